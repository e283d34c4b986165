//! All triangles of a scene in their places, and what rays find among them.

use super::bvh::{self, Bvh, Hit, Ray};
use super::point::{self, Point};
use super::texture;
use crate::model::normals::unit;
use crate::model::{Material, Mesh, Tangents};
use crate::scene::{Cull, Instance, Scene, ShadowCull};
use glam::{DMat3, DVec2, DVec3};
use std::cmp::Reverse;

/// Every visible instance, placed.
pub struct World<'a> {
    scene: &'a Scene,
    placed: Vec<Placed<'a>>,
    /// In submission order, as the triangles of `bvh` are.
    faces: Vec<Face>,
    bvh: Bvh,
}

/// An instance in its place.
pub struct Placed<'a> {
    /// The instance.
    pub instance: &'a Instance,
    /// Its mesh.
    pub mesh: &'a Mesh,
    /// How texture coordinates lie on it, if that is known.
    pub tangents: Option<&'a Tangents>,
    /// Model to world axes.
    pub linear: DMat3,
    /// Where the mesh's stored zero is, anchored.
    origin: DVec3,
    /// Where a mirror turns fronts into backs, −1.
    handedness: f64,
    /// The material of each of the mesh's slots.
    materials: Vec<&'a Material>,
}

/// A triangle of a placed instance.
#[derive(Clone, Copy)]
pub struct Face {
    /// Index into the placed instances.
    placed: u32,
    /// Index in the mesh.
    pub triangle: u32,
    /// Index into the mesh's slots.
    slot: u32,
}

/// A surface that a line of sight meets.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// Where. Triangles are counted in submission order.
    pub hit: Hit,
    /// How much of it is there, over 0.
    pub alpha: f64,
}

/// Memory of a triangle: its corners, its place in the order and its share of the tree, in vectors that grew by
/// doubling and so are up to twice as large.
pub const TRIANGLE_BYTES: u64 =
    2 * (size_of::<[DVec3; 3]>() + size_of::<Face>()) as u64 + bvh::TRIANGLE_BYTES;

/// Distances that differ by no more than this part are equal: coplanar surfaces are, but for rounding.
const SAME: f64 = 1e-11;

/// The alpha from which on a surface without a cut-off casts a shadow.
const SOLID: f64 = 0.5;

impl<'a> World<'a> {
    /// Places every visible instance as it is at time `t` (seconds).
    pub fn new(scene: &'a Scene, t: f64) -> Self {
        let placed: Vec<Placed> = scene.visible().map(|(_, of)| Placed::new(scene, of, t)).collect();
        let (mut faces, mut triangles) = (Vec::new(), Vec::new());
        for (index, placed) in (0..).zip(&placed) {
            for (slot, triangle) in placed.triangles() {
                faces.push(Face { placed: index, triangle, slot });
                triangles.push(placed.corners(triangle));
            }
        }
        Self { scene, placed, faces, bvh: Bvh::new(triangles) }
    }

    /// The point of a hit.
    pub fn point(&self, hit: &Hit) -> Point<'_> {
        let (placed, face) = self.of(hit);
        Point::new(placed, face, hit, self.bvh.corners(hit.triangle))
    }

    fn of(&self, hit: &Hit) -> (&Placed<'a>, &Face) {
        let face = &self.faces[hit.triangle as usize];
        (&self.placed[face.placed as usize], face)
    }

    /// What a line of sight meets, nearest first, as far as the first surface that nothing shows through.
    /// Of two at one distance the one submitted first hides the other, or lies behind it if both are
    /// blended.
    pub fn see(&self, ray: &Ray, layers: &mut Vec<Layer>) {
        layers.clear();
        let mut solid: Option<Layer> = None;
        self.bvh.walk(ray, |hit| {
            match self.layer(ray, hit) {
                Some(layer) if layer.alpha < 1.0 => layers.push(layer),
                Some(layer) if solid.is_none_or(|solid| layer.hides(&solid)) => solid = Some(layer),
                _ => (),
            }
            solid.map_or(ray.farthest, |solid| ray.farthest.min(solid.hit.distance * (1.0 + SAME)))
        });
        layers.retain(|layer| solid.is_none_or(|solid| !solid.hides(layer)));
        layers.sort_unstable_by(|a, b| a.hit.distance.total_cmp(&b.hit.distance));
        for equal in layers.chunk_by_mut(|a, b| b.hit.distance <= a.hit.distance * (1.0 + SAME)) {
            equal.sort_unstable_by_key(|layer| Reverse(layer.hit.triangle));
        }
        layers.extend(solid);
    }

    /// What a line of sight sees of a hit, if anything.
    fn layer(&self, ray: &Ray, hit: Hit) -> Option<Layer> {
        let (placed, face) = self.of(&hit);
        let material = placed.material(face);
        let is_front = placed.front_normal(self.bvh.corners(hit.triangle)).dot(ray.direction) < 0.0;
        let is_culled = match self.scene.render.cull {
            Cull::Back => !is_front,
            Cull::Front => is_front,
            Cull::None => false,
        };
        if is_culled && !material.double_sided {
            return None;
        }
        let alpha = alpha(material, || point::uv(placed.mesh, face, &hit));
        match material.alpha_cutoff.map(f64::from) {
            Some(cutoff) => (alpha >= cutoff).then_some(Layer { hit, alpha: 1.0 }),
            None => (alpha > 0.0).then_some(Layer { hit, alpha }),
        }
    }

    /// Whether nothing that casts shadows lies on the way of a ray to a light. `cull` names the faces, as
    /// the light sees them, that cast none.
    pub fn is_lit(&self, ray: &Ray, cull: ShadowCull) -> bool {
        let mut is_lit = true;
        self.bvh.walk(ray, |hit| {
            is_lit &= !self.casts(ray, &hit, cull);
            if is_lit { ray.farthest } else { f64::NEG_INFINITY }
        });
        is_lit
    }

    fn casts(&self, ray: &Ray, hit: &Hit, cull: ShadowCull) -> bool {
        let (placed, face) = self.of(hit);
        let material = placed.material(face);
        // The ray runs towards the light.
        let is_front = || placed.front_normal(self.bvh.corners(hit.triangle)).dot(ray.direction) > 0.0;
        let is_culled = match cull {
            ShadowCull::None => false,
            ShadowCull::Front => is_front(),
            ShadowCull::Back => !is_front(),
        };
        let least = material.alpha_cutoff.map_or(SOLID, f64::from);
        placed.instance.casts_shadow
            && !is_culled
            && alpha(material, || point::uv(placed.mesh, face, hit)) >= least
    }

    /// Whether what two lines of sight see lies apart: on two instances, or across a silhouette or a
    /// crease of one. A surface that bends is one surface.
    pub fn are_apart(&self, a: &Hit, b: &Hit) -> bool {
        if a.triangle == b.triangle {
            return false;
        }
        if self.faces[a.triangle as usize].placed != self.faces[b.triangle as usize].placed {
            return true;
        }
        let (a, b) = (self.point(a), self.point(b));
        let between = b.position - a.position;
        let off_plane = between.dot(a.geometric).abs().min(between.dot(b.geometric).abs());
        a.normal.dot(b.normal) < BEND_COSINE || off_plane > BEND_SINE * between.length()
    }
}

