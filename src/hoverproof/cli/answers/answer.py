"""How a command answers: lines for people, or one JSON object for machines, and an exit status."""

from __future__ import annotations

import json
import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission

EXIT = {"proved": 0, "refuted": 1, "undecided": 3}


class Answer(ABC):
    """What a command has to say."""

    @property
    def status(self) -> int:
        """The exit status."""
        return 0

    @abstractmethod
    def text(self) -> Iterator[str]:
        """Yield the lines for people."""

    @abstractmethod
    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""


def tell(answer: Answer, json_: bool, mission: Mission | None = None) -> int:
    """Print an answer about a mission, with its law, and return its status.

    No answer considers what `[uncertainty]` and `[camera]` ask to be covered, and each says so.
    """
    if json_:
        print_json(answer.as_json(), mission)
    else:
        for number, line in enumerate(answer.text()):
            print(line)
            if number == 0 and mission is not None:
                if not mission.law.is_papers:
                    print(f"  law                     {mission.law.name}")
                if mission.asks_to_cover():
                    print(f"  not considered          {', '.join(mission.asks_to_cover())}")
    return answer.status


def print_json(value: dict[str, Any], mission: Mission | None = None) -> None:
    """Print one JSON object, with the law of the mission that it tells of, and warnings."""
    if mission is not None:
        from hoverproof.plausibility import warnings

        found = [str(finding) for finding in warnings(mission)]
        found += [f"not considered: {words}" for words in mission.asks_to_cover()]
        law = mission.law.model_dump()
        value = {**value, "law": law, "warnings": [*found, *value.get("warnings", [])]}
    plain = "utf" not in (sys.stdout.encoding or "utf").lower()
    print(json.dumps(value, indent=2, ensure_ascii=plain, allow_nan=False))
