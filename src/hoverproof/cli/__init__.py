"""The commands: each parses, calls one function and prints.

Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, 2 bad usage or bad input,
3 undecided. Heavy imports stand inside the commands that need them, so that help comes at once.
"""

from __future__ import annotations

import io
import sys
from typing import NoReturn

from cyclopts import CycloptsError

# A command joins the application where it is defined; this order is the order of the help.
from hoverproof.cli import (  # noqa: F401
    atlas,
    attraction,
    certification,
    firmware,
    flight,
    missions,
    paper,
    report,
    tuning,
)
from hoverproof.cli.console import app, fail, plain_console, usage
from hoverproof.errors import InputError


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run a command and exit with its status."""
    for stream in (sys.stdout, sys.stderr):  # a terminal may know few letters
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        status = app(arguments, console=plain_console(), exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except CycloptsError as error:
        fail(usage(error))
    except InputError as error:
        fail(str(error))
    except KeyboardInterrupt:
        fail("interrupted", status=130)
    except BrokenPipeError:
        sys.stderr.close()
        status = 0
    sys.exit(status if isinstance(status, int) else 0)
