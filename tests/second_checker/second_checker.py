#!/usr/bin/env python3
"""A second checker for docs/certificate-format.md, "Certificates, version 1: delta", written from that page alone.

    second_checker.py CURVE.json CERTIFICATE    prints the verdict; exit code 0 verified, 1 rejected, 2 undecodable or unusable
    second_checker.py --list FILE               FILE has lines CURVE.json<TAB>CERTIFICATE; prints a word for each; exit code 0

The words: verified, rejected, undecodable, and unusable where a file cannot be read or is no valid curve file.
"Section" below is a section of the page; where a function names none, it is that of the headline above it.
Integers and fractions only.  A polynomial is the tuple of its Bernstein coefficients, each times its binomial coefficient: so
products are convolutions, and signs stay.  Its formal degree is the length of the tuple less 1.
"""
import hashlib, json, re, sys
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from math import ceil, comb, floor, gcd, lcm
from pathlib import Path

INF, MAX_BYTES, MAX_DIGITS, MAX_HALVINGS, UNIT = "inf", 256 << 20, 20000, 512, 1 << 32
sys.set_int_max_str_digits(2 * MAX_DIGITS)

class Verdict(Exception):
    """A word and a reason (head of the page): a rule of section 1, or a condition of sections 2 to 6, does not hold."""

def demand(word, condition, reason):
    if not condition:
        raise Verdict(word, reason)

usable, canonical, need = (partial(demand, word) for word in ("unusable", "undecodable", "rejected"))

# ---- the curve file (section 2; interface.md, Numbers and Curve files) ---------------------------------------------------

NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE]([+-]?[0-9]+))?|-?[0-9]+/0*[1-9][0-9]*")

def exact(text):
    """The rational that a JSON number or string spells."""
    usable(isinstance(text, str) and sum(map(str.isdigit, text)) <= 2000, "no number, or one of more than 2,000 digits")
    match = NUMBER.fullmatch(text)
    usable(match and abs(int(match[1] or 0)) <= 5000, "no number, or one with an exponent above 5,000")
    return Fraction(text)

def read_json(data):
    """A JSON object, its numbers as spelt."""
    def unique(items):
        usable(len({key for key, _ in items}) == len(items), "a duplicate key")
        return dict(items)
    usable(len(data) <= MAX_BYTES, "a file above 256 MiB")
    try:
        root = json.loads(data.decode("utf-8"), parse_int=str, parse_float=str, parse_constant=exact, object_pairs_hook=unique)
        usable(isinstance(root, dict), "no JSON object")
    except (ValueError, RecursionError) as error:
        raise Verdict("unusable", "not JSON: %s" % error)
    return root

class Curve:
    """A valid curve file.  Zeros of w and of the hodograph are left to `curved` (section 3)."""

    def __init__(self, data):
        root = read_json(data)
        known = {"degree", "control_points", "weights", "knots", "name", "source", "unit", "schema"}
        usable(all(key in known or key.startswith("x-") for key in root), "an unknown key")
        points, degree = root.get("control_points"), exact(root.get("degree"))
        usable(degree.denominator == 1 and 1 <= degree <= 64, "the degree is not an integer in 1 .. 64")
        n = self.degree = int(degree)
        usable(isinstance(points, list) and n < len(points) <= 10**6, "too few or too many control points")
        usable(all(isinstance(p, list) and len(p) in (2, 3) for p in points), "a control point without 2 or 3 coordinates")
        usable("knots" in root or len(points) == n + 1, "no knots, and not one Bezier segment")
        weights, knots = root.get("weights", ["1"] * len(points)), root.get("knots", ["0"] * (n + 1) + ["1"] * (n + 1))
        usable(isinstance(weights, list) and isinstance(knots, list), "weights or knots that are no list")
        usable(len(weights) == len(points) and len(knots) == len(points) + n + 1, "weights or knots of the wrong length")
        self.points = [([exact(c) for c in p] + [Fraction(0)])[:3] for p in points]
        self.weights, self.knots = [exact(w) for w in weights], [exact(u) for u in knots]
        u, start, end = self.knots, self.knots[n], self.knots[len(points)]
        usable(all(x <= y for x, y in zip(u, u[1:])) and start < end, "decreasing knots, or an empty domain")
        usable(not any(start < u[i] == u[i + n] < end for i in range(len(points) + 1)), "a multiplicity above the degree")

    @cached_property
    def digest(self):
        """Section 1: SHA-256 of the canonical text."""
        lines = ["tubecert-curve 1", "degree %d" % self.degree] + ["knot %s" % u for u in self.knots]
        for p, w in zip(self.points, self.weights):
            lines += ["point %s %s %s" % tuple(p), "weight %s" % w]
        return hashlib.sha256("".join(line + "\n" for line in lines).encode("ascii")).hexdigest()

    spine = cached_property(lambda self: Spine(self))

