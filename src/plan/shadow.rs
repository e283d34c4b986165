//! Fitting a shadow map: to the casters that can shade something, never to the camera.

use super::{AlphaTest, Item, ItemTest, Slot, number, opacity};
use crate::math::{Bounds, Projection, View};
use crate::model::Mesh;
use crate::model::normals::face_normal;
use crate::scene::{Cull, Instance, Scene, Shadow, ShadowCull};
use glam::DVec3;

/// One shadow map to draw.
#[derive(Clone, Debug)]
pub struct ShadowPass {
    /// The light as a viewer: orthographic, along the light.
    pub view: View,
    /// What casts. Draws of its slots count in `tests`.
    pub items: Vec<Item>,
    /// What decides on the triangles of slots that are cut out.
    pub tests: Vec<CasterTest>,
    /// Multiple of the normal offset that is just enough.
    pub bias: f64,
}

/// Two unit vectors that make a right-handed basis with the unit vector `n`, without a special case.
///
/// Source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
#[must_use]
pub fn orthonormal_basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// The alpha test of one slot of a caster.
#[derive(Clone, Debug)]
pub struct CasterTest {
    /// Index into [`ShadowPass::items`].
    pub item: u32,
    /// Which of its fragments cast.
    pub test: AlphaTest,
}

impl ShadowPass {
    /// The test of the triangles of `draw`.
    #[must_use]
    pub fn test(&self, draw: u32) -> ItemTest<'_> {
        let caster = &self.tests[draw as usize];
        ItemTest { item: &self.items[caster.item as usize], test: &caster.test }
    }

    /// Takes in a caster.
    fn push(&mut self, caster: &Participant) {
        let mut item = caster.item.clone();
        let first = number(self.tests.len());
        item.slots.iter_mut().flatten().for_each(|slot| slot.draw += first);
        let number = number(self.items.len());
        self.tests.extend(caster.tests.iter().map(|test| CasterTest { item: number, test: test.clone() }));
        self.items.push(item);
    }

    /// Working memory that drawing it takes.
    #[must_use]
    pub fn frame_bytes(&self) -> u64 {
        let items: u64 = self.items.iter().map(Item::frame_bytes).sum();
        items.saturating_add(u64::from(self.view.width).pow(2) * 4)
    }
}

/// The map of one light at time `t`; `None` if nothing can cast on anything.
#[must_use]
pub fn plan(scene: &Scene, t: f64, direction: DVec3, shadow: &Shadow) -> Option<ShadowPass> {
    let cull = match shadow.cull {
        ShadowCull::None => Cull::None,
        ShadowCull::Front => Cull::Front,
        ShadowCull::Back => Cull::Back,
    };
    let all: Vec<Participant> =
        scene.visible().map(|(_, instance)| Participant::new(scene, instance, t, cull)).collect();
    let casters = casters(&all, direction);
    let receivers: Vec<&Item> = all.iter().filter(|p| p.receives).map(|p| &p.item).collect();
    let cast: Vec<&Item> = casters.iter().map(|p| &p.item).collect();
    let view = fit(direction, &cast, &receivers, shadow.resolution)?;
    let mut pass = ShadowPass { view, items: Vec::new(), tests: Vec::new(), bias: shadow.bias };
    casters.into_iter().for_each(|caster| pass.push(caster));
    Some(pass)
}

/// An instance as a light sees it.
struct Participant {
    /// What is drawn into the map. Draws of its slots count in `tests`.
    item: Item,
    /// What decides on its slots that are cut out.
    tests: Vec<AlphaTest>,
    /// Whether it throws shadows.
    casts: bool,
    /// Whether shadows fall on it.
    receives: bool,
}

impl Participant {
    fn new(scene: &Scene, instance: &Instance, t: f64, cull: Cull) -> Self {
        let mut tests = Vec::new();
        let slots = instance.materials.iter().map(|&material| {
            let transparency = opacity::of_solid(&scene.materials[material as usize])?;
            let slot = Slot { draw: number(tests.len()), cull, opacity: transparency.opacity() };
            tests.extend(transparency.into_test());
            Some(slot)
        });
        let slots: Vec<_> = slots.collect();
        let casts = instance.casts_shadow && slots.iter().any(Option::is_some);
        let item = Item::new(scene, instance, t, slots);
        Self { item, tests, casts, receives: instance.receives_shadow }
    }
}

