"""The command `attraction`: where a controller may be switched on, proved."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import (
    Json,
    MissionName,
    Set,
    at_work,
    load_mission,
)
from hoverproof.cli.reading import as_named, default_stem, file_to_write, refuse_given
from hoverproof.errors import InputError
from hoverproof.mission.tolerances import Tolerance

if TYPE_CHECKING:
    from hoverproof.certification.attraction.starts import Start
    from hoverproof.certification.attraction.verdict import Attraction
    from hoverproof.certification.convergence import Converges
    from hoverproof.certification.exponential.verdict import Exponential
    from hoverproof.certification.largest import Largest
    from hoverproof.design.unproved import Unproved
    from hoverproof.mission.sections import Mission


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
    speed: Annotated[str, Parameter(help="Include speeds up to this, m/s.")] = "0",
    tilt: Annotated[str, Parameter(help="Include tilts up to this, rad.")] = "0",
    rate: Annotated[str, Parameter(help="Include roll and pitch rates up to this, rad/s.")] = "0",
    thrust: Annotated[str, Parameter(help="Include thrusts up to this off m g, N.")] = "0",
    barrier: Annotated[
        bool | None,
        Parameter(help="Use that motions do not sink to the target; by default, if it helps."),
    ] = None,
    largest: Annotated[
        Tolerance | None,
        Parameter(
            help="Find the largest such tolerance, a key of [uncertainty], with which the start is "
            "proved."
        ),
    ] = None,
    out: Annotated[Path | None, Parameter(help="Certificate file to write.")] = None,
    figure: Annotated[bool, Parameter(help="Draw the region beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove from where the vehicle converges to its goal: where it may be switched on.

    That is proved for every vehicle within the tolerances in `[uncertainty]` of the mission.
    Writes NAME.attraction.cert.json, which `check` verifies without trusting this program. A start
    above the target from which the vehicle is shown to sink to the height of its lowest point is
    refuted (status 1) in NAME.attraction.refutation.json. Where vehicles within tolerances are not
    proved, states that refuse all weights of the theorem, if any are found, are written to
    NAME.attraction.refusal.json, and the worst is flown. NAME is as for `certify`.

    Example: `hoverproof attraction x4-flyer --start 20,0,-20`

    Example: `hoverproof attraction x4-flyer --objective radius --no-barrier`

    Example: `hoverproof attraction x4-flyer --set uncertainty.torque=0.2`

    Example: `hoverproof attraction x4-flyer --largest torque`
    """
    from hoverproof.certification.convergence import attraction as decide
    from hoverproof.certification.largest import largest as find
    from hoverproof.cli.answers.attraction import AttractionAnswer
    from hoverproof.design.unproved import unproved

    loaded = load_mission(mission, set_)
    stem = f"{default_stem(loaded, mission, set_, proof=True)}.attraction"
    file_to_write(out, f"{stem}.cert.json")
    given = {"speed": speed, "tilt": tilt, "rate": rate, "thrust": thrust}
    sizes = {name: _number(f"--{name}", text) for name, text in given.items()}
    if start is None and any(sizes.values()):
        start = [",".join(map(str, loaded.start.position))]
    starts = None if start is None else [_start(text, sizes) for text in start]
    found = None
    if largest is not None:
        others = {"--objective": objective != "start", "--barrier": barrier}
        refuse_given(others, "is not for --largest, which is about a start")
    with at_work() as doing:
        if largest is not None:
            found = find(loaded, largest, starts=starts, progress=doing)
            verdict, loaded = found.verdict, found.verdict.mission
            set_ = [*(set_ or []), f"uncertainty.{largest}={float(found.value):g}"]
        else:
            verdict = decide(
                loaded, objective=objective, starts=starts, barrier=barrier, progress=doing
            )
        told = unproved(verdict, starts, doing) if objective == "start" else None
    path, picture, search = _saved(verdict, told, out, stem), None, None
    if path is not None and figure and verdict.proved:
        picture = _draw(verdict.proved, path)
        search = _draw_search(found, path) if found is not None else None
    tells = verdict.status == "undecided" and objective == "start"
    named = as_named(mission, set_)
    then = _then(verdict.mission, named, told is not None and starts is None) if tells else None
    answer = AttractionAnswer(verdict, path, picture, found, search, told, then)
    return tell(answer, json_, loaded)


def _then(mission: Mission, named: str, may_tune: bool) -> tuple[str, str] | None:
    """Return the command that comes next where a start is not proved, and what it does."""
    from hoverproof.certification.attraction.proof import why_not_covered

    if mission.law.feature == "centroid":  # whose gains are searched for near starts alone
        words = "proves a ball of other hovers, and so tells how near a start is"
        covered = not why_not_covered(mission)
        return (f"hoverproof attraction {named} --objective radius", words) if covered else None
    words = "looks for gains with which the start is proved, or says what would help"
    return (f"hoverproof tune {named}", words) if may_tune else None


def _saved(verdict: Converges, told: Unproved | None, out: Path | None, stem: str) -> Path | None:
    """Write the certificate, or what refuses one, and return where it is."""
    if verdict.certificate is not None:
        path = out or Path(f"{stem}.{verdict.ending}.json")
        verdict.certificate.save(path)
        return path
    if told is None or told.refusal is None:
        return None
    path = out or Path(f"{stem}.refusal.json")
    told.save(path)
    return path


def _draw_search(found: Largest, path: Path) -> Path:
    from hoverproof.show.largest import save_largest_figure

    picture = path.with_name(f"{path.name.removesuffix('.json').removesuffix('.cert')}.largest.png")
    save_largest_figure(found, picture)
    return picture


def _draw(verdict: Attraction | Exponential, path: Path) -> Path | None:
    from hoverproof.certification.attraction.verdict import Attraction

    picture = path.with_name(f"{path.name.removesuffix('.json').removesuffix('.cert')}.png")
    if isinstance(verdict, Attraction):
        if not verdict.mission.law.is_papers:  # whose flights and potential it draws
            return None
        from hoverproof.show.attraction import save_attraction_figure

        save_attraction_figure(verdict, picture)
    else:
        from hoverproof.show.exponential import save_exponential_figure

        save_exponential_figure(verdict, picture)
    return picture


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
    from hoverproof.mission.exact import exact

    try:
        value = exact(text[:60])
    except ValueError:
        raise InputError(option, "", f"must be a number, not {text!r}") from None
    if abs(value) > 10**6 or value.denominator > 10**18:
        raise InputError(option, "", f"must be a decimal within 1e6, not {text!r}")
    return value
