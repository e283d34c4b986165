//! What one frame needs: scene and request in, passes and draws out.
//!
//! Every option is settled here. Below the plan nothing asks again whether something is on, and
//! nothing can fail but cancellation.

mod draw;
mod elide;
mod etag;
mod left_out;
pub mod opacity;
mod passes;
mod post;
pub mod request;
mod resampling;
mod savings;
mod shadow;
mod surface;
mod variant;
mod view;

pub use draw::{Draw, Heights, Item, Relief, Slot, Spared, Specular, Surface};
pub use elide::{Elision, Elisions, Tally, Unit};
pub use left_out::{LeftOut, Part, Reason};
pub use opacity::{Alpha, AlphaTest, ItemTest, Opacity, Transparency};
pub use passes::Pass;
pub use post::{
    Bloom, Curve, Fxaa, Gaussian, Kernel, KernelRow, Neighbourhood, Pointwise, PostChain, PostPass, Sharpen,
};
pub use request::{FrameRequest, Knobs, Output, QueryFault};
pub use resampling::{AxisTaps, Resampling};
pub use savings::Saving;
pub use shadow::{CasterTest, Face, Filter, Maps, Pcss, ShadowPass, WIDEST_TANGENT, orthonormal_basis};

use crate::limits::Limits;
use crate::math::View;
use crate::model::Shading;
use crate::scene::framing::{self, ResolvedCamera};
use crate::scene::{Background, Cull, Instance, Light, LightKind, Scene, Shadow};
use glam::Vec3;
use request::BackgroundRequest;
use std::sync::Arc;

/// Everything that one frame needs, and nothing else.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What it is a picture of.
    pub scene: Arc<Scene>,
    /// Seconds.
    pub t: f64,
    /// What the picture shows.
    pub output: Output,
    /// The camera.
    pub camera: ResolvedCamera,
    /// What it sees, in the pixels that are drawn.
    pub view: View,
    /// Pixels along the sides of the picture: those that are drawn, unless it is resampled.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
    /// Visible instances that reach into the view, in submission order.
    pub items: Vec<Item>,
    /// Their surfaces.
    pub draws: Vec<Draw>,
    /// Ambient radiance.
    pub ambient: Vec3,
    /// Lights that shine.
    pub lights: Vec<PlannedLight>,
    /// Shadows to draw: those of the lights that have one.
    pub shadows: Vec<ShadowPass>,
    /// What is drawn where nothing else is.
    pub background: Background,
    /// What happens to the picture before it is encoded.
    pub post: PostChain,
    /// Distances that 0 and 65535 stand for in `output=depth`.
    pub depth_range: Option<[f64; 2]>,
    /// What may be left out where the picture stays the same.
    pub elide: Elisions,
    /// What it goes without, of all that the scene and the request ask for.
    pub left_out: Vec<LeftOut>,
    /// What overrides the shading of its materials.
    shading: Option<Shading>,
    /// What overrides how much work goes into it.
    knobs: Knobs,
    /// Working memory that it will take.
    bytes: u64,
    /// That of its items among it.
    geometry_bytes: u64,
}

/// A light that shines.
#[derive(Clone, Debug)]
pub struct PlannedLight {
    /// Index into the scene's lights.
    pub light: u32,
    /// Linear RGB.
    pub radiance: Vec3,
    /// Where its light comes from, anchored.
    pub kind: LightKind,
    /// Index into [`Plan::shadows`].
    pub shadow: Option<u32>,
}

/// Why a frame cannot be planned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// Query parameters that make no sense for this scene.
    #[error("the query makes no sense for this scene")]
    Query(Vec<QueryFault>),
    /// More than the server gives to one frame.
    #[error("{what} is {value}, over the limit of {limit}")]
    TooLarge {
        /// What is too large.
        what: String,
        /// How much there may be.
        limit: u64,
        /// How much it would be.
        value: u64,
        /// The setting that moves the limit.
        setting: Option<&'static str>,
    },
}

impl PlanError {
    /// Refuses a `value` over its `limit`, which `setting` moves.
    ///
    /// # Errors
    /// [`PlanError::TooLarge`].
    pub fn over(what: &str, value: u64, limit: u64, setting: Option<&'static str>) -> Result<(), Self> {
        if value <= limit {
            return Ok(());
        }
        Err(Self::TooLarge { what: what.to_owned(), limit, value, setting })
    }

