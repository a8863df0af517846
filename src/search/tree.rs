//! The hierarchy of arcs: blocks of spans above, dyadic cells of one span below, each with a ball round the arc and a
//! cone round its tangents. All f64, every bound with its rounding (docs/rounding.md). Nodes are made when first asked for.

use super::dyadic::Dyadic;
use super::frame::Frame;
use crate::bernstein::{Form, UNIT, Vec3};
use crate::integer::{Int, ldexp};
use crate::parallel;
use crate::spine::Bezier;
use std::ops::Deref;

pub(crate) type V3 = [f64; 3];

pub(crate) fn sub(a: &V3, b: &V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: &V3, b: &V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: &V3, b: &V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(a: &V3) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn unit(a: &V3) -> V3 {
    let length = norm(a);
    a.map(|x| x / length)
}

/// Covers a dozen rounded operations on numbers whose size is put in front of it.
pub(crate) const ROUNDING: f64 = 16.0 * UNIT;
/// The deepest dyadic cell. A cell that is still open there is reported as undecided.
pub(crate) const MAX_DEPTH: u32 = 110;

/// A place on the spine: joint-exact, comparable. `fraction` is in units of 2^-MAX_DEPTH.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    pub(crate) segment: usize,
    fraction: u128,
}

impl Place {
    /// Segment + local parameter.
    pub(crate) fn position(self) -> Dyadic {
        let fraction = Dyadic { m: Int::from(num_bigint::BigInt::from(self.fraction)), e: -i64::from(MAX_DEPTH) };
        Dyadic { m: Int::from(self.segment as i64), e: 0 }.add(&fraction)
    }

    /// The same, numerically.
    pub(crate) fn near(self) -> f64 {
        self.segment as f64 + ldexp(self.fraction as f64, -i64::from(MAX_DEPTH))
    }
}

pub(crate) type Id = u32;

#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) start: Place,
    pub(crate) end: Place,
    /// The arc lies in the ball of this centre and radius (infinite if nothing is known).
    pub(crate) mid: V3,
    pub(crate) rad: f64,
    /// Holds every tangent of the arc.
    pub(crate) cone: Cone,
    pub(crate) cell: Option<Head>,
    blocks: Option<(Id, Id)>,
    halves: Option<(Id, Id)>,
}

impl Node {
    fn of(cell: Cell) -> Self {
        let (mid, rad) = cell.ball();
        let cone = cell.cone();
        let unit = 1u128 << (MAX_DEPTH - cell.depth);
        let place = |index: u128| {
            let fraction = index * unit;
            if fraction >> MAX_DEPTH == 1 {
                Place { segment: cell.segment + 1, fraction: 0 }
            } else {
                Place { segment: cell.segment, fraction }
            }
        };
        let (start, end) = (place(cell.index), place(cell.index + 1));
        Self { start, end, mid, rad, cone, cell: Some(*cell.head), blocks: None, halves: None }
    }
}

/// A circular cone: every vector in it makes an angle with `axis` whose cosine is at least `cos`; -1 if nothing is
/// known. The axis is a unit vector up to rounding.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cone {
    pub(crate) axis: V3,
    pub(crate) cos: f64,
}

/// A dyadic cell of one span: control data in f64, each entry off by at most the radius of its kind.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell<'c> {
    pub(crate) head: &'c Head,
    /// Premultiplied numerators; for a constant weight the points themselves.
    pub(crate) r: &'c [V3],
    /// Empty for a constant weight, which then counts as 1.
    pub(crate) w: &'c [f64],
    /// The hodograph of the whole span restricted to the cell, up to a positive factor.
    pub(crate) a: &'c [V3],
    /// Cartesian control points, their hull holds the arc; empty while some weight is not surely positive.
    pub(crate) p: &'c [V3],
}

