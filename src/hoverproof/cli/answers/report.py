"""What `report` answers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.answers.answer import EXIT, Answer
from hoverproof.cli.answers.attraction import considered
from hoverproof.cli.answers.words import wrapped

if TYPE_CHECKING:
    from hoverproof.reporting.document import Report


@dataclass(frozen=True)
class ReportAnswer(Answer):
    """A report that was written."""

    mission: str
    written: Report
    path: Path

    @property
    def status(self) -> int:
        """The exit status."""
        return EXIT[self.written.verdict.status]

    @property
    def considered(self) -> list[str]:
        """What the proof from the start of the mission covers."""
        return considered(self.written.start) if self.written.start is not None else []

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        yield f"{self.mission}: gains {self.written.verdict.status}"
        for question, answer in self.written.glance:
            yield from wrapped(question.lower(), answer)
        yield f"  report                  {self.path} ({self.written.size / 1e6:.1f} MB)"
        for name, reason in self.written.missing.items():
            yield f"  without {name}: {reason}"

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {
            "mission": self.mission,
            "verdict": self.written.verdict.status,
            "glance": dict(self.written.glance),
            "missing": dict(self.written.missing),
            "bytes": self.written.size,
            "sha256": self.written.sha256,
            "out": str(self.path),
        }
