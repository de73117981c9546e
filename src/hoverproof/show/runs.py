"""Pictures of many flights: how they spread over time, where they started and how they ended.

Runs are a Dataset in the way of a flight's, with a dimension ``run`` in front:

================  ==================  =====================================================
variable          dimensions          meaning
================  ==================  =====================================================
position          (run, time, axis)   world frame, m; missing after a run has ended
euler_angles      (run, time, angle)  rad
lyapunov          (run, time)         L, without unit
rotor_thrust      (run, time, rotor)  N
outcome           (run,)              text, or a number with CF's ``flag_values`` and
                                      ``flag_meanings``; ``flown`` is a whole flight, and runs
                                      that are ``not_flown`` are left out; by default all flown
settled_at        (run,)              s, missing if never; by default found in the positions
start_position    (run, axis)         m; by default the first of the positions
final_error       (run,)              m; by default the distance at the last position
================  ==================  =====================================================

with the attributes ``mission`` and ``goal_position`` of a flight. Only ``position`` must be there:
a panel of what is not is left out. It may lie in a file larger than memory: a variable is read a
block of runs after the other, and thinned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hoverproof.show.image_plane import DEGREES
from hoverproof.show.scene import FLOWN, Array, Scene
from hoverproof.show.style import (
    COLOURS,
    STYLES,
    legend_above,
    plain_powers,
    round_numbers,
    save_figure,
)
from hoverproof.simulation.numbers import SETTLED

RUNS_FIGURES = ("fans", "starts")

NOT_FLOWN = "not_flown"
SETTLES, STAYS_AWAY = "settled", "flown, not settled"
BAND = (5, 50, 95)
MOST_TIMES = 300
BLOCK = 2048
SINGLE_RUNS = 20
MARKERS = "osX^DvP*"


def fans_figure(runs: xr.Dataset, first: xr.Dataset | None = None) -> Figure:
    """Draw median, 5-95 % band and a few runs of what was recorded over time.

    Parameters
    ----------
    runs : Dataset
        See the head of this module.
    first : Dataset, optional
        Their beginning in more samples, of which tilt and rotor thrusts are drawn; see
        `hoverproof.show.runs_again`.
    """
    runs = _thinned(runs)
    first = runs if first is None else _thinned(first)
    outcome = outcomes(runs)
    panels = [
        (draw, of)
        for name, draw, of in (
            ("position", _distance, runs),
            ("lyapunov", _level, runs),
            ("position", _settled_share, runs),
            ("position", _position, runs),
            ("euler_angles", _tilt, first),
            ("rotor_thrust", _rotors, first),
        )
        if name in runs
    ]
    rows = -(-len(panels) // 3)
    figure = Figure(figsize=(13, 0.8 + 3.7 * rows), layout="constrained")
    shown = min(SINGLE_RUNS, runs.sizes["run"])
    apart = _apart(runs)
    title = f"{_title(runs)}: median, 5 to 95 % band, and {shown} single runs"
    title += f", a sample each {apart:g} s" if apart else ""
    early = int(sum(o != FLOWN for o in outcome))
    if early:
        title += f"\n{early} ended early, and leave the bands when they end"
    figure.suptitle(title)
    for k, (draw, of) in enumerate(panels):
        axes = figure.add_subplot(rows, 3, k + 1)
        draw(axes, of)
        axes.set_xlabel("time (s)" if of is runs else _early_label(runs, of))
        legend_above(axes, 3)
    return figure


def starts_figure(runs: xr.Dataset) -> Figure:
    """Draw where the runs started, coloured by how they ended, and how far from the goal.

    Parameters
    ----------
    runs : Dataset
        See the head of this module.
    """
    runs = _flown(runs)
    scene, start = Scene.of(runs), _start(runs)
    kinds = _kinds(runs)
    figure = Figure(figsize=(13, 5), layout="constrained")
    figure.suptitle(f"{_title(runs)}: starts by outcome, and errors at the end")
    plan, side, ends = figure.subplots(1, 3)
    names = sorted(set(kinds), key=lambda kind: (-(kinds == kind).sum(), kind))
    faint = float(np.clip(30 / np.sqrt(len(kinds)), 0.15, 0.9))
    looks = _looks(names)
    for axes, (i, j) in ((plan, (0, 1)), (side, (0, 2))):
        for name in names:  # the rare ones last, on top
            own = kinds == name
            colour, marker = looks[name]
            axes.plot(
                start[own, i],
                start[own, j],
                marker,
                color=colour,
                markersize=4,
                alpha=faint,
                markeredgewidth=0,
                label=f"{name}: {own.sum()}",
            )
        axes.plot(*scene.points[:, [i, j]].T, "s", color="black", fillstyle="none", label="target")
        axes.plot(*scene.goal[[i, j]], "*", color="black", markersize=12, label="goal")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel("x of the start (m)")
        axes.invert_yaxis()
    plan.set_ylabel("y of the start (m)")
    side.set_ylabel("z of the start (m), down")
    plan.set_title("from above", fontsize="medium")
    side.set_title("from the side", fontsize="medium")
    error = _final_error(runs)
    for name in names:
        values = np.sort(error[kinds == name])
        share = np.arange(1, len(values) + 1) / len(kinds) * 100
        ends.step(values, share, where="post", color=looks[name][0], marker=".", markersize=3)
    ends.set_xscale("log")
    round_numbers(ends.xaxis)
    ends.set_ylim(0, 100)
    ends.set_xlabel("distance from the goal at the end (m)")
    ends.set_ylabel("runs that end nearer (% of all)")
    for axes in (plan, side, ends):
        axes.grid(alpha=0.3)
    handles, labels = plan.get_legend_handles_labels()
    legend = figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    for handle in legend.legend_handles:
        if handle is not None:
            handle.set_alpha(1)
    return figure


def save_runs_figures(
    runs: xr.Dataset,
    stem: Path,
    which: Sequence[str] = RUNS_FIGURES,
    first: xr.Dataset | None = None,
) -> list[Path]:
    """Write the figures of runs as PNG files beside each other.

    Parameters
    ----------
    runs : Dataset
        See the head of this module.
    stem : Path
        Path without its ending; ``.fans.png`` and ``.starts.png`` are appended.
    which : sequence of str
        Some of `RUNS_FIGURES`.
    first : Dataset, optional
        See `fans_figure`.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    draw: dict[str, Callable[[xr.Dataset], Figure]] = {
        "fans": lambda runs: fans_figure(runs, first),
        "starts": starts_figure,
    }
    paths: list[Path] = []
    if not (outcomes(runs) != NOT_FLOWN).any():
        return paths
    for name in which:
        path = stem.with_name(f"{stem.name}.{name}.png")
        save_figure(draw[name](runs), path)
        paths.append(path)
    return paths


