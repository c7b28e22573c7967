"""What of a drawing is read: roles, names, headings, what is hidden or copied, curves, the page."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.authoring.importing.plans import METRES, PATH, WALLS, check_says, svg
from tests.helpers import inside

read_svg = inside("physim.authoring.importing", "read_svg")

PILLAR = '<rect x="10" y="10" width="1" height="1" {}/>'
ONE = PILLAR.format("")
OTHER = '<rect x="15" y="10" width="1" height="1"/>'
G = '<g id="obstacle">{}</g>'


def read(folder: Path, inner: str, options: Options = METRES) -> Any:
    """Drawing of a room with what is in line 3; 1 m is a unit, y points up."""
    return read_text(folder, svg(f"{WALLS}\n{inner}\n{PATH}"), options)


def read_text(folder: Path, text: str, options: Options = METRES) -> Any:
    path = folder / "plan.svg"
    path.write_text(text)
    return read_svg(path, options)


def refusal(folder: Path, text: str, options: Options = METRES) -> str:
    with pytest.raises(ImportSourceError) as caught:
        read_text(folder, text, options)
    assert "\n" not in str(caught.value)
    return str(caught.value).removeprefix(str(folder / "plan.svg"))


def lefts(drawing: Any) -> list[float]:
    """Least x [m] of every obstacle."""
    return sorted(one.geometry.bounds[0] for one in drawing.of("obstacle"))


def test_the_sample(tmp_path: Path) -> None:
    drawing = read_svg(Path(__file__).parent / "samples" / "hall.svg", Options(scale=0.1))
    roles = [one.role for one in drawing.shapes]
    assert roles == ["boundary"] * 4 + ["path"] + ["robot"] * 2
    assert drawing.shapes[0].geometry.bounds == (2.0, 5.0, 23.0, 18.0)
    check_says(drawing.facts[0], "0.1 m per user unit … lower left corner is (0, 0)")


NAMES = {
    '<g id="robot"><rect inkscape:label="ann" {}/></g>': ("robot", "ann", None),
    '<rect id="robot 2" {}/>': ("robot", "2", None),
    '<rect id="robot_ann" {}/>': ("robot", "ann", None),
    '<rect inkscape:label="Robot ann @90" id="rect7" {}/>': ("robot", "ann", 90.0),
    '<rect inkscape:label="robot @-30" {}/>': ("robot", "", -30.0),
    '<g inkscape:label="robot"><g inkscape:label="bob"><rect id="path8" {}/></g></g>':
        ("robot", "bob", None),
    '<g inkscape:label="robot"><rect id="obstacle-left" {}/></g>': ("obstacle", "left", None),
    '<defs><rect id="q" {}/></defs><use href="#q" id="obstacle2"/>': ("obstacle", "2", None),
    '<rect id="robot a" style="display:none" {}/><use href="#robot a" id="robot b"/>': None,
}  # fmt: skip


@pytest.mark.parametrize("inner", NAMES)
def test_a_layer_label_or_id_says_role_name_and_heading(tmp_path: Path, inner: str) -> None:
    drawn = [one for one in read(tmp_path, inner.format('x="9" y="9" width="2" height="1"')).shapes
             if one.role in ("robot", "obstacle")]  # fmt: skip
    if (meant := NAMES[inner]) is None:
        assert not drawn
        return
    ((role, name, heading),) = ((one.role, one.name, one.heading) for one in drawn)
    assert (role, name) == meant[:2]
    assert heading == (None if meant[2] is None else pytest.approx(np.radians(meant[2])))


EDITORS = {
    "Inkscape": """<svg xmlns="http://www.w3.org/2000/svg" width="297mm" height="210mm"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" viewBox="0 0 297 210"
 xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd" version="1.1" id="svg5">
<sodipodi:namedview id="n" pagecolor="#fff"/><defs id="defs2"/>
<g inkscape:label="boundary" inkscape:groupmode="layer" id="layer1" style="display:inline">
<rect style="fill:none;stroke:#000;stroke-width:0.5;paint-order:fill markers stroke" id="rect1"
 width="240" height="140" x="10" y="10" ry="0"/></g>
