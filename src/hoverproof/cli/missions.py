"""The commands `presets` and `new`: mission files."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.completion import preset_names
from hoverproof.cli.console import Json, warn
from hoverproof.cli.reading import mission_name
from hoverproof.errors import InputError

AUTO = 'eigenvalues = "auto"          # of Q: proved over a box around start and goal'


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
    from hoverproof.servo.loop import slowest_rate

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
            help="Preset to start from, without questions. [default: x4-flyer]",
            completer=preset_names,
        ),
    ] = None,
    yes: Annotated[bool, Parameter(negative="", help="Ask nothing.")] = False,
    force: Annotated[bool, Parameter(negative="", help="Replace an existing file.")] = False,
    json_: Json = False,
) -> int:
    """Write a commented mission file for your vehicle, or from a preset.

    In a terminal it asks for the vehicle, its target and its start: mass, arm, inertia and so on,
    each with its unit and a default. An answer that cannot be used is asked for again. Gains are
    then those of x4-flyer, scaled by similarity. With --from, --yes or --json, or if it is not run
    in a terminal, nothing is asked and the preset is written, but that its eigenvalue bounds of Q
    are "auto": proved over a box around start and goal.

    The file is written whole at the end, or, after Ctrl-C, not at all.

    Example: `hoverproof new my-flyer.toml`

    Example: `hoverproof new my-flyer.toml --from x4-flyer --force`
    """
    from hoverproof.cli.answers.missions import NewAnswer
    from hoverproof.cli.interview import interview
    from hoverproof.files import replacing
    from hoverproof.mission.presets import conditions_text, preset_text
    from hoverproof.mission.reading import load

    if path.exists() and not force:
        raise InputError(str(path), "", "exists already; --force replaces it")
    if not path.parent.is_dir():
        raise InputError(str(path), "", f"there is no folder {path.parent}")
    name = mission_name(path)
    asks = not (yes or json_ or preset) and sys.stdin.isatty() and sys.stdout.isatty()
    source = "own vehicle" if asks else preset or "x4-flyer"
    if asks:
        text = interview(name)
    else:
        text = re.sub(r'(?m)^name = ".*"', f'name = "{name}"', preset_text(source), count=1)
        text = re.sub(r"(?m)^eigenvalues = .*", AUTO, text, count=1)
    with replacing(path) as beside:
        beside.write_text(text + conditions_text(), encoding="utf-8")
        made = load(beside)  # nothing is put in place that does not load
    warn(made.model_copy(update={"source": str(path)}))
    return tell(NewAnswer(path, name, source, asks), json_)
