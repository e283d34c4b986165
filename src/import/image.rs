//! Image bytes → [`Image`], or [`Picture`] for a sky.

use super::ImportError;
use crate::limits::Limits;
use crate::math::colour::BRIGHTEST;
use crate::model::sky::texels::{Picture, PictureSize, Texels};
use crate::model::texture::Image;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// Why an image was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// Neither content nor name say what it is.
    #[error(
        "not an image in a format that is read here (PNG, JPEG, WebP, BMP, TGA, GIF; Radiance HDR for backgrounds)"
    )]
    UnknownFormat,
    /// Damaged, cut off, or of a kind that the decoder does not know.
    #[error("the image cannot be read: {0}")]
    Unreadable(String),
    /// A side is 0.
    #[error("the image has {width} × {height} texels")]
    Empty {
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A side is over its limit; found before anything is decoded.
    #[error("the image has {width} × {height} texels, more than {limit} a side")]
    SideTooLarge {
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// [`Limits::texture_side`].
        limit: u32,
    },
    /// Decoding would take more memory than a scene may have; found before anything is decoded.
    #[error("the decoded image has {bytes} bytes, more than {limit}")]
    TooManyBytes {
        /// Decoded.
        bytes: u64,
        /// [`Limits::scene_bytes`].
        limit: u64,
    },
}

impl ImageError {
    /// As the API reports it.
    #[must_use]
    pub fn in_file(self, file: &str) -> ImportError {
        let detail = self.to_string();
        let file = file.to_owned();
        match self {
            Self::SideTooLarge { width, height, limit } => ImportError::TooLarge {
                file,
                detail,
                value: u64::from(width.max(height)),
                limit: u64::from(limit),
                setting: None,
            },
            Self::TooManyBytes { bytes, limit } => ImportError::TooLarge {
                file,
                detail,
                value: bytes,
                limit,
                setting: Some("RASTERD_MAX_SCENE_BYTES"),
            },
            _ => ImportError::Unreadable { file, line: None, detail },
        }
    }
}

/// Decodes a PNG, JPEG, WebP, BMP, TGA or GIF (its first frame) to 8-bit red, green, blue, alpha.
///
/// The content decides which it is; TGA has no signature and goes by the name's ending. Grey,
/// palette and 16-bit pictures are converted (16 bits by rounding), alpha stays straight, and
/// pictures without alpha are opaque. Embedded colour profiles and orientations are not applied.
///
/// # Errors
/// If it cannot be read or is larger than `limits` allow. Sizes are checked before decoding.
pub fn decode(bytes: &[u8], file: &str, limits: &Limits) -> Result<Image, ImageError> {
    let decoder = decoder(bytes, file, limits)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(|error| decoding_error(&error, limits))?;
    let rgba = decoded.into_rgba8();
    let (width, height) = rgba.dimensions();
    let (texels, _) = rgba.as_raw().as_chunks::<4>();
    Ok(Image { width, height, texels: texels.to_vec() })
}

/// Decodes a picture of a sky: Radiance HDR to linear floats, all other formats as [`decode`].
///
/// Values that are no numbers become 0, larger ones than [`BRIGHTEST`] that. The header's `EXPOSURE` is
/// not applied.
///
/// # Errors
/// As [`decode`].
pub fn decode_picture(bytes: &[u8], file: &str, limits: &Limits) -> Result<Picture, ImageError> {
    if !is_radiance(bytes) {
        return decode(bytes, file, limits).map(Picture::from);
    }
    let decoder = radiance_decoder(bytes, limits)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(|error| decoding_error(&error, limits))?;
    let rgb = decoded.into_rgb32f();
    let (width, height) = rgb.dimensions();
    let (texels, _) = rgb.as_raw().as_chunks::<3>();
    let scrubbed = |value: f32| if value > 0.0 { value.min(BRIGHTEST) } else { 0.0 };
    let texels = texels.iter().map(|texel| texel.map(scrubbed)).collect();
    Ok(Picture { width, height, texels: Texels::Linear(texels) })
}

/// The size of what [`decode_picture`] will make of a file, from its header; an image has that of a picture
/// that is not linear.
///
/// # Errors
/// As [`decode_picture`], but for damage behind the header.
pub fn picture_size(bytes: &[u8], file: &str, limits: &Limits) -> Result<PictureSize, ImageError> {
    let is_linear = is_radiance(bytes);
    let (width, height) = match is_linear {
        true => radiance_decoder(bytes, limits)?.dimensions(),
        false => decoder(bytes, file, limits)?.dimensions(),
    };
    Ok(PictureSize { width, height, is_linear })
}

/// Radiance itself begins its files with `#?RADIANCE`, some other programs with `#?RGBE`.
fn is_radiance(bytes: &[u8]) -> bool {
    bytes.starts_with(b"#?")
}

