//! `rasterd [serve]`, `rasterd render`, `rasterd report`, `rasterd healthcheck`, `rasterd selftest`.
//!
//! Exit code 0 when all went well, 1 for bad input or a failed check, 2 for wrong usage (clap's own).

mod beside;
mod destination;
mod frame_flags;
mod healthcheck;
mod render;
mod report;
mod selftest;
mod serve;
mod source;

use clap::{Parser, Subcommand};
use rasterd::settings::Settings;
use std::io::Write;
use std::process::ExitCode;

/// What a server reads from the environment alone.
const LOG_HELP: &str = "\
Environment:
  RASTERD_LOG  What the log on standard error shows: error, warn, info, debug, trace, or by module,
               as in rasterd=debug [default: info]";

/// A render server: 3D scenes over HTTP, drawn on the CPU
#[derive(Debug, Parser)]
#[command(name = "rasterd", version, args_conflicts_with_subcommands = true, after_help = LOG_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Serve scenes over HTTP (also without naming it)
    #[command(after_help = LOG_HELP)]
    Serve(Box<Settings>),
    /// Draw a model or a scene document into a picture, a turntable or an archive of outputs
    Render(Box<render::Render>),
    /// Measure error against run time of a model or a scene document
    Report(Box<report::Report>),
    /// Ask a server on the listening address whether it lives
    Healthcheck(healthcheck::Healthcheck),
    /// Run the catalogue of stiff and extreme cases, and print each error beside its bound
    Selftest(selftest::Selftest),
}

/// Runs the command that the arguments name.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        None => serve::run(cli.settings),
        Some(Command::Serve(settings)) => serve::run(*settings),
        Some(Command::Render(render)) => render.run(),
        Some(Command::Report(report)) => report.run(),
        Some(Command::Healthcheck(check)) => check.run(),
        Some(Command::Selftest(selftest)) => selftest.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(failure);
            ExitCode::FAILURE
        }
    }
}

/// Says something on standard error, if anybody still reads it.
fn say(message: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "rasterd: {message}");
}

/// What standard error shows before exit code 1.
#[derive(Debug)]
struct Failure(String);

impl Failure {
    /// `what`, and why.
    fn new(what: impl std::fmt::Display, why: impl std::fmt::Display) -> Self {
        Self(format!("{what}: {why}"))
    }
}

impl<T: Into<rasterd::http::Problem>> From<T> for Failure {
    fn from(problem: T) -> Self {
        Self(problem.into().to_string())
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_flags_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn help_names_the_log_filter() {
        let mut command = Cli::command();
        assert!(command.render_help().to_string().contains("RASTERD_LOG"));
        let serve = command.find_subcommand_mut("serve").expect("a command");
        assert!(serve.render_help().to_string().contains("RASTERD_LOG"));
    }

    #[test]
    fn serve_may_be_left_out() {
        let cli = Cli::try_parse_from(["rasterd", "--listen", "0.0.0.0:9000"]).expect("usage");
        assert_eq!(cli.settings.listen.port(), 9000);
        let cli = Cli::try_parse_from(["rasterd", "serve", "--listen", "0.0.0.0:9000"]).expect("usage");
        assert!(matches!(cli.command, Some(Command::Serve(settings)) if settings.listen.port() == 9000));
    }
}
