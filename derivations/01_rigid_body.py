# %% [markdown]
# # 1. The rigid body
#
# A vehicle with four rotors hovers above a target. It can push along one axis only, its own
# $e_3$, and it can turn. These notes go from this rigid body to a matrix $\Sigma$ whose positive
# definiteness makes the flight settle. They need no more than calculus, linear algebra and some
# idea of backstepping.
#
# Every claim in a formula is followed by a cell that proves it. The cell takes the model from the
# package, so what is typed there is only the closed form that is claimed, and `prove_equal`
# compares the two: it turns both sides into quotients of polynomials with rational coefficients,
# with every parameter a symbol. Nothing is sampled and nothing is rounded. The answer *true*
# means that both sides agree at every point where both are defined.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, RigidBodyState, skew

# %% [markdown]
# ## Frames and symbols
#
# The *world frame* has its third axis pointing **down**, so the vehicle flies at negative
# $\xi_3$. The *body frame* is fixed to the vehicle; when it hovers level, the third axis of both
# frames points down.
#
# | symbol | meaning | frame | unit |
# | --- | --- | --- | --- |
# | $\xi$ | position of the centre of mass | world | m |
# | $V$ | velocity | body | m/s |
# | $R$ | rotation that takes body coordinates to world coordinates | | 1 |
# | $\Omega$ | angular velocity | body | rad/s |
# | $T$ | thrust of all rotors together | | N |
# | $\Gamma$ | torque of the rotors | body | N m |
# | $m,\ g$ | mass, acceleration of gravity | | kg, m/s² |
# | $J = \mathrm{diag}(J_1, J_2, J_3)$ | moments of inertia | body | kg m² |
#
# Further $e_3 = (0, 0, 1)^\top$, $I$ is the identity matrix, and $\mathrm{sk}(a)$ is the matrix
# with $\mathrm{sk}(a)\,b = a \times b$. A dot is a derivative in time.

# %%
a, b = ca.SX.sym("a", 3), ca.SX.sym("b", 3)
assert prove_equal(skew(a) @ b, ca.cross(a, b))
assert prove_equal(skew(a).T, -skew(a))
print("sk(a) b = a × b, and sk(a) is antisymmetric: proved")

# %% [markdown]
# ## Rotations without sines
#
# Some proofs need $R^\top R = I$. Trigonometric functions would spoil the polynomials, so a
# rotation is written with four numbers $s = (s_0, \vec s) \ne 0$, a quaternion that need not have
# length 1:
#
# $$R(s) = \frac{(s_0^2 - |\vec s|^2)\,I + 2\,\vec s\,\vec s^\top + 2 s_0\,\mathrm{sk}(\vec s)}
# {s_0^2 + |\vec s|^2}.$$
#
# The rotation by an angle $\varphi$ about a unit vector $n$ is
# $s = (\cos\frac\varphi2,\ n\sin\frac\varphi2)$, so every rotation has this form. The other way
# round, for every $s$ the matrix is a rotation: $R^\top R = I$ and $\det R = 1$ hold identically.

# %%
s = ca.SX.sym("s", 4)
s0, sv = s[0], s[1:]
identity = ca.SX.eye(3)
R = ((s0**2 - ca.sumsqr(sv)) * identity + 2 * sv @ sv.T + 2 * s0 * skew(sv)) / ca.sumsqr(s)

assert prove_equal(R.T @ R, identity)
assert prove_equal(ca.det(R), ca.SX(1))
print("RᵀR = I and det R = 1 for every s: proved")

# %% [markdown]
# ## How the attitude turns
#
# The body turns with $\Omega$, given in its own frame:
#
# $$\dot R = R\,\mathrm{sk}(\Omega).$$
#
# This never leaves the rotations, because it is what the quaternion does when it moves by
# $\dot s_0 = -\tfrac12\,\vec s\cdot\Omega$ and
# $\dot{\vec s} = \tfrac12(s_0\,\Omega + \vec s\times\Omega)$.

# %%
body = RigidBodyState.symbols()
mass, gravity, thrust_rate = ca.SX.sym("m"), ca.SX.sym("g"), ca.SX.sym("U")
inertia, torque = ca.SX.sym("J", 3), ca.SX.sym("Gamma", 3)
motion = rigid_body.state_rate(
    body, torque=torque, thrust_rate=thrust_rate, mass=mass, inertia=inertia, gravity=gravity
)
Omega, V, T = body.rate, body.velocity, body.thrust


def dot(expression):
    """Return the derivative in time along the motion of the body."""
    return lie_derivative(expression, body.vector(), motion.vector())


def at_rotation(expression):
    """Put the rotation R(s) in place of the nine entries of the attitude matrix."""
    return ca.substitute(expression, body.rotation, R)


