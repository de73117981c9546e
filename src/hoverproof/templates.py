"""Templates of pages and firmware: strict, and compiled once on a machine."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import jinja2
from jinja2.bccache import Bucket

from hoverproof.files import cache_folder, keep, kept


class _Compiled(jinja2.BytecodeCache):
    """Compiled templates in the cache of the user, each under all that it is compiled from."""

    def __init__(self, options: dict[str, Any]) -> None:
        self.how = (jinja2.__version__, sorted(options.items()))

    def load_bytecode(self, bucket: Bucket) -> None:
        content = kept(self._place(bucket))
        if content is not None:
            bucket.bytecode_from_string(content)

    def dump_bytecode(self, bucket: Bucket) -> None:
        keep(self._place(bucket), bucket.bytecode_to_string())

    def _place(self, bucket: Bucket) -> Path:
        parts = (bucket.key, bucket.checksum, self.how)
        return cache_folder() / f"{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}.template"


def templates(package: str, folder: str, **options: bool) -> jinja2.Environment:
    """Return the templates of a package, in which a name that is not given is a fault.

    Parameters
    ----------
    package, folder : str
        Where they are: its dotted name, and the folder in it.
    **options : bool
        Further ones of `jinja2.Environment`.
    """
    return jinja2.Environment(
        loader=jinja2.PackageLoader(package, folder),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        bytecode_cache=_Compiled(options),
        **options,  # type: ignore[arg-type]
    )
