"""Run a crash test: draw, throw, foresee, judge, in blocks of cases."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from physim.crashtest.batch import Batch, pack, place
from physim.crashtest.case import Case
from physim.crashtest.drawing import KINDS, TIME_STEPS, draw_case
from physim.crashtest.footprints import Store, build_store
from physim.crashtest.foresight import Foresight, foresee, sight
from physim.crashtest.replay import file_name, world_of
from physim.crashtest.report import Report, Unexplained
from physim.crashtest.throw import NEVER, Thrown, throw
from physim.crashtest.verdict import Judgement, Verdict, judge
from physim.errors import PhysimError
from physim.tolerances import CLOSING_SPEED, CONTACT, TIME, chord

BLOCK = 2000
"""Cases drawn at a time; each time step among them gets a space of its own."""

Foresee = Callable[[Batch], Foresight]


def crash_test(
    cases: int,
    seed: int = 0,
    *,
    folder: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
    stop: Callable[[], bool] | None = None,
    _foresee: Foresee = foresee,
    _guarded: bool = True,
) -> Report:
    """Throw ``cases`` random cases and compare first physical contacts with collision times.

    Case k depends on the seed and k alone. Each unexplained case is written as a world into
    ``folder``, which is made when it is needed. ``progress`` is told the number of cases done;
    when ``stop`` says True the test ends with the cases so far.
    """
    report, store = Report(seed, cases), build_store(seed)
    for first in range(0, cases, BLOCK):
        for batch in _batches(seed, range(first, min(first + BLOCK, cases)), store):
            _take(report, batch, throw(batch, _guarded), _foresee(batch), folder)
            if progress is not None:
                progress(report.cases)
            if stop is not None and stop():
                report.interrupted = report.cases < cases
                return _sorted(report)
    return _sorted(report)


def _sorted(report: Report) -> Report:
    report.unexplained.sort(key=lambda one: one.number)
    return report


def _batches(seed: int, numbers: range, store: Store) -> list[Batch]:
    """Cases of a block by time step; the place of a case is its place in the block."""
    drawn = [draw_case(seed, k, place(k % BLOCK), store) for k in numbers]
    groups = [tuple(case for case in drawn if case.dt == dt) for dt in TIME_STEPS]
    return [pack(dt, group) for dt, group in zip(TIME_STEPS, groups, strict=True) if group]


def _take(
    report: Report,
    batch: Batch,
    thrown: Thrown,
    found: Foresight,
    folder: str | os.PathLike[str] | None,
) -> None:
    """Judge the cases of a batch into the report."""
    dt, xi, sample = batch.dt, found.time, thrown.sample
    seen = sight(batch, xi)  # by the true shapes and arcs, whoever said xi
    judgements = [
        judge(dt, int(sample[k]), float(xi[k]), float(seen.gap[k]), found.distance[k])
        for k in range(len(batch.cases))
    ]
    verdict = np.array([int(one.verdict) for one in judgements])
    names = tuple(KINDS)
    report.kind.append(np.array([names.index(case.kind) for case in batch.cases]))
    report.step.append(np.full(len(verdict), TIME_STEPS.index(dt)))
    report.verdict.append(verdict)
    report.rejected += thrown.rejected
    same = verdict == Verdict.SAME_SAMPLE
    report.late.append(sample[same] - xi[same] / dt)
    report.renewed += int((found.renewed > 0).sum())
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
            _unexplained(batch.cases[k], int(sample[k]), float(xi[k]), judgements[k])
        )
        if folder is not None:
            _write(report, batch.cases[k], Path(folder))


def _chords(batch: Batch) -> np.ndarray:
    """(M,) [m] how far straight motion between samples is from the arcs, both robots together."""
    off = np.array([chord(v, omega, batch.dt) for v, omega in batch.command])
    return np.add.reduceat(off, batch.first_robot[:-1])


def _unexplained(case: Case, sample: int, xi: float, judgement: Judgement) -> Unexplained:
    known = xi < math.inf
    return Unexplained(
        number=case.number,
        kind=case.kind,
        dt=case.dt,
        physical_sample=None if sample == NEVER else sample,
        collision_time=xi if known else None,
        expected_sample=max(0, math.ceil((xi - TIME) / case.dt)) if known else None,
        reason=judgement.reason,
    )


def _write(report: Report, case: Case, folder: Path) -> None:
    """Write the world of the last unexplained case."""
    last = report.unexplained[-1]
    path = folder / file_name(case)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be made ({error.strerror})") from None
    world_of(case, report.seed, last.reason).save(path)
    report.unexplained[-1] = Unexplained(**{**vars(last), "world": str(path)})
