"""How deep contacts may be: which part of the rule decides, and that longer steps keep to it."""

from __future__ import annotations

import numpy as np
import pytest

from physim.contacts import allowed_depth
from physim.tolerances import DEEP, IMPACT_SPEED, SETTLED_DEPTH, TUNNEL_FRACTION
from tests.helpers import inside
from tests.simulation.engine.hosts import box, drive, host, segments

pack_parts = inside("physim.geometry", "pack_parts")

ROBOT = [box(0.5, 0.3)]


def shapes(*footprints):
    return pack_parts([[box(*sides)] for sides in footprints])


@pytest.mark.parametrize("step", [0.001, 0.005, 0.01])
def test_short_steps_may_reach_an_impact_at_a_hundredth_of_a_second(step):
    assert allowed_depth(shapes((1.8, 1.0), (0.1, 0.09)), step) == DEEP


def test_longer_steps_may_reach_what_bodies_close_in_them():
    wide = shapes((1.8, 1.0))
    longer = allowed_depth(wide, 0.05) - allowed_depth(wide, 0.03)
    assert longer == pytest.approx(0.02 * IMPACT_SPEED)
    assert allowed_depth(wide, 0.03) - DEEP == pytest.approx(0.02 * IMPACT_SPEED)


def test_nothing_may_be_deeper_than_robots_may_move_in_a_step():
    assert allowed_depth(shapes((1.8, 1.0), (0.5, 0.3)), 0.05) == pytest.approx(
        TUNNEL_FRACTION * 0.3
    )


@pytest.mark.parametrize("step", [0.001, 0.05])
def test_small_robots_may_be_less_deep_but_deeper_than_they_settle(step):
    assert allowed_depth(shapes((1.8, 1.0), (0.5, 0.04)), step) == pytest.approx(0.01)
    assert SETTLED_DEPTH < allowed_depth(shapes((0.004, 0.004)), step) < 0.005


@pytest.mark.parametrize("dt", [0.02, 0.05])
def test_a_jam_at_long_steps_keeps_to_it(dt):
    """Twenty robots driven into a dead end: a step done again is met on the way."""
    start = [[0.55 * (i // 4) + 0.5, 0.6 * (i % 4) + 0.4, 0.3 * (-1) ** i] for i in range(20)]
    end = segments([(-5.0, 0.0), (3.5, 0.0), (3.5, 2.6), (-5.0, 2.6)])
    plain = host(start, [ROBOT] * 20, walls=[end], dt=dt, mass=15.0)
    allowed = plain._allowed_depth
    plain._allowed_depth = np.inf
    held = host(start, [ROBOT] * 20, walls=[end], dt=dt, mass=15.0)
    forth, turning = [[1.4, 0.0]] * 20, [[1.4, 1.5 * (-1) ** i] for i in range(20)]
    deepest = {}
    for name, physics in {"plain": plain, "held": held}.items():
        rows = [r for c in [forth, turning] * 3 for r in drive(physics, c, 50)[1]]
        deepest[name] = max(float(r["depth"].max()) for r in rows if len(r))
        assert (physics.pose[:, 0] < 3.5).all()
    assert deepest["held"] <= allowed < deepest["plain"]
