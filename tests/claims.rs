//! delta of curves for which it is known: published, constructed, or found to many digits by sampling. Each answer is
//! also held against the oracle, exactly from above.
#![cfg(feature = "search")]

mod oracle;
mod shapes;

use oracle::{Oracle, not_above, reaches};
use shapes::*;
use tubecert::{Curve, LimitedBy, Radius, RadiusOptions, Rational, Spine, radius};

const WIDTH: f64 = 1e-9;
/// Far more than any of these curves needs, so that a search that does not end fails in seconds.
const CELLS: u64 = 1_000_000;

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    Curve::from_json_str(&text).unwrap_or_else(|e| panic!("{path}: {e:?}"))
}

/// The answer, of the default width, and within the oracle; `share` is what sampling may miss.
fn answer(curve: &Curve, share: f64) -> Radius {
    let spine = Spine::from_curve(curve.clone()).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().max_cells(CELLS)).expect("an answer");
    let text = curve.to_json();
    assert!(answer.complete, "not complete: {answer:?}\n{text}");
    assert!(answer.delta.is_within(WIDTH), "too wide: {answer:?}\n{text}");
    let oracle = Oracle::of(&spine);
    assert_eq!(answer.closed, oracle.closed && answer.limited_by != LimitedBy::Corner, "{text}");
    let sampled = oracle.sample(400);
    not_above(&answer, &sampled).unwrap_or_else(|e| panic!("UNSOUND lower bound: {e}\n{answer:?}\n{text}"));
    reaches(&answer, &sampled, share, 0.0).unwrap_or_else(|e| panic!("upper bound: {e}\n{answer:?}\n{text}"));
    answer
}

/// delta is this rational. Any term may be named where all bind at once.
fn all_at_once(curve: &Curve, delta: &Rational) -> Radius {
    let answer = answer(curve, 1e-6);
    let (lo, hi) = (oracle::exact(answer.delta.lo), oracle::exact(answer.delta.hi));
    assert!(lo <= *delta && *delta <= hi, "delta = {delta} is not in {answer:?}\n{}", curve.to_json());
    answer
}

/// delta is this rational, by this term.
fn exactly(curve: &Curve, delta: &Rational, by: LimitedBy) -> Radius {
    let answer = all_at_once(curve, delta);
    assert_eq!(answer.limited_by, by, "{answer:?}\n{}", curve.to_json());
    answer
}

/// delta is this rational, by this term and perhaps by others: end disks in one plane are a doubly critical pair too.
fn among(curve: &Curve, delta: &Rational, by: LimitedBy) -> Radius {
    let answer = all_at_once(curve, delta);
    assert!(answer.limited_by == by || answer.also.contains(&by), "{answer:?}\n{}", curve.to_json());
    answer
}

/// delta agrees with a decimal in all the digits given.
fn printed(name: &str, delta: &str, by: LimitedBy) -> Radius {
    let answer = answer(&file(name), 1e-6);
    let value: f64 = delta.parse().expect("a decimal");
    let digits = delta.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    let half = 0.5 * 10f64.powi(-digits);
    let agrees = answer.delta.lo <= value + half && value - half <= answer.delta.hi;
    assert!(agrees, "{name}: {answer:?}");
    assert_eq!(answer.limited_by, by, "{name}: {answer:?}");
    answer
}

#[test]
fn published_curves() {
    use LimitedBy::{BodyToBody, Curvature, EndToBody};
    printed("m98_5_1_parabola", "0.500000", Curvature);
    printed("m98_5_2", "0.0925343", EndToBody);
    printed("m98_5_3", "0.0205086", Curvature);
    printed("m98_5_4", "0.0319766", Curvature);
    printed("m98_5_4_as_printed", "0.0931670", Curvature);
    printed("m98_5_5_planar", "0.0557522", EndToBody);
    printed("m98_5_6_1", "4.84424", Curvature);
    printed("m98_5_6_2", "8.18188", Curvature);
    printed("trefoil", "0.520235", BodyToBody);
    printed("pierced_end", "1.353121", EndToBody);
    exactly(&file("m98_5_1_parabola"), &q(1, 2), Curvature);
}

/// The ten digits of section 8 of theory.md.
#[test]
fn published_curves_to_ten_digits() {
    printed("m98_5_2", "0.0925342897", LimitedBy::EndToBody);
    printed("m98_5_5_planar", "0.0557521890", LimitedBy::EndToBody);
}

