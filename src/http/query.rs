//! The query string of a call, as pairs; each handler says which names it knows.

use super::problem::Problem;
use crate::plan::FrameRequest;
use crate::plan::request::{Budget, Query};
use crate::scene::gallery::{self, Piece};
use crate::scene::{ModelOptions, UpAxis};
use axum::extract::FromRequestParts;
use axum::http::Method;
use axum::http::request::Parts;

/// The decoded pairs of the query string, and the method and the path in front of it.
#[derive(Debug)]
pub(super) struct Pairs {
    method: Method,
    path: String,
    pairs: Vec<(String, String)>,
}

impl Pairs {
    /// Reads what `read` knows; anything else, and all that is wrong with it, is a 422.
    pub(super) fn read<T>(&self, read: impl FnOnce(&mut Query) -> T) -> Result<T, Problem> {
        let mut query = Query::new(self.pairs.iter().map(|(name, value)| (name.as_str(), value.as_str())));
        let value = read(&mut query);
        query.finish().map_err(|faults| Problem::query(&faults))?;
        Ok(value)
    }

    /// Where a GET finds the same with settings in place of a budget: path and query. What a body has a part in is
    /// found nowhere, and to name a place would be to say that it is (RFC 9110, section 8.7).
    pub(super) fn location(&self, settings: &[(&'static str, String)]) -> Option<String> {
        if ![Method::GET, Method::HEAD].contains(&self.method) {
            return None;
        }
        let is_own = |name: &str| {
            !Budget::PARAMETERS.contains(&name) && !settings.iter().any(|(setting, _)| *setting == name)
        };
        let own = self.pairs.iter().filter(|(name, _)| is_own(name));
        let own = own.map(|(name, value)| (name.as_str(), value.as_str()));
        let settings = settings.iter().map(|(name, value)| (*name, value.as_str()));
        let query =
            form_urlencoded::Serializer::new(String::new()).extend_pairs(own.chain(settings)).finish();
        Some(format!("{}?{query}", self.path))
    }

    /// The frame query and nothing else.
    pub(super) fn frame(&self) -> Result<FrameRequest, Problem> {
        self.read(FrameRequest::read)
    }
}

impl<S: Sync> FromRequestParts<S> for Pairs {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        axum::extract::Query::try_from_uri(&parts.uri)
            .map(|axum::extract::Query(pairs)| Self {
                method: parts.method.clone(),
                path: parts.uri.path().to_owned(),
                pairs,
            })
            .map_err(|_| Problem::bad_request("the query string does not decode"))
    }
}

/// Refuses any query: what a call without parameters takes in [`Pairs`]' place.
#[derive(Debug)]
pub(super) struct NoQuery;

impl<S: Sync> FromRequestParts<S> for NoQuery {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        Pairs::from_request_parts(parts, state).await?.read(|_| Self)
    }
}

/// What a new scene is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// The body; a model in it as these say.
    Body(ModelOptions),
    /// The gallery; there is no body then.
    Gallery(&'static Piece),
}

/// `from=NAME`, or else `up=y|z` and `floor=true|false`.
pub(super) fn source(query: &mut Query) -> Source {
    let piece = query.parsed("from", gallery::find);
    let up = query.one_of("up", &[("y", UpAxis::Y), ("z", UpAxis::Z)]);
    let floor = query.flag("floor");
    let Some(piece) = piece else {
        return Source::Body(ModelOptions { up: up.unwrap_or(UpAxis::Y), floor: floor.unwrap_or(true) });
    };
    for (name, is_given) in [("up", up.is_some()), ("floor", floor.is_some())] {
        if is_given {
            query.fault(name, "says how to make a scene of a model; what comes from the gallery is a scene");
        }
    }
    Source::Gallery(piece)
}
