"""Makes each edit in a copy of its own, runs the tests of its room there, and says who noticed."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Lock
from typing import NamedTuple, TypeVar

from tests.sabotage.anchors import Sources
from tests.sabotage.edit import ROOMS, Edit
from tests.sabotage.kernels import keep_compiled
from tests.sabotage.notice import REPORT
from tests.sabotage.scratch import WHERE, copy_checkout, copy_of, environment, python

T = TypeVar("T")
R = TypeVar("R")

LONGEST = 400.0
"""[s] after which a run of tests is given up: several times what the slowest room takes"""
CRASHES = (-signal.SIGSEGV, -signal.SIGBUS, -signal.SIGFPE, -signal.SIGILL, -signal.SIGABRT)
"""What a process returns that an edited kernel has led astray: nobody can overlook that."""
NO_SUCH_TEST = 4
"""What pytest returns where a test is not there."""
JUDGES_COMPILING = ("basics",)
"""Rooms whose tests look at what is compiled anew: nothing is done about that in their copies."""


class RunError(Exception):
    """Why nothing can be said about edits; one line."""


class Tests(NamedTuple):
    """How a run of tests went."""

    failed: str | None
    """first test that failed"""
    ran: int


class Outcome(NamedTuple):
    """What became of an edit."""

    edit: Edit
    noticed: str | None
    """test of its room that turned red; None where none did"""
    seconds: float


class Sabotage:
    """Copies of a checkout in a folder, and the processes in them."""

    def __init__(self, root: Path, folder: Path, jobs: int) -> None:
        self.sources = Sources(root)
        self.base = folder / "unedited"
        self.stamp = ""
        self._root, self._folder = root, folder
        self._pool = ThreadPoolExecutor(jobs)
        self._stopped = Event()
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = Lock()
        self._preparing = Lock()

    def begin(self) -> None:
        """Make the unedited copy. Raises `RunError` unless it is what a process imports."""
        copy_checkout(self._root, self.base)
        done = self._process(
            python("-c", WHERE), self._folder, environment(self.base, self._folder / "temporary")
        )
        if done.returncode:
            raise RunError(f"physim cannot be imported: {' '.join(done.stdout.split())[-300:]}")
        files, self.stamp = json.loads(done.stdout)
        for file in files:
            if not Path(file).resolve().is_relative_to(self.base.resolve()):
                raise RunError(f"not the copy was imported: {file}")

    def close(self) -> None:
        """End all processes, start none any more, and wait until nobody is at work."""
        self._stopped.set()
        with self._lock:
            for process in self._running:
                _kill(process)
        self._pool.shutdown(wait=True, cancel_futures=True)

    def unedited(self, rooms: Iterable[str]) -> Iterator[tuple[str, Tests, float]]:
        """Run the tests of rooms as they are. Raises `RunError` where one fails."""

        def run(room: str) -> tuple[str, Tests, float]:
            begun = time.monotonic()
            return room, self._tests(self.base, ROOMS[room]), time.monotonic() - begun

        for room, tests, seconds in self._all(run, rooms):
            if tests.failed is not None:
                raise RunError(f"{room}: {tests.failed} fails unedited; nothing can be said")
            yield room, tests, seconds

    def edits(self, edits: Iterable[Edit]) -> Iterator[Outcome]:
        """Outcomes, as they come."""
        return self._all(self._outcome, edits)

    def _outcome(self, edit: Edit) -> Outcome:
        begun = time.monotonic()
        copy = Path(tempfile.mkdtemp(prefix="edit-", dir=self._folder)) / "checkout"
        try:
            with self._preparing:  # sources are parsed, which Python 3.11 does not bear in threads
                self._prepare(copy, edit)
            noticed = self._tests(copy, [edit.notices]).failed
            if noticed is None:
                noticed = self._tests(copy, ROOMS[edit.room]).failed
            return Outcome(edit, noticed, time.monotonic() - begun)
        finally:
            shutil.rmtree(copy.parent, ignore_errors=True)

    def _prepare(self, copy: Path, edit: Edit) -> None:
        """Make a copy of the checkout with the edit in it."""
        copy_of(self.base, copy)
        place = self.sources.place_of(edit)
        for stale in (copy / place.file).parent.glob(f"__pycache__/{place.file.stem}.*.pyc"):
            stale.unlink()
        (copy / place.file).write_text(place.text, encoding="utf-8")
        if edit.room not in JUDGES_COMPILING:
            keep_compiled(copy, place.file, self.stamp)

    def _tests(self, copy: Path, paths: Sequence[str]) -> Tests:
        """Run tests in a copy until one fails."""
        told = f"pytest {' '.join(paths)}"
        report = copy.parent / f"{copy.name}-{'-'.join(paths).replace('/', '.')[:100]}.json"
        temporary = copy.parent / f"{copy.name}-temporary"
        try:
            done = self._pytest(copy, paths, report, temporary)
        except subprocess.TimeoutExpired:
            return Tests(f"{paths[0]} (does not end)", 0)
        if done.returncode == NO_SUCH_TEST and "::" in paths[0]:
            return Tests(None, 0)
        if done.returncode in CRASHES:
            return Tests(f"{paths[0]} (crashes)", 0)
        if done.returncode not in (0, 1, 2) or not report.is_file():
            said = " ".join(done.stdout.split())[-300:]
            raise RunError(f"{told} ends with {done.returncode}: {said}")
        seen = json.loads(report.read_text(encoding="utf-8"))
        report.unlink()
        if seen["foreign"]:
            raise RunError(f"{told}: not the copy was imported: {seen['foreign'][0]}")
        if done.returncode and seen["failed"] is None:
            raise RunError(f"{told} is red, and no test says so")
        return Tests(seen["failed"], seen["ran"])

    def _pytest(
        self, copy: Path, paths: Sequence[str], report: Path, temporary: Path
    ) -> subprocess.CompletedProcess[str]:
        """Run tests in a copy until one fails; what they find goes to ``report``."""
        return self._process(
            python(
                "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider",
                "-p", "tests.sabotage.notice", f"--basetemp={temporary / report.stem}", *paths,
            ),
            copy, {**environment(copy, temporary), REPORT: str(report)},
        )  # fmt: skip

    def _process(
        self, command: list[str], folder: Path, variables: dict[str, str]
    ) -> subprocess.CompletedProcess[str]:
        """Run a process to its end, with all that it starts."""
        with self._lock:
            if self._stopped.is_set():
                raise RunError("stopped")
            process = subprocess.Popen(
                command, cwd=folder, env=variables, text=True, start_new_session=True,
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )  # fmt: skip
            self._running.add(process)
        try:
            out, _ = process.communicate(timeout=LONGEST)
        finally:
            _kill(process)
            with self._lock:
                self._running.discard(process)
        return subprocess.CompletedProcess(command, process.returncode, out)

    def _all(self, work: Callable[[T], R], items: Iterable[T]) -> Iterator[R]:
        """Results of some work as they come; the first error ends it."""
        for done in as_completed([self._pool.submit(work, item) for item in items]):
            yield done.result()


def _kill(process: subprocess.Popen[str]) -> None:
    """End a process with all that it started and that stayed in its session."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        process.poll()


@contextmanager
def sabotage(root: Path, jobs: int) -> Iterator[Sabotage]:
    """Copies of a checkout in a temporary folder, which is gone afterwards, whatever happens."""
    folder = Path(tempfile.mkdtemp(prefix="physim-sabotage-"))
    made = Sabotage(root, folder, jobs)
    try:
        made.begin()
        yield made
    finally:
        made.close()
        shutil.rmtree(folder, ignore_errors=True)
