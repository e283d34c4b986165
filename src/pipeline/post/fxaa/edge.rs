//! One pixel at an edge: which neighbour it should show, and how much of it.

use crate::pipeline::post::frame::Plane;

/// Smallest jump that is an edge, as a share of the brightest of a pixel and its four neighbours.
/// Source: FXAA 3.11, `fxaaQualityEdgeThreshold`, "high quality".
pub const EDGE_SHARE: f32 = 0.125;

/// Smallest jump that is an edge, in the dark. Source: FXAA 3.11, `fxaaQualityEdgeThresholdMin`, "high
/// quality".
pub const EDGE_MIN: f32 = 0.0625;

/// How much of a speck of one pixel is removed. Source: FXAA 3.11, `fxaaQualitySubpix`, default.
const SUBPIXEL: f32 = 0.75;

/// Pixels that an edge is followed to either side.
const SEARCH: usize = 16;

/// The brightness of a picture.
pub struct Luma<'a> {
    /// √Y, 0–1.
    pub plane: &'a Plane,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Luma<'_> {
    /// Brightness `dx` columns to the right of (x, y) and `dy` rows below; the picture's border repeats.
    fn at(&self, x: usize, y: usize, [dx, dy]: [isize; 2]) -> f32 {
        let x = x.saturating_add_signed(dx).min(self.width - 1);
        self.plane.row(y.saturating_add_signed(dy).min(self.height - 1))[x]
    }
}

/// The neighbour above, below, to the left or right of a pixel, and how much of it the pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mix {
    /// 0: above, 1: below, 2: left, 3: right.
    side: u8,
    /// 0–0.75.
    share: f32,
}

/// Steps of [`Mix::side`] in x and y.
const SIDES: [[isize; 2]; 4] = [[0, -1], [0, 1], [-1, 0], [1, 0]];

impl Mix {
    /// Both in one number, 0 for a pixel that stays as it is.
    pub fn code(self) -> f32 {
        if self.share > 0.0 { f32::from(self.side) + self.share } else { 0.0 }
    }

    /// The inverse of [`Mix::code`] for what is not 0, but for the last bits of the share.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a side is in 0–3")]
    pub fn from_code(code: f32) -> Self {
        let side = code.floor();
        Self { side: side as u8, share: code - side }
    }

    /// Column and row of the neighbour of the pixel (x, y).
    pub fn neighbour(self, x: usize, y: usize, width: usize, height: usize) -> [usize; 2] {
        let [dx, dy] = SIDES[usize::from(self.side)];
        [x.saturating_add_signed(dx).min(width - 1), y.saturating_add_signed(dy).min(height - 1)]
    }

    /// A pixel's value with its share of the neighbour's.
    pub fn blend(self, own: f32, neighbour: f32) -> f32 {
        own + (neighbour - own) * self.share
    }
}

/// What the pixel (x, y) of an edge shows of which neighbour.
pub fn mix(luma: &Luma, x: usize, y: usize) -> Mix {
    let around = |dx, dy| luma.at(x, y, [dx, dy]);
    let centre = around(0, 0);
    let [north, south, west, east] = SIDES.map(|[dx, dy]| around(dx, dy));
    let [nw, ne, sw, se] = [around(-1, -1), around(1, -1), around(-1, 1), around(1, 1)];

    // Second differences, across rows and across columns: the edge runs where they are larger.
    let across_rows = (nw - 2.0 * west + sw).abs()
        + 2.0 * (north - 2.0 * centre + south).abs()
        + (ne - 2.0 * east + se).abs();
    let across_columns = (nw - 2.0 * north + ne).abs()
        + 2.0 * (west - 2.0 * centre + east).abs()
        + (sw - 2.0 * south + se).abs();
    let horizontal = across_rows >= across_columns;
    let (first, second, first_side) = if horizontal { (north, south, 0) } else { (west, east, 2) };
    let is_first = (first - centre).abs() >= (second - centre).abs();
    let (other, side) = if is_first { (first, first_side) } else { (second, first_side + 1) };

    let speck = speck(centre, [north, south, west, east], [nw, ne, sw, se]);
    let along: [isize; 2] = if horizontal { [1, 0] } else { [0, 1] };
    let offset = edge_offset(luma, [x, y], along, SIDES[usize::from(side)], centre, other);
    Mix { side, share: if offset > speck { offset } else { speck } }
}

