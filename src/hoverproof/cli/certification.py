"""The commands `certify`, `region` and `check`: proofs, and how to check them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.completion import mission_names
from hoverproof.cli.console import (
    Box,
    Boxes,
    Json,
    MissionName,
    Set,
    at_work,
    load_mission,
    warn_of,
)
from hoverproof.cli.reading import as_named, box_sides, default_stem, file_to_write, parse_weights
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.certification.gains import GainsVerdict
    from hoverproof.mission.sections import Mission


def certify(
    mission: MissionName,
    *,
    out: Annotated[
        Path | None,
        Parameter(help="Certificate to write; by default named after the mission."),
    ] = None,
    over_box: Annotated[
        bool,
        Parameter(negative="", help="Use eigenvalue bounds proved over a box (see `region`)."),
    ] = False,
    box: Box = None,
    boxes: Boxes = None,
    weights: Annotated[
        str | None,
        Parameter(help="Weights of L: four numbers w1,w2,w3,w4, or `search` for the best ones."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove or refute that the gains work for every Q and thrust in the mission's bounds.

    Writes a certificate (NAME.cert.json), or a counterexample (NAME.refutation.json), that `check`
    verifies without trusting this program; NAME is that of the preset or mission file, with eight
    digits of its hash if --set makes another mission of it. With --over-box it is
    NAME.over-box.cert.json, with --weights NAME.weighted.cert.json. If it is undecided, status 3,
    nothing is written.

    What it assumes: the eigenvalues of Q (with the scaled feature: J in a ball) and the thrust stay
    in the mission's bounds, and the vehicle does not turn about its vertical axis. See `region` for
    the first, `attraction` for a theorem that assumes neither, of the paper's law.

    Example: `hoverproof certify x4-flyer`

    Example: `hoverproof certify x4-flyer --set gains.k4=0.1` (refuted, status 1)

    Example: `hoverproof certify x4-flyer --over-box --weights search --json`
    """
    from hoverproof.cli.answers.certify import CertifyAnswer
    from hoverproof.paper.conditions import demands_of
    from hoverproof.plausibility import slow_motion

    loaded = load_mission(mission, set_)
    stem = default_stem(loaded, mission, set_, proof=True)
    over_box = over_box or box is not None
    stem += ".over-box" if over_box else ""
    stem += ".weighted" if weights is not None else ""
    file_to_write(out, f"{stem}.cert.json")
    verdict = _over_box(loaded, box, boxes, weights) if over_box else _as_assumed(loaded, weights)
    path = None
    if verdict.certificate is not None:
        path = out or Path(f"{stem}.{verdict.ending}.json")
        verdict.certificate.save(path)
    strange = list(slow_motion(loaded)) if verdict.status == "proved" else []
    for finding in strange:
        warn_of(loaded, finding)
    demands = demands_of(loaded, verdict.problem.eigenvalues)
    asked = box_sides(loaded, box) if over_box else None
    named = as_named(mission, set_)
    answer = CertifyAnswer(verdict, path, demands, weights is not None, strange, asked, named)
    return tell(answer, json_, loaded)


def _as_assumed(mission: Mission, weights: str | None) -> GainsVerdict:
    """Decide with the bounds of Q that the mission assumes."""
    from hoverproof.certification.gains import certify as decide

    return decide(mission, weights=parse_weights(mission, weights, None))


def _over_box(
    mission: Mission, box: str | None, boxes: int | None, weights: str | None
) -> GainsVerdict:
    """Decide with bounds of Q that are proved over a box."""
    from hoverproof.certification.gains import UndecidedGains
    from hoverproof.certification.gains import certify as decide
    from hoverproof.certification.over_box import enclose
    from hoverproof.certification.problem import gain_problem

    region = enclose(mission, box_sides(mission, box), boxes)
    if region is None:
        problem = gain_problem(mission)
        named = problem.flow.named
        reason = f"{named} over the box: not enclosed within the limit of boxes"
        return UndecidedGains(mission=mission, reason=reason, problem=problem, margin_above=None)
    return decide(mission, weights=parse_weights(mission, weights, region), region=region)


