//! Sizes at and over their bounds, and files at the edge of what a parser takes (B47, B48).

use crate::import::obj::{self, ObjOptions};
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

/// B47: a mesh, or an error that names the line.
pub fn odd_models_are_read_or_refused_by_line(ledger: &mut Ledger) {
    let refused = [
        ("v 0 0 0\nf 0 1 1\n", 2),
        ("v 0 0 0\n\nf 1 1 2\n", 3),
        ("v 0 0 0\nv 1 0 0\nf 1 2 -3\n", 3),
        ("v 1e400 0 0\n", 1),
        ("v 0 0 0\nv 0 nan 0\n", 2),
        ("v 0 0 0\nv 1 0\n", 2),
    ];
    let wrong = refused.iter().filter(|(text, line)| {
        let error = obj::read(text.as_bytes(), &ObjOptions::default()).err();
        error.and_then(|error| error.line()) != Some(*line)
    });
    ledger.none_of("", "faults at another line", wrong.count(), refused.len());

    let concave = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    let read = [
        ("negative indices", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n".to_owned(), 1),
        ("CRLF and BOM", "\u{feff}v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n".to_owned(), 1),
        ("a continued line", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3\n".to_owned(), 1),
        ("a concave pentagon", concave.to_owned(), 3),
        (
            "a line of 100 MB",
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n# {}\nf 1 2 3\n", "x".repeat(100_000_000)),
            1,
        ),
    ];
    for (case, text, triangles) in &read {
        let read = obj::read(text.as_bytes(), &ObjOptions::default()).map(|model| model.mesh.triangles.len());
        ledger.holds(case, "models read otherwise", read.is_ok_and(|read| read == *triangles));
    }
}
