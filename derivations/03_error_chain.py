# %% [markdown]
# # 3. The error chain
#
# The vehicle should move so that the image centroid $q$ comes to a wanted value $q^*$ and stays
# there. The force reaches $q$ through two integrators, and it is turned into place through two
# more. Backstepping takes them one after the other: at each step, the next quantity is given a
# wanted value, and the difference from it is the next error. This part builds $\delta_1$,
# $\delta_2$ and $\delta_3$ and shows how they move.
#
# Each `assert` below is an exact proof for all values of all symbols. The errors and the motion
# come from the package; only the claimed closed form is typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY as LAW
from hoverproof.servo.variables import Design, Measurement

# %% [markdown]
# ## What is given
#
# Measured, all in body axes (third axis down in level flight):
#
# | symbol | meaning | motion | unit |
# | --- | --- | --- | --- |
# | $q$ | centroid, sum of the unit vectors to the target | $\dot q = -\Omega\times q - y$ | 1 |
# | $V$ | velocity | $\dot V = -\Omega\times V + F/m$ | m/s |
# | $\rho$ | direction of gravity | $\dot\rho = -\Omega\times\rho$ | 1 |
# | $\Omega$ | angular velocity | $\dot\Omega = \alpha$, set by the torque | rad/s |
# | $T$ | thrust | $\dot T = U$, set by the controller | N |
#
# The force is $F = -T e_3 + m g\rho$ in N. The *depth flow* is $y = Q V$ in 1/s, where
# $Q = Q^\top > 0$ in 1/m holds the unknown distances of the target points.
#
# Chosen, besides the mass $m$ in kg and gravity $g$ in m/s²: the goal $q^*$ and the gains $k_1$
# in kg m/s, $k_2$ in 1/m, $k_3$ in kg/s. A short name for a force that will occur often:
#
# $$c = \frac{k_1^2 k_2}{m}\quad\text{in N.}$$
#
# Here $e_3 = (0, 0, 1)^\top$, and $\mathrm{sk}(a)$ is the matrix with
# $\mathrm{sk}(a)\,b = a\times b$.

# %%
z, design = Measurement.symbols(), Design.symbols()
q, V, rho, Omega, T = z.centroid, z.velocity, z.gravity_direction, z.rate, z.thrust
m, g, goal = design.mass, design.gravity, design.goal_centroid
k1, k2 = design.k1, design.k2
alpha, U, y = ca.SX.sym("alpha", 3), ca.SX.sym("U"), ca.SX.sym("y", 3)

F = rigid_body.force(T, rho, m, g)
flow = LAW.measured_rate(z, design, angular_acceleration=alpha, thrust_rate=U, depth_flow=y)
closed = ca.vertcat(
    -ca.cross(Omega, q) - y, -ca.cross(Omega, V) + F / m, -ca.cross(Omega, rho), alpha, U
)
assert prove_equal(F, -T * E3 + m * g * rho)
assert prove_equal(flow, closed)
assert prove_equal(design.stiffness, k1**2 * k2 / m)
print("the motion of the measurements is the table above: proved")

# %% [markdown]
# ## Three errors, all without unit
#
# $$\delta_1 = q - q^*, \qquad \delta_2 = \frac{m}{k_1}V - \delta_1, \qquad
# \delta_3 = \frac1c F + \delta_2 .$$
#
# So $V = \frac{k_1}{m}\delta_1$ is the velocity that is wanted in order to reduce $\delta_1$, and
# $F = -c\,\delta_2$ is the force that is wanted in order to reduce $\delta_2$.

# %%
e = LAW.errors(z, design)
d1, d2, d3 = e.d1, e.d2, e.d3
c = design.stiffness

assert prove_equal(d1, q - goal)
assert prove_equal(d2, m / k1 * V - d1)
assert prove_equal(d3, F / c + d2)
print("δ1, δ2, δ3 as defined: proved")

# %% [markdown]
# Read backwards, velocity and force are differences and sums of errors:
#
# $$V = \frac{k_1}{m}(\delta_1 + \delta_2), \qquad F = c\,(\delta_3 - \delta_2) .$$

# %%
assert prove_equal(V, k1 / m * (d1 + d2))
assert prove_equal(F, c * (d3 - d2))
print("V and F in terms of the errors: proved")

# %% [markdown]
# ## Step 1: the image error
#
# $$\dot\delta_1 = -\mathrm{sk}(\Omega)\,\delta_1 - y + \mathrm{sk}(q^*)\,\Omega .$$
#
# The goal is fixed in the image and not in the world, so turning the camera alone already makes
# an error: that is the last term. Feedback of this kind cannot remove it, since $\Omega$ is busy
# tilting the thrust. It is left alone here and will have to be dominated in the end.

# %%
d1_dot, d2_dot, d3_dot = (lie_derivative(d, z.vector(), flow) for d in (d1, d2, d3))
turn = skew(goal) @ Omega

assert prove_equal(d1_dot, -skew(Omega) @ d1 - y + turn)
print("δ1' with the depth flow y: proved")

# %% [markdown]
# Put in $y = Q V$ for a symmetric $Q$ of six symbols, and $V = \frac{k_1}{m}(\delta_1+\delta_2)$.
# The rotation drops out of the square:
#
# $$\frac{d}{dt}\,\tfrac12|\delta_1|^2 = -\frac{k_1}{m}\,\delta_1^\top Q\,\delta_1
# -\frac{k_1}{m}\,\delta_1^\top Q\,\delta_2 + \delta_1^\top\mathrm{sk}(q^*)\,\Omega .$$
#
# For every $Q > 0$, known or not, the first term is negative. That is why no depth is needed.

