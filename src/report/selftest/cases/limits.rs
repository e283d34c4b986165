//! Sizes at and over their bounds (B48).

use crate::limits::Limits;
use crate::plan::{FrameRequest, Plan, PlanError};
use crate::report::selftest::Ledger;
use crate::scene::{self, Document, Files};
use serde_json::json;
use std::sync::Arc;

/// B48: no product of sizes wraps, and every bound is met exactly.
pub fn pictures_are_planned_up_to_their_limits_and_not_beyond(ledger: &mut Ledger) {
    let document = Document::from_json(&json!({ "lights": {} })).expect("a sound document");
    let limits = Limits::default();
    let compiled = scene::compile(&document, &Files::default(), None, &limits).expect("it compiles");
    let scene = Arc::new(compiled.scene);
    let plan = |width: u32, height: u32| {
        let request = FrameRequest {
            width: Some(width),
            height: Some(height),
            samples: Some(16),
            ..FrameRequest::default()
        };
        Plan::new(&scene, &request, &limits)
    };
    let sizes = [
        (1, 1, true),
        (16_384, 4096, true),
        (16_384, 4097, false),
        (8192, 8192, true),
        (8193, 8192, false),
        (16_384, 1, true),
        (16_385, 1, false),
        (1, 16_385, false),
        (65_536, 65_536, false),
        (u32::MAX, u32::MAX, false),
    ];
    let wrong = sizes.iter().filter(|&&(width, height, fits)| match plan(width, height) {
        Ok(_) => !fits,
        Err(PlanError::TooLarge { limit, value, .. }) => fits || value <= limit,
        Err(PlanError::Query(_)) => true,
    });
    ledger.none_of("", "sizes on the wrong side", wrong.count(), sizes.len());
    for size in [json!(0), json!(-1), json!(1.5)] {
        let faults = Document::from_json(&json!({ "render": { "width": size } })).expect_err("no size");
        let is_named = faults[0].pointer == "/render/width";
        ledger.holds(&size.to_string(), "sizes not refused by name", is_named);
    }
}
