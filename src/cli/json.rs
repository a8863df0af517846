//! The JSON answers: one line, keys in the order of the contract.

use serde::Serialize;
use tubecert::Curve;

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
    error: &'a Failure,
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
    line(&FailureAnswer { schema: SCHEMA, error: failure })
}

fn line(value: &impl Serialize) -> String {
    // no map here has keys other than strings, and no number text is not JSON: writing to memory cannot fail
    serde_json::to_string(value).expect("an answer is JSON") + "\n"
}
