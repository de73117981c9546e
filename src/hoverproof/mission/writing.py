"""Mission files: write a mission back, with the comments of the file it came from."""

from __future__ import annotations

import tomllib
from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text, presets
from hoverproof.mission.sections import Mission


def mission_text(mission: Mission, *, name: str | None = None, note: str = "") -> str:
    """Return a mission as TOML, in the words of its source as far as they still hold.

    Values that changed are put in place, comments stay; a mission without a source is written
    plainly.

    Parameters
    ----------
    mission : Mission
    name : str, optional
        A new name.
    note : str
        Comment lines for the top of the file, without their ``#``.

    Raises
    ------
    InputError
        If a number of the mission is no decimal.
    """
    wanted = mission.exact(as_written=True) | ({"name": name} if name else {})
    head = "".join(f"# {line}\n" for line in note.splitlines())
    edited = _written(_source_text(mission), wanted)
    if _read(edited) == wanted:
        return head + edited
    turned = mission.uncertainty.latency and mission.sensors.gyro_turned
    return head + _written("", wanted) + ("\n[sensors]\ngyro_turned = true\n" if turned else "")


def _source_text(mission: Mission) -> str:
    if mission.source in presets():
        return preset_text(mission.source)
    try:
        return Path(mission.source).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""


def _written(text: str, wanted: dict[str, Any]) -> str:
    """Replace, one by one, the values of a text that differ from those that are wanted."""
    import tomlkit

    try:
        document = tomlkit.parse(text)
    except (ValueError, RecursionError):
        document = tomlkit.document()
    held = _read(text) or {}
    if held.get("name") != wanted["name"]:
        document["name"] = wanted["name"]
    for section, entries in wanted.items():
        if isinstance(entries, dict):
            entries = {k: v for k, v in entries.items() if k != "gyro_turned"}  # of [sensors]
            if not isinstance(document.get(section), dict):
                document[section] = tomlkit.table()
            table: Any = document[section]
            for key in table.keys() - entries.keys():
                del table[key]
            for key, value in entries.items():
                if held.get(section, {}).get(key) != value:
                    _put(table, key, tomlkit.value(_value(value)))
    return tomlkit.dumps(document)


def _put(table: Any, key: str, value: Any) -> None:
    """Set a value; a comment behind it stays where it is, if there is room."""
    room = len(table[key].as_string() + table[key].trivia.comment_ws) if key in table else 0
    table[key] = value
    trivia = table[key].trivia
    if trivia.comment:
        trivia.comment_ws = " " * max(room - len(value.as_string()), 2)


def _read(text: str) -> dict[str, Any] | None:
    """Return the exact mission of a text; None if it is none."""
    try:
        return Mission(**tomllib.loads(text, parse_float=Fraction)).exact(as_written=True)
    except (ValueError, TypeError):
        return None


def _value(value: Any) -> str:
    """Write exact strings, in any nesting, as decimals; a word stays a word."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {_value(entry)}' for key, entry in value.items())}}}"
    return f'"{value}"' if value.replace("_", "").isalpha() else decimal(Fraction(value))


def decimal(value: Fraction) -> str:
    """Write a number as an exact decimal.

    Parameters
    ----------
    value : Fraction
        A bare number, in any unit.

    Raises
    ------
    InputError
        If it has none, as 1/3.
    """
    places, scaled = 0, value
    while scaled.denominator != 1 and places < 60:
        places, scaled = places + 1, scaled * 10
    if scaled.denominator != 1:
        raise InputError("mission", "", f"{value} is no decimal, so it cannot be written to a file")
    digits = str(abs(scaled.numerator)).rjust(places + 1, "0")
    sign = "-" if value < 0 else ""
    return sign + (digits if not places else f"{digits[:-places]}.{digits[-places:]}")
