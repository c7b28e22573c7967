"""While a command works: progress bars, files that are watched."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from physim.escaping import escaped
from physim.terminal import INTERRUPTED, interrupts

if TYPE_CHECKING:
    from physim.simulation.loop import Simulation

REFRESH_SECONDS = 0.1
EVERY = 0.15
"""[s] between two looks at a file that is watched"""


class Bar:
    """A bar on standard error; does nothing when that is no terminal or ``quiet`` is set."""

    def __init__(self, title: str, total: float, unit: str, quiet: bool) -> None:
        self.visible = not quiet and sys.stderr.isatty()
        self.complete = False
        self._due = 0.0
        if self.visible:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

            self._progress = Progress(
                TextColumn("{task.description}", markup=False),
                BarColumn(),
                TextColumn(f"{{task.completed:.0f}}/{{task.total:.0f}} {unit}"),
                TextColumn("{task.fields[note]}", markup=False),
                TimeRemainingColumn(),
                TextColumn("left"),
                console=Console(file=getattr(sys.stderr, "stream", sys.stderr)),  # behind its gate
                transient=True,
            )
            self._progress.start()
            self._task = self._progress.add_task(escaped(title), total=total, note="")

    def count(self, done: int, total: int, note: str = "") -> None:
        """Show how much is done of what there is in all."""
        self.complete = done == total
        if self.visible:
            self._progress.update(self._task, total=total)
        self.update(done, note)

    def update(self, done: float, note: Callable[[], str] | str = "") -> None:
        """Show how far the work is; cheap when nothing is due."""
        if self.visible and (now := time.monotonic()) >= self._due:
            self._due = now + REFRESH_SECONDS
            text = escaped(note() if callable(note) else note)
            self._progress.update(self._task, completed=done, note=text)

    def simulated(self, simulation: Simulation, factor: float) -> None:
        """Show how far a simulation is, and how many times faster than what it simulates."""
        self.update(simulation.time, lambda: f"{factor:.0f} x real time")

    def __enter__(self) -> Bar:
        """Return the bar, which is on the screen already."""
        return self

    def __exit__(self, *error: object) -> None:
        """Take the bar off the screen."""
        if self.visible:
            self._progress.stop()
            self.visible = False


def watch(paths: Sequence[Path], changed: Callable[[], object]) -> int:
    """Call ``changed`` now and after every change of the files, until Ctrl-C; returns its code.

    Files are looked at now and then, which works on every file system. A change counts when they
    stay as they are from one look to the next, so that a file is seldom read half-written; when it
    is nonetheless, its completion is the next change.
    """
    handled: object = None
    before = [_state(path) for path in paths]
    with interrupts() as interrupt:
        while not interrupt():
            now = [_state(path) for path in paths]
            if now == before and now != handled:
                handled = now  # before the call: what is saved meanwhile is a change
                try:
                    changed()
                except KeyboardInterrupt:  # a run in it has heard the signal
                    break
            before = now
            time.sleep(EVERY)
    print("interrupted", file=sys.stderr)
    return INTERRUPTED


def _state(path: Path) -> tuple[int, ...]:
    """What changes with the content of a file; () while there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ()
    return status.st_mtime_ns, status.st_size, status.st_ino
