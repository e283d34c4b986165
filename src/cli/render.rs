//! `rasterd render`

use super::Failure;
use super::destination::Destination;
use super::frame_flags::FrameFlags;
use super::source::Source;
use rasterd::http::Problem;
use rasterd::jobs::Product;
use rasterd::plan::FrameRequest;
use rasterd::plan::request::Query;
use rasterd::report::choose::Choice;
use rasterd::settings::Machine;

/// The arguments of `rasterd render`.
#[derive(Debug, clap::Args)]
pub(super) struct Render {
    #[command(flatten)]
    source: Source,

    /// The file to write, of the kind that its ending says: .png, .jpg, .webp, .exr, .hdr; a turntable
    /// as .gif or .apng; several outputs as .zip. - is standard output, PNG
    #[arg(short, long, value_name = "OUT", value_parser = Destination::parser())]
    out: Destination,

    #[command(flatten)]
    frame: FrameFlags,

    #[command(flatten)]
    machine: Machine,
}

impl Render {
    /// Files → scene → picture → file.
    pub(super) fn run(self) -> Result<(), Failure> {
        self.check_usage().unwrap_or_else(|error| error.exit());
        let (product, request) = self.query()?;
        let (renderer, scene) = self.source.open(self.machine)?;
        let (request, choice) = renderer.to_budget_now(&scene, request)?;
        if let Some(choice) = choice {
            super::say(chosen(&choice));
        }
        let rendered = renderer.render_now(&scene, &request, product)?;
        self.out.write(&rendered.bytes).map_err(|error| Failure::new(&self.out, error))
    }

    /// Refuses flags that the kind of file has no use for.
    fn check_usage(&self) -> Result<(), clap::Error> {
        let flags = [("frames", &self.frame.frames), ("outputs", &self.frame.outputs)];
        let idle = flags.iter().find(|(name, value)| value.is_some() && !self.out.takes(name));
        idle.map_or(Ok(()), |(name, _)| {
            let detail = format!("--{name} says nothing about {}: {}\n", self.out, Destination::USES);
            Err(clap::Error::raw(clap::error::ErrorKind::ArgumentConflict, detail))
        })
    }

    /// What to draw, by the reader of the server's query.
    fn query(&self) -> Result<(Product, FrameRequest), Problem> {
        let mut query = Query::new(self.frame.pairs());
        let product = self.out.product(&mut query);
        let request = FrameRequest::read(&mut query);
        query.finish().map_err(|faults| Problem::query(&faults))?;
        Ok((product, request))
    }
}

/// The settings that a budget bought, in words.
fn chosen(choice: &Choice) -> String {
    let settings = choice.setting.parameters();
    let settings: Vec<String> = settings.iter().map(|(name, value)| format!("--{name} {value}")).collect();
    let (settings, error, ms) = (settings.join(" ").replace('_', "-"), choice.error, choice.ms);
    let missed = if choice.met { "" } else { "; no setting is expected to keep the budget" };
    format!("{settings}; expected: error {error:.4}, {ms:.1} ms ({}){missed}", choice.source.word())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(clap::Parser)]
    struct Flags {
        #[command(flatten)]
        render: Render,
    }

    fn parse(arguments: &[&str]) -> Render {
        use clap::Parser;
        Flags::try_parse_from(arguments).expect("usage").render
    }

    #[test]
    fn every_frame_query_is_a_flag() {
        let mut query = Query::new([]);
        FrameRequest::read(&mut query);
        let command = <Flags as clap::CommandFactory>::command();
        let names = |flag: &clap::Arg| {
            let aliases = flag.get_all_aliases().unwrap_or_default();
            flag.get_long().into_iter().chain(aliases).map(str::to_owned).collect::<Vec<_>>()
        };
        let flags: Vec<String> = command.get_arguments().flat_map(names).collect();
        for name in query.known() {
            assert!(flags.iter().any(|flag| flag == name), "{name}");
        }
    }

    #[test]
    fn a_value_may_start_with_a_minus() {
        let render = parse(&["render", "a.obj", "-o", "-", "--orbit", "-30,20", "--eye", "-1,2,3"]);
        let pairs: Vec<_> = render.frame.pairs().collect();
        assert_eq!(pairs, [("eye", "-1,2,3"), ("orbit", "-30,20")]);
    }

    #[test]
    fn flags_of_another_kind_of_file_are_wrong_usage() {
        let usage = |arguments: &[&str]| {
            let arguments = ["render", "a.obj", "-o"].iter().chain(arguments).copied();
            parse(&arguments.collect::<Vec<_>>()).check_usage()
        };
        assert!(usage(&["a.gif", "--frames", "3"]).is_ok());
        assert!(usage(&["a.zip", "--outputs", "depth"]).is_ok());
        let error = usage(&["a.png", "--frames", "3"]).expect_err("a fault").to_string();
        assert!(error.contains("--frames says nothing about a.png"), "{error}");
        assert!(usage(&["a.gif", "--outputs", "depth"]).is_err());
    }
}
