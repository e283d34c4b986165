//! Interpolated attributes, straight from the stage that makes them.

use crate::pipeline::geometry::bin::TileGrid;
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::geometry::{self, Bins};
use crate::pipeline::samples;
use crate::pipeline::shade::light::LightSource;
use crate::pipeline::shade::varyings::{Records, Source, Varyings, interpolate};
use crate::pipeline::shade::{self, Fragment, Lighting, SurfaceShader};
use crate::pipeline::shader::{Outputs, PixelShader, Visible};
use crate::plan::{Elisions, Plan};
use crate::report::random::Random;
use crate::report::selftest::instruments::draw::{level, work};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// Points a triangle is looked at.
const POINTS: usize = 8;

/// Many triangles as one mesh; the picture is 256 × 256 px, its field of view 90°, so that x/w = 1
/// is at 128 px.
pub fn document(positions: &[DVec3], extra: Value) -> Value {
    let positions: Vec<_> = positions.iter().map(|p| p.to_array()).collect();
    let mut mesh = json!({ "type": "triangles", "positions": positions });
    mesh.as_object_mut().expect("a mesh").extend(extra.as_object().cloned().unwrap_or_default());
    json!({
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1], "fov_y_deg": 90, "near": 1e-3 },
        "textures": { "t": { "checker": {} } },
        "materials": { "m": { "diffuse_map": "t", "double_sided": true } },
        "meshes": { "m": mesh },
        "instances": { "i": { "mesh": "m", "material": "m" } },
        "lights": {},
        "render": { "width": 256, "height": 256, "samples": 1 },
    })
}

/// The geometry of a plan.
pub fn bins(plan: &Plan) -> Bins {
    let grid = TileGrid::new(&plan.view, 6, samples::pattern(1));
    geometry::run(&plan.items, &plan.view, grid, Elisions::ALL, &work()).expect("nobody cancels")
}

/// The edge functions of the corners at p, exact.
pub fn weights(t: &Triangle, p: [i32; 2]) -> [i128; 3] {
    let edge = |i: usize, j: usize| {
        let d = |a: i32, b: i32| i128::from(a) - i128::from(b);
        d(t.x[j], t.x[i]) * d(p[1], t.y[i]) - d(t.y[j], t.y[i]) * d(p[0], t.x[i])
    };
    [edge(1, 2), edge(2, 0), edge(0, 1)]
}

/// A sub-pixel inside a triangle.
#[expect(clippy::cast_possible_truncation, reason = "between coordinates of the triangle")]
fn inside(t: &Triangle, random: &mut Random) -> Option<[i32; 2]> {
    let (a, b) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
    let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
    let mix = |c: [i32; 3]| {
        let c = c.map(f64::from);
        (c[0] + (c[1] - c[0]) * a + (c[2] - c[0]) * b).round() as i32
    };
    let p = [mix(t.x), mix(t.y)];
    weights(t, p).iter().all(|w| *w >= 0).then_some(p)
}

/// Calls `visit(triangle, points, source)` for every triangle of the plan, with points inside of it.
fn visit(
    plan: &Plan,
    random: &mut Random,
    anchor: DVec3,
    mut visit: impl FnMut(Visible, &[[i32; 2]], Source),
) {
    let bins = bins(plan);
    for chunk in &bins.chunks {
        for t in &chunk.triangles {
            let draw = &plan.draws[t.draw as usize];
            let item = &plan.items[draw.item as usize];
            let source = Source::new(item, &draw.surface, &[], &plan.view, anchor);
            let points: Vec<_> = (0..POINTS).filter_map(|_| inside(t, random)).collect();
            if !points.is_empty() {
                visit((chunk, t), &points, source);
            }
        }
    }
}

fn fragments(points: &[[i32; 2]]) -> Vec<Fragment> {
    points.iter().map(|&[x, y]| Fragment { record: 0, target: 0, x, y }).collect()
}

/// Calls `check(triangle, point, lane, varyings)` for points inside every triangle of the plan.
pub fn look(
    plan: &Plan,
    random: &mut Random,
    mut check: impl FnMut(&Triangle, [i32; 2], usize, &Varyings),
) -> usize {
    let mut looked = 0;
    visit(plan, random, DVec3::ZERO, |visible, points, source| {
        let (mut records, mut varyings) = (Records::new(&source), Varyings::default());
        records.push(&source, visible);
        interpolate(level(), &records, &source, &fragments(points), &mut varyings);
        for (lane, &point) in points.iter().enumerate() {
            check(visible.1, point, lane, &varyings);
            looked += 1;
        }
    });
    looked
}

/// Calls `check(triangle, point, radiance)` for points inside every triangle of the plan, lit by its
/// lights without shadows.
pub fn shaded(
    plan: &Plan,
    random: &mut Random,
    mut check: impl FnMut(&Triangle, [i32; 2], [f32; 3]),
) -> usize {
    let anchor = shade::anchor(plan.scene.bounds(plan.t), &plan.view);
    let lights = plan.lights.iter().map(|light| LightSource::new(light, &plan.view, anchor)).collect();
    let lighting =
        Lighting { ambient: plan.ambient, lights, maps: &[], view: &plan.view, anchor, elide: Elisions::ALL };
    let (mut scratch, mut out, mut looked) = (shade::Scratch::default(), Outputs::default(), 0);
    visit(plan, random, anchor, |visible, points, source| {
        let shader = SurfaceShader { source, lighting: &lighting };
        let mut shading = shader.open(&mut [visible].into_iter());
        shading.shade(level(), &fragments(points), &mut scratch, &mut out);
        for (lane, &point) in points.iter().enumerate() {
            check(visible.1, point, [0, 1, 2].map(|channel| out.colors[0][channel][lane]));
            looked += 1;
        }
    });
    looked
}

/// Positions of three corners whose distances differ by up to `ratio` and whose places on the screen
/// by up to `extent` px; the first is in the picture.
pub fn corners(random: &mut Random, ratio: f64, extent: f64) -> [DVec3; 3] {
    let corner = |random: &mut Random, extent: f64, w: f64| {
        let screen = DVec2::new(random.between(-extent, extent), random.between(-extent, extent));
        DVec3::new(screen.x / 128.0 * w, screen.y / 128.0 * w, -w)
    };
    let w = [1.0, random.magnitude(1.0, ratio), ratio];
    let first = usize::from(random.bits().to_le_bytes()[0]) % 3;
    [0, 1, 2].map(|i| corner(random, if i == 0 { 100.0 } else { extent }, w[(i + first) % 3]))
}
