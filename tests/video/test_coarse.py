"""Pictures of records with few samples: all of a picture is of one moment."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim.drawing.page import page
from physim.record import Record
from tests.cli.commands import physim as physim_command
from tests.helpers import facts, inside

make_page = inside("physim.cli", "make_page")
Timeline = inside("physim.drawing", "Timeline")
SAMPLE, Beside, Painter = inside("physim.drawing.video", "SAMPLE", "Beside", "Painter")
mark_lasts = inside("physim.drawing.video", "mark_lasts")

EVERY = 40


@pytest.fixture(scope="module")
def runs() -> Iterator[tuple[Record, Record]]:
    """One run, recorded at every step, and at every 40th."""
    change = ["time.duration=3.3", "expect=null"]
    fine = physim.simulate(physim.load_world("crossing", overrides=change))
    few = [*change, f"time.record_every={EVERY}"]
    coarse = physim.simulate(physim.load_world("crossing", overrides=few))
    yield fine, coarse
    fine.close()
    coarse.close()


def test_all_of_a_moment_is_of_the_sample_before(runs: tuple[Record, Record]) -> None:
    fine, coarse = map(Timeline, runs)
    assert (fine.spacing, coarse.spacing) == (0.0, pytest.approx(EVERY * runs[1].dt))
    assert fine.at(1.0).time == 1.0
    ends = [*runs[1].time[1:].tolist(), np.inf]
    for time in (0.0, 0.7, 1.0, 2.39, 3.3, 9.0):
        now = coarse.at(time)
        assert now.time == runs[1].time[now.sample] <= time + 1e-9 < ends[now.sample]
        exact = fine.at(now.time)
        assert np.array_equal(now.pose, exact.pose)
        assert np.array_equal(now.decisions, exact.decisions)
    assert not coarse.over(coarse.at(3.29).time)
    assert coarse.over(coarse.at(3.3).time)


def test_distances_told_are_of_that_moment(runs: tuple[Record, Record]) -> None:
    """In the record they are the least since the sample before."""

    def told(painter: Painter, time: float) -> list[Any]:
        now = painter.timeline.at(time)
        pair = painter._view._closest.pair(now.pose)
        return list(painter._panel._figures(now, pair))

    fine, coarse = (Painter(Timeline(one), 1.0, 25.0) for one in runs)
    kept = runs[1].boundary_clearance.min(axis=1)
    exact = runs[0].boundary_clearance[runs[1].steps].min(axis=1)
    assert np.abs(kept - exact).max() > 0.02, "the record must have others"
    for time in runs[1].time.tolist():
        assert told(coarse, time) == told(fine, time)


def test_two_runs_say_what_time_is_shown(
    runs: tuple[Record, Record], monkeypatch: pytest.MonkeyPatch
) -> None:
    fine, coarse = map(Timeline, runs)
    said: list[str] = []
    monkeypatch.setattr(
        "physim.drawing.video.frames.write", lambda _, words, *__, **___: said.append(words)
    )
    both = Beside(fine, coarse, 1.0, 25.0)
    both.paint(float(runs[1].time[3]) - 1e-10)
    assert not any("shown" in words for words in said)
    said.clear()
    both.paint(1.0)
    shown = SAMPLE.format(coarse.at(1.0).time)
    assert [shown in words for words in said if "arrived" in words] == [False, True]


def test_marks_of_contacts_between_two_samples_are_seen(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    few = np.r_[0 : len(record.steps) : 100, len(record.steps) - 1]
    arrays = {
        name: getattr(record, name)[few]
        for name in ("time", "steps", "pose", "clearance", "boundary_clearance")
    }
    coarse = Timeline(changed(record, record_every=100, **arrays))
    view = Painter(coarse, 0.1, 25.0)._view
    assert mark_lasts(0.1) < coarse.spacing == view._lasts


def test_the_command_says_which_sample_it_shows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = ("run", "crossing", "--no-video", "--quiet", "--set", "expect=null",
              "--set", "time.duration=3.3")  # fmt: skip
    physim_command(*common, "-o", tmp_path / "fine", capture=capsys)
    physim_command(*common, "--set", f"time.record_every={EVERY}", "-o", tmp_path / "few",
                   capture=capsys)  # fmt: skip
    for folder, at, said in (
        ("few", "1.0", ("few/record.h5", "every 0.4 s", "of 0.8 s")),
        ("few", "3.3", ()),
        ("few", "1.2", ()),
        ("fine", "1.005", ()),
    ):
        done = physim_command("video", tmp_path / folder / "record.h5", "--at", at, "--force",
                              "-o", tmp_path / "a.png", capture=capsys)  # fmt: skip
        assert done.code == 0
        assert re.search(facts("WARNING", *said), done.err) if said else not done.err, done.err
    done = physim_command("video", tmp_path / "few/record.h5", "--quiet", capture=capsys)
    assert re.search(facts("WARNING", "every 0.4 s"), done.err), done.err


def test_a_page_says_how_robots_are_drawn_between_samples(
    runs: tuple[Record, Record], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fine, coarse = runs
    for records, is_told in (((fine,), False), ((coarse,), True), ((fine, coarse), True)):
        assert ("samples every 0.4 s" in page(*records).html) == is_told
        make_page(records, tmp_path / "p.html", quiet=True)
        told = capsys.readouterr().err
        assert bool(re.search(facts("WARNING", "p.html", "0.4 s", "between"), told)) == is_told
