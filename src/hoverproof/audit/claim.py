"""What a certificate of theorem 5 says of Ψ and of what is seen, held against estimated poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof import checker
from hoverproof.audit.finding import Finding, over_time, untold
from hoverproof.audit.log import FlightLog
from hoverproof.certification.certificate import differences
from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.servo.loop import LoopNumbers, readout_function

Array = NDArray[np.float64]

ROUNDED = 1e-6


@dataclass(frozen=True, eq=False)
class Claim:
    """What is proved of Ψ: Ψ(t) <= start_level exp(-rate t).

    Attributes
    ----------
    level, start_level : float
        Dimensionless.
    rate : float
        1/s.
    weights : (3,)
        w2, w3, w4.
    """

    level: float
    start_level: float
    rate: float
    weights: Array

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> Claim:
        """Return that of the content of a certificate.

        Parameters
        ----------
        content : mapping
        """
        claim = content["claim"]
        level, start, rate = (
            float(Fraction(claim[key])) for key in ("level", "start_level", "rate")
        )
        return cls(level, start, rate, np.array([float(Fraction(w)) for w in content["weights"]]))


def given_claim(content: Mapping[str, Any], where: str, mission: Mission) -> Claim:
    """Return the claim of a certificate that the checker accepts, about the mission.

    Parameters
    ----------
    content : mapping
    where : str
        Of it, for messages.
    mission : Mission

    Raises
    ------
    InputError
        If it is rejected, about another mission, or of another theorem.
    """
    try:
        checker.check(content)
    except checker.Rejected as error:
        raise InputError(where, "", f"is rejected: {error}") from None
    if content["kind"] != "exponential":
        reason = f"is of the kind {content['kind']}: an audit is of theorem 5, exponential"
        raise InputError(where, "", reason)
    if other := differences(content, mission):
        raise InputError(where, "", f"is about another mission: {other[0]}")
    return Claim.of(content)


@dataclass(frozen=True, eq=False)
class Poses:
    """Errors and images that follow from estimated poses.

    Attributes
    ----------
    log : FlightLog
    mission : Mission
    """

    log: FlightLog
    mission: Mission

    @property
    def there(self) -> bool:
        """Whether there are poses, and what else the errors take."""
        names = ["position", "velocity", "rotation", "rate", "thrust_command"]
        return self.log.has(*names, *(["specific_force"] if self._felt else []))

    @property
    def _felt(self) -> bool:
        return self.mission.law.force == "measured"

    @cached_property
    def read(self) -> dict[str, Array]:
        """What `readout_function` makes of them, a row each sample."""
        log, numbers = self.log, LoopNumbers.of(self.mission)
        assert log.position is not None and log.velocity is not None and log.rotation is not None
        assert log.rate is not None and log.thrust_command is not None
        axes = log.rotation.transpose(0, 2, 1).reshape(-1, 9)
        parts = [log.position, log.velocity, axes, log.rate, log.thrust_command[:, None]]
        vehicle, count = self.mission.vehicle, len(log.times)
        felt = self._felt and log.specific_force is not None
        read = readout_function(
            numbers.target_size, numbers.law, vehicle.frame, with_specific_force=felt
        )
        given = [np.hstack(parts).T, np.tile(numbers.design[:, None], count)]
        given += [np.tile(numbers.points, count)]
        given += [np.full((1, count), float(x)) for x in (vehicle.reach, vehicle.drag_ratio)]
        if felt and log.specific_force is not None:
            given.append(log.specific_force.T)
        outputs = read.map(count)(*given)
        names = (read.name_out(i) for i in range(read.n_out()))
        return {
            name: np.array(value).T.reshape(count, -1)
            for name, value in zip(names, outputs, strict=True)
        }

    @cached_property
    def energy(self) -> Array:
        """|δ1|², |δ2|², |δ3|², |δ4|², (n, 4), dimensionless."""
        each = [(self.read[f"delta{i}"] ** 2).sum(axis=1) for i in (1, 2, 3, 4)]
        return np.stack(each, axis=1)

    @cached_property
    def angles(self) -> Array:
        """From the optical axis to the target point that is farthest from it, (n,), rad."""
        count = len(self.log.times)
        image = self.read["image"].reshape(count, -1, 2)
        return np.asarray(np.arctan(np.linalg.norm(image, axis=2)).max(axis=1))


def falls(poses: Poses, claim: Claim | None) -> Finding:
    """Judge whether Ψ fell as it is proved to, by its part without lag and latency.

    That part is at most Ψ, so that it breaks the bound only if Ψ does.

    Parameters
    ----------
    poses : Poses
    claim : Claim, optional
    """
    name = "Ψ falls as proved"
    if claim is None:
        return untold(name, "no certificate of theorem 5 says how")
    if not poses.there:
        return untold(name, "needs estimated positions from the target, attitude, thrust command")
    times = poses.log.times - poses.log.times[0]
    psi = poses.energy @ np.r_[1.0, claim.weights] / 2
    may_fall = claim.rate if not poses.mission.uncertainty.is_shaken else 0.0
    bound = claim.start_level * np.exp(-may_fall * times)
    share = psi / bound
    words = (
        f"Ψ is at most {np.nanmax(share):.3g} of its bound, {bound[0]:.4g} exp(-{may_fall:.4g} t)"
    )
    if psi[0] > bound[0]:
        words = f"it began outside the starts that are proved: Ψ {psi[0]:.4g}, {words}"
    return over_time(
        name, "", poses.log.times, share, 1.0, "1", words=words, allowed=ROUNDED, follows=True
    )


def in_view(poses: Poses) -> Finding:
    """Judge whether the target was within the field of view.

    Parameters
    ----------
    poses : Poses
    """
    name, half = "field of view", poses.mission.camera.half_angle
    if half is None:
        return untold(name, "the mission tells no camera.half_angle")
    if not poses.there:
        return untold(name, "needs estimated positions from the target and attitude")
    angles = poses.angles
    words = f"target points within {np.nanmax(angles):.4g} rad of the optical axis"
    return over_time(
        name, "", poses.log.times, angles, float(half), "rad", words=words, follows=True
    )
