//! Texels and what lies between them, in f64. There is one level, the picture itself: many samples of
//! a pixel are its footprint.

use crate::math::colour::linear_from_srgb8;
use crate::model::texture::{ColorSpace, Filter, Texture, Wrap};
use glam::{DVec2, DVec3, DVec4};
use std::sync::LazyLock;

/// Linear values of the 256 sRGB codes.
static SRGB: LazyLock<[f64; 256]> = LazyLock::new(|| codes().map(linear_from_srgb8));

fn codes() -> [u8; 256] {
    std::array::from_fn(|code| u8::try_from(code).unwrap_or(u8::MAX))
}

/// Linear red, green and blue, and alpha.
pub fn color(texture: &Texture, uv: DVec2) -> DVec4 {
    let decode = |[r, g, b, a]: [u8; 4]| {
        let [r, g, b] = [r, g, b].map(|code| linear(texture, code));
        DVec4::new(r, g, b, f64::from(a) / 255.0)
    };
    filtered(texture, uv, decode)
}

/// The direction that a normal map holds, along u, along v and along the normal; not of unit length.
pub fn direction(texture: &Texture, uv: DVec2) -> DVec3 {
    let decode = |[r, g, b, _]: [u8; 4]| {
        let [x, y, z] = [r, g, b].map(|code| ((linear(texture, code) * 255.0 - 128.0) / 127.0).max(-1.0));
        DVec4::new(x, y, z, 0.0)
    };
    let texel = filtered(texture, uv, decode);
    // A picture that is laid on turned round has its own directions turned round.
    let [turn_u, turn_v] = texture.scale.map(|scale| if scale < 0.0 { -1.0 } else { 1.0 });
    DVec3::new(texel.x * turn_u, texel.y * turn_v, texel.z)
}

/// How fast the heights of a map, its red channel, rise along u and along v: over the width of a texel,
/// half of it to each side. A map of steps has no slope, so all are read as bilinear.
pub fn slopes(texture: &Texture, uv: DVec2) -> DVec2 {
    let at = placed(texture, uv);
    let height = |at: DVec2| between(texture, at, |[r, ..]| DVec4::splat(linear(texture, r))).x;
    let size = DVec2::new(f64::from(texture.image.width), f64::from(texture.image.height));
    let (u, v) = (DVec2::new(0.5 / size.x, 0.0), DVec2::new(0.0, 0.5 / size.y));
    let rise = DVec2::new(height(at + u) - height(at - u), height(at + v) - height(at - v));
    rise * size * DVec2::from_array(texture.scale)
}

fn filtered(texture: &Texture, uv: DVec2, decode: impl Fn([u8; 4]) -> DVec4) -> DVec4 {
    let at = placed(texture, uv);
    match texture.filter {
        Filter::Nearest => decode(nearest(texture, at)),
        Filter::Bilinear | Filter::Trilinear => between(texture, at, decode),
    }
}

fn linear(texture: &Texture, code: u8) -> f64 {
    match texture.color_space {
        ColorSpace::Srgb => SRGB[usize::from(code)],
        ColorSpace::Linear => f64::from(code) / 255.0,
    }
}

/// Coordinates in the picture; what is no number reads as 0.
fn placed(texture: &Texture, uv: DVec2) -> DVec2 {
    let at = uv * DVec2::from_array(texture.scale) + DVec2::from_array(texture.offset);
    DVec2::from_array(at.to_array().map(|c| if c.is_finite() { c } else { 0.0 }))
}

/// The texel that holds `at`.
fn nearest(texture: &Texture, at: DVec2) -> [u8; 4] {
    let [width, height] = [texture.image.width, texture.image.height];
    let [x, y] = [at.x * f64::from(width), at.y * f64::from(height)].map(f64::floor);
    texel(texture, [x, y])
}

/// Between the four texels around `at`; texel i has its centre at (i + ½) / n.
fn between(texture: &Texture, at: DVec2, decode: impl Fn([u8; 4]) -> DVec4) -> DVec4 {
    let [width, height] = [texture.image.width, texture.image.height];
    let [x, y] = [at.x * f64::from(width) - 0.5, at.y * f64::from(height) - 0.5];
    let (left, low) = (x.floor(), y.floor());
    let row = |y: f64| {
        let [a, b] = [left, left + 1.0].map(|column| decode(texel(texture, [column, y])));
        mix(a, b, x - left)
    };
    mix(row(low), row(low + 1.0), y - low)
}

/// `a` at 0, `b` at 1; of equal ones exactly that.
fn mix(a: DVec4, b: DVec4, part: f64) -> DVec4 {
    a + (b - a) * part
}

