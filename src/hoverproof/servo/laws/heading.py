"""The yaw that a mission asks for, held beside the error chain by any of its laws.

Ω̇3 = -(k_yaw Ω3 + k_heading sin(ψ - ψ*))/I3. The errors know nothing of it: for a goal straight
below they obey the same equations whatever Ω3 is. As |sin| ≤ 1, |Ω3| comes to stay below
k_heading/k_yaw, and is never above the larger of that and what it was at the start.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import casadi as ca

from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rigid_body
from hoverproof.servo.heading import Heading
from hoverproof.servo.law import Law
from hoverproof.servo.laws.choices import WithAccelerometer
from hoverproof.servo.laws.hamel_mahony import LAWS, law_of
from hoverproof.servo.laws.mounted import mounted
from hoverproof.servo.layout import column, scalar
from hoverproof.servo.variables import Design, Measurement


@dataclass(frozen=True)
class DesignWithHeading(Design):
    """What a law that turns to a heading is made of.

    Attributes
    ----------
    k_heading : SX
        Its gain, kg m²/s²: the torque for a sine of one.
    goal_heading : SX
        (cos ψ*, sin ψ*), (2, 1).
    """

    k_heading: ca.SX = scalar("kg m²/s²", gain=True)
    goal_heading: ca.SX = column("1", 2)

    @classmethod
    def numbers(cls, mission: Mission) -> dict[str, Sequence[Fraction]]:
        """Return the numbers of the fields; see `Design.numbers`.

        Parameters
        ----------
        mission : Mission
            With a heading.
        """
        yaw = float(mission.goal.heading or 0)
        wanted = (Fraction(math.cos(yaw)), Fraction(math.sin(yaw)))
        own = {"k_heading": (mission.k_heading,), "goal_heading": wanted}
        return {**super().numbers(mission), **own}


@dataclass(frozen=True)
class WithHeading(Measurement):
    """What a compass or the image tells, besides.

    Attributes
    ----------
    heading : SX
        (cos ψ, sin ψ), (2, 1), ψ the yaw; (0, 0) where it is not known: yaw is damped alone.
    """

    heading: ca.SX = column("1", 2)


@dataclass(frozen=True)
class WithAccelerometerAndHeading(WithAccelerometer):
    """What an accelerometer, and a compass or the image tell, besides.

    Attributes
    ----------
    heading : SX
        (cos ψ, sin ψ), (2, 1); see `WithHeading`.
    """

    heading: ca.SX = column("1", 2)


_LAYOUTS: dict[type[Measurement], type[Measurement]] = {
    Measurement: WithHeading,
    WithAccelerometer: WithAccelerometerAndHeading,
}


def _turning(z: WithHeading, d: DesignWithHeading) -> ca.SX:
    """Return -(k_heading/I3) sin(ψ - ψ*)."""
    across = z.heading[1] * d.goal_heading[0] - z.heading[0] * d.goal_heading[1]
    return -d.k_heading / d.inertia[2] * across


def _nose(rotation: ca.SX, gravity_direction: ca.SX, directions: ca.SX, points: ca.SX) -> ca.SX:
    return rigid_body.heading(rotation)


def _seen(rotation: ca.SX, gravity_direction: ca.SX, directions: ca.SX, points: ca.SX) -> ca.SX:
    north = camera.north(directions, gravity_direction, points)
    return rigid_body.heading_of_north(north, gravity_direction)


def _rate(z: WithHeading) -> ca.SX:
    return rigid_body.heading_rate(z.heading, z.gravity_direction, z.rate)


COMPASS = Heading("compass", _LAYOUTS.__getitem__, _nose, _turning, _rate)
"""The yaw that an autopilot estimates, with a compass."""

FROM_IMAGE = Heading("image", _LAYOUTS.__getitem__, _seen, _turning, _rate, of_image=True)
"""The yaw that the image tells of a target that is flat and level, its points in their order."""

HEADED = {
    choices: replace(law, design=DesignWithHeading, heading=COMPASS)
    for choices, law in LAWS.items()
}
"""The eight laws, turning to a heading by a compass."""


def flown_law(mission: Mission) -> Law:
    """Return the law that a mission flies with: the one it names, with its heading and its camera.

    Parameters
    ----------
    mission : Mission
    """
    law = law_of(mission)
    if mission.goal.heading is not None:
        law = HEADED[law.feature.name, law.goal.name, law.force.name]
    if mission.goal.heading_from == "image":
        law = replace(law, heading=FROM_IMAGE)
    return mounted(law.flying(mission), mission)
