"""Run a crash test: draw, simulate, predict and compare, in blocks of cases.

The physics is the one that runs every world.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from physim.analysis.crashtest.case import STEPS, Case, build_store
from physim.analysis.crashtest.drawing import (
    KINDS,
    TIME_STEPS,
    Batch,
    case_world,
    draw_case,
    pack,
    place_of,
)
from physim.analysis.crashtest.prediction import Prediction, approach, predict
from physim.analysis.crashtest.report import (
    NEVER,
    Classified,
    CrashReport,
    Unexplained,
    Verdict,
    classify,
)
from physim.contacts import Phase
from physim.errors import PhysimError
from physim.geometry.shapes import IntArray
from physim.simulation.engine import Physics
from physim.tolerances import CLOSING_SPEED, CONTACT, TIME, chord


class Simulated(NamedTuple):
    """What the engine found in M cases."""

    sample: IntArray
    """(M,) of the first physical contact, or NEVER"""
    rejected: int
    """false contacts of the engine that were kept out"""


def simulate_cases(batch: Batch) -> Simulated:
    """Drive every robot for STEPS steps."""
    physics = Physics(batch.shapes, batch.walls, batch.start, batch.mass, batch.dt)
    case_of = np.repeat(np.arange(len(batch.cases)), np.diff(batch.first_robot))
    sample = np.full(len(batch.cases), NEVER, dtype=np.int64)
    command = batch.command.copy()
    _note(physics, case_of, sample)
    for _ in range(STEPS):
        # What has touched goes back where it came from: a pile-up would only cost time.
        command = np.where(sample[case_of, None] == NEVER, batch.command, -batch.command)
        physics.step(command)
        _note(physics, case_of, sample)
    return Simulated(sample, physics.rejected)


def _note(physics: Physics, case_of: IntArray, sample: IntArray) -> None:
    """Note the cases that touch for the first time at the present sample."""
    rows = physics.contacts
    if not len(rows):
        return
    case = case_of[rows["a"][rows["phase"] == Phase.BEGAN]]
    sample[case[sample[case] == NEVER]] = physics.step_number


BLOCK = 2000
"""Cases drawn at a time; each time step among them gets a space of its own."""


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
    report = CrashReport(seed, cases)
    for batch in _batches(seed, cases):
        _compare(report, batch, simulate_cases(batch), predict(batch), folder)
        if progress is not None:
            progress(report.cases)
        if stop is not None and stop():
            report.interrupted = report.cases < cases
            break
    report.unexplained.sort(key=lambda one: one.number)
    return report


def _batches(seed: int, cases: int) -> Iterator[Batch]:
    """Cases, block after block, by time step; the place of a case is its place in the block."""
    store = build_store(seed)
    for first in range(0, cases, BLOCK):
        numbers = range(first, min(first + BLOCK, cases))
        drawn = [draw_case(seed, k, place_of(k % BLOCK), store) for k in numbers]
        for dt in TIME_STEPS:
            if group := tuple(case for case in drawn if case.dt == dt):
                yield pack(dt, group)


def _compare(
    report: CrashReport,
    batch: Batch,
    simulated: Simulated,
    predicted: Prediction,
    folder: str | os.PathLike[str] | None,
) -> None:
    """Compare the cases of a batch; their verdicts go into the report."""
    dt, xi, sample = batch.dt, predicted.time, simulated.sample
    seen = approach(batch, xi)  # by the true shapes and arcs, whoever predicted xi
    classified = [
        classify(dt, int(sample[k]), float(xi[k]), float(seen.gap[k]), predicted.distance[k])
        for k in range(len(batch.cases))
    ]
    verdict = np.array([int(one.verdict) for one in classified])
    names = tuple(KINDS)
    report.kind.append(np.array([names.index(case.kind) for case in batch.cases]))
    report.step.append(np.full(len(verdict), TIME_STEPS.index(dt)))
    report.verdict.append(verdict)
    report.rejected += simulated.rejected
    same = verdict == Verdict.SAME_SAMPLE
    report.lag.append(sample[same] - xi[same] / dt)
    report.renewed += int((predicted.renewed > 0).sum())
    chords = _chords(batch)
    swept = same & (seen.swept < np.inf)
    off = np.abs(seen.swept_gap[swept]) - chords[swept]
    report.swept_beyond += int((off > 2.0 * CONTACT).sum())  # the swept check has a slack, too
    firm = swept & (seen.closing >= CLOSING_SPEED)
    report.swept.append(np.stack((np.abs(seen.swept[firm] - xi[firm]), chords[firm]), axis=1))
    graze = verdict == Verdict.GRAZE
    report.grazes.append(np.stack((seen.swept < np.inf, chords == 0.0), axis=1)[graze])
    for k in np.flatnonzero(verdict == Verdict.UNEXPLAINED):
        report.unexplained.append(
            _unexplained(batch.cases[k], int(sample[k]), float(xi[k]), classified[k])
        )
        if folder is not None:
            _write(report, batch.cases[k], Path(folder))


def _chords(batch: Batch) -> np.ndarray:
    """(M,) [m] how far straight motion between samples is from the arcs, both robots together."""
    off = np.array([chord(v, omega, batch.dt) for v, omega in batch.command])
    return np.add.reduceat(off, batch.first_robot[:-1])


def _unexplained(case: Case, sample: int, xi: float, classified: Classified) -> Unexplained:
    known = xi < math.inf
    return Unexplained(
        number=case.number,
        kind=case.kind,
        dt=case.dt,
        physical_sample=None if sample == NEVER else sample,
        collision_time=xi if known else None,
        expected_sample=max(0, math.ceil((xi - TIME) / case.dt)) if known else None,
        reason=classified.reason,
    )


def _write(report: CrashReport, case: Case, folder: Path) -> None:
    """Write the world of the last unexplained case."""
    last = report.unexplained[-1]
    path = folder / f"case-{case.number:06d}.yaml"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be made ({error.strerror})") from None
    case_world(case, report.seed, last.reason).save(path)
    report.unexplained[-1] = replace(last, world=str(path))
