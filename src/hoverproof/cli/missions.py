"""The commands `presets` and `new`: mission files."""

from __future__ import annotations

import contextlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.completion import preset_names
from hoverproof.cli.console import Json, at_work, warn
from hoverproof.cli.questions import OWN, Answers, Given
from hoverproof.cli.reading import file_to_write, mission_name, refuse_given
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission.described import VehicleFile
    from hoverproof.mission.target_files import TargetFile

AUTO = 'eigenvalues = "auto"          # of Q or J: proved over a box around start and goal'


def presets(
    name: Annotated[
        str | None,
        Parameter(help="Print this preset as a mission file.", completer=preset_names),
    ] = None,
    *,
    json_: Json = False,
) -> int:
    """List the missions that come with hoverproof, or print one.

    Each is a mission file with its sources in comments; every command that takes a mission takes
    the name of a preset.

    Example: `hoverproof presets`

    Example: `hoverproof presets x4-flyer`
    """
    from hoverproof.cli.answers.missions import PresetAnswer, PresetsAnswer
    from hoverproof.design.limits import bandwidth
    from hoverproof.mission.presets import preset_text
    from hoverproof.mission.presets import presets as names
    from hoverproof.mission.reading import load
    from hoverproof.servo.linearised import slowest_rate

    if name is not None:
        return tell(PresetAnswer(preset_text(name), load(name)), json_)
    missions = [load(n) for n in names()]
    facts = [(m, bandwidth(m), 1 / slowest_rate(m)) for m in missions]
    return tell(PresetsAnswer(facts), json_)


def new(
    path: Annotated[Path, Parameter(help="Mission file to write.")],
    *,
    preset: Annotated[
        str | None,
        Parameter(
            name="--from",
            help="Copy this preset in place of asking; or take the vehicle from this file: URDF, "
            "SDF, MJCF, RotorPy, parameters of PX4 or Betaflight.",
            completer=preset_names,
        ),
    ] = None,
    target: Annotated[
        str | None,
        Parameter(
            help="Take the target from this file: tag bundle (apriltag_ros), grid (Kalibr) or "
            "marker map (ArUco), in m."
        ),
    ] = None,
    target_name: Annotated[
        str | None, Parameter(help="Which bundle, or which tag, of a file that holds several.")
    ] = None,
    given: Annotated[Given | None, Parameter(name="*", help="Answers, each an option.")] = None,
    yes: Annotated[
        bool, Parameter(negative="", help="Ask nothing: what is not given has its default.")
    ] = False,
    force: Annotated[bool, Parameter(negative="", help="Replace an existing file.")] = False,
    json_: Json = False,
) -> int:
    """Write a commented mission file for your vehicle, or from a preset.

    In a terminal it asks for vehicle, tag, camera, tolerances and start, each with its unit and a
    default, except for what is given as an option. What cannot be used is asked for again.
    With --yes or --json, or if it is not run in a terminal, nothing is asked.

    The mission has the law that needs neither depth nor thrust to be known, and gains that are
    found to hold the start for every vehicle within the tolerances: `attraction` proves it.

    The file is written whole at the end, or, after Ctrl-C, not at all.

    Example: `hoverproof new my-flyer.toml`

    Example: `hoverproof new my-flyer.toml --mass 0.5 --rotor-distance 0.17 --rotor-lag 0.05`

    Example: `hoverproof new my-flyer.toml --from x4-flyer --force`

    Example: `hoverproof new my-flyer.toml --from model.sdf --tag 0.5`

    Example: `hoverproof new my-flyer.toml --target aprilgrid.yaml --height 2`
    """
    from hoverproof.cli.answers.missions import NewAnswer
    from hoverproof.files import replacing
    from hoverproof.mission.presets import with_conditions
    from hoverproof.mission.reading import load
    from hoverproof.mission.target_files import read_target

    answers = given.answers() if given else {}
    described = _described(preset, answers)
    preset = None if described else preset
    if preset:
        refuse_given(
            {f"--{name.replace('_', '-')}": text for name, text in answers.items()},
            "does not go with --from, which copies a preset",
        )
    if target_name is not None and target is None:
        raise InputError("--target-name", "", "goes with --target")
    if target is not None and "tag" in answers:
        raise InputError(
            "--tag", "", "does not go with --target, which tells the size of the target"
        )
    file_to_write(path, "mine.toml")
    if path.exists() and not force:
        raise InputError(str(path), "", "exists already; --force replaces it")
    name = mission_name(path)
    found = None if target is None else read_target(target, target_name)
    asks = not (yes or json_ or preset) and sys.stdin.isatty() and sys.stdout.isatty()
    with replacing(path) as beside, _told_of(path, beside):
        own = beside, name, answers, asks, found, described
        text, assumed = (_copied(preset, name, found), []) if preset else _own(*own)
        beside.write_text(with_conditions(text), encoding="utf-8", newline="\n")
        made = load(beside)  # nothing is put in place that does not load
    made = made.model_copy(update={"source": str(path)})
    warn(made)
    return tell(
        NewAnswer(path, made, preset or "own vehicle", _read(described, found), assumed), json_
    )


