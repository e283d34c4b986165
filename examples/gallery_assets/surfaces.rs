//! Flat materials: wood, stone, brick, shingles, paper.

use crate::paint::{self, Color, blend, shade};
use rasterd::scene::demo::noise::{Cells, Noise, random, smoothstep};

const SIZE: [u32; 2] = [512, 512];

/// Which of `count` strips lies at `t` in 0–1, and where in it, in 0–1.
fn strip(t: f64, count: u32) -> (u32, f64) {
    let at = t.clamp(0.0, 1.0) * f64::from(count);
    #[expect(clippy::cast_possible_truncation, reason = "0 ≤ at ≤ count, a u32")]
    let index = (at as u32).min(count - 1);
    (index, at - f64::from(index))
}

/// Wood with its grain along v.
#[derive(Debug)]
struct Wood {
    bend: Noise,
    fibre: Noise,
    early: Color,
    late: Color,
}

impl Wood {
    fn new(early: Color, late: Color, seed: u32) -> Self {
        Self { bend: Noise::new([5, 2], 3, seed), fibre: Noise::new([160, 12], 2, seed + 5), early, late }
    }

    /// At `across` and `along` a board that starts somewhere else in the log for each `seed`.
    fn at(&self, across: f64, along: f64, seed: u32) -> Color {
        let (x, y) = ((across + random(seed, 1, 9)).fract(), (along + random(seed, 2, 9)).fract());
        let ring = (across * 3.0 + 3.5 * self.bend.at(x, y) + random(seed, 3, 9) * 5.0).fract();
        let late = smoothstep(0.2, 0.88, ring) * (1.0 - smoothstep(0.9, 1.0, ring));
        let tone = (0.86 + 0.2 * random(seed, 4, 9)) * (0.84 + 0.28 * self.fibre.at(x, y));
        shade(blend(self.early, self.late, 0.7 * late), tone)
    }
}

/// A place on a side of a crate.
#[derive(Clone, Copy, Debug)]
struct CratePart {
    board: u32,
    across: f64,
    along: f64,
    /// Distance to the board's border, in units of the side.
    edge: f64,
    /// How far it stands out, 0–1.
    height: f64,
}

/// Six upright boards in a frame with a brace.
fn crate_part(u: f64, v: f64) -> CratePart {
    const FRAME: f64 = 0.13;
    let border = u.min(1.0 - u).min(v).min(1.0 - v);
    if border < FRAME {
        let upright = u.min(1.0 - u) < v.min(1.0 - v);
        // The frame's boards meet in mitres.
        let mitre = (u.min(1.0 - u) - v.min(1.0 - v)).abs() * 0.7;
        let edge = border.min(FRAME - border).min(mitre);
        let (across, along) = if upright { (border, v) } else { (border, u) };
        let board = 10 + u32::from(u > 0.5) + 2 * u32::from(upright) + 4 * u32::from(v > 0.5);
        return CratePart { board, across, along, edge, height: 1.0 };
    }
    let diagonal = (u - v) / std::f64::consts::SQRT_2;
    if diagonal.abs() < 0.075 {
        let along = (u + v) / std::f64::consts::SQRT_2;
        return CratePart {
            board: 30,
            across: diagonal + 0.1,
            along,
            edge: 0.075 - diagonal.abs(),
            height: 0.9,
        };
    }
    let (board, across) = strip((u - FRAME) / (1.0 - 2.0 * FRAME), 6);
    let width = (1.0 - 2.0 * FRAME) / 6.0;
    CratePart {
        board,
        across: across * width,
        along: v,
        edge: across.min(1.0 - across) * width,
        height: 0.35,
    }
}

/// Distance to the nearest nail.
fn nail(u: f64, v: f64) -> f64 {
    let near = |x: f64| [0.065, 0.22, 0.5, 0.78, 0.935].iter().map(|n| (x - n).abs()).fold(1.0, f64::min);
    let (u, v) = if u.min(1.0 - u) < 0.13 {
        ((u.min(1.0 - u) - 0.065).abs(), near(v))
    } else {
        (near(u), (v.min(1.0 - v) - 0.065).abs())
    };
    (u * u + v * v).sqrt()
}