#[test]
fn circle() {
    let answer = exactly(&file("circle_exact"), &int(1), LimitedBy::Curvature);
    assert!(answer.closed);
    exactly(&shapes::circle(4), &int(1), LimitedBy::Curvature);
}

/// On a circle every antipodal pair is doubly critical at the same radius.
#[test]
fn circle_names_its_other_term() {
    let answer = exactly(&file("circle_exact"), &int(1), LimitedBy::Curvature);
    assert_eq!(answer.also, [LimitedBy::BodyToBody]);
}

#[test]
fn straight_lines_have_no_bound() {
    let zigzag = bezier_int(&[[0, 0, 0], [3, 3, 3], [5, 5, 5], [9, 9, 9]]);
    let path = Path::from(plane(int(0), int(0))).line(plane(int(1), int(0))).line(plane(int(5), int(0))).curve();
    for curve in [file("straight_line"), zigzag, path] {
        let answer = answer(&curve, 0.0);
        assert_eq!((answer.delta.lo, answer.delta.hi), (f64::INFINITY, f64::INFINITY));
        assert_eq!(answer.limited_by, LimitedBy::None);
    }
}

#[test]
fn arcs_of_circles() {
    for quarters in 1..=3 {
        all_at_once(&shapes::circle(quarters), &int(1));
    }
    all_at_once(&rotated(&shapes::circle(3), [3, 1, -2, 5]), &int(1));
}

#[test]
fn hairpins() {
    for (length, radius) in [(q(1, 10), int(1)), (int(3), int(1)), (int(40), q(1, 7)), (int(1), q(1, 1000))] {
        all_at_once(&hairpin(length, radius.clone()), &radius);
    }
    all_at_once(&rotated(&hairpin(int(3), int(1)), [3, 1, -2, 5]), &int(1));
}

/// Straight strands a hundred million times longer than they are apart.
#[test]
fn hairpins_as_thin_as_can_be_told() {
    for e in [-5, -7, -8] {
        all_at_once(&hairpin(int(5), power(10, e)), &power(10, e));
    }
}

#[test]
fn stadiums() {
    for (length, radius) in [(int(3), int(1)), (int(10), q(1, 7))] {
        let curve = stadium(length, radius.clone());
        assert!(Oracle::new(&curve).closed);
        all_at_once(&curve, &radius);
    }
}

#[test]
fn straight_run_into_a_tight_bend() {
    for e in [0, -1, -3, -6, -9] {
        let radius = power(10, e);
        exactly(&hook(radius.clone()), &radius, LimitedBy::Curvature);
    }
}

#[test]
fn torus_knots_of_forty_spans() {
    // as sampled by the oracle with 1,600 points, to six digits
    for (turns, around, delta) in [(2, 3, 0.835_101), (2, 5, 0.584_860), (3, 4, 0.602_159)] {
        let answer = answer(&torus_knot(turns, around, 40), 1e-6);
        assert!(answer.closed && (answer.delta.lo - delta).abs() < 1e-6, "{answer:?}");
        assert_eq!(answer.limited_by, LimitedBy::BodyToBody);
    }
}

#[test]
fn strands_that_pass_closely() {
    for e in [-2, -3, -4, -6, -8] {
        let c = power(10, e) * q(3, 2);
        exactly(&alpha(c), &power(10, e), LimitedBy::BodyToBody);
    }
}

#[test]
fn end_disks_in_one_plane() {
    for e in [-1, -3, -6] {
        among(&bulb(power(10, e)), &power(10, e), LimitedBy::EndToEnd);
    }
    among(&rotated(&bulb(q(1, 10)), [3, 1, -2, 5]), &q(1, 10), LimitedBy::EndToEnd);
}

#[test]
fn end_disk_in_the_plane_of_a_disk_of_the_body() {
    for e in [-1, -3, -6] {
        among(&faced(power(10, e)), &power(10, e), LimitedBy::EndToBody);
        among(&reversed(&faced(power(10, e))), &power(10, e), LimitedBy::EndToBody);
    }
}

#[test]
fn critical_pair_at_knots() {
    exactly(&peanut(q(1, 10)), &q(1, 10), LimitedBy::BodyToBody);
    exactly(&peanut(q(1, 1000)), &q(1, 1000), LimitedBy::BodyToBody);
}