/// The cell without its control data.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Head {
    pub(crate) segment: usize,
    pub(crate) depth: u32,
    pub(crate) index: u128,
    pub(crate) r_err: f64,
    pub(crate) w_err: f64,
    pub(crate) a_err: f64,
    pub(crate) p_err: f64,
    /// Weights of like size (search only).
    pub(crate) even: bool,
    /// Straight from the exact arc.
    sharp: bool,
    /// All weights are surely positive.
    positive: bool,
    extent: Extent,
}

/// Where the control data of a cell start, and how many there are: r, a and, unless they are r, p follow one another.
#[derive(Debug, Clone, Copy, Default)]
struct Extent {
    points: usize,
    weights: usize,
    r: u32,
    a: u32,
    w: u32,
}

impl Extent {
    /// Of r and a.
    fn held(&self) -> usize {
        (self.r + self.a) as usize
    }

    /// With p: as many as weights.
    fn all(&self) -> usize {
        self.held() + self.w as usize
    }
}

/// Control data straight from an exact arc.
struct Sharp {
    r: Vec<V3>,
    r_err: f64,
    w: Vec<f64>,
    w_err: f64,
    a: Vec<V3>,
    a_err: f64,
}

/// The control data of all cells in one place, so that halving allocates nothing for a cell.
#[derive(Default)]
struct Store {
    points: Vec<V3>,
    weights: Vec<f64>,
}

pub(crate) struct Tree<'a> {
    pub(crate) frame: &'a Frame,
    nodes: Vec<Node>,
    store: Store,
    spans: Vec<Id>,
}

impl<'a> Tree<'a> {
    pub(crate) fn new(frame: &'a Frame) -> Self {
        let data = parallel::map(&frame.segments, Sharp::of);
        let spans: Vec<Id> = (0..data.len() as Id).collect();
        let mut tree = Self { frame, nodes: vec![], store: Store::default(), spans: spans.clone() };
        for (segment, data) in data.iter().enumerate() {
            let head = tree.store.span(segment, data);
            tree.push_cell(head);
        }
        tree.block(&spans);
        tree
    }

    /// The whole spine: of the 2n - 1 nodes made first, the last.
    pub(crate) fn root(&self) -> Id {
        (2 * self.spans.len() - 2) as Id
    }

    pub(crate) fn node(&self, id: Id) -> &Node {
        &self.nodes[id as usize]
    }

