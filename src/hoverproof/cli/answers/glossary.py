"""What the symbols of the answers mean, for the foot of an answer and a page of the manual."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

SYMBOLS = {
    "Q": "3x3, from velocity to motion of the centroid in the image; holds the unknown depths",
    "J": "3x3, from velocity to motion of the scaled centroid",
    "T": "thrust",
    "L": "Lyapunov function, half the weighted sum of the squared errors",
    "Σ": "11x11, decay of L: m L' = -XᵀΣX, X the errors",
    "W": "diagonal, weights of L",
    "f": "f(T), how the thrust enters Σ",
    "Λ": "Lyapunov function of the vehicle as modelled",
    "Ψ": "Lyapunov function that holds for every vehicle within tolerance",
}
"""In the order in which they are explained."""


def legend(lines: Sequence[str]) -> list[str]:
    """Return lines that say what the symbols in some lines mean; none if no symbol is there.

    Parameters
    ----------
    lines : sequence of str
    """
    alone = re.findall(r"(?<![\w.-])\w(?![\w.-])|[ΣΛΨ]", "\n".join(lines))
    words = "; ".join(f"{symbol}: {means}" for symbol, means in SYMBOLS.items() if symbol in alone)
    return textwrap.wrap(f"Symbols: {words}", 80, subsequent_indent="  ") if words else []
