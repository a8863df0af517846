//! The trust line as a test: which module may import which. Arrows only go where this table says.

use std::fs;
use std::path::{Path, PathBuf};

/// Module (path below `src`, without the ending), and what its `crate::` imports may start with.
const TABLE: &[(&str, &[&str])] = &[
    // for the words of the reader
    ("error", &["number", "print"]),
    // print: for the public paths
    ("number", &["error", "print"]),
    // construct: for what stands in a file besides the curve
    ("curve", &["construct", "error", "number"]),
    ("print", &["error", "number"]),
    // certificate, claim: to propose a claim
    ("construct", &["certificate", "claim", "curve", "error", "number", "print"]),
    // claim: the statement that evidence would prove
    ("certificate", &["claim", "error", "number"]),
    ("claim", &["curve", "number"]),
    ("check", &["certificate", "claim", "curve", "error", "number"]),
    ("integer", &[]),
    ("parallel", &[]),
    ("enclosure", &[]),
    ("bernstein", &["enclosure", "integer"]),
    ("roots", &["bernstein", "error", "integer", "number"]),
    ("spine", &["bernstein", "curve", "error", "integer", "number", "parallel", "roots"]),
    (
        "search",
        &[
            "bernstein",
            "certificate",
            "enclosure",
            "error",
            "integer",
            "number",
            "parallel",
            "roots",
            "search",
            "spine",
        ],
    ),
    // check: its own certificates are replayed in tests
    ("options", &["enclosure", "error", "number", "search"]),
    ("pairs", &["certificate", "claim", "enclosure", "error", "number", "options", "search", "spine"]),
    (
        "judge",
        &[
            "certificate",
            "claim",
            "enclosure",
            "error",
            "integer",
            "number",
            "options",
            "polyline",
            "radius",
            "search",
            "spine",
        ],
    ),
    ("polyline", &["certificate", "claim", "error", "number", "options", "radius", "search", "spine"]),
    (
        "curvature",
        &[
            "bernstein",
            "certificate",
            "claim",
            "enclosure",
            "error",
            "integer",
            "number",
            "options",
            "roots",
            "search",
            "spine",
        ],
    ),
    ("squares", &["certificate", "check", "claim", "error", "number", "options", "roots", "search", "spine"]),
    ("radius", &["certificate", "check", "curve", "error", "integer", "number", "options", "search", "spine"]),
];

/// The trust line: what reads the curve of a claim, and what checks. Besides them only the words of `error` and `print`.
/// Not `certificate/text.rs`: whatever is read there is evidence, which is checked.
const READER: &[&str] = &["number.rs", "curve.rs"];
const CHECKER: &[&str] = &["claim", "certificate.rs", "check/"];
/// Further claims: each in one file of the checker, with its own statement, and the tools that they share.
const FURTHER: &[&str] = &["curvature.rs", "pairs.rs", "polyline.rs", "squares.rs", "field.rs", "kappa.rs", "range.rs"];
/// What it takes to have several kinds of claims: it names and passes on, and decides nothing.
const SEVERAL: &[&str] = &["check/mod.rs", "claim.rs"];

fn sources(dir: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

fn library_sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = vec![];
    sources(&root, &mut found);
    found
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
            (name, fs::read_to_string(&path).unwrap())
        })
        .filter(|(name, _)| name != "lib.rs" && name != "main.rs" && !name.starts_with("cli"))
        .collect()
}

#[test]
fn imports_follow_the_table() {
    for (name, text) in library_sources() {
        let top = name.split(['/', '.']).next().unwrap();
        let Some((_, allowed)) = TABLE.iter().find(|(module, _)| *module == top) else {
            panic!("{name}: not in the table of tests/layering.rs");
        };
        for (number, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for part in line.split("crate::").skip(1) {
                let target: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let fine = target == top || allowed.contains(&target.as_str());
                assert!(fine, "src/{name}:{}: {top} may not import {target}", number + 1);
            }
        }
    }
}

#[test]
fn one_file_names_inari() {
    for (name, text) in library_sources() {
        let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        let named = code.filter(|l| l.contains("inari")).count();
        assert!(named == 0 || name == "enclosure/native.rs", "src/{name} names inari");
    }
}

fn within(part: &[&str]) -> Vec<(String, String)> {
    let wanted = |name: &str| part.iter().any(|start| name.starts_with(start)) && name != "check/tests.rs";
    library_sources().into_iter().filter(|(name, _)| wanted(name)).collect()
}

/// The trust line is small enough to be read, comments and all.
#[test]
fn the_trust_line_is_short() {
    let (mut total, mut several) = (0, 0);
    for (name, text) in within(&[READER, CHECKER].concat()) {
        let lines = text.lines().count();
        println!("{lines:5} {name}");
        assert!(lines <= 250, "src/{name} has {lines} lines");
        if SEVERAL.contains(&name.as_str()) {
            several += lines;
        } else if !FURTHER.iter().any(|claim| name.ends_with(claim)) {
            total += lines;
        }
    }
    println!("{total:5} of 1200");
    assert!(total <= 1_200, "{total} lines");
    assert!(several <= 125, "{several} lines");
}

#[test]
fn the_trust_line_searches_nothing() {
    for (name, text) in within(&[READER, CHECKER].concat()) {
        for word in ["inari", "search", "bernstein::", "enclosure", "f64"] {
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//") && !line.contains("f64_below"));
            assert_eq!(code.filter(|line| line.contains(word)).count(), 0, "src/{name} names {word}");
        }
    }
}
