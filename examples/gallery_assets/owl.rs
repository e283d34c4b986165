//! An owl: sculpted, feathered in its normal map, painted. It is 1 unit tall and looks along +z.

use crate::obj::{Obj, curve};
use crate::paint::{self, Color, blend, shade};
use crate::sculpt::{Axis, ball, carve, ellipsoid, join, limb};
use glam::{DVec2, DVec3, dvec3};
use rasterd::scene::demo::noise::{Noise, random, smoothstep};
use std::f64::consts::TAU;

/// Steps of the skin around and from below to above.
const STEPS: [u32; 2] = [56, 56];
/// Texels of its maps.
const SIZE: [u32; 2] = [896, 640];
/// Where the right eye is; the left one mirrors it.
const EYE: DVec3 = dvec3(0.098, 0.765, 0.166);
const EYE_RADIUS: f64 = 0.066;

const AXIS: Axis = Axis { from: dvec3(0.0, 0.3, 0.0), to: dvec3(0.0, 0.74, 0.0), reach: 0.6 };

fn mirrored(p: DVec3) -> DVec3 {
    dvec3(p.x.abs(), p.y, p.z)
}

/// Distance to the owl without eyes, beak and feet.
fn sculpture(p: DVec3) -> f64 {
    let side = mirrored(p);
    let body = ellipsoid(p, dvec3(0.0, 0.36, 0.0), dvec3(0.245, 0.36, 0.225));
    let head = ellipsoid(p, dvec3(0.0, 0.765, 0.015), dvec3(0.255, 0.185, 0.2));
    let trunk = join(body, head, 0.12);
    let tuft = limb(side, (dvec3(0.14, 0.86, 0.02), 0.065), (dvec3(0.215, 0.99, -0.005), 0.016));
    let owl = join(trunk, tuft, 0.07);
    let wing = ellipsoid(side, dvec3(0.212, 0.37, -0.03), dvec3(0.075, 0.285, 0.165));
    let owl = join(owl, wing, 0.02);
    let tail = ellipsoid(p, dvec3(0.0, 0.1, -0.2), dvec3(0.11, 0.17, 0.06));
    let owl = join(owl, tail, 0.05);
    let disc = ellipsoid(side, dvec3(0.1, 0.765, 0.285), dvec3(0.118, 0.125, 0.1));
    let owl = carve(owl, disc, 0.03);
    // It sits: the underside is flat.
    owl.max(0.03 - p.y)
}

fn skin(u: f64, v: f64) -> DVec3 {
    AXIS.skin(u, v, sculpture)
}

/// The whole model.
pub fn model() -> Vec<u8> {
    let mut obj = Obj::textured().with_library("owl.mtl");
    obj.material("plumage").surface(STEPS, DVec2::ONE, skin);
    obj.material("eye");
    for side in [-1.0, 1.0] {
        let centre = dvec3(side * EYE.x, EYE.y, EYE.z);
        let look = dvec3(side * 0.22, 0.0, 1.0).normalize();
        obj.surface([28, 12], DVec2::ONE, |u, v| centre + eyeball(u, v, look) * EYE_RADIUS);
    }
    obj.material("horn");
    beak(&mut obj);
    for (side, toe) in [-1.0, 1.0].into_iter().flat_map(|side| [-1.0, 0.0, 1.0].map(|toe| (side, toe))) {
        let centre = dvec3(side * 0.1 + toe * 0.042, 0.026, 0.205 - 0.02 * toe * toe);
        obj.surface([10, 8], DVec2::ONE, |u, v| centre + ball_point(u, v) * dvec3(0.024, 0.026, 0.062));
    }
    obj.to_bytes()
}

/// A point of the unit ball: u around from the back, v from below to above.
fn ball_point(u: f64, v: f64) -> DVec3 {
    let (angle, pitch) = (TAU * (u - 0.5), TAU / 2.0 * (v - 0.5));
    let level = libm::cos(pitch);
    dvec3(level * libm::sin(angle), libm::sin(pitch), level * libm::cos(angle))
}

/// A point of the unit ball whose upper pole looks along `look`, so that v alone says where in the eye
/// it is.
fn eyeball(u: f64, v: f64, look: DVec3) -> DVec3 {
    let p = ball_point(u, v);
    let right = DVec3::Y.cross(look).normalize();
    right * p.x + look * p.y + right.cross(look) * p.z
}

