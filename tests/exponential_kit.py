"""Parts of certificates about uncertain vehicles, and such a vehicle in numpy, for tests."""

from __future__ import annotations

import itertools
from fractions import Fraction as F
from types import SimpleNamespace
from unittest.mock import patch

import cvxpy as cp
import numpy as np

import checker_kit
from hoverproof import checker
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import LAWS

TOLERANCES = {"thrust": "1/5", "torque": "1/5", "latency": "73/1000", "rotor_lag": "3/100"}
TOLERANCES |= {"wind": "1/5", "yaw_rate": "1"}
NOISE = dict.fromkeys(("feature", "velocity", "force", "rate"), "0")
SCALED = "scaled", "inertial", "measured"
E3 = np.array([0.0, 0, 1])
QUARTER = np.array([[0.0, -1], [1, 0]])


def exact(x, digits=6):
    """Return a number as certificates have it, to so many digits."""
    return str(F(f"{float(x):.{digits}g}"))


def mission(law=SCALED, gains=(0.03, 45, 2.6, 5.8), **tolerances):
    """Return a vehicle of 0.5 kg, 1.2 m above a tag of 20 cm, as certificates have it."""
    side = ("1/10", "-1/10")
    asked = dict.fromkeys(TOLERANCES, "0") | tolerances | {"noise": NOISE}
    return {
        "name": "small",
        "vehicle": {
            **{"mass": "1/2", "arm": "3/25", "drag_ratio": "2/125", "gravity": "981/100"},
            "inertia": ["29/12500", "29/12500", "1/250"],
        },
        "target": {"points": [[x, y, "0"] for x, y in itertools.product(side, side)]},
        "goal": {"height": "6/5"},
        "gains": dict(zip(checker.GAINS, map(exact, (*gains, 0.05)), strict=True)),
        "bounds": {"eigenvalues": "auto", "thrust": ["4", "6"]},
        "start": {
            **{"position": ["3/5", "0", "-9/5"], "velocity": ["0"] * 3},
            **{"rotation": ["0"] * 3, "rates": ["0"] * 3},
        },
        **({} if law == checker.PAPERS else {"law": dict(zip(checker.LAW, law, strict=True))}),
        **({"uncertainty": asked} if tolerances else {}),
    }


def parts(of, *, level=20, rate=0.1, weights=(0.6, 0.5, 0.2), lag=(0.02, 0.05), ball=(5, 12)):
    """Return what a certificate holds of a mission; its multipliers are all 1."""
    asked = of.get("uncertainty", dict.fromkeys(TOLERANCES, "0"))
    law = tuple(of["law"].values()) if "law" in of else checker.PAPERS
    points = [[F(x) for x in p] for p in of["target"]["points"]]
    seen = checker.centroid_seen(checker.Pattern(points, [F(1)] * len(points)), HOVER)
    goal = (checker.scaled(seen, F(len(points))) if law[0] == "scaled" else seen)[2]
    start = {"position": [["0", "0"], ["0", "0"], ["-6/5", "-6/5"]]}
    content = {
        "mission": of,
        "mission_sha256": checker.digest(of),
        "goal_position": list(map(str, HOVER)),
        "weights": list(map(exact, weights)),
        "lag": dict(zip(("torque", "thrust"), map(exact, lag), strict=True)),
        "memory": "1/5",
        "multipliers": {"slope": "1/100", "terms": []},
        "domain": {
            **{"wedge": [["-1", "1"], ["-1", "1"], ["1/2", "5"]], "bounds": [*map(exact, ball)]},
            **{"offset": "7", "cone": None, "tree": "0"},
        },
        "enclosures": {
            "goal": [
                str(round(x * 10**9 + s) / F(10**9)) for x, s in zip(goal, (-1, 1), strict=True)
            ]
        },
        "hover": list(map(str, HOVER)),
        "claim": {
            **{"level": exact(level), "rate": exact(rate), "start_level": exact(level)},
            "starts": [start | dict.fromkeys(("speed", "tilt", "rate", "thrust"), "0")],
            "settling": {"offset": "1", "radius": "1/10", "time": "20"},
            "cone": None,
            "rotors": ["-100", "100"],
        },
        "trees": {"near": "0", "starts": ["0"]},
    }
    if asked["rotor_lag"] == "0":
        content["lag"] = None
    if asked["latency"] == "0":
        content["memory"] = None
    many = next(n for n in range(9) if is_read(content, n))
    return put_multipliers(content, ["1"] * many)