#[test]
fn critical_pair_at_a_knot_and_an_irrational_parameter() {
    for (height, slant, from, factor) in
        [(int(8), 0, -1, 1), (int(8), 1, -1, 1), (int(1), 1, -1, 7), (q(1, 10), 1, -1, 1), (int(8), 1, -8, 3)]
    {
        let curve = scaled(&bow_over_a_line(&height, slant, &q(1, from)), &int(factor));
        let spine = Spine::from_curve(curve).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
        let body = answer.terms.body_to_body;
        let half = height * q(factor, 2);
        assert!(answer.complete && body.is_within(1e-9), "{answer:?}");
        assert!(oracle::exact(body.lo) <= half && half <= oracle::exact(body.hi), "{answer:?}");
    }
}

fn ordered(answer: &Radius) {
    let at = answer.at.as_ref().expect("a place");
    for e in [at.t].iter().chain(&at.s).chain(at.x.iter().flatten()) {
        assert!(e.lo <= e.hi, "{answer:?}");
    }
}

/// The strands cross where one has a knot and the other an irrational parameter.
#[test]
fn crossing_at_a_knot_and_an_irrational_parameter() {
    for slant in [0, 1] {
        ordered(&touching(&crossing_on_a_knot(slant), LimitedBy::SelfContact));
    }
}

/// The same on a closed spine whose seam is that knot: the place is an interval round the start.
#[test]
fn crossing_at_the_seam() {
    let answer = touching(&crossing_on_its_seam(), LimitedBy::SelfContact);
    assert!(answer.closed);
    ordered(&answer);
}

#[test]
fn terms_beside_a_self_contact() {
    for curve in [alpha(int(0)), shapes::circle(6), figure_eight(), end_on_the_body()] {
        let spine = Spine::from_curve(curve).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
        let (terms, rim) = (answer.terms, answer.rim.expect("rim terms"));
        assert!(answer.complete && terms.curvature.is_within(1e-9) && terms.curvature.lo > 0.0, "{answer:?}");
        assert!(answer.also.contains(&LimitedBy::BodyToBody) && rim.delta.hi == 0.0, "{answer:?}");
    }
    // the end lies on the body: at a crossing, and along a circle run through more than once
    for curve in [end_on_the_body(), shapes::circle(5), shapes::circle(6)] {
        let spine = Spine::from_curve(curve).expect("a spine");
        let terms = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer").terms;
        assert_eq!((terms.end_to_body.lo, terms.end_to_body.hi), (0.0, 0.0));
    }
}

fn touching(curve: &Curve, by: LimitedBy) -> Radius {
    let spine = Spine::from_curve(curve.clone()).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().max_cells(CELLS)).expect("an answer");
    assert_eq!(
        (answer.delta.lo, answer.delta.hi, answer.limited_by),
        (0.0, 0.0, by),
        "{answer:?}\n{}",
        curve.to_json()
    );
    answer
}

#[test]
fn corners() {
    let polyline = Curve::new(
        1,
        [[0, 0, 0], [1, 0, 0], [1, 2, 0]].map(|p| p.map(int)).to_vec(),
        None,
        Some([0, 0, 1, 2, 2].map(int).to_vec()),
    );
    let doubled = Curve::new(
        2,
        [[0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 2, 1], [4, 4, 4]].map(|p| p.map(int)).to_vec(),
        None,
        Some([0, 0, 0, 1, 1, 2, 2, 2].map(int).to_vec()),
    );
    let there_and_back = Path::from(plane(int(0), int(0))).line(plane(int(1), int(0))).line(plane(int(0), int(0)));
    let drop = bezier_int(&[[0, 0, 0], [3, 1, 0], [-3, 1, 1], [0, 0, 0]]);
    for curve in [polyline.unwrap(), doubled.unwrap(), there_and_back.curve(), drop] {
        touching(&curve, LimitedBy::Corner);
    }
}

/// The finish has a contact (2.01925374045 to 50 digits) a little below the value at the frontier of its local pairs.
#[test]
fn contact_beside_the_frontier() {
    let curve = Curve::from_json_str(
        r#"{"degree": 3, "control_points": [[0, 0, 0], ["-3/8", "-9/16", "-3/4"], [0, "-23/16", -1], ["1/2", "-29/16",
            "-7/4"], ["13/16", "-39/16", "-39/16"], ["5/8", "-3/2", "-11/4"], ["23/16", "-9/8", "-51/16"], ["5/4",
            "-9/16", -4], ["5/8", "-13/16", "-19/4"], ["-3/16", "-5/16", "-81/16"]], "weights": ["7/8", 3, "15/8",
            "11/4", "1/4", "23/8", "5/8", "21/8", "13/8", "15/8"], "knots": [0, 0, 0, 0, 2, 3, 3, 6, 8, 9, 10, 10, 10,
            10]}"#,
    );
    let spine = Spine::from_curve(curve.expect("a curve")).expect("a spine");
    let term = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer").terms.end_to_body;
    assert!(term.is_within(WIDTH) && term.lo <= 2.019_253_740_45 && 2.019_253_740_44 <= term.hi, "{term:?}");
}

