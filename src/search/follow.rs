//! A polyline made elsewhere: where its vertices belong on the spine, and witnesses against it.

use super::meter::Meter;
use super::polyline::{Point, Rail};
use super::tree::{Id, Tree, V3, dot, norm, sub};
use crate::enclosure::Interval;

/// Steps of Newton's method.
const STEPS: usize = 40;
/// Samples of a span where a foot is looked for without a neighbour that is known.
const SAMPLES: usize = 24;
/// Points of an edge that are looked at when it cannot be proved.
pub(crate) const INNER: usize = 16;

pub(crate) struct Follower<'a> {
    rail: &'a Rail<'a>,
    closed: bool,
    /// Positions and points all along.
    samples: Vec<(f64, V3)>,
    /// The length of the spine up to each, nearly.
    lengths: Vec<f64>,
}

/// Where the polyline runs: for each vertex a position, increasing.
pub(crate) struct Feet {
    pub(crate) positions: Vec<f64>,
    /// Was the polyline turned round?
    pub(crate) reversed: bool,
}

impl<'a> Follower<'a> {
    pub(crate) fn new(rail: &'a Rail, closed: bool) -> Self {
        let spans = rail.count() as usize;
        let place = |i: usize| i as f64 / SAMPLES as f64;
        let samples: Vec<(f64, V3)> = (0..=spans * SAMPLES).map(|i| (place(i), rail.place(place(i)))).collect();
        let mut lengths = vec![0.0];
        for pair in samples.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + norm(&sub(&pair[1].1, &pair[0].1)));
        }
        Self { rail, closed, samples, lengths }
    }

    /// (x - C).C' and how it falls, at a position, at least half as for a line; and |C'|.
    fn slope(&self, x: &V3, position: f64) -> (f64, f64, f64) {
        let [point, first, second] = self.rail.jet(position);
        let (away, speed) = (sub(x, &point), dot(&first, &first));
        (dot(&away, &first), speed - dot(&away, &second).min(0.5 * speed), speed.sqrt())
    }

    fn held(&self, position: f64) -> f64 {
        if self.closed { position } else { position.clamp(0.0, self.rail.count()) }
    }

    /// The position so much farther along the spine, nearly.
    fn farther(&self, position: f64, by: f64) -> f64 {
        let count = self.rail.count();
        let (turn, whole) = ((position / count).floor().max(0.0) * count, self.lengths[self.lengths.len() - 1]);
        let at = |x: f64| {
            let place = (x - turn) * SAMPLES as f64;
            let k = (place.max(0.0) as usize).min(self.samples.len() - 2);
            self.lengths[k] + (place - k as f64) * (self.lengths[k + 1] - self.lengths[k])
        };
        let wanted = at(position) + by;
        let (more, wanted) = if self.closed && wanted > whole { (count, wanted - whole) } else { (0.0, wanted) };
        let k = self.lengths.partition_point(|length| *length <= wanted).clamp(1, self.lengths.len() - 1);
        let share = ((wanted - self.lengths[k - 1]) / (self.lengths[k] - self.lengths[k - 1])).clamp(0.0, 1.0);
        turn + more + (k as f64 - 1.0 + share) / SAMPLES as f64
    }

    /// A foot of x near a position, and its distance; infinite if none was reached.
    pub(crate) fn foot(&self, x: &V3, near: f64) -> (f64, f64) {
        let (mut at, mut reached) = (self.held(near), false);
        for _ in 0..STEPS {
            let (along, rate, speed) = self.slope(x, at);
            let step = (along / rate).clamp(-0.25, 0.25);
            let next = self.held(at + step);
            // no farther than rounding, of the parameter or of the box
            if (next - at).abs() <= (1e-12 * (1.0 + at.abs())).max(1e-14 / speed) {
                (at, reached) = (next, true);
                break;
            }
            at = next;
        }
        if !reached {
            return (at, f64::INFINITY);
        }
        (at, norm(&sub(x, &self.rail.place(at))))
    }

    /// The nearest foot of all that are found.
    pub(crate) fn nearest(&self, x: &V3) -> (f64, f64) {
        let far = |p: &V3| norm(&sub(x, p));
        let mut local: Vec<(f64, f64)> = vec![];
        for (k, (at, p)) in self.samples.iter().enumerate() {
            let d = far(p);
            let less = |other: Option<&(f64, V3)>| other.is_none_or(|(_, q)| d <= far(q));
            if less(k.checked_sub(1).and_then(|k| self.samples.get(k))) && less(self.samples.get(k + 1)) {
                local.push((d, *at));
            }
        }
        local.sort_by(|a, b| a.0.total_cmp(&b.0));
        let feet = local.iter().take(4).map(|(_, at)| self.foot(x, *at));
        feet.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, f64::INFINITY))
    }

    /// The feet of all vertices, one after the other; `None` where they do not go one way.
    pub(crate) fn feet(&self, vertices: &[V3], reach: f64, meter: &mut Meter) -> Option<Feet> {
        let (start, _) = self.nearest(&vertices[0]);
        let count = self.rail.count();
        // the direction by the first step
        let (second, _) = self.foot(&vertices[1], start);
        let mut forward = second > start;
        if !self.closed {
            forward = self.nearest(&vertices[vertices.len() - 1]).0 > start;
        }
        let order: Vec<usize> = match (forward, self.closed) {
            (true, _) => (0..vertices.len()).collect(),
            (false, false) => (0..vertices.len()).rev().collect(),
            (false, true) => [0].into_iter().chain((1..vertices.len()).rev()).collect(),
        };
        let mut positions = Vec::with_capacity(order.len());
        let mut at = self.nearest(&vertices[order[0]]).0;
        positions.push(at);
        for pair in order.windows(2) {
            if !meter.tick() {
                return None;
            }
            let (from, to) = (&vertices[pair[0]], &vertices[pair[1]]);
            let length = norm(&sub(to, from));
            let (mut next, mut off) = self.foot(to, self.farther(at, length));
            // on the spine, or nearly: no other is nearer
            if off > 1e-3 * length || next <= at {
                let (other, far) = self.nearest(to);
                let lifted = if self.closed { other + ((at - other) / count).ceil() * count } else { other };
                if far < off || next <= at {
                    (next, off) = (lifted, far);
                }
            }
            if next <= at || off > reach * 4.0 {
                return None;
            }
            at = next;
            positions.push(at);
        }
        let once = !self.closed || positions[positions.len() - 1] < positions[0] + count;
        once.then_some(Feet { positions, reversed: !forward })
    }
}

/// Is every point of the spine farther than `limit` from x? Proved if true; false may be unknown.
pub(crate) fn all_farther(tree: &mut Tree, x: &Point, limit: f64, meter: &mut Meter) -> bool {
    let middle: V3 = x.map(Interval::mid);
    let spread = x.iter().map(|x| (x.hi() - x.lo()).max(0.0)).fold(0.0, f64::max) * 2.0 + 1e-14;
    let mut open: Vec<Id> = vec![tree.root()];
    let mut patience = 20_000;
    while let Some(id) = open.pop() {
        let node = tree.node(id);
        let gap = norm(&sub(&middle, &node.mid)) * (1.0 - 1e-12) - node.rad - spread;
        if gap > limit {
            continue;
        }
        // a ball that small, that near: the point is not farther
        patience -= 1;
        if node.rad < 1e-9 * limit || patience == 0 || !meter.tick() {
            return false;
        }
        let Some((a, b)) = tree.children(id) else { return false };
        open.extend([a, b]);
    }
    true
}
