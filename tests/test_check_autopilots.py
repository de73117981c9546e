"""The check of packages inside autopilots' trees, with a stand-in of a tree."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

from firmware_kit import export, tool

ROOT = Path(__file__).parents[1]
STUBS = ROOT / "tests" / "stubs" / "ardupilot"
pytestmark = pytest.mark.slow


def check(*arguments):
    command = [sys.executable, ROOT / "tools" / "check-autopilots", *arguments]
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)


def tree(folder, *flags):
    """Make a tree of ArduPilot that has been configured: stand-ins, and how it compiles a file."""
    file = "libraries/AC_CustomControl/AC_CustomControl_PID.cpp"
    words = ["g++", "-std=gnu++11", f"-I{STUBS}", *flags, "-c", file, "-o", "made.o"]
    build = folder / "build" / "sitl"
    build.mkdir(parents=True)
    listed = [{"directory": str(folder), "file": file, "arguments": words}]
    (build / "compile_commands.json").write_text(json.dumps(listed))
    return folder


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_package_is_compiled_by_the_flags_of_a_tree_and_its_selftest_run(precision, tmp_path):
    tool("g++")
    package = export(tmp_path / "fw", precision=precision)
    done = check(package.folder, "--ardupilot", tree(tmp_path / "tree", "-O2", "-Wall", "-Werror"))
    assert done.returncode == 0, done.stdout
    assert f"{package.name} {precision}: compiled; self-test passes here (-O2)" in done.stdout


def test_what_does_not_compile_and_a_selftest_that_fails_are_told(tmp_path):
    tool("g++")
    package = export(tmp_path / "fw")
    other = tree(tmp_path / "tree", "-DAC_CustomControl_Backend=AnotherBackend", "-fno-such-flag")
    done = check(package.folder, "--ardupilot", other)
    assert done.returncode == 1
    assert "FAILED: g++" in done.stdout
    assert "no-such-flag" in done.stdout
    source = package.sources[1]
    source.write_text(source.read_text().replace("  return failed;", "  return failed + 1U;"))
    done = check(package.folder, "--ardupilot", tree(tmp_path / "good"))
    assert done.returncode == 1
    assert "FAILED: " in done.stdout


def test_a_tree_that_is_not_configured_and_no_tree_are_said_to_be(tmp_path):
    package = export(tmp_path / "fw")
    done = check(package.folder, "--ardupilot", tmp_path)
    assert done.returncode == 1
    assert "./waf configure" in done.stdout
    for wrong in ((package.folder,), (tmp_path, "--ardupilot", tmp_path)):
        done = check(*wrong)
        assert done.returncode == 2
        assert "Traceback" not in done.stderr


TYPES = """
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
typedef enum { controlModeLegacy = 0, controlModeForceTorque = 1 } control_mode_t;
typedef struct { float thrustSi, torqueX, torqueY, torqueZ; control_mode_t controlMode; } control_t;
typedef struct { int32_t list[4]; } motors_thrust_uncapped_t;
typedef struct { uint16_t list[4]; } motors_thrust_pwm_t;
#define THRUST_MAX 0.15f
"""
"""What a mixer of the Crazyflie has to do with, in brief."""

MIXER = """
#include "power_distribution.h"
void powerDistribution(const control_t *c, motors_thrust_uncapped_t *out)
{
  static const int side[4] = { -1, -1, 1, 1 }, front[4] = { 1, -1, -1, 1 };
  static const int turn[4] = { -1, 1, -1, 1 };
  int i;
  for (i = 0; (i < 4) && (c->controlMode == controlModeForceTorque); i++) {
    const float roll = ROLL * side[i] * c->torqueX, pitch = -front[i] * c->torqueY;
    const float force = (c->thrustSi + (roll + pitch) / ARM + turn[i] * c->torqueZ / DRAG) / 4.0f;
    out->list[i] = (force < 0.0f) ? 0 : (int32_t)(force / THRUST_MAX * 65535.0f);
  }
}
bool powerDistributionCap(const motors_thrust_uncapped_t *in, motors_thrust_pwm_t *out)
{
  int i;
  for (i = 0; i < 4; i++) out->list[i] = (in->list[i] > 65535) ? 65535 : (uint16_t)in->list[i];
  return false;
}
"""


def crazyflie_tree(folder, package, roll):
    """Make a tree with a mixer of its own, right if `roll` is 1."""
    place = folder / "src" / "modules" / "src"
    place.mkdir(parents=True)
    vehicle = package.manifest["mission"]["vehicle"]
    arm, drag = (f"(({vehicle[k]}.0f))".replace("/", ".0f/") for k in ("arm", "drag_ratio"))
    macros = f"#define ROLL {roll}\n#define ARM {arm}\n#define DRAG {drag}\n"
    (place / "power_distribution.h").write_text("#pragma once\n" + TYPES + macros)
    (place / "power_distribution_quadrotor.c").write_text(MIXER)
    return folder


def test_a_package_flies_by_the_mixer_of_a_tree_if_that_is_right(tmp_path):
    tool("cc")
    script = str(ROOT / "tools" / "check-autopilots")
    loader = importlib.machinery.SourceFileLoader("check_autopilots", script)
    checks = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(checks)
    package = export(tmp_path / "fw", "crazyflie-2.1", allow_uncertified=True)
    right, wrong = (crazyflie_tree(tmp_path / str(r), package, r) for r in (1, -1))
    said = checks.by_mixer(package.folder, package.name, right, tmp_path)
    assert "with 85 to 115 % of thrust" in said
    with pytest.raises(checks.Failure):
        checks.by_mixer(package.folder, package.name, wrong, tmp_path)
