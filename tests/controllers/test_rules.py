"""Single rules of the paper on hand-made cases."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from physim.control import Mode
from physim.controllers.formation import (
    formation_energy,
    formation_energy_rate,
    formation_error,
    formation_speed,
    formation_sum,
    is_neighbour,
)
from physim.controllers.priority import considered, has_priority
from physim.controllers.settings import ModeSwitchingSettings
from physim.controllers.switching import next_mode
from physim.controllers.timing import update_interval

RULES = ModeSwitchingSettings(time_low=0.5, time_high=1.0).rules()
FAR = float("inf")


def test_a_robot_that_lags_speeds_up_and_one_in_the_lead_slows_down() -> None:
    station, lead = np.array([0.0, 5.0]), np.array([0.0, 3.0])
    behind = formation_sum(0, np.array([1]), station, lead)
    ahead = formation_sum(1, np.array([0]), station, lead)
    assert behind == pytest.approx(2.0)
    assert ahead == pytest.approx(-2.0)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, behind) == pytest.approx(1.1)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, ahead) == pytest.approx(0.9)
    assert formation_speed(1.0, 0.05, 0.8, 1.3, 100.0) == 1.3
    assert formation_speed(1.0, 0.05, 0.8, 1.3, -100.0) == 0.8


stations = st.lists(st.floats(-100.0, 100.0), min_size=2, max_size=12)


@given(stations, st.integers(0, 2**31), st.floats(0.001, 0.1))
def test_energy_identity_10_for_robots_that_all_update_every_step(
    values: list[float], seed: int, dt: float
) -> None:
    """Ideal motion (8) on a straight road: the decay of W is (10) plus its exact remainder."""
    rng = np.random.default_rng(seed)
    n, alpha = len(values), 0.03
    station, lead = np.array(values), rng.uniform(-5.0, 5.0, n)
    adjacency = np.triu(rng.integers(0, 2, (n, n)), 1)
    adjacency = adjacency + adjacency.T
    inner = np.array(
        [formation_sum(i, np.flatnonzero(adjacency[i]), station, lead) for i in range(n)]
    )
    speed = np.array([formation_speed(1.0, alpha, -FAR, FAR, s) for s in inner])
    before = formation_energy(station, lead, adjacency)
    after = formation_energy(station + speed * dt, lead, adjacency)
    rate = formation_energy_rate(station, lead, adjacency, alpha)
    difference = inner[None, :] - inner[:, None]
    remainder = 0.5 * alpha**2 * dt**2 * (adjacency * difference**2).sum()
    assert rate <= 0.0
    assert after - before == pytest.approx(rate * dt + remainder, rel=1e-9, abs=1e-9 * (1 + before))


def test_formation_error_is_the_distance_to_the_mean_place() -> None:
    station, lead = np.array([1.0, 5.0, 9.0]), np.array([0.0, 4.0, 5.0])
    expected = [(5.0 - s) - (3.0 - wanted) for s, wanted in zip(station, lead, strict=True)]
    assert formation_error(station, lead) == pytest.approx(expected)


@given(stations, st.floats(0.1, 50.0))
def test_neighbourhood_is_symmetric(values: list[float], reach: float) -> None:
    station, none = np.array(values), np.zeros((0, 0), dtype=np.int64)
    for i in range(len(values)):
        assert not is_neighbour(i, i, station, none, reach)
        for j in range(len(values)):
            assert is_neighbour(i, j, station, none, reach) == is_neighbour(
                j, i, station, none, reach
            )


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
def test_of_two_robots_exactly_one_has_priority(s_i: float, s_j: float) -> None:
    assert has_priority(s_i, 0, s_j, 1) != has_priority(s_j, 1, s_i, 0)


def test_considered_are_those_ahead_within_range() -> None:
    pose = np.array([[0.0, 0, 0], [3.0, 0, 0], [-3.0, 0, 0], [0.0, 2, 0], [11.0, 0, 0]])
    station = np.array([0.0, 3.0, -3.0, 0.0, 11.0])
    index = np.arange(5)
    assert list(considered(0, index, pose, station, 10.0)) == [1]
    assert list(considered(3, index, pose, station, 10.0)) == [0, 1]
    assert list(considered(2, index, pose, station, 10.0)) == [0, 1, 3]


def history(values: list[tuple[float, float, float]]) -> list[Mode]:
    mode, modes = int(Mode.SAFE), []
    for distance, collision_time, boundary in values:
        mode = next_mode(mode, distance, collision_time, boundary, RULES)
        modes.append(Mode(mode))
    return modes


def test_hysteresis_by_distance() -> None:
    """Low 0.5, high 0.8: what lies between keeps the mode it came from."""
    distances = [0.6, 0.5, 0.49, 0.6, 0.8, 0.81, 0.6]
    modes = history([(d, FAR, FAR) for d in distances])
    S, D = Mode.SAFE, Mode.DISTANCE
    assert modes == [S, S, D, D, D, S, S]


def test_hysteresis_by_time() -> None:
    times = [0.6, 0.5, 0.49, 0.9, 1.0, 1.01, 0.6]
    S, T = Mode.SAFE, Mode.TIME
    assert history([(FAR, xi, FAR) for xi in times]) == [S, S, T, T, T, S, S]


def test_one_short_value_keeps_the_danger() -> None:
    """Out of danger only when distance, time and boundary are all above their thresholds."""
    S, D, T = Mode.SAFE, Mode.DISTANCE, Mode.TIME
    values = [(0.4, FAR, FAR), (0.9, 0.9, FAR), (0.9, 1.1, 0.15), (0.9, 1.1, 0.16), (0.7, 0.9, 0.2)]
    assert history(values) == [D, T, D, S, S]


def test_touching_shapes_part_by_distance() -> None:
    assert next_mode(0, 0.0, 0.0, FAR, RULES) == Mode.DISTANCE
    assert next_mode(0, FAR, 0.0, -0.01, RULES) == Mode.DISTANCE
    assert next_mode(0, 0.01, 0.01, FAR, RULES) == Mode.TIME


@given(st.floats(1e-6, 20.0), st.floats(1e-6, 20.0), st.floats(1e-6, 20.0), st.integers(0, 2))
def test_thresholds_of_zero_switch_one_off(
    distance: float, collision_time: float, boundary: float, previous: int
) -> None:
    """Shapes that don't touch: by time alone no distance matters, by distance alone no time."""
    time_only = ModeSwitchingSettings(distance_low=0.0, distance_high=0.0, boundary_low=0.0)
    distance_only = ModeSwitchingSettings(time_low=0.0, time_high=0.0)
    neither = ModeSwitchingSettings(
        distance_low=0.0, distance_high=0.0, boundary_low=0.0, time_low=0.0, time_high=0.0
    )
    by_time = next_mode(previous, distance, collision_time, boundary, time_only.rules())
    assert by_time == next_mode(previous, FAR, collision_time, FAR, time_only.rules())
    assert by_time != Mode.DISTANCE
    by_distance = next_mode(previous, distance, collision_time, boundary, distance_only.rules())
    assert by_distance == next_mode(previous, distance, FAR, boundary, distance_only.rules())
    assert by_distance != Mode.TIME
    assert next_mode(previous, distance, collision_time, boundary, neither.rules()) == Mode.SAFE


def test_update_interval_14() -> None:
    assert update_interval(0.1, 0.5, FAR) == 0.1
    assert update_interval(0.1, 0.5, 0.06) == 0.03
    assert update_interval(0.1, 0.5, 0.0) == 0.0


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"dwell_times": [0.05, 0.04]}, "add up to 0.09"),
        ({"distance_low": 1.0}, "distance_high is 0.8, below distance_low 1"),
        ({"time_high": 0.1}, "time_high is 0.1, below time_low 1"),
        ({"omegas": [1.0]}, "no 0"),
        ({"beta": 1.0}, "less than 1"),
        ({"look_ahaed": 1.0}, "look_ahaed"),
        ({"look_ahead": float("nan")}, "finite"),
    ],
)
def test_settings_that_cannot_be(settings: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        ModeSwitchingSettings.model_validate(settings)
