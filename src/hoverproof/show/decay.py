"""The proved decay of L beside a flight, and how long the flight keeps to what the proof assumes.

Nothing is proved here: the rate is that of a verdict.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_below
from hoverproof.certification.flow import flow_of
from hoverproof.certification.gains import GainsVerdict
from hoverproof.certification.pattern import Pattern
from hoverproof.show.scene import Flight

YAW_RATE_ZERO = 1e-9


@dataclass(frozen=True)
class Decay:
    """A proved decay, L ≤ L(0) exp(-rate t), for as long as its assumptions hold.

    Attributes
    ----------
    rate : float
        1/s.
    until : float
        Time of the last sample up to which the flight keeps to the assumptions, s.
    """

    rate: float
    until: float

    def bound(self, times: NDArray[np.float64], start: float) -> NDArray[np.float64]:
        """Return L(0) exp(-rate t) at times in s, where `start` is L(0).

        Parameters
        ----------
        times : (n,)
            s.
        start : float
            L(0), dimensionless.
        """
        return np.asarray(start * np.exp(-self.rate * times), np.float64)

    def label(self) -> str:
        """Say what is proved, with the rate rounded down."""
        rate = float(decimal_below(Fraction(self.rate), 3))
        return f"certified: L ≤ L(0) exp(-{rate:g} t), t in s"


def decay_along(flight: Flight, verdict: GainsVerdict) -> Decay | None:
    """Return the decay that a verdict proves for a flight; None if it says nothing of it.

    What the proof assumes is looked up at the samples, in floating point: Q (or J) and the thrust
    within their bounds, and no turning about the vertical axis of the body.

    Parameters
    ----------
    flight : Dataset or Record
        From `hoverproof.simulate`, of the mission that was certified. Its attribute ``conditions``
        (JSON), if there is one, names what was added to the model, of which nothing is proved.
    verdict : ProvedGains, RefutedGains or UndecidedGains
        With weights 1, so that its L is the one recorded.
    """
    proved, problem = verdict.proved, verdict.problem
    added = set(json.loads(flight.attrs.get("conditions", "{}"))) - {"scatter"}
    if proved is None or added or any(w != 1 for w in problem.weights):
        return None
    positions, thrust = flight["position"].values, flight["thrust"].values
    low, high = (float(x) for x in problem.eigenvalues)
    least, most = problem.thrust
    kept = (
        flow_of(problem.mission).kept(Pattern.of(problem.mission), positions, low, high)
        & (thrust >= float(least))
        & (thrust <= float(most))
        & (np.abs(flight["body_rate"].values[:, 2]) <= YAW_RATE_ZERO)
    )
    samples = len(kept) if kept.all() else int(kept.argmin())
    if samples < 2:
        return None
    return Decay(float(proved.decay_rate), float(flight["time"].values[samples - 1]))
