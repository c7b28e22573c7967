"""What a style sheet hides of a drawing is what a browser does not show of it."""

from __future__ import annotations

import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world

SELECTORS = ("*", "rect", "g", ".a", ".b", ".c", "rect.a", "rect.b", "#r0", "#r3", ".a, #r5")
BODIES = (
    "display: none", "display: inline", "display: none !important", "display: inline !important",
    "visibility: hidden", "visibility: visible", "visibility: collapse !important",
    "visibility: visible !important", "opacity: 0", "opacity: 1; display: inline", "fill: red",
    "fill: none", "fill: none; stroke: none", "stroke: red", "fill: none !important",
)  # fmt: skip
OWN = (
    "", 'class="a"', 'class="b a"', 'class="a b c"', 'class="c"', 'style="display:inline"',
    'display="none"', 'visibility="visible"', 'style="visibility:hidden !important" class="b"',
    'class="c" style="visibility:visible"', 'style="opacity:1" class="a"', 'fill="none"',
    'fill="none" stroke="blue" class="a"', 'style="stroke:inherit;fill:none"',
)  # fmt: skip
SHOWN = """[...document.querySelectorAll('rect')].filter(one => {
  for (let at = one; at instanceof SVGElement; at = at.parentElement) {
    const style = getComputedStyle(at);
    if (style.display === 'none' || style.opacity === '0') return false;
  }
  const own = getComputedStyle(one);
  const unseen = ['none', 'rgba(0, 0, 0, 0)'];
  const painted = !unseen.includes(own.fill) || !unseen.includes(own.stroke);
  return own.visibility === 'visible' && painted;
}).map(one => one.id)"""
"""Ids of what is to be seen, by the styles that the browser computes"""
ODD = (
    ".\\61 {display:none}", ".a\\{display:none}", "#r\\30 {display:none}", ".a/**/{display:none}",
    ".a{display/**/:none}", ".a{display:no/**/ne}", ".a{display:none;display:bogus}",
    ".a{fill:none;fill:bogus}", ".a{fill:none;fill:#12}", ".a{fill:none;fill:#123}",
    ".a{fill:none;fill:rgb(1,2,3)}", ".a{fill:transparent}", ".a{fill:rgba(0,0,0,0)}",
    ".a{fill:#0000}", ".a{fill:url(#x)}", ".a{fill:url(#x) none}", ".a{fill:url('x;y') red}",
    ".a{fill:none;fill:hsl(120deg 50% 50%)}", ".a{fill:none;fill:color-mix(in srgb, red, blue)}",
    ".a{fill:none;fill:RED}", ".a{fill:none;fill:context-fill}", ".a{fill:none;fill:inherit}",
    ".a{fill:none;fill:unset}", ".a{fill:none;fill:initial}", ".a{fill:none;fill:red blue}",
    ".a{stroke:none;fill:none;stroke:initial}", ".a{display:contents}", ".a{display:block flow}",
    ".a{display:none none}", ".a{display:NONE}", ".a{display:'none'}", ".a{visibility:Hidden}",
    ".a{visibility:hidden visible}", ".a{opacity:0%}", ".a{opacity:.0}", ".a{opacity:-1}",
    ".a{opacity:0px}", ".a{opacity:0;opacity:x}", ".a{display:none!important}",
    ".a{display:none ! important;display:inline}", ".a{display:none !importan}",
    "@media screen{.a{display:none}}", "@media PRINT{.a{display:none}}",
    "@media print{@media screen{.a{display:none}}}", "@media {.a{display:none}}",
    "@media screen{@media print{.a{display:none}} .b{display:none}}", "@layer x; .a{display:none}",
    "@keyframes k{from{display:none}} .b{display:none}", "@font-face{font-family:x;display:none}",
    "@import url(x.css); .a{display:none}", "@page{display:none}", "@foo; .a{display:none}",
    "@namespace url(http://www.w3.org/1999/xhtml); rect{display:none}", ".a{.b{display:none}}",
    ".a{fill:'x} .b{display:none}", ".a{fill:'x\n;display:none} .b{display:none}",
    "<!-- .a{display:none} -->", "/* .a{display:none}", "/* */ .a{display:none} /* */",
    ".a , .b{display:none}", ".a,.b:bogus{display:none}", "RECT{display:none}", ".A{display:none}",
    ".1a{display:none}", ".-a{display:none}", "\\.a{display:none}", ".a{;display:none}",
    ".a{x;display:none}", ".a{x:;display:none}", ".a{*display:none}", ".a{display:none;}b{",
    ".a{--display:none}", ".a{display:n\\6fne}", ".a{display:none} .a{display:}",
    ".a{all:unset}", ".b{fill:none} .a{all:unset}", ".a{display:none;all:initial}",
    ".a{fill:none;fill:rgb(0 0 0 / 50%)}", ".a{fill:none;fill:red;x:'",
    "@media screen{.a{display:none",
    ".a\u00a0{display:none}", ".a{fill:none;fill:red!}", ".a{content-visibility:hidden}",
)  # fmt: skip
"""Style sheets that are seldom written so"""
ELEMENTS = (
    ("", 'class="a"'), ("", 'class="b"'), ("", 'class="a b"'), ("", ""), ('class="a"', ""),
    ('fill="none"', 'class="a"'), ("", 'class="a" fill="none"'),
    ("", 'class="a" visibility="hidden"'),
)  # fmt: skip
"""Of a group, and of what is in it"""
WALLS = '<path class="z" id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PAINTED = (
    'style="display:inline !important;visibility:visible !important;opacity:1 !important;'
    'stroke:black !important"'
)


