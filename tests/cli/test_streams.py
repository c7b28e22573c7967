"""Standard output that takes nothing more: full, closed, or read by nobody."""

from __future__ import annotations

import errno
import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from physim.cli import FAULT, INTERRUPTED, main
from tests.cli.commands import command, environment, shell
from tests.helpers import check_error
from tests.helpers.records import make_record

FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.parametrize("arguments", [["list"], ["--help"], ["schema"], ["summary", "record.h5"]])
def test_a_full_output_is_told_in_one_line(arguments: list[str], tmp_path: Path) -> None:
    make_record(tmp_path / "record.h5", seconds=1.0).close()
    with FULL.open("w") as full:
        done = subprocess.run(
            command(arguments), cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True,
            env=environment(), timeout=60,
        )  # fmt: skip
    assert done.returncode == 2
    check_error(done.stderr, "standard output:", "No space left on device")


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
def test_a_full_error_output_leaves_the_exit_code(tmp_path: Path) -> None:
    with FULL.open("w") as full:
        done = subprocess.run(
            command(["summary", "none.h5"]), cwd=tmp_path, stdout=subprocess.PIPE, stderr=full,
            env=environment(), timeout=60,
        )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, b"")


class Full(io.StringIO):
    """A file on a disk without room."""

    def write(self, text: str) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_no_room_in_the_middle_of_a_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdout", Full())
    assert main(["list"]) == 2
    check_error(capsys.readouterr().err, "standard output:", "No space left on device")


def test_a_closed_output_is_no_fault(tmp_path: Path) -> None:
    words = " ".join(command(["list"]))
    done = subprocess.run(
        ["sh", "-c", f"{words} >&-"], cwd=tmp_path, capture_output=True, text=True,
        env=environment(), timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("arguments", [["schema"], ["summary", "record.h5"]])
def test_a_reader_that_goes_after_the_first_line_is_no_fault(
    arguments: list[str], tmp_path: Path
) -> None:
    make_record(tmp_path / "record.h5", seconds=1.0).close()
    words = " ".join(command(arguments))
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {words} | head -1 >first"], cwd=tmp_path,
        capture_output=True, text=True, env=environment(), timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "first").read_text().count("\n") == 1


def test_errors_begin_with_their_place(tmp_path: Path) -> None:
    """Not with the name of the program, wherever they arise."""
    (tmp_path / "w.yaml").write_text("name: 1\n")
    (tmp_path / "file").write_text("")
    for arguments, begin in (
        (["run", "w.yaml"], "w.yaml:1:"),
        (["run", "none.yaml"], "none.yaml: "),
        (["summary", "none.h5"], "none.h5: "),
        (["run", "straight", "-o", "file"], "file: "),
        (["run", "straight", "--set", "time.stp=1"], "--set time.stp: "),
        (["run", "straight", "--seed", "x"], "--seed x: "),
        (["reproduce", "--study", "x"], '--study "x": '),
    ):
        done = shell(*arguments, folder=tmp_path)
        assert done.code == 2
        assert all(line.startswith(begin) for line in done.err.splitlines()), done.err


def breaks_a_pipe(interrupted: bool) -> Callable[[object], int]:
    """A command whose worker's pipe breaks, of itself or because a signal broke off the writing."""

    def command(_: object) -> int:
        try:
            if interrupted:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(5.0)
        except KeyboardInterrupt:
            raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE)) from None
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))

    return command


@pytest.mark.parametrize(("interrupted", "code"), [(True, INTERRUPTED), (False, FAULT)])
def test_a_broken_pipe_to_a_worker_is_not_taken_for_an_output_that_nobody_reads(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    interrupted: bool,
    code: int,
) -> None:
    monkeypatch.setattr("physim.cli.parser.run_command", breaks_a_pipe(interrupted))
    assert main(["list"]) == code
    told = capsys.readouterr().err
    assert (told == "interrupted\n") == interrupted
    assert ("Broken pipe" in told) != interrupted
