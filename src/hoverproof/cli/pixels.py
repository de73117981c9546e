"""The options of `simulate --pixels`, and the flight that sees by images."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from hoverproof.cli.console import progress
from hoverproof.cli.reading import refuse_given
from hoverproof.cli.see import Printed
from hoverproof.errors import InputError

if TYPE_CHECKING:
    from hoverproof.mission.sections import Mission
    from hoverproof.simulation.record import Record
    from hoverproof.simulation.timing import Timing


@dataclass
class ByImages(Printed):
    """What a flight sees by; None is left to its default."""

    pixels: Annotated[
        bool,
        Parameter(
            negative="",
            help="See through rendered images in which the tag is detected (extra vision): the "
            "mission has a lens; its frame rate and latency count, its pixel noise does not.",
        ),
    ] = False
    exposure: Annotated[float | None, Parameter(help="Exposure time, s; by default 0.004.")] = None
    grey_noise: Annotated[
        float | None, Parameter(help="Deviation of a pixel, grey levels of 255; by default 2.")
    ] = None
    light: Annotated[
        float | None, Parameter(help="Light, as a share of a well lit image: 0.1; by default 1.")
    ] = None
    jitter: Annotated[
        float | None, Parameter(help="Images are late by up to about 3 times this more, s.")
    ] = None
    film: Annotated[
        Path | None,
        Parameter(help="Write the images: FILE.avi or .mkv, lossless, or .mp4."),
    ] = None

    def refuse(self, reason: str = "is for --pixels") -> None:
        """Refuse what was given where there are no images."""
        given = {f"--{name.replace('_', '-')}": value for name, value in vars(self).items()}
        refuse_given(given, reason)

    def check(self) -> None:
        """Refuse numbers that no image is taken with."""
        seconds, levels = (1.0, " s"), (255.0, " grey levels")
        most = {"exposure": seconds, "grey_noise": levels, "light": (1.15, ""), "jitter": seconds}
        for name, (highest, unit) in most.items():
            value = getattr(self, name)
            if value is not None and not 0 <= value <= highest:
                option = f"--{name.replace('_', '-')}"
                raise InputError(option, "", f"must be from 0 to {highest:g}{unit}, not {value:g}")

    def fly(self, mission: Mission, seed: int, timing: Timing, *, firmware: bool) -> Record:
        """Fly a mission on images."""
        from hoverproof.eyes.in_the_loop import Pixels, flown_on_pixels
        from hoverproof.eyes.renderer import Shot

        self.check()
        named = {name: getattr(self, name) for name in ("exposure", "grey_noise", "light")}
        shot = Shot(**{name: value for name, value in named.items() if value is not None})
        own: dict[str, Any] = {"jitter": self.jitter or 0.0, "seed": seed}
        pixels = Pixels.of(mission, self.board(), shot, **own)
        with _film(self.film, mission, pixels.renderer.size) as keep, progress("images") as bar:
            total = pixels.frames(mission, timing)
            count = iter(range(1, 10**9))

            def each(image: Any) -> None:
                keep(image)
                bar(next(count), total)

            return flown_on_pixels(mission, timing, pixels, seed=seed, firmware=firmware, keep=each)


@contextlib.contextmanager
def _film(
    path: Path | None, mission: Mission, size: tuple[int, int]
) -> Iterator[Callable[[Any], None]]:
    from hoverproof.eyes.video import video

    if path is None:
        yield lambda image: None
        return
    rate = mission.sensors.frame_rate
    if rate is None:
        raise InputError("--film", "", "needs sensors.frame_rate, Hz, in the mission")
    with video(path, float(rate), size) as add:
        yield add
