//! Polylines: sampled distances both ways, clearance by brute force, knot determinants, certificates and their mutants. Nothing
//! here shares code with the answer.
#![cfg(feature = "search")]

mod mutants;
mod oracle;
mod random;
mod shapes;

use mutants::*;
use num_traits::ToPrimitive;
use oracle::Oracle;
use proptest::prelude::*;
use random::*;
use shapes::*;
use tubecert::claim::Polyline as Claimed;
use tubecert::number::rational_from_f64;
use tubecert::{
    Certificate, Check, CheckOptions, Claim, Curve, ErrorKind, Polyline, PolylineOptions, Rational, Spine, Statement,
    Verdict, check, polyline, verify,
};

type V = [f64; 3];

fn file(name: &str) -> Curve {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Curve::from_json_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn made(curve: &Curve, tolerance: f64) -> Polyline {
    let spine = Spine::from_curve(curve.clone()).unwrap();
    polyline(&spine, tolerance, &PolylineOptions::new().certificate(true)).unwrap()
}

fn sub(a: &V, b: &V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: &V, b: &V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// From a point to a segment.
fn off(p: &V, a: &V, b: &V) -> f64 {
    let d = sub(b, a);
    let t = (dot(&sub(p, a), &d) / dot(&d, &d)).clamp(0.0, 1.0);
    let q = sub(p, &[0, 1, 2].map(|k| a[k] + t * d[k]));
    dot(&q, &q).sqrt()
}

fn edges(vertices: &[V], closed: bool) -> Vec<[V; 2]> {
    let mut edges: Vec<[V; 2]> = vertices.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    if closed {
        edges.push([vertices[vertices.len() - 1], vertices[0]]);
    }
    edges
}

/// The spine in so many points for each span.
fn sampled(curve: &Curve, count: i64) -> Vec<V> {
    Oracle::new(curve).points(count)
}

/// The greatest distance found of a point of one from the other. The samples of the spine are `gap` apart at the most.
fn hausdorff(spine: &[V], vertices: &[V], closed: bool) -> [f64; 2] {
    let edges = edges(vertices, closed);
    let to_line = |p: &V| edges.iter().map(|[a, b]| off(p, a, b)).fold(f64::INFINITY, f64::min);
    let pieces: Vec<[V; 2]> = spine.windows(2).map(|pair| [pair[0], pair[1]]).filter(|[a, b]| a != b).collect();
    let to_spine = |p: &V| pieces.iter().map(|[a, b]| off(p, a, b)).fold(f64::INFINITY, f64::min);
    let on_line =
        edges.iter().flat_map(|[a, b]| [0.0, 0.25, 0.5, 0.75].map(|t| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))));
    [spine.iter().map(to_line).fold(0.0, f64::max), on_line.map(|p| to_spine(&p)).fold(0.0, f64::max)]
}

/// The least distance of two edges that are not neighbours.
fn clearance(vertices: &[V], closed: bool) -> f64 {
    let edges = edges(vertices, closed);
    let mut least = f64::INFINITY;
    for (i, [a, b]) in edges.iter().enumerate() {
        for (j, [c, d]) in edges.iter().enumerate().skip(i + 2) {
            if closed && i == 0 && j + 1 == edges.len() {
                continue;
            }
            least = least.min(between([a, b], [c, d]));
        }
    }
    least
}

/// Of two segments.
fn between([a, b]: [&V; 2], [c, d]: [&V; 2]) -> f64 {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(a, c));
    let (uu, uv, vv, uw, vw) = (dot(&u, &u), dot(&u, &v), dot(&v, &v), dot(&u, &w), dot(&v, &w));
    let det = uu * vv - uv * uv;
    let ends = off(a, c, d).min(off(b, c, d)).min(off(c, a, b)).min(off(d, a, b));
    let (s, t) = ((uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det);
    if !((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)) {
        return ends;
    }
    let gap: V = [0, 1, 2].map(|k| w[k] + s * u[k] - t * v[k]);
    ends.min(dot(&gap, &gap).sqrt())
}

