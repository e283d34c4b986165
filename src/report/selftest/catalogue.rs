//! The cases in order: what each claims, and what checks it.

use super::Ledger;
use super::cases::shadows::{cube, kernels};
use super::cases::{
    attributes, camera, clipping, codes, colour, coverage, crops, depth, determinism, enormous, float_state,
    light, limits, models, normals, post, relief, samples, shadows, shift, sky, textures,
};
use super::ledger::{Measurement, Outcome};

/// Measures something and notes it.
pub type Check = fn(&mut Ledger);

/// A stiff or extreme case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name, such as `B14`.
    pub id: &'static str,
    /// What holds.
    pub claim: &'static str,
    /// What measures it. Without any the claim is the reason why there is nothing to measure.
    pub checks: &'static [Check],
}

impl Case {
    /// The row of a case that has nothing to measure.
    pub(super) fn not_offered(&self) -> Option<Measurement> {
        let row = || Measurement::without_numbers(self.id, self.claim.to_owned(), Outcome::NotOffered);
        self.checks.is_empty().then(row)
    }
}

/// There is no such case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no case {0:?}: they are B1 to B50")]
pub struct UnknownCase(pub String);

/// The cases of these names in the catalogue's order; without names all of them.
///
/// # Errors
/// [`UnknownCase`].
pub fn named(ids: &[String]) -> Result<Vec<&'static Case>, UnknownCase> {
    let is_known = |id: &&String| CASES.iter().any(|case| case.id.eq_ignore_ascii_case(id));
    if let Some(unknown) = ids.iter().find(|id| !is_known(id)) {
        return Err(UnknownCase(unknown.clone()));
    }
    let is_named = |case: &&Case| ids.is_empty() || ids.iter().any(|id| case.id.eq_ignore_ascii_case(id));
    Ok(CASES.iter().filter(is_named).collect())
}

const fn case(id: &'static str, claim: &'static str, checks: &'static [Check]) -> Case {
    Case { id, claim, checks }
}

