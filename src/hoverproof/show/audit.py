"""Draw a finding of an audit over time, against its bound."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from hoverproof.audit.finding import Finding
from hoverproof.show.style import COLOURS

COLUMNS = 600
"""Of more samples the least and the largest of each of so many stretches of time are drawn."""


def finding_figure(f: Finding) -> Figure:
    """Draw what was found over time.

    Parameters
    ----------
    f : Finding
        That is told over time.
    """
    assert f.times is not None and f.values is not None
    figure = Figure(figsize=(5, 2.1), layout="constrained")
    axes = figure.subplots()
    step = max(1, len(f.times) // COLUMNS)
    if step == 1:
        axes.plot(f.times, f.values, color=COLOURS[0], lw=1.2)
    else:
        begins = np.arange(0, len(f.times), step)
        least, largest = (end.reduceat(f.values, begins) for end in (np.minimum, np.maximum))
        ends = np.stack([least, largest], axis=1).ravel()
        axes.plot(np.repeat(f.times[begins], 2), ends, color=COLOURS[0], lw=1.2)
    axes.axhline(f.bound, color=COLOURS[1], ls="--", lw=1.4)
    if f.at is not None:
        axes.axvline(f.at, color=COLOURS[3], lw=1.4)
    if np.nanmax(abs(f.values)) < 1e-9 and not f.bound:  # else rounding errors fill the picture
        axes.set_ylim(-1, 1)
    axes.set_xlabel("time (s)")
    axes.set_ylabel(f"{f.name}\n({'share' if f.unit == '1' else f.unit})")
    axes.grid(alpha=0.3)
    return figure
