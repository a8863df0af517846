//! The reader of numbers, JSON and curve files: every error provoked with its place, every definition tested.

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use tubecert::curve::Curve;
use tubecert::error::{Error, ErrorKind};
use tubecert::number::*;

fn q(numerator: i64, denominator: i64) -> Rational {
    Rational::new(numerator.into(), denominator.into())
}

fn ten_to(power: i32) -> Rational {
    Rational::from_integer(10.into()).pow(power)
}

fn read(text: &str) -> Rational {
    parse_rational(text).unwrap()
}

fn number_error(text: &str) -> ErrorKind {
    parse_rational(text).unwrap_err().kind
}

type Place = (ErrorKind, Option<String>, Option<usize>);

/// Where the error stands that `text` is refused with; its byte offset is that of the mark `@`, if there is one.
fn refused(text: &str) -> Place {
    let error = Curve::from_json_str(&text.replacen('@', "", 1)).unwrap_err();
    assert_eq!(error.offset, text.find('@'), "{text}");
    place(error)
}

fn place(error: Error) -> Place {
    assert!(!error.message.is_empty() && !error.to_string().is_empty());
    (error.kind, error.key, error.index)
}

fn at(kind: ErrorKind, key: &str, index: impl Into<Option<usize>>) -> Place {
    (kind, Some(key.to_string()), index.into())
}

fn json_error(bytes: &[u8]) -> (ErrorKind, usize) {
    let error = Curve::from_json_slice(bytes).unwrap_err();
    (error.kind, error.offset.unwrap())
}

fn example_files() -> Vec<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/curves");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap())).collect()
}

fn assert_same_curve(a: &Curve, b: &Curve) {
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

// Numbers.

#[test]
fn both_grammars_are_read_exactly() {
    for (text, value) in [
        ("0", q(0, 1)),
        ("-0", q(0, 1)),
        ("-0.000e-7", q(0, 1)),
        ("+7", q(7, 1)),
        ("5.", q(5, 1)),
        (".5", q(1, 2)),
        ("-.125E+1", q(-5, 4)),
        ("0.1", q(1, 10)),
        ("00012.50", q(25, 2)),
        ("1e-3", q(1, 1000)),
        ("250e-0000000000000000000000000003", q(1, 4)),
        ("-6/4", q(-3, 2)),
        ("0/5", q(0, 1)),
        ("007/2", q(7, 2)),
    ] {
        let parsed = read(text);
        assert!(same(&parsed, &value), "{text}");
    }
    assert!(same(&read("1e5000"), &ten_to(5000)));
    assert!(same(&read("1e-5000"), &ten_to(-5000)));
}

#[test]
fn no_other_spelling_is_a_number() {
    for text in [
        "", "+", "-", ".", "-.", "e5", ".e5", "1e", "1e+", "1e1.5", "1e5e5", "1.2.3", " 1", "1 ", "1_000", "0x10",
        "inf", "NaN", "--1", "+-1", "1/", "/2", "1/-2", "+1/2", "1.5/2", "1/2/3", "1e2/3", "1 / 2", "1/0", "-1/000",
        "\u{663}", "1\u{0}",
    ] {
        assert_eq!(number_error(text), ErrorKind::Number, "{text:?}");
    }
}

#[test]
fn limits_of_numbers_hold_on_both_sides() {
    let nines = "9".repeat(MAX_DIGITS);
    assert_eq!(read(&nines).to_string(), nines);
    assert_eq!(number_error(&format!("{nines}9")), ErrorKind::Limit);
    assert_eq!(number_error(&format!("9.{nines}")), ErrorKind::Limit);
    assert_eq!(number_error(&format!("1/{nines}")), ErrorKind::Limit);
    assert!(parse_rational(&format!("1/{}", &nines[1..])).is_ok());
    assert_eq!(number_error("1e5001"), ErrorKind::Limit);
    assert_eq!(number_error("0e-5001"), ErrorKind::Limit);
    assert_eq!(number_error("1e99999999999999999999999999999999"), ErrorKind::Limit);
    let error = parse_rational("1e5001").unwrap_err();
    assert!(error.message.contains("MAX_EXPONENT") && error.message.contains("5000"));
    assert_eq!(number_error(&"9".repeat(100 << 20)), ErrorKind::Limit);
}

#[test]
fn comparison_survives_numbers_with_long_common_expansions() {
    let (mut a, mut b) = (BigInt::from(1), BigInt::from(1));
    for _ in 0..20_000 {
        (a, b) = (b.clone(), a + b);
    }
    let c = &a + &b;
    let (x, y) = (Rational::new_raw(a, b.clone()), Rational::new_raw(b, c));
    assert_ne!(compare(&x, &y), Ordering::Equal);
    assert_eq!(compare(&x, &x), Ordering::Equal);
    assert!(!same(&x, &y));
}

/// Floats of every kind: all bit patterns, and the edges.
fn any_float() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        (any::<i32>(), -1080_i32..1030).prop_map(|(m, e)| f64::from(m) * 2_f64.powi(e)),
        (any::<u64>(), any::<bool>()).prop_map(|(m, negative)| {
            let subnormal = f64::from_bits(m >> 12);
            if negative { -subnormal } else { subnormal }
        }),
        prop::sample::select(edges()),
    ]
    .prop_filter("finite", |x| x.is_finite())
}