    /// Refuses more `bytes` of memory than a frame may have.
    ///
    /// # Errors
    /// [`PlanError::TooLarge`].
    pub fn over_memory(what: &str, bytes: u64, limits: &Limits) -> Result<(), Self> {
        let what = format!("{what} in bytes");
        Self::over(&what, bytes, limits.frame_bytes, Some("RASTERD_MAX_FRAME_BYTES"))
    }
}

impl Plan {
    /// Settles what a frame of `scene` needs.
    ///
    /// # Errors
    /// [`PlanError`]: overrides that contradict the scene, or a frame over its limits.
    pub fn new(scene: &Arc<Scene>, request: &FrameRequest, limits: &Limits) -> Result<Self, PlanError> {
        let mut plan = Self::outline(scene, request, limits)?;
        plan.add_instances(limits)?;
        plan.add_lights(limits)?;
        if plan.output == Output::ShadowMap {
            plan.leave_out_view();
        }
        Ok(plan)
    }

    /// The plan without what follows from the scene: items, draws, lights and shadows. Its camera, its range
    /// of depth and its entity tag are those of the whole, for a small part of the work.
    ///
    /// # Errors
    /// As [`Plan::new`], but what its instances and lights would be too many for.
    pub fn outline(scene: &Arc<Scene>, request: &FrameRequest, limits: &Limits) -> Result<Self, PlanError> {
        let width = request.width.unwrap_or(scene.render.width);
        let height = request.height.unwrap_or(scene.render.height);
        check_picture(width, height, limits)?;
        let t = request.t;
        let background = background(scene, request)?;
        let camera = camera(scene, request, width, height)?;
        let bounds = scene.bounds(t);
        let is_shaded = request.output.is_shaded();
        let knobs = request.knobs.that_change(scene);
        let size = [width, height];
        let drawn = if is_shaded { knobs.drawn_size(size) } else { size };
        check_picture(drawn[0], drawn[1], limits)?;
        let view = view::of_camera(&camera, bounds, size).with_size(drawn);
        let samples = request.samples.unwrap_or(scene.render.samples);
        let mut plan = Self {
            scene: scene.clone(),
            t,
            output: request.output,
            camera,
            view,
            size,
            samples: if request.output.looks_as_color() { samples } else { 1 },
            items: Vec::new(),
            draws: Vec::new(),
            ambient: scene.ambient,
            lights: Vec::new(),
            shadows: Vec::new(),
            background: if is_shaded { background } else { Background::Color(Vec3::ZERO) },
            post: PostChain::default(),
            depth_range: (request.output == Output::Depth).then(|| view::depth_range(&camera, bounds)),
            // What shows the work of a frame shows that of the frame as it is drawn.
            elide: if request.output.shows_work() {
                Elisions::ALL
            } else {
                request.elide.unwrap_or_default()
            },
            left_out: Vec::new(),
            shading: request.shading.or(scene.render.shading),
            knobs,
            bytes: 0,
            geometry_bytes: 0,
        };
        plan.settle_post();
        if !is_shaded {
            plan.leave_out_light(samples);
        }
        plan.charge_picture(limits)?;
        Ok(plan)
    }

    /// Adds what its pixels take until they are written.
    fn charge_picture(&mut self, limits: &Limits) -> Result<(), PlanError> {
        let pixels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        let drawn = [self.view.width, self.view.height];
        let transparent = self.background == Background::Transparent;
        self.charge(pixels(drawn) * self.output.pixel_bytes(), limits)?;
        self.charge(self.post.frame_bytes(drawn[0], drawn[1], transparent), limits)?;
        if self.is_resampled() {
            self.charge(pixels(self.size) * self.output.pixel_bytes(), limits)?;
            self.charge(Resampling::frame_bytes(drawn, self.size), limits)?;
        }
        Ok(())
    }

    /// What overrides how much work goes into it, where that changes something.
    #[must_use]
    pub fn knobs(&self) -> &Knobs {
        &self.knobs
    }

    /// Whether the pixels that are drawn are not those of the picture.
    #[must_use]
    pub fn is_resampled(&self) -> bool {
        self.size != [self.view.width, self.view.height]
    }