/// |Alexander polynomial at -1| of a closed polyline: the colourings of its crossings in a plane, modulo a prime.
fn determinant(vertices: &[V]) -> u64 {
    const PRIME: i128 = 1_000_000_007;
    // a direction that no symmetric knot knows
    let (e, f, g) = ([0.36, 0.48, -0.8], [0.8, -0.6, 0.0], [0.48, 0.64, 0.6]);
    let turned: Vec<V> = vertices.iter().map(|p| [dot(p, &e), dot(p, &f), dot(p, &g)]).collect();
    let edges = edges(&turned, true);
    // under-crossings: (edge, place on it, the edge over it, place on that)
    let mut under: Vec<(usize, f64, usize, f64)> = vec![];
    for (i, [a, b]) in edges.iter().enumerate() {
        for (j, [c, d]) in edges.iter().enumerate().skip(i + 1) {
            let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
            let det = u[0] * v[1] - u[1] * v[0];
            let (s, t) = ((w[0] * v[1] - w[1] * v[0]) / det, (w[0] * u[1] - w[1] * u[0]) / det);
            if det == 0.0 || !(0.0..1.0).contains(&s) || !(0.0..1.0).contains(&t) {
                continue;
            }
            let (high, low) = (a[2] + s * u[2], c[2] + t * v[2]);
            under.push(if high < low { (i, s, j, t) } else { (j, t, i, s) });
        }
    }
    under.sort_by(|p, q| (p.0, p.1).partial_cmp(&(q.0, q.1)).unwrap());
    let n = under.len();
    if n < 3 {
        return 1;
    }
    // arc k ends at under-crossing k
    let arc = |edge: usize, s: f64| under.partition_point(|c| (c.0, c.1) < (edge, s)) % n;
    let mut rows: Vec<Vec<i128>> = vec![vec![0; n]; n];
    for (k, crossing) in under.iter().enumerate() {
        rows[k][arc(crossing.2, crossing.3)] += 2;
        rows[k][k] -= 1;
        rows[k][(k + 1) % n] -= 1;
    }
    let mut det = 1_i128;
    let size = n - 1;
    let power = |mut x: i128, mut e: i128| {
        let mut y = 1;
        while e > 0 {
            if e & 1 == 1 {
                y = y * x % PRIME;
            }
            (x, e) = (x * x % PRIME, e >> 1);
        }
        y
    };
    for c in 0..size {
        let Some(pivot) = (c..size).find(|r| rows[*r][c].rem_euclid(PRIME) != 0) else { return 0 };
        if pivot != c {
            rows.swap(pivot, c);
            det = -det;
        }
        det = det * rows[c][c] % PRIME;
        let inverse = power(rows[c][c].rem_euclid(PRIME), PRIME - 2);
        let pivot = rows[c].clone();
        for row in &mut rows[c + 1..size] {
            let factor = row[c] * inverse % PRIME;
            row.iter_mut().zip(&pivot).for_each(|(x, y)| *x = (*x - factor * y) % PRIME);
        }
    }
    let det = det.rem_euclid(PRIME);
    det.min(PRIME - det) as u64
}

