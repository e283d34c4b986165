//! `/openapi.json`: OpenAPI 3.1 from the handlers' own annotations.

mod headers;
mod pictures;
mod schemas;

use super::App;
use super::query::NoQuery;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get};
use serde_json::{Value, json};
use std::sync::Arc;
use utoipa::openapi::{InfoBuilder, OpenApi, OpenApiBuilder};
use utoipa::{IntoParams, ToSchema};

/// The frame query.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; `FrameRequest::read` does the reading")]
pub(super) struct FrameQuery {
    /// Pixels in a row
    #[param(minimum = 1)]
    width: Option<u32>,
    /// Rows
    #[param(minimum = 1)]
    height: Option<u32>,
    /// Samples a pixel: 1, 2, 4, 8 or 16
    samples: Option<u8>,
    /// Texels along a side of every shadow map
    #[param(minimum = 1, maximum = 16384)]
    shadow_resolution: Option<u32>,
    /// Samples of every PCF
    #[param(minimum = 1, maximum = 1024)]
    pcf_taps: Option<u32>,
    /// Samples with which PCSS looks for blockers
    #[param(minimum = 1, maximum = 1024)]
    search_taps: Option<u32>,
    /// Samples with which PCSS filters
    #[param(minimum = 1, maximum = 1024)]
    filter_taps: Option<u32>,
    /// `nearest`, `bilinear` or `trilinear`, in place of every texture's but those that are `nearest` themselves
    texture_filter: Option<String>,
    /// The picture is drawn with so many times the pixels along each side, and resampled
    #[param(minimum = 0.1, maximum = 4)]
    render_scale: Option<f64>,
    /// `draft`, `normal`, `high` or `reference`: settings on the scene's measured front, or on that of a built-in
    /// model of cost. The reply says which in `Render-Settings`; what the query sets itself stays
    preset: Option<String>,
    /// The settings with the least error that take at most so many milliseconds
    max_ms: Option<f64>,
    /// The fastest settings with at most this error: root mean square, in linear light from 0 to 1
    max_error: Option<f64>,
    /// Seconds
    t: Option<f64>,
    /// JPEG quality
    #[param(minimum = 1, maximum = 100)]
    quality: Option<u8>,
    /// `color`, `depth`, `normal`, `albedo`, `instance` or `wireframe`; of the pipeline's stages `ids` (a colour
    /// for each instance: the upper 24 bits of `id · 0x9E3779B1 mod 2³²`), `shadow_map`, `tiles` (how many
    /// triangles each lists), `shaded` (how many fragments each pixel has). A JPEG of depth has 8-bit greys, one
    /// of instances is that of `ids`
    output: Option<String>,
    /// `blinn_phong`, `lambert`, `unlit`, `vertex_color` or `normal`, in place of every material's
    shading: Option<String>,
    /// Where the camera stands: `x,y,z`
    eye: Option<String>,
    /// What it looks at: `x,y,z`
    target: Option<String>,
    /// Vertical field of view in degrees
    #[param(minimum = 0.001, maximum = 179.9)]
    fov: Option<f64>,
    /// Nearest distance drawn
    near: Option<f64>,
    /// Farthest distance drawn
    far: Option<f64>,
    /// Orthographic, with this full height of the view
    ortho: Option<f64>,
    /// About the target: `yaw,pitch` in degrees, and `,distance`
    orbit: Option<String>,
    /// `transparent`, `rrggbb`, or a name of the document's `backgrounds`
    background: Option<String>,
    /// What may be left out where the picture stays the same: `all`, `none`, or names with commas between
    elide: Option<String>,
}

/// How a stream runs.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; `StreamRequest::read` does the reading")]
pub(super) struct StreamQuery {
    /// Frames a second at most; 30 without it
    #[param(minimum = 0.1, maximum = 60)]
    fps: Option<f64>,
}

