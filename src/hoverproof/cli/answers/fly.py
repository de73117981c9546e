"""What `fly` says while it flies, and how it answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.answers.answer import Answer

if TYPE_CHECKING:
    from hoverproof.mavlink.report import Report

INTERRUPTED = 130


def status_line(report: Report) -> str:
    """Say in 79 columns how a flight stands."""
    words = f"{report.time:7.1f} s  "
    if report.phase == "waiting":
        return f"{words}waiting for {report.why}"[:79]
    words += f"{report.phase:6}"
    if report.image_age is not None:
        words += f"  image {report.image_age:4.2f} s"
    if report.metres is not None:
        words += f"  error {report.metres:5.3f} m"
    elif report.error is not None:
        words += f"  error {report.error:5.3f}"
    if report.rates is not None:
        words += "  rates" + "".join(f" {rate:+5.2f}" for rate in report.rates)
    if report.throttle is not None:
        words += f"  {report.throttle:4.2f}"
    return f"{words}{'  !' if report.watched else ''}"[:79]


def status_json(report: Report) -> dict[str, Any]:
    """Return how a flight stands, for machines."""
    return {"status": asdict(report)}


@dataclass(frozen=True)
class FlyAnswer(Answer):
    """How a flight over MAVLink ended.

    `flown` tells whether the law has had the vehicle, `fault` whether a fault ended it, and
    `fallback` what the autopilot does now, in words.
    """

    name: str
    report: Report
    flown: bool
    fault: bool
    fallback: str
    certified: bool
    log: Path | None

    @property
    def status(self) -> int:
        """The exit status."""
        return INTERRUPTED if self.report.why == "interrupted" else int(self.fault)

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        report = self.report
        yield f"{self.name}: {'handed back' if self.flown else 'not flown'}: {report.why}"
        if self.flown:
            yield f"  {report.sent} setpoints sent, none any more"
            yield f"  {report.autopilot} {self.fallback}"
        if report.metres is not None:
            yield f"  error     about {report.metres:.3g} m at the end, by the image"
        elif report.error is not None:
            yield f"  error     {report.error:.3g} at the end, of the feature"
        if not self.certified:
            yield "  nothing is proved of these gains"
        if self.log is not None:
            yield f"  log       {self.log}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {
            "mission": self.name,
            "flown": self.flown,
            "fault": self.fault,
            "certified": self.certified,
            **asdict(self.report),
            "log": None if self.log is None else str(self.log),
        }
