//! `/scenes/{id}/stream.mjpg` and `/events`: the scene as it changes and moves.
//!
//! Both are bodies without an end, fed by a [`Watcher`]. A picture is given when the connection has taken the
//! one before; what a slow client has missed by then it never sees.

use super::link::Link;
use super::problem::Problem;
use super::query::Pairs;
use super::{App, accept, frames, openapi};
use crate::jobs::{JobError, News, Picture, StreamRequest, Watcher};
use crate::plan::request::Query;
use crate::report::Progress;
use axum::Extension;
use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderName, HeaderValue};
use axum::response::{IntoResponse, Response};
use futures_util::{StreamExt, stream};
use serde_json::{Map, Value, json};
use std::convert::Infallible;
use std::sync::Arc;
use tokio::sync::watch::Receiver;

/// No quotes and no dashes: not every client reads those.
const MULTIPART: &str = "multipart/x-mixed-replace; boundary=frame";

const EVENT_STREAM: &str = "text/event-stream";

/// nginx holds back what it reads ahead of a slow client, 32 MB in seven seconds; this keeps it from that.
const NO_BUFFERING: (HeaderName, HeaderValue) =
    (HeaderName::from_static("x-accel-buffering"), HeaderValue::from_static("no"));

const NO_STORE: (HeaderName, HeaderValue) = (CACHE_CONTROL, HeaderValue::from_static("no-store"));

/// Watch the scene
///
/// The first picture is the scene as it is now; another follows when the scene changes or moves, at most
/// `fps` a second, and an unchanged one after a second. Who reads slowly misses pictures, and never sees old
/// ones. Each holds its number, the scene's revision and its time in a JPEG comment:
/// `rasterd frame=7 revision=2 t=12.5`. A budget is settled anew when the scene changes and when a report has
/// measured; `Render-Settings` is that of the first picture. Removing the scene ends the stream.
#[utoipa::path(
    get, path = "/scenes/{id}/stream.mjpg", tag = "streams",
    params(("id" = String, Path, description = "The scene"), openapi::StreamQuery, openapi::FramingQuery, openapi::FrameQuery),
    responses((status = 200, description = "Pictures without end", content_type = "multipart/x-mixed-replace", body = Vec<u8>, headers(("Render-Settings" = String), ("Content-Location" = String)))),
)]
pub(super) async fn watch(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
    link: Option<Extension<Link>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let names_images = accept::names(&headers, "image");
    if !names_images {
        accept::check(&headers, "multipart/x-mixed-replace")?;
    }
    let (framing, request) = pairs.read(|query| (Framing::read(query), StreamRequest::read(query)))?;
    let framing = framing.unwrap_or(if names_images { Framing::Advance } else { Framing::Length });
    let versions = app.store.watch(&id).ok_or_else(|| Problem::no_scene(&id))?;
    let (watcher, first) = begin(&app, &id, app.streams.watch(versions, request)).await?;
    let choice = first.choice;
    let mut before = None;
    let mut send = move |watcher: &Watcher, picture: &Picture| {
        watcher.count_sent(picture, before);
        before = Some(picture.number);
        framing.part(&picture.jpeg)
    };
    let mut opening = vec![Bytes::from_static(framing.opening())];
    opening.extend(send(&watcher, &first));
    let say = move |watcher: &Watcher, word: Word| match word {
        Word::News(News { picture: Some(picture), .. }) => send(watcher, &picture),
        Word::News(_) | Word::Report(_) => Vec::new(),
    };
    let mut response = reply(MULTIPART, body(watcher, link, opening, None, say));
    if let Some(choice) = choice {
        frames::add_settings(&mut response, &choice, &pairs);
    }
    Ok(response)
}

