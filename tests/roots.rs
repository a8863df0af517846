//! Roots of polynomials: known families, and random ones against Sturm sequences (exact, no shared code).

mod polynomials;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};
use polynomials::*;
use proptest::prelude::*;
use tubecert::Rational;
use tubecert::number::parse_rational;
use tubecert::roots::{ComplexRoot, RealRoot, complex_roots, real_roots};

/// Each interval has one root by Sturm, and there are as many as on the whole line; the intervals are disjoint.
fn agrees_with_sturm(p: &[Rational]) {
    let roots = real_roots(p).unwrap();
    let far = p.iter().map(Signed::abs).fold(Rational::one(), |all, c| all + c) / p[p.len() - 1].abs() + int(1);
    assert_eq!(roots.len(), sturm(p, &-&far, &far), "{p:?}");
    for pair in roots.windows(2) {
        assert!(pair[0].hi() < pair[1].lo(), "{pair:?}");
    }
    for root in &roots {
        let (lo, hi) = (root.lo(), root.hi());
        assert!(if lo == hi { value(p, &lo).is_zero() } else { sturm(p, &lo, &hi) == 1 || value(p, &lo).is_zero() });
    }
}

fn counts(p: &[Rational]) -> Vec<usize> {
    real_roots(p).unwrap().iter().map(RealRoot::multiplicity).collect()
}

fn simple(p: &[Rational], count: usize) {
    assert_eq!(counts(p), vec![1; count]);
}

#[test]
fn wilkinson_and_its_neighbour() {
    simple(&wilkinson(20), 20);
    simple(&wilkinson(40), 40);
    for (k, root) in (1..).zip(real_roots(&wilkinson(20)).unwrap()) {
        assert!(root.lo() <= int(k) && int(k) <= root.hi());
    }
    let mut lowered = wilkinson(20);
    lowered[19] -= q(1, 1 << 23);
    simple(&lowered, 10);
}

#[test]
fn chebyshev_and_legendre() {
    simple(&chebyshev(40), 40);
    simple(&orthogonal(40, |k| [2 * k + 1, k, k + 1]), 40);
}

#[test]
fn mignotte() {
    for (n, a, count) in [(20, 5, 4), (21, 5, 3), (40, 100, 4), (51, 1000, 3)] {
        let mut p = vec![Rational::zero(); n + 1];
        p[n] = int(1);
        for (p, c) in p.iter_mut().zip([-2, 4 * a, -2 * a * a]) {
            *p += int(c);
        }
        simple(&p, count);
    }
}

#[test]
fn mandelbrot() {
    let mut p = vec![int(1)];
    for (degree, count) in [(1, 1), (3, 1), (7, 3), (15, 5), (31, 7), (63, 9), (127, 19)] {
        // p -> x p^2 + 1
        p = times(&times(&p, &p), &[int(0), int(1)]);
        p[0] += int(1);
        assert_eq!(p.len(), degree + 1);
        let found = counts(&p).len();
        assert!(degree < 31 || found == count, "{degree}: {found}");
    }
}

#[test]
fn multiplicities_and_borders() {
    let root = |n: i64, d: i64| vec![q(-n, d), int(1)];
    let quadratic = vec![int(1), int(1), int(1)];
    // 0 twice, 1/3 three times, 1/2 and 1 (cell borders), -4, and a factor without real roots, twice
    let factors = [vec![root(0, 1); 2], vec![root(1, 3); 3], vec![root(1, 2), root(1, 1), root(-4, 1)]].concat();
    let p = product(factors.into_iter().chain([quadratic.clone(), quadratic.clone()]));
    assert_eq!(counts(&p), [1, 2, 3, 1, 1]);
    assert_eq!(counts(&quadratic).len(), 0);
    assert_eq!(counts(&[q(7, 3)]).len(), 0);
    assert_eq!(counts(&[int(0), int(5)]), [1]);
    assert_eq!(counts(&[int(1), int(0), int(0)]).len(), 0);
    assert!(real_roots(&[]).is_err() && real_roots(&[int(0), int(0)]).is_err());
    let decimal = ["-0.042", "0.55", "-1.4", "1"].map(|text| parse_rational(text).unwrap());
    let [a, b, c] = [q(1, 10), q(6, 10), q(7, 10)];
    let expected = product([vec![-&a, int(1)], vec![-&b, int(1)], vec![-&c, int(1)]]);
    assert_eq!(decimal.to_vec(), expected);
    simple(&decimal, 3);
}

