"""Mission files: write a mission back, with the comments of the file it came from."""

from __future__ import annotations

import re
import tomllib
from fractions import Fraction
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.mission.presets import preset_text, presets
from hoverproof.mission.sections import Mission


def mission_text(mission: Mission, *, name: str | None = None, note: str = "") -> str:
    """Return a mission as TOML, in the words of its source as far as they still hold.

    Values that changed are put in place, comments stay; where the source has another layout (as
    with inline tables), the mission is written plainly.

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
    wanted = mission.exact() | ({"name": name} if name else {})
    text = _source_text(mission)
    edited = None if text is None else _edited(text, wanted)
    head = "".join(f"# {line}\n" for line in note.splitlines())
    return head + (_plain(wanted) if edited is None else edited)


def _source_text(mission: Mission) -> str | None:
    if mission.source in presets():
        return preset_text(mission.source)
    try:
        return Path(mission.source).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return None


def _edited(text: str, wanted: dict[str, Any]) -> str | None:
    """Replace, one by one, the values that differ; None if the result does not read as wanted."""
    held = _read(text)
    if held is None:
        return None
    text = re.sub(r"(?m)^name(\s*)=.*$", rf'name\1= "{wanted["name"]}"', text, count=1)
    for section, entries in wanted.items():
        if isinstance(entries, dict):
            old = held.get(section, {})
            for key in old.keys() - entries.keys():
                text = _replaced(text, section, key, None)
            for key, value in entries.items():
                if old.get(key) != value:
                    text = _replaced(text, section, key, _value(value))
    return text if _read(text) == wanted else None


def _replaced(text: str, section: str, key: str, value: str | None) -> str:
    """Put a value in its place in a section, add it at the section's end, or take it out."""
    lines = text.splitlines(keepends=True)
    here, last = False, None
    for i, line in enumerate(lines):
        header = re.match(r"\s*\[\s*([\w.-]+)\s*\]", line)
        if header:
            here = header[1] == section
            last = i if here else last
        elif here and line.strip():
            last = i
            entry = re.match(rf"(\s*{re.escape(key)}\s*=\s*)([^#\n]*?)(\s*)(#.*)?$", line)
            if entry and value is None:
                lines[i] = ""
                return "".join(lines)
            if entry:
                room = " " * max(len(entry[2] + entry[3]) - len(str(value)), 2) if entry[4] else ""
                lines[i] = f"{entry[1]}{value}{room}{entry[4] or ''}\n"
                return "".join(lines)
    if last is not None and value is not None:
        lines[last] = lines[last].rstrip("\n") + f"\n{key} = {value}\n"
    return "".join(lines)


def _read(text: str) -> dict[str, Any] | None:
    """Return the exact mission of a text; None if it is none."""
    try:
        return Mission(**tomllib.loads(text, parse_float=Fraction)).exact()
    except (ValueError, TypeError):
        return None


def _plain(wanted: dict[str, Any]) -> str:
    sections = [f'name = "{wanted["name"]}"\n']
    for section, entries in wanted.items():
        if isinstance(entries, dict):
            lines = [f"{key} = {_value(value)}\n" for key, value in entries.items()]
            sections.append(f"[{section}]\n{''.join(lines)}")
    return "\n".join(sections)


def _value(value: Any) -> str:
    """Write exact strings, in any nesting, as decimals."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return decimal(Fraction(value))


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
