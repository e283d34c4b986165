//! Schemas that the annotations can't say: words, tuples in text, bodies by media type.

use crate::plan::{Elision, FrameRequest, Output};
use crate::scene::gallery;
use serde_json::{Value, json};

/// Narrows the parameters and bodies of a call to what is taken.
pub(super) fn narrow(operation: &mut Value) {
    let parameters = operation.get_mut("parameters").and_then(Value::as_array_mut);
    for parameter in parameters.into_iter().flatten() {
        let is_query = parameter["in"] == "query";
        if let Some(schema) = parameter["name"].as_str().filter(|_| is_query).and_then(of_parameter) {
            parameter["schema"] = schema;
        }
    }
    if takes_gallery(operation) {
        operation["requestBody"]["required"] = json!(false);
    }
    let contents = operation.pointer_mut("/requestBody/content").and_then(Value::as_object_mut);
    for (media_type, content) in contents.into_iter().flatten() {
        if let Some(schema) = of_body(media_type) {
            content["schema"] = schema;
        }
    }
}

/// Whether a name of the gallery may stand in place of the body.
fn takes_gallery(operation: &Value) -> bool {
    let parameters = operation.get("parameters").and_then(Value::as_array);
    parameters.into_iter().flatten().any(|parameter| parameter["name"] == "from")
}

fn of_parameter(name: &str) -> Option<Value> {
    match name {
        "samples" => Some(json!({ "type": "integer", "enum": [1, 2, 4, 8, 16] })),
        "output" | "shading" | "texture_filter" | "preset" => Some(words(&FrameRequest::words(name))),
        "outputs" => Some(listed(&Output::all())),
        "up" => Some(words(&["y", "z"])),
        "from" => {
            let names: Vec<&str> = gallery::pieces().iter().map(|piece| piece.name).collect();
            Some(words(&names))
        }
        "near" | "far" | "ortho" | "max_ms" | "max_error" => {
            Some(json!({ "type": "number", "exclusiveMinimum": 0 }))
        }
        "eye" | "target" => Some(numbers("{2}")),
        "orbit" => Some(numbers("{1,2}")),
        "background" => Some(json!({ "type": "string", "minLength": 1 })),
        "framing" => Some(words(&["advance", "length"])),
        "elide" => Some(elisions()),
        _ => None,
    }
}

/// `all`, `none`, or some of the names with commas between.
fn elisions() -> Value {
    let name = format!("({})", Elision::ALL.map(Elision::name).join("|"));
    json!({ "type": "string", "pattern": format!("^(all|none|{name}(,{name})*)$") })
}

fn words(words: &[&str]) -> Value {
    json!({ "type": "string", "enum": words })
}

/// Some of `outputs` with commas between.
fn listed(outputs: &[Output]) -> Value {
    let word = format!("({})", outputs.iter().map(|output| output.word()).collect::<Vec<_>>().join("|"));
    json!({ "type": "string", "pattern": format!("^{word}(,{word})*$") })
}

/// A number and as many more as `times` says, with commas between: in form all that the query's reader
/// takes.
fn numbers(times: &str) -> Value {
    let number = r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*";
    json!({ "type": "string", "pattern": format!("^{number}(,{number}){times}$") })
}

fn of_body(media_type: &str) -> Option<Value> {
    match media_type {
        "application/json" | "application/merge-patch+json" => Some(json!({ "type": "object" })),
        "multipart/form-data" => Some(json!({
            "type": "object",
            "properties": { "scene": { "type": "object", "description": "The document; without it, every OBJ among the files is an instance" } },
            "additionalProperties": { "type": "string", "contentMediaType": "application/octet-stream", "description": "A file, under its file name" },
        })),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::string::string_regex;

    /// Texts that match the pattern of `parameter`.
    fn texts(parameter: &str) -> impl Strategy<Value = String> + use<> {
        let schema = of_parameter(parameter).expect("a schema");
        let pattern = schema["pattern"].as_str().expect("a pattern");
        // The generator has no anchors; whole texts are what it makes.
        string_regex(pattern.trim_matches(['^', '$'])).expect("a regular expression")
    }

    fn fault(parameter: &str, text: &str) -> String {
        let faults = FrameRequest::parse([(parameter, text)]).err().unwrap_or_default();
        faults.first().map_or_else(String::new, |fault| fault.detail.clone())
    }

    proptest! {
        /// What is left to refuse are values, not forms.
        #[test]
        fn the_reader_takes_what_the_patterns_describe(eye in texts("eye"), orbit in texts("orbit")) {
            for detail in [fault("eye", &eye), fault("orbit", &orbit)] {
                let of_value = detail.is_empty() || detail.contains("must lie in") || detail.contains("greater than");
                prop_assert!(of_value || is_too_large(&eye) || is_too_large(&orbit), "{detail}");
            }
        }
    }

    /// Whether one of the numbers is beyond f64.
    fn is_too_large(text: &str) -> bool {
        text.split(',').any(|part| part.trim().parse().is_ok_and(f64::is_infinite))
    }

    #[test]
    fn a_body_may_be_left_out_where_the_gallery_stands_in_for_it() {
        let narrowed = |parameter: &str| {
            let mut operation = json!({ "parameters": [{ "name": parameter, "in": "query" }], "requestBody": { "required": true } });
            narrow(&mut operation);
            operation["requestBody"]["required"].clone()
        };
        assert_eq!((narrowed("from"), narrowed("up")), (json!(false), json!(true)));
    }

    #[test]
    fn the_patterns_describe_the_forms_that_the_reader_takes() {
        for text in ["1,2,3", "-1.5e3, +.5 ,2.", "0,1E-2,1e+2"] {
            assert_eq!(fault("eye", text), "", "{text}");
        }
    }
}