def outcomes(runs: xr.Dataset) -> np.ndarray:
    """Return the outcome of each run as text, (run,).

    Parameters
    ----------
    runs : Dataset
        Many flights.
    """
    if "outcome" not in runs:
        return np.full(runs.sizes["run"], FLOWN, object)
    recorded = runs["outcome"]
    if "flag_meanings" not in recorded.attrs:
        return recorded.values.astype(object)
    values = np.atleast_1d(recorded.attrs["flag_values"]).tolist()
    names = dict(zip(values, str(recorded.attrs["flag_meanings"]).split(), strict=True))
    return np.array([names[int(v)] for v in recorded.values], object)


def settled_times(runs: xr.Dataset) -> Array:
    """Return when each run came within 10 % of its distance at the start for good, s.

    NaN for those that did not, or ended early.

    Parameters
    ----------
    runs : Dataset
        Many flights.
    """
    if "settled_at" in runs:
        found = runs["settled_at"].values.astype(float)
    else:
        distance, times = _distances(runs), runs["time"].values
        outside = ~(distance <= SETTLED * distance[:, :1])
        last = distance.shape[1] - 1 - outside[:, ::-1].argmax(axis=1)
        reached = outside.any(axis=1) & (last + 1 < len(times))
        found = np.where(reached, times[np.minimum(last + 1, len(times) - 1)], np.nan)
    return np.where(outcomes(runs) == FLOWN, found, np.nan)


