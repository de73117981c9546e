"""The command `derive`: the paper, judged."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.console import Json, app, print_json


@app.command
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
    from hoverproof.paper.ledger import all_proved, as_rows
    from hoverproof.paper.ledger import derive as judge
    from hoverproof.show import ledger as show

    judgements = judge(equation)
    proved = all_proved(judgements)
    if json_ or format_ == "json":
        print_json({"proved": proved, "claims": as_rows(judgements)})
    elif format_ == "markdown":
        print(show.ledger_markdown(judgements))
    elif format_ == "latex":
        print(show.ledger_latex(judgements))
    elif equation:
        print("\n\n".join(map(show.claim_text, judgements)))
    else:
        print(show.ledger_text(judgements))
    return 0 if proved else 1
