"""What `tune --objective region` answers: gains, and how far hovers are certified."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.algebra.decimals import at_least
from hoverproof.certification.attraction.proof import why_no_barrier
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import (
    about,
    gain_units,
    gains_as_json,
    gains_text,
    goal_text,
    hover_error_as_json,
    hover_error_text,
    limits_as_json,
    limits_text,
    numbers,
    written_text,
)
from hoverproof.design.outcome import RegionTuned

WAYS = ("sideways", "up", "down")


@dataclass(frozen=True)
class RegionTunedAnswer(Answer):
    """Gains, and the mission file and the certificate that were written."""

    found: RegionTuned
    written: str | None
    certificate: Path | None

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found = self.found
        yield f"{found.mission.name}: tuned for the region of attraction, and proved"
        yield from gains_text(found.mission)
        yield f"  certified hovers        {reach_text(found.region)} of the goal"
        yield from goal_text(found.mission)
        own = "not proved" if found.before is None else reach_text(found.before)
        yield f"    the mission's own gains: {own}"
        yield from _barrier(found)
        yield from _rates(found)
        yield from hover_error_text(found.hover_error, found.mission)
        yield from limits_text(found.uses)
        yield from written_text(self.written, self.certificate)

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        certificate = None if self.certificate is None else str(self.certificate)
        written = {"out": self.written, "certificate": certificate}
        return {**region_tuned_as_json(self.found), **written}


def _barrier(found: RegionTuned) -> Iterator[str]:
    """Say what kind of region both are, and of which gains `attraction` may prove another one."""
    yield "    both are sets of all states, moving or not, in which the potential is low,"
    yield "    without regard to the start: attraction says whether that is inside"
    new, own = why_no_barrier(found.mission), found.before
    which = [] if own is None or why_no_barrier(own.mission) else ["the mission's own gains"]
    which += [] if new else ["the new ones"]
    if which:
        words = "with a barrier attraction may prove level hovers much farther away: of "
        words += " and ".join(which) + (f", not of the new ones ({new})" if new else "")
        yield from textwrap.wrap(words, 80, initial_indent=" " * 4, subsequent_indent=" " * 4)


def reach_text(region: Attraction) -> str:
    """Write how far hovers are certified."""
    far = [at_least(getattr(region.reach, way)) for way in WAYS]
    return f"{far[0]} m sideways, {far[1]} m up, {far[2]} m down"


def _rates(found: RegionTuned) -> Iterator[str]:
    slow, before = found.slowest_rate, about(found.slowest_rate_before)
    yield f"  slowest motion at goal  {about(slow)} 1/s, {before} with the mission's own gains"
    yield f"    time constant:           {about(1 / slow)} s (linearised)"
    rate = found.decay_rate
    decay = "not proved" if rate is None else f"{at_least(rate)} 1/s, proved"
    yield f"  decay rate of L         {decay} with the bounds of this mission"


def region_tuned_as_json(found: RegionTuned) -> dict[str, Any]:
    """Return gains and regions as an object for machines."""
    return {
        "mission": found.mission.name,
        "status": found.status,
        "objective": found.objective,
        "gains": gains_as_json(found.mission),
        "reach": _reach_as_json(found.region),
        "reach_before": _reach_as_json(found.before),
        "level": float(found.region.level),
        "weights": numbers(found.region.weights),
        "slowest_rate": found.slowest_rate,
        "slowest_rate_before": found.slowest_rate_before,
        "time_constant": 1 / found.slowest_rate,
        "time_constant_before": 1 / found.slowest_rate_before,
        "decay_rate": _real(found.decay_rate),
        "decay_rate_before": _real(found.decay_rate_before),
        "bandwidth": found.bandwidth,
        **limits_as_json(found.uses),
        "hover_error": hover_error_as_json(found.hover_error),
        "units": {
            **gain_units(),
            "reach": "m from the goal",
            "level": "m",
            "weights": "m",
            "slowest_rate": "1/s",
            "time_constant": "s",
            "decay_rate": "1/s",
            "bandwidth": "rad/s",
        },
    }


def _reach_as_json(region: Attraction | None) -> dict[str, float] | None:
    return None if region is None else {w: float(getattr(region.reach, w)) for w in WAYS}


def _real(value: Fraction | None) -> float | None:
    return None if value is None else float(value)
