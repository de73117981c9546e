# %% [markdown]
# # Why sampling eigenvalues is no proof
#
# The gains of the controller are good if a matrix $\Sigma(Q, T)$ is positive definite for **every**
# symmetric $Q$ with eigenvalues in an interval $[\lambda_-, \lambda_+]$ and every thrust $T$ in
# an interval. It is tempting to try: draw many $Q$ at random, check the corners
# $Q = \mathrm{diag}(\lambda_\pm, \lambda_\pm, \lambda_\pm)$, and if all is well, believe it.
#
# Here gains are looked for that pass 100 000 random $Q$ and all corners, and that are yet wrong,
# with a counterexample in fractions. They are found by computation, below, and not typed in.

# %%
import itertools
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof import checker
from hoverproof.algebra.definite import is_positive_definite
from hoverproof.certification.problem import gain_problem, sigma_function
from hoverproof.servo.variables import Design
from hoverproof.show.style import COLOURS, legend_above

# %matplotlib inline

# %% [markdown]
# ## A small quadrotor
#
# All numbers are fixed but the gain $k_2$.

# %%
MISSION = """
name = "sampled"
[vehicle]
mass = 1.2                          # kg
inertia = [0.0115, 0.0120, 0.0210]  # kg m²
layout = "x"                        # of the rotors
arm = 0.17                          # m
drag_ratio = 0.016                  # m
gravity = 9.81                      # m/s²
[target]
points = [[0.6, 0.6, 0], [0.6, -0.6, 0], [-0.6, -0.6, 0], [-0.6, 0.6, 0]]  # m
[goal]
height = 2.0                        # m
[gains]
k1 = 0.21                           # kg m/s
k2 = 7.5                            # 1/m
k3 = 0.4                            # kg/s
k4 = 70                             # kg/s
k_yaw = 0.2                         # kg m²/s
[bounds]
eigenvalues = [0.2, 3.4]            # 1/m, of Q
thrust = [10.6, 12.95]              # N
[start]
position = [0.5, -0.3, -2.2]        # m
"""


