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

import physim
from physim.drawing import palette
from physim.drawing.page import write_page
from physim.record import Record
from physim.world.file import parse_world
from tests.campaigns.real import WORLD
from tests.drawing.browser.driver import PHONE, Seen
from tests.helpers import inside
from tests.helpers.records import make_record

TOLERANCE = inside("physim.drawing.page", "TOLERANCE")
SceneModel, placed = inside("physim.drawing", "SceneModel", "placed")

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


@pytest.mark.parametrize(
    ("keys", "same"),
    [
        ({"seed": 5}, True),
        ({"corridor": {"centreline": [[0, 0], [20, 0]], "width": 8.01}}, False),
        ({"obstacles": [[[12, -1], [13, -1], [13, 0], [12, 0]]]}, False),
    ],
)
def test_runs_with_other_walls_are_not_shown_in_one_view(
    opened: Opened, tmp_path: Path, keys: dict[str, Any], same: bool
) -> None:
    world = parse_world(WORLD)
    runs = [physim.simulate(one) for one in (world, world.changed(**keys))]
    seen = opened(write_page(runs, tmp_path / "both.html"))
    box = seen.page.locator("#ghosts")
    assert box.is_enabled() == same
    told = seen.text("label:has(#ghosts)")
    assert ("their walls differ" in told) != same
    assert seen.page.locator(".view:visible canvas").count() == 2


def test_runs_side_by_side_have_one_scale(opened: Opened, record: Record, tmp_path: Path) -> None:
    with make_record(tmp_path / "other.h5", 2, 4.0, name="the other") as other:
        seen = opened(write_page([record, other], tmp_path / "both.html"))
    for follow in ("'whole'", "'robots'"):
        seen.ask(f"physim.look({follow})")
        seen.drawn_at(2.0)
        scales = seen.ask("physim.views.map((view) => view.drawn.lens.scale)")
        assert scales[0] == pytest.approx(scales[1])


BAR = """(scale) => {
  const { view, player } = physim, { camera } = view, bars = [], { prototype } =
    CanvasRenderingContext2D, write = prototype.fillText, Path = Path2D;
  camera.zoom *= scale / camera.lens(player.time).scale;
  let words = "", end = 0;
  window.Path2D = class extends Path {
    constructor(drawn) {
      super(drawn);
      end = Number(/^M14 .*H([\\d.e-]+)M/.exec(drawn)?.[1] ?? end);
    }
  };
  prototype.fillText = function(text, x, y) {
    if (Math.abs(x - end - 8) < 1e-6) words = text;
    write.call(this, text, x, y);
  };
  physim.show(player.time);
  window.Path2D = Path;
  prototype.fillText = write;
  return [words, (end - 14) / view.drawn.lens.scale, end - 14];
}"""
"""Words and length [m], [px] of the scale bar at about a scale [px/m]"""


def test_the_words_of_the_scale_bar_are_its_length(opened: Opened) -> None:
    seen = opened()
    for scale in (0.01, 0.3, 7.0, 51.0, 52.0, 480.0, 4_800.0, 9e4, 2.3e7, 4e8):
        words, length, pixels = seen.page.evaluate(BAR, scale)
        number, unit = words.split()
        assert unit == "m"
        assert "e" not in number
        assert len(number.strip("0.")) == 1
        assert float(number) == pytest.approx(length, rel=1e-6)
        assert 0.35 * 130.0 <= pixels <= 130.0 + 1e-6


SMALL_ROBOTS = """\
name: small robots
time: {{step: {step}, duration: 2.0}}
corridor: {{centreline: [[0, 0], [{far}, 0]], width: {wide}}}
robots:
  - name: a
    footprint: {{length: {long}, width: {long}}}
    pose: [{long}, 0, 0]
    path: {{offset: 0}}
controller: {{type: constant, commands: [[0.02, 0.0]]}}
"""


@pytest.mark.parametrize("long", [0.04, 1.6])
def test_robots_of_any_size_are_seen_as_large(opened: Opened, tmp_path: Path, long: float) -> None:
    """Of centimetres they had been dots in a view of 16 m."""
    step = min(0.002 * long / 0.04, 0.02)
    text = SMALL_ROBOTS.format(step=step, long=long, far=100.0 * long, wide=8.0 * long)
    record = physim.simulate(parse_world(text))
    seen = opened(write_page([record], tmp_path / "small.html"))
    seen.ask("physim.look('robots')")
    assert seen.drawn_at(1.0)["lens"]["scale"] * long > 30.0
    seen.ask("physim.look(0)")
    whole = seen.ask("physim.view.camera.wholeScale")
    assert seen.drawn_at(1.0)["lens"]["scale"] > 1.5 * whole


