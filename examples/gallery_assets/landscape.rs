//! Surroundings as functions of the direction that one looks in: a lake in the mountains, a garden out
//! of focus.

use crate::paint::{self, Color, blend, shade};
use glam::{DVec3, dvec3};
use rasterd::scene::demo::noise::{Noise, mix, random, smoothstep};
use std::f64::consts::{PI, TAU};

/// Where the sun stands; the scene's light comes from there.
const SUN: DVec3 = dvec3(0.62, 0.42, -0.66);

/// Texels along a side of a face.
const SIDE: u32 = 768;

/// The lake's noises: made once for all six faces.
#[derive(Debug)]
pub struct Lake {
    clouds: Noise,
    ranges: [Noise; 3],
    rocks: Noise,
    ripples: Noise,
}

/// A range of mountains or hills around the horizon.
#[derive(Clone, Copy, Debug)]
struct Range {
    /// Elevation of its lowest and highest crest, in degrees.
    crest_deg: [f64; 2],
    foot: Color,
    top: Color,
    /// Elevation above which snow lies, in degrees.
    snow_deg: f64,
}

/// Far to near.
const RANGES: [Range; 3] = [
    Range { crest_deg: [2.5, 16.0], foot: [168.0, 190.0, 214.0], top: [108.0, 136.0, 172.0], snow_deg: 8.0 },
    Range { crest_deg: [1.2, 6.5], foot: [122.0, 152.0, 158.0], top: [72.0, 108.0, 110.0], snow_deg: 90.0 },
    Range { crest_deg: [0.3, 2.7], foot: [64.0, 92.0, 62.0], top: [38.0, 66.0, 46.0], snow_deg: 90.0 },
];

impl Lake {
    /// Makes the noises.
    pub fn new() -> Self {
        Self {
            clouds: Noise::new([6, 6], 6, 101),
            ranges: [Noise::new([9, 1], 6, 111), Noise::new([13, 1], 6, 121), Noise::new([19, 1], 7, 131)],
            rocks: Noise::new([48, 24], 4, 141),
            ripples: Noise::new([24, 24], 4, 151),
        }
    }

    /// A face of a cube: the direction through its middle, and those across it and up in the picture.
    pub fn face(&self, [middle, across, up]: [DVec3; 3]) -> Vec<u8> {
        paint::jpeg([SIDE, SIDE], 80, |u, v| {
            let direction = middle + across * (2.0 * u - 1.0) + up * (2.0 * v - 1.0);
            self.color(direction.normalize())
        })
    }

    fn color(&self, direction: DVec3) -> Color {
        if direction.y > -0.004 { self.above(direction) } else { self.water(direction) }
    }

    fn above(&self, direction: DVec3) -> Color {
        let elevation_deg = libm::asin(direction.y.clamp(-1.0, 1.0)).to_degrees();
        let around = 0.5 + libm::atan2(direction.x, -direction.z) / TAU;
        let mut color = self.sky(direction);
        for (range, noise) in RANGES.iter().zip(&self.ranges) {
            color = self
                .range(range, noise, around, elevation_deg)
                .map_or(color, |(paint, cover)| blend(color, paint, cover));
        }
        color
    }

    /// The range's colour and cover at a direction, where it is not below.
    fn range(&self, range: &Range, noise: &Noise, around: f64, elevation_deg: f64) -> Option<(Color, f64)> {
        let [low, high] = range.crest_deg;
        // Noise stays near its mean: stretched, so that there are passes and peaks.
        let crest = mix(low, high, smoothstep(0.25, 0.78, noise.at(around, 0.5)));
        if elevation_deg > crest + 0.2 {
            return None;
        }
        let height = (elevation_deg / high).clamp(0.0, 1.0);
        let rock = self.rocks.at((around * 3.0).fract(), (0.1 + elevation_deg / 24.0).clamp(0.0, 1.0));
        let slope = shade(blend(range.foot, range.top, smoothstep(0.0, 0.7, height)), 0.76 + 0.48 * rock);
        let line = range.snow_deg + 9.0 * (rock - 0.5);
        let snow = smoothstep(line, line + 1.2, elevation_deg) * smoothstep(0.2, 0.4, rock);
        let color = blend(slope, [236.0, 240.0, 248.0], 0.85 * snow);
        Some((color, smoothstep(-0.1, 0.12, crest - elevation_deg)))
    }

