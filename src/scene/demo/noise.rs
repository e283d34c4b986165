//! Noise that repeats: from integers and polynomials alone, so the same on every machine.

/// A random number of a lattice point, in 0–1.
///
/// Source of the mixing: C. Wellons, "Prospecting for Hash Functions", 2018 (`lowbias32`).
pub fn random(x: u32, y: u32, seed: u32) -> f64 {
    let mix = |mut h: u32| {
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        h ^ (h >> 16)
    };
    f64::from(mix(x ^ mix(y ^ mix(seed)))) / f64::from(u32::MAX)
}

/// Random values on a lattice, smooth in between, in layers each twice as fine and half as strong
/// as the one before.
#[derive(Clone, Debug)]
pub struct Noise(Vec<Layer>);

/// One layer of [`Noise`].
#[derive(Clone, Debug)]
struct Layer {
    period: [u32; 2],
    /// Row by row, in 0–1.
    values: Vec<f64>,
    weight: f64,
}

impl Noise {
    /// `layers` of them, the first of `period` lattice points a unit.
    pub fn new(period: [u32; 2], layers: u32, seed: u32) -> Self {
        let strength = |i: u32| 1.0 / f64::from(1_u32 << i);
        let sum: f64 = (0..layers).map(strength).sum();
        let layer = |i| Layer::new(period.map(|p| p << i), strength(i) / sum, seed + i);
        Self((0..layers).map(layer).collect())
    }

    /// The noise at a point, in 0–1, `u` and `v` in 0–1. At 1 it is what it is at 0.
    pub fn at(&self, u: f64, v: f64) -> f64 {
        self.0.iter().map(|layer| layer.weight * layer.at(u, v)).sum()
    }
}

impl Layer {
    fn new(period: [u32; 2], weight: f64, seed: u32) -> Self {
        Self { period, values: lattice_points(period).map(|(x, y)| random(x, y, seed)).collect(), weight }
    }

    fn at(&self, u: f64, v: f64) -> f64 {
        let [columns, rows] = self.period;
        let (x, right) = lattice(u, columns);
        let (y, up) = lattice(v, rows);
        let next = |i: u32, count: u32| if i + 1 == count { 0 } else { i + 1 };
        let row = |y: u32| {
            let value = |x: u32| self.values[(y * columns + x) as usize];
            mix(value(x), value(next(x, columns)), smooth(right))
        };
        mix(row(y), row(next(y, rows)), smooth(up))
    }
}

/// Cellular noise: one site at random in each of `period` squares a unit; repeats like [`Noise`].
///
/// Source: S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996.
#[derive(Clone, Debug)]
pub struct Cells {
    period: [u32; 2],
    /// Row by row: x and y of the site in its square, and its random number, all in 0–1; with one
    /// more square on each side, so that no neighbour needs to be wrapped.
    sites: Vec<[f64; 3]>,
}

/// Where a point lies among the sites.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Distance to the nearest site, in lattice steps.
    pub nearest: f64,
    /// Distance to the next one; equal to `nearest` on the border between two cells.
    pub second: f64,
    /// The random number of the nearest site, in 0–1.
    pub id: f64,
}

impl Cells {
    /// Places the sites.
    pub fn new(period: [u32; 2], seed: u32) -> Self {
        let [columns, rows] = period;
        let site = |(x, y)| {
            let (x, y) = ((x + columns - 1) % columns, (y + rows - 1) % rows);
            [0, 1, 2].map(|number| random(x, y, seed + number))
        };
        Self { period, sites: lattice_points([columns + 2, rows + 2]).map(site).collect() }
    }

    /// The cell around a point, `u` and `v` in 0–1.
    pub fn at(&self, u: f64, v: f64) -> Cell {
        let [columns, rows] = self.period;
        let (x, right) = lattice(u, columns);
        let (y, up) = lattice(v, rows);
        let (mut nearest, mut second, mut id) = (f64::INFINITY, f64::INFINITY, 0.0);
        for dy in 0..3 {
            let first = ((y + dy) * (columns + 2) + x) as usize;
            for (dx, site) in (0..).zip(&self.sites[first..first + 3]) {
                let to_x = f64::from(dx) - 1.0 + site[0] - right;
                let to_y = f64::from(dy) - 1.0 + site[1] - up;
                let squared = to_x * to_x + to_y * to_y;
                if squared < nearest {
                    (nearest, second, id) = (squared, nearest, site[2]);
                } else {
                    second = second.min(squared);
                }
            }
        }
        Cell { nearest: nearest.sqrt(), second: second.sqrt(), id }
    }
}

/// `a` at 0, `b` at 1.
pub fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// 0 up to `from`, 1 from `to` on, smooth in between.
pub fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    smooth(((x - from) / (to - from)).clamp(0.0, 1.0))
}

fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// All points of a lattice, row by row.
fn lattice_points(period: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    (0..period[1]).flat_map(move |y| (0..period[0]).map(move |x| (x, y)))
}

/// The lattice point below `u` in 0–1 of `period` a unit, and how far above it `u` lies, in 0–1.
fn lattice(u: f64, period: u32) -> (u32, f64) {
    let at = u.clamp(0.0, 1.0) * f64::from(period);
    #[expect(clippy::cast_possible_truncation, reason = "0 ≤ at ≤ period, a u32")]
    let point = (at as u32).min(period - 1);
    (point, at - f64::from(point))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_stays_in_its_range() {
        let (noise, cells) = (Noise::new([5, 7], 4, 3), Cells::new([5, 7], 3));
        for step in 0..500 {
            let (u, v) = ((f64::from(step) * 0.0137).fract(), (f64::from(step) * 0.0071).fract());
            assert!((0.0..=1.0).contains(&noise.at(u, v)));
            let cell = cells.at(u, v);
            assert!(cell.nearest <= cell.second && cell.nearest < 1.5);
        }
    }

    #[test]
    fn noise_goes_on_across_the_border() {
        let (noise, cells) = (Noise::new([5, 7], 4, 3), Cells::new([5, 7], 3));
        for t in (0..=100).map(|step| f64::from(step) / 100.0) {
            for (start, end) in [((0.0, t), (1.0, t)), ((t, 0.0), (t, 1.0))] {
                assert!((noise.at(start.0, start.1) - noise.at(end.0, end.1)).abs() < 1e-12);
                let (a, b) = (cells.at(start.0, start.1), cells.at(end.0, end.1));
                assert!((a.nearest - b.nearest).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn random_numbers_are_spread_evenly() {
        let mean = (0..10_000).map(|i| random(i, 17, 4)).sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }
}
