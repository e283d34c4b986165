//! Texture sampling: level of detail from analytic derivatives, addressing, filtering in linear light;
//! texels as colours, as normals, and as heights.

mod heights;

pub use heights::sample_slopes;

use super::BLOCK;
use crate::math::colour::{self, UNORM_DECODE};
use crate::math::simd::*;
use crate::math::{approx, round_to_f32};
use crate::model::texture::{ColorSpace, Filter, Texture, Wrap};
use std::sync::LazyLock;

/// Where a block of fragments lies in a texture.
#[derive(Clone, Debug)]
pub struct Coordinates {
    /// u and v, the latter running up.
    pub uv: [[f32; BLOCK]; 2],
    /// ∂u/∂x, ∂v/∂x, ∂u/∂y, ∂v/∂y in units per pixel, y running down.
    pub per_pixel: [[f32; BLOCK]; 4],
}

impl Default for Coordinates {
    fn default() -> Self {
        Self { uv: [[0.0; BLOCK]; 2], per_pixel: [[0.0; BLOCK]; 4] }
    }
}

/// The component of a normal that a code in 0–255 stands for, exactly 0 at 128 and 1 at 255. Source:
/// Direct3D 11.3 functional specification, 3.2.3.3, moved by 128.
fn snorm(code: f64) -> f32 {
    round_to_f32(((code - 128.0) / 127.0).max(-1.0))
}

/// Components of normals for the 256 codes of a linear image.
static LINEAR_SNORM: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|c| snorm(f64::from(u8::try_from(c).unwrap_or(255)))));

/// The same for an image whose codes are sRGB-encoded.
static SRGB_SNORM: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|c| snorm(colour::linear_from_srgb8(u8::try_from(c).unwrap_or(255)) * 255.0))
});

/// Samples `texture` at a block's texture coordinates: red, green, blue, alpha, in linear light.
pub fn sample(
    level: Level,
    texture: &Texture,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 4],
) {
    sample_with(level, &Sampler::of_colors(texture), coordinates, count, out);
}

/// Samples a normal map: x along u, y along v, z along the normal, filtered after decoding and so not
/// of unit length. (The fourth is alpha.)
///
/// Decoding is affine but for the code 0, which stands for −1 as 1 does: mips, made from the codes, hold
/// the mean of the decoded texels but for 1/127 of the share that had that code. Where the wrap mode
/// mirrors the picture its vectors stay as they are, as in every graphics API.
pub fn sample_normals(
    level: Level,
    texture: &Texture,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 4],
) {
    sample_with(level, &Sampler::of_normals(texture), coordinates, count, out);
}

fn sample_with(
    level: Level,
    sampler: &Sampler,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 4],
) {
    // By value: tables that are the kernel's own stay in registers.
    dispatch!(level, simd => sample_kernel(simd, *sampler, coordinates, count, out));
}

#[inline(always)]
fn sample_kernel<S: Simd>(
    simd: S,
    sampler: Sampler,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 4],
) {
    for at in (0..count).step_by(LANES) {
        let [u, v, level] = place(simd, sampler.texture, coordinates, at);
        for lane in 0..LANES.min(count - at) {
            let texel = sampler.sample(u[lane], v[lane], level[lane]);
            for c in 0..4 {
                out[c][at + lane] = texel[c];
            }
        }
    }
}

/// Coordinates of eight fragments in the picture, and their levels of detail.
#[inline(always)]
fn place<S: Simd>(simd: S, texture: &Texture, coordinates: &Coordinates, at: usize) -> [f32x8<S>; 3] {
    let coordinate = always(
        #[inline(always)]
        |axis: usize| {
            f32x8::from_slice(simd, &coordinates.uv[axis][at..at + LANES]) * round_to_f32(texture.scale[axis])
                + offset(texture, axis)
        },
    );
    let level = match texture.filter {
        Filter::Nearest => f32x8::splat(simd, 0.0),
        _ => level_of_detail(simd, texture, coordinates, at),
    };
    [coordinate(0), coordinate(1), level]
}

