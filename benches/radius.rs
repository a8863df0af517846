//! From a validated spine to delta at the relative width 1e-9; long chains and many curves at 1e-6. Every answer is checked, so that no figure is a figure
//! for a wrong one.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::{Curve, LimitedBy, Radius, RadiusOptions, Spine, radius};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    Curve::from_json_str(&text).unwrap_or_else(|e| panic!("{path}: {e:?}"))
}

fn checked(answer: &Radius, delta: f64, by: LimitedBy) {
    let near = |x: f64| (x - delta).abs() <= 1e-5 * delta;
    assert!(answer.complete && answer.delta.is_within(1e-9), "{answer:?}");
    assert!(near(answer.delta.lo) && near(answer.delta.hi) && answer.limited_by == by, "{answer:?}");
}

fn bench(c: &mut Criterion) {
    use LimitedBy::{BodyToBody, Curvature, EndToBody};
    let options = RadiusOptions::new().rel_width(1e-9);
    let mut group = c.benchmark_group("radius");
    // the last as sampled by tests/oracle
    for (name, curve, delta, by) in [
        ("m98_5_3", file("m98_5_3"), 0.020_508_6, Curvature),
        ("m98_5_2", file("m98_5_2"), 0.092_534_3, EndToBody),
        ("trefoil", file("trefoil"), 0.520_235, BodyToBody),
        ("circle_exact", file("circle_exact"), 1.0, Curvature),
        ("hairpin", shapes::hairpin(shapes::int(3), shapes::int(1)), 1.0, Curvature),
        ("torus_knot_40_spans", shapes::torus_knot(2, 3, 40), 0.835_101, BodyToBody),
    ] {
        let spine = Spine::from_curve(curve).expect("a spine");
        group.bench_function(name, |b| {
            b.iter(|| {
                let answer = radius(black_box(&spine), &options).expect("an answer");
                checked(&answer, delta, by);
            });
        });
    }
    group.finish();
}

/// Long chains, on one thread and on all.
fn long(c: &mut Criterion) {
    const UNIT: i64 = 1_000_000_000;
    let options = RadiusOptions::new().rel_width(1e-6);
    let mut group = c.benchmark_group("long");
    group.sample_size(10);
    for (name, curve) in [
        ("torus_knot_10000", shapes::knot(2, 3, 10_000, UNIT)),
        ("torus_knot_40000", shapes::knot(2, 3, 40_000, UNIT)),
        ("nearly_straight_10000", shapes::nearly_straight(10_000)),
        ("spiral_10000", shapes::spiral(10_000)),
    ] {
        for threads in [1, 0] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let all = || {
                let spine = Spine::from_curve(black_box(curve.clone())).expect("a spine");
                let answer = radius(&spine, &options).expect("an answer");
                assert!(answer.complete && answer.delta.is_within(1e-6), "{answer:?}");
            };
            let name = format!("{name}_{}", if threads == 1 { "one_thread" } else { "all_cores" });
            group.bench_function(name, |b| b.iter(|| pool.install(all)));
        }
    }
    group.finish();
}

/// From text to answer, as in a batch.
fn cubics(c: &mut Criterion) {
    let options = RadiusOptions::new().rel_width(1e-6);
    let texts = shapes::random_cubics(1000);
    let mut group = c.benchmark_group("cubics");
    group.throughput(Throughput::Elements(texts.len() as u64));
    group.bench_function("random_1000", |b| {
        b.iter(|| {
            for text in &texts {
                let spine = Spine::from_json_str(black_box(text)).expect("a spine");
                assert!(radius(&spine, &options).expect("an answer").delta.is_within(1e-6));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, bench, long, cubics);
criterion_main!(benches);
