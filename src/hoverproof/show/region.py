"""The region of positions in which the eigenvalues of Q keep to their bounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from hoverproof.certification.flow import OfJ, eigenvalues, flow_of
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.certification.pattern import Pattern
from hoverproof.certification.region import Box
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.show.style import COLOURS, save_figure

CELLS = 160


def region_figure(mission: Mission, found: BoundsVerdict) -> Figure:
    """Draw the cross-section through the goal in the (x, z) plane, computed in floating point.

    Parameters
    ----------
    mission : Mission
    found : BoundsVerdict
        Its bounds are drawn, and the outline of its box.
    """
    target = Pattern.of(mission)
    goal = np.array([float(c) for c in hover_goal(mission).position])
    start = np.array([float(c) for c in mission.start.position])
    low, high = (float(x) for x in found.bounds)
    x, z = _window(target.points, goal, start, found.box)
    ground = float(target.points[:, 2].max())  # z is down: no vehicle is below it
    grid_x, grid_z = np.meshgrid(np.linspace(*x, CELLS), np.linspace(z[0], ground, CELLS))
    places = np.stack([grid_x, np.full_like(grid_x, goal[1]), grid_z], axis=-1).reshape(-1, 3)
    flow = flow_of(mission)
    if isinstance(flow, OfJ):
        j = (low + high) / 2
        far = flow.far(target, places, j).reshape(grid_x.shape)
        lines = [((high - low) / 2, far, COLOURS[1], f"|J - {j:g} I|")]
    else:
        lowest, _, highest = eigenvalues(target, places).T.reshape(3, *grid_x.shape)
        lines = [
            (-low, -lowest, COLOURS[0], "lowest eigenvalue"),
            (high, highest, COLOURS[1], "highest eigenvalue"),
        ]
    beyond = np.max([data - level for level, data, *_ in lines], axis=0)

    tall = min(1.0, (z[1] - z[0]) / (x[1] - x[0]))
    figure = Figure(figsize=(6.4, 5.6 * tall + 1.9), layout="constrained")
    axes = figure.subplots()
    if beyond.min() < 0:
        ends = [beyond.min(), 0]
        axes.contourf(grid_x, grid_z, beyond, levels=ends, colors=["#56B4E9"], alpha=0.45)
        axes.fill([], [], color="#56B4E9", alpha=0.45, label=f"bounds of {flow.symbol} hold")
    for level, data, colour, words in lines:
        if data.min() < level < data.max():
            look: dict[str, Any] = {"colors": [colour], "linewidths": 1.5, "linestyles": "solid"}
            axes.contour(grid_x, grid_z, data, levels=[level], **look)
            axes.plot([], [], color=colour, label=f"{words} = {abs(level):g} 1/m")
    (x0, x1), _, (z0, z1) = [[float(end) for end in side] for side in found.box]
    outline = Rectangle((x0, z0), x1 - x0, z1 - z0, fill=False, linestyle="--", linewidth=1.5)
    outline.set_label("the box of the question")
    axes.add_patch(outline)
    axes.axhline(ground, color="black", linewidth=1, label="ground")
    axes.plot(target.points[:, 0], target.points[:, 2], "s", color="black", label="target points")
    axes.plot(goal[0], goal[2], "*", color=COLOURS[2], markersize=13, label="goal")
    axes.plot(start[0], start[2], "o", color=COLOURS[3], label="start (its x and z)")
    where = f"where the bounds of {flow.symbol} hold, at y = {goal[1]:g} m"
    axes.set_title(f"{mission.title}\n{where}")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("z (m), down")
    axes.set_aspect("equal")
    axes.set_xlim(x)
    axes.set_ylim(z[::-1])
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=3)
    return figure


def save_region_figure(mission: Mission, found: BoundsVerdict, path: Path) -> None:
    """Write the figure as PNG.

    Parameters
    ----------
    mission, found
        See `region_figure`.
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(region_figure(mission, found), path)


Range = tuple[float, float]


def _window(
    points: np.ndarray, goal: np.ndarray, start: np.ndarray, box: Box
) -> tuple[Range, Range]:
    """Return the ranges of x and z that hold target, goal, start and box; room, not below."""
    x = [*points[:, 0], goal[0], start[0], *(float(end) for end in box[0])]
    z = [*points[:, 2], goal[2], start[2], *(float(end) for end in box[2])]
    middle, reach = float(goal[0]), max(max(x) - goal[0], goal[0] - min(x))
    depth = max(z) - min(z)
    room = 0.75 * max(reach, depth)
    aside = reach + room
    return (middle - aside, middle + aside), (min(z) - 1.5 * room, max(z) + 0.05 * depth)
