//! The summary of a scene that the API answers with.

use super::store::Entry;
use crate::math::Bounds;
use serde_json::{Value, json};

/// `{"id", "name", "revision", "counts", "bytes", "bounds", "framed_bounds", "warnings", "links"}`.
pub(super) fn of(entry: &Entry) -> Value {
    let scene = &*entry.scene;
    let triangles: usize = scene.visible().map(|(_, instance)| scene.mesh(instance).triangles.len()).sum();
    let vertices: usize = scene.meshes.iter().map(|mesh| mesh.vertex_count()).sum();
    let named = entry.document["textures"].as_object().map_or(0, serde_json::Map::len);
    let textures = named + entry.textures_of_files();
    let path = format!("/scenes/{}", entry.id);
    let world = |bounds: Bounds| {
        let bounds = bounds.translated(scene.anchor);
        json!({ "min": bounds.min.to_array(), "max": bounds.max.to_array() })
    };
    json!({
        "id": entry.id,
        "name": entry.document["name"],
        "revision": entry.revision,
        "counts": {
            "instances": scene.instances.len(),
            "meshes": scene.meshes.len(),
            "triangles": triangles,
            "vertices": vertices,
            // The default material is always there and nobody's.
            "materials": scene.materials.len() - 1,
            "textures": textures,
            "lights": scene.lights.len(),
        },
        "bytes": entry.bytes,
        "bounds": scene.bounds(0.0).map(&world),
        // What automatic framing looks at, for those who go on from there.
        "framed_bounds": scene.framed_bounds().map(&world),
        "warnings": scene.warnings,
        "links": {
            "self": path,
            "frame": format!("{path}/frame.png"),
            "stream": format!("{path}/stream.mjpg"),
            "plan": format!("{path}/plan"),
            "instances": format!("{path}/instances"),
            "report": format!("{path}/report.html"),
        },
    })
}
