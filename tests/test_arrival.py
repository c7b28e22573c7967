"""Arrival by the motion alone: two forms that agree, and a definition written out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.simulation.arrival import (
    STILL_TIME,
    arrivals,
    note_arrivals,
    since,
    still_distances,
    still_steps,
)


def written_out(pose, station, least, near, dt):
    """The definition, word by word."""
    samples, robots = station.shape
    found = np.zeros((samples, robots), dtype=bool)
    for k in range(samples):
        first = k - math.ceil(STILL_TIME / dt - 1e-9)
        for i in range(robots):
            places = pose[max(first, 0) : k + 1, i, :2]
            stood = [math.dist(place, pose[k, i, :2]) <= near[i] for place in places]
            found[k, i] = first >= 0 and station[k, i] >= least[i] and all(stood)
    return found


def stepwise(pose, station, least, near, dt):
    """The compiled form, as a simulation calls it."""
    trail = np.zeros((still_steps(dt) + 1, pose.shape[1], 2))
    found = np.zeros(station.shape, dtype=bool)
    for k in range(len(pose)):
        everybody = note_arrivals(k, pose[k], station[k], least, near, trail, found[k])
        assert everybody == found[k].all()
    return found


@given(st.integers(0, 10**6), st.sampled_from([0.05, 0.1, 0.07, 0.5, 0.6]))
def test_all_forms_agree_on_robots_that_stop_and_go(seed: int, dt: float) -> None:
    random = np.random.default_rng(seed)
    samples, robots = 80, 3
    speed = random.choice([0.0, 0.0, 0.004, 0.3], (samples, robots))
    speed = speed[np.maximum(np.arange(samples)[:, None] // 12 * 12 - np.arange(robots), 0), 0]
    station = np.cumsum(speed * dt, axis=0)
    pose = np.zeros((samples, robots, 3))
    pose[..., 0] = station
    pose[..., 1] = random.choice([0.0, 0.004], (samples, robots))
    pose[..., 2] = random.uniform(-3, 3, (samples, robots))
    least = random.uniform(0.0, 1.0, robots) * station[-1]
    near = still_distances(np.array([0.02, 0.06, 1.0]))
    wanted = written_out(pose, station, least, near, dt)
    assert np.array_equal(arrivals(pose, station, least, near, dt), wanted)
    assert np.array_equal(stepwise(pose, station, least, near, dt), wanted)


LARGE = np.array([0.01])
"""[m] how far a robot of a metre may move while it stands"""


def stretch(speeds: list[float], dt: float = 0.01) -> np.ndarray:
    x = np.concatenate(([0.0], np.cumsum(np.array(speeds) * dt)))
    pose = np.zeros((len(x), 1, 3))
    pose[:, 0, 0] = x
    return pose


@pytest.mark.parametrize(
    ("speeds", "first"),
    [
        ([0.0] * 100, 50),  # standing from the start on: when 0.5 s have passed
        ([0.9] * 30 + [0.0] * 100, 79),  # the last 9 mm of the way count as standing
        ([1.0] * 30 + [0.019] * 100, 80),  # creeping by 9.5 mm in 0.5 s
        ([1.0] * 30 + [0.021] * 100, -1),  # by 10.5 mm
        ([0.0] * 20 + [0.9] * 2 + [0.0] * 100, 71),
    ],
)
def test_standing_is_half_a_second_within_a_centimetre(speeds: list[float], first: int) -> None:
    pose = stretch(speeds)
    found = arrivals(pose, pose[:, :, 0], np.array([-1.0]), LARGE, 0.01)
    assert since(found).tolist() == [first]


def test_a_small_robot_that_creeps_at_its_full_speed_does_not_stand() -> None:
    """A Kilobot: 16.5 mm of radius, 1 cm/s. One of a metre that moves so stands."""
    pose = stretch([0.01] * 300)
    for radius, stands in ((0.0165, False), (1.0, True)):
        near = still_distances(np.array([radius]))
        assert arrivals(pose, pose[:, :, 0], np.array([-1.0]), near, 0.01).any() == stands


def test_short_of_the_stop_station_nobody_arrives() -> None:
    pose = stretch([1.0] * 30 + [0.0] * 100)
    for least, arrives in ((0.3, True), (0.3001, False)):
        found = arrivals(pose, pose[:, :, 0], np.array([least]), LARGE, 0.01)
        assert found[-1, 0] == arrives


def test_one_that_moves_on_has_not_arrived() -> None:
    pose = stretch([0.0] * 60 + [0.9] * 5 + [0.0] * 60)
    found = arrivals(pose, pose[:, :, 0], np.array([-1.0]), LARGE, 0.01)
    assert found[55, 0]
    assert not found[62, 0]
    assert since(found).tolist() == [114]
    assert since(found[:64]).tolist() == [-1]


def test_a_run_shorter_than_standing_takes_has_no_arrivals_and_no_time() -> None:
    # A record may say that its steps are of a nanosecond: half a second is 5e8 of them.
    pose, station = np.zeros((30, 2, 3)), np.full((30, 2), 9.0)
    assert not arrivals(pose, station, np.ones(2), np.ones(2), 1e-9).any()
    assert arrivals(pose, station, np.ones(2), np.ones(2), 0.1)[5:].all()
