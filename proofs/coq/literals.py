"""Write certificates of gains as Coq literals, for the replay of `make -C proofs/coq`.

    python literals.py CERTIFICATE... > Replay.v
    python literals.py --plain CERTIFICATE... | extracted/decide
    python literals.py --about CERTIFICATE   what Coq shows of it and what not, in words, as JSON

Standard library only. What is written is no part of what is believed: Coq decides anew whether the
numbers are right, and the hints of each certificate are tested there as well.
"""

import importlib.util
import itertools
import json
import math
import re
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

N = 11
Forms = list[list[Fraction]]  # three linear forms


class Hint(NamedTuple):
    """What shows that a matrix is positive definite; see `Forms.hint`."""

    scaling: int
    times_more: int
    parts: list[tuple[int, list[int]]]

    def literal(self) -> str:
        """Return it as a term of `Forms.hint`."""
        parts = "; ".join(f"({d}, [{'; '.join(map(str, row))}])" for d, row in self.parts)
        return f"(Hint {self.scaling} {self.times_more} [{parts}]%Z)"

    def plain(self) -> str:
        """Return its numbers."""
        parts = "\n".join(" ".join(map(str, (d, *row))) for d, row in self.parts)
        return f"{self.scaling} {self.times_more} {len(self.parts)}\n{parts}"


def unit(i: int, n: int = N) -> list[Fraction]:
    """Return a linear form that is one of n components, or zero."""
    return [Fraction(int(k == i)) for k in range(n)]


def vector(i: int, n: int = N) -> Forms:
    """Return a vector whose first component is the i-th."""
    return [unit(k if k < n else -1, n) for k in range(i, i + 3)]


def plus(*terms: tuple[Fraction, Forms]) -> Forms:
    """Return a sum of multiples of vectors of linear forms."""
    n = len(terms[0][1][0])
    return [[sum((c * u[k][i] for c, u in terms), Fraction(0)) for i in range(n)] for k in range(3)]


def flat(u: Forms) -> Forms:
    """Return P u."""
    return [u[0], u[1], [Fraction(0)] * len(u[0])]


