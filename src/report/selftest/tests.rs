//! The catalogue as tests, a case each.

use super::instruments::engine::Engine;
use super::*;
use std::sync::atomic::AtomicBool;

/// Runs a case and fails with its measurements that are out.
fn holds(id: &str) {
    let cases = named(&[id.to_owned()]).expect("a case of the catalogue");
    let rows = run(&cases, Effort::Quick, &Engine::default(), &AtomicBool::new(false), &|_| ());
    let rows = rows.expect("nobody cancels");
    println!("{}", table(&rows));
    let out: Vec<_> = rows.into_iter().filter(Measurement::is_out).collect();
    assert!(out.is_empty(), "\n{}", table(&out));
}

macro_rules! tests {
    ($($name:ident $id:literal)*) => { $(#[test] fn $name() { holds($id); })* };
}

#[rustfmt::skip] // A line a case.
tests! {
    b1_coverage "B1"
    b2_shared_edges "B2"
    b3_fans "B3"
    b4_slivers "B4"
    b5_no_area "B5"
    b6_dust "B6"
    b7_enormous "B7"
    b8_about_the_planes "B8"
    b9_near_cut "B9"
    b10_crops "B10"
    b11_samples "B11"
    b12_between_corners "B12"
    b13_depth_order "B13"
    b14_depth_of_stiff_triangles "B14"
    b15_coplanar "B15"
    b16_cameras "B16"
    b17_fields_of_view "B17"
    b18_up "B18"
    b19_far_from_the_origin "B19"
    b20_mixed_scales "B20"
    b21_uv "B21"
    b22_uv_far_off "B22"
    b23_textures "B23"
    b24_level_of_detail "B24"
    b25_scales "B25"
    b26_lengths_of_normals "B26"
    b27_normals_that_cancel "B27"
    b28_tangents "B28"
    b29_relief "B29"
    b30_highlights "B30"
    b32_lights "B32"
    b33_acne "B33"
    b34_leaks "B34"
    b35_light_along_axes "B35"
    b36_casters "B36"
    b37_still_maps "B37"
    b38_borders_of_maps "B38"
    b39_soft_shadows "B39"
    b40_seams "B40"
    b41_srgb "B41"
    b42_data "B42"
    b43_tone_mapping "B43"
    b44_neighbours "B44"
    b45_grey "B45"
    b46_sky "B46"
    b47_models "B47"
    b48_sizes "B48"
    b49_the_same_to_the_byte "B49"
    b50_every_build_to_the_byte "B50"
}

#[test]
fn the_cases_are_b1_to_b50_in_order() {
    let ids: Vec<&str> = CASES.iter().map(|case| case.id).collect();
    assert_eq!(ids, (1..=50).map(|n| format!("B{n}")).collect::<Vec<_>>());
}

#[test]
fn cases_are_named_in_any_case_and_unknown_ones_refused() {
    let ids = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        named(&names).map(|cases| cases.iter().map(|case| case.id).collect::<Vec<_>>())
    };
    assert_eq!(ids(&["b30", "B13"]), Ok(vec!["B13", "B30"]));
    assert_eq!(ids(&[]).map(|all| all.len()), Ok(50));
    assert_eq!(ids(&["B51"]), Err(UnknownCase("B51".to_owned())));
}

/// Runs checks as a case of their own.
fn measured(checks: &'static [Check]) -> Vec<Measurement> {
    let case: &'static Case = Box::leak(Box::new(Case { id: "B0", claim: "a test", checks }));
    let ran = run(&[case], Effort::Quick, &Engine::default(), &AtomicBool::new(false), &|_| ());
    ran.expect("nobody cancels")
}

#[test]
fn the_worst_margin_comes_first_and_what_breaks_before_it() {
    let rows = measured(&[
        |ledger| ledger.at_most("", "half", 1.0, 2.0),
        |_| panic!("no more"),
        |ledger| ledger.at_least("", "too little", 1.0, 4.0),
        |_| (),
        |ledger| ledger.none_of("", "none", 0, 3),
    ]);
    let metrics: Vec<(&str, Outcome)> = rows.iter().map(|row| (row.metric.as_str(), row.outcome)).collect();
    assert_eq!(
        metrics,
        [
            ("no more", Outcome::Broken),
            ("nothing was measured", Outcome::Broken),
            ("too little", Outcome::Out),
            ("half", Outcome::Holds),
            ("none", Outcome::Holds),
        ]
    );
}

#[test]
fn of_one_metric_the_worst_setting_is_kept_with_its_seed() {
    let rows = measured(&[|ledger| {
        ledger.random(7);
        for (setting, value) in [("a", 1.0), ("b", 3.0), ("c", 2.0)] {
            ledger.at_most(setting, "error", value, 2.0);
        }
    }]);
    assert_eq!((rows.len(), rows[0].settings), (1, 3));
    assert_eq!((rows[0].setting.as_str(), rows[0].value), ("b (seed 0x7)", 3.0));
    assert!(table(&rows).lines().nth(1).is_some_and(|line| line.ends_with("0.67 OUT  b (seed 0x7), of 3")));
}

#[test]
fn what_is_no_number_is_out() {
    let rows = measured(&[|ledger| ledger.at_most("", "error", f64::NAN, 1.0)]);
    assert_eq!((rows[0].outcome, rows[0].margin), (Outcome::Out, 0.0));
}

#[test]
fn a_set_flag_ends_a_run() {
    let all = named(&[]).expect("all of them");
    let ran = run(&all, Effort::Quick, &Engine::default(), &AtomicBool::new(true), &|_| ());
    assert_eq!(ran, Err(crate::pipeline::Cancelled));
}
