"""Pictures of a flight."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hoverproof.files import replacing

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, told apart by the colour-blind."""

STYLES = ("-", "--", "-.", ":")


def motion_figure(flight: xr.Dataset) -> Figure:
    """Draw position and attitude over time.

    Parameters
    ----------
    flight : Dataset
        From `hoverproof.simulate`.
    """
    figure = Figure(figsize=(8, 6), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    figure.suptitle(f"{_name(flight)}: position and attitude")
    goal = flight.attrs["goal_position"]
    for i, axis in enumerate("xyz"):
        _line(above, flight, flight["position"].sel(axis=axis), i, axis)
        above.axhline(goal[i], color=COLOURS[i], linewidth=0.7, alpha=0.6)
    above.set_ylabel("position, world frame (m)")
    above.text(0.99, 0.02, "z down; thin lines: goal", transform=above.transAxes, ha="right")
    for i, angle in enumerate(("roll", "pitch", "yaw")):
        _line(below, flight, flight["euler_angles"].sel(angle=angle) * (180 / np.pi), i, angle)
    below.set_ylabel("Euler angles (deg)")
    below.set_xlabel("time (s)")
    for axes in (above, below):
        _finish(axes)
    return figure


def features_figure(flight: xr.Dataset) -> Figure:
    """Draw the image points' tracks, and the errors and L over time.

    Parameters
    ----------
    flight : Dataset
        From `hoverproof.simulate`.
    """
    figure = Figure(figsize=(10, 5), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.3))
    figure.suptitle(f"{_name(flight)}: image features and errors")
    for i, point in enumerate(flight["point"].values):
        track = flight["image"].sel(point=point)
        x, y = track.sel(image_axis="x"), track.sel(image_axis="y")
        colour = COLOURS[i % len(COLOURS)]
        left.plot(x, y, color=colour, linewidth=1.2)
        left.plot(x[0], y[0], "o", color=colour, fillstyle="none")
        left.plot(x[-1], y[-1], "x", color=colour)
    left.plot([], [], "o", color="black", fillstyle="none", label="start")
    left.plot([], [], "x", color="black", label="end")
    left.set_xlabel("image x = X/Z (focal length 1)")
    left.set_ylabel("image y = Y/Z (focal length 1)")
    left.set_aspect("equal", adjustable="datalim")
    left.invert_yaxis()

    for i in range(4):
        name = f"delta{i + 1}"
        size = np.linalg.norm(flight[name].values, axis=1)
        right.semilogy(
            flight["time"], size, STYLES[i], color=COLOURS[i], label=f"|δ{i + 1}|", linewidth=1.3
        )
    right.semilogy(flight["time"], flight["lyapunov"], color="black", linewidth=1.8, label="L")
    largest = float(flight["lyapunov"].max())
    right.set_ylim(1e-12 * largest, 10 * largest)
    right.set_xlabel("time (s)")
    right.set_ylabel("errors and L (dimensionless)")
    for axes in (left, right):
        _finish(axes)
    return figure


def save_figures(flight: xr.Dataset, stem: Path) -> list[Path]:
    """Write both figures of a flight as PNG files beside each other.

    Parameters
    ----------
    flight : Dataset
    stem : Path
        Path without its ending; ``.motion.png`` and ``.features.png`` are appended.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    paths = []
    for name, draw in (("motion", motion_figure), ("features", features_figure)):
        path = stem.with_name(f"{stem.name}.{name}.png")
        with replacing(path) as beside:
            draw(flight).savefig(beside, dpi=130, format="png")
        paths.append(path)
    return paths


def _line(axes: Axes, flight: xr.Dataset, values: xr.DataArray, i: int, label: str) -> None:
    axes.plot(flight["time"], values, STYLES[i], color=COLOURS[i], label=label, linewidth=1.5)


def _finish(axes: Axes) -> None:
    axes.grid(alpha=0.3)
    axes.legend(loc="best", framealpha=0.8)


def _name(flight: xr.Dataset) -> str:
    return str(flight.attrs["title"]).removeprefix("closed-loop flight of ")
