"""Fly from random states of certified regions: ``python benchmarks/attraction_flights.py``.

Every state is drawn inside a proved set, hover or not, any heading, where the camera sees the
target. In every flight Λ must fall at
each sample, the set must not be left, and the goal must be reached. At more random states inside,
Λ' <= -(k1/m) ε |Y|² must hold, Λ' by differentiation of Λ along the simulated closed loop.
"""

from __future__ import annotations

import argparse
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import casadi as ca
import numpy as np

from hoverproof.certification.attraction.motion import energy_function
from hoverproof.certification.attraction.proof import attraction
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.linearised import slowest_rate
from hoverproof.servo.loop import LoopNumbers, loop_rate
from hoverproof.servo.variables import Design
from hoverproof.simulation.compiled import runner
from hoverproof.simulation.step import flight_states

TUNED = {"gains.k1": "1", "gains.k4": "10"}
CASES = (
    ("paper, no barrier", {}, {"objective": "volume", "barrier": False}, 0.15),
    ("paper, barrier", {}, {}, 0.25),
    ("tuned, no barrier", TUNED, {"objective": "volume", "barrier": False}, 0.3),
    ("tuned, barrier", TUNED, {}, 0.3),
)
FARTHEST = 12.0  # m from the goal; farther hovers are inside too, but fly for hours
STEP = 0.04  # s
SAMPLES = 150
REACHED = 1e-5


@dataclass
class Case:
    """A region and its numbers in floating point."""

    region: Attraction

    def __post_init__(self):
        mission = self.region.mission
        numbers = LoopNumbers.of(mission)
        self.design, self.goal, self.points = numbers.design, numbers.goal, numbers.points
        self.a = np.array([float(w) for w in self.region.weights])
        v, k = mission.vehicle, mission.gains
        self.m, self.weight = float(v.mass), float(v.weight)
        self.k1, self.k2, self.k3 = (float(x) for x in (k.k1, k.k2, k.k3))
        self.c, self.q3 = self.k1**2 * self.k2 / self.m, self.design[-1]
        self.level = float(self.region.level)
        self.bottom = None
        if self.region.barrier_height is not None:
            plane = float(mission.height_of_target)
            self.bottom = plane - float(self.region.barrier_height)

    def value(self, x):
        """Return the potential, but for a constant."""
        return np.linalg.norm(self.points.T - x, axis=1).sum() + self.q3 * x[2]

    def draw(self, rng, hover):
        """Return a random state inside, (19,)."""
        low, high = self.goal - FARTHEST, self.goal + FARTHEST
        if self.bottom is None:
            low, high = self.goal - np.array([3, 3, 15]), self.goal + np.array([3, 3, 3.2])
        else:
            high[2] = self.bottom
        base = self.value(self.goal)
        while True:
            x = rng.uniform(low, high)
            room = self.level - (self.value(x) - base)
            if room <= 0:
                continue
            rays = self.points.T - x
            q = (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)
            heading = rng.uniform(0, 2 * np.pi)
            if hover:
                R, T, V, omega = turn(heading), self.weight, np.zeros(3), np.zeros(2)
                d1 = R.T @ q - [0, 0, self.q3]
                size = ((self.a[0] + self.a[1]) * d1 @ d1 + self.a[2] * d1[:2] @ d1[:2]) / 2
                if size > room:
                    continue
            else:
                y = rng.normal(size=8)
                y *= np.sqrt(2 * room * rng.uniform() / (y @ y))
                d2, d3, d4 = (
                    y[:3] / np.sqrt(self.a[0]),
                    y[3:6] / np.sqrt(self.a[1]),
                    y[6:] / np.sqrt(self.a[2]),
                )
                F = self.c * (d3 - d2)  # m g ρ = F + T e3 with |ρ| = 1
                T = np.sqrt(self.weight**2 - F[:2] @ F[:2]) - F[2]
                rho = np.array([F[0], F[1], F[2] + T]) / self.weight
                R = rotation_with(rho, heading)
                V = self.k1 / self.m * (R.T @ q - [0, 0, self.q3] + d2)
                beta = self.m / (self.c * (self.k1 * self.k2 + self.k3)) * (T - self.c * self.q3)
                s = (d4 - d3[:2]) / beta  # (-Ω2, Ω1)
                omega = np.array([s[1], -s[0]])
                if self.bottom is not None and not self.above(x[2], rho @ V, rho @ F / self.m):
                    continue
            if (R[:, 2] @ rays.T).min() <= 0:
                continue  # a point is behind the image plane: inside, but the camera is blind
            yaw_rate = 0.0 if hover else rng.normal() * 0.5
            return np.concatenate([x, V, R.T.ravel(), omega, [yaw_rate, T]])

    def above(self, z, z1, z2):
        """Tell whether the inequalities of the barrier hold, with the least lags.

        z <= zb, z + z'/r <= zb, N <= zb, z'' + r z' <= (κ c/m) w/s and z' <= (k1/m) w.
        """
        kappa = (self.k1 * self.k2 + self.k3) / self.m
        product = kappa * self.k1 * self.k2 / self.m
        root = np.sqrt(kappa**2 - 4 * product)
        r, s = (kappa - root) / 2, (kappa + root) / 2
        most = self.points.shape[1] - self.q3  # less than what is allowed
        D1, D2 = self.k1 / self.m * most / s, self.k1 / self.m * most / r
        x, N = z + z1 / r, z + kappa / product * (z1 + z2 / kappa)
        return max(z, x, N) <= self.bottom and N - x <= D1 and x - z <= D2


