"""The closed loop that everyone uses: what is sensed, how the state moves, what is read off it.

The graphs are over the packed state of the vehicle, (19, 1), the design of a law and the target
points; `LoopNumbers` are the floating-point numbers of a mission that they run on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.derived import kept_graph
from hoverproof.mission.frame import Frame, X
from hoverproof.mission.sections import Mission
from hoverproof.plant import camera, rotors
from hoverproof.plant.goal import hover_goal, level_view
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState, rotation_matrix, state_rate
from hoverproof.servo.controller import derive_controller
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.laws.heading import flown_law
from hoverproof.servo.lyapunov import lyapunov
from hoverproof.servo.variables import Design, Measurement

Array = NDArray[np.float64]


def parameters(n: int, law: Law = HAMEL_MAHONY) -> tuple[Design, ca.SX]:
    """Return symbols of the design and of n target points, (3, n), world frame, m.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    return law.design.symbols(), ca.SX.sym("points", 3, n)


def sense(
    state: RigidBodyState,
    points: ca.SX,
    law: Law = HAMEL_MAHONY,
    design: Design | None = None,
    *,
    all_round: bool = False,
    specific_force: ca.SX | None = None,
) -> tuple[Measurement, ca.SX, ca.SX]:
    """Return what the vehicle measures, the pinhole image (2, n) and the depths (1, n) in m.

    Parameters
    ----------
    state : RigidBodyState
    points : SX
        (3, n), world frame, m.
    law : Law
    design : Design, optional
        For a law whose own measurements depend on it.
    all_round : bool
        Whether the centroid is that of a camera that sees behind itself too. A pinhole takes a
        point behind it for one in front; motions and regions go on where a vehicle leans so far,
        or has sunk to the target. In front both are the same but for rounding.
    specific_force : SX, optional
        That of the true vehicle, (3, 1), body frame, m/s², for a law that measures it; by default
        it follows from the model.
    """
    seen = law.mount.before(points, state.position, state.rotation)
    image = camera.pinhole(seen)
    directions = law.mount.in_body(
        camera.directions(seen) if all_round else camera.spherical(image)
    )
    measured = Measurement(
        centroid=law.look(directions),
        velocity=state.velocity,
        gravity_direction=state.gravity_direction,
        rate=state.rate,
        thrust=state.thrust,
    )
    heading = None
    if law.heading is not None:
        heading = law.heading.seen(state.rotation, state.gravity_direction, directions, points)
    return law.known(measured, design, specific_force, heading), image, seen[2, :]


def command(measured: Measurement, design: Design, law: Law = HAMEL_MAHONY) -> tuple[ca.SX, ca.SX]:
    """Return what the law asks for: U, (1, 1), N/s, and Γ, (3, 1), body frame, N m.

    Parameters
    ----------
    measured : Measurement
    design : Design
    law : Law
    """
    thrust_rate, torque = _controller(law)(measured.vector(), design.vector())
    return thrust_rate, torque


@kept_graph
def _controller(law: Law) -> ca.Function:
    return derive_controller(law).function()


def loop_rate(
    state: ca.SX,
    design: Design,
    points: ca.SX,
    law: Law = HAMEL_MAHONY,
    *,
    all_round: bool = False,
) -> ca.SX:
    """Return the time derivative of the packed state, (19, 1), with the controller in the loop.

    Parameters
    ----------
    state : SX
        (19, 1), packed as by `RigidBodyState`.
    design : Design
    points : SX
        (3, n), world frame, m.
    law : Law
    all_round : bool
        See `sense`.
    """
    body = RigidBodyState.from_vector(state)
    measured, _, _ = sense(body, points, law, design, all_round=all_round)
    thrust_rate, torque = command(measured, design, law)
    return state_rate(
        body,
        torque=torque,
        thrust_rate=thrust_rate,
        mass=design.mass,
        inertia=design.inertia,
        gravity=design.gravity,
    ).vector()


def readout(
    x: ca.SX,
    design: Design,
    points: ca.SX,
    arm: ca.SX,
    drag_ratio: ca.SX,
    law: Law = HAMEL_MAHONY,
    specific_force: ca.SX | None = None,
    frame: Frame = X,
) -> dict[str, ca.SX]:
    """Return the outputs of `readout_function` as expressions of its inputs.

    Parameters
    ----------
    x : SX
        (19, 1), packed as by `RigidBodyState`.
    design : Design
    points : SX
        (3, n), world frame, m.
    arm, drag_ratio : SX
        Of the rotors, (1, 1), m; see `hoverproof.plant.rotors.wrench`.
    law : Law
    specific_force : SX, optional
        (3, 1), body frame, m/s²; see `sense`.
    frame : Frame
        Of the rotors.
    """
    body = RigidBodyState.from_vector(x)
    measured, image, _ = sense(body, points, law, design, specific_force=specific_force)
    e = law.errors(measured, design)
    _, torque = command(measured, design, law)
    return {
        "image": image,
        "centroid": measured.centroid,
        "delta1": e.d1,
        "delta2": e.d2,
        "delta3": e.d3,
        "delta4": e.d4,
        "lyapunov": lyapunov(e, ca.SX.ones(4)),
        "torque": torque,
        "rotor_thrusts": rotors.rotor_thrusts(frame, measured.thrust, torque, arm, drag_ratio),
    }


