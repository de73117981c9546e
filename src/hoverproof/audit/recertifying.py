"""A mission proved anew, with tolerances that cover a flight that happened."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from hoverproof.certification.convergence import attraction
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.design.outcome import Infeasible, StartTuned
from hoverproof.design.tuning import Wish, gains_for
from hoverproof.mission.sections import Mission


@dataclass(frozen=True)
class Recertified:
    """What a proof with wider tolerances came to.

    Attributes
    ----------
    mission : Mission
        With these tolerances, and the gains that are proved, if any are.
    verdict : Exponential, optional
        None if nothing is proved.
    tuned : bool
        Whether the gains are other ones than before.
    reason : str
        Why nothing is proved; empty if it is.
    """

    mission: Mission
    verdict: Exponential | None
    tuned: bool
    reason: str


def recertified(wider: Mission, progress: Callable[[str], None]) -> Recertified:
    """Prove the start of a mission with its gains or, where that fails, with tuned ones.

    Parameters
    ----------
    wider : Mission
    progress : callable
        Is told what is being done.
    """
    own = attraction(wider, progress=progress)
    if isinstance(own.proved, Exponential):
        return Recertified(wider, own.proved, False, "")
    found = gains_for(wider, Wish(objective="start"), progress)
    if isinstance(found, StartTuned):
        return Recertified(found.mission, found.verdict, True, "")
    assert isinstance(found, Infeasible)
    return Recertified(wider, None, False, found.reason)
