"""What the exported C would have commanded in a flight that was logged."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import FlightLog
from hoverproof.errors import InputError
from hoverproof.export.binding import Firmware
from hoverproof.firmware.as_built import FAULTS
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.heading import flown_law
from hoverproof.simulation.record import Column, Record
from hoverproof.version import __version__

Array = NDArray[np.float64]

LONGEST = 0.1
"""A longer step is taken for one of so long, s: the firmware refuses others."""
SATURATED = 32


@dataclass(frozen=True, eq=False)
class Replay:
    """The commands of the firmware beside those of the log.

    Attributes
    ----------
    log : FlightLog
    mission : Mission
    firmware : str
        What ran, in words.
    times : (n,)
        s.
    outputs : dict of arrays
        thrust (n,), N; torque (n, 3), N m; rotor (n, r), N; of a package for a rate loop throttle
        (n,), dimensionless, and rate_command (n, 3), rad/s.
    status : (n,) int
        Sums of the bits in the firmware's header.
    seconds : (n,)
        That a step took here, with what Python takes to call it, s.
    """

    log: FlightLog
    mission: Mission
    firmware: str
    times: Array
    outputs: dict[str, Array]
    status: NDArray[np.int64]
    seconds: Array

    @cached_property
    def commanded(self) -> dict[str, Array]:
        """What the log holds of the same, with the units and shapes of `outputs`."""
        log, ahead = self.log, self.log.ahead
        pairs = {
            "thrust": log.thrust_command,
            "rotor": log.rotor_command,
            "rate_command": log.rate_command,
            "throttle": log.throttle,
        }
        held: dict[str, Array] = {}
        for name, values in pairs.items():
            ours = self.outputs.get(name)
            if values is None or ours is None or values.shape[1:] != ours.shape[1:]:
                continue
            gap = np.full((ahead, *values.shape[1:]), np.nan)
            held[name] = np.concatenate([values[ahead:], gap])
        return held

    def facts(self) -> dict[str, Any]:
        """Return what it came to: times in s, differences in the units of the commands."""
        steps = np.diff(self.times)
        off = {}
        for name, theirs in self.commanded.items():
            apart = np.abs(self.outputs[name] - theirs)
            if np.isfinite(apart).any():
                at = np.unravel_index(np.nanargmax(apart), apart.shape)[0]
                off[name] = {
                    "largest": float(np.nanmax(apart)),
                    "at": float(self.times[at]),
                    "rms": float(np.sqrt(np.nanmean(apart**2))),
                }
        faults, full = (self.status & sum(FAULTS)) != 0, (self.status & SATURATED) != 0
        return {
            "mission": self.mission.name,
            "log": self.log.source,
            "partial": self.log.partial or None,
            "firmware": self.firmware,
            "steps": len(self.times),
            "period": float(np.median(steps)),
            "longest_period": float(steps.max()),
            "seconds_a_step": float(np.median(self.seconds)),
            "longest_step": float(self.seconds.max()),
            "saturated": int(full.sum()),
            "saturated_at": float(self.times[full.argmax()]) if full.any() else None,
            "faults": int(faults.sum()),
            "fault_at": float(self.times[faults.argmax()]) if faults.any() else None,
            "differences": off,
        }

    def record(self) -> Record:
        """Return it with names and units."""
        units = {"thrust": "N", "torque": "N m", "rotor": "N", "throttle": "1"}
        variables: dict[str, Column] = {}
        axes = {"rotor": "rotor"}
        for name, values in self.outputs.items():
            dims = ("time",) if values.ndim == 1 else ("time", axes.get(name, "body_axis"))
            unit = units.get(name, "rad/s")
            words = f"{name.replace('_', ' ')} of the firmware"
            stored = "rotor_thrust" if name == "rotor" else name
            variables[stored] = Column(dims, values, {"units": unit, "long_name": words})
            if name in self.commanded:
                words = f"{name.replace('_', ' ')} in the log"
                attrs = {"units": unit, "long_name": words}
                variables[f"{stored}_logged"] = Column(dims, self.commanded[name], attrs)
        words = "0, or a sum of the bits in the firmware's header"
        variables["firmware_status"] = Column(("time",), self.status, {"long_name": words})
        names = np.array(list(self.mission.vehicle.frame.names))
        return Record(
            variables,
            {
                "time": Column(("time",), self.times, {"units": "s"}),
                "body_axis": Column(("body_axis",), np.array(list("xyz")), {}),
                "rotor": Column(("rotor",), names, {}),
            },
            {
                "title": f"what {self.mission.name} would have commanded",
                "log": self.log.source,
                "partial": self.log.partial,
                "firmware": self.firmware,
                "hoverproof_version": __version__,
            },
        )


def replayed(log: FlightLog, mission: Mission, firmware: Firmware) -> Replay:
    """Run firmware over what a log holds of features and inertial data.

    Its thrust starts as that of the log and goes on by its own commands: what differs adds up.

    Parameters
    ----------
    log : FlightLog
    mission : Mission
    firmware : Firmware
        A package of the mission that takes the feature.

    Raises
    ------
    InputError
        If the log does not hold what the firmware takes, or the firmware is another mission's.
    """
    if firmware.manifest["mission"] != mission.exact():
        raise InputError(mission.source, "", f"is not the mission of the firmware {firmware.name}")
    if "camera" not in firmware.manifest:
        raise InputError(firmware.name, "", "takes points: a log holds features (export --camera)")
    law = flown_law(mission)
    names = ["feature", "velocity", "rotation", "rate"]
    names += ["specific_force"] if law.force.sensed is not None else []
    missing = [name.replace("_", " ") for name in names if not log.has(name)]
    if missing:
        raise InputError(log.source, "", f"holds no {', no '.join(missing)}: nothing to replay")
    assert log.feature is not None
    columns = _given(log, law)
    whole = np.asarray(np.isfinite(np.hstack([*columns.values()])).all(axis=1))
    rows, outs, seconds = np.flatnonzero(whole), [], []
    if len(rows) < 2:
        raise InputError(log.source, "", "holds all that a replay needs at fewer than two times")
    firmware.reset(_first_thrust(log, int(rows[0])))
    periods = np.clip(np.diff(log.times[rows], append=np.nan), 1e-6, LONGEST)
    periods[-1] = periods[-2]
    used = np.minimum(np.arange(len(log.times)) + log.ahead, len(log.times) - 1)  # as commands are
    features = log.feature[used]
    seen, feature = ~np.isnan(features.sum(axis=1)), np.zeros(3)
    for k, period in zip(rows, periods, strict=True):
        feature = features[k] if seen[k] else feature
        told = {name: values[k] for name, values in columns.items()}
        begin = time.perf_counter()
        out = firmware.step(feature, **told, dt=period, target_seen=bool(seen[k]))
        seconds.append(time.perf_counter() - begin)
        outs.append(out)
    kept = {"thrust": [o.thrust for o in outs], "torque": [o.torque for o in outs]}
    kept["rotor"] = [o.rotor for o in outs]
    if "rate_bandwidth" in firmware.manifest:
        kept = {"thrust": kept["thrust"], "throttle": [o.throttle for o in outs]}
        kept["rate_command"] = [o.rate_command for o in outs]
    return Replay(
        log.rows(whole),
        mission,
        f"{firmware.name}, {firmware.manifest['precision']}",
        log.times[rows],
        {name: np.array(values, np.float64) for name, values in kept.items()},
        np.array([o.status for o in outs], np.int64),
        np.array(seconds),
    )


def _given(log: FlightLog, law: Law) -> dict[str, Array]:
    """Return what a step of the firmware of a law takes beside the feature, a row each sample."""
    assert log.rotation is not None
    given = {"velocity": log.velocity, "rate": log.rate, "gravity_direction": log.rotation[:, 2]}
    if law.force.sensed is not None:
        given["specific_force"] = log.specific_force
    if law.heading is not None:
        north = log.rotation[:, :2, 0]
        given["heading"] = north / np.linalg.norm(north, axis=1, keepdims=True)
    return {name: np.asarray(values) for name, values in given.items()}


def _first_thrust(log: FlightLog, row: int) -> float | None:
    """Return the thrust that was commanded at a row, N; None, that of hover, if it is not told."""
    if log.thrust_command is None or not np.isfinite(log.thrust_command[row]):
        return None
    return float(log.thrust_command[row])
