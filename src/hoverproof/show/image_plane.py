"""The image plane: where the target points are seen, and what the camera can see.

The image is that of the law: a pinhole at the centre of mass, about the z axis of the body.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from hoverproof.show.scene import Array, Flight, Scene
from hoverproof.show.style import COLOURS, legend_above

DEGREES = 180 / np.pi
WIDEST = 80 / DEGREES
"""What is farther off the axis, rad, is nowhere in the drawn part of a plane."""


def angles(flight: Flight) -> Array:
    """Return the angle of each target point off the axis, (time, point), rad.

    Parameters
    ----------
    flight : Dataset or Record
        From `simulate`.
    """
    within = np.arctan(np.linalg.norm(flight["image"].values, axis=-1))
    rays = Scene.of(flight).points - flight["position"].values[:, None]
    depth = (rays * flight["rotation"].values[:, None, :, 2]).sum(axis=-1)
    return np.asarray(np.where(depth > 0, within, np.pi - within), np.float64)


def view_angle(flight: Flight) -> Array:
    """Return the largest angle of a target point off the axis, (time,), rad.

    Parameters
    ----------
    flight : Dataset or Record
        From `simulate`.
    """
    return np.asarray(angles(flight).max(axis=-1), np.float64)


def seen(flight: Flight) -> Array:
    """Return the image of the points, (time, point, 2); NaN beyond `WIDEST`, and from behind.

    Parameters
    ----------
    flight : Dataset or Record
        From `simulate`.
    """
    return np.where(angles(flight)[..., None] <= WIDEST, flight["image"].values, np.nan)


def draw_image(axes: Axes, flight: Flight) -> None:
    """Draw the tracks of the target points in the image, their start, end and goal.

    The dotted circle is the smallest field of view around the axis that holds them; the lens of the
    mission and the edge of the image are drawn if they are told.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    flight : Dataset or Record
        From `simulate`.
    """
    scene, image = Scene.of(flight), seen(flight)
    for i, track in enumerate(np.swapaxes(image, 0, 1)):
        colour = COLOURS[i % len(COLOURS)]
        axes.plot(track[:, 0], track[:, 1], color=colour, linewidth=1.3)
        axes.plot(*track[0], "o", color=colour, fillstyle="none")
        axes.plot(*track[-1], "x", color=colour)
    yaw = float(flight["euler_angles"].values[-1, 2])
    goal = scene.goal_image(yaw)
    axes.plot(*goal.T, "s", color="black", fillstyle="none", markersize=9, markeredgewidth=0.8)
    axes.plot(0, 0, "+", color="grey", markersize=9)
    for marker, label in (("o", "start"), ("x", "end"), ("s", goal_label(yaw))):
        axes.plot([], [], marker, color="black", fillstyle="none", label=label)
    angle = float(view_angle(flight).max())
    _circle(axes, angle, f"points up to {angle * DEGREES:.1f}° off the axis", ":", "grey")
    draw_lens(axes, scene)
    image_axes(axes)
    legend_above(axes, 2)


def draw_lens(axes: Axes, scene: Scene) -> None:
    """Draw how far the lens of the mission is said to see, and the edge of the image.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    scene : Scene
    """
    if scene.half_angle is not None:
        _circle(axes, scene.half_angle, lens_label(scene.half_angle), "-", COLOURS[4])
    if scene.image_size is not None:
        width, height = scene.image_size
        corner = -width / 2, -height / 2
        outline = Rectangle(corner, width, height, fill=False, linestyle="--")
        outline.set_label("edge of the image")
        axes.add_patch(outline)


def lens_label(half_angle: float) -> str:
    """Say how far the lens of a mission sees.

    Parameters
    ----------
    half_angle : float
        Off the axis, rad.
    """
    return f"lens, to {half_angle * DEGREES:.1f}° off the axis"


def goal_label(yaw: float) -> str:
    """Name the image of the goal, with the yaw (rad) at which it is drawn unless that is zero.

    Parameters
    ----------
    yaw : float
        rad.
    """
    turned = abs(yaw) * DEGREES
    return "goal" if turned < 0.5 else f"goal, at yaw {yaw * DEGREES:.0f}°"


def image_axes(axes: Axes) -> None:
    """Label axes of the image plane, y down as in an image.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    """
    axes.set_xlabel("image x = X/Z (focal lengths)")
    axes.set_ylabel("image y = Y/Z (focal lengths), down")
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    if not axes.yaxis_inverted():
        axes.invert_yaxis()


def _circle(axes: Axes, angle: float, label: str, style: str, colour: str) -> None:
    """Draw a cone of such a half angle, rad, if it is in the drawn part of the plane."""
    if angle <= WIDEST:
        axes.add_patch(Circle((0, 0), np.tan(angle), fill=False, linestyle=style, color=colour))
        axes.plot([], [], style, color=colour, label=label)
    else:
        axes.plot([], [], " ", label=f"{label} (not drawn)")
