"""Arrival by the motion alone, against the definition written out."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import physim
from physim import Decision
from physim.analysis.metrics import Figures
from physim.analysis.validation import validate
from tests.helpers import inside

pack_parts, pack_polylines = inside("physim.geometry", "pack_parts", "pack_polylines")
Tracking = inside("physim.geometry", "Tracking")
Arrivals, later_since = inside("physim.simulation", "Arrivals", "later_since")

END, TOLERANCE = 20.0, 0.1


def judged(pose: np.ndarray, sizes: list[float], stop: float = END, dt: float = 0.01) -> np.ndarray:
    """(K, N) who has arrived at poses (K, N, 3): paths run along x to `END`, robots are squares."""
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    robots = len(sizes)
    shapes = pack_parts([[square * size] for size in sizes])
    road = np.array([[0.0, 0.0], [3.0, 0.0], [END, 0.0]])
    tracking = Tracking(
        pack_polylines([road] * robots), pack_polylines([road]), shapes.radius, pose[0]
    )
    scene = SimpleNamespace(
        stop_station=np.full(robots, stop), arrival_tolerance=TOLERANCE, dt=dt,
        shapes=shapes, robots=robots, start=pose[0],
    )  # fmt: skip
    arrivals = Arrivals(scene, tracking)
    found = [arrivals.arrived]
    for k in range(1, len(pose)):
        arrivals.follow(tracking, k, pose[k])
        found.append(arrivals.arrived)
        assert arrivals.all == found[-1].all()
    return np.array(found)


def written_out(pose: np.ndarray, sizes: list[float], stop: float, dt: float) -> np.ndarray:
    """The definition, word by word."""
    found = np.zeros(pose.shape[:2], dtype=bool)
    for k, i in np.ndindex(*found.shape):
        first = k - math.ceil(0.5 / dt - 1e-9)
        places = pose[max(first, 0) : k + 1, i, :2]
        near = min(0.01, 0.05 * math.sqrt(0.5) * sizes[i])
        stood = all(math.dist(place, places[-1]) <= near for place in places)
        x, y = places[-1]
        there = abs(x - stop) <= TOLERANCE and abs(y) <= max(abs(pose[0, i, 1]), sizes[i] / 2)
        found[k, i] = first >= 0 and there and stood
    return found


@settings(max_examples=25)
@given(
    st.integers(0, 10**6),
    st.sampled_from([0.05, 0.1, 0.07, 0.5, 0.6]),
    st.sampled_from([19.7, END]),
)
def test_robots_that_stop_and_go_arrive_as_it_is_defined(seed: int, dt: float, stop: float) -> None:
    random = np.random.default_rng(seed)
    samples, sizes = 80, [0.04, 0.12, 0.5, 1.0]
    speed = random.choice([0.0, 0.0, 0.004, 0.3], (samples, 4))
    speed = speed[np.maximum(np.arange(samples)[:, None] // 12 * 12 - np.arange(4), 0), 0]
    pose = np.zeros((samples, 4, 3))
    pose[..., 0] = np.cumsum(speed * dt, axis=0)
    pose[..., 0] += stop - random.uniform(-0.1, 1.1) * pose[-1, :, 0]
    pose[..., 1] = random.choice([0.0, 0.004], (samples, 4)) + random.choice([0.0, 0.3], 4)
    pose[..., 2] = random.uniform(-3, 3, (samples, 4))
    assert np.array_equal(judged(pose, sizes, stop, dt), written_out(pose, sizes, stop, dt))


def stretch(speeds: list[float], first: float = END - 0.05, dt: float = 0.01) -> np.ndarray:
    """Poses (K, 1, 3) along the path, from a station on."""
    pose = np.zeros((len(speeds) + 1, 1, 3))
    pose[1:, 0, 0] = np.cumsum(np.array(speeds) * dt)
    pose[:, 0, 0] += first
    return pose


def arrives(pose: np.ndarray, size: float = 1.0) -> int:
    """Sample from which on the one robot has arrived to the end; -1: it has not."""
    found = judged(pose, [size])
    halves = later_since(np.array([-1]), 0, found[:60])
    if len(found) > 60:
        halves = later_since(halves, 60, found[60:])
    assert halves.tolist() == later_since(np.array([-1]), 0, found).tolist()
    return int(halves[0])


@pytest.mark.parametrize(
    ("speeds", "first"),
    [
        ([0.0] * 100, 50),  # standing from the start on: when 0.5 s have passed
        ([0.09] * 30 + [0.0] * 100, 69),  # the last 9.9 mm of the way count as standing
        ([0.1] * 30 + [0.019] * 100, 80),  # creeping by 9.5 mm in 0.5 s
        ([0.1] * 30 + [0.021] * 100, -1),  # by 10.5 mm
        ([0.0] * 60 + [0.9] * 5 + [0.0] * 60, 114),  # one that moves on has not arrived
    ],
)
def test_standing_is_half_a_second_within_a_centimetre(speeds: list[float], first: int) -> None:
    assert arrives(stretch(speeds)) == first


def test_a_small_robot_that_creeps_at_its_full_speed_does_not_stand() -> None:
    """A Kilobot: 16.5 mm of radius, 1 cm/s. One of a metre that moves so stands."""
    pose = stretch([0.01] * 100)
    assert (arrives(pose, size=0.0233), arrives(pose, size=1.0)) == (-1, 50)


ROAD = """\
name: road
time: {step: 0.01, duration: 6.0}
corridor: {centreline: [[0, 0], [20, 0]], width: 8.0}
arrival: {tolerance: 0.1}
robots:
  - {name: stands, footprint: {length: 0.6, width: 0.4}, pose: [19.99, 0, 0], path: {offset: 0}}
  - {name: pushes, footprint: {length: 0.6, width: 0.4}, pose: POSE, path: {offset: 0}}
"""


class Push:
    """The second robot drives from 1 s to ``until``; the first stands all the time."""

    def __init__(self, until: float) -> None:
        self.until = until

    def decide(self, observation, memory):
        drives = observation.index == 1 and 1.0 <= observation.time < self.until
        return Decision(v=1.0 if drives else 0.0, omega=0.0, hold=0.01)


@pytest.mark.parametrize(
    ("pose", "little", "much", "words"),
    [
        ("[19.0, 0, 0]", 1.42, 4.0, "m past its stop station"),
        ("[19.85, -0.7, 1.5707963]", 1.35, 2.0, "m beside its stop station"),
    ],
)
def test_who_is_pushed_away_from_its_stop_has_not_arrived_any_more(
    pose: str, little: float, much: float, words: str
) -> None:
    """It stood 7.78 m past its stop, and the run was said to be finished."""
    world = physim.parse_world(ROAD.replace("POSE", pose))
    for until, is_far in ((little, False), (much, True)):
        record = physim.simulate(world, controller=Push(until))
        away = np.hypot(*(record.pose[-1, 0, :2] - record.pose[0, 0, :2]))
        assert (away > 0.25) == is_far
        assert away > 0.01
        assert (record.arrived[0] < 0) == is_far
        assert validate(record).code in (0, 1)
        text = [one.sentence("it") for one in Figures(record).absent if one.robot == 0]
        assert [words in one for one in text] == [True] * is_far
