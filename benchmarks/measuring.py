"""Measurements: a process each, in turn, kept one by one so that tables can be written again."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
Result = dict[str, Any]
FAILED = "failed"
"""Key of a result that says why there is none."""


@dataclass(frozen=True)
class Job:
    """One measurement: who measures what, and the process that does it."""

    subject: str
    who: str
    what: str
    command: tuple[str, ...]
    timeout: float = 120.0
    cwd: Path = ROOT
    environment: dict[str, str] = field(default_factory=dict)
    takes_time: bool = False
    """whether the time of the process itself is what is measured"""


def runner(
    subject: str,
    who: str,
    what: str,
    python: str,
    script: str,
    timeout: float = 120.0,
    /,
    **task: Any,
) -> Job:
    """Measurement by a script of ``runners/``, which is given its task as JSON."""
    command = (python, str(HERE / "runners" / script), json.dumps(task))
    return Job(subject, who, what, command, timeout)


class Store:
    """Results on disk, a file each: ``folder/SUBJECT/WHO.WHAT.ROUND.json``."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def _file(self, subject: str, who: str, what: str, number: int) -> Path:
        return self.folder / subject / f"{who}.{what}.{number}.json"

    def get(self, job: Job, number: int) -> Result | None:
        """Result of a round, or None where there is none yet."""
        try:
            file = self._file(job.subject, job.who, job.what, number)
            found: Result = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found

    def put(self, job: Job, number: int, result: Result) -> None:
        """Keep a result."""
        file = self._file(job.subject, job.who, job.what, number)
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(".part")
        part.write_text(json.dumps(result, indent=1), encoding="utf-8")
        part.replace(file)

    def results(self, subject: str, who: str, what: str) -> list[Result]:
        """Every result of a measurement, failures too."""
        files = sorted((self.folder / subject).glob(f"{who}.{what}.*.json"))
        return [json.loads(file.read_text(encoding="utf-8")) for file in files]

    def values(self, subject: str, who: str, what: str, key: str = "rate") -> list[float]:
        """One figure of every round that has it."""
        found = self.results(subject, who, what)
        return [one[key] for one in found if FAILED not in one and one.get(key) is not None]

    def why_not(self, subject: str, who: str, what: str) -> str:
        """Why there is no result; empty where there is one or none was asked for."""
        found = self.results(subject, who, what)
        if not found or any(FAILED not in one for one in found):
            return ""
        return str(found[0][FAILED])


INSTALLED = {"PYTHONDONTWRITEBYTECODE": ""}
"""Sources are kept as byte code, as an installation keeps them, whatever the shell says: to compile
physim's own anew at every start takes a tenth of a short command."""


def run(job: Job) -> Result:
    """Do one measurement; what goes wrong is its result."""
    before, began = os.times(), time.perf_counter()
    try:
        done = subprocess.run(
            job.command, cwd=job.cwd, timeout=job.timeout, capture_output=True, text=True,
            env={**os.environ, **INSTALLED, **job.environment},
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return {FAILED: f"not done in {job.timeout:g} s"}
    except OSError as error:
        return {FAILED: f"cannot be started: {error.strerror}"}
    after, wall = os.times(), time.perf_counter() - began
    lines = [line.strip() for line in (done.stderr + done.stdout).splitlines() if line.strip()]
    if done.returncode:
        return {FAILED: lines[-1][:200] if lines else f"exit code {done.returncode}"}
    if job.takes_time:
        user = after.children_user - before.children_user
        return {"wall": wall, "cpu": user + after.children_system - before.children_system}
    try:
        found: Result = json.loads(done.stdout.strip().splitlines()[-1])
    except (ValueError, IndexError):
        return {FAILED: "printed no result"}
    return found


def in_turn(
    groups: Iterable[Sequence[Job]], rounds: int, store: Store, resume: bool, progress: Progress
) -> None:
    """Run the jobs of each group in turn, round by round, every other round backwards.

    One that failed is not tried again in later rounds. With ``resume`` results that are there are
    kept, failures are not.
    """
    for group in groups:
        given_up: set[tuple[str, str, str]] = set()
        for number in range(rounds):
            for job in group if number % 2 == 0 else group[::-1]:
                known = store.get(job, number) if resume else None
                if known is None or FAILED in known:
                    if job_key(job) in given_up:
                        continue
                    progress.tell(f"{job.subject}: {job.who} {job.what}")
                    known = run(job)
                    if is_uneven(known):  # once more: something else was in one of its spans
                        known = {**run(job), "again": True}
                    store.put(job, number, known)
                    if FAILED in known:
                        given_up.add(job_key(job))
                progress.step()


def is_uneven(found: Result) -> bool:
    """Whether the spans of one measurement differ more than twice."""
    spans = found.get("spans") or [found.get("least", 1.0), found.get("most", 1.0)]
    return bool(max(spans) > 2.0 * min(spans))


def job_key(job: Job) -> tuple[str, str, str]:
    """Names of a job: all that tells it from others."""
    return job.subject, job.who, job.what


class Progress:
    """One line on a terminal; nothing in a pipe."""

    def __init__(self, total: int) -> None:
        self.total, self.done, self.began = total, 0, time.monotonic()
        self.is_shown = sys.stderr.isatty()

    def tell(self, note: str) -> None:
        """Say what is being done."""
        if self.is_shown:
            passed = time.monotonic() - self.began
            print(f"\r\033[K{self.done}/{self.total}, {passed:.0f} s  {note}"[:100], end="",
                  file=sys.stderr, flush=True)  # fmt: skip

    def step(self) -> None:
        """One more is done."""
        self.done += 1

    def end(self) -> None:
        """Leave an empty line."""
        if self.is_shown:
            print("\r\033[K", end="", file=sys.stderr)


def ratio(one: Sequence[float], other: Sequence[float]) -> float | None:
    """Median of one over median of the other; None where either is missing."""
    if not one or not other:
        return None
    return statistics.median(one) / statistics.median(other)


def amount(value: float) -> str:
    """A rate in three figures: 12.3 k, 1.23 M."""
    for limit, unit in ((1e6, " M"), (1e3, " k")):
        if value >= limit:
            return (
                f"{value / limit:.3g}{unit}"
                if value < 1000 * limit
                else f"{value / limit:.0f}{unit}"
            )
    return f"{value:.3g}"


def spread(values: Sequence[float]) -> str:
    """Median and range of rates."""
    if not values:
        return "–"
    middle = amount(statistics.median(values))
    if len(values) == 1:
        return middle
    return f"{middle} ({amount(min(values))}–{amount(max(values))})"


def cell(store: Store, subject: str, who: str, what: str) -> str:
    """Rates of a measurement in a table, or why there are none."""
    failed = store.why_not(subject, who, what)
    mark = "".join(UNEVEN for one in store.results(subject, who, what) if is_uneven(one))
    return failed or spread(store.values(subject, who, what)) + mark


UNEVEN = "†"
"""Stands behind a rate for every process whose spans differ more than twice, twice over."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(row)} |\n" for row in lines)
