//! Reads back the JSON answers: what they claim.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde_json::value::RawValue;
use tubecert::claim::{
    Critical, CriticalKind, CriticalPoints, PairBox, Pairs, Polyline, RootBox, Squares, Stretch, TwoSquares,
};
use tubecert::number::{Rational, parse_rational};
use tubecert::{Curve, ErrorKind, Statement};

/// What is wrong with an answer, and at which key.
pub struct Wrong {
    pub kind: &'static str,
    pub key: Option<String>,
    pub message: String,
}

fn wrong(key: &str, what: impl fmt::Display) -> Wrong {
    Wrong { kind: "answer", key: Some(key.to_string()), message: what.to_string() }
}

/// What a JSON answer claims of the curve, exactly as its decimals are printed.
pub fn statement(bytes: &[u8], curve: &Curve) -> Result<Statement, Wrong> {
    let root: &RawValue = serde_json::from_slice(bytes).map_err(|error| Wrong {
        kind: ErrorKind::Syntax.word(),
        key: None,
        message: format!("the answer is not JSON: {error}"),
    })?;
    let read = match string(root, "command")?.as_deref() {
        Some("radius") => radius,
        Some("pairs") => pairs,
        Some("curvature") => curvature,
        Some("squares") => squares,
        Some("polyline" | "check") => polyline,
        _ => return Err(wrong("command", "this is no answer that a certificate can prove")),
    };
    if string(root, "curve.digest")? != Some(curve.digest()) {
        return Err(wrong("curve.digest", "the answer is about another curve"));
    }
    if string(root, "unit")?.as_deref() != curve.unit() {
        return Err(wrong("unit", "the curve has another unit"));
    }
    if member(root, "schema")? != "1" {
        return Err(wrong("schema", "this version reads answers of schema 1"));
    }
    read(root)
}

fn radius(root: &RawValue) -> Result<Statement, Wrong> {
    let [lo, hi] = enclosure(root, "delta")?;
    Ok(Statement::Radius { lo, hi })
}

fn pairs(root: &RawValue) -> Result<Statement, Wrong> {
    let list = |key: &str| {
        let pair = |item: &RawValue| {
            let range = |key: &str| match enclosure(item, key)? {
                [Some(lo), Some(hi)] => Ok([lo, hi]),
                _ => Err(wrong(key, "a parameter is infinite")),
            };
            let [lo, hi] = enclosure(item, "distance")?;
            let lo = lo.ok_or_else(|| wrong("distance.lo", "a distance is infinite"))?;
            Ok(PairBox { s: range("s")?, t: range("t")?, distance: (lo, hi) })
        };
        items(root, key)?.into_iter().map(pair).collect::<Result<Vec<_>, Wrong>>()
    };
    let (pairs, undecided) = (list("pairs")?, list("undecided")?);
    if member(root, "complete")? == "true" && !undecided.is_empty() {
        return Err(wrong("complete", "it is true, but something is undecided"));
    }
    Ok(Statement::Pairs(Pairs { pairs, undecided }))
}

fn curvature(root: &RawValue) -> Result<Statement, Wrong> {
    let point = |item: &RawValue| {
        let kind = match member(item, "kind")? {
            "null" => None,
            _ => {
                let word = string(item, "kind")?;
                let known = CriticalKind::ALL.into_iter().find(|kind| Some(kind.word()) == word.as_deref());
                Some(known.ok_or_else(|| wrong("kind", "this version knows no such kind"))?)
            }
        };
        let unique = member(item, "unique")? == "true";
        Ok(Critical { t: enclosure(item, "t")?, kappa: enclosure(item, "kappa")?, kind, unique })
    };
    let stretch = |item: &RawValue| {
        Ok(Stretch { from: bound(item, "from")?, to: bound(item, "to")?, kappa: enclosure(item, "kappa")? })
    };
    Ok(Statement::Curvature(CriticalPoints {
        kappa_max: enclosure(root, "kappa_max")?,
        at: enclosure(root, "at")?,
        points: items(root, "critical_points")?.into_iter().map(point).collect::<Result<_, Wrong>>()?,
        constant: items(root, "constant")?.into_iter().map(stretch).collect::<Result<_, Wrong>>()?,
    }))
}

