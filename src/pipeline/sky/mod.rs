//! The background, where nothing else is: a kind of background and a view in, linear RGB out.
//!
//! Every pixel is looked up along the line of sight through its centre, in world axes.

mod cube_map;
mod daylight;
mod filter;
mod panorama;
pub mod rays;

use super::tiles::cover::Region;
use crate::math::colour::BRIGHTEST;
use crate::math::simd::*;
use crate::math::{Projection, View, approx, round_to_f32};
use crate::scene;
use cube_map::CubeMapView;
use daylight::DaylightView;
use glam::Vec3;
use panorama::PanoramaView;

/// A background as the tiles draw it.
#[derive(Clone, Debug)]
pub enum Background {
    /// One colour.
    Color(Vec3),
    /// By the elevation of the line of sight.
    Gradient(Gradient),
    /// A procedural sky.
    Daylight(DaylightView),
    /// Six pictures.
    CubeMap(CubeMapView),
    /// An equirectangular picture.
    Panorama(PanoramaView),
    /// Nothing: alpha 0.
    Transparent,
}

/// What is different along every line of sight.
trait Sight {
    /// Radiance along the lines of sight through eight screen points, in sub-pixels.
    fn radiance<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S>;
}

/// A gradient and the elevations it is seen at.
#[derive(Clone, Copy, Debug)]
pub struct Gradient {
    /// Colour at the nadir, and what it gains towards the zenith.
    bottom: Vec3,
    /// Zenith less nadir.
    rise: Vec3,
    /// World y of the line of sight's component per sub-pixel in x and y, and of the axis.
    elevation: [f32; 3],
    /// 1 / sub-pixels per unit of x/w and y/w.
    unit: [f32; 2],
}

impl Background {
    /// Prepares a scene's background for a view.
    #[must_use]
    pub fn new(background: &scene::Background, view: &View) -> Self {
        match background {
            scene::Background::Color(color) => Self::Color(*color),
            scene::Background::Gradient { top, bottom } => Self::Gradient(Gradient::new(*top, *bottom, view)),
            scene::Background::Sky(sky) => Self::Daylight(DaylightView::new(sky, view)),
            scene::Background::CubeMap(map) => Self::CubeMap(CubeMapView::new(map, view)),
            scene::Background::Panorama(panorama) => Self::Panorama(PanoramaView::new(panorama, view)),
            scene::Background::Transparent => Self::Transparent,
        }
    }

    /// Whether the picture has alpha.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        matches!(self, Self::Transparent)
    }

    /// What all of it looks like, if that is the same everywhere; as bright as radiance gets.
    #[must_use]
    pub fn plain(&self) -> Option<Vec3> {
        match self {
            Self::Color(color) => Some(color.min(Vec3::splat(BRIGHTEST))),
            Self::Transparent => Some(Vec3::ZERO),
            _ => None,
        }
    }

    /// Writes the colours of `pixels` (`y · side + x` within the tile) to their places, as bright as radiance
    /// gets.
    pub fn draw(&self, level: Level, pixels: &[u32], region: &Region, side: usize, out: &mut [Vec<f32>; 3]) {
        dispatch!(level, simd => self.draw_kernel(simd, pixels, region, side, out));
    }

    #[inline(always)]
    fn draw_kernel<S: Simd>(
        &self,
        simd: S,
        pixels: &[u32],
        region: &Region,
        side: usize,
        out: &mut [Vec<f32>; 3],
    ) {
        let place = Place { region, side };
        match self {
            Self::Color(_) | Self::Transparent => fill(pixels, self.plain().unwrap_or_default(), out),
            Self::Gradient(gradient) => place.draw(simd, pixels, gradient, out),
            Self::Daylight(sky) => place.draw(simd, pixels, sky, out),
            Self::CubeMap(map) => place.draw(simd, pixels, map, out),
            Self::Panorama(panorama) => place.draw(simd, pixels, panorama, out),
        }
    }
}

impl Gradient {
    fn new(top: Vec3, bottom: Vec3, view: &View) -> Self {
        let unit = match view.projection {
            Projection::Perspective => view.scale.map(|scale| 1.0 / scale),
            Projection::Orthographic => [0.0; 2],
        };
        let elevation = [view.right.y * unit[0], -view.up.y * unit[1], view.forward.y];
        Self {
            bottom,
            rise: top - bottom,
            elevation: elevation.map(round_to_f32),
            unit: unit.map(round_to_f32),
        }
    }
}

impl Sight for Gradient {
    #[inline(always)]
    fn radiance<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S> {
        let (x, y) = (narrow(x), narrow(y));
        let height = x * self.elevation[0] + y * self.elevation[1] + self.elevation[2];
        let (a, b) = (x * self.unit[0], y * self.unit[1]);
        let length = (a * a + b * b + 1.0).sqrt();
        let one = f32x8::splat(simd, 1.0);
        let sine = min(max(height / length, one * -1.0), one);
        let t = approx::asin(sine) * std::f32::consts::FRAC_1_PI + 0.5;
        Vec3x8::splat(simd, self.bottom) + Vec3x8::splat(simd, self.rise).scale(t)
    }
}

/// The tile that is drawn.
#[derive(Clone, Copy)]
struct Place<'a> {
    region: &'a Region,
    side: usize,
}

impl Place<'_> {
    /// Writes what is seen through the centres of `pixels`, eight at a time, to their places.
    #[inline(always)]
    fn draw<S: Simd>(self, simd: S, pixels: &[u32], sight: &impl Sight, out: &mut [Vec<f32>; 3]) {
        for group in pixels.chunks(LANES) {
            let pixel = always(
                #[inline(always)]
                |lane: usize| group[lane.min(group.len() - 1)] as usize,
            );
            let x = f64x8::from_fn(
                simd,
                #[inline(always)]
                |lane| centre(self.region.origin[0], pixel(lane) % self.side),
            );
            let y = f64x8::from_fn(
                simd,
                #[inline(always)]
                |lane| centre(self.region.origin[1], pixel(lane) / self.side),
            );
            let color = sight.radiance(simd, x, y);
            let brightest = f32x8::splat(simd, BRIGHTEST);
            let color = [color.x, color.y, color.z].map(always(
                #[inline(always)]
                |channel| min(channel, brightest),
            ));
            for (lane, &pixel) in group.iter().enumerate() {
                for (channel, value) in out.iter_mut().zip(color) {
                    channel[pixel as usize] = value[lane];
                }
            }
        }
    }
}

fn fill(pixels: &[u32], color: Vec3, out: &mut [Vec<f32>; 3]) {
    for (channel, value) in out.iter_mut().zip(color.to_array()) {
        for &pixel in pixels {
            channel[pixel as usize] = value;
        }
    }
}

/// Screen coordinate of a pixel's centre, in sub-pixels.
fn centre(origin: i32, pixel: usize) -> f64 {
    f64::from(origin + i32::try_from(pixel).expect("a tile is small") * 256 + 128)
}
