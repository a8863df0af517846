//! All real and all complex roots of polynomials with integer coefficients. Every answer is checked.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use tubecert::Rational;
use tubecert::roots::{complex_roots, real_roots};

#[path = "../tests/polynomials/mod.rs"]
mod polynomials;

use polynomials::{chebyshev, int, random, wilkinson};

/// |C'|^2 of [M98] 5.6.2.
fn m98_5_6_2() -> Vec<Rational> {
    [452, -672, -552, 2912, -588, -2688, 1808].map(int).to_vec()
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("roots");
    let mut both = |name: &str, p: &[Rational], real: Option<usize>| {
        let n = p.len() - 1;
        group.bench_function(BenchmarkId::new(format!("complex/{name}"), n), |b| {
            b.iter(|| assert_eq!(complex_roots(black_box(p)).expect("not 0").len(), n));
        });
        group.bench_function(BenchmarkId::new(format!("real/{name}"), n), |b| {
            b.iter(|| {
                let found = real_roots(black_box(p)).expect("not 0").len();
                assert!(found == real.unwrap_or(found));
            });
        });
    };
    both("m98_5_6_2", &m98_5_6_2(), Some(0));
    for n in [10, 20, 40, 60] {
        both("wilkinson", &wilkinson(n), Some(n));
        both("chebyshev", &chebyshev(n), Some(n));
        let odd = usize::from(n % 2 == 1);
        let p = random(n);
        let real = real_roots(&p).expect("not 0").len();
        assert_eq!(real % 2, odd);
        both("random", &p, Some(real));
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
