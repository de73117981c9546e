"""Time one step of the closed loop: the project's code, C by hand, numpy and CasADi's machine.

Run ``python benchmarks/closed_loop.py``; ``--write`` puts the table into the README beside it.
"""

from __future__ import annotations

import ctypes
import os
import platform
import shlex
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.compilers import find_compiler
from hoverproof.mission.reading import load
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import compiled
from hoverproof.simulation.step import FLIGHT_SIZE, flight_states
from tables import report

HERE = Path(__file__).parent

Array = NDArray[np.float64]
Run = Callable[[Array, Array, Array, float, int, int], tuple[Array, bool]]

N, DT, ROUNDS, AGREEMENT = 4, 0.01, 30, 1e-9
TILTED = {"start.rotation": [0.1, -0.05, 0.4], "start.rates": [0.1, -0.1, 0.2]}
PLAIN_FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")
KINDS = [slice(0, 3), slice(3, 6), slice(6, 15), slice(15, 18), slice(18, 19), slice(19, 21)]
"""Position, velocity, rotation, rate, thrust and guards in a flight state."""


@dataclass
class Peer:
    """A way to run the loop, with the length of the flight it is timed on.

    Attributes
    ----------
    run : callable
        As `hoverproof.simulation.compiled.Runner.run`.
    samples, every : int
        It takes samples * every steps.
    seconds : float
        The shortest flight so far.
    error : float
        Largest difference from the C by hand, relative to the largest value of its kind.
    """

    run: Run
    samples: int
    every: int
    seconds: float = np.inf
    error: float = np.nan

    @property
    def ns_per_step(self) -> float:
        """Time of a step in the shortest flight, ns."""
        return self.seconds / (self.samples * self.every) * 1e9


def hand_written(flags: Iterable[str], folder: Path) -> Run:
    """Compile closed_loop.c and load it the way the project loads its own."""
    library = Path(tempfile.mkstemp(suffix=".so", dir=folder)[1])
    compiler = shlex.split(find_compiler())
    sizes = (f"-DHP_DIVERGED={compiled.DIVERGED}", f"-DHP_FLIGHT={FLIGHT_SIZE}")
    inputs = (*sizes, str(HERE / "closed_loop.c"))
    subprocess.run([*compiler, *flags, *inputs, "-o", str(library), "-lm"], check=True)
    return compiled._machine_code(ctypes.CDLL(str(library))).run


def plain_rate(xp: ModuleType, x: Array, design: Array, points: Array) -> Array:
    """Return the time derivative of a packed state as one would write it with numpy, (19,).

    Parameters
    ----------
    xp : module
        numpy, or what looks like it.
    x : (19,)
    design : (13,)
    points : (3, n)
    """
    m, g, inertia, (k1, k2, k3, k4, k_yaw) = design[0], design[1], design[2:5], design[5:10]
    goal, e3 = design[10:], xp.array([0.0, 0.0, 1.0])
    c = k1**2 * k2 / m
    beta = m / (c * (k1 * k2 + k3))

    def skew(a: Array) -> Array:
        return xp.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])

    velocity, rotation, omega, thrust = x[3:6], x[6:15].reshape(3, 3).T, x[15:18], x[18]
    seen = rotation.T @ (points - x[:3, None])
    rays = xp.vstack([seen[:2] / seen[2], xp.ones(N)])
    q = (rays / xp.linalg.norm(rays, axis=0)).sum(axis=1)

    turn = skew(omega)
    force = m * g * rotation[2] - thrust * e3
    d2 = m / k1 * velocity - (q - goal)
    d3 = force / c + d2
    w = thrust * e3 - c * goal
    lever = -turn @ w
    d4 = beta * lever + d3

    thrust_rate = lever[2] + d3[2] / beta
    drift = -turn @ d3 + lever / c + force / k1
    wanted = -((k1 * k2 + k3) * d3 + k4 * d4) / m
    rest = (wanted - drift) / beta - thrust_rate * skew(e3) @ omega
    yaw = -k_yaw / inertia[2] * omega[2]
    alpha = xp.array([(rest[1] + w[0] * yaw) / w[2], (w[1] * yaw - rest[0]) / w[2], yaw])
    torque = inertia * alpha + turn @ (inertia * omega)

    return xp.concatenate(
        [
            rotation @ velocity,
            force / m - turn @ velocity,
            (rotation @ turn).T.ravel(),
            (torque - turn @ (inertia * omega)) / inertia,
            xp.array([thrust_rate]),
        ]
    )


