//! `/scenes/{id}/plan`: what a frame would run and what it goes without, each with its reason.

use super::problem::Problem;
use super::query::Pairs;
use super::{App, openapi};
use crate::plan::{
    Draw, Elision, Filter, Opacity, Pass, Plan, PlannedLight, Pointwise, PostPass, Saving, ShadowPass,
};
use crate::scene::document::words::Word;
use crate::scene::{Lens, LightKind, Scene};
use axum::Json;
use axum::extract::{Path, State};
use serde::Serialize;
use utoipa::ToSchema;

/// What a frame would run, and what it goes without.
#[derive(Serialize, ToSchema)]
pub(super) struct FramePlan {
    settings: Settled,
    camera: PlannedCamera,
    /// In the order of `Server-Timing`
    passes: Vec<PassNote>,
    /// In the order of submission
    draws: Vec<DrawNote>,
    /// Those that shine
    lights: Vec<LightNote>,
    /// Passes of effects, and what rides along with them
    post: Vec<EffectNote>,
    left_out: Vec<LeftOutNote>,
    /// What is spared on the way, in the order of the passes
    elisions: Vec<ElisionNote>,
    /// Working memory that it takes
    bytes: u64,
}

/// What the frame is drawn with.
#[derive(Serialize, ToSchema)]
struct Settled {
    width: u32,
    height: u32,
    /// Width and height of what is drawn, where the picture is resampled
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn: Option<[u32; 2]>,
    samples: u32,
    /// Seconds
    t: f64,
    output: &'static str,
    /// What overrides every material's
    shading: Option<&'static str>,
}

/// The camera, also where it is framed automatically, as a document has it.
#[derive(Serialize, ToSchema)]
struct PlannedCamera {
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    /// Of a perspective view
    #[serde(skip_serializing_if = "Option::is_none")]
    fov_y_deg: Option<f64>,
    /// Of a parallel one
    #[serde(skip_serializing_if = "Option::is_none")]
    orthographic: Option<OrthographicView>,
    near: f64,
    /// Infinite without it
    far: Option<f64>,
}

/// A parallel view.
#[derive(Serialize, ToSchema)]
struct OrthographicView {
    /// Of the whole view
    height: f64,
}

/// A pass.
#[derive(Serialize, ToSchema)]
struct PassNote {
    /// As in `Server-Timing`
    name: &'static str,
    runs: bool,
    /// A sentence
    reason: String,
}

/// One material of one instance.
#[derive(Serialize, ToSchema)]
struct DrawNote {
    instance: String,
    mesh: String,
    /// Null for the default one, and for those of the model's own file
    material: Option<String>,
    triangles: usize,
    /// What is computed for each of its fragments
    variant: Vec<String>,
    /// Whether what is behind shows through
    transparent: bool,
}

/// A light that shines.
#[derive(Serialize, ToSchema)]
struct LightNote {
    name: String,
    /// `directional` or `point`
    r#type: &'static str,
    shadow: Option<ShadowNote>,
}

/// A shadow that is drawn.
#[derive(Serialize, ToSchema)]
struct ShadowNote {
    /// `hard`, `pcf` or `pcss`
    filter: &'static str,
    /// Texels along a side of each map
    resolution: u32,
    /// One along parallel light, up to six around a point
    maps: usize,
    /// Instances that are drawn into them
    casters: usize,
}

/// One pass of effects.
#[derive(Serialize, ToSchema)]
struct EffectNote {
    /// Types, fused into the one pass
    effects: Vec<&'static str>,
    /// `pointwise`: one pixel at a time, in the tiles; `neighbourhood`: over the whole picture
    kind: &'static str,
}

/// What the frame goes without.
#[derive(Serialize, ToSchema)]
struct LeftOutNote {
    what: String,
    reason: String,
    /// The elision that decides on it; null where the scene or the request does
    elision: Option<&'static str>,
    /// What that saves
    saves: Option<String>,
}

/// An elision that the frame has use for.
#[derive(Serialize, ToSchema)]
struct ElisionNote {
    /// As `elide` takes it
    name: &'static str,
    /// What is counted of it: the name of its work in the events of a stream
    unit: &'static str,
    /// What the frame would do without it
    saves: String,
    /// Why the picture is the same to the bit
    exact: &'static str,
}

/// What a frame would run
///
/// And what it goes without, each with its reason. Nothing is drawn.
#[utoipa::path(
    get, path = "/scenes/{id}/plan", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::FrameQuery),
    responses((status = 200, description = "The plan of the frame that the same query gives", body = FramePlan)),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
) -> Result<Json<FramePlan>, Problem> {
    let request = pairs.frame()?;
    let scene = app.entry(&id)?.scene;
    let (request, _) = app.renderer.to_budget(&scene, request).await?;
    let plan = app.renderer.plan(scene, request).await?;
    Ok(Json(FramePlan::of(&plan)))
}

