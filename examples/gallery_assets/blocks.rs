//! Things of boards and boxes: books and a toy village's houses.

use crate::obj::Obj;
use glam::{DVec2, dvec2, dvec3};
use std::f64::consts::PI;

/// A closed book that lies flat: 1.5 wide (spine at −x), 0.24 thick, 1.1 deep; spine and boards.
pub fn book_cover() -> Vec<u8> {
    let mut obj = Obj::textured();
    let plain = DVec2::ONE;
    obj.cuboid(dvec3(-0.73, 0.0, -0.55), dvec3(0.75, 0.03, 0.55), plain);
    obj.cuboid(dvec3(-0.73, 0.21, -0.55), dvec3(0.75, 0.24, 0.55), plain);
    // The rounded spine, front to back.
    let round = |u: f64, v: f64| {
        let angle = PI * v;
        dvec3(-0.73 - 0.05 * libm::sin(angle), 0.12 - 0.12 * libm::cos(angle), -0.55 + 1.1 * u)
    };
    obj.surface([1, 10], plain, round);
    for (end, flip) in [(0.55, 1.0), (-0.55, 0.0)] {
        let mut rim: Vec<_> = (0..=10).map(|i| round((end + 0.55) / 1.1, f64::from(i) / 10.0)).collect();
        if flip > 0.5 {
            rim.reverse();
        }
        let corners: Vec<_> = rim.into_iter().map(|p| (p, dvec2(p.x, p.y))).collect();
        obj.face(&corners);
    }
    obj.to_bytes()
}

/// The block of its pages.
pub fn book_pages() -> Vec<u8> {
    Obj::textured().cuboid(dvec3(-0.75, 0.03, -0.52), dvec3(0.71, 0.21, 0.52), DVec2::ONE).to_bytes()
}

/// The walls of a house, 1 wide, 1 deep, 0.7 to the eaves, 1.2 to the ridge, which runs along z.
/// Each side shows the lower part of one image, the gables all of it.
pub fn house_walls() -> Vec<u8> {
    let mut obj = Obj::textured();
    for (z, turn) in [(0.5, 1.0), (-0.5, -1.0)] {
        let corner = |x: f64, y: f64| (dvec3(turn * x, y, z), dvec2(x + 0.5, y / 1.2));
        obj.face(&[
            corner(-0.5, 0.0),
            corner(0.5, 0.0),
            corner(0.5, 0.7),
            corner(0.0, 1.2),
            corner(-0.5, 0.7),
        ]);
    }
    for turn in [1.0, -1.0] {
        obj.surface([1, 1], dvec2(1.0, 0.7 / 1.2), |u, v| dvec3(0.5 * turn, 0.7 * v, turn * (0.5 - u)));
    }
    obj.to_bytes()
}

/// Its roof: two slabs with overhanging eaves.
pub fn house_roof() -> Vec<u8> {
    /// How thick, and how far below the eaves and beyond the gables it reaches.
    const THICK: f64 = 0.06;
    const OVER: f64 = 0.1;
    let mut obj = Obj::textured();
    let (eave, ridge) = (dvec2(0.5 + OVER, 0.7 - OVER), dvec2(0.0, 1.2));
    let up = dvec2(0.0, THICK * std::f64::consts::SQRT_2);
    for turn in [1.0, -1.0] {
        let at = |p: DVec2, z: f64| dvec3(turn * p.x, p.y, turn * z);
        let z = 0.5 + OVER;
        // Above, below, the eave, and both ends.
        obj.surface([1, 1], dvec2(1.2, 1.0), |u, v| at(eave + (ridge - eave) * v + up, z * (1.0 - 2.0 * u)));
        obj.surface([1, 1], dvec2(1.2, 1.0), |u, v| at(eave + (ridge - eave) * v, z * (2.0 * u - 1.0)));
        obj.surface([1, 1], dvec2(1.2, 0.05), |u, v| at(eave + up * v, z * (1.0 - 2.0 * u)));
        obj.surface([1, 1], dvec2(1.0, 0.05), |u, v| at(ridge + (eave - ridge) * u + up * v, z));
        obj.surface([1, 1], dvec2(1.0, 0.05), |u, v| at(eave + (ridge - eave) * u + up * v, -z));
    }
    obj.to_bytes()
}