/// Everything that an outsider can see of a polyline.
fn stands(curve: &Curve, line: &Polyline, tolerance: f64, samples: i64) {
    assert!(line.is_certified(), "{line:?}");
    assert!(line.distance.hi <= tolerance && line.distance.hi < line.tube_radius.lo);
    assert_eq!(line.edges, line.vertices.len() - usize::from(!line.closed));
    let spine = sampled(curve, samples);
    let gap =
        spine.windows(2).map(|pair| dot(&sub(&pair[1], &pair[0]), &sub(&pair[1], &pair[0])).sqrt()).fold(0.0, f64::max);
    let [far, near] = hausdorff(&spine, &line.vertices, line.closed);
    // chords of the samples leave the spine by kappa gap^2 / 8
    let slack = gap * gap / line.tube_radius.lo.min(1e9) / 8.0 + 1e-12 * gap;
    assert!(far <= line.distance.hi * (1.0 + 1e-9), "{far} {:?}", line.distance);
    assert!(near <= line.distance.hi + slack, "{near} {slack} {:?}", line.distance);
    // the bound is not much more than what is there
    assert!(far * 1.5 + 1e-12 >= line.distance.hi || line.edges < 8, "{far} {:?}", line.distance);
    let certificate = line.certificate.as_ref().expect("a certificate");
    let claim = Claim { curve: curve.clone(), statement: Statement::Polyline(line.claim().unwrap()) };
    verify(&claim, certificate).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn curves_of_the_files() {
    for name in [
        "m98_5_1_parabola",
        "m98_5_2",
        "m98_5_3",
        "m98_5_4",
        "m98_5_5_planar",
        "m98_5_6_1",
        "m98_5_6_2",
        "circle_exact",
        "pierced_end",
        "straight_line",
        "trefoil",
    ] {
        let curve = file(name);
        for tolerance in [100.0, 0.1, 1e-3] {
            let line = made(&curve, tolerance);
            stands(&curve, &line, tolerance, if name == "trefoil" { 60 } else { 400 });
        }
        let fine = made(&curve, 1e-9);
        assert!(fine.is_certified() && fine.distance.hi <= 1e-9, "{name}");
        assert!(
            (fine.edges as f64) <= 1.05 * fine.edges_lower_bound + 1.0,
            "{name}: {} {}",
            fine.edges,
            fine.edges_lower_bound
        );
    }
}

#[test]
fn knots_stay_knotted() {
    let eight = |k: i64| {
        let t = std::f64::consts::TAU * k as f64 / 40.0;
        let r = 2.0 + (2.0 * t).cos();
        [r * (3.0 * t).cos(), r * (3.0 * t).sin(), (4.0 * t).sin()].map(|x| q((x * 1e6) as i64, 1_000_000))
    };
    let figure_eight = periodic(3, &(0..40).map(eight).collect::<Vec<Point>>());
    let unknot = periodic(3, &[[0, 0, 0], [4, 0, 1], [5, 3, 0], [1, 4, -1]].map(|p: [i64; 3]| p.map(int)));
    for (curve, wanted) in [
        (file("trefoil"), 3),
        (torus_knot(2, 3, 40), 3),
        (torus_knot(2, 5, 40), 5),
        (figure_eight, 5),
        (unknot, 1),
        (file("circle_exact"), 1),
    ] {
        for tolerance in [10.0, 0.1, 1e-2, 1e-3] {
            let line = made(&curve, tolerance);
            stands(&curve, &line, tolerance, 40);
            assert_eq!(determinant(&line.vertices), wanted, "{tolerance}");
            assert!(clearance(&line.vertices, true) > 0.0);
        }
    }
}

#[test]
fn impossible_and_unusable() {
    let corner = bezier_int(&[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]]);
    let spine = Spine::from_curve(corner).unwrap();
    let kind = |tolerance: f64| polyline(&spine, tolerance, &PolylineOptions::new()).unwrap_err().kind;
    assert_eq!(kind(0.1), ErrorKind::Impossible);
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(kind(tolerance), ErrorKind::Option);
    }
    // below the rounding of coordinates nothing is proved, and that is soon known
    let curve = file("m98_5_2");
    for tolerance in [1e-17, f64::MIN_POSITIVE, 5e-324] {
        assert!(!made(&curve, tolerance).is_certified());
    }
    let limited = PolylineOptions::new().max_cells(5);
    assert!(!polyline(&Spine::from_curve(curve).unwrap(), 1e-6, &limited).unwrap().is_certified());
}

/// Far away, tiny, huge.
#[test]
fn any_size_and_place() {
    let curve = file("m98_5_3");
    for size in [power(10, -90), power(10, 80)] {
        let line = made(&scaled(&curve, &size), 1e-3 * size.to_f64().unwrap());
        assert!(line.is_certified() && line.edges.abs_diff(made(&curve, 1e-3).edges) < 3);
    }
    let far = moved(&curve, &[power(10, 6), int(0), q(1, 3)]);
    stands(&far, &made(&far, 1e-4), 1e-4, 400);
}

