"""Which robots of a formation meet, against every pair looked at; of crowds, the first of them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely

from physim.world.checks import spacing
from physim.world.checks.spacing import _meetings


def boxes(rng: np.random.Generator, robots: int, places: int, side: float) -> np.ndarray:
    corner = rng.uniform(0.0, side, (robots, places, 2))
    return np.asarray(shapely.box(*corner.transpose(2, 0, 1), *(corner + 1.0).transpose(2, 0, 1)))


def slowly(shapes: np.ndarray, is_there: np.ndarray) -> dict[tuple[int, int], int]:
    found = {}
    for i, j in combinations(range(len(shapes)), 2):
        both = is_there[i] & is_there[j]
        if count := int((shapely.dwithin(shapes[i], shapes[j], 1e-9) & both).sum()):
            found[i, j] = count
    return found


@pytest.mark.parametrize("most", [1, 40, 100_000])
@pytest.mark.parametrize("seed", range(5))
def test_pairs_and_places_are_those_of_every_pair(seed, most, monkeypatch):
    rng = np.random.default_rng(seed)
    shapes, is_there = boxes(rng, 30, 4, 6.0), rng.random((30, 4)) < 0.8
    monkeypatch.setattr(spacing, "MOST_PAIRS", most)
    found = {(i, j): count for i, j, count in _meetings(shapes, is_there)}
    wanted = slowly(shapes, is_there)
    if most == 100_000:
        assert found == wanted
    first = max(i for i, _ in found)
    assert found == {pair: count for pair, count in wanted.items() if pair[0] <= first}


def test_of_a_crowd_in_one_place_some_are_looked_at():
    """All pairs of 4,000 are 8 million, at each of twelve places."""
    crowd = boxes(np.random.default_rng(1), 4_000, 3, 0.5)
    found = _meetings(crowd, np.ones(crowd.shape, dtype=np.bool_))
    assert 100_000 < len(found) < 300_000
    assert {count for _, _, count in found} == {3}
