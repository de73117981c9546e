"""Ctrl-C ends a command within a second, whatever it is doing at that moment.

Python raises `KeyboardInterrupt` when the main thread is back from whatever machine code it is in,
and a library that catches everything may lose it. So a thread hears of the signal as well, leaves
the command some time to end in good order, and then ends it. Files are renamed into place when they
are whole, so nothing half-written is left.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from hoverproof.files import discard_unfinished

STATUS = 130


@dataclass
class Interruption:
    """What is known of an interruption by the user.

    Attributes
    ----------
    grace : float
        s from the signal to the end of the process, at the latest.
    heard, said : bool
        Whether there was one, and whether the user has been told.
    """

    grace: float = 0.5
    heard: bool = False
    said: bool = False

    def listen(self, receiver: socket.socket) -> None:
        """Wait for signals, each a byte; end the process if it does not end after the first.

        Parameters
        ----------
        receiver : socket
            Closed from the other side when the command is over.
        """
        with receiver:
            for number in iter(lambda: receiver.recv(1), b""):
                if number[0] == signal.SIGINT:
                    self.heard = True
                    end = time.monotonic() + self.grace
                    while (left := end - time.monotonic()) > 0:
                        receiver.settimeout(left)
                        with contextlib.suppress(TimeoutError):
                            if not receiver.recv(1):
                                return
                    self.leave()

    def tell(self) -> None:
        """Tell the user, once."""
        if not self.said:
            self.said = True
            cursor = "\x1b[?25h" if os.isatty(2) else ""  # a bar may have hidden it
            os.write(2, f"{cursor}hoverproof: interrupted\n".encode())

    def leave(self) -> None:
        """End the process and those that it started."""
        discard_unfinished()
        processes = sys.modules.get("multiprocessing")  # else there are no children
        for child in processes.active_children() if processes else ():
            child.terminate()
        self.tell()
        os._exit(STATUS)


interruption = Interruption()
"""Of this process."""


@contextlib.contextmanager
def heard() -> Iterator[None]:
    """Hear interruptions while this block runs, and to the end of the process once there is one."""
    receiver, sender = socket.socketpair()
    sender.setblocking(False)
    try:
        before = signal.set_wakeup_fd(sender.fileno(), warn_on_full_buffer=False)
    except ValueError:  # not in the main thread, to which no signal comes
        receiver.close()
        sender.close()
        yield
        return
    listener = threading.Thread(target=interruption.listen, args=(receiver,), daemon=True)
    listener.start()
    hook, sys.unraisablehook = sys.unraisablehook, _quiet
    try:
        yield
    except KeyboardInterrupt:
        raise  # and go on listening: the end must be soon as well
    except BaseException:
        _over(before, sender, listener, hook)
        raise
    _over(before, sender, listener, hook)


def _over(
    before: int, sender: socket.socket, listener: threading.Thread, hook: Callable[[Any], Any]
) -> None:
    sys.unraisablehook = hook
    signal.set_wakeup_fd(before)
    sender.close()
    listener.join()


def _quiet(lost: sys.UnraisableHookArgs) -> None:
    """Say nothing of an interruption that is lost, as in a callback: it has been heard."""
    if not issubclass(lost.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
