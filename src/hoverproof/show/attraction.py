"""Pictures of a region of attraction: where the controller may be switched on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from hoverproof.algebra.decimals import at_least, at_most
from hoverproof.certification.attraction.motion import energies
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.bounds import eigenvalue_bounds
from hoverproof.certification.flow import eigenvalues
from hoverproof.design.limits import bandwidth
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.loop import LoopNumbers
from hoverproof.show.style import COLOURS, heading, legend_above, plain_powers, save_figure
from hoverproof.simulation.compiled import runner
from hoverproof.simulation.step import flight_states
from hoverproof.spread import spread

Array = NDArray[np.float64]

CELLS = 160
FLIGHTS = 60
SAMPLES = 300
BLOCK = 20
AT_REST = 1e-6
"""Part of the proved level below which Λ is out of the picture."""
STEPS_PER_FASTEST = 4


@dataclass(frozen=True)
class View:
    """A vertical plane through the axis of the goal, and the window that is drawn of it.

    Attributes
    ----------
    potential : Potential
    along : (3,)
        Horizontal unit vector: toward the start, or along x.
    side : float
        Half the width of the window, m.
    top, bottom : float
        Heights above the mean of the target, m.
    """

    potential: Potential
    along: Array
    side: float
    top: float
    bottom: float

    @classmethod
    def of(cls, region: Attraction) -> View:
        """Choose a window that holds target, goal and start.

        Parameters
        ----------
        region : Attraction
        """
        p = Potential.of(region.mission)
        start = np.array([float(c) for c in region.mission.start.position])
        offset = (start - p.goal) * [1, 1, 0]
        far = float(np.linalg.norm(offset))
        along = offset / far if far > 1e-9 else np.array([1.0, 0, 0])
        size = p.height(float(p.goal[2]))
        reach = min(float(region.reach.sideways) * 1.35, 3 * size)
        side = max(1.15 * far, reach, 1.2 * np.abs(p.points[:, :2] - p.goal[:2]).max())
        top = max(size + side, 1.2 * p.height(float(start[2])))
        return cls(p, along, side, top, -0.15 * size)

    def places(self, across: Array, height: Array) -> Array:
        """Return positions, (k, 3), of points of the plane.

        Parameters
        ----------
        across, height : (k,)
            Distance from the axis of the goal, and height above the mean of the target, m.
        """
        axis = np.array([*self.potential.goal[:2], self.potential.plane])
        return np.asarray(
            axis + across[:, None] * self.along - height[:, None] * np.array([0, 0, 1.0])
        )

    def grid(self) -> tuple[Array, Array, Array]:
        """Return distances (k,), heights (l,) and positions (k l, 3)."""
        across = np.linspace(-self.side, self.side, CELLS)
        height = np.linspace(self.bottom, self.top, CELLS)
        a, h = np.meshgrid(across, height)
        return across, height, self.places(a.ravel(), h.ravel())


@dataclass(frozen=True)
class Flights:
    """Simulated flights from level hovers.

    Attributes
    ----------
    across, height : (k,)
        Where they start in the plane of the view, m.
    settled, certified : (k,)
        Whether they reach the goal; whether their start is in the proved region.
    time : (SAMPLES + 1,)
        s.
    energy : (k, SAMPLES + 1)
        Λ; NaN after a flight that ended, or came to rest at the goal.
    """

    across: Array
    height: Array
    settled: NDArray[np.bool_]
    certified: NDArray[np.bool_]
    time: Array
    energy: Array


def outside_by(region: Attraction, places: Array, terms: Array) -> Array:
    """Return by how much level hovers, (k, 3), are outside, (k,), m; certified are 0 and less.

    Parameters
    ----------
    region : Attraction
    places : (k, 3)
        World frame, m.
    terms : (k, 4)
        Their `Potential.hover_terms`.
    """
    excess = terms @ [1, *(float(w) for w in region.weights)] - float(region.level)
    if region.barrier_height is None:
        return np.asarray(excess)
    height = Potential.of(region.mission).plane - places[:, 2]
    return np.maximum(excess, float(region.barrier_height) - height)


def fly(region: Attraction, view: View, count: int = FLIGHTS) -> Flights:
    """Simulate flights from hovers all over the window, above the target.

    Parameters
    ----------
    region : Attraction
    view : View
    count : int
        Number of flights.
    """
    mission, p = region.mission, view.potential
    rng = np.random.default_rng(0)
    across = rng.uniform(-view.side, view.side, count)
    low = p.height(float(p.points[:, 2].min())) + 0.005 * view.top
    height = low + (view.top - low) * rng.uniform(0, 1, count) ** 2
    places = view.places(across, height)
    numbers, rate = (
        LoopNumbers.of(mission, HAMEL_MAHONY.flying(mission)),
        slowest_rate(mission),
    )
    step = 1 / (STEPS_PER_FASTEST * bandwidth(mission))
    every = max(1, int(12 / rate / step / SAMPLES))
    level = (np.zeros(3), np.eye(3).ravel(), np.zeros(3), [numbers.hover_thrust])
    hovers = np.column_stack([places, np.tile(np.concatenate(level), (count, 1))])
    starts = flight_states(hovers, p.goal, numbers.points)
    near = 0.05 * np.linalg.norm(p.points - p.goal, axis=1).min()
    energy = np.full((count, SAMPLES + 1), np.nan)
    settled = np.zeros(count, bool)
    machine = runner(numbers.target_size, numbers.law)

    def run(now: Array) -> tuple[Array, bool]:
        return machine.run(now, numbers.design, numbers.points, step, BLOCK, every)

    energy[:, 0] = energies(region, starts[:, :STATE_SIZE])
    flying, now = np.arange(count), starts
    for first in range(1, SAMPLES + 1, BLOCK):  # what has come to rest need not be flown on
        flown = list(spread(run, now))
        tracks = np.full((len(flown), BLOCK, STATE_SIZE), np.nan)
        for track, (states, good) in zip(tracks, flown, strict=True):
            kept = states if good else states[:-1]
            track[: len(kept)] = kept[:, :STATE_SIZE]
        of_tracks = energies(region, tracks.reshape(-1, STATE_SIZE)).reshape(len(flown), BLOCK)
        energy[flying, first : first + BLOCK] = of_tracks
        settled[flying] = np.linalg.norm(tracks[:, -1, :3] - p.goal, axis=1) < near
        whole = np.array([good for _, good in flown])
        on = whole & ~(settled[flying] & (of_tracks[:, -1] < AT_REST * float(region.level)))
        flying, now = flying[on], np.array([s[-1] for s, _ in flown])[on]
        if not len(flying):
            break
    time = np.linspace(0, step * every * SAMPLES, SAMPLES + 1)
    certified = outside_by(region, places, p.hover_terms(places)) <= 0
    return Flights(across, height, settled, certified, time, energy)


def attraction_figure(region: Attraction) -> Figure:
    """Draw the certified hovers in cross-section and in space, and Λ, or Ψ, along flights.

    The shaded set is computed in floating point from the proved level and weights.

    Parameters
    ----------
    region : Attraction
        From `hoverproof.attraction`.
    """
    view = View.of(region)
    flights = fly(region, view)
    figure = Figure(figsize=(16, 6.6), layout="constrained")
    grid = figure.add_gridspec(1, 3, width_ratios=(1.2, 1.1, 0.9), wspace=0.08)
    words = "where the controller may be switched on (proved), for {who}"
    figure.suptitle(heading(region.mission, words, 130))
    section = figure.add_subplot(grid[0])
    draw_section(section, region, view, flights)
    _draw_space(figure.add_subplot(grid[1], projection="3d"), region, view)
    draw_energy(figure.add_subplot(grid[2]), region, flights)
    handles, labels = section.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def save_attraction_figure(region: Attraction, path: Path) -> None:
    """Write the figure as PNG.

    Parameters
    ----------
    region : Attraction
    path : Path

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    save_figure(attraction_figure(region), path, dpi=120)


