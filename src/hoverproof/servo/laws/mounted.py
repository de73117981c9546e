"""A law whose camera is mounted anywhere in the vehicle.

Directions that the camera sees are turned into body axes; nothing else is different if it sits at
the centre of mass. At r from there, in body axes, it sees the feature s(ξ + R r). A law flies with

    s = s(ξ + R r) + a,     a = s* - s(ξ* + R* r),

ξ* and R* the wanted hover, so that its error vanishes just there. With d/dt s(ξ) = -Ω × s - J V,
and a = J̄ r by the mean value theorem,

    ds/dt = -Ω × s - J V - (J - j I)(Ω × r) + Ω × (J̄ - j I) r     for any j:

of a J near j I, what Ω × r does to the image is what turning a does, and little is left of both.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from hoverproof.mission.sections import Mission
from hoverproof.plant import camera
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.mount import Mount
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.law import Law


def mounted(law: Law, mission: Mission) -> Law:
    """Return a law with the camera of a mission in its place.

    Parameters
    ----------
    law : Law
    mission : Mission

    Raises
    ------
    InputError
        If no hover sees the goal of the mission.
    """
    mount = Mount.of(mission)
    if mount is None or not mission.camera.has_arm:
        return law if mount is None else replace(law, mount=mount)
    return replace(law, mount=replace(mount, offset=_offset(law, mission, mount)))


def heading_at_hover(mission: Mission) -> float:
    """Return the yaw of the hover that a mission wants, rad.

    It is the heading; where there is none, the yaw of the start; and where the goal is not straight
    below, 0.

    Parameters
    ----------
    mission : Mission
    """
    if any((mission.goal.centroid or (0, 0, 0))[:2]):
        return 0.0
    heading = mission.goal.heading
    return float(mission.start.rotation[2] if heading is None else heading)


def _offset(law: Law, mission: Mission, mount: Mount) -> tuple[float, float, float]:
    turned = rotation_matrix(0.0, 0.0, heading_at_hover(mission))
    place = np.array([float(c) for c in hover_goal(mission).position])
    place += turned @ np.array(mount.position)
    points = np.array(mission.target.points, float).T
    seen = camera.directions(camera.body_points(*map(ca.SX, map(ca.DM, (points, place, turned)))))
    feature = np.array(ca.evalf(law.feature.seen(seen))).ravel()
    x, y, z = (float(c) - f for c, f in zip(law.goal_feature(mission), feature, strict=True))
    return x, y, z