/// What the stream of the same query shows
///
/// Server-sent events. `frame`: one for each picture that the stream shows, repeated ones too, with what it
/// cost and how many pictures the last second saw. `problem`: a picture could not be made; others will be
/// tried. `report`: how far a report on the scene is, `{"stage", "done"}`. A listener keeps the stream alive like one who watches it.
#[utoipa::path(
    get, path = "/scenes/{id}/events", tag = "streams",
    params(("id" = String, Path, description = "The scene"), openapi::StreamQuery, openapi::FrameQuery),
    responses((status = 200, description = "Events without end; the data of each `frame` has this shape, that of a `problem` the shape of errors", content_type = "text/event-stream", body = FrameEvent)),
)]
pub(super) async fn events(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
    link: Option<Extension<Link>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    accept::check(&headers, EVENT_STREAM)?;
    let request = pairs.read(StreamRequest::read)?;
    let versions = app.store.watch(&id).ok_or_else(|| Problem::no_scene(&id))?;
    let (watcher, first) = begin(&app, &id, app.streams.listen(versions, request)).await?;
    let opening = vec![frame_event(&watcher, &first)];
    let say = move |watcher: &Watcher, word: Word| match word {
        Word::News(News { failure: Some(failure), .. }) => {
            vec![event("problem", &Problem::from(failure).to_json(None))]
        }
        Word::News(News { picture, .. }) => {
            picture.iter().map(|picture| frame_event(watcher, picture)).collect()
        }
        Word::Report((name, progress)) if name == id => vec![event("report", &json!(progress))],
        Word::Report(_) => Vec::new(),
    };
    Ok(reply(EVENT_STREAM, body(watcher, link, opening, Some(app.reports.news()), say)))
}

/// How far the report under way is, with the name of its scene.
type Measuring = (String, Progress);

/// What an endless body can tell of.
enum Word {
    News(News),
    Report(Measuring),
}

/// Waits for what is told next; `None` when the stream has ended.
async fn next_word(watcher: &mut Watcher, reports: Option<&mut Receiver<Option<Measuring>>>) -> Option<Word> {
    let report = async {
        let Some(reports) = reports else { return std::future::pending().await };
        match reports.changed().await {
            Ok(()) => reports.borrow_and_update().clone(),
            Err(_) => std::future::pending().await,
        }
    };
    tokio::select! {
        news = watcher.next() => news.map(Word::News),
        Some(report) = report => Some(Word::Report(report)),
    }
}

/// How the pictures lie one behind the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Framing {
    /// The next part's head right after each picture: browsers show one when they see what follows it. There
    /// is no length in it, since the next picture is not made yet.
    Advance,
    /// Each picture with its length in front, and the boundary right after it.
    Length,
}

impl Framing {
    /// `framing`; without it, it is the client that tells.
    fn read(query: &mut Query) -> Option<Self> {
        query.one_of("framing", &[("advance", Self::Advance), ("length", Self::Length)])
    }

    /// What stands before the first picture's part.
    fn opening(self) -> &'static [u8] {
        match self {
            Self::Advance => b"--frame\r\nContent-Type: image/jpeg\r\n\r\n",
            Self::Length => b"--frame\r\n",
        }
    }

    /// A picture, with all that can be said when it is there.
    fn part(self, jpeg: &Bytes) -> Vec<Bytes> {
        match self {
            Self::Advance => {
                vec![jpeg.clone(), Bytes::from_static(b"\r\n--frame\r\nContent-Type: image/jpeg\r\n\r\n")]
            }
            Self::Length => {
                let head = format!("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
                vec![head.into(), jpeg.clone(), Bytes::from_static(b"\r\n--frame\r\n")]
            }
        }
    }
}

/// Waits for the first picture of a stream of the scene `id`.
async fn begin(app: &App, id: &str, mut watcher: Watcher) -> Result<(Watcher, Arc<Picture>), Problem> {
    let deadline = app.settings.frame_seconds;
    let first = tokio::time::timeout(deadline, watcher.first()).await;
    match first.unwrap_or(Err(JobError::Deadline(deadline))) {
        Ok(picture) => Ok((watcher, picture)),
        // It may have been removed meanwhile.
        Err(failure) => Err(app.entry(id).err().unwrap_or_else(|| failure.into())),
    }
}

