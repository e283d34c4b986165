//! From a document to pixels, by the library alone: no server, no encoder.

pub use super::engine::pool;

use super::engine::Engine;
use crate::limits::Limits;
use crate::math::simd::Level;
use crate::pipeline::{self, Frame, Hit, Order, Pixels, Work};
use crate::plan::{FrameRequest, Output, Plan};
use crate::scene::{Document, Files, Scene, compile};
use crate::settings::Simd;
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// The threads, the SIMD level and the order of the current engine.
#[must_use]
pub fn work() -> Work<'static> {
    Engine::current().work()
}

/// The threads of `pool` at a SIMD level.
#[must_use]
pub fn work_of(pool: &rayon::ThreadPool, level: Level) -> Work<'_> {
    Work { pool, cancel: &NEVER, level, order: Order::Rows }
}

/// The SIMD level of the current engine.
#[must_use]
pub fn level() -> Level {
    Engine::current().level
}

/// Every SIMD level of this machine, with its name; in a build that carries the scalar one, that alone. Such
/// a build is compiled without optimisation, which takes the compiler a tenth of the time.
#[must_use]
pub fn levels() -> Vec<(&'static str, Level)> {
    let names: &[&str] =
        if cfg!(feature = "scalar") { &["scalar"] } else { &["sse2", "sse4.2", "avx2", "avx512", "neon"] };
    names.iter().filter_map(|&name| Some((name, name.parse::<Simd>().ok()?.level()))).collect()
}

/// Compiles a document that needs no files.
///
/// # Panics
/// If it is not valid.
#[must_use]
pub fn scene(document: &Value) -> Arc<Scene> {
    scene_with(document, &Files::default())
}

/// Compiles a document.
///
/// # Panics
/// If it is not valid.
#[must_use]
pub fn scene_with(document: &Value, files: &Files) -> Arc<Scene> {
    let document = Document::from_json(document).unwrap_or_else(|faults| panic!("{faults:?}"));
    let compiled = compile(&document, files, None, &Limits::default());
    Arc::new(compiled.unwrap_or_else(|error| panic!("{error:?}")).scene)
}

/// Pointers to what is wrong with a document.
#[must_use]
pub fn faults(document: &Value) -> Vec<String> {
    let faults = Document::from_json(document).err().unwrap_or_default();
    faults.into_iter().map(|fault| fault.pointer).collect()
}

/// Plans a frame.
///
/// # Panics
/// If the request makes no sense for the scene.
#[must_use]
pub fn plan(scene: &Arc<Scene>, request: &FrameRequest) -> Plan {
    let elide = request.elide.unwrap_or(Engine::current().elide);
    let request = FrameRequest { elide: Some(elide), ..request.clone() };
    Plan::new(scene, &request, &Limits::default()).unwrap_or_else(|error| panic!("{error:?}"))
}

/// Draws a planned frame.
#[must_use]
pub fn render(plan: &Plan) -> Frame {
    pipeline::render(plan, &work()).expect("nobody cancels")
}

/// Draws a frame.
#[must_use]
pub fn frame(scene: &Arc<Scene>, request: &FrameRequest) -> Frame {
    render(&plan(scene, request))
}

/// What is at a pixel's centre.
pub fn pick(scene: &Arc<Scene>, x: u32, y: u32) -> Option<Hit> {
    let plan = plan(scene, &output(Output::Instance));
    pipeline::pick(&plan, x, y, &work()).expect("nobody cancels")
}

/// A request for an output.
pub fn output(output: Output) -> FrameRequest {
    FrameRequest { output, ..FrameRequest::default() }
}

/// A request for a number of samples a pixel.
pub fn samples(samples: u32) -> FrameRequest {
    FrameRequest { samples: Some(samples), ..FrameRequest::default() }
}

/// A picture of colours: sRGB codes and straight alpha, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// Draws a document as it is.
    pub fn of(document: &Value) -> Self {
        Self::new(frame(&scene(document), &FrameRequest::default()))
    }

    /// The pixels of a frame of colours.
    pub fn new(frame: Frame) -> Self {
        let Pixels::Rgba8 { pixels, .. } = frame.pixels else { panic!("a picture of values") };
        Self { width: frame.width, height: frame.height, pixels }
    }

    /// One pixel.
    pub fn at(&self, x: u32, y: u32) -> [u8; 4] {
        self.pixels[(y * self.width + x) as usize]
    }

    /// Every pixel with its column and row.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32, [u8; 4])> {
        self.pixels.iter().zip(0..).map(|(&pixel, i)| (i % self.width, i / self.width, pixel))
    }
}

/// The colours of a document's picture.
#[must_use]
pub fn colors(document: &Value) -> Vec<[u8; 4]> {
    Picture::of(document).pixels
}

/// The 16-bit values of an output of a document.
#[must_use]
pub fn values_of(document: &Value, output: Output) -> Vec<u16> {
    values(frame(&scene(document), &self::output(output)))
}

/// The 16-bit values of a frame of values.
///
/// # Panics
/// If it is one of colours.
#[must_use]
pub fn values(frame: Frame) -> Vec<u16> {
    let Pixels::Gray16(values) = frame.pixels else { panic!("a picture of colours") };
    values
}

/// Every bit of a frame's pixels, so that −0 is not 0 and what is not a number is itself.
#[must_use]
pub fn bytes_of(pixels: &Pixels) -> Vec<u8> {
    match pixels {
        Pixels::Rgba8 { pixels, .. } => pixels.as_flattened().to_vec(),
        Pixels::Rgba32F { pixels, .. } => {
            pixels.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect()
        }
        Pixels::Gray16(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
    }
}

/// Encodes texels as the PNG file that a client would upload.
pub fn png(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = image::RgbaImage::from_fn(width, height, |x, y| image::Rgba(texel(x, y)));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes every byte");
    bytes.into_inner()
}

/// Files with one entry.
pub fn file(name: &str, bytes: Vec<u8>) -> Files {
    let mut files = Files::default();
    files.insert(name, bytes.into()).expect("a sound name");
    files
}