<g inkscape:groupmode="layer" id="layer2" inkscape:label="path"><path id="path3"
 style="fill:none;stroke:#000;marker-end:url(#Arrow)" d="m 20,80 h 150 c 10,0 20,5 30,5"
 sodipodi:nodetypes="ccc"/></g>
<g inkscape:groupmode="layer" id="layer3" inkscape:label="robot" transform="translate(5,0)">
<path sodipodi:type="arc" id="path9" d="m 38,80 a 5,5 0 0 1 -10,0 5,5 0 0 1 10,0 z"/></g></svg>""",
    "Illustrator": """<?xml version="1.0" encoding="utf-8"?>
<!-- Generator: Adobe Illustrator 27.0.0, SVG Export Plug-In . SVG Version: 6.00 Build 0)  -->
<svg version="1.1" xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 x="0px" y="0px" width="297mm" height="210mm" viewBox="0 0 297 210" xml:space="preserve"
 style="enable-background:new 0 0 297 210;">
<style type="text/css">
	.st0{fill:none;stroke:#000000;stroke-miterlimit:10;}
	.st1{fill:#FFF;opacity:0.5;font-family:'Arial;{'}
</style>
<g id="boundary_1_"><polygon class="st0" points="10,10 250,10 250,150 10,150 	"/></g>
<g id="path"><path id="path1" class="st0" d="M20,80h150c10,0,20,5,30,5"/></g>
<g id="robot"><circle id="robot_1" class="st1" cx="38" cy="80" r="5"/></g></svg>""",
    "draw.io": """<svg xmlns="http://www.w3.org/2000/svg" style="background-color: #fff;"
 xmlns:xlink="http://www.w3.org/1999/xlink" version="1.1" width="297mm" height="210mm"
 viewBox="-0.5 -0.5 297 210"><defs><style type="text/css">@import url(https://a.b/css?x;y);
@font-face {font-family: "x"; src: url(data:font;base64,aa)}</style></defs><g>
<g data-cell-id="boundary"><g id="boundary"><rect x="10" y="10" width="240" height="140"
 fill="none" stroke="#000" pointer-events="all"/></g></g><g data-cell-id="p"><g id="path"><path
 d="M 20 80 L 170 80" fill="none" stroke="#000" stroke-miterlimit="10"/></g></g>
<g><g id="robot"><ellipse cx="38" cy="80" rx="5" ry="5" fill="#ffffff" stroke="#000"/></g>
<g><g transform="translate(-0.5 -0.5)"><switch><foreignObject style="overflow: visible;"
 width="9" height="9" requiredFeatures="x"/><text x="2" y="3">Hall</text></switch></g></g></g>
</g></svg>""",
}


@pytest.mark.parametrize("editor", EDITORS)
def test_what_editors_write_is_read(tmp_path: Path, editor: str) -> None:
    drawing = read_text(tmp_path, EDITORS[editor], Options(scale=0.1))
    assert [one.role for one in drawing.shapes] == ["boundary", "path", "robot"]
    assert shapely.Polygon(drawing.shapes[0].points).area == pytest.approx(24.0 * 14.0)
    assert drawing.shapes[2].geometry.area == pytest.approx(np.pi / 4.0, rel=0.03)


SEEN = {
    "attribute": (G, 'visibility="hidden"', 0),
    "group": ('<g id="obstacle" visibility="hidden">{}</g>', "", 0),
    "seen again": ('<g id="obstacle" visibility="hidden">{}</g>', 'visibility="visible"', 1),
    "style over attribute": (G, 'display="none" style="display:inline"', 1),
    "important": (G, 'style="display : none !important"', 0),
    "clear": (G, 'opacity="0.0"', 0),
    "a hidden copy": (
        '<defs>{}</defs><g id="obstacle"><use visibility="hidden" href="#it"/></g>', 'id="it"', 0,
    ),
    "colours say nothing": (G, 'fill="none" fill-opacity="0"', 1),
    "a sheet that paints": ("<style>.h {{fill:none; opacity:.5}}</style>" + G, 'class="h"', 1),
}  # fmt: skip


@pytest.mark.parametrize("how", SEEN)
def test_what_is_hidden_is_left_out_and_listed(tmp_path: Path, how: str) -> None:
    around, values, count = SEEN[how]
    drawing = read(tmp_path, around.format(PILLAR.format(values)))
    assert len(drawing.of("obstacle")) == count
    assert len([one for one in drawing.changes if "hidden" in one]) == 1 - count


@pytest.mark.parametrize(
    ("inner", "at"),
    [
        (f'<symbol id="it">{ONE}</symbol><use href="#it" x="2"/><use xlink:href="#it" x="5"/>',
         [12.0, 15.0]),
        (f'<defs><g id="q">{ONE}</g></defs><g><use href="#q"/></g>', [10.0]),
        ('<defs><rect id="q" width="9" height="2"/><rect id="y" width="1" height="1"/></defs>'
         '<use xlink:href="#y" href="#q" x="4"/>', [4.0]),
        (f'<g transform="translate(2-8)"><g transform="scale(1e0)">{ONE}</g></g>', [12.0]),
        (f'<g transform="rotate(90) scale(-1 1)">{ONE}</g>', [-11.0]),
        (f'<g transform="matrix(1 0 0 1 2 -8)">{ONE}</g>', [12.0]),
        ('<rect x="10" y="10" width="0" height="1"/><circle r="0"/><path/>', []),
        ("<polygon points='9 4 12.5.5 10 5'/>", [9.0]),
        ("<polygon points='+9+4+12+.5+10+5'/>", [9.0]),
        ('<ellipse cx="9" cy="9" ry="1"/>', [8.0]),
        ('<rect x="10mm" y="9" width="1" height="1"/>', [37.795]),
        *((f"<{tag}>{ONE}</{tag}>{OTHER}", [15.0])
          for tag in ("mask", "marker", "symbol", "clipPath", "defs", "text", "foreignObject")),
    ],
)  # fmt: skip
def test_where_its_lines_lie(tmp_path: Path, inner: str, at: list[float]) -> None:
    assert lefts(read(tmp_path, G.format(inner))) == pytest.approx(at, abs=0.02)


CURVES = {
    "S after Q": ("Q11 2 12 4S14 3 14 4L12 6z", "Q11 2 12 4C12 4 14 3 14 4L12 6z"),
    "T after C": ("C10 3 11 3 12 4T14 4L12 6z", "C10 3 11 3 12 4L14 4 12 6z"),
    "T after T": ("Q11 2 12 4T14 4L12 9z", "Q11 2 12 4Q13 6 14 4L12 9z"),
    "S after S": ("S11 3 12 4 14 3 14 4L12 6z", "C10 4 11 3 12 4C13 5 14 3 14 4L12 6z"),
    "flags without gaps": ("a1 1 0 011 1v1z", "A 1 1 0 0 1 11 5 v 1z"),
    "after the end": ("h2v2zm0 4h1v1z", "h2v2zM10 8h1v1z"),
    "arcs": ("a1 1 0 1 1 2 0a1 1 0 0 1-2 0z",
             "c0-.552 .448-1 1-1s1 .448 1 1-.448 1-1 1-1-.448-1-1z"),
}  # fmt: skip


@pytest.mark.parametrize("how", CURVES)
def test_path_data(tmp_path: Path, how: str) -> None:
    drawn, meant = (
        shapely.union_all([shape.geometry for shape in read(
            tmp_path, f'<path id="obstacle" d="M10 4{one}"/>').of("obstacle")])
        for one in CURVES[how]
    )  # fmt: skip
    assert drawn.symmetric_difference(meant).area < 0.03


def test_an_outline_within_another_of_the_same_shape_is_a_hole(tmp_path: Path) -> None:
    ring = '<path id="obstacle" d="M 1,1 H 23 V 13 H 1 Z M 2,2 H 22 V 12 H 2 Z"/>'
    (solid,) = read(tmp_path, ring).of("obstacle")
    assert solid.geometry.area == 22.0 * 12.0 - 20.0 * 10.0


def test_what_has_no_role_is_asked_about_or_left_out_when_told(tmp_path: Path) -> None:
    notes = '<g inkscape:label="obstacels">' + ONE + '<rect id="r88"/>' * 6 + "</g>"
    text = svg(f"{WALLS}\n{notes}\n{PATH}")
    told = refusal(tmp_path, text)
    check_says(told, ':3: … <rect> in "obstacels"; did you mean "obstacles"? (line 3) … '
               '"r88" in … --ignore "obstacels" … --ignore-others')  # fmt: skip
    for options in (METRES.changed(ignore=("obstacels",)), METRES.changed(ignore_others=True)):
        drawing = read_text(tmp_path, text, options)
        assert not drawing.of("obstacle")
        assert "--ignore" in " ".join(drawing.changes)
    taken = read_text(tmp_path, svg(f'<rect id="rim" width="9" height="9"/>{PATH}'),
                      METRES.changed(boundary=("rim",)))  # fmt: skip
    assert len(taken.of("boundary")) == 1
    check_says(refusal(tmp_path, text, METRES.changed(ignore=("obstacel",))), '"obstacels"')


LAYERS = {
    "boundry": ('<path id="path1" d="M0,0H9"/>', '<path> "path1" in "boundry"; did you mean '
                '"boundary"? (line 3) … --ignore "boundry" or'),
    "obstacel": ('<rect id="rect1"/><g id="g4"><rect id="rect2"/></g>',
                 '2 shapes … "rect1" in "obstacel"; did you mean "obstacle"? (line 3), '
                 '<rect> "rect2" in "obstacel" (line 3); … --ignore "obstacel" or'),
}  # fmt: skip


@pytest.mark.parametrize("name", LAYERS)
def test_a_misspelt_layer_is_named_and_no_id_of_a_program(tmp_path: Path, name: str) -> None:
    shapes, message = LAYERS[name]
    layer = f'<g inkscape:groupmode="layer" inkscape:label="{name}" id="layer1">{shapes}</g>'
    check_says(refusal(tmp_path, inner(layer)), message)


def test_a_copy_is_called_by_its_own_id_and_line(tmp_path: Path) -> None:
    both = PILLAR.format('id="rect1"') + '\n<use id="use1" href="#rect1"/>'
    shapes = read(tmp_path, G.format(both)).of("obstacle")
    assert [str(one) for one in shapes] == ['<rect> "rect1", line 3', '<use> "use1", line 4']


def test_hidden_walls_and_the_area_elsewhere_are_told_where_there_is_no_place(
    tmp_path: Path,
) -> None:
    path = tmp_path / "plan.svg"
    hidden = WALLS.replace("path id", 'path display="none" id')
    room = '<rect id="boundary 2" x="30" y="2" width="5" height="4"/>'
    elsewhere = "no closed area; closed elsewhere: 20 m² about (32.50, 10.00); "
    for inside_it, message in ((room, elsewhere), ("", "no line is a boundary … ")):
        path.write_text(svg(f"{hidden}\n{inside_it}\n{PATH}"))
        with pytest.raises(ImportSourceError) as caught:
            import_world(path, METRES)
        check_says(str(caught.value), message + "hidden … 1 boundary, the first in line 2; show")


@pytest.mark.parametrize("name", ["wallpaper", "pathcollection_1", "robotics", "path_12"])
def test_names_of_roles_are_words_of_their_own(tmp_path: Path, name: str) -> None:
    pillar = PILLAR.format(f'id="{name}"')
    assert f'"{name}"' in refusal(tmp_path, svg(WALLS + pillar))


ROOM = '<path id="boundary" d="M 10,20 H 34 V 34 H 10 Z"/>'
PAGES = {
    "as large": ('width="50mm" height="40mm" viewBox="0 0 50 40"', 0.001, (10, 6)),
    "moved": ('width="50mm" height="40mm" viewBox="5 10 50 40"', 0.001, (5, 16)),
    "without gaps": ('width="50mm" height="40mm" viewBox="-5-10 50,40"', 0.001, (15, -4)),
    "in capitals": ('width="100MM" height="8cm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "without a height": ('width="100mm" viewBox="0 0 50 40"', 0.002, (10, 6)),
    "without a viewBox": ('width="50mm" height="40mm"', 0.0254 / 96, (10, 40 * 96 / 25.4 - 34)),
}


@pytest.mark.parametrize("how", PAGES)
def test_a_page_has_one_scale_and_a_corner(tmp_path: Path, how: str) -> None:
    """Metres of a unit, and where in units the lower left corner of the room is, of the page's."""
    page, unit, corner = PAGES[how]
    text = f'<svg xmlns="http://www.w3.org/2000/svg" {page}>{ROOM}</svg>'
    for scale, options in ((1.0, METRES), (unit, Options())):
        bounds = read_text(tmp_path, text, options).shapes[0].geometry.bounds
        meant = (*corner, corner[0] + 24.0, corner[1] + 14.0)
        assert bounds == pytest.approx(np.multiply(meant, scale), abs=1e-3)


BILLION = (
    '<?xml version="1.0"?>\n<!DOCTYPE svg [\n<!ENTITY a "aaaaaaaaaa">\n'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">\n' for a, b in pairwise("abcdefghi"))
    + ']>\n<svg xmlns="http://www.w3.org/2000/svg">&i;</svg>'
)
DOUBLING = "".join(
    f'<g id="g{k}"><use href="#g{k - 1}"/><use href="#g{k - 1}"/></g>' for k in range(1, 40)
)
HOSTILE = {
    "entity bomb": (BILLION, "entity"),
    "external entity": (
        '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<svg>&x;</svg>', "entity",
    ),
    "entity of another file": (
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd">\n<!-- &nbsp; -->\n'
        + svg('<rect id="boundary" x="6&foo;0" width="9" height="9"/>'),
        ":4: … entity",
    ),
    "copies of copies": (svg(f'<path id="g0" d="M0,0"/>{DOUBLING}'), "100000 elements, copies"),
    "copies itself": (svg('<g id="a"><use href="#a"/></g>'), ':2: … copy of itself … a'),
    "copy from outside": (
        svg('<use id="wall" href="other.svg#a"/>'), ':2: … "other.svg#a" … not in this file',
    ),
    "deep": (svg("<g>" * 3000 + "</g>" * 3000), ":2: … XML"),
    "nested": (svg("<g>" * 150 + "<path/>" * 14_000 + "</g>" * 150), ":2: … 100 groups"),
    "points": (svg(f'<path id="boundary" d="M{" 1" * 300_000}"/>'), "50000 points"),
    "elements": (svg("<g/>" * 100_000), "100000 elements"),
    "a comment without end": ("<!DOCTYPE svg>" + "<!--" * 100_000, ":1: … XML"),
    "a sheet of links": (svg("<style>" + "url(" * 200_000 + "</style>"), ":2: … style sheet"),
    "imports": (svg("<style>.a{" + "@import" * 200_000 + "</style>"), ":2: … style sheet"),
    "not XML": ("<svg><path</svg>", ":1: … XML"),
    "not SVG": ("<html></html>", ":1: … <html> … <svg>"),
    "a name that acts on a terminal": (svg('<rect id="r&#x202e;m"/>'), "r\\u202em"),
}  # fmt: skip


def page(values: str) -> str:
    return svg(f"{WALLS}\n{PATH}", values)


def inner(text: str) -> str:
    """A drawing with these elements in line 3."""
    return svg(f"{WALLS}\n{text}\n{PATH}")


def rect(values: str = "", place: str = 'x="2" y="1" width="2" height="1"') -> str:
    return inner(f'<rect id="obstacle" {place} {values}/>')


def data(text: str) -> str:
    return inner(f'<path id="obstacle" d="{text}"/>')


def group(transform: str) -> str:
    return inner(f'<g id="boundary" transform="{transform}"><path d="M0,0H9"/></g>')


FAULTS = {
    "viewBox of three": (page('viewBox="0 0 24"'), ':1: … viewBox="0 0 24" … four numbers'),
    "viewBox negative": (page('viewBox="0 0 -24 14"'), ':1: … viewBox="0 0 -24 14" … above 0'),
    "no page width": (page('width="0mm" viewBox="0 0 24 14"'), ':1: … width="0mm" … above 0'),
    "page in ems": (page('width="30em" viewBox="0 0 24 14"'), ':1: … width="30em" … a number'),
    "place": (rect(place='x="a" y="6" width="1" height="1"'), ':3: … obstacle … x="a"'),
    "place in percent": (rect(place='x="50%" width="1" height="1"'), ':3: … x="50%" … with px'),
    "negative width": (rect(place='width="-1" height="1"'), ':3: … obstacle … width="-1"'),
    "unit": (inner('<circle id="obstacle" cx="10" cy="6" r="1em"/>'), ':3: … r="1em" … mm'),
    "beyond numbers": (data("M 0,0 L 1e999,3 L 4,4 Z"), '"1e999" … large'),
    "odd points": (inner('<polygon id="obstacle" points="1,2 3"/>'), ":3: … 3 numbers … pairs"),
    "stray sign": (inner('<polygon id="path" points="1,1 4,1 - 5 6"/>'), ':3: … "- 5'),
    "path data": (data("M 0,0 L garbage"), ':3: … path data … "g" cannot be read'),
    "path data without a start": (data("L 5,5 6,9"), ":3: … begin with M"),
    "a comma too many": (data("M20 20,,h90v90z"), ':3: … path data … ",,"'),
    "a comma at the end": (data("M2 2 4 4,"), ':3: … path data … ","'),
    "a radius near to 0": (data("M50 50A1e-200 1e-200 0 0 1 70 50z"), ":3: … radius … 0"),
    "flag": (data("M10 4A2 1 0 2 1 12 4z"), ':3: … "2 1 12 4" … flag 0 or 1'),
    "an arc cut short": (data("M10 4A2 1 0 01 12z"), ':3: … "A" has 6 numbers … 7'),
    "a number after the end": (data("M10 4h2v2z 1"), ':3: … "z" has 1 numbers … 0'),
    "rotation": (group("scale(2) rotate(30,120)"), ':3: … "rotate(30,120)" … rotate 1 or 3'),
    "skewing": (group("skewx(5)"), ':3: … "skewx(5)" … rotate 1 or 3, skewX 1'),
    "turning": (group("turn(30)"), ':3: … transform: … "turn(30)"'),
    "flat": (rect('transform="scale(1,0)"'), ':3: … obstacle … "scale(1,0)" … no area'),
    "origin": (rect('transform-origin="3 1.5"'), ':3: … "transform-origin" is not read'),
    "a clip": (inner(f'<g id="obstacle" clip-path="url(#k)">{ONE}</g>'),
               ':3: … <g> … "clip-path" is not read … ungroup'),
    "a mask": (rect('style="mask:url(#k)"'), ':3: … "mask", which is not read'),
    "a drawing within": (inner("<svg><rect id='obstacle' width='1' height='1'/></svg>"),
                         ":3: … <svg> … is not read"),
    "a symbol with a view": (
        inner('<symbol id="q" viewBox="0 0 9 9"><path d="M0,0h1v1z"/></symbol>'
              '<g id="obstacle"><use href="#q"/></g>'), ':3: … <symbol> "q" … "viewBox"',
    ),
    "copy at a word": (
        inner('<defs><path id="a" d="M0,0h1v1z"/></defs><use id="wall" href="#a" x="left"/>'),
        ':3: … <use> … "left" … number',
    ),
    "transform in a style": (rect('style="transform: scale(2)"'), ':3: … "transform", which'),
    "size in a style": (rect('style="width: 3px"'), ':3: … obstacle … "width"'),
    "all in a style": (rect('style="display: none; all: unset"'), ':3: … obstacle … "all"'),
    "a language": (rect('systemLanguage="en"'), ':3: … "systemLanguage"'),
    "not closed": (data("M 5,5 7,7 7,5"), ":3: … obstacle … (5.00, 9.00) is not closed"),
    "without an area": (data("M 5,5 7,5 9,5 Z"), ":3: … obstacle"),
    "crosses itself": (data("M 5,5 7,7 7,5 5,7 Z"), ":3: … obstacle … itself at (6.00, 8.00)"),
    "outlines that cross": (data("M4,4h4v4h-4zM6,6h4v4h-4z"), ":3: … obstacle … cross each other"),
    "a robot of two": (inner('<path id="robot r" d="M4,4h1v1z M6,6h1v1z"/>'), ":3: … one outline"),
    "a heading": (inner('<rect inkscape:label="robot a @north" width="2" height="1"/>'),
                  ':3: … "north" … a number'),
    "a heading without @": (inner('<rect id="robot r1 90" width="2" height="1"/>'),
                            ':3: … "r1 90" … write @90'),
    "a wall with an inside": (inner('<rect id="wall" width="9" height="9"/>'),
                              ':3: … "wall" … obstacle … boundary'),
    "no boundary": (svg(PATH), "--boundary"),
    **{f"a sheet: {sheet}": (inner(f"<style>{sheet}</style>"), f':3: … "{said}" … only paint')
       for sheet, said in {
           ".h {display:none}": "display:none",
           "#f {fill:red; transform: scale(2)}": "transform: scale(2)",
           "@media print {.h {opacity:0}}": "opacity:0",
           ".a { .b {fill:red} visibility:hidden }": "visibility:hidden",
           ".a {fill:red} /* } */ .b {mask:none": "mask:none",
           '.a {font-family:"}"; d: none}': "d: none",
       }.items()},
}  # fmt: skip


SLOW = pytest.param("copies of copies", marks=pytest.mark.deep)


@pytest.mark.parametrize(
    "name", [SLOW, *[one for one in [*HOSTILE, *FAULTS] if one != "copies of copies"]]
)
def test_a_refusal_names_the_line_the_element_and_what_is_wrong(tmp_path: Path, name: str) -> None:
    text, message = {**HOSTILE, **FAULTS}[name]
    check_says(refusal(tmp_path, text), message)


OPTIONS = {
    "no units": (page('width="240" height="140"'), Options(), ":1: … units … --scale"),
    "stretched page": (
        page('width="240mm" height="240mm" viewBox="0 0 24 14"'), Options(),
        ":1: … width, height … viewBox … one scale",
    ),
    "a wall that is not there": (
        svg('<path id="rim" d="M 0,0 24,0 24,14 Z"/>'), METRES.changed(boundary=("rims",)), '"rim"',
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_a_fault_of_a_drawing_with_its_options(tmp_path: Path, name: str) -> None:
    text, options, message = OPTIONS[name]
    check_says(refusal(tmp_path, text, options), message)


UNREAD = {
    "a share of the page": '<rect id="paper" width="100%" height="100%"/>',
    "a drawing within": '<svg id="icon" viewBox="0 0 9 9"><rect width="4" height="4"/></svg>',
    "path data": '<path id="scribble" d="M0,0 h"/>',
    "a transform": '<g id="icons" transform="turn(3)"><rect width="4" height="4"/></g>',
}


@pytest.mark.parametrize("what", UNREAD)
def test_what_is_not_read_matters_for_what_has_a_role_alone(tmp_path: Path, what: str) -> None:
    assert len(read(tmp_path, UNREAD[what], METRES.changed(ignore_others=True)).shapes) == 2
    name = UNREAD[what].split('id="')[1].split('"')[0]
    told = refusal(tmp_path, inner(UNREAD[what]), METRES.changed(boundary=(name,)))
    assert f'"{name}"' in told


def test_a_drawing_becomes_a_world(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(svg(f'{WALLS}{PATH}<g id="robot"><circle cx="4" cy="7" r="0.5"/></g>'))
    (robot,) = import_world(path, METRES).world.robots
    assert robot.pose == pytest.approx((4.0, 7.0, 0.0))
