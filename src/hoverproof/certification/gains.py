"""Decide whether gains are certified: proved, refuted or undecided."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from hoverproof.algebra.decimals import at_least, at_most, decimal_below
from hoverproof.algebra.definite import is_positive_definite, quadratic_form
from hoverproof.algebra.derived import kept_json
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.certificate import Certificate, rejection, seal
from hoverproof.certification.problem import (
    ONES,
    GainProblem,
    Rows,
    gain_problem,
    sigma_function,
    squares,
)
from hoverproof.certification.region import Enclosure
from hoverproof.certification.robust import (
    Array,
    Inequality,
    margins,
    optimise,
    worst_case,
)
from hoverproof.certification.verdict import Proved, Refuted, Undecided
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.lyapunov import thrust_at

WITNESS_BITS = 40
DIGITS = 10
MOST_ROUNDS = 40
NO_BETTER = 1e-7
BESIDE = "the camera is not at the centre of mass: see attraction, which may cover it"


@dataclass(frozen=True, kw_only=True, repr=False)
class ProvedGains(Proved):
    """Σ is positive definite over the whole region.

    Attributes
    ----------
    mission, certificate
        See `Proved` of `hoverproof.certification.verdict`.
    problem : GainProblem
        What was asked.
    margin : Fraction
        Proved: Σ ⪰ margin·W, kg/s; with all weights 1 a lower bound of every eigenvalue of Σ.
    margin_above : Fraction
        Proved upper bound of the worst eigenvalue (from an extremal Q), kg/s.
    decay_rate : Fraction
        Proved: L falls at least as fast as exp(-decay_rate·t), 1/s.
    """

    problem: GainProblem
    margin: Fraction
    margin_above: Fraction
    decay_rate: Fraction

    @property
    def gist(self) -> str:
        """Margin and decay rate."""
        margin, rate = at_least(self.margin, 6), at_least(self.decay_rate, 6)
        return f"margin of Σ {margin} kg/s, decay rate of L {rate} 1/s"


@dataclass(frozen=True, kw_only=True, repr=False)
class RefutedGains(Refuted):
    """Σ has a negative direction at some point of the region.

    Attributes
    ----------
    mission, certificate
        See `Refuted` of `hoverproof.certification.verdict`.
    problem : GainProblem
        What was asked.
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
    """

    problem: GainProblem
    Q: Rows
    f: Fraction
    X: list[Fraction]
    value: Fraction
    margin_above: Fraction

    @property
    def thrust(self) -> Fraction:
        """A thrust with that f(T), N, q* in the middle of its box."""
        return thrust_at(self.f, self.mission, self.problem.centroid)

    @property
    def gist(self) -> str:
        """The worst eigenvalue."""
        return f"Σ has an eigenvalue of {at_most(self.margin_above, 6)} kg/s or less"


@dataclass(frozen=True, kw_only=True, repr=False)
class UndecidedGains(Undecided):
    """Whether Σ is positive definite over the whole region is not known.

    Attributes
    ----------
    mission, reason, advice, certificate
        See `Undecided` of `hoverproof.certification.verdict`.
    problem : GainProblem
        What was asked.
    margin_above : Fraction or None
        Proved upper bound of the worst eigenvalue, kg/s; None if the solver found nothing.
    """

    problem: GainProblem
    margin_above: Fraction | None


GainsVerdict = ProvedGains | RefutedGains | UndecidedGains


@dataclass(frozen=True)
class _Worst:
    """An exact point of the region, with XᵀΣX and XᵀWX: their quotient bounds the margin."""

    Q: Rows
    f: Fraction
    X: list[Fraction]
    value: Fraction
    weight: Fraction

    @property
    def quotient(self) -> Fraction:
        return self.value / self.weight


@of_mission
def certify(
    mission: Mission, *, weights: tuple[Fraction, ...] = ONES, region: Enclosure | None = None
) -> GainsVerdict:
    """Decide whether Σ ≻ 0 for every Q and every thrust that the mission allows.

    Solvers suggest a multiplier and a worst case for each end of the interval of f(T); the verdict
    rests on exact rational arithmetic alone (an LDLᵀ for a proof, XᵀΣX < 0 for a refutation).

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    weights : (4,) Fractions
        w of L = ½ Σ wᵢ|δᵢ|²; `search_weights` finds those with the largest decay rate.
    region : Enclosure, optional
        A box with proved eigenvalue bounds, to take the place of those that the mission assumes.

    Returns
    -------
    ProvedGains, RefutedGains or UndecidedGains

    Raises
    ------
    InputError
        If the mission poses no question: its goal cannot be seen, Q there is not within the bounds,
        or its thrust interval reaches the singularity of the controller.
    """
    problem = gain_problem(mission, weights, region)
    if mission.camera.has_arm:
        return _undecided(problem, BESIDE)
    vertices, candidates = [], []
    root = np.sqrt([float(w) for w in problem.weight_diagonal])
    for f, attained in zip(problem.factor, problem.factor_attained, strict=True):
        question = problem.inequality(f).scaled(root**2)
        try:
            best = float(margins(question)[1][0])
        except np.linalg.LinAlgError as error:
            return _undecided(problem, f"no multiplier was found ({error})")
        tau = _short_multiplier(best)
        estimate = float(np.linalg.eigvalsh(question.bound([float(tau)]))[0])
        x, axis = worst_case(question, best)
        candidates.append((estimate, attained, (x / root, axis)))
        margin = _proved_margin(problem, f, tau, estimate)
        vertices.append({"factor": f, "multiplier": tau, **_rated(problem, margin)})
    _, attained, direction = min(candidates, key=lambda candidate: candidate[0])
    worst = _worst_case(problem, direction, attained, WITNESS_BITS)
    low, high = problem.factor_attained
    if worst.value < 0 and low <= worst.f <= high:
        return _refuted(problem, _shortest_witness(problem, direction, worst), worst.quotient)
    if min(vertex["margin"] for vertex in vertices) <= 0:
        return _undecided(problem, "the worst eigenvalue of Σ is too near zero", worst.quotient)
    return _proved(problem, vertices, worst.quotient)


def _undecided(
    problem: GainProblem, reason: str, margin_above: Fraction | None = None
) -> UndecidedGains:
    return UndecidedGains(
        mission=problem.mission, reason=reason, problem=problem, margin_above=margin_above
    )


def _rated(problem: GainProblem, margin: Fraction) -> dict[str, Fraction]:
    """Return what a certificate says of a margin."""
    return {"margin": margin, "decay_rate": problem.decay_rate(margin)}


def search_weights(mission: Mission, *, region: Enclosure | None = None) -> tuple[Fraction, ...]:
    """Return short weights with (nearly) the largest decay rate that can be certified, w1 = 1.

    Where the mission gives a level, the thrust interval is that of weights 1 during the search.

    Parameters
    ----------
    mission : Mission
    region : Enclosure, optional
        See `certify`.

    Raises
    ------
    InputError
        See `certify`.
    """
    base = gain_problem(mission, ONES, region)
    units = list(np.eye(4))
    found = _best_weights([base.inequality(f, units) for f in base.factor])
    return (Fraction(1), *(decimal_below(float(w / found[0]), 4) for w in found[1:]))


def _best_weights(corners: Sequence[Inequality]) -> Array:
    """Return the weights w, (4,), w1 = 1, that maximise the margin over all corners.

    S and u are linear in w. By Dinkelbach's rounds: with the margin t of weights w', the next ones
    maximise the s with M ⪰ t W + s W'; then s is how much is left to be won, and t never falls.
    """
    best, margin = np.ones(4), -np.inf
    weights, units = best, np.array([np.diag(squares(list(unit))) for unit in np.eye(4)])
    for _ in range(MOST_ROUNDS):
        scale = np.array(squares(list(weights)))
        found = min(float(margins(c.at(weights).scaled(scale))[0]) for c in corners)
        if found <= margin + NO_BETTER * abs(margin):
            break
        best, margin = weights, found
        lost = np.array([*(margin * units), np.diag(scale)])
        step = optimise([0, 0, 0, -1], [c.less(lost) for c in corners], rows=np.eye(5)[1:4])
        if step is None or not (step.x[:3] > 0).all():
            break
        weights = np.array([1, *step.x[:3]])
    return best


def _proved(
    problem: GainProblem, vertices: list[dict[str, Fraction]], margin_above: Fraction
) -> ProvedGains | UndecidedGains:
    claim = _rated(problem, min(vertex["margin"] for vertex in vertices))
    enclosures = {"centroid": problem.centroid, "factor": problem.factor, "goal": problem.goal_box}
    parts = {"claim": claim, "enclosures": enclosures, "vertices": vertices}
    certificate = _seal(problem, "gains", parts)
    reason = rejection(certificate)
    if reason:
        return _undecided(problem, reason, margin_above)
    return ProvedGains(
        mission=problem.mission,
        certificate=certificate,
        problem=problem,
        margin_above=margin_above,
        **claim,
    )


def _refuted(problem: GainProblem, worst: _Worst, margin_above: Fraction) -> RefutedGains:
    value = -decimal_below(-worst.value, DIGITS)
    point: dict[str, Any] = {"Q": worst.Q, "f": worst.f, "X": worst.X, "value": value}
    certificate = _seal(problem, "counterexample", {"counterexample": point})
    return RefutedGains(
        mission=problem.mission,
        certificate=certificate,
        problem=problem,
        margin_above=margin_above,
        **point,
    )


def _seal(problem: GainProblem, kind: str, parts: dict[str, Any]) -> Certificate:
    tree = problem.region and problem.region.tree
    region = {"box": problem.box, "eigenvalues": problem.eigenvalues, "tree": tree}
    own = {"weights": problem.weights, "region": region, **parts}
    return seal(problem.mission, kind, own, model_fingerprint(law_of(problem.mission)))


@kept_json
def model_fingerprint(law: Law) -> str:
    """Return the SHA-256 of the graph of Σ from which the verdict was computed.

    Parameters
    ----------
    law : Law
    """
    return fingerprint(sigma_function(law))


def _proved_margin(problem: GainProblem, f: Fraction, tau: Fraction, estimate: float) -> Fraction:
    """Return a short t, near the estimate, with M(τ) ≻ t W exactly at all corners of q*.

    Zero if none is found above it.
    """
    middle, spread = _middle_and_spread(problem)
    loss = problem.mission.gains.k1 * spread / 2
    bounds = []
    for q in problem.corners():
        sigma, u, v = problem.matrices(_identity(middle), f, q)
        for a, b in zip(u, v, strict=True):  # rows of u and v: few entries of them are not zero
            for matrix_row, factor in ((b, loss * tau), (a, loss / tau)):
                held = [(i, x) for i, x in enumerate(matrix_row) if x]
                for i, x in held:
                    for j, y in held:
                        sigma[i][j] -= factor * x * y
        bounds.append(sigma)
    for slack in (1e-9, 1e-7, 1e-5, 1e-3):
        t = decimal_below(estimate * (1 - slack), DIGITS)
        if t > 0 and all(
            is_positive_definite(_shifted(m, t, problem.weight_diagonal)) for m in bounds
        ):
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
    weight = sum((w * x * x for w, x in zip(problem.weight_diagonal, X, strict=True)), Fraction(0))
    return _Worst(Q, f, X, value, weight)


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


def _shifted(matrix: Rows, t: Fraction, weights: Sequence[Fraction]) -> Rows:
    return [
        [a - t * weights[i] if i == j else a for j, a in enumerate(row)]
        for i, row in enumerate(matrix)
    ]


def _short_multiplier(tau: float) -> Fraction:
    """Round τ to 24 significant binary digits: the margin is flat there, and proofs stay short."""
    return _rounded(tau, 24 - int(np.frexp(tau)[1])) if tau < 2.0**24 else Fraction(round(tau))


def _rounded(value: float, bits: int) -> Fraction:
    """Round to so many binary digits after the point."""
    return Fraction(round(Fraction(value) * (1 << bits)), 1 << bits)
