"""Gains by design: the fastest gains within a vehicle's limits that can still be proved.

The search is in floating point (`gain_search`). Its winner is rounded to short decimals, and only
then certified, exactly: the rate that is reported is the proved one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.gain_search import (
    COARSE,
    GainSearch,
    Objective,
    slowest_rate_at_goal,
)
from hoverproof.certification.gains import Proved, certify, search_weights
from hoverproof.certification.limits import FirstCommand, Limits, Use, highest_k4, uses
from hoverproof.certification.margins import Questions, margins
from hoverproof.certification.problem import ONES, GainProblem, gain_problem
from hoverproof.errors import InputError
from hoverproof.mission import Gains, Mission

Array = NDArray[np.float64]
Weights = tuple[Fraction, ...] | Literal["search"]

LOSS = 2e-4
TRIES = 4
YAW_PART = 4
YAW_EFFORT = 2


@dataclass(frozen=True)
class Tuned:
    """Gains that are proved, and what was traded for them.

    Attributes
    ----------
    mission : Mission
        The mission with the new gains.
    verdict : Proved
        What `certify` says of just these gains.
    before : Fraction or None
        Decay rate of L that is proved for the gains the mission had, 1/s; with the same weights, or
        with those that suit them best if weights were searched.
    estimate : float
        Decay rate before rounding to short decimals, in floating point, 1/s.
    slowest_rate : float
        Decay rate of the slowest motion of the loop linearised at the goal, 1/s.
    uses : list of Use
        How much of each limit the gains use.
    objective : str
        What was made as large as possible.
    """

    status: ClassVar[str] = "tuned"
    mission: Mission
    verdict: Proved
    before: Fraction | None
    estimate: float
    slowest_rate: float
    uses: list[Use]
    objective: Objective


@dataclass(frozen=True)
class Infeasible:
    """No gains meet the wish within the limits: what was found, and what binds.

    Attributes
    ----------
    mission : Mission
    reason : str
        What binds, and by how much.
    best : Tuned or None
        The best that can be done within the limits.
    needed_bandwidth : float or None
        The bandwidth that would do, estimated in floating point, rad/s.
    """

    status: ClassVar[str] = "infeasible"
    mission: Mission
    reason: str
    best: Tuned | None = None
    needed_bandwidth: float | None = None


def tune(
    mission: Mission,
    *,
    bandwidth: float = 20.0,
    objective: Objective = "decay",
    rate: float | None = None,
    tilt: float | None = None,
    rotor_thrust: float | None = None,
    weights: Weights = ONES,
    at_least: float | None = None,
) -> Tuned | Infeasible:
    """Find the fastest gains within a vehicle's limits that can be proved.

    Parameters
    ----------
    mission : Mission
        Its gains are replaced; its bounds, goal and start count.
    bandwidth : float
        Largest attitude bandwidth (k1 k2 + k3 + k4)/m, rad/s.
    objective : {"decay", "settling"}
        Make the certified decay rate of L as large as possible, or the slowest rate of the loop
        linearised at the goal, as long as the gains are certified.
    rate : float, optional
        Sampling rate, 1/s: the bandwidth times the period is kept at 0.2 or below.
    tilt : float, optional
        Largest tilt that may be asked for at the mission's start, rad.
    rotor_thrust : float, optional
        Largest thrust of a rotor, N: the first command keeps each rotor between 0 and this.
    weights : (4,) Fractions, or "search"
        Weights of L; "search" improves gains and weights in turns.
    at_least : float, optional
        Certified decay rate of L that is wished for, 1/s.

    Returns
    -------
    Tuned or Infeasible

    Raises
    ------
    InputError
        If the mission poses no question, or an option is out of range.
    """
    limits = Limits(bandwidth, rate, tilt, rotor_thrust)
    if at_least is not None and not 0 < at_least < math.inf:
        raise InputError("--at-least", "", f"must be a positive rate in 1/s, not {at_least}")
    hover = float(mission.vehicle.weight) / 4
    if rotor_thrust is not None and rotor_thrust < hover:
        short = f"{rotor_thrust:g} N is {hover - rotor_thrust:g} N below m g/4 = {hover:g} N"
        return Infeasible(mission, f"no rotor thrust to hover: the limit of {short}")
    command = FirstCommand.of(mission)

    def best(objective: Objective, weights: tuple[Fraction, ...]) -> Tuned | Infeasible:
        questions = Questions.of(_problem(mission, weights))
        floor = at_least or 0.0
        return _tuned(mission, GainSearch(questions, limits, command, objective, floor), weights)

    found = best(objective, ONES if weights == "search" else weights)
    if weights == "search":
        found = _with_better_weights(found, best)
    if isinstance(found, Infeasible) and objective == "settling" and at_least is not None:
        found = best("decay", ONES if weights == "search" else weights)
    if isinstance(found, Infeasible):
        return found
    if at_least is not None and found.verdict.decay_rate < at_least:
        return _short_of(found, limits, at_least, command)
    return replace(found, before=_rate_of_own_gains(mission, weights))


def _with_better_weights(
    found: Tuned | Infeasible,
    best: Callable[[Objective, tuple[Fraction, ...]], Tuned | Infeasible],
) -> Tuned | Infeasible:
    """Improve weights and gains in turns, as long as that helps."""
    for _ in range(TRIES):
        if isinstance(found, Infeasible):
            break
        new = best(found.objective, search_weights(found.mission))
        if isinstance(new, Infeasible) or not _is_better(new, found):
            break
        found = new
    return found


def _rate_of_own_gains(mission: Mission, weights: Weights) -> Fraction | None:
    """Return the decay rate that is proved for a mission's own gains, 1/s; None if none is."""
    try:
        if weights == "search":
            weights = search_weights(mission) if _is_proved(mission) else ONES
        own = certify(mission, weights=weights)
    except InputError:
        return None
    return own.decay_rate if isinstance(own, Proved) else None


