# %% [markdown]
# # 5. The controller
#
# The inputs are the rate of the thrust, $U = \dot T$ in N/s, and the torque $\Gamma$ in N m. They
# are not guessed but solved for, from the rates that the errors are wanted to have. The point to
# be shown is that no depth is in the result.
#
# Each `assert` below is an exact proof for all values of all symbols. The controller comes from
# the package, which solves the equations; the closed form is typed here.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.mission.frame import X
from hoverproof.plant import rigid_body, rotors
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY as LAW

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $q$, $q^*$ | image centroid, and the wanted one, in body axes | 1 |
# | $V$, $\Omega$ | velocity and angular velocity, in body axes | m/s, rad/s |
# | $\rho$, $T$ | direction of gravity, in body axes; thrust | 1, N |
# | $J$ | moments of inertia (diagonal matrix) | kg m² |
# | $F = -Te_3 + mg\rho$ | force, with mass $m$ and gravity $g$ | N |
# | $y = QV$ | depth flow; $Q = Q^\top$ holds the unknown depths | 1/s |
# | $k_1, k_2, k_3, k_4, k_\psi$ | gains | kg m/s, 1/m, kg/s, kg/s, kg m²/s |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
# | $\beta = m^2/\big(k_1^2k_2(k_1k_2+k_3)\big)$ | factor in $\delta_4$ | s³/(kg m) |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
#
# Here $e_3 = (0, 0, 1)^\top$, and $\mathrm{sk}(a)$ is the matrix with
# $\mathrm{sk}(a)\,b = a\times b$. The errors are $\delta_1 = q - q^*$,
# $\delta_2 = \frac m{k_1}V - \delta_1$, $\delta_3 = \frac1cF + \delta_2$ and
# $\delta_4 = \beta\,\pi\,\mathrm{sk}(Te_3 - c\,q^*)\,\Omega + \pi\delta_3$.

# %%
law = derive_controller()
z, design = law.measured, law.design
V, Omega, T = z.velocity, z.rate, z.thrust
m, J, goal, c = design.mass, design.inertia, design.goal_centroid, design.stiffness
k1, k2, k3, k4 = design.k1, design.k2, design.k3, design.k4
k12 = k1 * k2
beta = m**2 / (k1**2 * k2 * (k12 + k3))
pi = ca.SX.eye(3) - E3 @ E3.T

e = LAW.errors(z, design)
d1, d2, d3, d4 = e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)
F = rigid_body.force(T, z.gravity_direction, m, design.gravity)
assert prove_equal(d1, z.centroid - goal)
assert prove_equal(d2, m / k1 * V - d1)
assert prove_equal(d3, F / c + d2)
assert prove_equal(d4, beta * pi @ skew(T * E3 - c * goal) @ Omega + pi @ d3)
print("δ1, δ2, δ3, δ4 as defined: proved")

# %% [markdown]
# ## The wish
#
# $$e_3^\top\dot\delta_3 = e_3^\top\Big(-\mathrm{sk}(\Omega)\,\delta_3 + y
#   - \frac{k_1k_2}{m}\delta_2 - \frac{k_3}{m}\delta_3\Big),$$
# $$\dot\delta_4 = \pi y - \frac{k_1k_2+k_3}{m}\,\pi\delta_3 - \frac{k_4}{m}\,\delta_4,\qquad
# \dot\Omega_3 = -\frac{k_\psi}{J_3}\,\Omega_3 .$$
#
# The first is what $\dot\delta_3$ is to be anyway, with damping by $k_3$. The second damps
# $\delta_4$ by $k_4$, undoes in $\frac12|\delta_4|^2$ the term
# $\frac{k_1k_2+k_3}{m}\,\delta_3^\top\delta_4$ that $\delta_4$ makes in $\frac12|\delta_3|^2$,
# and lets go of the rotation. The flow $y$ stands in both wishes just as it stands in the rates
# themselves. To wish it away would take a controller that knows it.
#
# ## No depth is needed
#
# With $U$ and $\alpha = \dot\Omega$ as unknowns, the difference between the rates and the wish
# does not contain $y$.

# %%
U, alpha, y = ca.SX.sym("U"), ca.SX.sym("alpha", 3), ca.SX.sym("y", 3)
flow = LAW.measured_rate(z, design, angular_acceleration=alpha, thrust_rate=U, depth_flow=y)
d3_dot, d4_dot = (lie_derivative(d, z.vector(), flow) for d in (d3, d4))

d3_wish = -skew(Omega) @ d3 + y - k12 / m * d2 - k3 / m * d3
d4_wish = pi @ y - (k12 + k3) / m * pi @ d3 - k4 / m * d4
difference = ca.vertcat(d3_dot[2] - d3_wish[2], d4_dot[:2] - d4_wish[:2])

assert prove_zero(ca.jacobian(difference, y))
print("no y in the equations for U and α: proved")

# %% [markdown]
# ## Can they be solved?
#
# The equations are linear. In the first, $U$ has the factor $-1/c$. In the second,
# $(\alpha_1, \alpha_2)$ have a matrix with the determinant $\beta^2(T - c\,q_3^*)^2$. So there is
# exactly one solution, as long as
#
# $$T \neq c\,q_3^* .$$

# %%
assert prove_equal(ca.jacobian(difference, U)[0], -1 / c)
assert prove_zero(ca.jacobian(difference[0], alpha))
slope = ca.jacobian(difference[1:], alpha[:2])
assert prove_equal(ca.det(slope), (beta * (T - c * goal[2])) ** 2)
print("slope -1/c for U, determinant β²(T - c q3*)² for α: proved")

