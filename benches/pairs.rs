//! From a validated spine to all its stationary pairs. Each bench asserts its answer.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::{Curve, PairsOptions, Spine, pairs};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

fn spine(name: &str) -> Spine {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Spine::from_json_str(&std::fs::read_to_string(path).expect("a file")).expect("a spine")
}

fn closed(curve: Curve) -> Spine {
    Spine::from_curve(curve).expect("a spine")
}

fn all(c: &mut Criterion) {
    let mut group = c.benchmark_group("pairs");
    for (name, spine, count) in [
        ("m98_5_3", spine("m98_5_3"), 4),
        ("m98_5_4", spine("m98_5_4"), 3),
        ("trefoil", spine("trefoil"), 12),
        ("torus knot, 40 spans", closed(shapes::torus_knot(2, 3, 40)), 32),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let answer = pairs(black_box(&spine), &PairsOptions::new()).expect("an answer");
                assert!(answer.complete && answer.narrow);
                assert_eq!(answer.pairs.len(), count);
            });
        });
    }
    // every antipodal pair is stationary: a bounded number of undecided cells
    let circle = spine("circle_exact");
    group.bench_function("circle_exact", |b| {
        b.iter(|| assert_eq!(pairs(black_box(&circle), &PairsOptions::new()).expect("an answer").undecided.len(), 16));
    });
    group.finish();
}

criterion_group!(benches, all);
criterion_main!(benches);
