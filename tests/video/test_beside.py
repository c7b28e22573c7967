"""Two runs side by side."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import physim
from physim import Decision, Mode
from physim.drawing import palette
from physim.drawing.video import frame_at, layout, render
from physim.drawing.video.frames import PAD, differences
from physim.record import Record
from physim.world.file import parse_world
from tests.cli.commands import SMALL
from tests.cli.commands import physim as command
from tests.helpers import inside
from tests.video.test_frames import pixels

Timeline = inside("physim.drawing", "Timeline")
BARS, FOOTER, HEADER, Beside = inside("physim.drawing.video", "BARS", "FOOTER", "HEADER", "Beside")
file_names, one_legend = inside("physim.drawing.video", "file_names", "one_legend")
titles, ground, Box, Image = inside("physim.drawing.video", "titles", "ground", "Box", "Image")
View = inside("physim.drawing.video", "View")

LEFT = (slice(0, HEADER), slice(0, layout.WIDTH // 2 - 2))
RIGHT = (slice(0, HEADER), slice(layout.WIDTH // 2 + 2, layout.WIDTH))
TINY = """\
name: tiny
time: {step: 0.005, duration: 2.0}  # [s]
corridor: {centreline: [[0, 0], [1.0, 0]], width: 0.4}  # [m]
robots:
  - name: a
    footprint: {length: 0.09, width: 0.05}  # [m]
    pose: [0.3, 0.0, 0.0]
    path: {offset: 0.0}
