"""Many flights of one mission: how they are drawn, flown in blocks, and what is kept of each."""

from __future__ import annotations

import hashlib
import math
import threading
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import hoverproof
from hoverproof.algebra.graph import fingerprint
from hoverproof.errors import InputError
from hoverproof.mission import Mission
from hoverproof.plant.rigid_body import STATE_SIZE, rotation_matrix
from hoverproof.simulation import kernel, noise
from hoverproof.simulation.closed_loop import GUARDS
from hoverproof.simulation.compiled import has_diverged
from hoverproof.simulation.numbers import FlightNumbers, euler_angles, settled_index
from hoverproof.simulation.realistic import (
    IMU_NOISE,
    LAYOUT,
    REALISTIC_RECORD,
    Features,
    Surroundings,
    place,
    realistic_loop,
)

Array = NDArray[np.float64]

OUTCOMES = (
    "flown",
    "target_left_the_view",
    "no_depth_left",
    "no_thrust_above_the_singularity_left",
    "diverged",
)
"""What became of a run; its place here is its code. -1 stands for a run not flown yet."""

STEPS_IN_A_BLOCK = 4_000_000
BYTES_IN_A_BLOCK = 32_000_000
UNLIMITED = 1e300
_PREPARING = threading.Lock()

IMU_BIAS_DRAW, GUST_DRAW, SCATTER_DRAW = 0, 8, 16
"""First channels of what is drawn before a flight."""


def is_ideal(mission: Mission, *, scattered: bool = False) -> bool:
    """Tell whether a mission flies as in the paper: no sensors, rotors, wind or errors named.

    Parameters
    ----------
    mission : Mission
    scattered : bool
        Whether ``[scatter]`` is drawn from: it may make vehicles differ from the model.
    """
    named = mission.conditions().keys() - {"scatter"}
    return not (named or (scattered and mission.scatter.of_the_vehicle))


def check_seed(seed: int) -> None:
    """Refuse a seed that is no key for the noise."""
    if not 0 <= seed < 2**63:
        raise InputError("--seed", "", f"must be from 0 to {2**63 - 1}, not {seed}")


