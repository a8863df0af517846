//! The JSON answers: one line, keys in the order of the contract.

use serde::Serialize;
#[cfg(feature = "search")]
use serde::ser::{Error as _, SerializeStruct, Serializer};
#[cfg(feature = "search")]
use serde_json::value::RawValue;
use tubecert::Curve;
#[cfg(feature = "search")]
use tubecert::Enclosure;
#[cfg(feature = "search")]
use tubecert::number::{lower_text, upper_text};

use super::Failure;

const SCHEMA: u8 = 1;

#[derive(serde::Serialize)]
struct Answer<'a, T> {
    schema: u8,
    command: &'static str,
    tubecert: &'static str,
    curve: CurveName<'a>,
    unit: Option<&'a str>,
    #[serde(flatten)]
    data: T,
}

#[derive(serde::Serialize)]
struct CurveName<'a> {
    name: Option<&'a str>,
    digest: String,
}

#[derive(serde::Serialize)]
struct FailureAnswer<'a> {
    schema: u8,
    #[cfg(feature = "search")]
    #[serde(flatten)]
    origin: Option<&'a Origin<'a>>,
    error: &'a Failure,
}

/// Which line of which file a record of a batch is about.
#[cfg(feature = "search")]
#[derive(serde::Serialize)]
pub struct Origin<'a> {
    /// As it is spelled.
    pub id: Option<&'a RawValue>,
    pub file: &'a str,
    /// From 1.
    pub line: u64,
}

pub fn answer(command: &'static str, curve: &Curve, data: impl Serialize) -> String {
    line(&Answer {
        schema: SCHEMA,
        command,
        tubecert: env!("CARGO_PKG_VERSION"),
        curve: CurveName { name: curve.name(), digest: curve.digest() },
        unit: curve.unit(),
        data,
    })
}

pub fn failure(failure: &Failure) -> String {
    line(&FailureAnswer {
        schema: SCHEMA,
        #[cfg(feature = "search")]
        origin: None,
        error: failure,
    })
}

#[cfg(feature = "search")]
pub fn failed_record(origin: &Origin, failure: &Failure) -> String {
    line(&FailureAnswer { schema: SCHEMA, origin: Some(origin), error: failure })
}

/// The answer of a command, and as its last keys the origin.
#[cfg(feature = "search")]
pub fn record(origin: &Origin, answer: &str) -> String {
    let open = answer.trim_end().strip_suffix('}').unwrap_or(answer);
    format!("{open},{}", line(origin).trim_start_matches('{'))
}

fn line(value: &impl Serialize) -> String {
    // no map here has keys other than strings, and no number text is not JSON: writing to memory cannot fail
    serde_json::to_string(value).expect("an answer is JSON") + "\n"
}

/// `{"lo", "hi"}`, each true as the decimal that is printed and as its nearest f64; `null` is +infinity.
#[cfg(feature = "search")]
pub struct E(pub Enclosure);

#[cfg(feature = "search")]
impl Serialize for E {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let raw = |text: String| RawValue::from_string(text).map_err(S::Error::custom);
        let mut pair = serializer.serialize_struct("E", 2)?;
        pair.serialize_field("lo", &raw(lower_text(self.0.lo))?)?;
        pair.serialize_field("hi", &raw(upper_text(self.0.hi))?)?;
        pair.end()
    }
}

/// A number as it is spelled, or null.
#[cfg(feature = "search")]
pub fn raw(number: String) -> Box<RawValue> {
    RawValue::from_string(number).expect("the text of a number is JSON")
}

/// A decimal if it is one, else a fraction in quotes.
#[cfg(feature = "search")]
pub fn rational(x: &tubecert::Rational) -> Box<RawValue> {
    raw(tubecert::number::decimal_text(x).unwrap_or_else(|| format!("\"{}\"", tubecert::number::to_fraction_text(x))))
}
