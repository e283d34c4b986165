//! Normals under every scale, of every length, and where they cancel.

use super::interpolated::{bins, corners, document, look};
use crate::pipeline::shade::Fragment;
use crate::pipeline::shade::varyings::{Records, Source, Varyings, interpolate};
use crate::plan::{FrameRequest, Plan, orthonormal_basis};
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{level, plan, scene};
use crate::report::selftest::instruments::worst::{U, Worst};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

fn lit(scale: DVec3, rotation: [f64; 3]) -> Value {
    let mut random = Random(0xb25);
    let positions: Vec<DVec3> = (0..300)
        .flat_map(|_| corners(&mut random, 2.0, 300.0))
        // What the scale makes of it is of order one; where it is 0, anything will do.
        .map(|p| p / DVec3::from_array(scale.to_array().map(|s| if s == 0.0 { 1.0 } else { s })))
        .collect();
    let mut document = document(&positions, json!({}));
    document["instances"]["i"]["scale"] = json!(scale.to_array());
    document["instances"]["i"]["rotation_deg"] = json!(rotation);
    if scale.z == 0.0 {
        // Flat in z: seen from the front.
        document["camera"] =
            json!({ "position": [0, 0, 3], "target": [0, 0, 0], "fov_y_deg": 90, "near": 1e-3 });
    }
    document
}

/// B25.
pub fn normals_are_those_of_the_transformed_triangle_under_every_scale(ledger: &mut Ledger) {
    for (scale, rotation) in [
        ([1.0, 1.0, 1.0], [0.0; 3]),
        ([1.0, 1e-6, 1e6], [0.0; 3]),
        ([1e6, 1.0, 1e-6], [3.0, 2.0, 40.0]),
        ([-1.0, 1.0, 1.0], [0.0; 3]),
        ([-1e-3, -2.0, -1e3], [1.0, -2.0, 90.0]),
        ([1.0, 1.0, 0.0], [0.0; 3]),
        ([1e-6, 1e3, 0.0], [0.0; 3]),
    ] {
        let plan = plan(&scene(&lit(scale.into(), rotation)), &FrameRequest::default());
        let item = &plan.items[0];
        let eye = plan.view.eye;
        let (mut worst, mut away) = (Worst::default(), 0);
        let looked = look(&plan, &mut Random(1), |t, _, lane, varyings| {
            let corners = item.mesh.triangles[t.source as usize].map(|v| item.linear * item.mesh.position(v));
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            let towards = if normal.dot(eye - item.origin - corners[0]) < 0.0 { -normal } else { normal };
            let drawn = varyings.normal.map(|axis| f64::from(axis[lane]));
            assert!(drawn.iter().all(|c| c.is_finite()));
            worst.note(DVec3::from_array(drawn).cross(towards).length() / U);
            away += usize::from(DVec3::from_array(drawn).dot(towards) <= 0.0);
        });
        assert!(looked > 300, "scale {scale:?}: {looked} points");
        ledger.at_most(&format!("scale {scale:?}"), "angle in u", worst.largest(), 4.0);
        ledger.none_of(&format!("scale {scale:?}"), "normals turned away", away, looked);
    }
}

/// B25.
pub fn what_the_scale_leaves_no_area_is_not_drawn(ledger: &mut Ledger) {
    for scale in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]] {
        let plan = plan(&scene(&lit(scale.into(), [0.0; 3])), &FrameRequest::default());
        let drawn = bins(&plan).counts.drawn;
        ledger.at_most(&format!("scale {scale:?}"), "triangles drawn", drawn as f64, 0.0);
    }
}

/// A triangle before the camera with these normals.
fn with_normals(normals: [DVec3; 3]) -> Plan {
    let positions = [DVec3::new(-1.0, -1.0, -1.5), DVec3::new(1.0, -0.9, -2.0), DVec3::new(0.1, 1.0, -1.2)];
    let extra = json!({ "normals": normals.map(|n| n.to_array()) });
    plan(&scene(&document(&positions, extra)), &FrameRequest::default())
}

fn geometric_normal(plan: &Plan) -> DVec3 {
    let mesh = &plan.items[0].mesh;
    let [a, b, c] = mesh.triangles[0].map(|v| mesh.position(v));
    (b - a).cross(c - a).normalize()
}

/// Largest excess of the length of interpolated normals over 1, in u.
fn worst_length(plan: &Plan) -> f64 {
    let mut worst = Worst::default();
    let looked = (0..50).map(|seed| {
        look(plan, &mut Random(seed), |_, _, lane, varyings| {
            let n = DVec3::from_array(varyings.normal.map(|axis| f64::from(axis[lane])));
            assert!(n.is_finite(), "{n}");
            worst.note((n.length() - 1.0).abs() / U);
        })
    });
    assert!(looked.sum::<usize>() > 100);
    worst.largest()
}

