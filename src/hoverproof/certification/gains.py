"""Decide whether gains are certified: proved, refuted or undecided."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np

from hoverproof.algebra.definite import is_positive_definite, quadratic_form
from hoverproof.certification.certificate import Certificate, seal
from hoverproof.certification.lmi import Array, Vertex, best_multiplier, worst_direction
from hoverproof.certification.problem import GainProblem, Rows, gain_problem
from hoverproof.mission import Mission

WITNESS_BITS = 40


@dataclass(frozen=True)
class Proved:
    """Σ is positive definite over the whole region.

    Attributes
    ----------
    margin : Fraction
        Proved lower bound of every eigenvalue of Σ, kg/s.
    margin_above : Fraction
        Proved upper bound of the worst eigenvalue (from an extremal Q), kg/s.
    decay_rate : Fraction
        Proved: L falls at least as fast as exp(-decay_rate·t), 1/s.
    problem : GainProblem
        What was asked.
    certificate : Certificate
    """

    status: ClassVar[str] = "proved"
    margin: Fraction
    margin_above: Fraction
    decay_rate: Fraction
    problem: GainProblem
    certificate: Certificate


@dataclass(frozen=True)
class Refuted:
    """Σ has a negative direction at some point of the region.

    Attributes
    ----------
    Q : (3, 3) rows of Fractions
        Symmetric, its eigenvalues strictly inside the interval, 1/m.
    f : Fraction
        f(T) of some thrust in the interval, 1/m.
    X : (11,) Fractions
        The error vector.
    value : Fraction
        Upper bound of XᵀΣX over the enclosure of q*, negative, kg/s.
    margin_above : Fraction
        Proved upper bound of the worst eigenvalue, negative, kg/s.
    problem : GainProblem
        What was asked.
    certificate : Certificate
        The counterexample in a file that the checker confirms.
    """

    status: ClassVar[str] = "refuted"
    Q: Rows
    f: Fraction
    X: list[Fraction]
    value: Fraction
    margin_above: Fraction
    problem: GainProblem
    certificate: Certificate


@dataclass(frozen=True)
class Undecided:
    """Neither a proof nor a counterexample was found.

    Attributes
    ----------
    margin_above : Fraction or None
        Proved upper bound of the worst eigenvalue, kg/s; None if the solver found nothing.
    reason : str
        What stood in the way.
    problem : GainProblem
        What was asked.
    """

    status: ClassVar[str] = "undecided"
    margin_above: Fraction | None
    reason: str
    problem: GainProblem


Verdict = Proved | Refuted | Undecided


@dataclass(frozen=True)
class _Vertex:
    """One end of the interval of f, with what was proved there."""

    factor: Fraction
    multiplier: Fraction
    margin: Fraction


@dataclass(frozen=True)
class _Worst:
    """An exact point of the region, and its Rayleigh quotient as a bound of the margin."""

    Q: Rows
    f: Fraction
    X: list[Fraction]
    value: Fraction

    @property
    def quotient(self) -> Fraction:
        return self.value / sum(x * x for x in self.X)


def certify(mission: Mission) -> Verdict:
    """Decide whether Σ ≻ 0 for every Q and every thrust that the mission allows.

    Solvers suggest a multiplier and a worst case for each end of the interval of f(T); the verdict
    rests on exact rational arithmetic alone (an LDLᵀ for a proof, XᵀΣX < 0 for a refutation).

    Parameters
    ----------
    mission : Mission

    Returns
    -------
    Proved, Refuted or Undecided

    Raises
    ------
    InputError
        If the mission poses no question: its goal cannot be seen, or its thrust interval reaches
        the singularity of the controller.
    """
    problem = gain_problem(mission)
    vertices, worst = [], []
    for f, attained in zip(problem.factor, problem.factor_attained, strict=True):
        vertex = _vertex(problem, f)
        try:
            tau = _short_multiplier(best_multiplier(vertex))
        except RuntimeError as error:
            return Undecided(None, str(error), problem)
        direction = worst_direction(vertex, float(tau))
        worst.append((_worst_case(problem, direction, attained, WITNESS_BITS), direction))
        margin = _proved_margin(problem, f, tau, vertex.margin(float(tau)))
        vertices.append(_Vertex(f, tau, margin))
    low, high = problem.factor_attained
    lowest, direction = min(worst, key=lambda pair: pair[0].quotient)
    if lowest.value < 0 and low <= lowest.f <= high:
        return _refuted(problem, _shortest_witness(problem, direction, lowest), lowest.quotient)
    if any(v.margin <= 0 for v in vertices):
        return Undecided(lowest.quotient, "the worst eigenvalue of Σ is too near zero", problem)
    return _proved(problem, vertices, lowest.quotient)


def _proved(problem: GainProblem, vertices: list[_Vertex], margin_above: Fraction) -> Proved:
    margin = min(v.margin for v in vertices)
    rate = problem.decay_rate(margin)
    parts = {
        "claim": {"margin": margin, "decay_rate": rate},
        "enclosures": {"centroid": problem.centroid, "factor": problem.factor},
        "vertices": [
            {
                "factor": v.factor,
                "multiplier": v.multiplier,
                "margin": v.margin,
                "decay_rate": problem.decay_rate(v.margin),
            }
            for v in vertices
        ],
    }
    return Proved(margin, margin_above, rate, problem, seal(problem, "gains", parts))


def _refuted(problem: GainProblem, worst: _Worst, margin_above: Fraction) -> Refuted:
    value = -_decimal_below(-worst.value)
    point = {"Q": worst.Q, "f": worst.f, "X": worst.X, "value": value}
    certificate = seal(problem, "counterexample", {"counterexample": point})
    return Refuted(worst.Q, worst.f, worst.X, value, margin_above, problem, certificate)


def _vertex(problem: GainProblem, f: Fraction) -> Vertex:
    """Round one end of the interval of f to floating point, q* in the middle of its box."""
    middle, spread = _middle_and_spread(problem)
    q = tuple((low + high) / 2 for low, high in problem.centroid)
    sigma, u, v = (_floats(m) for m in problem.matrices(_identity(middle), f, q))
    return Vertex(sigma, u, v, float(problem.mission.gains.k1 * spread / 2))


def _proved_margin(problem: GainProblem, f: Fraction, tau: Fraction, estimate: float) -> Fraction:
    """Return a short t, near the estimate, with M(τ) ≻ t I exactly at all corners of q*.

    Zero if none is found above it.
    """
    middle, spread = _middle_and_spread(problem)
    loss = problem.mission.gains.k1 * spread / 2
    bounds = []
    for q in problem.corners():
        sigma, u, v = problem.matrices(_identity(middle), f, q)
        n = range(len(sigma))
        bounds.append(
            [
                [
                    sigma[i][j]
                    - loss
                    * sum(tau * b[i] * b[j] + a[i] * a[j] / tau for a, b in zip(u, v, strict=True))
                    for j in n
                ]
                for i in n
            ]
        )
    for slack in (1e-9, 1e-7, 1e-5, 1e-3):
        t = _decimal_below(estimate * (1 - slack))
        if t > 0 and all(is_positive_definite(_shifted(m, t)) for m in bounds):
            return t
    return Fraction(0)


def _worst_case(
    problem: GainProblem, direction: tuple[Array, Array], f: Fraction, bits: int
) -> _Worst:
    """Round a worst direction to rationals, and evaluate XᵀΣX there exactly.

    Q = λ̄I + ϱH with a mirror H, pulled in a little so that its eigenvalues lie strictly inside.
    """
    middle, spread = _middle_and_spread(problem)
    spread *= 1 - Fraction(1, 1 << bits)
    x, w = direction
    X = [_rounded(c, bits) for c in x / np.abs(x).max()]
    axis = [_rounded(c, bits) for c in w]
    square = sum(c * c for c in axis)
    Q = _identity(middle + spread)
    for i in range(3):
        for j in range(3):
            Q[i][j] -= 2 * spread * axis[i] * axis[j] / square if square else Fraction(0)
    value = max(quadratic_form(problem.matrices(Q, f, q)[0], X) for q in problem.corners())
    return _Worst(Q, f, X, value)


def _shortest_witness(
    problem: GainProblem, direction: tuple[Array, Array], worst: _Worst
) -> _Worst:
    """Return a counterexample in shorter numbers that loses no more than a tenth of the value."""
    low, high = problem.factor_attained
    for bits in (4, 8, 12, 16, 24):
        unit = Fraction(1, 1 << (bits + 8))
        inward = worst.f // unit * unit + (unit if worst.f == low else 0)
        f = inward if low <= inward <= high else worst.f
        short = _worst_case(problem, direction, f, bits)
        if any(short.X) and short.quotient < worst.quotient * Fraction(9, 10):
            return short
    return worst


def _middle_and_spread(problem: GainProblem) -> tuple[Fraction, Fraction]:
    low, high = problem.eigenvalues
    return (low + high) / 2, (high - low) / 2


def _identity(scale: Fraction) -> Rows:
    return [[scale if i == j else Fraction(0) for j in range(3)] for i in range(3)]


def _shifted(matrix: Rows, t: Fraction) -> Rows:
    return [[a - t if i == j else a for j, a in enumerate(row)] for i, row in enumerate(matrix)]


def _floats(matrix: Rows) -> Array:
    return np.array([[float(entry) for entry in row] for row in matrix])


def _short_multiplier(tau: float) -> Fraction:
    """Round τ to 24 significant binary digits: the margin is flat there, and proofs stay short."""
    return _rounded(tau, 24 - int(np.frexp(tau)[1])) if tau < 2.0**24 else Fraction(round(tau))


def _rounded(value: float, bits: int) -> Fraction:
    """Round to so many binary digits after the point."""
    return Fraction(round(Fraction(value) * (1 << bits)), 1 << bits)


def _decimal_below(value: float | Fraction, digits: int = 10) -> Fraction:
    """Return the largest decimal of so many significant digits that is not above a value."""
    if value == 0:
        return Fraction(0)
    places = digits - 1 - int(np.floor(np.log10(abs(float(value)))))
    scale = Fraction(10) ** places
    return Fraction(value) * scale // 1 / scale


def as_json(verdict: Verdict, certificate_path: str | None) -> dict[str, Any]:
    """Return a verdict as an object for machines.

    Parameters
    ----------
    verdict : Proved, Refuted or Undecided
    certificate_path : str or None
        Where the certificate was written.
    """
    problem = verdict.problem
    proved = verdict if isinstance(verdict, Proved) else None
    refuted = verdict if isinstance(verdict, Refuted) else None
    above = None if verdict.margin_above is None else float(verdict.margin_above)
    return {
        "mission": problem.mission.name,
        "verdict": verdict.status,
        "margin": float(proved.margin) if proved else above,
        "margin_bounds": [float(proved.margin) if proved else None, above],
        "decay_rate": float(proved.decay_rate) if proved else None,
        "eigenvalues": _numbers(problem.eigenvalues),
        "thrust": _numbers(problem.thrust),
        "goal_centroid": _numbers(problem.goal.centroid_midpoint),
        "weights": _numbers(problem.weights),
        "counterexample": refuted.certificate.content["counterexample"] if refuted else None,
        "reason": verdict.reason if isinstance(verdict, Undecided) else None,
        "statement": None if isinstance(verdict, Undecided) else verdict.certificate.statement,
        "certificate": certificate_path,
        "units": {"margin": "kg/s", "decay_rate": "1/s", "eigenvalues": "1/m", "thrust": "N"},
    }


def _numbers(values: Sequence[Fraction]) -> list[float]:
    return [float(x) for x in values]
