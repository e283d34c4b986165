//! What a report was made on.

use crate::settings::Simd;
use serde::Serialize;

/// A machine, and the program that ran on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// The processor's name; null where the system does not tell.
    pub cpu: Option<String>,
    /// How its frequency is governed; null where the system does not tell.
    pub governor: Option<String>,
    /// Instruction set of the kernels.
    pub simd: &'static str,
    /// Threads that draw.
    pub threads: usize,
    /// Version, commit and kind of build.
    pub build: String,
}

impl Machine {
    /// This one, drawing at `simd` on `threads`.
    #[must_use]
    pub fn here(simd: Simd, threads: usize) -> Self {
        let kind = if cfg!(debug_assertions) { "debug" } else { "release" };
        let commit = option_env!("RASTERD_COMMIT").unwrap_or("no commit");
        Self {
            cpu: cpu(),
            governor: read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
            simd: simd.name(),
            threads,
            build: format!("{} ({commit}, {kind})", env!("CARGO_PKG_VERSION")),
        }
    }
}

/// From Linux's list of processors.
fn cpu() -> Option<String> {
    let list = read("/proc/cpuinfo")?;
    let name = list.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'))?.1;
    Some(name.trim().to_owned())
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}
