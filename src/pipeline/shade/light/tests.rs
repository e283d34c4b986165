use super::*;

/// Unit vectors at an angle to each other, as f32 has them, in every octant.
fn pairs(angle: f64) -> impl Iterator<Item = [Vec3; 2]> {
    (0..200).map(move |i| {
        let (a, b) = (f64::from(i) * 2.399_963, f64::from(i) / 100.0 - 0.995);
        let flat = (1.0 - b * b).sqrt();
        let n = DVec3::new(flat * a.cos(), b, flat * a.sin());
        let aside = n.cross(DVec3::new(0.3, -0.5, 0.81)).normalize();
        [n.as_vec3(), (n * angle.cos() + aside * angle.sin()).as_vec3()]
    })
}

fn lobe(normal: Vec3, half: Vec3, shininess: f32) -> f64 {
    let lanes = dispatch!(Level::new(), simd => {
        let (n, h) = (Vec3x8::splat(simd, normal), Vec3x8::splat(simd, half));
        specular_lobe(simd, n, h, shininess).to_array()
    });
    f64::from(lanes[0])
}

/// Numerics: B30. Of the vectors as they are given to the kernel, not quite of unit length.
#[test]
fn b30_a_highlight_is_right_to_4e_6_of_itself_where_it_is_bright() {
    let u = f64::from(f32::EPSILON) / 2.0;
    for shininess in [1.0f32, 2.0, 3.0, 10.0, 32.0, 100.0, 1e3, 1e4, 1e5] {
        let (mut relative, mut beyond, mut bright, mut wide) = (0.0f64, 0.0f64, 0, 0);
        // To where it falls to a thousandth of its peak.
        let widest = f64::acos(f64::powf(1e-3, 1.0 / f64::from(shininess)));
        for angle in (0..=200).map(|i| widest * f64::from(i) / 200.0) {
            for [n, h] in pairs(angle) {
                let (wide_n, wide_h) = (n.as_dvec3().normalize(), h.as_dvec3().normalize());
                let q = (wide_n - wide_h).length_squared() / 2.0;
                let exact = (f64::from(shininess) * (-q).ln_1p()).exp();
                let error = (lobe(n, h, shininess) - exact).abs();
                if exact <= 1e-3 {
                    continue;
                }
                // There it is a power of the dot product: its sum rounds by 2u of 1, each vector's length
                // by u; s of that, as parts of the cosine, besides what the power itself is off by.
                let of_dot = if q >= 0.5 { f64::from(shininess) * 4.0 * u / (1.0 - q) } else { 0.0 };
                assert!(error / exact <= 4e-6 + of_dot, "exponent {shininess}: {error:e} of {exact:e}");
                if q >= 0.5 {
                    beyond = beyond.max(error / exact);
                    wide += 1;
                } else {
                    relative = relative.max(error / exact);
                    bright += 1;
                }
            }
        }
        println!("B30 exponent {shininess}: {relative:.2e} of itself; beyond 60°, {beyond:.2e} of {wide}");
        assert!(bright > 10_000);
        // xˢ is over 10⁻³ beyond 60° if s < 10.
        assert!(shininess >= 9.0 || wide > 1000, "exponent {shininess}: {wide} beyond 60°");
    }
}

/// Numerics: B30.
#[test]
fn b30_an_exponent_of_zero_is_one_at_every_angle() {
    for angle in [0.0, 1.0, std::f64::consts::FRAC_PI_2, 2.0, std::f64::consts::PI] {
        for [n, h] in pairs(angle) {
            assert_eq!(lobe(n, h, 0.0), 1.0, "{angle}");
        }
    }
    assert_eq!(lobe(Vec3::X, Vec3::Y, 0.0), 1.0);
    assert_eq!(lobe(Vec3::X, Vec3::Y, 1.0), 0.0);
}
