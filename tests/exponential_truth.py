"""Small certificates of every vehicle within tolerances, and what is true of them, for tests.

Nothing here reads a certificate as the checker does: the inequality is the one that the graph
gives, positions and states are drawn, and the feature and its slope are those of `laws_kit`.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import re
from dataclasses import replace
from fractions import Fraction as F
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

import test_potential
import uncertain_body as kit
from hoverproof.certification.exponential import proof, question, search
from hoverproof.certification.exponential.inequality import Ball, Sector, falls
from hoverproof.certification.exponential.limits import Limits
from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles
from hoverproof.mission.reading import load
from hoverproof.servo.laws.hamel_mahony import LAWS
from laws_kit import depth_matrix, feature, floats, seen, slope
from sharing import kept

MISSION = Path(__file__).parents[1] / "examples" / "half-kilo.toml"
PAPERS = {"feature": "centroid", "goal": "image", "force": "modelled"}
NEAR = {"start.position": "[0.1, 0, -1.3]"}
EVEN = {"uncertainty.rotor_lag": "0"}
CALM = {"uncertainty.latency": "0.02", "uncertainty.thrust": "0.1"}
UNEVEN = "[[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, -0.1, 0], [-0.1, 0.1, 0], [0.07, 0, 0]]"
SMALL = {  # near, with a domain that few cells cover, so that it is soon proved and checked
    "late": NEAR | EVEN,
    "lagged": NEAR | CALM,
    "image": NEAR | EVEN | CALM | {"law.goal": "image", "uncertainty.wind": "0.05"},
    "uneven": EVEN
    | CALM
    | {"target.points": UNEVEN, "goal": "{centroid = [0, 0, 4.97]}"}
    | {"start.position": "[0.08, 0, -1.27]"},
}
SHARE = 1e-8
"""By which share floating point may differ from what is exact."""


@contextlib.contextmanager
def soon_found():
    """Let less be searched and more be spared for the proof, so that one is soon found."""
    with patch.object(question, "NEAR", 0.5), patch.object(search, "EVALUATIONS", 4):
        yield


def small(name):
    """Return a certificate of exponential convergence by name; it is made once a run."""

    def make(folder):
        folder.mkdir()
        with soon_found():
            verdict = proof.converge(load(MISSION, SMALL[name]))
        assert verdict.status == "proved", verdict.reason
        verdict.certificate.save(folder / "made.json")

    return json.loads((kept(("exponential", name), make) / "made.json").read_text())


def potential(name):
    """Return a certificate by the potential, of those of `test_potential`."""
    return test_potential.proof(name).certificate.content


def vehicles_of(case):
    """Return what the graph's form takes of a case."""
    law = LAWS[tuple((PAPERS | case.content["mission"].get("law", {})).values())]
    numbers = np.array(case.design, float)
    tolerances = (getattr(case, name) for name in kit.TOLERANCES)
    return Vehicles(law, numbers, case.s3, *tolerances, turned=not case.late_axes)


def least(matrix):
    """Return the least eigenvalue of a matrix whose diagonal is brought to 1."""
    size = np.sqrt(np.abs(np.diag(matrix))) + 1e-300
    return np.linalg.eigvalsh(matrix / np.outer(size, size))[0]


