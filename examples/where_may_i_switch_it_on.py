# %% [markdown]
# # Where may I switch it on?
#
# `hp.certify` proves that $L$ falls *while* the eigenvalues of $Q$ and the thrust stay in their
# bounds. A pilot asks something else: from *here*, will it come to its goal? This example shows
# why the first answer says almost nothing about the second, what takes its place, and what a
# certified region of starts looks like.

# %%
import subprocess
import sys
import tempfile
import textwrap
from fractions import Fraction
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof import checker
from hoverproof.certification.attraction.potential import Potential
from hoverproof.certification.attraction.verdict import NOT_COVERED
from hoverproof.servo.linearised import slowest_rate
from hoverproof.show.attraction import attraction_figure
from hoverproof.show.style import COLOURS, legend_above
from hoverproof.show.trade_off import trade_off_figure
from hoverproof.simulation.flight import summary

# %matplotlib inline

mission = hp.load("x4-flyer")
potential = Potential.of(mission)
flight = hp.simulate(mission)
print(f"start {[float(c) for c in mission.start.position]} m, goal {potential.goal} m (z is down)")

# %% [markdown]
# ## Why the level sets of L do not help
#
# The usual argument: $L$ falls in a level set $\{L\le\ell\}$, so nothing leaves it, so everything
# in it converges. It needs a level set that is bounded, and on which the assumed bounds hold.
#
# But $L$ is made of image errors, and the image of a target far away is a point: each direction
# $p_i$ has length one, however far the target is. Straight up, $q \to (0, 0, n)$ and
# $|\delta_1| \to n - q_3^*$, so a level above $\frac12(n - q_3^*)^2$ holds states at any
# height. There the smallest eigenvalue of $Q$ tends to zero, and the bounds fail.

# %%
largest = (potential.target.weights.sum() - potential.q3) ** 2 / 2
at_start = float(flight.lyapunov[0])
print(f"largest level with a bounded set: (n - q3*)²/2 = {largest:.4f}")
print(f"L at the start of the mission: {at_start:.4f}, {at_start / largest:.0f} times as much")

# %% [markdown]
# ## The sum of distances
#
# In world axes $-q$ is the gradient of $\Phi(\xi) = \sum_i|P_i - \xi|$, the sum of the distances to
# the target points, which nobody has to know. So
#
# $$W(\xi) = \Phi(\xi) - \Phi(\xi^*) + q_3^*\,(z - z^*)$$
#
# is a potential whose lowest point is the goal. It is convex (its Hessian is $Q$) and it grows
# without end in every direction. With the weighted squares of the other errors,
#
# $$\Lambda = W + \tfrac12(a_2|\delta_2|^2 + a_3|\delta_3|^2 + a_4|\delta_4|^2),$$
#
# every level set is bounded in position, and $\dot\Lambda < 0$ can be shown without any lower
# bound of $Q$ and for any yaw rate (part 9 of the derivation).

# %%
away = np.linspace(0.0, 12.0, 200)
directions = {"up": (0, 0, -1), "sideways": (1, 0, 0), "down, to the target": (0, 0, 1)}


def potential_figure():
    """Draw |δ1|²/2 and W of level hovers along three directions from the goal."""
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    for (name, direction), colour, style in zip(
        directions.items(), COLOURS, ("-", "--", "-."), strict=False
    ):
        last = away[-1] if direction[2] < 1 else 3.0  # the target is 3 m below the goal
        at = away[away <= last]
        terms = potential.hover_terms(potential.goal + at[:, None] * np.array(direction))
        left.plot(at, terms[:, 1], style, color=colour, label=name)
        right.plot(at, terms[:, 0], style, color=colour)
    left.axhline(largest, color="black", lw=0.8, ls=":", label="(n - q3*)²/2")
    left.set_ylim(0, 0.6)
    left.set(xlabel="distance from the goal, m", ylabel="½|δ1|², dimensionless")
    right.set(xlabel="distance from the goal, m", ylabel="W, m", ylim=(0, 12))
    right.grid(alpha=0.3)
    legend_above(left, columns=2)
    return figure


potential_figure()

# %% [markdown]
# On the left what $L$ sees: straight up it never passes the dotted line. On the right $W$, which
# tells far from near.
#
# ## The barrier
#
# What is left to fear is the target itself: near a point $Q$ is infinite, and no gain dominates it.
# One can choose a level so low that the set stays clear of the points. But a vehicle that starts
# from hover does not sink to its target, either: the lower it is, the smaller the sum of the
# heights over the distances gets, and that drives it up. Where the inner loops are damped well
# ($k_3 \ge 3k_1k_2$) this can be made a theorem, a *barrier*: a height below which no motion comes
# that starts from hover above it. Level, weights and barrier must fit each other; `hp.attraction`
# finds them by semidefinite programs and proves them in exact arithmetic.
#
# Two starts are asked for: the paper's own, and a hover 20 m off and 20 m up.

# %%
print(f"k3 = {float(mission.gains.k3)} kg/s,", end=" ")
print(f"3 k1 k2 = {float(3 * mission.gains.k1 * mission.gains.k2):g} kg/s")
far = hp.Start.hover(Fraction(20), Fraction(0), Fraction(-20))  # x, y, z in m
region = hp.attraction(mission, starts=[hp.Start.of(mission), far])
print(f"{region.status}: from every level hover with Λ <= {float(region.level):.1f} m", end=" ")
print(f"at least {float(region.barrier_height):.3f} m above the target,")
print(f"so about the goal {float(region.reach.sideways):.0f} m to each side,", end=" ")
print(f"{float(region.reach.up):.0f} m up and {float(region.reach.down):.2f} m down;")
print(f"the tilt stays below {np.degrees(float(region.tilt)):.2f}°,", end=" ")
print("the thrust in [{:.1f}, {:.1f}] N".format(*map(float, region.thrust)))
print(f"and Q below {float(region.largest_eigenvalue):.2f} 1/m")

