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


def test_the_page_itself_is_not_moved(tmp_path: Path) -> None:
    assert box(plan(tmp_path, PILLAR.format(""), 'x="5" y="1"')) == (2, 1, 4, 2)


TURN = 'transform="rotate(3)"'
REFUSED = {
    "a drawing within": (
        f'<svg x="4">\n{PILLAR.format("")}</svg>', ":3: … <svg> … within the drawing … not read",
    ),
    "a copy of a drawing within": (
        f'<defs><svg id="hut">{PILLAR.format("")}</svg></defs>\n<use href="#hut"/>',
        ':3: … <svg> "hut" … within the drawing',
    ),
    "a symbol with a view": (
        '<symbol id="q" viewBox="0 0 9 9"><path d="M0,0h1v1z"/></symbol>\n'
        '<g id="obstacle"><use href="#q"/></g>',
        ':3: … <symbol> "q" … viewBox … group',
    ),
    "a symbol with a place": (
        '<symbol id="q" x="3"><path d="M0,0h1v1z"/></symbol>\n'
        '<g id="obstacle"><use href="#q"/></g>',
        ':3: … <symbol> "q" … x or y',
    ),
    "place in percent": (
        PILLAR.format("").replace('x="2"', 'x="50%"'), ':3: … obstacle … x="50%" … or with px',
    ),
    "copy in percent": (
        '<path id="a" d="M0,0h1v1z"/>\n<use id="obstacle" href="#a" y="10%" width="100%"/>',
        ':4: … <use> … y="10%" … with px',
    ),
    "copy at a word": (
        '<path id="a" d="M0,0h1v1z"/><g id="obstacle"><use href="#a" x="left"/></g>',
        ':3: … <use> … x="left" … number',
    ),
    "copy with a place in its style": (
        '<path id="a" d="M0,0h1v1z"/><g id="obstacle"><use href="#a" style="x:3px"/></g>',
        ':3: … <use> … style … "x" … attribute',
    ),
    "a number without decimals": (
        '<path id="obstacle" d="M10. 4h2v2z"/>', ':3: … path data … ". 4h2v2z" cannot be read',
    ),
    "transform in a style": (
        PILLAR.format('style="transform: scale(2)"'), ':3: … obstacle … "transform" … attribute',
    ),
    "transform in a style, of a group": (
        f'<g style="transform: none">{PILLAR.format("")}</g>', ':3: … <g> … "transform"',
    ),
    "size in a style": (PILLAR.format('style="width: 3px"'), ':3: … obstacle … "width"'),
    "everything in a style": (PILLAR.format('style="all: unset"'), ':3: … obstacle … "all"'),
    "everything in a style, anew": (
        PILLAR.format('style="display: none; all: unset"'), ':3: … obstacle … "all"',
    ),
    "size in a sheet": (
        f"<style>rect {{height: 3px}}</style>\n{PILLAR.format('')}",
        ':4: … obstacle … "height"',
    ),
    "transform in a sheet": (
        f"<style>#floor {{transform: scale(2)}}</style>\n<g id='floor'>{PILLAR.format('')}</g>",
        ':4: … <g> "floor" … "transform"',
    ),
    "transform in a sheet, by more": (
        "<style>g rect {transform: scale(2)}</style>", ':3: … <style> … "g rect" … moves',
    ),
    "a group without a box": (
        f'<g style="display:contents">{PILLAR.format("")}</g>', ":3: … <g> … display: contents",
    ),
    "a link in a switch": (
        f"<switch><a>{PILLAR.format('')}</a></switch>", ":3: … <a> … link in a switch",
    ),
    "a radius in words": (PILLAR.format('rx="auto" ry="0.4"'), ':3: … obstacle … rx="auto"'),
    "a display of two words": (
        f'<g style="display:inline none">{PILLAR.format("")}</g>', ":3: … display: inline none",
    ),
    "a language": (
        f'<g systemLanguage="en">{PILLAR.format("")}</g>', ":3: … <g> … languages",
    ),
    "a switch by language": (
        f'<switch><text systemLanguage="de">a</text><g>{PILLAR.format("")}</g></switch>',
        ":3: … <g> … languages",
    ),
    "a blank before a unit": (
        PILLAR.format("").replace('x="2"', 'x="2 px"'), ':3: … obstacle … x="2 px" … alone or with',
    ),
    "a blank of another kind": (
        PILLAR.format("").replace('x="2"', 'x="2\u00a0"'), ":3: … obstacle … number",
    ),
    "points with a blank of another kind": (
        '<polygon id="obstacle" points="2,2\u00a04,2 4,4"/>', ":3: … points: … cannot be read",
    ),
    "digits of another script": (
        PILLAR.format('transform="translate(5\u0660,2)"'), ":3: … transform: … only numbers",
    ),
    "an element within a sheet": (
        "<style>.a{fill:red}\n<desc>.a{fill:blue}</desc></style>", ":4: … <style> … element",
    ),
    "one of several sheets": ('<style title="a">.k {fill:red}</style>', ":3: … <style> … title"),
    "origin": (
        PILLAR.format(f'{TURN} transform-origin="3 1.5"'),
        ':3: … <rect> "obstacle" … transform-origin: 3 1.5 … (0, 0)',
    ),
    "origin in a style": (
        PILLAR.format(f'{TURN} style="transform-origin: center"'),
        ":3: … obstacle … transform-origin: center … (0, 0)",
    ),
    "box": (
        PILLAR.format(f'{TURN} style="transform-box: fill-box"'),
        ":3: … obstacle … transform-box: fill-box … (0, 0)",
    ),
    "origin in a sheet": (
        f"<style>rect {{transform-origin: center}}</style>\n{PILLAR.format(TURN)}",
        ":4: … obstacle … transform-origin: center … (0, 0)",
    ),
    "origin in a sheet below": (
        f"{PILLAR.format(TURN)}\n<style>#obstacle {{transform-origin: center}}</style>",
        ":3: … obstacle … transform-origin: center",
    ),
    "origin in a sheet, by more": (
        "<style>g > rect {transform-origin: center}</style>", ':3: … <style> … "g > rect" … moves',
    ),
    "rotate in a style": (PILLAR.format('style="rotate: 30deg"'), ":3: … obstacle … rotate"),
    "rotate in a sheet": (
        f"<style>rect {{rotate: 30deg}}</style>\n{PILLAR.format('')}", ':4: … obstacle … "rotate"',
    ),
    "path in a style": (
        '<path id="obstacle" d="M4 4h2v2z" style="d: path(\'M5 5h2v2z\')"/>',
        ':3: … <path> "obstacle" … style … "d"',
    ),
    "radius in percent": (PILLAR.format('rx="2.5%"'), ':3: … obstacle … rx="2.5%" … px, mm'),
    "radius as the other, in percent": (
        '<ellipse id="obstacle" cx="9" cy="9" ry="5%"/>', ':3: … obstacle … ry="5%"',
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


FOR_LINES_ALONE = {
    "a share of the page": '<rect id="paper" width="100%" height="100%"/>',
    "a drawing within": '<svg id="icon" viewBox="0 0 9 9"><rect width="4" height="4"/></svg>',
    "a style that moves": '<path id="hand" style="transform:rotate(3deg)" d="M0,0h9v9z"/>',
    "path data": '<path id="scribble" d="M0,0 h"/>',
    "points": '<polygon id="star" points="0,0 4,0 4"/>',
    "a transform": '<g id="icons" transform="turn(3)"><rect width="4" height="4"/></g>',
}


@pytest.mark.parametrize("what", FOR_LINES_ALONE)
def test_what_is_not_read_matters_for_what_has_a_role_alone(tmp_path: Path, what: str) -> None:
    text = FOR_LINES_ALONE[what]
    (said,) = plan(tmp_path, text).changes
    check_says(said, "left out")
    path = tmp_path / "plan.svg"
    name = text.split('id="')[1].split('"')[0]
    with pytest.raises(ImportSourceError, match=f'plan.svg:3: <.*"{name}"'):
        import_world(path, Options(scale=1.0, boundary=(name,)))


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
    for values in ('ry="0.4"', 'rx="0.4" ry="0.4"'):
        assert shape(plan(tmp_path, PILLAR.format(values))).equals(round_one)
    ellipse = '<ellipse id="obstacle" cx="9" cy="9" ry="1"/>'
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


@pytest.mark.parametrize(
    "text",
    [
        '<?xml-stylesheet href="a.css"?>',
        "<style>@IMPORT url(a.css);</style>",
        '<link xmlns="http://www.w3.org/1999/xhtml" rel="stylesheet" href="a.css"/>',
    ],
)
def test_style_sheets_in_other_files_are_told(tmp_path: Path, text: str) -> None:
    told = [one for one in plan(tmp_path, text).changes if "style sheet" in one]
    assert len(told) == 1
    assert "not read" in told[0]


def test_properties_that_are_not_known_are_told_of_rules_that_are_not_followed(
    tmp_path: Path,
) -> None:
    for sheet, count in (("g rect {zoom: 2}", 1), ("g rect {font-size: 2px}", 0)):
        changes = plan(tmp_path, f"<style>{sheet}</style>{PILLAR.format('')}").changes
        said = [one for one in changes if "zoom" in one]
        assert len(said) == count
        for one in said:
            check_says(one, '<style> … "g rect" … zoom … not applied')


def test_a_copy_of_nothing_draws_nothing(tmp_path: Path) -> None:
    assert box(plan(tmp_path, PILLAR.format("") + "<use/><use href=''/>")) == (2, 1, 4, 2)


def test_a_radius_in_another_unit_is_no_longer_than_half_the_side(tmp_path: Path) -> None:
    """The library reckoned with its number alone: the outline lay 38 m outside of itself."""
    sharp = box(plan(tmp_path, PILLAR.format("")))
    for values in ('rx="1cm"', 'ry="1in"', 'rx="9mm" ry="2pc"'):
        made = plan(tmp_path, PILLAR.format(values))
        assert box(made) == (2, 1, 4, 2)
        assert shape(made).area < 2.0
    assert sharp == (2, 1, 4, 2)


def test_a_copy_of_what_is_not_there_draws_nothing_whatever_its_units(tmp_path: Path) -> None:
    inner = PILLAR.format("") + '<g id="obstacle"><use href="#nix" x="5mm" y="2pt"/></g>'
    assert box(plan(tmp_path, inner)) == (2, 1, 4, 2)


def test_a_link_in_a_link_is_not_drawn(tmp_path: Path) -> None:
    inner = RECT.format("z", "")
    assert box(plan(tmp_path, f'{PILLAR.format("")}<a><a id="obstacle">{inner}</a></a>')) == (
        2, 1, 4, 2,
    )  # fmt: skip


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
    "fitted with two blanks": (
        'width="100mm" height="300mm" viewBox="0 0 50 40" preserveAspectRatio=" xMinYMax  meet "',
        0.002, (10, 6),
    ),
    "in another case": (
        'width="100mm" height="120mm" viewBox="0 0 50 40" preserveAspectRatio="xminyminslice"',
        0.002, (10, 6),
    ),
    "without a height": ('width="100mm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "a share high": ('width="100mm" height="100%" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "without a viewBox": ('width="50mm" height="40mm"', 0.0254 / 96, (10, 40 * 96 / 25.4 - 34)),
    "of no height": ('width="50mm"', 0.0254 / 96, (10, -34)),
}  # fmt: skip


@pytest.mark.parametrize("how", PAGES)
def test_a_page_has_one_scale_and_a_corner(tmp_path: Path, how: str) -> None:
    """Metres of a unit, and where in units the lower left corner of the room is, of the page's."""
    page, unit, corner = PAGES[how]
    path = tmp_path / "plan.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {page}>{ROOM}</svg>')
    # the unit is told, too, where the world is enlarged beyond it
    imported = import_world(path, Options(scale=1.0))
    points = np.concatenate([np.array(one, dtype=float) for one in imported.world.boundaries])
    assert points.min(axis=0) == pytest.approx(corner, abs=1e-3)
    assert np.ptp(points, axis=0) == pytest.approx((24.0, 14.0), abs=1e-3)
    assert ("upper" in "".join(imported.facts)) == (how == "of no height")
    with pytest.raises(ImportSourceError, match=r"--scale") as caught:  # of some centimetres
        import_world(path, Options())
    size = " x ".join(f"{round(length * unit, 3):g}" for length in (24.0, 14.0))
    assert size in str(caught.value)


def test_the_name_of_an_element_is_told_in_one_short_line(tmp_path: Path) -> None:
    for name in ("urn:a\n  written: b", "urn:" + "u" * 10_000):
        inner = f'<x:y xmlns:x="{name}" display="none"/>'.replace("\n", "&#10;")
        (said,) = [one for one in plan(tmp_path, inner).changes if "hidden" in one]
        assert "\n" not in said
        assert len(said) < 200


def test_a_document_type_ends_where_it_ends(tmp_path: Path) -> None:
    """What looks like an entity of one, far below, is none."""
    path = tmp_path / "plan.svg"
    kind = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd">\n'
    path.write_text(kind + svg(f"{WALLS}<style><![CDATA[.a{{x-y:50%z;fill:red}}]]></style>{PATH}"))
    assert import_world(path, Options(scale=1.0)).world.boundaries


@pytest.mark.parametrize("what", [
    '<use href="#nope"/>', "<use/>", '<linearGradient id="q"/><use href="#q"/>',
])  # fmt: skip
def test_a_copy_of_nothing_is_told(tmp_path: Path, what: str) -> None:
    """An obstacle may be missing for it."""
    body = f'<path id="boundary" d="M 0,0 H 40 V 20 H 0 Z"/><g id="obstacle">{what}</g>'
    path = tmp_path / "plan.svg"
    path.write_text(svg(body, 'viewBox="0 0 40 20"'))
    made = import_world(path, Options(scale=1.0))
    assert [one for one in made.changes if "is nothing drawn in this file" in one]
    hidden = body.replace("<use", '<use display="none"')
    path.write_text(svg(hidden, 'viewBox="0 0 40 20"'))
    made = import_world(path, Options(scale=1.0))
    assert not [one for one in made.changes if "is nothing drawn in this file" in one]