class Gains:
    """A certificate of gains, with the numbers of `Gains.certificate` in its order."""

    def __init__(self, c: dict[str, Any], name: str) -> None:
        mission, hints, number = c["mission"], c["enclosures"], Fraction
        self.name = name
        self.mass = number(mission["vehicle"]["mass"])
        self.k = [number(mission["gains"][key]) for key in ("k1", "k2", "k3", "k4")]
        self.weights = [number(w) for w in c["weights"]]
        self.low, self.high = map(number, c["region"]["eigenvalues"])
        self.gravity, bounds = number(mission["vehicle"]["gravity"]), mission["bounds"]
        self.level = number(bounds["level"]) if "level" in bounds else None
        self.root = Fraction(0)
        if self.level is None:
            self.thrust = [number(x) for x in bounds["thrust"]]
        else:
            k1, k2, *_ = self.k
            _, w2, w3, _ = self.weights
            self.root = root(2 * self.level * (1 / w2 + 1 / w3))[1]
            reach, weight = k1**2 * k2 / self.mass * self.root, self.mass * self.gravity
            self.thrust = [weight - reach, weight + reach]
        self.box = [[number(x) for x in side] for side in hints["centroid"]]
        self.factor = [number(x) for x in hints["factor"]]
        self.margin = number(c["claim"]["margin"])
        self.multipliers = [number(vertex["multiplier"]) for vertex in c["vertices"]]
        self.goal = c["goal_position"] and [number(x) for x in c["goal_position"]]
        target = mission["target"]
        self.points = [[number(x) for x in point] for point in target["points"]]
        self.counts = [number(x) for x in target.get("weights", ["1"] * len(self.points))]
        law = {"feature": "centroid", "goal": "image", **mission.get("law", {})}
        self.given = self.known(law, mission["goal"])
        self.of_target = (
            self.given is None
            and self.goal is not None
            and law["feature"] == "centroid"
            and not any(x for ray in self.rays().values() for x in ray[:2])
        )

    def known(self, law: dict[str, str], goal: dict[str, Any]) -> list[Fraction] | None:
        """Return what is fixed in the image, if it is known by numbers."""
        if law["goal"] == "inertial":
            return [Fraction(0)] * 3
        if law["feature"] == "centroid" and "centroid" in goal:
            return [Fraction(x) for x in goal["centroid"]]
        return None

    def rays(self) -> dict[Fraction, list[Fraction]]:
        """Return the sums of the rays from the goal of each length, by its square."""
        found: dict[Fraction, list[Fraction]] = {}
        for point, count in zip(reversed(self.points), reversed(self.counts), strict=True):
            ray = [a - b for a, b in zip(point, self.goal, strict=True)]
            sums = found.setdefault(sum(x * x for x in ray), [Fraction(0)] * 3)
            sums[:] = [a + count * x for a, x in zip(sums, ray, strict=True)]
        return found

    def terms(self, f: Fraction, q: list[Fraction], tau: Fraction) -> list[tuple]:
        """Return the terms of `Gains.bound`."""
        k1, k2, k3, k4 = self.k
        j, rho = (self.low + self.high) / 2, (self.high - self.low) / 2
        one, (d1, d2, d3, d4) = Fraction(1), map(vector, (0, 3, 6, 9))
        e, v = plus((one, d4), (-one, d3)), plus((one, d1), (one, d2))
        along = [q[0] * x + q[1] * y for x, y in zip(e[0], e[1], strict=True)]
        turn = [[q[2] * x for x in e[0]], [q[2] * x for x in e[1]], [-x for x in along]]
        rates = [
            plus((k1 * f, turn), (-k1 * j, v)),
            plus((k1 * k2, d3), (-k1 * k2, d2), (k1 * j, v), (-k1 * f, turn)),
            plus((k1 * j, v), (k1 * k2 + k3, d4), (-k1 * k2, d2), (-k3, d3)),
            plus((k1 * j, flat(v)), (-(k1 * k2 + k3), flat(d3)), (-k4, d4)),
        ]
        w = self.weights
        pull = plus((w[0], d1), (-w[1], d2), (-w[2], d3), (-w[3], d4))
        loss = -k1 * rho / 2
        errors = (d1, d2, d3, d4)
        return [
            *((-w[i], errors[i], rates[i]) for i in range(4)),
            *((-self.margin * w[i], errors[i], errors[i]) for i in range(4)),
            (loss * tau, v, v),
            (loss / tau, pull, pull),
        ]

    def hint(self, f: Fraction, tau: Fraction) -> Hint:
        """Return a hint for the matrices at one end of the interval of f, of all corners alike."""
        corners = itertools.product(*(sorted(set(side)) for side in self.box))
        each = [products(self.terms(f, list(corner), tau)) for corner in corners]
        denominators = (x.denominator for m in itertools.chain(*each) for row in m for x in row)
        return hint(each[0], math.lcm(*denominators))

    def numbers(self) -> tuple[list[Fraction], list[Fraction]]:
        """Return mass, gains and weights, and all other rational numbers, in their order."""
        ends = [*self.thrust, *itertools.chain(*self.box), *self.factor]
        rest = [self.low, self.high, *ends, self.margin, *self.multipliers]
        return [self.mass, *self.k, *self.weights], rest

    def hints(self) -> list[Hint]:
        """Return those at either end."""
        return list(map(self.hint, self.factor, self.multipliers))

    def literal(self) -> str:
        """Return the certificate as a term of `Gains.certificate`."""
        its, rest = (" ".join(map(q, each)) for each in self.numbers())
        hints = "\n  ".join(hint.literal() for hint in self.hints())
        return f"Certificate (Numbers {its})\n  {rest}\n  {hints}"

    def roots(self) -> list[tuple[Fraction, Fraction]]:
        """Enclose the distances of the target's points from the goal, each once."""
        return list(map(root, self.rays()))

    def target(self) -> str:
        """Return the target as a term of `Target.target`."""
        roots = "; ".join(f"({q(low)}, {q(high)})" for low, high in self.roots())
        each = zip(self.counts, self.points, strict=True)
        points = "; ".join(f"({q(count)}, {place(point)})" for count, point in each)
        return f"Target [{points}] {place(self.goal)}\n  [{roots}]"

    def plain(self) -> str:
        """Return the certificate, and its target if any, as `extracted/main.ml` reads it."""
        its, rest = self.numbers()
        hints = "\n".join(hint.plain() for hint in self.hints())
        text = f"gains {self.name}\n{' '.join(map(str, its + rest))}\n{hints}\n"
        if self.given is not None:
            return f"{text}given {' '.join(map(str, self.given))}\n"
        if not self.of_target:
            return f"{text}none\n"
        each = zip(self.counts, self.points, strict=True)
        roots, points = self.roots(), [*(x for k, p in each for x in (k, *p)), *self.goal]
        ends = " ".join(map(str, itertools.chain(*roots)))
        where = " ".join(map(str, points))
        return f"{text}target {len(self.points)} {where} {len(roots)} {ends}\n"


