"""What `region` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.certification.flow import flow_of
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.words import about, numbers, position_text, sides_text, whole

CONTENTS = {
    "proved": "the bounds",
    "refuted": "where they break",
    "undecided": "what is proved there",
}


@dataclass(frozen=True)
class RegionAnswer(Answer):
    """A verdict on the bounds of Q over a box, and what was written.

    ``next_arguments`` are those of the `certify` that makes use of it.
    """

    mission: str
    verdict: BoundsVerdict
    path: Path | None
    picture: Path | None
    next_arguments: str

    @property
    def status(self) -> int:
        """The exit status."""
        return EXIT[self.verdict.status]

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        verdict = self.verdict
        found, broken, flow = verdict.enclosure, verdict.refuted, flow_of(verdict.mission)
        yield f"{self.mission}: {verdict.status}"
        yield f"  {_asked(verdict)}"
        yield f"  for every position in the box {sides_text(verdict.box)} m"
        if found is None:
            yield "  nothing is proved there within the limit of boxes (--boxes)"
        else:
            yield f"  proved there            {flow.within(found.eigenvalues, whole)}"
            yield f"  found there             {flow.within(found.attained, about)}"
        if broken is not None:
            spot = broken.outside
            value, place = about(spot.value), position_text(spot.position)
            name = "distance from j I" if spot.bound == "ball" else f"{spot.bound} bound broken"
            yield f"  {name:22}  {value} 1/m at {place}"
            low, high = verdict.bounds if found is None else found.attained
            if spot.bound == "lower" and high > verdict.bounds[1]:
                yield f"  upper bound broken too  {about(high)} 1/m found, not in the certificate"
            if spot.bound == "upper" and low < verdict.bounds[0]:
                yield f"  lower bound broken too  {about(low)} 1/m found, not in the certificate"
        if self.path is not None:
            yield f"  certificate             {self.path} ({CONTENTS[verdict.status]})"
        if self.picture is not None:
            yield f"  figure                  {self.picture}"
        if found is not None:
            yield f"Next: hoverproof certify {self.next_arguments}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        verdict = self.verdict
        found = verdict.enclosure
        spot = verdict.refuted and verdict.refuted.outside
        witness = spot and {
            "position": [str(c) for c in spot.position],
            "distance" if spot.bound == "ball" else "eigenvalue": spot.value,
            "bound": spot.bound,
        }
        return {
            "mission": self.mission,
            "verdict": verdict.status,
            "box": [numbers(side) for side in verdict.box],
            "bounded": flow_of(verdict.mission).words,
            "bounds": numbers(verdict.bounds),
            "enclosure": found and numbers(found.eigenvalues),
            "attained": found and list(found.attained),
            "witness": witness,
            "certificate": None if self.path is None else str(self.path),
            "figure": None if self.picture is None else str(self.picture),
            "units": {"box": "m", "bounds": "1/m", "enclosure": "1/m", "attained": "1/m"},
        }


def _asked(verdict: BoundsVerdict) -> str:
    flow = flow_of(verdict.mission)
    within = flow.within(verdict.bounds, whole)
    return f"bounds {within} of {flow.words}" if flow.symbol == "Q" else f"bounds {within}"
