# %% [markdown]
# # 13. A vehicle that is not the modelled one
#
# A real vehicle has another mass, thrust and inertia than the controller believes, flies in wind,
# and sees the target late and with noise. This part takes the errors of the *true* vehicle, lets it
# fly under the controller with *its* knowledge, and shows what is left in the rates. The goal is
# straight below.
#
# Each `assert` below is an exact proof for all values of all symbols. The motion, the errors and
# the controllers come from the package, which differentiates; only the claimed closed forms are
# typed.

# %%
from dataclasses import replace

import casadi as ca

from hoverproof.algebra.identity import prove_equal, prove_zero
from hoverproof.algebra.linear import lie_derivative
from hoverproof.plant import rigid_body
from hoverproof.plant.rate_loop import loop_torque, rate_command
from hoverproof.plant.rigid_body import E3, skew
from hoverproof.servo.laws.hamel_mahony import LAWS
from hoverproof.servo.uncertain import derive_uncertain_loop

# %% [markdown]
# ## What is given
#
# Vectors are in body axes. *Feature* means $q$ or, in its place, the scaled $s$ of part 12.
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $s$, $s_3^*$ | present feature, and the third component of the wanted one | 1 |
# | $y = JV$ | how the velocity moves the feature; unknown | 1/s |
# | $V$, $\Omega$, $\rho$ | velocity, angular velocity, direction of gravity | m/s, rad/s, 1 |
# | $m$, $g$ | mass that the controller has, and gravity | kg, m/s² |
# | $m_r$, $T_r$, $w$ | true mass and thrust; a steady force of the wind, world axes | kg, N, N |
# | $R$ | body to world | 1 |
# | $\tilde T = mT_r/m_r$, $\tilde w = mR^\top w/m_r$ | both, as forces on the mass $m$ | N |
# | $k_1, k_2, k_3, k_4$ | gains | kg m/s, 1/m, kg/s, kg/s |
# | $c = k_1^2k_2/m$, $\kappa = (k_1k_2+k_3)/m$, $\beta = 1/(c\kappa)$ | | N, 1/s, s/N |
# | $\pi = I - e_3e_3^\top$ | drops the third component | 1 |
#
# The true force on the mass $m$ is $F = -\tilde Te_3 + mg\rho + \tilde w$: it makes
# $\dot V = -\Omega\times V + F/m$ true.

# %%
m, m_r, T_r, g = ca.SX.sym("m"), ca.SX.sym("m_r"), ca.SX.sym("T_r"), ca.SX.sym("g")
rho, w_b, V, Omega = (ca.SX.sym(name, 3) for name in ("rho", "w_b", "V", "Omega"))
F = -m * T_r / m_r * E3 + m * g * rho + m * w_b / m_r
V_dot = -skew(Omega) @ V + (-T_r * E3 + m_r * g * rho + w_b) / m_r
assert prove_equal(V_dot, rigid_body.acceleration(V, Omega, F, m))
print("the true force on the mass m: proved")

# %% [markdown]
# What is unknown, each of it in bounds, and each may change in time:
#
# | symbol | meaning | unit |
# | --- | --- | --- |
# | $\varsigma$ | $\dot{\tilde T} = \varsigma\,U$ | 1 |
# | $n$ | error of $\delta_1$, used less present, less $\frac m{k_1}$ times that of $V$ | 1 |
# | $b$ | force that it uses, less the true one, over $c$ | 1 |
# | $\chi = D/D_c$ | true lever over that of the controller | 1 |
# | $\psi$ | $\dot D_c$ less what the controller takes for it, over $D_c$ | 1/s |
# | $\gamma$, $G$ | what becomes of the commanded angular acceleration $\alpha$, see below | 1 |
# | $\dot\Omega_3$, $\Omega_3$ | anything | rad/s², rad/s |
#
# $\gamma$ and $G$ are 2 × 2 matrices of
#
# $$e_3\times\dot\Omega = (I + \gamma)\,e_3\times\alpha + \Omega_3\,G\,(e_3\times\Omega) .$$
#
# The levers are $D = \tilde T - c\,s_3$ and $D_c = T_c - c\,s_3$ with the thrust $T_c$ that the
# controller takes, and $s_3 = s_3^*$ for a goal in the image, $0$ for one fixed to the vertical.
#
# The errors are those of the true vehicle, with the lever that the controller has:
#
# $$\delta_1 = s - s_3^*e_3\ \text{ or }\ s - s_3^*\rho,\quad \delta_2 = \frac m{k_1}V - \delta_1,
# \quad \delta_3 = \frac1cF + \delta_2,\quad
# \delta_4 = \beta D_c\,e_3\times\Omega + \pi\delta_3 .$$

