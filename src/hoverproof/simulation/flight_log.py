"""What is noted of a flight at each step, whatever is kept of it: when it settled, how it ended.

The log is a part of what a vehicle remembers, so a single flight and one of many have the same one.
Steps count from 0, the start. The graph uses + * and the lesser or greater of two numbers alone,
which a lane of a vector can do as well.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.plant.rigid_body import RigidBodyState
from hoverproof.simulation.numbers import SETTLED

Array = NDArray[np.float64]

LOW = 0.05
"""A vehicle has come down to the target at this share of the goal's height above its top."""

TIPPED = 0.5
"""Cosine of the tilt, 60 degrees, from which on a vehicle has tipped over."""

LOG = {
    "goal": 3,
    "allowed": 1,
    "low": 1,
    "steps": 1,
    "outside": 1,
    "low_at": 1,
    "tipped_at": 1,
    "unseen_at": 1,
    "singular_at": 1,
}
"""The log: the goal (m), the square of the error that counts as settled (m²) and z at which a
vehicle is low (m); steps taken; the last step with a larger error; the first steps at which it was
low, tipped over, had a target point not before the camera, and no thrust above the singularity."""

LOG_SIZE = sum(LOG.values())
HUGE = 1e300
"""Makes of what is above 0 a number beyond all steps, and of what is below 0 one below them."""

NEVER = 1e250
"""What no step reaches."""

OUTCOMES = (
    "flown",
    "target_left_the_view",
    "hit_the_height_of_the_target",
    "tipped_over",
    "target_point_behind_the_camera",
    "thrust_fell_to_the_singularity",
    "diverged",
)
"""What became of a flight; its place here is its code. -1 stands for a run not flown yet."""


def begin(goal: Array, points: Array, positions: Array) -> Array:
    """Return the log at the start, (count, LOG_SIZE).

    Parameters
    ----------
    goal : (3,)
        ξ*, world frame, m.
    points : (3, n)
        Target, world frame, m.
    positions : (m, 3)
        Where vehicles start, world frame, m.
    """
    count, top = len(positions), points[2].min()
    allowed = SETTLED**2 * ((positions - goal) ** 2).sum(axis=1)
    low = top - LOW * (top - goal[2])
    held = [np.tile(goal, (count, 1)), allowed[:, None], np.full((count, 1), low)]
    return np.hstack([*held, np.zeros((count, 2)), np.full((count, 4), HUGE)])


def noted(
    log: ca.SX, before: RigidBodyState, after: ca.SX, depth: ca.SX, thrust_margin: ca.SX
) -> ca.SX:
    """Return the log after one more step, (LOG_SIZE, 1).

    Parameters
    ----------
    log : SX
        (k, 1), k = LOG_SIZE, SI units as in `LOG`.
    before : RigidBodyState
        At the beginning of the step.
    after : SX
        Position at its end, (3, 1), world frame, m.
    depth, thrust_margin : SX
        Of the nearest target point, m, and above the singularity, N, at the beginning.
    """
    part = dict(zip(LOG, ca.vertsplit(log, _ends()), strict=True))
    step, next_step = part["steps"], part["steps"] + 1

    def first(name: str, good: ca.SX) -> ca.SX:
        return ca.fmin(part[name], ca.fmax(step, good * HUGE))

    error = ca.sumsqr(after - part["goal"])
    changes = {
        "steps": next_step,
        "outside": ca.fmax(part["outside"], ca.fmin(next_step, (error - part["allowed"]) * HUGE)),
        "low_at": first("low_at", part["low"] - before.position[2]),
        "tipped_at": first("tipped_at", before.rotation[2, 2] - TIPPED),
        "unseen_at": first("unseen_at", depth),
        "singular_at": first("singular_at", thrust_margin),
    }
    return ca.vertcat(*(part | changes).values())


def _ends() -> list[int]:
    return [0, *np.cumsum(list(LOG.values())).tolist()]


def read(log: Array, name: str) -> Any:
    """Return one number of a log, (...), in the unit that `LOG` says.

    Parameters
    ----------
    log : (..., LOG_SIZE)
        SI units as in `LOG`.
    name : str
        Of its part, with one number.
    """
    return log[..., sum(LOG[other] for other in list(LOG)[: list(LOG).index(name)])]


def settled_at(log: Array, step: float) -> Array:
    """Return from when on a whole flight had settled, s; NaN if it never had; (...,).

    Parameters
    ----------
    log : (..., LOG_SIZE)
        At its end, SI units as in `LOG`.
    step : float
        s.
    """
    outside = read(log, "outside")
    good = (outside < read(log, "steps")) & (read(log, "allowed") > 0)
    return np.asarray(np.where(good, (outside + 1) * step, np.nan))


def ending(log: Array, *, diverged: bool) -> tuple[int, float]:
    """Return the code of what ended a flight before its time, and the step of it.

    A camera that leaves the view of a point ends a flight too, and is left when nothing else is.

    Parameters
    ----------
    log : (k,)
        At its end, SI units as in `LOG`.
    diverged : bool
        Whether its last state is no good number.
    """
    low, tipped, unseen, singular = (
        float(read(log, name)) for name in ("low_at", "tipped_at", "unseen_at", "singular_at")
    )
    if min(unseen, singular) >= NEVER:
        word = "diverged" if diverged else "target_left_the_view"
        return OUTCOMES.index(word), float(read(log, "steps"))
    if singular < unseen:
        return OUTCOMES.index("thrust_fell_to_the_singularity"), singular
    if min(low, tipped) > unseen:
        word = "target_point_behind_the_camera"
    else:
        word = "hit_the_height_of_the_target" if low <= tipped else "tipped_over"
    return OUTCOMES.index(word), unseen


def is_noted(code: int) -> bool:
    """Tell whether a log holds the step at which a flight ended so.

    Parameters
    ----------
    code : int
        Place in `OUTCOMES`, a bare number.
    """
    return OUTCOMES[code] not in ("flown", "target_left_the_view", "diverged")


def ending_words(code: int, at: float) -> str:
    """Say what ended a flight.

    Parameters
    ----------
    code : int
        Place in `OUTCOMES`, a bare number.
    at : float
        When, s.
    """
    told = {
        "target_left_the_view": "ended before {}: a target point left the field of view",
        "target_point_behind_the_camera": "ended at {}: a target point came behind the camera",
        "diverged": "diverged before {}",
    }
    name = OUTCOMES[code]
    return told.get(name, name.replace("_", " ") + " at {}").format(f"{at:g} s")