a = np.array([1, *(float(weight) for weight in region.weights)])
for start in region.starts:
    place = np.array([side[0] for side in start.position], float)
    print(f"Λ at {place} m is {(potential.hover_terms(place[None]) @ a)[0]:.1f} m: inside")

# %% [markdown]
# Both are inside, with room to spare. The picture shows the certified hovers in a plane through
# goal and start and in space, and $\Lambda$ along simulated flights from hovers all over the
# window. A flight from a start that is not certified may arrive as well: what is not shown is not
# refuted. The orange line is all that the level sets of $L$ would give.

# %%
attraction_figure(region)

# %% [markdown]
# ## Believe nobody
#
# The certificate holds weights, level, multipliers and the height of the barrier, as fractions.
# The checker, one file of plain Python, derives everything else itself: here in a process of its
# own, without this package and without site packages.

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder, "x4-flyer.attraction.cert.json")
    region.certificate.save(path)
    command = [sys.executable, "-I", "-S", checker.__file__, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    size = path.stat().st_size
print(f"a file of {size} bytes, status {done.returncode}")
print("\n".join(textwrap.wrap(region.certificate.statement, 90)[:9]), "...")

# %% [markdown]
# ## Starts that move
#
# Nobody switches on from a perfect hover. A set of starts is a box of positions with bounds of
# speed, tilt, rates of roll and pitch, and thrust error, with any heading and yaw rate. It takes
# gains with more authority than the paper's: here $k_1 = 1$ kg m/s and $k_4 = 10$ kg/s, five times
# as fast. (The matrix $\Sigma$ of `hp.certify` is *refuted* for these gains and the bounds that the
# mission assumes. That is no contradiction: $L$ may rise, $\Lambda$ does not.)

# %%
faster = hp.load("x4-flyer", {"gains.k1": "1", "gains.k4": "10"})
moving = hp.Start(
    position=((Fraction("-0.5"), Fraction("0.5")),) * 2 + ((Fraction(-4), Fraction(-3)),),  # m
    speed=Fraction("0.1"),  # m/s
    tilt=Fraction("0.01"),  # rad
    rate=Fraction("0.01"),  # rad/s
)
print(f"Σ: {hp.certify(faster).status};", end=" ")
faster_region = hp.attraction(faster, objective="radius", starts=[moving], barrier=False)
print(f"attraction: {faster_region.status}, all of the set is inside")
print(f"about the goal {float(faster_region.reach.sideways):.2f} m to each side,", end=" ")
print(f"{float(faster_region.reach.up):.1f} m up, {float(faster_region.reach.down):.2f} m down")

# %% [markdown]
# A flight from one corner of it, at the edge of all bounds:

# %%
corner = hp.load(
    "x4-flyer",
    {
        "gains.k1": "1",
        "gains.k4": "10",
        "start.position": "[0.5, 0.5, -3]",
        "start.velocity": "[0.1, 0, 0]",
        "start.rotation": "[0.01, 0, 2]",  # roll, pitch, yaw
        "start.rates": "[0.01, 0, 0.5]",
    },
)
flown = summary(hp.simulate(corner))
print(f"{flown['outcome']}, {1000 * flown['final_error']:.1f} mm from the goal after", end=" ")
print(f"{flown['duration']:.0f} s")

# %% [markdown]
# ## Region against speed
#
# Fast gains ask for more tilt, and more of the region is lost to keeping thrust and tilt in
# bounds. Without a barrier, so that moving starts count too, this is how far hovers are certified
# for three sets of gains (`hoverproof tune x4-flyer --objective region --pareto 6` finds the best
# gains for each speed):

# %%
fast = hp.load("x4-flyer", {"gains.k1": "1.5", "gains.k2": "5", "gains.k3": "30", "gains.k4": "30"})
regions = [
    hp.attraction(mission, objective="radius", barrier=False),
    faster_region,
    hp.attraction(fast, objective="radius", barrier=False),
]
assert all(r.status == "proved" for r in regions)
for r in regions:
    print(f"k1 = {float(r.mission.gains.k1):g} kg m/s:", end=" ")
    print(f"slowest motion {slowest_rate(r.mission):.4f} 1/s,", end=" ")
    print(f"{float(r.reach.sideways):.2f} m sideways")
trade_off_figure(regions)

# %% [markdown]
# Gains that `hp.tune` makes for the largest decay rate of $L$ are another matter: with
# $k_3 < 3 k_1 k_2$ there is no barrier, and what is certified without one is small. The start of
# this preset is neither proved nor refuted, and the answer says what stood in the way and what
# would help; nearer to the goal there is a region. The two theorems want different gains.

# %%
small = hp.load("x4-flyer-tuned")
answer = hp.attraction(small)
print(answer.status)
print(textwrap.fill(answer.reason, 90))
print(*(textwrap.fill(f"would help: {line}", 90) for line in answer.advice), sep="\n")
near = hp.attraction(small, objective="radius")
print(f"{near.status}: hovers {100 * float(near.reach.sideways):.1f} cm sideways,", end=" ")
print(f"{100 * float(near.reach.up):.0f} cm up, {100 * float(near.reach.down):.0f} cm down")

# %% [markdown]
# ## What is not covered

# %%
print("\n".join(f"- {line}" for line in NOT_COVERED))
