"""The numbers of `[uncertainty]` by their names, with nothing imported: help names them too."""

from __future__ import annotations

from typing import Literal

Tolerance = Literal[
    "thrust",
    "torque",
    "latency",
    "wind",
    "rotor_lag",
    "yaw_rate",
    "control_period",
    "force_lag",
    "gust",
    "noise.feature",
    "noise.velocity",
    "noise.force",
    "noise.rate",
    "noise.vertical",
]
UNITS: dict[Tolerance, str] = {
    "thrust": "",
    "torque": "",
    "latency": "s",
    "wind": "m/s²",
    "rotor_lag": "s",
    "yaw_rate": "rad/s",
    "control_period": "s",
    "force_lag": "s",
    "gust": "m/s²",
    "noise.feature": "",
    "noise.velocity": "m/s",
    "noise.force": "N",
    "noise.rate": "rad/s",
    "noise.vertical": "rad",
}
"""Tolerances that may be asked for, with the unit of each; of a share it is 1."""
