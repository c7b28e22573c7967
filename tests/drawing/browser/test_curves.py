"""Curves of a drawing lie where a browser draws them, under whatever transforms."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.authoring.importing import Options, import_world

SHAPES = (
    '<circle id="c" cx="8" cy="9" r="3"/>', '<ellipse id="c" cx="8" cy="9" rx="4" ry="1.5"/>',
    '<rect id="c" x="5" y="6" width="7" height="5" rx="1.5"/>',
    '<rect id="c" x="5" y="6" width="7" height="5" rx="1" ry="2"/>',
    '<path id="c" d="M5 9 a 4 1.5 30 1 1 7 1 a 4 1.5 30 0 1 -7 -1 z"/>',
    '<path id="c" d="M5 9 A 3 3 0 0 0 10 12 L 12 7 z"/>',
    '<path id="c" d="M5 9 C 6 2 9 4 10 9 S 12 14 8 13 Q 6 13 5 9 z"/>',
    '<polygon id="c" points="5,6 12,7 9,12"/>',
)  # fmt: skip
TRANSFORMS = (
    "translate(3 2)", "rotate(20)", "rotate(-35)", "scale(1.5 0.6)", "scale(1 0.8)", "scale(-1 1)",
    "skewX(25)", "skewY(-15)", "matrix(1 0.2 0.3 0.9 0 0)", "scale(1.3)",
)  # fmt: skip
DRAWN = """() => {
  const one = document.getElementById('c');
  const m = document.documentElement.getScreenCTM().inverse().multiply(one.getScreenCTM());
  const length = one.getTotalLength(), found = [];
  for (let k = 0; k <= 2000; k++) {
    const p = one.getPointAtLength(length * k / 2000).matrixTransform(m);
    found.push([p.x, p.y]);
  }
  return found;
}"""
"""Points along the outline, in units of the drawing"""
SIZE = 200.0
CHORD = 0.01
"""[m] stated of curves"""
SINGLE = 0.004
"""[m] by which a browser's own points are off: single precision, 2,000 of them on a curve"""


@pytest.mark.parametrize("seed", range(3))
def test_curves_lie_where_a_browser_draws_them(browser: Any, tmp_path: Path, seed: int) -> None:
    rng, page, path = random.Random(seed), browser.new_page(), tmp_path / "plan.svg"
    for _ in range(20):
        outer, inner = (" ".join(rng.sample(TRANSFORMS, rng.randint(0, 2))) for _ in range(2))
        shape = rng.choice(SHAPES).replace(" id", f' transform="{inner}" id')
        path.write_text(drawing(f'<g id="obstacle" transform="{outer}">{shape}</g>'))
        page.goto(path.as_uri())
        check_drawn(page, path)
    page.close()


def drawing(inner: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}" '
        f'viewBox="{-SIZE / 2} {-SIZE / 2} {SIZE} {SIZE}">'
        f'<rect id="boundary" x="{-SIZE / 2}" y="{-SIZE / 2}" width="{SIZE}" height="{SIZE}"/>'
        f'{inner}<path id="path" d="M-90 -90 H 90"/></svg>'
    )


def check_drawn(page: Any, path: Path) -> None:
    """The one obstacle of a drawing is where the browser has the outline of ``c``."""
    # y goes up in the world, and its origin is the lower left corner of the page
    drawn = np.array(page.evaluate(DRAWN)) * (1.0, -1.0) + SIZE / 2
    text = path.read_text()
    (found,) = import_world(path, Options(scale=1.0)).world.obstacles or ()
    outline = shapely.LinearRing(np.array(found, dtype=float))
    assert shapely.distance(outline, shapely.points(drawn)).max() <= CHORD + SINGLE, text
    corners = shapely.points(shapely.get_coordinates(outline))
    assert shapely.distance(shapely.LineString(drawn), corners).max() <= SINGLE, text