# ---- the text of a certificate (section 1) -------------------------------------------------------------------------------

def integer(text, low=-10**MAX_DIGITS, high=10**MAX_DIGITS):
    canonical(len(text.removeprefix("-")) <= MAX_DIGITS and re.fullmatch("0|-?[1-9][0-9]*", text), "no canonical integer")
    canonical(low <= int(text) < high, "an integer outside its 64 bits")
    return int(text)

small, index = partial(integer, low=-2**63, high=2**63), partial(integer, low=0, high=2**64)

def rational(text):
    over, bar, under = text.partition("/")
    p, q = integer(over), integer(under) if bar else 1
    canonical(not bar or q > 1 and gcd(p, q) == 1, "no canonical rational")
    return Fraction(p, q)

def bound(text):
    canonical(not text.startswith("-"), "a negative bound")
    return INF if text == "inf" else rational(text)

# Sections 3 to 5: the readers of the fields of a node.
NODES = {"/": [], "1": [], "2": [], "curved": [], "local": [], "share": [small], "side": [small] * 2, "cone": [small] * 3,
         "slab": [small] * 3, "bent": [small] * 6}
# Section 6: those of a witness; and for each line that follows it the keywords allowed, with theirs.
VECTOR, FEET = [rational] * 3, {"plane": [rational], "valley": [rational] * 3}
WITNESSES = {"none": ([], []), "curvature": ([index, rational], []), "corner": ([index], []), "contact": (VECTOR, [FEET, FEET]),
             "crossing": ([rational] * 4, [{name: VECTOR} for name in ("normal", "first", "second")]),
             "mirror": ([rational] * 4, [{"normal": VECTOR}])}

class Certificate:
    """Digest, bounds, for every section the vector and the nodes of its tree, and the witness."""

    def __init__(self, data):
        canonical(len(data) <= MAX_BYTES >> 3 and data.isascii() and data.endswith(b"\n"), "too long, not ASCII, or no last \\n")
        self.lines, self.sections = data.decode("ascii")[:-1].split("\n")[::-1], {}
        canonical(self.lines.pop() == "tubecert-certificate 1 radius", "no tubecert-certificate 1 radius")
        self.digest, self.lo, self.hi = (self.line({k: [f]})[1][0] for k, f in (("curve", str), ("lo", bound), ("hi", bound)))
        canonical(re.fullmatch("[0-9a-f]{64}", self.digest), "no digest")
        self.section("along", [])
        if self.lo not in (0, INF):
            self.section("pairs", [])
            if self.lines and self.lines[-1].startswith("start "):
                self.section("start", [small] * 3)
                self.section("finish", [small] * 3)
        kind, fields = self.line({kind: readers for kind, (readers, _) in WITNESSES.items()}, "upper ")
        self.witness = [kind, fields] + [self.line(allowed)[1] for allowed in WITNESSES[kind][1]]
        self.line({"end": []})
        canonical(not self.lines, "lines after end")

    def line(self, allowed, prefix=""):
        """Keyword and fields of the next line; allowed are keywords with the readers of their fields."""
        canonical(self.lines and self.lines[-1].startswith(prefix), "the text ends too early, or no " + prefix)
        keyword, *words = self.lines.pop().removeprefix(prefix).split(" ")
        canonical(keyword in allowed and len(words) == len(allowed[keyword]), "expected %s, with its fields" % " or ".join(allowed))
        return keyword, [read(word) for read, word in zip(allowed[keyword], words)]

    def section(self, name, readers):
        """A vector and the nodes of a tree, up to the first line that is none."""
        (_, vector), nodes = self.line({name: readers}), []
        while self.lines and self.lines[-1].split(" ")[0] in NODES:
            nodes.append(self.line(NODES))
        self.sections[name] = vector, nodes

