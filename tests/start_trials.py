"""Vehicles at random for which `tune` is asked for gains, and gains at random that it is to beat.

``python tests/start_trials.py --vehicles 50`` tunes for so many vehicles, and follows the advice
where there are no gains; ``--gains 10000`` looks among so many for any that settle sooner.
"""

from __future__ import annotations

import argparse
import math
import tomllib
from fractions import Fraction

import numpy as np

from hoverproof.certification.exponential.proof import settling
from hoverproof.certification.exponential.sooner import OUTSIDE
from hoverproof.design.start_search import StartSearch
from hoverproof.design.tuning import Wish, tune
from hoverproof.mission.reading import load

LAW = {"law": '{feature = "scaled", goal = "inertial", force = "measured"}'}
SOONER, HOPELESS = 0.98, 0.3
"""What counts as sooner, as a share; and of the rate then needed the share that is missing at d and
force of the best gains beyond which no others are looked for."""


def vehicle(number):
    """Return a mission: 20 g to 20 kg, a tag of 8 cm to 2 m, a height to 15 tags; all sensible."""
    rng = np.random.default_rng([17, number])

    def between(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    mass, tag = between(0.02, 20), between(0.08, 2)
    height = tag * between(3, 15)
    arm = 0.22 * mass ** (1 / 3) * between(0.7, 1.4)
    about = mass * arm**2 * between(0.15, 0.35)
    pace = math.sqrt(height / 9.81)  # s; what is fast near the ground is slow far above it
    half, side = tag / 2, height * rng.uniform(0, 0.3)
    numbers = {
        "name": f'"vehicle-{number}"',
        "vehicle.mass": f"{mass:.4g}",
        "vehicle.inertia": f"[{about:.4g}, {about * between(0.9, 1.1):.4g}, {1.6 * about:.4g}]",
        "vehicle.lever": f"{arm:.3g}",
        "vehicle.drag_ratio": f"{arm * between(0.05, 0.2):.3g}",
        "target.points": str([[x, y, 0] for x, y in square(round(half, 4))]),
        "goal.height": f"{height:.4g}",
        "start.position": f"[{side:.4g}, 0, {-height * rng.uniform(0.9, 1.3):.4g}]",
        "bounds": '{eigenvalues = "auto", level = 20}',
        "sensors": "{gyro_turned = true, control_rate = 250}",
        "uncertainty": (
            f"{{thrust = {rng.uniform(0.05, 0.2):.2g}, torque = {rng.uniform(0.05, 0.2):.2g}, "
            f"latency = {min(0.08, 0.15 * pace):.2g}, rotor_lag = {min(0.05, 0.08 * pace):.2g}, "
            "wind = 0.2, yaw_rate = 0.5}"
        ),
        "rotors": f"{{max_thrust = {mass * 9.81 / 4 * rng.uniform(1.7, 3):.4g}}}",
        "camera": f"{{half_angle = {rng.uniform(0.75, 1.1):.2g}}}",
    }
    return load("crazyflie-2.1", LAW | numbers)


def square(half):
    """Return the corners of a square."""
    return (half, half), (half, -half), (-half, -half), (-half, half)


def followed(mission, advice):
    """Return a mission changed as advised."""
    changed = mission.model_dump()
    for setting in advice.settings:
        key, value = setting.split("=", 1)
        section, name = key.split(".")
        changed[section][name] = tomllib.loads(f"x = {value}", parse_float=str)["x"]
    return type(mission)(**changed)


def sooner(mission, count, seed=1, limits=None):
    """Return gains at random that are found to settle sooner than the best found, and its time."""
    search = StartSearch.of(mission, limits or Wish().limits(mission))
    best = search.run(lambda text: None)
    assert best is not None
    assert best.cost < OUTSIDE
    rng, found, goal = np.random.default_rng(seed), [], best.cost + math.log(SOONER)
    wanted = best.z.copy()
    wanted[6] -= math.log(SOONER)  # at the same d the rate that is needed
    for k in range(count):
        four = best.z[:4] + rng.normal(0, (0.1, 0.4, 1.2)[k % 3], 4)
        if (search.held_to.beyond(np.exp(four[None])) > 0).any():
            continue
        at = search.value(np.array([*four, *wanted[4:]]))
        if at is None or at.over[0] > HOPELESS:
            continue
        point = search.best_for(np.exp(four), best.z[None, 4:])
        if point.cost < goal:
            found.append((np.exp(four), math.exp(point.cost)))
    return found, math.exp(best.cost)


def soonest_at_random(mission, count, spread=0.3, seed=1, limits=None):
    """Return the least time that is found for gains at random about a mission's own, within limits.

    Each is asked as `attraction` asks; None if none of them has one.
    """
    search, least = StartSearch.of(mission, limits or Wish().limits(mission)), None
    rng = np.random.default_rng(seed)
    for _ in range(count):
        four = [float(f"{k:.3g}") for k in search.own * np.exp(rng.normal(0, spread, 4))]
        if (search.held_to.beyond(np.array([four])) > 0).any():
            continue
        names = search.whole.vehicles.law.design.chain_gains()
        gains = {name: Fraction(str(k)) for name, k in zip(names, four, strict=True)}
        changed = mission.gains.model_copy(update=gains)
        found = settling(mission.model_copy(update={"gains": changed}))
        if found is not None and (least is None or found.time < least):
            least = found.time
    return least


def main():
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vehicles", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--gains", type=int, default=0)
    parser.add_argument("--mission", default=None)
    options = parser.parse_args()
    held = 0
    for number in range(options.first, options.first + options.vehicles):
        mission = vehicle(number)
        answer = tune(mission)
        held += answer.status == "tuned"
        told = answer.reason if answer.status != "tuned" else f"{answer.verdict.settling.time} s"
        print(number, answer.status, told, flush=True)
        for advice in getattr(answer, "advice", ()):
            print("   ", advice.words, tune(followed(mission, advice)).status, flush=True)
    if options.vehicles:
        print(f"{held} of {options.vehicles} vehicles have gains that are proved for their start")
    if options.gains:
        mission = vehicle(0) if options.mission is None else load(options.mission)
        better, time = sooner(mission, options.gains)
        print(f"settled after {time:.4g} s; sooner by 2 %: {len(better)} of {options.gains} gains")
        print(*better, sep="\n")


if __name__ == "__main__":
    main()
