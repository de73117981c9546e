"""Gains with which every vehicle within tolerance has soon settled, from the mission's start.

The search is in floating point (`start_search`). Its winner is rounded to short decimals, and only
then is it proved, exactly, that the errors fall exponentially from the start. Where no gains are
found, changes of the mission are looked for with which some are, and each that is told of is proved
in the same way (`start_advice`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.closeness import closest, is_shown
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.proof import converge, require_question, settling
from hoverproof.certification.exponential.question import SETTLED
from hoverproof.certification.exponential.sooner import FAILED, OUTSIDE
from hoverproof.certification.exponential.verdict import Exponential, Settling
from hoverproof.design.limits import BINDS, Limits, Use, designed_gains, uses
from hoverproof.design.outcome import Infeasible, StartTuned
from hoverproof.design.proved_and_flown import near_goal_from, why_longer
from hoverproof.design.start_advice import scaled, what_helps
from hoverproof.design.start_rounding import rounded
from hoverproof.design.start_search import SPARED, Point, StartSearch
from hoverproof.mission.sections import Mission
from hoverproof.simulation.flight import flown
from hoverproof.simulation.timing import Timing

Progress = Callable[[str], None]
NARROWED, PARTS, SPARE = 3, (0.85, 0.7, 0.55, 0.4), 1e-6
"""How often a smaller d is looked for, and which parts of the way from the least d to the last."""
CLOSER = 30
"""So many programs, at most, where the ball of J is made closer."""
LONGER = 4
"""Times the proved time is flown: gains that were replaced may settle later."""
LATER = 1.02
"""Times what was searched: a proof that says so late has taken a wider ball of J."""
PROOFS = 2
"""So many sets of gains, each with more digits than the last, are tried to be proved."""


def tune_start(
    mission: Mission, limits: Limits, progress: Progress | None = None
) -> StartTuned | Infeasible:
    """Find the gains with the shortest proved settling time from the mission's start.

    Parameters
    ----------
    mission : Mission
        Its gains are replaced; its start, goal and tolerances, what its camera sees and its limits
        count.
    limits : Limits
    progress : callable, optional
        Is told what is being done.

    Returns
    -------
    StartTuned or Infeasible

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    tell = progress or (lambda text: None)
    require_question(mission, [Start.of(mission)])
    found = attempt(mission, limits, tell)
    if isinstance(found, StartTuned):
        return found

    def proved(changed: Mission, doing: Progress) -> Exponential | None:
        tried = searched(changed, limits, doing)
        return None if isinstance(tried, Failed) else tried.verdict

    def search(changed: Mission) -> StartSearch:
        return StartSearch.of(changed, limits)

    advice = what_helps(mission, found.point, search, proved, tell)
    return Infeasible(mission, found.reason, advice=advice)


@dataclass(frozen=True)
class Failed:
    """No gains.

    Attributes
    ----------
    reason : str
        Why.
    point : Point or None
        What comes nearest.
    """

    reason: str
    point: Point | None


class Proved(NamedTuple):
    """Gains that are proved.

    Attributes
    ----------
    verdict : Exponential
        With the mission that has them.
    search : StartSearch
    point : Point
        What was rounded to them.
    """

    verdict: Exponential
    search: StartSearch
    point: Point


def attempt(mission: Mission, limits: Limits, tell: Progress) -> StartTuned | Failed:
    """Search for gains, prove what is found, and fly it.

    Parameters
    ----------
    mission : Mission
    limits : Limits
    tell : callable
        Is told what is being done.
    """
    found = searched(mission, limits, tell)
    tell("searching for weights for the mission's own gains")
    before = settling(mission)
    if before is not None and _is_sooner(before, found):  # else there is nothing to search on for
        own = StartSearch.of(mission, limits)
        found = _from_own(own, found, tell) if own.keeps_limits else found
    return found if isinstance(found, Failed) else _tuned(found, before, tell)


def _is_sooner(settled: Settling, found: Proved | Failed | str) -> bool:
    """Tell whether something settles sooner, or nearer, than what is found."""
    if not isinstance(found, Proved):
        return True
    other = found.verdict.settling
    return (settled.radius, settled.time) < (other.radius, other.time)


