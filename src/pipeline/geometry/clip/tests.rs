use super::*;
use glam::DVec3;
use proptest::prelude::*;

const NEAR: f64 = 0.5;

fn viewport(far: f64) -> Viewport {
    Viewport { width: 128, height: 128, farthest: NEAR / far * (1.0 - f64::EPSILON) }
}

/// 20,000 sub-pixels per unit of x / w: a perspective view of (x, y, w).
fn project(p: DVec3) -> [f64; 4] {
    let focal = 20_000.0 / (128.0 * 128.0);
    [p.x * focal, p.y * focal, NEAR, p.z]
}

fn polygon(corners: [DVec3; 3], viewport: &Viewport) -> Polygon {
    Polygon::triangle(corners.map(project), viewport).expect("all coordinates are finite")
}

/// Points on all sides of all planes, most of them not far from one.
fn point() -> impl Strategy<Value = DVec3> {
    let w = prop_oneof![-2.0..4.0, Just(0.5), Just(3.0), Just(0.0), 0.4..0.6];
    let side = prop_oneof![-3000.0..3000.0, -3.0..3.0, Just(8_388_607.0 / 20_000.0)];
    (side.clone(), side, w).prop_map(|(x, y, w)| DVec3::new(x, y, w))
}

/// Everything about a corner but its weights, bit by bit.
fn bits(v: &ClipVertex) -> [u64; 4] {
    [v.x, v.y, v.z, v.w].map(f64::to_bits)
}

#[test]
fn a_triangle_inside_all_planes_is_left_as_it_is() {
    let viewport = viewport(3.0);
    let triangle = polygon(
        [DVec3::new(0.0, 0.0, 0.5), DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.0, 1.0)],
        &viewport,
    );
    assert_eq!(triangle.clipped(&viewport).corners(), triangle.corners());
}

#[test]
fn a_coordinate_that_is_not_finite_makes_no_polygon() {
    for bad in [f64::NAN, f64::INFINITY, -1e305] {
        let corners = [DVec3::new(bad, 0.0, 1.0), DVec3::ONE, DVec3::Z];
        assert!(Polygon::triangle(corners.map(project), &viewport(3.0)).is_none());
    }
}

proptest! {
    /// Seen from the two triangles on its sides, an edge runs in opposite directions and is cut at the
    /// same bits.
    #[test]
    fn neighbours_cut_a_shared_edge_at_the_same_bits(
        a in point(), b in point(), c in point(), d in point(), bounded in any::<bool>()
    ) {
        let viewport = viewport(if bounded { 3.0 } else { f64::INFINITY });
        let on_edge = |corners: [DVec3; 3], opposite: usize| {
            let clipped = polygon(corners, &viewport).clipped(&viewport);
            let mut on: Vec<_> = clipped
                .corners()
                .iter()
                .filter(|v| v.weights[opposite].to_bits() == 0)
                .map(bits)
                .collect();
            // A corner exactly on a plane is there twice if the other neighbour was cut away.
            on.sort_unstable();
            on.dedup();
            on
        };
        prop_assert_eq!(on_edge([a, b, c], 2), on_edge([b, a, d], 2));
    }

    /// What is left lies between near and far to the bit and within the guard band to a rounding,
    /// and each corner is the weighted mean of the triangle's.
    #[test]
    fn what_is_left_lies_inside_and_on_the_triangle(a in point(), b in point(), c in point()) {
        let viewport = viewport(3.0);
        let clipped = polygon([a, b, c], &viewport).clipped(&viewport);
        for v in clipped.corners() {
            prop_assert!(v.w >= NEAR && v.w <= 3.0 * (1.0 + 1e-15), "{v:?}");
            let guard = GUARD_PLANE * v.w * (1.0 + 1e-12);
            prop_assert!(v.x.abs() <= guard && v.y.abs() <= guard, "{v:?}");
            let [i, j, k] = v.weights;
            prop_assert!((i + j + k - 1.0).abs() < 1e-14, "{v:?}");
            let mean = a * i + b * j + c * k;
            let off = DVec3::new(v.x / 20_000.0, -v.y / 20_000.0, v.w) - mean;
            prop_assert!(off.length() < 1e-11 * (a.length() + b.length() + c.length()), "{off}");
        }
    }
}
