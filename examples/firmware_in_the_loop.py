# %% [markdown]
# # Firmware in the loop
#
# `hp.export_c` writes the certified controller as C99 for a microcontroller. Here it is exported
# for the paper's vehicle with its tuned gains, read, compiled for this computer, compared bit by
# bit and number by number with the model, flown, and handed the faults that a real flight has in
# store.
#
# The C is compiled with `cc` (or what `$CC` names); where there is no compiler, what needs one is
# left out.

# %%
import re
import tempfile
import textwrap
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof.export.flight_law import flight_law
from hoverproof.export.package import NotCertified
from hoverproof.export.precision import PRECISIONS
from hoverproof.export.vectors import law_at, random_step
from hoverproof.plant.goal import hover_goal
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.variables import Design
from hoverproof.show.style import COLOURS, STYLES, legend_above
from hoverproof.simulation.flight import summary

# %matplotlib inline

# %% [markdown]
# ## Export
#
# The gains are certified first, and the certificate goes with the code. That the C computes the
# derived controller is decided at each export by exact rational arithmetic, all numbers of the
# mission in place; then each number is rounded once to the precision of the target.

# %%
mission = hp.load("x4-flyer-tuned")
home = tempfile.TemporaryDirectory()
folders = {precision: Path(home.name, precision) for precision in PRECISIONS}
manifests = {p: hp.export_c(mission, folders[p], precision=p) for p in PRECISIONS}
manifest, folder = manifests["float32"], folders["float32"]
name = manifest["name"]
print(f"{name}: {len(manifest['files'])} files, certified: {manifest['certified']}")
print("certificate", manifest["certificate_sha256"][:16], "law", manifest["law_sha256"][:16], "...")
for path in (f"{name}.h", f"{name}.c", f"{name}_params.h", f"{name}_selftest.c"):
    print(f"{len((folder / path).read_text().splitlines()):4} lines  {path}")
theorem = hp.check(folder / f"{name}.cert.json")
print("the certificate beside it:", " ".join(theorem.split())[:75], "...")

# %% [markdown]
# Gains that are not proved are refused, and nothing is written:

# %%
try:
    hp.export_c(hp.load("x4-flyer-tuned", {"gains.k4": "0.1"}), Path(home.name, "refused"))
except NotCertified as error:
    print(textwrap.fill(str(error), 90))
assert not Path(home.name, "refused").exists()

# %% [markdown]
# ## Read it
#
# The whole law is one function without a branch: some constants, each with the formula it comes
# from, then the image, the errors, the torque and the rotors. The only library call is the square
# root.

# %%
source = (folder / f"{name}.c").read_text()
print(re.search(r"static void control_law\(.*?^}", source, flags=re.S | re.M)[0])

# %% [markdown]
# Around it there are checks: of the input, of the state, of the limits. One step is one call.

# %%
print(re.search(rf"^uint32_t {name}_step\(.*?^}}", source, flags=re.S | re.M)[0])

# %% [markdown]
# ## Compile it
#
# `hp.Firmware` compiles a package with the package's own flags and loads it: the same C that goes
# on the vehicle, with no other code between. The self-test holds a few steps with what must come
# of them, bit for bit.

# %%
try:
    firmware = {p: hp.Firmware(folders[p]) for p in PRECISIONS}
except hp.InputError as error:  # no C compiler here
    firmware = {}
    print(error)
for precision, compiled in firmware.items():
    print(f"{precision}: self-test {compiled.selftest():d} (0: every vector holds, bit for bit)")

# %% [markdown]
# ## Bit for bit
#
# The self-test holds a handful of vectors. Here are a thousand random steps near hover: the law is
# evaluated by numpy, one operation after the other, each rounded to the type of the target, and
# each output of the compiled C must be the same number. (Fused products would break it; that is
# why the flags forbid them.)

# %%
STEPS = 1000
law = flight_law(mission)


def steps_of(precision):
    """Yield random steps near hover, in numbers of a precision."""
    draw = np.random.default_rng(1)
    for _ in range(STEPS):
        yield random_step(draw, mission, PRECISIONS[precision], "points", mission.bounds.thrust)


