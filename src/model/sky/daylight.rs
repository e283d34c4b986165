//! A clear or hazy sky by day and at dusk, with its sun.

use super::scattering::{Air, GROUND_KM, Gathered, Sight, SunlitAir, part};
use crate::math::round_to_f32;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::fmt;

/// A sky: light of the sun, scattered once by molecules and haze after T. Nishita et al., "Display of
/// The Earth Taking into Account Atmospheric Scattering", SIGGRAPH 1993, and more often after S.
/// Hillaire, EGSR 2020; haze by the turbidity of Preetham et al., SIGGRAPH 1999.
///
/// Everything that depends on elevation and azimuth but not on the angle to the sun is in a table;
/// what is left for each pixel are the two phase functions. Below the horizon lies a plain, hidden by
/// haze towards the horizon, where sky and plain meet in the same colour.
#[derive(Clone, PartialEq)]
pub struct Daylight {
    /// Unit vector towards the sun.
    pub towards_sun: DVec3,
    /// Haze: 1 is air alone, 3 a clear day, 10 thick haze.
    pub turbidity: f64,
    /// `ROWS × COLUMNS` entries: red, green, blue that molecules scatter, the same that haze scatters,
    /// two times nothing; to be multiplied by [`rayleigh_phase`] and [`haze_phase`].
    ///
    /// Row i is the elevation whose sine is `(i / (ROWS − 1))²`; column j the azimuth from the sun whose
    /// cosine is `1 − 2 j / (COLUMNS − 1)`.
    pub table: Vec<[f32; 8]>,
    /// Radiance of the sun's disc.
    pub disc: Vec3,
    /// Radiance of the plain.
    pub ground: Vec3,
    /// Radiance of the night, everywhere.
    pub night: Vec3,
}

/// Elevations of the table.
pub const ROWS: usize = 64;

/// Azimuths of the table.
pub const COLUMNS: usize = 16;

/// The asymmetry of the haze's phase function: the mean cosine of its angle. Source: Hillaire 2020, table 1.
pub const HAZE_G: f64 = 0.8;

/// Half the angle under which the sun is seen: 0.2666°.
pub const SUN_RADIUS: f64 = 0.004_653;

/// Radiance of the sun's disc above the air. The real one is hundreds of times as bright and would
/// drown a picture that blurs it.
const DISC_RADIANCE: f64 = 250.0;

/// Radiance of the sky per irradiance of the sun: white under a light of intensity 2.5 to 3 and the sky
/// above it are then as bright as outdoors, without a tone mapper.
const EXPOSURE: f64 = 8.0;

/// Mean radiances, per irradiance of the sun, between which [`EXPOSURE`] holds: from a sun 10° high to a
/// clear midday.
const DUSK: f64 = 0.02;
const DAY: f64 = 0.057;

/// How much of darker and brighter skies the eye makes up for: the exponent of their ratio to these.
const ADAPTATION: f64 = 0.55;

/// A moonless night in the country, so that none is quite black.
const NIGHT: DVec3 = DVec3::new(0.0004, 0.0006, 0.0012);

/// Colour of the plain: dry soil and grass.
const GROUND: DVec3 = DVec3::new(0.2, 0.19, 0.17);

/// Rec. 709 luminance.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

impl Daylight {
    /// Computes a sky for a unit vector towards the sun and a turbidity of at least 1.
    #[must_use]
    pub fn new(towards_sun: DVec3, turbidity: f64) -> Self {
        let sun_up = towards_sun.y.clamp(-1.0, 1.0);
        let air = SunlitAir::new(Air::new(turbidity), sun_up);
        let gathered: Vec<Gathered> =
            (0..ROWS * COLUMNS).into_par_iter().map(|at| air.gather(sight(at, sun_up))).collect();
        let sky = mean(&gathered, sun_up);
        let exposure = exposure(sky.dot(LUMINANCE));
        let sun = air.at_ground(sun_up);
        let plain = sky + sun * (sun_up.max(0.0) * std::f64::consts::FRAC_1_PI);
        let entry = |gathered: &Gathered| {
            let [molecules, haze] = [gathered.molecules(), gathered.haze].map(|share| share * exposure);
            let (m, h) = (molecules, haze);
            [m.x, m.y, m.z, h.x, h.y, h.z, 0.0, 0.0].map(round_to_f32)
        };
        Self {
            towards_sun,
            turbidity,
            table: gathered.iter().map(entry).collect(),
            disc: rounded(sun * DISC_RADIANCE),
            ground: rounded(GROUND * plain * exposure),
            night: rounded(NIGHT),
        }
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        size_of_val(self.table.as_slice()) as u64
    }
}

impl Gathered {
    /// What is scattered as molecules do it: light that was scattered more often has little shape left,
    /// and takes theirs.
    fn molecules(&self) -> DVec3 {
        self.rayleigh + self.again * (4.0 * std::f64::consts::PI)
    }
}

