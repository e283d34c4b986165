//! The demo scene's textures. Each is a function of (u, v), v up, that repeats in both.

use super::noise::{Cells, Noise, mix, random, smoothstep};
use bytes::Bytes;

/// Texels along a side.
const SIDE: u32 = 512;

/// An sRGB-encoded colour, 0–255.
type Color = [f64; 3];

/// Celadon: a teal that runs together unevenly, with dark specks of iron. Finer in u than in v, as
/// a teapot is three times as far around as from bottom to rim.
pub fn glaze() -> Bytes {
    const THICK: Color = [40.0, 126.0, 130.0];
    const THIN: Color = [104.0, 176.0, 168.0];
    const SPECK: Color = [32.0, 70.0, 70.0];
    let flow = Noise::new([12, 5], 4, 11);
    let specks = Cells::new([120, 44], 12);
    paint(|u, v| {
        let colour = blend(THICK, THIN, smoothstep(0.25, 0.8, flow.at(u, v)));
        let dot = specks.at(u, v);
        let size = if dot.id < 0.22 { 0.1 + dot.id } else { 0.0 };
        blend(colour, SPECK, 0.75 * (1.0 - smoothstep(size * 0.5, size + 1e-3, dot.nearest)))
    })
}

/// One tile of terrazzo: chips of stone in pale cement, large ones and small ones between them, and
/// half of a joint along each border.
pub fn terrazzo() -> Bytes {
    const CEMENT: Color = [218.0, 214.0, 206.0];
    const JOINT: Color = [176.0, 169.0, 158.0];
    let sand = Noise::new([64, 64], 2, 21);
    let (small, large) = (Cells::new([40; 2], 22), Cells::new([13; 2], 25));
    paint(|u, v| {
        let mut colour = shade(CEMENT, 0.97 + 0.06 * sand.at(u, v));
        for cells in [&small, &large] {
            let here = cells.at(u, v);
            // A chip is a shrunken cell, so its edges are straight; not every cell holds one.
            let inside = smoothstep(0.16, 0.22, here.second - here.nearest);
            if here.id < 0.5 {
                colour = blend(colour, chip(here.id / 0.5), inside);
            }
        }
        let border = u.min(1.0 - u).min(v).min(1.0 - v);
        blend(JOINT, colour, smoothstep(0.002, 0.006, border))
    })
}

/// Colour of a chip by its random number in 0–1.
fn chip(id: f64) -> Color {
    const STONES: [Color; 6] = [
        [202.0, 197.0, 188.0],
        [184.0, 179.0, 171.0],
        [208.0, 179.0, 158.0],
        [232.0, 229.0, 223.0],
        [170.0, 183.0, 181.0],
        [156.0, 152.0, 147.0],
    ];
    let mut stones = (1..).zip(STONES);
    let chosen = stones.find(|(i, _)| id * 6.0 <= f64::from(*i));
    chosen.map_or(STONES[0], |(_, colour)| colour)
}

/// A plain weave of blue weft and undyed warp.
pub fn weave() -> Bytes {
    /// Threads along a side; even, so that over and under go on across the border.
    const THREADS: u32 = 18;
    const WARP: Color = [226.0, 215.0, 193.0];
    const WEFT: Color = [78.0, 106.0, 134.0];
    let (along_v, along_u) = (Noise::new([256, 64], 1, 32), Noise::new([64, 256], 1, 33));
    paint(|u, v| {
        let (column, x) = thread(u, THREADS);
        let (row, y) = thread(v, THREADS);
        let warp_is_over = (column + row) % 2 == 0;
        let (colour, across, along) = if warp_is_over { (WARP, x, y) } else { (WEFT, y, x) };
        let arch = |t: f64| 1.0 - (2.0 * t - 1.0) * (2.0 * t - 1.0);
        let light = 0.42 + 0.4 * arch(across).sqrt() + 0.18 * arch(along);
        let tone = if warp_is_over { random(column, 0, 31) } else { random(row, 1, 31) };
        let fibre = if warp_is_over { along_v.at(u, v) } else { along_u.at(u, v) };
        shade(colour, light * (0.9 + 0.08 * tone + 0.1 * fibre))
    })
}

