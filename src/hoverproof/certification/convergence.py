"""Decide from where the vehicle converges to its goal, by the theorem that fits the law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import get_args

from hoverproof.certification.attraction import proof as potential
from hoverproof.certification.attraction import verdict as of_potential
from hoverproof.certification.attraction.search import Objective
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.verdict import Attraction, Sinks
from hoverproof.certification.exponential.proof import converge
from hoverproof.certification.exponential.verdict import HIDDEN, NOT_COVERED, Exponential
from hoverproof.certification.verdict import Undecided
from hoverproof.errors import InputError
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission

STEPS = "control in steps (give uncertainty.control_period, or noise for it)"
LAGS = "an accelerometer with a low-pass (give uncertainty.force_lag, or such noise)"
"""What is not covered without the tolerance that is named."""

Converges = Attraction | Exponential | Sinks | Undecided
Progress = Callable[[str], None]


def not_covered(verdict: Converges) -> tuple[str, ...]:
    """Return what the theorem of a verdict does not say, in words.

    Parameters
    ----------
    verdict : Attraction, Exponential, Sinks or Undecided
    """
    if isinstance(verdict, Exponential) or verdict.mission.law.feature == "scaled":
        proved = isinstance(verdict, Exponential) and verdict.mission.camera.half_angle is not None
        may = verdict.mission.uncertainty
        steps = [] if may.control_period else [STEPS]
        lags = [] if may.force_lag else [LAGS]
        rest = (*NOT_COVERED[:-1], HIDDEN) if proved else NOT_COVERED
        return (rest[0], *steps, *lags, *rest[1:])
    return of_potential.not_covered(verdict)


@of_mission
def attraction(
    mission: Mission,
    *,
    objective: Objective = "start",
    starts: Sequence[Start] | None = None,
    barrier: bool | None = None,
    progress: Progress | None = None,
) -> Converges:
    """Find and prove from where the vehicle converges to its goal.

    With the centroid as its feature the natural potential proves a region of attraction; with the
    scaled centroid, or where that proves nothing, the squares of the errors prove that they fall
    exponentially from the starts. Either holds for every vehicle within `mission.uncertainty`.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    objective : {"start", "radius", "volume"}
        Prove the given starts; or make the largest ball of certified hovers about the goal, or
        their volume, as large as can be: with the centroid only.
    starts : sequence of Start, optional
        Sets of states to be inside; by default, with the objective "start", that of the mission.
    barrier : bool, optional
        Whether to use that motions do not sink to the target. By default both are tried, with a
        barrier first if k3 >= 3 k1 k2.
    progress : callable, optional
        Is told what is being done.

    Returns
    -------
    Attraction or Exponential; Sinks if a wanted start is shown to sink to the target; or Undecided

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    if objective not in get_args(Objective):
        known = ", ".join(get_args(Objective))
        raise InputError("--objective", "", f"must be one of {known}, not {objective!r}")
    if mission.law.feature == "scaled":
        if objective != "start":
            raise InputError(
                "--objective",
                "",
                f"{objective} is for the centroid; with the scaled centroid a start is proved: "
                "name it by --start",
            )
        return converge(mission, starts=starts, progress=progress)
    if mission.camera.has_arm and objective == "start" and barrier is None:
        return converge(mission, starts=starts, progress=progress)
    verdict = potential.attraction(
        mission, objective=objective, starts=starts, barrier=barrier, progress=progress
    )
    if isinstance(verdict, Undecided) and objective == "start" and barrier is None:
        other = converge(mission, starts=starts, progress=progress)
        return other if other.proved else verdict
    return verdict


def start_or_ball(mission: Mission) -> tuple[Converges, Attraction | Exponential | None]:
    """Decide about the start of a mission; if it is not proved, look for other hovers that are.

    Parameters
    ----------
    mission : Mission

    Returns
    -------
    verdict
        Of `attraction`, about the start of the mission.
    proved : Attraction, Exponential or None
        That verdict if it is proved; else, with the centroid, the region with the largest ball.

    Raises
    ------
    InputError
        See `attraction`.
    """
    verdict = attraction(mission)
    if verdict.proved or mission.law.feature == "scaled":
        return verdict, verdict.proved
    return verdict, potential.attraction(mission, objective="radius").proved
