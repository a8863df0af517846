//! The command `radius`.

mod json;
mod text;

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use tubecert::{Curve, Enclosure, Radius, RadiusOptions, Spine};

use super::args::RadiusArgs;
use super::{DONE, Failure, Said, UNDECIDED, read};

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
        .max_cells(args.max_cells)
        .progress(progress);
    if let Some(limit) = args.budget {
        options = options.budget(limit.saturating_sub(start.elapsed()));
    }
    let answer = tubecert::radius(&spine, &options);
    bar.finish_and_clear();

    let answer = printable(answer.map_err(refused)?);
    let code = if answer.complete { DONE } else { UNDECIDED };
    let text = if args.json { json::radius(&spine, &answer) } else { text::radius(&spine, &answer, args) };
    Ok((text, code))
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
