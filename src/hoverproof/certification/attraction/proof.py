"""Decide where a controller may be switched on: a region of attraction, proved."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.graph import fingerprint
from hoverproof.algebra.surd import sqrt_enclosure
from hoverproof.certification.attraction.at_goal import no_weights
from hoverproof.certification.attraction.draft import NotShown, draft, force_within
from hoverproof.certification.attraction.form import derive_form
from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.refutation import refute
from hoverproof.certification.attraction.search import (
    SLACKS,
    Found,
    Objective,
    Search,
    Slack,
    find,
)
from hoverproof.certification.attraction.sinking import Sinking
from hoverproof.certification.attraction.starts import Start, require_starts
from hoverproof.certification.attraction.tolerant import is_plain, posed
from hoverproof.certification.attraction.trees import start_terms
from hoverproof.certification.attraction.verdict import Attraction, AttractionVerdict, Reach
from hoverproof.certification.certificate import Certificate, rejection, seal
from hoverproof.certification.exponential import form as of_vehicles
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.verdict import Undecided
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import law_of

Progress = Callable[[str], None]
NO_WEIGHTS = "no weights were found that satisfy the inequality"


def attraction(
    mission: Mission,
    *,
    objective: Objective = "start",
    starts: Sequence[Start] | None = None,
    barrier: bool | None = None,
    progress: Progress | None = None,
) -> AttractionVerdict:
    """Find and prove a region of attraction of the goal.

    Parameters
    ----------
    mission : Mission
    objective : {"start", "radius", "volume"}
        Prove the given starts; or make the largest ball of certified hovers about the goal, or
        their volume, as large as can be.
    starts : sequence of Start, optional
        Sets of states to be inside; by default, with the objective "start", that of the mission.
    barrier : bool, optional
        Whether to use that motions do not sink to the target. By default both are tried, with a
        barrier first if k3 >= 3 k1 k2.
    progress : callable, optional
        Is told what is being done.

    Returns
    -------
    Attraction; Sinks if a wanted start is shown to sink to the target; or Undecided

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    tell = progress or (lambda text: None)
    verdict = _search_and_prove(mission, objective, starts, barrier, tell)
    asked = (objective == "start" or starts) and not mission.camera.has_arm
    if isinstance(verdict, Undecided) and asked and mission.law.is_papers:
        tell("following the motion from the start")
        return refute(mission, starts or None, verdict)
    return verdict


@dataclass(frozen=True)
class _Question:
    """Which starts are to be inside, and what a search needs to know of the mission."""

    mission: Mission
    potential: Potential
    loop: Loop
    starts: tuple[Start, ...]

    @classmethod
    def of(cls, mission: Mission, starts: Sequence[Start]) -> _Question:
        return cls(mission, *posed(mission), tuple(starts))

    def search(self, slack: Slack, barrier: bool) -> Search:
        sinking = Sinking.of(self.mission, self.starts) if barrier else None
        return Search(self.potential, self.loop, slack, sinking)

    def terms(self) -> np.ndarray[Any, Any]:
        """Return the terms of Λ at the corners of each set of starts, (k, 4), a little enlarged."""
        rows = []
        for start in self.starts:
            corners = itertools.product(*([float(end) for end in side] for side in start.position))
            cells = np.array([[(x, x) for x in corner] for corner in corners])
            found = start_terms(
                self.mission, self.potential, self.loop, start, cells, self.loop.weight / 2
            )
            rows.append(found * 1.001)
        if not np.isfinite(rows).all():
            raise InputError("--start", "", "is at a target point, or almost")
        return np.unique(np.concatenate(rows), axis=0) if rows else self._no_terms()

    def _no_terms(self) -> np.ndarray[Any, Any]:
        return self.potential.hover_terms(self.potential.goal[None])[:0]


