"""What the record of a flight says of its mission: all that a picture needs besides the motion."""

from __future__ import annotations

import json
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.frame import X
from hoverproof.mission.task import LawChoice
from hoverproof.plant.camera import body_points, pinhole
from hoverproof.plant.rigid_body import rotation_matrix
from hoverproof.simulation.record import Recorded

Array = NDArray[np.float64]
FLOWN = "flown"
"""How a flight ended that is whole."""
Flight: TypeAlias = Recorded
"""What `simulate` or `flown` returned. A picture needs no xarray, which takes long to import."""


@dataclass(frozen=True)
class Scene:
    """The surroundings of a flight.

    Attributes
    ----------
    name : str
        Of the mission.
    law : str
        Its choices.
    points : (n, 3)
        Target, world frame, m.
    goal : (3,)
        World frame, m.
    weight : float
        m g, N.
    arm : float
        Root mean square of the distances of the rotors from the centre of mass over √2, m; in an X
        frame their lever.
    rotor_places : (n, 3)
        Where the rotors are in the body frame, m.
    rotor_limits : (lowest or None, highest or None)
        Of the thrust of one rotor, N.
    image_size : (width, height) or None
        Of the image, in numbers of focal lengths, with the optical axis in its middle; None
        without an edge.
    half_angle : float or None
        Of the cone about the z axis of the body that the lens sees, rad, if the mission tells it.
    errors : str
        What of the vehicle is not as modelled, in words.
    ended : str
        How the flight ended, if early.
    """

    name: str
    law: str
    points: Array
    goal: Array
    weight: float
    arm: float
    rotor_places: Array
    rotor_limits: tuple[float | None, float | None]
    image_size: tuple[float, float] | None
    half_angle: float | None
    errors: str
    ended: str

    @classmethod
    def of(cls, record: Flight) -> Scene:
        """Read the attributes of a flight, or of runs.

        ``mission``, ``law`` and ``goal_position`` must be there. Of ``conditions`` (JSON, as
        ``mission``) come the limits of the rotors (``rotors.min_thrust``, ``rotors.max_thrust``, N)
        the edge of the image (``sensors.focal_length``, ``width``, ``height``, px) and errors of
        the model (``model_error``).

        Parameters
        ----------
        record : Dataset or Record
            From `simulate` or `flown`.
        """
        mission = json.loads(record.attrs["mission"])
        conditions = {**mission, **json.loads(record.attrs.get("conditions", "{}"))}
        vehicle, rotors = mission["vehicle"], conditions.get("rotors", {})
        places = _rotor_places(vehicle)
        return cls(
            name=mission["name"],
            law=record.attrs["law"],
            points=np.array([[_float(c) for c in p] for p in mission["target"]["points"]]),
            goal=np.array(record.attrs["goal_position"], float),
            weight=_float(vehicle["mass"]) * _float(vehicle["gravity"]),
            arm=float(np.sqrt((places**2).sum(axis=1).mean() / 2)),
            rotor_places=places,
            rotor_limits=(_maybe(rotors, "min_thrust"), _maybe(rotors, "max_thrust")),
            image_size=_image_size(conditions.get("sensors", {})),
            half_angle=_half_angle(mission.get("camera", {})),
            errors=_errors(conditions.get("model_error", {})),
            ended="" if (ended := record.attrs.get("outcome", FLOWN)) == FLOWN else ended,
        )

    @property
    def title(self) -> str:
        """Name of the mission, the law where it is not the paper's, and errors of the model."""
        papers = LawChoice().name
        name = self.name if self.law == papers else f"{self.name} ({self.law})"
        return f"{name}, {self.errors}" if self.errors else name

    def titled(self, words: str) -> str:
        """Return the title of a figure: `title`, its words, and how the flight ended if early.

        Parameters
        ----------
        words : str
        """
        return f"{self.title}: {words}" + (f"\nended early: {self.ended}" if self.ended else "")

    def goal_image(self, yaw: float) -> Array:
        """Return the pinhole image of the target from the goal, (n, 2), at a yaw in rad.

        Parameters
        ----------
        yaw : float
            rad.
        """
        rotation = ca.SX(rotation_matrix(0.0, 0.0, yaw))
        seen = body_points(ca.SX(self.points.T), ca.SX(self.goal), rotation)
        return np.array(ca.evalf(pinhole(seen))).T


def _rotor_places(vehicle: dict[str, Any]) -> Array:
    """Return where rotors are, (n, 3), m, of what `Vehicle.as_flown` says."""
    if "arm" in vehicle:
        return _float(vehicle["arm"]) * np.array([(*place, 0) for place in X.places], float)
    return np.array([(_float(x), _float(y), 0.0) for x, y, _ in vehicle["rotors"]])


def _half_angle(camera: dict[str, Any]) -> float | None:
    """Return the half angle of the cone about the z axis of the body that a lens sees, rad."""
    half, lean = _maybe(camera, "half_angle"), camera.get("rotation", ("0", "0", "0"))[:2]
    return None if half is None else half - sum(abs(_float(angle)) for angle in lean)


def _errors(errors: dict[str, Any]) -> str:
    """Say what of a vehicle is not as modelled: shares, but for the angles of the camera."""
    found = []
    for name, error in errors.items():
        sizes = [_float(e) for e in (error if isinstance(error, list) else [error])]
        unit, factor = (" rad", 1) if name == "camera_tilt" else (" %", 100)
        told = ", ".join(f"{factor * size:+g}" for size in sizes)
        found.append(f"{name.replace('_', ' ')} {told}{unit}")
    return f"with {', '.join(found)}" if found else ""


def _image_size(sensors: dict[str, Any]) -> tuple[float, float] | None:
    focal, width, height = (_maybe(sensors, k) for k in ("focal_length", "width", "height"))
    if focal is None or width is None or height is None:
        return None
    return width / focal, height / focal


def _maybe(section: dict[str, Any], key: str) -> float | None:
    return _float(section[key]) if section.get(key) is not None else None


def _float(value: Any) -> float:
    return float(Fraction(value))
