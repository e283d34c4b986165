//! Shadow maps to draw: fitted to the casters that can shade something, never to the camera.

mod casters;
mod cube;
mod directional;

pub(super) use casters::Participants;
pub use cube::WIDEST_TANGENT;

use super::{AlphaTest, Elision, Elisions, Item, ItemTest, LeftOut, Part, Reason, Slot, number};
use crate::math::View;
use crate::scene::{Cull, Shadow, ShadowCull, ShadowFilter};
use casters::Caster;
use glam::DVec3;
use std::collections::BTreeSet;

/// The shadow of one light: its maps, and how they are read.
#[derive(Clone, Debug)]
pub struct ShadowPass {
    /// What to draw.
    pub maps: Maps,
    /// How it is read.
    pub filter: Filter,
    /// Multiple of the normal offset that is just enough.
    pub bias: f64,
}

/// The maps of one light.
#[derive(Clone, Debug)]
pub enum Maps {
    /// Of parallel light, the way it travels.
    Directional(Face),
    /// Around a point light: those sides of a cube that hold a caster and can be looked at.
    Cube {
        /// The light, anchored.
        position: DVec3,
        /// At least one, at most six.
        faces: Vec<Face>,
    },
}

/// How light travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rays {
    /// Everywhere along the same unit vector.
    Parallel(DVec3),
    /// From an anchored position in all directions.
    FromPoint(DVec3),
}

/// One shadow map to draw.
#[derive(Clone, Debug)]
pub struct Face {
    /// Which side of the cube around a point light, in the order +x, −x, +y, −y, +z, −z; else 0.
    pub side: usize,
    /// The light as a viewer: orthographic along parallel rays, else perspective along an axis.
    pub view: View,
    /// What casts. Draws of its slots count in `tests`.
    pub items: Vec<Item>,
    /// The instance of each of `items`, an index into the scene's.
    pub casters: Vec<u32>,
    /// What decides on the triangles of slots that are cut out.
    pub tests: Vec<CasterTest>,
}

/// The alpha test of one slot of a caster.
#[derive(Clone, Debug)]
pub struct CasterTest {
    /// Index into [`Face::items`].
    pub item: u32,
    /// Which of its fragments cast.
    pub test: AlphaTest,
}

impl Face {
    fn new<'a>(side: usize, view: View, cull: ShadowCull, casters: impl Iterator<Item = &'a Caster>) -> Self {
        let cull = match cull {
            ShadowCull::None => Cull::None,
            ShadowCull::Front => Cull::Front,
            ShadowCull::Back => Cull::Back,
        };
        let mut face = Self { side, view, items: Vec::new(), casters: Vec::new(), tests: Vec::new() };
        casters.for_each(|caster| face.push(caster, cull));
        face
    }

    /// Takes in a caster but for the faces that `cull` leaves out.
    fn push(&mut self, caster: &Caster, cull: Cull) {
        let mut item = caster.item.clone();
        let first = number(self.tests.len());
        for slot in item.slots.iter_mut().flatten() {
            *slot = Slot { draw: slot.draw + first, cull, ..*slot };
        }
        let number = number(self.items.len());
        self.tests.extend(caster.tests.iter().map(|test| CasterTest { item: number, test: test.clone() }));
        self.items.push(item);
        self.casters.push(caster.instance);
    }

    /// The test of the triangles of `draw`.
    #[must_use]
    pub fn test(&self, draw: u32) -> ItemTest<'_> {
        let caster = &self.tests[draw as usize];
        ItemTest { item: &self.items[caster.item as usize], test: &caster.test }
    }
}

/// How shadow maps are read, all numbers settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// One tap.
    Hard,
    /// A disc of fixed size.
    Pcf {
        /// In texels, > 0.
        radius: f64,
        /// At least one.
        taps: u32,
    },
    /// A disc whose size follows the distance to what blocks the light.
    Pcss(Pcss),
}

/// Percentage-closer soft shadows. Source: R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH
/// 2005 sketches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pcss {
    /// Tangent of the light's half-angle (parallel rays) or its radius in world units; > 0.
    pub light_radius: f64,
    /// Radius of the search for blockers in texels; `None`: as wide as the nearest caster demands.
    pub search_radius: Option<f64>,
    /// Taps of that search.
    pub search_taps: u32,
    /// Taps of the filter.
    pub filter_taps: u32,
}

impl Filter {
    /// A kernel of no size is one tap.
    fn settle(shadow: &Shadow) -> Self {
        match shadow.filter {
            ShadowFilter::Pcf if shadow.radius > 0.0 => {
                Self::Pcf { radius: shadow.radius, taps: shadow.pcf_taps }
            }
            ShadowFilter::Pcss if shadow.light_radius > 0.0 => Self::Pcss(Pcss {
                light_radius: shadow.light_radius,
                search_radius: shadow.search_radius,
                search_taps: shadow.search_taps,
                filter_taps: shadow.filter_taps,
            }),
            _ => Self::Hard,
        }
    }
}

