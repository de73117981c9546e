"""The structs of a package's header, as ctypes has them."""

from __future__ import annotations

import ctypes
import re
from typing import Any

import numpy as np

NUMBERS = {"float": ctypes.c_float, "double": ctypes.c_double, "uint32_t": ctypes.c_uint32}


def structs_of(header: str, name: str) -> dict[str, type[ctypes.Structure]]:
    """Return the structs of a package's header, by the word between its name and ``_t``.

    Parameters
    ----------
    header : str
        Its text.
    name : str
        Of the package.
    """
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
    points = re.search(rf"#define {name.upper()}_POINTS \((\d+)\)", text)
    text = text.replace(f"{name.upper()}_POINTS", points[1] if points else "")
    found = {}
    for body, kind in re.findall(rf"typedef struct \{{([^}}]*)\}} {name}_(\w+)_t;", text):
        fields = []
        for number, field, sizes in re.findall(r"(\w+) (\w+)((?:\[\d+\])*);", body):
            held: Any = NUMBERS[number]
            for size in reversed(re.findall(r"\d+", sizes)):
                held *= int(size)
            fields.append((field, held))
        found[kind] = type(kind, (ctypes.Structure,), {"_fields_": fields})
    return found


def put(struct: ctypes.Structure, key: str, value: Any) -> None:
    """Set a field to a number, or to numbers of its own shape.

    Parameters
    ----------
    struct : ctypes.Structure
    key : str
        Name of the field.
    value : float or array_like
        Any unit and shape that the field has.

    Raises
    ------
    ValueError
        If the shape is another one.
    """
    field = getattr(struct, key)
    if not isinstance(field, ctypes.Array):
        setattr(struct, key, int(value) if isinstance(field, int) else float(value))
        return
    place = np.ctypeslib.as_array(field)
    if place.shape != np.shape(value):
        raise ValueError(f"{key} has the shape {place.shape}, not {np.shape(value)}")
    with np.errstate(over="ignore"):  # beyond its precision it is infinite: the step refuses it
        place[...] = value
