//! Cube maps: six square pictures of everything around.

use super::panorama::with_alpha;
use super::texels::{Picture, PictureSize, Texels, texel_bytes};
use crate::math::colour::SRGB_DECODE;
use crate::math::colour::srgb_from_linear;
use crate::model::texture::mips::{half, halve};
use std::fmt;
use std::sync::Arc;

/// Six faces with their mips, and a border of the neighbours' texels around each.
///
/// Faces are +x, −x, +y, −y, +z, −z, addressed as OpenGL addresses them (4.6 specification, table
/// 8.19): see [`AXES`].
#[derive(Clone, PartialEq)]
pub struct CubeMap {
    name: String,
    /// Level 0 are the pictures; the side of the next is half, down to 1.
    pub levels: Vec<CubeLevel>,
}

/// A mip level of all six faces.
#[derive(Clone, PartialEq)]
pub struct CubeLevel {
    /// Texels along a side of a face, without the border.
    pub side: usize,
    /// Face after face, each `(side + 2) × (side + 2)` texels with its border, rows from the top.
    pub texels: Texels,
}

/// A face's axes in world space: its centre, and the directions in which columns and rows run.
pub struct Axes {
    /// Where the face is.
    pub centre: [i32; 3],
    /// The way columns run (s).
    pub across: [i32; 3],
    /// The way rows run (t), so down the picture.
    pub down: [i32; 3],
}

/// The axes of +x, −x, +y, −y, +z, −z. A line of sight (x, y, z) meets the face of its largest
/// component m at `s = (across · (x, y, z) / |m| + 1) / 2`, and t likewise.
///
/// Source: OpenGL 4.6 specification, table 8.19.
pub const AXES: [Axes; 6] = [
    Axes { centre: [1, 0, 0], across: [0, 0, -1], down: [0, -1, 0] },
    Axes { centre: [-1, 0, 0], across: [0, 0, 1], down: [0, -1, 0] },
    Axes { centre: [0, 1, 0], across: [1, 0, 0], down: [0, 0, 1] },
    Axes { centre: [0, -1, 0], across: [1, 0, 0], down: [0, 0, -1] },
    Axes { centre: [0, 0, 1], across: [1, 0, 0], down: [0, -1, 0] },
    Axes { centre: [0, 0, -1], across: [-1, 0, 0], down: [0, -1, 0] },
];

/// Why six pictures make no cube. `face` counts in the order of [`AXES`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaceFault {
    /// A face is no square.
    #[error("a face must be square, is {width} × {height} texels")]
    NotSquare {
        /// Which.
        face: usize,
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A face is not as large as the first.
    #[error("all faces must be of one size, this one has {side} texels a side and px has {first}")]
    Unequal {
        /// Which.
        face: usize,
        /// Texels along its side.
        side: u32,
        /// Texels along the side of the first.
        first: u32,
    },
}

impl FaceFault {
    /// The face at fault.
    #[must_use]
    pub fn face(&self) -> usize {
        match *self {
            Self::NotSquare { face, .. } | Self::Unequal { face, .. } => face,
        }
    }
}

impl CubeMap {
    /// Adds mips and borders to six pictures in the order of [`AXES`]. Faces may share a picture.
    ///
    /// `name` tells it from other cube maps of one scene: see [`CubeMap::name`].
    ///
    /// # Errors
    /// Every face that is not square or not as large as the first.
    pub fn new(name: String, faces: [impl Into<Arc<Picture>>; 6]) -> Result<Self, Vec<FaceFault>> {
        let mut plain: [Arc<Picture>; 6] = faces.map(Into::into);
        let mut side = check(plain.each_ref().map(|face| [face.width, face.height]))? as usize;
        let mut levels = vec![CubeLevel::new(side, &plain)];
        while side > 1 {
            plain = halved(&plain);
            side = half(side);
            levels.push(CubeLevel::new(side, &plain));
        }
        Ok(Self { name, levels })
    }

