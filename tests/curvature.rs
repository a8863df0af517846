//! Critical points of curvature, against published values, exact samples and Sturm's theorem; certificates and limits.
#![cfg(feature = "search")]

mod mutants;
mod oracle;
mod random;
mod shapes;

use mutants::*;
use num_traits::{One, Signed, Zero};
use oracle::{Oracle, exact, root};
use proptest::prelude::*;
use random::*;
use shapes::*;
use tubecert::claim::CriticalPoints;
use tubecert::{
    Certificate, Claim, CriticalKind, CriticalPoint, Curvature, CurvatureOptions, Curve, Enclosure, Rational, Spine,
    Statement, curvature, verify,
};

use CriticalKind::{Inflection, Joint, Maximum, Minimum};

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Curve::from_json_str(&std::fs::read_to_string(&path).unwrap()).unwrap()
}

fn answer_to(curve: &Curve, options: &CurvatureOptions) -> Curvature {
    curvature(&Spine::from_curve(curve.clone()).unwrap_or_else(|e| panic!("{e:?}\n{}", curve.to_json())), options)
        .unwrap()
}

fn answer(curve: &Curve) -> Curvature {
    answer_to(curve, &CurvatureOptions::new())
}

fn kinds(answer: &Curvature) -> Vec<Option<CriticalKind>> {
    answer.critical_points.iter().map(|p| p.kind).collect()
}

fn holds(e: &Enclosure, x: f64, slack: f64) -> bool {
    e.lo <= x + slack && x - slack <= e.hi
}

// ---------------------------------------------------------------------------------------------------------------
// Oracles.

/// Samples kappa exactly: between critical points it is monotone, they hold its values, kappa_max is above.
fn agrees_with_samples(curve: &Curve, answer: &Curvature, count: i64) {
    let oracle = Oracle::new(curve);
    let json = curve.to_json();
    // the square of a bound, exactly
    let square = |x: f64| if x.is_finite() { Some(exact(x) * exact(x)) } else { None };
    let most = square(answer.kappa_max.hi);
    let meets = |from: &Rational, to: &Rational| {
        answer.critical_points.iter().any(|p| exact(p.t.lo) <= *to && (p.t.hi.is_infinite() || *from <= exact(p.t.hi)))
    };
    for (span, [a, b]) in oracle.knots().iter().enumerate() {
        let constant = answer.constant.iter().find(|s| *a <= exact(s.from) && exact(s.to) <= *b && s.from <= s.to);
        let samples: Vec<(Rational, Rational)> = (0..=count)
            .map(|i| {
                let t = a + (b - a) * q(i, count);
                let kappa = oracle.kappa_sq(span, &t);
                (t, kappa)
            })
            .collect();
        for (t, kappa) in &samples {
            assert!(most.as_ref().is_none_or(|most| kappa <= most), "kappa_max at {t}\n{json}");
            if let Some(stretch) = constant {
                assert!(
                    square(stretch.kappa.lo).unwrap() <= *kappa && *kappa <= square(stretch.kappa.hi).unwrap(),
                    "{json}"
                );
            }
        }
        for three in samples.windows(3) {
            let [(p, x), (_, y), (r, z)] = three else { unreachable!() };
            let extremum = (x < y && y > z) || (x > y && y < z) || x == y || y == z;
            assert!(constant.is_some() || !extremum || meets(p, r), "an extremum between {p} and {r}\n{json}");
        }
    }
    // kappa_max is there
    let at = exact(0.5 * (answer.at.lo + answer.at.hi));
    let sides = oracle.knots().into_iter().enumerate().filter(|(_, [a, b])| *a <= at && at <= *b);
    let seam = (oracle.closed && at == oracle.knots()[0][0]).then(|| oracle.knots().pop().unwrap()[1].clone());
    let there = sides.map(|(span, _)| oracle.kappa_sq(span, &at));
    let there = there.chain(seam.map(|end| oracle.kappa_sq(oracle.knots().len() - 1, &end))).map(|k| root(&k));
    assert!(there.fold(0.0, f64::max) >= answer.kappa_max.lo * (1.0 - 1e-6), "{answer:?}\n{json}");
    // values
    for p in answer.critical_points.iter().filter(|p| p.unique && p.t.hi - p.t.lo < 1e-6) {
        let t = exact(0.5 * (p.t.lo + p.t.hi));
        let all = oracle.knots();
        let near = |span: &usize| all[*span][0] <= exact(p.t.hi) && exact(p.t.lo) <= all[*span][1];
        // on a closed curve the seam has a side at the end
        let mut spans: Vec<usize> = (0..all.len()).filter(near).collect();
        if oracle.closed && exact(p.t.lo) <= all[0][0] {
            spans.push(all.len() - 1);
        }
        let value = |span: usize| {
            let at =
                if oracle.closed && span + 1 == all.len() && exact(p.t.lo) <= all[0][0] { &all[span][1] } else { &t };
            root(&oracle.kappa_sq(span, at.clamp(&all[span][0], &all[span][1])))
        };
        let greater = spans.into_iter().map(value).fold(0.0, f64::max);
        assert!(holds(&p.kappa, greater, 1e-5 * (greater + answer.kappa_max.hi * 1e-3)), "{p:?} {greater}\n{json}");
    }
}

