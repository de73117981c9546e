"""What breaks around a command (disk, compiler, patience) ends in one line, and leaves files whole.

Each runs as a user's does, in a process of its own.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hoverproof import checker, compilers
from hoverproof.mission.reading import load
from hoverproof.simulation import compiled
from hoverproof.simulation.flight import simulate
from sampling import mostly_whole

COMMAND = [sys.executable, "-m", "hoverproof"]
needs_compiler = pytest.mark.skipif(not compilers.find_compiler(), reason="no C compiler here")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def command(*words, **options):
    return subprocess.run(
        [*COMMAND, *words], capture_output=True, text=True, check=False, timeout=300, **options
    )


# --- the disk -------------------------------------------------------------------------------------


MANY = ("--runs", "20", "--set", "scatter.position=[1,1,1]", "--out", "x4-flyer.flights.nc")


def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "name"),
    mostly_whole(
        [
            (["simulate", "x4-flyer", "--no-figures"], "x4-flyer.flight.nc"),
            (["simulate", "x4-flyer", "--no-figures", *MANY], "x4-flyer.flights.nc"),
            (["atlas", "x4-flyer", "--cells", "100"], "x4-flyer.atlas.nc"),
        ],
        every=2,
    ),
)
def test_a_full_disk_is_one_line_and_the_old_file_stays(words, name):
    Path(name).write_text("old")
    done = command(*words, preexec_fn=small_files)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith(f"hoverproof: {name}: cannot be written: ")
    assert done.stderr.count("\n") == 1
    assert Path(name).read_text() == "old"
    assert [p.name for p in Path.cwd().iterdir()] == [name]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("json_", [[], ["--json"]])
def test_output_that_cannot_be_written_is_one_line_too(json_):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, "certify", "x4-flyer", *json_], stdout=full, stderr=-1, check=False
        )
    assert done.returncode == 2
    assert done.stderr.decode().startswith("hoverproof: the output cannot be written")
    assert done.stderr.count(b"\n") == 1


# --- the compiler ---------------------------------------------------------------------------------


@pytest.fixture
def nothing_cached(tmp_path, monkeypatch):
    """Forget what is loaded, and cache into a folder of this test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    compiled._library.cache_clear()
    yield
    compiled._library.cache_clear()


def for_another_machine(folder):
    """Make a compiler that works, and makes what this machine cannot load."""
    script = folder / "other-cc"
    script.write_text(
        "#!/bin/sh\n"
        'while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done\n'
        "cat > /dev/null\n"
        '[ -z "$out" ] || printf "\\177ELF\\001 for another machine" > "$out"\n'
    )
    script.chmod(0o755)
    return str(script)


@pytest.mark.parametrize("cc", [" ", "'gcc", '"', "for another machine", "/no/such/cc", "true"])
@pytest.mark.parametrize("adds", [{}, {"wind.drag": "0.01"}], ids=["ideal", "as built"])
@pytest.mark.usefixtures("nothing_cached")
def test_a_compiler_that_is_none_leaves_the_virtual_machine(cc, adds, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", for_another_machine(tmp_path) if cc.startswith("for") else cc)
    flight = simulate(load("x4-flyer", adds), duration=0.5)
    assert flight.attrs["machine"] == "CasADi virtual machine"
    assert flight.attrs["outcome"] == "flown"


def machine(cache):
    """Return what a flight ran on, with a cache of compiled code."""
    words = ("simulate", "x4-flyer", "--no-figures", "--duration", "1", "--json")
    done = command(*words, env={**os.environ, "XDG_CACHE_HOME": str(cache)})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["machine"]


@pytest.mark.slow
@needs_compiler
def test_a_cache_from_which_nothing_loads_is_gone_around(tmp_path):
    cache = tmp_path / "cache"
    assert machine(cache) == "compiled C"
    (made,) = cache.rglob("*.so")
    made.write_bytes(b"of another machine")
    assert machine(cache) == "compiled C"


@pytest.mark.slow
@pytest.mark.skipif(
    not (hasattr(os, "geteuid") and os.geteuid() == 0 and shutil.which("mount")),
    reason="needs the right to mount a file system",
)
def test_a_cache_on_a_file_system_without_execution_is_gone_around(tmp_path):
    cache = tmp_path / "cache"
    cache.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "noexec,size=4m", "tmpfs", str(cache)], check=False
    )
    if mounted.returncode:
        pytest.skip("no file system can be mounted here")
    try:
        assert machine(cache) in ("compiled C", "CasADi virtual machine")
    finally:
        subprocess.run(["umount", str(cache)], check=True)


