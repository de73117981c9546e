"""What each run of a plan starts and flies with: the mission's numbers, and what is drawn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.servo.layout import place
from hoverproof.simulation import gyro, noise
from hoverproof.simulation.flight_log import begin
from hoverproof.simulation.plan import Plan
from hoverproof.simulation.sensing import IMU_NOISE
from hoverproof.simulation.step import flight_states
from hoverproof.simulation.surroundings import HeadedSurroundings, of_vehicle

Array = NDArray[np.float64]

UNLIMITED = 1e300
IMU_BIAS_DRAW, GUST_DRAW, SCATTER_DRAW = 0, 8, 16
"""First channels of what is drawn before a flight."""


def memory_and_parameters(plan: Plan, runs: NDArray[np.int64]) -> tuple[Array, Array]:
    """Return where runs start, (count, MEMORY), and what they fly with, (count, PARAMS).

    Parameters
    ----------
    plan : Plan
    runs : (count,)
        Their numbers, from 0.
    """
    mission, numbers, count = plan.mission, plan.numbers, len(runs)
    drawn = _scatter(plan, runs)
    start = np.tile(numbers.start, (count, 1))
    start[:, :3] += drawn["position"]
    start[:, 3:6] += drawn["velocity"]
    if plan.scattered and any(mission.scatter.rotation):
        pairs = zip(mission.start.rotation, drawn["rotation"].T, strict=True)
        angles = [float(a) + d for a, d in pairs]
        start[:, 6:15] = rotation_matrix(*angles).transpose(2, 1, 0).reshape(count, 9)
    start[:, 15:18] += drawn["rates"]
    design = np.tile(numbers.design, (count, 1))
    arm, drag = float(mission.vehicle.reach), float(mission.vehicle.drag_ratio)
    if plan.ideal:
        memory = flight_states(start, numbers.goal, numbers.points)
        return memory, np.hstack([design, np.tile([plan.step, arm, drag], (count, 1))])

    values = _surroundings(plan, runs, drawn)
    around = plan.features.surroundings(numbers.law, plan.rotors)
    held = np.hstack([values[f].reshape(count, -1) for f in around.sizes()])
    low, high = values["rotor_min"][0], values["rotor_max"][0]
    hover = np.clip(np.array(mission.vehicle.hover_thrusts, float), low, high)
    most = np.finfo(float).max
    start[:, -1] = (hover * values["rotor_shares"]).sum(axis=1)
    parts = {
        "state": start,
        "depth": most,
        "thrust_margin": most,
        "view": most,
        "command": hover.sum(),
        "rotors": hover,
        "rotor_commands": hover,
        "gust": float(mission.wind.gust) * _normals(plan, runs, GUST_DRAW, 3),
        "log": begin(numbers.goal, numbers.points, start[:, :3]),
        "attitude": gyro.START,
    }
    layout = plan.features.layout(numbers.law, plan.rotors)
    if "accelerometer" in layout:  # it has felt the forces of the start for long
        forces = plan.felt.map(count)(start.T, parts["gust"].T, held.T)
        parts["accelerometer"] = np.array(forces).T
    memory = np.zeros((count, sum(layout.values())))
    for name in layout.keys() & parts.keys():
        memory[:, place(layout, name)] = parts[name]
    return memory, np.hstack([design, held])


def lag_shares(time_constant: float, step: float) -> tuple[float, float]:
    """Return what share a first-order low-pass keeps over a step, and takes of the newest value.

    Parameters
    ----------
    time_constant, step : float
        s; without a time constant it takes the newest value alone.
    """
    if not time_constant:
        return 0.0, 1.0
    taken = -math.expm1(-step / time_constant)
    return 1 - taken, 1 - taken * time_constant / step


def _limits(mission: Mission) -> dict[str, Any]:
    """Return the limits of each rotor and of all together, N."""
    values: dict[str, Any] = {}
    ends = zip(*mission.rotor_limits, strict=True)
    for name, missing, each in zip(("min", "max"), (-UNLIMITED, UNLIMITED), ends, strict=True):
        own = [missing if end is None else float(end) for end in each]
        alike = len({*own}) == 1  # rounded once, as they are for rotors that are all the same
        values[f"rotor_{name}"] = np.array(own)
        values[f"total_{name}"] = len(own) * own[0] if alike else sum(own)
    return values


def _surroundings(plan: Plan, runs: NDArray[np.int64], drawn: dict[str, Array]) -> dict[str, Array]:
    """Return the numbers of all that may surround runs, (count, size) each."""
    m, count = plan.mission, len(runs)
    s, r, w, wrong, vehicle = m.sensors, m.rotors, m.wind, m.model_error, m.vehicle
    tilt = [float(a) + d for a, d in zip(wrong.camera_tilt, drawn["camera_tilt"].T, strict=True)]
    mounted = rotation_matrix(*tilt)  # (3, 3, count)
    if not (mount := plan.numbers.law.mount).is_central:
        mounted = np.einsum("ijk,jl->ilk", mounted, np.array(mount.rotation))
    focal = float(s.focal_length or 1)
    bias = _normals(plan, runs, IMU_BIAS_DRAW, IMU_NOISE + 4)
    time_constant = float(r.time_constant)
    lag = [math.exp(-k * plan.step / time_constant) if time_constant else 0.0 for k in (0, 0.5, 1)]
    gust, kept = float(w.gust), math.exp(-plan.step / float(w.gust_time))
    period = plan.step if s.control_rate is None else 1 / float(s.control_rate)
    inertia = np.array([float(i) for i in vehicle.moments])
    inertia_error = _of_moments(np.array(wrong.inertia, float) + drawn["inertia"], len(inertia))
    strength = 1 + float(wrong.thrust) + drawn["thrust"]
    felt_late, felt_new = lag_shares(float(s.accelerometer_time_constant), plan.step)
    values: dict[str, Any] = {
        "mass": float(vehicle.mass) * (1 + float(wrong.mass) + drawn["mass"][:, 0]),
        "inertia": inertia * (1 + inertia_error),
        "camera_x": mounted[:, 0].T,
        "camera_y": mounted[:, 1].T,
        "camera_z": mounted[:, 2].T,
        "wind": np.array([float(c) for c in w.mean]),
        "gyro_bias": float(s.gyro_bias) * bias[:, :3],
        "velocity_bias": float(s.velocity_bias) * bias[:, 3:6],
        "gravity_bias": float(s.gravity_bias) * bias[:, 6:9],
        "arm": float(vehicle.reach),
        "drag_ratio": float(vehicle.drag_ratio),
        "air_drag": float(w.drag),
        "step": plan.step,
        "period": period,
        "left_now": lag[0],
        "left_half": lag[1],
        "left_whole": lag[2],
        "gust_kept": kept,
        "gust_added": gust * math.sqrt(1 - kept * kept),
        **_limits(m),
        "image_noise": float(s.pixel_noise) / focal,
        "image_resolution": float(s.pixel_resolution) / focal,
        "half_width": UNLIMITED if s.width is None else float(s.width) / 2 / focal,
        "half_height": UNLIMITED if s.height is None else float(s.height) / 2 / focal,
        "gyro_noise": float(s.gyro_noise),
        "velocity_noise": float(s.velocity_noise),
        "gravity_noise": float(s.gravity_noise),
        "accelerometer_bias": float(s.accelerometer_bias) * bias[:, 9:12],
        "accelerometer_noise": float(s.accelerometer_noise),
        "accelerometer_kept": felt_late,
        "accelerometer_newest": felt_new,
        "rotor_shares": strength * (1 + np.array(wrong.rotors or [0] * plan.rotors, float)),
        "heading_bias": float(s.heading_bias) * bias[:, 12],
        "heading_noise": float(s.heading_noise),
        "true_arm": float(vehicle.reach) * (1 + float(wrong.arm) + drawn["arm"][:, 0]),
    }
    whole = of_vehicle(HeadedSurroundings, plan.rotors, len(vehicle.moments))
    return {
        name: np.broadcast_to(np.reshape(values[name], (-1, size)), (count, size))
        for name, size in whole.sizes().items()
    }


def _of_moments(shares: Array, moments: int) -> Array:
    """Return by what share all moments change, (count, moments), from those of the diagonal.

    A product of inertia changes so that the matrix stays that of a body.
    """
    if moments == 3:
        return shares
    root = np.sqrt(1 + shares)
    pairs = [root[:, i] * root[:, j] - 1 for i, j in ((0, 1), (0, 2), (1, 2))]
    return np.column_stack([shares, *pairs])


def _scatter(plan: Plan, runs: NDArray[np.int64]) -> dict[str, Array]:
    """Return what is added to each number of the mission, (count, size) each."""
    scatter = plan.mission.scatter
    spreads = {
        name: np.atleast_1d(np.array(getattr(scatter, name), float))
        for name in type(scatter).model_fields
        if name != "distribution"
    }
    if not plan.scattered:
        return {name: np.zeros((len(runs), spread.size)) for name, spread in spreads.items()}
    draw = _normals if scatter.distribution == "normal" else _uniforms
    drawn, channel = {}, SCATTER_DRAW
    for name, spread in spreads.items():
        drawn[name] = spread * draw(plan, runs, channel, spread.size)
        channel += 2
    return drawn


def _normals(plan: Plan, runs: NDArray[np.int64], channel: int, size: int) -> Array:
    """Return standard normal numbers, (count, size)."""
    return _drawn(noise.normals, plan, runs, channel, size)


def _uniforms(plan: Plan, runs: NDArray[np.int64], channel: int, size: int) -> Array:
    """Return numbers between -1 and 1, (count, size)."""

    def pair(counter: Any, seed: int) -> tuple[Array, Array]:
        u, v = noise.uniforms(counter, seed)
        return 2 * u - 1, 2 * v

    return _drawn(pair, plan, runs, channel, size)


def _drawn(pair: Any, plan: Plan, runs: NDArray[np.int64], channel: int, size: int) -> Array:
    parts = [
        part
        for i in range((size + 1) // 2)
        for part in pair((runs, 0, channel + i, noise.DRAW), plan.seed)
    ]
    return np.stack(parts[:size], axis=-1)
