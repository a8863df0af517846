//! The rules against evaluation from their definitions, and certificates made by naive recursion.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing, clippy::float_arithmetic)]

use std::rc::Rc;

use num_bigint::BigInt;
use num_traits::{One, ToPrimitive, Zero};
use proptest::prelude::*;

use super::arc::{Arc, Piece, Spine};
use super::poly::Poly;
use super::rules;
use super::*;
use crate::certificate::{Foot, Node, Tube, Upper};

/// `bent` centred in the middle of both pieces.
const MIDDLE: [i64; 6] = [1 << 31, 1 << 31, 0, 0, 0, 0];
use crate::curve::Curve;
use crate::number::{Rational, compare, parse_rational};

fn q(text: &str) -> Rational {
    parse_rational(text).unwrap()
}

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Curve::from_json_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn curve(json: &str) -> Curve {
    Curve::from_json_str(json).unwrap()
}

/// About 2^20 times the unit vector along `v`.
fn rounded(v: [f64; 3]) -> [i64; 3] {
    let size = v.iter().fold(0.0_f64, |size, c| size.max(c.abs())).max(f64::MIN_POSITIVE);
    v.map(|c| (c / size * 1_048_576.0).round() as i64)
}

fn float(n: &BigInt) -> f64 {
    n.to_f64().unwrap()
}

fn first(f: &Poly) -> f64 {
    float(&f.0[0])
}

/// The point in the middle, and a there.
fn middle(pieces: &[Rc<Piece>]) -> ([f64; 3], [f64; 3]) {
    let piece = &pieces[pieces.len() / 2];
    let value = |f: &Poly| first(&f.at(&q("1/2")));
    let w = value(&piece.full_weight());
    (piece.r.each_ref().map(|r| value(r) / w), piece.a().each_ref().map(value))
}

/// Makes trees by trying the rules in turn.
struct Maker {
    spine: Spine,
    r: Rational,
    nodes: Vec<Node>,
}

impl Maker {
    fn tries(&mut self, tried: impl IntoIterator<Item = (Node, bool)>) -> bool {
        match tried.into_iter().find(|(_, fine)| *fine) {
            Some((node, _)) => self.nodes.push(node),
            None => return false,
        }
        assert!(self.nodes.len() < 400_000, "no certificate in sight");
        true
    }

    fn along(&mut self, arc: &Arc) {
        let fine = arc.len() == 1 && rules::curved(&arc[0], &self.r).iter().all(Poly::is_positive);
        if !self.tries([(Node::Curved, fine)]) {
            self.nodes.push(Node::Split);
            for half in self.spine.halves(arc).unwrap() {
                self.along(&half);
            }
        }
    }

    fn same(&mut self, arc: &Arc) {
        let g = rounded(middle(arc).1);
        let cone = rules::cone(arc, &g).is_ok();
        if !self.tries([(Node::Cone(g), cone)]) {
            self.nodes.push(Node::Split);
            let [first, second] = self.spine.halves(arc).unwrap();
            self.same(&first);
            self.two(&first, &second);
            self.same(&second);
        }
    }

    fn two(&mut self, a: &Arc, b: &Arc) {
        let (p, d) = middle(a);
        let (q, e) = middle(b);
        let [g, far] = [rounded([0, 1, 2].map(|i| d[i] + e[i])), rounded([0, 1, 2].map(|i| p[i] - q[i]))];
        let cone = self.spine.touch(a, b) && rules::cone(a, &g).is_ok() && rules::cone(b, &g).is_ok();
        let mut tried = vec![(Node::Cone(g), cone), (Node::Slab(far), rules::slab(a, b, &far, &self.r).is_ok())];
        if let ([a], [b]) = (&**a, &**b) {
            for of in [[1, 0], [0, 1], [1, 1], [1, -1]] {
                tried.push((Node::Side(of), rules::side(a, b, of).is_ok()));
            }
            tried.push((Node::Bent(MIDDLE), rules::bent(a, b, MIDDLE, &self.r).unwrap().is_positive()));
        }
        if !self.tries(tried) {
            let size = |arc: &Arc| arc.len() as f64 * float(&(&arc.last().unwrap().to - &arc[0].from));
            if size(a) >= size(b) {
                self.nodes.push(Node::SplitFirst);
                for half in self.spine.halves(a).unwrap() {
                    self.two(&half, b);
                }
            } else {
                self.nodes.push(Node::SplitSecond);
                for half in self.spine.halves(b).unwrap() {
                    self.two(a, &half);
                }
            }
        }
    }

    fn end(&mut self, e: &Rc<Piece>, axis: &[i64; 3], arc: &Arc, reverse: bool) {
        let place = [0, 1, 2].map(|i| first(&e.r[i]) / first(&e.w));
        let p = middle(arc).0;
        let far = rounded([0, 1, 2].map(|i| p[i] - place[i]));
        let so_far = self.nodes.iter().all(|node| matches!(node, Node::Local | Node::Split));
        let mut tried = vec![
            (Node::Local, so_far && rules::cone(arc, axis).is_ok()),
            (Node::Slab(far), rules::slab(arc, std::slice::from_ref(e), &far, &self.r).is_ok()),
        ];
        if let [piece] = &**arc {
            for k in [0, 1 << 30, 1 << 31, 3 << 30, 1 << 32] {
                tried.push((Node::Share(k), rules::share(e, piece, k, &self.r).unwrap().is_positive()));
            }
        }
        if !self.tries(tried) {
            self.nodes.push(Node::Split);
            let mut halves = self.spine.halves(arc).unwrap();
            if reverse {
                halves.reverse();
            }
            halves.iter().for_each(|half| self.end(e, axis, half, reverse));
        }
    }
}

