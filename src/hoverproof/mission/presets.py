"""The missions that come with the package."""

from __future__ import annotations

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
    """Return a TOML text, all comments, with the keys of law, sensors, rotors, wind and scatter."""
    return (resources.files("hoverproof") / "conditions.toml").read_text(encoding="utf-8")
