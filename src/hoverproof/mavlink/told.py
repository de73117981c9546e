"""What a vehicle tells of itself over MAVLink, in the frames and units of the law."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.mavlink.autopilots import ARDUPILOT, ARMED, AUTOPILOTS, Autopilot
from hoverproof.plant.rigid_body import rotation_matrix

Array = NDArray[np.float64]

MILLI_G = 9.80665e-3
"""m/s² in a thousandth of standard gravity."""

BODY_FRD, LOCAL_NED = 12, 1
"""MAV_FRAME of the velocity and the attitude of ODOMETRY."""

RESTART = 1.0
"""s: a stamp that is older by more is of a vehicle that has started anew, not of a late packet."""

DRIFT = 2e-4
"""s in a second: by how much two clocks may run apart; that of a simulator may by more."""

STALE = {"rotation": 0.15, "rate": 0.15, "velocity": 0.3, "specific_force": 0.15}
"""s: the age from which on something is not flown by."""

WORDS = {
    "rotation": "attitude (ATTITUDE or ATTITUDE_QUATERNION)",
    "rate": "body rate (ATTITUDE or ATTITUDE_QUATERNION)",
    "velocity": "velocity (LOCAL_POSITION_NED or ODOMETRY)",
    "specific_force": "specific force (HIGHRES_IMU, SCALED_IMU or ArduPilot's RAW_IMU)",
}


@dataclass
class Stamps:
    """The clock of a sender, told by the stamps of one kind of message.

    What comes with the least delay tells how the clocks stand to one another; what comes later than
    that was true before it came.

    Attributes
    ----------
    newest : float
        Stamp, s.
    ahead : float
        Our clock less theirs, s.
    restarted : bool
        Whether the stamps began anew.
    overtaken : int
        How many came behind a newer one: a bare number.
    drift : float
        By how much the clocks may run apart, s in a second.
    """

    newest: float = -math.inf
    ahead: float = math.inf
    restarted: bool = False
    overtaken: int = 0
    drift: float = DRIFT

    def read(self, stamp: float, now: float) -> float | None:
        """Return when that was by our clock, s; None of what is no newer than what came before.

        Parameters
        ----------
        stamp, now : float
            By their clock and by ours, s.
        """
        if stamp < self.newest - RESTART:
            self.newest, self.ahead, self.restarted = -math.inf, math.inf, True
        if stamp <= self.newest:
            self.overtaken += 1
            return None
        passed = stamp - self.newest if self.newest > -math.inf else 0.0
        self.newest = stamp
        self.ahead = min(self.ahead + self.drift * passed, now - stamp)
        return stamp + self.ahead


@dataclass(frozen=True)
class Reading:
    """What was told.

    Attributes
    ----------
    value : ndarray, any shape
        In the unit of what it is of.
    at : float
        When it was true by our clock, s.
    """

    value: Array
    at: float


@dataclass(frozen=True)
class Heartbeat:
    """What a heartbeat tells.

    Attributes
    ----------
    autopilot : Autopilot or None
        None if it is not known.
    kind : int
        MAV_TYPE, a bare number.
    armed : bool
    in_mode : bool
        Whether the mode is the one that takes setpoints.
    at : float
        When it came in by our clock, s.
    """

    autopilot: Autopilot | None
    kind: int
    armed: bool
    in_mode: bool
    at: float


@dataclass
class Told:
    """The newest of all that a vehicle tells.

    Attributes
    ----------
    heartbeat : Heartbeat or None
    rotation : Reading or None
        R, (3, 3), body (forward, right, down) to world (north, east, down).
    rate : Reading or None
        Ω, (3,), body, rad/s.
    velocity : Reading or None
        (3,), world, m/s.
    specific_force : Reading or None
        (3,), body, m/s².
    thrust_setpoint : Reading or None
        The throttle, 0 to 1, that its own controllers ask for, (1,).
    landed : int
        MAV_LANDED_STATE, a bare number; 0 if it does not say.
    refused : dict
        Messages that cannot be used, and why.
    drift : float
        By how much the vehicle's clock and ours may run apart, s in a second.
    """

    heartbeat: Heartbeat | None = None
    rotation: Reading | None = None
    rate: Reading | None = None
    velocity: Reading | None = None
    specific_force: Reading | None = None
    thrust_setpoint: Reading | None = None
    landed: int = 0
    refused: dict[str, str] = field(default_factory=dict)
    drift: float = DRIFT
    _clocks: dict[str, Stamps] = field(default_factory=dict)

    @property
    def overtaken(self) -> int:
        """How many messages came behind a newer one of their kind, and were left out."""
        return sum(clock.overtaken for clock in self._clocks.values())

    @property
    def restarted(self) -> bool:
        """Whether the vehicle has started anew since it was first heard."""
        return any(clock.restarted for clock in self._clocks.values())

    def missing(self, now: float) -> str:
        """Return what the vehicle has not told, or not lately, in words; "" if all is there.

        Parameters
        ----------
        now : float
            s.
        """
        for name, oldest in STALE.items():
            reading = getattr(self, name)
            if reading is None:
                return WORDS[name]
            if now - reading.at > oldest:
                return f"{WORDS[name]} since {now - reading.at:.2f} s"
        return ""

    def take(self, message: Any, now: float) -> None:
        """Take in a message; what is not known is left out.

        Parameters
        ----------
        message : MAVLink_message
            Of the vehicle's autopilot.
        now : float
            Our clock, s.
        """
        kind = message.get_type()
        taken = getattr(self, f"_{kind.lower()}", None)
        if taken is None:
            return
        if kind in ("HEARTBEAT", "EXTENDED_SYS_STATE"):
            taken(message, now)
            return
        boot = getattr(message, "time_boot_ms", None)
        stamp = message.time_usec / 1e6 if boot is None else boot / 1e3
        at = self._clocks.setdefault(kind, Stamps(drift=self.drift)).read(stamp, now)
        if at is not None:
            taken(message, at)

    def _put(self, name: str, values: Any, at: float, source: str) -> None:
        value = np.array(values, float)
        if not np.isfinite(value).all():
            self.refused[source] = "holds what is no number"
            return
        before = getattr(self, name)
        if before is None or at >= before.at:
            setattr(self, name, Reading(value, at))

    def _heartbeat(self, message: Any, now: float) -> None:
        known = AUTOPILOTS.get(message.autopilot)
        armed = bool(message.base_mode & ARMED)
        takes = known is not None and known.takes(message.custom_mode)
        self.heartbeat = Heartbeat(known, message.type, armed, takes, now)

    def _extended_sys_state(self, message: Any, now: float) -> None:
        self.landed = message.landed_state

    def _attitude(self, message: Any, at: float) -> None:
        rotation = rotation_matrix(message.roll, message.pitch, message.yaw)
        self._put("rotation", rotation, at, "ATTITUDE")
        rates = (message.rollspeed, message.pitchspeed, message.yawspeed)
        self._put("rate", rates, at, "ATTITUDE")

    def _attitude_quaternion(self, message: Any, at: float) -> None:
        quaternion = (message.q1, message.q2, message.q3, message.q4)
        rates = (message.rollspeed, message.pitchspeed, message.yawspeed)
        if self._unit(quaternion, "ATTITUDE_QUATERNION"):
            rotation = rotation_of_quaternion(quaternion)
            self._put("rotation", rotation, at, "ATTITUDE_QUATERNION")
            self._put("rate", rates, at, "ATTITUDE_QUATERNION")

    def _local_position_ned(self, message: Any, at: float) -> None:
        velocity = (message.vx, message.vy, message.vz)
        self._put("velocity", velocity, at, "LOCAL_POSITION_NED")

    def _odometry(self, message: Any, at: float) -> None:
        if (message.frame_id, message.child_frame_id) != (LOCAL_NED, BODY_FRD):
            frames = f"{message.frame_id} and {message.child_frame_id}"
            self.refused["ODOMETRY"] = f"is in the frames {frames}, not LOCAL_NED and BODY_FRD"
        elif self._unit(message.q, "ODOMETRY"):
            velocity = np.array([message.vx, message.vy, message.vz])
            self._put("velocity", rotation_of_quaternion(message.q) @ velocity, at, "ODOMETRY")

    def _highres_imu(self, message: Any, at: float) -> None:
        if message.fields_updated & 7 == 7:
            force = (message.xacc, message.yacc, message.zacc)
            self._put("specific_force", force, at, "HIGHRES_IMU")

    def _scaled_imu(self, message: Any, at: float) -> None:
        force = MILLI_G * np.array([message.xacc, message.yacc, message.zacc])
        self._put("specific_force", force, at, "SCALED_IMU")

    def _raw_imu(self, message: Any, at: float) -> None:
        if self.heartbeat is not None and self.heartbeat.autopilot is ARDUPILOT:
            self._scaled_imu(message, at)  # ArduPilot scales it as SCALED_IMU
        else:
            self.refused["RAW_IMU"] = "has units of the sensor, which are not known"

    def _attitude_target(self, message: Any, at: float) -> None:
        self._put("thrust_setpoint", [message.thrust], at, "ATTITUDE_TARGET")

    def _unit(self, quaternion: Any, source: str) -> bool:
        length = math.sqrt(sum(c * c for c in quaternion))
        if abs(length - 1) < 1e-2:
            return True
        self.refused[source] = "has an attitude that is no unit quaternion"
        return False


def rotation_of_quaternion(quaternion: Any) -> Array:
    """Return the rotation of a quaternion, scalar first, (3, 3).

    Parameters
    ----------
    quaternion : (4,)
        Of length about 1.
    """
    w, x, y, z = np.array(quaternion, float) / math.sqrt(sum(c * c for c in quaternion))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