/// Of a claim with other vertices the certificate proves nothing.
#[test]
fn other_vertices_are_rejected() {
    for name in ["m98_5_2", "trefoil"] {
        let curve = file(name);
        let line = made(&curve, 1e-3);
        let (claim, certificate) = (line.claim().unwrap(), line.certificate.unwrap());
        let proved = |change: &dyn Fn(&mut Claimed)| {
            let mut mutant = claim.clone();
            change(&mut mutant);
            verify(&Claim { curve: curve.clone(), statement: Statement::Polyline(mutant) }, &certificate).is_ok()
        };
        assert!(proved(&|_| {}));
        assert!(proved(&|c| c.distance = &c.distance * q(1_000_001, 1_000_000)));
        assert!(!proved(&|c| c.distance = &c.distance * q(9, 10)));
        assert!(!proved(&|c| c.distance = int(10)));
        assert!(!proved(&|c| c.vertices.swap(3, 4)));
        assert!(!proved(&|c| drop(c.vertices.remove(5))));
        assert!(!proved(&|c| c.vertices[5][0] = &c.vertices[5][0] + q(2, 1000)));
        assert!(!proved(&|c| c.vertices[0][2] = &c.vertices[0][2] - q(2, 1000)));
        assert!(!proved(&|c| c.vertices[2] = c.vertices[1].clone()));
        assert!(!proved(&|c| c.vertices.reverse()));
        assert!(!proved(&|c| c.vertices.clear()));
        assert!(!proved(&|c| c.vertices[1][1] = Rational::new_raw(1.into(), 0.into())));
    }
}

/// A spike that leaves a straight spine, along arcs that lie near its lines: only that the arcs do not reach beyond its vertex
/// tells that it is far away.
#[test]
fn a_spike_is_rejected() {
    let curve = bezier_int(&[[0, 0, 0], [1, 0, 0]]);
    let text = made(&curve, 0.1).certificate.unwrap().encode();
    let (head, tube) = (&text[..text.find("distance").unwrap()], &text[text.find("ends").unwrap()..]);
    let body = "distance 1/10\nvertex 0 0 0\nvertex 1/2 0 0\nvertex 51/100 3 0\nvertex 13/25 0 0\nvertex 1 0 0\n";
    let edges = "edge 0 3/5\nedge 1/2 51/100\nedge 51/100 13/25\nedge 2/5 1\n";
    let certificate = Certificate::decode(format!("{head}{body}{edges}{tube}").as_bytes()).unwrap();
    let why = verify(&certificate.claim(curve), &certificate).unwrap_err().to_string();
    assert!(why.contains("reach beyond"), "{why}");
}

/// Every certificate with a field or a line changed is none, is rejected, or proves what is true.
#[test]
fn mutants_prove_nothing_false() {
    for (name, tolerance) in [("m98_5_2", 0.05), ("circle_exact", 0.2), ("m98_5_5_planar", 0.02)] {
        let curve = file(name);
        let spine = sampled(&curve, 200);
        let line = made(&curve, tolerance);
        let text = line.certificate.unwrap().encode();
        let changed = |x: &Rational| vec![x + int(1), x - int(1), x + q(1, 100), x - q(1, 1 << 40), -x, int(0)];
        let (mut accepted, mut rejected) = (0, 0);
        for mutant in mutants(&text, |line| with_fields(line, |field| numbers(field, changed))) {
            let Ok(certificate) = Certificate::decode(mutant.as_bytes()) else { continue };
            let claim = certificate.claim(curve.clone());
            if verify(&claim, &certificate).is_err() {
                rejected += 1;
                continue;
            }
            accepted += 1;
            let Statement::Polyline(claimed) = claim.statement else { panic!("another kind") };
            let vertices: Vec<V> = claimed.vertices.iter().map(|v| v.each_ref().map(|x| x.to_f64().unwrap())).collect();
            let most = claimed.distance.to_f64().unwrap();
            let [far, near] = hausdorff(&spine, &vertices, name == "circle_exact");
            assert!(far <= most * (1.0 + 1e-9) && near <= most + 1e-4, "{far} {near} {most}\n{mutant}");
            assert!(clearance(&vertices, name == "circle_exact") > 0.0, "{mutant}");
        }
        println!("{name}: {accepted} accepted, {rejected} rejected");
        assert!(accepted > 5 && rejected > 100);
    }
}

