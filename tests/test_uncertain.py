"""The eight laws, and a vehicle that is not the modelled one: identities, mutants, a motion."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from hoverproof.algebra.identity import normal_form, prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.choices import SCALED
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.lyapunov import derive_error_dynamics
from hoverproof.servo.true_vehicle import QUARTER, kappa
from hoverproof.servo.uncertain import Doubt, Motion, derive_uncertain_loop, error_rates
from hoverproof.servo.variables import Design, Errors, Measurement
from sampling import share_of

each_law = pytest.mark.parametrize("law", LAWS.values(), ids=lambda law: law.name)
MEASURED = {"image": LAWS["centroid", "image", "measured"]} | {
    "inertial": LAWS["scaled", "inertial", "measured"]
}
MODELLED = LAWS["centroid", "image", "modelled"]

# --- the eight laws -----------------------------------------------------------------------------


@each_law
def test_no_controller_of_the_eight_knows_a_depth(law):
    """It is solved for while y = JV is a symbol; what is not measured is no input of it."""
    controller = derive_controller(law)
    f = controller.function()
    assert not f.free_sx()
    assert f.size1_in(0) == law.measurement.size() == (16 if "measured" in law.name else 13)
    assert f.size1_in(1) == law.design.size()


@pytest.mark.parametrize("goal", ["image", "inertial"])
def test_with_an_ideal_accelerometer_the_measured_force_is_the_modelled_one(goal):
    measured, modelled = (LAWS["centroid", goal, force] for force in ("measured", "modelled"))
    ours, theirs = derive_controller(measured), derive_controller(modelled)
    z, d = theirs.measured, theirs.design
    old = ca.vertcat(ours.measured.vector(), ours.design.vector())
    new = ca.vertcat(measured.force.ideal(z, d).vector(), d.vector())
    told = ca.vertcat(ours.thrust_rate, ours.angular_acceleration, ours.torque)
    told = ca.substitute(told, old, new)
    asked = ca.vertcat(theirs.thrust_rate, theirs.angular_acceleration, theirs.torque)
    assert prove_equal(told, asked)
    assert prove_equal(
        measured.errors(measured.force.ideal(z, d), d).vector(), modelled.errors(z, d).vector()
    )


# --- the uncertain vehicle ----------------------------------------------------------------------


@each_law
def test_the_error_rates_of_the_uncertain_vehicle(law):
    loop = derive_uncertain_loop(law)
    assert prove_equal(loop.rate, loop.closed_form())
    missed = loop.doubt.feature - loop.doubt.force
    asked = loop.design.stiffness * kappa(loop.design) * (loop.errors.d3 - missed)[2]
    assert prove_equal(loop.thrust_rate, asked)
    zeta = loop.errors.d4 - loop.errors.d3[:2]
    assert prove_equal(QUARTER @ loop.body.rate[:2], loop.motion.quickness * zeta)


@each_law
def test_what_the_controller_knows_is_off_by_what_it_measures_wrongly(law):
    loop = derive_uncertain_loop(law)
    n, b, known, body, d = loop.doubt.feature, loop.doubt.force, loop.known, loop.body, loop.design
    own, e = law.errors(known, d), loop.errors
    speed = d.slowness * (known.velocity - body.velocity)
    seen = known.centroid - body.centroid
    if law.goal.name == "inertial":
        seen -= d.goal_centroid[2] * (known.gravity_direction - body.gravity_direction)
    assert prove_equal(n, seen - speed)
    right = ca.vertcat(e.d1 + n + speed, e.d2 - n, e.d3 - n + b, e.d4 - (n - b)[:2])
    assert prove_equal(own.vector(), right)


@each_law
def test_without_doubt_it_is_the_loop_of_the_modelled_vehicle(law):
    """δ̇ of the controller's own model, for any Ω3 and any depth flow, goal straight below."""
    controller = derive_controller(law)
    z, d, y = Measurement.symbols(), controller.design, ca.SX.sym("y", 3)
    own = law.force.ideal(z, d)
    rates = lie_derivative(
        law.errors(controller.measured, d).vector(),
        controller.measured.vector(),
        controller.measured_rate(y),
    )
    rates = ca.substitute(rates, controller.measured.vector(), own.vector())
    e = law.errors(own, d)
    quickness = d.stiffness * kappa(d) / law.lever(z.thrust, d)
    motion = Motion(y, z.rate, law.goal.fixed(d)[2], quickness, quickness * e.d3[2], 0, 0)
    sideways = d.goal_centroid[:2]
    claimed = error_rates(e, motion, Doubt.none(), d)
    rates, claimed = ca.substitute([rates, claimed], [sideways], [ca.SX.zeros(2)])
    assert prove_equal(rates, claimed)