def _from_own(search: StartSearch, found: Proved | Failed, tell: Progress) -> Proved | Failed:
    """Search on from the mission's own gains, as nothing was found that settles as soon."""
    near = search.from_own()
    if near is None:
        return found
    tell("searching for gains from the mission's own")
    other = _closely_proved(search, search.descend(*near), tell)
    if isinstance(other, Proved) and _is_sooner(other.verdict.settling, found):
        found = other
    verdict = converge(search.mission, progress=tell)
    if isinstance(verdict, Exponential) and _is_sooner(verdict.settling, found):
        found = Proved(verdict, search, search.point(*near))
    return found


def searched(mission: Mission, limits: Limits, tell: Progress) -> Proved | Failed:
    """Search for gains, and prove what is found.

    Parameters
    ----------
    mission : Mission
    limits : Limits
    tell : callable
        Is told what is being done.
    """
    search = StartSearch.of(mission, limits)
    point = search.run(tell)
    for share in SETTLED[1:] if search.whole.vehicles.is_shaken else ():
        if point is None or point.cost >= OUTSIDE:
            search = replace(search, whole=replace(search.whole, settled=share))
            point = search.run(tell)
    reason = why_not(search, point) if point is None or point.cost >= OUTSIDE else ""
    for _ in range(NARROWED if not reason else 0):
        assert point is not None
        found = _closely_proved(search, point, tell)
        if isinstance(found, Proved):
            return found
        reason = f"the best gains found are not proved: {found}"
        tell("looking for a domain that takes fewer cells")
        narrower = _narrower(search, point) if _takes_long(found) else None
        if narrower is None:
            break
        search, point = narrower
    return Failed(reason, point)


def _narrower(search: StartSearch, point: Point) -> tuple[StartSearch, Point] | None:
    """Search on with a smaller d, over whose domain bounds of J are shown with few cells."""
    low, scene = search.ends[0], search.whole.scene
    for wider, beyond in SPARED:
        for part in PARTS:
            d = low * (math.exp(point.z[4]) / low) ** part
            whole = replace(
                search.whole, wider=wider, beyond=beyond, highest=d * (1 + SPARE) / scene.wanted
            )
            if is_shown(whole, search.mission.target, d):
                new = replace(search, whole=whole)
                z = np.minimum(point.z, new.highest)
                at = new.value(z)
                found = new.point(z, None) if at is None else new.descend(z, at)
                if found.cost < OUTSIDE:
                    return new, found
                break
    return None


def _closely_proved(search: StartSearch, point: Point, tell: Progress) -> Proved | str:
    """Prove gains with as close a ball of J as few cells show, or else with the ball as it is."""
    tell("searching for gains with closer bounds of J")
    closer = _closer(search, point)
    found = "" if closer is None else _proved(*closer, tell)
    if not isinstance(found, Proved):
        found = _proved(search, point, tell)
    wider = _as_proved(search, found) if isinstance(found, Proved) else None
    other = "" if wider is None else _proved(*wider, tell)
    better = isinstance(other, Proved) and _is_sooner(other.verdict.settling, found)
    return other if better else found


def _as_proved(search: StartSearch, found: Proved) -> tuple[StartSearch, Point] | None:
    """Search on with a wider ball of J where the proof had to take one; None if it did not."""
    if float(found.verdict.settling.time) < LATER * math.exp(found.point.cost):
        return None
    wider, beyond = SPARED[-1]
    new = replace(search, whole=replace(search.whole, wider=wider, beyond=beyond))
    at = new.value(found.point.z)
    if at is None:
        return None
    point = new.descend(found.point.z, at)
    return (new, point) if point.cost < OUTSIDE else None


def _closer(search: StartSearch, point: Point) -> tuple[StartSearch, Point] | None:
    """Search on with the closest ball of J that few cells show; None if nothing is sooner."""
    whole = closest(search.whole, search.mission.target, math.exp(point.z[4]))
    new = None if whole is None else replace(search, whole=whole)
    at = None if new is None else new.value(point.z)
    if new is None or at is None:
        return None
    found = new.descend(point.z, at, CLOSER)
    return (new, found) if found.cost < point.cost else None


def _proved(search: StartSearch, point: Point, tell: Progress) -> Proved | str:
    """Round gains and prove them; return why not if they are not."""
    reason = "none of few digits are near them"
    for _, (four, near) in zip(range(PROOFS), rounded(search, point), strict=False):
        tuned = search.mission.model_copy(
            update={"gains": designed_gains(search.mission, four, _fast(search, near))}
        )
        verdict = converge(tuned, progress=tell)
        if isinstance(verdict, Exponential):
            return Proved(verdict, search, point)
        reason = verdict.reason
        tell(f"not proved: {reason}")
        if _takes_long(reason):
            break
    return reason


