"""What tolerances cost: how much of the level a start takes, with and without them.

Run ``python benchmarks/tolerances.py``; ``--write`` puts the table into the README beside it. The
share is of a search in floating point, by the theorem that needs less, without a barrier, with the
measured force (which allows errors of thrust); a start is inside where it is 1 or less.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from pathlib import Path

from hoverproof.certification.attraction import proof as potential
from hoverproof.certification.attraction.starts import Start
from hoverproof.certification.exponential.positions import Scene
from hoverproof.certification.exponential.proof import ROOMS
from hoverproof.certification.exponential.question import Question
from hoverproof.certification.exponential.search import deepest
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.mission.presets import presets
from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission
from tables import report

HALF_KILO = Path(__file__).parents[1] / "examples" / "half-kilo.toml"
SHORT = {"gains.k1": "0.00466", "gains.k2": "18.1", "gains.k3": "0.114", "gains.k4": "0.3416"}
"""Gains for the centroid of a Crazyflie with the paper's law, with a high k2."""
CENTROID = Path(__file__).parents[1] / "tests" / "missions" / "crazyflie-2.1.toml"
NONE = dict.fromkeys(("thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate"), 0)
BOTH = {"thrust": 0.2, "torque": 0.2}
SETS = {"none": {}, "±20 %": BOTH, "±20 %, 83 ms": {**BOTH, "latency": 0.083}}
MUCH = 100.0
"""By so much Ψ at the start is enlarged, so that the search does not end before the best."""


def share(mission: Mission) -> float | None:
    """Return Ψ at the start over the highest level found; None if no weights satisfy it."""
    whole = Question.of(Vehicles.of(mission), Scene.of(mission), (Start.of(mission),))
    question = replace(whole, wider=ROOMS[0][0], highest=ROOMS[0][1])
    best = deepest(question, MUCH * question.terms())
    found = [] if best is None else [best.solution.fill / MUCH]
    if mission.law.feature == "centroid":
        with contextlib.suppress(ValueError):  # no weights
            found.append(potential.estimate(mission, objective="start", barrier=False).fill)
    return min(found, default=None)


def told(shares: list[float | None]) -> str:
    """Say what the tolerances come to."""
    first, both, _ = shares
    if first is None or both is None:
        return "not proved with these gains: no weights satisfy the inequality"
    cost = f"±20 % cost {100 * (both / first - 1):.1f} %"
    return f"not proved with these gains, not even alone; {cost}" if first > 1 else cost


def main() -> None:
    """Search each, print the table."""
    rows = ["| mission | none | ±20 % | ±20 %, 83 ms | |", "| --- | ---: | ---: | ---: | --- |"]
    cases = [(name, {}) for name in presets()] + [(str(CENTROID), SHORT), (str(HALF_KILO), {})]
    for name, gains in cases:
        shares = []
        for asked in SETS.values():
            may = {f"uncertainty.{k}": v for k, v in {**NONE, **asked}.items()}
            own = {"law.force": "measured", "sensors.gyro_turned": True}
            shares.append(share(load(name, {**gains, **may, **own})))
        words = f"`{load(name).name}`" + (", centroid, k2 = 18.1 1/m" if gains else "")
        numbers = " | ".join("none found" if x is None else f"{x:.3f}" for x in shares)
        rows.append(f"| {words} | {numbers} | {told(shares)} |")
        print(rows[-1], flush=True)
    report("tolerances", "\n".join(rows))


if __name__ == "__main__":
    main()
