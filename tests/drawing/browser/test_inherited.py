"""What says where the lines of an element lie is its own: nothing of it is inherited."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim.authoring.importing import Options, import_world

SIZE = 200.0
SINGLE = 0.01
"""[m] by which a browser's own box is off: single precision and the tenths of pixels"""
DRAWN = """() => {
  const box = document.getElementById('obstacle').getBoundingClientRect();
  const page = document.documentElement.getScreenCTM().inverse();
  return [[box.left, box.top], [box.right, box.bottom]].map(([x, y]) => {
    const p = new DOMPoint(x, y).matrixTransform(page);
    return [p.x, p.y];
  });
}"""
"""Corners of the box of all that is drawn, in units of the drawing"""
SHAPES = (
    '<rect width="9" height="7"/>', '<rect x="6" width="9" height="7"/>', '<circle r="5"/>',
    '<circle cy="4" r="5"/>', '<ellipse cx="2" rx="6"/>', '<ellipse rx="6" ry="3"/>',
    '<rect y="3" width="9" height="7" rx="2"/>', '<use href="#q"/>', '<use href="#q" y="3"/>',
    '<use href="#s"/>', '<use href="#s" width="20" height="12"/>', '<use href="#u" x="4"/>',
    '<polygon points="1 1 9 2.5.5 7"/>', '<polyline points="1-1 9 2,5 7"/>',
    '<path d="M1 1h8v5"/>', '<rect x="2mm" y="3pt" width="1pc" height="7" ry="2"/>',
)  # fmt: skip
AROUND = (
    '<g x="30" y="10" {}>', '<g style="x:30px;cx:12px;rx:3px" {}>', '<a cx="20" cy="11" {}>',
    '<switch r="9" rx="4" ry="5" {}>', '<g points="0,0 20,0 20,20" d="M0 0h30v30z" {}>',
    '<g width="40" height="50" viewBox="0 0 9 9" {}>', '<g transform="translate(7,9)" {}>',
)  # fmt: skip
WHOLE = 'overflow="visible"'
DEFINED = """<defs><rect id="q" width="11" height="6"/>
<symbol id="s" overflow="visible"><rect width="9" height="7"/></symbol>
<symbol id="u" overflow="visible" width="3"><use href="#s" x="2"/><circle r="4"/></symbol></defs>"""


def drawing(draw: np.random.Generator) -> str:
    inner = str(draw.choice(SHAPES))
    for around in draw.choice(AROUND, size=draw.integers(1, 4)).tolist():
        inner = f"{around.format(WHOLE)}{inner}</{around[1:].split()[0]}>"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}" cx="40" rx="9" '
        f'viewBox="{-SIZE / 2} {-SIZE / 2} {SIZE} {SIZE}">{DEFINED}'
        f'<rect id="boundary" x="{-SIZE / 2}" y="{-SIZE / 2}" width="{SIZE}" height="{SIZE}" '
        f'rx="0"/><g id="obstacle">{inner}</g><path id="path" d="M-90 -95 H 90"/></svg>'
    )


@pytest.mark.parametrize("seed", range(4))
def test_shapes_lie_where_a_browser_draws_them(browser: Any, tmp_path: Path, seed: int) -> None:
    page, path = browser.new_page(), tmp_path / "plan.svg"
    draw, looked_at = np.random.default_rng(seed), 0
    for _ in range(60):
        text = drawing(draw)
        path.write_text(text)
        page.goto(path.as_uri())
        corners = np.array(page.evaluate(DRAWN)) * (1.0, -1.0) + SIZE / 2
        is_drawn = np.ptp(corners, axis=0).min() > 0.0
        if (corners < 6.0).any() or (corners > SIZE - 6.0).any() or not is_drawn:
            continue  # cut at the page, or in the way of the path
        if '<switch r="9" rx="4" ry="5" overflow="visible"><a ' in text:
            continue  # a link in a switch is not read
        found = import_world(path, Options(scale=1.0)).world.obstacles or ()
        looked_at += 1
        points = np.concatenate([np.array(one, dtype=float) for one in found])
        assert points.min(axis=0) == pytest.approx(corners.min(axis=0), abs=SINGLE), text
        assert points.max(axis=0) == pytest.approx(corners.max(axis=0), abs=SINGLE), text
    page.close()
    assert looked_at > 20
