"""When a flight has settled, and why a settling time that is proved is much longer."""

from __future__ import annotations

import numpy as np

from hoverproof.certification.exponential.proof import settling
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import Uncertainty
from hoverproof.plant.goal import hover_goal
from hoverproof.simulation.numbers import near_from
from hoverproof.simulation.record import Record

ALIKE = 4
"""Times are alike if the one is at most so many times the other."""


def near_goal_from(mission: Mission, flight: Record, radius: float) -> float | None:
    """Return from when on a flight stays near its goal, s; None if it is not near at the end.

    Parameters
    ----------
    mission : Mission
    flight : Record
    radius : float
        How far from the goal is near, m.
    """
    goal = np.array([float(c) for c in hover_goal(mission).position])
    far = np.linalg.norm(flight["position"].values - goal, axis=1)
    return near_from(flight["time"].values, far, radius)


def why_longer(verdict: Exponential, flown: float | None) -> str | None:
    """Say what makes a proved settling time so much longer than a flown one; None if it is not.

    What tolerances have to do with it is found by searching for weights without any of them.

    Parameters
    ----------
    verdict : Exponential
    flown : float or None
        When the vehicle as modelled has settled as near in a flight, s; None if it has not.
    """
    time = float(verdict.settling.time)
    if flown is None or time <= ALIKE * flown:
        return None
    symbol = "J" if verdict.mission.law.feature == "scaled" else "Q"
    low, high = map(float, verdict.slope)
    whole = (
        f"it bounds {symbol} once for all the way, from {low:.3g} to {high:.3g} 1/m, and takes "
        "the slowest decay in these bounds"
    )
    words = f"{time / flown:.2g} times as long as in a flight of the vehicle as modelled: "
    if not verdict.mission.uncertainty.covers():
        return words + whole
    exact = verdict.mission.model_copy(update={"uncertainty": Uncertainty()})
    alone = settling(exact)
    if alone is None or alone.time > time or alone.radius != verdict.settling.radius:
        return words + whole
    share = 100 * (1 - float(alone.time) / time)
    return f"{words}the tolerances cost {share:.2g} % (found by search); besides, {whole}"
