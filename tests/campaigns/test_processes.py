"""Jobs of worker processes that are killed, hang or are stopped: each ends, and others go on."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import wait
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from physim.campaigns import Processes, pool
from physim.errors import PhysimError
from tests.campaigns import sample_jobs as sample
from tests.helpers import inside

Job, LostError, OverdueError = inside("physim.campaigns", "Job", "LostError", "OverdueError")

do_all = inside("physim.campaigns", "do_all")

deep = pytest.mark.deep

LONGEST = 120.0
"""[s] for a job that takes none"""


def ids() -> list[int]:
    """Numbers of the worker processes."""
    return [one.pid for one in multiprocessing.active_children() if one.pid is not None]


@pytest.fixture
def executor() -> Iterator[Processes]:
    made = Processes(2)
    yield made
    made.shutdown(cancel_futures=True)
    assert not multiprocessing.active_children()


@deep
@pytest.mark.parametrize(
    ("work", "given", "limit", "error", "text"),
    [
        (sample.killed, (), None, LostError, "exit code 9"),
        (sample.killed_by_the_system, (), None, LostError, "SIGKILL"),
        (sample.raises_as_ctrl_c_does, (), None, LostError, "bad: it raised KeyboardInterrupt"),
        (sample.writes_into_pipes, (), None, LostError, "a worker process was killed at bad"),
        (sample.writes_everywhere, (), None, LostError, "bad"),
        (sample.leaves_a_copy, (2.0 * LONGEST, 3), None, LostError, "bad"),
        (sample.leaves_a_copy, (2.0 * LONGEST, None), 1.0, OverdueError, "not done after 1 s"),
        (sample.unpicklable, (), None, RuntimeError, "bad"),
        (sample.hangs, (), 1.0, OverdueError, "not done after 1 s"),
        (sample.hangs_in_native_code, (), 1.0, OverdueError, "not done after 1 s"),
    ],
)
def test_whatever_a_job_does_to_its_process_the_next_is_done(
    executor: Processes, work: Any, given: tuple[Any, ...], limit: float | None,
    error: type[Exception], text: str,
) -> None:  # fmt: skip
    """What it forked has its end of its pipe, which looks open for as long as that lives."""
    begun = time.monotonic()
    bad = [executor.begin(Job("bad", work, given, limit)) for _ in range(2)]
    good = [executor.begin(Job("good", sample.echo, (k,), 60.0)) for k in range(3)]
    for future in bad:
        with pytest.raises(error, match=text):
            future.result(timeout=LONGEST)
    assert [future.result(timeout=LONGEST) for future in good] == [0, 1, 2]
    executor.shutdown(cancel_futures=True)
    assert time.monotonic() - begun < 2.0 * LONGEST, "it waited for the copy"


@deep
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_what_ends_a_command_does_not_end_its_workers(
    executor: Processes, number: signal.Signals, capfd: pytest.CaptureFixture[str]
) -> None:
    """A terminal sends it to all, also to those that are still importing what they need."""
    futures = [executor.begin(Job("good", sample.echo, (k,))) for k in range(2)]
    while not all(future.done() for future in futures):
        for worker in ids():
            os.kill(worker, number)
        wait(futures, timeout=0.005)
    assert [future.result() for future in futures] == [0, 1]
    assert capfd.readouterr().err == ""


@deep
def test_what_the_code_of_one_leaves_behind_is_not_met_by_that_of_another(
    executor: Processes,
) -> None:
    told = []
    for name in ("", "a", "b", "", "a", "b", "c", "d", "a", ""):
        job = Job("leaves", sample.leave_behind, (name,), code=name)
        told.append((name, *executor.begin(job).result(timeout=LONGEST)))
        assert len(ids()) <= 5
    assert all(found in (None, name or None) for name, _, found in told)
    again = [number for name, number, _ in told if name == "a"]
    assert again[0] == again[1]  # it had waited for more of the same


UNGUARDED = {
    "sweep": "sweep([spec_of(world, seed) for seed in range(2)], 'campaign', Processes(2))",
    "command": "sys.exit(main(['sweep', 'straight', '--seeds', '0:2', '--set', "
    "'time.duration=0.5', '-o', 'campaign', '--workers', '2', '--quiet']))",
}  # fmt: skip
"""What a program without a guard does, which its workers do again as they import it"""
HEAD = """\
import sys
import physim
from physim import PhysimError
from physim.campaigns import Processes, spec_of, sweep
from physim.cli import main
world = physim.load_world("straight", overrides=["time.duration=0.5"])
"""


@deep
@pytest.mark.parametrize("how", UNGUARDED)
def test_a_program_that_begins_runs_as_it_is_imported_is_told(tmp_path: Path, how: str) -> None:
    """A worker that swept, too, waited without end for runs that its parent had claimed."""
    (tmp_path / "begins.py").write_text(f"{HEAD}{UNGUARDED[how]}\n")
    process = subprocess.Popen(
        [sys.executable, "begins.py"], cwd=tmp_path, start_new_session=True, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        _, err = process.communicate(timeout=LONGEST)  # as long as anything has its pipes
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    *before, last = err.splitlines()
    assert process.returncode != 0
    assert last.endswith(pool.UNGUARDED)
    assert err.count(pool.UNGUARDED) == 1
    assert err.count("Traceback") == (how != "command")
    assert before == [] or how != "command"


@deep
def test_jobs_that_do_not_end_when_told_to_are_stopped_not_lost(
    executor: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as a controller that is slow to decide: what is lost counts as a failure."""
    monkeypatch.setattr(pool, "LAST_SECONDS", 0.5)
    executor.begin(Job("good", sample.echo, (4,))).result()
    futures = [
        executor.begin(Job("deaf", sample.hangs)),
        executor.begin(Job("starts", sample.hangs)),
    ]
    executor.halt()
    assert not wait(futures, timeout=LONGEST).not_done
    assert [future.result() for future in futures] == [None, None]


@deep
def test_what_a_job_prints_does_not_act_on_the_terminal(
    executor: Processes, capfd: pytest.CaptureFixture[str]
) -> None:
    """And stands beside what the command itself prints."""
    executor.begin(Job("colourful", sample.prints)).result()
    assert capfd.readouterr() == ("", "red \\u001b[31m \\u202e\n" * 2)


def echo(value: int) -> Job:
    return Job("echo", sample.echo, (value,))


def run(
    jobs: Iterable[tuple[Any, Any]],
    stop: Callable[[], bool] = lambda: False,
    progress: Callable[[int, int, str], None] = lambda done, total, note: None,
) -> dict[Any, Any]:
    found: dict[Any, Any] = do_all(jobs, 2, stop, progress)
    return found


@pytest.mark.usefixtures("in_process")
def test_results_by_key() -> None:
    seen: list[tuple[int, int, str]] = []
    found = run([(0, echo(10)), (1, echo(20))], progress=lambda *now: seen.append(now))
    assert found == {0: 10, 1: 20}
    assert all(0 <= done < total <= 2 and note == "echo" for done, total, note in seen)


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


@deep
def test_stopped_with_what_is_done() -> None:
    done: list[int] = []
    found = run(
        [("quick", echo(1)), *((k, Job("echo", sample.endless)) for k in range(4))],
        stop=lambda: bool(done and done[-1]),
        progress=lambda count, total, note: done.append(count),
    )
    assert found == {"quick": 1}


@deep
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