/// What a report measures.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; `reports::read_options` does the reading")]
pub(super) struct ReportQuery {
    /// Seconds that it may take; 30 without it
    #[param(minimum = 2, maximum = 600)]
    budget_s: Option<f64>,
    /// What is turned, with commas between: `samples`, `shadow_resolution`, `pcf_taps`, `pcss_taps`, `render_scale`,
    /// `texture_filter`; without it, all that the scene has
    knobs: Option<String>,
    /// Whether the catalogue of stiff cases is run too, for about a minute on top of `budget_s`; its table is in
    /// the report
    selftest: Option<bool>,
}

/// How the pictures of a stream lie one behind the other.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; the handler does the reading")]
pub(super) struct FramingQuery {
    /// `advance`: each picture with the next one's head behind it, as browsers need it; `length`: each with
    /// its length. Without it, `advance` where `Accept` names an image type
    framing: Option<String>,
}

/// What an archive holds.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; `Product::read_archive` does the reading")]
pub(super) struct Outputs {
    /// Outputs with commas between; without it, all but the pipeline's stages. It stands for `output`, which is
    /// not taken
    outputs: Option<String>,
}

/// How a turntable turns.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(
    dead_code,
    reason = "names and types for the description; `Product::read_turntable` does the reading"
)]
pub(super) struct Turn {
    /// Frames of a whole turn; 36 without it
    #[param(minimum = 1, maximum = 360)]
    frames: Option<u32>,
}

/// What a new scene is made of.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "names and types for the description; `query::source` does the reading")]
pub(super) struct SourceQuery {
    /// A name of the gallery, in place of a body; `up` and `floor` are not taken then
    from: Option<String>,
    /// Which of the model's axes is up: `y` or `z`
    up: Option<String>,
    /// Whether to put a floor under it
    floor: Option<bool>,
}

/// Holds a change to the scene's state that the client knows.
#[derive(IntoParams)]
#[into_params(parameter_in = Header)]
#[expect(dead_code, reason = "names and types for the description; `etag::precondition` does the reading")]
pub(super) struct IfMatch {
    /// ETags of the scene, or `*`
    #[param(rename = "If-Match")]
    if_match: Option<String>,
    /// ETags of what is changed, or `*`: only if it is not there
    #[param(rename = "If-None-Match")]
    if_none_match: Option<String>,
}

/// What a scene holds, in short.
#[derive(ToSchema)]
#[expect(dead_code, reason = "names and types for the description; the scene writes it")]
pub(super) struct Summary {
    id: String,
    name: Option<String>,
    revision: u64,
    /// `instances`, `meshes`, `triangles`, `vertices`, `materials`, `textures`, `lights`
    counts: Value,
    bytes: u64,
    /// `min` and `max` over the visible instances
    bounds: Option<Value>,
    /// The same over those that automatic framing looks at: instances with `framed`, true by default
    framed_bounds: Option<Value>,
    /// `file`, `line`, `detail`
    warnings: Vec<Value>,
    /// `self`, `frame`, …
    links: Value,
}

/// A file that came with a scene.
#[derive(ToSchema)]
#[expect(dead_code, reason = "names and types for the description")]
pub(super) struct FileEntry {
    name: String,
    bytes: u64,
}

/// A scene to open.
#[derive(ToSchema)]
#[expect(dead_code, reason = "names and types for the description; the gallery writes it")]
pub(super) struct GalleryPiece {
    /// What `from` takes
    name: String,
    title: String,
    description: String,
    /// Path of a small picture
    picture: String,
}

/// What there is before any route: the title.
pub(super) fn head() -> OpenApi {
    let info = InfoBuilder::new()
        .title("rasterd")
        .version(env!("CARGO_PKG_VERSION"))
        .description(Some(env!("CARGO_PKG_DESCRIPTION")));
    OpenApiBuilder::new().info(info).build()
}

/// The route that serves the description of `api`, this route and the errors included.
pub(super) fn route(api: OpenApi) -> MethodRouter<App> {
    let text: Arc<str> = described(api).to_string().into();
    get(move |_: NoQuery| async move { reply(&text) })
}

fn reply(text: &Arc<str>) -> Response {
    ([(CONTENT_TYPE, "application/json")], text.to_string()).into_response()
}

