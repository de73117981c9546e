"""What the answers share: how numbers, boxes, gains and limits are written."""

from __future__ import annotations

import shlex
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from hoverproof.algebra.decimals import at_least, at_most, written

if TYPE_CHECKING:
    from pathlib import Path

    from hoverproof.certification.problem import GainProblem
    from hoverproof.design.limits import Use
    from hoverproof.mission.sections import Mission
    from hoverproof.servo.hover_error import HoverError


def number(value: Any) -> str:
    """Write a number that a mission gives, with six digits."""
    return written(float(value), 6)


def whole(value: Any) -> str:
    """Write what a proof is about as it was given, or found in few digits, with all of them."""
    return written(float(value), 12)


def about(value: Any) -> str:
    """Write a number that is found or simulated, with three digits."""
    return written(float(value), 3)


def numbers(values: Iterable[Any]) -> list[float]:
    """Return numbers as JSON has them."""
    return [float(x) for x in values]


def wrapped(name: str, words: str) -> Iterator[str]:
    """Yield a name, and beside it words in lines that fit."""
    for k, line in enumerate(textwrap.wrap(words, 54)):
        yield f"  {'' if k else name:22}  {line}"


def interval(ends: Sequence[float | Fraction]) -> str:
    """Write an interval that a mission gives."""
    return f"[{number(ends[0])}, {number(ends[1])}]"


def enclosure(ends: Sequence[Fraction]) -> str:
    """Write proved bounds on both sides, rounded outward."""
    return f"[{at_least(ends[0])}, {at_most(ends[1])}]"


def inside(ends: Sequence[Fraction]) -> str:
    """Write an interval over which something is proved, rounded inward to six digits."""
    return f"[{at_most(ends[0], 6)}, {at_least(ends[1], 6)}]"


def sides_text(box: Sequence[Sequence[Fraction]]) -> str:
    """Write a box, over which something is proved, as a product of intervals."""
    return " x ".join(map(inside, box))


def position_text(p: Sequence[float | Fraction]) -> str:
    """Write a position in m."""
    return "(" + ", ".join(f"{round(float(c), 4) + 0.0:g}" for c in p) + ") m"


def goal_text(mission: Mission) -> Iterator[str]:
    """Yield where the goal is, if that is not right above the middle of the target."""
    from hoverproof.plant.goal import hover_goal

    goal = hover_goal(mission)
    if not goal.is_above_middle_of(mission):
        yield f"  goal                    {position_text(goal.position)}, level:"
        aside = any(map(any, goal.centroid[:2]))
        turned = ", at heading 0" if aside else ""
        yield f"                          where the target is seen as the mission asks{turned}"


def goal_as_json(mission: Mission) -> list[float]:
    """Return where the goal is, m, world frame."""
    from hoverproof.plant.goal import hover_goal

    return numbers(hover_goal(mission).position)


def bounds_as_json(problem: GainProblem) -> dict[str, Any]:
    """Return what a verdict supposes of Q, or of J, and whether it is assumed or proved."""
    of_q = problem.flow.symbol == "Q"
    low, high = problem.eigenvalues
    ball = {"centre": float(low + high) / 2, "radius": float(high - low) / 2}
    return {
        "eigenvalues": numbers(problem.eigenvalues) if of_q else None,
        "ball": None if of_q else ball,
        "eigenvalue_bounds": problem.origin,
    }


def gain_units() -> dict[str, str]:
    """Return the unit of each gain by its name."""
    from hoverproof.servo.variables import Design

    return Design.gains()


def gains_text(mission: Mission) -> Iterator[str]:
    """Yield a line for each gain."""
    from hoverproof.mission.writing import decimal

    units = gain_units()
    for key in units:
        yield f"  {key:6} = {decimal(getattr(mission.gains, key)):12} {units[key]}"


def gains_as_json(mission: Mission) -> dict[str, float]:
    """Return the gains by name."""
    return {key: float(getattr(mission.gains, key)) for key in gain_units()}


def limits_text(uses: Iterable[Use]) -> Iterator[str]:
    """Yield a line for each limit: how much of it is used."""
    for use in uses:
        binds = "binds" if use.binds else "does not bind"
        if use.binds and use.set_by:
            binds = f"{binds} ({use.set_by})"
        what = "at least" if use.least else "limit"
        limit = f"{about(use.limit)} {use.unit.removeprefix('1')}".rstrip()
        yield f"  {use.name}: {about(use.value)}, {what} {limit}: {binds}"


def limits_as_json(uses: Sequence[Use]) -> dict[str, Any]:
    """Return how much of each limit is used, and which bind."""
    keys = ("name", "value", "limit", "unit", "binds")
    return {
        "limits": [{key: getattr(use, key) for key in keys} for use in uses],
        "binds": [use.name for use in uses if use.binds],
    }


def hover_error_text(error: HoverError | None, mission: Mission) -> Iterator[str]:
    """Yield what an error of thrust or mass does to the hover, which no integral action mends."""
    if error is None and mission.law.force == "modelled":
        yield "  hover, 1 % less thrust  at another height, not computed for this law"
    for name, value in error.rows() if error is not None else ():
        yield f"  {name:22}  {value}"


def hover_error_as_json(error: HoverError | None) -> dict[str, Any] | None:
    """Return the same by name; null where it is not known of the law."""
    return None if error is None else asdict(error)


def as_argument(path: Path | str | None) -> str:
    """Write a path as a shell takes it, and a command not for an option."""
    text = str(path)
    return shlex.quote(f"./{text}" if text.startswith("-") else text)


def written_text(written: str | None, certificate: Path | None) -> Iterator[str]:
    """Yield where gains and their certificate were written, and what to do next."""
    if written is None:
        yield "Next: the same with --out FILE.toml writes a mission file and its certificate"
    else:
        yield f"  written to              {written}"
        yield f"  certificate             {certificate}"
        yield f"Next: hoverproof check {as_argument(certificate or '')}"