def run(compiled, step):
    """Let firmware take a step; return thrust rate, torque and rotors, (8,), and the output."""
    compiled.thrust_excess = float(step.excess)
    out = compiled.step(
        step.seen.T,
        velocity=step.velocity,
        rate=step.rate,
        gravity_direction=step.gravity_direction,
        dt=step.dt,
    )
    return np.array([out.thrust_rate, *out.torque, *out.rotor]), out


for precision, compiled in firmware.items():
    compiled.set_rotor_limits(0, 2.4 * float(mission.vehicle.weight))  # so that none is limited
    same = taken = 0
    for step in steps_of(precision):
        found, out = run(compiled, step)
        if out.status & 32:  # a rotor was brought to its limit: not the bare law
            continue
        expected = law_at(law, step, PRECISIONS[precision])
        want = [*expected["thrust_rate"], *expected["torque"], *expected["rotor"]]
        taken, same = taken + 1, same + int((found == np.array(want, float)).all())
    print(f"{precision}: {same} of {taken} steps the same in every bit")
    assert same == taken > STEPS / 2

# %% [markdown]
# ## Against the model
#
# The model, a CasADi graph, computes the same function in another order, so its numbers differ by
# rounding, and only by that. The differences below are relative to the largest value of each
# output, rounded up to a power of ten, beside the spacing of the numbers of each type.

# %%
controller = derive_controller()
design = [float(v) for v in Design.values(mission, hover_goal(mission).centroid_midpoint)]
weight = float(mission.vehicle.weight)


def model(step):
    """Return thrust rate and torque of the model's controller, (4,), in float64."""
    rays = np.vstack([step.seen, np.ones(step.seen.shape[1])])
    q = (rays / np.linalg.norm(rays, axis=0)).sum(axis=1)
    measured = [
        *q,
        *step.velocity,
        *step.gravity_direction,
        *step.rate,
        weight + float(step.excess),
    ]
    return np.vstack([np.array(part) for part in controller.function()(measured, design)])[:, 0]


steps = list(steps_of("float32"))  # numbers that both types hold
answers = {"model": np.array([model(step) for step in steps])}
for precision, compiled in firmware.items():
    answers[precision] = np.array([run(compiled, step)[0][:4] for step in steps])
scale = np.abs(answers["model"]).max(axis=0)
for one, other, precision in (("float64", "model", "float64"), ("float32", "float64", "float32")):
    if one in answers:
        apart = np.abs(answers[one] - answers[other]).max(axis=0) / scale
        spacing = float(np.finfo(precision).eps)
        bound = 10.0 ** np.ceil(np.log10(apart.max()))
        print(f"{one} against {other}: below {bound:.0e}; spacing of {precision}: {spacing:.1e}")

# %% [markdown]
# ## Fly it
#
# The controller runs 1000 times a second, its outputs are held in between, and the ideal rigid body
# moves. In the simulation of the model the controller acts continuously. So what separates the two
# flights is sampling; what separates float32 from float64 is rounding.

# %%
for compiled in firmware.values():
    compiled.set_rotor_limits(*manifest["rotor_limits"])
ideal = hp.simulate(mission, step=0.001)
flights = {p: hp.fly_firmware(mission, compiled, step=0.001) for p, compiled in firmware.items()}
for flight_name, flight in {"model": ideal, **flights}.items():
    flown = summary(flight)
    print(
        f"{flight_name}: {flown['outcome']}, within 10 % after {flown['settled_at']:.2f} s,",
        end=" ",
    )
    print(f"{1000 * flown['final_error']:.2f} mm away after {flown['duration']:g} s")
for precision, flight in flights.items():
    raised = int(np.bitwise_or.reduce(flight.firmware_status.values))
    print(f"{precision}: status bits that came up: {raised}")


# %%
def apart_figure():
    """Draw the distance of the flights from the goal and from each other."""
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    for (label, flight), colour, style in zip(
        {"model": ideal, **flights}.items(), COLOURS, STYLES, strict=False
    ):
        error = np.linalg.norm(flight.position.values - flight.attrs["goal_position"], axis=1)
        left.semilogy(flight.time, error, style, color=colour, label=label, lw=2)
    pairs = {"sampling: float64 and model": ("float64", ideal)}
    if flights:
        pairs["rounding: float32 and float64"] = ("float32", flights["float64"])
    for (label, (one, other)), colour, style in zip(
        pairs.items(), COLOURS[3:], STYLES, strict=False
    ):
        if one in flights:
            gap = flights[one].position.values - other.position.values
            size = np.linalg.norm(gap, axis=1)[1:]
            right.semilogy(other.time[1:], size, style, color=colour, label=label)
    left.set(xlabel="time, s", ylabel="distance from the goal, m")
    right.set(xlabel="time, s", ylabel="distance of two flights, m")
    legend_above(left, columns=3)
    legend_above(right, columns=1)
    return figure


