"""Put a table into the README beside, between its markers."""

from __future__ import annotations

import sys
from pathlib import Path

README = Path(__file__).parent / "README.md"


def report(name: str, text: str) -> None:
    """Print a table; with ``--write`` put it between ``<!-- name -->`` and ``<!-- /name -->``."""
    print(text)
    if "--write" in sys.argv[1:]:
        start, end = f"<!-- {name} -->", f"<!-- /{name} -->"
        before, rest = README.read_text(encoding="utf-8").split(start)
        after = rest.split(end)[1]
        README.write_text(f"{before}{start}\n\n{text}\n\n{end}{after}", encoding="utf-8")
