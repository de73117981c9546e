"""What `attraction` answers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.algebra.decimals import angle_at_most, at_least, at_most
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.attraction.verdict import Attraction, Sinks
from hoverproof.certification.certificate import exact
from hoverproof.certification.convergence import Converges, not_covered
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.largest import Largest
from hoverproof.certification.verdict import Undecided
from hoverproof.cli.answers import exponential, unproved
from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.words import (
    as_argument,
    enclosure,
    goal_as_json,
    goal_text,
    inside,
    number,
    numbers,
    whole,
)
from hoverproof.design.unproved import Unproved
from hoverproof.mission.tolerances import UNITS
from hoverproof.mission.uncertainty import Uncertainty

OF_A_PROOF = (
    "units",
    "rotor_limits_kept",
    "ultimate_radius",
    "theorem",
    "decay_rate",
    "settling_time",
    "settling_radius",
    "start_level",
    "heights",
    "slope",
    "field_of_view",
    "rotor_thrust",
    "level",
    "weights",
    "rate",
    "tilt",
    "thrust",
    "largest_eigenvalue",
    "barrier_height",
    "reach",
)


@dataclass(frozen=True)
class AttractionAnswer(Answer):
    """A verdict on where the controller may be switched on, and what was written."""

    verdict: Converges
    path: Path | None
    picture: Path | None
    largest: Largest | None = None
    search: Path | None = None
    unproved: Unproved | None = None
    then: tuple[str, str] | None = None

    @property
    def status(self) -> int:
        """The exit status."""
        return EXIT[self.verdict.status]

    @property
    def considered(self) -> list[str]:
        """What it considers of what the mission asks to be covered."""
        return [] if isinstance(self.verdict, Undecided) else considered(self.verdict)

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Say of tolerances whether they are left out, or asked for in vain."""
        return {"asked for" if isinstance(self.verdict, Undecided) else "not considered": left}

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        verdict = self.verdict
        yield f"{verdict.mission.name}: {verdict.status}"
        yield from goal_text(verdict.mission)
        if self.largest is not None:
            yield from _largest(self.largest)
        if isinstance(verdict, Undecided):
            for words in (
                *verdict.reason.split("; "),
                *(f"would help: {a}" for a in verdict.advice),
            ):
                yield textwrap.fill(words, 80, initial_indent="  ", subsequent_indent="    ")
            if self.unproved is not None:
                yield from unproved.lines(self.unproved, self.path)
            if self.then is not None:
                command, does = self.then
                yield f"Next: {command}"
                yield f"  {does}"
            return
        if isinstance(verdict, Sinks):
            yield from _motion(verdict)
        else:
            yield from _proved(verdict)
        yield f"  certificate             {self.path}"
        if self.picture is not None:
            yield f"  figure                  {self.picture}"
        if self.search is not None:
            yield f"  figure of the search    {self.search}"
        yield "Not covered:"
        for line in not_covered(verdict):
            yield f"  {line}"
        yield f"Next: hoverproof check {as_argument(self.path)}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        verdict = self.verdict
        return {
            "mission": verdict.mission.name,
            "verdict": verdict.status,
            "goal_position": goal_as_json(verdict.mission),
            "certificate": str(self.path) if self.path and verdict.certificate else None,
            "not_covered": list(not_covered(verdict)),
            "advice": list(verdict.advice),
            **dict.fromkeys(OF_A_PROOF),
            "starts": [],
            "statement": verdict.statement,
            "motion": verdict.refuted and verdict.refuted.certificate.content["motion"],
            "reason": verdict.reason,
            "covers": [],
            "unproved": self.unproved and unproved.as_json(self.unproved, self.path),
            "largest": self.largest and _largest_as_json(self.largest),
            "search_figure": None if self.search is None else str(self.search),
            **(proved_as_json(verdict.proved) if verdict.proved else {}),
            "figure": None if self.picture is None else str(self.picture),
        }


def _largest(found: Largest) -> Iterator[str]:
    unit = f" {UNITS[found.name]}".rstrip()
    if found.verdict.proved is None:
        yield f"  largest {found.name:15} none: not even zero is proved"
        return
    beyond = "no larger one may be asked for"
    if found.beyond is not None:
        beyond = f"nothing was found for {number(found.beyond)}{unit}"
    yield f"  largest {found.name:15} {number(found.value)}{unit}; {beyond}"


def _largest_as_json(found: Largest) -> dict[str, Any]:
    proved = found.verdict.proved is not None
    return {
        "tolerance": found.name,
        "value": float(found.value) if proved else None,
        "unit": UNITS[found.name] or "1",
        "not_found_at": None if found.beyond is None else float(found.beyond),
    }


def considered(verdict: Converges) -> list[str]:
    """Return what a verdict considers of what its mission asks to be covered, in words.

    Parameters
    ----------
    verdict : Attraction, Exponential, Sinks or Undecided
    """
    mission, proved = verdict.mission, verdict.proved
    seen = isinstance(proved, Exponential) and proved.field_of_view is not None
    views = mission.camera.covers() if seen else []
    if isinstance(proved, Exponential) and not seen:
        views = mission.camera.beside()
    return [*([] if verdict.refuted else mission.uncertainty.covers()), *views]