# %%
LOOPS = {law: derive_uncertain_loop(law) for law in LAWS.values()}
for law, loop in LOOPS.items():
    d, e, body, known = loop.design, loop.errors, loop.body, loop.known
    c, kappa, goal = d.stiffness, (d.k1 * d.k2 + d.k3) / d.mass, d.goal_centroid[2] * E3
    F = -body.thrust * E3 + d.mass * d.gravity * body.gravity_direction + loop.wind
    s3 = goal[2] if law.goal.name == "image" else 0
    T_c = known.thrust if law.force.name == "modelled" else -d.mass * known.specific_force[2]
    lean = E3 if law.goal.name == "image" else body.gravity_direction
    assert prove_equal(e.d1, body.centroid - goal[2] * lean)
    assert prove_equal(e.d2, d.mass / d.k1 * body.velocity - e.d1)
    assert prove_equal(e.d3, F / c + e.d2)
    turned = (T_c - c * s3) / (c * kappa) * skew(E3) @ body.rate
    assert prove_equal(ca.vertcat(e.d4, 0), turned + ca.vertcat(e.d3[:2], 0))
    assert prove_equal(loop.doubt.lever_ratio, (body.thrust - c * s3) / (T_c - c * s3))
    assert prove_equal(loop.doubt.force, (law.force.force(known, d) - F) / c)
    seen, speed = law.errors(known, d).d1 - e.d1, known.velocity - body.velocity
    assert prove_equal(loop.doubt.feature, seen - d.mass / d.k1 * speed)
print("δ1, δ2, δ3, δ4, χ, n and b as defined, for all eight laws: proved")

# %% [markdown]
# ## What the controller has in their place
#
# Feature, velocity, vertical and force that it uses may all be wrong; the body rates are taken as
# they are. Where $\delta_2$, $\delta_3$ and $\delta_4$ are, it has, with $r = n - b$,
#
# $$\delta_2 - n,\qquad \delta_3 - r,\qquad \delta_4 - \pi r .$$
#
# Of $\delta_1$ itself it makes no use. So it commands, with $\zeta = \delta_4 - \pi\delta_3$,
#
# $$U = c\,\kappa\,e_3^\top(\delta_3 - r),\qquad e_3\times\Omega = \frac{c\,\kappa}{D_c}\,\zeta .$$

# %%
for law, loop in LOOPS.items():
    d, e, n, b = loop.design, loop.errors, loop.doubt.feature, loop.doubt.force
    r, zeta = n - b, e.d4 - e.d3[:2]
    has = law.errors(loop.known, d)
    assert prove_equal(
        ca.vertcat(has.d2, has.d3, has.d4), ca.vertcat(e.d2 - n, e.d3 - r, e.d4 - r[:2])
    )
    c, kappa = d.stiffness, (d.k1 * d.k2 + d.k3) / d.mass
    D_c = law.lever(law.force.thrust(loop.known, d), d)
    assert prove_equal(loop.thrust_rate, c * kappa * (e.d3 - r)[2])
    assert prove_equal((skew(E3) @ loop.body.rate)[:2], c * kappa / D_c * zeta)
