"""The terminal while a command runs: one gate for what is printed, and the signals that end it.

Whatever is printed, a name of a robot, a line of a file, the message of a library, cannot act on
the terminal, and can be written in whatever encoding the terminal has. Streams that the shell has
closed lead nowhere.
"""

from __future__ import annotations

import io
import math
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, TextIO, cast

from physim.errors import Notice
from physim.escaping import escaped_lines

OWN = (
    "physim|numpy|scipy|shapely|pymunk|h5py|matplotlib|PIL|imageio_ffmpeg|yaml|pydantic|svgelements|"
    "cyclopts"
)
"""Modules whose warnings are for those who work on physim."""
INTERRUPTED = 130
"""Exit code of a command that a signal ended"""
PATIENCE = 1.0
"""[s] after which a second signal breaks off what has not heard the first"""


class Gate(io.TextIOBase):
    """A text stream that escapes what would act on the terminal of ``stream``.

    With ``forgiving`` what cannot be written is lost in silence: errors that nobody can read must
    not break off what goes on.
    """

    def __init__(self, stream: TextIO, forgiving: bool = False) -> None:
        self.stream, self._forgiving = stream, forgiving
        self.failed: OSError | None = None
        """why the stream took nothing more, as it was raised"""

    def write(self, text: str) -> int:
        """Write a text, escaped."""
        with self._noting_failure():
            self.stream.write(escaped_lines(text, self.encoding))
        return len(text)

    def flush(self) -> None:
        """Pass on what was written."""
        with self._noting_failure():
            self.stream.flush()

    @contextmanager
    def _noting_failure(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failed = error
            if not self._forgiving:
                raise
            silence(self.stream)

    def isatty(self) -> bool:
        """Whether a person looks at it."""
        return self.stream.isatty()

    def fileno(self) -> int:
        """Number of the file."""
        return self.stream.fileno()

    @property
    def encoding(self) -> str | None:  # type: ignore[override]
        """That of the stream behind."""
        return getattr(self.stream, "encoding", None)


def silence(stream: TextIO) -> None:
    """Let what is still to be written to a stream go nowhere."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


@contextmanager
def gates() -> Iterator[None]:
    """Put gates before standard output and error while a block runs.

    The numbers 0 to 2 are taken where they are free: a file that is opened next would have such a
    number, and what a library writes to its standard error would go into it.
    """
    before = sys.stdout, sys.stderr
    spare = os.open(os.devnull, os.O_RDWR)
    while spare <= 2:
        spare = os.open(os.devnull, os.O_RDWR)
    with open(spare, "w", encoding="utf-8") as nowhere:
        out, err = (stream if stream is not None else nowhere for stream in before)
        sys.stdout, sys.stderr = cast(TextIO, Gate(out)), cast(TextIO, Gate(err, forgiving=True))
        try:
            yield
        finally:
            sys.stdout, sys.stderr = before


@contextmanager
def without_warnings() -> Iterator[None]:
    """Show no warning of a library that physim uses; those of a user's own code are shown.

    All are, where Python was asked for them (``-W``, ``PYTHONWARNINGS``). A `Notice` is a line.
    """
    with warnings.catch_warnings():
        if not sys.warnoptions:
            warnings.filterwarnings("ignore", module=rf"({OWN})(\.|$)")
        warnings.simplefilter("always", Notice)
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *more: Any, **named: Any) -> None:
            if issubclass(category, Notice):
                print(f"WARNING  {message}", file=sys.stderr)
            else:
                usual(message, category, *more, **named)

        warnings.showwarning = show
        yield


class Interrupt:
    """Counts the signals that ask a command to end; called, it says whether there was one.

    A signal raises KeyboardInterrupt from ``due`` on, a time of `time.monotonic`: one that comes a
    while after another that nobody has asked for, since a controller may never return.
    """

    def __init__(self, due: float = math.inf) -> None:
        self.count = 0
        self.due = due

    def __call__(self) -> bool:
        """Whether there was a signal."""
        self.due = math.inf
        return self.count > 0

    def note(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        now = time.monotonic()
        self.count += 1
        if now > self.due:
            raise KeyboardInterrupt
        self.due = min(self.due, now + PATIENCE)


@contextmanager
def interrupts(due: float = math.inf) -> Iterator[Interrupt]:
    """Catch SIGINT, SIGTERM and SIGHUP while a block runs; the block asks the returned object.

    One that is ignored stays so, as SIGHUP of a command that ``nohup`` started, and none is heard
    outside the main thread.
    """
    interrupt = Interrupt(due)
    before: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(one) is not signal.SIG_IGN:
                before[one] = signal.signal(one, interrupt.note)
    try:
        yield interrupt
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
