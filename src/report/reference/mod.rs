//! What pictures are measured against: a ray caster in f64 that shares no code with the pipeline. What a scene holds
//! before either sees it they have in common: texels and their sRGB decoding, the table of a computed sky, meshes.
//!
//! In: a compiled scene and a settled camera. Out: radiance, how much of it is noise, and the picture after its
//! effects in linear light. It reads like the textbook, and takes its time.
//!
//! ```text
//! sequence → camera → world (bvh) → point → shading (texture, relief, light) → pixel → post
//!                                 ↘ background ────────────────────────────↗
//! ```
//!
//! Where the pipeline approximates, this is what it approximates: coverage is a box filter over the
//! pixel's square, a shadow a ray from the surface to the light (for PCSS to a place of a disc), a
//! texture its full-size picture seen by every sample. `pcf` blurs a hard shadow by the texels of its
//! map, and `fxaa` imitates what many samples are: neither has a limit of its own, so a hard shadow and
//! no effect stand for them.

mod background;
mod bvh;
mod camera;
mod light;
mod pixel;
mod point;
mod post;
mod relief;
mod sequence;
mod shading;
mod texture;
mod world;

use crate::model::Shading;
use crate::pipeline::{Cancelled, Work};
use crate::scene::framing::ResolvedCamera;
use crate::scene::{Background, Scene};
use camera::Camera;
use light::Lamp;
use pixel::{Pixel, Studio};
use shading::Lighting;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use world::World;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The scene. Its triangles take [`Subject::triangle_bytes`].
    pub scene: &'a Scene,
    /// Who looks at it.
    pub camera: ResolvedCamera,
    /// Width and height of the picture in pixels, at least 1.
    pub size: [u32; 2],
    /// Seconds.
    pub t: f64,
    /// What is seen where nothing else is.
    pub background: &'a Background,
    /// Overrides every material; `None`: as the scene has it.
    pub shading: Option<Shading>,
}

impl Subject<'_> {
    /// Memory that its triangles take, those outside the picture too.
    #[must_use]
    pub fn triangle_bytes(&self) -> u64 {
        let triangles = |instance| self.scene.mesh(instance).triangles.len() as u64;
        let count =
            self.scene.visible().map(|(_, instance)| triangles(instance)).fold(0, u64::saturating_add);
        count.saturating_mul(world::TRIANGLE_BYTES)
    }
}

/// How much work a pixel gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Samples of every pixel; at least 2 are taken.
    pub base: u32,
    /// Samples of a pixel whose samples do not agree: at edges, in penumbrae, on detailed textures. A quarter of them
    /// are taken beside edges and penumbrae too.
    pub most: u32,
    /// How much its colour, clamped to 0–1, may be off before that is more samples' worth.
    pub noise: f64,
    /// Where the samples lie.
    pub aim: Aim,
}

/// Where the samples of a pixel lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// All over its square.
    Pixel,
    /// All at its centre: what differs between them is where in a light they look.
    Centre,
}

/// A picture without approximations. Rows run from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear red, green, blue, premultiplied with alpha, and alpha: before `post`, every sample clamped
    /// to 65504.
    pub radiance: Vec<[f64; 4]>,
    /// Samples that were spent on each pixel.
    pub samples: Vec<u32>,
    /// By how much the colours of `radiance`, clamped to 0–1, are off in the root mean square, told from
    /// two independent halves of the samples. No error below it can be claimed.
    pub noise: f64,
    /// Which pixels show what.
    pub masks: Masks,
}

/// Pixels of which something is known, in the order of the picture's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Masks {
    /// Samples see what lies apart: two instances, background, or across a silhouette or a crease.
    pub edges: Vec<bool>,
    /// Some samples see a light that others do not: at the edge of a hard shadow, within a soft one.
    pub penumbrae: Vec<bool>,
    /// What is seen is read from a map, or from a picture of the sky.
    pub textured: Vec<bool>,
}

/// Samples of one task: some hundred microseconds, so that frames do not wait for a reference.
const TASK: usize = 64;

/// Samples of a pixel with a texture, whether they agree or not: of a few, texels agree by chance.
const TEXTURED: u32 = 64;

/// Pixels that need more samples get as many times more, and are drawn anew.
const MORE: u32 = 4;

