//! Wavefront OBJ files of curved surfaces and boxes.

use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::fmt::Write;

/// An OBJ file as it grows. Equal positions and coordinates are written once, so that surfaces close
/// at their seams and poles.
#[derive(Debug, Default)]
pub struct Obj {
    positions: Lines,
    /// `None`: the file has no texture coordinates.
    uvs: Option<Lines>,
    faces: String,
    library: &'static str,
}

/// Distinct lines of text in the order they came.
#[derive(Debug, Default)]
struct Lines {
    numbers: HashMap<String, usize>,
    text: String,
}

impl Lines {
    /// The number of `line`, from 1.
    fn number(&mut self, line: String) -> usize {
        let next = self.numbers.len() + 1;
        *self.numbers.entry(line).or_insert_with_key(|line| {
            self.text.push_str(line);
            next
        })
    }
}

impl Obj {
    /// A file without texture coordinates, half as long.
    pub fn bare() -> Self {
        Self::default()
    }

    /// A file with texture coordinates.
    pub fn textured() -> Self {
        Self { uvs: Some(Lines::default()), ..Self::default() }
    }

    /// The file that takes its materials from `library`.
    pub fn with_library(self, library: &'static str) -> Self {
        Self { library, ..self }
    }

    /// What follows is of this material.
    pub fn material(&mut self, name: &str) -> &mut Self {
        self.faces.push_str(&format!("usemtl {name}\n"));
        self
    }

    /// A surface over the unit square, `steps` along u and v, seen from the side where u runs right
    /// and v up. The coordinates are (u, v) times `repeat`.
    pub fn surface(&mut self, steps: [u32; 2], repeat: DVec2, at: impl Fn(f64, f64) -> DVec3) -> &mut Self {
        let [columns, rows] = steps.map(f64::from);
        for (x, y) in (0..steps[1]).flat_map(|y| (0..steps[0]).map(move |x| (x, y))) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| {
                let uv = DVec2::new(f64::from(x) / columns, f64::from(y) / rows);
                (at(uv.x, uv.y), uv * repeat)
            });
            self.face(&corners);
        }
        self
    }

    /// A polygon, counter-clockwise, of positions with their texture coordinates.
    pub fn face(&mut self, corners: &[(DVec3, DVec2)]) -> &mut Self {
        let mut numbers: Vec<(usize, String)> = corners
            .iter()
            .map(|(p, uv)| {
                let position =
                    self.positions.number(format!("v {} {} {}\n", short(p.x), short(p.y), short(p.z)));
                let uv = self.uvs.as_mut().map_or_else(String::new, |uvs| {
                    format!("/{}", uvs.number(format!("vt {} {}\n", short(uv.x), short(uv.y))))
                });
                (position, format!("{position}{uv}"))
            })
            .collect();
        // At a pole two corners of a quad are one.
        numbers.dedup_by_key(|(position, _)| *position);
        if numbers.len() > 1 && numbers[0].0 == numbers[numbers.len() - 1].0 {
            numbers.pop();
        }
        if numbers.len() > 2 {
            let corners: Vec<&str> = numbers.iter().map(|(_, corner)| corner.as_str()).collect();
            self.faces.push_str(&format!("f {}\n", corners.join(" ")));
        }
        self
    }

    /// A solid of revolution about y of a profile of (radius, height) from below to above, seen from
    /// outside; u runs around from the back, v along the profile.
    pub fn lathe(&mut self, segments: u32, profile: &[DVec2]) -> &mut Self {
        self.turned(segments, profile, |point, _| point)
    }

    /// A lathe whose profile `carve` changes from angle to angle (radians, 0 in front).
    pub fn turned(
        &mut self,
        segments: u32,
        profile: &[DVec2],
        carve: impl Fn(DVec2, f64) -> DVec2,
    ) -> &mut Self {
        let rows = u32::try_from(profile.len() - 1).expect("invariant: a short profile");
        self.surface([segments, rows], DVec2::ONE, |u, v| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "v is a row of the profile over their number"
            )]
            let point = profile[(v * f64::from(rows)).round() as usize];
            let angle = TAU * (u - 0.5);
            let carved = carve(point, angle);
            DVec3::new(carved.x * libm::sin(angle), carved.y, carved.x * libm::cos(angle))
        })
    }

    /// A box between two corners; every side shows the unit square times `repeat`.
    pub fn cuboid(&mut self, min: DVec3, max: DVec3, repeat: DVec2) -> &mut Self {
        let (size, corner) = (max - min, |x: f64, y: f64, z: f64| min + (max - min) * DVec3::new(x, y, z));
        debug_assert!(size.min_element() > 0.0);
        self.surface([1, 1], repeat, |u, v| corner(u, v, 1.0))
            .surface([1, 1], repeat, |u, v| corner(1.0 - u, v, 0.0))
            .surface([1, 1], repeat, |u, v| corner(1.0, v, 1.0 - u))
            .surface([1, 1], repeat, |u, v| corner(0.0, v, u))
            .surface([1, 1], repeat, |u, v| corner(u, 1.0, 1.0 - v))
            .surface([1, 1], repeat, |u, v| corner(u, 0.0, v))
    }

    /// The file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut text = String::from("# Written by examples/gallery_assets\n");
        if !self.library.is_empty() {
            text.push_str(&format!("mtllib {}\n", self.library));
        }
        let uvs = self.uvs.as_ref().map_or("", |uvs| &uvs.text);
        for part in [&self.positions.text, uvs, &self.faces] {
            text.push_str(part);
        }
        text.into_bytes()
    }
}

/// Four decimals, without zeros at the end.
fn short(x: f64) -> String {
    let mut text = String::new();
    write!(text, "{x:.4}").expect("invariant: a string takes all that is written");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A smooth curve through `points` (Catmull–Rom), `steps` between two of them; it begins and ends
/// straight.
pub fn curve(points: &[[f64; 2]], steps: u32) -> Vec<DVec2> {
    let point = |i: usize| DVec2::from_array(points[i.min(points.len() - 1)]);
    let mut curve = vec![point(0)];
    for i in 0..points.len() - 1 {
        let (a, b, c, d) = (point(i.saturating_sub(1)), point(i), point(i + 1), point(i + 2));
        for step in 1..=steps {
            let t = f64::from(step) / f64::from(steps);
            let (t2, t3) = (t * t, t * t * t);
            curve.push(
                0.5 * (2.0 * b
                    + (c - a) * t
                    + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2
                    + (3.0 * b - a - 3.0 * c + d) * t3),
            );
        }
    }
    curve
}

/// A profile of several smooth curves that meet in corners.
pub fn profile(curves: &[&[[f64; 2]]], steps: u32) -> Vec<DVec2> {
    let mut profile: Vec<DVec2> = Vec::new();
    for points in curves {
        let curve = curve(points, steps);
        let skip = usize::from(profile.last() == curve.first());
        profile.extend(&curve[skip..]);
    }
    profile
}
