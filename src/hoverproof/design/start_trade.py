"""What a tolerance, the bandwidth or a farther start costs in proved settling time.

For each value of what is traded gains are searched and proved as `tune` does for a mission that has
that value. A point is a proof of its own: nothing is drawn from one to the next.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.design.limits import Limits
from hoverproof.design.outcome import Infeasible, StartTuned
from hoverproof.design.start_tuning import Failed, attempt
from hoverproof.errors import InputError
from hoverproof.mission.reading import with_tolerance
from hoverproof.mission.sections import Mission
from hoverproof.mission.tolerances import UNITS
from hoverproof.plant.goal import hover_goal

Report = Callable[[int, int], None]
TRADED = {**{str(k): u for k, u in UNITS.items()}, "bandwidth": "rad/s", "distance": "m"}
"""What can be traded, tolerances first, and its unit; none of a share."""
SLOWEST = 5
"""The highest bandwidth over the lowest."""
NEAREST, FARTHEST = 0.5, 1.5
"""The nearest start and the farthest, as shares of the mission's distance."""
LARGEST, MOST_SHARE = 2, 0.9
"""The largest tolerance over the mission's, and what a share is at most."""
DIGITS = 4


def start_trade(
    mission: Mission,
    name: str,
    count: int,
    limits: Limits,
    report: Report = lambda done, total: None,
) -> list[tuple[float, StartTuned | Infeasible]]:
    """Return the gains with the shortest proved settling time for values of what is traded.

    Parameters
    ----------
    mission : Mission
    name : str
        One of `TRADED`.
    count : int
        Number of values.
    limits : Limits
        With the highest bandwidth.
    report : callable
        Called with how many are done, of how many.

    Raises
    ------
    InputError
        If that cannot be traded.
    """
    points: list[tuple[float, StartTuned | Infeasible]] = []
    for value in values_of(mission, name, count, limits):
        try:
            found: StartTuned | Failed = attempt(
                *changed(mission, name, value, limits), lambda text: None
            )
        except InputError as error:  # a mission that poses no question
            found = Failed(str(error), None)
        points.append(
            (value, Infeasible(mission, found.reason) if isinstance(found, Failed) else found)
        )
        report(len(points), count)
    return points


def values_of(mission: Mission, name: str, count: int, limits: Limits) -> list[float]:
    """Return the values of what is traded, ascending, in its unit.

    Parameters
    ----------
    mission, name, limits
        See `start_trade`, also for what is raised.
    count : int
        A bare number.
    """
    if name not in TRADED:
        raise InputError("--trade", "", f"must be one of {', '.join(TRADED)}, not {name!r}")
    if name == "bandwidth":
        values = np.geomspace(limits.bandwidth / SLOWEST, limits.bandwidth, count)
    elif name == "distance":
        away = value_of(mission, name) or 0.0
        if not away:
            raise InputError("--trade", "", "distance cannot vary: the start is the goal")
        values = np.linspace(NEAREST * away, FARTHEST * away, count)
    else:
        most = LARGEST * (value_of(mission, name) or 0.0)
        if not most:
            words = f"{name} cannot vary about 0: --set uncertainty.{name}=… says about what"
            raise InputError("--trade", "", words)
        values = np.linspace(0, min(most, MOST_SHARE) if not TRADED[name] else most, count)
    return [float(f"{value:.{DIGITS}g}") for value in values]


def changed(mission: Mission, name: str, value: float, limits: Limits) -> tuple[Mission, Limits]:
    """Return a mission and limits with a value of what is traded.

    Parameters
    ----------
    mission, name, limits
        See `start_trade`.
    value : float
        A bare number in its unit.

    Raises
    ------
    InputError
        If a mission cannot have it.
    """
    if name == "bandwidth":
        return mission, replace(limits, bandwidth=value)
    if name != "distance":
        return with_tolerance(mission, name, Fraction(repr(value))), limits
    way, goal = _way(mission), np.array([float(c) for c in hover_goal(mission).position])
    place = goal + way * value / np.linalg.norm(way)
    exact = tuple(Fraction(f"{c:.{DIGITS}g}") for c in place)
    return mission.model_copy(
        update={"start": mission.start.model_copy(update={"position": exact})}
    ), limits


def value_of(mission: Mission, name: str) -> float | None:
    """Return what a mission has of what is traded, in its unit; None of the bandwidth.

    Parameters
    ----------
    mission, name
        See `start_trade`.
    """
    if name == "bandwidth":
        return None
    away = name == "distance"
    return float(np.linalg.norm(_way(mission)) if away else getattr(mission.uncertainty, name))


def _way(mission: Mission) -> NDArray[np.float64]:
    goal = hover_goal(mission).position
    return np.array([float(s - g) for s, g in zip(mission.start.position, goal, strict=True)])
