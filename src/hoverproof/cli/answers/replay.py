"""What `replay` answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import wrapped

UNITS = {"thrust": "N", "torque": "N m", "rotor": "N", "throttle": "", "rate_command": "rad/s"}


@dataclass(frozen=True)
class ReplayAnswer(Answer):
    """The facts of a replay (`Replay.facts`), and what was written."""

    facts: Mapping[str, Any]
    path: Path
    figure: Path | None

    @property
    def status(self) -> int:
        """The exit status: 1 where the firmware met a fault, or the log is not whole."""
        return int(bool(self.facts["faults"] or self.facts["partial"]))

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        f = self.facts
        partial = f" (partial: {f['partial']})" if f["partial"] else ""
        yield f"{f['mission']}: {f['steps']} steps of the firmware{partial}"
        yield from wrapped("log", f["log"])
        yield from wrapped("firmware", f["firmware"])
        yield from wrapped(
            "period", f"{f['period']:.4g} s, {f['longest_period']:.4g} s at the longest"
        )
        step, longest = 1e6 * f["seconds_a_step"], 1e6 * f["longest_step"]
        words = f"{step:.3g} µs here, {longest:.0f} µs at the longest, called from Python"
        yield from wrapped("a step takes", words)
        for key, name in (("saturated", "at a limit"), ("fault", "faults")):
            count = f["saturated" if key == "saturated" else "faults"]
            since = "" if not count else f", first at {f[f'{key}_at']:.4g} s"
            yield from wrapped(name, f"{count} steps{since}")
        if not f["differences"]:
            yield from wrapped("commanded", "the log does not hold what was commanded")
        for name, off in f["differences"].items():
            unit = UNITS[name]
            words = f"off by {off['largest']:.3g} {unit} at most, at {off['at']:.4g} s; "
            yield from wrapped(name.replace("_", " "), words + f"{off['rms']:.3g} {unit} rms")
        yield f"  {'written to':22}  {self.path}"
        if self.figure is not None:
            yield f"  {'figure':22}  {self.figure}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        figure = None if self.figure is None else str(self.figure)
        return {**self.facts, "out": str(self.path), "figure": figure}
