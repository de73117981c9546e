"""A flight as a film: the vehicle over its target, and beside it what the camera sees."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from hoverproof.errors import InputError
from hoverproof.show.image_plane import draw_lens, goal_label, image_axes, seen
from hoverproof.show.movie import Pixels, check_file, film
from hoverproof.show.panels import space_axes
from hoverproof.show.scene import Array, Scene
from hoverproof.show.style import COLOURS

RATE = 20
DPI = 100
LENGTH = 12.0
MOST_PICTURES = 800
HOLD = 1.0
ROOM = 0.005
"""Between what is seen in space and by the camera, as a share of the width."""
SECONDS_TO_TENTHS = 10
ROTOR_RADIUS = 0.6
DRAWN_SPAN = 0.24
NICE = (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)


def check_request(path: Path, speed_up: float | None) -> None:
    """Refuse a film that cannot be made, before the flight.

    Parameters
    ----------
    path : Path or str
        The file.
    speed_up : float or None
        Seconds of flight in a second of the film.

    Raises
    ------
    InputError
    """
    check_file(path)
    if speed_up is not None and not (math.isfinite(speed_up) and speed_up > 0):
        raise InputError("--speed-up", "", f"must be a positive number, not {speed_up}")


def save_animation(
    flight: xr.Dataset,
    path: Path,
    *,
    speed_up: float | None = None,
    report: Callable[[int, int], None] | None = None,
) -> None:
    """Write a flight as a film of 20 pictures a second, which holds its last picture for 1 s.

    Parameters
    ----------
    flight : Dataset
        From `hoverproof.simulate`.
    path : Path
        Ends in ``.mp4`` (needs ffmpeg), ``.gif`` or ``.html`` (a page that needs no other file).
    speed_up : float, optional
        Seconds of flight in a second of the film; by default the film lasts about 12 s.
    report : callable, optional
        Called with (pictures done, pictures in all).

    Raises
    ------
    InputError
        If the file cannot be written, or the film would be longer than 40 s.
    """
    check_request(path, speed_up)
    duration = float(flight["time"].values[-1])
    speed = natural_speed_up(duration) if speed_up is None else speed_up
    if duration / speed * RATE > MOST_PICTURES - 1:
        least = duration * RATE / (MOST_PICTURES - 1)
        raise InputError(
            "--speed-up",
            "",
            f"must be at least {least:.2g} for a flight of {duration:g} s, not {speed:g}",
        )
    shown = math.ceil(duration / speed * RATE) + 1
    stage = Stage(flight, speed)
    total = shown + round(HOLD * RATE)
    with film(path, stage.pixels(duration), rate=RATE, split=stage.split) as add:
        for k in range(total):
            add(stage.pixels(min(k * speed / RATE, duration)))
            if report is not None:
                report(k + 1, total)


def natural_speed_up(duration: float) -> float:
    """Return a round speed-up at which a flight (s) takes about `LENGTH` seconds to watch.

    Parameters
    ----------
    duration : float
        s.
    """
    wanted = max(duration, 1e-6) / LENGTH
    power = 10.0 ** math.floor(math.log10(wanted))
    return float(min((n * power for n in NICE), key=lambda n: abs(math.log(n / wanted))))


class Stage:
    """The picture of a flight at one time, to be shown at another and another.

    Parameters
    ----------
    flight : Dataset
    speed_up : float
        Seconds of flight in a second, stated in the picture.
    """

    def __init__(self, flight: xr.Dataset, speed_up: float) -> None:
        self.scene = Scene.of(flight)
        self.times = flight["time"].values
        self.places = flight["position"].values
        self.rotations = flight["rotation"].values
        self.image = seen(flight)
        self.figure = Figure(figsize=(9.6, 5.4), dpi=DPI, layout="constrained")
        canvas: Any = FigureCanvasAgg(self.figure)
        self.canvas = canvas
        grid = self.figure.add_gridspec(1, 2, width_ratios=(1.45, 1))
        space = self.figure.add_subplot(grid[0, 0], projection="3d")
        plane = self.figure.add_subplot(grid[0, 1])
        self.size = self._drawn_size()
        self.rotors = self.size * self.scene.rotor_places
        self._set_space(space)
        self._set_plane(plane, float(flight["euler_angles"].sel(angle="yaw").values[-1]))
        self.clock = self.figure.suptitle("t\n", family="monospace", x=0.01, ha="left")
        self.pace = f"{speed_up:g} × real time"
        self.moving = (
            *(*self.rays, self.flown, *self.arms, *self.discs, *self.tracks, *self.dots),
            self.clock,
        )
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas.draw()
        self.still = self.canvas.copy_from_bbox(self.figure.bbox)
        right = plane.get_tightbbox()
        assert right is not None
        self.split = right.x0 / self.figure.bbox.width - ROOM

    def pixels(self, time: float) -> Pixels:
        """Return the picture at a time of the flight, s, (height, width, 4), a new array.

        Parameters
        ----------
        time : float
            s.
        """
        self.show(time)
        self.canvas.restore_region(self.still)
        renderer = self.canvas.get_renderer()
        for artist in self.moving:
            artist.draw(renderer)
        return np.array(self.canvas.buffer_rgba(), np.uint8)

    def show(self, time: float) -> None:
        """Move what moves to a time of the flight, s: to the last sample by then.

        Parameters
        ----------
        time : float
            s.
        """
        k = max(0, int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1)
        place, rotation = self.places[k], self.rotations[k]
        body = place + self.rotors @ rotation.T
        for line, end in zip(self.arms, body, strict=True):
            line.set_data_3d(*np.array([place, end]).T)
        for line, centre in zip(self.discs, self.rotors, strict=True):
            line.set_data_3d(*(place + (centre + self._circle()) @ rotation.T).T)
        for line, point in zip(self.rays, self.scene.points, strict=True):
            line.set_data_3d(*np.array([place, point]).T)
        self.flown.set_data_3d(*self.places[: k + 1].T)
        for i, (track, dot) in enumerate(zip(self.tracks, self.dots, strict=True)):
            track.set_data(*self.image[: k + 1, i].T)
            dot.set_data(*self.image[k : k + 1, i].T)
        digits = 1 if self.times[-1] >= SECONDS_TO_TENTHS else 2
        width = len(f"{self.times[-1]:.{digits}f}")
        ended = f"   {self.scene.ended}" if k == len(self.times) - 1 else ""
        now = f"t = {time:{width}.{digits}f} s   {self.pace}{ended}"
        self.clock.set_text(f"{self.scene.title}\n{now}")

    def _set_space(self, axes: Axes3D) -> None:
        scene, grey = self.scene, {"color": "grey", "linewidth": 0.7}
        axes.plot(*self.places.T, linestyle=":", **grey, label="path")
        axes.plot(*scene.points.T, "s", color=COLOURS[1], label="target points")
        axes.plot(*scene.goal, "*", color=COLOURS[2], markersize=12, label="goal")
        (self.flown,) = axes.plot([], [], [], color=COLOURS[0], linewidth=1.6, label="flown")
        self.rays = [axes.plot([], [], [], alpha=0.5, **grey)[0] for _ in scene.points]
        self.arms = [axes.plot([], [], [], color="black", linewidth=2)[0] for _ in self.rotors]
        self.discs = [axes.plot([], [], [], color=c, linewidth=1.6)[0] for c in self._colours()]
        reach = self.size * scene.arm * (math.sqrt(2) + ROTOR_RADIUS)
        around = [self.places - reach, self.places + reach]
        space_axes(axes, np.vstack([*around, scene.points, scene.goal]))
        ring = {"linewidth": 0, "marker": "o", "fillstyle": "none"}
        for colour, label in ((COLOURS[0], "rear rotors"), (COLOURS[4], "front rotors")):
            axes.plot([], [], [], color=colour, label=label, **ring)
        drawn = "to scale" if self.size == 1 else f"{self.size:g} × its size"
        axes.legend(
            loc="upper center",
            bbox_to_anchor=(0.5, 1.16),
            ncols=3,
            frameon=False,
            fontsize=8,
            title=f"vehicle drawn {drawn}",
            title_fontsize=8,
        )

    def _set_plane(self, axes: Axes, yaw: float) -> None:
        goal = self.scene.goal_image(yaw)
        colours = [COLOURS[i % len(COLOURS)] for i in range(len(self.scene.points))]
        axes.plot(
            *goal.T, "s", color="black", fillstyle="none", markersize=9, label=goal_label(yaw)
        )
        axes.plot(0, 0, "+", color="grey", label="optical axis")
        self.tracks = [axes.plot([], [], color=c, linewidth=1)[0] for c in colours]
        self.dots = [axes.plot([], [], "o", color=c)[0] for c in colours]
        everything = self.image.reshape(-1, 2)
        axes.update_datalim(everything[np.isfinite(everything[:, 0])])
        draw_lens(axes, self.scene)
        image_axes(axes)
        axes.set_title("what the camera sees", fontsize="medium", pad=22)
        axes.grid(alpha=0.3)
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0, 1),
            ncols=3,
            frameon=False,
            fontsize=8,
            borderaxespad=0.2,
        )

    def _drawn_size(self) -> float:
        """Return how many times its size the vehicle is drawn, so that it can be seen."""
        everything = np.vstack([self.places, self.scene.points])
        extent = float((everything.max(axis=0) - everything.min(axis=0)).max())
        times = DRAWN_SPAN * extent / (2 * math.sqrt(2) * self.scene.arm)
        return 1.0 if times < 1.5 else float(round(times))

    def _circle(self) -> Array:
        turn = np.linspace(0, 2 * np.pi, 25)
        radius = ROTOR_RADIUS * self.size * self.scene.arm
        return radius * np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)

    def _colours(self) -> list[str]:
        """Return the colours of the rotors: of those in front, and of the others."""
        return [COLOURS[4 if x > 0 else 0] for x, *_ in self.rotors]