impl FramePlan {
    fn of(plan: &Plan) -> Self {
        let left_out = plan.left_out.iter().map(|left| LeftOutNote {
            what: left.part.describe(&plan.scene),
            reason: left.reason.to_string(),
            elision: left.reason.elision().map(Elision::name),
            saves: plan.saved_with(*left),
        });
        let elisions = plan.savings().into_iter().map(ElisionNote::from);
        Self {
            settings: Settled::of(plan),
            camera: PlannedCamera::of(plan),
            passes: plan.passes().into_iter().map(PassNote::from).collect(),
            draws: plan.draws.iter().map(|draw| DrawNote::of(draw, plan)).collect(),
            lights: plan.lights.iter().map(|light| LightNote::of(light, plan)).collect(),
            post: effects(plan),
            left_out: left_out.collect(),
            elisions: elisions.collect(),
            bytes: plan.bytes(),
        }
    }
}

impl From<Saving> for ElisionNote {
    fn from(Saving { elision, saves }: Saving) -> Self {
        Self { name: elision.name(), unit: elision.unit().name(), saves, exact: elision.exact() }
    }
}

impl Settled {
    fn of(plan: &Plan) -> Self {
        Self {
            width: plan.size[0],
            height: plan.size[1],
            drawn: plan.is_resampled().then_some([plan.view.width, plan.view.height]),
            samples: plan.samples,
            t: plan.t,
            output: plan.output.word(),
            shading: plan.shading().map(Word::word),
        }
    }
}

impl PlannedCamera {
    fn of(plan: &Plan) -> Self {
        let camera = &plan.camera;
        let (fov_y_deg, orthographic) = match camera.lens {
            Lens::Perspective { fov_y_deg } => (Some(fov_y_deg), None),
            Lens::Orthographic { height } => (None, Some(OrthographicView { height })),
        };
        Self {
            position: (camera.eye + plan.scene.anchor).to_array(),
            target: (camera.target + plan.scene.anchor).to_array(),
            up: camera.vertical.to_array(),
            fov_y_deg,
            orthographic,
            near: camera.near,
            far: camera.far,
        }
    }
}

impl From<Pass> for PassNote {
    fn from(Pass { name, runs, reason }: Pass) -> Self {
        Self { name, runs, reason }
    }
}

impl DrawNote {
    fn of(draw: &Draw, plan: &Plan) -> Self {
        let scene: &Scene = &plan.scene;
        let instance = &scene.instances[draw.instance as usize];
        let slot = draw.slot as usize;
        let drawn = plan.items[draw.item as usize].slots[slot];
        Self {
            instance: instance.name.clone(),
            mesh: scene.mesh_names[instance.mesh as usize].clone(),
            material: scene.material_names[instance.materials[slot] as usize].clone(),
            triangles: scene.mesh(instance).triangles_of(slot),
            variant: plan.variant(draw),
            transparent: drawn.is_some_and(|slot| slot.opacity == Opacity::Blended),
        }
    }
}

impl LightNote {
    fn of(light: &PlannedLight, plan: &Plan) -> Self {
        Self {
            name: plan.scene.lights[light.light as usize].name.clone(),
            r#type: match light.kind {
                LightKind::Directional { .. } => "directional",
                LightKind::Point { .. } => "point",
            },
            shadow: light.shadow.map(|index| ShadowNote::of(&plan.shadows[index as usize])),
        }
    }
}

impl ShadowNote {
    fn of(pass: &ShadowPass) -> Self {
        let faces = pass.faces();
        Self {
            filter: match pass.filter {
                Filter::Hard => "hard",
                Filter::Pcf { .. } => "pcf",
                Filter::Pcss(_) => "pcss",
            },
            resolution: faces.first().map_or(0, |face| face.view.width),
            maps: faces.len(),
            casters: pass.casters(),
        }
    }
}

/// The passes of effects, in order.
fn effects(plan: &Plan) -> Vec<EffectNote> {
    let pointwise = |steps: &[Pointwise]| {
        let effects: Vec<_> = steps.iter().map(|step| step.type_name()).collect();
        (!effects.is_empty()).then_some(EffectNote { effects, kind: "pointwise" })
    };
    let pass = |pass: &PostPass| {
        let effect = pass.effect.as_ref().map(|effect| vec![effect.type_name()]);
        [effect.map(|effects| EffectNote { effects, kind: "neighbourhood" }), pointwise(&pass.then)]
    };
    let passes = plan.post.passes.iter().flat_map(pass);
    std::iter::once(pointwise(&plan.post.in_tiles)).chain(passes).flatten().collect()
}
