"""Fly a mission: from its start, with the camera in the loop, to a record with units."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.files import write_bytes
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import CONDITIONS, Mission
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.plant.rotors import wrench
from hoverproof.servo.law import Law
from hoverproof.servo.layout import place
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import kernel
from hoverproof.simulation.block import fly_raw, how_it_ended, log_of
from hoverproof.simulation.compiled import VIRTUAL_MACHINE, Runner, has_diverged, runner
from hoverproof.simulation.cut_short import last_good_step, up_to
from hoverproof.simulation.flight_log import ending, ending_words, is_noted, settled_at
from hoverproof.simulation.image_age import image_age
from hoverproof.simulation.numbers import settled_index
from hoverproof.simulation.plan import Plan, check_seed, is_ideal
from hoverproof.simulation.record import Record, feature_words, flight_record
from hoverproof.simulation.step import GUARDED_SIZE, flight_states
from hoverproof.simulation.surroundings import LAYOUT
from hoverproof.simulation.timing import MAX_SLOW_STEPS, Timing, check_patience, flight_step
from hoverproof.simulation.timing import default_duration as default_duration
from hoverproof.spread import interruptibly

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

SAMPLES = 2000


@of_mission
def simulate(
    mission: Mission,
    *,
    duration: float | None = None,
    step: float | None = None,
    every: int | None = None,
    seed: int = 0,
    compiler: str | None = None,
    law: Law | None = None,
) -> xr.Dataset:
    """Fly a mission from its start.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    duration : float, optional
        s; by default seven time constants of the slowest motion near the goal.
    step : float, optional
        Step of the Runge-Kutta method of order 4, s; by default as `flight_step` has it.
    every : int, optional
        Keep every so many steps; by default about 2000 samples are kept, also of a flight that
        ends early. Such a flight has one more sample, of the step at which it ended.
    seed : int
        Of the noise, if the mission names sensors or wind; a number from 0 to 2**63 - 1.
        ``[scatter]`` is for runs.
    compiler : str, optional
        Command of the C compiler (see `hoverproof.simulation.compiled.runner`).
    law : Law, optional
        What flies it; by default the law of the mission.

    Returns
    -------
    xarray.Dataset
        Named coordinates and units; ``attrs["outcome"]`` is ``"flown"``, or says why the flight
        ended before its time.

    Raises
    ------
    InputError
        If the duration, the step or the mission cannot be used.
    """
    timing = Timing(duration, step, every)
    return flown(mission, timing, seed=seed, compiler=compiler, law=law).dataset()


def flown(
    mission: Mission,
    timing: Timing,
    *,
    seed: int = 0,
    compiler: str | None = None,
    law: Law | None = None,
) -> Record:
    """Fly a mission from its start: `simulate`, without the time that it takes to import xarray.

    Parameters
    ----------
    mission, compiler
        See `simulate`, also for what is raised.
    timing : Timing
    seed : int
        A bare number.
    law : Law, optional
        What flies it; by default the law of the mission.
    """
    check_seed(seed)
    steps = timing.steps(mission, SAMPLES, sample_bytes(mission), law)
    step, every, finer = steps.step, steps.every, SAMPLES if timing.every is None else None
    if not is_ideal(mission):
        plan = Plan(mission, step, steps.samples, every, seed, scattered=False, law=law)
        return fly_as_built(plan, compiler, finer)
    numbers = LoopNumbers.of(mission, law)
    machine = runner(numbers.target_size, numbers.law, compiler=compiler)
    check_patience(steps.count, step, machine.name)
    begin = time.perf_counter()
    states, good = _run(machine, numbers, step, steps.samples, every)
    seconds = time.perf_counter() - begin
    log, outcome = states[-1][GUARDED_SIZE:], "flown"
    taken = every * np.arange(len(states))
    if not good:  # the record ends with the last good state

        def fly(samples: int, every: int) -> tuple[Array, bool]:
            flown, whole = _run(machine, numbers, step, samples, every)
            return (flown if whole else flown[:-1]), whole

        code, at = ending(log, diverged=has_diverged(states[-1]))
        told = at if is_noted(code) else None
        last = last_good_step(fly, states[:-1], every, told)
        states, taken = up_to(fly, states[:-1], every, last, finer)
        outcome = ending_words(code, (last if told is not None else last + 1) * step)
    flight = flight_record(mission, numbers, states[:, :STATE_SIZE], step * taken)
    flight.attrs.update(
        {
            "outcome": outcome,
            "settled_at": float(settled_at(log, step)) if good else math.nan,
            "step": step,
            "steps": int(taken[-1]),
            "seconds": seconds,
            "machine": machine.name,
        }
    )
    return flight


def sample_bytes(mission: Mission) -> int:
    """Return how many bytes a sample of a flight takes.

    Parameters
    ----------
    mission : Mission
    """
    return 8 * (53 + 2 * len(mission.target.points))


def summary(flight: xr.Dataset | Record) -> dict[str, Any]:
    """Return what a flight came to: positions and errors in m, times in s.

    Parameters
    ----------
    flight : Dataset or Record
        From `simulate` or `flown`.
    """
    error = np.linalg.norm(flight["position"].values - flight.attrs["goal_position"], axis=1)
    times, thrusts = flight["time"].values, flight["rotor_thrust"].values.ravel()
    if "settled_at" in flight.attrs:  # noted at each step of the flight
        settled = float(flight.attrs["settled_at"])
    else:
        index = int(settled_index(error))
        whole = flight.attrs["outcome"] == "flown" and index < len(times)
        settled = float(times[index]) if whole else math.nan
    return {
        "outcome": flight.attrs["outcome"],
        "start_position": flight["position"].values[0].tolist(),
        "start_error": float(error[0]),
        "final_position": flight["position"].values[-1].tolist(),
        "final_error": float(error[-1]),
        **_turned(flight),
        "settled_at": None if math.isnan(settled) else settled,
        "duration": float(times[-1]),
        "steps": int(flight.attrs["steps"]),
        "seconds": float(flight.attrs["seconds"]),
        "machine": flight.attrs["machine"],
        "largest_tilt": float(np.fmax.reduce(flight["tilt"].values)),
        "rotor_thrust": [float(end.reduce(thrusts)) for end in (np.fmin, np.fmax)],
        "frames_lost": int(flight.attrs.get("frames_lost", 0)),
        "left_view_at": flight.attrs.get("left_view_at"),
    }


def _turned(flight: xr.Dataset | Record) -> dict[str, float]:
    """Return the yaw at the end, and its distance from the heading, rad, if the flight has one."""
    heading = json.loads(flight.attrs["mission"])["goal"].get("heading")
    if heading is None:
        return {}
    yaw = float(flight["euler_angles"].values[-1, 2])
    off = math.remainder(yaw - float(Fraction(heading)), 2 * math.pi)
    return {"final_yaw": yaw, "final_heading_error": abs(off)}


OF_THE_IDEAL = (
    *("compared_until", "ideal_settled_at"),
    *("greatest_distance_from_ideal", "final_distance_from_ideal"),
)
"""What `without_conditions` tells."""


def without_conditions(
    mission: Mission, flight: xr.Dataset | Record, law: Law | None = None
) -> dict[str, Any]:
    """Return how far a flight is from the same one without sensors, rotors, wind and errors.

    Parameters
    ----------
    mission : Mission
    flight : Dataset or Record
        Its flight, from `simulate` or `flown`.
    law : Law, optional
        What flew it.

    Returns
    -------
    dict
        Distances in m, times in s; empty if the mission adds nothing to the model, or if that
        other flight needs far shorter steps and would take too many.
    """
    if is_ideal(mission):
        return {}
    times, step = flight["time"].values, float(flight.attrs["step"])
    if len(times) < 2:
        return {}
    bare = mission.model_copy(update={name: type(getattr(mission, name))() for name in CONDITIONS})
    finer = max(1, math.ceil(step / flight_step(bare, None, law)))  # held output may be slower
    if finer > 1 and finer * float(flight.attrs["steps"]) > MAX_SLOW_STEPS:
        return {}
    every = finer * round(float(times[1]) / step)
    ideal = flown(bare, Timing(float(times[-1]), step / finer, every), law=law)
    positions, times_of_ideal = ideal["position"].values, ideal["time"].values
    if len(times) == len(positions) + 1 and ideal.attrs["outcome"] == "flown":  # cut short
        whole = finer * round(float(times[-1]) / step)
        end = flown(bare, Timing(float(times[-1]), step / finer, whole), law=law)
        positions = np.vstack([positions, end["position"].values[-1:]])
        times_of_ideal = np.append(times_of_ideal, end["time"].values[-1])
    both = min(len(times), len(positions))
    same = np.isclose(times[:both], times_of_ideal[:both], rtol=0, atol=step / 2)
    apart = (flight["position"].values[:both] - positions[:both])[same]
    distance = np.linalg.norm(apart, axis=1)
    until, settled = float(times[:both][same][-1]), summary(ideal)["settled_at"]
    told = until, settled, float(distance.max()), float(distance[-1])
    return dict(zip(OF_THE_IDEAL, told, strict=True))


def save(flight: Record, path: str | Path) -> None:
    """Write a flight to a netCDF-4 file.

    Parameters
    ----------
    flight : Record
    path : str or Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    write_bytes(path, flight.netcdf())


