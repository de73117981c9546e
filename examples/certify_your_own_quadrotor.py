# %% [markdown]
# # Certify your own quadrotor
#
# A mission from scratch: describe a vehicle, prove its gains, read the certificate and check it,
# spoil a gain and get the counterexample, prove the bounds of $Q$ for the real target, and fly.

# %%
import json
import tempfile
import textwrap
from fractions import Fraction
from pathlib import Path

from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof import checker
from hoverproof.certification.gains import search_weights
from hoverproof.certification.over_box import certify_region, enclose
from hoverproof.certification.region import default_box
from hoverproof.show.decay import decay_along
from hoverproof.show.figures import features_figure, path_figure
from hoverproof.show.style import COLOURS, legend_above
from hoverproof.simulation.flight import summary

# %matplotlib inline

# %% [markdown]
# ## The vehicle
#
# A mission is one TOML file. The world has z **down**; positions are in the world frame. `bounds`
# is what is promised about the flight: the eigenvalues of $Q$, the matrix that holds the unknown
# distances, and the thrust stay in these intervals.

# %%
MISSION = """
name = "my-flyer"

[vehicle]
mass = 1.2                          # kg, battery included
inertia = [0.0115, 0.0120, 0.0210]  # kg m²
layout = "x"                        # of the rotors
arm = 0.17                          # m, rotor to centre of mass
drag_ratio = 0.016                  # m, drag torque of a rotor over its thrust
gravity = 9.81                      # m/s²

[target]
# four lamps on the ground, the corners of a square of side 1.2 m
points = [[0.6, 0.6, 0], [0.6, -0.6, 0], [-0.6, -0.6, 0], [-0.6, 0.6, 0]]

[goal]
height = 2.0                        # m above the lamps

[gains]
k1 = 0.4                            # kg m/s
k2 = 2.5                            # 1/m
k3 = 2.0                            # kg/s
k4 = 12                             # kg/s
k_yaw = 0.2                         # kg m²/s

[bounds]
eigenvalues = [0.08, 2.0]           # 1/m, of Q
thrust = [10.6, 12.95]              # N, about 0.9 to 1.1 times the weight

[start]
position = [1.0, -0.5, -2.5]        # m
"""

folder = tempfile.TemporaryDirectory()
path = Path(folder.name, "my-flyer.toml")
path.write_text(MISSION, encoding="utf-8")
mission = hp.load(path)
print(f"{mission.name}: {mission.vehicle.mass} kg, weight {float(mission.vehicle.weight):g} N")

# %% [markdown]
# Decimals are read as the exact fractions they are. What cannot be right is refused in one line:

# %%
try:
    hp.load(path, {"bounds.thrust": "[12, 13]"})
except hp.InputError as error:
    print(error.key, error.reason)

# %% [markdown]
# ## Certify

# %%
verdict = hp.certify(mission)
print(verdict.status)
print(f"every eigenvalue of Σ is above {float(verdict.margin):.6f} kg/s")
print(f"and the worst is no larger than {float(verdict.margin_above):.6f} kg/s")
print(f"L falls at least as fast as exp(-{float(verdict.decay_rate):.5f} t), t in s")
assert verdict.status == "proved"

# %% [markdown]
# ## Read the certificate
#
# It is a JSON object with exact numbers as strings. The hints in it (a multiplier $\tau$ and a
# margin for each end of the thrust factor) are all that the proof needs. Matrices are not stored:
# the checker builds them itself.

# %%
content = verdict.certificate.content
print(", ".join(content))
for vertex in content["vertices"]:
    print({key: f"{float(Fraction(value)):.4g}" for key, value in vertex.items()})

# %% [markdown]
# ## Check it
#
# `checker.py` is one file that uses the standard library alone. It accepts what was written:

# %%
saved = path.with_suffix(".cert.json")
verdict.certificate.save(saved)
theorem = hp.check(saved)
print(textwrap.fill(theorem.partition(": XᵀΣX")[0], 90), "...")

# %% [markdown]
# And it rejects what was tampered with. Here somebody claims twice the margin, and puts the
# hashes right:

# %%
forged = json.loads(json.dumps(content))
for part in (forged["claim"], *forged["vertices"]):
    for key in ("margin", "decay_rate"):
        part[key] = str(2 * Fraction(part[key]))
