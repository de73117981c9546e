"""What a file that describes a vehicle answers of the questions of `new`."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable

import numpy as np

from hoverproof.cli.questions import Answers, in_layout, in_rotor, in_rotors
from hoverproof.mission.described import RotorSaid, VehicleFile

DIGITS = 6
SMALL = 1e-6
"""Of the largest moment: a product of inertia below it is rounding."""


def answers_of_vehicle(found: VehicleFile) -> Answers:
    """Return what a file answers, as TOML, with its words as comments where the rotors stand.

    Parameters
    ----------
    found : VehicleFile
    """
    known: Answers = {}
    if found.mass is not None:
        known["mass"] = _text(found.mass)
    if found.inertia is not None:
        known["inertia"] = _row(found.inertia.diagonal().tolist())
    if found.drag_ratio:
        known["drag_ratio"] = _text(found.drag_ratio)
    if found.rotor_lag:
        known["rotor_lag"] = _text(found.rotor_lag)
    if found.rotors:
        squares = [x * x + y * y for x, y, _ in (r.position for r in found.rotors)]
        known["rotor_distance"] = f"{math.sqrt(sum(squares) / len(squares)):.4g}"
        known["placed"] = _comments(found) + in_rotors(
            in_rotor(_row(r.position), "ccw" if r.spin > 0 else "cw", _most(r))
            for r in found.rotors
        )
    if found.rotors or found.layout:
        known["layout"] = '"x"'  # not asked: the file says where they are
    return known


def said_of_vehicle(found: VehicleFile) -> list[str]:
    """Return in words what a file says, each number with its unit, and what is in doubt.

    Parameters
    ----------
    found : VehicleFile
    """
    said = []
    if found.mass is not None:
        said.append(f"mass {_text(found.mass)} kg")
    if found.inertia is not None:
        said.append(f"inertia {_row(found.inertia.diagonal().tolist())} kg m² about the body axes")
    if found.rotors:
        said.append(f"{len(found.rotors)} rotors, positions in m")
        if all(r.thrust_max for r in found.rotors):
            most = sorted({_text(r.thrust_max or 0) for r in found.rotors})
            said.append(f"highest thrust of a rotor {' to '.join([most[0], *most[1:][-1:]])} N")
    if found.drag_ratio:
        said.append(f"drag torque over thrust {_text(found.drag_ratio)} m")
    if found.rotor_lag:
        said.append(f"lag of the rotors {_text(found.rotor_lag)} s")
    return [*said, *(_products(found)), *found.words]


def in_layout_of(found: VehicleFile, distance: str) -> str:
    """Return the lines of a file that says a layout and no length.

    Parameters
    ----------
    found : VehicleFile
    distance : str
        Of a rotor, m, as TOML.
    """
    layout, *more = found.layout.splitlines()
    return _comments(found) + "\n".join([in_layout(layout, distance), *more])


def _products(found: VehicleFile) -> list[str]:
    """Say that products of inertia are left out, of a vehicle with tolerances of torque."""
    if found.inertia is None:
        return []
    aside = [found.inertia[i, j] for i, j in ((0, 1), (0, 2), (1, 2))]
    if np.abs(aside).max() <= SMALL * found.inertia.diagonal().max():
        return []
    return [products_left_out(aside)]


def products_left_out(products: Iterable[float]) -> str:
    """Say of products of inertia, kg m², that a mission with tolerances has them not.

    Parameters
    ----------
    products : iterable of float
        I12, I13, I23, (3,), kg m².
    """
    return (
        f"products of inertia {_row(products)} kg m² (xy, xz, yz) are left out, as a proof with "
        "tolerances of torque and lag takes principal moments"
    )


def comment(words: str) -> str:
    """Return the lines of a comment in a mission.

    Parameters
    ----------
    words : str
    """
    return "".join(
        f"# {line}\n"
        for line in textwrap.wrap(words, 96, break_long_words=False, break_on_hyphens=False)
    )


def _comments(found: VehicleFile) -> str:
    return comment("; ".join([f"From a file ({found.kind})", *_products(found), *found.words]))


def _most(rotor: RotorSaid) -> str:
    return f", thrust_max = {_text(rotor.thrust_max)}" if rotor.thrust_max else ""


def _text(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def _row(values: Iterable[float]) -> str:
    return f"[{', '.join(_text(round(float(v), 12) + 0.0) for v in values)}]"
