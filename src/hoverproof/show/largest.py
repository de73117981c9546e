"""A picture of the search for the largest tolerance: how full the level is with each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from hoverproof.certification.largest import UNITS, Largest
from hoverproof.show.style import COLOURS, save_figure


def largest_figure(found: Largest) -> Figure:
    """Draw the Lyapunov function at the starts, over the highest level found, by the tolerance.

    Parameters
    ----------
    found : Largest
        From `hoverproof.certification.largest`.
    """
    figure = Figure(figsize=(7, 4.6), layout="constrained")
    axes = figure.subplots()
    value, fill = np.array([(float(v), f) for v, f in found.fills]).T
    some = np.isfinite(fill)
    axes.plot(value[some], fill[some], "o-", color=COLOURS[0], label="highest level found")
    if not some.all():
        top = max(1.1, 1.05 * float(fill[some].max(initial=1)))
        axes.plot(value[~some], np.full((~some).sum(), top), "x", color=COLOURS[1], label="none")
    axes.axhline(1, color="black", linestyle="--", label="the start is inside below this")
    if found.verdict.proved is not None:
        axes.axvline(float(found.value), color=COLOURS[2], label=f"proved: {float(found.value):g}")
    unit = UNITS[found.name]
    axes.set_xlabel(f"uncertainty.{found.name}{f' ({unit})' if unit else ''}")
    axes.set_ylabel("Lyapunov function at the start over the level")
    axes.set_title(f"{found.verdict.mission.name}: the largest {found.name.replace('_', ' ')}")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend()
    return figure


def save_largest_figure(found: Largest, path: Path) -> None:
    """Write the figure as PNG.

    Parameters
    ----------
    found : Largest
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(largest_figure(found), path)
