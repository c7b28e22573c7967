"""Worker processes that are killed, hang, or cannot be begun: every job ends, and others go on."""

from __future__ import annotations

import errno
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from physim.campaigns import Processes, processes, sweep
from tests.campaigns import sample_jobs as sample
from tests.helpers import inside

Job, LostError, OverdueError = inside("physim.campaigns", "Job", "LostError", "OverdueError")
StartError = inside("physim.campaigns", "StartError")

LONGEST = 120.0
"""[s] for a job that takes none"""


@pytest.fixture
def executor() -> Iterator[Processes]:
    made = Processes(2)
    yield made
    made.shutdown(cancel_futures=True)
    assert not multiprocessing.active_children()


def test_a_copy_that_a_job_forks_answers_for_nobody() -> None:
    """It answered beside the worker, and took the next jobs from its pipe: rows were lost."""
    one = Processes(1)
    try:
        copies = [one.begin(Job("forks", sample.forks)).result(timeout=LONGEST) for _ in range(3)]
        answers = [one.begin(Job("good", sample.echo, (k,))) for k in range(20)]
        assert [future.result(timeout=LONGEST) for future in answers] == list(range(20))
        (worker,) = one.ids
        assert worker not in copies
        for copy in copies:
            ended(copy, worker)
    finally:
        one.shutdown(cancel_futures=True)


def test_a_worker_whose_job_writes_into_its_pipes_is_ended() -> None:
    """It seemed to have ended, and was waited for without end, beyond every limit and signal."""
    one = Processes(1)
    try:
        lost = one.begin(Job("writes", sample.writes_everywhere, ()))
        good = one.begin(Job("good", sample.echo, (5,)))
        with pytest.raises(LostError):
            lost.result(timeout=LONGEST)
        assert good.result(timeout=LONGEST) == 5
    finally:
        one.shutdown(cancel_futures=True)


@pytest.mark.parametrize(("code", "error"), [(3, LostError), (None, OverdueError)])
def test_a_worker_that_is_no_more_is_not_waited_for_because_of_what_it_forked(
    code: int | None, error: type[Exception]
) -> None:
    """The copy has the worker's end of its pipe: it looks open for as long as that lives."""
    one, begun = Processes(1), time.monotonic()
    try:
        limit = 1.0 if code is None else None
        lost = one.begin(Job("forks", sample.leaves_a_copy, (2.0 * LONGEST, code), limit))
        good = one.begin(Job("good", sample.echo, (5,)))
        with pytest.raises(error):
            lost.result(timeout=LONGEST)
        assert good.result(timeout=LONGEST) == 5
    finally:
        one.shutdown(cancel_futures=True)
    assert time.monotonic() - begun < 2.0 * LONGEST, "it waited for the copy"


def test_a_worker_with_a_thread_left_behind_ends_when_it_is_let_go() -> None:
    one = Processes(1)
    try:
        left = [
            one.begin(Job(code, sample.leaves_a_thread, code=code)).result(timeout=LONGEST)
            for code in "abcdef"
        ]
        assert len({*left}) == 6
        until = time.monotonic() + LONGEST
        while (some := len(multiprocessing.active_children())) > 3 and time.monotonic() < until:
            time.sleep(0.05)
        assert some <= 3
    finally:
        one.shutdown(cancel_futures=True)


def ended(copy: int, worker: int) -> None:
    """Wait until a child of a worker, which never asks for it, is no more than its number."""
    until = time.monotonic() + LONGEST
    while time.monotonic() < until:
        state = Path(f"/proc/{copy}/stat").read_text().rpartition(")")[2].split()[:2]
        if state == ["Z", str(worker)]:
            return
        time.sleep(0.02)
    raise AssertionError(f"process {copy} goes on")


def test_it_is_an_executor(executor: Processes) -> None:
    assert isinstance(executor, Executor)
    assert executor.submit(divmod, 7, 2).result() == (3, 1)
    assert list(executor.map(abs, [-1, 2, -3])) == [1, 2, 3]


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


@pytest.mark.parametrize("workers", [1, 2])
def test_what_the_code_of_one_leaves_behind_is_not_met_by_that_of_another(workers: int) -> None:
    made, told = Processes(workers), []
    try:
        for name in ("", "a", "b", "", "a", "b", "c", "d", "e", "a", ""):
            job = Job("leaves", sample.leave_behind, (name,), code=name)
            told.append((name, *made.begin(job).result(timeout=LONGEST)))
            assert len(made.ids) <= 2 * workers + 1
        for name, _, found in told:
            assert found in (None, name or None)
        again = [number for name, number, _ in told if name == "a"]
        assert again[0] == again[1]  # it had waited for more of the same
    finally:
        made.shutdown(cancel_futures=True)
    assert not multiprocessing.active_children()


