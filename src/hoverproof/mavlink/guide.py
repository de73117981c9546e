"""The exported controller of a mission, and what it wants as body rates and thrust."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.buffered import Buffered
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.mavlink.sight import Sighting
from hoverproof.mission.sections import Mission
from hoverproof.plant.rigid_body import heading
from hoverproof.servo.laws.hamel_mahony import choices_of
from hoverproof.servo.laws.heading import flown_law
from hoverproof.servo.loop import LoopNumbers

Array = NDArray[np.float64]

TARGET = 2
"""The bit of a status: the target is not seen."""

FAULTS = {
    1: "an input is out of its box",
    TARGET: "the target is not seen",
    4: "the thrust is near the singularity, or none is felt",
}
WATCHED = {
    8: "thrust outside of the interval",
    16: "tilted beyond the bound",
    32: "a rotor or the thrust at its limit",
    64: "nothing is proved of the gains",
    128: "no heading",
}
"""Bits of a status that end no flight."""

FASTEST = 3.5
"""rad/s: the largest body rate that is asked for about an axis."""


@dataclass(frozen=True)
class Measured:
    """What a step takes in besides the image.

    Attributes
    ----------
    rotation : (3, 3)
        Body to north, east, down.
    rate : (3,)
        Body, rad/s.
    velocity : (3,)
        World, m/s.
    specific_force : (3,)
        Body, m/s².
    """

    rotation: Array
    rate: Array
    velocity: Array
    specific_force: Array


@dataclass(frozen=True)
class Wanted:
    """What a step gave.

    Attributes
    ----------
    status : int
        0, or a sum of bits.
    rates : (3,)
        Body rates to ask for, rad/s.
    thrust : float
        N.
    throttle : float
        A number from 0 to 1.
    feature : (3,)
        What the law makes of the image, body axes, dimensionless.
    """

    status: int
    rates: Array
    thrust: float
    throttle: float
    feature: Array

    @property
    def fault(self) -> str:
        """What ends the flight, in words; empty if nothing does."""
        return " and ".join(words for bit, words in FAULTS.items() if self.status & bit)

    @property
    def watched(self) -> list[str]:
        """What is to be known of it, in words."""
        return [words for bit, words in WATCHED.items() if self.status & bit]


class Guide:
    """A package in flight, one that commands body rates and throttle.

    Parameters
    ----------
    mission : Mission
    firmware : Firmware
        Of the mission, with a camera.
    oldest : float
        Age beyond which an image is not flown by, s.

    Raises
    ------
    InputError
        If the package is another one, or its self-test does not hold here.
    """

    def __init__(self, mission: Mission, firmware: Firmware, *, oldest: float) -> None:
        self.law = flown_law(mission)
        _check(mission, firmware)
        self._firmware = firmware
        self.manifest = firmware.manifest
        rotation = ca.SX.sym("R", 3, 3)
        self._heading = Buffered(ca.Function("heading", [rotation], [heading(rotation)]))
        numbers = LoopNumbers.of(mission)
        self._error = Buffered(_image_error(numbers))
        centred = numbers.points - numbers.points.mean(axis=1, keepdims=True)
        self._radius = math.sqrt(float((centred**2).sum(axis=0).mean()))
        self._lens = "lens" in firmware.manifest
        self.newest: float | None = None
        firmware.watch(oldest)

    def take_over(self, felt: float, throttle: float) -> None:
        """Begin from a steady flight, whose throttle is from now on worth what it was there.

        Parameters
        ----------
        felt : float
            Thrust over mass that the vehicle felt, m/s².
        throttle : float
            That it flew with, a number from 0 to 1.
        """
        self._firmware.take_over((0.0, 0.0, -felt), throttle)

    def see(self, sighting: Sighting, now: float, gravity_direction: Array) -> None:
        """Take in a sighting; one that cannot be used is left out, and the last one grows old.

        Parameters
        ----------
        sighting : Sighting
        now : float
            Of the step that comes next, s.
        gravity_direction : (3,)
            At the exposure, body frame.
        """
        image = sighting.seen
        if sighting.in_pixels:
            if not self._lens:
                raise InputError("--features", "pixels", "need [camera.lens] in the mission")
            status, image = self._firmware.lens(image)
            if status:
                return
        down = {"gravity_direction": gravity_direction} if self.law.sees_north else {}
        if not self._firmware.frame(image, now - sighting.at, **down):
            self.newest = sighting.at

    def step(self, measured: Measured, dt: float) -> Wanted:
        """Run one step.

        Parameters
        ----------
        measured : Measured
        dt : float
            To the next step, s.
        """
        down, rate = measured.rotation[2], measured.rate
        told: dict[str, Any] = {}
        if self.law.sees_north:
            seen, feature, north = self._firmware.turn_heading([*rate], dt, [*down])
            told["heading"] = north
        else:
            seen, feature = self._firmware.turn([*rate], dt)
        if self.law.has_compass:
            told["heading"] = self._heading(measured.rotation.T.ravel())[0]
        if self.law.force.sensed is not None:
            told["specific_force"] = measured.specific_force
        out = self._firmware.step(
            feature,
            velocity=measured.rotation.T @ measured.velocity,
            rate=rate,
            gravity_direction=down,
            dt=dt,
            target_seen=seen == 0,
            **told,
        )
        rates = np.clip(out.rate_command, -FASTEST, FASTEST)
        return Wanted(out.status | seen, rates, out.thrust, out.throttle, np.array(feature))

    def error(self, feature: Array, down: Array) -> tuple[float, float | None]:
        """Return the image error, and about how many metres that is, if the feature tells.

        Parameters
        ----------
        feature : (3,)
            Body axes, dimensionless.
        down : (3,)
            ρ, body frame.
        """
        size = float(np.linalg.norm(self._error(feature, down)[0]))
        return size, size * self._radius if self.law.feature.name == "scaled" else None


def _image_error(numbers: LoopNumbers) -> ca.Function:
    """Return (feature, ρ) ↦ δ1, (3, 1)."""
    law = numbers.law
    z, d = law.measurement.symbols(), law.design.symbols()
    given = [z.centroid, z.gravity_direction]
    error = ca.substitute(law.goal.error(z, d), d.vector(), ca.DM(numbers.design))
    return ca.Function("image_error", given, [ca.densify(error)])


def _check(mission: Mission, firmware: Firmware) -> None:
    manifest, name = firmware.manifest, firmware.name
    if manifest["mission"] != mission.exact() or manifest["law"] != choices_of(flown_law(mission)):
        raise InputError(mission.source, "", f"is not the mission of the firmware {name}")
    if manifest.get("camera") != "points":
        raise InputError("--package", name, "keeps no frames of points: export it with --camera")
    if manifest.get("rate_bandwidth") != str(mission.interface.rate_bandwidth):
        reason = "commands no body rates for this rate loop: export it with --interface rates"
        raise InputError("--package", name, reason)
    if failed := firmware.selftest():
        raise InputError(name, "", f"computes wrong on this computer: self-test vector {failed}")