def mission(k2):
    """Return the mission with a gain k2, 1/m, in three decimals."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "sampled.toml")
        path.write_text(MISSION)
        return hp.load(path, {"gains.k2": f"{k2:.3f}"})


# %% [markdown]
# ## Checking by samples
#
# $\Sigma$ is affine in $Q$ and in the thrust factor $f(T)$, so both ends of $f$ suffice, and
# $\Sigma$ of many $Q$ is one product of arrays. The samples have random axes (uniform over all
# rotations) and random eigenvalues (uniform in the interval).

# %%
SAMPLES = 100_000
random = np.random.default_rng(2004)
low, high = (float(x) for x in mission(7.5).bounds.eigenvalues)


def matrices(eigenvalues, axes):
    """Return Q = Σ λ a aᵀ, (n, 3, 3), from eigenvalues (n, 3) and axes (n, 3, 3), columns."""
    return np.einsum("nij,nj,nkj->nik", axes, eigenvalues, axes)


axes, _ = np.linalg.qr(random.normal(size=(SAMPLES, 3, 3)))
sampled = matrices(random.uniform(low, high, (SAMPLES, 3)), axes)
corners = np.array([np.diag(c) for c in itertools.product((low, high), repeat=3)])


def lowest(problem, Q):
    """Return the lowest eigenvalue of Σ, kg/s, over both ends of f, for each Q, (n,)."""
    design = [float(x) for x in Design.values(problem.mission, problem.goal.centroid_midpoint)]
    by_end = []
    for f in map(float, problem.factor):

        def sigma(lower, f=f):
            return np.array(sigma_function()(design, [1] * 4, lower, f)[0])

        constant = sigma(np.zeros(6))
        slopes = np.array([sigma(unit) - constant for unit in np.eye(6)])
        lower = np.stack([Q[:, i, j] for j in range(3) for i in range(j, 3)], axis=1)
        by_end.append(np.linalg.eigvalsh(constant + np.tensordot(lower, slopes, 1))[:, 0])
    return np.minimum(*by_end)


# %% [markdown]
# ## Where the samples say yes and the proof says no
#
# For each $k_2$ there are three answers: from the corners, from the samples, and from `certify`,
# which is exact. At $k_2 = 7.5$ all say yes, at 5 and at 12 all say no. Where does each change?
# Bisection finds out, to three decimals. (The samples that are worst at 7.5 are worst nearby too,
# so a few thousand of them find the place; all of them confirm it below.)

# %%
hardest = sampled[np.argsort(lowest(gain_problem(mission(7.5)), sampled))[:3000]]


def passes(Q):
    """Return the test whether Σ has no negative eigenvalue at any of the Q, as a function of k2."""
    return lambda k2: lowest(gain_problem(mission(k2)), Q).min() > 0


def proved(k2):
    """Tell whether the gains are proved."""
    return hp.certify(mission(k2)).status == "proved"


def last_good(is_good, bad, good=7500):
    """Return the last k2 in thousandths, on the way from a good one to a bad one, that is good."""
    assert is_good(good / 1000) and not is_good(bad / 1000)
    while abs(good - bad) > 1:
        middle = (bad + good) // 2
        bad, good = (bad, middle) if is_good(middle / 1000) else (middle, good)
    return good / 1000


tests = {"corners": passes(corners), "samples": passes(hardest), "proof": proved}
found = {name: (last_good(test, 5000), last_good(test, 12000)) for name, test in tests.items()}
for name, (first, last) in found.items():
    print(f"{name} say{'s' if name == 'proof' else ''} yes for k2 from {first} to {last} 1/m")
firsts, lasts = zip(*found.values(), strict=True)
assert list(firsts) == sorted(firsts) and list(lasts) == sorted(lasts, reverse=True)

# %% [markdown]
# Every $k_2$ that the samples let pass and the proof does not is a trap. Take one in the middle:

# %%
k2 = round((found["samples"][0] + found["proof"][0]) / 2, 3)
trap = gain_problem(mission(k2))
verdict = hp.certify(trap.mission)

of_samples, of_corners = lowest(trap, sampled), lowest(trap, corners)
print(f"k2 = {k2} 1/m")
print(f"lowest eigenvalue of Σ over {len(corners)} corners:    {of_corners.min():.2e} kg/s")
print(f"lowest eigenvalue of Σ over {SAMPLES} samples: {of_samples.min():.2e} kg/s")
print(f"certify: {verdict.status}, lowest is {float(verdict.margin_above):.2e} kg/s or less")
assert of_samples.min() > 0 and of_corners.min() > 0 and verdict.status == "refuted"

# %% [markdown]
# ## The counterexample
#
# `certify` gives a $Q$, a thrust factor $f$ and an error $X$, in fractions. What makes them a
# counterexample can be checked by hand: both $Q - \lambda_- I$ and $\lambda_+ I - Q$ are positive
# definite, and $X^\top\Sigma X < 0$. The stand-alone checker builds $\Sigma$ from its own few
# lines.

# %%
Q = verdict.Q
lam_low, lam_high = trap.mission.bounds.eigenvalues
for sign, end in ((1, lam_low), (-1, lam_high)):
    room = [
        [sign * (Q[i][j] - (end if i == j else Fraction(0))) for j in range(3)] for i in range(3)
    ]
    assert is_positive_definite(room)
checker.check(verdict.certificate.content)
print("Q lies within the bounds, and the checker accepts the counterexample")
for key, value in verdict.certificate.content["counterexample"].items():
    print(key, "=", value)

# %% [markdown]
# ## Why they miss it
#
# The worst $Q$ has two eigenvalues at $\lambda_+$ and one at $\lambda_-$, and the axis $w$ of the
# small one is *tilted*: $Q = \lambda_+ I - (\lambda_+ - \lambda_-)\,w w^\top$. Below is the
# lowest eigenvalue of $\Sigma$ over the angle between $w$ and the vertical (all directions around
# the vertical are alike here, since the wanted centroid is vertical). Corners look only along the
# axes, at 0° and 90°. The random ones come near, but hardly ever all three at once: both large
# eigenvalues at their end, the small one at its end, and the axis at its angle.

# %%
angles = np.radians(np.linspace(0, 90, 361))
w = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=1)
tilted = high * np.eye(3) - (high - low) * np.einsum("ni,nj->nij", w, w)
of_tilted = lowest(trap, tilted)
assert np.isclose(of_tilted.min(), float(verdict.margin_above), rtol=1e-2)

values, vectors = np.linalg.eigh(sampled)
angle_of_sample = np.degrees(np.arccos(np.abs(vectors[:, 2, 0])))
worst_angle = float(np.degrees(angles[of_tilted.argmin()]))
print(f"worst where the axis of the small eigenvalue is tilted by {worst_angle:.1f}°")


def axis_figure():
    """Draw the lowest eigenvalue of Σ over the tilt of the axis of the small eigenvalue of Q."""
    figure = Figure(figsize=(8, 4.2), layout="constrained")
    for axes, size in zip(figure.subplots(1, 2), (2, 6), strict=True):
        axes.plot(
            angle_of_sample,
            1e3 * of_samples,
            ".",
            ms=size,
            color=COLOURS[5],
            label="random Q",
            rasterized=True,
        )
        axes.plot(np.degrees(angles), 1e3 * of_tilted, color=COLOURS[1], label="tilted axis")
        axes.plot([0, 90], 1e3 * of_tilted[[0, -1]], "s", color=COLOURS[0], label="corners")
        axes.axhline(0, color="black", lw=0.8)
        axes.set_ylim(-5, 60)
        legend_above(axes, columns=3)
    axes.get_legend().remove()
    axes.set_xlim(worst_angle - 12, worst_angle + 12)
    axes.set_ylim(1.5e3 * of_tilted.min(), -3.5e3 * of_tilted.min())
    axes.set_title("the same, near zero", fontsize=10)
    figure.supxlabel("tilt of the axis of the smallest eigenvalue of Q, degrees", fontsize=10)
    figure.supylabel("lowest eigenvalue of Σ, 10⁻³ kg/s", fontsize=10)
    return figure


axis_figure()

# %% [markdown]
# ## All three, over the gain
#
# Where the orange line is below zero the gains are refuted. The corners and the samples lie above
# it: they are always too kind, and by how much cannot be told from them. In the shaded spans the
# samples say yes although the gains are refuted.

# %%
gains = np.linspace(6.4, 9.1, 55)
exact, by_samples, by_corners = [], [], []
for k in gains:
    problem = gain_problem(mission(k))
    exact.append(float(hp.certify(problem.mission).margin_above))
    by_samples.append(lowest(problem, hardest).min())
    by_corners.append(lowest(problem, corners).min())


def gain_figure():
    """Draw what the three ways find, over k2."""
    figure = Figure(figsize=(8, 4.2), layout="constrained")
    axes = figure.subplots()
    for span in zip(found["samples"], found["proof"], strict=True):
        axes.axvspan(*span, color=COLOURS[4], alpha=0.25, lw=0)
    axes.plot(gains, 1e3 * np.array(by_corners), "--", color=COLOURS[0], label="corners")
    axes.plot(gains, 1e3 * np.array(by_samples), "-.", color=COLOURS[2], label="samples")
    axes.plot(gains, 1e3 * np.array(exact), color=COLOURS[1], label="exact")
    axes.axhline(0, color="black", lw=0.8)
    axes.set_xlabel("gain k2, 1/m")
    axes.set_ylabel("lowest eigenvalue of Σ, 10⁻³ kg/s")
    axes.set_ylim(-5, 6)
    legend_above(axes)
    return figure


gain_figure()

# %% [markdown]
# ## Better samples?
#
# One who knows that the worst $Q$ has its eigenvalues at the ends can draw only such $Q$. That
# finds the trouble here:

# %%
ends = matrices(random.choice([low, high], (SAMPLES, 3)), axes)
of_ends = lowest(trap, ends)
print(f"eigenvalues at the ends only: lowest {of_ends.min():.2e} kg/s")
print(f"{np.sum(of_ends < 0)} of {SAMPLES} such samples are negative")

# %% [markdown]
# But to know where to look *is* the theorem, and a sample that finds nothing is still no proof:
# it leaves open what lies between the samples. `certify` needs no samples. It decides one matrix
# inequality that holds exactly when $\Sigma \succ 0$ for every $Q$ (see the last step of the
# derivation), and either answer, yes or no, is confirmed in fractions.
