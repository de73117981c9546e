"""What a vehicle can do, as limits that gains must keep: bandwidth, sampling, tilt and rotors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.decimals import decimal_below
from hoverproof.algebra.derived import kept_graph
from hoverproof.errors import InputError
from hoverproof.mission.frame import Frame
from hoverproof.mission.sections import Mission
from hoverproof.mission.task import Gains
from hoverproof.plant import rotors
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers

Array = NDArray[np.float64]

BANDWIDTH_TIMES_SAMPLE = 0.2
"""Largest bandwidth times sampling period: some 30 samples a period of the fastest motion."""

LEAST = 1e-6
"""Of a limit, in its unit: nothing is computed with less."""
ANY = 1e6
"""A bandwidth that is no limit, rad/s."""
YAW_PART = 4
YAW_EFFORT = 2
BINDS = 0.01
"""A limit binds where less than this part of it is left."""


@dataclass(frozen=True)
class Limits:
    """What gains must keep to; None where there is no limit.

    Attributes
    ----------
    bandwidth : float
        Largest attitude bandwidth (k1 k2 + k3 + k4)/m, rad/s.
    rate : float or None
        Sampling rate of the controller, 1/s; the bandwidth times its period is kept below
        `BANDWIDTH_TIMES_SAMPLE`.
    tilt : float or None
        Largest tilt that the controller may ask for at the mission's start, rad.
    rotor_thrust : float or None
        Largest thrust of a rotor, N; the first command must keep each below this.
    least_thrust : float or None
        Lowest thrust of a rotor, N; 0 if only the largest is given.
    """

    bandwidth: float
    rate: float | None = None
    tilt: float | None = None
    rotor_thrust: float | None = None
    least_thrust: float | None = None

    def __post_init__(self) -> None:
        for option, value, unit, most in (
            ("--bandwidth", self.bandwidth, "rad/s", ANY),
            ("--rate", self.rate, "Hz", 1e9),
            ("--tilt", self.tilt, "rad", math.pi / 2),
            ("--rotor-thrust", self.rotor_thrust, "N", 1e9),
        ):
            if value is not None and not LEAST <= value <= most:
                words = f"must be from {LEAST:g} to {most:g} {unit}, not {value:g}"
                raise InputError(option, "", words)

    @property
    def rotors(self) -> tuple[float, float] | None:
        """The lowest and the largest thrust of a rotor, N; None without limits."""
        if self.rotor_thrust is None and self.least_thrust is None:
            return None
        most = math.inf if self.rotor_thrust is None else self.rotor_thrust
        return self.least_thrust or 0.0, most

    @property
    def fastest(self) -> float:
        """The bandwidth that both bandwidth and sampling allow, rad/s."""
        sampled = math.inf if self.rate is None else BANDWIDTH_TIMES_SAMPLE * self.rate
        return min(self.bandwidth, sampled)


@dataclass(frozen=True)
class Use:
    """How much of a limit some gains use.

    Attributes
    ----------
    name : str
    value, limit : float
        Bare numbers in `unit`.
    unit : str
    set_by : str
        The option, or the key of the mission, that says the limit; empty if none does.
    least : bool
        Whether the value must not be below the limit, rather than above.
    reached : bool
        Whether a search came to the limit, before its gains were rounded and proved.
    """

    name: str
    value: float
    limit: float
    unit: str
    set_by: str = ""
    least: bool = False
    reached: bool = False

    @property
    def binds(self) -> bool:
        """Whether hardly anything of the limit is left, or was before rounding."""
        return self.reached or abs(self.value - self.limit) <= BINDS * max(
            abs(self.limit), abs(self.value)
        )


@dataclass(frozen=True)
class FirstCommand:
    """The command at the mission's start as a function of the gains, in floating point.

    Attributes
    ----------
    mission : Mission
    measured : (k,)
        What is measured at the start, in the order of the law's measurement.
    numbers : LoopNumbers
    """

    mission: Mission
    measured: Array
    numbers: LoopNumbers

    @classmethod
    def of(cls, mission: Mission) -> FirstCommand:
        """Look at the target from the mission's start.

        Parameters
        ----------
        mission : Mission

        Raises
        ------
        InputError
            If the goal of the mission cannot be seen.
        """
        numbers = LoopNumbers.of(mission)
        return cls(mission, numbers.measured(), numbers)

    def __call__(self, gains: tuple[Array, ...]) -> tuple[Array, Array]:
        """Return rotor thrusts, N, (4, n), and the tilt asked for, rad, (n,), for n sets of gains.

        Parameters
        ----------
        gains : (4,) of (n,)
            Those of the error chain, in the order and units of the law's design.
        """
        n = len(gains[0])
        vehicle = self.mission.vehicle
        thrusts, tilt = _first_command(self.numbers.law, vehicle.frame)(
            np.tile(self.measured[:, None], n),
            self.numbers.designs(gains),
            np.full((1, n), float(vehicle.reach)),
            np.full((1, n), float(vehicle.drag_ratio)),
        )
        return np.array(thrusts), np.array(tilt).ravel()


@kept_graph
def _first_command(law: Law, frame: Frame) -> ca.Function:
    """Return (measurement, design, arm, drag ratio) ↦ (rotor thrusts, tilt asked for).

    The force asked for is the F at which δ3 = 0; the thrust that makes it lies along m g ρ - F.
    """
    controller = derive_controller(law)
    z, d = controller.measured, controller.design
    arm, drag = ca.SX.sym("arm"), ca.SX.sym("drag_ratio")
    thrusts = rotors.rotor_thrusts(frame, z.thrust, controller.torque, arm, drag)
    asked = d.mass * d.gravity * z.gravity_direction + d.stiffness * law.errors(z, d).d2
    across, along = ca.cross(z.gravity_direction, asked), ca.dot(z.gravity_direction, asked)
    tilt = ca.atan2(ca.norm_2(across), along)
    return ca.Function("first_command", [z.vector(), d.vector(), arm, drag], [thrusts, tilt])


def highest_k4(
    limits: Limits, command: FirstCommand, gains: tuple[Array, Array, Array]
) -> tuple[Array, Array]:
    """Return the lowest and the highest k4 that the limits allow, kg/s, (n,) each.

    Nothing is allowed where the lowest is not below the highest, or either is NaN. The first
    command is affine in k4, and so is the bandwidth.

    Parameters
    ----------
    limits : Limits
    command : FirstCommand
    gains : (3,) of (n,)
        k1, k2, k3.
    """
    k1, k2, k3 = gains
    low = np.zeros(len(k1))
    high = limits.fastest * float(command.mission.vehicle.mass) - k1 * k2 - k3
    if limits.tilt is None and limits.rotors is None:
        return low, high
    unit = np.maximum(high, 1e-300)
    at_zero, tilt = command((*gains, low))
    if limits.tilt is not None:
        high = np.where(tilt <= limits.tilt, high, np.nan)
    if limits.rotors is not None:
        least, most = limits.rotors
        slope = (command((*gains, unit))[0] - at_zero) / unit
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([(least - at_zero) / slope, (most - at_zero) / slope])
        fixed = (at_zero >= least) & (at_zero <= most)
        ends = np.where(slope == 0, np.where(fixed, [[[-np.inf]], [[np.inf]]], np.nan), ends)
        low = np.maximum(low, ends.min(axis=0).max(axis=0))
        high = np.minimum(high, ends.max(axis=0).min(axis=0))
    return low, high


def bandwidth(mission: Mission) -> float:
    """Return the attitude bandwidth of a mission's gains, rad/s.

    Parameters
    ----------
    mission : Mission
    """
    return float(HAMEL_MAHONY.bandwidth(mission.vehicle.mass, *_chain_gains(mission)))


def _chain_gains(mission: Mission) -> list[Fraction]:
    """Return the gains of the error chain, in the order of the law's design."""
    return [getattr(mission.gains, name) for name in HAMEL_MAHONY.design.chain_gains()]


