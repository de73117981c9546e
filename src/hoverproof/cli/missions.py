"""The commands `presets` and `new`: mission files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from hoverproof.cli.console import Json, app, number, print_json
from hoverproof.errors import InputError


@app.command
def presets(
    name: Annotated[str | None, Parameter(help="Print this preset as a mission file.")] = None,
    *,
    json_: Json = False,
) -> int:
    """List the missions that come with hoverproof, or print one.

    Example: `hoverproof presets x4-flyer`
    """
    from hoverproof.certification.gain_search import slowest_rate_at_goal
    from hoverproof.certification.limits import bandwidth
    from hoverproof.mission import load, preset_text
    from hoverproof.mission import presets as names

    if name is not None:
        text = preset_text(name)
        if json_:
            print_json(load(name).exact())
        else:
            print(text, end="")
        return 0
    missions = [load(n) for n in names()]
    times = [1 / slowest_rate_at_goal(m) for m in missions]
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
    print("rad/s: attitude bandwidth (k1 k2 + k3 + k4)/m; slowest s: time constant at the goal")
    print("Next: hoverproof presets NAME prints one, with its sources; hoverproof certify NAME")
    return 0


@app.command
def new(
    path: Annotated[Path, Parameter(help="Mission file to write.")],
    *,
    preset: Annotated[str, Parameter(name="--from", help="Preset to start from.")] = "x4-flyer",
    force: Annotated[bool, Parameter(negative="", help="Replace an existing file.")] = False,
) -> int:
    """Write a commented mission file to start from.

    Example: `hoverproof new my-flyer.toml`
    """
    import re

    from hoverproof.files import write_text
    from hoverproof.mission import conditions_text, preset_text

    text = preset_text(preset) + conditions_text()
    if path.exists() and not force:
        raise InputError(str(path), "", "exists already; --force replaces it")
    name = re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"
    write_text(path, re.sub(r'(?m)^name = ".*"', f'name = "{name}"', text, count=1))
    print(f"{path}: written, from preset {preset}")
    print("Next: put in your vehicle, target and gains, then")
    print(f"  hoverproof certify {path}")
    print(f"  hoverproof simulate {path}")
    return 0
