"""The command `export`: the control law as C99 firmware."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import EXIT, print_json, tell
from hoverproof.cli.console import Json, MissionName, Set, at_work, fail, load_mission
from hoverproof.errors import InputError

MOST_NEWTONS = 1e9
"""As many as a mission may give a rotor."""


def export(
    mission: MissionName,
    *,
    out: Annotated[Path, Parameter(help="Folder to write to; made if needed.")],
    precision: Annotated[
        Literal["float32", "float64"], Parameter(help="Type of the numbers on the target.")
    ] = "float32",
    sensing: Annotated[
        Literal["points", "centroid"],
        Parameter(help="What the camera delivers: image points, or the centroid already summed."),
    ] = "points",
    camera: Annotated[
        bool,
        Parameter(negative="", help="Keep the newest frame, and turn it with the gyroscope."),
    ] = False,
    pixels: Annotated[
        bool,
        Parameter(negative="", help="Let the adapters take raw pixels, by the mission's lens."),
    ] = False,
    interface: Annotated[
        Literal["torques", "rates"] | None,
        Parameter(
            help="What is commanded: torques, or body rates and thrust to an autopilot's own loop; "
            "by default rates where the mission has interface.rate_bandwidth (rad/s)."
        ),
    ] = None,
    tunable: Annotated[
        bool, Parameter(negative="", help="Keep the gains as parameters that may be set.")
    ] = False,
    name: Annotated[
        str | None, Parameter(help="Prefix of files and symbols; by default from the mission.")
    ] = None,
    rotor_limits: Annotated[
        str | None,
        Parameter(
            help="LOWEST,HIGHEST thrust of a rotor, N; by default the mission's, else 0 to m g/2."
        ),
    ] = None,
    certificate: Annotated[
        Path | None,
        Parameter(help="Certificate of `attraction` for this mission, to be checked and included."),
    ] = None,
    allow_uncertified: Annotated[
        bool,
        Parameter(negative="", help="Write it even if nothing is proved; each file says so."),
    ] = False,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Certify a mission, and write its control law as C99 firmware with the certificate.

    The folder gets the C with a self-test, a README for whoever flashes it, an example that flies,
    adapters for Crazyflie, PX4 and ArduPilot, and a manifest with hashes. Where the gains
    alone are undecided, a proof is searched that the vehicle converges from its start, as by
    `attraction`. Exit status 1 or 3 if that is refuted or undecided; then nothing is written.

    Example: `hoverproof export x4-flyer --out firmware`

    Example: `hoverproof export x4-flyer --out firmware --certificate x4-flyer.attraction.cert.json`

    Example: `hoverproof export crazyflie-2.1 --out firmware --rotor-limits 0,0.15 --tunable`
    """
    from hoverproof import checker
    from hoverproof.cli.answers.export import ExportAnswer, refused_as_json
    from hoverproof.export.package import NotCertified
    from hoverproof.firmware.exporting import export_c

    loaded = load_mission(mission, set_)
    given = None if certificate is None else _read(certificate)
    try:
        with at_work() as doing:
            manifest = export_c(
                loaded,
                out,
                certificate=given,
                progress=doing,
                precision=precision,
                sensing=sensing,
                camera=camera,
                pixels=pixels,
                interface=interface,
                tunable=tunable,
                name=name,
                rotor_limits=None if rotor_limits is None else _limits(rotor_limits),
                allow_uncertified=allow_uncertified,
            )
    except checker.Rejected as error:
        if given is None:
            raise
        raise InputError(str(certificate), "", f"is rejected: {error}") from None
    except NotCertified as error:
        if not json_:
            fail(str(error), EXIT[error.status])
        print_json(refused_as_json(loaded.name, error.status), loaded)
        return EXIT[error.status]
    answer = ExportAnswer(loaded.name, out, manifest, precision, rotor_limits is not None)
    return tell(answer, json_, loaded)


def _read(path: Path) -> dict[str, Any]:
    """Read a certificate of `attraction`; what it says is checked where it is written."""
    from hoverproof import checker
    from hoverproof.certification.reading import readable

    with readable(path):
        content: dict[str, Any] = checker.read(path)
    return content


def _limits(text: str) -> tuple[Fraction, Fraction]:
    from hoverproof.mission.exact import exact

    try:
        low, high = map(exact, text[:200].split(","))
        if max(abs(low), abs(high)) > MOST_NEWTONS:
            raise ValueError
    except ValueError:
        words = f"must be LOWEST,HIGHEST in N, at most {MOST_NEWTONS:g}, not {text!r}"
        raise InputError("--rotor-limits", "", words) from None
    return low, high