apart_figure()

# %% [markdown]
# ## Faults
#
# On board nothing may be trusted. Each step answers with a status, a sum of bits. 1, 2 and 4 are
# faults: the outputs are then the thrust of hover, spread evenly, and no torque. Outputs are always
# finite. 8 and 16 tell that what the theorem assumes does not hold at this moment; 32 that a rotor
# is at its limit.

# %%
header = (folder / f"{name}.h").read_text()
bits = re.findall(rf"#define {name.upper()}_(\w+) \(\(uint32_t\)(\d+)U\)\s*/\* (.*?) \*/", header)
for bit, value, meaning in bits:
    print(f"{value:>3}  {bit:10} {meaning}")

# %%
half = float(max(abs(x) for x in mission.target.points[0][:2]))  # of the square's side, m
image = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * half / float(mission.goal.height)
calm = {"velocity": [0, 0, 0], "rate": [0, 0, 0], "gravity_direction": [0, 0, 1], "dt": 0.001}
low, high = manifest["thrust"]
cases = {
    "hover at the goal": {},
    "a velocity that is no number": {"velocity": [np.nan, 0, 0]},
    "an image point at infinity": {"seen": np.where(image == image[0], np.inf, image)},
    "a gyroscope beyond all reason": {"rate": [0, 0, 1000]},
    "no time since the last step": {"dt": 0.0},
    "target lost": {"target_seen": False},
    "thrust 5 % above the certified": {"excess": 1.05 * high - weight},
    "thrust near the singularity": {"excess": -0.9 * weight},
    "upside down": {"gravity_direction": [0, 0, -1]},
    "20 m/s sideways, still allowed": {"velocity": [20, 0, 0]},
}


def told(status):
    """Name the bits of a status."""
    return " ".join(bit for bit, value, _ in bits if status & int(value) and bit != "FAULT") or "OK"


for what, case in cases.items():
    if not firmware:
        break
    compiled = firmware["float32"]
    compiled.reset()
    given = {**calm, **case}
    if "excess" in given:
        compiled.thrust_excess = given.pop("excess")
    out = compiled.step(given.pop("seen", image), **given)
    torque = max(map(abs, out.torque))
    rotors = f"[{min(out.rotor):.2f}, {max(out.rotor):.2f}] N"
    print(f"{what:31} {told(out.status):9} rotors {rotors:16} torque {torque:.2f} N m")
    assert np.isfinite([*out.rotor, *out.torque, out.thrust]).all()

# %% [markdown]
# What is *not* monitored: the eigenvalues of $Q$, since nothing on board measures depths, and that
# the vehicle does not turn about its vertical, which the theorem assumes.
#
# ## What it costs
#
# The package promises budgets for a Cortex-M4F, which is what a Crazyflie has (168 MHz):

# %%
budgets = manifest["budgets"]
CLOCK = 168e6  # Hz
share = budgets["instructions"] * 1000 / CLOCK
print(f"{budgets['target']}:")
print(
    f"at most {budgets['instructions']} instructions a step, {budgets['stack_bytes']} bytes of",
    end=" ",
)
print(f"stack, {budgets['flash_bytes']} bytes of flash")
print(f"so at 1 kHz and one instruction a cycle about {100 * share:.2f} % of the processor")

# %% [markdown]
# Divisions, square roots and memory take more than a cycle, so the true share is larger.
#
# ## On the target
#
# `tests/test_firmware_target.py` runs the same package on an emulated Cortex-M4F and Cortex-M7
# (QEMU). There, too, the self-test passes, and steps and a whole flight have the same bits as on
# this computer; the budgets hold (instructions counted, stack and flash measured); no soft double
# and no library function is linked in. Other tests in that file let cppcheck's MISRA addon and
# Frama-C's Eva read the source, and a fuzzer call it. `benchmarks/` counts the instructions beside
# those of C written by hand. An emulator is no board: the timing, sensors and wires of a real one
# are not tested.

# %%
home.cleanup()