def _flown(runs: xr.Dataset) -> xr.Dataset:
    flown = outcomes(runs) != NOT_FLOWN
    return runs if flown.all() else runs.isel(run=np.nonzero(flown)[0])


def _thinned(runs: xr.Dataset) -> xr.Dataset:
    """Return the runs that were flown, at no more than `MOST_TIMES` times, the last among them."""
    last = runs.sizes["time"] - 1
    kept = np.unique(np.linspace(0, last, min(MOST_TIMES, last + 1)).round().astype(int))
    return _flown(runs).isel(time=kept)


def _apart(runs: xr.Dataset) -> float:
    """Return the time between two samples, s."""
    return float(np.diff(runs["time"].values[:2]).sum())


def _early_label(runs: xr.Dataset, first: xr.Dataset) -> str:
    """Label the time of the beginning of runs, or of some of them."""
    count = first.sizes["run"]
    of = f"the first {count} runs" if count < runs.sizes["run"] else "the beginning"
    return f"{of}, a sample each {_apart(first):g} s: time (s)"


def _title(runs: xr.Dataset) -> str:
    return f"{Scene.of(runs).title}, {runs.sizes['run']} runs"


def _series(runs: xr.Dataset, name: str, reduce: Callable[[Array], Array]) -> Array:
    """Return what `reduce` makes of (runs, time, ...), as (runs, time), read block by block."""
    count = runs.sizes["run"]
    return np.vstack(
        [
            reduce(runs[name].isel(run=slice(k, k + BLOCK)).values).astype(np.float32)
            for k in range(0, count, BLOCK)
        ]
    )


def _distances(runs: xr.Dataset) -> Array:
    goal = Scene.of(runs).goal
    return _series(runs, "position", lambda p: np.linalg.norm(p - goal, axis=-1))


def _bands(values: Array) -> Array:
    """Return percentiles `BAND` of the runs that still fly, (3, time); NaN where none does."""
    columns = [column[np.isfinite(column)] for column in values.T]
    none = np.full(len(BAND), np.nan)
    return np.array([np.percentile(c, BAND) if c.size else none for c in columns]).T


def _fan(
    axes: Axes, times: Array, values: Array, *, colour: str, label: str, style: str = "-"
) -> None:
    """Draw the band, the median and evenly chosen single runs of (runs, time)."""
    low, middle, high = _bands(values)
    chosen = np.linspace(0, len(values) - 1, min(SINGLE_RUNS, len(values))).astype(int)
    axes.fill_between(times, low, high, color=colour, alpha=0.25, linewidth=0)
    axes.plot(times, values[np.unique(chosen)].T, color=colour, linewidth=0.4, alpha=0.6)
    axes.plot(times, middle, style, color=colour, linewidth=2, label=label)


def _distance(axes: Axes, runs: xr.Dataset) -> None:
    _fan(axes, runs["time"].values, _distances(runs), colour=COLOURS[0], label="median")
    axes.set_yscale("log")
    round_numbers(axes.yaxis)
    axes.set_ylabel("distance from the goal (m)")


def _level(axes: Axes, runs: xr.Dataset) -> None:
    values = _series(runs, "lyapunov", np.asarray)
    _fan(axes, runs["time"].values, values, colour=COLOURS[3], label="median")
    axes.set_yscale("log")
    plain_powers(axes.yaxis)
    axes.set_ylabel("L (dimensionless)")


