"""Time the commands of the README as they stand there, each in a process of its own.

Run ``python benchmarks/tour.py``; ``--write`` puts the seconds into the comments of the README.
"""

from __future__ import annotations

import compileall
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import hoverproof

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
TIMED = re.compile(
    r"(?m)^((?:hoverproof|python -I) [^#\n]*?)"  # a command
    r"(\s+#|$)"  # the sign before its comment, if it has one
    r"(?: (?:<?\d+ s)?(?:: )?(.*))?$"  # the comment, without its time
)


def seconds(command: str, folder: Path) -> float:
    """Run a command in a folder as a shell does; return the seconds by the clock."""
    env = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    begin = time.perf_counter()
    done = subprocess.run(["bash", "-euc", command], cwd=folder, env=env, capture_output=True)
    if done.returncode:
        raise SystemExit(f"{command}: {done.stderr.decode()}")
    return time.perf_counter() - begin


def main() -> None:
    """Measure, print, and with ``--write`` write."""
    compileall.compile_dir(Path(hoverproof.__file__).parent, quiet=1)  # as pip does
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "src").symlink_to(ROOT / "src")

        def timed(match: re.Match[str]) -> str:
            command, sign, comment = match.groups()
            whole = round(seconds(command, folder))
            took = f"{command}{sign or '  #'} {whole if whole else '<1'} s"
            line = f"{took}: {comment}" if comment else took
            print(line, flush=True)
            return line

        text = TIMED.sub(timed, README.read_text(encoding="utf-8"))
    if "--write" in sys.argv[1:]:
        README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
