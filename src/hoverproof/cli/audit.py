"""The commands `audit` and `replay`: logs of flights that happened."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.completion import mission_names
from hoverproof.cli.console import Json, Set, at_work, load_mission
from hoverproof.cli.reading import default_stem, file_to_write, mission_name, refuse_given, stretch
from hoverproof.cli.written import certificate_beside, write_mission
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.audit.claim import Claim
    from hoverproof.audit.log import FlightLog
    from hoverproof.audit.recertifying import Recertified
    from hoverproof.mission.sections import Mission

MAKER = "audit"
"""In the name of the certificate beside a mission that is written."""
LONG = 50_000_000
"""Bytes: it is said that a longer file is being read."""

LogFile = Annotated[
    Path,
    Parameter(
        help="netCDF of simulate, fly or see; with the extra `logs` PX4's .ulg, ArduPilot's .bin, "
        "a bag of ROS 2."
    ),
]
Topics = Annotated[
    list[str] | None,
    Parameter(
        name="--topic",
        negative="",
        help="Topic of a bag, PART=NAME, where its type does not tell (repeatable); the part is "
        "imu, odometry, pose, feature, sightings, rates, thrust or rotors.",
    ),
]

Between = Annotated[
    str | None,
    Parameter(help="FROM,TO in s: only this part of the log, in more detail."),
]


def audit(
    log: LogFile,
    *,
    mission: Annotated[
        str,
        Parameter(help="Mission whose proof the flight is compared with.", completer=mission_names),
    ],
    certificate: Annotated[
        Path | None,
        Parameter(help="Certificate of `attraction` for this mission; by default proved now."),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="Page to write; by default LOG.audit.html, here."),
    ] = None,
    page: Annotated[bool, Parameter(help="Write the page.")] = True,
    certify: Annotated[
        Path | None,
        Parameter(
            help="Mission file to write, with the tolerances that would cover the flight, proved "
            "with its gains or else with tuned ones; its certificate to FILE.audit.cert.json."
        ),
    ] = None,
    topic: Topics = None,
    between: Between = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Say which assumptions of a mission's proof held in a recorded flight.

    The proof is theorem 5: every vehicle within [uncertainty] converges. Thrust gain, torque gain
    and rotor lag are identified by least squares from what was commanded and felt, latency and
    gaps from time stamps, wind from what is felt across the thrust, Ψ and the field of view from
    estimated positions. What a log does not show is said to be "not told", never to hold.

    Names what broke first, when and by how much, and the tolerances that would cover it, as a
    command that asks for their proof; --certify asks for it now. Status 0 if all that is told
    held, 1 if something broke, 3 if nothing is proved of the mission or told by the log.

    Example: `hoverproof audit flight.nc --mission research-1.5kg`

    Example: `hoverproof audit log.ulg --mission my-flyer.toml --certificate my.cert.json --json`

    Example: `hoverproof audit flight.mcap --mission my-flyer.toml --topic imu=/mavros/imu/data`

    Example: `hoverproof audit flight.nc --mission my-flyer.toml --certify wider.toml`
    """
    from hoverproof.audit.verdict import audit as hold
    from hoverproof.cli.answers.audit import AuditAnswer

    if not page:
        refuse_given({"--out": out}, "does not go with --no-page")
    loaded = load_mission(mission, set_)
    path = (
        file_to_write(out, f"{default_stem(loaded, mission, set_, of=log.stem)}.audit.html")
        if page
        else None
    )
    if certify is not None:
        file_to_write(certify, "wider.toml")
    flight = _log(log, topic, between)
    claim, reason = _claim(loaded, certificate)
    found = hold(flight, loaded, claim)
    tolerances = found.covering()
    words = ["hoverproof", "attraction", mission]
    asked = [f"uncertainty.{key}={value}" for key, value in tolerances.items()]
    words += [word for setting in [*(set_ or []), *asked] for word in ("--set", setting)]
    anew = _anew(mission, [*(set_ or []), *asked], certify) if certify and asked else None
    command = shlex.join(words) if tolerances and anew is None else None
    answer = AuditAnswer(
        found, reason, command, path, certify, certify and certificate_beside(certify, MAKER), anew
    )
    if path is not None:
        from hoverproof.reporting.audit_page import write_page

        write_page(
            path, found, answer.verdict, [*answer.text()], answer.command, [*answer.proof_anew()]
        )
    return tell(answer, json_)


