"""The command `derive`: the paper, judged."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import Json


def derive(
    *,
    equation: Annotated[
        list[str] | None,
        Parameter(negative="", help="Show this equation alone, in full: 31 (repeatable)."),
    ] = None,
    format_: Annotated[
        Literal["text", "markdown", "latex", "json"],
        Parameter(name="--format", help="How to print."),
    ] = "text",
    json_: Json = False,
) -> int:
    """Judge every equation and claim of the paper against the derived model.

    Each verdict is computed now: holds, holds with correction, false, definition or convention.

    Status 0 if every verdict is proved, 1 if not.

    Example: `hoverproof derive`

    Example: `hoverproof derive --equation 31 --equation 33`

    Example: `hoverproof derive --format markdown`
    """
    from hoverproof.cli.answers.derive import DeriveAnswer
    from hoverproof.paper.ledger import derive as judge

    answer = DeriveAnswer(judge(equation), format_, in_full=bool(equation))
    return tell(answer, json_ or format_ == "json")