def _is_proved(mission: Mission) -> bool:
    return isinstance(certify(mission), Proved)


def _is_better(new: Tuned, old: Tuned) -> bool:
    if old.objective == "settling":
        return new.slowest_rate > old.slowest_rate * 1.001
    return new.verdict.decay_rate > old.verdict.decay_rate * Fraction(1001, 1000)


def _problem(mission: Mission, weights: tuple[Fraction, ...]) -> GainProblem:
    """Pose the question with gains that surely pose one: only bounds, goal and weights are used."""
    low = mission.model_copy(update={"gains": _gains(mission, ["0.000001", "1", "1", "1"])})
    try:
        return gain_problem(mission, weights)
    except InputError:
        return gain_problem(low, weights)


def _tuned(
    mission: Mission, search: GainSearch, weights: tuple[Fraction, ...]
) -> Tuned | Infeasible:
    """Search, round, and certify what was found."""
    best, value = search.run()
    if value <= 0:
        return _nothing(mission, search, best, value)
    for gains in _short(mission, search, best, value):
        tuned = mission.model_copy(update={"gains": gains})
        verdict = certify(tuned, weights=weights)
        if isinstance(verdict, Proved) and (
            search.objective == "decay" or verdict.decay_rate >= search.at_least
        ):
            break
    else:
        return Infeasible(mission, "the best gains found are too near the edge to be proved")
    exact = search.gains(best[None])
    return Tuned(
        mission=tuned,
        verdict=verdict,
        before=None,
        estimate=2
        * float(margins(replace(search.questions, gains=exact))[0])
        / search.questions.mass,
        slowest_rate=slowest_rate_at_goal(tuned),
        uses=uses(search.limits, search.command, tuned),
        objective=search.objective,
    )


def _short(mission: Mission, search: GainSearch, best: Array, value: float) -> Iterator[Gains]:
    """Yield the shortest decimals that keep all but `LOSS` of the rate, then longer ones.

    k1, k2 and k3 are rounded up or down, k4 is rounded down to what the limits then allow.
    """
    exact = [float(k[0]) for k in search.gains(best[None])]
    for digits in range(2, 9):
        around = [(decimal_below(k, digits), decimal_above(k, digits)) for k in exact[:3]]
        triples = list(itertools.product(*around))
        k1, k2, k3 = (np.array([float(t[i]) for t in triples]) for i in range(3))
        low, high = highest_k4(search.limits, search.command, (k1, k2, k3))
        if search.objective == "settling":
            high = np.minimum(high, exact[3])
        k4 = [
            decimal_below(h, digits + 1) if np.isfinite(h) and h > max(a, 0) else None
            for a, h in zip(low, high, strict=True)
        ]
        last = np.array([float(k) if k is not None else np.nan for k in k4])
        values = search.values((k1, k2, k3, np.where(last > low, last, np.nan)))
        order = np.argsort(-values, kind="stable")
        if values[order[0]] >= value * (1 - LOSS):
            k = int(order[0])
            yield _gains(mission, [*triples[k], k4[k]], search.limits.fastest)


def _gains(mission: Mission, four: list[Any], bandwidth: float | None = None) -> Gains:
    """Return gains with k_yaw in proportion to a bandwidth; that of the mission without one.

    Yaw is damped at a quarter of the bandwidth, but a turn of 1 rad/s takes no more than half the
    torque about the yaw axis that two rotors at rest and two at twice their hover thrust have.
    """
    k_yaw = mission.gains.k_yaw
    if bandwidth is not None:
        v = mission.vehicle
        effort = v.drag_ratio * v.weight / YAW_EFFORT
        k_yaw = decimal_below(min(v.inertia[2] * Fraction(bandwidth) / YAW_PART, effort), 2)
    k1, k2, k3, k4 = (Fraction(k) for k in four)
    return Gains(k1=k1, k2=k2, k3=k3, k4=k4, k_yaw=k_yaw)


