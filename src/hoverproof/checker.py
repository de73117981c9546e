"""Check a hoverproof certificate. Standard library only; imports nothing of hoverproof.

    python -I -S checker.py FILE

Exit status 0: accepted; 1: rejected; 2: not a certificate that can be read.

A certificate holds the exact numbers of a mission, a claim, and hints (multipliers). This program
takes nothing else from it: it builds every matrix itself from the equations below, in rational
arithmetic without any tolerance. Square roots are enclosed between rationals.

The closed loop (Ω3 = 0, v = δ1 + δ2, P drops the third component, A = q3* I - e3 q*ᵀ, f = f(T)):

    m δ1' = -m Ω×δ1 - k1 Q v + k1 f A(δ4 - δ3)
    m δ2' = -m Ω×δ2 + k1 Q v - k1 k2 δ2 + k1 k2 δ3 - k1 f A(δ4 - δ3)
    m δ3' = -m Ω×δ3 + k1 Q v - k1 k2 δ2 + (k1 k2 + k3) δ4 - k3 δ3
    m δ4' =           k1 P Q v - (k1 k2 + k3) P δ3 - k4 δ4

For L = ½ Σ wi|δi|² the terms in Ω drop out and -m L' = XᵀΣX, X = (δ1, δ2, δ3, δ4) ∈ R¹¹, with
Σ = Σ0(f, q*) + k1 sym(uᵀQv), u = w1 δ1 - w2 δ2 - w3 δ3 - w4 δ4. For symmetric Q with eigenvalues in
[a, b], λ = (a + b)/2, ϱ = (b - a)/2, and any τ > 0,

    uᵀQv ≥ λ uᵀv - ϱ|u||v| ≥ λ uᵀv - (ϱ/2)(τ|v|² + |u|²/τ),

so Σ ≻ t W follows from  M = Σ(λI) - (k1 ϱ/2)(τ vᵀv + uᵀu/τ) - t W ≻ 0,  which is decided by an
exact LDLᵀ, W = diag(w1 I, w2 I, w3 I, w4 I). M is affine in f and in each component of q*: the
corners of a box around them suffice. Then L' <= -(2 t/m) L.

Eigenvalues of Q over a box of positions c + δ, |δ| <= ρ: with ri the distance of point Pi from
c + δ, di that from c, and any θ > 0, wi = 1/(di + ρ)³ <= 1/ri³, s = Σ wi (Pi - c),

    xᵀQx = Σ |x × (Pi - c - δ)|²/ri³ >= Σ wi |x × (Pi - c)|² - 2 (x × s)·(x × δ) + Σ wi |x × δ|²
         >= Σ wi |x × (Pi - c)|² - θ|x × s|² - (1/θ - Σ wi) ρ²|x|²    (where 1/θ >= Σ wi).

From above: the derivative of (I - pipiᵀ)/ri along a unit vector has norm at most (2/√3)/ri², so
Q(c + δ) ⪯ Q(c) + Σ 1.155 ρ/(di - ρ)² I. A box that this does not decide is halved.
"""

import hashlib
import io
import itertools
import json
import math
import operator
import re
import sys
import textwrap
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

Row = Sequence[Fraction]
Matrix = list[list[Fraction]]
Gains = dict[str, Fraction]
Cell = list[tuple[int, int]]  # a box, its ends whole numbers of a unit of length

# What a file may ask for, so that any file is answered within seconds.
MAX_BYTES = 1_000_000
MAX_DIGITS = 80  # of a numerator or denominator
MAX_POINTS = 64
MAX_WORK = 40_000  # boxes times (points + 4), for the eigenvalues over a box
MAX_SEARCH = 560_000  # boxes times (points + 5) times 1, 3 or 4, for a region of attraction


class Question(NamedTuple):
    """The numbers of a mission that bear on the claim; intervals enclose what is irrational."""

    name: str
    m: Fraction  # mass, kg
    g: Gains  # k1 kg m/s, k2 1/m, k3 and k4 kg/s
    w: list[Fraction]  # weights of L
    thrust: list[Fraction]  # lowest and highest, N
    eigenvalues: list[Fraction]  # of Q, lowest and highest, 1/m
    box: list[list[Fraction]] | None  # positions over which the eigenvalues are to be shown, m
    points: Matrix  # target, world frame, m
    goal: list[Fraction] | None  # position, m; None where q* is given
    centroid: list[tuple[Fraction, Fraction]]  # q*
    factor: tuple[Fraction, Fraction]  # holds every f(T), 1/m
    attained: tuple[Fraction, Fraction]  # every value in it is an f(T), 1/m


class Spread(NamedTuple):
    """What a claim about Q alone rests on: neither gains nor thrust are in Q."""

    name: str
    points: Matrix  # target, world frame, m
    eigenvalues: list[Fraction]  # of Q, lowest and highest, 1/m
    box: list[list[Fraction]] | None  # positions over which they are to be shown, m


class Rejected(Exception):
    """The certificate does not prove what it claims."""


class Unreadable(Exception):
    """The file is not a certificate."""


# --- exact arithmetic ---------------------------------------------------------------------------


def positive_definite(matrix: Matrix) -> bool:
    """Tell by LDLᵀ in rational arithmetic whether a symmetric matrix is positive definite."""
    a = [list(row) for row in matrix]
    n = len(a)
    require(all(a[i][j] == a[j][i] for i in range(n) for j in range(n)), "not symmetric")
    for k in range(n):
        if a[k][k] <= 0:
            return False
        for i in range(k + 1, n):
            if a[i][k]:
                factor = a[i][k] / a[k][k]
                for j in range(k + 1, i + 1):
                    a[i][j] -= factor * a[j][k]
    return True


def square_root(s: Fraction) -> tuple[Fraction, Fraction]:
    """Return rationals low <= √s <= high, at most 2^-128 apart."""
    n = (s.numerator << 256) // s.denominator
    r = math.isqrt(n)
    exact = r * r == n and n * s.denominator == s.numerator << 256
    return Fraction(r, 1 << 128), Fraction(r if exact else r + 1, 1 << 128)


