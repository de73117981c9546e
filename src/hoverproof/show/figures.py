"""Pictures of one flight, put together from `panels`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hoverproof.show import panels
from hoverproof.show.decay import Decay
from hoverproof.show.image_plane import draw_image
from hoverproof.show.scene import Flight, Scene
from hoverproof.show.style import save_figure
from hoverproof.simulation.record import Record

FIGURES = ("motion", "features", "path")


def motion_figure(flight: Flight, first: Flight | None = None) -> Figure:
    """Draw position, attitude (paper, Fig. 5), rotor thrusts and required view over time.

    Where attitude and rotors come to rest long before the end, their beginning stands alongside.

    Parameters
    ----------
    flight : Dataset or Record
        From `hoverproof.simulate` or `flown`.
    first : Dataset or Record, optional
        That beginning in more samples; see `panels.beginning`.
    """
    drawn = (panels.position, panels.attitude, panels.rotor_forces, panels.required_view)
    early = panels.beginning(flight)
    columns = 1 if early is None else 2
    figure = Figure(figsize=(7 + 4 * (columns - 1), 10), layout="constrained")
    figure.suptitle(Scene.of(flight).titled("motion"))
    widths = (1.5, 1)[:columns]
    axes = figure.subplots(len(drawn), columns, sharex="col", squeeze=False, width_ratios=widths)
    for row, draw in zip(axes, drawn, strict=True):
        draw(row[0], flight)
    axes[-1, 0].set_xlabel("time (s)")
    if early is not None:
        start = _until(flight, early) if first is None else first
        for row, draw in zip(axes, drawn, strict=True):
            draw(row[1], start)
            row[1].get_legend().remove()
            row[1].set_ylabel("")
        title = f"the first {early:g} s, a sample each {start['time'].values[1]:g} s"
        axes[0, 1].set_title(title, fontsize="medium")
        apart = f"a sample each {flight['time'].values[1]:g} s"
        axes[0, 0].set_title(apart, loc="right", fontsize="medium")
        axes[-1, 1].set_xlabel("time (s)")
    figure.align_ylabels(axes[:, 0])
    return figure


def features_figure(flight: Flight, decay: Decay | None = None) -> Figure:
    """Draw the image points' tracks, and the errors and L over time.

    Parameters
    ----------
    flight : Dataset or Record
        From `hoverproof.simulate` or `flown`.
    decay : Decay, optional
        Proved for this flight; drawn as a line beside L.
    """
    figure = Figure(figsize=(11, 5.4), layout="constrained")
    figure.suptitle(Scene.of(flight).titled("image features and errors"))
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
    draw_image(left, flight)
    panels.errors(right, flight, decay)
    return figure


def path_figure(flight: Flight) -> Figure:
    """Draw the path in space (paper, Fig. 4), from above and from the side.

    Parameters
    ----------
    flight : Dataset or Record
        From `hoverproof.simulate` or `flown`.
    """
    figure = Figure(figsize=(12.2, 5.2), layout="constrained")
    figure.suptitle(Scene.of(flight).titled("path over the target"))
    grid = figure.add_gridspec(1, 3, width_ratios=(1.4, 1, 1), wspace=0.18)
    space = figure.add_subplot(grid[0], projection="3d")
    panels.path(space, flight)
    space.get_legend().remove()
    labels = space.get_legend_handles_labels()
    figure.legend(*labels, loc="outside lower center", ncols=6, frameon=False)
    panels.from_above(figure.add_subplot(grid[1]), flight)
    panels.from_the_side(figure.add_subplot(grid[2]), flight)
    return figure


def save_figures(
    flight: Flight,
    stem: Path,
    which: Sequence[str] = FIGURES,
    decay: Decay | None = None,
    first: Flight | None = None,
) -> list[Path]:
    """Write figures of a flight as PNG files beside each other.

    Parameters
    ----------
    flight : Dataset or Record
    stem : Path
        Path without its ending; ``.motion.png`` and so on are appended.
    which : sequence of str
        Some of `FIGURES`.
    decay : Decay, optional
        See `features_figure`.
    first : Dataset or Record, optional
        See `motion_figure`.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    draw = {
        "motion": lambda: motion_figure(flight, first),
        "features": lambda: features_figure(flight, decay),
        "path": lambda: path_figure(flight),
    }
    paths = []
    for name in which:
        path = stem.with_name(f"{stem.name}.{name}.png")
        save_figure(draw[name](), path)
        paths.append(path)
    return paths


def _until(flight: Flight, time: float) -> Flight:
    """Return the part of a flight up to a time in s."""
    if isinstance(flight, Record):
        return flight.until(time)
    return flight.isel(time=flight["time"].values <= time)
