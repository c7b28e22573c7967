"""Runs tests in forks of a process that has loaded the libraries, but nothing of physim."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import runpy
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import coverage
import hypothesis
import pytest

from tests.mutation.rooms import ROOT

for name in ("scipy.spatial", "scipy.stats", "shapely", "pymunk", "h5py", "pydantic", "matplotlib"):
    importlib.import_module(name)

T = TypeVar("T")

COLLECTING = 120.0
"""s of CPU that imports may take"""
WAITING = 20.0
"""By how much longer anything may take by the clock: other processes run meanwhile"""


def forked(
    tasks: Iterable[T], run: Callable[[T], Any], jobs: int, log: Path
) -> Iterator[tuple[T, Any]]:
    """Run each task in a fork, ``jobs`` at a time; yield its answer, or a signal that ended it.

    Raises RuntimeError where ``run`` raised.
    """
    waiting, running = iter(tasks), dict[int, tuple[T, Path]]()
    with tempfile.TemporaryDirectory() as folder:
        try:
            while True:
                for task in waiting:
                    answer = Path(folder, f"{time.monotonic_ns()}")
                    sys.stdout.flush()
                    pid = os.fork()
                    if not pid:
                        _child(task, run, answer, log)
                    running[pid] = task, answer
                    if len(running) >= jobs:
                        break
                if not running:
                    return
                pid, status = os.wait()
                task, answer = running.pop(pid)
                _end(pid)
                if os.WIFSIGNALED(status):
                    yield task, signal.Signals(os.WTERMSIG(status)).name
                elif status:
                    raise RuntimeError(answer.read_text())
                else:
                    yield task, json.loads(answer.read_text())
        finally:
            for pid in running:
                _end(pid)


def _end(pid: int) -> None:
    """End a child with all that it started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)


def _child(task: T, run: Callable[[T], Any], answer: Path, log: Path) -> NoReturn:
    code = 1
    try:
        os.chdir(ROOT)
        os.setpgid(0, 0)
        with log.open("ab") as out, open(os.devnull) as nothing:
            for number, file in enumerate((nothing, out, out)):
                os.dup2(file.fileno(), number)
        answer.write_text(json.dumps(run(task)))
        sys.stdout.flush()
        code = 0
    except BaseException:
        answer.write_text(traceback.format_exc())
    os._exit(code)


def plain_kernels() -> None:
    """Let kernels be plain functions from now on."""
    os.environ["PHYSIM_KERNELS"] = "plain"


def limit(seconds: float, action: Any) -> None:
    """Take an action after s of CPU, or far more by the clock; and again, where it is swallowed."""
    for timer, number, factor in (
        (signal.ITIMER_PROF, signal.SIGPROF, 1.0),
        (signal.ITIMER_REAL, signal.SIGALRM, WAITING),
    ):
        signal.signal(number, action)
        signal.setitimer(timer, factor * seconds, 0.5)


class Tests:
    """Plug-in of pytest that runs all tests and watches them, or those with limits in their order.

    A test that takes longer ends the process, or is skipped where all are watched.
    """

    def __init__(self, limits: dict[str, float] | None, slow: float = 0.0) -> None:
        self.seconds: dict[str, float] = {}
        self.not_passed: dict[str, str] = {}
        self.coverage: coverage.Coverage | None = None
        self._limits, self._slow = limits, slow
        limit(COLLECTING, signal.SIG_DFL)

    def run(self, files: Iterable[str], *options: str) -> int:
        """Run files of tests; returns the exit code of pytest."""
        options += (f"--rootdir={ROOT}", "-q", "-p", "no:cacheprovider", "-p", "no:xdist")
        return pytest.main([*dict.fromkeys(files), "-o", "addopts=", *options], plugins=[self])

    def pytest_sessionstart(self) -> None:
        """Let hypothesis not look for a simpler failure."""
        phases = [hypothesis.Phase.explicit, hypothesis.Phase.generate]
        hypothesis.settings.register_profile("mutation", hypothesis.settings(), phases=phases)
        hypothesis.settings.load_profile("mutation")

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self._limits is not None:
            rank = {name: place for place, name in enumerate(self._limits)}
            items[:] = [one for one in items if one.nodeid in rank]
            items.sort(key=lambda one: rank[one.nodeid])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        def skip(*_: Any) -> None:
            self.not_passed[item.nodeid] = "slow"
            raise pytest.skip.Exception("slow")

        if self._limits is None:
            limit(self._slow, skip)
        else:
            limit(self._limits[item.nodeid], signal.SIG_DFL)
        if self.coverage is not None:
            self.coverage.switch_context(item.nodeid)
        began = time.process_time()
        try:
            return (yield)
        finally:
            limit(0.0, signal.SIG_IGN)
            self.seconds[item.nodeid] = time.process_time() - began

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if not report.passed:
            self.not_passed.setdefault(report.nodeid, report.outcome)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.not_passed.setdefault(report.nodeid, report.outcome)


def watched(file: str, sources: list[str], slow: float) -> dict[str, Any]:
    """Run a file of tests: seconds of tests, why some did not pass, which executes what lines."""
    plain_kernels()
    tests, include = Tests(None, slow), [str(ROOT / one) for one in sources]
    tests.coverage = coverage.Coverage(data_file=None, include=include, config_file=False)
    with tests.coverage.collect():
        tests.run([file])
    data, lines = tests.coverage.get_data(), dict[str, dict[int, list[str]]]()
    for source in data.measured_files():
        lines[str(Path(source).relative_to(ROOT))] = data.contexts_by_lineno(source)
    return {"seconds": tests.seconds, "not_passed": tests.not_passed, "lines": lines}


def first_red(limits: dict[str, float]) -> str:
    """Run tests in this order until one is red; return which, "" for none."""
    tests = Tests(limits)
    code = tests.run((name.partition("::")[0] for name in limits), "-x") if limits else 0
    red = [name for name, outcome in tests.not_passed.items() if outcome == "failed"]
    return red[0] if red else "no test is left" if code else ""


def first_red_with(file: str, text: str, limits: dict[str, float]) -> str:
    """`first_red` where a source file has another text."""
    swap = Path(__file__).parent / "swap"
    os.environ["PHYSIM_MUTATED_FILE"], os.environ["PHYSIM_MUTATED_TEXT"] = str(ROOT / file), text
    paths = [str(swap), *filter(None, [os.environ.get("PYTHONPATH")])]
    os.environ["PYTHONPATH"] = os.pathsep.join(paths)
    runpy.run_path(str(swap / "sitecustomize.py"))
    plain_kernels()
    return first_red(limits)