/// `opening`, and then what `say` makes of the news, of reports too where it is told of them, until the stream ends.
fn body<S>(
    watcher: Watcher,
    link: Option<Extension<Link>>,
    opening: Vec<Bytes>,
    reports: Option<Receiver<Option<Measuring>>>,
    say: S,
) -> Body
where
    S: FnMut(&Watcher, Word) -> Vec<Bytes> + Send + 'static,
{
    let drained = link.map(|Extension(link)| link.begin_live());
    let state = (watcher, drained, reports, say);
    let rest = stream::unfold(state, |(mut watcher, mut drained, mut reports, mut say)| async move {
        if let Some(drained) = &mut drained {
            tokio::select! {
                () = drained.wait() => {}
                () = watcher.ended() => return None,
            }
        }
        let word = next_word(&mut watcher, reports.as_mut()).await?;
        let said = say(&watcher, word);
        Some((said, (watcher, drained, reports, say)))
    });
    let all = stream::once(std::future::ready(opening)).chain(rest);
    Body::from_stream(all.flat_map(|said| stream::iter(said.into_iter().map(Ok::<_, Infallible>))))
}

fn reply(content_type: &'static str, body: Body) -> Response {
    let headers = [(CONTENT_TYPE, HeaderValue::from_static(content_type)), NO_STORE, NO_BUFFERING];
    (headers, body).into_response()
}

/// What `event: frame` says of a picture.
#[derive(Debug, serde::Serialize, utoipa::ToSchema)]
pub(super) struct FrameEvent {
    /// Counts from 1, as long as the stream is watched; also in the picture's comment
    number: u64,
    /// Of the scene
    revision: u64,
    /// Seconds: the `t` of a single frame that is the same picture
    t: f64,
    /// Pictures made in the last second
    fps: usize,
    /// Who sees the same pictures; listeners are not counted
    watchers: usize,
    /// Pixels in a row
    width: u32,
    /// Rows
    height: u32,
    /// Of the picture's file
    bytes: usize,
    /// By the names of `Server-Timing`
    #[schema(value_type = BTreeMap<String, f64>)]
    milliseconds: Map<String, Value>,
    /// By the names of `Render-Stats`
    #[schema(value_type = BTreeMap<String, u64>)]
    counts: Map<String, Value>,
    /// The settings that the stream's budget became, as `Render-Settings` says them; absent without a budget
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<String>,
    /// Work that was done, by its units; what was none is absent
    #[schema(value_type = BTreeMap<String, u64>)]
    work: Map<String, Value>,
    /// Work that elisions spared, by their names, in the units that the plan names
    #[schema(value_type = BTreeMap<String, u64>)]
    spared: Map<String, Value>,
}

impl FrameEvent {
    fn of(watcher: &Watcher, picture: &Picture) -> Self {
        Self {
            number: picture.number,
            revision: picture.revision,
            t: picture.t,
            fps: watcher.fps(),
            watchers: watcher.watchers(),
            width: picture.size[0],
            height: picture.size[1],
            bytes: picture.jpeg.len(),
            milliseconds: members(picture.timings.iter().map(|(pass, ms)| (*pass, (ms * 1e3).round() / 1e3))),
            counts: members(picture.stats.iter().copied()),
            settings: picture.choice.as_ref().map(frames::settings),
            work: members(picture.tally.work()),
            spared: members(picture.tally.savings()),
        }
    }
}

/// An object whose members keep their order.
fn members<T: Into<Value>>(entries: impl Iterator<Item = (&'static str, T)>) -> Map<String, Value> {
    entries.map(|(name, value)| (name.to_owned(), value.into())).collect()
}

fn frame_event(watcher: &Watcher, picture: &Picture) -> Bytes {
    event("frame", &json!(FrameEvent::of(watcher, picture)))
}

/// One event; JSON has no line breaks of its own.
fn event(name: &str, data: &Value) -> Bytes {
    format!("event: {name}\ndata: {data}\n\n").into()
}
