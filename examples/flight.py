# %% [markdown]
# # A flight in pictures
#
# The vehicle of Hamel and Mahony (2004) starts level and at rest at (5, 2.5, -4) m (z is down) and
# flies to 3 m above a square of four points, seeing nothing but these points. This example flies
# it, certifies its gains, and draws everything that the command `hoverproof simulate` draws.
#
# It needs IPython (`pip install ipython`), which shows the film; Jupyter has it.

# %%
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr
from IPython.display import Image, display

import hoverproof as hp
from hoverproof.show.animation import save_animation
from hoverproof.show.decay import decay_along
from hoverproof.show.figures import features_figure, motion_figure, path_figure
from hoverproof.show.runs import fans_figure, starts_figure
from hoverproof.simulation.flight import summary

# %matplotlib inline

# %% [markdown]
# ## Proof and flight

# %%
mission = hp.load("x4-flyer")
verdict = hp.certify(mission)
flight = hp.simulate(mission, every=10)  # a sample each 0.1 s

result = summary(flight)
print(f"gains: {verdict.status}")
print(f"flight: {result['outcome']}, {result['duration']:g} s")
print(f"distance from the goal: {result['start_error']:.3g} m, then {result['final_error']:.2g} m")
print(f"within 10 % of it from {result['settled_at']:g} s on")

# %% [markdown]
# ## Where it flew (the paper's Fig. 4)
#
# The frame's z points down. The picture has up on top, so both y and z run backwards in it:
# turning z alone around would show a mirror image.

# %%
path_figure(flight)

# %% [markdown]
# ## Motion (the paper's Fig. 5)
#
# Position, attitude, the thrust of each rotor, and the angle of the farthest target point off the
# optical axis: twice its maximum is the field of view that the camera needs for this flight. All
# of the tilting happens in the first seconds, so those stand alongside.

# %%
motion_figure(flight)

# %% [markdown]
# ## What the camera sees, and the errors
#
# The certified line is what the proof says for every eigenvalue of $Q$ and every thrust within the
# bounds of the mission. `decay_along` looks up whether this flight keeps to them, and until when.
# The flight is much faster than the line, which holds for the worst $Q$ there may be.

# %%
decay = decay_along(flight, verdict)
print(f"{decay.label()}; this flight keeps to the bounds until {decay.until:g} s")
bound = decay.bound(flight["time"].values, float(flight["lyapunov"][0]))
assert (flight["lyapunov"].values <= bound).all()
features_figure(flight, decay)

# %% [markdown]
# ## A film
#
# The same as `hoverproof simulate x4-flyer --animate flight.gif --speed-up 300`; a file that ends
# in `.mp4` (with ffmpeg) or `.html` works as well.

# %%
with tempfile.TemporaryDirectory() as folder:
    film = Path(folder) / "flight.gif"
    save_animation(flight, film, speed_up=300)
    display(Image(data=film.read_bytes(), format="gif"))

# %% [markdown]
# ## Many flights
#
# Starts all around the target, in heights from 2 to 8 m.

# %%
generator = np.random.default_rng(1)
starts = generator.uniform([-6, -6, -8], [6, 6, -2], (24, 3))
flights = [
    hp.simulate(hp.load("x4-flyer", {"start.position": start.round(3).tolist()}), every=750)
    for start in starts
]
kept = ["position", "euler_angles", "lyapunov", "rotor_thrust"]
batch = xr.concat([f[kept] for f in flights], "run", combine_attrs="drop_conflicts")
batch.attrs |= {name: flight.attrs[name] for name in ("mission", "goal_position")}
batch["outcome"] = ("run", [f.attrs["outcome"] for f in flights])
print(sorted(set(batch["outcome"].values.tolist())))

# %%
fans_figure(batch)

# %%
starts_figure(batch)
