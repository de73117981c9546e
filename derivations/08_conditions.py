# %% [markdown]
# # 8. From Σ to a certificate
#
# Here the question is answered: given numbers for mass, gains and goal, is the matrix
# $\Sigma(Q, f)$ positive definite for every $Q$ and every $f$ that may occur? First it is turned
# into one matrix inequality, without loss. Then two vehicles are put to the test, one that passes
# and one that fails.
#
# Formulas are proved by `prove_equal` for all values of all symbols. Numbers are rational
# numbers, and definiteness is decided by an exact $LDL^\top$; a floating point solver only makes
# suggestions.

# %%
from fractions import Fraction

import casadi as ca

import hoverproof as hp
from hoverproof import checker
from hoverproof.algebra.definite import is_positive_definite
from hoverproof.algebra.graph import evaluate
from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.servo.lyapunov import derive_lyapunov_form, symmetric_matrix
from hoverproof.servo.variables import Design

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $\delta_1, \delta_2, \delta_3, \delta_4$ | errors of image, velocity, force and body rate | 1 |
# | $X$ | all errors in one column, $X \in \mathbb R^{11}$ | 1 |
# | $L = \frac12\sum_i\lvert\delta_i\rvert^2$ | Lyapunov function, $-m\dot L = X^\top\Sigma X$ | 1 |
# | $Q = Q^\top$, eigenvalues in $[\lambda_-, \lambda_+]$ | matrix of the unknown depths | 1/m |
# | $m$, $q^*$ | mass, wanted image centroid | kg, 1 |
# | $k_1, k_2, k_3, k_4$ | gains | kg m/s, 1/m, kg/s, kg/s |
# | $T$ | thrust | N |
# | $c = k_1^2k_2/m$ | force per unit of error | N |
# | $f = k_1k_2(k_1k_2+k_3)/\big(m\,(T - c\,q_3^*)\big)$, in $[f_-, f_+]$ | thrust factor | 1/m |
#
# $Q$ enters through one bilinear form, with $u = \delta_1-\delta_2-\delta_3-\delta_4$ and
# $v = \delta_1+\delta_2$ ($\delta_4$ has two components; read its third as 0):
#
# $$X^\top\Sigma(Q, f)\,X = k_1\,u^\top Qv + [\text{terms without } Q] .$$

# %%
form = derive_lyapunov_form()
X, f, k1 = form.errors, form.f, form.design.k1
Sigma = ca.substitute(form.Sigma, form.weights, ca.SX.ones(4))
u_hat = ca.substitute(form.flow_weight, form.weights, ca.SX.ones(4))
v_hat = form.scaled_velocity


def Sigma_at(Q):
    """Return Σ for a symmetric (3, 3) matrix."""
    return ca.substitute(Sigma, form.Q_lower, ca.densify(ca.vertcat(Q[:, 0], Q[1:, 1], Q[2, 2])))


Q = symmetric_matrix(form.Q_lower)
u, v = u_hat @ X, v_hat @ X
assert prove_equal(u, X[0:3] - X[3:6] - X[6:9] - ca.vertcat(X[9:11], 0))
assert prove_equal(v, X[0:3] + X[3:6])
assert prove_equal(X.T @ Sigma @ X, k1 * u.T @ Q @ v + X.T @ Sigma_at(ca.SX.zeros(3, 3)) @ X)
print("XᵀΣX = k1 uᵀQv + [terms without Q]: proved")

