"""What `atlas` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import about
from hoverproof.design.atlas import Axis
from hoverproof.design.atlas_summary import AtlasSummary


@dataclass(frozen=True)
class AtlasAnswer(Answer):
    """A map in a few numbers, and where it and its figure are."""

    mission: str
    x: Axis
    y: Axis
    found: AtlasSummary
    exact: bool
    path: Path
    picture: Path

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found = self.found
        share = 100 * found.certified / found.cells
        yield f"{self.mission}: a map of what is certified"
        for one in (self.x, self.y):
            ends = f"{about(one.values[0])} to {about(one.values[-1])} {one.quantity.unit}"
            yield f"  {one.name:23} from {ends}"
        yield (
            f"  certified               {found.certified} of {found.cells} cells, {share:.1f} % "
            "(floating point)"
        )
        if found.best is not None:
            words = ", ".join(f"{name} = {about(value)}" for name, value in found.best.items())
            axes = ((self.x.name, self.x.values), (self.y.name, self.y.values))
            at_edge = any(found.best[name] in (ends[0], ends[-1]) for name, ends in axes)
            yield f"  best cell               {words}{', at the edge of the map' * at_edge}"
            yield f"  its decay rate          {about(found.best_decay_rate)} 1/s"
        if self.exact:
            words = ", ".join(f"{n} {word}" for word, n in found.decided.items())
            yield f"  at the boundary         {words}, exactly; {found.disagree} unlike the map"
        yield f"  map                     {self.path}"
        yield f"  figure                  {self.picture}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        found = self.found
        best: dict[str, float | None] | None = None
        if found.best is not None:
            best = {**found.best, "decay_rate": found.best_decay_rate}
        return {
            "mission": self.mission,
            "x": self.x.name,
            "y": self.y.name,
            "cells": found.cells,
            "certified": found.certified,
            "no_question": found.no_question,
            "best": best,
            "decided_exactly": found.decided if self.exact else None,
            "disagree": found.disagree,
            "out": str(self.path),
            "figure": str(self.picture),
        }
