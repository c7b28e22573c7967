"""Ctrl-C and the like: SIGINT, SIGTERM and SIGHUP, which ask a command to end.

SIGHUP comes when the terminal is closed; a command started by ``nohup`` does not hear it.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

INTERRUPTED = 130
"""Exit code of a command that one of the signals ended."""


def heard() -> list[signal.Signals]:
    """The signals that this process hears, in its main thread; elsewhere none can be caught."""
    if threading.current_thread() is not threading.main_thread():
        return []
    hangup = getattr(signal, "SIGHUP", None)
    found = [signal.SIGINT, signal.SIGTERM]
    if hangup is not None and signal.getsignal(hangup) is not signal.SIG_IGN:
        found.append(hangup)
    return found


class Break:
    """Raises KeyboardInterrupt at a signal, and knows that there was one.

    What is being imported may turn a KeyboardInterrupt into an error of its own, or tell it: a
    process that does nothing else (``alone``) ends at once there. Nothing is being written then.
    """

    def __init__(self, alone: bool) -> None:
        self.came = False
        self._alone = alone
        self._ignores = False

    def ignore(self) -> None:
        """Raise nothing more: the command is ending."""
        self._ignores = True

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        self.came = True
        if self._ignores:
            return
        if self._alone and _imports(frame):
            with suppress(OSError):
                os.write(2, b"interrupted\n")
            os._exit(INTERRUPTED)
        raise KeyboardInterrupt

    def again(self, error: sys.UnraisableHookArgs) -> None:
        """Ask again where what cannot be broken off (a finaliser) has lost the interrupt."""
        if error.exc_type is KeyboardInterrupt and not self._ignores:
            threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT)).start()
        else:
            sys.__unraisablehook__(error)


def _imports(frame: FrameType | None) -> bool:
    """Whether a module is being imported."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


@contextmanager
def breaks(last: bool) -> Iterator[Break]:
    """Let the signals raise KeyboardInterrupt while a block runs.

    With ``last`` the process ends after it: it is told no more, and its exit code stands; where a
    thread that the user's code left behind keeps it, a signal ends it.
    """
    found = Break(alone=last)
    hook = sys.unraisablehook
    before: dict[signal.Signals, Any] = {number: signal.signal(number, found) for number in heard()}
    sys.unraisablehook = found.again
    try:
        yield found
    finally:
        sys.unraisablehook = hook
        after = signal.SIG_DFL if is_kept() else signal.SIG_IGN
        for number, handler in before.items():
            signal.signal(number, after if last else handler)


def is_kept() -> bool:
    """Whether a thread other than this one keeps the process from ending."""
    mine = threading.current_thread()
    return any(not one.daemon for one in threading.enumerate() if one is not mine)
