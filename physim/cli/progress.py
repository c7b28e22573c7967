"""While a command works: progress bars, Ctrl-C, files that are watched, kernels that are compiled.

Bars are drawn on a terminal alone. Files are watched by looking at them now and then, which
works on every file system.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from physim.cli.signals import INTERRUPTED, heard
from physim.errors import PhysimError
from physim.escaping import escaped
from physim.streams import unescaped

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation


REFRESH_SECONDS = 0.1
PATIENCE = 1.0
"""[s] after which a second Ctrl-C breaks off what has not heard the first"""
TOLD_AFTER, ENDED_AFTER = 3.0, 10.0
"""[s] after which a signal that nobody has heard is told of, and, where it is none of a keyboard,
sent again: whoever sent it may be a queue, which kills next"""


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


class Interrupt:
    """Counts Ctrl-C, SIGTERM and SIGHUP instead of breaking off in the middle of a file."""

    def __init__(self) -> None:
        self.count = 0
        self._unheard: float | None = None
        self._timers: list[threading.Timer] = []

    def __call__(self) -> bool:
        """Whether there was one."""
        self._unheard = None
        return self.count > 0

    def _note(self, number: int, frame: FrameType | None) -> None:
        """Count it. Raises KeyboardInterrupt where nobody has asked for a while after the last.

        A controller may never return.
        """
        now = time.monotonic()
        if self._unheard is not None and now - self._unheard > PATIENCE:
            raise KeyboardInterrupt
        self.count += 1
        if self._unheard is None:
            self._unheard = now
            self._after(TOLD_AFTER, self._tell, now, number)
            if number != signal.SIGINT:
                self._after(ENDED_AFTER, self._send_again, now, number)

    def _after(self, seconds: float, do: Callable[[float, int], None], *given: Any) -> None:
        timer = threading.Timer(seconds, do, given)
        timer.daemon = True
        timer.start()
        self._timers.append(timer)

    def _tell(self, since: float, number: int) -> None:
        if self._unheard == since:
            typed = number == signal.SIGINT
            name = "Ctrl-C" if typed else signal.Signals(number).name
            how = "once more breaks it off" if typed else "it is broken off soon"
            with suppress(OSError, ValueError):
                print(
                    f"{name}: not heard by what is under way (a controller that does not return?); "
                    f"{how}", file=sys.stderr, flush=True,
                )  # fmt: skip

    def _send_again(self, since: float, number: int) -> None:
        if self._unheard == since:
            os.kill(os.getpid(), number)

    def forget(self) -> None:
        """Do nothing more about what nobody has heard."""
        for timer in self._timers:
            timer.cancel()


@contextmanager
def interrupts() -> Iterator[Interrupt]:
    """Catch the signals while a block runs; the block polls the returned object.

    Raises PhysimError for a KeyboardInterrupt of which there was no signal, as one that a
    controller raises.
    """
    interrupt = Interrupt()
    before = {number: signal.signal(number, interrupt._note) for number in heard()}
    try:
        yield interrupt
    except KeyboardInterrupt as error:
        if interrupt.count:
            raise
        *_, last = traceback.extract_tb(error.__traceback__)
        where = f"{escaped(last.filename)}:{last.lineno}"
        raise PhysimError(f"{where}: raised KeyboardInterrupt; nobody interrupted") from error
    finally:
        interrupt.forget()
        for number, handler in before.items():
            signal.signal(number, handler)


EVERY = 0.15
"""[s] between two looks"""


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


def announce_compiling(what: str, seconds: int, quiet: bool) -> None:
    """Print one line on standard error; ``seconds`` is what it took on two quiet cores."""
    if not quiet:
        text = f"compiling {what} (once after an installation or an edit, about {seconds} s) ..."
        print(text, file=sys.stderr, flush=True)
