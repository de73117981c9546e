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
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.gains import certify, search_weights
from hoverproof.certification.problem import ONES, GainProblem, exact_weights, gain_problem
from hoverproof.design.gain_search import GainSearch
from hoverproof.design.gain_search import Objective as RateObjective
from hoverproof.design.infeasible import (
    margin_words,
    needed_bandwidth,
    start_words,
)
from hoverproof.design.limits import (
    ANY,
    LEAST,
    FirstCommand,
    Limits,
    designed_gains,
    highest_k4,
    uses,
)
from hoverproof.design.margins import Questions, margins
from hoverproof.design.outcome import Infeasible, RegionTuned, StartTuned, Tuned
from hoverproof.design.region_tuning import region_pareto, tune_region
from hoverproof.design.start_trade import start_trade
from hoverproof.design.start_tuning import tune_start
from hoverproof.errors import InputError
from hoverproof.mission.conditions import common_limits
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import Gains
from hoverproof.servo.linearised import slowest_rate

Array = NDArray[np.float64]
Weights = tuple[Fraction, ...] | Literal["search"]
Objective = Literal["start", "decay", "settling", "region"]
Found = Tuned | RegionTuned | StartTuned | Infeasible
Report = Callable[[int, int], None]

LOSS = 2e-4
TRIES = 4
LITTLE, ONE = Fraction("0.000001"), Fraction(1)


@of_mission
def tune(
    mission: Mission,
    *,
    bandwidth: float = 20.0,
    objective: Objective = "start",
    rate: float | None = None,
    tilt: float | None = None,
    rotor_thrust: float | None = None,
    weights: Weights = ONES,
    at_least: float | None = None,
    minimum_decay: float | None = None,
) -> Found:
    """Find the best gains within a vehicle's limits that can be proved.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
        Its gains are replaced; its bounds, goal, start and limits of the rotors count.
    bandwidth : float
        Largest attitude bandwidth (k1 k2 + k3 + k4)/m, rad/s.
    objective : {"start", "decay", "settling", "region"}
        Make the proved settling time from the mission's start as short as possible, for every
        vehicle within its tolerances; or the certified decay rate of L as large; or the slowest
        rate of the loop linearised at the goal, as long as the gains are certified; or the
        certified region of attraction, with a slowest rate that is wished for.
    rate : float, optional
        Sampling rate, 1/s: the bandwidth times the period is kept at 0.2 or below. For a start it
        is by default that of the mission's sensors.
    tilt : float, optional
        Largest tilt that may be asked for at the mission's start, rad.
    rotor_thrust : float, optional
        Largest thrust of a rotor, N: the first command keeps each rotor below. By default the
        max_thrust of the mission's rotors; their min_thrust, or 0, is kept too.
    weights : (4,) Fractions, or "search"
        Weights of L; "search" improves gains and weights in turns. Not for a region.
    at_least : float, optional
        Certified decay rate of L that is wished for, 1/s. Not for a region.
    minimum_decay : float, optional
        For a region: least rate of the slowest motion at the goal, 1/s; by default that of the
        mission's own gains.

    Returns
    -------
    Tuned, RegionTuned, StartTuned or Infeasible

    Raises
    ------
    InputError
        If the mission poses no question, or an option is out of range.
    """
    w = weights if isinstance(weights, str) else exact_weights(weights)
    wish = Wish(bandwidth, objective, rate, tilt, rotor_thrust, w, at_least, minimum_decay)
    return gains_for(mission, wish)


