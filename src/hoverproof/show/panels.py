"""The panels of a flight's pictures: each draws one thing on axes that it is given."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import AutoLocator, MaxNLocator, MultipleLocator
from mpl_toolkits.mplot3d import Axes3D

from hoverproof.show.decay import Decay
from hoverproof.show.image_plane import DEGREES, lens_label, view_angle
from hoverproof.show.scene import Array, Flight, Scene
from hoverproof.show.style import COLOURS, STYLES, legend_above, plain_powers

FLOOR = 1e-10
LIMIT_NEAR = 0.25
ERRORS = "image", "velocity", "force", "body rate"
"""What δ1 to δ4 are the errors of."""
LITTLE, SHORT = 0.2, 0.4
NEAR_CORNER = 0.45
"""Of a step of the ticks: no number of y stands so near the corner that x has in common with it."""
SLIM = 0.4
"""The smaller range of a plan is at least that share of the larger one."""


def position(axes: Axes, flight: Flight) -> None:
    """Draw the position over time, with the goal as thin lines (paper, Fig. 5).

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    goal = Scene.of(flight).goal
    for i, axis in enumerate("xyz"):
        label = "z (down)" if axis == "z" else axis
        _line(axes, flight, flight["position"].values[:, i], i, label)
        axes.axhline(goal[i], color=COLOURS[i], linewidth=0.7, alpha=0.6)
    axes.plot([], [], color="grey", linewidth=0.7, label="goal")
    axes.set_ylabel("position (m)")
    legend_above(axes)


def attitude(axes: Axes, flight: Flight) -> None:
    """Draw roll, pitch and yaw over time (paper, Fig. 5).

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    for i, angle in enumerate(("roll", "pitch", "yaw")):
        _line(axes, flight, flight["euler_angles"].values[:, i] * DEGREES, i, angle)
    axes.set_ylabel("Euler angles (deg)")
    legend_above(axes)


def rotor_forces(axes: Axes, flight: Flight) -> None:
    """Draw the thrust of each rotor over time, the share of the weight, and limits that are near.

    A limit farther off than the thrusts ever stray is left out, and named in the legend.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    scene = Scene.of(flight)
    for i, rotor in enumerate(flight["rotor"].values):
        _line(axes, flight, flight["rotor_thrust"].values[:, i], i, str(rotor))
    rotors = len(flight["rotor"].values)
    hover = scene.weight / rotors
    axes.axhline(hover, color="grey", linewidth=0.7, label=f"m g/{rotors}")
    reach = float(np.abs(flight["rotor_thrust"].values - hover).max())
    for name, limit in zip(("lowest", "highest"), scene.rotor_limits, strict=True):
        if limit is None:
            continue
        label = f"{name} {limit:g} N"
        if abs(limit - hover) * LIMIT_NEAR <= reach:
            axes.axhline(limit, color="black", linewidth=1.2, linestyle="--", label=label)
        else:
            axes.plot([], [], " ", label=f"{label} (not drawn)")
    axes.set_ylabel("rotor thrust (N)")
    axes.ticklabel_format(axis="y", useOffset=False)
    legend_above(axes, 3)


def required_view(axes: Axes, flight: Flight) -> None:
    """Draw the largest angle of a point off the axis over time, its maximum marked.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    times, angle = flight["time"].values, view_angle(flight) * DEGREES
    axes.plot(times, angle, color=COLOURS[0], linewidth=1.5, label="farthest point")
    top = int(angle.argmax())
    axes.plot(
        times[top],
        angle[top],
        "o",
        color=COLOURS[1],
        clip_on=False,
        label=f"largest, {angle[top]:.1f}° at {times[top]:g} s",
    )
    scene = Scene.of(flight)
    half, size = scene.half_angle, scene.image_size
    if half is not None:
        axes.axhline(half * DEGREES, color=COLOURS[4], linewidth=1.2, label=lens_label(half))
    if size is not None:
        edge = float(np.arctan(min(size) / 2)) * DEGREES
        axes.axhline(
            edge, color="black", linestyle="--", linewidth=1.2, label=f"nearest edge, {edge:.1f}°"
        )
    axes.set_ylim(0, 1.08 * axes.get_ylim()[1])
    axes.set_ylabel("off the axis (deg)")
    legend_above(axes)


def errors(axes: Axes, flight: Flight, decay: Decay | None = None) -> None:
    """Draw the sizes of the errors and L on a log scale, with the certified decay as a line.

    Parameters
    ----------
    axes : Axes
    flight : Dataset or Record
    decay : Decay, optional
        From `hoverproof.show.decay.decay_along`.
    """
    times, level = flight["time"].values, flight["lyapunov"].values
    for i, error in enumerate(ERRORS):
        size = np.linalg.norm(flight[f"delta{i + 1}"].values, axis=1)
        axes.plot(times, size, STYLES[i], color=COLOURS[i], label=error, linewidth=1.3)
    axes.plot(times, level, color="black", linewidth=1.8, label="L = half the sum of squares")
    if decay is not None:
        covered = times[times <= decay.until]
        label = decay.label()
        if decay.until < times[-1]:
            label += f"\n(until {decay.until:g} s, when the flight leaves its bounds)"
        bound = decay.bound(covered, level[0])
        axes.plot(covered, bound, color=COLOURS[4], linewidth=2.2, label=label)
    largest = float(level.max())
    if largest > 0:  # else it starts at its goal, and all is 0
        drawn = np.concatenate([line.get_ydata() for line in axes.lines])
        axes.set_yscale("log")
        axes.set_ylim(max(FLOOR * largest, 0.3 * drawn[drawn > 0].min()), 10 * largest)
    plain_powers(axes.yaxis)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("errors of the law, and L (dimensionless)")
    legend_above(axes, 3)


def path(axes: Axes3D, flight: Flight) -> None:
    """Draw the path in space with target, start and goal, up on the page (paper, Fig. 4).

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    scene = Scene.of(flight)
    places = flight["position"].values
    axes.plot(*places.T, color=COLOURS[0], linewidth=1.8, label="path")
    axes.plot(*places[0], "o", color=COLOURS[3], label="start")
    axes.plot(*places[-1], "x", color="black", zorder=4, label="end")
    axes.plot(*scene.goal, "*", color=COLOURS[2], markersize=13, label="goal")
    axes.plot(*scene.points.T, "s", color=COLOURS[1], label="target points")
    ground = np.full(len(places), scene.points[:, 2].max())
    axes.plot(*places[:, :2].T, ground, color="grey", linewidth=0.8, label="path on the ground")
    space_axes(axes, np.vstack([places, scene.points, scene.goal]))
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False)


