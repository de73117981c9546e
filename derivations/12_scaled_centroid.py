# %% [markdown]
# # 12. The scaled centroid
#
# The centroid $q$ of a small target hardly changes along the line of sight: $Q$ is nearly singular,
# and its eigenvalues are far apart. The length of $q$ tells how large the target looks. So a
# function of $q$ alone, without any depth, can even that out: the *scaled* centroid
#
# $$s = \varphi(|q|)\,\frac q{|q|},\qquad \varphi(a) = \frac1{\sqrt{2\,(1 - a/n)}} .$$
#
# This part shows how $s$ moves and that the controller is the same.
#
# Each `assert` below is an exact proof for all values of all symbols. The feature, the spread and
# the controllers come from the package; only the claimed closed forms are typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import camera
from hoverproof.plant.rigid_body import skew
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.laws.choices import SCALED
from hoverproof.servo.laws.hamel_mahony import LAWS

# %% [markdown]
# ## What is given
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $p_i$, $n$ | unit vectors to the target points, in body axes, and their number | 1 |
# | $q = \sum_i p_i$, $a = \lvert q\rvert$ | image centroid, and its length; $0 < a < n$ | 1 |
# | $\varphi$, $s$ | scale, and scaled centroid | 1 |
# | $V$, $\Omega$ | velocity and angular velocity, in body axes | m/s, rad/s |
# | $Q = Q^\top$ | matrix of the unknown depths, $\dot q = -\Omega\times q - QV$ | 1/m |
#
# Square roots are symbols $a$ and $\varphi$ here, with
# $a^2 = q^\top q$ and $\varphi^2 = n(n + a)/\big(2(n^2 - a^2)\big)$.

# %%
q, n, a, phi = ca.SX.sym("q", 3), ca.SX.sym("n"), ca.SX.sym("a"), ca.SX.sym("phi")
roots = {a: ca.dot(q, q), phi: n * (n + a) / (2 * (n**2 - ca.dot(q, q)))}
s = SCALED.at(q, n)
assert prove_equal(s, phi * q / a, roots)
assert prove_equal(phi**2, 1 / (2 * (1 - a / n)), roots)
print("s = φ q/|q| with φ² = 1/(2 (1 - a/n)): proved")

# %% [markdown]
# ## Without cancellation
#
# A small target has $a \approx n$, and $n - a$ is lost in short numbers. But
#
# $$n^2 - a^2 = n\sum_i\Big|p_i - \frac qn\Big|^2 = \tfrac12\sum_{i,j}|p_i - p_j|^2 ,$$
#
# a sum of squares of what is small, and $n - a = (n^2 - a^2)/(n + a)$. So $\varphi^2$ is $n(n+a)/2$
# over this sum: for a small target it is the square of distance over size. It is shown for three
# points.

# %%
points, r = ca.SX.sym("P", 3, 3), ca.SX.sym("r", 3)
lengths = {r[i]: ca.sumsqr(points[:, i]) for i in range(3)}
rays = camera.directions(points)
centroid = camera.centroid(rays)
spread = camera.spread(rays, centroid)
pairs = sum(ca.sumsqr(rays[:, i] - rays[:, j]) for i in range(3) for j in range(i))
assert prove_equal(spread, 3**2 - ca.dot(centroid, centroid), lengths)
assert prove_equal(spread, pairs, lengths)
print("n² - a² as a sum of squares: proved")

# %% [markdown]
# ## Its slope
#
# $$\varphi' = \frac{d\varphi}{da} = \frac{\varphi^3}n,\qquad
# D_s(q) = \frac{\partial s}{\partial q}
#  = \frac\varphi a\Big(I - \frac{qq^\top}{a^2}\Big) + \frac{\varphi^3}n\,\frac{qq^\top}{a^2} .$$

# %%
length = ca.SX.sym("length")
along = 1 / (2 * (1 - length / n))
assert prove_equal(ca.jacobian(ca.sqrt(along), length), phi**3 / n, {phi: along})

