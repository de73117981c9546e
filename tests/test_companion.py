"""What a companion computer runs beside `fly`: sightings of a camera as lines of JSON."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hoverproof.mavlink.sight import sighting_of
from hoverproof.mission.presets import preset_text
from test_see import INFO, TAG, frames


@pytest.mark.slow
def test_the_companion_writes_sightings_of_an_image_of_a_tag(tmp_path):
    cv2 = pytest.importorskip("cv2")
    cv2.imwrite(str(tmp_path / "tag.png"), next(frames(1)))
    (tmp_path / "info.yaml").write_text(INFO, encoding="utf-8")
    text = preset_text("crazyflie-2.1").split("\n[camera]\n")
    rest = text[1][text[1].index("\n[") :]
    (tmp_path / "m.toml").write_text(f'{text[0]}\n[camera]\nfile = "info.yaml"\n{rest}', "utf-8")
    script = Path(__file__).parents[1] / "examples" / "companion" / "sightings.py"
    command = [sys.executable, script, "m.toml", TAG[1], "tag.png", "0.05"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)
    seen = sighting_of(json.loads(done.stdout), 4, 10.0, time.time())
    assert seen.in_pixels
    assert 0 < seen.at < 9.95
    assert np.ptp(seen.seen, axis=0) == pytest.approx(60, abs=6)  # 0.2 m, 0.5 m below
