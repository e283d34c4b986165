//! Reading OBJ text: our parser beside the `tobj` crate, on generated grids.
//!
//! `cargo bench --bench import`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rasterd::import::obj::{self, ObjOptions};
use std::fmt::Write as _;
use std::hint::black_box;

/// A wavy grid of `side`² quads, with everything a vertex can have or positions alone.
fn grid(side: u32, full: bool) -> String {
    let mut text = String::new();
    let points = || (0..=side).flat_map(|j| (0..=side).map(move |i| (f64::from(i), f64::from(j))));
    for (x, z) in points() {
        writeln!(text, "v {:.6} {:.6} {:.6}", x * 0.01, (x * 0.13).sin() * 0.2, z * -0.01)
            .expect("a String takes all");
        if full {
            writeln!(text, "vt {:.6} {:.6}", x / f64::from(side), z / f64::from(side))
                .expect("a String takes all");
            writeln!(text, "vn {:.4} {:.4} {:.4}", (x * 0.13).cos() * -0.2, 1.0, 0.0)
                .expect("a String takes all");
        }
    }
    for (a, b) in
        (0..side).flat_map(|j| (1..=side).map(move |i| (j * (side + 1) + i, (j + 1) * (side + 1) + i)))
    {
        let quad = [a, a + 1, b + 1, b];
        let corner = |i: u32| {
            if full { format!("{i}/{i}/{i}") } else { i.to_string() }
        };
        let [a, b, c, d] = quad.map(corner);
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("a String takes all");
    }
    text
}

fn read_obj(c: &mut Criterion) {
    for (name, full) in [("v/vt/vn", true), ("v, normals generated", false)] {
        let text = grid(700, full); // 980,000 triangles
        let mut group = c.benchmark_group(format!("980k triangles, {name}"));
        group.sample_size(10).throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function("rasterd", |bencher| {
            bencher.iter(|| {
                obj::read(black_box(text.as_bytes()), &ObjOptions::default()).expect("a valid file")
            });
        });
        // As near as tobj comes to the same: one index a vertex. It generates no normals.
        let options =
            tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
        group.bench_function("tobj", |bencher| {
            bencher.iter(|| {
                let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
                tobj::load_obj_buf(&mut black_box(text.as_bytes()), &options, no_materials)
                    .expect("a valid file")
            });
        });
        group.finish();
    }
}

criterion_group!(benches, read_obj);
criterion_main!(benches);