type Vertex = [Rational; 3];

fn judged(curve: &Curve, vertices: &[Vertex], tolerance: f64) -> Check {
    let spine = Spine::from_curve(curve.clone()).unwrap();
    check(&spine, vertices, tolerance, &CheckOptions::new().certificate(true)).unwrap()
}

fn near(vertices: &[Vertex]) -> Vec<V> {
    vertices.iter().map(|v| v.each_ref().map(|x| x.to_f64().unwrap())).collect()
}

fn shifted(v: &Vertex, by: [f64; 3]) -> Vertex {
    std::array::from_fn(|k| &v[k] + rational_from_f64(by[k]).unwrap())
}

#[test]
fn its_own_polylines_are_certified_wherever_they_start() {
    for name in ["m98_5_2", "trefoil", "circle_exact", "m98_5_3"] {
        let curve = file(name);
        for tolerance in [10.0, 1e-2, 1e-4] {
            let line = made(&curve, tolerance);
            let vertices = line.claim().unwrap().vertices;
            let mut backwards = vertices.clone();
            backwards.reverse();
            let mut list = vec![vertices.clone(), backwards];
            if line.closed {
                let mut later = vertices.clone();
                later.rotate_left(vertices.len() / 3);
                later.push(later[0].clone());
                list.push(later);
            }
            // a little off the spine
            let off = 0.02 * line.distance.hi;
            let wavy = |(k, v): (usize, &Vertex)| shifted(v, [off * f64::from(k as u32 % 3) - off, 0.0, off]);
            let inner = 1..vertices.len() - usize::from(!line.closed);
            let mut moved = vertices.clone();
            for k in inner {
                moved[k] = wavy((k, &vertices[k]));
            }
            list.push(moved);
            for vertices in list {
                let answer = judged(&curve, &vertices, 1.1 * tolerance);
                assert_eq!(answer.verdict, Verdict::Certified, "{name} {tolerance} {answer:?}");
                let claim = Claim { curve: curve.clone(), statement: Statement::Polyline(answer.claim.unwrap()) };
                verify(&claim, &answer.certificate.unwrap()).unwrap();
            }
        }
    }
}

#[test]
fn wrong_polylines_are_refuted() {
    for (name, tolerance) in
        [("m98_5_2", 1e-2), ("trefoil", 1e-2), ("circle_exact", 1e-3), ("trefoil", 0.45), ("m98_5_3", 1e-3)]
    {
        let curve = file(name);
        let line = made(&curve, tolerance);
        let vertices = line.claim().unwrap().vertices;
        let closed = line.closed;
        let refuted = |what: &str, vertices: &[Vertex]| {
            let answer = judged(&curve, vertices, tolerance);
            assert_eq!(answer.verdict, Verdict::Refuted, "{name} {tolerance} {what}: {answer:?}");
            assert!(answer.witness.is_some() && answer.claim.is_none());
        };
        let with = |change: &dyn Fn(&mut Vec<Vertex>)| {
            let mut vertices = vertices.clone();
            change(&mut vertices);
            vertices
        };
        let k = vertices.len() / 2;
        refuted("a vertex moved by 2T", &with(&|v| v[k] = shifted(&v[k], [0.0, 0.0, 2.0 * tolerance])));
        if vertices.len() > 9 {
            refuted("two swapped", &with(&|v| v.swap(k, k + 1)));
            refuted(
                "an edge doubled back",
                &with(&|v| {
                    let back = v[k - 1].clone();
                    let again = v[k].clone();
                    v.splice(k + 1..k + 1, [back, again]);
                }),
            );
            refuted("a part left out", &with(&|v| drop(v.drain(2..v.len() / 2))));
            if !closed {
                refuted("an end left out", &with(&|v| drop(v.drain(..v.len() / 2))));
            }
        }
        refuted("another curve", &made(&file("m98_5_4"), 1e-2).claim().unwrap().vertices);
    }
}

