"""The commands: each parses, calls one function and prints.

Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, 2 bad usage or bad input,
3 undecided. Heavy imports stand inside the commands that need them, so that help comes at once.
"""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

from cyclopts import App, CycloptsError, Parameter

from hoverproof import __version__
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission import Mission

app = App(
    name="hoverproof",
    version=__version__,
    help="From a camera, a target and a hovering vehicle to gains with a proof and a flight.",
    help_epilogue="Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, "
    "2 bad usage or bad input, 3 undecided.",
    result_action="return_value",
)

MissionName = Annotated[str, Parameter(help="Name of a preset, or path of a mission file.")]
Json = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON object.")]
Set = Annotated[
    list[str] | None,
    Parameter(name="--set", negative="", help="Put a value in place: gains.k4=0.1 (repeatable)."),
]
Box = Annotated[
    str | None,
    Parameter(help="Positions x0,x1,y0,y1,z0,z1 in m; by default around start and goal."),
]
EXIT = {"proved": 0, "refuted": 1, "undecided": 3}


@app.command
def derive(
    *,
    equation: Annotated[
        list[str] | None,
        Parameter(negative="", help="Show this equation alone, in full: 31 (repeatable)."),
    ] = None,
    format_: Annotated[
        Literal["text", "markdown", "latex", "json"],
        Parameter(name="--format", help="How to print."),
    ] = "text",
    json_: Json = False,
) -> int:
    """Judge every equation and claim of the paper against the derived model.

    Each verdict is computed now: holds, holds with correction, false, definition or convention.

    Example: `hoverproof derive --equation 31`
    """
    from hoverproof.paper.ledger import all_proved, as_rows
    from hoverproof.paper.ledger import derive as judge
    from hoverproof.show import ledger as show

    judgements = judge(equation)
    proved = all_proved(judgements)
    if json_ or format_ == "json":
        _print_json({"proved": proved, "claims": as_rows(judgements)})
    elif format_ == "markdown":
        print(show.ledger_markdown(judgements))
    elif format_ == "latex":
        print(show.ledger_latex(judgements))
    elif equation:
        print("\n\n".join(map(show.claim_text, judgements)))
    else:
        print(show.ledger_text(judgements))
    return 0 if proved else 1