@pytest.mark.parametrize("law", [MODELLED, MEASURED["inertial"]], ids=lambda law: law.name)
def test_without_doubt_it_is_what_certificates_are_about(law):
    """The closed form over X alone, with Ω3 = 0, is the derived one."""
    dynamics = derive_error_dynamics(law)
    d, e = dynamics.design, Errors.from_vector(dynamics.errors)
    quickness = dynamics.f * d.k1 / d.mass
    z = quickness * (e.d4 - e.d3[:2])
    rate = ca.vertcat(-QUARTER @ z, 0)
    motion = Motion(
        dynamics.depth_flow, rate, law.goal.fixed(d)[2], quickness, quickness * e.d3[2], 0, 0
    )
    claimed = error_rates(e, motion, Doubt.none(), d)
    sideways = d.goal_centroid[:2]
    left, claimed = ca.substitute([dynamics.rate, claimed], [sideways], [ca.SX.zeros(2)])
    assert prove_equal(left, claimed)


def true_flow(loop):
    """Return symbols (T̃, wind, Ω) and how they move, but for Ω̇, which no lever depends on."""
    state = ca.vertcat(loop.body.thrust, loop.wind)
    flow = ca.vertcat(loop.doubt.thrust_gain * loop.thrust_rate, -skew(loop.body.rate) @ loop.wind)
    return state, flow


@pytest.mark.parametrize("goal", ["image", "inertial"])
def test_an_exact_accelerometer_leaves_the_force_right_in_any_steady_wind(goal):
    """b = 0, ψ = (ς - 1)(p1 - p2), p3 = (Ω × wind)₃/D_c, χ = 1 + wind₃/D_c, the vertical known."""
    law = MEASURED[goal]
    loop = derive_uncertain_loop(law)
    d, known, doubt, motion = loop.design, loop.known, loop.doubt, loop.motion
    felt = (loop.wind - loop.body.thrust * E3) / d.mass
    wrong = ca.vertcat(known.specific_force, known.gravity_direction)
    right = ca.vertcat(felt, loop.body.gravity_direction)

    def at(expression):
        return ca.substitute(expression, wrong, right)

    lever = at(law.lever(law.force.thrust(known, d), d))
    state, flow = true_flow(loop)
    taken = at(loop.thrust_rate) + lever * at(motion.crosswind)
    flow = at(flow)
    drift = (lie_derivative(lever, state, flow) - taken) / lever
    p1, p2 = at(motion.sinking), at(motion.sinking_by_error)
    assert prove_zero(at(doubt.force))
    assert prove_equal(drift, (doubt.thrust_gain - 1) * (p1 - p2))
    assert prove_equal(at(doubt.lever_ratio), 1 + loop.wind[2] / lever)
    assert prove_equal(at(motion.crosswind), (skew(loop.body.rate) @ loop.wind)[2] / lever)
    assert not prove_equal(drift, (doubt.thrust_gain - 1) * p1)  # the error of the feature counts


@pytest.mark.parametrize("goal", ["image", "inertial"])
def test_a_modelled_force_is_wrong_by_thrust_and_wind(goal):
    """b = ((T̃ - T_c) e₃ - wind)/c, and p3 = 0; the vertical is known."""
    loop = derive_uncertain_loop(LAWS["scaled", goal, "modelled"])
    off = (loop.body.thrust - loop.known.thrust) * E3 - loop.wind
    level = loop.known.gravity_direction, loop.body.gravity_direction
    assert prove_equal(ca.substitute(loop.doubt.force, *level), off / loop.design.stiffness)
    assert prove_zero(loop.motion.crosswind)


