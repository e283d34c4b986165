//! What a lathe makes: chessmen, pots and glass. Units are those of the scenes: a king is 1.9 tall.

use crate::obj::{Obj, profile};
use glam::{DVec2, DVec3, dvec2, dvec3};

/// The foot that all chessmen share, up to the collar above it.
const FOOT: [&[[f64; 2]]; 4] = [
    &[[0.0, 0.0], [0.36, 0.0]],
    &[[0.36, 0.0], [0.38, 0.03], [0.36, 0.1], [0.31, 0.13]],
    &[[0.31, 0.13], [0.33, 0.17], [0.29, 0.22], [0.25, 0.23]],
    &[[0.25, 0.23], [0.22, 0.28]],
];

fn chessman(above: &[&[[f64; 2]]]) -> Vec<DVec2> {
    profile(&[&FOOT, above].concat(), 2)
}

/// A pawn, 1.05 tall.
pub fn pawn() -> Vec<u8> {
    let line = chessman(&[
        &[[0.22, 0.28], [0.145, 0.42], [0.12, 0.58], [0.125, 0.64]],
        &[[0.125, 0.64], [0.21, 0.66], [0.215, 0.69], [0.13, 0.72]],
        &[[0.13, 0.72], [0.19, 0.78], [0.208, 0.86], [0.18, 0.96], [0.1, 1.03], [0.0, 1.05]],
    ]);
    Obj::bare().lathe(36, &line).to_bytes()
}

/// A bishop, 1.5 tall.
pub fn bishop() -> Vec<u8> {
    let line = chessman(&[
        &[[0.22, 0.28], [0.14, 0.5], [0.115, 0.75], [0.13, 0.9]],
        &[[0.13, 0.9], [0.22, 0.92], [0.225, 0.95], [0.15, 0.98]],
        &[[0.15, 0.98], [0.18, 1.02], [0.19, 1.04], [0.13, 1.06]],
        &[[0.13, 1.06], [0.185, 1.14], [0.17, 1.26], [0.09, 1.38], [0.045, 1.41]],
        &[[0.045, 1.41], [0.07, 1.44], [0.055, 1.49], [0.0, 1.5]],
    ]);
    Obj::bare().lathe(36, &line).to_bytes()
}

/// A queen, 1.75 tall: her crown has nine points.
pub fn queen() -> Vec<u8> {
    let line = chessman(&[
        &[[0.22, 0.28], [0.15, 0.55], [0.12, 0.9], [0.14, 1.08]],
        &[[0.14, 1.08], [0.24, 1.1], [0.245, 1.13], [0.16, 1.16]],
        &[[0.16, 1.16], [0.2, 1.2], [0.21, 1.23], [0.15, 1.25]],
        &[[0.15, 1.25], [0.165, 1.35], [0.205, 1.46], [0.265, 1.58]],
        &[[0.265, 1.58], [0.225, 1.575], [0.19, 1.52]],
        &[[0.19, 1.52], [0.15, 1.58], [0.07, 1.63]],
        &[[0.07, 1.63], [0.085, 1.68], [0.06, 1.74], [0.0, 1.75]],
    ]);
    let crown = |p: DVec2, angle: f64| {
        let points = 0.5 + 0.5 * libm::cos(9.0 * angle);
        let rim = ((p.y - 1.45) / 0.13).clamp(0.0, 1.0) * f64::from(p.x > 0.186);
        p + dvec2(0.012, 0.055) * rim * (points - 0.4)
    };
    Obj::bare().turned(54, &line, crown).to_bytes()
}

/// A king, 1.92 tall, with his cross.
pub fn king() -> Vec<u8> {
    let line = chessman(&[
        &[[0.22, 0.28], [0.16, 0.55], [0.13, 0.95], [0.15, 1.15]],
        &[[0.15, 1.15], [0.25, 1.17], [0.255, 1.2], [0.17, 1.23]],
        &[[0.17, 1.23], [0.21, 1.27], [0.22, 1.3], [0.16, 1.32]],
        &[[0.16, 1.32], [0.18, 1.45], [0.235, 1.62]],
        &[[0.235, 1.62], [0.23, 1.645], [0.12, 1.7], [0.06, 1.71], [0.0, 1.71]],
    ]);
    let block = |obj: &mut Obj, low: DVec3, high: DVec3| {
        obj.cuboid(low, high, DVec2::ONE);
    };
    let mut obj = Obj::bare();
    obj.lathe(36, &line);
    block(&mut obj, dvec3(-0.032, 1.69, -0.03), dvec3(0.032, 1.92, 0.03));
    block(&mut obj, dvec3(-0.095, 1.785, -0.028), dvec3(0.095, 1.85, 0.028));
    obj.to_bytes()
}

