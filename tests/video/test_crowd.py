"""Many robots at once: shown together, in words that say so; drawn where the picture changes."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import av
import numpy as np
import pytest

from physim import PAPER_MODES
from physim.drawing import palette
from physim.drawing.video import layout, panel, view
from tests.helpers import inside
from tests.helpers.records import make_record
from tests.video.test_frames import BELOW, pixels

MOST_LINES, NAMED, QUANTILES = inside("physim.drawing", "MOST_LINES", "NAMED", "QUANTILES")
quantiles, rgb, Timeline = inside("physim.drawing", "quantiles", "rgb", "Timeline")
Painter, PATH_TINT, ground = inside("physim.drawing.video", "Painter", "PATH_TINT", "ground")
signs, VideoFile = inside("physim.drawing.video", "signs", "VideoFile")

DANGER = next(k for k, mode in enumerate(PAPER_MODES) if mode.danger)


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory, changed: Callable[..., Any]) -> Any:
    """Robots in a field, 64 of them, 3 m apart; errors grow by 1 mm from each to the next."""
    made = make_record(tmp_path_factory.mktemp("crowd") / "r.h5", NAMED + 4, 0.6, dt=0.1)
    pose = made.pose.copy()
    robots = np.arange(pose.shape[1])
    pose[:, :, 0], pose[:, :, 1] = 3.0 * (robots % 8) + 4.0, 3.0 * (robots // 8) - 10.0
    pose[:, :, 0] += 0.1 * np.arange(len(pose))[:, None]
    pose[..., 2] = 0.0
    pose[:, 9, 0] += 1.0  # closest to 10
    course = made.course.copy()
    course[:, :, 2] = made.lead - robots / 1000.0
    return changed(made, pose=pose, course=course, contacts=made.contacts[:0])


def test_quantiles_are_those_of_the_known_values() -> None:
    random = np.random.default_rng(3)
    values = random.normal(size=(40, 17))
    values[random.random(values.shape) < 0.3] = np.nan
    values[3], values[4, :16] = np.nan, np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a moment without any value
        expected = np.nanquantile(values, QUANTILES, axis=1)
    assert np.allclose(quantiles(values), expected, rtol=0.0, atol=1e-12, equal_nan=True)
    values[5] = [-np.inf, np.inf, *range(15)]
    assert quantiles(values)[:, 5] == pytest.approx(np.quantile(range(15), QUANTILES))


def test_a_crowd_has_paths_and_trails_of_one_colour(crowd: Any, made: Callable[..., Any]) -> None:
    alike = palette.mix(palette.BAND, palette.WHITE, PATH_TINT)
    known = {palette.WALL, palette.REFERENCE}
    assert {stroke.colour for stroke in ground(Timeline(crowd)).strokes} - known == {alike}
    few = {stroke.colour for stroke in ground(Timeline(made(3))).strokes} - known
    assert few == {palette.mix(palette.robot_colour(i), palette.WHITE, PATH_TINT) for i in range(3)}
    words = signs(Timeline(crowd), ground(Timeline(crowd)))
    assert "target" not in words
    assert any(word.startswith("trails, last 2 s") for word in words)
    assert any(word.startswith("paths") for word in words)


def test_of_a_crowd_only_the_closest_pair_and_robots_that_touch_have_names(
    crowd: Any, changed: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    sprite = view.sprite

    def noted(text: str, *more: Any) -> Any:
        written.append(text)
        return sprite(text, *more)

    monkeypatch.setattr(view, "sprite", noted)
    Painter(Timeline(crowd), 1.0, 25.0).paint(0.3)
    assert set(written) == {"0.20 m", "r10", "r11"}
    written.clear()
    rows = make_record(robots=2, seconds=0.6, dt=0.1).contacts[:1].copy()
    rows["step"], rows["a"], rows["b"] = 3, 20, 21
    Painter(Timeline(changed(crowd, contacts=rows)), 1.0, 25.0).paint(0.3)
    assert {"r21", "r22"} < set(written)
    assert len(written) == 5


def test_the_strip_of_a_crowd_shows_its_quantiles_and_names_the_outermost(
    crowd: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from physim.drawing.video import strip

    written: list[str] = []
    write = strip.write

    def noted(image: Any, text: str, *more: Any, **named: Any) -> Any:
        written.append(text)
        return write(image, text, *more, **named)

    monkeypatch.setattr(strip, "write", noted)
    assert len(crowd.names) > MOST_LINES
    painter = Painter(Timeline(crowd), 1.0, 25.0)
    assert f"formation error [m] of {len(crowd.names)} robots" in written
    assert {"median", "middle 50 %", "middle 90 %", "least, greatest"} <= set(written)
    written.clear()
    picture = painter.paint(0.5)
    assert written == [f"r{len(crowd.names)}", "r1"]
    below = picture[BELOW]
    for index in range(10):
        assert pixels(picture, palette.robot_colour(index), BELOW) == 0
    heights = []
    for colour in (palette.BAND, palette.mix(palette.WHITE, palette.BAND, strip.INNER),
                   palette.mix(palette.WHITE, palette.BAND, strip.OUTER)):  # fmt: skip
        found = np.nonzero((below[40:, 60:400] == np.array(colour, np.uint8)).all(axis=2))[0]
        assert len(found) > 100
        heights.append(int(np.ptp(found)))
    assert heights[0] < heights[1] < heights[2]
    share = heights[2] / heights[1]
    assert share == pytest.approx(0.9 / 0.5, rel=0.1)


def test_the_overview_shows_robots_in_danger_over_all_others(
    crowd: Any, changed: Callable[..., Any]
) -> None:
    """Robots that stand at one place there: the one in danger is seen, be it first or last."""
    far = crowd.walls._replace(vertices=crowd.walls.vertices * [5.0, 1.0])
    colour, safe = rgb(PAPER_MODES[DANGER].colour), rgb(PAPER_MODES[0].colour)
    for robot in (0, NAMED + 3):
        updates, pose = crowd.updates.copy(), crowd.pose.copy()
        pose[..., :2] = [10.0, 0.0]
        updates["mode"] = np.where(updates["robot"] == robot, DANGER, 0)
        record = changed(crowd, updates=updates, pose=pose, walls=far)
        painter = Painter(Timeline(record), 1.0, 25.0)
        assert painter._overview is not None
        painter.paint(0.3)
        assert pixels(painter._overview_image, colour, ...) == 4
        assert pixels(painter._overview_image, safe, ...) == 0


def test_panel_and_strip_are_the_same_however_one_came_to_a_moment(
    made: Callable[..., Any], crowd: Any
) -> None:
    """Only what changes is drawn, so nothing may be left over of what was shown before."""
    wide = layout.WIDTH - layout.PANEL_WIDTH
    for record, times in (
        (made(3), (3.9, 0.0, 1.2, 2.4, 2.5, 1.21, 4.0)),
        (crowd, (0.5, 0.1, 0.4)),
    ):
        painter = Painter(Timeline(record), 1.0, 25.0)
        for time in times:
            picture, fresh = painter.paint(time), Painter(Timeline(record), 1.0, 25.0).paint(time)
            assert np.array_equal(picture[:, wide:], fresh[:, wide:])
            assert np.array_equal(picture[BELOW], fresh[BELOW])


def test_a_frame_is_kept_while_the_painter_goes_on(made: Callable[..., Any]) -> None:
    painter = Painter(Timeline(made(3)), 1.0, 25.0)
    kept = painter.frame(1.0)
    before = kept.copy()
    assert painter.paint(2.0) is painter.paint(3.0)
    assert np.array_equal(kept, before)


def test_frames_may_be_drawn_over_and_held(tmp_path: Any) -> None:
    """The file has the pictures as they were when written, held ones again."""
    path, image = tmp_path / "v.mp4", np.zeros((layout.HEIGHT, layout.WIDTH, 3), np.uint8)
    shades = [20 * k + 30 for k in range(10)]
    with VideoFile(path, 25.0) as video:
        for shade in shades:
            image[:] = shade
            video.write(image)
            video.hold()
    with av.open(str(path)) as file:
        shown = [frame.to_ndarray(format="gray").mean() for frame in file.decode(video=0)]
    assert len(shown) == 20
    assert np.diff(shown[::2]).min() > 10.0
    assert np.abs(np.array(shown[::2]) - shown[1::2]).max() < 1.0


def test_decisions_of_all_robots_are_found_as_those_of_each() -> None:
    record = make_record(robots=5, seconds=2.0, dt=0.01)
    timeline, rows = Timeline(record), record.updates
    times = np.concatenate((np.arange(0.0, 2.1, 0.037), record.time[::7], [-1.0]))
    found = timeline.decisions(times)
    for time, at in zip(times, found, strict=True):
        for robot in range(5):
            mine = np.flatnonzero((rows["robot"] == robot) & (rows["step"] * 0.01 < time + 1e-9))
            assert at[robot] == (mine[-1] if len(mine) else -1)


def test_panels_count_a_crowd_by_mode(crowd: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    words: list[str] = []
    write = panel.write

    def noted(image: Any, text: str, *more: Any, **named: Any) -> Any:
        words.append(text)
        return write(image, text, *more, **named)

    monkeypatch.setattr(panel, "write", noted)
    painter, now = Painter(Timeline(crowd), 1.0, 25.0), Timeline(crowd).at(0.2)
    words.clear()
    painter.paint(0.2)
    counts = [str(int((now.modes == mode).sum())) for mode in painter.timeline.explained_modes]
    assert sum(map(int, counts)) == len(crowd.names)
    assert [word for word in words if word.isdigit()][-len(counts) :] == counts
