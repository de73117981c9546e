"""Time a verdict and its check against the plain cvxpy model of the same inequality.

Run ``python benchmarks/verdict.py``; ``--write`` puts the table into the README beside it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median

import cvxpy as cp
import numpy as np

from hoverproof import checker
from hoverproof.certification.gains import certify
from hoverproof.certification.problem import gain_problem
from hoverproof.mission.reading import load
from hoverproof.mission.sections import Mission
from tables import report

ROUNDS = 15
MISSIONS = {"goal on the axis": {}, "goal off the axis": {"goal": "{centroid = [0.3, 0.2, 3.5]}"}}


def plain_cvxpy(mission: Mission) -> float:
    """Return the worst eigenvalue of Σ by the inequality as one would write it in cvxpy."""
    problem = gain_problem(mission)
    q = tuple((low + high) / 2 for low, high in problem.centroid)
    low, high = (float(x) for x in problem.eigenvalues)
    margins = []
    for f in problem.factor:
        middle = (problem.eigenvalues[0] + problem.eigenvalues[1]) / 2
        Q = [[middle * (i == j) for j in range(3)] for i in range(3)]
        sigma, u, v = (np.array(x, float) for x in problem.matrices(Q, f, q))
        spread = float(mission.gains.k1) * (high - low) / 4
        tau, t = cp.Variable(), cp.Variable()
        corner = sigma - spread * tau * v.T @ v - t * np.eye(11)
        side = np.sqrt(spread) * u
        block = cp.bmat([[corner, side.T], [side, tau * np.eye(3)]])
        cp.Problem(cp.Maximize(t), [(block + block.T) / 2 >> 0]).solve(solver=cp.CLARABEL)
        margins.append(float(t.value))
    return min(margins)


def milliseconds(work: Callable[[], object]) -> float:
    """Return how long one call takes."""
    begin = time.perf_counter()
    work()
    return (time.perf_counter() - begin) * 1e3


def main() -> None:
    """Measure in turns, print the table of medians."""
    rows = ["| mission | what | ms | ratio to plain cvxpy |", "| --- | --- | ---: | ---: |"]
    for name, change in MISSIONS.items():
        mission = load("x4-flyer", change)
        verdict = certify(mission)
        assert abs(plain_cvxpy(mission) - float(verdict.margin)) < 1e-6
        content = verdict.certificate.content
        work = {
            "certify": lambda mission=mission: certify(mission),
            "check": lambda content=content: checker.check(content),
            "plain cvxpy": lambda mission=mission: plain_cvxpy(mission),
        }
        times = {what: [] for what in work}
        for _ in range(ROUNDS):
            for what, call in work.items():
                times[what].append(milliseconds(call))
        peer = median(times["plain cvxpy"])
        for what, values in times.items():
            rows.append(f"| {name} | {what} | {median(values):.0f} | {median(values) / peer:.2f} |")
    report("verdict", "\n".join(rows))


if __name__ == "__main__":
    main()
