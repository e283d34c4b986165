//! Request bodies: read within a limit and a time, and told apart by their content type.

use super::blocking;
use super::problem::Problem;
use super::query::Source;
use crate::limits::Limits;
use crate::plan::QueryFault;
use crate::scene::Files;
use crate::scene::{ModelOptions, NewScene};
use axum::body::Body;
use axum::extract::multipart::{Field, Multipart, MultipartError};
use axum::extract::{FromRequest, Request};
use axum::http::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use bytes::Bytes;
use http_body_util::{BodyExt, LengthLimitError, Limited};
use serde_json::Value;
use std::error::Error;
use std::time::Duration;

/// The name a bare OBJ is stored under.
const MODEL_FILE: &str = "model.obj";

/// Parts of a multipart body: each file of a large model with its textures, and then some.
const PARTS_MAX: usize = 4096;

/// How much of a body is taken, and for how long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Bytes.
    pub(super) limit: u64,
    /// From the first to the last byte.
    pub(super) time: Duration,
}

impl Bounds {
    /// The bounds of a body under `limits`.
    pub(super) fn new(limits: &Limits, time: Duration) -> Self {
        Self { limit: limits.body_bytes, time }
    }

    fn too_large(self, value: Option<u64>) -> Problem {
        Problem::too_large("the body's bytes", self.limit, value, Some("RASTERD_MAX_BODY_BYTES"))
    }

    fn too_slow(self) -> Problem {
        let detail = format!("the body took longer than {} s", self.time.as_secs_f64());
        Problem::new(StatusCode::REQUEST_TIMEOUT, detail)
    }
}

/// The whole body.
pub(super) async fn bytes(request: Request, bounds: Bounds) -> Result<Bytes, Problem> {
    let body = limited(request, bounds)?.into_body();
    let collected = tokio::time::timeout(bounds.time, body.collect()).await.map_err(|_| bounds.too_slow())?;
    Ok(collected.map_err(|error| broken(&error, bounds))?.to_bytes())
}

/// A merge patch, from `application/merge-patch+json` or `application/json`.
pub(super) async fn patch(request: Request, bounds: Bounds) -> Result<Value, Problem> {
    match media_type(request.headers()).as_deref() {
        Some("application/merge-patch+json" | "application/json") => {}
        given => {
            return Err(unsupported(given, "application/merge-patch+json or application/json"));
        }
    }
    let bytes = bytes(request, bounds).await?;
    blocking::run(move || json(&bytes)).await
}

/// A new scene, of the body or in place of one.
pub(super) async fn scene(request: Request, bounds: Bounds, source: Source) -> Result<NewScene, Problem> {
    match source {
        Source::Body(options) => sent(request, bounds, options).await,
        Source::Gallery(piece) => {
            let body = bytes(request, bounds).await?;
            if body.is_empty() { Ok(piece.to_scene()) } else { Err(from_beside_a_body(body.len())) }
        }
    }
}

fn from_beside_a_body(bytes: usize) -> Problem {
    let detail =
        format!("must come without a body, which has {bytes} bytes: a scene is made of one or the other");
    Problem::query(&[QueryFault::new("from", detail)])
}

/// A document, a multipart form of one with its files, or a bare OBJ.
async fn sent(request: Request, bounds: Bounds, options: ModelOptions) -> Result<NewScene, Problem> {
    let media_type = media_type(request.headers());
    match media_type.as_deref() {
        Some("multipart/form-data") => {
            let form = tokio::time::timeout(bounds.time, multipart(request, bounds));
            let (document, files) = form.await.map_err(|_| bounds.too_slow())??;
            let document = blocking::run(move || document.map(|bytes| json(&bytes)).transpose()).await?;
            Ok(NewScene { document, files: Some(files), options })
        }
        Some("application/json") => {
            let bytes = bytes(request, bounds).await?;
            let document = blocking::run(move || json(&bytes)).await?;
            Ok(NewScene { document: Some(document), files: None, options })
        }
        None
        | Some(
            "model/obj" | "text/plain" | "application/octet-stream" | "application/x-www-form-urlencoded",
        ) => {
            let bytes = bytes(request, bounds).await?;
            blocking::run(move || sniffed(bytes, options)).await
        }
        given => Err(unsupported(given, "application/json, multipart/form-data or model/obj")),
    }
}

/// A body of no telling type: a document if it starts with `{`, else an OBJ.
///
/// # Errors
/// 400 for an empty body and for broken JSON.
pub fn sniffed(bytes: Bytes, options: ModelOptions) -> Result<NewScene, Problem> {
    let text = without_bom(&bytes).trim_ascii_start();
    let document = match text.first() {
        None => {
            return Err(Problem::bad_request("the body is empty; it must be a scene document or an OBJ"));
        }
        Some(b'{') => Some(json(&bytes)?),
        Some(_) => None,
    };
    let files = match document {
        Some(_) => None,
        None => Some(lone_model(bytes)?),
    };
    Ok(NewScene { document, files, options })
}

fn lone_model(bytes: Bytes) -> Result<Files, Problem> {
    let mut files = Files::default();
    files.insert(MODEL_FILE, bytes).map_err(Problem::bad_request)?;
    Ok(files)
}

/// JSON text → value.
///
/// # Errors
/// 400 with line and column; also for a number that no f64 holds and for nesting beyond 128 levels.
pub fn json(bytes: &[u8]) -> Result<Value, Problem> {
    serde_json::from_slice(without_bom(bytes))
        .map_err(|error| Problem::bad_request(format!("not JSON: {error}")))
}