    /// Settles the effects: colour alone has any.
    fn settle_post(&mut self) {
        let effects = &self.scene.post;
        let reason = match self.output {
            Output::Color => {
                let drawn = [self.view.width, self.view.height];
                let scale = f64::from(drawn[1]) / f64::from(self.size[1]);
                let (elide, left_out) = (self.post_elisions(), &mut self.left_out);
                self.post = PostChain::settle(effects, drawn, scale, elide, left_out);
                return;
            }
            Output::Radiance => Reason::BeforePost,
            output => Reason::Data(output),
        };
        let parts = (0..effects.len()).map(Part::Effect);
        self.left_out.extend(parts.map(|part| LeftOut { part, reason }));
    }

    /// What of its effects may be left out. Over a transparent background every pass divides by alpha and
    /// multiplies again, which rounds: there it is not the same in every bit whether one runs.
    fn post_elisions(&self) -> Elisions {
        match self.background {
            Background::Transparent => {
                self.elide.with(Elision::NeutralEffects).with(Elision::PointwisePasses)
            }
            _ => self.elide,
        }
    }

    /// Notes what a picture of data does not show.
    fn leave_out_light(&mut self, samples: u32) {
        let reason = Reason::Data(self.output);
        self.leave_out(Part::Background, reason);
        if self.samples < samples {
            self.leave_out(Part::Samples, reason);
        }
        if self.knobs.render_scale.is_some() {
            self.leave_out(Part::RenderScale, reason);
        }
    }

    /// Drops what the camera sees, once it is known which shadows fall there.
    fn leave_out_view(&mut self) {
        self.items.clear();
        self.draws.clear();
        self.bytes -= std::mem::take(&mut self.geometry_bytes);
        self.leave_out(Part::View, Reason::ViewsOfLights);
    }

    fn leave_out(&mut self, part: Part, reason: Reason) {
        self.left_out.push(LeftOut { part, reason });
    }

    /// Adds every instance that is seen, with its surfaces.
    fn add_instances(&mut self, limits: &Limits) -> Result<(), PlanError> {
        let scene = self.scene.clone();
        for (index, instance) in (0..).zip(&scene.instances) {
            match self.place(index, instance) {
                Ok(placed) => {
                    self.charge(placed.frame_bytes(), limits)?;
                    self.geometry_bytes += placed.frame_bytes();
                    self.items.push(placed);
                }
                Err(reason) => self.leave_out(Part::Instance(index), reason),
            }
        }
        Ok(())
    }

    /// An instance in its place, with what becomes of its slots; or why nothing of it is seen.
    fn place(&mut self, index: u32, instance: &Instance) -> Result<Item, Reason> {
        if !instance.visible {
            return Err(Reason::Hidden);
        }
        let mut placed = Item::new(&self.scene, instance, self.t, Vec::new());
        let bounds = placed.bounds().ok_or(Reason::NoTriangles)?;
        if self.elide.contains(Elision::OutsideInstances) && !view::reaches(&self.view, bounds) {
            return Err(Reason::OutsideOfTheView);
        }
        placed.slots = (0..).zip(&instance.materials).map(|(slot, _)| self.add_draw(index, slot)).collect();
        if placed.slots.iter().all(Option::is_none) {
            return Err(Reason::Clear);
        }
        let is_clear = (0..).zip(&placed.slots).filter(|(_, kept)| kept.is_none());
        let parts = is_clear.map(|(slot, _)| Part::Slot { instance: index, slot });
        self.left_out.extend(parts.map(|part| LeftOut { part, reason: Reason::Clear }));
        Ok(placed)
    }

    /// Adds the draw of one slot of an instance, for the item that comes next; `None` if nothing of its
    /// material is there.
    fn add_draw(&mut self, instance: u32, slot: u32) -> Option<Slot> {
        let scene = &self.scene;
        let of = &scene.instances[instance as usize];
        let material = self.knobs.material(&scene.materials[of.materials[slot as usize] as usize]);
        let transparency = opacity::of_output(&material, self.output)?;
        let (mesh, tangents) = (scene.mesh(of), scene.tangents(of));
        let (receives, shading) = (of.receives_shadow, self.shading);
        let (output, elide) = (self.output, self.elide);
        let surface =
            surface::settle(&material, mesh, tangents, receives, shading, output, elide, &transparency);
        let cull = if material.double_sided { Cull::None } else { scene.render.cull };
        let opacity = transparency.opacity();
        let (item, draw) = (number(self.items.len()), number(self.draws.len()));
        let alpha_test = transparency.into_test();
        self.draws.push(Draw { item, instance, slot, surface, alpha_test });
        Some(Slot { draw, cull, opacity })
    }

