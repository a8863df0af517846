//! |C'|^2 as a sum of two squares: published values, the identity itself in exact arithmetic, counts, certificates.
#![cfg(feature = "search")]

mod mutants;
mod polynomials;
mod random;
mod shapes;

use mutants::*;
use num_traits::{One, Signed, ToPrimitive, Zero};
use polynomials::*;
use proptest::prelude::*;
use random::{settings, small_spine};
use shapes::{Point, bezier, bezier_int};
use tubecert::number::rational_from_f64;
use tubecert::roots::complex_roots;
use tubecert::{
    Certificate, Curve, Enclosure, Rational, SegmentSquares, Spine, Squares, SquaresOptions, squares, verify,
};

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Curve::from_json_str(&std::fs::read_to_string(&path).unwrap()).unwrap()
}

fn answer_to(curve: &Curve, options: &SquaresOptions) -> Squares {
    squares(&Spine::from_curve(curve.clone()).unwrap(), options).unwrap()
}

fn answer(curve: &Curve) -> Squares {
    answer_to(curve, &SquaresOptions::new().certificate(true))
}

fn middle(e: &Enclosure) -> f64 {
    e.lo.midpoint(e.hi)
}

/// The hodograph of one integral segment on 0 .. 1, by rising powers: independent of the library.
fn hodograph(curve: &Curve) -> [Poly; 3] {
    let (n, points) = (curve.degree(), curve.control_points());
    [0, 1, 2].map(|k| {
        let mut sum = vec![Rational::zero(); n];
        for i in 0..n {
            let step = (&points[i + 1][k] - &points[i][k]) * int(n as i64) * shapes::binomial(n - 1, i);
            // t^i (1-t)^(n-1-i)
            let line = vec![int(1), int(-1)];
            let basis = product((0..n - 1 - i).map(|_| line.clone()).chain((0..i).map(|_| vec![int(0), int(1)])));
            for (sum, c) in sum.iter_mut().zip(&basis) {
                *sum += c * &step;
            }
        }
        sum
    })
}

fn speed_squared(curve: &Curve) -> Poly {
    let [x, y, z] = hodograph(curve).map(|p| times(&p, &p));
    let mut f: Poly = x.iter().zip(&y).zip(&z).map(|((x, y), z)| x + y + z).collect();
    while f.last().is_some_and(Zero::is_zero) {
        f.pop();
    }
    f
}

/// Coefficientwise in exact intervals alpha^2 + beta^2 holds f, and is narrow.
fn is_identity(f: &[Rational], two: &tubecert::Decomposition) {
    let exact = |e: &Enclosure| [e.lo, e.hi].map(|x| rational_from_f64(x).unwrap());
    let square = |p: &[Enclosure]| {
        let p: Vec<[Rational; 2]> = p.iter().map(exact).collect();
        let mut sum = vec![[Rational::zero(), Rational::zero()]; 2 * p.len() - 1];
        for (i, [a, b]) in p.iter().enumerate() {
            for (j, [c, d]) in p.iter().enumerate() {
                let ends = [a * c, a * d, b * c, b * d];
                sum[i + j][0] += ends.iter().min().unwrap();
                sum[i + j][1] += ends.iter().max().unwrap();
            }
        }
        sum
    };
    let (a, b) = (square(&two.alpha), square(&two.beta));
    let size = f.iter().map(Signed::abs).max().unwrap();
    for (k, c) in f.iter().enumerate() {
        let zero = [Rational::zero(), Rational::zero()];
        let [p, q] = [a.get(k).unwrap_or(&zero), b.get(k).unwrap_or(&zero)];
        let (lo, hi) = (&p[0] + &q[0], &p[1] + &q[1]);
        assert!(lo <= *c && *c <= hi, "coefficient {k}");
        assert!(&hi - &lo <= &size * q_(1, 10_000_000), "coefficient {k} is wide");
    }
}

fn q_(n: i64, d: i64) -> Rational {
    Rational::new(n.into(), d.into())
}

fn near(x: f64, y: f64) -> bool {
    (x - y).abs() < 1e-7
}

/// By falling powers, the sign of beta free.
fn listed(segment: &SegmentSquares, alpha: &[f64], beta: &[f64]) -> bool {
    let is = |list: &[Enclosure], wanted: &[f64], sign: f64| {
        list.len() == wanted.len() && list.iter().rev().zip(wanted).all(|(e, x)| near(sign * middle(e), *x))
    };
    let found = segment.decompositions.iter();
    found.into_iter().any(|two| is(&two.alpha, alpha, 1.0) && [1.0, -1.0].iter().any(|sign| is(&two.beta, beta, *sign)))
}

