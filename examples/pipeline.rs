//! The pipeline by hand: render targets, state and indexed, instanced draw calls, with nothing but the
//! library.
//!
//! `cargo run --release --example pipeline` draws two triangles that cut through each other and a
//! textured box, and an inset that looks into the box from above. It writes `pipeline.png`,
//! `pipeline-depth.png` and `pipeline-ids.png`.

use glam::dcamera::rh::proj::directx::perspective_infinite_reverse;
use glam::dcamera::rh::view::look_at_mat4;
use glam::{DMat4, DVec3, Vec3};
use rasterd::encode;
use rasterd::math::round_to_f32;
use rasterd::math::simd::Level;
use rasterd::model::texture::{ColorSpace, Filter, Image, Texture, Wrap};
use rasterd::pipeline::draw::{DrawCall, Rect, State, Targets};
use rasterd::pipeline::program::{Block, Program};
use rasterd::pipeline::shade::BLOCK;
use rasterd::pipeline::shade::texture::{Coordinates, sample};
use rasterd::pipeline::shader::Outputs;
use rasterd::pipeline::{Cancelled, Frame, Order, Pixels, Stats, Timings, Work};
use rasterd::scene::Cull;
use std::error::Error;
use std::sync::atomic::AtomicBool;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;
/// Pixels drawn for each pixel of the picture, along each side.
const SCALE: u32 = 3;

/// Triangles whose corners have colours: red, green and blue are their varyings.
struct Colored {
    clip_from_world: DMat4,
}

/// The corners of one triangle; each instance is turned a third of a circle about the y axis.
const CORNERS: [([f64; 3], [f32; 3]); 3] = [
    ([-0.9, -0.5, 0.0], [0.9, 0.15, 0.1]),
    ([0.9, -0.5, 0.0], [0.1, 0.75, 0.2]),
    ([0.0, 0.95, 0.0], [0.15, 0.25, 0.95]),
];

impl Program for Colored {
    fn varyings(&self) -> usize {
        3
    }

    fn vertex(&self, vertex: u32, instance: u32, varyings: &mut [f32]) -> [f64; 4] {
        let (position, color) = CORNERS[vertex as usize];
        varyings.copy_from_slice(&color);
        let turned = DMat4::from_rotation_y(f64::from(instance) * 1.9 + 0.4);
        (self.clip_from_world * turned * DVec3::from_array(position).extend(1.0)).to_array()
    }

    fn pixels(&self, _level: Level, block: &Block, out: &mut Outputs) {
        for channel in 0..3 {
            out.colors[0][channel] = block.varyings[channel];
        }
        out.colors[0][3] = [1.0; BLOCK];
    }
}

/// A box with a texture on each side.
struct Textured {
    clip_from_world: DMat4,
    texture: Texture,
}

/// The sides of the box by their outward axis, and the axes of u and v on them.
const SIDES: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::NEG_Z, DVec3::Y],
    [DVec3::NEG_X, DVec3::Z, DVec3::Y],
    [DVec3::Y, DVec3::X, DVec3::NEG_Z],
    [DVec3::NEG_Y, DVec3::X, DVec3::Z],
    [DVec3::Z, DVec3::X, DVec3::Y],
    [DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y],
];

impl Program for Textured {
    /// u, v, and how bright the side is.
    fn varyings(&self) -> usize {
        3
    }

    /// u and v.
    fn differentiated(&self) -> usize {
        2
    }

    fn vertex(&self, vertex: u32, _instance: u32, varyings: &mut [f32]) -> [f64; 4] {
        let [out, along_u, along_v] = SIDES[vertex as usize / 4];
        let (u, v) = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][vertex as usize % 4];
        let position = out * 0.5 + along_u * (u - 0.5) + along_v * (v - 0.5);
        let light = DVec3::new(0.35, 0.8, 0.5).normalize();
        let values = [u, v, 0.35 + 0.65 * out.dot(light).max(0.0)];
        varyings.copy_from_slice(&values.map(round_to_f32));
        let placed = position * 0.8 + DVec3::new(1.35, -0.1, 0.25);
        (self.clip_from_world * placed.extend(1.0)).to_array()
    }

    fn pixels(&self, level: Level, block: &Block, out: &mut Outputs) {
        let [along_u, along_v] = [0, 1].map(|axis| block.derivatives[axis]);
        let coordinates = Coordinates {
            uv: [block.varyings[0], block.varyings[1]],
            per_pixel: [along_u[0], along_v[0], along_u[1], along_v[1]],
        };
        sample(level, &self.texture, &coordinates, block.len(), &mut out.colors[0]);
        for channel in &mut out.colors[0][..3] {
            for (color, brightness) in channel.iter_mut().zip(&block.varyings[2]) {
                *color *= brightness;
            }
        }
    }
}

