"""Commands run in the process of a test."""

from __future__ import annotations

import pytest

from hoverproof import cli


def run(capsys, *arguments):
    """Run a command in this process; return status, stdout and stderr."""
    with pytest.raises(SystemExit) as exit_:
        cli.main([str(a) for a in arguments])
    captured = capsys.readouterr()
    return exit_.value.code, captured.out, captured.err


def refusal(capsys, *arguments):
    """Run what must fail with status 2 and one line on stderr; return the line."""
    status, out, err = run(capsys, *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    return err
