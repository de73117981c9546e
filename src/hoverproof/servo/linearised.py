"""The closed loop linearised at the goal of a mission: how fast its slowest motion decays."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.derived import kept_graph
from hoverproof.algebra.graph import evaluate
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.loop import LoopNumbers
from hoverproof.servo.lyapunov import linearised_loop, thrust_factor

Array = NDArray[np.float64]


@kept_graph
def _loop_at_goal(law: Law) -> ca.Function:
    """Return (design, Q, thrust) ↦ B of Ẋ = B X near the goal: (3, 3) and () to (11, 11)."""
    design, Q, thrust = law.design.symbols(), ca.SX.sym("Q", 3, 3), ca.SX.sym("thrust")
    B = linearised_loop(law)(design.vector(), Q, thrust_factor(thrust, design, law))
    return ca.Function("loop_at_goal", [design.vector(), Q, thrust], [B])


def slowest_rates(mission: Mission, gains: tuple[Array, ...]) -> Array:
    """Return the decay rate of the slowest motion of the loop linearised at the goal, 1/s, (m,).

    Parameters
    ----------
    mission : Mission
        Its gains do not count.
    gains : (4,) of (m,)
        Those of the error chain, in the order and units of the law's design.
    """
    numbers = LoopNumbers.of(mission)
    return _slowest_rates(numbers, numbers.designs(gains))


def slowest_rate(mission: Mission, law: Law | None = None) -> float:
    """Return the decay rate of the slowest motion with a mission's own gains, 1/s.

    Negative if some motion grows.

    Parameters
    ----------
    mission : Mission
    law : Law
    """
    numbers = LoopNumbers.of(mission, law)
    return float(_slowest_rates(numbers, numbers.design[:, None])[0])


def _slowest_rates(numbers: LoopNumbers, designs: Array) -> Array:
    columns = numbers.depth_matrix().T.ravel()  # a slope need not be symmetric
    inputs: list[Any] = [designs, columns, [numbers.hover_thrust]]
    rows = evaluate(_loop_at_goal(numbers.law), inputs, float)[0]
    B = np.empty((designs.shape[1], len(rows), len(rows)))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            B[:, i, j] = entry
    return np.asarray(-np.linalg.eigvals(B).real.max(axis=1), np.float64)
