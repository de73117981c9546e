"""A rigid body that is not the modelled one, thousands at once, written in numpy for tests.

Body, camera, wind, delay and rotor lag are written here anew; of the package only the controller
is taken, as numbers in and numbers out. Arrays are (components, flights). All of it may be complex,
so that a derivative along a motion is exact by a complex step.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca
import numpy as np

from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import LAWS
from laws_kit import floats, position_of, scaled, seen

POSITION, VELOCITY, ATTITUDE, RATE = slice(0, 3), slice(3, 6), slice(6, 10), slice(10, 12)
THRUST, ANGULAR, LIFT, SIZE = 12, slice(13, 15), 15, 16
"""Parts of a state: the velocity in world axes, a quaternion, Ω1 and Ω2, T̃ in N, and what the
rotors have of the commanded e₃ × Γ/I in rad/s² and of the commanded U in N/s."""

TOLERANCES = ("thrust", "torque", "latency", "rotor_lag", "wind", "yaw_rate")

# --- geometry -----------------------------------------------------------------------------------


def dot(a, b):
    return (a * b).sum(axis=0)


def size(a):
    return np.sqrt(dot(a, a))


def cross(a, b):
    return np.stack([a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)])


def quarter(a):
    """Return e₃ × of horizontal parts."""
    return np.stack([-a[1], a[0]])


def times(matrices, vectors):
    """Return the products of matrices (i, j, N) and vectors (j, N)."""
    return (matrices * vectors).sum(axis=1)


def back(matrices, vectors):
    """Return the products of transposed matrices and vectors."""
    return (matrices * vectors[:, None]).sum(axis=0)


def rotation(quaternion):
    """Return R, (3, 3, N), from body to world axes."""
    w, x, y, z = quaternion / size(quaternion)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row) for row in rows])


def quaternion_of(vertical, heading):
    """Return the attitude with ρ = Rᵀe₃ and a heading: the least tilt, then the turn."""
    x, y, z = vertical
    tilt = np.stack([1 + z, y, -x, 0 * z])
    a, b = np.cos(heading / 2), np.sin(heading / 2)
    turned = [a * tilt[0], a * tilt[1] - b * tilt[2], a * tilt[2] + b * tilt[1], b * tilt[0]]
    return np.stack(turned) / size(tilt)


# --- the controller -----------------------------------------------------------------------------

BINARY = {ca.OP_ADD: np.add, ca.OP_SUB: np.subtract, ca.OP_MUL: np.multiply, ca.OP_DIV: np.divide}
UNARY = {
    ca.OP_NEG: np.negative,
    ca.OP_SQ: np.square,
    ca.OP_SQRT: np.sqrt,
    ca.OP_TWICE: lambda a: 2 * a,
    ca.OP_INV: lambda a: 1 / a,
    ca.OP_ASSIGN: lambda a: a,
}


def on_arrays(function):
    """Return a compiled graph as a function of arrays: each operation at once for all flights."""
    listing = [
        (function.instruction_id(k), function.instruction_input(k), function.instruction_output(k))
        for k in range(function.n_instructions())
    ]
    constants = {
        k: function.instruction_constant(k)
        for k, (op, *_) in enumerate(listing)
        if op == ca.OP_CONST
    }
    sizes = [function.nnz_out(k) for k in range(function.n_out())]

    def run(*inputs):
        work, outputs = {}, [[0.0] * n for n in sizes]
        for k, (op, i, o) in enumerate(listing):
            if op in BINARY:
                work[o[0]] = BINARY[op](work[i[0]], work[i[1]])
            elif op in UNARY:
                work[o[0]] = UNARY[op](work[i[0]])
            elif op == ca.OP_INPUT:
                work[o[0]] = inputs[i[0]][i[1]]
            elif op == ca.OP_OUTPUT:
                outputs[o[0]][o[1]] = work[i[0]]
            else:
                assert op == ca.OP_CONST
                work[o[0]] = constants[k]
        return outputs

    return run


# --- what a certificate says --------------------------------------------------------------------


class Case:
    """The numbers of a mission and of its claim, in floating point.

    Parameters
    ----------
    content : mapping
        A certificate of the kind "exponential".
    """

    def __init__(self, content):
        mission, self.content = content["mission"], content
        law = {"feature": "centroid", "goal": "image", "force": "modelled"}
        law |= mission.get("law", {})
        self.scaled, self.measured = law["feature"] == "scaled", law["force"] == "measured"
        law = LAWS[law["feature"], law["goal"], law["force"]]
        self.controller = on_arrays(derive_controller(law).function())
        vehicle = mission["vehicle"]
        self.m, self.g = float(Fraction(vehicle["mass"])), float(Fraction(vehicle["gravity"]))
        self.inertia = floats(vehicle["inertia"])
        self.k = np.array([float(Fraction(mission["gains"][f"k{i}"])) for i in (1, 2, 3, 4)])
        k1, k2, k3, k4 = self.k
        self.c, self.kappa, self.k12 = (
            k1**2 * k2 / self.m,
            (k1 * k2 + k3) / self.m,
            k1 * k2 / self.m,
        )
        self.K4 = self.kappa + k4 / self.m
        self.points = floats(mission["target"]["points"])
        if content.get("goal_position") is None:
            q = floats(mission["goal"]["centroid"])
            self.goal = position_of(self.points, q)
        else:
            self.goal = floats(content["goal_position"])
            q = seen(self.points, self.goal)
        assert np.abs(q[:2]).max() < 1e-12
        self.s3 = scaled(q[None], len(self.points))[0, 2] if self.scaled else q[2]
        self.fixed = self.s3 if law.goal.name == "image" else 0.0
        yaw = float(Fraction(mission["gains"]["k_yaw"]))
        self.design = [self.m, self.g, *self.inertia, *self.k, yaw, 0.0, 0.0, self.s3]
        asked = mission.get("uncertainty", {})
        for name in TOLERANCES:
            setattr(self, name, float(Fraction(asked.get(name, "0"))))
        self.late_axes = asked.get("gyro_turned") == "false"
        first, second, third = self.inertia
        self.arm, self.drag_ratio = (
            float(Fraction(vehicle.get(key, "1"))) for key in ("arm", "drag_ratio")
        )
        self.compensated = np.array([[0, (third - first) / second], [(second - third) / first, 0]])
        self.turn_radius = (1 + self.torque) * np.abs(self.compensated).max() + self.torque
        self.start = floats(mission["start"]["position"]) if "start" in mission else self.goal
        self._claim(content)

    def _claim(self, content):
        lag, claim = content["lag"] or {"torque": "0", "thrust": "0"}, content["claim"]
        self.w = np.array([1.0, *floats(content["weights"])])
        self.a5, self.a6 = (float(Fraction(lag[k])) for k in ("torque", "thrust"))
        self.M = float(Fraction(content["memory"] or "0"))
        low, self.slope = floats(content["domain"]["bounds"])
        self.pace, self.offset = (
            (low + self.slope) / 2,
            float(Fraction(content["domain"]["offset"])),
        )
        self.level, self.r, self.start_level = (
            float(Fraction(claim[k])) for k in ("level", "rate", "start_level")
        )
        self.cosine = None if claim.get("cone") is None else float(Fraction(claim["cone"]))
        self.rotors = floats(claim["rotors"]) if "rotors" in claim else None

    def settling(self):
        """Return the radius that is claimed about the goal, m, and since when, s."""
        claim = self.content["claim"]["settling"]
        return float(Fraction(claim["radius"])), float(Fraction(claim["time"]))

    def bounds(self):
        """Return upper bounds on the level set, and the lower one of h."""
        w1, w2, w3, w4 = self.w
        two, weight, gust = 2 * self.level, self.m * self.g, self.m * self.wind
        b3, b32 = np.sqrt(two / w3), np.sqrt(two * (1 / w2 + 1 / w3))
        bz, v = np.sqrt(two * (1 / w4 + 1 / w3)), self.k[0] / self.m * np.sqrt(two * (1 + 1 / w2))
        force, lever = self.c * b32, self.c * self.fixed
        low = np.sqrt((weight - force) ** 2 - gust**2) - lever
        h, past = self.c * self.kappa / low, self.slope * v
        if self.late_axes:
            past += (self.s3 + np.sqrt(two / w1)) * (h * bz + self.yaw_rate)
        n = self.latency * past
        p3 = h * bz * gust / low
        return {
            "b1": np.sqrt(two / w1),
            "b3": b3,
            "b32": b32,
            "bz": bz,
            "v": v,
            "n": n,
            "h": h,
            "h_low": self.c * self.kappa / (weight + force - lever),
            "pi": 2 * h * (b3 + n) + p3,
            "q": (1 + self.thrust) * h * (b3 + n) + p3,
            "u": self.kappa * (b3 + n),
            "chi": gust / low,
        }

    def image(self, position, velocity):
        """Return the feature and its y = J V, world axes, of a level camera, (3, N)."""
        n, q, y, rays = len(self.points), 0, 0, []
        for point in self.points:
            ray = point[:, None] - position
            far = size(ray)
            p = ray / far
            rays.append(p)
            q = q + p
            y = y + (velocity - p * dot(p, velocity)) / far
        if not self.scaled:
            return q, y
        lacking = sum(dot(a - b, a - b) for i, a in enumerate(rays) for b in rays[:i])
        a = size(q)
        phi, u = np.sqrt(n * (n + a) / (2 * lacking)), q / a
        along = dot(u, y)
        return phi * u, phi / a * (y - u * along) + phi**3 / n * u * along


# --- the body -----------------------------------------------------------------------------------


@dataclass
class Doubt:
    """What a vehicle is, and what nature does, at one time; (…, N).

    Attributes
    ----------
    gain : (N,)
        ς.
    torque : (2, 2, N)
        γ.
    turn : (2, 2, N)
        G_t: e₃ × Ω̇ = (I + γ) a_a - Ω3 G_t e₃ × Ω, a_a of the torque with its gyroscopic part.
    yaw : (N,)
        Ω3, rad/s.
    wind : (3, N)
        Its force over mass, world axes, m/s².
    lag : (N,)
        τ, s; 0 for rotors that do not lag.
    """

    gain: np.ndarray
    torque: np.ndarray
    turn: np.ndarray
    yaw: np.ndarray
    wind: np.ndarray
    lag: np.ndarray


@dataclass
class View:
    """What is read off a state: feature, y, V, ρ, Ω and a = specific force in body axes, R, T_c."""

    case: Case
    x: np.ndarray
    doubt: Doubt
    R: np.ndarray = field(init=False)

    def __post_init__(self):
        case, x, doubt = self.case, self.x, self.doubt
        self.R = rotation(x[ATTITUDE])
        world = np.concatenate([x[VELOCITY], doubt.wind])
        self.V, self.wind = back(self.R, world[:3]), back(self.R, world[3:])
        self.rho, self.Omega = self.R[2], np.stack([*x[RATE], doubt.yaw + 0 * x[RATE][0]])
        self.level_image, self.level_flow = case.image(x[POSITION], x[VELOCITY])
        self.felt = self.wind - np.stack([0 * x[THRUST], 0 * x[THRUST], x[THRUST]]) / case.m
        self.known_thrust = -case.m * self.felt[2] if case.measured else x[THRUST]
        self.D = self.known_thrust - case.c * case.fixed
        self.z = quarter(x[RATE])

    def feature(self, level):
        """Return what the camera has of a level image: turned by the attitude of now."""
        return back(self.R, level)

    def kept(self):
        """Return what is kept of an image until it is used: level, or as the camera has it."""
        return self.feature(self.level_image) if self.case.late_axes else self.level_image

    def kept_flow(self):
        """Return minus the rate of that, but for what the wind leans and the yaw turns."""
        if not self.case.late_axes:
            return self.level_flow
        turned = cross(self.Omega, self.feature(self.level_image))
        if not self.case.fixed:
            aside = self.Omega[2] * self.case.s3 / self.case.g * quarter(self.wind)
            turned = turned + np.stack([*aside, 0 * aside[0]])
        return self.feature(self.level_flow) + turned

    def as_level(self, kept):
        """Return the level image that the controller takes what was kept for."""
        return times(self.R, kept) if self.case.late_axes else kept

    def commanded(self, level):
        """Return U, N/s, and e₃ × Γ/I, rad/s², of the controller with this level image."""
        lift, torque = self.asked(level)
        first, second, _ = self.case.inertia
        return lift, np.stack([-torque[1] / second, torque[0] / first])

    def asked(self, level):
        """Return U, N/s, and Γ, N m, of the controller with this level image."""
        own = [*self.feature(level), *self.V, *self.rho, *self.Omega, self.x[THRUST]]
        if self.case.measured:
            own += list(self.felt)
        (lift,), torque = self.case.controller(own, self.case.design)
        return lift, torque

    def errors(self):
        """Return δ1, δ2, δ3 and δ4, (11, N)."""
        case = self.case
        goal = case.s3 * (np.eye(3)[:, 2:] if case.fixed else self.rho)
        d1 = self.feature(self.level_image) - goal
        d2 = case.m / case.k[0] * self.V - d1
        force = case.m * (self.felt + case.g * self.rho)
        d3 = force / case.c + d2
        d4 = self.D / (case.c * case.kappa) * self.z + d3[:2]
        return np.concatenate([d1, d2, d3, d4])

    def lagging(self, d, command):
        """Return μ and μT, (3, N), of the errors, for what rotors have: (e₃ × Γ/I, U)."""
        case = self.case
        angular, lift = command
        s = -case.K4 * d[9:] - case.k12 * (d[6:8] - d[3:5])
        own = self.D / (case.c * case.kappa) * angular - s
        return np.concatenate([own, [lift / case.c - case.kappa * d[8]]])

    def energy(self):
        """Return E, (N,)."""
        case, d = self.case, self.errors()
        e = sum(w * dot(part, part) for w, part in zip(case.w, parts(d), strict=True))
        mu = self.lagging(d, (self.x[ANGULAR], self.x[LIFT]))
        return (e + self.doubt.lag * (case.a5 * dot(mu[:2], mu[:2]) + case.a6 * mu[2] ** 2)) / 2


def parts(d):
    """Return δ1, δ2, δ3 and δ4."""
    return d[:3], d[3:6], d[6:9], d[9:]


def body_rate(view, level):
    """Return how a state moves, (16, N), with a controller that has this level image.

    What rotors that do not lag have of a command is not moved: it is the command.
    """
    case, x, doubt = view.case, view.x, view.doubt
    lift, angular = view.commanded(level)
    slow = doubt.lag > 0
    pace = np.where(slow, 1 / np.where(slow, doubt.lag, 1), 0)
    lift_had, had = np.where(slow, x[LIFT], lift), np.where(slow, x[ANGULAR], angular)
    turned = had + times(doubt.torque, had) - doubt.yaw * times(doubt.turn, view.z)
    w, a, b, c = x[ATTITUDE]
    p, q, r = view.Omega
    spin = np.stack(
        [
            -a * p - b * q - c * r,
            w * p + b * r - c * q,
            w * q + c * p - a * r,
            w * r + a * q - b * p,
        ]
    )
    pull = times(view.R, view.felt)
    pull[2] = pull[2] + case.g
    return np.concatenate(
        [
            x[VELOCITY],
            pull,
            spin / 2,
            [turned[1], -turned[0]],
            [doubt.gain * lift_had],
            pace * (angular - x[ANGULAR]),
            [pace * (lift - x[LIFT])],
        ]
    )


# --- a state from its errors --------------------------------------------------------------------


def state_of(case, position, d, mu, wind, heading, doubt):
    """Return the state with errors δ2, δ3, δ4 = d (8, N) and μ (3, N) at a position, and where.

    The wind, body axes here, is put into the world axes of `doubt`. NaN where no attitude has it.
    """
    k1, zero = case.k[0], 0 * position[0]
    force = case.c * (d[3:6] - d[:3]) - case.m * wind
    rho = force / (case.m * case.g)
    rho[2] = np.sqrt(1 - rho[0] ** 2 - rho[1] ** 2)
    thrust = case.m * case.g * rho[2] - force[2]
    x = np.zeros((SIZE, len(zero)), np.result_type(position, d))
    x[POSITION], x[ATTITUDE], x[THRUST] = position, quaternion_of(rho, heading), thrust
    doubt.wind = times(rotation(x[ATTITUDE]), wind)
    at = View(case, x, doubt)
    d1 = at.errors()[:3]
    x[VELOCITY] = times(at.R, k1 / case.m * (d1 + d[:3]))
    z = case.c * case.kappa / at.D * (d[6:] - d[3:5])
    x[RATE] = np.stack([z[1], -z[0]])
    at = View(case, x, doubt)
    none = at.lagging(at.errors(), (np.zeros((2, 1)), zero))
    x[ANGULAR] = case.c * case.kappa / at.D * (mu[:2] - none[:2])
    x[LIFT] = case.c * (mu[2] - none[2])
    return x
