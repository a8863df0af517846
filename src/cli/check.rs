//! The command `check`.

use tubecert::{Check, CheckOptions, PolylineWitness, Statement, Verdict};

use super::args::CheckArgs;
use super::enclosed::nearest;
use super::enclosed::{bounds, near, parameter_places};
use super::job::Job;
use super::json::{self, E};
use super::text::unit;
use super::vertices::vertices;
use super::{DONE, REJECTED, Said, UNDECIDED};

pub fn run(args: &CheckArgs) -> Said {
    let common = &args.common;
    let job = Job::load(common)?;
    let vertices = vertices(&args.polyline)?;
    let options = CheckOptions::new()
        .rel_width(common.limits.rel_width)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer =
        job.done(tubecert::check(&job.spine, &vertices, args.tolerance, &options)).map_err(|mut failure| {
            if failure.key.as_deref() == Some("vertices") {
                failure.file = Some(args.polyline.display().to_string());
            }
            failure
        })?;
    if let Some(claim) = &answer.claim {
        job.certify(answer.certificate.as_ref(), Statement::Polyline(claim.clone()))?;
    }
    let code = match answer.verdict {
        Verdict::Certified => DONE,
        Verdict::Refuted => REJECTED,
        _ => UNDECIDED,
    };
    Ok((if common.json { as_json(&job, &answer) } else { as_text(&job, &answer, args.tolerance) }, code))
}

#[derive(serde::Serialize)]
struct CheckData {
    verdict: &'static str,
    distance: E,
    reason: &'static str,
    witness: Option<WitnessData>,
}

#[derive(serde::Serialize)]
struct WitnessData {
    kind: &'static str,
    edge: Option<usize>,
    t: Option<E>,
    point: Option<[E; 3]>,
}

fn as_json(job: &Job, answer: &Check) -> String {
    let witness = |w: &PolylineWitness| WitnessData {
        kind: w.kind,
        edge: w.edge,
        t: w.t.map(E),
        point: w.point.map(|p| p.map(E)),
    };
    let witness = answer.witness.as_ref().map(witness);
    let data =
        CheckData { verdict: answer.verdict.word(), distance: E(answer.distance), reason: answer.reason, witness };
    json::answer("check", job.spine.curve(), data)
}

fn as_text(job: &Job, answer: &Check, tolerance: f64) -> String {
    let unit = unit(job.spine.curve());
    let place = answer.witness.as_ref().map_or(String::new(), |witness| {
        let point = witness.point.map(|p| format!(" ({})", p.each_ref().map(|x| near(x, 10)).join(", ")));
        let places = parameter_places(job.spine.curve());
        let t = witness.t.map(|t| format!(", at t = {}", nearest(t.lo.midpoint(t.hi), places)));
        let edge = witness.edge.map(|edge| format!(" on edge {edge}"));
        format!("{}{}{}", point.unwrap_or_default(), edge.unwrap_or_default(), t.unwrap_or_default())
    });
    match answer.verdict {
        Verdict::Certified => {
            let (_, most) = bounds(&answer.distance);
            format!("certified: Frechet distance <= {most}        ({unit})\nisotopic to the spine inside its tube\n")
        }
        Verdict::Refuted => {
            let why = match answer.reason {
                "farther_than_tolerance" => {
                    format!("a point of the polyline{place} is farther than {tolerance:e} from all of the spine")
                }
                "leaves_tube" => format!("a point of the polyline{place} is farther than delta from all of the spine"),
                "spine_passed_over" => {
                    format!("a point of the spine{place} is farther than {tolerance:e} from all edges")
                }
                "doubles_back" => {
                    format!("the polyline does not run through the normal disks in the order of the spine:{place}")
                }
                _ => "delta is 0: the spine has no tube".to_string(),
            };
            format!("refuted: {why}        ({unit})\n")
        }
        _ => {
            let why = match answer.reason {
                "no_order" => {
                    "its vertices do not follow one another along the spine, as far as the search saw".to_string()
                }
                "edge_not_proved" => format!("an edge was not proved:{place}"),
                "end_not_covered" => {
                    "an end of the spine is not covered, or an end of the polyline lies too far beyond it; move it onto the end"
                        .to_string()
                }
                _ => format!("the limits ended the search, or delta may be 0; {}", job.limit(answer.stopped)),
            };
            format!("undecided: {why}        ({unit})\nthis says nothing about whether it is near or isotopic\n")
        }
    }
}
