//! Certificates: each answer verifies, exactly as it is printed; no mutant of one proves a claim that is false; and a
//! second checker, in Python and from docs/certificate-format.md alone, agrees on every file.

mod shapes;

use std::path::{Path, PathBuf};
use std::process::Command;

use shapes::*;
use tubecert::number::{lower_text, nearest_text, parse_rational, upper_text};
use tubecert::{Certificate, Claim, Curve, Radius, RadiusOptions, Rational, Spine, Statement, radius, verify};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

fn file(name: &str) -> Curve {
    let path = folder("curves").join(format!("{name}.json"));
    Curve::from_json_slice(&std::fs::read(&path).unwrap()).unwrap()
}

fn answer(curve: &Curve, width: f64) -> Radius {
    let spine = Spine::from_curve(curve.clone()).expect("a spine");
    radius(&spine, &RadiusOptions::new().rel_width(width).certificate(true)).expect("an answer")
}

fn certificate(curve: &Curve, width: f64) -> Certificate {
    answer(curve, width).certificate.unwrap_or_else(|| panic!("no certificate for {}", curve.to_json()))
}

fn number(text: &str) -> Option<Rational> {
    (text != "null").then(|| parse_rational(text).unwrap())
}

/// The bounds that are claimed for delta.
fn bounds(claim: &Claim) -> [Option<Rational>; 2] {
    match &claim.statement {
        Statement::Radius { lo, hi } => [lo.clone(), hi.clone()],
        other => panic!("{other:?}"),
    }
}

/// The answer verifies as printed, and with either bound one f64 inside it does not.
fn verifies(curve: &Curve, width: f64) -> String {
    let answer = answer(curve, width);
    let certificate = answer.certificate.unwrap_or_else(|| panic!("no certificate for {}", curve.to_json()));
    let text = certificate.encode();
    let certificate = Certificate::decode(text.as_bytes()).expect("its own text");
    let claim = |lo: String, hi: String| Claim {
        curve: curve.clone(),
        statement: Statement::Radius { lo: number(&lo), hi: number(&hi) },
    };
    let (lo, hi) = (answer.delta.lo, answer.delta.hi);
    let printed = claim(lower_text(lo), upper_text(hi));
    let verified = verify(&printed, &certificate).unwrap_or_else(|e| panic!("{e}\n{}", curve.to_json()));
    assert_eq!(bounds(verified.claim()), bounds(&printed));
    let inside = |text: String, step: fn(f64) -> f64| nearest_text(step(text.parse::<f64>().unwrap()));
    if lo.is_finite() {
        let claim = claim(inside(lower_text(lo), f64::next_up), upper_text(hi));
        assert_eq!(verify(&claim, &certificate).unwrap_err().section, "lo");
    }
    if hi.is_finite() && hi > 0.0 {
        let claim = claim(lower_text(lo), inside(upper_text(hi), f64::next_down));
        assert_eq!(verify(&claim, &certificate).unwrap_err().section, "hi");
    }
    text
}

const CURVES: [&str; 12] = [
    "circle_exact",
    "m98_5_1_parabola",
    "m98_5_2",
    "m98_5_3",
    "m98_5_4",
    "m98_5_4_as_printed",
    "m98_5_5_planar",
    "m98_5_6_1",
    "m98_5_6_2",
    "pierced_end",
    "straight_line",
    "trefoil",
];

#[test]
fn every_curve_verifies_as_printed() {
    for name in CURVES {
        let text = verifies(&file(name), 1e-9);
        let most = match name {
            "m98_5_3" => 20_000,
            "trefoil" => 400_000,
            _ => usize::MAX,
        };
        assert!(text.len() <= most, "{name}: {} bytes", text.len());
    }
}

#[test]
fn knots_of_forty_spans_and_high_degree() {
    for (turns, around) in [(2, 3), (2, 5), (3, 4)] {
        verifies(&torus_knot(turns, around, 40), 1e-9);
    }
    verifies(&degree_twelve(), 1e-9);
}

/// An arc of a parabola in space, elevated to degree 12 and bent by its last control points.
fn degree_twelve() -> Curve {
    let points = (0..=12i64).map(|i| [int(i), q(i * (12 - i), 9), q((i % 3) * i, 11)]).collect();
    bezier(points)
}

