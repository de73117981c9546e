"""Check a hoverproof certificate. Standard library only; imports nothing of hoverproof.

    python -I -S checker.py FILE

Exit status 0: accepted; 1: rejected; 2: not a certificate that can be read.

A certificate holds the exact numbers of a mission, a claim, and hints: multipliers, how boxes are
halved, time steps. This program takes nothing else from it, and searches for nothing: it builds
every matrix itself from the equations below and verifies the hints in exact arithmetic, without
any tolerance. What is irrational is enclosed between rationals. Proofs of all theorems are in
proofs/README.md.

Chapters: numbers; forms; the file; the model; covers of boxes by cells; then each theorem as
equations, reading, verification, words: gains, eigenvalues over a box, regions of attraction,
motions that sink.
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
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

Row = Sequence[Fraction]
Matrix = list[list[Fraction]]
Interval = tuple[Fraction, Fraction]
ZERO = Fraction(0)
Cell = list[tuple[int, int]]  # a box, its ends whole numbers of a unit of length

# What a file may ask for, so that any file is answered within seconds.
VERSION = 2
MAX_BYTES = 1_000_000
MAX_DIGITS = 80  # of a numerator or denominator
MAX_POINTS = 64
MAX_WORK = 800_000  # cells times (points + 5) times what one costs, over all trees
MAX_STEPS = 500  # of a motion, times (points + 3)
MAX_TIME = 60  # s


class Rejected(Exception):
    """The certificate does not prove what it claims."""


class Unreadable(Exception):
    """The file is not a certificate of this version."""


def require(condition: object, reason: str) -> None:
    """Reject the certificate for a reason unless the condition holds."""
    if not condition:
        raise Rejected(reason)


# --- numbers ------------------------------------------------------------------------------------


def total(values: Iterable[Fraction]) -> Fraction:
    """Return a sum of fractions."""
    return sum(values, Fraction(0))


def square_root(s: Fraction) -> Interval:
    """Return rationals low <= √s <= high, at most 2^-128 apart."""
    n = (s.numerator << 256) // s.denominator
    r = math.isqrt(n)
    exact = r * r == n and n * s.denominator == s.numerator << 256
    return Fraction(r, 1 << 128), Fraction(r if exact else r + 1, 1 << 128)


def outward(low: Fraction, high: Fraction) -> Interval:
    """Round the ends of an interval outward to multiples of 2^-160; keep a short exact number."""
    if low == high and low.denominator < 1 << 160:
        return low, high
    unit = 1 << 160
    return Fraction(math.floor(low * unit), unit), Fraction(math.ceil(high * unit), unit)


def within(inner: Row, outer: Row) -> bool:
    """Tell whether the interval `inner` lies in `outer`."""
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


def definite(a: list[list[int]]) -> bool:
    """Tell whether a symmetric matrix of whole numbers, which is overwritten, is positive definite.

    By Sylvester's criterion: Bareiss' elimination leaves the leading minors on the diagonal.
    """
    last = 1
    for k, row in enumerate(a):
        pivot = row[k]
        if pivot <= 0:
            return False
        for i in range(k + 1, len(a)):
            below, factor = a[i], a[i][k]
            for j in range(k + 1, i + 1):
                below[j] = (below[j] * pivot - factor * a[j][k]) // last
        last = pivot
    return True


def about(x: Fraction) -> str:
    """Write a rational number so that a person sees its size."""
    return str(x) if len(str(x)) < 6 else f"{x} (about {float(x):.6g})"


def interval(low: Fraction, high: Fraction) -> str:
    """Write an interval in words, a single number as such."""
    return about(low) if low == high else f"[{about(low)}, {about(high)}]"


# --- forms --------------------------------------------------------------------------------------


class Form(dict[tuple[int, ...], Fraction]):
    """A linear or quadratic form in X ∈ R¹¹: the coefficient of each Xi, or each Xi Xj, i <= j."""

    def __add__(self, other: "Form") -> "Form":
        new = Form(self)
        for key, c in other.items():
            new[key] = new.get(key, Fraction(0)) + c
        return new

    def __rmul__(self, c: Fraction) -> "Form":
        return Form({key: c * x for key, x in self.items()} if c else {})

    def __sub__(self, other: "Form") -> "Form":
        return self + Fraction(-1) * other

    def product(self, other: "Form") -> "Form":
        """Return the product of two linear forms."""
        new = Form()
        for (i,), a in self.items():
            for (j,), b in other.items():
                key = (min(i, j), max(i, j))
                new[key] = new.get(key, Fraction(0)) + a * b
        return new

    def positive(self, n: int = 11) -> bool:
        """Tell whether a quadratic form in the first n components of X is positive definite."""
        scale = 2 * math.lcm(*(c.denominator for c in self.values()))
        a = [[0] * n for _ in range(n)]
        for (i, j), c in self.items():
            a[i][j] = a[j][i] = int(c * scale) // (1 if i == j else 2)
        return definite(a)

    def value(self, X: Row) -> Fraction:
        """Return the value of a quadratic form at X."""
        return total(c * X[i] * X[j] for (i, j), c in self.items())


class Vector(tuple[Form, ...]):
    """Three linear forms."""

    def __add__(self, other: "Vector") -> "Vector":  # type: ignore[override]
        return Vector(map(operator.add, self, other))

    def __sub__(self, other: "Vector") -> "Vector":
        return Vector(map(operator.sub, self, other))

    def __rmul__(self, c: Fraction) -> "Vector":  # type: ignore[override]
        return Vector(c * x for x in self)

    def __matmul__(self, other: "Vector") -> Form:
        """Return the quadratic form xᵀy."""
        return sum(map(Form.product, self, other), Form())


def flat(x: Vector) -> Vector:
    """Return P x: the third component is dropped."""
    return Vector([*x[:2], Form()])


def through(rows: Sequence[Row], x: Vector) -> Vector:
    """Return the product of a matrix with a vector."""
    return Vector(sum((c * y for c, y in zip(row, x, strict=True)), Form()) for row in rows)


D1, D2, D3, D4 = (  # δ1, δ2, δ3, δ4
    Vector(Form({(i,): Fraction(1)} if i < 11 else {}) for i in range(k, k + 3))
    for k in (0, 3, 6, 9)
)


# --- the file -----------------------------------------------------------------------------------


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


def fields(value: Any, where: str, /, **shapes: tuple[int | None, ...]) -> Any:
    """Read an object of numbers: each of its keys, and the shape of what it holds."""
    return {k: numbers(keys(value, tuple(shapes), where)[k], *shapes[k]) for k in shapes}


def box_of(values: Any) -> Matrix:
    """Read a box, three intervals in order."""
    box: Matrix = numbers(values, 3, 2)
    require(all(a <= b for a, b in box), "a box is not in order")
    return box


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


class Law(NamedTuple):
    """The choices of a law; the paper's is by default."""

    feature: str = "centroid"  # q, or "scaled": s = q √(n (n + a)/(2 (n² - a²)))/a, a = |q|
    goal: str = "image"  # δ1 = q - q*, or "inertial": δ1 = q - q3* ρ
    force: str = "modelled"  # F = -T e3 + m g ρ, or "measured", which is the same in the model

    @property
    def scaled(self) -> bool:
        """Whether J = (∂s/∂q) Q stands in place of Q."""
        return self.feature == "scaled"


class Setting(NamedTuple):
    """What a mission says of vehicle, law, target and goal; q* is enclosed."""

    name: str
    law: Law
    m: Fraction  # mass, kg
    gravity: Fraction  # m/s²
    g: dict[str, Fraction]  # k1 kg m/s, k2 1/m, k3 and k4 kg/s
    points: Matrix  # target, world frame, m
    centroid: list[Interval]  # q*
    fixed: list[Interval]  # what turns with the image of q*, or of s*: all of it, or nothing
    goal: list[Fraction] | None  # position, m; None where q* is given

    @property
    def gains(self) -> list[Fraction]:
        """The gains k1 to k4."""
        return [self.g[k] for k in GAINS[:4]]

    @property
    def stiffness(self) -> Fraction:
        """The c = k1² k2/m of the force, N."""
        return self.g["k1"] ** 2 * self.g["k2"] / self.m

    @property
    def weight(self) -> Fraction:
        """The weight m g, N."""
        return self.m * self.gravity

    def words(self) -> str:
        """Name the gains."""
        return ", ".join(f"{k} = {self.g[k]}" for k in GAINS[:4])


