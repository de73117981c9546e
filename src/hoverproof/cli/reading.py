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
from hoverproof.files import require_file

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
    from hoverproof.certification.problem import ONES, exact_weights

    if text is None:
        return ONES
    if text == "search":
        return search_weights(mission, region=region)
    return exact_weights(text[:400].split(","))


def mission_name(path: Path) -> str:
    """Return a mission's name for a file."""
    return re.sub(r"[^A-Za-z0-9._-]", "-", path.stem).lstrip("._-")[:64] or "mission"


def default_stem(
    mission: Mission,
    source: str,
    settings: list[str] | None,
    *,
    of: str | None = None,
    proof: bool = False,
) -> str:
    """Return how the names of files begin that a command writes: as the preset or mission file.

    Where --set makes another mission of it, eight digits of its hash follow, so that it does not
    replace what was written of the mission itself; a name that --set gives stands alone.

    Parameters
    ----------
    mission : Mission
        As changed by `settings`.
    source : str
        The preset or the file.
    settings : list of str, optional
        Those of --set.
    of : str, optional
        What the files are about, if not the mission: the name of a log.
    proof : bool
        Whether the files are about what a certificate holds of a mission alone.
    """
    from hoverproof.checker import digest
    from hoverproof.mission.presets import presets
    from hoverproof.mission.reading import load

    stem = of or (source if source in presets() else Path(source).stem)
    if not settings:
        return stem
    told = mission.exact() if proof else _said(mission)
    with contextlib.suppress(InputError):  # it may be of use with --set alone
        plain = load(source)
        if of is None and plain.name != mission.name:
            return mission.name
        if told == (plain.exact() if proof else _said(plain)):
            return stem
    return f"{stem}.{digest(told)[:8]}"


def _said(mission: Mission) -> dict[str, Any]:
    """Return all that a mission says, each number an exact string."""
    from hoverproof.mission.fields import as_text

    interface = mission.interface.model_dump(exclude_defaults=True)
    return mission.exact() | mission.conditions() | {"interface": as_text(interface)}


def file_to_write(given: Path | None, default: str, *endings: str) -> Path:
    """Return where a command writes, and refuse what it could not write, before any work.

    Parameters
    ----------
    given : Path, optional
        As an option says; by default `default`, here.
    default : str
        A file name; what is given has its ending.
    *endings : str
        Or one of these.

    Raises
    ------
    InputError
        If the ending is another one, or a file cannot be made there.
    """
    path = Path(default) if given is None else given
    require_file(path)
    endings = (Path(default).suffix, *endings)
    if path.suffix.lower() not in endings:
        raise InputError(str(path), "", f"must end in {' or '.join(endings)}")
    return path


def stretch(option: str, text: str) -> tuple[float, float]:
    """Read FROM,TO in s."""
    try:
        begin, end = map(float, text.split(","))
    except ValueError:
        begin = end = math.nan
    if not begin < end:
        raise InputError(option, "", f"must be FROM,TO in s, as 2,7.5, not {text[:40]!r}")
    return begin, end
