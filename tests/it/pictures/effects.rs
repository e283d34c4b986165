//! Post effects of a caller's own, behind those of the document.

use crate::closed_form::encode;
use crate::draw::{Picture, frame, output, plan, samples, scene, work};
use rasterd::pipeline::post::{Effect, LinearFrame, write_rows};
use rasterd::pipeline::{self, Cancelled, Work};
use rasterd::plan::{FrameRequest, Neighbourhood, Output, Plan};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicU32, Ordering};

/// `factor · colour + offset`, in every channel of colour. It counts how often it is applied.
struct Affine {
    factor: f32,
    offset: f32,
    applied: AtomicU32,
}

impl Affine {
    fn new(factor: f32, offset: f32) -> Self {
        Self { factor, offset, applied: AtomicU32::new(0) }
    }

    fn count(&self) -> u32 {
        self.applied.load(Ordering::Relaxed)
    }
}

impl Effect for Affine {
    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        self.applied.fetch_add(1, Ordering::Relaxed);
        write_rows(&mut frame.planes[..3], work, |_, rows| {
            for sample in rows.iter_mut().flat_map(|row| row.iter_mut()) {
                *sample = self.factor * *sample + self.offset;
            }
        })
    }
}

/// Shows at each pixel what is `by` columns to the right and rows below; the border repeats.
struct Shift {
    by: [usize; 2],
}

impl Effect for Shift {
    fn spare_planes(&self) -> usize {
        4
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height, count) = (frame.width, frame.height, frame.planes.len());
        let LinearFrame { planes, spare, .. } = frame;
        write_rows(&mut spare[..count], work, |y, rows| {
            for (to, from) in rows.iter_mut().zip(&*planes) {
                let from = from.row((y + self.by[1]).min(height - 1));
                for (x, to) in to.iter_mut().enumerate().take(width) {
                    *to = from[(x + self.by[0]).min(width - 1)];
                }
            }
        })?;
        planes.swap_with_slice(&mut spare[..count]);
        Ok(())
    }
}

/// A picture of one colour.
fn plain(color: f64, post: &Value) -> Value {
    json!({
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "fov_y_deg": 40 },
        "environment": { "background": { "type": "color", "color": [color, color, color] } },
        "post": post,
        "render": { "width": 37, "height": 21, "samples": 1 },
    })
}

/// A ball before a gradient or before nothing.
fn ball(background: &str, post: &Value) -> Value {
    json!({
        "camera": { "position": [1, 1, 3], "target": [0, 0, 0], "fov_y_deg": 30 },
        "environment": { "background": { "type": background } },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.6], "intensity": 3 } },
        "meshes": { "ball": { "type": "sphere", "radius": 0.6 } },
        "instances": { "ball": { "mesh": "ball" } },
        "post": post,
        "render": { "width": 67, "height": 45, "samples": 4 },
    })
}

fn planned(document: &Value) -> Plan {
    plan(&scene(document), &FrameRequest::default())
}

fn drawn(document: &Value, effects: &[&dyn Effect]) -> Picture {
    Picture::new(pipeline::render_with(&planned(document), effects, &work()).expect("nobody cancels"))
}

