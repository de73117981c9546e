"""The one error that users cause, and that every command turns into one line and status 2."""

from __future__ import annotations


class InputError(ValueError):
    """Something that a user gave cannot be used.

    Parameters
    ----------
    where : str
        The file (or the preset, or the option) that holds the mistake.
    key : str
        The key inside it, dotted; empty if the whole is meant.
    reason : str
        What is wrong and what would be right.
    """

    def __init__(self, where: str, key: str, reason: str) -> None:
        self.where, self.key, self.reason = where, key, reason
        super().__init__(": ".join(part for part in (where, key, reason) if part))
