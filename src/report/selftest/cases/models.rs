//! Files at the edge of what a parser takes, and beyond (B47).

use crate::import::obj::{self, ObjOptions};
use crate::import::{image, mtl};
use crate::limits::Limits;
use crate::plan::Item;
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::png;
use crate::report::selftest::instruments::oracle::geometric::BAND;
use crate::report::selftest::instruments::oracle::sample_positions;
use crate::report::selftest::instruments::stage::*;
use glam::DVec2;
use std::fmt::Write;
use std::panic::catch_unwind;

/// B47: a mesh, or an error that names the line.
pub fn odd_models_are_read_or_refused_by_line(ledger: &mut Ledger) {
    let refused = [
        ("v 0 0 0\nf 0 1 1\n", 2),
        ("v 0 0 0\n\nf 1 1 2\n", 3),
        ("v 0 0 0\nv 1 0 0\nf 1 2 -3\n", 3),
        ("v 1e400 0 0\n", 1),
        ("v 0 0 0\nv 0 nan 0\n", 2),
        ("v 0 0 0\nv 1 0\n", 2),
        ("v 0 0 0\nvn 0 nan 0\n", 2),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", 4),
    ];
    let wrong = refused.iter().filter(|(text, line)| {
        let error = obj::read(text.as_bytes(), &ObjOptions::default()).err();
        error.and_then(|error| error.line()) != Some(*line)
    });
    ledger.none_of("", "faults at another line", wrong.count(), refused.len());

    let concave = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    let read = [
        ("negative indices", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n".to_owned(), 1),
        ("CRLF and BOM", "\u{feff}v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n".to_owned(), 1),
        ("a continued line", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3\n".to_owned(), 1),
        ("an index twice", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2 3\n".to_owned(), 2),
        ("a concave pentagon", concave.to_owned(), 3),
        (
            "a line of 100 MB",
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n# {}\nf 1 2 3\n", "x".repeat(100_000_000)),
            1,
        ),
    ];
    for (case, text, triangles) in &read {
        let read = obj::read(text.as_bytes(), &ObjOptions::default()).map(|model| model.mesh.triangles.len());
        ledger.holds(case, "models read otherwise", read.is_ok_and(|read| read == *triangles));
    }
}

/// A star of `n` corners about a place in pixels: a simple polygon, mostly a concave one.
fn star(rng: &mut Random, n: usize, centre: DVec2) -> Vec<DVec2> {
    let corner = |i: usize, rng: &mut Random| {
        let angle = (i as f64 + rng.between(0.1, 0.9)) / n as f64 * std::f64::consts::TAU;
        centre + DVec2::from_angle(angle) * rng.between(3.0, 19.0)
    };
    (0..n).map(|i| corner(i, rng)).collect()
}

/// Whether a point lies in a polygon by the crossings of a ray from it; `None` if snapping could decide.
fn inside(polygon: &[DVec2], p: DVec2) -> Option<bool> {
    let mut crossings = 0;
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let along = (p - a).dot(b - a) / (b - a).length_squared();
        if (a + (b - a) * along.clamp(0.0, 1.0) - p).length() < BAND / 256.0 {
            return None;
        }
        let is_crossed = (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
        crossings += u32::from(is_crossed);
    }
    Some(crossings % 2 == 1)
}

/// A model with the polygon as its one face, before the flat view.
fn one_face(polygon: &[DVec2]) -> String {
    let (mut text, mut face) = (String::new(), "f".to_owned());
    for (i, p) in polygon.iter().enumerate() {
        let p = on_screen([p.x * 256.0, p.y * 256.0], 0.5);
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("memory takes it");
        write!(face, " {}", i + 1).expect("memory takes it");
    }
    text + &face
}

/// Pixels in a row and a column of the pictures that show stars.
const SIDE: u32 = 44;

/// How many samples of a star its triangles do not cover exactly once, or cover outside of it; and of how many.
fn wrongly_covered(polygon: &[DVec2]) -> (usize, usize) {
    let mesh = obj::read(one_face(polygon).as_bytes(), &ObjOptions::default()).expect("a face").mesh;
    let item = Item { origin: mesh.origin, ..two_sided(mesh) };
    let counts = cover_counts(&bins(item, &flat_view(SIDE, SIDE), 4), 4);
    let offsets = sample_positions(4);
    let (mut wrong, mut looked) = (0, 0);
    for (&count, i) in counts.iter().zip(0u32..) {
        let corner = [i / 4 % SIDE, i / 4 / SIDE].map(|c| f64::from(c) - f64::from(SIDE / 2));
        let offset = offsets[i as usize % 4].map(|c| f64::from(c) / 256.0);
        if let Some(is_inside) = inside(polygon, DVec2::from_array(corner) + DVec2::from_array(offset)) {
            looked += 1;
            wrong += usize::from(count != u32::from(is_inside));
        }
    }
    (wrong, looked)
}

/// Triangles of a face cover what the face covers, and no point of it twice.
pub fn concave_faces_are_covered_exactly_once(ledger: &mut Ledger) {
    let mut rng = ledger.random(0xb47);
    let (mut wrong, mut looked) = (0, 0);
    for corners in 4..64 {
        for _ in 0..ledger.effort.pick(4, 40) {
            let place = DVec2::new(rng.between(-2.0, 2.0), rng.between(-2.0, 2.0));
            let (more, of) = wrongly_covered(&star(&mut rng, corners, place));
            (wrong, looked) = (wrong + more, looked + of);
        }
    }
    ledger.none_of("faces of 4 to 63 corners", "samples not covered exactly once", wrong, looked);
}

/// What numbers and names are replaced by.
const ODD: [&str; 16] = [
    "0",
    "-1",
    "-0.0",
    "1e400",
    "-1e308",
    "1e-400",
    "nan",
    "inf",
    "99999999999999999999",
    "9223372036854775808",
    "/",
    "//",
    "1/2/3/4",
    "\\",
    "#",
    "\u{0}",
];

const MODEL: &str = "\u{feff}mtllib a.mtl b.mtl\no thing\ng one two\ns 1\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\r\nv 0 1 0 1\n\
    v 0.5 0.2 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 1e-30 0\nusemtl red\nf 1/1/1 2/2/1 3/3/2 4//1\nf -1 -2 -3\n\
    f 1 2 \\\n 5 3 4\ns off\nusemtl blue # odd\nf 1//2 3//2 5//2\nl 1 2 3\np 1\n";

const MATERIALS: &str = "newmtl red\nKd 1 0.2 0.1\nKs 0.5 0.5 0.5\nNs 96\nd 0.5\nTr 0.2\nillum 2\n\
    map_Kd -s 2 2 1 -o 0.1 0 0 -clamp on red.png\nnorm n.png\nmap_Bump -bm 0.3 b.png\nnewmtl blue\nKe 1 1 1\nmap_d d.png\n";

/// Changes a few places: bytes, tokens, lines; repeats or drops some, or cuts the rest off.
fn damaged(whole: &[u8], rng: &mut Random) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..=rng.below(4) {
        if bytes.is_empty() {
            return bytes;
        }
        let at = rng.below(bytes.len());
        let end = (at + 1 + rng.below(12)).min(bytes.len());
        match rng.below(7) {
            0 => bytes[at] = rng.bits().to_le_bytes()[0],
            1 => bytes[at] ^= 1 << rng.below(8),
            2 => drop(bytes.drain(at..end)),
            3 => drop(bytes.splice(at..end, ODD[rng.below(ODD.len())].bytes())),
            4 => {
                let again = bytes[at..end].repeat(1 + rng.below(40));
                bytes.splice(at..at, again);
            }
            5 => bytes.truncate(at),
            _ => {
                let token = |b: &u8| b.is_ascii_whitespace();
                let from = bytes[..at].iter().rposition(token).map_or(0, |i| i + 1);
                let to = bytes[at..].iter().position(token).map_or(bytes.len(), |i| at + i);
                bytes.splice(from..to, ODD[rng.below(ODD.len())].bytes());
            }
        }
    }
    bytes
}

/// Damaged files are read or refused, whatever they say; and what is read is no larger than its file.
pub fn damaged_files_are_read_or_refused(ledger: &mut Ledger) {
    let mut rng = ledger.random(0x47);
    let runs = ledger.effort.pick(4_000, 200_000);
    let limits = Limits::default();
    let picture = png(5, 7, |x, y| [x as u8 * 40, y as u8 * 30, 9, 255]);
    let (mut panics, mut read, mut largest) = (0, 0, 0.0f64);
    for _ in 0..runs {
        let text = damaged(MODEL.as_bytes(), &mut rng);
        match catch_unwind(|| obj::read(&text, &ObjOptions::default())) {
            Ok(Ok(model)) => {
                let made = model.mesh.triangles.len().max(model.mesh.vertex_count());
                largest = largest.max(made as f64 / text.len() as f64);
                read += 1;
            }
            Ok(Err(_)) => {}
            Err(_) => panics += 1,
        }
        let text = damaged(MATERIALS.as_bytes(), &mut rng);
        panics += usize::from(catch_unwind(|| mtl::read(&text, &Limits::default()).is_ok()).is_err());
        let bytes = damaged(&picture, &mut rng);
        panics += usize::from(catch_unwind(|| image::decode(&bytes, "a.png", &limits).is_ok()).is_err());
    }
    assert!(read > runs / 10, "only {read} models could be read");
    ledger.none_of("models, materials, images", "damaged files that end in a panic", panics, 3 * runs);
    ledger.at_most("models", "vertices or triangles for a byte of the file", largest, 1.0);
}
