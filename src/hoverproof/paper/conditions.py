"""What the printed theorem demands of gains: the conditions as printed, beside a mission's own."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import written
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import Interval, hover_goal
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers, readout_function
from hoverproof.servo.variables import Design

Real = TypeVar("Real", Fraction, float)


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
        return f"{self.name} {sign} {written(self.limit, 3)} ({written(self.value, 3)}: {met})"


def demands_of(mission: Mission, eigenvalues: Interval) -> list[Demand] | None:
    """Return the conditions of the printed theorem; None for a law that it is not about.

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
    return printed_demands(mission, eigenvalues) if mission.law.is_papers else None


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
    law = HAMEL_MAHONY.flying(mission)
    numbers = LoopNumbers.of(mission, law)
    read = readout_function(numbers.target_size, law)  # L depends on neither of the rotors' lengths
    seen = read(x=numbers.start, design=numbers.design, points=numbers.points)
    return float(seen["lyapunov"])


def printed_conditions(
    mass: Any, gravity: Any, gains: Sequence[Any], q3: Any, low: Any, high: Any, length: Any = None
) -> dict[str, Any]:
    """Tell which conditions of the theorem are met; units are not looked at.

    Numbers may be arrays.

    Parameters
    ----------
    mass, gravity : number or array, kg and m/s²
    gains : sequence of numbers or arrays
        k1 kg m/s, k2 1/m, k3 and k4 kg/s.
    q3, length : number or array
        q3* and |q*|, dimensionless; by default q* is along e3, so that its length is q3*.
    low, high : number or array
        λmin and λmax of Q, 1/m.
    """
    a, b, k_3, k_4 = gains
    return {
        "k2": b > high,
        "k1": a**2 < 2 * mass * gravity * q3 / b,
        "k3": k_3 > k3_limit(a, b, k_3, q3, q3 if length is None else length, low, high),
        "k4": k_4 > 0,
    }


def k3_limit(a: Real, b: Real, k_3: Real, q3: Real, length: Real, low: Real, high: Real) -> Real:
    """Return what the theorem asks k3 to be above, for gains a = k1, b = k2 above high = λmax.

    f(Tmin) = (k1 k2 + k3)/(k1 q3*) at Tmin = 2 (k1² k2/m) q3*.

    Parameters
    ----------
    a, b, k_3 : number or expression
        k1 kg m/s, k2 1/m and k3 kg/s.
    q3, length : number or expression
        q3* and |q*|, dimensionless.
    low, high : number or expression
        λmin and λmax of Q, 1/m.
    """
    f_min = (a * b + k_3) / (a * q3)
    return (b + high) * (high + f_min * length) ** 2 / (low * (b - high))
