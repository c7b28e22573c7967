"""The command line: ``physim run``, ``check``, ``validate`` and the others (``physim --help``)."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import TextIO

UNWRITTEN = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""What a standard output answers that takes nothing more."""


FAULT = 70
"""Exit code of an exception that nobody expected: a fault in physim (EX_SOFTWARE of sysexits)."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0 success, 1 ran but an expectation failed or there was contact, 2 bad input or output that
    cannot be written, 3 checks disagree, 70 a fault in physim, after its traceback, 130
    interrupted.

    Every error is a line on standard error that begins with where the fault lies: the
    file with line and column, the file, the option, or the command.
    """
    try:
        return _with_streams(arguments)
    except Exception:
        import traceback

        _print_error(traceback.format_exc().rstrip())
        _print_error("physim: this is a fault in physim itself, not in its input; please report it")
        return FAULT


def _with_streams(arguments: Sequence[str] | None) -> int:
    """Run, and report outputs that take nothing more."""
    code = 0
    try:
        try:
            code = _main(arguments)
        finally:
            if sys.stdout is not None:  # it is None where the shell has closed it
                sys.stdout.flush()
    except BrokenPipeError:  # the reader has gone; say nothing more
        _silence(sys.stdout)
    except OSError as error:
        if error.filename is None and error.errno not in UNWRITTEN:
            raise
        _silence(sys.stdout)
        where = "standard output" if error.filename is None else os.fsdecode(error.filename)
        _print_error(f"{where}: cannot be written ({error.strerror})")
        return 2
    return code


def _main(arguments: Sequence[str] | None) -> int:
    from physim.errors import PhysimError

    try:
        from physim.cli.parser import run_command

        return run_command(sys.argv[1:] if arguments is None else arguments)
    except PhysimError as error:
        _print_error(str(error))
        return 2
    except KeyboardInterrupt:
        _print_error("interrupted")
        return 130


def _print_error(text: str) -> None:
    try:
        print(text, file=sys.stderr, flush=True)
    except OSError:  # it is full or closed, too: the exit code has to say it
        _silence(sys.stderr)


def _silence(stream: TextIO) -> None:
    """Let what is still to be written to a stream go nowhere."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
