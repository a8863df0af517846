//! Inclusion and tightness of both interval backends, against exact rational arithmetic.
//!
//! As in Arb's tests: draw intervals, draw rationals inside them, compute exactly, require the result inside.
#![cfg(feature = "search")]

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use proptest::prelude::*;
use tubecert::enclosure::{Interval as Selected, portable::Interval as Portable, rounding_is_sound};

const INF: f64 = f64::INFINITY;
const TINY: f64 = 5e-324;
const SPECIAL: &[f64] =
    &[0.0, -0.0, 1.0, 0.5, 3.0, TINY, f64::MIN_POSITIVE, f64::MAX, 1e-144, 1e144, 1e-154, 1e154, 1e-162];

/// Bounds of an interval before a backend has seen them.
type Bounds = (f64, f64);

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("finite")
}

fn pow2(k: i32) -> BigRational {
    let p = BigRational::from(BigInt::one() << k.unsigned_abs());
    if k < 0 { p.recip() } else { p }
}

/// Whether the rational `r` lies in `[lo, hi]`.
fn inside(r: &BigRational, (lo, hi): Bounds) -> bool {
    (lo == -INF || exact(lo) <= *r) && (hi == INF || *r <= exact(hi))
}

/// Largest `f64` (or `-inf`) below or at `r`, found by bisection over the ordered bit patterns.
fn floor(r: &BigRational) -> f64 {
    if r.is_negative() {
        let mut x = -toward_zero(&-r);
        if x.is_finite() && exact(x) > *r {
            x = x.next_down();
        }
        return x;
    }
    toward_zero(r)
}

fn toward_zero(r: &BigRational) -> f64 {
    let (mut low, mut high) = (0u64, INF.to_bits());
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if exact(f64::from_bits(middle)) <= *r { low = middle } else { high = middle }
    }
    f64::from_bits(low)
}

fn ceil(r: &BigRational) -> f64 {
    -floor(&-r)
}

/// `lo + t (hi - lo)`; an infinite bound stands for a rational far beyond the largest `f64`.
fn rational_in((lo, hi): Bounds, t: &BigRational) -> BigRational {
    let far = pow2(1100);
    let lo = if lo == -INF { -far.clone() } else { exact(lo) };
    let hi = if hi == INF { far } else { exact(hi) };
    &lo + t * (hi - &lo)
}

/// Finite numbers: small, of any size, special, and around the range limits of the portable error tests.
fn number() -> impl Strategy<Value = f64> {
    let signed = |x: f64, negative: bool| if negative { -x } else { x };
    prop_oneof![
        3 => (-20i32..=20).prop_map(f64::from),
        3 => -2.0..2.0f64,
        2 => any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        2 => (prop::sample::select(SPECIAL), any::<bool>(), 0..3u8).prop_map(
            move |(x, negative, nudge)| {
                let x = match nudge { 1 => x.next_up(), 2 => x.next_down(), _ => x };
                signed(if x.is_finite() { x } else { f64::MAX }, negative)
            }
        ),
        1 => (any::<u32>(), any::<bool>()).prop_map(move |(m, negative)| signed(f64::from(m) * TINY, negative)),
    ]
}

fn bounds() -> impl Strategy<Value = Bounds> {
    prop_oneof![
        3 => number().prop_map(|x| (x, x)),
        2 => (number(), 1..4u32).prop_map(|(x, steps)| {
            let up = (0..steps).fold(x, |y, _| y.next_up());
            (x, up)
        }),
        3 => (number(), number()).prop_map(|(x, y)| (x.min(y), x.max(y))),
        1 => number().prop_map(|x| (-INF, x)),
        1 => number().prop_map(|x| (x, INF)),
        1 => Just((-INF, INF)),
    ]
}

/// A position in `[0, 1]`, often at an end.
fn position() -> impl Strategy<Value = BigRational> {
    prop_oneof![Just(0), Just(255), 0..=255i32].prop_map(|t| BigRational::new(t.into(), 255.into()))
}

