"""Standard output and error while a command runs: what is printed goes through one gate.

Whatever is printed there, a name of a robot, a line of a file, the message of a library, cannot
act on the terminal, and can be written in whatever encoding the terminal has. Streams that the
shell has closed lead nowhere.
"""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, TextIO, cast

from physim.errors import Notice
from physim.escaping import escaped_lines

OWN = (
    "physim|numpy|scipy|shapely|numba|llvmlite|pymunk|h5py|cv2|matplotlib|PIL|av|yaml|"
    "pydantic|svgelements|cyclopts"
)
"""Modules whose warnings are for those who work on physim."""


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


class Gate(io.TextIOBase):
    """A text stream that escapes what would act on a terminal; see `physim.escaping`.

    With ``forgiving`` what cannot be written is lost in silence: errors that nobody can read must
    not break off what goes on. ``unescaped`` is for what draws on a terminal.
    """

    def __init__(self, stream: TextIO, forgiving: bool = False, escapes: bool = True) -> None:
        self._stream, self._forgiving, self._escapes = stream, forgiving, escapes
        self.failed: OSError | None = None
        """why the stream took nothing more, as it was raised"""

    def write(self, text: str) -> int:
        """Write a text, escaped."""
        encoding = getattr(self._stream, "encoding", None)
        try:
            self._stream.write(escaped_lines(text, encoding) if self._escapes else text)
        except OSError as error:
            self.failed = error
            if not self._forgiving:
                raise
            silence(self._stream)
        return len(text)

    def flush(self) -> None:
        """Pass on what was written."""
        try:
            self._stream.flush()
        except OSError as error:
            self.failed = error
            if not self._forgiving:
                raise
            silence(self._stream)

    def isatty(self) -> bool:
        """Whether a person looks at it."""
        return self._stream.isatty()

    def fileno(self) -> int:
        """Number of the file."""
        return self._stream.fileno()

    def writable(self) -> bool:
        """Return True."""
        return True

    @property
    def encoding(self) -> str | None:  # type: ignore[override]
        """That of the stream behind."""
        return getattr(self._stream, "encoding", None)

    @property
    def unescaped(self) -> TextIO:
        """The same stream without escapes."""
        return cast(TextIO, Gate(self._stream, self._forgiving, escapes=False))


def failed_at(stream: TextIO, error: OSError) -> bool:
    """Whether an error is that of writing to a stream, and not one of another file or pipe."""
    return getattr(stream, "failed", None) is error


def silence(stream: TextIO) -> None:
    """Let what is still to be written to a stream go nowhere."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def unescaped(stream: TextIO) -> TextIO:
    """What draws on the terminal of a stream: text from files must be escaped before."""
    found: TextIO = getattr(stream, "unescaped", stream)
    return found


@contextmanager
def gates() -> Iterator[None]:
    """Put gates before standard output and error while a block runs."""
    before = sys.stdout, sys.stderr
    with _nowhere() as nowhere:
        out, err = (stream if stream is not None else nowhere for stream in before)
        sys.stdout, sys.stderr = cast(TextIO, Gate(out)), cast(TextIO, Gate(err, forgiving=True))
        try:
            yield
        finally:
            sys.stdout, sys.stderr = before


@contextmanager
def _nowhere() -> Iterator[TextIO]:
    """A stream that leads nowhere; the numbers 0 to 2 are taken by it where they are free.

    A file that is opened next would have such a number, and what a library writes to its standard
    error would go into it.
    """
    spare = os.open(os.devnull, os.O_RDWR)
    while spare <= 2:
        spare = os.open(os.devnull, os.O_RDWR)
    with open(spare, "w", encoding="utf-8") as nowhere:
        yield nowhere