/// Arcs of up to 90 degrees: every pair is local, and no term of the ends exists.
#[test]
fn quarter_circles_have_no_end_terms() {
    let arc = Path::from(plane(int(1), int(0))).quarter(plane(int(1), int(1)), plane(int(0), int(1))).curve();
    let spine = Spine::from_curve(arc).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
    for term in [answer.terms.end_to_body, answer.terms.end_to_end, answer.terms.body_to_body] {
        assert_eq!(term, tubecert::Enclosure::INFINITE, "{answer:?}");
    }
    assert!(answer.complete);
}

/// Most of the unit circle in two arcs: what is across from a simple parameter is a fraction of many digits.
#[test]
fn body_term_of_a_long_arc() {
    let arc = r#"{"degree": 2, "control_points": [["-861/1061", "-620/1061"], ["19/81", "-55/27"], ["12/13", "-5/13"],
        ["77/23", "125/23"], ["-629/829", "540/829"]], "weights": ["1061/100", "81/50", "26/25", "23/50", "829/100"],
        "knots": [0, 0, 0, 1, 1, 2, 2, 2]}"#;
    let spine = Spine::from_json_str(arc).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
    let body = answer.terms.body_to_body;
    assert!(answer.complete && body.is_within(1e-9) && body.lo <= 1.0 && 1.0 <= body.hi, "{answer:?}");
}

/// Of ends that are mirror images the rims meet on a line, and so at radii far below those of the rims nearby.
#[test]
fn rims_of_mirrored_ends() {
    let spine = Spine::from_curve(butterfly()).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
    let rim = answer.rim.as_ref().expect("rim terms");
    assert!(answer.complete && rim.end_to_body.is_within(1e-9), "{answer:?}");
    assert_eq!(rim.end_to_body.hi, rim.end_to_end.hi);
}

/// A planar spine ends square to its own straight run, a millionth away: the rims meet it a millionth to each side.
#[test]
fn planar_rims_at_a_small_gap() {
    let gap = power(10, -6);
    let path = Path::from(plane(int(-3), int(0)))
        .line(plane(int(3), int(0)))
        .quarter(plane(int(4), int(0)), plane(int(4), int(1)))
        .quarter(plane(int(4), int(2)), plane(int(3), int(2)))
        .line(plane(int(1), int(2)))
        .quarter(plane(int(0), int(2)), plane(int(0), int(1)))
        .line(plane(int(0), gap.clone()));
    let spine = Spine::from_curve(path.curve()).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer");
    let rim = answer.rim.as_ref().expect("rim terms").end_to_body;
    assert!(answer.complete && rim.is_within(1e-9), "{answer:?}");
    assert!(oracle::exact(rim.lo) <= gap && gap <= oracle::exact(rim.hi), "{answer:?}");
}

/// Two straight strands of which one ends on the other, at a rational parameter, with a common tangent.
#[test]
fn touch_without_crossing() {
    let touch = Path::from(plane(int(-3), int(0)))
        .line(plane(int(3), int(0)))
        .quarter(plane(int(4), int(0)), plane(int(4), int(1)))
        .quarter(plane(int(4), int(2)), plane(int(3), int(2)))
        .line(plane(int(0), int(2)))
        .quarter(plane(int(-1), int(2)), plane(int(-1), int(1)))
        .quarter(plane(int(-1), int(0)), plane(int(0), int(0)));
    touching(&touch.curve(), LimitedBy::SelfContact);
}

/// A span of 10^-50 of the domain: an answer, however wide, and soon.
#[test]
fn vanishing_span() {
    let points = [[0, 0, 0], [1, 2, 0], [2, -2, 1], [3, 0, 0], [4, 1, 1], [5, 0, 0]].map(|p| p.map(int)).to_vec();
    let knots = [int(0), int(0), int(0), int(0), power(10, -50), q(1, 2), int(1), int(1), int(1), int(1)].to_vec();
    let spine = Spine::from_curve(Curve::new(3, points, None, Some(knots)).expect("a curve")).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().max_cells(10_000)).expect("an answer");
    assert!(answer.stopped.is_none() && answer.delta.lo <= answer.delta.hi && answer.delta.hi < 1e-12, "{answer:?}");
}

