# %% [markdown]
# # 9. A region of attraction
#
# Part 8 assumed that $Q$ stays within bounds. Where may the controller be switched on so that the
# vehicle does come to its goal? Here another function takes the place of $L$; it needs no lower
# bound of $Q$ and no knowledge of the yaw rate, and its level sets are bounded in position.
#
# Each `assert` below is an exact proof for all values of all symbols. The closed loop comes from
# the package; only the claimed closed forms are typed. The goal is straight below:
# $q^* = q_3^*e_3$.
#
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $\delta_1, \delta_2, \delta_3, \delta_4$ | errors of image, velocity, force and body rate | 1 |
# | $\xi$, $V$, $R$ | position (world, $z$ down), velocity (body), body to world | m, m/s, 1 |
# | $q$, $\rho = R^\top e_3$ | image centroid and direction of gravity, in body axes | 1 |
# | $T$, $F = -Te_3 + mg\rho$ | thrust and force | N |
# | $P_i'$, $P_i' - \xi$ | target point, and the ray to it, in world axes | m |
# | $Q = Q^\top \succeq 0$ | matrix of the unknown depths | 1/m |
# | $k_1, k_2, k_3, k_4$ | gains | kg m/s, 1/m, kg/s, kg/s |
# | $c = k_1^2k_2/m$, $f = k_1k_2(k_1k_2+k_3)/\big(m\,(T - c\,q_3^*)\big)$ | | N, 1/m |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.linear import lie_derivative
from hoverproof.certification.attraction.form import axial_loop
from hoverproof.plant import rigid_body
from hoverproof.plant.rigid_body import E3

loop = axial_loop()
z, d, f, Q = loop.measured, loop.design, loop.factor, loop.Q
m, g, c, q3 = d.mass, d.gravity, d.stiffness, d.goal_centroid[2]
k1, k2, k3, k4 = d.k1, d.k2, d.k3, d.k4
d1, d2, d3, d4 = loop.errors.d1, loop.errors.d2, loop.errors.d3, ca.vertcat(loop.errors.d4, 0)
rho = z.gravity_direction
P = ca.diag(ca.SX([1, 1, 0]))


def squared(a):
    return ca.dot(a, a)


# %% [markdown]
# ## The natural potential
#
# In world coordinates $Rq = -\nabla\Phi$ for $\Phi(\xi) = \sum_i|P_i' - \xi|$, a convex function:
# its Hessian is $Q$. So the hover that is asked for, if there is one, is the lowest point of
#
# $$W(\xi) = \Phi(\xi) - \Phi(\xi^*) + q_3^*\,e_3^\top(\xi - \xi^*) ,\qquad
# \dot W = -e^\top V,\quad e = q - q_3^*\rho .$$
#
# It is shown for one point; $\Phi$ is a sum of such terms.

# %%
point, xi, V, R = (
    ca.SX.sym(name, *size) for name, *size in (("P", 3), ("xi", 3), ("V", 3), ("R", 3, 3))
)
r, q_3 = ca.SX.sym("r"), ca.SX.sym("q3")
ray = point - xi
roots = {r: squared(ray)}
W = ca.sqrt(squared(ray)) + q_3 * xi[2]
e_of_one = R.T @ ray / r - q_3 * R.T @ E3
assert prove_equal(lie_derivative(W, xi, R @ V), -e_of_one.T @ V, roots)
hessian, _ = ca.hessian(W, xi)
assert prove_equal(hessian, (ca.SX.eye(3) - ray @ ray.T / r**2) / r, roots)
print("W' = -eᵀV, and the Hessian of W is Q: proved")

