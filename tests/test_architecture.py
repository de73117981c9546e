"""The house keeps its order: imports run downward, the checker stands alone."""

from __future__ import annotations

import ast
import functools
import graphlib
import re
import sys
from pathlib import Path

import pytest

import hoverproof

HOUSE = Path(hoverproof.__file__).parent
FLOORS = [
    {"errors", "version"},
    {"compilers", "descent", "files", "sequential", "spread"},
    {"templates"},
    {"mission", "algebra"},
    {"plant"},
    {"servo"},
    {"certification", "simulation", "export", "paper"},
    {"design"},
    {"firmware", "plausibility"},
    {"mavlink", "eyes", "audit"},
    {"show"},
    {"reporting"},
    {"cli"},
    {"__main__"},
]
ANYWHERE = {"checker", "__init__"}  # the checker imports nothing; the package imports by need
MODULES = sorted(HOUSE.rglob("*.py"))


def floor(part):
    return next(i for i, names in enumerate(FLOORS) if part in names)


@functools.cache
def nodes(path):
    """Return all nodes of the syntax of a module."""
    return list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


def faults(fault, paths=MODULES):
    """Return what is at fault with each module that has a fault, by its name."""
    assert paths
    found = {str(p.relative_to(HOUSE)): list(fault(p)) for p in paths}
    return {name: told for name, told in found.items() if told}


def imports(path):
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module:
            if node.module == "hoverproof":
                yield from (f"hoverproof.{alias.name}" for alias in node.names)
            else:
                yield node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@pytest.mark.slow
def test_imports_run_downward():
    def fault(path):
        part = path.relative_to(HOUSE).parts[0].removesuffix(".py")
        if part in ANYWHERE:
            return
        for module in imports(path):
            package, *rest = module.split(".")
            if package != "hoverproof" or rest[:1] == ["checker"]:
                continue
            if not rest:
                yield "imports the package itself, which imports everything"
            elif rest[0] != part and floor(rest[0]) >= floor(part):
                yield f"imports {rest[0]}"

    assert faults(fault) == {}


def test_CONTRIBUTING_lists_the_floors_of_the_house_from_the_top_down():
    guide = (Path(__file__).parent.parent / "CONTRIBUTING.md").read_text(encoding="utf-8")
    listed = guide.partition("How the house is built")[2].partition("What is added")[0]
    rows = [
        row[1].split(", ") for row in re.finditer(r"(?m)^    ([a-z]+(?:, [a-z]+)*)(?:  |$)", listed)
    ]
    floors = [{floor(part) for part in row} for row in rows]
    assert all(len(found) == 1 for found in floors)
    assert floors == sorted(floors, key=max, reverse=True)
    assert {part for row in rows for part in row} == set().union(*FLOORS) - {"__main__"}


def test_no_modules_import_each_other_in_a_circle():
    """Imports inside functions and those for types alone count too."""
    names = {".".join(("hoverproof", *p.relative_to(HOUSE).with_suffix("").parts)) for p in MODULES}
    graph = {}
    for path in MODULES:
        name = ".".join(("hoverproof", *path.relative_to(HOUSE).with_suffix("").parts))
        if path.name != "__init__.py":  # a package that imports by need
            graph[name] = names_taken(path, names) - {name}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        pytest.fail(" - ".join(error.args[1]))


def names_taken(path, names):
    """Return the modules that a module imports; `from package import module` is one."""
    taken = set()
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module:
            taken |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            taken |= {alias.name for alias in node.names}
    return taken & names


ANSWERS = HOUSE / "cli" / "answers"
COMMANDS = [path for path in MODULES if path.is_relative_to(HOUSE / "cli")]


def test_what_a_command_says_stands_in_its_answer():
    """A command itself prints nothing but progress and errors, on stderr."""

    def fault(path):
        for name, call in calls(path):
            if name == "print" and not any(option.arg == "file" for option in call.keywords):
                yield f"line {call.lineno}"

    assert faults(fault, [p for p in COMMANDS if p != ANSWERS / "answer.py"]) == {}


def test_an_answer_writes_no_file():
    def fault(path):
        yield from (n for n, _ in calls(path) if n.startswith(("save", "write", "open")))
        yield from {"hoverproof.files"} & set(imports(path))

    assert faults(fault, sorted(ANSWERS.glob("*.py"))) == {}


def test_a_command_parses_calls_and_answers():
    """It may have many options, with their help; what it does with them is short."""

    def fault(path):
        for function in nodes(path):
            if isinstance(function, ast.FunctionDef):
                does = function.body[1:] if ast.get_docstring(function) else function.body
                lines = does[-1].end_lineno - does[0].lineno + 1 if does else 0
                if lines > 36:
                    yield f"{function.name} has {lines} lines"

    assert faults(fault, COMMANDS) == {}


def calls(path):
    """Yield each call in a module, with the last part of the name of what is called."""
    for node in nodes(path):
        if isinstance(node, ast.Call):
            yield ast.unparse(node.func).split(".")[-1], node


def test_the_closed_loop_is_put_together_in_one_place():
    """Others take it from servo/loop.py; the paper's equations are what is judged by the model."""

    def fault(path):
        taken = [node for node in nodes(path) if isinstance(node, ast.ImportFrom)]
        yield from {a.name for n in taken for a in n.names} & {"state_rate", "linearised_loop"}

    inside = ("plant", "servo", "paper")
    assert faults(fault, [p for p in MODULES if p.relative_to(HOUSE).parts[0] not in inside]) == {}


def test_the_gains_of_a_law_are_listed_in_one_place():
    """Others ask the law; the checker has to stand alone, and the paper names what it prints.

    Coefficients of distortion happen to have such names too.
    """

    def fault(path):
        for node in nodes(path):
            if isinstance(node, ast.Tuple | ast.List | ast.Set):
                names = {part.value for part in node.elts if isinstance(part, ast.Constant)}
                if {"k1", "k2"} <= names:
                    yield f"line {node.lineno}"

    def own(path):
        alone = (HOUSE / "checker.py", HOUSE / "mission" / "camera.py")
        return path in alone or path.is_relative_to(HOUSE / "paper")

    assert faults(fault, [path for path in MODULES if not own(path)]) == {}


def test_the_checker_imports_the_standard_library_alone():
    assert set(imports(HOUSE / "checker.py")) <= sys.stdlib_module_names | {"collections.abc"}


LONG = {
    "derive_form": "a derivation, read from top to bottom",
    "_scheme": "a derivation, read from top to bottom",
    "_fly_slowly": "it follows batch.c, which is held to the same bits",
}
"""Functions of more than 60 lines, and why."""


def test_a_function_fits_on_a_screen():
    """Without its signature and docstring, which may have much to say."""

    def fault(path):
        for function in nodes(path):
            if isinstance(function, ast.FunctionDef) and function.name not in LONG:
                does = function.body[1:] if ast.get_docstring(function) else function.body
                if does and does[-1].end_lineno - does[0].lineno >= 60:
                    yield function.name

    assert faults(fault) == {}


def test_a_module_fits_in_one_reading():
    def fault(path):
        most = 3200 if path == HOUSE / "checker.py" else 400  # the checker has to be a single file
        lines = len(path.read_text(encoding="utf-8").splitlines())
        if lines > most:
            yield f"{lines} lines, {most} at most"

    assert faults(fault) == {}