/// A hooked cone between the eyes.
fn beak(obj: &mut Obj) {
    let line = curve(&[[0.215, 0.765], [0.262, 0.735], [0.268, 0.69], [0.246, 0.652]], 4);
    let last = u32::try_from(line.len() - 1).expect("invariant: a short line");
    let radius = |v: f64| 0.034 * (1.0 - v).max(0.0).sqrt() * (0.75 + 0.25 * (1.0 - v));
    obj.surface([14, last], DVec2::ONE, |u, v| {
        #[expect(clippy::cast_possible_truncation, reason = "1 − v is a row of the line over their number")]
        let at = line[((1.0 - v) * f64::from(last)).round() as usize];
        let angle = TAU * (u - 0.5);
        let r = radius(1.0 - v);
        dvec3(r * libm::sin(angle), at.y + 0.35 * r * libm::cos(angle), at.x + 0.9 * r * libm::cos(angle))
    });
}

/// The material library.
pub const LIBRARY: &str = "# Written by examples/gallery_assets
newmtl plumage
Kd 1 1 1
map_Kd owl.jpg
Ks 0.5 0.47 0.42
map_Ks owl-specular.jpg
Ns 26
norm owl-normal.jpg
newmtl eye
Kd 1 1 1
map_Kd owl-eye.png
Ks 1 1 1
Ns 180
newmtl horn
Kd 0.16 0.12 0.08
Ks 0.35 0.33 0.3
Ns 50
";

/// A place on the plumage: the topmost feather there.
#[derive(Clone, Copy, Debug)]
struct Feather {
    /// Its random number, 0–1.
    id: f64,
    /// From −1 at its left border over 0 at its shaft to 1.
    across: f64,
    /// From 0 at its tip upwards, in lengths of the visible part.
    along: f64,
}

/// Feathers lie in rows like tiles, every second row shifted by half a feather, and hang down.
fn feather(u: f64, v: f64, columns: f64, rows: f64) -> Feather {
    let y = v * rows;
    // A tip reaches down over the row below by as much as a row is high: look at two rows.
    let of_row = |row: f64| {
        let shift = if row.rem_euclid(2.0) < 0.5 { 0.0 } else { 0.5 };
        let x = u * columns + shift;
        let across = 2.0 * (x - x.floor()) - 1.0;
        let tip = row - 0.05 - 0.85 * (1.0 - across * across).sqrt();
        let column = x.floor().rem_euclid(columns);
        let number = |x: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a few dozen rows and columns"
            )]
            let number = x.max(0.0) as u32;
            number
        };
        let id = random(number(column), number(row + 1.0), 7);
        Feather { id, across, along: y - tip }
    };
    let upper = of_row(y.floor() + 1.0);
    if upper.along > 0.0 { upper } else { of_row(y.floor()) }
}

/// What grows where.
#[derive(Clone, Copy, Debug)]
struct Region {
    /// In the facial discs, 0–1.
    face: f64,
    /// On the breast, 0–1.
    breast: f64,
    /// On the wings, 0–1.
    wing: f64,
}

fn region(p: DVec3) -> Region {
    let side = mirrored(p);
    let disc = ball(side, dvec3(0.1, 0.765, 0.2), 0.0);
    let face = (1.0 - smoothstep(0.115, 0.13, disc)) * smoothstep(0.06, 0.1, p.z);
    let wing =
        smoothstep(0.0, 0.02, 0.012 - ellipsoid(side, dvec3(0.212, 0.37, -0.03), dvec3(0.08, 0.29, 0.17)));
    let breast = smoothstep(0.02, 0.1, p.z) * (1.0 - smoothstep(0.56, 0.66, p.y)) * (1.0 - wing);
    Region { face, breast, wing }
}

/// The feather at a place: large ones on the wings.
fn plume(u: f64, v: f64, region: Region) -> Feather {
    if region.wing > 0.5 { feather(u, v, 30.0, 22.0) } else { feather(u, v, 44.0, 40.0) }
}

/// How far the skin's cover stands out, in units of the model.
fn height(u: f64, v: f64, p: DVec3) -> f64 {
    let region = region(p);
    let f = plume(u, v, region);
    let tile = (1.0 - 0.75 * f.along.clamp(0.0, 1.3)) * smoothstep(0.0, 0.1, f.along);
    let arch = 1.0 - 0.5 * f.across * f.across;
    let shaft = 1.0 - smoothstep(0.0, 0.12, f.across.abs());
    let barbs = libm::sin(TAU * (5.0 * f.across.abs() + 3.0 * f.along));
    let size = if region.wing > 0.5 { 0.011 } else { 0.0065 };
    let plumage = size * (tile * arch + 0.16 * shaft + 0.06 * barbs);
    let rays = 0.0012 * libm::sin(46.0 * libm::atan2(p.y - EYE.y, p.x.abs() - EYE.x));
    plumage + (rays - plumage) * region.face
}

