"""Draw the findings of an audit over time, each against its bound."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from hoverproof.audit.finding import Finding
from hoverproof.show.style import COLOURS

POINTS = 1500


def findings_figure(findings: list[Finding]) -> Figure:
    """Draw what was found over time, a panel each.

    Parameters
    ----------
    findings : list of Finding
        With at least one that is told over time.
    """
    drawn = [f for f in findings if f.times is not None and f.values is not None]
    rows = -(-len(drawn) // 2)
    figure = Figure(figsize=(10, 1.9 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, 2, squeeze=False)).ravel()
    for axes, f in zip(panels, drawn, strict=False):
        assert f.times is not None and f.values is not None
        step = max(1, len(f.times) // POINTS)
        axes.plot(f.times[::step], f.values[::step], color=COLOURS[0], lw=1)
        axes.axhline(f.bound, color=COLOURS[1], ls="--", lw=1)
        if f.at is not None:
            axes.axvline(f.at, color=COLOURS[3], lw=1)
        unit = "" if f.unit == "1" else f", {f.unit}"
        axes.set_title(f"{f.name}{unit}", fontsize=9, loc="left")
        axes.tick_params(labelsize=8)
        axes.grid(alpha=0.3)
    for axes in panels[len(drawn) :]:
        axes.set_axis_off()
    for axes in panels[max(len(drawn) - 2, 0) : len(drawn)]:
        axes.set_xlabel("time, s", fontsize=8)
    return figure