    fn sky(&self, direction: DVec3) -> Color {
        const ZENITH: Color = [52.0, 112.0, 186.0];
        const MIDDLE: Color = [128.0, 178.0, 222.0];
        const HORIZON: Color = [228.0, 232.0, 232.0];
        const CLOUD: Color = [252.0, 250.0, 246.0];
        let y = direction.y.max(0.0);
        let clear = blend(blend(HORIZON, MIDDLE, smoothstep(0.0, 0.3, y)), ZENITH, smoothstep(0.15, 0.95, y));
        let to_sun = direction.dot(SUN.normalize()).max(0.0);
        let glow = 0.75 * libm::pow(to_sun, 60.0) + 0.35 * libm::pow(to_sun, 7.0);
        let clear = blend(clear, [255.0, 244.0, 222.0], glow.min(1.0));
        // Clouds lie in a plane: the nearer to the horizon, the more of them behind one another.
        let plane = direction / (y + 0.18) * 0.11;
        let density = self.clouds.at(plane.x.rem_euclid(1.0), plane.z.rem_euclid(1.0));
        let cover = smoothstep(0.5, 0.72, density) * smoothstep(0.02, 0.2, y);
        let lit = shade(CLOUD, 1.04 - 0.2 * smoothstep(0.6, 0.85, density));
        blend(blend(clear, lit, 0.9 * cover), [255.0, 252.0, 240.0], smoothstep(0.9985, 0.9993, to_sun))
    }

    /// What is above, mirrored in ripples, and darker the steeper one looks down.
    fn water(&self, direction: DVec3) -> Color {
        const DEPTH: Color = [22.0, 66.0, 78.0];
        let down = -direction.y;
        let plane = direction / (down + 0.03) * 0.05;
        let wave = self.ripples.at(plane.x.rem_euclid(1.0), (plane.z * 3.0).rem_euclid(1.0)) - 0.5;
        let tilt = 0.09 * wave * (0.15 + down.min(0.5));
        let mirrored = dvec3(direction.x, (down + tilt).abs().max(0.0), direction.z).normalize();
        let grazing = 1.0 - smoothstep(0.0, 0.75, down);
        blend(DEPTH, shade(self.above(mirrored), 0.86), 0.2 + 0.62 * grazing * grazing)
    }
}

/// A garden far out of focus: an equirectangular picture.
pub fn garden() -> Vec<u8> {
    let ground = Noise::new([10, 5], 3, 161);
    let discs: Vec<Disc> = (0..420).map(Disc::random).collect();
    paint::jpeg([1024, 512], 80, |u, v| {
        let mut color = foliage(v, ground.at(u, v));
        for disc in &discs {
            color = disc.over(color, u, v);
        }
        color
    })
}

fn foliage(v: f64, tone: f64) -> Color {
    const SHADE: Color = [26.0, 44.0, 30.0];
    const LAWN: Color = [92.0, 124.0, 62.0];
    const HEDGE: Color = [52.0, 84.0, 48.0];
    const SKY: Color = [214.0, 230.0, 234.0];
    let low = blend(LAWN, HEDGE, smoothstep(0.3, 0.5, v));
    let high = blend(low, SKY, smoothstep(0.56, 0.8, v + 0.25 * (tone - 0.5)));
    blend(high, SHADE, 0.5 * smoothstep(0.5, 0.25, 1.0 - tone) * smoothstep(0.9, 0.5, v))
}

/// A point of light out of focus.
#[derive(Clone, Copy, Debug)]
struct Disc {
    u: f64,
    v: f64,
    radius: f64,
    color: Color,
    strength: f64,
}

impl Disc {
    fn random(i: u32) -> Self {
        const COLORS: [Color; 6] = [
            [236.0, 238.0, 200.0],
            [186.0, 208.0, 120.0],
            [128.0, 168.0, 84.0],
            [88.0, 132.0, 72.0],
            [246.0, 214.0, 178.0],
            [220.0, 150.0, 166.0],
        ];
        let number = |k: u32| random(i, k, 171);
        #[expect(clippy::cast_possible_truncation, reason = "0 to 5")]
        let color = COLORS[((number(3) * 6.0) as usize).min(5)];
        let v = 0.36 + 0.4 * (number(1) + number(5)) / 2.0;
        Self {
            u: number(0),
            v,
            radius: mix(0.008, 0.03, number(2)),
            color,
            strength: mix(0.12, 0.55, number(4)),
        }
    }

    /// Lays it over `below`; it is a little brighter at its border, as behind a real lens.
    fn over(&self, below: Color, u: f64, v: f64) -> Color {
        let across = (u - self.u + 0.5).rem_euclid(1.0) - 0.5;
        // One unit of u is twice one of v; towards the poles a disc is stretched along u.
        let across = across * 2.0 * libm::cos(PI * (self.v - 0.5));
        let away = (across * across + (v - self.v) * (v - self.v)).sqrt() / (2.0 * self.radius);
        if away > 1.0 {
            return below;
        }
        let rim = 0.75 + 0.25 * smoothstep(0.7, 0.95, away);
        blend(below, self.color, self.strength * rim * (1.0 - smoothstep(0.9, 1.0, away)))
    }
}