HOVER = [F(0), F(0), F(-6, 5)]


def put_multipliers(content, terms):
    return content | {"multipliers": content["multipliers"] | {"terms": terms}}


def is_read(content, many):
    """Tell whether a certificate has so many multipliers."""
    try:
        claim_of(put_multipliers(content, ["1"] * many))
    except checker.Rejected as rejected:
        if "a multiplier a term" in str(rejected):
            return False
        raise
    return True


def claim_of(content):
    """Return the claim that the checker reads."""
    return checker.Exponential(checker.parsed(checker.ABOUT | checker.Exponential.own, content))


# --- hints that prove it --------------------------------------------------------------------------

FOUND = {  # by a search of weights, for TOLERANCES
    "gains": (0.007, 104, 1.85, 5.07),
    "weights": (0.08296, 0.03835, 0.01447),
    "lag": (0.001477, 0.006512),
    "ball": (4.07, 14.43),
}


def proved(law=SCALED, level=28, rate=0.1, **tolerances):
    """Return the parts of a certificate with multipliers that are found in floating point."""
    found = {key: FOUND[key] for key in ("weights", "lag", "ball")}
    content = parts(mission(law, FOUND["gains"], **tolerances), level=level, rate=rate, **found)
    slope, memory, terms = multipliers(content)
    content["multipliers"] = {"slope": exact(slope, 9), "terms": [exact(t, 9) for t in terms]}
    return content | ({"memory": exact(memory, 9)} if content["memory"] else {})


def multipliers(content):
    """Return the σJ, M and t for which the least eigenvalue is largest, at all vertices."""
    claim, n = claim_of(content), claim_of(content).size
    slope, t = cp.Variable(nonneg=True), cp.Variable(max(1, len(content["multipliers"]["terms"])))
    memory, margin, limits = cp.Variable(nonneg=True), cp.Variable(), [t >= 0]
    with (
        patch.object(claim.c.multipliers, "terms", []),
        patch.object(claim, "terms", lambda *at: []),
    ):
        bare = [of_shares(claim, corner) for corner in claim.vertices()]
    for corner, (form, of_slope, of_memory) in zip(claim.vertices(), bare, strict=True):
        form = form + slope * of_slope + memory * of_memory - margin * np.eye(n)
        rows, of = np.zeros((0, n)), []
        for k, (u, v, radius) in enumerate(claim.terms(*corner[3:])):
            half = float(radius) / 2
            form -= half * t[k] * matrix(v @ v, n)
            rows = np.vstack([rows, np.sqrt(half) * rows_of(u, n)])
            of += [k] * (len(rows) - len(of))
        # Schur's complement of |u|²/t
        limits.append((cp.bmat([[form, rows.T], [rows, cp.diag(t[of])]]) if of else form) >> 0)
    cp.Problem(cp.Maximize(margin), limits).solve(solver=cp.CLARABEL)
    return float(slope.value), float(memory.value), t.value[: len(content["multipliers"]["terms"])]


def of_shares(claim, corner):
    """Return the parts of the bound without terms, of which σJ and M are factors."""
    c, at = claim.c, []
    for slope, memory in ((0, 0), (1, 0), (0, 1)):
        shares = patch.object(c, "memory", c.memory and F(memory))
        with patch.object(c.multipliers, "slope", F(slope)), shares:
            at.append(matrix(claim.decrease(*corner), claim.size))
    return at[0], at[1] - at[0], at[2] - at[0]


def matrix(form, n):
    return np.array(checker_kit.matrix(form, n), float)


