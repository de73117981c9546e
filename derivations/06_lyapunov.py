# %% [markdown]
# # 6. The Lyapunov function
#
# All errors are measured by one number,
#
# $$L = \tfrac12\Big(|\delta_1|^2 + |\delta_2|^2 + |\delta_3|^2 + |\delta_4|^2\Big) .$$
#
# This part computes $\dot L$ along the closed loop, shows which terms cancel, and writes what is
# left in the errors alone.
#
# Each `assert` below is an exact proof for all values of all symbols. The closed loop comes from
# the package; only the claimed closed form is typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY as LAW
from hoverproof.servo.lyapunov import lyapunov, thrust_factor

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $q$, $q^*$ | image centroid, and the wanted one, in body axes | 1 |
# | $V$, $\Omega$ | velocity and angular velocity in body axes | m/s, rad/s |
# | $T$, $F$ | thrust; force $F = -Te_3 + mg\rho$ with $\rho$ the direction of gravity | N |
# | $Q = Q^\top$ | matrix of the unknown depths | 1/m |
# | $m$ | mass | kg |
# | $k_1, k_2, k_3, k_4$ | gains | kg m/s, 1/m, kg/s, kg/s |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
#
# Here $g$ is the acceleration of gravity in m/s², $e_3 = (0, 0, 1)^\top$, and $\mathrm{sk}(a)$ is
# the matrix with $\mathrm{sk}(a)\,b = a\times b$. With $\pi = I - e_3e_3^\top$, which drops the
# third component, the errors are
#
# $$\delta_1 = q - q^*,\quad \delta_2 = \frac m{k_1}V - \delta_1,\quad
# \delta_3 = \frac1cF + \delta_2,\quad
# \delta_4 = \frac{m}{c\,(k_1k_2+k_3)}\,\pi\,\mathrm{sk}(Te_3 - c\,q^*)\,\Omega + \pi\delta_3 .$$

# %%
law = derive_controller()
z, design = law.measured, law.design
V, Omega, T = z.velocity, z.rate, z.thrust
m, goal, c = design.mass, design.goal_centroid, design.stiffness
k1, k2, k3, k4 = design.k1, design.k2, design.k3, design.k4
k12 = k1 * k2
identity = ca.SX.eye(3)
pi = identity - E3 @ E3.T

e = LAW.errors(z, design)
d1, d2, d3, d4 = e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)
F = rigid_body.force(T, z.gravity_direction, m, design.gravity)
assert prove_equal(d1, z.centroid - goal)
assert prove_equal(d2, m / k1 * V - d1)
assert prove_equal(d3, F / c + d2)
assert prove_equal(d4, m / (c * (k12 + k3)) * pi @ skew(T * E3 - c * goal) @ Omega + pi @ d3)
print("δ1, δ2, δ3, δ4 as defined: proved")

# %% [markdown]
# ## The closed loop
#
# The controller makes the errors move as follows, with $v = \delta_1 + \delta_2 = \frac m{k_1}V$:
#
# $$\begin{aligned}
# m\,\dot\delta_1 &= -m\,\mathrm{sk}(\Omega)\,\delta_1 - k_1Qv + m\,\mathrm{sk}(q^*)\,\Omega\\
# m\,\dot\delta_2 &= -m\,\mathrm{sk}(\Omega)\,\delta_2 + k_1Qv - k_1k_2\,\delta_2 + k_1k_2\,\delta_3
#   - m\,\mathrm{sk}(q^*)\,\Omega\\
# m\,\dot\delta_3 &= -m\,\mathrm{sk}(\Omega)\,\delta_3 + k_1Qv - k_1k_2\,\delta_2 - k_3\,\delta_3
#   + (k_1k_2+k_3)\,\delta_4\\
# m\,\dot\delta_4 &= \pi k_1Qv - (k_1k_2+k_3)\,\pi\delta_3 - k_4\,\delta_4
# \end{aligned}$$

