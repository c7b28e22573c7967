"""The command line: ``physim run``, ``check``, ``validate`` and the others (``physim --help``)."""

from __future__ import annotations

import errno
import gc
import os
import sys
from collections.abc import Sequence

from physim.errors import PhysimError
from physim.terminal import INTERRUPTED, gates, interrupts, silence, without_warnings

UNWRITTEN = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""What a standard output answers that takes nothing more."""
PATIENT = 50_000
"""New objects after which a process of physim's own looks for garbage"""
FAULT = 70
"""Exit code of an exception that nobody expected: a fault in physim (EX_SOFTWARE of sysexits)."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0 success, 1 ran but an expectation failed or there was contact, 2 bad input or output that
    cannot be written, 3 checks disagree, 70 a fault in physim, after its traceback, 130
    interrupted: Ctrl-C, SIGTERM, or SIGHUP where they are not ignored.

    Every error is a line on standard error that begins with where the fault lies: the
    file with line and column, the file, the option, or the command.
    """
    words, code = sys.argv[1:] if arguments is None else arguments, 0
    if arguments is None:
        gc.set_threshold(PATIENT)  # to look for garbage at every import takes 30 ms
    with without_warnings(), gates(), interrupts(due=0.0) as interrupt:
        try:
            try:
                os.getcwd()
            except FileNotFoundError:
                raise PhysimError("the folder that this was started in is gone") from None
            from physim.cli.commands import run_command

            code = run_command(words)
            sys.stdout.flush()
        except SystemExit:
            raise
        except BaseException as error:  # somebody else's code may raise what is no Exception
            if interrupt() or isinstance(error, KeyboardInterrupt):
                code, told = INTERRUPTED, "interrupted"
            elif error is getattr(sys.stdout, "failed", None):
                silence(sys.stdout)
                if isinstance(error, BrokenPipeError):  # the reader has gone; say no more
                    return code
                code, told = 2, f"standard output: cannot be written ({error.strerror})"
            else:
                code, told = _ended_by(error)
            print(told, file=sys.stderr, flush=True)
    if arguments is None:
        gc.freeze()  # the process ends: to collect its garbage would hold the prompt
    return code


def _ended_by(error: BaseException) -> tuple[int, str]:
    """Exit code of an error, and what is told of it: in its own words what a user can mend."""
    if isinstance(error, PhysimError):
        return 2, str(error)
    if isinstance(error, MemoryError):
        why = f" ({error})" if str(error) else ""
        return 2, f"out of memory{why}: the machine, or a limit such as ulimit -v, has no more"
    if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):  # of a worker
        if error.filename is not None:
            return 2, f"{os.fsdecode(error.filename)}: cannot be read or written ({error.strerror})"
        if error.errno in UNWRITTEN:  # a library tells no file
            return 2, f"a file cannot be written ({error.strerror})"
    import traceback

    lines = traceback.format_exception(error)
    return FAULT, f"{''.join(lines)}physim: this is a fault in physim itself; please report it"