class Region:
    """A certificate of a region of attraction, with the numbers of `Region.region` in its order."""

    def __init__(self, c: dict[str, Any], name: str) -> None:
        mission, hints, number = c["mission"], c["enclosures"], Fraction
        self.name = name
        self.mass, self.gravity = (number(mission["vehicle"][k]) for k in ("mass", "gravity"))
        self.k = [number(mission["gains"][key]) for key in ("k1", "k2", "k3", "k4")]
        self.weights = [number(w) for w in c["weights"]]
        self.high, self.rate = number(hints["largest_eigenvalue"]), number(c["claim"]["rate"])
        self.tilt = number(hints["tilt"])
        self.factor, self.goal = ([number(x) for x in hints[key]] for key in ("factor", "goal"))
        self.multipliers = [number(x) for x in c["multipliers"]]

    def terms(self, f: Fraction, q3: Fraction, tau: Fraction) -> list[tuple]:
        """Return the terms of `Region.lower`."""
        (k1, k2, k3, k4), (a2, a3, a4), one = self.k, self.weights, Fraction(1)
        d1, d2, d3, d4 = map(vector, (0, 3, 6, 9))
        k = (k1 * k2 + k3) / k1
        lean = q3 * k1**2 * k2 / (self.mass**2 * self.gravity)
        s = plus((lean, d3), (-lean, d2))
        v = plus((one, d1), (one, [s[0], s[1], [-self.tilt * x for x in s[0]]]), (one, d2))
        u = plus((-a2, d2), (-a3, d3), (-a4, d4))
        loss = -self.high / 4
        return [
            *((one, d1, v), (self.high / 2, u, v), (loss * tau, v, v), (loss / tau, u, u)),
            (a2 * k2, d2, plus((one, d2), (-one, d3))),
            (a2 * f * q3, d2, flat(plus((one, d4), (-one, d3)))),
            (a3, d3, plus((k2, d2), (-k, d4), (k3 / k1, d3))),
            (a4, d4, plus((k, d3), (k4 / k1, d4))),
            *((-self.rate, d, d) for d in (d1, d2, d3, d4)),
        ]

    def hint(self, f: Fraction, tau: Fraction) -> Hint:
        """Return a hint for the matrices at one end of the interval of f, of both ends of q3*."""
        each = [products(self.terms(f, q3, tau)) for q3 in sorted(set(self.goal))]
        denominators = (x.denominator for m in itertools.chain(*each) for row in m for x in row)
        return hint(each[0], math.lcm(*denominators))

    def hints(self) -> list[Hint]:
        """Return those at either end."""
        return list(map(self.hint, self.factor, self.multipliers))

    def numbers(self) -> list[Fraction]:
        """Return all but the intervals."""
        rest = [*self.weights, self.high, self.rate, self.tilt]
        return [self.mass, *self.k, self.gravity, *rest]

    def literal(self) -> str:
        """Return the certificate as a term of `Region.region`."""
        pairs = (self.factor, self.goal, self.multipliers)
        ends = " ".join(f"({q(a)}, {q(b)})" for a, b in pairs)
        low, high = (hint.literal() for hint in self.hints())
        return f"Region {' '.join(map(q, self.numbers()))}\n  {ends}\n  ({low},\n  {high})"

    def plain(self) -> str:
        """Return the certificate as `extracted/main.ml` reads it."""
        numbers = [*self.numbers(), *self.factor, *self.goal, *self.multipliers]
        hints = "\n".join(hint.plain() for hint in self.hints())
        return f"region {self.name}\n{' '.join(map(str, numbers))}\n{hints}\n"


