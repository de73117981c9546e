"""What `presets` and `new` answer."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import as_argument, number

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission


@dataclass(frozen=True)
class PresetsAnswer(Answer):
    """The presets, with the bandwidth of each in rad/s and its slowest time constant in s."""

    missions: Sequence[tuple[Mission, float, float]]

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield (
            f"{'name':16} {'mass kg':>8} {'points':>7} {'height m':>9} {'rad/s':>7} "
            f"{'slowest s':>10}"
        )
        for m, bandwidth, time in self.missions:
            height = "-" if m.goal.height is None else number(m.goal.height)
            yield (
                f"{m.name:16} {number(m.vehicle.mass):>8} {len(m.target.points):>7} {height:>9} "
                f"{bandwidth:>7.3g} {time:>10.3g}"
            )
        yield "rad/s: attitude bandwidth (k1 k2 + k3 + k4)/m; slowest: time constant at goal"
        yield "Next: hoverproof presets NAME prints one; hoverproof certify NAME"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        facts = [
            {
                "name": m.name,
                "mass": float(m.vehicle.mass),
                "points": len(m.target.points),
                "height": None if m.goal.height is None else float(m.goal.height),
                "bandwidth": bandwidth,
                "time_constant": time,
            }
            for m, bandwidth, time in self.missions
        ]
        units = {"mass": "kg", "height": "m", "bandwidth": "rad/s", "time_constant": "s"}
        return {"presets": [m.name for m, *_ in self.missions], "missions": facts, "units": units}


@dataclass(frozen=True)
class PresetAnswer(Answer):
    """A preset, as its file has it."""

    explained: ClassVar[bool] = False

    file: str
    mission: Mission

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield self.file.removesuffix("\n")

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return self.mission.exact()


@dataclass(frozen=True)
class NewAnswer(Answer):
    """A mission file that was written, from a preset or from answers."""

    path: Path
    mission: Mission
    source: str
    read: Sequence[str] = ()
    assumed: Sequence[str] = ()

    @property
    def _for_start(self) -> bool:
        """Whether gains are searched by the start."""
        return self.mission.law.feature == "scaled"

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        path, tuned = self.path, self.path.with_stem(f"{self.path.stem}-tuned")
        own = self.source == "own vehicle"
        yield f"{path}: written, {self.source if own else f'from preset {self.source}'}"
        for words in self.read:
            yield from textwrap.wrap(words, 80, initial_indent="  ", subsequent_indent="    ")
        if self.assumed:
            words = f"assumed: {', '.join(self.assumed)}"
            yield from textwrap.wrap(
                words, 80, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False
            )
        if self.mission.asks_to_cover():
            words = f"for every vehicle within {', '.join(self.mission.asks_to_cover())}"
            yield from textwrap.wrap(words, 80, initial_indent="  ", subsequent_indent="    ")
        yield "Next:" if own else "Next: put in your vehicle, target and gains, then"
        objective = "" if self._for_start else "--objective decay "
        named = as_argument(path)
        yield f"  hoverproof {'attraction' if self._for_start else 'certify'} {named}"
        yield f"  hoverproof tune {named} {objective}--out {as_argument(tuned)}"
        yield f"  hoverproof simulate {named}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {
            "out": str(self.path),
            "name": self.mission.name,
            "from": self.source,
            "target": list(self.read),
            "assumed": list(self.assumed),
        }
