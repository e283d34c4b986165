//! Every error of the service → `application/problem+json` (RFC 9457). The only such place.

use crate::encode::Unfit;
use crate::jobs::JobError;
use crate::plan::{PlanError, QueryFault};
use crate::scene::Fault;
use crate::scene::{SceneError, StoreError};
use axum::body::Body;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, RETRY_AFTER};
use axum::http::{HeaderValue, Method, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

/// Seconds after which a refused client may ask again: about a frame's time.
const RETRY_SECONDS: HeaderValue = HeaderValue::from_static("1");

const PROBLEM_JSON: HeaderValue = HeaderValue::from_static("application/problem+json");

/// An error on its way to a client.
///
/// It travels as a response without a body; `complete` writes the body once the request's id is at
/// hand. The command line prints the same text.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The HTTP status.
    pub status: StatusCode,
    /// What is wrong, for a person.
    pub detail: String,
    /// For a document or a query: each fault by itself.
    pub errors: Vec<Value>,
}

impl Problem {
    /// A problem of one sentence.
    pub fn new(status: StatusCode, detail: impl Into<String>) -> Self {
        Self { status, detail: detail.into(), errors: Vec::new() }
    }

    /// 400.
    pub fn bad_request(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, detail)
    }

    /// 404 for a scene.
    pub fn no_scene(id: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, format!("there is no scene {id:?}"))
    }

    /// 413: names what is too large, its limit and the setting that moves it.
    pub fn too_large(what: &str, limit: u64, value: Option<u64>, setting: Option<&str>) -> Self {
        let value = value.map_or_else(|| "is more".to_owned(), |value| format!("is {value}"));
        let setting = setting
            .map_or_else(|| "a fixed limit".to_owned(), |setting| format!("a limit that {setting} moves"));
        Self::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            format!("{what} must be at most {limit} ({setting}), {value}"),
        )
    }

    /// 422 for a query.
    pub fn query(faults: &[QueryFault]) -> Self {
        Self::faulty("the query makes no sense", faults)
    }

    /// 422 for a document.
    pub fn document(faults: &[Fault]) -> Self {
        Self::faulty("the scene document makes no sense", faults)
    }

    /// 500.
    pub fn internal() -> Self {
        Self::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "a fault of the server; its log has it under the request id",
        )
    }

    fn faulty<T: serde::Serialize>(what: &str, faults: &[T]) -> Self {
        let errors: Vec<Value> = faults.iter().map(|fault| json!(fault)).collect();
        let detail = match errors.as_slice() {
            [only] => format!("{what}: {}", one_line(only)),
            _ => format!("{what}: {} faults", errors.len()),
        };
        Self { errors, ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, detail) }
    }

    /// The body's JSON; `request_id` only where there is a request.
    #[must_use]
    pub fn to_json(&self, request_id: Option<&str>) -> Value {
        let mut body = json!({
            "type": "about:blank",
            "title": self.status.canonical_reason().unwrap_or("Error"),
            "status": self.status.as_u16(),
            "detail": self.detail,
        });
        if let Some(id) = request_id {
            body["request_id"] = json!(id);
        }
        if !self.errors.is_empty() {
            body["errors"] = json!(self.errors);
        }
        body
    }
}

/// `/camera/fov_y_deg: must lie in …`; what is about the whole has no place in front.
fn one_line(fault: &Value) -> String {
    let text = |key: &str| fault.get(key).and_then(Value::as_str).unwrap_or_default();
    let place = [text("pointer"), text("parameter")].concat();
    if place.is_empty() { text("detail").to_owned() } else { format!("{place}: {}", text("detail")) }
}

/// As standard error shows it: the detail, and each fault on a line of its own.
impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.detail)?;
        if self.errors.len() > 1 {
            self.errors.iter().try_for_each(|fault| write!(f, "\n  {}", one_line(fault)))?;
        }
        Ok(())
    }
}

