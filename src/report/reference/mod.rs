//! What pictures are measured against: a ray caster in f64 that shares no code with the pipeline.
//!
//! In: a compiled scene and a settled camera. Out: radiance, the picture after its effects in linear
//! light, and how much of both is noise. It reads like the textbook, and takes its time.
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
    /// Linear red, green and blue after `post`, clamped to 0–1, over white; not encoded.
    pub color: Vec<[f64; 3]>,
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

/// Pixels of one task: a few milliseconds at some hundred samples.
const TASK: usize = 8;

/// The part of the work that the first look at every pixel is told to be.
const FIRST_LOOK: f64 = 0.7;

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
        let studio = studio(subject);
        let [width, height] = subject.size;
        let places: Vec<[u32; 2]> = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).collect();
        let tell = |share: f64| progress(FIRST_LOOK * share);
        let mut pixels = draw_pixels(&studio, &places, effort, &tell, work)?;
        // A few samples may all miss what covers a third of a pixel; what lies beside something is looked at again.
        let closer = Effort { base: effort.base.max(effort.most / 4), ..effort };
        let again = beside_detail(&pixels, subject.size, closer.base);
        let again_places: Vec<[u32; 2]> = again.iter().map(|&at| places[at]).collect();
        let tell = |share: f64| progress(FIRST_LOOK + (1.0 - FIRST_LOOK) * share);
        let closer = draw_pixels(&studio, &again_places, closer, &tell, work)?;
        again.into_iter().zip(closer).for_each(|(at, pixel)| pixels[at] = pixel);
        Ok(Self::of(subject, &pixels))
    }

    fn of(subject: &Subject, pixels: &[Pixel]) -> Self {
        let radiance: Vec<[f64; 4]> = pixels.iter().map(|pixel| pixel.radiance).collect();
        let squares: f64 = pixels.iter().map(|pixel| pixel.difference_squared).sum();
        let mask = |of: fn(&Pixel) -> bool| pixels.iter().map(of).collect();
        Self {
            size: subject.size,
            color: post::apply(&subject.scene.post, subject.size, &radiance),
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

/// Draws the pixels at `places`.
fn draw_pixels(
    studio: &Studio,
    places: &[[u32; 2]],
    effort: Effort,
    progress: &(dyn Fn(f64) + Sync),
    work: &Work,
) -> Result<Vec<Pixel>, Cancelled> {
    let done = AtomicUsize::new(0);
    let draw = |task: &[[u32; 2]]| -> Vec<Pixel> {
        let pixels = task.iter().map(|&place| pixel::draw(studio, place, effort)).collect();
        let before = done.fetch_add(task.len(), Ordering::Relaxed);
        progress(float(before + task.len()) / float(places.len()));
        pixels
    };
    let tasks = places.chunks(TASK).collect();
    let pixels = work.map(tasks, || (), |(), task| draw(task))?;
    Ok(pixels.into_iter().flatten().collect())
}

/// Indices of the pixels with fewer than `samples` that show or touch an edge or a penumbra.
fn beside_detail(pixels: &[Pixel], [width, height]: [u32; 2], samples: u32) -> Vec<usize> {
    let [width, height] = [width, height].map(|side| side as usize);
    let around = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let has_detail = |at: usize| {
        let (mut rows, columns) = (around(at / width, height), around(at % width, width));
        rows.any(|y| pixels[y * width..][columns.clone()].iter().any(|p| p.is_edge || p.is_penumbra))
    };
    (0..pixels.len()).filter(|&at| pixels[at].samples < samples && has_detail(at)).collect()
}

#[expect(clippy::cast_precision_loss, reason = "a picture has at most 2²⁶ pixels")]
fn float(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests;
