"""How far a motion may still sink when what pulls it down is over, in floating point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hoverproof.certification.attraction.starts import Start
from hoverproof.mission.sections import Mission


@dataclass(frozen=True)
class Sinking:
    """The lags of the height behind what drives it; see `checker.Attraction.verify_barrier`.

    Attributes
    ----------
    slow, fast : float
        r <= s of the height's equation, 1/s.
    pull : float
        k1/m, m/s.
    deepest : float
        z, m, that the starts may sink to by their own motion.
    first, second : float
        Lags that the starts have, m.
    """

    slow: float
    fast: float
    pull: float
    deepest: float
    first: float
    second: float

    @classmethod
    def of(cls, mission: Mission, starts: Sequence[Start]) -> Sinking:
        """Bound the lags of motions from some starts.

        Parameters
        ----------
        mission : Mission
        starts : sequence of Start
        """
        v, gains = mission.vehicle, mission.gains
        m, k12 = float(v.mass), float(gains.k1 * gains.k2)
        kappa = (k12 + float(gains.k3)) / m
        root = np.sqrt(max(kappa**2 - 4 * kappa * k12 / m, 0.0))
        slow, fast = float((kappa - root) / 2), float((kappa + root) / 2)
        deepest, first, second = -np.inf, 0.0, 0.0
        for start in starts:
            speed = float(start.speed)
            rate = float((start.thrust + v.weight * start.tilt) / v.mass)
            ahead = max(speed / slow, (speed + rate / kappa) * (1 / slow + 1 / fast))
            deepest = max(deepest, float(start.position[2][1]) + ahead)
            first = max(first, (rate + slow * speed) / (slow * fast))
            second = max(second, speed / slow)
        return cls(slow, fast, float(gains.k1) / m, deepest, first, second)

    def lag(self, most: float) -> float:
        """Return how far a motion may be behind, m.

        Parameters
        ----------
        most : float
            Bound of |w|, dimensionless.
        """
        first = max(self.first, self.pull * most / self.fast)
        return first + max(self.second, self.fast * first / self.slow)
