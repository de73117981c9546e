"""The command `export`: the control law as C99 firmware."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.console import (
    EXIT,
    Json,
    MissionName,
    Set,
    app,
    interval,
    load_mission,
    print_json,
)
from hoverproof.errors import InputError


@app.command
def export(
    mission: MissionName,
    *,
    out: Annotated[Path, Parameter(help="Folder to write to; made if needed.")],
    precision: Annotated[
        Literal["float32", "float64"], Parameter(help="Type of the numbers on the target.")
    ] = "float32",
    sensing: Annotated[
        Literal["points", "centroid"],
        Parameter(help="What the camera delivers: image points, or the centroid already summed."),
    ] = "points",
    tunable: Annotated[
        bool, Parameter(negative="", help="Keep the gains as parameters that may be set.")
    ] = False,
    name: Annotated[
        str | None, Parameter(help="Prefix of files and symbols; by default from the mission.")
    ] = None,
    rotor_limits: Annotated[
        str | None,
        Parameter(
            help="LOWEST,HIGHEST thrust of a rotor, N; by default the mission's, else 0 to m g/2."
        ),
    ] = None,
    allow_uncertified: Annotated[
        bool,
        Parameter(negative="", help="Write it even if nothing is proved; each file says so."),
    ] = False,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Certify a mission, and write its control law as C99 firmware with the certificate.

    The folder gets the C with a self-test, a README for whoever flashes it, an example that flies
    (CMake), adapters for Crazyflie, PX4 and ArduPilot, and a manifest with hashes. Exit status 1
    or 3 if the gains are refuted or undecided; then nothing is written.

    Example: `hoverproof export x4-flyer --out firmware`

    Example: `hoverproof export crazyflie-2.1 --out firmware --rotor-limits 0,0.15 --tunable`
    """
    from hoverproof.export.package import NotCertified
    from hoverproof.firmware import export_c

    loaded = load_mission(mission, set_)
    try:
        manifest = export_c(
            loaded,
            out,
            precision=precision,
            sensing=sensing,
            tunable=tunable,
            name=name,
            rotor_limits=None if rotor_limits is None else _limits(rotor_limits),
            allow_uncertified=allow_uncertified,
        )
    except NotCertified as error:
        if json_:
            print_json({"mission": loaded.name, "verdict": error.status, "out": None}, loaded)
        else:
            print(f"hoverproof: {error}", file=sys.stderr)
        return EXIT[error.status]
    if json_:
        print_json({"out": str(out), **manifest}, loaded)
        return 0
    standing = "UNCERTIFIED: nothing is proved"
    if manifest["certified"]:
        standing = f"certified (bounds of Q {manifest['eigenvalue_bounds']})"
    print(f"{loaded.name}: firmware written, {precision}, {standing}")
    print(f"  folder  {out}")
    print(f"  thrust  {interval(manifest['thrust'])} N, monitored")
    print(f"  rotors  {interval(manifest['rotor_limits'])} N each")
    option = " (see --rotor-limits)" if rotor_limits is None else ""
    print(f"          {manifest['rotor_limits_from']}{option}")
    print("SHA-256 of the law, and of the certificate if there is one:")
    print(f"  {manifest['law_sha256']}")
    if manifest["certified"]:
        print(f"  {manifest['certificate_sha256']}")
    print(f"Next: cd {out} && cmake -B build && cmake --build build --target fly")
    return 0


def _limits(text: str) -> tuple[Fraction, Fraction]:
    try:
        low, high = (Fraction(part.strip()) for part in text[:200].split(","))
    except (ValueError, ZeroDivisionError):
        raise InputError(
            "--rotor-limits", "", f"must be LOWEST,HIGHEST in N, not {text!r}"
        ) from None
    return low, high
