//! From a checked document and its files to the scene that frames are drawn from.
//!
//! In: a [`Document`], [`Files`], and the assets of the scene before, if there was one. Out: a
//! [`Scene`] in anchored space that shares every mesh and texture that did not change, or every
//! reason why there is none.

mod backgrounds;
mod instances;
mod lights;
mod surfaces;

use super::assets::{Assets, Loader};
use super::{
    Camera, Document, Fault, Files, Instance, RenderDefaults, Scene, Warning, framing, limits_check,
};
use crate::limits::{Limits, MAX_COORDINATE};
use crate::math::Bounds;
use crate::scene::document::{self, CameraPart, Faults, RenderPart, token};
use glam::{DMat3, DVec3};
use serde_json::Value;
use std::collections::HashSet;
use surfaces::Surfaces;

/// Why a document and its files make no scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// The document makes no sense (422). Never empty.
    #[error("the scene document has {} faults", .0.len())]
    Document(Vec<Fault>),
    /// A file cannot be read (400).
    #[error("{file}{}: {detail}", .line.map(|line| format!(", line {line}")).unwrap_or_default())]
    Unreadable {
        /// Its name.
        file: String,
        /// Line in it, from 1, where it has lines.
        line: Option<u64>,
        /// What is wrong.
        detail: String,
    },
    /// Something is over its limit (413).
    #[error("{what}: {value} is over the limit of {limit}")]
    TooLarge {
        /// What has the limit.
        what: String,
        /// The limit.
        limit: u64,
        /// The value that is over it.
        value: u64,
        /// The setting that moves the limit; `None` where it is fixed.
        setting: Option<&'static str>,
    },
}

/// A scene, and what the next version of it can share.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The scene.
    pub scene: Scene,
    /// Meshes, textures and backgrounds by what they were made of.
    pub assets: Assets,
}

/// Compiles `document`. Meshes and textures are taken from `previous` where what they are made of
/// is the same.
///
/// # Errors
/// [`SceneError`]; all faults of the document at once.
pub fn compile(
    document: &Document,
    files: &Files,
    previous: Option<&Assets>,
    limits: &Limits,
) -> Result<Compiled, SceneError> {
    check_files(document, files)?;
    limits_check::check(document, limits)?;
    let mut loader = Loader::new(files, previous, limits);
    let meshes = loader.meshes(document)?;
    let surfaces = Surfaces::compile(document, &meshes, &mut loader)?;
    let mut instances = instances::compile(document, &meshes, &surfaces);
    let tangents = instances::tangents(&instances, &meshes, &surfaces, &mut loader)?;
    let backgrounds = backgrounds::compile(document, &mut loader)?;
    let (assets, mut warnings) = loader.finish();

    let anchor = anchor(document, &instances, &meshes);
    for instance in &mut instances {
        instance.translation -= anchor;
    }
    instances::measure(&mut instances, &meshes);
    let scene = Scene {
        anchor,
        camera: camera(document, anchor),
        ambient: document.environment.ambient.to_linear(),
        background: backgrounds.chosen,
        backgrounds: backgrounds.named,
        lights: lights::compile(document, anchor),
        tangents,
        mesh_names: meshes.iter().map(|loaded| loaded.name.clone()).collect(),
        meshes: meshes.into_iter().map(|loaded| loaded.mesh).collect(),
        materials: surfaces.materials,
        material_names: surfaces.names,
        instances,
        post: document.post.clone(),
        render: render_defaults(&document.render),
        warnings: Vec::new(),
        content: content(document, &assets),
    };
    check_reach(&scene)?;
    warnings.extend(surfaces.warnings);
    warnings.extend(camera_warnings(&document.camera));
    let warnings = without_repeats(warnings);
    Ok(Compiled { scene: Scene { warnings, ..scene }, assets })
}

/// Refuses models whose files are missing, all at once.
fn check_files(document: &Document, files: &Files) -> Result<(), SceneError> {
    let faults = Faults::default();
    document::check_files(document, files, &faults);
    let faults = faults.into_vec();
    if faults.is_empty() { Ok(()) } else { Err(SceneError::Document(faults)) }
}

/// A hash of everything that pictures of the scene are made from: all but its name.
fn content(document: &Document, assets: &Assets) -> [u8; 32] {
    let mut hash = blake3::Hasher::new();
    let mut json = document.to_json();
    json["name"] = Value::Null;
    hash.update(json.to_string().as_bytes());
    for (name, bytes) in assets.file_hashes() {
        hash.update(&(name.len() as u64).to_le_bytes());
        hash.update(name.as_bytes());
        hash.update(bytes);
    }
    *hash.finalize().as_bytes()
}

