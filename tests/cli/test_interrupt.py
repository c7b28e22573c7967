"""Ctrl-C, SIGTERM and kill -9 of real runs: what is there afterwards is whole."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim.analysis.crashtest import CrashReport, crash_test
from physim.analysis.summary import summarise
from physim.drawing.video import render
from physim.errors import RecordError
from physim.record import Record
from physim.simulation.engine import Physics
from tests.cli.commands import LONG, SMALL, frames, physim, started, tree
from tests.helpers import facts
from tests.helpers.records import make_record


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
    *size, last = err.splitlines()
    assert last.startswith("interrupted at ")
    assert len(size) <= 1  # how large the run is
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
    assert out.startswith("run ")
    check_record(here / "out/record.h5")
    film = {f.name for f in (here / "out").iterdir()} - {"record.h5", "summary.json"}
    if film == {"video.mp4"}:  # the video was done first
        assert err == ""
    else:
        assert film == {"video.cut_short.mp4"}
        assert re.search(facts("video.cut_short.mp4", "physim video out/record.h5"), err), err
        assert err.count("\n") == 1
    assert frames(here / "out" / film.pop()) > 0


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
    assert re.search(facts("not closed", "killed"), done.out)
    done = physim("video", path, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert frames(here / "out/video.mp4") > 10
    left = {file.name: file.stat().st_size for file in (here / "out").iterdir()}
    locks = {".record.h5.lock", ".summary.json.lock"}
    assert left.keys() == {"record.h5", "video.mp4", *locks}
    assert not any(left[name] for name in locks)


def interrupting(calls: int) -> Callable[..., None]:
    """What sends Ctrl-C to this process when it is called so many times."""
    left = [calls]

    def called(*_: object) -> None:
        left[0] -= 1
        if left[0] == 0:
            os.kill(os.getpid(), signal.SIGINT)

    return called


def test_an_interrupted_crash_test_tells_how_far_it_came(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    crash_test(11)
    press = interrupting(1)

    def pressed(cases: int, seed: int, **more: Any) -> CrashReport:
        told = more.pop("progress")
        return crash_test(cases, seed, **more, progress=lambda done: (told(done), press())[0])

    monkeypatch.chdir(here)
    monkeypatch.setattr("physim.analysis.crashtest.crash_test", pressed)
    done = physim("crashtest", "--cases", 5000, "--json", "found.json", capture=capsys)
    assert done.code == 130
    found = json.loads((here / "found.json").read_text())
    cases = found["cases"]
    assert 0 < cases < 5000
    assert (found["interrupted"], found["cases_asked"]) == (True, 5000)
    assert re.search(facts("interrupted", f"{cases:,} of 5,000 cases"), done.err), done.err
    assert done.err.count("\n") == 1
    verdict = facts(
        "agree", f"0 of {cases} cases", "seed 0", "unexplained", "interrupted", f"{5000 - cases:,}"
    )
    assert re.search(verdict, done.out.splitlines()[-1]), done.out
    whole = json.loads(crash_test(60).to_json())
    assert (whole["interrupted"], whole["cases_asked"], whole["cases"]) == (False, 60, 60)


def test_a_film_that_is_cut_short_has_a_name_that_says_so(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make_record(here / "record.h5", seconds=2.0).close()
    press = interrupting(3)

    def pressed(*arguments: Any, **more: Any) -> int:
        told = more.pop("progress")
        return render(*arguments, **more, progress=lambda done, of: (told(done, of), press())[0])

    monkeypatch.setattr("physim.drawing.video.render", pressed)
    (here / "video.mp4").write_text("the whole film")
    done = physim("video", here / "record.h5", "--force", capture=capsys)
    short = here / "video.cut_short.mp4"
    assert (done.code, done.out, done.err.count("\n")) == (130, "", 1)
    assert re.search(facts("interrupted", str(short)), done.err), done.err
    assert frames(short) == 3
    assert (here / "video.mp4").read_text() == "the whole film"
    assert not list(here.glob(".*"))
    short.unlink()
    short.symlink_to(here / "record.h5")
    refused = physim("video", here / "record.h5", "--force", capture=capsys)
    assert (refused.code, refused.out) == (2, "")
    assert re.search(facts("video.cut_short.mp4:", "a link"), refused.err), refused.err


def press_ctrl_c(process: subprocess.Popen[str], ready: Callable[[], bool]) -> tuple[str, str]:
    """Send SIGINT as soon as ``ready``; returns what the process told."""
    try:
        while process.poll() is None and not ready():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        return process.communicate(timeout=60)
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()


def test_ctrl_c_during_a_video(here: Path) -> None:
    make_record(here / "record.h5", seconds=60.0).close()
    process = started("video", "record.h5", folder=here)
    out, err = press_ctrl_c(process, lambda: any(here.glob(".*.part")))
    assert process.returncode == 130
    assert (out, err.count("\n")) == ("", 1)
    assert re.search(facts("interrupted", "video.cut_short.mp4"), err), err
    assert frames(here / "video.cut_short.mp4") > 0
    assert not (here / "video.mp4").exists()
    assert not list(here.glob(".*"))


def test_ctrl_c_during_plots(here: Path) -> None:
    make_record(here / "record.h5", seconds=2.0).close()
    process = started("plot", "record.h5", "-o", "out", folder=here)
    out, err = press_ctrl_c(process, lambda: any(here.glob("out/*.png")))
    made = len(list(here.glob("out/*.png")))
    assert (process.returncode, err.count("\n")) == (130, 1)
    assert re.search(facts("interrupted", f"{made} of 9 pictures"), err), err
    assert out.count("\n") == made < 9
    assert not list(here.glob("out/.*"))


def test_ctrl_c_during_a_validation(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where it arrives in a callback of the engine, which would swallow it."""
    press, step = interrupting(10), Physics.step

    def pressed(self: Physics, command: Any) -> None:
        with suppress(KeyboardInterrupt):
            press()
        step(self, command)

    monkeypatch.chdir(here)
    (here / "small.yaml").write_text(SMALL)
    monkeypatch.setattr(Physics, "step", pressed)
    assert physim("validate", "small.yaml", capture=capsys) == (130, "", "interrupted\n")


