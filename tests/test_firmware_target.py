"""The exported firmware under the tools of its trade: compilers, analysers, emulated boards."""

from __future__ import annotations

import itertools
import random
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from firmware_kit import (
    BOARDS,
    C_WARNINGS,
    FLAGS,
    LENS,
    OFF_AXIS,
    TARGET,
    WARNINGS,
    build_for,
    emulate,
    export,
    kinds,
    load_weight,
    names_header,
    run,
    tool,
)
from harnesses import STUBS, image_topic
from papers_law import PAPERS
from sampling import mostly_whole

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
pytestmark = pytest.mark.slow

M4F = BOARDS["Cortex-M4F"]


def some_kinds(first, of=None):
    """Try a check on one kind of package in five, another one on others; all in `make trials`."""
    some = mostly_whole(kinds() if of is None else of, every=5, first=first)
    return pytest.mark.parametrize("kind", some, ids=str)


def all_c(package):
    return [*package.sources, *sorted((package.folder / "example").glob("*.c"))]


def misra(folder, *sources):
    """Return what cppcheck and its MISRA addon find."""
    command = [tool("cppcheck"), "--addon=misra", "--std=c99", "--quiet", "--inconclusive"]
    command += ["--enable=warning,style,performance,portability", "--template={file}:{line}: {id}"]
    done = subprocess.run(
        [*command, *map(str, sources)], cwd=folder, capture_output=True, text=True, check=True
    )
    return done.stderr.splitlines()


# --- compilers ----------------------------------------------------------------------------------


@some_kinds(first=3)
def test_no_compiler_warns(kind, tmp_path):
    """GCC has warnings that come of optimising; the others read the text alone."""
    package = kind.export(tmp_path / "fw")
    c = (*FLAGS, *C_WARNINGS, *package.includes)
    run(tool("gcc"), *c, "-c", *all_c(package))
    run(tool("clang"), *c, "-fsyntax-only", *all_c(package))
    for compiler in ("g++", "clang++"):
        flags = ("-x", "c++", "-std=c++17", *WARNINGS, *package.includes)
        run(tool(compiler), *flags, "-fsyntax-only", *package.sources)


# --- static analysis ----------------------------------------------------------------------------


@some_kinds(first=3)
def test_cppcheck_finds_no_breach_of_misra(kind, tmp_path):
    package = kind.export(tmp_path / "fw")
    assert misra(package.folder, *(s.name for s in package.sources)) == []


def test_cppcheck_finds_a_planted_breach_of_misra(tmp_path):
    package = export(tmp_path / "fw")
    source = package.sources[0]
    planted = (
        "int f(int a)\n{\n  int b;\n  if ((b = a) != 0) {\n    return\n 010;\n }\n return b;\n}\n"
    )
    source.write_text(source.read_text() + planted)
    found = misra(package.folder, *(s.name for s in package.sources))
    for rule in ("7.1", "13.4", "15.5"):  # octal, assignment as a value, more than one exit
        assert any(line.endswith(f"misra-c2012-{rule}") for line in found), (rule, found)


def eva(package, folder, entry, excess, *options):
    """Return the number of alarms that Frama-C's Eva raises."""
    (folder / "firmware_names.h").write_text(names_header(package))
    macros = {
        "SOURCE": f'\\"{package.name}.c\\"',
        "EXCESS_FROM": excess[0],
        "EXCESS_TO": excess[1],
    }
    defines = " ".join(f"-D{k}={v}" for k, v in macros.items())
    extra = f"-I{package.folder} -I{folder} {defines}"
    done = run(
        *(tool("frama-c"), "-eva", "-main", entry, "-machdep", "gcc_x86_64", *options),
        *(f"-cpp-extra-args={extra}", TARGET / "eva.c"),
        timeout=600,
    )
    assert "100% coverage" in done.stdout or "99% coverage" in done.stdout, done.stdout
    return int(re.search(r"(\d+) alarms? generated", done.stdout)[1])