impl ShadowPass {
    /// Working memory that drawing it takes.
    #[must_use]
    pub fn frame_bytes(&self) -> u64 {
        let items: u64 = self.faces().iter().flat_map(|face| &face.items).map(Item::frame_bytes).sum();
        // A texel, and its share of the pyramid above it.
        let texel = if self.filter == Filter::Hard { 4 } else { 5 };
        items.saturating_add(self.texels() * texel)
    }

    /// Texels of all its maps.
    #[must_use]
    pub fn texels(&self) -> u64 {
        self.faces().iter().map(|face| u64::from(face.view.width).pow(2)).sum()
    }

    /// Instances that are drawn into any of its maps.
    #[must_use]
    pub fn casters(&self) -> usize {
        self.faces().iter().flat_map(|face| &face.casters).collect::<BTreeSet<_>>().len()
    }

    /// How many sides of a cube are drawn; `None` of parallel light.
    #[must_use]
    pub fn cube_sides(&self) -> Option<usize> {
        match &self.maps {
            Maps::Directional(_) => None,
            Maps::Cube { faces, .. } => Some(faces.len()),
        }
    }

    /// Every map.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        match &self.maps {
            Maps::Directional(face) => std::slice::from_ref(face),
            Maps::Cube { faces, .. } => faces,
        }
    }
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

/// What the shadow of one light goes without.
pub(super) struct Notes<'a> {
    /// Index into the scene's lights.
    pub(super) light: u32,
    /// What of it may be left out.
    pub(super) elide: Elisions,
    /// Where it is noted.
    pub(super) left_out: &'a mut Vec<LeftOut>,
}

impl Notes<'_> {
    fn leave_out_caster(&mut self, instance: u32, reason: Reason) {
        self.left_out.push(LeftOut { part: Part::Caster { light: self.light, instance }, reason });
    }

    /// Whether a side that nothing reads, or that holds nothing, is left out.
    fn leaves_out_side(&mut self, side: usize, reason: Reason) -> bool {
        let leaves = self.elide.contains(Elision::CubeSides);
        if leaves {
            self.left_out.push(LeftOut { part: Part::Side { light: self.light, side }, reason });
        }
        leaves
    }
}

/// The maps of one light, or why nothing can cast on anything.
pub(super) fn plan(
    participants: &Participants,
    rays: Rays,
    shadow: &Shadow,
    notes: &mut Notes,
) -> Result<ShadowPass, Reason> {
    let casters = participants.casters(rays, notes);
    if casters.is_empty() {
        return Err(Reason::NothingCasts);
    }
    let receivers = participants.receivers();
    let filter = Filter::settle(shadow);
    let maps = match rays {
        Rays::Parallel(direction) => {
            let items: Vec<&Item> = casters.iter().map(|caster| &caster.item).collect();
            let view = directional::fit(direction, &items, &receivers, shadow.resolution, &filter)
                .ok_or(Reason::NothingBehind)?;
            Maps::Directional(Face::new(0, view, shadow.cull, casters.into_iter()))
        }
        Rays::FromPoint(position) => {
            let faces = cube::faces(position, &casters, &receivers, shadow, &filter, notes);
            (!faces.is_empty()).then_some(Maps::Cube { position, faces }).ok_or(Reason::NothingBehind)?
        }
    };
    Ok(ShadowPass { maps, filter, bias: shadow.bias })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::plan::{FrameRequest, Plan};
    use crate::scene::NewScene;
    use serde_json::json;
    use std::sync::Arc;

    #[test]
    fn lights_that_share_their_casters_cull_them_each_for_itself() {
        let sun = |cull: &str| json!({ "type": "directional", "direction": [0, -1, 0], "shadow": { "cull": cull } });
        let lamp = json!({ "type": "point", "position": [0, 3, 0], "shadow": { "cull": "front" } });
        let document = json!({
            "lights": { "a": sun("none"), "b": sun("back"), "c": lamp },
            "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [4, 4] } },
            "instances": {
                "box": { "mesh": "box", "translation": [0, 1, 0] },
                "floor": { "mesh": "floor", "casts_shadow": false },
            },
        });
        let new = NewScene { document: Some(document), ..NewScene::default() };
        let scene = Arc::new(new.compile(&Limits::default()).unwrap());
        let plan = Plan::new(&scene, &FrameRequest::default(), &Limits::default()).unwrap();
        let culls = plan.shadows.iter().map(|pass| {
            let items: Vec<&Item> = pass.faces().iter().flat_map(|face| &face.items).collect();
            // The floor casts nothing; the lamp's box is below it, before one side of its cube.
            assert_eq!(items.len(), 1);
            items[0].slots[0].unwrap().cull
        });
        assert!(culls.eq([Cull::None, Cull::Back, Cull::Front]));
    }
}
