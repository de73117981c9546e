"""Compile generated code with a vector in the place of each number: a whole vehicle in a lane."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Mapping, Sequence
from functools import cache

import casadi as ca

from hoverproof.simulation.compiled import PREAMBLE, c_file, define, generate, library

OPERATIONS = ("fabs", "fmin", "fmax", "sqrt", "floor", "sq")
"""Functions that lanes.h has for vectors; beside them a graph may use + - * / only."""


def vector_source(
    functions: Sequence[ca.Function], driver: str, constants: Mapping[str, int]
) -> str:
    """Return C text in which generated functions work on vectors, with a driver below them.

    Parameters
    ----------
    functions : sequence of Function
        SX functions of the operations + - * / and `OPERATIONS`, all inputs and outputs dense.
    driver : str
        Name of a C file of this folder.
    constants : mapping
        Bare numbers that the driver finds as HP_NAME; ``LANES`` overrules the lane width.
    """
    head = re.compile(
        r"^(?:static|CASADI_SYMBOL_EXPORT) int \w+\(const casadi_real\*\* arg.*?^}\n", re.M | re.S
    )
    bodies = "static " + "static ".join(
        re.sub(r"^(static|CASADI_SYMBOL_EXPORT) ", "", text)
        for text in head.findall(generate(functions))
    )
    bodies = re.sub(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg[\1][\2]", bodies)
    bodies = re.sub(r"if \(res\[\d+\]!=0\) ", "", bodies)
    number = r"-?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
    bodies = re.sub(rf"(?m)^(\s*\w+)=({number});", r"\1=(casadi_real){0}+(\2);", bodies)
    bodies = re.sub(rf"(?<![\w.])(?:casadi_)?({'|'.join(OPERATIONS)})\(", r"hp_\1(", bodies)
    return f"{PREAMBLE}{define(constants)}{c_file('lanes.h')}\n{bodies}\n{c_file(driver)}"


@cache
def vector_library(source: str, compiler: str) -> ctypes.CDLL | None:
    """Return the compiled text of `vector_source`, or None if that fails."""
    return library(source, compiler, "batch") if compiler else None
