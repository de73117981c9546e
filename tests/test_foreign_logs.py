"""Logs of autopilots and bags of ROS 2: what is in them is told, what is not is said to be not."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest

from command_line import refusal, run
from hoverproof.audit.reading import read_log
from hoverproof.audit.replaying import replayed
from hoverproof.audit.verdict import audit
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.simulation.flight import flown, save
from hoverproof.simulation.timing import Timing
from log_kit import Bag, bag_of, dataflash, message, ulog
from sampling import mostly_whole

BANDWIDTH = 20.0
MISSION = load("research-1.5kg", {"interface.rate_bandwidth": 25})
PROOF = Path(__file__).parents[1] / "proofs" / "research-1.5kg.attraction.cert.json"
WIND, GRAVITY = 0.8, 9.81
PERIOD = 0.0025
XYZ = [("xyz", "[3]")]


def told(log, mission=MISSION):
    return {f.name: f for f in audit(log, mission, None).findings}


def turned(begin=10.0, length=6.0):
    """Return times, and rates asked for and made by a rate loop of `BANDWIDTH`."""
    times = begin + PERIOD * np.arange(round(length / PERIOD))
    since = times - begin
    asked = 0.3 * np.column_stack([np.sin(3 * since), np.cos(2 * since), 0 * since])
    rate, kept = np.zeros_like(asked), np.exp(-BANDWIDTH * PERIOD)
    for k in range(1, len(times)):
        rate[k] = asked[k - 1] + kept * (rate[k - 1] - asked[k - 1])
    return times, asked, rate


def copter(path, *, guided=True, images=True):
    """Write a log of ArduCopter with the messages and letters of its release 4.5."""
    times, asked, rate = turned()
    none = np.zeros(len(times))
    felt = np.column_stack([none + WIND, none, none - GRAVITY])
    seen = np.arange(10, 16, 0.04)
    seen = seen[(seen < 12) | (seen > 13)]
    measured = np.array([seen[seen <= t][-1] for t in times])
    degrees = np.degrees(np.stack([asked, rate], axis=2).reshape(len(times), 6))
    first, second = (np.column_stack([times, none + i, rate, felt]) for i in (0, 1))
    second[:, 2:] = 7  # another instance, which is not taken
    imu = np.stack([first, second], axis=1).reshape(-1, 8)
    landing = np.column_stack([times, none + 1, none + 1, np.zeros((len(times), 7))])
    landing = np.column_stack([landing, 1e3 * measured, none, none])
    kinds = {
        "MODE": ("QMBB", "TimeUS,Mode,ModeNum,Rsn", [(9, 5, 5, 1), (11, *[4 * guided + 1] * 2, 1)]),
        "IMU": ("QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", imu),
        "ATT": (
            "QccccCC",
            "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw",
            np.column_stack([times, *[none] * 5, none + 90]),
        ),
        "RATE": (
            "Qfffffff",
            "TimeUS,RDes,R,PDes,P,YDes,Y,AOut",
            np.column_stack([times, degrees, none + 0.4]),
        ),
        "XKF1": (
            "QBccCfff",
            "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD",
            np.column_stack([times, none, none, none, none, none, none + 2, none]),
        ),
        "PL": (
            "QBBfffffffIIB",
            "TimeUS,Heal,TAcq,pX,pY,vX,vY,mX,mY,mZ,LastMeasMS,EKFOutl,Est",
            landing,
        ),
    }
    if guided:
        kinds["MODE"][2][1] = (11, 4, 4, 1)
    if not images:
        del kinds["PL"]
    return dataflash(path, kinds)


@pytest.fixture(scope="module")
def ardupilot(tmp_path_factory):
    return copter(tmp_path_factory.mktemp("ardupilot") / "00000001.BIN")


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    path = tmp_path_factory.mktemp("flight") / "flight.nc"
    save(flown(load("research-1.5kg"), Timing(2, None, None)), path)
    return path


@pytest.fixture(scope="module")
def mcap(flight):
    folder = bag_of(read_log(flight), flight.parent / "bag")
    return next(folder.glob("*.mcap"))


@pytest.fixture(scope="module")
def px4(tmp_path_factory):
    times, asked, rate = turned()
    none = np.zeros((len(times), 3))
    topics = {
        "vehicle_angular_velocity": (XYZ, np.column_stack([times, rate])),
        "vehicle_acceleration": (XYZ, np.column_stack([times, none - [0, 0, GRAVITY]])),
        "vehicle_rates_setpoint": (
            [("roll", ""), ("pitch", ""), ("yaw", ""), ("thrust_body", "[3]")],
            np.column_stack([times, asked, none]),
        ),
    }
    return ulog(tmp_path_factory.mktemp("px4") / "log.ulg", topics, sync=200)


def test_a_log_of_ardupilot_tells_rate_loop_wind_and_lost_target(ardupilot):
    log = read_log(ardupilot)
    assert (log.partial, log.lacks) == ("", ())
    assert log.times[0] == pytest.approx(11, abs=0.01)  # guided from then on
    found = told(log)
    assert found["torque gain"].value == pytest.approx(1 - BANDWIDTH / 25, abs=0.02)
    assert found["steady wind"].value == pytest.approx(WIND, rel=1e-3)
    assert found["target seen"].held is False
    assert found["target seen"].at == pytest.approx(12, abs=0.2)
    assert log.throttle == pytest.approx(np.full(len(log.times), 0.4))
    assert log.velocity == pytest.approx(np.tile([2.0, 0, 0], (len(log.times), 1)), abs=1e-6)
    for name in ("thrust gain", "latency", "Ψ falls as proved", "limits of the rotors"):
        assert found[name].held is None, name


def test_what_was_never_guided_is_looked_at_and_said_to_be(tmp_path):
    log = read_log(copter(tmp_path / "log.bin", guided=False, images=False))
    assert log.times[0] == pytest.approx(10)
    assert "never in GUIDED or GUIDED_NOGPS: all of it is looked at" in log.notes
    assert log.lacks == ("PL.LastMeasMS (precision landing): images, whether the target was seen",)


@pytest.mark.parametrize(("plugin", "begin"), [("mcap", 10.0), ("sqlite3", 1.7e9 + 0.5)])
def test_a_bag_tells_of_a_flight_what_its_own_record_tells(flight, plugin, begin, tmp_path):
    own = read_log(flight)
    log = read_log(bag_of(own, tmp_path / "bag", plugin, begin))
    assert log.partial == ""
    assert log.lacks == ("topic rates: rate loop",)
    assert log.times[0] == pytest.approx(begin if begin < 1e6 else 0.5)
    plain = load("research-1.5kg")
    theirs, ours = told(log, plain), told(own, plain)
    assert [f.held for f in theirs.values()] == [f.held for f in ours.values()]
    for name, f in ours.items():
        if f.held is not None:
            assert theirs[name].value == pytest.approx(f.value, rel=1e-4, abs=3e-4), name


@pytest.mark.slow
def test_a_bag_is_replayed_as_the_flight_is(flight, mcap):
    from hoverproof.firmware.exporting import exported

    mission = load("research-1.5kg")
    firmware = exported(mission, camera=True)
    logs = read_log(flight), read_log(mcap)
    ours, theirs = (replayed(log, mission, firmware) for log in logs)
    count = len(theirs.times)
    assert len(ours.times) - count <= 1  # before the first image came there is no feature
    assert theirs.outputs["rotor"] == pytest.approx(ours.outputs["rotor"][-count:], abs=1e-4)


def test_topics_are_named_where_their_types_do_not_tell(tmp_path, capsys):
    times, asked, rate = turned(length=2)
    with Bag(tmp_path / "bag") as bag:
        for k, time in enumerate(times):
            for topic, sign in (("/imu/raw", 1), ("/imu/other", -1)):
                bag.imu(topic, time, sign * rate[k], np.array([0, 0, -GRAVITY]))
            bag.rates("/mavros/setpoint_raw/attitude", time, asked[k])
            if k % 16 == 0 and not 10.5 < time < 11.5:
                bag.sightings("/detections", time + 0.03, time, 1)
    words = ("audit", tmp_path / "bag", "--mission", "research-1.5kg", "--no-page")
    line = refusal(capsys, *words)
    assert "has several topics of imu: /imu/other, /imu/raw: say which by --topic imu=NAME" in line
    path = tmp_path / "bag"
    named = {"imu": "/imu/raw", "rates": "/mavros/setpoint_raw/attitude"}
    log = read_log(path, named)
    found = told(log)
    assert found["torque gain"].value == pytest.approx(1 - BANDWIDTH / 25, abs=0.02)
    assert found["target seen"].at == pytest.approx(10.5, abs=0.2)
    for given, reason in (
        ({"imu": "/imu/rar"}, "did you mean '/imu/raw'?"),
        ({"thrust": "/imu/raw"}, "is sensor_msgs/msg/Imu, not geometry_msgs/msg/WrenchStamped"),
        ({"imus": "/imu/raw"}, "topic imus: did you mean 'imu'?"),
    ):
        with pytest.raises(InputError) as error:
            read_log(path, given)
        assert reason in str(error.value)
    assert "must be PART=NAME" in refusal(capsys, *words, "--topic", "imu")


def test_topics_go_with_bags_alone(flight, capsys):
    words = ("audit", flight, "--mission", "research-1.5kg", "--topic", "imu=/imu")
    assert "--topic: is for bags of ROS 2" in refusal(capsys, *words)


def test_an_older_log_of_px4_is_read_by_what_it_has(tmp_path):
    times, _, rate = turned(length=1)
    fields = [("gyro_rad", "[3]"), ("accelerometer_m_s2", "[3]")]
    rows = np.column_stack([times, rate, np.zeros((len(times), 2)), 0 * times - GRAVITY])
    log = read_log(ulog(tmp_path / "log.ulg", {"sensor_combined": (fields, rows)}))
    assert log.rate == pytest.approx(rate, abs=1e-6)
    assert log.specific_force[:, 2] == pytest.approx(-GRAVITY)
    assert any(lack.startswith("vehicle_attitude") for lack in log.lacks)


def test_images_that_px4_logs_once_a_second_tell_nothing(tmp_path):
    times, _, rate = turned(length=6)
    frames = np.arange(10, 16, 1.0)
    topics = {
        "vehicle_angular_velocity": (XYZ, np.column_stack([times, rate])),
        "landing_target_pose": (
            [("rel_pos_valid", "")],
            np.column_stack([frames, np.ones(len(frames))]),
        ),
    }
    found = told(read_log(ulog(tmp_path / "log.ulg", topics)))
    for name in ("latency", "frame gaps", "target seen"):
        assert found[name].held is None
        assert found[name].words == "the log has an image each 1 s: too few to tell"


def test_what_was_appended_to_a_log_of_px4_is_read(tmp_path, px4):
    """As its crash handler does: the log before it may end within a message."""
    content = px4.read_bytes()
    head, cut, more = content[:-7], len(content) - 7, message("D", b"\x00\x00" + bytes(20))
    flags = bytearray(message("B", bytes(40)))
    flags[11], flags[19:27] = 1, struct.pack("<Q", cut)
    path = tmp_path / "log.ulg"
    path.write_bytes(head[:16] + flags + head[16 + len(flags) :] + more)
    at_time_0 = "rows with impossible times or values, left out: 1"
    assert read_log(path).partial == at_time_0
    path.write_bytes(head[:16] + flags + head[16 + len(flags) :])
    assert read_log(path).partial == "it is cut short within a message"


@pytest.mark.parametrize("what", ["time", "value"])
def test_a_row_that_cannot_be_is_left_out_and_the_log_called_partial(what, tmp_path):
    times, _, rate = turned(length=2)
    if what == "time":
        times[300] += 2e6
    else:
        rate[300, 0] = 3e7
    topics = {"vehicle_angular_velocity": (XYZ, np.column_stack([times, rate]))}
    path = ulog(tmp_path / "log.ulg", topics)
    log = read_log(path)
    assert "rows with impossible times or values, left out: 1" in log.partial
    assert len(log.times) >= len(times) - 2
    assert abs(log.rate).max() < 1
    assert log.times[-1] < 13


@pytest.mark.parametrize("write", ["bin", "ulg"])
def test_a_number_that_is_none_of_a_rare_kind_is_taken_as_none(write, tmp_path):
    """Damage makes signalling ones, of which NumPy warns."""
    times, _, rate = turned(length=1)
    path = tmp_path / f"log.{write}"
    felt = 0 * rate
    felt[7] = np.pi
    if write == "bin":
        rows = np.column_stack([times, 0 * times, rate, felt])
        kinds = {"IMU": ("QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", rows)}
        dataflash(path, kinds)
    else:
        names = {"vehicle_angular_velocity": rate, "vehicle_acceleration": felt}
        ulog(path, {n: (XYZ, np.column_stack([times, v])) for n, v in names.items()})
    content = path.read_bytes()
    path.write_bytes(content.replace(struct.pack("<f", np.pi), b"\x01\x00\x80\x7f"))
    log = read_log(path)
    assert np.isnan(log.specific_force[7]).all()
    assert np.isfinite(log.rate).all()


def damaged(content, random, k):
    """Return a file cut short, with bits turned, wiped, with a hole, or with what is not its."""
    content, size = bytearray(content), len(content)
    at, length = int(random.integers(1, size)), int(random.integers(1, 4000))
    if k % 5 == 0:
        return content[:at]
    if k % 5 == 1:
        for place in random.integers(0, size, 12):
            content[place] ^= 1 << int(random.integers(0, 8))
    elif k % 5 == 2:
        content[at : at + length] = bytes(min(length, size - at))
    elif k % 5 == 3:
        del content[at : at + length]
    else:
        content[at:at] = random.bytes(length)
    return content


@pytest.mark.parametrize("kind", ["flight", "ardupilot", "mcap", "px4"])
@pytest.mark.parametrize("seed", mostly_whole(range(60), every=30))
def test_damage_is_one_clear_line_or_called_partial(kind, seed, request, tmp_path):
    """What is left may look whole only if bits of numbers were turned, or a topic cut that is not
    looked at: the formats of autopilots have no checksums."""
    whole = request.getfixturevalue(kind)
    random = np.random.default_rng(seed)
    ends = []
    for k in range(5):
        path = tmp_path / f"{k}{whole.suffix}"
        path.write_bytes(damaged(whole.read_bytes(), random, k))
        try:
            log = read_log(path)
            audit(log, MISSION, None)
            ends.append("partial" if log.partial else "whole")
        except InputError as error:
            assert "\n" not in str(error)
            assert len(str(error)) < 400
            ends.append("refused")
    assert ends[0] != "whole" or kind in ("px4", "ardupilot")  # cut between two messages
    assert ends[3] != "whole" or kind in ("px4", "ardupilot")
    if kind == "flight":
        assert ends[0] == ends[3] == ends[4] == "refused"


@pytest.mark.parametrize("kind", ["ardupilot", "px4"])
@pytest.mark.parametrize("share", [0.3, 0.7, 0.99])
def test_a_log_of_an_autopilot_that_was_cut_short_is_partial(kind, share, request, tmp_path):
    whole = request.getfixturevalue(kind)
    content, full = whole.read_bytes(), read_log(whole)
    path = tmp_path / f"cut{whole.suffix}"
    partials = 0
    for off in range(3):
        path.write_bytes(content[: int(share * len(content)) + off])
        log = read_log(path)
        partials += "cut short" in log.partial
        assert log.times[-1] < full.times[-1]
        count = len(log.times)
        assert log.rate == pytest.approx(full.rate[:count], abs=1e-9)
    assert partials >= 2  # at one place a message may just have ended


def test_a_log_goes_on_behind_damage(ardupilot, px4, tmp_path):
    for whole in (ardupilot, px4):
        content = bytearray(whole.read_bytes())
        middle = len(content) // 2
        content[middle : middle + 50] = b"\x07" * 50
        path = tmp_path / whole.name
        path.write_bytes(content)
        log, full = read_log(path), read_log(whole)
        assert "damaged" in log.partial
        assert log.times[-1] == full.times[-1]
        assert 0.85 * len(full.times) < len(log.times) <= len(full.times)


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("a.bin", b"\xa3\x95\x80" + bytes(300), "holds the layout of no message"),
        ("a.bin", b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", 9, 11, b"MSG", b"Q", b"TimeUS"), ""),
        ("a.mcap", b"\x89MCAP0\r\n" + bytes(99), "is damaged or cut short"),
        ("a.log", b"\x89MCAP0\r\n" + bytes(99), "must end in .mcap or .db3"),
        ("a.db3", b"SQLite format 3\0" + bytes(99), "is damaged or cut short"),
        ("a.bag", b"#ROSBAG V2.0\n", "is a bag of ROS 1: rosbags-convert"),
        ("a.ulg", b"ULog\x01\x12\x35\x01" + bytes(8), "no vehicle_angular_velocity in it"),
    ],
)
def test_what_holds_no_flight_is_one_line(name, content, reason, tmp_path, capsys):
    path = tmp_path / name
    path.write_bytes(content)
    assert reason in refusal(capsys, "audit", path, "--mission", "research-1.5kg")


def test_a_file_of_many_flights_is_said_to_be_one(tmp_path, capsys):
    with h5py.File(tmp_path / "many.nc", "w") as file:
        file.attrs["title"] = "many flights"
        file["run"], file["time"] = np.arange(3), np.arange(9.0)
    line = refusal(capsys, "audit", tmp_path / "many.nc", "--mission", "research-1.5kg")
    assert "holds many flights: give the file of one" in line


def test_a_folder_that_is_no_bag_is_no_log(tmp_path, capsys):
    line = refusal(capsys, "audit", tmp_path, "--mission", "research-1.5kg")
    assert "is no log of a kind that is read: netCDF" in line


@pytest.mark.slow
def test_a_flight_beyond_tolerances_is_covered_by_a_proof_on_request(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    late = flown(load("research-1.5kg", {"sensors.latency": 0.1}), Timing(2, None, None))
    save(late, "late.nc")
    words = ("audit", "late.nc", "--mission", "research-1.5kg", "--certificate", PROOF)
    status, out, _ = run(capsys, *words, "--certify", "wider.toml", "--json")
    anew = json.loads(out)["anew"]
    assert (status, anew["proved"], anew["tuned"]) == (1, True, False)
    assert "latency" in Path("late.audit.html").read_text(encoding="utf-8")
    certificate = anew["certificate"]
    assert certificate == "wider.audit.cert.json"  # `attraction` writes another
    assert run(capsys, "check", certificate, "--mission", "wider.toml")[0] == 0
    words = ("audit", "late.nc", "--mission", "wider.toml", "--certificate", certificate)
    status, out, _ = run(capsys, *words, "--certify", "other.toml", "--no-page")
    assert status == 0
    assert "proved again            nothing: the mission's own tolerances" in out
    assert not Path("other.toml").exists()


def test_gains_are_tuned_where_the_missions_own_are_not_proved(monkeypatch):
    """The searches themselves are tried elsewhere."""
    from types import SimpleNamespace

    from hoverproof.audit import recertifying
    from hoverproof.design.outcome import Infeasible

    asked = []
    unproved = SimpleNamespace(proved=None)
    monkeypatch.setattr(recertifying, "attraction", lambda mission, progress: unproved)

    def gains_for(mission, wish, progress):
        asked.append((mission, wish.objective))
        return Infeasible(mission, "too late")

    monkeypatch.setattr(recertifying, "gains_for", gains_for)
    found = recertifying.recertified(MISSION, lambda text: None)
    assert asked == [(MISSION, "start")]
    assert (found.verdict, found.tuned, found.reason) == (None, False, "too late")


@pytest.mark.parametrize("kind", ["flight", "ardupilot", "mcap", "px4"])
def test_a_part_of_a_log_is_what_is_between_two_times(kind, request):
    whole = read_log(request.getfixturevalue(kind))
    begin, end = whole.times[0] + 0.5, whole.times[0] + 1.5
    part = read_log(request.getfixturevalue(kind), between=(begin, end))
    assert part.times[0] >= begin
    assert part.times[-1] <= end
    kept = (whole.times >= begin) & (whole.times <= end)
    assert part.times == pytest.approx(whole.times[kept])
    for name in ("rate", "specific_force", "thrust_command", "rate_command", "image_age"):
        ours, theirs = getattr(part, name), getattr(whole, name)
        if theirs is not None:  # the first commands were before
            assert ours[20:] == pytest.approx(theirs[kept][20:], nan_ok=True)
    with pytest.raises(InputError, match="between these times"):
        read_log(request.getfixturevalue(kind), between=(900, 901))


def test_times_that_are_none_are_refused(flight, capsys):
    words = ("audit", flight, "--mission", "research-1.5kg", "--between")
    assert "--between: must be FROM,TO in s" in refusal(capsys, *words, "3,1")
