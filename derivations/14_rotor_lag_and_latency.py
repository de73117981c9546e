# %% [markdown]
# # 14. The uncertain vehicle with rotor lag and a late image
#
# Part 13 has the rates of the errors of a vehicle that is not the modelled one. Here its rotors
# follow with a lag, its image is late, it measures its force, and the wind is steady. This part
# shows how that becomes one quadratic inequality, which a solver can try and a checker can decide.
# The goal is straight below.
#
# Each `assert` below is an exact proof for all values of all symbols. Motion, errors and
# controllers come from the package, which differentiates; only the claimed closed forms are typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.lagged import derive_lagged_loop
from hoverproof.servo.laws.hamel_mahony import LAWS

# %% [markdown]
# ## Rotors that lag
#
# Let $U$ be the commanded rate of the thrust and $\Gamma$ the commanded torque. Thrust and torque
# follow with one first-order lag $\tau$. With $a_\Gamma = e_3\times I^{-1}\Gamma$, of which only
# the horizontal part counts, and its lag $a_a$,
#
# $$\tau\,\dot U_a = U - U_a,\qquad \tau\,\dot a_a = a_\Gamma - a_a,\qquad
# \dot{\tilde T} = \varsigma\,U_a,\qquad
# e_3\times\dot\Omega = (I+\gamma)\,a_a - \Omega_3\,G_t\,(e_3\times\Omega) .$$
#
# A thrust that lags behind its command has a rate that lags behind $U$. $G_t$ is the gyroscopic
# coupling of the true moments of inertia; the controller's own,
#
# $$G_c = \begin{pmatrix} 0 & (I_3-I_1)/I_2\\ (I_2-I_3)/I_1 & 0\end{pmatrix},$$
#
# is in $\Gamma$: $a_\Gamma = a + \Omega_3G_c\,(e_3\times\Omega)$ of the angular acceleration
# $a = e_3\times\alpha$ that the controller asks for. So the lag delays what makes up for it, too.
#
# ## Two new errors
#
# The rotors may be steady while the command is not small: there is nothing about $a_a$ alone that
# goes to zero by itself. What does is how far the rotors are from the smooth part of the command,
# the one without jumps of the image. With $h = c\kappa/D_c$, $s_a = a_a/h$ and
#
# $$s_n = -\big(\kappa + \tfrac{k_4}m\big)\delta_4 - \tfrac{k_1k_2}m\pi(\delta_3-\delta_2):\qquad
# \mu = s_a - s_n,\qquad \mu_T = \frac{U_a}c - \kappa\,e_3^\top\delta_3 .$$

# %%
LOOPS = {law: derive_lagged_loop(law) for law in LAWS.values()}
for law, loop in LOOPS.items():
    d, e, at, body = loop.design, loop.errors, loop.setting, loop.body
    c, kappa = d.stiffness, (d.k1 * d.k2 + d.k3) / d.mass
    F = -body.thrust * E3 + d.mass * d.gravity * body.gravity_direction + loop.wind
    T_c = body.thrust - loop.wind[2]
    s3 = d.goal_centroid[2] if law.goal.name == "image" else 0
    assert prove_equal(e.d3, F / c + e.d2)
    assert prove_equal(at.quickness * (T_c - c * s3), c * kappa)
    assert prove_equal((skew(E3) @ body.rate)[:2], at.quickness * (e.d4 - e.d3[:2]))
    assert prove_equal(at.lever_ratio, 1 + loop.wind[2] / (T_c - c * s3))
    assert prove_equal(at.crosswind, (skew(body.rate) @ loop.wind)[2] / (T_c - c * s3))
print("δ3, h, e3×Ω, χ and p3 of a vehicle in the wind, for all eight laws: proved")