/// Fractions of all magnitudes, half of them near a `f64` or exactly on one.
fn fraction() -> impl Strategy<Value = (BigInt, BigInt)> {
    let digits = || prop::collection::vec(any::<u32>(), 1..6);
    let free = (digits(), digits(), any::<bool>(), any::<bool>(), -1250..1250i32).prop_map(|(n, d, minus, flip, k)| {
        let n = BigInt::from_slice(if minus { Sign::Minus } else { Sign::Plus }, &n);
        let d = BigInt::from_slice(if flip { Sign::Minus } else { Sign::Plus }, &d);
        let d = if d.is_zero() { BigInt::one() } else { d };
        if k < 0 { (n, d << -k) } else { (n << k, d) }
    });
    let near = (number(), -1..=1i32, 1..1200i32).prop_map(|(x, side, k)| {
        let r = exact(x) + BigRational::from(BigInt::from(side)) * pow2(-k);
        (r.numer() * 6, r.denom() * 6)
    });
    prop_oneof![free, near]
}

/// The tight enclosure of a finite, nonempty set of extremes.
fn tight(extremes: &[BigRational]) -> Bounds {
    (floor(extremes.iter().min().expect("nonempty")), ceil(extremes.iter().max().expect("nonempty")))
}

/// `got` encloses `want` and each bound is at most `steps` floats wider.
fn within(got: Bounds, want: Bounds, steps: u32) -> bool {
    let down = (0..steps).fold(want.0, |x, _| x.next_down());
    let up = (0..steps).fold(want.1, |x, _| x.next_up());
    down <= got.0 && got.0 <= want.0 && want.1 <= got.1 && got.1 <= up
}

fn moderate(x: f64) -> bool {
    x == 0.0 || (1e-70..1e70).contains(&x.abs())
}