def space_axes(axes: Axes3D, places: Array) -> None:
    """Give axes in space equal scales around places (n, 3), with z, which is down, down the page.

    The y axis is turned around as well: turning one axis alone would show a mirror image.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    places : (n, 3)
        World frame, m.
    """
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.08 * float((high - low).max()) + 0.1
    low, high = low - room, high + room
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(high[1], low[1])
    axes.set_zlim(high[2], low[2])
    axes.set_box_aspect(tuple(high - low))
    _, step, *_ = AutoLocator().tick_values(0, (high - low).max())
    for axis in (axes.xaxis, axes.zaxis):
        axis.set_major_locator(MultipleLocator(step))
    ticks: list[float] = []
    apart, last = step, high[1] - NEAR_CORNER * step
    while len(ticks) < 2:
        ticks = [y for y in MultipleLocator(apart).tick_values(low[1], last) if low[1] <= y <= last]
        apart /= 2
    axes.yaxis.set_ticks(ticks)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    axes.set_zlabel("z (m), down", labelpad=14)  # clear of the numbers


def from_above(axes: Axes, flight: Flight) -> None:
    """Draw the path seen from above.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    _plan(axes, flight, 0, 1)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    axes.set_title("from above", fontsize="medium")


def from_the_side(axes: Axes, flight: Flight) -> None:
    """Draw the path seen from the side, along the y axis.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    _plan(axes, flight, 0, 2)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("z (m), down")
    axes.set_title("from the side", fontsize="medium")
    along, ground = flight["position"].values[:, 0], Scene.of(flight).points[:, 2].max()
    axes.plot(along, np.full(len(along), ground), color="grey", linewidth=0.8)


def _plan(axes: Axes, flight: Flight, i: int, j: int) -> None:
    scene, places = Scene.of(flight), flight["position"].values
    axes.plot(places[:, i], places[:, j], color=COLOURS[0], linewidth=1.5)
    axes.plot(places[0, i], places[0, j], "o", color=COLOURS[3])
    axes.plot(places[-1, i], places[-1, j], "x", color="black", zorder=4)
    axes.plot(scene.goal[i], scene.goal[j], "*", color=COLOURS[2], markersize=13)
    axes.plot(scene.points[:, i], scene.points[:, j], "s", color=COLOURS[1])
    shown = np.vstack([places, scene.points, scene.goal])[:, [i, j]]
    middle, sides = (shown.min(axis=0) + shown.max(axis=0)) / 2, np.ptp(shown, axis=0)
    reach = 0.6 * np.maximum(sides, SLIM * sides.max())
    axes.set_xlim(middle[0] - reach[0], middle[0] + reach[0])
    axes.set_ylim(middle[1] + reach[1], middle[1] - reach[1])  # y and z are down the page
    numbers = 2 + round(5 * min(1.0, reach[0] / reach[1]))
    axes.xaxis.set_major_locator(MaxNLocator(numbers, steps=[1, 2, 2.5, 5, 10]))
    axes.set_aspect("equal")
    axes.grid(alpha=0.3)


def beginning(flight: Flight) -> float | None:
    """Return for how long tilt and rotor thrusts are to be shown anew, s; None if not.

    That is twice the time after which they stray little any more, if it is short beside the flight.
    Little is a fifth of the farthest that each strays from the end of the flight.

    Parameters
    ----------
    flight : Dataset or Record
        From `simulate`.
    """
    late = 0
    for name in ("tilt", "rotor_thrust"):
        values = flight[name].values.reshape(len(flight["time"].values), -1)
        strayed = np.abs(values - values[-1]).max(axis=1)
        late = max(late, int(np.nonzero(strayed >= LITTLE * strayed.max())[0][-1]))
    times = flight["time"].values
    early = 2 * float(times[late])
    return early if 0 < early < SHORT * float(times[-1]) else None


def _line(axes: Axes, flight: Flight, values: Array, i: int, label: str) -> None:
    axes.plot(
        flight["time"].values,
        values,
        STYLES[i % len(STYLES)],
        color=COLOURS[i % len(COLOURS)],
        label=label,
        linewidth=1.5,
    )
