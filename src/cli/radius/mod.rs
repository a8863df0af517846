//! The command `radius`.

mod json;
mod text;

use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use tubecert::number::{lower_text, parse_rational, upper_text};
use tubecert::{Certificate, Claim, Curve, Enclosure, ErrorKind, Radius, RadiusOptions, Spine, verify};

use super::args::RadiusArgs;
use super::{DONE, Failure, NO_CLAIM, Said, UNDECIDED, read};

pub fn run(args: &RadiusArgs) -> Said {
    let start = Instant::now();
    let file = args.curve.display().to_string();
    let refused = |error| Box::new(Failure::of(file.clone(), error));
    let bytes = read(&args.curve, &file)?;
    let spine = Curve::from_json_slice(&bytes).and_then(Spine::from_curve).map_err(refused)?;
    drop(bytes);

    // drawn on a terminal only, and first after a second
    let bar = ProgressBar::no_length();
    bar.set_style(
        ProgressStyle::with_template("{spinner} {human_pos} cells").unwrap_or(ProgressStyle::default_spinner()),
    );
    let shown = bar.clone();
    let progress = move |cells| {
        if start.elapsed() > Duration::from_secs(1) {
            shown.set_position(cells);
        }
    };
    let mut options = RadiusOptions::new()
        .rel_width(args.rel_width)
        .all_terms(args.all_terms)
        .certificate(args.certificate.is_some())
        .max_cells(args.max_cells)
        .progress(progress);
    if let Some(limit) = args.budget {
        options = options.budget(limit.saturating_sub(start.elapsed()));
    }
    let answer = tubecert::radius(&spine, &options);
    bar.finish_and_clear();

    let answer = printable(answer.map_err(refused)?);
    if let Some(path) = &args.certificate {
        let curve = spine.curve().clone();
        replayed(&answer, curve).and_then(|text| written(path, &text)).map_err(|message| {
            let width = format!("raise --rel-width (now {:e}), wider bounds need less", args.rel_width);
            let help = Some(format!("nothing is claimed: {width}; or run without --certificate"));
            let file = Some(path.display().to_string());
            Box::new(Failure { file, help, ..Failure::new(ErrorKind::Certificate.word(), message, NO_CLAIM) })
        })?;
    }
    let code = if answer.complete { DONE } else { UNDECIDED };
    let text = if args.json { json::radius(&spine, &answer) } else { text::radius(&spine, &answer, args) };
    Ok((text, code))
}

/// The text of the certificate, once the checker has verified exactly what will be printed.
fn replayed(answer: &Radius, curve: Curve) -> Result<String, String> {
    let certificate = answer.certificate.as_ref().ok_or("the evidence is too long to be written")?;
    let text = certificate.encode();
    let bound = |text: String| parse_rational(&text).ok();
    let (lo, hi) = (bound(lower_text(answer.delta.lo)), bound(upper_text(answer.delta.hi)));
    let certificate = Certificate::decode(text.as_bytes()).map_err(|error| error.to_string())?;
    let verdict = verify(&Claim { curve, lo, hi }, &certificate);
    verdict.map(|_| text).map_err(|rejection| format!("the checker rejects the answer: {rejection}"))
}

fn written(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("the certificate cannot be written: {error}"))
}

/// Without places below every f64: the format has no -infinity.
fn printable(mut answer: Radius) -> Radius {
    let bounded = |e: &Enclosure| e.lo > f64::NEG_INFINITY;
    answer.at = answer.at.filter(|at| bounded(&at.t) && at.s.as_ref().is_none_or(bounded));
    if let Some(at) = &mut answer.at {
        at.x = at.x.filter(|x| x.iter().all(bounded));
    }
    answer
}
