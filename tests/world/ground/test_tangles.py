"""How often segments meet, against every pair looked at."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside

meet_more_often, segments_of = inside("physim.world.ground", "meet_more_often", "segments_of")

corners = st.tuples(st.integers(0, 4), st.integers(0, 4)).map(lambda xy: np.array(xy, float))
lines = st.lists(
    st.lists(corners, min_size=2, max_size=6)
    .map(np.array)
    .filter(lambda line: (np.diff(line, axis=0) != 0.0).any(axis=1).all()),
    max_size=4,
)


@pytest.mark.parametrize("by_boxes", [False, True])
@examples(25, deep=100)
@given(given=lines)
def test_pairs_that_meet_are_counted_as_by_looking_at_each(given, by_boxes):
    segments = segments_of(given)
    shapes = [shapely.LineString(one) for one in segments]
    if by_boxes:
        shapes = [shapely.box(*shape.bounds) for shape in shapes]
    count = sum(a.intersects(b) for a, b in combinations(shapes, 2))
    assert not meet_more_often(segments, count, by_boxes)
    if count:
        assert meet_more_often(segments, count - 1, by_boxes)
