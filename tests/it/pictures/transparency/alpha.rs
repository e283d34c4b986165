//! Where alpha comes from, and what counts as there.

use super::{BACK, HALF_A_CODE, SHEETS, named, over, sheets};
use crate::closed_form::{codes_apart, decode};
use crate::draw::{Picture, file, frame, output, pick, png, samples, scene, scene_with, values};
use crate::measure::at_most;
use glam::DVec3;
use rasterd::plan::{FrameRequest, Output};
use serde_json::{Value, json};

/// A sheet whose alpha map is 1 on the left and 0 on the right.
fn half_clear() -> (Value, rasterd::scene::Files) {
    let mut document = sheets(&named(&SHEETS[..1]), 4);
    document["textures"] = json!({ "half": { "file": "half.png", "filter": "nearest" } });
    let rose = &mut document["materials"]["rose"];
    rose["opacity"] = json!(1);
    rose["opacity_map"] = json!("half");
    let texel = |x: u32| if x < 2 { [255, 9, 77, 255] } else { [0, 200, 3, 255] };
    (document, file("half.png", png(4, 2, |x, _| texel(x))))
}

#[test]
fn alpha_of_one_is_opaque_and_of_none_is_nothing_to_the_byte() {
    let (document, files) = half_clear();
    let blended = Picture::new(frame(&scene_with(&document, &files), &samples(4)));
    let mut cut = document.clone();
    cut["materials"]["rose"]["alpha_cutoff"] = json!(0.5);
    let opaque = Picture::new(frame(&scene_with(&cut, &files), &samples(4)));
    assert_eq!(blended, opaque);
    let plain = blended.at(1, 1);
    assert_ne!(blended.at(24, 28), plain);
    assert_eq!(blended.at(45, 28), plain);
}

#[test]
fn a_surface_of_no_opacity_is_not_there() {
    let document = sheets(&named(&SHEETS), 4);
    let mut clear = document.clone();
    clear["materials"]["leaf"]["opacity"] = json!(0);
    let mut without = document;
    without["instances"].as_object_mut().expect("a map").remove("leaf");
    assert_eq!(Picture::of(&clear), Picture::of(&without));
    let shaded = |document: &Value| frame(&scene(document), &FrameRequest::default()).stats.shaded();
    assert_eq!(shaded(&clear), shaded(&without));
}

#[test]
fn alpha_holds_in_every_kind_of_shading() {
    for shading in ["blinn_phong", "lambert", "unlit", "vertex_color", "normal"] {
        let mut document = sheets(&named(&SHEETS[..1]), 1);
        document["environment"]["background"]["color"] = json!([0, 0, 0]);
        document["environment"]["ambient"] = json!([0.2, 0.2, 0.2]);
        document["lights"] =
            json!({ "sun": { "type": "directional", "direction": [0.3, -0.4, -1], "intensity": 0.5 } });
        let rose = &mut document["materials"]["rose"];
        rose["shading"] = json!(shading);
        rose["specular"] = json!([0.3, 0.3, 0.3]);
        rose["opacity"] = json!(1);
        let opaque = Picture::of(&document).at(35, 27);
        document["materials"]["rose"]["opacity"] = json!(0.25);
        let blended = Picture::of(&document).at(35, 27);
        let expected = DVec3::from_array([0, 1, 2].map(|c| decode(opaque[c]) * 0.25));
        // The opaque byte is half a code off at most, and encoding a quarter of it raises that.
        at_most(&format!("alpha of {shading}"), "codes", codes_apart(blended, expected), 1.0);
    }
}

#[test]
fn half_opaque_counts_as_there_and_less_does_not() {
    for (opacity, there) in [(0.499, false), (0.5, true)] {
        let mut sheet = SHEETS;
        sheet[0].opacity = opacity;
        let mut document = sheets(&named(&sheet[..1]), 1);
        document["camera"]["far"] = json!(10);
        let scene = scene(&document);
        assert_eq!(values(frame(&scene, &output(Output::Instance)))[30 * 64 + 36] != 0, there);
        assert_eq!(values(frame(&scene, &output(Output::Depth)))[30 * 64 + 36] != u16::MAX, there);
        for output in [Output::Normal, Output::Albedo].map(output) {
            assert_eq!(Picture::new(frame(&scene, &output)).at(36, 30) != [0, 0, 0, 255], there);
        }
        assert_eq!(pick(&scene, 36, 30).is_some(), there);
    }
}

#[test]
fn alpha_of_a_diffuse_map_and_of_an_mtl_file_counts() {
    let (mut document, _) = half_clear();
    document["textures"]["half"]["file"] = json!("clear.png");
    document["materials"]["rose"] =
        json!({ "shading": "unlit", "diffuse_map": "half", "diffuse": [1, 1, 1] });
    let files = file("clear.png", png(4, 2, |x, _| if x < 2 { [255, 255, 255, 51] } else { [255; 4] }));
    let picture = Picture::new(frame(&scene_with(&document, &files), &samples(1)));
    let fifth = over([1.0; 3], 0.2, BACK.into());
    at_most("alpha of a diffuse map", "codes", codes_apart(picture.at(24, 28), fifth), HALF_A_CODE);
    assert_eq!(picture.at(45, 28), [255; 4]);

    let mut files =
        file("pane.obj", b"mtllib pane.mtl\nusemtl pane\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n".to_vec());
    files
        .insert("pane.mtl", b"newmtl pane\nKd 0 0 0\nKa 1 0 0\nd 0.25\n".to_vec().into())
        .expect("a sound name");
    let mut document = sheets(&[], 1);
    document["environment"]["ambient"] = json!([1, 1, 1]);
    document["meshes"]["pane"] = json!({ "type": "obj", "file": "pane.obj" });
    document["instances"]["pane"] = json!({ "mesh": "pane" });
    let scene = scene_with(&document, &files);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let expected = over([1.0, 0.0, 0.0], 0.25, BACK.into());
    let picture = Picture::new(frame(&scene, &FrameRequest::default()));
    at_most("MTL `d 0.25`", "codes", codes_apart(picture.at(32, 40), expected), HALF_A_CODE);
}
