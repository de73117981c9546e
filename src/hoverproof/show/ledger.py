"""The ledger as text, Markdown or LaTeX."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence

from hoverproof.paper.judge import Judgement

WIDTH = 80


def ledger_text(judgements: Sequence[Judgement]) -> str:
    """Return a table of all claims that fits 80 columns, with the counts of verdicts below.

    Parameters
    ----------
    judgements : sequence of Judgement
        From `derive`.
    """
    id_width = max(len(j.id) for j in judgements) + 2
    margin = " " * (id_width + 2)
    lines = []
    for j in judgements:
        head = f"{j.id:>{id_width}}  {str(j.verdict).upper()}: {j.title}"
        lines += textwrap.wrap(head, WIDTH, subsequent_indent=margin)
        lines += textwrap.wrap(j.reason, WIDTH, initial_indent=margin, subsequent_indent=margin)
    counts = Counter(str(j.verdict) for j in judgements)
    total = f"{len(judgements)} claims: " + ", ".join(f"{n} {v}" for v, n in counts.items())
    return "\n".join([*lines, "", *textwrap.wrap(total, WIDTH, subsequent_indent="  ")])


def claim_text(j: Judgement) -> str:
    """Return one claim with its printed and derived forms, and how they differ.

    Parameters
    ----------
    j : Judgement
    """
    printed, derived = j.printed.text(), j.derived.text()
    rows = [
        (f"{j.id}: {j.title}", ""),
        ("verdict", str(j.verdict)),
        ("reason", j.reason),
        ("printed", printed),
        ("derived", "the same" if derived == printed else derived),
    ]
    if j.difference and len(j.difference) < len(printed + derived):
        rows.append(("difference", j.difference))  # else it is both forms again
    if j.counterexample:
        point = ", ".join(f"{name}={value}" for name, value in sorted(j.counterexample.items()))
        rows.append(("printed form fails at", point))
    lines = [line for name, words in rows for line in (name, *_indented(words))]
    return "\n".join(lines)


def _indented(words: str) -> list[str]:
    return textwrap.wrap(words, WIDTH, initial_indent="  ", subsequent_indent="    ")


def ledger_markdown(judgements: Sequence[Judgement]) -> str:
    """Return a Markdown table of claims with typeset formulas.

    Parameters
    ----------
    judgements : sequence of Judgement
        From `derive`.
    """
    lines = ["| id | claim | verdict | reason | printed | derived |", "| --- " * 6 + "|"]
    for j in judgements:
        derived = "" if j.derived is j.printed else f"${j.derived.latex()}$"
        cells = [j.id, j.title, str(j.verdict), j.reason, f"${j.printed.latex()}$", derived]
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join(lines)


def ledger_latex(judgements: Sequence[Judgement]) -> str:
    """Return the claims as LaTeX: a paragraph each, with displayed formulas.

    Parameters
    ----------
    judgements : sequence of Judgement
        From `derive`.
    """
    parts = ["% for LuaLaTeX or XeLaTeX with amsmath; titles and reasons hold Greek letters"]
    for j in judgements:
        parts.append(rf"\paragraph{{{_plain(j.id)}: {_plain(j.title)}}} {j.verdict}:")
        parts.append(_plain(j.reason))
        parts.append(rf"\[ {j.printed.latex()} \]")
        if j.derived is not j.printed:
            parts.append(rf"derived: \[ {j.derived.latex()} \]")
    return "\n".join(parts)


def _plain(words: str) -> str:
    """Escape what LaTeX would read as markup."""
    return "".join(rf"\{c}" if c in "&%$#_{}" else c for c in words)
