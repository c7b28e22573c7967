"""Style sheets of a drawing: what a viewer shows is there, what it hides is left out and listed.

A browser is asked in tests/drawing/browser/test_sheets.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.helpers import inside
from tests.importing.plans import check_says
from tests.importing.test_as_meant import PATH, PILLAR, WALLS, svg

DEEPEST, MOST_SELECTORS = inside("physim.authoring.importing", "DEEPEST", "MOST_SELECTORS")

SEEN = {
    "an id before a class": ("#w {display:inline} .k {display:none}", 'id="w" class="k"', ""),
    "a class before a tag": (".k {display:inline} rect {display:none}", 'class="k"', ""),
    "the later rule": (".h {display:none} .k {display:inline}", 'class="k h"', ""),
    "its own attribute, of a hidden group": (
        ".h {visibility:hidden}", 'visibility="visible"', 'class="h"',
    ),
    "its own style, of a hidden group": (
        ".h {visibility:hidden}", 'style="visibility:visible"', 'class="h"',
    ),
    "its own style": (".h {display:none}", 'class="h" style="display:inline"', ""),
    "what is important": (
        ".k {display:inline !important} #w {display:none}", 'id="w" class="k"', "",
    ),
    "on paper": ("@media", 'class="h"', ""),
    "on paper, by its second rule": (
        "@media print {.z {fill:red} .h {display:none}} .z {fill:red}", 'class="h"', "",
    ),
    "later than what is conditional": (
        ".h {display:none} @media screen, tv {.z {fill:red} .h {display:inline}}", 'class="h"', "",
    ),
    "in a sequence of pictures": ("@keyframes k {from {opacity:0} 50% {opacity:0}}", "", ""),
    "what a string holds": (".z {fill:red; content:none}", 'class="h"', ""),
    "a string with a rule in it": (".z {content:'} .h {display:none}'}", 'class="h"', ""),
    "another kind of sheet": ('" type="text/less', 'class="h"', ""),
    "a name in other letters": (".H {display:none}", 'class="h"', ""),
}  # fmt: skip
HIDDEN = {
    "by a class": (".h {display:none}", 'class="h"', ""),
    "by an id": ("#w {visibility:hidden}", 'id="w"', ""),
    "an id before a class": ("#w {display:none} .k {display:inline}", 'id="w" class="k"', ""),
    "what is important": (
        ".k {display:none !important}", 'class="k" style="display:inline"', "",
    ),
    "with its group": (".h {display:none}", 'style="display:inline"', 'class="h"'),
    "by a tag": ("rect {opacity:0}", "", ""),
    "on paper it is shown": (
        ".h {display:none} @media print {.z {fill:red} .h {display:inline}}", 'class="h"', "",
    ),
    "an attribute that is important": ("", 'style="display:inline !important;opacity:0"', ""),
    "in a group that is not painted": (".h {fill:none}", "", 'class="h"'),
    "after a comment before a star": ("/* z */* {fill:red} .h {display:none}", 'class="h"', ""),
    "after a comment of stars": ("/***/ .h {display:none} /* .h {display:inline}", 'class="h"', ""),
    "by a rule that does not end": (".h {display:none", 'class="h"', ""),
    "by a name with escapes": (".\\68 {dis\\70lay:no\\6e e}", 'class="h"', ""),
    "with comments": (".h/**/{display/* */:/*x*/none/* */}", 'class="h"', ""),
    "before what is not valid": (".h {visibility:hidden; visibility:x}", 'class="h"', ""),
    "by itself, before a string": (
        "", "style=\"display:none; font-family:'a;display:inline'\"", "",
    ),
    "in letters of any size": (".h {DISPLAY:None}", 'class="h"', ""),
    "by an attribute in letters of any size": ("", 'visibility=" HIDDEN "', ""),
    "seen through": (".h {fill:rgb(0 0 0 / 0%)}", 'class="h"', ""),
    "not painted": (".h {fill:none; stroke:none}", 'class="h"', ""),
}  # fmt: skip


def imported(folder: Path, sheet: str, values: str, group: str, *, last: bool = False):
    style = f"<style>{sheet}</style>"
    if sheet == "@media":
        style = '<style media="print">.h {display:none}</style>'
    if sheet.startswith('"'):
        style = f'<style class="{sheet}">.h {{display:none}}</style>'
    obstacle = f'<g id="obstacle" {group}>{PILLAR.format(values)}</g>'
    path = folder / "plan.svg"
    parts = (WALLS, obstacle, style) if last else (style, WALLS, obstacle)
    path.write_text(svg("".join((*parts, PATH))))
    return import_world(path, Options(scale=1.0))


@pytest.mark.parametrize("last", [False, True], ids=["before", "after"])
@pytest.mark.parametrize("how", SEEN)
def test_what_shows_in_a_viewer_is_an_obstacle(tmp_path: Path, how: str, last: bool) -> None:
    found = imported(tmp_path, *SEEN[how], last=last)
    assert len(found.world.obstacles or ()) == 1
    assert not [one for one in found.changes if "hidden" in one]


@pytest.mark.parametrize("last", [False, True], ids=["before", "after"])
@pytest.mark.parametrize("how", HIDDEN)
def test_what_is_hidden_in_a_viewer_is_left_out_and_listed(
    tmp_path: Path, how: str, last: bool
) -> None:
    found = imported(tmp_path, *HIDDEN[how], last=last)
    assert not found.world.obstacles
    (one,) = (change for change in found.changes if "hidden" in change)
    check_says(one, "line … hidden … left out")


WORK = {
    "many selectors of one rule": (
        f"{','.join(f'.a{k}' for k in range(20_000))} {{{'fill:a;' * 20_000}}}", "<g/>",
    ),
    "a long value": (f"* {{fill:{'a' * 300_000}}}", "<g/>" * 20_000),
    "a long value that is passed on": (f"* {{clip-path:{'a ' * 300_000}}}", "<g/>" * 20_000),
    "many declarations": (f".a {{{'fill:none;' * 190_000}}}", ""),
    "rules for many media": (
        f"@media {','.join(f'x{k}' for k in range(20_000))} {{{'.a {fill:none}' * 20_000}}}", "",
    ),
    "rules within one of a long name": (f".{'a' * 300_000} {{{'b {fill:none}' * 40_000}}}", ""),
    "a value that nests": (f".a {{fill:{'rgb(' * 200_000}}}", ""),
}  # fmt: skip


@pytest.mark.parametrize("how", WORK)
def test_sheets_are_read_in_their_length(tmp_path: Path, how: str) -> None:
    """Hours, if each value were taken to each selector, and each selector to each element."""
    sheet, rest = WORK[how]
    path = tmp_path / "plan.svg"
    path.write_text(svg(f"<style>{sheet}</style>{WALLS}{PATH}{rest}"))
    assert import_world(path, Options(scale=1.0)).world.boundaries


def test_rules_nested_beyond_all_reason_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(svg(f"<style>{'@supports (a:b) {' * 3000}</style>{WALLS}{PATH}"))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), f"<style> … {DEEPEST} rules within")


def test_a_flood_of_styles_is_refused(tmp_path: Path) -> None:
    """Those that are the same are read once."""
    path = tmp_path / "plan.svg"
    long = "fill:red;" * 1000
    path.write_text(svg(f"{WALLS}{PATH}{f'<g style={long!r}/>' * 500}"))
    assert import_world(path, Options(scale=1.0)).world.boundaries
    styles = "".join(f"<g style='{long}opacity:{k}'/>" for k in range(500))
    path.write_text(svg(f"{WALLS}{PATH}{styles}"))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), "<g> … 2 million characters of style")


def test_a_flood_of_selectors_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    rules = "".join(f".a{k}{{fill:none}}" for k in range(MOST_SELECTORS + 1))
    path.write_text(svg(f"<style>{rules}</style>{WALLS}{PATH}"))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), f"<style> … {MOST_SELECTORS} selectors")


def test_an_element_without_an_id_has_none(tmp_path: Path) -> None:
    found = imported(tmp_path, "#None {display:none} .h {fill:none} #None {fill:red}", "", "")
    assert found.world.obstacles
    assert not imported(
        tmp_path, ".h {fill:none} #None {fill:red}", 'class="h"', ""
    ).world.obstacles


@pytest.mark.parametrize("how", ['display="none"', 'visibility="hidden"', 'opacity="0"'])
def test_rules_that_are_not_followed_may_not_show_what_attributes_hide(
    tmp_path: Path, how: str
) -> None:
    """Any rule comes before them; a style of the element's own is beyond it."""
    sheet = ".k.h {display:inline; visibility:visible; opacity:1}"
    with pytest.raises(ImportSourceError) as caught:
        imported(tmp_path, sheet, f'class="h k" {how}', "")
    key = how.partition("=")[0]
    check_says(str(caught.value), f'<rect> … hidden by its {key} … ".k.h" … may show')
    own = how.replace('="', ":").replace('"', "")
    assert not imported(tmp_path, sheet, f'class="h k" style="{own}"', "").world.obstacles


