"""The command `attraction`: where a controller may be switched on, proved."""

from __future__ import annotations

import sys
import textwrap
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.console import (
    EXIT,
    Json,
    MissionName,
    Set,
    app,
    certificate_stem,
    interval,
    load_mission,
    number,
    print_json,
)
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.certification.attraction.starts import Start
    from hoverproof.certification.attraction.verdict import Proved, Refuted


@app.command
def attraction(
    mission: MissionName,
    *,
    objective: Annotated[
        Literal["start", "radius", "volume"],
        Parameter(help="Prove a start; or the largest ball, or volume, of hovers."),
    ] = "start",
    start: Annotated[
        list[str] | None,
        Parameter(
            negative="",
            help="Hover x,y,z or box of positions x0,x1,y0,y1,z0,z1 in m to be inside "
            "(repeatable); by default the mission's start.",
        ),
    ] = None,
    speed: Annotated[str, Parameter(help="Speeds up to this are to be inside too, m/s.")] = "0",
    tilt: Annotated[str, Parameter(help="Tilts up to this too, rad.")] = "0",
    rate: Annotated[str, Parameter(help="Roll and pitch rates up to this too, rad/s.")] = "0",
    thrust: Annotated[str, Parameter(help="Thrusts as far from m g as this too, N.")] = "0",
    barrier: Annotated[
        bool | None,
        Parameter(help="Use that motions do not sink to the target; by default, if it helps."),
    ] = None,
    out: Annotated[Path | None, Parameter(help="Certificate file to write.")] = None,
    figure: Annotated[bool, Parameter(help="Draw the region beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove from where the vehicle converges to its goal: where it may be switched on.

    Writes NAME.attraction.cert.json, which `check` verifies without trusting this program. A start
    above the target from which the vehicle is shown to sink to the height of its lowest point is
    refuted (status 1) in NAME.attraction.refutation.json. NAME is as for `certify`.

    Example: `hoverproof attraction x4-flyer --start 20,0,-20`

    Example: `hoverproof attraction x4-flyer --objective radius --no-barrier`
    """
    from hoverproof.certification.attraction.proof import attraction as decide
    from hoverproof.certification.attraction.verdict import Proved, Undecided, as_json, not_covered

    loaded = load_mission(mission, set_)
    sizes = {
        name: _number(f"--{name}", text)
        for name, text in (("speed", speed), ("tilt", tilt), ("rate", rate), ("thrust", thrust))
    }
    starts = None if start is None else [_start(text, sizes) for text in start]
    if starts is None and any(sizes.values()):
        p = loaded.start.position
        starts = [_start(",".join(map(str, p)), sizes)]
    verdict = decide(
        loaded,
        objective=objective,
        starts=starts,
        barrier=barrier,
        progress=lambda text: print(f"{text} ...", file=sys.stderr),
    )
    path = picture = None
    if not isinstance(verdict, Undecided):
        ending = "cert" if isinstance(verdict, Proved) else "refutation"
        stem = certificate_stem(loaded, mission, set_)
        path = out or Path(f"{stem}.attraction.{ending}.json")
        verdict.certificate.save(path)
        if figure and isinstance(verdict, Proved):
            picture = _draw(verdict, path)
    if json_:
        answer = as_json(verdict, None if path is None else str(path))
        print_json({**answer, "figure": picture}, loaded)
        return EXIT[verdict.status]
    print(f"{loaded.name}: {verdict.status}")
    if isinstance(verdict, Undecided):
        for reason in verdict.reason.split("; "):
            print(textwrap.fill(reason, 80, initial_indent="  ", subsequent_indent="    "))
        for line in verdict.advice:
            help_ = f"would help: {line}"
            print(textwrap.fill(help_, 80, initial_indent="  ", subsequent_indent="    "))
        return EXIT[verdict.status]
    if isinstance(verdict, Proved):
        _print_region(verdict)
    else:
        _print_motion(verdict)
    print(f"  certificate             {path}")
    if picture:
        print(f"  figure                  {picture}")
    print("Not covered:")
    for line in not_covered(verdict):
        print(f"  {line}")
    print(f"Next: hoverproof check {path}")
    return EXIT[verdict.status]


def _print_region(verdict: Proved) -> None:
    reach, height = verdict.reach, verdict.barrier_height
    at = "" if height is None else f" at least {number(height)} m above the target"
    print("  the motion converges to the goal: the controller may be switched on, with any")
    print("  heading and yaw rate, in every")
    if height is None:
        print(f"  state with Λ <= {number(verdict.level)} and T > 0; from hover, about the goal:")
    else:
        print(f"  level hover with Λ <= {number(verdict.level)}{at},")
        print("  so about the goal")
    print(f"  sideways, all round     {number(reach.sideways)} m")
    print(f"  up                      {number(reach.up)} m")
    print(f"  down                    {number(reach.down)} m")
    for start in verdict.starts:
        print(f"  and from                {_describe(start)}")
    print("  On the way:")
    print(f"  weights a2, a3, a4      {', '.join(map(number, verdict.weights))}")
    print(f"  Λ' <= -(k1/m) ε |Y|²    ε = {number(verdict.rate)}")
    print(f"  tilt                    {number(verdict.tilt)} rad or less")
    print(f"  thrust                  in {interval(verdict.thrust)} N")
    print(f"  eigenvalues of Q        {number(verdict.largest_eigenvalue)} 1/m or less")
    if height is not None:
        print(f"  height                  {number(height)} m or more above the target")


def _print_motion(verdict: Refuted) -> None:
    state = verdict.state
    print(f"  {verdict.reason},")
    print("  by the exact model, from the state (world axes, yaw rate zero):")
    for name, sides, unit in (
        ("position", state.position, "m"),
        ("velocity", state.velocity, "m/s"),
        ("body axis e3", state.axis, ""),
        ("its derivative", state.turning, "1/s"),
        ("thrust", [state.thrust], "N"),
    ):
        middle = ", ".join(number((a + b) / 2) for a, b in sides)
        print(f"  {name:22}  {middle} {unit}".rstrip())


def _describe(start: Start) -> str:
    point = all(a == b for a, b in start.position)
    sides = (", " if point else " x ").join(
        number(a) if a == b else interval((a, b)) for a, b in start.position
    )
    sizes = [
        f"{word} <= {number(value)} {unit}"
        for word, value, unit in (
            ("speed", start.speed, "m/s"),
            ("tilt", start.tilt, "rad"),
            ("rates", start.rate, "rad/s"),
            ("|T - m g|", start.thrust, "N"),
        )
        if value
    ]
    return ", ".join([f"({sides}) m", *(sizes or ["level hover"])])


def _draw(verdict: Proved, path: Path) -> str:
    from hoverproof.show.attraction import save_attraction_figure

    picture = path.with_name(f"{path.name.removesuffix('.json').removesuffix('.cert')}.png")
    save_attraction_figure(verdict, picture)
    return str(picture)


def _start(text: str, sizes: dict[str, Fraction]) -> Start:
    from hoverproof.certification.attraction.starts import Start
    from hoverproof.certification.region import parse_box

    parts = [_number("--start", part) for part in text[:400].split(",")]
    if len(parts) == 3:
        position: Any = tuple((c, c) for c in parts)
    elif len(parts) == 6:
        position = parse_box(text)
    else:
        raise InputError("--start", "", f"must be x,y,z or x0,x1,y0,y1,z0,z1 in m, not {text!r}")
    return Start(position, **sizes)


def _number(option: str, text: str) -> Fraction:
    """Read an exact decimal of a reasonable size."""
    try:
        value = Fraction(text.strip()[:60])
    except (ValueError, ZeroDivisionError):
        raise InputError(option, "", f"must be a number, not {text!r}") from None
    if abs(value) > 10**6 or value.denominator > 10**18:
        raise InputError(option, "", f"must be a decimal within 1e6, not {text!r}")
    return value
