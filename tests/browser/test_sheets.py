"""What a style sheet hides of a drawing is what a browser does not show of it."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from physim.authoring.importing import Options, import_world

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
  return own.visibility === 'visible' && (own.fill !== 'none' || own.stroke !== 'none');
}).map(one => one.id)"""
"""Ids of what is to be seen, by the styles that the browser computes"""
WALLS = '<path class="z" id="boundary" d="M 0,0 24,0 24,14 0,14 Z"/>'
PAINTED = (
    'style="display:inline !important;visibility:visible !important;opacity:1 !important;'
    'stroke:black !important"'
)


def drawing(rng: random.Random) -> str:
    rules = [f"{rng.choice(SELECTORS)} {{{rng.choice(BODIES)}}}" for _ in range(rng.randint(1, 6))]
    half = rng.randint(0, len(rules))
    pillars = [
        f'<g {rng.choice(OWN)}><rect id="r{k}" {rng.choice(OWN)} x="{2 + 2 * k}" y="10" '
        'width="1" height="1"/></g>'
        for k in range(8)
    ]
    # walls and path are no rectangles, and shown whatever is said of all
    seen = 'style="display:inline !important;visibility:visible !important;opacity:1 !important"'
    walls = WALLS.replace('class="z"', PAINTED)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 14" '
        f"{seen}><style>{' '.join(rules[:half])}</style>{walls}"
        f'<g id="obstacle" {seen}>{"".join(pillars)}</g><style>{" ".join(rules[half:])}</style>'
        f'<path id="path" {PAINTED} d="M 2,7 L 20,7"/></svg>'
    )


@pytest.mark.parametrize("seed", range(5))
def test_what_sheets_hide_is_what_a_browser_hides(browser: Any, tmp_path: Path, seed: int) -> None:
    rng, hidden = random.Random(seed), 0
    page = browser.new_page()
    for _ in range(40):
        text = drawing(rng)
        page.set_content(text)
        shown = page.evaluate(SHOWN)
        path = tmp_path / "plan.svg"
        path.write_text(text)
        imported = import_world(path, Options(scale=1.0))
        places = [min(float(x) for x, _ in one) for one in imported.world.obstacles or ()]
        assert sorted(f"r{round(x / 2.0) - 1}" for x in places) == sorted(shown), text
        hidden += 8 - len(shown)
    page.close()
    assert 80 < hidden < 300
