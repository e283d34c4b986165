//! What the headers of replies say: each is declared where it is sent, and described here.

use serde_json::{Value, json};

/// Headers of pictures and what they say.
const MEANINGS: [(&str, &str); 5] = [
    (
        "Server-Timing",
        "Milliseconds: of each pass that ran, of the wait in the queue, of encoding, and in all",
    ),
    ("Render-Stats", "Counts, as a dictionary of integers (RFC 8941): `triangles=12, drawn=6`"),
    ("Render-Depth-Range", "Of depths: the distances that the two ends stand for, `near, far`"),
    (
        "Render-Settings",
        "Where the query has a budget: the settings that it was settled into, with the `error` and the `ms` to expect \
         of them and the `source` of that, `measured` or `model`; with `budget=missed` where none is expected to keep \
         the budget and these come nearest to it. A list of `name=value` with `, ` between; a value \
         is a word or a decimal with any number of digits, so it is no RFC 8941 dictionary: \
         `samples=4, render_scale=1, error=0.012345, ms=3.210, source=model`",
    ),
    (
        "Content-Location",
        "Where the query has a budget: path and query of the same with those settings in its place",
    ),
];

/// Describes the headers of a call's reply.
pub(super) fn describe(operation: &mut Value) {
    let headers = operation.pointer_mut("/responses/200/headers").and_then(Value::as_object_mut);
    let Some(headers) = headers else { return };
    for (name, meaning) in MEANINGS {
        if let Some(header) = headers.get_mut(name) {
            header["description"] = json!(meaning);
        }
    }
}