fn edges() -> Vec<f64> {
    let tiny = f64::from_bits(1);
    let ups = [
        0.0,
        tiny,
        2.0 * tiny,
        f64::MIN_POSITIVE.next_down(),
        f64::MIN_POSITIVE,
        0.1,
        0.5,
        1.0,
        1e15,
        1e16,
        1e22,
        1e300,
    ];
    let ups = ups.into_iter().chain([1e-5, 1e-300, 2_f64.powi(53), 2_f64.powi(1023), f64::MAX.next_down(), f64::MAX]);
    ups.flat_map(|x| [x, -x]).collect()
}

/// Rationals of every magnitude, many of them at or between neighbouring floats.
fn any_rational() -> impl Strategy<Value = Rational> {
    prop_oneof![
        (any::<i128>(), 1..i128::MAX).prop_map(|(p, q)| Rational::new(p.into(), q.into())),
        (any::<i64>(), 1..1_000_i64, -400..400_i32).prop_map(|(p, d, e)| q(p, d) * ten_to(e)),
        (any::<i64>(), -1200..1100_i32).prop_map(|(p, e)| q(p, 1) * Rational::from_integer(2.into()).pow(e)),
        (any_float(), 0..3_i64, 1..5_i64).prop_map(|(x, a, b)| {
            let (x, next) = (rational_from_f64(x).unwrap(), rational_from_f64(x.next_up()));
            let step = next.map_or(Rational::zero(), |next| next - &x);
            x + step * q(a, b)
        }),
    ]
}

fn check_directed(x: &Rational) {
    let (below, above) = (f64_below(x), f64_above(x));
    match rational_from_f64(below) {
        Some(exact) => assert!(exact <= *x),
        None => assert_eq!(below, f64::NEG_INFINITY),
    }
    if let Some(next) = rational_from_f64(below.next_up()) {
        assert!(*x < next, "{x}: {below:e} is not the greatest");
    }
    assert!(below < f64::INFINITY && (below != 0.0 || below.is_sign_positive()));
    assert!(above != 0.0 || above.is_sign_positive());
    assert_eq!(above, -f64_below(&-x));
}

