"""Every public function and class says what it takes: each argument, with its shape or unit."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re
import types
import typing
from pathlib import Path

import docstring_parser
import pytest
import xarray as xr
from cyclopts import Parameter
from pydantic import BaseModel

import hoverproof
from hoverproof import checker
from hoverproof.cli.console import app

MODULES = [
    "hoverproof",
    *sorted(
        module.name
        for module in pkgutil.walk_packages(hoverproof.__path__, "hoverproof.")
        if not re.match(r"hoverproof\.(__main__|cli)\b", module.name)  # commands: a test below
    ),
]
TYPING_ONLY = {"Mission": hoverproof.mission.sections.Mission, "Path": Path, "xr": xr}
"""Names in annotations that the package imports for a type checker alone."""
CHECKER = {"check", "check_file", "digest", "main", "statement", "Rejected", "Unreadable"}
"""What the checker offers; the rest is the inside of a program that stands alone."""

NUMERIC = re.compile(r"\b(float|int|Fraction|Array|NDArray|ndarray|SX|DM|Row|Rows|Matrix)\b")
SHAPE = r"\([\dnmk]+,[^)]*\)|\(\.\.\., |any shape|one shape|\bscalar\b"
UNIT = r"\b(m|kg|s|N|rad|deg|m/s|1/m|1/s|kg/s|N m|N/s|m/s²|rad/s²?|kg m/s|kg m²(/s)?)\b|m²|%"
PURE = r"\b(dimensionless|(bare |exact )?numbers?|seconds|steps|boxes|bits|digits|coordinates)\b"
MEASURED = re.compile(f"{SHAPE}|{UNIT}|{PURE}", re.IGNORECASE)


def public(module_name):
    """Yield (name, object) of the functions, classes and methods that a module defines."""
    module = importlib.import_module(module_name)
    for name, thing in vars(module).items():
        if name.startswith("_") or getattr(thing, "__module__", None) != module_name:
            continue
        if module is checker and name not in CHECKER:
            continue
        if inspect.isfunction(thing) or inspect.isclass(thing):
            yield name, thing
        if inspect.isclass(thing):
            for key, value in vars(thing).items():
                function = getattr(value, "__func__", value)
                inherited = not function.__doc__ and any(hasattr(b, key) for b in thing.__bases__)
                if inspect.isfunction(function) and not key.startswith("_") and not inherited:
                    yield f"{name}.{key}", function


EVERYTHING = [(m, name, thing) for m in MODULES for name, thing in public(m)]


def faults(wanted, fault):
    """Return what is at fault with each thing that is wanted, and has a fault, by its name."""
    chosen = {f"{m}.{name}": thing for m, name, thing in EVERYTHING if wanted(thing)}
    assert len(chosen) > 100
    return {name: told for name, thing in chosen.items() if (told := fault(thing))}


def documented(thing):
    """Return the entries of the sections Parameters and Attributes: name to its whole text."""
    text = inspect.getdoc(thing) or ""
    if inspect.isclass(thing) and issubclass(thing, BaseModel):  # a line names all keys, with units
        return {key: text for key in thing.model_fields if re.search(rf"\b{key}\b", text)}
    doc = docstring_parser.parse(text, docstring_parser.DocstringStyle.NUMPYDOC)
    bases = thing.__bases__ if dataclasses.is_dataclass(thing) else ()
    entries = {k: v for b in bases if dataclasses.is_dataclass(b) for k, v in documented(b).items()}
    for entry in doc.params:
        for name in entry.arg_name.split(","):
            text = f"{entry.type_name or ''} {entry.description or ''}"
            entries[name.strip().lstrip("*")] = text
    return entries


def arguments(thing):
    """Return the arguments of a function, or the fields of a class: name to annotation."""
    if inspect.isfunction(thing):
        taken = inspect.signature(thing).parameters
        return {n: str(p.annotation) for n, p in taken.items() if n not in ("self", "cls")}
    if issubclass(thing, BaseModel):
        return {name: str(field.annotation) for name, field in thing.model_fields.items()}
    if dataclasses.is_dataclass(thing):
        return {f.name: str(f.type) for f in dataclasses.fields(thing) if f.name[0] != "_"}
    if issubclass(thing, tuple) and hasattr(thing, "_fields"):
        return {n: str(thing.__annotations__[n]) for n in thing._fields}
    if "__init__" in vars(thing):
        return arguments(thing.__init__)
    return {}


def numbers(thing):
    """Return the documented entries of the numeric arguments; exact arithmetic knows no units."""
    if thing.__module__.startswith("hoverproof.algebra"):
        return {}
    entries = documented(thing)
    return {
        name: entries[name]
        for name, annotation in arguments(thing).items()
        if NUMERIC.search(annotation) and "Callable" not in annotation and name in entries
    }


def test_each_argument_is_documented():
    def fault(thing):
        if not inspect.getdoc(thing):
            return "has no docstring"
        return sorted(arguments(thing).keys() - documented(thing).keys())

    assert faults(lambda thing: True, fault) == {}


def test_each_number_has_a_shape_or_a_unit():
    def fault(thing):
        return {n: e for n, e in numbers(thing).items() if not MEASURED.search(e)}

    assert faults(numbers, fault) == {}


def test_no_argument_is_documented_that_does_not_exist():
    def takes(thing):
        return inspect.isfunction(thing) and documented(thing)

    def fault(thing):
        return sorted(documented(thing).keys() - arguments(thing).keys())

    assert faults(takes, fault) == {}


def returned(annotation):
    """Yield the classes of hoverproof in an annotation, with those in their own fields."""
    for part in typing.get_args(annotation) or (annotation,):
        if isinstance(part, types.GenericAlias | types.UnionType) or typing.get_args(part):
            yield from returned(part)
        elif inspect.isclass(part) and part.__module__.startswith("hoverproof"):
            yield part


@pytest.mark.parametrize("name", sorted(set(hoverproof.__all__) - {"__version__"}))
def test_what_a_verb_returns_is_in_the_reference(name):
    """The pages of the documentation list modules; here is that nothing falls between."""
    verb = getattr(hoverproof, name)
    assert getattr(verb, "__module__", hoverproof._HOMES[name][0]) in MODULES
    if inspect.isfunction(verb):
        for result in returned(typing.get_type_hints(verb, localns=TYPING_ONLY)["return"]):
            assert result.__module__ in MODULES
            assert inspect.getdoc(result)


@pytest.mark.parametrize("command", sorted(name for name in app if not name.startswith("-")))
def test_each_option_of_a_command_has_a_help(command):
    function = app[command].default_command
    assert inspect.getdoc(function)
    assert "Example: `hoverproof " in inspect.getdoc(function)
    hints = typing.get_type_hints(function, include_extras=True)
    for name in inspect.signature(function).parameters:
        notes = [n for n in typing.get_args(hints[name])[1:] if isinstance(n, Parameter)]
        assert any(n.help for n in notes), name
