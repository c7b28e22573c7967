"""Frames show what the record says: who touches whom, where and when, and in which mode."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from physim import PAPER_MODES, Mode
from physim.analysis import metrics
from physim.contacts import Phase
from physim.drawing.video import close_up, frame_at
from physim.errors import PhysimError
from physim.tolerances import DEEP as DEPTH
from tests.drawing import palette
from tests.drawing.video.looking import STRIP, around, pixels
from tests.helpers import inside

Timeline, rgb = inside("physim.drawing", "Timeline", "rgb")
DEEP, NO_MODES, closest = inside("physim.drawing.video", "DEEP", "NO_MODES", "closest")
ground, signs = inside("physim.drawing.video", "ground", "signs")
NO_NUMBER = inside("physim.parts", "NO_NUMBER")
Part = inside("physim.record", "Part")

Made = Changed = Callable[..., Any]


def test_time_moves_the_picture(made: Made) -> None:
    assert frame_at(made(1), 0.0).shape == (720, 1280, 3)
    assert not np.array_equal(frame_at(made(1), 0.0), frame_at(made(1), 2.0))
    assert np.array_equal(frame_at(made(1), 99.0), frame_at(made(1), 4.0))
    with pytest.raises(PhysimError, match="finite"):
        frame_at(made(1), float("nan"))


def test_a_contact_shows_when_it_begins_and_half_a_second_of_video_after(made: Made) -> None:
    record = made(3)  # robots 0 and 1 touch from 1.2 s on
    began = float(record.contacts["step"][0]) * record.dt
    assert began == pytest.approx(1.2)
    counts = [pixels(frame_at(record, began + t), palette.CONTACT) for t in (-0.06, 0.0, 0.8, 1.1)]
    assert counts[0] == 0
    assert counts[1] > 150, "flash, mark and outlines"
    assert counts[2] > 30, "the mark stays for a second"
    assert counts[3] == 0
    assert pixels(frame_at(record, began + 1.1, speed=4.0), palette.CONTACT) > 30


def test_a_contact_that_lasts_has_a_mark_at_its_place_all_the_time(
    made: Made, changed: Changed
) -> None:
    steps = np.arange(20, 151)  # 0.4 to 3.0 s
    contacts = np.zeros(len(steps), made(3).contacts.dtype)
    contacts["step"], contacts["b"], contacts["phase"] = steps, 1, Phase.STAYS
    contacts["phase"][0], contacts["phase"][-1] = Phase.BEGAN, Phase.ENDED
    contacts["x"], contacts["y"] = np.linspace(4.0, 12.0, len(steps)), 2.5
    record = changed(made(3), contacts=contacts)
    for time, marked in ((0.3, False), (0.4, True), (1.6, True), (2.9, True), (3.1, False)):
        place = np.array([np.interp(time, [0.4, 3.0], [4.0, 12.0]), 2.5])
        image = frame_at(record, time, speed=1.0)
        found = pixels(image, palette.CONTACT, around(record, time, place, 8))
        assert (found > 40) == marked, f"at {time} s: {found} px"


def test_the_time_axis_keeps_when_contacts_began(made: Made) -> None:
    times = (1.1, 1.2, 2.3, 2.4, 4.0)
    shown = [pixels(frame_at(made(3), t, speed=1.0), palette.CONTACT, STRIP) for t in times]
    one = shown[1]
    assert shown == [0, one, one, 2 * one, 2 * one]
    assert one > 10


def test_the_closest_pair_is_joined_by_a_line(made: Made) -> None:
    timeline = Timeline(made(3))
    pair = closest(timeline, timeline.at(2.0))
    assert pair is not None
    near = around(made(3), 2.0, pair.points.mean(axis=0), 1)
    assert frame_at(made(3), 2.0, speed=1.0)[near].min() < 60


def test_robots_have_the_colour_of_their_mode(made: Made, changed: Changed) -> None:
    record = made(1)
    five = tuple(Mode(f"m{k}", f"#{k}0{8 - k}0f0", f"mode {k}") for k in range(5))
    for modes, mode in ((PAPER_MODES, 0), (PAPER_MODES, 1), (PAPER_MODES, 3), (five, 4)):
        updates = record.updates.copy()
        updates["mode"], colour = mode, rgb(modes[mode].colour)
        picture = frame_at(changed(record, updates=updates, modes=modes), 2.0)
        assert pixels(picture, colour) > 300
        others = [rgb(one.colour) for one in modes if rgb(one.colour) != colour]
        assert not any(pixels(picture, c) for c in others)


def test_robots_that_give_no_modes_have_their_own_colours(made: Made, changed: Changed) -> None:
    for robots in (3, 61):
        updates = made(robots).updates.copy()
        updates["mode"] = NO_NUMBER
        timeline = Timeline(changed(made(robots), updates=updates))
        expected = timeline.scene.colours if robots == 3 else [palette.BAND] * robots
        assert timeline.at(2.0).colours.tolist() == [list(colour) for colour in expected]
        assert NO_MODES in signs(timeline, ground(timeline))
    assert NO_MODES not in signs(Timeline(made(3)), ground(Timeline(made(3))))


def test_the_strip_rises_with_the_error(made: Made, changed: Changed) -> None:
    """Up is positive: the curve of a robot with an error of 1 m lies above that with -1 m."""
    course = made(3).course.copy()
    course[:, :, 2] = 20.0 + made(3).lead + [-1.0, 0.0, 1.0]
    picture = frame_at(changed(made(3), course=course), 3.9)[STRIP][4:]
    rows = [
        np.median(np.nonzero((picture == np.array(palette.robot_colour(i))).all(axis=2))[0])
        for i in range(3)
    ]
    assert rows[0] < rows[1] - 10 < rows[2] - 20


def test_a_close_up_names_the_two_that_it_is_of(made: Made, written: list[str]) -> None:
    """A robot and a wall, in a picture so small that a tile shows it as it is."""
    record = made(3)
    picture = close_up(record, 1.0, (2, 3))
    assert picture.shape[1] <= 600
    assert record.names[2] in written
    assert any(word.endswith(" m") or word == "contact" for word in written)


def test_the_strip_shows_formation_errors_or_deviations(made: Made, changed: Changed) -> None:
    record = made(3)
    formation = Timeline(record).curves
    assert formation.title == "formation error [m]"
    errors = metrics.formation_errors(record, every=record.dt)
    assert errors is not None
    assert np.allclose(formation.values, errors.values, rtol=0.0, atol=1e-9)
    for text in ("name: x", "name: x\nformation: null"):
        without = Timeline(changed(record, world_text=text)).curves
        assert "deviation" in without.title
        assert np.array_equal(without.values, record.course[:, :, 1])
    bare = changed(record, updates=record.updates[:0])
    assert np.array_equal(Timeline(bare).curves.values, formation.values), "nobody has to decide"
    assert "deviation" in Timeline(made(1)).curves.title


def test_the_strip_shows_the_least_distances_down_to_zero(
    made: Made, changed: Changed, written: list[str]
) -> None:
    """Of robots and of walls over the run; a single touch between two columns is seen."""
    record = made(3)
    gap, walls = np.full(record.clearance.shape, 0.3), np.full(record.clearance.shape, 0.4)
    apart = frame_at(changed(record, clearance=gap, boundary_clearance=walls), 3.9)[STRIP]
    assert {"least distance [m]", "robots", "walls", "0.0"} <= set(written)
    gap[97, 1] = 0.0
    touched = frame_at(changed(record, clearance=gap, boundary_clearance=walls), 3.9)[STRIP]
    rows = [np.nonzero((one == np.array(palette.INK)).all(axis=2))[0] for one in (apart, touched)]
    assert len(rows[1]) > len(rows[0]) + 50, "the line goes down to zero and back"
    assert Timeline(record).distances.values[:, 0].tolist() == record.clearance.min(axis=1).tolist()


def test_an_overlap_is_told_as_one_in_the_panel(
    made: Made, changed: Changed, written: list[str]
) -> None:
    """With the depth that the record has; while they are apart, with their distance."""
    record = made(3)
    pose, gap = record.pose.copy(), record.clearance.copy()
    gap[100:, :2] = -0.025
    pose[100:, 1] = pose[100:, 0] + [0.3, 0.0, 0.0]  # from 2 s on robot 1 is within robot 0
    for time, overlap in ((1.0, False), (2.5, True)):
        written.clear()
        frame_at(changed(record, pose=pose, clearance=gap), time)
        assert ("−0.025 m" in written) == overlap
        assert "0.000 m" not in written


def test_the_panel_tells_settings_and_contacts_of_now_and_so_far(
    made: Made, changed: Changed, written: list[str]
) -> None:
    own = Part("mine:Own", {"look_ahead": 2.5})
    setup = dataclasses.replace(made(3).setup, controllers=((own, (0, 1, 2)),))
    record = changed(made(3), setup=setup)
    for time, touching in ((1.1, "none"), (1.22, "r1 – r2")):
        written.clear()
        frame_at(record, time, speed=1.0)
        assert "look_ahead 2.5" in written
        values = dict(pairwise(written))
        assert values["contacts so far"] == str(int(touching != "none"))
        assert values["touching now"] == touching
    parts = (Part("mode_switching", {}), (0, 2)), (Part("path_following", {}), (1,))
    mixed = dataclasses.replace(setup, controllers=parts)
    written.clear()
    frame_at(changed(made(3), setup=mixed), 1.1, speed=1.0)
    heads = "A mode_switching: r1, r3", "B path_following: r2"
    first, second = map(written.index, heads)
    assert "safe" in written[first:second]  # that of A
    assert "safe" in written[second:]
    assert {"r1·A", "r2·B", "r3·A", "safe area of A"} <= set(written)


@pytest.mark.parametrize("share", [0.9, 10.0])
def test_contacts_too_deep_are_told_from_when_they_are(
    made: Made, changed: Changed, written: list[str], share: float
) -> None:
    contacts, dt = made(3).contacts.copy(), made(3).dt
    mine = (contacts["a"] == contacts["a"][0]) & (contacts["b"] == contacts["b"][0])
    contacts["depth"][np.flatnonzero(mine & (contacts["phase"] != Phase.ENDED))[1:]] = share * DEPTH
    record = changed(made(3), contacts=contacts)
    timeline, is_deep = Timeline(record), share > 1.0
    began = float(timeline.contacts.began[0])
    assert np.isclose(timeline.contacts.deep[0], began + dt if is_deep else np.inf)
    assert timeline.contacts.deep_count(began) == 0
    assert timeline.contacts.deep_count(began + dt) == is_deep
    assert (DEEP in signs(timeline, ground(timeline))) == is_deep
    frame_at(record, began + dt, speed=1.0)
    assert ("of them not physical" in written) == is_deep


NAMES = ("r", "日本語 — é ß 🤖", "a/\"b'\n\t\x00%s", "x" * 200, "", "\ud800")


def odd_records(record: Any, changed: Changed) -> list[Any]:
    """Names of all kinds; without decisions, areas, samples; with numbers that are not finite."""
    found = []
    for name in NAMES:
        bodies = tuple(dataclasses.replace(body, name=name) for body in record.bodies)
        found.append(changed(record, names=(name, "r2", name), bodies=bodies, name=name))
    fields = ("time", "steps", "pose", "clearance", "boundary_clearance")
    found += [
        changed(record, updates=record.updates[:0], contacts=record.contacts[:0]),
        changed(record, accessible=[], safe=[]),
        changed(record, **{field: getattr(record, field)[:1] for field in fields}),
    ]
    updates, contacts = record.updates.copy(), record.contacts.copy()
    updates["target_x"][::3] = np.nan
    updates["target_x"][1::7] = np.inf
    contacts["x"] = np.nan
    far = {name: np.full_like(getattr(record, name), np.inf) for name in fields[3:]}
    return [*found, changed(record, updates=updates, contacts=contacts, **far)]


def test_odd_records_are_drawn(made: Made, changed: Changed) -> None:
    for odd in odd_records(made(3), changed):
        assert frame_at(odd, 1.3).shape == (720, 1280, 3)


def test_without_safe_areas_nothing_is_drawn_as_danger(made: Made, changed: Changed) -> None:
    picture = frame_at(changed(made(1), safe_distance=0.0), 2.0)
    for colour in (palette.DANGER_AREA, palette.SAFE_AREA):
        assert pixels(picture, colour, ...) < 10, "single pixels of trails may be alike"
    assert pixels(picture, palette.FLOOR, ...) > 100_000