impl Reference {
    /// Draws `subject`. `progress` is told the share that is done, from several threads. The same machine
    /// gives the same numbers for any number of them.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn draw(
        subject: &Subject,
        effort: Effort,
        progress: &(dyn Fn(f64) + Sync),
        work: &Work,
    ) -> Result<Self, Cancelled> {
        Self::draw_until(subject, effort, None, progress, work)
    }

    /// The same, but that no pixel gets more than [`Effort::base`] samples once the time is up.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn draw_until(
        subject: &Subject,
        effort: Effort,
        until: Option<Instant>,
        progress: &(dyn Fn(f64) + Sync),
        work: &Work,
    ) -> Result<Self, Cancelled> {
        let studio = studio(subject);
        work.check()?;
        let steps = Steps::new(&effort);
        let mut samples = effort.base;
        let all: Vec<usize> = (0..subject.size[0] as usize * subject.size[1] as usize).collect();
        let look = Look { studio: &studio, aim: effort.aim, samples, until: None };
        let drawn = look.at(&all, &|share| progress(steps.share(0, share)), work)?;
        let mut pixels: Vec<Pixel> = drawn.into_iter().map(|pixel| pixel.expect("without an end")).collect();
        for step in 1..steps.count {
            samples = effort.most.min(samples * MORE);
            let again = unsettled(&pixels, subject.size, samples, &effort);
            let look = Look { studio: &studio, aim: effort.aim, samples, until };
            let drawn = look.at(&again, &|share| progress(steps.share(step, share)), work)?;
            for (at, pixel) in again.into_iter().zip(drawn) {
                pixels[at] = pixel.unwrap_or(pixels[at]);
            }
        }
        Ok(Self::of(subject.size, &pixels))
    }

    /// The picture after the effects of `scene`: linear red, green and blue, clamped to 0–1, over white; not encoded.
    #[must_use]
    pub fn finished(&self, scene: &Scene) -> Vec<[f64; 3]> {
        post::apply(&scene.post, self.size, &self.radiance)
    }

    fn of(size: [u32; 2], pixels: &[Pixel]) -> Self {
        let radiance: Vec<[f64; 4]> = pixels.iter().map(|pixel| pixel.radiance).collect();
        let squares: f64 = pixels.iter().map(|pixel| pixel.difference_squared).sum();
        let mask = |of: fn(&Pixel) -> bool| pixels.iter().map(of).collect();
        Self {
            size,
            samples: pixels.iter().map(|pixel| pixel.samples).collect(),
            // The mean of two halves is off by half of what they differ.
            noise: (squares / float(pixels.len())).sqrt() / 2.0,
            masks: Masks {
                edges: mask(|pixel| pixel.is_edge),
                penumbrae: mask(|pixel| pixel.is_penumbra),
                textured: mask(|pixel| pixel.is_textured),
            },
            radiance,
        }
    }
}

fn studio<'a>(subject: &'a Subject<'a>) -> Studio<'a> {
    let scene = subject.scene;
    Studio {
        subject,
        world: World::new(scene, subject.t),
        lighting: Lighting {
            ambient: scene.ambient.as_dvec3(),
            lamps: Lamp::all(scene),
            shading: subject.shading.or(scene.render.shading),
        },
        camera: Camera::new(&subject.camera, subject.size),
    }
}

/// The times that a pixel may be drawn, each with more samples.
struct Steps {
    count: u32,
}

impl Steps {
    fn new(effort: &Effort) -> Self {
        let grown = std::iter::successors(Some(effort.base.max(1)), |n| n.checked_mul(MORE));
        let count = grown.take_while(|samples| *samples < effort.most).count();
        Self { count: 1 + u32::try_from(count).unwrap_or(0) }
    }

    /// The share of the whole that is done with `share` of a step.
    fn share(&self, step: u32, share: f64) -> f64 {
        (f64::from(step) + share) / f64::from(self.count)
    }
}

/// A look at some pixels, with so many samples each.
struct Look<'a> {
    studio: &'a Studio<'a>,
    aim: Aim,
    samples: u32,
    /// What is not begun by then is left.
    until: Option<Instant>,
}

impl Look<'_> {
    /// The pixels of these numbers; `None` for those that the time was not enough for.
    fn at(
        &self,
        numbers: &[usize],
        progress: &(dyn Fn(f64) + Sync),
        work: &Work,
    ) -> Result<Vec<Option<Pixel>>, Cancelled> {
        let done = AtomicUsize::new(0);
        let draw = |task: &[usize]| -> Vec<Option<Pixel>> {
            let is_over = self.until.is_some_and(|until| Instant::now() >= until);
            let pixels = task.iter().map(|&number| (!is_over).then(|| self.pixel(number))).collect();
            let before = done.fetch_add(task.len(), Ordering::Relaxed);
            progress(float(before + task.len()) / float(numbers.len()));
            pixels
        };
        let tasks = numbers.chunks((TASK / self.samples as usize).max(1)).collect();
        let pixels = work.map(tasks, || (), |(), task| draw(task))?;
        Ok(pixels.into_iter().flatten().collect())
    }

    fn pixel(&self, number: usize) -> Pixel {
        let width = self.studio.subject.size[0] as usize;
        #[expect(clippy::cast_possible_truncation, reason = "sides of a picture")]
        let place = [number % width, number / width].map(|place| place as u32);
        pixel::draw(self.studio, place, self.samples, self.aim)
    }
}

/// The pixels that are to get `samples`, those first that need them most: whose samples do not agree well enough, and,
/// up to a quarter of the most, those that show or touch an edge or a penumbra. A few samples may all miss what covers
/// a third of a pixel. Up to [`TEXTURED`], also those that show a texture.
fn unsettled(pixels: &[Pixel], [width, height]: [u32; 2], samples: u32, effort: &Effort) -> Vec<usize> {
    let [width, height] = [width, height].map(|side| side as usize);
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let is_beside_detail = |at: usize| {
        let (mut rows, columns) = (around(at / width, height), around(at % width, width));
        rows.any(|y| pixels[y * width..][columns.clone()].iter().any(|p| p.is_edge || p.is_penumbra))
    };
    let is_coarse = samples <= effort.most / 4;
    let is_unsettled = |&at: &usize| {
        let is_guess = pixels[at].is_textured && samples <= TEXTURED;
        pixels[at].noise > effort.noise || is_guess || is_coarse && is_beside_detail(at)
    };
    let mut again: Vec<usize> = (0..pixels.len()).filter(is_unsettled).collect();
    again.sort_by(|&a, &b| pixels[b].noise.total_cmp(&pixels[a].noise));
    again
}

#[expect(clippy::cast_precision_loss, reason = "a picture has at most 2²⁶ pixels")]
fn float(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests;