@pytest.mark.parametrize(
    ("preset", "precision"),
    mostly_whole(itertools.product(PAPERS.values(), ["float32", "float64"]), every=3),
)
def test_eva_proves_finite_outputs_over_the_certified_box_and_alarms_beyond(
    preset, precision, tmp_path
):
    package = export(tmp_path / "fw", preset, precision=precision)
    vehicle = package.manifest["mission"]["vehicle"]
    weight = float(Fraction(vehicle["mass"]) * Fraction(vehicle["gravity"]))
    low, high = (t - weight for t in package.manifest["thrust"])
    assert eva(package, tmp_path, "law_over_box", (low, high), "-eva-precision", "3") == 0
    beyond = (-1.5 * weight, high)  # T from below 0, across T = c q3*
    assert eva(package, tmp_path, "law_over_box", beyond, "-eva-precision", "3") > 0


APART = ("-eva-precision", "3", "-eva-slevel", "1000", "-eva-split-return", "full")
"""Options that keep the cases of the harness apart."""

BEST = {"law": {"feature": "scaled", "goal": "inertial", "force": "measured"}}
CHOICES = [
    (BEST, {}),
    ({"law": {"feature": "scaled"}}, {}),
    (BEST, {"precision": "float64"}),
    (BEST, {"camera": True}),
    ({"law": {"goal": "inertial"}}, {}),
    (BEST, {"sensing": "centroid"}),
    ({"law": {"force": "measured"}}, {}),
    ({**BEST, "interface": {"rate_bandwidth": 20}}, {}),
]


def some_choices(first, every):
    """Prove one thing of one choice in so many, another one of others; all in `make trials`."""
    choices = mostly_whole(CHOICES, every=every, first=first)
    return pytest.mark.parametrize(("overrides", "options"), choices, ids=str)


@some_choices(first=1, every=3)
def test_eva_proves_the_same_of_each_choice_of_a_law(overrides, options, tmp_path):
    package = export(tmp_path / "fw", "x4-flyer", overrides, allow_uncertified=True, **options)
    low, high = (t - load_weight(package) for t in package.manifest["thrust"])
    assert eva(package, tmp_path, "law_over_box", (low, high), *APART) == 0
    beyond = (-1.5 * load_weight(package), high)
    assert eva(package, tmp_path, "law_over_box", beyond, *APART) > 0


@some_choices(first=3, every=len(CHOICES))
def test_eva_proves_a_step_of_each_law_on_anything_finite(overrides, options, tmp_path):
    package = export(tmp_path / "fw", "x4-flyer", overrides, allow_uncertified=True, **options)
    assert eva(package, tmp_path, "step_on_anything", (0, 0), *APART) == 0


@pytest.mark.long
def test_eva_proves_a_step_on_anything_finite_free_of_run_time_errors(tmp_path):
    package = export(tmp_path / "fw")
    assert eva(package, tmp_path, "step_on_anything", (0, 0), *APART) == 0


@pytest.mark.parametrize(
    "check",
    mostly_whole(["spread >= X4_FLYER_SPREAD_LOW", "lift > X4_FLYER_EXCESS_FLOOR"], every=2),
)
def test_eva_finds_a_check_left_out(check, tmp_path):
    package = export(tmp_path / "fw", "x4-flyer", BEST, allow_uncertified=True)
    source = package.sources[0]
    text = source.read_text()
    assert text.count(f"({check}) &&") == 1
    source.write_text(text.replace(f"({check}) &&", ""))
    assert eva(package, tmp_path, "step_on_anything", (0, 0), *APART) > 0


# --- boards -------------------------------------------------------------------------------------


