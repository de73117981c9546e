"""Pictures of maps of when the start of a mission has settled, for every vehicle covered."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from hoverproof.design.axes import OF_START
from hoverproof.design.start_atlas import NOT_PROVED, PROVED
from hoverproof.mission.sections import Mission
from hoverproof.show.atlas import fit_axes, label_axes, own_point
from hoverproof.show.style import hatched, save_figure
from hoverproof.simulation.record import Recorded

SLOWEST = 6
"""Times are told apart up to so many times the shortest."""
ROUND = (1, 1.5, 2, 3, 4, 5, 6, 8)
"""What stands at the bar of colours, times a power of ten."""


def start_atlas_figure(mission: Mission, atlas: Recorded) -> Figure:
    """Draw a map: settling times where they are found, and which cells are proved.

    Parameters
    ----------
    mission : Mission
    atlas : Dataset or Record
        From `hoverproof.atlas` with the theorem "start".
    """
    figure = Figure(figsize=(5.6, 5.6), layout="constrained")  # to be read 390 px wide, too
    axes = figure.subplots()
    handles = draw_start_atlas(axes, mission, atlas)
    axes.set_title(f"{mission.name}: its start, every vehicle covered")
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize="small")
    return figure


def draw_start_atlas(axes: Axes, mission: Mission, atlas: Recorded) -> list[Artist]:
    """Draw a map on axes, with a bar for its colours, and return what belongs in the legend.

    Parameters
    ----------
    axes : Axes
    mission, atlas
        See `start_atlas_figure`.
    """
    y, x = (str(name) for name in atlas["settling_time"].dims)
    across, along = atlas[x].values, atlas[y].values
    time, verdict = atlas["settling_time"].values, atlas["verdict"].values
    handles: list[Artist] = []
    if not np.isnan(time).all():
        first = float(np.nanmin(time))
        mesh = axes.pcolormesh(
            across,
            along,
            np.ma.masked_invalid(time),
            norm=LogNorm(first, SLOWEST * first),
            cmap="viridis_r",
            shading="nearest",
        )
        mesh.set_rasterized(True)
        bar = axes.figure.colorbar(
            mesh, ax=axes, label="settled after (s), found by search", extend="max"
        )
        powers = 10.0 ** (math.floor(math.log10(first)) + np.arange(2))
        ticks = [t for t in np.outer(powers, ROUND).ravel() if first <= t <= SLOWEST * first]
        bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        bar.minorticks_off()
    if np.isnan(time).any():
        handles.append(hatched(axes, "no weights found (not refuted)"))
    for code, mark, words in ((PROVED, "o", "proved exactly"), (NOT_PROVED, "x", "not confirmed")):
        rows, columns = np.nonzero(verdict == code)
        if len(rows):
            handles += axes.plot(
                across[columns],
                along[rows],
                mark,
                color="white" if code == PROVED else "black",
                markeredgecolor="black",
                markersize=5,
                linestyle="none",
                label=words,
            )
    handles += own_point(axes, mission, (x, y), (across, along), OF_START)
    scale_x, scale_y = (str(scale) for scale in atlas.attrs["scales"])
    fit_axes(axes, (across, along), (scale_x, scale_y))
    label_axes(axes, mission, (x, y), OF_START)
    return handles


def save_start_atlas_figure(mission: Mission, atlas: Recorded, path: Path) -> None:
    """Write the map as PNG or SVG.

    Parameters
    ----------
    mission, atlas
        See `start_atlas_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(start_atlas_figure(mission, atlas), path)