/// Each warning once, where it came first: several meshes may share a file.
fn without_repeats(warnings: Vec<Warning>) -> Vec<Warning> {
    let mut seen = HashSet::new();
    warnings.into_iter().filter(|warning| seen.insert(warning.clone())).collect()
}

/// The zero of anchored space: where the first visible instance is, else the camera.
///
/// The mesh's own offset is rounded to a power of two as large as the mesh, so that the anchor is
/// as exact as the document's numbers: a scene moved by an offset that keeps them exact has the
/// same anchored numbers to the bit, however the mesh is turned.
fn anchor(document: &Document, instances: &[Instance], meshes: &[super::assets::NamedMesh]) -> DVec3 {
    let first = instances.iter().find(|instance| instance.visible);
    match first {
        Some(instance) => {
            let mesh = &meshes[instance.mesh as usize].mesh;
            let linear = instance.linear(0.0);
            let size =
                mesh.bounds.map_or(0.0, |bounds| longest_side(bounds.transformed(linear, DVec3::ZERO)));
            instance.translation + rounded(linear * mesh.origin, size)
        }
        None => document.camera.position.unwrap_or(DVec3::ZERO),
    }
}

fn longest_side(bounds: Bounds) -> f64 {
    (bounds.max - bounds.min).max_element()
}

/// `offset` rounded to multiples of a power of two that is at least `size`.
fn rounded(offset: DVec3, size: f64) -> DVec3 {
    if size == 0.0 {
        return offset;
    }
    let (_, exponent) = libm::frexp(size);
    let step = libm::ldexp(1.0, exponent);
    (offset / step + DVec3::splat(0.5)).floor() * step
}

fn camera(document: &Document, anchor: DVec3) -> Camera {
    let camera = &document.camera;
    Camera {
        position: camera.position.map(|position| position - anchor),
        target: camera.target.map(|target| target - anchor),
        up: camera.up,
        lens: camera.lens(),
        near: camera.near,
        far: camera.far,
        orbit_deg_per_s: camera.orbit_deg_per_s,
    }
}

fn render_defaults(part: &RenderPart) -> RenderDefaults {
    let side = |n: u64| u32::try_from(n).expect("invariant: checked against the limits");
    RenderDefaults {
        width: side(part.width),
        height: side(part.height),
        samples: part.samples,
        shadows: part.shadows,
        shading: part.shading,
        cull: part.cull,
    }
}

/// Refuses instances that reach beyond what clipping can take, through scale or translation.
fn check_reach(scene: &Scene) -> Result<(), SceneError> {
    let beyond = |bounds: Bounds| {
        let reach = bounds.translated(scene.anchor);
        reach.min.abs().max(reach.max.abs()).max_element() > MAX_COORDINATE
    };
    let faults: Vec<_> = scene
        .instances
        .iter()
        .filter(|instance| instance.bounds(scene.mesh(instance), 0.0).is_some_and(beyond))
        .map(|instance| Fault {
            pointer: format!("/instances/{}", token(&instance.name)),
            detail: format!("must not reach beyond ±{MAX_COORDINATE:e}"),
        })
        .collect();
    if faults.is_empty() { Ok(()) } else { Err(SceneError::Document(faults)) }
}

fn camera_warnings(camera: &CameraPart) -> impl Iterator<Item = Warning> {
    let looks_along_up = camera
        .position
        .zip(camera.target)
        .is_some_and(|(position, target)| framing::is_parallel(target - position, camera.up));
    let has_two_lenses = camera.fov_y_deg.is_some() && camera.ortho_height.is_some();
    let warnings = [
        (looks_along_up, "camera: up is parallel to the direction of view; another axis is used instead"),
        (has_two_lenses, "camera: orthographic and fov_y_deg are both given; orthographic is used"),
    ];
    let held = warnings.into_iter().filter(|(holds, _)| *holds);
    held.map(|(_, detail)| Warning { file: None, line: None, detail: detail.to_owned() })
}

/// Rows of a rotation by quarter turns hold one ±1 each, so that boxes stay boxes.
fn keeps_boxes(linear: DMat3) -> bool {
    linear.to_cols_array_2d().iter().all(|column| column.iter().filter(|&&entry| entry != 0.0).count() <= 1)
}
