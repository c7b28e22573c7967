"""A controller broken in every way ends in one line, and never holds the command for good."""

from __future__ import annotations

import signal
import subprocess
import time

from tests.edges.shell import HANGUP, INTERRUPT, TERMINATE, Shell

NUMBER = "evil"
OWN = """\
import threading
import time

from physim import Decision

STILL = Decision(v=0.0, omega=0.0, hold=0.1)


class OddError(BaseException):
    pass


class Lies:
    def __float__(self):
        raise OddError("lies")

    def __index__(self):
        raise OddError("lies")


class Exits:
    def __iter__(self):
        raise GeneratorExit


def endless():
    while True:
        yield 0


def answers(answer):
    def decide(self, observation, memory):
        return answer()

    return type("Own", (), {"decide": decide})


def raises(error):
    def decide(self, observation, memory):
        raise error

    return type("Own", (), {"decide": decide})


Odd = raises(OddError("odd"))
Exit = raises(GeneratorExit())
Group = raises(BaseExceptionGroup("some", [OddError("odd")]))
Number = answers(lambda: Decision(v=Lies(), omega=0.0, hold=0.1))
Index = answers(lambda: Decision(v=0.0, omega=0.0, hold=0.1, considered=[Lies()]))
Iterator = answers(lambda: Decision(v=0.0, omega=0.0, hold=0.1, considered=Exits()))
Endless = answers(lambda: Decision(v=0.0, omega=0.0, hold=0.1, considered=endless()))


class Made:
    def __init__(self):
        raise OddError("odd")

    def decide(self, observation, memory):
        return STILL


class Batch:
    def decide(self, observation, memory):
        return STILL

    def batch(self, scene):
        raise ValueError("odd")


class Rows(Batch):
    def batch(self, scene):
        return self

    def memory(self):
        return {}

    def decide_due(self, sensed, due, memory):
        return 5


class Loop:
    def decide(self, observation, memory):
        if observation.time > 0.5:
            open("stuck", "w").close()
            while True:
                pass
        return STILL


class Thread:
    def decide(self, observation, memory):
        if observation.time == 0.0:
            threading.Thread(target=time.sleep, args=(1000,)).start()
        return STILL
"""
FAILING = (
    "Odd", "Exit", "Group", "Number", "Index", "Iterator", "Endless", "Made", "Batch", "Rows",
)  # fmt: skip
GIVEN = ("--set", "time.duration=1.0", "--no-video", "--force", "--quiet", "-o", "out")


def try_its_errors_are_one_line(shell: Shell) -> None:
    shell.write("own.py", OWN)
    for name in FAILING:
        done = shell.physim("run", "straight", *GIVEN, "--controller", f"own:{name}")
        done.refused("own.py:")


def try_they_are_findings_and_rows(shell: Shell) -> None:
    shell.write("own.py", OWN)
    chosen = ",".join(f"own:{name}" for name in ("Odd", "Group", "Index", "Made"))
    given = ("straight", "--set", "time.duration=1.0", "--controller", chosen, "-o", "many")
    done = shell.physim("sweep", *given, "--seeds", "0:1")
    assert "Traceback" not in done.err, done.err
    assert done.out.count("1 failed (1 error)") == 4, done.out
    for name in ("Odd", "Index", "Endless"):
        done = shell.physim("check-controller", f"own:{name}", "--world", "straight")
        assert (done.code, done.err) == (1, ""), done.err
        assert "own.py:" in done.out, done.out


def try_one_that_never_returns_is_broken_off(shell: Shell) -> None:
    shell.write("own.py", OWN)
    for number in (INTERRUPT, TERMINATE, HANGUP):
        process = shell.start("run", "straight", *GIVEN, "--controller", "own:Loop")
        stuck = shell.folder / "stuck"
        _wait(process, stuck.exists)
        process.send_signal(number)
        time.sleep(1.5)
        assert process.poll() is None, "the first waits for the end of the step"
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
        assert (process.returncode, err) == (130, b"interrupted\n")
        done = shell.physim("summary", "out/record.h5")
        assert done.code == 0, done.err
        stuck.unlink()


def try_a_thread_left_behind_does_not_outlive_a_signal(shell: Shell) -> None:
    shell.write("own.py", OWN)
    process = shell.start("run", "straight", *GIVEN, "--controller", "own:Thread")
    _wait(process, (shell.folder / "out/summary.json").exists)
    time.sleep(2.0)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == -signal.SIGTERM


def _wait(process: subprocess.Popen[bytes], there: object) -> None:
    assert callable(there)
    while not there():
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
