"""What the Tab key offers where an argument is a mission or one of its values."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cyclopts.completion import CompletionContext

MOST = 200


def mission_names(context: CompletionContext) -> list[tuple[str, str]]:
    """Offer the presets, and the mission files in the folder typed so far and one below it."""
    from hoverproof.mission.presets import presets

    typed = context.incomplete
    folder = typed[: typed.rfind("/") + 1]
    files = (p for depth in ("*.toml", "*/*.toml") for p in Path(folder or ".").glob(depth))
    here = [folder + p.relative_to(folder or ".").as_posix() for p in itertools.islice(files, MOST)]
    named = [] if folder else [(name, "preset") for name in presets()]
    return named + [(path, "mission file") for path in sorted(here)]


def preset_names(context: CompletionContext) -> list[str]:
    """Offer the presets."""
    from hoverproof.mission.presets import presets

    return presets()


def settings(context: CompletionContext) -> list[str]:
    """Offer each number of the mission typed so far as KEY=VALUE, to be changed."""
    import tomllib

    from hoverproof.mission.presets import preset_text, presets

    mission = context.get("mission")
    source = (mission and mission.raw) or presets()[0]
    text = preset_text(source) if source in presets() else Path(source).read_text(encoding="utf-8")
    return list(_numbers(tomllib.loads(text, parse_float=str), ""))


def _numbers(section: dict[str, Any], prefix: str) -> Iterator[str]:
    for key, value in section.items():
        if isinstance(value, dict):
            yield from _numbers(value, f"{prefix}{key}.")
        elif prefix and not isinstance(value, list):
            yield f"{prefix}{key}={value}"
