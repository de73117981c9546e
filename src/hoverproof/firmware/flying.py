"""The exported C, flown in the loop with the simulated vehicle."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.firmware.as_built import FAULTS, LONGEST_STEP, fault_words, fly_as_built
from hoverproof.firmware.exporting import exported
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import choices_of
from hoverproof.servo.laws.heading import flown_law
from hoverproof.simulation import flight as simulation
from hoverproof.simulation import kernel
from hoverproof.simulation.cut_short import last_good_step, up_to
from hoverproof.simulation.plan import Plan, is_ideal
from hoverproof.simulation.record import Record, flight_record
from hoverproof.simulation.timing import Timing, flight_step

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


@of_mission
def fly_firmware(
    mission: Mission,
    firmware: Firmware | None = None,
    *,
    duration: float | None = None,
    step: float | None = None,
    every: int | None = None,
    seed: int = 0,
    law: Law | None = None,
) -> xr.Dataset:
    """Fly a mission from its start with the exported C as its controller.

    The controller runs once a step, or at the control rate of the mission's sensors, and its output
    is held in between. With sensors, rotors, wind or errors of the model it is given what they make
    of a flight, and the package is one that takes the feature; see `hoverproof.simulate`. A package
    that commands body rates flies by a rate loop of first order, which runs at each step of the
    flight with the inertia that the mission has. Gains need not be proved for a simulated flight.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    firmware : Firmware, optional
        A package of this mission; by default it is exported in float32 for this flight. With
        sensors and the like it is to be made with ``camera=True``.
    duration : float, optional
        s; by default as in `hoverproof.simulate`.
    step : float, optional
        From one step of the controller to the next, s, at most 0.1; by default as in
        `hoverproof.simulate`.
    every : int, optional
        Keep every so many steps; by default about 2000 samples are kept; a flight that ends early
        is kept as in `hoverproof.simulate`.
    seed : int
        Of the noise, as in `hoverproof.simulate`; a bare number.
    law : Law, optional
        That of the firmware; by default the law of the mission.

    Returns
    -------
    xarray.Dataset
        As `hoverproof.simulate` gives it; thrusts and torque are those of the firmware, and
        `firmware_status` has the status of each sample's step.

    Raises
    ------
    InputError
        If the firmware is that of another mission or does not take the feature, a time cannot be
        used, or there is no C compiler.
    """
    return flown_firmware(
        mission, Timing(duration, step, every), firmware, seed=seed, law=law
    ).dataset()


def flown_firmware(
    mission: Mission,
    timing: Timing,
    firmware: Firmware | None = None,
    *,
    seed: int = 0,
    law: Law | None = None,
    eyes: Callable[[], kernel.Eyes] | None = None,
) -> Record:
    """Fly a mission with the exported C: `fly_firmware`, without importing xarray.

    Parameters
    ----------
    mission, firmware
        See `fly_firmware`, also for what is raised.
    timing : Timing
    seed : int
        A bare number.
    law : Law, optional
        That of the firmware; by default the law of the mission.
    eyes : callable, optional
        Makes what is in place of the camera; the mission is not an ideal one then.
    """
    ideal = is_ideal(mission)
    step = flight_step(mission, timing.step, law)
    if step > LONGEST_STEP:
        raise InputError(
            "--step", "", f"must be at most {LONGEST_STEP} s for the firmware, not {step}"
        )
    samples = simulation.SAMPLES
    steps = timing.steps(mission, samples, simulation.sample_bytes(mission), law)
    every, finer = steps.every, samples if timing.every is None else None
    if firmware is None:
        firmware = exported(mission, law, camera=not ideal)
    _check_fits(firmware, mission, law or flown_law(mission))
    plan = Plan(mission, step, steps.samples, every, seed, scattered=False, law=law)
    return _fly_ideal(plan, firmware, finer) if ideal else fly_as_built(plan, firmware, finer, eyes)


def _check_fits(firmware: Firmware, mission: Mission, law: Law) -> None:
    """Raise InputError if a package is not that of a mission and a law."""
    name, told = firmware.name, str(mission.interface.rate_bandwidth)
    bandwidth = firmware.manifest.get("rate_bandwidth", told)
    if firmware.manifest["mission"] != mission.exact():
        raise InputError(mission.source, "", f"is not the mission of the firmware {name}")
    if firmware.manifest["law"] != choices_of(law):
        raise InputError(mission.source, "law", f"is not the law of the firmware {name}")
    if bandwidth != told:
        key, reason = "interface.rate_bandwidth", f"is not that of the firmware {name}, {bandwidth}"
        raise InputError(mission.source, key, reason)


def _fly_ideal(plan: Plan, firmware: Firmware, finer: int | None) -> Record:
    """Fly as the model is, in the loop that comes with the package."""
    mission, step, every = plan.mission, plan.step, plan.every

    def fly(samples: int, every: int) -> tuple[Array, bool]:
        return _good(firmware.fly(step, samples, every))

    begin = time.perf_counter()
    flown = firmware.fly(step, plan.samples, every)
    seconds = time.perf_counter() - begin
    rows, whole = _good(flown)
    taken, at = every * np.arange(len(rows)), 0
    if not whole:
        last = last_good_step(fly, rows, every, None)
        rows, taken = up_to(fly, rows, every, last, finer)
        at = 0 if len(flown["status"]) == 1 else last + 1
    record = flight_record(mission, plan.numbers, rows[:, :19], step * taken)
    record["torque"].values[:] = rows[:, 19:22]
    record["rotor_thrust"].values[:] = rows[:, 22:-1]
    words = "0, or a sum of the bits in the firmware's header"
    record.add("firmware_status", ["time"], rows[:, -1].astype(np.uint32), long_name=words)
    status, states = int(flown["status"][-1]), flown["state"]  # the last ones are of the fault
    height = float(mission.height_of_target) - states[-1, 2]
    tilt = np.degrees(np.arccos(np.clip(states[-1, 14], -1, 1)))
    fault = f"{fault_words(status)}, {height:.3g} m above the target, tilted by {tilt:.0f} degrees"
    record.attrs.update(
        {
            "outcome": "flown" if whole else f"ended at {at * step:g} s: {fault}",
            "step": step,
            "steps": int(taken[-1]),
            "seconds": seconds,
            "machine": f"firmware, {firmware.manifest['precision']}",
        }
    )
    return record


def _good(flown: Mapping[str, Any]) -> tuple[Array, bool]:
    """Return the samples before a fault, (m, 27), at least the start, and whether there is none."""
    columns = ("state", "thrust", "torque", "rotor", "status")
    rows = np.column_stack([flown[name] for name in columns])
    whole = not int(flown["status"][-1]) & sum(FAULTS)
    return (rows if whole else rows[: max(1, len(rows) - 1)]), whole