type Poly = Vec<Rational>;

fn times(p: &[Rational], q: &[Rational]) -> Poly {
    let mut product = vec![Rational::zero(); (p.len() + q.len()).saturating_sub(1)];
    for (i, a) in p.iter().enumerate() {
        for (j, b) in q.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

fn sum(p: &[Rational], q: &[Rational], factor: i64) -> Poly {
    let mut sum = p.to_vec();
    sum.resize(p.len().max(q.len()), Rational::zero());
    sum.iter_mut().zip(q).for_each(|(s, c)| *s += c * int(factor));
    sum
}

fn slope(p: &[Rational]) -> Poly {
    p.iter().enumerate().skip(1).map(|(k, c)| c * int(k as i64)).collect()
}

fn trimmed(mut p: Poly) -> Poly {
    while p.last().is_some_and(Zero::is_zero) {
        p.pop();
    }
    p
}

/// The numerator of the derivative of kappa^2 = |C' x C''|^2 / |C'|^6 of a Bezier segment, in the power basis on [0, 1]: with
/// C = r/w, C' = a/w^2 and a x a' = w^4 C' x C'', kappa^2 = |a x a'|^2 w^4 / |a|^6.
fn numerator(curve: &Curve) -> Poly {
    let n = curve.degree();
    let column = |f: &dyn Fn(usize) -> Rational| -> Poly {
        let mut p = vec![Rational::zero(); n + 1];
        for i in 0..=n {
            for j in 0..=n - i {
                let sign = if j % 2 == 1 { -1 } else { 1 };
                p[i + j] += f(i) * binomial(n, i) * binomial(n - i, j) * int(sign);
            }
        }
        p
    };
    let w = column(&|i| curve.weights()[i].clone());
    let r = [0, 1, 2].map(|k| column(&|i| &curve.control_points()[i][k] * &curve.weights()[i]));
    let a = r.each_ref().map(|r| sum(&times(&slope(r), &w), &times(r, &slope(&w)), -1));
    let b = a.each_ref().map(|a| slope(a));
    let c = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| sum(&times(&a[i], &b[j]), &times(&a[j], &b[i]), -1));
    let square = |v: &[Poly; 3]| v.iter().fold(vec![], |all, p| sum(&all, &times(p, p), 1));
    let (aa, cc) = (square(&a), square(&c));
    let grown = sum(&times(&slope(&cc), &times(&w, &aa)), &times(&slope(&w), &times(&cc, &aa)), 4);
    trimmed(sum(&grown, &times(&cc, &times(&w, &slope(&aa))), -3))
}

fn value(p: &[Rational], x: &Rational) -> Rational {
    p.iter().rev().fold(Rational::zero(), |v, c| v * x + c)
}

/// Sturm's chain; its last element is the greatest common divisor with the derivative.
fn chain(p: &[Rational]) -> Vec<Poly> {
    let mut chain = vec![p.to_vec(), trimmed(slope(p))];
    while !chain[chain.len() - 1].is_empty() {
        let [a, b] = [&chain[chain.len() - 2], &chain[chain.len() - 1]];
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let factor = &rest[rest.len() - 1] / &b[b.len() - 1];
            let shift = rest.len() - b.len();
            for (i, c) in b.iter().enumerate() {
                rest[i + shift] -= &factor * c;
            }
            rest.pop();
        }
        let size = rest.iter().map(Signed::abs).max().filter(|size| !size.is_zero()).unwrap_or_else(Rational::one);
        chain.push(trimmed(rest.iter().map(|c| -c / &size).collect()));
    }
    chain.pop();
    chain
}

