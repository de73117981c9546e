"""What `derive` answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from hoverproof.cli.answers.answer import Answer
from hoverproof.paper.judge import Judgement
from hoverproof.paper.ledger import all_proved, as_rows
from hoverproof.show.ledger import claim_text, ledger_latex, ledger_markdown, ledger_text


@dataclass(frozen=True)
class DeriveAnswer(Answer):
    """The paper's claims, judged, as a table or each ``in_full``."""

    explained: ClassVar[bool] = False

    judgements: Sequence[Judgement]
    format: str
    in_full: bool

    @property
    def status(self) -> int:
        """The exit status."""
        return int(not all_proved(self.judgements))

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        if self.format == "markdown":
            yield ledger_markdown(self.judgements)
        elif self.format == "latex":
            yield ledger_latex(self.judgements)
        elif self.in_full:
            yield "\n\n".join(map(claim_text, self.judgements))
        else:
            yield ledger_text(self.judgements)

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        return {"proved": self.status == 0, "claims": as_rows(self.judgements)}
