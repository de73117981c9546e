"""Check a hoverproof certificate. Standard library only; imports nothing of hoverproof.

    python -I -S checker.py FILE

Exit status 0: accepted; 1: rejected; 2: not a certificate that can be read.

A certificate holds the exact numbers of a mission, a claim, and hints: multipliers, how boxes are
halved, time steps. This program takes nothing else from it, and searches for nothing: it builds
every matrix itself from the equations below and verifies the hints in exact arithmetic, without
any tolerance. What is irrational is enclosed between rationals. Proofs of all theorems are in
proofs/README.md.

Chapters: numbers; forms; reading; the model; covers of boxes by cells; then each theorem: its
equations, what a file holds of it (`own`) and what follows from that (`__init__`), what is shown
(`verify`), and what is said (`words`). They are eigenvalues over a box, gains, regions of
attraction, every vehicle within tolerances, and motions that sink.
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
from types import SimpleNamespace as Object
from typing import Any, ClassVar, NamedTuple

Row = Sequence[Fraction]
Matrix = list[list[Fraction]]
Interval = Sequence[Fraction]  # its two ends
Cell = list[tuple[int, int]]  # a box, its ends whole numbers of a unit of length

# What a file may ask for, so that any file is answered within seconds, about J within some more.
VERSION = 2
MAX_BYTES = 1_000_000
MAX_DIGITS = 80  # of a numerator or denominator
MAX_POINTS = 1024
MAX_ROTORS = 16
MAX_STARTS = 16
MAX_WORK = 800_000  # cells times what one costs times `price`, over all trees
PAIRED = 16  # so many points are few
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


def minus(x: Iterable[Any], y: Iterable[Any]) -> list[Any]:
    """Return x - y, component by component."""
    return list(map(operator.sub, x, y))


def dot(x: Iterable[Any], y: Iterable[Any]) -> Any:
    """Return xᵀy."""
    return sum(map(operator.mul, x, y))


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


def upward(x: Fraction) -> Fraction:
    """Round a number that is not negative up to about 64 bits."""
    unit = Fraction(2) ** (64 + x.denominator.bit_length() - x.numerator.bit_length())
    return math.ceil(x * unit) / unit


def exponential_above(x: Fraction, bound: Fraction) -> bool:
    """Show exp(x) >= bound, x >= 0, by a part of its series, rounded down."""
    term = total = 1 << 128
    for k in range(1, 400):
        term = term * x.numerator // (x.denominator * k)
        total += term
    return total >= bound * (1 << 128)


def cosine_below(x: Fraction, bound: Fraction) -> bool:
    """Show cos x <= bound by the series, which up to a power x⁴ᵏ is above it."""
    term = total = Fraction(1)
    for k in range(1, 11):
        term *= -(x**2) / (2 * k * (2 * k - 1))
        total += term
    return total <= bound


def within(inner: Interval, outer: Interval) -> bool:
    """Tell whether an interval lies in another."""
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


def about(low: Fraction, high: Fraction | None = None) -> str:
    """Write a rational number so that a person sees its size, or an interval of such."""
    if high is None or high == low:
        return str(low) if len(str(low)) < 6 else f"{low} (about {float(low):.6g})"
    return f"[{about(low)}, {about(high)}]"


# --- forms --------------------------------------------------------------------------------------


class Form(dict[tuple[int, ...], Fraction]):
    """A linear or quadratic form in X: the coefficient of each Xi, or each Xi Xj, i <= j."""

    def __add__(self, other: "Form") -> "Form":
        new = Form(self)
        for key, c in other.items():
            new[key] = new.get(key, 0) + c
        return new

    def __sub__(self, other: "Form") -> "Form":
        return self + Fraction(-1) * other

    def __rmul__(self, c: Fraction) -> "Form":
        return Form({key: c * x for key, x in self.items()} if c else {})

    @staticmethod
    def inner(x: "Vector", y: "Vector") -> "Form":
        """Return the quadratic form xᵀy of vectors of linear forms."""
        new = Form()
        for left, right in zip(x, y, strict=True):
            for ((i,), a), ((j,), b) in itertools.product(left.items(), right.items()):
                key = (min(i, j), max(i, j))
                new[key] = new.get(key, 0) + a * b
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
        return sum((c * X[i] * X[j] for (i, j), c in self.items()), Fraction(0))


class Vector(tuple[Any, ...]):
    """Three linear forms, or three series."""

    def __add__(self, other: "Vector") -> "Vector":  # type: ignore[override]
        return Vector(map(operator.add, self, other))

    def __sub__(self, other: "Vector") -> "Vector":
        return Vector(map(operator.sub, self, other))

    def __rmul__(self, c: Any) -> "Vector":
        return Vector(c * x for x in self)

    def __matmul__(self, other: "Vector") -> Any:
        """Return xᵀy."""
        return self[0].inner(self, other)


def flat(x: Vector) -> Vector:
    """Return P x: the third component is dropped."""
    return Vector([*x[:2], Form()])


def upright(x: Vector) -> Vector:
    """Return x - P x: only the third component is left."""
    return Vector([Form(), Form(), x[2]])


def through(rows: Sequence[Row], x: Vector) -> Vector:
    """Return the product of a matrix with a vector of linear forms."""
    return Vector(sum((c * y for c, y in zip(row, x, strict=True)), Form()) for row in rows)


def squares(weights: Row, errors: Iterable[Vector]) -> Form:
    """Return Σ wi |δi|²."""
    return sum((w * (d @ d) for w, d in zip(weights, errors, strict=True)), Form())


ERRORS = D1, D2, D3, D4 = [  # δ1, δ2, δ3, δ4
    Vector(Form({(i,): Fraction(1)} if i < 11 else {}) for i in range(k, k + 3))
    for k in (0, 3, 6, 9)
]


# --- reading ------------------------------------------------------------------------------------
#
# What a file is to hold is written down as shapes: a function reads a value; a list stands for a
# list of just these; a dictionary for an object of just these keys, or a tuple of such for one.


def parsed(shape: Any, value: Any) -> Any:
    """Read a JSON value of a shape; an object becomes one with attributes."""
    if callable(shape):
        return shape(value)
    if isinstance(shape, list):
        fits = isinstance(value, list) and len(value) == len(shape)
        require(fits, "a list is misshapen")
        return [parsed(part, entry) for part, entry in zip(shape, value, strict=True)]
    shapes = shape if isinstance(shape, tuple) else (shape,)
    require(isinstance(value, dict), f"not an object: {str(value)[:40]!r}")
    fitting = [each for each in shapes if set(value) == set(each)]
    wanted = "; or ".join(", ".join(each) for each in shapes)
    require(fitting, f"an object must have the keys {wanted}")
    found = Object()
    for key, part in fitting[0].items():
        try:
            setattr(found, key, parsed(part, value[key]))
        except Rejected as error:
            raise Rejected(f"{key}: {error}") from None
    return found


def such(shape: Any, holds: Callable[[Any], object], what: str) -> Callable[[Any], Any]:
    """Return what reads a value of a shape for which something holds."""

    def reader(value: Any) -> Any:
        found = parsed(shape, value)
        if not holds(found):
            raise Rejected(f"{what}: {str(value)[:40]!r}")
        return found

    return reader


def anything(value: Any) -> Any:
    """Read a value as it is."""
    return value


def word(pattern: str, what: str) -> Callable[[Any], Any]:
    """Return what reads a string of a form."""
    return such(anything, lambda x: isinstance(x, str) and re.fullmatch(pattern, x, re.A), what)


def several(shape: Any, most: int) -> Callable[[Any], Any]:
    """Return what reads a list of any length up to so many."""
    few = such(anything, lambda x: isinstance(x, list) and len(x) <= most, "a list is misshapen")
    return lambda values: [parsed(shape, value) for value in few(values)]


def maybe(shape: Any, none: Any = None) -> Callable[[Any], Any]:
    """Return what reads a value that may be absent, which has a sign."""
    return lambda value: none if value == none else parsed(shape, value)


def digest(value: Any) -> str:
    """Return the SHA-256 of a JSON value in canonical form.

    Parameters
    ----------
    value : mapping
        A JSON object.
    """
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def number(text: Any) -> Fraction:
    """Read an exact rational in lowest terms, written as "p" or "p/q"."""
    top, _, bottom = word(r"-?[0-9]+(/[0-9]+)?", "not an exact number")(text).partition("/")
    short = max(len(top.lstrip("-")), len(bottom)) <= MAX_DIGITS
    require(short, f"a number is longer than {MAX_DIGITS} digits: {text[:40]!r}")
    require(bottom == "" or int(bottom) > 0, "a denominator is zero")
    value = Fraction(int(top), int(bottom or 1))
    require(str(value) == text, f"not in lowest terms: {text[:40]!r}")
    return value


positive = such(number, lambda x: x > 0, "must be positive")
size = such(number, lambda x: x >= 0, "must not be negative")
share = such(number, lambda x: 0 <= x < 1, "must be a share from 0 to below 1")
interval = such([number] * 2, lambda x: x[0] <= x[1], "the ends of an interval are not in order")
VECTOR, BOX = [number] * 3, [interval] * 3
TREE = word("[0-3]+", "a tree is not written in 0, 1, 2 and 3")  # see `cover`
GAINS = ("k1", "k2", "k3", "k4", "k_yaw")  # k1 kg m/s, k2 1/m, k3 and k4 kg/s
BODY = {  # I33 and so on; with products of inertia I12, I13 and I23 besides
    **dict.fromkeys(("mass", "drag_ratio", "gravity"), positive),  # kg, m, m/s²
    "inertia": [positive] * 3,  # kg m²
}
VEHICLE = tuple(  # m: the lever of each rotor of an X frame; or where each is, (x, y), how it turns
    BODY | placed | more
    for placed in ({"arm": positive}, {"rotors": several(VECTOR, MAX_ROTORS)})
    for more in ({}, {"products": VECTOR})
)
AUTO = word("auto", "bounds that are assumed have no box")
ASSUMED = {"eigenvalues": maybe([number] * 2, "auto")}, {"eigenvalues": AUTO, "box": BOX}  # 1/m, m
FORCE = {"thrust": [number] * 2}, {"level": positive}  # N; of L
LAW = {  # the choices of a law; without them it is the paper's
    "feature": word("centroid|scaled", "no such feature"),
    "goal": word("image|inertial", "no such goal"),
    "force": word("modelled|measured", "no such force"),
}
PAPERS = ("centroid", "image", "modelled")


def also(shape: dict[str, Any], **more: Any) -> tuple[dict[str, Any], ...]:
    """Return the shapes of objects that have any of some more keys besides."""
    names = itertools.product(*((None, name) for name in more))
    return tuple(shape | {name: more[name] for name in some if name} for some in names)


NOISE = dict.fromkeys(("feature", "velocity", "force", "rate"), size)  # 1, m/s, N, rad/s
UNCERTAINTY = also(  # what a proof is asked to cover; without it, nothing
    {
        **dict.fromkeys(("thrust", "torque"), share),
        **dict.fromkeys(("latency", "rotor_lag", "wind", "yaw_rate"), size),  # s, s, m/s², rad/s
        "noise": also(NOISE, vertical=positive),  # 1
    },
    **dict.fromkeys(("gust", "control_period", "force_lag"), positive),  # m/s², s, s
    gyro_turned=word("false", "a late image is turned by the gyroscope unless this is false"),
)
LENS = also(  # it bears on no claim
    dict.fromkeys(("width", "height", "fx", "fy", "cx", "cy"), positive),  # px
    distortion_model=word("equidistant", "no such distortion"),
    distortion=several(number, 5),
)
CAMERA = also({}, half_angle=positive, position=VECTOR, rotation=VECTOR, lens=LENS)[1:]  # rad, m
WHERE = {"height": number}, {"centroid": VECTOR}  # m; q*
IMAGE = word("image", "a heading that is not from a compass is from the image")
ANGLE = {"heading": number}  # rad
HEADINGS: tuple[dict[str, Any], ...] = {}, ANGLE, ANGLE | {"heading_from": IMAGE}
PLAIN = {
    "name": word(r"[\w.-]{1,64}", "the mission has no proper name"),
    "vehicle": VEHICLE,
    # world axes, z down, m; how much each counts, by default 1
    "target": also({"points": several(VECTOR, MAX_POINTS)}, weights=several(positive, MAX_POINTS)),
    "goal": tuple(where | more for where in WHERE for more in HEADINGS),
    "gains": tuple(dict.fromkeys((*GAINS, *more), positive) for more in ((), ("k_heading",))),
    "bounds": tuple(bounds | force for bounds in ASSUMED for force in FORCE),
    "start": dict.fromkeys(("position", "velocity", "rotation", "rates"), VECTOR),
}
MORE = {"law": LAW, "uncertainty": UNCERTAINTY, "camera": CAMERA}  # each may be there or not


def mission_of(value: Any) -> Any:
    """Read a mission."""
    held = value if isinstance(value, dict) else {}
    return parsed(PLAIN | {key: part for key, part in MORE.items() if key in held}, value)


TOOLS = ("hoverproof", "casadi", "cvxpy", "clarabel")
ABOUT = {"mission": mission_of, "mission_sha256": anything, "goal_position": maybe(VECTOR)}
HEAD = {
    **dict.fromkeys(("format", "version", "kind", "statement", "sha256"), anything),
    "model_sha256": word("[0-9a-f]{64}", "no SHA-256"),
    "tools": dict.fromkeys(TOOLS, word(r"[\w.+-]{1,64}", "no proper version")),
}


# --- the model ----------------------------------------------------------------------------------
#
# Errors X = (δ1, δ2, δ3, δ4) ∈ R¹¹, Ω3 = 0, v = δ1 + δ2, P drops the third component,
# A = q3* I - e3 q*ᵀ, f = f(T), the terms in Ω left out. With the scaled centroid, J = (∂s/∂q) Q is
# in place of Q and s* in place of q*; of a goal that is inertial, zero is in place of q* here. With
# an accelerometer that is ideal, as in the model, the measured force is the modelled one.
#
#     m δ1' = -k1 Q v + k1 f A(δ4 - δ3)
#     m δ2' =  k1 Q v - k1 k2 δ2 + k1 k2 δ3 - k1 f A(δ4 - δ3)
#     m δ3' =  k1 Q v - k1 k2 δ2 + (k1 k2 + k3) δ4 - k3 δ3
#     m δ4' =  k1 P Q v - (k1 k2 + k3) P δ3 - k4 δ4


def rates(k: Row, Q: Sequence[Row], f: Fraction, q: Row) -> list[Vector]:
    """Return m δ1', m δ2', m δ3' and m δ4', the terms in Ω left out."""
    k1, k2, k3, k4 = k
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


def sigma(k: Row, w: Row, Q: Sequence[Row], f: Fraction, q: Row) -> Form:
    """Return XᵀΣX = -m L', L = ½ Σ wi|δi|²."""
    each = zip(w, ERRORS, rates(k, Q, f, q), strict=True)
    return Form() - sum((x * (d @ rate) for x, d, rate in each), Form())


class Pattern(NamedTuple):
    """Target points in world axes, m, each in one place, and how much each counts."""

    points: Matrix
    weights: Row

    @classmethod
    def of(cls, target: Any) -> "Pattern":
        """Take the target of a mission; points that coincide count as much as all of them."""
        weights = getattr(target, "weights", [Fraction(1)] * len(target.points))
        require(len(weights) == len(target.points), "a target has a weight for each point")
        places: dict[tuple[Fraction, ...], Fraction] = {}
        for point, weight in zip(target.points, weights, strict=True):
            places[tuple(point)] = places.get(tuple(point), Fraction(0)) + weight
        return cls([list(place) for place in places], list(places.values()))

    def whole(self) -> Fraction:
        """Return W, the sum of the weights: the number of points, if each counts once."""
        return sum(self.weights, Fraction(0))

    def mean(self) -> list[Fraction]:
        """Return the weighted mean."""
        sides = zip(*self.points, strict=True)
        return [Fraction(dot(self.weights, side)) / self.whole() for side in sides]


def centroid_seen(target: Pattern, position: Row) -> list[Interval]:
    """Enclose q = Σ wi (Pi - ξ)/|Pi - ξ|; points at equal distance are added before rounding.

    What is not exact, or long, is rounded outward: sums of fractions grow longer and longer.
    """
    sums: dict[Fraction, list[Fraction]] = {}
    for point, weight in zip(*target, strict=True):
        ray = minus(point, position)
        square = dot(ray, ray)
        require(square > 0, "the goal coincides with a target point")
        counted = [weight * x for x in ray]
        sums[square] = list(map(operator.add, sums.get(square, (0, 0, 0)), counted))
    box: list[Interval] = []
    for i in range(3):
        ends = [outward(*sorted(ray[i] / r for r in square_root(s))) for s, ray in sums.items()]
        low, high = zip(*ends, strict=True)
        box.append(outward(sum(low, Fraction(0)), sum(high, Fraction(0))))
    return box


def seen_near(target: Pattern, position: Row) -> tuple[list[Interval], Fraction]:
    """Enclose q at the hover near a position, at its height, that has Pq = 0; and how far it is.

    Pq is less the slope of a convex function, whose Hessian is a part of Q: where Q ≻ low I within
    r, and |Pq| < low r, there is such a place within |Pq|/low, and one alone. On the way to it q3
    changes by at most Σ wi/ri a metre.
    """
    q, grid = centroid_seen(target, position), Grid(target)
    if not any(map(any, q[:2])):
        return q, Fraction(0)
    off = square_root(sum((max(abs(a), abs(b)) ** 2 for a, b in q[:2]), Fraction(0)))[1]
    near = min(square_root(dot(ray, ray))[0] for ray in (minus(p, position) for p in target.points))
    r = near / 2**20
    view, high = View(grid, grid.cell([(x - r, x + r) for x in position])), target.whole() / near
    tried = (high / 2**k for k in range(100))
    low = next((x for x in tried if smallest_above(view, x)), Fraction(0))
    require(off < low * r, "there is no hover with a vertical centroid near the goal")
    moved = off / low
    shift = moved * target.whole() / (near - r)
    zero = Fraction(0), Fraction(0)
    return [zero, zero, outward(q[2][0] - shift, q[2][1] + shift)], moved


def scaled(q: list[Interval], n: Fraction) -> list[Interval]:
    """Enclose s = q √(n (n + a)/(2 (n² - a²)))/a, a = |q|, for q in a box that is not at zero.

    n is the sum of the weights.
    """
    ends = [[max(a, -b, Fraction(0)) ** 2, max(-a, b) ** 2] for a, b in q]
    low, high = (sum(squares, Fraction(0)) for squares in zip(*ends, strict=True))
    require(low > 0 and high < n**2, "no hover sees this centroid")
    a = square_root(low)[0], square_root(high)[1]
    grown = [n * (n + x) / (2 * (n**2 - square)) for x, square in zip(a, (low, high), strict=True)]
    stretch = square_root(grown[0])[0] / a[1], square_root(grown[1])[1] / a[0]
    products = [[x * y for x in side for y in stretch] for side in q]
    return [outward(min(each), max(each)) for each in products]


def farthest(box: Sequence[Interval], other: Sequence[Interval]) -> list[Fraction]:
    """Bound |x - y| in each component, for x and y in two boxes."""
    return [
        max(abs(x - y) for x in side for y in sides) for side, sides in zip(box, other, strict=True)
    ]


