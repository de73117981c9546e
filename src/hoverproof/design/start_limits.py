"""What gains may not exceed on the way from the start: bandwidth, tilt, rotors and what is seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.question import Question
from hoverproof.design.limits import FirstCommand, Limits
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]
VIEW = "the field of view"


@dataclass(frozen=True)
class StartLimits:
    """The limits, and how far a point of the search is beyond each.

    Attributes
    ----------
    mission : Mission
        Its gains do not count.
    limits : Limits
    command : FirstCommand
    whole : Question
    """

    mission: Mission
    limits: Limits
    command: FirstCommand
    whole: Question

    def beyond(self, fours: Array) -> Array:
        """Return by which share gains are beyond each limit, below 0 if they keep it, (n, m).

        Parameters
        ----------
        fours : (n, 4)
            k1 to k4.
        """
        k1, k2, k3, k4 = fours.T
        fastest = float(self.mission.vehicle.mass) * self.limits.fastest
        excess = [(k1 * k2 + k3 + k4) / fastest - 1]
        if self.limits.tilt is not None or self.limits.rotors is not None:
            thrusts, tilt = self.command((k1, k2, k3, k4))
            if self.limits.tilt is not None:
                excess.append(tilt / self.limits.tilt - 1)
            if self.limits.rotors is not None:
                least, most = self.limits.rotors
                hover = float(self.mission.vehicle.weight) / 4
                excess += [thrusts.max(axis=0) / most - 1, (least - thrusts.min(axis=0)) / hover]
        return np.stack(excess, axis=1)

    def names(self) -> list[str]:
        """Return the names of what `beyond` says, and of what is not seen, in their order."""
        names = ["the bandwidth"] + ["the tilt"] * (self.limits.tilt is not None)
        if self.limits.rotors is not None:
            names += ["the largest thrust of a rotor", "the least thrust of a rotor"]
        return names + [VIEW] * (self.whole.half_angle is not None)
