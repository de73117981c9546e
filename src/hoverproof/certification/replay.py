"""The proof assistant Coq decides a certificate by programs that it has proved right."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hoverproof.errors import InputError
from hoverproof.files import cache_folder

PACKAGE = Path(__file__).parents[1]
SOURCES = PACKAGE / "coq", PACKAGE.parents[1] / "proofs" / "coq"
"""Where Coq's library stands: as installed, and in a clone."""


@dataclass(frozen=True)
class Replay:
    """What Coq says of a certificate.

    Attributes
    ----------
    shown : tuple of str
        What Coq has decided and proved of it, in words; none if it is not covered, or refused.
    left : str
        What is left to paper and to the checker, in words.
    refused : str
        Which of the decisions Coq did not find true; empty if there is none.
    """

    shown: tuple[str, ...]
    left: str
    refused: str = ""


def replay(content: dict[str, Any], progress: Callable[[str], None]) -> Replay:
    """Have Coq decide a certificate that the checker has accepted.

    Parameters
    ----------
    content : dict
        The certificate.
    progress : callable
        Is told what is being done.

    Returns
    -------
    Replay

    Raises
    ------
    InputError
        If Coq is not installed, or cannot build the library.
    """
    sources = next((folder for folder in SOURCES if folder.is_dir()), None)
    if not shutil.which("coqc") or sources is None:
        needed = "needs the proof assistant Coq (coqc, 8.16 or so), which is not installed"
        raise InputError("--coq", "", f"{needed}: on Debian it is the package coq")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "certificate.cert.json"
        file.write_text(json.dumps(content), encoding="utf-8", newline="\n")
        literals = [sys.executable, "-I", "-S", str(sources / "literals.py")]
        about = json.loads(_call([*literals, "--about", str(file)]).stdout)
        if not about["shown"]:
            return Replay((), about["left"])
        library = _library(sources, progress)
        progress("Coq decides the certificate")
        terms = Path(folder) / "Replay.v"
        terms.write_text(_call([*literals, str(file)]).stdout, encoding="utf-8", newline="\n")
        done = _call(["coqc", "-q", "-Q", str(library), "Hoverproof", str(terms)], check=False)
        if done.returncode == 0:
            return Replay(tuple(about["shown"]), about["left"])
        line = re.search(r"line (\d+)", done.stderr)
        before = terms.read_text(encoding="utf-8").splitlines()[: int(line[1]) if line else 0]
        tried = re.findall(r"^Theorem (\w+?)_certificate", "\n".join(before), flags=re.MULTILINE)
        return Replay((), about["left"], tried[-1] if tried else "what is written for it")


def library_folder(sources: Path) -> Path:
    """Return where the library is kept compiled, by its text and the version of Coq.

    Parameters
    ----------
    sources : Path
        The folder of its files.
    """
    texts = [_version().encode(), *(file.read_bytes() for file in _files(sources))]
    return cache_folder() / f"coq-{hashlib.sha256(b''.join(texts)).hexdigest()[:16]}"


def _files(sources: Path) -> list[Path]:
    lines = (sources / "_CoqProject").read_text(encoding="utf-8").split()
    return [sources / name for name in lines if name.endswith(".v")]


def _version() -> str:
    return _call(["coqc", "--version"]).stdout.strip()


def _library(sources: Path, progress: Callable[[str], None]) -> Path:
    """Return the folder of the library, compiled; compile it if it is not there yet."""
    files, folder = _files(sources), library_folder(sources)
    if folder.is_dir():
        return folder
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix="coq-unfinished-") as made:
            beside = Path(made) / "coq"
            beside.mkdir()
            for number, file in enumerate(files, 1):
                progress(f"Coq proves {file.stem} ({number} of {len(files)}, the first time only)")
                copied = str(shutil.copy(file, beside))
                done = _call(["coqc", "-q", "-Q", str(beside), "Hoverproof", copied], check=False)
                if done.returncode:
                    version = _version().partition("\n")[0]
                    reason = f"{file.name} is not accepted by this version: {version}"
                    raise InputError("--coq", "", reason)
            beside.replace(folder)
    except OSError as error:
        if not folder.is_dir():  # another process may have been faster
            reason = f"the library cannot be kept: {error.strerror}"
            raise InputError("--coq", str(folder), reason) from None
    return folder


def _call(command: list[str], check: bool = True) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, capture_output=True, encoding="utf-8", errors="replace", check=check
    )
