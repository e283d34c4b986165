//! Instances: transforms, material slots, exact bounds.

use super::surfaces::Surfaces;
use super::{SceneError, keeps_boxes};
use crate::limits::MAX_MEASURED_VERTICES;
use crate::math::Bounds;
use crate::math::angle::rotation_xyz_deg;
use crate::model::normals::unit;
use crate::model::{Mesh, Tangents};
use crate::scene::assets::{Loader, NamedMesh};
use crate::scene::document::InstancePart;
use crate::scene::{Document, Instance, Spin};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Every instance in order of name, in world space; [`measure`] fills in `extent`.
pub(super) fn compile(document: &Document, meshes: &[NamedMesh], surfaces: &Surfaces) -> Vec<Instance> {
    let model_scale = document.render.model_scale;
    let place = |(name, part): (&String, &InstancePart)| {
        let mesh = meshes.binary_search_by(|loaded| loaded.name.as_str().cmp(&part.mesh)).ok()?;
        Some(Instance {
            name: name.clone(),
            mesh: u32::try_from(mesh).ok()?,
            materials: surfaces.slots(part.material.as_deref(), mesh, &meshes[mesh].mesh),
            translation: part.translation * model_scale,
            rotation: rotation_xyz_deg(part.rotation_deg),
            scale: part.scale.to_vector() * model_scale,
            spin: part.spin.map(turning),
            visible: part.visible,
            framed: part.framed,
            casts_shadow: part.casts_shadow,
            receives_shadow: part.receives_shadow,
            extent: None,
        })
    };
    document.instances.iter().filter_map(place).collect()
}

/// For each mesh its tangents, if an instance that is drawn has a relief on it.
pub(super) fn tangents(
    instances: &[Instance],
    meshes: &[NamedMesh],
    surfaces: &Surfaces,
    loader: &mut Loader,
) -> Result<Vec<Option<Arc<Tangents>>>, SceneError> {
    let mut tangents = vec![None; meshes.len()];
    for instance in instances.iter().filter(|instance| instance.visible) {
        let mesh = instance.mesh as usize;
        let has_relief = |&slot: &u32| surfaces.materials[slot as usize].has_relief();
        if tangents[mesh].is_none() && instance.materials.iter().any(has_relief) {
            tangents[mesh] = loader.tangents(&meshes[mesh].mesh)?;
        }
    }
    Ok(tangents)
}

/// With a unit axis; documents have none that is zero.
fn turning(spin: Spin) -> Spin {
    Spin { axis: unit(spin.axis).unwrap_or(DVec3::Y), ..spin }
}

/// Fills in the exact bounds of instances that are turned by other than quarter turns.
pub(super) fn measure(instances: &mut [Instance], meshes: &[NamedMesh]) {
    let mut left = MAX_MEASURED_VERTICES;
    for instance in instances {
        let mesh = &meshes[instance.mesh as usize].mesh;
        let linear = instance.linear(0.0);
        if !keeps_boxes(linear) && mesh.vertex_count() <= left {
            left -= mesh.vertex_count();
            instance.extent = exact_extent(mesh, linear);
        }
    }
}

fn exact_extent(mesh: &Mesh, linear: DMat3) -> Option<Bounds> {
    let [x, y, z] = &mesh.positions;
    let points = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| linear * DVec3::new(x, y, z));
    Bounds::around(points)
}
