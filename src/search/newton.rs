//! Newton's method for doubly critical pairs, in f64: candidates steer the search, they prove nothing.

use super::tree::{Tree, V3, dot, norm, sub};

/// A numerical doubly critical pair: candidates steer the search, they prove nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) s: (usize, f64),
    pub(crate) t: (usize, f64),
    /// Half the distance.
    pub(crate) radius: f64,
}

pub(crate) struct Step {
    pub(crate) ds: f64,
    pub(crate) dt: f64,
    /// |q|^2 at the critical pair, by the quadratic model.
    pub(crate) predicted_sq: f64,
    /// The step without its part along a valley, if |q|^2 is all but constant in some direction: ds, dt, |q|^2 there.
    pub(crate) across: Option<[f64; 3]>,
    pub(crate) length: f64,
    /// The larger of |cos(q, T(s))| and |cos(q, T(t))|.
    pub(crate) residual: f64,
    /// Half the gradient of |q|^2 and half its Hessian (ss, st, tt), in arc length; the speeds.
    pub(crate) gradient: [f64; 2],
    pub(crate) hessian: [f64; 3],
    pub(crate) speed: [f64; 2],
}

impl Step {
    /// Is the Hessian nearly singular?
    pub(crate) const fn flat(&self) -> bool {
        self.across.is_some()
    }

    /// Do q.T(s) and q.T(t) change sign well inside cells of these widths in the parameter, by the linear model?
    pub(crate) fn changes(&self, h: [f64; 2]) -> [bool; 2] {
        let [a, b, c] = self.hessian;
        let half = [0, 1].map(|k| 0.5 * h[k] * self.speed[k]);
        let inside = |g: f64, s: f64, t: f64| g.abs() < 0.5 * (s.abs() * half[0] + t.abs() * half[1]);
        [inside(self.gradient[0], a, b), inside(self.gradient[1], b, c)]
    }
}

/// Newton's step for grad |q|^2 = 0 in arc length, the shortest one where the Hessian is singular.
pub(crate) fn newton_step(at_s: &[V3; 3], at_t: &[V3; 3]) -> Option<Step> {
    let q = sub(&at_s[0], &at_t[0]);
    let (vs, vt) = (norm(&at_s[1]), norm(&at_t[1]));
    let (gs, gt) = (dot(&q, &at_s[1]) / vs, -dot(&q, &at_t[1]) / vt);
    let a = 1.0 + dot(&q, &at_s[2]) / (vs * vs);
    let c = 1.0 - dot(&q, &at_t[2]) / (vt * vt);
    let b = -dot(&at_s[1], &at_t[1]) / (vs * vt);
    // Jacobi's rotation, free of library functions: candidates are to be the same on every machine
    let turn = if b == 0.0 {
        0.0
    } else {
        let t = (c - a) / (2.0 * b);
        t.signum() / (t.abs() + (1.0 + t * t).sqrt())
    };
    let cos = 1.0 / (1.0 + turn * turn).sqrt();
    let sin = -turn * cos;
    let (l1, l2) = (a - turn * b, c + turn * b);
    let small = 1e-7 * l1.abs().max(l2.abs());
    let along = |l: f64, g: f64| if l.abs() > small { -g / l } else { 0.0 };
    let (u, v) = (along(l1, cos * gs + sin * gt), along(l2, -sin * gs + cos * gt));
    let length = norm(&q);
    let moved = |u: f64, v: f64| {
        let (ds, dt) = (cos * u - sin * v, sin * u + cos * v);
        [ds / vs, dt / vt, length * length + gs * ds + gt * dt]
    };
    let [ds, dt, predicted_sq] = moved(u, v);
    let flat = l1.abs().min(l2.abs()) < 1e-3 * l1.abs().max(l2.abs());
    let step = Step {
        ds,
        dt,
        predicted_sq,
        across: flat.then(|| if l1.abs() < l2.abs() { moved(0.0, v) } else { moved(u, 0.0) }),
        length,
        residual: if length > 0.0 { gs.abs().max(gt.abs()) / length } else { 0.0 },
        gradient: [gs, gt],
        hessian: [a, b, c],
        speed: [vs, vt],
    };
    (step.ds.is_finite() && step.dt.is_finite()).then_some(step)
}

/// Members of a family of critical pairs (circles, parallel strands) with a simple s.
pub(crate) fn snapped<'t>(tree: &'t Tree, pair: &'t Candidate) -> impl Iterator<Item = Candidate> + 't {
    [0.5, 0.0, 1.0, 0.25, 0.75].into_iter().filter_map(|s| partner(tree, (pair.s.0, s), pair.t))
}

/// The pair of s and the t near a guess with q.C'(t) = 0.
pub(crate) fn partner(tree: &Tree, s: (usize, f64), guess: (usize, f64)) -> Option<Candidate> {
    let spans = tree.frame.segments.len();
    let wrap = tree.frame.closed;
    let at_s = tree.evaluate(s.0, s.1);
    let (mut segment, mut t) = guess;
    for _ in 0..20 {
        let at = tree.evaluate(segment, t);
        let q = sub(&at_s[0], &at[0]);
        let step = dot(&q, &at[1]) / (dot(&at[1], &at[1]) - dot(&q, &at[2]));
        if step.abs() < 1e-13 {
            return Some(Candidate { s, t: (segment, t.clamp(0.0, 1.0)), radius: 0.5 * norm(&q) });
        }
        t += step.clamp(-0.5, 0.5);
        if t > 1.0 + 1e-9 && (segment + 1 < spans || wrap) {
            (segment, t) = ((segment + 1) % spans, 0.0);
        } else if t < -1e-9 && (segment > 0 || wrap) {
            (segment, t) = ((segment + spans - 1) % spans, 1.0);
        } else if !(-1e-9..=1.0 + 1e-9).contains(&t) {
            return None;
        }
    }
    None
}
