//! The scene that is there at start: a still life that needs no file from anywhere.

pub mod noise;
mod textures;

use super::Files;
use serde_json::Value;

/// The document of the demo scene, as a client would write it.
///
/// # Panics
///
/// Never: a test parses the same text.
#[must_use]
pub fn document() -> Value {
    serde_json::from_str(include_str!("scene.json")).expect("invariant: the embedded document is JSON")
}

/// The textures that [`document`] names, painted anew: PNG files of 512 × 512.
#[must_use]
pub fn files() -> Files {
    let painted = [
        ("glaze.png", textures::glaze()),
        ("terrazzo.png", textures::terrazzo()),
        ("weave.png", textures::weave()),
        ("wood.png", textures::wood()),
    ];
    let mut files = Files::default();
    for (name, bytes) in painted {
        files.insert(name, bytes).expect("invariant: a literal name");
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn names<'a>(document: &'a Value, map: &str) -> BTreeSet<&'a str> {
        document[map].as_object().unwrap().keys().map(String::as_str).collect()
    }

    fn referred<'a>(document: &'a Value, map: &str, key: &str) -> BTreeSet<&'a str> {
        document[map].as_object().unwrap().values().filter_map(|entry| entry[key].as_str()).collect()
    }

    #[test]
    fn every_name_is_defined_and_used() {
        let document = document();
        assert_eq!(referred(&document, "instances", "mesh"), names(&document, "meshes"));
        assert_eq!(referred(&document, "instances", "material"), names(&document, "materials"));
        assert_eq!(referred(&document, "materials", "diffuse_map"), names(&document, "textures"));
    }

    #[test]
    fn its_files_are_those_it_names() {
        let document = document();
        let files = files();
        let stored: BTreeSet<&str> = files.iter().map(|(name, _)| name).collect();
        assert_eq!(referred(&document, "textures", "file"), stored);
    }
}
