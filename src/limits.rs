//! Every bound on input, with its reason and the setting that moves it.

/// Largest magnitude of a coordinate, `f32::MAX / 16`: clipping, dividing and scaling it cannot
/// overflow (Direct3D 11.3 functional specification, 15.16). Fixed.
pub const MAX_COORDINATE: f64 = 3.402_823_466_385_288_6e38 / 16.0;

/// Corners of one face of an OBJ file: splitting a concave polygon takes quadratic time. Fixed.
pub const MAX_POLYGON_CORNERS: usize = 16_384;

/// Tests for all concave faces of one OBJ file together, about a second's worth. Fixed.
pub const MAX_POLYGON_TESTS: u64 = 1 << 28;

/// Triangles of a mesh: as many as have corners that a u32 can count, with one index to spare that
/// says "none". Fixed.
pub const MAX_TRIANGLES: usize = (u32::MAX / 3 - 1) as usize;

/// Steps along either direction of a built-in shape: 2048² quads are eight million triangles, more
/// than most pictures have pixels for. Fixed.
pub const MAX_SHAPE_SEGMENTS: u32 = 2048;

/// Steps along a side of each of the teapot's 32 patches: four million triangles. Fixed.
pub const MAX_TEAPOT_SEGMENTS: u32 = 256;

/// Fields of a chequer along a side: each has a texel of its own in an image of 2048 a side. Fixed.
pub const MAX_CHECKER_CELLS: u32 = 2048;

/// Radiance of a colour times an intensity: far above what any picture resolves (it is clamped to
/// 65504), and products of two stay finite in f32. What is above counts as this. Fixed.
pub const MAX_RADIANCE: f64 = 1e18;

/// Characters of a name: what still fits a log line and a header. Fixed.
pub const MAX_NAME_CHARS: usize = 128;

/// Bytes of a file's name: what file systems take. Fixed.
pub const MAX_FILE_NAME_BYTES: usize = 255;

/// Bytes of a file's name in a material: with its path, and the options that may stand behind it,
/// for which it is searched. Fixed.
pub const MAX_MAP_NAME_BYTES: usize = 1024;

/// Material libraries that one OBJ file may name: an entry is a few dozen times as large in memory as
/// in the file. Fixed.
pub const MAX_MATERIAL_LIBRARIES: usize = 1024;

/// Instances of one scene: a picture of instances has 16 bits a pixel, of which 0 is the background. Fixed.
pub const MAX_INSTANCES: usize = u16::MAX as usize;

/// Notes that one file may give; the rest is counted. Fixed.
pub const MAX_NOTES: usize = 64;

/// Faults told of one document: a damaged array of a million numbers needs no million messages. Fixed.
pub const MAX_FAULTS: usize = 256;

/// Words compared with a wrong one: a suggestion is no reason to spend a second. Fixed.
pub const MAX_SUGGESTION_CANDIDATES: usize = 1000;

/// Levels of nesting that a merge patch may have; a document has fewer, and `serde_json` itself stops
/// at 128. Fixed.
pub const MAX_PATCH_DEPTH: usize = 64;

/// Vertices that are transformed for exact bounds in one compilation, about a second's work: a small
/// document can place a large mesh often. What is beyond keeps the bounds of its turned box. Fixed.
pub const MAX_MEASURED_VERTICES: usize = 1 << 27;

/// Frames of a turntable: one for each degree. More would only last longer. Fixed.
pub const MAX_TURNTABLE_FRAMES: u32 = 360;

/// Bounds on what a client may ask for. A value over its bound is a 413 that names limit, value
/// and setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a request body (`RASTERD_MAX_BODY_BYTES`): a scene with its textures.
    pub body_bytes: u64,
    /// Pixels along a side of a picture: beyond, snapped coordinates leave the guard band's 24.8
    /// range. Fixed.
    pub picture_side: u32,
    /// Pixels of a picture: one is held as 4 bytes, or 16 on its way. Fixed.
    pub picture_pixels: u64,
    /// Pixels of a report: of each, references in 64-bit floats keep some 500 bytes. Fixed.
    pub report_pixels: u64,
    /// Bytes of working memory for one frame, those of the frames before it in the same file among them
    /// (`RASTERD_MAX_FRAME_BYTES`): 65 k instances of a million triangles are a tiny document.
    pub frame_bytes: u64,
    /// Bytes of decoded meshes and textures of one scene (`RASTERD_MAX_SCENE_BYTES`): a small PNG
    /// can decode to gigabytes.
    pub scene_bytes: u64,
    /// Bytes of all scenes together (`RASTERD_MAX_TOTAL_BYTES`); beyond is a 507.
    pub total_bytes: u64,
    /// Texels along a side of a texture or shadow map: what graphics hardware takes. Fixed.
    pub texture_side: u32,
    /// Texels of all shadow maps of a frame, those of each face of a point light among them: as many as
    /// the largest map has alone, a gigabyte of depths. Fixed.
    pub shadow_texels: u64,
    /// Lights of one scene: each costs time at every pixel. Fixed.
    pub lights: usize,
    /// Entries of `environment.backgrounds`: a procedural sky of a few words is some milliseconds' work.
    /// Fixed.
    pub backgrounds: usize,
    /// Entries of `instances`, [`MAX_INSTANCES`].
    pub instances: usize,
    /// Entries of any other map of the document. Fixed.
    pub entries: usize,
    /// Characters of a name, [`MAX_NAME_CHARS`].
    pub name_chars: usize,
    /// Steps along one direction of a built-in shape, [`MAX_SHAPE_SEGMENTS`].
    pub shape_segments: u32,
    /// Steps along a side of a teapot's patch, [`MAX_TEAPOT_SEGMENTS`].
    pub teapot_segments: u32,
    /// Fields of a chequer along a side, [`MAX_CHECKER_CELLS`].
    pub checker_cells: u32,
    /// `shadow.bias`: a thousand times the offset that is just enough detaches every shadow from its
    /// caster. Fixed.
    pub shadow_bias: u32,
    /// `shadow.radius` and `shadow.search_radius` in texels: a wider kernel covers what no map
    /// resolves. Fixed.
    pub shadow_kernel_texels: u32,
    /// `shadow.pcf_taps`, `shadow.search_taps` and `shadow.filter_taps`: each is read at every lit pixel. Fixed.
    pub shadow_taps: u32,
    /// Effects of one scene: each is a pass over the picture. Fixed.
    pub post_effects: usize,
    /// Radius of a blur or bloom in pixels: a wider one takes longer than any deadline and looks like
    /// one colour. Fixed.
    pub post_radius_px: u32,
    /// Weights along a side of a `kernel`, for the same reason. Fixed.
    pub post_kernel_side: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            body_bytes: 256 << 20,
            picture_side: 16_384,
            picture_pixels: 1 << 26,
            report_pixels: 1 << 20,
            frame_bytes: 4 << 30,
            scene_bytes: 2 << 30,
            total_bytes: 4 << 30,
            texture_side: 16_384,
            shadow_texels: 1 << 28,
            lights: 1024,
            backgrounds: 256,
            instances: MAX_INSTANCES,
            entries: 65_536,
            name_chars: MAX_NAME_CHARS,
            shape_segments: MAX_SHAPE_SEGMENTS,
            teapot_segments: MAX_TEAPOT_SEGMENTS,
            checker_cells: MAX_CHECKER_CELLS,
            shadow_bias: 1000,
            shadow_kernel_texels: 1024,
            shadow_taps: 1024,
            post_effects: 64,
            post_radius_px: 256,
            post_kernel_side: 63,
        }
    }
}
