"""Write files whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

from hoverproof.errors import InputError

_unfinished: set[Path] = set()


def cache_folder() -> Path:
    """Return where this user's machine keeps what can be made anew; it may not be there yet."""
    import platformdirs

    return Path(platformdirs.user_cache_dir("hoverproof"))


def kept(path: Path) -> bytes | None:
    """Return what `keep` has put into a file of the cache; None if it is not there, or damaged.

    Parameters
    ----------
    path : Path
    """
    import hashlib

    with contextlib.suppress(OSError, ValueError):
        checksum, content = path.read_bytes().split(b"\n", 1)
        if checksum == hashlib.sha256(content).hexdigest().encode():
            return content
    return None


def keep(path: Path, content: bytes) -> None:
    """Put what can be made anew into a file of the cache, or do nothing if that cannot be.

    Parameters
    ----------
    path : Path
        In `cache_folder`.
    content : bytes
    """
    import hashlib

    with contextlib.suppress(OSError, InputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, hashlib.sha256(content).hexdigest().encode() + b"\n" + content)


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
        The file to make or replace; of a link, what it points to. On any error the old file stays
        as it was.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written to.
    """
    import tempfile

    require_file(path)
    whole = Path(os.path.realpath(path))
    try:
        handle, name = tempfile.mkstemp(prefix=f".{whole.name[:50]}.", dir=whole.parent)
        os.close(handle)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be written: {error.strerror}") from None
    beside = Path(name)
    _unfinished.add(beside)
    try:
        yield beside
        beside.chmod(0o666 & ~_umask())
        beside.replace(whole)
    except OSError as error:
        raise InputError(str(path), "", f"cannot be written: {error.strerror or error}") from error
    finally:
        beside.unlink(missing_ok=True)
        _unfinished.discard(beside)


def require_file(path: Path | str) -> None:
    """Refuse a file that cannot be made, before the work of which it would hold the outcome.

    Parameters
    ----------
    path : Path or str
        The file that is going to be written.

    Raises
    ------
    InputError
        If it is read-only or no file, or its folder is not there or may not be written to.
    """
    path = Path(path)
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        mode = stat.S_IFREG | stat.S_IWUSR
    except (OSError, ValueError) as error:  # as for too long a name, or a null byte
        raise InputError(str(path), "", f"cannot be written: {_why(error)}") from None
    if stat.S_ISDIR(mode):
        raise InputError(str(path), "", "is a directory, not a file to write")
    if not stat.S_ISREG(mode):
        raise InputError(str(path), "", "cannot be written: it is a device, not a file")
    if not mode & 0o222:  # whoever owns the folder could replace it, but it says not to
        raise InputError(str(path), "", "cannot be written: it is read-only")
    folder = Path(os.path.realpath(path)).parent
    if not folder.is_dir():
        raise InputError(str(path), "", "cannot be written: its folder is not there")
    if not os.access(folder, os.W_OK):
        raise InputError(str(path), "", "cannot be written: its folder may not be written to")


def _why(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)


def require_folder(path: Path | str) -> None:
    """Refuse a folder that cannot be made or written to, before the work on what is to be in it.

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
    """
    try:
        ways = [Path(path), *Path(os.path.realpath(path)).parents]
        there = next(way for way in ways if way.exists())
    except (OSError, ValueError) as error:  # as for too long a name, or a null byte
        raise InputError(str(path), "", f"cannot be made: {_why(error)}") from None
    if not there.is_dir():
        raise InputError(str(path), "", f"cannot be made: {there} is no folder")
    if not os.access(there, os.W_OK):
        raise InputError(str(path), "", f"cannot be made: {there} may not be written to")


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


@contextlib.contextmanager
def locked(path: Path | str) -> Iterator[None]:
    """Keep other processes from writing a file over a long time as well.

    The system holds the lock, on a file beside it, and gives it back when the process ends, however
    it ends: what is left of a lock file then locks nothing.

    Parameters
    ----------
    path : Path or str
        The file that is going to be written.

    Raises
    ------
    InputError
        If another process has locked it, or the folder cannot be written to.
    """
    path = Path(path)
    beside = path.with_name(f".{path.name[:100]}.lock")
    try:
        handle = _lock(beside)
    except BlockingIOError:
        raise InputError(
            str(path),
            "",
            "is being written by another run; wait for it, or write elsewhere (--out)",
        ) from None
    except OSError as error:
        raise InputError(str(path), "", f"cannot be written: {error.strerror}") from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):  # a system that removes no open file leaves it
            beside.unlink()
        os.close(handle)


def _lock(beside: Path) -> int:
    """Open and lock a file, and make sure that it is still the one of that name."""
    while True:
        handle = os.open(beside, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            if sys.platform == "win32":
                _lock_on_windows(handle)
                return handle
            _lock_here(handle)
            if beside.exists() and os.path.samestat(os.fstat(handle), beside.stat()):
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)  # another process has just ended and removed it


def _lock_here(handle: int) -> None:
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS):  # it cannot lock
            raise


def _lock_on_windows(handle: int) -> None:
    import msvcrt

    try:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
    except OSError:
        raise BlockingIOError from None


def write_text(path: Path | str, text: str) -> None:
    """Write UTF-8 text to `path`, whole or not at all, with the same bytes on every system.

    Parameters
    ----------
    path : Path or str
        The file.
    text : str
    """
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8", newline="\n")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
