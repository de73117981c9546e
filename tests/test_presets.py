"""The presets fly: proved, tuned as they say, settled in time, rotors and thrust within limits."""

from __future__ import annotations

import re
import shlex
from fractions import Fraction

import numpy as np
import pytest

from firmware_kit import export, tool
from hoverproof.certification.gains import certify
from hoverproof.certification.verdict import Proved
from hoverproof.design.start_tuning import settled_in_flight
from hoverproof.design.tuning import tune
from hoverproof.export.binding import Firmware
from hoverproof.firmware.flying import fly_firmware
from hoverproof.mission.presets import preset_text, presets
from hoverproof.mission.reading import load
from hoverproof.mission.writing import mission_text
from hoverproof.simulation.flight import simulate, summary
from once import start_or_ball_once
from papers_law import PAPERS
from sampling import mostly_whole

SETTLES = {"crazyflie-2.1": 18, "racer-250": 22, "research-1.5kg": 17, "x4-flyer-tuned": 135}
"""Within a tenth of the distance at the start, for good, s."""

MOST_THRUST = {
    "crazyflie-2.1": 2.130295e-11 * 65535**2 + 1.032633e-6 * 65535 + 5.48456e-4,
    "racer-250": 1.91e-6 * 2200**2,
    "research-1.5kg": 5.84e-6 * 1100**2,
    "x4-flyer-tuned": 9.6 * 9.8 / 2,  # the paper gives no limit; twice the thrust of hover
}
"""Of one rotor, N, from the sources that the presets name."""


BUILT = ("crazyflie-2.1", "racer-250", "research-1.5kg")
"""Those of vehicles that are built, with the law that `new` recommends."""


def command(name):
    """Return the options of the tune command that a preset states."""
    words = shlex.split(re.search(r"# hoverproof tune (.*)", preset_text(name))[1])
    assert words[0] == name
    options = dict(zip(words[1::2], words[2::2], strict=True))
    objective = options.pop("--objective", "start")
    limits = {k[2:].replace("-", "_"): float(v) for k, v in options.items()}
    return {"objective": objective, **limits}


def test_every_preset_but_the_paper_s_is_tuned():
    assert set(presets()) == {"x4-flyer", "x4-flyer-tuned", *BUILT}


# --- vehicles that are built --------------------------------------------------------------------


@pytest.mark.parametrize("name", BUILT)
def test_the_tolerances_cover_what_the_preset_flies_with(name):
    mission = load(name)
    sensors, covered = mission.sensors, mission.uncertainty
    age = sensors.latency + 1 / sensors.frame_rate + 1 / sensors.control_rate
    assert age <= covered.latency < age + Fraction("0.002")
    assert covered.rotor_lag >= mission.rotors.time_constant
    assert float(mission.rotors.max_thrust) == pytest.approx(MOST_THRUST[name], rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_whole(BUILT, every=3, first=1))
def test_a_preset_is_proved_from_its_start_and_flies_there_in_a_time_like_the_proved(name):
    mission = load(name)
    assert certify(mission).status == "proved"
    proof, _ = start_or_ball_once(mission)
    assert proof.status == "proved"
    assert proof.field_of_view <= mission.camera.half_angle
    least, most = proof.rotor_thrust
    assert 0 < least < most < float(mission.rotors.max_thrust)
    time = float(proof.settling.time)
    flown = settled_in_flight(mission, float(proof.settling.radius), time)
    assert time / 4 < flown < time


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_whole(BUILT, every=3, first=2))
def test_the_firmware_of_a_preset_flies_as_the_model_with_its_sensors(name):
    tool("cc")
    mission = load(name)
    model = simulate(mission, duration=10)
    flown = fly_firmware(mission, duration=10)
    assert flown.attrs["outcome"] == "flown"
    way = np.linalg.norm(model["position"].values[-1] - model["position"].values[0])
    apart = np.linalg.norm(flown["position"].values[-1] - model["position"].values[-1])
    assert apart < 0.02 * way


# --- the law of the paper -----------------------------------------------------------------------


@pytest.mark.parametrize("name", SETTLES)
def test_a_vehicle_is_certified_and_settles_in_time_within_its_limits(name):
    mission = load(PAPERS[name])
    assert isinstance(certify(mission), Proved)
    flight = simulate(mission)
    result = summary(flight)
    assert result["outcome"] == "flown"
    assert result["settled_at"] < SETTLES[name]
    lowest, highest = result["rotor_thrust"]
    assert lowest > 0
    assert highest < MOST_THRUST[name]
    low, high = (float(t) for t in mission.bounds.thrust)
    thrust = flight["thrust"].values
    assert low < thrust.min()
    assert thrust.max() < high


@pytest.mark.parametrize("name", SETTLES)
def test_along_the_flight_q_stays_in_the_bounds_and_l_falls_as_fast_as_proved(name):
    mission = load(PAPERS[name])
    rate = float(certify(mission).decay_rate)
    flight = simulate(mission)
    rays = np.array(mission.target.points, float) - flight["position"].values[:, None]
    distance = np.linalg.norm(rays, axis=2)[..., None, None]
    p = rays[..., None] / distance
    Q = ((np.eye(3) - p * p.swapaxes(2, 3)) / distance).sum(axis=1)
    eigenvalues = np.linalg.eigvalsh(Q)
    low, high = (float(e) for e in mission.bounds.eigenvalues)
    assert low < eigenvalues.min() <= eigenvalues.max() < high
    level, time = flight["lyapunov"].values, flight["time"].values
    good = level > 1e-12 * level[0]
    assert (level[good] <= level[0] * np.exp(-rate * time[good]) * (1 + 1e-9)).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", SETTLES)
def test_the_firmware_of_a_vehicle_flies_as_the_model_until_it_has_settled(name, tmp_path):
    """Outputs held for a step are all that differs, so a tenth of the step is a tenth as far."""
    tool("cc")
    limits = (0, Fraction(MOST_THRUST[name]))
    export(tmp_path, PAPERS[name], precision="float64", rotor_limits=limits)
    firmware, seconds = Firmware(tmp_path), SETTLES[name]
    ideal = simulate(load(PAPERS[name]), duration=float(seconds), step=0.001, every=1000)
    way = np.linalg.norm(ideal["position"].values[-1] - ideal["position"].values[0])
    far = []
    for step in (1e-3, 1e-4):
        firmware.reset()
        flown = firmware.fly(step, seconds, round(1 / step))
        assert flown["any_status"] == 0  # no fault, no rotor at its limit
        assert 0 < flown["rotor"].min() <= flown["rotor"].max() < MOST_THRUST[name]
        far.append(np.abs(flown["state"][:, :3] - ideal["position"].values).max())
    assert far[0] < 1e-3 * way, far
    assert far[1] < 0.11 * far[0], far


@pytest.mark.slow
def test_the_command_that_a_preset_states_gives_its_gains():
    name = "x4-flyer-tuned"
    assert tune(load(name), **command(name)).mission.gains == load(name).gains


@pytest.mark.slow
@pytest.mark.whole  # CI tunes the README's vehicle for its start
@pytest.mark.parametrize("name", BUILT)
def test_the_command_that_a_preset_states_gives_gains_as_fast_as_its_own(name):
    """Where the best is flat, others are as good: the last digits are those of one machine."""
    tuned = tune(load(name), **command(name))
    assert float(tuned.verdict.settling.time) == pytest.approx(tuned.before, rel=0.03)


@pytest.mark.parametrize("name", presets())
def test_a_preset_written_back_is_its_own_text(name):
    assert mission_text(load(name)) == preset_text(name)