def test_wrong_moments_of_inertia_are_a_gain_and_a_turn_with_the_yaw():
    """e₃ × Ω̇ = (I + γ) e₃ × α + Ω3 G e₃ × Ω, whatever the torque about the vertical axis is."""
    Omega, asked = ca.SX.sym("Omega", 3), ca.SX.sym("alpha", 3)
    own, true, alpha = ca.SX.sym("I", 3), ca.SX.sym("I_true", 3), ca.SX.sym("alpha_true", 3)
    torque = own * asked + skew(Omega) @ (own * Omega)
    state = replace(rigid_body.RigidBodyState.symbols(), rate=Omega)
    alpha = rigid_body.state_rate(
        state,
        torque=torque,
        thrust_rate=ca.SX(0),
        mass=ca.SX(1),
        inertia=true,
        gravity=ca.SX(0),
    ).rate
    gain, gyroscopic = inertia_doubt(own, true, ca)
    z = QUARTER @ Omega[:2]
    right = QUARTER @ asked[:2] + gain @ QUARTER @ asked[:2] + Omega[2] * gyroscopic @ z
    assert prove_equal(QUARTER @ alpha[:2], right)
    assert prove_zero(gyroscopic[0, 0])
    assert prove_zero(ca.substitute(gyroscopic, true, own))


def inertia_doubt(own, true, arithmetic):
    """Return γ and G, (2, 2), of moments of inertia."""
    rows = arithmetic.vertcat if arithmetic is ca else np.array
    off = [own[i] - true[i] for i in range(3)]
    gain = [own[1] / true[1] - 1, own[0] / true[0] - 1]
    g12, g21 = (off[2] - off[0]) / true[1], -(off[2] - off[1]) / true[0]
    if arithmetic is ca:
        zero = ca.SX(0)
        return ca.diag(rows(*gain)), rows(ca.horzcat(zero, g12), ca.horzcat(g21, zero))
    return np.diag(gain), rows([[0, g12], [g21, 0]])


# --- the scaled feature -------------------------------------------------------------------------


class Scaled:
    """The scaled feature of a centroid over symbols, with the two roots in it declared."""

    def __init__(self):
        self.q, self.n = ca.SX.sym("q", 3), ca.SX.sym("n")
        self.a, self.phi = ca.SX.sym("a"), ca.SX.sym("phi")
        below = self.n**2 - ca.dot(self.q, self.q)
        self.roots = {
            self.a: ca.dot(self.q, self.q),
            self.phi: self.n * (self.n + self.a) / (2 * below),
        }
        self.s = SCALED.at(self.q, self.n)

    def slope(self, a, phi, q):
        """Return what Ds is claimed to be, (3, 3)."""
        outer = q @ q.T / a**2
        return phi / a * (ca.SX.eye(3) - outer) + phi**3 / self.n * outer


def test_the_scaled_feature_and_its_slope():
    f = Scaled()
    assert prove_equal(f.s, f.phi * f.q / f.a, f.roots)
    assert prove_equal(2 * f.phi**2 * (1 - f.a / f.n), ca.SX(1), f.roots)
    assert prove_equal(ca.jacobian(f.s, f.q), f.slope(f.a, f.phi, f.q), f.roots)
    length = ca.SX.sym("length")
    phi = ca.sqrt(1 / (2 * (1 - length / f.n)))
    roots = {f.phi: 1 / (2 * (1 - length / f.n))}
    assert prove_equal(ca.jacobian(phi, length), f.phi**3 / f.n, roots)


def test_the_scaled_feature_moves_by_the_depths_through_its_slope_alone():
    f, Omega, V = Scaled(), ca.SX.sym("Omega", 3), ca.SX.sym("V", 3)
    Q = ca.tril2symm(ca.SX.sym("Q", ca.Sparsity.lower(3)))
    rate = lie_derivative(f.s, f.q, camera.centroid_rate(f.q, Omega, Q @ V))
    claimed = -skew(Omega) @ f.s - f.slope(f.a, f.phi, f.q) @ Q @ V
    assert prove_equal(rate, claimed, f.roots)