def plain_step(xp: ModuleType, flight: Array, design: Array, points: Array, dt: float) -> Array:
    """Return a flight state after one step, its log as it was, as one would write it with numpy."""
    x, (depth, margin), log = flight[:19], flight[19:21], flight[21:]
    depths = x[6:15].reshape(3, 3)[2] @ (points - x[:3, None])
    depth = xp.minimum(depth, depths.min())
    margin = xp.minimum(margin, x[18] - design[5] ** 2 * design[6] / design[0] * design[12])
    a = plain_rate(xp, x, design, points)
    b = plain_rate(xp, x + dt / 2 * a, design, points)
    c = plain_rate(xp, x + dt / 2 * b, design, points)
    d = plain_rate(xp, x + dt * c, design, points)
    x = x + dt / 6 * (a + 2 * b + 2 * c + d)
    rotation = x[6:15].reshape(3, 3).T
    rotation = (rotation @ (3 * xp.eye(3) - rotation.T @ rotation) / 2).T.ravel()
    return xp.concatenate([x[:6], rotation, x[15:], xp.array([depth, margin]), log])


def numpy_run(
    start: Array, design: Array, points: Array, dt: float, samples: int, every: int
) -> tuple[Array, bool]:
    """Run the loop with numpy, in the manner of `Runner.run`."""
    flight, taken = start, []
    for _ in range(samples):
        for _ in range(every):
            flight = plain_step(np, flight, design, points, dt)
        taken.append(flight)
        if compiled.has_diverged(flight) or not (flight[19:21] > 0).all():
            return np.array(taken), False
    return np.array(taken), True


def measure(peers: list[Peer], reference: Peer) -> None:
    """Time the peers in turn, several times over, and assert that they agree."""
    numbers = LoopNumbers.of(load("x4-flyer", TILTED))
    (start,) = flight_states(numbers.start[None], numbers.goal, numbers.points)

    def fly(run: Run, peer: Peer) -> Array:
        states, good = run(start, numbers.design, numbers.points, DT, peer.samples, peer.every)
        assert good
        return states

    for _ in range(ROUNDS):
        for peer in peers:
            begin = time.perf_counter()
            states = fly(peer.run, peer)
            peer.seconds = min(peer.seconds, time.perf_counter() - begin)
            wanted = fly(reference.run, peer)
            peer.error = max(
                np.abs(states[:, k] - wanted[:, k]).max() / np.abs(wanted[:, k]).max()
                for k in KINDS
            )
            assert peer.error < AGREEMENT, peer


def table(peers: dict[str, Peer], reference: Peer) -> str:
    """Return the results as a Markdown table, with a line about where they come from."""
    compiler = shlex.split(find_compiler())
    version = subprocess.run([*compiler, "--version"], capture_output=True, text=True, check=True)
    rows = [
        f"| {name} | {peer.ns_per_step:,.0f} | {peer.ns_per_step / reference.ns_per_step:,.2f} |"
        for name, peer in peers.items()
    ]
    worst = max(peer.error for peer in peers.values())
    return "\n".join(
        [
            "| what | ns per step | ratio to hand-written C |",
            "| --- | ---: | ---: |",
            *rows,
            "",
            f"{platform.machine()} with {os.cpu_count()} CPUs, {version.stdout.splitlines()[0]}, "
            f"CasADi {ca.CasadiMeta.version()}, numpy {np.__version__}.",
            f"Largest relative difference from the hand-written C: {worst:.0e}.",
        ]
    )


def main() -> None:
    """Measure, print and, if asked, write."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        by_hand = Peer(hand_written(compiled.FLAGS, folder), 15, 1000)
        peers = {
            "hoverproof, compiled C": Peer(compiled.runner(N).run, 15, 1000),
            "C by hand, the same flags": by_hand,
            "C by hand, `-O3 -march=native`": Peer(hand_written(PLAIN_FLAGS, folder), 15, 1000),
            "CasADi virtual machine": Peer(compiled.runner(N, compiler="").run, 15, 100),
            "numpy": Peer(numpy_run, 15, 20),
        }
        measure(list(peers.values()), by_hand)
    report("closed_loop", table(peers, by_hand))


if __name__ == "__main__":
    main()