    /// The node as a cell; `None` for a block of spans.
    pub(crate) fn cell(&self, id: Id) -> Option<Cell<'_>> {
        self.node(id).cell.as_ref().map(|head| self.store.cell(head))
    }

    fn block(&mut self, spans: &[Id]) -> Id {
        if let [one] = spans {
            return *one;
        }
        let (left, right) = spans.split_at(spans.len() / 2);
        let (left, right) = (self.block(left), self.block(right));
        let (a, b) = (self.node(left), self.node(right));
        let mid: V3 = std::array::from_fn(|k| 0.5 * (a.mid[k] + b.mid[k]));
        let reach = |n: &Node| norm(&sub(&mid, &n.mid)) * (1.0 + ROUNDING) + n.rad;
        let rad = reach(a).max(reach(b)) * (1.0 + ROUNDING);
        let cone = a.cone.with(&b.cone);
        let node =
            Node { start: a.start, end: b.end, mid, rad, cone, cell: None, blocks: Some((left, right)), halves: None };
        self.nodes.push(node);
        (self.nodes.len() - 1) as Id
    }

    /// Both halves, in order; `None` at the depth limit.
    pub(crate) fn children(&mut self, id: Id) -> Option<(Id, Id)> {
        let node = self.node(id);
        if let Some(pair) = node.blocks.or(node.halves) {
            return Some(pair);
        }
        let whole = node.cell.filter(|cell| cell.depth < MAX_DEPTH)?;
        let [left, right] = self.store.halve(&whole).map(|half| self.push_cell(half));
        self.nodes[id as usize].halves = Some((left, right));
        Some((left, right))
    }

    /// An upper bound for the distance of the spine from the origin.
    pub(crate) fn extent(&mut self) -> f64 {
        let (mut open, mut extent) = (vec![self.root()], 0.0f64);
        while let Some(id) = open.pop() {
            let node = self.node(id);
            let reach = (norm(&node.mid) + node.rad) * (1.0 + ROUNDING);
            // infinite while the weights of the cell are not surely positive
            match if reach.is_finite() { None } else { self.children(id) } {
                Some((left, right)) => open.extend([left, right]),
                None => extent = extent.max(reach),
            }
        }
        extent
    }

    /// Takes a cell from its exact arc, without the errors of those that it was halved from; false if it is so already.
    pub(crate) fn sharpen(&mut self, id: Id) -> bool {
        let node = &mut self.nodes[id as usize];
        let Some(head) = node.cell.as_mut().filter(|cell| !cell.sharp) else { return false };
        self.store.reload(head, self.frame);
        self.store.project(head);
        let cell = self.store.cell(head);
        (node.mid, node.rad) = cell.ball();
        node.cone = cell.cone();
        true
    }

    fn push_cell(&mut self, mut head: Head) -> Id {
        self.store.refresh(&mut head, self.frame);
        self.nodes.push(Node::of(self.store.cell(&head)));
        (self.nodes.len() - 1) as Id
    }

    /// Is the first of a pair to be split? The larger, but a block of spans before a cell that f64 no longer makes smaller.
    pub(crate) fn first_is_split(&self, a: Id, b: Id) -> bool {
        let (a, b) = (self.node(a), self.node(b));
        let small = |node: &Node| node.cell.as_ref().is_some_and(|cell| node.rad <= 8.0 * cell.p_err);
        match (a.cell.is_none() && small(b), b.cell.is_none() && small(a)) {
            (true, _) => true,
            (_, true) => false,
            _ => a.rad >= b.rad,
        }
    }

    /// Does the arc hold the start, or the finish, of the spine?
    pub(crate) fn reaches_end(&self, id: Id, finish: bool) -> bool {
        let node = self.node(id);
        if finish {
            node.end == Place { segment: self.spans.len(), fraction: 0 }
        } else {
            node.start == Place { segment: 0, fraction: 0 }
        }
    }

    /// Do the two arcs share an end point of the parameter domain (the closure counts)?
    pub(crate) fn touching(&self, a: Id, b: Id) -> bool {
        let (a, b) = (self.node(a), self.node(b));
        let first = Place { segment: 0, fraction: 0 };
        let last = Place { segment: self.spans.len(), fraction: 0 };
        let wraps = |x: &Node, y: &Node| self.frame.closed && x.end == last && y.start == first;
        a.end == b.start || b.end == a.start || wraps(a, b) || wraps(b, a)
    }

    /// Are all tangents of both arcs within 45 degrees of one vector? With touching arcs this closes all their pairs by
    /// Lemma L.
    pub(crate) fn within_45_degrees(&self, a: Id, b: Id) -> bool {
        self.node(a).cone.with(&self.node(b).cone).within_45_degrees()
    }

    /// A tangent vector where a node starts or ends, numerically.
    pub(crate) fn tangent(&self, mut id: Id, at_end: bool) -> V3 {
        while let Some((left, right)) = self.node(id).blocks {
            id = if at_end { right } else { left };
        }
        let a = self.cell(id).expect("what is no block is a cell").a;
        a[if at_end { a.len() - 1 } else { 0 }]
    }

    /// Point, first and second derivative with respect to the span's parameter: plain f64, no bound (search only).
    /// Where weights far apart would cancel, in the smallest cell made so far, to the precision of its own weights.
    pub(crate) fn evaluate(&self, segment: usize, mut t: f64) -> [V3; 3] {
        let mut id = self.spans[segment];
        let mut scale = 1.0;
        while self.node(id).cell.is_some_and(|cell| !cell.even)
            && let Some((left, right)) = self.node(id).halves
        {
            (id, t) = if t < 0.5 { (left, 2.0 * t) } else { (right, 2.0 * t - 1.0) };
            scale *= 2.0;
        }
        let [c, c1, c2] = self.cell(id).expect("spans and their halves are cells").evaluate(t);
        [c, c1.map(|x| x * scale), c2.map(|x| x * (scale * scale))]
    }
}

