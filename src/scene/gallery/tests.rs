use super::*;
use crate::limits::Limits;
use crate::scene::Document;
use serde_json::Value;
use std::collections::BTreeSet;

/// The folder as it is in the sources.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery");

/// Bytes of the whole folder that a clone of the sources is asked to carry.
const MAX_BYTES: u64 = 3 << 20;

#[test]
fn every_piece_compiles_without_a_warning() {
    for piece in pieces() {
        let scene = piece.to_scene().compile(&Limits::default()).unwrap();
        assert!(scene.warnings.is_empty(), "{}: {:?}", piece.name, scene.warnings);
    }
}

#[test]
fn titles_are_the_documents_names() {
    for piece in pieces() {
        let document = piece.to_scene().document.unwrap();
        assert_eq!(document["name"], piece.title, "{}", piece.name);
        assert!(!piece.title.is_empty() && piece.description.ends_with('.'), "{}", piece.name);
    }
}

#[test]
fn every_name_in_a_document_is_used() {
    for piece in pieces() {
        let document = piece.to_scene().document.unwrap();
        let document = Document::from_json(&document).unwrap();
        let meshes: BTreeSet<_> = document.instances.values().map(|instance| &instance.mesh).collect();
        assert_eq!(meshes, document.meshes.keys().collect(), "{}", piece.name);
        let materials: BTreeSet<_> = document.instances.values().flat_map(|i| &i.material).collect();
        assert_eq!(materials, document.materials.keys().collect(), "{}", piece.name);
        let textures: BTreeSet<_> =
            document.materials.values().flat_map(|m| m.maps.iter().flatten()).collect();
        assert_eq!(textures, document.textures.keys().collect(), "{}", piece.name);
    }
}

#[test]
fn a_piece_has_the_files_that_it_names_and_no_other() {
    for piece in pieces() {
        let scene = piece.to_scene();
        let files = scene.files.unwrap();
        assert_eq!(files.iter().count(), piece.files.len(), "{}", piece.name);
        let texts = files.iter().filter(|(name, _)| name.ends_with(".obj") || name.ends_with(".mtl"));
        let texts: Vec<_> = texts.map(|(_, bytes)| String::from_utf8(bytes.to_vec()).unwrap()).collect();
        for name in piece.files {
            let is_named = |text: &str| text.contains(name);
            let named = is_named(piece.document) || texts.iter().any(|text| is_named(text));
            assert!(named, "{}: {name}", piece.name);
        }
    }
}

#[test]
fn all_that_lies_in_the_folder_is_embedded_and_small() {
    let documents =
        pieces().iter().flat_map(|piece| ["json", "jpg"].map(|end| format!("{}.{end}", piece.name)));
    let files = pieces::FILES.iter().map(|(name, _)| (*name).to_owned());
    let embedded: BTreeSet<_> = documents.chain(files).collect();
    let entries: Vec<_> = std::fs::read_dir(FOLDER).unwrap().map(Result::unwrap).collect();
    let lying: BTreeSet<_> = entries.iter().map(|entry| entry.file_name().into_string().unwrap()).collect();
    assert_eq!(lying, embedded);
    let bytes: u64 = entries.iter().map(|entry| entry.metadata().unwrap().len()).sum();
    assert!(bytes <= MAX_BYTES, "{bytes}");
}

#[test]
fn every_file_belongs_to_a_piece() {
    for (name, _) in pieces::FILES {
        assert!(pieces().iter().any(|piece| piece.files.contains(name)), "{name}");
    }
}

#[test]
fn an_unknown_name_is_told_the_nearest_and_all() {
    let detail = find("figur").unwrap_err();
    assert!(detail.contains("did you mean \"figure\"?"), "{detail}");
    assert!(pieces().iter().all(|piece| detail.contains(piece.name)), "{detail}");
    assert!(find(&"x".repeat(10_000)).unwrap_err().len() < 400);
}

/// The words that stand under `key` anywhere in a document.
fn words<'a>(value: &'a Value, key: &str, found: &mut BTreeSet<&'a str>) {
    match value {
        Value::Object(fields) => {
            found.extend(fields.get(key).and_then(Value::as_str));
            fields.values().for_each(|value| words(value, key, found));
        }
        Value::Array(values) => values.iter().for_each(|value| words(value, key, found)),
        _ => {}
    }
}

#[test]
fn together_they_show_what_there_is() {
    let documents: Vec<Value> = pieces().iter().filter_map(|piece| piece.to_scene().document).collect();
    let all = Value::Array(documents.clone());
    let kinds = [
        ("type", "directional point color gradient sky cubemap equirect"),
        ("type", "box plane sphere torus cylinder cone teapot obj triangles"),
        ("type", "tonemap blur grayscale vignette bloom sharpen fxaa color_matrix kernel"),
        ("filter", "hard pcf pcss"),
        ("operator", "aces reinhard"),
        ("shading", "lambert unlit vertex_color"),
    ];
    for (key, wanted) in kinds {
        let mut found = BTreeSet::new();
        words(&all, key, &mut found);
        let missing: Vec<_> = wanted.split(' ').filter(|word| !found.contains(word)).collect();
        assert!(missing.is_empty(), "{key}: {missing:?}");
    }
    let text = serde_json::to_string(&documents).unwrap();
    for field in [
        "specular",
        "emissive_map",
        "bump_map",
        "normal_map",
        "opacity",
        "opacity_map",
        "alpha_cutoff",
        "double_sided",
        "checker",
        "spin",
        "orbit_deg_per_s",
        "backgrounds",
        "colors",
        "uv_repeat",
        "casts_shadow",
    ] {
        assert!(text.contains(&format!("\"{field}\":")), "{field}");
    }
}