def draw_section(axes: Axes, region: Attraction, view: View, flights: Flights) -> None:
    """Draw the certified hovers in cross-section, and which simulated starts reach the goal.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    region : Attraction
    view : View
    flights : Flights
    """
    mission, p = region.mission, view.potential
    across, height, places = view.grid()
    shape = (len(height), len(across))
    terms = p.hover_terms(places)
    outside = outside_by(region, places, terms).reshape(shape)
    if outside.min() < 0:
        ends = [outside.min(), 0]
        axes.contourf(across, height, outside, levels=ends, colors=["#56B4E9"], alpha=0.45)
    axes.fill([], [], color="#56B4E9", alpha=0.45, label="certified hovers")
    values = eigenvalues(p.target, places)
    low, high = (float(x) for x in eigenvalue_bounds(mission))
    beyond = np.maximum(low - values[:, 0], values[:, 2] - high).reshape(shape)
    if beyond.min() < 0 < beyond.max():
        axes.contour(across, height, beyond, levels=[0], colors=COLOURS[4], linestyles="--")
    axes.plot([], [], "--", color=COLOURS[4], label=f"eigenvalues of Q in [{low:g}, {high:g}] 1/m")
    paper = (terms @ [0, 1, 2, 1]).reshape(shape)  # L = ½(3|δ1|² + |Pδ1|²) in a level hover
    axes.contour(
        across, height, paper, levels=[(p.whole - p.q3) ** 2 / 2], colors=COLOURS[1], linewidths=1.5
    )
    axes.plot([], [], color=COLOURS[1], label="largest bounded level set of the paper's L")
    if region.barrier_height is not None:
        at, barrier = float(region.barrier_height), at_most(region.barrier_height)
        axes.axhline(at, color="black", linewidth=1.5, linestyle=":")
        axes.plot([], [], ":", color="black", label=f"barrier, {barrier} m above the target")
    for kept, marker, colour, label in (
        (flights.settled, ".", COLOURS[2], "simulated start that reaches the goal"),
        (~flights.settled, "x", COLOURS[3], "simulated start that does not reach it"),
    ):
        style: dict[str, Any] = {"color": colour, "markersize": 6 if marker == "." else 7}
        axes.plot(flights.across[kept], flights.height[kept], marker, **style)
        if kept.any():
            axes.plot([], [], marker, label=label, **style)
    points = (p.points - p.goal) @ view.along
    axes.plot(points, p.plane - p.points[:, 2], "s", color="black", label="target points")
    axes.plot(0, p.height(float(p.goal[2])), "*", color="black", markersize=14, label="goal")
    start = np.array([float(c) for c in mission.start.position])
    axes.plot(
        (start - p.goal) @ view.along,
        p.height(float(start[2])),
        "D",
        color="white",
        markeredgecolor="black",
        label="start of the mission",
    )
    axes.set_xlim(-view.side, view.side)
    axes.set_ylim(view.bottom, view.top)
    axes.set_aspect("equal")
    axes.set_xlabel("horizontal distance from the goal, toward the start (m)")
    axes.set_ylabel("height above the target (m)")
    axes.set_title("cross-section")
    axes.grid(alpha=0.3)


