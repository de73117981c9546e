"""Past one machine: a real scheduler and real workers on loopback, one of them killed."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import run
from hoverproof.cli import main
from hoverproof.design.atlas import atlas, axis
from hoverproof.errors import InputError
from hoverproof.mission.reading import load
from hoverproof.simulation import plan
from hoverproof.simulation.runs import runs_summary, simulate_batch
from hoverproof.spread import spread

pytest.importorskip("distributed")

MISSION = {
    "scatter.position": "[1, 1, 0.5]",
    "sensors": "{frame_rate = 30, focal_length = 400, pixel_noise = 1}",
}


def start(*arguments):
    """Start a Dask process and return it with the address it prints."""
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments], stderr=subprocess.PIPE, text=True
    )
    for line in process.stderr:
        found = re.search(r"(?:Scheduler at|Start worker at): +(tcp://\S+)", line)
        if found:
            return process, found[1]
    raise AssertionError("no address was printed")


@pytest.fixture
def cluster():
    here = ("--host", "127.0.0.1")
    processes = []
    try:
        scheduler, address = start(
            "distributed.cli.dask_scheduler", *here, "--port", "0", "--no-dashboard"
        )
        processes.append(scheduler)
        for _ in range(2):
            options = ("--nthreads", "1", "--no-dashboard", "--no-nanny")
            worker, _ = start("distributed.cli.dask_worker", address, *here, *options)
            processes.append(worker)
        yield address, processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.communicate()


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_gives_the_same_bytes(cluster, monkeypatch):
    address, workers = cluster
    monkeypatch.setattr(plan, "STEPS_IN_A_BLOCK", 20_000 * 16)
    mission = load("x4-flyer", MISSION)
    options = {"runs": 400, "seed": 5, "duration": 200, "every": 2000}

    def kill_one(complete, _):
        if complete >= 100 and workers[0].poll() is None:
            workers[0].kill()

    flown = simulate_batch(mission, "far.nc", scheduler=address, progress=kill_one, **options)
    assert workers[0].poll() is not None
    assert flown.runs_complete == 400
    assert runs_summary("far.nc")["outcomes"]["flown"] == 400
    simulate_batch(mission, "here.nc", **options)
    assert Path("far.nc").read_bytes() == Path("here.nc").read_bytes()


def test_the_command_for_an_atlas_reaches_a_cluster_and_it_is_the_one_drawn_here(
    cluster, monkeypatch, capsys
):
    address, workers = cluster
    options = ("--x", "k3", "--y", "k4", "--cells", "12", "--scheduler", address, "--json")
    with pytest.raises(SystemExit) as done:
        main(["atlas", "x4-flyer", *options])
    assert done.value.code == 0
    assert json.loads(capsys.readouterr().out)["cells"] == 144
    monkeypatch.setattr("hoverproof.design.atlas.CHUNK", 80)
    mission = load("x4-flyer")
    x, y = axis(mission, "k3", cells=12), axis(mission, "k4", cells=12)
    seen = []

    def lose_one(done, total):
        seen.append((done, total))
        workers[0].kill()

    far = atlas(mission, x, y, exact=True, scheduler=address, report=lose_one)
    assert workers[0].poll() is not None
    assert seen[:2] == [(1, 2), (2, 2)]
    assert far.identical(atlas(mission, x, y, exact=True, processes=1))


def test_processes_and_a_scheduler_exclude_each_other(capsys):
    status, _, err = run(
        capsys, "atlas", "x4-flyer", "--processes", "2", "--scheduler", "tcp://127.0.0.1:1"
    )
    assert status == 2
    assert "does not go with --scheduler" in err


def test_without_a_scheduler_there_is_one_clear_message(monkeypatch):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    monkeypatch.setattr("hoverproof.spread.CONNECT_SECONDS", 1)
    for address in (f"tcp://127.0.0.1:{port}", "nonsense://x"):
        with pytest.raises(InputError, match="scheduler: no Dask scheduler answers at"):
            list(spread(abs, [1], scheduler=address))
