"""How old the frame is that the controller uses, at each sample of a flight."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.simulation.plan import Plan
from hoverproof.simulation.record import Record

Array = NDArray[np.float64]


def image_age(plan: Plan, flight: Record) -> Array:
    """Return the time since the exposure of the frame in use, (n,), s.

    A frame in which a point is out of view is not used. It is told by the sample nearest to it.

    Parameters
    ----------
    plan : Plan
    flight : Record
        Of the plan.
    """
    times = flight["time"].values
    steps = np.rint(times / plan.step).astype(np.int64)
    num, den = plan.schedule.frame
    count = int(steps[-1]) * num // den + 1
    exposed = -(-np.arange(count) * den // num)
    nearest = np.clip(np.searchsorted(steps, exposed), 0, len(steps) - 1)
    whole = _whole(plan, flight["image"].values[nearest])
    whole[0] = True  # at first there is nothing to hold
    return age_in_use(plan, times, exposed[whole], np.zeros(int(whole.sum())))


def age_in_use(plan: Plan, times: Array, exposed: NDArray[np.int64], late: Array) -> Array:
    """Return the time since the exposure of the frame in use at each time, (n,), s.

    Parameters
    ----------
    plan : Plan
    times : (n,)
        s.
    exposed : (m,)
        Steps of the exposures of the frames that are used.
    late : (m,)
        By how many steps each comes later than the latency says.
    """
    steps = np.rint(times / plan.step)
    waits = np.where(exposed > 0, plan.schedule.latency + late, 0)
    arrived = np.maximum.accumulate(exposed + waits)  # each waits for those before it
    used = np.searchsorted(arrived, np.maximum(steps - 1, 0), side="right") - 1
    return np.asarray(times - plan.step * exposed[np.maximum(used, 0)], np.float64)


def _whole(plan: Plan, images: Array) -> NDArray[np.bool_]:
    """Tell which images, (frames, n, 2), are within the edges of the camera."""
    sensors, lens = plan.mission.sensors, plan.features.lens
    if lens is not None:
        point = ca.SX.sym("point", 2)
        bent = ca.Function("pixel", [point], [lens.pixel(point)])
        flat = np.asarray(bent.map(images.size // 2)(images.reshape(-1, 2).T).full()).T
        pixels, edge = flat.reshape(images.shape), np.array([lens.width, lens.height])
        return np.asarray(((pixels > 0) & (pixels < edge)).all(axis=(1, 2)))
    if sensors.width is None or sensors.height is None or sensors.focal_length is None:
        return np.ones(len(images), bool)
    edge = np.array([float(sensors.width), float(sensors.height)]) / 2
    return np.asarray((abs(images) * float(sensors.focal_length) < edge).all(axis=(1, 2)))
