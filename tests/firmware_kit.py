"""What the tests of the firmware share: packages, compilers, boards. Not a test itself."""

from __future__ import annotations

import os
import pickle
import re
import shutil
import subprocess
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import pytest

import hoverproof
from harnesses import Package
from hoverproof.mission.reading import load
from papers_law import CRAZYFLIE, PAPERS
from sharing import kept

TARGET = Path(__file__).parent / "target"
FLAGS = ("-std=c99", "-O2", "-fno-math-errno", "-ffp-contract=off")
WARNINGS = (
    *("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wsign-conversion"),
    *("-Wshadow", "-Wfloat-equal", "-Wcast-qual", "-Werror"),
)
C_WARNINGS = (*WARNINGS, "-Wmissing-prototypes")
OFF_AXIS = {"goal": {"centroid": [0.1, -0.2, 3.5]}}
LEVEL = {"bounds": {"eigenvalues": [0.01, 5.0], "level": 20.0}}


def tool(name):
    """Skip the test that needs a tool which is not there; where all must be there, fail."""
    if shutil.which(name):
        return name
    if os.environ.get("HOVERPROOF_REQUIRE_TOOLS"):
        pytest.fail(f"{name} is needed here: tools/install-system-tools.sh")
    pytest.skip(f"not run: {name} is not installed (tools/install-system-tools.sh)")


def run(*command, **options):
    done = subprocess.run(
        [str(c) for c in command], capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}"
    return done


def export_anew(folder, mission="x4-flyer", overrides=None, **options):
    loaded = load(mission, overrides or {})
    return Package(folder, hoverproof.export_c(loaded, folder, **options))


def export(folder, mission="x4-flyer", overrides=None, **options):
    """Export a package, or copy the one that another test has exported with the same options."""

    def make(begun):
        made = export_anew(begun / "package", mission, overrides, **options)
        (begun / "manifest").write_bytes(pickle.dumps(made.manifest))

    place = kept(("package", mission, overrides or {}, sorted(options.items())), make)
    shutil.copytree(place / "package", folder, dirs_exist_ok=True)
    return Package(folder, pickle.loads((place / "manifest").read_bytes()))


@dataclass(frozen=True)
class Kind:
    """A mission and the options it is exported with."""

    mission: str = "x4-flyer"
    overrides: tuple = ()
    options: tuple = ()

    def __str__(self):
        said = [self.mission, *(k for k, _ in self.overrides), *(str(v) for _, v in self.options)]
        return "-".join(said)

    def export(self, folder):
        return export(folder, self.mission, dict(self.overrides), **dict(self.options))


def kinds():
    """Every preset in both precisions, and every option at least once."""
    plain = [
        Kind(p, (), (("precision", r),)) for p in PAPERS.values() for r in ("float32", "float64")
    ]
    off, level = tuple(OFF_AXIS.items()), tuple(LEVEL.items())
    return [
        *plain,
        Kind(overrides=off),
        Kind(overrides=off, options=(("tunable", True),)),
        Kind(overrides=level, options=(("sensing", "centroid"),)),
        Kind(
            overrides=(("gains.k4", "0.1"),),
            options=(("allow_uncertified", True), ("precision", "float64")),
        ),
        *other_laws(),
    ]


def other_laws():
    """The laws that take in more, and make more of it, than the paper's."""
    felt = (("law", {"force": "measured"}),)
    best = (("law", {"feature": "scaled", "goal": "inertial", "force": "measured"}),)
    uncertified = ("allow_uncertified", True)
    seen = (("goal.heading", "0.5"), ("goal.heading_from", "'image'"))
    return [
        Kind(CRAZYFLIE, felt, (uncertified, ("tunable", True))),
        Kind(CRAZYFLIE, (*best, ("interface.rate_bandwidth", "25")), (uncertified,)),
        Kind("x4-flyer", best, (uncertified, ("precision", "float64"), ("sensing", "centroid"))),
        Kind("x4-flyer", best, (uncertified, ("sensing", "centroid"))),
        Kind("x4-flyer", best, (uncertified, ("camera", True))),
        Kind(CRAZYFLIE, (("goal.heading", "0.5"),), (("tunable", True),)),
        Kind("x4-flyer", (*best, ("goal.heading", "-2")), (uncertified, ("camera", True))),
        Kind(CRAZYFLIE, seen),
        Kind("x4-flyer", (*best, *seen), (uncertified, ("camera", True))),
        Kind(options=(("camera", True), ("sensing", "centroid"), ("precision", "float64"))),
    ]


LENS = (
    "{width = 1280, height = 960, fx = 620, fy = 618, cx = 650, cy = 470, distortion_model = "
    '"plumb_bob", distortion = [-0.28, 0.07, 0.0005, -0.0003, 0.01]}'
)
"""Of a camera, as a mission has it."""


