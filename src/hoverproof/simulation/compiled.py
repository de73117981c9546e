"""Run the closed loop as machine code, or on CasADi's virtual machine where there is no compiler.

Both do the same operations in the same order, so they give the same bits.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import re
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

import casadi as ca
import numpy as np
import platformdirs
from numpy.typing import NDArray

from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.simulation.closed_loop import FLIGHT_SIZE, GUARDED_SIZE, step_function

Array = NDArray[np.float64]

FLAGS = (
    *("-std=gnu11", "-O3", "-march=native", "-fPIC", "-shared", "-w"),
    *("-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"),  # the bits stay the same
)


DIVERGED = 10**12
"""A flight has diverged when any number of its state reaches this size, in SI units."""


def has_diverged(flight: Array) -> bool:
    """Tell whether a flight state has diverged or is not a number.

    Parameters
    ----------
    flight : (k,)
        Packed state, SI units, and what comes after it.
    """
    return not (np.abs(flight[:STATE_SIZE]) < DIVERGED).all()


PREAMBLE = """\
#if !defined(__clang__)
#pragma GCC optimize("schedule-insns,sched-pressure") /* CasADi's order is depth first */
#endif
#define CASADI_SYMBOL_EXPORT static
"""


@dataclass(frozen=True)
class Runner:
    """A way to run the closed loop.

    Attributes
    ----------
    name : str
        ``"compiled C"`` or ``"CasADi virtual machine"``.
    run : callable
        ``run(start (k,), design (13,), points (3, n), dt, samples, every)`` returns the flight
        states after each `every` steps, (m, k), k = FLIGHT_SIZE, and whether the last of them is
        good; m is less than `samples` if it is not.
    """

    name: str
    run: Callable[[Array, Array, Array, float, int, int], tuple[Array, bool]]


def runner(n: int, *, compiler: str | None = None) -> Runner:
    """Return the fastest way to run the closed loop on this machine.

    Parameters
    ----------
    n : int
        Number of target points.
    compiler : str, optional
        Command of the C compiler; by default ``$CC``, or cc, gcc or clang, whichever is there. The
        empty string asks for the virtual machine.
    """
    command = find_compiler() if compiler is None else compiler
    library = _library(n, command) if command else None
    return _virtual_machine(n) if library is None else _machine_code(n, library)


def find_compiler() -> str:
    """Return the command of the system's C compiler, empty if there is none."""
    named = os.environ.get("CC")
    for command in [named] if named else ["cc", "gcc", "clang"]:
        if shutil.which(shlex.split(command)[0]):
            return command
    return ""


@cache
def c_source(n: int) -> str:
    """Return the C text of the closed loop with n target points: generated step and driver."""
    step = step_function(n)
    constants = {"FLIGHT": FLIGHT_SIZE, "STATE": STATE_SIZE, "DIVERGED": DIVERGED}
    constants |= {"GUARDED": GUARDED_SIZE}
    constants |= {"DESIGN": step.nnz_in(1), "POINTS": step.nnz_in(2)}
    defines, driver = define(constants), c_file("loop.c")
    return f"{PREAMBLE}{defines}{generate([step])}\n{driver}"


def define(constants: Mapping[str, int]) -> str:
    """Return a C definition of each constant, as HP_NAME.

    Parameters
    ----------
    constants : mapping
        Bare numbers by name.
    """
    return "".join(f"#define HP_{name} {value}\n" for name, value in constants.items())


def c_file(name: str) -> str:
    """Return the text of a C file of this folder.

    Parameters
    ----------
    name : str
        Of the file, as ``loop.c``.
    """
    return (resources.files("hoverproof.simulation") / name).read_text(encoding="utf-8")


def generate(functions: Sequence[ca.Function]) -> str:
    """Return the C text that CasADi makes of functions, everything in it static.

    Parameters
    ----------
    functions : sequence of Function
    """
    with tempfile.TemporaryDirectory() as folder:
        generator = ca.CodeGenerator("closed_loop.c", {"with_header": False})
        for function in functions:
            generator.add(function)
        generator.generate(folder + os.sep)
        generated = (Path(folder) / "closed_loop.c").read_text(encoding="utf-8")
    return re.sub(r"(?m)^casadi_real casadi_", "static casadi_real casadi_", generated)


@cache
def _library(n: int, compiler: str) -> Path | None:
    """Return the compiled closed loop from the cache, made if needed; None if that fails."""
    return build(c_source(n), compiler, "closed-loop")


def build(source: str, compiler: str, stem: str) -> Path | None:
    """Return a shared library from the cache, made if needed; None if that fails.

    Parameters
    ----------
    source : str
        C text.
    compiler : str
        Command of the C compiler.
    stem : str
        Beginning of the file's name.
    """
    command = [*shlex.split(compiler), *FLAGS]
    try:
        version = _call([command[0], "--version"]).stdout
        identity = "\0".join([source, *command, version, _processor()])
        digest = hashlib.sha256(identity.encode()).hexdigest()[:32]
        path = _cache_folder() / f"{stem}-{digest}.so"
        if not path.exists():
            with tempfile.TemporaryDirectory(dir=path.parent) as folder:
                made = Path(folder) / path.name
                _call([*command, "-x", "c", "-", "-o", str(made), "-lm"], source).check_returncode()
                made.replace(path)
    except (OSError, subprocess.CalledProcessError):
        return None
    return path


def _call(command: list[str], text: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, input=text, capture_output=True, text=True, check=False)


def _cache_folder() -> Path:
    """Return the user's cache directory, or a private one that lasts as long as the process."""
    folder = Path(platformdirs.user_cache_dir("hoverproof"))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return _temporary_folder()
    return folder if os.access(folder, os.W_OK) else _temporary_folder()


@cache
def _temporary_folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="hoverproof-"))


def _processor() -> str:
    """Return what -march=native depends on, so that a shared cache serves several machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        return f"{platform.machine()} {platform.processor()}"


def _machine_code(n: int, library: Path) -> Runner:
    entry = ctypes.CDLL(str(library)).hoverproof_run
    pointer = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
    entry.argtypes = [pointer] * 3 + [ctypes.c_double, ctypes.c_long, ctypes.c_long, pointer]
    entry.restype = ctypes.c_long

    def run(
        start: Array, design: Array, points: Array, dt: float, samples: int, every: int
    ) -> tuple[Array, bool]:
        out = np.empty((samples, FLIGHT_SIZE))
        columns = np.ascontiguousarray(points.T)  # CasADi stores column by column
        done = entry(start, design, columns, dt, samples, every, out)
        return out[: done + 1], done == samples

    return Runner("compiled C", run)


def _virtual_machine(n: int) -> Runner:
    step = step_function(n)

    def run(
        start: Array, design: Array, points: Array, dt: float, samples: int, every: int
    ) -> tuple[Array, bool]:
        longest = min(every, 100)
        whole, rest = divmod(every, longest)
        leaps = []
        for size, times in ((longest, whole), (rest, 1)):
            if size:
                held = (
                    np.tile(design[:, None], size),
                    np.tile(points, size),
                    np.full((1, size), dt),
                )
                leaps += [(step.fold(size), held)] * times
        flight, taken = start, []
        for _ in range(samples):
            for leap, held in leaps:
                flight = np.array(leap(flight, *held))[:, 0]
            taken.append(flight)
            if has_diverged(flight) or not (flight[STATE_SIZE:GUARDED_SIZE] > 0).all():
                return np.array(taken), False
        return np.array(taken), True

    return Runner("CasADi virtual machine", run)