fn make(curve: &Curve, lo: &str, hi: Option<&str>, upper: Upper) -> Certificate {
    let lo = (lo != "inf").then(|| q(lo));
    let r = lo.as_ref().unwrap_or(&Rational::zero()).pow(2);
    let bounded = !r.is_zero();
    let mut maker = Maker { spine: Spine::of(curve), r, nodes: vec![] };
    let whole = maker.spine.spans.clone();
    maker.along(&whole);
    let along = std::mem::take(&mut maker.nodes);
    let pairs = bounded.then(|| {
        maker.same(&whole);
        std::mem::take(&mut maker.nodes)
    });
    let ends = (bounded && !maker.spine.closed).then(|| {
        let ends = [maker.spine.spans[0].at(&Rational::zero()), maker.spine.spans.last().unwrap().at(&Rational::one())];
        [false, true].map(|reverse| {
            let e = &ends[usize::from(reverse)];
            let axis = rounded(e.a().each_ref().map(first));
            maker.end(e, &axis, &whole, reverse);
            (axis, std::mem::take(&mut maker.nodes))
        })
    });
    certificate(curve, Tube { lo, hi: hi.map(q), along, pairs, ends, upper })
}

/// Makes, writes, reads and verifies.
fn accepted(name: &str, curve: &Curve, lo: &str, hi: Option<&str>, upper: Upper) -> (Certificate, Verified) {
    let made = make(curve, lo, hi, upper);
    let text = made.encode();
    let certificate = Certificate::decode(text.as_bytes()).unwrap();
    assert_eq!(certificate, made);
    let start = std::time::Instant::now();
    let verified = verify(&certificate.claim(curve.clone()), &certificate).unwrap_or_else(|e| panic!("{name}: {e}"));
    println!("{name}: {:?} for {:?}", start.elapsed(), verified.leaves());
    (certificate, verified)
}

/// The bounds that are claimed for delta.
fn bounds(claim: &Claim) -> [Option<Rational>; 2] {
    match &claim.statement {
        Statement::Radius { lo, hi } => [lo.clone(), hi.clone()],
        other => panic!("{other:?}"),
    }
}

fn certificate(curve: &Curve, tube: Tube) -> Certificate {
    Certificate { digest: curve.digest(), evidence: Evidence::Radius(tube) }
}

/// With another witness.
fn with(certificate: &Certificate, upper: Upper) -> Certificate {
    let mut certificate = certificate.clone();
    tube(&mut certificate).upper = upper;
    certificate
}

fn tube(certificate: &mut Certificate) -> &mut Tube {
    match &mut certificate.evidence {
        Evidence::Radius(tube) => tube,
        other => panic!("{other:?}"),
    }
}

fn refused(curve: &Curve, certificate: &Certificate) -> Rejection {
    verify(&certificate.claim(curve.clone()), certificate).unwrap_err()
}

#[test]
fn parabola() {
    let curve = file("m98_5_1_parabola");
    let upper = Upper::Curvature { span: 0, t: q("1/2") };
    let (certificate, verified) = accepted("parabola", &curve, "0.4999", Some("1/2"), upper.clone());
    assert_eq!((bounds(verified.claim()), verified.closed()), ([Some(q("0.4999")), Some(q("1/2"))], false));

    // the tests of the program read it
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/certificates/accept/m98_5_1_parabola__naive.txt");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(path, certificate.encode()).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), certificate.encode());

    let claimed = |lo: Option<&str>, hi: Option<&str>| {
        let statement = Statement::Radius { lo: lo.map(q), hi: hi.map(q) };
        verify(&Claim { curve: curve.clone(), statement }, &certificate)
    };
    assert_eq!(claimed(Some("0.49991"), Some("1/2")).unwrap_err().section, "lo");
    assert_eq!(bounds(claimed(Some("0.1"), Some("1/2")).unwrap().claim())[0], Some(q("0.1")));
    assert_eq!(claimed(Some("0.1"), Some("0.49995")).unwrap_err().section, "hi");
    assert_eq!(bounds(claimed(Some("0.1"), None).unwrap().claim())[1], None);

    assert_eq!(refused(&file("m98_5_2"), &certificate).section, "curve");
    let changed = |change: fn(&mut Tube)| {
        let mut certificate = certificate.clone();
        change(tube(&mut certificate));
        refused(&curve, &certificate)
    };
    assert_eq!(changed(|c| c.lo = Some(q("0.500001"))).section, "along");
    assert_eq!(changed(|c| c.lo = None).section, "lo");
    assert_eq!(changed(|c| c.lo = Some(q("-1"))).section, "lo");
    assert_eq!(changed(|c| c.hi = Some(q("0.49999"))).section, "upper");
    assert_eq!(changed(|c| c.hi = Some(q("-1/2"))).section, "hi");
    assert_eq!(changed(|c| c.hi = None).section, "upper");
    assert_eq!(changed(|c| c.upper = Upper::None).section, "upper");
    assert_eq!(changed(|c| c.pairs = None).section, "pairs");
    assert_eq!(changed(|c| c.ends = None).section, "start");
    assert_eq!(changed(|c| c.along.truncate(0)).why, "the tree stops short");
    assert_eq!(changed(|c| c.along.push(Node::Curved)).why, "the tree has ended before");
    assert_eq!(changed(|c| c.along[0] = Node::Local).why, "the rule does not belong here");
    assert_eq!(changed(|c| c.along = vec![Node::Split; 2000]).why, "a part deeper than 512 halvings");
    assert_eq!(changed(|c| c.pairs.as_mut().unwrap()[0] = Node::Cone([1, 0, 0])).section, "pairs");
    assert_eq!(changed(|c| c.ends.as_mut().unwrap()[0].0 = [0; 3]).section, "start");
}

