"""What `simulate --runs` answers of many flights."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.beyond import about_flight
from hoverproof.cli.answers.words import about
from hoverproof.cli.interruption import STATUS

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission
    from hoverproof.simulation.runs import Flown


@dataclass(frozen=True)
class RunsAnswer(Answer):
    """What came of many flights, the facts of their file (`runs_summary`), and its figures."""

    within: ClassVar[str] = "vehicles within"

    mission: Mission
    flown: Flown
    facts: Mapping[str, Any]
    seed: int
    pictures: Sequence[Path]

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Say what of the flights is beyond the tolerances, or that their vehicles are within."""
        drawn = self.mission.scatter.of_the_vehicle
        return about_flight(self.mission, self.within, drawn=drawn)

    @property
    def status(self) -> int:
        """The exit status."""
        if self.flown.interrupted:
            return STATUS
        return int(self.facts["outcomes"]["flown"] < self.flown.runs)

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        flown, facts = self.flown, self.facts
        complete, length = facts["runs_complete"], facts["duration"]
        yield f"{self.mission.name}: {complete} of {flown.runs} runs of {length:g} s"
        rate = flown.steps / flown.seconds / 1e6
        yield (
            f"  {flown.steps} steps in {flown.seconds:.1f} s, {rate:.1f} million a second: "
            f"{flown.machine}"
        )
        for name, count in facts["outcomes"].items():
            if count or name == "flown":
                yield f"  {name.replace('_', ' '):24}  {count}"
        if complete:
            settled, error = _range(facts["settled_at"], "s"), _range(facts["final_error"], "m")
            yield f"  {'settled within 10 %':24}  {facts['settled']}{settled}"
            yield f"  {'error at the end':24}  {error.strip() or 'none flown'}"
        if facts["runs_that_lost_frames"]:
            yield f"  {'target left the view':24}  {facts['runs_that_lost_frames']}"
        yield f"  flights   {flown.path}"
        for picture in self.pictures:
            yield f"  figure    {picture}"
        if flown.interrupted:
            yield "interrupted; the complete runs are kept, and --resume flies the rest"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        flown = self.flown
        return {
            "mission": self.mission.name,
            **self.facts,
            "interrupted": flown.interrupted,
            "steps": flown.steps,
            "seconds": flown.seconds,
            "machine": flown.machine,
            "seed": self.seed,
            "figures": [str(p) for p in self.pictures],
            "out": str(flown.path),
        }


def _range(quantiles: Sequence[float] | None, unit: str) -> str:
    if quantiles is None or not all(map(math.isfinite, quantiles)):
        return ""
    low, middle, high = map(about, quantiles)
    return f"  median {middle} {unit}, 90 % within [{low}, {high}] {unit}"