#[test]
fn published_values_of_the_quartic() {
    let answer = answer(&file("m98_5_6_2"));
    let segment = &answer.segments[0];
    assert!(answer.complete && segment.count == 4 && segment.decompositions.len() == 4);
    for (re, im) in [(1.063_949_17, 0.494_248_87), (0.415_179_99, 0.389_195_25), (-0.735_766_33, 0.139_862_92)] {
        assert!(segment.roots.iter().any(|root| near(middle(&root.re), re) && near(middle(&root.im), im)));
    }
    let (a, b) = (42.520_583_24, -31.608_221_09);
    // the last printed digits of the source are off by a few units, up to 1e-6
    for (linear, constant, beta) in [
        (-30.417_578_26, 4.118_700_05, [31.617_506_31, 10.102_786_71, -20.857_524_19]),
        (-19.937_766_32, 18.595_401_54, [10.413_994_12, 3.371_938_18, 10.305_874_40]),
        (-40.925_355_16, 11.484_555_72, [43.511_611_16, -7.490_132_10, -17.891_478_01]),
        (-18.688_247_45, 21.079_862_86, [1.480_111_74, -20.964_857_00, -2.763_944_16]),
    ] {
        let found = segment.decompositions.iter().find(|two| (middle(&two.alpha[1]) - linear).abs() < 1e-5);
        let two = found.expect("a decomposition");
        let alpha = [constant, linear, b, a];
        for (e, x) in two.alpha.iter().zip(alpha) {
            assert!((middle(e) - x).abs() < 1e-6, "{e:?} {x}");
        }
        let sign = middle(&two.beta[2]).signum() * f64::signum(beta[0]);
        for (e, x) in two.beta.iter().rev().zip(beta) {
            assert!((sign * middle(e) - x).abs() < 1e-6, "{e:?} {x}");
        }
    }
}

/// [M98] 5.6.1 prints roots and decompositions of f - 9, where f = |C'|^2 of its control points: f(0) = 6^2 + 13.5^2 + 6^2 = 254.25,
/// but the squares printed make 245.25, as if z' were the root of 27.
#[test]
fn published_values_of_the_cubic() {
    let curve = file("m98_5_6_1");
    let mut f = speed_squared(&curve);
    assert_eq!(f[0], q_(1017, 4));
    let answer = answer(&curve);
    let segment = &answer.segments[0];
    assert!(answer.complete && segment.count == 2);
    segment.decompositions.iter().for_each(|two| is_identity(&f, two));
    // the two highest coefficients are those printed
    for two in &segment.decompositions {
        assert!(near(middle(&two.alpha[2]), 8.077_747_21) && near(middle(&two.alpha[1]), 8.913_376_19));
    }
    f[0] -= int(9);
    let roots = complex_roots(&f).unwrap();
    for (re, im) in [(0.806_415_07, 0.448_973_28), (-1.909_863_34, 0.874_390_26)] {
        let found = |root: &tubecert::roots::ComplexRoot| {
            near(root.re().to_f64().unwrap(), re) && near(root.im().to_f64().unwrap(), im)
        };
        assert!(roots.iter().any(found));
    }
    for (alpha, beta) in
        [(-15.612_027_16_f64, [1.230_694_27, 10.689_796_14]), (-9.269_737_68, [-12.622_280_45, 3.436_410_82])]
    {
        let square: f64 = alpha * alpha + beta[0] * beta[0];
        assert!((square - f[0].to_f64().unwrap()).abs() < 1e-6);
    }
    assert!(!listed(segment, &[8.077_747_21, 8.913_376_19, -15.612_027_16], &[10.689_796_14, 1.230_694_27]));
}

/// The integral of a hodograph, as a Bezier segment.
fn spine_of(hodograph: [&[i64]; 3]) -> Curve {
    let powers = hodograph.map(|p| {
        let integral = p.iter().enumerate().map(|(k, c)| q_(*c, k as i64 + 1));
        [Rational::zero()].into_iter().chain(integral).collect::<Poly>()
    });
    shapes::from_powers([&powers[0], &powers[1], &powers[2]], &int(0), &int(1))
}

#[test]
fn counts_with_multiplicities() {
    // a Pythagorean hodograph: |C'| = u^2 + v^2 is a polynomial
    let ph = spine_of([&[3, -2, 0, 0], &[4, 0, -2, 0], &[0; 4]]);
    assert!(answer(&ph).segments[0].count >= 1);
    // |C'|^2 = (t^2 + 1)^2, one pair of multiplicity 2: (3 + 1) / 2 ways
    let double = answer(&spine_of([&[1, 0, -1], &[0, 2, 0], &[0; 3]]));
    let segment = &double.segments[0];
    assert_eq!((segment.roots.len(), segment.roots[0].multiplicity, segment.count), (2, 2, 2));
    assert!(segment.decompositions.iter().any(|two| two.beta.iter().all(|e| *e == Enclosure { lo: 0.0, hi: 0.0 })));
    // a straight spine
    let line = answer(&file("straight_line"));
    assert_eq!((line.segments[0].roots.len(), line.segments[0].count), (0, 1));
    // a real double root outside the segment: C' = (t - 2) (1, t, 1)
    let real = answer(&spine_of([&[-2, 1, 0], &[0, -2, 1], &[-2, 1, 0]]));
    let segment = &real.segments[0];
    assert!(
        segment.roots.iter().any(|root| root.multiplicity == 2 && root.im.hi == 0.0 && near(middle(&root.re), 2.0))
    );
    assert_eq!(segment.count, 1);
}

