"""Pictures of design: the curve of decay rate against bandwidth, and maps of what is certified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from hoverproof.design.atlas import VERDICTS
from hoverproof.design.axes import QUANTITIES, Quantity
from hoverproof.design.limits import bandwidth
from hoverproof.design.outcome import Tuned
from hoverproof.mission.sections import Mission
from hoverproof.show.style import COLOURS, Powers, hatched, round_numbers, save_figure
from hoverproof.simulation.record import Recorded

Array = NDArray[np.float64]

DECADES = 3
LABELS = {"margin": "margin (kg/s)", "decay_rate": "decay rate of L (1/s)"}


def pareto_figure(mission: Mission, points: Sequence[tuple[float, Tuned]]) -> Figure:
    """Draw the certified decay rate against the bandwidth, and the mission's own gains.

    Parameters
    ----------
    mission : Mission
    points : sequence of (bandwidth limit in rad/s, what was tuned)
    """
    figure = Figure(figsize=(7.5, 5), layout="constrained")
    axes = figure.subplots()
    fastest = [bandwidth(t.mission) for _, t in points]
    rate = [float(t.verdict.decay_rate) for _, t in points]
    axes.loglog(fastest, rate, "o-", color=COLOURS[0], label="tuned gains, proved")
    before = points[0][1].before
    if before is not None:
        own = bandwidth(mission)
        axes.plot(
            own, float(before), "*", color=COLOURS[1], markersize=13, label="own gains, proved"
        )
    for axis in (axes.xaxis, axes.yaxis):
        round_numbers(axis)
    axes.set_title(f"{mission.title}: what a decay rate costs")
    axes.set_xlabel("attitude bandwidth (k1 k2 + k3 + k4)/m (rad/s)")
    axes.set_ylabel("certified decay rate of L (1/s)")
    axes.grid(alpha=0.3, which="both")
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def save_pareto_figure(mission: Mission, points: Sequence[tuple[float, Tuned]], path: Path) -> None:
    """Write the curve as PNG or SVG.

    Parameters
    ----------
    mission : Mission
    points : sequence of (bandwidth limit in rad/s, what was tuned)
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(pareto_figure(mission, points), path)


def atlas_figure(
    mission: Mission, atlas: Recorded, what: str, printed: NDArray[np.bool_] | None
) -> Figure:
    """Draw an atlas: colours where certified, the boundary, and the mission's own point.

    Parameters
    ----------
    mission : Mission
    atlas : Dataset or Record
        From `hoverproof.atlas`.
    what : str
        "margin" or "decay_rate".
    printed : (m, n), or None
        Where, along y and x, the conditions of the printed theorem are met, if it is about the law.
    """
    figure = Figure(figsize=(7.8, 6.8), layout="constrained")
    axes = figure.subplots()
    handles = draw_atlas(axes, mission, atlas, what, printed)
    title = f"{mission.title}: what is certified"
    if printed is not None and (printed.all() or not printed.any()):
        where = "everywhere" if printed.all() else "nowhere"
        title += f"\nconditions of the printed theorem: met {where} here"
    axes.set_title(title)
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def draw_atlas(
    axes: Axes, mission: Mission, atlas: Recorded, what: str, printed: NDArray[np.bool_] | None
) -> list[Artist]:
    """Draw an atlas on axes, with a bar for its colours, and return what belongs in the legend.

    Parameters
    ----------
    axes : Axes
    mission, atlas, what
        See `atlas_figure`.
    printed : (m, n), or None
        See `atlas_figure`.
    """
    y, x = (str(name) for name in atlas["margin"].dims)
    scales = [str(scale) for scale in atlas.attrs["scales"]]
    across, along = atlas[x].values, atlas[y].values
    margin, shown = atlas["margin"].values, atlas[what].values
    fit_axes(axes, (across, along), scales)
    handles: list[Artist] = []
    if (margin > 0).any():
        good = np.ma.masked_where(~(margin > 0), shown)
        norm = LogNorm(good.max() / 10**DECADES, good.max())
        mesh = axes.pcolormesh(across, along, good, norm=norm, cmap="viridis", shading="nearest")
        mesh.set_rasterized(True)
        figure = axes.figure
        bar = figure.colorbar(
            mesh, ax=axes, label=f"{LABELS[what]}, where certified", extend="min", format=Powers()
        )
        bar.minorformatter = Powers()
    if (margin <= 0).any():
        handles.append(hatched(axes, "refuted (floating point)"))
    if np.isnan(margin).any():
        none = np.ma.masked_where(~np.isnan(margin), np.ones(margin.shape))
        white = axes.pcolormesh(across, along, none, cmap="gray", vmin=0, vmax=1, shading="nearest")
        white.set_rasterized(True)
        handles.append(Patch(facecolor="white", edgecolor="grey", label="no question posed"))
    handles += _boundary(axes, atlas, x, y, scales)
    fit_axes(axes, (across, along), scales)
    if printed is not None and printed.any() and not printed.all():
        handles.append(_printed_area(axes, across, along, printed))
    names, values = (x, y), (across, along)
    handles += own_point(axes, mission, names, values, QUANTITIES)
    label_axes(axes, mission, names, QUANTITIES)
    return handles


