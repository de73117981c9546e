"""The command `fly`: a mission on a vehicle that speaks MAVLink, or on one that is not there."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import EXIT, print_json, print_line, tell
from hoverproof.cli.console import MissionName, Set, fail, load_mission
from hoverproof.cli.interruption import interruption
from hoverproof.cli.reading import file_to_write, refuse_given
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mavlink.flight import Flight
    from hoverproof.mavlink.flying import Wish
    from hoverproof.mavlink.report import Report
    from hoverproof.mission.sections import Mission

WRITING = 30.0
"""s that a log may take to be written after Ctrl-C; by then nothing is sent any more."""


def fly(
    mission: MissionName,
    *,
    mavlink: Annotated[
        str | None,
        Parameter(help="Vehicle at udp:HOST:PORT, udpout:HOST:PORT, serial:DEVICE:BAUD."),
    ] = None,
    rehearse: Annotated[
        Literal["px4", "ardupilot"] | None,
        Parameter(help="Fly a simulated vehicle and pilot, over real MAVLink messages."),
    ] = None,
    features: Annotated[
        str | None,
        Parameter(help="Where sightings come from, as JSON lines: stdin or udp:HOST:PORT."),
    ] = None,
    package: Annotated[
        Path | None,
        Parameter(help="Package to fly, exported with --camera; by default exported now."),
    ] = None,
    rate: Annotated[float, Parameter(help="Rate of the law and its setpoints, Hz.")] = 100.0,
    hover_throttle: Annotated[
        float | None, Parameter(help="Throttle of hover, 0 to 1; by default learned in a hover.")
    ] = None,
    system: Annotated[
        int | None, Parameter(help="MAVLink system of the vehicle; by default the first heard.")
    ] = None,
    duration: Annotated[
        float | None, Parameter(help="Hand control back after this time, s; by default fly on.")
    ] = None,
    clock_drift: Annotated[
        float,
        Parameter(help="Largest drift of the vehicle's clock, s/s; for a simulator 0.02."),
    ] = 0.0002,
    log: Annotated[Path | None, Parameter(help="Log to write at the end, netCDF-4.")] = None,
    seed: Annotated[int, Parameter(help="Seed of the noise of a rehearsal.")] = 0,
    allow_uncertified: Annotated[
        bool, Parameter(negative="", help="Fly gains of which nothing is proved.")
    ] = False,
    set_: Set = None,
    json_: Annotated[
        bool,
        Parameter(name="--json", negative="", help="Print JSON objects, a line each."),
    ] = False,
) -> int:
    """Fly a mission over MAVLink: body rates and thrust, for the autopilot's own rate loop.

    Runs the exported C here, by what the autopilot tells (attitude, velocity, specific force) and
    where the target is seen, and sends SET_ATTITUDE_TARGET while the pilot has the vehicle armed
    and in GUIDED (ArduPilot) or OFFBOARD (PX4). It arms nothing and changes no mode. On any fault,
    when the pilot changes the mode, and on Ctrl-C it sends nothing more: the autopilot then does
    what it is set to do. Exit status 1 after a fault.

    Example: `hoverproof fly crazyflie-2.1 --set interface.rate_bandwidth=25 --rehearse px4
    --duration 20`

    Example: `hoverproof fly my.toml --mavlink udp:127.0.0.1:14550 --log flight.nc`
    """
    from hoverproof.export.package import NotCertified
    from hoverproof.mavlink.flying import Wish, package_of

    loaded = load_mission(mission, set_)
    wish = Wish(rate, hover_throttle, system, duration, clock_drift)
    _check(loaded, wish, mavlink, rehearse, features, log)
    try:
        firmware = package_of(loaded, package, allow_uncertified=allow_uncertified)
    except NotCertified as error:
        if not json_:
            fail(str(error), EXIT[error.status])
        print_json({"mission": loaded.name, "status": error.status, "flown": False}, loaded)
        return EXIT[error.status]
    flight = (
        _real(loaded, firmware, mavlink, features or "stdin", wish, _reporter(json_))
        if mavlink is not None
        else _rehearsed(loaded, firmware, rehearse or "px4", seed, wish, _reporter(json_))
    )
    return _fly(loaded, flight, log, json_)


def _check(
    mission: Mission,
    wish: Wish,
    mavlink: str | None,
    rehearse: str | None,
    features: str | None,
    log: Path | None,
) -> None:
    if (mavlink is None) == (rehearse is None):
        raise InputError("--mavlink", "", "or --rehearse must be given, one of them")
    if rehearse is not None:
        refuse_given({"--features": features}, "is for --mavlink: a rehearsal has its own")
        if wish.duration is None:
            raise InputError("--duration", "", "must be given for a rehearsal, in s")
    if log is not None:
        file_to_write(log, "log.nc")
    wish.check(mission)


def _reporter(json_: bool) -> Callable[[Report], None]:
    """Return what tells how a flight stands: lines on stderr, or of JSON."""
    from hoverproof.cli.answers.fly import status_json, status_line

    if json_:
        return lambda report: print_line(status_json(report))
    begin, end = ("\r\x1b[K", "") if sys.stderr.isatty() else ("", "\n")
    return lambda report: print(begin + status_line(report), end=end, file=sys.stderr, flush=True)


def _real(
    mission: Mission,
    firmware: Any,
    mavlink: str,
    features: str,
    wish: Wish,
    report: Callable[[Report], None],
) -> Flight:
    from hoverproof.mavlink.flying import flight_of
    from hoverproof.mavlink.link import RealClock, link_to
    from hoverproof.mavlink.sight import lines_from

    clock = RealClock()
    sight = lines_from(features, len(mission.target.points), clock.wall)
    return flight_of(mission, firmware, (link_to(mavlink), sight, clock), wish, report)


def _rehearsed(
    mission: Mission,
    firmware: Any,
    autopilot: str,
    seed: int,
    wish: Wish,
    report: Callable[[Report], None],
) -> Flight:
    from hoverproof.mavlink.autopilots import ARDUPILOT, PX4
    from hoverproof.mavlink.flying import flight_of
    from hoverproof.mavlink.rehearsal import Rehearsal, patient_pilot
    from hoverproof.mavlink.stand_in import Habits, StandIn
    from hoverproof.simulation.plan import check_seed

    check_seed(seed)
    habits = Habits(PX4 if autopilot == "px4" else ARDUPILOT)
    flights: list[Flight] = []
    pilot = patient_pilot(lambda: flights[0].phase == "ready")
    world = Rehearsal(StandIn(mission, habits, seed), pilot)
    flights.append(flight_of(mission, firmware, (world, world, world), wish, report))
    return flights[0]


def _fly(mission: Mission, flight: Flight, log: Path | None, json_: bool) -> int:
    from hoverproof.cli.answers.fly import FlyAnswer
    from hoverproof.files import write_bytes

    with _time_to_write():
        try:
            report = flight.run()
        finally:
            if log is not None:
                write_bytes(log, flight.recorded(mission).netcdf())
        if sys.stderr.isatty() and not json_:
            print(file=sys.stderr)
        certified = bool(flight.guide.manifest["certified"])
        fallback = flight.autopilot.fallback if flight.autopilot is not None else ""
        answer = FlyAnswer(
            mission.name, report, flight.flown, flight.fault, fallback, certified, log
        )
        if json_:
            print_line(answer.as_json())
            return answer.status
        return tell(answer, json_, mission)


@contextlib.contextmanager
def _time_to_write() -> Iterator[None]:
    grace, interruption.grace = interruption.grace, WRITING
    try:
        yield
    finally:
        interruption.grace = grace
