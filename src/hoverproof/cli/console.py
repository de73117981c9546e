"""What the commands share: the application, common options, and ways to print."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

from cyclopts import App, Parameter, validators

from hoverproof import __version__
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission import Mission

app = App(
    name="hoverproof",
    version=__version__,
    help="From a camera, a target and a hovering vehicle to gains with a proof and a flight.",
    help_epilogue="Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, "
    "2 bad usage or bad input, 3 undecided.",
    result_action="return_value",
)

MissionName = Annotated[str, Parameter(help="Name of a preset, or path of a mission file.")]
Json = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON object.")]
Set = Annotated[
    list[str] | None,
    Parameter(name="--set", negative="", help="Put a value in place: gains.k4=0.1 (repeatable)."),
]
Box = Annotated[
    str | None,
    Parameter(help="Positions x0,x1,y0,y1,z0,z1 in m; by default around start and goal."),
]
Boxes = Annotated[
    int | None,
    Parameter(
        help="Most boxes in the branch and bound; fewer answer sooner, perhaps with undecided.",
        validator=validators.Number(gte=1),
    ),
]
EXIT = {"proved": 0, "refuted": 1, "undecided": 3}


def fail(message: str, status: int = 2) -> NoReturn:
    """Print one line on stderr and exit."""
    line = " ".join(message.split())
    print(f"hoverproof: {line}", file=sys.stderr)
    sys.exit(status)


def load_mission(mission: str, settings: list[str] | None) -> Mission:
    """Load a mission with the values given by --set put in place."""
    from hoverproof.mission import load

    overrides = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not equals:
            raise InputError(f"--set {setting}", "", "must have the form KEY=VALUE")
        overrides[key.strip()] = value.strip()
    return load(mission, overrides)


def box_sides(mission: Mission, text: str | None) -> Any:
    """Read --box; by default the box around start and goal."""
    from hoverproof.certification.region import default_box, parse_box

    return default_box(mission) if text is None else parse_box(text)


@contextlib.contextmanager
def progress(title: str) -> Iterator[Callable[[int, int], None]]:
    """Give a function (done, total) that shows a bar on stderr, if that is a terminal."""
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task(title)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def print_json(value: dict[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def number(value: Any) -> str:
    """Write a number with six digits."""
    return f"{float(value):.6g}"


def interval(ends: Sequence[float | Fraction]) -> str:
    """Write an interval."""
    return f"[{number(ends[0])}, {number(ends[1])}]"


def sides_text(box: Sequence[Sequence[Fraction]]) -> str:
    """Write a box as a product of intervals."""
    return " x ".join(map(interval, box))


def position_text(p: Sequence[float | Fraction]) -> str:
    """Write a position in m."""
    return "(" + ", ".join(f"{round(float(c), 4) + 0.0:g}" for c in p) + ") m"
