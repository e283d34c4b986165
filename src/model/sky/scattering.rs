//! Light on its way through the air: densities, transmittance, scattering once and many times.
//!
//! Lengths are kilometres; colours are three wavelengths, 680, 550 and 440 nm, taken as linear red,
//! green and blue. The sun's irradiance above the air is 1.

use glam::DVec3;

/// Radius of the earth.
pub const GROUND_KM: f64 = 6360.0;

/// Radius at which the air ends: what is above scatters less than a thousandth.
const TOP_KM: f64 = GROUND_KM + 60.0;

/// Scattering by molecules at the ground, per kilometre; it falls by e every 8 km.
/// Source: S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique",
/// EGSR 2020, table 1 (after E. Bruneton, "A Qualitative and Quantitative Evaluation of 8 Clear Sky
/// Models", 2017), as are the other constants of the air.
const RAYLEIGH_PER_KM: DVec3 = DVec3::new(5.802e-3, 13.558e-3, 33.1e-3);
const RAYLEIGH_HEIGHT_KM: f64 = 8.0;

/// Haze falls by e every 1.2 km, and scatters nine tenths of what it takes.
const HAZE_HEIGHT_KM: f64 = 1.2;
const HAZE_ALBEDO: f64 = 0.9;

/// Absorption by ozone where it is densest, at 25 km; it fades linearly over 15 km.
const OZONE_PER_KM: DVec3 = DVec3::new(0.650e-3, 1.881e-3, 0.085e-3);
const OZONE_CENTRE_KM: f64 = 25.0;
const OZONE_REACH_KM: f64 = 15.0;

/// Share of light that the ground sends back, for what is scattered many times.
const GROUND_ALBEDO: f64 = 0.3;

/// The air with a given haze.
#[derive(Clone, Copy, Debug)]
pub struct Air {
    /// Extinction by haze at the ground, per kilometre.
    haze_per_km: DVec3,
}

/// What a kilometre of air does at some altitude.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Share that molecules scatter.
    pub rayleigh: DVec3,
    /// Share that haze scatters.
    pub haze: DVec3,
    /// Share that is lost.
    pub extinction: DVec3,
}

impl Air {
    /// Air of a turbidity, at least 1 (no haze at all).
    ///
    /// Haze takes `exp(−β λ^−1.3)` of light from straight above (λ in micrometres), β = 0.04608 T −
    /// 0.04586. Source: A. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight",
    /// SIGGRAPH 1999, appendix A.1 (Ångström's formula).
    pub fn new(turbidity: f64) -> Self {
        let beta = (0.04608 * turbidity - 0.04586).max(0.0);
        let depth = DVec3::new(0.68, 0.55, 0.44).map(|micrometres| beta * libm::pow(micrometres, -1.3));
        Self { haze_per_km: depth / HAZE_HEIGHT_KM }
    }

    /// The air at an altitude.
    pub fn at(&self, altitude_km: f64) -> Medium {
        let rayleigh = RAYLEIGH_PER_KM * libm::exp(-altitude_km / RAYLEIGH_HEIGHT_KM);
        let haze = self.haze_per_km * libm::exp(-altitude_km / HAZE_HEIGHT_KM);
        let ozone = OZONE_PER_KM * (1.0 - (altitude_km - OZONE_CENTRE_KM).abs() / OZONE_REACH_KM).max(0.0);
        Medium { rayleigh, haze: haze * HAZE_ALBEDO, extinction: rayleigh + haze + ozone }
    }
}

impl Medium {
    /// Share of light that passes `length_km` of it, and that many kilometres' worth of scattering seen
    /// through itself: `∫ exp(−σ s) ds`.
    fn pass(&self, length_km: f64) -> (DVec3, DVec3) {
        let passes = self.extinction.map(|sigma| libm::exp(-sigma * length_km));
        (passes, (DVec3::ONE - passes) / self.extinction)
    }
}

/// A line of sight: where it starts, and the cosines of its angles with the zenith and the sun.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Distance from the earth's centre.
    pub radius_km: f64,
    /// Cosine of the angle with the zenith.
    pub up: f64,
    /// Cosine of the angle with the direction towards the sun.
    pub sunwards: f64,
    /// Cosine of the sun's angle with the zenith.
    pub sun_up: f64,
}

