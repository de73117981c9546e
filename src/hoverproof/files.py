"""Write files whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from hoverproof.errors import InputError

_unfinished: set[Path] = set()


def discard_unfinished() -> None:
    """Remove what is not written whole: for a process that ends without unwinding."""
    for beside in list(_unfinished):
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)


@contextlib.contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Give a path beside `path` to write to; rename it over `path` if all went well.

    Parameters
    ----------
    path : Path or str
        The file to make or replace. On any error the old file stays as it was.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written to.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(str(path), "", "is a directory, not a file to write")
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name[:100]}.", dir=path.parent)
        os.close(handle)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be written: {error.strerror}") from None
    beside = Path(name)
    _unfinished.add(beside)
    try:
        yield beside
        beside.chmod(0o666 & ~_umask())
        beside.replace(path)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be written: {error.strerror or error}") from error
    finally:
        beside.unlink(missing_ok=True)
        _unfinished.discard(beside)


def write_bytes(path: Path | str, content: bytes | memoryview) -> None:
    """Write bytes to `path`, whole or not at all.

    A library that writes a file itself may crash on a full disk, as HDF5 does when it closes its
    file; what it makes in memory is written by this.

    Parameters
    ----------
    path : Path or str
        The file.
    content : bytes or memoryview
    """
    with replacing(path) as beside:
        beside.write_bytes(content)


def write_text(path: Path | str, text: str) -> None:
    """Write UTF-8 text to `path`, whole or not at all.

    Parameters
    ----------
    path : Path or str
        The file.
    text : str
    """
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
