"""Logs of PX4 read and judged, and the exported C run over logs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from command_line import run
from hoverproof.audit.log import FlightLog
from hoverproof.audit.reading import read_log
from hoverproof.audit.replaying import replayed
from hoverproof.audit.vehicle import Vehicle
from hoverproof.audit.verdict import audit
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.firmware.exporting import export_c
from hoverproof.mission.reading import load
from hoverproof.simulation.flight import flown, save
from hoverproof.simulation.timing import Timing
from log_kit import ulog

BANDWIDTH = 20.0
MISSION = load("research-1.5kg", {"interface.rate_bandwidth": 25})
WIND = 0.8


@pytest.fixture(scope="module")
def px4(tmp_path_factory):
    """A vehicle whose rate loop is slower than the mission's, in wind, with images."""
    times = 10 + 0.004 * np.arange(1500)
    asked = 0.3 * np.column_stack([np.sin(3 * times), np.cos(2 * times), 0 * times])
    rate = np.zeros_like(asked)
    for k in range(1, len(times)):
        kept = np.exp(-BANDWIDTH * 0.004)
        rate[k] = asked[k - 1] + kept * (rate[k - 1] - asked[k - 1])
    felt = np.tile([WIND, 0, -9.81], (len(times), 1))
    level = np.tile([1.0, 0, 0, 0], (len(times), 1))
    xyz, still = [("xyz", "[3]")], np.zeros((len(times), 3))
    frames = np.arange(10, 16, 0.04)
    frames = frames[(frames < 12) | (frames > 13)]
    topics = {
        "vehicle_angular_velocity": (xyz, np.column_stack([times, rate])),
        "vehicle_acceleration": (xyz, np.column_stack([times, felt])),
        "vehicle_attitude": ([("q", "[4]")], np.column_stack([times, level])),
        "vehicle_local_position": (
            [("vx", ""), ("vy", ""), ("vz", "")],
            np.column_stack([times, still]),
        ),
        "vehicle_rates_setpoint": (
            [("roll", ""), ("pitch", ""), ("yaw", ""), ("thrust_body", "[3]")],
            np.column_stack([times, asked, still]),
        ),
        "landing_target_pose": (
            [("rel_pos_valid", "")],
            np.column_stack([frames, np.ones(len(frames))]),
        ),
    }
    return ulog(tmp_path_factory.mktemp("px4") / "log.ulg", topics)


def test_a_px4_log_tells_rate_loop_wind_and_lost_target(px4):
    found = {f.name: f for f in audit(read_log(px4), MISSION, None).findings}
    assert found["torque gain"].held is False
    assert found["torque gain"].value == pytest.approx(1 - BANDWIDTH / 25, abs=0.01)
    assert found["steady wind"].value == pytest.approx(WIND, rel=1e-3)
    assert found["target seen"].held is False
    assert found["target seen"].value == pytest.approx(1, abs=0.1)
    assert found["target seen"].at == pytest.approx(12, abs=0.2)
    for name in ("thrust gain", "latency", "Ψ falls as proved", "limits of the rotors"):
        assert found[name].held is None, name


def test_noise_that_the_law_answers_does_not_bend_the_bandwidth():
    """The command holds the noise of the rates that it is made of."""
    times, random = 0.004 * np.arange(5000), np.random.default_rng(3)
    noise = 0.01 * random.standard_normal((len(times), 3))
    true, asked = np.zeros((2, len(times), 3))
    wanted = np.column_stack([np.sin(4 * times), np.cos(3 * times), 0 * times])
    kept = np.exp(-BANDWIDTH * 0.004)
    for k in range(len(times)):
        if k:
            true[k] = asked[k - 1] + kept * (true[k - 1] - asked[k - 1])
        asked[k] = true[k] + noise[k] + wanted[k] / 25
    log = FlightLog(source="made", kind="made", times=times, rate=true + noise, rate_command=asked)
    fit = Vehicle(log, MISSION).bandwidth
    assert (abs(fit.value - BANDWIDTH) <= 4 * fit.deviation + 0.2).all()
    assert (fit.deviation < 0.1 * BANDWIDTH).all()


def test_a_px4_log_that_is_cut_short_is_partial_and_said_to_be(px4, tmp_path, capsys):
    path = tmp_path / "cut.ulg"
    path.write_bytes(px4.read_bytes()[:-5])
    assert read_log(px4).partial == ""
    assert "cut short" in read_log(path).partial
    path.write_bytes(px4.read_bytes()[:300])
    status, out, err = run(capsys, "audit", path, "--mission", "research-1.5kg", "--json")
    assert (status, out, err.count("\n")) == (2, "", 1)


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "flight.nc"
    save(flown(load("research-1.5kg"), Timing(2, None, None)), path)
    return path


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package")
    export_c(load("research-1.5kg"), folder, allow_uncertified=True, camera=True)
    return folder


@pytest.mark.slow
def test_a_replay_commands_what_was_commanded(flight, package, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ("--mission", "research-1.5kg", "--package", package, "--json")
    status, out, _ = run(capsys, "replay", flight, *words)
    told = json.loads(out)
    assert status == 0
    assert told["steps"] == len(read_log(flight).times)
    assert told["saturated"] == told["faults"] == 0
    with xr.open_dataset(told["out"], engine="h5netcdf") as written:
        moved = float(written["rotor_thrust_logged"].max() - written["rotor_thrust_logged"].min())
        off = float(abs(written["rotor_thrust"] - written["rotor_thrust_logged"]).max())
    assert told["differences"]["rotor"]["largest"] == pytest.approx(off)
    assert off < 0.02 * moved
    assert Path(told["figure"]).stat().st_size > 10_000


@pytest.mark.slow
def test_a_replay_with_weak_rotors_saturates(flight, package):
    firmware = Firmware(package)
    assert firmware.set_rotor_limits(0, 3.8) == 0
    told = replayed(read_log(flight), load("research-1.5kg"), firmware).facts()
    assert told["saturated"] > 0
    assert told["saturated_at"] < 2
    assert told["differences"]["rotor"]["largest"] > 0.05


@pytest.mark.slow
def test_what_a_log_has_not_is_not_replayed(px4, package):
    with pytest.raises(InputError, match="holds no feature: nothing to replay"):
        replayed(read_log(px4), load("research-1.5kg"), Firmware(package))
