"""Read a log of whatever kind."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hoverproof.audit import bag, dataflash, own, ulog
from hoverproof.audit.log import FlightLog
from hoverproof.audit.tracks import EVER
from hoverproof.errors import InputError

FORMATS = (
    "netCDF of simulate, fly and see, PX4's .ulg, ArduPilot's .bin, and bags of ROS 2 (.mcap, .db3)"
)


def read_log(
    path: str | Path,
    topics: Mapping[str, str] | None = None,
    between: tuple[float, float] = EVER,
) -> FlightLog:
    """Read a log.

    Parameters
    ----------
    path : str or Path
    topics : mapping, optional
        Topic of a bag by the part that it plays: see `hoverproof.audit.bag.PARTS`.
    between : (2,)
        s: what is not is left out.

    Raises
    ------
    InputError
        If it cannot be read, or is no log of a kind that is read.
    """
    path = Path(path)
    first = _first(path)
    if topics and not bag.is_bag(path, first):
        raise InputError("--topic", "", f"is for bags of ROS 2, which {path} is not")
    if bag.is_bag(path, first):
        log = bag.read(path, topics or {}, between)
    elif first.startswith(b"\x89HDF"):
        log = own.read(path, between)
    elif first.startswith(b"ULog\x01\x12\x35"):
        log = ulog.read(path, between)
    elif first.startswith(dataflash.MAGIC):
        log = dataflash.read(path, between)
    else:
        ros1 = first.startswith(b"#ROSBAG")
        reason = "is a bag of ROS 1: rosbags-convert makes one of ROS 2 of it" if ros1 else ""
        raise InputError(str(path), "", reason or f"is no log of a kind that is read: {FORMATS}")
    if len(log.times) < 2:
        raise InputError(str(path), "", "holds no flight: fewer than two times")
    if not (np.diff(log.times) > 0).all():
        raise InputError(str(path), "", "is damaged: its times do not rise")
    return log


def _first(path: Path) -> bytes:
    """Return the first bytes of a file; of a folder none."""
    if path.is_dir():
        return b""
    try:
        with path.open("rb") as file:
            first = file.read(16)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be read: {error.strerror}") from None
    if not first:
        raise InputError(str(path), "", "is empty")
    return first
