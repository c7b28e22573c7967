"""What the scan for contacts sees: robots and every part of every wall."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import affinity

from physim.analysis.validation.analytic_contacts import scan_walls
from physim.geometry.shapes import pack_shapes

BOX = np.array([[0.9, 0.5], [-0.9, 0.5], [-0.9, -0.5], [0.9, -0.5]])
CORNER = [[(0.0, -5.0), (0.0, 5.0)], [(0.0, 5.0), (8.0, 5.0)], [(8.0, 5.0), (8.0, -5.0)]]
"""One boundary of three segments round a dead end."""


@pytest.mark.parametrize(
    "pose", [(1.2, 0.0, 0.0), (4.0, 4.3, 0.0), (6.9, 0.0, 0.0), (1.5, 4.0, 0.4), (6.2, 3.6, 2.0)]
)
def test_the_distance_to_a_boundary_is_that_to_its_nearest_segment(pose):
    shapes = pack_shapes([[BOX]])
    walls = pack_shapes([[np.array(segment) for segment in CORNER]])
    who, values = np.zeros((4, 3), dtype=np.int64), np.zeros((4, 2))
    count = scan_walls(np.array([[pose]]), 0, shapes, walls, 3.0, 0.01, who, values)
    body = affinity.rotate(shapely.Polygon(BOX), pose[2], origin=(0, 0), use_radians=True)
    body = affinity.translate(body, *pose[:2])
    assert (count, who[0].tolist()) == (1, [0, 0, 1])
    nearest = min(body.distance(shapely.LineString(segment)) for segment in CORNER)
    assert values[0, 0] == pytest.approx(nearest, abs=1e-12)
    assert np.isnan(values[0, 1])