/// The side of a crate.
pub fn crate_colors() -> Vec<u8> {
    const NAIL: Color = [74.0, 70.0, 66.0];
    let wood = Wood::new([206.0, 158.0, 104.0], [146.0, 98.0, 56.0], 201);
    let dirt = Noise::new([6, 6], 4, 211);
    paint::jpeg(SIZE, 82, |u, v| {
        let part = crate_part(u, v);
        let board = wood.at(part.across, part.along, part.board);
        let crack = 0.22 + 0.78 * smoothstep(0.0, 0.009, part.edge);
        let tone = crack * (0.9 + 0.1 * part.height) * (0.82 + 0.3 * dirt.at(u, v));
        blend(NAIL, shade(board, tone), smoothstep(0.009, 0.012, nail(u, v)))
    })
}

/// Its relief as heights.
pub fn crate_heights() -> Vec<u8> {
    let fibre = Noise::new([90, 90], 2, 221);
    paint::grey_jpeg(SIZE, 84, |u, v| {
        let part = crate_part(u, v);
        let round = smoothstep(0.0, 0.014, part.edge);
        let head = 0.12 * (1.0 - smoothstep(0.006, 0.012, nail(u, v)));
        part.height * (0.72 * round + 0.08) + 0.07 * fibre.at(u, v) + head
    })
}

/// Boards of a table top or a floor, along v.
pub fn planks() -> Vec<u8> {
    let wood = Wood::new([176.0, 126.0, 80.0], [112.0, 72.0, 42.0], 231);
    paint::jpeg(SIZE, 82, |u, v| {
        let (board, across) = strip(u, 5);
        let edge = across.min(1.0 - across) / 5.0;
        shade(wood.at(across / 5.0, v, 40 + board), 0.3 + 0.7 * smoothstep(0.0, 0.006, edge))
    })
}

/// A place on a pavement.
#[derive(Clone, Copy, Debug)]
struct Slab {
    id: f64,
    /// From the joint to the middle, 0–1.
    inside: f64,
}

fn slab(cells: &Cells, u: f64, v: f64) -> Slab {
    let here = cells.at(u, v);
    Slab { id: here.id, inside: smoothstep(0.04, 0.16, here.second - here.nearest) }
}

const SLABS: ([u32; 2], u32) = ([6, 6], 241);

/// Broken slabs of sandstone, moss in the joints.
pub fn paving_colors() -> Vec<u8> {
    const JOINT: Color = [86.0, 88.0, 66.0];
    let cells = Cells::new(SLABS.0, SLABS.1);
    let (grain, stain) = (Noise::new([90, 90], 2, 251), Noise::new([5, 5], 5, 255));
    paint::jpeg(SIZE, 80, |u, v| {
        let slab = slab(&cells, u, v);
        let stone = blend([190.0, 176.0, 152.0], [150.0, 142.0, 132.0], slab.id);
        let stone = shade(stone, (0.86 + 0.24 * grain.at(u, v)) * (0.8 + 0.4 * stain.at(u, v)));
        blend(JOINT, stone, slab.inside)
    })
}

/// Its relief as heights.
pub fn paving_heights() -> Vec<u8> {
    let cells = Cells::new(SLABS.0, SLABS.1);
    let grain = Noise::new([60, 60], 3, 261);
    paint::grey_jpeg(SIZE, 80, |u, v| {
        let slab = slab(&cells, u, v);
        slab.inside * (0.62 + 0.16 * slab.id) + 0.2 * grain.at(u, v)
    })
}

/// A brick: its random number, and the distance to its border in bricks' heights.
fn brick(u: f64, v: f64, columns: u32, rows: u32) -> (f64, f64) {
    let (row, y) = strip(v, rows);
    let shift = if row % 2 == 0 { 0.0 } else { 0.5 / f64::from(columns) };
    let (column, x) = strip((u + shift).fract(), columns);
    let aspect = f64::from(rows) / f64::from(columns);
    (random(column, row, 271), y.min(1.0 - y).min(x.min(1.0 - x) * aspect))
}

/// Old brickwork.
pub fn brick_colors() -> Vec<u8> {
    const MORTAR: Color = [190.0, 180.0, 166.0];
    let (grain, wear) = (Noise::new([100, 100], 2, 281), Noise::new([24, 24], 3, 285));
    paint::jpeg(SIZE, 80, |u, v| {
        let (id, edge) = brick(u, v, 4, 10);
        let clay = blend([172.0, 86.0, 60.0], [126.0, 60.0, 46.0], id);
        let clay = shade(clay, (0.82 + 0.36 * grain.at(u, v)) * (0.9 + 0.2 * random(7, 3, 280)));
        blend(MORTAR, clay, smoothstep(0.07, 0.13, edge + 0.1 * (wear.at(u, v) - 0.5)))
    })
}

