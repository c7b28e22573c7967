"""Run a crash test: draw, simulate, predict and compare, in blocks of cases.

The physics is the one that runs every world.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from physim.analysis.crashtest.case_worlds import case_world, way_of
from physim.analysis.crashtest.drafts import KINDS, STEPS, TIME_STEPS, Case, draw_case, place_of
from physim.analysis.crashtest.footprints import build_store
from physim.analysis.crashtest.prediction import Packed, approach, pack, predict
from physim.analysis.crashtest.report import (
    NEVER,
    ROW,
    CrashReport,
    Unexplained,
    Verdict,
    classify,
)
from physim.contacts import Phase
from physim.errors import PhysimError
from physim.geometry.shapes import IntArray
from physim.geometry.timed_paths import TimedPaths, timed_paths
from physim.simulation.engine import Physics
from physim.tolerances import CLOSING_SPEED, CONTACT, TIME, chord

BLOCK = 2000
"""Cases drawn at a time; each time step among them gets a space of its own."""


def simulate_cases(batch: Packed, movers: TimedPaths) -> tuple[IntArray, int]:
    """Drive every robot for STEPS steps; those of infinite mass follow ``movers``.

    Sample (M,) of the first physical contact of each case, or NEVER, and how many false contacts
    of the engine were kept out.
    """
    physics = Physics(
        batch.shapes, batch.walls, batch.start, batch.mass, batch.dt, movers=movers
    )  # fmt: skip
    count = np.diff(batch.first_robot)
    case_of = np.repeat(np.arange(len(count)), count)
    sample = np.full(len(count), NEVER, dtype=np.int64)
    rejected = 0
    for step in range(STEPS + 1):
        if step:
            # What has touched goes back where it came from: a pile-up would only cost time.
            going = sample[case_of, None] == NEVER
            physics.step(np.where(going, batch.twist, -batch.twist))
        rejected += len(physics.false_contacts)
        if len(rows := physics.contacts):
            case = case_of[rows["a"][rows["phase"] == Phase.BEGAN]]
            sample[case[sample[case] == NEVER]] = physics.step_number
    return sample, rejected


def crash_test(
    cases: int,
    seed: int = 0,
    *,
    folder: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
    stop: Callable[[], bool] | None = None,
) -> CrashReport:
    """Simulate ``cases`` random cases and compare first physical contacts with collision times.

    Case k depends on the seed and k alone. Each unexplained case is written as a world into
    ``folder``, which is made when it is needed. ``progress`` is called with the number of cases
    done; when ``stop`` returns True the test ends with the cases so far.
    """
    report, store = CrashReport(seed, cases), build_store(seed)
    for first in range(0, cases, BLOCK):
        numbers = range(first, min(first + BLOCK, cases))
        drawn = [draw_case(seed, k, place_of(k % BLOCK), store) for k in numbers]
        for dt in TIME_STEPS:
            if some := tuple(case for case in drawn if case.dt == dt):
                _compare(report, some, folder)
                if progress is not None:
                    progress(report.cases)
                if stop is not None and stop():
                    report.interrupted = report.cases < cases
                    return report
    return report


def _compare(
    report: CrashReport, cases: tuple[Case, ...], folder: str | os.PathLike[str] | None
) -> None:
    """Simulate and compare cases of one time step; what came of them goes into the report."""
    dt = cases[0].dt
    batch = pack(dt, cases)
    ways = [way_of(case.layout, dt) for case in cases if case.layout.second == "mover"]
    poses, times = [way[0] for way in ways], [way[1] for way in ways]
    movers = timed_paths(poses, times, ["once"] * len(ways))
    (sample, rejected), predicted = simulate_cases(batch, movers), predict(batch)
    xi = predicted.time
    seen = approach(batch, xi)  # by the true shapes and arcs, whoever predicted xi
    report.rejected += rejected
    rows, names = np.zeros(len(cases), ROW), tuple(KINDS)
    for k, case in enumerate(cases):
        at, time = int(sample[k]), float(xi[k])
        verdict, reason = classify(dt, at, time, float(seen.gap[k]), predicted.distance[k])
        rows["kind"][k], rows["verdict"][k] = names.index(case.kind), verdict
        if verdict == Verdict.UNEXPLAINED:
            known = time < math.inf
            one = Unexplained(
                case.number, case.kind, dt, None if at == NEVER else at, time if known else None,
                max(0, math.ceil((time - TIME) / dt)) if known else None, reason,
            )  # fmt: skip
            if folder is not None:
                path = Path(folder) / f"case-{case.number:06d}.yaml"
                try:
                    path.parent.mkdir(parents=True, exist_ok=True)
                except OSError as error:
                    raise PhysimError(f"{folder}: cannot be made ({error.strerror})") from None
                case_world(case, report.seed, reason).save(path)
                one = replace(one, world=str(path))
            report.unexplained.append(one)
    same, swept = rows["verdict"] == Verdict.SAME_SAMPLE, seen.swept < np.inf
    # how far straight motion between samples is from the arcs, both robots together
    off = np.array([chord(v, omega, lateral, dt) for v, omega, lateral in batch.twist])
    chords = np.add.reduceat(off, batch.first_robot[:-1])
    firm = same & swept & (seen.closing >= CLOSING_SPEED)
    beyond = np.abs(seen.swept_gap) - chords > 2.0 * CONTACT  # the swept check has a slack, too
    rows["lag"] = rows["off"] = np.nan
    rows["lag"][same] = sample[same] - xi[same] / dt
    rows["off"][firm] = np.abs(seen.swept[firm] - xi[firm])
    rows["beyond"] = beyond & same & swept
    rows["step"], rows["chord"], rows["swept"] = TIME_STEPS.index(dt), chords, swept
    rows["renewed"] = predicted.renewed > 0
    report.batches.append(rows)
    report.unexplained.sort(key=lambda one: one.number)
