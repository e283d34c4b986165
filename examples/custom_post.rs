//! A post effect of one's own: the picture as a halftone print, ink on cream paper.
//!
//! `cargo run --release --example custom_post` writes `halftone.png`. The effect runs after those of the
//! scene's `post`, through the trait that they are made of: it writes luminance into a spare plane, makes a
//! dot of what lies around each place of a screen, and prints the dots over the picture.

use glam::{Vec2, Vec3};
use rasterd::encode;
use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::post::{Effect, LinearFrame, Plane, write_rows};
use rasterd::pipeline::{self, Cancelled, Frame, Order, Work};
use rasterd::plan::{FrameRequest, Plan};
use rasterd::scene::{self, Document, Files};
use serde_json::json;
use std::error::Error;
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI};
use std::sync::{Arc, atomic::AtomicBool};

/// From one dot to the next along a line of the screen, in pixels; the lines lie square to it. Whole
/// numbers put every dot at the same place in its pixel: all dots of a tone look alike.
const STEP: Vec2 = Vec2::new(4.0, 3.0);
/// Points along each side of a cell whose tones make its dot.
const POINTS: u8 = 5;
/// The least share of a cell that a press can ink.
const SMALLEST_DOT: f32 = 0.03;

/// #f7efdc and #1d1a33, linear.
const PAPER: Vec3 = Vec3::new(0.93, 0.863, 0.716);
const INK: Vec3 = Vec3::new(0.0123, 0.0103, 0.0331);

/// A screen of round dots, each as large as what lies under its cell is dark.
struct Halftone;

impl Effect for Halftone {
    /// For luminance.
    fn spare_planes(&self) -> usize {
        1
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let size = [frame.width, frame.height];
        let LinearFrame { planes, spare, .. } = frame;
        let luminance = &mut spare[..1];
        write_rows(luminance, work, |y, rows| {
            let [r, g, b] = [0, 1, 2].map(|channel: usize| planes[channel].row(y));
            for (x, luminance) in rows[0].iter_mut().enumerate() {
                *luminance = (0.2126 * r[x] + 0.7152 * g[x] + 0.0722 * b[x]).clamp(0.0, 1.0);
            }
        })?;
        let screen = Screen::new(&luminance[0], size, work)?;
        write_rows(planes, work, |y, rows| {
            for x in 0..size[0] {
                let printed = PAPER.lerp(INK, screen.ink(centre(x, y)));
                // Alpha, if there is one, is 1: paper is opaque.
                for (row, value) in rows.iter_mut().zip(printed.extend(1.0).to_array()) {
                    row[x] = value;
                }
            }
        })
    }
}

/// Where a pixel's centre lies.
#[expect(clippy::cast_precision_loss, reason = "a picture has at most 2¹⁴ pixels a side")]
fn centre(x: usize, y: usize) -> Vec2 {
    Vec2::new(x as f32, y as f32) + 0.5
}

/// From pixels to cells of the screen.
fn cell_from_pixel(pixel: Vec2) -> Vec2 {
    Vec2::new(pixel.dot(STEP), pixel.dot(STEP.perp())) / STEP.length_squared()
}

/// And back.
fn pixel_from_cell(cell: Vec2) -> Vec2 {
    STEP * cell.x + STEP.perp() * cell.y
}

/// The radii, in cells, of all dots that reach into a picture. Dots lie at whole places of the screen.
struct Screen {
    /// The place of the first.
    first: Vec2,
    columns: usize,
    radii: Vec<f32>,
}

impl Screen {
    /// Makes the dots of a picture of which `gray` holds the luminance.
    fn new(gray: &Plane, [width, height]: [usize; 2], work: &Work) -> Result<Self, Cancelled> {
        let corners = [(0, 0), (width, 0), (0, height), (width, height)];
        let corners = corners.map(|(x, y)| cell_from_pixel(centre(x, y)));
        let [least, most] = [Vec2::min, Vec2::max].map(|most| corners.into_iter().fold(corners[0], most));
        // Dots of the cells around reach in too.
        let first = least.floor() - 1.0;
        let [columns, rows] = (most.floor() + 3.0 - first).to_array().map(whole);
        let pixel = |at: Vec2| gray.row(whole(at.y).min(height - 1))[whole(at.x).min(width - 1)];
        let radii = work.map(
            (0..rows).collect(),
            || (),
            |(), row| -> Vec<f32> {
                let cells = (0..columns).map(|column| first + centre(column, row) - 0.5);
                cells.map(|cell| radius(mean(cell, pixel))).collect()
            },
        )?;
        Ok(Self { first, columns, radii: radii.concat() })
    }

