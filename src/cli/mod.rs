//! The command line: arguments in, text or JSON and an exit code out. It proves nothing by itself.

mod answer;
mod args;
#[cfg(feature = "search")]
mod batch;
#[cfg(feature = "search")]
mod check;
#[cfg(feature = "search")]
mod curvature;
#[cfg(feature = "search")]
mod enclosed;
#[cfg(feature = "search")]
mod job;
mod json;
#[cfg(feature = "search")]
mod pairs;
#[cfg(feature = "search")]
mod polyline;
#[cfg(feature = "search")]
mod radius;
#[cfg(feature = "search")]
mod squares;
mod text;
mod verify;
mod vertices;

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser};
use tubecert::number::MAX_BYTES;
use tubecert::{Error, ErrorKind};

use args::{Args, Command};

const DONE: u8 = 0;
const REJECTED: u8 = 1;
const UNUSABLE: u8 = 2;
const UNDECIDED: u8 = 3;
const NO_CLAIM: u8 = 4;

/// Why there is no answer: the fields of the JSON error, and the exit code.
#[derive(Debug, serde::Serialize)]
struct Failure {
    kind: &'static str,
    file: Option<String>,
    key: Option<String>,
    index: Option<usize>,
    message: String,
    help: Option<String>,
    /// The byte in the file.
    offset: Option<usize>,
    #[serde(skip)]
    code: u8,
}

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    let args = match Args::try_parse_from(&words) {
        Ok(args) => args,
        Err(error) if error.use_stderr() && asks_for_json(&words) => return fail(&Failure::usage(&error), true),
        Err(error) => {
            let code = if error.use_stderr() { UNUSABLE } else { DONE };
            return finish(error.print(), code);
        }
    };
    match args.command {
        #[cfg(feature = "search")]
        Command::Radius(args) => say(job::on_threads(&args.common, || radius::run(&args)), args.common.json),
        #[cfg(feature = "search")]
        Command::Curvature(args) => say(job::on_threads(&args.common, || curvature::run(&args)), args.common.json),
        #[cfg(feature = "search")]
        Command::Pairs(args) => say(job::on_threads(&args.common, || pairs::run(&args)), args.common.json),
        #[cfg(feature = "search")]
        Command::Squares(args) => say(job::on_threads(&args.common, || squares::run(&args)), args.common.json),
        #[cfg(feature = "search")]
        Command::Polyline(args) => say(job::on_threads(&args.common, || polyline::run(&args)), args.common.json),
        #[cfg(feature = "search")]
        Command::Batch(args) => batch::run(&args),
        #[cfg(feature = "search")]
        Command::Check(args) => say(job::on_threads(&args.common, || check::run(&args)), args.common.json),
        Command::Verify(args) => say(verify::run(&args), args.json),
        Command::Completions { shell } => {
            // into memory first: the generators panic where they cannot write
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Args::command(), "tubecert", &mut script);
            print(&String::from_utf8_lossy(&script), DONE)
        }
    }
}

/// The bytes of a file, never more than are allowed.
fn read(path: &Path, file: &str) -> Result<Vec<u8>, Box<Failure>> {
    let unreadable = |error: io::Error| Failure::unreadable(file, &error);
    let most = MAX_BYTES as u64;
    let (mut bytes, mut length) = (Vec::new(), 0);
    if path == Path::new("-") {
        io::stdin().lock().take(most + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    } else {
        let opened = File::open(path).map_err(unreadable)?;
        length = opened.metadata().map_err(unreadable)?.len();
        if length <= most {
            // more than its length: pipes and devices have the length 0
            opened.take(most + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        }
    }
    if length.max(bytes.len() as u64) > most {
        return Err(Failure::too_long("file", file));
    }
    Ok(bytes)
}

impl Failure {
    fn new(kind: &'static str, message: String, code: u8) -> Self {
        Self { kind, file: None, key: None, index: None, message, help: None, offset: None, code }
    }

    fn of(file: String, error: Error) -> Self {
        let code = match error.kind {
            ErrorKind::Rounding => NO_CLAIM,
            ErrorKind::Impossible => REJECTED,
            _ => UNUSABLE,
        };
        let help = Some(error.help).filter(|help| !help.is_empty());
        let Error { kind, key, index, offset, message, .. } = error;
        Self { kind: kind.word(), file: Some(file), key, index, message, help, offset, code }
    }

    fn in_file(file: &str, kind: ErrorKind, message: String, help: &str) -> Box<Self> {
        let file = Some(file.to_string());
        Box::new(Self { file, help: Some(help.to_string()), ..Self::new(kind.word(), message, UNUSABLE) })
    }

    fn unreadable(file: &str, error: &io::Error) -> Box<Self> {
        let help = "give a readable file, or - for standard input";
        Self::in_file(file, ErrorKind::Io, format!("the file cannot be read: {error}"), help)
    }

    /// `what`: the file, or a line of it.
    fn too_long(what: &str, file: &str) -> Box<Self> {
        let message = format!("the {what} has more than {MAX_BYTES} bytes, the limit MAX_BYTES");
        Self::in_file(file, ErrorKind::Limit, message, "cut the curve into several files")
    }

    /// What clap cannot say of an option.
    #[cfg(feature = "search")]
    fn option(key: &str, message: &str) -> Box<Self> {
        let help = Some("see --help of the command".to_string());
        Box::new(Self { key: Some(key.to_string()), help, ..Self::new("usage", message.to_string(), UNUSABLE) })
    }

    /// What clap says: a first paragraph, then advice.
    fn usage(error: &clap::Error) -> Self {
        let text = error.to_string();
        let (message, help) = text.split_once("\n\n").unwrap_or((&text, ""));
        let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let key = match error.get(ContextKind::InvalidArg) {
            Some(ContextValue::String(arg)) => arg.split_whitespace().next().map(str::to_string),
            _ => None,
        };
        let message = one_line(message.trim_start_matches("error: "));
        Self { key, help: Some(one_line(help)), ..Self::new("usage", message, UNUSABLE) }
    }
}

fn asks_for_json(words: &[OsString]) -> bool {
    words.iter().take_while(|word| *word != "--").any(|word| word == "--json")
}

/// An answer and its exit code.
type Said = Result<(String, u8), Box<Failure>>;

fn say(said: Said, as_json: bool) -> ExitCode {
    match said {
        Ok((text, code)) => print(&text, code),
        Err(failure) => fail(&failure, as_json),
    }
}

fn fail(failure: &Failure, as_json: bool) -> ExitCode {
    if as_json {
        return print(&json::failure(failure), failure.code);
    }
    complain(failure);
    ExitCode::from(failure.code)
}

/// On stderr; there is nobody left to tell if that fails.
fn complain(failure: &Failure) {
    let _ = io::stderr().write_all(text::failure(failure).as_bytes());
}

fn print(text: &str, code: u8) -> ExitCode {
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    finish(written, code)
}

/// A closed pipe ends quietly; any other failure to write means that nothing was said.
fn finish(written: io::Result<()>, code: u8) -> ExitCode {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            let message = format!("the answer cannot be written: {error}");
            let help = Some("write to another place; what was printed so far claims nothing".to_string());
            complain(&Failure { help, ..Failure::new(ErrorKind::Io.word(), message, NO_CLAIM) });
            ExitCode::from(NO_CLAIM)
        }
        _ => ExitCode::from(code),
    }
}
