"""The command `export`: the control law as C99 firmware."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

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

if TYPE_CHECKING:
    import xarray as xr

    from hoverproof.mission import Mission


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

    Exit status 1 or 3 if the gains are refuted or undecided; then nothing is written.

    Example: `hoverproof export x4-flyer --out firmware`
    """
    import hoverproof
    from hoverproof.export.package import NotCertified

    loaded = load_mission(mission, set_)
    try:
        manifest = hoverproof.export_c(
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
            print_json({"mission": loaded.name, "verdict": error.status, "out": None})
        else:
            print(f"hoverproof: {error}", file=sys.stderr)
        return EXIT[error.status]
    if json_:
        print_json({"out": str(out), **manifest})
        return 0
    standing = "certified" if manifest["certified"] else "UNCERTIFIED: nothing is proved"
    print(f"{loaded.name}: firmware written, {precision}, {standing}")
    print(f"  folder          {out}")
    print(f"  thrust          {interval(manifest['thrust'])} N, monitored")
    print(f"  rotors          {interval(manifest['rotor_limits'])} N each")
    print(f"  law             SHA-256 {manifest['law_sha256']}")
    if manifest["certified"]:
        print(f"  certificate     SHA-256 {manifest['certificate_sha256']}")
    print(f"Next: cd {out} && cmake -B build && cmake --build build --target fly")
    return 0


def fly_firmware(
    mission: Mission, *, duration: float | None, step: float, every: int | None
) -> xr.Dataset:
    """Export a mission in float32 and fly that very C from the mission's start.

    The controller runs once a step and its thrust and torque are held in between; the ideal rigid
    body moves by one step of RK4. Gains need not be proved for a simulated flight.

    Parameters
    ----------
    mission : Mission
    duration, step : float
        s.
    every : int, optional
        Keep every so many steps; by default about 2000 samples are kept.

    Returns
    -------
    xarray.Dataset
        As `hoverproof.simulate` gives it; thrusts and torque are those of the firmware, and
        `firmware_status` has the status of each sample's step.
    """
    import tempfile
    import time

    import numpy as np

    import hoverproof
    from hoverproof.export.binding import Firmware
    from hoverproof.simulation import flight as simulation
    from hoverproof.simulation.numbers import FlightNumbers

    unfit = sorted(set(mission.conditions()) - {"scatter"})
    if unfit:
        raise InputError(
            mission.source, unfit[0], "is not flown with --controller firmware; leave it out"
        )
    if duration is None:
        duration = simulation.default_duration(mission)
    if not 0 < step <= 0.1:
        raise InputError("--step", "", f"must be at most 0.1 s for the firmware, not {step}")
    steps = round(duration / step) if np.isfinite(duration) else 0
    if steps < 1:
        raise InputError("--duration", "", f"must be at least one step of {step} s, not {duration}")
    every = max(1, steps // simulation.SAMPLES) if every is None else every
    if not 1 <= every <= steps or steps // every > simulation.MAX_SAMPLES:
        raise InputError("--every", "", f"cannot be {every} for {steps} steps")
    with tempfile.TemporaryDirectory() as folder:
        hoverproof.export_c(mission, folder, name="firmware", allow_uncertified=True)
        firmware = Firmware(folder)
    begin = time.perf_counter()
    flown = firmware.fly(step, steps // every, every)
    seconds = time.perf_counter() - begin
    states = np.column_stack([flown["state"], flown["thrust"]])
    whole = len(states) == steps // every + 1
    kept = slice(None) if whole or len(states) == 1 else slice(-1)
    numbers = FlightNumbers.of(mission)
    record = simulation._record(mission, numbers, states[kept], step * every)
    record["torque"].values[:] = flown["torque"][kept]
    record["rotor_thrust"].values[:] = flown["rotor"][kept]
    words = "0, or a sum of the bits in the firmware's header"
    record["firmware_status"] = ("time", flown["status"][kept], {"long_name": words})
    fault = f"firmware fault {int(flown['status'][-1])}"
    record.attrs |= {
        "outcome": "flown"
        if whole
        else f"ended near {(len(states) - 1) * step * every:g} s: {fault}",
        "step": step,
        "steps": (len(states) - 1) * every,
        "seconds": seconds,
        "machine": "firmware, float32",
    }
    return record


def _limits(text: str) -> tuple[Fraction, Fraction]:
    try:
        low, high = (Fraction(part.strip()) for part in text[:200].split(","))
    except (ValueError, ZeroDivisionError):
        raise InputError(
            "--rotor-limits", "", f"must be LOWEST,HIGHEST in N, not {text!r}"
        ) from None
    return low, high