# %% [markdown]
# ## How $\delta_1$ and $e$ differ
#
# $\delta_1 = e + \eta$ with $\eta = q_3^*(\rho - e_3)$. With $\theta = \pi\rho/(1 + \rho_3)$, of
# length $\tan(\varphi/2)$ for a tilt $\varphi$, every unit vector $\rho \ne -e_3$ is a rational
# function of $\theta$. As $mg\rho = Te_3 + F$ and $F = c(\delta_3 - \delta_2)$,
#
# $$\eta = \frac{q_3^*c}{mg}\,(\pi - e_3\theta^\top)(\delta_3 - \delta_2) :$$
#
# for a known bound of the tilt, $\eta$ is linear in the errors.

# %%
theta, T = ca.SX.sym("theta", 2), z.thrust
unit = ca.vertcat(2 * theta, 1 - squared(theta)) / (1 + squared(theta))
F = rigid_body.force(T, unit, m, g)
lean = P - E3 @ ca.vertcat(theta, 0).T
assert prove_equal(squared(unit), ca.SX(1))
assert prove_equal(q3 * (unit - E3), q3 / (m * g) * lean @ F)
assert prove_equal(c * (d3 - d2), rigid_body.force(T, rho, m, g))
assert prove_equal(squared(F), (T - m * g) ** 2 + 2 * T * m * g * (1 - unit[2]))
print("η is linear in δ3 - δ2, and |T - m g| <= |F| for T > 0: proved")

# %% [markdown]
# ## The derivative of $\Lambda$
#
# For $\Lambda = W + \frac12(a_2|\delta_2|^2 + a_3|\delta_3|^2 + a_4|\delta_4|^2)$,
# $v = e + \eta + \delta_2 = \frac m{k_1}V$ and $K = (k_1k_2 + k_3)/k_1$,
#
# $$\begin{aligned} -\tfrac m{k_1}\dot\Lambda ={}& e^\top v
#   + a_2\big[k_2|\delta_2|^2 - k_2\,\delta_2^\top\delta_3
#     + fq_3^*\,\delta_2^\top\pi(\delta_4 - \delta_3) - \delta_2^\top Qv\big]\\
#  & + a_3\big[k_2\,\delta_3^\top\delta_2 - K\,\delta_3^\top\delta_4
#     + \tfrac{k_3}{k_1}|\delta_3|^2 - \delta_3^\top Qv\big]
#    + a_4\big[K\,\delta_4^\top\delta_3 + \tfrac{k_4}{k_1}|\delta_4|^2 - \delta_4^\top Qv\big] .
# \end{aligned}$$
#
# No $\Omega$ is left, not even the yaw rate: for a goal straight below, it drops out.

# %%
a = ca.SX.sym("a", 3)
e = z.centroid - q3 * rho
v, K = m / k1 * z.velocity, (k1 * k2 + k3) / k1
energy = (a[0] * squared(d2) + a[1] * squared(d3) + a[2] * squared(d4)) / 2
rate = -ca.dot(e, z.velocity) + loop.dot(energy)
second = k2 * squared(d2) - k2 * ca.dot(d2, d3) + f * q3 * ca.dot(d2, P @ (d4 - d3))
third = k2 * ca.dot(d3, d2) - K * ca.dot(d3, d4) + k3 / k1 * squared(d3)
fourth = K * ca.dot(d4, d3) + k4 / k1 * squared(d4)
claimed = ca.dot(e, v) + a[0] * (second - ca.dot(d2, Q @ v))
claimed += a[1] * (third - ca.dot(d3, Q @ v)) + a[2] * (fourth - ca.dot(d4, Q @ v))
assert prove_equal(-m / k1 * loop.axial(rate), loop.axial(claimed))
assert prove_equal(loop.axial(v), loop.axial(e + q3 * (rho - E3) + d2))
print("Λ' as a quadratic form of (e, δ2, δ3, δ4), for any Ω: proved")

