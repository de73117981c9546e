"""The tool that flies PX4's own simulation, as far as it goes without PX4."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pymavlink")
SCRIPT = Path(__file__).parents[1] / "tools" / "fly-px4"


@pytest.fixture(scope="module")
def tool():
    loader = importlib.machinery.SourceFileLoader("fly_px4", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


@pytest.mark.slow
def test_a_folder_without_px4_is_said_to_be_none(tmp_path):
    command = [sys.executable, str(SCRIPT), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert f"{tmp_path} holds no bin/px4: give the folder of a build" in done.stderr
    assert "Traceback" not in done.stderr


def test_from_when_on_a_flight_was_near_its_goal_is_told(tool):
    times = np.arange(0, 20, 0.1)
    off = np.where(times < 3, 0.4, 0.07)
    text = tool.told(list(zip(7 + times, off, strict=True)))
    assert text.splitlines() == [
        "began 0.40 m from the goal; the law flew 19.9 s",
        "within 10 cm: from 2.9 s on",
        "within 5 cm: not",
        "last 5 s: 7.0 cm off at most",
    ]


def test_the_parameters_that_it_sets_are_those_of_the_guide(tool):
    guide = (SCRIPT.parents[1] / "docs" / "how-to" / "fly-over-mavlink.md").read_text()
    for name in ("COM_OF_LOSS_T", "COM_OBL_RC_ACT"):
        assert f"`{name}` {tool.SETTINGS[name]}" in guide
