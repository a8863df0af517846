//! Reads polylines: JSON, CSV, OBJ.

use std::path::Path;

use serde_json::value::RawValue;
use tubecert::ErrorKind;
use tubecert::number::{MAX_CONTROL_POINTS, Rational, parse_rational};

use super::answer::items;
use super::{Failure, UNUSABLE, read};

type Vertex = [Rational; 3];

/// What is wrong with a polyline: the kind of fault, the vertex or line from 0, the words.
struct Wrong {
    kind: ErrorKind,
    key: &'static str,
    index: Option<usize>,
    message: String,
}

fn wrong(kind: ErrorKind, key: &'static str, index: usize, message: impl ToString) -> Wrong {
    Wrong { kind, key, index: Some(index), message: message.to_string() }
}

/// The points of a polyline in order, exactly as they are spelled. The format is that of the ending; `-` is JSON.
pub fn vertices(path: &Path) -> Result<Vec<Vertex>, Box<Failure>> {
    let file = path.display().to_string();
    let bytes = read(path, &file)?;
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    let found = match ending.as_deref() {
        Some("csv") => text(&bytes).and_then(csv),
        Some("obj") => text(&bytes).and_then(obj),
        _ => json(&bytes),
    };
    found.map_err(|Wrong { kind, key, index, message }| {
        let help = Some("give a list of points in JSON, lines x,y,z in CSV, or v and l lines in OBJ".to_string());
        let (file, key) = (Some(file), Some(key.to_string()));
        Box::new(Failure { file, key, index, help, ..Failure::new(kind.word(), message, UNUSABLE) })
    })
}

fn text(bytes: &[u8]) -> Result<&str, Wrong> {
    let syntax =
        |message: &str| Wrong { kind: ErrorKind::Syntax, key: "vertices", index: None, message: message.to_string() };
    let text =
        std::str::from_utf8(bytes).map_err(|error| syntax(&format!("byte {} is not UTF-8", error.valid_up_to())))?;
    if text.starts_with('\u{feff}') {
        Err(syntax("the file starts with a byte-order mark, at byte 0"))
    } else {
        Ok(text)
    }
}

/// Refuses one vertex too many, before memory is taken.
fn limited(count: usize) -> Result<(), Wrong> {
    let message = format!("there are more vertices than the limit MAX_CONTROL_POINTS = {MAX_CONTROL_POINTS}");
    if count <= MAX_CONTROL_POINTS {
        Ok(())
    } else {
        Err(Wrong { kind: ErrorKind::Limit, key: "vertices", index: None, message })
    }
}

/// Two or three coordinates.
fn point<'a>(words: impl Iterator<Item = &'a str>, key: &'static str, index: usize) -> Result<Vertex, Wrong> {
    let number = |word: &str| parse_rational(word).map_err(|error| wrong(error.kind, key, index, error.message));
    let mut numbers = words.map(number).collect::<Result<Vec<_>, Wrong>>()?;
    if numbers.len() == 2 {
        numbers.push(Rational::from_integer(0.into()));
    }
    let found = numbers.len();
    let message = format!("a point has two or three coordinates, not {found}");
    numbers.try_into().map_err(|_| wrong(ErrorKind::WrongLength, key, index, message))
}

/// A list of points, or an answer with the key `vertices`.
fn json(bytes: &[u8]) -> Result<Vec<Vertex>, Wrong> {
    let syntax = |message: String| Wrong { kind: ErrorKind::Syntax, key: "vertices", index: None, message };
    let root: &RawValue = serde_json::from_slice(bytes).map_err(|error| syntax(format!("it is not JSON: {error}")))?;
    let points: Vec<&RawValue> = if root.get().starts_with('{') {
        items(root, "vertices").map_err(|error| syntax(error.message))?
    } else {
        serde_json::from_str(root.get()).map_err(|error| syntax(format!("wanted a list of points: {error}")))?
    };
    limited(points.len())?;
    let each = |(index, item): (usize, &&RawValue)| {
        let words: Vec<&RawValue> = serde_json::from_str(item.get())
            .map_err(|_| wrong(ErrorKind::WrongType, "vertices", index, "a point is a list of numbers"))?;
        point(words.iter().map(|word| word.get().trim_matches('"')), "vertices", index)
    };
    points.iter().enumerate().map(each).collect()
}

