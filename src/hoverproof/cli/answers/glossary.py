"""What the symbols of an answer mean, for its foot."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

from hoverproof.reporting.symbols import STATED, SYMBOLS

THEOREMS = re.compile(r"\btheorems? \d|[ΣΛΨ]")
"""What stands for a theorem."""


def legend(lines: Sequence[str]) -> list[str]:
    """Return lines that say what the symbols in some lines mean, and where theorems are stated.

    None if there is neither.

    Parameters
    ----------
    lines : sequence of str
    """
    text = "\n".join(lines)
    alone = re.findall(r"(?<![\w.-])\w(?![\w.-])|[ΣΛΨ]", text)
    words = "; ".join(f"{symbol}: {means}" for symbol, means in SYMBOLS.items() if symbol in alone)
    told = textwrap.wrap(f"Symbols: {words}", 80, subsequent_indent="  ") if words else []
    return [*told, *([f"Theorems: {STATED}"] if THEOREMS.search(text) else [])]
