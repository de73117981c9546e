"""Fly runs of a plan, and keep what matters of each."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.servo.layout import place
from hoverproof.simulation import kernel
from hoverproof.simulation.compiled import has_diverged
from hoverproof.simulation.draws import memory_and_parameters
from hoverproof.simulation.flight_log import ending, settled_at
from hoverproof.simulation.numbers import euler_angles
from hoverproof.simulation.plan import Plan
from hoverproof.simulation.step import GUARDED_SIZE
from hoverproof.simulation.surroundings import LAYOUT
from hoverproof.version import __version__

Array = NDArray[np.float64]


def log_of(plan: Plan, memory: Array) -> Array:
    """Return the log of flights, (..., LOG_SIZE).

    Parameters
    ----------
    plan : Plan
    memory : (..., m)
        Their last memory, SI units: the flight state, or as in `Features.layout`.
    """
    if plan.ideal:
        return memory[..., GUARDED_SIZE:]
    return memory[..., place(plan.features.layout(plan.numbers.law, plan.rotors), "log")]


def how_it_ended(plan: Plan, memory: Array, taken: int) -> tuple[int, float]:
    """Return the place in `OUTCOMES` of a run, and when it ended, s.

    Parameters
    ----------
    plan : Plan
    memory : (m,)
        Its last memory, SI units.
    taken : int
        Number of good records after the start.
    """
    if taken == plan.samples:
        return 0, float(plan.times[-1])
    code, step = ending(log_of(plan, memory), diverged=has_diverged(memory))
    return code, step * plan.step


def fly_raw(
    plan: Plan,
    first: int,
    count: int,
    *,
    compiler: str | None = None,
    stop: kernel.Stop | None = None,
    control: kernel.Control | None = None,
    eyes: kernel.Eyes | None = None,
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Fly runs `first` to ``first + count - 1``; see `kernel.fly` for what is returned.

    Parameters
    ----------
    plan : Plan
    first : int
        Number of the first run, from 0.
    count : int
        Number of runs to fly.
    compiler : str, optional
        As in `hoverproof.simulation.compiled.runner`.
    stop : Stop, optional
        Ends the flights when set.
    control, eyes : callable, optional
        In place of the loop's controller and camera, see `kernel.fly`.
    """
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
        control=control,
        eyes=eyes,
    )


def fly_block(
    plan: Plan, part: tuple[int, int], stop: kernel.Stop | None = None
) -> dict[str, NDArray[Any]]:
    """Fly some runs and return what is kept of each.

    Parameters
    ----------
    plan : Plan
    part : (int, int)
        Number of the first run, from 0, and number of runs.
    stop : Stop, optional
        Ends the flights when set.

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
    if plan.version != __version__:
        found = f"a worker has hoverproof {__version__}, not {plan.version}"
        raise InputError("--scheduler", "", found)
    records, memory, taken = fly_raw(plan, *part, stop=stop)
    whole = {name: records[..., place(plan.record, name)] for name in plan.record}
    state = whole["state"]
    rotation = state[..., 6:15].reshape(*state.shape[:2], 3, 3).swapaxes(-1, -2)
    error = np.linalg.norm(state[..., :3] - plan.numbers.goal, axis=-1)
    tilt = np.arctan2(np.hypot(rotation[..., 2, 0], rotation[..., 2, 1]), rotation[..., 2, 2])
    runs = np.arange(len(taken))
    flown = taken == plan.samples
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
            [how_it_ended(plan, m, t)[0] for m, t in zip(memory, taken, strict=True)], np.int8
        ),
        "flown_until": times[taken],
        "start_error": error[:, 0],
        "final_error": error[runs, taken],
        "settled_at": np.where(flown, settled_at(log_of(plan, memory), plan.step), np.nan),
        "largest_tilt": np.nanmax(tilt, axis=1),
        "least_rotor_thrust": np.nanmin(whole["rotor_thrust"], axis=(1, 2)),
        "greatest_rotor_thrust": np.nanmax(whole["rotor_thrust"], axis=(1, 2)),
        "frames_lost": lost.astype(np.int32),
        "left_view_at": np.where(lost > 0, lost_at * plan.step, np.nan),
    }
