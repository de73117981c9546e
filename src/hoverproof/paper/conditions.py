"""What the printed theorem demands of a mission, beside what the mission has."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission
from hoverproof.paper.theorem import k3_limit, printed_conditions
from hoverproof.plant.goal import Interval, hover_goal
from hoverproof.servo.law import Design
from hoverproof.servo.loop import LoopNumbers, readout_function


@dataclass(frozen=True)
class Demand:
    """A condition of the theorem, numbers as printed and without regard to units.

    Attributes
    ----------
    name : str
        What is demanded to be above or below the limit.
    value, limit : float
        What the mission has, and the limit, in floating point: the bare numbers. Infinite if no
        value meets the condition.
    above : bool
        Whether the value must be above the limit.
    """

    name: str
    value: float
    limit: float
    above: bool

    @property
    def met(self) -> bool:
        """Whether the mission meets the condition."""
        return self.value > self.limit if self.above else self.value < self.limit

    @property
    def possible(self) -> bool:
        """Whether any value meets the condition."""
        return math.isfinite(self.limit)

    def text(self) -> str:
        """Return the condition with its numbers and whether it is met."""
        if not self.possible:
            return f"{self.name}: none is enough with such a k2 ({self.value:.3g}: not met)"
        sign, met = (">" if self.above else "<"), ("met" if self.met else "not met")
        return f"{self.name} {sign} {self.limit:.3g} ({self.value:.3g}: {met})"


def printed_demands(mission: Mission, eigenvalues: Interval) -> list[Demand]:
    """Return the conditions of the printed theorem (on k1…k4, and eq. 33) for a mission.

    Parameters
    ----------
    mission : Mission
    eigenvalues : (low, high)
        Bounds of the eigenvalues of Q, 1/m.

    Raises
    ------
    InputError
        If the goal of the mission cannot be seen.
    """
    k1, k2, k3, k4 = (float(getattr(mission.gains, k)) for k in Design.chain_gains())
    low, high = (float(x) for x in eigenvalues)
    q = [float(c) for c in hover_goal(mission).centroid_midpoint]
    weight, length = float(mission.vehicle.weight), math.hypot(*q)
    wanted_k3 = k3_limit(k1, k2, k3, q[2], length, low, high) if k2 > high else math.inf
    level_root = max(weight / (k1**2 * k2) - 2 * q[2], 0.0)
    return [
        Demand("k2", k2, high, above=True),
        Demand("k1", k1, math.sqrt(2 * weight * q[2] / k2), above=False),
        Demand("k3", k3, wanted_k3, above=True),
        Demand("k4", k4, 0.0, above=True),
        Demand("L(0)", start_level(mission), level_root**2 / 2, above=False),
    ]


def where_met(mission: Mission, values: Mapping[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Tell where all printed conditions on k1…k4 are met; the one on the start is not looked at.

    Parameters
    ----------
    mission : Mission
        Its vehicle and goal count.
    values : mapping of arrays of one shape
        ``k1``…``k4``, and ``lowest`` and ``highest`` eigenvalue of Q, 1/m.
    """
    q = [float(c) for c in hover_goal(mission).centroid_midpoint]
    vehicle = mission.vehicle
    with np.errstate(divide="ignore", invalid="ignore"):
        met = printed_conditions(
            float(vehicle.mass),
            float(vehicle.gravity),
            [values[k] for k in Design.chain_gains()],
            q[2],
            values["lowest"],
            values["highest"],
            math.hypot(*q),
        )
    return np.asarray(np.logical_and.reduce(list(met.values())))


def start_level(mission: Mission) -> float:
    """Return L at the start of a mission, with all weights 1.

    Parameters
    ----------
    mission : Mission
    """
    numbers = LoopNumbers.of(mission)
    read = readout_function(numbers.target_size)  # L depends on neither of the rotors' lengths
    seen = read(x=numbers.start, design=numbers.design, points=numbers.points)
    return float(seen["lyapunov"])