# %%
Q = ca.tril2symm(ca.SX.sym("Q", ca.Sparsity.lower(3)))


def dot(expression):
    """Return the derivative in time, with y = QV."""
    return ca.substitute(lie_derivative(expression, z.vector(), flow), y, Q @ V)


def half_square(d):
    """Return half the squared length."""
    return ca.sumsqr(d) / 2


closed = -k1 / m * (d1.T @ Q @ d1 + d1.T @ Q @ d2) + d1.T @ turn
assert prove_equal(dot(half_square(d1)), closed)
print("derivative of ½|δ1|²: proved")

# %% [markdown]
# ## Step 2: the velocity error
#
# $$\dot\delta_2 = -\mathrm{sk}(\Omega)\,\delta_2 + y - \frac{k_1k_2}{m}(\delta_2 - \delta_3)
# - \mathrm{sk}(q^*)\,\Omega .$$

# %%
k12 = k1 * k2
assert prove_equal(d2_dot, -skew(Omega) @ d2 + y - k12 / m * (d2 - d3) - turn)
print("δ2' with the depth flow y: proved")

# %% [markdown]
# In the sum of both squares the terms with $\delta_1^\top Q\,\delta_2$ cancel:
#
# $$\frac{d}{dt}\Big(\tfrac12|\delta_1|^2 + \tfrac12|\delta_2|^2\Big)
# = -\frac{k_1}{m}\,\delta_1^\top Q\,\delta_1 - \frac{k_1}{m}\,\delta_2^\top(k_2 I - Q)\,\delta_2
# + \frac{k_1k_2}{m}\,\delta_2^\top\delta_3 + (\delta_1-\delta_2)^\top\mathrm{sk}(q^*)\,\Omega .$$
#
# Here is the first condition: $k_2$ has to be above the largest eigenvalue of $Q$.

# %%
identity = ca.SX.eye(3)
closed = (
    -k1 / m * (d1.T @ Q @ d1 + d2.T @ (k2 * identity - Q) @ d2)
    + k12 / m * d2.T @ d3
    + (d1 - d2).T @ turn
)
assert prove_equal(dot(half_square(d1) + half_square(d2)), closed)
print("derivative of ½|δ1|² + ½|δ2|²: proved")

# %% [markdown]
# ## Step 3: the force error
#
# The force turns with the body and changes with the thrust,
# $\dot F = -\Omega\times F - U e_3 + T\,\mathrm{sk}(e_3)\,\Omega$. Together with $\dot\delta_2$:
#
# $$\dot\delta_3 = -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}(\delta_2-\delta_3)
# + \frac1c\Big(\mathrm{sk}(T e_3 - c\,q^*)\,\Omega - U e_3\Big) .$$
#
# The inputs have appeared: $U$ changes the third component, $\Omega$ the other two. The
# disturbance $-\mathrm{sk}(q^*)\,\Omega$ is now in the same bracket as the lever
# $T\,\mathrm{sk}(e_3)\,\Omega$, so in this equation it can be dealt with exactly.

# %%
lever = skew(T * E3 - c * goal) @ Omega
closed = -skew(Omega) @ d3 + y - k12 / m * (d2 - d3) + (lever - U * E3) / c
assert prove_equal(d3_dot, closed)
print("δ3' with the depth flow y: proved")

# %% [markdown]
# ## Where the depths are
#
# The flow $y$ enters the three rates with the constant matrices $-I$, $I$ and $I$, and nowhere
# else. It is multiplied by no input and by no measured quantity. That is what will let the
# controller be solved for without it.

# %%
slopes = ca.jacobian(ca.vertcat(d1_dot, d2_dot, d3_dot), y)
assert prove_equal(slopes, ca.vertcat(-identity, identity, identity))
print("∂(δ1', δ2', δ3')/∂y = (-I, I, I): proved")

# %% [markdown]
# ## What to remember
#
# With $v = \delta_1 + \delta_2$ and $y = \frac{k_1}{m} Q v$,
#
# $$\begin{aligned}
# m\,\dot\delta_1 &= -m\,\mathrm{sk}(\Omega)\,\delta_1 - k_1 Q v + m\,\mathrm{sk}(q^*)\,\Omega,\\
# m\,\dot\delta_2 &= -m\,\mathrm{sk}(\Omega)\,\delta_2 + k_1 Q v - k_1k_2(\delta_2-\delta_3)
#   - m\,\mathrm{sk}(q^*)\,\Omega,\\
# m\,\dot\delta_3 &= -m\,\mathrm{sk}(\Omega)\,\delta_3 + k_1 Q v - k_1k_2(\delta_2-\delta_3)
#   + \frac mc\Big(\mathrm{sk}(T e_3 - c\,q^*)\,\Omega - U e_3\Big).
# \end{aligned}$$

# %%
Qv = k1 * Q @ (d1 + d2)
closed = ca.vertcat(
    -m * skew(Omega) @ d1 - Qv + m * turn,
    -m * skew(Omega) @ d2 + Qv - k12 * (d2 - d3) - m * turn,
    -m * skew(Omega) @ d3 + Qv - k12 * (d2 - d3) + m / c * (lever - U * E3),
)
assert prove_equal(m * dot(ca.vertcat(d1, d2, d3)), closed)
print("m δ1', m δ2', m δ3' with Q: proved")
