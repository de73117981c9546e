"""How a command answers: lines for people, or one JSON object for machines, and an exit status."""

from __future__ import annotations

import json
import re
import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from hoverproof.cli.answers.glossary import legend
from hoverproof.cli.answers.words import wrapped

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission

EXIT = {"proved": 0, "refuted": 1, "undecided": 3}


class Answer(ABC):
    """What a command has to say; its symbols are explained at the foot, if not told otherwise."""

    explained: ClassVar[bool] = True
    within: ClassVar[str] = ""
    """The label of tolerances that are kept, of which nobody is to be warned."""

    @property
    def status(self) -> int:
        """The exit status."""
        return 0

    @property
    def considered(self) -> list[str]:
        """What it considers of what `[uncertainty]` and `[camera]` ask to be covered, in words."""
        return []

    def about_tolerances(self, left: list[str]) -> dict[str, list[str]]:
        """Return what to say, by label, of the tolerances that it does not consider."""
        return {"not considered": left}

    @abstractmethod
    def text(self) -> Iterator[str]:
        """Yield the lines for people."""

    @abstractmethod
    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""


def tell(answer: Answer, json_: bool, mission: Mission | None = None) -> int:
    """Print an answer about a mission, with its law, and return its status.

    What `[uncertainty]` and `[camera]` ask to be covered and it does not consider, it says.
    """
    asked = [] if mission is None else mission.asks_to_cover()
    said = answer.about_tolerances([words for words in asked if words not in answer.considered])
    if json_:
        warned = [(label, words) for label, each in said.items() for words in each]
        told = [f"{label}: {words}" for label, words in warned if label != answer.within]
        print_json(answer.as_json(), mission, told)
    else:
        first, *rest = answer.text()
        print(first)
        if mission is not None and not mission.law.is_papers:
            print(f"  law                     {mission.law.name} (feature/goal/force)")
        for label, each in said.items():
            for line in wrapped(label, ", ".join(each)):
                print(line)
        foot = next((n for n, line in enumerate(rest) if line.startswith("Next:")), len(rest))
        explained = legend([first, *rest]) if answer.explained else []
        for line in (*rest[:foot], *explained, *_settings_in(rest), *rest[foot:]):
            print(line)
    return answer.status


def _settings_in(lines: list[str]) -> Iterator[str]:
    """Explain names of files that `default_stem` makes of a mission with --set."""
    if found := re.search(r"\.[0-9a-f]{8}(?=\.[\w.]+$)", "\n".join(lines), re.MULTILINE):
        yield f"  {found[0][1:]} in names of files stands for the settings made by --set"


def print_json(
    value: dict[str, Any], mission: Mission | None = None, left: Sequence[str] | None = None
) -> None:
    """Print one JSON object, with the law of the mission, and warnings, of what is left out too."""
    if mission is not None:
        if left is None:
            left = [f"not considered: {words}" for words in mission.asks_to_cover()]
        from hoverproof.plausibility import warnings

        found = [str(finding) for finding in warnings(mission)]
        found += left
        law = mission.law.model_dump()
        value = {**value, "law": law, "warnings": [*found, *value.get("warnings", [])]}
    print(_dumped(value, indent=2))


def print_line(value: dict[str, Any]) -> None:
    """Print one JSON object in a line, at once: of a command that goes on."""
    print(_dumped(value, indent=None), flush=True)


def _dumped(value: dict[str, Any], indent: int | None) -> str:
    plain = "utf" not in (sys.stdout.encoding or "utf").lower()
    return json.dumps(value, indent=indent, ensure_ascii=plain, allow_nan=False)
