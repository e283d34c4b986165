//! A point of a surface and what it is made of.

use super::bvh::Hit;
use super::world::{Face, Placed};
use crate::model::normals::unit;
use crate::model::tangents::Frame;
use crate::model::{Material, Mesh};
use crate::scene::Instance;
use glam::{DVec2, DVec3};

/// A point of a surface. Directions are in world axes and those of the front.
pub struct Point<'a> {
    /// What it belongs to.
    pub instance: &'a Instance,
    /// What it is made of.
    pub material: &'a Material,
    /// Where it is, anchored.
    pub position: DVec3,
    /// Unit normal of its triangle.
    pub geometric: DVec3,
    /// Largest side of its triangle's box.
    pub extent: f64,
    /// Unit normal, between those of the corners.
    pub normal: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Whether the mesh has them.
    pub has_uvs: bool,
    /// The directions in which u and v grow; of about unit length, or zero.
    pub along: [DVec3; 2],
    /// Units of u and of v to a world unit along them.
    pub uv_per_world: DVec2,
    /// Vertex colour, linear RGB.
    pub color: DVec3,
}

/// Shared length below which corner normals are taken to cancel, squared.
const CANCELLED: f64 = 1e-12;

impl<'a> Point<'a> {
    /// The point that `hit` found on a face with these corners.
    pub fn new(placed: &'a Placed<'a>, face: &Face, hit: &Hit, corners: [DVec3; 3]) -> Self {
        let mesh = placed.mesh;
        let geometric = placed.front_normal(corners);
        let normal = mix(placed.corner_normals(face, geometric), hit.weights);
        let (along, uv_per_world) = frame(placed, face, hit);
        let [low, high] =
            [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])];
        Self {
            instance: placed.instance,
            material: placed.material(face),
            position: mix(corners, hit.weights),
            geometric,
            extent: (high - low).max_element(),
            normal: if normal.length_squared() < CANCELLED { geometric } else { normal.normalize() },
            uv: uv(mesh, face, hit),
            has_uvs: mesh.uvs.is_some(),
            along,
            uv_per_world,
            color: color(mesh, face, hit),
        }
    }
}

/// Texture coordinates of a hit; (0, 0) on a mesh without any.
pub fn uv(mesh: &Mesh, face: &Face, hit: &Hit) -> DVec2 {
    let Some(uvs) = &mesh.uvs else { return DVec2::ZERO };
    let [a, b, c] = mesh.triangles[face.triangle as usize].map(|vertex| uvs[vertex as usize]);
    a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2]
}

/// White on a mesh without vertex colours.
fn color(mesh: &Mesh, face: &Face, hit: &Hit) -> DVec3 {
    let Some(colors) = &mesh.colors else { return DVec3::ONE };
    mix(mesh.triangles[face.triangle as usize].map(|vertex| colors[vertex as usize].as_dvec3()), hit.weights)
}

/// How the texture lies on the surface: directions of u and v, and how much of them a world unit is.
fn frame(placed: &Placed, face: &Face, hit: &Hit) -> ([DVec3; 2], DVec2) {
    let frames = placed.tangents.map_or([Frame::default(); 3], |t| t.of_triangle(face.triangle));
    let world = frames.map(|f| [f.along_u, f.along_v].map(|along| placed.linear * along.as_dvec3()));
    let direction = |axis: usize| mix(world.map(|w| unit(w[axis]).unwrap_or(DVec3::ZERO)), hit.weights);
    let per_world = |axis: usize| {
        let inverse = world.map(|w| if w[axis] == DVec3::ZERO { 0.0 } else { 1.0 / w[axis].length() });
        (0..3).map(|corner| inverse[corner] * hit.weights[corner]).sum()
    };
    ([direction(0), direction(1)], DVec2::new(per_world(0), per_world(1)))
}

fn mix([a, b, c]: [DVec3; 3], weights: [f64; 3]) -> DVec3 {
    a * weights[0] + b * weights[1] + c * weights[2]
}