def _search_and_prove(
    mission: Mission,
    objective: Objective,
    starts: Sequence[Start] | None,
    barrier: bool | None,
    tell: Progress,
) -> Attraction | Undecided:
    """Try with and without a barrier."""
    own = [Start.of(mission)] if objective == "start" else []
    asked = _Question.of(mission, starts or own)
    if asked.loop.largest_force <= 0:
        raise InputError(mission.source, "gains", "the hover is beyond the singularity T = c q3*")
    require_starts(mission, asked.starts)
    refused, without = why_not_covered(mission), why_no_barrier(mission)
    if refused or (barrier and without):
        return Undecided(mission=mission, reason=refused or without)
    kinds = [k for k in (True, False) if (barrier is None or k is barrier) and not (k and without)]
    reasons = (
        [f"with a barrier: {without}"]
        if barrier is None and without and not is_plain(mission)
        else []
    )
    for with_barrier in kinds:
        verdict: Attraction | str
        try:
            verdict = _attempt(asked, objective, with_barrier, tell)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            verdict = f"these numbers are beyond what can be computed with ({error})"
        if not isinstance(verdict, str):
            return verdict
        reasons.append(("with" if with_barrier else "without") + f" a barrier: {verdict}")
    nowhere = no_weights(mission) if all(NO_WEIGHTS in reason for reason in reasons) else None
    if nowhere is not None:
        return Undecided(mission=mission, reason=nowhere[0], advice=nowhere[1])
    advice = _advice(mission, bool(asked.starts))
    return Undecided(mission=mission, reason="; ".join(reasons), advice=advice)


INSTEAD = "theorem 5 covers it: law.feature = 'scaled' has it at its best"


def _why_noisy(mission: Mission) -> str:
    """Return why a mission with bounded noise is not covered; empty if it has none."""
    may = mission.uncertainty
    if may.is_shaken:
        return (
            "bounded noise and gusts are not covered by a region of attraction: the motion ends "
            "near the goal, and the potential falls by |q - q3* ρ|², not by a share of itself, so "
            f"nothing bounds what is left of it; {INSTEAD}"
        )
    if may.control_period or may.force_lag:
        return (
            "a controller that runs in steps and an accelerometer that lags are not covered by a "
            "region of attraction; theorem 5 covers them"
        )
    if Vehicles.of(mission).is_shaken:
        return (
            "in the wind a vehicle leans, and while it yaws this turns in an image that is not "
            "turned with the gyroscope: the motion ends near the goal, which is not covered; "
            "sensors.gyro_turned = true is"
        )
    return ""


def why_not_covered(mission: Mission) -> str:
    """Return why the natural potential proves nothing of what is asked for; empty if it may.

    Parameters
    ----------
    mission : Mission
    """
    if mission.camera.has_arm:
        return (
            "a camera that is not at the centre of mass is not covered by a region of attraction: "
            "what it sees counts as an error of the feature, and the motion ends near the goal"
        )
    if is_plain(mission):
        return ""
    if refused := _why_noisy(mission):
        return refused
    if mission.uncertainty.wind and mission.law.goal == "image":
        return (
            "wind moves the hover of a goal that is fixed in the image, and the natural potential "
            "with it, another one for each wind, which is not covered; law.goal = 'inertial' is, "
            f"or {INSTEAD}"
        )
    return ""


def why_no_barrier(mission: Mission) -> str:
    """Return why no barrier is possible; empty if one may be.

    Parameters
    ----------
    mission : Mission
    """
    gains, may = mission.gains, mission.uncertainty
    if gains.k3 < 3 * gains.k1 * gains.k2:
        return "a barrier needs k3 >= 3 k1 k2"
    names = ("thrust", "latency", "rotor_lag", "wind")
    there = [name for name in names if getattr(may, name)]
    if there:
        return (
            "a barrier follows the height, which is driven just as modelled only without "
            + " and ".join(f"uncertainty.{name}" for name in there)
        )
    return ""


def _advice(mission: Mission, asked: bool) -> tuple[str, ...]:
    """Say what may help."""
    k, lines = mission.gains, []
    if k.k3 < 3 * k.k1 * k.k2:
        needed = f"k3 >= 3 k1 k2 = {float(3 * k.k1 * k.k2):.6g} kg/s"
        lines.append(f"{needed} (now {float(k.k3):.6g}): then a barrier makes regions far larger")
    else:
        lines.append("smaller k1 or k2, which ask for less force and tilt")
    if asked:
        lines.append("a start nearer to the goal; --objective radius tells how near")
    return tuple(lines)


