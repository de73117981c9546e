"""A package compiles under every name that it can have, and says what it was told of its rotors."""

from __future__ import annotations

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from firmware_kit import FLAGS, export, run, tool
from hoverproof.errors import InputError
from hoverproof.export.names import HEADERS, WORDS, package_name
from hoverproof.mission.reading import load
from sampling import share_of

STUBS = Path(__file__).parent / "stubs"
CAPTURED = {"capture_output": True, "text": True, "check": False}


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return export(tmp_path_factory.mktemp("package"), name="zzname", tunable=True)


def test_what_c_and_the_package_have_taken_is_refused_with_a_name_that_is_free():
    for name in ("vehicle", "stdint", "Vehicle", "STDINT", "int", "main", "m", "example", "class"):
        with pytest.raises(InputError, match=f"name: '{name}' is taken.*'m_{name}' is free"):
            package_name(name, "x4-flyer")
        assert package_name(f"m_{name}", "x4-flyer") == f"m_{name}"


def test_a_mission_may_be_called_so_all_the_same():
    assert package_name(None, "vehicle") == "m_vehicle"
    assert package_name(None, "stdint") == "m_stdint"
    assert package_name(None, "x4-flyer") == "x4_flyer"


def free(names):
    """Return those names that a package may have."""
    for name in sorted(names):
        try:
            yield package_name(name, "mission")
        except InputError:
            continue


def under(package, name, folder):
    """Write a package as it is under another name: its own stands nowhere for anything else."""
    for path in package.folder.rglob("*"):
        place = folder / str(path.relative_to(package.folder)).replace("zzname", name)
        if path.is_dir():
            place.mkdir(parents=True, exist_ok=True)
            continue
        text = path.read_text("utf-8").replace("zzname", name).replace("ZZNAME", name.upper())
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, "utf-8")


def compile_all(package, names, tmp_path):
    """Compile the package under each name, with the Crazyflie's adapter, and list what fails.

    All files in one go take a fifth of the time, and whatever clashes in one of them clashes there
    too; only where that fails each is compiled alone, as it is meant to be.
    """
    compiler, failures = tool("gcc"), {}

    def complaint(folder, *sources, **options):
        includes = ["-I.", "-Iexample", f"-I{STUBS / 'crazyflie'}"]
        command = [compiler, *FLAGS, "-fsyntax-only", *includes, *sources]
        done = subprocess.run(command, **CAPTURED, cwd=folder, **options)
        return done.stderr[:300] or "failed" if done.returncode else ""

    for name in names:
        folder = tmp_path / "package"
        under(package, name, folder)
        sources = [f"{name}.c", f"{name}_selftest.c", "example/main.c", "example/vehicle.c"]
        sources.append(f"adapters/crazyflie/controller_{name}.c")
        together = "".join(f'#include "{source}"\n' for source in sources)
        if complaint(folder, "-x", "c", "-", input=together):
            failures[name] = complaint(folder, *sources)
        shutil.rmtree(folder)
    return {name: said for name, said in failures.items() if said}


def test_a_name_that_cannot_be_compiled_is_told(package, tmp_path):
    assert set(compile_all(package, ["stdint", "zzother"], tmp_path)) == {"stdint"}


def headers_seen(package):
    """Return the stems of all headers that the compiler opens for the package."""
    main = package.folder / "example/main.c"
    text = run(tool("gcc"), "-M", "-I", package.folder, main, *package.sources).stdout
    return {Path(word).stem for word in text.split() if word.endswith(".h")} - {"zzname"}


def test_under_the_name_of_any_header_that_it_opens_a_package_is_refused_or_compiles(
    package, tmp_path
):
    tried = list(free(headers_seen(package) - {"zzname_params"}))
    assert tried  # headers in folders of their own are no danger
    assert compile_all(package, tried, tmp_path) == {}


@pytest.mark.slow
def test_under_any_word_of_c_or_of_its_own_a_package_is_refused_or_compiles(
    package, tmp_path, whole
):
    """Under one of twelve of them, and with `make trials` under each."""
    sources = [p for p in package.folder.rglob("*") if p.suffix in (".c", ".h")]
    own = set(re.findall(r"\b[A-Za-z]\w*", "".join(p.read_text("utf-8") for p in sources)))
    short = {name for name in own if "zzname" not in name.lower()}
    tried = list(free(short | set(f"{WORDS} {HEADERS}".split())))
    assert len(tried) > 100
    assert compile_all(package, share_of(tried, whole, every=12), tmp_path) == {}


def test_an_export_under_a_taken_name_writes_nothing(tmp_path):
    with pytest.raises(InputError, match="name"):
        export(tmp_path / "package", name="vehicle")
    assert not (tmp_path / "package").exists()


# --- what its README says of the rotors ----------------------------------------------------------


@pytest.mark.parametrize(
    ("overrides", "options", "words"),
    [
        ({}, {}, "0 to 47.04 N each (assumed: half the weight, as the mission names none)"),
        (
            {"rotors.min_thrust": 1, "rotors.max_thrust": 40},
            {},
            "1 to 40 N each (from [rotors] of the mission)",
        ),
        (
            {"rotors.max_thrust": 40},
            {},
            "0 to 40 N each (from [rotors] of the mission, which names no lowest)",
        ),
        (
            {"rotors.max_thrust": 40},
            {"rotor_limits": (Fraction(2), Fraction(39))},
            "2 to 39 N each (given to the export)",
        ),
    ],
)
def test_the_readme_says_where_the_limits_of_the_rotors_come_from(
    overrides, options, words, tmp_path
):
    made = export(tmp_path, overrides=overrides, **options)
    assert words in " ".join((made.folder / "README.md").read_text("utf-8").split())


# --- its build file ------------------------------------------------------------------------------


def flags_for(package, compiler, build):
    """Return the compiler's flags and the command of the linker that CMake makes."""
    forced = [f"-DCMAKE_C_COMPILER_{k}" for k in (f"ID={compiler}", "FORCED=1", "ID_RUN=1")]
    run(tool("cmake"), "-S", package.folder, "-B", build, "-G", "Unix Makefiles", *forced)
    flags = (build / "CMakeFiles/zzname.dir/flags.make").read_text("utf-8")
    return flags, (build / "CMakeFiles/example.dir/link.txt").read_text("utf-8")


def test_the_build_file_gives_a_compiler_the_flags_that_it_knows(package, tmp_path):
    flags, link = flags_for(package, "GNU", tmp_path / "gnu")
    assert "-ffp-contract=off" in flags
    assert " -lm" in link
    flags, link = flags_for(package, "MSVC", tmp_path / "msvc")
    assert "/fp:strict" in flags
    assert "-f" not in flags.split("C_FLAGS")[1]
    assert " -lm" not in link


def test_a_mission_is_named_in_its_package_even_if_the_name_is_taken(tmp_path):
    made = export(tmp_path, overrides={"name": "vehicle"})
    assert made.name == "m_vehicle"
    assert load("x4-flyer").name == "x4-flyer"


@pytest.mark.parametrize("mission", ["x" * 64, "9" * 64, "-" * 64, "a.b-" * 10])
def test_a_long_name_of_a_mission_is_cut_short(mission):
    name = package_name(None, mission)
    assert re.fullmatch(r"[A-Za-z]\w{0,19}", name)
