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
import itertools
import json
import math
import re
import sys
import textwrap
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

Row = Sequence[Fraction]
Matrix = list[list[Fraction]]
Gains = dict[str, Fraction]

MAX_BYTES = 1_000_000
MAX_WORK = 24_000  # boxes times points in a branch and bound
MAX_POINTS = 64


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
    centroid: list[tuple[Fraction, Fraction]]  # q*
    factor: tuple[Fraction, Fraction]  # holds every f(T), 1/m
    attained: tuple[Fraction, Fraction]  # every value in it is an f(T), 1/m


class Rejected(Exception):
    """The certificate does not prove what it claims."""


class Unreadable(Exception):
    """The file is not a certificate."""


# --- exact arithmetic ---------------------------------------------------------------------------


def positive_definite(matrix: Matrix) -> bool:
    """Tell by LDLᵀ in rational arithmetic whether a symmetric matrix is positive definite."""
    a = [list(row) for row in matrix]
    n = len(a)
    assert all(a[i][j] == a[j][i] for i in range(n) for j in range(n))
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


def within(inner: Sequence[Fraction], outer: Sequence[Fraction]) -> bool:
    """Tell whether the interval `inner` lies in `outer`."""
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


# --- the model ----------------------------------------------------------------------------------


def centroid_seen(points: Matrix, position: Row) -> list[tuple[Fraction, Fraction]]:
    """Enclose q = Σ (P - ξ)/|P - ξ|; points at equal distance are added before rounding."""
    sums: dict[Fraction, list[Fraction]] = {}
    for point in points:
        ray = [p - x for p, x in zip(point, position, strict=True)]
        square = sum((c * c for c in ray), Fraction(0))
        require(square > 0, "the goal coincides with a target point")
        old = sums.get(square, [Fraction(0)] * 3)
        sums[square] = [a + b for a, b in zip(old, ray, strict=True)]
    box = []
    for i in range(3):
        ends = [sorted(ray[i] / r for r in square_root(s)) for s, ray in sums.items()]
        low, high = (sum((e[k] for e in ends), Fraction(0)) for k in (0, 1))
        box.append((low, high))
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


