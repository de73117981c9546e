"""The command `simulate`: a mission, flown once or many times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from hoverproof.cli.answers.answer import tell
from hoverproof.cli.console import Json, MissionName, Set, load_mission, progress
from hoverproof.cli.pixels import ByImages
from hoverproof.cli.reading import as_named, default_stem, file_to_write, refuse_given
from hoverproof.cli.runs import fly_many
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.cli.answers.flight import FlightAnswer
    from hoverproof.mission.sections import Mission
    from hoverproof.show.decay import Decay
    from hoverproof.simulation.record import Record
    from hoverproof.simulation.timing import Timing


def simulate(
    mission: MissionName,
    *,
    duration: Annotated[
        float | None,
        Parameter(help="Length in s; by default seven time constants of the slowest motion."),
    ] = None,
    step: Annotated[
        float | None,
        Parameter(help="Step of the integrator in s; by default 0.01, or what a fast loop needs."),
    ] = None,
    every: Annotated[
        int | None,
        Parameter(help="Store every so many steps; by default about 2000 are stored, of runs 200."),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="Flight file to write; by default named after the mission."),
    ] = None,
    figures: Annotated[
        list[Literal["motion", "features", "path"]] | None,
        Parameter(
            negative="--no-figures",
            help="Draw this one (repeatable); by default all. Of runs: all or none.",
        ),
    ] = None,
    animate: Annotated[
        Path | None,
        Parameter(help="Animation to write: FILE.mp4, FILE.gif or FILE.html."),
    ] = None,
    speed_up: Annotated[
        float | None,
        Parameter(help="Flight seconds in a second of animation; by default about 12 s in all."),
    ] = None,
    runs: Annotated[
        int | None, Parameter(help="Number of flights, drawn from [scatter] of the mission.")
    ] = None,
    seed: Annotated[int, Parameter(help="Seed of all that is drawn: noise, wind, scatter.")] = 0,
    threads: Annotated[
        int | None, Parameter(help="Threads for runs; by default as many as processors.")
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Fly runs on a Dask cluster: tcp://host:8786 (extra cluster).")
    ] = None,
    resume: Annotated[
        bool, Parameter(negative="", help="Continue a file of runs that was cut short.")
    ] = False,
    precision: Annotated[
        Literal["float32", "float64"],
        Parameter(help="Type of the numbers stored, of runs."),
    ] = "float32",
    controller: Annotated[
        Literal["model", "firmware"],
        Parameter(help="Fly the model's controller, or the exported C in float32, at every step."),
    ] = "model",
    images: Annotated[ByImages | None, Parameter(name="*", help="What it sees by.")] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Fly a mission from its start, with the camera in the loop.

    Writes NAME.flight.nc (netCDF-4, with units and the mission inside), NAME as for `certify`, and
    draws the flight beside it, in NAME.flight.motion.png, features and path; where the gains are
    proved for the mission's bounds, and the flight keeps to them, with the certified decay of L as
    a line.

    With --runs, fly it many times, into NAME.flights.nc: starts and vehicles are drawn from
    [scatter] of the mission, and the file depends on mission, seed and times alone, not on threads
    or interruptions.
    `hoverproof new` writes all that [sensors], [rotors], [wind], [model_error] and [scatter] know.

    Example: `hoverproof simulate x4-flyer --duration 1500`

    Example: `hoverproof simulate x4-flyer --set "start.position=[3, 1, -5]" --json`

    Example: `hoverproof simulate x4-flyer --runs 1000 --set scatter.position=[1,1,1]`

    Example: `hoverproof simulate crazyflie-2.1 --controller firmware --step 0.001`

    Example: `hoverproof simulate my-flyer.toml --pixels --tag 36h11:0:0.2 --film seen.avi`
    """
    loaded = load_mission(mission, set_)
    stem = default_stem(loaded, mission, set_)
    path = file_to_write(out, f"{stem}.{'flight' if runs is None else 'flights'}.nc")
    if runs is None:
        for_runs = {"--resume": resume, "--scheduler": scheduler, "--threads": threads}
        refuse_given(for_runs, "is for --runs")
        _check_animation(animate, speed_up)
        from hoverproof.simulation.timing import Timing

        images = images or ByImages()
        fly = partial(_fly, loaded, seed, images, firmware=controller == "firmware")
        flight = fly(Timing(duration, step, every))
        named = as_named(mission, set_)
        again = None if images.pixels else lambda until: fly(Timing(until, step))
        told = _keep(loaded, named, flight, path, figures, animate, speed_up, again)
        return tell(told, json_, loaded)
    firmware = controller == "firmware"
    for_one = {"--animate": animate, "--speed-up": speed_up, "--controller": firmware}
    refuse_given(for_one, "is for a single flight, not for --runs")
    (images or ByImages()).refuse("is for a single flight, with --pixels")
    answer = fly_many(
        loaded,
        path,
        draw=figures is None or bool(figures),
        runs=runs,
        seed=seed,
        precision=precision,
        threads=threads,
        scheduler=scheduler,
        resume=resume,
        duration=duration,
        step=step,
        every=every,
    )
    return tell(answer, json_, loaded)


