"""What is kept of a flight over MAVLink: a row at each step, and a netCDF file of them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hoverproof.mavlink.guide import Measured, Wanted
from hoverproof.mission.sections import Mission
from hoverproof.servo.laws.heading import flown_law
from hoverproof.simulation.record import Column, Record, feature_words
from hoverproof.version import __version__

PHASES = ("waiting", "ready", "flying", "over")

MOST_ROWS = 720_000
"""Two hours at 100 Hz: beyond, the first are dropped."""

NONE = (math.nan,) * 3
WIDTHS = {
    "time": 1,
    "phase": 1,
    "firmware_status": 1,
    "image_age": 1,
    "gravity_direction": 3,
    "velocity": 3,
    "body_rate": 3,
    "specific_force": 3,
    "feature": 3,
    "rate_setpoint": 3,
    "thrust_command": 1,
    "throttle": 1,
}
UNITS = {
    "firmware_status": ("1", "0, or a sum of the bits in the firmware's header"),
    "phase": ("1", "0 waiting, 1 ready, 2 the law flies, 3 over"),
    "image_age": ("s", "since the exposure of the newest image"),
    "gravity_direction": ("1", "ρ, body frame, told by the autopilot"),
    "velocity": ("m/s", "velocity V, body frame, told by the autopilot"),
    "body_rate": ("rad/s", "angular velocity Ω, body frame, told by the autopilot"),
    "specific_force": ("m/s^2", "body frame, told by the autopilot"),
    "rate_setpoint": ("rad/s", "body rates sent; none where nothing was sent"),
    "thrust_command": ("N", "thrust that the law commands"),
    "throttle": ("1", "thrust sent, 0 to 1; none where nothing was sent"),
}


@dataclass
class Logbook:
    """The steps of a flight.

    Attributes
    ----------
    rows : list of tuples
        Each (k,), in the order of `WIDTHS` and the units of `UNITS`.
    """

    rows: list[tuple[float, ...]] = field(default_factory=list)

    def note(
        self,
        time: float,
        phase: str,
        image_age: float | None,
        measured: Measured | None,
        wanted: Wanted | None,
        sent: tuple[Any, float] | None,
    ) -> None:
        """Keep a step.

        Parameters
        ----------
        time : float
            Since the begin, s.
        phase : str
            One of `PHASES`.
        image_age : float or None
            s.
        measured : Measured or None
        wanted : Wanted or None
        sent : (rates in rad/s, throttle) or None
        """
        if len(self.rows) >= MOST_ROWS:
            del self.rows[: MOST_ROWS // 10]
        m, w = measured, wanted
        body = (
            (*m.rotation[2], *m.rotation.T @ m.velocity, *m.rate, *m.specific_force)
            if m is not None
            else NONE * 4
        )
        self.rows.append(
            (
                time,
                PHASES.index(phase),
                math.nan if w is None else w.status,
                math.nan if image_age is None else image_age,
                *body,
                *(NONE if w is None else w.feature),
                *(NONE if sent is None else sent[0]),
                math.nan if w is None else w.thrust,
                math.nan if sent is None else sent[1],
            )
        )

    def record(self, mission: Mission, outcome: str, **facts: Any) -> Record:
        """Return the flight with names and units.

        Parameters
        ----------
        mission : Mission
        outcome : str
            How it ended, in words.
        **facts
            Attributes besides.
        """
        values = np.array(self.rows).reshape(-1, sum(WIDTHS.values()))
        law = flown_law(mission)
        units = UNITS | {"feature": ("1", feature_words(law))}
        variables, at = {}, 0
        for name, width in WIDTHS.items():
            column = values[:, at] if width == 1 else values[:, at : at + width]
            at += width
            if name == "time":
                times = column
                continue
            unit, words = units[name]
            dims = ("time",) if width == 1 else ("time", "body_axis")
            variables[name] = Column(dims, column, {"units": unit, "long_name": words})
        return Record(
            variables,
            {
                "time": Column(("time",), times, {"units": "s"}),
                "body_axis": Column(("body_axis",), np.array(list("xyz")), {}),
            },
            attrs={
                "title": f"flight of {mission.name} over MAVLink",
                "mission": json.dumps(mission.exact()),
                "law": law.name,
                "outcome": outcome,
                "hoverproof_version": __version__,
                **facts,
            },
        )
