//! Shading against the formulas of the wire contract.

use crate::closed_form::{
    Camera, Incoming, Lens, Ray, Surface, blinn_phong, codes_apart, hit_plane, hit_sphere,
};
use crate::draw::{Picture, frame, output, scene};
use crate::measure::{Worst, at_most};
use glam::DVec3;
use rasterd::plan::Output;
use serde_json::{Value, json};

/// Largest difference to the formulas, in codes: half a code of rounding and the interpolation of
/// normals.
const BOUND: f64 = 1.6;

const SURFACE: Surface = Surface {
    diffuse: DVec3::new(0.5, 0.3, 0.2),
    specular: DVec3::new(0.3, 0.35, 0.4),
    shininess: 32.0,
    ambient: DVec3::new(0.5, 0.3, 0.2),
    emissive: DVec3::new(0.02, 0.0, 0.01),
};
const AMBIENT: DVec3 = DVec3::new(0.05, 0.06, 0.07);
const LAMP: DVec3 = DVec3::new(1.0, 1.6, 0.7);
const LAMP_RADIANCE: DVec3 = DVec3::new(2.0, 1.6, 1.2);
const FALLOFF: [f64; 3] = [0.8, 0.1, 0.5];
const SUN: DVec3 = DVec3::new(-0.3, -1.0, -0.4);
const SUN_RADIANCE: DVec3 = DVec3::new(0.3, 0.4, 0.5);

/// A point light without a shadow.
fn lamp() -> Value {
    let [constant, linear, quadratic] = FALLOFF;
    json!({
        "type": "point", "position": LAMP.to_array(), "color": (LAMP_RADIANCE / 2.0).to_array(), "intensity": 2,
        "attenuation": { "constant": constant, "linear": linear, "quadratic": quadratic },
    })
}

/// A directional light without a shadow.
fn sun() -> Value {
    json!({ "type": "directional", "direction": SUN.to_array(), "color": SUN_RADIANCE.to_array() })
}

/// One mesh under `lights`.
fn document(camera: &Camera, mesh: Value, lights: Value) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "ambient": AMBIENT.to_array(), "background": { "type": "color", "color": "#000" } },
        "lights": lights,
        "materials": { "stuff": {
            "diffuse": SURFACE.diffuse.to_array(), "specular": SURFACE.specular.to_array(),
            "shininess": SURFACE.shininess, "emissive": SURFACE.emissive.to_array(), "double_sided": true,
        } },
        "meshes": { "mesh": mesh },
        "instances": { "one": { "mesh": "mesh", "material": "stuff" } },
        "render": camera.render(1),
    })
}

/// Position and normal that a line of sight meets.
type Hit = fn(Ray) -> Option<(DVec3, DVec3)>;

fn plane(ray: Ray) -> Option<(DVec3, DVec3)> {
    let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y)?);
    (p.x.abs() < 3.0 && p.z.abs() < 3.0).then_some((p, DVec3::Y))
}

fn sphere(ray: Ray) -> Option<(DVec3, DVec3)> {
    let p = ray.at(hit_sphere(ray, DVec3::ZERO, 0.8)?);
    // At grazing angles the facets of the mesh lie visibly inside the sphere.
    (p.normalize().dot(-ray.direction.normalize()) > 0.1).then_some((p, p.normalize()))
}

fn plane_mesh() -> Value {
    json!({ "type": "plane", "size": [6, 6] })
}

fn sphere_mesh() -> Value {
    json!({ "type": "sphere", "radius": 0.8, "segments": 384, "rings": 192 })
}

fn cameras() -> [Camera; 2] {
    let perspective = Camera::perspective([0.4, 2.2, 2.6], [0.1, 0.1, 0.0], 45.0, 120, 90);
    [perspective, Camera { lens: Lens::Orthographic(2.2), ..perspective }]
}

/// Compares every pixel that `hit` knows with `expected(position, normal, towards the viewer)`.
fn compare(
    case: &str,
    camera: &Camera,
    document: &Value,
    hit: Hit,
    expected: impl Fn(DVec3, DVec3, DVec3) -> DVec3,
) {
    let picture = Picture::of(document);
    let (mut worst, mut checked) = (Worst::default(), 0);
    for (x, y, pixel) in picture.iter() {
        let known = camera.steady(x, y, 0.02, |ray| hit(ray).is_some()) == Some(true);
        let ray = camera.centre(x, y);
        let Some((position, normal)) = hit(ray).filter(|_| known) else {
            continue;
        };
        let viewer = -ray.direction.normalize();
        let normal = if normal.dot(viewer) < 0.0 { -normal } else { normal };
        checked += 1;
        worst.note(codes_apart(pixel, expected(position, normal, viewer)));
    }
    assert!(checked > 1000, "{case}: only {checked} pixels were looked at");
    at_most(case, &format!("largest difference in codes of {checked}"), worst.largest(), BOUND);
}

