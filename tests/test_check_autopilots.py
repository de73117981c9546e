"""The check of packages inside autopilots' trees, with a stand-in of a tree."""

from __future__ import annotations

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