def _nothing(mission: Mission, search: GainSearch, best: Array, value: float) -> Infeasible:
    """Say what stands in the way of any certificate."""
    if value == -np.inf:
        return Infeasible(mission, _start_words(search))
    low, high = (float(x) for x in search.questions.eigenvalues)
    margin = value * search.questions.mass / 2
    return Infeasible(
        mission,
        f"no gains are certified within a bandwidth of {search.limits.fastest:g} rad/s: the best "
        f"margin found is {margin:.3g} kg/s (floating point), short of 0 by {-margin:.3g}; what "
        f"binds are the bounds: eigenvalues of Q in [{low:g}, {high:g}] 1/m, and the thrust",
    )


def _start_words(search: GainSearch) -> str:
    """Say by how much the first command misses the limits even with hardly any gain."""
    limits, none = search.limits, tuple(np.array([k]) for k in (1e-6, 1e-3, 1e-3, 1e-3))
    thrusts, tilt = search.command(none)
    low, high = float(thrusts.min()), float(thrusts.max())
    words = []
    if limits.rotor_thrust is not None and not 0 <= low <= high <= limits.rotor_thrust:
        beyond = max(-low, high - limits.rotor_thrust)
        words.append(
            f"rotor thrusts from {low:.4g} to {high:.4g} N, {beyond:.3g} N beyond "
            f"[0, {limits.rotor_thrust:g}] N"
        )
    if limits.tilt is not None and tilt[0] > limits.tilt:
        most, asked = math.degrees(limits.tilt), math.degrees(tilt[0])
        words.append(f"a tilt of {asked:.3g} deg, {asked - most:.2g} deg beyond {most:g} deg")
    if not words:
        return "no gains were found that keep the limits at the start and pose a question"
    held = " and ".join(words)
    return f"no gains keep the limits at the start: even hardly any gain asks for {held}"


def _short_of(best: Tuned, limits: Limits, at_least: float, command: FirstCommand) -> Infeasible:
    """Say by how much a wished decay rate is missed, and which bandwidth would do."""
    rate = float(best.verdict.decay_rate)
    search = GainSearch(
        Questions.of(gain_problem(best.mission, best.verdict.problem.weights)),
        limits,
        command,
        "decay",
    )
    needed = _needed_bandwidth(search, best, at_least)
    binding = [f"{u.name} {u.value:.4g} of {u.limit:.4g} {u.unit}" for u in best.uses if u.binds]
    words = ", ".join(binding) if binding else "the bounds of Q and of the thrust alone"
    if needed is None:
        more = "no bandwidth would do (floating point): the bounds of Q and of the thrust bind"
    else:
        more = f"a bandwidth of about {needed:.3g} rad/s would do"
    reason = (
        f"the largest certified decay rate is {rate:.4g} 1/s, {at_least - rate:.3g} 1/s short of "
        f"{at_least:g} 1/s; what binds: {words}; {more}"
    )
    return Infeasible(best.mission, reason, best, needed)


def _needed_bandwidth(search: GainSearch, best: Tuned, at_least: float) -> float | None:
    """Return the bandwidth at which a rate is reached, rad/s; None beyond 10⁴-fold."""
    g = best.mission.gains
    z = np.log([float(k) for k in (g.k1, g.k1 * g.k2, g.k3)])

    def reached(bandwidth: float) -> bool:
        nonlocal z
        trial = replace(search, limits=replace(search.limits, bandwidth=bandwidth, rate=None))
        z_new, value = trial.climb(z, 0.5, COARSE / 4)
        if np.isfinite(value):
            z = z_new
        return value >= at_least

    low = high = search.limits.fastest
    while not reached(high):
        low, high = high, 2 * high
        if high > 1e4 * search.limits.fastest:
            return None
    while high > low * 1.01:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if reached(middle) else (middle, high)
    return high


Report = Callable[[int, int], None]


def pareto(
    mission: Mission,
    count: int,
    *,
    bandwidth: float = 20.0,
    lowest: float | None = None,
    report: Report = lambda done, total: None,
    **options: Any,
) -> list[tuple[float, Tuned | Infeasible]]:
    """Return the best certified gains for bandwidths in equal ratios, lowest first.

    Parameters
    ----------
    mission : Mission
    count : int
        Number of bandwidths, at least 2.
    bandwidth : float
        The highest, rad/s.
    lowest : float, optional
        The lowest, rad/s; by default a twentieth of the highest.
    report : callable
        Called with how many are done, of how many.
    options
        As for `tune`.
    """
    if not 2 <= count <= 1000:
        raise InputError("--pareto", "", f"must be from 2 to 1000 bandwidths, not {count}")
    first = bandwidth / 20 if lowest is None else lowest
    points = []
    for i, b in enumerate(np.geomspace(first, bandwidth, count)):
        b = float(f"{b:.4g}") if i < count - 1 else bandwidth
        points.append((b, tune(mission, bandwidth=b, **options)))
        report(i + 1, count)
    return points