/// How much the pixel stands out of all eight around it: 0–[`SUBPIXEL`].
fn speck(centre: f32, sides: [f32; 4], corners: [f32; 4]) -> f32 {
    let sum = |of: [f32; 4]| (of[0] + of[1]) + (of[2] + of[3]);
    let mean = (2.0 * sum(sides) + sum(corners)) * (1.0 / 12.0);
    let most = sides.into_iter().fold(centre, |a, b| if a > b { a } else { b });
    let least = sides.into_iter().fold(centre, |a, b| if a < b { a } else { b });
    let share = (mean - centre).abs() / (most - least);
    let share = if share < 1.0 { share } else { 1.0 };
    let smooth = (3.0 - 2.0 * share) * share * share;
    smooth * smooth * SUBPIXEL
}

/// How far the border between pixel and neighbour lies beyond the edge's line: 0–½. The line runs from
/// one end of the edge to the other and passes the border in the middle.
fn edge_offset(
    luma: &Luma,
    [x, y]: [usize; 2],
    [ax, ay]: [isize; 2],
    [ox, oy]: [isize; 2],
    centre: f32,
    other: f32,
) -> f32 {
    let mean = (centre + other) * 0.5;
    let enough = (centre - other).abs() * 0.25;
    // Follows the border to one side until brightness there is no longer that here: steps, difference.
    let end = |sign: isize| {
        let mut steps = 0.0;
        let mut difference = 0.0;
        for step in (1..=SEARCH).map(|step| sign * step.cast_signed()) {
            let [dx, dy] = [ax * step, ay * step];
            difference = (luma.at(x, y, [dx, dy]) + luma.at(x, y, [dx + ox, dy + oy])) * 0.5 - mean;
            steps += 1.0;
            if difference.abs() >= enough {
                break;
            }
        }
        (steps, difference)
    };
    let (before, after) = (end(-1), end(1));
    let (nearer, difference) = if before.0 < after.0 { before } else { after };
    // Only where the line has left the pixel's side of the border at the nearer end.
    let is_beyond = (difference < 0.0) != (centre < mean);
    if is_beyond { 0.5 - nearer / (before.0 + after.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mix_survives_its_code() {
        for side in 0..4 {
            for share in [1e-6f32, 0.1, 0.5, SUBPIXEL] {
                let mix = Mix { side, share };
                let again = Mix::from_code(mix.code());
                assert_eq!(again.side, side);
                assert!((again.share - share).abs() <= 2.4e-7, "{share}: {}", again.share);
            }
        }
        assert_eq!(Mix { side: 3, share: 0.0 }.code(), 0.0);
    }

    #[test]
    fn neighbours_lie_where_sides_say_and_end_at_the_border() {
        let of = |side, x, y| Mix { side, share: 0.5 }.neighbour(x, y, 5, 4);
        assert_eq!([of(0, 2, 2), of(1, 2, 2), of(2, 2, 2), of(3, 2, 2)], [[2, 1], [2, 3], [1, 2], [3, 2]]);
        assert_eq!([of(0, 0, 0), of(1, 4, 3), of(2, 0, 0), of(3, 4, 3)], [[0, 0], [4, 3], [0, 0], [4, 3]]);
    }

    #[test]
    fn a_speck_is_one_that_stands_out_of_all_around_it() {
        assert_eq!(speck(1.0, [0.0; 4], [0.0; 4]), SUBPIXEL);
        let at_an_edge = speck(0.0, [1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]);
        assert!(at_an_edge > 0.0 && at_an_edge < 0.06, "{at_an_edge}");
    }
}
