"""Ratio to a trial: another program for the same corridor, in a folder that has a ``measure.py``.

``python measure.py N SCENARIO STEPS REPEATS`` must print JSON with ``rate``, as its last line. The
targets are ratios: they hold on any machine.
"""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path

from benchmarks.measuring import FAILED, Job, Store, cell, ratio, run, runner, table

SUBJECT = "trial"
TARGETS: dict[str, tuple[str, str, dict[int, float]]] = {
    "phys": ("drive", "physics, commands from outside", {10: 0.4, 100: 0.6, 1000: 0.7, 5000: 0.7}),
    "free": ("free", "paper's controller, free flow", {10: 0.5, 100: 0.7, 1000: 0.8, 5000: 0.8}),
    "danger": ("danger", "every decision in danger mode", {10: 0.7, 100: 0.7, 1000: 0.7}),
    "jam": ("dead_end", "jam of 60 s", {10: 0.4, 100: 0.5}),
    "walls": ("free", "free flow, 10,000 segments in 64 m", {10: 1.0}),
}
"""Scenario of the trial: physim's kind, words, least ratio at each number of robots."""
STEPS = {"phys": {10: 10000, 100: 2000, 1000: 300, 5000: 50},
         "free": {10: 2000, 100: 300, 1000: 40, 5000: 10},
         "danger": {10: 300, 100: 30, 1000: 4},
         "jam": {10: 1200, 100: 1200}}  # fmt: skip
"""Steps of the trial, made twice: what takes about half a second."""
SEGMENTS = 10_000


def groups(folder: Path, work: Path, quick: bool) -> list[list[Job]]:
    """Trial and physim in turn."""
    copy = work / "trial"
    if not copy.exists():
        shutil.copytree(folder, copy)
        for file in copy.rglob("*"):
            file.chmod(0o755 if file.is_dir() else 0o644)
        copy.chmod(0o755)
    seconds, found = 0.1 if quick else 0.35, []
    for scenario, (kind, _, targets) in TARGETS.items():
        for robots in targets:
            if quick and robots > 100:
                continue
            found.append([
                _theirs(scenario, robots, copy, seconds), own(SUBJECT, scenario, robots, kind,
                                                              seconds),
            ])  # fmt: skip
    return found


def _theirs(scenario: str, robots: int, folder: Path, seconds: float) -> Job:
    what = f"{scenario}-{robots}"
    if scenario == "walls":
        job = runner(SUBJECT, "trial", what, sys.executable, "run_trial.py", 300.0, robots=robots,
                     segments=SEGMENTS, seconds=seconds, most=1000)  # fmt: skip
        return replace(job, cwd=folder)
    command = (sys.executable, "measure.py", str(robots), scenario, str(STEPS[scenario][robots]),
               "2")  # fmt: skip
    return Job(SUBJECT, "trial", what, command, 300.0, folder)


def own(subject: str, what: str, robots: int, kind: str, seconds: float, **walls: int) -> Job:
    """The same of physim."""
    is_jam = kind in ("jam", "dead_end")
    if what == "walls":
        walls = {"segments": SEGMENTS}
    return runner(
        subject, "physim", f"{what}-{robots}", sys.executable, "run_physim.py", 300.0,
        what="speed", robots=robots, kind=kind, seconds=seconds, most=1200 if is_jam else 1000,
        whole=is_jam, walls=walls,
    )  # fmt: skip


def warm_up(work: Path) -> str:
    """Compile the trial; why it cannot be run, or nothing."""
    for scenario in ("free", "danger", "jam"):  # whose kernels are compiled as they are needed
        command = (sys.executable, "measure.py", "10", scenario, "600", "1")
        found = run(Job(SUBJECT, "trial", "warm", command, 600.0, work / "trial"))
        if FAILED in found:
            return str(found[FAILED])
    return ""


def text(store: Store) -> str:
    """The table, with the targets."""
    rows = []
    for scenario, (_, words, targets) in TARGETS.items():
        for robots, target in targets.items():
            what = f"{scenario}-{robots}"
            if not store.results(SUBJECT, "physim", what):
                continue
            found = ratio(*(store.values(SUBJECT, who, what) for who in ("physim", "trial")))
            verdict = ["–", f"≥ {target:.2f}", "not measured"]
            if found is not None:
                is_met = "met" if found >= target else "short"
                verdict = [f"**{found:.2f}**", f"≥ {target:.2f}", is_met]
            rates = [cell(store, SUBJECT, who, what) for who in ("physim", "trial")]
            rows.append([words, f"{robots:,}", *rates, *verdict])
    head = ["", "N", "physim, robot-steps/s", "trial", "ratio", "target", ""]
    return f"## Beside the trial\n\n{INTRODUCTION}{table(head, rows)}\n"


INTRODUCTION = """\
In turn, in one session, processor time, steps of 0.05 s; medians and ranges over fresh processes.
Both choose walls, paths and starts of the same kind, not the same. In danger mode physim decides by
(13) alone, the dearer rule; the trial by (12) where a robot is nearer than 0.5 m. The trial keeps
no record, checks no command and knows neither wall ends nor compound parts.

"""