def rows_of(vector, n):
    """Return the rows of a vector of linear forms that are not zero."""
    return np.array([[float(part.get((i,), 0)) for i in range(n)] for part in vector if part])


# --- a vehicle that is not the modelled one -----------------------------------------------------


class Vehicle:
    """A rigid body with its feature, in numpy, under the controller of the package.

    Its errors are by their definitions, and how E falls by differences along the motion.
    """

    def __init__(self, content):
        self.claim = claim = claim_of(content)
        of = content["mission"]
        self.law = LAWS[claim.law]
        self.controller = derive_controller(self.law).function()
        self.m, self.g = float(claim.m), float(claim.gravity)
        self.k = k1, k2, k3, k4 = np.array(claim.k, float)
        self.c, self.kappa = k1**2 * k2 / self.m, (k1 * k2 + k3) / self.m
        self.k12, self.K = k1 * k2 / self.m, (k1 * k2 + k3 + k4) / self.m
        self.s3 = float(sum(claim.goal) / 2)
        self.fixed = 0.0 if claim.law[1] == "inertial" else self.s3
        self.may = SimpleNamespace(
            **{key: float(F(x)) for key, x in of["uncertainty"].items() if key != "noise"}
        )
        self.inertia = np.array([float(F(x)) for x in of["vehicle"]["inertia"]])
        i1, i2, i3 = self.inertia
        self.own = np.array([[0, (i3 - i1) / i2], [-(i3 - i2) / i1, 0]])  # Gc
        self.weights = np.r_[1, np.array(claim.c.weights, float)]
        self.design = np.r_[self.m, self.g, self.inertia, self.k, 0.05, 0, 0, self.s3]

    def state_of(self, d, wind, yaw, mu, lift):
        """Return the state of errors: s, V, ρ, Ω, T, w, Ua, b."""
        d1, d2, d3, d4 = np.split(np.r_[d, 0], 4)
        force = self.c * (d3 - d2)
        lean = force - wind
        thrust = np.sqrt((self.m * self.g) ** 2 - lean[:2] @ lean[:2]) - lean[2]
        rho = (lean + thrust * E3) / (self.m * self.g)
        s = d1 + (self.s3 * E3 if self.fixed else self.s3 * rho)
        h = self.c * self.kappa / (thrust - wind[2] - self.c * self.fixed)
        z = h * (d4 - d3)[:2]
        smooth = -self.K * d4[:2] - self.k12 * (d3 - d2)[:2]
        rotors = np.r_[self.c * (self.kappa * d3[2] + lift), h * (smooth + mu)]
        return np.r_[s, self.k[0] / self.m * (d1 + d2), rho, z[1], -z[0], yaw, thrust, wind, rotors]

    def errors(self, x):
        """Return δ1 to δ4, μ and μT by their definitions, and h."""
        s, V, rho, Omega, thrust, wind, Ua, b = np.split(x, [3, 6, 9, 12, 13, 16, 17])
        d1 = s - (self.s3 * E3 if self.fixed else self.s3 * rho)
        d2 = self.m / self.k[0] * V - d1
        d3 = (self.m * self.g * rho - thrust * E3 + wind) / self.c + d2
        h = self.c * self.kappa / (thrust[0] - wind[2] - self.c * self.fixed)
        d4 = np.array([-Omega[1], Omega[0]]) / h + d3[:2]
        smooth = -self.K * d4 - self.k12 * (d3 - d2)[:2]
        return np.r_[d1, d2, d3, d4], b / h - smooth, Ua / self.c - self.kappa * d3[2], h

    def energy(self, x, lag):
        d, mu, lift, _ = self.errors(x)
        E = self.weights @ [e @ e for e in np.split(d, [3, 6, 9])] / 2
        if self.claim.c.lag:
            a = self.claim.c.lag
            E += lag / 2 * (float(a.torque) * mu @ mu + float(a.thrust) * lift @ lift)
        return float(E)

    def commanded(self, x, ahead):
        """Return U, and e3 × the torque that is commanded over the moments of inertia."""
        s, V, rho, Omega, thrust, wind, *_ = np.split(x, [3, 6, 9, 12, 13, 16, 17])
        own = [s + ahead, V, rho, Omega, thrust]
        if self.law.force.name == "measured":
            own.append((wind - thrust * E3) / self.m)
        rate, torque = self.controller(np.concatenate(own), self.design)
        alpha = np.array(torque).ravel() / self.inertia
        return float(rate), np.array([-alpha[1], alpha[0]])

    def flow(self, x, y, ahead, doubt):
        s, V, rho, Omega, thrust, wind, Ua, b = np.split(x, [3, 6, 9, 12, 13, 16, 17])
        U, asked = self.commanded(x, ahead)
        z, yaw = np.array([-Omega[1], Omega[0]]), Omega[2]
        one = np.eye(2) + doubt.gamma
        Gt = one @ self.own - doubt.G
        if self.claim.c.lag:
            turned, lifted = one @ b - yaw * Gt @ z, Ua[0]
            late = np.r_[U - Ua, asked - b] / doubt.lag
        else:
            turned, lifted, late = one @ asked - yaw * Gt @ z, U, np.zeros(3)
        force = self.m * self.g * rho - thrust * E3 + wind
        return np.r_[
            -np.cross(Omega, s) - y,
            -np.cross(Omega, V) + force / self.m,
            -np.cross(Omega, rho),
            [turned[1], -turned[0], 0],
            doubt.gain * lifted,
            -np.cross(Omega, wind),
            late,
        ]

    def doubt(self, x, ahead, lag, gain, share):
        """Return what is in doubt, with a share of what makes E' the largest."""
        d, mu, _, h = self.errors(x)
        u, zeta, yaw = self.weights[3] * d[9:], d[9:] - d[6:8], x[11]
        if self.claim.c.lag:
            u = u + lag * self.K * float(self.claim.c.lag.torque) * mu
            asked = x[17:19]
        else:
            asked = self.commanded(x, ahead)[1] - h * yaw * self.own @ zeta
        gamma, G = (
            share
            * self.may.torque
            * np.outer(u, v)
            / max(np.linalg.norm(u) * np.linalg.norm(v), 1e-30)
            for v in (asked, yaw * zeta)
        )
        return SimpleNamespace(gain=gain, gamma=gamma, G=G, lag=lag)

    def change(self, x, y, ahead, doubt):
        """Return E' by differences."""
        f = self.flow(x, y, ahead, doubt)
        step = 1e-4 / max(1.0, np.abs(f / np.maximum(np.abs(x), 1)).max())
        at = [self.energy(x + k * step * f, doubt.lag) for k in (1, -1, 2, -2)]
        return (8 * (at[0] - at[1]) - (at[2] - at[3])) / (12 * step)


