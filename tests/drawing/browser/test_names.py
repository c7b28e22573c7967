"""Names on a page stand beside the robots they name, or have a line to them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from physim.record import Record
from tests.drawing.browser.driver import Seen
from tests.helpers import inside

SceneModel, placed = inside("physim.drawing", "SceneModel", "placed")

WRITTEN = """(zoom) => {
  const { view, player } = physim, { prototype } = CanvasRenderingContext2D;
  const found = [], write = prototype.fillText;
  prototype.fillText = function(words, x, y) {
    const half = this.measureText(words).width / 2;
    if (this === view.context) found.push({ words, box: [x - half, y - 6, x + half, y + 6] });
    write.call(this, words, x, y);
  };
  view.camera.zoom = zoom;
  physim.show(player.time);
  prototype.fillText = write;
  const lines = Object.fromEntries((view.drawn.leaders ?? []).map(({ words, from, to }) =>
    [words, [from, to]]));
  const { pose, lens } = view.drawn;
  return { found, lines, pose: [...pose], lens };
}"""
"""What a view writes, with its boxes and lines [px]"""
SLACK = 1.5
"""[px] by which widths of letters are unlike their boxes"""


@pytest.mark.parametrize("zoom", [0.4, 0.7, 1.0, 1.4])
@pytest.mark.parametrize("chosen", [-1, 4])
def test_a_name_is_nearest_to_its_robot_or_has_a_line_to_it(
    opened: Callable[..., Seen], page_of_ten: Path, ten: Record, zoom: float, chosen: int
) -> None:
    seen = opened(page_of_ten, size=(700, 600))
    seen.ask(f"physim.go({{robot: {chosen}}})")
    scene, named = SceneModel.of_record(ten), 0
    for time in (0.0, 1.0, 2.5):
        seen.drawn_at(time)
        drawn: dict[str, Any] = seen.page.evaluate(WRITTEN, zoom)
        scale, x, y = (drawn["lens"][key] for key in ("scale", "x", "y"))
        poses = np.reshape(drawn["pose"], (-1, 3))
        shapes = [
            shapely.Polygon(placed(outline, np.array(pose)) * (scale, -scale) + (x, y))
            for outline, pose in zip(scene.outlines, poses, strict=True)
        ]
        for one in drawn["found"]:
            if one["words"] not in ten.names:
                continue
            named += 1
            robot = ten.names.index(one["words"])
            box = shapely.box(*one["box"])
            if one["words"] in drawn["lines"]:
                line = shapely.LineString(drawn["lines"][one["words"]])
                assert line.distance(shapes[robot]) < SLACK, one["words"]
                assert line.distance(box) < 4.0 * SLACK, one["words"]
            else:
                away = [box.distance(shape) for shape in shapes]
                assert away[robot] <= min(away) + SLACK, (one["words"], time)
        if chosen >= 0:
            assert ten.names[chosen] in {one["words"] for one in drawn["found"]}
    assert named > 3