def _takes_long(reason: str) -> bool:
    """Tell whether what is not proved takes more cells, or a longer check, than is allowed."""
    return "cells" in reason or "too long" in reason


def _tuned(found: Proved, before: Settling | None, tell: Progress) -> StartTuned:
    """Put beside what is proved how the own gains do, and how both fly."""
    verdict, search, point = found
    tuned = verdict.mission
    tell("flying")
    time, radius = float(verdict.settling.time), float(verdict.settling.radius)
    flight, flight_before = (_flown(each, radius, time) for each in (tuned, search.mission))
    return StartTuned(
        mission=tuned,
        verdict=verdict,
        before=before,
        estimate=math.exp(point.cost),
        flown=flight,
        flown_before=flight_before,
        flown_for=LONGER * time,
        why_longer=why_longer(verdict, flight),
        uses=list(_uses(found)),
    )


def _flown(mission: Mission, radius: float, time: float) -> float | None:
    """Return when a mission has settled in a flight, s, a longer one if that is too short."""
    flight = settled_in_flight(mission, radius, time)
    return settled_in_flight(mission, radius, LONGER * time) if flight is None else flight


def _uses(found: Proved) -> Iterator[Use]:
    """Yield how much is used of each limit, and whether the search had come to it."""
    verdict, search, point = found
    four = [Fraction(float(k)) for k in np.exp(point.z[:4])]
    gains = designed_gains(search.mission, four, _fast(search, point))
    exact = search.mission.model_copy(update={"gains": gains})
    each = (uses(search.limits, search.command, m) for m in (verdict.mission, exact))
    for use, before in zip(*each, strict=True):
        yield replace(use, reached=before.binds)
    half, seen, at = search.whole.half_angle, verdict.field_of_view, search.value(point.z)
    if half is not None and seen is not None:
        name = "angle to the axis under which all is seen"
        reached = at is not None and at.over[-1] > -BINDS
        yield Use(name, float(seen), half, "rad", "camera.half_angle", reached=bool(reached))


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
    flight = flown(mission, Timing(duration=time))
    if flight.attrs["outcome"] != "flown":
        return None
    return near_goal_from(mission, flight, radius)


def why_not(search: StartSearch, point: Point | None) -> str:
    """Say what was searched, what stands in the way, and by how much.

    Parameters
    ----------
    search : StartSearch
    point : Point or None
        The best that was found.
    """
    return "; ".join(_why_not(search, point))


def _why_not(search: StartSearch, point: Point | None) -> Iterator[str]:
    low, high = search.ends
    mission = search.mission
    if mission.law.feature == "centroid":
        yield ill_conditioned(mission)
        yield "--objective decay asks for the decay of L alone, whatever the start"
    if not low < high:
        most = search.whole.known
        away = float(np.sqrt(2 * search.whole.terms()[:, 0].max()))
        yield (
            f"no gains were searched: at the start the feature is {away:.3g} off its goal, and "
            f"the search bounds {search.whole.scene.flow.symbol} up to {most:.3g}"
        )
        return
    fours = np.exp(np.array(search.tried)[:, :4])
    sets, fast = len(np.unique(fours, axis=0)), fours[:, 3] / float(mission.vehicle.mass)
    searched = (
        f"{sets} sets of gains were searched, k4/m from {fast.min():.3g} to {fast.max():.3g} 1/s"
    )
    if point is None or point.cost >= FAILED:
        yield f"{searched}, and no weights were found for any of them"
        return
    at = search.value(point.z)
    assert at is not None
    yield f"{searched}: none of them holds the start; with the best, {search.short(at)}"
    names = search.held_to.names()
    binding = [name for name, over in zip(names, at.over[1:], strict=True) if over > -BINDS]
    yield f"what binds: {', '.join(['the inequality of Ψ', *binding])}"


def ill_conditioned(mission: Mission) -> str:
    """Say how much less a change of height is seen than one sideways, with the centroid.

    Parameters
    ----------
    mission : Mission
    """
    scene = Scene.of(mission)
    values = np.linalg.eigvalsh(scene.slopes(scene.goal[None])[0])
    better = "" if scaled(mission) is None else "; the scaled feature does not have that factor"
    return (
        f"with the centroid, height is ill-conditioned: the eigenvalues of Q at the goal differ by "
        f"a factor of {values[-1] / values[0]:.3g}{better}"
    )
