//! `batch`: the answers of the single commands, in order, whatever the threads, shards and kills do.
#![cfg(all(feature = "cli", feature = "search"))]

use std::fs;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

#[path = "shapes/mod.rs"]
mod shapes;
use shapes::Random;

#[path = "program/mod.rs"]
mod program;
use program::{code, fed, tubecert};

/// The records on stdout of a batch that ended well.
fn records(words: &[&str], input: &[u8]) -> String {
    let output = fed(&[&["batch"], words].concat(), input);
    let said = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(code(&output), 0, "{words:?} {said}");
    assert!(said.lines().count() == 1 && said.contains(" records"), "{said}");
    String::from_utf8(output.stdout).unwrap()
}

fn values(records: &str) -> Vec<Value> {
    records.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))).collect()
}

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("tubecert-batch-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn at(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_string()
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.at(name);
        fs::write(&path, content).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Lines of random cubics, each with its number as id.
fn cubics(count: usize, seed: u64) -> Vec<String> {
    let mut dice = Random(seed);
    let mut point = || [(); 3].map(|()| dice.below(2001) - 1000);
    let line = |k| format!(r#"{{"id": {k}, "degree": 3, "control_points": {:?}}}"#, [(); 4].map(|()| point()));
    (0..count).map(line).collect()
}

/// A curve file on one line.
fn one_line(path: &Path) -> String {
    fs::read_to_string(path).unwrap().replace('\n', " ")
}

/// All examples, a corner (no polyline at all), and a file that is none.
fn examples() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/curves");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let corner = r#"{"degree": 1, "control_points": [[0, 0], [1, 0], [1, 1]], "knots": [0, 0, 1, 2, 2]}"#;
    let curves = paths.iter().map(|path| one_line(path));
    curves.chain([corner.to_string(), r#"{"degree": 1, "control_points": [[0, 0], [1, NaN]]}"#.to_string()]).collect()
}

#[test]
fn every_task_answers_as_its_command() {
    let lines = examples();
    for (task, options) in [
        ("radius", &[][..]),
        ("radius", &["--all-terms", "--rel-width", "1e-3"]),
        ("radius", &["--max-cells", "1"]),
        ("curvature", &[]),
        ("pairs", &[]),
        ("polyline", &["--tolerance", "0.05"]),
    ] {
        let batch = records(&[&["--task", task], options].concat(), lines.join("\n").as_bytes());
        assert_eq!(batch.lines().count(), lines.len());
        for ((record, line), number) in batch.lines().zip(&lines).zip(1..) {
            let single = fed(&[&[task, "-", "--json"], options].concat(), line.as_bytes());
            let single = String::from_utf8(single.stdout).unwrap();
            let origin = format!(r#""id":null,"file":"-","line":{number}"#);
            let expected = match single.strip_prefix(r#"{"schema":1,"error""#) {
                Some(error) => format!(r#"{{"schema":1,{origin},"error"{error}"#),
                None => format!("{},{origin}}}\n", single.strip_suffix("}\n").unwrap()),
            };
            assert_eq!(format!("{record}\n"), expected, "{task} {options:?} {line}");
        }
    }
}

const CURVE: &str = r#""degree": 2, "control_points": [[-1, 1], [0, -1], [1, 1]]"#;

#[test]
fn ids_are_echoed_as_they_are_spelled() {
    let ids =
        ["7", "-1.50e+07", r#""a""#, r#""""#, r#""\u00e9\"\\ \ud83d\ude00 é""#, &format!("\"{}\"", "x".repeat(998))];
    let mut lines: Vec<String> = ids.iter().map(|id| format!("{{\"id\": {id}, {CURVE}}}")).collect();
    lines.push(format!("{{{CURVE}, \"id\" : 5 }} \r"));
    lines.push(format!("{{{CURVE}}}"));
    // only at the top, only as a key
    lines.push(format!(r#"{{{CURVE}, "x-a": {{"id": 1}}, "name": "id"}}"#));
    let found = records(&["--task", "radius"], lines.join("\n").as_bytes());
    let expected = ids.into_iter().chain(["5", "null", "null"]);
    for ((record, id), number) in found.lines().zip(expected).zip(1..) {
        let origin = format!(r#","id":{id},"file":"-","line":{number}}}"#);
        assert!(record.ends_with(&origin), "{record} {origin}");
    }
    assert_eq!(found.lines().count(), lines.len());
    for (id, kind, offset) in [
        ("\"id\": null", "wrong_type", 7),
        ("\"id\": {}", "wrong_type", 7),
        ("\"id\": true", "wrong_type", 7),
        (r#""id": "\ud83d""#, "wrong_type", 7),
        (&format!("\"id\": \"{}\"", "x".repeat(999)), "limit", 7),
        ("\"id\": 1, \"id\": 2", "duplicate_key", 10),
    ] {
        let found = records(&["--task", "radius"], format!("{{{id}, {CURVE}}}").as_bytes());
        let error = &values(&found)[0]["error"];
        let place = json!([error["kind"], error["key"], error["offset"], error["file"]]);
        assert_eq!(place, json!([kind, "id", offset, "-"]), "{id}");
    }
}

/// The id is taken out without moving what stands behind it.
#[test]
fn errors_name_the_byte_of_the_line() {
    let line = r#"{"id": "seven", "degree": 1, "control_points": [[0, 0], [1, "nan"]]}"#;
    let found = values(&records(&["--task", "radius"], format!("\n{line}\n").as_bytes()));
    let error = &found[0]["error"];
    assert_eq!((&found[0]["id"], &found[0]["line"], &error["kind"]), (&"seven".into(), &2.into(), &"number".into()));
    assert_eq!(error["offset"], line.find("\"nan\"").unwrap());
}

#[test]
fn shards_part_the_lines_of_all_files() {
    let folder = Folder::new("shards");
    let lines = cubics(23, 1);
    // blank lines count as lines, not as curves
    let first = folder.file("a", format!("\n{}\n \t\r\n\n", lines[..8].join("\n\n")));
    let second = folder.file("b", lines[8..].join("\n"));
    let words = ["--task", "radius", &first, "-", &second];
    let all = records(&words, b"\n{}");
    assert_eq!(all.lines().count(), 24);
    for count in [1, 2, 5, 30] {
        let mut parts: Vec<Vec<String>> = vec![];
        for k in 1..=count {
            let shard = format!("{k}/{count}");
            let found = records(&[&words[..], &["--shard", &shard]].concat(), b"\n{}");
            parts.push(found.lines().map(str::to_string).collect());
        }
        let merged: Vec<&str> = (0..24).map(|k| parts[k % count][k / count].as_str()).collect();
        assert!(all.lines().eq(merged), "{count}");
        assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), 24);
    }
    let origins: Vec<Value> = values(&all).iter().map(|value| json!([value["file"], value["line"]])).collect();
    assert_eq!(origins[7..10], [json!([first, 16]), json!(["-", 2]), json!([second, 1])]);
}

#[test]
fn threads_do_not_change_the_bytes() {
    let input = cubics(700, 2).join("\n");
    let [one, four] = ["1", "4"].map(|n| records(&["--task", "radius", "--threads", n], input.as_bytes()));
    assert_eq!(one, four);
    let ids: Vec<Value> = values(&one).iter().map(|value| value["id"].clone()).collect();
    assert_eq!(ids, (0..700).map(Value::from).collect::<Vec<_>>());
}

#[test]
fn killed_and_resumed_is_never_interrupted() {
    let folder = Folder::new("kills");
    let (input, output) = (folder.file("in", cubics(3000, 3).join("\n")), folder.at("out"));
    let whole = records(&["--task", "radius", &input], b"");
    let words = ["batch", "--task", "radius", &input, "-o", &output, "--resume", "--threads", "2"];
    let (mut dice, mut kills, mut rounds) = (Random(4), 0, 0);
    while kills < 20 {
        let mut child = tubecert(&words).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(dice.below(60_000) as u64));
        if child.try_wait().unwrap().is_some() {
            assert!(fs::read_to_string(&output).unwrap() == whole);
            fs::remove_file(&output).unwrap();
            rounds += 1;
            continue;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    println!("{kills} kills in {rounds} complete batches and a last one");
    assert_eq!(code(&fed(&words, b"")), 0);
    assert!(fs::read_to_string(&output).unwrap() == whole);
}

#[test]
fn resumed_from_every_kind_of_cut() {
    let folder = Folder::new("cuts");
    // an error first, one record longer than a buffer
    let polyline = [&["{}".to_string()], &cubics(5, 5)[..]].concat().join("\n");
    let (input, output) = (folder.file("in", polyline), folder.at("out"));
    for options in [&[][..], &["--budget", "1000"]] {
        let words = [&["--task", "polyline", "--tolerance", "0.01", &input], options].concat();
        let whole = records(&words, b"").into_bytes();
        let words = [&["batch"], &words[..], &["--output", &output, "--resume"]].concat();
        let ends: Vec<usize> = (0..whole.len()).filter(|at| whole[*at] == b'\n').collect();
        assert_eq!(ends.len(), 6);
        let cuts = ends.iter().flat_map(|end| [end - 1, *end, end + 1, end + 2]);
        for cut in [0, 1, 11, 12, 20].into_iter().chain(cuts).filter(|cut| *cut <= whole.len()) {
            fs::write(&output, &whole[..cut]).unwrap();
            let done = fed(&words, b"");
            assert_eq!((code(&done), done.stdout), (0, vec![]), "{cut}");
            assert!(fs::read(&output).unwrap() == whole, "{cut}");
        }
        fs::remove_file(&output).unwrap();
        assert_eq!(code(&fed(&words, b"")), 0);
        assert!(fs::read(&output).unwrap() == whole);
    }
}

#[test]
fn what_does_not_fit_is_not_resumed() {
    let folder = Folder::new("refused");
    let lines = cubics(9, 6);
    let (input, output) = (folder.file("in", lines.join("\n")), folder.at("out"));
    let (shorter, other) =
        (folder.file("shorter", lines[..7].join("\n")), folder.file("other", cubics(9, 7).join("\n")));
    let last = folder.file("last", [&lines[..7], &cubics(9, 7)[7..]].concat().join("\n"));
    let words = ["batch", "--task", "radius", &input, "-o", &output];
    assert_eq!(code(&fed(&words, b"")), 0);
    let whole = fs::read(&output).unwrap();
    let eight = whole.len() - whole.rsplit(|byte| *byte == b'\n').nth(1).unwrap().len() - 1;
    let go_on = ["-o", &output, "--resume"];
    for (kept, words) in [
        (&whole[..], &["--task", "radius", &input, "-o", &output][..]),
        (&whole[..], &[&["--task", "curvature", &input], &go_on[..]].concat()),
        (&whole[..], &[&["--task", "radius", "--rel-width", "1e-8", &input], &go_on[..]].concat()),
        (&whole[..], &[&["--task", "radius", "--shard", "2/2", &input], &go_on[..]].concat()),
        (&whole[..], &[&["--task", "radius", "--budget", "9", &other], &go_on[..]].concat()),
        (&whole[..], &[&["--task", "radius", &other], &go_on[..]].concat()),
        (&whole[..], &[&["--task", "radius", &shorter], &go_on[..]].concat()),
        (&whole[..eight], &[&["--task", "radius", &last], &go_on[..]].concat()),
        (&whole[..eight + 20], &[&["--task", "radius", &last], &go_on[..]].concat()),
        (b"my notes", &[&["--task", "radius", &input], &go_on[..]].concat()),
        (b"my\nnotes\n", &[&["--task", "radius", &input], &go_on[..]].concat()),
    ] {
        fs::write(&output, kept).unwrap();
        let refused = fed(&[&["batch"], words].concat(), b"");
        assert_eq!((code(&refused), &refused.stdout), (2, &vec![]), "{words:?}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains("the output "), "{words:?}");
        assert!(fs::read(&output).unwrap() == kept, "{words:?}");
    }
}

/// What no curve is, and the kind of its error.
fn hostile() -> Vec<(Vec<u8>, &'static str)> {
    let deep = [b"{\"id\": 1, \"degree\": ".as_slice(), &vec![b'['; 1_000_000]].concat();
    let with = |text: &str| text.as_bytes().to_vec();
    vec![
        (with(r#"{"degree": 1, "control_points": [[0, 0], [1, NaN]]}"#), "syntax"),
        (with(r#"{"degree": 1, "control_points": [[0, 0], [1, 0]], "knots": [0, 1, 0, 1]}"#), "knot_order"),
        (deep, "syntax"),
        (vec![b'['; 1_000_000], "syntax"),
        (b"{\"degree\": 1, \"name\": \"\xff\"}".to_vec(), "syntax"),
        (with("{}"), "missing_key"),
        (with("\u{feff}{}"), "syntax"),
        (with(&format!("{{{CURVE}}} {{{CURVE}}}")), "syntax"),
        (with(&format!("{{{CURVE}")), "syntax"),
        (with(&format!("{{{CURVE}, \"x-\": 1, \"id\": 1}}")), "duplicate_key"),
        (with(r#"{"degree": 2, "control_points": [[0, 0], [0, 0], [1, 0]]}"#), "irregular"),
        (with(r#"{"degree": 1, "control_points": [[0, 0], [1, 1e999999999]]}"#), "limit"),
        (with("null"), "wrong_type"),
        (vec![0; 100], "syntax"),
    ]
}

#[test]
fn hostile_lines_are_errors_and_no_others() {
    let mut lines: Vec<Vec<u8>> = cubics(1400, 8).into_iter().map(String::into_bytes).collect();
    let mut clean = lines.clone();
    let mut kinds = vec![None; lines.len()];
    for (k, (line, kind)) in hostile().into_iter().enumerate() {
        let at = 100 * k + 37;
        (lines[at], clean[at], kinds[at]) = (line, vec![], Some(kind));
    }
    let [hostile, clean] = [lines, clean].map(|lines| records(&["--task", "radius"], &lines.join(&b'\n')));
    let (errors, answers): (Vec<&str>, Vec<&str>) = hostile.lines().partition(|line| line.contains("\"error\":"));
    assert!(clean.lines().eq(answers));
    assert_eq!(errors.len(), 14);
    for (found, kind) in values(&hostile).iter().zip(kinds) {
        assert_eq!(found["error"]["kind"].as_str(), kind, "{found}");
    }
}

/// Far more than a curve file may have, and more than there is memory for.
#[cfg(target_os = "linux")]
#[test]
fn a_line_without_end_is_an_error_of_its_own() {
    let folder = Folder::new("long");
    let line = format!("{{{CURVE}}}\n");
    let path = folder.file("in", &line);
    let mut file = fs::OpenOptions::new().append(true).open(&path).unwrap();
    file.set_len(1 << 30).unwrap();
    file.seek(SeekFrom::End(0)).unwrap();
    file.write_all(format!("\n{line}").as_bytes()).unwrap();
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -v 900000 && exec \"$0\" batch --task radius --threads 1 \"$1\""]);
    let output = limited.args([env!("CARGO_BIN_EXE_tubecert"), &path]).output().unwrap();
    assert_eq!(code(&output), 0, "{}", String::from_utf8_lossy(&output.stderr));
    let found = values(std::str::from_utf8(&output.stdout).unwrap());
    let lines: Vec<&Value> = found.iter().map(|value| &value["line"]).collect();
    assert_eq!((lines, &found[1]["error"]["kind"]), (vec![&json!(1), &json!(2), &json!(3)], &"limit".into()));
    assert!(found[0]["delta"] == found[2]["delta"] && found[0]["delta"]["hi"].is_number());
}

#[test]
fn wrong_usage_and_files_are_errors() {
    let folder = Folder::new("usage");
    let input = folder.file("in", format!("{{{CURVE}}}"));
    let (nope, folder_itself) = (folder.at("nope"), folder.at("."));
    for (expected, words) in [
        (2, &["--task", "squares", &input][..]),
        (2, &[&input]),
        (2, &["--task", "polyline", &input]),
        (2, &["--task", "radius", "--tolerance", "1", &input]),
        (2, &["--task", "pairs", "--all-terms", &input]),
        (2, &["--task", "radius", "--certificate", "c", &input]),
        (2, &["--task", "radius", "--resume", &input]),
        (2, &["--task", "radius", "--threads", "0", &input]),
        (2, &["--task", "radius", "--shard", "0/2", &input]),
        (2, &["--task", "radius", "--shard", "3/2", &input]),
        (2, &["--task", "radius", "--shard", "1/0", &input]),
        (2, &["--task", "radius", "--shard", "1", &input]),
        (2, &["--task", "radius", &input, &nope]),
        (2, &["--task", "radius", &input, &folder_itself]),
        (4, &["--task", "radius", &input, "-o", &folder_itself]),
        (4, &["--task", "radius", &input, "-o", &folder.at("nope/out")]),
    ] {
        let output = fed(&[&["batch"], words].concat(), b"");
        assert_eq!((code(&output), &output.stdout), (expected, &vec![]), "{words:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: "), "{words:?}");
    }
    assert_eq!(
        records(&["--task", "radius", &input], b""),
        records(&["--task", "radius", "--shard", "1/1", &input], b"")
    );
    assert_eq!(records(&["--task", "radius"], b" \n\n"), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_a_closed_pipe_is_not() {
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let folder = Folder::new("full");
    let input = folder.file("in", cubics(300, 9).join("\n"));
    for words in [&["batch", "--task", "radius", &input][..], &["batch", "--task", "radius", &input, "-o", "/dev/full"]]
    {
        let output = tubecert(words).stdout(full()).output().unwrap();
        assert_eq!(code(&output), 4, "{words:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: the records cannot be written"));
    }
    let mut child =
        tubecert(&["batch", "--task", "radius", &input]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""));
}
