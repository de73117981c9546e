"""The exported C flown with the sensors, rotors, wind and errors that a mission names."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware, Output
from hoverproof.servo.layout import place
from hoverproof.simulation import flight as simulation
from hoverproof.simulation import kernel
from hoverproof.simulation.inner_loop import inner_loop
from hoverproof.simulation.observed import read_function
from hoverproof.simulation.plan import Plan
from hoverproof.simulation.record import Record

Array = NDArray[np.float64]
LONGEST_STEP = 0.1
FAULTS = {
    1: "an input out of its box",
    2: "the target not seen",
    4: "thrust near the singularity",
}
"""What ends a flight of firmware, by the bit of its status."""


@dataclass
class _Ticks:
    """A step of the firmware at each tick of a flight, in place of the model's controller.

    Attributes
    ----------
    plan : Plan
    vehicle : Firmware
    period : float
        From tick to tick, s.
    inner : callable, optional
        A rate loop, which runs at each step; see `inner_loop`.
    schedule : (int, int)
        Ticks in a step, with a rate loop, a fraction.
    status, step : int
        Of the fault that ended the flight, bare numbers; 0 if there was none.
    """

    plan: Plan
    vehicle: Firmware
    period: float
    inner: Callable[[Array, Array, float], Array] | None = None
    schedule: tuple[int, int] = (1, 1)
    status: int = 0
    step: int = 0
    held: Output | None = None

    def __call__(self, step: int, memory: Array, parameters: Array, noise: Array) -> Array:
        """Return the memory after a tick, of one vehicle.

        Parameters
        ----------
        step : int
            A bare number.
        memory, parameters, noise : (k, 1)
            See `kernel.Control`.
        """
        plan, law = self.plan, self.plan.numbers.law
        layout = plan.features.layout(law, plan.rotors)
        read = read_function(plan.numbers.target_size, plan.features, law, plan.rotors)
        told = {
            name: np.array(value).ravel()
            for name, value in read(memory=memory, parameters=parameters, noise=noise).items()
        }
        feature, thrust = told.pop("centroid"), float(told.pop("thrust")[0])
        if step == 0:
            self.vehicle.reset(thrust)
        out = self.held if self.held and not kernel.due(step, self.schedule) else None
        out = out or self.vehicle.step(feature, **told, dt=self.period)
        after = memory.copy()
        if out.status & sum(FAULTS):
            self.status, self.step = out.status, step
            after[place(layout, "thrust_margin")] = -1.0  # ends the flight
            return after
        after[place(layout, "command")] = out.thrust
        rotor: Any = out.rotor
        if self.inner is not None:
            self.held = out
            rotor = self.inner(np.array(out.rate_command), told["rate"], out.thrust)
        after[place(layout, "rotor_commands"), 0] = rotor
        if "gyro_error" in layout:
            true_rate = memory[place(layout, "state"), 0][15:18]
            after[place(layout, "gyro_error"), 0] = told["rate"] - true_rate
        return after


def fly_as_built(
    plan: Plan,
    firmware: Firmware,
    finer: int | None,
    eyes: Callable[[], kernel.Eyes] | None,
) -> Record:
    """Fly once with the sensors, rotors, wind and errors that a mission names.

    Parameters
    ----------
    plan : Plan
    firmware : Firmware
    finer : int or None
        So many samples, a bare number, are kept of a flight that ends early, if it is said.
    eyes : callable or None
        See `flown_firmware`.

    Raises
    ------
    InputError
        If the firmware does not take the feature, or is run too seldom.
    """
    mission = plan.mission
    if "camera" not in firmware.manifest:
        raise InputError(
            mission.source,
            sorted(mission.conditions())[0],
            f"needs firmware that takes the feature: export {firmware.name} with camera=True",
        )
    num, den = plan.schedule.control
    period, made = plan.step * den / num, []
    if period > LONGEST_STEP:
        fastest = f"must be at least {1 / LONGEST_STEP:g} Hz for the firmware"
        raise InputError(mission.source, "sensors.control_rate", f"{fastest}, not {1 / period:g}")

    inner = inner_loop(mission) if "rate_bandwidth" in firmware.manifest else None
    if inner is not None:  # the rate loop runs at each step
        at_each_step = {"sensors": mission.sensors.model_copy(update={"control_rate": None})}
        plan = replace(plan, mission=mission.model_copy(update=at_each_step))

    def ticks() -> _Ticks:
        made.append(_Ticks(plan, firmware, period, inner, (num, den)))
        return made[-1]

    record = simulation.fly_as_built(plan, None, finer, ticks, eyes)
    record.attrs["conditions"] = json.dumps(mission.conditions())
    record.attrs["machine"] = f"firmware, {firmware.manifest['precision']}"
    first = made[0]
    if first.status:
        record.attrs["outcome"] = (
            f"ended at {first.step * plan.step:g} s: {fault_words(first.status)}"
        )
    return record


def fault_words(status: int) -> str:
    """Say what ended a flight.

    Parameters
    ----------
    status : int
        Of the firmware, a bare number: a sum of bits.
    """
    words = " and ".join(words for bit, words in FAULTS.items() if status & bit)
    return f"{words or 'a fault'} (firmware status {status})"
