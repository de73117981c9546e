"""The hover that a mission asks for: where it is, and the image centroid q* seen there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.surd import Surd
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.mission.target import Target
from hoverproof.plant import camera

Interval = tuple[Fraction, Fraction]
_ZERO: Interval = (Fraction(0), Fraction(0))
ASIDE = Fraction(1, 10**6)
"""A hover that is so far aside, as a share of its height, is said to be."""
SPARE = 64
"""What is added to the bound of how far the goal is from where it was found, as a factor."""


@dataclass(frozen=True)
class HoverGoal:
    """A level hover at rest above the target.

    Attributes
    ----------
    position : (3,) tuple of Fraction
        ξ*, world frame, m: exact for a target that is alike on all sides, else to rounding.
    centroid : (3,) tuple of (low, high)
        Rational bounds of q*, equal where it is rational; camera frame.
    exact : bool
        Whether `position` is ξ* itself.
    """

    position: tuple[Fraction, ...]
    centroid: tuple[Interval, ...]
    exact: bool

    def is_above_middle_of(self, mission: Mission) -> bool:
        """Tell whether it is right above the mean of the target, as of one alike on all sides.

        Parameters
        ----------
        mission : Mission
            Whose hover it is.
        """
        x, y, _ = mission.target.mean
        away = max(abs(self.position[0] - x), abs(self.position[1] - y))
        return away <= ASIDE * (mission.height_of_target - self.position[2])

    @property
    def centroid_midpoint(self) -> list[Fraction]:
        """(3,) q* to within the width of its bounds."""
        return [(low + high) / 2 for low, high in self.centroid]


def hover_goal(mission: Mission) -> HoverGoal:
    """Return the hover that a mission asks for.

    A ``goal.height`` is measured from the mean height of the target points; the goal lies where
    the centroid is vertical there, q* = (0, 0, q3*). Where that is irrational, `position` is a
    rational point within rounding of it, and q3* is enclosed.

    Parameters
    ----------
    mission : Mission

    Raises
    ------
    InputError
        If no hover above the target sees the wanted centroid.
    """
    target = mission.target
    key = (tuple(target.points), tuple(target.counts), mission.goal.height, mission.goal.centroid)
    if key not in _held:
        _held[key] = _found(mission)
    return _held[key]


_held: dict[object, HoverGoal] = {}
"""Hovers by target and goal: one verdict asks several times, and a search for gains again."""


def _found(mission: Mission) -> HoverGoal:
    points, middle = mission.target.points, mission.target.mean
    if mission.goal.height is not None:
        start = (middle[0], middle[1], mission.height_of_target - mission.goal.height)
        seen = centroid_seen(mission.target, start)
        if not (seen[0].terms or seen[1].terms):
            return HoverGoal(start, tuple(q.enclosure() for q in seen), exact=True)
        x, y, _ = _solve(mission, start, free=2, wanted=np.zeros(3))
        return _nearby(mission, (Fraction(x), Fraction(y), start[2]))

    centroid = mission.goal.centroid or (Fraction(0),) * 3  # a mission gives one of the two
    wanted = np.array([float(q) for q in centroid])
    spread = max(abs(p[i] - middle[i]) for p in points for i in range(3))
    above = (middle[0], middle[1], min(p[2] for p in points) - 2 * spread)
    found = _solve(mission, above, free=3, wanted=wanted)
    return HoverGoal(tuple(map(Fraction, found)), tuple((q, q) for q in centroid), exact=False)


def _nearby(mission: Mission, near: tuple[Fraction, ...]) -> HoverGoal:
    """Return the hover at the height of a point and near it that sees the centroid straight below.

    The horizontal part of q is the slope of a convex function, less its sign, and its Hessian is
    the upper left block of Q. Let it be above λ within r of the point; where |Pq| < λ r there, a
    point of slope zero is within |Pq|/λ, and q3 changes by at most Σ wᵢ/rᵢ a metre on the way. Both
    are taken with much to spare; `checker.seen_near` asks the same exactly.
    """
    *aside, down = (q.enclosure() for q in centroid_seen(mission.target, near))
    points, counts = np.array(mission.target.points, float).T, np.array(mission.target.counts)
    _, Q = (np.array(m) for m in level_view_of(mission)(points, [float(c) for c in near]))
    least = float(np.linalg.eigvalsh(Q[:2, :2])[0])
    off = sum(max(abs(end) for end in ends) for ends in aside)
    steep = (counts.astype(float) / np.linalg.norm(points.T - np.array(near, float), axis=1)).sum()
    slack = SPARE * off / Fraction(least) * Fraction(steep)
    return HoverGoal(near, (_ZERO, _ZERO, (down[0] - slack, down[1] + slack)), exact=False)


def hover_at_height(
    mission: Mission, goal: HoverGoal, z: float, near: Sequence[float] | None = None
) -> tuple[list[float], list[float]] | None:
    """Return the level hover at another height that sees q1 and q2 of q*, and the q it sees, (3,).

    q3 rises with the height: dq = -Q dξ, and Q is positive definite. None if it is not found, as
    where it comes too near to a target point.

    Parameters
    ----------
    mission : Mission
    goal : HoverGoal
        Its hover.
    z : float
        Height of that hover, world frame, down, m; above every target point.
    near : (2,), optional
        x and y near which it is, m; by default those of the goal.
    """
    points = np.array(mission.target.points, float).T
    look = level_view_of(mission)
    wanted = np.array([float(q) for q in goal.centroid_midpoint])[:2]

    def seen(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        q, Q = (np.array(m) for m in look(points, xi))
        return q[:, 0], Q[:2, :2], q[:2, 0] - wanted

    xi = np.array([*map(float, goal.position[:2] if near is None else near), z])
    q, Q, gap = seen(xi)
    for _ in range(50):
        if np.linalg.norm(gap) < 1e-12 * points.shape[1]:
            break
        try:
            step = np.append(np.linalg.solve(Q, gap), 0.0)
        except np.linalg.LinAlgError:
            return None
        for _ in range(40):  # a shorter step along it brings the gap down: Q is positive definite
            trial = seen(xi + step)
            if np.linalg.norm(trial[2]) < np.linalg.norm(gap):
                break
            step /= 2
        else:
            break
        xi, (q, Q, gap) = xi + step, trial
    if not np.linalg.norm(gap) < 1e-9:
        return None
    return xi.tolist(), q.tolist()


def centroid_seen(target: Target, position: tuple[Fraction, ...]) -> tuple[Surd, ...]:
    """Return the image centroid of a level camera, exactly, (3,).

    Parameters
    ----------
    target : Target
    position : (3,), world frame, m
    """
    look, whole = level_view(1).factory("centroid", ["points", "xi"], ["q"]), [Surd({})] * 3
    for point, count in zip(target.points, target.counts, strict=True):
        (q,) = evaluate(look, [[Surd.of(c) for c in a] for a in (point, position)], Surd.of)
        whole = [one + Surd.of(count) * row[0] for one, row in zip(whole, q, strict=True)]
    return tuple(whole)


@cache
def level_view(n: int, weights: tuple[float, ...] = ()) -> ca.Function:
    """Return (points (3, n), position (3,)) ↦ (q (3,), Q (3, 3)) that a level camera sees.

    Parameters
    ----------
    n : int
        Number of target points.
    weights : (n,), optional
        How much each counts; by default 1.
    """
    points, position, counts = ca.SX.sym("points", 3, n), ca.SX.sym("xi", 3), weights or None
    seen = camera.body_points(points, position, ca.SX.eye(3))
    q = camera.centroid(camera.spherical(camera.pinhole(seen)), counts)
    return ca.Function(
        "level_view",
        [points, position],
        [q, camera.depth_matrix(seen, counts)],
        ["points", "xi"],
        ["q", "Q"],
    )


def level_view_of(mission: Mission) -> ca.Function:
    """Return the `level_view` of the target of a mission.

    Parameters
    ----------
    mission : Mission
    """
    target = mission.target
    return level_view(len(target.points), tuple(map(float, target.weights or ())))


def _solve(
    mission: Mission, start: tuple[Fraction, ...], *, free: int, wanted: np.ndarray
) -> list[float]:
    """Find by Newton's method where the first `free` components of q are the wanted ones.

    q = -∇Φ of the convex Φ(ξ) = Σ wᵢ|P'ᵢ - ξ| with Hessian Q, so the place sought is the minimum of
    Φ(ξ) + wantedᵀξ, and halving a step until that falls makes Newton converge.
    """
    points, counts = (np.array(x, float) for x in (mission.target.points, mission.target.counts))
    look = level_view_of(mission)
    highest = points[:, 2].min()

    def potential(xi: np.ndarray) -> float:
        return float((counts * np.linalg.norm(points - xi, axis=1)).sum() + wanted @ xi)

    xi, seen = np.array([float(c) for c in start]), np.full(3, np.nan)
    visited: set[bytes] = set()  # once rounding is all that is left, it goes round in a circle
    while len(visited) < 200 and xi.tobytes() not in visited:
        visited.add(xi.tobytes())
        q, Q = (np.array(m) for m in look(points.T, xi))
        seen, step = q[:, 0], np.zeros(3)
        if not (np.isfinite(seen).all() and np.isfinite(Q).all()):
            break
        try:
            step[:free] = np.linalg.solve(Q[:free, :free], (seen - wanted)[:free])
        except np.linalg.LinAlgError:  # flat to within rounding
            break
        size = 1.0
        while size > 1e-14 and not (
            (xi + size * step)[2] < highest
            and potential(xi + size * step) <= potential(xi) + 1e-15 * abs(potential(xi))
        ):
            size /= 2
        xi = xi + size * step
        if size == 1.0 and np.abs(step).max() <= 4e-16 * max(1.0, np.abs(xi).max()):
            break
    seen = np.array(look(points.T, xi)[0])[:, 0]
    if not np.abs((seen - wanted)[:free]).max() <= 1e-9:  # nor if it is not a number
        if free == 3:
            raise _unseen(mission, wanted)
        raise InputError(
            mission.source,
            "goal.height",
            f"no level hover at z = {float(start[2]):g} m was found that sees the centroid "
            f"straight below; the search ended at {_shown(xi)} m",
        )
    return [float(c) for c in xi]


def _lowest(mission: Mission, wanted: np.ndarray) -> np.ndarray:
    """Return where the convex Φ(ξ) + wᵀξ is least, (3,), m, wherever that is: by damped Newton."""
    points, counts = (np.array(x, float) for x in (mission.target.points, mission.target.counts))
    xi, damping = points.mean(axis=0) - [0, 0, np.ptp(points, axis=0).max()], 1e-3

    def potential(at: np.ndarray) -> float:
        return float((counts * np.linalg.norm(points - at, axis=1)).sum() + wanted @ at)

    for _ in range(500):
        rays = points - xi
        shares = counts / np.maximum(np.linalg.norm(rays, axis=1), 1e-12)
        u = rays / np.maximum(np.linalg.norm(rays, axis=1), 1e-12)[:, None]
        slope = wanted - shares @ rays
        bend = shares.sum() * (1 + damping) * np.eye(3) - (shares[:, None] * u).T @ u
        step = -np.linalg.solve(bend, slope)
        better = potential(xi + step) < potential(xi)
        xi, damping = (xi + step, damping / 4) if better else (xi, damping * 4 + 1e-6)
        if damping > 1e9:
            break
    return np.asarray(xi)


def _unseen(mission: Mission, wanted: np.ndarray) -> InputError:
    """Say why no hover sees a centroid w.

    It is seen from where the convex Φ(ξ) + wᵀξ is least. If that is a target point, it is seen from
    nowhere; and it is target point k if |Σ wᵢ uᵢ - w| ≤ wₖ, uᵢ the unit vectors from there to the
    others, and wₖ the weight of all that is there. That is decided with rational bounds.
    """
    asked = f"no level hover sees the centroid {_shown(wanted)}"
    each = list(zip(mission.target.points, mission.target.counts, strict=True))
    lowest = _lowest(mission, wanted)
    off = np.linalg.norm(np.array(mission.target.points, float) - lowest, axis=1)
    for k in np.argsort(off, kind="stable")[:3]:
        point, _ = each[k]
        others = [(p, count) for p, count in each if p != point]
        here = sum((count for p, count in each if p == point), Fraction(0))
        rays = [[a - b for a, b in zip(p, point, strict=True)] for p, _ in others]
        lengths = [Surd.of(sum((c * c for c in ray), Fraction(0))).sqrt() for ray in rays]
        square = Fraction(0)
        for i, w in enumerate(mission.goal.centroid or ()):
            gap = Surd.of(-w)
            for ray, length, (_, count) in zip(rays, lengths, others, strict=True):
                gap = gap + Surd.of(count * ray[i]) / length
            square += max(end * end for end in gap.enclosure())
        if square <= here**2:
            reason = f"a camera that nears it comes down to target point {k + 1}, {_shown(point)} m"
            return InputError(mission.source, "goal.centroid", f"{asked}: {reason}")
    highest = min(float(p[2]) for p in mission.target.points)
    reason = (
        f"looking all round, it would be seen from {_shown(lowest)} m alone, which is not above "
        f"the highest target point, z = {highest:g} m"
        if lowest[2] >= highest
        else f"none was found above the highest target point, z = {highest:g} m"
    )
    return InputError(mission.source, "goal.centroid", f"{asked}: {reason}")


def _shown(vector: Iterable[Any]) -> str:
    return f"[{', '.join(f'{float(c):g}' for c in vector)}]"
