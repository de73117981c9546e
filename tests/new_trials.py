"""Answers to `new` at random, all sensible: the mission is to be proved, and to fly as written.

``python tests/new_trials.py --count 300`` tries so many; ``--first N`` sets out at another.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

import numpy as np

from hoverproof.certification.convergence import attraction
from hoverproof.cli.first_mission import make
from hoverproof.cli.interview import without_asking
from hoverproof.design.outcome import StartTuned
from hoverproof.design.start_tuning import settled_in_flight
from hoverproof.design.tuning import tune
from hoverproof.mission.reading import load


def answers(number):
    """Return the answers of one who has a vehicle of 30 g to 5 kg and a tag of 10 cm to 1 m."""
    rng = np.random.default_rng([18, number])

    def between(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    mass, tag = between(0.03, 5), between(0.1, 1)
    height = tag * between(4, 10)
    pace = math.sqrt(height / 9.81)
    side, down = height * rng.uniform(0, 0.35), -height * rng.uniform(0.95, 1.4)
    said = {
        "mass": mass,
        "rotor_distance": 0.22 * mass ** (1 / 3) * between(0.7, 1.4),
        "rotor_lag": min(0.05, 0.1 * pace) * rng.uniform(0.3, 1),
        "tag": tag,
        "height": height,
        "latency": min(0.06, 0.1 * pace) * rng.uniform(0.3, 1),
        "thrust": rng.uniform(0.05, 0.2),
    }
    given = {name: f"{value:.3g}" for name, value in said.items()}
    given["frame_rate"] = str(int(rng.choice([30, 60, 90])))
    given["start"] = f"{side:.3g},0,{down:.3g}"
    return given


def outcome(number):
    """Say what became of an answer: "proved", or what it takes, and whether it flies there."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mine.toml"
        path.write_text(make(path, "mine", without_asking(answers(number))), encoding="utf-8")
        mission = load(path)
        verdict, how = attraction(mission), "proved"
        if verdict.proved is None:
            found = tune(mission)
            if not isinstance(found, StartTuned):
                return f"not proved: {verdict.reason}; {found.reason}"
            mission, verdict, how = found.mission, found.verdict, "proved after tune"
        settling = verdict.proved.settling
        time = settled_in_flight(mission, float(settling.radius), float(settling.time))
        flown = "does not fly there" if time is None else f"flown in {time:.3g} s"
        return f"{how}, {float(settling.time):.4g} s, {flown}"


def main():
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    for number in range(options.first, options.first + options.count):
        print(number, outcome(number), flush=True)


if __name__ == "__main__":
    main()