/// What it is made of stands for the table.
impl fmt::Debug for Daylight {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Daylight")
            .field("towards_sun", &self.towards_sun)
            .field("turbidity", &self.turbidity)
            .finish_non_exhaustive()
    }
}

/// What the radiances of a sky are multiplied by, given their mean. A brighter sky stays the brighter
/// one: the exponent is less than 1.
fn exposure(mean: f64) -> f64 {
    let ratio = match mean {
        mean if mean < DUSK => DUSK / mean.max(1e-9),
        mean if mean > DAY => DAY / mean,
        _ => 1.0,
    };
    EXPOSURE * libm::pow(ratio, ADAPTATION)
}

/// The line of sight of a table's entry.
fn sight(at: usize, sun_up: f64) -> Sight {
    let row = part(at / COLUMNS, ROWS);
    let up = row * row;
    let azimuth_cosine = 1.0 - 2.0 * part(at % COLUMNS, COLUMNS);
    let [across, sun_across] = [up, sun_up].map(|y: f64| (1.0 - y * y).max(0.0).sqrt());
    let sunwards = up * sun_up + across * sun_across * azimuth_cosine;
    Sight { radius_km: GROUND_KM, up, sunwards, sun_up }
}

/// Irradiance of a plain by the sky, over π: the mean radiance, weighted by the cosine with the zenith.
///
/// A sum over the table's rows (whose sines are squares) and azimuths at even angles, in that order.
fn mean(gathered: &[Gathered], sun_up: f64) -> DVec3 {
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for (at, gathered) in gathered.iter().enumerate() {
        let sight = sight(at, sun_up);
        let row = part(at / COLUMNS, ROWS);
        // d(sin²) is 4 row³ d(row), d(azimuth) is d(cosine) / sin(azimuth).
        let column = part(at % COLUMNS, COLUMNS);
        let weight = row * row * row / (column * (1.0 - column) + 0.01).sqrt();
        let radiance = gathered.molecules() * rayleigh_phase(sight.sunwards)
            + gathered.haze * haze_phase(sight.sunwards);
        sum += radiance * weight;
        weights += weight;
    }
    sum / weights
}

/// Share per steradian that molecules scatter by an angle of this cosine.
#[must_use]
pub fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / 16.0 * std::f64::consts::FRAC_1_PI * (1.0 + cosine * cosine)
}

/// Share per steradian that haze scatters by an angle of this cosine. Source: W. Cornette, J. Shanks,
/// "Physically reasonable analytic expression for the single-scattering phase function", 1992.
#[must_use]
pub fn haze_phase(cosine: f64) -> f64 {
    let wide = 1.0 + HAZE_G * HAZE_G - 2.0 * HAZE_G * cosine;
    haze_scale() * (1.0 + cosine * cosine) / (wide * wide.sqrt())
}

/// The factor of [`haze_phase`] that makes its integral 1.
#[must_use]
pub fn haze_scale() -> f64 {
    3.0 / 8.0 * std::f64::consts::FRAC_1_PI * (1.0 - HAZE_G * HAZE_G) / (2.0 + HAZE_G * HAZE_G)
}

