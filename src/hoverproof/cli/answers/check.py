"""What `check` answers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from hoverproof.cli.answers.answer import EXIT, Answer

if TYPE_CHECKING:
    from hoverproof.certification.replay import Replay


@dataclass(frozen=True)
class CheckAnswer(Answer):
    """What the checker said: a statement, or the reason of a rejection.

    With a ``mission``, where the certificate's differs from it; what Coq ``decided``, if asked.
    """

    explained: ClassVar[bool] = False  # it says what the checker says, and no more

    certificate: Path
    statement: str | None
    reason: str | None
    mission: str | None
    differing: Sequence[str]
    decided: Replay | None = None

    @property
    def status(self) -> int:
        """The exit status."""
        decided = self.decided
        if self.statement is None or self.differing or (decided and decided.refused):
            return EXIT["refuted"]
        return EXIT["undecided"] if decided and not decided.shown else EXIT["proved"]

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
        if self.decided is not None:
            yield from self.coq(self.decided)

    @staticmethod
    def coq(decided: Replay) -> Iterator[str]:
        """Yield the lines about what Coq decided."""
        if decided.refused:
            yield f"Coq: not accepted: {decided.refused} is not found true"
        elif not decided.shown:
            yield "Coq: not covered"
        else:
            yield "Coq: accepted"
        left = [f"Not by Coq: {decided.left}."] if decided.left else []
        for words in (*decided.shown, *left):
            yield textwrap.fill(words, width=80, initial_indent="  ", subsequent_indent="    ")

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        coq, accepted = None, self.statement is not None
        if self.decided is not None:
            shown, refused = list(self.decided.shown), self.decided.refused or None
            coq = {"shown": shown, "left": self.decided.left, "refused": refused}
        return {
            "certificate": str(self.certificate),
            "accepted": accepted,
            "statement": self.statement,
            "reason": self.reason,
            "coq": coq,
            "mission": self.mission,
            "about_mission": None if self.mission is None else accepted and not self.differing,
            "differences": list(self.differing),
        }