OVERVIEW = """([x, y]) => {
  const { view, player } = physim, { camera } = view;
  camera.zoom = 3;
  physim.show(player.time);
  const { lens, pose, size } = view.drawn;
  const wanted = x < 0 ? [size[0] + x, y] : [x, size[1] - y];
  camera.pan(wanted[0] - (pose[0] * lens.scale + lens.x),
             wanted[1] - (lens.y - pose[1] * lens.scale), player.time);
  const seen = [], { prototype } = CanvasRenderingContext2D;
  const alpha = Object.getOwnPropertyDescriptor(prototype, "globalAlpha");
  Object.defineProperty(prototype, "globalAlpha", {
    ...alpha, set(value) { seen.push(value); alpha.set.call(this, value); },
  });
  physim.show(player.time);
  Object.defineProperty(prototype, "globalAlpha", alpha);
  return seen.includes(0.3);
}"""
"""Puts the first robot at a place [px], from the right where x is negative; whether it is pale"""


def test_the_overview_is_pale_over_robots(opened: Opened) -> None:
    seen = opened()
    seen.drawn_at(2.0)
    assert seen.page.evaluate(OVERVIEW, [-40, 40])
    assert not seen.page.evaluate(OVERVIEW, [120, 60])


SPIED = """() => {
  window.dashes = [];
  const line = CanvasRenderingContext2D.prototype, set = line.setLineDash;
  line.setLineDash = function(dash) {
    window.dashes.push(String(dash));
    set.call(this, dash);
  };
}"""
"""Notes each pattern of dashes that a line is drawn with"""
AVOIDING = """() => {
  const thresholds = [{ column: "distance", enter: 0.5, leave: 0.8 }];
  for (const run of physim.runs) Object.assign(run.header.why, { avoids: true, thresholds });
}"""
"""Gives all runs a threshold"""


def test_dashes_are_those_of_thresholds_or_tell_runs_apart(
    opened: Opened, record: Record, tmp_path: Path
) -> None:
    drawn = {}
    for count in (1, 2):
        seen = opened(write_page([record] * count, tmp_path / f"{count}.html"))
        seen.page.evaluate(SPIED)
        seen.page.evaluate(AVOIDING)
        seen.page.set_viewport_size({"width": 1100, "height": 800})  # all is drawn anew
        seen.settle()
        seen.drawn_at(2.0)
        drawn[count] = set(seen.page.evaluate("window.dashes"))
    of_thresholds = drawn[1] - {""}
    assert of_thresholds
    assert not of_thresholds & drawn[2]
    assert drawn[2] - {""}


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


def test_dark_pages_keep_the_colours_of_modes(opened: Opened) -> None:
    light, dark = opened(), opened(scheme="dark")
    ground = "getComputedStyle(document.body).backgroundColor"
    assert light.ask(ground) != dark.ask(ground)
    colours = "physim.view.run.modes.map((mode) => mode.colour)"
    assert light.ask(colours) == dark.ask(colours)
    assert light.ask("physim.colours.contact") == dark.ask("physim.colours.contact")


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


def test_keys_go_on_after_a_click_on_a_check_box(opened: Opened) -> None:
    seen = opened()
    seen.page.locator("#controls input[type=checkbox]").first.click()
    seen.page.keyboard.press("ArrowRight")
    assert seen.ask("physim.player.time") == pytest.approx(0.1)


def test_the_legend_shows_an_obstacle_in_the_colour_it_is_drawn_in(
    opened: Opened, tmp_path: Path
) -> None:
    """It had the colour of the first robot."""
    world = parse_world(WORLD).changed(obstacles=[[[12, -1], [13, -1], [13, 0], [12, 0]]])
    seen = opened(write_page([physim.simulate(world)], tmp_path / "r.html"))
    sign = "#legend li:has(span:text-is('obstacle')) canvas"
    pixel = seen.page.locator(sign).evaluate(
        "one => [...one.getContext('2d').getImageData(30, 20, 1, 1).data.slice(0, 3)]"
    )
    assert tuple(pixel) == palette.OBSTACLE