/// Feathers as a normal map.
pub fn normal_map() -> Vec<u8> {
    let step = DVec2::new(1.0 / f64::from(SIZE[0]), 1.0 / f64::from(SIZE[1])) * 0.75;
    paint::normal_map(SIZE, 80, |u, v| {
        let side = |du: f64, dv: f64| {
            let (u, v) = ((u + du).rem_euclid(1.0), (v + dv).clamp(0.0, 1.0));
            let p = skin(u, v);
            (p, height(u, v, p))
        };
        let slope = |(a, low): (DVec3, f64), (b, high): (DVec3, f64)| (high - low) / a.distance(b).max(1e-3);
        // At the poles all directions meet: what would be drawn there is noise.
        let calm = smoothstep(0.0, 0.08, v) * (1.0 - smoothstep(0.95, 1.0, v));
        let along_u = slope(side(-step.x, 0.0), side(step.x, 0.0));
        let along_v = slope(side(0.0, -step.y), side(0.0, step.y));
        [along_u * calm, along_v * calm].map(|slope| slope.clamp(-1.6, 1.6))
    })
}

/// Its colours.
pub fn colors() -> Vec<u8> {
    let tone = Noise::new([24, 16], 3, 3);
    paint::jpeg(SIZE, 84, |u, v| {
        let p = skin(u, v);
        let region = region(p);
        let f = plume(u, v, region);
        let color = plumage(region, f, tone.at(u, v));
        blend(color, face(p), region.face)
    })
}

fn plumage(region: Region, f: Feather, tone: f64) -> Color {
    const BROWN: Color = [140.0, 98.0, 60.0];
    const DARK: Color = [66.0, 42.0, 27.0];
    const CREAM: Color = [240.0, 222.0, 188.0];
    const TAWNY: Color = [196.0, 142.0, 86.0];
    let tip = 1.0 - smoothstep(0.05, 0.3, f.along);
    let back = blend(blend(BROWN, DARK, 0.6 * f.id), TAWNY, 0.75 * tip);
    let bar = smoothstep(0.35, 0.5, f.along) * (1.0 - smoothstep(0.62, 0.8, f.along));
    let wing = blend(blend(DARK, BROWN, 0.5 + 0.5 * f.id), CREAM, 0.75 * bar * f.across.abs());
    // A dark drop along the shaft.
    let drop = 1.0 - smoothstep(0.1, 0.34, f.across.abs() + 0.5 * (f.along - 0.45).abs());
    let breast = blend(CREAM, BROWN, if f.id < 0.75 { 0.8 * drop } else { 0.0 });
    let color = blend(blend(back, breast, region.breast), wing, region.wing);
    let edge = 0.72 + 0.28 * smoothstep(0.0, 0.14, f.along);
    shade(color, edge * (0.88 + 0.26 * tone) * (0.94 + 0.12 * f.id))
}

/// Pale discs with rings around the eyes and a dark rim.
fn face(p: DVec3) -> Color {
    const PALE: Color = [244.0, 230.0, 204.0];
    const RING: Color = [176.0, 122.0, 76.0];
    const RIM: Color = [70.0, 45.0, 30.0];
    let d = ball(mirrored(p), dvec3(0.1, 0.765, 0.2), 0.0);
    let rays = 0.5 + 0.5 * libm::sin(46.0 * libm::atan2(p.y - EYE.y, p.x.abs() - EYE.x));
    let color = blend(RING, PALE, smoothstep(0.06, 0.092, d) * (0.86 + 0.14 * rays));
    let brow = smoothstep(0.0, 0.02, p.x.abs()) + smoothstep(0.79, 0.82, p.y);
    blend(color, RIM, smoothstep(0.104, 0.118, d) * brow.min(1.0))
}

/// How glossy it is, 0–1: most where feathers are large and clean, least in the face.
pub fn specular_map() -> Vec<u8> {
    paint::grey_jpeg(SIZE.map(|side| side / 2), 80, |u, v| {
        let p = skin(u, v);
        let region = region(p);
        let f = plume(u, v, region);
        let shaft = 1.0 - smoothstep(0.05, 0.2, f.across.abs());
        let gloss = 0.16 + 0.5 * region.wing + 0.12 * f.id + 0.2 * shaft;
        gloss * (1.0 - region.face) * smoothstep(0.02, 0.2, f.along)
    })
}

/// An eye from its back (below) to its pupil (above): the image is a few texels wide.
pub fn eye() -> Vec<u8> {
    const PUPIL: Color = [8.0, 6.0, 6.0];
    const AMBER: Color = [244.0, 162.0, 24.0];
    const DEEP: Color = [170.0, 84.0, 10.0];
    const LID: Color = [26.0, 17.0, 12.0];
    paint::cutout([8, 128], |_, v| {
        let from_pole = 1.0 - v;
        let iris = blend(DEEP, AMBER, smoothstep(0.17, 0.26, from_pole));
        let iris = blend(iris, LID, smoothstep(0.36, 0.39, from_pole));
        (blend(PUPIL, iris, smoothstep(0.15, 0.165, from_pole)), 1.0)
    })
}