fn lamp_at(p: DVec3) -> Incoming {
    Incoming::from_point(LAMP, LAMP_RADIANCE, FALLOFF, p)
}

fn sunlight() -> Incoming {
    Incoming { towards: -SUN.normalize(), radiance: SUN_RADIANCE }
}

#[test]
fn a_point_light_shines_by_blinn_and_phong_on_plane_and_sphere() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        for (shape, mesh, hit) in [("plane", plane_mesh(), plane as Hit), ("sphere", sphere_mesh(), sphere)] {
            let document = document(&camera, mesh, json!({ "lamp": lamp() }));
            compare(&format!("point light, {shape}, {name}"), &camera, &document, hit, |p, n, v| {
                blinn_phong(&SURFACE, AMBIENT, &[lamp_at(p)], n, v)
            });
        }
    }
}

#[test]
fn a_point_light_over_a_huge_floor_shines_the_same_as_over_a_small_one() {
    let level = Camera::perspective([0.4, 0.6, 2.9], [0.1, 0.3, 0.0], 60.0, 120, 90);
    let down = Camera::perspective([0.2, 4.0, 0.3], [0.1, 0.0, 0.0], 40.0, 120, 90);
    let [_, parallel] = cameras();
    for (name, camera) in [("level", level), ("from above", down), ("orthographic", parallel)] {
        for size in [1e2, 1e4, 1e6, 1e8] {
            let mesh = json!({ "type": "plane", "size": [size, size] });
            let document = document(&camera, mesh, json!({ "lamp": lamp() }));
            let case = format!("point light, floor of {size:e}, {name}");
            compare(&case, &camera, &document, plane, |p, n, v| {
                blinn_phong(&SURFACE, AMBIENT, &[lamp_at(p)], n, v)
            });
        }
    }
}

#[test]
fn a_telephoto_view_is_lit_like_a_near_one() {
    let towards = DVec3::new(0.1, 0.8, 0.6).normalize();
    for fov in [1.0f64, 0.03, 0.001] {
        // Two units fill the view at every angle.
        let distance = 1.0 / (fov / 2.0).to_radians().tan();
        let eye = (towards * distance).to_array();
        let camera = Camera::perspective(eye, [0.0; 3], fov, 120, 90);
        let document = document(&camera, sphere_mesh(), json!({ "lamp": lamp() }));
        let case = format!("point light, sphere, {fov}° from {distance:.0} units");
        compare(&case, &camera, &document, sphere, |p, n, v| {
            blinn_phong(&SURFACE, AMBIENT, &[lamp_at(p)], n, v)
        });
    }
}

#[test]
fn lights_add_up() {
    let camera = cameras()[0];
    let document = document(&camera, sphere_mesh(), json!({ "lamp": lamp(), "sun": sun() }));
    compare("point and directional light, sphere", &camera, &document, sphere, |p, n, v| {
        blinn_phong(&SURFACE, AMBIENT, &[lamp_at(p), sunlight()], n, v)
    });
}

#[test]
fn a_light_that_is_off_or_dark_does_not_shine() {
    let camera = cameras()[0];
    let (mut off, mut dark) = (sun(), sun());
    off["enabled"] = json!(false);
    dark["intensity"] = json!(0);
    let document = document(&camera, plane_mesh(), json!({ "off": off, "dark": dark }));
    compare("lights that are off", &camera, &document, plane, |_, n, v| {
        blinn_phong(&SURFACE, AMBIENT, &[], n, v)
    });
}

#[test]
fn a_directional_light_shines_the_same_everywhere() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        let document = document(&camera, plane_mesh(), json!({ "sun": sun() }));
        compare(&format!("directional light, plane, {name}"), &camera, &document, plane, |_, n, v| {
            blinn_phong(&SURFACE, AMBIENT, &[sunlight()], n, v)
        });
    }
}

#[test]
fn a_given_ambient_replaces_the_diffuse_colour_in_ambient_light() {
    let camera = cameras()[0];
    let mut document = document(&camera, plane_mesh(), json!({}));
    document["materials"]["stuff"]["ambient"] = json!([0.9, 0.1, 0.4]);
    document["environment"]["ambient"] = json!([0.4, 0.5, 0.6]);
    compare("ambient", &camera, &document, plane, |_, _, _| {
        SURFACE.emissive + DVec3::new(0.9, 0.1, 0.4) * DVec3::new(0.4, 0.5, 0.6)
    });
}

