"""What of a drawing is read: what is drawn, hidden, copied or cut, its names and its page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Imported, Options, import_world
from tests.authoring.importing.plans import METRES, PATH, WALLS, check_says, refusal, svg

PILLAR = '<rect x="10" y="10" width="1" height="1" {}/>'
ONE = PILLAR.format("")
OTHER = '<rect x="15" y="10" width="1" height="1"/>'


def plan(folder: Path, inner: str) -> Imported:
    """World of a room with what is in line 3 of its drawing; 1 m is a unit, y points up."""
    path = folder / "plan.svg"
    path.write_text(svg(f"{WALLS}\n{inner}\n{PATH}"))
    return import_world(path, METRES)


def obstacles(folder: Path, inner: str) -> list[float]:
    """Least x [m] of every obstacle of a drawing with these elements in its group obstacle."""
    made = plan(folder, f'<g id="obstacle">{inner}</g>')
    return sorted(min(x for x, _ in ring) for ring in made.world.obstacles or ())


G = '<g id="obstacle">{}</g>'
SEEN = {
    "attribute": (G, 'visibility="hidden"', 0),
    "group": ('<g id="obstacle" visibility="hidden">{}</g>', "", 0),
    "seen again": ('<g id="obstacle" visibility="hidden">{}</g>', 'visibility="visible"', 1),
    "style over attribute": (G, 'display="none" style="display:inline"', 1),
    "clear": (G, 'opacity="0.0"', 0),
    "an area that is not drawn": (G, 'fill="none"', 0),
    "an area seen through": (G, 'fill-opacity="0"', 0),
    "a line without width": (G, 'fill="none" stroke="red" stroke-width="0px"', 0),
    "a shape named by its role": ("{}", 'id="obstacle" fill="none"', 1),
    "outline": (G, 'fill="none" stroke="black"', 1),
    "a hidden copy": (
        '<defs>{}</defs><g id="obstacle"><use visibility="hidden" href="#it"/></g>', 'id="it"', 0,
    ),
    "sheet, by a class": ("<style>.h {{display:none}}</style>" + G, 'class="h"', 0),
    "sheet, by an id": ("<style>#w {{visibility:hidden}}</style>" + G, 'id="w"', 0),
    "sheet, by a tag": ("<style>rect {{opacity:0}}</style>" + G, "", 0),
    "sheet, not painted": ("<style>.h {{fill:none; stroke:none}}</style>" + G, 'class="h"', 0),
    "sheet below": (G + "<style>.h {{display:none}}</style>", 'class="h"', 0),
    "an id before a class": (
        "<style>#w {{display:inline}} .k {{display:none}}</style>" + G, 'id="w" class="k"', 1,
    ),
    "the later rule": (
        "<style>.h {{display:none}} .k {{display:inline}}</style>" + G, 'class="k h"', 1,
    ),
    "its own style": ("<style>.h {{display:none}}</style>" + G, 'class="h" style="display:inline"',
                      1),
    "what is important": (
        "<style>.k {{display:none !important}}</style>" + G, 'class="k" style="display:inline"', 0,
    ),
    "on paper": ('<style media="print">.h {{display:none}}</style>' + G, 'class="h"', 1),
}  # fmt: skip


@pytest.mark.parametrize("how", SEEN)
def test_what_is_hidden_in_a_viewer_is_left_out_and_listed(tmp_path: Path, how: str) -> None:
    around, values, count = SEEN[how]
    made = plan(tmp_path, around.format(PILLAR.format(values)))
    assert len(made.world.obstacles or ()) == count
    assert len([one for one in made.changes if "hidden" in one]) == 1 - count


@pytest.mark.parametrize(
    "tag",
    ["mask", "marker", "symbol", "clipPath", "pattern", "defs", "foreignObject", "desc", "filter",
     "script", "text", "unknown", "rect"],
)  # fmt: skip
def test_what_is_drawn_elsewhere_if_at_all_is_no_obstacle(tmp_path: Path, tag: str) -> None:
    hidden = f'<{tag} id="it">{ONE}</{tag}>'
    assert obstacles(tmp_path, hidden + OTHER) == [15.0]
    if tag in ("mask", "marker"):
        assert obstacles(tmp_path, hidden + OTHER + '<use href="#it" x="2"/>') == [15.0]


@pytest.mark.parametrize(
    ("inner", "at"),
    [
        (f'<symbol id="it">{ONE}</symbol><use href="#it" x="2"/><use xlink:href="#it" x="5"/>',
         [12.0, 15.0]),
        (f'<defs><g id="q">{ONE}</g></defs><g x="4"><use href="#q"/></g>', [10.0]),
        (f"{ONE}<use/><use href=''/>", [10.0]),
        ('<defs><rect id="q" width="9" height="2"/><rect id="y" width="1" height="1"/></defs>'
         '<use xlink:href="#y" href="#q" x="4"/>', [4.0]),
        (f'<switch><foreignObject requiredExtensions="urn:x"/><g>{ONE}</g><g>{OTHER}</g></switch>',
         [10.0]),
        (f'<g transform="translate(2-8)"><g transform="scale(1e0)">{ONE}</g></g>', [12.0]),
        (f'<g transform="matrix(1 0 0 1 2 -8)">{ONE}</g>', [12.0]),
        ('<rect x="10" y="10" width="0" height="1"/><circle r="0"/><path/>', []),
        ("<polygon points='9 4 12.5.5 10 5'/>", [9.0]),
        ("<polyline points='+9+4+12+.5+10+5'/>", [9.0]),
        ('<ellipse cx="9" cy="9" ry="1"/>', [8.0]),
    ],
)  # fmt: skip
def test_where_its_lines_lie(tmp_path: Path, inner: str, at: list[float]) -> None:
    assert obstacles(tmp_path, inner) == pytest.approx(at, abs=0.02)


TOLD = {
    "cut": (ONE.replace("<rect", '<rect clip-path="url(#k)"'), "<rect> … clip-path … whole"),
    "masked": (ONE.replace("<rect", '<rect style="mask:url(#k)"'), "<rect> … mask … whole"),
    "edge of a symbol": (f'<symbol id="it">{ONE}</symbol><use href="#it"/>', "<symbol> … edge"),
    "a copy of nothing": ('<use href="#nope"/>', "is nothing drawn in this file"),
    "without a size": ('<rect id="nil" width="0" height="1"/>', "line 3: … <rect> … left out"),
    "moves": ('<rect id="a"/><set href="#a" attributeName="x" to="9"/>', "<set>"),
    "a program": ("<script>document.x = 3</script>", "<script>"),
    "a colour elsewhere": (ONE.replace("<rect", '<rect fill="currentColor"'), "depends"),
    "a sheet elsewhere": ("<style>@import url(a.css);</style>", "style sheet … not read"),
    "a sheet by a link": ('<?xml-stylesheet href="a.css"?>', "style sheet … not read"),
    "a text": ('<text x="1" y="2">Hall 7</text>', "line 3: … <text> … left out"),
}


@pytest.mark.parametrize("what", TOLD)
def test_what_is_not_followed_is_told(tmp_path: Path, what: str) -> None:
    inner, told = TOLD[what]
    check_says("; ".join(plan(tmp_path, f'<g id="obstacle">{inner}</g>').changes), told)


CURVES = {
    "S after Q": ("Q11 2 12 4S14 3 14 4L12 6z", "Q11 2 12 4C12 4 14 3 14 4L12 6z"),
    "T after C": ("C10 3 11 3 12 4T14 4L12 6z", "C10 3 11 3 12 4L14 4 12 6z"),
    "S after S": ("S11 3 12 4 14 3 14 4L12 6z", "C10 4 11 3 12 4C13 5 14 3 14 4L12 6z"),
    "flags without gaps": ("a1 1 0 011 1v1z", "A 1 1 0 0 1 11 5 v 1z"),
}


@pytest.mark.parametrize("how", CURVES)
def test_smooth_curves_go_on_after_their_own_kind_alone(tmp_path: Path, how: str) -> None:
    drawn, meant = (
        shape(plan(tmp_path, f'<path id="obstacle" d="M10 4{one}"/>')) for one in CURVES[how]
    )
    assert drawn.symmetric_difference(meant).area < 0.02


def shape(imported: Imported) -> Any:
    (ring,) = imported.world.obstacles or ()
    return shapely.Polygon(ring)


def test_a_radius_may_be_as_long_as_the_other(tmp_path: Path) -> None:
    corners = [shape(plan(tmp_path, PILLAR.format(f'id="obstacle" {values}')))
               for values in ('rx="0.4"', 'ry="0.4"', 'rx="0.4" ry="0.4"')]  # fmt: skip
    assert corners[0].area < 0.9
    assert all(one.equals(corners[0]) for one in corners)


def test_a_fill_rule_is_read(tmp_path: Path) -> None:
    """Both lines go round the same way: by the other rule all within is painted."""
    path = tmp_path / "plan.svg"
    ring = '<path id="walls" {} d="M 10,10 H 50 V 40 H 10 Z M 11,11 H 49 V 39 H 11 Z"/>'
    path.write_text(svg(ring.format('fill-rule="evenodd"')))
    made = import_world(path, METRES)
    assert min(shapely.Polygon(line).area for line in made.world.boundaries or ()) == 38.0 * 28.0
    path.write_text(svg(ring.format("")))
    assert "fill themselves" in refusal(path)


@pytest.mark.parametrize(
    ("name", "role"),
    [("wallpaper", False), ("pathcollection_1", False), ("robotics", False), ("path_12", False),
     ("obstacle_12", True), ("obstacle2", True), ("Obstacles", True), ("obstacle-left", True)],
)  # fmt: skip
def test_names_of_roles_are_words_of_their_own(tmp_path: Path, name: str, role: bool) -> None:
    made = plan(tmp_path, PILLAR.format(f'id="{name}"'))
    assert bool(made.world.obstacles) == role
    assert bool([one for one in made.changes if "in no layer" in one]) != role


@pytest.mark.parametrize(
    ("layer", "near"), [("obstacels", '"obstacles"'), ("wals", '"walls"'), ("notes", "")]
)
def test_a_layer_that_is_none_is_told_once_by_its_name(
    tmp_path: Path, layer: str, near: str
) -> None:
    shapes = '<rect id="rect88" x="9" y="2" width="1" height="1"/>' * 3
    changes = plan(tmp_path, f'<g inkscape:label="{layer}">{shapes}</g>').changes
    (told,) = (one for one in changes if "in no layer" in one)
    check_says(told, f"line 3: … 'rect88' and 2 more … '{layer}'")
    assert told.endswith(f"did you mean {near}?") if near else "did you mean" not in told


PLACE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="40" height="24"
 viewBox="0 0 40 24">
<g inkscape:label="boundary"><rect x="1" y="1" width="38" height="22"/></g>
<g inkscape:label="path"><path inkscape:label="path ann" d="M 3 5 L 37 5"/>
<path inkscape:label="path bob" d="M 3 12 L 30 20"/></g>
<g inkscape:label="robot"><rect id="one" inkscape:label="robot ann" x="4" y="4.5" width="1.8"
 height="1"/>{}</g></svg>"""


