"""The command `see`, and the options of what is printed, which `simulate --pixels` shares."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from hoverproof.cli.answers.answer import print_line, tell
from hoverproof.cli.completion import mission_names
from hoverproof.cli.console import Json, Set, load_mission, progress
from hoverproof.cli.reading import default_stem, file_to_write, refuse_given, stretch
from hoverproof.errors import InputError
from hoverproof.files import require_file

if TYPE_CHECKING:
    from hoverproof.eyes.sightings import Viewer
    from hoverproof.eyes.video import Source
    from hoverproof.mission.sections import Mission
    from hoverproof.mission.tags import Board
    from hoverproof.simulation.record import Record


ENDLESS = 9e5
"""s that a camera is looked at where lines go to a flight: until that ends."""


@dataclass
class Printed:
    """What is printed on the target."""

    tag: Annotated[
        str | None,
        Parameter(help="FAMILY:ID:SIZE of one tag, its black side in m, as 36h11:0:0.2."),
    ] = None
    target: Annotated[
        str | None,
        Parameter(help="File of several tags, as `new --target` takes it: apriltag_ros, Kalibr."),
    ] = None
    target_name: Annotated[
        str | None, Parameter(help="Which bundle, or which tag, of a file that holds several.")
    ] = None
    family: Annotated[
        str | None, Parameter(help="Of the tags of --target, if it does not say: 36h11, 4x4_50.")
    ] = None

    def board(self) -> Board | None:
        """Read what was given."""
        from hoverproof.mission.tags import board_of_file, board_of_tag

        if self.tag is not None and self.target is not None:
            raise InputError("--tag", "", "does not go with --target, which tells the tags")
        if self.target is None:
            for option, given in (("--target-name", self.target_name), ("--family", self.family)):
                if given is not None:
                    raise InputError(option, "", "goes with --target")
            return None if self.tag is None else board_of_tag(self.tag)
        return board_of_file(self.target, self.target_name, self.family)


def see(
    source: Annotated[
        str, Parameter(help="Image, folder of images, video, or number of a camera, as 0.")
    ],
    *,
    camera: Annotated[
        Path | None,
        Parameter(help="camera_info of ROS: the lens; by default that of the mission."),
    ] = None,
    printed: Annotated[Printed | None, Parameter(name="*", help="What is printed.")] = None,
    mission: Annotated[
        str | None,
        Parameter(
            help="Mission whose target and law it is about.",
            completer=mission_names,
        ),
    ] = None,
    rate: Annotated[
        float | None, Parameter(help="Images a second, Hz; by default a video's own, else 30.")
    ] = None,
    duration: Annotated[
        float | None, Parameter(help="End after so many s; of a camera by default 10.")
    ] = None,
    still: Annotated[
        str | None,
        Parameter(help="FROM,TO in s: nothing moved; by default the longest such time is found."),
    ] = None,
    out: Annotated[
        Path | None,
        Parameter(help="FILE.nc or FILE.csv; by default SOURCE.seen.nc, here."),
    ] = None,
    overlay: Annotated[
        Path | None,
        Parameter(
            help="The images with what was found: FILE.png, or FILE.avi, .mkv or .mp4 of several."
        ),
    ] = None,
    stream: Annotated[
        bool,
        Parameter(negative="", help="Print a JSON line an image, for `fly --features`; no file."),
    ] = False,
    late: Annotated[
        float | None, Parameter(help="With --stream: age of an image that comes, s; by default 0.")
    ] = None,
    set_: Set = None,
    json_: Json = False,
) -> int:
    """Find the tags of a target in images, and say what the law sees.

    Lenses are taken off by the formula that flights and exported C have. For each image: the
    corners, in px; the centroid and the scaled centroid of the target; how far from the optical
    axis it is; where the camera is. With a mission also the feature and the image error of its law,
    in body axes; the vertical is then that of the tag, which is taken to lie level.

    From a stretch in which nothing moves it tells the noise: as lines for the mission.

    Needs OpenCV: pip install 'hoverproof[vision]'.

    Example: `hoverproof see flight.mp4 --camera camera_info.yaml --tag 36h11:0:0.2`

    Example: `hoverproof see 0 --camera camera_info.yaml --tag 4x4_50:7:0.1 --duration 20`

    Example: `hoverproof see frames/ --mission my-flyer.toml --overlay seen.mp4 --json`

    Example: `hoverproof see 0 --mission my-flyer.toml --stream --late 0.02`
    """
    from hoverproof.cli.answers.see import SeeAnswer
    from hoverproof.eyes.at_rest import at_rest
    from hoverproof.eyes.sightings import Sightings
    from hoverproof.eyes.video import open_source

    part = None if still is None else stretch("--still", still)
    loaded = None if mission is None else load_mission(mission, set_)
    if loaded is None and set_:
        raise InputError("--set", "", "goes with --mission")
    stem = Path(source).stem or "camera"
    if loaded is not None and mission is not None:
        stem = default_stem(loaded, mission, set_, of=stem)
    path = file_to_write(out, f"{stem}.seen.nc", ".csv")
    viewer = _viewer(loaded, camera, (printed or Printed()).board())
    if stream:
        of_files = {"--out": out, "--overlay": overlay, "--still": still, "--json": json_}
        refuse_given(of_files, "does not go with --stream, which prints lines alone")
        return _stream(viewer, open_source(source, rate, duration or ENDLESS), late or 0.0)
    refuse_given({"--late": late}, "goes with --stream")
    images = open_source(source, rate, duration)
    seen = Sightings(viewer, images)
    with progress("images") as report, _overlay(overlay, viewer, images) as shown:
        seen.look(shown, report)
    rest = at_rest(seen, part)
    record = seen.record()
    _write(path, record)
    half = None if loaded is None else loaded.camera.half_angle
    facts = seen.facts(record) | {"half_angle": None if half is None else float(half)}
    return tell(SeeAnswer(facts, rest, path, overlay), json_)


def _stream(viewer: Viewer, images: Source, late: float) -> int:
    """Print where the target is in each image, as soon as it is there."""
    import numpy as np

    if not 0 <= late < 1:
        raise InputError("--late", "", f"must be from 0 to 1 s, not {late:g}")
    for _, image in images.images:
        exposed = time.time() - late
        pixels, _ = viewer.found(image, images.name)
        seen = [] if np.isnan(pixels).any() else pixels.tolist()
        print_line({"time": exposed, "pixels": seen})
    return int(bool(images.short))


def _viewer(mission: Mission | None, camera: Path | None, given: Board | None) -> Viewer:
    """Put together what looks: the tags, the lens and the law."""
    from hoverproof.eyes.opencv import dictionary
    from hoverproof.eyes.sightings import Viewer
    from hoverproof.mission.reading import load_lens
    from hoverproof.mission.tags import board_of_mission
    from hoverproof.plant.lens import LensModel, check_cone, seeing, seeing_lens

    board = given if mission is None else board_of_mission(mission, given)
    if board is None:
        raise InputError("--tag", "", "is needed, or --target or --mission: what is to be found")
    if camera is not None:
        lens = LensModel.of_section(load_lens(camera))
        looking = seeing(lens, str(camera), "distortion_coefficients")
    else:
        own = None if mission is None else seeing_lens(mission)
        if own is None or mission is None:
            reason = "is needed: the camera_info of the lens, or a mission with [camera.lens]"
            raise InputError("--camera", "", reason)
        looking = own
        check_cone(mission)
    dictionary(board)  # known to this OpenCV
    return Viewer(board, *looking, mission)


@contextlib.contextmanager
def _overlay(path: Path | None, viewer: Viewer, source: Source) -> Iterator[Callable[..., None]]:
    """Give a function that draws an image with what was found into a file."""
    from hoverproof.eyes.overlay import drawn
    from hoverproof.eyes.video import check_video, picture_file, video

    if path is None:
        yield lambda image, pixels: None
        return
    require_file(path)
    of_one = path.suffix.lower() == ".png"
    if of_one and source.expected != 1:
        raise InputError(str(path), "", "is for a single image; of several: .avi, .mkv or .mp4")
    if not of_one:
        check_video(path)
    size = round(viewer.lens.width), round(viewer.lens.height)
    made = picture_file(path) if of_one else video(path, source.rate or 30.0, size)
    axis = viewer.lens.cx, viewer.lens.cy
    with made as add:
        yield lambda image, pixels: add(drawn(image, pixels, viewer.board, axis))


def _write(path: Path, record: Record) -> None:
    from hoverproof.files import write_bytes, write_text

    if path.suffix.lower() == ".nc":
        write_bytes(path, record.netcdf())
    else:
        write_text(path, record.csv())