@pytest.mark.slow
@pytest.mark.parametrize("cc", mostly_whole(["'gcc", " ", "for another machine"], every=3))
def test_firmware_without_a_compiler_that_works_is_one_line(cc, tmp_path):
    env = {**os.environ, "CC": for_another_machine(tmp_path) if cc.startswith("for") else cc}
    done = command("simulate", "x4-flyer", "--controller", "firmware", "--duration", "1", env=env)
    assert done.returncode == 2
    assert done.stderr.startswith("hoverproof: ")
    assert done.stderr.count("\n") == 1


# --- patience -------------------------------------------------------------------------------------

LONG = [
    "simulate x4-flyer --duration 9e5 --no-figures --step 0.01 --every 80000000",
    "simulate x4-flyer --duration 9e5 --no-figures --set wind.drag=0.01 --every 80000000",
    "simulate x4-flyer --duration 9e5 --no-figures --controller firmware",
    "simulate x4-flyer --duration 9e5 --no-figures --runs 64 --every 80000000"
    " --set scatter.position=[1,1,1] --out x4-flyer.flights.nc",
    "simulate crazyflie-2.1 --no-figures --animate flight.html",
    "attraction x4-flyer --objective volume",
    "tune x4-flyer --objective decay --pareto 8",
    "tune x4-flyer --objective region",
    "atlas x4-flyer --cells 1500 --processes 2",
    "atlas x4-flyer --cells 300 --exact-boundary",
    "region x4-flyer --boxes 10000000 --box=-60,60,-60,60,-60,-0.001",
    "report x4-flyer -o report.html",
    "export x4-flyer --out firmware",
    "derive",
]
IN_STEPS = ("--runs", "--animate", "--exact-boundary", "report", "export")
"""Words of those that write one thing after another: they are interrupted later as well."""
MOMENTS = [
    *(
        case
        for number, words in enumerate(LONG)
        for case in mostly_whole([(words, 0.5), (words, 2)], every=4, first=number % 4)
    ),
    *mostly_whole(
        [(words, 5) for words in LONG if any(step in words for step in IN_STEPS)], every=4
    ),
]
"""CI interrupts every other command once, as it begins or at its work, and some of them later."""
WHOLE = {"x4-flyer.flights.nc", "crazyflie-2.1.flight.nc"}
"""Files that may be there: whole, made before the interruption, or made to be resumed."""


@pytest.mark.slow
@pytest.mark.parametrize(("words", "after"), MOMENTS)
def test_ctrl_c_ends_a_command_at_once_with_one_line_and_nothing_half_written(words, after):
    process = subprocess.Popen(
        [*COMMAND, *words.split()],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heard_again,
    )
    try:
        process.communicate(timeout=after)
        pytest.skip("was done before")
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
    begin = time.monotonic()
    out, err = process.communicate(timeout=20)
    seconds = time.monotonic() - begin
    if process.returncode in (0, 1, 3) and "interrupted" not in err:
        pytest.skip("was done before")  # in the moment before the signal: its answer stands
    assert process.returncode == 130, err
    told = [line for line in (out + err).splitlines() if "interrupted" in line]
    assert len(told) == 1
    assert "Traceback" not in err
    assert [p.name for p in Path.cwd().iterdir() if not is_whole(p)] == []
    assert seconds < 1 + patience()


def is_whole(path):
    """Tell whether a file was made before an interruption, or made to be resumed."""
    certificate = path.name.endswith((".cert.json", ".refutation.json"))
    return path.name in WHOLE or (certificate and bool(checker.check_file(path)))


def heard_again():
    """Let a command hear the signal though it is ignored here, as it is behind a shell's &."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def patience():
    """Return how much longer than at rest this machine takes at the moment, s."""
    begin = time.monotonic()
    subprocess.run([sys.executable, "-c", "import numpy"], check=True)
    return max(0.0, 3 * (time.monotonic() - begin) - 0.5)


def test_an_answer_that_is_out_keeps_its_status_if_the_user_interrupts_too_late():
    program = (
        "import os, signal, sys\n"
        "from hoverproof.cli import main\n"
        "class Late:\n"
        "    def __del__(self, signal=signal, os=os):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.modules['late'] = Late()\n"
        "main(['presets'])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "x4-flyer" in done.stdout


@pytest.mark.skipif(not hasattr(signal, "SIGINT"), reason="no such signal here")
def test_an_interruption_that_a_library_swallows_ends_the_process_all_the_same():
    program = (
        "import time\n"
        "from hoverproof.cli import console, main\n"
        "@console.app.command\n"
        "def stubborn():\n"
        "    end = time.monotonic() + 30\n"
        "    print('here', flush=True)\n"
        "    while time.monotonic() < end:\n"
        "        try:\n"
        "            time.sleep(30)\n"
        "        except BaseException:\n"
        "            pass\n"
        "main(['stubborn'])\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "here\n"
    process.send_signal(signal.SIGINT)
    begin = time.monotonic()
    _, err = process.communicate(timeout=20)
    assert time.monotonic() - begin < 5
    assert process.returncode == 130
    assert err == "hoverproof: interrupted\n"