@app.command
def certify(
    mission: MissionName,
    *,
    out: Annotated[Path | None, Parameter(help="Certificate file to write.")] = None,
    over_box: Annotated[
        bool,
        Parameter(negative="", help="Use eigenvalue bounds proved over a box (see `region`)."),
    ] = False,
    box: Box = None,
    weights: Annotated[
        str | None,
        Parameter(help="Weights of L: four numbers w1,w2,w3,w4, or `search` for the best ones."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove or refute that the gains work for every Q and thrust in the mission's bounds.

    Writes a certificate (NAME.cert.json), or a counterexample (NAME.refutation.json), that `check`
    verifies without trusting this program.

    Example: `hoverproof certify x4-flyer --set gains.k4=0.1`
    """
    from hoverproof.certification.gains import Proved, Refuted, Undecided, as_json
    from hoverproof.certification.gains import certify as decide
    from hoverproof.certification.region import enclose
    from hoverproof.paper.conditions import printed_demands

    loaded = _load(mission, set_)
    region = enclose(loaded, _box(loaded, box)) if over_box or box else None
    verdict = decide(loaded, weights=_weights(loaded, weights, region), region=region)
    path = None
    if not isinstance(verdict, Undecided):
        ending = "cert" if isinstance(verdict, Proved) else "refutation"
        path = out or Path(f"{loaded.name}.{ending}.json")
        verdict.certificate.save(path)
    demands = printed_demands(loaded)
    if json_:
        paper = [{"condition": d.text(), "met": d.met} for d in demands]
        answer = as_json(verdict, None if path is None else str(path))
        _print_json({**answer, "paper_conditions": paper})
        return EXIT[verdict.status]

    problem = verdict.problem
    (low, high), (weakest, strongest) = problem.eigenvalues, problem.thrust
    print(f"{loaded.name}: {verdict.status}")
    print(
        f"  Σ(Q, T) ≻ 0 for every symmetric Q with eigenvalues in [{_n(low)}, {_n(high)}] 1/m\n"
        f"  and every thrust T in [{_n(weakest)}, {_n(strongest)}] N?"
    )
    if problem.box is not None:
        print(f"  (bounds of the eigenvalues proved over the box {_sides(problem.box)} m)")
    if weights is not None:
        print(f"  weights of L            {', '.join(map(_n, problem.weights))}")
    if isinstance(verdict, Proved):
        gap = float(verdict.margin_above / verdict.margin - 1)
        what = "worst eigenvalue of Σ  " if weights is None else "margin, Σ ⪰ margin·W   "
        print(f"  {what} {_n(verdict.margin)} kg/s, proved (tight to {gap:.0e})")
        print(f"  decay rate of L         {_n(verdict.decay_rate)} 1/s, proved")
        print(f"  certificate             {path}")
    elif isinstance(verdict, Refuted):
        print(f"  worst eigenvalue of Σ   {_n(verdict.margin_above)} kg/s or less, proved")
        print("  counterexample, exact:")
        print(f"    Q = {_matrix(verdict.Q)} 1/m")
        print(f"    f = {verdict.f} 1/m")
        print(f"    X = ({', '.join(map(str, verdict.X))})")
        print(f"    XᵀΣX <= {verdict.value} (about {_n(verdict.value)}) < 0")
        print(f"  written to              {path}")
    else:
        print(f"  {verdict.reason}")
        if verdict.margin_above is not None:
            print(f"  worst eigenvalue of Σ   {_n(verdict.margin_above)} kg/s or less, proved")
    print("The printed theorem asks for (its conditions prove nothing, see `hoverproof derive`):")
    for line in textwrap.wrap("; ".join(d.text() for d in demands), 76):
        print(f"  {line}")
    if path is not None:
        print(f"Next: hoverproof check {path}")
    return EXIT[verdict.status]


@app.command
def region(
    mission: MissionName,
    *,
    box: Box = None,
    out: Annotated[Path | None, Parameter(help="Certificate file to write.")] = None,
    figure: Annotated[bool, Parameter(help="Draw the region beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Prove or refute that the eigenvalue bounds of Q hold for the real target over a box.

    Encloses the eigenvalues over the box, and draws where the bounds hold in a cross-section.

    Example: `hoverproof region x4-flyer --box=-1,5,-1,3,-4.5,-2.5`
    """
    from hoverproof.certification.certificate import seal
    from hoverproof.certification.problem import gain_problem
    from hoverproof.certification.region import Region, enclose, holds_over, outside
    from hoverproof.show.region import save_region_figure

    loaded = _load(mission, set_)
    sides = _box(loaded, box)
    enclosed = enclose(loaded, sides)
    wanted = loaded.bounds.eigenvalues
    inside = wanted[0] <= enclosed.eigenvalues[0] and enclosed.eigenvalues[1] <= wanted[1]
    witness = None if inside else outside(loaded, sides, wanted)
    proved = inside or (witness is None and holds_over(loaded, sides, wanted))
    verdict = "proved" if proved else "undecided" if witness is None else "refuted"
    shown = Region(sides, wanted, enclosed.attained) if proved else enclosed
    path = out or Path(f"{loaded.name}.region.cert.json")
    seal(gain_problem(loaded, region=shown), "region", {}).save(path)
    picture = path.with_name(f"{path.name.removesuffix('.cert.json')}.png")
    if figure:
        save_region_figure(loaded, enclosed, picture)

    if json_:
        _print_json(
            {
                "mission": loaded.name,
                "verdict": verdict,
                "box": [[float(end) for end in side] for side in sides],
                "bounds": [float(x) for x in wanted],
                "enclosure": [float(x) for x in enclosed.eigenvalues],
                "attained": list(enclosed.attained),
                "witness": None
                if witness is None
                else {"position": [str(c) for c in witness[0]], "eigenvalue": witness[1]},
                "certificate": str(path),
                "figure": str(picture) if figure else None,
            }
        )
        return EXIT[verdict]
    low, high = map(_n, enclosed.eigenvalues)
    print(f"{loaded.name}: {verdict}")
    print(f"  bounds [{_n(wanted[0])}, {_n(wanted[1])}] 1/m of the eigenvalues of Q")
    print(f"  for every position in the box {_sides(sides)} m")
    print(f"  proved there            [{low}, {high}] 1/m")
    print(f"  found there             [{_n(enclosed.attained[0])}, {_n(enclosed.attained[1])}] 1/m")
    if witness is not None:
        print(f"  out of bounds           {_n(witness[1])} 1/m at {_position(witness[0])}")
    print(
        f"  certificate             {path} ({'the bounds' if proved else 'what is proved there'})"
    )
    if figure:
        print(f"  figure                  {picture}")
    print(f"Next: hoverproof certify {mission} --over-box")
    return EXIT[verdict]


@app.command
def check(
    certificate: Annotated[Path, Parameter(help="Certificate file.")], *, json_: Json = False
) -> int:
    """Verify a certificate in exact arithmetic, with the standard library alone.

    The same as `python -I -S checker.py FILE`, which needs no installation.

    Example: `hoverproof check x4-flyer.cert.json`
    """
    from hoverproof import checker

    if not json_:
        return checker.main([str(certificate)])
    try:
        theorem = checker.check_file(certificate)
    except checker.Unreadable as error:
        raise InputError(str(certificate), "", str(error)) from None
    except checker.Rejected as error:
        _print_json({"certificate": str(certificate), "accepted": False, "reason": str(error)})
        return 1
    _print_json({"certificate": str(certificate), "accepted": True, "statement": theorem})
    return 0


@app.command
def simulate(
    mission: MissionName,
    *,
    duration: Annotated[
        float | None,
        Parameter(help="Length in s; by default seven time constants of the slowest motion."),
    ] = None,
    step: Annotated[float, Parameter(help="Step of the integrator in s.")] = 0.01,
    every: Annotated[
        int | None, Parameter(help="Keep every so many steps; by default about 2000 are kept.")
    ] = None,
    out: Annotated[Path | None, Parameter(help="Flight file to write, netCDF-4.")] = None,
    figures: Annotated[bool, Parameter(help="Draw the flight beside the file.")] = True,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    Example: `hoverproof simulate x4-flyer --duration 1500`
    """
    from hoverproof.show.figures import save_figures
    from hoverproof.simulation.flight import save, summary
    from hoverproof.simulation.flight import simulate as fly

    loaded = _load(mission, set_)
    flight = fly(loaded, duration=duration, step=step, every=every)
    path = out or Path(f"{loaded.name}.flight.nc")
    save(flight, path)
    pictures = save_figures(flight, path.with_suffix("")) if figures else []
    result: dict[str, Any] = {
        "mission": loaded.name,
        **summary(flight),
        "figures": [str(p) for p in pictures],
        "out": str(path),
    }
    status = 0 if result["outcome"] == "flown" else 1
    if json_:
        _print_json(result)
        return status

    settled = result["settled_at"]
    print(f"{loaded.name}: {result['outcome']}, {result['duration']:g} s")
    print(f"  {result['steps']} steps in {result['seconds']:.2f} s: {result['machine']}")
    if result["machine"] != "compiled C":
        print("  (no C compiler works here; with one this is much faster)")
    print(f"  start     {_position(result['start_position'])}, {result['start_error']:.3g} m away")
    print(f"  end       {_position(result['final_position'])}, {result['final_error']:.3g} m away")
    reached = "not reached" if settled is None else f"from {settled:g} s on"
    print(f"  within 10 % of the distance at the start: {reached}")
    print(f"  flight    {path}")
    for picture in pictures:
        print(f"  figure    {picture}")
    return status


@app.command
def presets(
    name: Annotated[str | None, Parameter(help="Print this preset as a mission file.")] = None,
    *,
    json_: Json = False,
) -> int:
    """List the missions that come with hoverproof, or print one.

    Example: `hoverproof presets x4-flyer`
    """
    from hoverproof.mission import load, preset_text
    from hoverproof.mission import presets as names

    if name is not None:
        text = preset_text(name)
        if json_:
            _print_json(load(name).exact())
        else:
            print(text, end="")
        return 0
    missions = [load(n) for n in names()]
    if json_:
        _print_json({"presets": [m.name for m in missions]})
        return 0
    for m in missions:
        mass, n = _n(m.vehicle.mass), len(m.target.points)
        print(f"{m.name:24} {mass} kg, {n} target points; hoverproof certify {m.name}")
    return 0


@app.command
def new(
    path: Annotated[Path, Parameter(help="Mission file to write.")],
    *,
    preset: Annotated[str, Parameter(name="--from", help="Preset to start from.")] = "x4-flyer",
    force: Annotated[bool, Parameter(negative="", help="Replace an existing file.")] = False,
) -> int:
    """Write a commented mission file to start from.

    Example: `hoverproof new my-flyer.toml`
    """
    import re

    from hoverproof.files import write_text
    from hoverproof.mission import preset_text

    text = preset_text(preset)
    if path.exists() and not force:
        raise InputError(str(path), "", "exists already; --force replaces it")
    name = re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"
    write_text(path, re.sub(r'(?m)^name = ".*"', f'name = "{name}"', text, count=1))
    print(f"{path}: written, from preset {preset}")
    print("Next: put in your vehicle, target and gains, then")
    print(f"  hoverproof certify {path}")
    print(f"  hoverproof simulate {path}")
    return 0


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run a command and exit with its status."""
    try:
        status = app(arguments, exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except CycloptsError as error:
        _fail(f"{str(error).strip()} (see --help)")
    except InputError as error:
        _fail(str(error))
    except KeyboardInterrupt:
        _fail("interrupted", status=130)
    except BrokenPipeError:
        sys.stderr.close()
        status = 0
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: str, status: int = 2) -> NoReturn:
    line = " ".join(message.split())
    print(f"hoverproof: {line}", file=sys.stderr)
    sys.exit(status)


def _load(mission: str, settings: list[str] | None) -> Mission:
    from hoverproof.mission import load

    overrides = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not equals:
            raise InputError(f"--set {setting}", "", "must have the form KEY=VALUE")
        overrides[key.strip()] = value.strip()
    return load(mission, overrides)


def _box(mission: Mission, text: str | None) -> Any:
    from hoverproof.certification.region import default_box, parse_box

    return default_box(mission) if text is None else parse_box(text)


def _weights(mission: Mission, text: str | None, region: Any) -> tuple[Fraction, ...]:
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
    if len(weights) != 4 or not all(0 < w <= 10**9 for w in weights):
        raise InputError(
            "--weights", "", f"must be `search` or four positive numbers w1,w2,w3,w4, not {text!r}"
        )
    return weights


def _print_json(value: dict[str, Any]) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _n(value: Any) -> str:
    return f"{float(value):.6g}"


def _matrix(rows: list[list[Any]]) -> str:
    return "[" + "; ".join(", ".join(map(str, row)) for row in rows) + "]"


def _sides(box: Any) -> str:
    return " x ".join(f"[{_n(a)}, {_n(b)}]" for a, b in box)


def _position(p: Sequence[float | Fraction]) -> str:
    return "(" + ", ".join(f"{round(float(c), 4) + 0.0:g}" for c in p) + ") m"
