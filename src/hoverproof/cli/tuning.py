"""The command `tune`: gains by design."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import Answer, tell
from hoverproof.cli.console import (
    Json,
    MissionName,
    Set,
    at_work,
    load_mission,
    progress,
    warn,
)
from hoverproof.cli.reading import default_stem, file_to_write, mission_name, parse_weights
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.cli.answers.curve import CurveAnswer
    from hoverproof.design.outcome import RegionTuned, StartTuned, Tuned
    from hoverproof.design.tuning import Found, Wish
    from hoverproof.mission.sections import Mission

VALUES = 5
"""So many of what is traded are tried, unless said."""


def tune(
    mission: MissionName,
    *,
    objective: Annotated[
        Literal["start", "decay", "settling", "region"],
        Parameter(
            help="Shortest proved settling time from the mission's start within its tolerances, "
            "largest certified decay rate of L, fastest settling of certified gains, or largest "
            "certified region of attraction."
        ),
    ] = "start",
    bandwidth: Annotated[
        float, Parameter(help="Largest attitude bandwidth (k1 k2 + k3 + k4)/m in rad/s.")
    ] = 20.0,
    rate: Annotated[
        float | None,
        Parameter(
            help="Sampling rate in Hz: keeps the bandwidth times its period at most 0.2; for start "
            "by default the mission's control_rate."
        ),
    ] = None,
    tilt: Annotated[
        float | None, Parameter(help="Largest tilt asked for at the start, in degrees.")
    ] = None,
    rotor_thrust: Annotated[
        float | None,
        Parameter(help="Largest thrust of a rotor in N at the start; by default the mission's."),
    ] = None,
    at_least: Annotated[
        float | None, Parameter(help="Certified decay rate of L that is required, in 1/s.")
    ] = None,
    minimum_decay: Annotated[
        float | None,
        Parameter(
            help="For region: least rate of the slowest motion at the goal, in 1/s; by default "
            "the mission's own."
        ),
    ] = None,
    weights: Annotated[
        str | None,
        Parameter(help="Weights of L: four numbers w1,w2,w3,w4, or `search`; by default ones."),
    ] = None,
    pareto: Annotated[
        int | None,
        Parameter(
            help="Tune for so many bandwidths up to the given one, and draw the curve; for "
            "region, for so many rates of the slowest motion; for start, for so many values of "
            "what is traded."
        ),
    ] = None,
    trade: Annotated[
        str | None,
        Parameter(
            help="For start: draw the proved settling time against bandwidth, distance (of the "
            "start), or a tolerance such as thrust or latency; five values unless --pareto says."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="Mission file to write; with --pareto the figure, PNG or SVG."),
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Find the best gains within a vehicle's limits that can be proved.

    By default these are the gains with the shortest proved settling time from the mission's start,
    of every vehicle within its tolerances, and within the limits of its camera, rotors and control
    rate. The gains are rounded to short decimals and then certified exactly, so what is printed
    is what is proved. What cannot be met ends with status 1, and says what binds, by how much, and
    what would help. With --out FILE.toml, the certificate of the start or the region is written
    to FILE.tuned.cert.json.

    Example: `hoverproof tune my-flyer.toml --out my-tuned-flyer.toml`

    Example: `hoverproof tune x4-flyer --objective decay --bandwidth 20 --out fast.toml`

    Example: `hoverproof tune x4-flyer --objective decay --pareto 4 --out curve.svg`

    Example: `hoverproof tune x4-flyer --objective region --minimum-decay 0.0234`

    Example: `hoverproof tune crazyflie-2.1 --trade thrust --out what-thrust-costs.png`
    """
    loaded = load_mission(mission, set_)
    pareto = VALUES if pareto is None and trade is not None else pareto
    picture = None
    if pareto is not None:
        stem = default_stem(loaded, mission, set_)
        picture = file_to_write(out, f"{stem}.pareto.png", ".svg")
    elif out is not None:
        if out.suffix in (".png", ".svg"):
            raise InputError("--out", "", f"{out} is no mission file: --pareto and --trade draw")
        file_to_write(out, "tuned.toml")
    if pareto is not None and at_least is not None:
        raise InputError("--at-least", "", "does not go with --pareto")
    from hoverproof.design.tuning import Wish

    wish = Wish(
        bandwidth=bandwidth,
        objective=objective,
        rate=rate,
        tilt=None if tilt is None else math.radians(tilt),
        rotor_thrust=rotor_thrust,
        weights="search" if weights == "search" else parse_weights(loaded, weights, None),
        at_least=at_least,
        minimum_decay=minimum_decay,
        trade=trade,
    )
    if pareto is None or picture is None:
        found, written, certificate = _tune(loaded, out, wish)
        return tell(_answer(found, written, certificate), json_, found.mission)
    return tell(_curve(loaded, pareto, picture, wish), json_, loaded)