# %% [markdown]
# ## The thrust
#
# $$U = c\,\Big(\frac{k_1k_2+k_3}{m}\,e_3^\top\delta_3 - e_3^\top\mathrm{sk}(q^*)\,\Omega\Big) .$$

# %%
U_closed = c * ((k12 + k3) / m * d3[2] - (skew(goal) @ Omega)[2])
assert prove_equal(law.thrust_rate, U_closed)
print("U in closed form: proved")

# %% [markdown]
# ## The angular acceleration
#
# A quarter turn is undone by $-\mathrm{sk}(e_3)$, as $-\mathrm{sk}(e_3)\,\mathrm{sk}(e_3) = \pi$.
# That gives
#
# $$\dot\Omega = \alpha
#   = -\frac{\mathrm{sk}(e_3)\,a}{T - c\,q_3^*} - \frac{k_\psi}{J_3}\,\Omega_3\,e_3,$$
# $$a = \frac1\beta\Big(\mathrm{sk}(\Omega)\,\delta_3 + \frac{k_1k_2}{m}(\delta_2-\delta_3)
#   - \frac{k_1k_2+k_3+k_4}{m}\,\delta_4\Big) - U\,\mathrm{sk}(e_3)\,\Omega
#   + c\,\frac{k_\psi}{J_3}\,\Omega_3\,\mathrm{sk}(e_3)\,q^* .$$
#
# The last term makes up for the yaw acceleration; it is zero for $\Omega_3 = 0$.

# %%
quarter = skew(E3)
assert prove_equal(-quarter @ quarter, pi)

yaw = design.k_yaw / J[2] * Omega[2]
a = (skew(Omega) @ d3 + k12 / m * (d2 - d3) - (k12 + k3 + k4) / m * d4) / beta
a = a - U_closed * quarter @ Omega + c * yaw * quarter @ goal
alpha_closed = -quarter @ a / (T - c * goal[2]) - yaw * E3
assert prove_equal(law.angular_acceleration, alpha_closed)
print("Ω' in closed form: proved")

# %% [markdown]
# ## The torque
#
# Euler's equation $J\dot\Omega = -\Omega\times J\Omega + \Gamma$ turns it into a torque:
#
# $$\Gamma = \mathrm{sk}(\Omega)\,J\Omega + J\,\dot\Omega, \qquad
# \Gamma_3 = e_3^\top(\Omega\times J\Omega) - k_\psi\,\Omega_3 .$$

# %%
gyroscopic = skew(Omega) @ (J * Omega)
assert prove_equal(law.torque, gyroscopic + J * alpha_closed)
assert prove_equal(law.torque[2], gyroscopic[2] - design.k_yaw * Omega[2])
print("Γ in closed form: proved")

# %% [markdown]
# So $\Omega_3 = 0$, once true, stays true: $\dot\Omega_3 = -\frac{k_\psi}{J_3}\Omega_3$.
#
# ## The loop is closed
#
# Put $U$ and $\alpha$ back. Both wishes come true for every flow $y$ and every $\Omega$, and the
# first two components of $\dot\delta_3$ are as they should be, too, but for $\delta_4$:
#
# $$\dot\delta_3 = -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}\delta_2
#  - \frac{k_3}{m}\delta_3 + \frac{k_1k_2+k_3}{m}\,\delta_4 .$$

# %%
inputs = ca.vertcat(U, alpha)
solution = ca.vertcat(law.thrust_rate, law.angular_acceleration)
d3_loop, d4_loop = (ca.substitute(rate, inputs, solution) for rate in (d3_dot, d4_dot))

assert prove_equal(d3_loop, d3_wish + (k12 + k3) / m * d4)
assert prove_equal(d4_loop, d4_wish)
print("δ3' and δ4' of the closed loop: proved")

# %% [markdown]
# ## Four rotors
#
# The rotors sit at the corners of a square, $(\pm d, \pm d, 0)$ in body axes: $x$ forward, $y$
# right, $z$ down. Each pushes along $-z$ with a thrust $t$ in N, so its torque is
# $r \times (-t\,e_3) = (-y t,\; x t,\; 0)$, and the drag of its turning adds one about $z$.
# Pushed up on the right a vehicle rolls to the left. The paper prints roll and pitch exchanged:
# its eqs. 37 and 38 fit axes to the left and to the rear, whose $z$ is up. For every $T$ and
# $\Gamma$ there is one set of four thrusts (not always positive ones: limits of the rotors are
# not part of this model).

# %%
arm, drag_ratio = ca.SX.sym("d"), ca.SX.sym("kappa")
thrusts = rotors.rotor_thrusts(X, T, law.torque, arm, drag_ratio)
assert prove_equal(rotors.wrench(X, thrusts, arm, drag_ratio), ca.vertcat(T, law.torque))
print("four rotor thrusts make T and Γ: proved")
each = ca.SX.sym("t", 4)
made = ca.jacobian(rotors.wrench(X, each, arm, drag_ratio), each)
for i, name in enumerate(X.names):
    print(f"T, Γ1, Γ2, Γ3 of 1 N of {name}: {made[:, i]}")

# %% [markdown]
# ## What to remember
#
# $U$ and $\Gamma$ are functions of $q$, $V$, $\rho$, $\Omega$, $T$ and constants. No depth and no
# position is in them. They exist while $T \neq c\,q_3^*$.