/// Which of `threads` lies at `u` in 0–1, and where in it, in 0–1.
fn thread(u: f64, threads: u32) -> (u32, f64) {
    let at = u * f64::from(threads);
    #[expect(clippy::cast_possible_truncation, reason = "0 ≤ at ≤ threads, a u32")]
    let index = at as u32;
    (index, at - f64::from(index))
}

/// Four planks of walnut and oak tones, grain along u.
pub fn wood() -> Bytes {
    const PLANKS: u32 = 4;
    const EARLY: Color = [186.0, 136.0, 88.0];
    const LATE: Color = [132.0, 86.0, 50.0];
    const GAP: Color = [64.0, 42.0, 26.0];
    let bends: [Noise; PLANKS as usize] = [41, 51, 61, 71].map(|seed| Noise::new([2, 6], 3, seed));
    let (coarse, fine) = (Noise::new([24, 256], 1, 81), Noise::new([64, 512], 1, 82));
    paint(|u, v| {
        let (plank, across) = thread(v, PLANKS);
        // Year rings: bands across the plank, bent along it into long arches.
        let bend = bends[plank as usize].at(u, v);
        let ring = (across * 3.5 + bend * 4.0 + random(plank, 0, 40) * 5.0).fract();
        let late = smoothstep(0.15, 0.9, ring) * (1.0 - smoothstep(0.92, 1.0, ring));
        let fibre = 0.6 * coarse.at(u, v) + 0.4 * fine.at(u, v);
        let tone = 0.86 + 0.2 * random(plank, 1, 40);
        let colour = shade(blend(EARLY, LATE, 0.65 * late), tone * (0.86 + 0.24 * fibre));
        let edge = across.min(1.0 - across);
        blend(GAP, colour, smoothstep(0.005, 0.02, edge))
    })
}

fn blend(a: Color, b: Color, t: f64) -> Color {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

fn shade(colour: Color, factor: f64) -> Color {
    colour.map(|channel| channel * factor)
}

/// A PNG of `colour` at the texel centres.
fn paint(colour: impl Fn(f64, f64) -> Color) -> Bytes {
    let centre = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let mut texels = Vec::with_capacity(3 * (SIDE * SIDE) as usize);
    // Rows run top to bottom, v runs up.
    for row in (0..SIDE).rev() {
        for column in 0..SIDE {
            texels.extend(colour(centre(column), centre(row)).map(byte));
        }
    }
    encode(&texels)
}

fn byte(channel: f64) -> u8 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to 0–255")]
    let byte = (channel.clamp(0.0, 255.0) + 0.5) as u8;
    byte
}

fn encode(rgb: &[u8]) -> Bytes {
    const IN_MEMORY: &str = "invariant: a vector takes all that is written, and the size is right";
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, SIDE, SIDE);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().expect(IN_MEMORY);
    writer.write_image_data(rgb).expect(IN_MEMORY);
    writer.finish().expect(IN_MEMORY);
    file.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [fn() -> Bytes; 4] = [glaze, terrazzo, weave, wood];

    fn decode(file: &Bytes) -> image::RgbImage {
        image::load_from_memory(file).unwrap().into_rgb8()
    }

    #[test]
    fn every_texture_is_a_png_of_its_size_that_is_no_flat_colour() {
        for texture in ALL {
            let picture = decode(&texture());
            assert_eq!(picture.dimensions(), (SIDE, SIDE));
            let reds = || picture.pixels().map(|p| p[0]);
            assert!(reds().max().unwrap() - reds().min().unwrap() > 40);
        }
    }

    #[test]
    fn every_texture_is_the_same_each_time() {
        for texture in ALL {
            assert_eq!(texture(), texture());
        }
    }

    #[test]
    fn the_terrazzo_tile_ends_in_its_joint_on_all_sides() {
        let picture = decode(&terrazzo());
        for i in 0..SIDE {
            for corner in [(i, 0), (i, SIDE - 1), (0, i), (SIDE - 1, i)] {
                assert_eq!(picture.get_pixel(corner.0, corner.1).0, [176, 169, 158]);
            }
        }
    }
}