def test_what_turns_velocity_into_its_rate_turns_with_the_camera():
    """While q and Q turn, J' = -sk(Ω) J + J sk(Ω): R J Rᵀ depends on the position alone."""
    f, Omega = Scaled(), ca.SX.sym("Omega", 3)
    lower = ca.SX.sym("Q", ca.Sparsity.lower(3))
    Q = ca.tril2symm(lower)
    J = ca.jacobian(f.s, f.q) @ Q
    turned = Q @ skew(Omega) - skew(Omega) @ Q
    state = ca.vertcat(f.q, ca.vertcat(*lower.nz))
    flow = ca.vertcat(-skew(Omega) @ f.q, ca.vertcat(*ca.tril(turned).nz))
    rate = ca.reshape(lie_derivative(ca.vec(J), state, flow), 3, 3)
    assert prove_equal(rate, J @ skew(Omega) - skew(Omega) @ J, f.roots)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_spread_is_what_the_centroid_lacks(n):
    points, r = ca.SX.sym("P", 3, n), ca.SX.sym("r", n)
    rays = camera.directions(points)
    q = camera.centroid(rays)
    roots = {r[i]: ca.sumsqr(points[:, i]) for i in range(n)}
    assert prove_equal(camera.spread(rays, q), n**2 - ca.dot(q, q), roots)


# --- an independent rigid body ------------------------------------------------------------------