# ---- polynomials, and vectors of numbers or polynomials (section 2) ------------------------------------------------------

class Poly(tuple):
    """A polynomial in s; or in s and t: its coefficients then are polynomials in t.  A factor may be a number."""

    def __mul__(self, other):
        if not isinstance(other, Poly):
            return Poly(other * x for x in self)
        out = [0] * (len(self) + len(other) - 1)
        for i, x in enumerate(self):
            for j, y in enumerate(other, i):
                out[j] += x * y
        return Poly(out)

    def __add__(self, other):
        low, high = sorted((self, other), key=len)
        return Poly(x + y for x, y in zip(low * one(len(high) - len(low)) if len(low) < len(high) else low, high))

    __rmul__, __radd__, __sub__ = __mul__, lambda self, zero: self, lambda self, other: self + -1 * other

@lru_cache(None)
def one(degree):
    return Poly(comb(degree, i) for i in range(degree + 1))

def in_t(f):
    """f(t), as a polynomial of degree 0 in s."""
    return Poly([f])

def positive(f):
    return all(positive(c) if isinstance(c, Poly) else c > 0 for c in f)

def value(f, x):
    """f at a rational."""
    p, q, n = x.numerator, x.denominator, len(f) - 1
    return Fraction(sum(c * p**i * (q - p)**(n - i) for i, c in enumerate(f)), q**n)

def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]

def cross(u, v):
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]

def times(c, vector):
    return [c * x for x in vector]

# ---- spine, arcs, pieces (section 2) -------------------------------------------------------------------------------------