def estimate(
    mission: Mission,
    *,
    objective: Objective = "radius",
    starts: Sequence[Start] | None = None,
    barrier: bool = False,
) -> Found:
    """Search without proving: for tuning, where many gains are tried.

    Parameters
    ----------
    mission : Mission
    objective, starts, barrier
        See `attraction`.

    Returns
    -------
    Found
        In floating point; `HoverGrid.of(potential).radius` or `volume` tells its size.

    Raises
    ------
    InputError
        See `attraction`.
    ValueError
        If no weights satisfy the inequality.
    """
    own = [Start.of(mission)] if objective == "start" else []
    asked = _Question.of(mission, starts or own)
    found = find(asked.search(SLACKS[0], barrier), objective, asked.terms())
    if found is None:
        raise ValueError("no weights satisfy the inequality for these gains")
    return found


def _attempt(
    asked: _Question, objective: Objective, barrier: bool, tell: Progress
) -> Attraction | str:
    """Search with more and more room for the proof; return what was proved, or why not."""
    terms, starts, reason = asked.terms(), asked.starts, ""
    for slack in SLACKS:
        tell("searching for weights" + (" with a barrier" if barrier else ""))
        found = find(asked.search(slack, barrier), objective, terms)
        if found is None:
            below = ", with a barrier below the starts" if barrier and starts else ""
            return reason or f"{NO_WEIGHTS}{below}"
        if starts and found.fill > 1:
            return (
                f"Λ at the start is {found.fill:.3g} times the highest level found "
                f"({found.binding})"
            )
        tell("proving")
        proved = prove(asked.mission, found, starts, slack)
        if not isinstance(proved, str):
            return proved
        reason = proved
    return reason


def prove(
    mission: Mission, found: Found, starts: Sequence[Start] = (), slack: Slack = SLACKS[0]
) -> Attraction | str:
    """Round what was found, and prove it exactly.

    Parameters
    ----------
    mission : Mission
    found : Found
    starts : sequence of Start
    slack : Slack
        Of its fields, how much of the reach is given away.

    Returns
    -------
    Attraction, or the reason why the checker rejects it
    """
    try:
        parts = draft(mission, found, starts, 1 - slack.reach)
    except NotShown as reason:
        return str(reason)
    plain = is_plain(mission)
    model = model_fingerprint() if plain else tolerant_model(law_of(mission))
    certificate = seal(mission, "attraction" if plain else "potential", parts, model)
    return rejection(certificate) or _verdict(mission, certificate, parts, starts)


def _verdict(
    mission: Mission, certificate: Certificate, parts: dict[str, Any], starts: Sequence[Start]
) -> Attraction:
    claim, hints, weight = parts["claim"], parts["enclosures"], mission.vehicle.weight
    force = force_within(mission, parts["weights"], claim["level"])
    return Attraction(
        mission=mission,
        certificate=certificate,
        level=claim["level"],
        weights=tuple(parts["weights"]),
        rate=claim["rate"],
        tilt=decimal_above(2 * hints["tilt"], 6),
        thrust=(_least_thrust(mission, weight - force), weight + force),
        largest_eigenvalue=hints["largest_eigenvalue"],
        barrier_height=claim["barrier_height"],
        reach=Reach(**claim["reach"]),
        starts=tuple(starts),
    )


@cache
def tolerant_model(law: Law) -> str:
    """Return the SHA-256 of the graph of Ψ' for every vehicle within tolerance.

    Parameters
    ----------
    law : Law
    """
    return fingerprint(of_vehicles.derive_form(law, True, True))


def _least_thrust(mission: Mission, least: Fraction) -> Fraction:
    """Return the least thrust, N, where m times the specific force is at least so large.

    Wind pushes across it by m w at most.
    """
    push = mission.vehicle.mass * mission.uncertainty.wind
    return decimal_below(sqrt_enclosure(least**2 - push**2)[0], 6) if push else least


@cache
def model_fingerprint() -> str:
    """Return the SHA-256 of the graph of Λ' from which the region was found."""
    return fingerprint(derive_form().function())
