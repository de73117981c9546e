"""What `atlas --theorem start` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.algebra.decimals import at_most
from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import about, wrapped
from hoverproof.design.atlas import Axis
from hoverproof.design.atlas_summary import StartSummary
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import Uncertainty


@dataclass(frozen=True)
class StartAtlasAnswer(Answer):
    """A map of settling times in a few numbers, and where it and its figure are."""

    mission: Mission
    axes: tuple[Axis, Axis]
    found: StartSummary
    path: Path
    picture: Path

    @property
    def considered(self) -> list[str]:
        """What is searched for, and proved where it is."""
        camera = self.mission.camera
        seen = camera.beside() if camera.half_angle is None else camera.covers()
        return [*self.mission.uncertainty.covers(), *seen]

    @property
    def covers(self) -> list[str]:
        """What every cell covers: of a tolerance that varies it covers what its axis says."""
        own = self.mission.uncertainty
        varied = {
            one.name: getattr(own, one.name)
            for one in self.axes
            if one.quantity.key.startswith("uncertainty")
        }
        told = Uncertainty(**varied).covers()
        return [words for words in self.considered if words not in told]

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found = self.found
        yield f"{self.mission.name}: a map of when its start has settled (theorem 5)"
        yield from wrapped("for every vehicle", ", ".join(self.covers) or "just as modelled")
        for one in self.axes:
            unit = "" if one.quantity.unit == "1" else f" {one.quantity.unit}"
            ends = f"{about(one.values[0])} to {about(one.values[-1])}{unit}"
            yield f"  {one.name:23} from {ends}"
        share = f"{found.found} of {found.cells} cells, {100 * found.found / found.cells:.1f} %"
        yield f"  start held              {share} (found by search, not proved)"
        if found.soonest is None:
            yield "  none is found here, which refutes none; `hoverproof tune` looks elsewhere"
        else:
            words = ", ".join(f"{name} = {about(value)}" for name, value in found.soonest.items())
            yield f"  soonest                 {words}"
            near = f"within {about(found.radius)} m after {about(found.time)} s"
            yield f"                          {near} (found by search)"
            if found.proved_time is not None:
                yield f"                          after {at_most(found.proved_time)} s, proved"
        if found.asked:
            words = "cells at the boundary, and the soonest: exact certificates"
            yield f"  proved                  {found.proved} of {found.asked} {words}"
        elif found.found:
            yield "  proved                  none asked for (--exact-boundary)"
        yield f"  map                     {self.path}"
        yield f"  figure                  {self.picture}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        found, (x, y) = self.found, self.axes
        best = None
        if found.soonest is not None:
            times = {"settling_time": found.time, "proved_time": found.proved_time}
            best = {**found.soonest, **times}
        return {
            "mission": self.mission.name,
            "theorem": "start",
            "covers": self.covers,
            "x": x.name,
            "y": y.name,
            "cells": found.cells,
            "found": found.found,
            "asked_exactly": found.asked,
            "proved": found.proved,
            "settling_radius": found.radius,
            "soonest": best,
            "out": str(self.path),
            "figure": str(self.picture),
            "units": {"settling_time": "s, found", "proved_time": "s", "settling_radius": "m"},
        }
