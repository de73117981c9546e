# %% [markdown]
# # 7. The matrix Σ
#
# Along the closed loop the Lyapunov function changes at a rate that is a quadratic form of the
# errors, $-m\dot L = X^\top\Sigma X$. This part writes $\Sigma$ down, and shows the property that
# makes it tractable: the unknown matrix $Q$ enters through a single bilinear form.
#
# Each `assert` below is an exact proof for all values of all symbols. $\Sigma$ comes from the
# package, which reads it off the derivative of $L$; only the claimed closed form is typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.lyapunov import (
    Errors,
    derive_error_dynamics,
    derive_lyapunov_form,
    lyapunov,
    symmetric_matrix,
)

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $\delta_1, \delta_2, \delta_3$ | errors of image, velocity, force, each in $\mathbb R^3$ | 1 |
# | $\delta_4$ | error of the body rate, in $\mathbb R^2$ | 1 |
# | $X$ | all errors in one column, $X \in \mathbb R^{11}$ | 1 |
# | $Q = Q^\top$ | matrix of the unknown depths | 1/m |
# | $T$ | thrust | N |
# | $m$, $q^*$ | mass, wanted image centroid | kg, 1 |
# | $k_1, k_2, k_3, k_4$ | gains | kg m/s, 1/m, kg/s, kg/s |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
# | $f = k_1k_2(k_1k_2+k_3)/\big(m\,(T - c\,q_3^*)\big)$ | all that matters of the thrust | 1/m |
# | $A = q_3^*\,I - e_3\,{q^*}^\top$ | what the fixed goal does when the body turns | 1 |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
# | $w_1,\dots,w_4$ | weights in $L = \frac12\sum_i w_i\lvert\delta_i\rvert^2$ | 1 |
#
# Here $e_3 = (0, 0, 1)^\top$, and $\mathrm{sk}(a)$ is the matrix with
# $\mathrm{sk}(a)\,b = a\times b$.
#
# While the yaw rate is zero, the controller makes the errors move like this,
# $v = \delta_1+\delta_2$:
#
# $$\begin{aligned}
# m\,\dot\delta_1 &= -m\,\mathrm{sk}(\Omega)\,\delta_1 - k_1Qv + k_1fA\,(\delta_4-\delta_3)\\
# m\,\dot\delta_2 &= -m\,\mathrm{sk}(\Omega)\,\delta_2 + k_1Qv - k_1k_2\,\delta_2 + k_1k_2\,\delta_3
#   - k_1fA\,(\delta_4-\delta_3)\\
# m\,\dot\delta_3 &= -m\,\mathrm{sk}(\Omega)\,\delta_3 + k_1Qv - k_1k_2\,\delta_2 - k_3\,\delta_3
#   + (k_1k_2+k_3)\,\delta_4\\
# m\,\dot\delta_4 &= k_1\pi Qv - (k_1k_2+k_3)\,\pi\delta_3 - k_4\,\delta_4
# \end{aligned}$$
#
# with $\Omega = -\frac{k_1}{m}f\,\mathrm{sk}(e_3)\,(\delta_4-\delta_3)$, the angular velocity in
# rad/s, itself a function of the errors.

# %%
loop = derive_error_dynamics()
form = derive_lyapunov_form(loop)
design, X, f = form.design, form.errors, form.f
m, goal = design.mass, design.goal_centroid
k1, k2, k3, k4 = design.k1, design.k2, design.k3, design.k4
k12 = k1 * k2
Q = symmetric_matrix(form.Q_lower)
identity = ca.SX.eye(3)
pi = identity - E3 @ E3.T
A = goal[2] * identity - E3 @ goal.T

e = Errors.from_vector(X)
d1, d2, d3, d4 = e.d1, e.d2, e.d3, ca.vertcat(e.d4, 0)
v = d1 + d2
turn = k1 * f * A @ (d4 - d3)
spin = m * skew(-k1 / m * f * skew(E3) @ (d4 - d3))
closed = ca.vertcat(
    -spin @ d1 - k1 * Q @ v + turn,
    -spin @ d2 + k1 * Q @ v - k12 * d2 + k12 * d3 - turn,
    -spin @ d3 + k1 * Q @ v - k12 * d2 - k3 * d3 + (k12 + k3) * d4,
    (k1 * pi @ Q @ v - (k12 + k3) * pi @ d3 - k4 * d4)[:2],
)
assert prove_equal(m * loop.rate_with_depths(Q), closed)
print("the closed loop in the errors: proved, all parameters symbolic")

# %% [markdown]
# ## A quadratic form
#
# $$-m\,\dot L = X^\top\,\Sigma(Q, f)\,X .$$
#
# The package differentiates $L$ and takes half the matrix of second derivatives at $X = 0$ as
# $\Sigma$. That this reproduces $-m\dot L$ for all $X$ has to be shown: the terms of third order,
# from the rotation, must have cancelled.

# %%
w = form.weights
w1, w2, w3, w4 = ca.vertsplit(w)
L = lyapunov(e, w)
squares = w1 * ca.sumsqr(d1) + w2 * ca.sumsqr(d2) + w3 * ca.sumsqr(d3) + w4 * ca.sumsqr(d4)
assert prove_equal(L, squares / 2)

falling = -m * ca.gradient(L, X).T @ loop.rate_with_depths(Q)
assert prove_equal(falling, form.dissipation)
assert prove_equal(falling, X.T @ form.Sigma @ X)
assert prove_equal(form.Sigma, form.Sigma.T)
print("-m L' = XᵀΣX, and Σ is symmetric: proved, for all weights")

