"""Fly many vehicles through one compiled loop, several in each vector of the processor.

Without a compiler CasADi's virtual machine does the same operations, and gives the same bits.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.compilers import find_compiler
from hoverproof.mission.frame import Frame, X
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import parameters, readout
from hoverproof.simulation.compiled import DIVERGED, VIRTUAL_MACHINE
from hoverproof.simulation.lanes import vector_library, vector_source
from hoverproof.simulation.noise import FLIGHT, normals
from hoverproof.simulation.step import FLIGHT_SIZE, GUARDS, step_function

Array = NDArray[np.float64]

Control = Callable[[int, Array, Array, Array], Array]
"""(step, memory (MEMORY, m), parameters (m, PARAMS), noise (k, m)) ↦ memory after a tick."""

Eyes = Callable[[int, Array, Array, Array], tuple[Array, Array, int]]
"""(step, memory (MEMORY, m), parameters (m, PARAMS), noise (k, m)) ↦ what a frame tells (SEEN, m),
a margin above 0 if it is seen, (m,), and how many steps it is later than the latency says."""

NOISE_AT_A_TIME = 1 << 12
"""How many pairs of normal numbers are drawn at once where there is no compiler."""


def ideal_record(rotors: int = 4) -> dict[str, int]:
    """Return what a record of the paper's loop holds, and the size of each part.

    Parameters
    ----------
    rotors : int
        Their number.
    """
    return {"state": STATE_SIZE, "lyapunov": 1, "rotor_thrust": rotors}


@dataclass(frozen=True, eq=False)
class Loop:
    """What a batch runs: generated functions, and where they find things.

    Two are the same if they are one object, so that what is made of one can be cached.

    Attributes
    ----------
    functions : dict of Function
        ``step``, or ``frame``, ``control``, ``move`` and ``normals``; and ``record``.
    constants : dict of int
        Bare numbers for the driver, batch.c: the sizes MEMORY, PARAMS, POINTS, RECORD, GUARDS and
        others, and places.
    """

    functions: dict[str, ca.Function]
    constants: dict[str, int]


@dataclass(frozen=True)
class Schedule:
    """When things happen, in steps; the same for all runs.

    Attributes
    ----------
    samples, every : int
        Records after the start, and steps between them.
    frame, control : (int, int)
        Rate times step, dimensionless, as numerator and denominator: an event happens at the first
        step at or after its time.
    latency : int
        From a frame to its use, in steps.
    """

    samples: int
    every: int
    frame: tuple[int, int] = (1, 1)
    control: tuple[int, int] = (1, 1)
    latency: int = 0

    @property
    def frames_under_way(self) -> int:
        """How many frames can be on their way to the controller, and one more to be held."""
        num, den = self.frame
        return -(-self.latency * num // den) + 2


def due(step: int, rate: tuple[int, int]) -> bool:
    """Tell whether an event happens at a step.

    Parameters
    ----------
    step : int
        Its number, from 0.
    rate : (int, int)
        Of the event, as in `Schedule`, dimensionless.
    """
    num, den = rate
    return step == 0 or step * num // den != (step - 1) * num // den


class _Plan(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_long) for name in ("samples", "every")),
        *((name, ctypes.c_ulonglong) for name in ("seed", "first_run")),
        *(
            (name, ctypes.c_longlong)
            for name in ("frame_num", "frame_den", "control_num", "control_den", "latency")
        ),
    )


class Stopped(Exception):
    """Flights that were told to end before their time."""


@dataclass
class Stop:
    """A flag that ends compiled flights soon, from any thread.

    Attributes
    ----------
    flag : c_int
        Not 0 once the flights are to end; compiled code reads it.
    """

    flag: ctypes.c_int = field(default_factory=lambda: ctypes.c_int(0))

    def set(self) -> None:
        """End the flights."""
        self.flag.value = 1


@cache
def ideal_loop(n: int, law: Law = HAMEL_MAHONY, frame: Frame = X) -> Loop:
    """Return the ideal loop: controller, camera and body as one differential equation.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    frame : Frame
        Of the rotors.
    """
    design, points = parameters(n, law)
    flight, dt = ca.SX.sym("flight", FLIGHT_SIZE), ca.SX.sym("dt")
    arm, drag = ca.SX.sym("arm"), ca.SX.sym("drag_ratio")
    x = flight[:STATE_SIZE]
    read = readout(x, design, points, arm, drag, law, frame=frame)
    held = ca.vertcat(design.vector(), dt, arm, drag)
    inputs = [flight, held, points]
    outputs = [ca.cse(ca.vertcat(x, read["lyapunov"], read["rotor_thrusts"]))]
    return Loop(
        {
            "step": step_function(n, law),
            "record": ca.Function("hoverproof_record", inputs, outputs),
        },
        {
            "MEMORY": FLIGHT_SIZE,
            "GUARDS": len(GUARDS),
            "PARAMS": held.numel(),
            "STEP": law.design.size(),
            "POINTS": 3 * n,
            "RECORD": sum(ideal_record(len(frame.names)).values()),
        },
    )


@cache
def source(loop: Loop, schedule: Schedule, lanes: int | None = None) -> str:
    """Return the C text of a loop; made once for each.

    Parameters
    ----------
    loop : Loop
    schedule : Schedule
    lanes : int, optional
        Lane width; by default that of the machine.
    """
    constants = loop.constants | {"STATE": STATE_SIZE, "DIVERGED": DIVERGED}
    if "CONDITIONS" in constants:
        constants["RING"] = schedule.frames_under_way
    if lanes is not None:
        constants["LANES"] = lanes
    return vector_source(list(loop.functions.values()), "batch.c", constants)


def fly(
    loop: Loop,
    schedule: Schedule,
    memory: Array,
    parameters: Array,
    points: Array,
    *,
    seed: int = 0,
    first_run: int = 0,
    compiler: str | None = None,
    lanes: int | None = None,
    stop: Stop | None = None,
    control: Control | None = None,
    eyes: Eyes | None = None,
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Fly vehicles to the end, or until each has diverged or broken a guard.

    Parameters
    ----------
    loop : Loop
    schedule : Schedule
    memory : (m, MEMORY)
        Where each of m vehicles starts, SI units.
    parameters : (m, PARAMS)
        What each flies with, SI units.
    points : (3, n)
        Target, world frame, m.
    seed, first_run : int
        What noise is drawn from: the seed, and the number of the first of these runs.
    compiler : str, optional
        As in `hoverproof.simulation.compiled.runner`.
    lanes : int, optional
        Number of vehicles in a vector; by default that of the machine.
    stop : Stop, optional
        Ends the flights when set.
    control : callable, optional
        In place of the loop's controller at each tick; then nothing runs as machine code.
    eyes : callable, optional
        In place of the loop's camera at each frame; likewise.

    Returns
    -------
    records : (m, samples + 1, RECORD)
        From the start on; not a number after the last good one.
    memory : (m, MEMORY)
        The last state of each, good or not.
    taken : (m,)
        Number of good records after the start.

    Raises
    ------
    Stopped
        If `stop` was set meanwhile.
    """
    library, count = None, len(memory)
    if control is None and eyes is None:
        command = find_compiler() if compiler is None else compiler
        library = vector_library(source(loop, schedule, lanes), command)
    records = np.full((count, schedule.samples + 1, loop.constants["RECORD"]), np.nan)
    memory = np.array(memory, np.float64, order="C")
    taken = np.zeros(count, np.int64)
    if library is None:
        arrays = memory, parameters, points
        own = stop or Stop()
        _fly_slowly(loop, schedule, *arrays, seed, first_run, records, taken, own, control, eyes)
        return records, memory, taken
    plan = _Plan(
        schedule.samples,
        schedule.every,
        seed,
        first_run,
        *schedule.frame,
        *schedule.control,
        schedule.latency,
    )
    held = np.ascontiguousarray(parameters, np.float64), np.ascontiguousarray(points.T)
    flag = (Stop() if stop is None else stop).flag
    library.hoverproof_batch(
        ctypes.byref(plan),
        ctypes.c_long(count),
        *(ctypes.c_void_p(a.ctypes.data) for a in (memory, *held, records, taken)),
        ctypes.byref(flag),
    )
    if flag.value:
        raise Stopped
    return records, memory, taken


