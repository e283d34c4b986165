//! The same bytes, however a frame is drawn: threads × SIMD levels × orders of the work.

use super::Failed;
use super::setting::Setting;
use super::subject::Subject;
use crate::pipeline::{self, Order, Pixels, Work};
use crate::settings::Simd;
use serde::Serialize;
use std::time::Instant;

/// Numbers of threads.
const THREADS: [usize; 5] = [1, 2, 3, 7, 16];

/// Levels that a machine may have, by their names.
const LEVELS: [&str; 6] = ["scalar", "sse2", "sse4.2", "avx2", "avx512", "neon"];

/// Orders in which the work is handed out.
const ORDERS: [(&str, Order); 3] =
    [("rows", Order::Rows), ("morton", Order::Morton), ("shuffled", Order::Shuffled(0x5eed))];

/// What a frame of every way to draw it said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Determinism {
    /// Ways in which it was drawn, such as `7 threads, avx2, morton`.
    pub matrix: Vec<String>,
    /// Those of them that gave other bytes; always none.
    pub differing: Vec<String>,
    /// A hash of the finished bytes.
    pub hash: String,
}

/// Draws `setting` in every way that this machine knows, until the time is up; in one at least.
///
/// # Errors
/// [`Failed`].
pub fn compare(
    subject: &Subject,
    setting: &Setting,
    until: Instant,
    work: &Work,
) -> Result<Determinism, Failed> {
    let plan = subject.plan(setting)?;
    let draw = |work: &Work| pipeline::render(&plan, work).map(|frame| frame.pixels);
    let expected = draw(work)?;
    let mut all = Determinism { matrix: Vec::new(), differing: Vec::new(), hash: hash(&expected) };
    for threads in THREADS {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { continue };
        for (name, level) in LEVELS.iter().filter_map(|name| Some((name, name.parse::<Simd>().ok()?.level())))
        {
            for (order_name, order) in ORDERS {
                if !all.matrix.is_empty() && Instant::now() >= until {
                    return Ok(all);
                }
                let pixels = draw(&Work { pool: &pool, level, order, ..*work })?;
                let way = format!("{threads} threads, {name}, {order_name}");
                if pixels != expected {
                    all.differing.push(way.clone());
                }
                all.matrix.push(way);
            }
        }
    }
    Ok(all)
}

fn hash(pixels: &Pixels) -> String {
    let mut hash = blake3::Hasher::new();
    if let Pixels::Rgba8 { pixels, .. } = pixels {
        hash.update(pixels.as_flattened());
    }
    hash.finalize().to_hex()[..32].to_owned()
}