s_dot = ca.vertcat(-ca.dot(sv, Omega), s0 * Omega + ca.cross(sv, Omega)) / 2
assert prove_equal(dot(body.rotation), body.rotation @ skew(Omega))
assert prove_equal(lie_derivative(R, s, s_dot), R @ skew(Omega))
print("R' = R sk(Ω), in the model and for the quaternion: proved")

# %% [markdown]
# ## Which way is down
#
# Inertial sensors tell the direction of gravity in body axes, $\rho = R^\top e_3$. It is all of
# the attitude that the force needs; the heading is not in it. From
# $\dot\rho = \dot R^\top e_3 = \mathrm{sk}(\Omega)^\top R^\top e_3$:
#
# $$\dot\rho = -\Omega\times\rho.$$

# %%
rho = body.gravity_direction
assert prove_equal(rho, body.rotation.T @ E3)
assert prove_equal(dot(rho), -ca.cross(Omega, rho))
assert prove_equal(dot(rho), rigid_body.gravity_direction_rate(rho, Omega))
print("ρ' = -Ω × ρ: proved")

# %% [markdown]
# ## Force
#
# The rotors push up, against $e_3$, and gravity pulls along $\rho$. The force in body axes is
#
# $$F = -T e_3 + m g \rho, \qquad \dot V = -\Omega\times V + \tfrac1m F .$$
#
# The term $-\Omega\times V$ is there because the axes turn. In world axes it goes away, and what
# remains is Newton's law, $m\ddot\xi = m g\,e_3 - T R e_3$. This needs $R R^\top = I$.

# %%
force = rigid_body.force(T, rho, mass, gravity)
assert prove_equal(force, -T * E3 + mass * gravity * rho)
assert prove_equal(dot(V), -ca.cross(Omega, V) + force / mass)
assert prove_equal(dot(body.position), body.rotation @ V)

xi_dot_dot = dot(dot(body.position))
newton = mass * gravity * E3 - T * body.rotation @ E3
assert prove_equal(at_rotation(mass * xi_dot_dot), at_rotation(newton))
print("m ξ'' = m g e3 - T R e3: proved for every rotation R(s)")

# %% [markdown]
# The vehicle is *under-actuated*: of the three components of $F$ only the third obeys the thrust.
# The other two are $m g \rho_1$ and $m g \rho_2$. To move sideways it has to tilt. And the only
# force-free state with $T > 0$ is $\rho = e_3$, $T = m g$: level, with the thrust equal to the
# weight.

# %%
assert prove_equal(force, ca.vertcat(mass * gravity * rho[:2], mass * gravity * rho[2] - T))
hover = ca.substitute(rigid_body.force(T, E3, mass, gravity), T, mass * gravity)
assert prove_equal(hover, ca.SX.zeros(3))
print("F = (m g ρ1, m g ρ2, m g ρ3 - T), zero in level hover: proved")

# %% [markdown]
# ## Torque
#
# Euler's equation gives the turning:
#
# $$J\dot\Omega = -\Omega\times J\Omega + \Gamma .$$
#
# Two checks of the signs: the torque does the work,
# $\frac{d}{dt}\,\frac12\Omega^\top J\Omega = \Omega^\top\Gamma$, and in world axes the angular
# momentum obeys $\frac{d}{dt}(R J\Omega) = R\,\Gamma$.

# %%
spin = inertia * Omega
assert prove_equal(inertia * dot(Omega), -ca.cross(Omega, spin) + torque)
assert prove_equal(dot(ca.dot(Omega, spin) / 2), ca.dot(Omega, torque))
assert prove_equal(dot(body.rotation @ spin), body.rotation @ torque)
print("J Ω' = -Ω × JΩ + Γ, with its energy and its angular momentum: proved")

# %% [markdown]
# ## Thrust as a state
#
# The thrust is not set directly but through its rate, $\dot T = U$ in N/s. Backstepping will have
# to differentiate the force once, and then $U$ and $\dot\Omega$ appear side by side:
#
# $$\dot F = -U e_3 - m g\,\Omega\times\rho = -\Omega\times F - U e_3 + T\,e_3\times\Omega .$$

# %%
assert prove_equal(dot(T), thrust_rate)
assert prove_equal(dot(force), -thrust_rate * E3 - mass * gravity * ca.cross(Omega, rho))
in_F = -ca.cross(Omega, force) - thrust_rate * E3 + T * ca.cross(E3, Omega)
assert prove_equal(dot(force), in_F)
print("F' = -Ω × F - U e3 + T e3 × Ω: proved")

# %% [markdown]
# ## What to remember
#
# $$\dot V = -\Omega\times V + \tfrac1m F,\qquad F = -T e_3 + m g\rho,\qquad
# \dot\rho = -\Omega\times\rho,\qquad J\dot\Omega = -\Omega\times J\Omega + \Gamma,\qquad
# \dot T = U .$$
#
# Inputs are $U$ and $\Gamma$. Position and heading do not occur; they come in through the camera,
# which is next.
