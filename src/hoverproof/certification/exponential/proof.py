"""Decide whether every vehicle within tolerance converges from some starts, and how soon."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification.attraction.draft import NotShown
from hoverproof.certification.attraction.potential import off_the_vertical
from hoverproof.certification.attraction.starts import Start, require_starts
from hoverproof.certification.certificate import Certificate, rejection, seal
from hoverproof.certification.exponential.candidate import Candidate
from hoverproof.certification.exponential.closeness import closest
from hoverproof.certification.exponential.draft import Parts, Rounded, draft
from hoverproof.certification.exponential.form import derive_form
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.question import SETTLED, Question
from hoverproof.certification.exponential.search import deepest, narrowest, quietest
from hoverproof.certification.exponential.sooner import soonest
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.exponential.verdict import Exponential, Settling
from hoverproof.certification.verdict import Undecided
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.lens import check_cone
from hoverproof.servo.law import Law

Array = NDArray[np.float64]
Progress = Callable[[str], None]
ROUGH, WHOLE = 10, 30
"""So many places are looked at to know how closely the ball of J is laid, and then to the end."""
ROOMS = (0.35, 0.838), (0.6, 0.835), (0.6, 0.7), (1.0, 0.55)
"""By which share the ball of J is widened for the proof, and the share of s3* that d is at most,
one after the other: the trees are shorter. The ball of what is found is then made closer."""


def converge(
    mission: Mission,
    *,
    starts: Sequence[Start] | None = None,
    progress: Progress | None = None,
) -> Exponential | Undecided:
    """Prove that every vehicle within tolerance converges from some starts.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start, optional
        Sets of states; by default the start of the mission.
    progress : callable, optional
        Is told what is being done.

    Raises
    ------
    InputError
        If the goal is not axial, or the mission poses no question.
    """
    tell, reason = progress or (lambda text: None), ""
    for found in _found(mission, tuple(starts or [Start.of(mission)]), tell):
        if isinstance(found, str):
            reason = reason or found
            break
        tell("proving")
        verdict = _proved(mission, *found)
        if isinstance(verdict, Exponential):
            return verdict
        reason = verdict
    return Undecided(mission=mission, reason=reason, advice=_advice(mission))


def settling(mission: Mission, progress: Progress | None = None) -> Settling | None:
    """Return what `converge` would prove of the start of a mission, but without the proof.

    Parameters
    ----------
    mission : Mission
    progress : callable, optional
        Is told what is being done.

    Raises
    ------
    InputError
        See `converge`.
    """
    for found in _found(mission, (Start.of(mission),), progress or (lambda text: None)):
        with contextlib.suppress(NotShown):
            return None if isinstance(found, str) else Rounded.of(*found).settling(found[0])
    return None


def _found(
    mission: Mission, starts: tuple[Start, ...], tell: Progress
) -> Iterator[tuple[Question, Candidate] | str]:
    """Yield questions and what is found, the likeliest to be proved first; or why nothing is."""
    require_question(mission, starts)
    whole = Question.of(Vehicles.of(mission), Scene.of(mission), starts)
    for wider, highest in ROOMS:
        tell("searching for weights")
        question = replace(whole, wider=wider, highest=highest, half_angle=_half_angle(mission))
        question, first = _first(question)
        if isinstance(first, str):
            yield first
            return
        terms = question.terms()
        rough = soonest(question, first, terms, ROUGH)
        closer = closest(question, mission.target, rough.offset)
        if closer is not None:
            near = closer.at(rough.x, rough.rate, terms, rough.solution.tight)
            if near is not None and closer.holds(near):
                yield closer, quietest(closer, soonest(closer, near, terms, WHOLE), terms)
        yield question, quietest(question, soonest(question, rough, terms, WHOLE), terms)


def _proved(mission: Mission, question: Question, found: Candidate) -> Exponential | str:
    """Write a certificate that the checker accepts; return why not if it does not."""
    try:
        parts = draft(mission, question, found)
        model = model_fingerprint(question.vehicles.law)
        certificate = seal(mission, "exponential", parts.content, model)
    except (NotShown, InputError) as error:
        return str(error)
    return rejection(certificate) or _verdict(mission, certificate, parts, question.starts)


def candidate(mission: Mission, starts: Sequence[Start], near: Array | None) -> Candidate | None:
    """Search without proving: Ψ of the starts is below the level if the fill is below 1 - `ROOM`.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start
    near : (2,), or None
        See `search.deepest`.

    Raises
    ------
    InputError
        See `converge`.
    """
    require_question(mission, starts)
    whole = Question.of(Vehicles.of(mission), Scene.of(mission), tuple(starts))
    wider, highest = ROOMS[0]
    settled = SETTLED[-1 if whole.vehicles.is_shaken else 0]
    question = replace(whole, wider=wider, highest=highest, settled=settled)
    question = replace(question, half_angle=_half_angle(mission))
    found = deepest(question, question.terms(), near)
    return found if found is not None and question.sees(found) else None


def require_question(mission: Mission, starts: Sequence[Start]) -> None:
    """Refuse what poses no question.

    Parameters
    ----------
    mission : Mission
    starts : sequence of Start

    Raises
    ------
    InputError
        See `converge`.
    """
    if any(end != 0 for ends in hover_goal(mission).centroid[:2] for end in ends):
        raise off_the_vertical(mission)
    check_cone(mission)
    require_starts(mission, starts)


def _first(question: Question) -> tuple[Question, Candidate | str]:
    """Search until a radius is found in which noise leaves the vehicle."""
    found = _held(question)
    for share in SETTLED[1:] if question.vehicles.is_shaken else ():
        if isinstance(found, str):
            question = replace(question, settled=share)
            found = _held(question)
    return question, found


def _held(question: Question) -> Candidate | str:
    """Return a candidate that holds the starts, or why there is none."""
    terms = question.terms()
    found = deepest(question, terms)
    if found is None:
        return "no weights were found that satisfy the inequality"
    if found.solution.fill > 1:
        return f"Ψ at the start is {found.solution.fill:.3g} times the highest level found"
    if not question.sees(found):
        found = narrowest(question, found, terms)
    if not question.sees(found):
        angle, half = question.seen(found), question.half_angle or 0
        return (
            f"points are seen up to {angle:.3g} rad from the optical axis on the smallest set "
            f"found, {angle - half:.3g} rad more than the half angle of the camera"
        )
    return found


def _half_angle(mission: Mission) -> float | None:
    half = mission.camera.about_vertical
    return None if half is None else float(half)


def _verdict(
    mission: Mission, certificate: Certificate, parts: Parts, starts: tuple[Start, ...]
) -> Exponential:
    claim, r = parts.content["claim"], parts.rounded
    low, high = r.limits.thrust
    cone = claim["cone"]
    return Exponential(
        mission=mission,
        certificate=certificate,
        level=claim["level"],
        start_level=claim["start_level"],
        weights=r.weights,
        rate=claim["rate"],
        settling=Settling(claim["settling"]["radius"], claim["settling"]["time"]),
        wedge=parts.domain.wedge,
        slope=r.ball,
        offset=r.offset,
        tilt=decimal_above(math.asin(r.limits.tilt), 9),
        thrust=(decimal_below(low, 6), decimal_above(high, 6)),
        field_of_view=None if cone is None else decimal_above(math.acos(cone), 9),
        ultimate_radius=claim["ultimate"]["radius"] if "ultimate" in claim else None,
        rotor_thrusts=_each(claim["rotors"], mission),
        starts=starts,
    )


def _each(rotors: list[Any], mission: Mission) -> tuple[tuple[Fraction, Fraction], ...]:
    """Return the bounds of the thrust of each rotor, N."""
    if isinstance(rotors[0], list):
        return tuple((low, high) for low, high in rotors)
    low, high = rotors
    return ((low, high),) * len(mission.vehicle.frame.names)


def _advice(mission: Mission) -> tuple[str, ...]:
    """Say what may help."""
    lines = ["a start nearer to the goal", "smaller k1, which asks for less force and speed"]
    covered = mission.uncertainty.covers()
    if covered:
        lines.append(f"smaller tolerances than {', '.join(covered)}")
    return tuple(lines)


@cache
def model_fingerprint(law: Law) -> str:
    """Return the SHA-256 of the graph from which the inequality was made.

    Parameters
    ----------
    law : Law
    """
    return fingerprint(derive_form(law, True))
