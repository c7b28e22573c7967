"""Ctrl-C, SIGTERM and kill -9 of real runs: what is there afterwards is whole."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from physim.errors import RecordError
from physim.record import Record
from physim.summary import summarise
from tests.cli.commands import LONG, frames, physim, started


@pytest.fixture
def here(tmp_path: Path) -> Path:
    (tmp_path / "long.yaml").write_text(LONG)
    return tmp_path


@pytest.fixture
def process(here: Path, request: pytest.FixtureRequest) -> Iterator[subprocess.Popen[str]]:
    """A long run under way, some seconds of it recorded; ended in any case."""
    process = started("run", "long.yaml", "-o", "out", *request.param, folder=here)
    try:
        wait_for_samples(process, here / "out/record.h5", 300)
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def wait_for_samples(process: subprocess.Popen[str], path: Path, samples: int) -> None:
    while process.poll() is None:
        try:
            with Record.load(path) as record:
                if record.samples >= samples:
                    return
        except RecordError:
            pass
        time.sleep(0.02)
    raise AssertionError(process.communicate()[1])


def check_record(path: Path) -> int:
    """An interrupted run, complete; its number of samples."""
    with Record.load(path) as record:
        assert record.ended == "interrupted"
        assert record.samples == record.steps_run + 1 >= 300
        assert record.steps.tolist() == list(range(record.samples))
        assert np.isfinite(record.pose).all()
        assert record.updates["step"].max() < record.steps_run
        assert record.updates["next_step"].max() >= record.steps_run
        assert summarise(record).ended == "interrupted"
        return record.samples


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("process", [["--no-video"]], indirect=True)
def test_an_interrupted_run_is_closed_properly(
    process: subprocess.Popen[str], here: Path, number: signal.Signals
) -> None:
    process.send_signal(number)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert err.startswith("interrupted at ")
    assert err.count("\n") == 1
    assert "interrupted after" in out
    check_record(here / "out/record.h5")
    assert {file.name for file in (here / "out").iterdir()} == {"record.h5", "summary.json"}


@pytest.mark.parametrize("process", [["--quiet"]], indirect=True)
def test_the_video_so_far_is_made(process: subprocess.Popen[str], here: Path) -> None:
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=120) == ("", "")
    assert process.returncode == 130
    check_record(here / "out/record.h5")
    assert frames(here / "out/video.mp4") > 10
    assert {f.name for f in (here / "out").iterdir()} == {"record.h5", "summary.json", "video.mp4"}


@pytest.mark.parametrize("second", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("process", [[]], indirect=True)
def test_a_second_interrupt_ends_the_video_sooner(
    process: subprocess.Popen[str], here: Path, second: signal.Signals
) -> None:
    process.send_signal(signal.SIGINT)
    assert process.stderr is not None
    for line in process.stderr:
        if line.startswith("writing the video so far"):
            break
    process.send_signal(second)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130
    short = "the video was cut short; physim video out/record.h5 --force makes it whole\n"
    assert err in ("", short)  # nothing where the video was done first
    assert out.startswith("run ")
    check_record(here / "out/record.h5")
    assert frames(here / "out/video.mp4") > 0
    assert {f.name for f in (here / "out").iterdir()} == {"record.h5", "summary.json", "video.mp4"}


@pytest.mark.parametrize("process", [[]], indirect=True)
def test_a_killed_run_can_be_summarised_and_shown(
    process: subprocess.Popen[str], here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    process.kill()
    process.communicate()
    path = here / "out/record.h5"
    with Record.load(path) as record:
        assert record.ended == "running"
        assert record.samples >= 300
        assert record.steps_run == record.samples - 1
        assert record.clearance.shape == (record.samples, 2)
        assert (record.extremes["clearance"] <= record.clearance.min(axis=0)).all()
    done = physim("summary", path, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert "not closed (killed, or still running) after" in done.out
    done = physim("video", path, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert frames(here / "out/video.mp4") > 10
    left = {file.name for file in (here / "out").iterdir()}
    assert left == {"record.h5", "video.mp4"}
