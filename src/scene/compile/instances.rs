//! Instances: transforms, material slots, exact bounds.

use super::keeps_boxes;
use super::surfaces::Surfaces;
use crate::limits::MAX_MEASURED_VERTICES;
use crate::math::Bounds;
use crate::math::angle::rotation_xyz_deg;
use crate::model::Mesh;
use crate::model::normals::unit;
use crate::scene::assets::NamedMesh;
use crate::scene::document::InstancePart;
use crate::scene::{Document, Instance, Spin};
use glam::{DMat3, DVec3};

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
