"""Images from files, videos and cameras, one after another, and videos written whole."""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.eyes.opencv import opencv
from hoverproof.files import replacing, require_file, write_bytes

Image = NDArray[np.uint8]

PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm")
CODECS = {".avi": "FFV1", ".mkv": "FFV1", ".mp4": "mp4v"}
"""Of a video that is written, by its ending: the first two lose nothing."""
LARGEST = 10**8
"""Pixels of an image, at most."""
FASTEST = 1000.0
"""Hz: a video that claims more frames has none that can be believed."""


@dataclass
class Source:
    """Images in a row, of one size.

    Attributes
    ----------
    name : str
        What was given.
    expected : int
        Number of images, as far as it is known; 0 if it is not.
    rate : float
        1/s, of a video or as it was given; 0 of a device.
    images : iterator
        Of (time in s, (height, width) uint8 grey levels).
    short : str
        Why there were fewer images than expected; empty until then.
    """

    name: str
    expected: int
    rate: float
    images: Iterator[tuple[float, Image]] = field(default_factory=lambda: iter(()))
    short: str = ""


def open_source(name: str, rate: float | None = None, duration: float | None = None) -> Source:
    """Open an image, a folder of images, a video, or a camera by its number.

    Parameters
    ----------
    name : str
        Path, or a number such as 0.
    rate : float, optional
        1/s, of the images; by default that of the video, else 30.
    duration : float, optional
        s; all of a file, and of a device 10 s, by default.

    Raises
    ------
    InputError
        If there is nothing that can be read.
    """
    if rate is not None and not 0 < rate <= FASTEST:
        raise InputError("--rate", "", f"must be above 0 and at most {FASTEST:g} Hz, not {rate:g}")
    if duration is not None and not 0 < duration < 1e6:
        raise InputError("--duration", "", f"must be above 0 s, not {duration:g}")
    path = Path(name)
    if not path.exists() and re.fullmatch(r"\d{1,3}", name):
        return _device(name, 10.0 if duration is None else duration)
    if not path.exists():
        raise InputError(name, "", "no such image, folder or video, nor the number of a camera")
    if path.is_dir():
        files = [f for f in path.iterdir() if f.suffix.lower() in PICTURES and f.is_file()]
        if not files:
            raise InputError(name, "", f"holds no images ({' '.join(PICTURES)})")
        source = _pictures(name, sorted(files, key=_natural), rate or 30.0)
    elif path.stat().st_size == 0:
        raise InputError(name, "", "is empty")
    elif path.suffix.lower() in PICTURES:
        source = _pictures(name, [path], rate or 30.0)
    else:
        source = _video(name, rate)
    if duration is not None:
        source.expected = min(source.expected, max(1, round(duration * source.rate)))
        source.images = _until(source.images, duration)
    return source


def _until(images: Iterator[tuple[float, Image]], end: float) -> Iterator[tuple[float, Image]]:
    for at, image in images:
        if at >= end:
            return
        yield at, image


def _natural(path: Path) -> list[Any]:
    parts = re.split(r"(\d+)", path.name)
    return [int(part) if part.isdigit() else part for part in parts]


def _pictures(name: str, files: list[Path], rate: float) -> Source:
    def each() -> Iterator[tuple[float, Image]]:
        for number, file in enumerate(files):
            yield number / rate, _read(file)

    return Source(name, len(files), rate, each())


def _read(path: Path) -> Image:
    """Return an image, whole: OpenCV would take the rest of a truncated one for grey."""
    from PIL import Image as Pillow

    try:
        with Pillow.open(path) as opened:
            if opened.width * opened.height > LARGEST:
                raise InputError(str(path), "", f"has more than {LARGEST:.0e} pixels")
            return np.array(opened.convert("L"))
    except (OSError, SyntaxError, ValueError, Pillow.DecompressionBombError) as error:
        if isinstance(error, InputError):
            raise
        words = " ".join(str(error).split()).replace(f" {str(path)!r}", "")[:100]
        raise InputError(str(path), "", f"is damaged, or no image: {words}") from None


def _video(name: str, rate: float | None) -> Source:
    cv2 = opencv()
    capture = cv2.VideoCapture(name)
    if not capture.isOpened():
        raise InputError(name, "", "is damaged, or no image or video that OpenCV reads")
    own = float(capture.get(cv2.CAP_PROP_FPS))
    known = own if 0 < own <= FASTEST else 30.0
    claimed = capture.get(cv2.CAP_PROP_FRAME_COUNT)
    expected = int(claimed) if 0 < claimed < 1e9 else 0
    source = Source(name, expected, rate or known)

    def each() -> Iterator[tuple[float, Image]]:
        count = 0
        try:
            while True:
                good, picture = capture.read()
                if not good:
                    break
                yield count / source.rate, _grey(picture)
                count += 1
        finally:
            capture.release()
        if count == 0:
            raise InputError(name, "", "holds no frame that can be read")
        if count < expected:
            source.short = f"ends after {count} of {expected} frames"

    source.images = each()
    return source


def _device(name: str, duration: float) -> Source:
    cv2 = opencv()
    capture = cv2.VideoCapture(int(name))
    if not capture.isOpened():
        raise InputError(name, "", "no camera of this number can be opened")
    source = Source(f"camera {name}", 0, 0.0)

    def each() -> Iterator[tuple[float, Image]]:
        begin = time.monotonic()
        try:
            while (now := time.monotonic() - begin) < duration:
                good, picture = capture.read()
                if not good:
                    source.short = f"ends after {now:.1f} of {duration:g} s: the camera has stopped"
                    return
                yield now, _grey(picture)
        finally:
            capture.release()

    source.images = each()
    return source


def _grey(picture: Image) -> Image:
    if picture.ndim == 2:
        return picture
    return np.asarray(opencv().cvtColor(picture, opencv().COLOR_BGR2GRAY))


def check_video(path: Path) -> None:
    """Refuse a video that could not be written, before the work on it begins.

    Parameters
    ----------
    path : Path
    """
    require_file(path)
    if path.suffix.lower() not in CODECS:
        raise InputError(str(path), "", f"must end in {' or '.join(CODECS)}")


@contextlib.contextmanager
def video(path: Path, rate: float, size: tuple[int, int]) -> Iterator[Callable[[Image], None]]:
    """Give a function that adds a picture to a video; the file comes when all is done.

    Parameters
    ----------
    path : Path
        Ends in one of `CODECS`. On any error the old file stays as it was.
    rate : float
        Pictures a second, 1/s.
    size : (int, int)
        Width and height, numbers of px.
    """
    check_video(path)
    cv2, ending = opencv(), path.suffix.lower()
    with replacing(path) as beside:
        named = beside.with_name(beside.name + ending)
        code = cv2.VideoWriter_fourcc(*CODECS[ending])
        try:
            writer = cv2.VideoWriter(str(named), cv2.CAP_FFMPEG, code, rate, size)
            if not writer.isOpened():
                raise InputError(str(path), "", "this OpenCV writes no such video; try another")

            def add(picture: Image) -> None:
                colour = picture if picture.ndim == 3 else cv2.cvtColor(picture, 8)
                writer.write(colour)

            try:
                yield add
            finally:
                writer.release()
            named.replace(beside)
        finally:
            named.unlink(missing_ok=True)


@contextlib.contextmanager
def picture_file(path: Path) -> Iterator[Callable[[Image], None]]:
    """Give a function that writes a picture as PNG.

    Parameters
    ----------
    path : Path
    """

    def add(picture: Image) -> None:
        _, content = opencv().imencode(".png", picture)
        write_bytes(path, content.tobytes())

    yield add
