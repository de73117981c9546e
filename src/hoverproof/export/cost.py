"""What firmware costs on its target: flash and stack as a compiler makes them, and rounding."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from hoverproof.errors import InputError
from hoverproof.export.flight_law import flight_law
from hoverproof.export.precision import FLOAT32, FLOAT64
from hoverproof.export.vectors import Step, law_at, random_step
from hoverproof.mission.sections import Mission

COMPILER = "arm-none-eabi-gcc"
FLAGS = (
    *("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"),
    *("-std=gnu99", "-O2", "-fno-math-errno", "-ffp-contract=off"),
)
STEPS = 100


@dataclass(frozen=True)
class Footprint:
    """What a package takes on a Cortex-M4F, measured.

    Attributes
    ----------
    compiler : str
        The first line of what it says of its version.
    flash : int
        Code and constants, without the self-test: a number of bytes.
    stack : int
        The frame of a step: a number of bytes.
    """

    compiler: str
    flash: int
    stack: int


@dataclass(frozen=True)
class Rounding:
    """How far a step in float32 is from the same step in float64.

    Attributes
    ----------
    output : str
        Name of the output.
    unit : str
        Its unit.
    error : float
        Largest difference, in that unit: N/s, N m or N.
    largest : float
        Largest size of the output over the same steps, in that unit: N/s, N m or N.
    """

    output: str
    unit: str
    error: float
    largest: float


def footprint(folder: str | Path, manifest: Mapping[str, Any]) -> Footprint:
    """Compile a package for a Cortex-M4F and read what it takes.

    Parameters
    ----------
    folder : str or Path
        The package, in float32.
    manifest : mapping
        Its manifest.

    Raises
    ------
    InputError
        If no compiler for the target is here, or it does not compile the package.
    """
    if shutil.which(COMPILER) is None:
        raise InputError(COMPILER, "", "is not installed here, so nothing was measured")
    name = manifest["name"]
    with tempfile.TemporaryDirectory() as build:
        made = Path(build) / "law.o"
        source = Path(folder) / f"{name}.c"
        _said(COMPILER, *FLAGS, "-fstack-usage", "-c", str(source), "-o", str(made))
        sizes = _said(COMPILER.replace("gcc", "size"), str(made))
        frames = made.with_suffix(".su").read_text(encoding="utf-8")
    frame = re.search(rf":{name}_step\t(\d+)\t", frames)
    if frame is None:
        raise InputError(COMPILER, "", "did not tell the stack of a step")
    version = _said(COMPILER, "--version").splitlines()[0]
    return Footprint(version, int(sizes.splitlines()[1].split()[0]), int(frame[1]))


def rounding(mission: Mission, thrust: tuple[Fraction, Fraction]) -> list[Rounding]:
    """Compare steps near hover in float32, bit for bit as on the target, with float64.

    Parameters
    ----------
    mission : Mission
    thrust : (low, high)
        The interval that thrusts are drawn from, N.
    """
    law = flight_law(mission, sensing="points", tunable=False)
    draw = np.random.default_rng(0)
    error: dict[str, float] = {}
    largest: dict[str, float] = {}
    for _ in range(STEPS):
        step = random_step(draw, mission, FLOAT32, "points", thrust)
        wide = Step(*(FLOAT64.scalar(v) for v in vars(step).values()))  # type: ignore[arg-type]
        short, long = law_at(law, step, FLOAT32), law_at(law, wide, FLOAT64)
        for name in long:
            apart = max(
                abs(float(a) - float(b)) for a, b in zip(short[name], long[name], strict=True)
            )
            error[name] = max(error.get(name, 0.0), apart)
            largest[name] = max(largest.get(name, 0.0), *(abs(float(b)) for b in long[name]))
    units = {"thrust_rate": "N/s", "torque": "N m", "rotor": "N"}
    return [Rounding(n, unit, error[n], largest[n]) for n, unit in units.items()]


def _said(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr or done.stdout).strip().splitlines()[:1]
        raise InputError(command[0], "", f"failed: {' '.join(reason)}")
    return done.stdout
