//! Claims about the bytes that a scene may take.

use crate::limits::Limits;
use crate::scene::{Document, Files, SceneError, compile};
use bytes::Bytes;
use image::{GrayImage, ImageFormat};
use serde_json::{Value, json};
use std::io::Cursor;

/// A grey square of `side` texels, as a file that is far smaller than what it decodes to.
fn grey(side: u32) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    GrayImage::new(side, side).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Documents in which the file `p.png` takes memory, and those bytes for a picture of 256 texels a side.
fn uses() -> [(Value, u64); 3] {
    let background = |background: Value| json!({ "environment": { "background": background } });
    let faces =
        json!({ "px": "p.png", "nx": "p.png", "py": "p.png", "ny": "p.png", "pz": "p.png", "nz": "q.png" });
    let mips = |texels: fn(u64) -> u64| (0..8).map(|level| texels(1 << level)).sum::<u64>();
    [
        (
            background(json!({ "type": "cubemap", "faces": faces })),
            6 * (258 * 258 * 4 + 12 * mips(|side| (side + 2) * (side + 2))),
        ),
        (
            background(json!({ "type": "equirect", "file": "p.png" })),
            256 * 256 * 4 + 12 * mips(|side| side * side),
        ),
        (json!({ "textures": { "t": { "file": "p.png" } } }), 256 * 256 * 4 + 8 * mips(|side| side * side)),
    ]
}

fn outcome(json: &Value, picture: &[u8], scene_bytes: u64) -> Result<u64, SceneError> {
    let mut files = Files::default();
    for name in ["p.png", "q.png"] {
        files.insert(name, Bytes::copy_from_slice(picture)).unwrap();
    }
    let limits = Limits { scene_bytes: scene_bytes + files.total_bytes(), ..Limits::default() };
    compile(&Document::from_json(json).unwrap(), &files, None, &limits)
        .map(|compiled| compiled.assets.bytes())
}

#[test]
fn pictures_take_what_their_sizes_say_and_not_a_byte_more() {
    for (json, bytes) in uses() {
        assert_eq!(outcome(&json, &grey(256), bytes), Ok(bytes), "{json}");
        let refused = outcome(&json, &grey(256), bytes - 1).unwrap_err();
        assert!(matches!(refused, SceneError::TooLarge { .. }), "{json}: {refused}");
    }
}

#[test]
fn pictures_that_do_not_fit_are_refused_by_their_headers_alone() {
    let whole = grey(256);
    // The header is there, the texels are not: who decodes it finds it damaged.
    let cut = &whole[..whole.len() - 60];
    for (json, bytes) in uses() {
        let damaged = outcome(&json, cut, bytes).unwrap_err();
        assert!(matches!(damaged, SceneError::Unreadable { .. }), "{json}: {damaged}");
        // A texture's mips are made of the decoded picture.
        let too_few = if json["textures"].is_object() { 256 * 256 * 4 - 1 } else { bytes - 1 };
        let refused = outcome(&json, cut, too_few).unwrap_err();
        let SceneError::TooLarge { setting, .. } = &refused else { panic!("{json}: {refused}") };
        assert_eq!(*setting, Some("RASTERD_MAX_SCENE_BYTES"));
    }
}
