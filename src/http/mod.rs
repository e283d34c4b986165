//! The service: requests in, replies out. Everything that knows HTTP is here, and only here.
//!
//! A request passes `observe` (id, log line, error bodies), the panic catcher and `guard`, then
//! its handler; the handlers are grouped by noun and listed in [`router`]. Heavy work leaves the
//! async workers through `blocking` or [`crate::jobs`].

mod accept;
mod archive;
mod blocking;
mod body;
mod connection;
mod etag;
mod files;
mod frames;
mod gallery;
mod guard;
mod instances;
mod link;
mod metrics;
mod observe;
mod openapi;
mod page;
mod patience;
mod pick;
mod plan;
mod problem;
mod query;
mod render_once;
mod reports;
mod reticent;
mod scenes;
pub mod serve;
mod service;
mod streams;
mod turntables;

pub use body::{json, sniffed};
pub use problem::Problem;

use crate::jobs::{Renderer, Reports, Streams};
use crate::scene::store::{Entry, Store};
use crate::settings::Settings;
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::response::IntoResponse;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tower_http::catch_panic::CatchPanicLayer;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// What every handler can reach. Cheap to clone.
#[derive(Clone, Debug)]
pub struct App {
    /// The scenes.
    pub store: Arc<Store>,
    /// Draws frames.
    pub renderer: Renderer,
    /// Draw again and again.
    pub streams: Streams,
    /// Measure error against run time.
    pub reports: Reports,
    /// As the server was started.
    pub settings: Arc<Settings>,
    ready: Arc<AtomicBool>,
}

impl App {
    /// A service over `renderer` with no scenes yet.
    #[must_use]
    pub fn new(settings: Settings, renderer: Renderer) -> Self {
        Self {
            store: Arc::new(Store::new(settings.limits())),
            streams: Streams::new(renderer.clone()),
            reports: Reports::new(renderer.clone()),
            renderer,
            settings: Arc::new(settings),
            ready: Arc::new(AtomicBool::new(true)),
        }
    }

    /// From now on `/readyz` says no and no new frame is taken; streams end, frames under way are finished.
    pub fn close(&self) {
        self.ready.store(false, Ordering::Relaxed);
        self.streams.close();
        self.reports.close();
        self.renderer.queue().close();
    }

    fn is_ready(&self) -> bool {
        self.ready.load(Ordering::Relaxed)
    }

    fn entry(&self, id: &str) -> Result<Entry, Problem> {
        self.store.get(id).ok_or_else(|| Problem::no_scene(id))
    }

    fn body_bounds(&self) -> body::Bounds {
        body::Bounds::new(self.renderer.limits(), self.settings.body_seconds)
    }
}

/// Every route of the service.
pub fn router(app: App) -> Router {
    let (routes, api) = OpenApiRouter::with_openapi(openapi::head())
        .routes(routes!(scenes::list, scenes::create))
        .routes(routes!(scenes::read, scenes::replace, scenes::patch, scenes::remove))
        .routes(routes!(files::list))
        .routes(routes!(files::read, files::replace, files::remove))
        .routes(routes!(frames::read, frames::of_changed))
        .routes(routes!(archive::read, archive::of_changed))
        .routes(routes!(turntables::read))
        .routes(routes!(streams::watch))
        .routes(routes!(streams::events))
        .routes(routes!(pick::read))
        .routes(routes!(plan::read))
        .routes(routes!(reports::read))
        .routes(routes!(instances::list))
        .routes(routes!(render_once::draw))
        .routes(routes!(gallery::list))
        .routes(routes!(gallery::picture))
        .routes(routes!(page::index))
        .routes(routes!(service::healthz))
        .routes(routes!(service::readyz))
        .routes(routes!(service::version))
        .routes(routes!(metrics::read))
        .split_for_parts();

    routes
        .route("/openapi.json", openapi::route(api))
        .merge(page::parts())
        .layer(from_fn_with_state(app.clone(), guard::check))
        .layer(CatchPanicLayer::custom(|_| Problem::internal().into_response()))
        .layer(from_fn_with_state(app.clone(), observe::observe))
        .layer(DefaultBodyLimit::disable()) // body.rs has the limit, and words for it
        .with_state(app)
}
