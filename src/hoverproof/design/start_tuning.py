"""Gains with which every vehicle within tolerance has soon settled, from the mission's start.

The search is in floating point (`start_search`). Its winner is rounded to short decimals, and only
then is it proved, exactly, that the errors fall exponentially from the start.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from hoverproof.certification.exponential.proof import converge
from hoverproof.certification.exponential.search import OUTSIDE
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.design.limits import Limits, designed_gains, uses
from hoverproof.design.outcome import Infeasible, StartTuned
from hoverproof.design.start_search import RATES, SCALES, Point, StartSearch
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.simulation.flight import simulate

Progress = Callable[[str], None]
TOLERANCES = "thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate"
HALVINGS = 5
PROOFS = 2
"""So many sets of gains, each with more digits than the last, are tried to be proved."""


def tune_start(
    mission: Mission, limits: Limits, progress: Progress | None = None
) -> StartTuned | Infeasible:
    """Find the gains with the shortest proved settling time from the mission's start.

    Parameters
    ----------
    mission : Mission
        Its gains are replaced; its start, goal and tolerances count.
    limits : Limits
    progress : callable, optional
        Is told what is being done.

    Returns
    -------
    StartTuned or Infeasible

    Raises
    ------
    InputError
        If the mission is not of the scaled feature, the goal is not axial, or it poses no question.
    """
    tell = progress or (lambda text: None)
    if mission.law.feature != "scaled":
        raise InputError(
            mission.source,
            "law.feature",
            f"is {mission.law.feature}: gains are searched by the start for the scaled centroid; "
            'write feature = "scaled" in [law], or take --objective region',
        )
    search = StartSearch.of(mission, limits)
    point = search.run(tell)
    if point is None or point.cost >= OUTSIDE:
        return Infeasible(mission, why_not(search, point))
    reason = ""
    for _, (four, near) in zip(range(PROOFS), search.short(point), strict=False):
        tuned = mission.model_copy(
            update={"gains": designed_gains(mission, four, _fast(search, near))}
        )
        verdict = converge(tuned, progress=tell, near=near.set_out)
        if isinstance(verdict, Exponential):
            tell("flying")
            time = float(verdict.settling.time)
            return StartTuned(
                mission=tuned,
                verdict=verdict,
                before=search.settled_before,
                estimate=float(np.exp(point.cost)),
                flown=settled_in_flight(tuned, float(verdict.settling.radius), time),
                uses=uses(limits, search.command, tuned),
            )
        reason = verdict.reason
    return Infeasible(mission, f"the best gains found are not proved: {reason}")


def _fast(search: StartSearch, point: Point) -> float:
    k1, k2, k3, k4 = np.exp(point.z[:4])
    return float((k1 * k2 + k3 + k4) / search.whole.vehicles.design.mass)


def settled_in_flight(mission: Mission, radius: float, time: float) -> float | None:
    """Return when a mission that is flown as it says is near its goal for good, s.

    None if it is not at the end.

    Parameters
    ----------
    mission : Mission
    radius : float
        About the hover point, m.
    time : float
        How long it is flown, s.
    """
    flight = simulate(mission, duration=time)
    goal = np.array([float(c) for c in hover_goal(mission).position])
    far = np.linalg.norm(flight.position.values - goal, axis=1) > radius
    if flight.attrs["outcome"] != "flown" or far[-1]:
        return None
    return float(flight.time.values[np.flatnonzero(far)[-1] + 1]) if far.any() else 0.0


def why_not(search: StartSearch, point: Point | None) -> str:
    """Say what stands in the way, by how much, and what would help.

    Parameters
    ----------
    search : StartSearch
    point : Point or None
        The best that was found.
    """
    low, high = search.whole.ends
    wanted = search.whole.scene.wanted
    if not low < high:
        most = search.whole.highest * wanted
        away = float(np.sqrt(2 * search.whole.terms()[:, 0].max()))
        return (
            f"no gains were searched: at the start the feature is {away:.3g} from the one wanted, "
            f"and {most:.3g} is the most of which J is bounded; {_nearer(search, most / away)}"
        )
    if point is None:
        return (
            "no weights satisfy the inequality for any of the gains from which the search sets "
            f"out, whose k4/m is {SCALES[-1]:g} to 1 times what suits latency, force and "
            f"bandwidth, with j k1/m, k1 k2/m, k3/m and k4/m as {RATES}; would help: smaller "
            "tolerances, a start nearer to the goal"
        )
    fill = float(np.exp(point.cost - OUTSIDE))
    reason = (
        f"no gains were found that hold the start: with the best of those searched, Ψ there is "
        f"{fill:.3g} times the level; {_nearer(search, 0.98 / np.sqrt(fill))}"
    )
    return "; ".join([reason, *_smaller(search, point)])


def _nearer(search: StartSearch, share: float) -> str:
    """Say how much nearer a start has its feature that share of as far from the one wanted."""
    scene = search.whole.scene
    start = np.array([float(c) for c in search.mission.start.position])
    parts = np.linspace(1, 0, 200)
    places = scene.goal + parts[:, None] * (start - scene.goal)
    far = np.linalg.norm(scene.offset(places), axis=1)
    inside = parts[int(np.argmax(far <= share * far[0]))]
    nearer = (1 - inside) * float(np.linalg.norm(start - scene.goal))
    return f"would help: a start about {nearer:.2g} m nearer to the goal"


def _smaller(search: StartSearch, point: Point) -> Iterator[str]:
    """Yield each tolerance that would help alone, and how small it would have to be."""
    vehicles = search.whole.vehicles

    def holds(name: str, value: float) -> bool:
        whole = replace(search.whole, vehicles=vehicles.allowing(name, value))
        return replace(search, whole=whole).at(point.z)[0] < OUTSIDE

    for name in TOLERANCES:
        most = getattr(vehicles, name)
        if not most or not holds(name, 0.0):
            continue
        low, high = 0.0, most
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if holds(name, middle) else (low, middle)
        yield f"would help: uncertainty.{name} of {low:.2g} in place of {most:.3g}"
