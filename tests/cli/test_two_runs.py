"""Two runs into one folder: one record, by one of them; the other says why it wrote nothing."""

from __future__ import annotations

import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from physim.errors import RecordError
from physim.record import Record
from tests.cli.commands import LONG, SMALL, physim, started
from tests.helpers import facts, inside

remove_earlier = inside("physim.cli", "remove_earlier")


@pytest.mark.parametrize("trial", range(2))
def test_runs_that_start_at_once(tmp_path: Path, trial: int) -> None:
    (tmp_path / "long.yaml").write_text(LONG)
    arguments = ("run", "long.yaml", "--no-video", "--quiet", "-o", "out")
    both = [started(*arguments, "--seed", seed, folder=tmp_path) for seed in (1, 2)]
    try:
        while all(one.poll() is None for one in both):
            time.sleep(0.01)
        refused, *_ = (one for one in both if one.poll() is not None)
        goes_on = both[1 - both.index(refused)]
        out, err = refused.communicate()
        assert (refused.returncode, out, err.count("\n")) == (2, "", 1), err
        assert re.search(r"out/?\b.*(record\.h5|summary\.json)", err), err
        wait_for(tmp_path / "out/record.h5", goes_on)
        goes_on.send_signal(signal.SIGINT)
        goes_on.communicate(timeout=60)
        assert goes_on.returncode == 130
    finally:
        for one in both:
            kill(one)
    with Record.load(tmp_path / "out/record.h5") as record:
        assert record.ended == "interrupted"
        assert record.seed == 1 + both.index(goes_on)
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [
        "record.h5",
        "summary.json",
    ]


def test_force_spares_a_run_that_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "long.yaml").write_text(LONG)
    (tmp_path / "small.yaml").write_text(SMALL)
    first = started("run", "long.yaml", "--no-video", "-o", "out", folder=tmp_path)
    try:
        wait_for(tmp_path / "out/record.h5", first)
        second = physim("run", tmp_path / "small.yaml", "--no-video", "--force",
                        "-o", tmp_path / "out", capture=capsys)  # fmt: skip
        assert (second.code, second.out) == (2, "")
        assert re.search(facts("summary.json: ", "another", "writing"), second.err), second.err
        first.send_signal(signal.SIGINT)
        out, _ = first.communicate(timeout=60)
    finally:
        kill(first)
    assert "record.h5" in out
    with Record.load(tmp_path / "out/record.h5") as record:
        assert record.ended == "interrupted"


def wait_for(path: Path, process: subprocess.Popen[str]) -> None:
    """Wait until a process has recorded some steps."""
    while process.poll() is None:
        try:
            with Record.load(path) as record:
                if record.samples > 100:
                    return
        except RecordError:
            pass
        time.sleep(0.02)


def kill(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        process.kill()
        process.communicate()


def test_what_another_command_removed_just_now_is_no_error(tmp_path: Path) -> None:
    mine, gone = tmp_path / "record.h5", tmp_path / "summary.json"
    mine.write_text("an earlier one")
    remove_earlier(tmp_path, [gone, mine], True, what="an earlier run")
    assert not any(tmp_path.iterdir())
