"""The floating-point numbers of a flight, and what is read off them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.error_chain import Design

Array = NDArray[np.float64]

SETTLED = 0.1
"""A flight has settled when its error stays below this share of that at the start."""


@dataclass(frozen=True)
class FlightNumbers:
    """The floating-point numbers that a flight runs on.

    Attributes
    ----------
    design : (13,)
        In the order of `Design`.
    points : (3, n)
        Target, world frame, m.
    goal : (3,)
        ξ*, world frame, m.
    start : (19,)
        Packed state.
    """

    design: Array
    points: Array
    goal: Array
    start: Array

    @classmethod
    def of(cls, mission: Mission) -> FlightNumbers:
        """Round the numbers of a mission.

        Parameters
        ----------
        mission : Mission
        """
        goal = hover_goal(mission)
        start = mission.start
        state = [
            *start.position,
            *start.velocity,
            *rotation_matrix(*map(float, start.rotation)).T.ravel(),
            *start.rates,
            mission.vehicle.weight,
        ]
        return cls(
            design=_floats(Design.values(mission, goal.centroid_midpoint)),
            points=np.array(mission.target.points, float).T,
            goal=_floats(goal.position),
            start=_floats(state),
        )


def euler_angles(rotation: Array) -> Array:
    """Return roll, pitch, yaw in rad, (..., 3), of rotations (..., 3, 3).

    Parameters
    ----------
    rotation : (..., 3, 3)
        R = Rz(yaw) Ry(pitch) Rx(roll).
    """
    r = rotation
    roll = np.arctan2(r[..., 2, 1], r[..., 2, 2])
    pitch = np.arctan2(-r[..., 2, 0], np.hypot(r[..., 0, 0], r[..., 1, 0]))
    yaw = np.arctan2(r[..., 1, 0], r[..., 0, 0])
    return np.stack([roll, pitch, yaw], axis=-1)


def settled_index(error: Array) -> NDArray[np.int64]:
    """Return from which sample on an error stays below `SETTLED` of the first; (...,).

    The number of samples if it never does, or if there was no error at the start.

    Parameters
    ----------
    error : (..., samples), m
    """
    samples = error.shape[-1]
    outside = error > SETTLED * error[..., :1]
    after_last = samples - np.argmax(outside[..., ::-1], axis=-1)
    index: NDArray[np.int64] = np.where(outside.any(axis=-1), after_last, samples)
    return index


def _floats(values: Any) -> Array:
    return np.array([float(value) for value in values])
