"""Fly vehicles within tolerance from proved starts: ``python benchmarks/exponential_flights.py``.

Half of the flights start at hover at the start of the mission, half all over the set {Ψ <= ℓ}.
Vehicle, wind and delay are drawn at random, at the corners, or chosen at each step as what makes Ψ
fall least. In no flight may Ψ(t) exceed Ψ(0) e^{-rt}, a point be seen outside of the proved cone, a
rotor leave its proved thrusts or any quantity its bound, and each has to be near the goal at the
proved time. The inequality itself is attacked by differential evolution. The exit status is 1 if
anything of the claim is contradicted.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from uncertain_body import Case
from uncertain_flights import fly, strongest

BLOCK = 4000


def trial(case, flights, duration, seed=1, *, anywhere=False):
    """Fly in blocks until so many are flown, and return them joined."""
    rng, done, radius = np.random.default_rng(seed), [], case.settling()[0]
    start, draws = (None, 4) if anywhere else (case.start, 1)  # a quarter of the draws is inside
    while sum(len(f.fall) for f in done) < flights:
        done.append(fly(case, rng, draws * min(BLOCK, flights), duration, radius, start=start))
    return done


def told(case, done):
    """Say what flights came to."""
    count = sum(len(f.fall) for f in done)

    def most(name):
        return max(float(getattr(f, name).max()) for f in done)

    def least(name):
        return min(float(getattr(f, name).min()) for f in done)

    bounds = {k: max(f.used[k] for f in done) for k in done[0].used}
    nearest = max(bounds, key=bounds.get)
    thrusts = min(f.thrust[0] for f in done), max(f.thrust[1] for f in done)
    rotors = ", ".join(map("{:.4g}".format, case.rotors))
    return (
        f"{count} flights, Ψ(0) to {most('level'):.3f} ℓ: Ψ(t) e^(rt) <= {most('ratio'):.4f} Ψ(0), "
        f"slowest fall of Ψ {least('fall'):.3f} 1/s in a step and {least('pace'):.3f} 1/s overall "
        f"(r = {case.r:.3g}); settled within {case.settling()[0]:.3g} m after "
        f"{most('settled'):.3g} s (proved: {case.settling()[1]:.3g} s); "
        f"|σ - σ*| <= {most('offset') / case.offset:.3f} d; "
        f"points within {np.degrees(np.arccos(least('cosine'))):.1f}°"
        f" (proved: {np.degrees(np.arccos(case.cosine or 0)):.1f}°); "
        f"rotors in [{thrusts[0]:.4g}, {thrusts[1]:.4g}] N (proved: [{rotors}]); "
        f"nearest to its bound: {nearest}, {bounds[nearest]:.3f}"
    )


def main():
    """Fly, and print what came of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("certificate", type=Path)
    parser.add_argument("--flights", type=int, default=100_000)
    parser.add_argument("--duration", type=float, help="s; by default the proved settling time")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    case = Case(json.loads(options.certificate.read_text(encoding="utf-8")))
    soon = case.settling()[1]
    duration, wrong = options.duration or 1.01 * soon, []
    for anywhere in (False, True):
        began = time.perf_counter()
        done = trial(case, options.flights // 2, duration, options.seed, anywhere=anywhere)
        print(f"{told(case, done)}; {time.perf_counter() - began:.0f} s", flush=True)
        wrong += [line for flown in done for line in flown.contradicts(case, duration)]
    for near in (1.0, 0.3, 0.03):
        value, _ = strongest(case, options.seed, 200, near=near)
        print(f"largest (Ψ' + rΨ)/Ψ found, positions {near:g}: {value:.4f} 1/s", flush=True)
        wrong += [f"Ψ' + rΨ is {value:.4f} Ψ, positions {near:g}"] if value > 0 else []
    print("\n".join(["CONTRADICTED:", *wrong] if wrong else ["nothing contradicts the claim"]))
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
