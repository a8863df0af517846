//! The program as a user or a script sees it: exact output, exit codes, errors, broken pipes.
//!
//! `UPDATE_SNAPSHOTS=1 cargo test --test cli` rewrites tests/snapshots; read the difference before committing it.
#![cfg(all(feature = "cli", feature = "search"))]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Value, json};
use tubecert::number::{Rational, compare, parse_rational, rational_from_f64};
use tubecert::{Enclosure, Radius, RadiusOptions, Spine};

#[path = "shapes/mod.rs"]
mod shapes;

#[path = "program/mod.rs"]
mod program;
use program::{code, fed, tubecert};

fn run(words: &[&str]) -> Output {
    tubecert(words).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// What stands on stdout; nothing may stand on stderr.
fn answer(output: &Output, expected: i32) -> &str {
    assert_eq!((text(&output.stderr), code(output)), ("", expected));
    text(&output.stdout)
}

fn curves() -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/curves"))
        .unwrap()
        .map(|entry| format!("tests/curves/{}", entry.unwrap().file_name().into_string().unwrap()))
        .collect();
    names.sort();
    assert!(names.len() >= 12);
    names
}

fn matches_snapshot(name: &str, found: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(name);
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, found).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}; run with UPDATE_SNAPSHOTS=1"));
    assert_eq!(found, kept, "{name}; if the change is meant, run with UPDATE_SNAPSHOTS=1");
}

fn library(file: &str, options: &RadiusOptions) -> (Spine, Radius) {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let spine = Spine::from_json_str(&text).unwrap();
    let answer = tubecert::radius(&spine, options).unwrap();
    (spine, answer)
}

fn exact(x: f64) -> Rational {
    rational_from_f64(x).unwrap()
}

#[test]
fn answers_are_the_snapshots() {
    for file in curves() {
        let stem = Path::new(&file).file_stem().unwrap().to_str().unwrap();
        for (flags, name) in [
            (&[][..], format!("{stem}.txt")),
            (&["--json"], format!("{stem}.json")),
            (&["--all-terms"], format!("{stem}.all.txt")),
            (&["--all-terms", "--json"], format!("{stem}.all.json")),
        ] {
            let words = [&["radius", &file], flags].concat();
            matches_snapshot(&name, answer(&run(&words), 0));
        }
    }
}

/// An enclosure as it is spelled.
#[derive(Deserialize)]
struct Spelled {
    lo: Box<RawValue>,
    hi: Box<RawValue>,
}

/// Both readings of the printed pair, the decimal and its nearest f64, enclose `e`.
fn assert_encloses(place: &str, line: &str, e: Enclosure) {
    let spelled: Spelled = serde_json::from_str(&raw_at(line, place)).unwrap();
    for (raw, key, bound, below) in [(&spelled.lo, "lo", e.lo, true), (&spelled.hi, "hi", e.hi, false)] {
        if bound == f64::INFINITY {
            assert_eq!(raw.get(), "null", "{place} of {line}");
            continue;
        }
        // not the f64 of serde_json, which without its feature float_roundtrip is not always the nearest
        let (decimal, nearest) = (parse_rational(raw.get()).unwrap(), exact(raw.get().parse().unwrap()));
        for read in [decimal, nearest] {
            let outward =
                if below { compare(&read, &exact(bound)).is_le() } else { compare(&read, &exact(bound)).is_ge() };
            assert!(outward, "{place}/{key} of {line} against {bound:e}");
        }
    }
}

/// The text of the value at a JSON pointer, as it is spelled.
fn raw_at(line: &str, pointer: &str) -> String {
    let mut raw = line.to_string();
    for key in pointer.split('/').skip(1) {
        raw = match key.parse::<usize>() {
            Ok(index) => serde_json::from_str::<Vec<Box<RawValue>>>(&raw).unwrap()[index].get().to_string(),
            Err(_) => {
                let members: std::collections::HashMap<String, Box<RawValue>> = serde_json::from_str(&raw).unwrap();
                members[key].get().to_string()
            }
        };
    }
    raw
}

