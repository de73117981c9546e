"""What the errors, the thrust and the tilt come to on a set, for all vehicles within tolerance.

All in floating point; `checker.Exponential` bounds the same exactly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.exponential.reach import Reach
from hoverproof.certification.exponential.vehicles import Vehicles

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limits:
    """What follows from the reach of the errors, for the vehicles and a ball of J.

    Attributes
    ----------
    vehicles : Vehicles
    reach : Reach
    largest : float
        Bound of |J|, 1/m.
    """

    vehicles: Vehicles
    reach: Reach
    largest: float

    @cached_property
    def force(self) -> float:
        """Bound of |F|, N."""
        return self.vehicles.stiffness * self.reach.force

    @cached_property
    def thrust(self) -> tuple[float, float]:
        """Ends of the thrust that is measured, N; not a number if it may vanish."""
        v = self.vehicles
        gust, low = v.gust, v.weight - self.force
        lowest = np.sqrt(low**2 - gust**2) if low > gust else np.nan
        return float(lowest), v.weight + self.force

    @cached_property
    def lever(self) -> tuple[float, float]:
        """Ends of D_c, N; not a number if it may vanish."""
        singular = self.vehicles.stiffness * self.vehicles.in_image
        low, high = (x - singular for x in self.thrust)
        return (low if low > 0 else np.nan), high

    @cached_property
    def quickness(self) -> tuple[float, float]:
        """Ends of h = c κ/D_c, 1/s."""
        low, high = self.lever
        gain = self.vehicles.stiffness * self.vehicles.pace
        return gain / high, gain / low

    @cached_property
    def tilt(self) -> float:
        """Bound of the sine of the tilt."""
        v = self.vehicles
        return (self.force + v.gust) / v.weight

    @cached_property
    def late(self) -> float:
        """Bound of |n + ν|: what is used of the feature and of V, less what is now, but a hold."""
        v = self.vehicles
        speed = self.reach.speed / float(v.design.slowness)
        swept = v.swept * (self.sweep * self.reach.turn + v.yaw_rate * self.seen)
        return v.age * self.largest * speed + swept + self.missed

    @cached_property
    def ahead(self) -> float:
        """Bound of the same as the controller runs, with the accelerometer; NaN if it is slow."""
        gain = self.vehicles.force_lag * self.lift
        return (self.late + gain * self.reach.d3) / (1 - gain) if gain < 1 else np.nan

    @property
    def lift(self) -> float:
        """Bound of how fast the thrust changes over what δ3z is used, over c, 1/s."""
        return (1 + self.vehicles.thrust) * self.vehicles.pace

    @property
    def swayed(self) -> float:
        """Bound of what the low-pass leaves, over c, as the vehicle turns in the wind."""
        v = self.vehicles
        turning = self.quickness[1] * self.reach.turn + v.yaw_rate
        return v.force_lag * turning * v.gust / v.stiffness

    @property
    def shock(self) -> float:
        """Bound of the error of the force over c, dimensionless."""
        return self.vehicles.shock + self.swayed

    @cached_property
    def lifted(self) -> float:
        """Bound of how much the thrust changes in what the force is behind, over c."""
        return self.vehicles.behind * self.lift * (self.reach.d3 + self.ahead)

    @cached_property
    def sunk(self) -> float:
        """Bound of the third part of what is used less what is now."""
        v, r = self.vehicles, self.reach
        moved = v.pull * r.force + self.quickness[1] * r.d3 * r.turn
        return self.late + v.control_period * moved + self.lifted

    @property
    def missed(self) -> float:
        """Bound of |ν|: of that what is there without y and errors; a wrong gyroscope turns too."""
        v = self.vehicles
        return v.missed + self.swayed + (v.age - v.swept) * v.gyro * self.seen

    @property
    def seen(self) -> float:
        """Bound of the length of the feature, dimensionless."""
        return self.vehicles.goal + self.reach.image

    @property
    def sweep(self) -> float:
        """Bound of how fast tilting turns the feature, over |ζ|, 1/s."""
        return self.quickness[1] * self.seen

    @cached_property
    def gust(self) -> float:
        """m w̄ over the least lever: bound of |χ - 1|."""
        return self.vehicles.gust / self.lever[0]

    @cached_property
    def crosswind(self) -> float:
        """Bound of |p3|, 1/s."""
        return self.quickness[1] * self.reach.turn * self.gust

    @cached_property
    def sinking(self) -> float:
        """Bound of |p1 - p2|, 1/s."""
        return self.quickness[1] * (self.reach.d3 + self.ahead)

    @cached_property
    def stray(self) -> float:
        """Bound of the share by which the h that the controller has is wrong; NaN if by all."""
        v, lever = self.vehicles, self.lever[0]
        felt = v.felt + v.stiffness * self.lifted
        felt += v.behind * self.quickness[1] * self.reach.turn * v.gust
        return felt / (lever - felt) if lever > felt else np.nan

    @cached_property
    def wobble(self) -> float:
        """Bound of the error of π that the controller has, 1/s."""
        v, stray = self.vehicles, self.stray
        turning = self.quickness[1] * self.reach.turn * v.felt + v.gyro * (v.gust + v.felt)
        turning += 2 * self.quickness[1] * self.reach.turn * v.gust if v.behind else 0.0
        own = stray * (2 * self.sinking + self.crosswind)
        return own + (1 + stray) * turning / self.lever[0]

    @cached_property
    def struck(self) -> float:
        """Bound of what errors of force and body rates, without others, add to the command, 1/s."""
        v, slow = self.vehicles, 1 / self.quickness[0]
        return (1 + self.stray) * v.pull * self.shock + self.turning * v.gyro * slow

    @cached_property
    def turning(self) -> float:
        """Bound of what an error of e3×Ω is multiplied by in the command, but for h, 1/s."""
        v = self.vehicles
        own = (v.yaw_rate + v.gyro) * v.gyroscopic
        return v.stiff + 2 * self.sinking + self.crosswind + self.wobble + own

    @cached_property
    def misled(self) -> tuple[float, float, float]:
        """By how much ζ, P(δ3 - n) and P(δ3 - δ2) are wrong in the command at most, 1/s."""
        v, stray = self.vehicles, self.stray
        twisted = stray * (v.stiff + v.yaw_rate) + (1 + stray) * v.gyro
        return self.wobble + v.gyro * v.gyroscopic, twisted, stray * v.pull

    def disturbances(self) -> list[tuple[str, float]]:
        """Return the bounds of what is there without any error of the vehicle, by name.

        "noise" is in what is used of the image error, "command" in the command, and "gust" in the
        rates of δ2, δ3 and δ4.
        """
        v = self.vehicles
        shaken = 1.0 if v.rotor_lag else 1 + v.torque
        each = [
            ("noise", self.missed),
            ("command", shaken * self.struck),
            ("gust", float(v.design.slowness) * v.gusts),
        ]
        return [(name, bound) for name, bound in each if bound]

    @cached_property
    def lean(self) -> float:
        """Bound of the tangent of half the tilt."""
        return float(self.tilt / (1 + np.sqrt(1 - self.tilt**2)))

    @cached_property
    def stretching(self) -> float:
        """Bound of |D_c'/D_c| with rotors that lag, 1/s."""
        return (1 + self.vehicles.thrust) * self.sinking + self.crosswind

    def vertices(self) -> Iterator[tuple[float, ...]]:
        """Yield χ, h, ς, τ and π at all vertices, and how the vehicle leans most."""
        v = self.vehicles
        swing = 2 * self.sinking + self.crosswind if v.thrust or v.torque or v.rotor_lag else 0.0
        sides = (
            (1 - self.gust, 1 + self.gust),
            self.quickness if v.in_image else (0.0,),
            (1 - v.thrust, 1 + v.thrust),
            (0.0, v.rotor_lag),
            (-swing, swing),
            (self.lean if v.in_image else 0.0,),
        )
        yield from itertools.product(*(sorted(set(side)) for side in sides))