/// A strand of the trefoil led through another one, the tolerance coarse: another knot, though everywhere near.
#[test]
fn a_changed_crossing_is_refuted() {
    let curve = file("trefoil");
    let fine = made(&curve, 1e-2);
    let vertices = fine.vertices;
    // the two places that are nearest to one another along z
    let n = vertices.len();
    let apart = |i: usize, j: usize| (j + n - i) % n > n / 8 && (i + n - j) % n > n / 8;
    let flat = |i: usize, j: usize| (vertices[i][0] - vertices[j][0]).hypot(vertices[i][1] - vertices[j][1]);
    let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| apart(*i, *j));
    let (i, j) = pairs.min_by(|a, b| flat(a.0, a.1).total_cmp(&flat(b.0, b.1))).unwrap();
    let drop = 1.5 * (vertices[j][2] - vertices[i][2]);
    let mut changed = vertices.clone();
    for (k, v) in changed.iter_mut().enumerate() {
        let away = ((k + n - i) % n).min((i + n - k) % n) as f64;
        v[2] += drop * (1.0 - away / 5.0).max(0.0);
    }
    assert_eq!((determinant(&vertices), determinant(&changed)), (3, 1));
    let exact: Vec<Vertex> = changed.iter().map(|v| v.map(|x| rational_from_f64(x).unwrap())).collect();
    let answer = judged(&curve, &exact, 5.0);
    assert_eq!(answer.verdict, Verdict::Refuted, "{answer:?}");
}

/// Found by readers: feet that fall on one position (no arc is left, and nothing was tested), the seam of a closed spine, and
/// vertices many spans apart.
#[test]
fn feet_that_are_hard_to_tell() {
    let line = bezier_int(&[[0, 0, 0], [1, 0, 0]]);
    let point = |x: f64, y: f64| [x, y, 0.0].map(|x| rational_from_f64(x).unwrap());
    for off in [4e-16, -4e-16, 1e-9] {
        let spike =
            [point(0.0, 0.0), point(0.5, 0.0), point(0.5 + off, 0.35), point(0.5 + 2.0 * off, 0.0), point(1.0, 0.0)];
        assert_ne!(judged(&line, &spike, 0.1).verdict, Verdict::Certified);
    }
    assert_ne!(
        judged(&line, &[point(-0.05, 0.0), point(6e-16, 0.0), point(1.0, 0.0)], 0.1).verdict,
        Verdict::Certified
    );

    let circle = file("circle_exact");
    for tiny in [1e-17, -1e-17, 1e-16, -1e-16, 1e-15, 1e-14] {
        let at = |k: i32| {
            let angle = std::f64::consts::PI * (1.0 + f64::from(k) / 32.0);
            if k == 32 { point(1.0005, tiny) } else { point(angle.cos(), angle.sin()) }
        };
        let vertices: Vec<Vertex> = (0..64).map(at).collect();
        assert_ne!(judged(&circle, &vertices, 0.01).verdict, Verdict::Refuted, "{tiny:e}");
    }

    let knot = torus_knot(2, 3, 200);
    let line = made(&knot, 10.0);
    assert!(line.edges < 40);
    assert_eq!(judged(&knot, &line.claim().unwrap().vertices, 10.0).verdict, Verdict::Certified);
}

