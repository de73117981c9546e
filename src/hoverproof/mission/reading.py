"""Read a mission: TOML with exact decimals, checked, and refused in our own words."""

from __future__ import annotations

import contextlib
import functools
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, TypeVar, get_args

from pydantic import ValidationError

from hoverproof.errors import InputError, suggestion
from hoverproof.mission.arguments import taken
from hoverproof.mission.camera import Lens
from hoverproof.mission.camera_info import lens_of_file
from hoverproof.mission.exact import exact
from hoverproof.mission.fields import Section, shown
from hoverproof.mission.presets import preset_text, presets
from hoverproof.mission.sections import Mission
from hoverproof.mission.target import MAX_POINTS
from hoverproof.mission.task import TAGS

MAX_FILE_BYTES = 1_000_000
MAX_PARTS = 64
_P = ParamSpec("_P")
_R = TypeVar("_R")
_DOTTED = re.compile(r"""\.[ \t]*["'A-Za-z_-]|\.\d+[ \t]*(?=\.)""")  # a dot in a key


def load(source: str | Path, overrides: Mapping[str, object] | None = None) -> Mission:
    """Read a mission.

    Parameters
    ----------
    source : str or Path
        Name of a preset, or path of a TOML file.
    overrides : mapping, optional
        Values to put in place of those in the file, by dotted key: ``{"gains.k4": 0.1}``.
        Strings are read as TOML; a float is taken for the shortest decimal that is read as it.

    Returns
    -------
    Mission

    Raises
    ------
    InputError
        If the file cannot be read or anything in it cannot be used; the message names the file,
        the key and what would be right.
    TypeError
        If `source` is neither, or `overrides` no mapping.
    """
    if not isinstance(source, str | Path):
        raise TypeError(
            f"a mission is the name of a preset or the path of a file, not {type(source).__name__}"
        )
    text, where = _read(source)
    data = _parse(text, where)
    if "source" in data:  # a field of Mission, but no key of a file
        raise InputError(where, "source", f"unknown key ({_key_hint((), 'source')})")
    return _with_changes(data, {} if overrides is None else overrides, where)


def of_mission(
    verb: Callable[Concatenate[Mission, _P], _R],
) -> Callable[Concatenate[Mission | str | Path, _P], _R]:
    """Let what is done with a mission be asked for by its preset or file as well.

    Parameters
    ----------
    verb : callable
        What takes a mission first.
    """

    @functools.wraps(verb)
    def of(mission: Mission | str | Path, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        read = mission if isinstance(mission, Mission) else load(mission)
        bound = taken(verb, (read, *args), kwargs)
        return verb(*bound.args, **bound.kwargs)

    return of  # type: ignore[return-value]  # the mission may be given by keyword as well


@of_mission
def replace(mission: Mission, changes: Mapping[str, object]) -> Mission:
    """Return a mission with other values.

    Parameters
    ----------
    mission : Mission, str or Path
    changes : mapping
        By dotted key, as the `overrides` of `load`: ``{"gains.k4": 0.1}``.

    Raises
    ------
    InputError
        If there is no such key, or a mission cannot have the value.
    """
    data = _given(mission)
    del data["source"]
    return _with_changes(data, changes, mission.source)


def load_lens(path: str | Path) -> Lens:
    """Read the lens of a `camera_info` file.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    InputError
        If it cannot be read or holds no lens that can be used.
    """
    try:
        return Lens(**lens_of_file(path, "no such file"))
    except ValidationError as error:
        raise _input_error(error, str(path)) from None


def with_tolerance(mission: Mission, name: str, value: Fraction) -> Mission:
    """Return a mission with another value in `[uncertainty]`.

    Parameters
    ----------
    mission : Mission
    name : str
        Such as ``"latency"``, or ``"noise.rate"``.
    value : Fraction
        In its unit, as in a mission file; a share is dimensionless.

    Raises
    ------
    InputError
        If a mission cannot have it.
    """
    section, (group, _, key) = dict(mission.uncertainty), name.partition(".")
    section[group] = dict(section[group]) | {key: value} if key else value
    try:
        return Mission(**(dict(mission) | {"uncertainty": section}))
    except ValidationError as error:
        raise _input_error(error, mission.source) from None


def _given(section: Section) -> dict[str, Any]:
    """Return what a section was made of, as if read from a file."""
    values = {key: getattr(section, key) for key in section.model_fields_set}
    return {k: _given(v) if isinstance(v, Section) else v for k, v in values.items()}


def _with_changes(data: dict[str, Any], changes: Mapping[str, object], where: str) -> Mission:
    if not isinstance(changes, Mapping) or not all(isinstance(key, str) for key in changes):
        raise TypeError('values are given by dotted key, as in {"gains.k4": 0.1}')
    for key, value in changes.items():
        _override(data, key, value)
    _read_lens(data, where)
    try:
        return Mission(**data, source=where)
    except ValidationError as error:
        raise _input_error(error, where) from None


def _read(source: str | Path) -> tuple[str, str]:
    path, where = Path(source), str(source)
    if isinstance(source, str) and source in presets():
        return preset_text(source), where
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)  # it may be a device without end
        if len(data) > MAX_FILE_BYTES:
            raise InputError(where, "", f"is larger than {MAX_FILE_BYTES} bytes")
        return data.decode("utf-8"), where
    except FileNotFoundError:
        near = [*presets(), *map(str, path.parent.glob("*.toml"))]
        hint = suggestion(where, near, "presets", shown=presets())
        raise InputError(where, "", f"no such mission file or preset ({hint})") from None
    except UnicodeDecodeError:
        raise InputError(where, "", "is not a text file in UTF-8") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(where, "", f"cannot be read: {reason}") from None