/// All cases.
#[rustfmt::skip] // A paragraph a case.
pub const CASES: &[Case] = &[
    case("B1", "Triangles of every size cover what exact arithmetic says, and change no more pixels than snapping must", &[
        coverage::b1_snapping_changes_no_more_pixels_than_it_must,
        coverage::b1_would_notice_four_lost_bits,
        coverage::b1_every_sample_sees_what_exact_arithmetic_says,
    ]),
    case("B2", "A jittered mesh covers every sample exactly once", &[
        coverage::b2_a_jittered_mesh_covers_every_sample_exactly_once,
    ]),
    case("B3", "Four triangles about a vertex leave no gap, wherever in a pixel it lies", &[
        coverage::b3_four_triangles_about_a_vertex_leave_no_gap,
    ]),
    case("B4", "A sliver of a sub-pixel is covered exactly", &[
        coverage::b4_a_sliver_of_a_sub_pixel_is_covered_exactly,
    ]),
    case("B5", "Triangles without area are dropped and counted, and leave no trace", &[
        coverage::b5_triangles_without_area_are_dropped_and_counted,
        coverage::b5_a_frame_is_the_same_without_what_has_no_area,
    ]),
    case("B6", "Dust below a sub-pixel is covered exactly", &[
        coverage::b6_dust_below_a_sub_pixel_is_covered_exactly,
    ]),
    case("B7", "Enormous coordinates are cut as a ray sees them, or at least finite and repeatable", &[
        enormous::b7_a_triangle_of_1e10_near_distances_is_cut_as_a_ray_sees_it,
        enormous::b7_coordinates_to_the_limit_stay_finite_exact_and_repeatable,
        enormous::b7_the_guard_band_reaches_to_its_last_sub_pixel_and_no_farther,
        enormous::b7_near_planes_at_the_ends_of_the_range_of_numbers_cut_without_trouble,
        enormous::b7_whole_frames_of_enormous_triangles_are_finite_and_repeatable,
    ]),
    case("B8", "Corners about the planes of the view are cut as a ray sees them", &[
        clipping::b8_corners_about_the_eye_and_near_planes_are_cut_as_a_ray_sees_them,
        clipping::triangles_along_the_planes_themselves_are_cut_without_trouble,
        camera::backs_are_culled_as_a_ray_sees_them,
    ]),
    case("B9", "A mesh cut by the near plane is covered exactly once", &[
        clipping::b9_a_mesh_cut_by_the_near_plane_is_covered_exactly_once,
    ]),
    case("B10", "A picture of any size is a crop of a larger one", &[
        crops::b10_a_picture_of_any_size_is_a_crop_of_a_larger_one,
        determinism::pictures_of_every_size_are_crops_of_a_larger_one,
    ]),
    case("B11", "Masks are exact, and edges as smooth as the sample pattern allows", &[
        samples::b11_masks_are_exact_and_edges_as_smooth_as_the_pattern_allows,
    ]),
    case("B12", "Attributes stay between those of the corners", &[
        samples::b12_attributes_stay_between_those_of_the_corners,
    ]),
    case("B13", "The nearer of two surfaces wins down to a gap of four roundings, and depth 0 is beyond the far plane", &[
        depth::b13_depth_zero_is_beyond_the_far_plane_and_the_least_depth_is_not,
        depth::b13_the_nearer_of_two_surfaces_wins_down_to_a_gap_of_four_roundings,
    ]),
    case("B14", "A triangle from near to 10⁹ times as far keeps its depth", &[
        depth::b14_a_triangle_to_1e9_near_distances_keeps_its_depth,
        depth::b14_any_ratio_of_distances_keeps_its_depth,
        depth::b14_a_sliver_keeps_its_depth,
        depth::b14_a_sliver_keeps_its_depth_on_its_own_edge,
    ]),
    case("B15", "Of coplanar surfaces the first wins wherever depths are equal, and the same one every time", &[
        depth::b15_of_coplanar_squares_the_first_wins_wherever_depths_are_equal,
        depth::b15_layers_of_one_depth_are_composited_in_the_order_of_submission,
        determinism::coplanar_surfaces_are_the_same_to_the_byte,
        determinism::the_order_of_names_does_not_show_where_depths_differ,
    ]),
    case("B16", "Bad cameras are refused by name, and a thin slab shows what lies in it", &[
        camera::b16_bad_cameras_are_refused_by_name,
        camera::b16_a_slab_of_a_millionth_shows_what_lies_in_it,
    ]),
    case("B17", "The narrowest and the widest view show what rays see", &[
        camera::b17_the_narrowest_and_the_widest_view_show_what_rays_see,
    ]),
    case("B18", "An up along the line of sight is replaced, and said", &[
        camera::b18_up_along_the_line_of_sight_is_replaced_and_said,
    ]),
    case("B19", "A scene far from the origin is the scene at the origin", &[
        shift::b19_a_scene_far_from_the_origin_has_the_same_bytes_where_its_numbers_are_exact,
        shift::b19_a_scene_far_from_the_origin_is_the_same_but_for_rounding_where_they_are_not,
    ]),
    case("B20", "A speck before the lens and a mountain are both seen", &[
        camera::b20_a_speck_before_the_lens_and_a_mountain_are_both_seen,
    ]),
    case("B21", "Texture coordinates are right at any ratio of distances", &[
        attributes::texture_coordinates_stay_within_sixteen_roundings_at_any_ratio_of_distances,
    ]),
    case("B22", "Coordinates a million turns on read the texel that they name", &[
        attributes::b22_coordinates_around_a_million_read_the_texel_that_they_name,
        attributes::b22_a_picture_is_the_same_a_million_turns_on,
    ]),
    case("B23", "Textures of odd sizes are read right, and those of bad ones refused", &[
        textures::a_texture_of_one_texel_is_that_texel_everywhere,
        textures::coordinates_on_the_border_read_the_border_texel,
        textures::whatever_is_asked_the_answer_lies_between_the_texels_at_every_simd_level,
        textures::mips_of_every_size_keep_the_mean,
        textures::images_that_are_too_large_or_damaged_are_refused,
    ]),
    case("B24", "The level of detail is right to a 256th, and within the levels to the horizon", &[
        attributes::b24_the_level_of_detail_is_right_to_a_256th_and_stays_within_the_levels,
        attributes::b24_derivatives_beyond_all_bounds_read_the_first_level_or_the_last,
        textures::a_floor_to_the_horizon_fades_to_its_mean,
    ]),
    case("B25", "Normals are those of the transformed triangle under every scale", &[
        normals::normals_are_those_of_the_transformed_triangle_under_every_scale,
        normals::what_the_scale_leaves_no_area_is_not_drawn,
    ]),
    case("B26", "Normals of any length become unit vectors", &[
        normals::normals_of_any_length_become_unit_vectors_and_zero_the_geometric_one,
    ]),
    case("B27", "Normals that cancel give way to the geometric one", &[
        normals::normals_that_cancel_give_way_to_the_geometric_one,
    ]),
    case("B28", "Tangent frames are orthonormal for every direction", &[
        normals::the_orthonormal_basis_holds_for_every_direction,
        relief::b28_tangent_frames_are_orthonormal_and_keep_their_handedness_for_all_directions,
        relief::b28_maps_without_texture_coordinates_draw_something,
    ]),
    case("B29", "Flat maps change no bit, and steep ones keep a normal on its side", &[
        relief::every_code_of_a_normal_map_decodes_exactly,
        relief::b29_neutral_texels_leave_the_bits_of_a_normal_whatever_filter_and_level,
        relief::b29_heights_of_any_scale_leave_the_normal_finite_and_on_its_side,
        relief::b29_maps_that_change_nothing_are_left_out_and_no_byte_differs,
    ]),
    case("B30", "A highlight of any sharpness is right to a fraction of its peak", &[
        light::b30_a_highlight_of_any_sharpness_is_right_to_a_fraction_of_its_peak,
        light::b30_an_exponent_of_zero_is_one_wherever_there_is_light,
    ]),
    case("B31", "No normalised Blinn-Phong is offered whose energy could be gained: the shading is the unnormalised form", &[]),
    case("B32", "Lights too close, too bright or too many leave finite radiance", &[
        light::b32_a_light_at_the_surface_or_beyond_all_brightness_leaves_finite_radiance,
        light::b32_a_light_without_intensity_is_left_out,
        light::b32_lights_that_make_no_sense_are_refused_by_name,
        light::b32_as_many_lights_as_the_limit_are_drawn_and_one_more_is_refused,
    ]),
    case("B33", "A lit plane does not shadow itself", &[
        shadows::a_lit_plane_does_not_shadow_itself_at_any_slope_or_resolution,
        shadows::without_an_offset_a_plane_shadows_itself,
        shadows::a_plane_in_a_map_a_thousand_times_its_size_does_not_shadow_itself,
        shadows::a_floor_a_thousand_times_larger_than_the_casters_keeps_their_shadows_sharp,
        kernels::a_lit_plane_does_not_shadow_itself_under_any_kernel,
        kernels::without_an_offset_a_plane_shadows_itself_under_a_kernel,
        cube::a_plane_in_the_light_of_a_lamp_does_not_shadow_itself,
        cube::without_an_offset_a_plane_shadows_itself_in_the_light_of_a_lamp,
    ]),
    case("B34", "Shadows begin where a box stands, and walls do not leak", &[
        shadows::shadows_begin_where_a_box_stands_and_walls_do_not_leak,
        kernels::filtered_shadows_begin_where_a_box_stands_and_walls_do_not_leak,
        cube::a_box_under_a_lamp_shadows_what_the_lamp_cannot_reach_and_nothing_else,
        cube::filtered_shadows_of_a_lamp_begin_where_a_box_stands_and_walls_do_not_leak,
    ]),
    case("B35", "Light along every axis gives the same shadow", &[
        shadows::light_along_every_axis_gives_the_same_shadow,
        kernels::light_along_every_axis_gives_the_same_filtered_shadow,
        cube::a_lamp_on_every_axis_throws_the_same_shadow,
    ]),
    case("B36", "Far, flat and pointlike casters throw the shadow that they should", &[
        shadows::casters_far_before_the_receivers_still_shade_them,
        shadows::flat_and_pointlike_scenes_are_lit_and_finite,
        kernels::casters_far_before_the_receivers_throw_filtered_shadows,
        cube::a_lamp_inside_of_a_caster_leaves_all_else_dark,
        cube::a_caster_next_to_a_lamp_shades_unless_it_is_nearer_than_the_near_limit,
        cube::flat_and_pointlike_scenes_under_a_lamp_are_lit_and_finite,
    ]),
    case("B37", "Maps are the same wherever the camera is", &[
        shadows::maps_are_the_same_wherever_the_camera_is,
    ]),
    case("B38", "Outside of a map is lit, its border is part of it, and any size is defined", &[
        shadows::maps_of_any_size_are_defined,
        shadows::the_largest_map_is_right,
        shadows::outside_the_map_is_lit_and_its_border_is_part_of_it,
        shadows::more_texels_than_a_frame_may_have_are_refused,
        cube::around_a_lamp_only_what_lies_behind_a_caster_is_dark,
    ]),
    case("B39", "A kernel without size is the hard shadow, and one of any size stays between light and dark", &[
        kernels::a_kernel_without_size_is_the_hard_shadow,
        kernels::soft_shadows_lie_between_light_and_dark_whatever_blocks,
        cube::soft_shadows_of_lamps_lie_between_light_and_dark_whatever_blocks,
    ]),
    case("B40", "The sides of a cube meet without a seam", &[
        cube::the_sides_of_a_cube_meet_without_a_seam,
    ]),
    case("B41", "Every code survives the way through linear light", &[
        colour::every_code_of_a_texture_survives_the_way_through_linear_light,
        colour::every_code_of_a_colour_in_the_document_survives,
        colour::linear_numbers_are_encoded_to_the_nearest_code,
        colour::encoding_is_within_one_code_and_differs_from_f64_in_one_of_100_000,
    ]),
    case("B42", "Every code of data survives the way into a file", &[
        codes::b42_every_16_bit_code_survives_the_way_through_depth_and_a_file,
        codes::b42_every_code_of_alpha_survives_and_the_colour_under_it,
        codes::b42_radiance_in_floats_is_finite_and_clamped,
    ]),
    case("B43", "Tone mapping takes everything to 0 to 1 in order", &[
        post::pointwise::tone_mapping_takes_everything_to_0_to_1_in_order,
    ]),
    case("B44", "Effects on neighbours are what f64 says, finite, and leave alone what is flat", &[
        post::neighbours::a_blur_is_a_gaussian_and_keeps_what_is_constant,
        post::neighbours::a_kernel_is_a_correlation_whose_first_row_weighs_the_pixels_above,
        post::neighbours::sharpening_adds_the_difference_to_binomial_weights,
        post::neighbours::bloom_adds_the_blurred_light_above_the_threshold,
        post::fxaa::fxaa_brings_slanted_edges_nearer_to_their_coverage,
        post::fxaa::fxaa_leaves_flat_and_gentle_pictures_alone,
        post::fxaa::fxaa_takes_on_no_black_from_where_nothing_is,
        post::fxaa::fxaa_is_what_is_published,
        post::the_largest_parameters_leave_finite_numbers,
        post::only_a_blur_changes_alpha,
    ]),
    case("B45", "Grey has no tint, and colours are weighed in linear light", &[
        post::pointwise::grey_has_no_tint_and_stays_what_it_was,
        post::pointwise::a_colour_matrix_adds_its_last_column,
        post::pointwise_effects_see_straight_colour_and_the_others_premultiplied,
    ]),
    case("B46", "The sky has no seams, and is only where nothing else is", &[
        sky::b46_rays_point_where_they_should,
        sky::b46_cube_maps_have_no_seams,
        sky::b46_poles_and_the_turn_of_a_panorama_are_clean,
        sky::b46_the_widest_view_shows_the_sky_to_its_edge,
        sky::b46_the_sky_is_only_where_nothing_else_is,
        sky::b46_a_computed_sky_is_read_as_its_table_says,
    ]),
    case("B47", "Odd and damaged models are read or refused by line, and concave faces covered once", &[
        models::odd_models_are_read_or_refused_by_line,
        models::concave_faces_are_covered_exactly_once,
        models::damaged_files_are_read_or_refused,
    ]),
    case("B48", "Sizes are met exactly at their limits, and none wraps", &[
        limits::pictures_are_planned_up_to_their_limits_and_not_beyond,
    ]),
    case("B49", "Every picture is the same for any number of threads, SIMD level and order of tiles", &[
        determinism::the_demo_is_the_same_to_the_byte,
        determinism::data_outputs_are_the_same_to_the_byte,
        determinism::textures_shadows_and_samples_are_the_same_to_the_byte,
        determinism::soft_shadows_are_the_same_to_the_byte,
        determinism::resampled_pictures_are_the_same_to_the_byte,
        determinism::transparency_is_the_same_to_the_byte,
        determinism::relief_is_the_same_to_the_byte,
        determinism::radiance_depth_and_codes_are_the_same_to_the_byte,
        determinism::the_catalogue_holds_for_other_engines,
        determinism::pictures_with_effects_are_the_same_to_the_byte,
        determinism::a_frame_is_the_same_in_every_run_and_beside_others,
        post::effects_are_the_same_to_the_bit,
    ]),
    case("B50", "No thread loses subnormal numbers, and every build draws the same", &[
        float_state::every_thread_keeps_subnormal_numbers,
        float_state::every_build_draws_the_same,
    ]),
];