/// A caller may spell a bound with `new_raw`: it proves nothing that its value does not.
#[test]
fn bounds_of_a_claim_that_are_not_in_lowest_terms() {
    let curve = file("m98_5_1_parabola");
    let text = include_str!("../../tests/certificates/accept/m98_5_1_parabola__naive.txt");
    let certificate = Certificate::decode(text.as_bytes()).unwrap();
    let raw = |num: i64, den: i64| Some(Rational::new_raw(num.into(), den.into()));
    let proved =
        |lo, hi| verify(&Claim { curve: curve.clone(), statement: Statement::Radius { lo, hi } }, &certificate).is_ok();
    assert!(proved(raw(2, 20), raw(20, 2)));
    // 5 <= delta; delta <= -5; and no numbers at all
    assert!(!proved(raw(-5, -1), None));
    assert!(!proved(raw(0, 1), raw(5, -1)));
    assert!(!proved(raw(0, 0), None));
    assert!(!proved(raw(0, 1), raw(0, 0)));
}

#[test]
fn straight_line() {
    let curve = file("straight_line");
    let (certificate, verified) = accepted("straight line", &curve, "inf", None, Upper::None);
    assert_eq!(bounds(verified.claim()), [None, None]);
    let bent = file("m98_5_1_parabola");
    let forged = Certificate { digest: bent.digest(), ..certificate };
    assert_eq!(refused(&bent, &forged).why, "the spine is not straight");
}

#[test]
fn trefoil() {
    // delta is 0.5625.. to 0.5626
    let (mut certificate, verified) = accepted("trefoil", &file("trefoil"), "0.45", None, Upper::None);
    assert!(verified.closed() && tube(&mut certificate).ends.is_none());
}

#[test]
fn circle() {
    let curve = file("circle_exact");
    let (_, verified) = accepted("circle", &curve, "0.8", Some("1"), Upper::Curvature { span: 0, t: q("1/3") });
    assert!(verified.closed());
}

#[test]
fn pierced_end() {
    accepted("cubic 5.2", &file("m98_5_2"), "0.08", None, Upper::None);
    accepted("quartic 5.3", &file("m98_5_3"), "0.01", None, Upper::None);
    accepted("pierced end", &file("pierced_end"), "1.2", None, Upper::None);
}