/// Value and two derivatives by de Casteljau.
fn derivatives<const N: usize>(c: &[[f64; N]], t: f64) -> [[f64; N]; 3] {
    let n = c.len() - 1;
    let mut short = [[0.0; N]; 12];
    let mut long;
    let row = match short.get_mut(..=n) {
        Some(row) => row,
        None => {
            long = vec![[0.0; N]; n + 1];
            &mut long
        }
    };
    row.copy_from_slice(c);
    let (mut first, mut second) = ([0.0; N], [0.0; N]);
    for m in (1..=n).rev() {
        if m == 2 {
            second = std::array::from_fn(|k| (n * (n - 1)) as f64 * (row[2][k] - 2.0 * row[1][k] + row[0][k]));
        }
        if m == 1 {
            first = std::array::from_fn(|k| n as f64 * (row[1][k] - row[0][k]));
        }
        for i in 0..m {
            row[i] = std::array::from_fn(|k| row[i][k] + t * (row[i + 1][k] - row[i][k]));
        }
    }
    [row[0], first, second]
}

impl Cone {
    pub(crate) const UNKNOWN: Self = Self { axis: [1.0, 0.0, 0.0], cos: -1.0 };

    /// A cone round both, about their bisector.
    pub(crate) fn with(&self, other: &Self) -> Self {
        let sum: V3 = std::array::from_fn(|k| self.axis[k] + other.axis[k]);
        let length = norm(&sum);
        let axis = sum.map(|x| x / length);
        let cos = self.about(&axis).min(other.about(&axis));
        if cos > 0.0 && length > 0.1 { Self { axis, cos } } else { Self::UNKNOWN }
    }

    pub(crate) fn within_45_degrees(&self) -> bool {
        self.cos > std::f64::consts::FRAC_1_SQRT_2 + ROUNDING
    }

    /// Is every vector within 45 degrees of another unit vector?
    pub(crate) fn within_45_degrees_of(&self, axis: &V3) -> bool {
        self.about(axis) > std::f64::consts::FRAC_1_SQRT_2 + ROUNDING
    }

    /// Is every vector of one at less than 90 degrees to every vector of the other?
    pub(crate) fn within_90_degrees_of(&self, other: &Self) -> bool {
        // angle + alpha + beta < 90 degrees iff cos(angle + alpha) > sin(beta), the left angle below 90 degrees
        other.cos > 0.0 && self.about(&other.axis) > other.sin() + ROUNDING
    }

    /// The sine of the half angle, from above.
    pub(crate) fn sin(&self) -> f64 {
        (1.0 - self.cos * self.cos).max(0.0).sqrt() + SINE_SLACK
    }

    /// Lower bound for the cosine of the angle between another axis and any vector of the cone.
    fn about(&self, axis: &V3) -> f64 {
        let between = dot(axis, &self.axis).min(1.0);
        if self.cos <= 0.0 || between <= 0.0 {
            return -1.0;
        }
        // the cosine of a sum of two angles below 90 degrees
        between * self.cos - ((1.0 - between * between).sqrt() + SINE_SLACK) * self.sin() - ROUNDING
    }
}

/// sqrt(2 ROUNDING) rounded up: what sqrt(1 - c^2) may lose when c is off by a few units in the last place.
pub(crate) const SINE_SLACK: f64 = 6.0e-8;

