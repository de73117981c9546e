"""Time whole commands as a user waits for them: a new process each, from its start to its end.

Run ``python benchmarks/commands.py``; ``--write`` puts the table into the README beside it.
"""

from __future__ import annotations

import compileall
import os
import resource
import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import hoverproof
from tables import report

ROUNDS = 3
ENOUGH = 10.0
"""A command that has run for so long, in s, is not run again."""

PEER = ("-c", "import casadi, numpy")
COMMANDS = (
    "--help",
    "certify x4-flyer",
    "region x4-flyer",
    "region x4-flyer --no-figure",
    "simulate x4-flyer --no-figures",
    "simulate x4-flyer",
    "tune x4-flyer --objective decay --bandwidth 20",
    "attraction x4-flyer",
    "report x4-flyer",
)


@dataclass(frozen=True)
class Run:
    """What a process took, in s: by the clock, and of processors."""

    wall: float
    cpu: float


def processors() -> float:
    """Return the processor seconds of all finished children."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(words: tuple[str, ...], folder: Path, cache: Path) -> Run:
    """Run Python in a folder, with a cache of its own, and its bytecode written as usual."""
    env = {**os.environ, "XDG_CACHE_HOME": str(cache)}
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    cpu, begin = processors(), time.perf_counter()
    done = subprocess.run([sys.executable, *words], cwd=folder, env=env, capture_output=True)
    wall = time.perf_counter() - begin
    if done.returncode:
        raise SystemExit(f"{shlex.join(words)}: {done.stderr.decode()}")
    return Run(wall, processors() - cpu)


def best(runs: list[Run]) -> Run:
    """Return the least of each time."""
    return Run(min(r.wall for r in runs), min(r.cpu for r in runs))


def measured(words: tuple[str, ...], folder: Path) -> tuple[Run, Run, Run]:
    """Return the first run with nothing kept, the best of later ones, and the peer between them."""
    (cache := folder / "cache").mkdir()
    first = run(words, folder, cache)
    later, peers = [], []
    while not later or (len(later) < ROUNDS and sum(r.wall for r in later) < ENOUGH):
        later.append(run(words, folder, cache))
        peers.append(run(PEER, folder, cache))
    return first, best(later), best(peers)


def main() -> None:
    """Measure each command in turn, print the table."""
    rows = [
        "| command | wall s, nothing kept | wall s | CPU s | ratio of CPU |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    compileall.compile_dir(Path(hoverproof.__file__).parent, quiet=1)  # as pip does
    peers = []
    for command in COMMANDS:
        with tempfile.TemporaryDirectory() as folder:
            words = ("-m", "hoverproof", *shlex.split(command))
            first, later, peer = measured(words, Path(folder))
        peers.append(peer)
        rows.append(
            f"| `{command}` | {first.wall:.2f} | {later.wall:.2f} | {later.cpu:.2f} "
            f"| {later.cpu / peer.cpu:.1f} |"
        )
    peer = best(peers)
    rows.append(f"| `python {shlex.join(PEER)}` | | {peer.wall:.2f} | {peer.cpu:.2f} | 1.0 |")
    report("commands", "\n".join(rows))


if __name__ == "__main__":
    main()
