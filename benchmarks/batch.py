"""Time many flights at once against one at a time, and against other ways to run the same loop.

Run ``python benchmarks/batch.py``; ``--write`` puts the table into the README beside it. JAX and
RotorPy are timed if they are installed.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from closed_loop import DT, TILTED, N, hand_written, numpy_run, plain_rate, plain_step
from hoverproof.compilers import find_compiler
from hoverproof.mission.reading import load
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import compiled, kernel
from hoverproof.simulation.block import fly_raw
from hoverproof.simulation.plan import Plan
from hoverproof.simulation.step import flight_states
from hoverproof.spread import processors, spread
from tables import report

ROUNDS = 40
PLAIN_FLAGS = ("-O3", "-march=native", "-fPIC", "-shared", "-w")
VEHICLES, STEPS = 64, 4000
"""In a block of the batch; a flight of 40 s."""


@dataclass
class Peer:
    """A way to fly.

    Attributes
    ----------
    run : callable
        Flies, and returns where the first vehicle is after so many steps, (3,), or None if that
        cannot be compared.
    steps : int
        Vehicle-steps of 10 ms that it takes.
    flight : int
        Length of a flight, in steps.
    seconds, processor_seconds : float
        The shortest time so far, by the clock and on the processors.
    difference : float
        Of where the first vehicle ends from the single flight, m.
    """

    run: Callable[[], np.ndarray | None]
    steps: int
    flight: int
    seconds: float = np.inf
    processor_seconds: float = np.inf
    difference: float = np.nan

    @property
    def rate(self) -> float:
        """Millions of vehicle-steps in a second."""
        return self.steps / self.seconds / 1e6

    @property
    def processor_rate(self) -> float:
        """Millions of vehicle-steps in a second of a processor."""
        return self.steps / self.processor_seconds / 1e6


def batch(threads: int) -> Peer:
    """Return the batch kernel on so many threads, two blocks each, of 400 s of flight."""
    plan = Plan(load("x4-flyer", TILTED), DT, 10, STEPS)
    parts = [(i * VEHICLES, VEHICLES) for i in range(2 * threads)]

    def run() -> np.ndarray:
        flown = list(spread(lambda part: fly_raw(plan, *part), parts, threads=threads))
        return flown[0][0][0, -1, :3]

    return Peer(run, len(parts) * VEHICLES * 10 * STEPS, 10 * STEPS)


def one_vehicle(run: Callable, numbers: LoopNumbers, steps: int) -> Peer:
    """Return a runner as a peer."""
    (start,) = flight_states(numbers.start[None], numbers.goal, numbers.points)

    def fly() -> np.ndarray:
        states, good = run(start, numbers.design, numbers.points, DT, 1, steps)
        assert good
        return states[-1, :3]

    return Peer(fly, steps, steps)


def plain_casadi(folder: Path) -> Callable:
    """Return the generated step and its driver as CasADi's users compile it."""
    source, library = folder / "plain.c", folder / "plain.so"
    text = compiled.c_source(N).removeprefix(compiled.PREAMBLE)
    source.write_text(f"#define CASADI_SYMBOL_EXPORT static\n{text}")
    command = [find_compiler(), *PLAIN_FLAGS, str(source), "-o", str(library), "-lm"]
    subprocess.run(command, check=True)
    return compiled._machine_code(ctypes.CDLL(str(library))).run


def scipy_peer(numbers: LoopNumbers, steps: int) -> Peer:
    """Return SciPy's solver with the right-hand side in numpy."""

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return plain_rate(np, x, numbers.design, numbers.points)

    def run() -> np.ndarray:
        done = solve_ivp(rate, (0, steps * DT), numbers.start, method="RK45", rtol=1e-8, atol=1e-9)
        return done.y[:3, -1]

    return Peer(run, steps, steps)


