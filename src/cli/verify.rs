//! The command `verify`.

use serde::Serialize;
use serde_json::value::RawValue;
use tubecert::Curve;
use tubecert::certificate::Certificate;
use tubecert::check::{Rejection, Verified, verify};
use tubecert::claim::Claim;
use tubecert::json::{self as reader, Node, Value};
use tubecert::number::{Rational, decimal_text, parse_rational, to_fraction_text};

use super::args::VerifyArgs;
use super::text::plain;
use super::{DONE, Failure, REJECTED, Said, UNUSABLE, json, read};

pub fn run(args: &VerifyArgs) -> Said {
    let load = |path: &std::path::Path| {
        let file = path.display().to_string();
        read(path, &file).map(|bytes| (bytes, move |error| Box::new(Failure::of(file.clone(), error))))
    };
    let (bytes, refused) = load(&args.curve)?;
    let curve = Curve::from_json_slice(&bytes).map_err(refused)?;
    let (bytes, refused) = load(&args.certificate)?;
    let certificate = Certificate::decode(&bytes).map_err(refused)?;
    let claim = match &args.answer {
        None => certificate.claim(curve),
        Some(path) => {
            let (bytes, refused) = load(path)?;
            let root = reader::parse(&bytes).map_err(refused)?;
            answered(&root, curve).map_err(|(key, message)| {
                let help = "give a JSON answer that radius printed for this curve".to_string();
                let failure = Failure::new("answer", message, UNUSABLE);
                let file = Some(path.display().to_string());
                Box::new(Failure { file, key: Some(key), help: Some(help), ..failure })
            })?
        }
    };
    let verdict = verify(&claim, &certificate);
    let code = if verdict.is_ok() { DONE } else { REJECTED };
    Ok((if args.json { as_json(&claim, &verdict) } else { as_text(&claim, &verdict) }, code))
}

/// A key and what is wrong with its value.
type Wrong = (String, String);

fn wrong(key: &str, what: &str) -> Wrong {
    (key.to_string(), what.to_string())
}

/// The claim that a JSON answer of `radius` makes, exactly as its decimals are printed.
fn answered(root: &Node, curve: Curve) -> Result<Claim, Wrong> {
    if !matches!(member(root, "command")?, Value::String(command) if command == "radius") {
        return Err(wrong("command", "this is no answer of radius"));
    }
    if !matches!(member(root, "curve.digest")?, Value::String(digest) if *digest == curve.digest()) {
        return Err(wrong("curve.digest", "the answer is about another curve"));
    }
    let bound = |key| match member(root, key)? {
        Value::Null => Ok(None),
        Value::Number(text) => parse_rational(text).map(Some).map_err(|error| wrong(key, &error.message)),
        _ => Err(wrong(key, "the bound is neither a number nor null")),
    };
    let (lo, hi) = (bound("delta.lo")?, bound("delta.hi")?);
    Ok(Claim { curve, lo, hi })
}

/// The value under keys parted by points.
fn member<'a, 'b>(root: &'b Node<'a>, path: &str) -> Result<&'b Value<'a>, Wrong> {
    path.split('.').try_fold(&root.value, |value, key| {
        let Value::Object(members) = value else { return Err(wrong(path, "the key is missing")) };
        let found = members.iter().find(|(found, _)| found.text == key);
        found.map(|(_, node)| &node.value).ok_or_else(|| wrong(path, "the key is missing"))
    })
}

/// A decimal if it is one, else a fraction.
fn text(x: &Rational) -> String {
    decimal_text(x).unwrap_or_else(|| to_fraction_text(x))
}

/// A decimal if it is one, else a fraction in quotes; `None` is null.
#[derive(Serialize)]
#[serde(untagged)]
enum Bound {
    Decimal(Box<RawValue>),
    Fraction(String),
}

fn bound(x: Option<&Rational>) -> Option<Bound> {
    let x = x?;
    let decimal = decimal_text(x).and_then(|text| RawValue::from_string(text).ok());
    Some(decimal.map_or_else(|| Bound::Fraction(to_fraction_text(x)), Bound::Decimal))
}

#[derive(Serialize)]
struct Verdict {
    verdict: &'static str,
    claim: ClaimData,
    reason: Option<String>,
}

#[derive(Serialize)]
struct ClaimData {
    kind: &'static str,
    curve_digest: String,
    lo: Option<Bound>,
    hi: Option<Bound>,
}

fn as_json(claim: &Claim, verdict: &Result<Verified, Rejection>) -> String {
    let data = Verdict {
        verdict: if verdict.is_ok() { "verified" } else { "rejected" },
        claim: ClaimData {
            kind: "radius",
            curve_digest: claim.curve.digest(),
            lo: bound(claim.lo.as_ref()),
            hi: bound(claim.hi.as_ref()),
        },
        reason: verdict.as_ref().err().map(ToString::to_string),
    };
    json::answer("verify", &claim.curve, data)
}

fn as_text(claim: &Claim, verdict: &Result<Verified, Rejection>) -> String {
    let number = |x: &Option<Rational>| x.as_ref().map_or("infinity".to_string(), text);
    let unit = claim.curve.unit().map_or("file units".to_string(), plain);
    let delta = format!("delta = {} .. {}        ({unit})\n", number(&claim.lo), number(&claim.hi));
    match verdict {
        Err(rejection) => format!(
            "rejected: {delta}the certificate does not prove this: {rejection}\n\
             this says nothing about whether it is true\n"
        ),
        Ok(verified) => {
            let leaves: Vec<String> = verified.leaves().iter().map(|(rule, count)| format!("{count} {rule}")).collect();
            format!(
                "verified: {delta}{}\nevidence: {}, all of it evaluated in integers\n",
                meaning(verified),
                leaves.join(", ")
            )
        }
    }
}

fn meaning(verified: &Verified) -> String {
    let spine = if verified.closed() { "closed" } else { "open" };
    let below = match &verified.claim().lo {
        None => "every radius".to_string(),
        Some(lo) => format!("every radius below {}", text(lo)),
    };
    let above = match &verified.claim().hi {
        None => String::new(),
        Some(hi) => format!("; no radius above {} is", text(hi)),
    };
    format!("on this {spine} spine {below} is free of self-intersection{above}")
}