/// The cosine and sine of 15°: what turns by less between two samples of a pixel is taken to be smooth.
const BEND_COSINE: f64 = 0.966;
const BEND_SINE: f64 = 0.259;

impl Layer {
    /// Whether it is seen in place of `other`, if nothing shows through it.
    fn hides(&self, other: &Self) -> bool {
        let (own, theirs) = (self.hit.distance, other.hit.distance);
        let is_level = own <= theirs * (1.0 + SAME) && theirs <= own * (1.0 + SAME);
        if is_level { self.hit.triangle < other.hit.triangle } else { own < theirs }
    }
}

/// `opacity · opacity_map · alpha of diffuse_map`; `uv` is asked only where a map is.
fn alpha(material: &Material, uv: impl Fn() -> DVec2) -> f64 {
    let mut alpha = f64::from(material.opacity);
    if let Some(map) = &material.opacity_map {
        alpha *= texture::color(map, uv()).x;
    }
    if let Some(map) = material.diffuse_map.as_ref().filter(|map| map.least[3] < u8::MAX) {
        alpha *= texture::color(map, uv()).w;
    }
    alpha
}

impl<'a> Placed<'a> {
    fn new(scene: &'a Scene, instance: &'a Instance, t: f64) -> Self {
        let (mesh, linear) = (scene.mesh(instance), instance.linear(t));
        Self {
            instance,
            mesh,
            tangents: scene.tangents(instance).map(|tangents| &**tangents),
            linear,
            origin: instance.origin(mesh, linear),
            handedness: if instance.is_mirrored() { -1.0 } else { 1.0 },
            materials: instance.materials.iter().map(|&index| &*scene.materials[index as usize]).collect(),
        }
    }

    /// Every triangle with its slot.
    fn triangles(&self) -> impl Iterator<Item = (u32, u32)> {
        let count = u32::try_from(self.mesh.triangles.len()).expect("invariant: counted in u32");
        let ends = self.mesh.parts.iter().skip(1).map(|next| next.first_triangle).chain([count]);
        let runs = self.mesh.parts.iter().zip(ends);
        runs.flat_map(|(part, end)| (part.first_triangle..end).map(|triangle| (part.slot, triangle)))
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let place = |vertex: u32| self.linear * self.mesh.position(vertex) + self.origin;
        self.mesh.triangles[triangle as usize].map(place)
    }

    /// What a face is made of.
    pub fn material(&self, face: &Face) -> &'a Material {
        self.materials[face.slot as usize]
    }

    /// Unit normal of a triangle with these corners, on the side of its front.
    pub fn front_normal(&self, [a, b, c]: [DVec3; 3]) -> DVec3 {
        unit((b - a).cross(c - a)).unwrap_or(DVec3::ZERO) * self.handedness
    }

    /// Unit normals of a face's corners; `geometric` where one has no direction.
    pub fn corner_normals(&self, face: &Face, geometric: DVec3) -> [DVec3; 3] {
        // The cofactors of the matrix, which its inverse transpose has but for a factor, and which a
        // matrix that flattens has too.
        let [x, y, z] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * self.handedness;
        self.mesh.triangles[face.triangle as usize].map(|vertex| {
            let normal = self.mesh.normals[vertex as usize].as_dvec3();
            unit(cofactors * normal).unwrap_or(geometric)
        })
    }
}