controller: {type: constant, commands: [[0.05, 0.0]]}
"""
"""Robots of some centimetres."""
BLOCKED = SMALL + "obstacles: [[[8.0, 0.0], [8.5, 0.0], [8.5, 2.0], [8.0, 2.0]]]\n"


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
    assert image.shape == (layout.HEIGHT, layout.WIDTH, 3)
    half, high = (layout.WIDTH - 3) // 2, layout.HEIGHT - HEADER - BARS - FOOTER
    for record, left in ((free, 0), (blocked, layout.WIDTH - half)):
        box, alone = Box(left, HEADER, half, high), np.zeros_like(image)
        timeline = Timeline(record)
        view = View(timeline, ground(timeline), box, 1.0, 25.0)
        view.paint(alone, timeline.at(0.8))
        assert np.array_equal(box.of(image), box.of(alone))


def test_the_header_tells_the_contacts_of_its_run(free: Record, blocked: Record) -> None:
    end = frame_at(free, 2.0, beside=blocked, speed=1.0)
    assert pixels(end, palette.CONTACT, LEFT) == 0
    assert pixels(end, palette.CONTACT, RIGHT) > 100
    turned = frame_at(blocked, 2.0, beside=free, speed=1.0)
    assert pixels(turned, palette.CONTACT, LEFT) > 100
    assert pixels(turned, palette.CONTACT, RIGHT) == 0
    assert pixels(frame_at(free, 0.0, beside=blocked, speed=1.0), palette.CONTACT, RIGHT) == 0


def test_a_run_that_is_over_stays_as_it_ended(free: Record, blocked: Record) -> None:
    painter = Beside(Timeline(free), Timeline(blocked), 1.0, 25.0)
    assert painter.duration == pytest.approx(2.0)
    at_its_end = Beside(Timeline(blocked), Timeline(blocked), 1.0, 25.0).frame(1.4)
    below = slice(HEADER, layout.HEIGHT - BARS - FOOTER), slice(layout.WIDTH // 2 + 2, layout.WIDTH)
    assert np.array_equal(painter.frame(2.0)[below], at_its_end[below])


def test_the_video_lasts_as_long_as_the_longer_run(
    free: Record, blocked: Record, tmp_path: Path
) -> None:
    alone = render(free, tmp_path / "one.mp4", fps=10.0, speed=1.0)
    assert render(blocked, tmp_path / "two.mp4", beside=free, fps=10.0, speed=1.0) == alone


CONTROLLED = SMALL + "controller: {type: mode_switching, beta: 0.2}\n"


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        (SMALL, SMALL, ("", "")),
        (SMALL, SMALL.replace("seed: 1", "seed: 2"), ("seed: 1", "seed: 2")),
        (SMALL, CONTROLLED, ("beta: default", "beta: 0.2")),
        (CONTROLLED, CONTROLLED.replace("0.2", "0.3"), ("beta: 0.2", "beta: 0.3")),
        (CONTROLLED, SMALL + "controller: {type: path_following}\n",
         ("controller: mode_switching", "controller: path_following")),
        (SMALL, BLOCKED, ("8 values, obstacles.0.0.0: none, obstacles.0.0.1: none",
                          "8 values, obstacles.0.0.0: 8.0, obstacles.0.0.1: 0.0")),
        (SMALL, re.sub("name: .*", "name: shut", BLOCKED, count=1),
         (parse_world(SMALL).name, "shut")),
        (SMALL, SMALL.replace("1.0, 0.0]", "1.5, 0.0]"), ("pose.1: 1.0", "pose.1: 1.5")),
        (SMALL, SMALL.replace("width: 1.0", "width: 1.1"),
         ("robots.0.footprint.width: 1.0, robots.1.footprint.width: 1.0",
          "robots.0.footprint.width: 1.1, robots.1.footprint.width: 1.1")),
    ],
)  # fmt: skip
def test_titles_say_in_what_worlds_differ(one: str, other: str, expected: tuple[str, str]) -> None:
    assert titles(parse_world(one), parse_world(other)) == expected


def test_an_entry_of_a_list_that_a_world_has_not_is_told_as_none() -> None:
    found = differences(parse_world(SMALL), parse_world(BLOCKED))
    assert {left for left, _ in found.values()} == {"none"}


GO, WAIT = Mode("go", "#0072b2"), Mode("wait", "#e69f00")
SAFE = Mode("safe", "#0072b2")


@pytest.mark.parametrize(
    ("left", "right", "shared"),
    [
        ([GO, WAIT], [GO], [GO, WAIT]),
        ([GO], [WAIT], [GO, WAIT]),
        ([GO], [SAFE], []),  # one colour, two meanings
        ([GO, WAIT], [Mode("wait", "#0072b2")], []),  # one name, two colours
        ([GO], [Mode("go", "#0072B2")], [GO]),
        ([], [GO], [GO]),
    ],
)
def test_runs_share_a_legend_where_a_colour_says_the_same_in_both(
    left: list[Mode], right: list[Mode], shared: list[Mode]
) -> None:
    assert [one.name for one in one_legend(left, right)] == [one.name for one in shared]
    assert len(one_legend(right, left)) == len(shared)


class Blue:
    """Goes straight on, in the blue that other controllers have for something else."""

    modes = (GO,)

    def decide(self, observation: object, memory: object) -> Decision:
        return Decision(v=0.2, omega=0.0, hold=0.1, mode="go")


def test_colours_with_two_meanings_stand_below_the_run_that_they_are_of(free: Record) -> None:
    own = physim.simulate(parse_world(SMALL), controller=Blue())
    legend = slice(layout.HEIGHT - FOOTER + 48, layout.HEIGHT)
    left, right = slice(0, layout.WIDTH // 2), slice(layout.WIDTH // 2, layout.WIDTH)
    blue = palette.rgb(GO.colour)
    apart = frame_at(own, 0.8, beside=free, speed=1.0)
    assert pixels(apart, blue, (legend, left)) > 50
    assert pixels(apart, blue, (legend, right)) > 50
    together = frame_at(free, 0.8, beside=free, speed=1.0)
    assert pixels(together, blue, (legend, left)) > 50
    assert pixels(together, blue, (legend, right)) == 0


def test_the_files_are_told_apart_by_their_names() -> None:
    assert file_names(Path("with/record.h5"), Path("runs/a-1/record.h5")) == ("with", "a-1")
    assert file_names(Path("one.h5"), Path("b/two.h5")) == ("one", "two")
    assert file_names(Path("a/with/record.h5"), Path("b/with/record.h5")) == ("", "")
    assert file_names(Path("one.h5"), None) == ("one", "")


def test_a_film_may_show_a_part_of_the_run(free: Record, tmp_path: Path) -> None:
    film = tmp_path / "part.mp4"
    whole = render(free, tmp_path / "whole.mp4", fps=10.0, speed=1.0)
    assert render(free, film, start=0.5, end=1.5, fps=10.0, speed=1.0) == whole - 10
    assert render(free, film, start=1.5, fps=10.0, speed=1.0) == whole - 15
    for start, end in ((2.0, 9.0), (1.0, 1.0), (-1.0, 1.0), (float("nan"), 1.0)):
        with pytest.raises(physim.PhysimError, match="nothing to show"):
            render(free, tmp_path / "no.mp4", start=start, end=end)
    assert not (tmp_path / "no.mp4").exists()


def test_the_command_writes_beside_the_first_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    for name in ("a", "b"):
        run = command("run", "small.yaml", "-o", name, "--no-video", "--quiet", capture=capsys)
        assert run.code == 0
    done = command("video", "a/record.h5", "--beside", "b/record.h5", capture=capsys)
    assert (done.code, done.out.split()) == (0, [str(Path("a/beside.mp4"))])
    other = command("video", "a/record.h5", "b/record.h5", "-o", "both.mp4", capture=capsys)
    assert (other.code, other.out.split()) == (0, ["both.mp4"])
    assert Path("both.mp4").read_bytes() == Path("a/beside.mp4").read_bytes()
    again = command("video", "a/record.h5", "--beside", "b/record.h5", capture=capsys)
    assert again.code == 2
    assert "--force" in again.err
    onto = command(
        "video", "a/record.h5", "--beside", "b/record.h5", "-o", "b/record.h5", "--force",
        capture=capsys,
    )  # fmt: skip
    assert onto.code == 2
    (tmp_path / "no.h5").write_text("no record")
    bad = command("video", "a/record.h5", "--beside", "no.h5", "-o", "x.mp4", capture=capsys)
    assert bad.code == 2
    assert "no.h5" in bad.err
    assert not (tmp_path / "x.mp4").exists()


def test_differences_are_the_values_that_two_worlds_do_not_share():
    given = parse_world(SMALL)
    assert differences(given, given) == {}
    other = given.changed(seed=4, controller={"type": "path_following", "speed": 2.0})
    assert differences(given, other) == {
        "seed": ("1", "4"),
        "controller.type": ("mode_switching", "path_following"),
    }
    absent = differences(given, given.changed(expect=None))
    assert absent == {"expect.contacts": ("0", "default")}


def test_a_run_that_has_ended_first_keeps_its_last_picture_pale_and_marked(
    free: Record, blocked: Record
) -> None:
    painter = Beside(Timeline(free), Timeline(blocked), 1.0, 25.0)
    below = slice(HEADER, layout.HEIGHT - BARS - FOOTER), slice(layout.WIDTH // 2 + 2, layout.WIDTH)
    just_before, ended, later = (painter.frame(time)[below] for time in (1.38, 1.4, 1.8))
    assert np.array_equal(ended, later)
    assert not np.array_equal(ended, painter.frame(2.0)[below])  # both whole
    still = ended.astype(float) - 0.55 * just_before
    assert np.median(np.abs(still - 0.45 * 255.0)) < 2.0  # the same view, of paler colours
    assert ended.min() >= 0.4 * 255.0  # all over: nothing covers it
    dark = [(painter.frame(time)[RIGHT] == palette.INK).all(axis=2).mean() for time in (1.3, 1.4)]
    assert dark[1] > dark[0] + 0.1  # and its header marked
    dark = [(painter.frame(time)[LEFT] == palette.INK).all(axis=2).mean() for time in (1.3, 1.4)]
    assert dark[1] < dark[0] + 0.01
    left = slice(HEADER, layout.HEIGHT - BARS - FOOTER), slice(0, layout.WIDTH // 2 - 2)
    assert not np.array_equal(painter.frame(1.5)[left], painter.frame(1.8)[left])


@pytest.mark.parametrize("half", [LEFT, RIGHT])
def test_what_marks_a_run_that_is_over_covers_no_words_of_its_header(
    free: Record, half: tuple[slice, slice]
) -> None:
    name = "a name of a world that is about as long as names of worlds may be"
    short = parse_world(SMALL).changed(name=name, time={"step": 0.02, "duration": 1.4})
    pair = [Timeline(physim.simulate(short)), Timeline(free)]
    painter = Beside(*(pair if half == LEFT else pair[::-1]), 1.0, 25.0)
    before, after = (painter.frame(time)[half].astype(int) for time in (1.3, 1.5))
    changed = np.flatnonzero((before != after).any(axis=(0, 2)))
    written = np.flatnonzero((before[34:57] < 200).any(axis=(0, 2)))
    assert written[written < layout.WIDTH // 3].max() < changed.min()


@pytest.fixture(scope="module")
def large() -> Record:
    """The small world on a road twice as long and wide."""
    world = parse_world(SMALL)
    wide = world.changed(corridor={"centreline": [[0.0, 0.0], [40.0, 0.0]], "width": 16.0})
    return physim.simulate(wide)


def test_both_views_have_one_scale_where_robots_stay_large_enough(
    free: Record, large: Record
) -> None:
    painter = Beside(Timeline(free), Timeline(large), 1.0, 25.0)
    alone = [Beside(Timeline(one), Timeline(one), 1.0, 25.0) for one in (free, large)]
    scales = [one._views[0].camera.scale for one in alone]
    assert scales[0] != scales[1]
    assert {view.camera.scale for view in painter._views} == {min(scales)}


def test_views_keep_their_scales_where_a_robot_would_be_too_small() -> None:
    small, large = (physim.simulate(parse_world(text)) for text in (TINY, SMALL))
    painter = Beside(Timeline(small), Timeline(large), 1.0, 25.0)
    scales = [view.camera.scale for view in painter._views]
    assert scales[0] > 5.0 * scales[1]


def bar(image: Image, left: int) -> int:
    """[px] length of the scale bar of a view that begins at ``left``."""
    row = (image[layout.HEIGHT - FOOTER - BARS // 2, left + PAD :] == palette.INK).all(axis=1)
    return int(np.argmin(row))  # the first pixel that is none of it


def test_a_bar_tells_the_scale_of_its_view(free: Record) -> None:
    small = physim.simulate(parse_world(TINY))
    painter = Beside(Timeline(small), Timeline(free), 1.0, 25.0)
    image = painter.frame(0.5)
    for view in painter._views:
        scale, drawn = view.camera.scale, bar(image, view.box.left)
        power = 10.0 ** np.floor(np.log10(drawn / scale))
        expected = np.array([1.0, 2.0, 5.0, 10.0]) * power * scale
        assert np.abs(expected - drawn).min() <= 3.0  # two ends of lines of 2 px