# %% [markdown]
# ## How errors and rotors move
#
# $n$ is the feature that is used less the present one, and $y = JV$. With
# $\zeta = \delta_4 - \pi\delta_3$, $p_1 = h\,e_3^\top\delta_3$, $k_{12} = k_1k_2/m$,
# $K_4 = \kappa + k_4/m$, and two numbers with the dimension of a rate,
#
# $$\eta = \frac{\dot D_c}{D_c} = \frac{\varsigma U_a}{D_c} + p_3,\qquad
# w = 2h\,e_3^\top(\delta_3 - n) + p_3,$$
#
# $$\begin{aligned}
# \dot\delta_1 &= -\Omega\times\delta_1 - y + s_3h\,\zeta,\\
# \dot\delta_2 &= -\Omega\times\delta_2 + y + k_{12}(\delta_3-\delta_2) - s_3h\,\zeta,\\
# \dot\delta_3 &= -\Omega\times\delta_3 + y + k_{12}(\delta_3-\delta_2) + \kappa\chi\,\zeta
#   - \varsigma\,(\kappa\,e_3^\top\delta_3+\mu_T)\,e_3,\\
# \dot\delta_4 &= \pi y + k_{12}\pi(\delta_3-\delta_2) + (\kappa\chi + \eta + p_1)\,\zeta
#   - \Omega_3\,e_3\times\pi\delta_3 + (I+\gamma)(s_n+\mu) - \Omega_3G_t\,\zeta,\\
# \tau\dot\mu &= K_4\pi n - w\,\zeta - \mu + \Omega_3\,e_3\times\pi(\delta_3-n)
#   + \Omega_3G_c\,\zeta\\
#  &\ + \tau\big[\eta\,(s_n+\mu) + K_4\dot\delta_4 + k_{12}\pi(\dot\delta_3-\dot\delta_2)\big],\\
# \tau\dot\mu_T &= -\kappa\,e_3^\top n - \mu_T - \tau\kappa\,e_3^\top\dot\delta_3 .
# \end{aligned}$$
#
# The term $\tau\eta\,(s_n + \mu)$ is easily forgotten: a torque that does not change moves
# $\delta_4$ at another pace as the lever $D_c$ changes.

# %%
quarter = skew(E3)[:2, :2]


def closed_form(loop):
    """Return the rates as they stand above."""
    d, e, at, rotors = loop.design, loop.errors, loop.setting, loop.rotors
    gamma, G_t = (ca.reshape(x, 2, 2) for x in (rotors.angular_gain, rotors.gyroscopic))
    (i1, i2, i3), tau, n, y = ca.vertsplit(d.inertia), rotors.lag, at.ahead, at.depth_flow
    G_c = ca.vertcat(ca.horzcat(0, (i3 - i1) / i2), ca.horzcat((i2 - i3) / i1, 0))
    kappa, k12 = (d.k1 * d.k2 + d.k3) / d.mass, d.k1 * d.k2 / d.mass
    K4, h, Omega, gain = kappa + d.k4 / d.mass, at.quickness, loop.body.rate, rotors.thrust_gain
    d1, d2, d3, d4 = e.d1, e.d2, e.d3, e.d4
    zeta, pull, p1 = d4 - d3[:2], k12 * (d3 - d2), h * d3[2]
    follows = kappa * d3[2] + rotors.thrust
    eta, w = gain * h / kappa * follows + at.crosswind, 2 * h * (d3 - n)[2] + at.crosswind
    s_a = -K4 * d4 - pull[:2] + rotors.torque
    dragged = at.goal * h * ca.vertcat(zeta, 0)
    r1 = -ca.cross(Omega, d1) - y + dragged
    r2 = -ca.cross(Omega, d2) + y + pull - dragged
    r3 = -ca.cross(Omega, d3) + y + pull - gain * follows * E3
    r3 += ca.vertcat(kappa * at.lever_ratio * zeta, 0)
    r4 = (y + pull)[:2] + (kappa * at.lever_ratio + eta + p1) * zeta + s_a + gamma @ s_a
    r4 -= Omega[2] * (quarter @ d3[:2] + G_t @ zeta)
    late = K4 * n[:2] - w * zeta - rotors.torque
    late += Omega[2] * (quarter @ (d3 - n)[:2] + G_c @ zeta)
    late += tau * (eta * s_a + K4 * r4 + k12 * (r3 - r2)[:2])
    lift = -kappa * n[2] - rotors.thrust - tau * kappa * r3[2]
    return ca.vertcat(r1, r2, r3, r4, late, lift)