/// One module of tests per backend; `$steps` is how far a bound may lie from tight for `* / sqr sqrt`.
macro_rules! backend {
    ($name:ident, $Interval:ty, $steps:expr) => {
        mod $name {
            use super::*;
            type I = $Interval;

            fn make((lo, hi): Bounds) -> I {
                I::new(lo, hi)
            }

            fn ends(x: I) -> Bounds {
                (x.lo(), x.hi())
            }

            /// Steps allowed, none where every quantity is far from the range limits.
            fn steps(all: &[f64]) -> u32 {
                if all.iter().all(|&x| moderate(x)) { 0 } else { $steps }
            }

            proptest! {
                #![proptest_config(ProptestConfig::with_cases(2000))]

                #[test]
                fn binary_inclusion(a in bounds(), b in bounds(), s in position(), t in position()) {
                    let (x, y) = (rational_in(a, &s), rational_in(b, &t));
                    let (a, b) = (make(a), make(b));
                    prop_assert!(inside(&(&x + &y), ends(a + b)), "{a:?} + {b:?} = {:?}", a + b);
                    prop_assert!(inside(&(&x - &y), ends(a - b)), "{a:?} - {b:?} = {:?}", a - b);
                    prop_assert!(inside(&(&x * &y), ends(a * b)), "{a:?} * {b:?} = {:?}", a * b);
                    if !y.is_zero() {
                        prop_assert!(inside(&(&x / &y), ends(a / b)), "{a:?} / {b:?} = {:?}", a / b);
                    }
                    prop_assert!(inside(&x, ends(a.hull(b))) && inside(&y, ends(a.hull(b))));
                    prop_assert!(inside((&x).min(&y), ends(a.min(b))), "min({a:?}, {b:?})");
                    prop_assert!(inside((&x).max(&y), ends(a.max(b))), "max({a:?}, {b:?})");
                }

                #[test]
                fn unary_inclusion(a in bounds(), s in position(), k in -2300..2300i32) {
                    let (x, a) = (rational_in(a, &s), make(a));
                    prop_assert!(inside(&-&x, ends(-a)), "-{a:?}");
                    prop_assert!(inside(&x.abs(), ends(a.abs())), "|{a:?}|");
                    prop_assert!(inside(&(&x * &x), ends(a.sqr())), "{a:?}^2 = {:?}", a.sqr());
                    prop_assert!(a.abs().lo() >= 0.0 && a.sqr().lo() >= 0.0);
                    prop_assert!(inside(&(&x * pow2(k)), ends(a.scale2(k))), "{a:?} 2^{k} = {:?}", a.scale2(k));
                    prop_assert!(a.mag() == INF || x.abs() <= exact(a.mag()));
                    prop_assert!(!a.is_positive() || x.is_positive());
                    prop_assert!(!a.is_negative() || x.is_negative());
                    prop_assert!(a.mid().is_finite() && a.contains(a.mid()), "mid {a:?} = {}", a.mid());
                    prop_assert_eq!(a.contains(0.0), !a.is_positive() && !a.is_negative());
                    if !x.is_negative() {
                        let (lo, hi) = ends(a.sqrt());
                        prop_assert!(lo >= 0.0 && exact(lo).pow(2) <= x, "sqrt {a:?}");
                        prop_assert!(hi == INF || x <= exact(hi).pow(2), "sqrt {a:?}");
                    }
                }

                #[test]
                fn arithmetic_is_tight(
                    a in bounds().prop_filter("finite", |a| a.0.is_finite() && a.1.is_finite()),
                    b in bounds().prop_filter("finite", |b| b.0.is_finite() && b.1.is_finite()),
                    k in -2300..2300i32,
                ) {
                    let (x, y) = ([exact(a.0), exact(a.1)], [exact(b.0), exact(b.1)]);
                    let corners = |f: fn(&BigRational, &BigRational) -> BigRational| {
                        tight(&[f(&x[0], &y[0]), f(&x[0], &y[1]), f(&x[1], &y[0]), f(&x[1], &y[1])])
                    };
                    let all = [a.0, a.1, b.0, b.1];
                    let (a, b) = (make(a), make(b));
                    prop_assert!(within(ends(a + b), corners(|x, y| x + y), 0), "{a:?} + {b:?} = {:?}", a + b);
                    prop_assert!(within(ends(a - b), corners(|x, y| x - y), 0), "{a:?} - {b:?} = {:?}", a - b);
                    let (got, want) = (ends(a * b), corners(|x, y| x * y));
                    prop_assert!(within(got, want, steps(&all)), "{a:?} * {b:?} = {got:?}, tight {want:?}");
                    if b.contains(0.0) {
                        prop_assert_eq!(ends(a / b), (-INF, INF));
                    } else {
                        let (got, want) = (ends(a / b), corners(|x, y| x / y));
                        prop_assert!(within(got, want, steps(&all)), "{a:?} / {b:?} = {got:?}, tight {want:?}");
                    }
                    let least = if a.contains(0.0) { BigRational::zero() } else { (&x[0]).abs().min((&x[1]).abs()) };
                    let want = tight(&[least.pow(2), exact(a.mag()).pow(2)]);
                    prop_assert!(within(ends(a.sqr()), want, steps(&all[..2])), "{a:?}^2 = {:?}", a.sqr());
                    let want = (floor(&(&x[0] * pow2(k))), ceil(&(&x[1] * pow2(k))));
                    prop_assert!(within(ends(a.scale2(k)), want, 0), "{a:?} 2^{k} = {:?}", a.scale2(k));
                }

                #[test]
                fn sqrt_is_tight(a in bounds().prop_filter("has a root", |a| a.1 >= 0.0)) {
                    let (lo, hi) = ends(make(a).sqrt());
                    let n = steps(&[a.0.max(0.0), a.1.min(f64::MAX)]);
                    let above = (0..=n).fold(lo, |x, _| x.next_up());
                    prop_assert!(exact(above).pow(2) > exact(a.0.max(0.0)), "sqrt {a:?} = [{lo}, {hi}]");
                    if a.1 < INF && hi > 0.0 {
                        let below = (0..=n).fold(hi, |x, _| x.next_down());
                        prop_assert!(exact(below).pow(2) < exact(a.1), "sqrt {a:?} = [{lo}, {hi}]");
                    }
                }

                #[test]
                fn ratio_is_tight((n, d) in fraction()) {
                    let (r, got) = (BigRational::new(n.clone(), d.clone()), ends(I::from_ratio(&n, &d)));
                    prop_assert_eq!(got, (floor(&r), ceil(&r)), "{} / {}", n, d);
                    let got = ends(I::from_bigint(&n));
                    let r = BigRational::from(n);
                    prop_assert_eq!(got, (floor(&r), ceil(&r)));
                }
            }

            #[test]
            fn infinities_and_zeros() {
                let (half, zero) = (I::new(1.0, INF), I::point(-0.0));
                assert_eq!(ends(zero * I::ENTIRE), (0.0, 0.0));
                assert_eq!(ends(half / half), (0.0, INF));
                assert_eq!(ends(I::point(1.0) / half), (0.0, 1.0));
                assert_eq!(ends(half - half), (-INF, INF));
                assert_eq!(ends(half * -half), (-INF, -1.0));
                assert_eq!(ends(half.sqrt()), (1.0, INF));
                assert_eq!(ends(I::new(-2.0, -1.0).sqrt()), (-INF, INF));
                assert_eq!(ends(I::new(-2.0, 4.0).sqrt()), (0.0, 2.0));
                assert_eq!(ends(I::new(-2.0, 1.0).sqr()), (0.0, 4.0));
                assert_eq!(ends(I::point(f64::MAX) + I::point(f64::MAX)), (f64::MAX, INF));
                // found by chance: a sum whose parts overflow on the way
                let (large, all) = (I::point(2.857_466_886_167_981_7e307), I::new(0.0, f64::MAX));
                assert_eq!(ends(large - all).0, -1.511_946_446_245_517_6e308);
                assert_eq!(ends(I::point(TINY) * I::point(TINY)), (0.0, TINY));
                assert_eq!(ends(I::point(TINY).scale2(i32::MAX)), (f64::MAX, INF));
                assert_eq!(ends(I::point(-1.0).scale2(i32::MIN)), (-TINY, 0.0));
                assert_eq!(I::point(TINY).mid(), TINY);
                assert_eq!(I::ENTIRE.mid(), 0.0);
                assert_eq!(I::point(f64::MAX).mid(), f64::MAX);
                for x in [zero, -zero, I::new(-1.0, 0.0).sqr(), -I::new(0.0, 1.0), zero * half] {
                    let zeros = [x.lo(), x.hi()].into_iter().filter(|b| *b == 0.0);
                    assert!(zeros.into_iter().all(f64::is_sign_positive), "{x:?}");
                }
                assert_eq!(format!("{:?}", I::new(-0.5, INF)), "[-0.5, inf]");
            }

            #[test]
            fn ratios_beyond_all_range() {
                let (one, huge) = (BigInt::one(), BigInt::one() << 200_000);
                assert_eq!(ends(I::from_ratio(&huge, &-&one)), (-INF, -f64::MAX));
                assert_eq!(ends(I::from_ratio(&one, &huge)), (0.0, TINY));
                assert_eq!(ends(I::from_ratio(&(&huge << 1), &huge)), (2.0, 2.0));
                assert_eq!(ends(I::from_ratio(&(&huge + 1), &huge)), (1.0, 1.0f64.next_up()));
                assert_eq!(ends(I::from_ratio(&(&huge - 1), &huge)), (1.0f64.next_down(), 1.0));
            }

            #[test]
            #[should_panic(expected = "nonzero denominator")]
            fn zero_denominator() {
                I::from_ratio(&BigInt::one(), &BigInt::zero());
            }

            #[test]
            fn invalid_bounds() {
                for (lo, hi) in [(1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::NAN), (INF, INF), (-INF, -INF)] {
                    match std::panic::catch_unwind(|| ends(I::new(lo, hi))) {
                        Ok(got) => assert!(!cfg!(debug_assertions) && got == (-INF, INF), "[{lo}, {hi}]"),
                        Err(_) => assert!(cfg!(debug_assertions), "[{lo}, {hi}]"),
                    }
                }
            }
        }
    };
}