outer, identity = q @ q.T / a**2, ca.SX.eye(3)
slope = phi / a * (identity - outer) + phi**3 / n * outer
assert prove_equal(ca.jacobian(s, q), slope, roots)
print("φ' = φ³/n, and the slope of s: proved")

# %% [markdown]
# $D_s$ is symmetric, with the eigenvalue $\varphi^3/n$ along $q$ and $\varphi/a$ across it. Both
# are positive: no motion of $q$ is lost in $s$.

# %%
across = ca.cross(q, ca.SX.sym("x", 3))
assert prove_equal(slope @ q, phi**3 / n * q, roots)
assert prove_equal(slope @ across, phi / a * across, roots)
assert prove_equal(ca.det(slope), phi**5 / (n * a**2), roots)
print("eigenvalues φ³/n and φ/a of the slope: proved")

# %% [markdown]
# ## How it moves
#
# $s$ turns with the camera as $q$ does, and the depths act through one matrix:
#
# $$\dot s = -\Omega\times s - JV,\qquad J = D_s(q)\,Q .$$

# %%
Omega, V = ca.SX.sym("Omega", 3), ca.SX.sym("V", 3)
lower = ca.SX.sym("Q", ca.Sparsity.lower(3))
Q = ca.tril2symm(lower)
s_dot = lie_derivative(s, q, camera.centroid_rate(q, Omega, Q @ V))
assert prove_equal(s_dot, -skew(Omega) @ s - slope @ Q @ V, roots)
print("s' = -Ω×s - J V: proved")

# %% [markdown]
# While the camera turns in its place, $\dot q = -\Omega\times q$ and
# $\dot Q = Q\,\mathrm{sk}(\Omega) - \mathrm{sk}(\Omega)\,Q$, and $J$ turns along as $Q$ does:
#
# $$\dot J = J\,\mathrm{sk}(\Omega) - \mathrm{sk}(\Omega)\,J .$$
#
# So $RJR^\top$ depends on the position alone, as $RQR^\top$ does: what is shown of $J$ for a level
# camera holds for a tilted one. $J$ is not symmetric.

# %%
J = ca.jacobian(s, q) @ Q
Q_dot = Q @ skew(Omega) - skew(Omega) @ Q
state = ca.vertcat(q, ca.vertcat(*lower.nz))
turning = ca.vertcat(-skew(Omega) @ q, ca.vertcat(*ca.tril(Q_dot).nz))
J_dot = ca.reshape(lie_derivative(ca.vec(J), state, turning), 3, 3)
assert prove_equal(Q_dot, Q_dot.T)
assert prove_equal(J_dot, J @ skew(Omega) - skew(Omega) @ J, roots)
print("J turns with the camera: proved")

# %% [markdown]
# ## The same controller
#
# The error chain asks two things of $q$: that it turns with the camera, and that the depths act
# on it through one vector $y$. Both hold for $s$, with $y = JV$ in place of $QV$. So for each goal
# and each force the controller is that of the centroid, with $s$ for $q$ and $s^*$ for $q^*$.

# %%
for (feature, goal, force), law in LAWS.items():
    if feature == "scaled":
        ours, papers = derive_controller(law), derive_controller(LAWS["centroid", goal, force])
        old = ca.vertcat(papers.measured.vector(), papers.design.vector())
        new = ca.vertcat(ours.measured.vector(), ours.design.vector())
        theirs = ca.substitute(ca.vertcat(papers.thrust_rate, papers.torque), old, new)
        assert prove_equal(ca.vertcat(ours.thrust_rate, ours.torque), theirs)
        print(f"U and Γ of {law.name}: proved")

# %% [markdown]
# ## What to remember
#
# $s$ is a function of the image alone. It moves as $\dot s = -\Omega\times s - JV$ with
# $J = D_s(q)\,Q$, and everything that was derived for $q$ holds for $s$ with $J$ for $Q$, but for
# the symmetry of $Q$: $J$ has none.