/// Knots as close as rounding leaves them, and closer: spans that f64 does not see are passed over, not taken for a place
/// where the spine meets itself.
#[test]
fn knots_closer_than_rounding() {
    let points = [[4, 0, 0], [3, 3, 1], [0, 4, 0], [-3, 3, -1], [-4, 0, 0], [-3, -3, 1], [0, -4, 0], [3, -3, -1]];
    let points: Vec<Point> = points.iter().chain(&points[..3]).map(|p| p.map(int)).collect();
    let delta = |near: &dyn Fn(i64) -> Rational| {
        let knots = (-3..12).map(|k: i64| near(k.rem_euclid(8)) + int(k - k.rem_euclid(8))).collect();
        let spine =
            Spine::from_curve(Curve::new(3, points.clone(), None, Some(knots)).expect("a curve")).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new().max_cells(CELLS)).expect("an answer");
        assert!(answer.complete && answer.closed, "{answer:?}");
        answer.delta
    };
    for joint in [1, 3] {
        let double = delta(&|k| int(if k == joint { k - 1 } else { k }));
        for gap in [-16, -25] {
            let nearly = delta(&|k| if k == joint { int(k - 1) + power(10, gap) } else { int(k) });
            assert!(nearly.lo <= double.hi && double.lo <= nearly.hi, "{nearly:?} {double:?}");
        }
    }
}

#[test]
fn circle_twice() {
    touching(&shapes::circle(8), LimitedBy::SelfContact);
}

#[test]
fn circle_and_a_half() {
    touching(&shapes::circle(6), LimitedBy::SelfContact);
}

#[test]
fn crossing_at_knots() {
    touching(&figure_eight(), LimitedBy::SelfContact);
}

#[test]
fn crossing_at_thirds() {
    touching(&alpha(int(0)), LimitedBy::SelfContact);
    touching(&rotated(&alpha(int(0)), [3, 1, -2, 5]), LimitedBy::SelfContact);
}

/// The crossing of a planar cubic at irrational parameters.
#[test]
fn crossing_anywhere_in_the_plane() {
    touching(&bezier_int(&[[0, 0, 0], [7, 5, 0], [-3, 6, 0], [4, 0, 0]]), LimitedBy::SelfContact);
}

/// In space, at irrational parameters: what makes the strands meet is their symmetry.
#[test]
fn mirror_images_that_meet() {
    // knots put in anywhere hide a symmetry from the spans, not from the parameter
    let knotted = [butterfly(), glide()].map(|curve| with_knot(&curve, &q(1, 7)).expect("a curve"));
    for curve in [butterfly(), glide()].into_iter().chain(knotted) {
        ordered(&touching(&curve, LimitedBy::SelfContact));
        let other = rotated(&scaled(&curve, &q(1, 3)), [2, 1, -3, 1]);
        ordered(&touching(&moved(&other, &[int(1000), q(1, 7), int(-5)]), LimitedBy::SelfContact));
    }
}

/// y = t^2, x = t^3 - t from t = -1 (the crossing) to 3/2: the end of the spine lies on its body.
fn end_on_the_body() -> Curve {
    from_powers([&[int(0), int(-1), int(0), int(1)], &[int(0), int(0), int(1)], &[int(0)]], &int(-1), &q(3, 2))
}

#[test]
fn end_that_lies_on_the_body() {
    touching(&end_on_the_body(), LimitedBy::SelfContact);
}

#[test]
fn small_and_far_away() {
    let far = [power(10, 9), -power(10, 9), power(10, 9)];
    for name in ["m98_5_2", "m98_5_3", "m98_5_5_planar", "trefoil", "circle_exact"] {
        let curve = file(name);
        let plain = answer(&curve, 1e-6);
        for factor in [power(10, -3), power(10, -9), power(10, 6)] {
            let answer = answer(&moved(&scaled(&curve, &factor), &far), 1e-6);
            let (lo, hi) = (oracle::exact(plain.delta.lo) * &factor, oracle::exact(plain.delta.hi) * &factor);
            assert!(oracle::exact(answer.delta.lo) <= hi && lo <= oracle::exact(answer.delta.hi), "{answer:?}");
            assert_eq!(answer.limited_by, plain.limited_by);
        }
    }
}