class Truth:
    """An accepted certificate of exponential convergence in floating point."""

    of = kit.Case

    def __init__(self, content):
        self.content, self.case, self.rng = content, self.of(content), np.random.default_rng(0)
        case = self.case
        goal, claim = content["mission"]["goal"], content["claim"]
        if "height" in goal:
            high = case.points[:, 2].mean() - case.goal[2]
            assert high == pytest.approx(float(F(goal["height"])))
        self.claim, self.vehicles = claim, vehicles_of(case)
        self.starts = [
            {key: floats(value) for key, value in start.items()} for start in claim["starts"]
        ]

    def holds(self):
        """Hold it to what is true."""
        self.falls()
        self.stays()
        self.settles()
        for start in self.starts:
            self.begins(start)

    # --- the inequality

    def numbers(self, slope_):
        """Return what the parameters of the graph's form are, and the multipliers."""
        case, c = self.case, self.content
        lag = [case.a5, case.a6] if c["lag"] else []
        memory = [case.M] if c["memory"] else []
        held = [1.0, *case.w[1:], *lag, slope_, *memory]
        assert min(held) > 0
        return held, floats(c["multipliers"]["terms"])

    def limits(self):
        limits = Limits(self.vehicles, Reach.of(self.case.w[1:], self.case.level), self.case.slope)
        assert np.isfinite(limits.lever).all()
        assert limits.tilt < 1
        return limits

    def falls(self):
        """Ψ falls at the rate: what the graph gives is positive at every vertex."""
        low, high = floats(self.content["domain"]["bounds"])
        assert 0 < low < high
        ball = Ball((low + high) / 2, (high - low) / 2)
        numbers, terms = self.numbers(float(F(self.content["multipliers"]["slope"])))
        for corner in falls(self.limits(), ball, self.case.r).of_used()[1]:
            assert least(corner.at(numbers).bound(terms)) > -SHARE

    # --- positions

    def wedge(self):
        """Return the ends of x and y as stated, and of u."""
        said = re.search(r"lies in \[(.*?)\] x \[(.*?)\] times", self.content["statement"])
        level = [[float(F(x.split()[0])) for x in side.split(", ")] for side in said.groups()]
        return np.array([*level, floats(self.content["domain"]["wedge"])[2]])

    def places(self, many, side=None):
        """Return positions of the wedge, or of a face, (k, 3)."""
        low, high = self.wedge().T
        assert (low <= high).all()
        assert low[2] > 0
        share = self.rng.random((many, 3))
        share[:8] = list(itertools.product((0, 1), repeat=3))
        if side is not None:
            share[:, side[0]] = side[1]
        x, y, u = (low + (high - low) * share).T
        return self.case.points.mean(axis=0) - np.stack([x, y, np.ones_like(x)]).T / u[:, None]

    def off(self, positions):
        """Return |σ - σ*|, (k,)."""
        if self.case.scaled:
            sigma = feature(self.case.points, positions)
        else:
            sigma = np.array([seen(self.case.points, place) for place in positions])
        return np.linalg.norm(sigma - [0, 0, self.case.s3], axis=1)

    def shifted(self):
        """Return A and b."""
        case, tilt = self.case, self.limits().tilt
        lean = case.fixed / np.sqrt((1 + np.sqrt(1 - tilt**2)) / 2)
        spread = (lean * case.c / (case.m * case.g)) ** 2 * (1 / case.w[1] + 1 / case.w[2])
        return 1 + spread, lean * case.wind / case.g

    def stays(self, many=400):
        """No motion leaves the wedge, J is in its ball on the way, and the points in the cone."""
        case, domain = self.case, self.content["domain"]
        A, b = self.shifted()
        assert np.sqrt(2 * case.level * A) + b <= case.offset * (1 + SHARE)
        for side in itertools.product(range(3), (0, 1)):
            assert (self.off(self.places(60, side)) > case.offset * (1 - SHARE)).all()
        places = np.vstack([self.places(many), case.goal + self.rng.normal(size=(50, 3)) * 0.01])
        inside = places[self.off(places) <= case.offset]
        low, high = floats(domain["bounds"])
        if case.scaled:
            away = slope(case.points, inside) - (low + high) / 2 * np.eye(3)
            far = np.linalg.norm(away, 2, axis=(1, 2))
            assert far.max() <= (high - low) / 2 * (1 + SHARE)
        else:
            values = np.linalg.eigvalsh(depth_matrix(case.points, inside))
            assert low <= values.min() * (1 + SHARE)
            assert values.max() <= high * (1 + SHARE)
        cosine = self.claim["cone"]
        if cosine is not None:
            rays = case.points - inside[:, None]
            angle = np.arccos((rays[..., 2] / np.linalg.norm(rays, axis=2)).min())
            angle += np.arcsin(self.limits().tilt)
            assert float(F(cosine)) <= np.cos(angle) + SHARE
        camera = self.content["mission"].get("camera")
        if camera is not None:
            assert np.arccos(float(F(cosine))) <= float(F(camera["half_angle"])) * (1 + SHARE)

    def settles(self):
        """From some time on the vehicle is within the radius."""
        soon = {key: float(F(x)) for key, x in self.claim["settling"].items()}
        A, b = self.shifted()
        assert soon["offset"] > b
        level = (soon["offset"] - b) ** 2 / (2 * A)
        left = self.case.start_level * np.exp(-self.case.r * soon["time"])
        assert left <= level * (1 + SHARE)
        places = np.vstack([self.places(400), self.around(soon["radius"])])
        near = places[self.off(places) <= soon["offset"]]
        far = np.linalg.norm(near - floats(self.content["hover"]), axis=1)
        assert (far <= soon["radius"] * (1 + SHARE)).all()

    def around(self, radius, many=200):
        """Return positions of about that distance from the goal, (k, 3)."""
        way = self.rng.normal(size=(many, 3))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return self.case.goal + way * radius * self.rng.uniform(0.5, 2, size=(many, 1))

    # --- starts

    def states(self, start, many=60):
        """Return states of a start, the doubts that belong to them, and their positions."""
        case = self.case

        def pointed(n, size):
            way = self.rng.normal(size=(n, many))
            return size * way / kit.size(way)

        low, high = start["position"].T
        assert (low <= high).all()
        place = low[:, None] + (high - low)[:, None] * self.rng.random((3, many))
        force = pointed(3, start["thrust"] + case.m * case.g * start["tilt"])
        wind = pointed(3, case.wind)
        up = np.array([0, 0, case.m * case.g])[:, None] + case.m * wind - force
        thrust, x = kit.size(up), np.zeros((kit.SIZE, many))
        rho = up / thrust * np.array([-1, -1, 1])[:, None]
        x[kit.POSITION], x[kit.VELOCITY] = place, pointed(3, start["speed"])
        x[kit.ATTITUDE], x[kit.RATE] = (
            kit.quaternion_of(rho, np.zeros(many)),
            pointed(2, start["rate"]),
        )
        x[kit.THRUST] = thrust
        none = np.zeros((2, 2, many))
        lag = np.full(many, case.rotor_lag)
        return kit.View(case, x, kit.Doubt(np.ones(many), none, none, 0.0, wind, lag))

    def before(self, view):
        """Return what the latency remembers of a start that moved as it moves, (k,)."""
        case = self.case
        fading = np.exp(-case.r * case.latency)
        flow = kit.dot(view.kept_flow(), view.kept_flow())
        return case.M * case.latency**2 / 2 * fading * flow

    def begins(self, start):
        """No state of a start has a higher Ψ."""
        view = self.states(start)
        assert (view.energy() + self.before(view) <= self.case.start_level * (1 + SHARE)).all()
        assert self.case.start_level <= self.case.level
        low, high = self.wedge().T
        ray = self.case.points.mean(axis=0) - view.x[kit.POSITION].T
        at = np.column_stack([ray[:, :2] / ray[:, 2:], 1 / ray[:, 2]])
        assert ((low - SHARE <= at) & (at <= high + SHARE)).all()


