"""What the standard says of a drawing is done or refused, never left out in silence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Imported, ImportSourceError, Options, import_world
from tests.importing.plans import check_says, svg

WALLS = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PATH = '<path id="path" d="M 2,2 L 20,2"/>'
PILLAR = '<rect id="obstacle" x="2" y="1" width="2" height="1" {}/>'


def plan(folder: Path, inner: str, page: str = "") -> Imported:
    """World of a room with what is in line 3 of its drawing; 1 m is a unit, y points up."""
    path = folder / "plan.svg"
    text = svg(f"{WALLS}\n{inner}\n{PATH}")
    path.write_text(text.replace("<svg", f"<svg {page}", 1))
    return import_world(path, Options(scale=1.0))


def told(folder: Path, inner: str) -> str:
    with pytest.raises(ImportSourceError) as caught:
        plan(folder, inner)
    message = str(caught.value)
    assert "\n" not in message
    return message.removeprefix(str(folder / "plan.svg"))


def box(imported: Imported) -> Any:
    """Least and largest x, y of the obstacle [m], y down as drawn."""
    (ring,) = imported.world.obstacles or ()
    x, y = np.array(ring).T
    return pytest.approx((x.min(), 14.0 - y.max(), x.max(), 14.0 - y.min()), abs=2e-3)


def shape(imported: Imported) -> Any:
    (ring,) = imported.world.obstacles or ()
    return shapely.Polygon(ring)


PAGES = {
    "place": ('<svg x="10" y="6" width="4" height="2">{}</svg>', (12, 7, 14, 8)),
    "style": ('<svg style="x: 10px; y:6" width="4" height="2">{}</svg>', (12, 7, 14, 8)),
    "units": ('<svg x="96pt" y="0.0625in" width="4" height="2">{}</svg>', (130, 7, 132, 8)),
    "view": ('<svg x="10" y="6" width="4" height="2" viewBox="0 0 4 2">{}</svg>', (12, 7, 14, 8)),
    "within another": ('<svg x="9" y="5"><svg x="1" y="1">{}</svg></svg>', (12, 7, 14, 8)),
    "copied": (
        '<defs><svg id="it" x="8" y="6">{}</svg></defs><use href="#it" x="2"/>', (12, 7, 14, 8),
    ),
    "moved": ('<svg x="8" y="6" transform="translate(2,0)">{}</svg>', (12, 7, 14, 8)),
    "turned": (
        '<g transform="translate(10,6) rotate(90)"><svg x="1" y="-5">{}</svg></g>', (13, 9, 14, 11),
    ),
}  # fmt: skip


@pytest.mark.parametrize("how", PAGES)
def test_a_drawing_within_the_drawing_is_where_it_is_placed(tmp_path: Path, how: str) -> None:
    text, expected = PAGES[how]
    if how == "units":  # a pixel is a metre: leave the room as wide as they need
        text = f'<g transform="translate(-118,0)">{text}</g>'
        expected = (12, 7, 14, 8)
    made = plan(tmp_path, text.format(PILLAR.format("")))
    assert expected == box(made)
    assert not [one for one in made.changes if "short" not in one]


def test_the_page_itself_is_not_moved(tmp_path: Path) -> None:
    for page in ('x="5" y="1"', 'style="x: 5; y: 1"'):
        assert box(plan(tmp_path, PILLAR.format(""), page)) == (2, 1, 4, 2)


EDGES = {
    "across": ('width="4" height="1.5"', "line 3: … <svg> … hut … its edge … taken whole"),
    "as large": ('width="4" height="2"', ""),
    "seen beyond": ('width="1" height="1" style="overflow: visible"', ""),
}


@pytest.mark.parametrize("how", EDGES)
def test_what_reaches_out_of_a_drawing_within_the_drawing_is_told(tmp_path: Path, how: str) -> None:
    values, message = EDGES[how]
    page = f'<svg id="hut" x="10" y="6" {values}>{PILLAR.format("")}</svg>'
    made = plan(tmp_path, f'<g transform="translate(2,0) rotate(3)">{page}</g>')
    said = [one for one in made.changes if "whole" in one]
    assert len(said) == bool(message)
    for one in said:
        check_says(one, message)


TURN = 'transform="rotate(3)"'
REFUSED = {
    "place in percent": (
        '<svg id="hut" x="10%"><g/></svg>', ':3: … <svg> "hut" … x="10%" … give it in px or mm',
    ),
    "place of a word": ('<svg y="low"><g/></svg>', ':3: … <svg> … y="low" … number'),
    "percent below": (
        '<svg width="4" height="2"><g/></svg>\n' + PILLAR.format("").replace('x="2"', 'x="50%"'),
        ":4: … 'obstacle' … x=\"50%\" … below an <svg>",
    ),
    "percent within": (
        f'<svg width="4" height="2">{PILLAR.format("").replace("2", "50%", 1)}</svg>',
        ":3: … 'obstacle' … x=\"50%\" … page without viewBox",
    ),
    "copy in percent below": (
        '<svg width="4" height="2"><g/></svg><path id="a"/>\n<use href="#a" y="10%" width="100%"/>',
        ':4: … <use> … y="10%" … below an <svg>',
    ),
    "copy at a word": (
        '<path id="a"/><use href="#a" id="b" x="left"/>', ':3: … <use> "b" … x="left" … number',
    ),
    "origin": (
        PILLAR.format(f'{TURN} transform-origin="3 1.5"'),
        ':3: … <rect> "obstacle" … transform-origin: 3 1.5 … (0, 0)',
    ),
    "origin in a style": (
        PILLAR.format(f'{TURN} style="transform-origin: center"'),
        ":3: … obstacle … transform-origin: center … (0, 0)",
    ),
    "both in a style": (
        PILLAR.format('style="transform: scale(2); transform-origin: 1px 1px"'),
        ":3: … obstacle … transform-origin: 1px 1px",
    ),
    "box": (
        PILLAR.format(f'{TURN} style="transform-box: fill-box"'),
        ":3: … obstacle … transform-box: fill-box … (0, 0)",
    ),
    "origin in a sheet": (
        f"<style>.a {{transform-origin: center}}</style>\n{PILLAR.format(TURN)}",
        ':4: … obstacle … transform … <style> ".a" has transform-origin: center',
    ),
    "origin in a sheet below": (
        f"{PILLAR.format(TURN)}\n<style>#obstacle {{transform-origin: center}}</style>",
        ':3: … obstacle … transform … <style> "#obstacle" has transform-origin: center',
    ),
    "rotate in a style": (PILLAR.format('style="rotate: 30deg"'), ":3: … obstacle … rotate"),
    "rotate in a sheet": ("<style>.a {rotate: 30deg}</style>", ':3: … <style> … ".a" … rotate'),
    "path in a style": (
        '<path id="obstacle" d="M4 4h2v2z" style="d: path(\'M5 5h2v2z\')"/>',
        ':3: … <path> "obstacle" … style … "d"',
    ),
    "radius in percent": (PILLAR.format('rx="2.5%"'), ':3: … obstacle … rx="2.5%" … px or mm'),
    "radius as the other, in percent": (
        '<ellipse id="obstacle" cx="9" cy="9" rx="auto" ry="5%"/>', ':3: … obstacle … ry="5%"',
    ),
    "flag": (
        '<path id="obstacle" d="M10 4A2 1 0 2 1 12 4z"/>',
        ':3: … <path> "obstacle" … path data: "A2 1 0 2 1 12 4": "2 1 12 4" … flag … 0 or 1',
    ),
    "an arc cut short": (
        '<path id="obstacle" d="M10 4A2 1 0 01 12z"/>', ':3: … obstacle … 6 numbers … A takes 7',
    ),
    "a curve cut short": (
        '<path id="obstacle" d="M10 4C2 1 0z"/>', ':3: … obstacle … "C2 1 0" has 3 numbers … 6',
    ),
    "a number after the end": (
        '<path id="obstacle" d="M10 4h2v2z 1"/>', ":3: … obstacle … 1 number … z takes none",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_not_read_as_the_standard_has_it_is_refused(tmp_path: Path, what: str) -> None:
    text, message = REFUSED[what]
    check_says(told(tmp_path, text), message)


@pytest.mark.parametrize(
    "values",
    [
        f'{TURN} transform-origin="0 0"',
        f'{TURN} style="transform-origin: left 0%; transform-box: view-box"',
        'transform="translate(1,1)" transform-origin="3 1.5"',
        'transform="matrix(1 0 0 1 1 1)" transform-origin="3 1.5"',
        'style="transform-origin: center"',
        f'{TURN} transform-origin="3 1.5" display="none"',
    ],
)
def test_an_origin_that_changes_nothing_is_no_fault(tmp_path: Path, values: str) -> None:
    plan(tmp_path, PILLAR.format(values))


def test_a_share_of_the_page_matters_for_what_has_a_role_alone(tmp_path: Path) -> None:
    """Programs paint the page by a shape as large as all of it."""
    page = '<svg width="4" height="2"><rect id="paper" width="100%" height="100%"/></svg>'
    (said,) = plan(tmp_path, page).changes
    check_says(said, "paper … left out")


CURVES = {
    "S after Q": ("Q11 2 12 4S14 3 14 4L12 6z", "Q11 2 12 4C12 4 14 3 14 4L12 6z"),
    "s after t": ("Q11 2 12 4t1 0s1 -1 1 0L12 6z", "Q11 2 12 4T13 4C13 4 14 3 14 4L12 6z"),
    "T after C": ("C10 3 11 3 12 4T14 4L12 6z", "C10 3 11 3 12 4L14 4 12 6z"),
    "t after S": ("S11 3 12 4t2 0L12 6z", "C10 4 11 3 12 4L14 4 12 6z"),
    "S after S": ("S11 3 12 4 14 3 14 4L12 6z", "C10 4 11 3 12 4C13 5 14 3 14 4L12 6z"),
    "flags without gaps": ("a1 1 0 011 1v1z", "A 1 1 0 0 1 11 5 v 1z"),
}


@pytest.mark.parametrize("how", CURVES)
def test_smooth_curves_go_on_after_their_own_kind_alone(tmp_path: Path, how: str) -> None:
    drawn, meant = (
        shape(plan(tmp_path, f'<path id="obstacle" d="M10 4{one}"/>')) for one in CURVES[how]
    )
    assert drawn.symmetric_difference(meant).area < 0.02


def test_a_radius_may_be_as_long_as_the_other(tmp_path: Path) -> None:
    round_one = shape(plan(tmp_path, PILLAR.format('rx="0.4"')))
    assert round_one.area < 1.9
    for values in ('rx="auto" ry="0.4"', 'rx="0.4" ry="0.1" style="ry: auto"'):
        assert shape(plan(tmp_path, PILLAR.format(values))).equals(round_one)
    ellipse = '<ellipse id="obstacle" cx="9" cy="9" rx="auto" ry="1"/>'
    assert box(plan(tmp_path, ellipse)) == (8, 8, 10, 10)


RECT = '<rect id="{}" x="10" y="6" width="4" height="2" {}/>'
NOT_PAINTED = {
    **{
        tag: f'<g id="obstacle"><{tag}>{RECT.format("z", "")}</{tag}></g>'
        for tag in (
            "desc", "title", "metadata", "linearGradient", "filter", "font", "script", "text",
            "image", "unknown", "marker", "symbol", "rect",
        )
    },
    "foreign": f'<x:g xmlns:x="urn:x" id="obstacle">{RECT.format("z", "")}</x:g>',
    "extension": RECT.format("obstacle", 'requiredExtensions="urn:x"'),
    "group with an extension": f'<g requiredExtensions="x">{RECT.format("obstacle", "")}</g>',
    "area seen through": RECT.format("z", 'fill-opacity="0"'),
    "line seen through": RECT.format("z", 'fill="none" stroke="red" stroke-opacity="0%"'),
    "line without width": RECT.format("z", 'fill="none" stroke="red" stroke-width="0px"'),
    "path without data": '<path id="obstacle"/>',
    "rectangle without a size": '<rect id="obstacle" x="10"/>',
    "circle without a radius": '<circle id="obstacle" cx="10" cy="9"/>',
    "ellipse without radii": '<ellipse id="obstacle" cx="10" cy="9"/>',
}  # fmt: skip


@pytest.mark.parametrize("how", NOT_PAINTED)
def test_what_no_viewer_paints_is_no_obstacle(tmp_path: Path, how: str) -> None:
    inner = NOT_PAINTED[how]
    if 'id="obstacle"' not in inner:
        inner = f'<g id="obstacle">{inner}</g>'
    imported = plan(tmp_path, f"{PILLAR.format('')}\n{inner}")
    assert box(imported) == (2, 1, 4, 2)  # that beside it alone


def test_of_elements_with_one_id_a_copy_is_of_the_first(tmp_path: Path) -> None:
    first, second = RECT.format("z", ""), '<rect id="z" width="1" height="1"/>'
    inner = f'<defs>{first}{second}</defs><g id="obstacle"><use href="#z"/></g>'
    assert box(plan(tmp_path, inner)) == (10, 6, 14, 8)


def test_all_elements_with_the_id_of_a_role_have_it(tmp_path: Path) -> None:
    imported = plan(tmp_path, PILLAR.format("") + RECT.format("obstacle", ""))
    assert len(imported.world.obstacles or ()) == 2


def test_a_copy_is_of_its_href(tmp_path: Path) -> None:
    """As a browser has it where both are there."""
    others = RECT.format("z", "") + '<rect id="y" width="1" height="1"/>'
    use = '<use xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="#y" href="#z"/>'
    inner = f'<defs>{others}</defs><g id="obstacle">{use}</g>'
    assert box(plan(tmp_path, inner)) == (10, 6, 14, 8)


def test_copies_of_ids_that_stand_twice_are_counted_before_they_are_made(tmp_path: Path) -> None:
    """Each copies the next ten times; those counted were empty ones of the same ids."""
    empty = "".join(f'<g id="u{k}"/>' for k in range(9))
    copies = "".join(
        f'<g id="u{k}">{f"<use href={chr(34)}#u{k + 1}{chr(34)}/>" * 10}</g>' for k in range(9)
    )
    last = '<rect id="u9" width="1" height="1"/>'
    plan(tmp_path, f'<defs>{empty}{copies}{last}</defs><use href="#u0"/>')  # the empty one
    assert "copies written out" in told(
        tmp_path, f'<defs>{copies}{empty}{last}</defs><use href="#u0"/>'
    )


def test_a_share_of_the_page_in_what_is_copied_is_refused(tmp_path: Path) -> None:
    """The library took it for one of a drawing that had ended."""
    page = '<svg x="10" y="6" width="4" height="2" viewBox="0 0 4 2"/>'
    rect = '<rect id="z" x="50%" y="50%" width="4" height="2"/>'
    inner = f'<defs>{rect}</defs>{page}<g id="obstacle"><use href="#z"/></g>'
    check_says(told(tmp_path, inner), ":3: … x … 50%")


@pytest.mark.parametrize(
    "text",
    ['<?xml-stylesheet href="a.css"?>', "<style>@IMPORT url(a.css);</style>"],
)
def test_style_sheets_in_other_files_are_told(tmp_path: Path, text: str) -> None:
    told = [one for one in plan(tmp_path, text).changes if "style sheet" in one]
    assert len(told) == 1
    assert "not read" in told[0]
