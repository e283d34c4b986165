//! One route for pictures or reports of every format becomes a path for each, with what holds for it alone.

use crate::encode::{Animation, Format};
use crate::http::reports;
use crate::plan::Output;
use serde_json::{Map, Value, json};

/// Where a route's path has its format.
const FORMAT: &str = "{format}";

/// What is said of one format.
struct Kind {
    extension: &'static str,
    content_type: &'static str,
    has_quality: bool,
    outputs: Vec<&'static str>,
}

/// Puts a path for each format in the place of every path for all of them.
pub(super) fn expand(paths: &mut Map<String, Value>) {
    for (path, mut item) in std::mem::take(paths) {
        if path.ends_with("/frame.zip") {
            operations(&mut item).for_each(|operation| {
                retain_parameters(operation, |name| name != "output" && name != "quality")
            });
        }
        let Some(stem) = path.strip_suffix(FORMAT) else {
            paths.insert(path, item);
            continue;
        };
        for kind in kinds(stem) {
            let mut item = item.clone();
            operations(&mut item).for_each(|operation| kind.describe(operation));
            paths.insert(format!("{stem}{}", kind.extension), item);
        }
    }
}

/// The formats of a path that ends before them.
fn kinds(stem: &str) -> Vec<Kind> {
    if stem.ends_with("/turntable.") {
        animations()
    } else if stem.ends_with("/report.") {
        reports()
    } else {
        stills()
    }
}

fn operations(item: &mut Value) -> impl Iterator<Item = &mut Value> {
    item.as_object_mut().into_iter().flat_map(Map::values_mut)
}

fn retain_parameters(operation: &mut Value, keep: impl Fn(&str) -> bool) {
    if let Some(parameters) = operation["parameters"].as_array_mut() {
        parameters.retain(|parameter| parameter["name"].as_str().is_none_or(&keep));
    }
}

fn stills() -> Vec<Kind> {
    let kind = |format: Format| Kind {
        extension: format.extension(),
        content_type: format.content_type(),
        has_quality: matches!(format, Format::Jpeg { .. }),
        outputs: words(|output| format.drawn_as(output).is_ok()),
    };
    Format::ALL.map(kind).into()
}

fn animations() -> Vec<Kind> {
    let kind = |format: Animation| Kind {
        extension: format.extensions()[0],
        content_type: format.content_type(),
        has_quality: false,
        outputs: words(|output| format.check(output).is_ok()),
    };
    Animation::ALL.map(kind).into()
}

fn reports() -> Vec<Kind> {
    let kind = |format: &reports::Format| Kind {
        extension: format.extension,
        content_type: format.content_type,
        has_quality: false,
        outputs: words(|_| true),
    };
    reports::FORMATS.iter().map(kind).collect()
}

fn words(fits: impl Fn(Output) -> bool) -> Vec<&'static str> {
    Output::all().into_iter().filter(|output| fits(*output)).map(Output::word).collect()
}

impl Kind {
    fn describe(&self, operation: &mut Value) {
        let schema = match self.content_type {
            "application/json" => json!({ "type": "object" }),
            other => json!({ "type": "string", "contentMediaType": other }),
        };
        operation["responses"]["200"]["content"] = json!({ self.content_type: { "schema": schema } });
        retain_parameters(operation, |name| self.has_quality || name != "quality");
        narrow_outputs(operation, &self.outputs);
    }
}

fn narrow_outputs(operation: &mut Value, outputs: &[&str]) {
    let parameters = operation["parameters"].as_array_mut().into_iter().flatten();
    for output in parameters.filter(|parameter| parameter["name"] == "output") {
        output["schema"] = json!({ "type": "string", "enum": outputs });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_format_is_described_by_itself() {
        let operation = json!({ "get": {
            "parameters": [{ "name": "quality" }, { "name": "output" }],
            "responses": { "200": {} },
        } });
        let mut paths =
            Map::from_iter([("/a/frame.{format}".to_owned(), operation), ("/b".to_owned(), json!(1))]);
        expand(&mut paths);
        assert_eq!(paths.len(), 1 + Format::ALL.len());
        let names = |path: &str| -> Vec<String> {
            let parameters = paths[path]["get"]["parameters"].as_array().expect("a list");
            parameters
                .iter()
                .map(|parameter| parameter["name"].as_str().expect("a name").to_owned())
                .collect()
        };
        assert_eq!(names("/a/frame.jpg"), ["quality", "output"]);
        assert_eq!(names("/a/frame.png"), ["output"]);
        let outputs = |path: &str| {
            paths[path]["get"]["parameters"].as_array().expect("a list").last().expect("one")["schema"]["enum"].clone()
        };
        assert_eq!(outputs("/a/frame.exr"), json!(["color"]));
        assert!(outputs("/a/frame.png").as_array().expect("a list").contains(&json!("depth")));
        assert!(paths["/a/frame.exr"]["get"]["responses"]["200"]["content"]["image/x-exr"].is_object());
    }
}
