# %% [markdown]
# # 11. A goal that is fixed to the vertical
#
# The goal of the paper is fixed in the image: when the vehicle leans, it moves along with the
# camera, and $\delta_1$ feels every turn. If the direction of gravity is measured anyway, the goal
# can be fixed to it. This part shows what falls away then: the turn in $\dot\delta_1$, the
# singularity at $T = c\,q_3^*$, and every thrust in $\Sigma$.
#
# Each `assert` below is an exact proof for all values of all symbols. The errors, the motion and
# the controller come from the package; only the claimed closed forms are typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY as IMAGE
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.lyapunov import derive_error_dynamics, derive_lyapunov_form

LAW = LAWS["centroid", "inertial", "modelled"]

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $q$, $q_3^*$ | image centroid, in body axes, and its wanted length along the vertical | 1 |
# | $V$, $\Omega$ | velocity and angular velocity, in body axes | m/s, rad/s |
# | $\rho = R^\top e_3$ | direction of gravity, in body axes; $R$ maps body to world | 1 |
# | $T$, $U = \dot T$ | thrust and its rate | N, N/s |
# | $F = -Te_3 + mg\rho$ | force, with mass $m$ and gravity $g$ | N |
# | $J$ | moments of inertia | kg m² |
# | $Q = Q^\top$, $y = QV$ | matrix of the unknown depths, depth flow | 1/m, 1/s |
# | $k_1, k_2, k_3, k_4, k_\psi$ | gains | kg m/s, 1/m, kg/s, kg/s, kg m²/s |
# | $c = k_1^2k_2/m$, $\kappa = (k_1k_2+k_3)/m$, $\beta = 1/(c\kappa)$ | | N, 1/s, s/N |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
#
# The errors, without unit:
#
# $$\delta_1 = q - q_3^*\,\rho,\quad \delta_2 = \frac m{k_1}V - \delta_1,\quad
# \delta_3 = \frac1cF + \delta_2,\quad
# \delta_4 = \beta\,T\,\mathrm{sk}(e_3)\,\Omega + \pi\delta_3 .$$

# %%
z, design = LAW.measurement.symbols(), LAW.design.symbols()
q, V, rho, Omega, T = z.centroid, z.velocity, z.gravity_direction, z.rate, z.thrust
m, c, q3 = design.mass, design.stiffness, design.goal_centroid[2]
k1, k2, k3, k4 = design.k1, design.k2, design.k3, design.k4
k12, kappa = k1 * k2, (k1 * k2 + k3) / m
beta = 1 / (c * kappa)
pi, quarter = ca.SX.eye(3) - E3 @ E3.T, skew(E3)
alpha, U, y = ca.SX.sym("alpha", 3), ca.SX.sym("U"), ca.SX.sym("y", 3)

e = LAW.errors(z, design)
d1, d2, d3, d4 = e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)
F = rigid_body.force(T, rho, m, design.gravity)
assert prove_equal(d1, q - q3 * rho)
assert prove_equal(d2, m / k1 * V - d1)
assert prove_equal(d3, F / c + d2)
assert prove_equal(d4, beta * T * quarter @ Omega + pi @ d3)
print("δ1, δ2, δ3, δ4 as defined: proved")

# %% [markdown]
# ## The hover does not depend on the tilt
#
# In world axes $\delta_1$ is $Rq - q_3^*e_3$, and $Rq$ is what a level camera sees at the same
# place. So $\delta_1 = 0$ is a statement about the position alone. A vehicle that has to lean
# against the wind hovers where one hovers that does not. With the goal in the image it is
# displaced:
#
# $$q - q_3^*e_3 = \delta_1 + q_3^*(\rho - e_3) .$$

# %%
R, level = ca.SX.sym("R", 3, 3), ca.SX.sym("q_level", 3)
leaning = ca.substitute(d1, ca.vertcat(q, rho), ca.vertcat(R.T @ level, R.T @ E3))
assert prove_equal(leaning, R.T @ (level - q3 * E3))
in_image = ca.substitute(IMAGE.errors(z, design).d1, design.goal_centroid[:2], ca.SX.zeros(2))
assert prove_equal(in_image, d1 + q3 * (rho - E3))
print("δ1 = Rᵀ(what a level camera sees - q3* e3): proved")

# %% [markdown]
# ## No turn is left
#
# $\rho$ turns as $q$ does, so their difference feels no turn but its own:
#
# $$\begin{aligned}
# \dot\delta_1 &= -\mathrm{sk}(\Omega)\,\delta_1 - y,\\
# \dot\delta_2 &= -\mathrm{sk}(\Omega)\,\delta_2 + y - \frac{k_1k_2}{m}(\delta_2-\delta_3),\\
# \dot\delta_3 &= -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}(\delta_2-\delta_3)
#   + \frac1c\big(T\,\mathrm{sk}(e_3)\,\Omega - Ue_3\big) .
# \end{aligned}$$
#
# The lever is $D = T$ in place of $T - c\,q_3^*$.

# %%
flow = LAW.measured_rate(z, design, angular_acceleration=alpha, thrust_rate=U, depth_flow=y)
d1_dot, d2_dot, d3_dot, d4_dot = (lie_derivative(d, z.vector(), flow) for d in (d1, d2, d3, d4))
pull = -k12 / m * (d2 - d3)
assert prove_equal(d1_dot, -skew(Omega) @ d1 - y)
assert prove_equal(d2_dot, -skew(Omega) @ d2 + y + pull)
assert prove_equal(d3_dot, -skew(Omega) @ d3 + y + pull + (T * quarter @ Omega - U * E3) / c)
assert prove_equal(LAW.lever(T, design), T)
print("δ1', δ2', δ3' with the depth flow y: proved")