@dataclass(frozen=True)
class Plan:
    """Flights to be flown: all that decides about every bit of them.

    Attributes
    ----------
    mission : Mission
    step : float
        s.
    samples, every : int
        Records after the start, and steps between them.
    seed : int
    scattered : bool
        Whether starts and vehicles are drawn from ``[scatter]``.
    version : str
        Of hoverproof, which must be the same wherever a part is flown.
    """

    mission: Mission
    step: float
    samples: int
    every: int
    seed: int = 0
    scattered: bool = True
    version: str = hoverproof.__version__

    def __reduce__(self) -> tuple[Any, ...]:
        """Travel without what is derived."""
        return Plan, tuple(getattr(self, f.name) for f in fields(self))

    def prepare(self) -> None:
        """Derive and compile, one thread at a time: CasADi has settings that all threads share."""
        with _PREPARING:
            _ = self.numbers, kernel.source(self.loop, self.schedule)

    @cached_property
    def ideal(self) -> bool:
        """Whether it is the paper's loop that flies."""
        return is_ideal(self.mission, scattered=self.scattered)

    @cached_property
    def numbers(self) -> FlightNumbers:
        """The numbers of the mission, rounded."""
        return FlightNumbers.of(self.mission)

    @cached_property
    def loop(self) -> kernel.Loop:
        """What is compiled."""
        n = self.numbers.points.shape[1]
        if self.ideal:
            return kernel.ideal_loop(n)
        s, w = self.mission.sensors, self.mission.wind
        features = Features(
            camera_noise=bool(s.pixel_noise),
            rounded=bool(s.pixel_resolution),
            imu_noise=bool(s.gyro_noise or s.velocity_noise or s.gravity_noise),
            gusts=bool(w.gust),
            abort=s.out_of_view == "abort",
        )
        return realistic_loop(n, features)

    @cached_property
    def model_sha256(self) -> str:
        """A hash of the graphs that fly."""
        parts = "".join(map(fingerprint, self.loop.functions.values()))
        return hashlib.sha256(parts.encode()).hexdigest()

    @property
    def record(self) -> dict[str, int]:
        """What a record holds, and the size of each part."""
        return kernel.IDEAL_RECORD if self.ideal else REALISTIC_RECORD

    @cached_property
    def schedule(self) -> kernel.Schedule:
        """When things happen.

        Raises
        ------
        InputError
            If a rate is faster than the integrator.
        """
        s, dt = self.mission.sensors, Fraction(repr(self.step))

        def events(key: str, rate: Fraction | None) -> tuple[int, int]:
            share = Fraction(1) if rate is None else (rate * dt).limit_denominator(10**6)
            if not 0 < share <= 1:
                fastest = float(1 / dt)
                raise InputError(
                    self.mission.source,
                    f"sensors.{key}",
                    f"must be at most one in a step (--step {self.step:g} s: {fastest:g} Hz) and "
                    f"no slower than one in {10**6} steps, not {float(rate or 0):g} Hz",
                )
            return share.numerator, share.denominator

        return kernel.Schedule(
            samples=self.samples,
            every=self.every,
            frame=events("frame_rate", s.frame_rate),
            control=events("control_rate", s.control_rate),
            latency=math.ceil(s.latency / dt),
        )

    @property
    def times(self) -> Array:
        """When the records are taken, s."""
        times: Array = self.step * self.every * np.arange(self.samples + 1.0)
        return times

    @property
    def block(self) -> int:
        """How many runs are flown at a time: about half a second's work, and little memory."""
        by_steps = STEPS_IN_A_BLOCK // (self.samples * self.every)
        by_bytes = BYTES_IN_A_BLOCK // (8 * (self.samples + 1) * sum(self.record.values()))
        return max(16, min(by_steps, by_bytes, 65536) // 16 * 16)


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
    arm, drag = float(mission.vehicle.arm), float(mission.vehicle.drag_ratio)
    most = np.finfo(float).max
    if plan.ideal:
        memory = np.hstack([start, np.full((count, len(GUARDS)), most)])
        return memory, np.hstack([design, np.tile([plan.step, arm, drag], (count, 1))])

    around = _surroundings(plan, runs, drawn)
    params = np.hstack([design, *(around[f].reshape(count, -1) for f in _FIELDS)])
    memory = np.zeros((count, sum(LAYOUT.values())))
    low, high = around["rotor_min"][0], around["rotor_max"][0]
    hover = np.clip(float(mission.vehicle.weight) / 4, low, high)
    parts = {
        "state": np.hstack([start[:, :-1], np.full((count, 1), 4 * hover)]),
        "depth": most,
        "thrust_margin": most,
        "view": most,
        "command": 4 * hover,
        "rotors": hover,
        "rotor_commands": hover,
        "gust": float(mission.wind.gust) * _normals(plan, runs, GUST_DRAW, 3),
    }
    for name, values in parts.items():
        memory[:, place(LAYOUT, name)] = values
    return memory, params


_FIELDS = tuple(Surroundings.__dataclass_fields__)


def _surroundings(plan: Plan, runs: NDArray[np.int64], drawn: dict[str, Array]) -> dict[str, Array]:
    """Return the values of `Surroundings` for each run, each (count,) or (count, 3)."""
    m, count = plan.mission, len(runs)
    s, r, w, wrong, vehicle = m.sensors, m.rotors, m.wind, m.model_error, m.vehicle
    tilt = [float(a) + d for a, d in zip(wrong.camera_tilt, drawn["camera_tilt"].T, strict=True)]
    mounted = rotation_matrix(*tilt)  # (3, 3, count)
    focal = float(s.focal_length or 1)
    bias = _normals(plan, runs, IMU_BIAS_DRAW, IMU_NOISE)
    time_constant = float(r.time_constant)
    lag = [math.exp(-k * plan.step / time_constant) if time_constant else 0.0 for k in (0, 0.5, 1)]
    gust, kept = float(w.gust), math.exp(-plan.step / float(w.gust_time))
    period = plan.step if s.control_rate is None else 1 / float(s.control_rate)
    inertia = np.array([float(i) for i in vehicle.inertia])
    inertia_error = np.array([float(e) for e in wrong.inertia]) + drawn["inertia"]
    values: dict[str, Any] = {
        "mass": float(vehicle.mass) * (1 + float(wrong.mass) + drawn["mass"][:, 0]),
        "inertia": inertia * (1 + inertia_error),
        "camera_x": mounted[:, 0].T,
        "camera_y": mounted[:, 1].T,
        "camera_z": mounted[:, 2].T,
        "wind": np.array([float(c) for c in w.mean]),
        "gyro_bias": float(s.gyro_bias) * bias[:, :3],
        "velocity_bias": float(s.velocity_bias) * bias[:, 3:6],
        "gravity_bias": float(s.gravity_bias) * bias[:, 6:],
        "arm": float(vehicle.arm),
        "drag_ratio": float(vehicle.drag_ratio),
        "air_drag": float(w.drag),
        "step": plan.step,
        "period": period,
        "left_now": lag[0],
        "left_half": lag[1],
        "left_whole": lag[2],
        "gust_kept": kept,
        "gust_added": gust * math.sqrt(1 - kept * kept),
        "rotor_min": -UNLIMITED if r.min_thrust is None else float(r.min_thrust),
        "rotor_max": UNLIMITED if r.max_thrust is None else float(r.max_thrust),
        "image_noise": float(s.pixel_noise) / focal,
        "image_resolution": float(s.pixel_resolution) / focal,
        "half_width": UNLIMITED if s.width is None else float(s.width) / 2 / focal,
        "half_height": UNLIMITED if s.height is None else float(s.height) / 2 / focal,
        "gyro_noise": float(s.gyro_noise),
        "velocity_noise": float(s.velocity_noise),
        "gravity_noise": float(s.gravity_noise),
    }
    sizes = {name: 3 if name in Surroundings.vectors else 1 for name in _FIELDS}
    return {
        name: np.broadcast_to(np.reshape(values[name], (-1, sizes[name])), (count, sizes[name]))
        for name in _FIELDS
    }


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


def outcome_code(plan: Plan, memory: Array, taken: int) -> int:
    """Return the place in `OUTCOMES` of a run that ended with this memory, (MEMORY,)."""
    if taken == plan.samples:
        return 0
    if has_diverged(memory):
        return OUTCOMES.index("diverged")
    depth, thrust = memory[STATE_SIZE : STATE_SIZE + 2]
    if not depth > 0:
        return OUTCOMES.index("no_depth_left")
    if not thrust > 0:
        return OUTCOMES.index("no_thrust_above_the_singularity_left")
    return OUTCOMES.index("target_left_the_view")


def fly_raw(
    plan: Plan,
    first: int,
    count: int,
    *,
    compiler: str | None = None,
    stop: kernel.Stop | None = None,
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Fly runs `first` to ``first + count - 1``; see `kernel.fly` for what is returned."""
    plan.prepare()
    memory, params = memory_and_parameters(plan, np.arange(first, first + count))
    return kernel.fly(
        plan.loop,
        plan.schedule,
        memory,
        params,
        plan.numbers.points,
        seed=plan.seed,
        first_run=first,
        compiler=compiler,
        stop=stop,
    )


def fly_block(
    plan: Plan, part: tuple[int, int], stop: kernel.Stop | None = None
) -> dict[str, NDArray[Any]]:
    """Fly some runs and return what is kept of each.

    Parameters
    ----------
    plan : Plan
    part : (first, count)
    stop : Stop, optional

    Returns
    -------
    dict
        By name of the variable in the file; the first axis is the run. Not a number stands after
        the end of a flight.

    Raises
    ------
    InputError
        If this is another version of hoverproof than the plan's.
    """
    if plan.version != hoverproof.__version__:
        found = f"a worker has hoverproof {hoverproof.__version__}, not {plan.version}"
        raise InputError("--scheduler", "", found)
    records, memory, taken = fly_raw(plan, *part, stop=stop)
    whole = {name: records[..., place(plan.record, name)] for name in plan.record}
    state = whole["state"]
    rotation = state[..., 6:15].reshape(*state.shape[:2], 3, 3).swapaxes(-1, -2)
    error = np.linalg.norm(state[..., :3] - plan.numbers.goal, axis=-1)
    tilt = np.arctan2(np.hypot(rotation[..., 2, 0], rotation[..., 2, 1]), rotation[..., 2, 2])
    runs = np.arange(len(taken))
    flown = taken == plan.samples
    settled = settled_index(error)
    times = plan.times
    lost = memory[:, place(LAYOUT, "lost").start] if not plan.ideal else np.zeros(len(taken))
    lost_at = memory[:, place(LAYOUT, "lost_at").start] if not plan.ideal else lost
    return {
        "position": state[..., :3],
        "velocity": state[..., 3:6],
        "euler_angles": euler_angles(rotation),
        "body_rate": state[..., 15:18],
        "thrust": state[..., 18],
        "lyapunov": whole["lyapunov"][..., 0],
        "rotor_thrust": whole["rotor_thrust"],
        "outcome": np.array(
            [outcome_code(plan, m, t) for m, t in zip(memory, taken, strict=True)], np.int8
        ),
        "flown_until": times[taken],
        "start_error": error[:, 0],
        "final_error": error[runs, taken],
        "settled_at": np.where(
            flown & (settled < len(times)), times[np.minimum(settled, len(times) - 1)], np.nan
        ),
        "largest_tilt": np.nanmax(tilt, axis=1),
        "least_rotor_thrust": np.nanmin(whole["rotor_thrust"], axis=(1, 2)),
        "greatest_rotor_thrust": np.nanmax(whole["rotor_thrust"], axis=(1, 2)),
        "frames_lost": lost.astype(np.int32),
        "left_view_at": np.where(lost > 0, lost_at * plan.step, np.nan),
    }
