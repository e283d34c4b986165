//! The palette: up to 255 colours that stand for all those of some frames.
//!
//! Colours that are few enough are kept as they are. Else the colour cube is cut into boxes, and a colour
//! finds the mean of the nearest by its cell. Only integers and basic f64 arithmetic in a fixed order:
//! the same palette on every machine.

use super::boxes::{Cells, cell_of, cut};
use super::nearest::nearest;
use crate::pipeline::{Cancelled, Work};
use std::collections::BTreeSet;

/// The index that shows what is behind.
pub(super) const TRANSPARENT: u8 = 255;

/// Entries for colours: one of 256 is [`TRANSPARENT`].
const COLORS: usize = 255;

/// A pixel with at least this alpha is there.
const OPAQUE_ALPHA: u8 = 128;

/// Colours and the way to them.
pub(super) struct Palette {
    /// At most [`COLORS`].
    colors: Vec<[u8; 3]>,
    way: Way,
}

/// How a colour finds its index.
enum Way {
    /// Every colour is there as it is, in order.
    Exact,
    /// By its cell.
    Nearest {
        /// For each cell the index of the colour nearest to its centre.
        of_cell: Vec<u8>,
        /// Codes between neighbouring colours, about.
        spacing: f64,
    },
}

impl Palette {
    /// The palette for all of `frames`.
    pub(super) fn of<'a>(
        frames: impl Iterator<Item = &'a [[u8; 4]]> + Clone,
        work: &Work,
    ) -> Result<Self, Cancelled> {
        if let Some(colors) = few_colors(frames.clone()) {
            return Ok(Self { colors, way: Way::Exact });
        }
        let mut cells = Cells::default();
        for frame in frames {
            work.check()?;
            frame.iter().filter(|pixel| is_there(**pixel)).for_each(|pixel| cells.add(rgb(*pixel)));
        }
        let boxes = cut(&mut cells.occupied(), COLORS);
        let (weight, error) = boxes.iter().fold((0.0, 0.0), |sum, b| (sum.0 + b.weight, sum.1 + b.error));
        let colors: Vec<[u8; 3]> = boxes.iter().map(|b| b.mean.map(rounded)).collect();
        let of_cell = nearest(&colors, work)?;
        // A uniform step Δ has a mean squared error of Δ²/12, and that in each of three channels.
        Ok(Self { colors, way: Way::Nearest { of_cell, spacing: (error / weight * 4.0).sqrt() } })
    }

    /// Codes between neighbouring colours, about; 0 if every colour is there as it is.
    pub(super) fn spacing(&self) -> f64 {
        match self.way {
            Way::Exact => 0.0,
            Way::Nearest { spacing, .. } => spacing,
        }
    }

    /// The index for a pixel whose channels are moved by `offset` codes (0 where the palette is exact).
    pub(super) fn index(&self, pixel: [u8; 4], offset: i8) -> u8 {
        if !is_there(pixel) {
            return TRANSPARENT;
        }
        let color = rgb(pixel);
        match &self.way {
            Way::Exact => {
                let at = self.colors.binary_search(&color).expect("every colour is there");
                u8::try_from(at).expect("fewer than 256 colours")
            }
            Way::Nearest { of_cell, .. } => {
                of_cell[cell_of(color.map(|code| code.saturating_add_signed(offset)))]
            }
        }
    }

    /// Red, green, blue of all 256 entries, for the file.
    pub(super) fn rgb(&self) -> Vec<u8> {
        let mut rgb = self.colors.as_flattened().to_vec();
        rgb.resize(256 * 3, 0);
        rgb
    }
}

fn is_there(pixel: [u8; 4]) -> bool {
    pixel[3] >= OPAQUE_ALPHA
}

fn rgb(pixel: [u8; 4]) -> [u8; 3] {
    [pixel[0], pixel[1], pixel[2]]
}

/// All colours in order, if they are few enough to be kept.
fn few_colors<'a>(frames: impl Iterator<Item = &'a [[u8; 4]]>) -> Option<Vec<[u8; 3]>> {
    let (mut colors, mut last) = (BTreeSet::new(), None);
    for &pixel in frames.flatten() {
        if last != Some(pixel) && is_there(pixel) {
            colors.insert(rgb(pixel));
            if colors.len() > COLORS {
                return None;
            }
        }
        last = Some(pixel);
    }
    Some(colors.into_iter().collect())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of codes is in 0–255")]
fn rounded(code: f64) -> u8 {
    (code + 0.5).floor() as u8
}