def _anew(mission: str, settings: list[str], out: Path) -> Recertified:
    """Prove a mission with wider tolerances, and write it with its certificate."""
    from hoverproof.audit.recertifying import recertified
    from hoverproof.cli.answers.exponential import settled_text

    loaded = load_mission(mission, settings)
    wider = loaded.model_copy(update={"name": mission_name(out)})  # whom the certificate is about
    with at_work() as doing:
        found = recertified(wider, doing)
    if found.verdict is not None:
        proved = f"settled from the start, proved: {settled_text(found.verdict)}"
        write_mission(out, found.mission, proved, found.verdict.certificate, MAKER)
    return found


def replay(
    log: LogFile,
    *,
    mission: Annotated[
        str,
        Parameter(help="Mission whose controller is run.", completer=mission_names),
    ],
    package: Annotated[
        Path | None,
        Parameter(help="Package to run, exported with --camera; by default exported now."),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="netCDF to write; by default LOG.replay.nc, here."),
    ] = None,
    figure: Annotated[bool, Parameter(help="Draw the commands beside the file.")] = True,
    topic: Topics = None,
    between: Between = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Run the exported C over the features and inertial data of a log.

    Says what it would have commanded at each step, how long the steps were and took, when a limit
    was reached, and how far that is from what was commanded. Its thrust starts as that of the log
    and goes on by its own commands, so that what differs adds up.

    Example: `hoverproof replay flight.nc --mission research-1.5kg`

    Example: `hoverproof replay flight.nc --mission my-flyer.toml --package firmware --json`
    """
    from hoverproof.audit.replaying import replayed
    from hoverproof.cli.answers.replay import ReplayAnswer
    from hoverproof.export.binding import Firmware
    from hoverproof.files import write_bytes
    from hoverproof.firmware.exporting import exported

    loaded = load_mission(mission, set_)
    path = file_to_write(out, f"{default_stem(loaded, mission, set_, of=log.stem)}.replay.nc")
    flight = _log(log, topic, between)
    firmware = exported(loaded, camera=True) if package is None else Firmware(package)
    found = replayed(flight, loaded, firmware)
    write_bytes(path, found.record().netcdf())
    picture = path.with_suffix(".png") if figure else None
    if picture is not None:
        from hoverproof.show.replay import replay_figure
        from hoverproof.show.style import save_figure

        save_figure(replay_figure(found), picture)
    return tell(ReplayAnswer(found.facts(), path, picture), json_)


def _log(path: Path, topics: list[str] | None, between: str | None) -> FlightLog:
    """Read a log, or a part of it; say so if that takes a while."""
    from hoverproof.audit.reading import read_log
    from hoverproof.audit.tracks import EVER

    part = EVER if between is None else stretch("--between", between)
    named = _topics(topics)
    if not path.is_file() or path.stat().st_size < LONG:
        return read_log(path, named, part)
    with at_work() as doing:
        doing(f"reading {path}")
        return read_log(path, named, part)


def _topics(given: list[str] | None) -> dict[str, str]:
    """Return topics by the parts that they play."""
    pairs = [text.partition("=") for text in given or []]
    for part, equals, name in pairs:
        if not (part and equals and name):
            raise InputError("--topic", "", f"must be PART=NAME, as imu=/imu, not {part!r}")
    return {part: name for part, _, name in pairs}


def _claim(mission: Mission, path: Path | None) -> tuple[Claim | None, str]:
    """Return what is proved of a mission, or None and why not."""
    from hoverproof import checker
    from hoverproof.audit.claim import Claim, given_claim
    from hoverproof.certification.convergence import attraction
    from hoverproof.certification.reading import readable

    if path is not None:
        with readable(path):
            return given_claim(checker.read(path), str(path), mission), ""
    with at_work() as doing:
        verdict = attraction(mission, progress=doing)
    if verdict.certificate is None or verdict.proved is None:
        return None, f"{verdict.status}: {verdict.reason}"
    content = verdict.certificate.content
    if content["kind"] != "exponential":
        return None, "proved by another theorem, not by theorem 5"
    return Claim.of(content), ""