/// Has read the header of a Radiance HDR whose size is within `limits`.
fn radiance_decoder<'a>(
    bytes: &'a [u8],
    limits: &Limits,
) -> Result<HdrDecoder<Cursor<&'a [u8]>>, ImageError> {
    let decoder =
        HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(|error| decoding_error(&error, limits))?;
    check_size(&decoder, limits)?;
    Ok(decoder)
}

/// Has read the header of a file of any other format whose size is within `limits`.
fn decoder<'a>(
    bytes: &'a [u8],
    file: &str,
    limits: &Limits,
) -> Result<impl ImageDecoder + use<'a>, ImageError> {
    let format = format_of(bytes, file).ok_or(ImageError::UnknownFormat)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(decoder_limits(limits));
    let decoder = reader.into_decoder().map_err(|error| decoding_error(&error, limits))?;
    check_size(&decoder, limits)?;
    Ok(decoder)
}

/// By content; TGA by its name.
fn format_of(bytes: &[u8], file: &str) -> Option<ImageFormat> {
    let is_tga = || file.to_ascii_lowercase().ends_with(".tga").then_some(ImageFormat::Tga);
    image::guess_format(bytes).ok().or_else(is_tga).filter(|format| {
        use ImageFormat::{Bmp, Gif, Jpeg, Png, Tga, WebP};
        matches!(format, Png | Jpeg | WebP | Bmp | Tga | Gif)
    })
}

/// What the decoders hold themselves to. Twice a scene, since a decoder may need a second buffer.
fn decoder_limits(limits: &Limits) -> image::Limits {
    let mut decoder_limits = image::Limits::default();
    decoder_limits.max_alloc = Some(limits.scene_bytes.saturating_mul(2));
    decoder_limits
}

fn check_size(decoder: &impl ImageDecoder, limits: &Limits) -> Result<(), ImageError> {
    let (width, height) = decoder.dimensions();
    let limit = limits.texture_side;
    let bytes = decoder.total_bytes().max(u64::from(width) * u64::from(height) * 4);
    match () {
        () if width == 0 || height == 0 => Err(ImageError::Empty { width, height }),
        () if width.max(height) > limit => Err(ImageError::SideTooLarge { width, height, limit }),
        () if bytes > limits.scene_bytes => {
            Err(ImageError::TooManyBytes { bytes, limit: limits.scene_bytes })
        }
        () => Ok(()),
    }
}