# %%
Q = ca.tril2symm(ca.SX.sym("Q", ca.Sparsity.lower(3)))
flow = LAW.measured_rate(
    z,
    design,
    angular_acceleration=law.angular_acceleration,
    thrust_rate=law.thrust_rate,
    depth_flow=Q @ V,
)


def dot(expression):
    """Return the derivative in time along the closed loop."""
    return lie_derivative(expression, z.vector(), flow)


v = d1 + d2
turn = m * skew(goal) @ Omega
spin = m * skew(Omega)
assert prove_equal(v, m / k1 * V)
assert prove_equal(m * dot(d1), -spin @ d1 - k1 * Q @ v + turn)
assert prove_equal(m * dot(d2), -spin @ d2 + k1 * Q @ v - k12 * d2 + k12 * d3 - turn)
assert prove_equal(m * dot(d3), -spin @ d3 + k1 * Q @ v - k12 * d2 - k3 * d3 + (k12 + k3) * d4)
assert prove_equal(m * dot(d4), k1 * pi @ Q @ v - (k12 + k3) * pi @ d3 - k4 * d4)
print("the closed loop in the errors: proved")

# %% [markdown]
# ## What cancels
#
# Three things happen when each line is multiplied by its error and all are added up.
#
# 1. *Rotation*: $\delta_i^\top\mathrm{sk}(\Omega)\,\delta_i = 0$ for $i = 1, 2, 3$. In
#    $\dot\delta_4$ there is none, because the controller has removed it:
#    $\pi\,\mathrm{sk}(\Omega)\,\delta_3$ would not have cancelled.
# 2. *Neighbours*: $k_1k_2\,\delta_2^\top\delta_3 - k_1k_2\,\delta_3^\top\delta_2 = 0$, and
#    $(k_1k_2+k_3)(\delta_3^\top\delta_4 - \delta_4^\top\pi\delta_3) = 0$, since
#    $\pi\delta_4 = \delta_4$.
# 3. *Depths of the first two*:
#    $-k_1\delta_1^\top Q\,\delta_2 + k_1\delta_2^\top Q\,\delta_1 = 0$, since $Q = Q^\top$.

# %%
zero = ca.SX(0)
assert prove_equal(d3.T @ skew(Omega) @ d3, zero)
assert prove_equal(d3.T @ d4 - d4.T @ pi @ d3, zero)
assert prove_equal(-d1.T @ Q @ d2 + d2.T @ Q @ d1, zero)
print("rotation, neighbours, depths of the first two: proved")

# %% [markdown]
# ## The derivative
#
# $$\begin{aligned} m\,\dot L ={}& -k_1\,\delta_1^\top Q\,\delta_1
#   - k_1\,\delta_2^\top(k_2I - Q)\,\delta_2 - k_3|\delta_3|^2 - k_4|\delta_4|^2\\
#  & + k_1(\delta_3+\delta_4)^\top Q\,(\delta_1+\delta_2)
#   + m\,(\delta_1-\delta_2)^\top\mathrm{sk}(q^*)\,\Omega . \end{aligned}$$
#
# The first line is what is wanted. In the second, $Q$ ties the fast errors $\delta_3, \delta_4$
# to the slow ones, and the goal that is fixed in the image leaves a term in $\Omega$, of either
# sign.

# %%
L = lyapunov(e, ca.SX.ones(4))
assert prove_equal(L, (ca.sumsqr(d1) + ca.sumsqr(d2) + ca.sumsqr(d3) + ca.sumsqr(d4)) / 2)

good = d1.T @ Q @ d1 * k1 + k1 * d2.T @ (k2 * identity - Q) @ d2
good = good + k3 * ca.sumsqr(d3) + k4 * ca.sumsqr(d4)
ties = k1 * (d3 + d4).T @ Q @ (d1 + d2)
assert prove_equal(m * dot(L), -good + ties + (d1 - d2).T @ turn)
print("m L' with Ω: proved, for any Ω and any symmetric Q")