/// Beyond the ends of an open spine by less than the tolerance: certified on the spine prolonged by stubs.
#[test]
fn beyond_the_ends() {
    for name in ["m98_5_2", "m98_5_3", "straight_line", "pierced_end", "m98_5_6_1"] {
        let curve = file(name);
        let line = made(&curve, 1e-2);
        let vertices = line.claim().unwrap().vertices;
        let points = near(&vertices);
        let n = points.len();
        let out = |k: usize, inner: usize, by: f64| {
            let d = sub(&points[k], &points[inner]);
            let size = dot(&d, &d).sqrt();
            shifted(&vertices[k], d.map(|x| x / size * by))
        };
        for (start, finish) in [(3e-3, 0.0), (0.0, 1e-7), (5e-3, 4e-3), (1e-12, 1e-3)] {
            let mut moved = vertices.clone();
            (moved[0], moved[n - 1]) = (out(0, 1, start), out(n - 1, n - 2, finish));
            let mut backwards = moved.clone();
            backwards.reverse();
            for moved in [moved, backwards] {
                let answer = judged(&curve, &moved, 1.2e-2);
                assert_eq!(answer.verdict, Verdict::Certified, "{name} {start} {finish} {answer:?}");
                assert!(answer.distance.hi >= start.max(finish) * 0.9);
                let (claim, certificate) = (answer.claim.unwrap(), answer.certificate.unwrap());
                let spine = sampled(&curve, 300);
                let [far, back] = hausdorff(&spine, &near(&claim.vertices), false);
                assert!(far <= answer.distance.hi * (1.0 + 1e-9) && back <= answer.distance.hi + 1e-4);
                let claim = Claim { curve: curve.clone(), statement: Statement::Polyline(claim) };
                verify(&claim, &certificate).unwrap();
                // without the stubs, with others, or one for the other, it proves nothing
                let text = certificate.encode();
                let stubs = text.lines().find(|line| line.starts_with("stubs")).unwrap();
                for other in ["stubs 0 0\n".to_string(), "stubs -1 1/2\n".to_string(), String::new()] {
                    let text = text.replace(&format!("{stubs}\n"), &other);
                    let certificate = Certificate::decode(text.as_bytes());
                    assert!(certificate.is_err() || verify(&claim, &certificate.unwrap()).is_err(), "{other}");
                }
            }
        }
        let mut far = vertices.clone();
        far[0] = out(0, 1, 2e-2);
        assert_eq!(judged(&curve, &far, 1e-2).verdict, Verdict::Refuted);
    }
}

/// On an open spine the order of the vertices is theirs, on a closed one the start is free.
#[test]
fn another_order_is_another_polyline() {
    let curve = file("m98_5_2");
    let line = made(&curve, 0.05);
    let (claim, certificate) = (line.claim().unwrap(), line.certificate.unwrap());
    for (closed, turn) in [(false, 3), (true, 0), (true, 3)] {
        let mut mutant = Claimed { closed, ..claim.clone() };
        mutant.vertices.rotate_left(turn);
        assert!(verify(&Claim { curve: curve.clone(), statement: Statement::Polyline(mutant) }, &certificate).is_err());
    }
}

#[test]
fn unusable_polylines() {
    let spine = Spine::from_curve(file("m98_5_2")).unwrap();
    let kind = |vertices: &[Vertex], tolerance: f64| {
        check(&spine, vertices, tolerance, &CheckOptions::new()).unwrap_err().kind
    };
    let point = [int(0), int(0), int(0)];
    assert_eq!(kind(&[], 1.0), ErrorKind::Option);
    assert_eq!(kind(std::slice::from_ref(&point), 1.0), ErrorKind::Option);
    assert_eq!(kind(&[point.clone(), point.clone(), point.clone()], 1.0), ErrorKind::Option);
    assert_eq!(kind(&[point.clone(), [int(1), int(1), int(1)]], f64::NAN), ErrorKind::Option);
}

