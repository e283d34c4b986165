//! Normal and bump maps against closed forms, on what `output=normal` shows.

use crate::closed_form::{Camera, EIGHT, Ray, hit_plane, hit_sphere};
use crate::draw::{Picture, file, frame, output, png, scene_with};
use crate::measure::{Worst, at_most};
use glam::{DMat3, DVec2, DVec3};
use rasterd::plan::{FrameRequest, Output};
use rasterd::scene::Files;
use serde_json::{Value, json};

/// What a normal map's texel says.
fn decoded(texel: [u8; 3]) -> DVec3 {
    DVec3::from_array(texel.map(|code| ((f64::from(code) - 128.0) / 127.0).max(-1.0)))
}

/// A slanted normal map of one texel: to the right and a little down.
const SLANTED: [u8; 3] = [200, 90, 220];

fn slanted() -> Files {
    file("map.png", png(1, 1, |_, _| [SLANTED[0], SLANTED[1], SLANTED[2], 255]))
}

/// Heights that rise steadily to the right and half as much upwards, from their lower left corner.
fn ramp() -> Files {
    let height = |x: u32, y: u32| u8::try_from(2 * x + 63 - y).expect("at most 189");
    file("map.png", png(64, 64, |x, y| [height(x, y), 0, 0, 255]))
}

/// Slopes of [`ramp`] in heights a unit of u and v.
const RAMP: DVec2 = DVec2::new(2.0 * 64.0 / 255.0, 64.0 / 255.0);

/// A mesh whose placement is `rotation` (degrees about y) after `scale`.
pub fn document(camera: &Camera, mesh: Value, material: Value, scale: DVec3, rotation: f64) -> Value {
    json!({
        "camera": camera.document(),
        "lights": {},
        "environment": { "background": { "type": "color", "color": "#000" } },
        "textures": { "map": { "file": "map.png", "wrap": "clamp" } },
        "materials": { "m": material },
        "meshes": { "mesh": mesh },
        "instances": { "one": { "mesh": "mesh", "material": "m", "scale": scale.to_array(), "rotation_deg": [0, rotation, 0] } },
        "render": camera.render(1),
    })
}

fn placement(scale: DVec3, rotation: f64) -> DMat3 {
    DMat3::from_rotation_y(rotation.to_radians()) * DMat3::from_diagonal(scale)
}

/// A point of a surface in model space: its normal, ∂P/∂u and ∂P/∂v.
pub struct Point {
    normal: DVec3,
    along_u: DVec3,
    along_v: DVec3,
}

impl Point {
    /// In world space.
    fn placed(&self, linear: DMat3) -> Self {
        let inverse = linear.inverse().transpose();
        Self {
            normal: (inverse * self.normal).normalize(),
            along_u: linear * self.along_u,
            along_v: linear * self.along_v,
        }
    }

    /// The normal that a normal map's vector stands for: the tangent along u in the plane of the normal,
    /// the bitangent on the side of v.
    fn mapped(&self, vector: DVec3) -> DVec3 {
        let n = self.normal;
        let tangent = (self.along_u - n * n.dot(self.along_u)).normalize();
        let side = n.cross(tangent).dot(self.along_v).signum();
        (tangent * vector.x + n.cross(tangent) * side * vector.y + n * vector.z).normalize()
    }

    /// The normal of the surface raised by heights of these slopes: `n − g`, where the gradient g in
    /// the surface has `g · ∂P/∂u = ∂h/∂u` and the same for v.
    fn raised(&self, slopes: DVec2) -> DVec3 {
        let rows = DMat3::from_cols(self.along_u, self.along_v, self.normal).transpose();
        (self.normal - rows.inverse() * slopes.extend(0.0)).normalize()
    }
}

/// Compares what `output=normal` shows with what is expected where a line of sight in model space meets
/// the surface; a back shows its front's normal turned round.
fn compare(
    case: &str,
    camera: &Camera,
    drawn: (&Value, &Files),
    linear: DMat3,
    bound: f64,
    hit: impl Fn(Ray) -> Option<(Point, DVec3)>,
    expected: impl Fn(&Point) -> DVec3,
) {
    let picture = Picture::new(frame(&scene_with(drawn.0, drawn.1), &output(Output::Normal)));
    let inverse = linear.inverse();
    let in_model = |ray: Ray| Ray { origin: inverse * ray.origin, direction: inverse * ray.direction };
    let (mut worst, mut checked) = (Worst::default(), 0);
    for (x, y, pixel) in picture.iter() {
        let around = EIGHT.iter().all(|[dx, dy]| {
            hit(in_model(camera.ray(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy))).is_some()
        });
        let ray = camera.centre(x, y);
        let Some((point, place)) = hit(in_model(ray)).filter(|_| around) else { continue };
        let point = point.placed(linear);
        let seen_from = ray.origin - linear * place;
        let normal = expected(&point) * point.normal.dot(seen_from).signum();
        for c in 0..3 {
            worst.note((f64::from(pixel[c]) - 255.0 * (normal[c] / 2.0 + 0.5)).abs());
        }
        checked += 1;
    }
    assert!(checked > 500, "{case}: only {checked} pixels were looked at");
    at_most(case, &format!("largest difference in codes of {checked}"), worst.largest(), bound);
}

