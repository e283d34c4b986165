//! Borders of the picture: one of any size is a crop of a larger one (B10).

use crate::pipeline::Pixels;
use crate::plan::{FrameRequest, Output, Plan};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw;

/// Shrinks a plan's picture about its centre, without a change to what each pixel shows.
fn cropped(plan: &Plan, [width, height]: [u32; 2]) -> Plan {
    let mut plan = plan.clone();
    assert!((plan.view.width - width).is_multiple_of(2) && (plan.view.height - height).is_multiple_of(2));
    (plan.view.width, plan.view.height) = (width, height);
    plan.size = [width, height];
    plan
}

pub fn b10_a_picture_of_any_size_is_a_crop_of_a_larger_one(ledger: &mut Ledger) {
    let sizes = [
        ([16_384, 5], [16_384, 1], 1),
        ([16_384, 5], [16_384, 1], 4),
        ([5, 16_384], [1, 16_384], 4),
        ([131, 67], [1, 1], 8),
        ([200, 132], [130, 66], 16),
        ([200, 133], [64, 65], 4),
        ([199, 131], [63, 33], 2),
    ];
    for orthographic in [false, true] {
        let mut json = serde_json::json!({
            "camera": { "position": [0.3, 0.4, 4], "target": [0, 0.1, 0], "fov_y_deg": 60 },
            "environment": { "background": { "type": "gradient", "top": "#48f", "bottom": "#fda" } },
            "textures": { "tiles": { "checker": { "colors": ["#123", "#fed"], "cells": 4 } } },
            "materials": { "tiled": { "diffuse_map": "tiles", "specular": [0.3, 0.3, 0.3] } },
            "meshes": { "torus": { "type": "torus" }, "floor": { "type": "plane", "size": [20, 9] } },
            "instances": {
                "torus": { "mesh": "torus", "material": "tiled", "rotation_deg": [50, 10, 0] },
                "floor": { "mesh": "floor", "material": "tiled", "translation": [0, -0.6, 0], "rotation_deg": [8, 3, 0] },
            },
        });
        if orthographic {
            json["camera"]["orthographic"] = serde_json::json!({ "height": 1.5 });
        }
        let scene = draw::scene(&json);
        for (large, small, samples) in sizes {
            for output in [Output::Color, Output::Normal, Output::Depth] {
                let request = FrameRequest {
                    width: Some(large[0]),
                    height: Some(large[1]),
                    samples: Some(samples),
                    output,
                    ..FrameRequest::default()
                };
                let plan = draw::plan(&scene, &request);
                let whole = draw::render(&plan).pixels;
                let crop = draw::render(&cropped(&plan, small)).pixels;
                let same = match (&whole, &crop) {
                    (Pixels::Rgba8 { pixels: whole, .. }, Pixels::Rgba8 { pixels: crop, .. }) => {
                        is_crop(whole, large, crop, small)
                    }
                    (Pixels::Gray16(whole), Pixels::Gray16(crop)) => is_crop(whole, large, crop, small),
                    _ => false,
                };
                let setting = format!(
                    "{small:?} of {large:?}, {samples} samples, {output:?}, orthographic {orthographic}"
                );
                ledger.holds(&setting, "pictures that are no crop", same);
            }
        }
    }
}

fn is_crop<P: PartialEq>(whole: &[P], large: [u32; 2], crop: &[P], small: [u32; 2]) -> bool {
    let [left, top] = [0, 1].map(|axis| ((large[axis] - small[axis]) / 2) as usize);
    let rows = crop.chunks(small[0] as usize);
    let row = |y: usize| &whole[(top + y) * large[0] as usize + left..][..small[0] as usize];
    rows.len() == small[1] as usize && rows.enumerate().all(|(y, part)| part == row(y))
}