/// Both halves by de Casteljau, `middle` that of two coefficients. The second starts as the whole row.
fn split<T: Copy>(left: &mut [T], row: &mut [T], middle: impl Fn(T, T) -> T) {
    let n = row.len();
    for (level, left) in left.iter_mut().enumerate() {
        *left = row[0];
        for i in 1..n - level {
            row[i - 1] = middle(row[i - 1], row[i]);
        }
    }
}

fn largest(v: &[V3]) -> f64 {
    v.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()))
}

impl Sharp {
    /// Every entry within UNIT of the largest of its kind.
    fn of(bezier: &Bezier) -> Self {
        let drop = bezier.w.iter().map(|x| x.bits() as i64).max().unwrap_or(0);
        let n = bezier.degree();
        let f = |x: &Int| x.to_f64_shifted(drop);
        let mut r: Vec<V3> = (0..=n).map(|i| [0, 1, 2].map(|k| f(&bezier.x[k][i]))).collect();
        let (mut w, mut w_err) = (vec![], 0.0);
        if bezier.w.len() == 1 {
            let w = f(&bezier.w[0]);
            for p in &mut r {
                *p = p.map(|x| x / w);
            }
        } else {
            w = bezier.w.iter().map(f).collect();
            w_err = UNIT * 2.0;
        }
        // the constant is above what squares of tiny coordinates may lose to underflow
        let r_err = 4.0 * UNIT * largest(&r) + 1e-140;
        let forms = bezier.forms();
        let drop = forms.a.iter().flat_map(|f| &f.c).map(|x| x.bits() as i64).max().unwrap_or(0);
        let binomials = crate::bernstein::binomials(forms.a[0].ds);
        let a: Vec<V3> = (0..=forms.a[0].ds)
            .map(|i| [0, 1, 2].map(|k| forms.a[k].c[i].to_f64_shifted(drop) / binomials[i]))
            .collect();
        let a_err = (4.0 * UNIT + crate::bernstein::binomial_error(forms.a[0].ds)) * largest(&a);
        Self { r, r_err, w, w_err, a, a_err }
    }
}

impl Head {
    /// A half; its control data are yet to come.
    fn half(&self, second: bool, extent: Extent) -> Self {
        let index = 2 * self.index + u128::from(second);
        Self { depth: self.depth + 1, index, sharp: false, positive: false, extent, ..*self }
    }

    /// The arc of the cell, exactly.
    pub(crate) fn exact(&self, frame: &Frame) -> Bezier {
        let index = Int::from(num_bigint::BigInt::from(self.index));
        frame.segments[self.segment].cell(&index, self.depth)
    }
}

impl Store {
    fn cell<'c>(&'c self, head: &'c Head) -> Cell<'c> {
        let extent = &head.extent;
        let w = &self.weights[extent.weights..][..extent.w as usize];
        let (held, quotients) = self.points[extent.points..][..extent.all()].split_at(extent.held());
        let (r, a) = held.split_at(extent.r as usize);
        let p = match head.positive {
            false => &[],
            true if w.is_empty() => r,
            true => quotients,
        };
        Cell { head, r, w, a, p }
    }

    /// Room for one more cell of these numbers.
    fn room(&mut self, size: &Extent) -> Extent {
        let extent = Extent { points: self.points.len(), weights: self.weights.len(), ..*size };
        self.points.resize(extent.points + size.all(), [0.0; 3]);
        self.weights.resize(extent.weights + size.w as usize, 0.0);
        extent
    }

    /// A whole span.
    fn span(&mut self, segment: usize, data: &Sharp) -> Head {
        let [r, a, w] = [data.r.len(), data.a.len(), data.w.len()].map(|n| n as u32);
        let extent = self.room(&Extent { r, a, w, ..Extent::default() });
        let mut head = Head { segment, extent, ..Head::default() };
        self.fill(&mut head, data);
        head
    }

