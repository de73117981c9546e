"""A flight over MAVLink: who has the vehicle, what is sent, and when it is handed back.

One loop in one thread of one process: whatever ends it, nothing is left that sends. A step first
hears what has come in, then judges, and sends last. A step that finds a fault is the last one: if
the vehicle is still armed and in the mode it sends one setpoint of a level attitude and the thrust
of hover, since an autopilot holds the last one until it gives up on them. Nothing is armed and no
mode is changed.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hoverproof.mavlink.autopilots import MULTICOPTERS, ON_GROUND, Autopilot
from hoverproof.mavlink.dialect import AUTOPILOT, COMPANION, Codec, dialect
from hoverproof.mavlink.guide import TARGET, Guide, Measured, Wanted
from hoverproof.mavlink.link import Clock, Link
from hoverproof.mavlink.logbook import Logbook
from hoverproof.mavlink.report import Report
from hoverproof.mavlink.sight import Sight
from hoverproof.mavlink.throttle import HoverThrottle
from hoverproof.mavlink.told import Reading, Told
from hoverproof.mission.sections import Mission
from hoverproof.simulation.record import Record

HEARTBEAT_LOST = 3.0
"""s without a heartbeat, which come once a second at least."""

PAUSE = 0.1
"""s: a step that comes later by more was kept from running; what it would send is old."""

ASK_AGAIN = 2.0
"""s between requests for messages that do not come."""

FELT = (0.7, 1.3)
"""Thrust that is felt over m g in a flight that the law may take over."""

REPORT = 0.5
"""s between reports."""


@dataclass
class Flight:
    """A flight over MAVLink.

    Attributes
    ----------
    guide : Guide
    gravity : float
        m/s².
    link : Link
    sight : Sight
    clock : Clock
    rate : float
        Of its steps, and of setpoints, Hz.
    hover : HoverThrottle
    system : int or None
        The vehicle's number; by default the first that is heard.
    duration : float or None
        After so long of its own flight it hands back, s.
    report : callable
        Takes a `Report` twice a second.
    told : Told
        By the vehicle, so far.
    log : Logbook
    phase, why : str
        See `Report`.
    fault : bool
        Whether a fault ended it.
    sent : int
        Setpoints so far: a bare number.
    """

    guide: Guide
    gravity: float
    link: Link
    sight: Sight
    clock: Clock
    rate: float
    hover: HoverThrottle
    report: Callable[[Report], None]
    system: int | None = None
    duration: float | None = None
    told: Told = field(default_factory=Told)
    log: Logbook = field(default_factory=Logbook)
    phase: str = "waiting"
    why: str = "a heartbeat"
    fault: bool = False
    sent: int = 0
    _peer: Any = None
    _asked: float = -1e9
    _took_over: float = -math.inf
    _outside: bool = False
    _last: float | None = None
    _wanted: Wanted | None = None
    _last_sent: tuple[list[float], float] | None = None
    _turns: deque[Reading] = field(default_factory=lambda: deque(maxlen=256))

    def __post_init__(self) -> None:
        self._codec = Codec(self.system or 1, COMPANION)
        self._start = self.clock.now()

    def run(self) -> Report:
        """Step at a fixed rate until the flight is over, and return how it ended.

        An interruption or an error ends it as everything else does: nothing more is sent.
        """
        next_step, next_report = self.clock.now(), self.clock.now()
        try:
            while self.phase != "over":
                now = self.clock.now()
                if now >= next_report:
                    self.report(self.told_of(now))
                    next_report = now + REPORT
                self.step(now)
                next_step = max(next_step + 1 / self.rate, now)
                self.clock.wait(next_step)
        except KeyboardInterrupt:
            self._over("interrupted", fault=False)
        except OSError as error:  # as of a cable that is pulled out
            self.phase, self.why, self.fault = "over", f"input or output failed: {error}", True
        except BaseException:
            self.phase, self.why, self.fault = "over", "an error of the program", True
            raise
        finally:
            self.link.close()
            self.sight.close()
        return self.told_of(self.clock.now())

    def step(self, now: float) -> None:
        """Hear, judge, and send if all is well.

        Parameters
        ----------
        now : float
            s.
        """
        late = self._last is not None and now - self._last > 1 / self.rate + PAUSE
        dt = 1 / self.rate if self._last is None else min(max(now - self._last, 1e-4), PAUSE)
        self._last = now
        self._hear(now)
        if self.phase == "flying":
            ended, fault = self._ended(now, late)
            if ended:
                self._over(ended, fault=fault)
                return
        missing, before = self.told.missing(now), self.sent
        measured = None if missing else self._measured()
        wanted = None if measured is None else self._guided(measured, dt)
        if self.phase == "flying":
            if wanted is None:
                self._over(f"no {missing}", fault=True)
            elif wanted.fault:
                self._over(self._faulty(wanted, now), fault=True)
            else:
                self._send(now, wanted)
        else:
            self._wait(now, missing, wanted)
        sent = self._last_sent if self.sent > before else None
        self._wanted = wanted or self._wanted
        self.log.note(now - self._start, self.phase, self._age(now), measured, wanted, sent)

    def _hear(self, now: float) -> None:
        for data, sender in self.link.receive():
            if self._peer is not None and sender != self._peer[0]:
                continue
            for message in self._codec.messages(data):
                self._take(message, sender, now)
        for sighting in self.sight.newest(now):
            self.guide.see(sighting, now, self._down_at(sighting.at))

    def _take(self, message: Any, sender: Any, now: float) -> None:
        system = message.get_srcSystem()
        if message.get_srcComponent() != AUTOPILOT:
            return
        if self._peer is None:
            wanted = self.system in (None, system)
            if not (wanted and message.get_type() == "HEARTBEAT"):
                return
            self._peer = (sender, system)
        if system != self._peer[1]:
            return
        self.told.take(message, now)
        kind, force = message.get_type(), self.told.specific_force
        if kind == "ATTITUDE_TARGET" and self.phase != "flying" and force is not None:
            beat = self.told.heartbeat
            in_air = self.told.landed != ON_GROUND
            if beat is not None and beat.armed and in_air and not beat.in_mode:
                self.hover.take(now, message.thrust, -float(force.value[2]))
        if self.told.rotation is not None:
            self._turns.append(self.told.rotation)

    def _down_at(self, at: float) -> Any:
        if not self._turns:
            return np.array([0.0, 0.0, 1.0])
        return min(self._turns, key=lambda turn: abs(turn.at - at)).value[2]

    def _ended(self, now: float, late: bool) -> tuple[str, bool]:
        """Return what ends a flight besides the controller, and whether that is a fault."""
        beat = self.told.heartbeat
        if beat is None or now - beat.at > HEARTBEAT_LOST:
            return "no heartbeat", True
        if self.told.restarted:
            return "the autopilot has restarted", True
        if not beat.armed:
            return "disarmed", False
        if not beat.in_mode:
            return "the vehicle is in another mode", False
        if late:
            return "this computer stalled the flight", True
        if self.duration is not None and now - self._took_over >= self.duration:
            return f"flown for {self.duration:g} s", False
        return "", False

    def _measured(self) -> Measured:
        told: Any = self.told
        names = ("rotation", "rate", "velocity", "specific_force")
        return Measured(*(getattr(told, name).value for name in names))

    def _guided(self, measured: Measured, dt: float) -> Wanted:
        if self.phase != "flying":
            self._begin()  # until then it commands the thrust of the hover so far
        return self.guide.step(measured, dt)

    def _age(self, now: float) -> float | None:
        return None if self.guide.newest is None else now - self.guide.newest

    def _faulty(self, wanted: Wanted, now: float) -> str:
        if wanted.status & TARGET and self.guide.newest is not None:
            return f"no image since {now - self.guide.newest:.2f} s"
        return wanted.fault

    def _wait(self, now: float, missing: str, wanted: Wanted | None) -> None:
        """Before the law has the vehicle: see whether it may have it, and take it over then."""
        beat, ready = self.told.heartbeat, self.phase == "ready"
        why = self._not_ready(now, missing, wanted)
        in_mode = beat is not None and beat.armed and beat.in_mode
        if in_mode and ready and self._outside and not why:
            self.phase, self.why, self._took_over = "flying", "", now
            self._begin()
            self._outside = False
            return  # the first setpoint of the law goes out at the next step
        if not in_mode:
            self._outside = not why
        elif not why:
            why = f"the pilot to leave {self._mode} and enter it again"
        self.phase = "waiting" if why else "ready"
        self.why = why or f"the pilot to enter {self._mode}"
        if self.phase == "ready" and wanted is not None and self._streams_first():
            self._send(now, wanted)

    @property
    def autopilot(self) -> Autopilot | None:
        """That of the vehicle, if it is heard and known."""
        return self.told.heartbeat.autopilot if self.told.heartbeat is not None else None

    @property
    def _mode(self) -> str:
        return self.autopilot.mode if self.autopilot is not None else ""

    def _streams_first(self) -> bool:
        return self.autopilot is not None and self.autopilot.stream_first

    def _not_ready(self, now: float, missing: str, wanted: Wanted | None) -> str:
        """Return what is missing for the law to take the vehicle over, in words."""
        beat = self.told.heartbeat
        if beat is None or now - beat.at > HEARTBEAT_LOST:
            return "a heartbeat"
        if beat.autopilot is None:
            return "a heartbeat of ArduPilot or PX4"
        if beat.kind not in MULTICOPTERS:
            return "a multicopter: this vehicle is none"
        if missing or (self.told.thrust_setpoint is None and self.hover.value is None):
            self._ask(now)
        if missing:
            return missing
        if not beat.armed:
            return "the pilot to arm"
        if self.told.landed == ON_GROUND:
            return "the pilot to take off"
        measured = self._measured()
        felt = -float(measured.specific_force @ measured.rotation[2]) / self.gravity
        if not FELT[0] <= felt <= FELT[1]:
            return f"a steady hover: {felt:.2f} times the weight is felt"
        if wanted is not None and wanted.status & TARGET:
            return self.sight.remark or "an image of the target"
        if wanted is not None and wanted.fault:
            return wanted.fault
        if self.hover.value is None:
            return "the throttle of hover (or --hover-throttle)"
        return ""

    def _ask(self, now: float) -> None:
        """Ask for the messages that are needed; an autopilot that does not know how does not."""
        beat = self.told.heartbeat
        if now - self._asked < ASK_AGAIN or beat is None or beat.autopilot is None:
            return
        self._asked = now
        known, fast = dialect(), self.rate
        wishes = {
            known.MAVLINK_MSG_ID_ATTITUDE: fast,
            beat.autopilot.imu: fast,
            known.MAVLINK_MSG_ID_LOCAL_POSITION_NED: fast / 2,
            known.MAVLINK_MSG_ID_ATTITUDE_TARGET: 20.0,
            known.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 2.0,
            known.MAVLINK_MSG_ID_HEARTBEAT: 10.0,
        }
        for message, rate in wishes.items():
            self.link.send(self._codec.request(self._peer[1], message, rate), self._peer[0])

    def _begin(self) -> None:
        if self.hover.steady is not None:
            self.guide.take_over(*self.hover.steady)

    def _send(self, now: float, wanted: Wanted) -> None:
        rates, throttle = [float(rate) for rate in wanted.rates], float(wanted.throttle)
        setpoint = self._codec.setpoint(now - self._start, self._peer[1], rates, throttle)
        self.link.send(setpoint, self._peer[0])
        self._last_sent = (rates, throttle)
        self.sent += 1

    def _over(self, why: str, *, fault: bool) -> None:
        flew, self.phase, self.why, self.fault = self.phase == "flying", "over", why, fault
        beat, hover, rotation = self.told.heartbeat, self.hover.value, self.told.rotation
        in_mode = beat is not None and beat.armed and beat.in_mode
        if flew and in_mode and hover is not None and rotation is not None:
            yaw = math.atan2(rotation.value[1, 0], rotation.value[0, 0])
            time = self.clock.now() - self._start
            self.link.send(self._codec.level(time, self._peer[1], yaw, hover), self._peer[0])
            self.sent += 1

    @property
    def flown(self) -> bool:
        """Whether the law has had the vehicle."""
        return self._took_over > -math.inf

    def recorded(self, mission: Mission) -> Record:
        """Return the log as a record.

        Parameters
        ----------
        mission : Mission
        """
        hover, known = self.hover.value, self.autopilot
        facts = {
            "autopilot": known.name if known else "not heard",
            "hover_throttle": math.nan if hover is None else hover,
            "setpoints": self.sent,
            "rate": self.rate,
        }
        outcome = self.why if self.phase == "over" else "not over"
        return self.log.record(mission, outcome, **facts)

    def told_of(self, now: float) -> Report:
        """Return how it stands.

        Parameters
        ----------
        now : float
            s.
        """
        beat, wanted, sent = self.told.heartbeat, self._wanted, self._last_sent
        known = self.autopilot
        error = metres = None
        if wanted is not None and self.told.rotation is not None:
            error, metres = self.guide.error(wanted.feature, self.told.rotation.value[2])
        return Report(
            time=now - self._start,
            phase=self.phase,
            why=self.why,
            autopilot=known.name if known else "",
            mode=known.mode if known else "",
            armed=beat is not None and beat.armed,
            in_mode=beat is not None and beat.in_mode,
            image_age=self._age(now),
            error=error,
            metres=metres,
            rates=None if sent is None else tuple(sent[0]),
            throttle=None if sent is None else sent[1],
            hover_throttle=self.hover.value,
            watched=tuple(wanted.watched) if wanted is not None else (),
            sent=self.sent,
        )
