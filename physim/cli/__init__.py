"""The command line: ``physim run``, ``check``, ``validate`` and the others (``physim --help``)."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence

from physim.cli.progress import INTERRUPTED, Break, handling
from physim.streams import failed_at, gates, silence, without_warnings

UNWRITTEN = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""What a standard output answers that takes nothing more."""
FAULT = 70
"""Exit code of an exception that nobody expected: a fault in physim (EX_SOFTWARE of sysexits)."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0 success, 1 ran but an expectation failed or there was contact, 2 bad input or output that
    cannot be written, 3 checks disagree, 70 a fault in physim, after its traceback, 130
    interrupted: Ctrl-C, SIGTERM, or SIGHUP where it is not ignored.

    Every error is a line on standard error that begins with where the fault lies: the
    file with line and column, the file, the option, or the command.
    """
    if "multiprocessing.spawn" in sys.modules:  # else nobody began this process
        from physim.campaigns.pool import end_if_importing

        end_if_importing()
    broken = Break()
    words = sys.argv[1:] if arguments is None else arguments
    with without_warnings(), gates(), handling(broken):
        try:
            return _with_streams(words, broken)
        except KeyboardInterrupt:
            pass
        except SystemExit:
            raise
        except BaseException:  # somebody else's code may raise what is no Exception
            if not broken.came:
                import traceback

                _tell(traceback.format_exc().rstrip())
                _tell(
                    "physim: this is a fault in physim itself, not in its input; please report it"
                )
                return FAULT
        broken.ends = True
        _tell("interrupted")
        return INTERRUPTED


def _with_streams(words: Sequence[str], broken: Break) -> int:
    """Run, and report outputs that take nothing more."""
    code = 0
    try:
        try:
            code = _run(words, broken)
        finally:
            sys.stdout.flush()
    except OSError as error:
        is_output = failed_at(sys.stdout, error)
        if is_output and isinstance(error, BrokenPipeError):  # the reader has gone; say no more
            silence(sys.stdout)
            return code
        if isinstance(error, BrokenPipeError) or (broken.came and not is_output):
            raise  # the pipe of a worker: what broke it off is told
        if error.filename is None and error.errno not in UNWRITTEN:
            raise
        silence(sys.stdout)
        if error.filename is not None:
            where = os.fsdecode(error.filename)
        else:  # numba tells no file
            where = "standard output" if is_output else "a file (of numba's cache, perhaps)"
        _tell(f"{where}: cannot be written ({error.strerror})")
        return 2
    return code


def _run(words: Sequence[str], broken: Break) -> int:
    """Run; what a user can mend is told in its own words."""
    from physim.errors import PhysimError

    try:
        from physim.cli.commands import run_command

        return run_command(words)
    except PhysimError as error:
        if broken.came:  # what was being imported made an error of it
            raise KeyboardInterrupt from None
        _tell(str(error))
        _is_folder_gone()
    except FileNotFoundError:
        if not _is_folder_gone():
            raise
    except MemoryError as error:
        why = f" ({error})" if str(error) else ""
        _tell(f"out of memory{why}: the machine, or a limit such as ulimit -v, has no more")
    return 2


def _is_folder_gone() -> bool:
    """Say so where the working folder is not there any more, by which relative names fail."""
    try:
        os.getcwd()
    except FileNotFoundError:
        _tell("the folder that this was started in is gone; change to one that is there")
        return True
    return False


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
