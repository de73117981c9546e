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
    if json_:
        print_json({"presets": [m.name for m in missions]})
        return 0
    for m in missions:
        mass, n = number(m.vehicle.mass), len(m.target.points)
        print(f"{m.name:24} {mass} kg, {n} target points; hoverproof certify {m.name}")
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
