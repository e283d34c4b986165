//! Which instances throw a shadow on anything.

use super::{Notes, Rays};
use crate::math::Bounds;
use crate::model::Mesh;
use crate::model::normals::face_normal;
use crate::plan::{AlphaTest, Item, Reason, Slot, number, opacity};
use crate::scene::{Cull, Instance, Scene};
use glam::DVec3;

/// Every visible instance as lights see it, all of them alike.
pub(in crate::plan) struct Participants(Vec<Participant>);

struct Participant {
    caster: Caster,
    /// Why it throws no shadow whatever the light; `None`: it may throw one.
    casts_none: Option<Reason>,
    /// Whether shadows fall on it.
    receives: bool,
    /// Whether one part of it throws a shadow on another.
    shades_itself: bool,
    /// Around all others on which shadows fall.
    others: Option<Bounds>,
}

/// What is drawn into a map.
pub(super) struct Caster {
    /// Index into the scene's instances.
    pub(super) instance: u32,
    /// Its slots say what of it casts, from all of its faces; their draws count in `tests`.
    pub(super) item: Item,
    /// What decides on the slots that are cut out.
    pub(super) tests: Vec<AlphaTest>,
}

impl Caster {
    fn new(scene: &Scene, index: usize, instance: &Instance, t: f64) -> Self {
        let mut tests = Vec::new();
        let slots = instance.materials.iter().map(|&material| {
            let transparency = opacity::of_solid(&scene.materials[material as usize])?;
            let slot = Slot { draw: number(tests.len()), cull: Cull::None, opacity: transparency.opacity() };
            tests.extend(transparency.into_test());
            Some(slot)
        });
        let slots = slots.collect();
        Self { instance: number(index), item: Item::new(scene, instance, t, slots), tests }
    }
}

impl Participants {
    /// Places every visible instance as it is at time `t` (seconds).
    pub(in crate::plan) fn of(scene: &Scene, t: f64) -> Self {
        let mut is_hollow = vec![None; scene.meshes.len()];
        let participant = |(index, instance): (usize, &Instance)| {
            let caster = Caster::new(scene, index, instance, t);
            let is_clear = caster.item.slots.iter().all(Option::is_none);
            let casts_none = if instance.casts_shadow {
                is_clear.then_some(Reason::Clear)
            } else {
                Some(Reason::CastsNone)
            };
            let receives = instance.receives_shadow;
            let mut shades_itself = || {
                let known: &mut Option<bool> = &mut is_hollow[instance.mesh as usize];
                *known.get_or_insert_with(|| can_shade_itself(&caster.item.mesh))
            };
            let shades_itself = casts_none.is_none() && receives && shades_itself();
            Participant { caster, casts_none, receives, shades_itself, others: None }
        };
        let mut all = Self(scene.visible().map(participant).collect());
        all.find_others();
        all
    }

    /// Fills in `others`.
    fn find_others(&mut self) {
        let join = |a: Option<Bounds>, b: Option<Bounds>| match (a, b) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        let own = |p: &Participant| p.caster.item.bounds().filter(|_| p.receives);
        let boxes: Vec<Option<Bounds>> = self.0.iter().map(own).collect();
        // Around all receivers behind each participant in the list; those before it are added on the way.
        let mut after = None;
        for (p, own) in self.0.iter_mut().zip(&boxes).rev() {
            p.others = after;
            after = join(*own, after);
        }
        let mut before = None;
        for (p, own) in self.0.iter_mut().zip(&boxes) {
            p.others = join(before, p.others);
            before = join(before, *own);
        }
    }

    /// Those on which shadows fall.
    pub(super) fn receivers(&self) -> Vec<&Item> {
        self.0.iter().filter(|p| p.receives).map(|p| &p.caster.item).collect()
    }

    /// Those that throw a shadow on anything; the others are noted.
    pub(super) fn casters(&self, rays: Rays, notes: &mut Notes) -> Vec<&Caster> {
        let mut casters = Vec::with_capacity(self.0.len());
        for Participant { caster, casts_none, shades_itself, others, .. } in &self.0 {
            let shades_others = || others.is_some_and(|others| can_shade(&caster.item, others, rays));
            match casts_none {
                None if *shades_itself || shades_others() => casters.push(caster),
                reason => notes.leave_out_caster(caster.instance, reason.unwrap_or(Reason::ShadesNothing)),
            }
        }
        casters
    }
}

/// Whether anything in the box `others` can lie behind the item: no side of its own box that faces
/// the light has all of them before it. So a floor shades nothing that stands on it.
fn can_shade(item: &Item, others: Bounds, rays: Rays) -> bool {
    let Some(own) = item.mesh.bounds else { return false };
    let [low, high] = [own.min, own.max].map(|corner| item.linear * corner + item.origin);
    let normals = item.world_from_normal();
    (0..3).all(|axis| {
        let normal = normals.col(axis);
        let Some(towards) = side_that_faces_the_light(normal, [low, high], rays) else { return true };
        let (corner, behind) = if towards { (high, -normal) } else { (low, normal) };
        let reach = (others.max - others.min).length() * normal.length();
        others.corners().iter().any(|p| (*p - corner).dot(behind) > reach * 1e-9)
    })
}

/// Which of the two sides of a slab across `normal`, through the corners `low` and `high`, faces the
/// light: the high one (`true`), the low one, or none: edge on a side hides nothing from parallel
/// rays, and a point may lie between the two.
fn side_that_faces_the_light(normal: DVec3, [low, high]: [DVec3; 2], rays: Rays) -> Option<bool> {
    match rays {
        Rays::Parallel(direction) => {
            let along = normal.dot(direction);
            (along != 0.0).then_some(along < 0.0)
        }
        Rays::FromPoint(position) if (position - high).dot(normal) > 0.0 => Some(true),
        Rays::FromPoint(position) => ((position - low).dot(normal) < 0.0).then_some(false),
    }
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
