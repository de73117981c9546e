"""What `tune` answers by default: gains, and how soon they are proved to settle."""

from __future__ import annotations

import shlex
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.algebra.decimals import angle_at_most, at_least
from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.attraction import considered
from hoverproof.cli.answers.beyond import beyond_text, covering
from hoverproof.cli.answers.exponential import PER_MASS, settled_text, view_text
from hoverproof.cli.answers.words import (
    about,
    enclosure,
    gain_units,
    gains_as_json,
    gains_text,
    hover_error_as_json,
    hover_error_text,
    limits_as_json,
    limits_text,
    numbers,
    wrapped,
    written_text,
)
from hoverproof.design.outcome import StartTuned

UNITS = {
    "settling_time": "s, to settling_radius for good, proved",
    "settling_time_before": "s, with the mission's own gains, found, not proved",
    "settling_time_before_rounding": "s, in floating point",
    "settling_time_flown": "s, in a flight",
    "settling_time_flown_before": "s, in a flight with the mission's own gains",
    "settling_radius": "m from the goal",
    "fill": "Ψ at the start over the level of the set",
    "decay_rate": "1/s, of Ψ",
    "tilt": "rad",
    "thrust": "N, of T times modelled over true mass",
    "rotor_thrust": "N, of each rotor",
    "field_of_view": "rad, from the optical axis",
    "bandwidth": "rad/s",
}


@dataclass(frozen=True)
class StartTunedAnswer(Answer):
    """Gains, and the mission file and the certificate that were written."""

    found: StartTuned
    written: str | None
    certificate: Path | None

    @property
    def considered(self) -> list[str]:
        """What the proof covers."""
        return considered(self.found.verdict)

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found, proved, covers = self.found, self.found.verdict, self.considered
        yield f"{found.mission.name}: tuned for its start, and proved (theorem 5)"
        yield from wrapped("for every vehicle", ", ".join(covers) or "just as modelled")
        for words in beyond_text(found.mission):
            yield f"  not covered: {words}"
        if sets := covering(found.mission):
            yield "    with these the proof and the gains would be about that:"
            yield from (f"    --set {setting}" for setting in sets)
        yield from gains_text(found.mission)
        yield from self._settled()
        yield f"  decay rate              Ψ falls as exp(-r t), r = {at_least(proved.rate)} 1/s"
        yield f"  tilt on the way         {angle_at_most(proved.tilt)} or less"
        yield f"  thrust                  in {enclosure(proved.thrust)} {PER_MASS}"
        yield f"  thrust of each rotor    in {enclosure(proved.rotor_thrust)} N"
        yield from view_text(proved)
        yield from hover_error_text(found.hover_error, found.mission)
        yield from limits_text(found.uses)
        binding = [use.name for use in found.uses if use.binds]
        if not binding:
            yield "  what binds: no limit above, the inequality of the proof alone"
        yield from written_text(self.written, self.certificate)
        if self.written is not None and self.certificate is not None:
            folder = str(Path(self.written).with_suffix("")) + "-firmware"
            options = ["--certificate", str(self.certificate), "--out", folder]
            yield f"Then: {shlex.join(['hoverproof', 'export', self.written, *options])}"

    def _settled(self) -> Iterator[str]:
        found = self.found
        yield f"  settled, proved         {settled_text(found.verdict)}"
        yield f"    the mission's own gains: {_sought(found)}"
        if found.why_longer is not None:
            yield from textwrap.wrap(
                found.why_longer, 80, initial_indent=" " * 4, subsequent_indent=" " * 4
            )
        yield f"  settled, in a flight    {_flown(found.flown, found)}"
        yield f"    the mission's own gains: {_flown(found.flown_before, found)}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        found, proved = self.found, self.found.verdict
        return {
            "mission": found.mission.name,
            "status": found.status,
            "objective": found.objective,
            "gains": gains_as_json(found.mission),
            "settling_time": float(proved.settling.time),
            "settling_radius": float(proved.settling.radius),
            "settling_time_before": None if found.before is None else float(found.before.time),
            "settling_time_before_rounding": found.estimate,
            "settling_time_flown": found.flown,
            "why_proved_longer": found.why_longer,
            "settling_time_flown_before": found.flown_before,
            "covers": found.mission.asks_to_cover(),
            "not_covered": list(beyond_text(found.mission)),
            "would_cover": covering(found.mission),
            "rotor_thrust": numbers(proved.rotor_thrust),
            "field_of_view": None if proved.field_of_view is None else float(proved.field_of_view),
            "fill": fill(found),
            "decay_rate": float(proved.rate),
            "tilt": float(proved.tilt),
            "thrust": numbers(proved.thrust),
            "bandwidth": found.bandwidth,
            **limits_as_json(found.uses),
            "hover_error": hover_error_as_json(found.hover_error),
            "out": self.written,
            "certificate": None if self.certificate is None else str(self.certificate),
            "units": {**gain_units(), **UNITS},
        }


def _sought(found: StartTuned) -> str:
    """Say when the mission's own gains settle, as `attraction` would prove it."""
    if found.before is None:
        return "no time is found by search"
    settled, radius = found.before, found.verdict.settling.radius
    near = "" if settled.radius == radius else f", within {about(settled.radius)} m"
    return f"{about(settled.time)} s{near} (by search, not proved)"


def _flown(time: float | None, found: StartTuned) -> str:
    if time is None:
        return f"not within {about(found.flown_for)} s"
    return f"after {about(time)} s"


def fill(found: StartTuned) -> float:
    """Return Ψ at the start over the level of the set."""
    return float(found.verdict.start_level / found.verdict.level)
