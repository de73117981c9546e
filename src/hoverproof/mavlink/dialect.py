"""MAVLink as bytes: what is sent and understood, by pymavlink, imported when it is used."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from hoverproof.errors import needing

ATTITUDE_IGNORE = 128
"""The type mask of a setpoint of body rates and thrust: of all fields, the attitude is ignored."""

RATES_IGNORE = 7
"""The type mask of a setpoint of attitude and thrust: of all fields, the body rates are ignored."""

COMPANION = 191
"""MAV_COMP_ID_ONBOARD_COMPUTER."""

AUTOPILOT = 1
"""MAV_COMP_ID_AUTOPILOT1."""


def dialect() -> Any:
    """Return pymavlink's common dialect of MAVLink 2.

    Raises
    ------
    InputError
        If it is not installed.
    """
    with needing("mavlink", "--mavlink", "needs pymavlink"):
        from pymavlink.dialects.v20 import common
    return common


class Codec:
    """One end of a link: makes bytes of messages and messages of bytes.

    Parameters
    ----------
    system, component : int
        Of this end, bare numbers.
    """

    def __init__(self, system: int, component: int) -> None:
        self._own = dialect().MAVLink(None, system, component)
        self._own.robust_parsing = True  # what is no message is skipped

    def messages(self, data: bytes) -> list[Any]:
        """Return the messages that are whole and right, in the order that they came in.

        Parameters
        ----------
        data : bytes
        """
        found = self._own.parse_buffer(data) or []
        return [message for message in found if message.get_type() != "BAD_DATA"]

    def packed(self, message: Any) -> bytes:
        """Return the bytes of a message, with the next number of the sequence.

        Parameters
        ----------
        message : MAVLink_message
        """
        return bytes(message.pack(self._own))

    def setpoint(self, time: float, system: int, rates: Sequence[float], throttle: float) -> bytes:
        """Return SET_ATTITUDE_TARGET with body rates and thrust, and no attitude.

        Parameters
        ----------
        time : float
            s.
        system : int
            The vehicle, a bare number.
        rates : (3,)
            Body axes: forward, right, down; rad/s.
        throttle : float
            A number from 0 to 1.
        """
        values = ([1.0, 0.0, 0.0, 0.0], *rates, throttle)
        return self._set_attitude_target(time, system, ATTITUDE_IGNORE, *values)

    def level(self, time: float, system: int, yaw: float, throttle: float) -> bytes:
        """Return SET_ATTITUDE_TARGET with a level attitude and thrust, and no body rates.

        Parameters
        ----------
        time : float
            s.
        system : int
            The vehicle, a bare number.
        yaw : float
            rad.
        throttle : float
            A number from 0 to 1.
        """
        values = ([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)], 0.0, 0.0, 0.0, throttle)
        return self._set_attitude_target(time, system, RATES_IGNORE, *values)

    def _set_attitude_target(self, time: float, system: int, mask: int, *values: Any) -> bytes:
        stamp = int(time * 1000) % 2**32
        known = dialect()
        return self.packed(
            known.MAVLink_set_attitude_target_message(stamp, system, AUTOPILOT, mask, *values)
        )

    def request(self, system: int, message: int, rate: float) -> bytes:
        """Return SET_MESSAGE_INTERVAL: the wish for a message at a rate.

        Parameters
        ----------
        system, message : int
            The vehicle and the number of the message, bare numbers.
        rate : float
            Hz: 1/s.
        """
        interval = [message, 1e6 / rate, 0, 0, 0, 0, 0]
        command = dialect().MAV_CMD_SET_MESSAGE_INTERVAL
        wish = dialect().MAVLink_command_long_message(system, AUTOPILOT, command, 0, *interval)
        return self.packed(wish)