# %% [markdown]
# $Q$ stands in one bilinear form $u^\top Qv$, $u = -(a_2\delta_2 + a_3\delta_3 + a_4\delta_4)$. So,
# as in part 8, for $0 \preceq Q \preceq \lambda I$ and any $\tau > 0$,
# $u^\top Qv \ge \frac\lambda2\big(u^\top v - \frac12(\tau|v|^2 + |u|^2/\tau)\big)$, and what is to
# be shown is one matrix inequality at each end of $f$: the form is affine in $f$ and in $\theta$,
# and a turn about $e_3$ carries one $\theta$ to all of its length. There is no lower bound of $Q$
# in it.
#
# ## The height
#
# The level alone must keep away from the target points, where $Q$ is infinite. But a vehicle does
# not sink to its target, either. With $\kappa = (k_1k_2 + k_3)/m$ and
# $N = z + \frac m{k_1k_2}(\dot z + \ddot z/\kappa)$ one has exactly
#
# $$\dot N = \frac{k_1}m\,w,\qquad w = \rho^\top q - q_3^*\cos\varphi
#   + (\pi\rho)^\top\big[(1 + \gamma)\delta_4 - \gamma\,\pi\delta_3\big],\quad
#   \gamma = \frac{c\,q_3^*}{T - c\,q_3^*} .$$
#
# $\rho^\top q = \sum_i h_i/r_i$ does not fall as the heights $h_i$ above the points grow; straight
# above or below a point, $h_i/r_i$ is $1$ or $-1$. Near the target it is below $q_3^*$, so $N$, the
# depth at which the vehicle would come to rest, decreases.

# %%
kappa = (k1 * k2 + k3) / m
gamma = c * q3 / (T - c * q3)
sink = ca.dot(rho, z.velocity)
N_rate = sink + m / (k1 * k2) * (loop.dot(sink) + loop.dot(loop.dot(sink)) / kappa)
w = ca.dot(rho, z.centroid) - q3 * rho[2] + ca.dot(P @ rho, (1 + gamma) * d4 - gamma * d3)
assert prove_equal(loop.axial(N_rate), loop.axial(k1 / m * w))
print("N' = (k1/m) w: proved")

# %% [markdown]
# $z$ follows $N$ through two lags, with the rates $r \le s$, $r + s = \kappa$,
# $rs = \kappa k_1k_2/m$, which are real if $k_3 \ge 3k_1k_2$: with $x = z + \dot z/r$,
# $\dot x = s(N - x)$ and $\dot z = r(x - z)$. Where $w \le \bar w$, the first lag $N - x$ stays
# below $\frac{k_1}m\bar w/s$ and the second below $\frac{k_1}m\bar w/r$. Their sum is
# $\bar w/k_2$.

# %%
slow, fast, b, z0, z1, z2, w_, w_most = map(
    ca.SX.sym, ("r", "s", "b", "z", "dz", "ddz", "w", "w_most")
)
height = ca.vertcat(z0, z1, z2)
motion = ca.vertcat(z1, z2, -(slow + fast) * z2 - slow * fast * z1 + b * slow * fast * w_)
N, x = z0 + (slow + fast) / (slow * fast) * (z1 + z2 / (slow + fast)), z0 + z1 / slow
assert prove_equal(lie_derivative(N, height, motion), b * w_)
assert prove_equal(lie_derivative(x, height, motion), fast * (N - x))
assert prove_equal(z1, slow * (x - z0))
k_2 = slow * fast / (b * (slow + fast))  # b = k1/m, r s = κ k1 k2/m
assert prove_equal(b * w_most / fast + b * w_most / slow, w_most / k_2)
print("two lags, together w/k2 at most: proved")

# %% [markdown]
# So if $w \le 0$ at and below a depth $z_s$, a motion from hover passes no depth below
# $z_s + \bar w/k_2$. That, a level of $\Lambda$, and a bound $\lambda$ of $Q$ above that depth hold
# each other up: none can be the first to fail. `hoverproof attraction` finds numbers that fit
# and proves them in exact arithmetic; the theorem and its whole proof stand in `proofs/`.
#
# ## What is not claimed
#
# * Goals that are not straight below.
# * Sampling, noise, delay, limits of the rotors, wind, and errors of the model.
# * That the camera sees the target at all times: this is assumed.
