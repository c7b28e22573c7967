"""How robots and walls are put into the engine."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.geometry.test_polygon import star_polygons
from tests.helpers import examples, inside
from tests.simulation.engine.hosts import box

convex_parts, counter_clockwise = inside("physim.geometry", "convex_parts", "counter_clockwise")
is_simple, moment, signed_area = inside("physim.geometry", "is_simple", "moment", "signed_area")
pack_parts = inside("physim.geometry", "pack_parts")
MOST_WALL_CELLS, cell_side = inside("physim.simulation.engine", "MOST_WALL_CELLS", "cell_side")


@examples(25, deep=100)
@given(star_polygons(), st.floats(0.1, 100.0))
def test_moment_is_that_of_green_s_theorem_over_the_outline(polygon, mass):
    assume(is_simple(polygon))
    ring = counter_clockwise(polygon)
    x, y = ring.T
    u, v = np.roll(x, -1), np.roll(y, -1)
    cross = x * v - u * y
    second = np.sum(cross * (x * x + x * u + u * u + y * y + y * v + v * v)) / 12.0
    found = moment(list(convex_parts(polygon)), mass)
    assert found == pytest.approx(mass * second / signed_area(ring), rel=1e-6)


def test_a_long_wall_drawn_diagonally_fills_no_more_cells_than_allowed():
    robots = pack_parts([[box(0.8, 0.6)]])
    for far, steepness in ((300.0, 1.0), (1e5, 0.0), (1e6, 1.0)):
        side = cell_side(robots, pack_parts([[[(-far, -steepness * far), (far, steepness * far)]]]))
        if steepness * far > 1e3:
            assert MOST_WALL_CELLS / 8 < (2.0 * far / side) ** 2 <= MOST_WALL_CELLS
        else:
            assert side == pytest.approx(3.0)  # of three lengths of the longest robot
