"""A physics that is reset is as good as new."""

from __future__ import annotations

import numpy as np
import pytest

from physim.errors import PhysimError
from tests.simulation.engine.crowds import KINDS, crowd, go_on, told
from tests.simulation.engine.hosts import host


@pytest.mark.parametrize("kind", KINDS)
def test_reset_is_the_same_as_built(kind):
    scene = crowd(kind, 2)
    used = crowd(kind, 2).physics()
    for steps in (0, 1, 110):
        go_on(scene, used, steps)
        start = scene.start[::-1] + (0.01 * steps, 0.0, 0.2)
        fresh = scene._replace(start=start).physics()
        used.reset(start)
        assert told(used) == told(fresh)
        assert used.state == fresh.state
        assert go_on(scene, used, 120) == go_on(scene, fresh, 120)


@pytest.mark.parametrize(
    ("start", "told"),
    [
        ([0.0, 0.0, 0.0], r"shape \(3,\); allowed: \(1, 3\)"),
        ([[0.0, 0.0, 0.0]] * 2, r"shape \(2, 3\); allowed: \(1, 3\)"),
        ([[0.0, np.nan, 0.0]], "not finite"),
    ],
)
def test_bad_starts_are_refused(start, told):
    physics = host([[0.0, 0.0, 0.0]])
    with pytest.raises(PhysimError, match=told):
        physics.reset(start)
    assert physics.pose.tolist() == [[0.0, 0.0, 0.0]]
