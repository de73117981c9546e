"""The commands `presets` and `new`: mission files."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from hoverproof.cli.completion import preset_names
from hoverproof.cli.console import Json, app, number, print_json, warn
from hoverproof.errors import InputError

AUTO = 'eigenvalues = "auto"          # of Q: proved over a box around start and goal'


@app.command
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
    from hoverproof.design.limits import bandwidth
    from hoverproof.mission.presets import preset_text
    from hoverproof.mission.presets import presets as names
    from hoverproof.mission.reading import load
    from hoverproof.servo.loop import slowest_rate

    if name is not None:
        text = preset_text(name)
        if json_:
            print_json(load(name).exact())
        else:
            print(text, end="")
        return 0
    missions = [load(n) for n in names()]
    times = [1 / slowest_rate(m) for m in missions]
    if json_:
        facts = [
            {
                "name": m.name,
                "mass": float(m.vehicle.mass),
                "points": len(m.target.points),
                "height": None if m.goal.height is None else float(m.goal.height),
                "bandwidth": bandwidth(m),
                "time_constant": time,
            }
            for m, time in zip(missions, times, strict=True)
        ]
        units = {"mass": "kg", "height": "m", "bandwidth": "rad/s", "time_constant": "s"}
        print_json({"presets": [m.name for m in missions], "missions": facts, "units": units})
        return 0
    print(
        f"{'name':16} {'mass kg':>8} {'points':>7} {'height m':>9} {'rad/s':>7} {'slowest s':>10}"
    )
    for m, time in zip(missions, times, strict=True):
        height = "-" if m.goal.height is None else number(m.goal.height)
        print(
            f"{m.name:16} {number(m.vehicle.mass):>8} {len(m.target.points):>7} {height:>9} "
            f"{bandwidth(m):>7.3g} {time:>10.3g}"
        )
    print("rad/s: attitude bandwidth (k1 k2 + k3 + k4)/m; slowest: time constant at goal")
    print("Next: hoverproof presets NAME prints one; hoverproof certify NAME")
    return 0


@app.command
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
    from hoverproof.cli.interview import interview
    from hoverproof.files import replacing
    from hoverproof.mission.presets import conditions_text, preset_text
    from hoverproof.mission.reading import load

    if path.exists() and not force:
        raise InputError(str(path), "", "exists already; --force replaces it")
    if not path.parent.is_dir():
        raise InputError(str(path), "", f"there is no folder {path.parent}")
    name = re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"
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
    if json_:
        print_json({"out": str(path), "name": name, "from": source})
        return 0
    print(f"{path}: written, {source if asks else f'from preset {source}'}")
    print("Next:" if asks else "Next: put in your vehicle, target and gains, then")
    print(f"  hoverproof certify {path}")
    print(f"  hoverproof tune {path} --out {path.with_stem(f'{path.stem}-tuned')}")
    print(f"  hoverproof simulate {path}")
    return 0