@dataclass(frozen=True)
class Wish:
    """What gains are to be designed for: see `tune`.

    Attributes
    ----------
    bandwidth, rate, tilt, rotor_thrust
        Limits, in rad/s, 1/s, rad and N.
    objective : {"start", "decay", "settling", "region"}
    weights : (4,) Fractions, or "search"
    at_least, minimum_decay : float or None
        1/s.
    trade : str or None
        One of `start_trade.TRADED`: what varies along a curve for a start.
    """

    bandwidth: float = 20.0
    objective: Objective = "start"
    rate: float | None = None
    tilt: float | None = None
    rotor_thrust: float | None = None
    weights: Weights = ONES
    at_least: float | None = None
    minimum_decay: float | None = None
    trade: str | None = None

    def __post_init__(self) -> None:
        """Refuse what is out of range, or does not go together."""
        known = get_args(Objective)
        if self.objective not in known:
            reason = f"must be one of {', '.join(known)}, not {self.objective!r}"
            raise InputError("--objective", "", reason)
        rates = (("--at-least", self.at_least), ("--minimum-decay", self.minimum_decay))
        for option, wished in rates:
            if wished is not None and not LEAST <= wished <= ANY:
                words = f"must be a rate from {LEAST:g} to {ANY:g} 1/s, not {wished:g}"
                raise InputError(option, "", words)
        of_place = self.objective in ("region", "start")
        if of_place and (self.at_least is not None or self.weights != ONES):
            option = "--weights" if self.at_least is None else "--at-least"
            other = "name --objective decay or settling"
            reason = f"is about L, so not for --objective {self.objective}: {other}"
            raise InputError(option, "", reason)
        if self.weights != "search":
            exact_weights(self.weights)
        if self.objective != "start" and self.trade is not None:
            raise InputError("--trade", "", f"is for --objective start, not {self.objective}")
        if self.objective != "region" and self.minimum_decay is not None:
            reason = f"is for --objective region, not {self.objective}"
            raise InputError("--minimum-decay", "", reason)

    def limits(self, mission: Mission) -> Limits:
        """Return the limits that are asked for, with those of the mission's rotors by default.

        Parameters
        ----------
        mission : Mission
        """
        (lowest, highest), most = common_limits(mission.rotor_limits), self.rotor_thrust
        if most is None and highest is not None:
            most = float(highest)
        least = None if lowest is None else float(lowest)
        rate, known = self.rate, mission.sensors.control_rate
        if rate is None and self.objective == "start" and known is not None:
            rate = float(known)
        return Limits(self.bandwidth, rate, self.tilt, most, least)


def gains_for(mission: Mission, wish: Wish, progress: Callable[[str], None] | None = None) -> Found:
    """Do what `tune` does, for a wish in one piece.

    Parameters
    ----------
    mission : Mission
    wish : Wish
    progress : callable, optional
        Is told what is being done, for a start.
    """
    limits, at_least, weights = wish.limits(mission), wish.at_least, wish.weights
    least, most = limits.rotors or (0.0, math.inf)
    shares = mission.vehicle.hover_thrusts
    lowest, hover = float(min(shares)), float(max(shares))
    of = f"m g/{len(shares)}" if lowest == hover else "its share in hover"
    if most < hover:
        short = f"{most:g} N is {hover - most:g} N below {of} = {hover:g} N"
        return Infeasible(mission, f"no rotor thrust to hover: the limit of {short}")
    if least > lowest:
        above = f"{least:g} N is {least - lowest:g} N above {of} = {lowest:g} N"
        return Infeasible(mission, f"the rotors cannot hover: their least thrust of {above}")
    if wish.objective == "region":
        return tune_region(mission, limits, wish.minimum_decay)
    if wish.objective == "start":
        return tune_start(mission, limits, progress)
    command = FirstCommand.of(mission)

    def best(objective: RateObjective, weights: tuple[Fraction, ...]) -> Tuned | Infeasible:
        questions = Questions.of(_problem(mission, weights))
        floor = at_least or 0.0
        return _tuned(mission, GainSearch(questions, limits, command, objective, floor), weights)

    given = ONES if weights == "search" else weights
    found = best(wish.objective, given)
    if weights == "search":
        found = _with_better_weights(found, best)
    if isinstance(found, Infeasible) and wish.objective == "settling" and at_least is not None:
        found = best("decay", given)
    if isinstance(found, Infeasible):
        return found
    if at_least is not None and found.verdict.decay_rate < at_least:
        return _short_of(found, limits, at_least, command)
    return replace(found, before=_rate_of_own_gains(mission, weights))


