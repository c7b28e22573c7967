"""How a command ends: by which signals, by a fault of physim itself, without memory or folder."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.cli import FAULT, main
from physim.terminal import interrupts

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def put_in_place(monkeypatch: pytest.MonkeyPatch, *numbers: int, error: object = None) -> None:
    """Put in the place of every command one that signals hit while it works, or an error ends."""

    def work(arguments: object) -> int:
        for number in numbers:
            os.kill(os.getpid(), number)
        if isinstance(error, BaseException):
            raise error
        time.sleep(0.2)
        return 0

    monkeypatch.setattr("physim.cli.commands.run_command", work)


@pytest.fixture
def handlers() -> Iterator[None]:
    """Put back what the test changes, and let no signal end the tests themselves."""
    before = {number: signal.signal(number, lambda *_: None) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_a_command_with_130_and_one_line(
    number: int, handlers: None, monkeypatch, capsys
) -> None:
    put_in_place(monkeypatch, number)
    before = [signal.getsignal(one) for one in SIGNALS]
    assert main(["list"]) == 130
    assert capsys.readouterr() == ("", "interrupted\n")
    assert [signal.getsignal(one) for one in SIGNALS] == before


def test_a_command_started_by_nohup_goes_on(handlers: None, monkeypatch) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    put_in_place(monkeypatch, signal.SIGHUP)
    assert main(["list"]) == 0


def hit(number: int) -> None:
    os.kill(os.getpid(), number)
    time.sleep(1.0)


def test_what_does_not_hear_the_first_is_broken_off_by_the_second(
    handlers: None, monkeypatch
) -> None:
    monkeypatch.setattr("physim.terminal.PATIENCE", 0.0)
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
    assert interrupt.count == 5


class OddError(BaseException):
    """What is no Exception, as some libraries have."""


ENDS = [
    (IndexError("beyond the end"), FAULT, "this is a fault in physim"),
    (OSError("odd"), FAULT, "this is a fault in physim"),
    (OddError("odd"), FAULT, "this is a fault in physim"),
    (FileNotFoundError(2, "No such file or directory"), FAULT, "this is a fault in physim"),
    (KeyboardInterrupt(), 130, "interrupted"),
    (MemoryError("Unable to allocate 3 GiB"), 2, "out of memory (Unable to allocate 3 GiB)"),
]


@pytest.mark.parametrize(("error", "code", "said"), ENDS, ids=repr)
def test_how_an_error_that_nobody_caught_ends(
    error: BaseException, code: int, said: str, monkeypatch, capsys
) -> None:
    put_in_place(monkeypatch, error=error)
    assert main(["list"]) == code
    told = capsys.readouterr().err
    assert said in told.splitlines()[-1]
    assert (code == FAULT) == told.startswith("Traceback") == (str(error) in told and code == FAULT)


def test_an_end_that_somebody_asked_for_stays_what_it_is(monkeypatch) -> None:
    put_in_place(monkeypatch, error=SystemExit(5))
    with pytest.raises(SystemExit):
        main(["list"])


def test_a_working_folder_that_is_gone_is_no_fault(monkeypatch, capsys, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path / "folder")
    (tmp_path / "folder").rmdir()
    assert main(["list"]) == 2
    assert "gone" in capsys.readouterr().err
