"""Where the vehicle hovers if its thrust or its mass is not the modelled one.

A law that models its force believes in F = -T e3 + m g ρ and integrates nothing. At rest the true
force is zero, so a vehicle whose weight over its thrust is `load` times the modelled one rests,
level, at T = m g load: the law takes it to be pulled by F = m g (1 - load) e3. Its rates U and Γ
vanish where δ3 = F/c + δ2 is zero with V = 0, that is at q = q* + F/c. So q3 is another one, and
with it the height. No hover sees a q3 at or below that of the plane of the highest target point, or
one that makes |q| as large as the sum of the weights: there the vehicle reaches the target, or
leaves. On its way to a hover near the target it may swing through it before that, so these are the
last errors.

A law that measures its force finds it to be zero at rest, and so rests at its goal whatever thrust
and mass are; of one with another feature than the centroid nothing is said here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import HoverGoal, hover_at_height, hover_goal
from hoverproof.servo.law import Law
from hoverproof.servo.laws.choices import IMAGE, INERTIAL
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers
from hoverproof.servo.variables import Design

PERCENT = 0.01
DOWN = [2.0**-k for k in range(20)]
UP = [2.0**k for k in range(1, 11)]
"""Heights of hovers that are looked for, as shares of that of the goal above the target."""
HALVINGS = 30
"""Of what is between two of them, to find one; better ways of SciPy take longer to import."""

Hover = tuple[float, list[float], float]


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
            return f"none: it {end}" if height is None else f"{at(height)}, not {self.height:.3g} m"

        def at(height: float | None) -> str:
            return "none" if height is None else f"at {height:.3g} m"

        def percent(share: float) -> str:
            return f"{abs(share) / PERCENT:.3g} %"

        target, leaving = self.target_load, self.leaving_load
        sinks, leaves = "sinks to the target", "climbs away"
        return [
            (
                "hover, 1 % less thrust",
                f"{hover(self.less_thrust, sinks)} (1 % more mass: {at(self.heavier)})",
            ),
            (
                "hover, 1 % more thrust",
                f"{hover(self.more_thrust, leaves)} (1 % less mass: {at(self.lighter)})",
            ),
            (
                sinks,
                f"{percent(1 / target - 1)} less thrust or {percent(target - 1)} more mass, "
                "at the latest",
            ),
            (
                leaves,
                f"{percent(1 / leaving - 1)} more thrust or {percent(leaving - 1)} less mass"
                if leaving > 0
                else "never",
            ),
        ]


def rests_as_modelled(law: Law) -> bool:
    """Tell whether a law errs as is said here: of the centroid, with a force that is modelled.

    At rest the vehicle is level, so it is the same where its goal is fixed.

    Parameters
    ----------
    law : Law
    """
    papers = HAMEL_MAHONY
    own = (law.feature.of, law.force, law.chain)
    return own == (papers.feature.of, papers.force, papers.chain) and law.goal in (IMAGE, INERTIAL)


def hover_error(mission: Mission, law: Law | None = None) -> HoverError:
    """Return what an error of thrust or mass does to the hover of a mission.

    Parameters
    ----------
    mission : Mission
    law : Law, optional
        One that `rests_as_modelled`; by default that of the mission.

    Raises
    ------
    InputError
        If no hover sees the goal of the mission.
    """
    column = _Column.of(mission)
    q1, q2, q3 = (float(q) for q in column.goal.centroid_midpoint)
    shift = LoopNumbers.of(mission, law).value(_shift)
    highest = math.sqrt(float(mission.target.whole) ** 2 - q1**2 - q2**2)
    loads = {
        "less_thrust": 1 / (1 - PERCENT),
        "more_thrust": 1 / (1 + PERCENT),
        "heavier": 1 + PERCENT,
        "lighter": 1 - PERCENT,
    }
    return HoverError(
        height=float(mission.height_of_target - column.goal.position[2]),
        target_load=1 + (q3 - column.hovers[0][2]) / shift,
        leaving_load=1 - (highest - q3) / shift,
        **{name: column.height(q3 + shift * (1 - load)) for name, load in loads.items()},
    )


@dataclass(frozen=True)
class _Column:
    """Hovers that see q1 and q2 of q*, one above the other.

    Attributes
    ----------
    mission : Mission
    goal : HoverGoal
    hovers : list of (share, (x, y), q3)
        From the lowest to the highest, by their share of the goal's height above the highest target
        point.
    """

    mission: Mission
    goal: HoverGoal
    hovers: list[Hover]

    @classmethod
    def of(cls, mission: Mission) -> _Column:
        """Follow the hovers down and up from the goal, each found near the one before."""
        column = cls(mission, hover_goal(mission), [])
        for shares in (DOWN, UP):
            near = [float(c) for c in column.goal.position[:2]]
            for share in shares:
                found = column.at(share, near)
                if found is None:
                    break
                near = found[1]
                column.hovers.append(found)
        column.hovers.sort(key=itemgetter(0))
        return column

    def z(self, share: float) -> float:
        """Return z at a share of the goal's height above the highest target point, m."""
        top = min(z for _, _, z in self.mission.target.points)
        return float(top) - share * float(top - self.goal.position[2])

    def at(self, share: float, near: list[float]) -> Hover | None:
        """Return the hover at a share of the goal's height, if it is found."""
        found = hover_at_height(self.mission, self.goal, self.z(share), near)
        return None if found is None else (share, found[0][:2], found[1][2])

    def height(self, q3: float) -> float | None:
        """Return the height of the hover that sees a certain q3, m; None if there is none."""
        for (low, near, below), (high, _, above) in pairwise(self.hovers):
            if below < q3 <= above:
                for _ in range(HALVINGS):
                    found = self.at((low + high) / 2, near)
                    if found is None:
                        return None
                    low, high = (found[0], high) if found[2] < q3 else (low, found[0])
                return float(self.mission.height_of_target) - self.z((low + high) / 2)
        return None


def _shift(d: Design) -> ca.SX:
    """Return m g/c, by which q3 falls for a load of 2 in place of 1."""
    return d.mass * d.gravity / d.stiffness
