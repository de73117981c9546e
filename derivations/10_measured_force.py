# %% [markdown]
# # 10. The force, measured
#
# So far the force was modelled: $F = -Te_3 + mg\rho$, with the thrust $T$ that is commanded. A
# vehicle that is heavier, has weaker rotors or flies in wind has another force, and comes to rest
# elsewhere. An accelerometer knows the force without a model. This part puts it into the error
# chain, and shows that nothing else changes.
#
# Each `assert` below is an exact proof for all values of all symbols. The errors, the motion and
# the controller come from the package; only the claimed closed forms are typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY as MODELLED
from hoverproof.servo.laws.hamel_mahony import LAWS

LAW = LAWS["centroid", "image", "measured"]

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $q$, $q^*$ | image centroid, and the wanted one, in body axes | 1 |
# | $V$, $\Omega$ | velocity and angular velocity, in body axes | m/s, rad/s |
# | $\rho$, $g$ | direction of gravity, in body axes, and gravity | 1, m/s² |
# | $a$ | what an accelerometer measures, in body axes | m/s² |
# | $U$, $\Gamma$ | rate of the commanded thrust, and torque | N/s, N m |
# | $m$, $J$ | mass and moments of inertia that the controller has | kg, kg m² |
# | $m_r$, $T_r$ | true mass and true thrust | kg, N |
# | $w$, $R$ | a steady force of the wind, world axes; body to world | N, 1 |
# | $y = QV$ | depth flow; $Q = Q^\top$ holds the unknown depths | 1/s |
# | $k_1, k_2, k_3, k_4, k_\psi$ | gains | kg m/s, 1/m, kg/s, kg/s, kg m²/s |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
#
# An accelerometer measures the acceleration less gravity,
#
# $$a = \dot V + \Omega\times V - g\rho ,$$
#
# and the law takes of it, without a model,
#
# $$F = m\,(a + g\rho), \qquad T = -m\,e_3^\top a .$$

# %%
z, design = LAW.measurement.symbols(), LAW.design.symbols()
V, Omega, rho, a = z.velocity, z.rate, z.gravity_direction, z.specific_force
m, g, c, goal = design.mass, design.gravity, design.stiffness, design.goal_centroid
F, T = LAW.force.force(z, design), LAW.force.thrust(z, design)
assert prove_equal(F, m * (a + g * rho))
assert prove_equal(T, -m * a[2])
print("F and T of an accelerometer: proved")

# %% [markdown]
# ## Whatever the vehicle is
#
# The true vehicle obeys $m_r(\dot V + \Omega\times V) = -T_re_3 + m_rg\rho + R^\top w$. So its
# accelerometer shows $a = (-T_re_3 + R^\top w)/m_r$, and
#
# $$\dot V = -\Omega\times V + \frac Fm$$
#
# is exact for every $m_r$, $T_r$ and $w$, though $m$ is not the true mass: the factor $m$ is in $F$
# too. A vehicle that stays where it is, $V = 0$ and $\dot V = 0$, has $F = 0$.

# %%
m_r, T_r, w, R = (
    ca.SX.sym(name, *size) for name, *size in (("m_r",), ("T_r",), ("w", 3, 1), ("R", 3, 3))
)
V_dot = -skew(Omega) @ V + (-T_r * E3 + m_r * g * rho + R.T @ w) / m_r
shown = V_dot + skew(Omega) @ V - g * rho
F_true = ca.substitute(F, a, shown)
assert prove_equal(shown, (-T_r * E3 + R.T @ w) / m_r)
assert prove_equal(V_dot, -skew(Omega) @ V + F_true / m)
print("V' = -Ω×V + F/m for any true mass, thrust and wind: proved")

# %% [markdown]
# With the modelled force the same vehicle hovers, $\dot V = 0$, where $F \ne 0$ by the model: then
# $\delta_3 \ne \delta_2$, and the errors do not go to zero. With the measured force they can.
#
# ## How the force moves
#
# What the law takes for the motion of $a$: the thrust changes at the rate $U$, and what is not
# along $e_3$ is steady in the world,
#
# $$\dot a = -\frac Um\,e_3 - \Omega\times(a - e_3e_3^\top a) .$$
#
# Then the force moves as the modelled one does, with the measured thrust as its lever:
#
# $$\dot F = -\Omega\times F - Ue_3 + T\,\mathrm{sk}(e_3)\,\Omega .$$

# %%
alpha, U, y = ca.SX.sym("alpha", 3), ca.SX.sym("U"), ca.SX.sym("y", 3)
flow = LAW.measured_rate(z, design, angular_acceleration=alpha, thrust_rate=U, depth_flow=y)
a_dot, F_dot, T_dot = (lie_derivative(of, z.vector(), flow) for of in (a, F, T))
assert prove_equal(a_dot, -U / m * E3 - skew(Omega) @ (a - E3 * a[2]))
assert prove_equal(F_dot, -skew(Omega) @ F - U * E3 + T * skew(E3) @ Omega)
print("a' and F' as the law takes them: proved")

# %% [markdown]
# The measured thrust $T = -m\,e_3^\top a$ is not quite the integral of $U$: the body turns under
# a steady sideways force,
#
# $$\dot T = U + m\,e_3^\top(\Omega\times a) .$$
#
# Without wind $a$ is along $e_3$, and the last term is zero.

# %%
assert prove_equal(T_dot, U + m * (skew(Omega) @ a)[2])
assert prove_equal(ca.substitute(T_dot, a, -T_r / m * E3), U)
print("T' of the measured thrust: proved")

