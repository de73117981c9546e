"""Pictures of design: the curve of decay rate against bandwidth, and maps of what is certified."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hoverproof.certification.tuning import Tuned
from hoverproof.files import replacing
from hoverproof.mission import Mission
from hoverproof.show.figures import COLOURS

ENDINGS = {".png": "png", ".svg": "svg"}


def pareto_figure(mission: Mission, points: Sequence[tuple[float, Tuned]]) -> Figure:
    """Draw the certified decay rate against the bandwidth, and the mission's own gains.

    Parameters
    ----------
    mission : Mission
    points : sequence of (bandwidth limit in rad/s, what was tuned)
    """
    figure = Figure(figsize=(7.5, 5), layout="constrained")
    axes = figure.subplots()
    bandwidth = [t.uses[0].value for _, t in points]
    rate = [float(t.verdict.decay_rate) for _, t in points]
    axes.loglog(bandwidth, rate, "o-", color=COLOURS[0], label="tuned gains, proved")
    before = points[0][1].before
    if before is not None:
        g, m = mission.gains, mission.vehicle.mass
        own = float((g.k1 * g.k2 + g.k3 + g.k4) / m)
        axes.plot(own, float(before), "*", color=COLOURS[1], markersize=13, label="own gains, proved")
    axes.set_title(f"{mission.name}: what a decay rate costs")
    axes.set_xlabel("attitude bandwidth (k1 k2 + k3 + k4)/m (rad/s)")
    axes.set_ylabel("certified decay rate of L (1/s)")
    axes.grid(alpha=0.3, which="both")
    axes.legend(loc="best", framealpha=0.8)
    return figure


def save_pareto_figure(
    mission: Mission, points: Sequence[tuple[float, Tuned]], path: Path
) -> None:
    """Write the curve as PNG or SVG.

    Parameters
    ----------
    mission, points
        See `pareto_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save(pareto_figure(mission, points), path)


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the path's ending, PNG if it is none of `ENDINGS`."""
    with replacing(path) as beside:
        figure.savefig(beside, dpi=130, format=ENDINGS.get(path.suffix.lower(), "png"))
