# %% [markdown]
# # 2. What the camera sees
#
# The camera sits in the vehicle and looks down. It sees $n$ points of a target that does not
# move. Here the image is put on a sphere, the points are added up to one vector $q$, and it is
# shown how $q$ moves. All that is unknown, the depths, ends up in one symmetric matrix $Q$.
#
# Each `assert` below is an exact proof for all values of all symbols, by comparing quotients of
# polynomials; the model comes from the package and only the claimed closed form is typed.

# %%
import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.rigid_body import RigidBodyState, skew

# %% [markdown]
# ## Symbols
#
# | symbol | meaning | frame | unit |
# | --- | --- | --- | --- |
# | $\xi$, $R$ | position of the camera; rotation from camera axes to world axes | world | m, 1 |
# | $V$, $\Omega$ | velocity and angular velocity of the camera | camera | m/s, rad/s |
# | $P_i^\circ$ | a point of the target, at rest | world | m |
# | $P_i = R^\top(P_i^\circ - \xi)$ | the same point | camera | m |
# | $r_i = \lvert P_i\rvert$ | its distance, the *depth*, not measured | | m |
# | $p_i = P_i/r_i$ | direction to it, a point of the unit sphere | camera | 1 |
# | $\pi_p = I - p\,p^\top$ | projection onto the plane tangent to the sphere at $p$ | camera | 1 |
# | $q = \sum_i p_i$ | the centroid of the image | camera | 1 |
#
# Camera frame and body frame are the same. The world is at rest, the body moves with
# $\dot\xi = R V$ and $\dot R = R\,\mathrm{sk}(\Omega)$, where $\mathrm{sk}(a)\,b = a\times b$.
#
# ## A point seen from the moving camera
#
# $$\dot P = -\mathrm{sk}(\Omega)\,P - V .$$
#
# Since $R^\top R = I$ is needed, $R$ is written with four numbers $s = (s_0, \vec s) \ne 0$, a
# quaternion, for which that holds identically. Every rotation has this form:
#
# $$R(s) = \frac{(s_0^2 - |\vec s|^2)\,I + 2\,\vec s\,\vec s^\top + 2 s_0\,\mathrm{sk}(\vec s)}
# {s_0^2 + |\vec s|^2}.$$

# %%
body = RigidBodyState.symbols()
motion = rigid_body.state_rate(
    body,
    torque=ca.SX.sym("Gamma", 3),
    thrust_rate=ca.SX.sym("U"),
    mass=ca.SX.sym("m"),
    inertia=ca.SX.sym("J", 3),
    gravity=ca.SX.sym("g"),
)
s = ca.SX.sym("s", 4)
s0, sv = s[0], s[1:]
identity = ca.SX.eye(3)
R = ((s0**2 - ca.sumsqr(sv)) * identity + 2 * sv @ sv.T + 2 * s0 * skew(sv)) / ca.sumsqr(s)
assert prove_equal(R.T @ R, identity)

target_point = ca.SX.sym("P_world", 3)
seen = camera.body_points(target_point, body.position, body.rotation)
seen_dot = lie_derivative(seen, body.vector(), motion.vector())
closed = -skew(body.rate) @ seen - body.velocity
assert prove_equal(
    ca.substitute(seen_dot, body.rotation, R), ca.substitute(closed, body.rotation, R)
)
print("P' = -Ω × P - V: proved for every rotation R(s)")

# %% [markdown]
# From here on $P$, $V$ and $\Omega$ are symbols of their own, and $\dot P$ is what was just
# proved.
#
# ## From the pinhole image to the sphere
#
# A pinhole camera of focal length 1 gives $(x, y) = (P_1/P_3,\ P_2/P_3)$. With
# $\sigma = \sqrt{x^2 + y^2 + 1}$ the point of the sphere is
#
# $$p = \frac1\sigma\,(x, y, 1)^\top = \frac{P}{r}, \qquad r = P_3\,\sigma = |P| .$$
#
# This is where the point has to be in front of the camera: $P_3 > 0$ makes $r > 0$. No depth is
# needed to compute $p$.

# %%
P, V, Omega = ca.SX.sym("P", 3), ca.SX.sym("V", 3), ca.SX.sym("Omega", 3)
x, y = P[0] / P[2], P[1] / P[2]
sigma = ca.SX.sym("sigma")
roots = {sigma: x**2 + y**2 + 1}  # sigma stands for the positive root of this
r = P[2] * sigma

assert prove_equal(camera.pinhole(P), ca.vertcat(x, y))
assert prove_equal(camera.spherical(camera.pinhole(P)), P / r, roots)
assert prove_equal(r**2, ca.sumsqr(P), roots)
print("the point of the sphere is p = P/r: proved")

# %% [markdown]
# ## How a point of the sphere moves
#
# $$\dot p = -\mathrm{sk}(\Omega)\,p - \pi_p\,\frac{V}{r} .$$
#
# The first term is the turning of the camera, the same for all points. The second is the flow
# that tells near points from far ones.

