"""Jobs in worker processes: all done once, in any order, and ended when told to."""

from __future__ import annotations

import multiprocessing
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
    found = do_all(jobs, follow, 2, stop, progress)
    assert not multiprocessing.active_children()
    return found


def test_results_by_key() -> None:
    seen: list[tuple[int, int, str]] = []
    found = run([(k, echo(k * k)) for k in range(7)], progress=lambda *now: seen.append(now))
    assert found == {k: k * k for k in range(7)}
    assert all(total == 7 and 0 <= done < 7 and note == "echo" for done, total, note in seen)


def test_two_processes_share_the_work() -> None:
    assert len(set(run([(k, Job("echo", sample.process)) for k in range(8)]).values())) == 2


def test_jobs_that_follow() -> None:
    def follow(key: Any, found: dict[Any, int]) -> list[tuple[Any, Job]]:
        return [((key, "next"), echo(found[key] + 1))] if isinstance(key, int) else []

    found = run([(0, echo(10)), (1, echo(20))], follow)
    assert found == {0: 10, (0, "next"): 11, 1: 20, (1, "next"): 21}


def test_no_jobs() -> None:
    assert run([]) == {}


def test_stopped_with_what_is_done() -> None:
    done: list[int] = []
    found = run(
        [("quick", echo(1)), *((k, Job("echo", sample.endless)) for k in range(4))],
        stop=lambda: bool(done and done[-1]),
        progress=lambda count, total, note: done.append(count),
    )
    assert found == {"quick": 1}


def test_bad_input_of_a_job_is_one_line() -> None:
    with pytest.raises(PhysimError, match=r"^what was given is wrong$"):
        run([(0, Job("echo", sample.refused)), (1, Job("echo", sample.endless))])


def test_a_full_disk_is_one_line() -> None:
    with pytest.raises(PhysimError, match=r"^echo: No space left on device$"):
        run([(0, Job("echo", sample.disk_full))])


def test_a_fault_of_the_program_tells_where() -> None:
    with pytest.raises(RuntimeError, match=r"echo:\n(.|\n)*ZeroDivisionError"):
        run([(0, Job("echo", sample.faulty))])


def test_a_killed_worker_is_told() -> None:
    with pytest.raises(PhysimError, match="a worker process was killed at echo"):
        run([(0, Job("echo", sample.killed))])
