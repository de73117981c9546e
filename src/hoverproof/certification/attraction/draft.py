"""Round what a search found to the exact numbers and the hints of a certificate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import binary_above, binary_below, decimal_above, decimal_below
from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.search import Found, reach_along
from hoverproof.certification.attraction.sinking import Sinking
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.tolerant import TolerantLoop, posed
from hoverproof.certification.attraction.trees import Set
from hoverproof.certification.problem import force_bound
from hoverproof.certification.robust import margins
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal

Array = NDArray[np.float64]
BITS = 64
DIGITS = 6
SPARE = 1e-12
"""By what share an enclosure is wider than the number in floating point."""


class NotShown(Exception):
    """Something does not hold after rounding, or takes more cells than the checker takes."""


def force_within(mission: Mission, weights: Sequence[Fraction], level: Fraction) -> Fraction:
    """Return the bound of |F| where Λ is at most a level, N, from above.

    Parameters
    ----------
    mission : Mission
    weights : (3,)
        a2, a3, a4, m.
    level : Fraction
        ℓ, m.
    """
    gains = mission.gains
    stiffness = gains.k1**2 * gains.k2 / mission.vehicle.mass
    return force_bound(stiffness, level, *weights[:2])


def draft(mission: Mission, found: Found, starts: Sequence[Start], share: float) -> dict[str, Any]:
    """Return the parts of a certificate of a region of attraction, exact.

    Parameters
    ----------
    mission : Mission
    found : Found
    starts : sequence of Start
        Sets of states to be inside, beside the hovers about the goal.
    share : float
        Of the reach of these hovers, what is claimed; dimensionless.

    Raises
    ------
    NotShown
        If the checker would not be shown what it asks for.
    """
    potential, loop = posed(mission)
    height = None
    if found.bottom is not None:
        height = mission.height_of_target - Fraction(f"{found.bottom:.6f}")
    if isinstance(loop, TolerantLoop):
        numbers = _tolerant_numbers(mission, found, loop)
    else:
        numbers = _numbers(mission, found, loop)
    region = Set(
        potential=potential,
        loop=loop,
        weights=numbers.weighed,
        level=float(numbers.level),
        largest=float(numbers.hints["largest_eigenvalue"]),
        force=float(force_within(mission, numbers.weights, numbers.level)),
        bottom=None if height is None else float(mission.height_of_target - height),
    )
    above = mission.height_of_target - hover_goal(mission).position[2]
    reach = _reach(region, share, None if height is None else above - height)
    claim = {
        "level": numbers.level,
        "rate": numbers.rate,
        "barrier_height": height,
        "reach": reach,
        "starts": [start.content() for start in starts],
    }
    return {
        "weights": numbers.weights,
        **numbers.more,
        "hover": list(hover_goal(mission).position),
        "enclosures": numbers.hints,
        "multipliers": numbers.multipliers,
        "claim": claim,
        "trees": _trees(mission, region, reach, starts),
    }


@dataclass(frozen=True)
class Numbers:
    """The numbers by which Λ, or Ψ, is shown to fall.

    Attributes
    ----------
    weights : (3,)
        a2, a3, a4, m.
    weighed : (..., k)
        What the terms of a start are multiplied by beside W, rounded.
    level, rate : Fraction
        ℓ, m, and ε.
    multipliers : list or dict
    hints : dict
        Bounds that follow from the level, rounded outward.
    more : dict
        What else is weighed.
    """

    weights: list[Fraction]
    weighed: Array
    level: Fraction
    rate: Fraction
    multipliers: Any
    hints: dict[str, Any]
    more: dict[str, Any]


def _require_lift(loop: Loop, force: Fraction) -> None:
    if float(force) >= loop.largest_force:
        raise NotShown("the thrust reaches the singularity T = c q3*")


def _goal(mission: Mission) -> list[Fraction]:
    """Return the interval of q3*, rounded outward."""
    low, high = hover_goal(mission).centroid[2]
    return [binary_below(low, BITS), binary_above(high, BITS)]


def _numbers(mission: Mission, found: Found, loop: Loop) -> Numbers:
    """Round weights and level, and find rate and multipliers."""
    weights = [decimal_below(float(w), 4) for w in found.weights]
    level = decimal_below(found.level, DIGITS)
    exact_force = force_within(mission, weights, level)
    _require_lift(loop, exact_force)
    force, goal, sizes = float(exact_force), _goal(mission), np.array(weights, float)
    loop = Loop.of(mission, float(goal[0]))
    ends = loop.factor(force)
    tilt = decimal_above(loop.tilt(force)[2] * (1 + SPARE), 9)
    largest = decimal_above(found.largest, 5)
    factor = [decimal_below(ends[0] * (1 - SPARE), 12), decimal_above(ends[1] * (1 + SPARE), 12)]
    rates, multipliers = [], []
    for f in factor:
        corner = loop.corner(float(f), float(tilt), float(largest)).at([0, 1, *sizes])
        least, tau = margins(corner)
        rates.append(float(least))
        multipliers.append(decimal_below(float(tau[0]), DIGITS))
    hints = {"goal": goal, "factor": factor, "tilt": tilt, "largest_eigenvalue": largest}
    return Numbers(weights, sizes, level, _rate(min(rates)), multipliers, hints, {})


def _tolerant_numbers(mission: Mission, found: Found, loop: TolerantLoop) -> Numbers:
    """Round what was found for every vehicle within tolerance, and find the rate."""
    r, largest = loop.rounded(found), decimal_above(found.largest, 5)
    force = force_within(mission, r.weights, r.level)
    _require_lift(loop, force)
    tilt = decimal_above(loop.tilt(float(force))[2] * (1 + SPARE), 9)
    slope, *terms = r.multipliers
    lag = None if r.lag is None else dict(zip(("torque", "thrust"), r.lag, strict=True))
    return Numbers(
        weights=list(r.weights),
        weighed=r.weighed(float(largest)),
        level=r.level,
        rate=_rate(loop.rate(r, float(largest))),
        multipliers={"slope": slope, "terms": terms},
        hints={"goal": _goal(mission), "tilt": tilt, "largest_eigenvalue": largest},
        more={"lag": lag, "memory": r.memory},
    )


def _rate(least: float) -> Fraction:
    if least <= 0:
        raise NotShown("the inequality fails after rounding")
    return decimal_below(least * (1 - 1e-6), DIGITS)


def _reach(region: Set, share: float, room: Fraction | None) -> dict[str, Fraction]:
    """Return how far hovers are claimed to be inside: at the height of the goal, up and down."""

    def reach(*directions: tuple[float, float, float]) -> Fraction:
        each = reach_along(region.potential, np.array(directions), region.weights, region.level)
        return decimal_below(float(each.min()) * share, 3)

    down = reach((0, 0, 1))
    if room is not None:  # the barrier is exact: nothing of that needs to be given away
        down = min(down, decimal_below(room, 3))
    turns = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    around = [(float(np.cos(t)), float(np.sin(t)), 0.0) for t in turns]
    return {"sideways": reach(*around), "up": reach((0, 0, -1)), "down": down}


def _trees(
    mission: Mission, region: Set, reach: dict[str, Fraction], starts: Sequence[Start]
) -> dict[str, Any]:
    """Halve positions, plane and starts."""
    x, y, z = hover_goal(mission).position
    side, up, down = reach["sideways"], reach["up"], reach["down"]
    disc = Start(((x - side, x + side), (y - side, y + side), (z, z)))
    line = Start(((x, x), (y, y), (z - up, z + down)))
    trees = [region.start(mission, disc, float(side))]
    trees += [region.start(mission, start) for start in (line, *starts)]
    barrier = region.barrier(Sinking.of(mission, [disc, line, *starts]))
    if region.bottom is not None and barrier is None:
        raise NotShown("the barrier is not shown to hold")
    positions = region.positions()
    if positions is None:
        raise NotShown("the largest eigenvalue of Q is not shown to be bounded")
    if None in trees:
        raise NotShown("a start is not shown to have Λ <= level")
    return {"positions": positions, "barrier": barrier, "starts": trees}
