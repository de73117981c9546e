"""Time `tune` and `atlas` against the same work done one inequality at a time.

Run ``python benchmarks/design.py``; ``--write`` puts the table into the README beside it.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace
from statistics import median

import numpy as np
from scipy.optimize import minimize

from hoverproof.certification.gains import certify
from hoverproof.certification.problem import gain_inequality, gain_problem
from hoverproof.certification.robust import Inequality, optimise
from hoverproof.design.atlas import atlas, axis
from hoverproof.design.axes import cell_mission
from hoverproof.design.margins import Questions, factor_of
from hoverproof.design.tuning import tune
from hoverproof.mission.reading import load
from tables import report

ROUNDS = 3
SAMPLE = 100
CASES = {
    "eigenvalues in [0.01, 5]": {},
    "proved over a box": {"bounds.eigenvalues": "auto"},
}


def cpu() -> float:
    """Return the CPU seconds of this process and of its finished children."""
    return sum(os.times()[:4])


def one_inequality(questions: Questions) -> float:
    """Return the margin of one question by the interior-point solver, at both ends of f."""
    ends = tuple(float(e) for e in questions.eigenvalues)
    k1, found = float(questions.gains[0][0]), []
    design = [float(np.ravel(x)[0]) for x in questions.design()]
    for thrust in questions.thrust:
        f = float(factor_of(questions, thrust)[0])
        one = gain_inequality(design, questions.weights, k1, ends, f)
        (term,) = one.terms
        corner = Inequality(one.S[None], (term._replace(u=term.u[None]),))
        corner = corner.less(np.array([0 * one.S, np.eye(len(one.S))]))  # S - t I, largest t
        solution = optimise([-1.0], [corner])
        if solution is None:
            raise RuntimeError("the solver found no multiplier")
        found.append(float(solution.x[0]))
    return min(found)


def nelder_mead(questions: Questions, bandwidth: float) -> tuple[float, float]:
    """Return the decay rate that a plain search from the own gains finds, and its CPU seconds."""
    begin, most = cpu(), bandwidth * questions.mass

    def cost(z: np.ndarray) -> float:
        k1, k12, k3 = np.exp(z)
        k4 = most - k12 - k3
        if k4 <= 0:
            return 1.0
        gains = tuple(np.array([k]) for k in (k1, k12 / k1, k3, k4))
        try:
            return -one_inequality(replace(questions, gains=gains))
        except RuntimeError:
            return 1.0

    own = [float(k[0]) for k in questions.gains]
    start = np.log([own[0], own[0] * own[1], own[2]])
    best = minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-5, "fatol": 1e-9})
    return -2 * float(best.fun) / questions.mass, cpu() - begin


def main() -> None:
    """Measure in turns, print the table."""
    rows = [
        "| what | decay rate 1/s | wall s | CPU s | ratio of CPU |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for name, change in CASES.items():
        mission = load("x4-flyer", change)
        own = float(certify(mission).decay_rate)
        walls, times = [], []
        for _ in range(ROUNDS):
            wall, begin = time.perf_counter(), cpu()
            tuned = tune(mission, objective="decay")
            walls.append(time.perf_counter() - wall)
            times.append(cpu() - begin)
        rate, plain = nelder_mead(Questions.of(gain_problem(mission)), 20.0)
        proved = float(tuned.verdict.decay_rate)
        rows.append(
            f"| tune, {name} | {proved:.4g}, proved: {proved / own:.2f} times the own "
            f"| {median(walls):.1f} | {median(times):.1f} | {median(times) / plain:.2f} |"
        )
        rows.append(
            f"| Nelder-Mead, {name} | {rate:.4g}: {rate / own:.2f} times | | {plain:.1f} | 1.00 |"
        )
    mission = load("x4-flyer")
    x, y = axis(mission, "k1"), axis(mission, "k2")
    drawn = atlas(mission, x, y)
    cells = np.random.default_rng(0).integers(0, 200, (SAMPLE, 2))
    begin = cpu()
    for i, j in cells:
        problem = gain_problem(cell_mission(mission, x, y, i, j))
        margin = one_inequality(Questions.of(problem))
        assert abs(margin - drawn["margin"].values[i, j]) < 1e-6 * max(1, abs(margin))
    plain = (cpu() - begin) / SAMPLE * drawn["margin"].size
    for what, options in (
        ("a process for each CPU", {}),
        ("one process", {"processes": 1}),
        ("the cells at the boundary decided exactly", {"exact": True}),
    ):
        wall, begin = time.perf_counter(), cpu()
        again = atlas(mission, x, y, **options)
        wall, spent = time.perf_counter() - wall, cpu() - begin
        assert again["margin"].equals(drawn["margin"])
        rows.append(
            f"| atlas, 200 x 200: {what} | | {wall:.1f} | {spent:.1f} | {spent / plain:.4f} |"
        )
    rows.append(f"| one inequality after another, from {SAMPLE} cells | | | {plain:.0f} | 1.0000 |")
    report("design", "\n".join(rows))


if __name__ == "__main__":
    main()
