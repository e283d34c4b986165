//! `-o`: where a file goes, and what its name says about it.

use clap::builder::{PathBufValueParser, TypedValueParser};
use rasterd::jobs::{Animation, Format, Product};
use rasterd::plan::request::Query;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A file to write, or standard output.
#[derive(Clone, Debug)]
pub(super) struct Destination {
    path: PathBuf,
    kind: Kind,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Still(Format),
    Turntable(Animation),
    Archive,
}

impl Destination {
    /// Which files have flags of their own.
    pub(super) const USES: &str = "--frames is for turntables (.gif, .apng), --outputs for archives (.zip)";

    /// Reads the value of the flag.
    pub(super) fn parser() -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().try_map(Self::new)
    }

    fn new(path: PathBuf) -> Result<Self, String> {
        Ok(Self { kind: kind_of(&path)?, path })
    }

    /// Whether the flag `name` says something about it.
    pub(super) fn takes(&self, name: &str) -> bool {
        match name {
            "frames" => matches!(self.kind, Kind::Turntable(_)),
            "outputs" => self.kind == Kind::Archive,
            _ => true,
        }
    }

    /// What to make for it, out of a query that may hold other parameters too.
    pub(super) fn product(&self, query: &mut Query) -> Product {
        match self.kind {
            Kind::Still(format) => Product::Still(format),
            Kind::Turntable(format) => Product::read_turntable(query, format),
            Kind::Archive => Product::read_archive(query),
        }
    }

    /// Writes the whole file.
    pub(super) fn write(&self, bytes: &[u8]) -> std::io::Result<()> {
        if self.path == Path::new("-") {
            let mut stdout = std::io::stdout().lock();
            stdout.write_all(bytes)?;
            stdout.flush()
        } else {
            std::fs::write(&self.path, bytes)
        }
    }
}

impl std::fmt::Display for Destination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.path.display().fmt(f)
    }
}

/// By the file's ending; standard output, and what has no ending, is a PNG.
fn kind_of(path: &Path) -> Result<Kind, String> {
    let Some(ending) = path.extension() else { return Ok(Kind::Still(Format::Png)) };
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    if ending == "zip" {
        return Ok(Kind::Archive);
    }
    let still = Format::of_extension(&ending).map(Kind::Still);
    still.or_else(|| Animation::of_extension(&ending).map(Kind::Turntable)).ok_or_else(|| {
        format!("a picture is written as {}, a turntable as .gif or .apng, several outputs as .zip, not as .{ending}", Format::list())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_picks_the_kind() {
        let of = |path: &str| kind_of(Path::new(path));
        assert_eq!(of("-"), Ok(Kind::Still(Format::Png)));
        assert_eq!(of("a/b.PNG"), Ok(Kind::Still(Format::Png)));
        assert_eq!(of("a.b/c"), Ok(Kind::Still(Format::Png)));
        assert!(matches!(of("a.jpeg"), Ok(Kind::Still(Format::Jpeg { .. }))));
        assert_eq!(of("a.gif"), Ok(Kind::Turntable(Animation::Gif)));
        assert_eq!(of("a.apng"), Ok(Kind::Turntable(Animation::Apng)));
        assert_eq!(of("a.zip"), Ok(Kind::Archive));
        let fault = of("a.bmp").expect_err("a fault");
        assert!(fault.contains(".png, .jpg, .webp, .exr, .hdr") && fault.ends_with("not as .bmp"), "{fault}");
    }
}