fn squares(root: &RawValue) -> Result<Statement, Wrong> {
    let range = |item: &RawValue, key: &str| match enclosure(item, key)? {
        [Some(lo), Some(hi)] => Ok([lo, hi]),
        _ => Err(wrong(key, "a number is infinite")),
    };
    let whole = |item: &RawValue, key: &str| {
        let text = member(item, key)?;
        text.parse::<u128>().map_err(|error| wrong(key, error))
    };
    let one = |item: &RawValue| {
        let multiplicity =
            usize::try_from(whole(item, "multiplicity")?).map_err(|error| wrong("multiplicity", error))?;
        Ok(RootBox { re: range(item, "re")?, im: range(item, "im")?, multiplicity })
    };
    let coefficients = |item: &RawValue, key: &str| {
        let each = |item: &RawValue| match [bound(item, "lo")?, bound(item, "hi")?] {
            [Some(lo), Some(hi)] => Ok([lo, hi]),
            _ => Err(wrong(key, "a coefficient is infinite")),
        };
        items(item, key)?.into_iter().map(each).collect::<Result<Vec<_>, Wrong>>()
    };
    let two =
        |item: &RawValue| Ok(TwoSquares { alpha: coefficients(item, "alpha")?, beta: coefficients(item, "beta")? });
    let segment = |item: &RawValue| {
        let end = |key: &str| {
            let text = member(item, key)?;
            let text = serde_json::from_str::<String>(text).unwrap_or_else(|_| text.to_string());
            parse_rational(&text).map_err(|error| wrong(key, error.message))
        };
        Ok(Squares {
            from: end("from")?,
            to: end("to")?,
            roots: items(item, "roots")?.into_iter().map(one).collect::<Result<_, Wrong>>()?,
            count: whole(item, "count")?,
            decompositions: items(item, "decompositions")?.into_iter().map(two).collect::<Result<_, Wrong>>()?,
        })
    };
    let segments = items(root, "segments")?;
    let unknown = |item: &&RawValue| {
        let twists = items(item, "decompositions")?.into_iter().map(|two| items(two, "twist"));
        let twists = twists.collect::<Result<Vec<_>, Wrong>>()?;
        twists.into_iter().flatten().try_fold(false, |any, twist| Ok(any || bound(twist, "hi")?.is_none()))
    };
    let unknown = segments.iter().try_fold(false, |any, item| Ok(any || unknown(item)?))?;
    if member(root, "complete")? == "true" && unknown {
        return Err(wrong("complete", "it is true, but a twist is unknown"));
    }
    let segments = segments.into_iter().map(segment).collect::<Result<_, Wrong>>()?;
    Ok(Statement::Squares(segments))
}

fn polyline(root: &RawValue) -> Result<Statement, Wrong> {
    let vertex = |item: &RawValue| {
        let numbers: [&RawValue; 3] =
            serde_json::from_str(item.get()).map_err(|_| wrong("vertices", "a vertex has three coordinates"))?;
        let number = |x: &RawValue| parse_rational(x.get()).map_err(|error| wrong("vertices", error.message));
        let [x, y, z] = numbers;
        Ok([number(x)?, number(y)?, number(z)?])
    };
    let distance = bound(root, "distance.hi")?.ok_or_else(|| wrong("distance.hi", "no polyline is claimed"))?;
    if bound(root, "distance.lo")?.is_none_or(|lo| lo > Rational::from_integer(0.into())) {
        return Err(wrong("distance.lo", "no certificate proves a lower bound"));
    }
    if string(root, "command")?.as_deref() == Some("check") {
        if string(root, "verdict")?.as_deref() != Some("certified") {
            return Err(wrong("verdict", "a certificate proves no other verdict than certified"));
        }
        // its polyline is named by --polyline
        return Ok(Statement::Polyline(Polyline { vertices: vec![], closed: false, distance }));
    }
    let vertices: Vec<_> = items(root, "vertices")?.into_iter().map(vertex).collect::<Result<_, Wrong>>()?;
    let closed = member(root, "closed")? == "true";
    if member(root, "edges")? != (vertices.len() - usize::from(!closed && !vertices.is_empty())).to_string() {
        return Err(wrong("edges", "there are as many as the vertices say"));
    }
    if member(root, "complete")? != "true" {
        return Err(wrong("complete", "no polyline is claimed"));
    }
    Ok(Statement::Polyline(Polyline { vertices, closed, distance }))
}

/// The values of an array.
pub fn items<'a>(root: &'a RawValue, key: &str) -> Result<Vec<&'a RawValue>, Wrong> {
    serde_json::from_str(member(root, key)?).map_err(|error| wrong(key, error))
}

/// The bounds under `path`; `None` is null.
fn enclosure(root: &RawValue, path: &str) -> Result<[Option<Rational>; 2], Wrong> {
    Ok([bound(root, &format!("{path}.lo"))?, bound(root, &format!("{path}.hi"))?])
}

/// The number at a key; `None` is null.
fn bound(root: &RawValue, key: &str) -> Result<Option<Rational>, Wrong> {
    match member(root, key)? {
        "null" => Ok(None),
        text if text.starts_with(['-', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9']) => {
            parse_rational(text).map(Some).map_err(|error| wrong(key, error.message))
        }
        _ => Err(wrong(key, "the bound is neither a number nor null")),
    }
}

/// The string under keys parted by points; `None` if it is no string.
fn string(root: &RawValue, path: &str) -> Result<Option<String>, Wrong> {
    Ok(serde_json::from_str(member(root, path)?).ok())
}

/// The value under keys parted by points, as it is spelled.
fn member<'a>(root: &'a RawValue, path: &str) -> Result<&'a str, Wrong> {
    path.split('.').try_fold(root.get(), |value, key| {
        if !value.starts_with('{') {
            return Err(wrong(path, "the key is missing"));
        }
        let members = serde_json::Deserializer::from_str(value).deserialize_map(Members).map_err(|error| {
            let kind = if error.is_data() { ErrorKind::DuplicateKey } else { ErrorKind::Syntax };
            Wrong { kind: kind.word(), ..wrong(path, error) }
        })?;
        members.get(key).map(|value| value.get()).ok_or_else(|| wrong(path, "the key is missing"))
    })
}

/// Collects the members of a JSON object, their values as they are spelled; refuses a key that stands twice.
struct Members;

impl<'a> Visitor<'a> for Members {
    type Value = BTreeMap<String, &'a RawValue>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut members = BTreeMap::new();
        while let Some((key, value)) = map.next_entry::<String, _>()? {
            if members.contains_key(&key) {
                return Err(A::Error::custom(format_args!("the key {key:?} stands twice in one object")));
            }
            members.insert(key, value);
        }
        Ok(members)
    }
}