/// The texel in column x and row y, counted from the lower left corner, wherever that is.
fn texel(texture: &Texture, [x, y]: [f64; 2]) -> [u8; 4] {
    let image = &texture.image;
    let column = wrapped(texture.wrap[0], x, image.width);
    let row = wrapped(texture.wrap[1], y, image.height);
    // Rows are stored from the top.
    image.texels[(image.height as usize - 1 - row) * image.width as usize + column]
}

/// The place of texel `i` among those that there are.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "brought to 0–count before")]
fn wrapped(wrap: Wrap, i: f64, count: u32) -> usize {
    let n = f64::from(count);
    let place = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i,
        Wrap::Mirror => {
            let i = i.rem_euclid(2.0 * n);
            if i < n { i } else { 2.0 * n - 1.0 - i }
        }
    };
    place.clamp(0.0, n - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::texture::Image;
    use std::sync::Arc;

    /// Greys of one row, or of one column from the top.
    fn texture(codes: &[u8], is_row: bool, filter: Filter, wrap: Wrap) -> Texture {
        let count = u32::try_from(codes.len()).unwrap();
        let (width, height) = if is_row { (count, 1) } else { (1, count) };
        let texels = codes.iter().map(|&code| [code, code, code, 255]).collect();
        Texture::new(Arc::new(Image { width, height, texels }), ColorSpace::Linear, filter, [wrap; 2])
    }

    /// Codes along u at places counted in texels.
    fn along(filter: Filter, wrap: Wrap, places: &[f64]) -> Vec<f64> {
        let texture = texture(&[0, 60, 200], true, filter, wrap);
        places
            .iter()
            .map(|x| (color(&texture, DVec2::new(x / 3.0, 0.5)).x * 255.0 * 1e9).round() / 1e9)
            .collect()
    }

    #[test]
    fn texels_go_on_beyond_the_picture_as_their_wrap_says() {
        let inside = [0.1, 0.9, 1.1, 2.9];
        let beyond = [-0.1, -1.1, 3.1, 4.1, -30.1];
        for (wrap, expected) in [
            (Wrap::Repeat, [200.0, 60.0, 0.0, 60.0, 200.0]),
            (Wrap::Clamp, [0.0, 0.0, 200.0, 200.0, 0.0]),
            (Wrap::Mirror, [0.0, 60.0, 200.0, 60.0, 0.0]),
        ] {
            assert_eq!(along(Filter::Nearest, wrap, &inside), [0.0, 0.0, 60.0, 200.0]);
            assert_eq!(along(Filter::Nearest, wrap, &beyond), expected, "{wrap:?}");
        }
    }

    #[test]
    fn between_their_centres_texels_are_mixed() {
        for (wrap, expected) in [
            (Wrap::Repeat, [0.0, 15.0, 130.0, 200.0, 100.0, 100.0]),
            (Wrap::Clamp, [0.0, 15.0, 130.0, 200.0, 0.0, 200.0]),
            (Wrap::Mirror, [0.0, 15.0, 130.0, 200.0, 0.0, 200.0]),
        ] {
            assert_eq!(along(Filter::Bilinear, wrap, &[0.5, 0.75, 2.0, 2.5, 0.0, 3.0]), expected, "{wrap:?}");
        }
    }

    #[test]
    fn v_runs_up_and_coordinates_are_scaled_and_moved() {
        let texture = texture(&[10, 20, 30, 40], false, Filter::Nearest, Wrap::Repeat);
        let at = |texture: &Texture, v: f64| (color(texture, DVec2::new(0.5, v)).x * 255.0).round();
        assert_eq!([0.1, 0.3, 0.6, 0.9].map(|v| at(&texture, v)), [40.0, 30.0, 20.0, 10.0]);
        let placed = texture.placed([1.0, 2.0], [0.0, 0.25]);
        assert_eq!([0.1, 0.3, 0.4].map(|v| at(&placed, v)), [30.0, 10.0, 40.0]);
    }

    #[test]
    fn colours_are_decoded_before_they_are_mixed() {
        let mut texture = texture(&[0, 255], true, Filter::Bilinear, Wrap::Clamp);
        texture.color_space = ColorSpace::Srgb;
        assert_eq!(color(&texture, DVec2::new(0.5, 0.5)), DVec4::new(0.5, 0.5, 0.5, 1.0));
        texture.color_space = ColorSpace::Linear;
        // Code 128 is exactly 0, code 255 exactly 1, codes 0 and 1 both −1.
        let direction_of = |code: u8| {
            let image = Image { width: 1, height: 1, texels: vec![[code, code, code, 255]] };
            direction(&Texture { image: Arc::new(image), ..texture.clone() }, DVec2::ZERO)
        };
        assert_eq!([0, 1, 128, 255].map(|code| direction_of(code).x), [-1.0, -1.0, 0.0, 1.0]);
    }
}