@kept_graph
def readout_function(
    n: int,
    law: Law = HAMEL_MAHONY,
    frame: Frame = X,
    *,
    with_specific_force: bool = False,
) -> ca.Function:
    """Return (state, design, points, arm, drag_ratio) ↦ what a flight record holds.

    Outputs: image (2, n), centroid (3,), δ1, δ2, δ3 (3,), δ4 (2,), lyapunov, torque (3,) in N m,
    rotor_thrusts (r,) in N, r the number of rotors.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    frame : Frame
        Of the rotors.
    with_specific_force : bool
        Whether the last input is the true specific force, (3,), body frame, m/s²; see `sense`.
    """
    design, points = parameters(n, law)
    x, arm, drag = ca.SX.sym("x", STATE_SIZE), ca.SX.sym("arm"), ca.SX.sym("drag_ratio")
    inputs = {"x": x, "design": design.vector(), "points": points, "arm": arm, "drag_ratio": drag}
    felt = ca.SX.sym("specific_force", 3) if with_specific_force else None
    outputs = readout(x, design, points, arm, drag, law, felt, frame)
    inputs |= {} if felt is None else {"specific_force": felt}
    return ca.Function(
        "readout", list(inputs.values()), list(outputs.values()), list(inputs), list(outputs)
    )


@kept_graph
def level_slope(n: int, law: Law) -> ca.Function:
    """Return (points (3, n), position (3,)) ↦ what turns V into the rate of the feature, (3, 3).

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    points, position, q = ca.SX.sym("points", 3, n), ca.SX.sym("xi", 3), ca.SX.sym("q", 3)
    if ca.is_equal(law.feature.at(q, n), q):
        return level_view(n, law.feature.weights).factory("level_slope", ["points", "xi"], ["Q"])
    slope = -ca.jacobian(level_feature(n, law)(points, position), position)
    return ca.Function("level_slope", [points, position], [ca.densify(slope)])


@kept_graph
def level_feature(n: int, law: Law) -> ca.Function:
    """Return (points (3, n), position (3,)) ↦ σ, the feature that a level camera sees, (3,).

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    points, position = ca.SX.sym("points", 3, n), ca.SX.sym("xi", 3)
    seen = camera.body_points(points, position, ca.SX.eye(3))
    feature = law.feature.seen(camera.directions(seen))
    return ca.Function("level_feature", [points, position], [ca.densify(feature)])


@dataclass(frozen=True)
class LoopNumbers:
    """The floating-point numbers that the loop of a mission runs on.

    Attributes
    ----------
    design : (d,)
        In the order of the law's design.
    points : (3, n)
        Target, world frame, m.
    goal : (3,)
        ξ*, world frame, m.
    start : (19,)
        Packed state.
    law : Law
    """

    design: Array
    points: Array
    goal: Array
    start: Array
    law: Law

    @classmethod
    def of(cls, mission: Mission, law: Law | None = None) -> LoopNumbers:
        """Round the numbers of a mission.

        Parameters
        ----------
        mission : Mission
        law : Law, optional
            By default that of the mission; it counts the target points as the mission does.

        Raises
        ------
        InputError
            If no level hover sees the goal of the mission.
        """
        goal, law = hover_goal(mission), (law or flown_law(mission)).flying(mission)
        start = mission.start
        state = [
            *start.position,
            *start.velocity,
            *rotation_matrix(*map(float, start.rotation)).T.ravel(),
            *start.rates,
            mission.vehicle.weight,
        ]
        return cls(
            design=_floats(law.design.values(mission, law.goal_feature(mission))),
            points=np.array(mission.target.points, float).T,
            goal=_floats(goal.position),
            start=_floats(state),
            law=law,
        )

    @property
    def target_size(self) -> int:
        """Number of target points."""
        return int(self.points.shape[1])

    @property
    def goal_centroid(self) -> Array:
        """q*, (3,), or the feature that the law has in its place."""
        return self.design[self.law.design.place("goal_centroid")]

    @property
    def hover_thrust(self) -> float:
        """The thrust of a hover, N."""
        return float(self.start[-1])

    @property
    def hover(self) -> Array:
        """(19,) the packed state of the level hover at the goal."""
        state = np.zeros(STATE_SIZE)
        state[:3], state[[6, 10, 14]], state[-1] = self.goal, 1, self.hover_thrust
        return state

    def depth_matrix(self) -> Array:
        """Return what turns V into the rate of the feature at the goal, (3, 3), 1/m: Q for q."""
        return np.array(level_slope(self.target_size, self.law)(self.points, self.goal))

    def measured(self) -> Array:
        """Return what is measured at the start, in the order of the law's measurement."""
        (design, points), x = parameters(self.target_size, self.law), ca.SX.sym("x", STATE_SIZE)
        measured, _, _ = sense(RigidBodyState.from_vector(x), points, self.law, design)
        look = ca.Function("look", [x, design.vector(), points], [measured.vector()])
        return np.array(look(self.start, self.design, self.points)).ravel()

    def value(self, of: Callable[[Design], ca.SX]) -> float:
        """Return a number that follows from the design.

        Parameters
        ----------
        of : callable
            Design ↦ SX, (1, 1), of any unit.
        """
        design = self.law.design.symbols()
        return float(ca.Function("value", [design.vector()], [of(design)])(self.design))

    def designs(self, gains: tuple[Array, ...]) -> Array:
        """Return the design with other gains, (d, m).

        Parameters
        ----------
        gains : (4,) of (m,)
            Those of the error chain, in the order and units of the law's design.
        """
        designs = np.tile(self.design[:, None], len(gains[0]))
        for name, values in zip(self.law.design.chain_gains(), gains, strict=True):
            designs[self.law.design.place(name)] = values
        return designs


def _floats(values: Any) -> Array:
    return np.array([float(value) for value in values])
