//! The examples draw what their documentation says.

use super::golden::assert_golden;
use crate::draw::work;

#[path = "../../../examples/custom_shader.rs"]
#[expect(dead_code, reason = "its `main` writes files")]
mod custom_shader;

#[path = "../../../examples/pipeline.rs"]
#[expect(dead_code, reason = "its `main` writes files")]
mod pipeline;

#[test]
fn golden_examples() {
    let [flag, normals] = custom_shader::draw(&work()).expect("nobody cancels");
    assert_golden("examples/a_waving_flag", &flag);
    assert_golden("examples/the_normals_of_a_waving_flag", &normals);
    let [colors, depths, ids] = pipeline::draw(&work()).expect("nobody cancels");
    assert_golden("examples/triangles_and_a_box", &colors);
    assert_golden("examples/depths_of_triangles_and_a_box", &depths);
    assert_golden("examples/ids_of_triangles_and_a_box", &ids);
}
