"""Firmware of a mission, certified and written as C99."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from hoverproof.certification.certificate import Certificate
from hoverproof.certification.convergence import Progress, attraction
from hoverproof.certification.gains import certify
from hoverproof.certification.problem import pose
from hoverproof.export.binding import Firmware
from hoverproof.export.package import NotCertified, check_options, write_package
from hoverproof.export.standing import Standing
from hoverproof.files import require_folder
from hoverproof.mission.reading import of_mission
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.heading import flown_law


@of_mission
def export_c(
    mission: Mission,
    /,
    out: str | Path,
    *,
    certificate: Certificate | dict[str, Any] | None = None,
    allow_uncertified: bool = False,
    law: Law | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Certify a mission and write its control firmware, a C99 package, with the certificates.

    Where the gains alone are undecided, and nothing else is given or allowed, it is looked for a
    proof that the vehicle converges from the start of the mission.

    Parameters
    ----------
    mission : Mission, or str or Path as `hoverproof.load` takes
    out : str or Path
        Folder to write to; made if needed.
    certificate : Certificate or dict, optional
        Of `hoverproof.attraction` about this mission, which is enough; or what its file holds.
    allow_uncertified : bool
        Write a package even if nothing is proved; every file of it then says so.
    law : Law, optional
        What the firmware computes; by default the law of the mission, which alone a certificate of
        the mission is about.
    progress : callable, optional
        Is told what is being done.
    **options
        precision, sensing, camera, pixels, interface, tunable, name, rotor_limits: see
        `hoverproof.export.package.write_package`.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    hoverproof.export.package.NotCertified
        If nothing is proved, or the law is another one, and that is not allowed; nothing is
        written.
    checker.Rejected
        If the certificate does not prove it.
    InputError
        If an argument cannot be used or the folder cannot be written to.
    """
    require_folder(out)
    own, law = flown_law(mission), law and law.flying(mission)
    if law is not None and law != own:
        if not allow_uncertified:
            why = f"its certificate is about its law, {own.name}, not about {law.name}"
            raise NotCertified(mission.name, "undecided", why)
        return write_package(mission, out, Standing(pose(mission).thrust), law=law, **options)
    verdict = certify(mission)
    gains = verdict.proved.certificate.content if verdict.proved else None
    if gains is None and certificate is None and not allow_uncertified:
        check_options(mission, **options)  # before what may take a while
        certificate = _converges(mission, verdict.status, progress)
    shown = certificate.content if isinstance(certificate, Certificate) else certificate
    standing = Standing(verdict.problem.thrust, gains, shown)
    return write_package(mission, out, standing, **options)


def _converges(mission: Mission, gains: str, progress: Progress | None) -> Certificate:
    """Return the certificate that a vehicle converges from its start, though its gains are `gains`.

    Refuted gains are not looked at: who wants them nevertheless proves it before.
    """
    if gains == "refuted":
        raise NotCertified(mission.name, gains)
    verdict = attraction(mission, progress=progress)
    if not verdict.proved:
        reason = f"the gains alone are {gains}, and from its start it is {verdict.status} too"
        raise NotCertified(mission.name, verdict.status, f"{reason}: {verdict.reason}")
    return verdict.proved.certificate


def exported(mission: Mission, law: Law | None = None, *, camera: bool) -> Firmware:
    """Return the firmware of a mission in float32, proved or not, for flights on this computer.

    Parameters
    ----------
    mission : Mission
    law : Law, optional
        By default that of the mission.
    camera : bool
        Whether it takes the feature.
    """
    with tempfile.TemporaryDirectory() as folder:
        own: dict[str, Any] = {"allow_uncertified": True, "law": law, "camera": camera}
        export_c(mission, folder, name="firmware", **own)
        return Firmware(folder)
