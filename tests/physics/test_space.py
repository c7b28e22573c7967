"""How robots and walls are put into the engine."""

from __future__ import annotations

import functools
import sys

import numpy as np
import pymunk
import pytest
from crowds import crowd, run
from hosts import ELL, box
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.geometry.test_polygon import star_polygons
from tests.helpers import inside

convex_parts, counter_clockwise = inside("physim.geometry", "convex_parts", "counter_clockwise")
is_simple, moment, signed_area = inside("physim.geometry", "is_simple", "moment", "signed_area")
pack_parts, part_bodies = inside("physim.geometry", "pack_parts", "part_bodies")
MOST_WALL_CELLS, cell_side = inside("physim.simulation.engine", "MOST_WALL_CELLS", "cell_side")


def test_moment_is_about_the_reference_point():
    part = np.array(box(1.0, 0.6, x=0.3, y=-0.1))
    about_centre = 10.0 * (1.0 + 0.36) / 12
    assert moment([part], 10.0) == pytest.approx(about_centre + 10.0 * (0.09 + 0.01))
    assert moment([part], 10.0) == pytest.approx(pymunk.moment_for_poly(10.0, part.tolist()))


def test_moment_of_parts_is_that_of_the_whole():
    halves = [np.array(box(0.5, 0.6, x=-0.25)), np.array(box(0.5, 0.6, x=0.25))]
    assert moment(halves, 4.0) == pytest.approx(moment([np.array(box())], 4.0))


@given(star_polygons(), st.floats(0.1, 100.0))
def test_moment_is_that_of_many_small_squares(polygon, mass):
    assume(is_simple(polygon))
    found = moment(list(convex_parts(polygon)), mass)
    ring = counter_clockwise(polygon)
    x, y = ring.T
    u, v = np.roll(x, -1), np.roll(y, -1)
    cross = x * v - u * y  # Green's theorem over the outline
    second = np.sum(cross * (x * x + x * u + u * u + y * y + y * v + v * v)) / 12.0
    assert found == pytest.approx(mass * second / signed_area(ring), rel=1e-6)


def test_moment_of_a_box_is_the_textbook_one():
    rectangle = np.array(box(2.0, 1.0))
    assert moment([rectangle], 12.0) == pytest.approx(12.0 * (4.0 + 1.0) / 12.0)
    assert moment([rectangle + (3.0, 4.0)], 12.0) == pytest.approx(5.0 + 12.0 * 25.0)


def test_parts_know_their_body():
    shapes = pack_parts([[box()], ELL, [box()]])
    assert part_bodies(shapes).tolist() == [0, 1, 1, 2]


def test_cells_are_three_lengths_of_the_longest_robot():
    robots = pack_parts([[box(0.8, 0.6)], [box(1.6, 1.2)]])
    assert cell_side(robots, pack_parts([])) == pytest.approx(6.0)
    near = pack_parts([[[(-300.0, -300.0), (300.0, 300.0)]]])
    assert cell_side(robots, near) == pytest.approx(6.0)


def test_a_wall_of_kilometres_drawn_diagonally_fills_no_more_cells_than_allowed():
    robots = pack_parts([[box(0.8, 0.6)]])
    side = cell_side(robots, pack_parts([[[(-1e6, -1e6), (1e6, 1e6)]]]))
    assert MOST_WALL_CELLS / 8 < (2e6 / side) ** 2 <= MOST_WALL_CELLS
    along = cell_side(robots, pack_parts([[[(-1e5, 0.0), (1e5, 0.0)]]]))
    assert along == pytest.approx(3.0)


def test_without_the_members_behind_pymunks_own_functions_robots_move_alike(monkeypatch):
    quick = run("jam", 3, 150)
    monkeypatch.setitem(sys.modules, "pymunk._chipmunk_cffi", None)
    physics = crowd("jam", 3).physics()
    assert isinstance(physics._arrays.write_pose, functools.partial)
    assert run("jam", 3, 150).samples == quick.samples
