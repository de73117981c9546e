"""Options that several commands read, and the names of the files that they write."""

from __future__ import annotations

import contextlib
import itertools
import math
import re
import shlex
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hoverproof.certification.region import Box, Enclosure
    from hoverproof.mission.sections import Mission


READ = {"mission", "certificate", "log", "source", "camera", "target"}
WRITTEN = {"out", "figure", "animate", "film", "overlay", "certify"}


def keep_what_is_read(command: str, /, **options: Any) -> None:
    """Refuse to write over a file that the same command reads.

    A mission may be replaced by the one that is made of it: with tuned gains, or wider tolerances.

    Parameters
    ----------
    command : str
    **options
        Those that are given, by the names that the parameters have.

    Raises
    ------
    InputError
        If a file is both.
    """
    given = options | (vars(options["images"]) if options.get("images") else {})
    written = WRITTEN | {"log"} if command == "fly" else WRITTEN
    for one, other in itertools.product(sorted(written), sorted(READ - written)):
        anew = other == "mission" and (command in ("tune", "new") or one == "certify")
        if not anew and _same_file(given.get(one), given.get(other)):
            words = f"{given[one]} is the {other} that is read; give another name"
            raise InputError(f"--{one}", "", words)


def _same_file(one: object, other: object) -> bool:
    """Tell whether two paths, as given or None, are of one file that is there."""
    if not (isinstance(one, str | Path) and isinstance(other, str | Path)):
        return False
    with contextlib.suppress(OSError, ValueError):
        return Path(one).samefile(other)
    return False


def refuse_given(options: Mapping[str, object], reason: str) -> None:
    """Refuse options that were given, where there is no use for them."""
    for option, value in options.items():
        if value is not None and value is not False:
            raise InputError(option, "", reason)


def as_named(mission: str, settings: Iterable[str] | None) -> str:
    """Return the arguments with which a command was given its mission, for the next command."""
    return shlex.join([mission, *(word for it in settings or () for word in ("--set", it))])


def box_sides(mission: Mission, text: str | None) -> Box:
    """Read --box; by default the box around start and goal."""
    from hoverproof.certification.region import default_box, parse_box

    return default_box(mission) if text is None else parse_box(text)


def parse_weights(
    mission: Mission, text: str | None, region: Enclosure | None
) -> tuple[Fraction, ...]:
    """Read --weights: four numbers, or the best ones; by default ones."""
    from hoverproof.certification.gains import search_weights
    from hoverproof.certification.problem import ONES

    if text is None:
        return ONES
    if text == "search":
        return search_weights(mission, region=region)
    try:
        weights = tuple(Fraction(part.strip()) for part in text[:400].split(","))
    except (ValueError, ZeroDivisionError):
        weights = ()
    if len(weights) != 4 or not all(0 < w <= 10**9 and w.denominator <= 10**18 for w in weights):
        raise InputError(
            "--weights",
            "",
            "must be `search` or four positive numbers w1,w2,w3,w4 of at most 18 decimals, "
            f"not {text!r}",
        )
    return weights


def picture_path(path: Path) -> Path:
    """Refuse a figure in another format than .png or .svg before the work is done."""
    if path.suffix.lower() not in (".png", ".svg"):
        raise InputError(str(path), "", "a figure must end in .png or .svg")
    return path


def mission_name(path: Path) -> str:
    """Return a mission's name for a file."""
    return re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"


def certificate_stem(mission: Mission, source: str, settings: list[str] | None) -> str:
    """Return how the names of certificates begin: with the mission's name.

    Where --set makes another mission of it, eight digits of its hash follow, so that it does not
    replace a certificate of the mission itself.
    """
    from hoverproof.checker import digest
    from hoverproof.mission.reading import load

    if not settings:
        return mission.name
    with contextlib.suppress(InputError):  # it may be of use with --set alone
        plain = load(source)
        if plain.name != mission.name or plain.exact() == mission.exact():
            return mission.name
    return f"{mission.name}.{digest(mission.exact())[:8]}"


def stretch(option: str, text: str) -> tuple[float, float]:
    """Read FROM,TO in s."""
    try:
        begin, end = map(float, text.split(","))
    except ValueError:
        begin = end = math.nan
    if not begin < end:
        raise InputError(option, "", f"must be FROM,TO in s, as 2,7.5, not {text[:40]!r}")
    return begin, end
