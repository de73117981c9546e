"""What is read off the states of a flight: its angles, and when it settled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SETTLED = 0.1
"""A flight has settled when its error stays below this share of that at the start."""


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


def near_from(time: Array, far: Array, radius: float) -> float | None:
    """Return from when on a vehicle stays near, s; None if it is not near at the end.

    Parameters
    ----------
    time : (samples,)
        s.
    far : (samples,)
        How far it is, m.
    radius : float
        How far it may be, m.
    """
    outside = np.flatnonzero(far > radius)
    if not len(outside):
        return 0.0
    return None if outside[-1] + 1 == len(far) else float(time[outside[-1] + 1])
