"""A mission: its sections together, and what they must be to one another.

Numbers are exact (`fractions.Fraction`); a float is made of them only where one is needed.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from hoverproof.mission.camera import Camera
from hoverproof.mission.conditions import ModelError, Rotors, Scatter, Sensors, Wind, out_of_order
from hoverproof.mission.fields import Section as _Section
from hoverproof.mission.fields import as_text
from hoverproof.mission.fields import reject as _reject
from hoverproof.mission.fields import shown as _shown
from hoverproof.mission.interface import Interface
from hoverproof.mission.target import Target, on_one_line
from hoverproof.mission.task import Bounds, Gains, Goal, LawChoice, Start
from hoverproof.mission.uncertainty import Uncertainty
from hoverproof.mission.vehicle import Vehicle

CONDITIONS = ("sensors", "rotors", "wind", "model_error", "scatter")
"""Sections that say what a real flight adds to the model."""


class Mission(_Section):
    """A vehicle, a camera target, a goal and gains, with the bounds assumed, the start and the law.

    All numbers are `fractions.Fraction`. Made by `load`; `source` says from where. The name is also
    that of the files that commands write. The sections `sensors`, `rotors`, `wind`, `model_error`
    and `scatter` say what a real flight adds to the model, `interface` what exported firmware
    commands; `uncertainty` and `camera` say what a proof is asked to cover.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")]
    vehicle: Vehicle
    target: Target
    goal: Goal
    gains: Gains
    bounds: Bounds
    start: Start
    law: LawChoice = LawChoice()
    uncertainty: Uncertainty = Uncertainty()
    camera: Camera = Camera()
    sensors: Annotated[Sensors, Field(exclude=True)] = Sensors()
    rotors: Annotated[Rotors, Field(exclude=True)] = Rotors()
    interface: Annotated[Interface, Field(exclude=True)] = Interface()
    wind: Annotated[Wind, Field(exclude=True)] = Wind()
    model_error: Annotated[ModelError, Field(exclude=True)] = ModelError()
    scatter: Annotated[Scatter, Field(exclude=True)] = Scatter()
    source: Annotated[str, Field(exclude=True)] = "mission"

    def __repr__(self) -> str:
        goal, points = self.goal, len(self.target.points)
        where = (
            f"centroid {tuple(map(float, goal.centroid))}"
            if goal.centroid is not None
            else f"{float(goal.height or 0):g} m above them"
        )
        mass = f"{float(self.vehicle.mass):g} kg"
        return f"<Mission {self.name}: {mass}, law {self.law.name}, {points} points, {where}>"

    __str__ = __repr__

    @model_validator(mode="after")
    def _hangs_together(self) -> Self:
        thrust, weight = self.bounds.thrust, self.vehicle.weight
        if thrust is not None and not thrust[0] <= weight <= thrust[1]:
            raise _reject(
                f"must contain the thrust of hover, m g = {float(weight):g} N, "
                f"not [{_shown(thrust[0])}, {_shown(thrust[1])}]",
                key="bounds.thrust",
            )
        self._require_a_goal_that_is_seen()
        if self.gains.k_heading is not None and self.goal.heading is None:
            raise _reject(
                "turns to a heading: give goal.heading (rad), or leave it out",
                key="gains.k_heading",
            )
        self._require_a_start_above()
        return self

    def _require_a_goal_that_is_seen(self) -> None:
        points = self.target.points
        height, centroid = self.goal.height, self.goal.centroid
        if height is not None:
            if len({(x, y) for x, y, _ in points}) == 1:
                raise _reject("all are in line with a camera above them", key="target.points")
            highest = self.height_of_target - min(z for _, _, z in points)
            if height <= highest:
                raise _reject(
                    f"must be above the highest target point, {float(highest):g} m "
                    f"above the mean of the target, not {_shown(height)}",
                    key="goal.height",
                )
        if centroid is not None:
            if sum(q * q for q in centroid) >= self.target.whole**2:
                of = "number of points" if self.target.weights is None else "sum of the weights"
                raise _reject(
                    f"must be shorter than the {of}, {_shown(self.target.whole)}: "
                    "no hover sees the target so",
                    key="goal.centroid",
                )
            if centroid[2] <= 0:
                raise _reject(
                    f"q3 must be above 0 for a target below the camera, not {_shown(centroid[2])}",
                    key="goal.centroid",
                )
            if self.law.goal == "inertial" and any(centroid[:2]):
                raise _reject(
                    "must be [0, 0, q3] for law.goal = 'inertial', which is fixed to the vertical, "
                    f"not [{', '.join(map(_shown, centroid))}]",
                    key="goal.centroid",
                )
            if self.goal.heading is not None and any(centroid[:2]):
                raise _reject(
                    "needs a goal straight below, centroid = [0, 0, q3]: nothing is proved of "
                    "another while the vehicle turns",
                    key="goal.heading",
                )
        if self.goal.heading_from == "image" and len({z for _, _, z in points}) > 1:
            raise _reject(
                "'image' needs a target that is flat and level, all z equal: of another the image "
                "alone does not tell the heading",
                key="goal.heading_from",
            )

    def _require_a_start_above(self) -> None:
        points = self.target.points
        start = self.start.position
        if start[2] >= min(z for _, _, z in points):
            raise _reject(
                f"must be above every target point (z is down), not at z = {_shown(start[2])} m",
                key="start.position",
            )
        if on_one_line([*points, start]):
            raise _reject("is in line with the target points", key="start.position")

    @model_validator(mode="after")
    def _knows_its_rotors(self) -> Self:
        shares, names = self.model_error.rotors, self.vehicle.frame.names
        if shares and len(shares) != len(names):
            raise _reject(
                f"must be a list [{', '.join(names)}], not {len(shares)} entries",
                key="model_error.rotors",
            )
        if (wrong := out_of_order(self.rotor_limits)) is not None:
            raise _reject(
                f"the lowest thrust of the rotor {names[wrong]} must be below its highest, N",
                key="vehicle.rotors",
            )
        return self

    @model_validator(mode="after")
    def _has_one_lens(self) -> Self:
        lens, seen = self.camera.lens, self.sensors
        for key in ("focal_length", "width", "height"):
            if lens is not None and getattr(seen, key) is not None:
                raise _reject("is told by camera.lens; leave it out", key=f"sensors.{key}")
        in_pixels = ("width", "height", "pixel_noise", "pixel_resolution")
        named = [key for key in in_pixels if getattr(seen, key)]
        if named and seen.focal_length is None and lens is None:
            raise _reject(f"is missing; {named[0]} in px needs it", key="sensors.focal_length")
        return self

    @model_validator(mode="after")
    def _can_cover(self) -> Self:
        wind, gravity = self.uncertainty.wind, self.vehicle.gravity
        if wind >= gravity:
            raise _reject(
                f"must be below gravity, {_shown(gravity)} m/s², not {_shown(wind)}",
                key="uncertainty.wind",
            )
        self._covers_its_inertia()
        self.interface.check_covered(self.uncertainty)
        for key in ("thrust", "wind", "rotor_lag"):
            if self.law.force == "modelled" and getattr(self.uncertainty, key):
                raise _reject(
                    "must be 0 for law.force = 'modelled', which takes the force commanded for the "
                    "one that acts, so that the hover moves; law.force = 'measured' can cover it",
                    key=f"uncertainty.{key}",
                )
        for key in ("control_period", "force_lag"):
            if getattr(self.uncertainty, key) and not self.uncertainty.rotor_lag:
                raise _reject(
                    "is proved for rotors that lag: give uncertainty.rotor_lag, or leave it out",
                    key=f"uncertainty.{key}",
                )
            if getattr(self.uncertainty, key) and self.holds_old_axes:
                raise _reject(
                    "is proved for images that are turned to the present axes alone: set "
                    "sensors.gyro_turned = true, or leave it out",
                    key=f"uncertainty.{key}",
                )
        return self

    def _covers_its_inertia(self) -> None:
        """Refuse tolerances that a vehicle with products of inertia cannot have covered."""
        key = self.uncertainty.of_torques
        if key and self.vehicle.products is not None:
            raise _reject(
                "must be 0 for a vehicle with products of inertia: another torque, or a late one, "
                "then turns that about yaw, and squares of the rates, into roll and pitch",
                key=f"uncertainty.{key}",
            )

    @property
    def rotor_limits(self) -> tuple[tuple[Fraction | None, Fraction | None], ...]:
        """The lowest and the highest thrust of each rotor, N: its own, else that of all."""
        return self.rotors.of_each(self.vehicle.own_limits, len(self.vehicle.frame.names))

    @property
    def title(self) -> str:
        """Its name, with its law where that is not the paper's."""
        return self.name if self.law.is_papers else f"{self.name} ({self.law.name})"

    @property
    def holds_old_axes(self) -> bool:
        """Whether it is asked about a late feature in the axes that the camera had then."""
        return bool(self.uncertainty.latency) and not self.sensors.gyro_turned

    @property
    def k_heading(self) -> Fraction:
        """The gain of the heading, kg m²/s²: that of the gains, or what suits k_yaw.

        That is k_yaw²/(4 I3), which damps yaw critically, but no more than k_yaw times 1 rad/s: the
        vehicle then turns at 1 rad/s at most.
        """
        if self.gains.k_heading is not None:
            return self.gains.k_heading
        damping = self.gains.k_yaw
        return min(damping**2 / (4 * self.vehicle.inertia[2]), damping)

    @property
    def height_of_target(self) -> Fraction:
        """Mean z of the target points, each as much as it counts, m, world frame (down)."""
        return self.target.mean[2]

    def covers(self) -> list[str]:
        """Return in words which vehicles a proof is asked to cover, but for what they see."""
        return [*self.camera.beside(), *self.uncertainty.covers()]

    def asks_to_cover(self) -> list[str]:
        """Return in words what a proof is asked to cover beside the vehicle as modelled."""
        return [*self.uncertainty.covers(), *self.camera.covers()]

    def exact(self, *, as_written: bool = False) -> dict[str, Any]:
        """Return the mission as nested dicts and lists, each number an exact string.

        The vehicle is what counts of it, `Vehicle.as_flown`, however a file says it. Sensors,
        rotors, wind, model_error and scatter are not in it: see `conditions`; nor interface; but
        for whether a late feature is turned, which stands under `uncertainty` if it is not.

        Parameters
        ----------
        as_written : bool
            Whether the vehicle has the keys of a mission file.
        """
        said_by_none = ("law", "uncertainty", "camera")  # as in the missions before these sections
        left_out = {k for k in said_by_none if getattr(self, k) == type(getattr(self, k))()}
        numbers = self.model_dump(exclude_none=True, exclude=left_out)
        if not as_written:
            numbers["vehicle"] = self.vehicle.as_flown()
        else:
            numbers["vehicle"] |= {} if self.vehicle.products is None else self.vehicle.as_matrix()
            if not self.vehicle.reversed:
                del numbers["vehicle"]["reversed"]
        text: dict[str, Any] = as_text(numbers)
        for part, key in (
            *((text.get("uncertainty"), key) for key in ("gust", "control_period", "force_lag")),
            (text.get("uncertainty", {}).get("noise"), "vertical"),
        ):
            if part and part[key] == "0":  # as in the missions before these keys
                del part[key]
        if "camera" in text:
            text["camera"] = as_text(self.camera.told())
        if self.holds_old_axes:
            text["uncertainty"]["gyro_turned"] = "false"
        if text["goal"].get("heading_from") == "compass":
            del text["goal"]["heading_from"]  # what it is left out
        return text

    def conditions(self) -> dict[str, Any]:
        """Return what the mission adds to the model and how it scatters, in the way of `exact`."""
        sections = {name: getattr(self, name) for name in CONDITIONS}
        held = {k: v.model_dump(exclude_defaults=True) for k, v in sections.items()}
        if self.vehicle.own_limits:
            held["rotors"]["each"] = self.rotor_limits
        text: dict[str, Any] = as_text(held)
        return {name: keys for name, keys in text.items() if keys}
