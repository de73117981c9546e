"""Verdicts that several tests ask for, reached once in a run. Not a test itself."""

from __future__ import annotations

from typing import Any

from hoverproof.certification import convergence
from hoverproof.mission.sections import Mission
from sharing import kept_value


def attraction_once(mission: Mission, **options: Any) -> convergence.Converges:
    """Return `attraction(mission, **options)`."""
    key = ("attraction", mission.name, mission.exact(), options)
    return kept_value(key, lambda: _attraction(mission, **options))


def start_or_ball_once(mission: Mission) -> Any:
    """Return `start_or_ball(mission)`."""
    key = ("start or ball", mission.name, mission.exact())
    return kept_value(key, lambda: _start_or_ball(mission))


_attraction, _start_or_ball = convergence.attraction, convergence.start_or_ball