/// Draws the triangles and the box as `eye` sees them.
fn draw_from(eye: DVec3, targets: &mut Targets, state: &State, work: &Work) -> Result<(), Cancelled> {
    let aspect = f64::from(state.viewport.width) / f64::from(state.viewport.height);
    let view = look_at_mat4(eye, DVec3::new(0.5, 0.05, 0.0), DVec3::Y);
    let clip_from_world = perspective_infinite_reverse(0.7, aspect, 0.1) * view;

    let triangles = DrawCall {
        program: &Colored { clip_from_world },
        vertices: 3,
        triangles: &[[0, 1, 2]],
        instances: 2,
        first_id: 1,
    };
    // Both sides of a triangle are to be seen.
    triangles.draw(targets, &State { cull: Cull::None, ..*state }, work)?;

    let image = Image::checker([Vec3::new(0.06, 0.18, 0.36), Vec3::new(0.8, 0.75, 0.58)], 4);
    let texture = Texture::new(image.into(), ColorSpace::Srgb, Filter::Trilinear, [Wrap::Repeat; 2]);
    let sides = (0..6u32).map(|side| 4 * side);
    let indices: Vec<[u32; 3]> = sides.flat_map(|a| [[a, a + 1, a + 2], [a, a + 2, a + 3]]).collect();
    let textured = DrawCall {
        program: &Textured { clip_from_world, texture },
        vertices: 24,
        triangles: &indices,
        instances: 1,
        first_id: 3,
    };
    textured.draw(targets, state, work)
}

/// A share as 16-bit grey.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float-to-integer cast saturates"
)]
fn grey(share: f32) -> u16 {
    (share * 65535.0) as u16
}

/// The depth target, as reciprocals of the distance, and the id target, in greys: the middle one of the
/// pixels that each of the picture's has.
fn greys(targets: &Targets) -> [Frame; 2] {
    let frame = |values: Vec<u16>| Frame {
        width: WIDTH,
        height: HEIGHT,
        pixels: Pixels::Gray16(values),
        stats: Stats::default(),
        timings: Timings::default(),
        depth_range: None,
    };
    let middles = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| [x, y].map(|c| c * SCALE + SCALE / 2)));
    let middles: Vec<usize> = middles.map(|[x, y]| (y * WIDTH * SCALE + x) as usize).collect();
    // The near plane is at 0.1: nothing here is nearer than 2, of depth 0.05.
    let depth = middles.iter().map(|&at| grey(targets.depth()[at] * 20.0));
    let ids = middles.iter().map(|&at| u16::try_from(targets.ids()[at] * 20_000).unwrap_or(u16::MAX));
    [frame(depth.collect()), frame(ids.collect())]
}

/// Draws the picture, and what depths and ids it has without the inset.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(work: &Work) -> Result<[Frame; 3], Cancelled> {
    let (width, height) = (WIDTH * SCALE, HEIGHT * SCALE);
    let mut targets = Targets::new(width, height, 1);
    targets.clear_color(0, [0.09, 0.1, 0.13, 1.0]);
    let whole = State::new(Rect { x: 0, y: 0, width, height });
    draw_from(DVec3::new(0.9, 0.9, 3.6), &mut targets, &whole, work)?;
    let [depth, ids] = greys(&targets);

    // An inset over it: what is there counts no more, and front faces are left out, so that the box
    // shows its inside.
    targets.clear_depth();
    let inset = Rect { x: width * 2 / 3, y: height / 24, width: width * 3 / 10, height: height * 3 / 10 };
    let inside = State { cull: Cull::Front, ..State::new(inset) };
    draw_from(DVec3::new(0.9, 3.6, 1.2), &mut targets, &inside, work)?;
    Ok([targets.frame(0, SCALE), depth, ids])
}

fn main() -> Result<(), Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let frames = draw(&work)?;
    for (name, frame) in ["pipeline.png", "pipeline-depth.png", "pipeline-ids.png"].iter().zip(&frames) {
        std::fs::write(name, encode::png(frame))?;
        println!("wrote {name}");
    }
    Ok(())
}
