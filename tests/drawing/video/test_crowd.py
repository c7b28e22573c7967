"""Many robots at once: shown together, in words that say so; drawn where the picture changes."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from physim.drawing.video import frame_at
from tests.drawing import palette
from tests.drawing.video.looking import PANEL_WIDTH, STRIP, WIDTH, pixels
from tests.helpers import inside
from tests.helpers.records import make_record

MOST_LINES, NAMED, QUANTILES = inside("physim.drawing", "MOST_LINES", "NAMED", "QUANTILES")
items = inside("physim.drawing", "items")
Timeline, quantiles = inside("physim.drawing", "Timeline", "quantiles")
Painter, ground, signs = inside("physim.drawing.video", "Painter", "ground", "signs")


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
    clearance = np.full(made.clearance.shape, 1.2)
    clearance[:, 9:11] = 0.2
    course = made.course.copy()
    course[:, :, 2] = made.lead - robots / 1000.0
    return changed(made, pose=pose, clearance=clearance, course=course, contacts=made.contacts[:0])


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
    def colours(record: Any) -> set[palette.Colour]:
        drawn = items(Timeline(record).scene)
        return {item.colour for item in drawn if item.what == "path"}

    assert colours(crowd) == {palette.mix(palette.BAND, palette.WHITE, palette.PATH_TINT)}
    few = [palette.mix(palette.robot_colour(i), palette.WHITE, palette.PATH_TINT) for i in range(3)]
    assert colours(made(3)) == set(few)
    words = signs(Timeline(crowd), ground(Timeline(crowd)))
    assert "target" not in words
    assert any(word.startswith("trails, last 2 s") for word in words)


def test_of_a_crowd_only_the_closest_pair_and_robots_that_touch_have_names(
    crowd: Any, changed: Callable[..., Any], written: list[str]
) -> None:
    def named() -> set[str]:
        return {f"r{k + 1}" for k in range(len(crowd.names))} & set(written)

    frame_at(crowd, 0.3, speed=1.0)
    assert named() - {f"r{len(crowd.names)}", "r1"} == {"r10", "r11"}  # those are of the strip
    assert "0.200 m" in written
    rows = make_record(robots=2, seconds=0.6, dt=0.1).contacts[:1].copy()
    rows["step"], rows["a"], rows["b"] = 3, 20, 21
    frame_at(changed(crowd, contacts=rows), 0.3, speed=1.0)
    assert {"r21", "r22"} < named()
    assert len(named()) == 6


def test_the_strip_and_the_panel_tell_of_all_robots_together(
    crowd: Any, written: list[str]
) -> None:
    """Quantiles, names of the outermost, and how many are in each mode."""
    assert len(crowd.names) > MOST_LINES
    picture, now = frame_at(crowd, 0.5, speed=1.0), Timeline(crowd).at(0.5)
    assert {"least distance [m]", "formation error [m]", "median"} <= set(written)
    assert {f"r{len(crowd.names)}", "r1"} <= set(written)
    for index in range(10):
        assert pixels(picture, palette.robot_colour(index), STRIP) == 0
    counts = [str(int((now.modes == mode).sum())) for mode in Timeline(crowd).explained_modes]
    assert sum(map(int, counts)) == len(crowd.names)
    numbers = [word for word in written if word.isdigit()]
    assert any(numbers[k:][: len(counts)] == counts for k in range(len(numbers)))


def test_a_frame_is_the_same_however_one_came_to_its_moment(
    made: Callable[..., Any], crowd: Any
) -> None:
    """Only what changes is drawn, so nothing may be left over of what was shown before."""
    beside = slice(WIDTH - PANEL_WIDTH, None)
    for record, times in ((made(3), (3.9, 0.0, 2.4, 2.5, 1.21, 4.0)), (crowd, (0.5, 0.1))):
        painter, kept = Painter(Timeline(record), 1.0, 25.0), []
        for time in times:
            fresh = frame_at(record, time, speed=1.0)
            kept.append((painter.paint(time)[..., :3].copy(), fresh))
        for picture, fresh in kept:
            assert np.array_equal(picture[:, beside], fresh[:, beside])
            assert np.array_equal(picture[STRIP][4:], fresh[STRIP][4:])