@pytest.mark.parametrize("rule", [".h {display:none}", ".z {fill:red} .h {display:none}"])
def test_rules_on_a_condition_may_not_hide(tmp_path: Path, rule: str) -> None:
    """A browser follows them or not, by its window."""
    with pytest.raises(ImportSourceError) as caught:
        imported(tmp_path, f"@media (min-width: 9px) {{{rule}}}", 'class="h"', "")
    check_says(str(caught.value), '<style> … "@media (min-width: 9px) .h" hides')


@pytest.mark.parametrize("how", ['style="display:none"', 'opacity="0"', 'class="h"'])
def test_a_drawing_that_is_hidden_is_refused(tmp_path: Path, how: str) -> None:
    path = tmp_path / "plan.svg"
    text = svg(f"<style>.h {{display:none}}</style>{WALLS}{PATH}")
    path.write_text(text.replace("<svg ", f"<svg {how} ", 1))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), "the whole drawing is hidden")


def test_rules_that_are_not_followed_may_not_show_what_others_hide(tmp_path: Path) -> None:
    with pytest.raises(ImportSourceError) as caught:
        imported(tmp_path, ".h {display:none} g > .k {display:inline}", 'class="h k"', "")
    check_says(str(caught.value), '<style> … "g > .k" … ".h" hides')


def test_entities_in_a_sheet_are_refused_where_they_are_declared(tmp_path: Path) -> None:
    path = tmp_path / "plan.svg"
    entity = '<!DOCTYPE svg [<!ENTITY a "display:none">]>'
    path.write_text(entity + svg(f"<style>.h {{&a;}}</style>{WALLS}{PATH}"))
    with pytest.raises(ImportSourceError) as caught:
        import_world(path, Options(scale=1.0))
    check_says(str(caught.value), "plan.svg:1 … XML entity")