    fn fill(&mut self, head: &mut Head, data: &Sharp) {
        let extent = &head.extent;
        let (r, a) = self.points[extent.points..][..extent.held()].split_at_mut(extent.r as usize);
        r.copy_from_slice(&data.r);
        a.copy_from_slice(&data.a);
        self.weights[extent.weights..][..extent.w as usize].copy_from_slice(&data.w);
        (head.r_err, head.w_err, head.a_err, head.sharp) = (data.r_err, data.w_err, data.a_err, true);
    }

    /// Takes r, w and a from the exact arc.
    fn reload(&mut self, head: &mut Head, frame: &Frame) {
        let data = match head.depth {
            0 => Sharp::of(&frame.segments[head.segment]),
            _ => Sharp::of(&head.exact(frame)),
        };
        self.fill(head, &data);
    }

    /// Both halves, without their points.
    fn halve(&mut self, whole: &Head) -> [Head; 2] {
        let from = whole.extent;
        let to = [self.room(&from), self.room(&from)];
        self.points.copy_within(from.points..from.points + from.held(), to[1].points);
        self.weights.copy_within(from.weights..from.weights + from.w as usize, to[1].weights);
        let (left, right) = self.points[to[0].points..].split_at_mut(from.all());
        let middle = |x: V3, y: V3| std::array::from_fn(|k| 0.5 * (x[k] + y[k]));
        for kind in [0..from.r as usize, from.r as usize..from.held()] {
            split(&mut left[kind.clone()], &mut right[kind], middle);
        }
        let (left, right) = self.weights[to[0].weights..].split_at_mut(from.w as usize);
        split(left, right, |x, y| 0.5 * (x + y));
        let grown = self.cell(whole).grown();
        [grown.half(false, to[0]), grown.half(true, to[1])]
    }

    /// Computes the Cartesian points; where rounding has eaten the hodograph, a weight or the points, starts again from
    /// the exact arc.
    fn refresh(&mut self, head: &mut Head, frame: &Frame) {
        let mut worn = self.cell(head).worn();
        let may_reload = head.depth > 0 && head.depth.is_multiple_of(4);
        if !worn {
            self.project(head);
            worn = may_reload && self.cell(head).blurred();
        }
        if worn && may_reload {
            self.reload(head, frame);
        }
        if worn {
            self.project(head);
        }
        let cell = self.cell(head);
        head.even = cell.w.is_empty() || cell.heaviest() < 16.0 * cell.lightest();
    }

    /// Computes the Cartesian points.
    fn project(&mut self, head: &mut Head) {
        let extent = &head.extent;
        if extent.w == 0 {
            (head.p_err, head.positive) = (head.r_err, true);
            return;
        }
        head.p_err = 0.0;
        let w = &self.weights[extent.weights..][..extent.w as usize];
        head.positive = !w.iter().any(|w| *w <= 2.0 * head.w_err);
        if !head.positive {
            return;
        }
        let (held, quotients) = self.points[extent.points..][..extent.all()].split_at_mut(extent.held());
        for ((r, w), p) in held.iter().zip(w).zip(quotients) {
            *p = r.map(|x| x / w);
            let size = p.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            let err = (head.r_err + size * head.w_err) / (w - head.w_err) + 2.0 * UNIT * size;
            head.p_err = head.p_err.max(err * (1.0 + 1e-9) + 1e-290);
        }
    }
}

impl Deref for Cell<'_> {
    type Target = Head;

    fn deref(&self) -> &Head {
        self.head
    }
}