class Flying:
    """A rigid body in numpy, of another mass, thrust and inertia than modelled, in steady wind.

    Feature, velocity and vertical are measured with errors that are steady in body axes. It takes
    from the package only the controller, as numbers in and numbers out.
    """

    points = np.array([[0.4, 0.5, 0.1], [-0.5, 0.4, 0], [-0.4, -0.5, 0.2], [0.5, -0.6, 0]]).T
    mass, gravity, gains = 1.5, 9.8, np.array([0.9, 1.7, 4.0, 9.0])
    inertia, yaw_gain, s3 = np.array([0.02, 0.025, 0.04]), 0.03, 1.3
    true_mass, true_inertia = 1.8, np.array([0.026, 0.021, 0.05])
    thrust_gain, wind = 0.85, np.array([0.7, -0.4, 0.5])
    missed, drift = np.array([0.03, -0.02, 0.05]), np.array([-0.04, 0.02, 0.03])
    lean = np.array([0.02, 0.03, -0.01])

    def __init__(self, law):
        self.law, self.controller = law, derive_controller(law).function()
        self.fixed = self.s3 if law.goal.name == "image" else 0.0
        k1, k2, k3, _ = self.gains
        self.c, self.kappa = k1**2 * k2 / self.mass, (k1 * k2 + k3) / self.mass
        self.design = np.r_[
            self.mass, self.gravity, self.inertia, self.gains, self.yaw_gain, 0, 0, self.s3
        ]

    def start(self):
        """Return position, V, R by rows, Ω and the commanded thrust."""
        R = rigid_body.rotation_matrix(0.2, -0.3, 0.7)
        return np.r_[0.3, -0.2, -1.7, 0.4, -0.6, 0.3, R.ravel(), 0.5, -0.7, 0.9, 17.0]

    def seen(self, x):
        """Return the feature and the rate that V makes in it."""
        xi, V, R = x[:3], x[3:6], x[6:15].reshape(3, 3)
        rays = R.T @ (self.points - xi[:, None])
        r = np.linalg.norm(rays, axis=0)
        p, n = rays / r, self.points.shape[1]
        q = p.sum(1)
        y = sum((V - p[:, i] * (p[:, i] @ V)) / r[i] for i in range(n))
        if self.law.feature.name == "centroid":
            return q, y
        a = np.linalg.norm(q)
        phi, u = 1 / np.sqrt(2 * (1 - a / n)), q / a
        return phi * u, phi / a * (y - u * (u @ y)) + phi**3 / n * u * (u @ y)

    def felt(self, x):
        """Return the true specific force, body axes, m/s²."""
        R, thrust = x[6:15].reshape(3, 3), self.thrust_gain * x[18]
        return (R.T @ self.wind - thrust * np.array([0, 0, 1])) / self.true_mass

    def known_thrust(self, x):
        return x[18] if self.law.force.name == "modelled" else -self.mass * self.felt(x)[2]

    def commanded(self, x):
        """Return U and Γ."""
        own = [self.seen(x)[0] + self.missed, x[3:6] + self.drift, x[12:15] + self.lean]
        own += [x[15:18], [x[18]]]
        if self.law.force.name == "measured":
            own.append(self.felt(x))
        thrust_rate, torque = self.controller(np.concatenate(own), self.design)
        return float(thrust_rate), np.array(torque).ravel()

    def rate(self, x):
        V, R, Omega = x[3:6], x[6:15].reshape(3, 3), x[15:18]
        thrust_rate, torque = self.commanded(x)
        inertia = self.true_inertia
        return np.concatenate(
            [
                R @ V,
                -np.cross(Omega, V) + self.felt(x) + self.gravity * R[2],
                (R @ np.cross(np.eye(3), Omega)).ravel(),
                (torque - np.cross(Omega, inertia * Omega)) / inertia,
                [thrust_rate],
            ]
        )

    def errors(self, x):
        k1, goal = self.gains[0], self.s3 * np.array([0, 0, 1])
        rho = x[12:15]
        d1 = self.seen(x)[0] - (goal if self.fixed else self.s3 * rho)
        d2 = self.mass / k1 * x[3:6] - d1
        d3 = self.mass * (self.felt(x) + self.gravity * rho) / self.c + d2
        z = np.cross([0, 0, 1], x[15:18])
        lever = self.known_thrust(x) - self.c * self.fixed
        return np.concatenate([d1, d2, d3, (lever / (self.c * self.kappa) * z + d3)[:2]])

    def differenced(self, step=1e-4):
        """Return the rates of the errors by differences along the motion."""
        return sum(
            w * self.errors(self.moved(k * step)) for k, w in ((1, 8), (-1, -8), (2, -1), (-2, 1))
        ) / (12 * step)

    def moved(self, time):
        x, f = self.start(), self.rate
        a = f(x)
        b = f(x + time / 2 * a)
        c = f(x + time / 2 * b)
        return x + time / 6 * (a + 2 * b + 2 * c + f(x + time * c))

    def doubt(self, x):
        """Return what is in doubt, and the motion: by hand, from the vehicle's own numbers."""
        X, (thrust_rate, _) = self.errors(x), self.commanded(x)
        measured = self.law.force.name == "measured"
        gain = self.thrust_gain * self.mass / self.true_mass
        aside = self.mass / self.true_mass * (x[6:15].reshape(3, 3).T @ self.wind)
        lever = self.known_thrust(x) - self.c * self.fixed
        p1, p12 = self.c * self.kappa * X[8] / lever, thrust_rate / lever
        off = (gain - 1) * x[18] * np.array([0, 0, 1]) - aside
        gamma, gyroscopic = inertia_doubt(self.inertia, self.true_inertia, np)
        n = self.missed - self.mass / self.gains[0] * self.drift
        n -= 0 if self.fixed else self.s3 * self.lean
        b = self.mass * self.gravity * self.lean + (0 if measured else off)
        doubt = [
            [gain, (gain * x[18] - self.c * self.fixed) / lever],
            [(gain - 1) * p12 if measured else 0.0],
            *(gamma.T.ravel(), gyroscopic.T.ravel(), n, b / self.c),
        ]
        crosswind = np.cross(x[15:18], aside)[2] / lever if measured else 0.0
        quickness = self.c * self.kappa / lever
        motion = [self.seen(x)[1], x[15:18], [self.fixed, quickness, p1, p1 - p12, crosswind]]
        return np.concatenate(doubt), np.concatenate(motion)


@each_law
def test_a_rigid_body_with_everything_wrong_moves_its_errors_so(law):
    parts = [layout.symbols() for layout in (Errors, Motion, Doubt, Design)]
    f = ca.Function("f", [part.vector() for part in parts], [error_rates(*parts)])
    body = Flying(law)
    x = body.start()
    doubt, motion = body.doubt(x)
    claimed = np.array(f(body.errors(x), motion, doubt, body.design)).ravel()
    shown = body.differenced()
    assert claimed == pytest.approx(shown, rel=1e-7, abs=1e-7)
    sure = Doubt.none().vector()
    blind = np.array(f(body.errors(x), motion, ca.DM(ca.evalf(sure)), body.design)).ravel()
    assert np.abs(blind - shown)[6:].max() > 0.1


# --- mutants ------------------------------------------------------------------------------------

