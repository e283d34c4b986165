//! Maps by their names in MTL files, and maps that multiply.

use super::relief::{document, floor};
use crate::closed_form::{Camera, Incoming, Surface, blinn_phong, codes_apart, decode};
use crate::draw::{Picture, file, frame, png, scene_with};
use crate::measure::{Worst, at_most};
use glam::DVec3;
use rasterd::plan::FrameRequest;
use serde_json::{Value, json};

fn byte(n: u32) -> u8 {
    u8::try_from(n).expect("a byte")
}

/// What MTL files call these maps, against the document's own.
#[test]
fn mtl_maps_draw_what_the_document_s_do() {
    let camera = Camera::perspective([0.3, 0.4, 1.6], [0.0, 0.0, 0.0], 50.0, 80, 60);
    let obj = "mtllib m.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    let quad = json!({ "type": "triangles", "indices": [[0, 1, 2], [0, 2, 3]],
        "positions": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]] });
    let rough = png(16, 16, |x, y| [byte(x * y), byte(x * 15), byte(200 + y * 3), 255]);
    for (mtl, material) in [
        ("norm map.png", json!({ "normal_map": "map" })),
        ("map_Bump -bm 4 map.png", json!({ "bump_map": "map", "bump_scale": 0.08 })),
        ("bump map.png -bm -2", json!({ "bump_map": "map", "bump_scale": -0.04 })),
        (
            "Ks 0.9 0.5 0.4\nNs 12\nmap_Ks map.png",
            json!({ "specular_map": "map", "specular": [0.9, 0.5, 0.4], "shininess": 12 }),
        ),
        ("Ke 0.5 1 0.2\nmap_Ke map.png", json!({ "emissive_map": "map", "emissive": [0.5, 1, 0.2] })),
    ] {
        let mut files = file("map.png", rough.clone());
        files.insert("m.mtl", format!("newmtl m\n{mtl}\n").into_bytes().into()).expect("a sound name");
        files.insert("m.obj", obj.as_bytes().to_vec().into()).expect("a sound name");
        let mut own = document(&camera, quad.clone(), material, DVec3::ONE, 0.0);
        own["textures"]["map"]["wrap"] = json!("repeat");
        own["lights"] = json!({ "lamp": { "type": "point", "position": [0.2, 0.3, 0.8] } });
        let mut of_file = own.clone();
        of_file["meshes"]["mesh"] = json!({ "type": "obj", "file": "m.obj" });
        of_file["instances"]["one"].as_object_mut().expect("a map").remove("material");
        let draw = |document: &Value| {
            let scene = scene_with(document, &files);
            assert!(scene.warnings.is_empty(), "{mtl}: {:?}", scene.warnings);
            Picture::new(frame(&scene, &FrameRequest::default()))
        };
        assert!(draw(&own) == draw(&of_file), "{mtl}");
        let mut plain = own.clone();
        plain["materials"]["m"] = json!({});
        assert!(draw(&own) != draw(&plain), "{mtl} shows");
    }
}

#[test]
fn specular_and_emissive_maps_multiply_their_factors() {
    let texel = [200u8, 120, 60];
    let files = file("map.png", png(1, 1, |_, _| [texel[0], texel[1], texel[2], 255]));
    let map = DVec3::from_array(texel.map(decode));
    let camera = Camera::perspective([0.2, 1.2, 1.4], [0.0, 0.0, 0.0], 45.0, 80, 60);
    let (specular, emissive) = (DVec3::new(0.7, 0.6, 0.9), DVec3::new(0.1, 0.3, 0.2));
    let mut document = document(
        &camera,
        json!({ "type": "plane", "size": [2, 2] }),
        json!({
        "diffuse": [0.1, 0.1, 0.1], "specular": specular.to_array(), "specular_map": "map", "shininess": 15,
        "emissive": emissive.to_array(), "emissive_map": "map" }),
        DVec3::ONE,
        0.0,
    );
    let towards = DVec3::new(-0.2, 1.0, -0.9);
    document["environment"]["ambient"] = json!([0, 0, 0]);
    document["lights"] = json!({ "sun": { "type": "directional", "direction": (-towards).to_array() } });
    let surface = Surface {
        diffuse: DVec3::splat(0.1),
        specular: specular * map,
        shininess: 15.0,
        ambient: DVec3::ZERO,
        emissive: emissive * map,
    };
    let light = Incoming { towards: towards.normalize(), radiance: DVec3::ONE };
    let picture = Picture::new(frame(&scene_with(&document, &files), &FrameRequest::default()));
    let (mut worst, mut checked) = (Worst::default(), 0);
    for (x, y, pixel) in picture.iter() {
        let ray = camera.centre(x, y);
        if floor(ray).is_some() {
            let viewer = -ray.direction.normalize();
            worst.note(codes_apart(pixel, blinn_phong(&surface, DVec3::ZERO, &[light], DVec3::Y, viewer)));
            checked += 1;
        }
    }
    assert!(checked > 800);
    at_most("specular and emissive maps", "largest difference in codes", worst.largest(), 0.55);
}
