"""What is to be flown: a mission, its times and a seed, which together decide about every bit."""

from __future__ import annotations

import hashlib
import math
import threading
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.graph import fingerprint
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.lens import check_cone, seeing_lens
from hoverproof.servo.law import Law
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import kernel
from hoverproof.simulation.observed import specific_force_function
from hoverproof.simulation.realistic import realistic_loop
from hoverproof.simulation.surroundings import Features
from hoverproof.version import __version__

Array = NDArray[np.float64]

STEPS_IN_A_BLOCK = 4_000_000
BYTES_IN_A_BLOCK = 8_000_000
AT_LEAST = 16
"""How many runs a block has at least."""

_PREPARING = threading.Lock()


def is_ideal(mission: Mission, *, scattered: bool = False) -> bool:
    """Tell whether a mission flies as in the paper: no sensors, lens, rotors, wind or errors named.

    Parameters
    ----------
    mission : Mission
    scattered : bool
        Whether ``[scatter]`` is drawn from: it may make vehicles differ from the model.
    """
    named = mission.conditions().keys() - {"scatter"}
    return not (named or mission.camera.lens or (scattered and mission.scatter.of_the_vehicle))


def check_runs_differ(mission: Mission, runs: int) -> None:
    """Refuse to fly the same flight many times.

    Parameters
    ----------
    mission : Mission
    runs : int
        Number of flights.

    Raises
    ------
    InputError
        If nothing in the mission is drawn at random.
    """
    spreads = [value for name, value in mission.scatter if name != "distribution"]
    drawn = [part for value in spreads for part in (value if isinstance(value, tuple) else [value])]
    s = mission.sensors
    noises = (s.pixel_noise, s.gyro_noise, s.velocity_noise, s.gravity_noise)
    biases = (s.gyro_bias, s.velocity_bias, s.gravity_bias)
    felt = (s.accelerometer_noise, s.accelerometer_bias) if mission.law.force == "measured" else ()
    compass = mission.goal.heading is not None and mission.goal.heading_from != "image"
    told = (s.heading_noise, s.heading_bias) if compass else ()
    if runs > 1 and not any((*drawn, *noises, *biases, *felt, *told, mission.wind.gust)):
        raise InputError(
            "--runs",
            "",
            f"all {runs} flights would be the same: nothing in {mission.source} is drawn; give "
            "[scatter] (as --set scatter.position=[1,1,1]), noise of [sensors] or gusts of [wind]",
        )


def check_seed(seed: int) -> None:
    """Refuse a seed that is no key for the noise.

    Parameters
    ----------
    seed : int
        A number, good from 0 to 2**63 - 1.
    """
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
        A number from 0 to 2**63 - 1.
    scattered : bool
        Whether starts and vehicles are drawn from ``[scatter]``.
    version : str
        Of hoverproof, which must be the same wherever a part is flown.
    law : Law, optional
        By default that of the mission.
    """

    mission: Mission
    step: float
    samples: int
    every: int
    seed: int = 0
    scattered: bool = True
    version: str = __version__
    law: Law | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Travel without what is derived."""
        return Plan, tuple(getattr(self, f.name) for f in fields(self))

    def prepare(self) -> None:
        """Derive and compile, one thread at a time: CasADi has settings that all threads share."""
        with _PREPARING:
            _ = self.numbers, kernel.source(self.loop, self.schedule)
            _ = None if self.ideal else self.felt

    @cached_property
    def ideal(self) -> bool:
        """Whether it is the ideal loop that flies."""
        return is_ideal(self.mission, scattered=self.scattered)

    @cached_property
    def numbers(self) -> LoopNumbers:
        """The numbers of the mission, rounded."""
        return LoopNumbers.of(self.mission, self.law)

    @cached_property
    def loop(self) -> kernel.Loop:
        """What is compiled."""
        n, frame = self.numbers.target_size, self.mission.vehicle.frame
        if self.ideal:
            return kernel.ideal_loop(n, self.numbers.law, frame)
        return realistic_loop(n, self.features, self.numbers.law, frame)

    @cached_property
    def features(self) -> Features:
        """What the loop has beside its numbers, if it is not the ideal one."""
        mission, law = self.mission, self.numbers.law
        s, wrong, drawn = mission.sensors, mission.model_error, mission.scatter
        check_cone(mission)
        noises = [s.gyro_noise, s.velocity_noise, s.gravity_noise]
        noises += [s.accelerometer_noise] if law.force.sensed else []
        noises += [s.heading_noise] if law.has_compass else []
        errors = [wrong.thrust, wrong.arm, *wrong.rotors]
        errors += [drawn.thrust, drawn.arm] if self.scattered else []
        return Features(
            camera_noise=bool(s.pixel_noise),
            rounded=bool(s.pixel_resolution),
            imu_noise=any(noises),
            gusts=bool(mission.wind.gust),
            abort=s.out_of_view == "abort",
            turned=s.gyro_turned,
            rotors_differ=any(errors),
            lag=bool(s.accelerometer_time_constant),
            lens=None if (seeing := seeing_lens(mission)) is None else seeing[0],
        )

    @cached_property
    def felt(self) -> ca.Function:
        """(state, gust, surroundings) ↦ true specific force; see `specific_force_function`."""
        return specific_force_function(self.features.surroundings(self.numbers.law, self.rotors))

    @cached_property
    def model_sha256(self) -> str:
        """A hash of the graphs that fly."""
        parts = "".join(map(fingerprint, self.loop.functions.values()))
        return hashlib.sha256(parts.encode()).hexdigest()

    @property
    def rotors(self) -> int:
        """Number of rotors."""
        return len(self.mission.vehicle.frame.names)

    @property
    def record(self) -> dict[str, int]:
        """What a record holds, and the size of each part."""
        if self.ideal:
            return kernel.ideal_record(self.rotors)
        return self.features.record(self.numbers.law, self.rotors)

    @cached_property
    def schedule(self) -> kernel.Schedule:
        """When things happen.

        Raises
        ------
        InputError
            If a rate is faster than the integrator.
        """
        s, dt = self.mission.sensors, Fraction(repr(float(self.step)))

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
        return max(AT_LEAST, min(by_steps, by_bytes, 65536) // 16 * 16)
