//! The kinds of files that a picture can be.

use crate::plan::Output;

/// How one picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG: RGB or RGBA of 8 bits, or 16-bit grey for values.
    Png,
    /// JPEG.
    Jpeg {
        /// 1–100.
        quality: u8,
    },
    /// WebP, lossless.
    Webp,
    /// OpenEXR: linear colour before `post`, 32-bit floats.
    Exr,
    /// Radiance HDR: linear colour before `post`, a shared exponent.
    Hdr,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 5] =
        [Self::Png, Self::Jpeg { quality: Self::DEFAULT_QUALITY }, Self::Webp, Self::Exr, Self::Hdr];

    /// Quality of a JPEG where none is asked for.
    pub const DEFAULT_QUALITY: u8 = 80;

    /// The ending of a file's name, without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        self.names().0
    }

    /// The media type.
    #[must_use]
    pub fn content_type(self) -> &'static str {
        self.names().1
    }

    /// The one table.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Png => ("png", "image/png"),
            Self::Jpeg { .. } => ("jpg", "image/jpeg"),
            Self::Webp => ("webp", "image/webp"),
            // Registered by nobody; these are what programs look for.
            Self::Exr => ("exr", "image/x-exr"),
            Self::Hdr => ("hdr", "image/vnd.radiance"),
        }
    }

    /// The format of a file that ends in `.extension`; `jpeg` counts as `jpg`.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        let extension = if extension == "jpeg" { "jpg" } else { extension };
        Self::ALL.into_iter().find(|format| format.extension() == extension)
    }

    /// Every extension, for a sentence: `.png, .jpg, …`.
    #[must_use]
    pub fn list() -> String {
        Self::ALL.map(|format| format!(".{}", format.extension())).join(", ")
    }

    /// The same format at a quality, if it has such a thing.
    #[must_use]
    pub fn with_quality(self, quality: Option<u8>) -> Self {
        match (self, quality) {
            (Self::Jpeg { .. }, Some(quality)) => Self::Jpeg { quality },
            _ => self,
        }
    }

    /// What must be drawn for a picture of `output` in this format.
    ///
    /// # Errors
    /// [`Unfit`]: the format cannot hold it.
    pub fn drawn_as(self, output: Output) -> Result<Output, Unfit> {
        match self {
            Self::Png => Ok(output),
            // What is lossy keeps no numbers: of depth it shows greys, of instances their colours.
            Self::Jpeg { .. } if output == Output::Instance => Ok(Output::Ids),
            Self::Jpeg { .. } => Ok(output),
            Self::Webp if output.is_values() => Err(Unfit::Values { output, extension: self.extension() }),
            Self::Webp => Ok(output),
            Self::Exr | Self::Hdr if output.is_shaded() => Ok(Output::Radiance),
            Self::Exr | Self::Hdr => Err(Unfit::Data { output, extension: self.extension() }),
        }
    }

    /// What tells the files of one picture apart, for an ETag: `png`, `jpg80`.
    #[must_use]
    pub fn tag(self) -> String {
        match self {
            Self::Jpeg { quality } => format!("jpg{quality}"),
            _ => self.extension().to_owned(),
        }
    }
}

/// How a moving picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Animation {
    /// GIF: one palette of up to 255 colours, alpha 0 or 1.
    Gif,
    /// APNG: all that PNG holds.
    Apng,
}

impl Animation {
    /// Every format.
    pub const ALL: [Self; 2] = [Self::Gif, Self::Apng];

    /// The ending of a file's name, without the dot: of a turntable's path, and of an animated PNG that
    /// lies among others.
    #[must_use]
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Gif => &["gif"],
            Self::Apng => &["png", "apng"],
        }
    }

    /// The media type. An animated PNG is a PNG to all who do not know better.
    #[must_use]
    pub fn content_type(self) -> &'static str {
        match self {
            Self::Gif => "image/gif",
            Self::Apng => "image/png",
        }
    }

    /// The format of a file that ends in `.extension`.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|animation| animation.extensions().contains(&extension))
    }

    /// Every extension of a turntable's path, for a sentence.
    #[must_use]
    pub fn list() -> String {
        Self::ALL.map(|animation| format!(".{}", animation.extensions()[0])).join(", ")
    }

    /// Whether it can show `output`.
    ///
    /// # Errors
    /// [`Unfit`].
    pub fn check(self, output: Output) -> Result<(), Unfit> {
        match self {
            Self::Gif if output.is_values() => Err(Unfit::Values { output, extension: "gif" }),
            _ => Ok(()),
        }
    }
}

/// Why a format cannot hold what a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// 16 bits do not go into 8.
    #[error(
        "output={} is a picture of 16-bit values, which .{extension} cannot hold; ask for .png",
        output.word()
    )]
    Values {
        /// What the picture would show.
        output: Output,
        /// The format.
        extension: &'static str,
    },
    /// Light is not what the picture would show.
    #[error("must be color, is {}: .{extension} holds linear colour before post and nothing else", output.word())]
    Data {
        /// What the picture would show.
        output: Output,
        /// The format.
        extension: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_extension_finds_its_format() {
        for format in Format::ALL {
            assert_eq!(Format::of_extension(format.extension()), Some(format));
        }
        assert_eq!(Format::of_extension("jpeg"), Format::of_extension("jpg"));
        assert_eq!(Format::of_extension("bmp"), None);
        for animation in Animation::ALL {
            for extension in animation.extensions() {
                assert_eq!(Animation::of_extension(extension), Some(animation));
            }
        }
    }

    #[test]
    fn quality_is_jpegs_alone() {
        assert_eq!(Format::Png.with_quality(Some(7)), Format::Png);
        let jpeg = Format::Jpeg { quality: 80 };
        assert_eq!(jpeg.with_quality(None), jpeg);
        assert_eq!(jpeg.with_quality(Some(7)).tag(), "jpg7");
    }

    #[test]
    fn float_formats_hold_linear_colour_alone() {
        for format in [Format::Exr, Format::Hdr] {
            assert_eq!(format.drawn_as(Output::Color), Ok(Output::Radiance));
            assert!(matches!(format.drawn_as(Output::Normal), Err(Unfit::Data { .. })));
        }
    }

    #[test]
    fn a_jpeg_shows_every_output_in_its_way() {
        let jpeg = Format::Jpeg { quality: 80 };
        for output in Output::all() {
            let expected = if output == Output::Instance { Output::Ids } else { output };
            assert_eq!(jpeg.drawn_as(output), Ok(expected));
        }
    }

    #[test]
    fn values_go_into_a_png_alone() {
        for output in [Output::Depth, Output::Instance] {
            assert_eq!(Format::Png.drawn_as(output), Ok(output));
            let fault = Format::Webp.drawn_as(output).unwrap_err().to_string();
            assert!(fault.contains(output.word()) && fault.ends_with(".png"), "{fault}");
            assert!(Animation::Apng.check(output).is_ok() && Animation::Gif.check(output).is_err());
        }
    }
}
