"""What `tune --pareto` answers: gains along a curve."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from hoverproof.algebra.decimals import at_least
from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.region_tuned import WAYS, region_tuned_as_json
from hoverproof.cli.answers.start_tuned import StartTunedAnswer
from hoverproof.cli.answers.tuned import infeasible_as_json, tuned_as_json
from hoverproof.cli.answers.words import about, number
from hoverproof.design.outcome import Infeasible, RegionTuned, StartTuned, Tuned
from hoverproof.servo.variables import Design

Found = Tuned | RegionTuned | StartTuned | Infeasible


@dataclass(frozen=True)
class CurveAnswer(Answer):
    """What was tuned for each point of a curve, and its figure, if there is anything to see."""

    title: ClassVar[str]
    along: ClassVar[str]
    head: ClassVar[str]

    mission: str
    points: Sequence[tuple[float, Found]]
    picture: Path | None

    @property
    def status(self) -> int:
        """The exit status."""
        return int(any(isinstance(found, Infeasible) for _, found in self.points))

    @abstractmethod
    def row(self, at: float, found: Found) -> str:
        """Write a point of the curve."""

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield f"{self.mission}: {self.title}"
        yield self.head
        for at, found in self.points:
            yield self.row(at, found)
        if self.picture is not None:
            yield f"  figure  {self.picture}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {
            "mission": self.mission,
            "points": [{self.along: at, **_as_json(found)} for at, found in self.points],
            "figure": None if self.picture is None else str(self.picture),
        }


class DecayCurveAnswer(CurveAnswer):
    """The certified decay against the bandwidth."""

    title = "certified decay rate of L against attitude bandwidth"
    along = "bandwidth_limit"
    head = "  ".join(
        ["", f"{'rad/s':>8}", f"{'1/s':>11}", *(f"{k:>9}" for k in Design.chain_gains())]
    )

    def row(self, at: float, found: Found) -> str:
        """Write a point of the curve."""
        if not isinstance(found, Tuned):
            return nothing_row(f"{at:8.4g}", found)
        rate = at_least(found.verdict.decay_rate)
        return "  ".join(["", f"{at:8.4g}", f"{rate:>11}", *gains_row(found, 9)])


class RegionCurveAnswer(CurveAnswer):
    """The certified hovers against the slowest motion."""

    title = "certified hovers against the slowest motion at the goal"
    along = "minimum_decay"
    head = "  ".join(
        [
            "",
            *(f"{w:>10}" for w in ("1/s", "sideways m", "up m", "down m")),
            *(f"{k:>6}" for k in Design.chain_gains()),
        ]
    )

    def row(self, at: float, found: Found) -> str:
        """Write a point of the curve."""
        if not isinstance(found, RegionTuned):
            return nothing_row(f"{about(at):>10}", found)
        far = (at_least(getattr(found.region.reach, way)) for way in WAYS)
        row = (about(found.slowest_rate), *far)
        return "  ".join(["", *(f"{x:>10}" for x in row), *gains_row(found, 6)])


def gains_row(found: Tuned | RegionTuned | StartTuned, width: int) -> list[str]:
    """Write the gains of a point, each so wide.

    Parameters
    ----------
    found : Tuned, RegionTuned or StartTuned
    width : int
        In characters.
    """
    return [f"{number(getattr(found.mission.gains, k)):>{width}}" for k in Design.chain_gains()]


def nothing_row(at: str, found: Found) -> str:
    """Write that there is nothing at a point.

    Parameters
    ----------
    at : str
    found : Infeasible
    """
    return f"  {at}  {found.status}: {getattr(found, 'reason', '')}"


def _as_json(found: Found) -> dict[str, Any]:
    match found:
        case Tuned():
            return tuned_as_json(found)
        case RegionTuned():
            return region_tuned_as_json(found)
        case StartTuned():
            return StartTunedAnswer(found, None, None).as_json()
        case Infeasible():
            return infeasible_as_json(found)