fn described(api: OpenApi) -> Value {
    let mut api = json!(api);
    api["paths"]["/openapi.json"] = json!({ "get": {
        "tags": ["service"],
        "summary": "This description",
        "responses": { "200": { "description": "OpenAPI 3.1", "content": { "application/json": { "schema": {} } } } },
    } });
    api["components"]["schemas"]["Problem"] = problem_schema();
    let Some(paths) = api["paths"].as_object_mut() else { return api };
    for item in paths.values_mut() {
        item.as_object_mut().into_iter().flatten().for_each(|(_, operation)| schemas::narrow(operation));
    }
    pictures::expand(paths);
    for (path, item) in paths {
        for (method, operation) in item.as_object_mut().into_iter().flatten() {
            operation["operationId"] = json!(operation_id(path, method));
            headers::describe(operation);
            add_errors(path, method, operation);
        }
    }
    api
}

/// `get_scenes_id_frame_png`: the handlers' own names repeat from noun to noun.
fn operation_id(path: &str, method: &str) -> String {
    let words = path.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    std::iter::once(method).chain(words).collect::<Vec<_>>().join("_")
}

/// Every status that the call's shape lets it answer, beside those it names itself.
fn add_errors(path: &str, method: &str, operation: &mut Value) {
    let has_body = operation.get("requestBody").is_some();
    let has_format = ["/frame.", "/turntable.", "/render.", "/stream.", "/events", "/report."]
        .iter()
        .any(|stem| path.contains(stem));
    let draws = has_format || path.ends_with("/pick") || path.ends_with("/plan");
    let changes = method != "get";
    let conditional = changes && path.contains("{id}") && !draws;
    let of = |applies: bool, statuses: &'static [u16]| if applies { statuses } else { &[] };
    let statuses = [
        of(true, &[403, 422, 431, 500]),
        of(path.contains('{'), &[400]),
        // What is put under a name need not be there yet.
        of(path.contains('{') && (method, path) != ("put", "/scenes/{id}"), &[404]),
        of(has_body, &[400, 408, 413, 415, 422]),
        of(has_body && !draws, &[507]),
        of(conditional, &[412]),
        of(has_format, &[406]),
        of(draws, &[413, 503, 504]),
        of(path == "/readyz", &[503]),
    ];
    for status in statuses.into_iter().flatten() {
        operation["responses"][status.to_string()] = problem_response(*status);
    }
}

fn problem_response(status: u16) -> Value {
    let status = axum::http::StatusCode::from_u16(status).ok();
    let description = status.and_then(|status| status.canonical_reason()).unwrap_or("Error");
    let schema = json!({ "$ref": "#/components/schemas/Problem" });
    json!({ "description": description, "content": { "application/problem+json": { "schema": schema } } })
}

/// RFC 9457, with what this service adds.
fn problem_schema() -> Value {
    let text = json!({ "type": "string" });
    json!({
        "type": "object",
        "required": ["type", "title", "status", "detail", "request_id"],
        "properties": {
            "type": text, "title": text, "status": { "type": "integer" }, "detail": text, "request_id": text,
            "errors": { "type": "array", "items": {
                "type": "object",
                "required": ["detail"],
                "properties": { "pointer": text, "parameter": text, "detail": text },
            } },
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::FrameRequest;
    use crate::plan::request::Query;

    #[test]
    fn a_scene_that_is_put_need_not_be_there() {
        let answers = |method: &str| {
            let mut operation = json!({});
            add_errors("/scenes/{id}", method, &mut operation);
            ["400", "404"].map(|status| operation["responses"][status].is_object())
        };
        assert_eq!((answers("put"), answers("patch")), ([true, false], [true, true]));
    }

    #[test]
    fn the_frame_query_is_described_name_by_name() {
        let described: Vec<String> =
            FrameQuery::into_params(|| None).into_iter().map(|param| param.name).collect();
        let mut query = Query::new([]);
        FrameRequest::read(&mut query);
        let served = query.known().iter();
        assert!(described.iter().eq(served), "{described:?}");
    }
}
