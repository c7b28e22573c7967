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
from tests.cli.commands import LONG, frames, physim, started, tree
from tests.helpers import facts
from tests.helpers.records import make_record


@pytest.fixture
def process(here: Path, request: pytest.FixtureRequest) -> Iterator[subprocess.Popen[str]]:
    """A long run under way, some seconds of it recorded; ended in any case."""
    (here / "long.yaml").write_text(LONG)
    process = started("run", "long.yaml", "-o", "out", *request.param, folder=here)
    try:
        wait_for_samples(process, here / "out/record.h5", 300)
        yield process
    finally:
        end(process)


def end(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        process.kill()
        process.communicate()


def wait_for_samples(process: subprocess.Popen[str], path: Path, samples: int) -> None:
    while process.poll() is None:
        with suppress(RecordError), Record.load(path) as record:
            if record.samples >= samples:
                return
        time.sleep(0.02)
    raise AssertionError(process.communicate()[1])


def check_record(path: Path) -> None:
    """An interrupted run, complete."""
    with Record.load(path) as record:
        assert record.ended == "interrupted"
        assert record.samples == record.steps_run + 1 >= 300
        assert record.steps.tolist() == list(range(record.samples))
        assert np.isfinite(record.pose).all()
        assert record.updates["step"].max() < record.steps_run <= record.updates["next_step"].max()
        assert summarise(record).run.record.ended == "interrupted"


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


@pytest.mark.parametrize("process", [["--no-video"]], indirect=True)
def test_a_killed_run_can_be_summarised_and_no_run_takes_the_place_of_one_that_goes_on(
    process: subprocess.Popen[str], here: Path, capsys
) -> None:
    second = physim("run", "small.yaml", "--no-video", "--force", "-o", "out", capture=capsys)
    assert (second.code, second.out) == (2, "")
    assert re.search(facts("summary.json: ", "another", "writing"), second.err), second.err
    end(process)
    path = here / "out/record.h5"
    with Record.load(path) as record:
        assert record.ended == "running"
        assert record.steps_run == record.samples - 1 >= 299
        assert record.clearance.shape == (record.samples, 2)
        assert (record.extremes["clearance"] <= record.clearance.min(axis=0)).all()
    done = physim("summary", path, capture=capsys)
    assert (done.code, done.err) == (0, "")
    assert re.search(facts("not closed", "killed"), done.out)
    left = {file.name: file.stat().st_size for file in (here / "out").iterdir()}
    locks = {".record.h5.lock", ".summary.json.lock"}
    assert left.keys() == {"record.h5", *locks}
    assert not any(left[name] for name in locks)


@pytest.mark.deep
@pytest.mark.parametrize("second", [None, signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("process", [[]], indirect=True)
def test_the_video_so_far_is_made_unless_a_second_signal_ends_it_sooner(
    process: subprocess.Popen[str], here: Path, second: signal.Signals | None
) -> None:
    process.send_signal(signal.SIGINT)
    if second:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("writing the video so far"):
                break
        process.send_signal(second)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert out.startswith("run ")
    check_record(here / "out/record.h5")
    (film,) = {f.name for f in (here / "out").iterdir()} - {"record.h5", "summary.json"}
    if film != "video.mp4":  # which may be done first
        assert second
        assert film == "video.cut_short.mp4"
        assert re.search(facts("video.cut_short.mp4", "physim video out/record.h5"), err), err
        assert err.count("\n") == 1
    assert frames(here / "out" / film) > 0


@pytest.mark.deep
@pytest.mark.parametrize("late", [0.15, 0.25, 0.4])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_at_the_start(number: signal.Signals, late: float, here: Path) -> None:
    """From the first moment that physim itself runs; before it, Python answers as it does."""
    process = started("validate", "hundred_robots", "--quiet", folder=here)
    time.sleep(late)
    process.send_signal(number)
    told = process.communicate(timeout=60)
    assert process.returncode in (130, -number), told
    assert process.returncode == -number or told == ("", "interrupted\n")


OWN = """
import physim

STILL = physim.Decision(v=0.0, omega=0.0, hold=0.1)

class Loop:
    def decide(self, observation, memory):
        if observation.time > 0.5:
            open("stuck", "w").close()
            while True:
                pass
        return STILL
"""


@pytest.mark.deep
def test_a_controller_that_never_returns_is_broken_off_by_a_second_signal(here: Path) -> None:
    (here / "own_loop.py").write_text(OWN)
    given = ("--controller", "own_loop:Loop", "--no-video", "--quiet", "-o", "out")
    process = started("run", "small.yaml", *given, folder=here)
    try:
        while process.poll() is None and not (here / "stuck").exists():
            time.sleep(0.05)
        process.terminate()
        time.sleep(1.5)
        assert process.poll() is None, "the first waits for the end of the step"
        process.terminate()
        _, err = process.communicate(timeout=60)
    finally:
        end(process)
    assert (process.returncode, err) == (130, "interrupted\n")
    Record.load(here / "out/record.h5").close()


@pytest.mark.deep
@pytest.mark.parametrize(
    ("arguments", "ready", "said"),
    [
        (("video", "record.h5"), ".*.part", ("interrupted", "video.cut_short.mp4")),
        (("plot", "record.h5", "-o", "out"), "out/*.png", ("interrupted", "of 9 pictures")),
        (("check", "small.yaml", "--watch"), "", ("interrupted",)),
    ],
)
def test_ctrl_c_of_a_process(arguments: tuple[str, ...], ready: str, said: Any, here: Path) -> None:
    make_record(here / "record.h5", seconds=60.0).close()
    process = started(*arguments, folder=here)
    try:
        if ready:
            while process.poll() is None and not list(here.glob(ready)):
                time.sleep(0.01)
        else:
            assert process.stdout is not None
            process.stdout.readline()
        os.killpg(process.pid, signal.SIGINT)  # the terminal sends it to all of the group
        _, err = process.communicate(timeout=60)
    finally:
        end(process)
    assert (process.returncode, err.count("\n")) == (130, 1), err
    assert re.search(facts(*said), err), err
    assert not list(here.rglob(".*"))


def interrupting(calls: int) -> Callable[..., None]:
    """What sends Ctrl-C to this process when it is called so many times."""
    left = [calls]

    def called(*_: object) -> None:
        left[0] -= 1
        if left[0] == 0:
            os.kill(os.getpid(), signal.SIGINT)

    return called


def test_an_interrupted_crash_test_tells_how_far_it_came(here: Path, monkeypatch, capsys) -> None:
    crash_test(11)
    press = interrupting(1)

    def pressed(cases: int, seed: int, **more: Any) -> CrashReport:
        told = more.pop("progress")
        return crash_test(cases, seed, **more, progress=lambda done: (told(done), press())[0])

    monkeypatch.setattr("physim.analysis.crashtest.crash_test", pressed)
    done = physim("crashtest", "--cases", 5000, "--json", "found.json", capture=capsys)
    assert done.code == 130
    found = json.loads((here / "found.json").read_text())
    cases = found["cases"]
    assert 0 < cases < 5000
    assert (found["interrupted"], found["cases_asked"]) == (True, 5000)
    assert re.search(facts("interrupted", f"{cases:,} of 5,000 cases"), done.err), done.err
    assert done.err.count("\n") == 1
    verdict = facts("agree", f"0 of {cases} cases", "interrupted", f"{5000 - cases:,}")
    assert re.search(verdict, done.out.splitlines()[-1]), done.out


def test_a_film_that_is_cut_short_has_a_name_that_says_so(here: Path, monkeypatch, capsys) -> None:
    make_record(here / "record.h5", seconds=2.0).close()
    press = interrupting(3)

    def pressed(*arguments: Any, **more: Any) -> int:
        told = more.pop("progress")
        return render(*arguments, **more, progress=lambda done, of: (told(done, of), press())[0])

    monkeypatch.setattr("physim.drawing.video.render", pressed)
    (here / "video.mp4").write_text("the whole film")
    done = physim("video", "record.h5", "--force", capture=capsys)
    short = here / "video.cut_short.mp4"
    assert (done.code, done.out, done.err.count("\n")) == (130, "", 1)
    assert re.search(facts("interrupted", short.name), done.err), done.err
    assert frames(short) == 3
    assert (here / "video.mp4").read_text() == "the whole film"
    assert not list(here.glob(".*"))
    short.unlink()
    short.symlink_to(here / "record.h5")
    refused = physim("video", "record.h5", "--force", capture=capsys)
    assert (refused.code, refused.out) == (2, "")
    assert re.search(facts("video.cut_short.mp4:", "a link"), refused.err), refused.err


def test_ctrl_c_within_a_callback_of_the_engine(here: Path, monkeypatch, capsys) -> None:
    """Which would swallow it."""
    press, step = interrupting(10), Physics.step

    def pressed(self: Physics, command: Any) -> None:
        with suppress(KeyboardInterrupt):
            press()
        step(self, command)

    monkeypatch.setattr(Physics, "step", pressed)
    assert physim("validate", "small.yaml", capture=capsys) == (130, "", "interrupted\n")


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
            "physim.analysis.validation.judge",
        ),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_ctrl_c_anywhere_else_is_one_line_and_leaves_nothing(
    arguments: tuple[str, ...], at: str, here: Path, monkeypatch, capsys
) -> None:
    make_record(here / "record.h5", seconds=1.0).close()
    before = tree(here)

    def pressed(*_: object, **__: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(10.0)

    monkeypatch.setattr(at, pressed)
    assert physim(*arguments, capture=capsys) == (130, "", "interrupted\n")
    assert tree(here) == before
