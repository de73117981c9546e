"""A lemma of a ledger: what it says, why, and the identities that are computed for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Lemma:
    """A statement, its proof in words, and the identities that the proof leans on.

    Attributes
    ----------
    id, title : str
    statement, proof : str
        In words and formulas.
    identities : callable
        Returns whether each identity holds, by exact computation, under its name.
    """

    id: str
    title: str
    statement: str
    proof: str
    identities: Callable[[], dict[str, bool]]

    def proved(self) -> bool:
        """Compute whether every identity of the proof holds."""
        return all(self.identities().values())
