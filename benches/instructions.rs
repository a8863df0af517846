//! One job each, for benches/instructions.py to count its instructions under valgrind. Without names every job runs once,
//! natively, and its name is printed. Run without target flags: valgrind rounds to nearest whatever inari asks for, and the
//! portable interval needs nothing else. So the answers hold under valgrind too, and each job asserts its own.

use std::hint::black_box;
use tubecert::roots::complex_roots;
use tubecert::{Certificate, Curve, RadiusOptions, Rational, Spine, curvature, pairs, radius, verify};

#[path = "../tests/shapes/mod.rs"]
mod shapes;

type Job = Box<dyn FnMut()>;

/// What is collected: neither the preparation nor the start of the process.
#[inline(never)]
fn measured(job: &mut dyn FnMut()) {
    job();
}

fn text(name: &str) -> String {
    let path = format!("{}/tests/curves/{name}.json", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn curve(name: &str) -> Curve {
    Curve::from_json_str(&text(name)).expect("a curve")
}

fn spine(curve: Curve) -> Spine {
    Spine::from_curve(curve).expect("a spine")
}

fn delta(spine: Spine) -> Job {
    Box::new(move || assert!(radius(&spine, &RadiusOptions::new()).expect("an answer").delta.is_within(1e-9)))
}

/// 200 cubics, text to answer, as in a batch.
fn cubics() -> Job {
    let texts = shapes::random_cubics(200);
    Box::new(move || {
        for text in &texts {
            let spine = Spine::from_json_str(black_box(text)).expect("a spine");
            assert!(radius(&spine, &RadiusOptions::new()).expect("an answer").delta.is_within(1e-9));
        }
    })
}

fn replay() -> Job {
    let curve = curve("m98_5_3");
    let answer = radius(&spine(curve.clone()), &RadiusOptions::new().certificate(true)).expect("an answer");
    let text = answer.certificate.expect("a certificate").encode();
    Box::new(move || {
        let certificate = Certificate::decode(black_box(text.as_bytes())).expect("a certificate");
        verify(&certificate.claim(curve.clone()), &certificate).expect("verified");
    })
}

fn prepared(name: &str) -> Job {
    match name {
        "read_5_3" => {
            let text = text("m98_5_3");
            Box::new(move || assert!(Spine::from_json_str(black_box(&text)).is_ok()))
        }
        "radius_5_3" => delta(spine(curve("m98_5_3"))),
        "radius_trefoil" => delta(spine(curve("trefoil"))),
        "radius_torus_40" => delta(spine(shapes::torus_knot(2, 3, 40))),
        "cubics_200" => cubics(),
        "pairs_5_3" => {
            let spine = spine(curve("m98_5_3"));
            Box::new(move || assert_eq!(pairs(&spine, &Default::default()).expect("an answer").pairs.len(), 4))
        }
        "curvature_5_3" => {
            let spine = spine(curve("m98_5_3"));
            Box::new(move || {
                assert_eq!(curvature(&spine, &Default::default()).expect("an answer").critical_points.len(), 3)
            })
        }
        "complex_roots_5_6_2" => {
            let p: Vec<Rational> = [452, -672, -552, 2912, -588, -2688, 1808].map(shapes::int).to_vec();
            Box::new(move || assert_eq!(complex_roots(black_box(&p)).expect("not 0").len(), 6))
        }
        "verify_5_3" => replay(),
        other => panic!("no job {other}"),
    }
}

const ALL: [&str; 9] = [
    "read_5_3",
    "radius_5_3",
    "radius_trefoil",
    "radius_torus_40",
    "cubics_200",
    "pairs_5_3",
    "curvature_5_3",
    "complex_roots_5_6_2",
    "verify_5_3",
];

fn main() {
    // cargo adds --bench
    let names: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let all = ALL.map(String::from);
    for name in if names.is_empty() { &all[..] } else { &names } {
        println!("{name}");
        measured(&mut *prepared(name));
    }
}
