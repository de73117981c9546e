"""What a set of states adds to Λ, in floating point: hints for a proof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.cells import View
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shares:
    """What speed, lean, rates and thrust of a start add to |δ|; see `checker.shares_of`.

    Attributes
    ----------
    moved, lean, push, turned : float
        By the speed, by the tilt through the force, by the thrust, and by the rates.
    tilted, tilted_all : float
        Of q3* and of q, by the tilt.
    """

    moved: float
    lean: float
    push: float
    turned: float
    tilted: float
    tilted_all: float

    @classmethod
    def of(cls, mission: Mission, potential: Potential, loop: Loop, start: Start) -> Shares:
        """Bound what a set of states adds.

        Parameters
        ----------
        mission : Mission
        potential : Potential
        loop : Loop
        start : Start
        """
        m, gains, q3 = float(mission.vehicle.mass), mission.gains, potential.q3
        speed, tilt, rate, thrust = map(float, (start.speed, start.tilt, start.rate, start.thrust))
        quick = loop.stiffness * float(gains.k1 * gains.k2 + gains.k3)
        return cls(
            moved=m / float(gains.k1) * speed,
            lean=loop.weight / loop.stiffness * tilt,
            push=thrust / loop.stiffness,
            turned=m / quick * (loop.weight + thrust - loop.stiffness * q3) * rate,
            tilted=q3 * tilt,
            tilted_all=potential.n * tilt,
        )


def start_terms(potential: Potential, add: Shares, cells: Array) -> Array:
    """Return (k, 4): Λ <= terms · (1, a2, a3, a4) over cells; see `checker.below_level`.

    Infinite where a cell may hold a target point.

    Parameters
    ----------
    potential : Potential
    add : Shares
    cells : (k, 3, 2)
        Low and high ends, world frame, m.
    """
    view = View.of(potential.points, cells)
    ends = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3)
    corners = cells[:, np.arange(3)[None], ends]
    value = potential.value(corners.reshape(-1, 3)).reshape(-1, 8).max(axis=1)
    change = (view.radius[:, None] / view.apart).sum(axis=1)
    d1 = potential.centroid(view.center) - [0, 0, potential.q3]
    level, whole = (np.linalg.norm(d1[:, :k], axis=1) + change for k in (2, 3))
    d2 = add.moved + add.tilted + whole
    d3 = add.push + add.lean + d2
    d4 = add.turned + add.lean + add.moved + level + add.tilted_all
    terms = np.stack([value, d2**2 / 2, d3**2 / 2, d4**2 / 2], axis=1)
    terms[(view.distance <= view.radius[:, None]).any(axis=1)] = np.inf
    return terms