/// Editors on Windows write a byte order mark in front.
fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The media type without its parameters, in lower case.
fn media_type(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(CONTENT_TYPE)?.to_str().unwrap_or_default();
    Some(value.split(';').next().unwrap_or_default().trim().to_ascii_lowercase())
}

fn unsupported(given: Option<&str>, wanted: &str) -> Problem {
    let given = given.unwrap_or("nothing");
    Problem::new(
        StatusCode::UNSUPPORTED_MEDIA_TYPE,
        format!("the body must be {wanted}, Content-Type says {given}"),
    )
}

/// The part named `scene`, if there is one, and all files by their names.
async fn multipart(request: Request, bounds: Bounds) -> Result<(Option<Bytes>, Files), Problem> {
    let request = limited(request, bounds)?;
    let mut form = Multipart::from_request(request, &())
        .await
        .map_err(|rejection| Problem::bad_request(format!("broken multipart: {rejection}")))?;
    let (mut document, mut files) = (None, Files::default());
    for _ in 0..PARTS_MAX {
        let Some(field) = form.next_field().await.map_err(|error| broken_part(&error, bounds))? else {
            return if document.is_none() && files.iter().next().is_none() {
                Err(Problem::bad_request("the form has neither a part named scene nor a file"))
            } else {
                Ok((document, files))
            };
        };
        take_part(field, &mut document, &mut files, bounds).await?;
    }
    Err(Problem::too_large("the parts of the form", PARTS_MAX as u64, None, None))
}

async fn take_part(
    field: Field<'_>,
    document: &mut Option<Bytes>,
    files: &mut Files,
    bounds: Bounds,
) -> Result<(), Problem> {
    let name = field.name().unwrap_or_default().to_owned();
    let file_name = field.file_name().map(|path| Files::reduce(path).to_owned());
    let bytes = field.bytes().await.map_err(|error| broken_part(&error, bounds))?;
    match file_name {
        _ if name == "scene" => match document.replace(bytes) {
            None => Ok(()),
            Some(_) => Err(Problem::bad_request("two parts are named scene")),
        },
        Some(file_name) if file_name.is_empty() => {
            Err(Problem::bad_request(format!("the file of part {name:?} has no name")))
        }
        Some(file_name) if files.iter().any(|(known, _)| known == file_name) => {
            Err(Problem::bad_request(format!("two files are named {file_name:?}")))
        }
        Some(file_name) => files.insert(&file_name, bytes).map_err(Problem::bad_request),
        None => Err(Problem::bad_request(format!("part {name:?} is neither named scene nor a file"))),
    }
}

/// The request with a body that ends in an error beyond the limit; one that announces more is refused
/// before any of it is read.
fn limited(request: Request, bounds: Bounds) -> Result<Request, Problem> {
    refuse_encoded(request.headers())?;
    let announced = request.headers().get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok());
    if let Some(value) = announced.filter(|value| *value > bounds.limit) {
        return Err(bounds.too_large(Some(value)));
    }
    let limit = usize::try_from(bounds.limit).unwrap_or(usize::MAX);
    Ok(request.map(|body| Body::new(Limited::new(body, limit))))
}

/// A compressed body would be read as if it were what is packed in it.
fn refuse_encoded(headers: &HeaderMap) -> Result<(), Problem> {
    let lines = headers.get_all(CONTENT_ENCODING).into_iter().map(|line| line.to_str().unwrap_or("?"));
    let mut codings =
        lines.flat_map(|line| line.split(',')).map(str::trim).filter(|coding| !coding.is_empty());
    match codings.find(|coding| !coding.eq_ignore_ascii_case("identity")) {
        None => Ok(()),
        Some(coding) => Err(Problem::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            format!("the body must come as it is, Content-Encoding says {coding}"),
        )),
    }
}

fn broken(error: &(dyn Error + 'static), bounds: Bounds) -> Problem {
    if is_over_limit(error) {
        bounds.too_large(None)
    } else {
        Problem::bad_request(format!("the body broke off: {error}"))
    }
}

fn broken_part(error: &MultipartError, bounds: Bounds) -> Problem {
    if is_over_limit(error) {
        bounds.too_large(None)
    } else {
        Problem::bad_request(format!("broken multipart: {}", error.body_text()))
    }
}

fn is_over_limit(error: &(dyn Error + 'static)) -> bool {
    error.is::<LengthLimitError>() || error.source().is_some_and(is_over_limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::UpAxis;

    const OPTIONS: ModelOptions = ModelOptions { up: UpAxis::Y, floor: true };

    #[test]
    fn broken_json_names_line_and_column() {
        let problem = json(b"{\n  \"a\": ]\n}").unwrap_err();
        assert_eq!(problem.status, 400);
        assert!(problem.detail.contains("line 2 column 8"), "{}", problem.detail);
    }

    #[test]
    fn a_number_that_no_f64_holds_is_not_json() {
        assert_eq!(json(b"[1e999]").unwrap_err().status, 400);
    }

    #[test]
    fn deep_nesting_is_refused_without_a_crash() {
        assert_eq!(json("[".repeat(100_000).as_bytes()).unwrap_err().status, 400);
    }

    #[test]
    fn a_brace_tells_a_document_from_an_obj() {
        let of = |text: &'static str| sniffed(Bytes::from_static(text.as_bytes()), OPTIONS);
        assert!(of(" \r\n{}").expect("a document").document.is_some());
        assert!(of("\u{feff}{}").expect("a document").document.is_some());
        // A document alone leaves a scene its files.
        assert!(of("{}").expect("a document").files.is_none());
        let model = of("v 0 0 0\n").expect("an OBJ");
        assert!(model.document.is_none() && model.files.expect("files").find(MODEL_FILE).is_some());
        assert_eq!(of(" \n").unwrap_err().status, 400);
    }
}
