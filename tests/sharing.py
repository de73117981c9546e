"""What a run of the tests computes once, for all its processes. Not a test itself."""

from __future__ import annotations

import atexit
import fcntl
import hashlib
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

PLACE = "HOVERPROOF_TESTS_SHARED"


def share() -> None:
    """Make the folder that this process and those that it starts share; it goes with this one."""
    if PLACE in os.environ:
        return
    os.environ[PLACE] = tempfile.mkdtemp(prefix="hoverproof-tests-")
    atexit.register(_remove, os.environ[PLACE], os.getpid())


def _remove(folder: str, owner: int) -> None:
    if os.getpid() == owner:  # and not a fork of it
        shutil.rmtree(folder, ignore_errors=True)


def kept(key: object, make: Callable[[Path], object]) -> Path:
    """Return the folder that `make` fills, called by one process of a run for each key.

    Parameters
    ----------
    key : object
        Its `repr` tells all that what is made depends on.
    make : callable
        Fills the folder that it is given, which is not there yet. What it raises is not kept.
    """
    share()
    folder = Path(os.environ[PLACE]) / hashlib.sha256(repr(key).encode()).hexdigest()[:16]
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.exists():
            begun = folder.with_suffix(".begun")
            shutil.rmtree(begun, ignore_errors=True)
            make(begun)
            begun.rename(folder)
    return folder


def kept_value(key: object, make: Callable[[], Any]) -> Any:
    """Return what `make` returns, called by one process of a run for each key; see `kept`."""

    def written(folder: Path) -> None:
        folder.mkdir()
        (folder / "value").write_bytes(pickle.dumps(make()))

    return pickle.loads((kept(key, written) / "value").read_bytes())