def uses(limits: Limits, command: FirstCommand, mission: Mission) -> list[Use]:
    """Return how much of each limit the gains of a mission use.

    Parameters
    ----------
    limits : Limits
    command : FirstCommand
    mission : Mission
        The same start and goal as `command`, with the gains in question.
    """
    fastest = bandwidth(mission)
    used = [Use("bandwidth", fastest, limits.bandwidth, "rad/s", "--bandwidth")]
    if limits.rate is not None:
        product = fastest / limits.rate
        name = "bandwidth times sampling period"
        used.append(Use(name, product, BANDWIDTH_TIMES_SAMPLE, "1", "--rate"))
    gains = tuple(np.array([float(k)]) for k in _chain_gains(mission))
    thrusts, tilt = command(gains)
    if limits.tilt is not None:
        asked = float(tilt[0])
        used.append(Use("tilt asked for at the start", asked, limits.tilt, "rad", "--tilt"))
    if limits.rotors is not None:
        least, most = limits.rotors
        if most < math.inf:
            highest = float(thrusts.max())
            name = "highest rotor thrust at the start"
            used.append(Use(name, highest, most, "N", "--rotor-thrust"))
        name, lowest = "lowest rotor thrust at the start", float(thrusts.min())
        used.append(Use(name, lowest, least, "N", "rotors.min_thrust", least=True))
    return used


def designed_gains(mission: Mission, four: Sequence[Fraction], bandwidth: float) -> Gains:
    """Return gains with a k_yaw that suits a bandwidth.

    Yaw is damped at a quarter of the bandwidth, but a turn of 1 rad/s takes no more than half the
    torque about the yaw axis that two rotors at rest and two at twice their hover thrust have.

    Parameters
    ----------
    mission : Mission
    four : (4,) Fractions
        Those of the error chain, in the order and units of the law's design.
    bandwidth : float
        rad/s.
    """
    v = mission.vehicle
    effort = v.drag_ratio * v.weight / YAW_EFFORT
    k_yaw = decimal_below(min(v.inertia[2] * Fraction(bandwidth) / YAW_PART, effort), 2)
    chain = dict(zip(HAMEL_MAHONY.design.chain_gains(), four, strict=True))
    return Gains(**chain, k_yaw=k_yaw)