#[test]
fn other_shapes() {
    for curve in [
        hairpin(int(3), int(1)),
        stadium(int(2), q(1, 3)),
        hook(q(1, 50)),
        alpha(q(3, 2000)),
        alpha(int(0)),
        figure_eight(),
        crossing_on_a_knot(1),
        crossing_on_its_seam(),
        butterfly(),
        glide(),
        bulb(q(1, 100)),
        faced(q(1, 10)),
        peanut(q(1, 10)),
        circle(6),
        moved(&scaled(&file("m98_5_3"), &power(10, -7)), &[power(10, 6), int(3), power(10, 5)]),
        bezier_int(&[[0, 0, 0], [7, 5, 0], [-3, 6, 0], [4, 0, 0]]),
        bezier_int(&[[0, 0, 0], [3, 1, 0], [-3, 1, 1], [0, 0, 0]]),
    ] {
        verifies(&curve, 1e-6);
    }
}

/// Bounds of delta from a narrower answer: a claim is false if it does not meet them.
struct Truth {
    lo: Option<Rational>,
    hi: Option<Rational>,
}

impl Truth {
    fn of(curve: &Curve) -> Self {
        let delta = answer(curve, 1e-12).delta;
        Self { lo: number(&lower_text(delta.lo)), hi: number(&upper_text(delta.hi)) }
    }

    fn allows(&self, claim: &Claim) -> bool {
        // None is +infinity
        let low = |claimed: &Option<Rational>, hi: &Option<Rational>| match (claimed, hi) {
            (_, None) => true,
            (None, Some(_)) => false,
            (Some(claimed), Some(hi)) => claimed <= hi,
        };
        let [lo, hi] = bounds(claim);
        low(&lo, &self.hi) && low(&self.lo, &hi)
    }
}

/// Every text that differs from a certificate in one line or one field.
fn mutants(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let mut all = vec![];
    let mut with = |replaced: Vec<String>| all.push(replaced.iter().map(|line| format!("{line}\n")).collect());
    let own = || lines.iter().map(|line| (*line).to_string()).collect::<Vec<String>>();
    for (i, line) in lines.iter().enumerate() {
        let mut dropped = own();
        dropped.remove(i);
        with(dropped);
        let mut doubled = own();
        doubled.insert(i, (*line).to_string());
        with(doubled);
        if i + 1 < lines.len() && lines[i + 1] != *line {
            let mut swapped = own();
            swapped.swap(i, i + 1);
            with(swapped);
        }
        let fields: Vec<&str> = line.split(' ').collect();
        for (k, field) in fields.iter().enumerate() {
            let mut values: Vec<String> =
                ["0", "1", "-1", "inf", "/", "2", "curved", "local", "side 1 0", "side 0 1", "none"]
                    .map(String::from)
                    .to_vec();
            values.extend(
                ["bent 2147483648 2147483648 0 0 0 0", "slab 1 0 0", "cone 1 1 1", "share 2147483648"]
                    .map(String::from),
            );
            values.push(String::new());
            if let Ok(x) = parse_rational(field) {
                let near = [
                    &x + int(1),
                    &x - int(1),
                    -&x,
                    &x * int(2),
                    &x / int(2),
                    &x * q(1_000_001, 1_000_000),
                    &x * q(999_999, 1_000_000),
                ];
                values.extend(near.iter().map(tubecert::number::to_fraction_text));
            }
            for value in values.into_iter().filter(|value| value != field) {
                let mut changed: Vec<&str> = fields.clone();
                changed[k] = &value;
                let mut replaced = own();
                replaced[i] = changed.join(" ").trim_end().to_string();
                with(replaced);
            }
        }
    }
    all
}

/// Each mutant is no certificate, is rejected, or proves what is true.
fn mutants_prove_nothing_false(curve: &Curve, width: f64) {
    let text = certificate(curve, width).encode();
    let truth = Truth::of(curve);
    let (mut accepted, mut rejected) = (0, 0);
    for mutant in mutants(&text) {
        let Ok(certificate) = Certificate::decode(mutant.as_bytes()) else { continue };
        assert_eq!(certificate.encode(), mutant, "not canonical");
        let claim = certificate.claim(curve.clone());
        if verify(&claim, &certificate).is_ok() {
            accepted += 1;
            assert!(truth.allows(&claim), "a false claim is accepted: {:?}\n{mutant}", claim.statement);
        } else {
            rejected += 1;
        }
    }
    assert!(rejected > 20 && accepted > 0, "{accepted} accepted, {rejected} rejected");
}

