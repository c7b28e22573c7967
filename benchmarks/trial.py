"""Ratio to a trial: another program for the same corridor, in a folder that has a ``measure.py``.

``python measure.py N SCENARIO STEPS REPEATS`` must print JSON with ``rate``, as its last line. The
targets are ratios: they hold on any machine.
"""

from __future__ import annotations

import shutil
import statistics
import sys
from pathlib import Path

from benchmarks.measuring import FAILED, Job, Store, ratio, run, runner, spread, table

SUBJECT = "trial"
TARGETS: dict[str, tuple[str, str, dict[int, float]]] = {
    "phys": ("drive", "physics, commands from outside", {10: 0.4, 100: 0.6, 1000: 0.7, 5000: 0.7}),
    "free": ("free", "paper's controller, free flow", {10: 0.5, 100: 0.7, 1000: 0.8, 5000: 0.8}),
    "danger": ("danger", "every decision in danger mode", {10: 0.7, 100: 0.7, 1000: 0.7}),
    "jam": ("jam", "jam, packed", {10: 0.4, 100: 0.5}),
}
"""Scenario of the trial: physim's kind, words, least ratio at each number of robots."""
STEPS = {"phys": {10: 20000, 100: 4000, 1000: 600, 5000: 100},
         "free": {10: 4000, 100: 600, 1000: 80, 5000: 20},
         "danger": {10: 600, 100: 60, 1000: 6},
         "jam": {10: 1200, 100: 1200}}  # fmt: skip
"""Steps of the trial: what takes about half a second."""
RECORDED = {10: 1200, 100: 400, 1000: 80, 5000: 20}
"""Steps with a record on disk."""
LEAST_WITH_RECORD, MOST_BY_DISTANCE = 0.6, 1.3
PLAIN = {10: 60e3, 100: 40e3, 1000: 40e3}
"""Robot-steps/s of a plain controller, on the day and machine of the targets."""
PACKED = 250e3
"""The same of a packed jam of 1,000."""


def groups(folder: Path, work: Path, quick: bool) -> list[list[Job]]:
    """Trial and physim in turn."""
    copy = work / "trial"
    if not copy.exists():
        shutil.copytree(folder, copy)
        for file in copy.rglob("*"):
            file.chmod(0o755 if file.is_dir() else 0o644)
        copy.chmod(0o755)
    seconds, found = 0.2 if quick else 0.7, []
    for scenario, (kind, _, targets) in TARGETS.items():
        for robots in targets:
            if quick and robots > 100:
                continue
            steps = STEPS[scenario][robots] // (3 if quick and scenario != "jam" else 1)
            command = (sys.executable, "measure.py", str(robots), scenario, str(steps), "1")
            found.append([
                Job(SUBJECT, "trial", f"{scenario}-{robots}", command, 300.0, copy),
                _own(scenario, robots, kind, seconds),
            ])  # fmt: skip
    for robots in (10, 100) if quick else (10, 100, 1000):
        found.append([_own(kind, robots, kind, seconds) for kind in ("default", "short", "plain")])
    if not quick:
        found.append([_own("jam", 1000, "jam", seconds)])
    for robots in (10, 100) if quick else RECORDED:
        steps = RECORDED[robots] // (4 if quick else 1)
        task = {"what": "record", "robots": robots, "steps": steps}
        job = runner(
            SUBJECT, "physim", f"record-{robots}", sys.executable, "run_physim.py", 300.0, **task
        )
        found.append([job])
    return found


def warm_up(work: Path) -> str:
    """Compile the trial; why it cannot be run, or nothing."""
    for scenario in ("free", "danger", "jam"):  # whose kernels are compiled as they are needed
        command = (sys.executable, "measure.py", "10", scenario, "600", "1")
        found = run(Job(SUBJECT, "trial", "warm", command, 600.0, work / "trial"))
        if FAILED in found:
            return str(found[FAILED])
    return ""


def _own(scenario: str, robots: int, kind: str, seconds: float) -> Job:
    most = 1200 if scenario == "jam" else 1000
    return runner(SUBJECT, "physim", f"{scenario}-{robots}", sys.executable, "run_physim.py", 300.0,
                  what="speed", robots=robots, kind=kind, seconds=seconds, most=most)  # fmt: skip


def text(store: Store) -> str:
    """The table, with the targets."""
    rows: list[list[str]] = []
    for scenario, (_, words, targets) in TARGETS.items():
        for n, target in targets.items():
            what = f"{scenario}-{n}"
            rows += _row(store, words, n, what, _cell(store, "trial", what), target,
                         store.values(SUBJECT, "trial", what))  # fmt: skip
    for n in RECORDED:
        without = store.values(SUBJECT, "physim", f"record-{n}", "without")
        rows += _row(store, "with record on disk, beside without", n, f"record-{n}",
                     spread(without), LEAST_WITH_RECORD, without)  # fmt: skip
    for n in PLAIN:
        rows += _row(store, f"default settings (L 1 m), beside L 0.3 m{_danger(store, n)}", n,
                     f"default-{n}", _cell(store, "physim", f"short-{n}"), 1.0 / MOST_BY_DISTANCE,
                     store.values(SUBJECT, "physim", f"short-{n}"))  # fmt: skip
    aims = [("plain", "a plain controller", n, aim) for n, aim in PLAIN.items()]
    for scenario, words, n, aim in [*aims, ("jam", "jam, packed", 1000, PACKED)]:
        rows += _row(store, words, n, f"{scenario}-{n}", f"{aim / 1e3:.0f} k", 1.0, [aim])
    head = ["", "N", "physim, robot-steps/s", "beside", "ratio", "target", ""]
    return f"## Beside the trial\n\n{INTRODUCTION}{table(head, rows)}\n"


def _row(
    store: Store, words: str, robots: int, what: str, beside: str, target: float,
    other: list[float],
) -> list[list[str]]:  # fmt: skip
    """One row; none where it was not asked for."""
    if not store.results(SUBJECT, "physim", what):
        return []
    found = ratio(store.values(SUBJECT, "physim", what), other)
    verdict = ["–", f"≥ {target:.2f}", "not measured"]
    if found is not None:
        verdict = [f"**{found:.2f}**", f"≥ {target:.2f}", "met" if found >= target else "short"]
    return [[words, f"{robots:,}", _cell(store, "physim", what), beside, *verdict]]


def _danger(store: Store, robots: int) -> str:
    """Shares of robots in danger mode with the one and with the other."""
    shares = [store.values(SUBJECT, "physim", f"{kind}-{robots}", "danger")
              for kind in ("default", "short")]  # fmt: skip
    if not all(shares):
        return ""
    one, other = (100.0 * statistics.median(each) for each in shares)
    return f" ({one:.0f} and {other:.0f} % in danger mode)"


INTRODUCTION = """\
In turn, in one session, processor time, steps of 0.05 s; medians and ranges over fresh processes.
Where the target is a rate, it is that of another day and machine. Both choose walls, paths and
starts of the same kind, not the same.

"""


def _cell(store: Store, who: str, what: str) -> str:
    return store.why_not(SUBJECT, who, what) or spread(store.values(SUBJECT, who, what))
