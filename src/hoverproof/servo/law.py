"""A law is a value: what it measures and is made of, its errors, and what it wants of them.

Everything else is derived from that value: the controller is solved for, the dissipation
differentiated, the flight compiled and the firmware printed. A file of `hoverproof.servo.laws`
holds a law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import casadi as ca

from hoverproof.errors import InputError
from hoverproof.mission.sections import Mission
from hoverproof.mission.target import Target
from hoverproof.plant import camera, rigid_body
from hoverproof.plant.goal import hover_goal
from hoverproof.plant.mount import CENTRAL, Mount
from hoverproof.servo.feature import Feature
from hoverproof.servo.heading import Heading
from hoverproof.servo.layout import resized
from hoverproof.servo.variables import Design, Errors, Measurement, WantedRates

SMALLEST_SPREAD = Fraction(1, 10**12)
"""Of W² - |q|² at a goal: a target that is seen smaller, under some 1e-6 rad, is a point."""


@dataclass(frozen=True)
class Goal:
    """Where the goal of a law is fixed.

    Attributes
    ----------
    name : str
    error : callable
        (Measurement, Design) ↦ δ1, (3, 1).
    fixed : callable
        Design ↦ the part of the wanted feature that turns with the image, (3, 1).
    """

    name: str
    error: Callable[[Any, Any], ca.SX]
    fixed: Callable[[Any], ca.SX]


@dataclass(frozen=True)
class Force:
    """How a law knows the force and the thrust.

    Attributes
    ----------
    name : str
    force : callable
        (Measurement, Design) ↦ F, (3, 1), body frame, N.
    thrust : callable
        (Measurement, Design) ↦ T, (1, 1), N.
    measurement : type of Measurement
        The layout of what it measures.
    ideal : callable
        (Measurement, Design) ↦ its own measurement: with what ideal sensors deliver besides.
    rate : callable
        (Measurement, Design, U in N/s) ↦ the time derivative of what it measures besides, (m, 1).
    sensed : callable, optional
        (Measurement, a in m/s², (3, 1), body frame) ↦ its own measurement, with that reading of an
        accelerometer; None if it needs none.
    """

    name: str
    force: Callable[[Any, Any], ca.SX]
    thrust: Callable[[Any, Any], ca.SX]
    measurement: type[Measurement]
    ideal: Callable[[Measurement, Any], Measurement]
    rate: Callable[[Any, Any, ca.SX], ca.SX]
    sensed: Callable[[Measurement, ca.SX], Measurement] | None = None


@dataclass(frozen=True, repr=False)
class Law:
    """A control law as a value, from which everything is derived; hashable, so graphs are cached.

    Attributes
    ----------
    feature : Feature
        What it makes of the image.
    goal : Goal
        Where its goal is fixed.
    force : Force
        How it knows the force.
    chain : callable
        (Design, image_error=, velocity=, force=, turn=) ↦ `Errors`: δ1…δ4, of SX (3, 1) in
        1, m/s, N and N/s; the last is what body rates add to the rate of the force error, times c.
    wanted_rates : callable
        (Errors, Measurement, Design, y) ↦ `WantedRates`, y = QV, (3, 1), 1/s.
    turning : callable
        Design ↦ the factor of f(T) = turning/(m D), (1, 1), kg²/s², by which the error rates depend
        on the thrust.
    bandwidth : callable
        (mass, gains of the error chain) ↦ attitude bandwidth, rad/s: the damping of the loop of
        δ3 and δ4. Of exact numbers, floats or arrays.
    design : type of Design
        The layout of what it is made of.
    variant : str
        What tells it from another law of the same choices.
    heading : Heading, optional
        By default yaw is damped alone.
    mount : Mount
        Of its camera; by default at the centre of mass, its axes those of the body.
    """

    feature: Feature
    goal: Goal
    force: Force
    chain: Callable[..., Errors]
    wanted_rates: Callable[[Errors, Any, Any, ca.SX], WantedRates]
    turning: Callable[[Any], ca.SX]
    bandwidth: Callable[..., Any]
    design: type[Design] = Design
    variant: str = ""
    heading: Heading | None = None
    mount: Mount = CENTRAL

    @property
    def name(self) -> str:
        """Its choices: feature, goal and force, and its variant."""
        choices = f"{self.feature.name}/{self.goal.name}/{self.force.name}"
        choices += "" if self.heading is None else f" with {self.heading.name}"
        return f"{choices} ({self.variant})" if self.variant else choices

    def __repr__(self) -> str:
        return f"Law({self.name!r})"

    def weighing(self, target: Target) -> Law:
        """Return the law with how much each point of a target counts.

        Parameters
        ----------
        target : Target
            Of a mission.
        """
        if target.weights is None:
            return self
        weights = tuple(map(float, target.weights))
        return replace(self, feature=replace(self.feature, weights=weights))

    def flying(self, mission: Mission) -> Law:
        """Return the law with the weights of a mission's points and the inertia of its vehicle.

        Parameters
        ----------
        mission : Mission
        """
        law, moments = self.weighing(mission.target), len(mission.vehicle.moments)
        if law.design.sizes()["inertia"] == moments:
            return law
        design = resized(law.design, (("inertia", moments),))
        return replace(law, design=design)

    @property
    def has_compass(self) -> bool:
        """Whether it is a compass that tells where the vehicle heads."""
        return self.heading is not None and not self.heading.of_image

    @property
    def sees_north(self) -> bool:
        """Whether it is the image that tells where the vehicle heads."""
        return self.heading is not None and self.heading.of_image

    @property
    def measurement(self) -> type[Measurement]:
        """The layout of what it measures."""
        own = self.force.measurement
        return own if self.heading is None else self.heading.measurement(own)

    def look(self, directions: ca.SX) -> ca.SX:
        """Return the feature that it makes of an image, (3, 1), body axes.

        Parameters
        ----------
        directions : SX
            p, (3, n), unit vectors, body axes.
        """
        return self.mount.made_up(self.feature.seen(directions))

    def known(
        self,
        measured: Measurement,
        design: Any,
        specific_force: Any = None,
        heading: ca.SX | None = None,
    ) -> Any:
        """Return its own measurement, of what every law measures and its own sensors.

        Parameters
        ----------
        measured : Measurement
        design : Design
        specific_force, heading : SX, optional
            Of an accelerometer, (3, 1), m/s², by default that of the model; (cos ψ, sin ψ), (2, 1),
            by default (0, 0), which is none.
        """
        felt = None if specific_force is None else self.force.sensed
        known = felt(measured, specific_force) if felt else self.force.ideal(measured, design)
        told = {"heading": ca.SX.zeros(2) if heading is None else heading}
        return self.measurement(**vars(known), **(told if self.heading else {}))

    def errors(self, measured: Any, design: Any) -> Errors:
        """Return δ1…δ4 of a measurement.

        Parameters
        ----------
        measured : Measurement
            In the law's own layout.
        design : Design
            Likewise.
        """
        thrust = self.force.thrust(measured, design)
        lever = thrust * rigid_body.E3 - design.stiffness * self.goal.fixed(design)
        return self.chain(
            design,
            image_error=self.goal.error(measured, design),
            velocity=measured.velocity,
            force=self.force.force(measured, design),
            turn=rigid_body.skew(lever) @ measured.rate,
        )

    def lever(self, thrust: ca.SX, design: Any) -> ca.SX:
        """Return D, (1, 1), N: how body rates turn the force error.

        The controller divides by it, and may be flown where it is positive.

        Parameters
        ----------
        thrust : SX
            T, (1, 1), N.
        design : Design
        """
        lever: ca.SX = thrust - design.stiffness * self.goal.fixed(design)[2]
        return lever

    def measured_rate(
        self,
        measured: Any,
        design: Any,
        *,
        angular_acceleration: ca.SX,
        thrust_rate: ca.SX,
        depth_flow: ca.SX,
    ) -> ca.SX:
        """Return the time derivative of a measurement's vector, (k, 1).

        The unknown depths act on what is measured through one vector only, the depth flow
        ``y = QV`` (or JV, of another feature than q); keeping it as a symbol of its own is what
        shows that a controller does not use it.

        Parameters
        ----------
        measured : Measurement
            In the law's own layout, k numbers.
        design : Design
            Likewise.
        angular_acceleration : SX
            Ω̇, (3, 1), rad/s².
        thrust_rate : SX
            U, N/s.
        depth_flow : SX
            y, (3, 1), 1/s.
        """
        d, z = design, measured
        return ca.vertcat(
            camera.centroid_rate(z.centroid, z.rate, depth_flow),
            rigid_body.acceleration(z.velocity, z.rate, self.force.force(z, d), d.mass),
            rigid_body.gravity_direction_rate(z.gravity_direction, z.rate),
            angular_acceleration,
            thrust_rate,
            self.force.rate(z, d, thrust_rate),
            *([] if self.heading is None else [self.heading.rate(z)]),
        )

    def goal_feature(self, mission: Mission) -> list[Fraction]:
        """Return what stands in place of q* in the design, (3,): exact if it is q* itself.

        Parameters
        ----------
        mission : Mission

        Raises
        ------
        InputError
            If no hover sees the goal of the mission, or the target is a point from there.
        """
        q, whole = hover_goal(mission).centroid_midpoint, mission.target.whole
        symbol, spread = ca.SX.sym("q", 3), ca.SX.sym("spread")
        seen = self.feature.of(symbol, spread, self.feature.whole(len(mission.target.points)))
        if ca.is_equal(seen, symbol):
            return q
        exact = whole**2 - sum(c * c for c in q)  # in floating point nothing would be left of it
        if exact < SMALLEST_SPREAD:
            raise InputError(
                mission.source, "target.points", "are too near to one another, seen from the goal"
            )
        feature = ca.Function("feature", [symbol, spread], [seen])
        value = feature([float(c) for c in q], float(exact))
        return [Fraction(float(c)) for c in ca.vertsplit(value)]
