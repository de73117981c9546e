"""Count the instructions of a firmware step on an emulated Cortex-M4F: exported and by hand.

Run ``python benchmarks/firmware.py``; ``--write`` puts the table into the README beside it. Needs
gcc-arm-none-eabi and qemu-system-arm (tools/install-system-tools.sh).
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

from tables import report

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests"))

from firmware_kit import (  # noqa: E402
    BOARDS,
    FLAGS,
    LEVEL,
    OFF_AXIS,
    TARGET,
    Package,
    build_for,
    count_instructions,
    export,
    names_header,
    run,
)

BOARD = BOARDS["Cortex-M4F"]
CALLS = 20


def hand_macros(package: Package) -> list[str]:
    """Return the numbers of the C by hand, taken from the package's own header."""
    text = (package.folder / f"{package.name}_params.h").read_text(encoding="utf-8")
    found = dict(re.findall(rf"#define {package.name.upper()}_(\w+) (\(.*?\)|{{.*?}})", text))
    inertia = found["INERTIA"].strip("{ }").split(", ")
    gains = found["GAINS_CERTIFIED"].strip("{ }").split(", ")
    numbers = {
        "POINTS": str(len(package.manifest["mission"]["target"]["points"])),
        "MASS": found["MASS"],
        "GRAVITY": found["GRAVITY"],
        **dict(zip(("I1", "I2", "I3"), inertia, strict=True)),
        **dict(zip(("K1", "K2", "K3", "K4", "KYAW"), gains, strict=True)),
        "GOAL": found["GOAL_CENTROID"].strip("{ }").split(", ")[2],
        "ARM": found["ARM"],
        "DRAG": found["DRAG_RATIO"],
        "IMAGE": found["IMAGE_SQUARE"],
        "SPEED": found["SPEED_SQUARE"],
        "RATE": found["RATE_SQUARE"],
        "DOWN_LOW": found["DIRECTION_LOW"],
        "DOWN_HIGH": found["DIRECTION_HIGH"],
        "DT": found["DT_HIGHEST"],
        "FLOOR": found["EXCESS_FLOOR"],
        "CEILING": found["EXCESS_CEILING"],
        "LOW": found["EXCESS_LOW"],
        "HIGH": found["EXCESS_HIGH"],
        "TILT": found["TILT_COSINE"],
    }
    return [f"-DHAND_{name}={value}" for name, value in numbers.items()]


def counted(package: Package, folder: Path, step: str, *extra: str | Path) -> int:
    """Return the most instructions that a step takes on the board."""
    (folder / "firmware_names.h").write_text(names_header(package, CALLS), encoding="utf-8")
    sources = [TARGET / "count.c", package.folder / "example" / "vehicle.c"]
    image = build_for(BOARD, package, sources, folder / f"{step}.elf", f"-DSTEP={step}", *extra)
    counts = count_instructions(BOARD, image, step)
    assert len(counts) == CALLS, counts
    return max(counts)


def size_of(folder: Path, source: Path, function: str, *extra: str) -> tuple[int, int]:
    """Return bytes of code and constants, and of the stack that a function takes."""
    made = folder / "size.o"
    flags = (*BOARD.flags, *(f.replace("c99", "gnu99") for f in FLAGS), f"-I{folder}")
    run("arm-none-eabi-gcc", *flags, "-fstack-usage", *extra, "-c", source, "-o", made)
    text = int(run("arm-none-eabi-size", made).stdout.splitlines()[1].split()[0])
    stack = re.search(rf":{function}\t(\d+)\t", made.with_suffix(".su").read_text())
    assert stack is not None
    return text, int(stack[1])


def by_hand(package: Package, folder: Path) -> int:
    """Return the instructions of a step of the C by hand."""
    return counted(package, folder, "hand_step", *hand_macros(package), HERE / "firmware.c")


def table() -> str:
    """Measure, and return the table in Markdown."""
    rows = ["| what | instructions | ratio to C by hand | stack, bytes | flash, bytes |"]
    rows.append("| --- | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plain = export(folder / "plain")
        hand = by_hand(plain, folder)
        kinds = {
            "exported, `x4-flyer`": plain,
            "exported, gains tunable": export(folder / "tunable", tunable=True),
            "exported, centroid from the camera": export(folder / "centroid", sensing="centroid"),
            "exported, level instead of thrusts": export(folder / "level", overrides=LEVEL),
            "exported, goal off the axis": export(folder / "off", overrides=OFF_AXIS),
        }
        text, stack = size_of(
            folder, HERE / "firmware.c", "hand_step", *plain.includes, *hand_macros(plain)
        )
        rows.append(f"| C by hand, `x4-flyer` | {hand} | 1.00 | {stack} | {text} |")
        for what, package in kinds.items():
            step = f"{package.name}_step"
            count = counted(package, folder, step)
            text, stack = size_of(folder, package.sources[0], step, *package.includes)
            rows.append(f"| {what} | {count} | {count / hand:.2f} | {stack} | {text} |")
    compiler = run("arm-none-eabi-gcc", "--version").stdout.splitlines()[0]
    emulator = run("qemu-system-arm", "--version").stdout.splitlines()[0]
    note = f"\n{compiler}; {emulator}; `{' '.join((*BOARD.flags, *FLAGS))}`."
    return "\n".join([*rows, note])


if __name__ == "__main__":
    report("firmware", table())