    /// Bytes of memory that one of faces of these sizes will hold.
    ///
    /// # Errors
    /// As [`CubeMap::new`].
    pub fn bytes_of(faces: [PictureSize; 6]) -> Result<u64, Vec<FaceFault>> {
        let mut side = check(faces.map(|face| [face.width, face.height]))? as usize;
        let of = |side: usize, is_linear| 6 * (side as u64 + 2).pow(2) * texel_bytes(is_linear);
        let mut bytes = of(side, faces.iter().any(|face| face.is_linear));
        while side > 1 {
            side = half(side);
            bytes += of(side, true);
        }
        Ok(bytes)
    }

    /// What its pictures are called: the same scene content and the same name make the same cube map.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.texels.bytes()).sum()
    }
}

/// The side of six faces of these widths and heights.
fn check(faces: [[u32; 2]; 6]) -> Result<u32, Vec<FaceFault>> {
    let first = faces[0][0];
    let fault = |(face, [width, height]): (usize, [u32; 2])| match () {
        () if width != height => Some(FaceFault::NotSquare { face, width, height }),
        () if width != first => Some(FaceFault::Unequal { face, side: width, first }),
        () => None,
    };
    let faults: Vec<_> = faces.into_iter().enumerate().filter_map(fault).collect();
    if faults.is_empty() { Ok(first) } else { Err(faults) }
}

/// The next level of the faces, without borders. Those that share a picture share the next one too.
fn halved(faces: &[Arc<Picture>; 6]) -> [Arc<Picture>; 6] {
    let first = |face: usize| faces.iter().position(|earlier| Arc::ptr_eq(earlier, &faces[face]));
    let mut below: Vec<Arc<Picture>> = Vec::with_capacity(faces.len());
    for (face, picture) in faces.iter().enumerate() {
        let made = first(face).and_then(|earlier| below.get(earlier).cloned());
        below.push(made.unwrap_or_else(|| Arc::new(halved_face(picture))));
    }
    below.try_into().expect("invariant: as many as there were")
}

fn halved_face(face: &Picture) -> Picture {
    let (side, decode) = (face.width as usize, &*SRGB_DECODE);
    let below = halve(side, side, |x, y| with_alpha(face.texels.linear(y * side + x, decode))).texels;
    let texels = Texels::Linear(below.into_iter().map(|[r, g, b, _]| [r, g, b]).collect());
    let side = (face.width / 2).max(1);
    Picture { width: side, height: side, texels }
}

impl CubeLevel {
    /// Puts the faces, `side × side` texels each, behind one another and a border around each.
    ///
    /// The border holds the texels across the edge, so that filtering knows no seam. Where three faces
    /// meet there is none: the corner holds the mean of the three texels that meet there, as OpenGL's
    /// seamless filtering has it (4.6 specification, 8.14.3).
    fn new(side: usize, faces: &[Arc<Picture>; 6]) -> Self {
        let srgb: Option<Vec<&Vec<[u8; 4]>>> = faces
            .iter()
            .map(|face| match &face.texels {
                Texels::Srgb8(codes) => Some(codes),
                Texels::Linear(_) => None,
            })
            .collect();
        let texels = match srgb {
            Some(faces) => Texels::Srgb8(bordered(side, |face, at| faces[face][at], mean_of_codes)),
            None => {
                let decode = &*SRGB_DECODE;
                let texel = |face: usize, at: usize| faces[face].texels.linear(at, decode);
                Texels::Linear(bordered(side, texel, mean_of_values))
            }
        };
        Self { side, texels }
    }
}

/// The three texels that meet at a corner, in one.
fn mean_of_values(texels: [[f32; 3]; 3]) -> [f32; 3] {
    std::array::from_fn(|c| (texels[0][c] + texels[1][c] + texels[2][c]) * (1.0 / 3.0))
}

