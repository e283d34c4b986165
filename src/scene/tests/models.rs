//! Claims about scenes made of files.

use crate::limits::Limits;
use crate::model::Wrap;
use crate::model::texture::ColorSpace;
use crate::scene::{Compiled, Document, Files, SceneError, Warning, compile};
use bytes::Bytes;
use glam::Vec3;
use serde_json::{Value, json};
use std::sync::Arc;

const OBJ: &str = "mtllib some colours.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\nusemtl blue\nf 1/1 3/1 2/1\n";
const MTL: &str =
    "newmtl red\nKd 1 0 0\nmap_Kd -clamp on -s 2 3 textures\\dots.png\nmap_d -imfchan g dots.png\n";

/// A PNG of one texel.
fn png(texel: [u8; 4]) -> Bytes {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&texel).unwrap();
    writer.finish().unwrap();
    bytes.into()
}

fn files(list: &[(&str, Bytes)]) -> Files {
    let mut files = Files::default();
    for (name, bytes) in list {
        files.insert(name, bytes.clone()).unwrap();
    }
    files
}

fn build(json: &Value, files: &Files) -> Result<Compiled, SceneError> {
    compile(&Document::from_json(json).unwrap(), files, None, &Limits::default())
}

fn one_model() -> Value {
    json!({ "meshes": { "m": { "type": "obj", "file": "a.obj" } }, "instances": { "i": { "mesh": "m" } } })
}

#[test]
fn colour_and_alpha_may_come_from_one_file() {
    let of = |texture: Value| {
        let json = json!({
            "textures": { "t": texture },
            "materials": { "m": { "diffuse_map": "t", "opacity_map": "t" } },
        });
        let scene = build(&json, &files(&[("a.png", png([188, 64, 0, 255]))])).unwrap().scene;
        let material = scene.materials[1].clone();
        [material.diffuse_map.clone().unwrap(), material.opacity_map.clone().unwrap()]
    };
    let [color, alpha] = of(json!({ "file": "a.png" }));
    assert_eq!((color.color_space, alpha.color_space), (ColorSpace::Srgb, ColorSpace::Linear));
    assert!(Arc::ptr_eq(&color.image, &alpha.image));
    let [color, alpha] = of(json!({ "file": "a.png", "color_space": "srgb" }));
    assert!(Arc::ptr_eq(&color, &alpha) && alpha.color_space == ColorSpace::Srgb);
}

fn warned(warnings: &[Warning], file: &str, line: u64, word: &str) -> bool {
    warnings
        .iter()
        .any(|w| w.file.as_deref() == Some(file) && w.line == Some(line) && w.detail.contains(word))
}

#[test]
fn materials_and_textures_of_an_mtl_are_found() {
    let files = files(&[
        ("A.OBJ", OBJ.into()),
        ("some colours.mtl", MTL.into()),
        ("Dots.PNG", png([255, 128, 0, 255])),
    ]);
    let scene = build(&one_model(), &files).unwrap().scene;
    let red = &scene.materials[scene.instances[0].materials[0] as usize];
    assert_eq!(red.diffuse, Vec3::X);
    let map = red.diffuse_map.as_ref().unwrap();
    assert_eq!((map.wrap, map.scale), ([Wrap::Clamp; 2], [2.0, 3.0]));
    assert_eq!(red.opacity_map.as_ref().unwrap().image.texels, [[128, 128, 128, 255]]);
    assert!(warned(&scene.warnings, "A.OBJ", 8, "\"blue\""), "{:?}", scene.warnings);
}

#[test]
fn what_a_model_lacks_is_warned_of_and_neutral() {
    let scene = build(&one_model(), &files(&[("a.obj", OBJ.into())])).unwrap().scene;
    assert!(warned(&scene.warnings, "a.obj", 1, "some"), "{:?}", scene.warnings);
    let files = files(&[("a.obj", OBJ.into()), ("some colours.mtl", MTL.into())]);
    let scene = build(&one_model(), &files).unwrap().scene;
    assert!(warned(&scene.warnings, "some colours.mtl", 3, "dots.png"), "{:?}", scene.warnings);
}

#[test]
fn a_given_material_takes_the_place_of_the_mtl() {
    let mut json = one_model();
    json["materials"] = json!({ "green": { "diffuse": [0, 1, 0] } });
    json["instances"]["i"]["material"] = json!("green");
    let scene = build(&json, &files(&[("a.obj", OBJ.into())])).unwrap().scene;
    assert_eq!(scene.warnings, []);
    assert_eq!(scene.instances[0].materials, [1, 1]);
}

#[test]
fn two_names_for_a_file_share_its_mesh() {
    let json = json!({ "meshes": {
        "a": { "type": "obj", "file": "a.obj" }, "b": { "type": "obj", "file": "x/A.obj" }
    } });
    let json_files = files(&[("a.obj", OBJ.into())]);
    let first = build(&json, &json_files).unwrap();
    assert!(Arc::ptr_eq(&first.scene.meshes[0], &first.scene.meshes[1]));
    let document = Document::from_json(&json).unwrap();
    let same = compile(&document, &json_files, Some(&first.assets), &Limits::default()).unwrap();
    assert!(Arc::ptr_eq(&first.scene.meshes[0], &same.scene.meshes[0]));
    let other = files(&[("a.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n".into())]);
    let other = compile(&document, &other, Some(&first.assets), &Limits::default()).unwrap();
    assert!(!Arc::ptr_eq(&first.scene.meshes[0], &other.scene.meshes[0]));
}

#[test]
fn files_that_cannot_be_read_are_named_with_their_line() {
    let broken = build(&one_model(), &files(&[("a.obj", "v 0 0 0\nf 1 2 3\n".into())])).unwrap_err();
    assert!(
        matches!(&broken, SceneError::Unreadable { file, line: Some(2), .. } if file == "a.obj"),
        "{broken}"
    );
    let json = json!({ "textures": { "t": { "file": "t.png" } } });
    let broken = build(&json, &files(&[("t.png", "no picture".into())])).unwrap_err();
    assert!(matches!(&broken, SceneError::Unreadable { file, .. } if file == "t.png"), "{broken}");
}

#[test]
fn decoded_assets_are_bounded() {
    let json = json!({ "meshes": { "m": { "type": "sphere", "segments": 512, "rings": 512 } } });
    let limits = Limits { scene_bytes: 1 << 20, ..Limits::default() };
    let error = compile(&Document::from_json(&json).unwrap(), &Files::default(), None, &limits).unwrap_err();
    assert!(
        matches!(error, SceneError::TooLarge { setting: Some("RASTERD_MAX_SCENE_BYTES"), .. }),
        "{error}"
    );
}
