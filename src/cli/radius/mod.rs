//! The command `radius`.

mod json;
mod text;

use tubecert::number::{lower_text, parse_rational, upper_text};
use tubecert::{Enclosure, Radius, RadiusOptions, Statement};

use super::args::RadiusArgs;
use super::job::Job;
use super::{DONE, Said, UNDECIDED};

pub fn run(args: &RadiusArgs) -> Said {
    answer(&Job::load(&args.common)?, args)
}

pub fn answer(job: &Job, args: &RadiusArgs) -> Said {
    let common = &args.common;
    let options = RadiusOptions::new()
        .rel_width(common.limits.rel_width)
        .all_terms(args.terms.all_terms)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer = printable(job.done(tubecert::radius(&job.spine, &options))?);
    let bound = |text: String| parse_rational(&text).ok();
    let (lo, hi) = (bound(lower_text(answer.delta.lo)), bound(upper_text(answer.delta.hi)));
    job.certify(answer.certificate.as_ref(), Statement::Radius { lo, hi })?;
    let code = if answer.complete { DONE } else { UNDECIDED };
    let text = if common.json { json::radius(&job.spine, &answer) } else { text::radius(job, &answer, args) };
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