@pytest.mark.parametrize("second", [
    '<use xlink:href="#one" inkscape:label="robot bob" transform="translate(0,7)"/>',
    '<g inkscape:label="bob"><rect x="4" y="11.5" width="1.8" height="1"/></g>',
])  # fmt: skip
def test_copies_and_groups_have_names_of_their_own(tmp_path: Path, second: str) -> None:
    """Not that of what they copy; by it a robot follows its own path."""
    file = tmp_path / "d.svg"
    file.write_text(PLACE.format(second))
    world = import_world(file, METRES).world
    assert [robot.name for robot in world.robots] == ["ann", "bob"]
    ends = [np.asarray(world.reference_path if not isinstance(one.path, tuple) else one.path)[-1]
            for one in world.robots]  # fmt: skip
    assert ends[0][1] == pytest.approx(19.0, abs=0.1)  # y points up
    assert ends[1][1] < 6.0


ROOM = '<path id="boundary" d="M 10,20 H 34 V 34 H 10 Z"/><path id="path" d="M 12,22 H 30"/>'
PAGES = {
    "as large": ('width="50mm" height="40mm" viewBox="0 0 50 40"', 0.001, (10, 6)),
    "moved": ('width="50mm" height="40mm" viewBox="5 10 50 40"', 0.001, (5, 16)),
    "without gaps": ('width="50mm" height="40mm" viewBox="-5-10 50,40"', 0.001, (15, -4)),
    "twice": ('width="100mm" height="80mm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "fitted": ('width="100mm" height="300mm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "cut": (
        'width="100mm" height="120mm" viewBox="0 0 50 40" preserveAspectRatio="xMinYMax slice"',
        0.003, (10, 6),
    ),
    "without a height": ('width="100mm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "without a viewBox": ('width="50mm" height="40mm"', 0.0254 / 96, (10, 40 * 96 / 25.4 - 34)),
}  # fmt: skip


@pytest.mark.parametrize("how", PAGES)
def test_a_page_has_one_scale_and_a_corner(tmp_path: Path, how: str) -> None:
    """Metres of a unit, and where in units the lower left corner of the room is, of the page's."""
    page, unit, corner = PAGES[how]
    path = tmp_path / "plan.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {page}>{ROOM}</svg>')
    made = import_world(path, METRES)
    points = np.concatenate([np.array(one, dtype=float) for one in made.world.boundaries or ()])
    assert points.min(axis=0) == pytest.approx(corner, abs=1e-3)
    assert np.ptp(points, axis=0) == pytest.approx((24.0, 14.0), abs=1e-3)
    size = " x ".join(f"{round(length * unit, 3):g}" for length in (24.0, 14.0))
    check_says(refusal(path, Options()), f"{size} … --scale")  # of some centimetres


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_units_may_be_in_capitals(tmp_path: Path, unit: str) -> None:
    """Of a page and of its shapes."""
    path, box, found = tmp_path / "plan.svg", 'y="9" width="1" height="1"', set()
    for one in (unit, unit.upper(), unit.title()):
        inner = f'{WALLS}\n<g id="obstacle"><rect x="0.1{one}" {box}/></g>\n{PATH}'
        path.write_text(svg(inner, f'width="24000{one}" height="14000{one}" viewBox="0 0 24 14"'))
        world = import_world(path, Options()).world
        found.add((world.boundaries, world.obstacles))
    assert len(found) == 1
