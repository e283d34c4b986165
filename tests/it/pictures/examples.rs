//! The examples draw what their documentation says.

use super::golden::assert_golden;
use crate::draw::{levels, pool, work, work_of};

use rasterd::math::simd::Level;

#[path = "../../../examples/custom_post.rs"]
#[expect(dead_code, reason = "its `main` writes a file")]
mod custom_post;

#[path = "../../../examples/custom_shader.rs"]
#[expect(dead_code, reason = "its `main` writes files")]
mod custom_shader;

#[path = "../../../examples/pipeline.rs"]
#[expect(dead_code, reason = "its `main` writes files")]
mod pipeline;

#[test]
fn golden_examples() {
    assert_golden(
        "examples/a_halftone_print",
        &custom_post::draw(240, 160, &work()).expect("nobody cancels"),
    );
    let [flag, normals] = custom_shader::draw(&work()).expect("nobody cancels");
    assert_golden("examples/a_waving_flag", &flag);
    assert_golden("examples/the_normals_of_a_waving_flag", &normals);
    let [colors, depths, ids] = pipeline::draw(&work()).expect("nobody cancels");
    assert_golden("examples/triangles_and_a_box", &colors);
    assert_golden("examples/depths_of_triangles_and_a_box", &depths);
    assert_golden("examples/ids_of_triangles_and_a_box", &ids);
}

#[test]
fn a_halftone_print_is_the_same_to_the_byte() {
    let draw = |threads, level| {
        let pool = pool(threads);
        custom_post::draw(120, 80, &work_of(pool, level)).expect("nobody cancels").pixels
    };
    let first = draw(1, Level::new());
    for (name, level) in levels() {
        for threads in [2, 16] {
            assert!(draw(threads, level) == first, "{name}, {threads} threads");
        }
    }
}