#[test]
fn clusters() {
    let tiny = Rational::new(BigInt::one(), BigInt::one() << 200);
    let near = |k: i64| vec![-(q(1, 3) + int(k) * &tiny), int(1)];
    simple(&product([near(0), near(1), near(-1), near(5)]), 4);
    let double = times(&near(0), &near(0));
    assert_eq!(counts(&product([double.clone(), near(1)])), [2, 1]);
    // the double root opened by 2^-400: none, or two
    for (sign, count) in [(1, 0), (-1, 2)] {
        let mut p = double.clone();
        p[0] += &tiny * &tiny * int(sign);
        simple(&p, count);
    }
}

#[test]
fn refinement_keeps_the_root() {
    let p = product([vec![int(-2), int(0), int(1)], vec![q(-1, 3), int(1)]]);
    for mut root in real_roots(&p).unwrap() {
        let length = Rational::new(BigInt::one(), BigInt::one() << 1000);
        root.refine(&length);
        assert!(root.hi() - root.lo() <= length);
        assert!(sturm(&p, &(root.lo() - &length), &root.hi()) == 1);
    }
}

/// A complex number by parts.
type Complex = [Rational; 2];

fn in_disk(root: &ComplexRoot, [x, y]: &Complex) -> bool {
    let (re, im, r) = (root.re() - x, root.im() - y, root.radius());
    &re * &re + &im * &im <= &r * &r
}

/// All roots, each as often as it counts: disks are disjoint, real ones as many as there are, conjugates in pairs, and
/// the sum and the product of the roots are what the coefficients say.
fn disks(p: &[Rational]) -> Vec<ComplexRoot> {
    let roots = complex_roots(p).unwrap();
    for (i, a) in roots.iter().enumerate() {
        for b in &roots[..i] {
            let (re, im, r) = (a.re() - b.re(), a.im() - b.im(), a.radius() + b.radius());
            assert!(&re * &re + &im * &im > &r * &r, "{a:?} {b:?}");
        }
        let conjugate = roots.iter().find(|b| b.re() == a.re() && b.im() == -a.im());
        assert!(conjugate.is_some_and(|b| b.radius() == a.radius() && b.multiplicity() == a.multiplicity()));
    }
    let real = roots.iter().filter(|root| root.im().is_zero());
    let isolated = real_roots(p).unwrap();
    assert_eq!(real.clone().count(), isolated.len());
    for (disk, interval) in real.zip(&isolated) {
        assert!(disk.re() - disk.radius() <= interval.hi() && interval.lo() <= disk.re() + disk.radius());
        assert_eq!(disk.multiplicity(), interval.multiplicity());
    }
    let p = &p[..=p.iter().rposition(|c| !c.is_zero()).unwrap()];
    assert_eq!(roots.iter().map(ComplexRoot::multiplicity).sum::<usize>(), p.len() - 1);
    if p.len() > 1 {
        let times = |root: &ComplexRoot| int(root.multiplicity() as i64);
        let sum: Rational = roots.iter().map(|root| root.re() * times(root)).sum();
        let error: Rational = roots.iter().map(|root| root.radius() * times(root)).sum();
        assert!((sum + &p[p.len() - 2] / &p[p.len() - 1]).abs() <= error);
    }
    roots
}

#[test]
fn complex_roots_of_known_families() {
    let mut mandelbrot = vec![int(1)];
    for _ in 0..5 {
        mandelbrot = times(&times(&mandelbrot, &mandelbrot), &[int(0), int(1)]);
        mandelbrot[0] += int(1);
    }
    for p in [
        wilkinson(20),
        chebyshev(40),
        mandelbrot,
        vec![int(7)],
        vec![int(0), int(0), int(3)],
        vec![int(-5), int(3)],
        product([vec![int(1), int(0), int(1)], vec![int(1), int(0), int(1)], vec![int(2), int(-2), int(1)]]),
    ] {
        disks(&p);
    }
    assert!(complex_roots(&[]).is_err());
    // the roots of unity
    for n in [3, 8, 30] {
        let mut p = vec![Rational::zero(); n + 1];
        (p[0], p[n]) = (int(-1), int(1));
        assert_eq!(disks(&p).len(), n);
    }
}

