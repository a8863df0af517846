//! The trust line as a test: which module may import which. Arrows only go where this table says.

use std::fs;
use std::path::{Path, PathBuf};

/// Module (path below `src`, without the ending), and what its `crate::` imports may start with.
const TABLE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("number", &["error"]),
    ("json", &["error", "number"]),
    ("curve", &["error", "json", "number"]),
    ("certificate", &["error", "number"]),
    ("claim", &["certificate", "curve", "number"]),
    ("check", &["certificate", "claim", "curve", "error", "number"]),
    ("integer", &[]),
    ("enclosure", &[]),
    ("bernstein", &["enclosure", "integer"]),
    ("roots", &["bernstein", "integer"]),
    ("spine", &["bernstein", "curve", "error", "integer", "number", "roots"]),
    ("search", &["bernstein", "enclosure", "integer", "number", "search", "spine"]),
    ("radius", &["enclosure", "error", "number", "search", "spine"]),
];

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