# %% [markdown]
# ## The worst $Q$ for two given vectors
#
# Write $\bar\lambda = \frac12(\lambda_-+\lambda_+)$, $\varrho = \frac12(\lambda_+-\lambda_-)$ and
# $Q = \bar\lambda I + \varrho H$. Then $Q$ may be any symmetric matrix with $H = H^\top$ and
# $|H|\le 1$ (no eigenvalue of $H$ outside $[-1, 1]$). As $|u^\top Hv| \le |u||v|$,
#
# $$u^\top Qv \ \ge\ \bar\lambda\,u^\top v - \varrho\,|u||v| ,$$
#
# and this is attained: the mirror $H = I - 2\,\dfrac{n\,n^\top}{n^\top n}$ with
# $n = \frac{u}{|u|} + \frac{v}{|v|}$ turns $v$ into the direction opposite to $u$. A mirror is
# symmetric, and its eigenvalues are $\pm1$, as $H^2 = I$. (If $n = 0$, then $H = I$ does it.)

# %%
a, b = ca.SX.sym("a", 3), ca.SX.sym("b", 3)  # any two vectors, in place of u and v
size_a, size_b = ca.SX.sym("|a|"), ca.SX.sym("|b|")
roots = {size_a: ca.sumsqr(a), size_b: ca.sumsqr(b)}
n = a / size_a + b / size_b
mirror = ca.SX.eye(3) - 2 * n @ n.T / ca.sumsqr(n)

assert prove_equal(mirror, mirror.T, roots)
assert prove_equal(mirror @ mirror, ca.SX.eye(3), roots)
assert prove_equal(a.T @ mirror @ b, -size_a * size_b, roots)
print("a mirror H attains uᵀHv = -|u||v|: proved")

# %% [markdown]
# ## One matrix for all $Q$: Petersen's lemma
#
# For a number $\tau > 0$ let
#
# $$M(\tau, f) = \Sigma(\bar\lambda I, f) - \frac{k_1\varrho}{2}
#   \Big(\tau\,\hat v^\top\hat v + \frac1\tau\,\hat u^\top\hat u\Big),$$
#
# where $\hat u$, $\hat v$ are the $3\times11$ matrices with $u = \hat uX$ and $v = \hat vX$. Then
# for $Q = \bar\lambda I + \varrho H$
#
# $$X^\top\Sigma(Q, f)\,X - X^\top M X = \frac{k_1\varrho}{2}\bigg(
#   \tau\,\Big|v + \frac1\tau Hu\Big|^2 + \frac1\tau\Big(|u|^2 - |Hu|^2\Big)\bigg) \ \ge\ 0 ,$$
#
# because $|Hu|\le|u|$. So **one** $\tau$ with $M(\tau, f)\succ0$ settles **every** $Q$.

# %%
lam, spread, tau = ca.SX.sym("lam"), ca.SX.sym("spread"), ca.SX.sym("tau")
H = ca.tril2symm(ca.SX.sym("H", ca.Sparsity.lower(3)))
loss = k1 * spread / 2 * (tau * v_hat.T @ v_hat + u_hat.T @ u_hat / tau)
M = Sigma_at(lam * ca.SX.eye(3)) - loss

gap = X.T @ Sigma_at(lam * ca.SX.eye(3) + spread * H) @ X - X.T @ M @ X
square = tau * ca.sumsqr(v + H @ u / tau)
remainder = (ca.sumsqr(u) - ca.sumsqr(H @ u)) / tau
assert prove_equal(gap, k1 * spread / 2 * (square + remainder))
print("XᵀΣX - XᵀMX = (k1 ϱ/2)(τ|v + Hu/τ|² + (|u|² - |Hu|²)/τ): proved")

# %% [markdown]
# Nothing is lost by this: Petersen (1987) showed that if $\Sigma(Q, f)\succ0$ for every such $Q$,
# then such a $\tau$ exists. (That half is quoted, not proved here. His $H$ need not be symmetric;
# by the mirror above that makes no difference. No certificate rests on it; it only says that a
# search for $\tau$ does not fail without need.) For a given $f$, $M \succeq t I$ is, by a Schur
# complement, a linear matrix inequality in $(\tau, t)$, so finding the best $\tau$ is a convex
# problem.
#
# ## Both ends of $f$ are enough
#
# $\Sigma$ is affine in $f$. If $X^\top\Sigma(Q, f)X > 0$ at $f_-$ and at $f_+$, for all $Q$ and
# $X \ne 0$, then it is positive between them. Each end may have a $\tau$ of its own.