print("the errors that the controller has, U, and the body rates, for all eight laws: proved")

# %% [markdown]
# ## How the errors move
#
# With $h = c\,\kappa/D_c$, $p_1 = h\,e_3^\top\delta_3$, $p_2 = h\,e_3^\top r$, and
# $p_3 = (\dot D_c^{\rm law} - U)/D_c$, where $\dot D_c^{\rm law}$ is what the controller takes for
# $\dot D_c$:
#
# $$\begin{aligned}
# \dot\delta_1 &= -\Omega\times\delta_1 - y + s_3h\,\zeta,\\
# \dot\delta_2 &= -\Omega\times\delta_2 + y + \tfrac{k_1k_2}m(\delta_3-\delta_2) - s_3h\,\zeta,\\
# \dot\delta_3 &= -\Omega\times\delta_3 + y + \tfrac{k_1k_2}m(\delta_3-\delta_2)
#   + \kappa\,\chi\,\zeta - \varsigma\,\kappa\,e_3e_3^\top(\delta_3 - r),\\
# \dot\delta_4 &= \pi y - \kappa\,\pi\delta_3 - \tfrac{k_4}m\delta_4
#   + \big(\kappa + \tfrac{k_4}m\big)\pi r - \tfrac{k_1k_2}m\pi b - \Omega_3\,e_3\times\pi r\\
#  &\quad + \big(\psi + \kappa(\chi - 1) + p_2\big)\zeta + \gamma\,\sigma + \Omega_3\,G\,\zeta,\\
# \sigma &= -\big(\kappa + \tfrac{k_4}m\big)(\delta_4 - \pi r)
#   - \tfrac{k_1k_2}m\pi(\delta_3-\delta_2+b)\\
#  &\quad - \big(2(p_1 - p_2) + p_3\big)\zeta + \Omega_3\,e_3\times\pi(\delta_3 - r) .
# \end{aligned}$$
#
# $\sigma = \beta D_c\,e_3\times\alpha$ is what is commanded. The yaw acceleration is in none of
# them.

# %%
quarter, pi = skew(E3), ca.SX.eye(3) - E3 @ E3.T


def flat(a):
    """Return a horizontal vector of two numbers as one of three."""
    return ca.vertcat(a, 0)


def closed_form(law, loop):
    """Return the rates as they stand above."""
    d, e, doubt = loop.design, loop.errors, loop.doubt
    n, b, Omega, y = doubt.feature, doubt.force, loop.body.rate, loop.motion.depth_flow
    gamma, G = (ca.reshape(a, 2, 2) for a in (doubt.angular_gain, doubt.gyroscopic))
    c, kappa, damping = d.stiffness, (d.k1 * d.k2 + d.k3) / d.mass, d.k4 / d.mass
    s3 = d.goal_centroid[2] if law.goal.name == "image" else 0
    D_c = law.lever(law.force.thrust(loop.known, d), d)
    d1, d2, d3, d4 = e.d1, e.d2, e.d3, flat(e.d4)
    r, zeta, h = n - b, d4 - pi @ d3, c * kappa / D_c
    p1, p2, p3 = h * d3[2], h * r[2], taken(law, loop) / D_c
    pull, k12 = d.k1 * d.k2 / d.mass * (d3 - d2), d.k1 * d.k2 / d.mass
    sigma = -(kappa + damping) * (d4 - pi @ r) - pi @ (pull + k12 * b)
    sigma += -(2 * (p1 - p2) + p3) * zeta + Omega[2] * quarter @ pi @ (d3 - r)
    d4_dot = pi @ y - kappa * pi @ d3 - damping * d4 + (kappa + damping) * pi @ r
    d4_dot += -k12 * pi @ b - Omega[2] * quarter @ pi @ r
    d4_dot += (doubt.lever_drift + kappa * (doubt.lever_ratio - 1) + p2) * zeta
    d4_dot += flat(gamma @ sigma[:2] + Omega[2] * G @ zeta[:2])
    lift = doubt.thrust_gain * kappa * E3 * (d3 - r)[2]
    return ca.vertcat(
        -ca.cross(Omega, d1) - y + s3 * h * zeta,
        -ca.cross(Omega, d2) + y + pull - s3 * h * zeta,
        -ca.cross(Omega, d3) + y + pull + kappa * doubt.lever_ratio * zeta - lift,
        d4_dot[:2],
    )


