"""Stations followed from step to step: on the own path, and on the reference path."""

from __future__ import annotations

import numpy as np
import pytest

from physim.geometry.path import Tracking
from physim.geometry.shapes import pack_polylines

OWN = [[[0.0, 2.0], [60.0, 2.0]], [[10.0, -3.0], [10.0, 40.0]]]
REFERENCE = [[-5.0, 0.0], [60.0, 0.0]]


@pytest.mark.parametrize("step", [0.015, 0.15])
def test_stations_follow_the_robots(step: float) -> None:
    """Two robots on straight paths, seen from a reference path that begins elsewhere."""
    t = step * np.arange(100)
    poses = np.zeros((100, 2, 3))
    poses[:, 0, 0], poses[:, 0, 1] = 3.0 + t, 2.5
    poses[:, 1, 0], poses[:, 1, 1] = 9.0, 1.0 + t
    paths, reference = pack_polylines(OWN), pack_polylines([REFERENCE])
    tracking = Tracking(paths, reference, np.array([0.2, 1.0]), poses[0])
    one_by_one = []
    for pose in poses:
        tracking.follow(pose)
        one_by_one.append(
            np.stack((tracking.station, tracking.deviation, tracking.reference_station), axis=1)
        )
    found = np.array(one_by_one)
    assert found[:, 0, 0] == pytest.approx(3.0 + t)
    assert found[:, 1, 0] == pytest.approx(4.0 + t)
    assert found[:, :, 1] == pytest.approx(np.tile([0.5, 1.0], (100, 1)))  # left positive
    assert found[:, 0, 2] == pytest.approx(8.0 + t)
    assert found[:, 1, 2] == pytest.approx(np.full(100, 14.0))
    again = Tracking(paths, reference, np.array([0.2, 1.0]), poses[0])
    assert np.array_equal(again.course(poses), found)


def test_a_path_that_passes_near_itself_does_not_attract() -> None:
    """Out along one leg of a hairpin 0.8 m wide, nearer to the other leg."""
    paths = pack_polylines([[[0.0, 0.0], [30.0, 0.0], [30.0, 0.8], [0.0, 0.8]]])
    start = np.array([[1.0, 0.1, 0.0]])
    tracking = Tracking(paths, paths, np.array([0.5]), start)
    for x in np.arange(1.0, 25.0, 0.1):
        tracking.follow(np.array([[x, 0.5, 0.0]]))
    assert tracking.station == pytest.approx([24.9])
    assert tracking.reference_station == pytest.approx([24.9])