def _run(
    machine: Runner, numbers: LoopNumbers, step: float, samples: int, every: int
) -> tuple[Array, bool]:
    """Return the flight states from the start on, (1 + samples, k), and whether all are good."""
    (start,) = flight_states(numbers.start[None], numbers.goal, numbers.points)
    states, good = machine.run(start, numbers.design, numbers.points, step, samples, every)
    return np.vstack([start, states]), good


def fly_as_built(
    plan: Plan,
    compiler: str | None,
    finer: int | None,
    control: Callable[[], kernel.Control] | None = None,
    eyes: Callable[[], kernel.Eyes] | None = None,
) -> Record:
    """Fly once with the sensors, rotors, wind and errors that the mission names.

    A flight that ends early, with few samples kept, is kept in about `finer` samples.

    Parameters
    ----------
    plan : Plan
    compiler : str, optional
        As in `simulate`.
    finer : int, optional
        Number of samples.
    control, eyes : callable, optional
        Make what is in place of the loop's controller and camera, for each time that it is flown.
    """
    mission, machine = plan.mission, VIRTUAL_MACHINE
    if control is None and eyes is None:
        machine = kernel.machine(plan.loop, plan.schedule, compiler)  # compiled before it is timed
    check_patience(plan.samples * plan.every, plan.step, machine)

    def fly_all(plan: Plan) -> tuple[Array, Array, int]:
        stop = kernel.Stop()
        own: dict[str, Any] = {"control": control and control(), "eyes": eyes and eyes()}
        records, memory, good = interruptibly(
            lambda: fly_raw(plan, 0, 1, compiler=compiler, stop=stop, **own), stop.set
        )
        return records[0, : good[0] + 1], memory[0], int(good[0])

    def fly(samples: int, every: int) -> tuple[Array, bool]:
        rows, _, good = fly_all(replace(plan, samples=samples, every=every))
        return rows, good == samples

    begin = time.perf_counter()
    kept, last, good = fly_all(plan)
    seconds = time.perf_counter() - begin
    code, at = how_it_ended(plan, last, good)
    lost, lost_at = (last[place(LAYOUT, name)][0] for name in ("lost", "lost_at"))
    taken, outcome = plan.every * np.arange(len(kept)), "flown"
    if code:
        told = round(at / plan.step) if is_noted(code) else None
        end = last_good_step(fly, kept, plan.every, told)
        kept, taken = up_to(fly, kept, plan.every, end, finer)
        outcome = ending_words(code, (end if told is not None else end + 1) * plan.step)
    flight = _record_as_built(plan, kept, taken)
    if eyes is None:
        words = "since the exposure of the frame that the controller uses"
        flight.add("image_age", ["time"], image_age(plan, flight), units="s", long_name=words)
    flight.attrs.update(
        {
            "outcome": outcome,
            "settled_at": math.nan if code else float(settled_at(log_of(plan, last), plan.step)),
            "step": plan.step,
            "steps": int(taken[-1]),
            "seconds": seconds,
            "machine": machine.split(",")[0],
            "model_sha256": plan.model_sha256,
            "conditions": json.dumps(mission.conditions()),
            "seed": plan.seed,
            "frames_lost": int(lost),
        }
    )
    if lost:
        flight.attrs["left_view_at"] = float(lost_at) * plan.step
    return flight