BINARY = {
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_MUL: lambda a, b: a * b,
    ca.OP_DIV: lambda a, b: a / b,
}
UNARY = {
    ca.OP_NEG: lambda a: -a,
    ca.OP_SQ: lambda a: a * a,
    ca.OP_TWICE: lambda a: 2 * a,
    ca.OP_INV: lambda a: 1 / a,
}
OTHER = {ca.OP_ADD: ca.OP_SUB, ca.OP_SUB: ca.OP_ADD, ca.OP_MUL: ca.OP_DIV, ca.OP_DIV: ca.OP_MUL}


def computed(op, operands, way):
    """Return the result of an operation; with a way of 0 to 3, a wrong one."""
    if op in UNARY:
        (a,) = operands
        right = UNARY[op](a)
        return right if way is None else (-right, a, 2 * right, right / 2)[way]
    a, b = operands
    right = BINARY[op](a, b)
    return right if way is None else (BINARY[OTHER[op]](a, b), a, b, 2 * right)[way]


def instructions(function):
    """Return operation, inputs, outputs and constant of each instruction."""
    for k in range(function.n_instructions()):
        op, i = function.instruction_id(k), function.instruction_input(k)
        constant = function.instruction_constant(k) if op == ca.OP_CONST else 0
        yield op, i[: 1 if op in UNARY else 2], function.instruction_output(k), constant


def run(listing, inputs, outputs, wrong=None, way=None):
    """Run a graph on expressions, with the instruction `wrong` computed in a wrong way."""
    work, result = {}, [ca.SX(0)] * outputs
    for k, (op, i, o, constant) in enumerate(listing):
        if op == ca.OP_INPUT:
            work[o[0]] = inputs[i[1]]
        elif op == ca.OP_OUTPUT:
            result[o[1]] = work[i[0]]
        elif op == ca.OP_CONST:
            work[o[0]] = ca.SX(constant)
        else:
            work[o[0]] = computed(op, [work[at] for at in i], way if k == wrong else None)
    return ca.vertcat(*result)


def graph_mutants(symbols, expression, values):
    """Yield an expression at values, with one operation of its graph wrong, in two of four ways."""
    f = ca.Function("f", [symbols], [ca.densify(ca.vec(expression))])
    listing, inputs = list(instructions(f)), ca.vertsplit(values)
    for k, (op, *_) in enumerate(listing):
        if op in BINARY | UNARY:
            for way in (0, 1 + k % 3):
                yield f"instruction {k}, way {way}", run(listing, inputs, f.nnz_out(0), k, way)


def same(left, right, roots):
    """Return what `prove_equal` decides; without its rational counterexample, where roots are."""
    if not roots:
        return bool(prove_equal(left, right))
    (one,), (other,) = normal_form(ca.vertcat(left, right), roots)
    return one == other


def rejected(left, mutants, roots=None, inputs=None, point=None):
    """Return how many mutants the prover rejects: all that differ in floating point, no other."""
    symbols = ca.vertcat(*ca.symvar(left)) if inputs is None else inputs
    point = np.random.default_rng(3).uniform(0.5, 2, symbols.numel()) if point is None else point
    size = np.array(ca.Function("f", [symbols], [left])(point)).ravel()
    count = 0
    for name, mutant in mutants:
        value = ca.Function("f", [symbols], [mutant])(point)
        apart = np.abs(np.array(value).ravel() - size)
        apart[~np.isfinite(apart)] = np.inf
        i = int(np.argmax(apart))
        if apart[i] > 1e-9 * max(1, abs(size[i])):
            assert not same(left[i], mutant[i], roots), name
            count += 1
        else:  # the same in other words, as where one goal has a zero
            assert prove_equal(left, mutant, roots), f"undecided mutant: {name}"
    return count


