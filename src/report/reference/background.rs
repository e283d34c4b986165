//! What is seen where nothing else is.
//!
//! The computed sky is read from its own table of scattered light, between entries in f64, times the two
//! phase functions in closed form; the model's tests say how far the table is off the integral. Pictures
//! are read at their full size, bilinearly: many samples of a pixel are its footprint.

use crate::math::colour::{BRIGHTEST, SRGB_DECODE};
use crate::model::sky::cube_map::AXES;
use crate::model::sky::daylight::{COLUMNS, ROWS, SUN_RADIUS, haze_phase, rayleigh_phase};
use crate::model::sky::{CubeMap, Daylight, Panorama, Texels};
use crate::scene::Background;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, TAU};

/// Red, green, blue and alpha along a direction of any length.
pub fn radiance(background: &Background, direction: DVec3) -> [f64; 4] {
    let sight = direction.normalize();
    let color = match background {
        Background::Color(color) => color.as_dvec3(),
        Background::Gradient { top, bottom } => {
            bottom.as_dvec3().lerp(top.as_dvec3(), 0.5 + sight.y.clamp(-1.0, 1.0).asin() * FRAC_1_PI)
        }
        Background::Sky(sky) => daylight(sky, sight),
        Background::CubeMap(map) => cube_map(map, sight),
        Background::Panorama(panorama) => equirectangular(panorama, sight),
        Background::Transparent => return [0.0; 4],
    };
    let [r, g, b] = color.min(DVec3::splat(f64::from(BRIGHTEST))).to_array();
    [r, g, b, 1.0]
}

/// Whether it is read from pictures.
pub fn is_picture(background: &Background) -> bool {
    matches!(background, Background::CubeMap(_) | Background::Panorama(_))
}

/// Haze dims the plain below the horizon by `exp(−HAZE (1/sin − 1))`, the sine that of the angle down.
const HAZE: f64 = 0.01;

/// Above the horizon the sky with its sun; below it the sky at the horizon, and the plain through haze.
fn daylight(sky: &Daylight, sight: DVec3) -> DVec3 {
    let above = DVec3::new(sight.x, sight.y.max(0.0), sight.z).try_normalize().unwrap_or(DVec3::X);
    let is_sun = sight.y > 0.0 && sight.distance(sky.towards_sun) < SUN_RADIUS;
    let sun = if is_sun { sky.disc.as_dvec3() } else { DVec3::ZERO };
    let plain = if sight.y < 0.0 { (HAZE * (1.0 + 1.0 / sight.y)).exp() } else { 0.0 };
    (scattered(sky, above) + sun).lerp(sky.ground.as_dvec3(), plain) + sky.night.as_dvec3()
}

/// Light scattered towards the viewer from a direction that does not point down.
fn scattered(sky: &Daylight, sight: DVec3) -> DVec3 {
    let azimuth = |v: DVec3| DVec2::new(v.x, v.z).try_normalize().unwrap_or(DVec2::NEG_Y);
    let from_sun = azimuth(sight).dot(azimuth(sky.towards_sun)).clamp(-1.0, 1.0);
    let entry = entry(sky, sight.y.sqrt() * last(ROWS), (1.0 - from_sun) / 2.0 * last(COLUMNS));
    let cosine = sight.dot(sky.towards_sun);
    let [molecules, haze] = [0, 3].map(|c| DVec3::new(entry[c], entry[c + 1], entry[c + 2]));
    molecules * rayleigh_phase(cosine) + haze * haze_phase(cosine)
}

/// The sky's table at a place between its rows and columns.
fn entry(sky: &Daylight, row: f64, column: f64) -> [f64; 8] {
    let ((i, s), (j, t)) = (place(row, ROWS), place(column, COLUMNS));
    let at = |i: usize, j: usize, c: usize| f64::from(sky.table[i * COLUMNS + j][c]);
    let across = |i: usize, c: usize| at(i, j, c) * (1.0 - t) + at(i, j + 1, c) * t;
    std::array::from_fn(|c| across(i, c) * (1.0 - s) + across(i + 1, c) * s)
}

/// The line before `x` of `count`, at most the last but one, and how far it is to the next.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the table")]
fn place(x: f64, count: usize) -> (usize, f64) {
    let first = x.floor().clamp(0.0, last(count) - 1.0);
    (first as usize, x - first)
}

fn last(count: usize) -> f64 {
    float(count) - 1.0
}

#[expect(clippy::cast_precision_loss, reason = "sides of tables and pictures are far below 2⁵³")]
fn float(count: usize) -> f64 {
    count as f64
}

/// Source: OpenGL 4.6 specification, table 8.19.
fn cube_map(map: &CubeMap, sight: DVec3) -> DVec3 {
    let level = &map.levels[0];
    let along = |axis: &[i32; 3]| (0..3).map(|c| f64::from(axis[c]) * sight[c]).sum::<f64>();
    let (face, away) = (0..)
        .zip(AXES.each_ref().map(|axes| along(&axes.centre)))
        .fold((0, f64::NEG_INFINITY), |most, face| if face.1 > most.1 { face } else { most });
    let at = |axis: &[i32; 3]| (along(axis) / away + 1.0) / 2.0 * float(level.side) + 0.5;
    let ((x, s), (y, t)) =
        (place(at(&AXES[face].across), level.side + 2), place(at(&AXES[face].down), level.side + 2));
    let wide = level.side + 2;
    let texel = |x: usize, y: usize| texel(&level.texels, (face * wide + y) * wide + x);
    let row = |y: usize| texel(x, y).lerp(texel(x + 1, y), s);
    row(y).lerp(row(y + 1), t)
}

