"""What differs on Windows and macOS, as far as it can be tried here."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from hoverproof import compilers
from hoverproof.simulation.flight import simulate

SOURCES = sorted((Path(__file__).parents[1] / "src").rglob("*.py"))
PICKY = """#!/bin/sh
for word in "$@"; do
  if [ "$word" = -march=native ]; then echo "unsupported option" >&2; exit 1; fi
done
exec cc "$@"
"""


@pytest.mark.skipif(not compilers.find_compiler(), reason="no C compiler here")
def test_a_compiler_in_a_folder_with_blanks_that_knows_no_native_processor(x4, tmp_path):
    picky = tmp_path / "Program Files" / "cc"
    picky.parent.mkdir()
    picky.write_text(PICKY)
    picky.chmod(0o755)
    flight = simulate(x4, duration=5, compiler=str(picky))
    assert flight.attrs["machine"] == "compiled C"
    for name, values in simulate(x4, duration=5).items():
        assert np.array_equal(flight[name].values, values.values), name


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("gcc", ["gcc"]),
        (r"C:\mingw64\bin\gcc.exe -m64", [r"C:\mingw64\bin\gcc.exe", "-m64"]),
        (
            r'"C:\Program Files\LLVM\bin\clang.exe" -v',
            [r"C:\Program Files\LLVM\bin\clang.exe", "-v"],
        ),
        ('"C:\\no end', []),
    ],
)
def test_on_windows_a_backslash_is_part_of_a_path(command, words, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(compilers.os, "name", "nt")
        found = compilers.command_words(command)
    assert found == words


def test_text_has_the_same_bytes_on_every_system():
    calls = [
        (path, node)
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "write_text"
    ]
    assert calls
    for path, call in calls:
        words = {word.arg: word.value for word in call.keywords}
        assert ast.unparse(words["newline"]) == r"'\n'", f"{path}:{call.lineno}"


def test_no_module_needs_a_unix_to_be_imported():
    only_there = {"fcntl", "termios", "resource", "pty", "pwd", "grp", "readline"}
    for path in SOURCES:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module] if isinstance(node, ast.ImportFrom) else []
            assert not only_there & set(names), path