/// The twist by its definition: N of theory.md, section 6, differenced numerically.
#[test]
fn twists_by_their_definition() {
    for name in ["m98_5_6_1", "m98_5_6_2", "m98_5_2"] {
        let curve = file(name);
        let hodograph = hodograph(&curve).map(|p| p.iter().map(|c| c.to_f64().unwrap()).collect::<Vec<f64>>());
        let value = |p: &[f64], t: f64| p.iter().rev().fold(0.0, |sum, c| sum * t + c);
        let answer = answer(&curve);
        // no great circle misses all tangents of 5.2
        assert_eq!(answer.segments[0].axes.len() > 1, name == "m98_5_2");
        for two in &answer.segments[0].decompositions {
            let coefficients = |list: &[Enclosure]| list.iter().map(middle).collect::<Vec<f64>>();
            let (alpha, beta) = (coefficients(&two.alpha), coefficients(&two.beta));
            for (sign, told) in [1.0, -1.0].into_iter().zip(two.twist) {
                // right-handed coordinates along the axis
                let turned = |axis: [i64; 3], v: [f64; 3]| {
                    let unit = |v: [f64; 3]| {
                        let size = v.iter().map(|x| x * x).sum::<f64>().sqrt();
                        v.map(|x| x / size)
                    };
                    let cross = |a: [f64; 3], b: [f64; 3]| {
                        [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
                    };
                    let up = unit(axis.map(|x| x as f64));
                    let first = unit(cross(up, if axis[0] == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }));
                    [first, cross(up, first), up].map(|row| (0..3).map(|k| row[k] * v[k]).sum::<f64>())
                };
                let normal = |t: f64, phi: f64, axis: [i64; 3]| {
                    let [x, y, z] = turned(axis, [0, 1, 2].map(|k| value(&hodograph[k], t)));
                    let (a, b) = (value(&alpha, t), sign * value(&beta, t));
                    let (re, im) = (a * phi.cos() - b * phi.sin(), a * phi.sin() + b * phi.cos());
                    let along = re * x + im * y;
                    let size = a * a + b * b - along;
                    [z * (re - x) / size, z * (im - y) / size, (x * x + y * y - along) / size]
                };
                let (steps, turns, h) = (400, 24, 1e-5);
                let mut sum = 0.0;
                for i in 0..steps {
                    let t = (i as f64 + 0.5) / steps as f64;
                    let axis = answer.segments[0].axes.iter().find(|part| t <= part.to).unwrap().axis;
                    let tangent = turned(axis, [0, 1, 2].map(|k| value(&hodograph[k], t)));
                    let speed = tangent.iter().map(|x| x * x).sum::<f64>().sqrt();
                    for j in 0..turns {
                        let phi = std::f64::consts::TAU * (f64::from(j) + 0.37) / f64::from(turns);
                        let [n, m, p] = [t, t - h, t + h].map(|t| normal(t, phi, axis));
                        let d: [f64; 3] = std::array::from_fn(|k| (p[k] - m[k]) / (2.0 * h));
                        let cross = [n[1] * d[2] - n[2] * d[1], n[2] * d[0] - n[0] * d[2], n[0] * d[1] - n[1] * d[0]];
                        let along = (0..3).map(|k| cross[k] * tangent[k]).sum::<f64>() / speed;
                        sum += along * along / (f64::from(steps) * f64::from(turns));
                    }
                }
                assert!(told.hi - told.lo <= 1e-3 * told.hi, "three digits: {told:?}");
                assert!((middle(&told) - sum).abs() <= 2e-2 * sum, "{told:?} {sum}");
            }
        }
    }
}