class Claim:
    """What is claimed of a mission; each kind of claim adds its own."""

    own: ClassVar[dict[str, Any]]  # what a certificate of the kind has besides, as shapes
    anywhere: ClassVar[bool] = False  # whether it covers a camera beside the centre of mass

    def __init__(self, c: Any) -> None:
        self.c, self.name, k = c, c.mission.name, c.mission.gains
        self.camera = getattr(c.mission, "camera", Object())
        place = getattr(self.camera, "position", [Fraction(0)])
        self.arm = upward(square_root(dot(place, place))[1]) if any(place) else Fraction(0)  # m
        central = self.anywhere or not self.arm
        require(central, "a camera that is not at the centre of mass is not covered by this claim")
        self.m, self.gravity = c.mission.vehicle.mass, c.mission.vehicle.gravity
        self.k, self.weight = [k.k1, k.k2, k.k3, k.k4], self.m * self.gravity
        self.stiffness = k.k1**2 * k.k2 / self.m  # c of the force, N
        self.target, goal = Pattern.of(c.mission.target), c.mission.goal
        self.points, self.whole = self.target.points, self.target.whole()
        require(len(self.points) >= 2, f"a target has 2 to {MAX_POINTS} points, not all in one")
        self.moved = Fraction(0)  # bounds how far the goal is from its position here
        if hasattr(goal, "height"):
            heights, place = [z for _, _, z in self.points], c.goal_position
            there = place is not None and place[2] == self.target.mean()[2] - goal.height
            require(there, "the goal is not at the height of the mission")
            require(min(heights) > place[2], "a target point is above the goal")
            self.centroid, self.moved = seen_near(self.target, place)  # encloses q*
        else:
            q = goal.centroid
            require(c.goal_position is None, "a goal by centroid has no position here")
            require(q[2] > 0 and dot(q, q) < self.whole**2, "no hover sees this q*")
            self.centroid = [(x, x) for x in q]
        self.law = tuple(vars(c.mission.law).values()) if hasattr(c.mission, "law") else PAPERS
        self.scaled = self.law[0] == "scaled"
        # what turns with the image of the wanted feature: all of it, or nothing
        self.fixed = scaled(self.centroid, self.whole) if self.scaled else self.centroid
        if self.law[1] == "inertial":
            require(self.vertical(), "a goal fixed to the vertical is straight below")
            self.fixed = [(Fraction(0), Fraction(0))] * 3
        self.heading = hasattr(goal, "heading")
        require(self.heading or not hasattr(k, "k_heading"), "there is no heading to turn to")

    def vertical(self) -> bool:
        """Tell whether q* is vertical."""
        return not any(map(any, self.centroid[:2]))

    def counted(self) -> str:
        """Say what n is."""
        weighed = hasattr(self.c.mission.target, "weights")
        return "sum of the weights" if weighed else "number of target points"

    def times(self) -> str:
        """Name the weights in a sum over the target points, if there are any."""
        return " wi " if hasattr(self.c.mission.target, "weights") else ""

    def of_another_law(self) -> str:
        """Name the law, unless it is the paper's."""
        return "" if self.law == PAPERS else f"law {'/'.join(self.law)}, "

    def left_out(self) -> str:
        """Say that nothing is considered of what the mission asks to be covered, if it asks."""
        asked = ["[uncertainty]"] if hasattr(self.c.mission, "uncertainty") else []
        asked += ["[camera]"] if hasattr(self.camera, "half_angle") else []
        here = f"This is about the vehicle as modelled, {' and '.join(asked)} not considered"
        return f" {here}." if asked else ""

    def gains(self) -> str:
        """Name the gains."""
        return ", ".join(f"{name} = {k}" for name, k in zip(GAINS, self.k, strict=False))

    def factor(self, thrust: Fraction, q3: Fraction) -> Fraction:
        """Return f(T) = k1 k2 (k1 k2 + k3)/(m (T - c q3)), c = k1² k2/m, q3 of what is fixed."""
        (k1, k2, k3, _), distance = self.k, thrust - self.stiffness * q3
        require(distance > 0, "the thrust interval reaches the singularity T = c q3*")
        return Fraction(k1 * k2 * (k1 * k2 + k3) / (self.m * distance))


# --- covers of boxes by cells -------------------------------------------------------------------


def price(points: int) -> int:
    """Return what so many points count in a cell: as 5 more, and each beyond 16 as an eighth."""
    return points + 5 if points <= PAIRED else PAIRED + 5 + (points - PAIRED) // 8


def require_little(points: Matrix, *trees: tuple[str | None, int]) -> None:
    """Require that all cells of trees, at what one costs in each, take no more than MAX_WORK."""
    work = sum(tree.count("0") * cost for tree, cost in trees if tree)
    require(work * price(len(points)) <= MAX_WORK, "the trees are too long")


def cover(tree: str, box: Cell, holds: Callable[[Cell], bool], what: str) -> None:
    """Verify that something holds over each cell that a box is halved into, so over the box.

    The tree is written in preorder: 0 stands for a cell that is not halved, 1, 2 or 3 for one that
    is, across that axis.
    """
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


class Grid:
    """Lengths as whole numbers of a unit that divides every coordinate of the target."""

    def __init__(self, target: Pattern) -> None:
        # so many units are 1 m
        self.unit = 2**40 * math.lcm(*(c.denominator for point in target.points for c in point))
        require(self.unit < 10**46, "the coordinates of the target are too long")
        self.points = [[int(c * self.unit) for c in point] for point in target.points]
        self.per = math.lcm(*(w.denominator for w in target.weights))  # so many count 1
        require(self.per < 10**46, "the weights of the target are too long")
        self.weights = [int(w * self.per) for w in target.weights]

    def cell(self, box: Sequence[Interval]) -> Cell:
        """Round a box outward."""
        require(all(abs(end) < 10**9 for side in box for end in side), "a box is too far away")
        return [(math.floor(a * self.unit), math.ceil(b * self.unit)) for a, b in box]


