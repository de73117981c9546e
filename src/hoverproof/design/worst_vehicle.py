"""Fly vehicles at the corners of the tolerances where there is no proof: which does worst.

These are simulations with the latency and the lag at their most, thrust and torque at either end,
and wind from the goal, to it, across, from above and from below. They prove nothing, not even
where all settle.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from hoverproof.algebra.decimals import decimal_below
from hoverproof.errors import InputError
from hoverproof.mission.conditions import ModelError, Sensors, Wind
from hoverproof.mission.fields import shown
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.simulation.flight import flown, summary
from hoverproof.simulation.timing import Timing

BRAKE = Fraction(1, 1000)
"""Drag over mass of what is blown along, 1/s: so little that the force is steady."""
MOST = Fraction(10)
"""Largest share by which a moment of inertia may differ."""


@dataclass(frozen=True)
class Vehicle:
    """A corner of the tolerances.

    Attributes
    ----------
    mission : Mission
        That vehicle, as it is flown.
    words : tuple of str
        What it is.
    """

    mission: Mission
    words: tuple[str, ...]


@dataclass(frozen=True)
class Flown:
    """What came of the flight of the vehicle that did worst.

    Attributes
    ----------
    vehicle : Vehicle
    count : int
        Number of vehicles that were flown.
    settled : float or None
        When it is near its goal for good, s; None if it is not at the end.
    ended : str or None
        Why the flight ended before its time.
    duration : float
        s.
    distance : float
        From the goal at the end, m.
    """

    vehicle: Vehicle
    count: int
    settled: float | None
    ended: str | None
    duration: float
    distance: float

    @property
    def outcome(self) -> str:
        """What happened, in words."""
        if self.ended is not None:
            return self.ended
        if self.settled is None:
            return (
                f"is not settled after {self.duration:.4g} s, {self.distance:.3g} m from its goal"
            )
        return f"settles after {self.settled:.4g} s"

    @property
    def badness(self) -> tuple[bool, bool, float]:
        """How bad that is, to be compared."""
        if self.ended is not None:
            return True, True, -self.duration
        return False, self.settled is None, self.settled or self.distance


def vehicles(mission: Mission) -> Iterator[Vehicle]:
    """Yield the vehicles at the corners of what a mission asks to be covered.

    Parameters
    ----------
    mission : Mission
    """
    may = mission.uncertainty
    sensors = Sensors(latency=may.latency, gyro_turned=mission.sensors.gyro_turned)
    rotors = mission.rotors.model_copy(update={"time_constant": may.rotor_lag})
    always = [(may.latency, f"latency {shown(may.latency)} s")]
    always += [(may.rotor_lag, f"rotor lag {shown(may.rotor_lag)} s")]
    fixed = [words for size, words in always if size]
    thrusts, torques = ((-1, 1) if size else (0,) for size in (may.thrust, may.torque))
    for thrust, torque, way in itertools.product(thrusts, torques, _ways(mission)):
        gain = 1 + torque * may.torque
        heavier = min(1 / gain - 1, MOST)
        wrong = ModelError(thrust=thrust * may.thrust, inertia=(heavier,) * 3)
        air, blown = Wind(), ""
        if any(way):
            mass = mission.vehicle.mass
            x, y, z = (may.wind / BRAKE * c for c in way)
            air = Wind(mean=(x, y, z), drag=BRAKE * mass)
            blown = f"wind ({', '.join(shown(may.wind * c) for c in way)}) m/s²"
        part = {"sensors": sensors, "rotors": rotors, "model_error": wrong, "wind": air}
        words = [
            f"thrust {'+' if thrust > 0 else '-'}{shown(100 * may.thrust)} %" if thrust else "",
            f"torque {'+' if torque > 0 else '-'}{shown(100 * may.torque)} %" if torque else "",
            *fixed,
            blown,
        ]
        yield Vehicle(mission.model_copy(update=part), tuple(filter(None, words)))


def _ways(mission: Mission) -> list[tuple[Fraction, ...]]:
    """Return the directions of wind: along the way to the goal, across it, up and down."""
    zero, one = Fraction(0), Fraction(1)
    if not mission.uncertainty.wind:
        return [(zero, zero, zero)]
    goal = np.array([float(c) for c in hover_goal(mission).position])
    away = np.array([float(c) for c in mission.start.position])[:2] - goal[:2]
    size = float(np.linalg.norm(away))
    x, y = (decimal_below(c / size, 4) for c in away) if size > 0 else (one, zero)
    level = [(x, y, zero), (-x, -y, zero), (-y, x, zero)]
    return [*level, (zero, zero, one), (zero, zero, -one)]


def worst_flight(mission: Mission) -> Flown | None:
    """Fly all these vehicles from the start of a mission, and return what came of the worst.

    Parameters
    ----------
    mission : Mission

    Returns
    -------
    Flown, or None if none can be flown
    """
    told: list[Flown] = []
    each = list(vehicles(mission))
    for vehicle in each:
        try:
            flight = flown(vehicle.mission, Timing(None, None, None))
        except InputError:  # numbers beyond what is simulated, or no end to it
            continue
        end = summary(flight)
        outcome, times = flight.attrs["outcome"], flight["time"].values
        position, goal = flight["position"].values[-1], flight.attrs["goal_position"]
        told.append(
            Flown(
                vehicle=vehicle,
                count=len(each),
                settled=end["settled_at"],
                ended=None if outcome == "flown" else str(outcome),
                duration=float(times[-1]),
                distance=float(math.dist(position, goal)),
            )
        )
    return max(told, key=lambda f: f.badness, default=None)
