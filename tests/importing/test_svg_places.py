"""Faults of a drawing name the element and the line; values that cannot be meant are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.importing.plans import check_says, svg

WALLS = '<path id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PATH = '<path id="path" d="M 2,7 L 20,7"/>'
METRES = Options(scale=1.0)


def page(values: str) -> str:
    return svg(f"{WALLS}\n{PATH}", values)


def shape(tag: str, values: str) -> str:
    """A drawing with an obstacle named pillar in line 3."""
    return svg(f'{WALLS}\n<{tag} id="obstacle pillar" {values}/>\n{PATH}')


FAULTS = {
    "viewBox without extent": (page('viewBox="0 0 0 0"'), ':1: … <svg> … "0 0 0 0" … 0'),
    "viewBox without width": (page('viewBox="0 0 0 14"'), ':1: … viewBox="0 0 0 14" … above 0'),
    "viewBox negative": (page('viewBox="0 0 -24 14"'), ':1: … viewBox="0 0 -24 14" … above 0'),
    "viewBox of three": (page('viewBox="0 0 24"'), ':1: … viewBox="0 0 24" … four numbers'),
    "viewBox of words": (page('viewBox="a b c d"'), ':1: … viewBox="a b c d" … four numbers'),
    "page width with a blank": (page('width="9 mm" viewBox="0 0 24 14"'), ':1: … "9 mm" … 240mm'),
    "no page width": (page('width="0mm" viewBox="0 0 24 14"'), ':1: … width="0mm" … above 0'),
    "page width": (page('width="wide" viewBox="0 0 24 14"'), ':1: … width="wide" … 240mm'),
    "page height": (page('height="-1cm" viewBox="0 0 24 14"'), ':1: … height="-1cm" … above 0'),
    "stretched page": (
        "<!-- a\nplan -->\n"
        + page('width="240mm" height="240mm" viewBox="0 0 24 14" preserveAspectRatio="none"'),
        ":3: … <svg> … width … height … viewBox",
    ),
    "path of words": (shape("path", 'd="M 2,7 L x y"'), ':3: … pillar … path data … "x y"'),
    "path without a move": (shape("path", 'd="L 2,7"'), ':3: … pillar … path data … "L 2,7"'),
    "place": (shape("rect", 'x="a" y="6" width="1" height="1"'), ':3: … pillar … x="a"'),
    "unit": (shape("circle", 'cx="10" cy="6" r="1em"'), ':3: … pillar … r="1em" … mm'),
    "negative width": (shape("rect", 'width="-1" height="1"'), ':3: … pillar … width="-1"'),
    "negative radius": (shape("circle", 'r="-1"'), ':3: … pillar … r="-1" … negative'),
    "odd points": (shape("polygon", 'points="1,2 3"'), ":3: … pillar … 3 numbers … pairs"),
    "points of words": (shape("polyline", 'points="1,2 x"'), ':3: … pillar … points: … "x"'),
    "flat": (shape("rect", 'transform="scale(1,0)"'), ':3: … pillar … "scale(1,0)" … 0'),
    "flat matrix": (
        svg(f'<g id="floor" transform="matrix(1,1,1,1,0,0)">{WALLS}</g>{PATH}'),
        ':2: … floor … "matrix(1,1,1,1,0,0)" … determinant',
    ),
    "path through an obstacle": (
        shape("rect", 'x="10" y="6" width="1" height="2"'),
        ":4: … 'path' … 'obstacle pillar', line 3 … (10.00, 7.00)",
    ),
    "obstacle that crosses itself": (
        shape("polygon", 'points="10,6 12,8 12,6 10,8"'), ":3: … 'obstacle pillar' … itself",
    ),
    "obstacle without area": (
        shape("polygon", 'points="10,6 12,6 14,6"'), ":3: … 'obstacle pillar' … area",
    ),
    "obstacle over everything": (
        shape("rect", 'x="-1" y="-1" width="30" height="30"'),
        ":3: … 'obstacle pillar' … whole area",
    ),
    "robot of a line": (
        svg(f'{WALLS}\n{PATH}\n<polyline id="robot r7" points="3,6 5,6"/>'),
        ":4: … 'robot r7' … area",
    ),
    "robot that crosses itself": (
        svg(f'{WALLS}\n{PATH}\n<polygon id="robot r7" points="3,6 5,7 5,6 3,7"/>'),
        ":4: … 'robot r7' … itself",
    ),
    "path outside": (svg(f'{WALLS}\n<path id="path" d="M 30,7 50,7"/>'), ":3: … 'path' … no area"),
    "ends of walls": (
        svg(
            '<path id="boundary a" d="M 0,14 0,0 24,0"/>\n'
            '<path id="boundary b" d="M 24,3 24,14 8,14"/>\n<path id="boundary c" d="M 9,0 9,4"/>'
        ),
        ":2: … 'boundary a' … (24.00, 14.00) … (24.00, 11.00) … 'boundary b', line 3 … 3 m apart",
    ),
    "no room at the start": (
        svg(
            '<path id="boundary" d="M 0,6 30,6 30,0 40,0 40,14 30,14 30,7.2 0,7.2 Z"/>\n'
            '<path id="path" d="M 0.5,6.6 38,6.6"/>'
        ),
        ":3: … 'path' … no room … 'boundary', line 2",
    ),
    "room for some": (
        svg(f"{WALLS}\n{PATH}"), ":3: … 'path' … room for … of 40 … 'boundary', line 2",
    ),
    "robots over each other": (
        svg(
            f"{WALLS}\n{PATH}\n"
            '<rect id="robot a" x="3" y="6" width="2" height="1"/>\n'
            '<rect id="robot b" x="4" y="6" width="2" height="1"/>'
        ),
        ":5: … 'robot b' … cannot run … robots[1]",
    ),
    "robot in a wall": (
        svg(f'{WALLS}\n{PATH}\n<rect id="robot a" x="-1" y="6" width="2" height="1"/>'),
        ":4: … 'robot a' … cannot run … boundaries[0]",
    ),
    "what could be a boundary": (
        svg(
            '<path id="fence" d="M 0,0 24,0 24,14 Z"/>\n'
            '<g id="hut"><rect width="5" height="4"/></g>'
        ),
        '--boundary … "fence" (line 2, 24 x 14 m) … "hut" (line 3, 5 x 4 m)',
    ),
}  # fmt: skip


OPTIONS = {
    "no room at the start": METRES.changed(robot=(1.8, 1.1)),
    "room for some": METRES.changed(robots=40),
}


@pytest.mark.parametrize("text", FAULTS)
def test_a_fault_names_the_element_its_line_and_what_is_wrong(tmp_path, text):
    path = tmp_path / "plan.svg"
    path.write_text(FAULTS[text][0])
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, OPTIONS.get(text, METRES))
    check_says(str(caught.value).removeprefix(str(path)), FAULTS[text][1])


@pytest.mark.parametrize(
    "colour",
    [
        "fill='rgb(1.5,2,3)'",
        "stroke='rgb(1e3,2,3)'",
        "style='fill: rgb(1.5, 2, 3); display: inline'",
    ],
)
def test_a_shape_keeps_its_place_whatever_its_colour(tmp_path, colour):
    path = tmp_path / "plan.svg"
    path.write_text(shape("rect", f'x="10" y="10" width="1" height="1" {colour}'))
    (ring,) = import_world(path, METRES).world.obstacles
    assert sorted({x for x, _ in ring}) == [10.0, 11.0]


@pytest.mark.parametrize(
    ("tag", "values"),
    [("rect", 'x="10" y="10" width="0" height="1"'), ("circle", 'cx="10" cy="10" r="0"')],
)
def test_a_shape_that_draws_nothing_is_told(tmp_path, tag, values):
    path = tmp_path / "plan.svg"
    path.write_text(shape(tag, values))
    made = import_world(path, METRES)
    assert not made.world.obstacles
    (told,) = [one for one in made.changes if "pillar" in one]
    check_says(told, f"line 3: … <{tag}> … left out")


def test_shapes_out_of_sight_are_no_fault(tmp_path):
    path = tmp_path / "plan.svg"
    text = shape("rect", 'x="12" y="10" width="1" height="1"')
    path.write_text(text.replace("</svg>", '<defs><rect width="-1" height="1"/></defs>\n</svg>'))
    assert not [one for one in import_world(path, METRES).changes if "nothing" in one]


def test_what_a_style_sheet_hides_is_left_out(tmp_path):
    path = tmp_path / "plan.svg"
    text = shape("rect", 'class="a b" x="10" y="10" width="1" height="1"')
    sheet = "<style>/* all { */ .c, .b {fill: red; display: none !important}</style>"
    for rules, count in ((sheet, 0), (sheet.replace(".b", ".d"), 1)):
        path.write_text(text.replace("<rect", f"{rules}<rect", 1))
        assert len(import_world(path, METRES).world.obstacles) == count


@pytest.mark.parametrize("copied", [False, True])
def test_transforms_count_for_every_shape_that_they_move(tmp_path, copied):
    path = tmp_path / "plan.svg"
    turn, many = "rotate(1)" * 1000, '<use href="#one"/>' if copied else '<rect width="1"/>'
    text = f'<g id="{"one" if copied else "all"}" transform="{turn}"><rect width="1"/>'
    text += f"</g>{many * 200}" if copied else f"{many * 200}</g>"
    path.write_text(shape("rect", 'width="1" height="1"').replace("</svg>", f"{text}</svg>"))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, METRES)
    check_says(str(caught.value), "transforms … 150000")


PILLAR = '<rect x="10" y="10" width="1" height="1"/>'
OTHER = '<rect x="15" y="10" width="1" height="1"/>'


def obstacles(tmp_path, inner):
    """Least x [m] of every obstacle of a drawing with these elements in its group obstacle."""
    path = tmp_path / "plan.svg"
    path.write_text(svg(f'{WALLS}\n<g id="obstacle">{inner}</g>\n{PATH}'))
    made = import_world(path, METRES)
    return sorted(min(x for x, _ in ring) for ring in made.world.obstacles or ()), made.changes


@pytest.mark.parametrize(
    "tag",
    ["mask", "marker", "symbol", "clipPath", "pattern", "defs", "flowRoot", "foreignObject"],
)
def test_what_is_drawn_elsewhere_if_at_all_is_no_obstacle(tmp_path, tag):
    hidden = f'<{tag} id="it">{PILLAR}</{tag}>'
    assert obstacles(tmp_path, hidden + OTHER)[0] == [15.0]
    assert obstacles(tmp_path, f"<g>{hidden}</g>{OTHER}")[0] == [15.0]


@pytest.mark.parametrize("around", ["{}", "<defs>{}</defs>", "<g>{}</g>"])
def test_a_symbol_is_drawn_where_it_is_copied(tmp_path, around):
    symbol = around.format(f'<symbol id="it">{PILLAR}</symbol>')
    copies = '<use href="#it" x="2"/><use xlink:href="#it" x="5"/>'
    assert obstacles(tmp_path, symbol + copies)[0] == [12.0, 15.0]


@pytest.mark.parametrize("tag", ["mask", "marker"])
def test_a_copy_of_what_is_never_drawn_is_not_drawn(tmp_path, tag):
    inner = f'<{tag} id="it">{PILLAR}</{tag}><use href="#it" x="2"/>'
    assert obstacles(tmp_path, inner)[0] == []


CUT = {
    "attribute": ('clip-path="url(#k)"', "line 3: … <rect> … room … clip-path … whole"),
    "style": ('style="fill:red;mask:url(#k)"', "line 3: … <rect> … room … mask … whole"),
    "sheet": ('class="half"', "its clip-path … whole"),
    "filter": ('filter="url(#k)"', "line 3: … <rect> … room … filter … whole"),
    "another name": ('style="-webkit-mask-image:url(#k)"', "line 3: … its mask … whole"),
    "unknown": ('style="content-visibility:hidden"', "line 3: … content-visibility … whole"),
    "none": ('clip-path="none" style="mask: none;filter:none;font-size:3px;-inkscape-x:y"', ""),
}


@pytest.mark.parametrize("how", CUT)
def test_a_shape_that_is_cut_is_taken_whole_and_told(tmp_path, how):
    values, told = CUT[how]
    sheet = "<style>.half {clip-path: url(#k)} .no {mask: none}</style>"
    inner = sheet + PILLAR.replace("<rect", f'<rect id="room" {values}')
    found, changes = obstacles(tmp_path, inner + OTHER)
    assert found == [10.0, 15.0]
    said = [one for one in changes if "whole" in one]
    assert len(said) == bool(told)
    for one in said:
        check_says(one, told)


def test_a_group_or_copy_that_is_cut_is_told_once_and_not_where_it_is_left_out(tmp_path):
    cut = '<{} id="{}" clip-path="url(#k)"'
    group = f"{cut.format('g', 'floor')}>{PILLAR}{OTHER}</g>"
    symbol = f'<symbol id="it" overflow="visible">{PILLAR}</symbol>'
    copy = f'{cut.format("use", "there")} href="#it" x="8"/>'
    found, changes = obstacles(tmp_path, f"{group}{symbol}{copy}")
    assert found == [10.0, 15.0, 18.0]
    said = [one for one in changes if "whole" in one]
    assert [name for name in ("floor", "there") for one in said if name in one] == [
        "floor", "there",
    ]  # fmt: skip
    assert len(said) == 2
    outside = f"</g>{cut.format('g', 'floor')}>{PILLAR}</g><g>"
    assert not [one for one in obstacles(tmp_path, outside)[1] if "whole" in one]


def test_all_that_cuts_a_shape_is_told(tmp_path):
    cut = '<g clip-path="url(#c)"><g mask="url(#m)">{}</g></g>'
    _, changes = obstacles(tmp_path, cut.format(PILLAR.replace("<rect", '<rect filter="url(#f)"')))
    told = [one for one in changes if "whole" in one]
    assert [key for key in ("clip-path", "mask", "filter") for one in told if key in one] == [
        "clip-path", "mask", "filter",
    ]  # fmt: skip


def test_of_a_switch_one_alternative_is_drawn(tmp_path):
    """The first that needs no extension, as programs draw it; the others are told."""
    foreign = '<foreignObject requiredExtensions="http://example.org/"><p/></foreignObject>'
    foreign += '<i:x xmlns:i="urn:i"/>'  # nor is what is no SVG
    found, changes = obstacles(
        tmp_path, f"<switch>{foreign}<g>{PILLAR}</g><g>{OTHER}</g></switch>{OTHER}"
    )
    assert found == [10.0, 15.0]
    assert len([one for one in changes if "hidden <g>" in one]) == 1
    assert obstacles(tmp_path, f"<switch>{OTHER}{PILLAR}</switch>")[0] == [15.0]


@pytest.mark.parametrize("tag", ["polygon", "polyline"])
@pytest.mark.parametrize(
    ("points", "corners"),
    [
        ("9 4 12.5.5 10 5", [(9, 4), (12.5, 0.5), (10, 5)]),
        ("+9+4+12+.5+10+5", [(9, 4), (12, 0.5), (10, 5)]),
        ("9,4-12e-1.5,10 5", [(9, 4), (-1.2, 0.5), (10, 5)]),
    ],
)
def test_numbers_of_points_need_no_gap(tmp_path, tag, points, corners):
    path = tmp_path / "plan.svg"
    moved = f'<g transform="translate(5,0)"><{tag} points="{points}"/></g>'
    path.write_text(svg(f'{WALLS}\n<g id="obstacle">{moved}</g>\n{PATH}'))
    (found,) = import_world(path, METRES).world.obstacles
    assert set(found) == {(round(x + 5.0, 3), round(14.0 - y, 3)) for x, y in corners}


@pytest.mark.parametrize("unit", ["mm", "cm", "in", "pt", "pc"])
def test_units_may_be_in_capitals(tmp_path, unit):
    """Of a page and of its shapes."""
    path, box, found = tmp_path / "plan.svg", 'y="9" width="1" height="1"', set()
    for one in (unit, unit.upper(), unit.title()):
        inner = f'{WALLS}\n<g id="obstacle"><rect x="0.1{one}" {box}/></g>\n{PATH}'
        path.write_text(svg(inner, f'width="24000{one}" height="14000{one}" viewBox="0 0 24 14"'))
        world = import_world(path, Options()).world
        found.add((world.boundaries, world.obstacles))
    assert len(found) == 1


@pytest.mark.parametrize(
    "inner",
    [
        f'<use href="#q">{OTHER}</use>',
        f'<path d="M10,10h1v1z">{OTHER}</path>',
        PILLAR + OTHER.replace("<rect", '<rect requiredExtensions=""'),
        PILLAR + OTHER.replace("<rect", '<rect xmlns=""'),
    ],
)
def test_what_no_browser_draws_is_no_obstacle(tmp_path, inner):
    assert obstacles(tmp_path, f"<defs><g id='q'>{PILLAR}</g></defs>{inner}")[0] == [10.0]


@pytest.mark.parametrize(
    ("inner", "at"),
    [
        (f'<g x="4" cx="3" r="2" rx="1">{PILLAR}<circle cx="18" cy="10" r="1"/></g>', [10.0, 17.0]),
        (f'<defs><g id="q">{PILLAR}</g></defs><g x="4"><use href="#q"/></g>', [10.0]),
        ('<defs><rect id="q" width="9" height="2"/></defs><use href="#q" x="4"/>', [4.0]),
    ],
)
def test_where_its_lines_lie_is_said_by_each_element_alone(tmp_path, inner, at):
    assert obstacles(tmp_path, inner)[0] == pytest.approx(at, abs=0.02)


@pytest.mark.parametrize(
    ("moves", "said"),
    [
        ('<set attributeName="x" to="9"/>', "<set>"),
        ('<defs><set href="#a" attributeName="x" to="9"/></defs>', "<set>"),
        ('<g display="none"><set href="#a" attributeName="x" to="9"/></g>', "<set>"),
        ("<script>document.x = 3</script>", "<script>"),
        ('<g onload="document.x = 3"/>', "its onload"),
        ('<h:img xmlns:h="http://www.w3.org/1999/xhtml" onerror="x()"/>', "its onerror"),
        ('<h:script xmlns:h="http://www.w3.org/1999/xhtml">document.x = 3</h:script>', "<script>"),
        ("<style>#a{animation:blink 2s}</style>", "its animation"),
        ("<style>#a{ANIM\\41 tion-/**/Name/**/ : blink}</style>", ""),
        ("<style>#a{ANIM\\41 tion-Name/**/ : blink}</style>", "its animation-name"),
        ("<style>g #a{-webkit-animation/**/:blink 2s}</style>", "-webkit-animation"),
        ("<style>rect{transition:none}</style>", ""),
    ],
)
def test_what_changes_as_time_goes_by_is_told_and_taken_as_it_stands(tmp_path, moves, said):
    found, changes = obstacles(tmp_path, PILLAR.replace("<rect", '<rect id="a"') + OTHER + moves)
    assert found == [10.0, 15.0]
    told = [one for one in changes if " followed" in one or "not applied" in one]
    assert len(told) == bool(said)
    assert all(said in one for one in told)
    assert not [one for one in changes if "hidden" in one and "hidden <g>" not in one]


@pytest.mark.parametrize(
    ("paint", "told"),
    [
        ('fill="currentColor"', "depends"),
        ('style="fill:var(--x)"', "depends"),
        ('fill="oklch(what)"', "depends"),
        ('style="fill-opacity:calc(0*1)"', "depends"),
        ('fill="currentColor" stroke="red"', ""),
        ('fill="url(#x)"', ""),
    ],
)
def test_a_shape_that_may_be_seen_through_is_taken_which_is_told(tmp_path, paint, told):
    found, changes = obstacles(tmp_path, PILLAR.replace("<rect", f"<rect {paint}") + OTHER)
    assert found == [10.0, 15.0]
    said = [one for one in changes if "depends" in one]
    assert len(said) == bool(told)
    for one in said:
        check_says(one, "line 3: … <rect> … taken")


def test_a_wall_that_no_browser_draws_is_taken_which_is_told(tmp_path):
    """By its layer: it has neither line nor area, as nothing is said of a line."""
    path = tmp_path / "plan.svg"
    wall = '<g id="boundary"><path id="rim" {} d="M 0,14 H 24"/></g>'
    rest = '<path id="boundary rest" d="M 24,14 V 0 H 0 V 14"/>'
    for line, count in (("", 1), ('stroke="black"', 0)):
        path.write_text(svg(f"{wall.format(line)}\n{rest}\n{PATH}"))
        said = [one for one in import_world(path, METRES).changes if "stroke" in one]
        assert len(said) == count
        for one in said:
            check_says(one, "line 2: … rim … no line (stroke) … taken")


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("wallpaper", False), ("pathcollection_1", False), ("robotics", False), ("path_12", False),
        ("path-copy-2", False), ("obstacle_12", True), ("obstacle2", True), ("obstacleA", True),
        ("Obstacles", True), ("obstacle-left", True),
    ],
)  # fmt: skip
def test_names_of_roles_are_words_of_their_own(tmp_path, name, role):
    path = tmp_path / "plan.svg"
    path.write_text(svg(f"{WALLS}\n{PILLAR.replace('<rect', f'<rect id={name!r}')}\n{PATH}"))
    made = import_world(path, METRES)
    assert bool(made.world.obstacles) == role
    assert bool([one for one in made.changes if "in no layer" in one]) != role


@pytest.mark.parametrize("sized", ["", 'width="2"', 'style="overflow:visible"'])
def test_copies_of_a_symbol_are_taken_whole_which_is_told_unless_they_are_seen_whole(
    tmp_path, sized
):
    """A browser cuts them at the edge of the symbol, which may be anywhere."""
    symbol = f'<symbol id="it" {sized}>{PILLAR}</symbol>'
    found, changes = obstacles(tmp_path, f'{symbol}<use href="#it" x="2"/>')
    assert found == [12.0]
    said = [one for one in changes if "edge" in one]
    assert len(said) == ("visible" not in sized)
    for one in said:
        check_says(one, "line 3: … <symbol> … it … edge … not applied")


@pytest.mark.parametrize(
    ("inner", "seen"),
    [
        ("<switch><g/><g id='q'>{}</g></switch>", "switch"),
        ("<path d='M0,0h1'><g id='q'>{}</g></path>", "shape"),
        ("<g requiredExtensions='urn:x' id='q'>{}</g>", "copy"),
    ],
)
def test_copies_of_what_is_hidden_by_where_it_stands_are_refused(tmp_path, inner, seen):
    with pytest.raises(ImportSourceError) as caught:
        obstacles(tmp_path, f'{inner.format(PILLAR)}<use href="#q"/>')
    check_says(str(caught.value), f':3: … "q" … copied … {seen} … <defs>')


PLACE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="40" height="24"
 viewBox="0 0 40 24">
<g inkscape:label="boundary"><rect x="1" y="1" width="38" height="22"/></g>
<g inkscape:label="path">{paths}</g>
<g inkscape:label="robot"><rect id="one" inkscape:label="{first}" x="4" y="4.5" width="1.8"
 height="1"/>{second}</g></svg>"""