for law, loop in LOOPS.items():
    assert prove_equal(loop.rate, closed_form(loop))
    print(f"δ1' to δ4', τ μ' and τ μT' of {law.name}: proved")

# %% [markdown]
# For $\tau\to0$ the last two lines say what $\mu$ and $\mu_T$ are, and the others become the rates
# of part 13: a lag of zero is none. That is why the inequality below, with a factor $\tau$ in front
# of the squares of $\mu$ and $\mu_T$, holds for every lag from zero to $\tau_r$.
#
# In $\pi(\dot\delta_3-\dot\delta_2)$ neither $y$ nor $\delta_3-\delta_2$ is left but for the turn,
# and $\Omega\times$ is products of errors:

# %%
for loop in LOOPS.values():
    d, e, at, rate = loop.design, loop.errors, loop.setting, loop.rate
    kappa, h, zeta = (d.k1 * d.k2 + d.k3) / d.mass, at.quickness, e.d4 - e.d3[:2]
    apart = e.d3 - e.d2
    right = (kappa * at.lever_ratio + at.goal * h + h * apart[2]) * zeta
    assert prove_equal((rate[6:9] - rate[3:6])[:2], right - at.yaw * quarter @ apart[:2])
    turned = ca.cross(loop.body.rate, e.d3)[2]
    assert prove_equal(turned, h * ca.dot(zeta, e.d3[:2]))
print("π(δ3' - δ2') = (κχ + s3 h + h (δ3 - δ2)z) ζ - Ω3 e3×π(δ3 - δ2), (Ω×δ3)z = h ζᵀπδ3: proved")

# %% [markdown]
# ## A late image
#
# The controller turns the last feature to the present axes by the gyroscope. In world axes it so
# uses $Rs$ of an earlier time. As $(Rs)\dot{} = -Ry$, what is used is ahead by
#
# $$n = R^\top\!\int_{t-\tau(t)}^t\! Ry\,dz,\qquad
# |n|^2 \le \bar\tau\int_{t-\bar\tau}^t |y|^2\,dz .$$
#
# The integral is paid back by a functional that remembers the last $\bar\tau$ (Krasovskii), here
# with a weight that lets it fade at the rate $r$ that is to be shown:
#
# $$Z = \int_{-\bar\tau}^0\!\int_{t+x}^t\! e^{r(z-t)}|y(z)|^2dz\,dx
#     = \int_{t-\bar\tau}^t K\,|y(z)|^2dz,\quad K = (z-t+\bar\tau)\,e^{r(z-t)},$$
# $$\dot Z \le -rZ + \bar\tau|y|^2 - \frac{\varepsilon}{\bar\tau}|n|^2,\qquad
# \varepsilon = 1 - x + \tfrac{x^2}2 - \tfrac{x^3}6 \le e^{-x},\ x = r\bar\tau .$$

# %%
R, s, y, Omega = (
    ca.SX.sym(n, *k) for n, k in (("R", (3, 3)), ("s", (3,)), ("y", (3,)), ("Omega", (3,)))
)
assert prove_equal(R @ skew(Omega) @ s + R @ (-skew(Omega) @ s - y), -R @ y)
z, t, bar, fade, r = map(ca.SX.sym, ("z", "t", "tau", "E", "r"))  # E' = -r E
K = (z - t + bar) * fade
assert prove_equal(ca.jacobian(K, t) - r * fade * ca.jacobian(K, fade), -fade - r * K)
x = ca.SX.sym("x")
series = 6 - 6 * x + 3 * x**2 - x**3
assert prove_equal(ca.jacobian(series, x) + series, -(x**3))
print("(Rs)' = -Ry; ∂K/∂t = -e^{r(z-t)} - r K; ε' + ε = -x³/6: proved")

