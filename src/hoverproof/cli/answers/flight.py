"""What `simulate` answers of a single flight."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.beyond import about_flight, covering, needs_measured_force
from hoverproof.cli.answers.see import images_text
from hoverproof.cli.answers.words import about, as_argument, goal_as_json, goal_text, position_text
from hoverproof.simulation.compiled import VIRTUAL_MACHINE
from hoverproof.simulation.flight import OF_THE_IDEAL
from hoverproof.simulation.numbers import SETTLED

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission
    from hoverproof.show.decay import Decay


@dataclass(frozen=True)
class FlightAnswer(Answer):
    """The facts of a flight (`summary`, `without_conditions`), and what was written.

    `uncovered` tells that gains are proved, but nothing of this flight; `named` are the arguments
    with which the mission was given.
    """

    within: ClassVar[str] = "one vehicle within"

    mission: Mission
    named: str
    facts: Mapping[str, Any]
    decay: Decay | None
    path: Path
    pictures: Sequence[Path]
    animation: Path | None
    uncovered: bool = False

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Say what of the flight is beyond the tolerances, or that its vehicle is within."""
        return about_flight(self.mission, self.within)

    @property
    def status(self) -> int:
        """The exit status."""
        return int(self.facts["outcome"] != "flown")

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        facts = self.facts
        whole = facts["outcome"] == "flown"  # else it says when it ended
        length = f", {facts['duration']:g} s" if whole else ""
        yield f"{self.mission.name}: {facts['outcome']}{length}"
        if whole and facts["final_error"] > SETTLED * facts["start_error"] > 0:
            yield f"  did not come to its goal: {facts['final_error']:.3g} m away at the end"
        yield f"  {facts['steps']} steps in {facts['seconds']:.2f} s: {facts['machine']}"
        if facts["machine"] == VIRTUAL_MACHINE:
            yield "  (no C compiler works here; with one this is much faster)"
        yield from goal_text(self.mission)
        start, end = position_text(facts["start_position"]), position_text(facts["final_position"])
        yield f"  start     {start}, {about(facts['start_error'])} m away"
        yield f"  end       {end}, {about(facts['final_error'])} m away"
        if "final_yaw" in facts:
            yaw, off = facts["final_yaw"], facts["final_heading_error"]
            yield f"  yaw       {yaw:.3f} rad at the end, {off:.3g} rad off its heading"
        settled = _since(facts["settled_at"])
        yield f"  within 10 % of the distance at the start: {settled}"
        yield from self._conditions()
        yield f"  flight    {self.path}"
        for picture in self.pictures:
            yield f"  figure    {picture}"
        if self.decay is not None:
            ends = self.decay.until < facts["duration"]
            until = f", until {self.decay.until:g} s: then the flight leaves its bounds"
            yield f"  drawn in figure features, {self.decay.label()}{until if ends else ''}"
        if self.uncovered:
            yield "  nothing is certified of this flight: it starts outside the bounds of the proof"
        low, high = facts["rotor_thrust"]
        if low < 0:
            yield f"  rotor thrusts from {low:.3g} to {high:.3g} N: no rotor pulls a vehicle down"
        if self.animation is not None:
            yield f"  animation {self.animation}"
        if not whole or facts["final_error"] > SETTLED * facts["start_error"] > 0:
            yield from self._said_before()

    def _said_before(self) -> Iterator[str]:
        """Yield the tolerances that ask a proof about what was flown, or the law that can."""
        if needs_measured_force(self.mission):
            yield '  law.force = "measured" can cover that, with other gains: this law takes the'
            yield "  force commanded for the one that acts"
            yield f"Next: hoverproof new measured.toml --vehicle {as_argument(self.mission.source)}"
            yield "  writes a mission with that law, of this vehicle, with a tag, height"
            yield "  and start of its own that its gains hold"
        elif sets := covering(self.mission):
            options = shlex.join(word for it in sets for word in ("--set", it))
            yield f"Next: hoverproof attraction {self.named} {options}"

    def _conditions(self) -> Iterator[str]:
        facts = self.facts
        if "ideal_settled_at" in facts:
            settled = _since(facts["ideal_settled_at"])
            if facts["ideal_settled_at"] is None:
                settled = f"not before {facts['compared_until']:g} s"
            yield f"  with ideal sensors and rotors, no wind or errors: {settled}"
            most = about(facts["greatest_distance_from_ideal"])
            last = about(facts["final_distance_from_ideal"])
            yield f"  at most {most} m from that ideal flight, {last} m at the end"
        if facts["frames_lost"] and self.mission.sensors.width is not None:
            yield (
                f"  a target point was out of view in {facts['frames_lost']} frames, "
                f"first at {facts['left_view_at']:g} s"
            )
        if "images" in facts:
            yield from images_text(facts["images"])

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        decay = self.decay
        return {
            "mission": self.mission.name,
            "goal_position": goal_as_json(self.mission),
            **dict.fromkeys((*OF_THE_IDEAL, "images")),
            **self.facts,
            "figures": [str(p) for p in self.pictures],
            "certified_decay": None
            if decay is None
            else {"rate": decay.rate, "until": decay.until},
            "animation": None if self.animation is None else str(self.animation),
            "out": str(self.path),
        }


def _since(settled: float | None) -> str:
    return "not reached" if settled is None else f"from {settled:g} s on"
