"""A camera anywhere in the vehicle: its axes and place, and what makes up for the place."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from hoverproof.mission.sections import Mission
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import rotation_matrix

Three = tuple[float, float, float]


@dataclass(frozen=True)
class Mount:
    """How a camera sits in the vehicle, as numbers.

    Attributes
    ----------
    rotation : (3, 3) tuple of float
        Camera axes to body axes, row by row, dimensionless.
    position : (3,) tuple of float
        From the centre of mass, body axes, m.
    offset : (3,) tuple of float
        Added to the feature that is seen, body axes, dimensionless: for a camera that is not at the
        centre of mass, what that would see at the wanted hover less what the camera sees there.
    """

    rotation: tuple[Three, Three, Three]
    position: Three
    offset: Three = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, mission: Mission) -> Mount:
        """Return the mount of a mission's camera, without an offset.

        Parameters
        ----------
        mission : Mission
        """
        mounted = mission.camera
        if not mounted.is_mounted:
            return CENTRAL
        rows = rotation_matrix(*map(float, mounted.rotation))
        rows = np.where(np.abs(rows - np.round(rows)) < 1e-15, np.round(rows), rows) + 0.0
        first, second, third = (_three(row) for row in rows)
        return cls((first, second, third), _three(mounted.position))

    @property
    def is_central(self) -> bool:
        """Whether it is at the centre of mass, its axes those of the body."""
        return self == CENTRAL

    def axes(self) -> ca.SX:
        """Return camera axes to body axes, (3, 3)."""
        return ca.SX(ca.DM(self.rotation))

    def place(self, position: ca.SX, rotation: ca.SX) -> ca.SX:
        """Return where the camera is, (3, 1), world frame, m.

        Parameters
        ----------
        position : SX
            ξ, (3, 1), world frame, m.
        rotation : SX
            R, (3, 3), body to world.
        """
        if not any(self.position):
            return position
        return position + rotation @ ca.SX(ca.DM(self.position))

    def before(self, points: ca.SX, position: ca.SX, rotation: ca.SX) -> ca.SX:
        """Return the target points in the frame of the camera, (3, n), m.

        Parameters
        ----------
        points : SX
            P', (3, n), world frame, m.
        position, rotation : SX
            ξ, (3, 1), m, and R, (3, 3); see `place`.
        """
        axes = rotation if self.is_central else rotation @ self.axes()
        return camera.body_points(points, self.place(position, rotation), axes)

    def in_body(self, directions: ca.SX) -> ca.SX:
        """Return directions in body axes, (3, n), exactly as long.

        Parameters
        ----------
        directions : SX
            (3, n), camera axes, of any unit.
        """
        return directions if self.is_central else self.axes() @ directions

    def made_up(self, feature: ca.SX) -> ca.SX:
        """Return a feature with what makes up for the place of the camera, (3, 1), body axes.

        Parameters
        ----------
        feature : SX
            That the camera sees, (3, 1), body axes.
        """
        return feature + ca.SX(ca.DM(self.offset)) if any(self.offset) else feature


CENTRAL = Mount(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0))
"""At the centre of mass, its axes those of the body."""


def _three(numbers: object) -> Three:
    x, y, z = (float(c) for c in np.asarray(numbers, float))
    return x, y, z