def taken(law, loop):
    """Return what the controller takes for the rate of its lever, less U."""
    if law.force.name == "modelled":
        return ca.SX(0)
    return loop.design.mass * (skew(loop.body.rate) @ loop.known.specific_force)[2]


for law, loop in LOOPS.items():
    assert prove_equal(loop.rate, closed_form(law, loop))
    print(f"δ1', δ2', δ3', δ4' of {law.name}: proved")

# %% [markdown]
# Without doubt, $\varsigma = \chi = 1$ and all others zero, this is the loop of part 5, or of
# part 11. Of the unknowns, $\varsigma$, $\chi$, $\psi$, $\gamma$ and $G$ are multiplied by errors:
# they cost margin and move nothing. Only $n$ and $b$ stand alone.
#
# ## With the measured force
#
# Let the vertical be known. An exact accelerometer shows $a = (\tilde w - \tilde Te_3)/m$. Then, in
# any steady wind,
#
# $$b = 0,\quad \chi = 1 + \frac{e_3^\top\tilde w}{D_c},\quad
# p_3 = \frac{e_3^\top(\Omega\times\tilde w)}{D_c},\quad \psi = (\varsigma - 1)(p_1 - p_2) .$$
#
# The turn of the body under the wind is in $p_3$, which the controller knows and makes up for; it
# is not in $\psi$.

# %%
for law, loop in LOOPS.items():
    if law.force.name == "measured":
        d, doubt, known, Omega = loop.design, loop.doubt, loop.known, loop.body.rate
        shown = (loop.wind - loop.body.thrust * E3) / d.mass
        measured = ca.vertcat(known.specific_force, known.gravity_direction)
        true = ca.vertcat(shown, loop.body.gravity_direction)

        def at(expression, measured=measured, true=true):
            """Return an expression with what exact sensors show."""
            return ca.substitute(expression, measured, true)

        D_c, U = at(law.lever(law.force.thrust(known, d), d)), at(loop.thrust_rate)
        state = ca.vertcat(loop.body.thrust, loop.wind)
        flow = ca.vertcat(doubt.thrust_gain * U, -skew(Omega) @ loop.wind)
        psi = (lie_derivative(D_c, state, flow) - U - at(taken(law, loop))) / D_c
        assert prove_zero(at(doubt.force))
        assert prove_equal(at(doubt.lever_ratio), 1 + loop.wind[2] / D_c)
        assert prove_equal(at(taken(law, loop)), (skew(Omega) @ loop.wind)[2])
        p1, p2 = at(loop.motion.sinking), at(loop.motion.sinking_by_error)
        assert prove_equal(psi, (doubt.thrust_gain - 1) * (p1 - p2))
print("b, χ, p3 and ψ of the measured force: proved")

# %% [markdown]
# ## With the modelled force
#
# The controller's thrust is the integral of $U$, so $\psi = p_3 = 0$. But, the vertical known,
#
# $$b = \frac1c\big((\tilde T - T_c)\,e_3 - \tilde w\big)$$
#
# is no small thing: with another mass, thrust or wind it is not zero at rest, and moves the hover.

# %%
for law, loop in LOOPS.items():
    if law.force.name == "modelled":
        off = (loop.body.thrust - loop.known.thrust) * E3 - loop.wind
        b = ca.substitute(
            loop.doubt.force, loop.known.gravity_direction, loop.body.gravity_direction
        )
        assert prove_equal(b, off / loop.design.stiffness)
