"""The README's own commands run as written."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "docs"))

from forked import ran  # noqa: E402 - the pages run theirs with it

README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.S)


ELSEWHERE = ("wide.", "--objective region", "--animate")
"""Gains for a region, and films, which have tests of their own."""


@pytest.mark.slow
@pytest.mark.long
def test_the_commands_run_as_written(whole):
    """All in `make trials`; else without some that take long, and are tried by other tests."""
    scripts = [block for block in blocks("sh") if "make " not in block]
    assert len(scripts) == 3
    (Path.cwd() / "src").symlink_to(ROOT / "src")
    lines = [line.split(" #")[0].rstrip() for script in scripts for line in script.splitlines()]
    if not any(map(shutil.which, ("cc", "gcc", "clang"))):  # the firmware flies as compiled C only
        lines = [line for line in lines if "--controller firmware" not in line]
    if not whole:
        lines = [line for line in lines if not any(words in line for words in ELSEWHERE)]
    said = ""
    for line in filter(None, lines):
        status, words = ran(line, Path.cwd())
        assert status == 0, f"{line}: {words}"
        said += words
    assert "x4-flyer: proved" in said
    assert "x4-flyer: refuted" in said
    assert "fast: tuned for its start, and proved" in said


def test_each_command_says_how_long_it_took():
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    commands = [line for line in lines if line.startswith(("hoverproof ", "python "))]
    assert len(commands) > 20
    for line in commands:
        assert re.search(r"  # <?\d+ s(: |$)", line) or re.search(r" # <?\d+ s: ", line), line


@pytest.mark.slow
def test_the_python_example_runs_as_written():
    (example,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-c", example], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "positive definite" in done.stdout


def test_every_file_and_folder_that_is_named_exists():
    named = re.findall(r"`((?:src|benchmarks|docs|tests)/[\w./-]*)`", README)
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README)
    assert named
    for name in [*named, *pictures]:
        assert (ROOT / name).exists(), name


def test_the_two_commands_are_targets_of_the_makefile():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"^make (\w+)", README, flags=re.M):
        assert re.search(rf"^{target}:", makefile, flags=re.M)