forged["statement"] = checker.statement(forged)
del forged["sha256"]
forged["sha256"] = checker.digest(forged)
try:
    checker.check(forged)
except checker.Rejected as reason:
    print("rejected:", reason)
else:
    raise AssertionError("a forged certificate was accepted")

# %% [markdown]
# ## Break it
#
# A $k_4$ that is too small looks harmless. Where does it start to be wrong? Every verdict below is
# exact: proved (filled) or refuted (open).

# %%
gains = [2, 3, 3.5, 4, 4.5, 5, 6, 8, 10, 12, 16, 22]
verdicts = [hp.certify(hp.load(path, {"gains.k4": str(k4)})) for k4 in gains]


def gain_figure():
    """Draw the worst eigenvalue of Σ over k4."""
    figure = Figure(figsize=(8, 3.6), layout="constrained")
    axes = figure.subplots()
    worst = [1e3 * float(v.margin_above) for v in verdicts]
    axes.plot(gains, worst, color=COLOURS[0], lw=1)
    for status, face in (("proved", COLOURS[0]), ("refuted", "white")):
        chosen = [i for i, v in enumerate(verdicts) if v.status == status]
        axes.plot(
            [gains[i] for i in chosen],
            [worst[i] for i in chosen],
            "o",
            color=COLOURS[0],
            mfc=face,
            label=status,
        )
    axes.axhline(0, color="black", lw=0.8)
    axes.set(xlabel="gain k4, kg/s", ylabel="worst eigenvalue of Σ, 10⁻³ kg/s", ylim=(-22, 10))
    legend_above(axes)
    return figure


gain_figure()

# %% [markdown]
# Take $k_4 = 3$. The counterexample is a $Q$, a thrust factor $f$ and an error $X$ in fractions,
# which the checker confirms as well:

# %%
weak = hp.certify(hp.load(path, {"gains.k4": "3"}))
checker.check(weak.certificate.content)
print(weak.status, f"XᵀΣX <= {float(weak.value):.4f} kg/s")
for key, value in weak.certificate.content["counterexample"].items():
    print(key, "=", value)

# %% [markdown]
# ## Are the bounds of Q true?
#
# $Q$ depends on where the vehicle is. Over a box around start and goal the eigenvalues are
# enclosed by branch and bound, and the mission's bounds are proved for this very target:

# %%
box = default_box(mission)
answer = certify_region(mission, box)
region = enclose(mission, box)
print(answer.status, "for", " x ".join(f"[{float(a):.2f}, {float(b):.2f}]" for a, b in box), "m")
print("proved there:", [float(x) for x in region.eigenvalues], "1/m")

# %% [markdown]
# The gains can rest on these bounds in place of the assumed ones. With good weights of $L$ on
# top, the proved decay gets faster. The gains are the same all the while.

# %%
better = hp.certify(mission, region=region)
best = hp.certify(mission, region=region, weights=search_weights(mission, region=region))
for name, v in (("assumed bounds", verdict), ("proved bounds", better), ("and weights", best)):
    print(f"{name:15} decay rate {float(v.decay_rate):.4f} 1/s, {v.status}")

# %% [markdown]
# ## Fly

# %%
flight = hp.simulate(mission)
result = summary(flight)
print(f"{result['outcome']}, {result['duration']:g} s, from {result['start_error']:.2f} m away")
print(f"to {1000 * result['final_error']:.1f} mm; within 10 % from {result['settled_at']:.1f} s on")
print(f"thrust {float(flight.thrust.min()):.2f} to {float(flight.thrust.max()):.2f} N")

# %%
path_figure(flight)

# %%
decay = decay_along(flight, better)
print(f"Q and thrust stay within the proved bounds until {decay.until:g} s, that is to the end")
assert decay.until == result["duration"]
features_figure(flight, decay)

# %% [markdown]
# ## What is known now
#
# While $Q$ and the thrust stay within their bounds and the vehicle does not turn about the
# vertical, $L$ falls at the proved rate, for the ideal rigid body. The flight above stayed within
# them; that *every* flight from a region of starts does is another theorem.

# %%
folder.cleanup()