#[test]
fn corner() {
    let corner = curve(r#"{"degree": 1, "control_points": [[0, 0], [1, 0], [1, 1]], "knots": [0, 0, 1, 2, 2]}"#);
    let (mut certificate, _) = accepted("corner", &corner, "0", Some("0"), Upper::Corner(1));
    tube(&mut certificate).upper = Upper::Corner(0);
    assert_eq!(refused(&corner, &certificate).why, "the ends are two points");
    tube(&mut certificate).upper = Upper::Corner(2);
    assert_eq!(refused(&corner, &certificate).why, "there is no such joint");
    let smooth = curve(r#"{"degree": 1, "control_points": [[0, 0], [1, 0], [3, 0]], "knots": [0, 0, 1, 2, 2]}"#);
    certificate = with(&certificate, Upper::Corner(1));
    certificate.digest = smooth.digest();
    assert_eq!(refused(&smooth, &certificate).why, "the joint is smooth");
}

#[test]
fn crossing() {
    // a loop: (0, 0) (3, 3) (-2, 3) (1, 0) crosses itself at x = 1/2
    let curve = curve(r#"{"degree": 3, "control_points": [[0, 0], [3, 3], [-2, 3], [1, 0]]}"#);
    let v = |x: &str, y: &str, z: &str| [q(x), q(y), q(z)];
    let witness = |s: [&str; 2], t: [&str; 2]| Upper::Crossing {
        arcs: [s, t].map(|arc| arc.map(q)),
        normal: v("0", "0", "1"),
        first: v("1", "1", "0"),
        second: v("-1", "1", "0"),
    };
    let (certificate, _) = accepted("crossing", &curve, "0", Some("0"), witness(["0.05", "0.15"], ["0.85", "0.95"]));
    let changed = |upper| refused(&curve, &with(&certificate, upper)).why;
    let signs = "the coefficients on opposite sides have no opposite strict signs";
    let (apart, range) = ("the two are not apart on the spine", "a position is out of range");
    assert_eq!(changed(witness(["0", "0.01"], ["0.85", "0.95"])), signs);
    assert_eq!(changed(witness(["0.15", "0.15"], ["0.85", "0.95"])), signs);
    assert_eq!(changed(witness(["0.85", "0.95"], ["0.05", "0.15"])), apart);
    assert_eq!(changed(witness(["0.05", "0.85"], ["0.85", "0.95"])), apart);
    assert_eq!(changed(witness(["0.05", "0.15"], ["0.85", "1.95"])), range);
    assert_eq!(changed(witness(["-0.05", "0.15"], ["0.85", "0.95"])), range);
    // run back, an arc is the same set of points
    accepted("crossing", &curve, "0", Some("0"), witness(["0.15", "0.05"], ["0.85", "0.95"]));
}

/// Arcs in several pieces, across joints and across the seam, run forth and back.
#[test]
fn crossing_on_joints() {
    let points = ["0,0", "2,2", "4,2", "5,0", "4,-2", "2,-2", "0,0", "-2,2", "-4,2", "-5,0", "-4,-2", "-2,-2"]
        .map(|p| format!("[{p}]"));
    let eight = |first: usize| {
        let points: Vec<_> = points.iter().cycle().skip(first).take(15).cloned().collect();
        curve(&format!(
            r#"{{"degree": 3, "control_points": [{}],
                "knots": [-3, -2, -1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]}}"#,
            points.join(", ")
        ))
    };
    let v = |x: &str, y: &str| [q(x), q(y), q("0")];
    let witness = |s: [&str; 2], t: [&str; 2]| Upper::Crossing {
        arcs: [s, t].map(|arc| arc.map(q)),
        normal: [q("0"), q("0"), q("1")],
        first: v("1", "-1"),
        second: v("1", "1"),
    };
    // through the origin at the positions 6 and 12, which is the seam
    for (s, t) in [(["5.9", "6.1"], ["11.9", "12.1"]), (["6.1", "5.9"], ["12.1", "11.9"])] {
        accepted("crossing", &eight(11), "0", Some("0"), witness(s, t));
    }
    // at 5 and 11, which are joints
    let curve = eight(0);
    for (s, t) in [
        (["4.9", "5.1"], ["10.9", "11.1"]),
        (["5.1", "4.9"], ["10.9", "11.1"]),
        (["5.1", "4.9"], ["11.1", "10.9"]),
        (["4.5", "5.5"], ["10.75", "11.25"]),
        (["4.8", "5.1"], ["10.9", "11.2"]),
    ] {
        accepted("crossing", &curve, "0", Some("0"), witness(s, t));
    }
    let (certificate, _) = accepted("crossing", &curve, "0", Some("0"), witness(["4.9", "5.1"], ["10.9", "11.1"]));
    let changed = |upper| refused(&curve, &with(&certificate, upper)).why;
    let signs = "the coefficients on opposite sides have no opposite strict signs";
    assert_eq!(changed(witness(["5.05", "5.1"], ["10.9", "11.1"])), signs);
    assert_eq!(changed(witness(["4.9", "5.1"], ["10.9", "16.95"])), "the two are not apart on the spine");
    for (s, t) in [
        (["-1.1", "-0.9"], ["4.9", "5.1"]),
        (["24.9", "25.1"], ["30.9", "31.1"]),
        (["9223372036854775813.1", "9223372036854775812.9"], ["9223372036854775818.9", "9223372036854775819.1"]),
    ] {
        assert_eq!(changed(witness(s, t)), "a position is out of range");
    }
}

#[test]
fn mirror() {
    // its own image by x -> -x; x = 0 at s = (1 - 1/sqrt 3)/2 = 0.211.. and at 1 - s
    let curve = curve(
        r#"{"degree": 4, "control_points": [[4, -19, -11], [-4, -24, 8], [0, 8, 0], [4, -24, 8], [-4, -19, -11]]}"#,
    );
    let witness = |s: [&str; 2], t: [&str; 2], x: &str, y: &str| Upper::Mirror {
        arcs: [s, t].map(|arc| arc.map(q)),
        normal: [q(x), q(y), q("0")],
    };
    let (s, t) = (["0.2", "0.25"], ["0.8", "0.75"]);
    let (certificate, _) = accepted("mirror", &curve, "0", Some("0"), witness(s, t, "-1/3", "0"));
    let changed = |upper| refused(&curve, &with(&certificate, upper)).why;
    let not_along = "the points of equal parameters are not along the normal";
    assert_eq!(changed(witness(s, ["0.75", "0.8"], "1", "0")), not_along);
    assert_eq!(changed(witness(s, t, "1", "1/9")), not_along);
    assert_eq!(changed(witness(s, t, "0", "0")), "the arcs do not change sides");
    assert_eq!(changed(witness(["0.1", "0.2"], ["0.9", "0.8"], "1", "0")), "the arcs do not change sides");
    assert_eq!(changed(witness(["0.2", "0.5"], ["0.8", "0.5"], "1", "0")), "the two are not apart on the spine");
}

#[test]
fn contact() {
    // two strands of a hairpin at the distance 2, a bend of radius 2 at least between them
    let circle = file("circle_exact");
    let at = |p: &str| Foot::Plane(q(p));
    let n = Spine::of(&circle).spans.len();
    let (certificate, _) = accepted(
        "contact",
        &circle,
        "0.5",
        Some("1"),
        Upper::Contact { x: [q("0"), q("0"), q("0")], feet: [at("0"), at(&format!("{}/2", n))] },
    );
    let changed = |feet| {
        let upper = Upper::Contact { x: [q("0"), q("0"), q("0")], feet };
        refused(&circle, &with(&certificate, upper)).why
    };
    assert_eq!(changed([at("1/3"), at("1/3")]), "the two are not apart on the spine");
    assert_eq!(changed([at("0"), at(&n.to_string())]), "the two are not apart on the spine");
    assert_eq!(changed([at("0"), at("100")]), "a position is out of range");
    let valley = |a: &str, p: &str, b: &str| Foot::Valley([q(a), q(p), q(b)]);
    assert_eq!(changed([valley("0", "1/4", "1/2"), at("1")]), "an end of a valley is not farther");
    assert_eq!(changed([valley("1/2", "1/4", "1/2"), at("1")]), "the positions of a valley are not in order");
}

/// Conditions of the page that the code leaves to others: ends that are one point though lo is > 0, a first weight of 0, and
/// a witness beside lo = inf.
#[test]
fn what_other_conditions_imply_is_refused() {
    let refused_by = |curve: &Curve, lo: Option<&str>, hi: Option<&str>, trees: [Vec<Node>; 4], upper: Upper| {
        let [along, pairs, start, finish] = trees;
        let bounded = lo.is_some_and(|lo| lo != "0");
        let ends = bounded.then_some([([1, 0, 0], start), ([1, 0, 0], finish)]);
        let (lo, hi, pairs) = (lo.map(q), hi.map(q), bounded.then_some(pairs));
        refused(curve, &self::certificate(curve, Tube { lo, hi, along, pairs, ends, upper })).section
    };
    // a loop whose ends meet at a right angle: the pair of its ends, one point, passes no rule
    let bend = curve(r#"{"degree": 4, "control_points": [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]}"#);
    let mut maker = Maker { spine: Spine::of(&bend), r: q("1/1000").pow(2), nodes: vec![] };
    maker.along(&maker.spine.spans.clone());
    let [mut a, mut b] = maker.spine.halves(&maker.spine.spans).unwrap();
    for _ in 0..8 {
        for g in [[1, 0, 0], [0, 1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]] {
            assert!(rules::slab(&a, &b, &g, &maker.r).is_err() && rules::side(&a[0], &b[0], [g[0], g[1]]).is_err());
            assert!(rules::cone(&[&*a, &*b].concat(), &g).is_err());
        }
        assert!(!rules::bent(&a[0], &b[0], MIDDLE, &maker.r).unwrap().is_positive());
        (a, b) = (maker.spine.halves(&a).unwrap()[0].clone(), maker.spine.halves(&b).unwrap()[1].clone());
    }
    let trees = [maker.nodes.clone(), vec![Node::Cone([1, 1, 0])], vec![], vec![]];
    assert_eq!(refused_by(&bend, Some("1/1000"), None, trees, Upper::None), "pairs");
    let weights = r#"{"degree": 2, "control_points": [[0, 0], [1, 1], [2, 0]], "weights": [0, 1, 1]}"#;
    let trees = || [vec![Node::Curved], vec![], vec![], vec![]];
    assert_eq!(refused_by(&curve(weights), Some("0"), None, trees(), Upper::None), "along");
    for upper in [
        Upper::None,
        Upper::Corner(0),
        Upper::Corner(1),
        Upper::Curvature { span: 0, t: q("1/2") },
        Upper::Contact { x: [q("1"), q("0"), q("0")], feet: [Foot::Plane(q("1/3")), Foot::Plane(q("2/3"))] },
    ] {
        assert_eq!(refused_by(&file("straight_line"), None, Some("9"), trees(), upper), "upper");
    }
}

/// A disk of radius r about the end and one about a point at the distance 3/2 r may meet.
#[test]
fn a_slab_at_an_end_is_two_radii_thick() {
    let line = curve(r#"{"degree": 1, "control_points": [[3, 0], [5, 0]]}"#);
    let spine = Spine::of(&line);
    let end = Piece::new(BigInt::zero(), BigInt::zero(), [0, 0, 0].map(Poly::constant), Poly::constant(1));
    let slab = |r: &str| rules::slab(&spine.spans, std::slice::from_ref(&end), &[7, 0, 0], &q(r).pow(2)).is_ok();
    assert_eq!(["2", "3/2", "1.4999"].map(slab), [false, false, true]);
    let two = |r: &str| rules::slab(&spine.spans, &spine.spans, &[1, 0, 0], &q(r).pow(2)).is_ok();
    assert!(!two("0.001"));
}

/// How long a leaf takes: `cargo test --release --lib leaf_times -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn leaf_times() {
    for (name, parts) in [("trefoil", 3), ("m98_5_2", 4), ("m98_5_3", 4)] {
        let spine = Spine::of(&file(name));
        let mut arcs: [Arc; 2] = [[spine.spans[0].clone()].into(), [spine.spans.last().unwrap().clone()].into()];
        for _ in 0..parts {
            arcs = [spine.halves(&arcs[0]).unwrap()[0].clone(), spine.halves(&arcs[1]).unwrap()[1].clone()];
        }
        let (a, b) = (&arcs[0][0], &arcs[1][0]);
        let r = q("0.0925342896334").pow(2);
        let e = spine.spans[0].at(&Rational::zero());
        let time = |what: &str, run: &mut dyn FnMut() -> bool| {
            let start = std::time::Instant::now();
            let fine = (0..1000).filter(|_| run()).count();
            println!("{name} {what}: {:?} a leaf, {}", start.elapsed() / 1000, fine > 0);
        };
        time("bent", &mut || rules::bent(a, b, MIDDLE, &r).unwrap().is_positive());
        time("side", &mut || rules::side(a, b, [1, 0]).is_ok());
        time("share", &mut || rules::share(&e, b, 1 << 31, &r).unwrap().is_positive());
        time("curved", &mut || rules::curved(a, &r).iter().all(Poly::is_positive));
        time("cone", &mut || rules::cone(std::slice::from_ref(a), &[1, 2, 3]).is_ok());
        time("slab", &mut || rules::slab(std::slice::from_ref(a), std::slice::from_ref(b), &[1, 2, 3], &r).is_ok());
        time("halving, then bent", &mut || {
            let first = a.part(&q("0"), &q("1/2"));
            rules::bent(&first, b, MIDDLE, &r).unwrap().is_positive()
        });
    }
}

proptest! {
    /// The convolution code against values.
    #[test]
    fn polynomials(
        f in prop::collection::vec(-50_i64..50, 1..6),
        g in prop::collection::vec(-50_i64..50, 1..6),
        p in 0_i64..8,
    ) {
        let [f, g] = [f, g].map(|c| Poly::bernstein(c.into_iter().map(BigInt::from).collect()));
        let t = Rational::new(p.into(), 7.into());
        let value = |f: &Poly| value(f, &t);
        prop_assert_eq!(value(&f.times(&g)), value(&f) * value(&g));
        prop_assert_eq!(value(&f.clone().plus(g.clone())), value(&f) + value(&g));
        prop_assert_eq!(value(&f.clone().minus(g.clone())), value(&f) - value(&g));
        let scale = |k: i64| Rational::from_integer(BigInt::from(k).pow(f.0.len() as u32 - 1));
        for (a, b) in [(0, 2), (2, 5), (4, 1), (3, 3)] {
            let there = (Rational::from_integer(a.into()) + &t * BigInt::from(b - a)) / BigInt::from(5);
            let part = f.between(&a.into(), &b.into(), &5.into());
            prop_assert_eq!(value(&part), self::value(&f, &there) * scale(5));
        }
        prop_assert_eq!(value(&f.at(&t)), value(&f) * scale(t.denom().to_i64().unwrap()));
        // the derivative of f g is f' g + f g'
        let product = f.derivative().times(&g).plus(f.times(&g.derivative()));
        prop_assert_eq!(value(&f.times(&g).derivative()), value(&product));
    }

    /// Whatever lines are moved or changed: no panic, and nothing false is verified. delta of the parabola is 1/2.
    #[test]
    fn tampering(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..6), 1..4),
    ) {
        let text = include_str!("../../tests/certificates/accept/m98_5_1_parabola__naive.txt");
        let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
        for (at, from, kind) in changes {
            let (at, other) = (at.index(lines.len()), lines[from.index(lines.len())].clone());
            match kind {
                0 => lines[at] = other,
                1 => lines.insert(at, other),
                2 => lines[at] = lines[at].replace("4999", "500001"),
                3 => lines[at] = lines[at].replace("1/2", "4999/10000"),
                4 => lines[at] = lines[at].replace("cone", "slab"),
                _ => lines[at] = lines[at].replace("1048576", "-9223372036854775808"),
            }
        }
        let curve = file("m98_5_1_parabola");
        if let Ok(certificate) = Certificate::decode((lines.join("\n") + "\n").as_bytes())
            && let Ok(verified) = verify(&certificate.claim(curve), &certificate)
        {
            let [lo, hi] = bounds(verified.claim());
            prop_assert!(lo.as_ref().is_some_and(|lo| compare(lo, &q("1/2")).is_lt()));
            prop_assert!(hi.as_ref().is_none_or(|hi| compare(hi, &q("1/2")).is_ge()));
        }
    }

    /// The spans against the basis functions of Cox and de Boor, up to one factor > 0 for all of a span: knots that are
    /// multiple and not clamped, weights of any sign but the first of a span, which the sign of all makes > 0.
    #[test]
    fn spans(
        degree in 1_usize..5,
        steps in prop::collection::vec((0_i64..3, 1_i64..4), 16),
        numbers in prop::collection::vec((-9_i64..10, 1_i64..8), 6 * 4),
    ) {
        let mut knots = vec![Rational::zero()];
        for (step, per) in &steps[..6 + degree] {
            knots.push(knots.last().unwrap() + Rational::new((*step).into(), (*per).into()));
        }
        let number = |i: usize| Rational::new(numbers[i].0.into(), numbers[i].1.into());
        let points: Vec<[Rational; 3]> = (0..6).map(|i| [0, 1, 2].map(|k| number(4 * i + k))).collect();
        let weights: Vec<Rational> = (0..6).map(|i| number(4 * i + 3)).collect();
        let made = Curve::new(degree, points.clone(), Some(weights.clone()), Some(knots.clone()));
        let Ok(curve) = made else { return Ok(()) }; // too many knots at one place
        let spine = Spine::of(&curve);
        let real = |k: &usize| knots[*k] != knots[k + 1];
        prop_assert_eq!(spine.spans.len(), (degree..6).filter(real).count());
        for (piece, k) in spine.spans.iter().zip((degree..6).filter(real)) {
            // a first weight of 0 makes all 0
            if piece.point().iter().all(|f| f.is_zero()) {
                continue;
            }
            let mut factor: Option<Rational> = None;
            for t in 0..=4 {
                let t = Rational::new(t.into(), 4.into());
                let at = &knots[k] + &t * (&knots[k + 1] - &knots[k]);
                let mut wanted = [0; 4].map(|_| Rational::zero());
                for (i, ([x, y, z], w)) in points.iter().zip(&weights).enumerate() {
                    let basis = basis(&knots, i, degree, k, &at);
                    for (sum, c) in wanted.iter_mut().zip([x * w, y * w, z * w, w.clone()]) {
                        *sum += c * &basis;
                    }
                }
                for (found, wanted) in piece.point().map(|f| value(f, &t)).into_iter().zip(wanted) {
                    prop_assert_eq!(found.is_zero(), wanted.is_zero());
                    if !wanted.is_zero() {
                        let ratio = found / wanted;
                        prop_assert_eq!(factor.get_or_insert_with(|| ratio.clone()), &ratio);
                    }
                }
            }
            prop_assert!(piece.w.0[0] > BigInt::zero());
        }
    }

    /// What `side` accepts has one strict sign by its definition; one field alone is enough, none is not.
    #[test]
    fn one_side(parts in 2_usize..6, turns in any::<[bool; 6]>(), fields in [-2_i64..3, -2..3], rational in any::<bool>()) {
        let spine = Spine::of(&file(if rational { "m98_5_3" } else { "m98_5_2" }));
        let [mut a, mut b] = spine.halves(&spine.spans).unwrap();
        for turn in &turns[..parts] {
            let half = |arc: &Arc, k: bool| spine.halves(arc).unwrap()[usize::from(k)].clone();
            (a, b) = (half(&a, *turn), half(&b, !*turn));
        }
        let (a, b) = (&a[0], &b[0]);
        let weight = |piece: &Piece| Rational::from_integer(piece.w.0[0].clone());
        let [x, y] = fields.map(|k| Rational::from_integer(k.into()));
        let at = |s: i64, t: i64| {
            let [s, t] = [s, t].map(|t| Rational::new(t.into(), 4.into()));
            let point = |piece: &Piece, t: &Rational| [0, 1, 2].map(|i| value(&piece.r[i], t) / value(&piece.w, t));
            let (p, o) = (point(a, &s), point(b, &t));
            let d = [0, 1, 2].map(|i| &p[i] - &o[i]);
            // up to v(s) w(t)
            let [of_s, of_t] = [(a, &s), (b, &t)].map(|(piece, t)| dotted(&d, &hodograph(piece, t)));
            (&x * weight(b).pow(2) * of_s + &y * weight(a).pow(2) * of_t).cmp(&Rational::zero())
        };
        let signs: Vec<_> = (0..=4).flat_map(|s| (0..=4).map(move |t| (s, t))).map(|(s, t)| at(s, t)).collect();
        let one = signs[0].is_ne() && signs.iter().all(|sign| *sign == signs[0]);
        prop_assert!(one || rules::side(a, b, fields).is_err());
        let plain = rules::side(a, b, [1, 0]).is_ok() && fields[0] != 0 && fields[1] == 0;
        prop_assert!(!plain || rules::side(a, b, fields).is_ok());
    }

    /// The forms of the rules against their definitions, on a rational and an integral arc.
    #[test]
    fn forms(
        s in 0_i64..6, t in 0_i64..6, fields in prop::array::uniform6(-4_000_000_000_i64..4_000_000_000), k in 0_i64..(1 << 32),
        rational in any::<bool>(),
    ) {
        let name = if rational { "m98_5_3" } else { "m98_5_2" };
        let spine = Spine::of(&file(name));
        let [a, rest] = spine.halves(&spine.spans).unwrap();
        let [b, _] = spine.halves(&rest).unwrap();
        let (a, b) = (&a[0], &b[0]);
        let radius = q("3/7");
        let r = radius.pow(2);
        let (s, t) = (Rational::new(s.into(), 5.into()), Rational::new(t.into(), 5.into()));
        let at = |piece: &Piece, t: &Rational| (piece.r.each_ref().map(|f| value(f, t)), value(&piece.w, t));
        let ((p, v), (o, w)) = (at(a, &s), at(b, &t));
        let d = [0, 1, 2].map(|i| &p[i] * &w - &o[i] * &v);
        let [of_s, of_t] = [(a, &s), (b, &t)].map(|(piece, t)| {
            let a = hodograph(piece, t);
            assert_eq!(piece.a().each_ref().map(|f| value(f, t)), a);
            dotted(&d, &a)
        });
        let weights = [a, b].map(|piece| piece.w.0[0].clone());
        let [first, second] = weights.each_ref().map(|w| Rational::from_integer(w.clone()));
        let unit = Rational::from_integer(BigInt::one() << 32);
        let ratio = |x: i64| Rational::from_integer(x.into()) / &unit;
        let [x, y, g, h, u, v2] = fields.map(ratio);
        let (one, half) = (Rational::one(), q("1/2"));
        let two = &one + &one;
        let quotient = &second * (&two - &u) / (&first * (&two - &v2));
        let lines = |x: &Rational, s: &Rational, g: &Rational, u: &Rational| {
            (x - s) * (&one + g * (x - s) + u * (&half - s))
        };
        // a constant weight has no line
        let weight = |s: &Rational, u: &Rational| if rational { &one + u * (s - &half) } else { one.clone() };
        let form = dotted(&d, &d) - Rational::from_integer(4.into()) * &radius * &radius * &v * &v * &w * &w
            + &quotient * lines(&x, &s, &g, &u) * weight(&t, &v2) * of_s
            - lines(&y, &t, &h, &v2) / &quotient * weight(&s, &u) * of_t;
        let degree = if rational { 13 } else { 7 };
        let rows: Vec<Poly> =
            rules::bent(a, b, fields, &r).unwrap().0.chunks(degree + 1).map(|row| Poly(row.to_vec())).collect();
        let columns: Vec<Rational> = rows.iter().map(|row| value(row, &t)).collect();
        let found = horner(&columns, &s);
        let common = num_integer::gcd(weights[0].clone(), weights[1].clone());
        let product = &first * &second / Rational::from_integer(&common * &common);
        let factor = Rational::from_integer(r.denom() << 194) * product * (&two - &u) * (&two - &v2);
        prop_assert_eq!(found, form * factor);
        prop_assert!(rows.len() == degree + 1 && rows.iter().all(|row| row.0.len() == degree + 1));

        let e = spine.spans[0].at(&Rational::zero());
        let form = rules::share(&e, b, k, &r).unwrap();
        let exact = |v: &[Poly; 3]| v.each_ref().map(|c| Rational::from_integer(c.0[0].clone()));
        let (d, a) = (exact(e.a()), hodograph(b, &t));
        let we = Rational::from_integer(e.w.0[0].clone());
        let point = exact(&e.r);
        let q = [0, 1, 2].map(|i| &o[i] * &we - &point[i] * &w);
        let u = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &d[i] * &a[j] - &d[j] * &a[i]);
        let k = ratio(k);
        let other = Rational::one() - &k;
        let [aq, dq, uq] = [&a, &d, &u].map(|v| dotted(v, &q) * dotted(v, &q));
        let wanted = &k * aq * dotted(&d, &d) + &other * dq * dotted(&a, &a) + &k * &other * uq
            - &radius * &radius * dotted(&u, &u) * &w * &w * &we * &we;
        prop_assert_eq!(value(&form, &t), wanted * &unit * &unit * Rational::from_integer(r.denom().clone()));

        // w b, with b as the page has it
        let jets = b.r.each_ref().map(|r| jet(r, &t));
        let [w0, w1, w2] = if rational { jet(&b.w, &t) } else { [value(&b.w, &t), Rational::zero(), Rational::zero()] };
        let [r0, r1, r2] = [0, 1, 2].map(|k| jets.each_ref().map(|jet| jet[k].clone()));
        let cross = |u: &[Rational; 3], v: &[Rational; 3]| {
            [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &u[i] * &v[j] - &u[j] * &v[i])
        };
        let (first, second, third) = (cross(&r1, &r2), cross(&r0, &r2), cross(&r0, &r1));
        let wanted = [0, 1, 2].map(|i| &w0 * (&w0 * &first[i] - &w1 * &second[i] + &w2 * &third[i]));
        prop_assert_eq!(b.wb().each_ref().map(|f| value(f, &t)), wanted);

        // kappa^2 = |C' x C''|^2 / |C'|^6 by quotients
        let form = value(&rules::curvature(b, &r), &t);
        let kappa = curvature_squared(b, &t);
        let a6 = dotted(&a, &a) * dotted(&a, &a) * dotted(&a, &a);
        let wanted = &a6 * (Rational::one() - &radius * &radius * kappa);
        prop_assert_eq!(form, wanted * Rational::from_integer(r.denom().clone()));
    }
}

