# %% [markdown]
# # 4. Force and rate errors
#
# Three errors lead from the image to the force. The force obeys the thrust only along the body
# axis $e_3$; its other two components must be turned into place. The fourth error, $\delta_4$, is
# about how fast the body turns. This part defines it, differentiates it, and shows what a yaw
# rate $\Omega_3 \neq 0$ would spoil.
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
from hoverproof.servo.lyapunov import thrust_factor
from hoverproof.servo.variables import Design, Measurement

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $q$, $q^*$ | image centroid, and the wanted one, in body axes | 1 |
# | $V$, $\Omega$ | velocity and angular velocity, in body axes | m/s, rad/s |
# | $\rho$ | direction of gravity, in body axes | 1 |
# | $T$, $U = \dot T$ | thrust and its rate | N, N/s |
# | $\alpha = \dot\Omega$ | angular acceleration, set by the torque | rad/s² |
# | $F = -Te_3 + mg\rho$ | force, with mass $m$ and gravity $g$ | N |
# | $Q = Q^\top$, $y = QV$ | matrix of the unknown depths, depth flow | 1/m, 1/s |
# | $k_1, k_2, k_3$ | gains | kg m/s, 1/m, kg/s |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
#
# Here $e_3 = (0, 0, 1)^\top$, and $\mathrm{sk}(a)$ is the matrix with
# $\mathrm{sk}(a)\,b = a\times b$. The errors so far, without unit:
#
# $$\delta_1 = q - q^*,\qquad \delta_2 = \frac{m}{k_1}V - \delta_1,\qquad
# \delta_3 = \frac1c F + \delta_2 .$$

# %%
z, design = Measurement.symbols(), Design.symbols()
V, rho, Omega, T = z.velocity, z.gravity_direction, z.rate, z.thrust
m, goal, c = design.mass, design.goal_centroid, design.stiffness
k1, k2, k3 = design.k1, design.k2, design.k3
k12 = k1 * k2
alpha, U, y = ca.SX.sym("alpha", 3), ca.SX.sym("U"), ca.SX.sym("y", 3)

e = LAW.errors(z, design)
d1, d2, d3 = e.d1, e.d2, e.d3
flow = LAW.measured_rate(z, design, angular_acceleration=alpha, thrust_rate=U, depth_flow=y)
d3_dot, d4_dot = (lie_derivative(d, z.vector(), flow) for d in (e.d3, e.d4))

F = rigid_body.force(T, rho, m, design.gravity)
assert prove_equal(c, k1**2 * k2 / m)
assert prove_equal(d1, z.centroid - goal)
assert prove_equal(d2, m / k1 * V - d1)
assert prove_equal(d3, F / c + d2)
print("δ1, δ2, δ3 as defined: proved")

# %% [markdown]
# ## What the inputs should do
#
# The force error moves as
#
# $$\dot\delta_3 = -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}(\delta_2 - \delta_3)
# + \frac1c\Big(\mathrm{sk}(T e_3 - c\,q^*)\,\Omega - U e_3\Big) .$$
#
# The bracket is ours to choose. If it were $-c\,\frac{k_1k_2 + k_3}{m}\,\delta_3$, the last two
# terms would be $-\frac{k_1k_2}{m}\delta_2 - \frac{k_3}{m}\delta_3$: damping by $k_3$, and a term
# that cancels $\frac{k_1k_2}{m}\delta_2^\top\delta_3$ in the derivative of $\frac12|\delta_2|^2$.

# %%
bracket = skew(T * E3 - c * goal) @ Omega - U * E3
assert prove_equal(d3_dot, -skew(Omega) @ d3 + y - k12 / m * (d2 - d3) + bracket / c)

wish = ca.SX.sym("wish", 3)
rest = -k12 / m * (d2 - d3) + wish / c
wanted = -c * (k12 + k3) / m * d3
assert prove_equal(ca.substitute(rest, wish, wanted), -k12 / m * d2 - k3 / m * d3)
print("δ3', and what it becomes if the bracket does as wanted: proved")

# %% [markdown]
# The third component of the bracket holds $-U$, so it can be set at once. The first two hold only
# $\Omega$, which cannot jump. What they miss is the new error, without unit:
#
# $$\delta_4 = \beta\,\pi\,\mathrm{sk}(T e_3 - c\,q^*)\,\Omega + \pi\,\delta_3,\qquad
# \beta = \frac{m}{c\,(k_1k_2+k_3)} = \frac{m^2}{k_1^2k_2\,(k_1k_2+k_3)} .$$
#
# It has no third component: two numbers, written as a vector with a zero when added to others.

# %%
beta = m**2 / (k1**2 * k2 * (k12 + k3))
d4 = ca.vertcat(e.d4, 0)
pi = ca.SX.eye(3) - E3 @ E3.T

assert prove_equal(beta, m / (c * (k12 + k3)))
assert prove_equal(d4, beta * pi @ skew(T * E3 - c * goal) @ Omega + pi @ d3)
print("δ4 as defined: proved")

# %% [markdown]
# ## The force error again
#
# With $\delta_4$ in place of the first two components of the bracket:
#
# $$\dot\delta_3 = -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}\delta_2
# - \frac{k_3}{m}\delta_3 + \frac{k_1k_2+k_3}{m}\delta_4
# + e_3\Big(\frac{k_1k_2+k_3}{m}\,e_3^\top\delta_3 - e_3^\top\mathrm{sk}(q^*)\,\Omega
# - \frac Uc\Big) .$$
#
# The last bracket is one number, and $U$ is free to make it zero.

