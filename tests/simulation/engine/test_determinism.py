"""The same scene runs the same, to the last bit."""

from __future__ import annotations

import numpy as np

from physim.tolerances import CONTACT
from tests.helpers import inside
from tests.simulation.engine.hosts import ELL, box, distances, host, pairs_in, segments

pack_parts = inside("physim.geometry", "pack_parts")

RING = [(-6, -5), (0, -5), (6, -5), (6, 5), (0, 6), (-6, 5), (-6, -5)]
ROBOTS = [ELL if k % 3 == 0 else [box(0.6 + 0.02 * k, 0.4 + 0.01 * k)] for k in range(20)]


def jam(steps, seed=5):
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-5, 5, 5), np.linspace(-4, 4, 4))
    start = np.column_stack((x.ravel(), y.ravel(), rng.uniform(-3, 3, 20)))
    physics = host(start, ROBOTS, walls=[segments(RING)])
    for _ in range(steps):
        pose = physics.pose
        wanted = np.arctan2(-pose[:, 1], -pose[:, 0])
        error = np.remainder(wanted - pose[:, 2] + np.pi, 2 * np.pi) - np.pi
        physics.step(np.column_stack((np.cos(error), np.clip(2 * error, -1, 1))))
        yield physics


def test_two_hosts_of_a_jam_are_bit_equal():
    rows = 0
    for one, other in zip(jam(120), jam(120), strict=True):
        assert one.pose.tobytes() == other.pose.tobytes()
        assert one.contacts.tobytes() == other.contacts.tobytes()
        rows += len(one.contacts)
    assert rows > 500


def test_nothing_is_missed_or_thrown_in_a_jam():
    shapes, walls = pack_parts(ROBOTS), pack_parts([segments(RING)])
    last = None
    for physics in jam(150):
        exact = distances(shapes, walls, physics.pose)
        assert pairs_in(physics.contacts) == {p for p, d in exact.items() if d <= CONTACT}
        if last is not None:
            # Commanded 0.05 m a step; easing of overlaps and turning add a little.
            assert np.hypot(*(physics.pose - last)[:, :2].T).max() < 0.1
        last = physics.pose
