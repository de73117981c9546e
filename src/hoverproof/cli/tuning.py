"""The command `tune`: gains by design."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.certification import parse_weights
from hoverproof.cli.console import (
    NO_FOLDER,
    Json,
    MissionName,
    Set,
    app,
    load_mission,
    number,
    print_json,
    warn,
)
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.design.limits import Use
    from hoverproof.design.outcome import Infeasible, Tuned
    from hoverproof.design.tuning import Report
    from hoverproof.mission.sections import Mission

GAIN_UNITS = {"k1": "kg m/s", "k2": "1/m", "k3": "kg/s", "k4": "kg/s", "k_yaw": "kg m²/s"}


@app.command
def tune(
    mission: MissionName,
    *,
    objective: Annotated[
        Literal["decay", "settling", "region"],
        Parameter(
            help="Largest certified decay rate of L, fastest settling of certified gains, or "
            "largest certified region of attraction."
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
        Parameter(help="Largest thrust of a rotor in N at the start; by default the mission's."),
    ] = None,
    at_least: Annotated[
        float | None, Parameter(help="Certified decay rate of L that is wished for, in 1/s.")
    ] = None,
    minimum_decay: Annotated[
        float | None,
        Parameter(
            help="For region: least rate of the slowest motion at the goal, in 1/s; by default "
            "the mission's own."
        ),
    ] = None,
    weights: Annotated[
        str | None,
        Parameter(help="Weights of L: four numbers w1,w2,w3,w4, or `search`; by default ones."),
    ] = None,
    pareto: Annotated[
        int | None,
        Parameter(
            help="Tune for so many bandwidths up to the given one, and draw the curve; for "
            "region, for so many rates of the slowest motion."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(
            help="Mission file to write; with --pareto the figure, PNG or SVG.", validator=NO_FOLDER
        ),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Find the best gains within a vehicle's limits that can be proved.

    The gains are rounded to short decimals and then certified exactly, so what is printed is what
    is proved. A wish that cannot be met has status 1, and says what binds and by how much. With
    --out, --objective region writes the certificate of the region beside the mission.

    Example: `hoverproof tune x4-flyer --bandwidth 20 --out my-flyer.toml`

    Example: `hoverproof tune x4-flyer --pareto 4 --out decay-and-bandwidth.svg`

    Example: `hoverproof tune x4-flyer --objective region --minimum-decay 0.0234`
    """
    from hoverproof.cli import region_gains
    from hoverproof.design.outcome import Infeasible, RegionTuned, Tuned
    from hoverproof.design.tuning import pareto as curve
    from hoverproof.design.tuning import tune as design
    from hoverproof.files import write_text
    from hoverproof.mission.writing import mission_text

    loaded = load_mission(mission, set_)
    options: dict[str, Any] = {
        "bandwidth": bandwidth,
        "objective": objective,
        "rate": rate,
        "tilt": None if tilt is None else math.radians(tilt),
        "rotor_thrust": rotor_thrust,
        "at_least": at_least,
        "minimum_decay": minimum_decay,
        "weights": "search" if weights == "search" else parse_weights(loaded, weights, None),
    }
    if pareto is not None:
        if at_least is not None:
            raise InputError("--at-least", "", "does not go with --pareto")
        picture = picture_path(out or Path(f"{loaded.name}.pareto.png"))
        with progress("tune") as report:
            points = curve(loaded, pareto, report=report, **options)
        if objective == "region":
            return region_gains.print_curve(loaded, points, picture, json_)
        rates = [(b, t) for b, t in points if not isinstance(t, RegionTuned)]
        return _print_curve(loaded, rates, picture, json_)

    asked = loaded
    if objective == "region" and out is not None:  # the certificate is about the mission in `out`
        loaded = loaded.model_copy(update={"name": stem(out)})
    with progress("tune"):
        found = design(loaded, **options)
    if isinstance(found, Infeasible):  # nothing is written, so nothing bears the name of `out`
        found = replace(found, mission=asked)
    warn(found.mission, known=asked)
    written = None
    if out is not None and not isinstance(found, Infeasible):
        if isinstance(found, Tuned):
            proved = f"certified decay rate of L: {number(found.verdict.decay_rate)} 1/s"
        else:
            proved = region_gains.note(found)
            found.region.certificate.save(region_gains.certificate_path(str(out)))
        note = f"{command_line()}\n{proved}"
        write_text(out, mission_text(found.mission, name=stem(out), note=note))
        written = str(out)
    if isinstance(found, RegionTuned):
        return region_gains.print_tuned(found, written, json_)
    if json_:
        print_json(as_json(found) | {"out": written}, found.mission)
    else:
        _print_tuned(found, written)
    return 0 if found.status == "tuned" else 1