#[test]
fn lambert_leaves_the_highlight_out() {
    let camera = cameras()[0];
    let mut document = document(&camera, sphere_mesh(), json!({ "lamp": lamp() }));
    document["materials"]["stuff"]["shading"] = json!("lambert");
    let dull = Surface { specular: DVec3::ZERO, ..SURFACE };
    compare("lambert", &camera, &document, sphere, |p, n, v| {
        blinn_phong(&dull, AMBIENT, &[lamp_at(p)], n, v)
    });
}

#[test]
fn unlit_is_emissive_and_diffuse() {
    let camera = cameras()[0];
    let mut document = document(&camera, plane_mesh(), json!({ "lamp": lamp() }));
    document["materials"]["stuff"]["shading"] = json!("unlit");
    compare("unlit", &camera, &document, plane, |_, _, _| SURFACE.emissive + SURFACE.diffuse);
}

#[test]
fn a_back_that_is_shown_is_lit_from_its_own_side() {
    let camera = Camera::perspective([0.4, -2.2, 2.6], [0.1, -0.1, 0.0], 45.0, 120, 90);
    let mut document = document(&camera, plane_mesh(), json!({ "lamp": lamp(), "low": lamp() }));
    let low = LAMP * DVec3::new(1.0, -1.0, 1.0);
    document["lights"]["low"]["position"] = json!(low.to_array());
    compare("back of a plane", &camera, &document, plane, |p, n, v| {
        let below = Incoming::from_point(low, LAMP_RADIANCE, FALLOFF, p);
        blinn_phong(&SURFACE, AMBIENT, &[lamp_at(p), below], n, v)
    });
}

/// A triangle with a colour at each corner, in the plane z = 0.
const CORNERS: [DVec3; 3] =
    [DVec3::new(-1.5, -1.0, 0.0), DVec3::new(1.6, -0.8, 0.0), DVec3::new(0.1, 1.4, 0.0)];
const COLORS: [DVec3; 3] = [DVec3::new(0.9, 0.1, 0.2), DVec3::new(0.1, 0.8, 0.3), DVec3::new(0.2, 0.3, 1.0)];

fn colored_triangle(camera: &Camera) -> Value {
    let mesh = json!({
        "type": "triangles", "positions": CORNERS.map(|p| p.to_array()), "colors": COLORS.map(|c| c.to_array()),
    });
    document(camera, mesh, json!({ "sun": sun() }))
}

/// The point of the triangle that a line of sight meets, and its colour there.
fn triangle_colour(ray: Ray) -> Option<(DVec3, DVec3)> {
    let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Z)?);
    let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).z;
    let [a, b, c] = CORNERS;
    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|part| part / area(a, b, c));
    let colour = (0..3).map(|i| COLORS[i] * weights[i]).sum();
    weights.iter().all(|w| *w > 0.0).then_some((p, colour))
}

#[test]
fn vertex_colours_interpolate_in_perspective_and_multiply_the_diffuse_colour() {
    let camera = Camera::perspective([2.0, 0.3, 1.1], [0.1, 0.0, 0.0], 60.0, 120, 90);
    for (shading, factor) in [("vertex_color", DVec3::ONE), ("unlit", SURFACE.diffuse)] {
        let mut document = colored_triangle(&camera);
        document["materials"]["stuff"]["shading"] = json!(shading);
        document["materials"]["stuff"]["emissive"] = json!([0, 0, 0]);
        let ray_through = |p: DVec3| Ray { origin: camera.eye, direction: p - camera.eye };
        compare(&format!("vertex colours, {shading}"), &camera, &document, triangle_colour, |p, _, _| {
            triangle_colour(ray_through(p)).map_or(DVec3::ZERO, |(_, colour)| colour * factor)
        });
    }
}

#[test]
fn shading_normal_shows_the_bytes_of_output_normal() {
    let camera = cameras()[0];
    for mesh in [sphere_mesh(), plane_mesh(), json!({ "type": "teapot" })] {
        let mut document = document(&camera, mesh, json!({}));
        let data = Picture::new(frame(&scene(&document), &output(Output::Normal)));
        document["render"]["shading"] = json!("normal");
        assert_eq!(Picture::of(&document), data);
    }
}

#[test]
fn output_normal_is_the_world_normal() {
    let camera = cameras()[0];
    let document = document(&camera, sphere_mesh(), json!({}));
    let picture = Picture::new(frame(&scene(&document), &output(Output::Normal)));
    let (mut worst, mut checked) = (Worst::default(), 0);
    for (x, y, pixel) in picture.iter() {
        let Some((_, normal)) = sphere(camera.centre(x, y)) else {
            continue;
        };
        checked += 1;
        for c in 0..3 {
            worst.note((f64::from(pixel[c]) - 255.0 * (normal[c] / 2.0 + 0.5)).abs());
        }
    }
    assert!(checked > 1000);
    // Half a code of rounding; the facets' depth shifts the point that is seen.
    at_most("output=normal, sphere", "largest difference in codes", worst.largest(), 0.6);
}
