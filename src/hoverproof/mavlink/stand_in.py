"""A vehicle that is not there: the plant, an autopilot's rate loop and its habits, real MAVLink.

Its autopilot has the habits of ArduPilot and PX4: it flies itself in a mode of its own, takes
setpoints in one mode alone, and gives up on them when they stop.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.buffered import Buffered
from hoverproof.algebra.derived import kept_graph
from hoverproof.export.vehicle import sense_function
from hoverproof.mavlink.autopilots import ARMED, PX4, Autopilot
from hoverproof.mavlink.dialect import ATTITUDE_IGNORE, AUTOPILOT, RATES_IGNORE, Codec, dialect
from hoverproof.mavlink.sight import Sighting
from hoverproof.mission.sections import Mission
from hoverproof.plant.rate_loop import loop_torque
from hoverproof.plant.rigid_body import BODY_SIZE, RigidBodyState, held_rate, specific_force
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation.numbers import euler_angles
from hoverproof.simulation.step import nearest_rotation, runge_kutta

Array = NDArray[np.float64]

STEP = 1 / 400
"""s."""

RATE_LOOP = 25.0
"""rad/s, of a mission that does not say."""

SYSTEM = 1
HOLD, TAKES = "hold", "takes setpoints"
MODES = {"PX4": {HOLD: 4 << 16 | 3 << 24, TAKES: 6 << 16}, "ArduPilot": {HOLD: 5, TAKES: 4}}
"""custom_mode: AUTO.LOITER and OFFBOARD, LOITER and GUIDED."""

GIVES_UP = {"PX4": 1.0, "ArduPilot": 3.0}
"""s without a setpoint: the defaults of COM_OF_LOSS_T and GUID_TIMEOUT."""

FIRST_RATES = {0: 1.0, 30: 10.0, 32: 3.0}
"""Hz: HEARTBEAT, ATTITUDE and LOCAL_POSITION_NED before anything else is asked for."""


@kept_graph
def _step_function(moments: int) -> ca.Function:
    """Return (x, T, Ω_c, ω, w, (mass, gravity, inertia), dt) ↦ x after dt, and the specific force.

    The rate loop brings about Ω̇ = ω (Ω_c - Ω); w is a force in the world frame, N.
    """
    x, thrust, wanted, loop = (ca.SX.sym(*s) for s in (("x", 18), ("T",), ("c", 3), ("w",)))
    wind, vehicle, dt = ca.SX.sym("f", 3), ca.SX.sym("vehicle", 2 + moments), ca.SX.sym("dt")
    mass, gravity, inertia = vehicle[0], vehicle[1], vehicle[2:]

    def body_of(state: ca.SX) -> RigidBodyState:
        return RigidBodyState.from_vector(ca.vertcat(state, thrust))

    def rate(state: ca.SX, half: int) -> ca.SX:
        body = body_of(state)
        return held_rate(
            body,
            torque=loop_torque(wanted, body.rate, loop, inertia),
            mass=mass,
            inertia=inertia,
            gravity=gravity,
            drag=body.rotation.T @ wind,
        )

    after = body_of(runge_kutta(rate, x, dt))
    kept = RigidBodyState(
        after.position, after.velocity, nearest_rotation(after.rotation), after.rate, thrust
    )
    felt = specific_force(thrust, mass, kept.rotation.T @ wind)
    given = [x, thrust, wanted, loop, wind, vehicle, dt]
    results = [ca.densify(ca.cse(kept.vector()[:BODY_SIZE])), ca.densify(felt)]
    return ca.Function("stand_in", given, results)


def _turning_to(up: Array) -> Array:
    """Return body rates, rad/s, that turn the z axis of the body to an axis, (3,), body frame."""
    axis = up / math.sqrt(up @ up)
    return np.array([-6 * axis[1], 6 * axis[0], 0.0])


@dataclass
class Habits:
    """How a vehicle differs from what its mission says, and what it is like.

    Attributes
    ----------
    autopilot : Autopilot
    loop : float
        Bandwidth of its rate loop over that of the mission, dimensionless.
    hover_throttle : float
        A number from 0 to 1.
    thrust : float
        What its rotors give over what they gave when the throttle of hover was learned,
        dimensionless.
    wind : (3,)
        Force over its mass, world frame, m/s².
    gyro, velocity, force, image : float
        Deviations of the noise, rad/s, m/s, m/s² and focal lengths.
    delay : float
        From a message to its coming in, s, both ways.
    jitter : float
        That is added at random, at most, s: messages overtake one another.
    lost : float
        Share of the messages that are lost, both ways, a number from 0 to 1.
    """

    autopilot: Autopilot = PX4
    loop: float = 1.0
    hover_throttle: float = 0.45
    thrust: float = 1.0
    wind: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gyro: float = 0.005
    velocity: float = 0.02
    force: float = 0.1
    image: float = 0.001
    delay: float = 0.004
    jitter: float = 0.006
    lost: float = 0.0


@dataclass
class StandIn:
    """A vehicle in flight.

    Attributes
    ----------
    mission : Mission
        It hovers at the start of the mission first.
    habits : Habits
    seed : int
        Of its noise, a bare number.
    time : float
        Since it was switched on, s.
    mode : str
        ``HOLD`` or ``TAKES``.
    armed : bool
    orders : list of int
        Numbers of all commands and messages it got that are neither a setpoint nor a wish for a
        message.
    setpoints : list of (float, int)
        When each came in, s, and its type mask.
    fell_back : float or None
        When it gave up on setpoints, s.
    switched_on : float
        When its autopilot started last, s.
    landed : int
        MAV_LANDED_STATE, a bare number: 2 is in the air.
    silent : set of int
        Numbers of messages that it does not send.
    """

    mission: Mission
    habits: Habits = field(default_factory=Habits)
    seed: int = 0
    time: float = 0.0
    mode: str = HOLD
    armed: bool = True
    orders: list[int] = field(default_factory=list)
    setpoints: list[tuple[float, int]] = field(default_factory=list)
    fell_back: float | None = None
    switched_on: float = 0.0
    landed: int = 2
    silent: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        v = self.mission.vehicle
        self._draw = np.random.default_rng(self.seed)
        self._numbers = LoopNumbers.of(self.mission)
        self.state = self._numbers.start[:BODY_SIZE].copy()
        self._weight, self._mass = float(v.weight), float(v.mass)
        self.thrust, self._lag = self._weight, float(self.mission.rotors.time_constant)
        self._vehicle = [self._mass, float(v.gravity), *map(float, v.moments)]
        self._step = Buffered(_step_function(len(v.moments)))
        self._look = sense_function(self._numbers.target_size, "points", self._numbers.law)
        self._bandwidth = float(self.mission.interface.rate_bandwidth or RATE_LOOP)
        self._codec = Codec(SYSTEM, AUTOPILOT)
        self._rates, self._next = dict(FIRST_RATES), dict.fromkeys(FIRST_RATES, 0.0)
        self._hold = self.state[:3].copy()
        self._wanted, self._throttle = np.zeros(3), self.habits.hover_throttle
        self._order: tuple[Array | None, float] = (np.zeros(3), self._throttle)
        self._felt = np.array([0.0, 0.0, -float(v.gravity)])
        self._shutter, self._frames = 0.0, 0

    @property
    def position(self) -> Array:
        """World frame, m, (3,)."""
        return self.state[:3]

    @property
    def error(self) -> float:
        """Distance from the goal of the mission, m."""
        return float(np.linalg.norm(self.state[:3] - self._numbers.goal))

    @property
    def tilt(self) -> float:
        """rad."""
        return math.acos(min(1.0, max(-1.0, self.state[14])))

    def enter(self, mode: str) -> bool:
        """Change the mode, as a pilot does, and return whether the autopilot does it.

        Parameters
        ----------
        mode : str
            ``HOLD`` or ``TAKES``.
        """
        if mode == TAKES and self.habits.autopilot.stream_first and not self._streamed():
            return False
        self.mode, self._entered = mode, self.time
        if mode == TAKES:
            self.fell_back = None
        if mode == HOLD:
            self._hold = self.state[:3].copy()
        self._order = (np.zeros(3), self.habits.hover_throttle)
        return True

    def _streamed(self) -> bool:
        """Whether setpoints have come in at 2 Hz and more for a second."""
        times = [at for at, _ in self.setpoints if at > self.time - 1.5]
        gaps = [b - a for a, b in itertools.pairwise([*times, self.time])]
        return len(times) > 2 and times[0] < self.time - 1 and max(gaps) < 0.5

    def step(self) -> None:
        """Fly on for a step."""
        self._decide()
        thrust = self.habits.thrust if self._gave_setpoints else 1.0
        aim = self._throttle / self.habits.hover_throttle * self._weight * thrust
        aim *= self.armed
        left = math.exp(-STEP / self._lag) if self._lag else 0.0
        self.thrust = aim + (self.thrust - aim) * left
        wind = self._mass * np.array(self.habits.wind)
        loop = self.habits.loop * self._bandwidth
        given = (self.state, self.thrust, self._wanted, loop, wind)
        self.state, self._felt = self._step(*given, self._vehicle, STEP)
        self.time += STEP

    @property
    def _gave_setpoints(self) -> bool:
        return self.mode == TAKES or self.fell_back is not None

    def _decide(self) -> None:
        """Set the body rates and the throttle, by a setpoint or by its own controllers."""
        name = self.habits.autopilot.name
        if self.mode == TAKES:
            last = max(self.setpoints[-1][0] if self.setpoints else 0.0, self._entered)
            if self.time - last <= GIVES_UP[name]:
                rates, self._throttle = self._order
                self._wanted = self._levelling() if rates is None else rates
                return
            self.fell_back = self.time if self.fell_back is None else self.fell_back
            if name == "PX4":
                self.enter(HOLD)
        level = self.mode == TAKES  # ArduPilot levels and holds its height
        gravity = self._vehicle[1]
        rotation = self.state[6:15].reshape(3, 3).T
        velocity = rotation @ self.state[3:6]
        pull = -2.0 * velocity - (0 if level else 1.2) * (self.state[:3] - self._hold)
        pull = np.clip(pull, -3, 3) * ((0, 0, 1) if level else (1, 1, 1))
        aim = rotation.T @ (np.array([0, 0, gravity]) - pull)
        self._wanted = _turning_to(aim)
        self._throttle = self.habits.hover_throttle * max(0.0, aim[2]) / gravity

    def _levelling(self) -> Array:
        return _turning_to(self.state[[8, 11, 14]])

    def hear(self, data: bytes) -> None:
        """Take in what comes over the link.

        Parameters
        ----------
        data : bytes
        """
        known = dialect()
        for message in self._codec.messages(data):
            if message.get_type() == "SET_ATTITUDE_TARGET":
                self.setpoints.append((self.time, message.type_mask))
                rates = (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
                known_rates = {ATTITUDE_IGNORE: np.array(rates), RATES_IGNORE: None}
                if self.mode == TAKES and message.type_mask in known_rates:
                    self._order = (known_rates[message.type_mask], message.thrust)
            elif (
                message.get_type() == "COMMAND_LONG"
                and message.command == known.MAV_CMD_SET_MESSAGE_INTERVAL
            ):
                kind = int(message.param1)
                self._rates[kind] = 1e6 / message.param2
                self._next.setdefault(kind, self.time)
            else:
                self.orders.append(getattr(message, "command", message.get_msgId()))

    def tell(self) -> Iterator[bytes]:
        """Yield the messages that are due now."""
        for kind, rate in self._rates.items():
            if kind not in self.silent and self._next[kind] <= self.time:
                self._next[kind] = max(self._next[kind] + 1 / rate, self.time)
                message = self._message(kind)
                if message is not None:
                    yield self._codec.packed(message)

    def _message(self, kind: int) -> Any:
        known, (x, noise) = dialect(), (self.state, self._draw.standard_normal)
        boot = int((self.time - self.switched_on) * 1000)
        if kind == 0:
            autopilot = 12 if self.habits.autopilot is PX4 else 3
            base = 1 | (ARMED if self.armed else 0)
            mode = MODES[self.habits.autopilot.name][self.mode]
            return known.MAVLink_heartbeat_message(2, autopilot, base, mode, 4, 3)
        if kind == known.MAVLINK_MSG_ID_ATTITUDE:
            rotation = x[6:15].reshape(1, 3, 3).transpose(0, 2, 1)
            rates = x[15:18] + self.habits.gyro * noise(3)
            return known.MAVLink_attitude_message(boot, *euler_angles(rotation)[0], *rates)
        if kind == known.MAVLINK_MSG_ID_LOCAL_POSITION_NED:
            velocity = x[6:15].reshape(3, 3).T @ x[3:6] + self.habits.velocity * noise(3)
            return known.MAVLink_local_position_ned_message(boot, *x[:3], *velocity)
        force = self._felt + self.habits.force * noise(3)
        if kind == known.MAVLINK_MSG_ID_HIGHRES_IMU:
            rest = [*x[15:18], 0, 0, 0, 1013.0, 0, 0, 20, 63, 0]
            return known.MAVLink_highres_imu_message(boot * 1000, *force, *rest)
        if kind == known.MAVLINK_MSG_ID_RAW_IMU:
            milli = [int(v) for v in (*force / 9.80665e-3, *x[15:18] * 1000)]
            return known.MAVLink_raw_imu_message(boot * 1000, *milli, 0, 0, 0, 0, 2000)
        if kind == known.MAVLINK_MSG_ID_ATTITUDE_TARGET:
            quaternion = [1.0, 0.0, 0.0, 0.0]
            order = (*self._wanted, self._throttle)
            return known.MAVLink_attitude_target_message(boot, 0, quaternion, *order)
        if kind == known.MAVLINK_MSG_ID_EXTENDED_SYS_STATE:
            return known.MAVLink_extended_sys_state_message(0, self.landed)
        return None

    def photograph(self, now: float) -> Sighting | None:
        """Return what the camera exposes now, if a frame is due.

        Parameters
        ----------
        now : float
            By the clock of the flight, s.
        """
        if self.time < self._shutter:
            return None
        period = 1 / float(self.mission.sensors.frame_rate or 30)
        self._shutter = max(self._shutter + period, self.time)
        numbers = self._numbers
        told = self._look(self.state, numbers.points, self.thrust, numbers.design)
        image = np.array(told[0]).T
        return Sighting(now, image + self.habits.image * self._draw.standard_normal(image.shape))