def own_point(
    axes: Axes,
    mission: Mission,
    names: tuple[str, str],
    values: tuple[Array, Array],
    known: Mapping[str, Quantity],
) -> list[Artist]:
    """Mark the point of the mission itself, if it lies on the map; return it for the legend.

    Parameters
    ----------
    axes : Axes
    mission : Mission
    names : (x, y)
        Of what varies.
    values : ((n,), (m,))
        Of the cells along x and y, ascending, in the units of the quantities.
    known : mapping of Quantity
        By name, what can vary.
    """
    own = [known[name].value(mission) for name in names]
    if not all(
        v is not None and along[0] <= float(v) <= along[-1]
        for v, along in zip(own, values, strict=True)
    ):
        return []
    return list(
        axes.plot(
            *(float(v) for v in own if v is not None),
            "*",
            color=COLOURS[1],
            markeredgecolor="white",
            markersize=16,
            linestyle="none",
            label="the mission's own point",
        )
    )


def fit_axes(axes: Axes, values: tuple[Array, Array], scales: Sequence[str]) -> None:
    """Let the axes of a map end where its cells do.

    Parameters
    ----------
    axes : Axes
    values : ((n,), (m,))
        Of the cells along x and y, ascending, in the units of the quantities.
    scales : (str, str)
        "log" or "linear".
    """
    x, y = (cell_edges(v, s)[[0, -1]] for v, s in zip(values, scales, strict=True))
    axes.set(xscale=scales[0], yscale=scales[1], xlim=x, ylim=y)
    for axis, scale in zip((axes.xaxis, axes.yaxis), scales, strict=True):
        if scale == "log":
            round_numbers(axis)


def label_axes(
    axes: Axes, mission: Mission, names: tuple[str, str], known: Mapping[str, Quantity]
) -> None:
    """Write on the axes of a map what varies, and in which unit.

    Parameters
    ----------
    axes : Axes
    mission : Mission
    names : (x, y)
        Of what varies.
    known : mapping of Quantity
        By name, what can vary.
    """
    for set_label, name in ((axes.set_xlabel, names[0]), (axes.set_ylabel, names[1])):
        unit = known[name].unit
        set_label(f"{known[name].told(mission)}{'' if unit == '1' else f' ({unit})'}")


def _printed_area(axes: Axes, across: Array, along: Array, printed: NDArray[np.bool_]) -> Artist:
    """Hatch where the conditions of the printed theorem are met; return it for the legend."""
    label = "conditions of the printed theorem (k1…k4) met"
    area = axes.contourf(across, along, printed, levels=[0.5, 1.5], colors="none", hatches=["//"])
    area.set_edgecolor(COLOURS[3])
    area.set_linewidth(0)
    axes.contour(across, along, printed, levels=[0.5], colors=[COLOURS[3]], linewidths=1.5)
    return Patch(facecolor="none", edgecolor=COLOURS[3], hatch="//", label=label)


def _boundary(axes: Axes, atlas: Recorded, x: str, y: str, scales: list[str]) -> list[Artist]:
    """Draw where certified turns into refuted: between cells decided exactly, or a contour."""
    margin, verdict = atlas["margin"].values, atlas["verdict"].values
    decided = (verdict == VERDICTS["proved"]).any() and (verdict == VERDICTS["refuted"]).any()
    if not decided:
        if not ((margin > 0).any() and (margin < 0).any()):
            return []
        axes.contour(
            atlas[x].values, atlas[y].values, margin, levels=[0], colors="black", linewidths=1.5
        )
        return [Line2D([], [], color="black", label="boundary (floating point)")]
    edges = [
        cell_edges(atlas[name].values, scale) for name, scale in zip((x, y), scales, strict=True)
    ]
    lines = []
    for i, j in np.argwhere(verdict[:, 1:] * verdict[:, :-1] == -1):
        lines.append([(edges[0][j + 1], edges[1][i]), (edges[0][j + 1], edges[1][i + 1])])
    for i, j in np.argwhere(verdict[1:] * verdict[:-1] == -1):
        lines.append([(edges[0][j], edges[1][i + 1]), (edges[0][j + 1], edges[1][i + 1])])
    axes.add_collection(LineCollection(lines, colors="black", linewidths=1.5))
    return [Line2D([], [], color="black", label="boundary, decided exactly on both sides")]


def cell_edges(values: Array, scale: str) -> Array:
    """Return the edges of cells about values, (n + 1,), in their unit.

    Parameters
    ----------
    values : (n,)
        Ascending, in any unit.
    scale : str
        "log" or "linear".
    """
    v = np.log(values) if scale == "log" else values
    middle = (v[1:] + v[:-1]) / 2
    edges = np.concatenate([[2 * v[0] - middle[0]], middle, [2 * v[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if scale == "log" else edges)


def save_atlas_figure(
    mission: Mission, atlas: Recorded, what: str, printed: NDArray[np.bool_] | None, path: Path
) -> None:
    """Write the map as PNG or SVG.

    Parameters
    ----------
    mission, atlas, what
        See `atlas_figure`.
    printed : (m, n), or None
        See `atlas_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(atlas_figure(mission, atlas, what, printed), path)
