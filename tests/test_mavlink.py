"""A flight over MAVLink with a vehicle on the other end that encodes and decodes real messages.

Time runs with the vehicle and not with the machine, so that a busy machine flies the same flight.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from firmware_kit import export, tool
from hoverproof.export.binding import Firmware
from hoverproof.mavlink.autopilots import ARDUPILOT, PX4
from hoverproof.mavlink.flight import HEARTBEAT_LOST, PAUSE
from hoverproof.mavlink.flying import Wish, flight_of, package_of
from hoverproof.mavlink.guide import Guide
from hoverproof.mavlink.rehearsal import Rehearsal, patient_pilot
from hoverproof.mavlink.stand_in import HOLD, TAKES, Habits, StandIn
from hoverproof.mavlink.told import STALE
from hoverproof.mission.reading import load
from papers_law import CRAZYFLIE

MISSION = "crazyflie-2.1"
LOOP = {"interface.rate_bandwidth": "25"}
RATE = 100.0
OLDEST = 0.14
"""s: latency and three frames of the mission."""

ATTITUDE, VELOCITY, FORCE, HEARTBEAT = 30, 32, 105, 0


@pytest.fixture(scope="module")
def mission():
    return load(MISSION, LOOP)


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    tool("cc")
    return export(
        tmp_path_factory.mktemp("package"), MISSION, LOOP, camera=True, name="flown"
    ).folder


@pytest.fixture(scope="module")
def firmware(package):
    return Firmware(package)


class World:
    """A flight and its vehicle, before the first step."""

    def __init__(self, mission, firmware, habits=None, pilot=None, seed=1, **wish):
        self.vehicle = StandIn(mission, habits or Habits(), seed)
        self.reports = []
        patient = patient_pilot(lambda: self.flight.phase == "ready", after=0.2)
        self.ends = Rehearsal(self.vehicle, pilot or patient)
        ends = (self.ends, self.ends, self.ends)
        wish = Wish(RATE, **{"hover_throttle": 0.45, **wish})
        self.flight = flight_of(mission, firmware, ends, wish, self.reports.append)

    def step(self, seconds):
        """Let flight and vehicle go on together, unless the flight is over."""
        until = self.ends.now() + seconds
        while self.ends.now() < until - 1e-9 and self.flight.phase != "over":
            self.flight.step(self.ends.now())
            self.ends.wait(self.ends.now() + 1 / RATE)

    def fly_until(self, phase, most=6.0):
        until = self.ends.now() + most
        while self.flight.phase != phase:
            assert self.ends.now() < until, f"{self.flight.phase}: {self.flight.why}"
            self.step(1 / RATE)
        return self


@pytest.fixture
def world(mission, firmware):
    return lambda *args, **wish: World(mission, firmware, *args, **wish)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=lambda a: a.name)
def test_it_settles_with_messages_lost_and_overtaken(autopilot, world):
    """The battery sags by 7 % once the law flies, the wind blows, the rate loop is slower."""
    habits = Habits(autopilot, loop=0.8, lost=0.02, jitter=0.03, thrust=0.93, wind=(0.1, 0, 0))
    flown = world(habits, hover_throttle=None, duration=9.0)
    report = flown.flight.run()
    assert report.why == "flown for 9 s"
    assert not flown.flight.fault
    assert flown.vehicle.error < 0.05
    assert report.metres == pytest.approx(flown.vehicle.error, abs=0.03)
    assert flown.flight.told.overtaken > 100
    assert report.sent > 0.97 * 9 * RATE
    sent = np.array([at for at, _ in flown.vehicle.setpoints])
    assert 0.96 < len(sent) / report.sent < 1  # some were lost on the way
    assert {mask for _, mask in flown.vehicle.setpoints[:-1]} == {128}
    assert flown.vehicle.orders == []  # nothing armed, no mode changed
    assert report.hover_throttle == pytest.approx(0.45, rel=0.02)  # learned


def spoil(vehicle, kind, change):
    """Change all messages of a kind before they are sent."""
    make = vehicle._message

    def spoilt(asked):
        made = make(asked)
        if asked == kind:
            change(made)
        return made

    vehicle._message = spoilt


def silence(kind):
    def begin(flown):
        flown.vehicle.silent.add(kind)

    return begin


def blind(flown):
    flown.ends.blind = True


def spoiled(flown):
    flown.vehicle.habits = replace(flown.vehicle.habits, velocity=1e4)


def not_a_number(flown):
    flown.vehicle.habits = replace(flown.vehicle.habits, force=math.nan)


def restarted(flown):
    flown.vehicle.switched_on = flown.vehicle.time


def left(flown):
    flown.vehicle.enter(HOLD)


def disarmed(flown):
    """It says so before its rotors are slower."""
    spoil(flown.vehicle, HEARTBEAT, lambda beat: setattr(beat, "base_mode", 1))


def without_thrust(flown):
    flown.vehicle.armed = False


def stopped(flown):
    flown.ends.wait(flown.ends.now() + 0.4)  # nothing of the flight runs meanwhile


def mistaken(flown):
    def step(*_):
        raise RuntimeError("a mistake")

    flown.flight.guide.step = step


def unplugged(flown):
    def send(*_):
        raise OSError("no such device")

    flown.ends.send = send


def interrupted(flown):
    def wait(_):
        raise KeyboardInterrupt

    flown.flight.clock = type("Clock", (), {"now": flown.ends.now, "wait": staticmethod(wait)})


ARRIVAL = 0.05
"""s: delay and jitter of the link, and the time from one message to the next."""

FAULTS = {
    "images stop": (blind, OLDEST, "no image since", True),
    "attitude stops": (silence(ATTITUDE), STALE["rotation"], "no attitude", True),
    "velocity stops": (silence(VELOCITY), STALE["velocity"], "no velocity", True),
    "specific force stops": (silence(FORCE), STALE["specific_force"], "no specific force", True),
    "heartbeats stop": (silence(HEARTBEAT), HEARTBEAT_LOST, "no heartbeat", True),
    "monitor": (spoiled, 0.0, "an input is out of its box", True),
    "no number": (not_a_number, STALE["specific_force"], "no specific force", True),
    "restart": (restarted, 0.0, "has restarted", True),
    "mode": (left, 0.1, "another mode", False),
    "disarmed": (disarmed, 0.1, "disarmed", False),
    "no thrust": (without_thrust, 0.05, "none is felt", True),
    "stopped": (stopped, 0.0, "stalled the flight", True),
    "mistake": (mistaken, 0.0, "an error of the program", True),
    "unplugged": (unplugged, 0.0, "failed: no such device", True),
    "Ctrl-C": (interrupted, 0.0, "interrupted", False),
}


@pytest.mark.parametrize("name", FAULTS)
def test_nothing_is_sent_after_a_fault_and_the_vehicle_looks_after_itself(name, world):
    begin, allowed, words, is_fault = FAULTS[name]
    flown = world().fly_until("flying")
    flown.step(0.5)
    assert flown.flight.sent > 40
    onset = flown.ends.now()
    begin(flown)
    if name == "mistake":
        with pytest.raises(RuntimeError):
            flown.flight.run()
    else:
        flown.flight.run()
    assert words in flown.flight.why
    assert flown.flight.fault is is_fault
    assert flown.ends.closed
    over, sent, vehicle = flown.ends.now(), flown.ends.sent, flown.vehicle
    late = 0.4 if name == "stopped" else 0.0
    assert max(sent) <= over < onset + late + allowed + ARRIVAL + 2 / RATE
    before = len(sent)
    flown.ends.wait(over + 2.5)
    assert len(sent) == before
    last = sorted(mask for _, mask in vehicle.setpoints[-2:])
    assert last == (
        [128, 128] if name in ("mode", "disarmed", "mistake", "unplugged") else [7, 128]
    )
    if name != "mode":
        assert vehicle.fell_back == pytest.approx(vehicle.setpoints[-1][0] + 1.0, abs=0.01)
    assert vehicle.mode == HOLD
    if name != "no thrust":
        assert vehicle.tilt < 0.05
        assert vehicle.error < 0.6


def test_ArduPilot_levels_and_holds_its_height_when_setpoints_stop(world):
    flown = world(Habits(ARDUPILOT)).fly_until("flying")
    flown.step(0.5)
    last, vehicle = flown.ends.now(), flown.vehicle
    flown.ends.wait(last + 5)
    assert vehicle.fell_back == pytest.approx(last + 3, abs=0.02)
    assert vehicle.tilt < 0.02
    assert abs((vehicle.state[6:15].reshape(3, 3).T @ vehicle.state[3:6])[2]) < 0.05


@pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=lambda a: a.name)
@pytest.mark.parametrize("why", ["the pilot to arm", "an image", "take off", "throttle of hover"])
def test_no_setpoint_is_sent_until_all_is_there(autopilot, why, world):
    asked = {"hover_throttle": None} if why == "throttle of hover" else {}
    flown = world(Habits(autopilot), **asked)
    flown.vehicle.armed = why != "the pilot to arm"
    flown.ends.blind = why == "an image"
    flown.vehicle.landed = 1 if why == "take off" else 2
    flown.vehicle.silent = {83} if why == "throttle of hover" else set()
    flown.step(1.5)
    assert why in flown.flight.why
    assert flown.flight.sent == len(flown.vehicle.setpoints) == 0
    flown.vehicle.mode, flown.vehicle._entered = TAKES, flown.vehicle.time
    flown.step(0.5)
    assert flown.flight.sent == 0


def test_PX4_is_streamed_to_before_the_mode_and_ArduPilot_is_not(world):
    """As long as the law has not the vehicle, its setpoints command the thrust of hover."""
    px4 = world(Habits(PX4), pilot=lambda vehicle: None)
    px4.step(1.5)
    assert px4.flight.phase == "ready"
    assert px4.flight.sent > 100
    assert px4.flight._last_sent[1] == pytest.approx(0.45)
    assert px4.vehicle.enter(TAKES)
    quiet = world(Habits(ARDUPILOT), pilot=lambda vehicle: None)
    quiet.step(1.5)
    assert quiet.flight.phase == "ready"
    assert quiet.flight.sent == 0


def test_PX4_refuses_the_mode_without_a_stream(world):
    flown = world(Habits(PX4), pilot=lambda vehicle: None)
    flown.ends.blind = True
    flown.step(1.5)
    assert not flown.vehicle.enter(TAKES)


def test_a_vehicle_that_is_in_the_mode_already_is_not_taken_over(world):
    flown = world(Habits(ARDUPILOT), pilot=lambda vehicle: None)
    flown.vehicle.enter(TAKES)
    flown.step(1.5)
    assert flown.flight.phase == "waiting"
    assert "to leave GUIDED and enter it again" in flown.flight.why
    flown.vehicle.enter(HOLD)
    flown.step(1.2)
    flown.vehicle.enter(TAKES)
    flown.fly_until("flying")
    assert flown.flight.sent <= 1


@pytest.mark.parametrize("wrong", [-1.0, 1 / 9.80665e-3, 0.3])
def test_a_specific_force_in_other_axes_or_units_is_not_flown_by(wrong, world):
    flown = world()

    def change(told):
        told.xacc, told.yacc, told.zacc = wrong * told.xacc, wrong * told.yacc, wrong * told.zacc

    spoil(flown.vehicle, FORCE, change)
    flown.step(1.5)
    assert flown.flight.sent == 0
    assert "times the weight is felt" in flown.flight.why


def test_others_on_the_link_are_not_heard(world):
    """A second vehicle that says it is armed and in the mode, and another component."""
    flown = world(Habits(ARDUPILOT), pilot=lambda vehicle: None)
    flown.step(0.5)
    other = StandIn(flown.vehicle.mission, Habits(ARDUPILOT))
    other._codec = type(other._codec)(7, 1)
    other.mode, other.time, other._next = TAKES, 5.0, dict.fromkeys(other._next, 0.0)
    for data in other.tell():
        flown.ends._down.put(data, flown.ends.now())
    flown.step(1.0)
    assert flown.flight.phase == "ready"
    assert flown.flight.sent == 0


def test_a_law_that_takes_its_thrust_for_granted_is_refused():
    mission = load(CRAZYFLIE, {"interface.rate_bandwidth": "25"})
    with pytest.raises(ValueError, match=r"law\.force: must be 'measured'"):
        package_of(mission)


def test_a_mission_without_a_rate_loop_is_refused(package):
    plain = load(MISSION, {})
    with pytest.raises(ValueError, match=r"interface\.rate_bandwidth: is missing"):
        package_of(plain)
    with pytest.raises(ValueError, match="interface rates"):
        Guide(plain, Firmware(package), oldest=OLDEST)


def test_reports_come_twice_a_second_and_are_JSON(world):
    flown = world(duration=1.0)
    flown.flight.run()
    times = [report.time for report in flown.reports]
    np.testing.assert_allclose(np.diff(times), 0.5, atol=0.011)
    assert flown.reports[0].phase == "waiting"
    assert flown.reports[-1].phase == "flying"
    json.dumps([vars(report) for report in flown.reports], allow_nan=False)


def test_the_log_tells_what_was_told_and_what_was_sent(world, mission, tmp_path):
    xarray = pytest.importorskip("xarray")
    flown = world(duration=1.0)
    flown.flight.run()
    path = tmp_path / "log.nc"
    path.write_bytes(flown.flight.recorded(mission).netcdf())
    with xarray.open_dataset(path, engine="h5netcdf") as log:
        assert log.attrs["outcome"] == "flown for 1 s"
        assert log.attrs["autopilot"] == "PX4"
        assert np.isfinite(log["throttle"]).sum() == flown.flight.sent - 1  # the last is no law's
        assert log["body_rate"].attrs["units"] == "rad/s"
        in_flight = log.where(log["phase"] == 2, drop=True)[{"time": slice(1, None)}]
        assert np.isfinite(in_flight["rate_setpoint"]).all()
        assert (in_flight["image_age"] < OLDEST).all()
        np.testing.assert_allclose(in_flight["specific_force"][:, 2].mean(), -9.81, rtol=0.05)


def test_a_step_that_comes_a_little_late_goes_on(world):
    flown = world().fly_until("flying")
    flown.ends.wait(flown.ends.now() + PAUSE / 2)
    flown.step(0.3)
    assert flown.flight.phase == "flying"
