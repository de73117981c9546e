"""A flight as a film: files that play, and pictures that tell the truth about time and size."""

from __future__ import annotations

import base64
import io
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hoverproof.errors import InputError
from hoverproof.show import movie
from hoverproof.show.animation import (
    HOLD,
    LENGTH,
    RATE,
    Stage,
    natural_speed_up,
    save_animation,
)
from hoverproof.simulation.flight import simulate


@pytest.fixture(scope="module")
def flight(x4):
    return simulate(x4, duration=40)


def opened(coded):
    """Return a picture of a page."""
    return Image.open(io.BytesIO(base64.b64decode(coded))).convert("RGBA")


DATA = "data:image/png;base64,([A-Za-z0-9+/=]+)"
PICTURES = 1 + 20 + round(HOLD * RATE)  # of 40 s at 40 times real time


@pytest.mark.slow
def test_a_gif_has_every_picture_and_its_pace(flight):
    said = []
    save_animation(
        flight, Path("a.gif"), speed_up=40, report=lambda *progress: said.append(progress)
    )
    assert said == [(k + 1, PICTURES) for k in range(PICTURES)]
    with Image.open("a.gif") as film:
        length, pictures = 0, []
        for k in range(film.n_frames):
            film.seek(k)
            length += film.info["duration"]
            pictures.append(np.array(film.convert("RGB"), int))
        assert film.info["loop"] == 0
    assert length == PICTURES * 1000 / RATE
    assert np.abs(pictures[0] - pictures[-1]).max() > 100
    assert Path("a.gif").stat().st_size < 2_000_000


@pytest.mark.slow
def test_an_html_page_needs_no_other_file_and_shows_what_was_drawn(flight):
    save_animation(flight, Path("a.html"), speed_up=40)
    page = Path("a.html").read_text(encoding="utf-8")
    assert not re.search(r"https?:|src=\"(?!data:)|href|@[A-Z]+@", page)
    still, *changes = map(opened, re.findall(DATA, page))
    assert len(changes) == PICTURES
    assert "<img" not in page  # laid over each other and scaled, they let the first shine through
    stage = Stage(flight, 40)
    for k, time in ((0, 0), (10, 20), (PICTURES - 1, 40)):
        picture = Image.alpha_composite(still, changes[k])
        wanted = stage.pixels(time)[..., :3].astype(int)
        off = np.abs(np.array(picture)[..., :3] - wanted).max(axis=-1)
        assert np.quantile(off, 0.995) <= 12
        assert off.max() < 100


@pytest.mark.slow
def test_a_page_of_any_width_shows_each_picture_and_nothing_of_another(flight, browser):
    save_animation(flight, Path("a.html"), speed_up=40)
    still, *changes = map(opened, re.findall(DATA, Path("a.html").read_text(encoding="utf-8")))
    page = browser.new_page(viewport={"width": 500, "height": 900})
    page.goto(Path("a.html").resolve().as_uri())
    page.click("#play")
    for k in (0, 12):
        page.evaluate("k => show(k)", k)
        page.evaluate("Promise.all([still, ...changes].map((each) => each.decode()))")
        for canvas in page.query_selector_all("canvas"):
            assert canvas.is_visible()
            (shown,) = map(opened, re.findall(DATA, canvas.evaluate("c => c.toDataURL()")))
            wanted = Image.alpha_composite(still, changes[k])
            assert np.abs(np.array(shown, int) - np.array(wanted, int)).max() <= 1
    page.close()