def eigenvalues_hold(
    points: Matrix, box: Matrix, low: Fraction, high: Fraction, most: int | None = None
) -> bool:
    """Tell whether low I ≺ Q ≺ high I is shown for every position in a box, halving it at need.

    Lengths are whole numbers of a unit that divides every coordinate of the target; the box is
    rounded outward. So every matrix is one of integers.
    """
    unit = 2**20 * math.lcm(*(c.denominator for point in points for c in point))
    require(unit < 10**50, "the coordinates of the target are too long")
    require(all(abs(end) < 10**9 for side in box for end in side), "the box is too far away")
    rays = [[int(c * unit) for c in point] for point in points]
    boxes = [[(math.floor(a * unit), math.ceil(b * unit)) for a, b in box]]
    for _ in range(MAX_WORK // len(points) if most is None else most):
        if not boxes:
            return True
        sides = boxes.pop()
        if not eigenvalues_hold_near(rays, sides, low / unit, high / unit):
            center = [((a + b) // 2,) * 2 for a, b in sides]
            if not eigenvalues_hold_near(rays, center, low / unit, high / unit):
                return False  # not even there
            longest = max(range(3), key=lambda i: sides[i][1] - sides[i][0])
            middle = center[longest][0]
            for half in ((sides[longest][0], middle), (middle, sides[longest][1])):
                boxes.append([half if i == longest else side for i, side in enumerate(sides)])
    return False


def eigenvalues_hold_near(
    points: Sequence[Sequence[int]],
    box: Sequence[tuple[int, int]],
    low: Fraction,
    high: Fraction,
) -> bool:
    """Show it for a whole box at once, without halving, in integers; see the top of this file."""
    center = [(a + b) // 2 for a, b in box]
    square = sum((b - c) ** 2 for (_, b), c in zip(box, center, strict=True))  # ρ², b - c >= c - a
    radius = math.isqrt(square) + 1
    rays = [[p - c for p, c in zip(point, center, strict=True)] for point in points]
    near = [math.isqrt(sum(x * x for x in ray)) for ray in rays]  # near <= di <= near + 1
    if min(near) <= radius:
        return False
    scale = 1 << (64 + 3 * max(near).bit_length())  # weights and bounds are multiples of 1/scale
    top = math.floor(scale * high)
    if sum(scale // (d - radius) + 1 for d in near) >= top:  # else Q ⪯ Σ 1/ri is enough
        steep = sum(1155 * scale * radius // (1000 * (d - radius) ** 2) + 1 for d in near)
        above = turns([scale // d**3 + 1 for d in near], rays)
        if not positive_definite_3(above, -1, top - steep):
            return False
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
    good = isinstance(text, str) and re.fullmatch(r"-?[0-9]{1,300}(/[0-9]{1,300})?", text, re.A)
    require(good, f"not an exact number: {str(text)[:40]!r}")
    top, _, bottom = text.partition("/")
    require(bottom == "" or int(bottom) > 0, "a denominator is zero")
    value = Fraction(int(top), int(bottom or 1))
    require(str(value) == text, f"not in lowest terms: {text[:40]!r}")
    return value


def numbers(values: Any, *shape: int | None) -> Any:
    """Read nested lists of numbers of a shape; None stands for any length."""
    if not shape:
        return number(values)
    require(isinstance(values, list) and shape[0] in (None, len(values)), "a list is misshapen")
    return [numbers(entry, *shape[1:]) for entry in values]


def keys(value: Any, wanted: Sequence[str], where: str) -> Any:
    """Make sure that an object has just the wanted keys."""
    require(isinstance(value, dict), f"{where} is not an object")
    require(set(value) == set(wanted), f"{where} must have the keys {', '.join(wanted)}")
    return value


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
    *("tools", "goal_position", "weights", "region", "sha256"),
)
GAINS = ("k1", "k2", "k3", "k4", "k_yaw")


def read_mission(c: Any) -> Question:
    """Return the numbers of the mission that bear on the claim, and enclosures made from them."""
    mission = c["mission"]
    keys(mission, ("name", "vehicle", "target", "goal", "gains", "bounds", "start"), "mission")
    named = isinstance(mission["name"], str) and re.fullmatch(
        r"[\w.-]{1,64}", mission["name"], re.A
    )
    require(named, "the mission has no proper name")
    require(c["mission_sha256"] == digest(mission), "the mission is not the one that was hashed")
    vehicle = keys(
        mission["vehicle"], ("mass", "inertia", "arm", "drag_ratio", "gravity"), "vehicle"
    )
    g = {k: number(v) for k, v in keys(mission["gains"], GAINS, "gains").items()}
    m, gravity = number(vehicle["mass"]), number(vehicle["gravity"])
    require(min(m, gravity, *g.values()) > 0, "mass, gravity and gains must be positive")
    w = numbers(c["weights"], 4)
    require(min(w) > 0, "weights must be positive")
    bounds, goal = mission["bounds"], mission["goal"]
    require(isinstance(bounds, dict) and isinstance(goal, dict), "bounds or goal is not an object")
    stiffness = g["k1"] ** 2 * g["k2"] / m

    keys(bounds, ("eigenvalues", "thrust" if "thrust" in bounds else "level"), "bounds")
    if "thrust" in bounds:
        thrust = numbers(bounds["thrust"], 2)
        require(thrust[0] <= m * gravity <= thrust[1], "the thrust interval does not hold m g")
    else:
        level = number(bounds["level"])
        require(level > 0, "the level must be positive")
        reach = stiffness * square_root(2 * level * (1 / w[1] + 1 / w[2]))[1]
        thrust = [m * gravity - reach, m * gravity + reach]
    numbers(bounds["eigenvalues"], 2)
    region = keys(c["region"], ("box", "eigenvalues"), "region")
    eigenvalues, box = numbers(region["eigenvalues"], 2), None
    require(0 < eigenvalues[0] < eigenvalues[1], "the eigenvalue bounds are not in order")
    if region["box"] is None:
        assumed = region["eigenvalues"] == bounds["eigenvalues"]
        require(assumed, "without a box, the eigenvalue bounds are those of the mission")
    else:
        box = numbers(region["box"], 3, 2)
        require(all(a <= b for a, b in box), "the box is not in order")

    points = numbers(keys(mission["target"], ("points",), "target")["points"], None, 3)
    require(2 <= len(points) <= MAX_POINTS, f"a target has 2 to {MAX_POINTS} points")
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
        centroid = [(x, x) for x in q]

    def f(thrust: Fraction, q3: Fraction) -> Fraction:
        return factor(m, g, thrust, q3)

    (low, high), (q_low, q_high) = thrust, centroid[2]
    return Question(
        name=mission["name"],
        m=m,
        g=g,
        w=w,
        thrust=thrust,
        eigenvalues=eigenvalues,
        box=box,
        points=points,
        centroid=centroid,
        factor=(f(high, q_low), f(low, q_high)),
        attained=(f(high, q_high), f(low, q_low)),
    )


def verify_gains(c: Any, p: Question) -> None:
    """Verify a proof of Σ ≻ margin·W, hence of the decay of L."""
    keys(c["enclosures"], ("centroid", "factor"), "enclosures")
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


def theorem_of_gains(c: Any, p: Question) -> str:
    """Say in words what is proved."""
    claim = keys(c["claim"], ("margin", "decay_rate"), "claim")
    margin, rate = about(number(claim["margin"])), about(number(claim["decay_rate"]))
    weights = ", ".join(map(str, p.w))
    stays = "Q and T stay in these intervals"
    region = ""
    if p.box is not None:
        stays, region = (
            "the vehicle stays in that box and T in its interval",
            theorem_of_region(c, p) + " ",
        )
    return (
        f"For {setting(p)}, the matrix Σ(Q, T) is positive definite: XᵀΣX > {margin} kg/s times "
        f"Σ wi|δi|² for all X ≠ 0, w = ({weights}). {region}Hence, while {stays} and Ω3 = 0, the "
        f"Lyapunov function L = ½ Σ wi|δi|² falls at least as fast as exp(-r t), r = {rate} 1/s."
    )


def verify_region(c: Any, p: Question) -> None:
    """Verify the eigenvalue bounds over the box, if one is claimed."""
    if p.box is not None:
        shown = eigenvalues_hold(p.points, p.box, p.eigenvalues[0], p.eigenvalues[1])
        require(shown, "the eigenvalue bounds are not shown to hold over the box")


def theorem_of_region(c: Any, p: Question) -> str:
    """Say in words over which box the eigenvalue bounds hold."""
    require(p.box is not None, "a claim about a region has a box")
    sides = " x ".join(f"[{about(a)}, {about(b)}]" for a, b in p.box or [])
    low, high = map(about, p.eigenvalues)
    return (
        f"For the target of the mission {p.name} and every position in the box {sides} m, the "
        f"eigenvalues of Q lie between {low} and {high} 1/m."
    )


def verify_outside(c: Any, p: Question) -> None:
    """Verify that Q has an eigenvalue out of bounds at a position in the box."""
    spot = c["outside"]
    position, x = numbers(spot["position"], 3), numbers(spot["direction"], 3)
    inside = all(a <= y <= b for y, (a, b) in zip(position, p.box or (), strict=True))
    require(inside, "the position is not in the box")
    lower = spot["bound"] == "lower"
    out = out_of_bounds(p.points, position, x, p.eigenvalues[0 if lower else 1], lower=lower)
    require(out, "the eigenvalue of Q there is not shown to be out of bounds")


def theorem_of_outside(c: Any, p: Question) -> str:
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


class Kind(NamedTuple):
    """A kind of certificate: its own keys, what it says, and how that is verified."""

    keys: tuple[str, ...]
    theorem: Callable[[Any, Question], str]
    verify: Callable[[Any, Question], None]


KINDS = {
    "gains": Kind(("enclosures", "vertices", "claim"), theorem_of_gains, verify_gains),
    "counterexample": Kind(("counterexample",), theorem_of_counterexample, verify_counterexample),
    "region": Kind((), theorem_of_region, verify_region),
    "outside": Kind(("outside",), theorem_of_outside, verify_outside),
}


def statement(certificate: Any) -> str:
    """Return the theorem that a certificate claims, in words.

    Parameters
    ----------
    certificate : mapping
        The JSON object.
    """
    return KINDS[certificate["kind"]].theorem(certificate, read_mission(certificate))


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
    head = (certificate["format"], certificate["version"])
    require(head == ("hoverproof certificate", 1), "not version 1 of the format")
    rest = {k: v for k, v in certificate.items() if k != "sha256"}
    require(certificate["sha256"] == digest(rest), "the file was changed after it was written")
    question = read_mission(certificate)
    theorem = KINDS[kind].theorem(certificate, question)
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
        raise Unreadable(f"is not JSON: {str(error)[:100]}") from None


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
    try:
        theorem = check_file(arguments[0])
    except Unreadable as error:
        print(f"{arguments[0]}: {error}", file=sys.stderr)
        return 2
    except Rejected as error:
        print(f"{arguments[0]}: rejected: {error}")
        return 1
    print(f"{arguments[0]}: accepted")
    print(
        textwrap.fill(f"Proved: {theorem}", width=80, initial_indent="  ", subsequent_indent="  ")
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
