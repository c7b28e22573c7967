"""Pages play, scrub and show the poses of the record, from disk and without network."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from physim.drawing.page import write_page
from physim.record import Record
from tests.drawing.browser.driver import PHONE, Seen
from tests.helpers import inside
from tests.helpers.records import make_record

SceneModel, placed = inside("physim.drawing", "SceneModel", "placed")
TOLERANCE = inside("physim.drawing.page", "TOLERANCE")

PIXEL = 1.0
"""by which a robot may be drawn beside its place: edges are smoothed over one"""
Opened = Callable[..., Seen]


def test_it_opens_without_network_and_plays_to_the_end(opened: Opened, record: Record) -> None:
    seen = opened()
    assert seen.text("h1") == record.name
    seen.ask("physim.player.setSpeed(16)")
    seen.page.click("button.play")
    seen.until("!physim.player.playing")
    assert seen.ask("physim.view.drawn.time") == pytest.approx(record.time[-1])
    assert seen.ask("physim.player.frames.length") > 3
    assert seen.text("#clock") == "6.00 s"


@pytest.mark.parametrize("follow", ["whole", "robots"])
def test_a_scrub_shows_the_poses_of_the_record(opened: Opened, record: Record, follow: str) -> None:
    seen = opened()
    seen.ask(f"physim.look('{follow}')")
    for step in (0, 1, 137, 300, 422, 599, 600):
        drawn = seen.drawn_at(float(record.time[step]))
        error = np.reshape(drawn["pose"], (-1, 3)) - record.pose[step]
        assert np.hypot(error[:, 0], error[:, 1]).max() <= TOLERANCE
        assert np.abs(error[:, 2]).max() <= TOLERANCE
        assert drawn["time"] == pytest.approx(record.time[step])


def colour_box(seen: Seen, colour: str, near: Any, reach: float) -> list[float]:
    """Left, top, right, bottom [px] of what is drawn in a colour about a place."""
    data = seen.ask("document.querySelector('.view canvas').toDataURL()").partition(",")[2]
    image = np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB"), dtype=int)
    wanted = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    rows, columns = np.nonzero(np.abs(image - wanted).max(axis=2) < 40)
    close = np.hypot(columns + 0.5 - near[0], rows + 0.5 - near[1]) < reach
    rows, columns = rows[close], columns[close]
    assert len(rows) > 20
    return [columns.min(), rows.min(), columns.max() + 1.0, rows.max() + 1.0]


def test_the_canvas_holds_each_robot_where_python_places_it(opened: Opened, record: Record) -> None:
    """Pixels of its mode's colour fill the box of its outline; lens worked out here, too."""
    seen = opened()
    seen.ask("physim.look('whole')")
    for layer in range(3):
        seen.page.locator("#controls input[type=checkbox]").nth(layer).uncheck()
    scene = SceneModel.of_record(record)
    low, high = scene.extent
    for step in (150, 450):
        drawn = seen.drawn_at(float(record.time[step]))
        size = np.array(drawn["size"])
        scale = float(np.min((size - 56.0) / (high - low)))
        origin = size / 2.0 - scale * (low + high) / 2.0 * (1.0, -1.0)
        assert drawn["lens"]["scale"] == pytest.approx(scale, rel=1e-3)
        at = (record.updates["step"] <= step) & (record.updates["robot"] == 2)
        mode = record.modes[record.updates["mode"][at][-1]]
        shape = placed(scene.outlines[2], record.pose[step, 2]) * (scale, -scale) + origin
        middle = record.pose[step, 2, :2] * (scale, -scale) + origin
        reach = scene.reach[2] * scale + 3.0
        box = colour_box(seen, mode.colour, middle, reach)
        expected = [*shape.min(axis=0), *shape.max(axis=0)]
        assert np.abs(np.array(box) - expected).max() <= PIXEL + 0.5


def test_two_runs_go_in_step_beside_each_other_or_in_one_view(
    opened: Opened, record: Record, tmp_path: Path
) -> None:
    with make_record(tmp_path / "other.h5", 2, 4.0, name="the other") as other:
        file = write_page([record, other], tmp_path / "both.html")
    seen = opened(file)
    assert seen.page.locator(".view:visible canvas").count() == 2
    seen.drawn_at(5.0)
    assert seen.ask("physim.views.map((view) => view.drawn.time)") == [5.0, 4.0]
    held = seen.page.locator(".over:visible")  # the run that is over by then
    assert held.count() == 1
    assert "4.0 s" in held.inner_text()
    for time in (3.0, 6.0):
        seen.drawn_at(time)
        assert seen.page.locator(".over:visible").count() == 0
    seen.page.check("#ghosts")
    seen.settle()
    assert seen.page.locator(".view:visible canvas").count() == 1
    assert seen.ask("physim.views[0].ghosts.length") == 1
    title = seen.page.locator(".view:visible .title").inner_text()
    assert "dashed outlines: the other" in title
    assert "ends at 4.0 s" in title
    assert "the other" in seen.text(".figures")


def test_on_a_phone_all_is_reached_by_a_finger(opened: Opened) -> None:
    seen = opened(size=PHONE, touch=True)
    assert seen.ask("document.documentElement.scrollWidth") <= PHONE[0]
    seen.page.tap("button.play")
    assert seen.ask("physim.player.playing")
    seen.page.tap("button.play")
    drawn = seen.drawn_at(3.0)
    (x, y), lens = drawn["pose"][:2], drawn["lens"]
    seen.page.locator(".view canvas").tap(
        position={"x": x * lens["scale"] + lens["x"], "y": lens["y"] - y * lens["scale"]}
    )
    seen.settle()
    assert "r1" in seen.text("#why h2")


def test_keys_do_what_the_page_says(opened: Opened) -> None:
    seen = opened()
    for key, time in (("ArrowRight", 0.1), ("Shift+ArrowRight", 1.1), ("ArrowLeft", 1.0),
                      ("End", 6.0), ("Home", 0.0)):  # fmt: skip
        seen.page.keyboard.press(key)
        assert seen.ask("physim.player.time") == pytest.approx(time), key
    seen.page.keyboard.press("n")
    assert seen.ask("physim.robot") == 0
    seen.page.keyboard.press("p")
    assert seen.ask("physim.robot") == 2
    seen.page.keyboard.press("f")
    assert seen.ask("physim.view.camera.follow") == 2
    before = seen.ask("physim.view.camera.zoom")
    seen.page.keyboard.press("+")
    assert seen.ask("physim.view.camera.zoom") > before
    seen.page.keyboard.press("Escape")
    assert seen.ask("physim.robot") == -1
    seen.page.keyboard.press(" ")
    assert seen.ask("physim.player.playing")
