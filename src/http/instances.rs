//! `/scenes/{id}/instances`: what stands where.

use super::App;
use super::problem::Problem;
use super::query::Pairs;
use crate::math::Bounds;
use crate::plan::request::Query;
use crate::scene::{Instance, Scene};
use axum::Json;
use axum::extract::{Path, State};
use glam::DVec3;
use serde::Serialize;
use utoipa::ToSchema;

/// An instance in its place.
#[derive(Serialize, ToSchema)]
pub(super) struct PlacedInstance {
    /// In the document
    name: String,
    /// Its value in a picture of instances
    id: usize,
    mesh: String,
    visible: bool,
    triangles: usize,
    /// Around it in world space; null for a mesh without triangles. Of an instance that spins, around its
    /// mesh's turned box
    bounds: Option<MinMax>,
    /// The same in the mesh's own space
    mesh_bounds: Option<MinMax>,
}

/// A box along the axes.
#[derive(Serialize, ToSchema)]
struct MinMax {
    min: [f64; 3],
    max: [f64; 3],
}

impl MinMax {
    fn of(bounds: Bounds, origin: DVec3) -> Self {
        let Bounds { min, max } = bounds.translated(origin);
        Self { min: min.to_array(), max: max.to_array() }
    }
}

/// List a scene's instances
///
/// In order of name, hidden ones too, each where it is at `t`.
#[utoipa::path(
    get, path = "/scenes/{id}/instances", tag = "scenes",
    params(("id" = String, Path, description = "The scene"), ("t" = Option<f64>, Query, description = "Seconds")),
    responses((status = 200, description = "Every instance", body = Vec<PlacedInstance>)),
)]
pub(super) async fn list(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
) -> Result<Json<Vec<PlacedInstance>>, Problem> {
    let t = pairs.read(|query: &mut Query| query.number("t"))?.unwrap_or(0.0);
    let scene = app.entry(&id)?.scene;
    let instances = scene.instances.iter().zip(1..);
    Ok(Json(instances.map(|(instance, id)| placed(&scene, instance, id, t)).collect()))
}

fn placed(scene: &Scene, instance: &Instance, id: usize, t: f64) -> PlacedInstance {
    let mesh = scene.mesh(instance);
    PlacedInstance {
        name: instance.name.clone(),
        id,
        mesh: scene.mesh_names[instance.mesh as usize].clone(),
        visible: instance.visible,
        triangles: mesh.triangles.len(),
        bounds: instance.bounds(mesh, t).map(|bounds| MinMax::of(bounds, scene.anchor)),
        mesh_bounds: mesh.bounds.map(|bounds| MinMax::of(bounds, mesh.origin)),
    }
}
