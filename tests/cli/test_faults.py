"""A fault in physim itself has an exit code of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.cli import FAULT, main
from tests.helpers import inside

listing = inside("physim.cli", "listing")


class OddError(BaseException):
    """What is no Exception, as some libraries have."""


ERRORS = [IndexError("beyond the end"), ValueError("x"), OSError("odd"), OddError("odd")]


@pytest.mark.parametrize("error", ERRORS)
def test_a_fault_in_physim(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], error: BaseException
) -> None:
    def broken(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", broken)
    assert main(["list"]) == FAULT == 70
    err = capsys.readouterr().err
    assert err.startswith("Traceback (most recent call last):\n")
    assert f"{type(error).__name__}: {error}" in err
    assert err.splitlines()[-1].startswith("physim: this is a fault in physim")


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(5)])
def test_ends_that_are_no_fault(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    def ended(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", ended)
    if isinstance(error, SystemExit):
        with pytest.raises(SystemExit):
            main(["list"])
    else:
        assert main(["list"]) == 130


@pytest.mark.parametrize("error", [MemoryError(), MemoryError("Unable to allocate 3 GiB")])
def test_no_memory_is_no_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], error: MemoryError
) -> None:
    def full(options: object) -> int:
        raise error

    monkeypatch.setattr(listing, "callback", full)
    assert main(["list"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("out of memory")
    assert str(error) in line


@pytest.mark.parametrize("gone", [True, False])
def test_a_working_folder_that_is_gone_is_no_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, gone: bool
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