/// The floor between ±1, well inside its texture.
pub fn floor(ray: Ray) -> Option<(Point, DVec3)> {
    let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y)?);
    let point = Point { normal: DVec3::Y, along_u: DVec3::X * 2.0, along_v: DVec3::NEG_Z * 2.0 };
    (p.x.abs() < 0.9 && p.z.abs() < 0.9).then_some((point, p))
}

/// A sphere of radius ½ between its poles and off its seam.
fn ball(ray: Ray) -> Option<(Point, DVec3)> {
    let p = ray.at(hit_sphere(ray, DVec3::ZERO, 0.5)?);
    let n = p.normalize();
    let (tau, pi) = (std::f64::consts::TAU, std::f64::consts::PI);
    let point = Point {
        normal: n,
        along_u: DVec3::Y.cross(p) * tau,
        // Half a turn from pole to pole.
        along_v: (DVec3::Y - n * n.y).normalize() * 0.5 * pi,
    };
    let (u, v) = (n.x.atan2(n.z) / tau + 0.5, n.y.asin() / pi + 0.5);
    let inside = (0.1..0.9).contains(&u) && (0.15..0.85).contains(&v);
    // At grazing angles the facets of the mesh lie visibly inside the sphere.
    (inside && n.dot(-ray.direction.normalize()) > 0.3).then_some((point, p))
}

fn ball_mesh() -> Value {
    json!({ "type": "sphere", "segments": 384, "rings": 192 })
}

/// Scales, and a turn about y, mirrored ones among them.
const PLACEMENTS: [(DVec3, f64); 4] = [
    (DVec3::ONE, 0.0),
    (DVec3::new(1.0, 0.6, 1.4), 30.0),
    (DVec3::new(-1.0, 1.0, 1.0), -20.0),
    (DVec3::new(0.8, -1.2, 1.0), 20.0),
];

fn cameras() -> [Camera; 2] {
    [
        Camera::perspective([0.5, 1.6, 2.0], [0.0, 0.0, 0.0], 50.0, 120, 90),
        Camera::orthographic([0.4, -1.1, 1.5], [0.0, 0.0, 0.0], 2.2, 120, 90),
    ]
}

#[test]
fn a_normal_map_lies_along_u_and_v_under_every_placement() {
    let material = json!({ "normal_map": "map", "double_sided": true });
    let files = slanted();
    for camera in cameras() {
        for (scale, rotation) in PLACEMENTS {
            let linear = placement(scale, rotation);
            let mapped = |point: &Point| point.mapped(decoded(SLANTED));
            let case = format!("scale {scale} turned {rotation}, from {}", camera.eye);
            let plane = document(
                &camera,
                json!({ "type": "plane", "size": [2, 2] }),
                material.clone(),
                scale,
                rotation,
            );
            compare(
                &format!("normal map on a floor, {case}"),
                &camera,
                (&plane, &files),
                linear,
                0.51,
                floor,
                mapped,
            );
            // The facets shift the point that is seen by up to 2·10⁻⁵.
            let round = document(&camera, ball_mesh(), material.clone(), scale, rotation);
            compare(
                &format!("normal map on a ball, {case}"),
                &camera,
                (&round, &files),
                linear,
                0.6,
                ball,
                mapped,
            );
        }
    }
}

#[test]
fn a_bump_map_rises_in_world_units_under_every_placement() {
    let files = ramp();
    for camera in cameras() {
        for (scale, rotation) in PLACEMENTS {
            for height in [0.7, -0.3] {
                let material = json!({ "bump_map": "map", "bump_scale": height, "double_sided": true });
                let linear = placement(scale, rotation);
                let raised = |point: &Point| point.raised(RAMP * height);
                let case = format!("of {height}, scale {scale} turned {rotation}, from {}", camera.eye);
                let plane = document(
                    &camera,
                    json!({ "type": "plane", "size": [2, 2] }),
                    material.clone(),
                    scale,
                    rotation,
                );
                compare(
                    &format!("heights on a floor {case}"),
                    &camera,
                    (&plane, &files),
                    linear,
                    0.51,
                    floor,
                    raised,
                );
                let round = document(&camera, ball_mesh(), material, scale, rotation);
                compare(
                    &format!("heights on a ball {case}"),
                    &camera,
                    (&round, &files),
                    linear,
                    0.75,
                    ball,
                    raised,
                );
            }
        }
    }
}

