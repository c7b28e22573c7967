from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from physim import PAPER_MODES, Mode
from physim.analysis import metrics
from physim.contacts import Phase
from physim.drawing import palette
from physim.drawing.video import frame_at, layout, panel
from physim.errors import PhysimError
from tests.helpers import inside
from tests.helpers.records import make_record

rgb, Timeline = inside("physim.drawing", "rgb", "Timeline")
Closest, Painter = inside("physim.drawing.video", "Closest", "Painter")
SAFE = inside("physim.parts", "SAFE")
Part = inside("physim.record", "Part")

VIEW = (slice(0, layout.HEIGHT - layout.STRIP_HEIGHT), slice(0, layout.WIDTH - layout.PANEL_WIDTH))


def pixels(image: Any, colour: palette.Colour, part: Any = VIEW) -> int:
    return int((image[part] == np.array(colour, np.uint8)).all(axis=2).sum())


def words_of_the_panel(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """All that the panel writes from now on."""
    words: list[str] = []
    write = panel.write

    def noted(image: Any, text: str, *more: Any, **named: Any) -> Any:
        words.append(text)
        return write(image, text, *more, **named)

    monkeypatch.setattr(panel, "write", noted)
    return words


def test_same_record_same_frames(made: Callable[..., Any], tmp_path: Any) -> None:
    again = make_record(tmp_path / "again.h5", 3, 4.0, dt=0.02)
    first, second = Painter(Timeline(made(3)), 1.0, 25.0), Painter(Timeline(again), 1.0, 25.0)
    for time in np.arange(0.0, 4.0, 0.2):
        assert np.array_equal(first.frame(time), second.frame(time))
    again.close()


def test_a_still_is_the_frame_of_its_time(made: Callable[..., Any]) -> None:
    still, frame = frame_at(made(3), 0.0), Painter(Timeline(made(3)), 1.0, 25.0).frame(0.0)
    assert still.shape == (720, 1280, 3)
    assert still.dtype == np.uint8
    assert np.array_equal(still, frame)


def test_time_moves_the_picture(made: Callable[..., Any]) -> None:
    assert not np.array_equal(frame_at(made(1), 0.0), frame_at(made(1), 2.0))
    assert np.array_equal(frame_at(made(1), 99.0), frame_at(made(1), 4.0))
    with pytest.raises(PhysimError, match="finite"):
        frame_at(made(1), float("nan"))


def test_a_contact_shows_when_it_begins_and_not_long_after(made: Callable[..., Any]) -> None:
    record = made(3)  # robots 0 and 1 touch from 1.2 s on
    began = float(record.contacts["step"][0]) * record.dt
    assert began == pytest.approx(1.2)
    counts = [pixels(frame_at(record, began + t), palette.CONTACT) for t in (-0.06, 0.0, 0.8, 1.1)]
    assert counts[0] == 0
    assert counts[1] > 150, "flash, mark and outlines"
    assert counts[2] > 30, "the mark stays for a second"
    assert counts[3] == 0


def test_a_pair_that_rattles_has_one_mark_and_flashes_once(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    began, stays, ended = Phase.BEGAN, Phase.STAYS, Phase.ENDED
    held = [(step, stays) for step in range(21, 60)]
    shaken = [(20 + k, (began, stays, ended)[k % 3]) for k in range(39)]

    def frame(rows: list[tuple[int, Phase]], time: float) -> Any:
        contacts = np.zeros(len(rows), record.contacts.dtype)
        contacts["step"], contacts["phase"] = np.array(rows).T
        contacts["b"], contacts["x"], contacts["y"] = 1, 8.0, 2.5
        return frame_at(changed(record, contacts=contacts), time, speed=1.0)[VIEW]

    whole = frame([(20, began), *held, (60, ended)], 0.96)
    parts = frame(shaken, 0.96)
    assert pixels(whole, palette.CONTACT) > 150
    assert np.array_equal(whole, parts)


def test_a_contact_that_lasts_has_a_mark_at_its_place_all_the_time(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    steps = np.arange(20, 151)  # 0.4 to 3.0 s
    contacts = np.zeros(len(steps), record.contacts.dtype)
    contacts["step"], contacts["b"], contacts["phase"] = steps, 1, Phase.STAYS
    contacts["phase"][0], contacts["phase"][-1] = Phase.BEGAN, Phase.ENDED
    contacts["x"], contacts["y"] = np.linspace(4.0, 12.0, len(steps)), 2.5
    painter = Painter(Timeline(changed(record, contacts=contacts)), 1.0, 25.0)
    for time, marked in ((0.3, False), (0.4, True), (1.6, True), (2.9, True), (3.1, False)):
        x = np.interp(time, [0.4, 3.0], [4.0, 12.0])
        at = painter._view.camera.lens(time).pixels(np.array([x, 2.5]))
        column, row = np.rint(at).astype(int).tolist()
        around = (slice(row - 8, row + 9), slice(column - 8, column + 9))
        found = pixels(painter.frame(time), palette.CONTACT, around)
        assert (found > 40) == marked, f"at {time} s: {found} px"


def test_the_time_axis_keeps_when_contacts_began(made: Callable[..., Any]) -> None:
    painter = Painter(Timeline(made(3)), 1.0, 25.0)
    below = (slice(layout.HEIGHT - layout.STRIP_HEIGHT, None), VIEW[1])
    shown = [pixels(painter.frame(t), palette.CONTACT, below) for t in (1.1, 1.2, 2.3, 2.4, 4.0)]
    one = shown[1]
    assert shown == [0, one, one, 2 * one, 2 * one]
    assert one > 10


def test_a_mark_lasts_half_a_second_of_video(made: Callable[..., Any]) -> None:
    assert pixels(frame_at(made(3), 1.2 + 1.1, speed=4.0), palette.CONTACT) > 30
    assert pixels(frame_at(made(3), 1.2 + 1.1, speed=1.0), palette.CONTACT) == 0


def test_the_closest_pair_is_joined_by_a_line(made: Callable[..., Any]) -> None:
    painter = Painter(Timeline(made(3)), 1.0, 25.0)
    picture, pose = painter.frame(2.0), painter.timeline.pose(2.0)
    scene = painter.timeline.scene
    pair = Closest(scene.footprints, scene.reach).pair(pose)
    assert pair is not None
    x, y = np.rint(painter._view.camera.lens(2.0).pixels(pair.points.mean(axis=0))).astype(int)
    assert picture[y - 1 : y + 2, x - 1 : x + 2].min() < 60


def test_robots_have_the_colour_of_their_mode(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(1)
    five = tuple(Mode(f"m{k}", f"#{k}0{8 - k}0f0", f"mode {k}") for k in range(5))
    for modes, mode in itertools.chain(
        ((PAPER_MODES, k) for k in range(4)), ((five, k) for k in range(5))
    ):
        updates = record.updates.copy()
        updates["mode"], colour = mode, rgb(modes[mode].colour)
        picture = frame_at(changed(record, updates=updates, modes=modes), 2.0)
        assert pixels(picture, colour) > 300
        others = [rgb(one.colour) for one in modes if rgb(one.colour) != colour]
        assert not any(pixels(picture, c) for c in others)


BELOW = (slice(layout.HEIGHT - layout.STRIP_HEIGHT + 4, None), VIEW[1])


def test_one_robot_has_a_strip_of_its_deviation(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    assert "deviation" in Timeline(made(1)).curves.title
    course = made(1).course.copy()
    course[:, 0, 1] = 0.1 * np.cos(np.linspace(0.0, 9.0, len(course)))
    picture = frame_at(changed(made(1), course=course), 3.9)
    assert pixels(picture, palette.WHITE, BELOW) > 100000
    assert pixels(picture, palette.robot_colour(0), BELOW) > 500
    turned = frame_at(changed(made(1), course=course * (1.0, -1.0, 1.0)), 3.9)
    assert not np.array_equal(picture[BELOW], turned[BELOW]), "the sign is shown"


def test_the_strip_rises_with_the_error(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    """Up is positive: the curve of a robot with an error of 1 m lies above that with -1 m."""
    course = made(3).course.copy()
    course[:, :, 2] = 20.0 + made(3).lead + [-1.0, 0.0, 1.0]
    picture = frame_at(changed(made(3), course=course), 3.9)[BELOW]
    rows = [
        np.median(np.nonzero((picture == np.array(palette.robot_colour(i))).all(axis=2))[0])
        for i in range(3)
    ]
    assert rows[0] < rows[1] - 10 < rows[2] - 20


def test_an_overlap_is_told_as_one_in_the_panel(
    made: Callable[..., Any], changed: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the depth that the record has; while they are apart, with their distance."""
    record = made(3)
    pose, gap = record.pose.copy(), np.full(record.clearance.shape, -0.025)
    pose[100:, 1] = pose[100:, 0] + [0.3, 0.0, 0.0]  # from 2 s on robot 1 is within robot 0
    words = words_of_the_panel(monkeypatch)
    for time, overlap in ((1.0, False), (2.5, True)):
        words.clear()
        frame_at(changed(record, pose=pose, clearance=gap), time)
        assert ("−0.025 m" in words) == overlap
        assert "0.000 m" not in words


def test_the_settings_of_the_controller_are_told(
    made: Callable[..., Any], changed: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    told = words_of_the_panel(monkeypatch)
    record = made(2)
    frame_at(record, 1.0)
    assert not any("look_ahead" in text for text in told)
    setup = dataclasses.replace(record.setup, controller=Part("mine:Own", {"look_ahead": 2.5}))
    frame_at(changed(record, setup=setup), 1.0)
    assert "look_ahead 2.5" in told


def test_what_the_strip_shows(made: Callable[..., Any], changed: Callable[..., Any]) -> None:
    record = made(3)
    formation = Timeline(record).curves
    assert formation.title == "formation error [m]"
    errors = metrics.formation_errors(record, every=record.dt)
    assert errors is not None
    assert np.allclose(formation.values, errors.values, rtol=0.0, atol=1e-9)
    for text in ("name: x", "name: x\nformation: null"):
        without = Timeline(changed(record, world_text=text)).curves
        assert without.title == "deviation from the path, left positive [m]"
        assert np.array_equal(without.values, record.course[:, :, 1])
    bare = changed(record, updates=record.updates[:0])
    assert np.array_equal(Timeline(bare).curves.values, formation.values), "nobody has to decide"


def test_names_come_when_the_curves_have_begun(made: Callable[..., Any]) -> None:
    beside = (BELOW[0], slice(100, VIEW[1].stop))  # right of the cursor
    painter = Painter(Timeline(made(3)), 1.0, 25.0)
    ink = [pixels(painter.frame(t), palette.robot_colour(2), beside) for t in (0.0, 0.08, 0.16)]
    assert ink[:2] == [0, 0]
    assert ink[2] > 10


def test_a_record_without_decisions_or_areas(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    bare = changed(record, updates=record.updates[:0], contacts=record.contacts[:0])
    assert pixels(frame_at(bare, 2.0), palette.UNDECIDED) > 300
    open_field = changed(record, accessible=[], safe=[])
    assert frame_at(open_field, 2.0).shape == (720, 1280, 3)


def test_a_record_of_one_sample(made: Callable[..., Any], changed: Callable[..., Any]) -> None:
    record = made(3)
    fields = ("time", "steps", "pose", "clearance", "boundary_clearance")
    single = changed(record, **{field: getattr(record, field)[:1] for field in fields})
    assert frame_at(single, 0.0).shape == (720, 1280, 3)


@pytest.mark.parametrize(
    "name", ["r", "日本語 — é ß 🤖", "a/\"b'\n\t\x00%s", "x" * 200, "", "\ud800"]
)
def test_any_name(made: Callable[..., Any], changed: Callable[..., Any], name: str) -> None:
    bodies = [dataclasses.replace(body, name=name) for body in made(3).bodies]
    strange = changed(made(3), names=(name, "r2", name), bodies=tuple(bodies), name=name)
    assert frame_at(strange, 2.0).shape == (720, 1280, 3)


def test_values_that_are_not_finite_do_not_break(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    updates, contacts = record.updates.copy(), record.contacts.copy()
    updates["target_x"][::3] = np.nan
    updates["target_x"][1::7] = np.inf
    contacts["x"] = np.nan
    without = SimpleNamespace(
        clearance=np.full_like(record.clearance, np.inf),
        boundary_clearance=np.full_like(record.boundary_clearance, np.inf),
    )
    odd = changed(record, updates=updates, contacts=contacts, **vars(without))
    assert frame_at(odd, 1.3).shape == (720, 1280, 3)


def test_places_far_from_the_origin(made: Callable[..., Any], changed: Callable[..., Any]) -> None:
    """10 km from the origin the view is the same, up to rounding of the camera's place."""
    record, away = made(1), np.array([10_000.0, -10_000.0])
    walls = record.walls._replace(vertices=record.walls.vertices + away)
    pose = record.pose + np.array([*away, 0.0])
    updates = record.updates.copy()
    updates["target_x"] += away[0]
    updates["target_y"] += away[1]
    rings = [ring + away for ring in record.accessible], [ring + away for ring in record.safe]
    moved = changed(
        record, walls=walls, pose=pose, updates=updates, accessible=rings[0], safe=rings[1],
        paths=record.paths._replace(points=record.paths.points + away),
        reference=record.reference._replace(points=record.reference.points + away),
    )  # fmt: skip
    here, there = frame_at(record, 2.0), frame_at(moved, 2.0)
    for colour in (palette.SAFE_AREA, palette.DANGER_AREA, rgb(SAFE.colour)):
        assert pixels(there, colour) == pytest.approx(pixels(here, colour), rel=0.05)


def test_who_has_arrived_is_counted_in_one_place(
    made: Callable[..., Any], changed: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last frames of a film said "9 arrived" and "arrived 10": by the motion, by the modes."""
    words, updates = words_of_the_panel(monkeypatch), made(3).updates.copy()
    updates["mode"] = 3
    for arrived, told in (([50, 60, -1], False), ([50, 60, 70], True)):
        words.clear()
        record = changed(made(3), updates=updates, arrived=np.array(arrived), dt=0.02)
        Painter(Timeline(record), 1.0, 25.0).frame(3.0)
        counts = [said for said in words if "arrived" in said and any(map(str.isdigit, said))]
        assert (counts, "finished" in words, "3" in words) == ([], told, True)