def drawing(rng: random.Random) -> str:
    rules = [f"{rng.choice(SELECTORS)} {{{rng.choice(BODIES)}}}" for _ in range(rng.randint(1, 6))]
    half = rng.randint(0, len(rules))
    elements = [(rng.choice(OWN), rng.choice(OWN)) for _ in range(8)]
    return drawn(" ".join(rules[:half]), elements, " ".join(rules[half:]))


def drawn(sheet: str, elements: Sequence[tuple[str, str]], last: str) -> str:
    pillars = [
        f'<g {group}><rect id="r{k}" {own} x="{2 + 2 * k}" y="10" width="1" height="1"/></g>'
        for k, (group, own) in enumerate(elements)
    ]
    # walls and path are no rectangles, and shown whatever is said of all
    seen = 'style="display:inline !important;visibility:visible !important;opacity:1 !important"'
    walls = WALLS.replace('class="z"', PAINTED)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 14" '
        f"{seen}><style>{escape(sheet)}</style>{walls}"
        f'<g id="obstacle" {seen}>{"".join(pillars)}</g><style>{escape(last)}</style>'
        f'<path id="path" {PAINTED} d="M 2,7 L 20,7"/></svg>'
    )


def taken(path: Path) -> list[str]:
    """Ids of the rectangles that are obstacles."""
    world = import_world(path, Options(scale=1.0)).world
    places = [min(float(x) for x, _ in one) for one in world.obstacles or ()]
    return sorted(f"r{round(x / 2.0) - 1}" for x in places)


@pytest.mark.parametrize("seed", range(5))
def test_what_sheets_hide_is_what_a_browser_hides(browser: Any, tmp_path: Path, seed: int) -> None:
    rng, hidden = random.Random(seed), 0
    page = browser.new_page()
    for _ in range(40):
        text = drawing(rng)
        path = tmp_path / "plan.svg"
        path.write_text(text)
        page.goto(path.as_uri())
        shown = page.evaluate(SHOWN)
        assert taken(path) == sorted(shown), text
        hidden += 8 - len(shown)
    page.close()
    assert 80 < hidden < 300


def test_odd_sheets_are_followed_or_refused(browser: Any, tmp_path: Path) -> None:
    refused, page, path = 0, browser.new_page(), tmp_path / "plan.svg"
    for sheet in ODD:
        path.write_text(drawn(sheet, ELEMENTS, ""), encoding="utf-8")
        page.goto(path.as_uri())
        try:
            found = taken(path)
        except ImportSourceError:
            refused += 1
        else:
            assert found == sorted(page.evaluate(SHOWN)), sheet
    page.close()
    assert refused <= 15  # for what is said of all properties, and odd words of display
