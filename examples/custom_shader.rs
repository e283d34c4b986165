//! A shader of one's own: toon shading on a waving flag.
//!
//! `cargo run --release --example custom_shader` writes `flag.png` and `flag-normals.png`: a vertex part
//! that moves the vertices of a grid, and a pixel part that paints three tones, writes two targets, and
//! discards what the wind has torn off.

use glam::dcamera::rh::proj::directx::perspective_infinite_reverse;
use glam::dcamera::rh::view::look_at_mat4;
use glam::{DMat4, DVec2, DVec3, Vec3};
use rasterd::encode;
use rasterd::math::simd::Level;
use rasterd::pipeline::draw::{DrawCall, Rect, State, Targets};
use rasterd::pipeline::program::{Block, Program};
use rasterd::pipeline::shader::Outputs;
use rasterd::pipeline::{Cancelled, Frame, Order, Work};
use rasterd::scene::Cull;
use std::error::Error;
use std::sync::atomic::AtomicBool;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;
/// Pixels drawn for each pixel of the picture, along each side: a draw call has one sample a pixel.
const SCALE: u32 = 4;

/// Quads of the flag's grid.
const COLUMNS: u32 = 60;
const ROWS: u32 = 24;

/// A flag at a moment in the wind, seen by a camera.
struct Flag {
    clip_from_world: DMat4,
    seconds: f64,
}

impl Flag {
    /// A point of the cloth, `uv` in 0–1: bound to its pole at u = 0, waving the more the farther from it.
    fn point(&self, uv: DVec2) -> DVec3 {
        let phase = 9.0 * uv.x + 1.5 * uv.y - 5.0 * self.seconds;
        let sway = 0.22 * uv.x.sqrt() * libm::sin(phase);
        DVec3::new(1.6 * uv.x, uv.y - 0.12 * uv.x * uv.x, sway)
    }

    /// Unit normal of the cloth, from differences along u and v.
    fn normal(&self, uv: DVec2) -> DVec3 {
        let along = |step: DVec2| self.point(uv + step) - self.point(uv - step);
        along(DVec2::new(1e-4, 0.0)).cross(along(DVec2::new(0.0, 1e-4))).normalize()
    }
}

impl Program for Flag {
    /// A normal and (u, v).
    fn varyings(&self) -> usize {
        5
    }

    fn discards(&self) -> bool {
        true
    }

    fn vertex(&self, vertex: u32, _instance: u32, varyings: &mut [f32]) -> [f64; 4] {
        let (column, row) = (vertex % (COLUMNS + 1), vertex / (COLUMNS + 1));
        let uv = DVec2::new(f64::from(column) / f64::from(COLUMNS), f64::from(row) / f64::from(ROWS));
        varyings[..3].copy_from_slice(&self.normal(uv).as_vec3().to_array());
        varyings[3..].copy_from_slice(&uv.as_vec2().to_array());
        (self.clip_from_world * self.point(uv).extend(1.0)).to_array()
    }

    fn pixels(&self, _level: Level, block: &Block, out: &mut Outputs) {
        let light = Vec3::new(0.75, 0.35, 0.55).normalize();
        for i in 0..block.len() {
            let facing = if block.back >> i & 1 == 1 { -1.0 } else { 1.0 };
            let normal = Vec3::from_array([0, 1, 2].map(|axis| block.varyings[axis][i])).normalize() * facing;
            let [u, v] = [3, 4].map(|varying| block.varyings[varying][i]);
            if is_torn(u, v) {
                out.discarded |= 1 << i;
            }
            let color = cloth(u, v) * tone(normal.dot(light));
            let shown = normal * 0.5 + 0.5;
            for (target, color) in out.colors.iter_mut().zip([color, shown]) {
                for (channel, value) in target.iter_mut().zip(color.extend(1.0).to_array()) {
                    channel[i] = value;
                }
            }
        }
    }
}

/// The swallow tail at the free end.
fn is_torn(u: f32, v: f32) -> bool {
    u > 0.78 + 0.44 * (v - 0.5).abs()
}

/// Three stripes and a disc.
fn cloth(u: f32, v: f32) -> Vec3 {
    let from_centre = [(u - 0.36) * 1.6, v - 0.5];
    if from_centre[0] * from_centre[0] + from_centre[1] * from_centre[1] < 0.27 * 0.27 {
        Vec3::new(0.95, 0.72, 0.12)
    } else if (v - 0.5).abs() < 0.17 {
        Vec3::new(0.9, 0.88, 0.82)
    } else {
        Vec3::new(0.62, 0.05, 0.07)
    }
}

/// Light in three tones, as a comic has it.
fn tone(cosine: f32) -> f32 {
    if cosine > 0.8 {
        1.0
    } else if cosine > 0.4 {
        0.62
    } else {
        0.3
    }
}

/// Two triangles for each quad of the grid.
fn grid() -> Vec<[u32; 3]> {
    let quads = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| row * (COLUMNS + 1) + column));
    let above = COLUMNS + 1;
    quads.flat_map(|a| [[a, a + 1, a + above + 1], [a, a + above + 1, a + above]]).collect()
}

/// Draws the flag: its colours and its normals.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(work: &Work) -> Result<[Frame; 2], Cancelled> {
    let aspect = f64::from(WIDTH) / f64::from(HEIGHT);
    let view = look_at_mat4(DVec3::new(0.45, 0.85, 2.6), DVec3::new(0.78, 0.46, 0.0), DVec3::Y);
    // Reversed depth and an infinite far plane, as the pipeline has it.
    let projection = perspective_infinite_reverse(0.52, aspect, 0.1);
    let flag = Flag { clip_from_world: projection * view, seconds: 0.4 };

    let (width, height) = (WIDTH * SCALE, HEIGHT * SCALE);
    let mut targets = Targets::new(width, height, 2);
    targets.clear_color(0, [0.36, 0.6, 0.85, 1.0]);
    targets.clear_color(1, [0.0, 0.0, 0.0, 1.0]);
    let state = State { cull: Cull::None, ..State::new(Rect { x: 0, y: 0, width, height }) };
    let call = DrawCall {
        program: &flag,
        vertices: (COLUMNS + 1) * (ROWS + 1),
        triangles: &grid(),
        instances: 1,
        first_id: 1,
    };
    call.draw(&mut targets, &state, work)?;
    Ok([0, 1].map(|target| targets.frame(target, SCALE)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let [colors, normals] = draw(&work)?;
    std::fs::write("flag.png", encode::png(&colors))?;
    std::fs::write("flag-normals.png", encode::png(&normals))?;
    println!("wrote flag.png and flag-normals.png");
    Ok(())
}
