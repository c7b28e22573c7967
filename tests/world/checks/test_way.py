"""Places along a way, against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside

Way = inside("physim.world.checks", "Way")


@examples(20, deep=100)
@given(seed=st.integers(0, 10_000), points=st.integers(2, 7))
def test_a_way_agrees_with_shapely(seed: int, points: int) -> None:
    rng = np.random.default_rng(seed)
    path = rng.uniform(-10.0, 10.0, (points, 2))
    way, line = Way(path), shapely.LineString(path)
    stations = np.append(rng.uniform(0.0, line.length, 9), [0.0, line.length])
    places, direction = way.at(stations)
    assert places == pytest.approx(shapely.get_coordinates(line.interpolate(stations)), abs=1e-9)
    ahead = way.at(np.minimum(stations + 1e-6, way.station[-1]))[0] - places
    assert ((ahead * direction).sum(axis=1) >= 0.0).all()
    assert np.hypot(*direction.T) == pytest.approx(1.0)
    near = rng.uniform(-12.0, 12.0, (20, 2))
    gaps = np.hypot(*(way.at(way.nearest(near))[0] - near).T)
    assert gaps == pytest.approx(shapely.distance(line, shapely.points(near)), abs=1e-9)
