"""Decide whether gains are certified: proved, refuted or undecided."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np

from hoverproof.algebra.definite import is_positive_definite, quadratic_form
from hoverproof.certify.certificate import Certificate, exact, seal
from hoverproof.certify.lmi import Array, Vertex, best_multiplier, worst_directions
from hoverproof.certify.problem import GainProblem, Rows, gain_problem
from hoverproof.mission import Mission

MULTIPLIER_BITS = 40
DIRECTION_BITS = 40
SHRINK = 1 - Fraction(1, 1 << 40)


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
    margin_above : Fraction
        Proved upper bound of the worst eigenvalue, kg/s.
    reason : str
        What stood in the way.
    problem : GainProblem
        What was asked.
    """

    status: ClassVar[str] = "undecided"
    margin_above: Fraction
    reason: str
    problem: GainProblem


Verdict = Proved | Refuted | Undecided


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
        try:
            vertex = _vertex(problem, f)
            tau = _dyadic(best_multiplier(vertex), MULTIPLIER_BITS)
        except RuntimeError as error:
            return _undecided(problem, worst, str(error))
        worst.append(_worst_case(problem, vertex, float(tau), attained))
        margin = _proved_margin(problem, f, tau, vertex.margin(float(tau)))
        vertices.append(
            {
                "factor": f,
                "multiplier": tau,
                "margin": margin,
                "decay_rate": None if margin is None else problem.decay_rate(margin),
            }
        )
    low, high = problem.factor_attained
    lowest = min(worst, key=lambda w: w.quotient)
    if lowest.value < 0 and low <= lowest.f <= high:
        return _refuted(problem, lowest)
    margins = [v["margin"] for v in vertices]
    if None in margins or min(margins) <= 0:
        return _undecided(problem, worst, "the worst eigenvalue of Σ is too close to zero")
    return _proved(problem, vertices, lowest.quotient)


def _proved(problem: GainProblem, vertices: list[dict[str, Any]], margin_above: Fraction) -> Proved:
    margin = min(v["margin"] for v in vertices)
    rate = problem.decay_rate(margin)
    parts = {
        "claim": {"margin": margin, "decay_rate": rate},
        "enclosures": {"centroid": problem.centroid, "factor": problem.factor},
        "vertices": vertices,
    }
    return Proved(margin, margin_above, rate, problem, seal(problem, "gains", parts))


def _refuted(problem: GainProblem, worst: _Worst) -> Refuted:
    point = {"Q": worst.Q, "f": worst.f, "X": worst.X, "value": worst.value}
    certificate = seal(problem, "counterexample", {"counterexample": point})
    return Refuted(worst.Q, worst.f, worst.X, worst.value, worst.quotient, problem, certificate)


def _undecided(problem: GainProblem, worst: list[_Worst], reason: str) -> Undecided:
    return Undecided(min(w.quotient for w in worst), reason, problem)


def _vertex(problem: GainProblem, f: Fraction) -> Vertex:
    """Round one end of the interval of f to floating point, q* in the middle of its box."""
    middle, spread = _middle_and_spread(problem)
    q = tuple((low + high) / 2 for low, high in problem.centroid)
    sigma, u, v = (_floats(m) for m in problem.matrices(_identity(middle), f, q))
    return Vertex(sigma, u, v, float(problem.mission.gains.k1 * spread / 2))


def _proved_margin(
    problem: GainProblem, f: Fraction, tau: Fraction, estimate: float
) -> Fraction | None:
    """Return a short t, just below the estimate, with M(τ) ≻ t I exactly at all corners of q*."""
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
    for slack in (1e-9, 1e-7, 1e-5):
        t = _decimal_below(estimate - slack * abs(estimate))
        if all(is_positive_definite(_shifted(m, t)) for m in bounds):
            return t
    return None


def _worst_case(problem: GainProblem, vertex: Vertex, tau: float, f: Fraction) -> _Worst:
    """Make exact the candidate of worst directions with the lowest Rayleigh quotient."""
    middle, spread = _middle_and_spread(problem)
    found = []
    for x, w in worst_directions(vertex, tau):
        X = [_dyadic(float(c), DIRECTION_BITS) for c in x / np.abs(x).max()]
        axis = [_dyadic(float(c), DIRECTION_BITS) for c in w]
        square = sum(c * c for c in axis)
        Q = _identity(middle)
        for i in range(3):
            for j in range(3):
                mirror = 2 * axis[i] * axis[j] / square if square else Fraction(0)
                Q[i][j] += spread * SHRINK * (Fraction(int(i == j)) - mirror)
        value = max(quadratic_form(problem.matrices(Q, f, q)[0], X) for q in problem.corners())
        found.append(_Worst(Q, f, X, value))
    return min(found, key=lambda candidate: candidate.quotient)


def _middle_and_spread(problem: GainProblem) -> tuple[Fraction, Fraction]:
    low, high = problem.eigenvalues
    return (low + high) / 2, (high - low) / 2


def _identity(scale: Fraction) -> Rows:
    return [[scale if i == j else Fraction(0) for j in range(3)] for i in range(3)]


def _shifted(matrix: Rows, t: Fraction) -> Rows:
    return [[a - t if i == j else a for j, a in enumerate(row)] for i, row in enumerate(matrix)]


def _floats(matrix: Rows) -> Array:
    return np.array([[float(entry) for entry in row] for row in matrix])


def _dyadic(value: float, bits: int) -> Fraction:
    """Round to `bits` binary digits, relative to the size of the value if that is below 1."""
    _, exponent = np.frexp(value)
    places = bits - min(int(exponent), 0)
    return Fraction(round(Fraction(value) * (1 << places)), 1 << places)


def _decimal_below(value: float, digits: int = 10) -> Fraction:
    """Return the largest decimal of so many significant digits that is not above a value."""
    if value == 0:
        return Fraction(0)
    places = digits - 1 - int(np.floor(np.log10(abs(value))))
    scale = Fraction(10) ** places
    return Fraction(int((Fraction(value) * scale) // 1)) / scale


def as_json(verdict: Verdict, certificate_path: str | None) -> dict[str, Any]:
    """Return a verdict as an object for machines.

    Parameters
    ----------
    verdict : Proved, Refuted or Undecided
    certificate_path : str or None
        Where the certificate was written.
    """
    problem = verdict.problem
    margin = verdict.margin if isinstance(verdict, Proved) else None
    counterexample = None
    if isinstance(verdict, Refuted):
        point = {"Q": verdict.Q, "f": verdict.f, "X": verdict.X, "value": verdict.value}
        counterexample = exact(point)
    return {
        "mission": problem.mission.name,
        "verdict": verdict.status,
        "margin": float(verdict.margin_above if margin is None else margin),
        "margin_bounds": [
            None if margin is None else float(margin),
            float(verdict.margin_above),
        ],
        "decay_rate": float(verdict.decay_rate) if isinstance(verdict, Proved) else None,
        "eigenvalues": [float(x) for x in problem.eigenvalues],
        "thrust": [float(x) for x in problem.thrust],
        "goal_centroid": [float(x) for x in problem.goal.centroid_midpoint],
        "weights": [float(x) for x in problem.weights],
        "counterexample": counterexample,
        "reason": verdict.reason if isinstance(verdict, Undecided) else None,
        "statement": None if isinstance(verdict, Undecided) else verdict.certificate.statement,
        "certificate": certificate_path,
        "units": {
            "margin": "kg/s",
            "decay_rate": "1/s",
            "eigenvalues": "1/m",
            "thrust": "N",
        },
    }
