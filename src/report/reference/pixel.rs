//! One pixel: samples over its square, and how far they agree.

use super::background;
use super::bvh::Hit;
use super::camera::Camera;
use super::sequence::Sequence;
use super::shading::{Lighting, View, reads_maps};
use super::world::{Layer, World};
use super::{Aim, Subject};
use glam::{DVec3, DVec4};

/// What all pixels are drawn with.
pub struct Studio<'a> {
    /// What is drawn.
    pub subject: &'a Subject<'a>,
    /// Its triangles.
    pub world: World<'a>,
    /// What shines on them.
    pub lighting: Lighting<'a>,
    /// Who looks.
    pub camera: Camera,
}

/// A finished pixel.
#[derive(Clone, Copy)]
pub struct Pixel {
    /// The mean of its samples, premultiplied.
    pub radiance: [f64; 4],
    /// How many there were.
    pub samples: u32,
    /// How far the mean of its samples may be off.
    pub noise: f64,
    /// Squared difference of its halves' means, clamped to 0–1: the mean of red, green and blue.
    pub difference_squared: f64,
    /// Whether samples saw what lies apart.
    pub is_edge: bool,
    /// Whether a light was seen by some samples and not by others.
    pub is_penumbra: bool,
    /// Whether any of it was read from a map.
    pub is_textured: bool,
}

/// Samples so far.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: f64,
    radiance: DVec4,
    /// Of what a picture can show: the same clamped to 0–1, and its squares.
    shown: DVec4,
    squares: DVec4,
}

/// A pixel under way.
struct Drawing<'a> {
    studio: &'a Studio<'a>,
    place: [u32; 2],
    aim: Aim,
    /// The two halves of its samples are independent of each other.
    sequences: [Sequence; 2],
    halves: [Sum; 2],
    layers: Vec<Layer>,
    /// What the first sample met; `None` before it.
    first: Option<Vec<Hit>>,
    /// For each layer from the front and each light there, whether a sample saw it, and whether one did not.
    seen: Vec<[bool; 2]>,
    is_edge: bool,
    is_textured: bool,
}

/// Draws a pixel with as many samples, two at least.
pub fn draw(studio: &Studio, place: [u32; 2], samples: u32, aim: Aim) -> Pixel {
    let mut drawing = Drawing::new(studio, place, aim);
    // Half of them for each half of the samples.
    drawing.sample((samples / 2).max(1));
    drawing.finish()
}

impl<'a> Drawing<'a> {
    fn new(studio: &'a Studio<'a>, place: [u32; 2], aim: Aim) -> Self {
        Self {
            studio,
            place,
            aim,
            sequences: [Sequence::new(place, 0), Sequence::new(place, 1)],
            halves: [Sum::default(); 2],
            layers: Vec::new(),
            first: None,
            seen: Vec::new(),
            is_edge: false,
            is_textured: false,
        }
    }

    /// Adds so many samples to each half.
    fn sample(&mut self, count: u32) {
        for number in 0..count {
            for half in 0..2 {
                let color = self.look(half, number);
                self.halves[half].add(color);
            }
        }
    }

    /// Premultiplied colour of one sample.
    fn look(&mut self, half: usize, number: u32) -> DVec4 {
        let [x, y] = match self.aim {
            Aim::Pixel => self.sequences[half].point(number, 0),
            Aim::Centre => [0.5; 2],
        };
        let ray = self.studio.camera.ray([f64::from(self.place[0]) + x, f64::from(self.place[1]) + y]);
        let mut layers = std::mem::take(&mut self.layers);
        self.studio.world.see(&ray, &mut layers);
        self.compare(&layers);
        let is_covered = layers.last().is_some_and(|layer| layer.alpha >= 1.0);
        let background = self.studio.subject.background;
        self.is_textured |= !is_covered && background::is_picture(background);
        let behind = if is_covered { [0.0; 4] } else { background::radiance(background, ray.direction) };
        // Source: T. Porter, T. Duff, "Compositing Digital Images", SIGGRAPH 1984.
        let color = layers.iter().enumerate().rev().fold(DVec4::from_array(behind), |behind, (at, layer)| {
            let color = self.shade(at, layer, ray.direction, half, number);
            color.extend(1.0) * layer.alpha + behind * (1.0 - layer.alpha)
        });
        self.layers = layers;
        color
    }

    /// Radiance of the layer that is number `at` from the front towards the viewer.
    fn shade(&mut self, at: usize, layer: &Layer, direction: DVec3, half: usize, number: u32) -> DVec3 {
        let Studio { world, lighting, camera, .. } = self.studio;
        let point = world.point(&layer.hit);
        self.is_textured |= reads_maps(point.material, lighting.shading_of(point.material));
        let is_back = point.geometric.dot(direction) > 0.0;
        let view = View { point: &point, towards: camera.towards_viewer(point.position), is_back };
        let lamps = lighting.lamps.len();
        self.seen.resize(self.seen.len().max((at + 1) * lamps), [false; 2]);
        let (sequence, seen) = (self.sequences[half], &mut self.seen[at * lamps..]);
        lighting.radiance(&view, &mut |lamp| {
            let pair = u32::try_from(lamp).map_or(u32::MAX, |lamp| lamp + 1);
            let is_seen = lighting.lamps[lamp].is_seen(world, &point, sequence.point(number, pair));
            seen[lamp][usize::from(is_seen == Some(false))] |= is_seen.is_some();
            is_seen.unwrap_or(true)
        })
    }

    /// Notes whether what a sample sees lies apart from what the first one saw.
    fn compare(&mut self, layers: &[Layer]) {
        let hits = layers.iter().map(|layer| layer.hit);
        let Some(first) = &self.first else {
            self.first = Some(hits.collect());
            return;
        };
        let world = &self.studio.world;
        self.is_edge = self.is_edge
            || first.len() != layers.len()
            || first.iter().zip(hits).any(|(first, hit)| world.are_apart(first, &hit));
    }

    /// How far the mean of all samples may be off, in the channel where that is most.
    ///
    /// The difference of the halves alone would be 0 by chance now and then; the spread of the samples
    /// is not. Over an edge, low-discrepancy points err by about `spread / n^¾` (D. Mitchell,
    /// "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996).
    fn noise(&self) -> f64 {
        let [a, b] = self.halves;
        let count = a.count + b.count;
        let mean = (a.shown + b.shown) / count;
        let spread = ((a.squares + b.squares) / count - mean * mean).max(DVec4::ZERO).max_element().sqrt();
        let difference = (a.shown / a.count - b.shown / b.count).abs().max_element();
        (difference / 2.0).max(spread / count.powf(0.75))
    }

    fn finish(self) -> Pixel {
        let noise = self.noise();
        let [a, b] = self.halves;
        let count = a.count + b.count;
        let shown = |half: Sum| (half.radiance / half.count).truncate().clamp(DVec3::ZERO, DVec3::ONE);
        Pixel {
            radiance: ((a.radiance + b.radiance) / count).to_array(),
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counted in u32")]
            samples: count as u32,
            noise,
            difference_squared: (shown(a) - shown(b)).length_squared() / 3.0,
            is_edge: self.is_edge,
            is_penumbra: self.seen.contains(&[true; 2]),
            is_textured: self.is_textured,
        }
    }
}

impl Sum {
    fn add(&mut self, color: DVec4) {
        let shown = color.clamp(DVec4::ZERO, DVec4::ONE);
        self.count += 1.0;
        self.radiance += color;
        self.shown += shown;
        self.squares += shown * shown;
    }
}
