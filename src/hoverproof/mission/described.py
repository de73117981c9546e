"""What a file of another tool says of a vehicle.

It is turned into body axes x forward, y right, z down, about the centre of mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DOWN = np.diag([1.0, -1.0, -1.0])
"""From axes x forward, y left, z up to x forward, y right, z down."""


@dataclass(frozen=True)
class RotorSaid:
    """A rotor of a file.

    Attributes
    ----------
    position : (3,)
        Body axes, m.
    spin : int
        A bare number: 1 to the left, seen from above, -1 to the right, 0 if the file does not say.
    thrust_max : float or None
        N.
    """

    position: tuple[float, float, float]
    spin: int
    thrust_max: float | None = None


@dataclass(frozen=True)
class VehicleFile:
    """What a file says of a vehicle; None where it says nothing.

    Attributes
    ----------
    kind : str
        Of the file.
    mass : float or None
        kg.
    inertia : (3, 3) or None
        About the centre of mass, body axes, kg m².
    rotors : tuple of RotorSaid
        From the centre of mass.
    drag_ratio : float or None
        m.
    rotor_lag : float or None
        s.
    words : tuple of str
        What was assumed, and what is in doubt.
    layout : str
        Of four rotors of which the file says no length, as "x"; empty else.
    """

    kind: str
    mass: float | None = None
    inertia: Array | None = None
    rotors: tuple[RotorSaid, ...] = ()
    drag_ratio: float | None = None
    rotor_lag: float | None = None
    words: tuple[str, ...] = ()
    layout: str = ""


def of_bodies(bodies: list[tuple[float, Array, Array]]) -> tuple[float, Array, Array]:
    """Return mass, kg, centre, (3,), m, and inertia about it, (3, 3), kg m², of all bodies.

    Parameters
    ----------
    bodies : list of (mass, centre, inertia about it)
        kg, (3,) in m and (3, 3) in kg m².
    """
    mass = sum(m for m, _, _ in bodies)
    centre: Array = np.sum([m * c for m, c, _ in bodies], axis=0) / mass
    whole = np.zeros((3, 3))
    for m, c, inertia in bodies:
        r = c - centre
        whole += inertia + m * (r @ r * np.eye(3) - np.outer(r, r))
    return mass, centre, whole


def down(
    kind: str,
    bodies: list[tuple[float, Array, Array]],
    rotors: Sequence[tuple[Array, int, float | None]],
    **more: float | tuple[str, ...] | None,
) -> VehicleFile:
    """Return a vehicle of a file whose axes are x forward, y left, z up.

    Parameters
    ----------
    kind : str
        Of the file.
    bodies : list of (mass, centre, inertia about it)
        kg, (3,) in m and (3, 3) in kg m².
    rotors : sequence of (position, spin, thrust_max)
        (3,) in m, and as in `RotorSaid`.
    **more
        Further attributes of `VehicleFile`, in their units: m, s.
    """
    bodies = [body for body in bodies if body[0] > 0]
    if not bodies:
        raise ValueError(f"{kind} has no mass")
    mass, centre, inertia = of_bodies(bodies)
    said = []
    for place, spin, most in rotors:
        x, y, z = (DOWN @ (place - centre)).tolist()
        said.append(RotorSaid((x, y, z), spin, most))
    return VehicleFile(kind, mass, DOWN @ inertia @ DOWN, tuple(said), **more)  # type: ignore[arg-type]