def _settled_share(axes: Axes, runs: xr.Dataset) -> None:
    settled, times = settled_times(runs), runs["time"].values
    flying = np.isfinite(_axis(runs, 0)).mean(axis=0)
    arrived = np.array([(settled <= t).mean() for t in times])
    within = f"settled within {SETTLED * 100:.0f} %"
    axes.step(times, 100 * flying, "--", where="post", color="black", label="still flying")
    axes.step(times, 100 * arrived, where="post", color=COLOURS[2], linewidth=2, label=within)
    axes.set_ylim(-3, 103)
    axes.set_ylabel("share of the runs (%)")


def _axis(runs: xr.Dataset, i: int) -> Array:
    """Return one coordinate of the positions, (run, time), m."""

    def coordinate(places: Array) -> Array:
        return places[..., i]

    return _series(runs, "position", coordinate)


def _position(axes: Axes, runs: xr.Dataset) -> None:
    for i, axis in enumerate("xyz"):
        values = _axis(runs, i)
        label = "z (down)" if axis == "z" else axis
        _fan(axes, runs["time"].values, values, colour=COLOURS[i], label=label, style=STYLES[i])
    axes.set_ylabel("position (m)")


def _tilt(axes: Axes, runs: xr.Dataset) -> None:
    def tilt(angles: Array) -> Array:
        """Of R₃₃ = cos(roll) cos(pitch), through half the angle, which keeps small ones exact."""
        roll, pitch = np.asarray(angles[..., 0], float), np.asarray(angles[..., 1], float)
        half = np.sin(roll / 2) ** 2 * np.cos(pitch) + np.sin(pitch / 2) ** 2
        return np.asarray(2 * DEGREES * np.arcsin(np.sqrt(np.clip(half, 0, 1))), np.float64)

    values = _series(runs, "euler_angles", tilt)
    _fan(axes, runs["time"].values, values, colour=COLOURS[1], label="median")
    axes.set_ylabel("tilt (deg)")


def _rotors(axes: Axes, runs: xr.Dataset) -> None:
    times = runs["time"].values
    highest = _series(runs, "rotor_thrust", lambda t: np.asarray(t.max(axis=-1)))
    lowest = _series(runs, "rotor_thrust", lambda t: np.asarray(t.min(axis=-1)))
    _fan(axes, times, highest, colour=COLOURS[4], label="highest of the rotors")
    _fan(axes, times, lowest, colour=COLOURS[5], label="lowest", style="--")
    axes.set_ylabel("rotor thrust (N)")
    axes.ticklabel_format(axis="y", useOffset=False)


def _start(runs: xr.Dataset) -> Array:
    if "start_position" in runs:
        return np.asarray(runs["start_position"].values, np.float64)
    return np.asarray(runs["position"].isel(time=0).values, np.float64)


def _final_error(runs: xr.Dataset) -> Array:
    if "final_error" in runs:
        return np.asarray(runs["final_error"].values, np.float64)
    distance = _distances(runs)
    last = np.isfinite(distance).cumsum(axis=1).argmax(axis=1)
    return np.asarray(distance[np.arange(len(distance)), last], np.float64)


def _kinds(runs: xr.Dataset) -> np.ndarray:
    """Return how each run ended, in words, (run,)."""
    settled = np.isfinite(settled_times(runs))
    return np.array(
        [
            (SETTLES if done else STAYS_AWAY) if o == FLOWN else str(o).replace("_", " ")
            for o, done in zip(outcomes(runs), settled, strict=True)
        ],
        object,
    )


def _looks(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return a colour and a marker for each way to end."""
    others = [n for n in sorted(names) if n not in (SETTLES, STAYS_AWAY)]
    order = [SETTLES, STAYS_AWAY, *others]
    return {n: (COLOURS[i % len(COLOURS)], MARKERS[i % len(MARKERS)]) for i, n in enumerate(order)}
