"""What a flight over MAVLink is told and tells: messages, sightings, the link, the command."""

from __future__ import annotations

import json
import os
import pty
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from command_line import refusal, run
from firmware_kit import export, tool
from hoverproof.errors import InputError
from hoverproof.mavlink.dialect import Codec, dialect
from hoverproof.mavlink.link import Serial, Udp, link_to
from hoverproof.mavlink.sight import Lines, lines_from
from hoverproof.mavlink.stand_in import STEP, TAKES, StandIn
from hoverproof.mavlink.throttle import HoverThrottle
from hoverproof.mavlink.told import Stamps, Told
from hoverproof.mission.reading import load
from hoverproof.plant.rigid_body import rotation_matrix

MISSION = "crazyflie-2.1"
LOOP = {"interface.rate_bandwidth": "25"}
SET = ("--set", "interface.rate_bandwidth=25")
ROLL, PITCH, YAW = 0.3, -0.2, 1.1
ROTATION = rotation_matrix(ROLL, PITCH, YAW)
QUATERNION = np.roll(Rotation.from_euler("ZYX", [YAW, PITCH, ROLL]).as_quat(), 1)
RATES = (0.1, -0.2, 0.3)


def told(*messages, heartbeat=None):
    """Take messages in as they come over a link: packed by one end, parsed by the other."""
    found, sender, receiver = Told(), Codec(1, 1), Codec(1, 191)
    for message in [*([heartbeat] if heartbeat else []), *messages]:
        for heard in receiver.messages(sender.packed(message)):
            found.take(heard, 10.0)
    return found


def common(name, *values):
    return getattr(dialect(), f"MAVLink_{name}_message")(*values)


def beat(autopilot, mode=4, base=129, kind=2):
    return common("heartbeat", kind, autopilot, base, mode, 4, 3)


def test_an_attitude_is_the_same_by_angles_and_by_a_quaternion():
    angles = told(common("attitude", 5000, ROLL, PITCH, YAW, *RATES))
    quaternion = told(common("attitude_quaternion", 5000, *QUATERNION, *RATES))
    np.testing.assert_allclose(angles.rotation.value, ROTATION, atol=1e-6)
    np.testing.assert_allclose(quaternion.rotation.value, ROTATION, atol=1e-6)
    for found in (angles, quaternion):
        np.testing.assert_allclose(found.rate.value, RATES, rtol=1e-6)


def test_a_velocity_is_in_the_world_whichever_message_tells_it():
    world = np.array([0.4, -0.5, 0.6])
    local = told(common("local_position_ned", 5000, 1, 2, 3, *world))
    np.testing.assert_allclose(local.velocity.value, world, rtol=1e-6)
    rest = [[float("nan")] * 21, [float("nan")] * 21]

    def odometry(frame, child):
        body = ROTATION.T @ world
        values = (1, 2, 3, QUATERNION, *body, *RATES, *rest)
        return told(common("odometry", 5_000_000, frame, child, *values))

    np.testing.assert_allclose(odometry(1, 12).velocity.value, world, atol=1e-6)
    other = odometry(20, 12)
    assert other.velocity is None
    assert "frames 20 and 12" in other.refused["ODOMETRY"]


def test_a_specific_force_is_in_metres_per_square_second_whichever_message_tells_it():
    force = np.array([0.5, -1.0, -9.5])
    rest = [*RATES, 0, 0, 0, 1000, 0, 0, 20]
    milli = [round(c / 9.80665e-3) for c in force]
    scaled = [*milli, 100, -200, 300, 0, 0, 0]
    by = {
        "highres": told(common("highres_imu", 5_000_000, *force, *rest, 63)),
        "scaled": told(common("scaled_imu", 5000, *scaled)),
        "raw of ArduPilot": told(common("raw_imu", 5_000_000, *scaled), heartbeat=beat(3)),
    }
    for found in by.values():
        np.testing.assert_allclose(found.specific_force.value, force, atol=6e-3)
    other = told(common("raw_imu", 5_000_000, *scaled), heartbeat=beat(12))
    assert other.specific_force is None
    assert "units of the sensor" in other.refused["RAW_IMU"]
    old = told(common("highres_imu", 5_000_000, *force, *rest, 0))
    assert old.specific_force is None


