"""The commands `certify`, `region` and `check`: proofs, and how to check them."""

from __future__ import annotations

import textwrap
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from hoverproof.cli.completion import mission_names
from hoverproof.cli.console import (
    EXIT,
    Box,
    Boxes,
    Json,
    MissionName,
    Set,
    app,
    box_sides,
    certificate_stem,
    interval,
    load_mission,
    number,
    position_text,
    print_json,
    sides_text,
)
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission

CLAIM = {
    "proved": "Σ(Q, T) ≻ 0 for",
    "refuted": "not Σ(Q, T) ≻ 0 for",
    "undecided": "not known: whether Σ(Q, T) ≻ 0 for",
}


@app.command
def certify(
    mission: MissionName,
    *,
    out: Annotated[
        Path | None, Parameter(help="Certificate to write; by default named after the mission.")
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
    verifies without trusting this program; NAME is the name in the mission, with eight digits of
    its hash if --set makes another mission of it. With --over-box it is NAME.over-box.cert.json,
    with --weights NAME.weighted.cert.json. If it is undecided, status 3, nothing is written.

    What it assumes: the eigenvalues of Q and the thrust stay in the mission's bounds, and the
    vehicle does not turn about its vertical axis. See `region` for the first, `attraction` for a
    theorem that assumes neither.

    Example: `hoverproof certify x4-flyer`

    Example: `hoverproof certify x4-flyer --set gains.k4=0.1` (refuted, status 1)

    Example: `hoverproof certify x4-flyer --over-box --weights search --json`
    """
    from hoverproof.certification.gains import Proved, Refuted, Undecided, Verdict, as_json
    from hoverproof.certification.gains import certify as decide
    from hoverproof.certification.problem import gain_problem
    from hoverproof.certification.region import enclose
    from hoverproof.paper.conditions import printed_demands

    loaded = load_mission(mission, set_)
    stem = certificate_stem(loaded, mission, set_)
    over_box = over_box or box is not None
    region = enclose(loaded, box_sides(loaded, box), boxes) if over_box else None
    verdict: Verdict
    if over_box and region is None:
        reason = "the eigenvalues of Q over the box were not enclosed within the limit of boxes"
        verdict = Undecided(None, reason, gain_problem(loaded))
    else:
        verdict = decide(loaded, weights=parse_weights(loaded, weights, region), region=region)
    path = None
    if not isinstance(verdict, Undecided):
        ending = "cert" if isinstance(verdict, Proved) else "refutation"
        kind = [stem, "over-box"] if over_box else [stem]
        kind += [] if weights is None else ["weighted"]
        path = out or Path(".".join([*kind, ending, "json"]))
        verdict.certificate.save(path)
    demands = printed_demands(loaded, verdict.problem.eigenvalues)
    if json_:
        paper = [{"condition": d.text(), "met": d.met} for d in demands]
        answer = as_json(verdict, None if path is None else str(path))
        print_json({**answer, "paper_conditions": paper}, loaded)
        return EXIT[verdict.status]

    problem = verdict.problem
    print(f"{loaded.name}: {verdict.status}")
    print(f"  {CLAIM[verdict.status]} every symmetric Q with eigenvalues in")
    print(
        f"  {interval(problem.eigenvalues)} 1/m and every thrust T in {interval(problem.thrust)} N"
    )
    if problem.box is not None:
        print("  (bounds of the eigenvalues proved over the box")
        print(f"  {sides_text(problem.box)} m)")
        own = loaded.bounds.eigenvalues
        if over_box and isinstance(own, tuple):
            print(f"  the mission's own bounds {interval(own)} 1/m are not used")
    else:
        print("  (bounds of the eigenvalues assumed, not proved: see hoverproof region)")
    if weights is not None:
        print(f"  weights of L            {', '.join(map(number, problem.weights))}")
    if isinstance(verdict, Proved):
        gap = float(verdict.margin_above / verdict.margin - 1)
        what = "worst eigenvalue of Σ  " if weights is None else "margin, Σ ⪰ margin·W   "
        print(f"  {what} {number(verdict.margin)} kg/s, proved (tight to {gap:.0e})")
        print(f"  decay rate of L         {number(verdict.decay_rate)} 1/s, proved")
        print(f"  certificate             {path}")
    elif isinstance(verdict, Refuted):
        print(f"  worst eigenvalue of Σ   {number(verdict.margin_above)} kg/s or less, proved")
        print("  counterexample, exact:")
        print(f"    Q = {matrix(verdict.Q)} 1/m")
        print(f"    f = {verdict.f} 1/m")
        print(f"    X = ({', '.join(map(str, verdict.X))})")
        print(f"    XᵀΣX <= {verdict.value} (about {number(verdict.value)}) < 0")
        print(f"  written to              {path}")
    else:
        print(f"  {verdict.reason}")
        if verdict.margin_above is not None:
            print(f"  worst eigenvalue of Σ   {number(verdict.margin_above)} kg/s or less, proved")
    print("Asked for by the printed theorem (which is false, see hoverproof derive):")
    whole = "; ".join(d.text().replace(" ", "\xa0") for d in demands)  # broken between, not within
    for line in textwrap.wrap(whole, 76):
        print("  " + line.replace("\xa0", " "))
    if path is not None:
        print(f"Next: hoverproof check {path}")
    return EXIT[verdict.status]


@app.command
def region(
    mission: MissionName,
    *,
    box: Box = None,
    out: Annotated[
        Path | None, Parameter(help="Certificate to write; by default named after the mission.")
    ] = None,
    boxes: Boxes = None,
    figure: Annotated[bool, Parameter(help="Draw the region beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove or refute that the eigenvalue bounds of Q hold for the real target over a box.

    Encloses the eigenvalues over the box, and draws where the bounds hold in a cross-section.
    Writes a certificate (NAME.region.cert.json), or a position where a bound breaks
    (NAME.region.refutation.json), and the figure NAME.region.png; NAME is as for `certify`.

    Example: `hoverproof region x4-flyer`

    Example: `hoverproof region x4-flyer --box=-1,5,-1,3,-4.5,-2.5 --no-figure`
    """
    from hoverproof.certification.over_box import certify_region
    from hoverproof.show.region import save_region_figure

    loaded = load_mission(mission, set_)
    sides = box_sides(loaded, box)
    verdict = certify_region(loaded, sides, boxes)
    found, spot, wanted = verdict.enclosure, verdict.outside, verdict.bounds
    ending = "refutation" if spot else "cert"
    path = out or Path(f"{certificate_stem(loaded, mission, set_)}.region.{ending}.json")
    picture = path.with_name(f"{path.name.removesuffix('.json').removesuffix(f'.{ending}')}.png")
    if verdict.certificate is not None:
        verdict.certificate.save(path)
    if figure:
        save_region_figure(loaded, verdict, picture)

    if json_:
        witness = spot and {
            "position": [str(c) for c in spot.position],
            "eigenvalue": spot.eigenvalue,
            "bound": spot.bound,
        }
        print_json(
            {
                "mission": loaded.name,
                "verdict": verdict.status,
                "box": [[float(end) for end in side] for side in sides],
                "bounds": [float(x) for x in wanted],
                "enclosure": found and [float(x) for x in found.eigenvalues],
                "attained": found and list(found.attained),
                "witness": witness,
                "certificate": str(path) if verdict.certificate else None,
                "figure": str(picture) if figure else None,
                "units": {"box": "m", "bounds": "1/m", "enclosure": "1/m", "attained": "1/m"},
            },
            loaded,
        )
        return EXIT[verdict.status]
    print(f"{loaded.name}: {verdict.status}")
    print(f"  bounds {interval(wanted)} 1/m of the eigenvalues of Q")
    print(f"  for every position in the box {sides_text(sides)} m")
    if found is None:
        print("  nothing is proved there within the limit of boxes (--boxes)")
    else:
        print(f"  proved there            {interval(found.eigenvalues)} 1/m")
        print(f"  found there             {interval(found.attained)} 1/m")
    if spot is not None:
        value, place = number(spot.eigenvalue), position_text(spot.position)
        print(f"  {spot.bound} bound broken      {value} 1/m at {place}")
        low, high = wanted if found is None else found.attained
        if spot.bound == "lower" and high > wanted[1]:
            print(f"  upper bound broken too  {number(high)} 1/m found, not in the certificate")
        if spot.bound == "upper" and low < wanted[0]:
            print(f"  lower bound broken too  {number(low)} 1/m found, not in the certificate")
    if verdict.certificate is not None:
        contents = {"proved": "the bounds", "refuted": "where they break"}
        what = contents.get(verdict.status, "what is proved there")
        print(f"  certificate             {path} ({what})")
    if figure:
        print(f"  figure                  {picture}")
    if found is not None:
        given = "--over-box" if box is None else f"--box={box}"
        print(f"Next: hoverproof certify {mission} {given}")
    return EXIT[verdict.status]


@app.command
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
    json_: Json = False,
) -> int:
    """Verify a certificate in exact arithmetic, with the standard library alone.

    The same as `python -I -S checker.py FILE`, which needs no installation. Takes certificates and
    refutations of `certify`, `region` and `attraction`. Status 0 if it is accepted, with the
    theorem in words; 1 if it is rejected, with the reason; 2 if it cannot be read.

    The theorem names the target points and the SHA-256 of the mission's numbers. With --mission,
    status 1 also if the certificate is about another mission, with what differs.

    Example: `hoverproof check x4-flyer.cert.json`

    Example: `hoverproof check x4-flyer.cert.json --mission x4-flyer`

    Example: `hoverproof check x4-flyer.cert.json --json`
    """
    from hoverproof import checker
    from hoverproof.certification.certificate import differences

    if set_ and mission is None:
        raise InputError("--set", "", "needs --mission")
    wanted = None if mission is None else load_mission(mission, set_)
    try:
        content = checker.read(certificate)
    except checker.Unreadable as error:
        raise InputError(str(certificate), "", str(error)) from None
    answer: dict[str, Any] = {"certificate": str(certificate)}
    if not json_:
        status = checker.tell(str(certificate), content)
    else:
        try:
            answer |= {"accepted": True, "statement": checker.check(content)}
        except checker.Rejected as error:
            answer |= {"accepted": False, "reason": str(error)}
        status = 0 if answer["accepted"] else 1
    if wanted is not None:
        differing = differences(content, wanted) if status == 0 else []
        if not json_ and status == 0:
            some = [*differing[:3], *(["..."] if len(differing) > 3 else [])]
            other = f"is about another mission than {mission}: {'; '.join(some)}"
            print(f"{certificate}: {other if differing else f'is about the mission {mission}'}")
        status = 1 if differing else status
        answer |= {"mission": mission, "about_mission": status == 0, "differences": differing}
    if json_:
        print_json(answer)
    return status


def parse_weights(mission: Mission, text: str | None, region: Any) -> tuple[Fraction, ...]:
    """Read --weights: four numbers, or the best ones; by default ones."""
    from hoverproof.certification.gains import search_weights
    from hoverproof.certification.problem import ONES

    if text is None:
        return ONES
    if text == "search":
        return search_weights(mission, region=region)
    try:
        weights = tuple(Fraction(part.strip()) for part in text[:400].split(","))
    except (ValueError, ZeroDivisionError):
        weights = ()
    if len(weights) != 4 or not all(0 < w <= 10**9 and w.denominator <= 10**18 for w in weights):
        raise InputError(
            "--weights",
            "",
            "must be `search` or four positive numbers w1,w2,w3,w4 of at most 18 decimals, "
            f"not {text!r}",
        )
    return weights


def matrix(rows: list[list[Any]]) -> str:
    """Write a matrix, row by row."""
    return "[" + "; ".join(", ".join(map(str, row)) for row in rows) + "]"
