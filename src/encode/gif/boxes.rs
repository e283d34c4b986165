//! The colour cube cut into boxes.
//!
//! Pixels are counted in cells of 8 × 4 × 8 codes; then the box of cells with the greatest squared error
//! is cut in two at its mean, again and again. After X. Wu, "Efficient Statistical Computations for
//! Optimal Color Quantization", Graphics Gems II, 1991, cutting at the mean in place of the best plane.

/// Cells of the colour cube: 5 bits of red, 6 of green, 5 of blue.
pub(super) const CELLS: usize = 1 << 16;

/// The cell of a colour.
pub(super) fn cell_of([r, g, b]: [u8; 3]) -> usize {
    usize::from(r >> 3) << 11 | usize::from(g >> 2) << 5 | usize::from(b >> 3)
}

/// The codes in the middle of a cell.
pub(super) fn centre_of(cell: usize) -> [i32; 3] {
    let cell = i32::try_from(cell).expect("one of 2¹⁶");
    [(cell >> 11) << 3 | 4, (cell >> 5 & 63) << 2 | 2, (cell & 31) << 3 | 4]
}

/// How many pixels each cell has, and the sums of their codes.
pub(super) struct Cells(Vec<[u64; 4]>);

impl Default for Cells {
    fn default() -> Self {
        Self(vec![[0; 4]; CELLS])
    }
}

impl Cells {
    /// Counts a pixel.
    pub(super) fn add(&mut self, [r, g, b]: [u8; 3]) {
        let sums = &mut self.0[cell_of([r, g, b])];
        for (sum, part) in sums.iter_mut().zip([1, r, g, b]) {
            *sum += u64::from(part);
        }
    }

    /// Those that have pixels.
    pub(super) fn occupied(self) -> Vec<Cell> {
        self.0.into_iter().filter(|sums| sums[0] > 0).map(Cell::new).collect()
    }
}

/// The pixels of a cell.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    /// How many they are.
    weight: f64,
    mean: [f64; 3],
}

impl Cell {
    #[expect(clippy::cast_precision_loss, reason = "sums of fewer than 2⁴⁵ codes are exact")]
    fn new([count, r, g, b]: [u64; 4]) -> Self {
        let weight = count as f64;
        Self { weight, mean: [r, g, b].map(|sum| sum as f64 / weight) }
    }
}

/// Some of the cells.
pub(super) struct ColorBox {
    /// Where they are.
    cells: std::ops::Range<usize>,
    /// Their pixels.
    pub(super) weight: f64,
    /// Their mean colour.
    pub(super) mean: [f64; 3],
    /// Sum over the pixels of their squared distance to the mean.
    pub(super) error: f64,
    /// The channel that has most of it.
    axis: usize,
}

/// Cuts `cells` into at most `count` boxes, reordering them.
pub(super) fn cut(cells: &mut [Cell], count: usize) -> Vec<ColorBox> {
    let mut boxes = vec![ColorBox::around(cells, 0..cells.len())];
    while boxes.len() < count {
        let (worst, _) = boxes
            .iter()
            .enumerate()
            .fold((0, 0.0), |worst, (at, b)| if b.error > worst.1 { (at, b.error) } else { worst });
        let Some([low, high]) = boxes[worst].halves(cells) else { break };
        boxes[worst] = low;
        boxes.push(high);
    }
    boxes
}

impl ColorBox {
    fn around(cells: &[Cell], range: std::ops::Range<usize>) -> Self {
        let own = &cells[range.clone()];
        let weight: f64 = own.iter().map(|cell| cell.weight).sum();
        let mean = [0, 1, 2].map(|c| own.iter().map(|cell| cell.weight * cell.mean[c]).sum::<f64>() / weight);
        let errors = [0, 1, 2].map(|c| {
            let squared = |cell: &Cell| (cell.mean[c] - mean[c]) * (cell.mean[c] - mean[c]);
            own.iter().map(|cell| cell.weight * squared(cell)).sum::<f64>()
        });
        let axis = (1..3).fold(0, |axis, c| if errors[c] > errors[axis] { c } else { axis });
        Self { cells: range, weight, mean, error: errors[0] + errors[1] + errors[2], axis }
    }

    /// The cells below the mean and those above it; `None` if all are alike.
    fn halves(&self, cells: &mut [Cell]) -> Option<[Self; 2]> {
        let own = &mut cells[self.cells.clone()];
        let mut low = 0;
        for at in 0..own.len() {
            if own[at].mean[self.axis] <= self.mean[self.axis] {
                own.swap(at, low);
                low += 1;
            }
        }
        if low == 0 || low == own.len() {
            return None;
        }
        let middle = self.cells.start + low;
        Some([Self::around(cells, self.cells.start..middle), Self::around(cells, middle..self.cells.end)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(colors: &[([u8; 3], u32)], count: usize) -> Vec<ColorBox> {
        let mut cells = Cells::default();
        for (color, times) in colors {
            (0..*times).for_each(|_| cells.add(*color));
        }
        cut(&mut cells.occupied(), count)
    }

    #[test]
    fn the_centre_of_a_cell_lies_in_it() {
        for cell in 0..CELLS {
            let centre = centre_of(cell).map(|code| u8::try_from(code).expect("a code"));
            assert_eq!(cell_of(centre), cell);
        }
    }

    #[test]
    fn clusters_far_apart_get_a_box_each() {
        let clusters = [([0, 0, 0], 50), ([255, 255, 255], 9), ([255, 0, 0], 20), ([0, 0, 255], 1)];
        let mut means: Vec<[f64; 3]> = boxes(&clusters, 4).iter().map(|b| b.mean).collect();
        means.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let mut expected = clusters.map(|(color, _)| color.map(f64::from));
        expected.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        assert_eq!(means, expected);
    }

    #[test]
    fn no_box_is_cut_that_has_no_error() {
        assert_eq!(boxes(&[([9, 9, 9], 3), ([200, 9, 9], 3)], 255).len(), 2);
    }
}