/// Those of `all` that throw a shadow on anything, along `direction`.
fn casters(all: &[Participant], direction: DVec3) -> Vec<&Participant> {
    let boxes: Vec<Option<Bounds>> = all.iter().map(|p| p.item.bounds().filter(|_| p.receives)).collect();
    let join = |a: Option<Bounds>, b: Option<Bounds>| match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(b),
    };
    // Around all receivers behind each participant in the list; those before it are added on the way.
    let mut after = vec![None; all.len() + 1];
    for i in (0..all.len()).rev() {
        after[i] = join(after[i + 1], boxes[i]);
    }
    let mut before = None;
    let mut found = Vec::new();
    for (i, p) in all.iter().enumerate() {
        let others = join(before, after[i + 1]);
        let shades = others.is_some_and(|others| can_shade(&p.item, others, direction));
        // Light that falls through the holes of a hull meets its inside.
        let is_hollow = !p.tests.is_empty() || can_shade_itself(&p.item.mesh);
        if p.casts && (shades || (p.receives && is_hollow)) {
            found.push(p);
        }
        before = join(before, boxes[i]);
    }
    found
}

/// Whether anything in the box `others` can lie behind the item: no side of its own box that faces
/// the light has all of them before it. So a floor shades nothing that stands on it.
fn can_shade(item: &Item, others: Bounds, direction: DVec3) -> bool {
    let Some(own) = item.mesh.bounds else { return false };
    let normals = item.world_from_normal();
    (0..3).all(|axis| {
        let normal = normals.col(axis);
        let along = normal.dot(direction);
        // From the side that faces the light, along the light; edge on, a side hides nothing.
        let (corner, behind) = if along < 0.0 { (own.max, -normal) } else { (own.min, normal) };
        let corner = item.linear * corner + item.origin;
        let reach = (others.max - others.min).length() * normal.length();
        along == 0.0 || others.corners().iter().any(|p| (*p - corner).dot(behind) > reach * 1e-9)
    })
}

/// Whether a part of a mesh can shade another: not if it is convex.
fn can_shade_itself(mesh: &Mesh) -> bool {
    // Told for simple meshes alone: slabs, boxes, wedges. Others are taken to be hollow.
    const SIMPLE: usize = 48;
    mesh.triangles.len() > SIMPLE || !is_convex(mesh)
}

/// Whether all vertices lie on or behind the plane of every triangle.
fn is_convex(mesh: &Mesh) -> bool {
    let size = mesh.bounds.map_or(0.0, |bounds| (bounds.max - bounds.min).length());
    mesh.triangles.iter().all(|corners| {
        let [a, b, c] = corners.map(|v| mesh.position(v));
        let normal = face_normal(&[a, b, c], [0, 1, 2]).unwrap_or(DVec3::ZERO);
        mesh.triangles.as_flattened().iter().all(|&v| (mesh.position(v) - a).dot(normal) <= size * 1e-9)
    })
}

/// A view along `direction` that holds all casters and, sideways, no more than receivers can ask for.
/// `None` if no caster can shade a receiver.
fn fit(direction: DVec3, casters: &[&Item], receivers: &[&Item], resolution: u32) -> Option<View> {
    let (right, up) = orthonormal_basis(direction);
    // A viewer's right × up points backwards, to where the light comes from.
    let right = -right;
    let extent = |items: &[&Item]| {
        items.iter().filter_map(|item| extent_along(item, [right, up, direction])).reduce(Bounds::union)
    };
    let (cast, receive) = (extent(casters)?, extent(receivers)?);
    let mut min = cast.min.max(DVec3::new(receive.min.x, receive.min.y, cast.min.z));
    let mut max = cast.max.min(DVec3::new(receive.max.x, receive.max.y, cast.max.z));
    if max.cmplt(min).any() {
        return None;
    }
    // Never thinner than a millionth of the casters: no division by nothing, no needle-shaped texels.
    // The receivers do not count here: a huge floor must not make small casters vanish in a texel.
    let least = ((cast.max - cast.min).max_element() * 1e-6).max(f64::MIN_POSITIVE * 1e16);
    let grow = (DVec3::splat(least) - (max - min)).max(DVec3::ZERO) * 0.5;
    (min, max) = (min - grow, max + grow);
    // A texel of margin on each side; 1 % of the depth range behind, so that no caster has depth 0.
    let texels = f64::from(resolution.max(1));
    let size = max - min;
    let margin = DVec3::new(size.x / texels, size.y / texels, size.z * 0.01);
    (min, max) = (min - margin, max + margin);
    let size = max - min;
    let centre = (min + max) * 0.5;
    Some(View {
        eye: right * centre.x + up * centre.y + direction * min.z,
        right,
        up,
        forward: direction,
        projection: Projection::Orthographic,
        scale: [texels * 256.0 / size.x, texels * 256.0 / size.y],
        near: 0.0,
        far: size.z,
        width: resolution,
        height: resolution,
    })
}

/// Bounds of an item along three axes, from the corners of its box.
fn extent_along(item: &Item, axes: [DVec3; 3]) -> Option<Bounds> {
    let corners = item.mesh.bounds?.corners().map(|p| item.linear * p + item.origin);
    Bounds::around(corners.map(|p| DVec3::from_array(axes.map(|axis| p.dot(axis)))))
}
