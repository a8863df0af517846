//! Stationary pairs: published values, a Newton oracle that shares no code, other descriptions of the same curve,
//! degenerate spines, certificates and their mutants.
#![cfg(feature = "search")]

mod mutants;
mod oracle;
mod random;
mod shapes;

use mutants::*;
use num_traits::{Signed, ToPrimitive};
use oracle::Oracle;
use proptest::prelude::*;
use random::*;
use shapes::*;
use tubecert::claim::{PairBox, Pairs as Claimed};
use tubecert::number::{lower_text, parse_rational, rational_from_f64, upper_text};
use tubecert::{
    Certificate, Claim, Curve, Enclosure, Pairs, PairsOptions, Rational, Spine, Statement, StationaryPair, pairs,
    verify,
};

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Curve::from_json_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn solve(curve: &Curve) -> Option<Pairs> {
    let spine = Spine::from_curve(curve.clone()).ok()?;
    Some(pairs(&spine, &PairsOptions::new().certificate(true).max_cells(200_000)).unwrap())
}

fn answer(curve: &Curve) -> Pairs {
    solve(curve).expect("a spine")
}

/// Exactly as printed.
fn claimed(answer: &Pairs) -> Claimed {
    let number = |text: String| parse_rational(&text).unwrap();
    let range = |e: &Enclosure| [number(lower_text(e.lo)), number(upper_text(e.hi))];
    let one = |pair: &StationaryPair| PairBox {
        s: range(&pair.s),
        t: range(&pair.t),
        distance: (number(lower_text(pair.distance.lo)), parse_rational(&upper_text(pair.distance.hi)).ok()),
    };
    Claimed { pairs: answer.pairs.iter().map(one).collect(), undecided: answer.undecided.iter().map(one).collect() }
}

fn proved(curve: &Curve, claimed: Claimed, certificate: &Certificate) -> Result<(), String> {
    let claim = Claim { curve: curve.clone(), statement: Statement::Pairs(claimed) };
    verify(&claim, certificate).map(|_| ()).map_err(|rejection| rejection.to_string())
}

fn holds(e: &Enclosure, x: f64) -> bool {
    e.lo <= x && x <= e.hi
}

/// Whether boxes hold a pair of shares of the domain, seen through f64.
fn listed(curve: &Curve, boxes: &[StationaryPair], pair: [f64; 2], closed: bool) -> bool {
    let (start, end) = curve.domain();
    let (start, length) = (start.to_f64().unwrap(), (end - start).to_f64().unwrap());
    let near = |e: &Enclosure, u: f64| {
        let turns = if closed { [-1.0, 0.0, 1.0].as_slice() } else { &[0.0] };
        let far = |u: f64| (e.lo - start) / length - 1e-7 <= u && u <= (e.hi - start) / length + 1e-7;
        turns.iter().any(|turn| far(u + turn))
    };
    let [s, t] = pair;
    boxes.iter().any(|b| (near(&b.s, s) && near(&b.t, t)) || (near(&b.s, t) && near(&b.t, s)))
}

#[test]
fn published_values() {
    let counts =
        [("m98_5_3", 4), ("m98_5_4", 3), ("m98_5_6_1", 0), ("m98_5_6_2", 0), ("straight_line", 0), ("trefoil", 12)];
    for (name, count) in counts {
        let answer = answer(&file(name));
        assert!(answer.complete && answer.narrow, "{name}");
        assert_eq!(answer.pairs.len(), count, "{name}");
        let curve = file(name);
        proved(&curve, claimed(&answer), &answer.certificate.unwrap()).unwrap();
    }
    let pair = answer(&file("m98_5_3")).pairs[0];
    // [M98] 5.3 prints t = 0.102506, s = 0.952132 (0.9521328), the distance 0.157556
    assert!((pair.t.lo - 0.102_506).abs() < 1e-6 && (pair.s.lo - 0.952_132).abs() < 1e-6);
    assert!((pair.distance.lo - 0.157_556).abs() < 1e-6);
}

