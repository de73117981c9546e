"""Whether any weights satisfy the inequality at the goal itself, and which gain would give some."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from hoverproof.certification.attraction.inequality import Bounds
from hoverproof.certification.attraction.tolerant import posed
from hoverproof.mission.sections import Mission

NEAR = 1e-3
"""Of the height above the target: so near to the goal is a hover that is to be inside."""
FORCES = 0.003, 0.03, 0.2, 0.6
"""Shares of the largest force that are tried."""
OTHERS = ("k2", 2), ("k2", 4), ("k3", 2), ("k4", 2), ("k4", Fraction(1, 2)), ("k1", Fraction(1, 2))
"""Gains that are tried, and by which they are multiplied."""


def no_weights(mission: Mission) -> tuple[str, tuple[str, ...]] | None:
    """Say why no weights hold near the goal, and what would help; None where some do.

    Every set that holds the goal has the eigenvalues of Q there in its bounds, so without weights
    there the theorem proves nothing for these gains, whatever the starts. It is solved in floating
    point.

    Parameters
    ----------
    mission : Mission
    """
    largest = _least_bound(mission)
    if largest is None:
        return None
    reason = (
        "no weights satisfy the inequality of this theorem even at the goal, where Q has an "
        f"eigenvalue of {largest:.4g} 1/m"
    )
    for name, times in OTHERS:
        value = getattr(mission.gains, name) * times
        gains = mission.gains.model_copy(update={name: value})
        if _least_bound(mission.model_copy(update={"gains": gains})) is None:
            return reason, (f"{name} = {float(value):.6g}: then there are weights at the goal",)
    return reason, ()


def _least_bound(mission: Mission) -> float | None:
    """Return the largest eigenvalue of Q at the goal, 1/m, if no weights go with it."""
    potential, loop = posed(mission)
    height = potential.height(float(potential.goal[2]))
    near = potential.hover_terms((potential.goal + np.array([NEAR * height, 0, 0]))[None])
    largest = potential.largest_at_goal
    for share in FORCES:
        bounds = Bounds(share * loop.largest_force, largest)
        if loop.largest_force > 0 and loop.solve(bounds, near) is not None:
            return None
    return float(largest)
