"""What the commands share: the application, common options, missions, and bars of progress."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

from cyclopts import (
    App,
    Argument,
    CycloptsError,
    MissingArgumentError,
    Parameter,
    UnknownCommandError,
    UnusedCliTokensError,
    validators,
)

from hoverproof.cli.completion import mission_names, settings
from hoverproof.errors import InputError, suggestion
from hoverproof.version import __version__

if TYPE_CHECKING:
    from rich.console import Console

    from hoverproof.mission.sections import Mission
    from hoverproof.plausibility import Finding


def shown_default(value: Any) -> str | None:
    """Show a default in the help, but not that a switch is off until it is given."""
    return None if value is None or value is False else "yes" if value is True else str(value)


app = App(
    name="hoverproof",
    version=__version__,
    help="From a camera, a target and a hovering vehicle to gains with a proof, a flight and C.\n\n"
    "Example: `hoverproof certify x4-flyer` (a vehicle that is included; see `presets`)\n\n"
    "Example: `hoverproof new my-flyer.toml` (a mission file for your own)\n\n"
    "Each command has its own --help, with examples.",
    help_epilogue="Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, "
    "2 bad usage or bad input, 3 undecided.",
    default_parameter=Parameter(show_default=shown_default),
    result_action="return_value",
    suppress_keyboard_interrupt=False,
)
app["--help"].help = "Print this help and exit."
app["--version"].help = "Print the version and exit."
app.register_install_completion_command(
    help="Install Tab completion of commands, options, presets and mission files for bash, zsh, "
    "fish or PowerShell.\n\n"
    "Writes the script where the shell looks for it and, if need be, a line to the start-up file "
    "of the shell.\n\nExample: `hoverproof --install-completion --shell bash`\n\n"
    "Example: `hoverproof --install-completion --shell zsh --output _hoverproof`"
)

MissionName = Annotated[
    str,
    Parameter(help="Name of a preset, or path of a mission file.", completer=mission_names),
]
Json = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON object.")]
Set = Annotated[
    list[str] | None,
    Parameter(
        name="--set",
        negative="",
        help="Override a value: gains.k4=0.1 (repeatable).",
        completer=settings,
    ),
]
Box = Annotated[
    str | None,
    Parameter(help="Positions x0,x1,y0,y1,z0,z1 in m; by default around start and goal."),
]
Boxes = Annotated[
    int | None,
    Parameter(
        help="Most cells to halve the box into; fewer answer sooner, perhaps with undecided.",
        validator=validators.Number(gte=1),
    ),
]


def fail(message: str, status: int = 2) -> NoReturn:
    """Print one line on stderr and exit."""
    line = " ".join(message.split())
    print(f"hoverproof: {line}", file=sys.stderr)
    sys.exit(status)


def usage(error: CycloptsError) -> str:
    """Say in one line what is wrong with the words of a command, and where its help is."""
    command = " ".join(error.command_chain or ())
    match error:
        case MissingArgumentError(argument=Argument() as missing) if not missing.has_tokens:
            only_named = not missing.field_info.is_positional
            name = missing.name if only_named else missing.name.lstrip("-").upper()
            problem = f"{command} needs {error.keyword or name}"
            if error.keyword:
                problem = f"{error.keyword} needs a value"
            if missing.parameter.help:
                problem += f": {missing.parameter.help}"
            minus = _minus(error.keyword, error.root_input_tokens or [])
            if minus:
                problem = f"{error.keyword} needs an equals sign before a minus: {minus}"
        case UnusedCliTokensError(unused_tokens=[first, *_]):
            problem = f"{first!r} is one argument too many."
        case UnknownCommandError(unused_tokens=[first, *_]):
            verbs = [name for name in app if not name.startswith("-")]
            problem = f"no command {first!r}: {suggestion(first, [*app], 'there are', shown=verbs)}"
        case _:
            problem = str(error).strip()
    return f"{problem} (see {f'hoverproof {command}'.strip()} --help)"


def _minus(option: str | None, words: list[str]) -> str | None:
    """Return how an option is given the value behind it, if that starts with a minus."""
    for word, after in itertools.pairwise(words):
        if word == option and re.match(r"-[\d.]", after):
            return f"{option}={after}"
    return None


def plain_console() -> Console | None:
    """Return a terminal without escape codes if NO_COLOR asks for one."""
    if not os.environ.get("NO_COLOR"):
        return None
    from rich.console import Console

    return Console(color_system=None)


def load_mission(mission: str, settings: list[str] | None) -> Mission:
    """Load a mission with the values given by --set put in place; warn of what is strange in it."""
    from hoverproof.mission.reading import load

    overrides = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not equals:
            raise InputError(f"--set {setting}", "", "must have the form KEY=VALUE")
        overrides[key.strip()] = value.strip()
    loaded = load(mission, overrides)
    warn(loaded)
    return loaded


def warn(mission: Mission, known: Mission | None = None) -> None:
    """Say on stderr what no vehicle has, a line each, but for what a known mission has too."""
    from hoverproof.plausibility import warnings

    told = [] if known is None else [finding.name for finding in warnings(known)]
    for finding in warnings(mission):
        if finding.name not in told:
            warn_of(mission, finding)


def warn_of(mission: Mission, finding: Finding) -> None:
    """Say one thing on stderr that is strange about a mission."""
    print(f"hoverproof: warning: {mission.source}: {finding}", file=sys.stderr)


@contextlib.contextmanager
def progress(title: str) -> Iterator[Callable[..., None]]:
    """Give a function (done, total, note="") that shows a bar on stderr, if a person looks."""
    if not sys.stderr.isatty():
        yield lambda done, total, note="": None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as Remaining

    note = TextColumn("{task.fields[note]}")
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), note)
    with Progress(*columns, Remaining(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None, note="")
        yield lambda done, total, note="": bar.update(task, completed=done, total=total, note=note)


@contextlib.contextmanager
def at_work() -> Iterator[Callable[[str], None]]:
    """Give a function (text) that says on stderr what is being done; to a person, since when."""
    if not sys.stderr.isatty():
        last = ""

        def say(text: str) -> None:
            nonlocal last
            if text != last:
                print(f"{text} ...", file=sys.stderr)
            last = text

        yield say
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda text: bar.update(task, description=f"{text} ...")