@some_kinds(first=0)
def test_the_object_has_no_soft_double_no_library_and_no_variables(kind, tmp_path):
    package = kind.export(tmp_path / "fw")
    single = package.manifest["precision"] == "float32"
    for name, board in BOARDS.items():
        for source in package.sources:
            made = tmp_path / "made.o"
            flags = (*board.flags, *FLAGS, *package.includes)
            run(tool("arm-none-eabi-gcc"), *flags, "-c", source, "-o", made)
            undefined = run("arm-none-eabi-nm", "--undefined-only", made).stdout.split()[1::2]
            own = {s for s in undefined if s.startswith(package.name)}
            soft = () if single or name == "Cortex-M7" else ("__aeabi_d", "__aeabi_", "sqrt")
            others = {s for s in set(undefined) - own if not (soft and s.startswith(soft))}
            assert not others, others
            _, data, bss = run("arm-none-eabi-size", made).stdout.splitlines()[1].split()[:3]
            assert (data, bss) == ("0", "0")


@some_kinds(first=1)
def test_boards_and_host_compute_the_same_bits(kind, tmp_path, whole):
    """Self-test, 10,000 random inputs and a flight at 1 kHz; the vehicle is simulated on the board.

    Both precisions of the first preset fly for 5 s, the others for 1 s; in `make trials` for 30 s
    and 5 s.
    """
    package = kind.export(tmp_path / "fw")
    steps = (30_000 if whole else 5_000) if kind in kinds()[:2] else (5_000 if whole else 1_000)
    (tmp_path / "firmware_names.h").write_text(names_header(package, steps))
    sources = [TARGET / "bits.c", package.folder / "example" / "vehicle.c"]
    includes = (*package.includes, f"-I{tmp_path}")
    said = set()
    for compiler in ("gcc", "clang"):
        flags = ("-std=gnu99", *FLAGS[1:])
        made = tmp_path / compiler
        run(tool(compiler), *flags, *includes, *sources, *package.sources, "-lm", "-o", made)
        said.add(run(made).stdout)
    for name, board in BOARDS.items():
        image = build_for(board, package, sources, tmp_path / f"{name}.elf")
        said.add(emulate(board, image))
    assert len(said) == 1, said
    assert said.pop().startswith("selftest 0\n")


UNRULY = {
    "fused": ("-ffp-contract=fast",),
    "PX4": ("-freciprocal-math", "-fno-signed-zeros", "-fno-trapping-math"),
    "fast": ("-Ofast",),
}
"""Flags that change the bits of a C that does not forbid it."""


@pytest.mark.parametrize("flags", UNRULY.values(), ids=UNRULY)
def test_the_bits_are_kept_under_flags_that_would_change_them(flags, tmp_path):
    """On a board by GCC, which takes no notice of the pragma of C."""
    package = export(tmp_path / "fw", "x4-flyer", BEST, allow_uncertified=True, camera=True)
    (tmp_path / "firmware_names.h").write_text(names_header(package))
    macros = camera_macros(package, 2000)
    said = {
        emulate(
            M4F, build_for(M4F, package, [TARGET / "camera.c"], tmp_path / "a.elf", *macros, *f)
        )
        for f in ((), flags)
    }
    assert len(said) == 1


@pytest.mark.parametrize("flags", [UNRULY["fused"], UNRULY["fast"]], ids=str)
def test_without_what_forbids_it_the_bits_change_and_the_selftest_says_so(flags, tmp_path):
    package = export(tmp_path / "fw")
    source = package.sources[0]
    text = source.read_text()
    assert text.count("#pragma GCC optimize(") == 1
    source.write_text(text.replace("#pragma GCC optimize(", "#pragma ignored("))
    (tmp_path / "firmware_names.h").write_text(names_header(package, 10))
    sources = [TARGET / "bits.c", package.folder / "example" / "vehicle.c"]
    image = build_for(M4F, package, sources, tmp_path / "fused.elf", *flags, "-Wno-unknown-pragmas")
    assert not emulate(M4F, image).startswith("selftest 0\n")


