//! From a validated spine to a proved polyline, to the verdict on it, and the exact replay of its certificate. Each bench asserts
//! its answer.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::{CheckOptions, Claim, PolylineOptions, Spine, Statement, Verdict, check, polyline, verify};

fn spine(name: &str) -> Spine {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Spine::from_json_str(&std::fs::read_to_string(path).expect("a file")).expect("a spine")
}

fn made(c: &mut Criterion) {
    let mut group = c.benchmark_group("polyline");
    group.sample_size(10);
    for name in ["trefoil", "m98_5_3"] {
        let spine = spine(name);
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let edges = polyline(&spine, tolerance, &PolylineOptions::new()).expect("an answer").edges;
            group.throughput(Throughput::Elements(edges as u64));
            group.bench_function(BenchmarkId::new(name, format!("{tolerance:e}")), |b| {
                b.iter(|| {
                    let line = polyline(black_box(&spine), tolerance, &PolylineOptions::new()).expect("an answer");
                    assert!(line.is_certified() && line.distance.hi <= tolerance);
                    // few edges: near the asymptotic law
                    assert!(tolerance > 1e-4 || line.edges as f64 <= 1.05 * line.edges_lower_bound);
                });
            });
        }
    }
    group.finish();
}

fn judged(c: &mut Criterion) {
    let mut group = c.benchmark_group("check");
    group.sample_size(10);
    let spine = spine("trefoil");
    let line = polyline(&spine, 1e-4, &PolylineOptions::new().certificate(true)).expect("an answer");
    let (claim, certificate) = (line.claim().expect("a claim"), line.certificate.expect("a certificate"));
    group.throughput(Throughput::Elements(line.edges as u64));
    group.bench_function("trefoil/1e-4", |b| {
        b.iter(|| {
            let answer = check(black_box(&spine), &claim.vertices, 1e-4, &CheckOptions::new()).expect("an answer");
            assert_eq!(answer.verdict, Verdict::Certified);
        });
    });
    let claim = Claim { curve: spine.curve().clone(), statement: Statement::Polyline(claim) };
    group.bench_function("trefoil/1e-4, exact replay", |b| {
        b.iter(|| assert!(verify(black_box(&claim), &certificate).is_ok()));
    });
    group.finish();
}

criterion_group!(benches, made, judged);
criterion_main!(benches);
