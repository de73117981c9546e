"""How long a flight is, and in what steps: both follow from the motions of the loop."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from hoverproof.algebra.derived import kept_graph
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.law import Law
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.loop import LoopNumbers, loop_rate, parameters
from hoverproof.simulation.compiled import VIRTUAL_MACHINE
from hoverproof.simulation.step import guards

STEP = 0.01
"""The step of a flight, s, unless its loop or its controller is too fast for it."""

LONGEST = 2.0
"""Of a step times the fastest motion: beyond it, the method of Runge and Kutta or a controller that
holds its output makes a stable motion grow."""

MAX_STEPS = 10**8
MAX_SLOW_STEPS = 10**6
"""Without a C compiler: that many take about ten minutes."""
MAX_BYTES = 2 * 10**9


def flight_step(mission: Mission, step: float | None, law: Law | None = None) -> float:
    """Return the step to fly a mission with, s.

    By default it is 0.01 s. It is shorter for a loop whose fastest motion takes less time than
    that, and no longer than from one frame, or one tick of the controller, to the next.

    Parameters
    ----------
    mission : Mission
    step : float, optional
        A wish, s.
    law : Law, optional
        By default that of the mission.

    Raises
    ------
    InputError
        If the wish is no time, or too long for the loop.
    """
    if step is not None and not (math.isfinite(step) and step > 0):
        raise InputError("--step", "", f"must be a positive time in s, not {step}")
    held = mission.sensors.control_rate is not None  # what is held cannot be too fast for a step
    fastest = 0.0 if held else fastest_rate(mission, law)
    if step is None:
        return _default_step(mission, fastest)
    if step * fastest > LONGEST:
        raise InputError(
            "--step",
            "",
            f"{step:g} s is too long for this loop, whose fastest motion takes {1 / fastest:.3g} s:"
            f" the computation would diverge; {_default_step(mission, fastest):g} s will do",
        )
    return step


def _default_step(mission: Mission, fastest: float) -> float:
    """Return the step that follows from the fastest motion, 1/s, and the rates of a mission."""
    rates = (mission.sensors.control_rate, mission.sensors.frame_rate)
    rate = float(max((r for r in rates if r is not None), default=0))
    longest = min(STEP, 1 / fastest) if fastest else STEP
    if rate * longest > 1:
        return 1 / rate
    if longest == STEP:
        return STEP
    if rate:  # so that frames and ticks fall on steps
        return 1 / rate / math.ceil(1 / rate / longest)
    power = math.floor(math.log10(longest))
    steps = [float(f"{d}e{p}") for p in (power - 1, power) for d in (1, 2, 5)]
    return max(s for s in steps if s <= longest)


def fastest_rate(mission: Mission, law: Law | None = None) -> float:
    """Return the rate of the fastest motion of the linearised loop, at the start or the goal, 1/s.

    Zero where the loop cannot be linearised, as without thrust above the singularity.

    Parameters
    ----------
    mission : Mission
    law : Law, optional
        By default that of the mission.
    """
    numbers = LoopNumbers.of(mission, law)
    linearise, rates = _linearised(numbers.target_size, numbers.law), [0.0]
    for state in (numbers.hover, numbers.start):
        slope, margins = (np.array(m) for m in linearise(state, numbers.design, numbers.points))
        if (margins > 0).all() and np.isfinite(slope).all():
            rates.append(float(np.abs(np.linalg.eigvals(slope)).max()))
    error = mission.model_error  # what is lighter, or stronger, than the controller knows is faster
    lighter = min(1.0, *(float(1 + e) for e in (error.mass, *error.inertia)))
    levers = [float((1 + error.thrust) * (1 + e) * (1 + error.arm)) for e in error.rotors or (0,)]
    stronger = max(1.0, float(1 + error.thrust), *levers)
    return max(rates) * stronger / lighter


@kept_graph
def _linearised(n: int, law: Law) -> ca.Function:
    """Return (state, design, points) ↦ slope of the loop, (19, 19), 1/s, and its guards."""
    (design, points), x = parameters(n, law), ca.SX.sym("x", STATE_SIZE)
    slope = ca.jacobian(loop_rate(x, design, points, law), x)
    inputs = [x, design.vector(), points]
    return ca.Function("linearised", inputs, [ca.densify(slope), guards(x, design, points, law)])


@dataclass(frozen=True)
class Steps:
    """How a flight is stepped through.

    Attributes
    ----------
    step : float
        s.
    count : int
        Number of steps.
    every : int
        Steps from one sample to the next.
    """

    step: float
    count: int
    every: int

    @property
    def samples(self) -> int:
        """Number of samples after that of the start."""
        return self.count // self.every


@dataclass(frozen=True)
class Timing:
    """What is wished of the times of a flight; by default they follow from its loop.

    Attributes
    ----------
    duration : float or None
        s; by default that of `default_duration`.
    step : float or None
        s; by default that of `flight_step`.
    every : int or None
        Steps between samples.
    """

    duration: float | None = None
    step: float | None = None
    every: int | None = None

    def steps(
        self, mission: Mission, samples: int, sample_bytes: int, law: Law | None = None
    ) -> Steps:
        """Return the steps of a flight.

        Parameters
        ----------
        mission : Mission
        samples : int
            Number of those that are to be kept, about, if `every` is not given.
        sample_bytes : int
            Number of bytes that each takes in memory.
        law : Law, optional
            By default that of the mission.

        Raises
        ------
        InputError
            If the wishes are not possible, or beyond reason.
        """
        step = flight_step(mission, self.step, law)
        duration = default_duration(mission, law) if self.duration is None else self.duration
        count, every = _count(duration, step, self.every, samples, sample_bytes)
        return Steps(step, count, every)


def _count(
    duration: float, step: float, every: int | None, samples: int, sample_bytes: int
) -> tuple[int, int]:
    """Return how many steps a flight has, and how many lie between its samples."""
    if not (math.isfinite(duration) and duration >= step):
        raise InputError("--duration", "", f"must be at least one step of {step} s, not {duration}")
    count = duration / step
    if not count <= MAX_STEPS:
        kept = samples if every is None else count / max(every, 1)
        raise InputError(
            "--duration, --step",
            "",
            f"{duration:g} s would take {count:.3g} steps of {step:g} s, of which {kept:.3g} "
            f"are kept ({_bytes(kept * sample_bytes)}); at most {MAX_STEPS:.3g} steps are flown",
        )
    steps = round(count)
    every = max(1, steps // samples) if every is None else every
    if not 1 <= every <= steps:
        raise InputError("--every", "", f"must be between 1 and the {steps} steps, not {every}")
    size = steps // every * sample_bytes
    if size > MAX_BYTES:
        raise InputError(
            "--every",
            "",
            f"would keep {steps // every} of {steps} steps, which takes {_bytes(size)}; for at "
            f"most {_bytes(MAX_BYTES)} take {-(-steps * sample_bytes // MAX_BYTES)} or more",
        )
    return steps, every


def check_patience(steps: int, step: float, machine: str) -> None:
    """Refuse a flight that nobody would wait for, since there is no C compiler.

    Parameters
    ----------
    steps : int
        Number of steps that the flight has.
    step : float
        s.
    machine : str
        On what it runs, in words; see `hoverproof.simulation.compiled.Runner`.

    Raises
    ------
    InputError
        If the flight has more than `MAX_SLOW_STEPS` steps and does not run as machine code.
    """
    if steps > MAX_SLOW_STEPS and machine == VIRTUAL_MACHINE:
        raise InputError(
            "--duration, --step",
            "",
            f"{steps * step:g} s would take {steps:.3g} steps of {step:g} s, which are too many "
            f"without a C compiler: at most {MAX_SLOW_STEPS:.3g} are flown ($CC names a compiler; "
            "else it is cc, gcc or clang)",
        )


def _bytes(size: float) -> str:
    return f"{size / 1e6:.3g} MB" if size < 1e9 else f"{size / 1e9:.3g} GB"


def default_duration(mission: Mission, law: Law | None = None) -> float:
    """Return seven time constants of the slowest motion near the goal, s, to two digits.

    Parameters
    ----------
    mission : Mission
    law : Law, optional
        By default that of the mission.

    Raises
    ------
    InputError
        If the loop is not stable near the goal, so that no time is natural.
    """
    slowest = slowest_rate(mission, law)
    if slowest <= 0:
        raise InputError("--duration", "", "must be given: this loop is not stable near its goal")
    time = 7 / slowest
    digits = 1 - math.floor(math.log10(time))
    return float(round(time, digits))