def region(
    mission: MissionName,
    *,
    box: Box = None,
    out: Annotated[
        Path | None,
        Parameter(help="Certificate to write; by default named after the mission."),
    ] = None,
    boxes: Boxes = None,
    figure: Annotated[bool, Parameter(help="Draw the region beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove or refute that the eigenvalue bounds of Q hold for the real target over a box.

    With the scaled feature the bounds are a ball that contains J, in place of Q. Encloses the
    eigenvalues, or J, over the box, and draws where the bounds hold in a cross-section.
    Writes a certificate (NAME.region.cert.json), or a position where a bound breaks
    (NAME.region.refutation.json), and the figure NAME.region.png; NAME is as for `certify`.

    Example: `hoverproof region x4-flyer`

    Example: `hoverproof region x4-flyer --box=-1,5,-1,3,-4.5,-2.5 --no-figure`
    """
    from hoverproof.certification.over_box import certify_region
    from hoverproof.cli.answers.region import RegionAnswer

    loaded = load_mission(mission, set_)
    stem = f"{default_stem(loaded, mission, set_, proof=True)}.region"
    file_to_write(out, f"{stem}.cert.json")
    verdict = certify_region(loaded, box_sides(loaded, box), boxes)
    path = out or Path(f"{stem}.{verdict.ending}.json")
    stem = path.name.removesuffix(".json").removesuffix(f".{verdict.ending}")
    picture = path.with_name(f"{stem}.png")
    if verdict.certificate is not None:
        verdict.certificate.save(path)
    if figure:
        from hoverproof.show.region import save_region_figure

        save_region_figure(loaded, verdict, picture)
    answer = RegionAnswer(
        loaded.name,
        verdict,
        path if verdict.certificate else None,
        picture if figure else None,
        f"{as_named(mission, set_)} {'--over-box' if box is None else f'--box={box}'}",
    )
    return tell(answer, json_, loaded)


def check(
    certificate: Annotated[Path, Parameter(help="Certificate file.")],
    *,
    mission: Annotated[
        str | None,
        Parameter(
            help="Preset or mission file: is the certificate about it?", completer=mission_names
        ),
    ] = None,
    set_: Set = None,
    coq: Annotated[
        bool,
        Parameter(negative="", help="Have the proof assistant Coq decide it, too (Debian: coq)."),
    ] = False,
    json_: Json = False,
) -> int:
    """Verify a certificate in exact arithmetic, with the standard library alone.

    The same as `python -I -S checker.py FILE`, which needs no installation. Takes certificates and
    refutations of `certify`, `region` and `attraction`. Status 0 if it is accepted, with the
    theorem in words; 1 if it is rejected, with the reason; 2 if it cannot be read.

    The theorem names the target points and the SHA-256 of the mission's numbers. With --mission,
    status 1 also if the certificate is about another mission, with what differs.

    With --coq, a program that Coq has proved correct decides what is accepted again, and the answer
    says what that covers; status 3 if Coq does not know the kind. The first time takes a minute.

    Example: `hoverproof check x4-flyer.cert.json`

    Example: `hoverproof check x4-flyer.cert.json --mission x4-flyer`

    Example: `hoverproof check x4-flyer.cert.json --coq`

    Example: `hoverproof check x4-flyer.cert.json --json`
    """
    from hoverproof import checker
    from hoverproof.certification.reading import readable
    from hoverproof.cli.answers.check import CheckAnswer

    if set_ and mission is None:
        raise InputError("--set", "", "needs --mission")
    wanted = None if mission is None else load_mission(mission, set_)
    statement = reason = None
    differing: list[str] = []
    try:
        with readable(certificate):
            content = checker.read(certificate)
            statement = checker.check(content)
    except checker.Rejected as error:
        reason = str(error)
    if wanted is not None and statement is not None:
        from hoverproof.certification.certificate import differences

        differing = differences(content, wanted)
    decided = None
    if coq and statement is not None:
        from hoverproof.certification.replay import replay

        with at_work() as doing:
            decided = replay(content, doing)
    return tell(CheckAnswer(certificate, statement, reason, mission, differing, decided), json_)
