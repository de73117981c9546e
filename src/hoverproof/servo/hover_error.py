"""Where the vehicle hovers if its thrust or its mass is not the modelled one.

The law believes in the force F = -T e3 + m g ρ and integrates nothing. At rest the true force is
zero, so a vehicle whose weight over its thrust is `load` times the modelled one rests, level, at
T = m g load: the law takes it to be pulled by F = m g (1 - load) e3. Its rates U and Γ vanish where
δ3 = F/c + δ2 is zero with V = 0, that is at q = q* + F/c. So q3 is another one, and with it the
height. No hover sees a q3 at or below that of the plane of the highest target point, or one that
makes |q| as large as the number of points: there the vehicle reaches the target, or leaves. On its
way to a hover near the target it may swing through it before that, so these are the last errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca
from scipy.optimize import brentq

from hoverproof.mission import Mission
from hoverproof.plant.goal import HoverGoal, hover_at_height, hover_goal
from hoverproof.servo.error_chain import Design

PERCENT = 0.01
NEAR, FAR = 1e-6, 1e3
"""The lowest and the highest hover that is looked for, in heights of the goal."""


@dataclass(frozen=True)
class HoverError:
    """What an error of thrust or mass does to the hover, in floating point.

    Heights are above the mean of the target points, m; None where there is no hover. An error is a
    share: 0.01 is 1 %.

    Attributes
    ----------
    height : float
        Of the goal, m.
    less_thrust, more_thrust : float or None
        Heights with 1 % less and with 1 % more thrust than is commanded, m.
    heavier, lighter : float or None
        Heights with 1 % more and with 1 % less mass than is modelled, m.
    target_load, leaving_load : float
        Weight over thrust as a share of the modelled one, bare numbers: from the first on (above
        1) the vehicle reaches the target at the latest, below the second (below 1) it leaves; not
        above 0 if it never does.
    """

    height: float
    less_thrust: float | None
    more_thrust: float | None
    heavier: float | None
    lighter: float | None
    target_load: float
    leaving_load: float

    def rows(self) -> list[tuple[str, str]]:
        """Return it in words: (name, value), heights above the mean of the target."""

        def hover(height: float | None, end: str) -> str:
            return (
                f"none: it {end}" if height is None else f"{height:.3g} m, not {self.height:.3g} m"
            )

        def other(height: float | None) -> str:
            return "none" if height is None else f"{height:.3g} m"

        def percent(share: float) -> str:
            return f"{abs(share) / PERCENT:.3g} %"

        target, leaving = self.target_load, self.leaving_load
        sinks, leaves = "reaches the target", "leaves"
        return [
            (
                "hover, 1 % less thrust",
                f"{hover(self.less_thrust, sinks)} (1 % heavier: {other(self.heavier)})",
            ),
            (
                "hover, 1 % more thrust",
                f"{hover(self.more_thrust, leaves)} (1 % lighter: {other(self.lighter)})",
            ),
            (
                sinks,
                f"at latest from {percent(1 / target - 1)} less thrust, or "
                f"{percent(target - 1)} heavier",
            ),
            (
                leaves,
                f"from {percent(1 / leaving - 1)} more thrust, or {percent(leaving - 1)} lighter"
                if leaving > 0
                else "never, by such an error",
            ),
        ]


def hover_error(mission: Mission) -> HoverError:
    """Return what an error of thrust or mass does to the hover of a mission.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If no hover sees the goal of the mission.
    """
    goal = hover_goal(mission)
    q1, q2, q3 = (float(q) for q in goal.centroid_midpoint)
    per_load = _shift(mission)
    highest = math.sqrt(len(mission.target.points) ** 2 - q1**2 - q2**2)
    lowest = _seen_from(mission, goal, NEAR)
    loads = {
        "less_thrust": 1 / (1 - PERCENT),
        "more_thrust": 1 / (1 + PERCENT),
        "heavier": 1 + PERCENT,
        "lighter": 1 - PERCENT,
    }
    return HoverError(
        height=float(mission.height_of_target - goal.position[2]),
        target_load=1 + (q3 - lowest) / per_load,
        leaving_load=1 - (highest - q3) / per_load,
        **{
            name: _height(mission, goal, q3 + per_load * (1 - load), lowest, highest)
            for name, load in loads.items()
        },
    )


def _shift(mission: Mission) -> float:
    """Return m g/c, by which q3 falls for a load of 2 in place of 1."""
    d = Design.symbols()
    shift = ca.Function("shift", [d.vector()], [d.mass * d.gravity / d.stiffness])
    return float(shift([float(x) for x in Design.values(mission, [Fraction(0)] * 3)]))


def _room(mission: Mission, goal: HoverGoal) -> tuple[float, float]:
    """Return z of the highest target point, and the height of the goal above it, m."""
    top = min(z for _, _, z in mission.target.points)
    return float(top), float(top - goal.position[2])


def _seen_from(mission: Mission, goal: HoverGoal, share: float) -> float:
    """Return q3 seen at a share of the goal's height above the highest target point."""
    top, height = _room(mission, goal)
    return hover_at_height(mission, goal, top - share * height)[1][2]


def _height(
    mission: Mission, goal: HoverGoal, q3: float, lowest: float, highest: float
) -> float | None:
    """Return the height of the hover that sees a certain q3, m; None if there is none."""
    if not lowest < q3 < highest:
        return None
    near, far = math.log(NEAR), math.log(FAR)

    def missing(log_share: float) -> float:
        return _seen_from(mission, goal, math.exp(log_share)) - q3

    if missing(far) < 0:
        return None  # beyond a thousand times the height it has left
    top, height = _room(mission, goal)
    share = math.exp(brentq(missing, near, far, xtol=1e-10))
    return float(mission.height_of_target) - top + share * height
