"""While a command works: progress bars, Ctrl-C, files that are watched, kernels that are compiled.

Bars are drawn on a terminal alone. Files are watched by looking at them now and then, which
works on every file system.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from physim.errors import PhysimError
from physim.escaping import escaped
from physim.streams import unescaped

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

INTERRUPTED = 130
"""Exit code of a command that a signal ended."""
REFRESH_SECONDS = 0.1
PATIENCE = 1.0
"""[s] after which a second signal breaks off what has not heard the first"""
COMPILING = 25
"""[s] about, on two quiet cores"""
EVERY = 0.15
"""[s] between two looks at a file that is watched"""


class Bar:
    """A bar on standard error; does nothing when that is no terminal or ``quiet`` is set."""

    def __init__(self, title: str, total: float, unit: str, quiet: bool) -> None:
        self.visible = not quiet and sys.stderr.isatty()
        self.due = 0.0
        self.complete = False
        if not self.visible:
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        self.progress = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            TextColumn(f"{{task.completed:.0f}}/{{task.total:.0f}} {unit}"),
            TextColumn("{task.fields[note]}", markup=False),
            TimeRemainingColumn(),
            console=Console(file=unescaped(sys.stderr)),
            transient=True,
        )
        self.progress.start()
        self.task = self.progress.add_task(escaped(title), total=total, note="")

    def count(self, done: int, total: int, note: str = "") -> None:
        """Show how much is done of what there is in all."""
        self.complete = done == total
        if self.visible:
            self.progress.update(self.task, total=total)
        self.update(done, note)

    def update(self, done: float, note: Callable[[], str] | str = "") -> None:
        """Show how far the work is; cheap when nothing is due."""
        if not self.visible or (now := time.monotonic()) < self.due:
            return
        self.due = now + REFRESH_SECONDS
        text = note() if callable(note) else note
        self.progress.update(self.task, completed=done, note=text)

    def simulated(self, simulation: Simulation, factor: float) -> None:
        """Show how far a simulation is, and how many times faster than what it simulates."""
        self.update(simulation.time, lambda: f"{factor:.0f} x real time")

    def __enter__(self) -> Bar:
        """Return the bar, which is on the screen already."""
        return self

    def __exit__(self, *error: object) -> None:
        """Take the bar off the screen."""
        if self.visible:
            self.progress.stop()
            self.visible = False


@contextmanager
def handling(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Handle SIGINT, SIGTERM and SIGHUP while a block runs: they ask a command to end.

    SIGHUP comes when the terminal is closed; a command started by ``nohup`` does not hear it, and
    none is heard outside the main thread.
    """
    heard = [signal.SIGINT, signal.SIGTERM]
    hangup = getattr(signal, "SIGHUP", None)
    if hangup is not None and signal.getsignal(hangup) is not signal.SIG_IGN:
        heard.append(hangup)
    if threading.current_thread() is not threading.main_thread():
        heard = []
    before = {number: signal.signal(number, handler) for number in heard}
    try:
        yield
    finally:
        for number, one in before.items():
            signal.signal(number, one)


class Break:
    """Raises KeyboardInterrupt at a signal, and knows that there was one."""

    def __init__(self) -> None:
        self.came = False
        self.ends = False
        """whether the command is ending, so that no more is raised"""

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        self.came = True
        if not self.ends:
            raise KeyboardInterrupt


class Interrupt:
    """Counts signals instead of breaking off in the middle of a file."""

    def __init__(self) -> None:
        self.count = 0
        self._unheard: float | None = None

    def __call__(self) -> bool:
        """Whether there was one."""
        self._unheard = None
        return self.count > 0

    def note(self, number: int, frame: FrameType | None) -> None:
        """Count it. Raises KeyboardInterrupt where nobody has asked for a while after the last.

        A controller may never return.
        """
        now = time.monotonic()
        if self._unheard is not None and now - self._unheard > PATIENCE:
            raise KeyboardInterrupt
        self.count += 1
        self._unheard = now if self._unheard is None else self._unheard


@contextmanager
def interrupts() -> Iterator[Interrupt]:
    """Catch the signals while a block runs; the block polls the returned object.

    Raises PhysimError for a KeyboardInterrupt of which there was no signal, as one that a
    controller raises.
    """
    interrupt = Interrupt()
    try:
        with handling(interrupt.note):
            yield interrupt
    except KeyboardInterrupt as error:
        if interrupt.count:
            raise
        *_, last = traceback.extract_tb(error.__traceback__)
        where = f"{last.filename}:{last.lineno}"
        raise PhysimError(f"{where}: raised KeyboardInterrupt; nobody interrupted") from error


def watch(paths: Sequence[Path], changed: Callable[[], object]) -> int:
    """Call ``changed`` now and after every change of the files, until Ctrl-C; returns its code.

    A change counts when the files stay as they are from one look to the next, so that a file is
    seldom read half-written; when it is nonetheless, its completion is the next change.
    """
    handled: object = None
    before = [state(path) for path in paths]
    with interrupts() as interrupt:
        while not interrupt():
            now = [state(path) for path in paths]
            if now == before and (handled is None or now != handled):
                handled = now  # before the call: what is saved meanwhile is a change
                try:
                    changed()
                except KeyboardInterrupt:  # a run in it has heard the signal
                    break
            before = now
            time.sleep(EVERY)
    print("interrupted", file=sys.stderr)
    return INTERRUPTED


def state(path: Path) -> tuple[int, ...]:
    """What changes with the content of a file; () while there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ()
    return status.st_mtime_ns, status.st_size, status.st_ino


def announce_compiling(what: str, quiet: bool) -> None:
    """Print one line on standard error."""
    if not quiet:
        text = f"compiling {what} (once after an installation or an edit, about {COMPILING} s) ..."
        print(text, file=sys.stderr, flush=True)