#[test]
fn many_vertices_end() {
    let curve = file("m98_5_2");
    let many: Vec<Vertex> = (0..200_000).map(|k| [q(k, 1000), q(k * k % 97, 10), int(0)]).collect();
    assert_eq!(judged(&curve, &many, 1e-3).verdict, Verdict::Refuted);
    let still: Vec<Vertex> = (0..200_000).map(|k| [q(k % 2, 1_000_000), int(0), int(0)]).collect();
    assert_ne!(judged(&curve, &still, 1e-3).verdict, Verdict::Certified);
}

proptest! {
    #![proptest_config(settings(150))]

    /// No polyline that the samples find wrong is certified.
    #[test]
    fn wrong_ones_are_never_certified(
        name in prop::sample::select(vec!["m98_5_2", "trefoil", "circle_exact", "m98_5_5_planar", "m98_5_3"]),
        tolerance in prop::sample::select(vec![0.5, 0.1, 0.02]),
        edits in prop::collection::vec((0..4_u8, any::<prop::sample::Index>(), any::<prop::sample::Index>(), -3.0..3.0_f64), 1..4),
    ) {
        let curve = file(name);
        let mut vertices = made(&curve, tolerance).claim().unwrap().vertices;
        for (kind, i, j, by) in edits {
            let (i, j) = (i.index(vertices.len()), j.index(vertices.len()));
            match kind {
                0 => vertices[i] = shifted(&vertices[i], [by * tolerance, 0.3 * by * tolerance, 0.0]),
                1 => vertices.swap(i, j),
                2 if vertices.len() > 4 => drop(vertices.remove(i)),
                _ => vertices.insert(i, vertices[j].clone()),
            }
        }
        let answer = judged(&curve, &vertices, tolerance);
        let (closed, points) = (name == "trefoil" || name == "circle_exact", near(&vertices));
        let [far, back] = hausdorff(&sampled(&curve, 100), &points, closed);
        let wrong = far > tolerance * (1.0 + 1e-9) || back > tolerance + 1e-3;
        let crossed = answer.verdict == Verdict::Certified && {
            let mut points = points.clone();
            points.dedup();
            if closed && points.first() == points.last() { points.pop(); }
            clearance(&points, closed) <= 0.0 || (name == "trefoil" && determinant(&points) != 3)
        };
        if wrong || crossed {
            prop_assert_ne!(answer.verdict, Verdict::Certified, "{:?} {:?}", answer, points);
        }
        if answer.verdict == Verdict::Refuted && answer.reason == "farther_than_tolerance" {
            prop_assert!(back > tolerance * (1.0 - 1e-9) - 1e-9, "{:?}", answer);
        }
        if answer.verdict == Verdict::Refuted && answer.reason == "spine_passed_over" {
            prop_assert!(far > tolerance * 0.98, "{} {:?}", far, answer);
        }
    }
}

proptest! {
    #![proptest_config(settings(60))]

    #[test]
    fn random_spines(curve in spine_anywhere(), share in 1e-4..1.0_f64) {
        let Ok(spine) = Spine::from_curve(curve.clone()) else { return Ok(()) };
        let points = sampled(&curve, 30);
        let size = points.iter().map(|p| { let d = sub(p, &points[0]); dot(&d, &d).sqrt() }).fold(0.0, f64::max);
        let options = PolylineOptions::new().certificate(true).max_cells(100_000);
        let tolerance = share * size;
        if !(tolerance > 0.0 && tolerance.is_finite()) { return Ok(()) }
        let Ok(line) = polyline(&spine, tolerance, &options) else { return Ok(()) };
        if line.is_certified() {
            let [far, _] = hausdorff(&points, &line.vertices, line.closed);
            prop_assert!(far <= line.distance.hi * (1.0 + 1e-9), "{far} {:?}\n{}", line.distance, curve.to_json());
            prop_assert!(line.certificate.is_some(), "no certificate\n{}", curve.to_json());
            let claim = Claim { curve: curve.clone(), statement: Statement::Polyline(line.claim().unwrap()) };
            let verdict = verify(&claim, line.certificate.as_ref().unwrap());
            prop_assert!(verdict.is_ok(), "{}\n{}", verdict.unwrap_err(), curve.to_json());
        }
    }
}