def _record_as_built(plan: Plan, kept: Array, taken: NDArray[np.int64]) -> Record:
    """Return samples, a row each, at so many steps from the start, as a record."""
    parts = {name: kept[:, place(plan.record, name)] for name in plan.record}
    felt, mission = parts.get("specific_force"), plan.mission
    flight = flight_record(mission, plan.numbers, parts["state"], plan.step * taken, felt)
    vehicle, frame = mission.vehicle, mission.vehicle.frame
    lengths = vehicle.reach * (1 + mission.model_error.arm), vehicle.drag_ratio
    arm, drag = (ca.SX(float(x)) for x in lengths)
    thrusts = ca.SX.sym("thrusts", len(frame.names))
    made = ca.Function("made", [thrusts], [wrench(frame, thrusts, arm, drag)[1:]])
    flight["rotor_thrust"].values[:] = parts["rotor_thrust"]
    flight["torque"].values[:] = np.array(made.map(len(kept))(parts["rotor_thrust"].T)).T
    for name, dims, units, words in (
        ("thrust_command", ("time",), "N", "thrust that the controller asks for"),
        (
            "centroid_held",
            ("time", "body_axis"),
            "1",
            f"{feature_words(plan.numbers.law)} that the controller uses",
        ),
        ("wind", ("time", "axis"), "m/s", "wind, world frame"),
        ("rotor_command", ("time", "rotor"), "N", "thrust that each rotor is asked for"),
        ("specific_force", ("time", "body_axis"), "m/s²", "true specific force a, body frame"),
    ):
        if name not in parts:
            continue
        values = parts[name] if len(dims) > 1 else parts[name].ravel()
        flight.add(name, dims, values, units=units, long_name=words)
    return flight