def test_fusing_by_clang_that_overrules_the_c_is_found_out(tmp_path):
    package = export(tmp_path / "fw")
    for flags, holds in (("-O3",), True), (("-O3", "-ffp-contract=fast"), False):
        calls = f"int main(void) {{ return {package.name}_selftest() != 0U; }}"
        (tmp_path / "main.c").write_text(f'#include "{package.name}.h"\n{calls}\n')
        sources = (tmp_path / "main.c", *package.sources)
        made = tmp_path / "selftest"
        run(tool("clang"), *flags, "-march=haswell", *package.includes, *sources, "-lm", "-o", made)
        assert (subprocess.run([made], check=False).returncode == 0) == holds


@pytest.mark.parametrize(
    "kind", mostly_whole([k for k in kinds() if "float64" not in str(k)], every=4), ids=str
)
def test_the_budgets_of_the_manifest_are_kept(kind, tmp_path):
    """They are about float32."""
    package = kind.export(tmp_path / "fw")
    sys.path.insert(0, str(BENCHMARKS))
    import firmware as benchmark

    step, budgets = f"{package.name}_step", package.manifest["budgets"]
    count = benchmark.counted(package, tmp_path, step)
    text, stack = benchmark.size_of(tmp_path, package.sources[0], step, *package.includes)
    assert 0.8 * budgets["instructions"] < count <= budgets["instructions"]
    assert stack <= budgets["stack_bytes"] <= 160
    assert 0.7 * budgets["flash_bytes"] < text <= budgets["flash_bytes"]


@pytest.mark.parametrize("preset", mostly_whole(PAPERS.values(), every=3, first=1), ids=PAPERS)
def test_a_step_takes_no_more_instructions_than_c_by_hand(preset, tmp_path):
    sys.path.insert(0, str(BENCHMARKS))
    import firmware as benchmark

    package = export(tmp_path / "fw", preset)
    assert benchmark.counted(package, tmp_path, f"{package.name}_step") <= benchmark.by_hand(
        package, tmp_path
    )


def test_c_by_hand_computes_the_same(tmp_path):
    """The reference of the benchmark has the same duties: outputs and status agree."""
    sys.path.insert(0, str(BENCHMARKS))
    import firmware as benchmark

    package = export(tmp_path / "fw")
    (tmp_path / "firmware_names.h").write_text(names_header(package, 1000))
    flags = ("-std=gnu99", *FLAGS[1:], *package.includes, f"-I{tmp_path}")
    macros = benchmark.hand_macros(package)
    sources = [TARGET / "agree.c", BENCHMARKS / "firmware.c", *package.sources]
    run(tool("gcc"), *flags, *macros, *sources, "-lm", "-o", tmp_path / "agree")
    calls, worst = run(tmp_path / "agree").stdout.split()
    assert int(calls) == 100_000
    assert float(worst) < 2e-5, worst


# --- fuzzing ------------------------------------------------------------------------------------

SANITIZERS = ("-fsanitize=undefined,address", "-fno-sanitize-recover=all", "-g", "-O2")


def fuzzer(package, folder):
    """Compile the fuzz harness with its package, libFuzzer and sanitizers."""
    (folder / "firmware_names.h").write_text(names_header(package))
    flags = ("-std=gnu99", "-ffp-contract=off", *SANITIZERS, *package.includes, f"-I{folder}")
    made, sources = folder / "fuzz", (TARGET / "fuzz.c", *package.sources)
    run(tool("clang"), *flags, "-fsanitize=fuzzer", *sources, "-lm", "-o", made)
    return made


def fuzz_random(program, calls):
    """Call a step so often with random bytes; return how often."""
    assert run(program, "alone", calls).stdout == f"{calls} calls\n"
    return calls


