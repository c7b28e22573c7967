"""Pages by keyboard and by ear: all that acts has a name, tables a caption, the focus is seen."""

from __future__ import annotations

from collections.abc import Callable

from tests.drawing.browser.driver import Seen

Opened = Callable[..., Seen]
NAMELESS = """
    [...document.querySelectorAll("button, select, input, a, canvas[role]")]
      .filter((one) => !(one.getAttribute("aria-label") || one.innerText || one.labels?.length))
      .map((one) => one.outerHTML)"""
TABLES = """
    [...document.querySelectorAll("table")].filter((table) => table.offsetParent)
      .filter((table) => !table.caption || table.querySelector("th:not([scope])"))
      .map((table) => table.outerHTML.slice(0, 200))"""
FOCUS = """
    (({ activeElement: one }) => [
      one.id || one.getAttribute("aria-label") || one.innerText || one.labels?.[0].innerText,
      getComputedStyle(one).outlineStyle,
    ])(document)"""


def test_all_that_acts_has_a_name_and_all_tables_say_what_they_are(opened: Opened) -> None:
    for at in ("", "#t=2&robot=r2", "#t=1.9&contact=1"):
        seen = opened(hash=at)
        seen.settle()
        assert seen.ask("document.querySelectorAll('table').length") >= 3
        assert seen.ask(NAMELESS) == []
        assert seen.ask(TABLES) == []
        assert seen.page.locator("h1").count() == 1


def test_all_is_reached_by_the_tab_key_and_the_focus_is_seen(opened: Opened) -> None:
    seen = opened()
    reached: set[str] = set()
    for _ in range(60):
        seen.page.keyboard.press("Tab")
        what, outline = seen.ask(FOCUS)
        if what in reached or seen.ask("document.activeElement === document.body"):
            break  # once round
        reached.add(what)
        assert outline != "none", what
    assert {"scrub", "play", "to the start", "speed", "follow"} <= reached
    assert "robot to ask why" in reached
    assert any("shortest distance" in one for one in reached)