/// A rook, 1.15 tall, with six battlements.
pub fn rook() -> Vec<u8> {
    let line = chessman(&[
        &[[0.22, 0.28], [0.19, 0.45], [0.175, 0.7], [0.185, 0.8]],
        &[[0.185, 0.8], [0.27, 0.84], [0.275, 0.87]],
        &[[0.275, 0.87], [0.275, 1.14]],
        &[[0.275, 1.14], [0.21, 1.14]],
        &[[0.21, 1.14], [0.205, 1.02]],
        &[[0.205, 1.02], [0.0, 1.0]],
    ]);
    let battlements = |p: DVec2, angle: f64| {
        let is_gap = libm::cos(6.0 * angle) > 0.45 && p.x > 0.2 && p.y > 1.03;
        if is_gap { dvec2(p.x, 1.03) } else { p }
    };
    Obj::bare().turned(48, &line, battlements).to_bytes()
}

/// A flower pot, 1 tall, open, with earth in it.
pub fn pot() -> Vec<u8> {
    let line = profile(
        &[
            &[[0.0, 0.0], [0.34, 0.0]],
            &[[0.34, 0.0], [0.36, 0.02], [0.45, 0.7]],
            &[[0.45, 0.7], [0.53, 0.71], [0.55, 0.95], [0.53, 1.0]],
            &[[0.53, 1.0], [0.47, 0.99], [0.46, 0.9]],
        ],
        2,
    );
    let earth = profile(&[&[[0.465, 0.87], [0.3, 0.9], [0.0, 0.92]]], 3);
    let mut obj = Obj::bare().with_library("pot.mtl");
    obj.material("clay").lathe(48, &line).material("earth").lathe(48, &earth).to_bytes()
}

/// The pot's materials.
pub const POT_LIBRARY: &str = "# Written by examples/gallery_assets
newmtl clay
Kd 0.49 0.155 0.065
Ks 0.05 0.05 0.05
Ns 14
newmtl earth
Kd 0.035 0.022 0.014
";

/// A glass bell, 1.3 tall, with its knob.
pub fn bell() -> Vec<u8> {
    let line = profile(
        &[
            &[[0.53, 0.0], [0.54, 0.015], [0.5, 0.03]],
            &[[0.5, 0.03], [0.5, 0.55], [0.48, 0.76], [0.38, 0.98], [0.22, 1.1], [0.06, 1.135]],
            &[[0.06, 1.135], [0.05, 1.16], [0.085, 1.22], [0.06, 1.28], [0.0, 1.29]],
        ],
        4,
    );
    Obj::bare().lathe(48, &line).to_bytes()
}

/// A wide bottle, 1 tall.
pub fn bottle() -> Vec<u8> {
    let line = profile(
        &[
            &[
                [0.0, 0.015],
                [0.2, 0.0],
                [0.27, 0.03],
                [0.3, 0.12],
                [0.3, 0.4],
                [0.25, 0.56],
                [0.12, 0.66],
                [0.085, 0.74],
                [0.08, 0.9],
            ],
            &[[0.08, 0.9], [0.115, 0.92], [0.115, 0.975], [0.085, 1.0]],
            &[[0.085, 1.0], [0.065, 0.97], [0.06, 0.8]],
        ],
        4,
    );
    Obj::bare().lathe(48, &line).to_bytes()
}

/// A lamp shade, 0.5 tall, open above and below; one surface, to be lit from both sides.
pub fn shade() -> Vec<u8> {
    let line = profile(&[&[[0.46, 0.0], [0.39, 0.14], [0.29, 0.34], [0.24, 0.5]]], 2);
    Obj::textured().lathe(48, &line).to_bytes()
}