fn quotient(p: &[Rational], d: &[Rational]) -> Poly {
    let (mut rest, mut quotient) = (p.to_vec(), vec![]);
    while rest.len() >= d.len() {
        let (factor, shift) = (&rest[rest.len() - 1] / &d[d.len() - 1], rest.len() - d.len());
        for (i, c) in d.iter().enumerate() {
            rest[i + shift] -= &factor * c;
        }
        rest.pop();
        quotient.insert(0, factor);
    }
    quotient
}

/// The number of distinct zeros in (from, to].
fn sturm(chain: &[Poly], from: &Rational, to: &Rational) -> usize {
    let changes = |x: &Rational| {
        let signs: Vec<bool> =
            chain.iter().map(|p| value(p, x)).filter(|v| !v.is_zero()).map(|v| v.is_positive()).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    changes(from) - changes(to)
}

/// As many critical points of one Bezier segment as the numerator has zeros, each in its own interval.
fn agrees_with_sturm(curve: &Curve, answer: &Curvature) {
    let p = numerator(curve);
    let (domain, json) = (curve.domain(), curve.to_json());
    if p.is_empty() {
        assert!(answer.critical_points.is_empty() && answer.constant.len() == 1, "{answer:?}\n{json}");
        return;
    }
    let all = chain(&p);
    let multiple = &all[all.len() - 1];
    // at a multiple zero Sturm's chain counts nothing
    let simple = quotient(&p, multiple);
    let (p, chain) = (simple.clone(), chain(&simple));
    let local = |t: f64| ((exact(t) - domain.0) / (domain.1 - domain.0)).clamp(int(0), int(1));
    let at_zero = usize::from(p[0].is_zero());
    assert_eq!(answer.critical_points.len(), sturm(&chain, &int(0), &int(1)) + at_zero, "{answer:?}\n{json}");
    for point in answer.critical_points.iter().filter(|point| point.unique) {
        let (from, to) = (local(point.t.lo), local(point.t.hi));
        let inside = sturm(&chain, &from, &to) + usize::from(value(&p, &from).is_zero());
        assert_eq!(inside, 1, "{point:?}\n{json}");
    }
    // simple zeros only, if all are called unique
    if answer.critical_points.iter().all(|point| point.unique) {
        let inside = |point: &CriticalPoint| {
            let (from, to) = (value(multiple, &local(point.t.lo)), value(multiple, &local(point.t.hi)));
            !(from * to).is_negative()
        };
        assert!(answer.critical_points.iter().all(inside), "{json}");
    }
}

// ---------------------------------------------------------------------------------------------------------------
// Certificates.

/// The answer replays as printed; the text of its certificate.
fn replays(curve: &Curve, options: &CurvatureOptions) -> String {
    let answer = answer_to(curve, &options.clone().certificate(true));
    let json = curve.to_json();
    let certificate = answer.certificate.clone().unwrap_or_else(|| panic!("no certificate {answer:?}\n{json}"));
    let text = certificate.encode();
    let certificate = Certificate::decode(text.as_bytes()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(certificate.encode(), text);
    let claim = certificate.claim(curve.clone());
    if let Err(rejection) = verify(&claim, &certificate) {
        panic!("{rejection}\n{answer:?}\n{text}\n{json}");
    }
    text
}

#[test]
fn published_values() {
    for (name, zeros, kappa, t) in [
        ("m98_5_3", 3, Some(48.7601), Some(0.706_018)),
        ("m98_5_4", 3, Some(31.272_916), Some(0.761_006)),
        ("m98_5_6_1", 1, None, None),
        ("m98_5_6_2", 2, None, None),
        ("m98_5_1_parabola", 1, Some(2.0), Some(0.5)),
    ] {
        let curve = file(name);
        let answer = answer(&curve);
        assert!(answer.complete && answer.critical_points.iter().all(|p| p.unique), "{name} {answer:?}");
        assert_eq!(answer.critical_points.len(), zeros, "{name}");
        assert!(answer.kappa_max.is_within(1e-9) && answer.at.hi - answer.at.lo <= 1e-9);
        if let Some(kappa) = kappa {
            assert!(holds(&answer.kappa_max, kappa, 5e-5 * kappa / 48.0), "{name} {answer:?}");
        }
        if let Some(t) = t {
            assert!(holds(&answer.at, t, 5e-7), "{name} {answer:?}");
        }
        agrees_with_sturm(&curve, &answer);
        agrees_with_samples(&curve, &answer, 200);
        replays(&curve, &CurvatureOptions::new());
    }
}

#[test]
fn circles_and_lines_are_constant() {
    let answer_circle = answer(&file("circle_exact"));
    assert!(answer_circle.complete && answer_circle.critical_points.is_empty());
    assert_eq!(answer_circle.constant.len(), 4);
    assert_eq!(answer_circle.kappa_max, Enclosure { lo: 1.0, hi: 1.0 });
    let line = answer(&file("straight_line"));
    assert!(line.complete && line.critical_points.is_empty());
    assert_eq!(line.kappa_max, Enclosure { lo: 0.0, hi: 0.0 });
    for curve in [
        file("circle_exact"),
        file("straight_line"),
        circle(3),
        circle(4),
        hairpin(int(3), q(1, 3)),
        stadium(int(2), int(7)),
    ] {
        replays(&curve, &CurvatureOptions::new());
        agrees_with_samples(&curve, &answer(&curve), 12);
    }
}

#[test]
fn curvature_jumps_where_a_line_meets_a_circle() {
    let answer = answer(&hook(q(1, 50)));
    assert_eq!(kinds(&answer), [Some(Joint)]);
    assert!(answer.critical_points[0].unique && answer.complete);
    assert!(holds(&answer.kappa_max, 50.0, 1e-12) && holds(&answer.critical_points[0].kappa, 50.0, 1e-12));
    assert_eq!(answer.constant.len(), 2);
    assert_eq!(answer.constant[0].kappa, Enclosure { lo: 0.0, hi: 0.0 });
}

fn graph(y: &[i64], from: Rational, to: Rational) -> Curve {
    let y: Vec<Rational> = y.iter().map(|c| int(*c)).collect();
    from_powers([&[int(0), int(1)], &y, &[]], &from, &to)
}

#[test]
fn inflections_have_curvature_zero() {
    let zero = Enclosure { lo: 0.0, hi: 0.0 };
    // y = x^3 turns at 0; rational, irrational and dyadic places
    for (from, to) in [(int(-1), int(2)), (int(-1), int(1)), (q(-1, 3), q(3, 7))] {
        let curve = graph(&[0, 0, 0, 1], from, to);
        for curve in [curve.clone(), rotated(&curve, [1, 2, 3, 4]), reversed(&curve)] {
            let answer = answer(&curve);
            let inflections: Vec<_> = answer.critical_points.iter().filter(|p| p.kind == Some(Inflection)).collect();
            assert_eq!(inflections.len(), 1, "{answer:?}");
            assert!(inflections[0].unique && inflections[0].kappa == zero && answer.complete);
            agrees_with_sturm(&curve, &answer);
            replays(&curve, &CurvatureOptions::new());
        }
    }
    // b = (t^2 - 2) v with v constant, at an irrational place, and in space: b = 6 t (0, ., .) at 0 alone
    let curve = from_powers([&[int(0), int(1)], &[int(0), int(0), int(-12), int(0), int(1)], &[]], &int(1), &int(2));
    let planar = answer(&curve);
    assert_eq!(kinds(&planar).iter().filter(|kind| **kind == Some(Inflection)).count(), 1, "{planar:?}");
    replays(&curve, &CurvatureOptions::new());
    let space = from_powers(
        [&[int(0), int(1)], &[int(0), int(0), int(0), int(1)], &[int(0), int(0), int(0), int(0), int(0), int(1)]],
        &int(-1),
        &int(2),
    );
    let answer = answer(&space);
    assert_eq!(kinds(&answer).iter().filter(|kind| **kind == Some(Inflection)).count(), 1, "{answer:?}");
    agrees_with_sturm(&space, &answer);
    replays(&space, &CurvatureOptions::new());
}

#[test]
fn multiple_zeros_are_found_and_not_called_unique() {
    // x^2 + x^4 touches its circle of curvature to the sixth order: N = -240 x^3 + ..
    for (from, to) in [(-1, 1), (-1, 2), (-2, 3), (0, 1), (-1, 0)] {
        let curve = graph(&[0, 0, 1, 0, 1], int(from), int(to));
        let answer = answer(&curve);
        assert_eq!(kinds(&answer), [Some(Maximum)], "{answer:?}");
        assert!(
            !answer.critical_points[0].unique && answer.complete && holds(&answer.kappa_max, 2.0, 0.0),
            "{answer:?}"
        );
        agrees_with_sturm(&curve, &answer);
        replays(&curve, &CurvatureOptions::new());
        // N = 60 x^2 + ..: no extremum
        let curve = graph(&[0, 0, 1, 0, 1, 1], int(from), int(to));
        let answer = answer_to(&curve, &CurvatureOptions::new());
        let double = answer.critical_points.iter().find(|p| !p.unique).unwrap();
        assert!(answer.complete && holds(&double.kappa, 2.0, 0.0), "{answer:?}");
        assert_eq!(
            double.kind,
            if from == 0 {
                Some(Minimum)
            } else if to == 0 {
                Some(Maximum)
            } else {
                None
            }
        );
        agrees_with_sturm(&curve, &answer);
        replays(&curve, &CurvatureOptions::new());
    }
    // b = x^2: a threefold zero of N, at a rational place that is not dyadic
    let curve = graph(&[0, 0, 0, 0, 1], int(-1), int(2));
    let answer = answer(&curve);
    let flat = answer.critical_points.iter().find(|p| p.kind == Some(Inflection)).unwrap();
    assert!(!flat.unique && flat.kappa == Enclosure { lo: 0.0, hi: 0.0 } && answer.complete);
    agrees_with_sturm(&curve, &answer);
}

/// y = x^2 + (1 + e) x^4 has critical points at 0 and about +-sqrt(e/10).
#[test]
fn clusters_are_told_apart() {
    for bits in [10, 20, 40, 60, 100, 200] {
        let e = power(2, -bits);
        for (from, to) in [(-1, 1), (-1, 2)] {
            let y = [int(0), int(0), int(1), int(0), int(1) + &e];
            let curve = from_powers([&[int(0), int(1)], &y, &[]], &int(from), &int(to));
            let answer = answer(&curve);
            assert_eq!(kinds(&answer), [Some(Maximum), Some(Minimum), Some(Maximum)], "{bits} {answer:?}");
            assert!(answer.complete, "{bits} {answer:?}");
            // f64 parameters resolve them or do not
            assert_eq!(answer.critical_points.iter().all(|p| p.unique), bits < 100, "{bits} {answer:?}");
            agrees_with_sturm(&curve, &answer);
            replays(&curve, &CurvatureOptions::new());
        }
    }
}

#[test]
fn zeros_at_ends_and_knots_stand_once() {
    let half = graph(&[0, 0, 1], int(0), int(1));
    let answer_half = answer(&half);
    assert_eq!(kinds(&answer_half), [Some(Maximum)]);
    assert_eq!(answer_half.critical_points[0].t, Enclosure { lo: 0.0, hi: 0.0 });
    assert!(answer_half.critical_points[0].unique);
    replays(&half, &CurvatureOptions::new());
    let whole = graph(&[0, 0, 1], int(-1), int(1));
    for share in [q(1, 2), q(1, 3), q(3, 4)] {
        let cut = with_knot(&whole, &share).unwrap();
        let answer = answer(&cut);
        assert_eq!(kinds(&answer), [Some(Maximum)], "{share} {answer:?}");
        assert!(answer.critical_points[0].unique && holds(&answer.critical_points[0].t, 0.5, 0.0));
        replays(&cut, &CurvatureOptions::new());
    }
    // two halves with different speeds, one of them bent otherwise: a turn of curvature at a joint
    let tent = Curve::new(
        3,
        [[0, 0], [1, 0], [2, 1], [3, 3], [4, 5], [5, 6], [6, 6]].iter().map(|p| plane(int(p[0]), int(p[1]))).collect(),
        None,
        Some([0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2].map(int).to_vec()),
    )
    .unwrap();
    let answer = answer(&tent);
    assert!(answer.complete);
    agrees_with_samples(&tent, &answer, 60);
    replays(&tent, &CurvatureOptions::new());
}

#[test]
fn a_corner_has_a_curvature_on_each_side() {
    let points = [[0, 0], [1, 2], [2, 0], [3, 4], [4, 0]].map(|[x, y]| plane(int(x), int(y)));
    let knots = [0, 0, 0, 1, 1, 2, 2, 2].map(int).to_vec();
    let corner = Curve::new(2, points.to_vec(), None, Some(knots)).unwrap();
    let answer = answer(&corner);
    assert!(answer.complete && kinds(&answer).contains(&Some(Joint)), "{answer:?}");
    agrees_with_samples(&corner, &answer, 50);
    replays(&corner, &CurvatureOptions::new());
}

#[test]
fn any_size_and_place() {
    let curve = file("m98_5_3");
    let plain = answer(&curve);
    for (factor, by) in [(300, 0), (-300, 0), (0, 12), (-200, 5), (3, 40)] {
        let factor = power(10, factor);
        let curve = moved(&scaled(&curve, &factor), &[power(10, by), int(0), -power(10, by)]);
        let answer = answer(&curve);
        assert_eq!(kinds(&answer), kinds(&plain));
        for (p, q) in answer.critical_points.iter().zip(&plain.critical_points) {
            assert!(p.unique && p.t.meets(&q.t), "{p:?} {q:?}");
            let kappa = root(&(exact(p.kappa.lo) * exact(p.kappa.lo) * &factor * &factor));
            assert!(holds(&q.kappa, kappa, 1e-8 * kappa), "{p:?} {q:?}");
        }
        assert!(answer.complete);
        replays(&curve, &CurvatureOptions::new());
    }
}

#[test]
fn narrow_and_wide() {
    let curve = file("m98_5_4");
    for width in [0.5, 1e-3, 1e-12, 1e-14] {
        let answer = answer_to(&curve, &CurvatureOptions::new().rel_width(width));
        assert!(answer.complete, "{width} {answer:?}");
        assert!(answer.critical_points.iter().all(|p| p.kappa.is_within(width) && p.t.hi - p.t.lo <= width));
        agrees_with_sturm(&curve, &answer);
        replays(&curve, &CurvatureOptions::new().rel_width(width));
    }
    // more than f64 can hold: as narrow as it can be, but not complete
    let answer = answer_to(&curve, &CurvatureOptions::new().rel_width(1e-18));
    assert!(!answer.complete && answer.critical_points.iter().all(|p| p.t.hi - p.t.lo < 1e-14), "{answer:?}");
}

#[test]
fn limits_only_widen() {
    for curve in [file("m98_5_3"), file("trefoil"), graph(&[0, 0, 1, 0, 1], int(-1), int(2)), torus_knot(2, 3, 30)] {
        let full = answer(&curve);
        for cells in [0, 1, 2, 5, 20, 50] {
            let options = CurvatureOptions::new().max_cells(cells);
            let answer = answer_to(&curve, &options);
            for p in &full.critical_points {
                assert!(answer.critical_points.iter().any(|e| e.t.lo <= p.t.hi && p.t.lo <= e.t.hi), "{cells} {p:?}");
            }
            assert!(answer.kappa_max.meets(&full.kappa_max) && (answer.complete == answer.stopped.is_none()));
            replays(&curve, &options);
        }
    }
}

#[test]
fn high_degrees_and_many_spans_end() {
    let wave = |n: i64| bezier((0..=n).map(|i| [int(i), int((i * i * 7) % 11), int((i * 5) % 7)]).collect());
    let weighted = |n: i64| {
        let weights = (0..=n).map(|i| int(1 + (i * 3) % 5)).collect();
        Curve::new(n as usize, wave(n).control_points().to_vec(), Some(weights), None).unwrap()
    };
    for curve in [wave(12), wave(24), weighted(8), weighted(12)] {
        let answer = answer(&curve);
        agrees_with_samples(&curve, &answer, if curve.degree() > 20 { 8 } else { 40 });
        assert!(answer.complete, "{answer:?}");
    }
    let answer = answer(&torus_knot(5, 7, 1500));
    assert!(answer.complete && answer.critical_points.len() > 100);
}

/// What a certificate claims: its own statement, and that of the answer.
fn statement(certificate: &Certificate, curve: &Curve) -> CriticalPoints {
    match certificate.claim(curve.clone()).statement {
        Statement::Curvature(points) => points,
        other => panic!("{other:?}"),
    }
}

/// Is a claim true, by the exact samples of the oracle and by a proved answer?
fn is_true(claim: &CriticalPoints, truth: &CriticalPoints, samples: &[Rational]) -> bool {
    let at_most = |a: &Option<Rational>, b: &Option<Rational>| match (a, b) {
        (_, None) => true,
        (None, Some(_)) => false,
        (Some(a), Some(b)) => a <= b,
    };
    let meet = |p: &[Option<Rational>; 2], q: &[Option<Rational>; 2]| at_most(&p[0], &q[1]) && at_most(&q[0], &p[1]);
    let most = claim.kappa_max[1].as_ref();
    let above = most.is_none_or(|most| samples.iter().all(|sq| *sq <= most * most));
    let told = truth.points.iter().all(|point| {
        let near = claim.points.iter().filter(|claimed| meet(&claimed.t, &point.t));
        near.clone().count() > 0 && near.clone().all(|claimed| meet(&claimed.kappa, &point.kappa) || !claimed.unique)
    });
    let alone = claim
        .points
        .iter()
        .filter(|point| point.unique)
        .all(|claimed| truth.points.iter().filter(|point| meet(&claimed.t, &point.t)).count() == 1);
    above && told && alone && meet(&claim.kappa_max, &truth.kappa_max) && meet(&claim.at, &truth.at)
}

/// Straight spines of degree 1, with and without weights, have certificates.
#[test]
fn straight_spines_have_certificates() {
    let points = || vec![plane(int(0), int(0)), plane(int(1), int(2))];
    let weighted = Curve::new(1, points(), Some(vec![int(2), q(1, 3)]), None).unwrap();
    for curve in [bezier(points()), weighted] {
        replays(&curve, &CurvatureOptions::new());
    }
}

/// Every certificate with a line or field changed is none, is rejected, or proves what is true.
#[test]
fn mutants_prove_nothing_false() {
    for curve in [file("m98_5_3"), file("m98_5_1_parabola"), file("m98_5_6_2"), graph(&[0, 1, 0, 1], int(0), int(1))] {
        let certificate = answer_to(&curve, &CurvatureOptions::new().certificate(true)).certificate.unwrap();
        let (truth, text) = (statement(&certificate, &curve), certificate.encode());
        let oracle = Oracle::new(&curve);
        let samples: Vec<Rational> = (0..=200).map(|i| oracle.kappa_sq(0, &q(i, 200))).collect();
        let spelled = |field: &str| match field {
            "maximum" => vec!["minimum".to_string()],
            "minimum" | "inflection" => vec!["maximum".to_string()],
            "unique" => vec!["open".to_string()],
            _ => numbers(field, |x| {
                [int(1), int(-1), q(1, 1 << 40), q(-1, 1 << 40), -x].iter().map(|by| x + by).collect()
            }),
        };
        let (mut accepted, mut rejected) = (0, 0);
        for text in mutants(&text, |line| with_fields(line, spelled)) {
            let Ok(certificate) = Certificate::decode(text.as_bytes()) else { continue };
            let claim = certificate.claim(curve.clone());
            if verify(&claim, &certificate).is_err() {
                rejected += 1;
                continue;
            }
            accepted += 1;
            assert!(is_true(&statement(&certificate, &curve), &truth, &samples), "a false claim is accepted\n{text}");
        }
        assert!(accepted > 3 && rejected > 30, "{accepted} accepted, {rejected} rejected");
    }
}

/// A claim about another curve, or one that says more, is not proved.
#[test]
fn claims_that_say_more_are_rejected() {
    let curve = file("m98_5_3");
    let certificate = answer_to(&curve, &CurvatureOptions::new().certificate(true)).certificate.unwrap();
    let proved = |change: &dyn Fn(&mut CriticalPoints)| {
        let mut points = statement(&certificate, &curve);
        change(&mut points);
        verify(&Claim { curve: curve.clone(), statement: Statement::Curvature(points) }, &certificate).is_ok()
    };
    let tighter = |x: &Option<Rational>, by: Rational| x.as_ref().map(|x| x * by);
    assert!(proved(&|_| {}));
    assert!(!proved(&|c| drop(c.points.pop())));
    assert!(!proved(&|c| c.points.swap(0, 1)));
    assert!(!proved(&|c| c.kappa_max[0] = tighter(&c.kappa_max[1], q(1_000_001, 1_000_000))));
    assert!(!proved(&|c| c.kappa_max[1] = tighter(&c.kappa_max[0], q(999_999, 1_000_000))));
    assert!(!proved(&|c| c.points[0].kind = Some(Minimum)));
    assert!(!proved(&|c| c.points[0].t[0] = c.points[0].t[1].clone()));
    assert!(!proved(&|c| c.points[0].t[1] = Some(int(1))));
    assert!(!proved(&|c| c.points[1].kappa[1] = c.points[1].kappa[0].clone()));
    assert!(!proved(&|c| c.at = [Some(int(0)), Some(q(1, 2))]));
    assert!(!proved(&|c| c.kappa_max[0] = Some(Rational::new_raw((-1).into(), (-1).into()))));
    // the same twice
    assert!(!proved(&|c| c.points.insert(0, c.points[0].clone())));
    assert!(proved(&|c| c.points[0].unique = false));
    assert!(proved(&|c| c.kappa_max = [Some(int(0)), None]));
}

#[test]
fn an_inflection_is_no_minimum_and_has_no_other_curvature() {
    let curve = graph(&[0, 0, 0, 1], int(-1), int(2));
    let certificate = answer_to(&curve, &CurvatureOptions::new().certificate(true)).certificate.unwrap();
    let proved = |change: &dyn Fn(&mut CriticalPoints)| {
        let mut points = statement(&certificate, &curve);
        let k = points.points.iter().position(|point| point.kind == Some(Inflection)).unwrap();
        points.points.swap(0, k);
        change(&mut points);
        points.points.swap(0, k);
        verify(&Claim { curve: curve.clone(), statement: Statement::Curvature(points) }, &certificate).is_ok()
    };
    assert!(proved(&|_| {}));
    assert!(!proved(&|c| c.points[0].kind = Some(Minimum)));
    assert!(!proved(&|c| c.points[0].kappa[0] = None));
}

/// Where the curvature jumps at the seam, that is a critical point at either end of the domain.
#[test]
fn the_seam_stands_at_both_ends() {
    let curve = periodic(2, &[[0, 0, 0], [4, 0, 0], [5, 3, 0], [1, 4, 0]].map(|p: [i64; 3]| p.map(int)));
    let certificate = answer_to(&curve, &CurvatureOptions::new().certificate(true)).certificate.unwrap();
    let finish = curve.domain().1.clone();
    for (more, sound) in [(q(-1, 1000), true), (int(0), false)] {
        let mut points = statement(&certificate, &curve);
        let last = points.points.len() - 1;
        points.points[last].t[1] = Some(&finish + more);
        let claim = Claim { curve: curve.clone(), statement: Statement::Curvature(points) };
        assert_eq!(verify(&claim, &certificate).is_ok(), sound);
    }
}

/// Nearly planar: b almost vanishes where it changes its direction, and the cells show it only when they are short.
#[test]
fn nearly_an_inflection() {
    let tiny = |n: i64| int(n) * power(10, -21);
    let points = [[-2, -5, 5], [4, 1, -1], [-5, 2, -5], [2, 5, 1]];
    let curve = bezier(points.iter().map(|[x, y, z]| [int(*x), int(*y), tiny(*z)]).collect());
    for width in [1e-3, 1e-6, 1e-9, 1e-12] {
        let options = CurvatureOptions::new().rel_width(width);
        assert!(answer_to(&curve, &options).complete);
        replays(&curve, &options);
    }
}

proptest! {
    #![proptest_config(settings(60))]

    #[test]
    fn samples_and_certificates_of_random_spines(curve in spine_anywhere()) {
        if Spine::from_curve(curve.clone()).is_ok() {
            let options = CurvatureOptions::new().certificate(true).max_cells(100_000);
            let answer = answer_to(&curve, &options);
            agrees_with_samples(&curve, &answer, 12);
            if let Some(certificate) = &answer.certificate {
                let verdict = verify(&certificate.claim(curve.clone()), certificate);
                prop_assert!(verdict.is_ok(), "{}\n{}", verdict.unwrap_err(), curve.to_json());
            } else {
                prop_assert!(!answer.complete, "no certificate\n{}", curve.to_json());
            }
        }
    }
}
