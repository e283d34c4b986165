//! Low-discrepancy points: Sobol's first two dimensions, scrambled after A. Owen.
//!
//! Any 2ⁿ points in a row from the first leave one in each of 2ⁿ boxes of equal area, whichever their
//! shape. Source: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020.

/// An endless sequence of points in the unit square, and others that are independent of them.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    seed: u32,
}

impl Sequence {
    /// The sequence number `half` of a pixel.
    pub fn new([x, y]: [u32; 2], half: u32) -> Self {
        Self { seed: hash(hash(hash(x) ^ y).wrapping_add(half)) }
    }

    /// Point `index` of the pair of dimensions `pair`, in [0, 1)².
    pub fn point(self, index: u32, pair: u32) -> [f64; 2] {
        let seed = hash(self.seed ^ hash(pair));
        let index = scrambled(index, seed);
        let point = [index.reverse_bits(), sobol(index)];
        [0, 1].map(|axis| unit(scrambled(point[axis as usize], hash(seed ^ (axis + 1)))))
    }
}

/// The middle of the interval that 32 bits stand for.
fn unit(bits: u32) -> f64 {
    (f64::from(bits) + 0.5) / 4_294_967_296.0
}

/// Sobol's second dimension. (The first is the index with its bits reversed.)
fn sobol(mut index: u32) -> u32 {
    let (mut bits, mut direction) = (0, 1 << 31);
    while index > 0 {
        if index & 1 == 1 {
            bits ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

/// Owen's nested scrambling: each bit is flipped or not by a hash of those above it.
fn scrambled(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits().wrapping_add(seed);
    // S. Laine, T. Karras, "Stratified Sampling for Stochastic Transparency", 2011, with Burley's constants.
    for factor in [0x6c50_b47c_u32, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

/// Source: C. Wellons, "Prospecting for Hash Functions", 2018 (lowbias32).
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_box_holds_one_point() {
        for (pixel, half, pair) in [([0, 0], 0, 0), ([3, 9], 1, 0), ([250, 17], 0, 5)] {
            let sequence = Sequence::new(pixel, half);
            for power in 0..8u32 {
                let count = 1 << power;
                for rows in 0..=power {
                    let [across, down] = [f64::from(1 << (power - rows)), f64::from(1 << rows)];
                    let mut boxes: Vec<f64> = (0..count)
                        .map(|i| {
                            let [x, y] = sequence.point(i, pair);
                            (x * across).floor() + (y * down).floor() * across
                        })
                        .collect();
                    boxes.sort_unstable_by(f64::total_cmp);
                    assert_eq!(boxes, (0..count).map(f64::from).collect::<Vec<_>>(), "{power} {rows}");
                }
            }
        }
    }

    #[test]
    fn pairs_of_dimensions_know_nothing_of_each_other() {
        let sequence = Sequence::new([1, 2], 0);
        let count = 4096;
        let centred = |i: u32, pair: u32, axis: usize| sequence.point(i, pair)[axis] - 0.5;
        for (pair, axis) in [(1, 0), (1, 1), (2, 0), (2, 1)] {
            let product: f64 = (0..count).map(|i| centred(i, 0, 0) * centred(i, pair, axis)).sum();
            // Of independent numbers the correlation is 1/√4096 = 0.016 in the root mean square.
            let correlation = product / f64::from(count) * 12.0;
            assert!(correlation.abs() < 0.05, "{pair} {axis}: {correlation}");
        }
    }
}