/// Every stationary pair that Newton's method finds is listed, and what is listed is stationary.
fn agrees_with_newton(curve: &Curve, count: usize) -> Result<(), String> {
    let Some(answer) = solve(curve) else { return Ok(()) };
    let spine = Spine::from_curve(curve.clone()).unwrap();
    if spine.to_json().is_empty() || answer.undecided.iter().any(|b| b.distance.lo == 0.0) {
        // near a corner, or where it touches itself, slopes of unit tangents tell little
        return Ok(());
    }
    let oracle = Oracle::new(curve);
    let (start, end) = curve.domain();
    let share = |e: &Enclosure| {
        let middle = rational_from_f64(e.lo.midpoint(e.hi)).unwrap();
        ((middle - start) / (end - start)).to_f64().unwrap()
    };
    for pair in &answer.pairs {
        let [f, g, distance] = oracle.slopes(share(&pair.s), share(&pair.t));
        let size = oracle.size();
        if f.abs().max(g.abs()) > 1e-6 || (distance * size - pair.distance.lo).abs() > 1e-6 * size {
            return Err(format!("not stationary: {pair:?} {f:e} {g:e} {distance}"));
        }
    }
    let all: Vec<StationaryPair> = answer.pairs.iter().chain(&answer.undecided).copied().collect();
    for pair in oracle.stationary(count) {
        if !listed(curve, &all, pair, oracle.closed) {
            return Err(format!("not listed: {pair:?} in {all:?}"));
        }
    }
    Ok(())
}

