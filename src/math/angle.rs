//! Angles in degrees, exact where the result is.

use glam::{DMat3, DVec3};

/// Sine and cosine of an angle in degrees; exact at every multiple of 90.
///
/// Only `libm` and basic arithmetic, so the same bits on every machine.
#[must_use]
pub fn sin_cos_deg(deg: f64) -> (f64, f64) {
    // The remainder is exact, so a large angle loses nothing on the way.
    let deg = deg % 360.0;
    let quarter = (deg / 90.0 + 0.5).floor();
    let rest = (deg - quarter * 90.0).to_radians();
    let (sin, cos) = (libm::sin(rest), libm::cos(rest));
    match quarter.rem_euclid(4.0) {
        q if q < 0.5 => (sin, cos),
        q if q < 1.5 => (cos, -sin),
        q if q < 2.5 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// `Rz · Ry · Rx`: turns about x, then y, then z, each right-handed.
#[must_use]
pub fn rotation_xyz_deg(deg: DVec3) -> DMat3 {
    rotation_about_deg(DVec3::Z, deg.z)
        * rotation_about_deg(DVec3::Y, deg.y)
        * rotation_about_deg(DVec3::X, deg.x)
}

/// A right-handed turn about `axis`, a unit vector. Source: Rodrigues' formula. An angle that is not
/// finite (a speed times a time that no f64 holds) turns nothing.
#[must_use]
pub fn rotation_about_deg(axis: DVec3, deg: f64) -> DMat3 {
    let (sin, cos) = sin_cos_deg(if deg.is_finite() { deg } else { 0.0 });
    let column = |unit: DVec3| unit * cos + axis.cross(unit) * sin + axis * (axis.dot(unit) * (1.0 - cos));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        for turn in -9..9 {
            let (sin, cos) = sin_cos_deg(f64::from(turn) * 90.0);
            let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][(turn + 12) as usize % 4];
            assert_eq!((sin, cos), expected, "{turn}");
        }
        assert_eq!(rotation_xyz_deg(DVec3::new(-90.0, 0.0, 0.0)) * DVec3::Z, DVec3::Y);
        assert_eq!(rotation_xyz_deg(DVec3::new(90.0, 90.0, 90.0)) * DVec3::X, -DVec3::Z);
    }

    #[test]
    fn other_angles_agree_with_libm() {
        for i in -2000..2000 {
            let deg = f64::from(i) * 0.37;
            let (sin, cos) = sin_cos_deg(deg);
            assert!((sin - libm::sin(deg.to_radians())).abs() < 1e-14, "{deg}");
            assert!((cos - libm::cos(deg.to_radians())).abs() < 1e-14, "{deg}");
        }
    }

    #[test]
    fn turns_are_right_handed_and_in_order() {
        let m = rotation_xyz_deg(DVec3::new(30.0, 40.0, 50.0));
        let by_hand = DMat3::from_rotation_z(50_f64.to_radians())
            * DMat3::from_rotation_y(40_f64.to_radians())
            * DMat3::from_rotation_x(30_f64.to_radians());
        assert!(m.abs_diff_eq(by_hand, 1e-15));
    }
}