@pytest.mark.parametrize(
    ("autopilot", "mode", "name", "takes"),
    [
        (3, 4, "ArduPilot", True),
        (3, 20, "ArduPilot", True),
        (3, 5, "ArduPilot", False),
        (12, 6 << 16, "PX4", True),
        (12, 4 << 16 | 3 << 24, "PX4", False),
    ],
)
def test_the_mode_that_takes_setpoints_is_known(autopilot, mode, name, takes):
    found = told(beat(autopilot, mode)).heartbeat
    assert (found.autopilot.name, found.in_mode, found.armed) == (name, takes, True)
    assert not told(beat(autopilot, mode, base=1)).heartbeat.armed


def test_what_is_no_number_and_no_unit_quaternion_is_refused():
    nan = float("nan")
    assert told(common("attitude", 5000, nan, 0, 0, *RATES)).rotation is None
    assert told(common("attitude_quaternion", 5000, 0, 0, 0, 0, *RATES)).rotation is None


def test_a_message_that_was_overtaken_or_doubled_is_left_out():
    first, second = (common("attitude", at, 0, 0, 0, at / 1000, 0, 0) for at in (5000, 5010))
    found = told(second, first, second)
    assert found.rate.value[0] == pytest.approx(5.01)
    assert found.overtaken == 2


def test_what_comes_late_was_true_before_it_came():
    clock = Stamps()
    assert clock.read(5.0, 100.01) == pytest.approx(100.01)
    assert clock.read(5.1, 100.10) == pytest.approx(100.10)  # the quickest tells the offset
    assert clock.read(5.2, 100.50) == pytest.approx(100.20, abs=1e-4)
    assert not clock.restarted
    assert clock.read(0.1, 101.0) == pytest.approx(101.0)
    assert clock.restarted


def test_clocks_may_run_apart():
    clock = Stamps()
    for k in range(6000):
        stamp = k / 10
        at = clock.read(stamp, 50 + stamp * (1 + 1e-4))
    assert at == pytest.approx(50 + stamp * (1 + 1e-4), abs=1e-3)


def test_the_clock_of_a_simulator_may_run_slow_if_that_is_allowed():
    slow, strict = Told(drift=0.02), Told()
    for k in range(600):
        now = 50 + k / 10 / 0.99  # its clock runs 1 % slow
        for told_so in (slow, strict):
            told_so.take(common("attitude", 100 * k, 0, 0, 0, 0, 0, 0), now)
    assert slow.rotation.at == pytest.approx(now, abs=1e-3)
    assert now - strict.rotation.at > 0.5  # else a link that slows down is not found out


def test_the_throttle_of_hover_is_learned_from_a_hover():
    hover = HoverThrottle(9.81)
    for k in range(60):
        assert hover.value is None or k > 15
        hover.take(k / 20, 0.4 * (1 + 0.1 * np.sin(k)), 9.0)
    assert hover.value == pytest.approx(0.4 / 9 * 9.81, rel=0.02)
    assert HoverThrottle(9.81, 0.3).value == 0.3
    idle = HoverThrottle(9.81)
    for k in range(60):
        idle.take(k / 20, 0.01, 9.81)
    assert idle.value is None


def lines(*pieces, points=2, wall=1000.0):
    given = [list(pieces)]
    return Lines(lambda: given.pop() if given else [], points, lambda: None, lambda: wall)


SQUARE = [[0.1, 0.2], [-0.3, 0.4]]


def test_sightings_are_lines_with_an_age_or_a_time_of_day():
    by_age = {"age": 0.03, "image": SQUARE}
    by_time = {"time": 999.95, "pixels": SQUARE}
    text = "\n".join(json.dumps(told) for told in (by_age, by_time, {"image": []})) + "\n"
    half = len(text) // 3
    source = lines(text[:half].encode(), text[half:].encode())
    late, early = source.newest(50.0)
    assert (late.at, early.at) == pytest.approx((49.95, 49.97))
    assert (late.in_pixels, early.in_pixels) == (True, False)
    np.testing.assert_array_equal(early.seen, SQUARE)
    assert source.remark == ""
    assert source.newest(50.0) == []


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("{", "is no JSON"),
        ("[1]", "is no JSON object"),
        ('{"image": [[0.1, 0.2], [0.3, 0.4]]}', 'neither "age" nor "time"'),
        ('{"age": true, "image": [[0.1, 0.2], [0.3, 0.4]]}', 'neither "age" nor "time"'),
        ('{"age": 0.1, "image": [[0.1, 0.2]]}', "of 2 pairs of numbers"),
        ('{"age": 0.1, "image": [[0.1, NaN], [1, 2]]}', "of 2 pairs of numbers"),
        ('{"age": 0.1, "image": "here"}', "of 2 pairs of numbers"),
        ("[" * 10000, "is no JSON"),
    ],
)
def test_a_line_that_is_no_sighting_is_said_to_be_none(line, words):
    source = lines(line.encode() + b"\n")
    assert source.newest(0.0) == []
    assert words in source.remark


