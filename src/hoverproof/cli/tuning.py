"""The commands `tune` and `atlas`: gains by design, and maps of what is certified."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.certification import parse_weights
from hoverproof.cli.console import Json, MissionName, Set, app, load_mission, number, print_json
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.certification.tuning import Infeasible, Report, Tuned
    from hoverproof.mission import Mission

VARY = (
    "k1, k2, k3, k4, lowest_eigenvalue, highest_eigenvalue, lowest_thrust, highest_thrust or level"
)
GAIN_UNITS = {"k1": "kg m/s", "k2": "1/m", "k3": "kg/s", "k4": "kg/s", "k_yaw": "kg m²/s"}


@app.command
def tune(
    mission: MissionName,
    *,
    objective: Annotated[
        Literal["decay", "settling"],
        Parameter(
            help="Largest certified decay rate of L, or fastest settling of the certified gains."
        ),
    ] = "decay",
    bandwidth: Annotated[
        float, Parameter(help="Largest attitude bandwidth (k1 k2 + k3 + k4)/m in rad/s.")
    ] = 20.0,
    rate: Annotated[
        float | None,
        Parameter(help="Sampling rate in Hz: keeps the bandwidth times its period at most 0.2."),
    ] = None,
    tilt: Annotated[
        float | None, Parameter(help="Largest tilt asked for at the start, in degrees.")
    ] = None,
    rotor_thrust: Annotated[
        float | None,
        Parameter(help="Largest thrust of a rotor in N; the first command keeps within 0 and it."),
    ] = None,
    at_least: Annotated[
        float | None, Parameter(help="Certified decay rate of L that is wished for, in 1/s.")
    ] = None,
    weights: Annotated[
        str | None,
        Parameter(help="Weights of L: four numbers w1,w2,w3,w4, or `search`; by default ones."),
    ] = None,
    pareto: Annotated[
        int | None,
        Parameter(help="Tune for so many bandwidths up to the given one, and draw the curve."),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="Mission file to write; with --pareto the figure, PNG or SVG."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Find the fastest gains within a vehicle's limits that can be proved.

    The gains are rounded to short decimals and then certified exactly, so what is printed is what
    is proved. A wish that cannot be met has status 1, and says what binds and by how much.

    Example: `hoverproof tune x4-flyer --bandwidth 20 --out my-flyer.toml`
    """
    from hoverproof.certification.tuning import Tuned
    from hoverproof.certification.tuning import pareto as curve
    from hoverproof.certification.tuning import tune as design
    from hoverproof.editing import mission_text
    from hoverproof.files import write_text

    loaded = load_mission(mission, set_)
    options: dict[str, Any] = {
        "bandwidth": bandwidth,
        "objective": objective,
        "rate": rate,
        "tilt": None if tilt is None else math.radians(tilt),
        "rotor_thrust": rotor_thrust,
        "at_least": at_least,
        "weights": "search" if weights == "search" else parse_weights(loaded, weights, None),
    }
    if pareto is not None:
        if at_least is not None:
            raise InputError("--at-least", "", "does not go with --pareto")
        picture = _picture(out or Path(f"{loaded.name}.pareto.png"))
        with progress("tune") as report:
            points = curve(loaded, pareto, report=report, **options)
        return _print_curve(loaded, points, picture, json_)

    with progress("tune"):
        found = design(loaded, **options)
    written = None
    if out is not None and isinstance(found, Tuned):
        proved = number(found.verdict.decay_rate)
        note = f"{command_line()}\ncertified decay rate of L: {proved} 1/s"
        write_text(out, mission_text(found.mission, name=stem(out), note=note))
        written = str(out)
    if json_:
        print_json(as_json(found) | {"out": written})
    else:
        _print_tuned(found, written)
    return 0 if found.status == "tuned" else 1


