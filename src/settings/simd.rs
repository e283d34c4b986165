//! The name of a SIMD level → the level, where this machine has it.

use fearless_simd::Level;
use std::str::FromStr;

/// A SIMD level that this machine has.
#[derive(Clone, Copy, Debug)]
pub struct Simd(Level);

impl Simd {
    /// The best level that this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// A level that kernels were given.
    #[must_use]
    pub fn of(level: Level) -> Self {
        Self(level)
    }

    /// The level as the kernels take it.
    #[must_use]
    pub fn level(self) -> Level {
        self.0
    }

    /// Its name, as `--simd` takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Sse2(_) => "sse2",
            #[cfg(target_arch = "x86_64")]
            Level::Sse4_2(_) => "sse4.2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "scalar",
        }
    }
}

impl FromStr for Simd {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        named(name).map(Self).ok_or_else(|| format!("this machine or build has no SIMD level {name:?}"))
    }
}

fn named(name: &str) -> Option<Level> {
    let best = Level::new();
    match name {
        #[cfg(target_arch = "x86_64")]
        "sse2" => best.as_sse2().map(Level::Sse2),
        #[cfg(target_arch = "x86_64")]
        "sse4.2" => best.as_sse4_2().map(Level::Sse4_2),
        #[cfg(target_arch = "x86_64")]
        "avx2" => best.as_avx2().map(Level::Avx2),
        #[cfg(target_arch = "x86_64")]
        "avx512" => best.as_avx512().map(Level::Avx512),
        #[cfg(target_arch = "aarch64")]
        "neon" => best.as_neon().map(Level::Neon),
        #[cfg(feature = "scalar")]
        "scalar" => Some(Level::fallback()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_level_is_found_by_its_name() {
        let best = Simd::best();
        assert_eq!(best.name().parse().map(Simd::name), Ok(best.name()));
    }

    #[test]
    fn an_unknown_level_is_refused() {
        assert!("mmx".parse::<Simd>().is_err());
    }
}