def fuzz_guided(program, calls):
    """Let libFuzzer call a step until so many inputs were long enough; return how many."""
    seeds = program.with_name("seeds")
    seeds.mkdir()
    for i in range(16):
        (seeds / str(i)).write_bytes(random.Random(i).randbytes(400))
    total = 0
    while total < calls:
        runs = max(1000, int(1.5 * (calls - total)))
        guided = (f"-runs={runs}", f"-seed={total + 1}", "-max_len=400", "-len_control=0", seeds)
        total += int(re.search(r"(\d+) whole calls", run(program, *guided).stderr)[1])
    return total


@some_kinds(first=2)
def test_fuzzing_finds_no_trap_no_nan_and_no_wrong_status(kind, tmp_path, whole):
    """The first of the ten million calls of `make fuzz`; in `make trials` five times as many."""
    program = fuzzer(kind.export(tmp_path / "fw"), tmp_path)
    calls = 500_000 if whole else 100_000  # what is left out is found within 100,000, see below
    assert fuzz_random(program, calls) == calls
    assert fuzz_guided(program, calls // 5) >= calls // 5


def test_fuzzing_finds_a_check_left_out(tmp_path):
    package = export(tmp_path / "fw")
    source = package.sources[0]
    text = source.read_text()
    mutant = text.replace("(square_length(in->rate) <= X4_FLYER_RATE_SQUARE) &&", "", 1)
    assert mutant != text
    source.write_text(mutant)
    done = subprocess.run(
        [fuzzer(package, tmp_path), "alone", "100000"], capture_output=True, check=False
    )
    assert done.returncode != 0
    assert b"RATE_SQUARE" in done.stderr or b"inside" in done.stderr


# --- adapters and example -----------------------------------------------------------------------


@some_kinds(first=4, of=[k for k in kinds() if "rate_bandwidth" not in str(k)])
def test_adapters_compile_against_the_headers_of_their_trees(kind, tmp_path):
    compile_adapters(kind.export(tmp_path / "fw"), tmp_path)


@pytest.mark.parametrize("camera", [False, True])
def test_adapters_that_take_raw_pixels_compile_too(camera, tmp_path):
    options = {"camera": camera, "pixels": True, "allow_uncertified": True}
    package = export(tmp_path / "fw", "x4-flyer", {"camera.lens": LENS}, **options)
    for source in package.folder.glob("adapters/*/*"):
        text = source.read_text()
        assert ("lens_seen(" in text) == source.name.endswith(("module.cpp", "x4_flyer.c", "r.cpp"))
    compile_adapters(package, tmp_path)


def compile_adapters(package, tmp_path):
    """Compile the adapters of a package by the flags of each tree."""
    name, adapters = package.name, package.folder / "adapters"
    image_topic(package, tmp_path)
    warn = ("-Wall", "-Wextra", "-Werror", "-c", "-o", "made.o")
    tree = (*M4F.flags, "-std=gnu11", "-Os", "-Wdouble-promotion")
    for source in sorted((adapters / "crazyflie").glob("*.c")):
        run(tool("arm-none-eabi-gcc"), *tree, *warn, f"-I{STUBS / 'crazyflie'}", source)
    beside = tmp_path / "beside"
    beside.mkdir()
    (beside / name).symlink_to(package.folder)
    for compiler in ("g++", "clang++"):
        px4 = (f"-I{STUBS / 'px4'}", f"-I{tmp_path}", f"-I{package.folder}")
        module = adapters / "px4" / f"{name}_module.cpp"
        quiet = ("-Wno-unused-parameter", "-Wdouble-promotion", "-Wfloat-equal", "-Wshadow")
        run(tool(compiler), "-std=c++14", *warn, *quiet, *px4, module)
        for source in sorted((adapters / "ardupilot").glob("*.cpp")):
            includes = (f"-I{STUBS / 'ardupilot'}", f"-I{beside}")
            run(tool(compiler), "-std=gnu++11", *warn, *includes, source)


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_the_readme_of_the_package_leads_to_a_running_example(precision, tmp_path):
    tool("cmake")
    package = export(tmp_path / "fw", precision=precision)
    readme = (package.folder / "README.md").read_text()
    blocks = re.findall(r"```sh\n(.*?)```", readme, re.S)
    assert [len(commands.strip().splitlines()) for commands in blocks] == [1, 2]
    for commands in blocks:
        done = run("bash", "-euc", commands, cwd=package.folder)
        assert "selftest: passed" in done.stdout
        assert re.search(r"^ +30\.000 .* 0$", done.stdout, re.M)


def test_the_example_also_flies_off_the_axis(tmp_path):
    package = export(tmp_path / "fw", overrides=OFF_AXIS)
    run(tool("gcc"), *FLAGS, *package.includes, *all_c(package), "-lm", "-o", "fly")
    assert run("./fly", 5).stdout.startswith("selftest: passed")


def test_the_installer_names_the_packages_of_the_tools_used_here():
    script = (Path(__file__).parents[1] / "tools" / "install-system-tools.sh").read_text()
    for package in ("gcc-arm-none-eabi", "libnewlib-arm-none-eabi", "qemu-system-arm", "cppcheck"):
        assert package in script


# --- the camera ---------------------------------------------------------------------------------

WITH_CAMERA = [kind for kind in kinds() if ("camera", True) in kind.options]


def camera_macros(package, calls):
    """Return the flags by which the harness calls a package's camera whatever its prefix."""
    name = package.name
    macros = {
        "CAMERA_HEADER": f'"{name}_camera.h"',
        "OF_POINTS": int(package.manifest["camera"] == "points"),
        "HEADED": int(package.manifest["law"].get("heading") == "image"),
        "CALLS": calls,
        **{f"{t}_t": f"{name}_{t}_t" for t in ("camera", "frame")},
        **{f"camera_{v}": f"{name}_camera_{v}" for v in ("init", "turn")},
        "camera_frame": f"{name}_camera",
    }
    return [f"-D{key}={value}" for key, value in macros.items()]


@pytest.mark.parametrize("kind", mostly_whole(WITH_CAMERA, every=3), ids=str)
def test_boards_and_host_keep_the_same_frames_bit_for_bit(kind, tmp_path):
    """Under sanitizers too, on two compilers and two boards: broken frames, gaps, large turns."""
    package = kind.export(tmp_path / "fw")
    (tmp_path / "firmware_names.h").write_text(names_header(package))
    flags = ("-std=gnu99", *FLAGS[1:], *package.includes, f"-I{tmp_path}")
    macros, said = camera_macros(package, 60_000), set()
    for compiler, extra in (("gcc", ()), ("clang", SANITIZERS)):
        sources = [TARGET / "camera.c", *package.sources]
        made = tmp_path / compiler
        run(tool(compiler), *flags, *macros, *extra, *sources, "-lm", "-o", made)
        said.add(run(made).stdout)
    for name, board in BOARDS.items():
        image = build_for(board, package, [TARGET / "camera.c"], tmp_path / f"{name}.elf", *macros)
        said.add(emulate(board, image))
    assert len(said) == 1, said
    counts = [int(n) for n in re.findall(r"\d+", said.pop().splitlines()[0])]
    assert min(counts) > 100, counts  # each status has come up, of steps and of frames


@pytest.mark.parametrize("kind", WITH_CAMERA, ids=str)
def test_a_camera_takes_no_more_stack_than_a_step_may(kind, tmp_path):
    package = kind.export(tmp_path / "fw")
    made = tmp_path / "camera.o"
    flags = (*M4F.flags, *(f.replace("c99", "gnu99") for f in FLAGS), *package.includes)
    source = package.folder / f"{package.name}_camera.c"
    run(tool("arm-none-eabi-gcc"), *flags, "-fstack-usage", "-c", source, "-o", made)
    frames = made.with_suffix(".su").read_text()
    assert max(int(n) for n in re.findall(r"\t(\d+)\t", frames)) <= 160