#[test]
fn effects_run_once_in_order_behind_those_of_the_document() {
    let scale = |factor: f64| json!({ "type": "tonemap", "operator": "none", "exposure": factor });
    let keep = json!({ "type": "kernel", "kernel": [[0, 0, 0], [0, 1, 1e-30], [0, 0, 0]] });
    // With the factor that the chain as a whole is.
    let chains = [
        (json!([]), 1.0),
        (json!([scale(0.5)]), 0.5),
        (json!([keep]), 1.0),
        (json!([scale(0.5), keep]), 0.5),
        (json!([keep, scale(0.5)]), 0.5),
        (json!([scale(0.8), keep, scale(0.9), keep, scale(0.7)]), 0.8 * 0.9 * 0.7),
    ];
    for (post, of_chain) in &chains {
        let document = plain(0.2, post);
        for order in [[0, 1], [1, 0]] {
            let own = [Affine::new(1.0, 0.1), Affine::new(3.0, 0.0)];
            let effects: [&dyn Effect; 2] = order.map(|i: usize| &own[i] as &dyn Effect);
            let linear = order
                .into_iter()
                .fold(0.2 * of_chain, |color, i| f64::from(own[i].factor) * color + f64::from(own[i].offset));
            let picture = drawn(&document, &effects);
            for (x, y, pixel) in picture.iter() {
                let off = (255.0 * encode(linear) - f64::from(pixel[0])).abs();
                assert!(off <= 0.501, "{post}, {order:?}: {pixel:?} at ({x}, {y}) for {linear}");
                assert_eq!(pixel, [pixel[0], pixel[0], pixel[0], 255]);
            }
            assert_eq!(own.map(|effect| effect.count()), [1, 1]);
        }
        assert_eq!(drawn(&document, &[]), Picture::of(&document), "{post}");
    }
}

#[test]
fn effects_of_the_document_give_the_same_bytes_from_a_caller() {
    let effects = [
        json!({ "type": "blur", "radius": 3 }),
        json!({ "type": "bloom", "threshold": 0.4, "intensity": 2 }),
        json!({ "type": "bloom", "threshold": 0.4, "intensity": 2, "radius": 0 }),
        json!({ "type": "sharpen" }),
        json!({ "type": "fxaa" }),
        json!({ "type": "kernel", "kernel": [[0, 1, 0], [1, -3, 1], [0, 1, 0]] }),
    ];
    for background in ["gradient", "transparent"] {
        for effect in &effects {
            let document = ball(background, &json!([effect]));
            let plan = planned(&document);
            let neighbourhood: &Neighbourhood = plan.post.passes[0].effect.as_ref().expect("an effect");
            let own = drawn(&ball(background, &json!([])), &[neighbourhood.as_effect()]);
            assert!(own == Picture::of(&document), "{effect}, {background}");
        }
    }
    let steps =
        json!([{ "type": "vignette" }, { "type": "tonemap" }, { "type": "grayscale", "amount": 0.3 }]);
    let document = ball("gradient", &steps);
    let steps = &planned(&document).post.in_tiles;
    let each: Vec<&dyn Effect> = steps.iter().map(|step| step as &dyn Effect).collect();
    let bare = ball("gradient", &json!([]));
    assert!(drawn(&bare, &[steps]) == Picture::of(&document));
    assert!(drawn(&bare, &each) == Picture::of(&document));
}

#[test]
fn an_effect_looks_at_neighbours_and_works_in_spare_planes() {
    for background in ["gradient", "transparent"] {
        for post in [json!([]), json!([{ "type": "blur", "radius": 2 }])] {
            let document = ball(background, &post);
            let (still, moved) = (Picture::of(&document), drawn(&document, &[&Shift { by: [5, 3] }]));
            for (x, y, pixel) in moved.iter() {
                assert_eq!(pixel, still.at((x + 5).min(66), (y + 3).min(44)), "({x}, {y}), {background}");
            }
        }
    }
}

#[test]
fn data_outputs_and_radiance_know_no_effects() {
    let scene = scene(&ball("gradient", &json!([])));
    let effect = Affine::new(2.0, 0.5);
    for what in
        [Output::Normal, Output::Albedo, Output::Depth, Output::Instance, Output::Wireframe, Output::Radiance]
    {
        let request = output(what);
        let with = pipeline::render_with(&plan(&scene, &request), &[&effect], &work());
        assert!(with.expect("nobody cancels").pixels == frame(&scene, &request).pixels, "{what:?}");
    }
    assert_eq!(effect.count(), 0);
    let color = pipeline::render_with(&plan(&scene, &samples(1)), &[&effect], &work());
    assert_eq!(color.expect("nobody cancels").timings.iter().last().map(|(pass, _)| pass), Some("post"));
    assert_eq!(effect.count(), 1);
}