def _edge(region: Attraction, view: View) -> tuple[Array, float | None]:
    """Return where rays from the goal leave the certified hovers, and where some are cut, m."""
    p = view.potential
    polar, around = np.linspace(0, np.pi, 40), np.linspace(0, 2 * np.pi, 60)
    a, b = np.meshgrid(polar, around, indexing="ij")
    rays = np.stack([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)], axis=-1)
    steps = np.linspace(0.01, 1, 40) * min(view.side, view.top)
    places = (p.goal + rays[:, :, None] * steps[:, None]).reshape(-1, 3)
    outside = outside_by(region, places, p.hover_terms(places)).reshape(*a.shape, -1)
    ended = (outside > 0).any(axis=2)
    first = np.where(ended, (outside > 0).argmax(axis=2), len(steps) - 1)
    last = np.maximum(first - 1, 0)
    near, far = (np.take_along_axis(outside, i[..., None], 2)[..., 0] for i in (last, first))
    part = np.divide(-near, far - near, out=np.ones_like(near), where=ended & (near < 0))
    reach = steps[last] + part * (steps[first] - steps[last])
    return p.goal + rays * reach[..., None], None if ended.all() else float(steps[-1])


def _draw_space(axes: Any, region: Attraction, view: View) -> None:
    p, (edge, cut) = view.potential, _edge(region, view)
    axes.plot_surface(
        edge[..., 0],
        edge[..., 1],
        p.plane - edge[..., 2],
        color="#56B4E9",
        alpha=0.35,
        linewidth=0.2,
        edgecolor="#0072B2",
    )
    axes.scatter(
        p.points[:, 0], p.points[:, 1], p.plane - p.points[:, 2], marker="s", color="black"
    )
    x, y, z = p.goal
    axes.scatter([x], [y], [p.plane - z], marker="*", s=120, color="black")
    axes.set_xlabel("x (m)", labelpad=8)
    axes.set_ylabel("y (m)", labelpad=8)
    axes.set_zlabel("height (m)")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(4))
    axes.set_xlim(edge[..., 0].min(), edge[..., 0].max())  # so that the numbers of two axes do
    axes.set_ylim(edge[..., 1].min(), edge[..., 1].max())  # not meet in their common corner
    axes.set_title("certified hovers" + (f", cut at {cut:.3g} m from the goal" if cut else ""))
    shown = np.vstack([edge.reshape(-1, 3), p.points, p.goal])
    axes.set_box_aspect(np.ptp(shown, axis=0), zoom=0.88)
    axes.view_init(elev=18, azim=-60)


def draw_energy(axes: Axes, region: Attraction, flights: Flights) -> None:
    """Draw Λ along simulated flights, and the proved level.

    The flights are of the vehicle as modelled, of which Ψ of the theorem about tolerances is Λ.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    region : Attraction
    flights : Flights
    """
    level = float(region.level)
    for kept, colour, style, label in (
        (flights.certified, COLOURS[0], "-", "start certified"),
        (~flights.certified, COLOURS[3], "--", "start not certified"),
    ):
        over = 3 if kept is flights.certified else 2  # the certified are not to be hidden
        look: dict[str, Any] = {"color": colour, "linestyle": style}
        for energy in flights.energy[kept]:
            axes.semilogy(flights.time, energy, **look, linewidth=0.8, alpha=0.6, zorder=over)
        if kept.any():
            axes.plot([], [], **look, label=label)
    largest = max(np.nanmax(flights.energy), level)
    proved = f"proved level {at_least(region.level)}"
    axes.axhline(level, color="black", linestyle="--", label=proved)
    axes.set_ylim(AT_REST * largest, 10 * largest)
    plain_powers(axes.yaxis)
    last = int(np.nonzero(flights.energy > AT_REST * largest)[1].max(initial=0))
    axes.set_xlim(0, flights.time[min(last + 1, SAMPLES)])
    axes.set_xlabel("time (s)")
    axes.set_ylabel(f"{region.symbol} along simulated flights, as modelled (m)")
    legend_above(axes, 2)