# %% [markdown]
# ## Bounded matrices, and numbers in intervals
#
# In the derivative of
#
# $$E = \tfrac12\sum w_i|\delta_i|^2 + \tfrac12\tau\,(a_5|\mu|^2 + a_6\mu_T^2)$$
#
# the turns $-\Omega\times\delta_i$ drop out. What is left that is not known is of two sorts.
# *Numbers in intervals*: $\chi$, $s_3h$, $\varsigma$, $\tau$ and $w$; in each the rest is concave,
# so its ends suffice. *Matrices of bounded norm*, as $\gamma$: for these
# $u^\top Hv \le |H||u||v|$ and, for any $t > 0$,
#
# $$|u||v| \le \tfrac12\big(t|v|^2 + |u|^2/t\big)\quad\text{(Petersen)}.$$
#
# In the product of $\delta_4 = \zeta + \pi\delta_3$ with the turn of $\pi\delta_3$ only $\zeta$
# counts. And for $|J - jI|\le\varrho$, $\varrho^2|V|^2 - |y-jV|^2\ge0$ may be subtracted
# with any multiplier.

# %%
u, v, t = map(ca.SX.sym, ("u", "v", "t"))
assert prove_equal((t * v**2 + u**2 / t) / 2 - u * v, (t * v - u) ** 2 / (2 * t))
zeta, flat = ca.SX.sym("zeta", 2), ca.SX.sym("d3", 2)
assert prove_equal(ca.dot(zeta + flat, quarter @ flat), ca.dot(zeta, quarter @ flat))
for loop in LOOPS.values():
    e, rotors, d = loop.errors, loop.rotors, loop.design
    parts = ((e.d1, slice(0, 3)), (e.d2, slice(3, 6)), (e.d3, slice(6, 9)))
    for part, place in parts:
        turn = ca.cross(loop.body.rate, part)
        assert prove_zero(ca.dot(part, turn))
        still = loop.rate[place] + turn
        assert prove_equal(ca.dot(part, loop.rate[place]), ca.dot(part, still))
print("Petersen's step, the skew step, and the turns that drop out: proved")

# %% [markdown]
# ## The inequality
#
# With $\Psi = E + M\,Z$ the motion falls, $\dot\Psi\le-r\Psi$, on $\{\Psi\le\ell\}$ if at every
# vertex
#
# $$-\dot E_0 - rE - M\bar\tau|y|^2 + \frac{M\varepsilon}{\bar\tau}|n|^2
#  - \nu\big(\varrho^2|V|^2 - |y-jV|^2\big)
#  - \sum_k\frac{R_k}2\Big(t_k|v_k|^2 + \frac{|u_k|^2}{t_k}\Big)\succ0$$
#
# as a quadratic form of $(\delta, y, n, \mu, \mu_T)$. $V = (k_1/m)(\delta_1+\delta_2)$, $\dot E_0$
# is without the terms of bounded norm, and the intervals and $R_k$ are what $\Psi\le\ell$ implies.
# With these fixed, it is concave in $w_i$, $a_5$, $a_6$, $M$, $\nu$ and $t_k$ together: a solver
# finds them, and a checker decides in fractions.

# %%
for law, loop in LOOPS.items():
    if law.force.name == "measured":
        d, e, wind, body = loop.design, loop.errors, loop.wind, loop.body
        F, T_c = d.stiffness * (e.d3 - e.d2), body.thrust - wind[2]
        mg = d.mass * d.gravity * body.gravity_direction
        assert prove_equal(ca.dot(F - mg, F - mg), T_c**2 + ca.dot(wind[:2], wind[:2]))
        assert prove_equal((F - wind)[:2], mg[:2])
        assert prove_equal(e.d1 + e.d2, d.mass / d.k1 * body.velocity)
print("thrust and tilt in the wind, and V, from the errors: proved")

# %% [markdown]
# So $|\delta_3-\delta_2|\le\beta$ bounds the force, $|F|\le c\beta$, hence the measured thrust
# $T_c$, the lever $D_c$, $h$, and the tilt, $m g\sin\varphi\le c\beta + m\bar w$.
#
# ## What to remember
#
# Tolerances cost margin, each in its own way: an interval costs a corner, a matrix of bounded norm
# a multiplier, a late image a memory, and rotors that lag two errors more. No tolerance moves the
# hover of an inertial goal.
#
# ## What is not claimed
#
# * That the inequality has a solution: for given gains and tolerances a solver tries.
# * What of it makes a theorem, that $J$ stays in its ball and motions exist: that is
#   theorem 5 of `proofs/README.md`.