def _parse(text: str, where: str) -> dict[str, Any]:
    for count, line in enumerate(text.splitlines(), 1):  # reading takes the square of their number
        if len(_DOTTED.findall(line)) > MAX_PARTS:
            raise InputError(where, "", f"line {count} has a key of more than {MAX_PARTS} parts")
    try:
        return tomllib.loads(text, parse_float=_exact_decimal)
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, "", f"is not valid TOML: {error}") from None
    except (ValueError, RecursionError):  # as for an integer of thousands of digits
        raise InputError(
            where, "", "is not a mission: nested too deep, or a number of too many digits"
        ) from None


def _exact_decimal(text: str) -> Fraction | float:
    """Read a TOML float exactly; what is too large for any reason stays a float, refused later."""
    exponent = re.search(r"[eE]([+-]?[0-9_]+)$", text)
    if len(text) > 400:
        raise ValueError("a number of so many digits")
    if exponent and int(exponent[1]) > 400:
        return float(text.replace("_", ""))
    if exponent and int(exponent[1]) < -400:
        raise ValueError("a number so near to zero")
    if text.lstrip("+-") in ("inf", "nan"):
        return float(text)
    return Fraction(text.replace("_", ""))


def _read_lens(data: dict[str, Any], where: str) -> None:
    """Put the lens of the file that `camera.file` names in its place."""
    section = data.get("camera")
    if not isinstance(section, dict) or "file" not in section:
        return
    file = section.pop("file")
    if not isinstance(file, str) or not file:
        raise InputError(where, "camera.file", f"must be the path of a file, not {shown(file)}")
    if "lens" in section:
        raise InputError(where, "camera.file", "give either the file or camera.lens, one of them")
    folder = Path() if where in presets() else Path(where).parent
    section["lens"] = lens_of_file(folder / file)


def _override(data: dict[str, Any], key: str, value: object) -> None:
    option = f"--set {key}"
    if isinstance(value, str):
        try:
            value = _parse(f"value = {value}", option)["value"]
        except InputError:
            if not re.fullmatch(r"[./]*[A-Za-z][\w./-]*", str(value)):  # a word or path
                reason = f"{shown(value)} is not a TOML value{_as_toml(str(value))}"
                raise InputError(option, "", reason) from None
    else:
        value = _exact_value(value)
    *path, last = key.split(".")
    for depth, part in enumerate([*path, last]):
        known = _known_keys(path[:depth])
        if known and part not in known:
            raise InputError(option, "", f"unknown key ({_key_hint(path[:depth], part)})")
    for part in path:
        data = data.setdefault(part, {})
        if not isinstance(data, dict):
            raise InputError(option, "", f"{part!r} is not a section")
    data[last] = value


def _as_toml(text: str) -> str:
    """Say how a list or a share is written that was not given as TOML; nothing if it is neither."""
    parts = re.split(r"[\s,;]+", text.strip(" ()"))
    with contextlib.suppress(ValueError, ArithmeticError):
        if text.endswith("%"):
            return f"; a share is written {float(Decimal(text[:-1].strip()) / 100):g}"
        if len(parts) > 1 and all(Decimal(part).is_finite() for part in parts):
            return f"; a list is written [{', '.join(parts)}]"
    return ""


def _exact_value(value: object) -> object:
    """Take a float for the shortest decimal that is read as it, also inside a list."""
    if isinstance(value, str | bool | int | Fraction):
        return value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {key: _exact_value(entry) for key, entry in value.items()}
    if hasattr(value, "tolist"):  # an array of numpy or a number of its
        return _exact_value(value.tolist())
    if isinstance(value, float | Decimal):
        with contextlib.suppress(ValueError):
            return exact(value)
        return value
    return [_exact_value(entry) for entry in value] if isinstance(value, Sequence) else value


def _input_error(error: ValidationError, where: str) -> InputError:
    """Turn the most telling finding of pydantic into our own words."""
    problems = sorted(error.errors(), key=lambda p: p["type"] != "extra_forbidden")
    first = problems[0]
    held = [part for part in first["loc"] if part not in TAGS]
    location = [*held, *first.get("ctx", {}).get("key", "").split(".")]
    key = "".join(f"[{p + 1}]" if isinstance(p, int) else f".{p}" for p in location if p != "")
    kind, given = first["type"], shown(first["input"])
    short_name = f"must be a short name of letters, digits, '.', '_' and '-', not {given}"
    wording = {
        "missing": "is missing",
        "model_type": f"must be a section, not {given}",
        "too_short": f"must hold at least 2 points, not {given}",
        "too_long": f"must hold at most {MAX_POINTS} points, not {given}",
        "list_type": f"must be a list of points [x, y, z], not {given}",
        "string_type": short_name,
        "string_pattern_mismatch": short_name,
    }
    message = wording.get(kind, first["msg"])
    if kind == "extra_forbidden":
        message = f"unknown key ({_key_hint(first['loc'][:-1], str(first['loc'][-1]))})"
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return InputError(where, key.removeprefix("."), message + more)


def _known_keys(path: Sequence[int | str]) -> list[str]:
    """Return the keys of a section; none if the path leads to no section."""
    section: Any = Mission
    for part in path:
        field = getattr(section, "model_fields", {}).get(part)
        kinds = () if field is None else (field.annotation, *get_args(field.annotation))
        section = next((kind for kind in kinds if hasattr(kind, "model_fields")), None)
    return [key for key in getattr(section, "model_fields", ()) if key != "source"]


def _key_hint(path: Sequence[int | str], key: str) -> str:
    """Suggest the nearest key of a section, or the same key where it belongs."""
    elsewhere = [f"{s}.{key}" for s in _known_keys(()) if key in _known_keys([s])]
    return suggestion((elsewhere or [key])[0], elsewhere or _known_keys(path), "known here")
