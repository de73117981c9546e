"""Firmware on an emulated board, for a vehicle that is simulated here. Not a test itself."""

from __future__ import annotations

import ctypes
import subprocess
from contextlib import contextmanager

from firmware_kit import TARGET, build_for, emulation, names_header
from hoverproof.export.binding import Firmware


class OnBoard(Firmware):
    """A package of which a board makes the resets and steps, with a state of its own.

    Parameters
    ----------
    folder : Path
        The package.
    pipe : subprocess.Popen
        The emulator, with `target/flight.c` on it.
    """

    pipe = None

    def __init__(self, folder, pipe):
        super().__init__(folder)
        kinds, bits = self._structs, ctypes.c_uint32
        call = [("steps", bits), ("thrust", self._real), ("given", kinds["input"])]
        answer = [("status", bits), ("state", kinds["state"]), ("out", kinds["output"])]
        for name, fields in (("call", call), ("answer", answer)):
            kinds[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
        self.pipe = pipe

    def _call(self, verb, *arguments):
        if self.pipe is None:  # while it is made
            return super()._call(verb, *arguments)
        call = self._new("call")
        if verb == "step":
            _, state, call.given, out = arguments
            call.steps = 1
        else:
            assert verb == "reset"
            _, state, call.thrust = arguments
            out = self._new("output")
        self.pipe.stdin.write(bytes(call))
        self.pipe.stdin.flush()
        kind = self._structs["answer"]
        answer = kind.from_buffer_copy(self.pipe.stdout.read(ctypes.sizeof(kind)))
        for here, there in ((state, answer.state), (out, answer.out)):
            ctypes.pointer(here)[0] = there
        return answer.status


@contextmanager
def on_board(board, package, *flags):
    """Run a package on an emulated board, compiled with further flags, as long as the context."""
    made = package.folder.with_name(f"{package.folder.name}-{board.machine}")
    made.mkdir()
    (made / "firmware_names.h").write_text(names_header(package))
    image = build_for(board, package, [TARGET / "flight.c"], made / "flight.elf", *flags)
    command = [str(word) for word in emulation(board, image)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, **pipes) as running:
        try:
            yield OnBoard(package.folder, running)
            running.stdin.close()
            assert running.wait(timeout=10) == 0
        finally:
            running.kill()


def listen(firmware):
    """Return the list that gets each reset and step of a package: its status, and all its bits."""
    heard, call = [], firmware._call

    def heard_call(verb, params, *rest):
        status = call(verb, params, *rest)
        bits = [bytes(a) if isinstance(a, ctypes.Structure) else a for a in rest]
        heard.append((verb, status, *bits))
        return status

    firmware._call = heard_call
    return heard
