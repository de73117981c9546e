"""Why no weights prove a start: a few states that refuse all weights at once, exactly.

For a reach of the errors, a ball of J and a rate, the theorem asks for weights w, a memory M and
multipliers, none negative, with which a form is nowhere negative at any vertex, Ψ at the start is
at most ℓ, and 1/w2 + 1/w3, 1/w3, 1/w3 + 1/w4 and 1/w2 are so small that the errors on {Ψ <= ℓ}
keep to the reach. All of that is affine in what is sought. States at a few vertices, each with what
the norm-bounded terms push there, a multiple of ℓ - Ψ, and vectors z of the matrices

    most  1   1              that are positive semidefinite where
    1     w2                 1/w2 + 1/w3 <= most,
    1         w3

make a sum, c0 + c2 w2 + c3 w3 + …, that is negative for all of them: c0 < 0, and each other c <= 0.
So whatever the weights, one of these states has Ψ fall too slowly, or the start is outside. A
solver finds the states; that the sum is so is shown by adding up rational numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.graph import evaluate
from hoverproof.certification.exponential.form import ROWS, Variables, Vertex, Weights, derive_form
from hoverproof.servo.law import Law

Exact = NDArray[np.object_]
Vector = tuple[Fraction, ...]
Total = dict[str, Fraction]
WEIGHTS = "1", "w2", "w3", "w4", "a5", "a6"
REACH = ("w2", "w3"), ("w3",), ("w3", "w4"), ("w2",)
"""Of which weights the sum of the reciprocals is bounded."""


@dataclass(frozen=True)
class State:
    """What a form is taken at.

    Attributes
    ----------
    variables : (20,)
        In the order of `Variables`, in its units.
    pushes : (k,) tuples
        Half of what each norm-bounded term adds to a rate, 1/s or 1/s².
    """

    variables: Vector
    pushes: tuple[Vector, ...]


@dataclass(frozen=True)
class Corner:
    """States at a vertex.

    Attributes
    ----------
    vertex : (6,)
        In the order of `Vertex`, in its units.
    states : tuple of State
    """

    vertex: Vector
    states: tuple[State, ...]


@dataclass(frozen=True)
class Asked:
    """The numbers of the inequality, exact.

    Attributes
    ----------
    law : Law
    design : tuple of Fractions
        In the order of the design, in its units.
    rate, latency, fading : Fraction
        r, 1/s; τ, s; and what is at least exp(-r τ).
    ball : (j, ϱ)
        1/m.
    slowness : Fraction
        m/k1, s.
    lagged : bool
        Whether rotors lag.
    terms : tuple of (pushed, by, radius)
        See `terms.terms`; the radius is a bare number.
    level : Fraction
        ℓ, dimensionless.
    start : mapping
        What 1 and the weights are multiplied by at least in Ψ at the start.
    reach : (4,)
        The bounds of the sums of `REACH`, bare numbers.
    """

    law: Law
    design: Vector
    rate: Fraction
    latency: Fraction
    fading: Fraction
    ball: tuple[Fraction, Fraction]
    slowness: Fraction
    lagged: bool
    terms: tuple[tuple[str, str, Fraction], ...]
    level: Fraction
    start: Total
    reach: Vector

    def at(self, corner: Corner) -> Sum:
        """Return the sum of the forms of a corner, as what 1 and all that is sought multiply.

        Parameters
        ----------
        corner : Corner
        """
        at, (j, radius) = _matrices(self.law, self.lagged, self.design, corner.vertex), self.ball
        X, total = Whole.of([state.variables for state in corner.states]), Sum()
        G, y, n = X.turned @ X, X[:, Variables.place("flow")], X[:, Variables.place("ahead")]
        v = (X @ at["sum"][0].turned).times(1 / self.slowness)
        for k, name in enumerate(WEIGHTS):
            total.add(name, at["fall"][k] * G)
            total.add(name, at["energy"][k] * G, -self.rate / 2)
        total.add("slope", y * y - 2 * j * (y * v) + (j**2 - radius**2) * (v * v))
        if self.latency:
            total.add("memory", self.fading / self.latency * (n * n) - self.latency * (y * y))
        for k, (pushed, by, size) in enumerate(self.terms):
            push = Whole.of([state.pushes[k] for state in corner.states])
            for place, name in enumerate(WEIGHTS):
                total.add(name, 2 * (at[pushed][place] * (push.turned @ X)))
            own = X @ at[by][0].turned
            total.add(f"t{k + 1}", 2 / size * (push * push) - size / 2 * (own * own))
        return total


@dataclass(frozen=True)
class Whole:
    """A matrix of Fractions over one denominator: to add them one by one takes long.

    Attributes
    ----------
    over : array of int
    under : int
        A bare number.
    """

    over: Exact
    under: int

    @classmethod
    def of(cls, rows: Any) -> Whole:
        """Take rows of Fractions.

        Parameters
        ----------
        rows : (n, k)
            Bare numbers.
        """
        values = np.array(rows, object)
        under = math.lcm(*(x.denominator for x in values.flat))
        return cls(np.array([[int(x * under) for x in row] for row in values], object), under)

    def __getitem__(self, place: Any) -> Whole:
        """Return a part."""
        return Whole(self.over[place], self.under)

    @property
    def turned(self) -> Whole:
        """The transpose."""
        return Whole(self.over.T, self.under)

    def times(self, factor: Fraction) -> Whole:
        """Return it times a number.

        Parameters
        ----------
        factor : Fraction
            A scalar.
        """
        return Whole(self.over * factor.numerator, self.under * factor.denominator)

    def __matmul__(self, other: Whole) -> Whole:
        """Return the product."""
        return Whole(self.over @ other.over, self.under * other.under)

    def __mul__(self, other: Whole) -> Fraction:
        """Return the sum of the products of all entries."""
        there = self.over != 0
        total = int((self.over[there] * other.over[there]).sum())
        return Fraction(total, self.under * other.under)


@cache
def _matrices(
    law: Law, lagged: bool, design: Vector, vertex: Vector
) -> dict[str, tuple[Whole, ...]]:
    """Return the matrices at a vertex, by name: what 1, w2, w3, w4, a5, a6 multiply."""
    count, graph = Weights.size(), derive_form(law, lagged)
    units = [[Fraction(i == k) for i in range(1, count + 1)] for k in range(count + 1)]
    found = np.array([evaluate(graph, [design, vertex, unit])[0] for unit in units])
    ends = np.cumsum(list(ROWS.values()))
    found[1:, : ends[4]] -= found[0, : ends[4]]
    each = dict(zip(ROWS, np.split(found, ends[:-1], axis=1), strict=True))
    each["yaw"] = each["d4"].copy()
    each["yaw"][WEIGHTS.index("w4")] -= each["h3"][0]
    return {name: tuple(map(Whole.of, parts)) for name, parts in each.items()}


class Sum(Total):
    """What 1 and all that is sought multiply."""

    def add(self, name: str, value: Any, times: Fraction = Fraction(1)) -> None:
        """Add a multiple of something.

        Parameters
        ----------
        name : str
        value, times : Fraction
            Bare numbers.
        """
        self[name] = self.get(name, Fraction(0)) + times * value

    @property
    def is_negative(self) -> bool:
        """Whether it is negative whatever is sought, if that is not."""
        return self["1"] < 0 and all(c <= 0 for name, c in self.items() if name != "1")


@dataclass(frozen=True)
class Refusal:
    """States, and what is added for start and reach, whose sum is negative for all weights.

    Attributes
    ----------
    asked : Asked
    corners : tuple of Corner
    start : Fraction
        Of ℓ - Ψ at the start, a bare number.
    vectors : (4,) tuples of vectors
        Of the matrices of `REACH`, bare numbers.
    left_out : tuple of str
        What the mission asks to be covered and is not looked at, in words: the theorem asks for
        more with it.
    """

    asked: Asked
    corners: tuple[Corner, ...]
    start: Fraction
    vectors: tuple[tuple[Vector, ...], ...]
    left_out: tuple[str, ...] = ()

    def total(self) -> Sum:
        """Return the sum."""
        total, asked = Sum(), self.asked
        for corner in self.corners:
            for name, value in asked.at(corner).items():
                total.add(name, value)
        total.add("1", asked.level, self.start)
        for name, value in asked.start.items():
            total.add(name, -value, self.start)
        for most, names, vectors in zip(asked.reach, REACH, self.vectors, strict=True):
            for first, *rest in vectors:
                total.add("1", most * first**2 + 2 * first * sum(rest))
                for name, z in zip(names, rest, strict=True):
                    total.add(name, z**2)
        return total

    @property
    def words(self) -> str:
        """What it shows."""
        states, (j, radius) = sum(len(c.states) for c in self.corners), self.asked.ball
        left = ""
        if self.left_out:
            left = f" (even without {' and '.join(self.left_out)}, with which it asks for more)"
        return (
            f"theorem 5 proves nothing of this start{left} with |J - {float(j):.3g} I| <= "
            f"{float(radius):.3g} 1/m, r = {float(self.asked.rate):.3g} 1/s and the bounds of the "
            f"errors in the file: all its weights are refused by {_count(states, 'state')} of "
            f"{_count(len(self.corners), 'vehicle')} within tolerance, in exact arithmetic; the "
            "vehicles may converge all the same"
        )

    def content(self) -> dict[str, Any]:
        """Return what is written of it, by name; all numbers are Fractions."""
        a = self.asked
        return {
            "format": "hoverproof refusal",
            "shows": self.words,
            "law": a.law.name,
            "design": _named(a.law.design.sizes(), a.design),
            "lagged": a.lagged,
            "rate": a.rate,
            "latency": a.latency,
            "fading": a.fading,
            "ball": list(a.ball),
            "level": a.level,
            "terms": [list(term) for term in a.terms],
            "start": {"multiplier": self.start, "factors": dict(a.start)},
            "reach": [
                {"of": list(names), "most": most, "vectors": [list(v) for v in vectors]}
                for names, most, vectors in zip(REACH, a.reach, self.vectors, strict=True)
            ],
            "corners": [
                {
                    "vertex": _named(Vertex.sizes(), corner.vertex),
                    "states": [
                        {
                            **_named(Variables.sizes(), state.variables),
                            "pushes": [list(push) for push in state.pushes],
                        }
                        for state in corner.states
                    ],
                }
                for corner in self.corners
            ],
            "sum": dict(self.total()),
        }


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _named(sizes: dict[str, int], values: Sequence[Fraction]) -> dict[str, Any]:
    """Put names to the parts of a vector."""
    parts, at = {}, 0
    for name, size in sizes.items():
        part = list(values[at : at + size])
        parts[name], at = part[0] if size == 1 else part, at + size
    return parts
