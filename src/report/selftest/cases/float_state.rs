//! What a thread or a compiler could change about floats (B50).

use super::determinism::{busy, glassy, noise, small};
use crate::math::keeps_subnormals;
use crate::pipeline::Pixels;
use crate::plan::{FrameRequest, Output};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{bytes_of, frame, output, scene_with};
use crate::report::selftest::instruments::engine::Engine;
use serde_json::{Value, json};

/// A thread that flushes subnormal numbers to 0 draws other depths; no compiler sets that, but libraries do.
/// The threads are those that draw, and have drawn: what something sets on the way stays.
pub fn every_thread_keeps_subnormal_numbers(ledger: &mut Ledger) {
    let scene = scene_with(&glassy(), &noise());
    for threads in [1, 2, 3, 7, 16] {
        let engine = Engine { threads, ..Engine::current() };
        drop(engine.drive(|| frame(&scene, &small(&output(Output::Color), 1))));
        let kept = engine.work().pool.broadcast(|_| keeps_subnormals());
        let lost = kept.iter().filter(|kept| !**kept).count();
        ledger.none_of(&format!("{threads} threads"), "threads where 2⁻¹⁴⁰ · 0.5 is lost", lost, threads);
    }
    ledger.holds("the thread of a check", "threads where 2⁻¹⁴⁰ · 0.5 is lost", keeps_subnormals());
}

/// First half of the BLAKE3 hash of each picture, the same in every build: with and without optimisation,
/// with and without assertions.
const HASHES: [(&str, &str); 6] = [
    ("colours", "94134d0c6d85d7412b58da75db3a1ccf"),
    ("transparency", "c2679f18ced21f8487d67033802c4af7"),
    ("radiance", "319012c4bfd26c6d65af5447767c2be9"),
    ("depth", "3a05bf23238bffbaec113f68684f0410"),
    ("normals", "734366105f280aa433fd7363733028ea"),
    ("effects", "9b7db5fccbb2a50d21b21402022a95f8"),
];

fn hash(pixels: &Pixels) -> String {
    blake3::hash(&bytes_of(pixels)).to_hex()[..32].to_owned()
}

/// The pictures that [`HASHES`] are of, in their order.
fn pictures() -> [(Value, FrameRequest); 6] {
    let busy = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    let mut effects = busy.clone();
    effects["post"] =
        json!([{ "type": "bloom" }, { "type": "tonemap", "operator": "aces" }, { "type": "fxaa" }]);
    let of = |what: Output, count: u32| small(&output(what), count);
    [
        (busy.clone(), of(Output::Color, 4)),
        (glassy(), of(Output::Color, 8)),
        (glassy(), of(Output::Radiance, 4)),
        (busy.clone(), of(Output::Depth, 1)),
        (busy, of(Output::Normal, 2)),
        (effects, of(Output::Color, 1)),
    ]
}

/// A release build draws what a debug build draws.
pub fn every_build_draws_the_same(ledger: &mut Ledger) {
    for ((name, expected), (document, request)) in HASHES.into_iter().zip(pictures()) {
        let drawn = hash(&frame(&scene_with(&document, &noise()), &request).pixels);
        ledger.holds(
            &format!("hash {drawn}"),
            &format!("{name} unlike those of other builds"),
            drawn == expected,
        );
    }
}
