"""Graphs kept on disk: the same to the last instruction, and never in the way."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from hoverproof.algebra import derived
from hoverproof.algebra.derived import kept_graph, kept_json
from hoverproof.algebra.graph import fingerprint
from hoverproof.certification import gains, problem
from hoverproof.servo import linearised, loop
from hoverproof.servo.feature import Feature
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.simulation import compiled, record, step, timing

GRAPHS = [
    (step.step_function, (3,)),
    (step.step_function, (3, HAMEL_MAHONY)),
    (loop.readout_function, (3,)),
    (loop._controller, (HAMEL_MAHONY,)),
    (linearised._loop_at_goal, (HAMEL_MAHONY,)),
    (problem.sigma_function, (HAMEL_MAHONY,)),
    (timing._linearised, (3, HAMEL_MAHONY)),
]
WORDS = [
    (compiled.c_source, (3,)),
    (record.model_fingerprint, (3,)),
    (gains.model_fingerprint, (HAMEL_MAHONY,)),
]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "hoverproof"


def anew(kept, *args):
    """Return what another process finds."""
    kept.cache_clear()
    return kept(*args)


@pytest.fixture
def count():
    """A kept function of a word, and how often it was computed."""
    calls = []

    @kept_json
    def twice(word):
        calls.append(word)
        return [word, word]

    return twice, calls


@pytest.mark.parametrize(("kept", "args"), GRAPHS, ids=lambda p: getattr(p, "__name__", ""))
def test_a_graph_that_was_kept_is_the_graph_that_was_derived(kept, args):
    made, found, own = anew(kept, *args), anew(kept, *args), kept.__wrapped__(*args)
    assert fingerprint(made) == fingerprint(found) == fingerprint(own)
    assert compiled.generate([found]) == compiled.generate([own])
    for names in ("name_in", "name_out"):
        assert getattr(found, names)() == getattr(own, names)()


@pytest.mark.parametrize(("kept", "args"), WORDS, ids=lambda p: getattr(p, "__name__", ""))
def test_words_that_were_kept_are_those_that_were_derived(kept, args):
    assert anew(kept, *args) == anew(kept, *args) == kept.__wrapped__(*args)


def test_a_thing_is_derived_once_for_each_argument(count):
    twice, calls = count
    for word in ("a", "b", "a"):
        assert anew(twice, word) == [word, word]
    assert calls == ["a", "b"]


@pytest.mark.parametrize("damage", [b"", b"\xff\xfe", b"0\n[]", "cut", "changed", "folder"])
def test_a_damaged_file_is_ignored_and_made_good(count, folder, damage):
    twice, calls = count
    twice("a")
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    if damage == "folder":
        path.unlink()
        path.mkdir()
    else:
        other = {"cut": whole[:-3], "changed": whole.replace(b"a", b"e", 1)}
        path.write_bytes(other.get(damage, damage))
    assert anew(twice, "a") == ["a", "a"] and calls == ["a", "a"]
    assert damage == "folder" or path.read_bytes() == whole


@pytest.mark.parametrize("place", ["a/file/in/between", "/proc/nothing"])
def test_where_nothing_can_be_written_it_is_derived(count, tmp_path, monkeypatch, place):
    (tmp_path / "a").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / place))
    twice, calls = count
    assert anew(twice, "a") == anew(twice, "a") == ["a", "a"]
    assert calls == ["a", "a"]


def test_what_is_no_number_and_no_word_is_never_mistaken_for_another(folder):
    class Law:
        def __repr__(self):
            return "law"

    @kept_json
    def name(law):
        return law.name

    one, other = Law(), Law()
    one.name, other.name = "one", "other"
    assert [name(one), name(other)] == ["one", "other"] and not folder.exists()


def test_with_other_sources_or_another_casadi_it_is_derived_anew(count, monkeypatch):
    twice, calls = count
    for sources, version in [("one", "3"), ("one", "3"), ("two", "3"), ("two", "4"), ("one", "3")]:
        monkeypatch.setattr(derived, "_sources", lambda module, sources=sources: sources)
        monkeypatch.setattr(derived.ca.CasadiMeta, "version", lambda version=version: version)
        assert anew(twice, "a") == ["a", "a"]
    assert calls == ["a"] * 3


def test_every_file_that_a_graph_is_derived_from_counts(tmp_path, monkeypatch):
    seen = []
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: seen.append(path) or read(path))
    derived._content.cache_clear()
    derived._sources.__wrapped__("hoverproof.simulation.compiled")
    parts = {path.relative_to(derived.HOUSE).as_posix() for path in seen}
    assert {"simulation/loop.c", "servo/controller.py", "plant/camera.py"} <= parts
    assert "algebra/reciprocals.py" in parts and "checker.py" not in parts


def test_what_is_derived_of_a_law_that_is_not_of_the_house_is_not_kept(folder):
    other = replace(HAMEL_MAHONY, feature=Feature("other", HAMEL_MAHONY.feature.of))
    assert anew(linearised._loop_at_goal, other)
    assert not folder.exists()


@pytest.mark.slow
def test_processes_at_the_same_time_do_not_disturb_each_other(folder):
    code = (
        "from hoverproof.simulation.step import step_function\n"
        "from hoverproof.algebra.graph import fingerprint\n"
        "print(fingerprint(step_function(2)))"
    )

    def run(_):
        return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)

    with ThreadPoolExecutor() as pool:
        done = list(pool.map(run, range(3)))
    told = {process.stdout.strip() for process in done}
    assert told == {fingerprint(step.step_function.__wrapped__(2))}
    assert all(path.suffix == ".derived" for path in folder.iterdir())


def test_a_graph_of_the_checked_kind_is_kept_under_its_own_name(folder):
    @kept_graph
    def square():
        x = derived.ca.SX.sym("x")
        return derived.ca.Function("square", [x], [x * x])

    assert float(anew(square)(3)) == float(anew(square)(3)) == 9
    assert [path.name.split("-")[0] for path in folder.iterdir()] == ["square"]
