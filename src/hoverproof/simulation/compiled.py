"""Run the closed loop as machine code, or on CasADi's virtual machine where there is no compiler.

Both do the same operations in the same order, so they give the same bits.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import re
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from itertools import product
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.derived import kept_json
from hoverproof.compilers import command_words, find_compiler
from hoverproof.files import cache_folder
from hoverproof.plant.rigid_body import STATE_SIZE
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.simulation.step import FLIGHT_SIZE, GUARDED_SIZE, step_function

Array = NDArray[np.float64]

FLAGS = (
    *("-std=gnu11", "-O3", "-fPIC", "-shared", "-w"),
    *("-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"),  # the bits stay the same
)
OF_THIS_PROCESSOR = ("-march=native",)
"""What not every compiler takes: Clang for some processors of ARM does not."""

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


VIRTUAL_MACHINE = "CasADi virtual machine"
"""The name of what a flight runs on without a compiler."""

STEPS_AT_A_TIME = 200_000
"""How many steps compiled code makes before Python may look whether it is to end."""

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
        ``run(start (k,), design (d,), points (3, n), dt, samples, every)`` returns the flight
        states after each `every` steps, (m, k), k = FLIGHT_SIZE, and whether the last of them is
        good; m is less than `samples` if it is not.
    """

    name: str
    run: Callable[[Array, Array, Array, float, int, int], tuple[Array, bool]]


def runner(n: int, law: Law = HAMEL_MAHONY, *, compiler: str | None = None) -> Runner:
    """Return the fastest way to run the closed loop on this machine.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    compiler : str, optional
        Command of the C compiler; by default ``$CC``, or cc, gcc or clang, whichever is there. The
        empty string asks for the virtual machine.
    """
    command = find_compiler() if compiler is None else compiler
    made = _library(n, law, command) if command else None
    return _virtual_machine(n, law) if made is None else _machine_code(made)


@kept_json
def c_source(n: int, law: Law = HAMEL_MAHONY) -> str:
    """Return the C text of the closed loop with n target points: generated step and driver.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    step = step_function(n, law)
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
def _library(n: int, law: Law, compiler: str) -> ctypes.CDLL | None:
    """Return the compiled closed loop, made if needed; None if that fails."""
    return library(c_source(n, law), compiler, "closed-loop")


def library(source: str, compiler: str, stem: str) -> ctypes.CDLL | None:
    """Return a shared library from the cache, made if needed and loaded; None if that fails.

    What the cache holds may not load: it may lie where nothing may be executed. Then the library
    is made in a temporary folder; a compiler for another machine fails there as well.

    Parameters
    ----------
    source : str
        C text.
    compiler : str
        Command of the C compiler.
    stem : str
        Beginning of the file's name.
    """
    words = command_words(compiler)
    if not words:
        return None
    folders: tuple[Callable[[], Path], ...] = (_cache_folder, _temporary_folder)
    flags: tuple[tuple[str, ...], ...] = (OF_THIS_PROCESSOR, ())
    for folder, own in product(folders, flags):
        try:
            command = [*words, *FLAGS, *own]
            return ctypes.CDLL(str(_built(source, command, folder(), stem)))
        except (OSError, subprocess.CalledProcessError):
            continue
    return None


def _built(source: str, command: list[str], folder: Path, stem: str) -> Path:
    version = _call([command[0], "--version"]).stdout
    identity = "\0".join([source, *command, version, _processor()])
    digest = hashlib.sha256(identity.encode()).hexdigest()[:32]
    path = folder / f"{stem}-{digest}.so"
    if not path.exists():
        with tempfile.TemporaryDirectory(dir=folder) as beside:
            made = Path(beside) / path.name
            _call([*command, "-x", "c", "-", "-o", str(made), "-lm"], source).check_returncode()
            made.replace(path)
    return path


def _call(command: list[str], text: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, input=text, capture_output=True, text=True, errors="replace", check=False
    )


def _cache_folder() -> Path:
    """Return the user's cache directory, or a private one that lasts as long as the process."""
    folder = cache_folder()
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


def _machine_code(library: ctypes.CDLL) -> Runner:
    entry = library.hoverproof_run
    pointer = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
    entry.argtypes = [pointer] * 3 + [ctypes.c_double, ctypes.c_long, ctypes.c_long, pointer]
    entry.restype = ctypes.c_long

    def run(
        start: Array, design: Array, points: Array, dt: float, samples: int, every: int
    ) -> tuple[Array, bool]:
        out = np.empty((samples, FLIGHT_SIZE))
        columns = np.ascontiguousarray(points.T)  # CasADi stores column by column
        at_a_time = max(1, STEPS_AT_A_TIME // every)
        now = start
        for first in range(0, samples, at_a_time):  # between the calls Ctrl-C is heard
            part = out[first : first + at_a_time]
            left = every
            while left > STEPS_AT_A_TIME:
                now = now.copy()
                if not entry(now, design, columns, dt, 1, STEPS_AT_A_TIME, now[None]):
                    out[first] = now
                    return out[: first + 1], False
                left -= STEPS_AT_A_TIME
            done = entry(now, design, columns, dt, len(part), left, part)
            if done < len(part):
                return out[: first + done + 1], False
            now = part[-1]
        return out, True

    return Runner("compiled C", run)


def _virtual_machine(n: int, law: Law) -> Runner:
    step = step_function(n, law)

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

    return Runner(VIRTUAL_MACHINE, run)
