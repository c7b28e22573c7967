"""A logarithmic axis has ticks at round values, however few or many decades it has."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.analysis.metrics.histories import history
from tests.helpers import inside

collision_times, MOST_TICKS = inside("physim.drawing.plots", "collision_times", "MOST_TICKS")
log_ticks = inside("physim.drawing.plots", "log_ticks")


@pytest.mark.parametrize(
    ("low", "high", "ticks"),
    [
        (0.5, 3.2, [0.5, 1.0, 2.0]),
        (0.0061, 0.0153, [0.007, 0.01, 0.015]),
        (0.5, 1250.0, [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]),
        (0.5, 1.25e9, [10.0**k for k in range(10)]),
        (0.005, 1.7e308, None),
    ],
)
def test_ticks_are_round_and_some(low: float, high: float, ticks: list[float] | None) -> None:
    found = log_ticks(low, high)
    if ticks is not None:
        assert found == pytest.approx(ticks)
    assert 2 <= len(found) <= MOST_TICKS
    assert low <= found[0] < found[-1] <= high


def test_an_axis_of_any_range_has_two_ticks_and_not_too_many() -> None:
    for low in np.geomspace(0.005, 0.5, 60).tolist():
        for factor in (2.5, 2.6, 3.0, 7.0, *np.geomspace(10.0, 1e305, 60).tolist()):
            found = log_ticks(low, low * factor)
            assert 2 <= len(found) <= MOST_TICKS, (low, factor)
            assert all(math.isclose(t, float(f"{t:.1e}"), rel_tol=1e-12) for t in found)


@pytest.mark.parametrize("none", [1e9, 1.7e308])
def test_collision_times_have_ticks_with_a_large_number_for_none(none: float) -> None:
    rows = [
        {"step": 0, "robot": 0, "collision_time": none, "next_step": 50},
        {"step": 50, "robot": 0, "collision_time": 2.345, "next_step": 100},
    ]
    with history(rows, steps_run=100) as made:
        figure = collision_times(made)
        figure.draw_without_rendering()
        axis = figure.axes[0]
        low, high = axis.get_ylim()
        shown = [tick for tick in axis.get_yticks() if low <= tick <= high]
        assert len(shown) >= 2
        assert high >= min(none, 1e300)
        assert all(label.get_text() for label in axis.get_yticklabels())