#[test]
fn directed_rounding_at_the_edges() {
    let tiny = f64::from_bits(1);
    let max = rational_from_f64(f64::MAX).unwrap();
    let (huge, small) = (ten_to(4000), ten_to(-4000));
    assert_eq!((f64_below(&huge), f64_above(&huge)), (f64::MAX, f64::INFINITY));
    assert_eq!((f64_below(&-&huge), f64_above(&-&huge)), (f64::NEG_INFINITY, -f64::MAX));
    assert_eq!((f64_below(&small), f64_above(&small)), (0.0, tiny));
    assert_eq!((f64_below(&-&small), f64_above(&-&small)), (-tiny, 0.0));
    assert_eq!((f64_below(&max), f64_above(&max)), (f64::MAX, f64::MAX));
    assert_eq!((f64_below(&(&max + &small)), f64_above(&(&max + &small))), (f64::MAX, f64::INFINITY));
    assert_eq!((f64_below(&(&max - &small)), f64_above(&(&max - &small))), (f64::MAX.next_down(), f64::MAX));
    let two_1024 = q(2, 1) * Rational::from_integer(2.into()).pow(1023);
    assert_eq!((f64_below(&two_1024), f64_above(&two_1024)), (f64::MAX, f64::INFINITY));
    assert_eq!((f64_below(&q(0, 1)), f64_above(&q(0, 1))), (0.0, 0.0));
    for x in edges() {
        let exact = rational_from_f64(x).unwrap();
        assert_eq!((f64_below(&exact), f64_above(&exact)), (x, x));
        check_directed(&(&exact + &small));
        check_directed(&(&exact - &small));
    }
    assert!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].iter().all(|x| rational_from_f64(*x).is_none()));
}

fn check_texts(x: f64) {
    let exact = rational_from_f64(x).unwrap();
    for (text, outward) in [(lower_text(x), Ordering::Less), (upper_text(x), Ordering::Greater)] {
        let value: &serde_json::value::RawValue = serde_json::from_str(&text).unwrap();
        assert!(value.get() == text && text.starts_with(|c: char| c == '-' || c.is_ascii_digit()), "{text}");
        assert!(text.len() <= 25, "{text}");
        let nearest: f64 = text.parse().unwrap();
        assert_ne!(read(&text).cmp(&exact), outward.reverse(), "{text} for {x:e}");
        assert_ne!(nearest.partial_cmp(&x), Some(outward.reverse()), "{text} for {x:e}");
        assert!(nearest == x || nearest == x.next_down() || nearest == x.next_up());
    }
    assert_eq!(nearest_text(x).parse::<f64>().unwrap(), x);
    let short = read(&nearest_text(x)) == exact;
    assert_eq!((lower_text(x) == nearest_text(x), upper_text(x) == nearest_text(x)), (short, short), "{x:e}");
}

#[test]
fn printed_bounds_hold_both_as_decimal_and_as_f64() {
    edges().into_iter().for_each(check_texts);
    // where shortest decimals end to be exact
    (0..60).for_each(|k| [1.0, -3.0, 1025.0].map(|m| m * 0.5_f64.powi(k)).into_iter().for_each(check_texts));
    assert_eq!((lower_text(0.0), upper_text(-0.0)), ("0".into(), "0".into()));
    assert_eq!((lower_text(1.0), lower_text(-2.5)), ("1".into(), "-2.5".into()));
    assert_eq!((lower_text(1e22), upper_text(1e22)), ("1e22".into(), "1e22".into()));
    assert_eq!((lower_text(f64::from_bits(1)), lower_text(-f64::from_bits(1))), ("0".into(), "-1e-323".into()));
    assert_eq!(upper_text(f64::MAX), "1.7976931348623158e308");
    assert_eq!(upper_text(f64::INFINITY), "null");
}