def read_setting(c: Any) -> Setting:
    """Return the numbers of vehicle, gains, target and goal."""
    mission = c["mission"]
    named = isinstance(mission, dict) and "law" in mission
    keys(mission, (*SECTIONS, "law") if named else SECTIONS, "mission")
    require(matches(mission["name"], r"[\w.-]{1,64}"), "the mission has no proper name")
    require(c["mission_sha256"] == digest(mission), "the mission is not the one that was hashed")
    plain: dict[str, tuple[int, ...]] = dict.fromkeys(("mass", "arm", "drag_ratio", "gravity"), ())
    vehicle = fields(mission["vehicle"], "vehicle", inertia=(3,), **plain)
    g = fields(mission["gains"], "gains", **dict.fromkeys(GAINS, ()))
    rest = [vehicle[k] for k in plain]
    require(min(*vehicle["inertia"], *rest, *g.values()) > 0, "vehicle and gains must be positive")
    fields(mission["start"], "start", position=(3,), velocity=(3,), rotation=(3,), rates=(3,))
    read_bounds(mission["bounds"])
    points = fields(mission["target"], "target", points=(None, 3))["points"]
    require(len(points) >= 2, f"a target has 2 to {MAX_POINTS} points")
    goal = mission["goal"]
    if isinstance(goal, dict) and "height" in goal:
        height = fields(goal, "goal", height=())["height"]
        position = numbers(c["goal_position"], 3)
        mean = sum(p[2] for p in points) / len(points)
        require(position[2] == mean - height, "the goal is not at the height of the mission")
        require(all(p[2] > position[2] for p in points), "a target point is above the goal")
        centroid = centroid_seen(points, position)
        level_off = max(abs(end) for ends in centroid[:2] for end in ends)
        require(level_off < Fraction(1, 10**9), "the centroid at the goal is not vertical")
    else:
        q = fields(goal, "goal", centroid=(3,))["centroid"]
        require(c["goal_position"] is None, "a goal by centroid has no position here")
        require(q[2] > 0 and sum(x * x for x in q) < len(points) ** 2, "no hover sees this q*")
        position, centroid = None, [(x, x) for x in q]
    law = Law(**keys(mission["law"], Law._fields, "law")) if named else Law()
    known = (("centroid", "scaled"), ("image", "inertial"), ("modelled", "measured"))
    require(all(map(operator.contains, known, law)), "there is no such law")
    fixed = scaled(centroid, len(points)) if law.scaled else centroid
    if law.goal == "inertial":
        vertical = all(max(map(abs, ends)) < Fraction(1, 10**9) for ends in centroid[:2])
        require(vertical, "a goal fixed to the vertical is straight below")
        fixed = [(Fraction(0), Fraction(0))] * 3
    weights = vehicle["mass"], vehicle["gravity"]
    return Setting(mission["name"], law, *weights, g, points, centroid, fixed, position)


def of_the_paper(s: Setting) -> Setting:
    """Return a setting whose law is the paper's."""
    require(s.law == Law(), "this is shown for the law of the paper alone")
    return s


def read_bounds(bounds: Any) -> None:
    """Make sure of the form of the bounds: eigenvalues, and thrust or level."""
    require(isinstance(bounds, dict), "bounds is not an object")
    shapes: dict[str, tuple[int, ...]] = {"eigenvalues": (2,), "thrust": (2,)}
    if "thrust" not in bounds:
        shapes = {"eigenvalues": (2,), "level": ()}
    if bounds.get("eigenvalues") == "auto":  # to be shown over a box, which may be named
        del shapes["eigenvalues"]
        shapes |= {"box": (3, 2)} if "box" in bounds else {}
        bounds = {k: v for k, v in bounds.items() if k != "eigenvalues"}
    fields(bounds, "bounds", **shapes)


# --- the model ----------------------------------------------------------------------------------
#
# Errors X = (δ1, δ2, δ3, δ4) ∈ R¹¹, Ω3 = 0, v = δ1 + δ2, P drops the third component,
# A = q3* I - e3 q*ᵀ, f = f(T), the terms in Ω left out. With the scaled centroid, J = (∂s/∂q) Q is
# in place of Q and s* in place of q*; of a goal that is inertial, zero is in place of q* here.
#
#     m δ1' = -k1 Q v + k1 f A(δ4 - δ3)
#     m δ2' =  k1 Q v - k1 k2 δ2 + k1 k2 δ3 - k1 f A(δ4 - δ3)
#     m δ3' =  k1 Q v - k1 k2 δ2 + (k1 k2 + k3) δ4 - k3 δ3
#     m δ4' =  k1 P Q v - (k1 k2 + k3) P δ3 - k4 δ4


def centroid_seen(points: Matrix, position: Row) -> list[Interval]:
    """Enclose q = Σ (P - ξ)/|P - ξ|; points at equal distance are added before rounding.

    What is not exact, or long, is rounded outward: sums of fractions grow longer and longer.
    """
    sums: dict[Fraction, list[Fraction]] = {}
    for point in points:
        ray = [p - x for p, x in zip(point, position, strict=True)]
        square = total(c * c for c in ray)
        require(square > 0, "the goal coincides with a target point")
        old = sums.get(square, [Fraction(0)] * 3)
        sums[square] = [a + b for a, b in zip(old, ray, strict=True)]
    box = []
    for i in range(3):
        ends = [outward(*sorted(ray[i] / r for r in square_root(s))) for s, ray in sums.items()]
        box.append(outward(*map(total, zip(*ends, strict=True))))
    return box


def scaled(q: list[Interval], n: int) -> list[Interval]:
    """Enclose s = q √(n (n + a)/(2 (n² - a²)))/a, a = |q|, for q in a box that is not at zero."""
    squares = [[max(a, -b, Fraction(0)) ** 2, max(-a, b) ** 2] for a, b in q]
    low, high = map(total, zip(*squares, strict=True))
    require(low > 0 and high < n**2, "no hover sees this centroid")
    a = square_root(low)[0], square_root(high)[1]
    factors = [
        n * (n + x) / (2 * (n**2 - square)) for x, square in zip(a, (low, high), strict=True)
    ]
    stretch = square_root(factors[0])[0] / a[1], square_root(factors[1])[1] / a[0]
    products = [[x * y for x in ends for y in stretch] for ends in q]
    return [outward(min(each), max(each)) for each in products]


def factor(s: Setting, thrust: Fraction, q3: Fraction) -> Fraction:
    """Return f(T) = k1 k2 (k1 k2 + k3)/(m (T - c q3)), c = k1² k2/m, q3 of what is fixed."""
    (k1, k2, k3, _), distance = s.gains, thrust - s.stiffness * q3
    require(distance > 0, "the thrust interval reaches the singularity T = c q3*")
    return k1 * k2 * (k1 * k2 + k3) / (s.m * distance)


def rates(s: Setting, Q: Sequence[Row], f: Fraction, q: Row) -> list[Vector]:
    """Return m δ1', m δ2', m δ3' and m δ4', the terms in Ω left out."""
    k1, k2, k3, k4 = s.gains
    flow, e = k1 * through(Q, D1 + D2), D4 - D3
    along = Vector([Form(), Form(), *through([q], e)])  # e3 q*ᵀ(δ4 - δ3)
    turn = (k1 * f) * (q[2] * e - along)
    damped = flow - (k1 * k2) * D2
    return [
        turn - flow,
        damped + (k1 * k2) * D3 - turn,
        damped + (k1 * k2 + k3) * D4 - k3 * D3,
        flat(flow) - (k1 * k2 + k3) * flat(D3) - k4 * D4,
    ]


def sigma(s: Setting, w: Row, Q: Sequence[Row], f: Fraction, q: Row) -> Form:
    """Return XᵀΣX = -m L', L = ½ Σ wi|δi|²."""
    errors = zip(w, (D1, D2, D3, D4), rates(s, Q, f, q), strict=True)
    return Form() - sum((x * (d @ rate) for x, d, rate in errors), Form())


def scaled_identity(c: Fraction) -> Matrix:
    """Return c I, 3 x 3."""
    return [[c if i == j else Fraction(0) for j in range(3)] for i in range(3)]


# --- covers of boxes by cells -------------------------------------------------------------------


def tree_of(text: Any, points: Matrix, cost: int) -> tuple[str, int]:
    """Read how a box is halved, in preorder, and the work that asks for.

    0 stands for a cell that is not halved, 1, 2 or 3 for one that is, across that axis.
    """
    require(matches(text, "[0-3]+"), "a tree is not written in 0, 1, 2 and 3")
    return text, text.count("0") * (len(points) + 5) * cost


def cover(tree: str, box: Cell, holds: Callable[[Cell], bool], what: str) -> None:
    """Verify that something holds over each cell that a box is halved into, so over the box."""
    cells = [box]
    for letter in tree:
        require(cells, "a tree is longer than what it halves")
        cell = cells.pop()
        if letter == "0":
            require(holds(cell), f"{what} over a cell of the box")
            continue
        k = int(letter) - 1
        require(k < len(cell), "a tree halves across an axis that is not there")
        a, b = cell[k]
        middle = (a + b) // 2
        cells += [[*cell[:k], side, *cell[k + 1 :]] for side in ((middle, b), (a, middle))]
    require(not cells, "a tree is shorter than what it halves")