# %%
low, high, share = ca.SX.sym("f-"), ca.SX.sym("f+"), ca.SX.sym("share")
between = ca.substitute(Sigma, f, (1 - share) * low + share * high)
mixed = (1 - share) * ca.substitute(Sigma, f, low) + share * ca.substitute(Sigma, f, high)
assert prove_equal(between, mixed)
print("Σ between two values of f is the mean of Σ at both: proved")

# %% [markdown]
# ## The vehicle of Hamel and Mahony
#
# A mission file holds mass, target, goal, gains and the bounds that are assumed. Its decimals are
# taken as the exact fractions they are. What is irrational, $q_3^* = 12/\sqrt{11}$ here, and $f$
# with it, is held between two rational numbers.

# %%
mission = hp.load("x4-flyer")
verdict = hp.certify(mission)
problem = verdict.problem
gains = mission.gains
(f_low, f_high), (lam_low, lam_high) = problem.factor, problem.eigenvalues

print(f"k1 = {gains.k1} kg m/s, k2 = {gains.k2} 1/m, k3 = {gains.k3} kg/s, k4 = {gains.k4} kg/s")
print(f"eigenvalues of Q in [{float(lam_low)}, {float(lam_high)}] 1/m")
print(f"thrust in [{float(problem.thrust[0])}, {float(problem.thrust[1])}] N")
print(f"f in about [{float(f_low):.4f}, {float(f_high):.4f}] 1/m")
print(f"q3* is about {float(problem.goal.centroid_midpoint[2]):.4f}")
print(f"verdict: {verdict.status}")

# %% [markdown]
# The verdict comes with a certificate. It names, for each end of $f$, a rational $\tau$ and a
# rational margin $t$. Here is the proof again, step by step. The graph of $M(\tau, f) - tI$ from
# above is run on fractions, at both ends of $f$ and at both ends of the enclosure of $q_3^*$ (in
# which $M$ is affine, too), and an exact $LDL^\top$ decides whether it is positive definite.

# %%
t = ca.SX.sym("t")
symbols = [form.design.vector(), lam, spread, f, tau, t]
bound = ca.Function("bound", symbols, [M - t * ca.SX.eye(11)])
middle, half_width = (lam_low + lam_high) / 2, (lam_high - lam_low) / 2

vertices = verdict.certificate.content["vertices"]
for vertex, end in zip(vertices, ("f-", "f+"), strict=True):
    factor, multiplier, margin = (Fraction(vertex[k]) for k in ("factor", "multiplier", "margin"))
    assert factor == {"f-": f_low, "f+": f_high}[end]
    for goal in problem.corners():
        numbers = [[middle], [half_width], [factor], [multiplier], [margin]]
        (matrix,) = evaluate(bound, [Design.values(mission, goal), *numbers])
        assert is_positive_definite(matrix)
    print(f"at {end}: every eigenvalue of Σ is above t, proved;", end=" ")
    print(f"t is about {float(margin):.5f} kg/s, τ about {float(multiplier):.2f}")

# %% [markdown]
# Therefore $\Sigma(Q, f) \succ 0$ in the whole region, and $\dot L \le -\frac{2t}{m}L$ with the
# smaller of both margins. The margin is nearly the best there is: an explicit $Q$, $f$ and $X$
# give an upper bound that agrees with it to many digits. A program of its own, `checker.py`,
# which shares no code with what made the certificate, accepts it.

# %%
assert set(problem.weights) == {1}
assert verdict.margin == min(Fraction(vertex["margin"]) for vertex in vertices)
assert verdict.decay_rate == 2 * verdict.margin / mission.vehicle.mass
assert verdict.margin < verdict.margin_above < verdict.margin * Fraction(1000001, 1000000)
checker.check(verdict.certificate.content)
rate = float(verdict.decay_rate)
print(f"L falls at least as fast as exp(-r·time), r about {rate:.2e} 1/s: proved")