fn assert_json_says(line: &str, spine: &Spine, answer: &Radius) {
    assert!(line.ends_with('\n') && line.lines().count() == 1);
    let value: Value = serde_json::from_str(line).unwrap();
    let mut enclosures = vec![
        ("/delta", answer.delta),
        ("/terms/curvature", answer.terms.curvature),
        ("/terms/body_to_body", answer.terms.body_to_body),
        ("/terms/end_to_body", answer.terms.end_to_body),
        ("/terms/end_to_end", answer.terms.end_to_end),
    ];
    if let Some(at) = &answer.at {
        enclosures.push(("/at/t", at.t));
        enclosures.extend(at.s.map(|s| ("/at/s", s)));
        enclosures.extend(at.x.iter().flatten().zip(["/at/x/0", "/at/x/1", "/at/x/2"]).map(|(x, place)| (place, *x)));
    }
    if let Some(rim) = answer.rim {
        enclosures.extend([
            ("/rim/end_to_body", rim.end_to_body),
            ("/rim/end_to_end", rim.end_to_end),
            ("/rim/delta", rim.delta),
        ]);
    }
    let printed = line.matches("\"lo\":").count();
    assert_eq!(printed, enclosures.len(), "every enclosure is compared: {line}");
    for (place, e) in enclosures {
        assert_encloses(place, line, e);
    }
    assert_eq!(value["limited_by"], answer.limited_by.word());
    assert_eq!(value["closed"], answer.closed);
    assert_eq!(value["at"].is_null(), answer.at.is_none());
    assert_eq!(value["curve"]["digest"], spine.curve().digest());
    assert_eq!(value["tubecert"], env!("CARGO_PKG_VERSION"));
}

/// `delta = LO .. HI` of the human text encloses, and is at most a few per cent wider.
fn assert_text_says(text: &str, delta: Enclosure) {
    let line = text.lines().next().unwrap().strip_suffix("        (file units)").unwrap();
    let bounds = match line.strip_prefix("delta = ") {
        Some("infinity") => return assert_eq!(delta, Enclosure::INFINITE),
        Some(bounds) => bounds,
        None => panic!("{line}"),
    };
    let (lo, hi) = bounds.split_once(" .. ").unwrap_or((bounds, bounds));
    let (lo, hi) = (parse_rational(lo).unwrap(), parse_rational(hi).unwrap());
    assert!(compare(&lo, &exact(delta.lo)).is_le() && compare(&hi, &exact(delta.hi)).is_ge(), "{text}");
    let allowed = exact(1.1) * (exact(delta.hi) - exact(delta.lo));
    assert!(compare(&(hi - lo), &allowed).is_le(), "{text}");
}

#[test]
fn everything_printed_is_true_read_either_way() {
    for file in curves() {
        let options = RadiusOptions::new;
        for (flags, options) in [
            (&["--max-cells", "1"][..], options().max_cells(1)),
            (&["--max-cells", "300"], options().max_cells(300)),
            (&["--rel-width", "0.01"], options().rel_width(0.01)),
            (&["--all-terms"], options().all_terms(true)),
            (&[], options()),
        ] {
            let (spine, expected) = library(&file, &options);
            let exit = if expected.complete { 0 } else { 3 };
            let words = [&["radius", &file], flags].concat();
            assert_json_says(answer(&run(&[&words[..], &["--json"]].concat()), exit), &spine, &expected);
            let human = run(&words);
            if expected.delta.hi.is_finite() || expected.complete {
                assert_text_says(answer(&human, exit), expected.delta);
            }
        }
    }
}

#[test]
fn the_keys_stand_in_the_order_of_the_contract() {
    let output = run(&["radius", "tests/curves/m98_5_2.json", "--json"]);
    let line = answer(&output, 0);
    let order = [
        "schema",
        "command",
        "tubecert",
        "curve",
        "name",
        "digest",
        "unit",
        "delta",
        "limited_by",
        "also",
        "closed",
        "at",
        "s",
        "t",
        "x",
        "end",
        "terms",
        "curvature",
        "body_to_body",
        "end_to_body",
        "end_to_end",
    ];
    let mut rest = line;
    for key in order {
        let quoted = format!("\"{key}\":");
        let (_, after) = rest.split_once(&quoted).unwrap_or_else(|| panic!("{key} out of order in {line}"));
        rest = after;
    }
}

#[test]
fn stopping_early_is_told_by_the_exit_code_and_stays_true() {
    let (_, narrow) = library("tests/curves/m98_5_2.json", &RadiusOptions::new());
    let stopped = run(&["radius", "tests/curves/m98_5_2.json", "--max-cells", "1", "--json"]);
    let value: Value = serde_json::from_str(answer(&stopped, 3)).unwrap();
    assert_eq!(value["limited_by"], "undecided");
    assert!(value["delta"]["lo"].as_f64().unwrap() <= narrow.delta.lo);
    assert!(value["delta"]["hi"].as_f64().is_none_or(|hi| hi >= narrow.delta.hi));
    let stopped = run(&["radius", "tests/curves/m98_5_2.json", "--max-cells", "1"]);
    assert!(answer(&stopped, 3).contains("raise --max-cells (now 1)"));
    // asked for less, the same work is enough
    let wide = run(&["radius", "tests/curves/m98_5_2.json", "--rel-width", "0.5"]);
    answer(&wide, 0);
    let late = run(&["radius", "tests/curves/circle_exact.json", "--budget", "1e-9"]);
    assert!(answer(&late, 3).contains("raise --budget"));
}