fn decoding_error(error: &image::ImageError, limits: &Limits) -> ImageError {
    match error {
        image::ImageError::Limits(_) => ImageError::TooManyBytes {
            bytes: limits.scene_bytes.saturating_add(1),
            limit: limits.scene_bytes,
        },
        other => ImageError::Unreadable(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, GrayAlphaImage, ImageBuffer, Rgb, RgbImage, RgbaImage};
    use proptest::prelude::*;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn rgb(width: u32, height: u32) -> DynamicImage {
        RgbImage::from_fn(width, height, |x, y| {
            Rgb([u8::try_from(x * 40 % 256).unwrap(), u8::try_from(y * 60 % 256).unwrap(), 7])
        })
        .into()
    }

    #[test]
    fn every_format_is_read() {
        use ImageFormat::{Bmp, Gif, Jpeg, Png, Tga, WebP};
        for format in [Png, Bmp, Tga, WebP, Gif, Jpeg] {
            let name = if format == Tga { "x.TGA" } else { "misnamed.dat" };
            let image = decode(&encoded(&rgb(5, 3), format), name, &Limits::default()).unwrap();
            assert_eq!((image.width, image.height, image.texels.len()), (5, 3, 15), "{format:?}");
            assert!(image.is_opaque());
            if !matches!(format, Jpeg | Gif) {
                assert_eq!(image.texels[6], [40, 60, 7, 255], "{format:?}");
            }
        }
    }

    #[test]
    fn sixteen_bits_round_and_grey_alpha_spreads() {
        let deep: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_pixel(1, 1, Rgb([65_535u16, 0x8080, 128]));
        let image = decode(&encoded(&deep.into(), ImageFormat::Png), "", &Limits::default()).unwrap();
        assert_eq!(image.texels, [[255, 128, 0, 255]]);
        let grey = GrayAlphaImage::from_pixel(1, 1, image::LumaA([9, 100]));
        let image = decode(&encoded(&grey.into(), ImageFormat::Png), "", &Limits::default()).unwrap();
        assert_eq!(image.texels, [[9, 9, 9, 100]]);
    }

    #[test]
    fn a_side_over_its_limit_is_refused_before_decoding() {
        let mut bytes = encoded(&rgb(1, 1), ImageFormat::Bmp);
        bytes[18..22].copy_from_slice(&16_385u32.to_le_bytes());
        let error = decode(&bytes, "", &Limits::default()).unwrap_err();
        assert_eq!(error, ImageError::SideTooLarge { width: 16_385, height: 1, limit: 16_384 });
        assert!(matches!(error.in_file("a.bmp"), ImportError::TooLarge { value: 16_385, limit: 16_384, .. }));
    }

    #[test]
    fn a_bomb_is_refused_before_decoding() {
        let limits = Limits { scene_bytes: 1000, ..Limits::default() };
        let error = decode(&encoded(&rgb(16, 16), ImageFormat::Png), "", &limits).unwrap_err();
        assert!(matches!(error, ImageError::TooManyBytes { .. }), "{error}");
    }

    #[test]
    fn text_is_not_an_image() {
        assert_eq!(decode(b"v 0 0 0\n", "a.png", &Limits::default()), Err(ImageError::UnknownFormat));
    }

    /// A Radiance picture of one row: mantissas and exponent of each texel, not compressed.
    fn radiance(signature: &str, texels: &[[u8; 4]]) -> Vec<u8> {
        let header = format!("{signature}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X {}\n", texels.len());
        [header.as_bytes(), texels.as_flattened()].concat()
    }

    #[test]
    fn radiance_pictures_keep_what_is_brighter_than_white() {
        for signature in ["#?RADIANCE", "#?RGBE"] {
            // Mantissa · 2^(exponent − 136).
            let bytes = radiance(signature, &[[128, 64, 0, 136], [3, 0, 255, 250]]);
            let picture = decode_picture(&bytes, "sky.hdr", &Limits::default()).unwrap();
            let texels = Texels::Linear(vec![[128.0, 64.0, 0.0], [BRIGHTEST, 0.0, BRIGHTEST]]);
            assert_eq!(picture, Picture { width: 2, height: 1, texels });
        }
    }

    #[test]
    fn radiance_pictures_keep_to_the_limits_and_are_no_textures() {
        let bytes = radiance("#?RADIANCE", &[[1, 1, 1, 128]; 2]);
        assert_eq!(decode(&bytes, "sky.hdr", &Limits::default()), Err(ImageError::UnknownFormat));
        let large = b"#?RADIANCE\n\n-Y 16385 +X 1\n";
        let refused = decode_picture(large, "sky.hdr", &Limits::default()).unwrap_err();
        assert_eq!(refused, ImageError::SideTooLarge { width: 1, height: 16_385, limit: 16_384 });
        let bomb = b"#?RADIANCE\n\n-Y 16384 +X 16384\n";
        let refused = decode_picture(bomb, "sky.hdr", &Limits::default()).unwrap_err();
        assert!(matches!(refused, ImageError::TooManyBytes { .. }), "{refused}");
        let cut = &bytes[..bytes.len() - 1];
        let refused = decode_picture(cut, "sky.hdr", &Limits::default()).unwrap_err();
        assert!(matches!(refused, ImageError::Unreadable(_)), "{refused}");
    }

    proptest! {
        #[test]
        fn damaged_radiance_pictures_never_panic(
            hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
            tail in prop::collection::vec(any::<u8>(), 0..200),
        ) {
            let mut bytes = radiance("#?RADIANCE", &[[2, 2, 0, 9]; 9]);
            for (at, value) in hits {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            bytes.extend(tail);
            let limits = Limits { scene_bytes: 1 << 24, ..Limits::default() };
            if let Ok(Picture { width, height, texels: Texels::Linear(texels) }) =
                decode_picture(&bytes, "x.hdr", &limits)
            {
                prop_assert_eq!(texels.len() as u64, u64::from(width) * u64::from(height));
                prop_assert!(texels.iter().flatten().all(|v| (0.0..=BRIGHTEST).contains(v)));
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn damage_never_panics(
            format in prop::sample::select(vec![
                ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP, ImageFormat::Bmp, ImageFormat::Tga, ImageFormat::Gif,
            ]),
            hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
            keep in 0.0f64..1.2,
        ) {
            let rgba = RgbaImage::from_fn(9, 7, |x, y| image::Rgba([1, 2, u8::try_from(x * y).unwrap(), 200]));
            let picture: DynamicImage = if format == ImageFormat::Jpeg { rgb(9, 7) } else { rgba.into() };
            let mut bytes = encoded(&picture, format);
            for (at, value) in hits {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a length of a small file")]
            bytes.truncate((keep * f64::from(u32::try_from(bytes.len()).unwrap())) as usize);
            let limits = Limits { scene_bytes: 1 << 24, ..Limits::default() };
            if let Ok(image) = decode(&bytes, "x.tga", &limits) {
                prop_assert_eq!(image.texels.len() as u64, u64::from(image.width) * u64::from(image.height));
            }
        }
    }
}
