"""What a set of states adds to Λ, in floating point: hints for a proof."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.attraction.inequality import Loop
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.cells import View
from hoverproof.mission.sections import Mission

Array = NDArray[np.float64]


def added(mission: Mission, potential: Potential, loop: Loop, start: Start) -> Array:
    """Return what a start that moves adds to |δ1|, then |δ2| and |δ3|, and to |δ4|, (4,).

    See `checker.added`.

    Parameters
    ----------
    mission : Mission
    potential : Potential
    loop : Loop
    start : Start
    """
    m, gains, q3 = float(mission.vehicle.mass), mission.gains, potential.q3
    speed, tilt, rate, thrust = map(float, (start.speed, start.tilt, start.rate, start.thrust))
    moved, lean = m / float(gains.k1) * speed, loop.weight / loop.stiffness * tilt
    quick = loop.stiffness * float(gains.k1 * gains.k2 + gains.k3)
    turned = m / quick * (loop.weight + thrust - loop.stiffness * q3) * rate
    last = turned + lean + moved + potential.n * tilt
    return np.array([q3 * tilt, moved, thrust / loop.stiffness + lean, last])


def start_terms(potential: Potential, add: Array, cells: Array) -> Array:
    """Return (k, 4): Λ <= terms · (1, a2, a3, a4) over cells; see `checker.below_level`.

    Infinite where a cell may hold a target point.

    Parameters
    ----------
    potential : Potential
    add : (4,)
        See `added`.
    cells : (k, 3, 2)
        Low and high ends, world frame, m.
    """
    view = View.of(potential.points, cells)
    ends = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), axis=-1).reshape(-1, 3)
    corners = cells[:, np.arange(3)[None], ends]
    value = potential.value(corners.reshape(-1, 3)).reshape(-1, 8).max(axis=1)
    change = (view.radius[:, None] / view.apart).sum(axis=1)
    d1 = view.centroid - [0, 0, potential.q3]
    level, whole = (np.linalg.norm(d1[:, :k], axis=1) + change for k in (2, 3))
    d2 = whole + add[0] + add[1]
    d3, d4 = d2 + add[2], level + add[3]
    terms = np.stack([value, d2**2 / 2, d3**2 / 2, d4**2 / 2], axis=1)
    terms[(view.distance <= view.radius[:, None]).any(axis=1)] = np.inf
    return terms