def _check_animation(animate: Path | None, speed_up: float | None) -> None:
    """Refuse an animation that cannot be made, before the flight."""
    if animate is None:
        refuse_given({"--speed-up": speed_up}, "is for --animate")
    else:
        from hoverproof.show.animation import check_request

        check_request(animate, speed_up)


def _fly(
    mission: Mission, seed: int, images: ByImages, timing: Timing, *, firmware: bool
) -> Record:
    if images.pixels:
        return images.fly(mission, seed, timing, firmware=firmware)
    images.refuse()
    if firmware:
        from hoverproof.firmware.flying import flown_firmware

        return flown_firmware(mission, timing, seed=seed)
    from hoverproof.simulation.flight import flown

    return flown(mission, timing, seed=seed)


def _keep(
    mission: Mission,
    named: str,
    flight: Record,
    path: Path,
    figures: Sequence[str] | None,
    animate: Path | None,
    speed_up: float | None,
    again: Callable[[float], Record] | None,
) -> FlightAnswer:
    """Write a flight, its figures and its animation."""
    from hoverproof.cli.answers.flight import FlightAnswer
    from hoverproof.simulation.flight import save, summary, without_conditions

    save(flight, path)
    decay, uncovered, pictures = _draw(mission, flight, path.with_suffix(""), figures, again)
    if animate is not None:
        from hoverproof.show.animation import save_animation

        with progress("animation") as report:
            save_animation(flight.dataset(), animate, speed_up=speed_up, report=report)
    facts = {**summary(flight), **without_conditions(mission, flight)}
    if "seen_by" in flight.attrs:
        from hoverproof.eyes.in_the_loop import seen_well

        facts["images"] = seen_well(flight)
    return FlightAnswer(mission, named, facts, decay, path, pictures, animate, uncovered)


def _draw(
    mission: Mission,
    flight: Record,
    stem: Path,
    figures: Sequence[str] | None,
    again: Callable[[float], Record] | None,
) -> tuple[Decay | None, bool, list[Path]]:
    """Draw figures; return the decay drawn in them, whether none is where some is proved, paths.

    The beginning that is shown alongside is flown again, up to a time in s, for more samples of it.
    """
    if figures is not None and not figures:
        return None, False, []
    from hoverproof.show.figures import FIGURES, save_figures
    from hoverproof.show.panels import beginning

    which = FIGURES if figures is None else figures
    decay, uncovered = None, False
    if "features" in which:
        decay, uncovered = _certified_decay(mission, flight)
    early = beginning(flight) if again and "motion" in which else None
    first = again(early) if again and early is not None else None
    return decay, uncovered, save_figures(flight, stem, which, decay, first)


def _certified_decay(mission: Mission, flight: Record) -> tuple[Decay | None, bool]:
    """Return the decay that is proved for a flight, and whether none is though gains are proved."""
    from hoverproof.certification.gains import certify
    from hoverproof.show.decay import decay_along

    try:
        verdict = certify(mission)
    except InputError:  # the mission's bounds pose no question: nothing to draw
        return None, False
    decay = decay_along(flight, verdict)
    as_modelled = not mission.conditions().keys() - {"scatter"}
    return decay, decay is None and verdict.proved is not None and as_modelled
