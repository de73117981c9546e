"""Make the notebooks from the scripts in derivations/: executed, with the same bytes every time.

Run it as ``make notebooks``.
"""

from __future__ import annotations

from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).parent
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def build(script: Path) -> Path:
    """Execute a script in py:percent format as a notebook, and write it with its outputs.

    Parameters
    ----------
    script : Path

    Returns
    -------
    Path
        The notebook.
    """
    notebook = nbformat.v4.new_notebook(metadata=METADATA)
    notebook.cells = jupytext.read(script, fmt="py:percent").cells
    client = NotebookClient(
        notebook,
        kernel_name="python3",
        extra_arguments=["--log-level=ERROR"],
        coalesce_streams=True,
        record_timing=False,
    )
    client.execute()
    notebook.metadata = nbformat.from_dict(METADATA)
    for i, cell in enumerate(notebook.cells, start=1):
        cell.id, cell.metadata = f"cell-{i:02d}", nbformat.from_dict({})
    nbformat.validate(notebook)
    path = HERE / f"{script.stem}.ipynb"
    nbformat.write(notebook, path)
    return path


if __name__ == "__main__":
    for script in sorted((HERE.parent / "derivations").glob("[0-9]*.py")):
        print(f"notebooks/{build(script).name}")