def test_a_line_without_an_end_is_forgotten():
    source = lines(b"x" * 70_000)
    assert source.newest(0.0) == []
    assert "has no end" in source.remark


def test_sightings_come_by_UDP():
    source = lines_from("udp:127.0.0.1:45117", 2, lambda: 1000.0)
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            told = json.dumps({"age": 0.0, "image": SQUARE}).encode()
            sender.sendto(told, ("127.0.0.1", 45117))
        for _ in range(100):
            if found := source.newest(3.0):
                break
            time.sleep(0.01)
        assert found[0].at == 3.0
        with pytest.raises(InputError, match="cannot be listened on"):
            lines_from("udp:127.0.0.1:45117", 2, lambda: 0.0)
    finally:
        source.close()


def test_a_serial_port_carries_messages():
    ours, theirs = pty.openpty()
    link = link_to(f"serial:{os.ttyname(theirs)}:57600")
    try:
        assert isinstance(link, Serial)
        os.write(ours, Codec(1, 1).packed(beat(12)))
        heard = []
        for _ in range(100):
            heard += [m for data, _ in link.receive() for m in Codec(1, 191).messages(data)]
            if heard:
                break
            time.sleep(0.01)
        assert heard[0].autopilot == 12
        link.send(Codec(1, 191).setpoint(1.0, 1, RATES, 0.5), None)
        (sent,) = Codec(1, 1).messages(os.read(ours, 200))
        assert sent.type_mask == 128
        assert sent.thrust == 0.5
    finally:
        link.close()
        os.close(ours)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "--mavlink: or --rehearse must be given"),
        (["--rehearse", "px4", "--mavlink", "udp:127.0.0.1:14550"], "one of them"),
        (["--rehearse", "px4"], "--duration: must be given for a rehearsal"),
        (["--rehearse", "px4", "--duration", "-1"], "--duration: must be above 0 s"),
        (["--rehearse", "px4", "--duration", "1", "--features", "stdin"], "is for --mavlink"),
        (["--mavlink", "udp:127.0.0.1:14550", "--rate", "2000"], "--rate: must be from 20 to 400"),
        (["--mavlink", "udp:127.0.0.1:14550", "--hover-throttle", "45"], "must be from 0.05 to"),
        (["--mavlink", "udp:127.0.0.1:14550", "--system", "0"], "must be from 1 to 255"),
        (["--rehearse", "px4", "--duration", "1", "--seed=-1"], "--seed: must be from 0 to"),
        (["--mavlink", "udp:127.0.0.1:14550", "--clock-drift", "0.2"], "to 0.05 s/s, not"),
        (["--mavlink", "udp:127.0.0.1:14550", "--log", "no/such/f.nc"], "its folder is not there"),
        (["--mavlink", "udp:127.0.0.1:14550", "--package", "no"], "is no firmware package"),
    ],
)
def test_what_cannot_be_flown_is_one_line(options, words, capsys):
    assert words in refusal(capsys, "fly", MISSION, *SET, *options)


@pytest.mark.parametrize("where", ["tcp:1.2.3.4:5", "udp:14550", "udp:h:0", "serial:9600", ""])
def test_an_address_that_is_none_is_refused(where):
    with pytest.raises(InputError, match="mavlink"):
        link_to(where)