class Grid(NamedTuple):
    """Lengths as whole numbers of a unit that divides every coordinate of the target."""

    unit: int  # of them are 1 m
    points: list[list[int]]

    @classmethod
    def of(cls, points: Matrix) -> "Grid":
        """Lay the grid of a target."""
        unit = 2**40 * math.lcm(*(c.denominator for point in points for c in point))
        require(unit < 10**46, "the coordinates of the target are too long")
        return cls(unit, [[int(c * unit) for c in point] for point in points])

    def cell(self, box: Sequence[Row]) -> Cell:
        """Round a box outward."""
        require(all(abs(end) < 10**9 for side in box for end in side), "a box is too far away")
        return [(math.floor(a * self.unit), math.ceil(b * self.unit)) for a, b in box]

    def around(self, cell: Cell) -> "Ball3":
        """Enclose a cell by a ball."""
        center = [(a + b) // 2 for a, b in cell]
        square = sum((b - c) ** 2 for (_, b), c in zip(cell, center, strict=True))  # b - c >= c - a
        rays = [[p - c for p, c in zip(point, center, strict=True)] for point in self.points]
        near = [math.isqrt(sum(x * x for x in ray)) for ray in rays]
        return Ball3(center, square, math.isqrt(square) + 1, rays, near)


class Ball3(NamedTuple):
    """Positions within ρ of a centre, and the target seen from there."""

    center: list[int]
    square: int  # ρ²
    radius: int  # ρ, rounded up
    rays: list[list[int]]  # Pi - centre
    near: list[int]  # their lengths: d stands for one in [d, d + 1]


def turns(weights: Sequence[int], rays: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the matrix of Σ wi |x × di|², that is Σ wi (|di|² I - di diᵀ)."""
    pairs = list(zip(weights, rays, strict=True))
    xx, yy, zz = (sum(w * d[i] * d[i] for w, d in pairs) for i in range(3))
    xy, yz, zx = (-sum(w * d[i] * d[i - 2] for w, d in pairs) for i in range(3))
    return [[yy + zz, xy, zx], [xy, zz + xx, yz], [zx, yz, xx + yy]]


def shifted(a: list[list[int]], sign: int, shift: int) -> list[list[int]]:
    """Return sign·a + shift·I."""
    return [[sign * x + shift * (i == j) for j, x in enumerate(row)] for i, row in enumerate(a)]


def largest_below(ball: Ball3, high: Fraction) -> bool:
    """Show Q ≺ high I over a ball; the unit of length is that of the grid.

    By Q ⪯ Σ 1/ri I, and by Q(c + δ) ⪯ Q(c) + Σ 1.155 ρ/(di - ρ)² I: the derivative of
    (I - pipiᵀ)/ri along a unit vector has norm at most (2/√3)/ri².
    """
    _, _, radius, rays, near = ball
    if min(near) <= radius:
        return False
    scale = 1 << (64 + 3 * max(near).bit_length())
    top = scale * high.numerator // high.denominator
    if sum(scale // (d - radius) + 1 for d in near) < top:
        return True
    steep = sum(1155 * scale * radius // (1000 * (d - radius) ** 2) + 1 for d in near)
    return definite(shifted(turns([scale // d**3 + 1 for d in near], rays), -1, top - steep))


def smallest_above(ball: Ball3, low: Fraction) -> bool:
    """Show Q ≻ low I over a ball; the unit of length is that of the grid.

    With wi = 1/(di + ρ)³ <= 1/ri³, s = Σ wi di and any θ > 0 with 1/θ >= Σ wi,

        xᵀQx = Σ |x × (di - δ)|²/ri³ >= Σ wi |x × di|² - 2 (x × s)·(x × δ) + Σ wi |x × δ|²
             >= Σ wi |x × di|² - θ|x × s|² - (1/θ - Σ wi) ρ²|x|².
    """
    _, square, radius, rays, near = ball
    scale = 1 << (64 + 3 * max(near).bit_length())  # weights and bounds are multiples of 1/scale
    weights = [scale // (d + 1 + radius) ** 3 for d in near]
    whole = sum(weights)
    s = [sum(w * ray[i] for w, ray in zip(weights, rays, strict=True)) for i in range(3)]
    below, lost = turns(weights, rays), turns([1], [s])
    bottom = math.ceil(scale * low)
    for k in (2, 4, 16, 64, 2**20):  # 1/θ = k Σ wi; the inequality is multiplied by that
        difference = [
            [k * whole * a - b for a, b in zip(*pair, strict=True)]
            for pair in zip(below, lost, strict=True)
        ]
        if definite(shifted(difference, 1, -k * whole * (bottom + (k - 1) * whole * square))):
            return True
    return False


# --- the slope of the scaled centroid ------------------------------------------------------------
#
# With C any point, r0 = |C - ξ|, p0 = (C - ξ)/r0, t = 1/r0, ei = Pi - C, di = 2 ei·p0 + t|ei|²,
# κi = r0/ri = 1/√(1 + t di), λi = -di κi/(1 + 1/κi), the unit vectors are pi = p0 + t wi with
# wi = λi p0 + κi ei, and (I - pi piᵀ)/ri - (I - p0 p0ᵀ)/r0 = t² Di,
# Di = λi I - κi (wi piᵀ + p0 wiᵀ) - λi p0 p0ᵀ. Nothing cancels in them. With w̄ their mean,
# ui = wi - w̄, S = n Σ|ui|² = (n² - a²)/t², a = |q|, q̂ = q/a and N = Σ κi (I - pi piᵀ) = r0 Q,
#
#     J = √(n (n + a)/(2 S)) (N/a + q̂ hᵀ),
#     hᵀ = (1/(2 (n + a)) - 1/a) q̂ᵀN - n Σ uiᵀDi / S.
#
# Over a cell each of these is enclosed by a number, a slope and a rest.

BITS = 192  # numbers are multiples of 2^-BITS
ONE_OF_THEM = 1 << BITS


class Tangent(NamedTuple):
    """What is within `rest` of mid + slope·x for x in [-1, 1]³, the place in a cell."""

    mid: int
    slope: tuple[int, int, int]
    rest: int

    @classmethod
    def constant(cls, c: Fraction) -> "Tangent":
        """Enclose a number."""
        return cls(math.floor(c * ONE_OF_THEM), (0, 0, 0), 1)

    def spread(self) -> int:
        """Bound how far it is from mid."""
        a, b, c = self.slope
        return abs(a) + abs(b) + abs(c) + self.rest

    def __add__(self, other: "Tangent") -> "Tangent":  # type: ignore[override]
        (a, b, c), (x, y, z) = self.slope, other.slope
        return Tangent(self.mid + other.mid, (a + x, b + y, c + z), self.rest + other.rest)

    def __sub__(self, other: "Tangent") -> "Tangent":
        (a, b, c), (x, y, z) = self.slope, other.slope
        return Tangent(self.mid - other.mid, (a - x, b - y, c - z), self.rest + other.rest)

    def __mul__(self, other: "Tangent") -> "Tangent":  # type: ignore[override]
        (a, b, c), (x, y, z), m, k = self.slope, other.slope, self.mid, other.mid
        slope = (m * x + k * a) >> BITS, (m * y + k * b) >> BITS, (m * z + k * c) >> BITS
        rest = abs(m) * other.rest + abs(k) * self.rest + self.spread() * other.spread()
        return Tangent(m * k >> BITS, slope, (rest >> BITS) + 5)

    def times(self, n: int, d: int = 1) -> "Tangent":
        """Return it times n/d."""
        a, b, c = self.slope
        slope = a * n // d, b * n // d, c * n // d
        return Tangent(self.mid * n // d, slope, self.rest * abs(n) // d + 5)

    def bent(self, value: int, slope: int, least: int, bend: int) -> "Tangent":
        """Return a function of it: its value and slope at mid, from which it bends away.

        The function less its tangent line is between `least` and least + bend. The slope that is
        given may be off by one unit and by 2/mid, and so the tangent line by spread + 2 units.
        """
        a, b, c = ((slope * x) >> BITS for x in self.slope)
        rest = (abs(slope) * self.rest + self.spread() >> BITS) + bend // 2 + 10
        return Tangent(value + least + bend // 2, (a, b, c), rest)

    def inverse(self) -> "Tangent":
        """Return 1/x of x > 0, which is above its tangent line by at most d²/(m² (m - d))."""
        m, d = self.mid, self.spread()
        require(m > d, "a number is not shown to be positive")
        value = (ONE_OF_THEM**2) // m
        bend = d * d * ONE_OF_THEM**2 // (m * m * (m - d)) + 1
        return self.bent(value, -(value * value >> BITS), 0, bend)

    def root(self) -> "Tangent":
        """Return √x of x > 0, below its tangent line by at most d²/(2√m (√m + √(m - d))²)."""
        m, d = self.mid, self.spread()
        require(m > d, "a number is not shown to be positive")
        value, low = math.isqrt(m << BITS), math.isqrt((m - d) << BITS)
        bend = d * d * ONE_OF_THEM // (2 * value * (value + low) ** 2 >> BITS) + 1
        return self.bent(value, ONE_OF_THEM**2 // (2 * value), -bend, bend)


Three = list[Tangent]
NOTHING = Tangent(0, (0, 0, 0), 0)


def along(x: Iterable[Tangent], y: Iterable[Tangent]) -> Tangent:
    """Return xᵀy."""
    return add_up(a * b for a, b in zip(x, y, strict=True))


def add_up(values: Iterable[Tangent]) -> Tangent:
    """Return a sum."""
    return sum(values, NOTHING)


def place_in(grid: Grid, cell: Cell) -> Three:
    """Return the positions of a cell."""
    xi = []
    for k, (a, b) in enumerate(cell):
        half = (b - a) * ONE_OF_THEM // (2 * grid.unit)
        slope = (half * (k == 0), half * (k == 1), half * (k == 2))
        xi.append(Tangent((a + b) * ONE_OF_THEM // (2 * grid.unit), slope, 2))
    return xi


def slope_of_scaled(points: Matrix, grid: Grid, cell: Cell) -> list[Three] | None:
    """Enclose J over a cell, (3, 3); None if the target is too near."""
    try:
        return scaled_slope(points, place_in(grid, cell))
    except Rejected:  # a number is not shown to be positive
        return None


def scaled_slope(points: Matrix, xi: Three) -> list[Three]:
    """Enclose J at the positions of a cell, (3, 3), 1/m."""
    n, one, axes = len(points), Tangent.constant(Fraction(1)), range(3)
    C = [total(side) / n for side in zip(*points, strict=True)]
    ray = [Tangent.constant(c) - x for c, x in zip(C, xi, strict=True)]
    t = along(ray, ray).root().inverse()
    p0 = [x * t for x in ray]
    rays = []
    for point in points:
        e = [Tangent.constant(x - c) for x, c in zip(point, C, strict=True)]
        d = along(e, p0).times(2) + along(e, e) * t
        far = (one + t * d).root()  # ri/r0
        near = far.inverse()
        bend = NOTHING - d * near * (one + far).inverse()
        w = [bend * p0[k] + near * e[k] for k in axes]
        rays.append((w, [p0[k] + t * w[k] for k in axes], near, bend))
    mean = [add_up(w[k] for w, *_ in rays).times(1, n) for k in axes]
    apart = [[w[k] - mean[k] for k in axes] for w, *_ in rays]
    S = add_up(along(u, u) for u in apart).times(n)
    a = (Tangent.constant(Fraction(n * n)) - t * t * S).root()
    whole, short, less = a + Tangent.constant(Fraction(n)), a.inverse(), S.inverse()
    q = [(p0[k] + t * mean[k]).times(n) * short for k in axes]
    N = [[NOTHING] * 3 for _ in axes]
    falling = [NOTHING] * 3  # Σ uiᵀDi
    for u, (w, p, near, bend) in zip(apart, rays, strict=True):
        up, uw = along(u, p0), along(u, w) * near
        kp, bent = [near * x for x in p], up * near
        for i in axes:
            falling[i] += bend * (u[i] - up * p0[i]) - uw * p[i] - bent * w[i]
            for j in range(i + 1):
                N[i][j] += (near if i == j else NOTHING) - kp[i] * p[j]
    N = [[N[max(i, j)][min(i, j)] for j in axes] for i in axes]
    seen = [along(q, row) for row in N]
    first = whole.inverse().times(1, 2) - short
    h = [first * seen[k] - (falling[k] * less).times(n) for k in axes]
    stretch = (whole * less).times(n, 2).root()
    return [[stretch * (N[i][j] * short + q[i] * h[j]) for j in axes] for i in axes]


def within_ball(J: list[Three] | None, low: Fraction, high: Fraction) -> bool:
    """Show |J - j I| < ϱ, low = j - ϱ and high = j + ϱ.

    A norm is convex, so the corners of a cell suffice; the rests of J have the norm of their
    matrix at most.
    """
    if J is None:
        return False
    j = math.floor((low + high) / 2 * ONE_OF_THEM)
    rest = math.isqrt(sum(x.rest**2 for row in J for x in row)) + 2
    room = math.floor((high - low) / 2 * ONE_OF_THEM) - rest
    for signs in itertools.product((-1, 1), repeat=3):
        ends = [[x.mid + sum(map(operator.mul, signs, x.slope)) for x in row] for row in J]
        ends = shifted(ends, 1, -j)
        columns = list(zip(*ends, strict=True))
        square = [[sum(map(operator.mul, x, y)) for y in columns] for x in columns]
        if room <= 0 or not definite(shifted(square, -1, room**2)):
            return False
    return True


# --- bounds of Q, or of J, over a box -------------------------------------------------------------


class Spread(NamedTuple):
    """What a claim about Q rests on: neither gains nor thrust are in Q.

    About J, low and high are the ends of the ball |J - j I| <= ϱ, j - ϱ and j + ϱ.
    """

    s: Setting
    low: Fraction  # of the eigenvalues, 1/m
    high: Fraction
    box: Matrix | None  # positions over which they are to be shown, m; None if they are assumed
    tree: str | None


def read_spread(c: Any, s: Setting | None = None) -> Spread:
    """Return target, box and bounds; the setting may have been read."""
    s = s or read_setting(c)
    region = keys(c["region"], ("box", "eigenvalues", "tree"), "region")
    low, high = numbers(region["eigenvalues"], 2)
    require(0 < low < high, "the eigenvalue bounds are not in order")
    box, tree = None, region["tree"]
    if region["box"] is None:
        assumed = region["eigenvalues"] == c["mission"]["bounds"]["eigenvalues"]
        require(assumed, "without a box, the eigenvalue bounds are those of the mission")
    else:
        box = box_of(region["box"])
    if box is None or c["kind"] == "outside":
        require(tree is None, "a tree belongs to bounds that are shown over a box")
    else:
        tree, work = tree_of(tree, s.points, 20 if s.law.scaled else 5)
        require(work <= MAX_WORK, "a tree is too long")
    return Spread(s, low, high, box, tree)


def verify_region(c: Any, p: Spread) -> None:
    """Verify the eigenvalue bounds over the box, if one is claimed."""
    if p.box is None or p.tree is None:
        return
    grid = Grid.of(p.s.points)
    cover(p.tree, grid.cell(p.box), bounds_of(p, grid), "the bounds are not shown to hold")


def bounds_of(p: Spread, grid: Grid) -> Callable[[Cell], bool]:
    """Return what shows the bounds of Q, or of J, over a cell."""
    low, high = p.low / grid.unit, p.high / grid.unit

    def hold(cell: Cell) -> bool:
        if p.s.law.scaled:
            return within_ball(slope_of_scaled(p.s.points, grid, cell), p.low, p.high)
        ball = grid.around(cell)
        return largest_below(ball, high) and smallest_above(ball, low)

    return hold


def theorem_of_region(c: Any, p: Spread) -> str:
    """Say in words over which box the eigenvalue bounds hold."""
    require(p.box is not None, "a claim about a region has a box")
    sides = " x ".join(f"[{about(a)}, {about(b)}]" for a, b in p.box or [])
    held = f"the eigenvalues of Q lie between {about(p.low)} and {about(p.high)} 1/m"
    if p.s.law.scaled:
        held = f"J = (∂s/∂q) Q, s the scaled centroid, obeys {in_ball(p)}"
    return (
        f"For the target of the mission {p.s.name} and every position in the box {sides} m, {held}."
    )


def in_ball(p: Spread) -> str:
    """Say in words in which ball J is."""
    return f"|J - {about((p.low + p.high) / 2)} I| <= {about((p.high - p.low) / 2)} 1/m"


def verify_outside(c: Any, p: Spread) -> None:
    """Verify that Q has an eigenvalue out of bounds at a position in the box."""
    spot = c["outside"]
    position, x = numbers(spot["position"], 3), numbers(spot["direction"], 3)
    inside = all(a <= y <= b for y, (a, b) in zip(position, p.box or (), strict=True))
    require(inside, "the position is not in the box")
    if p.s.law.scaled:
        require(beyond_ball(p, position, x), "J there is not shown to be out of the ball")
        return
    lower = spot["bound"] == "lower"
    xx, value = total(a * a for a in x), Fraction(0)
    for point in p.s.points:  # xᵀQx = Σ (|x|² - (x·pi)²)/ri, rounded against the claim
        ray = [a - b for a, b in zip(point, position, strict=True)]
        square = total(a * a for a in ray)
        require(square > 0, "the position is that of a target point")
        along = total(a * b for a, b in zip(ray, x, strict=True))
        value += (xx - along**2 / square) / square_root(square)[0 if lower else 1]
    out = value < p.low * xx if lower else value > p.high * xx
    require(out, "the eigenvalue of Q there is not shown to be out of bounds")


def beyond_ball(p: Spread, position: Row, x: Row) -> bool:
    """Show |J x - j x| > ϱ|x| at a position."""
    J = scaled_slope(p.s.points, [Tangent.constant(c) for c in position])
    j, size = (p.low + p.high) / 2, square_root(total(c * c for c in x))[1]
    square = Fraction(0)
    for i, row in enumerate(J):
        value = (
            total(Fraction(y.mid, ONE_OF_THEM) * c for y, c in zip(row, x, strict=True)) - j * x[i]
        )
        loss = total(
            Fraction(y.spread(), ONE_OF_THEM) * abs(c) for y, c in zip(row, x, strict=True)
        )
        square += max(abs(value) - loss, Fraction(0)) ** 2
    return square > ((p.high - p.low) / 2 * size) ** 2


def theorem_of_outside(c: Any, p: Spread) -> str:
    """Say in words what is refuted."""
    spot = keys(c["outside"], ("position", "direction", "bound"), "outside")
    position = ", ".join(map(str, numbers(spot["position"], 3)))
    if p.s.law.scaled:
        require(spot["bound"] == "ball", "the bound is not the ball")
        return f"It is not true that {theorem_of_region(c, p)[:-1]}: not at ({position}) m in it."
    require(spot["bound"] in ("lower", "upper"), "the bound is neither lower nor upper")
    side, value = ("smaller", p.low) if spot["bound"] == "lower" else ("larger", p.high)
    return (
        f"It is not true that {theorem_of_region(c, p)[:-1]}: at the position ({position}) m in "
        f"that box, Q has an eigenvalue {side} than {about(value)} 1/m."
    )


# --- gains --------------------------------------------------------------------------------------
#
# For L = ½ Σ wi|δi|² the terms in Ω drop out and -m L' = XᵀΣX, Σ = Σ0(f, q*) + k1 sym(uᵀQv),
# u = w1 δ1 - w2 δ2 - w3 δ3 - w4 δ4. For symmetric Q with eigenvalues in [a, b], λ = (a + b)/2,
# ϱ = (b - a)/2, and any τ > 0,
#
#     uᵀQv >= λ uᵀv - ϱ|u||v| >= λ uᵀv - (ϱ/2)(τ|v|² + |u|²/τ),
#
# so Σ ≻ t W follows from  M = Σ(λI) - (k1 ϱ/2)(τ vᵀv + uᵀu/τ) - t W ≻ 0,  W = diag(wi I). M is
# affine in f and in each component of q*: the corners of a box around them suffice. Then
# L' <= -(2 t/m) L.


class Question(NamedTuple):
    """The numbers of a mission that bear on the claim; intervals enclose what is irrational."""

    s: Setting
    w: list[Fraction]  # weights of L
    thrust: Sequence[Fraction]  # lowest and highest, N
    spread: Spread
    factor: Interval  # holds every f(T), 1/m
    attained: Interval  # every value in it is an f(T), 1/m


def read_gains(c: Any) -> Question:
    """Return the numbers of the mission that bear on the claim, and enclosures made from them."""
    s = read_setting(c)
    w, bounds = numbers(c["weights"], 4), c["mission"]["bounds"]
    require(min(w) > 0, "weights must be positive")
    if "thrust" in bounds:
        thrust = numbers(bounds["thrust"], 2)
        require(thrust[0] <= s.weight <= thrust[1], "the thrust interval does not hold m g")
    else:
        level = number(bounds["level"])
        require(level > 0, "the level must be positive")
        reach = s.stiffness * square_root(2 * level * (1 / w[1] + 1 / w[2]))[1]
        thrust = [s.weight - reach, s.weight + reach]
    (low, high), (q_low, q_high) = thrust, s.fixed[2]
    return Question(
        s,
        w,
        thrust,
        read_spread(c, s),
        (factor(s, high, q_low), factor(s, low, q_high)),
        (factor(s, high, q_high), factor(s, low, q_low)),
    )


def bound(p: Question, f: Fraction, q: Row, tau: Fraction, t: Fraction) -> Form:
    """Return XᵀMX."""
    low, high = p.spread.low, p.spread.high
    errors, loss = (D1, D2, D3, D4), p.s.g["k1"] * (high - low) / 4
    w1, w2, w3, w4 = p.w
    u, v = w1 * D1 - w2 * D2 - w3 * D3 - w4 * D4, D1 + D2
    weighed = sum((w * (d @ d) for w, d in zip(p.w, errors, strict=True)), Form())
    middle = sigma(p.s, p.w, scaled_identity((low + high) / 2), f, q)
    return middle - loss * (tau * (v @ v) + (1 / tau) * (u @ u)) - t * weighed


def verify_gains(c: Any, p: Question) -> None:
    """Verify a proof of Σ ≻ margin·W, hence of the decay of L."""
    hints = fields(c["enclosures"], "enclosures", centroid=(3, 2), factor=(2,), goal=(3, 2))
    for mine, given in zip(p.s.fixed, hints["centroid"], strict=True):
        require(within(mine, given), "the box around q* does not hold q*")
    require(within(p.factor, hints["factor"]), "the interval of f does not hold f(T)")
    require(isinstance(c["vertices"], list) and len(c["vertices"]) == 2, "two vertices are needed")
    margin, rate = (number(c["claim"][k]) for k in ("margin", "decay_rate"))
    require(margin > 0, "a margin of zero or less proves nothing")
    require(rate == 2 * margin / p.s.m, "the decay rate does not follow from the margin")
    margins = []
    for f, vertex in zip(hints["factor"], c["vertices"], strict=True):
        own = fields(vertex, "vertex", factor=(), multiplier=(), margin=(), decay_rate=())
        require(own["factor"] == f, "a vertex is not at an end of the interval of f")
        tau, t = own["multiplier"], own["margin"]
        require(tau > 0, "a multiplier must be positive")
        require(own["decay_rate"] == 2 * t / p.s.m, "a rate is not that of its margin")
        for q in itertools.product(*(sorted(set(ends)) for ends in hints["centroid"])):
            shown = bound(p, f, q, tau, t).positive()
            require(shown, "Σ - margin·W is not shown to be positive definite")
        margins.append(t)
    require(margin == min(margins), "the margin is not the smallest of the vertices")
    verify_region(c, p.spread)
    verify_goal(p, box_of(c["enclosures"]["goal"]))


def verify_goal(p: Question, box: Matrix) -> None:
    """Verify that a box holds the goal, and low I ≺ Q ≺ high I all over it.

    A goal by its centroid q* is where the convex Σ|P'i - ξ| + q*ᵀξ, of slope q* - q and Hessian
    Q ≻ low I, is least. On the largest ball about the middle of the box, of radius r, it is higher
    than in the middle if |q - q*| < low r/2 there.
    """
    grid, J = Grid.of(p.s.points), "J" if p.s.law.scaled else "Q"
    cell, low = grid.cell(box), p.spread.low
    inside = bounds_of(p.spread, grid)(cell)
    require(inside, f"{J} at the goal is not shown to be within its bounds")
    if p.s.goal is not None:
        held = all(a <= x <= b for x, (a, b) in zip(p.s.goal, box, strict=True))
    else:
        seen = centroid_seen(p.s.points, [(a + b) / 2 for a, b in box])
        if p.s.law.scaled:  # the bounds are not those of Q
            tried = (p.spread.high / 2**k for k in range(100))
            low = next((x for x in tried if smallest_above(grid.around(cell), x / grid.unit)), ZERO)
        off = zip(seen, p.s.centroid, strict=True)
        slope = total(max(abs(x - y) for x in ends for y in want) ** 2 for ends, want in off)
        held = slope < (low * min(b - a for a, b in box) / 4) ** 2
    require(held, "the box for Q at the goal is not shown to hold the goal")


def theorem_of_gains(c: Any, p: Question) -> str:
    """Say in words what is proved."""
    claim = fields(c["claim"], "claim", margin=(), decay_rate=())
    margin, rate = about(claim["margin"]), about(claim["decay_rate"])
    weights = ", ".join(map(str, p.w))
    Q = "J" if p.s.law.scaled else "Q"
    stays = f"{Q} and T stay in these bounds (which is assumed of {Q}, not shown for the target)"
    if p.s.law == Law():
        stays = "Q and T stay in these intervals (which is assumed of Q, not shown for the target)"
    region = ""
    if p.spread.box is not None:
        stays = "the vehicle stays in that box and T in its interval"
        region = theorem_of_region(c, p.spread) + " "
    return (
        f"For {asked(p)}, the matrix Σ({Q}, T) is positive definite: XᵀΣX > {margin} kg/s times "
        f"Σ wi|δi|² for all X ≠ 0, w = ({weights}). {region}Hence, while {stays} and Ω3 = 0, the "
        f"Lyapunov function L = ½ Σ wi|δi|² falls at least as fast as exp(-r t), r = {rate} 1/s. "
        f"At the goal {Q} is within {'that ball' if p.s.law.scaled else 'this interval'}."
    )


def verify_counterexample(c: Any, p: Question) -> None:
    """Verify that Σ(Q, f) is not positive semidefinite at one admissible point."""
    point = fields(c["counterexample"], "counterexample", Q=(3, 3), f=(), X=(11,), value=())
    Q, f, value = point["Q"], point["f"], point["value"]
    require(all(Q[i][j] == Q[j][i] for i in range(3) for j in range(3)), "Q is not symmetric")
    form, size = D1 @ through(Q, D1), D1 @ D1
    inside = (form - p.spread.low * size).positive(3) and (p.spread.high * size - form).positive(3)
    require(inside, "the eigenvalues of Q are not inside the interval")
    require(within((f, f), p.attained), "no thrust in the interval gives this f")
    corners = itertools.product(*p.s.fixed)
    worst = max(sigma(p.s, p.w, Q, f, q).value(point["X"]) for q in corners)
    require(worst <= value < 0, "XᵀΣX is not as negative as claimed")
    verify_region(c, p.spread)


def theorem_of_counterexample(c: Any, p: Question) -> str:
    """Say in words what is refuted."""
    point = keys(c["counterexample"], ("Q", "f", "X", "value"), "counterexample")
    return (
        f"It is not true that, for {asked(p)}, the matrix Σ(Q, T) is positive definite: for the "
        f"given rational Q and X, and the thrust with f(T) = {about(number(point['f']))} 1/m, "
        f"XᵀΣX <= {about(number(point['value']))} < 0."
    )


def asked(p: Question) -> str:
    """Say in words for which vehicle, gains and intervals."""
    q = ", ".join(f"{float((a + b) / 2):.12g}" for a, b in p.s.centroid)
    t, u = p.thrust
    law = "" if p.s.law == Law() else f"law {'/'.join(p.s.law)}, "
    every = f"symmetric Q with eigenvalues in [{p.spread.low}, {p.spread.high}] 1/m"
    if p.s.law.scaled:
        every = f"3 x 3 matrix J with {in_ball(p.spread)}"
    return (
        f"the mission {p.s.name} ({law}m = {p.s.m} kg, {p.s.words()}, q* = ({q}) to 12 digits), "
        f"every {every} and every thrust T in [{about(t)}, {about(u)}] N"
    )


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
# z >= zb - D1 - D2, none of N, x, z passes zb.


class Start(NamedTuple):
    """A set of states, with any heading and any yaw rate."""

    position: Matrix  # box, m
    radius: Fraction | None  # bounds the horizontal distance from the middle of the box, m
    speed: Fraction  # bounds |V|, m/s
    tilt: Fraction  # bounds φ, rad
    rate: Fraction  # bounds √(Ω1² + Ω2²), rad/s
    thrust: Fraction  # bounds |T - m g|, N


class Attraction(NamedTuple):
    """What follows from mission, weights and level before anything about positions is shown."""

    s: Setting
    a: list[Fraction]  # weights a2, a3, a4
    level: Fraction
    rate: Fraction
    q3: Interval  # holds q3*
    force: Fraction  # bounds |F|, N
    sine: Fraction  # bounds sin φ
    cosine: Fraction  # below cos φ
    bottom: Fraction | None  # zb, m
    reach: list[Fraction]  # of hovers from the hover at the goal: sideways, up, down, m
    starts: list[Start]
    trees: tuple[str, str | None, list[str]]  # of positions, the barrier, and all sets of starts
    grid: Grid
    pull: tuple[int, int]  # q3*, in units of 1/ONE, rounded outward
    range: tuple[int, int]  # min G and level + min G, rounded outward, in units of the grid/ONE


ONE = 1 << 64  # fractions of a cell's bounds are whole multiples of 1/ONE


def read_attraction(c: Any) -> Attraction:
    """Return the numbers of the question, and bounds that follow from the level."""
    s, claim = of_the_paper(read_setting(c)), c["claim"]
    q3, n = s.centroid[2], len(s.points)
    require(all(end == 0 for ends in s.centroid[:2] for end in ends), "the goal is not axial")
    require(q3[0] > 0 and q3[1] < n, "no hover sees this q3*")
    require(len({(x, y) for x, y, _ in s.points}) > 1, "the target is one vertical line")
    keys(claim, ("level", "rate", "barrier_height", "reach", "starts"), "claim")
    a, level, rate = numbers(c["weights"], 3), number(claim["level"]), number(claim["rate"])
    require(min(*a, level, rate) > 0, "weights, level and rate must be positive")
    hover = numbers(c["hover"], 3)
    require(s.goal in (None, hover), "the hover point is not the goal")
    force = s.stiffness * square_root(2 * level * (1 / a[0] + 1 / a[1]))[1]
    require(s.weight - force > s.stiffness * q3[1], "the thrust reaches the singularity T = c q3*")
    sine, bottom = force / s.weight, claim["barrier_height"]
    if bottom is not None:
        bottom = total(p[2] for p in s.points) / n - number(bottom)
    reach = list(fields(claim["reach"], "reach", sideways=(), up=(), down=()).values())
    require(min(reach) >= 0, "a reach is negative")
    starts = read_starts(claim["starts"])
    grid, base = Grid.of(s.points), least_potential(s, hover)
    unit = grid.unit * ONE
    return Attraction(
        *(s, a, level, rate, q3, force, sine, square_root(1 - sine**2)[0], bottom),
        reach,
        [*hovers(hover, *reach), *starts],
        read_trees(c, s, bottom, len(starts) + 2),
        grid,
        (math.floor(ONE * q3[0]), math.ceil(ONE * q3[1])),
        (math.floor(unit * base[0]), math.ceil(unit * (base[1] + level))),
    )


def least_potential(s: Setting, hover: Row) -> Interval:
    """Enclose min G >= G(hover) - |∇G||ξ* - hover|; G(ξ*) <= G(hover) bounds the distance."""
    q3, n = s.centroid[2], len(s.points)
    roots = [
        square_root(total((a - b) ** 2 for a, b in zip(p, hover, strict=True))) for p in s.points
    ]
    low, high = (total(r[k] for r in roots) for k in (0, 1))
    pull = [end * hover[2] for end in q3]
    wanted = ((Fraction(0),) * 2, (Fraction(0),) * 2, q3)
    seen = zip(centroid_seen(s.points, hover), wanted, strict=True)
    slope = total(max(abs(x - y) for x in ends for y in want) for ends, want in seen)
    return outward(low + min(pull) - slope * 2 * high / (n - q3[1]), high + max(pull))


def read_starts(values: Any) -> list[Start]:
    """Read the sets of states that are claimed to be inside."""
    require(isinstance(values, list) and len(values) <= 16, "starts is not a list of at most 16")
    starts = []
    for value in values:
        own = fields(value, "a start", position=(3, 2), speed=(), tilt=(), rate=(), thrust=())
        sizes = [own[k] for k in ("speed", "tilt", "rate", "thrust")]
        require(min(sizes) >= 0, "a start is not in order")
        starts.append(Start(box_of(value["position"]), None, *sizes))
    return starts


def hovers(hover: Row, side: Fraction, up: Fraction, down: Fraction) -> list[Start]:
    """Return the hovers about the goal: a disc at its height, and a line from below to above."""
    (x, y, z), still = hover, (Fraction(0),) * 4
    disc = [[x - side, x + side], [y - side, y + side], [z, z]]
    return [Start(disc, side, *still), Start([[x, x], [y, y], [z - up, z + down]], None, *still)]


def read_trees(
    c: Any, s: Setting, bottom: Fraction | None, count: int
) -> tuple[str, str | None, list[str]]:
    """Read how positions, the plane of the barrier and the starts are halved."""
    trees = keys(c["trees"], ("positions", "barrier", "starts"), "trees")
    require(isinstance(trees["starts"], list) and len(trees["starts"]) == count, "a tree a start")
    require((trees["barrier"] is None) == (bottom is None), "a tree belongs to a barrier")
    positions, work = tree_of(trees["positions"], s.points, 3)
    barrier, more = (None, 0) if bottom is None else tree_of(trees["barrier"], s.points, 1)
    starts = [tree_of(text, s.points, 4) for text in trees["starts"]]
    require(work + more + sum(w for _, w in starts) <= MAX_WORK, "the trees are too long")
    return positions, barrier, [text for text, _ in starts]


def dissipation(
    p: Attraction, high: Fraction, f: Fraction, q3: Fraction, t: Fraction, tau: Fraction
) -> Form:
    """Return the lower bound of -(m/k1) Λ' at θ = (t, 0), for all 0 ⪯ Q ⪯ high I."""
    k1, k2, k3, k4 = p.s.gains
    (a2, a3, a4), K, e = p.a, (k1 * k2 + k3) / k1, D1
    x = (q3 * p.s.stiffness / p.s.weight) * (D3 - D2)
    eta = Vector([x[0], x[1], -t * x[0]])
    v, u = e + eta + D2, -a2 * D2 - a3 * D3 - a4 * D4
    return (
        (e @ v)
        + (high / 2) * (u @ v)
        - (high / 4) * (tau * (v @ v) + (1 / tau) * (u @ u))
        + a2 * (k2 * (D2 @ (D2 - D3)) + (f * q3) * (D2 @ flat(D4 - D3)))
        + a3 * (D3 @ (k2 * D2 - K * D4 + (k3 / k1) * D3))
        + a4 * (D4 @ (K * D3 + (k4 / k1) * D4))
    )


def verify_attraction(c: Any, p: Attraction) -> None:
    """Verify that the set is not left, and that Λ falls in it as claimed."""
    s = p.s
    hints = fields(
        *(c["enclosures"], "enclosures"), goal=(2,), factor=(2,), tilt=(), largest_eigenvalue=()
    )
    goal, span, tilt, high = hints.values()
    require(high > 0 and within(p.q3, goal), "the interval of q3* does not hold it")
    own = (factor(s, s.weight + p.force, p.q3[0]), factor(s, s.weight - p.force, p.q3[1]))
    require(within(own, span), "the interval of f does not hold f(T)")
    require(tilt * (1 + p.cosine) >= p.sine, "tan(φ/2) is not below the bound of the tilt")
    multipliers, size = numbers(c["multipliers"], 2), sum((d @ d for d in (D1, D2, D3, D4)), Form())
    require(min(multipliers) > 0, "a multiplier must be positive")
    for (f, tau), q3 in itertools.product(zip(span, multipliers, strict=True), goal):
        M = dissipation(p, high, f, q3, tilt, tau) - p.rate * size
        require(M.positive(), "-(m/k1) Λ' is not shown to be above rate·|Y|²")
    positions, barrier, starts = p.trees
    if p.bottom is not None and barrier is not None:
        verify_barrier(p, p.bottom, barrier)
    verify_positions(p, high, positions)
    for start, tree in zip(p.starts, starts, strict=True):
        verify_start(p, start, tree)


def verify_positions(p: Attraction, high: Fraction, tree: str) -> None:
    """Verify that Q ≺ high I wherever W <= ℓ and z <= zb.

    Farther than n/high from every target point, Q ⪯ Σ 1/ri does not reach high.
    """
    far, top = len(p.s.points) / high, high / p.grid.unit
    sides = list(zip(*p.s.points, strict=True))
    box = [[min(side) - far, max(side) + far] for side in sides]
    if p.bottom is not None:
        box[2][1] = max(min(box[2][1], p.bottom), box[2][0])

    def hold(cell: Cell) -> bool:
        ball = p.grid.around(cell)
        return largest_below(ball, top) or above_level(p, cell, ball)

    cover(tree, p.grid.cell(box), hold, "the largest eigenvalue of Q is not shown to be bounded")


def above_level(p: Attraction, cell: Cell, ball: Ball3) -> bool:
    """Show W > ℓ all over a cell: W is convex, so above its tangent plane at the centre."""
    if min(ball.near) == 0:
        return False
    value = ONE * sum(ball.near) + min(end * ball.center[2] for end in p.pull) - p.range[1]
    for slope, (_, b), x in zip(slopes(p, ball), cell, ball.center, strict=True):
        value -= max(map(abs, slope)) * (b - x)
    return value > 0


def slopes(p: Attraction, ball: Ball3) -> list[tuple[int, int]]:
    """Enclose ∇W = q3* e3 - q at the centre, in units of 1/ONE."""
    ends = []
    for i in range(3):
        low, high = p.pull if i == 2 else (0, 0)
        for ray, d in zip(ball.rays, ball.near, strict=True):  # -ray/distance, in [d, d + 1]
            parts = (-ONE * ray[i] // d, -ONE * ray[i] // (d + 1))
            low, high = low + min(parts), high + max(parts) + 1
        ends.append((low, high))
    return ends


def verify_barrier(p: Attraction, bottom: Fraction, tree: str) -> None:
    """Verify that no motion from the starts passes below z = bottom while Λ <= ℓ."""
    s, (_, a3, a4), (k1, k2, k3, _) = p.s, p.a, p.s.gains
    require(k3 >= 3 * k1 * k2, "a barrier needs k3 >= 3 k1 k2")
    singular = s.stiffness * p.q3[1]
    gamma = singular / (s.weight - p.force - singular)
    spread = square_root(2 * p.level * ((1 + gamma) ** 2 / a4 + gamma**2 / a3))[1]
    omega = p.q3[1] * (1 - p.cosine) + p.sine * spread
    limit, most = p.q3[0] - omega, len(s.points) - p.q3[0] + omega
    require(limit > 0, "the tilt lifts the barrier out of reach")
    kappa, product = (k1 * k2 + k3) / s.m, (k1 * k2 + k3) * k1 * k2 / s.m**2  # r + s, r s
    low, high = square_root(kappa**2 - 4 * product)
    slow, slow_above, fast, fast_above = ((kappa + x) / 2 for x in (-high, -low, low, high))
    require(slow > 0, "a pole is too near zero")
    first, second = k1 / s.m * most / fast, Fraction(0)
    for start in p.starts:  # z' <= speed and z'' <= |F|/m there
        second_rate = (start.thrust + s.weight * start.tilt) / s.m
        first = max(first, (second_rate + slow_above * start.speed) / product)
        second = max(second, start.speed / slow)
        ahead = max(start.speed / slow, s.m / (k1 * k2) * (start.speed + second_rate / kappa))
        require(start.position[2][1] + ahead <= bottom, "a start sinks below the barrier")
    verify_plane(p, bottom - first - max(second, fast_above * first / slow), limit, tree)


def verify_plane(p: Attraction, z: Fraction, limit: Fraction, tree: str) -> None:
    """Verify that qz = Σ hi/ri < limit for all positions at a height."""
    unit, most = p.grid.unit, math.ceil(ONE * limit)
    heights = [max(math.ceil((point[2] - z) * unit), 0) for point in p.s.points]
    far = Fraction(sum(heights) + 1, unit) / limit  # farther out every ri is above it
    sides = list(zip(*p.s.points, strict=True))[:2]

    def hold(cell: Cell) -> bool:
        whole = 0
        for point, h in zip(p.grid.points, heights, strict=True):
            gaps = (max(a - x, x - b, 0) for x, (a, b) in zip(point, cell, strict=False))
            whole += ONE * h // max(math.isqrt(sum((g * g for g in gaps), h * h)), 1) + 1
        return whole < most

    box = p.grid.cell([[min(side) - far, max(side) + far] for side in sides])
    cover(tree, box, hold, "the barrier is not shown to hold")


def verify_start(p: Attraction, start: Start, tree: str) -> None:
    """Verify that Λ <= ℓ in a set of states, and that the thrust is above the singularity."""
    safe = p.s.weight - start.thrust > p.s.stiffness * p.q3[1]
    require(safe, "a thrust at the start is too low")
    require(p.bottom is None or start.position[2][1] <= p.bottom, "a start is below the barrier")
    box, add = p.grid.cell(start.position), added(p, start)
    middle = [sum(side) for side in box[:2]]
    rim = math.ceil((2 * p.grid.unit * (start.radius or 0) + 2) ** 2)

    def hold(cell: Cell) -> bool:
        if start.radius is not None:  # what is farther from the axis is left out
            gaps = (max(2 * a - x, x - 2 * b, 0) for (a, b), x in zip(cell, middle, strict=False))
            if sum(gap * gap for gap in gaps) > rim:
                return True
        return below_level(p, add, cell)

    cover(tree, box, hold, "a start is not shown to have Λ <= level")


def added(p: Attraction, start: Start) -> list[int]:
    """Return what a start that moves adds to |δ1|, then |δ2| and |δ3|, and to |δ4|, in 1/ONE.

    To lean by φ turns q3* ρ and the unit vectors of q by φ, and adds at most m g φ to |F|.
    """
    s, (k1, k2, k3, _) = p.s, p.s.gains
    room = s.weight + start.thrust - s.stiffness * p.q3[0]
    moved, lean = s.m / k1 * start.speed, s.weight / s.stiffness * start.tilt
    turned = s.m / (s.stiffness * (k1 * k2 + k3)) * room * start.rate
    last = turned + lean + moved + len(s.points) * start.tilt
    shares = (p.q3[1] * start.tilt, moved, start.thrust / s.stiffness + lean, last)
    return [math.ceil(ONE * x) for x in shares]


def below_level(p: Attraction, add: Sequence[int], cell: Cell) -> bool:
    """Show Λ <= ℓ for positions in a cell.

    W is convex, so its corners bound it; q changes by at most Σ 1/ri a metre, and by at most φ
    where unit vectors are turned by φ.
    """
    ball = p.grid.around(cell)
    if min(ball.near) <= ball.radius:
        return False
    highest = p.range[0]
    for a, b, c in itertools.product(*(sorted(set(side)) for side in cell)):
        squares = ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 for x, y, z in p.grid.points)
        far = sum(math.isqrt(square) + 1 for square in squares)
        highest = max(highest, ONE * far + max(end * c for end in p.pull))
    change = sum(ONE * ball.radius // (d - ball.radius) + 1 for d in ball.near)
    sizes = [max(map(abs, ends)) for ends in slopes(p, ball)]  # of q - q* at the centre
    level = math.isqrt(sizes[0] ** 2 + sizes[1] ** 2) + 1 + change
    d1 = math.isqrt(sum(x * x for x in sizes)) + 1 + change + add[0]
    d2, d3, d4 = d1 + add[1], d1 + add[1] + add[2], level + add[3]
    a2, a3, a4 = p.a
    W = Fraction(highest - p.range[0], p.grid.unit * ONE)
    return W + (a2 * d2**2 + a3 * d3**2 + a4 * d4**2) / (2 * ONE**2) <= p.level


def theorem_of_attraction(c: Any, p: Attraction) -> str:
    """Say in words what is proved."""
    s, claim = p.s, c["claim"]
    if p.bottom is None:
        states = "state of the set {Λ <= level, T > 0}"
        stays = ". This knows no ground: on its way the motion may pass below the target points"
    else:
        height = f", at least {about(number(claim['barrier_height']))} m above the mean height"
        states = f"level hover at rest with Λ <= level{height} of the target points"
        stays = "; it stays in {Λ <= level, T > 0} and at that height or above it"
    side, up, down = map(about, p.reach)
    hover = ", ".join(map(about, numbers(c["hover"], 3)))
    others = "".join(f", and in every {state_of(start)}" for start in p.starts[2:])
    return (
        f"For the mission {s.name} (m = {s.m} kg, g = {s.gravity} m/s², {s.words()}, goal straight "
        f"below with q3* = {float(sum(p.q3) / 2):.12g} to 12 digits) let Λ = W + ½(a2|δ2|² + "
        f"a3|δ3|² + a4|δ4|²), W = Σ|P'i - ξ| + q3* z less its minimum, (a2, a3, a4) = "
        f"({', '.join(map(about, p.a))}), level = {about(p.level)}. With the exact model and "
        f"controller in continuous time and all target points seen, the controller may be switched "
        f"on, with any heading and yaw rate, in every {states}: the motion converges to the hover "
        f"at the goal{stays}. On the way Λ <= level and Λ' <= -(k1/m) "
        f"{about(p.rate)} (|q - q3* ρ|² + |δ2|² + |δ3|² + |δ4|²). This holds in "
        f"every level hover at rest up to {side} m sideways of the point ({hover}) m at its "
        f"height, up to {up} m above it and {down} m below it{others}."
    )


def state_of(start: Start) -> str:
    """Describe a set of states."""
    place = f"position in ({', '.join(interval(a, b) for a, b in start.position)}) m"
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

ORDER, ACCURACY = 20, 50  # |d| <= 2^-ACCURACY


class Ball(NamedTuple):
    """The numbers within `rad` of `mid`, both whole multiples of 2^-BITS."""

    mid: int
    rad: int

    @classmethod
    def over(cls, low: Fraction, high: Fraction | None = None) -> "Ball":
        """Enclose an interval, or a number."""
        bottom = math.floor(low * (1 << BITS))
        top = math.ceil((low if high is None else high) * (1 << BITS))
        return cls((bottom + top) // 2, (top - bottom + 1) // 2)

    def times(self, other: "Ball") -> "Ball":
        """Enclose a product."""
        rad = self.size() * other.rad + self.rad * other.size()
        return Ball(self.mid * other.mid >> BITS, (rad >> BITS) + 2)

    def size(self) -> int:
        """Bound the absolute value."""
        return abs(self.mid) + self.rad


class Series:
    """Enclosed Taylor coefficients, each computed when it is asked for, in order."""

    __slots__ = ("mid", "rad", "rule", "size")

    def __init__(self, rule: Callable[[int], Ball]) -> None:
        self.rule = rule  # gives the coefficient of an order
        self.mid: list[int] = []
        self.rad: list[int] = []
        self.size: list[int] = []

    def __getitem__(self, order: int) -> Ball:
        while len(self.mid) <= order:
            ball = self.rule(len(self.mid))
            self.mid.append(ball.mid)
            self.rad.append(ball.rad)
            self.size.append(ball.size())
        return Ball(self.mid[order], self.rad[order])

    def __add__(self, other: "Series") -> "Series":
        def rule(i: int) -> Ball:
            x, y = self[i], other[i]
            return Ball(x.mid + y.mid, x.rad + y.rad)

        return Series(rule)

    def __sub__(self, other: "Series") -> "Series":
        def rule(i: int) -> Ball:
            x, y = self[i], other[i]
            return Ball(x.mid - y.mid, x.rad + y.rad)

        return Series(rule)

    def __mul__(self, other: "Series") -> "Series":
        return inner([self], [other])

    def __rmul__(self, c: Fraction) -> "Series":
        ball = Ball.over(c)
        return Series(lambda i: ball.times(self[i]))


def constant(x: Ball) -> Series:
    """Return the series of a constant."""
    return Series(lambda i: Ball(0, 0) if i else x)


def inner(x: Sequence[Series], y: Sequence[Series]) -> Series:
    """Return the series of xᵀy."""

    def rule(i: int) -> Ball:
        mid = rad = 0
        for a, b in zip(x, y, strict=True):
            a[i], b[i]  # now they are there
            mid += sum(map(operator.mul, a.mid, b.mid[i::-1]))
            rad += sum(map(operator.mul, a.size, b.rad[i::-1]))
            rad += sum(map(operator.mul, a.rad, b.size[i::-1]))
        return Ball(mid >> BITS, (rad >> BITS) + 2)

    return Series(rule)


class Motion(NamedTuple):
    """A motion that is claimed to sink, from above, to the height of the lowest target point."""

    s: Setting
    start: list[list[Fraction]]  # intervals of ξ, ξ', b, w in world axes, and of T
    time: Fraction  # s
    steps: list[Fraction]  # s; in which it is followed
    depth: Fraction  # z of the lowest target point, m


STATE = ("position", "velocity", "axis", "turning")


def read_motion(c: Any) -> Motion:
    """Read the start of a motion, for how long it is to be followed, and in which steps."""
    s, given = (
        of_the_paper(read_setting(c)),
        keys(c["motion"], (*STATE, "thrust", "time", "steps"), "motion"),
    )
    require(all(end == 0 for ends in s.centroid[:2] for end in ends), "the goal is not axial")
    start = [side for name in STATE for side in numbers(given[name], 3, 2)]
    start.append(numbers(given["thrust"], 2))
    require(all(low <= high for low, high in start), "the start is not in order")
    require(inhabited(start[6:9], start[9:12]), "no state is shown to be in the start")
    time, depth = number(given["time"]), max(point[2] for point in s.points)
    require(0 < time <= MAX_TIME, f"the time is not above 0 s and at most {MAX_TIME} s")
    require(start[2][1] < depth, "the start is not above the lowest target point")
    require(isinstance(given["steps"], list), "steps is not a list")
    require(len(given["steps"]) * (len(s.points) + 3) <= MAX_STEPS, "there are too many steps")
    steps = [number(step) for step in given["steps"]]
    require(min(steps, default=0) > 0 and sum(steps) == time, "the steps do not fill the time")
    return Motion(s, start, time, steps, depth)


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
    low, high = map(total, zip(*squares, strict=True))
    return low <= 1 <= high and least <= 0 <= greatest


def unknowns(p: Motion) -> list[Ball]:
    """Enclose ξ, ξ', b, w, T, 1/D and every 1/ri at the start."""
    singular = [p.s.stiffness * q3 for q3 in p.s.centroid[2]]
    low, high = p.start[12][0] - singular[1], p.start[12][1] - singular[0]
    require(low > 0, "the thrust at the start is not above the singularity T = c q3*")
    boxes = [*p.start, [1 / high, 1 / low]]
    for point in p.s.points:
        sides = [[a - x, b - x] for (a, b), x in zip(p.start, point, strict=False)]
        near = total(max(a, -b, Fraction(0)) ** 2 for a, b in sides)
        far = total(max(-a, b) ** 2 for a, b in sides)
        require(near > 0, "the start is at a target point")
        boxes.append([1 / square_root(far)[1], 1 / square_root(near)[0]])
    return [Ball.over(*box) for box in boxes]


def taylor(p: Motion, z: Sequence[Ball], step: Fraction, order: int) -> list[Series]:
    """Return the coefficients up to an order, times stepⁱ, of all motions from a box."""
    s, (k1, k2, k3, k4) = p.s, p.s.gains
    m, c, kappa, slowing = s.m, s.stiffness, (k1 * k2 + k3) / s.m, k4 / s.m
    singular = constant(Ball.over(*(c * q3 for q3 in s.centroid[2])))
    points = [[constant(Ball.over(x)) for x in point] for point in s.points]
    reach = max(x.size() for x in z)
    require(reach < 10**12 << BITS, "the motion is not followed to its end")
    slopes: list[Series] = []  # the right sides, of each unknown

    def unknown(k: int) -> Series:
        parts = [Ball.over(step / i) for i in range(1, order + 1)]
        return Series(lambda i: parts[i - 1].times(slopes[k][i - 1]) if i else z[k])

    series = [unknown(k) for k in range(len(z))]
    xi, v, b, w = (series[i : i + 3] for i in (0, 3, 6, 9))
    T, x, u = series[12], series[13], series[14:]  # x = 1/D, u = 1/r
    none = constant(Ball(0, 0))

    def up(value: Fraction) -> list[Series]:  # value·e3
        return [none, none, constant(Ball.over(value))]

    rays = [[at - place for at, place in zip(point, xi, strict=True)] for point in points]
    seen = [inner(axis, u) for axis in zip(*rays, strict=True)]
    y = [far + m / k1 * vk - q for far, vk, q in zip(up(s.weight / c), v, seen, strict=True)]
    a = [g + (kappa + slowing) * yk for g, yk in zip(up(s.weight / k1), y, strict=True)]
    by = inner(b, y)
    rise = kappa * (c * by - T + singular)  # T'
    gain, h = c * kappa * x, (rise + c * kappa * by) * x + constant(Ball.over(slowing))
    inward = gain * inner(b, a) + inner(w, w)
    slopes += v
    slopes += [g - 1 / m * (T * bk) for g, bk in zip(up(s.gravity), b, strict=True)]
    slopes += w
    slopes += [gain * ak - inward * bk - h * wk for ak, bk, wk in zip(a, b, w, strict=True)]
    slopes += [rise, none - x * x * rise]
    slopes += [uj * uj * uj * inner(ray, v) for uj, ray in zip(u, rays, strict=True)]
    for i, line in itertools.product(range(order + 1), series):
        line[i]
    return series


def advance(p: Motion, z: Sequence[Ball], step: Fraction) -> list[Ball]:
    """Enclose where all motions from a box are after a step."""
    series, most = taylor(p, z, step, ORDER - 1), 1 << (BITS - ACCURACY)
    reach = [sum(line.size[1:]) + most for line in series]
    hull = [Ball(x.mid, x.rad + 2 * r + 1) for x, r in zip(z, reach, strict=True)]
    rest = [line[ORDER] for line in taylor(p, hull, step, ORDER)]
    require(max(x.size() for x in rest) <= most, "the motion is not followed to its end")
    ends = zip(series, rest, strict=True)
    return [Ball(sum(line.mid) + x.mid, sum(line.rad) + x.rad) for line, x in ends]


def verify_motion(c: Any, p: Motion) -> None:
    """Verify that the motion exists for the time, and where it ends."""
    z = unknowns(p)
    for step in p.steps:
        z = advance(p, z, step)
    sunk = z[2].mid - z[2].rad >= p.depth * (1 << BITS)
    require(sunk, "the motion is not shown to sink to the lowest target point")


def theorem_of_motion(c: Any, p: Motion) -> str:
    """Say in words from where the vehicle sinks to the target."""
    sides = [interval(a, b) for a, b in p.start]
    place, speed, axis, turning = (", ".join(sides[i : i + 3]) for i in (0, 3, 6, 9))
    return (
        f"It is not true that, for the mission {p.s.name} (m = {p.s.m} kg, g = {p.s.gravity} m/s², "
        f"{p.s.words()}, goal straight below with q3* = {float(sum(p.s.centroid[2]) / 2):.12g} to "
        f"12 digits), the vehicle stays above the lowest target point, z < {about(p.depth)} m, for "
        f"{about(p.time)} s from a state with position ({place}) m, velocity ({speed}) m/s and "
        f"thrust {sides[12]} N whose body axis e3 is ({axis}) and turns at ({turning}) 1/s, all in "
        f"world axes, with yaw rate zero. There is such a state. With the exact model and "
        f"controller in continuous time, all target points seen and any heading, the motion from "
        f"every such state, which is above that height, exists for {about(p.time)} s, T > c q3* "
        f"on the way, and at their end the vehicle is at that height or lower: z >= "
        f"{about(p.depth)} m. What comes after is not said."
    )


# --- what a file is, and what is said of it -------------------------------------------------------


class Kind(NamedTuple):
    """A kind of certificate: its own keys, how they are read, what it says and how it is shown."""

    keys: tuple[str, ...]
    read: Callable[[Any], Any]
    verify: Callable[[Any, Any], None]
    theorem: Callable[[Any, Any], str]


KINDS = {
    "gains": Kind(
        *(("weights", "region", "enclosures", "vertices", "claim"), read_gains),
        *(verify_gains, theorem_of_gains),
    ),
    "counterexample": Kind(
        *(("weights", "region", "counterexample"), read_gains),
        *(verify_counterexample, theorem_of_counterexample),
    ),
    "region": Kind(("region",), read_spread, verify_region, theorem_of_region),
    "outside": Kind(("region", "outside"), read_spread, verify_outside, theorem_of_outside),
    "attraction": Kind(
        *(("weights", "hover", "enclosures", "multipliers", "claim", "trees"), read_attraction),
        *(verify_attraction, theorem_of_attraction),
    ),
    "sinking": Kind(("motion",), read_motion, verify_motion, theorem_of_motion),
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

    Raises Rejected if it does not prove what it claims, Unreadable if it is of an older version.

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
    version = certificate.get("version")
    if certificate.get("format") == "hoverproof certificate" and version == 1:
        raise Unreadable("was made by an older version of hoverproof; make it anew")
    keys(certificate, COMMON + KINDS[kind].keys, "certificate")
    known = certificate["format"] == "hoverproof certificate" and type(version) is int
    require(known and version == VERSION, f"not version {VERSION} of the format")
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
    except Unreadable as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
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