def _with_better_weights(
    found: Tuned | Infeasible,
    best: Callable[[RateObjective, tuple[Fraction, ...]], Tuned | Infeasible],
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
            weights = search_weights(mission) if certify(mission).proved else ONES
        own = certify(mission, weights=weights).proved
    except InputError:
        return None
    return own.decay_rate if own else None


def _is_better(new: Tuned, old: Tuned) -> bool:
    if old.objective == "settling":
        return new.slowest_rate > old.slowest_rate * 1.001
    return new.verdict.decay_rate > old.verdict.decay_rate * Fraction(1001, 1000)


def _problem(mission: Mission, weights: tuple[Fraction, ...]) -> GainProblem:
    """Pose the question with gains that surely pose one: only bounds, goal and weights are used."""
    few = mission.gains.model_copy(update={"k1": LITTLE, "k2": ONE, "k3": ONE, "k4": ONE})
    low = mission.model_copy(update={"gains": few})
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
        words = start_words(search) if value == -np.inf else margin_words(search, value)
        return Infeasible(mission, words)
    for gains in _short(mission, search, best, value):
        tuned = mission.model_copy(update={"gains": gains})
        verdict = certify(tuned, weights=weights).proved
        slowest = slowest_rate(tuned)
        if (
            verdict is not None
            and (search.objective == "decay" or verdict.decay_rate >= search.at_least)
            and slowest > 0  # follows from the proof; held against the loop itself all the same
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
        slowest_rate=slowest,
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
            four = (*triples[k], Fraction(k4[k] or 0))
            yield designed_gains(mission, four, search.limits.fastest)


def _short_of(best: Tuned, limits: Limits, at_least: float, command: FirstCommand) -> Infeasible:
    """Say by how much a wished decay rate is missed, and which bandwidth would do."""
    rate = float(best.verdict.decay_rate)
    questions = Questions.of(gain_problem(best.mission, best.verdict.problem.weights))
    search = GainSearch(questions, limits, command, "decay")
    needed = needed_bandwidth(search, best.mission.gains, rate, at_least)
    binding = [f"{u.name} {u.value:.4g} of {u.limit:.4g} {u.unit}" for u in best.uses if u.binds]
    bounds = f"the bounds of {best.verdict.problem.flow.symbol} and of the thrust"
    words = ", ".join(binding) if binding else f"{bounds} alone"
    if needed is None:
        more = f"no larger bandwidth reaches it (floating point): {bounds} bind"
    else:
        more = f"a bandwidth of about {needed:.3g} rad/s would do"
    reason = (
        f"the largest certified decay rate is {rate:.4g} 1/s, {at_least - rate:.3g} 1/s short of "
        f"{at_least:g} 1/s; what binds: {words}; {more}"
    )
    return Infeasible(best.mission, reason, best, needed)


@of_mission
def pareto(
    mission: Mission,
    count: int,
    wish: Wish | None = None,
    *,
    bandwidth: float | None = None,
    lowest: float | None = None,
    report: Report = lambda done, total: None,
) -> list[tuple[float, Found]]:
    """Return the best certified gains for bandwidths in equal ratios, lowest first.

    With the objective "region", for rates of the slowest motion at the goal instead; with "start",
    for values of what the wish trades, by default bandwidths from a fifth of the highest.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    count : int
        Number of bandwidths, at least 2.
    wish : Wish, optional
        By default the largest certified decay rate of L.
    bandwidth : float, optional
        The highest, rad/s; by default that of the wish.
    lowest : float, optional
        The lowest, rad/s; by default a twentieth of the highest.
    report : callable
        Called with how many are done, of how many.
    """
    if not 2 <= count <= 1000:
        raise InputError("--pareto", "", f"must be from 2 to 1000 bandwidths, not {count}")
    wish = wish or Wish(objective="decay")
    highest = wish.bandwidth if bandwidth is None else bandwidth
    limits = replace(wish, bandwidth=highest).limits(mission)
    if wish.objective == "start":
        return list(start_trade(mission, wish.trade or "bandwidth", count, limits, report))
    if wish.objective == "region":
        return list(region_pareto(mission, count, limits, wish.minimum_decay, report))
    first = highest / 20 if lowest is None else lowest
    if not 0 < first <= highest:
        reason = f"must be above 0 and at most the highest, {highest:g} rad/s, not {first:g}"
        raise InputError("--lowest", "", reason)
    points = []
    for i, b in enumerate(np.geomspace(first, highest, count)):
        b = float(f"{b:.4g}") if i < count - 1 else highest
        found = gains_for(mission, replace(wish, bandwidth=b))
        points.append((b, found))
        report(i + 1, count)
    return points
