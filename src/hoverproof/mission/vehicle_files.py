"""Vehicles as other tools describe them: URDF, SDF, MJCF, RotorPy, PX4 and Betaflight."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from hoverproof.errors import InputError
from hoverproof.mission.described import VehicleFile
from hoverproof.mission.frame import ROTORS
from hoverproof.mission.plain_vehicles import read_plain
from hoverproof.mission.xml_vehicles import read_xml

MAX_BYTES = 4_000_000


def read_vehicle(path: str | Path) -> VehicleFile:
    """Read a file that describes a vehicle.

    Parameters
    ----------
    path : str or Path
        URDF, SDF or MJCF (XML), RotorPy (Python, read as data, not run), or parameters of PX4 or
        Betaflight (text).

    Raises
    ------
    InputError
        If it cannot be read, or nothing in it describes a vehicle.
    """
    where = str(path)
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(where, "", "is not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(where, "", f"cannot be read: {error.strerror or error}") from None
    if len(data) > MAX_BYTES:
        raise InputError(where, "", f"is larger than {MAX_BYTES} bytes")
    try:
        found = read_xml(text, Path(path)) if text.lstrip().startswith("<") else read_plain(text)
    except (ValueError, RecursionError) as error:
        raise InputError(where, "", f"describes no vehicle: {error}") from None
    return checked(_turning(found), where)


def checked(found: VehicleFile, where: str) -> VehicleFile:
    """Return what was read, with what is in doubt of its units; refuse what is no vehicle.

    Parameters
    ----------
    found : VehicleFile
    where : str
        Path of the file.
    """
    if found.mass is None and not found.rotors and not found.layout:
        raise InputError(where, "", f"{found.kind} holds neither mass nor rotors of a vehicle")
    numbers = [found.mass or 1.0, *(c for r in found.rotors for c in r.position)]
    if not all(map(math.isfinite, numbers)) or not 0 < numbers[0] < 1e6:
        raise InputError(where, "", "has a number that is not finite, or no mass above 0 kg")
    least, most = ROTORS
    if found.rotors and not least <= len(found.rotors) <= most:
        said = (
            f"{found.kind} has {len(found.rotors)} rotors: vehicles of {least} to {most} are taken"
        )
        raise InputError(where, "", said)
    words = list(found.words)
    if found.mass and found.inertia is not None and found.rotors:
        reach = max(math.hypot(*r.position[:2]) for r in found.rotors)
        radius = math.sqrt(max(found.inertia.diagonal().max(), 0) / found.mass)
        if reach and not 0.1 <= radius / reach * math.sqrt(2) <= 4:
            words.append(
                f"the inertia means a radius of gyration of {radius:.3g} m, its rotors are "
                f"{reach:.3g} m away: is it in kg m², and not in g cm² (1e-7 kg m²)?"
            )
    return replace(found, words=tuple(words))


def _turning(found: VehicleFile) -> VehicleFile:
    """Let rotors of which a file does not say how they turn do so by turns."""
    if not found.rotors or all(r.spin for r in found.rotors):
        return found
    around = sorted(found.rotors, key=lambda r: math.atan2(r.position[1], r.position[0]) % math.tau)
    turned = {id(r): replace(r, spin=(-1) ** i) for i, r in enumerate(around)}
    assumed = "how rotors turn is not said: by turns, that in front on the right to the left"
    return replace(
        found,
        rotors=tuple(turned[id(r)] for r in found.rotors),
        words=(*found.words, assumed),
    )
