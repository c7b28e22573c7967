"""Settings of every test: two tiers, the same examples in every run.

*Fast* is what ``python -m pytest`` runs. What is marked ``deep`` runs with ``--deep``, or a tenth
of it with ``--tenth N``: CI takes the tenth that the hash of the commit chooses.
"""

from __future__ import annotations

import hashlib
import os
import signal
from collections import defaultdict
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).parents[1]
SCREENS = {"browser"}
"""Folders whose tests are deep as a whole"""

settings.register_profile(
    "physim",
    deadline=None,  # tests share the machine, and mutation runs them plain
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("physim")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # as in the background of a shell: processes that tests start would be deaf to Ctrl-C, too
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("physim")
    group.addoption("--deep", action="store_true", help="run the deep tier, too")
    group.addoption(
        "--tenth", type=int, choices=range(10), metavar="0-9",
        help="run this tenth of the deep tier, too",
    )  # fmt: skip
    group.addoption("--rooms", action="store_true", help="print the seconds of each room")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "deep: slow or seldom needed; runs with --deep or --tenth")
    os.environ["PHYSIM_DEEP"] = "1" if config.getoption("--deep") else ""


def tenth_of(item: pytest.Item) -> int:
    """Which tenth of the deep tier a test belongs to, with all its cases if not ``each=True``."""
    each = any(mark.kwargs.get("each") for mark in item.iter_markers("deep"))
    name = item.nodeid if each else item.nodeid.partition("[")[0]
    return hashlib.sha256(name.encode()).digest()[0] % 10


def room_of(path: str) -> str:
    """The folder of a test, or ``tests`` itself."""
    parts = Path(path.partition("::")[0]).parts
    return parts[1] if len(parts) > 2 else "tests"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--deep"):
        return
    tenth = config.getoption("--tenth")
    for item in items:
        if SCREENS.intersection(item.path.parts):
            item.add_marker("deep")
    left_out = [
        item for item in items if item.get_closest_marker("deep") and tenth_of(item) != tenth
    ]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in set(left_out)]


def pytest_report_header(config: pytest.Config) -> str:
    tenth = config.getoption("--tenth")
    part = "no test" if tenth is None else f"tenth {tenth} of 0 to 9"
    return f"deep tier: {'all' if config.getoption('--deep') else part}"


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """The tests and seconds of each room, slowest first."""
    if not config.getoption("--rooms"):
        return
    seconds: defaultdict[str, float] = defaultdict(float)
    tests: defaultdict[str, int] = defaultdict(int)
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                seconds[room_of(report.nodeid)] += report.duration
                tests[room_of(report.nodeid)] += report.when == "call"
    terminalreporter.section("rooms")
    for room in sorted(seconds, key=lambda one: -seconds[one]):
        terminalreporter.line(f"{room:14} {tests[room]:5} tests {seconds[room]:7.1f} s")
