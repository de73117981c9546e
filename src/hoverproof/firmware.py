"""Firmware of a mission: certified and written as C99, and flown: that very C, in the loop."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.certification.convergence import Progress, attraction
from hoverproof.certification.gains import certify
from hoverproof.certification.problem import pose
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware, Output
from hoverproof.export.package import NotCertified, check_options, write_package
from hoverproof.export.standing import Standing
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import choices_of
from hoverproof.servo.laws.heading import flown_law
from hoverproof.servo.layout import place
from hoverproof.servo.loop import LoopNumbers
from hoverproof.simulation import flight as simulation
from hoverproof.simulation import kernel
from hoverproof.simulation.cut_short import last_good_step, up_to
from hoverproof.simulation.inner_loop import inner_loop
from hoverproof.simulation.plan import Plan, is_ideal
from hoverproof.simulation.record import Record, flight_record
from hoverproof.simulation.timing import Timing, flight_step
from hoverproof.simulation.told import read_function

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

LONGEST_STEP = 0.1
FAULTS = {
    1: "an input out of its box",
    2: "the target not seen",
    4: "thrust near the singularity",
}
"""What ends a flight of firmware, by the bit of its status."""


@of_mission
def export_c(
    mission: Mission,
    /,
    out: str | Path,
    *,
    certificate: Mapping[str, Any] | None = None,
    allow_uncertified: bool = False,
    law: Law | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Certify a mission and write its control firmware, a C99 package, with the certificates.

    Where the gains alone are undecided, and nothing else is given or allowed, it is looked for a
    proof that the vehicle converges from the start of the mission.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    out : str or Path
        Folder to write to; made if needed.
    certificate : mapping, optional
        Content of a certificate of `hoverproof.attraction` about this mission, which is enough.
    allow_uncertified : bool
        Write a package even if nothing is proved; every file of it then says so.
    law : Law, optional
        What the firmware computes; by default the law of the mission, which alone a certificate of
        the mission is about.
    progress : callable, optional
        Is told what is being done.
    **options
        precision, sensing, camera, pixels, interface, tunable, name, rotor_limits: see
        `hoverproof.export.package.write_package`.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    hoverproof.export.package.NotCertified
        If nothing is proved, or the law is another one, and that is not allowed; nothing is
        written.
    checker.Rejected
        If the certificate does not prove it.
    InputError
        If an argument cannot be used or the folder cannot be written to.
    """
    own, law = flown_law(mission), law and law.flying(mission)
    if law is not None and law != own:
        if not allow_uncertified:
            why = f"its certificate is about its law, {own.name}, not about {law.name}"
            raise NotCertified(mission.name, "undecided", why)
        return write_package(mission, out, Standing(pose(mission).thrust), law=law, **options)
    verdict = certify(mission)
    gains = verdict.proved.certificate.content if verdict.proved else None
    if gains is None and certificate is None and not allow_uncertified:
        check_options(mission, **options)  # before what may take a while
        certificate = _converges(mission, verdict.status, progress)
    standing = Standing(verdict.problem.thrust, gains, certificate)
    return write_package(mission, out, standing, **options)


def _converges(mission: Mission, gains: str, progress: Progress | None) -> dict[str, Any]:
    """Return the certificate that a vehicle converges from its start, though its gains are `gains`.

    Refuted gains are not looked at: who wants them nevertheless proves it before.
    """
    if gains == "refuted":
        raise NotCertified(mission.name, gains)
    verdict = attraction(mission, progress=progress)
    if not verdict.proved:
        reason = f"the gains alone are {gains}, and from its start it is {verdict.status} too"
        raise NotCertified(mission.name, verdict.status, f"{reason}: {verdict.reason}")
    return verdict.proved.certificate.content


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
    elif firmware.manifest["mission"] != mission.exact():
        raise InputError(mission.source, "", f"is not the mission of the firmware {firmware.name}")
    elif firmware.manifest["law"] != choices_of(law or flown_law(mission)):
        raise InputError(mission.source, "law", f"is not the law of the firmware {firmware.name}")
    told = str(mission.interface.rate_bandwidth)
    if firmware.manifest.get("rate_bandwidth", told) != told:
        raise InputError(
            mission.source,
            "interface.rate_bandwidth",
            f"is not that of the firmware {firmware.name}, {firmware.manifest['rate_bandwidth']}",
        )
    if not ideal:
        plan = Plan(mission, step, steps.samples, every, seed, scattered=False, law=law)
        return _fly_as_built(plan, firmware, finer, eyes)
    vehicle = firmware

    def fly(samples: int, every: int) -> tuple[Array, bool]:
        return _good(vehicle.fly(step, samples, every))

    begin = time.perf_counter()
    flown = firmware.fly(step, steps.samples, every)
    seconds = time.perf_counter() - begin
    rows, whole = _good(flown)
    taken, at = every * np.arange(len(rows)), 0
    if not whole:
        last = last_good_step(fly, rows, every, None)
        rows, taken = up_to(fly, rows, every, last, finer)
        at = 0 if len(flown["status"]) == 1 else last + 1
    numbers = LoopNumbers.of(mission, law)
    record = flight_record(mission, numbers, rows[:, :19], step * taken)
    record["torque"].values[:] = rows[:, 19:22]
    record["rotor_thrust"].values[:] = rows[:, 22:-1]
    words = "0, or a sum of the bits in the firmware's header"
    record.add("firmware_status", ["time"], rows[:, -1].astype(np.uint32), long_name=words)
    status, states = int(flown["status"][-1]), flown["state"]  # the last ones are of the fault
    height = float(mission.height_of_target) - states[-1, 2]
    tilt = np.degrees(np.arccos(np.clip(states[-1, 14], -1, 1)))
    fault = f"{_faults(status)}, {height:.3g} m above the target, tilted by {tilt:.0f} degrees"
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


def exported(mission: Mission, law: Law | None = None, *, camera: bool) -> Firmware:
    """Return the firmware of a mission in float32, proved or not, for flights on this computer.

    Parameters
    ----------
    mission : Mission
    law : Law, optional
        By default that of the mission.
    camera : bool
        Whether it takes the feature.
    """
    with tempfile.TemporaryDirectory() as folder:
        own: dict[str, Any] = {"allow_uncertified": True, "law": law, "camera": camera}
        export_c(mission, folder, name="firmware", **own)
        return Firmware(folder)


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


def _fly_as_built(
    plan: Plan,
    firmware: Firmware,
    finer: int | None,
    eyes: Callable[[], kernel.Eyes] | None,
) -> Record:
    """Fly once with the sensors, rotors, wind and errors that a mission names."""
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
        record.attrs["outcome"] = f"ended at {first.step * plan.step:g} s: {_faults(first.status)}"
    return record


def _faults(status: int) -> str:
    words = " and ".join(words for bit, words in FAULTS.items() if status & bit)
    return f"{words or 'a fault'} (firmware status {status})"
