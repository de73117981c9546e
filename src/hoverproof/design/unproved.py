"""What is told where there is no proof: what refuses it, and how the worst vehicle flies."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.certificate import exact
from hoverproof.certification.convergence import Converges
from hoverproof.certification.exponential.refusal import Refusal
from hoverproof.certification.exponential.refuting import refused
from hoverproof.certification.verdict import Undecided
from hoverproof.design.worst_vehicle import Flown, worst_flight
from hoverproof.errors import InputError
from hoverproof.files import write_text

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Unproved:
    """What was found about starts that are not proved.

    Attributes
    ----------
    refusal : Refusal or None
        States that refuse all weights, exact.
    flown : Flown or None
        A simulation.
    """

    refusal: Refusal | None
    flown: Flown | None

    def save(self, path: Path) -> None:
        """Write the states that refuse all weights as JSON.

        Parameters
        ----------
        path : Path

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        if self.refusal is not None:
            content = exact(self.refusal.content())
            write_text(path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def unproved(
    verdict: Converges, starts: Sequence[Start] | None, progress: Progress
) -> Unproved | None:
    """Look for what refuses a proof for every vehicle within tolerance, and fly the worst.

    Parameters
    ----------
    verdict : Attraction, Exponential, Sinks or Undecided
    starts : sequence of Start or None
        What was asked for; None stands for the start of the mission.
    progress : callable
        Is told what is being done.

    Returns
    -------
    Unproved, or None if it is decided, or for a mission without tolerances
    """
    mission = verdict.mission
    if not isinstance(verdict, Undecided) or mission.uncertainty.is_none:
        return None
    progress("looking for what refuses all weights")
    try:
        refusal = refused(mission, starts or [Start.of(mission)])
    except (ArithmeticError, ValueError, InputError):  # numbers beyond what can be computed with
        refusal = None
    if not mission.uncertainty.is_tolerant:
        return Unproved(refusal, None)
    progress("flying vehicles at the corners of the tolerances")
    if starts:
        middle = tuple((a + b) / 2 for a, b in starts[0].position)
        begin = mission.start.model_copy(update={"position": middle})
        mission = mission.model_copy(update={"start": begin})
    return Unproved(refusal, worst_flight(mission))
