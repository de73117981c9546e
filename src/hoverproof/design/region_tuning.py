"""Gains with the largest certified region of attraction that still settle fast enough.

Slower gains have a larger region, so the slowest motion at the goal is kept at a wished rate. The
search is in floating point (`gain_search`). Its winner is rounded to short decimals, and only then
is its region proved, exactly.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np

from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.gains import certify
from hoverproof.design.limits import (
    Limits,
    Use,
    uses,
)
from hoverproof.design.outcome import Infeasible, RegionTuned
from hoverproof.design.region_search import GainRegionSearch
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.linearised import slowest_rate

Report = Callable[[int, int], None]


def tune_region(
    mission: Mission,
    limits: Limits,
    minimum_decay: float | None = None,
    before: Callable[[], Attraction | None] | None = None,
) -> RegionTuned | Infeasible:
    """Find the gains with the largest certified ball of hovers about the goal.

    Parameters
    ----------
    mission : Mission
        Its gains are replaced; its goal and start count.
    limits : Limits
    minimum_decay : float, optional
        Least decay rate of the slowest motion at the goal, 1/s; by default that of the mission's
        own gains.
    before : callable, optional
        Gives the region of the mission's own gains, where it is known.

    Returns
    -------
    RegionTuned or Infeasible

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    own = slowest_rate(mission)
    floor = own if minimum_decay is None else minimum_decay
    if floor <= 0:
        reason = "the mission's own gains do not settle: give a rate in 1/s"
        raise InputError("--minimum-decay", "", reason)
    search = GainRegionSearch.of(mission, limits, floor)
    point = search.run()
    if point is None:
        return Infeasible(mission, _why_not(search))
    for gains in search.short(point):
        tuned = mission.model_copy(update={"gains": gains})
        region = attraction(tuned, objective="radius", barrier=False).proved
        if region is not None:
            break
    else:
        return Infeasible(mission, "the best gains found are too near the edge to be proved")
    slowest = slowest_rate(tuned)
    wished = Use("slowest motion at the goal", slowest, floor, "1/s", least=True)
    return RegionTuned(
        mission=tuned,
        region=region,
        before=before() if before else _own_region(mission),
        slowest_rate=slowest,
        slowest_rate_before=own,
        decay_rate=_decay_rate(tuned),
        decay_rate_before=_decay_rate(mission),
        uses=[wished, *uses(limits, search.command, tuned)],
    )


def _own_region(mission: Mission) -> Attraction | None:
    try:
        return attraction(mission, objective="radius", barrier=False).proved
    except InputError:
        return None


def _decay_rate(mission: Mission) -> Fraction | None:
    try:
        proved = certify(mission).proved
    except InputError:
        return None
    return proved.decay_rate if proved else None


def fastest_with_region(search: GainRegionSearch) -> float | None:
    """Return about the fastest rate of the slowest motion that leaves a region, 1/s.

    None if there is none even a thousand times slower than the limits allow.

    Parameters
    ----------
    search : GainRegionSearch
        Its floor does not count.
    """
    size = search.potential.height(float(search.potential.goal[2])) / 4

    def possible(floor: float) -> bool:
        return replace(search, floor=floor).first(size, enough=0.0).cost < 0

    high = search.fastest()
    low = high / 2
    while low > high / 1e3 and not possible(low):
        low /= 2
    if not possible(low):
        return None
    high = min(2 * low, high)
    while high > low * 1.1:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if possible(middle) else (low, middle)
    return low


def _why_not(search: GainRegionSearch) -> str:
    fastest = search.fastest()
    limit = f"a bandwidth of {search.limits.fastest:g} rad/s"
    if fastest < search.floor:
        return (
            f"no gains settle as fast as {search.floor:.4g} 1/s at the goal: with {limit} the "
            f"fastest found is {fastest:.4g} 1/s, {search.floor - fastest:.3g} 1/s short"
        )
    possible = fastest_with_region(search)
    if possible is None:
        return f"no region of attraction was found for any gains with {limit}"
    return (
        f"no region of attraction was found with a slowest motion of {search.floor:.4g} 1/s and "
        f"{limit}; what binds is the inequality of Λ; about {possible:.3g} 1/s leaves a region "
        f"(--minimum-decay {float(decimal_below(possible, 2)):g})"
    )


def region_pareto(
    mission: Mission,
    count: int,
    limits: Limits,
    minimum_decay: float | None = None,
    report: Report = lambda done, total: None,
) -> list[tuple[float, RegionTuned | Infeasible]]:
    """Return the largest regions for rates of the slowest motion in equal ratios, slowest first.

    Parameters
    ----------
    mission : Mission
    count : int
        Number of rates, at least 2.
    limits : Limits
    minimum_decay : float, optional
        The lowest rate, 1/s; by default that of the mission's own gains, or a tenth of the
        fastest with a region if that is less.
    report : callable
        Called with how many are done, of how many.

    Returns
    -------
    list of (rate in 1/s, RegionTuned or Infeasible)
        The last is about the fastest that leaves a region.
    """
    search = GainRegionSearch.of(mission, limits, 1.0)
    fastest = fastest_with_region(search)
    lowest = minimum_decay
    if lowest is None and fastest is not None:
        lowest = min(slowest_rate(mission), fastest / 10)
    if fastest is None or lowest is None or lowest >= fastest:
        floor = lowest or slowest_rate(mission)
        return [(floor, Infeasible(mission, _why_not(replace(search, floor=floor))))]
    points, before = [], cache(lambda: _own_region(mission))
    for i, rate in enumerate(np.geomspace(lowest, fastest, count)):
        floor = float(f"{rate:.3g}") if i or minimum_decay is None else rate
        points.append((floor, tune_region(mission, limits, floor, before)))
        report(i + 1, count)
    return points
