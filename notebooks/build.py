"""Make the notebooks from the scripts in derivations/ and examples/, executed.

Those of derivations/ print text alone, and come out with the same bytes every time.

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


def build(script: Path, folder: Path) -> Path:
    """Execute a script in py:percent format as a notebook, and write it with its outputs.

    Parameters
    ----------
    script : Path
    folder : Path
        Where the notebook is to be.

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
    path = folder / f"{script.stem}.ipynb"
    nbformat.write(notebook, path)
    return path


if __name__ == "__main__":
    for scripts, folder in (("derivations", HERE), ("examples", HERE / "examples")):
        for script in sorted((HERE.parent / scripts).glob("*.py")):
            print(build(script, folder).relative_to(HERE.parent))