/// Its relief as a normal map.
pub fn brick_normals() -> Vec<u8> {
    let (grain, wear) = (Noise::new([70, 70], 3, 291), Noise::new([24, 24], 3, 285));
    let height = |u: f64, v: f64| {
        let (u, v) = (u.rem_euclid(1.0), v.rem_euclid(1.0));
        let (id, edge) = brick(u, v, 4, 10);
        let body = smoothstep(0.04, 0.16, edge + 0.1 * (wear.at(u, v) - 0.5));
        0.011 * body * (0.8 + 0.4 * id) + 0.004 * grain.at(u, v)
    };
    let step = 0.6 / f64::from(SIZE[0]);
    paint::normal_map(SIZE, 84, |u, v| {
        let along_u = (height(u + step, v) - height(u - step, v)) / (2.0 * step);
        let along_v = (height(u, v + step) - height(u, v - step)) / (2.0 * step);
        [along_u, along_v]
    })
}

/// Rows of rounded shingles, the ridge above.
pub fn shingles() -> Vec<u8> {
    let grain = Noise::new([64, 64], 2, 301);
    paint::jpeg([256, 256], 82, |u, v| {
        let (row, y) = strip(v, 10);
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 / 12.0 };
        let (column, x) = strip((u + shift).fract(), 12);
        let (across, bottom) = (2.0 * x - 1.0, 0.3 * (2.0 * x - 1.0) * (2.0 * x - 1.0));
        let id = random(column, row, 311);
        let light = 0.55 + 0.45 * smoothstep(bottom, bottom + 0.14, y);
        let gap = 0.75 + 0.25 * smoothstep(0.0, 0.1, 1.0 - across.abs());
        let shadow = 1.0 - 0.3 * smoothstep(0.6, 1.0, y);
        // Nearly white: the material's colour tints it.
        shade([244.0, 240.0, 236.0], light * gap * shadow * (0.8 + 0.2 * id) * (0.86 + 0.2 * grain.at(u, v)))
    })
}

/// What is where on the front of a half-timbered house of 1 × 1.2.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Front {
    Plaster,
    Beam,
    Door,
    Frame,
    Pane,
}

fn front(u: f64, v: f64) -> Front {
    let (x, y) = ((u - 0.5).abs(), 1.2 * v);
    let inside = |cx: f64, cy: f64, half: [f64; 2]| (x - cx).abs() < half[0] && (y - cy).abs() < half[1];
    let windows = [(0.3, 0.4, [0.09, 0.11]), (0.0, 0.86, [0.08, 0.09])];
    for (cx, cy, half) in windows {
        // Two panes across, two up.
        let bar = (x - cx).abs() < 0.01 || (y - cy).abs() < 0.01;
        if inside(cx, cy, half) {
            return if bar { Front::Frame } else { Front::Pane };
        }
        if inside(cx, cy, half.map(|half| half + 0.025)) {
            return Front::Frame;
        }
    }
    if x < 0.09 && y < 0.36 {
        return if x > 0.07 || y > 0.34 || (x < 0.008) { Front::Frame } else { Front::Door };
    }
    let level = [0.02, 0.62, 0.7].iter().any(|beam| (y - beam).abs() < 0.022);
    let upright = [0.17, 0.478].iter().any(|beam| (x - beam).abs() < 0.02) && y < 0.7;
    let rafter = (y - 0.7 - (0.5 - x)).abs() < 0.05 && y > 0.7;
    let brace = (y - 0.7 - 1.1 * x).abs() < 0.026 && (0.2..0.5).contains(&x) && y > 0.7;
    if level || upright || rafter || brace { Front::Beam } else { Front::Plaster }
}

/// The front of a house, nearly white where its material's colour is to tint it.
pub fn front_colors() -> Vec<u8> {
    let grain = Noise::new([40, 40], 3, 351);
    paint::jpeg([320, 384], 84, |u, v| {
        let color = match front(u, v) {
            Front::Plaster => [250.0, 246.0, 238.0],
            Front::Beam => [96.0, 66.0, 46.0],
            Front::Door => [120.0, 62.0, 40.0],
            Front::Frame => [244.0, 240.0, 232.0],
            Front::Pane => [70.0, 84.0, 104.0],
        };
        shade(color, 0.88 + 0.2 * grain.at(u, v))
    })
}

