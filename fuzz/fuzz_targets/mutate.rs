//! Edits of true certificates: whatever still verifies is true.
#![no_main]

use std::sync::LazyLock;

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use tubecert::number::{lower_text, parse_rational, upper_text};
use tubecert::{Certificate, Curve, RadiusOptions, Rational, Spine, Statement, radius, verify};

struct Case {
    curve: Curve,
    lines: Vec<String>,
    /// Bounds of delta from a far narrower answer.
    lo: Rational,
    hi: Rational,
}

static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let case = |text: &str, width: f64| {
        let spine = Spine::from_json_str(text).expect("a spine");
        let answer = |width| {
            let options = RadiusOptions::new().rel_width(width).certificate(true);
            radius(&spine, &options).expect("an answer")
        };
        let (wide, narrow) = (answer(width), answer(1e-12).delta);
        let lines = wide.certificate.expect("a certificate").encode().lines().map(String::from).collect();
        let bound = |text: String| parse_rational(&text).expect("a number");
        let (lo, hi) = (bound(lower_text(narrow.lo)), bound(upper_text(narrow.hi)));
        Case { curve: spine.curve().clone(), lines, lo, hi }
    };
    vec![
        case(include_str!("../../tests/curves/m98_5_1_parabola.json"), 1e-3),
        case(include_str!("../../tests/curves/m98_5_2.json"), 1e-2),
        case(include_str!("../../tests/curves/m98_5_5_planar.json"), 1e-1),
        case(include_str!("../../tests/curves/m98_5_3.json"), 1e-1),
    ]
});

#[derive(Debug, Arbitrary)]
enum Edit {
    Drop(u16),
    Double(u16),
    Swap(u16, u16),
    Copy(u16, u16),
    Whole(u16, u8, i32),
    Add(u16, u8, i8),
    Scale(u16, u8, i8),
}

fuzz_target!(|input: (u8, Vec<Edit>)| {
    let (case, edits) = input;
    let case = &CASES[usize::from(case) % CASES.len()];
    let mut lines = case.lines.clone();
    for edit in edits.into_iter().take(4) {
        if lines.is_empty() {
            return;
        }
        let count = lines.len();
        let at = |i: u16| usize::from(i) % count;
        let mut field = |i: u16, k: u8, change: &dyn Fn(&Rational) -> Rational| {
            let mut fields: Vec<String> = lines[at(i)].split(' ').map(String::from).collect();
            let k = usize::from(k) % fields.len();
            if let Ok(x) = parse_rational(&fields[k]) {
                fields[k] = tubecert::number::to_fraction_text(&change(&x));
            }
            lines[at(i)] = fields.join(" ");
        };
        let whole = |n: i64| Rational::from_integer(n.into());
        match edit {
            Edit::Whole(i, k, n) => field(i, k, &|_| whole(n.into())),
            Edit::Add(i, k, n) => field(i, k, &|x| x + whole(n.into())),
            Edit::Scale(i, k, n) => field(i, k, &|x| x * (whole(1) + whole(n.into()) / whole(1 << 20))),
            Edit::Drop(i) => drop(lines.remove(at(i))),
            Edit::Double(i) => lines.insert(at(i), lines[at(i)].clone()),
            Edit::Swap(i, j) => lines.swap(at(i), at(j)),
            Edit::Copy(i, j) => lines[at(i)] = lines[at(j)].clone(),
        }
    }
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    let Ok(certificate) = Certificate::decode(text.as_bytes()) else { return };
    let claim = certificate.claim(case.curve.clone());
    if verify(&claim, &certificate).is_ok() {
        let Statement::Radius { lo, hi } = &claim.statement else { return };
        let true_lo = lo.as_ref().is_some_and(|lo| *lo <= case.hi);
        let true_hi = hi.as_ref().is_none_or(|hi| case.lo <= *hi);
        assert!(true_lo && true_hi, "a false claim is accepted: {lo:?} .. {hi:?}\n{text}");
    }
});