#[test]
fn extreme_scales() {
    for name in ["m98_5_2", "m98_5_3", "trefoil", "circle_exact"] {
        let curve = file(name);
        let plain = answer(&curve, 1e-6);
        for e in [-300, 300] {
            let factor = power(10, e);
            let answer = answer(&scaled(&curve, &factor), 1e-6);
            let (lo, hi) = (oracle::exact(plain.delta.lo) * &factor, oracle::exact(plain.delta.hi) * &factor);
            assert!(oracle::exact(answer.delta.lo) <= hi && lo <= oracle::exact(answer.delta.hi), "{answer:?}");
        }
    }
}

/// Beyond the range of f64 nothing false may be said: the enclosure widens to (0, smallest) or (largest, infinite).
#[test]
fn scales_beyond_f64() {
    for e in [-400, 400] {
        let spine = Spine::from_curve(scaled(&file("m98_5_2"), &power(10, e))).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new()).expect("an answer");
        let delta = power(10, e) * q(925_342_897, 10_000_000_000);
        assert!(oracle::exact(answer.delta.lo) <= delta, "{answer:?}");
        assert!(answer.delta.hi == f64::INFINITY || delta <= oracle::exact(answer.delta.hi), "{answer:?}");
    }
}

#[test]
fn degree_twelve() {
    let mut raised = file("m98_5_3");
    while raised.degree() < 12 {
        raised = elevated(&raised).expect("weights other than 0");
    }
    let plain = answer(&file("m98_5_3"), 1e-6);
    assert!(answer(&raised, 1e-6).delta.meets(&plain.delta));
    let wild = bezier_int(&[
        [0, 0, 0],
        [3, 7, 1],
        [-5, 4, 9],
        [8, -6, 2],
        [4, 9, -7],
        [-9, 2, 5],
        [1, -8, 6],
        [7, 3, -4],
        [-2, 5, 8],
        [6, -1, -9],
        [9, 8, 3],
        [-4, -7, 7],
        [2, 6, 5],
    ]);
    answer(&wild, 1e-6);
}

/// An S in the plane, symmetric about its inflection.
#[test]
fn planar_s() {
    for k in [1, 3, 10, 40] {
        // the ends bend back over the middle as k grows
        let points = [[-3, 0], [3 * k, 1], [-3 * k, -1], [3, 0]].map(|[x, y]| plane(int(x), int(y)));
        let curve = bezier(points.to_vec());
        let spine = Spine::from_curve(curve.clone()).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new()).expect("an answer");
        println!("{k} {answer:?}");
        not_above(&answer, &Oracle::of(&spine).sample(400)).unwrap();
    }
}

/// Closed, one segment, the control vectors of its hodograph add up to 0 exactly; of its two near-cusps the sharper one
/// is easily missed by sampling. (A bound that took the mean of these vectors for an axis once closed it unproved.)
#[test]
fn closed_segment_with_near_cusps() {
    let curve = bezier_int(&[
        [0, 0, 0],
        [2_508_226_541, 251_169_687, 0],
        [-9_032_684_723, 10_593_049_981, 0],
        [-2_104_810_403, 324_763_262, 0],
        [6_608_045_723, -10_160_032_299, 0],
        [-2_508_226_541, -251_169_687, 0],
        [0, 0, 0],
    ]);
    let answer = answer(&curve, 1e-6);
    assert!((answer.delta.hi - 1_624.906_6).abs() < 1e-3, "{answer:?}");
}

/// Waves of a plane spline, each with a near-cusp at its crest whose 1/kappa is 3/8 e^2 / (1 - e), below 1e-12 of the size.
#[test]
fn chain_of_near_cusps() {
    let waves = 200;
    let e = |wave: i64| q(1, 100_000 + 97 * wave);
    let mut points = vec![plane(int(0), int(0))];
    for wave in 0..waves {
        let (a, side) = (int(1) - e(wave), int(1 - 2 * (wave % 2)));
        points.push(plane(int(wave) + &a, &side * &a));
        points.push(plane(int(wave + 1) - &a, side * a));
        points.push(plane(int(wave + 1), int(0)));
    }
    let knots = (0..=waves).flat_map(|k| vec![int(k); if k == 0 || k == waves { 4 } else { 3 }]).collect();
    let curve = Curve::new(3, points, None, Some(knots)).expect("a curve");
    let spine = Spine::from_curve(curve).expect("a spine");
    let answer = radius(&spine, &RadiusOptions::new().max_cells(CELLS)).expect("an answer");
    let e = e(waves - 1);
    let crest = q(3, 8) * &e * &e / (int(1) - e);
    let (lo, hi) = (oracle::exact(answer.delta.lo), oracle::exact(answer.delta.hi));
    assert!(lo <= crest && crest <= hi && answer.delta.is_within(WIDTH), "{answer:?}");
    assert_eq!(answer.limited_by, LimitedBy::Curvature);
}

