"""Contacts that are too deep to be true, and how deep they may be."""

from __future__ import annotations

import numpy as np
import pytest

from physim.analysis import metrics
from physim.contacts import Phase, allowed_depth
from physim.tolerances import DEEP, IMPACT_SPEED, SETTLED_DEPTH, TUNNEL_FRACTION
from tests.analysis.metrics.histories import history
from tests.helpers import inside
from tests.simulation.engine.hosts import box, drive, host, segments

pack_parts = inside("physim.geometry", "pack_parts")

ROBOT = [box(0.5, 0.3)]


@pytest.mark.parametrize("b", [1, 2], ids=["robot", "wall"])
def test_a_contact_is_deep_from_its_first_sample_beyond_what_is_allowed(b: int) -> None:
    """However fast the bodies are commanded to be; what is just allowed is not deep."""
    fast = [{"robot": i, "nominal_v": 10.0, "nominal_omega": -2.0} for i in (0, 1)]
    phases = (Phase.BEGAN, Phase.STAYS, Phase.STAYS, Phase.ENDED)

    def touching(*depths: float) -> tuple[metrics.Deep, ...]:
        rows = [(40 + k, 0, b, *one) for k, one in enumerate(zip(phases, depths, strict=True))]
        return metrics.Figures(history(fast, rows)).deep

    assert touching(0.5 * DEEP, DEEP, 0.99 * DEEP, -0.1) == ()
    (deep,) = touching(0.5 * DEEP, 1.01 * DEEP, 2.5 * DEEP, -0.1)
    assert (deep.a, deep.b, deep.allowed) == (0, b, DEEP)
    assert (deep.time, deep.depth_time) == (pytest.approx(0.41), pytest.approx(0.42))
    assert deep.depth == pytest.approx(2.5 * DEEP)


def allowed(step: float, *footprints: tuple[float, float]) -> float:
    return allowed_depth(pack_parts([[box(*sides)] for sides in footprints]), step)


def test_each_part_of_the_rule_decides_somewhere() -> None:
    wide = (1.8, 1.0)
    for step in (0.001, 0.01):  # an impact at a hundredth of a second, whatever the step
        assert allowed(step, wide, (0.1, 0.09)) == DEEP
    for step in (0.03, 0.05):  # what bodies close in a step
        assert allowed(step, wide) - DEEP == pytest.approx((step - 0.01) * IMPACT_SPEED)
    # no deeper than robots may move in a step
    assert allowed(0.05, wide, (0.5, 0.3)) == pytest.approx(TUNNEL_FRACTION * 0.3)
    # of small robots less, but more than they settle at
    assert allowed(0.05, wide, (0.5, 0.04)) == pytest.approx(0.01)
    assert SETTLED_DEPTH < allowed(0.05, (0.004, 0.004)) < 0.005


@pytest.mark.parametrize("dt", [0.02, pytest.param(0.05, marks=pytest.mark.deep)])
def test_a_jam_at_long_steps_keeps_to_it(dt: float) -> None:
    """Twenty robots driven into a dead end: a step done again is met on the way."""
    start = [[0.55 * (i // 4) + 0.5, 0.6 * (i % 4) + 0.4, 0.3 * (-1) ** i] for i in range(20)]
    end = segments([(-5.0, 0.0), (3.5, 0.0), (3.5, 2.6), (-5.0, 2.6)])
    plain = host(start, [ROBOT] * 20, walls=[end], dt=dt, mass=15.0)
    limit = plain._allowed_depth
    plain._allowed_depth = np.inf
    held = host(start, [ROBOT] * 20, walls=[end], dt=dt, mass=15.0)
    forth, turning = [[1.4, 0.0]] * 20, [[1.4, 1.5 * (-1) ** i] for i in range(20)]
    deepest = {}
    for name, physics in {"plain": plain, "held": held}.items():
        rows = [r for c in [forth, turning] * 3 for r in drive(physics, c, 50)[1]]
        deepest[name] = max(float(r["depth"].max()) for r in rows if len(r))
        assert (physics.pose[:, 0] < 3.5).all()
    assert deepest["held"] <= limit < deepest["plain"]
