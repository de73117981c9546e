"""The derivations run alone, and the notebooks are the same, executed."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import jupytext
import nbformat
import pytest

from sampling import mostly_whole

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "derivations").glob("*.py"))
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
each = pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: p.stem)


def cells_of(script):
    return jupytext.read(script, fmt="py:percent").cells


def notebook_of(script):
    return nbformat.read(ROOT / "notebooks" / f"{script.stem}.ipynb", as_version=4)


def code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def printed(notebook):
    return "".join(output.text for cell in code(notebook) for output in cell.outputs)


def test_every_script_has_its_notebook_and_the_other_way_round():
    assert [p.stem for p in SCRIPTS] == [p.stem for p in NOTEBOOKS]
    assert [p.stem[:2] for p in SCRIPTS] == [f"{i:02d}" for i in range(1, len(SCRIPTS) + 1)]


@pytest.mark.slow
@pytest.mark.parametrize("script", mostly_whole(SCRIPTS, every=2), ids=lambda p: p.stem)
def test_a_script_runs_alone_and_prints_what_its_notebook_shows(script):
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert done.stdout == printed(notebook_of(script)), "run `make notebooks`"
    assert not list(Path.cwd().iterdir())


@each
def test_a_notebook_has_the_cells_of_its_script(script):
    pair = zip(cells_of(script), notebook_of(script).cells, strict=True)
    for text, cell in pair:
        assert (text.cell_type, text.source) == (cell.cell_type, cell.source), "`make notebooks`"


@each
def test_a_notebook_is_executed_in_order_without_an_error(script):
    notebook = notebook_of(script)
    nbformat.validate(notebook)
    assert [cell.execution_count for cell in code(notebook)] == [*range(1, len(code(notebook)) + 1)]
    for cell in code(notebook):
        assert all((o.output_type, o.name) == ("stream", "stdout") for o in cell.outputs)
        assert bool(cell.outputs) == ("print(" in cell.source)


@each
def test_a_notebook_tells_nothing_of_the_machine(script):
    notebook = notebook_of(script)
    assert notebook.metadata == {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    assert all(cell.metadata == {} for cell in notebook.cells)
    text = json.dumps(notebook)
    assert not re.search(r"/(home|root|tmp|work|Users)/|0x[0-9a-f]{6}", text)


@each
def test_what_is_called_proved_is_asserted(script):
    for cell in code(notebook_of(script)):
        claims = [line for line in cell.source.splitlines() if "proved" in line]
        if claims and "import" not in cell.source:
            assert "assert " in cell.source
    assert printed(notebook_of(script)).count("proved") >= 5