def drawn(rng, vehicle):
    """Return a state of the set, y, n and what is in doubt: much of it zero, or at its worst."""
    v, claim, may = vehicle, vehicle.claim, vehicle.may

    def unit(size, n=3):
        x = rng.normal(size=n)
        return size * x / np.linalg.norm(x)

    def share():
        return rng.choice([0, 1, 1, rng.uniform()])

    sign = rng.choice([-1, 1], size=4)
    d = rng.normal(size=11) * np.repeat(rng.choice([0, 1, 3], size=4), [3, 3, 3, 2])
    d *= np.tile([rng.choice([0, 1])] * 2 + [rng.choice([0, 1])], 4)[:11]
    if rng.uniform() < 0.6:  # ζ = 0, or across δ3 and small
        d[9:] = d[6:8] + rng.choice([0, 0, 0.1]) * QUARTER @ d[6:8]
    size = np.sqrt(v.weights @ [e @ e for e in np.split(d, [3, 6, 9])] / 2)
    d *= np.sqrt(float(claim.c.claim.level)) * rng.uniform(0.1, 1) / max(size, 1e-9)
    wind = unit(v.m * may.wind * share())
    V = v.k[0] / v.m * (d[:3] + d[3:6])
    j, reach = (float(claim.high + s * claim.low) / 2 for s in (1, -1))
    y, n = j * V + unit(reach * np.linalg.norm(V) * share()), unit(float(claim.missed) * share())
    most = v.kappa * float(claim.sink + claim.missed)  # of |Ua|/c
    lift = sign[0] * most * share() - v.kappa * d[8]
    mu = unit(np.linalg.norm(d) * rng.choice([0, 1, 10, 30]), 2)
    x = v.state_of(d, wind, may.yaw_rate * share() * sign[1], mu, lift)
    lag = may.rotor_lag * rng.choice([1, 1, rng.uniform(0.1, 1)])
    return x, y, n, v.doubt(x, n, lag, 1 + may.thrust * share() * sign[2], share() * sign[3])