fn mean_of_codes(texels: [[u8; 4]; 3]) -> [u8; 4] {
    let decode = &*SRGB_DECODE;
    let linear = texels.map(|[r, g, b, _]| [r, g, b].map(|code| decode[usize::from(code)]));
    let [r, g, b] = mean_of_values(linear).map(code);
    [r, g, b, u8::MAX]
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of codes lies in 0–255")]
fn code(linear: f32) -> u8 {
    (srgb_from_linear(f64::from(linear).min(1.0)) * 255.0 + 0.5).floor() as u8
}

/// Six faces of `side × side` texels with a border around each; `texel(face, y · side + x)` reads them.
fn bordered<T: Copy>(side: usize, texel: impl Fn(usize, usize) -> T, mean: impl Fn([T; 3]) -> T) -> Vec<T> {
    let mut out = Vec::with_capacity(6 * (side + 2) * (side + 2));
    let last = signed(side) - 1;
    for face in 0..6 {
        for y in -1..=last + 1 {
            for x in -1..=last + 1 {
                let across = |x: i64, y: i64| {
                    let (face, at) = across_edge(face, [x, y], side);
                    texel(face, at)
                };
                let (inner_x, inner_y) = (x.clamp(0, last), y.clamp(0, last));
                let own = texel(face, index(inner_x, inner_y, side));
                out.push(match (x == inner_x, y == inner_y) {
                    (true, true) => own,
                    (false, false) => mean([own, across(x, inner_y), across(inner_x, y)]),
                    _ => across(x, y),
                });
            }
        }
    }
    out
}

/// Face and index of the texel that lies where (x, y) is, one texel over an edge of `face`.
///
/// All in whole numbers: in units of half a texel, the face spans ±side and the texel's centre lies at
/// `2x + 1 − side`. Over the edge, that coordinate becomes the neighbour's axis, and the face's own axis
/// one of the neighbour's coordinates, half a texel from its edge.
fn across_edge(face: usize, [x, y]: [i64; 2], side: usize) -> (usize, usize) {
    let n = signed(side);
    let [s, t] = [x, y].map(|i| 2 * i + 1 - n);
    let axes = &AXES[face];
    let inner = |c: i64| if c.abs() > n { c.signum() * n } else { c };
    let point: [i64; 3] = std::array::from_fn(|c| {
        i64::from(axes.centre[c]) * (n - 1)
            + i64::from(axes.across[c]) * inner(s)
            + i64::from(axes.down[c]) * inner(t)
    });
    let along = |axis: &[i32; 3]| (0..3).map(|c| i64::from(axis[c]) * point[c]).sum::<i64>();
    let neighbour = AXES.iter().position(|axes| along(&axes.centre) == n).expect("an edge has two faces");
    let [x, y] = [along(&AXES[neighbour].across), along(&AXES[neighbour].down)].map(|c| (c + n - 1) / 2);
    (neighbour, index(x, y, side))
}

/// Place of a texel within a face; both lie in it.
fn index(x: i64, y: i64, side: usize) -> usize {
    let whole = |i: i64| usize::try_from(i).expect("invariant: within the face");
    whole(y) * side + whole(x)
}

/// A face's side is at most 2¹⁴ texels.
fn signed(side: usize) -> i64 {
    i64::try_from(side).expect("invariant: far below 2⁶³")
}

/// Name and size stand for the texels.
impl fmt::Debug for CubeMap {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let side = self.levels.first().map(|level| level.side);
        f.debug_struct("CubeMap").field("name", &self.name).field("side", &side).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(side: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let texels = (0..side * side).map(|i| texel(i % side, i / side)).collect();
        Picture { width: side, height: side, texels: Texels::Linear(texels) }
    }

    /// A cube map whose texels are their own directions, moved to 0–2.
    fn directions(side: u32) -> CubeMap {
        let faces = AXES.each_ref().map(|axes| {
            face(side, |x, y| {
                let [s, t] = [x, y].map(|i| (2.0 * i as f32 + 1.0) / side as f32 - 1.0);
                std::array::from_fn(|c| {
                    1.0 + axes.centre[c] as f32 + axes.across[c] as f32 * s + axes.down[c] as f32 * t
                })
            })
        });
        CubeMap::new(String::new(), faces).unwrap()
    }

    /// Texel (x, y) of a face, −1 and `side` being the border.
    fn at(level: &CubeLevel, face: usize, x: i64, y: i64) -> [f32; 3] {
        let wide = signed(level.side) + 2;
        let i = (i64::try_from(face).unwrap() * wide + y + 1) * wide + x + 1;
        level.texels.linear(usize::try_from(i).unwrap(), &SRGB_DECODE)
    }

    #[test]
    fn every_border_texel_is_the_one_across_the_edge() {
        for side in [1u32, 2, 5, 8] {
            let cube = directions(side);
            let (level, n) = (&cube.levels[0], i64::from(side));
            for face in 0..6 {
                for i in 0..n {
                    for (inner, outer) in
                        [([i, 0], [i, -1]), ([i, n - 1], [i, n]), ([0, i], [-1, i]), ([n - 1, i], [n, i])]
                    {
                        // The neighbour mirrored at the edge: the same but for two coordinates swapped,
                        // each half a texel from the edge.
                        let (a, b) =
                            (at(level, face, inner[0], inner[1]), at(level, face, outer[0], outer[1]));
                        let apart: f32 = (0..3).map(|c| (a[c] - b[c]).abs()).sum();
                        let texel = 1.0 / side as f32;
                        assert!((apart - 2.0 * texel).abs() < 1e-5, "{side} {face} {inner:?}: {a:?} {b:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_three_faces_of_a_corner_share_its_texel() {
        let cube = directions(4);
        let mut corners = Vec::new();
        for face in 0..6 {
            for [x, y] in [[-1, -1], [4, -1], [-1, 4], [4, 4]] {
                corners.push(at(&cube.levels[0], face, x, y).map(f32::to_bits));
            }
        }
        corners.sort_unstable();
        for three in corners.chunks(3) {
            assert_eq!((three[0], three[1]), (three[1], three[2]));
        }
        corners.dedup();
        assert_eq!(corners.len(), 8);
    }

    #[test]
    fn a_white_cube_stays_white_in_codes() {
        let texels = Texels::Srgb8(vec![[255, 255, 255, 7]; 9]);
        let faces = std::array::from_fn(|_| Picture { width: 3, height: 3, texels: texels.clone() });
        let cube = CubeMap::new(String::new(), faces).unwrap();
        assert_eq!(cube.levels.len(), 2);
        for level in &cube.levels {
            let count = 6 * (level.side + 2) * (level.side + 2);
            assert!((0..count).all(|i| level.texels.linear(i, &SRGB_DECODE) == [1.0; 3]));
        }
    }

    #[test]
    fn faces_that_share_a_picture_are_those_that_have_it_each() {
        let [a, b] = [3.0, 9.0].map(|s| face(5, |x, y| [x as f32, y as f32, s]));
        let each = [&a, &a, &b, &a, &b, &a].map(Picture::clone);
        let [a, b] = [a, b].map(Arc::new);
        let shared = [&a, &a, &b, &a, &b, &a].map(Arc::clone);
        let cube = CubeMap::new(String::new(), shared).unwrap();
        assert!(cube == CubeMap::new(String::new(), each).unwrap());
    }

    #[test]
    fn its_bytes_are_known_before_it_is_there() {
        for side in [1, 2, 5, 16] {
            for of_codes in [0, 5, 6] {
                let codes = Texels::Srgb8(vec![[1; 4]; (side * side) as usize]);
                let faces = std::array::from_fn(|i| match i < of_codes {
                    true => Picture { width: side, height: side, texels: codes.clone() },
                    false => face(side, |_, _| [0.5; 3]),
                });
                let sizes = std::array::from_fn(|i| PictureSize {
                    width: side,
                    height: side,
                    is_linear: i >= of_codes,
                });
                let known = CubeMap::bytes_of(sizes).unwrap();
                assert_eq!(CubeMap::new(String::new(), faces).unwrap().bytes(), known);
            }
        }
    }

    #[test]
    fn every_odd_face_is_told() {
        let mut faces: [Picture; 6] = std::array::from_fn(|_| face(2, |_, _| [0.0; 3]));
        faces[1] = face(3, |_, _| [0.0; 3]);
        faces[4].height = 1;
        let faults = CubeMap::new(String::new(), faces).unwrap_err();
        let expected = [
            FaceFault::Unequal { face: 1, side: 3, first: 2 },
            FaceFault::NotSquare { face: 4, width: 2, height: 1 },
        ];
        assert_eq!(faults, expected);
    }
}