#[test]
fn certificates_and_their_mutants() {
    for curve in [
        file("m98_5_6_1"),
        spine_of([&[1, 0, -1], &[0, 2, 0], &[0; 3]]),
        bezier_int(&[[0, 0, 0], [1, 2, 1], [3, 1, 4]]),
    ] {
        let answer = answer(&curve);
        let certificate = answer.certificate.expect("a certificate");
        let text = certificate.encode();
        verify(&certificate.claim(curve.clone()), &certificate).unwrap();
        let f = speed_squared(&curve);
        let truth = complex_roots(&f).unwrap();
        let changed = |x: &Rational| vec![x + int(1), x - int(1), -x, x * q_(1001, 1000), int(0)];
        let (mut accepted, mut rejected) = (0, 0);
        for mutant in mutants(&text, |line| with_fields(line, |field| numbers(field, changed))) {
            let Ok(certificate) = Certificate::decode(mutant.as_bytes()) else { continue };
            let claim = certificate.claim(curve.clone());
            if verify(&claim, &certificate).is_err() {
                rejected += 1;
                continue;
            }
            accepted += 1;
            let tubecert::Statement::Squares(segments) = claim.statement else { panic!("another kind") };
            let [segment] = &segments[..] else { panic!("another number of segments") };
            assert_eq!(segment.roots.len(), truth.len(), "{mutant}");
            for claimed in &segment.roots {
                let held = truth.iter().filter(|root| {
                    let (r, re, im) = (root.radius(), root.re(), root.im());
                    let meets = |[lo, hi]: &[Rational; 2], x: &Rational| *lo <= x + &r && x - &r <= *hi;
                    meets(&claimed.re, &re) && meets(&claimed.im, &im) && claimed.multiplicity == root.multiplicity()
                });
                assert!(held.count() > 0, "{mutant}");
            }
            for two in &segment.decompositions {
                let exact = |list: &[[Rational; 2]]| -> Vec<Enclosure> {
                    let f = |x: &Rational| x.to_f64().unwrap();
                    list.iter().map(|[lo, hi]| Enclosure { lo: f(lo).next_down(), hi: f(hi).next_up() }).collect()
                };
                let (a, b) = (exact(&two.alpha), exact(&two.beta));
                // the constant and the leading coefficient of alpha^2 + beta^2 = f
                let square = |e: &Enclosure| [e.lo * e.lo, e.hi * e.hi];
                let holds =
                    |e: [f64; 2], x: f64| e[0].min(e[1]) <= x * (1.0 + 1e-9) && x <= e[0].max(e[1]) * (1.0 + 1e-9);
                assert!(holds(square(&a[a.len() - 1]), f[f.len() - 1].to_f64().unwrap()), "{mutant}");
                let (p, q) = (square(&a[0]), square(&b[0]));
                let most = p[0].max(p[1]) + q[0].max(q[1]);
                assert!(f[0].to_f64().unwrap() <= most * (1.0 + 1e-9), "{mutant}");
            }
        }
        assert!(rejected > 30, "{accepted} accepted, {rejected} rejected");
    }
}

/// A straight spine, given in any degree, has no twist.
#[test]
fn a_line_does_not_twist() {
    for two in answer(&file("straight_line")).segments[0].decompositions.iter().flat_map(|two| two.twist) {
        assert!(two.lo == 0.0 && two.hi < 1e-12, "{two:?}");
    }
}

#[test]
fn the_list_may_be_cut() {
    let curve = file("m98_5_6_2");
    let one = answer_to(&curve, &SquaresOptions::new().limit(1));
    let all = answer(&curve);
    assert_eq!((one.segments[0].count, one.segments[0].decompositions.len()), (4, 1));
    assert_eq!(one.segments[0].decompositions[0], all.segments[0].decompositions[0]);
    // 2^20 ways and more: produced one after the other
    let points: Vec<Point> = (0..=24_i64).map(|i| [i * 3, (i * i * 7) % 11, (i * 5) % 7].map(int)).collect();
    let many = answer_to(&bezier(points), &SquaresOptions::new().limit(3));
    assert!(many.segments[0].count > 1 << 20 && many.segments[0].decompositions.len() == 3);
}

proptest! {
    #![proptest_config(settings(40))]

    #[test]
    fn identities_and_certificates(curve in small_spine()) {
        let Ok(spine) = Spine::from_curve(curve.clone()) else { return Ok(()) };
        let options = SquaresOptions::new().limit(2).certificate(true).max_cells(20_000);
        let answer = squares(&spine, &options).unwrap();
        let integral = curve.weights().iter().all(One::is_one) && curve.control_points().len() == curve.degree() + 1;
        if integral {
            let f = speed_squared(&curve);
            prop_assert_eq!(answer.segments[0].roots.iter().map(|root| root.multiplicity).sum::<usize>(), f.len() - 1);
            answer.segments[0].decompositions.iter().for_each(|two| is_identity(&f, two));
        }
        if let Some(certificate) = &answer.certificate {
            let verdict = verify(&certificate.claim(curve.clone()), certificate);
            prop_assert!(verdict.is_ok(), "{}\n{}", verdict.unwrap_err(), curve.to_json());
        }
    }
}