# %% [markdown]
# The rate is small: this $L$ and these wide bounds of $Q$ promise no more. It is a lower bound; a
# flight may settle faster.
#
# ## A gain that is too small
#
# One might hope that any $k_4 > 0$ will do, since $k_4$ damps an error that stands last in the
# chain. But take a $Q = \lambda I$, $\delta_1 = \delta_2 = \frac12e_1$, $\delta_3 = 0$ and
# $\delta_4 = e_1$, with $e_1$ the first unit vector. Then
#
# $$X^\top\Sigma X = k_4 - k_1\Big(\lambda - \frac{k_2}{4}\Big),$$
#
# whatever the thrust and the goal. So $k_4 > k_1(\lambda_+ - k_2/4)$ is necessary.

# %%
half = ca.SX(1) / 2
x = ca.vertcat(half, 0, 0, half, 0, 0, 0, 0, 0, 1, 0)
value = x.T @ Sigma_at(lam * ca.SX.eye(3)) @ x
d = form.design
assert prove_equal(value, d.k4 - d.k1 * (lam - d.k2 / 4))
assert prove_zero(ca.jacobian(value, ca.vertcat(f, d.goal_centroid, d.k3)))
print("XᵀΣX = k4 - k1 (λ - k2/4) for this X: proved")
print(f"so k4 must be above {float(gains.k1 * (lam_high - gains.k2 / 4))} kg/s")

# %% [markdown]
# With $k_4 = 0.1$ in place of 3 that is violated, so the verdict must be *refuted*. It brings a
# counterexample of its own: a $Q$, an $f$ and an $X$ in fractions. What makes it one is checked
# here exactly: both $Q - \lambda_-I$ and $\lambda_+I - Q$ are positive definite, $f$ is the
# factor of a thrust in the interval, and $X^\top\Sigma X < 0$.

# %%
weak = hp.certify(hp.load("x4-flyer", {"gains.k4": "0.1"}))
assert weak.status == "refuted"

lowest, highest = weak.problem.factor_attained
assert lowest <= weak.f <= highest
Q_numbers = [weak.Q[i][j] for j in range(3) for i in range(j, 3)]
room = ca.Function("room", [form.Q_lower, lam, t], [Q - lam * ca.SX.eye(3), t * ca.SX.eye(3) - Q])
for difference in evaluate(room, [Q_numbers, [lam_low], [lam_high]]):
    assert is_positive_definite(difference)

rate = ca.Function("rate", [form.design.vector(), form.Q_lower, f, X], [X.T @ Sigma @ X])
for goal in weak.problem.corners():
    numbers = [Q_numbers, [weak.f], weak.X]
    (value,) = evaluate(rate, [Design.values(weak.problem.mission, goal), *numbers])
    assert value[0][0] < 0
checker.check(weak.certificate.content)
print(f"k4 = {float(weak.problem.mission.gains.k4)}: {weak.status}, XᵀΣX < 0")

# %% [markdown]
# ## What is not claimed
#
# * *Proved* means: while the eigenvalues of $Q$ and the thrust stay in their intervals and
#   $\Omega_3 = 0$, $L$ falls at the stated rate. That they stay there during a flight is assumed
#   and not shown here. $Q$ depends on where the vehicle is, and $L$ alone hardly bounds where it
#   goes.
# * *Refuted* means: at some $Q$ and thrust within the bounds, $L$ rises for some error. It does
#   not mean that a flight diverges, nor that the target can show this very $Q$ together with this
#   $X$. Another Lyapunov function may prove the same gains.
# * The vehicle is an ideal rigid body, with exact measurements, no delay and rotors without
#   limits.