@pytest.mark.skipif(not movie.find_ffmpeg(), reason="no ffmpeg here")
def test_an_mp4_plays_for_as_long_as_it_should(flight):
    save_animation(flight, Path("a.mp4"), speed_up=40)
    command = [movie.find_ffmpeg(), "-i", "a.mp4", "-f", "null", "-"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    assert re.findall(r"frame=\s*(\d+)", said)[-1] == str(PICTURES)
    assert "yuv420p" in said
    assert "960x540" in said


def test_without_ffmpeg_an_mp4_is_refused_with_what_to_do(flight, monkeypatch):
    monkeypatch.setattr(movie, "find_ffmpeg", lambda: None)
    with pytest.raises(InputError, match=r"needs ffmpeg: install it .*or take \.gif or \.html"):
        save_animation(flight, Path("a.mp4"))


def test_what_ffmpeg_says_is_passed_on_and_the_old_file_stays(flight, monkeypatch):
    broken = Path("ffmpeg")
    broken.write_text(f"#!{sys.executable}\nimport sys\nsys.exit('no such encoder')\n")
    broken.chmod(0o755)
    Path("a.mp4").write_text("old")
    monkeypatch.setattr(movie, "find_ffmpeg", lambda: str(broken.resolve()))
    with pytest.raises(InputError, match=r"a\.mp4: ffmpeg failed: no such encoder"):
        save_animation(flight, Path("a.mp4"))
    assert Path("a.mp4").read_text() == "old"
    assert sorted(p.name for p in Path.cwd().iterdir()) == ["a.mp4", "ffmpeg"]


@pytest.mark.slow
def test_an_interrupted_film_leaves_the_old_file(flight):
    def interrupt(done, _):
        if done == 5:
            raise KeyboardInterrupt

    for name in ("a.gif", "a.html", *(["a.mp4"] if movie.find_ffmpeg() else [])):
        Path(name).write_text("old")
        with pytest.raises(KeyboardInterrupt):
            save_animation(flight, Path(name), report=interrupt)
        assert Path(name).read_text() == "old"
    assert not list(Path.cwd().glob(".*"))


@pytest.mark.parametrize(
    ("path", "speed_up", "message"),
    [
        ("a.avi", None, r"a.avi: must end in .mp4 or .gif or .html"),
        ("a", None, "must end in"),
        ("no/such/folder/a.gif", None, "cannot be written"),
        ("a.gif", 0, "speed_up: must be a positive number"),
        ("a.gif", float("nan"), "speed_up: must be a positive number"),
        ("a.gif", 0.1, "speed_up: must be at least 1 for a flight of 40 s"),
    ],
)
def test_impossible_films_are_refused(flight, path, speed_up, message):
    with pytest.raises(InputError, match=message):
        save_animation(flight, Path(path), speed_up=speed_up)
    assert not list(Path.cwd().iterdir())


@pytest.mark.parametrize("duration", [0.01, 0.5, 3, 40, 1500, 86400])
def test_a_film_lasts_about_twelve_seconds(duration):
    assert 0.75 * LENGTH <= duration / natural_speed_up(duration) <= 1.3 * LENGTH


def test_time_pace_and_size_of_the_vehicle_are_stated(flight):
    stage = Stage(flight, 40)
    stage.show(12.34)
    assert stage.clock.get_text() == "x4-flyer\nt = 12.3 s   40 × real time"
    said = stage.figure.axes[0].get_legend().get_title().get_text()
    assert said == f"vehicle drawn {stage.size:g} × its size"
    span = np.ptp(np.array([disc.get_data_3d() for disc in stage.discs]), axis=(0, 2))
    assert span[0] == pytest.approx(2 * 0.25 * stage.size * 1.6, rel=0.01)


def test_a_page_is_split_between_what_is_in_space_and_what_the_camera_sees(flight):
    stage = Stage(flight, 40)
    space, plane = stage.figure.axes
    at = stage.split * stage.figure.bbox.width
    assert max(stage.clock.get_window_extent().x1, space.zaxis.get_tightbbox().x1) < at
    assert at < plane.get_tightbbox().x0


def test_the_vehicle_is_where_the_flight_has_it_and_tilted_as_it_is(flight):
    stage = Stage(flight, 40)
    stage.show(20)
    k = int(np.searchsorted(flight["time"], 20))
    arms = [np.array(arm.get_data_3d()) for arm in stage.arms]
    for arm in arms:
        assert np.allclose(arm[:, 0], flight["position"].values[k])
    normal = np.cross(arms[0][:, 1] - arms[0][:, 0], arms[1][:, 1] - arms[1][:, 0])
    down = flight["rotation"].values[k][:, 2]
    assert abs(normal @ down) / np.linalg.norm(normal) == pytest.approx(1)
    for i, dot in enumerate(stage.dots):
        assert np.allclose(np.ravel(dot.get_data()), flight["image"].values[k, i])