# %%
r = ca.SX.sym("r")
roots = {r: ca.sumsqr(P)}  # r = |P|
p = P / r
P_dot = -skew(Omega) @ P - V
p_dot = lie_derivative(P / ca.norm_2(P), P, P_dot)
projection = identity - p @ p.T

assert prove_equal(p_dot, -skew(Omega) @ p - projection @ V / r, roots)
print("p' = -Ω × p - π_p V/r: proved")

# %% [markdown]
# Mind the sign: fly to the right, and what you look at drifts to the left. (Hamel and Mahony,
# 2004, print a plus sign in their eq. 6. With it the equation is false; their eq. 8 for $q$ has
# the right sign.)

# %%
assert not prove_equal(p_dot, -skew(Omega) @ p + projection @ V / r, roots)
print("p' = -Ω × p + π_p V/r: refuted")

# %% [markdown]
# ## How the centroid moves
#
# Adding up over the points gives
#
# $$\dot q = -\Omega\times q - Q V, \qquad Q = \sum_i \frac{\pi_{p_i}}{r_i}\ \ \text{in 1/m.}$$
#
# $Q$ holds all that is unknown. Two points are enough for a proof, since both sides are sums over
# the points; a third would only add a term of the same kind.

# %%
points = ca.SX.sym("P", 3, 2)
distance = ca.SX.sym("r", 2)
roots = {distance[i]: ca.sumsqr(points[:, i]) for i in range(2)}
directions = ca.horzcat(*(points[:, i] / ca.norm_2(points[:, i]) for i in range(2)))
points_dot = -skew(Omega) @ points - ca.repmat(V, 1, 2)

q = camera.centroid(directions)
q_dot = lie_derivative(q, ca.vec(points), ca.vec(points_dot))
Q = camera.depth_matrix(points)

assert prove_equal(q_dot, -skew(Omega) @ q - Q @ V, roots)
assert prove_equal(q_dot, camera.centroid_rate(q, Omega, Q @ V), roots)
print("q' = -Ω × q - Q V: proved")

# %% [markdown]
# In the rest of these notes $Q$ meets the model only as the vector $y = Q V$, the *depth flow*,
# in 1/s.
#
# ## Q is positive definite
#
# For every vector $x$
#
# $$x^\top Q\,x = \sum_i \frac{|p_i\times x|^2}{r_i} .$$
#
# So $Q$ is never negative, and it is zero only in a direction $x$ parallel to all $p_i$ at once.
# Unless the camera and all target points lie on one line, $Q > 0$.

# %%
x = ca.SX.sym("x", 3)
p1, p2 = directions[:, 0], directions[:, 1]
r1, r2 = distance[0], distance[1]
squares = ca.sumsqr(ca.cross(p1, x)) / r1 + ca.sumsqr(ca.cross(p2, x)) / r2
assert prove_equal(x.T @ Q @ x, squares, roots)
print("xᵀQx = Σ |p × x|²/r: proved")

# %% [markdown]
# Since $|p\times x|^2 = |x|^2 - (p^\top x)^2 \le |x|^2$, no eigenvalue of $Q$ is above
# $\sum_i 1/r_i$. Their sum is $2\sum_i 1/r_i$. Far away all eigenvalues are small and the
# eigenvalue along the line of sight is smaller still: sizes in the image then hardly tell the
# distance.

# %%
assert prove_equal(ca.sumsqr(ca.cross(p1, x)), ca.sumsqr(x) - ca.dot(p1, x) ** 2, roots)
assert prove_equal(ca.trace(Q), 2 / r1 + 2 / r2, roots)
print("|p × x|² = |x|² - (p·x)² and trace Q = Σ 2/r: proved")

# %% [markdown]
# ## A potential behind it
#
# Let $\Phi(\xi) = \sum_i |P_i^\circ - \xi|$ be the sum of the distances to the target points. The
# centroid is its slope and $Q$ its curvature, seen in camera axes:
#
# $$R\,q = -\nabla\Phi(\xi), \qquad R\,Q\,R^\top = \nabla^2\Phi(\xi) .$$
#
# So $\Phi$ is convex, and the eigenvalues of $Q$ depend on where the camera is, not on how it is
# turned. One point is enough here: both sides are sums again.

# %%
xi = body.position
ray = target_point - xi
roots = {r: ca.sumsqr(ray)}  # r is the distance of the point
hessian, gradient = ca.hessian(ca.norm_2(ray), xi)
seen = camera.body_points(target_point, xi, R)
q = camera.centroid(seen / ca.norm_2(seen))

assert prove_zero(R @ q + gradient, roots)
assert prove_equal(R @ camera.depth_matrix(seen) @ R.T, hessian, roots)
print("R q = -∇Φ and R Q Rᵀ = ∇²Φ: proved for every rotation R(s)")

# %% [markdown]
# ## What to remember
#
# $$\dot q = -\Omega\times q - Q V, \qquad Q = Q^\top > 0 .$$
#
# The vehicle measures $q$, never $Q$. A control law may use that $Q$ is symmetric and that its
# eigenvalues lie between two known bounds, and nothing else.