/// The top row is straight up, the centre column along −z, and columns run towards +x.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
fn equirectangular(panorama: &Panorama, sight: DVec3) -> DVec3 {
    let level = &panorama.levels[0];
    let (width, height) = (float(level.width), float(level.height));
    let azimuth = sight.x.atan2(-sight.z);
    let elevation = sight.y.clamp(-1.0, 1.0).asin();
    let x = (azimuth / TAU + 0.5) * width - 0.5;
    let y = (0.5 - elevation * FRAC_1_PI) * height - 0.5;
    let texel = |x: f64, y: f64| {
        let (column, row) = (x.rem_euclid(width).min(width - 1.0), y.clamp(0.0, height - 1.0));
        texel(&level.texels, row as usize * level.width + column as usize)
    };
    let row = |y: f64| texel(x.floor(), y).lerp(texel(x.floor() + 1.0, y), x - x.floor());
    row(y.floor()).lerp(row(y.floor() + 1.0), y - y.floor())
}

fn texel(texels: &Texels, index: usize) -> DVec3 {
    DVec3::from_array(texels.linear(index, &SRGB_DECODE).map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sky::Picture;
    use glam::Vec3;
    use std::sync::Arc;

    /// A picture whose texels are `color` of their column and row.
    fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let texels = (0..width * height).map(|i| color(i % width, i / width)).collect();
        Picture { width, height, texels: Texels::Linear(texels) }
    }

    #[test]
    fn a_gradient_goes_by_elevation() {
        let gradient =
            Background::Gradient { top: Vec3::new(1.0, 0.0, 2.0), bottom: Vec3::new(0.0, 1.0, 2.0) };
        for (deg, share) in [(-90.0, 0.0), (-45.0, 0.25), (0.0, 0.5), (30.0, 2.0 / 3.0), (90.0, 1.0)] {
            let (sin, cos) = f64::to_radians(deg).sin_cos();
            let [r, g, b, a] = radiance(&gradient, DVec3::new(0.6 * cos, sin, -0.8 * cos) * 7.0);
            assert!((r - share).abs() < 1e-9 && (g - 1.0 + share).abs() < 1e-9, "{deg}: {r} {g}");
            assert_eq!((b, a), (2.0, 1.0));
        }
    }

    #[test]
    fn a_cube_of_directions_shows_them() {
        // Texels hold their own directions, scaled so that the largest component is 1, and moved to 0–2:
        // between texels of a face that is linear, so exact.
        let side = 8;
        let faces = AXES.each_ref().map(|axes| {
            picture(side, side, |x, y| {
                let [s, t] = [x, y].map(|i| (2.0 * i as f32 + 1.0) / side as f32 - 1.0);
                std::array::from_fn(|c| {
                    1.0 + axes.centre[c] as f32 + axes.across[c] as f32 * s + axes.down[c] as f32 * t
                })
            })
        });
        let map = Background::CubeMap(Arc::new(CubeMap::new(String::new(), faces).unwrap()));
        for sight in [
            [1.0, 0.3, -0.2],
            [-2.0, 0.5, 0.9],
            [0.1, 3.0, 0.4],
            [0.3, -1.0, 0.2],
            [0.2, -0.6, 1.0],
            [0.4, 0.1, -1.0],
        ] {
            let sight = DVec3::from_array(sight);
            let [r, g, b, _] = radiance(&map, sight);
            let expected = DVec3::ONE + sight / sight.abs().max_element();
            assert!(DVec3::new(r, g, b).distance(expected) < 1e-6, "{sight}: {r} {g} {b}");
        }
    }

    #[test]
    fn a_panorama_begins_behind_and_its_centre_is_ahead() {
        let columns = picture(16, 8, |x, y| [x as f32, y as f32, 0.0]);
        let panorama = Background::Panorama(Arc::new(Panorama::new(String::new(), columns)));
        let at = |azimuth_deg: f64, elevation_deg: f64| {
            let (sin, cos) = azimuth_deg.to_radians().sin_cos();
            let (up, level) = elevation_deg.to_radians().sin_cos();
            let [x, y, ..] = radiance(&panorama, DVec3::new(sin * level, up, -cos * level));
            [x, y]
        };
        for (azimuth, elevation, expected) in [
            (0.0, 0.0, [7.5, 3.5]),
            (22.5, 22.5, [8.5, 2.5]),
            (-90.0, -80.0, [3.5, 7.0]),
            (11.25, 89.0, [8.0, 0.0]),
            // Between the last column and the first.
            (180.0, 11.25, [7.5, 3.0]),
        ] {
            let [x, y] = at(azimuth, elevation);
            assert!((x - expected[0]).abs() < 1e-6 && (y - expected[1]).abs() < 1e-6, "{azimuth}: {x} {y}");
        }
    }

    #[test]
    fn the_sun_stands_where_its_light_comes_from() {
        let towards_sun = DVec3::new(0.3, 0.5, -0.4).normalize();
        let sky = Daylight::new(towards_sun, 3.0);
        let disc = sky.disc.as_dvec3();
        let sky = Background::Sky(Arc::new(sky));
        let aside = towards_sun.any_orthonormal_vector();
        let red = |angle: f64| radiance(&sky, towards_sun + aside * angle.tan())[0];
        let edge = red(SUN_RADIUS * 0.999) - red(SUN_RADIUS * 1.001);
        assert!((edge / disc.x - 1.0).abs() < 1e-3, "{edge} {disc}");
        assert!(radiance(&sky, DVec3::NEG_Y)[2] < radiance(&sky, DVec3::Y)[2]);
    }
}