class OfPotential(Truth):
    """An accepted certificate by the natural potential of every vehicle within tolerances."""

    of = test_potential.Case

    def holds(self):
        self.falls()
        self.stays()
        reach = {key: float(F(x)) for key, x in self.claim["reach"].items()}
        assert min(reach.values()) >= 0
        none = dict.fromkeys(("speed", "tilt", "rate", "thrust"), 0.0)
        x, y, z = floats(self.content["hover"])
        side = reach["sideways"] / np.sqrt(2)  # of a square in the disc
        disc = np.array([[x - side, x + side], [y - side, y + side], [z, z]])
        line = np.array([[x, x], [y, y], [z - reach["up"], z + reach["down"]]])
        for start in (*({"position": box, **none} for box in (disc, line)), *self.starts):
            self.begins(start)

    def limits(self):
        case = self.case
        far = len(case.points) + case.s3 + np.sqrt(2 * case.level / case.w[1])
        seen = len(case.points) - case.s3
        reach = replace(Reach.of(case.w[1:], case.level), speed=far, image=seen)
        limits = Limits(self.vehicles, reach, case.slope)
        assert np.isfinite(limits.lever).all()
        assert limits.tilt < 1
        return limits

    def falls(self):
        case = self.case
        numbers, terms = self.numbers(float(F(self.content["multipliers"]["slope"])))
        rate = float(F(self.claim["rate"])) * case.k[0] / case.m
        each = np.arange(7)
        assert case.wind == 0 or not case.fixed
        for corner in falls(self.limits(), Sector(case.slope), 0.0, potential=True).of_used()[1]:
            matrix = corner.at(numbers).bound(terms)
            matrix[each, each] -= rate
            assert least(matrix) > -SHARE
        height = self.claim["barrier_height"]
        assert height is None or not (case.thrust or case.latency or case.rotor_lag or case.wind)

    def stays(self, many=400):
        """Q is below its bound on the set."""
        case = self.case
        height = case.points[:, 2].mean() - case.goal[2]
        places = [self.around(height, many), self.around(height / 5, many)]
        places += [p + self.rng.normal(size=(40, 3)) * height / 3 for p in case.points]
        places = np.vstack(places)
        far = np.linalg.norm(case.points - places[:, None], axis=2).sum(axis=1)
        W = far + case.s3 * (places[:, 2] - case.goal[2])
        W -= np.linalg.norm(case.points - case.goal, axis=1).sum()
        inside = places[case.level >= W]
        if self.claim["barrier_height"] is None and len(inside):
            values = np.linalg.eigvalsh(depth_matrix(case.points, inside))
            assert values.max() <= case.slope * (1 + SHARE)

    def begins(self, start):
        view = self.states(start)
        Psi = test_potential.energy_of(view) + self.before(view)
        assert (Psi <= self.case.level * (1 + SHARE)).all()
