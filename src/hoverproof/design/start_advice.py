"""What would help where no gains hold a start: changes of the mission, each tried and proved.

A change has a size, a part from 0 (none) to 1. The search that looks for gains tells whether some
hold the start (`StartSearch.held`); the least part for which it does is found by bisection, and for
the mission with that change gains are searched and proved as for any other. Only then is it told
of: who follows it gets the gains that were proved.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from pydantic import ValidationError

from hoverproof.algebra.decimals import decimal_above, decimal_below
from hoverproof.certification.exponential.sooner import OUTSIDE
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.design.outcome import Advice
from hoverproof.design.start_search import Point, StartSearch
from hoverproof.errors import InputError
from hoverproof.mission.reading import with_tolerance
from hoverproof.mission.sections import Mission
from hoverproof.mission.uncertainty import TOLERANCES
from hoverproof.plant.goal import hover_goal

Progress = Callable[[str], None]
MOST = 3
"""So many changes are told of."""
SCALED: tuple[str, tuple[str, ...]] = "the scaled feature", ("law.feature=scaled",)
HALVINGS = 4
NEAREST, LARGEST, WIDEST = 0.05, 8.0, Fraction("1.4")
"""The nearest start, as a share of its way; the largest target, in times; the widest lens, rad."""


@dataclass(frozen=True)
class Change:
    """A change of a mission.

    Attributes
    ----------
    to : callable
        A part from 0 to 1 ↦ the mission so changed, and the change in words; None if there is none.
    key : str
        What it changes, as ``--set`` names it.
    shown : callable
        Mission ↦ the value, as ``--set`` has it.
    """

    to: Callable[[float], tuple[Mission, str] | None]
    key: str
    shown: Callable[[Mission], str]

    def settings(self, mission: Mission) -> tuple[str, ...]:
        """Return it as values of ``--set``.

        Parameters
        ----------
        mission : Mission
        """
        return (f"{self.key}={self.shown(mission)}",)


def what_helps(
    mission: Mission,
    point: Point | None,
    search: Callable[[Mission], StartSearch],
    proved: Callable[[Mission, Progress], Exponential | None],
    tell: Progress,
) -> tuple[Advice, ...]:
    """Return changes with which gains are proved.

    Parameters
    ----------
    mission : Mission
    point : Point or None
        What comes nearest without any.
    search, proved : callable
        Mission ↦ its search; and, told what is being done, what is proved of gains found for it.
    tell : callable
        Is told what is being done.
    """
    other = scaled(mission)
    if other is not None:
        found = proved(other, _within(tell, "what would help: the scaled feature"))
        if found is not None:
            return (Advice(SCALED[0], SCALED[1], found.settling.time),)
        mission, point = other, None
    words, first = ("", ()) if other is None else (f"{SCALED[0]} and ", SCALED[1])
    found_each: list[Advice] = []
    changes = list(_changes(mission, point, search))
    for k, change in enumerate(changes, 1):
        if len(found_each) == MOST:
            break
        doing = _within(tell, f"what would help, {k} of {len(changes)}: {change.key}")
        size = _least(change, search, doing)
        for part in () if size is None else (size, (size + 1) / 2):
            made = change.to(part)
            tuned = None if made is None else proved(made[0], doing)
            if made is not None and tuned is not None:
                settings = (*first, *change.settings(made[0]))
                time = tuned.settling.time
                found_each.append(Advice(words + made[1], settings, time))
                break
    return tuple(found_each)


def scaled(mission: Mission) -> Mission | None:
    """Return a mission with the scaled feature; None if it has it.

    Parameters
    ----------
    mission : Mission
    """
    if mission.law.feature == "scaled":
        return None
    return mission.model_copy(update={"law": mission.law.model_copy(update={"feature": "scaled"})})


def _within(tell: Progress, title: str) -> Progress:
    """Tell what is being done as a part of something."""
    return lambda text: tell(f"{title}: {text}")


def _least(
    change: Change, search: Callable[[Mission], StartSearch], tell: Progress
) -> float | None:
    """Return about the least part of a change with which a start is held; None if none is found."""
    tried = 0

    def held(part: float, near: np.ndarray | None) -> np.ndarray | None:
        nonlocal tried
        tried += 1
        tell(f"{tried} of at most {2 + HALVINGS} sizes")
        made = change.to(part)
        if made is None:
            return None
        try:
            return search(made[0]).held(near)
        except InputError:
            return None

    low, high, at = 0.0, 1.0, None
    for high in (1.0, 0.5):
        if (at := held(high, None)) is not None:
            break
    if at is None:
        return None
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        found = held(middle, at)
        if found is None:
            low = middle
        else:
            high, at = middle, found
    return high


def _changes(
    mission: Mission, point: Point | None, search: Callable[[Mission], StartSearch]
) -> Iterator[Change]:
    """Yield changes that may help, the likeliest first."""
    half = mission.camera.half_angle
    if half is not None and half < WIDEST:
        yield _wider(mission)
    yield _nearer(mission)
    tolerance = _heaviest(mission, point, search)
    if tolerance is not None:
        yield _smaller(mission, tolerance)
    if mission.goal.height is not None:
        yield _larger(mission)


def _heaviest(
    mission: Mission, point: Point | None, search: Callable[[Mission], StartSearch]
) -> str | None:
    """Return the tolerance without which what comes nearest would come nearest."""
    names = [name for name in TOLERANCES if getattr(mission.uncertainty, name)]
    if point is None or point.cost < OUTSIDE or not names:
        return names[0] if names else None

    def merit(name: str) -> float:
        at = search(with_tolerance(mission, name, Fraction(0))).value(point.z)
        return np.inf if at is None else at.merit

    return min(names, key=merit)


def _nearer(mission: Mission) -> Change:
    goal = [Fraction(c) for c in hover_goal(mission).position]
    start = mission.start.position
    way = float(np.linalg.norm([float(a - b) for a, b in zip(start, goal, strict=True)]))

    def to(part: float) -> tuple[Mission, str]:
        left = Fraction(1 - (1 - NEAREST) * part).limit_denominator(1000)
        digits = max(1e-6, 10.0 ** np.floor(np.log10(way) - 2))
        unit = Fraction(str(digits))
        place = tuple(
            round((g + left * (s - g)) / unit) * unit for s, g in zip(start, goal, strict=True)
        )
        moved = mission.start.model_copy(update={"position": place})
        far = np.linalg.norm([float(a - b) for a, b in zip(place, start, strict=True)])
        words = f"a start {far:.2g} m nearer to the goal"
        return mission.model_copy(update={"start": moved}), words

    return Change(to, "start.position", lambda m: _row(m.start.position))


def _larger(mission: Mission) -> Change:
    points = mission.target.points
    middle = [sum(axis, Fraction(0)) / len(points) for axis in zip(*points, strict=True)]

    def to(part: float) -> tuple[Mission, str] | None:
        times = decimal_above(LARGEST**part, 2)
        new = [tuple(m + times * (c - m) for c, m in zip(p, middle, strict=True)) for p in points]
        target = mission.target.model_copy(update={"points": new})
        size = max(float(max(axis) - min(axis)) for axis in zip(*new, strict=True))
        words = f"a target of {size:.3g} m, {float(times):g} times as large"
        try:
            return Mission(**(dict(mission) | {"target": target})), words
        except ValidationError:
            return None

    return Change(to, "target.points", lambda m: f"[{', '.join(map(_row, m.target.points))}]")


def _smaller(mission: Mission, name: str) -> Change:
    most = getattr(mission.uncertainty, name)

    def to(part: float) -> tuple[Mission, str]:
        value = decimal_below(float(most) * (1 - part), 2) if part < 1 else Fraction(0)
        return with_tolerance(mission, name, value), _less(name, most, value)

    return Change(to, f"uncertainty.{name}", lambda m: f"{float(getattr(m.uncertainty, name)):g}")


def _less(name: str, most: Fraction, value: Fraction) -> str:
    less = float(most - value)
    if name in ("latency", "rotor_lag"):
        return f"{1e3 * less:.3g} ms less {name.replace('_', ' ')}, {1e3 * float(value):.3g} ms"
    return (
        f"a tolerance of {name.replace('_', ' ')} of {float(value):g} in place of {float(most):g}"
    )


def _wider(mission: Mission) -> Change:
    half = mission.camera.half_angle
    assert half is not None

    def to(part: float) -> tuple[Mission, str]:
        value = decimal_above(float(half + Fraction(part) * (WIDEST - half)), 3)
        camera = mission.camera.model_copy(update={"half_angle": value})
        degrees = 2 * np.degrees(float(value))
        words = f"a lens that sees {degrees:.3g}°, {float(value):g} rad to each side"
        return mission.model_copy(update={"camera": camera}), words

    return Change(to, "camera.half_angle", lambda m: f"{float(m.camera.half_angle or 0):g}")


def _row(values: tuple[Fraction, ...]) -> str:
    return json.dumps([float(c) for c in values])
