"""What the video says of now and so far, of contacts that cannot be, and how it ends."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import physim
from physim.contacts import Phase
from physim.drawing import palette
from physim.drawing.video import frame_at, panel
from physim.drawing.video.legend import PAD
from physim.tolerances import DEEP as DEPTH
from tests.analysis.validation.runs import Drivers
from tests.helpers import inside
from tests.video.test_frames import pixels

Timeline = inside("physim.drawing", "Timeline")
Closing, write_corner, ACROSS = inside("physim.drawing.video", "Closing", "write_corner", "ACROSS")
MOST_NOTES, across, notes = inside("physim.drawing.video", "MOST_NOTES", "across", "notes")
why, Painter, Overview = inside("physim.drawing.video", "why", "Painter", "Overview")
ground, PANEL_WIDTH, TEXT = inside("physim.drawing.video", "ground", "PANEL_WIDTH", "TEXT")
Box, DEEP, NO_MODES, signs = inside("physim.drawing.video", "Box", "DEEP", "NO_MODES", "signs")
draw_contacts, BOLD, width = inside("physim.drawing.video", "draw_contacts", "BOLD", "width")
FloatArray = inside("physim.geometry", "FloatArray")
NO_NUMBER = inside("physim.parts", "NO_NUMBER")


def deepened(record: Any, changed: Callable[..., Any], depth: float) -> Any:
    """The record with its first contact so deep from the second sample on."""
    contacts = record.contacts.copy()
    first = contacts[0]
    mine = (contacts["a"] == first["a"]) & (contacts["b"] == first["b"])
    rows = np.flatnonzero(mine & (contacts["phase"] != Phase.ENDED))
    contacts["depth"][rows[1:]] = depth
    return changed(record, contacts=contacts)


def words_of(painter: Painter, time: float) -> list[tuple[str, str]]:
    """Words and values beside the view."""
    now = painter.timeline.at(time)
    pair = painter._view.paint(painter._image, now)
    return [(words, value) for words, value, _ in painter._panel._figures(now, pair)]


def test_figures_say_what_is_of_now_and_what_so_far(made: Callable[..., Any]) -> None:
    record = made(3)
    painter = Painter(Timeline(record), 1.0, 25.0)
    began = float(painter.timeline.contacts.began[0])
    for time, touching in ((began - 0.1, "none"), (began + 0.02, "r1 – r2")):
        found = dict(words_of(painter, time))
        assert list(found)[:2] == ["contacts so far", "touching now"]
        assert found["contacts so far"] == str(int(touching != "none"))
        assert found["touching now"] == touching
        assert all(" now" in words for words in list(found)[1:])
    alone = Painter(Timeline(made(1)), 1.0, 25.0)
    assert "off its path now" in words_of(alone, 1.0)[-1][0]


QUEUE = """\
name: queue
time: {step: 0.01, duration: 3.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [8.0, 0.0, 0.0], path: {offset: 0.0}}
  - {name: b, footprint: {length: 1.8, width: 1.0}, pose: [6.0, 0.1, 0.0], path: {offset: 0.0}}
  - {name: c, footprint: {length: 1.8, width: 1.0}, pose: [3.5, 0.0, 0.0], path: {offset: 0.0}}