def test_ctrl_c_ends_a_check_that_watches(here: Path) -> None:
    process = started("check", "long.yaml", "--watch", folder=here)
    assert process.stdout is not None
    assert process.stdout.readline().startswith("-- ")
    _, err = press_ctrl_c(process, lambda: True)
    assert (process.returncode, err) == (130, "interrupted\n")


@pytest.mark.parametrize(
    ("arguments", "at"),
    [
        (("preview", "small.yaml"), "physim.world.layout.layout.lay_out"),
        (("import", "track.csv", "-o", "w.yaml"), "physim.authoring.importing.import_world"),
        (("check", "small.yaml"), "physim.world.checks.check_world"),
        (("new", "a"), "physim.cli.new.write_text"),
        (("summary", "record.h5"), "physim.analysis.summary.summarise"),
        (
            ("validate", "record.h5", "--json", "a.json", "--quiet"),
            "physim.analysis.validation.validate",
        ),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_ctrl_c_anywhere_else_is_one_line_and_leaves_nothing(
    arguments: tuple[str, ...],
    at: str,
    here: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(here)
    (here / "small.yaml").write_text(SMALL)
    make_record(here / "record.h5", seconds=1.0).close()
    before = tree(here)

    def pressed(*_: object, **__: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(10.0)

    monkeypatch.setattr(at, pressed)
    assert physim(*arguments, capture=capsys) == (130, "", "interrupted\n")
    assert tree(here) == before


LOGGER = """
import threading, time
import physim

class Logger:
    def __init__(self):
        threading.Thread(target=self.work).start()

    def work(self):
        while True:
            time.sleep(1.0)

    def decide(self, seen, memory):
        time.sleep(0.01)
        return physim.Decision(v=0.5, omega=0.0, hold=0.01)
"""


def test_one_signal_ends_a_run_whose_controller_left_a_thread(tmp_path: Path) -> None:
    (tmp_path / "logging_one.py").write_text(LOGGER)
    run = started(
        "run", "three_robots", "--controller", "logging_one:Logger", "-o", "out", "--no-video",
        folder=tmp_path,
    )  # fmt: skip
    try:
        wait_for_samples(run, tmp_path / "out/record.h5", 20)
        run.terminate()
        run.communicate(timeout=60)
    finally:
        run.kill()
    assert run.returncode == 130
    with Record.load(tmp_path / "out/record.h5") as record:
        assert record.ended == "interrupted"


def test_a_controller_that_raises_keyboard_interrupt_is_no_ctrl_c(tmp_path: Path) -> None:
    (tmp_path / "tired.py").write_text(
        "import physim\nclass Tired:\n    def decide(self, seen, memory):\n"
        "        if seen.time > 0.2: raise KeyboardInterrupt\n"
        "        return physim.Decision(v=0.5, omega=0.0, hold=0.1)\n"
    )
    run = started(
        "run", "straight", "--controller", "tired:Tired", "-o", "out", "--no-video",
        folder=tmp_path,
    )  # fmt: skip
    _, err = run.communicate(timeout=120)
    assert run.returncode == 2
    assert err.strip().splitlines()[-1].startswith(f"{tmp_path / 'tired.py'}:4: ")
    assert "KeyboardInterrupt" in err