impl Cell<'_> {
    /// Point, first and second derivative with respect to the cell's parameter.
    fn evaluate(&self, t: f64) -> [V3; 3] {
        let [r, r1, r2] = derivatives(self.r, t);
        if self.w.is_empty() {
            return [r, r1, r2];
        }
        let [w, w1, w2] = derivatives(self.w.as_chunks::<1>().0, t).map(|v| v[0]);
        let c = r.map(|x| x / w);
        let c1: V3 = std::array::from_fn(|k| (r1[k] - w1 * c[k]) / w);
        let c2 = std::array::from_fn(|k| (r2[k] - 2.0 * w1 * c1[k] - w2 * c[k]) / w);
        [c, c1, c2]
    }

    pub(crate) fn weight(&self, i: usize) -> f64 {
        self.w.get(i).copied().unwrap_or(1.0)
    }

    /// The largest weight held.
    pub(crate) fn heaviest(&self) -> f64 {
        self.w.iter().copied().reduce(f64::max).unwrap_or(1.0)
    }

    pub(crate) fn weight_form(&self) -> Form<f64> {
        let one: &[f64] = &[1.0];
        let w = if self.w.is_empty() { one } else { self.w };
        Form::from_strip(w.iter().copied(), self.w_err, 0)
    }

    pub(crate) fn hodograph_forms(&self) -> Vec3<f64> {
        std::array::from_fn(|k| Form::from_strip(self.a.iter().map(|a| a[k]), self.a_err, 0))
    }

    fn lightest(&self) -> f64 {
        self.w.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The head with the errors that halving leaves.
    fn grown(&self) -> Head {
        // each level rounds one sum, and averages do not amplify: degree * UNIT * max per split
        let grown = |err: f64, max: f64, n: usize| (err + (n as f64 * UNIT) * max) * (1.0 + 1e-9) + 1e-290;
        let w_max = self.w.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let r_err = grown(self.r_err, largest(self.r), self.r.len());
        let w_err = if self.w.is_empty() { 0.0 } else { grown(self.w_err, w_max, self.w.len()) };
        let a_err = grown(self.a_err, largest(self.a), self.a.len());
        Head { r_err, w_err, a_err, ..*self.head }
    }

    /// The hodograph of a cell is to keep at least 20 bits, a positive weight too.
    fn worn(&self) -> bool {
        let shortest = self.a.iter().map(norm).fold(f64::INFINITY, f64::min);
        let lightest = self.lightest();
        self.a_err * 1e6 > shortest || (lightest > 0.0 && self.w_err * 1e6 > lightest)
    }

    /// Do inherited errors blur the arc, where a fresh start does better?
    fn blurred(&self) -> bool {
        self.p_err > 2000.0 * UNIT * largest(self.p) && self.p_err > 1e-7 * self.length()
    }

    /// From one end to the other.
    fn length(&self) -> f64 {
        self.p.first().zip(self.p.last()).map_or(0.0, |(first, last)| norm(&sub(first, last)))
    }

    /// A ball that holds the arc. Coordinates are off by p_err each, so points by less than 2 p_err.
    fn ball(&self) -> (V3, f64) {
        let (Some(first), Some(last)) = (self.p.first(), self.p.last()) else { return ([0.0; 3], f64::INFINITY) };
        let mid: V3 = std::array::from_fn(|k| 0.5 * (first[k] + last[k]));
        let far = self.p.iter().map(|p| norm(&sub(p, &mid))).fold(0.0f64, f64::max);
        let size = norm(&mid) + far;
        (mid, (far + 2.0 * self.p_err) * (1.0 + ROUNDING) + ROUNDING * UNIT * size)
    }

    /// A cone round the control vectors of the hodograph, hence round all tangents.
    fn cone(&self) -> Cone {
        let unknown = Cone::UNKNOWN;
        let (first, last) = (unit(&self.a[0]), unit(&self.a[self.a.len() - 1]));
        let axis = unit(&std::array::from_fn(|k| first[k] + last[k]));
        if !axis.iter().all(|x| x.is_finite()) {
            return unknown;
        }
        let mut cos = 1.0f64;
        for a in self.a {
            let length = norm(a);
            if length <= 4.0 * self.a_err {
                return unknown;
            }
            // a vector off by e turns by an angle of sine e / length at most
            cos = cos.min(dot(a, &axis) / length - 2.0 * self.a_err / length - ROUNDING);
        }
        if cos > 0.0 { Cone { axis, cos } } else { unknown }
    }
}
