//! The command `verify`.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

use serde::Serialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde_json::value::RawValue;
use tubecert::certificate::Certificate;
use tubecert::check::{Rejection, Verified, verify};
use tubecert::claim::Claim;
use tubecert::number::{Rational, decimal_text, parse_rational, to_fraction_text};
use tubecert::{Curve, ErrorKind};

use super::args::VerifyArgs;
use super::text::plain;
use super::{DONE, Failure, REJECTED, Said, UNDECIDED, UNUSABLE, json, read};

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
            let (bytes, _) = load(path)?;
            answered(&bytes, curve).map_err(|Wrong { kind, key, message }| {
                let help = "give a JSON answer that radius printed for this curve".to_string();
                let file = Some(path.display().to_string());
                Box::new(Failure { file, key, help: Some(help), ..Failure::new(kind, message, UNUSABLE) })
            })?
        }
    };
    let verdict = within(args.budget, &claim, certificate);
    let code = match &verdict {
        Verdict::Verified(_) => DONE,
        Verdict::Rejected(_) => REJECTED,
        Verdict::Undecided(_) => UNDECIDED,
    };
    Ok((if args.json { as_json(&claim, &verdict) } else { as_text(&claim, &verdict) }, code))
}

#[allow(clippy::large_enum_variant, reason = "there is one")]
enum Verdict {
    Verified(Verified),
    Rejected(Rejection),
    /// After so long.
    Undecided(Duration),
}

impl Verdict {
    fn of(verdict: Result<Verified, Rejection>) -> Self {
        verdict.map_or_else(Self::Rejected, Self::Verified)
    }
}

/// The verdict, or none if it takes longer.
fn within(budget: Option<Duration>, claim: &Claim, certificate: Certificate) -> Verdict {
    let Some(limit) = budget else { return Verdict::of(verify(claim, &certificate)) };
    let (owned, (sender, receiver)) = (claim.clone(), std::sync::mpsc::channel());
    let replay = std::thread::spawn(move || drop(sender.send(verify(&owned, &certificate))));
    match receiver.recv_timeout(limit) {
        Ok(verdict) => Verdict::of(verdict),
        // the thread ends with the process
        Err(RecvTimeoutError::Timeout) => Verdict::Undecided(limit),
        // a panic ended the thread: it goes on here
        Err(RecvTimeoutError::Disconnected) => match replay.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => Verdict::Undecided(limit),
        },
    }
}

/// What is wrong with an answer, and at which key.
struct Wrong {
    kind: &'static str,
    key: Option<String>,
    message: String,
}

fn wrong(key: &str, what: impl fmt::Display) -> Wrong {
    Wrong { kind: "answer", key: Some(key.to_string()), message: what.to_string() }
}

/// The claim that a JSON answer of `radius` makes, exactly as its decimals are printed.
fn answered(bytes: &[u8], curve: Curve) -> Result<Claim, Wrong> {
    let root: &RawValue = serde_json::from_slice(bytes).map_err(|error| Wrong {
        kind: ErrorKind::Syntax.word(),
        key: None,
        message: format!("the answer is not JSON: {error}"),
    })?;
    if string(root, "command")?.as_deref() != Some("radius") {
        return Err(wrong("command", "this is no answer of radius"));
    }
    if string(root, "curve.digest")? != Some(curve.digest()) {
        return Err(wrong("curve.digest", "the answer is about another curve"));
    }
    if member(root, "schema")? != "1" {
        return Err(wrong("schema", "this version reads answers of schema 1"));
    }
    let bound = |key| match member(root, key)? {
        "null" => Ok(None),
        text if text.starts_with(['-', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9']) => {
            parse_rational(text).map(Some).map_err(|error| wrong(key, error.message))
        }
        _ => Err(wrong(key, "the bound is neither a number nor null")),
    };
    let (lo, hi) = (bound("delta.lo")?, bound("delta.hi")?);
    Ok(Claim { curve, lo, hi })
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
struct VerdictData {
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

fn as_json(claim: &Claim, verdict: &Verdict) -> String {
    let (word, reason) = match verdict {
        Verdict::Verified(_) => ("verified", None),
        Verdict::Rejected(rejection) => ("rejected", Some(rejection.to_string())),
        Verdict::Undecided(limit) => ("undecided", Some(too_long(*limit))),
    };
    let data = VerdictData {
        verdict: word,
        claim: ClaimData {
            kind: "radius",
            curve_digest: claim.curve.digest(),
            lo: bound(claim.lo.as_ref()),
            hi: bound(claim.hi.as_ref()),
        },
        reason,
    };
    json::answer("verify", &claim.curve, data)
}

fn too_long(limit: Duration) -> String {
    format!("it takes more than {} seconds; raise --budget", limit.as_secs_f64())
}

fn as_text(claim: &Claim, verdict: &Verdict) -> String {
    let number = |x: &Option<Rational>| x.as_ref().map_or("infinity".to_string(), text);
    let unit = claim.curve.unit().map_or("file units".to_string(), plain);
    let delta = format!("delta = {} .. {}        ({unit})\n", number(&claim.lo), number(&claim.hi));
    match verdict {
        Verdict::Rejected(rejection) => format!(
            "rejected: {delta}the certificate does not prove this: {rejection}\n\
             this says nothing about whether it is true\n"
        ),
        Verdict::Undecided(limit) => format!("undecided: {delta}{}\n", too_long(*limit)),
        Verdict::Verified(verified) => {
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