WAYS = """<path inkscape:label="path ann" d="M 3 5 L 37 5"/>
<path inkscape:label="path bob" d="M 3 12 L 30 20"/>"""
COPY = '<use xlink:href="#one" inkscape:label="{}" transform="translate(0,7)"/>'


@pytest.mark.parametrize(
    ("paths", "first", "second"),
    [
        (WAYS, "ann", COPY.format("bob")),
        (WAYS, "robot ann", COPY.format("robot bob")),
        (WAYS, "ann", '<g inkscape:label="bob"><rect x="4" y="11.5" width="1.8" height="1"/></g>'),
        (WAYS.replace('<path inkscape:label="path bob" d="M 3 12 L 30 20"/>',
                      '<g inkscape:label="bob"><path d="M 3 12 L 30 20"/></g>'),
         "ann", COPY.format("bob")),
    ],
    ids=["copy", "copy with a role", "group", "path in a group"],
)  # fmt: skip
def test_copies_and_groups_have_names_of_their_own(
    tmp_path: Path, paths: str, first: str, second: str
) -> None:
    """Not that of what they copy; by it a robot follows its own path."""
    file = tmp_path / "d.svg"
    file.write_text(PLACE.format(paths=paths, first=first, second=second))
    world = import_world(file, Options(scale=1.0)).world
    assert [robot.name for robot in world.robots] == ["ann", "bob"]
    ends = [np.asarray(world.reference_path if not isinstance(one.path, tuple) else one.path)[-1]
            for one in world.robots]  # fmt: skip
    assert ends[0][1] == pytest.approx(19.0, abs=0.1)  # y points up
    assert ends[1][1] < 6.0


def test_a_copy_has_the_role_that_it_is_given(tmp_path: Path) -> None:
    file = tmp_path / "d.svg"
    obstacle = COPY.format("obstacle 1").replace("(0,7)", "(14,8)")
    file.write_text(PLACE.format(paths=WAYS, first="robot ann", second=obstacle))
    world = import_world(file, Options(scale=1.0)).world
    assert ([robot.name for robot in world.robots], len(world.obstacles)) == (["ann"], 1)
