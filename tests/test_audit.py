"""Flights that happened, held against the assumptions of their theorem: what breaks is named."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path

import casadi as ca
import h5py
import numpy as np
import pytest
from rich.cells import cell_len

from command_line import run
from hoverproof import cli
from hoverproof.audit.claim import Claim, Poses
from hoverproof.audit.finding import Finding
from hoverproof.audit.reading import read_log
from hoverproof.audit.vehicle import Vehicle
from hoverproof.audit.verdict import audit
from hoverproof.certification.certificate import differences
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.plant import camera
from hoverproof.servo.loop import LoopNumbers
from hoverproof.show.audit import finding_figure
from hoverproof.simulation.flight import flown, save
from hoverproof.simulation.timing import Timing

MISSION = load("research-1.5kg")
PROOF = Path(__file__).parents[1] / "proofs" / "research-1.5kg.attraction.cert.json"
CONTENT = json.loads(PROOF.read_text(encoding="utf-8"))
CLAIM = Claim.of(CONTENT)
WITHIN_TIME, WITHIN = 0.2, 0.2
AT = 2.0
"""When a fault begins that is put into the record, s."""


def fly(folder, name, **changes):
    path = folder / f"{name}.nc"
    mission = load("research-1.5kg", {k.replace("__", "."): v for k, v in changes.items()})
    save(flown(mission, Timing(4, None, None)), path)
    return path


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return fly(tmp_path_factory.mktemp("audit"), "good")


def judged(log):
    return {f.name: f for f in audit(log, MISSION, CLAIM).findings}


def named(log, name):
    """Return the first thing that broke, which must be this."""
    found = audit(log, MISSION, CLAIM).broken
    assert found[0].name == name, [f.name for f in found]
    return found[0]


def test_the_certificate_of_these_tests_is_that_of_the_mission():
    assert differences(CONTENT, MISSION) == []


@pytest.mark.slow
def test_a_flight_within_tolerances_held_every_assumption(good, capsys):
    status, out, _ = run(
        capsys, "audit", good, "--mission", "research-1.5kg", "--certificate", PROOF, "--json"
    )
    told = json.loads(out)
    assert status == 0
    assert told["broken"] == told["untold"] == []
    assert told["covering"] == {}
    assert {f["name"] for f in told["findings"]} >= {"thrust gain", "latency", "Ψ falls as proved"}
    page = Path(told["page"]).read_text(encoding="utf-8")
    drawn = [f for f in told["findings"] if f["name"] not in ("rotor lag", "target seen")]
    assert page.count("<svg") == len(drawn) == 12  # the others have no course over time
    assert len(page) < 500_000


def test_what_is_identified_is_what_flew(good):
    vehicle = Vehicle(read_log(good), MISSION)
    assert vehicle.lag.value[0] == pytest.approx(float(MISSION.rotors.time_constant), rel=1e-3)
    assert vehicle.torque_gain.value == pytest.approx([1, 1], abs=1e-3)
    assert vehicle.thrust_gain[0].value[0] == pytest.approx(1, abs=1e-4)


def test_the_image_age_is_that_of_the_schedule(good):
    log = read_log(good)
    late, rate = float(MISSION.sensors.latency), float(MISSION.sensors.frame_rate)
    assert log.image_age is not None
    flying = log.image_age[log.times > 0.2]
    assert flying.min() == pytest.approx(late, abs=2 * log.step)
    assert flying.max() == pytest.approx(late + 1 / rate, abs=2 * log.step)


@pytest.mark.parametrize(
    ("changes", "name", "value"),
    [
        ({"model_error__mass": 0.4}, "thrust gain", 1 - 1 / 1.4),
        ({"model_error__inertia": "[0.4, 0.4, 0]"}, "torque gain", 1 - 1 / 1.4),
        ({"model_error__rotors": "[-0.3, 0, 0, 0]"}, "every rotor answers", 0.3),
        ({"sensors__latency": 0.2}, "latency", 0.2 + 1 / 30),
        ({"rotors__time_constant": 0.05}, "rotor lag", 0.05),
        ({"wind__mean": "[2, 0, 0]", "wind__drag": 0.5}, "steady wind", 1 / 1.545),
        ({"start__rates": "[0, 0, 1]"}, "yaw rate", 1),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_a_fault_from_the_start_is_named_timed_and_quantified(changes, name, value, tmp_path):
    broken = named(read_log(fly(tmp_path, "flight", **changes)), name)
    assert broken.value == pytest.approx(value, rel=WITHIN)
    assert broken.at is not None
    assert broken.at <= WITHIN_TIME + 0.002


def aged(log, begin, end):
    """Return a log in which no image came between two times, s."""
    assert log.image_age is not None
    exposed = log.times - log.image_age
    kept = exposed[np.searchsorted(log.times, begin)]
    lost = (log.times >= begin) & (log.times < end)
    return replace(log, image_age=log.times - np.where(lost, kept, exposed))


@pytest.mark.parametrize(("name", "length"), [("frame gaps", 0.2), ("target seen", 1.0)])
def test_images_that_stay_out_are_named_as_dropped_or_lost(good, name, length):
    broken = named(aged(read_log(good), AT, AT + length), name)
    assert broken.value == pytest.approx(length, rel=WITHIN, abs=0.04)
    assert broken.at == pytest.approx(AT, abs=WITHIN_TIME)


def seen_larger(log, file, times_as_large):
    """Return a log with the features of images that are so many times as large."""
    numbers = LoopNumbers.of(MISSION)
    image = ca.SX.sym("image", 2, numbers.target_size)
    looked = ca.Function("look", [image], [numbers.law.look(camera.spherical(image))])
    with h5py.File(file) as held:
        images = held["image"][:]
    assert log.image_age is not None
    assert log.rotation is not None
    exposed = np.searchsorted(log.times, log.times - log.image_age - 1e-9)
    flat = times_as_large * images[exposed].transpose(2, 0, 1).reshape(2, -1)
    seen = np.asarray(looked.map(len(exposed))(flat).full()).T
    still = np.einsum("nij,nj->ni", log.rotation[exposed], seen)
    return replace(log, feature=np.einsum("nij,ni->nj", log.rotation, still))


@pytest.mark.parametrize("times_as_large", [0.85, 1, 1.15])
def test_wrong_intrinsics_are_told_by_estimated_positions(good, times_as_large):
    log = seen_larger(read_log(good), good, times_as_large)
    found = {f.name: f for f in audit(log, MISSION, CLAIM).findings}["scale of the image"]
    assert found.held is (times_as_large == 1)
    assert found.value == pytest.approx(abs(times_as_large - 1), rel=WITHIN, abs=0.01)
    assert found.at is None or found.at <= WITHIN_TIME


def test_a_rotor_that_fails_on_the_way_is_named_with_its_time_and_share(good):
    log = read_log(good)
    assert log.rotor_command is not None
    asked = log.rotor_command.copy()
    asked[log.times >= AT, 2] *= 2
    broken = named(replace(log, rotor_command=asked), "every rotor answers")
    assert broken.value == pytest.approx(0.5, rel=WITHIN)
    assert broken.at == pytest.approx(AT, abs=WITHIN_TIME)
    assert MISSION.vehicle.frame.names[2] in broken.words


def test_thrust_that_fades_on_the_way_is_timed(good):
    log = read_log(good)
    assert log.specific_force is not None
    force = log.specific_force.copy()
    force[log.times >= AT, 2] *= 0.7
    broken = named(replace(log, specific_force=force), "thrust gain")
    assert broken.value == pytest.approx(0.3, rel=WITHIN)
    assert broken.at == pytest.approx(AT, abs=WITHIN_TIME)


def test_wind_that_comes_up_on_the_way_is_timed(good):
    log = read_log(good)
    assert log.specific_force is not None
    assert log.rotation is not None
    blown = np.where(log.times[:, None] >= AT, log.rotation.transpose(0, 2, 1) @ [0, 1, 0], 0)
    found = audit(replace(log, specific_force=log.specific_force + blown), MISSION, CLAIM)
    broken = {f.name: f for f in found.broken}["steady wind"]
    assert broken.value == pytest.approx(1, rel=WITHIN)
    assert broken.at == pytest.approx(AT, abs=WITHIN_TIME)


def test_error_bars_of_a_noisy_log_contain_the_truth(good):
    log, random = read_log(good), np.random.default_rng(1)
    assert log.rate is not None
    assert log.specific_force is not None
    rate = log.rate + 0.0005 * random.standard_normal(log.rate.shape)
    force = log.specific_force + 0.1 * random.standard_normal(log.specific_force.shape)
    noisy = Vehicle(replace(log, rate=rate, specific_force=force), MISSION)
    for fit, truth in (
        (noisy.lag, [0.025]),
        (noisy.torque_gain, [1, 1]),
        (noisy.thrust_gain[0], [1]),
        (noisy.wind[0], [0, 0]),
    ):
        assert (abs(fit.value - truth) <= 4 * fit.deviation).all()
        assert (fit.deviation > 0).all()


def test_psi_is_half_the_weighted_squares_of_the_errors(good):
    poses = Poses(read_log(good), MISSION)
    with h5py.File(good) as file:
        squares = [(file[f"delta{i}"][:] ** 2).sum(axis=1) for i in (1, 2, 3, 4)]
    assert poses.energy == pytest.approx(np.stack(squares, axis=1), abs=1e-9)


def test_what_a_log_does_not_tell_is_not_said_to_hold(good):
    log = read_log(good)
    less = replace(log, specific_force=None, position=None, image_age=None)
    found = judged(less)
    for name in ("thrust gain", "steady wind", "latency", "Ψ falls as proved", "field of view"):
        assert found[name].held is None, name
    assert found["yaw rate"].held is True
    still = judged(replace(log, rate=None, rotor_command=log.rotor_command))
    assert still["thrust gain"].held is True
    assert still["torque gain"].held is still["yaw rate"].held is None


def test_a_log_of_another_vehicle_is_said_to_be(good):
    heavy = load("research-1.5kg", {"vehicle.mass": 1.6})
    notes = audit(read_log(good), heavy, None).log.notes
    assert notes == ("flown with another mission: its vehicle is not that of research-1.5kg",)
    assert audit(read_log(good), MISSION, None).log.notes == ()


def test_the_command_that_would_cover_runs_as_written(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = fly(tmp_path, "flight", start__rates="[0, 0, 0.6]")
    status, out, _ = run(
        capsys, "audit", path, "--mission", "research-1.5kg", "--certificate", PROOF, "--no-page"
    )
    assert status == 1
    assert max(map(cell_len, out.splitlines())) <= 80
    command = shlex.split(out.splitlines()[-1].removeprefix("Next: hoverproof "))
    assert command[:2] == ["attraction", "research-1.5kg"]
    wider = load("research-1.5kg", dict(w.split("=") for w in command if "=" in w))
    assert {f.name: f.held for f in audit(read_log(path), wider, CLAIM).findings}["yaw rate"]
    cli.app.parse_args(command, exit_on_error=False, print_error=False)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\x89HDF\r\n\x1a\n and nothing", "is damaged or cut short"),
        (b"time,x\n0,1\n", "no log of a kind that is read: netCDF"),
        (None, "cannot be read"),
    ],
)
def test_files_that_are_no_logs_get_one_line(content, words, tmp_path, capsys):
    path = tmp_path / "log.nc"
    if content is not None:
        path.write_bytes(content)
    status, out, err = run(capsys, "audit", path, "--mission", "research-1.5kg")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert words in err


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
def test_a_flight_file_that_is_cut_short_gets_one_line(good, share, tmp_path):
    content = good.read_bytes()
    path = tmp_path / "cut.nc"
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(InputError, match="damaged or cut short"):
        read_log(path)


def test_what_breaks_at_the_very_end_of_a_long_log_is_in_its_picture():
    values = np.zeros(1999)
    values[-1] = 5
    figure = finding_figure(Finding("gusts", times=np.arange(1999.0), values=values, bound=1.0))
    assert max(figure.axes[0].lines[0].get_ydata()) == 5


def test_a_netcdf_with_phases_that_fly_did_not_write_gets_one_line(tmp_path):
    path = tmp_path / "phases.nc"
    with h5py.File(path, "w") as file:
        file.attrs["title"] = "phases of the moon"
        file["time"], file["phase"] = [0.0, 1.0, 2.0], [2.0, 2.0, 2.0]
    with pytest.raises(InputError, match="is no log of fly: it holds no gravity_direction"):
        read_log(path)


def test_a_certificate_of_another_mission_is_refused(good, capsys):
    status, _, err = run(
        capsys,
        *("audit", good, "--mission", "research-1.5kg", "--certificate", PROOF),
        *("--set", "gains.k4=17"),
    )
    assert status == 2
    assert "is about another mission: gains.k4 is 18" in err


@pytest.mark.parametrize(("duration", "rows"), [(400, "0.2"), (1500, "0.75")])
def test_rows_that_are_far_apart_tell_no_fault_of_a_vehicle_as_modelled(duration, rows):
    mission = load("x4-flyer")
    save(flown(mission, Timing(duration, None, None)), "far.nc")
    found = audit(read_log("far.nc"), mission, None)
    assert found.broken == []
    asked = {f.name: f.words for f in found.untold}
    assert "few rows" in asked["every rotor answers"] or f"{rows} s apart" in asked["thrust gain"]


@pytest.mark.slow
def test_no_tolerance_is_proposed_for_the_log_of_another_vehicle(good, capsys):
    _, out, _ = run(capsys, "audit", good, "--mission", "crazyflie-2.1", "--no-page")
    assert "no tolerance: is it of another vehicle?" in out
    assert "Next:" not in out