"""


def test_of_several_that_touch_the_deepest_two_are_named() -> None:
    record = physim.simulate(
        physim.parse_world(QUEUE), controller=Drivers((0.0, 0.0), (0.5, 0.0), (1.4, 0.0))
    )
    painter = Painter(Timeline(record), 1.0, 25.0)
    named, shallower = set(), 0
    for step in range(0, record.steps_run, 5):
        rows = record.contacts[(record.contacts["step"] == step) & (record.contacts["phase"] < 2)]
        if len(rows) < 2:
            continue
        deepest = rows[np.argmax(rows["depth"])]
        names = [record.bodies[deepest[side]].name for side in "ab"]
        found = dict(words_of(painter, step * record.dt + 1e-4))
        (told,) = [(words, value) for words, value in found.items() if "closest now: " in words]
        assert told[0] == f"closest now: {names[0]} – {names[1]}"
        named.add(told[0])
        shallower += names == ["b", "c"]
    assert shallower  # of equal ones the first would be a and b


def test_names_fit_beside_their_values(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    for name in ("W" * 40, "r1", "heavy robot"):
        bodies = tuple(dataclasses.replace(body, name=name) for body in made(3).bodies)
        painter = Painter(Timeline(changed(made(3), bodies=bodies)), 1.0, 25.0)
        began = float(painter.timeline.contacts.began[0])
        for words, value in words_of(painter, began + 0.02):
            assert width(words, TEXT) + width(value, TEXT, BOLD) < PANEL_WIDTH - 2 * PAD
            assert name != "r1" or "…" not in words + value


def test_contacts_too_deep_are_told_from_when_they_are(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    deep = deepened(record, changed, 10.0 * DEPTH)
    contacts, dt = Timeline(deep).contacts, record.dt
    began = float(contacts.began[0])
    assert np.isclose(contacts.deep[0], began + dt)
    assert np.isinf(contacts.deep[1:]).all()
    assert (contacts.deep_count(began), contacts.deep_count(began + dt)) == (0, 1)
    assert np.isinf(Timeline(deepened(record, changed, 0.9 * DEPTH)).contacts.deep).all()
    assert DEEP in signs(Timeline(deep), ground(Timeline(deep)))
    assert DEEP not in signs(Timeline(record), ground(Timeline(record)))
    found = dict(words_of(Painter(Timeline(deep), 1.0, 25.0), began + dt))
    assert found["of them not physical"] == "1"
    after = began + 0.7  # the flash is over
    shown, usual = (frame_at(one, after, speed=1.0)[:536, :1008] for one in (deep, record))
    assert (shown != usual).any(axis=2).sum() > 200


def test_the_sign_of_a_contact_too_deep_is_a_cross_on_a_disc() -> None:
    image = np.zeros((40, 40, 3), np.uint8)
    draw_contacts(image, np.array([[20.0, 20.0]]), False, deep=True)
    assert tuple(image[20, 20]) == palette.WHITE
    assert tuple(image[20, 12]) == palette.CONTACT
    assert min(image[20, 32]) > 190


def test_robots_that_give_no_modes_have_their_own_colours(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    updates = record.updates.copy()
    updates["mode"] = NO_NUMBER
    bare = changed(record, updates=updates)
    timeline = Timeline(bare)
    assert timeline.at(2.0).colours == list(timeline.scene.colours)
    picture = frame_at(bare, 2.0)
    assert pixels(picture, palette.UNDECIDED) < 50
    assert NO_MODES in signs(timeline, ground(timeline))
    assert NO_MODES not in signs(Timeline(record), ground(Timeline(record)))
    crowd = Timeline(changed(made(61), updates=_no_modes(made(61))))
    assert set(crowd.at(2.0).colours) == {palette.BAND}


def _no_modes(record: Any) -> Any:
    updates = record.updates.copy()
    updates["mode"] = NO_NUMBER
    return updates


def test_the_last_picture_shows_the_whole_run(made: Callable[..., Any]) -> None:
    record = made(3)
    timeline = Timeline(record)
    painter = Painter(timeline, 1.0, 25.0)
    assert not painter._view.camera.whole
    before, end = painter.frame(timeline.duration - 0.1), painter.frame(timeline.duration)
    view = np.zeros((536, 1008, 3), np.uint8)
    closing = Closing(timeline, ground(timeline), Box(0, 0, 1008, 536))
    closing.paint(view, timeline.at(timeline.duration), painter._view._fleet)
    assert np.array_equal(end[:536, :1008], view)
    assert not np.array_equal(before[:536, :1008], view)
    for robot in range(3):
        course = closing._lens.pixels(record.pose[:: len(record.pose) // 3, robot, :2])
        for x, y in np.rint(course).astype(int)[1:2]:
            patch = end[y - 3 : y + 4, x - 3 : x + 4].reshape(-1, 3)
            assert (patch == palette.robot_colour(robot)).all(axis=1).any()
    assert closing.scale < painter._view.camera.scale
    assert painter._view.scales == (painter._view.camera.scale, closing.scale)


def turned(record: Any, changed: Callable[..., Any], robot: int, angle: float) -> Any:
    pose = np.array(record.pose)
    pose[-1, robot, 2] += angle
    return changed(record, pose=pose)


def test_who_stands_across_its_path_is_told_with_the_reason(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    there = changed(record, arrived=np.full(3, len(record.pose) - 1))
    before = across(Timeline(there))
    assert np.allclose(before, 0.0), "they stand along their paths"
    odd = turned(there, changed, 1, np.radians(40.0))
    after = across(Timeline(odd))
    assert np.allclose(after - before, [0.0, 40.0, 0.0])
    found = notes(Timeline(odd))
    assert [line.split()[0] for line in found] == [
        record.names[k] for k in np.flatnonzero(np.abs(after) >= ACROSS)
    ]
    assert any("r2" in line and "across its path" in line for line in found)


def test_reasons_are_contacts_then_danger_then_what_arriving_asks_for(
    made: Callable[..., Any], changed: Callable[..., Any]
) -> None:
    record = made(3)
    end = record.steps[-1]
    touching = record.contacts[:1].copy()
    touching["step"], touching["phase"] = end, Phase.BEGAN
    timeline = Timeline(changed(record, contacts=touching))
    other = timeline.record.bodies[int(touching["b"][0])].name
    assert f"in contact with {other} since" in why(timeline, int(touching["a"][0]), True)
    quiet = changed(record, contacts=record.contacts[:0])
    updates = quiet.updates.copy()
    updates["mode"] = 0
    safe = Timeline(changed(quiet, updates=updates))
    assert "station" in why(safe, 0, True)
    assert why(safe, 0, False) == "no contact"
    updates["mode"] = 1
    assert "danger, by distance" in why(Timeline(changed(quiet, updates=updates)), 0, True)


def test_robots_that_have_not_arrived_are_told_up_to_a_number(made: Callable[..., Any]) -> None:
    few = notes(Timeline(made(3)))
    assert len(few) == 3
    assert all("short of its stop station" in line for line in few)
    many = notes(Timeline(made(61)))
    assert len(many) == MOST_NOTES
    assert many[-1] == f"and {61 - MOST_NOTES + 1} robots more"


def closed(made: Callable[..., Any]) -> tuple[Painter, list[FloatArray], list[str]]:
    """A painter at the end of a run, corners its small map was given, and signs it drew."""
    timeline = Timeline(made(3))
    corners: list[FloatArray] = []
    drawn: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        paint, signs_of = Overview.paint, panel.draw_signs
        patch.setattr(
            Overview, "paint", lambda self, image, at, now: (corners.append(at),
            paint(self, image, at, now)),
        )  # fmt: skip
        patch.setattr(
            panel, "draw_signs", lambda *given: (drawn.extend(given[-1]), signs_of(*given))[1]
        )
        painter = Painter(timeline, 1.0, 25.0)
        painter.frame(0.5 * timeline.duration)
        drawn.clear()
        painter.frame(timeline.duration)
    return painter, corners, drawn


def test_at_the_end_the_small_map_and_the_legend_tell_of_the_whole_run(
    made: Callable[..., Any],
) -> None:
    """The rectangle had been that of the view a moment before, the trail that of ten seconds."""
    painter, (before, end), drawn = closed(made)
    low, high = ground(painter.timeline).extent
    assert not ((before[0] <= low).all() and (before[1] >= high).all())
    assert (end[0] <= low).all()
    assert (end[1] >= high).all()
    assert np.allclose((end[1] - end[0]) * painter._view.scales[1], (1008, 536))
    assert drawn == ["trail of the whole run"]


def test_words_at_the_end_do_not_cover_the_robots_they_speak_of() -> None:
    """The emptiest corner was where the robots stood."""
    view = np.full((536, 1008, 3), palette.OUTSIDE, np.uint8)
    view[:120] = palette.FLOOR
    view[:, 450:560] = palette.FLOOR
    bodies = np.array([[478.0, 400.0, 491.0, 428.0], [519.0, 470.0, 532.0, 494.0]])
    lines = ["the whole run", *(f"w{k} stands 2.42 m short of its stop station " * 2 for k in "12")]
    before = view.copy()
    write_corner(view, lines, bodies)
    assert (view != before).any()
    for x0, y0, x1, y1 in bodies.astype(int):
        assert np.array_equal(view[y0:y1, x0:x1], before[y0:y1, x0:x1])