class View:
    """Positions within ρ of the centre of a cell, which they hold, and the target seen from it."""

    def __init__(self, grid: Grid, cell: Cell) -> None:
        self.center = center = [(a + b) // 2 for a, b in cell]
        corner = [b - c for (_, b), c in zip(cell, center, strict=True)]  # b - c >= c - a
        self.square = dot(corner, corner)  # ρ²
        self.radius = math.isqrt(self.square) + 1  # ρ, rounded up
        self.unit, self.rays = grid.unit, [minus(point, center) for point in grid.points]
        self.near = [math.isqrt(dot(ray, ray)) for ray in self.rays]  # d for a length in [d, d + 1]
        self.weights, self.per = grid.weights, grid.per


def turns(weights: Iterable[int], rays: Sequence[Sequence[int]], shift: int) -> list[list[int]]:
    """Return the matrix of Σ wi |x × di|² + shift |x|²: Σ wi (|di|² I - di diᵀ) + shift I."""
    weights, (x, y, z) = list(weights), zip(*rays, strict=True)
    wx, wy, wz = (list(map(operator.mul, weights, side)) for side in (x, y, z))
    xx, yy, zz, xy, yz, zx = map(dot, (wx, wy, wz, wx, wy, wz), (x, y, z, y, z, x))
    return [
        [yy + zz + shift, -xy, -zx],
        [-xy, zz + xx + shift, -yz],
        [-zx, -yz, xx + yy + shift],
    ]


def largest_below(view: View, high: Fraction) -> bool:
    """Show Q ≺ high I over a ball.

    By Q ⪯ Σ wi/ri I, and by Q(c + δ) ⪯ Q(c) + Σ 1.155 wi ρ/(di - ρ)² I: the derivative of
    (I - pipiᵀ)/ri along a unit vector has norm at most (2/√3)/ri².
    """
    radius, near = view.radius, view.near
    if min(near) <= radius:
        return False
    scale = 1 << (64 + 3 * max(near).bit_length())  # weights and bounds are multiples of 1/scale
    top = scale * view.per * high.numerator // (high.denominator * view.unit)
    if dot(view.weights, (scale // (d - radius) + 1 for d in near)) < top:
        return True
    slopes = (1155 * scale * radius // (1000 * (d - radius) ** 2) + 1 for d in near)
    steep, bent = dot(view.weights, slopes), (-(scale // d**3) - 1 for d in near)
    return definite(turns(map(operator.mul, view.weights, bent), view.rays, top - steep))


def smallest_above(view: View, low: Fraction) -> bool:
    """Show Q ≻ low I over a ball.

    With ωi the weights, wi = ωi/(di + ρ)³ <= ωi/ri³, s = Σ wi di and any θ > 0 with 1/θ >= Σ wi,

        xᵀQx = Σ ωi |x × (di - δ)|²/ri³ >= Σ wi |x × di|² - 2 (x × s)·(x × δ) + Σ wi |x × δ|²
             >= Σ wi |x × di|² - θ|x × s|² - (1/θ - Σ wi) ρ²|x|².
    """
    scale = 1 << (64 + 3 * max(view.near).bit_length())  # as in `largest_below`
    each = zip(view.weights, view.near, strict=True)
    weights = [w * (scale // (d + 1 + view.radius) ** 3) for w, d in each]
    bottom = -(-scale * view.per * low.numerator // (low.denominator * view.unit))
    whole = sum(weights)
    rays = [*view.rays, [dot(weights, side) for side in zip(*view.rays, strict=True)]]
    for k in (2, 4, 16, 64, 2**20):  # 1/θ = k Σ wi; the inequality is multiplied by that
        times = k * whole
        lost = times * (bottom + (k - 1) * whole * view.square)
        if definite(turns([*(times * w for w in weights), -1], rays, -lost)):
            return True
    return False


# --- the slope of the scaled centroid ------------------------------------------------------------
#
# With W = Σ ωi the sum of the weights, n where that is their number, C the weighted mean of the
# points, r0 = |C - ξ|, p0 = (C - ξ)/r0, t = 1/r0 and ei = Pi - C, so that Σ ωi ei = 0, let bi =
# ei·p0, di = 2 bi + t|ei|², fi = ri/r0 = √(1 + t di), κi = 1/fi, λi = -di κi/(1 + fi), ηi = (bi di
# (1 + 1/(1 + fi)) - |ei|²) κi/(1 + fi), vi = ηi p0 + λi ei and wi = ei - bi p0 + t vi. The unit
# vectors are pi = p0 + t wi, κi = 1 + t λi, λi = -bi + t ηi. With means weighted by ωi, v̄ that of
# the vi, q = W (p0 + t² v̄) and t v̄ is that of the wi. With gij = (di - dj)/(fi + fj), ri - rj = gij
# and eij = ei - ej, W² - |q|² = ½ ΣΣ ωi ωj |pi - pj|² = t² S, S the sum over pairs of ωi ωj κi κj
# (|eij|² - gij²), and r0 ∂S/∂C = S',
#
#     S' = Σ ωi ωj κi κj (-t (|eij|² - gij²)((λi + λj) p0 + κi wi + κj wj) - 2 gij (wi - wj)).
#
# Of many points it is W Σ ωi |pi - q/W|², a little less sharp over cells. With gi = ri - r0 =
# di/(1 + fi), |wi|² = κi (|ei|² - gi²) = κi|ei|² + λi gi, S = W (Σ ωi |wi|² - W |t v̄|²), and
#
#     S' = W Σ ωi (2 λi wi - t|wi|² (λi p0 + κi wi)) - 2 W² (|t v̄|² p0 + t R̄ t v̄), R̄ below.
#
# With a = |q|, A = n √n √((n + a)/(2 S))/a, h = (1/(2 (n + a)) - 1/a) a' - S'/(2 S),
# a' = -t² (S' - 2 S p0)/(2 a), and R̄ the mean of ηi (I - p0 p0ᵀ) - ui p0ᵀ - p0 uiᵀ - κi wi wiᵀ,
# ui = λi wi + vi,
#
#     s = A (p0 + t² v̄)/t,    J = A (I + t² (R̄ + v̄ p0ᵀ) + (p0 + t² v̄) hᵀ).
#
# Nothing cancels in them. Over a cell each of these is enclosed by a number, a slope and a rest.
#
# A cell is a box of positions, or a wedge: a box of x, y, u, where (x, y, 1)/u = C - ξ.

BITS = 84  # numbers are multiples of 2^-BITS
ONE_OF_THEM = 1 << BITS


class Tangent(NamedTuple):
    """What is within `rest` of mid + slope·x for x in [-1, 1]³, the place in a cell."""

    mid: int
    slope: tuple[int, int, int]
    rest: int
    far: int  # bounds how far it is from mid

    @classmethod
    def of(cls, mid: int, a: int, b: int, c: int, rest: int) -> "Tangent":
        """Return one with a slope."""
        return tuple.__new__(cls, (mid, (a, b, c), rest, abs(a) + abs(b) + abs(c) + rest))

    @classmethod
    def constant(cls, c: Fraction) -> "Tangent":
        """Enclose a number."""
        return cls(math.floor(c * ONE_OF_THEM), (0, 0, 0), 1, 1)

    def __add__(self, other: "Tangent") -> "Tangent":  # type: ignore[override]
        (m, (a, b, c), e, _), (k, (x, y, z), f, _) = self, other
        return self.of(m + k, a + x, b + y, c + z, e + f)

    def __sub__(self, other: "Tangent") -> "Tangent":
        (m, (a, b, c), e, _), (k, (x, y, z), f, _) = self, other
        return self.of(m - k, a - x, b - y, c - z, e + f)

    def __mul__(self, other: "Tangent") -> "Tangent":  # type: ignore[override]
        (m, (p, q, r), e, g), (k, (s, t, u), f, h) = self, other
        a, b, c = m * s + k * p >> BITS, m * t + k * q >> BITS, m * u + k * r >> BITS
        rest = (abs(m) * f + abs(k) * e + g * h >> BITS) + 5
        far = abs(a) + abs(b) + abs(c) + rest
        return tuple.__new__(Tangent, (m * k >> BITS, (a, b, c), rest, far))

    def times(self, n: int, d: int = 1) -> "Tangent":
        """Return it times n/d."""
        a, b, c = self.slope
        rest = self.rest * abs(n) // d + 5
        return self.of(self.mid * n // d, a * n // d, b * n // d, c * n // d, rest)

    def scaled(self, c: Fraction) -> "Tangent":
        """Return it times a number."""
        return self.times(c.numerator, c.denominator)

    def bent(self, value: int, slope: int, least: int, bend: int) -> "Tangent":
        """Return a function of it: its value and slope at mid, from which it bends away.

        The function less its tangent line is between `least` and least + bend. The slope that is
        given may be off by one unit and by 2/mid, and so the tangent line by spread + 2 units.
        """
        _, (p, q, r), rest, far = self
        a, b, c = slope * p >> BITS, slope * q >> BITS, slope * r >> BITS
        rest = (abs(slope) * rest + far >> BITS) + bend // 2 + 10
        return self.of(value + least + bend // 2, a, b, c, rest)

    def inverse(self) -> "Tangent":
        """Return 1/x of x > 0, which is above its tangent line by at most d²/(m² (m - d))."""
        m, d = self.mid, self.far
        require(m > d, "a number is not shown to be positive")
        value = (1 << 2 * BITS) // m
        most = (d * (value + 1) >> BITS) + 1  # at least d/m
        return self.bent(value, -(value * value >> BITS), 0, most * most // (m - d) + 1)

    def root(self) -> "Tangent":
        """Return √x of x > 0, below its tangent line by at most d²/(2√m (√m + √(m - d))²)."""
        m, d = self.mid, self.far
        require(m > d, "a number is not shown to be positive")
        value, low = math.isqrt(m << BITS), math.isqrt((m - d) << BITS)
        bend = d * d * ONE_OF_THEM // (2 * value * (value + low) ** 2 >> BITS) + 1
        return self.bent(value, ONE_OF_THEM**2 // (2 * value), -bend, bend)


Three = list[Tangent]
NOTHING, ONE_TANGENT = (Tangent.of(mid, 0, 0, 0, 0) for mid in (0, ONE_OF_THEM))


def along(x: Iterable[Tangent], y: Iterable[Tangent]) -> Tangent:
    """Return xᵀy."""
    mid = a = b = c = rest = 0
    for (m, (p, q, r), e, g), (k, (s, t, u), f, h) in zip(x, y, strict=True):
        mid += m * k
        a += m * s + k * p
        b += m * t + k * q
        c += m * u + k * r
        rest += abs(m) * f + abs(k) * e + g * h
    return Tangent.of(mid >> BITS, a >> BITS, b >> BITS, c >> BITS, (rest >> BITS) + 5)


def add_up(values: Iterable[Tangent]) -> Tangent:
    """Return a sum."""
    mid = a = b = c = rest = 0
    for m, (x, y, z), e, _ in values:
        mid, a, b, c, rest = mid + m, a + x, b + y, c + z, rest + e
    return Tangent.of(mid, a, b, c, rest)


def place_in(grid: Any, cell: Cell) -> Three:
    """Return the positions of a cell, in the unit of its grid or wedge."""
    xi = []
    for k, (a, b) in enumerate(cell):
        half, mid = (x * ONE_OF_THEM // (2 * grid.unit) for x in (b - a, a + b))
        xi.append(Tangent.of(mid, half * (k == 0), half * (k == 1), half * (k == 2), 2))
    return xi


class Target:
    """Target points from their mean, and what is the same from wherever they are seen."""

    def __init__(self, target: Pattern) -> None:
        self.weights, self.whole, self.mean = target.weights, target.whole(), target.mean()
        self.apart = [minus(point, self.mean) for point in target.points]
        self.squares = [dot(e, e) for e in self.apart]
        constant = Tangent.constant
        self.constants = [([constant(x) for x in e], constant(dot(e, e))) for e in self.apart]
        self.many = len(target.points) > PAIRED
        self.share, self.alike = 1 / self.whole, all(weight == 1 for weight in self.weights)
        self.pairs = [
            (i, j, [2 * x for x in across], constant(dot(across, across)), more, weight)
            for i, j in itertools.combinations(range(0 if self.many else len(self.apart)), 2)
            for across in [minus(self.apart[i], self.apart[j])]
            for more in [self.squares[i] - self.squares[j]]
            for weight in [self.weights[i] * self.weights[j]]
        ]


class Sight:
    """A target seen from a cell, or from a position."""

    def __init__(self, target: Target, p0: Three, t: Tangent) -> None:
        axes = range(3)
        self.target, self.p0, self.t, self.square = target, p0, t, t * t
        self.rays = [self.ray(i) for i in range(len(target.apart))]
        self.sum = [self.weighed(ray.v[k] for ray in self.rays) for k in axes]
        self.mean = [x.scaled(target.share) for x in self.sum]
        self.lead = [p0[k] + self.square * self.mean[k] for k in axes]  # q/W

    def weigh(self, values: Iterable[Tangent]) -> Three:
        """Return wi xi of each point."""
        if self.target.alike:
            return list(values)
        each = zip(self.target.weights, values, strict=True)
        return [x if weight == 1 else x.scaled(weight) for weight, x in each]

    def weighed(self, values: Iterable[Tangent]) -> Tangent:
        """Return Σ wi xi."""
        return add_up(self.weigh(values))

    @classmethod
    def over(cls, target: Target, xi: Three) -> "Sight":
        """See the target from the positions of a cell."""
        ray = [Tangent.constant(c) - x for c, x in zip(target.mean, xi, strict=True)]
        t = along(ray, ray).root().inverse()
        return cls(target, [x * t for x in ray], t)

    @classmethod
    def over_wedge(cls, target: Target, wedge: Three) -> "Sight":
        """See the target from the positions of a wedge."""
        x, y, u = wedge
        z = (x * x + y * y + ONE_TANGENT).root().inverse()
        return cls(target, [x * z, y * z, z], u * z)

    def ray(self, i: int) -> Object:
        """Return what is seen of a point."""
        p0, t, e, square = self.p0, self.t, self.target.apart[i], self.target.squares[i]
        exact, exact_square = self.target.constants[i]
        b = add_up(p0[k].scaled(e[k]) for k in range(3) if e[k])
        d = b.times(2) + t.scaled(square)
        far = (t * d + ONE_TANGENT).root()
        near, short = far.inverse(), (far + ONE_TANGENT).inverse()
        scale = near * short
        bend, back = NOTHING - d * scale, NOTHING - b
        eta = (b * d * (short + ONE_TANGENT) - exact_square) * scale
        v = [along((eta, bend), both) for both in zip(p0, exact, strict=True)]
        gap = d * short
        return Object(far=far, near=near, bend=bend, back=back, eta=eta, v=v, gap=gap)

    def centroid(self) -> Three:
        """Enclose q."""
        return [x.scaled(self.target.whole) for x in self.lead]

    def of_pairs(self) -> Tangent:
        """Compute S over pairs."""
        self.pairs = []
        for i, j, twice, square, more, weight in self.target.pairs:
            one, other = self.rays[i], self.rays[j]
            d = add_up(self.p0[k].scaled(twice[k]) for k in range(3) if twice[k])
            d = d + self.t.scaled(more) if more else d
            g, both = d * (one.far + other.far).inverse(), one.near * other.near
            both = both if self.target.alike else both.scaled(weight)
            self.pairs.append((g, both, both * (square - g * g)))
        return add_up(part for *_, part in self.pairs)

    def of_points(self) -> Tangent:
        """Compute S over points."""
        squares, t = self.target.squares, self.t
        each = zip(self.rays, squares, strict=True)
        self.sizes = [ray.near.scaled(x) + ray.bend * ray.gap for ray, x in each]  # |wi|²
        self.aside = [t * x for x in self.mean]  # the mean of the wi
        self.off = along(self.aside, self.aside).scaled(self.target.whole)
        return (self.weighed(self.sizes) - self.off).scaled(self.target.whole)

    def look(self) -> None:
        """Compute S, and what follows from it."""
        W = self.target.whole
        self.spread = self.of_points() if self.target.many else self.of_pairs()
        a = (Tangent.constant(W**2) - self.square * self.spread).root()
        whole = a + Tangent.constant(W)
        self.short, self.whole, self.less = a.inverse(), whole.inverse(), self.spread.inverse()
        self.gain = (Tangent.constant(W**3 / 2) * whole * self.less).root() * self.short  # A

    def scaled(self) -> Three:
        """Enclose s."""
        self.look()
        size = self.gain * self.t.inverse()
        return [size * x for x in self.lead]

    def bent(self) -> list[Three]:
        """Enclose W R̄, (3, 3)."""
        p0, axes, rays = self.p0, range(3), self.rays
        near = [self.weigh(ray.thin[k] for ray in rays) for k in axes]
        w_of, bends = list(zip(*(ray.w for ray in rays), strict=True)), self.bends
        eta = self.weighed(ray.eta for ray in rays)
        half = eta.times(1, 2)
        turned = [along((*bends, half), (*w_of[k], p0[k])) + self.sum[k] for k in axes]
        R = [[NOTHING] * 3 for _ in axes]
        for i, j in itertools.product(axes, axes):
            if j <= i:
                less = along((*near[i], turned[i], turned[j]), (*w_of[j], p0[j], p0[i]))
                R[i][j] = R[j][i] = NOTHING - less
        for i in axes:
            R[i][i] += eta
        return R

    def fall_of_pairs(self) -> Three:
        """Enclose -S'."""
        p0, t, axes, n = self.p0, self.t, range(3), len(self.rays)
        weights, turns = [NOTHING] * n, [NOTHING] * n  # of κi wi and wi in S'
        for (i, j, *_), (g, both, part) in zip(self.target.pairs, self.pairs, strict=True):
            twice = (g * both).times(2)
            weights[i], weights[j] = weights[i] + part, weights[j] + part
            turns[i], turns[j] = turns[i] + twice, turns[j] - twice
        straight = t * along((ray.bend for ray in self.rays), weights)
        factors = [straight, *(t * weight for weight in weights), *turns]
        w_of = list(zip(*(ray.w for ray in self.rays), strict=True))
        near_of = list(zip(*(ray.thin for ray in self.rays), strict=True))
        return [along(factors, (p0[k], *near_of[k], *w_of[k])) for k in axes]

    def fall_of_points(self, R: list[Three]) -> Three:
        """Enclose -S'."""
        p0, t, axes, W = self.p0, self.t, range(3), self.target.whole
        thin = self.weigh(t * size for size in self.sizes)
        each = list(zip(thin, self.rays, self.bends, strict=True))
        turns = [x * ray.near - bend.times(2) for x, ray, bend in each]
        straight = add_up(x * ray.bend for x, ray, _ in each) + self.off.times(2)
        w_of = list(zip(*(ray.w for ray in self.rays), strict=True))
        twice = [(t * x).times(2) for x in self.aside]
        return [along((*turns, straight, *twice), (*w_of[k], p0[k], *R[k])).scaled(W) for k in axes]

    def slope(self) -> list[Three]:
        """Enclose J, (3, 3), 1/m; after `look`."""
        p0, axes = self.p0, range(3)
        self.bends = self.weigh(ray.bend for ray in self.rays)
        for ray, (e, _) in zip(self.rays, self.target.constants, strict=True):
            ray.w = [along((self.t, ray.back), (ray.v[k], p0[k])) + e[k] for k in axes]
            ray.thin = [ray.near * x for x in ray.w]
        R = self.bent()
        falling = self.fall_of_points(R) if self.target.many else self.fall_of_pairs()
        scale = (self.whole.times(1, 2) - self.short) * self.short * self.square
        half = [x.times(1, 2) for x in falling]
        ends = [(self.spread * p0[k] + half[k], half[k]) for k in axes]
        ahead = [along((scale, self.less), x) for x in ends]  # h
        J = [[NOTHING] * 3 for _ in axes]
        for i, j in itertools.product(axes, axes):
            bent = R[i][j].scaled(self.target.share) + self.mean[i] * p0[j]
            bent = along((self.square, self.lead[i]), (bent, ahead[j]))
            J[i][j] = self.gain * (bent + ONE_TANGENT if i == j else bent)
        return J


def slope_over(target: Pattern, grid: Grid, cell: Cell) -> list[Three] | None:
    """Enclose J over a cell, (3, 3); None if the target is too near."""
    try:
        return scaled_slope(Target(target), place_in(grid, cell))
    except Rejected:  # a number is not shown to be positive
        return None


def scaled_slope(target: Target, xi: Three) -> list[Three]:
    """Enclose J at the positions of a cell, (3, 3), 1/m."""
    sight = Sight.over(target, xi)
    sight.look()
    return sight.slope()


def within_ball(J: list[Three] | None, low: Fraction, high: Fraction) -> bool:
    """Show |J - j I| < ϱ, low = j - ϱ and high = j + ϱ.

    The rests of J have the norm of their matrix at most, and what J changes along an axis too: the
    middle of a cell suffices if that much is left there, else its corners do, as norms are convex.
    """
    if J is None:
        return False
    j = math.floor((low + high) / 2 * ONE_OF_THEM)
    rest = math.isqrt(sum(x.rest**2 for row in J for x in row)) + 2
    room = math.floor((high - low) / 2 * ONE_OF_THEM) - rest
    rows = [[(x.mid - j * (i == k), *x.slope) for k, x in enumerate(r)] for i, r in enumerate(J)]
    lost = sum(math.isqrt(sum(x.slope[k] ** 2 for row in J for x in row)) + 1 for k in range(3))

    def below(room: int, p: int = 0, q: int = 0, r: int = 0) -> bool:
        ends = [[m + p * a + q * b + r * c for m, a, b, c in row] for row in rows]
        left = [[-dot(x, y) for y in ends[: i + 1]] for i, x in enumerate(ends)]
        for i in range(3):
            left[i][i] += room**2
        return room > 0 and definite(left)

    return below(room - lost) or all(below(room, *x) for x in itertools.product((-1, 1), repeat=3))


def beyond_ball(target: Pattern, position: Row, x: Row, low: Fraction, high: Fraction) -> bool:
    """Show |J x - j x| > ϱ|x| at a position."""
    J = scaled_slope(Target(target), [Tangent.constant(c) for c in position])
    j, size, square = (low + high) / 2, square_root(dot(x, x))[1], Fraction(0)
    for row, along_it in zip(J, x, strict=True):
        value = dot([Fraction(y.mid, ONE_OF_THEM) for y in row], x) - j * along_it
        loss = dot([Fraction(y.far, ONE_OF_THEM) for y in row], [abs(c) for c in x])
        square += max(abs(value) - loss, Fraction(0)) ** 2
    return bool(square > ((high - low) / 2 * size) ** 2)


# --- bounds of Q, or of J, over a box -----------------------------------------------------------


def bounded(
    target: Pattern, scaled: bool, grid: Grid, cell: Cell, low: Fraction, high: Fraction
) -> bool:
    """Show the bounds of J, or of Q, over a cell."""
    if scaled:
        return within_ball(slope_over(target, grid, cell), low, high)
    view = View(grid, cell)
    return largest_below(view, high) and smallest_above(view, low)


class Eigenvalues(Claim):
    """The eigenvalues of Q are within bounds over a box; neither gains nor thrust are in Q.

    Bounds of J are the ends of a ball, |J - j I| <= ϱ: j - ϱ and j + ϱ.

    Claims about gains rest on it, or on bounds that the mission assumes: then there is no box.
    """

    anywhere: ClassVar[bool] = True
    own: ClassVar[dict[str, Any]] = {
        "region": {"box": maybe(BOX), "eigenvalues": [positive] * 2, "tree": maybe(TREE)}
    }

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        (self.low, self.high), self.box, tree = c.region.eigenvalues, c.region.box, c.region.tree
        require(self.low < self.high, "the eigenvalue bounds are not in order")
        assumed = self.box is not None or c.region.eigenvalues == c.mission.bounds.eigenvalues
        require(assumed, "without a box, the eigenvalue bounds are those of the mission")
        shown = self.box is not None and not hasattr(c, "outside")
        require((tree is not None) == shown, "a tree belongs to bounds that are shown over a box")
        require_little(self.points, (tree, 15 if self.scaled else 5))

    def hold(self, grid: Grid, cell: Cell) -> bool:
        """Show the bounds over a cell."""
        return bounded(self.target, self.scaled, grid, cell, self.low, self.high)

    def ball(self) -> str:
        """Say in which ball J is."""
        j, reach = (self.low + self.high) / 2, (self.high - self.low) / 2
        return f"|J - {about(j)} I| <= {about(reach)} 1/m"

    def verify(self) -> None:
        """Verify the bounds over the box, if one is claimed."""
        if self.box is not None:
            grid, what = Grid(self.target), "the bounds are not shown to hold"
            box, tree = grid.cell(self.box), self.c.region.tree
            cover(tree, box, lambda cell: self.hold(grid, cell), what)

    def words(self) -> str:
        """Say over which box the bounds hold."""
        require(self.box is not None, "a claim about a region has a box")
        sides = " x ".join(f"[{about(a)}, {about(b)}]" for a, b in self.box)
        held = f"the eigenvalues of Q lie between {about(self.low)} and {about(self.high)} 1/m"
        if self.scaled:
            held = (
                "J = (∂s/∂q) Q of the scaled centroid s = q √(n (n + |q|)/(2 (n² - |q|²)))/|q|, n "
                f"the {self.counted()}, obeys {self.ball()}"
            )
        return (
            f"For the target of the mission {self.name} and every position in the box {sides} m, "
            f"{held}."
        )


class Outside(Eigenvalues):
    """Q has an eigenvalue out of bounds, or J is out of its ball, at a position in the box."""

    own = Eigenvalues.own | {
        "outside": {
            # m; x with xᵀQx out of bounds, or |(J - j I)x| > ϱ|x|
            **{"position": VECTOR, "direction": VECTOR},
            "bound": word("lower|upper|ball", "the bound is neither lower nor upper, nor a ball"),
        }
    }

    def verify(self) -> None:
        """Verify that an xᵀQx, or J x, is out of bounds."""
        spot = self.c.outside
        require((spot.bound == "ball") == self.scaled, "the bound is that of another feature")
        inside = all(a <= y <= b for y, (a, b) in zip(spot.position, self.box, strict=True))
        require(inside, "the position is not in the box")
        x, lower = spot.direction, spot.bound == "lower"
        if self.scaled:
            out = beyond_ball(self.target, spot.position, x, self.low, self.high)
            require(out, "J there is not shown to be out of its ball")
            return
        xx, value = dot(x, x), Fraction(0)
        for point, weight in zip(*self.target, strict=True):
            # xᵀQx = Σ wi (|x|² - (x·pi)²)/ri, rounded against the claim
            ray = minus(point, spot.position)
            square = dot(ray, ray)
            require(square > 0, "the position is that of a target point")
            part = weight * (xx - dot(ray, x) ** 2 / square)
            value += part / square_root(square)[0 if lower else 1]
        out = value < self.low * xx if lower else value > self.high * xx
        require(out, "the eigenvalue of Q there is not shown to be out of bounds")

    def words(self) -> str:
        """Say what is refuted."""
        lower, place = self.c.outside.bound == "lower", map(str, self.c.outside.position)
        if self.scaled:
            return f"It is not true that {super().words()[:-1]}: not at ({', '.join(place)}) m."
        side, bound = ("smaller", self.low) if lower else ("larger", self.high)
        return (
            f"It is not true that {super().words()[:-1]}: at the position ({', '.join(place)}) m "
            f"in that box, Q has an eigenvalue {side} than {about(bound)} 1/m."
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


class Sigma(Eigenvalues):
    """A claim about Σ; intervals enclose what is irrational."""

    anywhere: ClassVar[bool] = False
    own = Eigenvalues.own | {"weights": [positive] * 4}  # of L

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        if hasattr(c.mission.bounds, "thrust"):
            low, high = c.mission.bounds.thrust
            require(low <= self.weight <= high, "the thrust interval does not hold m g")
        else:
            _, w2, w3, _ = c.weights
            reach = square_root(2 * c.mission.bounds.level * (1 / w2 + 1 / w3))[1] * self.stiffness
            low, high = self.weight - reach, self.weight + reach
        self.thrust, (q_low, q_high) = (low, high), self.fixed[2]
        self.f = self.factor(high, q_low), self.factor(low, q_high)  # holds every f(T), 1/m
        self.attained = self.factor(high, q_high), self.factor(low, q_low)  # each in it is an f(T)

    def asked(self) -> str:
        """Say for which vehicle, gains and intervals."""
        q = ", ".join(f"{float((a + b) / 2):.12g}" for a, b in self.centroid)
        low, high = map(about, self.thrust)
        every = f"symmetric Q with eigenvalues in [{self.low}, {self.high}] 1/m"
        if self.scaled:
            every = f"3 x 3 matrix J with {self.ball()}"
        return (
            f"the mission {self.name} ({self.of_another_law()}m = {self.m} kg, {self.gains()}, "
            f"q* = ({q}) to 12 digits), every {every} and every thrust T in [{low}, {high}] N"
        )


VERTEX = {"factor": number, "multiplier": positive, "margin": number, "decay_rate": number}


class Gains(Sigma):
    """Σ ≻ margin·W, and so L falls."""

    own = Sigma.own | {
        "enclosures": {"centroid": BOX, "factor": interval, "goal": BOX},
        "vertices": [VERTEX] * 2,  # at the ends of the interval of f
        "claim": {"margin": number, "decay_rate": number},
    }

    def verify(self) -> None:
        """Verify a proof of Σ ≻ margin·W, hence of the decay of L."""
        hints, claim, vertices = self.c.enclosures, self.c.claim, self.c.vertices
        for mine, given in zip(self.fixed, hints.centroid, strict=True):
            require(within(mine, given), "the box around q* does not hold q*")
        require(within(self.f, hints.factor), "the interval of f does not hold f(T)")
        require(claim.margin > 0, "a margin of zero or less proves nothing")
        for each in (claim, *vertices):
            follows = each.decay_rate == 2 * each.margin / self.m
            require(follows, "a decay rate does not follow from its margin")
        for f, vertex in zip(hints.factor, vertices, strict=True):
            require(vertex.factor == f, "a vertex is not at an end of the interval of f")
            for q in itertools.product(*(sorted(set(ends)) for ends in hints.centroid)):
                shown = self.bound(f, q, vertex.multiplier, vertex.margin).positive()
                require(shown, "Σ - margin·W is not shown to be positive definite")
        least = min(vertex.margin for vertex in vertices)
        require(claim.margin == least, "the margin is not the smallest of the vertices")
        super().verify()
        self.verify_goal(hints.goal)

    def bound(self, f: Fraction, q: Row, tau: Fraction, t: Fraction) -> Form:
        """Return XᵀMX."""
        w1, w2, w3, w4 = w = self.c.weights
        u, v = w1 * D1 - w2 * D2 - w3 * D3 - w4 * D4, D1 + D2
        middle, loss = (self.low + self.high) / 2, self.k[0] * (self.high - self.low) / 4
        Q = [[middle if i == j else Fraction(0) for j in range(3)] for i in range(3)]
        lost: Form = loss * (tau * (v @ v) + (1 / tau) * (u @ u))
        return sigma(self.k, w, Q, f, q) - t * squares(w, ERRORS) - lost

    def verify_goal(self, box: Matrix) -> None:
        """Verify that a box holds the goal, and low I ≺ Q ≺ high I all over it.

        A goal by its centroid q* is where the convex Σ|P'i - ξ| + q*ᵀξ, of slope q* - q and Hessian
        Q ≻ low I, is least. On the largest ball about the middle of the box, of radius r, it is
        higher than in the middle if |q - q*| < low r/2 there.
        """
        grid = Grid(self.target)
        cell, low = grid.cell(box), self.low
        J = "J" if self.scaled else "Q"
        require(self.hold(grid, cell), f"{J} at the goal is not shown to be within its bounds")
        if self.c.goal_position is not None:
            reach = (self.moved, self.moved, Fraction(0))
            around = ((x - r, x + r) for x, r in zip(self.c.goal_position, reach, strict=True))
            held = all(map(within, around, box))
        else:
            seen = centroid_seen(self.target, [(a + b) / 2 for a, b in box])
            if self.scaled:  # the bounds are not those of Q
                view, tried = View(grid, cell), (self.high / 2**k for k in range(100))
                low = next((x for x in tried if smallest_above(view, x)), Fraction(0))
            off = farthest(seen, self.centroid)
            held = dot(off, off) < (low * min(b - a for a, b in box) / 4) ** 2
        require(held, "the box for Q at the goal is not shown to hold the goal")

    def words(self) -> str:
        """Say what is proved."""
        margin, rate = about(self.c.claim.margin), about(self.c.claim.decay_rate)
        weights, region = ", ".join(map(str, self.c.weights)), ""
        Q, these = ("J", "that ball") if self.scaled else ("Q", "this interval")
        stays = "Q and T stay in these intervals (which is assumed of Q, not shown for the target)"
        if self.scaled:
            stays = "J stays in that ball (which is assumed, not shown for the target), T in its"
            stays += " interval"
        if self.box is not None:
            stays = "the vehicle stays in that box and T in its interval"
            region = super().words() + " "
        alike = self.heading and not any(map(any, self.fixed[:2]))  # Ω3 is in no term but Ω×δi
        yaw = ", whatever the yaw rate Ω3 is," if alike else " and Ω3 = 0,"
        return (
            f"For {self.asked()}, the matrix Σ({Q}, T) is positive definite: XᵀΣX > {margin} kg/s "
            f"times Σ wi|δi|² for all X ≠ 0, w = ({weights}). {region}Hence, while {stays}"
            f"{yaw} the Lyapunov function L = ½ Σ wi|δi|² falls at least as fast as exp(-r t), "
            f"r = {rate} 1/s. At the goal {Q} is within {these}."
        )


class Counterexample(Sigma):
    """Σ(Q, f) is not positive semidefinite at one admissible point."""

    own = Sigma.own | {
        "counterexample": {"Q": [VECTOR] * 3, "f": number, "X": [number] * 11, "value": number}
    }

    def verify(self) -> None:
        """Verify that the point is admissible, and that XᵀΣX is negative there."""
        p = self.c.counterexample
        require([list(x) for x in zip(*p.Q, strict=True)] == p.Q, "Q is not symmetric")
        form, size = D1 @ through(p.Q, D1), D1 @ D1
        inside = (form - self.low * size).positive(3) and (self.high * size - form).positive(3)
        require(inside, "the eigenvalues of Q are not inside the interval")
        require(within((p.f, p.f), self.attained), "no thrust in the interval gives this f")
        corners = itertools.product(*self.fixed)
        worst = max(sigma(self.k, self.c.weights, p.Q, p.f, q).value(p.X) for q in corners)
        require(worst <= p.value < 0, "XᵀΣX is not as negative as claimed")
        super().verify()

    def words(self) -> str:
        """Say what is refuted."""
        p, Q = self.c.counterexample, "J, which stands as Q," if self.scaled else "Q"
        return (
            f"It is not true that, for {self.asked()}, the matrix Σ({Q[0]}, T) is positive "
            f"definite: for the given rational {Q} and X, and the thrust with f(T) = "
            f"{about(p.f)} 1/m, XᵀΣX <= {about(p.value)} < 0."
        )


# --- regions of attraction ----------------------------------------------------------------------
#
# For an axial goal, q* = (0, 0, q3*), let G(ξ) = Σ wi|P'i - ξ| + q3* z, W = G - min G, e = q -
# q3* ρ, θ = Pρ/(1 + ρ3), η = (q3* c/(m g)) (P - e3 θᵀ)(δ3 - δ2), v = e + η + δ2 = (m/k1) V. With
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
# largest at the largest tilt and the least thrust, T = m g - d. qz = Σ wi hi/ri; no hi/ri falls as
# the vehicle rises (it jumps from -1 to 1 through the point). If k3 >= 3 k1 k2, let r <= s have
# r + s = κ, r s = κ k1 k2/m; then x = z + z'/r obeys x' = s (N - x), z' = r (x - z). So N - x and
# x - z keep below lags D1 >= (k1/m) max w/s and D2 >= s D1/r, and if w <= 0 wherever
# z >= zb - D1 - D2, none of N, x, z passes zb.

ONE = 1 << 64  # fractions of a cell's bounds are whole multiples of 1/ONE
START = {  # a set of states, with any heading and any yaw rate
    "position": BOX,  # m
    "speed": size,  # bounds |V|, m/s
    "tilt": size,  # bounds φ, rad
    "rate": size,  # bounds √(Ω1² + Ω2²), rad/s
    "thrust": size,  # bounds |T - m g|, N
}


class Axial(Claim):
    """A claim for a goal straight below, q* = (0, 0, q3*)."""

    laws: ClassVar[set[tuple[str, ...]]] = {PAPERS}

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        require(self.law in self.laws, "this is shown for the law of the paper alone")
        self.q3 = self.centroid[2]  # holds q3*
        require(self.vertical(), "the goal is not axial")

    def asked(self) -> str:
        """Say for which vehicle, gains and goal."""
        return (
            f"the mission {self.name} ({self.of_another_law()}m = {self.m} kg, g = {self.gravity} "
            f"m/s², {self.gains()}, "
            f"goal straight below with q3* = {float(sum(self.q3) / 2):.12g} to 12 digits)"
        )


class Attraction(Axial):
    """From some states the motion converges to the hover at the goal."""

    own: ClassVar[dict[str, Any]] = {
        "weights": [positive] * 3,  # a2, a3, a4
        "hover": VECTOR,  # near where G is least, m
        "enclosures": {
            **{"goal": interval, "factor": interval, "tilt": number},  # of q3* and f(T); of |θ|
            "largest_eigenvalue": positive,  # of Q, 1/m
        },
        "multipliers": [positive] * 2,
        "claim": {
            **{"level": positive, "rate": positive},
            "barrier_height": maybe(number),  # above the mean of the target, m
            "reach": dict.fromkeys(("sideways", "up", "down"), size),  # of hovers from `hover`, m
            "starts": several(START, MAX_STARTS),
        },
        "trees": {
            **{"positions": TREE, "barrier": maybe(TREE)},
            "starts": several(TREE, MAX_STARTS + 2),
        },
    }

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        claim, trees = c.claim, c.trees
        require(self.q3[0] > 0 and self.q3[1] < self.whole, "no hover sees this q3*")
        require(len({(x, y) for x, y, _ in self.points}) > 1, "the target is one vertical line")
        require(self.c.goal_position in (None, c.hover), "the hover point is not the goal")
        self.a, self.level = c.weights, claim.level
        reach = square_root(2 * self.level * (1 / self.a[0] + 1 / self.a[1]))[1]
        self.force = self.stiffness * reach  # bounds |F|, N
        self.singular = self.stiffness * self.fixed[2][1]  # c q3*, N
        low = self.weight - self.force > self.singular
        require(low, "the thrust reaches the singularity T = c q3*")
        self.sine = self.force / self.weight  # bounds sin φ
        self.cosine = square_root(1 - self.sine**2)[0]  # below cos φ
        mean, height = self.target.mean()[2], claim.barrier_height
        self.bottom = None if height is None else mean - height  # zb, m
        self.starts = [*self.hovers(), *claim.starts]
        require(len(trees.starts) == len(self.starts), "a tree a start")
        require((trees.barrier is None) == (self.bottom is None), "a tree belongs to a barrier")
        costs = (trees.positions, 3), (trees.barrier, 1), *((tree, 4) for tree in trees.starts)
        require_little(self.points, *costs)
        self.grid = Grid(self.target)
        unit, (low, high) = self.grid.unit * ONE, self.least_potential()
        # min G and level + min G in units of the grid/ONE, and q3* in those of 1/ONE, outward
        self.least, self.most = math.floor(unit * low), math.ceil(unit * (high + self.level))
        self.pull = math.floor(ONE * self.q3[0]), math.ceil(ONE * self.q3[1])

    def least_potential(self) -> Interval:
        """Enclose min G >= G(hover) - |∇G||ξ* - hover|; G(ξ*) <= G(hover) bounds the distance."""
        hover, q3 = self.c.hover, self.q3
        rays = (minus(point, hover) for point in self.points)
        far = zip(*(square_root(dot(ray, ray)) for ray in rays), strict=True)
        low, high = (Fraction(dot(self.target.weights, ends)) for ends in far)
        pull = [end * hover[2] for end in q3]
        slope = sum(farthest(centroid_seen(self.target, hover), self.centroid))
        distance = 2 * high / (self.whole - q3[1])
        return outward(low + min(pull) - slope * distance, high + max(pull))

    def hovers(self) -> list[Object]:
        """Return the hovers about the goal: a disc at its height, a line from below to above."""
        (x, y, z), reach = self.c.hover, self.c.claim.reach
        side, still = reach.sideways, dict.fromkeys(list(START)[1:], Fraction(0))
        disc = [[x - side, x + side], [y - side, y + side], [z, z]]
        line = [[x, x], [y, y], [z - reach.up, z + reach.down]]
        return [Object(position=box, **still) for box in (disc, line)]

    def verify(self) -> None:
        """Verify that the set is not left, and that Λ falls in it as claimed."""
        hints, trees = self.c.enclosures, self.c.trees
        require(within(self.q3, hints.goal), "the interval of q3* does not hold it")
        tilted = hints.tilt * (1 + self.cosine) >= self.sine
        require(tilted, "tan(φ/2) is not below the bound of the tilt")
        self.verify_fall()
        if self.bottom is not None:
            self.verify_barrier(self.bottom, trees.barrier)
        self.verify_positions(hints.largest_eigenvalue, trees.positions)
        for start, tree in zip(self.starts, trees.starts, strict=True):
            self.verify_start(start, tree)

    def verify_fall(self) -> None:
        """Verify that Λ falls as claimed where Q ⪯ λ I."""
        hints = self.c.enclosures
        high, low = self.weight + self.force, self.weight - self.force
        f = self.factor(high, self.q3[0]), self.factor(low, self.q3[1])
        require(within(f, hints.factor), "the interval of f does not hold f(T)")
        rate = self.c.claim.rate * squares([Fraction(1)] * 4, ERRORS)
        ends = zip(hints.factor, self.c.multipliers, strict=True)
        for (end, tau), q3 in itertools.product(ends, hints.goal):
            M = self.dissipation(hints.largest_eigenvalue, end, q3, hints.tilt, tau) - rate
            require(M.positive(), "-(m/k1) Λ' is not shown to be above rate·|Y|²")

    def dissipation(
        self, high: Fraction, f: Fraction, q3: Fraction, t: Fraction, tau: Fraction
    ) -> Form:
        """Return the lower bound of -(m/k1) Λ' at θ = (t, 0), for all 0 ⪯ Q ⪯ high I."""
        k1, k2, k3, k4 = self.k
        (a2, a3, a4), K, e = self.a, (k1 * k2 + k3) / k1, D1
        x = (q3 * self.stiffness / self.weight) * (D3 - D2)
        eta = Vector([x[0], x[1], -t * x[0]])
        v, u = e + eta + D2, -a2 * D2 - a3 * D3 - a4 * D4
        lower: Form = (
            (e @ v)
            + (high / 2) * (u @ v)
            - (high / 4) * (tau * (v @ v) + (1 / tau) * (u @ u))
            + a2 * (k2 * (D2 @ (D2 - D3)) + (f * q3) * (D2 @ flat(D4 - D3)))
            + a3 * (D3 @ (k2 * D2 - K * D4 + (k3 / k1) * D3))
            + a4 * (D4 @ (K * D3 + (k4 / k1) * D4))
        )
        return lower

    def around(self, far: Fraction) -> list[list[Fraction]]:
        """Return the box around the target, with room on all sides."""
        return [[min(side) - far, max(side) + far] for side in zip(*self.points, strict=True)]

    def verify_positions(self, high: Fraction, tree: str) -> None:
        """Verify that Q ≺ high I wherever W <= ℓ and z <= zb.

        Farther than W/high from every target point, Q ⪯ Σ wi/ri does not reach high.
        """
        box = self.around(self.whole / high)
        if self.bottom is not None:
            box[2][1] = max(min(box[2][1], self.bottom), box[2][0])

        def hold(cell: Cell) -> bool:
            view = View(self.grid, cell)
            return largest_below(view, high) or self.above_level(cell, view)

        what = "the largest eigenvalue of Q is not shown to be bounded"
        cover(tree, self.grid.cell(box), hold, what)

    def above_level(self, cell: Cell, view: View) -> bool:
        """Show W > ℓ all over a cell: W is convex, so above its tangent plane at the centre."""
        if min(view.near) == 0:
            return False
        value = min(end * view.center[2] for end in self.pull) - self.most
        value += ONE * dot(view.weights, view.near) // view.per
        for slope, (_, b), x in zip(self.slopes(view), cell, view.center, strict=True):
            value -= slope * (b - x)
        return bool(value > 0)

    def slopes(self, view: View) -> list[int]:
        """Bound the components of ∇W = q3* e3 - q at the centre, in units of 1/ONE."""
        most = []
        for i, pull in enumerate([(0, 0), (0, 0), self.pull]):
            low, high = (view.per * end for end in pull)
            for ray, d, weight in zip(view.rays, view.near, view.weights, strict=True):
                part = -ONE * weight * ray[i]
                ends = (part // d, part // (d + 1))  # the distance is in [d, d + 1]
                low, high = low + min(ends), high + max(ends) + 1
            most.append(-(min(low, -high) // view.per))
        return most

    def verify_barrier(self, bottom: Fraction, tree: str) -> None:
        """Verify that no motion from the starts passes below z = bottom while Λ <= ℓ."""
        (_, a3, a4), (k1, k2, k3, _), m = self.a, self.k, self.m
        require(k3 >= 3 * k1 * k2, "a barrier needs k3 >= 3 k1 k2")
        gamma = self.singular / (self.weight - self.force - self.singular)
        spread = square_root(2 * self.level * ((1 + gamma) ** 2 / a4 + gamma**2 / a3))[1]
        omega = self.fixed[2][1] * (1 - self.cosine) + self.sine * spread
        limit, most = self.q3[0] - omega, self.whole - self.q3[0] + omega
        require(limit > 0, "the tilt lifts the barrier out of reach")
        kappa, product = (k1 * k2 + k3) / m, (k1 * k2 + k3) * k1 * k2 / m**2  # r + s, r s
        low, high = square_root(kappa**2 - 4 * product)
        slow, slow_above, fast, fast_above = ((kappa + x) / 2 for x in (-high, -low, low, high))
        require(slow > 0, "a pole is too near zero")
        first, second = k1 / m * most / fast, Fraction(0)
        for start in self.starts:  # z' <= speed and z'' <= |F|/m there
            speed, fall = start.speed, (start.thrust + self.weight * start.tilt) / m
            first = max(first, (fall + slow_above * speed) / product)
            second = max(second, speed / slow)
            ahead = max(speed / slow, m / (k1 * k2) * (speed + fall / kappa))
            require(start.position[2][1] + ahead <= bottom, "a start sinks below the barrier")
        self.verify_plane(bottom - first - max(second, fast_above * first / slow), limit, tree)

    def verify_plane(self, z: Fraction, limit: Fraction, tree: str) -> None:
        """Verify that qz = Σ wi hi/ri < limit for all positions at a height."""
        unit, weights = self.grid.unit, self.grid.weights
        most = math.ceil(ONE * self.grid.per * limit)
        heights = [max(math.ceil((point[2] - z) * unit), 0) for point in self.points]

        def hold(cell: Cell) -> bool:
            whole = 0
            for point, h, weight in zip(self.grid.points, heights, weights, strict=True):
                gaps = (max(a - x, x - b, 0) for x, (a, b) in zip(point, cell, strict=False))
                far = max(math.isqrt(sum((g * g for g in gaps), h * h)), 1)
                whole += weight * (ONE * h // far + 1)
            return whole < most

        # farther out every ri is above it
        reach = Fraction(dot(weights, heights) + 1, unit * self.grid.per) / limit
        box = self.grid.cell(self.around(reach)[:2])
        cover(tree, box, hold, "the barrier is not shown to hold")

    def verify_start(self, start: Object, tree: str) -> None:
        """Verify that Λ <= ℓ in a set of states, and that the thrust is above the singularity."""
        require(self.weight - start.thrust > self.singular, "a thrust at the start is too low")
        above = self.bottom is None or start.position[2][1] <= self.bottom
        require(above, "a start is below the barrier")
        box, add = self.grid.cell(self.path(start)), self.added(start)
        middle = [sum(side) for side in box[:2]]
        disc, side = start is self.starts[0], self.c.claim.reach.sideways
        rim = math.ceil((2 * self.grid.unit * side + 2) ** 2)

        def hold(cell: Cell) -> bool:
            if disc:  # what is farther from its middle is left out
                gaps = (
                    max(2 * a - x, x - 2 * b, 0) for (a, b), x in zip(cell, middle, strict=False)
                )
                if sum(gap * gap for gap in gaps) > rim:
                    return True
            return self.below_level(add, cell)

        cover(tree, box, hold, "a start is not shown to have Λ <= level")

    def path(self, start: Object) -> Sequence[Interval]:
        """Return the positions of a start, those before it that matter among them."""
        return list(start.position)

    def added(self, start: Object) -> Any:
        """Return what a start that moves adds to |δ1|, then |δ2| and |δ3|, and to |δ4|, in 1/ONE.

        To lean by φ turns q3* ρ and the unit vectors of q by φ, and adds at most m g φ to |F|.
        """
        k1, k2, k3, _ = self.k
        room = self.weight + start.thrust - self.stiffness * self.q3[0]
        moved, lean = self.m / k1 * start.speed, self.weight / self.stiffness * start.tilt
        turned = self.m / (self.stiffness * (k1 * k2 + k3)) * room * start.rate
        last = turned + lean + moved + self.whole * start.tilt
        shares = (self.q3[1] * start.tilt, moved, start.thrust / self.stiffness + lean, last)
        return [math.ceil(ONE * x) for x in shares]

    def below_level(self, add: Any, cell: Cell) -> bool:
        """Show Λ <= ℓ for positions in a cell.

        W is convex, so its corners bound it; q changes by at most Σ wi/ri a metre, and by at most φ
        where unit vectors are turned by φ.
        """
        view = View(self.grid, cell)
        if min(view.near) <= view.radius:
            return False
        highest = self.least
        for a, b, c in itertools.product(*(sorted(set(side)) for side in cell)):
            squares = ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 for x, y, z in self.grid.points)
            far = -(-ONE * dot(view.weights, (math.isqrt(x) + 1 for x in squares)) // view.per)
            highest = max(highest, far + max(end * c for end in self.pull))
        steps = (ONE * view.radius // (d - view.radius) + 1 for d in view.near)
        change = -(-dot(view.weights, steps) // view.per)
        sizes = self.slopes(view)  # of q - q* at the centre
        level, whole = (math.isqrt(dot(x, x)) + 1 + change for x in (sizes[:2], sizes))
        W = Fraction(highest - self.least, self.grid.unit * ONE)
        return bool(W + self.beside(add, whole, level) <= self.level)

    def beside(self, add: Any, whole: int, level: int) -> Fraction:
        """Bound Λ - W where |q - q*| and its horizontal part are bounded, in units of 1/ONE."""
        d2, d4 = whole + add[0] + add[1], level + add[3]
        a2, a3, a4 = self.a
        rest = a2 * d2**2 + a3 * (d2 + add[2]) ** 2 + a4 * d4**2
        return Fraction(rest / (2 * ONE**2))

    def words(self) -> str:
        """Say what is proved."""
        claim = self.c.claim
        if self.bottom is None:
            states = "state of the set {Λ <= level, T > 0}"
            stays = ". This knows no ground: on its way the motion may pass below the target points"
        else:
            height = f"at least {about(claim.barrier_height)} m above the mean height"
            states = f"level hover at rest with Λ <= level, {height} of the target points"
            stays = "; it stays in {Λ <= level, T > 0} and at that height or above it"
        side, up, down = map(about, vars(claim.reach).values())
        weights, hover = (", ".join(map(about, x)) for x in (self.a, self.c.hover))
        others = "".join(f", and in every {state_of(start)}" for start in claim.starts)
        return (
            f"For {self.asked()} let Λ = W + ½(a2|δ2|² + a3|δ3|² + a4|δ4|²), "
            f"W = Σ{self.times()}|P'i - ξ| + "
            f"q3* z less its minimum, (a2, a3, a4) = ({weights}), level = {about(self.level)}. "
            f"With the exact model and controller in continuous time and all target points seen, "
            f"the controller may be switched on, with any heading and yaw rate, in every {states}: "
            f"the motion converges to the hover at the goal{stays}. On the way Λ <= level and Λ' "
            f"<= -(k1/m) {about(claim.rate)} (|q - q3* ρ|² + |δ2|² + |δ3|² + |δ4|²). This holds in "
            f"every level hover at rest up to {side} m sideways of the point ({hover}) m at its "
            f"height, up to {up} m above it and {down} m below it{others}."
        )


def state_of(start: Object) -> str:
    """Describe a set of states."""
    place = f"position in ({', '.join(about(a, b) for a, b in start.position)}) m"
    if not any((start.speed, start.tilt, start.rate, start.thrust)):
        return f"level hover at rest with {place}"
    return (
        f"state with {place}, |V| <= {about(start.speed)} m/s, tilt <= {about(start.tilt)} rad, "
        f"√(Ω1² + Ω2²) <= {about(start.rate)} rad/s, |T - m g| <= {about(start.thrust)} N"
    )


# --- every vehicle within tolerances --------------------------------------------------------------
#
# The goal is straight below; s is the feature, s3 the third component of what is wanted of it for
# a goal fixed in the image, 0 for an inertial one; y = J V. Of the vehicle (θ, γ', τ', τr, w', Ω3'
# are the mission's thrust, torque, latency, rotor_lag, wind, yaw_rate):
#
#   m (V' + Ω×V) = F = m g ρ - T e3 + w, |w| <= m w', w fixed in the world, T times m over the true
#   mass the true thrust, T' = ς Ua, |ς - 1| <= θ; e3×Ω' = (I + γ) a + Ω3 G e3×Ω, a the commanded,
#   |γ|, |G| <= γ'. Without lag Ua = U, the commanded; with it Ua' = (U - Ua)/τ, 0 < τ <= τr, and
#   e3×Ω' = (I + γ) b - Ω3 Gt e3×Ω, b the lag of a + Ω3 Gc e3×Ω, where Gc is the controller's own,
#   |Gc| <= ρ' = max(|I3 - I2|/I1, |I3 - I1|/I2), and G = (I + γ) Gc - Gt.
#
# The controller has V, Ω, ρ, F and Tc = T - e3·w; its feature is that of t - τ(t), 0 <= τ(t) <= τ',
# turned to now, and n what is used less what is now: n = ∫ y over that time. c = k1² k2/m,
# κ = (k1 k2 + k3)/m, K = κ + k4/m, k12 = k1 k2/m, Dc = Tc - c s3, h = cκ/Dc, ζ = δ4 - Pδ3,
# e3×Ω = h ζ, χ = 1 + e3·w/Dc, u = Ua/c, p1 = h δ3z, p2 = h nz, p3 = e3·(Ω×w)/Dc, U = Dc (p1 - p2),
# π = 2(p1 - p2) + p3, e = ς(Ua - U)/Dc. Then, the turns -Ω×δi left out,
#
#   δ1' = s3 h ζ - y        δ2' = y + k12 (δ3 - δ2) - s3 h ζ
#   δ3' = y + k12 (δ3 - δ2) + κχζ - ς u e3
#   δ4' = Py + (κχ + (ς - 1)π/2 + π)ζ + k12 P(δ3 - δ2) + σ + ω,   σn = -Kδ4 - k12 P(δ3 - δ2)
#
#   no lag: u = κ(δ3z - nz), σ = σn + K Pn - πζ,
#           ω = (p2 - (ς - 1)p3/2 + Ω3 G)ζ - Ω3 e3×Pn + γ(σ + Ω3 e3×P(δ3 - n))
#   lag:    u = κ δ3z + μT, σ = σn + μ = b/h, η = Dc'/Dc = ς Ua/Dc + p3,
#           ω = (p2 - (ς - 1)p3/2 + e - Ω3 Gt)ζ - Ω3 e3×Pδ3 + γσ
#           τ μ' = K Pn - πζ - μ + Ω3 e3×P(δ3 - n) + Ω3 Gc ζ + τ (ησ + Kδ4' + k12 P(δ3 - δ2)'),
#           P(δ3 - δ2)' = κχζ + s3 h ζ + h(δ3z - δ2z)ζ - Ω3 e3×P(δ3 - δ2)
#           τ μT' = -κ nz - μT - τκ δ3z',   where -(Ω×δ3)z is in δ3z', at most h|Pδ3||ζ|.
#
# E = ½(|δ1|² + w2|δ2|² + w3|δ3|² + w4|δ4|²) + ½τ(a5|μ|² + a6 μT²), and with a memory M > 0
#
#   Ψ = E + M ∫_{-τ'}^0 ∫_{t+x}^t exp(r(z - t)) |y(z)|² dz dx.
#
# A feature that is not turned to now is used in the axes that the camera had then. It moves by
# s' = -Ω×s - y, so n = ∫ (y + Ω×s), and y + Ω×s stands in the memory in the place of y, where
# |Ω×s| <= h|s||ζ| + Ω3'|Ps|, |s| <= s3* + |δ1|; Ps = Pδ1 for a goal in the image, else
# Ps = Pδ1 + s3* Pρ, m g Pρ = c P(δ3 - δ2) - Pw. What w adds to n, at most τ' Ω3' s3* w'/g, is
# counted as noise.
#
# Let feature, V, Ω, ρ and m a be measured wrong by b, v, (ω turned by e3×, ω3), d and f, each with
# the bound of the mission, and let a gust g, an acceleration, be beside the wind. F, Tc and all δ
# are those without it. With G = (m/k1) g, α = f + m g for a measured force, else 0, and φ = (α +
# weight d)/c, B = b - (m/k1) v - φ, for an inertial goal less s3* d: n + B stands where n does, but
# for the memory. A gyroscope that is wrong turns a late image by at most τ'|Ω error|, so that B is
# larger by |s| times that. G is added to δ2', δ3' and P of it to δ4', and to σ (with lag to τ μ')
#
#   C - (πc - π)ζ + ω3 Gc ζ + (1 + ι) ω3 e3×q - ι (K q - Ω3 e3×q) - ι k12 P(δ3 - δ2),
#   q = P(δ3 - n - B),
#   C = -(1 + ι) k12 Pφ - (K + πc) ω/h + (Ω3 + ω3) Gc ω/h,   ι = Dc/(Dc - αz) - 1,
#   πc = 2h (1 + ι)(δ3 - n - B)z + e3·((Ω + (ω, ω3))×(w + α))/(Dc - αz).
#
# With terms -σB|B|² - σC|C|² - σG|G|² the same gives Ψ' <= -r Ψ + r ℓ∞, r ℓ∞ = σB max|B|² + ..., so
# that {Ψ <= ℓ} is not left while ℓ∞ < ℓ, and Ψ(t) <= Ψ(0) exp(-r t) + ℓ∞.
#
# A controller that runs at tk, t - p' <= tk <= t, p' the control_period, and until it runs again
# holds U and the torque, has what was measured at tk. Let also the force be behind a low-pass of a
# time up to f', the force_lag, and let n be that of tk and ∫ y over [tk, t]: |n|² <= (τ' + p') ∫
# |y|² over the last τ' + p'. With κ = 1 in [tk, t] and at most exp((x - tk)/f') before, B has E, C
# has H and αz has c ∫ κ (|ς u| + |p3| Dc/c) besides, and the noise φ has f' |Ω×w|/c:
#
#   E = ∫_{tk}^t (k12 (δ3 - δ2) + P κχζ - Ω×δ3) - e3 ∫ κ ς u
#   H = ∫_{tk}^t ((1 + ι) k12 P(κχζ + s3 h ζ - Ω×(δ3 - δ2)) + (K + πc - Ω3(tk) Gc) h/h(t) ((I + γ)σ
#       - Ω3 Gt ζ)).
#
# Let a part of them be at most w = ∫ g, g = Σ R|v|, g² <= Θ = ΣR ΣR|v|². As w(tk) = 0, ∫ w² <=
# (2p'/ π)² ∫ Θ over [tk, t]: for the level part of E, and H, Ψ has W ∫_{tk}^t exp(r (x - t))
# ((2p'/π)² exp(r p') Θ - w²) dx >= 0 besides, which drops to 0 at tk. For the other part it has W b
# ∫ k(t - x) Θ dx, b = p' + f', k(x) = ∫_x^∞ exp(r (z - x)) κ' dz, κ' = 1 up to p' and exp((p' -
# z)/f') beyond, with k(0) <= (p' + f'/(1 - r f'))/(1 - r p'). So W (|part|² - (2p'/π)² exp(r p')
# Θ), or W (|part|² - b k(0) Θ), is added to -Ψ' - rΨ.
#
# A camera at r from the centre of mass, in body axes, sees the feature of ξ + R r. With a constant
# a that makes it s* at the wanted hover (ξ*, R*) it differs from that of ξ by
#
#   Rᵀ(σ(ξ + R r) - σ(ξ)) + a = (J* - J') r,   J', J* in body axes means of J between ξ and ξ + R r,
#                                              and between ξ* and ξ* + R* r:
#
# at most 2 ϱ |r| if |J - j I| <= ϱ within |r| of every position. It counts as an error of s.
#
# For |J - j I| <= ϱ, ϱ²|V|² >= |y - jV|². As |n|² <= τ' ∫ |y|² over the last τ', Ψ' <= -r Ψ if
#
#   -E' - r E - Mτ'|y|² + (M/τ') exp(-rτ')|n|² - σJ(ϱ²|V|² - |y - jV|²) >= 0,
#
# where uᵀHv <= (R/2)(t|v|² + |u|²/t) for what E' has of norm |H| <= R, with any t > 0. The rest is
# affine, and all of it concave, in each of χ, s3 h, ς, τ and π: their ends suffice. No product in
# it is of components along different axes, and those along y stand in it as those along x: they
# are left out. On {Ψ <= ℓ},
#
#   |δ3|² <= 2ℓ/w3, |δ3 - δ2|² <= 2ℓ(1/w2 + 1/w3), |ζ|² <= 2ℓ(1/w3 + 1/w4), |F| = c|δ3 - δ2| <= f,
#   |V|² <= (k1/m)² 2ℓ(1 + 1/w2), |n| <= τ'(j + ϱ)|V|, (m g - f)² - (m w')² <= Tc² <= (m g + f)²,
#   and the tilt φ has sin φ <= (f + m w')/(m g). |Ua| <= cκ(|δ3| + |n|), as of U, whose lag it is.
#
# With σ(ξ) the feature that a level camera sees, |σ - s*| = |δ1| for an inertial goal; for that of
# the image |σ - s3 R e3| = |δ1|, |R e3 - e3| = sin φ/cos(φ/2) <= t sin φ. So |σ - s*| <= √(2ΨA) +
# b, A = 1 + (s3 t c/(m g))² (1/w2 + 1/w3), b = s3 t w'/g. The domain is a wedge each cell of which
# has |σ - s*| > d >= √(2ℓA) + b, or J in its ball; those at the faces have the first. So no motion
# leaves it. In it ξ' = J⁻¹(σ - s*), for which (σ - s*)' = -(σ - s*), leads from where |σ - s*| <= e
# <= d to the one ξ* with σ = s*, on a way of length |σ - s*|/(j - ϱ) at most, on which |σ - s*|
# falls. So if |J - j' I| <= ϱ' over a box about a point x, x ± R, e < (j' - ϱ')(R - |x - ξ*|), all
# of |σ - s*| <= e is in the box, where |σ - s*| >= (j' - ϱ')|ξ - ξ*|. At a start, |F| <= f0 and sin
# φ <= (f0 + m w')/(m g).
#
# A vehicle whose mass, inertia, rotors and drag ratio κd are the mission's makes the thrust T, that
# is within f + m w' of m g, and torques Γ1, Γ2 that are the moments of inertia times at most
# (1 + γ')|a| + Ω3' ((1 + γ')ρ' + γ')|ζ|h, a = h (σn + K Pn - πζ + Ω3 e3×P(δ3 - n)). With lag it is
# set to what it would settle at, which is τ T' ahead, |T'| <= (1 + θ)|Ua|, and to these torques.
# |Γ3| <= (1 + γ')(k_yaw Ω3' + k_heading + |I2 - I1| |Ω1 Ω2|), k_heading if there is a heading.
# A rotor at (x, y) that turns in the sense s has its entry of Bᵀ(BBᵀ)⁻¹(T, Γ1, Γ2, Γ3), where its
# column of B is (1, -y, x, s κd): in an X frame, (±d, ±d), T/4 ± Γ1/(4d) ± Γ2/(4d) ± Γ3/(4κd). With
# products of inertia the torque is I Ω' + Ω × I Ω: no other torque, lag or rate is covered.


def rotor_shares(vehicle: Any) -> list[Row]:
    """Return the rows of Bᵀ(BBᵀ)⁻¹: what a rotor takes over of T, Γ1, Γ2 and Γ3."""
    placed = getattr(vehicle, "rotors", None)
    if placed is None:
        d = vehicle.arm
        placed = [[d, d, 1], [d, -d, -1], [-d, d, -1], [-d, -d, 1]]
    columns = [[Fraction(1), -y, x, turn * vehicle.drag_ratio] for x, y, turn in placed]
    rows = [[dot(a, b) for b in zip(*columns, strict=True)] for a in zip(*columns, strict=True)]
    rows = [[*row, *(Fraction(i == j) for j in range(4))] for i, row in enumerate(rows)]
    for k in range(4):
        require(rows[k][k] > 0, "the rotors cannot make every thrust and torque")
        rows[k] = [entry / rows[k][k] for entry in rows[k]]
        for i in range(4):
            if i != k:
                rows[i] = minus(rows[i], [rows[i][k] * entry for entry in rows[k]])
    return [[dot(column, row[4:]) for row in rows] for column in columns]


class Wedges:
    """Positions above a target in cells of x, y, u: (x, y, 1)/u is where its mean lies from them.

    A target that is its own mirror image across x or y needs one half of the wedge. With one that
    is the same along x and y, what lies at y > x is seen as its image is.
    """

    def __init__(self, c: Any, target: Pattern, scaled: bool, arm: Fraction) -> None:
        self.scaled, self.arm = scaled, arm
        self.sides, self.goal = c.domain.wedge, c.enclosures.goal
        require(self.sides[2][0] > 0, "the wedge is not above the target")
        self.unit = 2**40 * math.lcm(*(end.denominator for side in self.sides for end in side))
        require(self.unit < 10**46, "the ends of the wedge are too long")
        self.whole = [(int(a * self.unit), int(b * self.unit)) for a, b in self.sides]
        self.target = Target(target)
        self.mean = self.target.mean
        apart = sorted((*e, w) for e, w in zip(self.target.apart, target.weights, strict=True))
        self.length = math.lcm(*(x.denominator for *point, _ in apart for x in point))
        self.apart = [[int(x * self.length) for x in point] for *point, _ in apart]
        images = [(-x, y, z, w) for x, y, z, w in apart], [(x, -y, z, w) for x, y, z, w in apart]
        self.mirrored = [sorted(image) == apart for image in images]
        swapped = sorted((y, x, z, w) for x, y, z, w in apart) == apart
        self.swapped = swapped and self.sides[0] == self.sides[1]

    def faces(self) -> list[tuple[int, int]]:
        """Return the axis and the side of each face; a plane of symmetry is none."""
        each = itertools.product(range(3), (0, 1))
        return [(k, side) for k, side in each if side or not self.halved(k)]

    def halved(self, k: int) -> bool:
        """Tell whether the other half of the wedge is the mirror image of this one."""
        return k < 2 and self.mirrored[k] and self.sides[k][0] == 0

    def left_out(self, cell: Cell) -> bool:
        """Tell whether the image of a cell with x and y exchanged is looked at."""
        return self.swapped and cell[1][0] >= cell[0][1]

    def at_face(self, cell: Cell) -> bool:
        """Tell whether a cell is at a face."""
        return any(cell[k][side] == self.whole[k][side] for k, side in self.faces())

    def sight(self, cell: Cell) -> "Sight":
        """See the target from a cell."""
        return Sight.over_wedge(self.target, place_in(self, cell))

    def off(self, sight: "Sight") -> Three:
        """Enclose σ - σ*."""
        seen = sight.scaled() if self.scaled else sight.centroid()
        low, high = (math.floor(end * ONE_OF_THEM) for end in self.goal)
        return [*seen[:2], seen[2] - Tangent.of((low + high) // 2, 0, 0, 0, high - low + 2)]

    def beyond(self, off: Three, distance: Fraction) -> bool:
        """Show |σ - σ*| > distance, along its direction in the middle."""
        largest = max(abs(x.mid) for x in off)
        along = [x.mid * 2**30 // largest for x in off] if largest else [0, 0, 0]
        part = add_up(x.times(a) for x, a in zip(off, along, strict=True))
        least = part.mid - part.far
        return least > 0 and least**2 > dot(along, along) * (distance * ONE_OF_THEM) ** 2

    def hold(self, cell: Cell, grid: Grid, domain: Any) -> bool:
        """Show that a cell is beyond the domain, or J in its bounds over it, and what is seen.

        The camera is no farther than its arm from a position in the domain, so there is none in a
        cell if all within the arm of that is beyond.
        """
        if self.left_out(cell):
            return True
        try:
            sight = self.sight(cell)
            if self.beyond(self.off(sight), domain.offset):
                around = self.arm and not self.held(cell, sight, grid, domain)
                return not around or self.all_beyond(self.widened(cell), domain.offset, 2)
            return self.held(cell, sight, grid, domain)
        except Rejected:
            return False

    def held(self, cell: Cell, sight: "Sight", grid: Grid, domain: Any) -> bool:
        """Show that J is in its bounds over a cell that is at no face, and what is seen from it."""
        if self.at_face(cell) or (domain.cone is not None and not self.steep(cell, domain.cone)):
            return False
        low, high = domain.bounds
        if self.scaled:
            return within_ball(sight.slope(), low, high)
        sides = zip(*self.corners(cell), strict=True)
        view = View(grid, grid.cell([(min(side), max(side)) for side in sides]))
        return largest_below(view, high) and smallest_above(view, low)

    def all_beyond(self, cell: Cell, distance: Fraction, halved: int) -> bool:
        """Show |σ - σ*| > distance over a cell, or over its eight parts, halved so often."""
        try:
            if self.beyond(self.off(self.sight(cell)), distance):
                return True
        except Rejected:
            pass
        middles = [(a + b) // 2 for a, b in cell]
        sides = [((a, m), (m, b)) for (a, b), m in zip(cell, middles, strict=True)]
        parts = (list(part) for part in itertools.product(*sides))
        return halved > 0 and all(self.all_beyond(part, distance, halved - 1) for part in parts)

    def widened(self, cell: Cell) -> Cell:
        """Return a cell that holds all positions within the arm of the camera from a cell.

        At p from a position lies ((x, y, 1)/u - p), and |u p| is at most u1 times the arm.
        """
        if not self.arm:
            return cell
        (u0, u1), unit = cell[2], self.unit
        moved = self.arm * u1 / unit
        require(moved < 1, "a cell is nearer to the target than the camera to the centre of mass")
        found = []
        for a, b in cell[:2]:
            low, high = a - moved * unit, b + moved * unit
            low /= 1 - moved if low < 0 else 1 + moved
            high /= 1 - moved if high > 0 else 1 + moved
            found.append((math.floor(low), math.ceil(high)))
        least, most = u0 / (1 + self.arm * u0 / unit), u1 / (1 - moved)
        return [*found, (math.floor(least), math.ceil(most))]

    def corners(self, cell: Cell) -> list[list[Fraction]]:
        """Return the positions of the corners; a cell is their convex hull."""
        unit = Fraction(1, self.unit)
        return [
            minus(self.mean, (Fraction(x, u), Fraction(y, u), 1 / (u * unit)))
            for x, y, u in itertools.product(*cell)
        ]

    def steep(self, cell: Cell, cosine: Fraction) -> bool:
        """Show that all target points are in a cone about the vertical.

        The ray to a point that is a from the mean has the direction of (x, y, 1) + u a, so it is so
        over the cell if it is at the corners, the cone being convex.
        """
        (x0, x1), (y0, y1), heights = cell
        p, q = cosine.numerator**2, cosine.denominator**2
        for u, (a, b, c) in itertools.product(heights, self.apart):
            x = max(abs(end * self.length + u * a) for end in (x0, x1))
            y = max(abs(end * self.length + u * b) for end in (y0, y1))
            z = self.unit * self.length + u * c
            if z <= 0 or (q - p) * z**2 < p * (x**2 + y**2):
                return False
        return True

    def holds(self, box: Sequence[Interval]) -> bool:
        """Tell whether a box of positions is in the wedge, or in its mirror images."""
        (u0, u1), mean = self.sides[2], self.mean
        for corner in itertools.product(*box):
            *level, height = minus(mean, corner)
            if height <= 0 or not u0 * height <= 1 <= u1 * height:
                return False
            for k, x in enumerate(level):
                a, b = self.sides[k]
                a = -b if self.halved(k) else a
                if not a * height <= x <= b * height:
                    return False
        return True

    def start(self, grid: Grid, cell: Cell) -> tuple[Fraction, Fraction] | None:
        """Bound |σ - σ*| and its horizontal part over a box of positions."""
        try:
            off = self.off(Sight.over(self.target, place_in(grid, cell)))
        except Rejected:
            return None
        far = [Fraction(abs(x.mid) + x.far, ONE_OF_THEM) ** 2 for x in off]
        whole, level = (square_root(sum(part, Fraction(0)))[1] for part in (far, far[:2]))
        return whole, level

    def words(self) -> str:
        """Describe the wedge."""
        (u0, u1), level = self.sides[2], []
        for k in range(2):
            a, b = self.sides[k]
            level.append(f"[{about(-b if self.halved(k) else a)}, {about(b)}]")
        return (
            f"between {about(1 / u1)} m and {about(1 / u0)} m above the mean of the target points, "
            f"which lies in {' x '.join(level)} times that height from it"
        )


NONE = Object(
    **dict.fromkeys(("thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate"), Fraction(0)),
    noise=Object(**dict.fromkeys(NOISE, Fraction(0))),
)


SAWTOOTH = Fraction(4053, 10000)  # above 4/π²
HOLD = {"lift": positive}


class Tolerant(Claim):
    """A claim about every vehicle within tolerances."""

    w1: ClassVar[Fraction] = Fraction(1)  # 0 if there is a potential in place of |δ1|²
    low: Fraction  # the ball of J, 1/m
    high: Fraction  # bounds |J|, 1/m
    hold: Any = None  # weights of the memory of what is held
    fastest: Callable[[], Fraction]  # bounds |δ1 + δ2|
    seen: Callable[[], Fraction]  # bounds |s|

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        (k1, k2, k3, k4), m = self.k, self.m
        self.k12, self.kappa, self.damping = k1 * k2 / m, (k1 * k2 + k3) / m, k4 / m
        require(self.vertical(), "the goal is not axial")
        require(c.goal_position in (None, c.hover), "the hover point is not the goal")
        wanted = scaled(self.centroid, self.whole) if self.scaled else self.centroid
        self.goal = wanted[2]  # holds s3*
        self.inertial = self.law[1] == "inertial"
        self.may = may = getattr(c.mission, "uncertainty", NONE)
        self.late_axes = hasattr(may, "gyro_turned") and may.latency > 0
        self.period, self.slow = (
            getattr(may, name, Fraction(0)) for name in ("control_period", "force_lag")
        )
        self.late, self.behind = may.latency + self.period, self.period + self.slow
        held = self.behind == 0 or (may.rotor_lag > 0 and not self.late_axes)
        require(held, "what is held is shown for rotors that lag, and images turned to now")
        kept = {"lift": self.behind, "level": self.period, "command": self.period}
        have = {name for name, time in kept.items() if time} == set(vars(self.hold or Object()))
        require(have, "weights of what is held belong to it")
        self.disturb(may.noise, getattr(may, "gust", Fraction(0)))
        exact = self.law[2] == "measured" or not (may.thrust or may.rotor_lag or may.wind)
        require(exact, "a modelled force knows nothing of thrust, rotor lag and wind")
        require((c.lag is not None) == (may.rotor_lag > 0), "weights of the lag belong to a lag")
        require((c.memory is not None) == (self.late > 0), "a memory belongs to a latency")
        known = not (may.torque or may.rotor_lag or may.noise.rate)
        aside = hasattr(c.mission.vehicle, "products")
        require(known or not aside, "other torques are covered for principal moments alone")
        i1, i2, i3 = c.mission.vehicle.inertia
        self.gyroscopic = max(abs(i3 - i2) / i1, abs(i3 - i1) / i2)  # bounds |Gc|
        self.bound()
        late, lagged, hold = self.late > 0, may.rotor_lag > 0, self.period > 0
        noisy, struck, blown = (self.shaken[name] > 0 for name in ("noise", "command", "gust"))
        held = [*[(True, True)] * 3, (True, False), (True, True)]
        held += [(late, late), (noisy, noisy), (struck, False), (blown, blown)]
        held += [(hold, self.behind > 0), (hold, False), (lagged, lagged)]
        self.size = sum(map(sum, held))
        count = itertools.count()
        *self.errors, self.Y, self.N, self.B, self.C, self.G, self.E, self.H, lag = (
            Vector(Form({(next(count),): Fraction(1)} if there else {}) for there in (x, False, z))
            for x, z in held
        )
        self.lag, self.lift = flat(lag), upright(lag)  # μ and μT
        self.A = Vector(self.N + self.B + self.E)  # what is used less what is now
        terms = len(self.terms(Fraction(0), Fraction(0)))
        require(len(c.multipliers.terms) == terms, "a multiplier a term")

    def disturb(self, noise: Object, gust: Fraction) -> None:
        """Bound b, of the image error; the error of the force; that of Ω; and a gust, over k1/m."""
        tipped, self.spun = getattr(noise, "vertical", Fraction(0)), noise.rate
        measured = self.law[2] == "measured"
        self.felt = noise.force + self.m * gust if measured else Fraction(0)  # of m a
        self.shock = (self.felt + self.weight * tipped) / self.stiffness  # |φ|
        self.jolt = self.m / self.k[0] * gust
        self.noise = noise.feature + self.m / self.k[0] * noise.velocity + self.shock
        self.noise += self.period * self.jolt
        self.displaced = self.arm * (self.high - self.low) if self.arm else Fraction(0)
        self.noise += self.displaced
        s3 = self.c.enclosures.goal[1]
        if self.inertial:
            self.noise += s3 * tipped
            if self.late_axes:
                turned = self.may.latency * self.may.yaw_rate * s3 * self.may.wind
                self.noise += turned / self.gravity

    def bound(self) -> None:
        """Bound what the set {Ψ <= ℓ} holds."""
        c, (w2, w3, w4), may = self.c, self.c.weights, self.may
        double, (low, high) = 2 * c.claim.level, c.enclosures.goal
        self.spread = upward(square_root(double * (1 / w2 + 1 / w3))[1])  # bounds |δ3 - δ2|
        self.sink = upward(square_root(double / w3)[1])  # |δ3|
        self.turn = upward(square_root(double * (1 / w3 + 1 / w4))[1])  # |ζ|
        speed = self.k[0] / self.m * self.fastest()  # |V|
        self.force, self.push = self.stiffness * self.spread, self.m * may.wind  # |F|, |w|
        least = self.weight - self.force
        require(least > self.push, "the force is not shown to be below the weight")
        pull = [Fraction(0)] * 2 if self.inertial else [self.stiffness * x for x in (low, high)]
        lever = square_root(least**2 - self.push**2)[0] - pull[1]
        require(lever > 0, "the thrust reaches the singularity T = c s3*")
        longest, gain = self.weight + self.force - pull[0], self.kappa * self.stiffness
        self.quick = upward(gain / lever)  # bounds h, 1/s
        # the ends of s3 h, χ - 1 and π
        self.drag = pull[0] / self.stiffness * gain / longest, pull[1] / self.stiffness * self.quick
        self.tipped = upward(self.push / lever)
        self.reach = self.seen()  # bounds |s|
        self.sweep = upward(self.quick * self.reach)  # |Ω×s| <= sweep |ζ| + Ω3' |Ps|
        if not self.late_axes:
            self.noise += upward(self.late * self.spun * self.reach)
        # what is left, of a wind that turns past the vehicle, by an accelerometer that lags
        self.cross = upward(self.quick * self.turn * self.tipped)  # |p3|
        swayed = (self.quick * self.turn + may.yaw_rate) * self.push / self.stiffness
        self.shock += upward(self.slow * swayed)
        self.noise += upward(self.slow * swayed)
        past = self.high * speed
        if self.late_axes:
            past += self.sweep * self.turn + may.yaw_rate * self.reach
        lift = (1 + may.thrust) * self.kappa
        require(self.slow * lift < 1, "the accelerometer is too slow")
        known = self.late * past + self.noise  # |n + B| but for what is held
        self.missed = upward((known + self.slow * lift * self.sink) / (1 - self.slow * lift))
        self.sinking = upward(self.quick * (self.sink + self.missed))  # |p1 - p2|, |Ua/Dc|
        lifted = self.behind * lift * (self.sink + self.missed)
        self.held_back = self.stiffness * lifted + self.behind * self.quick * self.turn * self.push
        moved = self.k12 * self.spread + self.quick * self.sink * self.turn
        self.sunk = upward(known + self.period * moved + lifted)  # |(n + B)z|
        self.pace = 2 * self.sinking + self.cross
        self.mislead(lever, longest / gain)
        self.sine = (self.force + self.push) / self.weight  # bounds sin φ
        self.cosine = square_root(1 - self.sine**2)[0]  # below cos φ
        self.lean = upward(square_root(2 / (1 + self.cosine))[1])  # t

    def mislead(self, lever: Fraction, slow: Fraction) -> None:
        """Bound ι, πm - π, and what errors of force and of Ω are in the command without others."""
        felt = self.felt + self.held_back
        require(lever > felt, "the error of the force is not shown to be below the lever")
        self.stray = upward(felt / (lever - felt))  # |ι|
        turned = self.quick * self.turn * self.felt + self.spun * (self.push + self.felt)
        turned += 2 * self.quick * self.turn * self.push if self.behind else 0
        wrong = self.stray * self.pace + (1 + self.stray) * turned / lever
        self.wobble = upward(wrong + self.spun * self.gyroscopic)  # with that of Ω3 Gc
        stiff, yaw = self.kappa + self.damping, self.may.yaw_rate
        self.twist = upward(self.stray * (stiff + yaw) + (1 + self.stray) * self.spun)
        turning = stiff + self.pace + wrong + (yaw + self.spun) * self.gyroscopic
        struck = (1 + self.stray) * self.k12 * self.shock + turning * self.spun * slow
        self.struck = upward(struck) if struck else Fraction(0)
        self.turning = upward(turning)
        gain = Fraction(1) if self.c.lag else 1 + self.may.torque
        self.shaken = {"noise": self.noise, "command": gain * self.struck, "gust": self.jolt}

    def vertices(self) -> Any:
        """Return the corners of χ, s3 h, ς, τ and π."""
        may, one = self.may, Fraction(1)
        moved = may.thrust or may.torque or may.rotor_lag
        ends = (
            (one - self.tipped, one + self.tipped),
            self.drag,
            (one - may.thrust, one + may.thrust),
            (Fraction(0), may.rotor_lag),
            (-self.pace, self.pace) if moved else (Fraction(0),),
        )
        return itertools.product(*(sorted(set(each)) for each in ends))

    def nominal(
        self, chi: Fraction, drag: Fraction, gain: Fraction, tau: Fraction, pi: Fraction
    ) -> Form:
        """Return E' without what is bounded by its norm."""
        (w2, w3, w4), kappa, stiff = self.c.weights, self.kappa, self.kappa + self.damping
        (D1, D2, D3, D4), Y, N = self.errors, self.Y, self.A
        zeta, pull = D4 - flat(D3), self.k12 * (D3 - D2)
        dragged, flow = drag * zeta, Y + self.G
        lift = kappa * upright(D3) + self.lift if self.c.lag else kappa * upright(D3 - N)
        d1, d2 = dragged - Y, flow + pull - dragged
        d3 = flow + pull + (kappa * chi) * zeta - gain * lift
        turning = kappa * chi + (gain - 1) * pi / 2 + pi
        d4 = flat(flow + pull) + turning * zeta + self.command(pi)
        d4 = d4 if self.c.lag else d4 + self.C
        total: Form = self.w1 * (D1 @ d1) + w2 * (D2 @ d2) + w3 * (D3 @ d3) + w4 * (D4 @ d4)
        if self.c.lag:
            steady = stiff * flat(N) - pi * zeta - self.lag + self.C + self.H
            late = steady + tau * (stiff * d4 + self.k12 * ((kappa * chi) * zeta + dragged))
            sinks = Fraction(-1) * (kappa * upright(N) + self.lift + (tau * kappa) * upright(d3))
            total += self.c.lag.torque * (self.lag @ late) + self.c.lag.thrust * (self.lift @ sinks)
        return total

    def command(self, pi: Fraction) -> Vector:
        """Return σ, the angular acceleration but for what the yaw rate adds, over h."""
        _, D2, D3, D4 = self.errors
        sigma = (-self.kappa - self.damping) * D4 - self.k12 * flat(D3 - D2)
        if self.c.lag:
            return Vector(sigma + self.lag)
        return Vector(sigma + (self.kappa + self.damping) * flat(self.A) - pi * (D4 - flat(D3)))

    def terms(self, tau: Fraction, pi: Fraction) -> list[tuple[Vector, Vector, Fraction]]:
        """Return u, v and R of each uᵀHv in E', |H| <= R, where R is not zero."""
        _, D2, D3, D4 = self.errors
        may, yaw, zeta = self.may, self.may.yaw_rate, D4 - flat(D3)
        u, missed, sigma = self.c.weights[2] * D4, flat(D3 - self.A), self.command(pi)
        turned = self.quick * self.sunk + may.thrust * self.cross / 2
        pulled, strayed, gain = flat(D3 - D2), self.stray * self.k12, 1 + may.torque
        if self.c.lag is None:
            each = [
                (u, sigma, may.torque),
                (u, zeta, turned + yaw * may.torque + gain * self.wobble),
                (u, flat(self.A), yaw if self.late or self.noise else Fraction(0)),
                (u, missed, may.torque * yaw + gain * self.twist),
                (u, pulled, gain * strayed),
            ]
        else:
            lag, late = self.c.lag.torque * self.lag, may.rotor_lag
            ahead = (tau * (self.kappa + self.damping)) * lag
            turned += (1 + may.thrust) * 2 * self.sinking
            turned += yaw * (gain * self.gyroscopic + may.torque)
            moving = (1 + may.thrust) * self.sinking + self.cross  # bounds |η|
            apart = yaw * self.gyroscopic + late * self.k12 * self.quick * self.spread
            each = [
                (u + ahead, sigma, may.torque),
                (u + ahead, zeta, turned),
                (self.c.weights[2] * zeta + ahead, flat(D3), yaw),
                (lag, zeta, apart + self.wobble),
                (lag, missed, yaw + self.twist),
                (lag, pulled, late * self.k12 * yaw + strayed),
                (self.c.lag.thrust * self.lift, zeta, late * self.kappa * self.quick * self.sink),
                (lag, sigma, late * moving),
            ]
        if self.late_axes:
            twice, aside = 2 * self.c.memory * self.late, self.level_part()
            each += [
                (twice * self.Y, zeta, self.sweep),
                (twice * flat(self.Y), aside, yaw),
                (twice * zeta, aside, self.sweep * yaw),
            ]
        return [(u, v, upward(radius)) for u, v, radius in each if radius]

    def level_part(self) -> Vector:
        """Return Ps, but for what steady wind adds: P δ1, or P δ1 + s3* Pρ."""
        D1, D2, D3, _ = self.errors
        if self.w1 and not self.inertial:
            return flat(D1)
        lean = self.c.enclosures.goal[1] * self.stiffness / self.weight
        return flat(D1 + lean * (D3 - D2))

    def least_fall(self, fading: Fraction, *corner: Fraction) -> Form:
        """Return the lower bound of -Ψ' at a corner, without what is known of J."""
        *_, tau, pi = corner
        c, latency = self.c, self.late
        form: Form = Form() - self.nominal(*corner)
        if c.memory:
            form += (c.memory * fading / latency) * (self.N @ self.N)
            form -= (c.memory * latency) * (self.Y @ self.Y)
            if self.late_axes:
                zeta, aside = self.errors[3] - flat(self.errors[2]), self.level_part()
                form -= (c.memory * latency * self.sweep**2) * (zeta @ zeta)
                form -= (c.memory * latency * self.may.yaw_rate**2) * (aside @ aside)
        for t, (u, v, radius) in zip(c.multipliers.terms, self.terms(tau, pi), strict=True):
            form -= (radius / 2) * (t * (v @ v) + (1 / t) * (u @ u))
        for part, (held, moves, kept) in self.changes().items() if self.hold else ():
            weight, moves = getattr(self.hold, part), [(v, upward(r)) for v, r in moves if r]
            form += weight * (held @ held)
            whole = sum(radius for _, radius in moves)
            for v, radius in moves:
                form -= (weight * kept * whole * radius) * (v @ v)
        return form

    def changes(self) -> dict[str, Any]:
        """Return the parts of E and H: each v and R, and what Σ R Σ R|v|² is multiplied by."""
        _, D2, D3, D4 = self.errors
        zeta, pulled, yaw, own = D4 - flat(D3), D3 - D2, self.may.yaw_rate, 1 + self.may.torque
        spun, leaned = self.quick * self.sink, self.kappa * (1 + self.tipped)
        stiff, k12 = self.kappa + self.damping, (1 + self.stray) * self.k12
        drift = (1 + self.may.thrust) * self.sinking + self.cross  # bounds |Dc'/Dc|
        require(self.period * drift < 1, "the control period is too long")
        turned = self.turning / (1 - self.period * drift)
        by_zeta = k12 * (leaned + self.drag[1] + self.quick * self.spread)
        by_zeta += turned * yaw * (own * self.gyroscopic + self.may.torque)
        lifted = upright(D3) + (1 / self.kappa) * self.lift, (1 + self.may.thrust) * self.kappa
        level = [(flat(pulled), self.k12), (zeta, leaned + spun), (flat(D3), yaw)]
        early, fades = (self.c.claim.rate * x for x in (self.period, self.slow))
        require(max(early, fades) < 1, "the rate is too fast for what is held")
        step = SAWTOOTH * self.period**2 / (1 - early)
        kept = self.behind * (self.period + self.slow / (1 - fades)) / (1 - early)
        sinks = [(upright(pulled), self.k12), (zeta, spun)] if self.period else []
        asked = (1 / stiff) * self.command(Fraction(0)), turned * own * stiff
        command = [(flat(pulled), k12 * yaw), (zeta, by_zeta), asked]
        each = {
            "lift": (upright(self.E), [*sinks, lifted], kept),
            "level": (flat(self.E), level, step),
            "command": (self.H, command, step),
        }
        return {name: each[name] for name in vars(self.hold)}

    def at_start(self, start: Object, offset: Fraction, level: Fraction) -> Fraction:
        """Bound Ψ, without a potential, at a start by |σ - s*| and its horizontal part.

        The rotors are steady: Ua = 0 and b = 0, hence μ = -σn and μT = -κ δ3z.
        """
        (w2, w3, w4), may, stiff = self.c.weights, self.may, self.kappa + self.damping
        f0 = start.thrust + self.weight * start.tilt
        lean = self.lean * (f0 + self.push) / self.weight  # f0 <= f, as |δ3| shows
        s3 = Fraction(0) if self.inertial else self.c.enclosures.goal[1]
        d1 = offset + s3 * lean
        flat1 = min(d1, level + lean * (offset + s3))  # |Pδ1|, body axes
        moved, pushed = self.m / self.k[0] * start.speed, f0 / self.stiffness
        lever = self.weight + f0
        if not self.inertial:
            lever -= self.stiffness * self.c.enclosures.goal[0]
        d2 = d1 + moved
        d3 = d2 + pushed
        d4 = flat1 + moved + pushed + lever * start.rate / (self.stiffness * self.kappa)
        total = self.w1 * d1**2 + w2 * d2**2 + w3 * d3**2 + w4 * d4**2
        if self.c.lag:
            asked = stiff * d4 + self.k12 * pushed
            rotors = self.c.lag.torque * asked**2 + self.c.lag.thrust * (self.kappa * d3) ** 2
            total += may.rotor_lag * rotors
        if self.c.memory:
            flow = self.high * start.speed
            if self.late_axes:
                s3 = self.c.enclosures.goal[1]
                flow += self.reach * start.rate + may.yaw_rate * (level + lean * (offset + s3))
            total += self.c.memory * (self.late * flow) ** 2
        return Fraction(total / 2)

    def left_out(self) -> str:
        """Say nothing: all that the mission asks to be covered is."""
        return ""

    def vehicles(self) -> str:
        """Say which vehicles, winds and cameras are covered."""
        may = self.may
        gust, law = getattr(may, "gust", None), "force is as modelled"
        ends = f"by {about(1 - may.thrust)} to {about(1 + may.thrust)} times what is commanded"
        if self.law[2] == "measured":
            law = "measured force is exact"
            if may.noise.force:
                law = f"accelerometer is wrong by at most {about(may.noise.force)} N over m"
        turned = "turned to now by the body rates"
        if self.late_axes:
            turned = "used in the axes that the camera had then, not turned to now"
        torque = (
            "e3×Ω' = (I + γ) a + Ω3 G e3×Ω but for lag, a the angular acceleration commanded, with "
            f"any 2 x 2 matrices γ and G, which may change, of norm at most {about(may.torque)}"
        )
        lag = (
            "rotors that follow the commanded change of thrust and the commanded torque with a "
            f"first-order lag of one constant time of at most {about(may.rotor_lag)} s"
        )
        late = (
            f"an image at most {about(may.latency)} s old when it is used, the frame period "
            f"included, in any way that changes, and {turned}"
        )
        runs = (
            f"a controller that runs at least every {about(self.period)} s and in between holds "
            "the torque and the rate at which the thrust commanded changes"
        )
        slow = (
            "an accelerometer with a first-order low-pass of one constant time of at most "
            f"{about(self.slow)} s, settled at the start"
        )
        wind = f"a steady wind from anywhere whose force over mass is <= {about(may.wind)} m/s²"
        yaw = f"|Ω3| <= {about(may.yaw_rate)} rad/s" if may.yaw_rate else "Ω3 = 0"
        if not (may.torque or may.latency or may.rotor_lag or self.noise or self.spun):
            yaw = "any Ω3"  # nothing but these depends on it
        each = [
            torque if may.torque else "e3×Ω' as commanded",
            lag if may.rotor_lag else "no rotor lag",
            late if may.latency else "no latency",
            *([runs] if self.period else []),
            *([slow] if self.slow else []),
            wind if may.wind else "no wind",
        ]
        if gust:
            most = f"<= {about(gust)} m/s²"
            each.append(f"gusts besides that change at will, whose force over mass is {most}")
        return (
            f"a true thrust over mass that changes {ends if may.thrust else 'just as commanded'}, "
            f"{', '.join(each)} and {yaw} on the way, where {self.known()} and the {law}"
        )

    def known(self) -> str:
        """Say how well the feature, V, Ω and the vertical are known."""
        noise = self.may.noise
        seen = f"the feature of that image is wrong by at most {about(noise.feature)} and V by at "
        if self.displaced:
            seen = (
                f"the camera is {about(self.arm)} m from the centre of mass, so that the feature "
                "of that image, plus the constant that makes it right at the hover, is wrong by at "
                f"most {about(self.displaced)}, and by {about(noise.feature)} besides, and V by "
                "at "
            )
        tipped = getattr(noise, "vertical", Fraction(0))
        each = [
            (
                self.displaced + noise.feature + noise.velocity,
                "V",
                f"{seen}most {about(noise.velocity)} m/s",
            ),
            (noise.rate, "Ω", f"Ω by at most {about(noise.rate)} rad/s"),
            (tipped, "the vertical", f"ρ by at most {about(tipped)}"),
        ]
        *others, last = right = [name for size, name, _ in each if not size] or [""]
        known = f"{', '.join(others)} and {last} are" if others else last
        wrong = ", ".join(words for size, _, words in each if size)
        wrong += ", in any way that changes" if wrong else ""
        return ", ".join(filter(None, (wrong, f"{known} known exactly" if any(right) else "")))

    def state(self, start: Object, place: str = "") -> str:
        """Describe a set of states, by another description of its positions if there is one."""
        f0 = start.thrust + self.weight * start.tilt
        sides = ", ".join(about(a, b) for a, b in start.position)
        before = f"in the {about(self.may.latency)} s before too, " if self.may.latency else ""
        held = f"upright state (T > 0) with {place or f'position in ({sides}) m'}, any heading, "
        if start.speed:
            held += f"|V| <= {about(start.speed)} m/s"
            held += f" {before}" if before else ", "
        else:
            held += "at rest, "
            held += f"for {about(self.may.latency)} s already, " if self.may.latency else ""
        held += f"an acceleration of at most {about(f0 / self.m)} m/s²" if f0 else "no acceleration"
        held += (
            f" and √(Ω1² + Ω2²) <= {about(start.rate)} rad/s" if start.rate else " and Ω1 = Ω2 = 0"
        )
        if self.late_axes:
            yaw = f" and |Ω3| <= {about(self.may.yaw_rate)} rad/s" if self.may.yaw_rate else ""
            held += f", these bounds of acceleration and rates{yaw} {before.removesuffix(', ')}"
        if self.may.rotor_lag:
            held += ", with the rotors steady: thrust that does not change, no torque"
        return held


def thrusts(value: Any) -> list[list[Fraction]]:
    """Read an interval that holds the thrust of every rotor, or one of each."""
    nested = isinstance(value, list) and all(isinstance(entry, list) for entry in value)
    return [*several(interval, MAX_ROTORS)(value if nested else [value])]


TERMS = several(positive, 11)
CLAIM = {
    **dict.fromkeys(("level", "rate", "start_level"), positive),
    "starts": several(START, MAX_STARTS),
    "settling": dict.fromkeys(("offset", "radius", "time"), positive),  # 1, m, s
    "cone": maybe(share),
    "rotors": thrusts,  # N
}


class Exponential(Tolerant):
    """Every vehicle within tolerances converges at a rate, from some states."""

    anywhere: ClassVar[bool] = True
    own: ClassVar[dict[str, Any]] = {
        "weights": [positive] * 3,  # w2, w3, w4
        "lag": maybe({"torque": positive, "thrust": positive}),  # a5, a6
        "memory": maybe(positive),  # M
        "hold": maybe((HOLD, HOLD | dict.fromkeys(("level", "command"), positive))),
        "multipliers": also(
            {"slope": positive, "terms": TERMS},
            **dict.fromkeys(("noise", "command", "gust"), positive),
        ),
        "domain": {
            **{"wedge": BOX, "bounds": [positive] * 2, "offset": positive},
            **{"cone": maybe(share), "tree": TREE},  # the cosine of an angle
        },
        "enclosures": {"goal": interval},  # of s3*
        "hover": VECTOR,  # near the hover at the goal, m
        "claim": (CLAIM, CLAIM | {"ultimate": dict.fromkeys(("offset", "radius"), positive)}),
        "near": {"bounds": [positive] * 2, "tree": TREE},  # of J, about the hover
    }

    def __init__(self, c: Any) -> None:
        (self.low, self.high), self.hold = c.domain.bounds, c.hold
        super().__init__(c)
        require(self.low < self.high, "the bounds of J are not in order")
        self.grid = Grid(self.target)
        self.place = Wedges(c, self.target, self.scaled, self.arm)
        require(c.claim.starts, "there is no start")
        require(c.claim.start_level <= c.claim.level, "a start is above the level")
        restless = any(self.shaken.values())
        have = hasattr(c.claim, "ultimate") == restless
        have &= all(hasattr(c.multipliers, name) == (x > 0) for name, x in self.shaken.items())
        require(have, "noise is to have its multipliers and bound")
        require_little(self.points, (c.domain.tree, 40 if self.arm else 15), (c.near.tree, 15))
        angles = c.claim.cone is None or c.domain.cone is not None
        require(angles, "the angle under which all is seen needs a cone over the domain")

    def bound(self) -> None:
        """Bound what the set {Ψ <= ℓ} holds, and how far positions are."""
        super().bound()
        c, (w2, w3, _), may = self.c, self.c.weights, self.may
        high = c.enclosures.goal[1]
        self.aside = Fraction(0) if self.inertial else high * self.lean  # s3 t
        leaned = (self.aside * self.stiffness / self.weight) ** 2
        self.stretch = upward(1 + leaned * (1 / w2 + 1 / w3))
        self.shift = upward(self.aside * may.wind / self.gravity)

    def fastest(self) -> Fraction:
        """Bound |δ1 + δ2|."""
        return upward(square_root(2 * self.c.claim.level * (1 + 1 / self.c.weights[0]))[1])

    def seen(self) -> Fraction:
        """Bound |s|, by s3* and |δ1|."""
        return Fraction(self.c.enclosures.goal[1] + upward(square_root(2 * self.c.claim.level)[1]))

    def decrease(self, *corner: Fraction) -> Form:
        """Return the lower bound of -Ψ' - r Ψ at a corner."""
        *_, tau, _ = corner
        c, rate = self.c, self.c.claim.rate
        energy = squares([Fraction(1), *c.weights], self.errors)
        if c.lag:
            energy += tau * squares([c.lag.torque, c.lag.thrust], [self.lag, self.lift])
        j, reach = (self.low + self.high) / 2, (self.high - self.low) / 2
        V = (self.k[0] / self.m) * (self.errors[0] + self.errors[1])
        out, x = self.Y - j * V, rate * self.late
        fading = 1 - x + x**2 / 2 - x**3 / 6  # below exp(-x)
        form: Form = (
            self.least_fall(fading, *corner)
            - (rate / 2) * energy
            - c.multipliers.slope * (reach**2 * (V @ V) - out @ out)
        )
        for name, d in (("noise", self.B), ("command", self.C), ("gust", self.G)):
            if self.shaken[name]:
                form += getattr(c.multipliers, name) * (d @ d)
        return form

    def floor(self) -> Fraction:
        """Return ℓ∞ = Σ σ max|·|²/r over noise, command and gust."""
        each = ((getattr(self.c.multipliers, k), x) for k, x in self.shaken.items() if x)
        return Fraction(sum(sigma * x**2 for sigma, x in each) / self.c.claim.rate)

    def verify(self) -> None:
        """Verify that Ψ falls at the rate, where, how soon the vehicle is near, and from where."""
        require(within(self.goal, self.c.enclosures.goal), "the interval of s3* does not hold it")
        quiet = self.floor() < self.c.claim.level
        require(quiet, "the noise is not shown to stay within the level")
        for corner in self.vertices():
            shown = self.decrease(*corner).positive(self.size)
            require(shown, "Ψ is not shown to fall at the rate claimed")
        made, said = self.rotors(), self.c.claim.rotors
        said = said * len(made) if len(said) == 1 else said
        follows = len(said) == len(made) and all(map(within, made, said))
        require(follows, "the thrust of a rotor does not follow")
        self.verify_domain()
        self.verify_settling()
        for start in self.c.claim.starts:
            self.verify_start(start)

    def verify_domain(self) -> None:
        """Verify that no motion leaves the box, in which J is in its ball, and what is seen."""
        claim, domain, place = self.c.claim, self.c.domain, self.place
        far = self.shift + square_root(2 * claim.level * self.stretch)[1]
        require(far <= domain.offset, "the level is not shown to be within the domain")
        what = "the domain is not shown"
        cover(domain.tree, place.whole, lambda cell: place.hold(cell, self.grid, domain), what)
        if claim.cone is not None:
            cosine, sine = domain.cone, square_root(1 - domain.cone**2)[1]
            seen = claim.cone <= cosine * self.cosine - sine * self.sine
            require(seen, "the angle under which all is seen does not follow")
        if hasattr(self.camera, "half_angle"):
            roll, pitch, _ = getattr(self.camera, "rotation", [Fraction(0)] * 3)
            left = self.camera.half_angle - abs(roll) - abs(pitch)  # about the z axis of the body
            follows = claim.cone is not None and left > 0 and cosine_below(left, claim.cone)
            require(follows, "the points are not shown to be within the half angle of the camera")

    def rotors(self) -> list[Interval]:
        """Bound what each rotor makes, and is set to make, N."""
        c, (w2, w3, w4), may, vehicle = self.c, self.c.weights, self.may, self.c.mission.vehicle
        stiff, (i1, i2, i3) = self.kappa + self.damping, vehicle.inertia
        steady = 2 * c.claim.level * (stiff**2 / w4 + self.k12**2 * (1 / w2 + 1 / w3))
        asked = square_root(steady)[1] + stiff * self.missed + self.pace * self.turn
        asked += (may.yaw_rate + self.twist) * (self.sink + self.missed)
        asked += self.struck + self.wobble * self.turn + self.stray * self.k12 * self.spread
        own = (1 + may.torque) * self.gyroscopic + may.torque
        turned = self.quick * ((1 + may.torque) * asked + may.yaw_rate * own * self.turn)
        k_yaw = c.mission.gains.k_yaw
        plain = self.quick * asked
        yaw = k_yaw * (may.yaw_rate + self.spun)
        if self.heading:  # its gain is this one unless it is given
            yaw += getattr(c.mission.gains, "k_heading", min(k_yaw**2 / (4 * i3), k_yaw))
        about_it = yaw / i3
        yaw += abs(i2 - i1) * (self.quick * self.turn + self.spun) ** 2 / 2
        ahead = may.rotor_lag * (1 + may.thrust) * self.stiffness * self.kappa
        swing = self.force + self.push + ahead * (self.sink + self.missed)
        ends: list[Interval] = []
        products = getattr(vehicle, "products", None)
        for lift, roll, pitch, spin in rotor_shares(vehicle):
            if products is None:
                aside = square_root((roll * i1) ** 2 + (pitch * i2) ** 2)[1] * turned
                aside += abs(spin) * (1 + may.torque) * yaw
            else:  # Γ = I Ω' + Ω × (I - i) Ω, for any number i
                i12, i13, i23 = products
                rows = [i1, i12, i13], [i12, i2, i23], [i13, i23, i3]
                x, y, z = (dot(row, (roll, pitch, spin)) for row in rows)
                aside = square_root(x**2 + y**2)[1] * plain + abs(z) * about_it
                other = [(i - sum(vehicle.inertia) / 3) ** 2 for i in vehicle.inertia]
                uneven = sum(other) + 2 * dot(products, products)
                size = square_root(uneven * (roll**2 + pitch**2 + spin**2))[1]
                aside += size * ((self.quick * self.turn) ** 2 + may.yaw_rate**2)
            aside += abs(lift) * swing
            ends.append((lift * self.weight - aside, lift * self.weight + aside))
        return ends

    def verify_settling(self) -> None:
        """Verify that the vehicle is near the hover in time, where |σ - s*| is no longer large."""
        claim, soon, place = self.c.claim, self.c.claim.settling, self.place
        require(soon.offset > self.shift, "the wind moves the hover by more than the offset")
        level = (soon.offset - self.shift) ** 2 / (2 * self.stretch) - self.floor()
        require(level > 0, "the noise is not shown to leave the vehicle within the offset")
        fallen = exponential_above(claim.rate * soon.time, claim.start_level / level)
        require(fallen, "the settling time does not follow from the rate")

        (low, high), hover = self.c.near.bounds, [(x, x) for x in self.c.hover]
        off = place.start(self.grid, self.grid.cell(hover)) if place.holds(hover) else None
        away = off[0] if off else soon.offset + 1
        require(away <= soon.offset, "the hover point is off the goal")
        require(soon.offset <= self.c.domain.offset, "the vehicle settles beyond the domain")
        require(0 < low < high, "the bounds of J near the goal are not in order")
        box = self.grid.cell([(x - soon.radius, x + soon.radius) for x in self.c.hover])
        known, what = (self.target, self.scaled, self.grid), "J is not bounded near the goal"
        cover(self.c.near.tree, box, lambda cell: bounded(*known, cell, low, high), what)
        away /= self.low  # of the hover from the goal, m
        what = "the vehicle is not shown to be within the radius"
        require(soon.offset < low * (soon.radius - away), what)
        if self.floor():
            last = claim.ultimate
            least = self.shift + square_root(2 * self.floor() * self.stretch)[1]
            require(last.offset > least, "the noise may move the vehicle by more than the offset")
            near = last.offset <= soon.offset and last.offset <= low * (last.radius - away)
            require(near, what)

    def verify_start(self, start: Object) -> None:
        """Verify that Ψ <= ℓ0 in a set of states; the vehicle was near its positions before."""
        moved = start.speed * self.late
        box = [(a - moved, b + moved) for a, b in start.position]
        require(self.place.holds(box), "a start is not in the wedge of the domain")
        offsets = self.place.start(self.grid, self.grid.cell(box))
        inside = offsets and self.at_start(start, *offsets) <= self.c.claim.start_level
        require(inside, "a start is not shown to have Ψ <= its level")

    def words(self) -> str:
        """Say what is proved."""
        c, claim, soon = self.c, self.c.claim, self.c.claim.settling
        weights, hover = (", ".join(map(about, x)) for x in (c.weights, c.hover))
        more = ""
        if c.lag:
            lag = f"{about(c.lag.torque)} |μ|² + {about(c.lag.thrust)} μT²"
            more += f" + ½ τ ({lag}) of the lag τ"
        if c.memory:
            more += f" + {about(c.memory)} ∫∫ exp(r (z - t)) |y(z)|² dz dx of the latency, z from "
            more += "t + x to t, x from minus the latency to 0, y = J V"
            more += " + Ω×s, but for what the lean in the wind adds," if self.late_axes else ""
            more += " the flow of the feature"
        if self.hold:
            more += " + what is held, which is 0 at the start and never below"
        half = ""
        if claim.cone is not None:
            angle = f"{math.degrees(math.acos(claim.cone)):.4g}°"
            turned = any(getattr(self.camera, "rotation", ())[:2])
            axis = "z axis of the body" if turned else "optical axis"
            half = (
                f"; on the way every target point is seen at an angle of at most arccos "
                f"{about(claim.cone)}, {angle}, from the {axis}"
            )
        fall, last = "Ψ(t) <= Ψ(0) exp(-r t)", ""
        if self.floor():
            fall += f" + {float(self.floor()):.6g} (to 6 digits)"
            last = f", and in the end within {about(claim.ultimate.radius)} m"
        turning = f", while |Ω3| <= {about(self.may.yaw_rate)} rad/s"
        starts = "; or ".join(map(self.state, claim.starts))
        s3 = f"{float(sum(self.goal) / 2):.12g}"
        placed = "arm" if hasattr(c.mission.vehicle, "arm") else "rotors"
        who, make = "each rotor", "makes, and is set to make, a thrust"
        if len(claim.rotors) > 1:
            who, make = "the rotors, in their order,", "make, and are set to make, thrusts"
        return (
            f"For the mission {self.name} ({self.of_another_law()}m = {self.m} kg, g = "
            f"{self.gravity} m/s², {self.gains()}, goal straight below where its feature is (0, 0, "
            f"{s3}) to 12 digits), and for every vehicle with {self.vehicles()}, let Ψ = ½(|δ1|² + "
            f"w2|δ2|² + w3|δ3|² + w4|δ4|²){more}, (w2, w3, w4) = ({weights}). "
            f"{'With' if self.period else 'In continuous time and with'} all target points seen, "
            f"the controller may be switched on in every {starts}. Then Ψ(0) <= "
            f"{about(claim.start_level)} and {fall}, r = {about(claim.rate)} 1/s, for all t >= 0; "
            f"the vehicle stays {self.place.words()}; and after {about(soon.time)} s it is, and "
            f"stays, within {about(soon.radius)} m of the point ({hover}) m{last}{half}. "
            f"On the way {who} of a vehicle whose mass, "
            f"inertia, {placed} and drag ratio are the mission's {make} in "
            f"{', '.join(about(*ends) for ends in claim.rotors)} N{turning}."
        )


# With the centroid there is the natural potential W in place of ½|δ1|², of which W' = -eᵀV, and e
# in place of δ1 = e + η, as for regions of attraction; η = 0 for an inertial goal, and without wind
# it is as there for one of the image. With q3* and θ = (t, 0) at their ends, and 0 ⪯ Q ⪯ λ I, so
# yᵀ(λV - y) >= 0,
#
#   -(E - ½|δ1|²)' + eᵀV - Mτ'|y|² + (M/τ')|n|² - σQ yᵀ(λV - y) >= ε (k1/m) |Y|²
#
# on {Ψ <= ℓ}, where |V| <= (k1/m)(|δ1| + |δ2|), |δ1| <= n + q3*. What is along the second axis is
# in this as what is along the first if θ = 0. A barrier follows from how U is made, so it needs
# that the height is driven as modelled: no tolerance but those of torque and yaw rate.


class Potential(Tolerant, Attraction):
    """From some states every vehicle within tolerances converges to the hover at the goal."""

    own: ClassVar[dict[str, Any]] = Attraction.own | {
        "lag": maybe({"torque": positive, "thrust": positive}),  # a5, a6
        "memory": maybe(positive),  # M
        "enclosures": {"goal": interval, "tilt": number, "largest_eigenvalue": positive},
        "multipliers": {"slope": positive, "terms": TERMS},
    }
    laws: ClassVar[set[tuple[str, ...]]] = {
        ("centroid", goal, force)
        for goal in ("image", "inertial")
        for force in ("modelled", "measured")
    }

    w1: ClassVar[Fraction] = Fraction(0)

    def __init__(self, c: Any) -> None:
        self.high = c.enclosures.largest_eigenvalue
        super().__init__(c)
        shaken = self.behind or any(self.shaken.values())
        require(not shaken, "noise, and what is held, are not covered by this theorem")
        moved = self.may.wind > 0 and not self.inertial
        require(not moved, "wind moves the potential of a goal that is fixed in the image")
        tossed = self.may.thrust or self.may.latency or self.may.rotor_lag or self.may.wind
        require(self.bottom is None or not tossed, "a barrier needs the height driven as modelled")

    def fastest(self) -> Fraction:
        """Bound |δ1 + δ2|."""
        second = upward(square_root(2 * self.level / self.a[0])[1])
        return Fraction(self.whole + self.c.enclosures.goal[1] + second)

    def seen(self) -> Fraction:
        """Bound |q|."""
        return self.whole

    def verify_fall(self) -> None:
        """Verify that Ψ falls as claimed where Q ⪯ λ I."""
        for q3, corner in itertools.product(self.c.enclosures.goal, self.vertices()):
            shown = self.decrease(q3, *corner).positive(self.size)
            require(shown, "-Ψ' is not shown to be above (k1/m) rate·|Y|²")

    def decrease(self, q3: Fraction, *corner: Fraction) -> Form:
        """Return the lower bound of -Ψ' - (k1/m) ε|Y|² at a corner."""
        c, (e, D2, D3, _), pace = self.c, self.errors, self.k[0] / self.m
        lean = Fraction(0) if self.inertial else q3 * self.stiffness / self.weight
        x = lean * (D3 - D2)
        eta = Vector([x[0], x[1], -c.enclosures.tilt * x[0]])
        V, rate = pace * (e + eta + D2), squares([pace * c.claim.rate] * 4, self.errors)
        form: Form = (
            self.least_fall(Fraction(1), *corner)
            + (e @ V)
            - rate
            - c.multipliers.slope * (self.Y @ (self.high * V - self.Y))
        )
        return form

    def path(self, start: Object) -> Sequence[Interval]:
        """Return the positions of a start, and those of the latency before it."""
        moved = start.speed * self.may.latency
        return [(a - moved, b + moved) for a, b in start.position]

    def added(self, start: Object) -> Any:
        """Return the start itself."""
        return start

    def beside(self, add: Any, whole: int, level: int) -> Fraction:
        """Bound Ψ - W where |q - q*| and its horizontal part are bounded, in units of 1/ONE."""
        return self.at_start(add, Fraction(whole, ONE), Fraction(level, ONE))

    def words(self) -> str:
        """Say what is proved."""
        c, claim = self.c, self.c.claim
        side, up, down = map(about, vars(claim.reach).values())
        weights, hover = (", ".join(map(about, x)) for x in (self.a, c.hover))
        more = ""
        if c.lag:
            more = f" + ½ τ ({about(c.lag.torque)} |μ|² + {about(c.lag.thrust)} μT²) of the lag"
        if c.memory:
            more += f" + {about(c.memory)} ∫∫ |y|² of the latency"
            more += ", y = Q V + Ω×q the flow of the centroid" if self.late_axes else ""
        stays = ". This knows no ground: on its way the motion may pass below the target points"
        if self.bottom is not None:
            height = about(claim.barrier_height)
            stays = f"; it stays at least {height} m above the mean height of the target points"
        others = "".join(f", and in every {self.state(start)}" for start in claim.starts)
        rest = self.state(
            self.starts[0],
            f"a position up to {side} m sideways of the point "
            f"({hover}) m at its height, up to {up} m above it or {down} m below it",
        )
        return (
            f"For {self.asked()} and for every vehicle with {self.vehicles()}, let Ψ = W + "
            f"½(a2|δ2|² + a3|δ3|² + a4|δ4|²){more}, "
            f"W = Σ{self.times()}|P'i - ξ| + q3* z less its minimum, "
            f"(a2, a3, a4) = ({weights}). In continuous time and with all target points seen, the "
            f"controller may be switched on in every {rest}{others}: the motion converges to the "
            f"hover at the goal{stays}. On the way Ψ <= {about(self.level)} and Ψ' <= -(k1/m) "
            f"{about(claim.rate)} (|q - q3* ρ|² + |δ2|² + |δ3|² + |δ4|²)."
        )


# --- motions that sink to the target ------------------------------------------------------------
#
# Let q* = q3* e3 and Ω3 = 0. In world axes, with b = R e3, w = b', D = T - c q3*, c = k1² k2/m,
# κ = (k1 k2 + k3)/m, y = (m g/c) e3 + (m/k1) ξ' - Σ wi (P'i - ξ)/ri, the closed loop is
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
FINE = 192  # numbers are multiples of 2^-FINE


class Ball(NamedTuple):
    """The numbers within `rad` of `mid`, both whole multiples of 2^-FINE."""

    mid: int
    rad: int

    @classmethod
    def over(cls, low: Fraction, high: Fraction | None = None) -> "Ball":
        """Enclose an interval, or a number."""
        bottom = math.floor(low * (1 << FINE))
        top = math.ceil((low if high is None else high) * (1 << FINE))
        return cls((bottom + top) // 2, (top - bottom + 1) // 2)

    def __add__(self, other: "Ball") -> "Ball":  # type: ignore[override]
        return Ball(self.mid + other.mid, self.rad + other.rad)

    def __sub__(self, other: "Ball") -> "Ball":
        return Ball(self.mid - other.mid, self.rad + other.rad)

    def __mul__(self, other: "Ball") -> "Ball":  # type: ignore[override]
        rad = self.size() * other.rad + self.rad * other.size()
        return Ball(self.mid * other.mid >> FINE, (rad >> FINE) + 2)

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
        return Series(lambda i: self[i] + other[i])

    def __sub__(self, other: "Series") -> "Series":
        return Series(lambda i: self[i] - other[i])

    def __mul__(self, other: "Series") -> "Series":
        return self.inner([self], [other]) if isinstance(other, Series) else NotImplemented

    def __rmul__(self, c: Fraction) -> "Series":
        ball = Ball.over(c)
        return Series(lambda i: ball * self[i])

    @staticmethod
    def constant(low: Fraction, high: Fraction | None = None) -> "Series":
        """Return the series of a constant, or of all in an interval."""
        ball = Ball.over(low, high)
        return Series(lambda i: Ball(0, 0) if i else ball)

    @staticmethod
    def inner(x: Sequence["Series"], y: Sequence["Series"]) -> "Series":
        """Return the series of xᵀy."""

        def rule(i: int) -> Ball:
            mid = rad = 0
            for a, b in zip(x, y, strict=True):
                a[i], b[i]  # now they are there
                mid += dot(a.mid, b.mid[i::-1])
                rad += dot(a.size, b.rad[i::-1]) + dot(a.rad, b.size[i::-1])
            return Ball(mid >> FINE, (rad >> FINE) + 2)

        return Series(rule)


class Sinking(Axial):
    """A motion sinks, from above, to the height of the lowest target point."""

    own: ClassVar[dict[str, Any]] = {
        "motion": {
            **dict.fromkeys(("position", "velocity", "axis", "turning"), BOX),  # ξ, ξ', b, w
            **{"thrust": interval, "time": number, "steps": several(number, MAX_STEPS)},
        }
    }

    def __init__(self, c: Any) -> None:
        super().__init__(c)
        p, n = c.motion, len(self.points)
        require(not self.heading, "a vehicle that turns to a heading has a yaw rate")
        self.time, self.steps = p.time, p.steps
        self.start = [*p.position, *p.velocity, *p.axis, *p.turning, p.thrust]
        self.depth = max(point[2] for point in self.points)  # z of the lowest target point, m
        require(inhabited(p.axis, p.turning), "no state is shown to be in the start")
        soon = 0 < p.time <= MAX_TIME
        require(soon, f"the time is not above 0 s and at most {MAX_TIME} s")
        require(p.position[2][1] < self.depth, "the start is not above the lowest target point")
        require(len(p.steps) * (n + 3) <= MAX_STEPS, "there are too many steps")
        fill = min(p.steps, default=0) > 0 and sum(p.steps) == p.time
        require(fill, "the steps do not fill the time")

    def unknowns(self) -> list[Ball]:
        """Enclose ξ, ξ', b, w, T, 1/D and every 1/ri at the start."""
        low, high = minus(self.start[12], (self.stiffness * q3 for q3 in reversed(self.q3)))
        require(low > 0, "the thrust at the start is not above the singularity T = c q3*")
        boxes = [*self.start, (1 / high, 1 / low)]
        for point in self.points:
            sides = [(a - x, b - x) for (a, b), x in zip(self.start, point, strict=False)]
            near, far = squared_length(sides)
            require(near > 0, "the start is at a target point")
            boxes.append((1 / square_root(far)[1], 1 / square_root(near)[0]))
        return [Ball.over(*box) for box in boxes]

    def taylor(self, z: Sequence[Ball], step: Fraction, order: int) -> list[Series]:
        """Return the coefficients up to an order, times stepⁱ, of all motions from a box."""
        m, c, (k1, k2, k3, k4) = self.m, self.stiffness, self.k
        kappa, slowing, constant = (k1 * k2 + k3) / m, k4 / m, Series.constant
        reach = max(x.size() for x in z)
        require(reach < 10**12 << FINE, "the motion is not followed to its end")
        parts = [Ball.over(step / i) for i in range(1, order + 1)]
        slopes: list[Series] = []  # the right sides, of each unknown

        def unknown(k: int) -> Series:
            return Series(lambda i: parts[i - 1] * slopes[k][i - 1] if i else z[k])

        def vector(values: Iterable[Any]) -> Vector:
            return Vector(map(constant, values))

        series = [unknown(k) for k in range(len(z))]
        xi, v, b, w = (Vector(series[i : i + 3]) for i in (0, 3, 6, 9))
        T, x, u = series[12], series[13], series[14:]  # x = 1/D, u = 1/r
        rays = [vector(point) - xi for point in self.points]
        weighed = [w * x if w != 1 else x for w, x in zip(self.target.weights, u, strict=True)]
        seen = Vector(Series.inner(axis, weighed) for axis in zip(*rays, strict=True))
        y = vector((0, 0, self.weight / c)) + (m / k1) * v - seen
        a = vector((0, 0, self.weight / k1)) + (kappa + slowing) * y
        by = b @ y
        singular = constant(c * self.q3[0], c * self.q3[1])
        rise = kappa * (c * by - T + singular)  # T'
        gain, h = (c * kappa) * x, (rise + (c * kappa) * by) * x + constant(slowing)
        inward = gain * (b @ a) + w @ w
        slopes += v
        slopes += vector((0, 0, self.gravity)) - (1 / m) * (T * b)
        slopes += w
        slopes += gain * a - inward * b - h * w
        slopes += [rise, constant(Fraction(0)) - x * x * rise]
        slopes += [uj * uj * uj * (ray @ v) for uj, ray in zip(u, rays, strict=True)]
        for i, line in itertools.product(range(order + 1), series):
            line[i]
        return series

    def advance(self, z: Sequence[Ball], step: Fraction) -> list[Ball]:
        """Enclose where all motions from a box are after a step."""
        series, most = self.taylor(z, step, ORDER - 1), 1 << (FINE - ACCURACY)
        reach = [sum(line.size[1:]) + most for line in series]
        hull = [Ball(x.mid, x.rad + 2 * r + 1) for x, r in zip(z, reach, strict=True)]
        rest = [line[ORDER] for line in self.taylor(hull, step, ORDER)]
        require(max(x.size() for x in rest) <= most, "the motion is not followed to its end")
        ends = zip(series, rest, strict=True)
        return [Ball(sum(line.mid), sum(line.rad)) + x for line, x in ends]

    def verify(self) -> None:
        """Verify that the motion exists for the time, and where it ends."""
        z = self.unknowns()
        for step in self.steps:
            z = self.advance(z, step)
        sunk = z[2].mid - z[2].rad >= self.depth * (1 << FINE)
        require(sunk, "the motion is not shown to sink to the lowest target point")

    def words(self) -> str:
        """Say from where the vehicle sinks to the target."""
        sides = [about(a, b) for a, b in self.start]
        place, speed, axis, turning = (", ".join(sides[i : i + 3]) for i in (0, 3, 6, 9))
        depth, time = about(self.depth), about(self.time)
        return (
            f"It is not true that, for {self.asked()}, the vehicle stays above the lowest target "
            f"point, z < {depth} m, for {time} s from a state with position ({place}) m, velocity "
            f"({speed}) m/s and thrust {sides[12]} N whose body axis e3 is ({axis}) and turns at "
            f"({turning}) 1/s, all in world axes, with yaw rate zero. There is such a state. With "
            f"the exact model and controller in continuous time, all target points seen and any "
            f"heading, the motion from every such state, which is above that height, exists for "
            f"{time} s, T > c q3* on the way, and at their end the vehicle is at that height or "
            f"lower: z >= {depth} m. What comes after is not said."
        )


def squared_length(box: Sequence[Interval]) -> tuple[Fraction, Fraction]:
    """Return the least and the greatest |x|² of a box."""
    near = [max(a, -b, Fraction(0)) for a, b in box]
    far = [max(-a, b) for a, b in box]
    return dot(near, near), dot(far, far)


def inhabited(axis: Matrix, turning: Matrix) -> bool:
    """Show that intervals hold a unit vector b and a w across it, bᵀw = 0.

    |b|² takes every value between its least and its greatest in the box, so 1 too. If for each b
    of the box, bᵀw is nowhere above 0 for the w that make it least, nor below for the w that make
    it greatest, then it is 0 for some w.
    """
    least = greatest = Fraction(0)
    for (a, b), (u, v) in zip(axis, turning, strict=True):
        ends = [a, b, Fraction(0)] if a < 0 < b else [a, b]
        least += max(min(x * u, x * v) for x in ends)  # concave in x, with a corner at 0
        greatest += min(max(x * u, x * v) for x in ends)
    low, high = squared_length(axis)
    return low <= 1 <= high and least <= 0 <= greatest


# --- what a file is, and what is said of it -------------------------------------------------------

KINDS: dict[str, Any] = {
    **{"gains": Gains, "counterexample": Counterexample, "region": Eigenvalues, "outside": Outside},
    **{"attraction": Attraction, "exponential": Exponential, "potential": Potential},
    "sinking": Sinking,
}


def claim_of(certificate: Any) -> Any:
    """Read what is claimed, and of which mission."""
    hashed = certificate["mission_sha256"] == digest(certificate["mission"])
    require(hashed, "the mission is not the one that was hashed")
    kind = KINDS[certificate["kind"]]
    parts = ABOUT | kind.own
    return kind(parsed(parts, {key: certificate[key] for key in parts}))


def stated(claim: Any) -> str:
    """Say in words what is claimed, and of which mission."""
    target = claim.c.mission.target
    points = ", ".join(f"({', '.join(map(str, point))})" for point in target.points)
    weights = getattr(target, "weights", None)
    counted = f", which count {', '.join(map(str, weights))} times" if weights else ""
    return (
        f"{claim.words()}{claim.left_out()} The mission {claim.name} is the one whose numbers "
        f"have the SHA-256 {claim.c.mission_sha256}; its target points are {points} m, in world "
        f"axes, z down{counted}."
    )


def statement(certificate: Any) -> str:
    """Return the theorem that a certificate claims, in words.

    Parameters
    ----------
    certificate : mapping
        The JSON object.
    """
    return stated(claim_of(certificate))


def check(certificate: Any) -> str:
    """Return the theorem that a certificate (an object read from JSON) proves.

    Raises Rejected if it does not prove what it claims, Unreadable if it is of an older version.

    Parameters
    ----------
    certificate : mapping
        The JSON object.
    """
    try:
        require_whole(certificate)
        claim = claim_of(certificate)
        theorem = stated(claim)
        said = certificate["statement"] == theorem
        require(said, f"the statement is not what is proved: {theorem}")
        claim.verify()
    except (ArithmeticError, RecursionError) as error:  # numbers or nesting out of any reason
        raise Rejected(f"{type(error).__name__} while checking: {error}") from None
    return theorem


def require_whole(c: Any) -> None:
    """Require the format and its version, just the keys of the kind, and that nothing changed."""
    require(isinstance(c, dict), "the certificate is not an object")
    kind, version = c.get("kind"), c.get("version")
    ours = c.get("format") == "hoverproof certificate"
    require(isinstance(kind, str) and kind in KINDS, "unknown kind of certificate")
    if ours and version == 1:
        raise Unreadable("was made by an older version of hoverproof; make it anew")
    wanted = [*HEAD, *ABOUT, *KINDS[kind].own]
    require(set(c) == set(wanted), f"a certificate must have the keys {', '.join(wanted)}")
    known = ours and type(version) is int and version == VERSION
    require(known, f"not version {VERSION} of the format")
    parsed(HEAD, {key: c[key] for key in HEAD})
    rest = {key: part for key, part in c.items() if key != "sha256"}
    require(c["sha256"] == digest(rest), "the file was changed after it was written")


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
    (name,) = arguments
    try:
        theorem = check_file(name)
    except Unreadable as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
    except Rejected as error:
        print(f"{name}: rejected: {error}")
        return 1
    print(f"{name}: accepted")
    print(textwrap.fill(f"Proved: {theorem}", 80, initial_indent="  ", subsequent_indent="  "))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