def names_header(package, steps=30_000):
    """Return the header by which the C harnesses call a package whatever its prefix."""
    name, weight = package.name, load_weight(package)
    in_step = "camera" not in package.manifest
    sized = in_step and "angular_radius_rad" in package.manifest["input_box"]
    pairs = {
        "real": "float" if package.manifest["precision"] == "float32" else "double",
        **{f"{t}_t": f"{name}_{t}_t" for t in ("params", "state", "input", "output")},
        **{v: f"{name}_{v}" for v in ("init", "step", "selftest")},
        "reset_state": f"{name}_reset",
        "set_rotor_limits": f"{name}_set_rotor_limits",
        "take_over": f"{name}_take_over",
        "HOVER": repr(weight),
        "STEPS": str(steps),
        "FELT": str(int("specific_force_length_m_per_s2" in package.manifest["input_box"])),
        "SIZED": str(int(sized)),
        "RATES": str(int("rate_bandwidth" in package.manifest)),
        "SENSED_POINTS": str(int(package.manifest["sensing"] == "points")),
        "PARAMS_HEADER": f'"{name}_params.h"',
    }
    macros = "".join(f"#define {k} {v}\n" for k, v in pairs.items())
    prefix = name.upper()
    consts = ("FAULT", "INPUT", "TARGET", "SINGULAR", "THRUST", "TILT", "SATURATED")
    macros += "".join(f"#define S_{c} {prefix}_{c}\n" for c in consts)
    limits = (
        "EXCESS_FLOOR",
        "EXCESS_CEILING",
        "EXCESS_LOW",
        "EXCESS_HIGH",
        "TILT_COSINE",
        "WEIGHT",
    )
    limits += ("ROTOR_HOVER", "SPEED_SQUARE", "RATE_SQUARE", "DIRECTION_LOW", "DIRECTION_HIGH")
    macros += "".join(f"#define P_{c} {prefix}_{c}\n" for c in (*limits, "DT_HIGHEST"))
    if "specific_force_length_m_per_s2" in package.manifest["input_box"]:
        macros += f"#define P_FORCE_SQUARE {prefix}_FORCE_SQUARE\n"
        macros += f"#define P_MASS {prefix}_MASS\n#define P_GRAVITY {prefix}_GRAVITY\n"
    felt = "FELT" if "specific_force_length_m_per_s2" in package.manifest["input_box"] else "EXCESS"
    macros += "".join(f"#define P_FELT_{end} {prefix}_{felt}_{end}\n" for end in ("LOW", "HIGH"))
    if sized:
        low, high = package.manifest["input_box"]["angular_radius_rad"]
        macros += f"#define RADIUS_LOW {low!r}\n#define RADIUS_HIGH {high!r}\n"
        macros += f"#define P_SPREAD_LOW {prefix}_SPREAD_LOW\n"
        n = len(package.manifest["mission"]["target"]["points"])
        macros += f"#define TARGET_POINTS {n}\n"
    sensing = package.manifest["sensing"]
    seen = "IMAGE" if sensing == "points" else sensing.upper()
    macros += f"#define SEEN_SQUARE {prefix}_{seen}_SQUARE\n"
    return f'#include <stddef.h>\n#include "{name}.h"\n{macros}'


def load_weight(package):
    vehicle = package.manifest["mission"]["vehicle"]
    return float(Fraction(vehicle["mass"]) * Fraction(vehicle["gravity"]))


@dataclass(frozen=True)
class Board:
    machine: str
    flags: tuple


BOARDS = {
    "Cortex-M4F": Board(
        "mps2-an386", ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
    ),
    "Cortex-M7": Board(
        "mps2-an500", ("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16")
    ),
}


def build_for(board, package, sources, out, *extra):
    """Compile sources and the package for a board, ready for QEMU."""
    run(
        tool("arm-none-eabi-gcc"),
        *board.flags,
        *(f.replace("c99", "gnu99") for f in FLAGS),
        "--specs=rdimon.specs",
        *package.includes,
        f"-I{out.parent}",
        *extra,
        TARGET / "startup.c",
        *sources,
        *package.sources,
        *("-T", TARGET / "mps2.ld", "-lm", "-o", out),
    )
    return out


def emulation(board, image, *options):
    """Return the command that runs an image on a board; what it prints is printed here."""
    command = [tool("qemu-system-arm"), "-M", board.machine, "-nographic", "-monitor", "none"]
    semihosting = ("-serial", "none", "-semihosting-config", "enable=on,target=native")
    return [*command, *semihosting, *options, "-kernel", image]


def emulate(board, image, *options, timeout=300):
    return run(*emulation(board, image, *options), timeout=timeout).stdout


def count_instructions(board, image, function, caller="main"):
    """Return the instructions of each call of a function, from its first to its return."""
    symbols = {}
    for line in run("arm-none-eabi-nm", "-S", image).stdout.splitlines():
        parts = line.split()
        if len(parts) == 4:
            symbols[parts[3]] = (int(parts[0], 16) & ~1, int(parts[1], 16))
    entry = symbols[function][0]
    outside = range(symbols[caller][0], sum(symbols[caller]))
    log = image.with_suffix(".trace")
    emulate(board, image, "-singlestep", "-d", "exec,nochain", "-D", log)
    counts, inside = [], False
    for at in re.finditer(r"\[[0-9a-f]+/([0-9a-f]+)/", log.read_text(errors="replace")):
        pc = int(at[1], 16)
        if pc == entry:
            counts.append(0)
            inside = True
        elif pc in outside:
            inside = False
        if inside:
            counts[-1] += 1
    return counts