def machine(loop: Loop, schedule: Schedule, compiler: str | None = None) -> str:
    """Return on what a loop runs here, in words.

    Parameters
    ----------
    loop : Loop
    schedule : Schedule
    compiler : str, optional
        As in `hoverproof.simulation.compiled.runner`.
    """
    command = find_compiler() if compiler is None else compiler
    library = vector_library(source(loop, schedule), command)
    if library is None:
        return VIRTUAL_MACHINE
    return f"compiled C, {library.hoverproof_lanes()} vehicles in a vector"


def _fly_slowly(
    loop: Loop,
    schedule: Schedule,
    memory: Array,
    parameters: Array,
    points: Array,
    seed: int,
    first_run: int,
    records: Array,
    taken: NDArray[np.int64],
    stop: Stop,
    control: Control | None,
    eyes: Eyes | None,
) -> None:
    """Do what batch.c does on CasADi's virtual machine, all vehicles a step at a time."""
    count = len(memory)
    tiled = ca.DM(np.tile(points, count))
    mapped = {name: f.map(count) for name, f in loop.functions.items() if name != "normals"}
    params = ca.DM(parameters.T)
    c = loop.constants
    runs, ahead = first_run + np.arange(count), max(1, NOISE_AT_A_TIME // count)

    def call(name: str, *inputs: Any) -> list[Array]:
        outputs = mapped[name](*inputs)
        several = mapped[name].n_out() > 1
        return [np.array(part) for part in (outputs if several else (outputs,))]

    drawn: dict[str, dict[int, Array]] = {"CAMERA": {}, "IMU": {}, "GUST": {}}

    def noise(what: str, size: int, step: int, fraction: tuple[int, int]) -> Array:
        """Return the noise of an event; that of many to come is drawn with it, which is faster."""
        if step not in drawn[what]:
            num, den = fraction
            first, channel = step * num // den, c[f"{what}_CHANNEL"]
            steps = [step, *(-(-event * den // num) for event in range(first + 1, first + ahead))]
            at = np.array(steps)[:, None]
            pairs = [normals((runs, at, channel + i, FLIGHT), seed) for i in range((size + 1) // 2)]
            parts = np.array([part for pair in pairs for part in pair])[:size]
            drawn[what] = {at: parts[:, i] for i, at in enumerate(steps)}
        return drawn[what][step]

    now = memory.T.copy()
    flying = np.ones(count, bool)
    records[:, 0] = call("record", now, params, tiled)[0].T
    frames: list[tuple[int, Array]] = []  # arrival and what it tells
    last = np.zeros((c.get("SEEN", 3), count))
    step = 0
    for sample in range(1, schedule.samples + 1):
        if not flying.any():
            return
        for _ in range(schedule.every):
            if stop.flag.value:
                raise Stopped
            if "step" in mapped:
                (now,) = call("step", now, params[: c["STEP"], :], tiled, params[c["STEP"], :])
                step += 1
                continue
            if due(step, schedule.frame):
                blur = np.zeros((c["CAMERA_NOISE"], count))
                if c["CAMERA_NOISY"]:
                    blur = noise("CAMERA", len(blur), step, schedule.frame)
                if eyes is None:
                    (seen, (margin,)), late = call("frame", now, params, tiled, blur), 0
                else:
                    seen, margin, late = eyes(step, now, parameters, blur)
                visible, initial = margin > 0, step == 0
                last = np.where(visible, seen, seen if initial else last)
                if c["ABORT"] or initial:
                    now[c["VIEW"]] = np.where(margin < now[c["VIEW"]], margin, now[c["VIEW"]])
                now[c["LOST_AT"], ~visible & (now[c["LOST"]] == 0)] = step
                now[c["LOST"]] += ~visible
                frames.append((step + (0 if initial else schedule.latency + late), last))
            while frames and frames[0][0] <= step:
                _, told = frames.pop(0)
                now[c["HELD"] : c["HELD"] + 3] = told[:3]
                now[c["NORTH"] : c["NORTH"] + len(told) - 3] = told[3:]
            if due(step, schedule.control):
                shake = np.zeros((c["IMU_NOISE"], count))
                if c["IMU_NOISY"]:
                    shake = noise("IMU", len(shake), step, schedule.control)
                if control is None:
                    (now,) = call("control", now, params, shake)
                else:
                    now = control(step, now, parameters.T, shake)
            gust = noise("GUST", 3, step, (1, 1)) if c["GUSTY"] else np.zeros((3, count))
            (now,) = call("move", now, params, tiled, gust)
            step += 1
        memory[flying] = now.T[flying]
        good = (np.abs(now[:STATE_SIZE]) < DIVERGED).all(axis=0)
        good &= (now[STATE_SIZE : STATE_SIZE + c["GUARDS"]] > 0).all(axis=0)
        flying &= good
        taken[flying] = sample
        records[flying, sample] = call("record", now, params, tiled)[0].T[flying]
