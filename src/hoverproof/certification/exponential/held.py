"""What a controller that runs in steps holds, and what an accelerometer that lags is behind.

All in floating point; `checker.Tolerant.changes` bounds the same exactly.
"""

from __future__ import annotations

import numpy as np

from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.vehicles import Vehicles

SAWTOOTH = 0.4053
"""Above 4/π²."""


def moved(limits: Limits) -> dict[str, list[tuple[str, float]]]:
    """Return by how much what is held moves, 1/s: each part by the sum of radii times parts.

    "level" is what is used of the image error by now, "lift" its third part, and "command" what is
    added to the command.

    Parameters
    ----------
    limits : Limits
    """
    v, h, r = limits.vehicles, limits.quickness[1], limits.reach
    if not v.behind:
        return {}
    early = v.control_period * limits.stretching
    if not early < 1:
        return {"lift": [("lifted", np.nan)]}
    own = (1 + v.torque) * v.gyroscopic + v.torque
    pulled, leaned = (1 + limits.stray) * v.pull, v.pace * (1 + limits.gust)
    turned = limits.turning / (1 - early)
    by_zeta = pulled * (leaned + v.in_image * h + h * r.force) + turned * v.yaw_rate * own
    sinks = [("sinks", v.pull), ("zeta", h * r.d3)] if v.control_period else []
    parts = {"lift": [*sinks, ("lifted", limits.lift)]}
    if v.control_period:
        parts["level"] = [("pulled", v.pull), ("zeta", leaned + h * r.d3), ("h3", v.yaw_rate)]
        parts["command"] = [
            ("pulled", pulled * v.yaw_rate),
            ("zeta", by_zeta),
            ("slowly", turned * (1 + v.torque) * v.stiff),
        ]
    return parts


def is_kept(limits: Limits, rate: float) -> bool:
    """Tell whether what is held is kept in mind at a rate.

    Parameters
    ----------
    limits : Limits
    rate : float
        r, 1/s.
    """
    v = limits.vehicles
    fades = rate * max(v.force_lag, v.control_period) < 1
    return fades and all(np.isfinite(r) for part in moved(limits).values() for _, r in part)


def factor(name: str, v: Vehicles, rate: float) -> float:
    """Return what Θ is multiplied by that bounds how a part of what is held moves, s².

    Parameters
    ----------
    name : str
        Of the part, see `moved`.
    v : Vehicles
    rate : float
        r, 1/s.
    """
    early, fades = rate * v.control_period, rate * v.force_lag
    if name != "lift":
        return SAWTOOTH * v.control_period**2 / (1 - early)
    return v.behind * (v.control_period + v.force_lag / (1 - fades)) / (1 - early)
