//! Replaying certificates: decoded text and curve to `Verified`. Every certificate is of an answer at 1e-9.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::{Certificate, Curve, RadiusOptions, Spine, radius, verify};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    Curve::from_json_str(&text).unwrap_or_else(|e| panic!("{path}: {e:?}"))
}

fn text(curve: &Curve) -> String {
    let spine = Spine::from_curve(curve.clone()).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().certificate(true)).expect("an answer");
    assert!(answer.complete, "{answer:?}");
    answer.certificate.expect("a certificate").encode()
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("verify");
    for name in ["m98_5_3", "trefoil"] {
        let curve = file(name);
        let text = text(&curve);
        group.bench_function(name, |b| b.iter(|| replay(&curve, &text)));
    }
    group.sample_size(10);
    for spans in [16, 40, 100, 250, 1000] {
        let curve = shapes::knot(2, 3, spans, 1_000_000_000);
        let text = text(&curve);
        eprintln!("torus knot, {spans} spans: {} bytes, {} leaves and nodes", text.len(), text.lines().count());
        group.bench_with_input(BenchmarkId::new("torus_knot", spans), &text, |b, text| b.iter(|| replay(&curve, text)));
    }
    group.finish();
}

fn replay(curve: &Curve, text: &str) {
    let certificate = Certificate::decode(black_box(text).as_bytes()).expect("a certificate");
    verify(&certificate.claim(curve.clone()), &certificate).expect("verified");
}

criterion_group!(benches, bench);
criterion_main!(benches);