/// A part of a line of sight, as if the air were the same all along it.
struct Step {
    altitude_km: f64,
    /// Cosine of the sun's angle with the zenith there.
    sun_up: f64,
    length_km: f64,
}

impl Sight {
    /// Whether it ends at the ground, and its length.
    fn end(&self) -> (bool, f64) {
        let (r, mu) = (self.radius_km, self.up);
        let beneath = r * r * (mu * mu - 1.0);
        let ground = beneath + GROUND_KM * GROUND_KM;
        if mu < 0.0 && ground >= 0.0 {
            (true, (-r * mu - ground.sqrt()).max(0.0))
        } else {
            (false, (-r * mu + (beneath + TOP_KM * TOP_KM).max(0.0).sqrt()).max(0.0))
        }
    }

    /// Its parts up to `length_km`, short where it starts: there the air is densest.
    fn steps(self, length_km: f64, count: u32) -> impl Iterator<Item = Step> {
        (0..count).map(move |i| {
            let [near, far] = [i, i + 1].map(|i| {
                let share = f64::from(i) / f64::from(count);
                length_km * share * share
            });
            self.step((near + far) * 0.5, far - near)
        })
    }

    fn step(&self, at_km: f64, length_km: f64) -> Step {
        let r = self.radius_km;
        let there = (r * r + at_km * at_km + 2.0 * r * self.up * at_km).sqrt();
        Step {
            altitude_km: (there - GROUND_KM).max(0.0),
            sun_up: (r * self.sun_up + at_km * self.sunwards) / there,
            length_km,
        }
    }
}

/// A function of altitude and of the sun's height, on a grid.
#[derive(Clone, Debug)]
struct Grid {
    altitudes: usize,
    suns: usize,
    /// Cosines of the sun's angle with the zenith, least and range.
    sun_up: [f64; 2],
    values: Vec<DVec3>,
}

impl Grid {
    fn of([altitudes, suns]: [usize; 2], [least, most]: [f64; 2], value: impl Fn(f64, f64) -> DVec3) -> Self {
        let mut values = Vec::with_capacity(altitudes * suns);
        for i in 0..altitudes {
            let altitude_km = altitude_of(part(i, altitudes));
            for j in 0..suns {
                values.push(value(altitude_km, least + (most - least) * part(j, suns)));
            }
        }
        Self { altitudes, suns, sun_up: [least, most - least], values }
    }

    /// Bilinear between the grid's points.
    fn at(&self, altitude_km: f64, sun_up: f64) -> DVec3 {
        let (i, s) = place(share_of(altitude_km), self.altitudes);
        let (j, t) = place((sun_up - self.sun_up[0]) / self.sun_up[1], self.suns);
        let row = |i: usize| {
            let (a, b) = (self.values[i * self.suns + j], self.values[i * self.suns + j + 1]);
            a + (b - a) * t
        };
        let (a, b) = (row(i), row(i + 1));
        a + (b - a) * s
    }
}

/// Where a grid has an altitude, 0–1: half of its points lie in the lowest tenth of the air, evenly
/// where haze is.
fn share_of(altitude_km: f64) -> f64 {
    altitude_km / (altitude_km + CROWDED_KM) / AIR_SHARE
}

/// The altitude at a share of a grid: the inverse of [`share_of`].
fn altitude_of(share: f64) -> f64 {
    let share = share * AIR_SHARE;
    share * CROWDED_KM / (1.0 - share)
}

const CROWDED_KM: f64 = 5.0;
const AIR_SHARE: f64 = (TOP_KM - GROUND_KM) / (TOP_KM - GROUND_KM + CROWDED_KM);

/// `i` of `count` points from 0 to 1.
#[expect(clippy::cast_precision_loss, reason = "grids have a few dozen points")]
pub fn part(i: usize, count: usize) -> f64 {
    i as f64 / (count - 1) as f64
}