def turn(angle):
    """Return the rotation about the vertical."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def rotation_with(rho, heading):
    """Return a rotation R with Rᵀe3 = rho."""
    v = np.array([rho[1], -rho[0], 0])  # rho x e3
    K = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return turn(heading) @ (np.eye(3) + K + K @ K / (1 + rho[2]))


def fly(case, machine, energy, start, duration):
    """Fly until the goal is reached.

    Return whether it is, whether the camera lost the target, the largest rise of Λ, the largest
    Λ/ℓ, and how far below the barrier it came, m.
    """
    (state,) = flight_states(start[None], case.goal, case.points)
    every = max(1, int(duration / STEP / SAMPLES))
    for _ in range(12):
        states, good = machine.run(state, case.design, case.points, STEP, SAMPLES, every)
        if not good:
            return False, True, -np.inf, 0, -np.inf
        track = np.vstack([state, states])[:, :STATE_SIZE]
        value = energy(track)
        rise = np.diff(value).max(initial=-np.inf, where=value[:-1] > 1e-8)
        if rise > 0 or value.max() > case.level or value[-1] < REACHED:
            break
        state = states[-1].copy()
    lowest = -np.inf if case.bottom is None else track[:, 2].max() - case.bottom
    return value[-1] < REACHED, False, rise, value.max() / case.level, lowest


def rates(case, states):
    """Return Λ' + (k1/m) ε |Y|² and |Y|² at states, (k, 19)."""
    n = case.points.shape[1]
    x, d, p = ca.SX.sym("x", STATE_SIZE), Design.symbols(), ca.SX.sym("points", 3, n)
    goal, a = ca.SX.sym("goal", 3), ca.SX.sym("a", 3)
    energy, Y = energy_function(n)(x, d.vector(), p, goal, a)
    rate = ca.jtimes(energy, x, loop_rate(x, d, p))
    value = ca.Function("rate", [x, d.vector(), p, goal, a], [rate, ca.dot(Y, Y)])
    k = len(states)
    held = [np.tile(v[:, None], k) for v in (case.design,)] + [np.tile(case.points, k)]
    held += [np.tile(v[:, None], k) for v in (case.goal, case.a)]
    rate, square = (np.array(v)[0] for v in value.map(k)(states.T, *held))
    return rate + case.k1 / case.m * float(case.region.rate) * square, square


def trial(region, flights, states, threads=2, seed=1):
    """Fly from random states of a region, and differentiate Λ at more of them.

    Return what the flights came to, and Λ'/((k1/m)|Y|²) + ε at the states.
    """
    case, rng = Case(region), np.random.default_rng(seed)
    machine, duration = runner(case.points.shape[1]), 4 / slowest_rate(region.mission)
    read, k = energy_function(case.points.shape[1]).map(SAMPLES + 1), SAMPLES + 1
    held = [np.tile(case.design[:, None], k), np.tile(case.points, k)]
    held += [np.tile(v[:, None], k) for v in (case.goal, case.a)]

    def one(start):
        def energy(track):
            return np.array(read(track.T, *held)[0])[0]

        return fly(case, machine, energy, start, duration)

    starts = [case.draw(rng, hover=i % 3 == 0) for i in range(flights)]
    with ThreadPoolExecutor(threads) as pool:
        reached, lost, rise, fill, low = (
            np.array(v) for v in zip(*pool.map(one, starts), strict=True)
        )
    flown = {
        "flights": flights,
        "reach the goal": int(reached.sum()),
        "Λ rises": int((rise > 0).sum()),
        "leave the level": int((fill > 1).sum()),
        "pass the barrier": int((low > 0).sum()),
        "lose the target": int(lost.sum()),
    }
    drawn = np.array([case.draw(rng, hover=False) for _ in range(states)])
    excess, square = rates(case, drawn)
    return flown, excess / square * case.m / case.k1


def main():
    """Fly, and print what came of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--flights", type=int, default=1000)
    parser.add_argument("--states", type=int, default=10_000)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    for name, overrides, asked, share in CASES:
        began = time.perf_counter()
        region = attraction(load("x4-flyer", overrides), **asked)
        assert isinstance(region, Attraction), region
        flown, excess = trial(
            region,
            round(share * options.flights),
            round(share * options.states),
            options.threads,
        )
        print(f"{name}: {', '.join(f'{word} {count}' for word, count in flown.items())};")
        print(
            f"  {len(excess)} states, Λ' > -(k1/m) ε|Y|² at {int((excess > 0).sum())}, "
            f"least -(m/k1) Λ'/|Y|² - ε = {-excess.max():.3g}; "
            f"{time.perf_counter() - began:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
