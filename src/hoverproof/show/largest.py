"""A picture of the search for the largest tolerance: how full the level is with each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from hoverproof.certification.largest import Largest
from hoverproof.mission.tolerances import UNITS
from hoverproof.show.style import COLOURS, save_figure


def largest_figure(found: Largest) -> Figure:
    """Draw the Lyapunov function at the starts, over the highest level found, by the tolerance.

    Parameters
    ----------
    found : Largest
        From `hoverproof.certification.largest`.
    """
    figure = Figure(figsize=(5.2, 4.4), layout="constrained")  # to be read 390 px wide, too
    axes = figure.subplots()
    value, fill = np.array([(float(v), 100 * f) for v, f in found.fills]).T
    some, unit = np.isfinite(fill), f" {UNITS[found.name]}".rstrip()
    found_at = axes.plot(value[some], fill[some], "o-", color=COLOURS[0], clip_on=False, zorder=3)
    found_at[0].set_label("of the highest level found")
    if found.verdict.proved is not None:
        most = float(found.value)
        axes.axvspan(0, most, color=COLOURS[2], alpha=0.15, lw=0)
        axes.axvline(most, color=COLOURS[2], label=f"proved up to {most:g}{unit}")
    if not some.all():
        top = max(110, 1.05 * float(fill[some].max(initial=100)))
        axes.plot(value[~some], np.full((~some).sum(), top), "x", color=COLOURS[1], label="none")
    axes.axhline(100, color="black", linestyle="--", label="the start is inside below")
    axes.set_xlabel(f"uncertainty.{found.name}{f' ({unit.strip()})' if unit else ''}")
    axes.set_ylabel("Ψ at the start, % of the level")
    words = found.name.replace("_", " ").replace(".", " of the ")
    axes.set_title(f"{found.verdict.mission.name}: the largest {words}")
    axes.set_ylim(0, max(110, axes.get_ylim()[1]))
    axes.set_xlim(left=0)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=2, fontsize="small")
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
