"""Many jobs: all done once, in any order, and ended when told to."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pytest

from physim.errors import PhysimError
from tests.campaigns import sample_jobs as sample
from tests.helpers import inside

Job, do_all = inside("physim.campaigns", "Job", "do_all")


def echo(value: int) -> Job:
    return Job("echo", sample.echo, (value,))


def run(
    jobs: Iterable[tuple[Any, Any]],
    follow: Callable[[Any, Any], Any] = lambda key, found: (),
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[int, int, str], None] = lambda done, total, note: None,
) -> dict[Any, Any]:
    found: dict[Any, Any] = do_all(jobs, follow, 2, stop, progress)
    return found


@pytest.mark.usefixtures("in_process")
def test_results_by_key_also_of_jobs_that_follow() -> None:
    def follow(key: Any, found: dict[Any, int]) -> list[tuple[Any, Job]]:
        return [((key, "next"), echo(found[key] + 1))] if isinstance(key, int) else []

    seen: list[tuple[int, int, str]] = []
    found = run([(0, echo(10)), (1, echo(20))], follow, progress=lambda *now: seen.append(now))
    assert found == {0: 10, (0, "next"): 11, 1: 20, (1, "next"): 21}
    assert all(0 <= done < total <= 4 and note == "echo" for done, total, note in seen)


@pytest.mark.usefixtures("in_process")
@pytest.mark.parametrize(
    ("work", "error", "told"),
    [
        (sample.refused, PhysimError, r"^what was given is wrong$"),
        (sample.disk_full, PhysimError, r"^echo: No space left on device$"),
    ],
)
def test_bad_input_of_a_job_and_a_full_disk_are_one_line(
    work: Any, error: type[Exception], told: str
) -> None:
    with pytest.raises(error, match=told):
        run([(0, Job("echo", work)), (1, echo(1))])


@pytest.mark.deep
def test_two_processes_share_the_work() -> None:
    assert len(set(run([(k, Job("echo", sample.process)) for k in range(8)]).values())) == 2


@pytest.mark.deep
def test_stopped_with_what_is_done() -> None:
    done: list[int] = []
    found = run(
        [("quick", echo(1)), *((k, Job("echo", sample.endless)) for k in range(4))],
        stop=lambda: bool(done and done[-1]),
        progress=lambda count, total, note: done.append(count),
    )
    assert found == {"quick": 1}


@pytest.mark.deep
@pytest.mark.parametrize(
    ("work", "error", "told"),
    [
        (sample.faulty, RuntimeError, r"echo:\n(.|\n)*ZeroDivisionError"),
        (sample.killed, PhysimError, "a worker process was killed at echo"),
    ],
)
def test_a_fault_of_the_program_and_a_killed_worker_are_told(
    work: Any, error: type[Exception], told: str
) -> None:
    with pytest.raises(error, match=told):
        run([(0, Job("echo", work))])
