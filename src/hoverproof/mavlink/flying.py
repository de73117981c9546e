"""A mission made ready to fly over MAVLink: its package, its rate, its throttle."""

from __future__ import annotations

import hashlib
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.export.adapter import oldest_image
from hoverproof.export.binding import Firmware
from hoverproof.export.camera import KEPT
from hoverproof.firmware.exporting import export_c
from hoverproof.mavlink.dialect import dialect
from hoverproof.mavlink.flight import Flight
from hoverproof.mavlink.guide import Guide
from hoverproof.mavlink.link import Clock, Link
from hoverproof.mavlink.report import Report
from hoverproof.mavlink.sight import Sight
from hoverproof.mavlink.throttle import PLAUSIBLE, HoverThrottle
from hoverproof.mavlink.told import DRIFT, Told
from hoverproof.mission.sections import Mission
from hoverproof.simulation.timing import fastest_rate

SLOWEST, FASTEST = 20.0, 400.0
"""Hz of the setpoints."""

MOST_DRIFT = 0.05
"""s in a second: a simulator that runs slower than that is not flown."""


@dataclass(frozen=True)
class Wish:
    """What a user chooses of a flight over MAVLink.

    Attributes
    ----------
    rate : float
        Of steps and setpoints, Hz: 1/s.
    hover_throttle : float or None
        A number from 0 to 1; learned if there is none.
    system : int or None
        Number of the vehicle; by default the first that is heard.
    duration : float or None
        Of the law's own flight, s; by default until the pilot or a fault ends it.
    clock_drift : float
        By how much the vehicle's clock may run apart from ours, s in a second.
    """

    rate: float = 100.0
    hover_throttle: float | None = None
    system: int | None = None
    duration: float | None = None
    clock_drift: float = DRIFT

    def check(self, mission: Mission) -> None:
        """Refuse what cannot be flown.

        Parameters
        ----------
        mission : Mission

        Raises
        ------
        InputError
            If one of them cannot be used.
        """
        oldest = oldest_image(mission)[0] / 1000
        highest = min(FASTEST, (KEPT - 2) / oldest)
        lowest = max(SLOWEST, fastest_rate(mission))
        if not lowest <= self.rate <= highest:
            reason = (
                f"must be from {lowest:.3g} to {highest:.3g} Hz for this mission: its loop is that "
                f"fast, and its images are up to {oldest:g} s old; not {self.rate:g}"
            )
            raise InputError("--rate", "", reason)
        low, high = PLAUSIBLE
        if self.hover_throttle is not None and not low <= self.hover_throttle <= high:
            reason = f"must be from {low:g} to {high:g}, not {self.hover_throttle:g}"
            raise InputError("--hover-throttle", "", reason)
        if self.system is not None and not 1 <= self.system <= 255:
            raise InputError("--system", "", f"must be from 1 to 255, not {self.system}")
        if self.duration is not None and not self.duration > 0:
            raise InputError("--duration", "", f"must be above 0 s, not {self.duration:g}")
        if not DRIFT <= self.clock_drift <= MOST_DRIFT:
            reason = f"must be from {DRIFT:g} to {MOST_DRIFT:g} s/s, not {self.clock_drift:g}"
            raise InputError("--clock-drift", "", reason)


def package_of(
    mission: Mission, folder: Path | None = None, *, allow_uncertified: bool = False
) -> Firmware:
    """Return the package to fly, compiled for this computer.

    Parameters
    ----------
    mission : Mission
    folder : Path, optional
        Of a package that was exported with a camera; by default it is exported now.
    allow_uncertified : bool
        Take one even if nothing is proved of its gains.

    Raises
    ------
    hoverproof.export.package.NotCertified
        If the gains are not proved, and that is not allowed.
    InputError
        If the folder holds no package, or there is no C compiler.
    """
    dialect()  # before the work of it
    if folder is None:
        with tempfile.TemporaryDirectory() as made:
            own: dict[str, Any] = {"allow_uncertified": allow_uncertified, "interface": "rates"}
            export_c(mission, made, camera=True, name="flown", **own)
            return Firmware(made)
    firmware = Firmware(folder)
    if changed := _changed(folder, firmware):
        if not allow_uncertified:
            words = f"its {min(changed)} is not as it was exported, so not what is certified"
            raise InputError(str(folder), "", f"{words}; --allow-uncertified flies it")
        firmware.manifest["certified"] = False
    if not (firmware.manifest["certified"] or allow_uncertified):
        raise InputError(str(folder), "", "is uncertified; --allow-uncertified flies it")
    return firmware


def _changed(folder: Path, firmware: Firmware) -> set[str]:
    """Return which files of the C of a package are not of the SHA-256 that its manifest says."""
    told = firmware.manifest.get("files", {})
    own = {name for name in told if re.fullmatch(r"\w+\.[ch]", name)}
    own |= {path.name for path in folder.glob(f"{firmware.name}*.[ch]")}  # one more may be compiled
    held = {path.name: path.read_bytes() for path in map(folder.joinpath, own) if path.is_file()}
    sums = {name: hashlib.sha256(content).hexdigest() for name, content in held.items()}
    return {name for name in own if name not in sums or sums[name] != told.get(name)}


def flight_of(
    mission: Mission,
    firmware: Firmware,
    ends: tuple[Link, Sight, Clock],
    wish: Wish,
    report: Callable[[Report], None],
) -> Flight:
    """Return a flight, not begun.

    Parameters
    ----------
    mission : Mission
    firmware : Firmware
        Of the mission, with a camera.
    ends : (Link, Sight, Clock)
    wish : Wish
    report : callable
        Takes a `Report` twice a second.
    """
    oldest = oldest_image(mission)[0] / 1000
    gravity = float(mission.vehicle.gravity)
    link, sight, clock = ends
    return Flight(
        Guide(mission, firmware, oldest=oldest),
        gravity,
        link,
        sight,
        clock,
        wish.rate,
        HoverThrottle(gravity, wish.hover_throttle),
        system=wish.system,
        duration=wish.duration,
        report=report,
        told=Told(drift=wish.clock_drift),
    )