# %% [markdown]
# ## Σ block by block
#
# For $w_1 = \dots = w_4 = 1$:
#
# $$\Sigma = \begin{pmatrix}
# k_1Q & 0 & -\frac{k_1}{2}(Q - fA) & -\frac{k_1}{2}(Q + fA)\pi\\
# 0 & k_1(k_2I - Q) & -\frac{k_1}{2}(Q + fA) & -\frac{k_1}{2}(Q - fA)\pi\\
# \cdot & \cdot & k_3 I & 0\\
# \cdot & \cdot & \cdot & k_4 I
# \end{pmatrix}$$
#
# Dots stand for the transposed blocks; of the last block row and column only the first two rows
# and columns exist.

# %%
ones = ca.SX.ones(4)
Sigma = ca.substitute(form.Sigma, w, ones)
minus, plus, zero = -k1 / 2 * (Q - f * A), -k1 / 2 * (Q + f * A), ca.SX.zeros(3, 3)
blocks = ca.blockcat(
    [
        [k1 * Q, zero, minus, plus],
        [zero, k1 * (k2 * identity - Q), plus, minus],
        [minus.T, plus.T, k3 * identity, zero],
        [plus.T, minus.T, zero, k4 * identity],
    ]
)
assert prove_equal(Sigma, blocks[:11, :11])
print("the blocks of Σ: proved")

# %% [markdown]
# ## One bilinear form
#
# All of $Q$ is in one term. With
#
# $$u = w_1\delta_1 - w_2\delta_2 - w_3\delta_3 - w_4\delta_4, \qquad v = \delta_1 + \delta_2,$$
#
# $$X^\top\Sigma(Q, f)\,X = k_1\,u^\top Q\,v + X^\top\Sigma(0, f)\,X .$$
#
# The reason is simple. $Q$ enters the motion only through the depth flow $y = \frac{k_1}{m}Qv$,
# and the flow enters the four rates with the constant factors $-1, 1, 1, \pi$. So $-m\dot L$
# contains $m\,u^\top y$ and no other depth.

# %%
u = w1 * d1 - w2 * d2 - w3 * d3 - w4 * d4
assert prove_equal(form.flow_weight @ X, u)
assert prove_equal(form.scaled_velocity @ X, v)

without_depths = ca.substitute(form.Sigma, form.Q_lower, ca.SX.zeros(6))
assert prove_equal(X.T @ form.Sigma @ X, k1 * u.T @ Q @ v + X.T @ without_depths @ X)
print("XᵀΣX = k1 uᵀQv + [terms without Q]: proved, for all weights")

# %% [markdown]
# What has no $Q$ is short, too:
#
# $$\begin{aligned} X^\top\Sigma(0,f)\,X
#  ={}& w_2\,k_1k_2\,\big(|\delta_2|^2 - \delta_2^\top\delta_3\big)\\
#  & + w_3\big(k_1k_2\,\delta_3^\top\delta_2 + k_3|\delta_3|^2
#    - (k_1k_2+k_3)\,\delta_3^\top\delta_4\big)\\
#  & + w_4\big((k_1k_2+k_3)\,\delta_4^\top\delta_3 + k_4|\delta_4|^2\big)
#   - k_1 f\,(w_1\delta_1 - w_2\delta_2)^\top A\,(\delta_4-\delta_3) . \end{aligned}$$

# %%
rest = (
    w2 * k12 * (ca.sumsqr(d2) - ca.dot(d2, d3))
    + w3 * (k12 * ca.dot(d3, d2) + k3 * ca.sumsqr(d3) - (k12 + k3) * ca.dot(d3, d4))
    + w4 * ((k12 + k3) * ca.dot(d4, d3) + k4 * ca.sumsqr(d4))
    - k1 * f * (w1 * d1 - w2 * d2).T @ A @ (d4 - d3)
)
assert prove_equal(X.T @ without_depths @ X, rest)
print("the terms without Q: proved, for all weights")

# %% [markdown]
# ## Affine in the thrust factor
#
# $\Sigma$ is affine in $f$, and so it is in each component of $q^*$ at a fixed $f$. If
# $X^\top\Sigma X > 0$ at both ends of an interval of $f$, then it is between them.

# %%
flat = ca.vec(form.Sigma)
assert prove_zero(ca.jacobian(ca.jacobian(flat, f), f))
for i in range(3):
    assert prove_zero(ca.jacobian(ca.jacobian(flat, goal[i]), goal[i]))
print("Σ is affine in f and in each component of q*: proved")

# %% [markdown]
# ## From Σ to a rate
#
# Let $w_i = 1$. Then $|X|^2 = 2L$, and if every eigenvalue of $\Sigma$ is at least $t > 0$ in
# kg/s,
#
# $$\dot L = -\tfrac1m X^\top\Sigma X \le -\tfrac tm|X|^2 = -\tfrac{2t}{m}\,L .$$
#
# So $L$ falls at least as fast as $e^{-2t\,\cdot\,\mathrm{time}/m}$, and all errors with it.

# %%
assert prove_equal(ca.sumsqr(X), 2 * ca.substitute(L, w, ones))
print("|X|² = 2 L for unit weights: proved")

# %% [markdown]
# ## What to remember
#
# The question is now one of linear algebra: is $\Sigma(Q, f) \succ 0$ for **every** symmetric $Q$
# whose eigenvalues lie in an interval, and every $f$ in an interval? Samples of $Q$ cannot answer
# it.
