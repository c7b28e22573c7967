"""Standard output: full, closed, read by nobody, of few characters; JSON stands alone there."""

from __future__ import annotations

import errno
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from physim.cli import FAULT, main
from physim.terminal import INTERRUPTED
from tests.cli.commands import command, environment, physim, shell
from tests.helpers import check_error
from tests.helpers.records import make_record

FULL = Path("/dev/full")


def in_shell(script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A line of a shell in which ``physim`` is the command."""
    whole = f'set -o pipefail; physim() {{ "{sys.executable}" -m physim "$@"; }}\n{script}'
    return subprocess.run(
        ["bash", "-c", whole], cwd=folder, capture_output=True, text=True, env=environment(),
        timeout=120,
    )  # fmt: skip


def test_as_a_user_sees_it(here: Path) -> None:
    """The exit code of ``python -m physim``; help comes without loading the engine."""
    (here / "w.yaml").write_text("name: 1\n")
    done = shell("run", "w.yaml", folder=here)
    assert (done.code, done.out) == (2, "")
    assert all(line.startswith("w.yaml:1:") for line in done.err.splitlines())
    loaded = shell("run", "--help", folder=here, PYTHONPROFILEIMPORTTIME="1")
    assert loaded.code == 0
    assert loaded.out.startswith("Usage: physim")
    assert " cyclopts\n" in loaded.err
    for heavy in (
        "numpy",
        "physim._kernels",
        "pymunk",
        "h5py",
        "pydantic",
        "matplotlib",
        "shapely",
    ):
        assert f" {heavy}\n" not in loaded.err


@pytest.mark.parametrize(
    ("script", "code"),
    [
        ("physim list >&-", 0),
        ("physim schema | head -1 >first", 0),
        ("physim --version | true", 0),
        pytest.param("physim summary record.h5 | head -1 >first", 0, marks=pytest.mark.deep),
        pytest.param("physim check straight 2>&- >told", 0, marks=pytest.mark.deep),
        pytest.param("physim summary none.h5 2>&-", 2, marks=pytest.mark.deep),
        pytest.param("physim check bad.yaml >&-", 2, marks=pytest.mark.deep),
        pytest.param("physim check bad.yaml <&- >&- 2>&-", 2, marks=pytest.mark.deep),
    ],
)
def test_an_output_that_is_closed_or_left_is_no_fault(script: str, code: int, here: Path) -> None:
    (here / "bad.yaml").write_text("name: 1\n")
    make_record(here / "record.h5", seconds=1.0).close()
    done = in_shell(script, here)
    assert (done.returncode, done.stdout) == (code, "")
    assert "Traceback" not in done.stderr
    assert code or done.stderr == ""
    assert not (here / "first").exists() or (here / "first").read_text().count("\n") == 1


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.deep
@pytest.mark.parametrize("arguments", [["list"], ["--help"], ["schema"], ["summary", "record.h5"]])
def test_a_full_output_is_told_in_one_line(arguments: list[str], here: Path) -> None:
    make_record(here / "record.h5", seconds=1.0).close()
    with FULL.open("w") as full:
        done = subprocess.run(
            command(arguments), stdout=full, stderr=subprocess.PIPE, text=True, env=environment()
        )
        assert done.returncode == 2
        check_error(done.stderr, "standard output:", "No space left on device")
        done = subprocess.run(command(["summary", "none"]), stderr=full, env=environment())
        assert done.returncode == 2


@pytest.mark.deep
@pytest.mark.parametrize("name", ["a.mp4", "a.gif", "a.png --at 1"])
def test_a_film_that_finds_no_room_is_told_and_leaves_nothing(name: str, here: Path) -> None:
    make_record(here / "record.h5", seconds=2.0).close()
    done = in_shell(f"ulimit -f 8; physim video record.h5 --width 640 -o {name}", here)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert name.partition(" ")[0] in done.stderr
    assert sorted(one.name for one in here.iterdir()) == ["record.h5", "small.yaml"]


class Full(io.StringIO):
    """A file on a disk without room."""

    def write(self, text: str) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_no_room_in_the_middle_of_a_command(monkeypatch, capsys) -> None:
    monkeypatch.setattr(sys, "stdout", Full())
    assert main(["list"]) == 2
    check_error(capsys.readouterr().err, "standard output:", "No space left on device")


def test_a_reader_that_has_gone_is_no_fault(monkeypatch, capsys) -> None:
    read, write = os.pipe()
    os.close(read)
    with open(write, "w") as gone:
        monkeypatch.setattr(sys, "stdout", gone)
        assert main(["list"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252"])
def test_a_name_that_the_output_has_no_letters_for(encoding: str, here: Path, monkeypatch) -> None:
    make_record(here / "record.h5", seconds=1.0, name="robot 🤖").close()
    for option in ((), ("--json",)):
        out = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
        monkeypatch.setattr(sys, "stdout", out)
        assert main(["summary", "record.h5", *option]) == 0
        out.flush()
        told = out.buffer.getvalue().decode(encoding)  # type: ignore[attr-defined]
    assert json.loads(told)["name"] == "robot 🤖"


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
    monkeypatch, capsys, interrupted: bool, code: int
) -> None:
    monkeypatch.setattr("physim.cli.commands.run_command", breaks_a_pipe(interrupted))
    assert main(["list"]) == code
    told = capsys.readouterr().err
    assert (told == "interrupted\n") == interrupted
    assert ("Broken pipe" in told) != interrupted


CHATTY = """\
from physim import Decision

print("imported")

class Chatty:
    def __init__(self):
        print("made")

    def decide(self, observation, memory):
        print("at", observation.station)
        return Decision(0.2, 0.0, 0.1)
"""
SHORT = ("--controller", "chatty:Chatty", "--set", "time.duration=0.2")
SEEDS = (*SHORT, "--seeds", "1:3", "--workers", "1")


@pytest.mark.parametrize(
    "arguments",
    [
        ("check-controller", "chatty:Chatty", "--world", "small.yaml", "--seconds", "0.1",
         "--json"),
        ("validate", "small.yaml", *SHORT, "--json", "-"),
        ("check", "small.yaml", *SHORT, "--json"),
        pytest.param(
            ("sweep", "small.yaml", *SEEDS, "-o", "out", "--json"), marks=pytest.mark.deep
        ),
    ],
    ids=lambda words: words[0],
)  # fmt: skip
def test_json_stands_alone_whatever_a_controller_prints(
    arguments: tuple[str, ...], here: Path, monkeypatch, capfd
) -> None:
    (here / "chatty.py").write_text(CHATTY)
    monkeypatch.delitem(sys.modules, "chatty", raising=False)
    done = physim(*arguments, capture=capfd)
    assert done.code in (0, 1), done
    assert json.loads(done.out)
    assert "at " in done.err
