"""The eight laws written anew in floating point, for tests to hold verdicts and certificates to."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from scipy.optimize import minimize

D1, D2, D3, D4 = np.eye(12)[:, :11].reshape(4, 3, 11)  # the δs of X; δ4 has no third component
V = D1 + D2
SIZES = [3, 3, 3, 2]


def feature(points, positions):
    """Return s, (k, 3), at positions (k, 3) that may be complex, with n² - a² = Σ |pi - pj|²."""
    rays = points - positions[:, None]
    p = rays / np.sqrt((rays**2).sum(axis=2))[..., None]
    n = len(points)
    spread = ((p[:, :, None] - p[:, None]) ** 2).sum(axis=(1, 2, 3)) / 2
    return scaled(p.sum(axis=1), n, spread)


def scaled(q, n, spread=None):
    """Return s of centroids q, (k, 3)."""
    square = (q**2).sum(axis=1)
    a = np.sqrt(square)
    spread = n * n - square if spread is None else spread
    return q * (np.sqrt(n * (n + a) / (2 * spread)) / a)[:, None]


def slope(points, positions):
    """Return J = -∂s/∂ξ, (k, 3, 3), by a complex step."""
    h = 1e-20 * np.abs(points - positions[0]).max()
    return np.stack([-feature(points, positions + 1j * h * e).imag / h for e in np.eye(3)], axis=2)


def depth_matrix(points, positions):
    """Return Q, (k, 3, 3)."""
    rays = points - positions[:, None]
    r = np.linalg.norm(rays, axis=2)[..., None, None]
    p = rays[..., None] / r
    return ((np.eye(3) - p * p.swapaxes(2, 3)) / r).sum(axis=1)


def seen(points, position):
    """Return q at a position."""
    rays = points - position
    return (rays / np.linalg.norm(rays, axis=1)[:, None]).sum(axis=0)


def position_of(points, q):
    """Return where a level camera sees q: by Newton's method, step by step from far above."""
    place = points.mean(axis=0) - [0, 0, 2 * np.ptp(points, axis=0).max()]
    for _ in range(200):
        off = seen(points, place) - q
        if np.abs(off).max() < 1e-14:
            break
        step = np.linalg.solve(depth_matrix(points, place[None])[0], off)
        far = np.linalg.norm(points - place, axis=1).min()
        place = place + step * min(1, 0.3 * far / (np.linalg.norm(step) + 1e-300))
    return place