def _proved(verdict: Attraction | Exponential) -> Iterator[str]:
    may, covers = verdict.mission.uncertainty, verdict.mission.covers()
    who = f"every vehicle with {', '.join(covers)}" if covers else "the vehicle"
    theorem, where = "theorem 5, exponential", "from"
    if isinstance(verdict, Attraction):
        theorem, where = f"theorem {6 if verdict.tolerant else 3}, potential", _states(verdict)
    yield from textwrap.wrap(
        f"{who} converges to the goal ({theorem}): the controller may be switched on, "
        f"{_turning(may)}, {where}",
        80,
        initial_indent="  ",
        subsequent_indent="  ",
    )
    if isinstance(verdict, Exponential):
        yield from exponential.lines(verdict, [describe(start) for start in verdict.starts])
    else:
        yield from _region(verdict)


def _states(verdict: Attraction) -> str:
    inside = f"{verdict.symbol} <= {at_least(verdict.level)}"
    if verdict.barrier_height is None:
        return f"in every state with {inside} and T > 0; the hovers of these reach from the goal"
    above = f"at least {at_most(verdict.barrier_height)} m above the target"
    return f"in every level hover {above} with {inside}; these reach from the goal"


def _turning(may: Uncertainty) -> str:
    """Say how it may turn about its vertical axis."""
    if may.yaw_rate:
        return "with any heading"
    depends = may.torque or may.latency or may.rotor_lag or may.is_shaken
    return "with any heading and yaw rate zero" if depends else "with any heading and yaw rate"


def _region(verdict: Attraction) -> Iterator[str]:
    reach, height = verdict.reach, verdict.barrier_height
    yield f"  sideways, all round     {at_least(reach.sideways)} m"
    yield f"  up                      {at_least(reach.up)} m"
    yield f"  down                    {at_least(reach.down)} m"
    yield "  (by the model, whose camera sees every target point from any distance)"
    for start in verdict.starts:
        yield f"  and from                {describe(start)}"
    yield "  On the way:"
    yield f"  tilt                    {angle_at_most(verdict.tilt)} or less"
    yield f"  thrust                  in {enclosure(verdict.thrust)} N"
    if height is not None:
        yield f"  height                  {at_least(height)} m or more above the target"


def _motion(verdict: Sinks) -> Iterator[str]:
    state = verdict.state
    yield f"  {verdict.reason},"
    yield "  by the exact model, from the state (world axes, yaw rate zero):"
    for name, sides, unit in (
        ("position", state.position, "m"),
        ("velocity", state.velocity, "m/s"),
        ("body axis e3", state.axis, ""),
        ("its derivative", state.turning, "1/s"),
        ("thrust", [state.thrust], "N"),
    ):
        middle = ", ".join(number((a + b) / 2) for a, b in sides)
        yield f"  {name:22}  {middle} {unit}".rstrip()


def describe(start: Start) -> str:
    """Describe a set of states.

    Parameters
    ----------
    start : Start
    """
    point = all(a == b for a, b in start.position)
    sides = (", " if point else " x ").join(
        whole(a) if a == b else inside((a, b)) for a, b in start.position
    )
    sizes = [
        f"{word} <= {at_least(value, 6)} {unit}"
        for word, value, unit in (
            ("speed", start.speed, "m/s"),
            ("tilt", start.tilt, "rad"),
            ("rates", start.rate, "rad/s"),
            ("|T - m g|", start.thrust, "N"),
        )
        if value
    ]
    return ", ".join([f"({sides}) m", *(sizes or ["level hover"])])


def proved_as_json(verdict: Attraction | Exponential) -> dict[str, Any]:
    """Return what is proved, for machines.

    Parameters
    ----------
    verdict : Attraction or Exponential
    """
    covers = {"covers": verdict.mission.covers()}
    if isinstance(verdict, Exponential):
        return {"theorem": "exponential", **covers, **exponential.as_json(verdict)}
    return {"theorem": "potential", **covers, **_region_as_json(verdict)}


def _region_as_json(verdict: Attraction) -> dict[str, Any]:
    reach, height = verdict.reach, verdict.barrier_height
    return {
        "level": float(verdict.level),
        "weights": numbers(verdict.weights),
        "rate": float(verdict.rate),
        "tilt": float(verdict.tilt),
        "thrust": numbers(verdict.thrust),
        "largest_eigenvalue": float(verdict.largest_eigenvalue),
        "barrier_height": None if height is None else float(height),
        "reach": {way: float(getattr(reach, way)) for way in ("sideways", "up", "down")},
        "starts": [exact(start.content()) for start in verdict.starts],
        "units": {
            "rate": f"1, of {verdict.symbol}' <= -(k1/m) rate |Y|²",
            "tilt": "rad",
            "thrust": "N",
            "largest_eigenvalue": "1/m",
            "barrier_height": "m above the mean of the target",
            "reach": "m from the goal",
        },
    }
