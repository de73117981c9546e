"""The heading that the image tells, as C: of points in their order, and of what is kept of it."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from hoverproof.algebra.reciprocals import share_reciprocals
from hoverproof.errors import InputError
from hoverproof.export.emitter import statements
from hoverproof.export.options import Options
from hoverproof.mission.sections import Mission
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import heading_of_north
from hoverproof.servo.law import Law

DOWN = tuple(f"gravity_direction[{k}]" for k in range(3))
"""The fields of the unit vector down, of a struct before which they are named."""


def check_sees_points(law: Law, options: Options) -> None:
    """Refuse firmware whose heading is to be seen in a centroid.

    Parameters
    ----------
    law : Law
    options : Options

    Raises
    ------
    InputError
        If the camera delivers no points.
    """
    if law.sees_north and "points" not in (options.sensing, options.camera):
        reason = "must be points for goal.heading_from = 'image': a centroid tells no heading"
        raise InputError("--sensing", "", reason)


def north_seen(
    mission: Mission, options: Options, law: Law, image: Sequence[str], down: str, to: Sequence[str]
) -> tuple[str, ...]:
    """Return the statements from an image to the x axis of the world, or to its heading.

    Parameters
    ----------
    mission : Mission
    options : Options
    law : Law
    image : sequence of str
        2 n numbers in C, point by point.
    down : str
        Before the names of `DOWN`.
    to : sequence of str
        Where to put it: three places for the axis, two for (cos ψ, sin ψ).
    """
    n = len(mission.target.points)
    seen, gravity_direction = ca.SX.sym("seen", 2, n), ca.SX.sym("down", 3)
    points = ca.DM([[float(c) for c in point] for point in mission.target.points]).T
    directions = law.in_body(camera.spherical(seen))
    told = camera.north(directions, gravity_direction, ca.SX(points))
    if len(to) == 2:
        told = heading_of_north(told, gravity_direction)
    function = share_reciprocals(
        ca.Function("told", [seen, gravity_direction], [ca.cse(told)], ["s", "d"], ["told"])
    )
    given = [list(image), [down + name for name in DOWN]]
    return tuple(statements(function, given, {"told": list(to)}, options.precision))


def heading_kept(options: Options, north: Sequence[str], down: str) -> tuple[str, ...]:
    """Return the statements from the x axis of the world to in->heading.

    Parameters
    ----------
    options : Options
    north : sequence of str
        Three numbers in C, body frame.
    down : str
        Before the names of `DOWN`.
    """
    axis, gravity_direction = ca.SX.sym("axis", 3), ca.SX.sym("down", 3)
    told = ca.cse(heading_of_north(axis, gravity_direction))
    function = share_reciprocals(
        ca.Function("told", [axis, gravity_direction], [told], ["a", "d"], ["told"])
    )
    given = [list(north), [down + name for name in DOWN]]
    places = ["in->heading[0]", "in->heading[1]"]
    return tuple(statements(function, given, {"told": places}, options.precision))