/// B26.
pub fn normals_of_any_length_become_unit_vectors_and_zero_the_geometric_one(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb26);
    for length in [1e-300, 1e-30, 1e-6, 1.0, 1e6, 1e30, 1e37] {
        let plan = with_normals([(); 3].map(|()| {
            let n = random.direction();
            DVec3::new(n.x, n.y, n.z.abs()) * length
        }));
        let stored = plan.items[0].mesh.normals.iter().map(|n| (n.as_dvec3().length() - 1.0).abs() / U);
        let case = format!("normals of length {length:e}");
        ledger.at_most(&case, "stored length − 1 in u", stored.collect::<Worst>().largest(), 2.0);
        ledger.at_most(&case, "interpolated length − 1 in u", worst_length(&plan), 2.0);
    }
    let plan = with_normals([DVec3::ZERO; 3]);
    let geometric = geometric_normal(&plan);
    let worst = plan.items[0].mesh.normals.iter().map(|n| n.as_dvec3().cross(geometric).length() / U);
    ledger.at_most(
        "normals of length 0",
        "angle to the geometric normal in u",
        worst.collect::<Worst>().largest(),
        2.0,
    );
}

/// B27.
pub fn normals_that_cancel_give_way_to_the_geometric_one(ledger: &mut Ledger) {
    for (case, normals) in [
        ("two corners", [DVec3::Z, DVec3::NEG_Z, DVec3::NEG_Z]),
        ("all along one line", [DVec3::X, DVec3::NEG_X, DVec3::X]),
    ] {
        let plan = with_normals(normals);
        ledger.at_most(case, "interpolated length − 1 in u", worst_length(&plan), 2.0);
    }
    // Three directions at 120°: they cancel at the centre of a triangle seen head on, to the bit.
    let (x, y) = (0.5, 0.75f64.sqrt());
    let normals = [DVec3::X, DVec3::new(-x, y, 0.0), DVec3::new(-x, -y, 0.0)];
    let positions = [DVec3::new(-1.5, -1.5, -2.0), DVec3::new(1.5, -1.5, -2.0), DVec3::new(0.0, 3.0, -2.0)];
    let extra = json!({ "normals": normals.map(|n| n.to_array()) });
    let plan = plan(&scene(&document(&positions, extra)), &FrameRequest::default());
    let bins = bins(&plan);
    let (chunk, t) = (&bins.chunks[0], &bins.chunks[0].triangles[0]);
    let draw = &plan.draws[0];
    let source = Source::new(&plan.items[0], &draw.surface, &[], &plan.view, DVec3::ZERO);
    let mut records = Records::new(&source);
    records.push(&source, (chunk, t));
    let centre =
        Fragment { record: 0, target: 0, x: t.x.iter().sum::<i32>() / 3, y: t.y.iter().sum::<i32>() / 3 };
    let mut varyings = Varyings::default();
    interpolate(level(), &records, &source, &[centre], &mut varyings);
    let normal = Vec3::from_array(varyings.normal.map(|axis| axis[0]));
    ledger.holds("three at 120°", "not the geometric normal where they cancel", normal == Vec3::Z);
}

/// B28, as far as it does not need tangents: the basis that every fallback is made of.
pub fn the_orthonormal_basis_holds_for_every_direction(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb28);
    let mut worst = Worst::default();
    let mut check = |n: DVec3| {
        let (a, b) = orthonormal_basis(n);
        let errors =
            [a.dot(b), a.dot(n), b.dot(n), a.length() - 1.0, b.length() - 1.0, (a.cross(b) - n).length()];
        errors.into_iter().for_each(|e| worst.note(e.abs()));
    };
    for _ in 0..200_000 {
        check(random.direction());
        // Close to ±z, at every distance.
        let (r, angle) = (random.magnitude(1e-20, 1e-1), random.between(0.0, 6.3));
        for side in [-1.0, 1.0] {
            check(DVec3::new(r * angle.cos(), r * angle.sin(), side).normalize());
        }
    }
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        check(axis);
        check(-axis);
    }
    check(DVec3::new(0.0, 0.0, -1.0));
    check(DVec3::new(-0.0, 1.0, -0.0));
    ledger.at_most("basis", "error in u", worst.largest() / U, 4.0);
    // It is made in f64, whose own roundoff is 2⁻⁵³; a unit vector's square is off by 4 of those, which
    // the basis inherits, and its own steps add as many.
    let roundoff = f64::EPSILON / 2.0;
    ledger.at_most("basis", "error in roundings of f64", worst.largest() / roundoff, 8.0);
}
