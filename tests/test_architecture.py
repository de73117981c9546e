"""The house keeps its order: imports run downward, the checker stands alone."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

import hoverproof

HOUSE = Path(hoverproof.__file__).parent
FLOORS = [
    {"errors"},
    {"compilers", "files", "quantities", "spread"},
    {"conditions"},
    {"mission", "algebra"},
    {"editing"},
    {"plant"},
    {"servo"},
    {"certification", "simulation", "export", "paper"},
    {"firmware_flight", "plausibility"},
    {"show"},
    {"reporting"},
    {"cli"},
    {"__main__"},
]
ANYWHERE = {"checker", "__init__"}  # the checker imports nothing; the package imports by need
MODULES = sorted(HOUSE.rglob("*.py"))


def floor(part):
    return next(i for i, names in enumerate(FLOORS) if part in names)


def imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            if node.module == "hoverproof":
                yield from (f"hoverproof.{alias.name}" for alias in node.names)
            else:
                yield node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(HOUSE)))
def test_imports_run_downward(path):
    part = path.relative_to(HOUSE).parts[0].removesuffix(".py")
    if part in ANYWHERE:
        return
    for module in imports(path):
        package, *rest = module.split(".")
        if package != "hoverproof" or not rest or rest[0] in {"checker", "__version__"}:
            continue
        if rest[0] != part:
            assert floor(rest[0]) < floor(part), f"{part} imports {rest[0]}"


def test_the_checker_imports_the_standard_library_alone():
    assert set(imports(HOUSE / "checker.py")) <= sys.stdlib_module_names | {"collections.abc"}


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(HOUSE)))
def test_a_module_fits_in_one_reading(path):
    # the checker has to be a single file, and the lemmas are a list to be read through
    most = {"checker.py": 1560, "lemmas.py": 600}.get(path.name, 460)
    assert len(path.read_text(encoding="utf-8").splitlines()) <= most
