"""Two runs side by side go in step, at one scale; of few samples each moment is one sample."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import physim
from physim.drawing.page import page
from physim.drawing.video import frame_at
from physim.record import Record
from physim.world.file import parse_world
from tests.cli.commands import SMALL
from tests.drawing import palette
from tests.drawing.video.looking import HEIGHT, WIDTH, pixels
from tests.helpers import facts, inside, said

Timeline, rgb = inside("physim.drawing", "Timeline", "rgb")
Canvas = inside("physim.drawing.video", "Canvas")
BARS, Box, FOOTER, HEADER = inside("physim.drawing.video", "BARS", "Box", "FOOTER", "HEADER")
View, ground = inside("physim.drawing.video", "View", "ground")
render, titles = inside("physim.drawing.video", "render", "titles")
SAFE = inside("physim.parts", "SAFE")

LEFT = (slice(0, HEADER), slice(0, WIDTH // 2 - 2))
RIGHT = (slice(0, HEADER), slice(WIDTH // 2 + 2, WIDTH))
VIEWS = slice(HEADER, HEIGHT - BARS - FOOTER)
BLOCKED = SMALL + "obstacles: [[[8.0, 0.0], [8.5, 0.0], [8.5, 2.0], [8.0, 2.0]]]\n"
CONTROLLED = SMALL + "controller: {type: mode_switching, beta: 0.2}\n"
EVERY = 40


@pytest.fixture(scope="module")
def free() -> Record:
    return physim.simulate(parse_world(SMALL))


@pytest.fixture(scope="module")
def blocked() -> Record:
    """A run half as long that drives against an obstacle from the start on."""
    world = parse_world(BLOCKED).changed(
        time={"step": 0.02, "duration": 1.4}, controller={"type": "path_following"}
    )
    record = physim.simulate(world)
    assert len(record.contacts)
    return record


def test_either_half_is_the_view_of_its_own_run(free: Record, blocked: Record) -> None:
    image = frame_at(free, 0.8, beside=blocked, speed=1.0)
    assert image.shape == (HEIGHT, WIDTH, 3)
    half = (WIDTH - 3) // 2
    for record, left in ((free, 0), (blocked, WIDTH - half)):
        box, alone = Box(left, HEADER, half, VIEWS.stop - HEADER), Canvas((WIDTH, HEIGHT))
        timeline = Timeline(record)
        View(timeline, ground(timeline), box, 1.0, 25.0).paint(alone.part(box), timeline.at(0.8))
        assert np.array_equal(box.of(image), box.of(alone.pixels)[..., :3])


def test_the_header_tells_the_contacts_of_its_run(free: Record, blocked: Record) -> None:
    end = frame_at(free, 2.0, beside=blocked, speed=1.0)
    assert pixels(end, palette.CONTACT, LEFT) == 0
    assert pixels(end, palette.CONTACT, RIGHT) > 100
    turned = frame_at(blocked, 2.0, beside=free, speed=1.0)
    assert pixels(turned, palette.CONTACT, LEFT) > 100
    assert pixels(turned, palette.CONTACT, RIGHT) == 0
    assert pixels(frame_at(free, 0.0, beside=blocked, speed=1.0), palette.CONTACT, RIGHT) == 0


def test_a_run_that_is_over_keeps_its_last_picture_pale_and_marked(
    free: Record, blocked: Record
) -> None:
    def at(time: float) -> Any:
        return frame_at(free, time, beside=blocked, speed=1.0)

    part = VIEWS, RIGHT[1]
    before, ended, later = at(1.38), at(1.4), at(1.8)
    assert np.array_equal(ended[part], later[part])
    still = ended[part].astype(float) - 0.55 * before[part]
    assert np.median(np.abs(still - 0.45 * 255.0)) < 2.0  # the same view, of paler colours
    assert pixels(ended, palette.INK, RIGHT) > pixels(before, palette.INK, RIGHT) + 1000
    assert not np.array_equal(ended[VIEWS, LEFT[1]], later[VIEWS, LEFT[1]])


def test_the_film_lasts_as_long_as_the_longer_run(
    free: Record, blocked: Record, tmp_path: Path
) -> None:
    alone = render(free, tmp_path / "one.mp4", fps=5.0, speed=2.0, width=320)
    both = render(blocked, tmp_path / "two.mp4", beside=free, fps=5.0, speed=2.0, width=320)
    assert both == alone


def test_both_views_have_one_scale_where_robots_stay_large_enough(free: Record) -> None:
    wide = {"centreline": [[0.0, 0.0], [40.0, 0.0]], "width": 16.0}
    large = physim.simulate(parse_world(SMALL).changed(corridor=wide))
    safe = rgb(SAFE.colour)
    image = frame_at(free, 0.1, beside=large, speed=1.0)
    one, other = (pixels(image, safe, (VIEWS, half[1])) for half in (LEFT, RIGHT))
    assert one == pytest.approx(other, rel=0.05)
    assert one > 300


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (SMALL, SMALL, ("", "")),
        (SMALL, SMALL.replace("seed: 1", "seed: 2"), ("seed: 1", "seed: 2")),
        (SMALL, CONTROLLED, ("beta: default", "beta: 0.2")),
        (CONTROLLED, SMALL + "controller: {type: path_following}\n",
         ("controller: mode_switching", "controller: path_following")),
        (SMALL, BLOCKED, ("8 values, obstacles.0.0.0: none, obstacles.0.0.1: none",
                          "8 values, obstacles.0.0.0: 8.0, obstacles.0.0.1: 0.0")),
        (SMALL, re.sub("name: .*", "name: shut", BLOCKED, count=1),
         (parse_world(SMALL).name, "shut")),
    ],
)  # fmt: skip
def test_titles_say_in_what_worlds_differ(one: str, other: str, expected: tuple[str, str]) -> None:
    assert titles(parse_world(one), parse_world(other)) == expected


def test_a_title_names_the_stage_of_which_a_setting_differs() -> None:
    slow, fast = (
        parse_world(SMALL).changed(filters=[{"type": "ramp", "gap": gap}]) for gap in (0.0, 2.0)
    )
    assert titles(slow, fast) == ("ramp gap: 0.0", "ramp gap: 2.0")


def test_a_title_names_the_stages_that_only_one_world_has() -> None:
    names = ["noise", "messages"]
    some = parse_world(SMALL).changed(sensing={"stages": [{"type": name} for name in names]})
    told = "with noise, messages", "without noise, messages"
    assert titles(some, parse_world(SMALL)) == told
    assert titles(parse_world(SMALL), some) == told[::-1]


def test_the_command_writes_beside_the_first_record(
    free: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        Path(name).mkdir()
        free.save(Path(name, "record.h5"))
    pair = ("video", "a/record.h5", "b/record.h5")
    assert said(*pair)[:2] == (0, f"{Path('a/beside.mp4')}\n")
    assert "--force" in said(*pair).err
    kept = Path("b/record.h5").read_bytes()
    assert said(*pair, "-o", "b/record.h5", "--force").code == 2
    assert Path("b/record.h5").read_bytes() == kept
    Path("no.h5").write_text("no record")
    bad = said("video", "a/record.h5", "no.h5", "-o", "x.mp4")
    assert bad.code == 2
    assert "no.h5" in bad.err
    assert not Path("x.mp4").exists()


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


def test_distances_told_are_of_that_moment(runs: tuple[Record, Record], written: list[str]) -> None:
    """In the record they are the least since the sample before."""
    kept = runs[1].boundary_clearance.min(axis=1)
    exact = runs[0].boundary_clearance[runs[1].steps].min(axis=1)
    assert np.abs(kept - exact).max() > 0.02, "the record must have others"
    for time in runs[1].time.tolist():
        told = []
        for record in runs:
            written.clear()
            frame_at(record, time, speed=1.0)
            told.append(written[written.index("contacts so far") :])
        assert any(words.endswith(" m") for words in told[0])
        assert [words for words in told[0] if words.endswith(" m")] == [
            words for words in told[1] if words.endswith(" m")
        ]


def test_of_two_runs_the_coarse_one_says_what_time_is_shown(
    runs: tuple[Record, Record], written: list[str]
) -> None:
    fine, coarse = runs
    for time, told in ((float(coarse.time[3]) - 1e-10, 0), (1.0, 1)):
        written.clear()
        frame_at(fine, time, beside=coarse, speed=1.0)
        assert sum("shown at 0.8 s" in words for words in written) == told


def test_marks_of_contacts_between_two_samples_are_seen(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    first = record.contacts[record.contacts["b"] < 3]  # from 1.2 s on
    few = np.r_[0 : len(record.steps) : 150, len(record.steps) - 1]
    fields = ("time", "steps", "pose", "clearance", "boundary_clearance")
    arrays = {name: getattr(record, name)[few] for name in fields}
    coarse = changed(record, contacts=first, record_every=150, **arrays)
    fine = changed(record, contacts=first)
    shown = [pixels(frame_at(one, 3.0, speed=0.1), palette.CONTACT) for one in (coarse, fine)]
    assert shown[0] > 30
    assert shown[1] == 0


def test_commands_and_pages_say_which_sample_is_shown(
    runs: tuple[Record, Record], tmp_path: Path
) -> None:
    for record, at, told in (
        (runs[1], "1.0", ("record.h5", "every 0.4 s")),
        (runs[1], "1.2", ()),
        (runs[0], "1.005", ()),
    ):
        file = tmp_path / "record.h5"
        file.unlink(missing_ok=True)
        record.save(file)
        done = said("video", str(file), "--at", at, "--force", "-o", str(tmp_path / "a.png"))
        assert done.code == 0
        assert re.search(facts("WARNING", *told), done.err) if told else not done.err, done.err
    fine, coarse = runs
    for records, is_told in (((fine,), False), ((coarse,), True), ((fine, coarse), True)):
        assert ("samples every 0.4 s" in page(*records).html) == is_told
