"""The house keeps its order: imports run downward, the checker stands alone."""

from __future__ import annotations

import ast
import graphlib
import sys
from pathlib import Path

import pytest

import hoverproof

HOUSE = Path(hoverproof.__file__).parent
FLOORS = [
    {"errors", "version"},
    {"compilers", "files", "spread"},
    {"mission", "algebra"},
    {"plant"},
    {"servo"},
    {"certification", "simulation", "export", "paper"},
    {"design"},
    {"firmware", "plausibility"},
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
        if package != "hoverproof" or rest[:1] == ["checker"]:
            continue
        assert rest, f"{part} imports the package itself, which imports everything"
        if rest[0] != part:
            assert floor(rest[0]) < floor(part), f"{part} imports {rest[0]}"


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
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            taken |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            taken |= {alias.name for alias in node.names}
    return taken & names


ANSWERS = HOUSE / "cli" / "answers"
COMMANDS = [path for path in MODULES if path.is_relative_to(HOUSE / "cli")]


@pytest.mark.parametrize("path", COMMANDS, ids=lambda p: str(p.relative_to(HOUSE)))
def test_what_a_command_says_stands_in_its_answer(path):
    """A command itself prints nothing but progress and errors, on stderr."""
    if path == ANSWERS / "answer.py":
        return
    for name, call in calls(path):
        to_stderr = any(option.arg == "file" for option in call.keywords)
        assert name != "print" or to_stderr, f"line {call.lineno}"


@pytest.mark.parametrize("path", sorted(ANSWERS.glob("*.py")), ids=lambda p: p.name)
def test_an_answer_writes_no_file(path):
    assert not [name for name, _ in calls(path) if name.startswith(("save", "write", "open"))]
    assert "hoverproof.files" not in set(imports(path))


@pytest.mark.parametrize("path", COMMANDS, ids=lambda p: str(p.relative_to(HOUSE)))
def test_a_command_parses_calls_and_answers(path):
    """It may have many options, with their help; what it does with them is short."""
    for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(function, ast.FunctionDef):
            does = function.body[1:] if ast.get_docstring(function) else function.body
            lines = does[-1].end_lineno - does[0].lineno + 1 if does else 0
            assert lines <= 36, f"{function.name} has {lines} lines"


def calls(path):
    """Yield each call in a module, with the last part of the name of what is called."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            yield ast.unparse(node.func).split(".")[-1], node


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(HOUSE)))
def test_the_closed_loop_is_put_together_in_one_place(path):
    """Others take it from servo/loop.py; the paper's equations are what is judged by the model."""
    if path.relative_to(HOUSE).parts[0] in ("plant", "servo", "paper"):
        return
    tree = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    names = {a.name for node in tree if isinstance(node, ast.ImportFrom) for a in node.names}
    assert not names & {"state_rate", "linearised_loop"}


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(HOUSE)))
def test_the_gains_of_a_law_are_listed_in_one_place(path):
    """Others ask the law; the checker has to stand alone, and the paper names what it prints."""
    if path.name == "checker.py" or path.is_relative_to(HOUSE / "paper"):
        return
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Tuple | ast.List | ast.Set):
            names = {part.value for part in node.elts if isinstance(part, ast.Constant)}
            assert not {"k1", "k2"} <= names, f"line {node.lineno}"


def test_the_checker_imports_the_standard_library_alone():
    assert set(imports(HOUSE / "checker.py")) <= sys.stdlib_module_names | {"collections.abc"}


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(HOUSE)))
def test_a_module_fits_in_one_reading(path):
    # the checker has to be a single file, and the lemmas are a list to be read through
    most = {"checker.py": 1448, "lemmas.py": 600}.get(path.name, 460)
    assert len(path.read_text(encoding="utf-8").splitlines()) <= most