    /// The share of the pixel at `place` that is inked: all of it half a pixel inside a dot's edge, nothing
    /// half a pixel outside.
    fn ink(&self, place: Vec2) -> f32 {
        let place = cell_from_pixel(place) - self.first;
        let corner = place.floor();
        let around = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| corner + Vec2::new(x, y));
        let inside =
            around.map(|dot| self.radii[whole(dot.y) * self.columns + whole(dot.x)] - dot.distance(place));
        let deepest = inside.into_iter().fold(f32::NEG_INFINITY, f32::max);
        (deepest * STEP.length() + 0.5).clamp(0.0, 1.0)
    }
}

/// The mean of points spread over the cell around `cell`; the picture's border repeats.
fn mean(cell: Vec2, pixel: impl Fn(Vec2) -> f32) -> f32 {
    let side = f32::from(POINTS);
    let along = |i: u8| (f32::from(i) + 0.5) / side - 0.5;
    let points = (0..POINTS).flat_map(|y| (0..POINTS).map(move |x| Vec2::new(along(x), along(y))));
    points.map(|point| pixel(pixel_from_cell(cell + point))).sum::<f32>() / (side * side)
}

/// The radius, in cells, of a dot that shows a luminance of 0–1.
fn radius(luminance: f32) -> f32 {
    // Light that enters the paper between dots is lost under them: they look larger than they are.
    // Source: J. Yule and W. Nielsen, "The Penetration of Light into Paper", 1951, n = 2.
    let area = 1.0 - luminance.sqrt();
    if area < SMALLEST_DOT {
        f32::NEG_INFINITY
    } else if area < FRAC_PI_4 {
        (area / PI).sqrt()
    } else {
        // Neighbours have met. The gap between four of them is about as wide as its area's root.
        let gap = ((1.0 - area) / (1.0 - FRAC_PI_4)).sqrt();
        FRAC_1_SQRT_2 + (0.5 - FRAC_1_SQRT_2) * gap
    }
}

/// A number as an index; what is negative is 0.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
fn whole(number: f32) -> usize {
    number as usize
}

/// Draws a teapot on `width` × `height` pixels, and prints it.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(width: u32, height: u32, work: &Work) -> Result<Frame, Cancelled> {
    let json = json!({
        "camera": { "position": [0.9, 1.45, 3.6], "target": [0.24, 0.37, 0.1], "fov_y_deg": 23.5 },
        "environment": { "ambient": [0.14, 0.14, 0.14] },
        "materials": {
            "floor": { "diffuse": [1, 1, 1] },
            "glaze": { "diffuse": "#9c9c9c", "specular": [0.9, 0.9, 0.9], "shininess": 40, "double_sided": true },
            "lacquer": { "diffuse": "#3c3c3c", "specular": [0.8, 0.8, 0.8], "shininess": 40 },
        },
        "meshes": {
            "ball": { "type": "sphere", "radius": 0.2 },
            "floor": { "type": "plane", "size": [2000, 2000] },
            "pot": { "type": "teapot", "segments": 16 },
        },
        "instances": {
            "ball": { "mesh": "ball", "material": "lacquer", "translation": [0.62, 0.2, 0.62] },
            "floor": { "mesh": "floor", "material": "floor" },
            "pot": { "mesh": "pot", "material": "glaze", "translation": [0, 0.5, 0], "rotation_deg": [0, -20, 0] },
        },
        "lights": { "sun": { "type": "directional", "direction": [0.7, -0.9, -0.45], "intensity": 1.05, "shadow": { "filter": "pcf" } } },
        "post": [{ "type": "sharpen" }, { "type": "vignette", "amount": 0.4 }],
        "render": { "width": width, "height": height },
    });
    let limits = Limits::default();
    let document = Document::from_json(&json).expect("a sound document");
    let scene = scene::compile(&document, &Files::default(), None, &limits).expect("a sound scene").scene;
    let plan = Plan::new(&Arc::new(scene), &FrameRequest::default(), &limits).expect("a small picture");
    pipeline::render_with(&plan, &[&Halftone], work)
}

fn main() -> Result<(), Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    std::fs::write("halftone.png", encode::png(&draw(480, 320, &work)?))?;
    println!("wrote halftone.png");
    Ok(())
}
