#!/usr/bin/env python3
"""Tubecert beside other tools, on the same curves: time, and whether the answers are right.

    python3 benches/compare.py          makes target/compare-venv with benches/requirements.txt (a peer that does not install
                                        is named and left out), runs criterion's benches, then the peers, one thread each
    python3 benches/compare.py --keep   the same with criterion's last times

Each value of a peer is compared, as an exact rational, with tubecert's enclosures from --json: an enclosure is found where a
value is within NEAR of it, relative to the size of the answer; a value near none is wrong. Timed is the way from the spine,
for a peer from its polynomials (formed here in fractions) or curves. The ratio is of least times: other work only adds.
"""
import json, os, platform, re, statistics, subprocess, sys, time, venv
from fractions import Fraction
from functools import partial
from itertools import product
from math import comb, cos, lcm, pi, sin
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CURVES, TARGET = ROOT / "tests" / "curves", ROOT / "target"
VENV, REQUIREMENTS = TARGET / "compare-venv", ROOT / "benches" / "requirements.txt"
NEAR = Fraction(1, 10**6)

# ---- set-up --------------------------------------------------------------------------------------------------------------
def reenter_in_venv():
    """Starts this script anew with the peers' Python, one thread, and without settings that could slow its BLAS down."""
    python = VENV / "bin" / "python"
    if not python.exists():
        venv.create(VENV, with_pip=True)
    for line in REQUIREMENTS.read_text().split():
        if subprocess.run([python, "-m", "pip", "install", "--quiet", line]).returncode:
            print(f"{line} does not install: left out", file=sys.stderr)
    env = {k: v for k, v in os.environ.items() if k not in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")}
    os.execve(python, [python, *sys.argv], env | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"})

def exact(text):
    """Decimals as the rationals that they spell."""
    return json.loads(text, parse_float=Fraction, parse_int=Fraction)

def answer(command, curve, *flags):
    return exact(subprocess.check_output([TARGET / "release" / "tubecert", command, curve, "--json", *flags]))

def timed(task):
    """The times of several calls; what the last one found."""
    times = []
    while len(times) < 4 or sum(times) < 0.5:
        start = time.perf_counter()
        found = task()
        times.append(time.perf_counter() - start)
    return times, found

# ---- curves; polynomials are fractions by rising power -------------------------------------------------------------------
def add(*ps):
    return [sum(p[i] for p in ps if i < len(p)) for i in range(max(map(len, ps)))]

def mul(p, *qs):
    for q in qs:
        r = [Fraction(0)] * (len(p) + len(q) - 1)
        for (i, a), (j, b) in product(enumerate(p), enumerate(q)):
            r[i + j] += a * b
        p = r
    return p

def derivative(p):
    return [i * a for i, a in enumerate(p)][1:] or [Fraction(0)]

def dot(p, q):
    return add(*map(mul, p, q))

def cross(p, q):
    return [add(mul(p[i - 2], q[i - 1]), mul([-1], mul(p[i - 1], q[i - 2]))) for i in range(3)]

def exact_quotient(p, q):
    p, r = list(p), []
    while len(p) >= len(q):
        r.append(p[-1] / q[-1])
        p = add(p, mul([-r[-1]], [0] * (len(p) - len(q)) + q))[:-1]
    assert not any(p)
    return r[::-1]

def integers(p):
    """The same polynomial times a positive integer, without zeros at the top."""
    while not p[-1]:
        p = p[:-1]
    common = lcm(*(a.denominator for a in p))
    return [int(a * common) for a in p]

def spline(curve):
    """Degree, knots, homogeneous control points."""
    n, points = int(curve["degree"]), curve["control_points"]
    knots = curve.get("knots", [Fraction(0)] * (n + 1) + [Fraction(1)] * (n + 1))
    return n, knots, [[w * x for x in [*p, 1]] for p, w in zip(points, curve.get("weights", [Fraction(1)] * len(points)))]

def segments(curve):
    """The homogeneous Bezier points of each span, by blossoms."""
    n, knots, points = spline(curve)

    def blossom(k, arguments):
        row = points[k - n:k + 1]
        for level, u in enumerate(arguments, 1):
            ratios = [(u - knots[j]) / (knots[j + n + 1 - level] - knots[j]) for j in range(k - n + level, k + 1)]
            row = [[(1 - r) * a + r * b for a, b in zip(p, q)] for r, p, q in zip(ratios, row, row[1:])]
        return row[0]

    return [[blossom(k, [knots[k]] * (n - i) + [knots[k + 1]] * i) for i in range(n + 1)]
            for k in range(n, len(points)) if knots[k] < knots[k + 1]]

def hodograph(segment):
    """X, Y, Z; the W below them; P with C' = P / W^2."""
    n = len(segment) - 1
    *xs, w = [[comb(n, j) * sum((-1) ** (j - i) * comb(j, i) * segment[i][k] for i in range(j + 1)) for j in range(n + 1)]
              for k in range(4)]
    return xs, w, [add(mul(derivative(x), w), mul([-1], mul(x, derivative(w)))) for x in xs]

def critical_curvature(segment):
    """kappa^2 = M W^6 / B^3 with W N = P x P', M = N.N, B = P.P; the numerator of its derivative, less what W gives."""
    _, w, p = hodograph(segment)
    n = [exact_quotient(c, w) for c in cross(p, [derivative(x) for x in p])]
    m, b = dot(n, n), dot(p, p)
    return integers(add(mul(derivative(m), b, w), mul([6], m, derivative(w), b), mul([-3], m, derivative(b), w)))

def stationary(segment):
    """(C(s) - C(t)).C'(s) and (C(s) - C(t)).C'(t) without denominators and without the factor s - t: {(i, j): integer}."""
    xs, w, p = hodograph(segment)
    f = {}
    for x, h in zip(xs, p):
        for (i, a), (j, b) in product(enumerate(x), enumerate(w)):
            # (s^i t^j - s^j t^i) / (s - t)
            low, high, sign = min(i, j), max(i, j), 1 if i > j else -1
            for k, (l, c) in product(range(high - low), enumerate(h)):
                key = (low + k + l, high - 1 - k)
                f[key] = f.get(key, 0) + sign * a * b * c
    f = {key: c for key, c in f.items() if c}
    f = dict(zip(f, integers(list(f.values()))))
    return f, {(j, i): c for (i, j), c in f.items()}

def torus_knot(turns, around, n):
    """That of tests/shapes, as a file."""
    angles = [(2 * pi * i / n * turns, 2 * pi * i / n * around) for i in range(n)]
    points = [[round(1000 * x) / 1000 for x in ((2 + cos(b)) * cos(a), (2 + cos(b)) * sin(a), sin(b))] for a, b in angles]
    path = TARGET / "torus_knot.json"
    path.write_text(json.dumps({"degree": 3, "control_points": points + points[:3], "knots": [*range(-3, n + 4)]}))
    return path

# ---- peers: each prepares a task, which is timed, and says how what it finds reads as enclosures -----------------------
def point(*xs):
    return [(Fraction(float(x)),) * 2 for x in xs]

def ball(x):
    (m, e), (r, f) = x.mid().man_exp(), x.rad().man_exp()
    mid, rad = int(m) * Fraction(2) ** int(e), int(r) * Fraction(2) ** int(f)
    return mid - rad, mid + rad

def flint_roots(p):
    from flint import fmpz_poly
    return fmpz_poly(p).complex_roots, lambda found: [[ball(z.real), ball(z.imag)] for z, _ in found]

def numpy_roots(p):
    import numpy as np
    return partial(np.roots, np.array(p[::-1], float)), lambda found: [point(z.real, z.imag) for z in found]

def pari_roots(p):
    from cypari import pari
    return pari(p).Polrev().polroots, lambda found: [point(z.real(), z.imag()) for z in found]

def real(roots, p):
    """Of complex roots those that are real, in [0, 1]."""
    task, enclosures = roots(p)
    return task, lambda found: [[x] for x, y in enclosures(found) if y == (0, 0) and 0 <= x[0] and x[1] <= 1]

def pari_real_roots(p):
    from cypari import pari
    return partial(pari(p).Polrev().polrootsreal, pari("[0, 1]")), lambda found: [point(z) for z in found]

def flint_pairs(f, g):
    """The resultant's real roots, and of the pairs of them those at which both polynomials enclose 0."""
    from flint import Ordering, arb, fmpz_mpoly_ctx, fmpz_poly
    context = fmpz_mpoly_ctx.get(("s", "t"), Ordering.lex)
    f, g = context.from_dict(f), context.from_dict(g)

    def task():
        rest = f.resultant(g, "s").to_dict()
        rest = fmpz_poly([rest.get((0, j), 0) for j in range(max(rest)[1] + 1)])
        real = [z.real for z, _ in rest.complex_roots() if z.imag == 0 and 0 <= z.real <= 1]
        return [(s, t) for s in real for t in real if s > t and all(
            sum((s**i * t**j * c for (i, j), c in p.terms()), arb(0)).contains(0) for p in (f, g))]

    return task, lambda found: [[ball(s), ball(t)] for s, t in found]

def pari_pairs(f, g):
    """The same; which pairs of roots belong together is decided in floating point."""
    from cypari import pari
    polynomials = [pari(" + ".join(f"{c} * s^{i} * t^{j}" for (i, j), c in p.items())) for p in (f, g)]

    def vanish(s, t):
        terms = ([c * s**i * t**j for (i, j), c in p.items()] for p in (f, g))
        return all(abs(sum(x)) < 1e-9 * sum(map(abs, x)) for x in terms)

    def task():
        real = [float(t) for t in polynomials[0].polresultant(polynomials[1], "s").polrootsreal(pari("[0, 1]"))]
        return [(s, t) for s in real for t in real if s > t and vanish(s, t)]

    return task, lambda found: [point(*x) for x in found]

def jet(curve, closed):
    """Point and derivative at parameters, and the domain."""
    from scipy.interpolate import BSpline
    n, knots, points = spline(curve)
    h = BSpline([*map(float, knots)], [[*map(float, p)] for p in points], n, extrapolate="periodic" if closed else True)
    h1 = h.derivative()

    def at(t):
        x, x1 = h(t), h1(t)
        c = x[..., :3] / x[..., 3:]
        return c, (x1[..., :3] - c * x1[..., 3:]) / x[..., 3:]

    return at, float(knots[n]), float(knots[len(points)])

def grid_pairs(curve, closed, cells):
    """scipy's fsolve from the middle of each cell of a grid where both equations change sign."""
    import numpy as np
    from scipy.optimize import fsolve
    at, start, end = jet(curve, closed)

    def equations(x):
        (c, c1), (d, d1) = at(x[0]), at(x[1])
        return [(c - d) @ c1, (c - d) @ d1]

    def task():
        u = np.linspace(start, end, cells + 1)
        c, c1 = at(u)
        # the diagonal is a zero of both
        own, both, found = (c * c1).sum(1), np.tri(cells, k=-2, dtype=bool), {}
        both[-1, 0] &= not closed
        for f in (own[:, None] - c1 @ c.T, c @ c1.T - own):
            corners = np.sign([f[:-1, :-1], f[1:, :-1], f[:-1, 1:], f[1:, 1:]])
            both &= corners.min(0) != corners.max(0)
        for i, j in zip(*np.nonzero(both)):
            x, _, converged, _ = fsolve(equations, [(u[i] + u[i + 1]) / 2, (u[j] + u[j + 1]) / 2], full_output=True)
            if closed:
                x = start + (x - start) % (end - start)
            if converged == 1 and start <= min(x) and max(x) <= end and abs(x[0] - x[1]) > 1e-3 * (end - start):
                found[tuple(np.round(sorted(x), 6))] = max(x), min(x)
        return list(found.values())

    return task, lambda found: [point(*x) for x in found]

def sampled_delta(curve, closed, n):
    """The least radius of a circle through two samples, tangent to the curve at one of them."""
    import numpy as np
    at, start, end = jet(curve, closed)

    def task():
        c, c1 = at(np.linspace(start, end, n, endpoint=not closed))
        least = np.inf
        for p, tangent in zip(c, c1 / np.linalg.norm(c1, axis=1)[:, None]):
            d = c - p
            square, along = (d * d).sum(1), d @ tangent
            with np.errstate(divide="ignore", invalid="ignore"):
                least = min(least, np.nanmin(square / (2 * np.sqrt(np.maximum(square - along**2, 0)))))
        return least

    return task, lambda least: [point(least)]

def occt_distance(curve):
    """Half the least distance of two spans with more than an eighth of the closed curve between them: that of others may
    be one of their ends."""
    from OCP import BRepBuilderAPI, BRepExtrema, Geom, gp
    from OCP.OCP.collections import Array1_gp_Pnt
    edges = []
    for segment in segments(curve):
        poles = Array1_gp_Pnt(1, len(segment))
        for i, p in enumerate(segment, 1):
            poles.SetValue(i, gp.gp_Pnt(*map(float, p[:3])))
        edges.append(BRepBuilderAPI.BRepBuilderAPI_MakeEdge(Geom.Geom_BezierCurve(poles)).Edge())
    n, distance = len(edges), BRepExtrema.BRepExtrema_DistShapeShape
    apart = [(edges[i], edges[j]) for i in range(n) for j in range(i) if n / 8 < i - j - 1 < n - 2 - n / 8]
    return (lambda: min(distance(a, b).Value() for a, b in apart) / 2), lambda found: [point(found)]

# ---- the table -----------------------------------------------------------------------------------------------------------
def shown(times):
    return f"{1e3 * min(times):.3g} ms | {1e3 * statistics.median(times):.3g} ms"

def judged(found, expected, size):
    """How many enclosures have a value near them, how many values are near none, and how far off the nearest ones are."""
    def off(value, enclosure):
        return max(max(e["lo"] - hi, lo - e["hi"], 0) for (lo, hi), e in zip(value, enclosure)) / size
    nearest = [min((off(v, e) for v in found), default=1) for e in expected]
    wrong = sum(all(off(v, e) > NEAR for e in expected) for v in found)
    right = f"{sum(d <= NEAR for d in nearest)} of {len(expected)}" + (f", {wrong} wrong" if wrong else "")
    return right, f"{float(max(nearest)):.0e}" if max(nearest) else "inside"

def questions():
    """Title, tubecert's bench, its enclosures, their size, and the peers."""
    path = CURVES / "m98_5_6_2.json"
    _, _, p = hodograph(segments(exact(path.read_text()))[0])
    p = integers(dot(p, p))
    roots = [[z["re"], z["im"]] for z in answer("squares", path, "--limit", "1")["segments"][0]["roots"]]
    yield ("complex roots of \\|C'\\|^2 of `m98_5_6_2`", "roots/complex_m98_5_6_2/6", roots, 1,
           {"flint": partial(flint_roots, p), "pari": partial(pari_roots, p), "numpy": partial(numpy_roots, p)})

    path = CURVES / "m98_5_3.json"
    curve = exact(path.read_text())
    p, equations = critical_curvature(segments(curve)[0]), stationary(segments(curve)[0])
    points = [[z["t"]] for z in answer("curvature", path)["critical_points"]]
    yield (f"critical points of curvature of `m98_5_3` (degree {len(p) - 1})", "curvature/m98_5_3", points, 1,
           {"pari, real roots": partial(pari_real_roots, p), "flint, complex roots": partial(real, flint_roots, p),
            "numpy, complex roots": partial(real, numpy_roots, p)})

    more = {"pari, by resultant": partial(pari_pairs, *equations), "flint, by resultant": partial(flint_pairs, *equations)}
    for name, bench, path in (("`m98_5_3`", "m98_5_3", path), ("`trefoil`", "trefoil", CURVES / "trefoil.json"),
                              ("a torus knot, 40 spans", "torus knot, 40 spans", torus_knot(2, 3, 40))):
        curve, closed = exact(path.read_text()), bench != "m98_5_3"
        pairs = [[z["s"], z["t"]] for z in answer("pairs", path)["pairs"]]
        grids = {f"scipy, from a grid of {n}^2": partial(grid_pairs, curve, closed, n) for n in (20, 100)}
        yield f"stationary pairs of {name}", f"pairs/{bench}", pairs, len(segments(curve)), more | grids
        delta = answer("radius", path)["delta"]
        more = {"OCCT, distances of spans": partial(occt_distance, curve)} if closed else {}
        samples = {f"numpy, {n} samples": partial(sampled_delta, curve, closed, n) for n in (500, 2000)}
        yield f"delta of {name}", f"radius/{re.sub('[, ]+', '_', bench)}", [[delta]], delta["hi"], more | samples
        more = {}

def main():
    if Path(sys.prefix) != VENV:
        reenter_in_venv()
    subprocess.check_call(["cargo", "build", "--release"], cwd=ROOT)
    if "--keep" not in sys.argv:
        benches = [part for name in ("radius", "pairs", "curvature", "roots") for part in ("--bench", name)]
        used = "(radius|pairs)/(m98_5_3|trefoil|torus)|curvature/m98_5_3|complex/m98_5_6_2"
        subprocess.check_call(["cargo", "bench", *benches, "--", used, "--warm-up-time", "1"], cwd=ROOT)
    print("| question | tool | least time | median | ratio | found | furthest off |\n|---|---|---|---|---|---|---|")
    for title, bench, expected, size, peers in questions():
        sample = json.loads((TARGET / "criterion" / bench / "new" / "sample.json").read_text())
        own = [t / 1e9 / calls for t, calls in zip(sample["times"], sample["iters"])]
        print(f"| {title} | tubecert | {shown(own)} | 1 | {len(expected)}, proved | |")
        for name, prepare in peers.items():
            try:
                task, enclosures = prepare()
            except ImportError as e:
                print(f"| | {name} | not installed: {e} | | | | |")
                continue
            times, found = timed(task)
            right, off = judged(enclosures(found), expected, size)
            print(f"| | {name} | {shown(times)} | {min(times) / min(own):,.1f} | {right} | {off} |")
    cpu = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())[1]
    rustc = subprocess.check_output(["rustc", "--version"], text=True).strip()
    print(f"\n{cpu}, one thread; {rustc}; Python {platform.python_version()};", *REQUIREMENTS.read_text().split())

if __name__ == "__main__":
    main()
