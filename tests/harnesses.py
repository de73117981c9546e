"""The harnesses of the glue for autopilots: a package between stand-ins, flown by a mixer.

The mixer is one scaled as that of the autopilot, or the very files of a tree of it, compiled
between stand-ins for the headers that they take from elsewhere. Not a test itself.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

TESTS = Path(__file__).parent
STUBS, TARGET = TESTS / "stubs", TESTS / "target"
ROTOR_MAX = 0.13
"""N, of one rotor of the vehicles here."""

WARNED = ("-Wall", "-Wextra", "-Werror")
PLAIN_C = ("-std=gnu11", "-O2", "-g")


class Failure(Exception):
    """A command that ended badly, with what it said."""


def run(*command: object, cwd: Path | None = None) -> str:
    """Run a command and return what it prints."""
    words = [str(c) for c in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode != 0:
        said = (done.stdout + done.stderr).splitlines()
        wrong = re.compile(r"\b[Ee]rror: |undefined reference|Error \d|does not hold")
        errors = [line for line in said if wrong.search(line)] or said
        raise Failure(f"{' '.join(words[:3])} ...\n    " + "\n    ".join(errors[:8]))
    return done.stdout


@dataclass(frozen=True)
class Package:
    """What `hoverproof export` wrote into a folder."""

    folder: Path
    manifest: dict[str, Any]

    @property
    def name(self) -> str:
        """Of its files and functions."""
        return str(self.manifest["name"])

    @property
    def sources(self) -> list[Path]:
        """Its C."""
        own = [self.folder / f"{self.name}.c", self.folder / f"{self.name}_selftest.c"]
        return [*own, *self.folder.glob(f"{self.name}_camera.c")]

    @property
    def includes(self) -> list[str]:
        """Options by which its headers are found, and those of its simulated vehicle."""
        return [f"-I{self.folder}", f"-I{self.folder / 'example'}"]


def numbers(package: Package, plain: Package) -> list[str]:
    """Return the macros of a package and of the one whose vehicle is flown, for the harnesses."""
    name = package.name
    vehicle = {
        k: float(Fraction(package.manifest["mission"]["vehicle"][k]))
        for k in ("mass", "gravity", "arm", "drag_ratio")
    }
    of_points = "points" in (package.manifest["sensing"], package.manifest.get("camera"))
    n = len(package.manifest["mission"]["target"]["points"])
    pairs = {
        "OBSERVE": f"{name}_observe",
        "RECEIVE": f"{name}_receive",
        "in_t": f"{plain.name}_input_t",
        "out_t": f"{plain.name}_output_t",
        "real": "float" if plain.manifest["precision"] == "float32" else "double",
        "SEEN": 2 * n if of_points else 3,
        "V_MASS": vehicle["mass"],
        "V_GRAVITY": vehicle["gravity"],
        "V_ARM": vehicle["arm"],
        "V_DRAG": vehicle["drag_ratio"],
        "ROTOR_MAX": rotor_max(package),
    }
    return [f"-D{k}={v}" for k, v in pairs.items()] + (["-DOF_POINTS"] if of_points else [])


def rotor_max(package: Package) -> float:
    """Return what a rotor gives at most, N: `ROTOR_MAX`, or 1.6 times its share of a hover."""
    vehicle = package.manifest["mission"]["vehicle"]
    hover = float(Fraction(vehicle["mass"]) * Fraction(vehicle["gravity"])) / 4
    return max(ROTOR_MAX, 1.6 * hover)


def crazyflie(package: Package, folder: Path, *extra: object, plain: Package | None = None) -> Path:
    """Compile the controller with its harness and the simulated vehicle, that of `plain`."""
    plain = plain or package
    controller = package.folder / "adapters" / "crazyflie" / f"controller_{package.name}.c"
    sources = (TARGET / "crazyflie.c", plain.folder / "example" / "vehicle.c", *package.sources)
    run(
        *("gcc", *PLAIN_C, *WARNED, *numbers(package, plain)),
        *(f'-DCONTROLLER="{controller}"', *extra, f"-I{STUBS / 'crazyflie'}", *plain.includes),
        *(*sources, "-lm", "-pthread", "-o", folder / "crazyflie"),
    )
    return folder / "crazyflie"


def image_topic(package: Package, folder: Path) -> None:
    """Write the header that PX4 makes of the message of a package."""
    message = (package.folder / "adapters" / "px4" / "HoverproofImage.msg").read_text()
    (size,) = re.findall(r"^float32\[(\d+)\] seen", message, re.M)
    topic = folder / "uORB" / "topics" / "hoverproof_image.h"
    topic.parent.mkdir(parents=True, exist_ok=True)
    topic.write_text(
        '#pragma once\n#include "px4.hpp"\n'
        "struct hoverproof_image_s {\n"
        f"  uint64_t timestamp, timestamp_sample; float seen[{size}];\n}};\n"
    )


def px4(package: Package, folder: Path, *extra: object, plain: Package | None = None) -> Path:
    """Compile the flight mode with its harness and the simulated vehicle, that of `plain`."""
    plain = plain or package
    module = package.folder / "adapters" / "px4" / f"{package.name}_module.cpp"
    image_topic(package, folder)
    sources = (plain.folder / "example" / "vehicle.c", *package.sources, *plain.sources)
    made = in_c(sources, plain, folder)
    run(
        *("g++", "-std=gnu++14", "-O2", "-g", *WARNED, "-Wno-unused-parameter"),
        *numbers(package, plain),
        *(f'-DMODULE="{module}"', f"-DLAW_OUT={package.name}_output_t", f"-I{STUBS / 'px4'}"),
        *(f"-I{folder}", *plain.includes, f"-I{package.folder}", TARGET / "px4.cpp"),
        *(*made, *extra, "-lm", "-o", folder / "px4"),
    )
    return folder / "px4"


def ardupilot(package: Package, folder: Path, *extra: object, plain: Package | None = None) -> Path:
    """Compile the custom controller with its harness and the simulated vehicle, that of `plain`."""
    plain = plain or package
    control = f"AC_CustomControl_{package.name}"
    adapters = package.folder / "adapters" / "ardupilot"
    (folder / package.name).symlink_to(package.folder)
    sources = (plain.folder / "example" / "vehicle.c", *plain.sources)
    made = in_c(sources if plain is not package else sources[:1], plain, folder)
    run(
        *("g++", "-std=gnu++11", "-O2", "-g", *WARNED, *numbers(package, plain)),
        *(f"-DCONTROL={control}", f'-DBACKEND="{control}.cpp"', f"-I{STUBS / 'ardupilot'}"),
        *(f"-I{folder}", f"-I{adapters}", *plain.includes, TARGET / "ardupilot.cpp", *made),
        *(*sorted(adapters.glob(f"{package.name}_*.cpp")), *extra, "-lm"),
        *("-o", folder / "ardupilot"),
    )
    return folder / "ardupilot"


def in_c(sources: Iterable[Path], plain: Package, folder: Path) -> list[Path]:
    """Compile each of these once, and return the objects."""
    made = []
    for source in dict.fromkeys(sources):
        made.append(folder / f"{source.stem}.o")
        run("gcc", *PLAIN_C, *plain.includes, "-c", source, "-o", made[-1])
    return made


def flown(program: Path, share: float, late: int) -> tuple[float, float, float, float]:
    """Fly 20 s with rotors that give that share of what they are told, images at 30 Hz.

    Returns the lowest and the highest z of the last five seconds, and where it ends, x and y, m.
    The program ends badly if power is not cut in the step in which it is to be.
    """
    lowest, highest, x, y = map(float, run(program, "fly", share, late).split())
    return lowest, highest, x, y


@dataclass(frozen=True)
class Mixer:
    """What a tree mixes by.

    Attributes
    ----------
    folders : sequence of str
        Of the tree, where its sources are, somewhere below.
    sources : sequence of str
        Names of its files.
    includes : sequence of str
        Folders of the tree whose headers are taken as they are.
    first : sequence of str
        Headers that come first in each file.
    """

    folders: Sequence[str]
    sources: Sequence[str]
    includes: Sequence[str] = ()
    first: Sequence[str] = ()


MIXERS = {
    "px4": Mixer(
        ("src/lib/control_allocation", "src/modules/control_allocator"),
        (
            *("ActuatorEffectiveness", "ActuatorEffectivenessMultirotor"),
            *("ActuatorEffectivenessRotors", "ControlAllocation"),
            *("ControlAllocationPseudoInverse", "ControlAllocationSequentialDesaturation"),
        ),
        ("src/lib", "src/lib/matrix"),
        ("mathlib/mathlib.h",),
    ),
    "ardupilot": Mixer(
        ("libraries/AP_Motors", "libraries/Filter"),
        (
            *("AP_MotorsMatrix", "AP_MotorsMulticopter", "AP_Motors_Class"),
            *("AP_Motors_Thrust_Linearization", "LowPassFilter", "DerivativeFilter"),
        ),
        first=("ardupilot_mixer.h",),
    ),
}
"""Of the trees in C++."""


def tree_mixer(autopilot: str, tree: Path, macros: Sequence[str], folder: Path) -> Path:
    """Compile the mixer of a tree, its own files, as a library that has `tree_mixer` alone.

    A header that none of these folders holds leads to the stand-in.
    """
    mixer, lent = MIXERS[autopilot], folder / "lent"
    lent.mkdir()
    files = (f for part in mixer.folders for f in (tree / part).rglob("*.cpp"))
    found = {f.stem: f for f in files if "examples" not in f.parts}
    if absent := [name for name in mixer.sources if name not in found]:
        raise Failure(f"{tree} has no {absent[0]}.cpp below {' or '.join(mixer.folders)}")
    sources = [*(found[name] for name in mixer.sources), TARGET / f"{autopilot}_mixer.cpp"]
    for part in mixer.folders:
        (lent / Path(part).name).symlink_to(tree / part)
    places = [STUBS / f"{autopilot}-mixer", lent, *(tree / part for part in mixer.includes)]
    places += dict.fromkeys(found[name].parent for name in mixer.sources)
    options = ["-std=gnu++17", *(f"-I{p}" for p in places), *macros]
    options += [word for header in mixer.first for word in ("-include", header)]
    for header in missing_headers(options, sources):
        (lent / header).parent.mkdir(parents=True, exist_ok=True)
        (lent / header).write_text(f'#include "{autopilot}_mixer.h"\n')
    library = folder / f"lib{autopilot}-mixer.so"
    hidden = ("-shared", "-fPIC", "-fvisibility=hidden")  # its classes are not the stand-ins
    run("g++", *options, "-O2", "-w", *hidden, *sources, "-o", library)
    return library


def missing_headers(options: Sequence[object], sources: Sequence[Path]) -> list[str]:
    """Return the headers that these sources ask for and nobody has."""
    rules = run("g++", *options, "-M", "-MG", *sources)
    words = (word for word in rules.split() if word != "\\" and not word.endswith(":"))
    return sorted({word for word in words if not Path(word).is_absolute()})