impl From<SceneError> for Problem {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Document(faults) => Self::document(&faults),
            SceneError::Unreadable { file, line, detail } => {
                let line = line.map_or_else(String::new, |line| format!(", line {line}"));
                Self::bad_request(format!("{file}{line}: {detail}"))
            }
            SceneError::TooLarge { what, limit, value, setting } => {
                Self::too_large(&what, limit, Some(value), setting)
            }
        }
    }
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::NotFound => Self::new(StatusCode::NOT_FOUND, "there is no such scene or file"),
            StoreError::PreconditionFailed => Self::new(StatusCode::PRECONDITION_FAILED, error.to_string()),
            StoreError::Full { limit, value } => Self::new(
                StatusCode::INSUFFICIENT_STORAGE,
                format!(
                    "all scenes together may take {limit} bytes (RASTERD_MAX_TOTAL_BYTES moves that), this would make {value}"
                ),
            ),
            StoreError::Scene(error) => error.into(),
        }
    }
}

impl From<PlanError> for Problem {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Query(faults) => Self::query(&faults),
            PlanError::TooLarge { what, limit, value, setting } => {
                Self::too_large(&what, limit, Some(value), setting)
            }
        }
    }
}

impl From<JobError> for Problem {
    fn from(error: JobError) -> Self {
        let detail = error.to_string();
        match error {
            JobError::Plan(error) => error.into(),
            JobError::Unfit(Unfit::Values { .. }) => Self::new(StatusCode::NOT_ACCEPTABLE, detail),
            JobError::Unfit(Unfit::Data { .. }) => Self::query(&[QueryFault::new("output", detail)]),
            JobError::Full(_) | JobError::FullOfReports(_) | JobError::Closing | JobError::Cancelled => {
                Self::new(StatusCode::SERVICE_UNAVAILABLE, detail)
            }
            JobError::Deadline(_) => Self::new(StatusCode::GATEWAY_TIMEOUT, detail),
            JobError::Panicked => Self::internal(),
        }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = self.status.into_response();
        if self.status == StatusCode::SERVICE_UNAVAILABLE {
            response.headers_mut().insert(RETRY_AFTER, RETRY_SECONDS);
        }
        response.extensions_mut().insert(self);
        response
    }
}

/// Writes the body of a [`Problem`]. axum's own refusals (no route, wrong method, an argument that
/// does not decode) come by without one and are given the words for their status.
pub(super) fn complete(response: Response, request_id: &str, method: &Method) -> Response {
    if !response.status().is_client_error() && !response.status().is_server_error() {
        return response;
    }
    let problem =
        response.extensions().get::<Problem>().cloned().unwrap_or_else(|| of_status(response.status()));
    let body = problem.to_json(Some(request_id)).to_string();
    let (mut head, _) = response.into_parts();
    head.headers.insert(CONTENT_TYPE, PROBLEM_JSON);
    head.headers.insert(CONTENT_LENGTH, HeaderValue::from(body.len()));
    // The router does this for its routes, but not where there is none.
    let body = if method == Method::HEAD { Body::empty() } else { Body::from(body) };
    Response::from_parts(head, body)
}

fn of_status(status: StatusCode) -> Problem {
    let detail = match status {
        StatusCode::NOT_FOUND => {
            "there is nothing under this path; /openapi.json lists what there is".to_owned()
        }
        StatusCode::METHOD_NOT_ALLOWED => {
            "this path does not take this method; Allow names those it takes".to_owned()
        }
        StatusCode::BAD_REQUEST => "the path does not decode to UTF-8".to_owned(),
        _ => status.canonical_reason().unwrap_or("the request failed").to_owned(),
    };
    Problem::new(status, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_fault_is_told_in_the_detail() {
        let problem = Problem::query(&[QueryFault::new("t", "must be a finite number, is \"x\"")]);
        assert_eq!(problem.detail, "the query makes no sense: t: must be a finite number, is \"x\"");
        assert_eq!(problem.to_json(None)["errors"][0]["parameter"], "t");
    }

    #[test]
    fn several_faults_are_told_line_by_line() {
        let fault = |pointer: &str| Fault { pointer: pointer.to_owned(), detail: "is wrong".to_owned() };
        let problem = Problem::document(&[fault("/a"), fault("/b")]);
        assert_eq!(
            problem.to_string(),
            "the scene document makes no sense: 2 faults\n  /a: is wrong\n  /b: is wrong"
        );
    }

    #[test]
    fn a_full_queue_says_when_to_come_back() {
        for error in [JobError::Full(3), JobError::FullOfReports(3)] {
            let response = Problem::from(error).into_response();
            assert_eq!(response.status(), 503);
            assert_eq!(response.headers()[RETRY_AFTER], "1");
        }
    }
}
