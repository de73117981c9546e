"""The worked examples run alone, and the notebooks are the same, executed, with their pictures."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import jupytext
import nbformat
import pytest

from firmware_kit import tool

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
NOTEBOOKS = sorted((ROOT / "notebooks" / "examples").glob("*.ipynb"))
NUMBER = re.compile(r"-?\d+(?:/\d+|(?:\.\d+)?(?:e[-+]?\d+)?)")
NEARLY = 0.05
"""Processors round differently, and a search in floating point may then end elsewhere."""
each = pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: p.stem)
LARGE = "machinevisiontoolbox"
"""What an example needs that `make trials` alone installs and runs."""
LONG = {
    "flight",
    "from_the_papers_gains_to_gains_that_fly",
    "where_may_i_switch_it_on",
    "why_sampling_is_no_proof",
}
"""What `make trials` alone runs for its time."""
RUN = [
    pytest.param(
        p,
        marks=(pytest.mark.whole,)
        if p.stem in LONG or LARGE in p.read_text(encoding="utf-8")
        else (),
    )
    for p in SCRIPTS
]


def notebook_of(script):
    path = ROOT / "notebooks" / "examples" / f"{script.stem}.ipynb"
    return nbformat.read(path, as_version=4)


def words_and_numbers(text):
    """Return what is printed with # for each number, and the numbers, fractions divided out."""
    text = text.replace("<IPython.core.display.Image object>", "")
    text = re.sub(r"\b(?=\d*[a-f])[0-9a-f]{16,64}\b", "a hash", text)
    numbers = [float(Fraction(n)) for n in NUMBER.findall(text)]
    return " ".join(NUMBER.sub("#", text).split()), numbers


def test_every_example_has_its_notebook_and_the_other_way_round():
    assert [p.stem for p in SCRIPTS] == [p.stem for p in NOTEBOOKS] != []


@pytest.mark.slow
@pytest.mark.parametrize("script", RUN, ids=[p.stem for p in SCRIPTS])
def test_an_example_runs_alone_and_leaves_nothing_behind(script):
    source = script.read_text(encoding="utf-8")
    if LARGE in source:
        pytest.importorskip(LARGE, reason="not run: it is in the extra `compare`")
    if "hp.Firmware(" in source:
        tool("cc")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not list(Path.cwd().iterdir())
    outputs = [o for c in notebook_of(script).cells for o in c.get("outputs", [])]
    printed = "".join(o.text for o in outputs if o.output_type == "stream")
    kept, now = words_and_numbers(printed), words_and_numbers(done.stdout)
    assert kept[0] == now[0], "run `make notebooks`"
    assert now[1] == pytest.approx(kept[1], rel=NEARLY), "run `make notebooks`"


@each
def test_a_notebook_has_the_cells_of_its_example(script):
    cells = jupytext.read(script, fmt="py:percent").cells
    for text, cell in zip(cells, notebook_of(script).cells, strict=True):
        assert (text.cell_type, text.source) == (cell.cell_type, cell.source), "`make notebooks`"


@each
def test_a_notebook_is_executed_and_shows_a_picture_for_each_figure(script):
    notebook = notebook_of(script)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == [*range(1, len(code) + 1)]
    for cell in code:
        kinds = [kind for o in cell.outputs for kind in o.get("data", {})]
        drawn = len(re.findall(r"^\w+_figure\(", cell.source, flags=re.M))
        assert kinds.count("image/png") == drawn
        assert kinds.count("image/gif") == cell.source.count("display(Image(")
        assert all(o.output_type != "error" and o.get("name") != "stderr" for o in cell.outputs)
    text = json.dumps([[cell.source, cell.outputs] for cell in code if "Image(" not in cell.source])
    assert not re.search(r"/(home|root|tmp|work|Users)/\w+/", text)
    assert notebook.metadata.keys() == {"kernelspec", "language_info"}