def picture_path(path: Path) -> Path:
    """Refuse a figure in another format before the work is done.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InputError
        If it does not end in .png or .svg.
    """
    if path.suffix.lower() not in (".png", ".svg"):
        raise InputError(str(path), "", "a figure must end in .png or .svg")
    return path


def as_json(found: Tuned | Infeasible) -> dict[str, Any]:
    """Return what `tune` found as an object for machines."""
    from hoverproof.design.outcome import Infeasible

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
        "eigenvalues": [float(x) for x in found.verdict.problem.eigenvalues],
        "eigenvalue_bounds": found.verdict.problem.origin,
        "slowest_rate": found.slowest_rate,
        "bandwidth": found.uses[0].value,
        "weights": [float(w) for w in found.verdict.problem.weights],
        "limits": limits_as_json(found.uses),
        "binds": [u.name for u in found.uses if u.binds],
        "hover_error": hover_error_as_json(found.mission),
        "units": {
            **GAIN_UNITS,
            "decay_rate": "1/s",
            "margin": "kg/s",
            "slowest_rate": "1/s",
            "bandwidth": "rad/s",
        },
    }


def limits_as_json(uses: list[Use]) -> list[dict[str, Any]]:
    """Return how much of each limit is used, as objects for machines.

    Parameters
    ----------
    uses : list of Use
    """
    keys = ("name", "value", "limit", "unit", "binds")
    return [{key: getattr(use, key) for key in keys} for use in uses]


def print_limits(uses: list[Use]) -> None:
    """Print how much of each limit is used.

    Parameters
    ----------
    uses : list of Use
    """
    for use in uses:
        binds = "binds" if use.binds else "does not bind"
        what = "at least" if use.least else "limit"
        print(f"  {use.name}: {number(use.value)}, {what} {number(use.limit)} {use.unit}: {binds}")


def print_hover_error(mission: Mission) -> None:
    """Print what an error of thrust or mass does to the hover, which no integral action mends.

    Parameters
    ----------
    mission : Mission
    """
    from hoverproof.servo.hover_error import hover_error

    for name, value in hover_error(mission).rows():
        print(f"  {name:22}  {value}")


def hover_error_as_json(mission: Mission) -> dict[str, float | None]:
    """Return what an error of thrust or mass does to the hover: heights in m, loads as shares.

    Parameters
    ----------
    mission : Mission
    """
    from dataclasses import asdict

    from hoverproof.servo.hover_error import hover_error

    return asdict(hover_error(mission))


def _print_tuned(found: Tuned | Infeasible, written: str | None) -> None:
    from hoverproof.certification.problem import ONES
    from hoverproof.design.outcome import Infeasible
    from hoverproof.mission.writing import decimal

    if isinstance(found, Infeasible):
        print(f"{found.mission.name}: infeasible")
        parts = found.reason.split("; ")
        print("\n".join(f"  {part}{';' if part is not parts[-1] else ''}" for part in parts))
        return
    name, verdict = found.mission.name, found.verdict
    print(f"{name}: tuned for {found.objective}, and proved ({verdict.problem.footing})")
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
    print_hover_error(found.mission)
    print_limits(found.uses)
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
    from hoverproof.design.outcome import Tuned
    from hoverproof.show.atlas import save_pareto_figure

    tuned = [(b, t) for b, t in points if isinstance(t, Tuned)]
    if tuned:
        save_pareto_figure(mission, tuned, path)
    status = 0 if len(tuned) == len(points) else 1
    if json_:
        rows = [{"bandwidth_limit": b, **as_json(t)} for b, t in points]
        print_json(
            {"mission": mission.name, "points": rows, "figure": str(path) if tuned else None},
            mission,
        )
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
