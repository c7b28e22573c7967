"""Drawings that cannot be imported: the line and the element, what is wrong and what to write."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from physim.authoring.importing import Options, import_world
from tests.authoring.importing.plans import METRES, PATH, WALLS, check_says, refusal, svg

BILLION = (
    '<?xml version="1.0"?>\n<!DOCTYPE svg [\n<!ENTITY a "aaaaaaaaaa">\n'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">\n' for a, b in pairwise("abcdefghi"))
    + ']>\n<svg xmlns="http://www.w3.org/2000/svg">&i;</svg>'
)
DOUBLING = "".join(
    f'<g id="g{k}"><use href="#g{k - 1}"/><use href="#g{k - 1}"/></g>' for k in range(1, 40)
)
USES = (f'<use href="#u{k + 1}"/>' * 10 for k in range(9))
COPIES = "".join(f'<g id="u{k}">{uses}</g>' for k, uses in enumerate(USES))
EMPTY = "".join(f'<g id="u{k}"/>' for k in range(9))
TURNS = f'<g transform="{"rotate(1)" * 1000}">' + '<rect width="1"/>' * 200 + "</g>"

HOSTILE = {
    "entity bomb": (BILLION, ":3: … XML entity"),
    "external entity": (
        '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<svg>&x;</svg>',
        ":1: … XML entity",
    ),
    "entity of another file": (
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd">\n<!-- &nbsp; -->\n'
        + svg('<rect id="boundary" x="6&foo;0" width="9" height="9"/>'),
        ":4: … XML entity &foo;",
    ),
    "entity in a sheet": (
        '<!DOCTYPE svg [<!ENTITY a "display:none">]>' + svg(f"<style>.h {{&a;}}</style>{WALLS}"),
        ":1 … XML entity",
    ),
    "copies of copies": (svg(f'<path id="g0" d="M 0,0 1,1"/>{DOUBLING}'), "more than 100000"),
    "copies of ids that stand twice": (
        svg(f'<defs>{COPIES}{EMPTY}<rect id="u9" width="1"/></defs><use href="#u0"/>'),
        "copies written out",
    ),
    "copies itself": (svg('<g id="a"><use href="#a"/></g>'), '"a" … itself … use'),
    "copy from outside": (svg('<use href="other.svg#a"/>'), ':2: … "other.svg#a" … outside'),
    "deep": (svg("<g>" * 3000 + "</g>" * 3000), ":2: … groups … ungroup"),
    "nested": (
        svg("<g>" * 150 + "<path/>" * 14_000 + "</g>" * 150), ":2: … groups within each other",
    ),
    "numbers": (svg(f'<path d="M{" 1" * 300_001}"/>'), "300000 numbers"),
    "transforms": (svg(WALLS + TURNS), "transforms … 150000"),
    "rules within rules": (
        svg(f"<style>{'@supports (a:b) {' * 3000}</style>{WALLS}"), "<style> … rules within",
    ),
    "a comment without end": ("<!DOCTYPE svg>" + "<!--" * 100_000, ":1: … XML"),
    "not XML": ("<svg><path</svg>", ":1: … XML"),
    "not SVG": ("<html></html>", ":1: … <html> … <svg>"),
}  # fmt: skip

FLOODS = {
    "elements": (svg("<g/>" * 100_000), ":2: … 100000 elements"),
    "a flood of styles": (
        svg(WALLS + "".join(f"<g style='{'fill:red;' * 1000}opacity:{k}'/>" for k in range(500))),
        "<g> … 2 million characters of style",
    ),
    "a flood of selectors": (
        svg("<style>"
            + "".join(f".a{k}{{fill:none}}" for k in range(100_001)) + f"</style>{WALLS}"),
        "<style> … selectors",
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "name", [*HOSTILE, *(pytest.param(one, marks=pytest.mark.deep) for one in FLOODS)]
)
def test_hostile_drawings_are_refused(tmp_path: Path, name: str) -> None:
    text, message = {**HOSTILE, **FLOODS}[name]
    path = tmp_path / "d.svg"
    path.write_text(text)
    check_says(refusal(path).removeprefix(str(path)), message)


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
    return inner(f'<g id="wall" transform="{transform}"><path d="M0,0H9"/></g>')


TURN = 'transform="rotate(3)"'
FAULTS = {
    # the page
    "viewBox without width": (page('viewBox="0 0 0 14"'), ':1: … viewBox="0 0 0 14" … above 0'),
    "viewBox negative": (page('viewBox="0 0 -24 14"'), ':1: … viewBox="0 0 -24 14" … above 0'),
    "viewBox of three": (page('viewBox="0 0 24"'), ':1: … viewBox="0 0 24" … four numbers'),
    "viewBox of words": (page('viewBox="a b c d"'), ':1: … viewBox="a b c d" … four numbers'),
    "no page width": (page('width="0mm" viewBox="0 0 24 14"'), ':1: … width="0mm" … above 0'),
    "page width": (page('width="wide" viewBox="0 0 24 14"'), ':1: … width="wide" … 240mm'),
    "page in ems": (page('width="30em" viewBox="0 0 24 14"'), ':1 … <svg> … width="30em"'),
    "stretched page": (
        "<!-- a\nplan -->\n"
        + page('width="240mm" height="240mm" viewBox="0 0 24 14" preserveAspectRatio="none"'),
        ":3: … <svg> … width … height … viewBox",
    ),
    # numbers
    "place": (rect(place='x="a" y="6" width="1" height="1"'), ':3: … obstacle … x="a"'),
    "place in percent": (rect(place='x="50%" width="1" height="1"'), ':3: … x="50%" … with px'),
    "a blank before a unit": (rect(place='x="2 px" width="1"'), ':3: … x="2 px" … alone or with'),
    "negative width": (rect(place='width="-1" height="1"'), ':3: … obstacle … width="-1"'),
    "a radius in words": (rect('rx="auto" ry="0.4"'), ':3: … obstacle … rx="auto"'),
    "radius in percent": (rect('rx="2.5%"'), ':3: … obstacle … rx="2.5%" … px, mm'),
    "unit": (inner('<circle id="obstacle" cx="10" cy="6" r="1em"/>'), ':3: … r="1em" … mm'),
    "beyond numbers": (data("M 0,0 L 1e999,3 L 4,4 Z"), '"1e999" … large'),
    "odd points": (inner('<polygon id="obstacle" points="1,2 3"/>'), ":3: … 3 numbers … pairs"),
    "stray sign": (inner('<polygon id="path" points="1,1 4,1 4 4 - 5 6"/>'), ':3: … points: "- 5'),
    # path data
    "path data": (data("M 0,0 L garbage"), ':3: … path data … "garbage"'),
    "path data without a start": (data("L 5,5 6,9"), ":3: … begin with M"),
    "a comma too many": (data("M20 20,,h90v90z"), ":3: … path data … comma"),
    "a comma too early": (data("M,20 20h90v90z"), ":3: … path data … comma"),
    "a comma at the end": (data("M2 2 4 4,"), ":3: … path data … comma"),
    "a radius near to 0": (data("M50 50A1e-200 1e-200 0 0 1 70 50z"), ':3: … "1e-200" … 0'),
    "a number without decimals": (data("M10. 4h2v2z"), ':3: … ". 4h2v2z" cannot be read'),
    "flag": (data("M10 4A2 1 0 2 1 12 4z"), ':3: … "2 1 12 4" … flag … 0 or 1'),
    "an arc cut short": (data("M10 4A2 1 0 01 12z"), ":3: … 6 numbers … A takes 7"),
    "a curve cut short": (data("M10 4C2 1 0z"), ':3: … "C2 1 0" has 3 numbers … 6'),
    "a number after the end": (data("M10 4h2v2z 1"), ":3: … 1 number … z takes none"),
    # transforms
    "rotation": (group("scale(2) rotate(30,120)"), ':3: … "rotate(30,120)" … 2 … 1 or 3'),
    "turning": (group("turn(30)"), ':3: … transform: … "turn(30)" … matrix'),
    "digits of another script": (group("translate(5\u0660,2)"), ":3: … transform: … only numbers"),
    "flat": (rect('transform="scale(1,0)"'), ':3: … obstacle … "scale(1,0)" … 0'),
    "origin": (
        rect(f'{TURN} transform-origin="3 1.5"'), ":3: … transform-origin: 3 1.5 … (0, 0)",
    ),
    # what is not read
    "a drawing within": (inner("<svg><rect id='obstacle' width='1' height='1'/></svg>"),
                         ":3: … <svg> … within the drawing … not read"),
    "a symbol with a view": (
        inner('<symbol id="q" viewBox="0 0 9 9"><path d="M0,0h1v1z"/></symbol>'
              '<g id="obstacle"><use href="#q"/></g>'),
        ':3: … <symbol> "q" … viewBox … group',
    ),
    "a symbol with a place": (
        inner('<symbol id="q" x="3"><path d="M0,0h1v1z"/></symbol>'
              '<g id="obstacle"><use href="#q"/></g>'),
        ':3: … <symbol> "q" … x or y',
    ),
    "copy at a word": (
        inner('<path id="a" d="M0,0h1v1z"/><g id="obstacle"><use href="#a" x="left"/></g>'),
        ':3: … <use> … x="left" … number',
    ),
    "a copy of what is hidden where it stands": (
        inner('<switch><g/><g id="q"><path d="M0,0h1v1z"/></g></switch>'
              '<g id="obstacle"><use href="#q"/></g>'),
        ':3: … "q" … copied … switch … <defs>',
    ),
    "transform in a style": (rect('style="transform: scale(2)"'), ':3: … "transform" … attribute'),
    "size in a style": (rect('style="width: 3px"'), ':3: … obstacle … "width"'),
    "rotate in a style": (rect('style="rotate: 30deg"'), ":3: … obstacle … rotate"),
    "a language": (rect('systemLanguage="en"'), ":3: … languages"),
    "an element within a sheet": (
        inner("<style>.a{fill:red}\n<desc>.a{fill:blue}</desc></style>"), ":4: … <style> … element",
    ),
    "transform in a sheet": (
        inner("<style>#floor {transform: scale(2)}</style>\n<g id='floor'><rect id='obstacle'"
              " width='1' height='1'/></g>"),
        ':4: … <g> "floor" … "transform"',
    ),
    "moved by a sheet, by more": (
        inner("<style>g rect {transform: scale(2)}</style>"), ':3: … <style> … "g rect" … moves',
    ),
    "hidden by a sheet, by more": (
        inner("<style>.x, .k rect {display: none}</style>"), ":3 … <style> … .k rect … hides",
    ),
    "cut by a sheet, by more": (
        inner("<style>rect:not(.h) {mask: url(#m)}</style>"), ":3 … <style> … rect:not(.h) … cuts",
    ),
    "hidden on a condition": (
        rect('class="h"').replace("<rect", "<style>@media (min-width: 9px) {.h {display:none}}"
                                  "</style><rect"),
        '<style> … "@media (min-width: 9px) .h" hides',
    ),
    "hidden as a whole": (
        page('style="display:none" viewBox="0 0 24 14"'), "the whole drawing is hidden",
    ),
    # places
    "path through an obstacle": (
        rect(place='x="10" y="6" width="1" height="2"'),
        ":4: … 'path' … 'obstacle', line 3 … (10.00, 7.00)",
    ),
    "obstacle of a line": (data("M 5,5 7,7"), ":3: … 'obstacle' … area"),
    "obstacle that crosses itself": (data("M 5,5 7,7 7,5 5,7 Z"), ":3: … 'obstacle' … itself"),
    "obstacle over everything": (
        rect(place='x="-1" y="-1" width="30" height="30"'), ":3: … 'obstacle' … whole area",
    ),
    "robot that crosses itself": (
        inner('<polygon id="robot r7" points="3,6 5,7 5,6 3,7"/>'), ":3: … 'robot r7' … itself",
    ),
    "robot in a wall": (
        inner('<rect id="robot a" x="-1" y="6" width="2" height="1"/>'),
        ":3: … 'robot a' … cannot run … boundaries[0]",
    ),
    "robots over each other": (
        inner('<rect id="robot a" x="3" y="6" width="2" height="1"/>\n'
              '<rect id="robot b" x="4" y="6" width="2" height="1"/>'),
        ":4: … 'robot b' … cannot run … robots[1]",
    ),
    "path outside": (svg(f'{WALLS}\n<path id="path" d="M 30,7 50,7"/>'), ":3: … 'path' … no area"),
    "ends of walls": (
        svg('<path id="boundary a" d="M 0,14 0,0 24,0"/>\n'
            '<path id="boundary b" d="M 24,3 24,14 8,14"/>\n<path id="boundary c" d="M 9,0 9,4"/>'),
        ":2: … 'boundary a' … (24.00, 14.00) … (24.00, 11.00) … 'boundary b', line 3 … 3 m apart",
    ),
    "what could be a boundary": (
        svg('<path id="fence" d="M 0,0 24,0 24,14 Z"/>\n'
            '<g id="hut"><rect width="5" height="4"/></g>'),
        '--boundary … "fence" (line 2, 24 x 14 m) … "hut" (line 3, 5 x 4 m)',
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_names_the_element_its_line_and_what_is_wrong(tmp_path: Path, name: str) -> None:
    text, message = FAULTS[name]
    path = tmp_path / "plan.svg"
    path.write_text(text)
    check_says(refusal(path).removeprefix(str(path)), message)


OPTIONS = {
    "no units": (page('width="240" height="140"'), Options(), ":1: … units … --scale"),
    "too small": (svg(WALLS), Options(), "0.24 x 0.14 m … --scale"),
    "room for some": (inner(""), METRES.changed(robots=40), "'path' … room for … of 40"),
    "no room at the start": (
        svg('<path id="boundary" d="M 0,6 30,6 30,0 40,0 40,14 30,14 30,7.2 0,7.2 Z"/>\n'
            '<path id="path" d="M 0.5,6.6 38,6.6"/>'),
        METRES.changed(robot=(1.8, 1.1)),
        ":3: … 'path' … no room … 'boundary', line 2",
    ),
    "a wall that is not there": (
        svg('<path id="rim" d="M 0,0 24,0 24,14 Z"/>'), METRES.changed(boundary=("rims",)), '"rim"',
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_a_fault_of_a_drawing_with_its_options(tmp_path: Path, name: str) -> None:
    text, options, message = OPTIONS[name]
    path = tmp_path / "plan.svg"
    path.write_text(text)
    check_says(refusal(path, options).removeprefix(str(path)), message)


UNREAD = {
    "a share of the page": '<rect id="paper" width="100%" height="100%"/>',
    "a drawing within": '<svg id="icon" viewBox="0 0 9 9"><rect width="4" height="4"/></svg>',
    "path data": '<path id="scribble" d="M0,0 h"/>',
    "a transform": '<g id="icons" transform="turn(3)"><rect width="4" height="4"/></g>',
}


@pytest.mark.parametrize("what", UNREAD)
def test_what_is_not_read_matters_for_what_has_a_role_alone(tmp_path: Path, what: str) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(inner(UNREAD[what]))
    assert "left out" in " ".join(import_world(path, METRES).changes)
    name = UNREAD[what].split('id="')[1].split('"')[0]
    assert f'"{name}"' in refusal(path, METRES.changed(boundary=(name,)))


def test_names_of_shapes_cannot_act_on_a_terminal(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(svg('<path id="r&#x202e;m" d="M 0,0 24,0 24,14 Z"/>'))
    told = refusal(path)
    assert "\u202e" not in told
    assert "\\u202e" in told
