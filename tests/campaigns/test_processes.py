"""Worker processes that are killed, hang, or cannot be begun: every job ends, and others go on."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import wait
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from physim.campaigns import Processes, processes
from tests.campaigns import sample_jobs as sample
from tests.helpers import inside

Job, LostError, OverdueError = inside("physim.campaigns", "Job", "LostError", "OverdueError")
StartError = inside("physim.campaigns", "StartError")

pytestmark = pytest.mark.deep

LONGEST = 120.0
"""[s] for a job that takes none"""


def made(workers: int) -> Iterator[Processes]:
    some = Processes(workers)
    yield some
    some.shutdown(cancel_futures=True)
    assert not multiprocessing.active_children()


@pytest.fixture
def executor() -> Iterator[Processes]:
    yield from made(2)


@pytest.fixture
def one() -> Iterator[Processes]:
    yield from made(1)


def test_a_copy_that_a_job_forks_answers_for_nobody(one: Processes) -> None:
    """It answered beside the worker, and took the next jobs from its pipe: rows were lost."""
    copies = [one.begin(Job("forks", sample.forks)).result(timeout=LONGEST) for _ in range(3)]
    answers = [one.begin(Job("good", sample.echo, (k,))) for k in range(20)]
    assert [future.result(timeout=LONGEST) for future in answers] == list(range(20))
    (worker,) = one.ids
    assert worker not in copies
    for copy in copies:
        ended(copy, worker)


def ended(copy: int, worker: int) -> None:
    """Wait until a child of a worker, which never asks for it, is no more than its number."""
    until = time.monotonic() + LONGEST
    while time.monotonic() < until:
        state = Path(f"/proc/{copy}/stat").read_text().rpartition(")")[2].split()[:2]
        if state == ["Z", str(worker)]:
            return
        time.sleep(0.02)
    raise AssertionError(f"process {copy} goes on")


@pytest.mark.parametrize(
    ("work", "given", "limit", "error"),
    [
        (sample.writes_everywhere, (), None, LostError),
        (sample.leaves_a_copy, (2.0 * LONGEST, 3), None, LostError),
        (sample.leaves_a_copy, (2.0 * LONGEST, None), 1.0, OverdueError),
    ],
)
def test_a_worker_that_is_no_more_is_not_waited_for_whatever_has_its_pipes(
    one: Processes, work: Any, given: tuple[Any, ...], limit: float | None, error: type[Exception]
) -> None:
    """What it forked has its end of its pipe, which looks open for as long as that lives."""
    begun = time.monotonic()
    lost = one.begin(Job("forks", work, given, limit))
    good = one.begin(Job("good", sample.echo, (5,)))
    with pytest.raises(error):
        lost.result(timeout=LONGEST)
    assert good.result(timeout=LONGEST) == 5
    one.shutdown(cancel_futures=True)
    assert time.monotonic() - begun < 2.0 * LONGEST, "it waited for the copy"


@pytest.mark.parametrize(
    ("work", "limit", "error", "text"),
    [
        (sample.killed, None, LostError, "exit code 9"),
        (sample.killed_by_the_system, None, LostError, "SIGKILL"),
        (sample.raises_as_ctrl_c_does, None, LostError, "bad: it raised KeyboardInterrupt"),
        (sample.writes_into_pipes, None, LostError, "a worker process was killed at bad"),
        (sample.hangs, 1.0, OverdueError, "not done after 1 s"),
        (sample.hangs_in_native_code, 1.0, OverdueError, "not done after 1 s"),
    ],
)
def test_whatever_a_job_does_to_its_process_the_next_is_done(
    executor: Processes, work, limit, error, text
) -> None:
    bad = [executor.begin(Job("bad", work, (), limit)) for _ in range(2)]
    good = [executor.begin(Job("good", sample.echo, (k,), 60.0)) for k in range(3)]
    for future in bad:
        with pytest.raises(error, match=text):
            future.result(timeout=LONGEST)
    assert [future.result(timeout=LONGEST) for future in good] == [0, 1, 2]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_what_ends_a_command_does_not_end_its_workers(
    executor: Processes, number: signal.Signals, capfd: pytest.CaptureFixture[str]
) -> None:
    """A terminal sends it to all, also to those that are still importing what they need."""
    futures = [executor.begin(Job("good", sample.echo, (k,))) for k in range(2)]
    while not all(future.done() for future in futures):
        for worker in executor.ids:
            os.kill(worker, number)
        wait(futures, timeout=0.005)
    assert [future.result() for future in futures] == [0, 1]
    assert capfd.readouterr().err == ""


def test_what_the_code_of_one_leaves_behind_is_not_met_by_that_of_another(
    executor: Processes,
) -> None:
    told = []
    for name in ("", "a", "b", "", "a", "b", "c", "d", "a", ""):
        job = Job("leaves", sample.leave_behind, (name,), code=name)
        told.append((name, *executor.begin(job).result(timeout=LONGEST)))
        assert len(executor.ids) <= 5
    assert all(found in (None, name or None) for name, _, found in told)
    again = [number for name, number, _ in told if name == "a"]
    assert again[0] == again[1]  # it had waited for more of the same


def test_workers_have_the_modules_of_their_parent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever stands before them where they look: in the working folder, or another checkout."""
    for name in ("struct", "signal", "multiprocessing"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit(7)\n")
    for folder in ("away", "other"):
        (tmp_path / folder).mkdir()
    (tmp_path / "other/physim.py").write_text("raise SystemExit(7)\n")
    (tmp_path / "away/begins.py").write_text(
        "import sys\n"
        "from physim.campaigns import Processes\n"
        "if __name__ == '__main__':\n"
        f"    sys.path.insert(0, {str(tmp_path / 'other')!r})\n"
        "    before = list(sys.path)\n"
        "    made = Processes(1)\n"
        "    assert made.submit(eval, \"__import__('sys').path\").result() == before\n"
        "    assert sys.path == before\n"
        "    made.shutdown()\n"
    )
    done = subprocess.run(
        [sys.executable, str(tmp_path / "away/begins.py")], cwd=tmp_path,
        capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


UNGUARDED = {
    "submit": "print(Processes(1).submit(abs, -3).result())",
    "sweep": "sweep([spec_of(world, seed) for seed in range(2)], 'campaign', Processes(2))",
    "caught": "try:\n    sweep([spec_of(world, 1)], 'campaign', Processes(1))\n"
    "except PhysimError as error:\n    sys.exit(str(error))",
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
    assert last.endswith(processes.UNGUARDED.removeprefix("; "))
    assert err.count(processes.UNGUARDED) == 1
    assert err.count("Traceback") == (0 if how in ("caught", "command") else 1)
    assert before == [] or how not in ("caught", "command")


def test_a_worker_killed_from_outside(executor: Processes) -> None:
    future = executor.begin(Job("long", sample.endless))
    quick = executor.submit(os.getpid)
    other = quick.result()
    (victim,) = set(executor.ids) - {other}
    os.kill(victim, signal.SIGKILL)
    with pytest.raises(LostError, match="SIGKILL"):
        future.result()
    assert executor.submit(abs, -4).result() == 4


def test_jobs_end_early_when_told_to(executor: Processes) -> None:
    futures = [executor.begin(Job("long", sample.endless)) for _ in range(2)]
    executor.halt()
    assert not wait(futures, timeout=300).not_done
    assert [future.result() for future in futures] == [None, None]


def test_jobs_that_do_not_end_when_told_to_are_stopped_not_lost(
    executor: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as a controller that is slow to decide: what is lost counts as a failure."""
    monkeypatch.setattr(processes, "LAST_SECONDS", 0.5)
    executor.submit(abs, -4).result()
    futures = [
        executor.begin(Job("deaf", sample.hangs)),
        executor.begin(Job("starts", sample.hangs)),
    ]
    executor.halt()
    assert not wait(futures, timeout=LONGEST).not_done
    assert [future.result() for future in futures] == [None, None]


def test_what_cannot_be_sent_is_told(executor: Processes) -> None:
    with pytest.raises(RuntimeError, match="cannot be sent"):
        executor.begin(Job("odd", sample.echo, (lambda: 1,))).result()
    assert executor.submit(abs, -4).result() == 4


def test_what_a_job_prints_does_not_act_on_the_terminal(
    executor: Processes, capfd: pytest.CaptureFixture[str]
) -> None:
    """And stands beside what the command itself prints."""
    executor.begin(Job("colourful", sample.prints)).result()
    assert capfd.readouterr() == ("", "red \\u001b[31m \\u202e\n" * 2)
