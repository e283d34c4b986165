//! Whole frames: a document in, a picture out.

use super::stage::with_work;
use rasterd::limits::Limits;
use rasterd::pipeline::{self, Frame, Pixels};
use rasterd::plan::{FrameRequest, Output, Plan};
use rasterd::scene::{self, Document, Files, Scene};
use serde_json::Value;
use std::sync::Arc;

/// Compiles a document that is right.
pub fn scene(json: &Value) -> Arc<Scene> {
    let document = Document::from_json(json).unwrap_or_else(|faults| panic!("{faults:?}"));
    let compiled = scene::compile(&document, &Files::default(), None, &Limits::default());
    Arc::new(compiled.unwrap_or_else(|error| panic!("{error:?}")).scene)
}

/// Pointers to what is wrong with a document.
pub fn faults(json: &Value) -> Vec<String> {
    match Document::from_json(json) {
        Ok(_) => Vec::new(),
        Err(faults) => faults.into_iter().map(|fault| fault.pointer).collect(),
    }
}

/// Settles a frame.
pub fn plan(scene: &Arc<Scene>, request: &FrameRequest) -> Plan {
    Plan::new(scene, request, &Limits::default()).unwrap_or_else(|error| panic!("{error:?}"))
}

/// Draws a frame.
pub fn draw(plan: &Plan) -> Frame {
    with_work(|work| pipeline::render(plan, work)).expect("nothing cancels")
}

/// The colours of a document's picture.
pub fn colors(json: &Value) -> Vec<[u8; 4]> {
    match draw(&plan(&scene(json), &FrameRequest::default())).pixels {
        Pixels::Rgba8 { pixels, .. } => pixels,
        _ => panic!("asked for colours"),
    }
}

/// The values of a document's picture.
pub fn values(json: &Value, output: Output) -> Vec<u16> {
    let request = FrameRequest { output, ..FrameRequest::default() };
    match draw(&plan(&scene(json), &request)).pixels {
        Pixels::Gray16(values) => values,
        _ => panic!("asked for values"),
    }
}
