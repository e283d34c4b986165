//! A tile with a number on it.

use super::{heat, opaque};
use crate::pipeline::tiles::Tile;

/// Digits of 3 × 5 dots, row by row from the highest bit.
const GLYPHS: [u16; 10] = [
    0b111_101_101_101_111,
    0b010_110_010_010_111,
    0b111_001_111_100_111,
    0b111_001_111_001_111,
    0b101_101_111_001_001,
    0b111_100_111_001_111,
    0b111_100_111_101_111,
    0b111_001_010_010_010,
    0b111_101_111_101_111,
    0b111_101_111_001_111,
];

/// Dots of a digit.
const WIDTH: usize = 3;
const HEIGHT: usize = 5;

/// Dots from one digit to the next.
const ADVANCE: usize = 4;

/// Dots between the tile's border and the number.
const MARGIN: usize = 2;

/// The tile's first row and column.
const BORDER: [u8; 3] = [90, 90, 90];

/// Fills a tile of `side` pixels with the colour of `count`, and writes it there. Two pixels are a dot, one in
/// the smaller tiles.
pub fn write_count(count: usize, side: usize, tile: Tile<[u8; 4]>) {
    let number = count.to_string();
    let ground = heat::of_triangles(u32::try_from(count).unwrap_or(u32::MAX));
    let ink = if is_bright(ground) { [0; 3] } else { [255; 3] };
    let dot = side / 32;
    for (y, row) in tile.rows.into_iter().enumerate() {
        for (x, pixel) in row.iter_mut().enumerate() {
            let color = if x == 0 || y == 0 {
                BORDER
            } else if has_ink(&number, [x / dot, y / dot]) {
                ink
            } else {
                ground
            };
            *pixel = opaque(color);
        }
    }
}

/// Whether a digit covers a dot of the tile.
fn has_ink(number: &str, dot: [usize; 2]) -> bool {
    let [Some(x), Some(y)] = dot.map(|n| n.checked_sub(MARGIN)) else { return false };
    let column = x % ADVANCE;
    let digit = number.as_bytes().get(x / ADVANCE).map(|digit| usize::from(digit - b'0'));
    let Some(digit) = digit.filter(|_| column < WIDTH && y < HEIGHT) else { return false };
    GLYPHS[digit] >> (WIDTH * HEIGHT - 1 - y * WIDTH - column) & 1 == 1
}

/// Whether black is easier to read on it than white; weights of luma by Rec. 709.
fn is_bright([r, g, b]: [u8; 3]) -> bool {
    2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) > 10_000 * 140
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number as rows of dots.
    fn written(number: &str) -> Vec<String> {
        let row = |y: usize| {
            let dots = (0..number.len() * ADVANCE).map(|x| has_ink(number, [x + MARGIN, y + MARGIN]));
            dots.map(|ink| if ink { '#' } else { '.' }).collect()
        };
        (0..HEIGHT).map(row).collect()
    }

    #[test]
    fn digits_look_like_digits() {
        assert_eq!(written("17"), [".#..###.", "##....#.", ".#...#..", ".#...#..", "###..#.."]);
        assert_eq!(written("40"), ["#.#.###.", "#.#.#.#.", "###.#.#.", "..#.#.#.", "..#.###."]);
    }

    #[test]
    fn nothing_is_written_beside_the_number() {
        let all = [0, 1, MARGIN + 7, 40];
        assert!(!all.iter().any(|&x| has_ink("11", [x, MARGIN])));
        assert!(!has_ink("11", [MARGIN + 1, MARGIN + HEIGHT]));
    }
}