/// A needle: 1/kappa at its tip is far below the smallest f64, and the mean of the hodograph squares to 0 in f64.
#[test]
fn needles() {
    for e in [50, 100, 150, 165, 200, 1000] {
        let curve = bezier(vec![plane(-power(10, -e), int(0)), plane(int(0), int(1)), plane(power(10, -e), int(0))]);
        let spine = Spine::from_curve(curve).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new().max_cells(10_000)).expect("an answer");
        // 1/kappa at t = 1/2 is |a|^3 / |a x a'| there
        let tip = power(10, -2 * e);
        assert!(oracle::exact(answer.delta.lo) <= tip, "1e-{e}: {answer:?}");
        assert!(oracle::exact(answer.terms.curvature.lo) <= tip, "1e-{e}: {answer:?}");
        assert!(answer.delta.hi == f64::INFINITY || oracle::exact(answer.delta.hi) >= tip, "1e-{e}: {answer:?}");
        assert!(!answer.complete || answer.delta.hi.is_finite(), "1e-{e}: {answer:?}");
    }
}

/// One point is no pair: searches that slide along a stretch of critical pairs must not end on the diagonal.
#[test]
fn one_segment_round_a_circle() {
    for text in [
        r#"{"degree":2,"control_points":[["-4/5","-3/5"],["-5/4",0],["-4/5","3/5"]],"weights":[10,-8,10]}"#,
        r#"{"degree":4,"control_points":[["-7/25","-24/25"],[1,"-4/3"],["75/43",0],[1,"4/3"],["-7/25","24/25"]],"weights":["25/16","15/16","43/48","15/16","25/16"]}"#,
        r#"{"degree":6,"control_points":[[-1,0],[-1,-1],["3/5","-16/5"],[3,-1],["17/7","16/7"],[-1,3],[-1,0]],"weights":[4,"8/3","4/3","8/5","28/15","8/3",12]}"#,
    ] {
        among(&Curve::from_json_str(text).expect("a curve"), &q(1, 1), LimitedBy::Curvature);
    }
}