#[test]
fn curves_of_the_files() {
    for name in ["m98_5_1_parabola", "m98_5_2", "m98_5_3", "m98_5_4", "m98_5_5_planar", "pierced_end", "trefoil"] {
        agrees_with_newton(&file(name), 300).unwrap();
    }
    for curve in [torus_knot(2, 3, 24), torus_knot(2, 5, 40)] {
        agrees_with_newton(&curve, 400).unwrap();
        let answer = answer(&curve);
        assert!(answer.complete, "{:?}", answer.undecided);
        proved(&curve, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
    }
}

/// Both parameters of a pair of the trefoil are knots; a box steps over both joints.
#[test]
fn a_pair_at_two_joints() {
    let answer = answer(&file("trefoil"));
    let joints = answer.pairs.iter().find(|pair| holds(&pair.s, 15.0) && holds(&pair.t, 7.0)).expect("the pair");
    assert!(holds(&joints.distance, 1.949_333_333_333_333_4) && joints.distance.is_within(1e-9), "{joints:?}");
}

/// The neck of the peanut is straight up to third order at two knots: a multiple pair, which is not called unique.
#[test]
fn a_multiple_pair() {
    let curve = peanut(q(1, 2));
    let answer = answer(&curve);
    assert!(!answer.complete && answer.pairs.len() == 3);
    assert!(answer.undecided.iter().all(|cell| holds(&cell.distance, 1.0) && cell.distance.is_within(1e-6)));
    assert!(answer.undecided.iter().any(|cell| holds(&cell.s, 15.0) && holds(&cell.t, 7.0)));
    proved(&curve, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
}

/// Whole curves of pairs: few boxes, and no pair is lost.
#[test]
fn families_stay_undecided() {
    let circle = circle(4);
    for curve in [file("circle_exact"), circle, stadium(int(2), int(1)), hairpin(int(3), q(1, 2))] {
        let answer = answer(&curve);
        assert!(!answer.complete && !answer.undecided.is_empty() && answer.undecided.len() <= 64, "{answer:?}");
        assert!(answer.cells < 20_000, "{}", answer.cells);
        proved(&curve, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
        agrees_with_newton(&curve, 200).unwrap();
    }
}

/// A U of two quarter circles: its ends face each other, and (start, finish) is one of a family; and a bow whose ends alone do.
#[test]
fn ends_of_an_open_spine() {
    // x(1 - x) and its slopes: the ends are (0, 0) and (1, 0) with tangents (0, 1) and (0, -1)
    let bow = bezier_int(&[[0, 0, 0], [0, 3, 0], [1, 3, 0], [1, 0, 0]]);
    let answer = answer(&bow);
    assert!(answer.complete, "{answer:?}");
    let ends = answer.pairs.iter().find(|pair| holds(&pair.s, 1.0) && holds(&pair.t, 0.0)).expect("the ends");
    assert_eq!((ends.s.lo, ends.t.hi, ends.distance.hi >= 1.0), (1.0, 0.0, true));
    proved(&bow, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
    // a little less, and a little more, than to the ends
    let shorter = bezier(vec![
        plane(int(0), int(0)),
        plane(q(1, 1000), int(3)),
        plane(q(999, 1000), int(3)),
        plane(int(1), int(0)),
    ]);
    let longer = bezier(vec![
        plane(int(0), int(0)),
        plane(q(-1, 1000), int(3)),
        plane(q(1001, 1000), int(3)),
        plane(int(1), int(0)),
    ]);
    let [shorter, longer] = [shorter, longer].map(|curve| self::answer(&curve));
    assert!(shorter.complete && longer.complete);
    assert_eq!(shorter.pairs.len() + 1, longer.pairs.len() + usize::from(longer.pairs.len() == shorter.pairs.len()));
}

/// Self-crossings are stationary pairs at the distance 0.
#[test]
fn crossings() {
    for (curve, count) in [(alpha(int(0)), 1), (figure_eight(), 1)] {
        let answer = answer(&curve);
        let touching = answer.pairs.iter().filter(|pair| pair.distance.hi == 0.0).count();
        assert_eq!(touching, count, "{answer:?}");
        proved(&curve, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
    }
}

fn changed(e: &Rational, by: &Rational) -> Rational {
    e + by
}

/// Mutants of the claim are rejected unless they claim less.
#[test]
fn claims_that_say_more_are_rejected() {
    for name in ["m98_5_3", "trefoil", "circle_exact"] {
        let curve = file(name);
        let answer = answer(&curve);
        let (claim, certificate) = (claimed(&answer), answer.certificate.unwrap());
        let rejected = |change: &dyn Fn(&mut Claimed)| {
            let mut mutant = claim.clone();
            change(&mut mutant);
            proved(&curve, mutant, &certificate).is_err()
        };
        let tiny = |x: &Rational| x.abs() * q(1, 1_000_000_000_000_000) + q(1, 1_000_000_000_000);
        if !claim.pairs.is_empty() {
            assert!(rejected(&|c| drop(c.pairs.pop())));
            assert!(rejected(&|c| c.pairs.push(c.pairs[0].clone())));
            assert!(rejected(&|c| c.pairs.swap(0, 1)));
            assert!(rejected(
                &|c| c.pairs[0].distance.0 = changed(&c.pairs[0].distance.0, &tiny(&c.pairs[0].distance.0))
            ));
            assert!(rejected(&|c| c.pairs[0].distance.1 = Some(q(1, 1000))));
            assert!(rejected(&|c| c.pairs[0].distance.1 = Some(-int(1000))));
            assert!(rejected(&|c| c.pairs[0].s[0] = c.pairs[0].s[1].clone()));
            assert!(rejected(&|c| c.pairs[0].t[1] = c.pairs[0].t[0].clone()));
            // so wide that the pair need not be alone in it
            assert!(rejected(&|c| c.pairs[0].s[0] = int(-100)));
            assert!(rejected(&|c| c.pairs[0].t[0] = Rational::new_raw((-1).into(), 0.into())));
            assert!(!rejected(&|c| c.pairs[0].distance.1 = None));
            assert!(!rejected(&|c| c.pairs[0].distance.0 = int(0)));
        } else {
            assert!(rejected(&|c| drop(c.undecided.pop())));
            assert!(rejected(&|c| c.undecided[0].distance.0 = q(2, 1)));
            assert!(rejected(&|c| c.undecided[0].distance.1 = Some(q(2, 1))));
            assert!(rejected(&|c| c.undecided[3].s[1] = c.undecided[3].s[0].clone()));
        }
    }
}

/// Forged by readers of the checker: one pair twice, a period apart; a box without width, whose derivatives are unbounded; a
/// point at a corner where the tangent beyond the corner, not that of the box, is at right angles.
#[test]
fn forged_certificates_are_rejected() {
    let closed = r#"{"degree": 3, "control_points": [[0, 0, 0], [4, 0, 1], [5, 3, 0], [1, 4, -1], [0, 0, 0], [4, 0, 1],
        [5, 3, 0]], "knots": [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]}"#;
    let corner = r#"{"degree": 1, "control_points": [[1, -9, 2], [0, 1, 2], [3, 5, 0], [-5, 0, 0], [5, 0, 0]],
        "knots": [0, 0, 1, 2, 3, 4, 4]}"#;
    for (curve, name) in
        [(closed, "closed__pair_twice"), (closed, "closed__box_is_a_point"), (corner, "corner__other_tangent")]
    {
        let path = format!("{}/tests/certificates/forged/{name}.txt", env!("CARGO_MANIFEST_DIR"));
        let certificate = Certificate::decode(&std::fs::read(path).unwrap()).unwrap();
        let claim = certificate.claim(Curve::from_json_slice(curve.as_bytes()).unwrap());
        let why = verify(&claim, &certificate).unwrap_err();
        assert_ne!(why.section, "curve", "{name}: {why}");
    }
}

/// (u^3 - 3u, u^2) has its double points u = +-sqrt 3 and F = 0 at (-1, 2): cut off at 2^-k before or behind -1.
#[test]
fn a_pair_just_off_the_end() {
    for k in (20..60).step_by(3) {
        for (sign, count) in [(1, 1), (-1, 2)] {
            let x = [int(0), int(-3), int(0), int(1)];
            let from = int(-1) + int(sign) * power(2, -k);
            let curve = from_powers([&x, &[int(0), int(0), int(1)], &[]], &from, &int(3));
            let answer = answer(&curve);
            let sure = answer.pairs.len();
            assert!(sure <= count && count <= sure + answer.undecided.len(), "{k} {sign}: {answer:?}");
            proved(&curve, claimed(&answer), answer.certificate.as_ref().unwrap()).unwrap();
        }
    }
}

/// Every certificate with one field or line changed is none, is rejected, or proves what is true.
#[test]
fn mutants_prove_nothing_false() {
    for name in ["m98_5_2", "m98_5_5_planar"] {
        let curve = file(name);
        let answer = answer(&curve);
        let (truth, text) = (claimed(&answer), answer.certificate.unwrap().encode());
        let changed = |x: &Rational| {
            let by = [int(1), int(-1), q(1, 1 << 40), q(-1, 1 << 40)];
            by.iter().map(|by| x + by).chain([-x]).collect()
        };
        let nodes = ["/", "1", "2", "open", "pair 0", "pair 1", "side 1 0", "side 0 1", "side 1 1"];
        let others = |line: &str| {
            let node = ["/", "1", "2"].contains(&line) || line.starts_with("side") || line.starts_with("cone");
            let nodes = nodes.iter().filter(|_| node).map(|node| (*node).to_string());
            with_fields(line, |field| numbers(field, changed)).into_iter().chain(nodes).collect()
        };
        let (mut accepted, mut rejected) = (0, 0);
        for text in mutants(&text, others) {
            let Ok(certificate) = Certificate::decode(text.as_bytes()) else { continue };
            let claim = certificate.claim(curve.clone());
            if verify(&claim, &certificate).is_err() {
                rejected += 1;
                continue;
            }
            accepted += 1;
            let Statement::Pairs(claim) = claim.statement else { panic!("another kind") };
            is_true(&claim, &truth).unwrap_or_else(|why| panic!("{why}\n{text}"));
        }
        println!("{name}: {accepted} accepted, {rejected} rejected");
        assert!(accepted > 10 && rejected > 100);
    }
}

/// Against the pairs as they are: those of a complete answer.
fn is_true(claim: &Claimed, truth: &Claimed) -> Result<(), String> {
    let meets = |[a, b]: &[Rational; 2], [c, d]: &[Rational; 2]| a <= d && c <= b;
    let same =
        |a: &PairBox, b: &PairBox| (meets(&a.s, &b.s) && meets(&a.t, &b.t)) || (meets(&a.s, &b.t) && meets(&a.t, &b.s));
    for claimed in &claim.pairs {
        let held: Vec<&PairBox> = truth.pairs.iter().filter(|pair| same(claimed, pair)).collect();
        let [one] = held[..] else { return Err(format!("{} pairs in {claimed:?}", held.len())) };
        let low = one.distance.1.as_ref().is_none_or(|hi| claimed.distance.0 <= *hi);
        if !low || claimed.distance.1.as_ref().is_some_and(|hi| one.distance.0 > *hi) {
            return Err(format!("a wrong distance: {claimed:?}"));
        }
    }
    for pair in &truth.pairs {
        let told = claim.pairs.iter().chain(&claim.undecided).filter(|claimed| same(claimed, pair)).count();
        if told == 0 {
            return Err(format!("{pair:?} is lost"));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(settings(150))]

    #[test]
    fn nothing_is_lost(curve in spine_anywhere()) {
        agrees_with_newton(&curve, 120).map_err(|why| TestCaseError::fail(format!("{why}\n{}", curve.to_json())))?;
    }

    #[test]
    fn every_answer_has_a_certificate(curve in spine_anywhere()) {
        if let Some(answer) = solve(&curve) {
            let certificate = answer.certificate.clone();
            prop_assert!(certificate.is_some(), "no certificate\n{}", curve.to_json());
            let verdict = proved(&curve, claimed(&answer), &certificate.unwrap());
            prop_assert!(verdict.is_ok(), "{verdict:?}\n{}", curve.to_json());
        }
    }

    /// Another description of the same spine has the same pairs.
    #[test]
    fn described_otherwise(curve in small_spine(), change in change()) {
        let (Some(a), Some((other, factor))) = (solve(&curve), change.apply(&curve)) else { return Ok(()) };
        let Some(b) = solve(&other) else { return Ok(()) };
        if a.complete && b.complete {
            prop_assert_eq!(a.pairs.len(), b.pairs.len(), "{} {:?}", curve.to_json(), change);
            let factor = factor.to_f64().unwrap();
            for (x, y) in a.pairs.iter().zip(&b.pairs) {
                let (lo, hi) = (x.distance.lo * factor * (1.0 - 1e-12), x.distance.hi * factor * (1.0 + 1e-12));
                prop_assert!(lo <= y.distance.hi && y.distance.lo <= hi, "{} {:?}", curve.to_json(), change);
            }
        }
    }
}