proptest! {
    #[test]
    fn decimals_are_what_they_spell(m in any::<i64>(), zeros in 0_usize..4, e in -60..60_i32, places in 0_usize..30) {
        let digits = format!("{}{:0>width$}", "0".repeat(zeros), m.unsigned_abs(), width = places);
        let (whole, fraction) = digits.split_at(digits.len() - places);
        let text = format!("{}{whole}.{fraction}e{e}", if m < 0 { "-" } else { "+" });
        prop_assume!(!digits.is_empty());
        let parsed = read(&text);
        let expected = q(m, 1) * ten_to(e - places as i32);
        prop_assert!(same(&parsed, &expected), "{}", text);
    }

    #[test]
    fn spellings_of_floats_are_exact(x in any_float()) {
        let exact = rational_from_f64(x).unwrap();
        prop_assert!(same(&exact, &Rational::from_float(x).unwrap()));
        prop_assert!(same(&read(&exact_text(&exact)), &exact));
        let all_places = format!("{x:.1074}");
        prop_assert!(same(&read(&all_places), &exact));
    }

    #[test]
    fn directed_rounding_is_by_definition(x in any_rational()) {
        check_directed(&x);
    }

    #[test]
    fn printed_bounds_are_outward(x in any_float()) {
        check_texts(x);
    }

    #[test]
    fn exact_texts_are_read_back(m in "[1-9][0-9]{0,80}", pad in 0_usize..1900, e in -5000..=5000_i32, point: bool) {
        let digits = format!("{m}{}", "0".repeat(pad));
        let text = if point { format!("-.{}{m}e{e}", "0".repeat(pad)) } else { format!("{digits}e{e}") };
        let exact = read(&text);
        prop_assert!(same(&read(&exact_text(&exact)), &exact));
    }

    #[test]
    fn fractions_are_read_back(x in any_rational()) {
        let text = to_fraction_text(&x);
        if text.len() <= MAX_DIGITS {
            prop_assert!(same(&read(&text), &x));
        }
        prop_assert!(same(&read(&exact_text(&x)), &x));
        prop_assert_eq!(compare(&x, &Rational::zero()), x.numer().signum().cmp(&BigInt::zero()));
    }

    #[test]
    fn any_text_is_refused_or_read(text in "[-+0-9./eE]{0,12}") {
        if let Ok(x) = parse_rational(&text) {
            prop_assert!(same(&x, &x.reduced()));
        }
    }
}

// JSON.