def _tune(mission: Mission, out: Path | None, wish: Wish) -> tuple[Found, str | None, Path | None]:
    """Find gains; return them with the mission file and the certificate that were written."""
    from hoverproof.design.outcome import Infeasible
    from hoverproof.design.tuning import gains_for

    wanted = mission
    if wish.objective in ("region", "start") and out is not None:
        # the certificate is about the mission in `out`
        wanted = mission.model_copy(update={"name": mission_name(out)})
    if wish.objective == "start":
        with at_work() as doing:
            found = gains_for(wanted, wish, doing)
    else:
        with progress("tune"):
            found = gains_for(wanted, wish)
    if isinstance(found, Infeasible):  # nothing is written, so nothing bears the name of `out`
        found = replace(found, mission=mission)
    warn(found.mission, known=mission)
    if out is None or isinstance(found, Infeasible):
        return found, None, None
    return found, str(out), _write(found, out)


def _write(found: Tuned | RegionTuned | StartTuned, out: Path) -> Path | None:
    """Write a mission file, and the certificate of a region or a start, whose path is returned."""
    from hoverproof.cli.answers.exponential import settled_text
    from hoverproof.cli.answers.region_tuned import reach_text
    from hoverproof.cli.answers.words import number
    from hoverproof.cli.written import write_mission
    from hoverproof.design.outcome import RegionTuned, StartTuned

    certificate = None
    if isinstance(found, RegionTuned):
        proved = f"certified hovers about the goal: {reach_text(found.region)}"
        certificate = found.region.certificate
    elif isinstance(found, StartTuned):
        proved = f"settled from the start, proved: {settled_text(found.verdict)}"
        certificate = found.verdict.certificate
    else:
        proved = f"certified decay rate of L: {number(found.verdict.decay_rate)} 1/s"
    return write_mission(out, found.mission, proved, certificate, "tuned")


def _answer(found: Found, written: str | None, certificate: Path | None) -> Answer:
    from hoverproof.cli.answers.region_tuned import RegionTunedAnswer
    from hoverproof.cli.answers.start_tuned import StartTunedAnswer
    from hoverproof.cli.answers.tuned import InfeasibleAnswer, TunedAnswer
    from hoverproof.design.outcome import Infeasible, RegionTuned, StartTuned

    if isinstance(found, Infeasible):
        return InfeasibleAnswer(found)
    if isinstance(found, StartTuned):
        return StartTunedAnswer(found, written, certificate)
    if isinstance(found, RegionTuned):
        return RegionTunedAnswer(found, written, certificate)
    return TunedAnswer(found, written)


def _curve(mission: Mission, count: int, picture: Path, wish: Wish) -> CurveAnswer:
    """Tune along a curve, and draw it if there is anything to see."""
    from hoverproof.cli.answers.curve import DecayCurveAnswer, RegionCurveAnswer
    from hoverproof.cli.answers.trade import StartCurveAnswer
    from hoverproof.design.outcome import RegionTuned, StartTuned, Tuned
    from hoverproof.design.tuning import pareto as curve
    from hoverproof.show.atlas import save_pareto_figure
    from hoverproof.show.trade import save_trade_figure
    from hoverproof.show.trade_off import save_trade_off_figure

    with progress("tune") as report:
        points = curve(mission, count, wish, report=report)
    if wish.objective == "start":
        traded = wish.trade or "bandwidth"
        if some := any(isinstance(found, StartTuned) for _, found in points):
            save_trade_figure(mission, traded, points, picture)
        return StartCurveAnswer(mission.name, points, picture if some else None, traded, mission)
    tuned = [(at, found) for at, found in points if isinstance(found, Tuned)]
    regions = [found for _, found in points if isinstance(found, RegionTuned)]
    if tuned:
        save_pareto_figure(mission, tuned, picture)
    if regions:
        save_trade_off_figure([r.region for r in regions], regions[0].before, picture)
    kind = RegionCurveAnswer if wish.objective == "region" else DecayCurveAnswer
    return kind(mission.name, points, picture if tuned or regions else None)
