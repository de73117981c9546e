"""The commands as a user or a program meets them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import hoverproof
from command_line import run
from hoverproof import checker
from hoverproof.mission.presets import presets

PROOF = Path(__file__).parents[1] / "proofs" / "x4-flyer.cert.json"


def test_certify_writes_a_certificate_that_check_accepts(capsys):
    status, out, _ = run(capsys, "certify", "x4-flyer")
    assert status == 0
    assert "proved" in out
    assert "x4-flyer.cert.json" in out
    status, out, _ = run(capsys, "check", "x4-flyer.cert.json")
    assert status == 0
    assert "accepted" in out


def test_certify_answers_machines_in_json(capsys):
    status, out, err = run(capsys, "certify", "x4-flyer", "--json", "--out", "c.json")
    answer = json.loads(out)
    assert (status, err) == (0, "")
    assert answer["verdict"] == "proved"
    assert 1.0e-3 < answer["margin"] < 1.8e-3
    assert answer["decay_rate"] == pytest.approx(2 * answer["margin"] / 9.6)
    assert answer["eigenvalues"] == [0.01, 5.0]
    assert answer["thrust"] == [84.672, 103.488]
    assert answer["counterexample"] is None
    assert answer["certificate"] == "c.json"
    assert checker.check_file("c.json") == answer["statement"]


def test_a_refutation_has_status_1_and_a_witness_that_check_confirms(capsys):
    options = ("--set", "gains.k4=0.1", "--json")
    status, out, _ = run(capsys, "certify", "x4-flyer", *options)
    answer = json.loads(out)
    assert status == 1
    assert answer["verdict"] == "refuted"
    assert answer["margin"] < 0
    assert set(answer["counterexample"]) == {"Q", "f", "X", "value"}
    assert re.fullmatch(r"x4-flyer\.[0-9a-f]{8}\.refutation\.json", answer["certificate"])
    status, out, _ = run(capsys, "check", answer["certificate"], "--json")
    assert status == 0
    assert json.loads(out)["accepted"] is True
    status, out, _ = run(capsys, "certify", "x4-flyer", "--set", "gains.k4=0.1")
    assert status == 1
    assert "XᵀΣX <= -" in out


def test_check_says_why_it_rejects(capsys):
    run(capsys, "certify", "x4-flyer", "--out", "c.json")
    content = json.loads(Path("c.json").read_text())
    content["claim"]["margin"] = "1"
    Path("c.json").write_text(json.dumps(content))
    status, out, _ = run(capsys, "check", "c.json", "--json")
    assert status == 1
    assert json.loads(out)["accepted"] is False
    status, out, _ = run(capsys, "check", "c.json")
    assert status == 1
    assert "rejected: the file was changed" in out


@pytest.mark.slow
def test_simulate_draws_and_answers_machines_in_json(capsys):
    status, out, _ = run(capsys, "simulate", "x4-flyer", "--duration", 20, "--json")
    answer = json.loads(out)
    assert status == 0
    assert answer["steps"] == 2000
    assert answer["final_error"] < answer["start_error"]
    assert answer["settled_at"] is None
    assert answer["seconds"] >= 0
    assert len(answer["final_position"]) == 3
    assert Path(answer["out"]).stat().st_size > 10_000
    assert len(answer["figures"]) == 3
    for picture in answer["figures"]:
        assert Path(picture).read_bytes().startswith(b"\x89PNG")
    assert 3.4e-4 < answer["certified_decay"]["rate"] < 3.5e-4
    assert answer["certified_decay"]["until"] == 20


@pytest.mark.slow
def test_simulate_draws_what_is_asked_for_and_a_film(capsys):
    some = (
        "--duration",
        20,
        "--speed-up",
        20,
        "--figures",
        "path",
        "--figures",
        "features",
        "--animate",
        "a.gif",
    )
    status, out, err = run(capsys, "simulate", "x4-flyer", *some)
    assert status == 0
    assert "certified: L ≤ L(0) exp(-0.000348 t)" in out
    assert "animation a.gif" in out
    assert sorted(p.suffixes[-2] for p in Path.cwd().glob("*.png")) == [".features", ".path"]
    assert Path("a.gif").read_bytes().startswith(b"GIF89a")
    assert err == ""


@pytest.mark.slow
def test_no_figure_claims_a_certificate_that_is_refused(capsys):
    refuted = ("--set", "gains.k4=0.1", "--duration", 5, "--figures", "features", "--json")
    assert json.loads(run(capsys, "simulate", "x4-flyer", *refuted)[1])["certified_decay"] is None
    singular = ("--set", "bounds={eigenvalues=[0.01, 5], level=1e6}", "--duration", 5, "--json")
    status, out, _ = run(capsys, "simulate", "x4-flyer", *singular)
    assert status == 0
    assert json.loads(out)["certified_decay"] is None


def test_a_flight_cut_short_has_status_1(capsys):
    wild = ("--set", "gains.k1=200", "--set", "gains.k2=300", "--duration", 50, "--no-figures")
    status, out, _ = run(capsys, "simulate", "x4-flyer", *wild)
    assert status == 1
    assert "thrust fell to the singularity at 0 s" in out


def test_new_writes_a_mission_that_certifies_and_says_what_comes_next(capsys):
    status, out, _ = run(capsys, "new", "my-flyer.toml")
    assert status == 0
    assert "hoverproof attraction my-flyer.toml" in out
    assert tomllib.loads(Path("my-flyer.toml").read_text())["name"] == "my-flyer"
    assert run(capsys, "certify", "my-flyer.toml")[0] == 0
    assert Path("my-flyer.cert.json").exists()
    status, _, err = run(capsys, "new", "my-flyer.toml")
    assert status == 2
    assert "--force" in err


def test_presets_are_listed_and_printed(capsys):
    assert json.loads(run(capsys, "presets", "--json")[1])["presets"] == presets()
    assert "x4-flyer" in run(capsys, "presets")[1]
    assert tomllib.loads(run(capsys, "presets", "x4-flyer")[1])["vehicle"]["mass"] == 9.6
    assert run(capsys, "presets", "nothing")[0] == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ["frobnicate"],
        ["certify"],
        ["certify", "x4-flyer", "--wrong"],
        ["certify", "x4-flyer", "--set", "gains.k4"],
        ["certify", "x4-flyer", "--set", "name.first=1"],
        ["certify", "x4-flyer", "--out", "no/such/folder/c.json"],
        ["certify", "x4-flyer", "--out", "."],
        ["simulate", "x4-flyer", "--duration", "long"],
        ["simulate", "x4-flyer", "--duration", "-3"],
        ["simulate", "x4-flyer", "--figures", "sketch"],
        ["simulate", "x4-flyer", "--animate", "a.avi"],
        ["simulate", "x4-flyer", "--speed-up", "3"],
        ["simulate", "x4-flyer", "--animate", "a.gif", "--speed-up", "0"],
        ["check", "nothing.json"],
        ["new", "no/such/folder/my.toml"],
    ],
)
def test_bad_usage_gives_one_line_and_status_2(arguments, capsys):
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1
    assert list(Path.cwd().iterdir()) == []


@pytest.mark.parametrize(
    "command", [[], ["certify"], ["check"], ["simulate"], ["presets"], ["new"]]
)
def test_each_command_has_help(command, capsys):
    status, out, _ = run(capsys, *command, "--help")
    assert status == 0
    assert "Usage" in out
    assert not command or "Example" in out


FIGURES = {"matplotlib", "PIL", "mpl_toolkits"}
TABLES = {"xarray", "pandas", "dask", "distributed"}
ALGEBRA = {"flint", "sympy", "mpmath"}
SEARCHES = {"cvxpy", "scipy.optimize", "scipy.stats", "scipy.integrate"}
SOLVERS = {*SEARCHES, "scipy", "clarabel"}
NUMBERS = {"numpy", "casadi", "pydantic", "platformdirs"}
OTHERS = FIGURES | TABLES | ALGEBRA | {"jinja2", "hoverproof.cli.atlas"}
WRITING = {"tempfile", "platformdirs", "difflib", "tomllib"}
LEAN = [
    ("--version", {*NUMBERS, *SOLVERS, *FIGURES, *TABLES, *ALGEBRA, *WRITING}),
    ("--help", {*NUMBERS, *SOLVERS, *FIGURES, *TABLES, *ALGEBRA, *WRITING}),
    ("presets", {*SOLVERS, *OTHERS}),
    (f"check {PROOF}", {*NUMBERS, *SOLVERS, *OTHERS, *WRITING}),
    ("certify x4-flyer", {*SOLVERS, *OTHERS, "h5py", "hoverproof.paper.equations"}),
    ("region x4-flyer --no-figure", {*SOLVERS, *OTHERS, "h5py"}),
    ("region x4-flyer", {*SOLVERS, *TABLES, *ALGEBRA, "jinja2", "h5py", "matplotlib.pyplot"}),
    ("attraction x4-flyer --no-figure", {*SEARCHES, *FIGURES, *TABLES, "flint", "jinja2", "h5py"}),
    ("simulate x4-flyer --no-figures --duration 1", {*SOLVERS, *OTHERS, "cffi"}),
    ("tune x4-flyer --objective decay", {*SOLVERS, *OTHERS - {"mpmath"}, "h5py"}),
    ("report x4-flyer", {*SEARCHES, *TABLES, "sympy", "scipy.spatial", "matplotlib.pyplot"}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("words", "needless"), LEAN, ids=[words for words, _ in LEAN])
def test_a_command_imports_what_it_needs_alone(words, needless):
    """When what it derives has been derived before, that is: by itself, if by no other test."""
    probe = (
        "import atexit, sys; from hoverproof.cli import main\n"
        "atexit.register(lambda: print(*sys.modules, file=sys.stderr))\n"
        f"main({words.split()!r})"
    )
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True)
        if not needless & set(done.stderr.split()):
            break
    assert done.returncode == 0, done.stderr
    assert not needless & set(done.stderr.split())


def test_a_command_looks_for_no_garbage_among_what_it_imports():
    probe = (
        "import atexit, gc, sys; from hoverproof.cli import main\n"
        "seen = []; gc.callbacks.append(lambda phase, info: seen.append(phase))\n"
        "atexit.register(lambda: print(len(seen), gc.get_freeze_count() > 0, file=sys.stderr))\n"
        "main(['--help'])"
    )
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True)
    assert done.stderr == "0 True\n"


def test_the_module_runs_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "hoverproof", "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == hoverproof.__version__


def test_the_verbs_are_importable():
    import hoverproof as hp

    verdict = hp.certify(hp.load("x4-flyer"))
    verdict.certificate.save("c.json")
    assert hp.check("c.json") == verdict.certificate.statement
    assert hp.simulate(hp.load("x4-flyer"), duration=1).attrs["outcome"] == "flown"
    assert set(hp.__all__) <= set(dir(hp))
    with pytest.raises(AttributeError):
        hp.nothing  # noqa: B018
