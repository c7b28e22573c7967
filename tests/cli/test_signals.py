"""How a command ends: by which signals, by a fault of physim itself, without memory or folder."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.cli import FAULT, Break, breaks, main
from tests.helpers import inside

interrupts, listing = inside("physim.cli", "interrupts", "listing")

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def stop_at_once(monkeypatch, number: int) -> None:
    """Put in the place of every command one that is hit by a signal while it works."""

    def work(arguments: object) -> int:
        os.kill(os.getpid(), number)
        time.sleep(0.2)
        return 0

    monkeypatch.setattr("physim.cli.parser.run_command", work)


@pytest.fixture
def handlers() -> Iterator[None]:
    """Put back what the test changes, and let no signal end the tests themselves."""
    before = {number: signal.signal(number, lambda *_: None) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_a_command_with_130_and_one_line(
    number: int,
    handlers: None,
    monkeypatch,
    capsys,
) -> None:
    stop_at_once(monkeypatch, number)
    before = [signal.getsignal(one) for one in SIGNALS]
    assert main(["list"]) == 130
    assert capsys.readouterr() == ("", "interrupted\n")
    assert [signal.getsignal(one) for one in SIGNALS] == before


def test_a_command_started_by_nohup_goes_on(handlers: None, monkeypatch) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    stop_at_once(monkeypatch, signal.SIGHUP)
    assert main(["list"]) == 0


def hit(number: int) -> None:
    os.kill(os.getpid(), number)
    time.sleep(1.0)


def test_what_does_not_hear_the_first_is_broken_off_by_the_second(
    handlers: None, monkeypatch
) -> None:
    monkeypatch.setattr("physim.cli.progress.PATIENCE", 0.0)
    with interrupts() as interrupt:
        try:
            for _ in range(3):
                os.kill(os.getpid(), signal.SIGINT)
                assert interrupt()  # it is heard
        except KeyboardInterrupt:  # which would end the tests
            pytest.fail("who asks was broken off")
        os.kill(os.getpid(), signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            hit(signal.SIGTERM)
    assert interrupt.count == 4


def test_what_nobody_hears_is_told_and_broken_off(handlers: None, monkeypatch, capsys) -> None:
    """A queue sends SIGTERM once, and then kills: what was simulated would be lost."""
    monkeypatch.setattr("physim.cli.progress.PATIENCE", 0.0)
    monkeypatch.setattr("physim.cli.progress.TOLD_AFTER", 0.05)
    monkeypatch.setattr("physim.cli.progress.ENDED_AFTER", 0.2)
    with interrupts(), pytest.raises(KeyboardInterrupt):
        hit(signal.SIGTERM)
    assert "SIGTERM: not heard" in capsys.readouterr().err


def test_ctrl_c_that_nobody_hears_is_told_and_waits_for_another(
    handlers: None, monkeypatch, capsys
) -> None:
    monkeypatch.setattr("physim.cli.progress.TOLD_AFTER", 0.05)
    monkeypatch.setattr("physim.cli.progress.ENDED_AFTER", 0.1)
    with interrupts() as interrupt:
        hit(signal.SIGINT)
        assert "Ctrl-C: not heard" in capsys.readouterr().err
        assert interrupt()
    assert interrupt.count == 1


def test_nothing_is_told_of_what_was_heard(handlers: None, monkeypatch, capsys) -> None:
    monkeypatch.setattr("physim.cli.progress.TOLD_AFTER", 0.3)
    monkeypatch.setattr("physim.cli.progress.ENDED_AFTER", 0.4)
    for number in (signal.SIGINT, signal.SIGTERM):
        with interrupts() as interrupt:
            os.kill(os.getpid(), number)
            assert interrupt()
            time.sleep(0.6)
            assert interrupt.count == 1
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("left", [False, True])
def test_a_thread_left_behind_does_not_outlive_a_signal(handlers: None, left: bool) -> None:
    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    if left:
        thread.start()
    with breaks(last=True):
        pass
    stop.set()
    after = signal.SIG_DFL if left else signal.SIG_IGN
    assert {signal.getsignal(one) for one in SIGNALS} == {after}


def test_a_command_that_is_ending_is_not_broken_off_again() -> None:
    found = Break(alone=False)
    with pytest.raises(KeyboardInterrupt):
        found(signal.SIGINT, None)
    found.ignore()
    try:
        found(signal.SIGINT, None)
    except KeyboardInterrupt:  # which would end the tests
        pytest.fail("it was broken off again")
    assert found.came


class OddError(BaseException):
    """What is no Exception, as some libraries have."""


ERRORS = [IndexError("beyond the end"), ValueError("x"), OSError("odd"), OddError("odd")]


@pytest.mark.parametrize("error", ERRORS)
def test_a_fault_in_physim(monkeypatch, capsys, error: BaseException) -> None:
    def broken(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", broken)
    assert main(["list"]) == FAULT == 70
    err = capsys.readouterr().err
    assert err.startswith("Traceback (most recent call last):\n")
    assert f"{type(error).__name__}: {error}" in err
    assert err.splitlines()[-1].startswith("physim: this is a fault in physim")


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(5)])
def test_ends_that_are_no_fault(monkeypatch, error: BaseException) -> None:
    def ended(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", ended)
    if isinstance(error, SystemExit):
        with pytest.raises(SystemExit):
            main(["list"])
    else:
        assert main(["list"]) == 130


@pytest.mark.parametrize("error", [MemoryError(), MemoryError("Unable to allocate 3 GiB")])
def test_no_memory_is_no_fault(monkeypatch, capsys, error: MemoryError) -> None:
    def full(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", full)
    assert main(["list"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("out of memory")
    assert str(error) in line


@pytest.mark.parametrize("gone", [True, False])
def test_a_working_folder_that_is_gone_is_no_fault(
    monkeypatch, capsys, tmp_path: Path, gone: bool
) -> None:
    """A file that is missing otherwise, and of which nobody has thought, still is one."""

    def missing(options: object) -> int:
        raise FileNotFoundError(2, "No such file or directory")

    folder = tmp_path / "folder"
    folder.mkdir()
    monkeypatch.chdir(folder)
    if gone:
        folder.rmdir()
    monkeypatch.setattr(listing, "callback", missing)
    assert main(["list"]) == (2 if gone else 70)
    told = capsys.readouterr().err
    assert ("gone" in told) == gone
    assert ("Traceback" in told) != gone
