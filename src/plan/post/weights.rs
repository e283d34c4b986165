//! Weights of the pixels around one.

use crate::math::round_to_f32;

/// One dimension of a separable Gaussian.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian {
    /// `weights[k]` is that of each of the two pixels at distance k + 1. The pixel itself has what is
    /// missing to 1. Never empty; the last is not 0, but for that of a single pixel.
    pub weights: Vec<f32>,
}

impl Gaussian {
    /// sigma = `radius` / 2, taps from −⌈radius⌉ to ⌈radius⌉, normalised in f64. `radius` is in pixels;
    /// `None` if it is so small that every pixel keeps its colour.
    #[must_use]
    pub fn new(radius: f64) -> Option<Self> {
        let sigma = radius / 2.0;
        let distances = (1..).map(f64::from).take_while(|k| *k < radius + 1.0);
        let side: Vec<f64> = distances.map(|k| libm::exp(-0.5 * (k / sigma) * (k / sigma))).collect();
        let sum = 1.0 + 2.0 * side.iter().sum::<f64>();
        let mut weights: Vec<f32> = side.iter().map(|weight| round_to_f32(weight / sum)).collect();
        while weights.last() == Some(&0.0) {
            weights.pop();
        }
        (!weights.is_empty()).then_some(Self { weights })
    }
}

impl Gaussian {
    /// That of a radius so small that every pixel keeps its colour.
    #[must_use]
    pub fn of_one_pixel() -> Self {
        Self { weights: vec![0.0] }
    }
}

/// A free correlation kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Pixels to each side that it looks at.
    pub reach: usize,
    /// Rows with weights, from above to below.
    pub rows: Vec<KernelRow>,
}

/// A row of a kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct KernelRow {
    /// Which, counted from `reach` pixels above the centre.
    pub row: usize,
    /// Columns, counted from `reach` pixels left of the centre, with their weights; those of 0 are absent.
    pub weights: Vec<(usize, f32)>,
}

impl Kernel {
    /// Settles an odd square of rows.
    #[must_use]
    pub fn new(kernel: &[Vec<f64>]) -> Self {
        let reach = kernel.len() / 2;
        let weights_of = |row: &Vec<f64>| -> Vec<(usize, f32)> {
            let weights = row.iter().map(|weight| round_to_f32(*weight)).enumerate();
            weights.filter(|(_, weight)| *weight != 0.0).collect()
        };
        let rows = kernel.iter().map(weights_of).enumerate();
        let rows: Vec<KernelRow> = rows
            .filter(|(_, weights)| !weights.is_empty())
            .map(|(row, weights)| KernelRow { row, weights })
            .collect();
        Self { reach, rows }
    }

    /// Whether every pixel keeps its colour.
    #[must_use]
    pub fn keeps_every_color(&self) -> bool {
        let reach = self.reach;
        matches!(self.rows.as_slice(), [only] if only.row == reach && only.weights == [(reach, 1.0)])
    }
}