#[test]
fn complex_clusters() {
    let tiny = Rational::new(BigInt::one(), BigInt::one() << 200);
    // ((x - 1/3)^2 + 1/4)^2 + 2^-400: pairs 2^-200 apart
    let square = vec![q(1, 9) + q(1, 4), q(-2, 3), int(1)];
    let mut p = times(&square, &square);
    assert_eq!(disks(&p).len(), 2);
    p[0] += &tiny * &tiny;
    let mut roots = disks(&p);
    assert_eq!(roots.len(), 4);
    for root in &mut roots {
        let before = [root.re(), root.im(), root.radius()];
        root.refine(&(&tiny * &tiny));
        let [re, im, r] = [root.re() - &before[0], root.im() - &before[1], &before[2] - root.radius()];
        assert!(root.radius() <= &tiny * &tiny && &re * &re + &im * &im <= &r * &r);
    }
    // sizes far apart
    let sizes = [power(2, -300), int(1), power(2, 300)];
    let p = product(sizes.iter().map(|s| vec![s * s, -s, int(1)]));
    assert_eq!(disks(&p).len(), 6);
}

/// Polynomials whose derivative has a content, and pairs far smaller than all else beside real roots alone.
#[test]
fn refinement_of_complex_roots_ends() {
    let length = power(2, -300);
    let binomial =
        |n: usize, c: Rational| (0..=n).map(|k| if k == 0 { c.clone() } else { int(i64::from(k == n)) }).collect();
    let mut all: Vec<Poly> = vec![vec![int(6), int(0), int(4), int(0), int(1)]];
    all.extend([2, 3, 7].map(|n| binomial(n, int(-2))));
    let close = product([binomial(2, int(-2)), binomial(2, int(-2)), binomial(2, int(-2) - power(10, -12))]);
    all.extend([close, times(&[int(-1), int(1)], &binomial(2, power(10, -36)))]);
    for e in [-70, -140, -2000] {
        all.push(times(&binomial(2, int(-1)), &binomial(2, power(2, e))));
    }
    for p in all {
        for mut root in disks(&p) {
            root.refine(&int(0));
            root.refine(&length);
            assert!(root.radius() <= length);
        }
        for mut root in real_roots(&p).unwrap() {
            root.refine(&int(-1));
            root.refine(&length);
            assert!(root.hi() - root.lo() <= length);
        }
    }
}

fn power(base: i64, e: i32) -> Rational {
    int(base).pow(e)
}

proptest! {
    #[test]
    fn known_complex_factors(
        roots in prop::collection::vec((-9_i64..9, -9_i64..9, 1_i64..5, 1_usize..3), 1..5),
    ) {
        let mut expected = std::collections::BTreeMap::<Complex, usize>::new();
        let mut factors = vec![];
        for (x, y, d, m) in roots {
            let (x, y) = (q(x, d), q(y, d).abs());
            let factor = if y.is_zero() { vec![-&x, int(1)] } else { vec![&x * &x + &y * &y, -&x * int(2), int(1)] };
            factors.extend(vec![factor; m]);
            *expected.entry([x.clone(), y.clone()]).or_default() += m;
            if !y.is_zero() {
                *expected.entry([x, -y]).or_default() += m;
            }
        }
        let found = disks(&product(factors));
        prop_assert_eq!(found.len(), expected.len());
        for (z, multiplicity) in &expected {
            let there: Vec<_> = found.iter().filter(|root| in_disk(root, z)).collect();
            prop_assert!(there.len() == 1 && there[0].multiplicity() == *multiplicity);
        }
    }

    #[test]
    fn random_complex(coefficients in prop::collection::vec(-20_i64..20, 1..14)) {
        let p: Poly = coefficients.iter().map(|c| int(*c)).chain([int(1)]).collect();
        disks(&p);
    }

    #[test]
    fn random_polynomials(coefficients in prop::collection::vec(-20_i64..20, 1..12), over in 1_i64..9) {
        let p: Poly = coefficients.iter().map(|c| q(*c, over)).chain([int(1)]).collect();
        agrees_with_sturm(&p);
    }

    #[test]
    fn known_factors(roots in prop::collection::vec((-30_i64..30, 1_i64..12, 1_usize..4), 1..6), complex in 0_usize..3) {
        let factors = roots.iter().flat_map(|(n, d, m)| vec![vec![int(-n), int(*d)]; *m]);
        let p = product(factors.chain(vec![vec![int(3), int(2), int(1)]; complex]));
        let mut expected = std::collections::BTreeMap::<Rational, usize>::new();
        for (n, d, m) in roots {
            *expected.entry(q(n, d)).or_default() += m;
        }
        let found = real_roots(&p).unwrap();
        prop_assert_eq!(found.len(), expected.len());
        for (root, (x, multiplicity)) in found.iter().zip(expected) {
            prop_assert!(root.lo() <= x && x <= root.hi() && root.multiplicity() == multiplicity);
        }
    }
}