def named_mutants(loop):
    """Yield the closed form with one thing in it wrong that a hand would get wrong."""
    e, motion, doubt, d = loop.errors, loop.motion, loop.doubt, loop.design

    def say(name, errors=e, moves=motion, doubts=doubt, design=d):
        return name, error_rates(errors, moves, doubts, design)

    for name in Doubt.sizes():
        own = getattr(doubt, name)
        neutral = getattr(Doubt.none(), name)
        for how, other in {"dropped": neutral, "negated": -own, "doubled": 2 * own}.items():
            yield say(f"{name} {how}", doubts=replace(doubt, **{name: other}))
    yield say("ς and χ swapped", doubts=swapped(doubt, "thrust_gain", "lever_ratio"))
    yield say("n and b swapped", doubts=swapped(doubt, "feature", "force"))
    yield say("γ and G swapped", doubts=swapped(doubt, "angular_gain", "gyroscopic"))
    for name in ("thrust_gain", "lever_ratio"):
        yield say(f"1/{name}", doubts=replace(doubt, **{name: 1 / getattr(doubt, name)}))
    for name in ("angular_gain", "gyroscopic"):
        turned = ca.vec(ca.reshape(getattr(doubt, name), 2, 2).T)
        yield say(f"{name} transposed", doubts=replace(doubt, **{name: turned}))
    for name in Motion.sizes():
        own = getattr(motion, name)
        for how, other in {"dropped": 0 * own, "negated": -own, "doubled": 2 * own}.items():
            yield say(f"{name} {how}", moves=replace(motion, **{name: other}))
    yield say("h inverted", moves=replace(motion, quickness=1 / motion.quickness))
    yield say("p1 and p2 swapped", moves=swapped(motion, "sinking", "sinking_by_error"))
    yield say("no yaw", moves=replace(motion, rate=ca.vertcat(motion.rate[:2], 0)))
    yield say("yaw alone", moves=replace(motion, rate=motion.rate * E3))
    for one, two in (("d1", "d2"), ("d2", "d3"), ("d1", "d3")):
        yield say(f"{one} and {two} swapped", replace(e, **{one: getattr(e, two)}))
    yield say("δ4 for ζ", replace(e, d4=e.d4 + e.d3[:2]))
    for one, two in (("k1", "k2"), ("k2", "k3"), ("k3", "k4"), ("mass", "k1")):
        yield say(f"{one} for {two}", design=replace(d, **{one: getattr(d, two)}))
    yield say("β for κ", design=beta_for_kappa(d))


def swapped(record, one, two):
    return replace(record, **{one: getattr(record, two), two: getattr(record, one)})


def beta_for_kappa(d):
    """Return a design with (k1 k2 + k3)/m = β of the right one, and the same k1 k2, m and k4."""
    return replace(d, k3=d.mass / (d.stiffness * kappa(d)) - d.k1 * d.k2)


def own_form():
    """Return the closed form over symbols of its own, and these."""
    parts = [layout.symbols() for layout in (Errors, Motion, Doubt, Design)]
    return ca.vertcat(*(part.vector() for part in parts)), error_rates(*parts)


@pytest.mark.slow
def test_the_prover_rejects_every_named_mutant_of_the_uncertain_dynamics(whole):
    """All of one law, a third of two others, and with `make trials` all."""
    for every, law in zip((1, 3, 3), (*MEASURED.values(), MODELLED), strict=True):
        loop = derive_uncertain_loop(law)
        mutants = share_of(named_mutants(loop), whole, every=every)
        assert rejected(loop.rate, mutants) >= (40 if whole else 40 // every), law.name


@pytest.mark.slow
def test_the_prover_rejects_every_wrong_operation_in_the_uncertain_dynamics(record_property, whole):
    """One of five, and with `make trials` all."""
    loop = derive_uncertain_loop(MEASURED["image"])
    values = [part.vector() for part in (loop.errors, loop.motion, loop.doubt, loop.design)]
    mutants = graph_mutants(*own_form(), ca.vertcat(*values))
    count = rejected(loop.rate, share_of(mutants, whole, every=10))
    record_property("mutants", count)
    assert count >= (200 if whole else 20)


def test_the_prover_rejects_every_wrong_operation_in_the_slope_of_the_scaled_feature():
    f = Scaled()
    names = ca.vertcat(f.a, f.phi, f.n, f.q)
    mutants = graph_mutants(names, f.slope(f.a, f.phi, f.q), names)

    q, n = np.array([0.7, -0.4, 3.1]), 4.0
    a = np.linalg.norm(q)
    point = np.r_[a, 1 / np.sqrt(2 * (1 - a / n)), n, q]
    left = ca.vec(ca.jacobian(f.s, f.q))
    assert rejected(left, mutants, f.roots, names, point) >= 50
