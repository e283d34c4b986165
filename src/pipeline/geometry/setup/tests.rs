use super::*;
use crate::scene::Cull;
use proptest::prelude::*;

impl Triangle {
    /// A triangle of given corners (sub-pixels) and depths, both sides seen; `None` without area.
    pub(in crate::pipeline) fn set(corners: [[i32; 2]; 3], depth: [f64; 3], draw: u32) -> Option<Self> {
        let snapped = [0, 1, 2].map(|i| Snapped {
            x: f64::from(corners[i][0]),
            y: f64::from(corners[i][1]),
            depth: depth[i],
        });
        match set_up(snapped, slot(draw, Cull::None), 0, NOT_CLIPPED, false) {
            Fate::Set(triangle) => Some(triangle),
            _ => None,
        }
    }
}

fn slot(draw: u32, cull: Cull) -> Slot {
    Slot { draw, cull, opacity: Opacity::Opaque }
}

fn corner() -> impl Strategy<Value = [i32; 2]> {
    let c = -8_388_607..=8_388_607;
    prop_oneof![[c.clone(), c], [-2000..2000, -2000..2000], [-2..2, -2..2]]
}

fn area(x: [i32; 3], y: [i32; 3]) -> i64 {
    let d = |c: [i32; 3], i: usize| i64::from(c[i]) - i64::from(c[0]);
    d(x, 1) * d(y, 2) - d(y, 1) * d(x, 2)
}

proptest! {
    #[test]
    fn corners_run_clockwise_from_the_least_depth(
        corners in [corner(), corner(), corner()], depth in prop::array::uniform3(prop_oneof![Just(0.5), 0.0f64..1.0])
    ) {
        let given = area(corners.map(|c| c[0]), corners.map(|c| c[1]));
        let set = Triangle::set(corners, depth, 0);
        prop_assert_eq!(set.is_some(), given != 0);
        if let Some(t) = set {
            prop_assert_eq!(area(t.x, t.y), given.abs());
            let order = t.corners();
            for i in 0..3 {
                prop_assert_eq!([t.x[i], t.y[i]], corners[order[i]]);
                prop_assert!(depth[order[0]] <= depth[order[i]]);
            }
            prop_assert_eq!(t.is_back(), given > 0);
        }
    }

    /// Wherever the depth is taken: at the corners it is that of the corners, to f32's precision.
    #[test]
    fn depth_at_the_corners_is_theirs(
        corners in [corner(), corner(), corner()], exponents in [-40.0f64..0.0, -40.0..0.0, -40.0..0.0]
    ) {
        let depth = exponents.map(libm::exp2);
        if let Some(t) = Triangle::set(corners, depth, 0) {
            for (i, corner) in t.corners().into_iter().enumerate() {
                let at = t.depth_at(f64::from(t.x[i]), f64::from(t.y[i]));
                prop_assert!((at / depth[corner] - 1.0).abs() < 1e-8, "{at} for {}", depth[corner]);
            }
        }
    }
}

#[test]
fn counter_clockwise_is_the_front_and_a_mirror_turns_it() {
    // With y down this runs counter-clockwise as seen.
    let front = [[0.0, 0.0], [0.0, 100.0], [100.0, 0.0]].map(|[x, y]| Snapped { x, y, depth: 0.5 });
    for (cull, mirrored, drawn) in [
        (Cull::Back, false, true),
        (Cull::Front, false, false),
        (Cull::None, false, true),
        (Cull::Back, true, false),
        (Cull::Front, true, true),
    ] {
        let fate = set_up(front, slot(0, cull), 0, NOT_CLIPPED, mirrored);
        assert_eq!(matches!(fate, Fate::Set(_)), drawn, "{cull:?}, mirrored {mirrored}");
    }
}

#[test]
fn even_permutations_come_first() {
    let is_even = |p: [usize; 3]| (p[1] + 3 - p[0]) % 3 == 1;
    assert_eq!(PERMUTATIONS.map(is_even), [true, true, true, false, false, false]);
}

#[test]
fn only_triangles_that_a_plane_would_get_wrong_are_stiff() {
    let stiff = |corners, depth| Triangle::set(corners, depth, 0).expect("it has an area").is_stiff();
    let fat = [[0, 0], [5000, 300], [700, 6000]];
    assert!(!stiff(fat, [0.001, 0.1, 1.0]));
    assert!(!stiff(fat, [1e-6, 1e-6, 1.0]));
    assert!(stiff(fat, [1e-9, 1e-6, 1.0]));
    let sliver = [[0, 0], [7_000_000, 3_000_000], [7_000_001, 3_000_002]];
    assert!(!stiff(sliver, [0.5, 0.5, 0.6]));
    assert!(stiff(sliver, [0.001, 0.001, 1.0]));
}

#[test]
fn a_triangle_fits_a_cache_line() {
    assert_eq!(size_of::<Triangle>(), 64);
}