#[test]
fn mutants_of_an_open_spine() {
    mutants_prove_nothing_false(&file("m98_5_1_parabola"), 1e-9);
    mutants_prove_nothing_false(&file("m98_5_2"), 1e-3);
}

#[test]
fn mutants_of_a_closed_spine() {
    mutants_prove_nothing_false(&file("circle_exact"), 0.2);
}

#[test]
fn mutants_of_rational_and_planar_spines() {
    mutants_prove_nothing_false(&file("m98_5_3"), 1e-3);
    mutants_prove_nothing_false(&file("m98_5_5_planar"), 1e-2);
}

#[test]
fn mutants_of_self_contacts() {
    mutants_prove_nothing_false(&bezier_int(&[[0, 0, 0], [7, 5, 0], [-3, 6, 0], [4, 0, 0]]), 1e-6);
    mutants_prove_nothing_false(&alpha(int(0)), 1e-6);
    mutants_prove_nothing_false(&butterfly(), 1e-6);
    mutants_prove_nothing_false(&bezier_int(&[[0, 0, 0], [3, 1, 0], [-3, 1, 1], [0, 0, 0]]), 1e-6);
}

#[test]
fn another_curve_is_rejected() {
    let certificate = certificate(&file("m98_5_4"), 1e-6);
    let rejection = verify(&certificate.claim(file("m98_5_4_as_printed")), &certificate).unwrap_err();
    assert_eq!(rejection.section, "curve");
}

/// A search that took another curve for this one: its certificates, with the digest mended, prove nothing false.
#[test]
fn evidence_for_a_neighbour_of_the_curve() {
    for name in ["m98_5_2", "m98_5_3", "m98_5_4", "trefoil"] {
        let curve = file(name);
        let truth = Truth::of(&curve);
        for (i, k) in [(0, 0), (1, 1), (2, 2), (3, 0)] {
            let mut points = curve.control_points().to_vec();
            points[i][k] = -&points[i][k] * q(11, 10) + q(1, 7);
            let Ok(other) =
                Curve::new(curve.degree(), points, Some(curve.weights().to_vec()), Some(curve.knots().to_vec()))
            else {
                continue;
            };
            let text = certificate(&other, 1e-4).encode().replace(&other.digest(), &curve.digest());
            let certificate = Certificate::decode(text.as_bytes()).unwrap();
            let claim = certificate.claim(curve.clone());
            assert!(verify(&claim, &certificate).is_err() || truth.allows(&claim), "{name}, point {i}");
        }
    }
}

/// Long hostile texts about `m98_5_2`, made from its kept certificate: more splits than leaves, and arcs too deep.
fn long_texts() -> [String; 3] {
    let path = folder("certificates/accept").join("m98_5_2__1e-9.txt");
    let text = std::fs::read_to_string(path).unwrap();
    let (head, _) = text.split_at(text.find("along\n").unwrap() + "along\n".len());
    let (along, _) = text.split_at(text.find("pairs\n").unwrap());
    let (_, rest) = text.split_at(text.find("start ").unwrap());
    [
        format!("{head}{}", "/\n".repeat(100_000)),
        format!("{head}{}pairs\n", "/\ncurved\n".repeat(2_000)),
        format!("{along}pairs\n/\ncone 1 0 0\n{}{rest}", "1\n".repeat(3_000)),
    ]
}

