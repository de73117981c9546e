"""Commands run as a reader types them, in processes that have imported the libraries already.

A command of the program alone runs in a process of its own that a server forks, which has imported
the libraries once for all of them; what needs a shell gets one.
"""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import tempfile
from pathlib import Path

IMPORTED = (
    "hoverproof.cli",
    "hoverproof.reporting.document",
    *(f"hoverproof.show.{name}" for name in ("atlas", "attraction", "figures", "region", "runs")),
    *("clarabel", "scipy.integrate", "scipy.linalg", "scipy.sparse", "xarray"),
)
FOR_A_SHELL = frozenset("|&;<>()$`\\\"'*?#~\n")
"""What none but a shell knows how to read."""

_server = multiprocessing.get_context("forkserver") if os.name == "posix" else None


def ran(command: str, folder: Path) -> tuple[int, str]:
    """Run a command in a folder; return its status and what it printed."""
    env = {
        **{k: v for k, v in os.environ.items() if not k.startswith("MAKE")},
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "COLUMNS": "80",
        "NO_COLOR": "1",
    }
    line = command.replace("\\\n", " ")
    with tempfile.NamedTemporaryFile() as output:
        if _server and line.startswith("hoverproof ") and not FOR_A_SHELL & set(line):
            _server.set_forkserver_preload(list(IMPORTED))
            process = _server.Process(target=_alone, args=(line.split(), folder, env, output.name))
            process.start()
            process.join()
            status = process.exitcode or 0
        else:
            shell = ["bash", "-euc", command]
            status = subprocess.call(shell, cwd=folder, env=env, stdout=output, stderr=output)
        return status, Path(output.name).read_text(encoding="utf-8")


def _alone(words: list[str], folder: Path, env: dict[str, str], output: str) -> None:
    """Be the program as a shell would start it, in a process of its own."""
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(env)
    handle = os.open(output, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(handle, stream)
    sys.argv = words
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - to the end
    sys.stderr = open(2, "w", buffering=1, encoding="utf-8", closefd=False)  # noqa: SIM115
    from hoverproof.cli import main

    main()
