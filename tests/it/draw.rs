//! From a document to pixels, by the library alone: no server, no encoder.

use fearless_simd::Level;
use rasterd::limits::Limits;
use rasterd::pipeline::{self, Frame, Hit, Order, Pixels, Work};
use rasterd::plan::{FrameRequest, Output, Plan};
use rasterd::scene::{Document, Files, Scene, compile};
use serde_json::Value;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

static POOL: LazyLock<rayon::ThreadPool> = LazyLock::new(|| pool(2));
static NEVER: AtomicBool = AtomicBool::new(false);

/// A pool of `threads` threads.
pub fn pool(threads: usize) -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("threads to start")
}

/// Two threads at the machine's best SIMD level.
pub fn work() -> Work<'static> {
    work_of(&POOL, Level::new())
}

/// The threads of `pool` at a SIMD level.
pub fn work_of(pool: &rayon::ThreadPool, level: Level) -> Work<'_> {
    Work { pool, cancel: &NEVER, level, order: Order::Rows }
}

/// Compiles a document that needs no files.
pub fn scene(document: &Value) -> Arc<Scene> {
    scene_with(document, &Files::default())
}

/// Compiles a document.
pub fn scene_with(document: &Value, files: &Files) -> Arc<Scene> {
    let document = Document::from_json(document).expect("a valid document");
    let compiled = compile(&document, files, None, &Limits::default()).expect("a scene");
    Arc::new(compiled.scene)
}

/// Plans a frame.
pub fn plan(scene: &Arc<Scene>, request: &FrameRequest) -> Plan {
    Plan::new(scene, request, &Limits::default()).expect("a plan")
}

/// Draws a frame.
pub fn frame(scene: &Arc<Scene>, request: &FrameRequest) -> Frame {
    pipeline::render(&plan(scene, request), &work()).expect("nobody cancels")
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
    pub width: u32,
    pub height: u32,
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

/// The 16-bit values of a frame of values.
pub fn values(frame: Frame) -> Vec<u16> {
    let Pixels::Gray16(values) = frame.pixels else { panic!("a picture of colours") };
    values
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
