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
    b50_float_state "B50"
}