@contextlib.contextmanager
def _told_of(path: Path, beside: Path) -> Iterator[None]:
    """Name the file that was asked for, where what is wrong stands in the one beside it."""
    try:
        yield
    except InputError as error:
        where = str(path) if error.where == str(beside) else error.where
        raise InputError(where, error.key, error.reason) from None


def _copied(preset: str, name: str, target: TargetFile | None) -> str:
    from hoverproof.cli.interview import answers_of_target
    from hoverproof.mission.presets import preset_text

    text = re.sub(r'(?m)^name = ".*"', f'name = "{name}"', preset_text(preset), count=1)
    if target is not None:
        known = answers_of_target(target)
        lines = f"{known['target']}\npoints = {known['points']}"
        text = re.sub(r"(?m)^points = .*", lines, text, count=1)
        text = re.sub(r"(?m)^eigenvalues = .*", AUTO, text, count=1)  # its own are of its target
    return text


def _read(vehicle: VehicleFile | None, target: TargetFile | None) -> tuple[str, ...]:
    from hoverproof.cli.described import said_of_vehicle

    return (*(said_of_vehicle(vehicle) if vehicle else ()), *(target.words if target else ()))


def _described(source: str | None, answers: Answers) -> VehicleFile | None:
    """Read the vehicle of a file; None if it is none but a preset."""
    from hoverproof.mission.presets import preset_text, presets
    from hoverproof.mission.vehicle_files import read_vehicle

    if source is None or source in presets():
        return None
    if not Path(source).is_file():
        preset_text(source)  # says which there are
    if source.endswith(".toml"):
        raise InputError(
            "--from", "", f"{source} is a mission file: --vehicle takes a vehicle of one"
        )
    if "vehicle" in answers:
        raise InputError("--vehicle", "", "does not go with --from, which tells the vehicle")
    return read_vehicle(source)


def _own(
    beside: Path,
    name: str,
    given: Answers,
    asks: bool,
    target: TargetFile | None,
    vehicle: VehicleFile | None,
) -> tuple[str, list[str]]:
    """Return a mission of one's own, and which of its answers nobody gave."""
    from hoverproof.cli.described import answers_of_vehicle, in_layout_of
    from hoverproof.cli.interview import (
        answers_of_target,
        interview,
        say_as_options,
        without_asking,
    )

    known = {} if target is None else answers_of_target(target)
    if vehicle is not None:
        known |= answers_of_vehicle(vehicle) | {"vehicle": f'"{OWN}"'}
    known = {key: value for key, value in known.items() if key not in given}
    assumed: list[str] = []
    answers = interview(given, known=known) if asks else without_asking(given, known, assumed)
    if vehicle is not None and vehicle.layout and "layout" not in given:
        answers["placed"] = in_layout_of(vehicle, answers["rotor_distance"])
    try:
        return _with_start(beside, name, answers, assumed, asks, "start" in given)
    except InputError:
        if asks:  # nothing that was typed is lost
            say_as_options(answers, given, known)
        raise


def _with_start(
    beside: Path, name: str, answers: Answers, assumed: list[str], asks: bool, is_given: bool
) -> tuple[str, list[str]]:
    """Return the mission of some answers, with a start that is held, and what is assumed.

    A start that nobody gave is taken nearer to the goal, or asked for again.
    """
    from hoverproof.cli.first_mission import NotHeldError, make
    from hoverproof.cli.interview import start_again
    from hoverproof.cli.questions import START

    while True:
        try:
            with at_work() as doing:
                return make(beside, name, answers, assumed, doing), assumed
        except NotHeldError as refused:
            if is_given or refused.held is None:
                raise
            usual = START.assumed(answers["start"])
            held = start_again(refused.line, refused.held, answers) if asks else refused.held
            nearer = f"{START.assumed(held)} (nearer than usual, to be held)"
            assumed = [nearer if words == usual else words for words in assumed]
            answers = answers | {"start": held}