# %% [markdown]
# ## Without $\Omega$
#
# The term in $\Omega$ is not a new variable. The definition of $\delta_4$ tells roll and pitch:
# with
#
# $$f = f(T) = \frac{k_1k_2\,(k_1k_2+k_3)}{m\,(T - c\,q_3^*)}\ \text{in 1/m},\qquad
# A = q_3^*\,I - e_3\,{q^*}^\top = -\mathrm{sk}(q^*)\,\mathrm{sk}(e_3),$$
#
# one has, **if $\Omega_3 = 0$**,
#
# $$\pi\Omega = -\frac{k_1}{m}\,f\,\mathrm{sk}(e_3)\,(\delta_4-\delta_3),\qquad
# m\,\mathrm{sk}(q^*)\,\Omega = k_1 f A\,(\delta_4-\delta_3) .$$
#
# In the cells, `no_yaw` makes this assumption.

# %%
f = thrust_factor(T, design)
A = goal[2] * identity - E3 @ goal.T


def no_yaw(expression):
    """Put Ω3 = 0."""
    return ca.substitute(expression, Omega, ca.vertcat(Omega[:2], 0))


assert prove_equal(f, k12 * (k12 + k3) / (m * (T - c * goal[2])))
assert prove_equal(A, -skew(goal) @ skew(E3))
assert prove_equal(no_yaw(Omega), no_yaw(-k1 / m * f * skew(E3) @ (d4 - d3)))
assert prove_equal(no_yaw(turn), no_yaw(k1 * f * A @ (d4 - d3)))
print("Ω from δ4 - δ3 while Ω3 = 0: proved")

# %% [markdown]
# So, while $\Omega_3 = 0$,
#
# $$\begin{aligned} m\,\dot L ={}& -k_1\,\delta_1^\top Q\,\delta_1
#   - k_1\,\delta_2^\top(k_2I - Q)\,\delta_2 - k_3|\delta_3|^2 - k_4|\delta_4|^2\\
#  & + k_1\,\delta_1^\top(Q - fA)\,\delta_3 + k_1\,\delta_1^\top(Q + fA)\,\delta_4\\
#  & + k_1\,\delta_2^\top(Q + fA)\,\delta_3 + k_1\,\delta_2^\top(Q - fA)\,\delta_4 . \end{aligned}$$
#
# That is a quadratic form of the errors. The motion enters its coefficients through $Q$ and
# $f(T)$ alone.

# %%
minus, plus = Q - f * A, Q + f * A
cross = d1.T @ (minus @ d3 + plus @ d4) + d2.T @ (plus @ d3 + minus @ d4)
assert prove_equal(no_yaw(m * dot(L)), no_yaw(-good + k1 * cross))
print("m L' in the errors alone, while Ω3 = 0: proved")

# %% [markdown]
# ## What a yaw rate would do
#
# For any $\Omega_3$ one more term appears:
#
# $$m\,\dot L = [\text{the same}] - \frac{m\,T\,\Omega_3}{T - c\,q_3^*}\,
# (\delta_1-\delta_2)^\top\mathrm{sk}(e_3)\,q^* .$$
#
# It can have either sign, and no error of the chain bounds $\Omega_3$. It vanishes in two cases:
# if $\Omega_3 = 0$, or if the goal is straight below, $q^*\parallel e_3$. Then the formula above
# holds for any yaw rate.

# %%
yaw = -m * T * Omega[2] / (T - c * goal[2]) * (d1 - d2).T @ skew(E3) @ goal
assert prove_equal(m * dot(L), -good + k1 * cross + yaw)
print("m L' with any Ω3: proved")

straight_below = ca.vertcat(0, 0, goal[2])
assert prove_equal(ca.substitute(yaw, goal, straight_below), zero)
print("no harm of Ω3 for a goal straight below: proved")