    /// Adds the lights that shine, with the shadow maps that they need.
    fn add_lights(&mut self, limits: &Limits) -> Result<(), PlanError> {
        let scene = self.scene.clone();
        let is_lit = self.draws.iter().any(|draw| draw.surface.lit);
        let receives = self.draws.iter().any(|draw| draw.surface.receives_shadow && draw.surface.lit);
        let mut participants = None;
        for (index, light) in (0..).zip(&scene.lights) {
            let dark = self.why_dark(light, is_lit);
            if let Some(reason) = dark.filter(|reason| self.may_elide(*reason)) {
                self.leave_out(Part::Light(index), reason);
                continue;
            }
            let shadow = light.shadow.and_then(|shadow| {
                let shadow = self.knobs.shadow(shadow);
                let pass = self.shadow(index, light, &shadow, receives, &mut participants);
                pass.map_err(|reason| self.leave_out(Part::Shadow(index), reason)).ok()
            });
            let shadow = shadow.map(|pass| self.add_shadow(pass, limits)).transpose()?;
            let radiance = if light.enabled { light.radiance } else { Vec3::ZERO };
            let kind = light.kind;
            self.lights.push(PlannedLight { light: index, radiance, kind, shadow });
        }
        Ok(())
    }

    /// Whether what the reason is about is left out: always, but for what an elision decides on.
    fn may_elide(&self, reason: Reason) -> bool {
        reason.elision().is_none_or(|elision| self.elide.contains(elision))
    }

    /// Why a light does not shine in the frame, if it does not.
    fn why_dark(&self, light: &Light, is_lit: bool) -> Option<Reason> {
        if !self.output.is_lit() {
            Some(Reason::Data(self.output))
        } else if !light.enabled {
            Some(Reason::SwitchedOff)
        } else if light.radiance == Vec3::ZERO {
            Some(Reason::Black)
        } else {
            (!is_lit).then_some(Reason::NothingLit)
        }
    }

    /// The maps of a light that asks for a `shadow`, or why it needs none. `participants` are found when the
    /// first light asks for them.
    fn shadow(
        &mut self,
        index: u32,
        light: &Light,
        shadow: &Shadow,
        receives: bool,
        participants: &mut Option<shadow::Participants>,
    ) -> Result<ShadowPass, Reason> {
        if !self.scene.render.shadows {
            return Err(Reason::NoShadows);
        }
        if !receives && self.may_elide(Reason::NothingReceives) {
            return Err(Reason::NothingReceives);
        }
        let rays = match light.kind {
            LightKind::Directional { direction } => shadow::Rays::Parallel(direction),
            LightKind::Point { position, .. } => shadow::Rays::FromPoint(position),
        };
        let participants = participants.get_or_insert_with(|| shadow::Participants::of(&self.scene, self.t));
        let mut notes = shadow::Notes { light: index, elide: self.elide, left_out: &mut self.left_out };
        shadow::plan(participants, rays, shadow, &mut notes)
    }

    /// Adds a shadow; gives back its index.
    fn add_shadow(&mut self, pass: ShadowPass, limits: &Limits) -> Result<u32, PlanError> {
        self.charge(pass.frame_bytes(), limits)?;
        self.shadows.push(pass);
        check_shadow_texels(&self.shadows, limits)?;
        Ok(number(self.shadows.len() - 1))
    }

    /// Adds to the frame's working memory, and refuses what would not fit: a small document can ask
    /// for any number of triangles.
    fn charge(&mut self, bytes: u64, limits: &Limits) -> Result<(), PlanError> {
        self.bytes = self.bytes.saturating_add(bytes);
        PlanError::over_memory("working memory of the frame", self.bytes, limits)
    }

    /// Bytes of working memory that it will take.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Those of them that a pass over its triangles takes, which plans that show the same ones share.
    #[must_use]
    pub fn geometry_bytes(&self) -> u64 {
        self.geometry_bytes
    }

