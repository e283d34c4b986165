//! `frame.json`: what a program needs to know about a frame's pictures: the camera that took them, and
//! what their values mean.

use crate::math::view::SUBPIXELS;
use crate::math::{Projection, View};
use crate::plan::{Output, Plan};
use crate::scene::{Instance, Lens};
use glam::{DMat4, DVec3, DVec4};
use serde_json::{Map, Value, json};

/// Describes the frame that `plan` draws, with the pictures of `outputs` beside it. `depth_range` is what 0 and
/// 65535 stand for in a picture of depth.
///
/// Matrices are lists of rows and multiply columns from the left. World space is right-handed with y up, a
/// camera looks along −z of view space, and in clip space what can be seen has −w ≤ x, y ≤ w and
/// 0 ≤ z ≤ w, with the near plane at z = w.
#[must_use]
pub fn frame_json(plan: &Plan, outputs: &[Output], depth_range: Option<[f64; 2]>) -> Vec<u8> {
    let (view, camera) = (&plan.view.with_size(plan.size), &plan.camera);
    let files: Map<String, Value> = outputs
        .iter()
        .map(|output| (output.word().to_owned(), json!(format!("{}.png", output.word()))))
        .collect();
    let eye_world = plan.scene.anchor + view.eye;
    let view_from_world = view_from_world(view, eye_world);
    let clip_from_view = clip_from_view(view);
    let description = json!({
        "width": view.width,
        "height": view.height,
        "t": plan.t,
        "files": files,
        "camera": {
            "position": eye_world.to_array(),
            "forward": view.forward.to_array(),
            "right": view.right.to_array(),
            "up": view.up.to_array(),
            "projection": projection(view, camera.lens),
            "near": view.near,
            "far": camera.far,
            "view_from_world": rows(view_from_world),
            "clip_from_view": rows(clip_from_view),
            "clip_from_world": rows(clip_from_view * view_from_world),
        },
        "depth_range": depth_range,
        "instances": instances(plan),
    });
    let mut bytes = serde_json::to_vec_pretty(&description).expect("a value of strings and numbers");
    bytes.push(b'\n');
    bytes
}

/// Focal length and principal point are in pixels from the upper left corner of the picture.
fn projection(view: &View, lens: Lens) -> Value {
    let principal_point_px = [view.width, view.height].map(|side| f64::from(side) / 2.0);
    let focal_length_px = view.scale.map(|subpixels| subpixels / f64::from(SUBPIXELS));
    match lens {
        Lens::Perspective { fov_y_deg } => json!({
            "type": "perspective",
            "fov_y_deg": fov_y_deg,
            "focal_length_px": focal_length_px,
            "principal_point_px": principal_point_px,
        }),
        Lens::Orthographic { height } => json!({ "type": "orthographic", "height": height }),
    }
}

fn view_from_world(view: &View, eye_world: DVec3) -> DMat4 {
    let row = |axis: DVec3| axis.extend(-axis.dot(eye_world));
    DMat4::from_cols(row(view.right), row(view.up), row(-view.forward), DVec4::W).transpose()
}

/// As the pipeline has it: depth reversed, and in perspective without a far plane.
fn clip_from_view(view: &View) -> DMat4 {
    let half = view.half_extent();
    let [x, y] = [view.scale[0] / half[0], view.scale[1] / half[1]];
    let [depth, w] = match view.projection {
        Projection::Perspective => [DVec4::W * view.near, -DVec4::Z],
        Projection::Orthographic => {
            let slope = view.depth_slope();
            [DVec4::new(0.0, 0.0, slope, 1.0 + view.near * slope), DVec4::W]
        }
    };
    DMat4::from_cols(DVec4::X * x, DVec4::Y * y, depth, w).transpose()
}

fn rows(matrix: DMat4) -> Value {
    json!(matrix.transpose().to_cols_array_2d())
}

/// Every instance by name: its value in a picture of instances, its mesh, and whether it is drawn at all. Those
/// that are hidden keep their values, so that the others' do not change with them.
fn instances(plan: &Plan) -> Map<String, Value> {
    let of = |(index, instance): (usize, &Instance)| {
        let mesh = &plan.scene.mesh_names[instance.mesh as usize];
        (instance.name.clone(), json!({ "id": index + 1, "mesh": mesh, "visible": instance.visible }))
    };
    plan.scene.instances.iter().enumerate().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(projection: Projection) -> View {
        View {
            eye: DVec3::new(1.0, 2.0, 7.0),
            right: DVec3::X,
            up: DVec3::Y,
            forward: DVec3::NEG_Z,
            projection,
            scale: [256.0 * 40.0; 2],
            near: 0.5,
            far: 100.0,
            width: 80,
            height: 40,
        }
    }

    /// Where a world point is in the picture, and its depth, by the matrices alone.
    fn seen(view: &View, point: DVec3) -> [f64; 3] {
        let clip = clip_from_view(view) * view_from_world(view, view.eye) * point.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        [f64::from(view.width) * (0.5 + ndc.x / 2.0), f64::from(view.height) * (0.5 - ndc.y / 2.0), ndc.z]
    }

    #[test]
    fn the_matrices_say_where_a_point_is_seen() {
        let (point, distance) = (DVec3::new(3.0, 1.0, -3.0), 10.0);
        let perspective = view(Projection::Perspective);
        let expected = [40.0 + 40.0 * 2.0 / distance, 20.0 + 40.0 / distance, perspective.depth(distance)];
        assert_eq!(seen(&perspective, point), expected);
        let orthographic = view(Projection::Orthographic);
        let [x, y, depth] = seen(&orthographic, point);
        assert_eq!([x, y], [40.0 + 40.0 * 2.0, 20.0 + 40.0]);
        assert!((depth - orthographic.depth(distance)).abs() < 1e-15);
    }
}