/// Where light comes out of it: the windows.
pub fn front_lights() -> Vec<u8> {
    paint::grey_jpeg([160, 192], 84, |u, v| f64::from(front(u, v) == Front::Pane))
}

/// The edges of a book's pages, along u.
pub fn pages() -> Vec<u8> {
    let sheet = Noise::new([2, 96], 2, 321);
    paint::jpeg([64, 128], 80, |u, v| shade([238.0, 226.0, 200.0], 0.72 + 0.4 * sheet.at(u, v)))
}

/// A book's cloth.
pub fn cloth() -> Vec<u8> {
    let thread = [Noise::new([96, 24], 1, 331), Noise::new([24, 96], 1, 332)];
    let wear = Noise::new([4, 4], 4, 335);
    paint::jpeg([256, 256], 80, |u, v| {
        let weave = 0.5 * (thread[0].at(u, v) + thread[1].at(u, v));
        shade([250.0, 250.0, 250.0], (0.76 + 0.3 * weave) * (0.84 + 0.26 * wear.at(u, v)))
    })
}

/// Wallpaper with small leaves in a lattice.
pub fn wallpaper() -> Vec<u8> {
    const GROUND: Color = [232.0, 226.0, 210.0];
    const LEAF: Color = [186.0, 190.0, 168.0];
    paint::jpeg([256, 256], 84, |u, v| {
        let sprig = |x: f64, y: f64| {
            let (x, y) = (x.rem_euclid(1.0) - 0.5, y.rem_euclid(1.0) - 0.5);
            // Two leaves and a stem.
            let leaf = |side: f64| {
                let (a, b) = (x * 0.7 + side * y * 0.7, y * 0.7 - side * x * 0.7);
                let (a, b) = ((a - side * 0.17) / 0.17, b / 0.07);
                a * a + b * b
            };
            let stem = (x / 0.018) * (x / 0.018) + ((y + 0.06) / 0.26) * ((y + 0.06) / 0.26);
            leaf(1.0).min(leaf(-1.0)).min(stem)
        };
        let nearest = sprig(u * 2.0, v * 2.0).min(sprig(u * 2.0 + 0.5, v * 2.0 + 0.5));
        blend(LEAF, GROUND, smoothstep(0.85, 1.15, nearest))
    })
}

/// How much of a greenhouse's pane is seen, 0–1: dust that rain has run through, most of it below.
pub fn grime() -> Vec<u8> {
    let (dust, streaks) = (Noise::new([8, 8], 5, 361), Noise::new([40, 3], 3, 365));
    paint::grey_jpeg([256, 256], 80, |u, v| {
        let low = 0.35 + 0.65 * smoothstep(0.9, 0.1, v);
        0.12 + 0.6 * low * smoothstep(0.35, 0.8, 0.6 * dust.at(u, v) + 0.4 * streaks.at(u, v))
    })
}

/// Holes in the shape of stars: alpha is 0 in them.
pub fn stars() -> Vec<u8> {
    const TIN: Color = [196.0, 164.0, 104.0];
    paint::cutout([512, 256], |u, v| {
        let (row, y) = strip(v, 7);
        // Fewer towards the poles, so that stars stay about as wide as high.
        let count = [3, 8, 12, 14, 12, 8, 3][row as usize];
        let (column, x) = strip((u + 0.031 * f64::from(row)).fract(), count);
        let wide = std::f64::consts::TAU * libm::cos(std::f64::consts::PI * (v - 0.5)) / f64::from(count);
        let (x, y) = ((x - 0.5) * wide, (y - 0.5) * std::f64::consts::PI / 7.0);
        let size = 0.11 + 0.05 * random(column, row, 341);
        let (away, angle) = ((x * x + y * y).sqrt(), libm::atan2(x, y));
        let five = (angle * 5.0 / std::f64::consts::TAU).rem_euclid(1.0) - 0.5;
        let rim = size * (0.52 + 0.48 * (2.0 * five.abs()));
        (TIN, smoothstep(-0.008, 0.008, away - rim))
    })
}