    /// Whether a pass over this plan's triangles is one over those of `other` too: the same view of the
    /// same items, of which the same draws are shown.
    #[must_use]
    pub fn shows_the_triangles_of(&self, other: &Self) -> bool {
        self.view == other.view
            && self.elide == other.elide
            && self.items.len() == other.items.len()
            && self.items.iter().zip(&other.items).all(|(own, other)| own.places_the_triangles_of(other))
    }

    /// Whether what every sample sees is the same as in `other`.
    #[must_use]
    pub fn looks_as(&self, other: &Self) -> bool {
        let tests =
            || self.draws.iter().zip(&other.draws).map(|(own, other)| (&own.alpha_test, &other.alpha_test));
        self.samples == other.samples
            && self.shows_the_triangles_of(other)
            && tests().all(|tests| match tests {
                (Some(own), Some(other)) => own.has_the_holes_of(other),
                (own, other) => own.is_none() && other.is_none(),
            })
    }

    /// What is known of its work before it is done: what it will do, and what it is spared.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        let cubes = self.shadows.iter().filter_map(ShadowPass::cube_sides);
        let (effects, passes) = self.post.work();
        let texels = self.shadows.iter().map(ShadowPass::texels).sum();
        tally.count(Unit::ShadowTexels, texels);
        for (unit, count) in [
            (Unit::Shadows, self.shadows.len()),
            (Unit::Lights, self.lights.len()),
            (Unit::CubeSides, cubes.sum()),
            (Unit::Instances, self.items.len()),
            (Unit::Effects, effects),
            (Unit::Passes, passes),
        ] {
            tally.count(unit, count as u64);
        }
        let elided = self.left_out.iter().filter_map(|left| left.reason.elision());
        elided.for_each(|elision| tally.spare(elision, 1));
        tally.spare(Elision::PointwisePasses, self.post.fused as u64);
        tally
    }

    /// What overrides the shading of its materials; what shows no light knows no override.
    #[must_use]
    pub fn shading(&self) -> Option<Shading> {
        self.shading.filter(|_| self.output.is_lit())
    }

    /// Strong entity tag of the picture, in quotes: a function of its inputs and the program's
    /// version alone.
    #[must_use]
    pub fn etag(&self) -> String {
        etag::of(self)
    }
}

/// An index: maps of a document and the materials of a mesh hold fewer than 2³² entries.
fn number(index: usize) -> u32 {
    u32::try_from(index).expect("fewer than 2³² entries")
}

fn check_picture(width: u32, height: u32, limits: &Limits) -> Result<(), PlanError> {
    let side = u64::from(width.max(height));
    PlanError::over("the picture's longer side in pixels", side, limits.picture_side.into(), None)?;
    let pixels = u64::from(width) * u64::from(height);
    PlanError::over("the number of pixels", pixels, limits.picture_pixels, None)
}

fn check_shadow_texels(shadows: &[ShadowPass], limits: &Limits) -> Result<(), PlanError> {
    let texels = shadows.iter().map(ShadowPass::texels).sum();
    PlanError::over("the number of texels of all shadow maps", texels, limits.shadow_texels, None)
}

fn background(scene: &Scene, request: &FrameRequest) -> Result<Background, PlanError> {
    match &request.background {
        None => Ok(scene.background.clone()),
        Some(BackgroundRequest::Transparent) => Ok(Background::Transparent),
        Some(BackgroundRequest::Color(color)) => Ok(Background::Color(*color)),
        Some(BackgroundRequest::Named(name)) => {
            let found = scene.backgrounds.iter().find(|(known, _)| known == name);
            found.map(|(_, background)| background.clone()).ok_or_else(|| {
                let known: Vec<&str> = scene.backgrounds.iter().map(|(name, _)| name.as_str()).collect();
                let detail = format!(
                    "must be \"transparent\", rrggbb, or one of the scene's backgrounds [{}], is {name:?}",
                    known.join(", ")
                );
                PlanError::Query(vec![QueryFault::new("background", detail)])
            })
        }
    }
}

/// The camera of a frame of `width` × `height` pixels.
fn camera(
    scene: &Scene,
    request: &FrameRequest,
    width: u32,
    height: u32,
) -> Result<ResolvedCamera, PlanError> {
    framing::resolve(scene, request, width, height).map_err(|faults| {
        PlanError::Query(
            faults.into_iter().map(|fault| QueryFault::new(fault.parameter, fault.detail)).collect(),
        )
    })
}