fn rounded(color: DVec3) -> Vec3 {
    Vec3::from_array(color.to_array().map(round_to_f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards(elevation_deg: f64) -> DVec3 {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        DVec3::new(0.0, sin, -cos)
    }

    #[test]
    fn phase_functions_share_out_everything() {
        for phase in [rayleigh_phase, haze_phase] {
            let count = 200_000;
            let cosine = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0;
            let sum: f64 = (0..count).map(|i| phase(cosine(i))).sum();
            let integral = sum * 2.0 / f64::from(count) * 2.0 * std::f64::consts::PI;
            assert!((integral - 1.0).abs() < 1e-6, "{integral}");
        }
    }

    /// The line of sight of a place between the table's entries.
    fn sight_between(row: f64, column: f64, sun_up: f64) -> Sight {
        let up = (row / (ROWS - 1) as f64).powi(2);
        let azimuth_cosine = 1.0 - 2.0 * column / (COLUMNS - 1) as f64;
        let [across, sun_across] = [up, sun_up].map(|y: f64| (1.0 - y * y).max(0.0).sqrt());
        let sunwards = up * sun_up + across * sun_across * azimuth_cosine;
        Sight { radius_km: GROUND_KM, up, sunwards, sun_up }
    }

    /// Linear, at black.
    const HALF_A_CODE: f64 = 0.5 / 255.0 / 12.92;

    /// Numerics: B46. What is read between entries is off by what linear interpolation leaves, an eighth
    /// of the second differences along rows and along columns: of the largest around, and twice that; or,
    /// where the earth's shadow ends within a cell, by half a code at black.
    #[test]
    fn between_its_entries_the_table_is_the_model() {
        for (turbidity, elevation) in [(1.0, 60.0), (3.0, 10.0), (10.0, 1.0), (3.0, -3.0)] {
            let sun_up = f64::to_radians(elevation).sin();
            let air = SunlitAir::new(Air::new(turbidity), sun_up);
            let model = |row: f64, column: f64| {
                let gathered = air.gather(sight_between(row, column, sun_up));
                [gathered.molecules(), gathered.haze]
            };
            let gathered: Vec<_> = (0..ROWS * COLUMNS).map(|at| air.gather(sight(at, sun_up))).collect();
            let table: Vec<_> = gathered.iter().map(|entry| [entry.molecules(), entry.haze]).collect();
            let exposure = exposure(mean(&gathered, sun_up).dot(LUMINANCE));
            let bends = |which: usize, at: [usize; 2], step: [usize; 2]| {
                let entry = |k: usize| table[(at[0] + k * step[0]) * COLUMNS + at[1] + k * step[1]][which];
                (entry(0) - entry(1) * 2.0 + entry(2)).abs()
            };
            let (mut looked_at, mut most) = (0, 0.0f64);
            for i in 1..ROWS - 2 {
                for j in 1..COLUMNS - 2 {
                    let (s, t) = (0.5, if (i + j) % 2 == 0 { 0.5 } else { 0.25 });
                    let (row, column) = (i as f64 + s, j as f64 + t);
                    let exact = model(row, column);
                    let sunwards = sight_between(row, column, sun_up).sunwards;
                    let phases = [rayleigh_phase(sunwards), haze_phase(sunwards)].map(|p| p * exposure);
                    for which in 0..2 {
                        let entry = |i: usize, j: usize| table[i * COLUMNS + j][which];
                        let between = |i: usize| entry(i, j).lerp(entry(i, j + 1), t);
                        let error = (between(i).lerp(between(i + 1), s) - exact[which]).abs();
                        let along_rows = [0, 1].into_iter().flat_map(|a| [0, 1].map(|b| [i - 1 + a, j + b]));
                        let along_columns =
                            [0, 1].into_iter().flat_map(|a| [0, 1].map(|b| [i + a, j - 1 + b]));
                        let rows = along_rows.map(|at| bends(which, at, [1, 0])).reduce(DVec3::max);
                        let columns = along_columns.map(|at| bends(which, at, [0, 1])).reduce(DVec3::max);
                        let bound =
                            (rows.unwrap() + columns.unwrap()) * (2.0 / 8.0) * phases[which] + HALF_A_CODE;
                        let error = error * phases[which];
                        assert!(error.cmple(bound).all(), "{row} {column}: {error} > {bound}");
                        most = most.max(error.max_element());
                        looked_at += 1;
                    }
                }
            }
            println!(
                "B46 sun at {elevation}°, turbidity {turbidity}: radiance off by {most:.2e}, {looked_at} values"
            );
        }
    }

    #[test]
    fn every_sky_is_finite_and_not_negative() {
        for turbidity in [1.0, 2.0, 10.0, 20.0] {
            for elevation in [90.0, 45.0, 0.3, 0.0, -0.3, -10.0, -90.0] {
                let sky = Daylight::new(towards(elevation), turbidity);
                let mut values = sky.table.iter().flatten().copied().collect::<Vec<_>>();
                values.extend([sky.disc, sky.ground, sky.night].iter().flat_map(Vec3::to_array));
                assert!(values.iter().all(|v| v.is_finite() && *v >= 0.0), "{turbidity} {elevation}");
            }
        }
    }

    #[test]
    fn a_setting_sun_dims_and_reddens() {
        let discs: Vec<Vec3> =
            [60.0, 20.0, 5.0, 1.0, -1.0].iter().map(|&deg| Daylight::new(towards(deg), 3.0).disc).collect();
        for pair in discs.windows(2) {
            assert!(pair[0].cmpgt(pair[1]).all() || pair[1] == Vec3::ZERO, "{discs:?}");
        }
        assert!(discs[2].x > 3.0 * discs[2].z && discs[4] == Vec3::ZERO, "{discs:?}");
    }

    #[test]
    fn the_zenith_of_a_clear_midday_is_blue_and_half_as_bright_as_white() {
        let sky = Daylight::new(towards(55.0), 3.0);
        let entry = sky.table[(ROWS - 1) * COLUMNS];
        let cosine = 55.0_f64.to_radians().sin();
        let phases = [rayleigh_phase(cosine), haze_phase(cosine)];
        let channel = |c: usize| f64::from(entry[c]) * phases[0] + f64::from(entry[3 + c]) * phases[1];
        let zenith = DVec3::new(channel(0), channel(1), channel(2));
        assert!(zenith.z > 1.5 * zenith.x && (0.3..0.6).contains(&zenith.z), "{zenith}");
    }
}
