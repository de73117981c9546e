"""Fly runs of a plan, and keep what matters of each."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import hoverproof
from hoverproof.errors import InputError
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.simulation import kernel
from hoverproof.simulation.compiled import has_diverged
from hoverproof.simulation.draws import memory_and_parameters
from hoverproof.simulation.numbers import euler_angles, settled_index
from hoverproof.simulation.plan import Plan
from hoverproof.simulation.realistic import LAYOUT, place

Array = NDArray[np.float64]

OUTCOMES = (
    "flown",
    "target_left_the_view",
    "no_depth_left",
    "no_thrust_above_the_singularity_left",
    "diverged",
)
"""What became of a run; its place here is its code. -1 stands for a run not flown yet."""


def outcome_code(plan: Plan, memory: Array, taken: int) -> int:
    """Return the place in `OUTCOMES` of a run that ended with this memory, (MEMORY,).

    Parameters
    ----------
    plan : Plan
    memory : (m,)
        The last memory, m = MEMORY: packed state, then guards, and the rest of `LAYOUT` if any.
    taken : int
        Number of good records after the start.
    """
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
