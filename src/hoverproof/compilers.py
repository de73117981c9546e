"""The C compiler of this machine, as it is named by ``$CC`` or found on the path."""

from __future__ import annotations

import os
import shlex
import shutil


def find_compiler() -> str:
    """Return the command of the system's C compiler, empty if there is none that can be run.

    It is ``$CC``, or cc, gcc or clang, whichever is there first.
    """
    named = os.environ.get("CC")
    for command in [named] if named else ["cc", "gcc", "clang"]:
        words = command_words(command)
        if words and shutil.which(words[0]):
            return command
    return ""


def command_words(command: str) -> list[str]:
    """Split a command as a shell does; nothing is left of what a shell would not understand.

    Parameters
    ----------
    command : str
        As in ``$CC``: a program, perhaps with options. The path of a program may have blanks, as it
        often has on Windows, and there a backslash is part of it.
    """
    if shutil.which(command):
        return [command]
    plain = os.name == "nt"
    try:
        words = shlex.split(command, posix=not plain)
    except ValueError:  # a quotation that does not end
        return []
    return [word.strip("\"'") for word in words] if plain else words