# %%
third = (k12 + k3) / m * d3[2] - (skew(goal) @ Omega)[2] - U / c
d3_closed = -skew(Omega) @ d3 + y - k12 / m * d2 - k3 / m * d3 + (k12 + k3) / m * d4 + E3 * third
assert prove_equal(d3_dot, d3_closed)
print("δ3' with δ4: proved")

# %% [markdown]
# ## The rate error
#
# $$\dot\delta_4 = \beta\,\pi\Big(U\,\mathrm{sk}(e_3)\,\Omega
# + \mathrm{sk}(T e_3 - c\,q^*)\,\dot\Omega\Big) + \pi\,\dot\delta_3 .$$
#
# Here is $\dot\Omega$, hence the torque, and the chain ends. The depth flow comes in through
# $\pi\dot\delta_3$ only, again with a constant matrix: $\partial\dot\delta_4/\partial y = \pi$.

# %%
lever = skew(T * E3 - c * goal)
d4_closed = beta * pi @ (U * skew(E3) @ Omega + lever @ alpha) + pi @ d3_closed
assert prove_equal(ca.vertcat(e.d4, 0), pi @ (beta * lever @ Omega + d3))
assert prove_equal(ca.vertcat(d4_dot, 0), d4_closed)
assert prove_equal(ca.jacobian(d4_dot, y), pi[:2, :])
print("δ4' and ∂δ4'/∂y = π: proved")

# %% [markdown]
# ## What the lever does, and where $\Omega_3 = 0$ is needed
#
# Everything so far holds for any $\Omega$. Split it into roll and pitch, $\pi\Omega$, and yaw,
# $\Omega_3$. The lever is a quarter turn about $e_3$ with a factor, plus a part that comes from
# yaw:
#
# $$\pi\,\mathrm{sk}(T e_3 - c\,q^*)\,\Omega
# = (T - c\,q_3^*)\,\mathrm{sk}(e_3)\,\pi\Omega + c\,\Omega_3\,\mathrm{sk}(e_3)\,q^* .$$

# %%
quarter = skew(E3)
closed = (T - c * goal[2]) * quarter @ pi @ Omega + c * Omega[2] * quarter @ goal
assert prove_equal(pi @ lever @ Omega, closed)
print("the lever, in roll and pitch, and in yaw: proved")

# %% [markdown]
# Where $T \neq c\,q_3^*$ this can be solved for $\pi\Omega$. With
#
# $$f(T) = \frac{k_1k_2\,(k_1k_2+k_3)}{m\,(T - c\,q_3^*)}\quad\text{in 1/m,}$$
#
# the rates of roll and pitch are a function of the errors and, unless $q^*$ is along $e_3$, of
# the yaw rate:
#
# $$\pi\Omega = -\frac{k_1}{m}f(T)\,\mathrm{sk}(e_3)\,(\delta_4 - \delta_3)
# - \frac{c\,\Omega_3}{T - c\,q_3^*}\,\pi\,q^* .$$

# %%
f = thrust_factor(T, design)
assert prove_equal(f, k12 * (k12 + k3) / (m * (T - c * goal[2])))

from_errors = -k1 / m * f * quarter @ (d4 - d3)
from_yaw = -c * Omega[2] / (T - c * goal[2]) * pi @ goal
assert prove_equal(pi @ Omega, from_errors + from_yaw)
print("πΩ in terms of the errors and of Ω3: proved")

# %% [markdown]
# The errors tell roll and pitch, but they do not tell yaw: $\Omega_3$ is a quantity of its own,
# which no error measures. It is held at zero by the third component of the torque, and from here
# on $\Omega_3 = 0$ is an *assumption about the motion*. It does no harm elsewhere. It is needed
# when the disturbance $\mathrm{sk}(q^*)\,\Omega$ in $\dot\delta_1$ and $\dot\delta_2$ is to be
# written in terms of the errors:
#
# $$\Omega_3 = 0:\qquad m\,\mathrm{sk}(q^*)\,\Omega = k_1 f(T)\,A\,(\delta_4-\delta_3),\qquad
# A = q_3^*\,I - e_3\,{q^*}^\top = -\mathrm{sk}(q^*)\,\mathrm{sk}(e_3) .$$

# %%
A = goal[2] * ca.SX.eye(3) - E3 @ goal.T
assert prove_equal(A, -skew(goal) @ skew(E3))

no_yaw = ca.vertcat(Omega[:2], 0)
disturbance = m * skew(goal) @ Omega
in_errors = k1 * f * A @ (d4 - d3)
assert prove_equal(
    ca.substitute(disturbance, Omega, no_yaw), ca.substitute(in_errors, Omega, no_yaw)
)
print("m sk(q*)Ω = k1 f A(δ4 - δ3) while Ω3 = 0: proved")

# %% [markdown]
# With a yaw rate a term remains, which vanishes for a goal straight below, $q^* \parallel e_3$:
#
# $$m\,\mathrm{sk}(q^*)\,\Omega = k_1 f(T)\,A\,(\delta_4-\delta_3)
# - \frac{m\,T\,\Omega_3}{T - c\,q_3^*}\,\mathrm{sk}(e_3)\,q^* .$$

# %%
left_over = -m * T * Omega[2] / (T - c * goal[2]) * quarter @ goal
assert prove_equal(disturbance, in_errors + left_over)
print("the same with any Ω3: proved")

# %% [markdown]
# ## What to remember
#
# The errors $\delta_1, \delta_2, \delta_3 \in \mathbb R^3$ and $\delta_4 \in \mathbb R^2$ form
# the vector $X \in \mathbb R^{11}$. $U$ and $\dot\Omega$ stand in $\dot\delta_3$ and
# $\dot\delta_4$ and are free to be chosen, as long as $T \neq c\,q_3^*$. Depths are in all four
# rates, but with constant factors.
