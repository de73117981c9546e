"""Pictures of exponential convergence: where it starts, where it stays, and how soon it is over."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.attraction.potential import sphere
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.candidate import Tilted
from hoverproof.certification.exponential.domain import mirrored
from hoverproof.certification.exponential.inequality import MEMORY, THRUST, TORQUE, W2, W3, W4
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.positions import DIRECTIONS, Scene
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.show.style import COLOURS, heading, plain_powers, save_figure
from hoverproof.simulation.flight import flown
from hoverproof.simulation.record import Record
from hoverproof.simulation.timing import Timing

Array = NDArray[np.float64]
CELLS, TIMES, STEPS = 220, 120, 600
NEAREST, FARTHEST = 1e-3, 1e2
"""Of what is looked at along rays from the goal, in its heights."""
LONGER = 1.25
"""The flight is shown for that many times the proved settling time."""


@dataclass(frozen=True)
class View:
    """A vertical plane through the goal, and what is proved of it.

    Attributes
    ----------
    verdict : Exponential
    """

    verdict: Exponential

    @cached_property
    def scene(self) -> Scene:
        """Target and goal."""
        return Scene.of(self.verdict.mission)

    @cached_property
    def top(self) -> float:
        """Height of the target, world z, m."""
        return float(self.scene.target.mean[2])

    @cached_property
    def middles(self) -> Array:
        """The middles of the boxes of starts, (k, 3), m."""
        sides = np.array([start.position for start in self.verdict.starts], float)
        return np.asarray(sides.mean(axis=2))

    @cached_property
    def along(self) -> Array:
        """Horizontal unit vector: toward the start that is farthest sideways, or along x."""
        aside = (self.middles - self.scene.goal) * [1, 1, 0]
        far = np.linalg.norm(aside, axis=1)
        k = int(far.argmax())
        return np.asarray(aside[k] / far[k] if far[k] > 1e-9 else [1.0, 0.0, 0.0])

    @cached_property
    def tilted(self) -> Tilted:
        """How |σ - σ*| follows from Ψ."""
        v = self.verdict
        reach = Reach.of(np.array(v.weights, float), float(v.level))
        low, high = map(float, v.slope)
        return Tilted.of(Limits(Vehicles.of(v.mission).before((low, high)), reach, high))

    def offset(self, level: float | Array) -> Array:
        """Return what |σ - σ*| is at most where Ψ is at most a level.

        Parameters
        ----------
        level : float or array
            Dimensionless.
        """
        return self.tilted.offset(self.verdict.weights, level)

    def seen(self, places: Array) -> tuple[Array, Array]:
        """Return across and height, m, of places in the world, (k, 3).

        Parameters
        ----------
        places : (k, 3)
            World frame, m.
        """
        return (places - self.scene.goal) @ self.along, self.top - places[:, 2]

    def places(self, across: Array, height: Array) -> Array:
        """Return positions, (k, 3), of points of the plane.

        Parameters
        ----------
        across, height : (k,)
            Distance from the axis of the goal, and height above the mean of the target, m.
        """
        axis = np.array([*self.scene.goal[:2], self.top])
        return np.asarray(axis + across[:, None] * self.along - height[:, None] * [0, 0, 1.0])

    def out_of_wedge(self, across: Array, height: Array) -> Array:
        """Return how far points of the plane are out of the wedge that no motion leaves, (k,), m.

        Parameters
        ----------
        across, height : (k,)
            See `places`.
        """
        ray = self.scene.target.mean - self.places(across, height)
        low, high = map(float, self.verdict.heights)
        out = [low - height, height - high]
        for k, (a, b) in enumerate(self.verdict.wedge[:2]):
            least = -b if a == 0 and mirrored(self.verdict.mission.target, k) else a
            out += [float(least) * height - ray[:, k], ray[:, k] - float(b) * height]
        return np.asarray(np.max(out, axis=0))

    def hovers(self, offset: Array) -> Array:
        """Return Ψ of level hovers at rest where the feature is off by that, (k, 3).

        Parameters
        ----------
        offset : (k, 3)
            σ - σ*.
        """
        v = self.verdict
        question = Question.of(Vehicles.of(v.mission), self.scene, v.starts)
        away, level = (np.linalg.norm(offset[:, :k], axis=1) for k in (3, 2))
        terms = question.terms_at(away, level, Start(v.starts[0].position))
        lag = v.certificate.content["lag"] or {"torque": 0, "thrust": 0}
        weights = np.zeros(terms.shape[1])
        weights[[0, W2, W3, W4]] = 1, *map(float, v.weights)
        weights[[TORQUE, THRUST]] = [float(Fraction(lag[name])) for name in ("torque", "thrust")]
        weights[MEMORY] = float(Fraction(v.certificate.content["memory"] or 0))
        return np.asarray(terms @ weights)

    def distances(self, offsets: Array) -> Array:
        """Return how far from the goal |σ - σ*| may be an offset, m, (k,).

        Parameters
        ----------
        offsets : (k,)
        """
        radii = abs(self.top - self.scene.goal[2]) * np.geomspace(NEAREST, FARTHEST, STEPS)
        places = self.scene.goal + sphere(DIRECTIONS)[:, None] * radii[None, :, None]
        with np.errstate(all="ignore"):
            far = np.linalg.norm(self.scene.offset(places.reshape(-1, 3)), axis=1)
        far = np.nan_to_num(far, nan=np.inf).reshape(DIRECTIONS, -1)
        each = np.arange(DIRECTIONS)

        def farthest(d: float) -> float:
            end = np.maximum(np.argmax(far >= d, axis=1), 1)
            near, beyond = far[each, end - 1], far[each, end]
            part = np.clip((d - near) / (beyond - near), 0, 1)
            return float((radii[end - 1] + part * (radii[end] - radii[end - 1])).max())

        return np.array([farthest(float(d)) for d in offsets])


def exponential_figure(verdict: Exponential) -> Figure:
    """Draw where every vehicle within tolerance stays, and its distance from the goal over time.

    What is shaded, and the distance that follows from the bound of Ψ, is computed in floating point
    from proved numbers; the flight is simulated, with what the mission adds to the model.

    Parameters
    ----------
    verdict : Exponential
        From `hoverproof.attraction`.
    """
    view, mission = View(verdict), verdict.mission
    flight = fly(view)
    figure = Figure(figsize=(13, 6.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.15))
    figure.suptitle(heading(mission, "{who}", 100))
    draw_section(left, view, flight)
    left.set_title("vertical section through goal and start")
    draw_distance(right, view, flight)
    right.set_title("settling")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def fly(view: View) -> Record | None:
    """Simulate the mission, if what is proved is about its start.

    Parameters
    ----------
    view : View
    """
    verdict = view.verdict
    if Start.of(verdict.mission) not in verdict.starts:
        return None
    return flown(verdict.mission, Timing(duration=LONGER * float(verdict.settling.time)))


def draw_section(axes: Axes, view: View, flight: Record | None) -> None:
    """Draw target, goal, starts, hovers inside and the domain in a vertical plane.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    view : View
    flight : Record or None
        Of the mission.
    """
    verdict, scene = view.verdict, view.scene
    side, height = window(view)
    low, high = verdict.heights
    across, up = np.linspace(-side, side, CELLS), np.linspace(0, height, CELLS)
    a, h = np.meshgrid(across, up)
    with np.errstate(all="ignore"):
        offset = np.nan_to_num(scene.offset(view.places(a.ravel(), h.ravel())), nan=1e9)
        away = np.linalg.norm(offset, axis=1).reshape(a.shape)
        psi = view.hovers(offset).reshape(a.shape)
    d, level = float(verdict.offset), float(verdict.level)
    axes.contourf(across, up, away, levels=[0, d], colors=["#56B4E9"], alpha=0.25)
    axes.contourf(across, up, psi, levels=[0, level], colors=["#009E73"], alpha=0.4)
    axes.contour(across, up, away, levels=[d], colors=COLOURS[0], linewidths=1.2)
    out = view.out_of_wedge(a.ravel(), h.ravel()).reshape(a.shape)
    axes.contour(across, up, out, levels=[0], colors=COLOURS[0], linewidths=1.2, linestyles="--")
    axes.fill([], [], color="#009E73", alpha=0.5, label="level hovers within the proved level of Ψ")
    of_feature = "no motion leaves this: bound of the feature's error"
    axes.fill([], [], color="#56B4E9", alpha=0.3, label=of_feature)
    stated = f"nor this, as the theorem states it: {at_least(low)} to {at_most(high)} m high"
    axes.plot([], [], "--", color=COLOURS[0], linewidth=1.2, label=stated)
    if flight is not None:
        path = view.seen(np.asarray(flight["position"].values))
        axes.plot(*path, color=COLOURS[1], linewidth=1.5, label="simulated flight (no proof)")
    places, heights = view.seen(scene.points)
    axes.plot(places, heights, "s", color="black", label="target points", clip_on=False)
    axes.plot(*view.seen(scene.goal[None]), "*", color="black", markersize=14, label="goal")
    _draw_starts(axes, view)
    axes.set_xlim(-side, side)
    axes.set_ylim(-0.03 * height, height)
    axes.set_aspect("equal")
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.set_xlabel("horizontal distance from the goal, toward the start (m)")
    axes.set_ylabel("height above the target (m)")
    axes.grid(alpha=0.3)


def window(view: View) -> tuple[float, float]:
    """Return half the width and the height of a window that holds domain, target and starts, m.

    It is as high as the wedge, which may be far wider.

    Parameters
    ----------
    view : View
    """
    ends = view.scene.goal + view.scene.ends(float(view.verdict.offset))
    shown = np.vstack([ends, view.middles, view.scene.points, view.scene.goal])
    across, height = view.seen(shown)
    highest = max(float(height.max()), float(view.verdict.heights[1]))
    return 1.08 * float(np.abs(across).max()), 1.08 * highest


def _draw_starts(axes: Axes, view: View) -> None:
    for start, middle in zip(view.verdict.starts, view.middles, strict=True):
        sides = np.array(start.position, float)
        corners = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)
        across, height = view.seen(corners)
        if np.ptp(across) or np.ptp(height):
            low, size = (across.min(), height.min()), (np.ptp(across), np.ptp(height))
            axes.add_patch(Rectangle(low, *size, fill=False, linewidth=1.5))
        else:
            axes.plot(*view.seen(middle[None]), "D", color="white", markeredgecolor="black")
    axes.plot([], [], "D", color="white", markeredgecolor="black", label="proved starts")


def draw_distance(axes: Axes, view: View, flight: Record | None) -> None:
    """Draw how far from the goal a motion may be at most over time, and where one is.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    view : View
    flight : Record or None
        Of the mission.
    """
    verdict = view.verdict
    settling, until = verdict.settling, LONGER * float(verdict.settling.time)
    time = np.linspace(0, until, TIMES)
    level = float(verdict.start_level) * np.exp(-float(verdict.rate) * time)
    bound = view.distances(view.offset(level))
    label = f"bound, Ψ ≤ Ψ(0) exp(−{at_least(verdict.rate)} t)"
    axes.semilogy(time, bound, "--", color=COLOURS[0], label=label)
    radius, soon = float(settling.radius), float(settling.time)
    axes.plot([soon, until], [radius, radius], color="black", linewidth=2)
    axes.plot(soon, radius, "o", color="black")
    proved = f"proved: within {at_most(settling.radius)} m from {at_most(settling.time)} s"
    axes.plot([], [], "o-", color="black", label=proved)
    least = radius
    if flight is not None:
        away = np.asarray(flight["position"].values) - view.scene.goal
        far = np.linalg.norm(away, axis=1)
        axes.plot(flight["time"].values, far, color=COLOURS[1], label="simulated flight (no proof)")
        least = min(least, float(np.clip(far[far > 0].min(), 1e-4 * bound[0], None)))
    axes.set_ylim(0.5 * least, 1.6 * bound[0])
    plain_powers(axes.yaxis)
    axes.set_xlim(0, until)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance from the goal (m)")
    axes.grid(alpha=0.3, which="both")
    axes.legend(loc="lower left", framealpha=0.9)


def save_exponential_figure(verdict: Exponential, path: Path) -> None:
    """Write the figure as PNG.

    Parameters
    ----------
    verdict : Exponential
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(exponential_figure(verdict), path, dpi=120)