/// A point on each line; empty lines and those that start with # do not count, nor a first line of words.
fn csv(text: &str) -> Result<Vec<Vertex>, Wrong> {
    // an empty field is a fault, spaces are not
    let words = |line: &'_ str| -> Vec<String> {
        let parted = line.trim().split([',', ';']).map(|word| word.trim().to_string()).collect::<Vec<_>>();
        if parted.len() > 1 { parted } else { line.split_whitespace().map(str::to_string).collect() }
    };
    let name = |word: &String| {
        let number = ["nan", "inf", "infinity"].contains(&word.to_ascii_lowercase().as_str());
        word.starts_with(|c: char| c.is_ascii_alphabetic()) && !number
    };
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.trim().starts_with('#'));
    let mut points = vec![];
    for (number, (index, line)) in lines.enumerate() {
        let words = words(line);
        if number > 0 || !words.iter().all(name) {
            limited(points.len() + 1)?;
            points.push(point(words.iter().map(String::as_str), "line", index)?);
        }
    }
    Ok(points)
}

/// The `v` lines in the order of the `l` lines, each of which goes on where the one before ends.
fn obj(text: &str) -> Result<Vec<Vertex>, Wrong> {
    let (mut all, mut order): (Vec<Vertex>, Vec<usize>) = (vec![], vec![]);
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                limited(all.len() + 1)?;
                all.push(point(words.take(3), "line", index)?);
            }
            Some("l") => {
                let mut first = true;
                for word in words {
                    let number = word.split('/').next().unwrap_or_default().parse::<i64>().ok();
                    let place = number.and_then(|k| {
                        if k < 0 { all.len().checked_add_signed(k as isize) } else { usize::try_from(k - 1).ok() }
                    });
                    let place = place
                        .ok_or_else(|| wrong(ErrorKind::Number, "line", index, "an index is no number of a vertex"))?;
                    let parted = first && order.last().is_some_and(|last| *last != place);
                    if parted {
                        return Err(wrong(
                            ErrorKind::WrongType,
                            "line",
                            index,
                            "the line does not go on where the one before ends",
                        ));
                    }
                    if !first || order.is_empty() {
                        limited(order.len() + 1)?;
                        order.push(place);
                    }
                    first = false;
                }
            }
            _ => {}
        }
    }
    if order.is_empty() {
        let message = "there is no l line".to_string();
        return Err(Wrong { kind: ErrorKind::MissingKey, key: "l", index: None, message });
    }
    let at =
        |k: usize| all.get(k).cloned().ok_or_else(|| wrong(ErrorKind::WrongLength, "l", k, "there is no such vertex"));
    order.into_iter().map(at).collect()
}

/// Are these the same polylines, whichever way they run and, if they are closed, wherever they start?
pub fn same(a: &[Vertex], b: &[Vertex], closed: bool) -> bool {
    let once = |vertices: &[Vertex]| {
        let mut vertices = vertices.to_vec();
        vertices.dedup();
        if closed && vertices.len() > 1 && vertices.first() == vertices.last() {
            vertices.pop();
        }
        vertices
    };
    let (a, mut b) = (once(a), once(b));
    let turned = |b: &[Vertex]| {
        let starts = b.iter().enumerate().filter(|(k, vertex)| (closed || *k == 0) && Some(*vertex) == a.first());
        let mut starts = starts.take(16);
        starts.any(|(k, _)| a.len() == b.len() && a.iter().eq(b[k..].iter().chain(&b[..k])))
    };
    let forward = turned(&b);
    b.reverse();
    forward || turned(&b)
}
