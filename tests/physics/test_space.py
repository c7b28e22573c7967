"""How robots and walls are put into the engine."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from hosts import ELL, box

from physim.geometry.shapes import pack_shapes
from physim.physics.space import moment, part_bodies


def test_moment_is_about_the_reference_point():
    part = np.array(box(1.0, 0.6, x=0.3, y=-0.1))
    about_centre = 10.0 * (1.0 + 0.36) / 12
    assert moment([part], 10.0) == pytest.approx(about_centre + 10.0 * (0.09 + 0.01))
    assert moment([part], 10.0) == pytest.approx(pymunk.moment_for_poly(10.0, part.tolist()))


def test_moment_of_parts_is_that_of_the_whole():
    halves = [np.array(box(0.5, 0.6, x=-0.25)), np.array(box(0.5, 0.6, x=0.25))]
    assert moment(halves, 4.0) == pytest.approx(moment([np.array(box())], 4.0))


def test_parts_know_their_body():
    shapes = pack_shapes([[box()], ELL, [box()]])
    assert part_bodies(shapes).tolist() == [0, 1, 1, 2]
