"""`physim falsify` as a user has it: what is written, said and returned."""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from physim.record import Record
from physim.world import World
from physim.world.file import load_world
from tests.campaigns.falsify.worlds import five_robots, judge
from tests.cli.commands import SMALL, frames, physim
from tests.helpers import inside

in_this_process, Judged = inside("physim.campaigns.falsify", "in_this_process", "Judged")

QUIET_SMALL = SMALL.replace("duration: 2.0", "duration: 0.4")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    five_robots(time={"step": 0.05, "duration": 6.0}).save(tmp_path / "five.yaml")
    (tmp_path / "small.yaml").write_text(QUIET_SMALL)
    return tmp_path


def test_a_failure_is_written_as_a_world_that_fails(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By worker processes, as it usually is."""
    done = physim("falsify", "five.yaml", "--budget", "9", "-o", "out", "--workers", "2",
                  "--json", "found.json", capture=capsys)  # fmt: skip
    assert done.code == 1, done.err
    out = here / "out"
    assert {file.name for file in out.iterdir()} == {
        "worst.yaml", "as_found.yaml", "record.h5", "video.mp4", "story.txt",
    }  # fmt: skip
    text = (out / "worst.yaml").read_text()
    head = "".join(line for line in text.splitlines(keepends=True) if line.startswith("#"))
    (time,) = re.findall(r"r2 and r4 touch at ([\d.]+) s", head)
    assert float(time) < 1.0
    assert "physim falsify five.yaml --budget 9" in head
    story = (out / "story.txt").read_text()
    assert story in done.out
    for word in ("r2", "r4", f"{time} s", "1.00 m/s", "front", "rear", "Responsible"):
        assert word in story
    assert re.search("robots 5 to 2", done.out)
    found = json.loads((here / "found.json").read_text())
    assert (found["failed"], found["runs"], found["worst"]["touched"]["time_s"]) == (True, 1, 4.0)
    assert {one["kind"] for one in found["bounds"]} == {"pose", "heading"}
    assert found["shrunk"]["worst"]["touched"]["time_s"] == pytest.approx(float(time), abs=5e-3)
    assert frames(out / "video.mp4") > 5
    with Record.load(out / "record.h5") as record:
        assert record.world == load_world(out / "worst.yaml")
    assert judge_of(out / "worst.yaml").failed
    names = {load_world(file).stem for file in (here / "five.yaml", *out.glob("*.yaml"))}
    assert len(names) == 3  # runs of each go to a folder of their own
    (run,) = re.findall(r"To see it: (physim run [^\n]*)", head)
    again = physim(*run.split()[1:], "--no-video", "-o", "again", capture=capsys)
    assert again.code == 1
    checked = physim("check", "out/worst.yaml", capture=capsys)
    assert checked.code == 0
    judged = physim("validate", "again/record.h5", capture=capsys)
    assert judged.code == 1


@pytest.mark.usefixtures("in_process")
def test_where_nothing_fails_the_nearest_miss_is_written(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ("falsify", "small.yaml", "--budget", "5", "-o", "out", "--no-video")
    done = physim(*arguments, capture=capsys)
    assert done.code == 0, done.err
    assert "no failure in 5 runs" in done.out
    assert "no proof" in done.out
    assert {file.name for file in (here / "out").iterdir()} == {
        "worst.yaml", "record.h5", "story.txt",
    }  # fmt: skip
    (least,) = re.findall(r"least clearance ([\d.]+) m", done.out)
    result = judge_of(here / "out/worst.yaml")
    assert result.clearance == pytest.approx(float(least), abs=1e-3)
    story = " ".join((here / "out/story.txt").read_text().split())
    assert "Nothing touches" in story
    assert all(name in story for name in result.pair)
    again = physim(*arguments, capture=capsys)
    assert again.code == 2
    assert "--force" in again.err
    forced = physim(*arguments, "--force", capture=capsys)
    assert (forced.code, forced.out) == (0, done.out)


def judge_of(path: Path) -> Judged:
    return judge(load_world(path))


def interrupting(calls: int) -> Callable[..., Any]:
    """Runs in this process; before one of them Ctrl-C is pressed."""
    seen = iter(range(1, 1000))

    def by_executor(executor: object, world: World, stop: Callable[[], bool]) -> Any:
        here = in_this_process(stop)

        def evaluate(worlds: Sequence[World]) -> Iterator[Judged]:
            for world in worlds:
                if next(seen) == calls:
                    os.kill(os.getpid(), signal.SIGINT)
                yield from here([world])

        return evaluate

    return by_executor


@pytest.mark.parametrize(("world", "calls"), [("small.yaml", 4), ("five.yaml", 4)])
def test_interrupted_it_writes_the_worst_so_far(
    here: Path,
    world: str,
    calls: int,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In the search, and while it shrinks."""
    monkeypatch.setattr("physim.campaigns.falsify.evaluate.by_executor", interrupting(calls))
    done = physim("falsify", world, "-o", "out", "--no-video", capture=capsys)
    assert done.code == 130, done.err
    assert judge_of(here / "out/worst.yaml").failed == (world == "five.yaml")
    assert (here / "out/story.txt").read_text() in done.out
    if world == "small.yaml":
        assert re.search("interrupted after 3 of 200 runs", done.out)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["five.yaml", "--vary", "pose,mass"], ["--vary", "pose", "speed"]),
        (["five.yaml", "--budget", "0"], ["--budget"]),
        (["five.yaml", "--set", "robots.0.pose=[8, 0, 0]"], ["r1", "r4"]),
        (["nowhere"], ["nowhere"]),
        (["five.yaml", "--controller", "constnat"], ["constant"]),
    ],
)
def test_bad_input_is_refused(
    here: Path, arguments: list[str], words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    done = physim("falsify", *arguments, "-o", "out", capture=capsys)
    assert done.code == 2
    assert all(word in done.err for word in words), done.err
    assert "Traceback" not in done.err
    assert not (here / "out").exists()


CHANCE = """\
import itertools
from physim import Decision

COUNT = itertools.count()

class Chance:
    def decide(self, observation, memory):
        v = 1.0 if next(COUNT) < 200 and observation.index == 1 else 0.0
        return Decision(v=v, omega=0.0, hold=0.1)
"""


@pytest.mark.usefixtures("in_process")
def test_a_failure_that_does_not_come_again_is_told(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A controller that remembers earlier runs: its failure is no result."""
    (here / "chance_for_tests.py").write_text(CHANCE)
    monkeypatch.syspath_prepend(str(here))
    done = physim("falsify", "five.yaml", "--controller", "chance_for_tests:Chance", "-o", "out",
                  "--shrink", "0", capture=capsys)  # fmt: skip
    assert done.code == 2
    assert "once more" in done.err