/// The point before `share` of 0–1, and how far it is to the next.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to a grid of a few dozen points"
)]
fn place(share: f64, count: usize) -> (usize, f64) {
    let x = share.clamp(0.0, 1.0) * (count - 1) as f64;
    let first = (x as usize).min(count - 2);
    (first, x - first as f64)
}

/// Parts of the way to the sun, of a line of sight, and of one for light that is scattered often.
const SUN_STEPS: u32 = 24;
const SIGHT_STEPS: u32 = 24;
const AGAIN_STEPS: u32 = 10;

/// Air under one sun.
#[derive(Clone, Debug)]
pub struct SunlitAir {
    air: Air,
    /// Share of the sun's light that reaches a place.
    sunlight: Grid,
    /// Radiance of light that was scattered twice and more, the same in all directions, per share that
    /// a place scatters.
    again: Grid,
}

/// What a line of sight gathers, of an irradiance of 1 above the air. Times its phase function each.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathered {
    /// Scattered once by molecules.
    pub rayleigh: DVec3,
    /// Scattered once by haze.
    pub haze: DVec3,
    /// Scattered more often, with its (even) phase function in it.
    pub again: DVec3,
}

impl SunlitAir {
    /// Prepares air for a sun at `sun_up`, the cosine of its angle with the zenith.
    pub fn new(air: Air, sun_up: f64) -> Self {
        // A line of sight leaves the air within 8°: as far does the sun's angle change on its way, and
        // twice as far on that of light that is scattered again.
        let [near, far] = [0.16, 0.32].map(|reach| [(sun_up - reach).max(-1.0), (sun_up + reach).min(1.0)]);
        let sunlight =
            Grid::of([24, 64], far, |altitude_km, sun_up| transmittance(&air, altitude_km, sun_up));
        let again = Grid::of([8, 16], near, |altitude_km, sun_up| {
            scattered_again(&air, &sunlight, altitude_km, sun_up)
        });
        Self { air, sunlight, again }
    }

    /// Share of the sun's light that reaches the ground.
    pub fn at_ground(&self, sun_up: f64) -> DVec3 {
        self.sunlight.at(0.0, sun_up)
    }

    /// Gathers what is scattered into a line of sight that starts at the ground and does not end there.
    pub fn gather(&self, sight: Sight) -> Gathered {
        let (_, length_km) = sight.end();
        let mut gathered = Gathered::default();
        let mut passed = DVec3::ONE;
        for step in sight.steps(length_km, SIGHT_STEPS) {
            let medium = self.air.at(step.altitude_km);
            let (passes, scatters) = medium.pass(step.length_km);
            let lit = passed * scatters * self.sunlight.at(step.altitude_km, step.sun_up);
            let again = passed * scatters * self.again.at(step.altitude_km, step.sun_up);
            gathered.rayleigh += medium.rayleigh * lit;
            gathered.haze += medium.haze * lit;
            gathered.again += (medium.rayleigh + medium.haze) * again;
            passed *= passes;
        }
        gathered
    }
}

/// Share of the sun's light that reaches an altitude; none through the earth.
fn transmittance(air: &Air, altitude_km: f64, sun_up: f64) -> DVec3 {
    let radius_km = GROUND_KM + altitude_km;
    let sight = Sight { radius_km, up: sun_up, sunwards: 1.0, sun_up };
    let (_, length_km) = Sight { up: sun_up.abs(), ..sight }.end();
    // Half a degree around the edge of the earth, as wide as the sun.
    let horizon = -(1.0 - (GROUND_KM / radius_km) * (GROUND_KM / radius_km)).max(0.0).sqrt();
    let seen = ((sun_up - horizon) / 0.0093 + 0.5).clamp(0.0, 1.0);
    let length_km = if sun_up < 0.0 { length_km - 2.0 * radius_km * sun_up } else { length_km };
    let depth: DVec3 = sight
        .steps(length_km, SUN_STEPS)
        .map(|step| air.at(step.altitude_km).extinction * step.length_km)
        .sum();
    depth.map(|depth| libm::exp(-depth)) * seen
}