/// delta = 0 and its place, unit and escapes, from standard input.
#[test]
fn special_answers_read_well() {
    let corner = br#"{"degree": 1, "control_points": [[0, 0], [1, 0], [1, 1]], "knots": [0, 0, 1, 3, 3], "unit": "mm\u001b[31m"}"#;
    assert_eq!(
        answer(&fed(&["radius", "-"], corner), 0),
        "delta = 0        (mm?[31m)\nlimited by corner: the tangent jumps at t = 1\n\
         no positive radius is free of self-intersection\n"
    );
    let value: Value = serde_json::from_str(answer(&fed(&["radius", "-", "--json"], corner), 0)).unwrap();
    assert_eq!((&value["delta"]["hi"], &value["at"]["t"]["lo"]), (&0.into(), &1.into()));
    assert_eq!((&value["unit"], &value["at"]["s"]), (&"mm\u{1b}[31m".into(), &Value::Null));
    let drop = br#"{"degree": 3, "control_points": [[0, 0], [2, 1], [-2, 1], [0, 0]]}"#;
    assert!(
        answer(&fed(&["radius", "-"], drop), 0)
            .contains("limited by corner: the ends meet, at t = 0, without a common tangent")
    );
    let line = answer(&run(&["radius", "tests/curves/straight_line.json", "--json"]), 0).to_string();
    assert!(line.contains(r#""delta":{"lo":null,"hi":null},"limited_by":"none","also":[],"closed":false,"at":null"#));
}

/// What f64 does not reach: the places are left out, as -infinity has no spelling.
#[test]
fn huge_numbers_are_not_called_infinite() {
    let huge = br#"{"degree": 2, "control_points": [["-1e400", 0], [0, 0], [0, "1e400"]]}"#;
    let output = fed(&["radius", "-", "--json"], huge);
    let value: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert!(value["delta"]["lo"].is_number(), "{value}");
    let far = br#"{"degree": 2, "control_points": [[0, 0], [1, 2], [2, 0]], "knots": ["-1e400", "-1e400", "-1e400", "-1e399", "-1e399", "-1e399"]}"#;
    let output = fed(&["radius", "-", "--json"], far);
    let value: Value = serde_json::from_str(answer(&output, 0)).unwrap();
    assert_eq!(value["at"], Value::Null);
    assert!(answer(&fed(&["radius", "-"], far), 0).contains("at a place too far out to print"));
}

/// kind, key, index, offset of the JSON error, whose file is `-`.
fn refused(input: &[u8]) -> Value {
    let output = fed(&["radius", "-", "--json"], input);
    let value: Value = serde_json::from_str(answer(&output, 2)).unwrap();
    let error = &value["error"];
    assert_eq!((&value["schema"], &error["file"]), (&1.into(), &"-".into()));
    assert!(!error["message"].as_str().unwrap().is_empty());
    let human = fed(&["radius", "-"], input);
    assert_eq!((text(&human.stdout), code(&human)), ("", 2));
    let stderr = text(&human.stderr);
    assert!(stderr.starts_with(&format!("error: {}", error["message"].as_str().unwrap())), "{stderr}");
    assert!(stderr.contains("\n  at standard input"), "{stderr}");
    assert_eq!(stderr.contains("\nhelp: "), error["help"].is_string(), "{stderr}");
    json!([error["kind"], error["key"], error["index"], error["offset"]])
}

#[test]
fn bad_files_are_errors_with_their_place() {
    assert_eq!(refused(b""), json!(["syntax", null, null, 0]));
    assert_eq!(refused(b"{\"degree\": 1,}"), json!(["syntax", null, null, 13]));
    assert_eq!(refused(b"{} \xff"), json!(["syntax", null, null, 3]));
    assert_eq!(refused(b"{\"degree\": NaN}"), json!(["syntax", null, null, 11]));
    assert_eq!(refused(b"{\"degre\": 1}"), json!(["unknown_key", "degre", null, 1]));
    let knots = br#"{"degree": 1, "control_points": [[0, 0], [1, 0]], "knots": [0, 1, 0, 1]}"#;
    assert_eq!(refused(knots), json!(["knot_order", "knots", 2, null]));
    let doubled = br#"{"degree": 2, "control_points": [[0, 0], [0, 0], [1, 0]]}"#;
    assert_eq!(refused(doubled), json!(["irregular", "control_points", 1, null]));
    let deep = vec![b'['; 10_000_000];
    assert_eq!(refused(&deep), json!(["syntax", null, null, 10_000_000]));
}

#[test]
fn unreadable_files_are_errors() {
    for (file, words) in [("tests/no_such_file.json", "No such file"), ("tests", "directory")] {
        let output = run(&["radius", file]);
        assert_eq!((text(&output.stdout), code(&output)), ("", 2));
        let stderr = text(&output.stderr);
        assert!(stderr.contains(words) && stderr.contains(file) && stderr.contains("\nhelp: "), "{stderr}");
        let output = run(&["radius", "--json", file]);
        let value: Value = serde_json::from_str(answer(&output, 2)).unwrap();
        assert_eq!((&value["error"]["kind"], &value["error"]["file"]), (&"io".into(), &file.into()));
    }
}

/// A file above the limit is refused by its length, before memory is taken; a stream is read to the limit and no
/// further. Tested with only so many KiB of memory.
#[cfg(target_os = "linux")]
#[test]
fn the_limit_of_bytes_holds_before_memory_is_taken() {
    let long = std::env::temp_dir().join(format!("tubecert-{}.json", std::process::id()));
    fs::File::create(&long).unwrap().set_len((256 << 20) + 1).unwrap();
    for (kib, file) in [("150000", long.to_str().unwrap()), ("900000", "-"), ("900000", "/dev/zero")] {
        let mut limited = Command::new("sh");
        limited.args([
            "-c",
            "ulimit -v $1 && exec \"$0\" radius --json \"$2\"",
            env!("CARGO_BIN_EXE_tubecert"),
            kib,
            file,
        ]);
        let output = limited.stdin(fs::File::open("/dev/zero").unwrap()).output().unwrap();
        let value: Value = serde_json::from_str(answer(&output, 2)).unwrap();
        assert_eq!(value["error"]["kind"], "limit", "{value}");
        assert!(value["error"]["message"].as_str().unwrap().contains("268435456"));
    }
    fs::remove_file(&long).unwrap();
}

#[test]
fn wrong_usage_is_an_error() {
    let curve = "tests/curves/m98_5_1_parabola.json";
    for words in [
        &["radius", curve, "--rel-width", "0"][..],
        &["radius", curve, "--rel-width", "nan"],
        &["radius", curve, "--rel-width", "inf"],
        &["radius", curve, "--rel-width", "-1"],
        &["radius", curve, "--rel-width", "1"],
        &["radius", curve, "--rel-width"],
        &["radius", curve, "--max-cells", "-1"],
        &["radius", curve, "--max-cells", "1.5"],
        &["radius", curve, "--budget", "-1"],
        &["radius", curve, "--budget", "0"],
        &["radius", curve, "--budget", "inf"],
        &["radius", curve, "--threads", "0"],
        &["radius", curve, "--threads", "1025"],
        &["radius", curve, "--certificate"],
        &["radius", curve, curve],
        &["radius"],
        &["polyline", curve],
        &["squares", curve, "--limit", "-1"],
        &["verify", curve],
        &["verify", curve, curve, curve],
        &["completions", "clay-tablet"],
        &[],
    ] {
        let output = run(words);
        assert_eq!((text(&output.stdout), code(&output)), ("", 2), "{words:?}");
        assert!(text(&output.stderr).contains("Usage:") || text(&output.stderr).contains("--help"), "{words:?}");
        let output = run(&[&["--json"], words].concat());
        let value: Value = serde_json::from_str(answer(&output, 2)).unwrap();
        let error = &value["error"];
        assert_eq!((&value["schema"], &error["kind"], &error["file"]), (&1.into(), &"usage".into(), &Value::Null));
        assert!(!error["message"].as_str().unwrap().contains('\n') && error["help"].is_string());
    }
    let output = run(&["radius", curve, "--json", "--rel-width", "0"]);
    let value: Value = serde_json::from_str(answer(&output, 2)).unwrap();
    assert_eq!(value["error"]["key"], "--rel-width");
    // behind -- it is a file name
    assert_eq!(text(&run(&["radius", "--threads", "--", "--json"]).stdout), "");
}

#[test]
fn help_names_what_works_and_nothing_else() {
    let help = [
        &["--help"][..],
        &["radius", "--help"],
        &["squares", "--help"],
        &["check", "--help"],
        &["batch", "--help"],
        &["verify", "--help"],
        &["help"],
    ]
    .map(|words| answer(&run(words), 0).to_string())
    .concat();
    for word in [
        "radius",
        "curvature",
        "pairs",
        "squares",
        "batch",
        "verify",
        "completions",
        "--task",
        "--shard",
        "--threads",
        "--resume",
        "--output",
        "--limit",
        "--tolerance",
        "--polyline",
        "--answer",
        "--json",
        "--rel-width",
        "--all-terms",
        "--max-cells",
        "--budget",
        "--certificate",
        "--version",
    ] {
        assert!(help.contains(word), "{word}");
    }
    for word in ["surface", "report"] {
        let named = help.split(|c: char| !(c.is_alphanumeric() || c == '-')).any(|found| found == word);
        assert!(!named, "{word} does not work yet");
    }
    assert_eq!(answer(&run(&["--version"]), 0), concat!("tubecert ", env!("CARGO_PKG_VERSION"), "\n"));
}

const CURVE: &str = "tests/curves/m98_5_1_parabola.json";
const CERTIFICATE: &str = "tests/certificates/accept/m98_5_1_parabola__naive.txt";

fn verdict(output: &Output, expected: i32) -> Value {
    let line = answer(output, expected);
    assert!(line.starts_with(r#"{"schema":1,"command":"verify","tubecert":""#) && line.lines().count() == 1, "{line}");
    serde_json::from_str(line).unwrap()
}

#[test]
fn a_certificate_is_verified() {
    assert_eq!(
        answer(&run(&["verify", CURVE, CERTIFICATE]), 0),
        "verified: delta = 0.4999 .. 0.5        (file units)\n\
         on this open spine every radius below 0.4999 is free of self-intersection; no radius above 0.5 is\n\
         evidence: 7 cone, 2 curved, 2 local, 2 share, 7 side, 2 slab, all of it evaluated in integers\n"
    );
    let value = verdict(&run(&["verify", CURVE, CERTIFICATE, "--json"]), 0);
    let digest = Spine::from_json_str(&fs::read_to_string(CURVE).unwrap()).unwrap().curve().digest();
    let claim = json!({"kind": "radius", "curve_digest": digest, "lo": 0.4999, "hi": 0.5});
    assert_eq!(
        (&value["verdict"], &value["claim"], &value["reason"], &value["curve"]["digest"]),
        (&"verified".into(), &claim, &Value::Null, &digest.clone().into())
    );
    let curve = fs::read(CURVE).unwrap();
    assert_eq!(verdict(&fed(&["verify", "-", CERTIFICATE, "--json"], &curve), 0), value);
}

#[test]
fn a_claim_is_verified_as_it_is_printed() {
    let printed = answer(&run(&["radius", CURVE, "--json"]), 0).to_string();
    let with = |answer: &str, words: &[&str]| {
        fed(&[&["verify", CURVE, CERTIFICATE, "--answer", "-"], words].concat(), answer.as_bytes())
    };
    // the certificate proves less than was answered
    let value = verdict(&with(&printed, &["--json"]), 1);
    assert_eq!((&value["verdict"], &value["claim"]["hi"]), (&"rejected".into(), &0.5.into()));
    assert!(value["reason"].as_str().unwrap().starts_with("lo: the claim is more"), "{value}");
    assert!(answer(&with(&printed, &[]), 1).starts_with("rejected: delta = "));
    // what it does prove
    let mut claim: Value = serde_json::from_str(&printed).unwrap();
    for (lo, hi, expected) in [
        ("0.4999", "0.5", 0),
        ("0", "null", 0),
        ("0.49990000000000000000000000001", "0.5", 1),
        ("null", "null", 1),
        ("0.4", "0.49999999999999999999999999999", 1),
        ("0.4", "5e-1", 0),
    ] {
        let delta = format!(r#""delta":{{"lo":{lo},"hi":{hi}}},"#);
        claim.as_object_mut().unwrap().remove("delta");
        let text = claim.to_string().replacen('{', &format!("{{{delta}"), 1);
        verdict(&with(&text, &["--json"]), expected);
    }
    // what makes no claim about this curve
    for (text, key) in [
        (printed.replace("\"radius\"", "\"diameter\""), json!("command")),
        (printed.replace("\"radius\"", "\"curvature\""), json!("kappa_max.lo")),
        (printed.replace("\"digest\":\"", "\"digest\":\"0"), json!("curve.digest")),
        (printed.replace("\"delta\"", "\"gamma\""), json!("delta.lo")),
        ("{".to_string(), Value::Null),
        ("[]".to_string(), json!("command")),
        (printed.replace("\"schema\":1", "\"schema\":2"), json!("schema")),
        (printed.replacen('{', "{\"\\u0063ommand\":\"radius\",", 1), json!("command")),
        (printed.replace("\"lo\":", "\"hi\":0,\"lo\":"), json!("delta.lo")),
        (printed.replace("\"delta\":{\"lo\":", "\"delta\":{\"lo\":\"1\",\"low\":"), json!("delta.lo")),
    ] {
        let value: Value = serde_json::from_str(answer(&with(&text, &["--json"]), 2)).unwrap();
        assert_eq!((&value["error"]["key"], &value["error"]["file"]), (&key, &"-".into()), "{value}");
    }
}

#[test]
fn verifying_ends_with_its_budget() {
    // thousands of times longer than the budget
    let (curve, certificate) = ("tests/curves/circle_exact.json", "tests/certificates/accept/circle_exact__1e-3.txt");
    let words = ["verify", curve, certificate, "--budget", "1e-9"];
    let said = run(&[&words[..], &["--json"]].concat());
    let value: Value = serde_json::from_str(answer(&said, 3)).unwrap();
    assert_eq!(value["verdict"], "undecided");
    assert!(answer(&run(&words), 3).starts_with("undecided: delta = "));
    assert!(answer(&run(&["verify", CURVE, CERTIFICATE, "--budget", "1e6"]), 0).starts_with("verified: delta = "));
}

#[test]
fn an_answer_verifies_with_its_own_certificate() {
    let certificate = std::env::temp_dir().join(format!("tubecert-own-{}.txt", std::process::id()));
    let path = certificate.to_str().unwrap();
    for name in ["m98_5_1_parabola", "m98_5_2", "m98_5_3", "straight_line", "trefoil"] {
        let curve = format!("tests/curves/{name}.json");
        let plain = answer(&run(&["radius", &curve, "--json"]), 0).to_string();
        let printed = answer(&run(&["radius", &curve, "--json", "--certificate", path]), 0).to_string();
        assert_eq!(printed, plain, "the certificate changes nothing in the answer");
        let check = |answer: &str| fed(&["verify", &curve, path, "--answer", "-", "--json"], answer.as_bytes());
        verdict(&check(&printed), 0);
        // one f64 inside
        for (key, step) in [("\"lo\":", f64::next_up as fn(f64) -> f64), ("\"hi\":", f64::next_down)] {
            let bound = printed.split(key).nth(1).unwrap().split([',', '}']).next().unwrap();
            let Ok(value) = bound.parse::<f64>() else { continue };
            let (old, new) = (format!("{key}{bound}"), format!("{key}{}", step(value)));
            verdict(&check(&printed.replacen(&old, &new, 1)), 1);
        }
    }
    fs::remove_file(&certificate).unwrap();
}

#[test]
fn nothing_is_claimed_if_the_certificate_cannot_be_written() {
    let output = run(&["radius", CURVE, "--json", "--certificate", "tests"]);
    let value: Value = serde_json::from_str(answer(&output, 4)).unwrap();
    assert_eq!((&value["error"]["kind"], &value["error"]["file"]), (&"certificate".into(), &"tests".into()));
}

#[test]
fn a_certificate_that_is_none_is_unusable() {
    let (text, curve) = (fs::read_to_string(CERTIFICATE).unwrap(), "tests/curves/m98_5_2.json");
    let value = verdict(&run(&["verify", curve, CERTIFICATE, "--json"]), 1);
    assert_eq!(value["reason"], "curve: the certificate is for another curve");
    let with = |text: &str| fed(&["verify", CURVE, "-", "--json"], text.as_bytes());
    verdict(&with(&text), 0);
    verdict(&with(&text.replace("hi 1/2", "hi 499/1000")), 1);
    verdict(&with(&text.replace("local", "share 0")), 1);
    for wrong in [
        "",
        "tubecert-certificate 1 radius",
        &text.replace("1 radius", "2 radius"),
        &text.replace("hi 1/2", "hi 2/4"),
        &text.replace("hi 1/2", "hi -1/2"),
        &text.replace("hi 1/2", "hi 1/0"),
        &text.replace("curved\n", "curved \n"),
        &text.replace("curved\n", "curved\r\n"),
        &text.replace("cone", "kone"),
        &text.replace("end\n", "end"),
        &(text.clone() + "\n"),
        &text.replacen("curve ", "curve A", 1),
        &text.replace("hi 1/2", &format!("hi {}", "9".repeat(20_001))),
    ] {
        let value: Value = serde_json::from_str(answer(&with(wrong), 2)).unwrap();
        let kind = value["error"]["kind"].as_str().unwrap();
        assert!(kind == "certificate" || (kind == "limit" && wrong.len() > 20_000), "{value} {wrong}");
    }
    for words in [["verify", "nope", CERTIFICATE], ["verify", CURVE, "nope"]] {
        assert_eq!((code(&run(&words)), run(&words).stdout), (2, vec![]));
    }
    assert_eq!(code(&run(&["verify", CURVE, CERTIFICATE, "--answer", "nope"])), 2);
    #[cfg(target_os = "linux")]
    {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        assert_eq!(code(&tubecert(&["verify", CURVE, CERTIFICATE]).stdout(full).output().unwrap()), 4);
    }
}

#[test]
fn completions_are_printed() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = run(&["completions", shell]);
        assert!(answer(&script, 0).contains("rel-width"), "{shell}");
    }
}

/// Enough spans for the work to be shared.
#[test]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let long = shapes::torus_knot(2, 3, 600).to_json();
    for words in [&["radius"][..], &["curvature"], &["polyline", "--tolerance", "0.1"]] {
        let on = |threads: &str| {
            let words = [words, &["-", "--json", "--rel-width", "1e-6", "--threads", threads]].concat();
            answer(&fed(&words, long.as_bytes()), 0).to_string()
        };
        let one = on("1");
        assert!(["2", "3", "8"].iter().all(|threads| on(threads) == one), "{words:?}");
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    for words in [&["radius", "tests/curves/m98_5_2.json"][..], &["completions", "bash"], &["--help"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = tubecert(words).stdout(writer).output().unwrap();
        assert_eq!((text(&output.stderr), code(&output)), ("", 0), "{words:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_written_is_no_answer() {
    let curve = "tests/curves/m98_5_2.json";
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for words in [
        &["radius", curve][..],
        &["radius", curve, "--json"],
        &["radius", "nope", "--json"],
        &["completions", "zsh"],
        &["--version"],
    ] {
        let output = tubecert(words).stdout(full()).output().unwrap();
        assert_eq!(code(&output), 4, "{words:?}");
        assert!(text(&output.stderr).starts_with("error: the answer cannot be written"), "{words:?}");
    }
    // with no place for the complaint either
    let output = tubecert(&["radius", curve]).stdout(full()).stderr(full()).output().unwrap();
    assert_eq!(code(&output), 4);
    let output = tubecert(&["radius", "nope"]).stderr(full()).output().unwrap();
    assert_eq!(code(&output), 2);
}

/// What the other commands print, as JSON, verifies with their own certificates; and reads as the snapshots say.
#[test]
fn critical_points_pairs_and_squares() {
    let certificate = std::env::temp_dir().join(format!("tubecert-{}.cert", std::process::id()));
    let certificate = certificate.to_str().unwrap();
    for path in curves() {
        let file = Path::new(&path).file_stem().unwrap().to_str().unwrap();
        for (command, key) in [("curvature", "kappa_max"), ("pairs", "pairs"), ("squares", "segments")] {
            let words = [command, &path, "--limit", "8"];
            let words = &words[..if command == "squares" { 4 } else { 2 }];
            let output = run(&[words, &["--json", "--certificate", certificate]].concat());
            assert!([0, 3].contains(&code(&output)), "{words:?} {}", text(&output.stderr));
            let printed = text(&output.stdout);
            let value: Value = serde_json::from_str(printed).unwrap();
            assert_eq!((&value["schema"], &value["command"]), (&1.into(), &command.into()));
            assert!(value.get(key).is_some() && value["complete"].as_bool() == Some(code(&output) == 0), "{printed}");
            let verified = fed(&["verify", &path, certificate, "--answer", "-", "--json"], printed.as_bytes());
            let said: Value = serde_json::from_str(answer(&verified, 0)).unwrap();
            assert_eq!((&said["verdict"], &said["claim"]["kind"]), (&"verified".into(), &command.into()));
            if ["m98_5_3", "m98_5_6_2", "trefoil", "circle_exact"].contains(&file) {
                let output = run(words);
                matches_snapshot(&format!("{file}.{command}.txt"), text(&output.stdout));
            }
        }
    }
    std::fs::remove_file(certificate).unwrap();
}

/// Made, judged and verified in each format; each key of the answer that is a claim is compared.
#[test]
fn polylines_in_each_format() {
    let folder = std::env::temp_dir().join(format!("tubecert-polylines-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).to_str().unwrap().to_string();
    let (certificate, corner) = (at("cert"), at("corner.json"));
    for file in ["m98_5_2", "trefoil", "circle_exact"] {
        let curve = format!("tests/curves/{file}.json");
        let made = ["polyline", &curve, "--tolerance", "0.05"];
        matches_snapshot(&format!("{file}.polyline.txt"), answer(&run(&made), 0));
        let printed = run(&[&made[..], &["--json", "--certificate", &certificate]].concat());
        let printed = answer(&printed, 0);
        matches_snapshot(&format!("{file}.polyline.json"), printed);
        answer(&fed(&["verify", &curve, &certificate, "--answer", "-"], printed.as_bytes()), 0);
        for ending in ["json", "csv", "obj"] {
            let path = at(&format!("{file}.{ending}"));
            answer(&run(&[&made[..], &["-o", &path]].concat()), 0);
            let judged = run(&["check", &curve, &path, "--tolerance", "0.05", "--json", "--certificate", &certificate]);
            let judged = answer(&judged, 0);
            answer(&fed(&["verify", &curve, &certificate, "--answer", "-", "--polyline", &path], judged.as_bytes()), 0);
            // only certified, only with its polyline
            let edited = judged.replace("certified", "refuted");
            let words = ["verify", &curve, &certificate, "--answer", "-", "--polyline", &path, "--json"];
            answer(&fed(&words, edited.as_bytes()), 2);
            answer(&fed(&["verify", &curve, &certificate, "--answer", "-", "--json"], judged.as_bytes()), 2);
            let refuted = run(&["check", &curve, &path, "--tolerance", "1e-4", "--json"]);
            assert!(
                answer(&refuted, 1).contains("\"verdict\":\"refuted\"") || answer(&refuted, 1).contains("\"refuted\"")
            );
        }
        let value: Value = serde_json::from_str(printed).unwrap();
        for (key, other) in
            [("closed", "\"?\""), ("edges", "3"), ("distance", "{\"lo\": 1, \"hi\": 2}"), ("complete", "false")]
        {
            let mut edited = value.clone();
            edited[key] = if key == "closed" {
                (!value["closed"].as_bool().unwrap()).into()
            } else {
                serde_json::from_str(other).unwrap()
            };
            let output = fed(&["verify", &curve, &certificate, "--answer", "-"], edited.to_string().as_bytes());
            assert!([1, 2].contains(&code(&output)), "{key}: {}", text(&output.stdout));
        }
    }
    fs::write(&corner, r#"{"degree": 1, "control_points": [[0, 0], [1, 0], [1, 1]], "knots": [0, 0, 1, 2, 2]}"#)
        .unwrap();
    assert_eq!(code(&run(&["polyline", &corner, "--tolerance", "0.1"])), 1);
    let curve = "tests/curves/m98_5_2.json";
    for tolerance in ["0", "-1", "nan", "1e-400", "x"] {
        assert_eq!(code(&run(&["polyline", curve, "--tolerance", tolerance])), 2, "{tolerance}");
    }
    assert_eq!(code(&run(&["polyline", curve, "--tolerance", "0.1", "-o", &at("p.stl")])), 2);
    for (name, file) in [
        ("one.json", "[[0, 0, 0]]"),
        ("nan.json", "[[0, 0, 0], [\"nan\", 0, 0]]"),
        ("ragged.json", "[[0, 0, 0], [1]]"),
        ("deep.json", "[[[[0]]]]"),
        ("nan.csv", "nan,nan,nan\n0,0,0\n1,1,1\n"),
        ("gap.csv", "0,0,0\n1,,3\n"),
        ("empty.csv", ""),
        ("marked.obj", "\u{feff}v 0 0 0\nv 1 1 1\nl 1 2\n"),
        ("far.obj", "v 0 0 0\nl 1 2\n"),
        ("none.obj", "v 0 0 0\nv 1 0 0\n"),
        ("parted.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nl 1 2\nl 3 4\n"),
    ] {
        fs::write(at(name), file).unwrap();
        let output = run(&["check", curve, &at(name), "--tolerance", "0.1", "--json"]);
        assert_eq!(code(&output), 2, "{name}: {}", text(&output.stdout));
        assert!(text(&output.stdout).contains("help"), "{name}");
    }
    fs::write(at("named.csv"), "x, y, z\r\n# a comment\r\n0 0 0\r\n\r\n1;1;1\r\n").unwrap();
    assert_eq!(code(&run(&["check", curve, &at("named.csv"), "--tolerance", "0.1"])), 1);
    fs::remove_dir_all(folder).unwrap();
}