/// A square in z = 0 whose texture is sheared, or mirrored.
#[test]
fn sheared_and_mirrored_coordinates_keep_their_relief() {
    let camera = Camera::perspective([0.3, 0.4, 2.2], [0.0, 0.0, 0.0], 50.0, 100, 80);
    for shear in [[1.0, 0.0, 0.0, 1.0], [1.0, 0.4, 0.1, 0.8], [-1.0, 0.2, 0.0, 0.7], [0.0, 1.0, 1.0, 0.0]] {
        // (u, v) = ½ + A (x, y) / 4, well inside the unit square.
        let [a, b, c, d] = shear;
        let uv = |x: f64, y: f64| [0.5 + (a * x + b * y) / 4.0, 0.5 + (c * x + d * y) / 4.0];
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mesh = json!({ "type": "triangles", "indices": [[0, 1, 2], [0, 2, 3]],
            "positions": corners.map(|[x, y]| [x, y, 0.0]), "uvs": corners.map(|[x, y]| uv(x, y)) });
        // The columns of the inverse are ∂P/∂u and ∂P/∂v.
        let det = (a * d - b * c) / 4.0;
        let hit = |ray: Ray| {
            let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Z)?);
            let point = Point {
                normal: DVec3::Z,
                along_u: DVec3::new(d, -c, 0.0) / det,
                along_v: DVec3::new(-b, a, 0.0) / det,
            };
            (p.abs().max_element() < 0.9).then_some((point, p))
        };
        let draw = |material: Value| document(&camera, mesh.clone(), material, DVec3::ONE, 0.0);
        let mapped = draw(json!({ "normal_map": "map" }));
        let identity = DMat3::IDENTITY;
        compare(
            &format!("normal map sheared by {shear:?}"),
            &camera,
            (&mapped, &slanted()),
            identity,
            0.51,
            hit,
            |p| p.mapped(decoded(SLANTED)),
        );
        let raised = draw(json!({ "bump_map": "map", "bump_scale": 2 }));
        compare(
            &format!("heights sheared by {shear:?}"),
            &camera,
            (&raised, &ramp()),
            identity,
            0.51,
            hit,
            |p| p.raised(RAMP * 2.0),
        );
    }
}

#[test]
fn heights_lie_on_top_of_a_normal_map() {
    let camera = cameras()[0];
    let mut document = document(
        &camera,
        json!({ "type": "plane", "size": [2, 2] }),
        json!({ "normal_map": "slant", "bump_map": "map", "bump_scale": 0.5 }),
        DVec3::ONE,
        0.0,
    );
    document["textures"]["slant"] = json!({ "file": "slant.png" });
    let mut files = ramp();
    let slant = png(1, 1, |_, _| [SLANTED[0], SLANTED[1], SLANTED[2], 255]);
    files.insert("slant.png", slant.into()).expect("a sound name");
    compare("both maps", &camera, (&document, &files), DMat3::IDENTITY, 0.51, floor, |point| {
        let normal = point.mapped(decoded(SLANTED));
        // Along the directions that u and v have on the slanted surface.
        let on = |v: DVec3| (v - normal * normal.dot(v)).normalize() * v.length();
        Point { normal, along_u: on(point.along_u), along_v: on(point.along_v) }.raised(RAMP * 0.5)
    });
}

#[test]
fn a_shadow_falls_where_it_falls_without_a_map() {
    let camera = Camera::perspective([0.0, 2.0, 1.5], [0.0, 0.0, 0.0], 50.0, 100, 80);
    let mut plain = document(
        &camera,
        json!({ "type": "plane", "size": [2, 2] }),
        json!({ "ambient": [0, 0, 0] }),
        DVec3::ONE,
        0.0,
    );
    plain["lights"] = json!({ "sun": { "type": "directional", "direction": [-0.4, -1, -0.2], "shadow": { "filter": "hard" } } });
    plain["meshes"]["ball"] = json!({ "type": "sphere", "radius": 0.3 });
    plain["materials"]["dark"] = json!({ "diffuse": [0, 0, 0], "ambient": [0, 0, 0] });
    plain["instances"]["ball"] = json!({ "mesh": "ball", "material": "dark", "translation": [0.3, 0.5, 0] });
    let draw =
        |document: &Value| Picture::new(frame(&scene_with(document, &slanted()), &FrameRequest::default()));
    let dark = |picture: &Picture| picture.pixels.iter().map(|pixel| pixel[0] == 0).collect::<Vec<_>>();
    let mut mapped = plain.clone();
    mapped["materials"]["m"]["normal_map"] = json!("map");
    let (plain, mapped) = (draw(&plain), draw(&mapped));
    assert!(plain != mapped);
    assert!(dark(&plain).iter().filter(|dark| **dark).count() > 300);
    assert_eq!(dark(&plain), dark(&mapped));
}