/// The files of tests/certificates: what must be accepted, what must be rejected, and what must only be survived. Their
/// names start with the curve's, up to `__`.
#[test]
fn kept_files() {
    let files = |kind: &str| {
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(folder("certificates").join(kind)).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{kind} is empty");
        files
    };
    let curve_of = |path: &Path| {
        let name = path.file_name().unwrap().to_str().unwrap();
        file(name.split("__").next().unwrap())
    };
    for path in files("accept") {
        let certificate = Certificate::decode(&std::fs::read(&path).unwrap()).unwrap();
        verify(&certificate.claim(curve_of(&path)), &certificate).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
    for path in files("reject") {
        let certificate = Certificate::decode(&std::fs::read(&path).unwrap()).unwrap();
        assert!(verify(&certificate.claim(curve_of(&path)), &certificate).is_err(), "{}", path.display());
    }
    let survive = files("survive").into_iter().map(|path| (curve_of(&path), std::fs::read(&path).unwrap()));
    for (curve, text) in survive.chain(long_texts().map(|text| (file("m98_5_2"), text.into_bytes()))) {
        if let Ok(certificate) = Certificate::decode(&text) {
            let _ = verify(&certificate.claim(curve), &certificate);
        }
    }
}

/// Both checkers accept and reject the same files: those kept, and a sample of mutants.
#[test]
fn second_checker_agrees() {
    let scratch = std::env::temp_dir().join(format!("tubecert-second-{}", std::process::id()));
    std::fs::create_dir_all(&scratch).unwrap();
    let mut cases: Vec<(PathBuf, PathBuf)> = vec![];
    for kind in ["accept", "reject", "survive"] {
        for entry in std::fs::read_dir(folder("certificates").join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().split("__").next().unwrap().to_string();
            cases.push((folder("curves").join(format!("{name}.json")), path));
        }
    }
    let mut keep = |name: &str, i: String, text: String| {
        let path = scratch.join(format!("{name}__{i}"));
        std::fs::write(&path, text).unwrap();
        let own = scratch.join(format!("{name}.json"));
        let curve = if own.exists() { own } else { folder("curves").join(format!("{name}.json")) };
        cases.push((curve, path));
    };
    for (i, text) in long_texts().into_iter().enumerate() {
        keep("m98_5_2", format!("long{i}"), text);
    }
    let loose = |name, width| (name, certificate(&file(name), width));
    let mut sampled = [("m98_5_1_parabola", 1e-6), ("m98_5_2", 1e-2), ("m98_5_3", 1e-2), ("circle_exact", 0.2)]
        .map(|(name, width)| loose(name, width))
        .to_vec();
    let crossing = bezier_int(&[[0, 0, 0], [7, 5, 0], [-3, 6, 0], [4, 0, 0]]);
    let seam = crossing_on_its_seam();
    for (name, curve) in [("crossing", crossing), ("seam", seam), ("butterfly", butterfly()), ("alpha", alpha(int(0)))]
    {
        std::fs::write(scratch.join(format!("{name}.json")), curve.to_json()).unwrap();
        sampled.push((name, certificate(&curve, 1e-2)));
    }
    for (name, certificate) in sampled {
        let mutants = mutants(&certificate.encode());
        // all of a short one
        let step = if mutants.len() < 300 { 1 } else { 23 };
        for (i, mutant) in mutants.into_iter().enumerate().step_by(step) {
            keep(name, i.to_string(), mutant);
        }
    }
    let list: String = cases.iter().map(|(curve, cert)| format!("{}\t{}\n", curve.display(), cert.display())).collect();
    std::fs::write(scratch.join("list"), list).unwrap();
    let python = Command::new("python3")
        .arg(folder("second_checker").join("second_checker.py"))
        .arg("--list")
        .arg(scratch.join("list"))
        .output()
        .expect("python3 runs the second checker");
    assert!(python.status.success(), "{}", String::from_utf8_lossy(&python.stderr));
    let verdicts = String::from_utf8(python.stdout).unwrap();
    assert_eq!(verdicts.lines().count(), cases.len());
    for ((curve, path), verdict) in cases.iter().zip(verdicts.lines()) {
        let curve = Curve::from_json_slice(&std::fs::read(curve).unwrap()).unwrap();
        let ours = match Certificate::decode(&std::fs::read(path).unwrap()) {
            Err(_) => "undecodable",
            Ok(certificate) => match verify(&certificate.claim(curve), &certificate) {
                Ok(_) => "verified",
                Err(_) => "rejected",
            },
        };
        assert_eq!(verdict, ours, "{}\n{}", path.display(), std::fs::read_to_string(path).unwrap_or_default());
    }
    std::fs::remove_dir_all(&scratch).unwrap();
}
