"""Fig. 5: when danger begins, when it ends, and by which rule it is met."""

from __future__ import annotations

import numpy as np

from tests.helpers import inside
from tests.oracles import switching as oracle

AVOIDANCE, DISTANCE = inside("physim.controllers", "AVOIDANCE", "DISTANCE")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")
next_mode, SAFE, TIME = inside("physim.controllers", "next_mode", "SAFE", "TIME")

RULES = ModeSwitchingSettings(time_low=0.5, time_high=1.0, avoidance="time_first").rules()
FAR = float("inf")
S, D, T = SAFE, DISTANCE, TIME


def test_modes_agree_with_the_oracle() -> None:
    """On a grid of values, so that many lie exactly at a threshold."""
    grid = np.array([-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, FAR])
    met = set()
    for k in range(2000):
        rng = np.random.default_rng([50, k])
        low, high = np.sort(rng.choice(grid[1:-1], 2)), np.sort(rng.choice(grid[1:-1], 2))
        settings = ModeSwitchingSettings(
            distance_low=low[0], distance_high=low[1], time_low=high[0], time_high=high[1],
            boundary_low=float(rng.choice(grid[1:-1])), avoidance=AVOIDANCE[k % len(AVOIDANCE)],
        )  # fmt: skip
        previous = int(rng.integers(4))
        distance, boundary = rng.choice(grid, 2, p=[0.1] * 7 + [0.3])
        time = float(rng.choice(grid[1:]))
        expected = oracle.next_mode(previous, distance, time, boundary, settings)
        found = next_mode(previous, float(distance), time, float(boundary), settings.rules())
        assert found == expected
        met.add((settings.avoidance, previous, expected))
    assert len(met) == 4 * (2 * 3 + 2 * 2 + 1)


def history(values: list[tuple[float, float, float]]) -> list[int]:
    mode, modes = SAFE, []
    for distance, collision_time, boundary in values:
        mode = next_mode(mode, distance, collision_time, boundary, RULES)
        modes.append(mode)
    return modes


def test_hysteresis_by_distance() -> None:
    """Low 0.5, high 0.8: what lies between keeps the mode it came from."""
    distances = [0.6, 0.5, 0.49, 0.6, 0.8, 0.81, 0.6]
    assert history([(d, FAR, FAR) for d in distances]) == [S, S, D, D, D, S, S]


def test_hysteresis_by_time() -> None:
    times = [0.6, 0.5, 0.49, 0.9, 1.0, 1.01, 0.6]
    assert history([(FAR, xi, FAR) for xi in times]) == [S, S, T, T, T, S, S]


def test_no_hysteresis_by_boundary() -> None:
    """One threshold, 0.15 m: below it danger, above it safe, at it what was before."""
    gaps = [0.16, 0.15, 0.149, 0.15, 0.151, 0.15]
    assert history([(FAR, FAR, b) for b in gaps]) == [S, S, D, D, S, S]


def test_one_short_value_keeps_the_danger() -> None:
    """Out of danger only when distance, time and boundary are all above their thresholds."""
    values = [(0.4, FAR, FAR), (0.9, 0.9, FAR), (0.9, 1.1, 0.15), (0.9, 1.1, 0.16), (0.7, 0.9, 0.2)]
    assert history(values) == [D, T, D, S, S]


def test_touching_shapes_part_by_distance() -> None:
    assert next_mode(0, 0.0, 0.0, FAR, RULES) == DISTANCE
    assert next_mode(0, FAR, 0.0, -0.01, RULES) == DISTANCE
    assert next_mode(0, 0.01, 0.01, FAR, RULES) == TIME
