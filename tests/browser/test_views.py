"""Copies of symbols with a view of their own lie where a browser draws them."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim.authoring.importing import ImportSourceError, Options, import_world

SYMBOLS = ('viewBox="0 0 20 10"', 'viewBox="-36 -36 72 72"', 'viewBox="5,5 8 30"')
RATIOS = ("", "none", "xMinYMin", "xMaxYMid meet", "xMidYMax slice", "xMinYMax slice")
COPIES = (
    'x="-20" y="10" width="40" height="30"', 'width="30" height="12"', 'x="3mm" y="-10"',
    'x="-36" y="-36" width="72" height="72" transform="matrix(1 0 0 -1 12 20)"',
    'style="transform:scale(0.8, 0.9);x:4px" width="25px" height="40px"',
    'x="-10%" y="5%" width="20%" height="15%"', 'style="x:10%" y="20pt" width="9%" height="80px"',
)  # fmt: skip
DRAWN = """() => {
  const use = document.querySelector('use'), found = [];
  const box = use.getBoundingClientRect(), page = document.documentElement.getScreenCTM().inverse();
  return [[box.left, box.top], [box.right, box.bottom]].map(([x, y]) => {
    const p = new DOMPoint(x, y).matrixTransform(page);
    return [p.x, p.y];
  });
}"""
"""Corners of the box of what the copy draws, in units of the drawing"""
SIZE = 200.0
SINGLE = 0.01
"""[m] by which a browser's own box is off: single precision and the tenths of pixels"""


def drawing(symbol: str, copy: str) -> str:
    shape = '<path d="M6 6 H 11 V 12 L 8 14 Z"/>'
    symbol = f'<symbol id="s" overflow="visible" {symbol}>{shape}</symbol>'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}" '
        f'viewBox="{-SIZE / 2} {-SIZE / 2} {SIZE} {SIZE}">{symbol}'
        f'<rect id="boundary" x="{-SIZE / 2}" y="{-SIZE / 2}" width="{SIZE}" height="{SIZE}"/>'
        f'<g id="obstacle"><use href="#s" {copy}/></g><path id="path" d="M-90 -95 H 90"/></svg>'
    )


def test_symbols_with_views_lie_where_a_browser_draws_them(browser: Any, tmp_path: Path) -> None:
    page, path = browser.new_page(), tmp_path / "plan.svg"
    for view, ratio, copy in product(SYMBOLS, RATIOS, COPIES):
        text = drawing(f'{view} preserveAspectRatio="{ratio}"' if ratio else view, copy)
        path.write_text(text)
        page.goto(path.as_uri())
        corners = np.array(page.evaluate(DRAWN)) * (1.0, -1.0) + SIZE / 2
        if (corners < 6.0).any() or (corners > SIZE - 6.0).any():
            continue  # cut at the page, or in the way of the path
        (found,) = import_world(path, Options(scale=1.0)).world.obstacles or ()
        points = np.array(found, dtype=float)
        low, high = points.min(axis=0), points.max(axis=0)
        assert low == pytest.approx(corners.min(axis=0), abs=SINGLE), text
        assert high == pytest.approx(corners.max(axis=0), abs=SINGLE), text
    page.close()


@pytest.mark.parametrize(
    ("symbol", "copy", "said"),
    [
        (SYMBOLS[0], 'width="0%" height="3"', "width"),
        (SYMBOLS[0], 'x="2em" width="4" height="3"', "x"),
        (SYMBOLS[0], 'style="x:calc(1px + 2px)" width="4" height="3"', "x"),
        (f'{SYMBOLS[0]} preserveAspectRatio="xMinYMidfoo"', "", "preserveAspectRatio"),
        (SYMBOLS[0], 'width="2em" height="3"', "width"),
        (SYMBOLS[0], 'width="auto" height="3"', "width"),
        (SYMBOLS[0], 'style="width:2px" height="3"', "style has a width"),
        (f'{SYMBOLS[0]} x="2em"', 'width="4" height="3"', "x"),
        ('viewBox="0 0 0 4"', 'width="2" height="3"', "viewBox"),
        (f'{SYMBOLS[0]} preserveAspectRatio="left"', "", "preserveAspectRatio"),
    ],
)
def test_copies_that_cannot_be_fitted_are_refused(
    tmp_path: Path, symbol: str, copy: str, said: str
) -> None:
    path = tmp_path / "plan.svg"
    path.write_text(drawing(symbol, copy))
    with pytest.raises(ImportSourceError, match=said):
        import_world(path, Options(scale=1.0))