def root(square: Fraction) -> tuple[Fraction, Fraction]:
    """Enclose a square root."""
    unit = 2**128
    low = math.isqrt(square.numerator * unit**2 // square.denominator)
    exact = Fraction(low, unit) ** 2 == square
    return Fraction(low, unit), Fraction(low + (not exact), unit)


def place(p: list[Fraction]) -> str:
    """Write a position."""
    return f"({', '.join(map(q, p))})"


class Tolerant:
    """A certificate of every vehicle within tolerances, with the numbers of `Tolerant.matrices`.

    What `checker.py` derives is taken from it, rounded to the side that proves less.
    """

    def __init__(self, claim: Any, name: str) -> None:
        self.name, c, may = name, claim.c, claim.may
        one, t, rate = Fraction(1), c.multipliers, c.claim.rate
        late, x = claim.late, rate * claim.late
        self.late, self.memory = late, c.memory
        fading = (1 - x / 64) ** 64  # as `Late.fades`
        spent, regained = (c.memory * late, c.memory * fading / late) if late else (0 * one, one)
        a5, a6 = c.lag.torque, c.lag.thrust
        stiff, speed = claim.kappa + claim.damping, claim.k[0] / claim.m
        fixed = [claim.kappa, stiff, claim.k12, speed, *c.weights, a5, a6, rate]
        self.constants = [*fixed, up(spent), down(regained)]
        self.ball = [claim.low, claim.high]
        self.slope = t.slope
        follows = Follows(claim)
        whole = late and claim.inertial
        self.limits = follows.limits if whole else None
        self.starts = [started(claim, start) for start in c.claim.starts] if whole else []
        self.settling = settled(claim) if whole else []
        self.setting = [claim.m, *claim.k, claim.gravity]
        self.radii = [up(r) for r in follows.radii(claim)]
        known = iter(t.terms)
        multipliers = [next(known) if r else one for r in self.radii]
        self.prices = [(up(t), up(1 / up(t))) for t in multipliers]
        self.chi = [down(1 - follows.tipped), up(1 + follows.tipped)]
        self.drag = [down(claim.drag[0]), up(follows.drag)]
        self.gain = [1 - may.thrust, 1 + may.thrust]
        self.lag, self.pace = may.rotor_lag, up(2 * follows.sinking + follows.cross)

    def corners(self) -> Iterator[tuple[Fraction, ...]]:
        """Yield χ, s3 h, ς, τ and π in the order of `Tolerant.corners_of`."""
        ends = self.chi, self.drag, self.gain, [Fraction(0), self.lag], [-self.pace, self.pace]
        return itertools.product(*(sorted(set(each)) for each in ends))

    def terms(self, corner: tuple[Fraction, ...]) -> list[tuple]:
        """Return the terms of `Tolerant.lower`."""
        chi, drag, gain, tau, pi = corner
        kap, stiff, k12, speed, v2, v3, v4, a5, a6, pace, spent, regained = self.constants
        one = Fraction(1)
        d1, d2, d3, y, n = (vector(i, M) for i in (0, 3, 6, 11, 14))
        zero = [Fraction(0)] * M
        d4, mu = [unit(9, M), unit(10, M), zero], [unit(17, M), unit(18, M), zero]
        lift = [zero, zero, unit(19, M)]
        zeta, strain = plus((one, d4), (-one, flat(d3))), plus((one, d3), (-one, d2))
        moved = plus((one, y), (k12, strain))
        go3 = plus((one, moved), (kap * chi, zeta), (-gain * kap, upright(d3)), (-gain, lift))
        asked = plus((one, mu), (-stiff, d4), (-k12, flat(strain)))
        turning = kap * chi + (gain - 1) * pi / 2 + pi
        go4 = plus((one, flat(moved)), (turning, zeta), (one, asked))
        turned = plus((stiff, go4), (k12 * (kap * chi + drag), zeta))
        lag_turn = plus((stiff, flat(n)), (-pi, zeta), (-one, mu), (tau, turned))
        lag_lift = plus((-kap, upright(n)), (-one, lift), (-tau * kap, upright(go3)))
        ahead = tau * stiff * a5
        first = plus((v4, d4), (ahead, mu))
        lag = plus((a5, mu))
        pairs = [
            (first, asked),
            (first, zeta),
            (plus((v4, zeta), (ahead, mu)), flat(d3)),
            (lag, zeta),
            (lag, flat(plus((one, d3), (-one, n)))),
            (lag, flat(strain)),
            (plus((a6, lift)), zeta),
            (lag, asked),
        ]
        v = plus((speed, d1), (speed, d2))
        j, reach = sum(self.ball) / 2, (self.ball[1] - self.ball[0]) / 2
        out, half = plus((one, y), (-j, v)), -pace / 2
        found = [
            (-one, d1, plus((drag, zeta), (-one, y))),
            (-v2, d2, plus((one, moved), (-drag, zeta))),
            *((-v3, d3, go3), (-v4, d4, go4), (-a5, mu, lag_turn), (-a6, lift, lag_lift)),
            *((half, d1, d1), (half * v2, d2, d2), (half * v3, d3, d3), (half * v4, d4, d4)),
            *((half * tau * a5, mu, mu), (half * tau * a6, lift, lift)),
            *((-spent, y, y), (regained, n, n)),
            *((-self.slope * reach**2, v, v), (self.slope, out, out)),
        ]
        for (t, s), r, (u, w) in zip(self.prices, self.radii, pairs, strict=True):
            found += [(-r / 2 * t, w, w), (-r / 2 * s, u, u)]
        return found

    def hint(self, corner: tuple[Fraction, ...]) -> Hint:
        """Return a hint for the matrix at a corner."""
        parts = products(self.terms(corner), M)
        denominators = {x.denominator for m in parts for row in m for x in row}
        return hint(parts, math.lcm(*denominators))

    def hints(self) -> list[Hint]:
        """Return those of all corners."""
        return [*map(self.hint, self.corners())]

    def literal(self) -> str:
        """Return the certificate as a term of `Tolerant.matrices`."""
        constants = " ".join(map(q, self.constants))
        prices = "; ".join(f"({q(t)}, {q(s)})" for t, s in self.prices)
        ends = " ".join(f"({q(a)}, {q(b)})" for a, b in (self.chi, self.drag, self.gain))
        hints = ";\n  ".join(hint.literal() for hint in self.hints())
        return (
            f"Matrices (Constants {constants})\n  {' '.join(map(q, (*self.ball, self.slope)))}"
            f" [{prices}] [{'; '.join(map(q, self.radii))}]\n  {ends} {q(self.lag)} {q(self.pace)}"
            f"\n  [{hints}]"
        )

    def plain(self) -> str:
        """Return the certificate as `extracted/main.ml` reads it."""
        prices = itertools.chain(*self.prices)
        numbers = [*self.constants, *self.ball, self.slope, *prices, *self.radii]
        numbers += [*self.chi, *self.drag, *self.gain, self.lag, self.pace]
        hints = [hint.plain() for hint in self.hints()]
        rest = [*self.setting, *self.limits, *self.settling, len(self.starts)]
        rest += itertools.chain(*self.starts)
        lines = f"tolerant {self.name}", " ".join(map(str, numbers)), str(len(hints)), *hints
        return "\n".join([*lines, " ".join(map(str, rest)), ""])


M = 20
LITTLE = Fraction(1, 2**40)


class Follows:
    """What `Stays.limits` holds: bounds at a level a little above that of the certificate.

    Above, so that the start is below it. Each is rounded to the side that proves less.
    """

    def __init__(self, claim: Any) -> None:
        c, may, (w2, w3, w4) = claim.c, claim.may, claim.c.weights
        level = up(c.claim.level * (1 + LITTLE), FINE)
        self.spread, self.sink, self.turn, self.fast = (
            up(root(2 * level * x)[1], FINE)
            for x in (1 / w2 + 1 / w3, 1 / w3, 1 / w3 + 1 / w4, 1 + 1 / w2)
        )
        force, push = claim.stiffness * self.spread, claim.m * may.wind
        high = Fraction(0) if claim.inertial else c.enclosures.goal[1]
        lever = down(root((claim.weight - force) ** 2 - push**2)[0] - claim.stiffness * high, FINE)
        self.quick = up(claim.stiffness * claim.kappa / lever, FINE)
        self.drag, self.tipped = high * self.quick, push / lever
        past = claim.high * claim.k[0] / claim.m * self.fast
        self.missed = up(claim.late * past, FINE)
        self.sinking = up(self.quick * (self.sink + self.missed), FINE)
        self.cross = up(self.quick * self.turn * push / lever, FINE)
        tolerances = [may.thrust, may.torque, claim.gyroscopic, may.wind, may.yaw_rate]
        levels = [level, c.claim.start_level, self.spread, self.sink, self.turn, self.fast]
        others = [lever, self.quick, self.missed, self.sinking, self.cross, c.domain.offset]
        self.limits = [*tolerances, claim.late, c.memory, *levels, *others]

    def radii(self, claim: Any) -> list[Fraction]:
        """Return the radii of the eight terms of theorem 5 that are known by bounds alone."""
        may, yaw, late = claim.may, claim.may.yaw_rate, claim.may.rotor_lag
        gain, more = 1 + may.torque, 1 + may.thrust
        turned = self.quick * self.missed + may.thrust * self.cross / 2
        turned += 2 * more * self.sinking + yaw * (gain * claim.gyroscopic + may.torque)
        return [
            *(may.torque, turned, yaw),
            yaw * claim.gyroscopic + late * claim.k12 * self.quick * self.spread,
            *(yaw, late * claim.k12 * yaw),
            late * claim.kappa * self.quick * self.sink,
            late * (more * self.sinking + self.cross),
        ]


FINE = 64


def started(claim: Any, start: Any) -> list[Fraction]:
    """Return a set of states at first as a `Starts.start`: what the checker sees from there."""
    moved = start.speed * claim.late
    box = [(a - moved, b + moved) for a, b in start.position]
    seen = claim.place.start(claim.grid, claim.grid.cell(box)) or [2 * claim.c.domain.offset] * 2
    off, level = (up(x, FINE) for x in seen)
    force = start.thrust + claim.weight * start.tilt
    sine = (force + claim.m * claim.may.wind) / claim.weight
    cosine = down(root(max(Fraction(0), 1 - sine**2))[0], FINE)
    lean = up(sine * root(2 / (1 + cosine))[1], FINE)
    flat = min(off, up(level + lean * off, FINE))
    turn = (claim.weight + force) * start.rate / (claim.stiffness * claim.kappa)
    return [off, level, start.speed, force, start.rate, cosine, lean, flat, up(turn, FINE)]


def settled(claim: Any) -> list[Fraction]:
    """Return when the vehicle is near as a `Starts.settling`, and powers of e from below."""
    soon = claim.c.claim.settling
    y = down(claim.c.claim.rate * soon.time / 64, FINE)
    powers = [down(sum((y**k / math.factorial(k) for k in range(6)), Fraction(0)), FINE)]
    for _ in range(6):
        powers.append(down(powers[-1] ** 2, FINE))
    return [soon.offset, soon.time, y, *powers]


def up(x: Fraction, bits: int = 28) -> Fraction:
    """Round a number to one with few digits that is not below."""
    return -down(-x, bits)


def down(x: Fraction, bits: int = 28) -> Fraction:
    """Round a number to one with few digits that is not above."""
    unit = Fraction(2) ** (bits + x.denominator.bit_length() - x.numerator.bit_length())
    return math.floor(x * unit) / unit


def upright(u: Forms) -> Forms:
    """Return what stands along e3."""
    return [[Fraction(0)] * len(u[2]), [Fraction(0)] * len(u[2]), u[2]]


def products(terms: list[tuple], n: int = N) -> list[list[list[Fraction]]]:
    """Return twice the symmetric matrix of each product of two linear forms."""
    return [
        [
            [c * (x[i] * y[k] + x[k] * y[i]) if y[k] or y[i] else y[k] for k in range(n)]
            for i in range(n)
        ]
        for c, u, v in terms
        for x, y in zip(u, v, strict=True)
    ]


def factors(m: list[list[Fraction]]) -> list[tuple[Fraction, list[Fraction]]] | None:
    """Return (d, r) with M = Σ d r rᵀ, d > 0, or None where M is not positive definite."""
    found, rest, n = [], [row[:] for row in m], len(m)
    for k in range(n):
        d = rest[k][k]
        if d <= 0:
            return None
        r = [x / d for x in rest[k]]
        found.append((d, r))
        for i in range(k, n):
            rest[i] = [x - d * r[i] * y for x, y in zip(rest[i], r, strict=True)]
    return found


def hint(parts: list[list[list[Fraction]]], scaling: int) -> Hint:
    """Return what shows that a sum of matrices is positive definite: nearly all of it as squares.

    The squares are of M less a small multiple of I, rounded to whole numbers; what is left of M is
    nearly that multiple of I. Where M is not positive definite there is none, and an empty one.
    """
    n = len(parts[0])
    m = [[scaling * sum(part[i][k] for part in parts) for k in range(n)] for i in range(n)]
    if factors(m) is None:
        return Hint(scaling, 1, [])
    size = max(m[i][i] for i in range(n))
    for bits in range(10, 200, 10):
        less = size / 2**bits
        shifted = [
            [x - (less if i == k else 0) for k, x in enumerate(row)] for i, row in enumerate(m)
        ]
        found = factors(shifted)
        if found:
            unit = 2 ** (bits + 12)  # of the rows; they are multiplied by it, M by its square
            rows = [(round(d), [round(x * unit) for x in r]) for d, r in found]
            return Hint(scaling, unit**2, rows)
    return Hint(scaling, 1, [])


def q(x: Fraction) -> str:
    """Write a rational number."""
    return f"({x.numerator} # {x.denominator})"


def checked() -> Any:
    """Return checker.py, as installed or in a clone."""
    here = Path(__file__).resolve()
    places = here.parents[1] / "checker.py", here.parents[2] / "src" / "hoverproof" / "checker.py"
    spec = importlib.util.spec_from_file_location("checker", next(filter(Path.is_file, places)))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def tolerant_of(held: dict[str, Any], name: str) -> Tolerant | None:
    """Return a certificate of vehicles within tolerances, if it is of those that Coq knows."""
    claim = checked().claim_of(held)
    plain = claim.c.lag is not None and not (
        claim.hold or claim.late_axes or any(claim.shaken.values())
    )
    return Tolerant(claim, name) if plain else None


def certificates(paths: list[str]) -> Iterator[Gains | Tolerant | Region]:
    """Yield the certificates that Coq can decide."""
    for path in map(Path, paths):
        held = json.loads(path.read_text(encoding="utf-8"))
        name = path.name.removesuffix(".cert.json")
        if held["kind"] == "gains":
            yield Gains(held, name)
        elif held["kind"] == "attraction":
            yield Region(held, name)
        elif held["kind"] == "exponential":
            found = tolerant_of(held, name)
            if found:
                yield found


PAPER = "certificates of this kind are checked by checker.py alone, and their theorem is on paper"
PLAIN = (
    "of certificates of vehicles within tolerances, Coq knows those with rotors that lag, and with "
    "none of noise, gusts, a control period, a lag of the force, and images that are not turned"
)
STEPS = (
    "that the corners and the bounds follow from the level, that no motion leaves it, the domain, "
    "the starts, the settling and the rotors are on paper, and left to checker.py"
)
PLACES = (
    "what depends on where the target is is left to checker.py: that J is in its ball and all "
    "points are seen all over the domain, that it ends where what is seen is beyond the offset, "
    "how far off a start sees, the radius within which the offset is, and the angle; so are the "
    "rotors; that a motion exists, and motions of thrusts that jump, are on paper"
)
NATURAL = (
    "that -(m/k1) Λ' is that form and its ends follow from the level, that no motion leaves the "
    "region, the positions, the barrier, the starts and the convergence are on paper, and left to "
    "checker.py"
)
ENCLOSED = "that the wanted feature is in its box is left to checker.py"
GOAL = "that J or Q is within its bounds at the goal is left to checker.py"
BOX = "that J or Q is within its bounds over the box, and at the goal, is left to checker.py"


def about(held: dict[str, Any]) -> dict[str, Any]:
    """Return what Coq shows of a certificate, and what is left, in words."""
    if held["kind"] == "exponential":
        known = tolerant_of(held, "")
        if known is None:
            return {"shown": [], "left": PLAIN}
        shown = [
            "matrices_sound: the inequality of theorem 5, that Ψ falls faster than at its rate, "
            "for every J of the ball, all parameters of the vehicle between the corners of the "
            "certificate, and all that is known by bounds alone",
            "tolerant_falls: so Ψ(t) <= Ψ(0) exp(-r t) along every solution of the error equations "
            "of theorem 5 that is between them on the way",
            "vehicle_obeys: rigid body, camera and law obey these equations",
        ]
        if held["memory"] is not None:
            shown.append("late_remembers: the memory in Ψ makes up for an image that is late")
        if not known.limits:
            return {"shown": shown, "left": STEPS}
        shown += [
            "vehicle_stays: no motion from a start leaves the domain or what is between the "
            "corners, and Ψ(t) <= Ψ(0) exp(-r t) along all of it",
            "start_arrives: Ψ(0) is at most its level in every state of a start, and from the "
            "settling time on what a level camera sees is within the offset",
        ]
        return {"shown": shown, "left": PLACES}
    if held["kind"] == "attraction":
        shown = [
            "region_sound: the inequality of theorem 3, that -(m/k1) Λ' is above rate·|Y|², for "
            "every Q with eigenvalues between 0 and the largest, all f and q3* between their ends "
            "and every tilt up to the bound, in whatever direction"
        ]
        return {"shown": shown, "left": NATURAL}
    if held["kind"] != "gains":
        return {"shown": [], "left": PAPER}
    c = Gains(held, "")
    axial = not any(map(any, c.box[:2]))
    yaw = "whatever the yaw rate is" if axial else "with a yaw rate of 0 at the start, and damped"
    shown = [
        "gains_sound: XᵀΣX > margin Σ wi|δi|² for every X ≠ 0, every J or Q and every thrust "
        "within the bounds, every q* in the box of the certificate, whatever Ω is",
        "lyapunov_decays: L falls at its rate along every motion of rigid body, camera and law "
        f"while J or Q and T are within their bounds, {yaw}",
    ]
    if c.given is not None:
        shown.append("given_sound: what is fixed in the image is in that box")
    elif c.of_target:
        shown.append("target_sound: what a level camera sees from the goal is in that box")
    left = [] if len(shown) == 3 else [ENCLOSED]
    if c.level is not None:
        shown.append("level_sound: T is within these bounds while L is within the level, and T > 0")
    left.append(GOAL if held["region"]["box"] is None else BOX)
    return {"shown": shown, "left": "; ".join(left)}


def theorems(c: Gains | Tolerant | Region) -> str:
    """Return what Coq is to decide of a certificate."""
    name, decided = re.sub(r"\W", "_", c.name), "Proof. vm_cast_no_check (eq_refl true). Qed."
    if isinstance(c, Region):
        lines = [
            f"Definition natural_{name} : region :=\n  {c.literal()}.",
            f"Theorem region_{name} : region_ok natural_{name} = true.\n{decided}",
            f"Definition falls_{name} := region_sound natural_{name} region_{name}.",
        ]
        return "\n".join(lines) + "\n"
    if isinstance(c, Tolerant):
        lines = [
            f"Definition matrices_{name} : matrices :=\n  {c.literal()}.",
            f"Theorem tolerant_{name} : matrices_ok matrices_{name} = true.\n{decided}",
            f"Definition falls_{name} := matrices_sound matrices_{name} tolerant_{name}.",
        ]
        if c.memory is not None:
            numbers = f"{q(c.memory)} {q(c.late)}"
            lines.append(
                f"Theorem late_{name} : memory_ok {numbers} matrices_{name} = true.\n{decided}"
            )
        if c.limits is not None:
            limits, setting = (" ".join(map(q, each)) for each in (c.limits, c.setting))
            its = f"setting_{name} limits_{name} matrices_{name}"
            lines += [
                f"Definition limits_{name} := Limits {limits}.",
                f"Definition setting_{name} := Setting {setting}.",
                f"Theorem bounds_{name} : limits_ok {its} = true.\n{decided}",
                f"Definition stays_{name} := fun vehicle => vehicle_stays vehicle {its}.",
                f"Definition settling_{name} := Settling {' '.join(map(q, c.settling[:4]))}\n"
                f"  [{'; '.join(map(q, c.settling[4:]))}].",
                f"Theorem settled_{name} : settled_ok limits_{name} matrices_{name} "
                f"settling_{name} = true.\n{decided}",
            ]
            for number, start in enumerate(c.starts, 1):
                term = f"start_{name}_{number}"
                lines += [
                    f"Definition {term} := Start {' '.join(map(q, start))}.",
                    f"Theorem held_{name}_{number} : start_ok {its} {term} = true.\n{decided}",
                    f"Definition arrives_{name}_{number} := fun vehicle =>\n"
                    f"  start_arrives vehicle {its} {term} settling_{name}.",
                ]
        return "\n".join(lines) + "\n"
    lines = [
        f"Definition cert_{name} : certificate :=\n  {c.literal()}.",
        f"Theorem gains_{name} : certificate_ok cert_{name} = true.\n{decided}",
        f"Definition falls_{name} := gains_sound cert_{name} gains_{name}.",
    ]
    if c.given is not None:
        lines.append(
            f"Theorem given_{name} : given_ok {place(c.given)} cert_{name} = true.\n{decided}"
        )
    if c.level is not None:
        numbers = f"{q(c.gravity)} {q(c.level)} {q(c.root)}"
        lines.append(f"Theorem level_{name} : level_ok {numbers} cert_{name} = true.\n{decided}")
    if c.of_target:
        lines += [
            f"Definition target_{name} : target :=\n  {c.target()}.",
            f"Theorem seen_{name} : target_ok target_{name} cert_{name} = true.\n{decided}",
        ]
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> None:
    """Print theorems for certificates, or their numbers."""
    if arguments[:1] == ["--about"]:
        held = json.loads(Path(arguments[1]).read_text(encoding="utf-8"))
        sys.stdout.buffer.write(json.dumps(about(held)).encode())
        return
    if arguments[:1] == ["--plain"]:
        known = certificates(arguments[1:])
        sys.stdout.writelines(c.plain() for c in known if not isinstance(c, Tolerant) or c.limits)
        return
    print("(* Written by literals.py from certificates. *)")
    print(
        "From Hoverproof Require Import Forms Gains Target Decay Tolerant Late Stays Starts Region."
    )
    print("Require Import QArith List.\nImport ListNotations.\n")
    for c in certificates(arguments):
        print(theorems(c))


if __name__ == "__main__":
    main(sys.argv[1:])