/// How far the picture is moved along an axis: without its whole turns where they change nothing (an
/// even number: a mirrored texture repeats every second unit), so that f32 keeps the digits that count.
fn offset(texture: &Texture, axis: usize) -> f32 {
    let offset = texture.offset[axis];
    let turns = if texture.wrap[axis] == Wrap::Clamp { 0.0 } else { (offset * 0.5).floor() * 2.0 };
    round_to_f32(offset - turns)
}

/// `log2` of the texels that a pixel steps over in the direction in which they are most, clamped to
/// the levels there are. Source: OpenGL 4.6 specification, 8.14.1.
#[inline(always)]
fn level_of_detail<S: Simd>(simd: S, texture: &Texture, coordinates: &Coordinates, at: usize) -> f32x8<S> {
    let size = [texture.image.width, texture.image.height].map(f64::from);
    let texels = always(
        #[inline(always)]
        |field: usize| {
            let axis = field % 2;
            let scale = round_to_f32(texture.scale[axis] * size[axis]);
            let d = f32x8::from_slice(simd, &coordinates.per_pixel[field][at..at + LANES]) * scale;
            d * d
        },
    );
    let (across, down) = (texels(0) + texels(1), texels(2) + texels(3));
    // What is not finite (at the horizon) takes the last level.
    let (least, most) = (f32x8::splat(simd, 1.0), f32x8::splat(simd, f32::MAX));
    let is_finite = across.simd_lt(most) & down.simd_lt(most);
    let bounded = is_finite.select(max(max(across, down), least), most);
    let last = f32x8::splat(simd, float(texture.mips.len()));
    min(approx::log2(bounded) * 0.5, last)
}

#[expect(clippy::cast_precision_loss, reason = "at most 14 levels")]
fn float(levels: usize) -> f32 {
    levels as f32
}

/// A texture as it is read texel by texel.
#[derive(Clone, Copy)]
struct Sampler<'a> {
    texture: &'a Texture,
    decode: &'static [f32; 256],
    alpha: &'static [f32; 256],
    /// The 16-bit code of a mip that stands for 0.
    zero: f32,
    /// What one step of that code is.
    step: f32,
}

/// The 16-bit code of a normal's zero, `128/255 · 65535`.
const SNORM_ZERO: f32 = 32_896.0;

/// The level below a level of detail.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to at most 14 levels")]
fn whole(level: f32) -> usize {
    level as usize
}

/// A texel's channels in linear light.
type Texel = [f32; 4];

impl<'a> Sampler<'a> {
    fn of_colors(texture: &'a Texture) -> Self {
        let decode = texture.decode();
        Self { texture, decode, alpha: &UNORM_DECODE, zero: 0.0, step: 1.0 / 65535.0 }
    }

    fn of_normals(texture: &'a Texture) -> Self {
        let decode = match texture.color_space {
            ColorSpace::Srgb => &*SRGB_SNORM,
            ColorSpace::Linear => &*LINEAR_SNORM,
        };
        let step = 1.0 / (65535.0 - SNORM_ZERO);
        Self { decode, zero: SNORM_ZERO, step, ..Self::of_colors(texture) }
    }

    #[inline(always)]
    fn sample(&self, u: f32, v: f32, level: f32) -> Texel {
        match self.texture.filter {
            Filter::Nearest => {
                let [w, h] = self.size(0);
                let (x, _) = address(self.texture.wrap[0], u, w, 0.0);
                let (y, _) = address(self.texture.wrap[1], v, h, 0.0);
                self.texel(0, x[0], y[0])
            }
            Filter::Bilinear => self.bilinear(whole(level + 0.5), u, v),
            Filter::Trilinear => {
                let below = self.bilinear(whole(level), u, v);
                let t = level - level.floor();
                if t == 0.0 { below } else { mix(below, self.bilinear(whole(level) + 1, u, v), t) }
            }
        }
    }