class Balance:
    """-Ψ' - r Ψ less what the ball of J gives: of the vehicle, and the checker's bound of it."""

    def __init__(self, vehicle, x, y, n, doubt):
        self.v, self.x, self.y, self.n, self.doubt = vehicle, x, y, n, doubt
        self.claim, may = vehicle.claim, vehicle.may
        self.d, self.mu, self.lift, self.h = vehicle.errors(x)
        self.wind = x[13:16]
        lever = vehicle.c * vehicle.kappa / self.h
        self.corner = [
            1 + self.wind[2] / lever,
            vehicle.fixed * self.h,
            doubt.gain,
            doubt.lag,
            2 * self.h * (self.d[8] - n[2]) + np.cross(x[9:12], self.wind)[2] / lever,
        ]
        held = [*np.split(np.r_[self.d, 0], 4), y]
        held += [n] if may.latency else []
        held += [np.r_[self.mu, self.lift]] if may.rotor_lag else []
        self.slices = []
        for axis in (0, 1):
            pairs = [np.array([e[axis], 0 if axis else e[2]]) for e in held]
            pairs[3] = pairs[3][:1]  # δ4 has no third component
            self.slices.append([F(float(c)) for c in np.concatenate(pairs)])

    def truth(self):
        v, claim, may, c = self.v, self.claim, self.v.may, self.claim.c
        rate = float(c.claim.rate)
        fall = -v.change(self.x, self.y, self.n, self.doubt)
        fall -= rate * v.energy(self.x, self.doubt.lag)
        if c.memory:
            M, late = float(c.memory), may.latency
            fall += M / late * np.exp(-rate * late) * self.n @ self.n - M * late * self.y @ self.y
        V = v.k[0] / v.m * (self.d[:3] + self.d[3:6])
        j, reach = float(claim.low + claim.high) / 2, float(claim.high - claim.low) / 2
        out = self.y - j * V
        return fall - float(c.multipliers.slope) * (reach**2 * V @ V - out @ out)

    def bound(self):
        """Return the checker's bound without the norm-bounded terms, and the most of each."""
        corner, multipliers = [F(float(x)) for x in self.corner], self.claim.c.multipliers
        terms = self.claim.terms(*corner[3:])
        most = [
            float(radius) * np.sqrt(float(self.value(u @ u) * self.value(v @ v)))
            for u, v, radius in terms
        ]
        none = patch.object(self.claim, "terms", lambda *at: [])
        with none, patch.object(multipliers, "terms", []):
            form = self.claim.decrease(*corner)
        return float(self.value(form)), np.array(most)

    def value(self, form):
        return sum(form.value(X) for X in self.slices)

    def scale(self):
        return max(abs(self.d).max() ** 2, abs(self.mu).max() ** 2, self.lift[0] ** 2, 1e-20)


# --- a whole certificate ------------------------------------------------------------------------


def sealed(content):
    """Return the certificate of parts, with its statement and its hashes."""
    whole = {
        **{"format": "hoverproof certificate", "version": checker.VERSION, "kind": "exponential"},
        **{"statement": "", "model_sha256": "0" * 64, "tools": dict.fromkeys(checker.TOOLS, "1")},
        **content,
    }
    whole["mission_sha256"] = checker.digest(whole["mission"])
    whole["statement"] = checker.statement(whole)
    return whole | {"sha256": checker.digest(whole)}
