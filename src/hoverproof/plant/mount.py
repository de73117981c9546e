"""A camera anywhere in the vehicle: its axes and place, and what makes up for the place."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import rotation_matrix

Three = tuple[float, float, float]


@dataclass(frozen=True)
class Mount:
    """How a camera sits in the vehicle, as numbers.

    Attributes
    ----------
    rotation : (3, 3) tuple of float
        Camera axes to body axes, row by row.
    position : (3,) tuple of float
        From the centre of mass, body axes, m.
    offset : (3,) tuple of float
        Added to the feature that is seen, body axes: for a camera that is not at the centre of
        mass, what the centre would see at the wanted hover less what the camera sees there.
    """

    rotation: tuple[Three, Three, Three]
    position: Three
    offset: Three = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, mission: Mission) -> Mount | None:
        """Return the mount of a mission, without an offset; None if its camera is not mounted.

        Parameters
        ----------
        mission : Mission
        """
        mounted = mission.camera
        if not mounted.is_mounted:
            return None
        rows = rotation_matrix(*map(float, mounted.rotation))
        rows = np.where(np.abs(rows - np.round(rows)) < 1e-15, np.round(rows), rows) + 0.0
        first, second, third = (_three(row) for row in rows)
        return cls((first, second, third), _three(mounted.position))

    def axes(self) -> ca.SX:
        """Return camera axes to body axes, (3, 3)."""
        return ca.SX(ca.DM(self.rotation))

    def arm(self) -> ca.SX:
        """Return the place of the camera from the centre of mass, (3, 1), body axes, m."""
        return ca.SX(ca.DM(self.position))

    def in_body(self, directions: ca.SX) -> ca.SX:
        """Return directions in body axes, (3, n), exactly as long.

        Parameters
        ----------
        directions : SX
            (3, n), camera axes, of any unit.
        """
        return self.axes() @ directions

    def added(self) -> ca.SX:
        """Return the offset, (3, 1), dimensionless."""
        return ca.SX(ca.DM(self.offset))


def _three(numbers: object) -> Three:
    x, y, z = (float(c) for c in np.asarray(numbers, float))
    return x, y, z
