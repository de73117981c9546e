"""Fly vehicles within tolerance from proved starts: ``python benchmarks/exponential_flights.py``.

Half of the flights start at hover at the start of the mission, half all over the set {Ψ <= ℓ}.
Vehicle, wind and delay are drawn at random, at the corners, or chosen at each step as what makes Ψ
fall least. In no flight may Ψ(t) exceed Ψ(0) e^{-rt}, nor may any quantity leave its bound. The
inequality itself is attacked by differential evolution.
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

BLOCK = 1000


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
    return (
        f"{count} flights, Ψ(0) to {most('level'):.3f} ℓ: Ψ(t) e^(rt) <= {most('ratio'):.4f} Ψ(0), "
        f"slowest fall of Ψ {least('fall'):.3f} 1/s in a step and {least('pace'):.3f} 1/s overall "
        f"(r = {case.r:.3g}); settled within {case.settling()[0]:.3g} m after "
        f"{most('settled'):.3g} s (proved: {case.settling()[1]:.3g} s); "
        f"|σ - σ*| <= {most('offset') / case.offset:.3f} d; "
        f"points within {np.degrees(np.arccos(least('cosine'))):.1f}°; "
        f"nearest to its bound: {nearest}, {bounds[nearest]:.3f}"
    )


def main():
    """Fly, and print what came of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("certificate", type=Path)
    parser.add_argument("--flights", type=int, default=100_000)
    parser.add_argument("--duration", type=float, default=12.0, help="s")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    case = Case(json.loads(options.certificate.read_text(encoding="utf-8")))
    for anywhere in (False, True):
        began = time.perf_counter()
        done = trial(case, options.flights // 2, options.duration, options.seed, anywhere=anywhere)
        print(f"{told(case, done)}; {time.perf_counter() - began:.0f} s", flush=True)
    for near in (1.0, 0.3, 0.03):
        value, _ = strongest(case, options.seed, 200, near=near)
        print(f"largest (Ψ' + rΨ)/Ψ found, positions {near:g}: {value:.4f} 1/s", flush=True)


if __name__ == "__main__":
    main()