def test_workers_have_the_physim_of_their_parent(tmp_path: Path) -> None:
    """Whatever stands before it where they look: a file of that name, or another checkout."""
    (tmp_path / "physim.py").write_text("raise SystemExit(7)\n")
    script = (
        "import sys\n"
        "from physim.campaigns.processes import Processes\n"
        "if __name__ == '__main__':\n"
        f"    sys.path.insert(0, {str(tmp_path)!r})\n"
        "    before = list(sys.path)\n"
        "    made = Processes(1)\n"
        "    assert made.submit(eval, \"__import__('sys').path\").result() == before\n"
        "    assert sys.path == before\n"
        "    made.shutdown()\n"
    )
    away = tmp_path / "away"
    away.mkdir()
    (away / "begins.py").write_text(script)
    done = subprocess.run(
        [sys.executable, str(away / "begins.py")],
        capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


def test_no_module_of_the_working_folder_is_run_as_workers_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python itself would look there first; what its parent knows a worker finds."""
    for name in ("struct", "signal", "socket", "multiprocessing"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit(7)\n")
    monkeypatch.chdir(tmp_path)
    script = (
        "import os\n"
        "from physim.campaigns.processes import Processes\n"
        "if __name__ == '__main__':\n"
        "    made = Processes(1)\n"
        "    assert made.submit(os.getenv, 'PYTHONSAFEPATH').result() is None\n"
        "    assert os.getenv('PYTHONSAFEPATH') is None\n"
        "    made.shutdown()\n"
    )
    away = tmp_path / "away"
    away.mkdir()
    (away / "begins.py").write_text(script)
    done = subprocess.run(
        [sys.executable, str(away / "begins.py")],
        capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


UNGUARDED = {
    "submit": "print(Processes(1).submit(abs, -3).result())",
    "sweep 1": "sweep([spec_of(world, seed) for seed in range(2)], 'campaign', Processes(1))",
    "sweep 2": "sweep([spec_of(world, seed) for seed in range(2)], 'campaign', Processes(2))",
    "caught": "try:\n    sweep([spec_of(world, 1)], 'campaign', Processes(1))\n"
    "except PhysimError as error:\n    sys.exit(str(error))",
    "command": "sys.exit(main(['sweep', 'straight', '--seeds', '0:2', '--set', "
    "'time.duration=0.5', '-o', 'campaign', '--workers', '2', '--quiet']))",
    "check": "sys.exit(main(['validate', '--seeds', '0:2', 'ten_robots', '--quiet']))",
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
    assert err.count("Traceback") == (0 if how in ("caught", "command", "check") else 1)
    assert before == [] or how not in ("caught", "command")


def test_a_program_that_is_no_file_is_told_so(tmp_path: Path) -> None:
    """Its guard is there; what workers miss is a file to import."""
    sweeps = UNGUARDED["sweep 1"]
    done = subprocess.run(
        [sys.executable, "-"], input=f"{HEAD}if __name__ == '__main__':\n    {sweeps}\n",
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip
    last = done.stderr.splitlines()[-1]
    assert done.returncode != 0
    assert last.endswith("and <stdin> is no file: save the program as one and run that")
    assert "__name__" not in last


def test_a_process_of_another_that_imports_is_told(
    executor: Processes, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """multiprocessing marks it so, whoever began it; it is not ours to end."""
    this = multiprocessing.current_process()
    monkeypatch.setattr(this, "_inheriting", True, raising=False)
    with pytest.raises(StartError, match="__main__"):
        sweep([], tmp_path / "campaign", ThreadPoolExecutor(1))
    assert not (tmp_path / "campaign").exists()
    with pytest.raises(StartError, match="__main__"):
        executor.submit(abs, -3)


def test_a_program_that_does_not_shut_it_down_ends(tmp_path: Path) -> None:
    """Its workers hear no TERM, by which multiprocessing ends what is left."""
    (tmp_path / "begins.py").write_text(
        "from physim.campaigns.processes import Processes\n"
        "if __name__ == '__main__':\n"
        "    print(Processes(1).submit(abs, -3).result())\n"
    )
    done = subprocess.run(
        [sys.executable, str(tmp_path / "begins.py")],
        capture_output=True, text=True, check=False, timeout=LONGEST,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "3\n", "")


def test_a_worker_may_have_workers(executor: Processes) -> None:
    """It has imported the program by then."""
    assert executor.submit(sample.has_workers).result(timeout=LONGEST) == 3


@pytest.mark.parametrize("most", [0, 1])
def test_no_more_processes_than_the_system_allows(
    executor: Processes, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    begun, real = [], processes._Worker.begun

    def limited(context, halt):
        if len(begun) == most:
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))
        begun.append(1)
        return real(context, halt)

    monkeypatch.setattr(processes._Worker, "begun", limited)
    futures = [executor.begin(Job("good", sample.echo, (k,))) for k in range(3)]
    if most:
        assert [future.result(timeout=LONGEST) for future in futures] == [0, 1, 2]
        return
    for future in futures:
        with pytest.raises(StartError, match=os.strerror(errno.EMFILE)):
            future.result(timeout=5.0)


def test_the_limit_counts_from_when_a_process_is_ready(executor: Processes) -> None:
    job = Job("slow to begin", sample.echo, (5,), 1.0, sample.takes_two_seconds)
    assert executor.begin(job).result() == 5


def test_a_worker_killed_from_outside(executor: Processes) -> None:
    future = executor.begin(Job("long", sample.endless))
    quick = executor.submit(os.getpid)
    other = quick.result()
    (victim,) = set(executor.ids) - {other}
    os.kill(victim, signal.SIGKILL)
    with pytest.raises(LostError, match="SIGKILL"):
        future.result()
    assert executor.submit(abs, -4).result() == 4


def test_a_worker_that_does_not_end_in_time_is_gone_after_the_shutdown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It was killed and not waited for: on a busy machine it was still there."""
    monkeypatch.setattr(processes, "LAST_SECONDS", 0.0)
    made = Processes(2)
    for future in [made.submit(time.sleep, 0.05) for _ in range(4)]:
        future.result()
    made.shutdown()
    assert not multiprocessing.active_children()


def test_workers_killed_while_they_had_nothing_to_do(executor: Processes) -> None:
    for _ in range(3):
        assert executor.submit(abs, -4).result() == 4
        for one in multiprocessing.active_children():
            one.kill()
            one.join()


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


@pytest.mark.parametrize("workers", [0, -1, None, "2", 1.5, True])
def test_no_processes_would_wait_for_ever(workers: Any) -> None:
    with pytest.raises(ValueError, match="workers ="):
        Processes(workers)
