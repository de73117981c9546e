"""The autopilots that are known: which mode takes setpoints, and what it needs before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

ARMED = 128
"""MAV_MODE_FLAG_SAFETY_ARMED in the base mode of a heartbeat."""

MULTICOPTERS = {2, 3, 13, 14, 15, 29, 35}
"""MAV_TYPE of four, two coaxial, six, eight, three, twelve and ten rotors."""

ON_GROUND = 1
"""MAV_LANDED_STATE_ON_GROUND."""


@dataclass(frozen=True)
class Autopilot:
    """An autopilot, as far as setpoints go.

    Attributes
    ----------
    name, mode : str
        Of the mode that takes setpoints of body rates and thrust.
    takes : callable
        custom_mode of a heartbeat ↦ whether it is that mode.
    stream_first : bool
        Whether the mode can be entered only while setpoints come in. They have no effect before.
    imu : int
        Number of the message that tells its specific force.
    fallback : str
        What it does when setpoints stop, in words.
    """

    name: str
    mode: str
    takes: Callable[[int], bool]
    stream_first: bool
    imu: int
    fallback: str


ARDUPILOT = Autopilot(
    "ArduPilot",
    "GUIDED",
    lambda mode: mode in (4, 20),  # GUIDED and GUIDED_NOGPS of Copter
    stream_first=False,
    imu=27,  # RAW_IMU
    fallback="levels and holds its height after GUID_TIMEOUT",
)
PX4 = Autopilot(
    "PX4",
    "OFFBOARD",
    lambda mode: (mode >> 16) & 0xFF == 6,  # PX4_CUSTOM_MAIN_MODE_OFFBOARD
    stream_first=True,
    imu=105,  # HIGHRES_IMU
    fallback="does what COM_OBL_RC_ACT says after COM_OF_LOSS_T",
)
AUTOPILOTS = {3: ARDUPILOT, 12: PX4}
"""By MAV_AUTOPILOT of a heartbeat."""