/// The basis function number `i` of a degree at t, in the span that begins at knot `k`.
fn basis(knots: &[Rational], i: usize, degree: usize, k: usize, t: &Rational) -> Rational {
    if degree == 0 {
        return if i == k { Rational::one() } else { Rational::zero() };
    }
    let part = |low: usize, of: usize, sign: &Rational| {
        let length = &knots[of + degree] - &knots[of];
        if length.is_zero() { length } else { sign * (t - &knots[low]) / length * basis(knots, of, degree - 1, k, t) }
    };
    part(i, i, &Rational::one()) + part(i + degree + 1, i + 1, &-Rational::one())
}

/// The value of the sum of c_i t^i (1-t)^(n-i).
fn horner(c: &[Rational], t: &Rational) -> Rational {
    power_basis(c).iter().rev().fold(Rational::zero(), |sum, c| sum * t + c)
}

fn power_basis(c: &[Rational]) -> Vec<Rational> {
    let mut sum = vec![Rational::zero(); c.len()];
    for (i, c) in c.iter().enumerate() {
        let mut term = vec![Rational::one()];
        for _ in i + 1..sum.len() {
            term.push(Rational::zero());
            for j in (1..term.len()).rev() {
                term[j] = &term[j] - &term[j - 1];
            }
        }
        term.iter().enumerate().for_each(|(j, d)| sum[i + j] += c * d);
    }
    sum
}

