"""The missions that come with the package."""

from __future__ import annotations

import re
from importlib import resources

from hoverproof.errors import InputError, suggestion


def presets() -> list[str]:
    """Return the names of the missions that come with the package."""
    folder = resources.files("hoverproof") / "presets"
    return sorted(
        p.name.removesuffix(".toml") for p in folder.iterdir() if p.name.endswith(".toml")
    )


def preset_text(name: str) -> str:
    """Return the TOML text of a preset.

    Parameters
    ----------
    name : str
        One of `presets`.

    Raises
    ------
    InputError
        If there is no such preset.
    """
    if name not in presets():
        raise InputError(name, "", f"no such preset ({suggestion(name, presets(), 'there are')})")
    return (resources.files("hoverproof") / "presets" / f"{name}.toml").read_text(encoding="utf-8")


def conditions_text() -> str:
    """Return a TOML text, all comments, with the keys of law, sensors, rotors, interface, ..."""
    return (resources.files("hoverproof") / "conditions.toml").read_text(encoding="utf-8")


def with_conditions(text: str) -> str:
    """Return a mission file with all that it does not say of law, sensors, rotors and so on.

    That is comments: the keys of a section that is there at its end, all others after the rest.

    Parameters
    ----------
    text : str
        TOML.
    """
    for part in conditions_text().strip().split("\n\n"):
        section = re.search(r"(?m)^# \[(\w+)\].*\n", part)
        there = section and re.search(rf"(?ms)^\[{section[1]}\].*?(?=\n\n|\n*\Z)", text)
        if not section or not there:
            text = f"{text.rstrip()}\n\n{part}\n"
            continue
        said = re.findall(r"(?m)^(?:# )?(\w+) =", there[0])
        keys = part[section.end() :].splitlines()
        more = [line for line in keys if line[2:].split(" =")[0] not in said]
        text = "\n".join([text[: there.end()], *more]) + text[there.end() :]
    return text
