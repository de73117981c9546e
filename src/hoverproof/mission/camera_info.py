"""The lens of a camera from a `camera_info` file: YAML as ROS writes and publishes it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.mission.exact_yaml import exact, read_yaml
from hoverproof.mission.fields import shown

_MODELS = {"plumb_bob": "plumb_bob", "equidistant": "equidistant", "fisheye": "equidistant"}
_OTHERS = {"": "plumb_bob", "none": "plumb_bob"}
"""What a camera without distortion has for a model."""


RELATIVE = "no such file; camera.file is relative to the mission"


def lens_of_file(path: str | Path, absent: str = RELATIVE) -> dict[str, Any]:
    """Return the keys of `Lens` that a calibration file holds, its numbers exact.

    Parameters
    ----------
    path : str or Path
        Of a file as `camera_calibration` writes it, or of a message `sensor_msgs/CameraInfo`.
    absent : str
        What is said where there is none.

    Raises
    ------
    InputError
        If it cannot be read or holds no lens that can be used.
    """
    where = str(path)
    data = read_yaml(where, absent)
    if not isinstance(data, Mapping):
        raise InputError(where, "", f"is no camera_info: must be a mapping, not {shown(data)}")
    matrix = _numbers(where, data, "camera_matrix", "K", "k")
    if len(matrix) != 9 or matrix[8] != 1 or any(matrix[i] for i in (3, 6, 7)):
        raise InputError(
            where, "camera_matrix", "must be [fx, 0, cx, 0, fy, cy, 0, 0, 1], 9 numbers in px"
        )
    if matrix[1]:
        reason = f"must have no skew, a second number of 0, not {shown(matrix[1])}"
        raise InputError(where, "camera_matrix", reason)
    model, coefficients = _distortion(where, data)
    return {
        "width": _one(where, data, "image_width", "width"),
        "height": _one(where, data, "image_height", "height"),
        **dict(zip(("fx", "cx", "fy", "cy"), (matrix[i] for i in (0, 2, 4, 5)), strict=True)),
        "distortion_model": model,
        "distortion": coefficients,
    }


def _distortion(where: str, data: Mapping[str, Any]) -> tuple[str, list[Any]]:
    named = data.get("distortion_model", "")
    numbers = _numbers(where, data, "distortion_coefficients", "D", "d", instead=[])
    models = _MODELS if any(numbers) else _MODELS | _OTHERS
    if not isinstance(named, str) or named not in models:
        known = "must be plumb_bob or equidistant (fisheye)"
        raise InputError(where, "distortion_model", f"{known}, not {shown(named)}")
    return models[named], numbers if any(numbers) else []


def _named(where: str, data: Mapping[str, Any], *names: str) -> Any:
    for name in names:
        if name in data:
            return data[name]
    raise InputError(where, names[0], "is missing; a camera_info has it")


def _one(where: str, data: Mapping[str, Any], *names: str) -> Any:
    held = _named(where, data, *names)
    value = exact(held)
    if value is None:
        raise InputError(where, names[0], f"must be a number in px, not {shown(held)}")
    return value


def _numbers(
    where: str, data: Mapping[str, Any], *names: str, instead: list[Any] | None = None
) -> list[Any]:
    if instead is not None and not any(name in data for name in names):
        return instead
    held = _named(where, data, *names)
    held = held.get("data") if isinstance(held, Mapping) else held
    numbers = list(map(exact, held)) if isinstance(held, list) else [None]
    if None in numbers:
        raise InputError(where, names[0], f"must hold a list of numbers, not {shown(held)}")
    return numbers