fn value(f: &Poly, t: &Rational) -> Rational {
    let c: Vec<Rational> = f.0.iter().map(|c| Rational::from_integer(c.clone())).collect();
    horner(&c, t)
}

/// The derivatives 0 to 2 of a polynomial.
fn jet(f: &Poly, t: &Rational) -> [Rational; 3] {
    let mut c = power_basis(&f.0.iter().map(|c| Rational::from_integer(c.clone())).collect::<Vec<_>>());
    [0, 1, 2].map(|_| {
        let value = c.iter().rev().fold(Rational::zero(), |sum, c| sum * t + c);
        c = c.iter().enumerate().skip(1).map(|(i, c)| c * BigInt::from(i)).collect();
        value
    })
}

/// r' w - r w'.
fn hodograph(piece: &Piece, t: &Rational) -> [Rational; 3] {
    let [w, w1, _] = jet(&piece.w, t);
    piece.r.each_ref().map(|r| {
        let [r, r1, _] = jet(r, t);
        if piece.w.0.len() == 1 { r1 * &w } else { r1 * &w - r * &w1 }
    })
}

/// By C' and C'' of the quotients.
fn curvature_squared(piece: &Piece, t: &Rational) -> Rational {
    let [w, w1, w2] = jet(&piece.w, t);
    let both = piece.r.each_ref().map(|r| {
        let [r, r1, r2] = jet(r, t);
        let c = r / &w;
        let c1 = (r1 - &c * &w1) / &w;
        let c2 = (r2 - &c1 * &w1 * BigInt::from(2) - &c * &w2) / &w;
        (c1, c2)
    });
    let [d, e] = [both.each_ref().map(|b| b.0.clone()), both.each_ref().map(|b| b.1.clone())];
    let u = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &d[i] * &e[j] - &d[j] * &e[i]);
    let square = dotted(&d, &d);
    dotted(&u, &u) / (&square * &square * &square)
}

fn dotted(f: &[Rational; 3], g: &[Rational; 3]) -> Rational {
    f.iter().zip(g).map(|(f, g)| f * g).sum()
}
