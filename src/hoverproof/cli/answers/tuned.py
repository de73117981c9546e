"""What `tune` answers: gains that are proved, or what stands in the way."""

from __future__ import annotations

import shlex
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.problem import ONES
from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import (
    about,
    as_argument,
    bounds_as_json,
    gain_units,
    gains_as_json,
    gains_text,
    hover_error_as_json,
    hover_error_text,
    limits_as_json,
    limits_text,
    number,
    numbers,
)
from hoverproof.design.outcome import Infeasible, Tuned


@dataclass(frozen=True)
class TunedAnswer(Answer):
    """Gains, and the mission file that was written with them."""

    found: Tuned
    written: str | None

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        found, verdict = self.found, self.found.verdict
        yield (
            f"{found.mission.name}: tuned for {found.objective}, "
            f"and proved ({verdict.problem.footing})"
        )
        yield from gains_text(found.mission)
        yield from _rates(found)
        if verdict.problem.weights != ONES:
            yield f"  weights of L            {', '.join(map(number, verdict.problem.weights))}"
        slow = found.slowest_rate
        yield f"  slowest motion at goal  {about(slow)} 1/s (linearised)"
        yield from hover_error_text(found.hover_error, found.mission)
        yield from limits_text(found.uses)
        if not any(use.binds for use in found.uses):
            yield f"  what binds: the bounds of {verdict.problem.flow.symbol} and of the thrust"
        if self.written is None:
            yield "Next: the same with --out FILE.toml writes a mission file with these gains"
        else:
            yield f"  written to              {self.written}"
            yield f"Next: hoverproof certify {as_argument(self.written)}"
            yield f"Then: hoverproof attraction {as_argument(self.written)}, for whether the start"
            yield f"  is still held, which is no part of the objective {found.objective}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {**tuned_as_json(self.found), "out": self.written}


@dataclass(frozen=True)
class InfeasibleAnswer(Answer):
    """No gains, and why."""

    found: Infeasible

    @property
    def status(self) -> int:
        """The exit status."""
        return 1

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Say of tolerances that nothing was found for that they were asked for."""
        return {"asked for": left}

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield f"{self.found.mission.name}: infeasible"
        for part in self.found.reason.replace("; ", ";\n").split("\n"):
            yield from textwrap.wrap(part, 80, initial_indent="  ", subsequent_indent="    ")
        for advice in self.found.advice:
            yield f"  would help: {advice.words}"
            yield f"    proved to settle within {at_most(advice.time)} s, with"
            yield from (f"    --set {shlex.quote(setting)}" for setting in advice.settings)

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {**infeasible_as_json(self.found), "out": None}


def _rates(found: Tuned) -> Iterator[str]:
    rate = found.verdict.decay_rate
    yield f"  decay rate of L         {at_least(rate)} 1/s, proved"
    if found.before is None:
        yield "    the mission's own gains: not proved"
    else:
        own, times = at_least(found.before), float(rate / found.before)
        yield f"    the mission's own gains: {own} 1/s, proved; now {times:.3g} times that"


def tuned_as_json(found: Tuned) -> dict[str, Any]:
    """Return gains as an object for machines."""
    verdict, before = found.verdict, found.before
    rate = verdict.decay_rate
    return {
        "mission": found.mission.name,
        "status": found.status,
        "objective": found.objective,
        "gains": gains_as_json(found.mission),
        "decay_rate": float(rate),
        "decay_rate_before": None if before is None else float(before),
        "decay_rate_before_rounding": found.estimate,
        "improvement": None if before is None else float(rate / before),
        "margin": float(verdict.margin),
        **bounds_as_json(verdict.problem),
        "slowest_rate": found.slowest_rate,
        "bandwidth": found.bandwidth,
        "weights": numbers(verdict.problem.weights),
        **limits_as_json(found.uses),
        "hover_error": hover_error_as_json(found.hover_error),
        "units": {
            **gain_units(),
            "decay_rate": "1/s",
            "margin": "kg/s",
            "slowest_rate": "1/s",
            "bandwidth": "rad/s",
        },
    }


def infeasible_as_json(found: Infeasible) -> dict[str, Any]:
    """Return what stands in the way as an object for machines."""
    return {
        "mission": found.mission.name,
        "status": found.status,
        "reason": found.reason,
        "needed_bandwidth": found.needed_bandwidth,
        "advice": [
            {"words": a.words, "set": list(a.settings), "settling_time": float(a.time)}
            for a in found.advice
        ],
        "best": None if found.best is None else tuned_as_json(found.best),
    }