/// The key and the value that a file is refused for, with the place of the value.
#[test]
fn json_values_keep_text_and_place() {
    let file = |x: &str, name: &str| {
        format!(" {{\"degr\\u0065e\": 1, \"control_points\": [[0, 0], [1.50e+2, {x}]], \"n\\u0061me\": {name}}}\n")
    };
    let curve = Curve::from_json_str(&file("-0", r#""\ud83d\ude00\n\/""#)).unwrap();
    assert_eq!(curve.name(), Some("\u{1f600}\n/"));
    assert!(same(&curve.control_points()[1][0], &q(150, 1)) && same(&curve.control_points()[1][1], &q(0, 1)));
    let spelled = Curve::from_json_str(&file(r#""\u0031\u002f3""#, r#""""#)).unwrap();
    assert!(same(&spelled.control_points()[1][1], &q(1, 3)));
    for (value, found) in [("true", "a boolean"), ("null", "null"), ("{}", "an object"), ("[1]", "an array")] {
        let error = Curve::from_json_str(&file(value, "0")).unwrap_err();
        assert!(error.message.contains(found), "{error}");
        assert_eq!((error.kind, error.offset), (ErrorKind::WrongType, file("@", "").find('@')));
    }
    let error = Curve::from_json_str(&file("1", "12")).unwrap_err();
    assert!(error.message.contains("found a number"), "{error}");
}

#[test]
fn json_syntax_errors_name_the_byte() {
    for (text, offset) in [
        ("", 0),
        ("  ", 2),
        ("\u{feff}{}", 0),
        ("1 2", 2),
        ("[1,]", 3),
        ("[1 2]", 3),
        ("[,1]", 1),
        ("{\"a\" 1}", 5),
        ("{\"a\":1,}", 7),
        ("{a:1}", 1),
        ("+1", 0),
        (".5", 0),
        ("1.", 1),
        ("1.e5", 2),
        ("1e", 1),
        ("-", 0),
        ("01", 1),
        ("-01", 2),
        ("NaN", 0),
        ("Infinity", 0),
        ("nul", 3),
        ("True", 0),
        ("\"a", 2),
        ("\"a\nb\"", 2),
        ("\"\\x\"", 2),
        ("\"\\", 2),
        ("\"\\u12", 5),
        ("\"\\u12é3\"", 5),
        ("\"\\u+123\"", 6),
        ("[1] // no", 4),
        ("é", 0),
    ] {
        assert_eq!(json_error(text.as_bytes()), (ErrorKind::Syntax, offset), "{text:?}");
    }
    // half a surrogate pair, in a text that is read
    for half in ["ud800", "ude00", "ud800\\u0041", "ud800\\n", "ud800\\u"] {
        for file in [format!("{{\"name\": \"\\{half}\"}}"), format!("{{\"x-\\{half}\": 1}}")] {
            let file = file.replacen('{', r#"{"degree": 1, "control_points": [[0, 0], [1, 1]], "#, 1);
            let (kind, offset) = json_error(file.as_bytes());
            let start = file.find('\\').unwrap();
            assert!(kind == ErrorKind::Syntax && (start..start + 16).contains(&offset), "{file} {offset}");
        }
    }
    assert_eq!(json_error(b"[\"ab\xff\"]"), (ErrorKind::Syntax, 4));
    assert_eq!(json_error(b"\xff\xfe[\0"), (ErrorKind::Syntax, 0));
}

#[test]
fn json_limits_hold() {
    // no depth overflows the stack
    for open in ["[", "{\"a\":", "{\"x-a\":[[{\"b\":"] {
        assert_eq!(json_error(open.repeat((10 << 20) / open.len()).as_bytes()).0, ErrorKind::Syntax);
    }
    let nested = "[".repeat(5 << 20) + &"]".repeat(5 << 20);
    let file = format!(r#"{{"degree": 1, "control_points": [[0, 0], [1, 1]], "x-deep": {nested}}}"#);
    assert!(Curve::from_json_str(&file).is_ok());
    assert_eq!(Curve::from_json_str(&nested).unwrap_err().kind, ErrorKind::WrongType);
    let error = Curve::from_json_slice(&vec![b' '; MAX_BYTES + 1]).unwrap_err();
    assert!(error.kind == ErrorKind::Limit && error.message.contains("MAX_BYTES"));
}

#[test]
fn json_refuses_duplicate_keys() {
    let error = Curve::from_json_str(r#"{"x-b": 1, "x-a": {"c": 1}, "x-\u0062": 2, "x-b": 3}"#).unwrap_err();
    assert_eq!((error.offset, place(error.clone())), (Some(28), at(ErrorKind::DuplicateKey, "x-b", None)));
    let mut many: String = (0..200_000).map(|i| format!("\"x-{i}\":0,")).collect();
    many = format!("{{{many}\"x-7\":0}}");
    assert_eq!(Curve::from_json_str(&many).unwrap_err().key.as_deref(), Some("x-7"));
}

proptest! {
    #[test]
    fn quoted_texts_are_read_back(text in any::<String>()) {
        let points = vec![[q(0, 1), q(0, 1), q(0, 1)], [q(1, 1), q(0, 1), q(0, 1)]];
        let curve = Curve::new(1, points, None, None).unwrap().with_name(text.clone());
        let again = Curve::from_json_str(&curve.to_json()).unwrap();
        prop_assert_eq!(again.name(), Some(text.as_str()));
    }

    #[test]
    fn any_bytes_are_refused_or_read(bytes in prop::collection::vec(any::<u8>(), 0..60), text in "[\\[\\]{},:\"\\\\u0d8e.x -]{0,40}") {
        let _ = Curve::from_json_slice(&bytes);
        let _ = Curve::from_json_str(&text);
        let _ = Curve::from_json_str(&format!("{{\"name\": {text}"));
    }
}

// Curves.

#[test]
fn example_files_are_read_and_written_back() {
    let files = example_files();
    assert_eq!(files.len(), 12);
    for (path, text) in files {
        let curve = Curve::from_json_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(curve.name().is_some() && curve.source().is_some());
        let again = Curve::from_json_str(&curve.to_json()).unwrap();
        assert_same_curve(&curve, &again);
        assert_eq!(curve.digest(), again.digest());
    }
}

#[test]
fn keys_of_a_file_are_checked() {
    let file = |extra: &str| format!(r#"{{"degree": 1, "control_points": [[0, 0], [1, 1]], {extra}}}"#);
    let with = |extra: &str| refused(&file(extra));
    assert!(Curve::from_json_str(&file(r#""schema": 1.0, "x-any": [null, {"degree": 7}], "name": "n""#)).is_ok());
    assert_eq!(with(r#"@"weight": 1"#), at(ErrorKind::UnknownKey, "weight", None));
    assert_eq!(with(r#"@"degree": 1"#), at(ErrorKind::DuplicateKey, "degree", None));
    assert_eq!(with(r#""schema": @2"#), at(ErrorKind::Schema, "schema", None));
    assert_eq!(with(r#""name": @null"#), at(ErrorKind::WrongType, "name", None));
    assert_eq!(with(r#""unit": @1"#), at(ErrorKind::WrongType, "unit", None));
    assert_eq!(with(r#""knots": @{}"#), at(ErrorKind::WrongType, "knots", None));
    assert_eq!(with(r#""weights": [1, @true]"#), at(ErrorKind::WrongType, "weights", 1));
    assert_eq!(with(r#""weights": [1, @"x"]"#), at(ErrorKind::Number, "weights", 1));
    assert_eq!(with(r#""weights": [@1e9999, 1]"#), at(ErrorKind::Limit, "weights", 0));
    assert_eq!(refused(r#"{"degree": 1}"#), at(ErrorKind::MissingKey, "control_points", None));
    assert_eq!(refused(r#"{"control_points": []}"#), at(ErrorKind::MissingKey, "degree", None));
    assert_eq!(refused("@[]"), (ErrorKind::WrongType, None, None));
}

#[test]
fn degrees_are_checked() {
    let with = |degree: &str| refused(&format!(r#"{{"degree": {degree}, "control_points": [[0, 0], [1, 1]]}}"#));
    assert_eq!(with("0"), at(ErrorKind::Limit, "degree", None));
    assert_eq!(with("65"), at(ErrorKind::Limit, "degree", None));
    assert_eq!(with("1e5000"), at(ErrorKind::Limit, "degree", None));
    assert_eq!(with("@-1"), at(ErrorKind::Number, "degree", None));
    assert_eq!(with("@1.5"), at(ErrorKind::Number, "degree", None));
    assert_eq!(with("@[1]"), at(ErrorKind::WrongType, "degree", None));
    assert_eq!(with("2"), at(ErrorKind::WrongLength, "control_points", None));
}

#[test]
fn points_name_their_index() {
    const KEY: &str = "control_points";
    let with = |points: &str| refused(&format!(r#"{{"degree": 2, "control_points": {points}}}"#));
    assert_eq!(with("[[0, 0], [1, 1], @[2, 2, 2]]"), at(ErrorKind::WrongLength, KEY, 2));
    assert_eq!(with("[@[0], [1], [2]]"), at(ErrorKind::WrongLength, KEY, 0));
    assert_eq!(with("[[0, 0], @[1, 1, 1, 1], [2, 2]]"), at(ErrorKind::WrongLength, KEY, 1));
    assert_eq!(with("[[0, 0], @1, [2, 2]]"), at(ErrorKind::WrongType, KEY, 1));
    assert_eq!(with(r#"[[0, 0], [1, @"1/0"], [2, 2]]"#), at(ErrorKind::Number, KEY, 1));
    assert_eq!(with("[[0, 0], [1, 1]]"), at(ErrorKind::WrongLength, KEY, None));
    assert_eq!(with("[[0, 0], [1, 1], [2, 2], [3, 3]]"), at(ErrorKind::WrongLength, KEY, None));
    assert_eq!(with("@7"), at(ErrorKind::WrongType, KEY, None));
    assert_eq!(with(&format!("[0{}]", ",0".repeat(MAX_CONTROL_POINTS))), at(ErrorKind::Limit, KEY, None));
}

#[test]
fn weights_and_knots_are_checked() {
    let file = |extra: &str| {
        format!(r#"{{"degree": 2, "control_points": [[0, 0], [1, 1], [2, 0], [3, 3], [4, 0]], {extra}}}"#)
    };
    let with = |extra: &str| refused(&file(extra));
    for good in [
        r#""knots": [0, 0, 0, 1, 1, 2, 2, 2], "weights": [1, 0, -1, 1, 1]"#,
        r#""knots": [0, 1, 2, 3, 4, 5, 6, 7]"#,
        r#""knots": [0, 0, 0, 0, 1, 2, 2, 2]"#,
    ] {
        assert!(Curve::from_json_str(&file(good)).is_ok(), "{good}");
    }
    assert_eq!(with(r#""knots": [0, 0, 0, 1, 1, 2, 2]"#), at(ErrorKind::WrongLength, "knots", None));
    assert_eq!(with(r#""knots": [0, 0, 0, 2, 1, 2, 2, 0]"#), at(ErrorKind::KnotOrder, "knots", 4));
    assert_eq!(with(r#""knots": [0, 0, "1/3", "2/6", 3e0, 2, 1, 0]"#), at(ErrorKind::KnotOrder, "knots", 5));
    assert_eq!(with(r#""knots": [0, 0, 0, 0, 0, 0, 1, 2]"#), at(ErrorKind::EmptyDomain, "knots", 2));
    let short = r#""knots": [0, 0, 0, 1, 1, 2, 2, 2], "weights": [1, 1]"#;
    assert_eq!(with(short), at(ErrorKind::WrongLength, "weights", None));
}

#[test]
fn a_knot_inside_stands_at_most_degree_times() {
    let points = |n: i64| (0..n).map(|i| [q(i, 1), q(i * i, 1), q(0, 1)]).collect::<Vec<_>>();
    let knots = |list: &[i64]| Some(list.iter().map(|k| q(*k, 3)).collect());
    let error = Curve::new(2, points(6), None, knots(&[0, 0, 0, 1, 1, 1, 2, 2, 2])).unwrap_err();
    assert_eq!(place(error), at(ErrorKind::KnotMultiplicity, "knots", 5));
    assert!(Curve::new(2, points(6), None, knots(&[0, 0, 0, 1, 1, 2, 3, 3, 3])).is_ok());
    assert!(Curve::new(2, points(6), None, knots(&[0, 0, 0, 0, 1, 3, 3, 3, 3])).is_ok());
}

#[test]
fn numbers_of_a_caller_are_tidied_or_refused() {
    let ends = |x: Rational| vec![[q(0, 1), q(0, 1), q(0, 1)], [q(1, 1), x, q(0, 1)]];
    let raw = |p: i64, q: i64| Rational::new_raw(p.into(), q.into());
    let curve = Curve::new(1, ends(raw(2, -4)), None, None).unwrap();
    assert!(same(&curve.control_points()[1][1], &q(-1, 2)));
    let with = |x| place(Curve::new(1, ends(x), None, None).unwrap_err());
    assert_eq!(with(raw(1, 0)), at(ErrorKind::Number, "control_points", 1));
    let limit = at(ErrorKind::Limit, "control_points", 1);
    assert_eq!(with(ten_to(3000) / (ten_to(3000) - q(1, 1))), limit);
    assert_eq!(with(ten_to(7000)), limit);
    assert_eq!(with(ten_to(-7001)), limit);
    assert_eq!(with(Rational::from_integer(BigInt::from(1) << 1_000_000)), limit);
    for x in [ten_to(6999), ten_to(-7000), q(1, 3) * ten_to(900), q(1, 1) / Rational::from_integer(2.into()).pow(6000)]
    {
        let curve = Curve::new(1, ends(x), None, None).unwrap();
        assert_same_curve(&curve, &Curve::from_json_str(&curve.to_json()).unwrap());
    }
}

#[test]
fn digest_is_of_the_documented_text_and_of_the_curve_alone() {
    let short = Curve::from_json_str(r#"{"degree": 1, "control_points": [[0.5, 0], [1, -2]], "name": "a"}"#).unwrap();
    let long = r#"{"degree": 1, "control_points": [["1/2", 0, 0], [1e0, "-4/2", 0]], "weights": [1, 1], "knots": [0, 0, 1, 1]}"#;
    let long = Curve::from_json_str(long).unwrap();
    assert_eq!(
        short.canonical_text(),
        "tubecert-curve 1\ndegree 1\nknot 0\nknot 0\nknot 1\nknot 1\npoint 1/2 0 0\nweight 1\npoint 1 -2 0\nweight 1\n"
    );
    // printf of the text above, piped to sha256sum.
    assert_eq!(short.digest(), "58f2ec15cb9da5ecb8fb46f042cffea6ac70070db1bd47c14b760e8bd2a42919");
    assert_eq!(short.digest(), long.with_name("b").with_unit("mm").digest());
    assert!(short.is_planar_in_file());
    let other =
        Curve::from_json_str(r#"{"degree": 1, "control_points": [[0.5, 0], [1, -2]], "weights": [1, 2]}"#).unwrap();
    assert_ne!(short.digest(), other.digest());
}

fn any_curve() -> impl Strategy<Value = Curve> {
    (1_usize..5, 0_usize..6).prop_flat_map(|(degree, more)| {
        let points = degree + 1 + more;
        let coordinates = prop::array::uniform3(any_rational());
        (
            prop::collection::vec(coordinates, points),
            prop::option::of(prop::collection::vec(any_rational(), points)),
            prop::collection::vec(0_i64..1000, points + degree + 1),
            any::<(Option<String>, Option<String>)>(),
        )
            .prop_filter_map("valid knots", move |(points, weights, mut knots, (name, unit))| {
                knots.sort_unstable();
                let knots = knots.into_iter().map(|k| q(k, 7)).collect();
                let curve = Curve::new(degree, points, weights, Some(knots)).ok()?;
                let curve = name.into_iter().fold(curve, |curve, name| curve.with_name(name.clone()).with_source(name));
                Some(unit.into_iter().fold(curve, Curve::with_unit))
            })
    })
}

proptest! {
    #[test]
    fn curves_are_written_and_read_back(curve in any_curve()) {
        let again = Curve::from_json_slice(curve.to_json().as_bytes()).unwrap();
        assert_same_curve(&curve, &again);
        prop_assert_eq!(curve.digest(), again.digest());
    }

    #[test]
    fn mutated_files_are_refused_or_read(
        file in 0_usize..12,
        cuts in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>(), 0_u8..5), 1..5),
    ) {
        let mut bytes = example_files()[file].1.clone().into_bytes();
        for (at, other, byte, how) in cuts {
            let (i, j) = (at.index(bytes.len()), other.index(bytes.len()));
            match how {
                0 => bytes[i] = byte,
                1 => bytes.insert(i, b"0123456789-.eE/[]{},:\"\\ "[usize::from(byte) % 24]),
                2 => drop(bytes.remove(i)),
                3 => bytes.swap(i, j),
                _ => bytes.truncate(i.max(1)),
            }
            if bytes.is_empty() {
                break;
            }
        }
        if let Ok(curve) = Curve::from_json_slice(&bytes) {
            assert_same_curve(&curve, &Curve::from_json_str(&curve.to_json()).unwrap());
        }
    }
}