def outward(low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    """Round the ends of an interval outward to multiples of 2^-160; keep a short exact number."""
    if low == high and low.denominator < 1 << 160:
        return low, high
    unit = 1 << 160
    return Fraction(math.floor(low * unit), unit), Fraction(math.ceil(high * unit), unit)


def within(inner: Sequence[Fraction], outer: Sequence[Fraction]) -> bool:
    """Tell whether the interval `inner` lies in `outer`."""
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


# --- the model ----------------------------------------------------------------------------------


def centroid_seen(points: Matrix, position: Row) -> list[tuple[Fraction, Fraction]]:
    """Enclose q = Σ (P - ξ)/|P - ξ|; points at equal distance are added before rounding.

    What is not exact, or long, is rounded outward: sums of fractions grow longer and longer.
    """
    sums: dict[Fraction, list[Fraction]] = {}
    for point in points:
        ray = [p - x for p, x in zip(point, position, strict=True)]
        square = sum((c * c for c in ray), Fraction(0))
        require(square > 0, "the goal coincides with a target point")
        old = sums.get(square, [Fraction(0)] * 3)
        sums[square] = [a + b for a, b in zip(old, ray, strict=True)]
    box = []
    for i in range(3):
        ends = [outward(*sorted(ray[i] / r for r in square_root(s))) for s, ray in sums.items()]
        box.append(outward(*(sum((e[k] for e in ends), Fraction(0)) for k in (0, 1))))
    return box


def factor(m: Fraction, g: Gains, thrust: Fraction, q3: Fraction) -> Fraction:
    """Return f(T) = k1 k2 (k1 k2 + k3)/(m (T - c q3*)), c = k1² k2/m."""
    distance = thrust - g["k1"] ** 2 * g["k2"] / m * q3
    require(distance > 0, "the thrust interval reaches the singularity T = c q3*")
    return g["k1"] * g["k2"] * (g["k1"] * g["k2"] + g["k3"]) / (m * distance)


def closed_loop(g: Gains, Q: Matrix, f: Fraction, q: Row) -> Matrix:
    """Return the matrix B of m X' = B X (the terms in Ω left out), 11 x 11."""
    k1, k2, k3, k4 = (g[k] for k in ("k1", "k2", "k3", "k4"))
    unit = [[Fraction(int(i == j)) for j in range(11)] for i in range(11)]
    zero = [Fraction(0)] * 11
    d1, d2, d3, d4 = unit[0:3], unit[3:6], unit[6:9], [unit[9], unit[10], zero]

    def mix(*terms: tuple[Fraction | int, Row]) -> list[Fraction]:
        return [sum((c * row[j] for c, row in terms), Fraction(0)) for j in range(11)]

    v = [mix((1, d1[i]), (1, d2[i])) for i in range(3)]
    flow = [mix(*((k1 * Q[i][j], v[j]) for j in range(3))) for i in range(3)]
    e = [mix((1, d4[i]), (-1, d3[i])) for i in range(3)]
    turn = [mix((k1 * f * q[2], e[i])) for i in range(3)]  # k1 f A (δ4 - δ3)
    turn[2] = mix((1, turn[2]), *((-k1 * f * q[j], e[j]) for j in range(3)))
    rows = [mix((-1, flow[i]), (1, turn[i])) for i in range(3)]
    for i in range(3):
        damped = ((1, flow[i]), (-k1 * k2, d2[i]))
        rows.append(mix(*damped, (k1 * k2, d3[i]), (-1, turn[i])))
    for i in range(3):
        damped = ((1, flow[i]), (-k1 * k2, d2[i]))
        rows.append(mix(*damped, (k1 * k2 + k3, d4[i]), (-k3, d3[i])))
    for i in range(2):
        rows.append(mix((1, flow[i]), (-(k1 * k2 + k3), d3[i]), (-k4, d4[i])))
    return rows


def diagonal(w: Row) -> list[Fraction]:
    """Return the diagonal of W, (11,)."""
    return [w[0]] * 3 + [w[1]] * 3 + [w[2]] * 3 + [w[3]] * 2


def sigma(g: Gains, w: Row, Q: Matrix, f: Fraction, q: Row) -> Matrix:
    """Return Σ = -sym(W B) for L = ½ XᵀWX."""
    weight = diagonal(w)
    b = closed_loop(g, Q, f, q)
    n = range(11)
    return [[-(weight[i] * b[i][j] + weight[j] * b[j][i]) / 2 for j in n] for i in n]


def out_of_bounds(points: Matrix, position: Row, x: Row, bound: Fraction, *, lower: bool) -> bool:
    """Tell whether xᵀQx is shown to be below (lower) or above bound·|x|² at a position."""
    xx, total = sum((a * a for a in x), Fraction(0)), Fraction(0)
    for point in points:  # xᵀQx = Σ (|x|² - (x·pi)²)/ri, rounded against the claim
        ray = [a - b for a, b in zip(point, position, strict=True)]
        square = sum((a * a for a in ray), Fraction(0))
        require(square > 0, "the position is that of a target point")
        along = sum((a * b for a, b in zip(ray, x, strict=True)), Fraction(0))
        total += (xx - along**2 / square) / square_root(square)[0 if lower else 1]
    return total < bound * xx if lower else total > bound * xx


class Grid(NamedTuple):
    """Lengths as whole numbers of a unit that divides every coordinate of the target."""

    unit: int  # of them are 1 m
    points: list[list[int]]

    @classmethod
    def of(cls, points: Matrix) -> "Grid":
        """Lay the grid of a target."""
        unit = 2**20 * math.lcm(*(c.denominator for point in points for c in point))
        require(unit < 10**40, "the coordinates of the target are too long")
        return cls(unit, [[int(c * unit) for c in point] for point in points])

    def cover(self, box: Matrix) -> Cell:
        """Round a box outward."""
        require(all(abs(end) < 10**9 for side in box for end in side), "a box is too far away")
        return [(math.floor(a * self.unit), math.ceil(b * self.unit)) for a, b in box]


def halves(cell: Cell) -> list[Cell]:
    """Halve a cell along its longest side."""
    k = max(range(len(cell)), key=lambda i: cell[i][1] - cell[i][0])
    middle = sum(cell[k]) // 2
    return [
        [side if i == k else old for i, old in enumerate(cell)]
        for side in ((cell[k][0], middle), (middle, cell[k][1]))
    ]


def eigenvalues_hold(
    points: Matrix, box: Matrix, low: Fraction, high: Fraction, most: int | None = None
) -> bool:
    """Tell whether low I ≺ Q ≺ high I is shown for every position in a box, halving it at need.

    The box is rounded outward to the grid, so every matrix is one of integers.
    """
    grid = Grid.of(points)
    low, high = low / grid.unit, high / grid.unit
    cells = [grid.cover(box)]
    limit = MAX_WORK // (len(points) + 4)
    for _ in range(limit if most is None else min(limit, most)):
        if not cells:
            return True
        cell = cells.pop()
        if not eigenvalues_hold_near(grid.points, cell, low, high):
            center: Cell = [((a + b) // 2,) * 2 for a, b in cell]
            if not eigenvalues_hold_near(grid.points, center, low, high):
                return False  # not even there
            cells += halves(cell)
    return False


def eigenvalues_hold_near(
    points: list[list[int]], cell: Cell, low: Fraction, high: Fraction
) -> bool:
    """Show it for a whole cell at once, without halving, in integers; see the top of this file."""
    _, square, radius, rays, near = around(points, cell)
    if not largest_below(rays, near, radius, high):
        return False
    scale = 1 << (64 + 3 * max(near).bit_length())  # weights and bounds are multiples of 1/scale
    weights = [scale // (d + 1 + radius) ** 3 for d in near]
    total = sum(weights)
    s = [sum(w * ray[i] for w, ray in zip(weights, rays, strict=True)) for i in range(3)]
    below, lost = turns(weights, rays), turns([1], [s])
    bottom = math.ceil(scale * low)
    for k in (2, 4, 16, 64, 2**20):  # 1/θ = k Σ wi; the inequality is multiplied by that
        matrix = [
            [k * total * a - b for a, b in zip(*r, strict=True)]
            for r in zip(below, lost, strict=True)
        ]
        if positive_definite_3(matrix, 1, -k * total * (bottom + (k - 1) * total * square)):
            return True
    return False


def around(
    points: list[list[int]], cell: Cell
) -> tuple[list[int], int, int, list[list[int]], list[int]]:
    """Return the centre of a cell, ρ² and ρ, the rays from the centre, and their lengths.

    A length d stands for one in [d, d + 1]; ρ is rounded up.
    """
    center = [(a + b) // 2 for a, b in cell]
    square = sum((b - c) ** 2 for (_, b), c in zip(cell, center, strict=True))  # b - c >= c - a
    rays = [[p - c for p, c in zip(point, center, strict=True)] for point in points]
    near = [math.isqrt(sum(x * x for x in ray)) for ray in rays]
    return center, square, math.isqrt(square) + 1, rays, near


def largest_below(rays: list[list[int]], near: list[int], radius: int, high: Fraction) -> bool:
    """Show Q ≺ high I for a whole cell at once."""
    if min(near) <= radius:
        return False
    scale = 1 << (64 + 3 * max(near).bit_length())
    top = scale * high.numerator // high.denominator
    if sum(scale // (d - radius) + 1 for d in near) < top:  # Q ⪯ Σ 1/ri is enough
        return True
    steep = sum(1155 * scale * radius // (1000 * (d - radius) ** 2) + 1 for d in near)
    return positive_definite_3(turns([scale // d**3 + 1 for d in near], rays), -1, top - steep)


def turns(weights: Sequence[int], rays: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the matrix of Σ wi |x × di|², that is Σ wi (|di|² I - di diᵀ)."""
    pairs = list(zip(weights, rays, strict=True))
    xx, yy, zz = (sum(w * d[i] * d[i] for w, d in pairs) for i in range(3))
    xy, yz, zx = (-sum(w * d[i] * d[i - 2] for w, d in pairs) for i in range(3))
    return [[yy + zz, xy, zx], [xy, zz + xx, yz], [zx, yz, xx + yy]]


def positive_definite_3(matrix: list[list[int]], sign: int, shift: int) -> bool:
    """Tell by its leading minors whether sign·matrix + shift·I is positive definite."""
    (a, b, c), (_, d, e), (_, _, f) = ([sign * x for x in row] for row in matrix)
    a, d, f = a + shift, d + shift, f + shift
    minor = a * d - b * b
    return a > 0 and minor > 0 and f * minor > a * e * e - 2 * b * c * e + d * c * c


def bound(
    g: Gains, w: Row, eigenvalues: Row, f: Fraction, q: Row, tau: Fraction, t: Fraction
) -> Matrix:
    """Return M = Σ(λI) - (k1 ϱ/2)(τ vᵀv + uᵀu/τ) - t W."""
    low, high = eigenvalues
    middle, spread = (low + high) / 2, (high - low) / 2
    M = sigma(g, w, [[middle * (i == j) for j in range(3)] for i in range(3)], f, q)
    loss = g["k1"] * spread / 2
    for axis in range(3):  # u and v on each axis, as rows of length 11
        u, v = [Fraction(0)] * 11, [Fraction(0)] * 11
        v[axis] = v[3 + axis] = Fraction(1)
        u[axis], u[3 + axis], u[6 + axis] = w[0], -w[1], -w[2]
        if axis < 2:
            u[9 + axis] = -w[3]
        for i, j in itertools.product(range(11), repeat=2):
            M[i][j] -= loss * (tau * v[i] * v[j] + u[i] * u[j] / tau)
    for i, weight in enumerate(diagonal(w)):
        M[i][i] -= t * weight
    return M


# --- the certificate ----------------------------------------------------------------------------


def require(condition: object, reason: str) -> None:
    """Reject the certificate for a reason unless the condition holds."""
    if not condition:
        raise Rejected(reason)


def number(text: Any) -> Fraction:
    """Read an exact rational in lowest terms, written as "p" or "p/q"."""
    good = isinstance(text, str) and re.fullmatch(r"-?[0-9]+(/[0-9]+)?", text, re.A)
    require(good, f"not an exact number: {str(text)[:40]!r}")
    size = max(map(len, text.lstrip("-").split("/")))
    require(size <= MAX_DIGITS, f"a number is longer than {MAX_DIGITS} digits: {text[:40]!r}")
    top, _, bottom = text.partition("/")
    require(bottom == "" or int(bottom) > 0, "a denominator is zero")
    value = Fraction(int(top), int(bottom or 1))
    require(str(value) == text, f"not in lowest terms: {text[:40]!r}")
    return value


def numbers(values: Any, *shape: int | None) -> Any:
    """Read nested lists of numbers of a shape; None stands for any length up to MAX_POINTS."""
    if not shape:
        return number(values)
    fits = isinstance(values, list) and (
        len(values) <= MAX_POINTS if shape[0] is None else len(values) == shape[0]
    )
    require(fits, "a list is misshapen")
    return [numbers(entry, *shape[1:]) for entry in values]


def keys(value: Any, wanted: Sequence[str], where: str) -> Any:
    """Make sure that an object has just the wanted keys."""
    require(isinstance(value, dict), f"{where} is not an object")
    require(set(value) == set(wanted), f"{where} must have the keys {', '.join(wanted)}")
    return value


def matches(text: Any, pattern: str) -> bool:
    """Tell whether a value is a string of a form."""
    return isinstance(text, str) and re.fullmatch(pattern, text, re.A) is not None


def digest(value: Any) -> str:
    """Return the SHA-256 of a JSON value in canonical form.

    Parameters
    ----------
    value : mapping
        A JSON object.
    """
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


COMMON = (
    *("format", "version", "kind", "statement", "mission", "mission_sha256", "model_sha256"),
    *("tools", "goal_position", "sha256"),
)
TOOLS = ("hoverproof", "casadi", "cvxpy", "clarabel")
GAINS = ("k1", "k2", "k3", "k4", "k_yaw")
SECTIONS = ("name", "vehicle", "target", "goal", "gains", "bounds", "start")


class Setting(NamedTuple):
    """What a mission says of vehicle, target and goal; q* is enclosed."""

    name: str
    m: Fraction  # mass, kg
    gravity: Fraction  # m/s²
    g: Gains
    points: Matrix
    centroid: list[tuple[Fraction, Fraction]]
    goal: list[Fraction] | None  # position, m


def read_setting(c: Any) -> Setting:
    """Return the numbers of vehicle, gains, target and goal."""
    mission = keys(c["mission"], SECTIONS, "mission")
    require(matches(mission["name"], r"[\w.-]{1,64}"), "the mission has no proper name")
    require(c["mission_sha256"] == digest(mission), "the mission is not the one that was hashed")
    vehicle = keys(
        mission["vehicle"], ("mass", "inertia", "arm", "drag_ratio", "gravity"), "vehicle"
    )
    g = {k: number(v) for k, v in keys(mission["gains"], GAINS, "gains").items()}
    m, gravity = number(vehicle["mass"]), number(vehicle["gravity"])
    rest = [*numbers(vehicle["inertia"], 3), number(vehicle["arm"]), number(vehicle["drag_ratio"])]
    require(min(m, gravity, *g.values(), *rest) > 0, "vehicle and gains must be positive")
    start = keys(mission["start"], ("position", "velocity", "rotation", "rates"), "start")
    numbers(list(start.values()), 4, 3)
    bounds = mission["bounds"]
    require(isinstance(bounds, dict), "bounds is not an object")
    auto = bounds.get("eigenvalues") == "auto"  # to be shown over a box, which may be named
    named = ("box",) if auto and "box" in bounds else ()
    keys(bounds, ("eigenvalues", *named, "thrust" if "thrust" in bounds else "level"), "bounds")
    if named:
        numbers(bounds["box"], 3, 2)
    if not auto:
        numbers(bounds["eigenvalues"], 2)
    numbers(bounds["thrust"], 2) if "thrust" in bounds else number(bounds["level"])
    points = numbers(keys(mission["target"], ("points",), "target")["points"], None, 3)
    require(len(points) >= 2, f"a target has 2 to {MAX_POINTS} points")
    goal = mission["goal"]
    require(isinstance(goal, dict), "goal is not an object")
    if "height" in goal:
        height = number(keys(goal, ("height",), "goal")["height"])
        position = numbers(c["goal_position"], 3)
        mean = sum(p[2] for p in points) / len(points)
        require(position[2] == mean - height, "the goal is not at the height of the mission")
        require(all(p[2] > position[2] for p in points), "a target point is above the goal")
        centroid = centroid_seen(points, position)
        level_off = max(abs(end) for ends in centroid[:2] for end in ends)
        require(level_off < Fraction(1, 10**9), "the centroid at the goal is not vertical")
    else:
        q = numbers(keys(goal, ("centroid",), "goal")["centroid"], 3)
        require(c["goal_position"] is None, "a goal by centroid has no position here")
        require(q[2] > 0 and sum(x * x for x in q) < len(points) ** 2, "no hover sees this q*")
        position, centroid = None, [(x, x) for x in q]
    return Setting(mission["name"], m, gravity, g, points, centroid, position)


def read_spread(c: Any, read: Setting | None = None) -> Spread:
    """Return target, box and bounds of a claim about Q; the setting may have been read."""
    s, bounds = read or read_setting(c), c["mission"]["bounds"]
    require(min(numbers(c["weights"], 4)) > 0, "weights must be positive")
    region = keys(c["region"], ("box", "eigenvalues"), "region")
    eigenvalues, box = numbers(region["eigenvalues"], 2), None
    require(0 < eigenvalues[0] < eigenvalues[1], "the eigenvalue bounds are not in order")
    if region["box"] is None:
        assumed = region["eigenvalues"] == bounds["eigenvalues"]
        require(assumed, "without a box, the eigenvalue bounds are those of the mission")
    else:
        box = numbers(region["box"], 3, 2)
        require(all(a <= b for a, b in box), "the box is not in order")
    return Spread(s.name, s.points, eigenvalues, box)


def read_mission(c: Any) -> Question:
    """Return the numbers of the mission that bear on the claim, and enclosures made from them."""
    name, m, gravity, g, points, centroid, goal = setting = read_setting(c)
    _, _, eigenvalues, box = read_spread(c, setting)
    w, bounds = numbers(c["weights"], 4), c["mission"]["bounds"]
    stiffness = g["k1"] ** 2 * g["k2"] / m

    if "thrust" in bounds:
        thrust = numbers(bounds["thrust"], 2)
        require(thrust[0] <= m * gravity <= thrust[1], "the thrust interval does not hold m g")
    else:
        level = number(bounds["level"])
        require(level > 0, "the level must be positive")
        reach = stiffness * square_root(2 * level * (1 / w[1] + 1 / w[2]))[1]
        thrust = [m * gravity - reach, m * gravity + reach]

    def f(thrust: Fraction, q3: Fraction) -> Fraction:
        return factor(m, g, thrust, q3)

    (low, high), (q_low, q_high) = thrust, centroid[2]
    return Question(
        name=name,
        m=m,
        g=g,
        w=w,
        thrust=thrust,
        eigenvalues=eigenvalues,
        box=box,
        points=points,
        goal=goal,
        centroid=centroid,
        factor=(f(high, q_low), f(low, q_high)),
        attained=(f(high, q_high), f(low, q_low)),
    )


def verify_gains(c: Any, p: Question) -> None:
    """Verify a proof of Σ ≻ margin·W, hence of the decay of L."""
    keys(c["enclosures"], ("centroid", "factor", "goal"), "enclosures")
    box = numbers(c["enclosures"]["centroid"], 3, 2)
    span = numbers(c["enclosures"]["factor"], 2)
    for mine, given in zip(p.centroid, box, strict=True):
        require(within(mine, given), "the box around q* does not hold q*")
    require(within(p.factor, span), "the interval of f does not hold f(T)")
    require(isinstance(c["vertices"], list) and len(c["vertices"]) == 2, "two vertices are needed")
    margin, rate = (number(c["claim"][k]) for k in ("margin", "decay_rate"))
    require(margin > 0, "a margin of zero or less proves nothing")
    require(rate == 2 * margin / p.m, "the decay rate does not follow from the margin")
    margins = []
    for f, vertex in zip(span, c["vertices"], strict=True):
        keys(vertex, ("factor", "multiplier", "margin", "decay_rate"), "vertex")
        require(number(vertex["factor"]) == f, "a vertex is not at an end of the interval of f")
        tau, t = number(vertex["multiplier"]), number(vertex["margin"])
        require(tau > 0, "a multiplier must be positive")
        require(number(vertex["decay_rate"]) == 2 * t / p.m, "a rate is not that of its margin")
        for q in itertools.product(*(sorted(set(ends)) for ends in box)):
            M = bound(p.g, p.w, p.eigenvalues, f, q, tau, t)
            require(positive_definite(M), "Σ - margin·W is not shown to be positive definite")
        margins.append(t)
    require(margin == min(margins), "the margin is not the smallest of the vertices")
    verify_region(c, p)
    spot = numbers(c["enclosures"]["goal"], 3, 2)
    require(
        goal_within(p.points, p.goal, p.centroid, spot, p.eigenvalues),
        "Q at the goal is not shown to be within the bounds of its eigenvalues",
    )


def goal_within(
    points: Matrix,
    goal: Row | None,
    centroid: Sequence[tuple[Fraction, Fraction]],
    box: Matrix,
    eigenvalues: Row,
) -> bool:
    """Tell whether a box is shown to hold the goal, and low I ≺ Q ≺ high I all over it.

    A goal by its centroid q* is where the convex Σ|P'i - ξ| + q*ᵀξ, of slope q* - q and Hessian
    Q ≻ low I, is least. On the largest ball about the middle of the box, of radius r, it is higher
    than in the middle if |q - q*| < low r/2 there.
    """
    if any(a > b for a, b in box) or not eigenvalues_hold(
        points, box, eigenvalues[0], eigenvalues[1], 1000
    ):
        return False
    if goal is not None:
        return all(a <= x <= b for x, (a, b) in zip(goal, box, strict=True))
    seen = centroid_seen(points, [(a + b) / 2 for a, b in box])
    slope = sum(
        max(abs(x - y) for x in ends for y in want) ** 2
        for ends, want in zip(seen, centroid, strict=True)
    )
    radius = min(b - a for a, b in box) / 2
    return slope < (eigenvalues[0] * radius / 2) ** 2


def theorem_of_gains(c: Any, p: Question) -> str:
    """Say in words what is proved."""
    claim = keys(c["claim"], ("margin", "decay_rate"), "claim")
    margin, rate = about(number(claim["margin"])), about(number(claim["decay_rate"]))
    weights = ", ".join(map(str, p.w))
    stays = "Q and T stay in these intervals (which is assumed of Q, not shown for the target)"
    region = ""
    if p.box is not None:
        stays, region = (
            "the vehicle stays in that box and T in its interval",
            theorem_of_region(c, p) + " ",
        )
    return (
        f"For {setting(p)}, the matrix Σ(Q, T) is positive definite: XᵀΣX > {margin} kg/s times "
        f"Σ wi|δi|² for all X ≠ 0, w = ({weights}). {region}Hence, while {stays} and Ω3 = 0, the "
        f"Lyapunov function L = ½ Σ wi|δi|² falls at least as fast as exp(-r t), r = {rate} 1/s. "
        "At the goal Q is within this interval."
    )


def verify_region(c: Any, p: Question | Spread) -> None:
    """Verify the eigenvalue bounds over the box, if one is claimed."""
    if p.box is not None:
        shown = eigenvalues_hold(p.points, p.box, p.eigenvalues[0], p.eigenvalues[1])
        require(shown, "the eigenvalue bounds are not shown to hold over the box")


def theorem_of_region(c: Any, p: Question | Spread) -> str:
    """Say in words over which box the eigenvalue bounds hold."""
    require(p.box is not None, "a claim about a region has a box")
    sides = " x ".join(f"[{about(a)}, {about(b)}]" for a, b in p.box or [])
    low, high = map(about, p.eigenvalues)
    return (
        f"For the target of the mission {p.name} and every position in the box {sides} m, the "
        f"eigenvalues of Q lie between {low} and {high} 1/m."
    )


def verify_outside(c: Any, p: Spread) -> None:
    """Verify that Q has an eigenvalue out of bounds at a position in the box."""
    spot = c["outside"]
    position, x = numbers(spot["position"], 3), numbers(spot["direction"], 3)
    inside = all(a <= y <= b for y, (a, b) in zip(position, p.box or (), strict=True))
    require(inside, "the position is not in the box")
    lower = spot["bound"] == "lower"
    out = out_of_bounds(p.points, position, x, p.eigenvalues[0 if lower else 1], lower=lower)
    require(out, "the eigenvalue of Q there is not shown to be out of bounds")


def theorem_of_outside(c: Any, p: Spread) -> str:
    """Say in words what is refuted."""
    spot = keys(c["outside"], ("position", "direction", "bound"), "outside")
    require(spot["bound"] in ("lower", "upper"), "the bound is neither lower nor upper")
    side = "smaller" if spot["bound"] == "lower" else "larger"
    value = p.eigenvalues[0 if side == "smaller" else 1]
    position = ", ".join(map(str, numbers(spot["position"], 3)))
    return (
        f"It is not true that {theorem_of_region(c, p)[:-1]}: at the position ({position}) m in "
        f"that box, Q has an eigenvalue {side} than {about(value)} 1/m."
    )


def verify_counterexample(c: Any, p: Question) -> None:
    """Verify that Σ(Q, f) is not positive semidefinite at one admissible point."""
    point = c["counterexample"]
    Q, X = numbers(point["Q"], 3, 3), numbers(point["X"], 11)
    f, value = number(point["f"]), number(point["value"])
    n = range(3)
    require(all(Q[i][j] == Q[j][i] for i in n for j in n), "Q is not symmetric")
    low, high = p.eigenvalues
    above = [[Q[i][j] - (low if i == j else 0) for j in n] for i in n]
    below = [[(high if i == j else 0) - Q[i][j] for j in n] for i in n]
    inside = positive_definite(above) and positive_definite(below)
    require(inside, "the eigenvalues of Q are not inside the interval")
    require(within((f, f), p.attained), "no thrust in the interval gives this f")
    values = []
    for q in itertools.product(*p.centroid):
        S = sigma(p.g, p.w, Q, f, q)
        values.append(sum(X[i] * S[i][j] * X[j] for i in range(11) for j in range(11)))
    require(max(values) <= value < 0, "XᵀΣX is not as negative as claimed")
    verify_region(c, p)


def theorem_of_counterexample(c: Any, p: Question) -> str:
    """Say in words what is refuted."""
    point = keys(c["counterexample"], ("Q", "f", "X", "value"), "counterexample")
    return (
        f"It is not true that, for {setting(p)}, the matrix Σ(Q, T) is positive definite: for the "
        f"given rational Q and X, and the thrust with f(T) = {about(number(point['f']))} 1/m, "
        f"XᵀΣX <= {about(number(point['value']))} < 0."
    )


def setting(p: Question) -> str:
    """Say in words for which vehicle, gains and intervals."""
    gains = ", ".join(f"{k} = {p.g[k]}" for k in GAINS[:4])
    q = ", ".join(f"{float((a + b) / 2):.12g}" for a, b in p.centroid)
    (a, b), (t, u) = p.eigenvalues, p.thrust
    return (
        f"the mission {p.name} (m = {p.m} kg, {gains}, q* = ({q}) to 12 digits), every "
        f"symmetric Q with eigenvalues in [{a}, {b}] 1/m and every thrust T in "
        f"[{about(t)}, {about(u)}] N"
    )


def about(x: Fraction) -> str:
    """Write a rational number so that a person sees its size."""
    return str(x) if len(str(x)) < 6 else f"{x} (about {float(x):.6g})"


# --- regions of attraction ----------------------------------------------------------------------
#
# For an axial goal, q* = (0, 0, q3*), let G(ξ) = Σ |P'i - ξ| + q3* z, W = G - min G, e = q - q3* ρ,
# θ = Pρ/(1 + ρ3), η = (q3* c/(m g)) (P - e3 θᵀ)(δ3 - δ2), v = e + η + δ2 = (m/k1) V. With
# u = -(a2 δ2 + a3 δ3 + a4 δ4), K = (k1 k2 + k3)/k1, and whatever Ω is, the derivative of
# Λ = W + ½(a2|δ2|² + a3|δ3|² + a4|δ4|²) is given by
#
#   -(m/k1) Λ' = eᵀv + uᵀQv + a2 [k2|δ2|² - k2 δ2ᵀδ3 + f q3* δ2ᵀP(δ4 - δ3)]
#                + a3 [k2 δ3ᵀδ2 - K δ3ᵀδ4 + (k3/k1)|δ3|²] + a4 [K δ4ᵀδ3 + (k4/k1)|δ4|²],
#
# where uᵀQv >= (λ/2)(uᵀv - ½(τ|v|² + |u|²/τ)) for 0 ⪯ Q ⪯ λ I. It is affine in f, in q3* and in θ,
# and a turn about e3 carries one θ to all of its length: both ends of f and q3*, and θ = (t, 0),
# suffice. On {Λ <= ℓ, T > 0}, |F| <= d = c √(2ℓ(1/a2 + 1/a3)): |T - m g| <= d, and the tilt φ has
# sin φ <= d/(m g), |θ| = tan(φ/2). G is least at one point; were that a target point, no hover
# would see q3*, but then W <= ℓ at a target point, where Q has no bound.
#
# Barrier: with κ = (k1 k2 + k3)/m, N = z + (m/(k1 k2))(z' + z''/κ) obeys N' = (k1/m) w, where
# w <= qz - q3* + ω, ω = q3*(1 - cos φ) + sin φ √(2ℓ((1 + γ)²/a4 + γ²/a3)), γ = c q3*/(T - c q3*),
# largest at the largest tilt and the least thrust, T = m g - d. qz = Σ hi/ri; no hi/ri falls as the
# vehicle rises (it jumps from -1 to 1 through the point). If k3 >= 3 k1 k2, let r <= s have
# r + s = κ, r s = κ k1 k2/m; then x = z + z'/r obeys x' = s (N - x), z' = r (x - z). So N - x and
# x - z keep below lags D1 >= (k1/m) max w/s and D2 >= s D1/r, and if w <= 0 wherever
# z >= zb - D1 - D2, none of N, x, z passes zb. Proofs of all this are in proofs/.


class Attraction(NamedTuple):
    """What follows from mission, weights and level before anything about positions is shown."""

    s: Setting
    a: list[Fraction]  # weights a2, a3, a4
    level: Fraction
    q3: tuple[Fraction, Fraction]  # holds q3*
    force: Fraction  # bounds |F|, N
    sine: Fraction  # bounds sin φ
    cosine: Fraction  # below cos φ
    bottom: Fraction | None  # zb, m
    grid: Grid
    pull: tuple[int, int]  # q3*, in units of 1/ONE, rounded outward
    range: tuple[int, int]  # min G and level + min G, rounded outward, in units of the grid/ONE


ONE = 1 << 64  # fractions of a cell's bounds are whole multiples of 1/ONE


def read_attraction(c: Any) -> Attraction:
    """Return the numbers of the question, and bounds that follow from the level."""
    s = read_setting(c)
    q3, n = s.centroid[2], len(s.points)
    require(all(end == 0 for ends in s.centroid[:2] for end in ends), "the goal is not axial")
    require(q3[0] > 0 and q3[1] < n, "no hover sees this q3*")
    require(len({(x, y) for x, y, _ in s.points}) > 1, "the target is one vertical line")
    a, claim = numbers(c["weights"], 3), c["claim"]
    keys(claim, ("level", "rate", "barrier_height", "reach", "starts"), "claim")
    level = number(claim["level"])
    require(min(*a, level, number(claim["rate"])) > 0, "weights, level and rate must be positive")
    hover = numbers(c["hover"], 3)
    require(s.goal in (None, hover), "the hover point is not the goal")
    low, high = (  # of Σ |P'i - hover|
        sum((r[k] for r in (square_root(length(p, hover)) for p in s.points)), Fraction(0))
        for k in (0, 1)
    )
    pull = [end * hover[2] for end in q3]
    # min G >= G(hover) - |∇G||ξ* - hover|, where G(ξ*) <= G(hover) bounds the distance
    wanted = ((Fraction(0),) * 2, (Fraction(0),) * 2, q3)
    seen = zip(centroid_seen(s.points, hover), wanted, strict=True)
    slope = sum((max(abs(x - y) for x in ends for y in want) for ends, want in seen), Fraction(0))
    base = outward(low + min(pull) - slope * 2 * high / (n - q3[1]), high + max(pull))
    stiffness, weight = s.g["k1"] ** 2 * s.g["k2"] / s.m, s.m * s.gravity
    force = stiffness * square_root(2 * level * (1 / a[0] + 1 / a[1]))[1]
    require(weight - force > stiffness * q3[1], "the thrust reaches the singularity T = c q3*")
    sine, bottom = force / weight, claim["barrier_height"]
    if bottom is not None:
        bottom = sum((p[2] for p in s.points), Fraction(0)) / n - number(bottom)
    cosine, grid = square_root(1 - sine**2)[0], Grid.of(s.points)
    whole = (math.floor(ONE * q3[0]), math.ceil(ONE * q3[1]))
    unit = grid.unit * ONE
    span = (math.floor(unit * base[0]), math.ceil(unit * (base[1] + level)))
    return Attraction(s, a, level, q3, force, sine, cosine, bottom, grid, whole, span)


def length(p: Row, q: Row) -> Fraction:
    """Return the square of the distance of two points."""
    return sum(((a - b) ** 2 for a, b in zip(p, q, strict=True)), Fraction(0))


def dissipation(
    p: Attraction, high: Fraction, f: Fraction, q3: Fraction, t: Fraction, tau: Fraction
) -> Matrix:
    """Return the matrix of the lower bound of -(m/k1) Λ' at θ = (t, 0), for all 0 ⪯ Q ⪯ high I."""
    k1, k2, k3, k4 = (p.s.g[k] for k in GAINS[:4])
    (a2, a3, a4), K, one = p.a, (k1 * k2 + k3) / k1, Fraction(1)
    unit = [[Fraction(int(i == j)) for j in range(11)] for i in range(11)]
    zero = [Fraction(0)] * 11
    e, d2, d3, d4 = unit[0:3], unit[3:6], unit[6:9], [unit[9], unit[10], zero]

    def mix(*terms: tuple[Fraction, Matrix]) -> Matrix:
        return [
            [sum((c * rows[i][j] for c, rows in terms), Fraction(0)) for j in range(11)]
            for i in range(3)
        ]

    eta = mix((q3 * k1**2 * k2 / (p.s.m**2 * p.s.gravity), mix((one, d3), (-one, d2))))
    eta[2] = [-t * x for x in eta[0]]
    v, u = mix((one, e), (one, eta), (one, d2)), mix((-a2, d2), (-a3, d3), (-a4, d4))
    turn = [*mix((one, d4), (-one, d3))[:2], zero]
    M = [[Fraction(0)] * 11 for _ in range(11)]
    for weight, left, right in (
        (one, e, v),
        (a2 * k2, d2, mix((one, d2), (-one, d3))),
        (a2 * f * q3, d2, turn),
        (a3, d3, mix((k2, d2), (-K, d4), (k3 / k1, d3))),
        (a4, d4, mix((K, d3), (k4 / k1, d4))),
        (high / 2, u, v),
        (-high * tau / 4, v, v),
        (-high / (4 * tau), u, u),
    ):
        for x, y in zip(left, right, strict=True):
            for i, j in itertools.product(range(11), repeat=2):
                if x[i] and y[j]:
                    M[i][j] += weight * x[i] * y[j] / 2
                    M[j][i] += weight * x[i] * y[j] / 2
    return M


def verify_attraction(c: Any, p: Attraction) -> None:
    """Verify that the set is not left, and that Λ falls in it as claimed."""
    s, weight = p.s, p.s.m * p.s.gravity
    hints = keys(c["enclosures"], ("goal", "factor", "tilt", "largest_eigenvalue"), "enclosures")
    goal, span = numbers(hints["goal"], 2), numbers(hints["factor"], 2)
    tilt, high = number(hints["tilt"]), number(hints["largest_eigenvalue"])
    require(high > 0 and within(p.q3, goal), "the interval of q3* does not hold it")
    low = factor(s.m, s.g, weight + p.force, p.q3[0])
    require(
        within((low, factor(s.m, s.g, weight - p.force, p.q3[1])), span),
        "the interval of f does not hold f(T)",
    )
    require(tilt * (1 + p.cosine) >= p.sine, "tan(φ/2) is not below the bound of the tilt")
    rate, multipliers = number(c["claim"]["rate"]), numbers(c["multipliers"], 2)
    require(min(multipliers) > 0, "a multiplier must be positive")
    for (f, tau), q3 in itertools.product(zip(span, multipliers, strict=True), goal):
        M = dissipation(p, high, f, q3, tilt, tau)
        for i in range(11):
            M[i][i] -= rate
        require(positive_definite(M), "-(m/k1) Λ' is not shown to be above rate·|Y|²")
    starts, work = [*reach_starts(c), *read_starts(c)], Work(MAX_SEARCH)
    if p.bottom is not None:
        barrier_holds(p, p.bottom, starts, work)
    held = positions_hold(p, high, work)
    require(held, "the largest eigenvalue of Q is not shown to be bounded")
    for start in starts:
        start_holds(p, start, work)


class Work:
    """The work that may still be done for a certificate, in units that take about as long."""

    def __init__(self, most: int) -> None:
        self.left = most

    def may(self, amount: int) -> bool:
        """Take so much of it, and tell whether it was there."""
        self.left -= amount
        return self.left >= 0


def positions_hold(p: Attraction, high: Fraction, work: Work) -> bool:
    """Tell whether Q ≺ high I is shown wherever W <= ℓ and z <= zb.

    Farther than n/high from every target point, Q ⪯ Σ 1/ri does not reach high.
    """
    near, box = len(p.s.points) / high, []
    for i in range(3):
        box.append([min(x[i] for x in p.s.points) - near, max(x[i] for x in p.s.points) + near])
    if p.bottom is not None:
        box[2][1] = min(box[2][1], p.bottom)
    cells = [p.grid.cover(box)] if box[2][0] <= box[2][1] else []
    top = high / p.grid.unit
    while cells and work.may(3 * (len(p.s.points) + 5)):
        cell = cells.pop()
        center, _, radius, rays, distances = around(p.grid.points, cell)
        if not largest_below(rays, distances, radius, top):
            part = below_level(p, center, cell, rays, distances)
            cells += [] if part is None else halves(part)
    return not cells


def below_level(
    p: Attraction, center: list[int], cell: Cell, rays: list[list[int]], near: list[int]
) -> Cell | None:
    """Return the part of a cell where W <= ℓ may be; None if it is nowhere.

    W is convex, so it is above its tangent plane at the centre.
    """
    if min(near) == 0:
        return cell
    value = ONE * sum(near) + min(end * center[2] for end in p.pull) - p.range[1]
    slopes, falls = [], []
    for i, (_, b) in enumerate(cell):
        low, high = p.pull if i == 2 else (0, 0)
        for ray, d in zip(rays, near, strict=True):  # -ray/distance, the distance in [d, d + 1]
            parts = (-ONE * ray[i] // d, -ONE * ray[i] // (d + 1))
            low, high = low + min(parts), high + max(parts) + 1
        slopes.append((low, high))
        falls.append(max(abs(low), abs(high)) * (b - center[i]))
    if value > sum(falls):
        return None
    part = []
    for (a, b), x, (low, high), fall in zip(cell, center, slopes, falls, strict=True):
        room = sum(falls) - fall - value  # what the slope along this axis may take
        if low > 0 and room >= 0:
            b = min(b, x + room // low + 1)
        elif high < 0 and room >= 0:
            a = max(a, x - room // -high - 1)
        part.append((a, b))
    return part


class Start(NamedTuple):
    """A set of states, with any heading and any yaw rate."""

    position: Matrix  # box, m
    radius: Fraction | None  # bounds the horizontal distance from the middle of the box, m
    speed: Fraction  # bounds |V|, m/s
    tilt: Fraction  # bounds φ, rad
    rate: Fraction  # bounds √(Ω1² + Ω2²), rad/s
    thrust: Fraction  # bounds |T - m g|, N


def read_starts(c: Any) -> list[Start]:
    """Read the sets of states that are claimed to be inside."""
    values, starts = c["claim"]["starts"], []
    require(isinstance(values, list) and len(values) <= 16, "starts is not a list of at most 16")
    for value in values:
        keys(value, ("position", "speed", "tilt", "rate", "thrust"), "a start")
        box = numbers(value["position"], 3, 2)
        sizes = [number(value[k]) for k in ("speed", "tilt", "rate", "thrust")]
        require(all(a <= b for a, b in box) and min(sizes) >= 0, "a start is not in order")
        starts.append(Start(box, None, *sizes))
    return starts


def reach_of(c: Any) -> list[Fraction]:
    """Read how far hovers are certified: sideways, up and down, m."""
    names = ("sideways", "up", "down")
    reach = [number(keys(c["claim"]["reach"], names, "reach")[k]) for k in names]
    require(min(reach) >= 0, "a reach is negative")
    return reach


def reach_starts(c: Any) -> list[Start]:
    """Return the hovers about the goal: a disc at its height, and a line from below to above."""
    x, y, z = numbers(c["hover"], 3)
    side, up, down = reach_of(c)
    still = (Fraction(0),) * 4
    disc = [[x - side, x + side], [y - side, y + side], [z, z]]
    return [Start(disc, side, *still), Start([[x, x], [y, y], [z - up, z + down]], None, *still)]


def barrier_holds(p: Attraction, bottom: Fraction, starts: Sequence[Start], work: Work) -> None:
    """Verify that no motion from the starts passes below z = bottom while Λ <= ℓ."""
    s, (_, a3, a4), weight = p.s, p.a, p.s.m * p.s.gravity
    k1, k2, k3 = (s.g[k] for k in GAINS[:3])
    require(k3 >= 3 * k1 * k2, "a barrier needs k3 >= 3 k1 k2")
    singular = k1**2 * k2 / s.m * p.q3[1]
    gamma = singular / (weight - p.force - singular)
    spread = square_root(2 * p.level * ((1 + gamma) ** 2 / a4 + gamma**2 / a3))[1]
    omega = p.q3[1] * (1 - p.cosine) + p.sine * spread
    limit, most = p.q3[0] - omega, len(s.points) - p.q3[0] + omega
    require(limit > 0, "the tilt lifts the barrier out of reach")
    kappa, product = (k1 * k2 + k3) / s.m, (k1 * k2 + k3) * k1 * k2 / s.m**2  # r + s, r s
    low, high = square_root(kappa**2 - 4 * product)
    slow, slow_above, fast, fast_above = ((kappa + x) / 2 for x in (-high, -low, low, high))
    require(slow > 0, "a pole is too near zero")
    first, second = k1 / s.m * most / fast, Fraction(0)
    for start in starts:  # z' <= speed and z'' <= |F|/m there
        second_rate = (start.thrust + weight * start.tilt) / s.m
        first = max(first, (second_rate + slow_above * start.speed) / product)
        second = max(second, start.speed / slow)
        ahead = max(start.speed / slow, s.m / (k1 * k2) * (start.speed + second_rate / kappa))
        require(start.position[2][1] + ahead <= bottom, "a start sinks below the barrier")
    lag = first + max(second, fast_above * first / slow)
    require(height_part_below(p, bottom - lag, limit, work), "the barrier is not shown to hold")


def height_part_below(p: Attraction, z: Fraction, limit: Fraction, work: Work) -> bool:
    """Tell whether qz = Σ hi/ri < limit is shown for all positions at a height."""
    heights = [max(math.ceil((point[2] - z) * p.grid.unit), 0) for point in p.s.points]
    far = Fraction(sum(heights) + 1, p.grid.unit) / limit  # farther out every ri is above it
    ends = [[x[i] for x in p.s.points] for i in (0, 1)]
    cells = [p.grid.cover([[min(line) - far, max(line) + far] for line in ends])]
    most = math.ceil(ONE * limit)
    while cells and work.may(len(p.s.points) + 5):
        cell, total = cells.pop(), 0
        for point, h in zip(p.grid.points, heights, strict=True):
            gaps = (max(a - x, x - b, 0) for x, (a, b) in zip(point, cell, strict=False))
            total += ONE * h // max(math.isqrt(sum((g * g for g in gaps), h * h)), 1) + 1
        if total >= most:
            cells += halves(cell)
    return not cells


def start_holds(p: Attraction, start: Start, work: Work) -> None:
    """Verify that Λ <= ℓ in a set of states, and that the thrust is above the singularity."""
    weight, stiffness = p.s.m * p.s.gravity, p.s.g["k1"] ** 2 * p.s.g["k2"] / p.s.m
    require(weight - start.thrust > stiffness * p.q3[1], "a thrust at the start is too low")
    require(p.bottom is None or start.position[2][1] <= p.bottom, "a start is below the barrier")
    cells = [p.grid.cover(start.position)]
    middle, shares = [sum(side) for side in cells[0][:2]], shares_of(p, start)
    rim = math.ceil((2 * p.grid.unit * (start.radius or 0) + 2) ** 2)
    while cells and work.may(4 * (len(p.s.points) + 5)):
        cell = cells.pop()
        if start.radius is not None:  # leave out what is farther from the axis
            gaps = (max(2 * a - x, x - 2 * b, 0) for (a, b), x in zip(cell, middle, strict=False))
            if sum(gap * gap for gap in gaps) > rim:
                continue
        terms = start_terms(p, shares, cell)
        if terms is None or terms[0] + dot(p.a, terms[1:]) > p.level:
            widest = max(b - a for a, b in cell)
            require(widest > p.grid.unit >> 16, "a start is not shown to have Λ <= level")
            cells += halves(cell)
    require(not cells, "a set of starts is not shown to have Λ <= level")


def dot(x: Row, y: Row) -> Fraction:
    """Return xᵀy."""
    return sum((a * b for a, b in zip(x, y, strict=True)), Fraction(0))


class Shares(NamedTuple):
    """What speed, lean, rates and thrust of a start add to |δ|, in units of 1/ONE, rounded up."""

    moved: int  # by the speed
    lean: int  # by the tilt, through the force
    push: int  # by the thrust
    turned: int  # by the rates
    tilted: int  # of q3* by the tilt
    tilted_all: int  # of q by the tilt


def shares_of(p: Attraction, start: Start) -> Shares:
    """Return what a start that moves adds; to lean by φ adds at most m g φ to |F|."""
    s, weight = p.s, p.s.m * p.s.gravity
    k1, k2, k3 = (s.g[k] for k in GAINS[:3])
    stiffness = k1**2 * k2 / s.m
    room = weight + start.thrust - stiffness * p.q3[0]
    shares = [
        s.m / k1 * start.speed,
        weight / stiffness * start.tilt,
        start.thrust / stiffness,
        s.m / (stiffness * (k1 * k2 + k3)) * room * start.rate,
        p.q3[1] * start.tilt,
        len(s.points) * start.tilt,
    ]
    return Shares(*(math.ceil(ONE * x) for x in shares))


def start_terms(p: Attraction, add: Shares, cell: Cell) -> list[Fraction] | None:
    """Bound W and half the squares of δ2, δ3, δ4 for positions in a cell; None if too near.

    W is convex, so its corners bound it; q changes by at most Σ 1/ri a metre, and by at most φ
    where unit vectors are turned by φ.
    """
    _, _, radius, rays, near = around(p.grid.points, cell)
    if min(near) <= radius:
        return None
    highest = p.range[0]
    for a, b, c in itertools.product(*(sorted(set(side)) for side in cell)):
        squares = ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 for x, y, z in p.grid.points)
        far = sum(math.isqrt(square) + 1 for square in squares)
        highest = max(highest, ONE * far + max(end * c for end in p.pull))
    change = sum(ONE * radius // (d - radius) + 1 for d in near)
    sizes = []  # of q - q* at the centre
    for i, (low, high) in enumerate(((0, 0), (0, 0), (-p.pull[1], -p.pull[0]))):
        for ray, d in zip(rays, near, strict=True):
            parts = (ONE * ray[i] // d, ONE * ray[i] // (d + 1))
            low, high = low + min(parts), high + max(parts) + 1
        sizes.append(max(abs(low), abs(high)))
    flat = math.isqrt(sizes[0] ** 2 + sizes[1] ** 2) + 1 + change
    d1 = math.isqrt(sum(x * x for x in sizes)) + 1 + change + add.tilted
    d2 = add.moved + d1
    d3 = add.push + add.lean + d2
    d4 = add.turned + add.lean + add.moved + flat + add.tilted_all
    W = Fraction(highest - p.range[0], p.grid.unit * ONE)
    return [W, *(Fraction(d * d, 2 * ONE * ONE) for d in (d2, d3, d4))]


def theorem_of_attraction(c: Any, p: Attraction) -> str:
    """Say in words what is proved."""
    s, claim = p.s, c["claim"]
    gains = ", ".join(f"{k} = {s.g[k]}" for k in GAINS[:4])
    if p.bottom is None:
        states = "state of the set {Λ <= level, T > 0}"
        stays = ". This knows no ground: on its way the motion may pass below the target points"
    else:
        height = f", at least {about(number(claim['barrier_height']))} m above the mean height"
        states = f"level hover at rest with Λ <= level{height} of the target points"
        stays = "; it stays in {Λ <= level, T > 0} and at that height or above it"
    side, up, down = map(about, reach_of(c))
    hover = ", ".join(map(about, numbers(c["hover"], 3)))
    others = "".join(f", and in every {state_of(start)}" for start in read_starts(c))
    return (
        f"For the mission {s.name} (m = {s.m} kg, g = {s.gravity} m/s², {gains}, goal straight "
        f"below with q3* = {float(sum(p.q3) / 2):.12g} to 12 digits) let Λ = W + ½(a2|δ2|² + "
        f"a3|δ3|² + a4|δ4|²), W = Σ|P'i - ξ| + q3* z less its minimum, (a2, a3, a4) = "
        f"({', '.join(map(about, p.a))}), level = {about(p.level)}. With the exact model and "
        f"controller in continuous time and all target points seen, the controller may be switched "
        f"on, with any heading and yaw rate, in every {states}: the motion converges to the hover "
        f"at the goal{stays}. On the way Λ <= level and Λ' <= -(k1/m) "
        f"{about(number(claim['rate']))} (|q - q3* ρ|² + |δ2|² + |δ3|² + |δ4|²). This holds in "
        f"every level hover at rest up to {side} m sideways of the point ({hover}) m at its "
        f"height, up to {up} m above it and {down} m below it{others}."
    )


def state_of(start: Start) -> str:
    """Describe a set of states."""
    sides = [about(a) if a == b else f"[{about(a)}, {about(b)}]" for a, b in start.position]
    place = f"position in ({', '.join(sides)}) m"
    if not any((start.speed, start.tilt, start.rate, start.thrust)):
        return f"level hover at rest with {place}"
    return (
        f"state with {place}, |V| <= {about(start.speed)} m/s, tilt <= {about(start.tilt)} rad, "
        f"√(Ω1² + Ω2²) <= {about(start.rate)} rad/s, |T - m g| <= {about(start.thrust)} N"
    )


# --- motions that sink to the target ------------------------------------------------------------
#
# Let q* = q3* e3 and Ω3 = 0. In world axes, with b = R e3, w = b', D = T - c q3*, c = k1² k2/m,
# κ = (k1 k2 + k3)/m, y = (m g/c) e3 + (m/k1) ξ' - Σ (P'i - ξ)/ri, the closed loop is
#
#   ξ'' = g e3 - (T/m) b,   T' = κ(c bᵀy - D),   w' = (cκ/D)(I - bbᵀ) a - |w|² b - h w,
#   a = (m g/k1) e3 + (κ + k4/m) y,   h = (T' + cκ bᵀy)/D + k4/m.
#
# With 1/D and 1/ri as unknowns of their own, (1/D)' = -T'/D², (1/ri)' = (P'i - ξ)ᵀξ'/ri³, the right
# sides are polynomials. For a step s let ci hold the Taylor coefficients z⁽ⁱ⁾(0) sⁱ/i! of all
# motions that start in a box Z, and d those of order p in Z + 2r, r = |c1| + … + |c(p-1)| + 2^-50.
# Until a motion from Z leaves Z + 2r it is within r + |d| of its start. So if |d| <= 2^-50, it does
# not leave within the step, hence exists, and ends in c0 + ... + c(p-1) + d.

BITS, ORDER, ACCURACY = 192, 20, 50  # numbers are multiples of 2^-BITS; |d| <= 2^-ACCURACY
MAX_SERIES = 800  # expansions times (points + 3)
MAX_TIME = 60  # s


class Ball:
    """The numbers within `rad` of `mid`, both whole multiples of 2^-BITS."""

    __slots__ = ("mid", "rad")

    def __init__(self, mid: int, rad: int = 0) -> None:
        self.mid, self.rad = mid, rad

    @classmethod
    def over(cls, low: Fraction, high: Fraction) -> "Ball":
        """Enclose an interval."""
        bottom, top = math.floor(low * (1 << BITS)), math.ceil(high * (1 << BITS))
        return cls((bottom + top) // 2, (top - bottom + 1) // 2)

    def __add__(self, other: "Ball") -> "Ball":
        return Ball(self.mid + other.mid, self.rad + other.rad)

    def __sub__(self, other: "Ball") -> "Ball":
        return Ball(self.mid - other.mid, self.rad + other.rad)

    def __mul__(self, other: "Ball") -> "Ball":
        rad = self.size() * other.rad + self.rad * other.size()
        return Ball(self.mid * other.mid >> BITS, (rad >> BITS) + 2)

    def size(self) -> int:
        """Bound the absolute value."""
        return abs(self.mid) + self.rad


class Series:
    """Taylor coefficients: their middles, radii and sizes."""

    __slots__ = ("mid", "rad", "size")

    def __init__(self, *balls: Ball) -> None:
        self.mid: list[int] = []
        self.rad: list[int] = []
        self.size: list[int] = []
        for ball in balls:
            self.append(ball)

    def append(self, ball: Ball) -> None:
        """Add a coefficient."""
        self.mid.append(ball.mid)
        self.rad.append(ball.rad)
        self.size.append(ball.size())

    def __getitem__(self, i: int) -> Ball:
        return Ball(self.mid[i], self.rad[i])


NOUGHT = Ball(0)


def product(x: Series, y: Series) -> Ball:
    """Return the last coefficient of the product of two series."""
    return inner([x], [y])


def inner(x: Sequence[Series], y: Sequence[Series]) -> Ball:
    """Return the last coefficient of xᵀy."""
    mid = rad = 0
    for a, b in zip(x, y, strict=True):
        mid += sum(map(operator.mul, a.mid, b.mid[::-1]))
        rad += sum(map(operator.mul, a.size, b.rad[::-1]))
        rad += sum(map(operator.mul, a.rad, b.size[::-1]))
    return Ball(mid >> BITS, (rad >> BITS) + 2)


class Motion(NamedTuple):
    """A motion that is claimed to sink, from above, to the height of the lowest target point."""

    s: Setting
    start: list[list[Fraction]]  # intervals of ξ, ξ', b, w in world axes, and of T
    time: Fraction  # s
    depth: Fraction  # z of the lowest target point, m


def read_motion(c: Any) -> Motion:
    """Read the start of a motion and for how long it is to be followed."""
    s, given = read_setting(c), keys(c["motion"], (*STATE, "thrust", "time"), "motion")
    require(all(end == 0 for ends in s.centroid[:2] for end in ends), "the goal is not axial")
    start = [side for name in STATE for side in numbers(given[name], 3, 2)]
    start.append(numbers(given["thrust"], 2))
    require(all(low <= high for low, high in start), "the start is not in order")
    require(inhabited(start[6:9], start[9:12]), "no state is shown to be in the start")
    time, depth = number(given["time"]), max(point[2] for point in s.points)
    require(0 < time <= MAX_TIME, f"the time is not above 0 s and at most {MAX_TIME} s")
    require(start[2][1] < depth, "the start is not above the lowest target point")
    return Motion(s, start, time, depth)


def inhabited(axis: Matrix, turning: Matrix) -> bool:
    """Show that intervals hold a unit vector b and a w across it, bᵀw = 0.

    |b|² takes every value between its least and its greatest in the box, so 1 too. If for each b
    of the box, bᵀw is nowhere above 0 for the w that make it least, nor below for the w that make
    it greatest, then it is 0 for some w.
    """
    squares = [[max(a, -b, Fraction(0)) ** 2, max(-a, b) ** 2] for a, b in axis]
    least = greatest = Fraction(0)
    for (a, b), (u, v) in zip(axis, turning, strict=True):
        ends = [a, b, Fraction(0)] if a < 0 < b else [a, b]
        least += max(min(x * u, x * v) for x in ends)  # concave in x, with a corner at 0
        greatest += min(max(x * u, x * v) for x in ends)
    low, high = (sum((pair[k] for pair in squares), Fraction(0)) for k in (0, 1))
    return low <= 1 <= high and least <= 0 <= greatest


STATE = ("position", "velocity", "axis", "turning")


def unknowns(p: Motion) -> list[Ball]:
    """Enclose ξ, ξ', b, w, T, 1/D and every 1/ri at the start."""
    c = p.s.g["k1"] ** 2 * p.s.g["k2"] / p.s.m
    ends = [p.start[12][0] - c * p.s.centroid[2][1], p.start[12][1] - c * p.s.centroid[2][0]]
    require(ends[0] > 0, "the thrust at the start is not above the singularity T = c q3*")
    boxes = [*p.start, [1 / ends[1], 1 / ends[0]]]
    for point in p.s.points:
        sides = [[a - x, b - x] for (a, b), x in zip(p.start, point, strict=False)]
        near = sum((max(a, -b, Fraction(0)) ** 2 for a, b in sides), Fraction(0))
        far = sum((max(-a, b) ** 2 for a, b in sides), Fraction(0))
        require(near > 0, "the start is at a target point")
        boxes.append([1 / square_root(far)[1], 1 / square_root(near)[0]])
    return [Ball.over(*box) for box in boxes]


def taylor(p: Motion, z: Sequence[Ball], step: Fraction, order: int) -> list[Series]:
    """Return the coefficients up to an order, times stepⁱ, of all motions from a box."""
    m, g, (k1, k2, k3, k4) = p.s.m, p.s.gravity, (p.s.g[k] for k in GAINS[:4])
    c, kappa = k1**2 * k2 / m, (k1 * k2 + k3) / m
    exact = [c, kappa, c * kappa, k4 / m, kappa + k4 / m, m / k1, 1 / m, g, m * g / c, m * g / k1]
    C, K, CK, H, quick, slow, light, G, far, pull = fixed = [Ball.over(x, x) for x in exact]
    points = [[Ball.over(x, x) for x in point] for point in p.s.points]
    singular = Ball.over(*(c * q3 for q3 in p.s.centroid[2]))
    largest = max(x.size() for x in (*fixed, *z, *itertools.chain(*points)))
    require(largest < 10**12 << BITS, "a number is out of reach")
    series, n = [Series(x) for x in z], len(points)
    xi, v, b, w = (series[i : i + 3] for i in (0, 3, 6, 9))
    T, x, u = series[12], series[13], series[14:]
    rays, (y, a) = [empty(3) for _ in points], (empty(3), empty(3))
    closing, u2, u3 = empty(n), empty(n), empty(n)
    by, ba, rise, swing, gain, x2, inward, brake = empty(8)
    for i in range(order):
        first = i == 0  # then constants count
        for j in range(n):
            for k in range(3):
                rays[j][k].append((points[j][k] if first else NOUGHT) - xi[k][i])
            closing[j].append(inner(rays[j], v))
            u2[j].append(product(u[j], u[j]))
            u3[j].append(product(u2[j], u[j]))
        for k in range(3):
            up = first and k == 2
            bent = slow * v[k][i] - inner([ray[k] for ray in rays], u)
            y[k].append(bent + far if up else bent)
            quicker = quick * y[k][i]
            a[k].append(quicker + pull if up else quicker)
        by.append(inner(b, y))
        ba.append(inner(b, a))
        lift = C * by[i] - T[i]
        rise.append(K * (lift + singular if first else lift))
        swing.append(rise[i] + CK * by[i])
        gain.append(CK * x[i])
        x2.append(product(x, x))
        inward.append(product(gain, ba) + inner(w, w))
        braked = product(swing, x)
        brake.append(braked + H if first else braked)
        rates = [
            *(side[i] for side in v),
            *(NOUGHT - light * product(T, side) for side in b),
            *(side[i] for side in w),
            *(product(gain, a[k]) - product(inward, b[k]) - product(brake, w[k]) for k in range(3)),
            rise[i],
            NOUGHT - product(x2, rise),
            *(product(u3[j], closing[j]) for j in range(n)),
        ]
        rates[5] += G if first else NOUGHT
        part = Ball.over(step / (i + 1), step / (i + 1))
        for line, rate in zip(series, rates, strict=True):
            line.append(part * rate)
    return series


def empty(count: int) -> list[Series]:
    """Return series without coefficients."""
    return [Series() for _ in range(count)]


def advance(p: Motion, z: Sequence[Ball], step: Fraction) -> list[Ball] | None:
    """Enclose where all motions from a box are after a step; None if that is not shown."""
    series, most = taylor(p, z, step, ORDER - 1), 1 << (BITS - ACCURACY)
    reach = [sum(line.size[1:]) + most for line in series]
    if max(reach) >> (BITS + 20) or max(line.size[-1] for line in series) > 256 * most:
        return None
    hull = [Ball(x.mid, x.rad + 2 * r + 1) for x, r in zip(z, reach, strict=True)]
    rest = [line[ORDER] for line in taylor(p, hull, step, ORDER)]
    if any(x.size() > most for x in rest):
        return None
    ends = zip(series, rest, strict=True)
    return [Ball(sum(line.mid) + x.mid, sum(line.rad) + x.rad) for line, x in ends]


def verify_motion(c: Any, p: Motion) -> None:
    """Verify that the motion exists for the time, and where it ends."""
    z, left, step, work = unknowns(p), p.time, Fraction(1, 8), Work(MAX_SERIES)
    wait = 0  # steps until a longer one is tried again
    while left and work.may(2 * (len(p.s.points) + 3)):
        step = min(step, left)
        new = advance(p, z, step)
        if new is None:
            step, wait = step / 2, 4
        else:
            z, left, wait = new, left - step, wait - 1
            step *= 2 if wait < 0 else 1
    require(not left, "the motion is not followed to its end")
    sunk = z[2].mid - z[2].rad >= p.depth * (1 << BITS)
    require(sunk, "the motion is not shown to sink to the lowest target point")


def theorem_of_motion(c: Any, p: Motion) -> str:
    """Say in words from where the vehicle sinks to the target."""
    gains = ", ".join(f"{k} = {p.s.g[k]}" for k in GAINS[:4])
    sides = [about(a) if a == b else f"[{about(a)}, {about(b)}]" for a, b in p.start]
    place, speed, axis, turning = (", ".join(sides[i : i + 3]) for i in (0, 3, 6, 9))
    return (
        f"It is not true that, for the mission {p.s.name} (m = {p.s.m} kg, g = {p.s.gravity} m/s², "
        f"{gains}, goal straight below with q3* = {float(sum(p.s.centroid[2]) / 2):.12g} to 12 "
        f"digits), the vehicle stays above the lowest target point, z < {about(p.depth)} m, for "
        f"{about(p.time)} s from a state with position ({place}) m, velocity ({speed}) m/s and "
        f"thrust {sides[12]} N whose body axis e3 is ({axis}) and turns at ({turning}) 1/s, all in "
        f"world axes, with yaw rate zero. There is such a state. With the exact model and "
        f"controller in continuous time, all target points seen and any heading, the motion from "
        f"every such state, which is above that height, exists for {about(p.time)} s, T > c q3* "
        f"on the way, and at their end the vehicle is at that height or lower: z >= "
        f"{about(p.depth)} m. What comes after is not said."
    )


class Kind(NamedTuple):
    """A kind of certificate: its own keys, how they are read, what it says and how it is shown."""

    keys: tuple[str, ...]
    theorem: Callable[[Any, Any], str]
    verify: Callable[[Any, Any], None]
    read: Callable[[Any], Any] = read_mission


LYAPUNOV = ("weights", "region")
KINDS = {
    "gains": Kind((*LYAPUNOV, "enclosures", "vertices", "claim"), theorem_of_gains, verify_gains),
    "counterexample": Kind(
        (*LYAPUNOV, "counterexample"), theorem_of_counterexample, verify_counterexample
    ),
    "region": Kind(LYAPUNOV, theorem_of_region, verify_region, read_spread),
    "outside": Kind((*LYAPUNOV, "outside"), theorem_of_outside, verify_outside, read_spread),
    "attraction": Kind(
        ("weights", "hover", "enclosures", "multipliers", "claim"),
        theorem_of_attraction,
        verify_attraction,
        read_attraction,
    ),
    "sinking": Kind(("motion",), theorem_of_motion, verify_motion, read_motion),
}


def statement(certificate: Any) -> str:
    """Return the theorem that a certificate claims, in words.

    Parameters
    ----------
    certificate : mapping
        The JSON object.
    """
    kind = KINDS[certificate["kind"]]
    return stated(certificate, kind.read(certificate))


def stated(c: Any, question: Any) -> str:
    """Say in words what is claimed, and of which mission, whose numbers and hash were verified."""
    mission = c["mission"]
    points = ", ".join(f"({', '.join(point)})" for point in mission["target"]["points"])
    return (
        f"{KINDS[c['kind']].theorem(c, question)} The mission {mission['name']} is the one whose "
        f"numbers have the SHA-256 {c['mission_sha256']}; its target points are {points} m, in "
        "world axes, z down."
    )


def check(certificate: Any) -> str:
    """Return the theorem that a certificate (an object read from JSON) proves.

    Raises Rejected if it does not prove what it claims.

    Parameters
    ----------
    certificate : mapping
        The JSON object.
    """
    try:
        return checked(certificate)
    except (ArithmeticError, RecursionError) as error:  # numbers or nesting out of any reason
        raise Rejected(f"{type(error).__name__} while checking: {error}") from None


def checked(certificate: Any) -> str:
    """Do the work of `check`."""
    require(isinstance(certificate, dict), "the certificate is not an object")
    kind = certificate.get("kind")
    require(isinstance(kind, str) and kind in KINDS, "unknown kind of certificate")
    keys(certificate, COMMON + KINDS[kind].keys, "certificate")
    head, version = certificate["format"], certificate["version"]
    known = head == "hoverproof certificate" and type(version) is int and version == 1
    require(known, "not version 1 of the format")
    require(matches(certificate["model_sha256"], "[0-9a-f]{64}"), "model_sha256 is no SHA-256")
    tools = keys(certificate["tools"], TOOLS, "tools").values()
    require(all(matches(v, r"[\w.+-]{1,64}") for v in tools), "a tool has no proper version")
    rest = {k: v for k, v in certificate.items() if k != "sha256"}
    require(certificate["sha256"] == digest(rest), "the file was changed after it was written")
    question = KINDS[kind].read(certificate)
    theorem = stated(certificate, question)
    require(certificate["statement"] == theorem, f"the statement is not what is proved: {theorem}")
    KINDS[kind].verify(certificate, question)
    return theorem


def read(path: Any) -> Any:
    """Read a certificate file: JSON without floats, duplicate keys or constants such as NaN."""

    def refuse(what: str) -> Any:
        raise Unreadable(f"holds {what}")

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(dict(pairs)) < len(pairs):
            refuse("the same key twice")
        return dict(pairs)

    try:
        with open(path, "rb") as file:  # noqa: PTH123
            data = file.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise Unreadable(f"is larger than {MAX_BYTES} bytes")
        return json.loads(
            data.decode("utf-8"),
            parse_float=lambda text: refuse("a rounded number; exact ones are strings"),
            parse_int=lambda text: int(text) if len(text) < 10 else refuse("a long bare integer"),
            parse_constant=refuse,
            object_pairs_hook=unique,
        )
    except OSError as error:
        raise Unreadable(error.strerror or str(error)) from None
    except (ValueError, RecursionError) as error:
        wanted = "a certificate, as certify, region and attraction write it"
        raise Unreadable(f"is not JSON, and so not {wanted}: {str(error)[:100]}") from None


def check_file(path: Any) -> str:
    """Return the theorem that a certificate file proves.

    Raises Rejected if it does not prove what it claims, Unreadable if it is not a certificate.

    Parameters
    ----------
    path : Path or str
        A certificate or a counterexample.
    """
    return check(read(path))


def main(arguments: list[str]) -> int:
    """Check the file named on the command line; return the exit status.

    Parameters
    ----------
    arguments : sequence of str
        The path of the certificate.
    """
    if len(arguments) != 1:
        print("usage: checker.py FILE", file=sys.stderr)
        return 2
    for stream in (sys.stdout, sys.stderr):  # a terminal may know few letters
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        certificate = read(arguments[0])
    except Unreadable as error:
        print(f"{arguments[0]}: {error}", file=sys.stderr)
        return 2
    return tell(arguments[0], certificate)


def tell(name: str, certificate: Any) -> int:
    """Print whether a certificate is accepted; return the exit status.

    Parameters
    ----------
    name : str
        Of the file.
    certificate : mapping
        The JSON object.
    """
    try:
        theorem = check(certificate)
    except Rejected as error:
        print(f"{name}: rejected: {error}")
        return 1
    print(f"{name}: accepted")
    print(
        textwrap.fill(f"Proved: {theorem}", width=80, initial_indent="  ", subsequent_indent="  ")
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
