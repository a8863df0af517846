//! The command `pairs`.

use tubecert::claim;
use tubecert::number::{lower_text, parse_rational, upper_text};
use tubecert::{Enclosure, Pairs, PairsOptions, Statement, StationaryPair};

use super::args::PairsArgs;
use super::enclosed::{floor_log10, nearest, parameter_places, relation};
use super::job::Job;
use super::json::{self, E};
use super::text::unit;
use super::{DONE, Said, UNDECIDED};

pub fn run(args: &PairsArgs) -> Said {
    answer(&Job::load(&args.common)?, args)
}

pub fn answer(job: &Job, args: &PairsArgs) -> Said {
    let common = &args.common;
    let options = PairsOptions::new()
        .rel_width(common.limits.rel_width)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer = job.done(tubecert::pairs(&job.spine, &options))?;
    if common.certificate.is_some() {
        job.certify(answer.certificate.as_ref(), Statement::Pairs(claimed(&answer)))?;
    }
    let code = if answer.complete && answer.narrow { DONE } else { UNDECIDED };
    let text = if common.json { as_json(job, &answer) } else { as_text(job, &answer) };
    Ok((text, code))
}

/// What is claimed by what will be printed.
fn claimed(answer: &Pairs) -> claim::Pairs {
    // a place below every f64 is printed as null, which no certificate proves
    let number = |text: String| parse_rational(&text).unwrap_or_default();
    let range = |e: &Enclosure| [number(lower_text(e.lo)), number(upper_text(e.hi))];
    let one = |pair: &StationaryPair| {
        let hi = upper_text(pair.distance.hi);
        let distance = (number(lower_text(pair.distance.lo)), parse_rational(&hi).ok());
        claim::PairBox { s: range(&pair.s), t: range(&pair.t), distance }
    };
    claim::Pairs {
        pairs: answer.pairs.iter().map(one).collect(),
        undecided: answer.undecided.iter().map(one).collect(),
    }
}

#[derive(serde::Serialize)]
struct PairsData {
    pairs: Vec<PairData>,
    undecided: Vec<PairData>,
    complete: bool,
}

#[derive(serde::Serialize)]
struct PairData {
    s: E,
    t: E,
    distance: E,
    #[serde(skip_serializing_if = "Option::is_none")]
    unique: Option<bool>,
}

fn as_json(job: &Job, answer: &Pairs) -> String {
    let data = |pairs: &[StationaryPair], unique| {
        let data = |pair: &StationaryPair| PairData { s: E(pair.s), t: E(pair.t), distance: E(pair.distance), unique };
        pairs.iter().map(data).collect()
    };
    let (pairs, undecided) = (data(&answer.pairs, Some(true)), data(&answer.undecided, None));
    json::answer("pairs", job.spine.curve(), PairsData { pairs, undecided, complete: answer.complete })
}

fn as_text(job: &Job, answer: &Pairs) -> String {
    let count = |n: usize| match n {
        1 => "1 stationary pair".to_string(),
        n => format!("{n} stationary pairs"),
    };
    let all = if answer.complete { "proved to be all" } else { "and what is undecided" };
    let mut lines = vec![format!("{}, {all}        ({})", count(answer.pairs.len()), unit(job.spine.curve()))];
    let places = parameter_places(job.spine.curve());
    // rounded; the JSON encloses them
    let middle = |e: &Enclosure| nearest(e.lo.midpoint(e.hi), places);
    for pair in &answer.pairs {
        lines.push(format!(
            "  s = {}, t = {}: distance {}",
            middle(&pair.s),
            middle(&pair.t),
            relation(&pair.distance)
        ));
    }
    if !answer.undecided.is_empty() {
        lines.push("undecided: every other stationary pair lies in one of these".to_string());
        let range = |e: &Enclosure| {
            // as many digits as tell the ends apart
            let places = places.max(2 - floor_log10(e.hi - e.lo));
            format!("{} .. {}", nearest(e.lo, places), nearest(e.hi, places))
        };
        for cell in &answer.undecided {
            let distance = relation(&cell.distance);
            lines.push(format!("  s = {}, t = {}: distance {distance}", range(&cell.s), range(&cell.t)));
        }
    }
    if let Some(help) = advice(job, answer) {
        lines.push(format!("help: {help}"));
    }
    lines.join("\n") + "\n"
}

fn advice(job: &Job, answer: &Pairs) -> Option<String> {
    let true_all_the_same = "what is printed is true all the same; to have it";
    if answer.stopped.is_some() {
        return Some(format!("{true_all_the_same} complete, {}", job.limit(answer.stopped)));
    }
    if !answer.complete {
        return Some(
            "whole curves of pairs (circles, parallel strands), multiple pairs and corners stay undecided; \
             the least distance is enclosed by radius all the same"
                .to_string(),
        );
    }
    let touching = |pair: &StationaryPair| pair.distance.lo == 0.0 && pair.distance.hi > 0.0;
    if answer.pairs.iter().any(touching) {
        return Some("the spine may touch itself where the distance is from 0 on; ask radius".to_string());
    }
    (!answer.narrow).then(|| format!("{true_all_the_same} as narrow as asked, {}", job.limit(None)))
}
