"""The commands: each parses, calls one function and prints.

Exit status: 0 done or proved, 1 refuted, rejected or a flight cut short, 2 bad usage or bad input,
3 undecided. Heavy imports stand inside the commands that need them, so that help comes at once.
"""

from __future__ import annotations

import atexit
import gc
import io
import os
import signal
import sys
import time
from functools import partial
from typing import NoReturn

# Next to nothing that a command imports is ever garbage; to look through it as often as Python
# does by itself, and once more at the exit, takes a fifth of the time of a short command.
gc.set_threshold(200_000)

try:
    from cyclopts import CycloptsError

    from hoverproof.cli.console import app, fail, plain_console, usage
    from hoverproof.cli.interruption import STATUS, heard, interruption
    from hoverproof.cli.reading import keep_what_is_read
    from hoverproof.errors import InputError
except KeyboardInterrupt:  # in the fraction of a second before a command begins
    os.write(2, b"hoverproof: interrupted\n")
    os._exit(130)

# Else pydantic looks through all that is installed for what may change how a mission is read.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

COMMANDS = (
    *("certification:certify", "certification:region", "certification:check"),
    *("tuning:tune", "atlas:atlas", "attraction:attraction"),
    *("firmware:export", "flight:simulate", "flying:fly", "see:see"),
    *("audit:audit", "audit:replay"),
    *("missions:presets", "missions:new", "paper:derive", "report:report"),
)
"""Module and function of each command; imported when it is run, or when help tells of it."""

for command in COMMANDS:
    keep = partial(keep_what_is_read, command.partition(":")[2])
    app.command(f"{__name__}.{command}", validator=keep)


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run a command and exit with its status."""
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)  # what is answered stays answered
    atexit.register(gc.freeze)
    for stream in (sys.stdout, sys.stderr):  # a terminal may know few letters
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        with heard():
            status = run(arguments)
    except BaseException as error:  # some libraries make another error of an interruption
        if not (interruption.heard or isinstance(error, KeyboardInterrupt)):
            raise
        interruption.tell()
        status = STATUS
        time.sleep(0.02)  # until it has been heard, too
    if interruption.heard and status == STATUS:
        sys.stdout.flush()
        interruption.leave()  # taking the libraries down takes longer than a user waits
    sys.exit(status if isinstance(status, int) else 0)


def run(arguments: list[str] | None) -> object:
    """Run a command and return its status, or exit with a line that says what is wrong."""
    given = sys.argv[1:] if arguments is None else arguments
    try:
        if not given or given[0].startswith("-"):  # help or completion: all commands are told of
            app.resolved_commands()
        status: object = app(
            arguments, console=plain_console(), exit_on_error=False, print_error=False
        )
        if sys.stdout is not None:
            sys.stdout.flush()
    except CycloptsError as error:
        if isinstance(error.__cause__, InputError):
            fail(error.__cause__.line)
        fail(usage(error))
    except InputError as error:
        fail(error.line)
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except _numerical():  # nothing is proved of numbers that cannot be computed with
        fail("undecided: these numbers are beyond what can be computed with", status=3)
    except OSError as error:  # files are written by functions that say which; this is the output
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # flushed again at the exit
        fail(f"the output cannot be written: {error}")
    return status


def _numerical() -> tuple[type[Exception], ...]:
    """Return what arithmetic raises on absurd numbers, without importing what has not been."""
    homes = {"numpy.linalg": "LinAlgError", "hoverproof.checker": "Rejected"}
    found = [getattr(sys.modules[m], name) for m, name in homes.items() if m in sys.modules]
    return (ArithmeticError, *found)