# %% [markdown]
# Let the true thrust over the true mass change at $\varsigma U/m$ in place of $U/m$, and let the
# wind, a specific force $a_w$ in body axes, be steady in the world. Then the law errs by
#
# $$\dot a_{\rm true} - \dot a_{\rm law} = (1-\varsigma)\,\frac Um\,e_3
#   - e_3^\top a_w\;\Omega\times e_3 .$$
#
# Along $e_3$ that is the thrust alone. What the wind pushes along $e_3$ is taken for thrust, which
# would turn with the body: it makes the lever a little wrong. What it pushes across is understood.

# %%
gain, a_w = ca.SX.sym("gain"), ca.SX.sym("a_w", 3)
thrust = ca.SX.sym("thrust")
true_a = -thrust / m * E3 + a_w
true_flow = ca.vertcat(gain * U, -skew(Omega) @ a_w)
true_a_dot = lie_derivative(true_a, ca.vertcat(thrust, a_w), true_flow)
off = (1 - gain) * U / m * E3 - a_w[2] * skew(Omega) @ E3
assert prove_equal(true_a_dot - ca.substitute(a_dot, a, true_a), off)
print("the error of a' in steady wind: proved")

# %% [markdown]
# ## The same errors, the same wish
#
# With this $F$ and $T$ the chain of parts 3 and 4 is as it was,
#
# $$\delta_3 = \frac1c F + \delta_2,\qquad
# \delta_4 = \beta\,\pi\,\mathrm{sk}(Te_3 - c\,q^*)\,\Omega + \pi\delta_3 ,$$
#
# and so is $\dot\delta_3$. The depth flow stands where it stood, so the controller can be solved
# for without it.

# %%
e = LAW.errors(z, design)
k1, k2, k3, k4 = design.k1, design.k2, design.k3, design.k4
k12 = k1 * k2
beta = m / (c * (k12 + k3))
pi = ca.SX.eye(3) - E3 @ E3.T
lever = skew(T * E3 - c * goal)
d1, d2, d3, d4 = e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)
d3_dot, d4_dot = (lie_derivative(d, z.vector(), flow) for d in (d3, d4))
assert prove_equal(d3, F / c + d2)
assert prove_equal(d4, beta * pi @ lever @ Omega + pi @ d3)
bracket = lever @ Omega - U * E3
assert prove_equal(d3_dot, -skew(Omega) @ d3 + y - k12 / m * (d2 - d3) + bracket / c)
d3_wish = -skew(Omega) @ d3 + y - k12 / m * d2 - k3 / m * d3
d4_wish = pi @ y - (k12 + k3) / m * pi @ d3 - k4 / m * d4
difference = ca.vertcat(d3_dot[2] - d3_wish[2], d4_dot[:2] - d4_wish[:2])
assert prove_zero(ca.jacobian(difference, y))
print("δ3, δ4, δ3', and no y in the equations for U and α: proved")

# %% [markdown]
# ## The controller
#
# $$U = c\,\Big(\frac{k_1k_2+k_3}{m}\,e_3^\top\delta_3
#   - e_3^\top\mathrm{sk}(q^*)\,\Omega\Big),$$
# $$\dot\Omega = -\frac{\mathrm{sk}(e_3)\,b}{T - c\,q_3^*} - \frac{k_\psi}{J_3}\,\Omega_3\,e_3 ,$$
# $$b = \frac1\beta\Big(\mathrm{sk}(\Omega)\,\delta_3 + \frac{k_1k_2}{m}(\delta_2-\delta_3)
#   - \frac{k_1k_2+k_3+k_4}{m}\,\delta_4\Big) - \dot T\,\mathrm{sk}(e_3)\,\Omega
#   + c\,\frac{k_\psi}{J_3}\,\Omega_3\,\mathrm{sk}(e_3)\,q^* ,$$
#
# with the $\dot T$ above in the place of $U$.

# %%
law = derive_controller(LAW)
old = ca.vertcat(law.measured.vector(), law.design.vector())
new = ca.vertcat(z.vector(), design.vector())
U_law, alpha_law = ca.substitute([law.thrust_rate, law.angular_acceleration], [old], [new])
U_closed = c * ((k12 + k3) / m * d3[2] - (skew(goal) @ Omega)[2])
quarter, yaw = skew(E3), design.k_yaw / design.inertia[2] * Omega[2]
b = (skew(Omega) @ d3 + k12 / m * (d2 - d3) - (k12 + k3 + k4) / m * d4) / beta
b = b - (U_closed + m * (skew(Omega) @ a)[2]) * quarter @ Omega + c * yaw * quarter @ goal
assert prove_equal(U_law, U_closed)
assert prove_equal(alpha_law, -quarter @ b / (T - c * goal[2]) - yaw * E3)
print("U and Ω' in closed form: proved")

# %% [markdown]
# ## With the ideal vehicle it is the law of the paper
#
# If mass and thrust are as modelled and there is no wind, $a = -\frac Tm e_3$. Then both
# controllers are one and the same function of what is measured.

# %%
paper = derive_controller(MODELLED)
ideal = LAW.force.ideal(paper.measured, paper.design)
assert prove_equal(ideal.specific_force, -paper.measured.thrust / paper.design.mass * E3)
new = ca.vertcat(ideal.vector(), paper.design.vector())
ours = ca.substitute(ca.vertcat(law.thrust_rate, law.torque), old, new)
assert prove_equal(ours, ca.vertcat(paper.thrust_rate, paper.torque))
print("U and Γ are those of the modelled force: proved")

# %% [markdown]
# ## What to remember
#
# $F = m(a + g\rho)$ is what moves the vehicle, whatever its mass, thrust and wind are. Errors of
# these are inside $\delta_3$, which goes to zero; they move no equilibrium. What is left of them
# in the rates is shown in part 13.
