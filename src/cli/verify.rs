//! The command `verify`.

use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

use serde::Serialize;
use serde_json::value::RawValue;
use tubecert::certificate::Certificate;
use tubecert::check::{Rejection, Verified, verify};
use tubecert::claim::{Bounds, Claim, CriticalPoints, PairBox, Pairs, Polyline, RootBox, Statement, TwoSquares};
use tubecert::number::{Rational, decimal_text, to_fraction_text};
use tubecert::{Curve, ErrorKind};

use super::answer::{self, Wrong};
use super::args::VerifyArgs;
use super::text::unit;
use super::vertices::{same, vertices};
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
            let statement = answer::statement(&bytes, &curve).map_err(|Wrong { kind, key, message }| {
                let help = "give a JSON answer that was printed for this curve".to_string();
                let file = Some(path.display().to_string());
                Box::new(Failure { file, key, help: Some(help), ..Failure::new(kind, message, UNUSABLE) })
            })?;
            Claim { curve, statement }
        }
    };
    let claim = match &args.polyline {
        None if matches!(&claim.statement, Statement::Polyline(line) if line.vertices.is_empty()) => {
            let help = Some("give the polyline that was checked: --polyline FILE".to_string());
            let message = "the answer of check does not list its polyline".to_string();
            return Err(Box::new(Failure { help, ..Failure::new("usage", message, UNUSABLE) }));
        }
        None => claim,
        Some(path) => {
            let file = vertices(path)?;
            with_polyline(claim, file, &certificate).ok_or_else(|| {
                let help = Some("leave --polyline out, or give the certificate of polyline or check".to_string());
                let message = "the claim is not about this polyline".to_string();
                let file = Some(args.certificate.display().to_string());
                Box::new(Failure { file, help, ..Failure::new(ErrorKind::Option.word(), message, UNUSABLE) })
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

/// The claim about the polyline of a file, in the order of the certificate if that is the same one; `None` if it is about
/// another one.
fn with_polyline(claim: Claim, file: Vec<[Rational; 3]>, certificate: &Certificate) -> Option<Claim> {
    let Claim { curve, statement: Statement::Polyline(claimed) } = claim else { return None };
    let Statement::Polyline(proved) = certificate.claim(curve.clone()).statement else { return None };
    // the answer of `check` lists no vertices
    let listed = !claimed.vertices.is_empty();
    if listed && claimed.vertices != proved.vertices && !same(&claimed.vertices, &file, claimed.closed) {
        return None;
    }
    let closed = if listed { claimed.closed } else { proved.closed };
    let vertices = if same(&proved.vertices, &file, proved.closed) { proved.vertices } else { file };
    Some(Claim { curve, statement: Statement::Polyline(Polyline { vertices, closed, ..claimed }) })
}

#[allow(clippy::large_enum_variant, reason = "there is one")]
pub enum Verdict {
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
pub fn within(budget: Option<Duration>, claim: &Claim, certificate: Certificate) -> Verdict {
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
    #[serde(flatten)]
    statement: StatementData,
}

/// The statement, as its command spells it.
#[derive(Serialize)]
#[serde(untagged)]
enum StatementData {
    Radius(Range),
    Curvature { kappa_max: Range, at: Range, critical_points: Vec<PointData>, constant: Vec<StretchData> },
    Squares { segments: Vec<SegmentData> },
    Polyline { vertices: usize, distance: Range },
    Pairs { pairs: Vec<PairData>, undecided: Vec<PairData>, complete: bool },
}

#[derive(Serialize)]
struct Range {
    lo: Option<Bound>,
    hi: Option<Bound>,
}

#[derive(Serialize)]
struct PointData {
    t: Range,
    kappa: Range,
    kind: Option<&'static str>,
    unique: bool,
}

#[derive(Serialize)]
struct StretchData {
    from: Option<Bound>,
    to: Option<Bound>,
    kappa: Range,
}

#[derive(Serialize)]
struct SegmentData {
    from: Option<Bound>,
    to: Option<Bound>,
    roots: Vec<RootData>,
    count: u128,
    decompositions: Vec<TwoSquaresData>,
}

#[derive(Serialize)]
struct RootData {
    re: Range,
    im: Range,
    multiplicity: usize,
}

#[derive(Serialize)]
struct TwoSquaresData {
    alpha: Vec<Range>,
    beta: Vec<Range>,
}

#[derive(Serialize)]
struct PairData {
    s: Range,
    t: Range,
    distance: Range,
}

impl StatementData {
    fn of(statement: &Statement) -> (&'static str, Self) {
        fn range(lo: Option<&Rational>, hi: Option<&Rational>) -> Range {
            Range { lo: bound(lo), hi: bound(hi) }
        }
        let pair = |pair: &PairBox| {
            let [s, t] = [&pair.s, &pair.t].map(|[lo, hi]| range(Some(lo), Some(hi)));
            PairData { s, t, distance: range(Some(&pair.distance.0), pair.distance.1.as_ref()) }
        };
        match statement {
            Statement::Radius { lo, hi } => ("radius", Self::Radius(range(lo.as_ref(), hi.as_ref()))),
            Statement::Curvature(claimed) => {
                let both = |[lo, hi]: &Bounds| range(lo.as_ref(), hi.as_ref());
                let points = claimed.points.iter().map(|point| PointData {
                    t: both(&point.t),
                    kappa: both(&point.kappa),
                    kind: point.kind.map(|kind| kind.word()),
                    unique: point.unique,
                });
                let constant = claimed.constant.iter().map(|stretch| StretchData {
                    from: bound(stretch.from.as_ref()),
                    to: bound(stretch.to.as_ref()),
                    kappa: both(&stretch.kappa),
                });
                let (kappa_max, at) = (both(&claimed.kappa_max), both(&claimed.at));
                let (critical_points, constant) = (points.collect(), constant.collect());
                ("curvature", Self::Curvature { kappa_max, at, critical_points, constant })
            }
            Statement::Squares(claimed) => {
                let both = |[lo, hi]: &[Rational; 2]| range(Some(lo), Some(hi));
                let root = |root: &RootBox| RootData {
                    re: both(&root.re),
                    im: both(&root.im),
                    multiplicity: root.multiplicity,
                };
                let two = |two: &TwoSquares| TwoSquaresData {
                    alpha: two.alpha.iter().map(both).collect(),
                    beta: two.beta.iter().map(both).collect(),
                };
                let segments = claimed.iter().map(|segment| SegmentData {
                    from: bound(Some(&segment.from)),
                    to: bound(Some(&segment.to)),
                    roots: segment.roots.iter().map(root).collect(),
                    count: segment.count,
                    decompositions: segment.decompositions.iter().map(two).collect(),
                });
                ("squares", Self::Squares { segments: segments.collect() })
            }
            Statement::Polyline(claimed) => {
                let distance = range(Some(&Rational::from_integer(0.into())), Some(&claimed.distance));
                ("polyline", Self::Polyline { vertices: claimed.vertices.len(), distance })
            }
            Statement::Pairs(claimed) => {
                let [pairs, undecided] = [&claimed.pairs, &claimed.undecided].map(|all| all.iter().map(pair).collect());
                ("pairs", Self::Pairs { pairs, undecided, complete: claimed.undecided.is_empty() })
            }
            other => unreachable!("a claim without words: {other:?}"),
        }
    }
}

fn as_json(claim: &Claim, verdict: &Verdict) -> String {
    let (word, reason) = match verdict {
        Verdict::Verified(_) => ("verified", None),
        Verdict::Rejected(rejection) => ("rejected", Some(rejection.to_string())),
        Verdict::Undecided(limit) => ("undecided", Some(too_long(*limit))),
    };
    let (kind, statement) = StatementData::of(&claim.statement);
    let data =
        VerdictData { verdict: word, claim: ClaimData { kind, curve_digest: claim.curve.digest(), statement }, reason };
    json::answer("verify", &claim.curve, data)
}

fn too_long(limit: Duration) -> String {
    format!("it takes more than {} seconds; raise --budget", limit.as_secs_f64())
}

fn as_text(claim: &Claim, verdict: &Verdict) -> String {
    let claimed = claimed(claim);
    match verdict {
        Verdict::Rejected(rejection) => format!(
            "rejected: {claimed}the certificate does not prove this: {rejection}\n\
             this says nothing about whether it is true\n"
        ),
        Verdict::Undecided(limit) => format!("undecided: {claimed}{}\n", too_long(*limit)),
        Verdict::Verified(verified) => {
            let leaves: Vec<String> = verified.leaves().iter().map(|(rule, count)| format!("{count} {rule}")).collect();
            format!(
                "verified: {claimed}{}evidence: {}, all of it evaluated in integers\n",
                meaning(verified),
                leaves.join(", ")
            )
        }
    }
}

/// The statement in a line or more.
fn claimed(claim: &Claim) -> String {
    let number = |x: &Option<Rational>| x.as_ref().map_or("infinity".to_string(), text);
    match &claim.statement {
        Statement::Radius { lo, hi } => {
            format!("delta = {} .. {}        ({})\n", number(lo), number(hi), unit(&claim.curve))
        }
        Statement::Curvature(CriticalPoints { kappa_max: [lo, hi], points, .. }) => {
            let alone = points.iter().filter(|point| point.unique).count();
            format!(
                "kappa_max = {} .. {}        (1 / {})\n{alone} critical points of curvature, each a simple zero or one joint; no other but in {} stretches\n",
                number(lo),
                number(hi),
                unit(&claim.curve),
                points.len() - alone
            )
        }
        Statement::Squares(segments) => {
            let roots: usize = segments.iter().map(|segment| segment.roots.len()).sum();
            let listed: usize = segments.iter().map(|segment| segment.decompositions.len()).sum();
            format!(
                "|C'|^2 has exactly {roots} complex roots on {} segments, each in a box claimed for it; {listed} decompositions into two squares\n\
                 the twists and their axes are not part of this claim\n",
                segments.len()
            )
        }
        Statement::Pairs(Pairs { pairs, undecided }) if undecided.is_empty() => {
            format!("the spine has exactly {} stationary pairs, one in each of the boxes claimed\n", pairs.len())
        }
        Statement::Pairs(Pairs { pairs, undecided }) => format!(
            "{} stationary pairs, one in each of the boxes claimed; all others lie in {} undecided boxes\n",
            pairs.len(),
            undecided.len()
        ),
        Statement::Polyline(Polyline { vertices, distance, .. }) => format!(
            "the polyline of {} vertices is isotopic to the spine in its tube, and within {} of it        ({})\n\
             parameters, the radius of the tube and numbers of edges needed are not part of this claim\n",
            vertices.len(),
            text(distance),
            unit(&claim.curve)
        ),
        _ => String::new(),
    }
}

/// What it means, where that is not said yet.
fn meaning(verified: &Verified) -> String {
    let Statement::Radius { lo, hi } = &verified.claim().statement else { return String::new() };
    let spine = if verified.closed() { "closed" } else { "open" };
    let below = match lo {
        None => "every radius".to_string(),
        Some(lo) => format!("every radius below {}", text(lo)),
    };
    let above = match hi {
        None => String::new(),
        Some(hi) => format!("; no radius above {} is", text(hi)),
    };
    format!("on this {spine} spine {below} is free of self-intersection{above}\n")
}