/// Radiance of light that was scattered at least twice, for a place that scatters all it meets.
///
/// The second scattering is integrated over directions; each further one adds the same share of the one
/// before, a geometric series. Source: Hillaire 2020, section 5.5.
fn scattered_again(air: &Air, sunlight: &Grid, altitude_km: f64, sun_up: f64) -> DVec3 {
    let across = (1.0 - sun_up * sun_up).max(0.0).sqrt();
    let (mut second, mut share) = (DVec3::ZERO, DVec3::ZERO);
    for up in [-0.875, -0.625, -0.375, -0.125, 0.125, 0.375, 0.625, 0.875_f64] {
        for azimuth_cosine in [-0.5_f64.sqrt(), 0.5_f64.sqrt()] {
            let sunwards = up * sun_up + (1.0 - up * up).sqrt() * across * azimuth_cosine;
            let sight = Sight { radius_km: GROUND_KM + altitude_km, up, sunwards, sun_up };
            let (radiance, scattered) = look_around(air, sunlight, sight);
            second += radiance / 16.0;
            share += scattered / 16.0;
        }
    }
    second / (DVec3::ONE - share.min(DVec3::splat(0.95)))
}

/// Radiance from a direction by one even scattering or the ground, and the share of what is sent that
/// way that is scattered on it.
fn look_around(air: &Air, sunlight: &Grid, sight: Sight) -> (DVec3, DVec3) {
    let even = 0.25 * std::f64::consts::FRAC_1_PI;
    let (is_ground, length_km) = sight.end();
    let (mut radiance, mut share, mut passed) = (DVec3::ZERO, DVec3::ZERO, DVec3::ONE);
    for step in sight.steps(length_km, AGAIN_STEPS) {
        let medium = air.at(step.altitude_km);
        let (passes, scatters) = medium.pass(step.length_km);
        let scattered = passed * scatters * (medium.rayleigh + medium.haze);
        radiance += scattered * sunlight.at(step.altitude_km, step.sun_up) * even;
        share += scattered;
        passed *= passes;
    }
    if is_ground {
        let sun_up = sight.step(length_km, 0.0).sun_up;
        let lit = sunlight.at(0.0, sun_up) * sun_up.max(0.0);
        radiance += passed * lit * (GROUND_ALBEDO * std::f64::consts::FRAC_1_PI);
    }
    (radiance, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_down_passes_what_the_optical_depths_say() {
        // Molecules: 13.558e-3 · 8 km; ozone: 1.881e-3 · 15 km; haze by Ångström's formula.
        for (turbidity, haze) in [(1.0, 0.04608 - 0.04586), (3.0, 3.0 * 0.04608 - 0.04586)] {
            let depth = 13.558e-3 * 8.0 + 1.881e-3 * 15.0 + haze * 0.55_f64.powf(-1.3);
            let passes = transmittance(&Air::new(turbidity), 0.0, 1.0).y;
            assert!((passes / (-depth).exp() - 1.0).abs() < 0.01, "{turbidity}: {passes}");
        }
    }

    #[test]
    fn the_earth_hides_the_sun() {
        let air = Air::new(3.0);
        assert_eq!(transmittance(&air, 0.0, -0.02), DVec3::ZERO);
        assert!(transmittance(&air, 50.0, -0.02).min_element() > 0.5);
        assert_eq!(transmittance(&air, 50.0, -0.3), DVec3::ZERO);
    }

    #[test]
    fn nothing_gathers_more_than_falls_in() {
        for turbidity in [1.0, 3.0, 20.0] {
            for sun_up in [-1.0, -0.1, 0.0, 0.2, 1.0] {
                let air = SunlitAir::new(Air::new(turbidity), sun_up);
                for up in [0.0, 0.01, 0.3, 1.0] {
                    let sight = Sight { radius_km: GROUND_KM, up, sunwards: up * sun_up, sun_up };
                    let Gathered { rayleigh, haze, again } = air.gather(sight);
                    let sum = rayleigh + haze + again;
                    assert!(
                        sum.min_element() >= 0.0 && sum.max_element() <= 2.0,
                        "{turbidity} {sun_up}: {sum}"
                    );
                }
            }
        }
    }
}