def jax_peer(numbers: LoopNumbers, vehicles: int, steps: int) -> Peer:
    """Return the step in JAX: jit, vmap over vehicles, float64, on the processor."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")
    design, points = jnp.array(numbers.design), jnp.array(numbers.points)
    step = partial(plain_step, jnp, design=design, points=points, dt=DT)

    @jax.jit
    def fly(flights: jax.Array) -> jax.Array:
        return jax.lax.fori_loop(0, steps, lambda _, x: jax.vmap(step)(x), flights)

    (start,) = flight_states(numbers.start[None], numbers.goal, numbers.points)
    starts = jnp.array(np.tile(start, (vehicles, 1)))
    fly(starts).block_until_ready()  # compiled
    return Peer(lambda: np.array(fly(starts))[0, :3], vehicles * steps, steps)


def rotorpy_peer(steps: int) -> Peer:
    """Return RotorPy's own loop: its vehicle, its controller, its integrator, hovering."""
    from rotorpy.controllers.quadrotor_control import SE3Control
    from rotorpy.environments import Environment
    from rotorpy.trajectories.hover_traj import HoverTraj
    from rotorpy.vehicles.crazyflie_params import quad_params
    from rotorpy.vehicles.multirotor import Multirotor

    world = Environment(
        vehicle=Multirotor(quad_params),
        controller=SE3Control(quad_params),
        trajectory=HoverTraj(),
        sim_rate=round(1 / DT),
    )

    def run() -> None:
        world.run(
            t_final=steps * DT,
            use_mocap=False,
            terminate=False,
            plot=False,
            plot_mocap=False,
            plot_estimator=False,
            plot_imu=False,
            animate_bool=False,
            verbose=False,
        )

    return Peer(run, steps, steps)


def peers(folder: Path) -> dict[str, Peer]:
    """Return what is timed, by name."""
    numbers = LoopNumbers.of(load("x4-flyer", TILTED))
    found = {
        "batch kernel, 1 thread": batch(1),
        "batch kernel, 2 threads": batch(2),
        "CasADi's C, scalar, `-O3 -march=native`": one_vehicle(
            plain_casadi(folder), numbers, 10 * STEPS
        ),
        "one flight, `hoverproof simulate`": one_vehicle(
            compiled.runner(N).run, numbers, 10 * STEPS
        ),
        "one flight, C by hand, the same flags": one_vehicle(
            hand_written(compiled.FLAGS, folder), numbers, 10 * STEPS
        ),
        "numpy, one vehicle": one_vehicle(numpy_run, numbers, 200),
        "SciPy `solve_ivp`, one vehicle": scipy_peer(numbers, STEPS),
    }
    for name, make in (
        ("JAX, 512 vehicles", lambda: jax_peer(numbers, 512, 400)),
        ("RotorPy's own loop, one vehicle", lambda: rotorpy_peer(50)),
    ):
        try:
            found[name] = make()
        except ImportError as error:
            print(f"{name}: not installed ({error})")
    return found


def main() -> None:
    """Measure in turns, compare where they end, print and, if asked, write."""
    with tempfile.TemporaryDirectory() as name:
        timed = peers(Path(name))
        for _ in range(ROUNDS):
            for peer in timed.values():
                begin, used = time.perf_counter(), time.process_time()
                end = peer.run()
                peer.seconds = min(peer.seconds, time.perf_counter() - begin)
                peer.processor_seconds = min(peer.processor_seconds, time.process_time() - used)
                if end is not None:
                    numbers = LoopNumbers.of(load("x4-flyer", TILTED))
                    wanted = one_vehicle(compiled.runner(N).run, numbers, peer.flight).run()
                    peer.difference = float(np.abs(end - wanted).max())
                    assert peer.difference < 1e-5, peer
    scalar = timed["CasADi's C, scalar, `-O3 -march=native`"].rate
    rows = [
        f"| {name} | {peer.rate:,.3g} | {peer.processor_rate:,.3g} | {peer.rate / scalar:,.3g} "
        f"| {'other' if np.isnan(peer.difference) else f'{peer.difference:.0e} m'} |"
        for name, peer in timed.items()
    ]
    lanes = kernel.machine(kernel.ideal_loop(N), kernel.Schedule(1, 1))
    one, two = (timed[f"batch kernel, {n}"] for n in ("1 thread", "2 threads"))
    share = two.processor_rate / one.processor_rate
    single = timed["one flight, `hoverproof simulate`"].rate
    by_hand = timed["one flight, C by hand, the same flags"].rate
    text = "\n".join(
        [
            "| what | million vehicle-steps a second | per processor-second "
            "| ratio to scalar C | difference |",
            "| --- | ---: | ---: | ---: | ---: |",
            *rows,
            "",
            f"The batch kernel is {lanes}, on {processors()} processors. One thread against the "
            f"scalar C: {one.rate / scalar:.1f}; two threads against one: "
            f"{two.rate / one.rate:.2f} by the clock, and each at {share:.0%} of the speed of one "
            "by processor time, which does not count what else the machine does; a single flight "
            f"takes {by_hand / single:.2f} times as long as C by hand.",
        ]
    )
    report("batch", text)


if __name__ == "__main__":
    main()
