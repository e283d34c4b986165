//! Built-in meshes.
//!
//! In: a shape's essentials in model units. Out: a [`Mesh`] of one part with the one slot `None`,
//! with unit normals that are those of the true surface and with texture coordinates.
//!
//! Every shape is centred on the origin with its axis along y. Around that axis u runs from left to
//! right for a viewer outside, from a seam at −z, so that the middle of a picture faces +z; v runs
//! up. Counter-clockwise is the front.

mod bezier;
mod builder;
mod cone;
mod cuboid;
mod cylinder;
mod plane;
mod sphere;
mod teapot;
mod torus;

#[cfg(test)]
mod check;

pub use cone::cone;
pub use cuboid::box_;
pub use cylinder::cylinder;
pub use plane::plane;
pub use sphere::sphere;
pub use teapot::teapot;
pub use torus::torus;

use super::Mesh;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn round_shapes_of_any_size_and_fineness_are_closed(
            radius in 1e-3..1e3_f64,
            other in 1e-3..1e3_f64,
            around in 3..40_u32,
            along in 3..20_u32,
        ) {
            let tube = radius * other / 1e3; // a ring, not a spindle that passes through itself
            let shapes = [
                sphere(radius, around, along),
                torus(radius, tube, around, along),
                cylinder(radius, other, around),
                cone(radius, other, around),
            ];
            for mesh in &shapes {
                check::assert_well_formed(mesh);
                check::assert_watertight(mesh);
                prop_assert!(check::volume(mesh) > 0.0);
            }
        }

        #[test]
        fn no_size_whatever_makes_a_shape_fail(
            a in any::<f64>(),
            b in any::<f64>(),
            c in any::<f64>(),
            n in prop_oneof![Just(0_u32), 1..9_u32],
        ) {
            for mesh in [
                plane([a, b], [c, a]),
                box_([a, b, c]),
                sphere(a, n, n),
                torus(a, b, n, n),
                cylinder(a, b, n),
                cone(a, b, n),
                teapot(a, n),
            ] {
                prop_assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.vertex_count()));
            }
        }
    }
}
