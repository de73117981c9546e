"""Vehicles of parameter files: RotorPy's Python, read as data, and dumps of PX4 and Betaflight."""

from __future__ import annotations

import ast
import math
import operator
import re
from typing import Any

import numpy as np

from hoverproof.mission.described import RotorSaid, VehicleFile, down

MAX_NODES = 20_000
_OPERATIONS: dict[type[ast.AST], Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS: dict[str, Any] = {
    "array": np.array,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "deg2rad": np.deg2rad,
}


def read_plain(text: str) -> VehicleFile:
    """Read a parameter dict of RotorPy, or parameters of PX4 or Betaflight.

    Parameters
    ----------
    text : str

    Raises
    ------
    ValueError
        If it is none of these.
    """
    if re.search(r"(?m)\bCA_ROTOR\d+_P[XY]\b", text):
        return _px4(text)
    if re.search(r"(?m)^\s*(mixer \w+|set yaw_motors_reversed)", text):
        return _betaflight(text)
    for value in _values(text).values():
        if isinstance(value, dict) and "mass" in value:
            return _rotorpy(value)
    raise ValueError("it is neither XML nor parameters of RotorPy, PX4 or Betaflight")


# --- RotorPy: a dict of numbers, axes x forward, y left, z up -------------------------------------


def _values(text: str) -> dict[str, Any]:
    """Return what a Python text assigns, as far as it is numbers; nothing of it is run."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, MemoryError):
        return {}
    if sum(1 for _ in ast.walk(tree)) > MAX_NODES:
        raise ValueError("it is too long")
    known: dict[str, Any] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            found = _value(statement.value, known)
            if found is not None:
                known[statement.targets[0].id] = found
    return known


def _value(node: ast.AST, known: dict[str, Any]) -> Any:
    """Return the number, or what is made of numbers, that a node stands for; None if it is else."""
    if isinstance(node, ast.Constant):
        number: Any = node.value
        return float(number) if type(number) in (int, float) else None
    if isinstance(node, ast.Name):
        return known.get(node.id)
    if isinstance(node, ast.List | ast.Tuple):
        return [_value(entry, known) for entry in node.elts]
    if isinstance(node, ast.Dict):
        return {
            key.value: _value(entry, known)
            for key, entry in zip(node.keys, node.values, strict=True)
            if isinstance(key, ast.Constant)
        }
    if isinstance(node, ast.UnaryOp | ast.BinOp) and type(node.op) in _OPERATIONS:
        sides = [node.operand] if isinstance(node, ast.UnaryOp) else [node.left, node.right]
        values = [_value(side, known) for side in sides]
        if all(isinstance(v, float | np.ndarray | np.floating) for v in values):
            return _OPERATIONS[type(node.op)](*values)
    if isinstance(node, ast.Attribute) and node.attr == "pi":
        return math.pi
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and len(node.args) == 1:
        function, value = _FUNCTIONS.get(node.func.attr), _value(node.args[0], known)
        flat = value if not isinstance(value, list) else None if None in value else value
        if function is not None and flat is not None:
            return function(flat)
    return None


def _rotorpy(held: dict[str, Any]) -> VehicleFile:
    def number(key: str) -> float | None:
        value = held.get(key)
        return float(value) if isinstance(value, float | np.floating) else None

    mass, moments = number("mass"), [number(key) for key in ("Ixx", "Iyy", "Izz")]
    if mass is None or None in moments:
        raise ValueError("its dict lacks mass, Ixx, Iyy or Izz as a number")
    xy, xz, yz = (number(key) or 0.0 for key in ("Ixy", "Ixz", "Iyz"))
    xx, yy, zz = (m or 0.0 for m in moments)
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    places = [np.array(p, float) for p in (held.get("rotor_pos") or {}).values()]
    if any(p.shape != (3,) for p in places):
        raise ValueError("a position of its rotor_pos is not three numbers")
    turning = held.get("rotor_directions")
    signs = [0] * len(places) if turning is None else [-int(s) for s in np.array(turning, float)]
    if len(signs) != len(places):
        raise ValueError("rotor_pos and rotor_directions are not of as many rotors")
    thrust, torque = number("k_eta"), number("k_m")
    words = () if places else ("no positions of rotors (rotor_pos)",)
    return down(
        "RotorPy",
        [(mass, np.zeros(3), inertia)],
        list(zip(places, signs, strict=True)),
        drag_ratio=torque / thrust if thrust and torque else None,
        rotor_lag=number("tau_m"),
        words=words,
    )


# --- PX4: CA_ROTORn_PX, PY, PZ in m, x forward, y right, z down; KM above 0 turns to the left -----


def _px4(text: str) -> VehicleFile:
    found: dict[str, float] = {}
    for name, value in re.findall(
        r"(?m)\b((?:CA_ROTOR(?:\d+_(?:P[XYZ]|KM|CT)|_COUNT))|MPC_THR_HOVER)[\s,]+([-+.\deE]+)", text
    ):
        found[name] = float(value)
    numbers = sorted({int(n) for n in re.findall(r"CA_ROTOR(\d+)_P[XY]", text)})
    count = int(found.get("CA_ROTOR_COUNT", len(numbers)))
    rotors, ratios = [], []
    for i in numbers[:count]:
        x, y, z = (found.get(f"CA_ROTOR{i}_P{axis}", 0.0) for axis in "XYZ")
        turning = found.get(f"CA_ROTOR{i}_KM", 0.05)
        rotors.append(RotorSaid((x, y, z), 1 if turning > 0 else -1))
        ratios.append(abs(turning))
    words = []
    if any(max(map(abs, r.position)) >= 1 for r in rotors):
        words.append(
            "positions of 1 and more: PX4 also takes them without a unit; they are to be m"
        )
    if all(
        f"CA_ROTOR{i}_KM" not in found or abs(found[f"CA_ROTOR{i}_KM"]) == 0.05 for i in numbers
    ):
        words.append("KM is PX4's default of 0.05 m, not measured")
    return VehicleFile("PX4", rotors=tuple(rotors), drag_ratio=ratios[0], words=tuple(words))


def _betaflight(text: str) -> VehicleFile:
    mixer = re.search(r"(?m)^\s*mixer (\w+)", text)
    kinds = {"QUADX": "x", "QUADP": "plus", "HEX6X": "hex", "OCTOFLATX": "octo"}
    name = mixer[1].upper() if mixer else "QUADX"
    if name not in kinds:
        raise ValueError(f"its mixer {name} is none of {', '.join(kinds)}")
    backwards = re.search(r"(?m)^\s*set yaw_motors_reversed\s*=\s*ON", text) is not None
    words = ["Betaflight knows no lengths, mass or inertia"]
    words += ["propellers are reversed"] if backwards else []
    layout = kinds[name] + ("\nreversed = true" if backwards else "")
    return VehicleFile("Betaflight", words=tuple(words), layout=layout)