# %% [markdown]
# ## The controller
#
# The wish is that of part 5. No depth is in the equations; in the second, $\alpha_1$ and $\alpha_2$
# have a matrix with the determinant $\beta^2T^2$. So the controller exists while $T \ne 0$:
#
# $$U = c\,\kappa\,e_3^\top\delta_3,\qquad
# \dot\Omega = -\frac{\mathrm{sk}(e_3)\,a}T - \frac{k_\psi}{J_3}\,\Omega_3e_3,$$
# $$a = \frac1\beta\Big(\mathrm{sk}(\Omega)\,\delta_3 + \frac{k_1k_2}{m}(\delta_2-\delta_3)
#   - \Big(\kappa + \frac{k_4}m\Big)\delta_4\Big) - U\,\mathrm{sk}(e_3)\,\Omega .$$

# %%
d3_wish = -skew(Omega) @ d3 + y - k12 / m * d2 - k3 / m * d3
d4_wish = pi @ y - kappa * pi @ d3 - k4 / m * d4
difference = ca.vertcat(d3_dot[2] - d3_wish[2], d4_dot[:2] - d4_wish[:2])
assert prove_zero(ca.jacobian(difference, y))
assert prove_equal(ca.det(ca.jacobian(difference[1:], alpha[:2])), (beta * T) ** 2)

law = derive_controller(LAW)
old = ca.vertcat(law.measured.vector(), law.design.vector())
new = ca.vertcat(z.vector(), design.vector())
U_law, alpha_law = ca.substitute([law.thrust_rate, law.angular_acceleration], [old], [new])
U_closed = c * kappa * d3[2]
a = (skew(Omega) @ d3 + k12 / m * (d2 - d3) - (kappa + k4 / m) * d4) / beta
a = a - U_closed * quarter @ Omega
yaw = design.k_yaw / design.inertia[2] * Omega[2]
assert prove_equal(U_law, U_closed)
assert prove_equal(alpha_law, -quarter @ a / T - yaw * E3)
print("no y in the equations, U and Ω' in closed form: proved")

# %% [markdown]
# ## The loop is closed
#
# For every $y$ and every $\Omega$, whatever the yaw does,
#
# $$\dot\delta_3 = -\mathrm{sk}(\Omega)\,\delta_3 + y - \frac{k_1k_2}{m}\delta_2
#  - \frac{k_3}{m}\delta_3 + \kappa\,\delta_4,\qquad
# \dot\delta_4 = \pi y - \kappa\,\pi\delta_3 - \frac{k_4}{m}\delta_4 .$$

# %%
inputs, solution = ca.vertcat(U, alpha[:2]), ca.vertcat(U_law, alpha_law[:2])
d3_loop, d4_loop = (ca.substitute(rate, inputs, solution) for rate in (d3_dot, d4_dot))
assert prove_equal(d3_loop, d3_wish + kappa * d4)
assert prove_equal(d4_loop, d4_wish)
print("δ3' and δ4' of the closed loop, for any yaw acceleration: proved")

# %% [markdown]
# ## No thrust in $\Sigma$
#
# With $L = \frac12\sum w_i|\delta_i|^2$, $v = \delta_1 + \delta_2$ and
# $u = w_1\delta_1 - w_2\delta_2 - w_3\delta_3 - w_4\delta_4$,
#
# $$\begin{aligned}
# -m\,\dot L = k_1\,u^\top Qv &+ w_2k_1k_2\big(|\delta_2|^2 - \delta_2^\top\delta_3\big)
#   + w_3\big(k_1k_2\,\delta_3^\top\delta_2 + k_3|\delta_3|^2
#     - m\kappa\,\delta_3^\top\delta_4\big)\\
#  &+ w_4\big(m\kappa\,\delta_4^\top\delta_3 + k_4|\delta_4|^2\big) .
# \end{aligned}$$
#
# There is no $f(T)$: one matrix inequality decides for all thrusts at once. The equations hold for
# every $\Omega_3$, so no yaw rate is assumed away either.

# %%
form = derive_lyapunov_form(derive_error_dynamics(LAW))
x, w, d = form.errors, form.weights, form.design
x1, x2, x3, x4 = x[:3], x[3:6], x[6:9], ca.vertcat(x[9:], 0)
Q = ca.tril2symm(ca.SX(ca.Sparsity.lower(3), form.Q_lower))
u = w[0] * x1 - w[1] * x2 - w[2] * x3 - pi @ (w[3] * x4)
p, K = d.k1 * d.k2, d.k1 * d.k2 + d.k3
claimed = d.k1 * u.T @ Q @ (x1 + x2) + w[1] * p * (ca.sumsqr(x2) - ca.dot(x2, x3))
claimed += w[2] * (p * ca.dot(x3, x2) + d.k3 * ca.sumsqr(x3) - K * ca.dot(x3, x4))
claimed += w[3] * (K * ca.dot(x4, x3) + d.k4 * ca.sumsqr(x4))
assert prove_equal(form.dissipation, claimed)
assert prove_zero(ca.jacobian(form.dissipation, form.f))
print("-m L' as a quadratic form, without f(T): proved")

# %% [markdown]
# ## What to remember
#
# With $\delta_1 = q - q_3^*\rho$ the goal is a place, not a view. The lever is the thrust itself,
# $f(T)$ is gone from $\Sigma$, and $\Omega_3$ may be anything. The price: an error of the measured
# vertical is an error of $\delta_1$, as one of the image is.