class Piece:
    """A span or a part of one, by integer control points up to a positive factor; flat if w has degree 0."""

    def __init__(self, lines, flat, start, end):
        up = lcm(*(c.denominator for line in lines for c in line))
        down = gcd(*(int(c * up) for line in lines for c in line))
        self.lines = [[int(c * up) // down for c in line] for line in lines]    # x, y, z, w
        self.weights, self.points, self.flat, self.start, self.end = self.lines[3], list(zip(*self.lines)), flat, start, end
        *self.r, w = self.derivatives(0)
        self.w = Poly(self.weights[:1]) if flat else w

    @cached_property
    def halves(self):
        """By de Casteljau, level k times 2^k."""
        need(self.end - self.start > Fraction(1, 1 << MAX_HALVINGS), "a part more than 512 halvings deep")
        def left(c):
            out = []
            while c:
                out.append(c[0] << len(c) - 1)
                c = [x + y for x, y in zip(c, c[1:])]
            return out
        middle = (self.start + self.end) / 2
        first, second = [left(c) for c in self.lines], [left(c[::-1])[::-1] for c in self.lines]
        return (Piece(first, self.flat, self.start, middle),), (Piece(second, self.flat, middle, self.end),)

    def derivatives(self, order):
        """Of x, y, z and w."""
        lines = self.lines
        for _ in range(order):
            lines = [[(len(c) - 1) * (y - x) for x, y in zip(c, c[1:])] for c in lines]
        return [Poly(comb(len(c) - 1, i) * x for i, x in enumerate(c)) for c in lines]

    @cached_property
    def a(self):
        *dr, dw = self.derivatives(1)
        return [self.w * f if self.flat else self.w * f - dw * g for f, g in zip(dr, self.r)]

    @cached_property
    def b(self):
        """The 0 of n = 1 has the degree 0 here, so that terms with it do not count in sums."""
        if len(self.weights) == 2:
            return [Poly([0])] * 3
        (*dr, dw), (*ddr, ddw) = self.derivatives(1), self.derivatives(2)
        terms = zip(cross(dr, ddr), cross(self.r, ddr), cross(self.r, dr))
        return [self.w * f if self.flat else self.w * f - dw * g + ddw * h for f, g, h in terms]

    vectors = cached_property(lambda self: list(zip(*self.a)))    # positive multiples of the control vectors of a

def halves(arc):
    """Of an arc, which is the tuple of its pieces."""
    middle = len(arc) // 2
    return (arc[:middle], arc[middle:]) if middle else arc[0].halves

def segment(lines, knots, start, end):
    """Knot insertion: Bezier coefficients on start .. end, from B-spline coefficients over 2 n knots."""
    n = len(knots) // 2
    def blossom(c, arguments):
        for level, x in enumerate(arguments):
            steps = [(x - left) / (right - left) for left, right in zip(knots[level:n], knots[n:])]
            c = [p + step * (q - p) for p, q, step in zip(c, c[1:], steps)]
        return c[0]
    return [[blossom(c, [start] * (n - j) + [end] * j) for j in range(n + 1)] for c in lines]

class Spine:
    """The spans of a curve, and its joints."""

    def __init__(self, curve):
        n, u, spans = curve.degree, curve.knots, []
        homogeneous = [times(w, (*p, 1)) for p, w in zip(curve.points, curve.weights)]
        for k in range(n, len(curve.points)):
            if u[k] < u[k + 1]:
                lines = segment(list(zip(*homogeneous[k - n:k + 1])), u[k - n + 1:k + n + 1], u[k], u[k + 1])
                need(lines[3][0] != 0, "the weight at the start of a span is 0")
                lines = [times(1 if lines[3][0] > 0 else -1, c) for c in lines]
                spans.append(Piece(lines, len(set(lines[3])) == 1, Fraction(len(spans)), Fraction(len(spans) + 1)))
        (*p, v), (*q, w) = spans[0].points[0], spans[-1].points[-1]
        self.n, self.spans, self.one_end = len(spans), tuple(spans), times(w, p) == times(v, q)
        self.closed = self.smooth(0)

    def smooth(self, k):
        """Joint k is smooth.  Vectors are parallel iff the square of their product is that of their lengths."""
        c, d = self.spans[k - 1].vectors[-1], self.spans[k].vectors[0]
        return dot(c, d) > 0 and dot(c, d)**2 == dot(c, c) * dot(d, d) and (k > 0 or self.one_end)

    def at(self, position):
        """Section 6: a and C at a position."""
        low, high = (-self.n, 2 * self.n) if self.closed else (0, self.n)
        need(low <= position <= high, "a position outside its range")
        position = position % self.n if self.closed else position
        k = min(position // 1, self.n - 1)
        *r, w = [value(f, position - k) for f in self.spans[k].derivatives(0)]
        return [value(f, position - k) for f in self.spans[k].a], times(1 / w, r)

# ---- rules (sections 3 to 5), each a function that answers yes or no -----------------------------------------------------

def weights_positive(arc):
    """Sections 3 to 6: all control weights are > 0."""
    return all(positive(piece.weights) for piece in arc)

def curved(arc, R):
    """Section 3; times q^2, with R = p/q."""
    if len(arc) > 1 or not weights_positive(arc):
        return False
    aa, bb, ww = dot(arc[0].a, arc[0].a), dot(arc[0].b, arc[0].b), arc[0].w * arc[0].w
    return positive(aa if R == 0 else R.denominator**2 * (aa * aa * aa) - R.numerator**2 * bb * (ww * ww * ww))

def in_cone(arc, g):
    """Sections 4 and 5: the condition of cone and local on control vectors."""
    return all(dot(c, g) > 0 and 2 * dot(c, g)**2 > dot(c, c) * dot(g, g) for piece in arc for c in piece.vectors)

def cone(A, B, g, spine):
    """Section 4."""
    around = spine.closed and B[-1].end == spine.n and A[0].start == 0
    return (A == B or A[-1].end == B[0].start or around) and in_cone(A + B, g)

def heights(arc, g):
    """Sections 4 to 6: g.p for all control points p."""
    return [Fraction(dot(p, g), p[3]) for piece in arc for p in piece.points]

def slab(A, height, g, R):
    """Sections 4 and 5; height is the greatest g.q, or g.C(e)."""
    gap = min(heights(A, g)) - height if weights_positive(A) else 0
    return gap > 0 and gap**2 > 4 * R**2 * dot(g, g)

def difference(A, B):
    """Section 4: D, of pieces A with parameter s and B with parameter t; and a(t)."""
    return [f * in_t(B.w) - A.w * in_t(g) for f, g in zip(A.r, B.r)], [in_t(f) for f in B.a]

def side(A, B, X, Y):
    """Section 4."""
    (D, a_t), v, v_ = difference(A, B), A.weights[0], B.weights[0]
    F = X * v_**2 * dot(D, A.a) + Y * v**2 * dot(D, a_t)
    return positive(F) or positive(-1 * F)

def bends(x, g, u, flat):
    """Section 4, bent: (x - s)(1 + g (x - s) + u (1/2 - s)) and 1 + u (s - 1/2), times 2^97 and 2^33; x, g and u times 2^32."""
    bend = [2 * UNIT**2 + 2 * g * x + u * UNIT, 2 * UNIT**2 + 2 * g * (x - UNIT) - u * UNIT]
    return Poly([x, x - UNIT]) * Poly(bend), Poly([2 * UNIT] if flat else [2 * UNIT - u, 2 * UNIT + u])

def bent(A, B, X, Y, G, H, U, V, R):
    """Section 4; times 2^130 q^2 m m', with R = p/q and k = m'/m; |D|^2 is multiplied out."""
    m, m_, p2, q2 = A.weights[0] * (2 * UNIT - V), B.weights[0] * (2 * UNIT - U), R.numerator**2, R.denominator**2
    if max(abs(U), abs(V)) >= UNIT or m <= 0 or m_ <= 0:
        return False
    (D, a_t), (bend_s, line_s), (bend_t, line_t) = difference(A, B), bends(X, G, U, A.flat), bends(Y, H, V, B.flat)
    DD = dot(A.r, A.r) * in_t(B.w * B.w) - 2 * dot(times(A.w, A.r), [in_t(B.w * f) for f in B.r]) + A.w * A.w * in_t(dot(B.r, B.r))
    return positive(4 * UNIT**4 * m * m_ * (q2 * DD - 4 * p2 * (A.w * A.w) * in_t(B.w * B.w))
                    + q2 * m_**2 * bend_s * in_t(line_t) * dot(D, A.a) - q2 * m**2 * line_s * in_t(bend_t) * dot(D, a_t))

def share(arc, e, d, K, R):
    """Section 5; e in homogeneous coordinates; times 2^64 q^2, with R = p/q."""
    if not 0 <= K <= UNIT or len(arc) > 1:
        return False
    a, w, p2, q2 = arc[0].a, arc[0].w, R.numerator**2, R.denominator**2
    q, u = [e[3] * f - x * w for f, x in zip(arc[0].r, e)], cross(d, a)
    aq, dq, uq, W = dot(a, q), dot(d, q), dot(u, q), e[3] * w
    return positive(q2 * (K * UNIT * dot(d, d) * (aq * aq) + (UNIT - K) * UNIT * (dq * dq) * dot(a, a) + K * (UNIT - K) * (uq * uq))
                    - UNIT**2 * p2 * dot(u, u) * (W * W))

# ---- trees (sections 3 to 5) ---------------------------------------------------------------------------------------------

def check_tree(nodes, root, split, rules):
    """Sections 3 to 5: split answers the children of a node, and None for a leaf; rules are by the kind of a leaf."""
    stack = [root]
    for kind, fields in nodes:
        need(stack, "the tree ends before the section does")
        arcs = stack.pop()
        children = split(kind, *arcs)
        if children is None:
            place = ["%s .. %s" % (A[0].start, A[-1].end) for A in arcs]
            need(kind in rules and rules[kind](*arcs, *fields), "%s on %s" % (kind, " and ".join(place)))
        else:
            stack += reversed(children)
    need(not stack, "the section ends before the tree does")

def split_arc(kind, A, order=1):
    """Sections 3 and 5."""
    return [(half,) for half in halves(A)[::order]] if kind == "/" else None

def split_pair(kind, A, B):
    """Section 4."""
    if kind not in ("/", "1", "2"):
        return None
    need((A == B) == (kind == "/"), "pairs: %s, against A is B" % kind)
    L, R = halves(B if kind == "2" else A)
    return {"/": [(L, L), (L, R), (R, R)], "1": [(L, B), (R, B)], "2": [(A, L), (A, R)]}[kind]

def check_pairs(nodes, spine, R):
    """Section 4."""
    two_pieces = lambda A, B: A != B and len(A + B) == 2
    check_tree(nodes, (spine.spans, spine.spans), split_pair, {
        "cone": lambda A, B, *g: cone(A, B, g, spine),
        "slab": lambda A, B, *g: A != B and weights_positive(B) and slab(A, max(heights(B, g)), g, R),
        "side": lambda A, B, *fields: two_pieces(A, B) and side(A[0], B[0], *fields),
        "bent": lambda A, B, *fields: two_pieces(A, B) and bent(A[0], B[0], *fields, R)})

def check_end(vector, nodes, spine, R, at, order):
    """Section 5; at is the index of the end among spans, control points and control vectors."""
    e, d, leaves = spine.spans[at].points[at], spine.spans[at].vectors[at], [kind for kind, _ in nodes if kind != "/"]
    need(leaves == sorted(leaves, key="local".__ne__), "a leaf before a local leaf is not local")
    check_tree(nodes, (spine.spans,), partial(split_arc, order=order), {
        "local": lambda A: in_cone(A, vector), "share": lambda A, K: share(A, e, d, K, R),
        "slab": lambda A, *g: slab(A, Fraction(dot(e, g), e[3]), g, R)})

# ---- the witness of hi (section 6) ---------------------------------------------------------------------------------------

def check_upper(witness, spine, hi):
    kind, fields, *lines = witness
    need((kind == "none") == (hi == INF), "upper none, against hi")
    if kind == "curvature":
        K, T = fields
        need(K < spine.n and 0 <= T <= 1, "upper curvature: no such span or parameter")
        a, b, (w,) = ([value(f, T) for f in p] for p in (spine.spans[K].a, spine.spans[K].b, [spine.spans[K].w]))
        need(any(b) and dot(a, a)**3 <= hi**2 * dot(b, b) * w**6, "upper curvature: b = 0, or a curvature below 1/hi")
    elif kind == "corner":
        K, = fields
        need(K < spine.n and (K > 0 or spine.one_end) and not spine.smooth(K), "upper corner: no corner")
    elif kind == "contact":
        (first, last), (first2, last2) = (check_foot(line, fields, spine, hi) for line in lines)
        need(last < first2 and (not spine.closed or last2 < first + spine.n), "upper contact: not apart")
    elif kind == "crossing":
        check_crossing(strands(*fields, spine), *lines)
    elif kind == "mirror":
        check_mirror(strands(*fields, spine), *lines)

def check_foot(line, x, spine, hi):
    """A plane (one position) or a valley (three).  Answers its first and its last position."""
    feet = [(a, [p - q for p, q in zip(x, point)]) for a, point in map(spine.at, line)]
    squares = [dot(away, away) for _, away in feet]
    need(squares[len(line) // 2] <= hi**2, "plane or valley: farther than hi")
    if len(line) == 1:
        need(dot(*feet[0]) == 0, "plane: not in the normal plane")
    else:
        need(line[0] < line[1] < line[2] and line[2] - line[0] < spine.n, "valley: positions out of order")
        need(squares[1] < squares[0] and squares[1] < squares[2], "valley: not nearer than both ends")
    return line[0], line[-1]

def strands(S0, S1, T0, T1, spine):
    """Of crossing and mirror: two tuples of pieces."""
    (first, last), (first2, last2) = sorted((S0, S1)), sorted((T0, T1))
    need(0 <= first and last2 <= spine.n * (2 if spine.closed else 1), "crossing, mirror: a position outside its range")
    need(last < first2 and (not spine.closed or last2 < first + spine.n), "crossing, mirror: not apart")
    def part(k, start, end):
        need(spine.closed or k < spine.n, "crossing, mirror: beyond the end")
        span = spine.spans[k % spine.n]
        n = len(span.weights) - 1
        return Piece(segment(span.lines, [Fraction(0)] * n + [Fraction(1)] * n, start, end), span.flat, start, end)
    def strand(start, end):
        low, high = sorted((start, end))
        cuts = [(k, max(low - k, Fraction(0)), min(high - k, Fraction(1))) for k in range(floor(low), ceil(high))]
        return tuple(part(*cut) for cut in cuts) if start < end else tuple(part(k, y, x) for k, x, y in reversed(cuts))
    both = strand(S0, S1), strand(T0, T1)
    need(all(both), "crossing, mirror: an empty strand")
    need(weights_positive(both[0] + both[1]), "crossing, mirror: a weight that is not positive")
    return both

def check_mirror(both, normal):
    need(len(both[0]) == len(both[1]) == 1, "mirror: more than one piece")
    (A,), (B,) = both
    D = [f * B.w - A.w * g for f, g in zip(A.r, B.r)]
    side = dot(D, normal)
    need(not any(map(any, cross(D, normal))), "mirror: not along the normal")
    need(side[0] * side[-1] < 0, "mirror: no change of sides")

def check_crossing(both, normal, first, second):
    need(dot(normal, cross(first, second)) != 0, "crossing: the three vectors are dependent")
    need(len(set(heights(both[0] + both[1], normal))) == 1, "crossing: not in one plane")
    (start_a, *_, end_a), (start_b, *_, end_b) = [(*strand, strand[-1]) for strand in both]
    def rows(A, B, v):
        return dot(difference(A, B)[0], v)
    def change(start, end):
        start, end = ([c for row in side for c in row] for side in (start, end))
        return positive(start) and positive([-c for c in end]) or positive([-c for c in start]) and positive(end)
    need(change([rows(start_a, B, first)[0] for B in both[1]], [rows(end_a, B, first)[-1] for B in both[1]]),
         "crossing: no change of sign of D.first")
    need(change([[row[0] for row in rows(A, start_b, second)] for A in both[0]],
                [[row[-1] for row in rows(A, end_b, second)] for A in both[0]]), "crossing: no change of sign of D.second")

# ---- all of it, and the verdict (head of the page) ----------------------------------------------------------------------

def verify(curve, data):
    """All sections: the (lo, hi) that the certificate proves of delta of the curve, as Fraction or INF."""
    certificate = Certificate(data)
    lo, hi, sections = certificate.lo, certificate.hi, certificate.sections
    need(certificate.digest == curve.digest, "the certificate belongs to another curve")
    spine, R = curve.spine, Fraction(0) if lo == INF else lo
    check_tree(sections["along"][1], (spine.spans,), split_arc, {"curved": lambda A: curved(A, R)})
    need(lo == 0 or all(map(spine.smooth, range(1, spine.n))), "lo > 0, but a joint is not smooth")
    need(lo == 0 or spine.closed or not spine.one_end, "lo > 0, but the ends of an open spine are one point")
    if lo == INF:
        need(hi == INF and not spine.closed, "lo is inf, but hi is not, or the spine is closed")
        need(not any(any(f) for span in spine.spans for f in span.b), "lo is inf, but b is not 0")
    need(("start" in sections) == (R > 0 and not spine.closed), "start and finish: iff lo is > 0, not inf, and the spine open")
    if "pairs" in sections:
        check_pairs(sections["pairs"][1], spine, R)
    if "start" in sections:
        check_end(*sections["start"], spine, R, 0, 1)
        check_end(*sections["finish"], spine, R, -1, -1)
    check_upper(certificate.witness, spine, hi)
    return lo, hi

@lru_cache(16)
def read_curve(path):
    return Curve(Path(path).read_bytes())

def judge(curve, certificate):
    """The word for two files, and its explanation."""
    try:
        return "verified", "delta in %s .. %s" % verify(read_curve(curve), Path(certificate).read_bytes())
    except Verdict as verdict:
        return verdict.args
    except OSError as error:
        return "unusable", error

def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if arguments[0] == "--list":
        for line in Path(arguments[1]).read_text("utf-8").splitlines():
            print(judge(*line.split("\t"))[0])
        return 0
    word, explanation = judge(*arguments)
    print("%s: %s" % (word, explanation))
    return {"verified": 0, "rejected": 1}.get(word, 2)

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
