//! What is in the gallery, and the files of `assets/gallery/` that it is made of.

use super::Piece;

/// A file of the folder by its name.
macro_rules! embedded {
    ($name:expr) => {
        include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery/", $name))
    };
}

/// The models and images named, each with its bytes.
macro_rules! files {
    ($($name:literal)*) => {
        &[$(($name, embedded!($name).as_slice())),*]
    };
}

/// A piece whose document and picture go by its name.
macro_rules! piece {
    ($name:literal, $title:literal, $description:literal, [$($file:literal)*]) => {
        Piece {
            name: $name,
            title: $title,
            description: $description,
            document: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery/", $name, ".json")),
            files: &[$($file),*],
            picture: embedded!(concat!($name, ".jpg")),
        }
    };
}

/// Every model and image, whichever pieces it belongs to.
pub(super) static FILES: &[(&str, &[u8])] = files![
    "bell.obj" "bishop.obj" "book-cover.obj" "book-pages.obj" "bottle.obj" "brick-normal.jpg" "brick.jpg"
    "cloth.jpg" "crate-height.jpg" "crate.jpg" "front-lights.jpg" "front.jpg" "garden.jpg" "grime.jpg" "house-roof.obj"
    "house-walls.obj" "king.obj" "lake-nx.jpg" "lake-ny.jpg" "lake-nz.jpg" "lake-px.jpg" "lake-py.jpg"
    "lake-pz.jpg" "lamp-shade.obj" "leaf.png" "monstera.mtl" "monstera.obj" "monstera.png" "owl-eye.png"
    "owl-normal.jpg" "owl-specular.jpg" "owl.jpg" "owl.mtl" "owl.obj" "pages.jpg" "paving-height.jpg"
    "paving.jpg" "pawn.obj" "planks.jpg" "pot.mtl" "pot.obj" "queen.obj" "rook.obj" "rosette.obj"
    "shingles.jpg" "stars.png" "wallpaper.jpg"
];

/// In the order to show them in.
pub(super) static PIECES: &[Piece] = &[
    piece!(
        "sky-box",
        "crates by a mountain lake",
        "Textured boxes with their relief on a pavement, in front of a cube map.",
        ["crate-height.jpg" "crate.jpg" "lake-nx.jpg" "lake-ny.jpg" "lake-nz.jpg" "lake-px.jpg" "lake-py.jpg"
         "lake-pz.jpg" "paving-height.jpg" "paving.jpg"]
    ),
    piece!(
        "figure",
        "an owl on books",
        "A model from OBJ and MTL: every feather is its normal map's, the gloss its specular map's.",
        ["book-cover.obj" "book-pages.obj" "cloth.jpg" "owl-eye.png" "owl-normal.jpg" "owl-specular.jpg"
         "owl.jpg" "owl.mtl" "owl.obj" "pages.jpg" "planks.jpg"]
    ),
    piece!(
        "soft-shadow-mono",
        "checkmate",
        "Chessmen with PCSS shadows, blurred like an old lens, in grey.",
        ["bishop.obj" "king.obj" "pawn.obj" "planks.jpg" "queen.obj" "rook.obj"]
    ),
    piece!(
        "pcf-pcss",
        "PCF beside PCSS",
        "A point light each: the left one's shadows have an even edge, the right one's soften with distance.",
        ["planks.jpg"]
    ),
    piece!(
        "triangles",
        "paper cranes",
        "Nothing but triangles written out in the document, with a colour at every corner.",
        []
    ),
    piece!(
        "greenhouse",
        "glass and leaves",
        "Blended glass, leaves cut out of their textures with shadows to match, a lamp that glows.",
        ["bell.obj" "bottle.obj" "brick-normal.jpg" "brick.jpg" "garden.jpg" "grime.jpg" "leaf.png" "monstera.mtl"
         "monstera.obj" "monstera.png" "planks.jpg" "pot.mtl" "pot.obj" "rosette.obj"]
    ),
    piece!(
        "village",
        "a toy village in the evening",
        "A low sun in a procedural sky, long soft shadows, lights in the windows; it turns with time.",
        ["front-lights.jpg" "front.jpg" "house-roof.obj" "house-walls.obj" "shingles.jpg"]
    ),
    piece!(
        "night",
        "star light",
        "A turning lantern throws stars on the walls: shadows of three point lights and the moon, bloom.",
        ["book-cover.obj" "book-pages.obj" "cloth.jpg" "lamp-shade.obj" "owl-eye.png" "owl-normal.jpg"
         "owl-specular.jpg" "owl.jpg" "owl.mtl" "owl.obj" "pages.jpg" "planks.jpg" "stars.png" "wallpaper.jpg"]
    ),
];
