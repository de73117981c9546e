"""Films as files: MP4 through ffmpeg, GIF through Pillow, and an HTML page that needs nothing."""

from __future__ import annotations

import base64
import contextlib
import html
import io
import json
import shutil
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hoverproof.errors import InputError
from hoverproof.files import replacing, require_file

Pixels = NDArray[np.uint8]

ENDINGS = (".mp4", ".gif", ".html")
FREQUENT, CLEAR = 100, 250


def check_file(path: Path) -> None:
    """Refuse a film that could not be written here, before the work on it begins.

    Parameters
    ----------
    path : Path or str
        The file.

    Raises
    ------
    InputError
        If the ending is none of `ENDINGS`, or is ``.mp4`` and there is no ffmpeg.
    """
    require_file(path)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise InputError(str(path), "", f"must end in {' or '.join(ENDINGS)}")
    if ending == ".mp4" and find_ffmpeg() is None:
        raise InputError(
            str(path),
            "",
            "needs ffmpeg: install it (Debian: apt install ffmpeg) or `pip install "
            "hoverproof[video]`, or take .gif or .html",
        )


def find_ffmpeg() -> str | None:
    """Return the command of ffmpeg, of the system or of imageio-ffmpeg; None if there is none."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        return None


@contextlib.contextmanager
def film(
    path: Path, sample: Pixels, *, rate: int, split: float = 1.0
) -> Iterator[Callable[[Pixels], None]]:
    """Give a function that adds a picture to a film; the file comes when all is done.

    Parameters
    ----------
    path : Path
        Ends in one of `ENDINGS`. On any error the old file stays as it was.
    sample : (height, width, 4) uint8
        A picture of the same size in which all colours occur.
    rate : int
        Pictures a second, 1/s.
    split : float
        Share of the width, dimensionless, after which a narrow page puts the rest below.

    Raises
    ------
    InputError
        See `check_file`; or if the file cannot be written.
    """
    check_file(path)
    page: Any = partial(_html, split=split)
    make = {".mp4": _mp4, ".gif": _gif, ".html": page}[path.suffix.lower()]
    with replacing(path) as beside, make(path, beside, sample, rate) as add:
        yield add


@contextlib.contextmanager
def _mp4(path: Path, beside: Path, sample: Pixels, rate: int) -> Iterator[Callable[[Pixels], None]]:
    height, width, _ = sample.shape
    raw = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", "-r", str(rate)]
    made = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", "-y", str(beside)]
    ffmpeg = subprocess.Popen(
        [find_ffmpeg() or "ffmpeg", "-loglevel", "error", *raw, "-i", "-", *made],
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    pipe = ffmpeg.stdin
    assert pipe is not None

    def add(pixels: Pixels) -> None:
        pipe.write(pixels.tobytes())

    try:
        with contextlib.suppress(BrokenPipeError):  # then ffmpeg has failed, and says why
            yield add
        _, said = ffmpeg.communicate()
    finally:
        if ffmpeg.poll() is None:
            ffmpeg.kill()
            ffmpeg.communicate()
    if ffmpeg.returncode:
        words = said.decode(errors="replace").strip().splitlines()
        reason = words[-1] if words else f"status {ffmpeg.returncode}"
        raise InputError(str(path), "", f"ffmpeg failed: {reason}")


@contextlib.contextmanager
def _gif(path: Path, beside: Path, sample: Pixels, rate: int) -> Iterator[Callable[[Pixels], None]]:
    pictures: list[Image.Image] = []
    few = _few_colours(sample)
    yield lambda pixels: pictures.append(few(pixels))
    first, *others = pictures
    pause = round(1000 / rate)
    first.save(beside, format="GIF", save_all=True, append_images=others, duration=pause, loop=0)


@contextlib.contextmanager
def _html(
    path: Path, beside: Path, sample: Pixels, rate: int, split: float
) -> Iterator[Callable[[Pixels], None]]:
    height, width, _ = sample.shape
    pictures: list[str] = []
    few = _few_colours(sample)
    first = few(sample)
    unchanged = np.array(first)

    def add(pixels: Pixels) -> None:
        picture = few(pixels)
        index = np.array(picture)
        index[index == unchanged] = CLEAR
        change = Image.fromarray(index, "P")
        colours = picture.getpalette() or []
        change.putpalette(colours + [0] * (3 * 256 - len(colours)))
        pictures.append(_png(change, transparency=CLEAR))

    yield add
    page = (
        PAGE.replace("@TITLE@", html.escape(path.stem))
        .replace("@WIDTH@", str(width))
        .replace("@HEIGHT@", str(height))
        .replace("@LEFT@", f"{split:.4g}")
        .replace("@PAUSE@", str(round(1000 / rate)))
        .replace("@LAST@", str(len(pictures) - 1))
        .replace("@STILL@", _png(first))
        .replace("@CHANGES@", json.dumps(pictures))
    )
    beside.write_text(page, encoding="utf-8", newline="\n")


def _png(picture: Image.Image, transparency: int | None = None) -> str:
    """Return a picture as a data URL."""
    png = io.BytesIO()
    options = {} if transparency is None else {"transparency": transparency}
    picture.save(png, format="PNG", **options)
    return "data:image/png;base64," + base64.b64encode(png.getvalue()).decode("ascii")


def _few_colours(sample: Pixels) -> Callable[[Pixels], Image.Image]:
    """Return what turns pixels into a picture with a palette, never the index `CLEAR`.

    The palette has the most frequent colours of the sample as they are, and some that come near to
    all others in it.
    """
    flat = np.ascontiguousarray(sample[..., :3])
    colours, counts = np.unique(flat.reshape(-1, 3), axis=0, return_counts=True)
    frequent = colours[np.argsort(counts)[::-1][:FREQUENT]]
    near = Image.fromarray(flat).quantize(CLEAR - FREQUENT, method=Image.Quantize.MAXCOVERAGE)
    palette = Image.new("P", (1, 1))
    palette.putpalette([*map(int, frequent.ravel()), *(near.getpalette() or [])][: 3 * CLEAR])

    def few(pixels: Pixels) -> Image.Image:
        picture = Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
        return picture.quantize(palette=palette, dither=Image.Dither.NONE)

    return few


PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>@TITLE@</title>
<style>
body { font-family: sans-serif; margin: 1em auto; max-width: @WIDTH@px; padding: 0 1em; }
div { overflow: hidden; }
div + div { display: none; }
canvas { --wide: 100%; width: var(--wide); height: auto; display: block; }
@media (max-width: 44rem) {
  canvas { --wide: calc(100% / @LEFT@); max-width: none; }
  div + div { display: block; }
  div + div canvas { --wide: calc(100% / (1 - @LEFT@)); margin-left: calc(-@LEFT@ * var(--wide)); }
}
form { display: flex; gap: 1em; align-items: center; }
input { flex: 1; }
button { min-width: 5em; padding: 0.4em; }
</style>
</head>
<body>
<div><canvas width="@WIDTH@" height="@HEIGHT@" role="img"
 aria-label="The flight over its target"></canvas></div>
<div><canvas width="@WIDTH@" height="@HEIGHT@" role="img"
 aria-label="What the camera sees"></canvas></div>
<form>
<button type="button" id="play">Pause</button>
<input type="range" id="place" min="0" max="@LAST@" value="0" aria-label="picture">
</form>
<script>
"use strict";
const picture = (data) => Object.assign(new Image(), { src: data });
const still = picture("@STILL@");
const changes = @CHANGES@.map(picture);
const play = document.getElementById("play");
const place = document.getElementById("place");
let timer = null;
function show(i) {
  place.value = i;
  Promise.all([still, changes[i]].map((each) => each.decode())).then(() => {
    if (+place.value !== i) return;  // another one is wanted by now
    for (const canvas of document.querySelectorAll("canvas")) {
      const pen = canvas.getContext("2d");  // in pixels of the film: a change that is scaled by
      pen.drawImage(still, 0, 0);  // itself would let what it covers shine through
      pen.drawImage(changes[i], 0, 0);
    }
  });
}
function run(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => show((+place.value + 1) % changes.length), @PAUSE@) : null;
  play.textContent = on ? "Pause" : "Play";
}
play.addEventListener("click", () => run(timer === null));
place.addEventListener("input", () => { run(false); show(+place.value); });
show(0);
run(true);
</script>
</body>
</html>
"""
