//! Makes the models and images of the gallery: `cargo run --release --example gallery_assets`.
//!
//! Everything in `assets/gallery/` but the documents and their small pictures comes from here, byte for
//! byte the same on every machine: the formulas take nothing but arithmetic and `libm`.

mod blocks;
mod landscape;
mod leaves;
mod obj;
mod owl;
mod paint;
mod sculpt;
mod surfaces;
mod turned;

use glam::DVec3;
use landscape::Lake;
use rayon::prelude::*;
use std::path::PathBuf;

/// What makes the bytes of a file.
type Make = fn() -> Vec<u8>;

/// Every file, in order of name.
const FILES: [(&str, Make); 47] = [
    ("bell.obj", turned::bell),
    ("bishop.obj", turned::bishop),
    ("book-cover.obj", blocks::book_cover),
    ("book-pages.obj", blocks::book_pages),
    ("bottle.obj", turned::bottle),
    ("brick-normal.jpg", surfaces::brick_normals),
    ("brick.jpg", surfaces::brick_colors),
    ("cloth.jpg", surfaces::cloth),
    ("crate-height.jpg", surfaces::crate_heights),
    ("crate.jpg", surfaces::crate_colors),
    ("front-lights.jpg", surfaces::front_lights),
    ("front.jpg", surfaces::front_colors),
    ("garden.jpg", landscape::garden),
    ("grime.jpg", surfaces::grime),
    ("house-roof.obj", blocks::house_roof),
    ("house-walls.obj", blocks::house_walls),
    ("king.obj", turned::king),
    ("lake-nx.jpg", || lake([DVec3::NEG_X, DVec3::Z, DVec3::Y])),
    ("lake-ny.jpg", || lake([DVec3::NEG_Y, DVec3::X, DVec3::Z])),
    ("lake-nz.jpg", || lake([DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y])),
    ("lake-px.jpg", || lake([DVec3::X, DVec3::NEG_Z, DVec3::Y])),
    ("lake-py.jpg", || lake([DVec3::Y, DVec3::X, DVec3::NEG_Z])),
    ("lake-pz.jpg", || lake([DVec3::Z, DVec3::X, DVec3::Y])),
    ("lamp-shade.obj", turned::shade),
    ("leaf.png", leaves::slender),
    ("monstera.mtl", || leaves::MONSTERA_LIBRARY.into()),
    ("monstera.obj", leaves::monstera),
    ("monstera.png", leaves::slit),
    ("owl-eye.png", owl::eye),
    ("owl-normal.jpg", owl::normal_map),
    ("owl-specular.jpg", owl::specular_map),
    ("owl.jpg", owl::colors),
    ("owl.mtl", || owl::LIBRARY.into()),
    ("owl.obj", owl::model),
    ("pages.jpg", surfaces::pages),
    ("paving-height.jpg", surfaces::paving_heights),
    ("paving.jpg", surfaces::paving_colors),
    ("pawn.obj", turned::pawn),
    ("planks.jpg", surfaces::planks),
    ("pot.mtl", || turned::POT_LIBRARY.into()),
    ("pot.obj", turned::pot),
    ("queen.obj", turned::queen),
    ("rook.obj", turned::rook),
    ("rosette.obj", leaves::rosette),
    ("shingles.jpg", surfaces::shingles),
    ("stars.png", surfaces::stars),
    ("wallpaper.jpg", surfaces::wallpaper),
];

/// A face of the lake's cube map. Source of the axes: OpenGL 4.6 specification, table 8.19.
fn lake(axes: [DVec3; 3]) -> Vec<u8> {
    Lake::new().face(axes)
}

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery"))
}

fn main() -> std::io::Result<()> {
    FILES.par_iter().try_for_each(|(name, make)| {
        let bytes = make();
        println!("{name}: {} bytes", bytes.len());
        std::fs::write(folder().join(name), bytes)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_in_the_folder_are_those_made_here() {
        FILES.par_iter().for_each(|(name, make)| {
            let lying = std::fs::read(folder().join(name)).unwrap();
            assert!(lying == make(), "{name}: run `cargo run --release --example gallery_assets`");
        });
    }
}
