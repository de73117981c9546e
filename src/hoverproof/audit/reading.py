"""Read a log of whatever kind."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hoverproof.audit import own, ulog
from hoverproof.audit.log import FlightLog
from hoverproof.errors import InputError

FORMATS = "netCDF of simulate, fly and see, and PX4's .ulg"


def read_log(path: str | Path) -> FlightLog:
    """Read a log.

    Parameters
    ----------
    path : str or Path

    Raises
    ------
    InputError
        If it cannot be read, or is no log of a kind that is read.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            first = file.read(8)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be read: {error.strerror}") from None
    if not first:
        raise InputError(str(path), "", "is empty")
    if first.startswith(b"\x89HDF"):
        log = own.read(path)
    elif first.startswith(b"ULog\x01\x12\x35"):
        log = ulog.read(path)
    else:
        raise InputError(str(path), "", f"is no log of a kind that is read: {FORMATS}")
    if len(log.times) < 2:
        raise InputError(str(path), "", "holds no flight: fewer than two times")
    if not (np.diff(log.times) > 0).all():
        raise InputError(str(path), "", "is damaged: its times do not rise")
    return log
