"""Style sheets of a drawing: what a viewer shows is there, what it hides is left out and listed.

A browser is asked in tests/browser/test_sheets.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world
from tests.importing.plans import check_says
from tests.importing.test_as_meant import PATH, PILLAR, WALLS, svg

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
    "not painted": (".h {fill:none; stroke:none}", 'class="h"', ""),
}  # fmt: skip


def imported(folder: Path, sheet: str, values: str, group: str, *, last: bool = False):
    style = f"<style>{sheet}</style>"
    if sheet == "@media":
        style = '<style media="print">.h {display:none}</style>'
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