def test_it_says_how_to_get_pymavlink(monkeypatch, capsys):
    for name in list(sys.modules):
        if name.startswith("pymavlink"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pymavlink", None)
    line = refusal(capsys, "fly", MISSION, *SET, "--rehearse", "px4", "--duration", "1")
    assert "pip install 'hoverproof[mavlink]'" in line


def test_c_that_was_changed_is_not_flown_as_certified(capsys, tmp_path):
    tool("cc")
    folder = export(tmp_path, MISSION, LOOP, camera=True, name="flown").folder
    params = folder / "flown_params.h"
    params.write_text(params.read_text("utf-8") + "/* mine */\n", encoding="utf-8")
    wish = ("fly", MISSION, *SET, "--rehearse", "px4", "--package", folder, "--duration", "0.1")
    assert "its flown_params.h is not as it was exported" in refusal(capsys, *wish)
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    del manifest["files"]["flown_params.h"]
    (folder / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    assert "its flown_params.h is not as it was exported" in refusal(capsys, *wish)
    _, out, _ = run(capsys, *wish, "--allow-uncertified", "--json")
    assert json.loads(out.splitlines()[-1])["certified"] is False


@pytest.mark.slow
def test_a_rehearsal_answers_and_fits_80_columns(capsys, tmp_path):
    tool("cc")
    folder = export(tmp_path, MISSION, LOOP, camera=True, name="flown").folder
    wish = ("fly", MISSION, *SET, "--rehearse", "px4", "--package", folder)
    status, out, err = run(capsys, *wish, "--duration", "2", "--log", tmp_path / "log.nc")
    assert status == 0
    assert "handed back: flown for 2 s" in out
    assert "COM_OBL_RC_ACT" in out
    assert all(len(line) <= 79 for line in err.splitlines())
    assert sum("flying" in line for line in err.splitlines()) == 4
    status, out, err = run(capsys, *wish, "--duration", "0.5", "--json")
    *reports, answer = map(json.loads, out.splitlines())
    assert (status, err) == (0, "")
    assert {report["status"]["phase"] for report in reports} == {"waiting", "ready", "flying"}
    assert answer["flown"] and not answer["fault"]


def test_sightings_come_by_standard_input():
    """Of a pipe that is still open, and of one that is not."""
    program = (
        "import sys, time\n"
        "from hoverproof.mavlink.sight import lines_from\n"
        "source, found = lines_from('stdin', 2, lambda: 0.0), []\n"
        "print('begun', flush=True)\n"
        "while not found: found = source.newest(7.0)\n"
        "print(found[0].at, flush=True)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"begun\n"
        process.stdin.write(json.dumps({"age": 0.5, "image": SQUARE}).encode() + b"\n")
        process.stdin.flush()
        assert process.stdout.readline() == b"6.5\n"


class Field:
    """A vehicle on loopback in real time, in a thread, with a pilot who enters the mode."""

    def __init__(self, mission):
        self.vehicle = StandIn(mission)
        self.link = Udp(("127.0.0.1", 45118), listens=False)
        self.camera = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.heard, self.stop = [], False
        self.thread = threading.Thread(target=self.fly, daemon=True)

    def fly(self):
        start = time.monotonic()
        while not self.stop:
            now = time.monotonic()
            while start + self.vehicle.time < now:
                self.vehicle.step()
            for data, _ in self.link.receive():
                self.heard.append(now)
                self.vehicle.hear(data)
            for data in self.vehicle.tell():
                self.link.send(data, None)
            if seen := self.vehicle.photograph(now):
                told = json.dumps({"age": 0.0, "image": seen.seen.tolist()})
                self.camera.sendto(told.encode(), ("127.0.0.1", 45119))
            time.sleep(STEP)

    def until(self, what, most=90.0):
        end = time.monotonic() + most
        while not what():
            assert time.monotonic() < end
            time.sleep(0.01)


@pytest.mark.slow
@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGINT])
def test_a_process_that_is_ended_leaves_nothing_sending(ending, tmp_path):
    """By real sockets: it has no child, and the vehicle gives up on setpoints and holds."""
    tool("cc")
    folder, log = (
        export(tmp_path, MISSION, LOOP, camera=True, name="flown").folder,
        tmp_path / "log.nc",
    )
    field = Field(load(MISSION, LOOP))
    wish = ["--mavlink", "udp:127.0.0.1:45118", "--features", "udp:127.0.0.1:45119"]
    command = [sys.executable, "-m", "hoverproof", "fly", MISSION, *SET, *wish]
    command += ["--package", str(folder), "--hover-throttle", "0.45", "--log", str(log), "--json"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        field.thread.start()
        field.until(lambda: len(field.vehicle.setpoints) > 20)
        field.until(lambda: field.vehicle.enter(TAKES))
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        if children.exists():
            assert children.read_text() == ""
        process.send_signal(ending)
        process.wait(60)
        ended = time.monotonic()
        field.until(lambda: field.vehicle.mode != TAKES, most=20)
        assert all(at < ended + 0.5 for at in field.heard)
        said = process.stderr.read().decode()
        assert (process.returncode, "Traceback" in said) == (
            (-9, False) if ending == signal.SIGKILL else (130, False)
        )
        assert log.exists() == (ending == signal.SIGINT)
    finally:
        field.stop = True
        process.kill()
        process.wait()
        process.stderr.close()
        field.thread.join()
        field.link.close()
        field.camera.close()