print("b of the modelled force: proved")

# %% [markdown]
# ## Wrong moments of inertia
#
# The torque is computed with the moments $I_i$ and acts on the moments $I_i'$. With
# $\Delta_i = I_i - I_i'$,
#
# $$\gamma = \begin{pmatrix} I_2/I_2' - 1 & 0\\ 0 & I_1/I_1' - 1\end{pmatrix},\qquad
# G = \begin{pmatrix} 0 & (\Delta_3-\Delta_1)/I_2'\\ (\Delta_2-\Delta_3)/I_1' & 0\end{pmatrix} .$$
#
# $G$ is multiplied by $\Omega_3$: it counts while the vehicle yaws.

# %%
own, true, alpha = ca.SX.sym("I", 3), ca.SX.sym("I_true", 3), ca.SX.sym("alpha", 3)
state = replace(rigid_body.RigidBodyState.symbols(), rate=Omega)
torque = own * alpha + skew(Omega) @ (own * Omega)
none = {"thrust_rate": ca.SX(0), "mass": ca.SX(1), "gravity": ca.SX(0)}
Omega_dot = rigid_body.state_rate(state, torque=torque, inertia=true, **none).rate
delta = own - true
gamma = ca.diag(ca.vertcat(own[1] / true[1] - 1, own[0] / true[0] - 1))
G = ca.SX(2, 2)
G[0, 1], G[1, 0] = (delta[2] - delta[0]) / true[1], (delta[1] - delta[2]) / true[0]
turned = (quarter @ alpha)[:2]
claimed = turned + gamma @ turned + Omega[2] * G @ (quarter @ Omega)[:2]
assert prove_equal((quarter @ Omega_dot)[:2], claimed)
print("γ and G of wrong moments of inertia: proved")

# %% [markdown]
# ## An autopilot's rate loop
#
# Most autopilots take body rates in place of torques, and answer about as
#
# $$\dot\Omega = \omega\,(\Omega_c - \Omega)$$
#
# with $\omega$ a diagonal matrix of bandwidths, whatever the inertia. Let the law command
# $\Omega_c = \Omega + \alpha/\omega_r$, of a bandwidth $\omega_r$ that it believes. Then
# $\dot\Omega = \omega\alpha/\omega_r$: this is
#
# $$\gamma = \begin{pmatrix}\omega_2/\omega_r - 1 & 0\\ 0 & \omega_1/\omega_r - 1\end{pmatrix},
# \qquad G = 0 .$$
#
# So a loop whose bandwidths are within a share $x$ of $\omega_r$ is covered by torques within $x$.
# That law and loop have the same $\Omega$, at the same time, is assumed.

# %%
omega, omega_r = ca.SX.sym("omega", 3), ca.SX.sym("omega_r")
commanded = rate_command(Omega, alpha, omega_r)
torque = loop_torque(commanded, Omega, omega, true)
Omega_dot = rigid_body.state_rate(state, torque=torque, inertia=true, **none).rate
gamma = ca.diag(ca.vertcat(omega[1], omega[0]) / omega_r - 1)
assert prove_equal((quarter @ Omega_dot)[:2], turned + gamma @ turned)
assert prove_equal(Omega_dot, omega * alpha / omega_r)
print("γ and G of a rate loop: proved")

# %% [markdown]
# ## What to remember
#
# Errors of mass, thrust and inertia multiply errors of the chain. With the measured force, so does
# steady wind: at rest nothing of it is left. What is used and not true, $n$ and $b$, is what the
# vehicle stays away from its goal by.
#
# ## What is not claimed
#
# * That the motion converges: this is for a Lyapunov function to show, over bounds of the unknowns.
# * A thrust that drifts by itself, as with a battery, or a torque that is not zero when none is
#   commanded: these move the hover as $b$ does.
# * A rate loop of higher order, or one that takes its commands late or in steps.