@app.command
def atlas(
    mission: MissionName,
    *,
    x: Annotated[str, Parameter(help=f"What varies across: {VARY}.")] = "k1",
    y: Annotated[str, Parameter(help="What varies upward: another of these.")] = "k2",
    x_range: Annotated[
        str | None, Parameter(help="Range LOW,HIGH of x; by default /10 to x10.")
    ] = None,
    y_range: Annotated[str | None, Parameter(help="Range LOW,HIGH of y.")] = None,
    x_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of x.")] = None,
    y_scale: Annotated[Literal["log", "linear"] | None, Parameter(help="Scale of y.")] = None,
    cells: Annotated[int, Parameter(help="Cells along each axis.")] = 200,
    show: Annotated[
        Literal["decay_rate", "margin"], Parameter(help="What the colours show.")
    ] = "decay_rate",
    exact_boundary: Annotated[
        bool, Parameter(negative="", help="Decide each cell at the boundary exactly.")
    ] = False,
    processes: Annotated[
        int | None, Parameter(help="How many work at once; by default one for each CPU.")
    ] = None,
    weights: Annotated[str | None, Parameter(help="Weights of L: w1,w2,w3,w4.")] = None,
    out: Annotated[Path | None, Parameter(help="Map file to write, netCDF-4.")] = None,
    figure: Annotated[
        Path | None, Parameter(help="Figure to write, PNG or SVG; by default beside the map.")
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Map the certified decay rate over two gains or bounds.

    The map is in floating point; with --exact-boundary each cell that has a neighbour on the other
    side is decided exactly, as `certify` does.

    Example: `hoverproof atlas x4-flyer --x k3 --y k4 --exact-boundary`
    """
    import numpy as np

    from hoverproof.certification.atlas import NOT_ASKED, VERDICTS, axis, cell_values
    from hoverproof.certification.atlas import atlas as draw_map
    from hoverproof.files import replacing
    from hoverproof.paper.conditions import where_met
    from hoverproof.show.atlas import save_atlas_figure

    loaded = load_mission(mission, set_)
    if processes is not None and not 1 <= processes <= 1024:
        raise InputError("--processes", "", f"must be from 1 to 1024, not {processes}")
    across = axis(loaded, x, ends=_ends("--x-range", x_range), scale=x_scale, cells=cells)
    along = axis(
        loaded, y, ends=_ends("--y-range", y_range), scale=y_scale, cells=cells, option="--y"
    )
    path = out or Path(f"{loaded.name}.atlas.nc")
    picture = _picture(figure or path.with_suffix(".png"))
    with progress("atlas") as report:
        drawn = draw_map(
            loaded,
            across,
            along,
            weights=parse_weights(loaded, weights, None),
            exact=exact_boundary,
            processes=processes,
            report=report,
        )
    with replacing(path) as beside:
        drawn.to_netcdf(beside, engine="h5netcdf")
    save_atlas_figure(
        loaded, drawn, show, where_met(loaded, cell_values(loaded, across, along)), picture
    )
    margin, verdict = drawn["margin"].values, drawn["verdict"].values
    certified = int((margin > 0).sum())
    best = np.unravel_index(np.nanargmax(margin), margin.shape) if certified else None
    counts = {word: int((verdict == code).sum()) for word, code in VERDICTS.items()}
    asked = verdict != NOT_ASKED
    result = {
        "mission": loaded.name,
        "x": across.name,
        "y": along.name,
        "cells": margin.size,
        "certified": certified,
        "no_question": int(np.isnan(margin).sum()),
        "best": None
        if best is None
        else {
            across.name: float(across.values[best[1]]),
            along.name: float(along.values[best[0]]),
            "decay_rate": float(drawn["decay_rate"].values[best]),
        },
        "decided_exactly": counts if exact_boundary else None,
        "disagree": int((np.sign(margin[asked]) != verdict[asked]).sum()),
        "out": str(path),
        "figure": str(picture),
    }
    if json_:
        print_json(result)
        return 0
    share = 100 * certified / margin.size
    print(
        f"{loaded.name}: {across.name} from {number(across.values[0])} to "
        f"{number(across.values[-1])} {across.quantity.unit}, {along.name} from "
        f"{number(along.values[0])} to {number(along.values[-1])} {along.quantity.unit}"
    )
    print(
        f"  certified               {certified} of {margin.size} cells, {share:.1f} % "
        "(floating point)"
    )
    if best is not None:
        print(
            f"  best cell               {across.name} = {number(across.values[best[1]])}, "
            f"{along.name} = {number(along.values[best[0]])}: "
            f"decay rate {number(drawn['decay_rate'].values[best])} 1/s"
        )
    if exact_boundary:
        words = ", ".join(f"{n} {word}" for word, n in counts.items())
        print(f"  at the boundary         {words}, exactly; {result['disagree']} unlike the map")
    print(f"  map                     {path}")
    print(f"  figure                  {picture}")
    return 0


def _picture(path: Path) -> Path:
    """Refuse a figure in another format before the work is done."""
    if path.suffix.lower() not in (".png", ".svg"):
        raise InputError(str(path), "", "a figure must end in .png or .svg")
    return path


def _ends(option: str, text: str | None) -> tuple[float, float] | None:
    """Read a range LOW,HIGH."""
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text[:100].split(","))
    except ValueError:
        raise InputError(option, "", f"must be LOW,HIGH, not {text!r}") from None
    return low, high


def as_json(found: Tuned | Infeasible) -> dict[str, Any]:
    """Return what `tune` found as an object for machines."""
    from hoverproof.certification.tuning import Infeasible

    if isinstance(found, Infeasible):
        return {
            "mission": found.mission.name,
            "status": found.status,
            "reason": found.reason,
            "needed_bandwidth": found.needed_bandwidth,
            "best": None if found.best is None else as_json(found.best),
        }
    rate, before = found.verdict.decay_rate, found.before
    return {
        "mission": found.mission.name,
        "status": found.status,
        "objective": found.objective,
        "gains": {k: float(v) for k, v in found.mission.gains},
        "decay_rate": float(rate),
        "decay_rate_before": None if before is None else float(before),
        "decay_rate_before_rounding": found.estimate,
        "improvement": None if before is None else float(rate / before),
        "margin": float(found.verdict.margin),
        "slowest_rate": found.slowest_rate,
        "bandwidth": found.uses[0].value,
        "weights": [float(w) for w in found.verdict.problem.weights],
        "limits": [
            {
                "name": u.name,
                "value": u.value,
                "limit": u.limit,
                "unit": u.unit,
                "binds": u.binds,
            }
            for u in found.uses
        ],
        "binds": [u.name for u in found.uses if u.binds],
        "units": {
            **GAIN_UNITS,
            "decay_rate": "1/s",
            "margin": "kg/s",
            "slowest_rate": "1/s",
            "bandwidth": "rad/s",
        },
    }


def _print_tuned(found: Tuned | Infeasible, written: str | None) -> None:
    from hoverproof.certification.problem import ONES
    from hoverproof.certification.tuning import Infeasible
    from hoverproof.editing import decimal

    if isinstance(found, Infeasible):
        print(f"{found.mission.name}: infeasible")
        parts = found.reason.split("; ")
        print("\n".join(f"  {part}{';' if part is not parts[-1] else ''}" for part in parts))
        return
    name, verdict = found.mission.name, found.verdict
    print(f"{name}: tuned for {found.objective}, and proved")
    for key, value in found.mission.gains:
        print(f"  {key:6} = {decimal(value):12} {GAIN_UNITS[key]}")
    rate = verdict.decay_rate
    print(f"  decay rate of L         {number(rate)} 1/s, proved")
    if found.before is None:
        print("    the mission's own gains: not proved")
    else:
        times = float(rate / found.before)
        print(f"    the mission's own gains: {number(found.before)} 1/s, proved; {times:.2f} times")
    print(f"    before rounding:         {number(found.estimate)} 1/s (floating point)")
    if verdict.problem.weights != ONES:
        print(f"  weights of L            {', '.join(map(number, verdict.problem.weights))}")
    slow = found.slowest_rate
    print(f"  slowest motion at goal  {number(slow)} 1/s (linearised, floating point)")
    for use in found.uses:
        binds = "binds" if use.binds else "does not bind"
        print(f"  {use.name}: {number(use.value)}, limit {number(use.limit)} {use.unit}: {binds}")
    if not any(use.binds for use in found.uses):
        print("  what binds: the bounds of Q and of the thrust")
    if written is None:
        print("Next: the same with --out FILE.toml writes a mission file with these gains")
    else:
        print(f"  written to              {written}")
        print(f"Next: hoverproof certify {written}")


def _print_curve(
    mission: Mission, points: list[tuple[float, Tuned | Infeasible]], path: Path, json_: bool
) -> int:
    from hoverproof.certification.tuning import Tuned
    from hoverproof.show.atlas import save_pareto_figure

    tuned = [(b, t) for b, t in points if isinstance(t, Tuned)]
    if tuned:
        save_pareto_figure(mission, tuned, path)
    status = 0 if len(tuned) == len(points) else 1
    if json_:
        rows = [{"bandwidth_limit": b, **as_json(t)} for b, t in points]
        print_json({"mission": mission.name, "points": rows, "figure": str(path)})
        return status
    print(f"{mission.name}: certified decay rate of L against attitude bandwidth")
    print(f"  {'rad/s':>8}  {'1/s':>11}  {'k1':>9}  {'k2':>9}  {'k3':>9}  {'k4':>9}")
    for b, t in points:
        if isinstance(t, Tuned):
            g = t.mission.gains
            four = "  ".join(f"{number(k):>9}" for k in (g.k1, g.k2, g.k3, g.k4))
            print(f"  {b:8.4g}  {number(t.verdict.decay_rate):>11}  {four}")
        else:
            print(f"  {b:8.4g}  {t.status}: {t.reason}")
    if tuned:
        print(f"  figure  {path}")
    return status


def command_line() -> str:
    """Return the command as it was typed."""
    return shlex.join(["hoverproof", *sys.argv[1:]])


def stem(path: Path) -> str:
    """Return a mission's name for a file."""
    import re

    return re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """Show a bar on stderr while work is done, if a person looks at it."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done, total: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
