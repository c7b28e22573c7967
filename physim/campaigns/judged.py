"""Runs of many seeds, each held against the exact checks of the validation, told in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from typing import NamedTuple

from physim.analysis.validation import judge as validated
from physim.analysis.validation import report
from physim.analysis.validation.seeds import SeedResult
from physim.campaigns.one_run import simulation_of
from physim.campaigns.runner import outcomes
from physim.campaigns.spec import RunSpec
from physim.campaigns.worker import Job, Stop
from physim.errors import PhysimError
from physim.simulation.run import record_run


class Judged(NamedTuple):
    """What is kept of the validation of one run."""

    result: SeedResult
    report: str
    """the page about it, where it is not as it should be"""


def judged(
    specs: Iterable[RunSpec],
    source: str,
    executor: Executor,
    stop: Stop,
    progress: Callable[[int], None] = lambda done: None,
) -> Iterator[tuple[int, Judged | PhysimError]]:
    """Seeds and what came of them, in the order of ``specs``; a run that fails gives its error.

    ``source`` is what reports call the runs. When ``stop`` says True, those that were done without
    a gap have been told; a fault of the program is raised.
    """
    waiting: dict[int, Judged | PhysimError] = {}
    turn = done = 0
    jobs = (((k, one.seed), Job(one.note, judge, (one, source))) for k, one in enumerate(specs))
    seeds: dict[int, int] = {}
    for outcome in outcomes(jobs, executor, stop):
        k, seed = outcome.key
        if outcome.error is not None and not isinstance(outcome.error, PhysimError):
            raise outcome.error
        if (found := outcome.error or outcome.result) is None:
            continue
        waiting[k], seeds[k] = found, seed
        done += 1
        progress(done)
        while turn in waiting:
            yield seeds.pop(turn), waiting.pop(turn)
            turn += 1


def judge(spec: RunSpec, source: str, stop: Stop) -> Judged | None:
    """Run and validate in a worker; None when it was stopped."""
    with record_run(simulation_of(spec), stop=stop) as record:
        if record.ended == "interrupted":  # half a run says nothing about its seed
            return None
        found = validated(record, None, source=source)
        return Judged(SeedResult.of(spec.seed, found), report(found) if found.code else "")


__all__ = ["Judged", "judged"]
