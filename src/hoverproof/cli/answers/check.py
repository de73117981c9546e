"""What `check` answers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.cli.answers.answer import Answer


@dataclass(frozen=True)
class CheckAnswer(Answer):
    """What the checker said: a statement, or the reason of a rejection.

    With a ``mission``, where the certificate's differs from it.
    """

    certificate: Path
    statement: str | None
    reason: str | None
    mission: str | None
    differing: Sequence[str]

    @property
    def status(self) -> int:
        """The exit status."""
        return int(self.statement is None or bool(self.differing))

    def text(self) -> Iterator[str]:
        """Yield the lines for people: those of the checker, and if it is about the mission."""
        if self.statement is None:
            yield f"{self.certificate}: rejected: {self.reason}"
            return
        about = ""
        if self.differing:
            some = [*self.differing[:3], *(["..."] if len(self.differing) > 3 else [])]
            about = f", but it is about another mission than {self.mission}: {'; '.join(some)}"
        elif self.mission is not None:
            about = f", and it is about the mission {self.mission}"
        yield f"{self.certificate}: accepted{about}"
        words = f"Proved: {self.statement}"
        yield textwrap.fill(words, width=80, initial_indent="  ", subsequent_indent="  ")

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        answer: dict[str, Any] = {"certificate": str(self.certificate)}
        if self.statement is None:
            answer |= {"accepted": False, "reason": self.reason}
        else:
            answer |= {"accepted": True, "statement": self.statement}
        if self.mission is not None:
            about = {"mission": self.mission, "about_mission": self.status == 0}
            answer |= {**about, "differences": list(self.differing)}
        return answer
