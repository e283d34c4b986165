//! A document for OBJ files that came without one: every file as an instance, and around it what
//! makes a good first picture.

use super::document::{Color, Fault, InstancePart, MaterialPart, MeshPart, names};
use super::{Assets, Compiled, Document, Files, SceneError, compile};
use crate::limits::Limits;
use crate::math::Bounds;
use glam::DVec3;

/// Which axis of a model file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As in the world.
    #[default]
    Y,
    /// As in much of CAD: the model is turned by −90° about x.
    Z,
}

/// How to make a document of model files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelOptions {
    /// Which axis of the files points up.
    pub up: UpAxis,
    /// Whether the models stand on a floor.
    pub floor: bool,
}

impl Default for ModelOptions {
    fn default() -> Self {
        Self { up: UpAxis::Y, floor: true }
    }
}

/// Side of the floor in units of the model's longest side: its edges are so far off that the horizon
/// looks level.
const FLOOR_SIZE: f64 = 64.0;
/// How far below the model the floor lies, in the same unit: what is flat on the ground would else
/// have the floor's own depth.
const FLOOR_GAP: f64 = 1e-4;

/// Makes a document of every OBJ among `files` and compiles it.
///
/// # Errors
/// As [`compile()`]; also if there is no OBJ.
pub(super) fn build(
    files: &Files,
    options: ModelOptions,
    previous: Option<&Assets>,
    limits: &Limits,
) -> Result<(Document, Compiled), SceneError> {
    let mut document = models(files, options.up)?;
    let compiled = compile(&document, files, previous, limits)?;
    let bounds = compiled.scene.bounds(0.0).map(|bounds| bounds.translated(compiled.scene.anchor));
    match bounds {
        Some(bounds) if options.floor => {
            stand_on_floor(&mut document, bounds);
            let compiled = compile(&document, files, Some(&compiled.assets), limits)?;
            Ok((document, compiled))
        }
        _ => Ok((document, compiled)),
    }
}

/// Every OBJ as one instance, under a sky, in a sun with its shadow, framed automatically.
fn models(files: &Files, up: UpAxis) -> Result<Document, SceneError> {
    let mut document = Document::default();
    // A model alone has little around it that would brighten its shadows.
    document.environment.ambient = Color::from_linear([0.16, 0.18, 0.21]);
    let rotation_deg = match up {
        UpAxis::Y => DVec3::ZERO,
        UpAxis::Z => DVec3::new(-90.0, 0.0, 0.0),
    };
    for (file, _) in files.iter().filter(|(file, _)| is_obj(file)) {
        let name = unused_name(&document, names::cleaned(stem(file)));
        if document.name.is_empty() {
            document.name.clone_from(&name);
        }
        document.meshes.insert(name.clone(), MeshPart::Obj { file: file.to_owned() });
        let instance = InstancePart { rotation_deg, ..InstancePart::of(&name) };
        document.instances.insert(name, instance);
    }
    if document.meshes.is_empty() {
        let detail = "neither a scene document nor an OBJ file came with the request".to_owned();
        return Err(SceneError::Document(vec![Fault { pointer: String::new(), detail }]));
    }
    Ok(document)
}

/// Adds a floor under `bounds`, at which automatic framing does not look.
fn stand_on_floor(document: &mut Document, bounds: Bounds) {
    let longest = (bounds.max - bounds.min).max_element();
    let longest = if longest > 0.0 { longest } else { 1.0 };
    let side = FLOOR_SIZE * longest;
    let name = unused_name(document, "floor".to_owned());
    let centre = bounds.centre();
    let floor = InstancePart {
        material: Some(name.clone()),
        translation: DVec3::new(centre.x, bounds.min.y - FLOOR_GAP * longest, centre.z),
        casts_shadow: false,
        framed: false,
        ..InstancePart::of(&name)
    };
    document.meshes.insert(name.clone(), MeshPart::Plane { size: [side; 2], uv_repeat: [1.0; 2] });
    let grey = MaterialPart { diffuse: Color::grey(0.6), ..MaterialPart::default() };
    document.materials.insert(name.clone(), grey);
    document.instances.insert(name, floor);
}

fn is_obj(file: &str) -> bool {
    file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("obj"))
}

fn stem(file: &str) -> &str {
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

/// `name`, or with a number behind it where it is taken. The search begins where the number is
/// likely free, so that thousands of like names take no longer than others.
fn unused_name(document: &Document, name: String) -> String {
    let is_taken =
        |name: &str| document.instances.contains_key(name) || document.materials.contains_key(name);
    if !is_taken(&name) {
        return name;
    }
    let numbered = (document.instances.len() + 1..).map(|n| format!("{name}-{n}"));
    numbered.into_iter().find(|name| !is_taken(name)).expect("invariant: fewer files than numbers")
}
