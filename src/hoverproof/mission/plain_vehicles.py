"""Vehicles of parameter files: RotorPy's Python, read as data, and dumps of PX4 and Betaflight."""

from __future__ import annotations

import ast
import math
import operator
import re
from typing import Any

import numpy as np

from hoverproof.mission.described import RotorSaid, VehicleFile, down
from hoverproof.mission.frame import PLUS, X

MAX_NODES = 20_000
LEAN = 0.05
"""Of a rotor's axis, from which on it does not push straight up."""
PX4S_KM = 0.05
"""m: what PX4 takes for the drag ratio of a rotor where nobody has said it."""
PX4S_CT = 6.5
"""N: what PX4 takes a rotor to give at full output where nobody has said it."""
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
    if re.search(r"(?m)^\s*(mixer \w+|set yaw_motors_reversed|# Betaflight /|board_name )", text):
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
    speed = number("rotor_speed_max")
    most = [None if not thrust or not speed else thrust * speed**2] * len(places)
    words = () if places else ("no positions of rotors (rotor_pos)",)
    return down(
        "RotorPy",
        [(mass, np.zeros(3), inertia)],
        list(zip(places, signs, most, strict=True)),
        drag_ratio=torque / thrust if thrust and torque else None,
        rotor_lag=number("tau_m"),
        words=words,
    )


# --- PX4: CA_ROTORn_PX, PY, PZ in m, x forward, y right, z down; KM above 0 turns to the left -----


def _px4(text: str) -> VehicleFile:
    found: dict[str, float] = {}
    for name, value in re.findall(
        r"(?m)\b(CA_ROTOR(?:\d+_(?:P[XYZ]|A[XYZ]|KM|CT)|_COUNT))[\s,]+([-+.\deE]+)", text
    ):
        found[name] = float(value)
    numbers = sorted({int(n) for n in re.findall(r"CA_ROTOR(\d+)_P[XY]", text)})
    count = int(found.get("CA_ROTOR_COUNT", len(numbers)))
    for name in (f"CA_ROTOR{i}_A{axis}" for i in range(count) for axis in "XY"):
        if abs(found.get(name, 0.0)) > LEAN:
            raise ValueError(f"{name} turns a rotor aside: each is to push straight up")
    rotors, ratios = [], []
    for i in numbers[:count]:
        x, y, z = (found.get(f"CA_ROTOR{i}_P{axis}", 0.0) for axis in "XYZ")
        turning, most = found.get(f"CA_ROTOR{i}_KM", PX4S_KM), found.get(f"CA_ROTOR{i}_CT", PX4S_CT)
        rotors.append(
            RotorSaid((x, y, z), 1 if turning > 0 else -1, None if most == PX4S_CT else most)
        )
        ratios.append(abs(turning))
    words = []
    if any(max(map(abs, r.position)) >= 1 for r in rotors):
        words.append(
            "positions of 1 and more: PX4 also takes them without a unit; they are to be m"
        )
    measured = any(abs(found.get(f"CA_ROTOR{i}_KM", PX4S_KM)) != PX4S_KM for i in numbers)
    if not measured:
        words.append("KM is PX4's default of 0.05 m, which nobody has measured: it is not taken")
    ratio = ratios[0] if measured else None
    if (layout := _normalized(rotors)) is not None:
        words = [w for w in words if "positions" not in w]
        words.append("positions are of 1, without a unit: they say the layout, and no length")
        return VehicleFile("PX4", drag_ratio=ratio, words=tuple(words), layout=layout)
    return VehicleFile("PX4", rotors=tuple(rotors), drag_ratio=ratio, words=tuple(words))


def _normalized(rotors: list[RotorSaid]) -> str | None:
    """Return the layout of four rotors whose places are of 1 m, as PX4 has generic frames."""
    turns = {(x, y): rotor.spin for rotor in rotors for x, y, _ in [rotor.position]}
    for name, frame in (("x", X), ("plus", PLUS)):
        own = {(float(x), float(y)): int(t) for (x, y), t in zip(*frame[1:], strict=True)}
        if turns == own:
            return name
        if turns == {place: -turn for place, turn in own.items()}:
            return f"{name}\nreversed = true"
    return None


def _betaflight(text: str) -> VehicleFile:
    mixer = re.search(r"(?m)^\s*mixer (\w+)", text)
    kinds = {"QUADX": "x", "QUADP": "plus", "HEX6X": "hex", "OCTOFLATX": "octo"}
    name = mixer[1].upper() if mixer else "QUADX"
    if name not in kinds:
        raise ValueError(f"its mixer {name} is none of {', '.join(kinds)}")
    backwards = re.search(r"(?m)^\s*set yaw_motors_reversed\s*=\s*ON", text) is not None
    words = ["Betaflight knows no lengths, mass or inertia"]
    words += [] if mixer else ["no mixer is named, so it is Betaflight's own, QUADX"]
    words += ["propellers are reversed"] if backwards else []
    layout = kinds[name] + ("\nreversed = true" if backwards else "")
    return VehicleFile("Betaflight", words=tuple(words), layout=layout)
