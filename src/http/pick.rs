//! `/scenes/{id}/pick`: what is at a pixel.

use super::problem::Problem;
use super::query::Pairs;
use super::{App, openapi};
use crate::pipeline::Hit;
use crate::plan::FrameRequest;
use crate::plan::request::Query;
use crate::scene::Scene;
use axum::Json;
use axum::extract::{Path, State};

/// What is at a pixel; all `null` for the background.
#[derive(Default, serde::Serialize, utoipa::ToSchema)]
pub(super) struct Pick {
    /// Name in the document
    instance: Option<String>,
    /// Name in the document
    mesh: Option<String>,
    /// Index in the mesh
    triangle: Option<u64>,
    /// Distance along the viewing axis
    depth: Option<f64>,
    /// In world space
    position: Option<[f64; 3]>,
}

/// What is at a pixel
///
/// Of the frame that the same query gives; everything is null for the background.
#[utoipa::path(
    get, path = "/scenes/{id}/pick", tag = "frames",
    params(
        ("id" = String, Path, description = "The scene"),
        ("x" = u32, Query, description = "Pixels from the left, from 0"),
        ("y" = u32, Query, description = "Pixels from the top, from 0"),
        openapi::FrameQuery,
    ),
    responses((status = 200, description = "What is there", body = Pick)),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
) -> Result<Json<Pick>, Problem> {
    let (x, y, request) =
        pairs.read(|query| (coordinate(query, "x"), coordinate(query, "y"), FrameRequest::read(query)))?;
    let scene = app.entry(&id)?.scene;
    let hit = app.renderer.pick(scene.clone(), request, x, y).await?;
    Ok(Json(hit.map_or_else(Pick::default, |hit| describe(&hit, &scene))))
}

/// A hit in the words of the document.
fn describe(hit: &Hit, scene: &Scene) -> Pick {
    let instance = &scene.instances[hit.instance as usize];
    Pick {
        instance: Some(instance.name.clone()),
        mesh: Some(scene.mesh_names[instance.mesh as usize].clone()),
        triangle: Some(hit.triangle.into()),
        depth: Some(hit.depth),
        position: Some(hit.position.to_array()),
    }
}

/// A coordinate that must be there. A fault is noted in `query`, so the 0 in its place is never used.
fn coordinate(query: &mut Query, name: &'static str) -> u32 {
    if query.text(name).is_none() {
        query.fault(name, "is missing");
    }
    query.integer_in(name, 0..=u32::MAX).unwrap_or(0)
}