backend!(portable, Portable, 1);

#[cfg(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma"))]
backend!(native, Selected, 0);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// The portable result encloses the selected one and is at most one step wider at each end.
    #[test]
    fn backends_agree(a in bounds(), b in bounds(), k in -2300..2300i32) {
        let ((p, q), (x, y)) = (
            (Portable::new(a.0, a.1), Portable::new(b.0, b.1)),
            (Selected::new(a.0, a.1), Selected::new(b.0, b.1)),
        );
        let results = [
            ("+", p + q, x + y, 0), ("-", p - q, x - y, 0), ("neg", -p, -x, 0), ("abs", p.abs(), x.abs(), 0),
            ("scale2", p.scale2(k), x.scale2(k), 0), ("*", p * q, x * y, 1), ("/", p / q, x / y, 1),
            ("sqr", p.sqr(), x.sqr(), 1), ("sqrt", p.sqrt(), x.sqrt(), 1),
        ];
        for (op, wide, narrow, steps) in results {
            prop_assert!(
                within((wide.lo(), wide.hi()), (narrow.lo(), narrow.hi()), steps),
                "{} {} {}: {:?} against {:?}", format!("{p:?}"), op, format!("{q:?}"), wide, narrow
            );
        }
    }
}

#[test]
fn self_test_passes_here() {
    assert!(rounding_is_sound());
}

#[test]
fn intervals_cross_threads() {
    fn check<T: Copy + Send + Sync + std::fmt::Debug>() {}
    check::<Selected>();
    check::<Portable>();
}