/// Strands that leave the ends side by side: the closest pair is near both ends, and is not one end twice.
#[test]
fn light_bulb() {
    let curve = Curve::from_json_str(r#"{"degree": 9, "control_points": [[-0.30138325959389956, 0.0], [-0.30138325959389956, 1.0], [-0.29738325959389955, 2.0], [-3.190456692355483, 3.035729041655591], [-3.190456692355483, 9.416642426366558], [3.190456692355483, 9.416642426366558], [3.190456692355483, 3.035729041655591], [0.30138325959389956, 2.0], [0.30138325959389956, 1.0], [0.30138325959389956, 0.0]]}"#).expect("a curve");
    let answer = answer(&curve, 1e-6);
    assert!(answer.delta.lo > 0.3013 && answer.delta.hi < 0.3014, "{answer:?}");
}

/// A term above 1/kappa_max: the least over pairs that are not local, and none where all pairs are local.
#[test]
fn terms_beyond_the_binding_one() {
    let all = |text: &str| {
        let spine = Spine::from_json_str(text).expect("a spine");
        radius(&spine, &RadiusOptions::new().all_terms(true)).expect("an answer")
    };
    let inside = all(r#"{"degree":3,"control_points":[[-9,0,-7],[-9,7,-4],[-2,-1,4],[2,8,-1]]}"#);
    let term = inside.terms.end_to_body;
    assert!(inside.complete && term.is_within(WIDTH) && (term.lo - 6.384_684).abs() < 2e-5, "{inside:?}");
    let local = all(r#"{"degree":3,"control_points":[[5,5,-4],[0,4,5],[-6,5,2],[-7,4,2]],"weights":[5,5,5,1]}"#);
    assert!(local.complete && local.terms.end_to_body.lo == f64::INFINITY, "{local:?}");
    assert!(local.terms.end_to_end.lo == f64::INFINITY, "{local:?}");
}

/// Bends so tight that f64 differences no longer give the radius of a contact to nine digits.
#[test]
fn straight_run_into_a_very_tight_bend() {
    for e in [-8, -7, -6, -5] {
        let r = power(10, e) * q(2, 1);
        let x = q(1, 1) + &r;
        let at = |x: Rational, y: Rational| [x, y, q(0, 1)];
        let points = vec![
            at(q(0, 1), q(0, 1)),
            at(q(1, 2), q(0, 1)),
            at(q(1, 1), q(0, 1)),
            at(x.clone(), q(0, 1)),
            at(x, r.clone()),
        ];
        let weights = [1, 1, 1, 1, 2].map(|w| q(w, 1)).to_vec();
        let knots = [0, 0, 0, 1, 1, 2, 2, 2].map(|k| q(k, 1)).to_vec();
        let curve = Curve::new(2, points, Some(weights), Some(knots)).expect("a curve");
        among(&curve, &r, LimitedBy::Curvature);
    }
}

/// End planes that meet 10^400 away: a radius that no f64 spells is finite all the same.
#[test]
fn radii_beyond_f64_are_not_infinite() {
    let points = vec![
        [q(0, 1), q(0, 1), q(0, 1)],
        [q(5, 1), q(0, 1), q(0, 1)],
        [q(5, 1), q(2, 1), q(0, 1)],
        [q(1, 1), q(2, 1) + power(10, -400), q(0, 1)],
    ];
    let spine = Spine::from_curve(Curve::new(3, points, None, None).expect("a curve")).expect("a spine");
    for all in [false, true] {
        let answer = radius(&spine, &RadiusOptions::new().all_terms(all)).expect("an answer");
        assert!(answer.terms.end_to_end.lo.is_finite(), "{answer:?}");
    }
}

/// Whole families of critical pairs, or nearly so, and weights far apart, are proved in few cells.
#[test]
fn few_cells() {
    let within = |curve: &Curve, cells: u64| {
        let spine = Spine::from_curve(curve.clone()).expect("a spine");
        let answer = radius(&spine, &RadiusOptions::new().max_cells(cells)).expect("an answer");
        assert!(answer.complete && answer.delta.is_within(WIDTH), "{answer:?}");
        answer
    };
    within(&file("circle_exact"), 9_000);
    // a spiral staircase that widens: q.T(s) = 0 and q.T(t) = 0 run side by side through all turns
    let steps: Vec<Point> = (0..120)
        .map(|i| {
            let (angle, r) = (0.334 * f64::from(i), 10.0 + 0.05 * f64::from(i));
            [r * angle.cos(), r * angle.sin(), 0.9 * f64::from(i)].map(|x| q((1000.0 * x).round() as i64, 1000))
        })
        .collect();
    let knots = [0; 3].into_iter().chain(0..=117).chain([117; 3]).map(int).collect();
    within(&Curve::new(3, steps, None, Some(knots)).expect("a curve"), 40_000);
    // half circles of nearly one radius, a thousandth apart
    let (far, near) = (|x: i64| plane(int(x), int(0)), |y: i64| plane(int(0), int(y)));
    let (radius, turn) = (q(1999, 1000), plane(q(-3999, 2000), int(0)));
    let strands = Path::from(far(2))
        .half(&far(0), &near(2))
        .half(&turn, &plane(turn[0].clone(), q(-1, 2000)))
        .half(&far(0), &plane(int(0), radius));
    within(&strands.curve(), 400_000);
    // a trefoil in one segment that runs through most of its length near the middle of its parameter
    let knot = r#"{"degree": 6, "control_points": [
            ["3071200/40972801", "-122803201/40972801", "19650560480/262266899201"],
            ["39321601600/786554860797", "-2358927430397/786554860797", "320/6401"],
            ["19662028000/786407420163", "-2359369742083/786407420163", "1024160/40952321"],
            ["0", "-786505713919/262119427839", "0"],
            ["-19662028000/786407420163", "-2359369742083/786407420163", "-1024160/40952321"],
            ["-39321601600/786554860797", "-2358927430397/786554860797", "-320/6401"],
            ["-3071200/40972801", "-122803201/40972801", "-19650560480/262266899201"]],
        "weights": [
            "262266899201", "-262184953599", "262135806721", "-262119427839",
            "262135806721", "-262184953599", "262266899201"]}"#;
    let answer = within(&Curve::from_json_str(knot).expect("a curve"), 5_000);
    assert!((answer.delta.lo - 0.607_154_708_6).abs() < 1e-9, "{answer:?}");
}
