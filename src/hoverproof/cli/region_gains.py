"""What `tune --objective region` answers: gains, and how far hovers are certified."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.console import number, print_json

if TYPE_CHECKING:
    from hoverproof.certification.attraction.verdict import Proved
    from hoverproof.design.outcome import Infeasible, RegionTuned, Tuned
    from hoverproof.mission.sections import Mission

WAYS = ("sideways", "up", "down")


def note(found: RegionTuned) -> str:
    """Return a line for the head of a mission file.

    Parameters
    ----------
    found : RegionTuned
    """
    return f"certified hovers about the goal: {_reach(found.region)}"


def certificate_path(out: str) -> Path:
    """Return where the certificate of a mission file goes.

    Parameters
    ----------
    out : str
        The mission file.
    """
    return Path(out).with_suffix(".attraction.cert.json")


def print_tuned(found: RegionTuned, written: str | None, json_: bool) -> int:
    """Print what was tuned, for people or machines; return the exit status.

    Parameters
    ----------
    found : RegionTuned
    written : str or None
        The mission file that was written.
    json_ : bool
    """
    from hoverproof.cli.tuning import GAIN_UNITS, print_hover_error, print_limits
    from hoverproof.mission.writing import decimal

    certificate = None if written is None else str(certificate_path(written))
    if json_:
        print_json(as_json(found) | {"out": written, "certificate": certificate}, found.mission)
        return 0
    print(f"{found.mission.name}: tuned for the region of attraction, and proved")
    for key, value in found.mission.gains:
        print(f"  {key:6} = {decimal(value):12} {GAIN_UNITS[key]}")
    print(f"  certified hovers        {_reach(found.region)} of the goal")
    own = "not proved" if found.before is None else _reach(found.before)
    print(f"    the mission's own gains: {own}")
    times = found.slowest_rate / found.slowest_rate_before
    print(
        f"  slowest motion at goal  {number(found.slowest_rate)} 1/s, "
        f"{times:.2f} times that of the own gains"
    )
    print(f"    time constant:           {number(1 / found.slowest_rate)} s (linearised)")
    rate = found.decay_rate
    decay = "not proved" if rate is None else f"{number(rate)} 1/s, proved"
    print(f"  decay rate of L         {decay} with the bounds of this mission")
    print_hover_error(found.mission)
    print_limits(found.uses)
    if written is None:
        print("Next: the same with --out FILE.toml writes a mission file and its certificate")
    else:
        print(f"  written to              {written}")
        print(f"  certificate             {certificate}")
        print(f"Next: hoverproof check {certificate}")
    return 0


def _reach(region: Proved) -> str:
    far = [number(getattr(region.reach, way)) for way in WAYS]
    return f"{far[0]} m sideways, {far[1]} m up, {far[2]} m down"


def as_json(found: RegionTuned) -> dict[str, Any]:
    """Return what was tuned as an object for machines.

    Parameters
    ----------
    found : RegionTuned
    """
    from hoverproof.cli.tuning import GAIN_UNITS, hover_error_as_json, limits_as_json
    from hoverproof.design.limits import bandwidth

    def reach(region: Proved | None) -> dict[str, float] | None:
        return None if region is None else {w: float(getattr(region.reach, w)) for w in WAYS}

    def real(value: Any) -> float | None:
        return None if value is None else float(value)

    return {
        "mission": found.mission.name,
        "status": found.status,
        "objective": found.objective,
        "gains": {k: float(v) for k, v in found.mission.gains},
        "reach": reach(found.region),
        "reach_before": reach(found.before),
        "level": float(found.region.level),
        "weights": [float(a) for a in found.region.weights],
        "slowest_rate": found.slowest_rate,
        "slowest_rate_before": found.slowest_rate_before,
        "time_constant": 1 / found.slowest_rate,
        "time_constant_before": 1 / found.slowest_rate_before,
        "decay_rate": real(found.decay_rate),
        "decay_rate_before": real(found.decay_rate_before),
        "bandwidth": bandwidth(found.mission),
        "limits": limits_as_json(found.uses),
        "binds": [use.name for use in found.uses if use.binds],
        "hover_error": hover_error_as_json(found.mission),
        "units": {
            **GAIN_UNITS,
            "reach": "m from the goal",
            "level": "m",
            "weights": "m",
            "slowest_rate": "1/s",
            "time_constant": "s",
            "decay_rate": "1/s",
            "bandwidth": "rad/s",
        },
    }


def print_curve(
    mission: Mission,
    points: Sequence[tuple[float, Tuned | RegionTuned | Infeasible]],
    path: Path,
    json_: bool,
) -> int:
    """Draw the regions against the rate of the slowest motion, print them; return the exit status.

    Parameters
    ----------
    mission : Mission
    points : sequence of (least rate in 1/s, what was tuned)
    path : Path
        Of the figure.
    json_ : bool
    """
    from hoverproof.cli.tuning import as_json as infeasible_as_json
    from hoverproof.design.outcome import RegionTuned
    from hoverproof.show.attraction import save_trade_off_figure

    tuned = [(rate, t) for rate, t in points if isinstance(t, RegionTuned)]
    if tuned:
        save_trade_off_figure([t.region for _, t in tuned], tuned[0][1].before, path)
    status = 0 if len(tuned) == len(points) else 1
    if json_:
        rows = [
            {"minimum_decay": rate}
            | (as_json(t) if isinstance(t, RegionTuned) else infeasible_as_json(t))
            for rate, t in points
        ]
        figure = str(path) if tuned else None
        print_json({"mission": mission.name, "points": rows, "figure": figure}, mission)
        return status
    print(f"{mission.name}: certified hovers against the slowest motion at the goal")
    heads = ("1/s", "sideways m", "up m", "down m", "k1", "k2", "k3", "k4")
    print(
        "  " + "  ".join(f"{head:>10}" if i < 4 else f"{head:>6}" for i, head in enumerate(heads))
    )
    for rate, t in points:
        if not isinstance(t, RegionTuned):
            print(f"  {number(rate):>10}  {t.status}: {getattr(t, 'reason', '')}")
            continue
        row = [t.slowest_rate, *(getattr(t.region.reach, way) for way in WAYS)]
        g = t.mission.gains
        cells = [f"{number(x):>10}" for x in row]
        cells += [f"{number(k):>6}" for k in (g.k1, g.k2, g.k3, g.k4)]
        print("  " + "  ".join(cells))
    if tuned:
        print(f"  figure  {path}")
    return status