class Numbers:
    """What a mission says, in floating point, read from its numbers as a certificate has them.

    Parameters
    ----------
    mission : mapping
        As in a certificate.
    goal_position : list, or None
    eigenvalues : (2,) of str
        Of the claim.
    weights : (4,) of str
    """

    def __init__(self, mission, goal_position, eigenvalues, weights=("1",) * 4):
        law = mission.get("law", {})
        self.scaled = law.get("feature", "centroid") == "scaled"
        inertial = law.get("goal", "image") == "inertial"
        self.k = [floats(mission["gains"][k]) for k in ("k1", "k2", "k3", "k4")]
        self.m, self.gravity = (floats(mission["vehicle"][k]) for k in ("mass", "gravity"))
        self.points = floats(mission["target"]["points"])
        self.w = floats(list(weights))
        self.low, self.high = floats(list(eigenvalues))
        if goal_position is None:
            self.q = floats(mission["goal"]["centroid"])
            self.goal = position_of(self.points, self.q)
        else:
            self.goal = floats(goal_position)
            self.q = seen(self.points, self.goal)
        wanted = scaled(self.q[None], len(self.points))[0] if self.scaled else self.q
        self.fixed = np.zeros(3) if inertial else wanted
        self.bounds = mission["bounds"]

    @property
    def thrust(self):
        """Lowest and highest, N."""
        if "thrust" in self.bounds:
            return floats(self.bounds["thrust"])
        (k1, k2, _, _), m = self.k, self.m
        reach = np.sqrt(2 * floats(self.bounds["level"]) * (1 / self.w[1] + 1 / self.w[2]))
        return m * self.gravity + np.array([-1, 1]) * k1**2 * k2 / m * reach

    def factor(self, thrust):
        """Return f(T), 1/m."""
        k1, k2, k3, _ = self.k
        distance = thrust - k1**2 * k2 / self.m * self.fixed[2]
        assert np.min(distance) > 0
        return k1 * k2 * (k1 * k2 + k3) / (self.m * distance)

    def ends_of_f(self):
        """Return f at both ends of the thrust interval."""
        return self.factor(self.thrust[::-1])

    def loop(self, f, flow):
        """Return m B, Ẋ = B X, without the terms in Ω, for Q or J."""
        k1, k2, k3, k4 = self.k
        A = self.fixed[2] * np.eye(3) - np.outer([0, 0, 1], self.fixed)
        moved, turn = k1 * flow @ V, k1 * f * A @ (D4 - D3)
        rows = [
            -moved + turn,
            moved - k1 * k2 * D2 + k1 * k2 * D3 - turn,
            moved - k1 * k2 * D2 + (k1 * k2 + k3) * D4 - k3 * D3,
            (moved - (k1 * k2 + k3) * D3 - k4 * D4)[:2],
        ]
        return np.concatenate(rows)

    def sigma(self, f, flow):
        """Return Σ."""
        B = np.repeat(self.w, SIZES)[:, None] * self.loop(f, flow)
        return -(B + B.T) / 2

    @property
    def u(self):
        """The u of Σ, (3, 11)."""
        w = self.w
        return w[0] * D1 - w[1] * D2 - w[2] * D3 - w[3] * D4

    def at(self, positions):
        """Return Q, or J, at positions."""
        return (slope if self.scaled else depth_matrix)(self.points, positions)

    def slowest(self):
        """Return the rate of the slowest motion of the loop linearised at the goal, 1/s."""
        f = self.factor(self.m * self.gravity)
        return -np.linalg.eigvals(self.loop(f, self.at(self.goal[None])[0])).real.max() / self.m

    def within(self, flow):
        """Return by how much Q, or J, is within the bounds, as a share; (k,)."""
        if self.scaled:
            j, reach = (self.low + self.high) / 2, (self.high - self.low) / 2
            return 1 - np.linalg.norm(flow - j * np.eye(3), 2, axis=(1, 2)) / reach
        values = np.linalg.eigvalsh(flow)
        return np.minimum(values[:, 0] / self.low - 1, 1 - values[:, 2] / self.high)

    def worst_flow(self, u, v):
        """Return the Q, or the J, with the least uᵀ()v: a mirror, or a J that is not symmetric."""
        j, reach = (self.low + self.high) / 2, (self.high - self.low) / 2
        u, v = (x / (np.linalg.norm(x) + 1e-300) for x in (u, v))
        if self.scaled:
            return j * np.eye(3) - reach * np.outer(u, v)
        w = (u + v) / (np.linalg.norm(u + v) + 1e-300)
        return self.high * np.eye(3) - (self.high - self.low) * np.outer(w, w)

    def worst(self, rng, starts=4, turns=12, rounds=3):
        """Return the least eigenvalue of W^-½ Σ W^-½ found, and the size of that matrix.

        In turn: the worst X for a Q or J, and the worst Q or J for that X. The quotient that is
        least over Q or J for each X, which is in closed form, is then minimised over X.
        """
        root, found = np.sqrt(np.repeat(self.w, SIZES)), []
        u_of, v_of = self.u / root, V / root
        j, cost = (self.low + self.high) / 2, self.k[0] * (self.high - self.low) / 2
        for f in np.unique(self.ends_of_f()):
            base = self.sigma(f, j * np.eye(3)) / np.outer(root, root)

            def quotient(x, base=base):
                u, v, square = u_of @ x, v_of @ x, x @ x
                a, b = (np.linalg.norm(y) + 1e-300 for y in (u, v))
                value = (x @ base @ x - cost * a * b) / square
                slope_ = 2 * base @ x - cost * (b / a * u_of.T @ u + a / b * v_of.T @ v)
                return value, (slope_ - 2 * value * x) / square

            best = np.inf
            for _ in range(starts):
                x = rng.normal(size=11)
                for _ in range(turns):
                    flow = self.worst_flow(u_of @ x, v_of @ x)
                    values, vectors = np.linalg.eigh(self.sigma(f, flow) / np.outer(root, root))
                    x = vectors[:, 0]
                if values[0] < best:
                    best, place = values[0], x
            size = np.abs(values).max()
            for _ in range(rounds):  # anew from where rounding stopped it
                scale = 1 / (abs(quotient(place)[0]) + 1e-9 * size)
                place = minimize(
                    lambda x, c=scale, of=quotient: tuple(c * y for y in of(x)),
                    place / np.linalg.norm(place),
                    jac=True,
                    options={"gtol": 1e-12},
                ).x
            flow = self.worst_flow(u_of @ place, v_of @ place)
            refined = np.linalg.eigvalsh(self.sigma(f, flow) / np.outer(root, root))[0]
            found.append((min(best, refined), size))
        return min(found)[0], max(size for _, size in found)


def numbers_of(content):
    """Return the numbers of a certificate."""
    own = (content["mission"], content["goal_position"], content["region"]["eigenvalues"])
    return Numbers(*own, content.get("weights", ["1"] * 4))


def floats(values):
    """Turn exact strings, in any nesting, into floating point."""
    if isinstance(values, list):
        return np.array([floats(v) for v in values])
    return float(Fraction(values))