    #[inline(always)]
    fn bilinear(&self, level: usize, u: f32, v: f32) -> Texel {
        let [w, h] = self.size(level);
        let (x, fx) = address(self.texture.wrap[0], u, w, 0.5);
        let (y, fy) = address(self.texture.wrap[1], v, h, 0.5);
        let row = always(
            #[inline(always)]
            |y: usize| mix(self.texel(level, x[0], y), self.texel(level, x[1], y), fx),
        );
        mix(row(y[0]), row(y[1]), fy)
    }

    #[inline(always)]
    fn size(&self, level: usize) -> [u32; 2] {
        match level {
            0 => [self.texture.image.width, self.texture.image.height],
            _ => {
                let mip = &self.texture.mips[level - 1];
                [mip.width, mip.height]
            }
        }
    }

    #[inline(always)]
    fn texel(&self, level: usize, x: usize, y: usize) -> Texel {
        if level == 0 {
            let image = &self.texture.image;
            let [r, g, b, a] = image.texels[index(x, y, image.width, image.height)];
            let decode = always(
                #[inline(always)]
                |code: u8| self.decode[usize::from(code)],
            );
            [decode(r), decode(g), decode(b), self.alpha[usize::from(a)]]
        } else {
            let mip = &self.texture.mips[level - 1];
            let [r, g, b, a] = mip.texels[index(x, y, mip.width, mip.height)];
            [self.decode16(r), self.decode16(g), self.decode16(b), unorm16(a)]
        }
    }

    /// The value of a 16-bit code, to within one rounding.
    #[inline(always)]
    fn decode16(&self, code: u16) -> f32 {
        (f32::from(code) - self.zero) * self.step
    }
}

/// Index of the texel in column x and row y. Rows are stored from the top; v, and so y, runs up.
#[inline(always)]
fn index(x: usize, y: usize, width: u32, height: u32) -> usize {
    (height as usize - 1 - y) * width as usize + x
}

/// `code / 65535`, to within one rounding.
#[inline(always)]
fn unorm16(code: u16) -> f32 {
    f32::from(code) * (1.0 / 65535.0)
}

#[inline(always)]
fn mix(a: Texel, b: Texel, t: f32) -> Texel {
    let lerp = always(
        #[inline(always)]
        |c: usize| a[c] + (b[c] - a[c]) * t,
    );
    [lerp(0), lerp(1), lerp(2), lerp(3)]
}

/// The two texels along one axis around coordinate `c`, and how far it lies between them.
///
/// Texel i has its centre at `(i + ½) / n`; `half` is ½ for a pair around `c` and 0 for the one
/// texel that holds it.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "both are bounded by the texture's side"
)]
#[expect(clippy::cast_precision_loss, reason = "a texture has at most 2¹⁴ texels a side")]
fn address(wrap: Wrap, c: f32, n: u32, half: f32) -> ([usize; 2], f32) {
    // What is no number reads as 0.
    let c = if c.is_finite() { c } else { 0.0 };
    let folded = match wrap {
        Wrap::Repeat => c - c.floor(),
        Wrap::Clamp => c.clamp(0.0, 1.0),
        Wrap::Mirror => {
            let t = c - 2.0 * (c * 0.5).floor();
            if t > 1.0 { 2.0 - t } else { t }
        }
    };
    let x = folded * n as f32 - half;
    let floor = x.floor();
    let (last, first) = (i64::from(n) - 1, floor as i64);
    let side = always(
        #[inline(always)]
        |i: i64| match wrap {
            Wrap::Repeat if i < 0 => last as usize,
            Wrap::Repeat if i > last => {
                if half == 0.0 {
                    last as usize
                } else {
                    0
                }
            }
            _ => i.clamp(0, last) as usize,
        },
    );
    ([side(first), side(first + 1)], x - floor)
}
