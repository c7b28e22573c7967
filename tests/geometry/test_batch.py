"""Batch forms equal the plain ones, pair by pair, to the last bit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.errors import PhysimError
from physim.geometry import (
    collision_time,
    collision_times,
    pack_shapes,
    shortest_distances,
)
from tests.geometry.cases import BOX, random_scene
from tests.geometry.test_collision_time import OMEGAS
from tests.helpers import inside

body_distance, pack_parts = inside("physim.geometry", "body_distance", "pack_parts")


def scene(seed=3, count=40):
    rng = np.random.default_rng(seed)
    bodies, shapes, _ = random_scene(rng, 6)
    index = rng.integers(0, 6, (2, count))
    pose = np.concatenate([rng.uniform(-4, 4, (2, count, 2)), rng.uniform(-4, 4, (2, count, 1))], 2)
    return rng, bodies, shapes, index, pose


def test_distances_equal_the_plain_form():
    _, _, shapes, index, pose = scene(count=300)
    found = shortest_distances(shapes, index[0], pose[0], shapes, index[1], pose[1])
    signed = [
        body_distance(shapes, index[0, k], pose[0, k], shapes, index[1, k], pose[1, k])
        for k in range(300)
    ]
    assert found.tolist() == [max(0.0, d) for d in signed]
    assert 0 < (found == 0.0).sum() < 300
    swapped = shortest_distances(shapes, index[1], pose[1], shapes, index[0], pose[0])
    assert swapped == pytest.approx(found, abs=1e-13)


@pytest.mark.parametrize("width", [2, 3])
def test_times_equal_the_plain_form(width):
    rng, bodies, shapes, index, pose = scene()
    twist = rng.uniform(-1.5, 1.5, (2, 40, width))
    twist[:, :, -1] = rng.choice(OMEGAS, (2, 40))
    arguments = (shapes, index[0], pose[0], twist[0], shapes, index[1], pose[1], twist[1])
    found = collision_times(*arguments, 8.0)
    plain = [
        collision_time(
            bodies[index[0, k]], pose[0, k], twist[0, k],
            bodies[index[1, k]], pose[1, k], twist[1, k], 8.0,
        )
        for k in range(40)
    ]  # fmt: skip
    assert found.tolist() == plain
    assert 5 < np.isfinite(found).sum() < 40


def test_one_serves_for_all_and_twists_may_differ_in_kind():
    shapes = pack_parts([[BOX]])
    poses = np.array([[5.0, 0.0, 0.0], [1.8, 0.0, 0.0], [5.0, 3.0, 0.0]])
    found = collision_times(shapes, 0, (0, 0, 0), (1, 0), shapes, 0, poses, (0, 0, 0))
    assert found == pytest.approx([3.2, 0.0, math.inf], abs=1e-12)
    gaps = shortest_distances(shapes, 0, (0, 0, 0), shapes, [0, 0, 0], poses)
    assert gaps == pytest.approx([3.2, 0.0, math.hypot(3.2, 2.0)], abs=1e-12)
    assert shortest_distances(shapes, 0, (0, 0, 0), shapes, 0, (3, 0, 0)).shape == (1,)
    assert shortest_distances(shapes, [], np.zeros((0, 3)), shapes, [], (0, 0, 0)).shape == (0,)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"index_a": [0, 1]}, "index_a: body 1.*0 to 0"),
        ({"index_a": [0, -1]}, "index_a: body -1"),
        ({"index_a": [0.5, 0.0]}, "index_a: float64.*whole"),
        ({"index_b": [0, 0, 0]}, "index_a|index_b|pose_"),
        ({"pose_a": np.zeros((2, 2))}, "pose_a.*3"),
        ({"pose_b": [[0, 0, 0], [0, math.nan, 0]]}, "pose_b: row 1"),
        ({"twist_b": np.zeros((2, 4))}, "twist_b.*2.* or .*3"),
        ({"twist_a": "fast"}, "twist_a"),
        ({"horizon": -1.0}, "horizon"),
    ],
)
def test_bad_input_is_refused(change, words):
    shapes = pack_parts([[BOX]])
    good = {
        "shapes_a": shapes,
        "index_a": [0, 0],
        "pose_a": np.zeros((2, 3)),
        "twist_a": np.zeros((2, 2)),
        "shapes_b": shapes,
        "index_b": [0, 0],
        "pose_b": np.ones((2, 3)),
        "twist_b": np.zeros((2, 2)),
    }
    given = {**good, **change}
    with pytest.raises(PhysimError, match=words):
        collision_times(**given)
    if {"twist_a", "twist_b", "horizon"}.isdisjoint(change):
        for name in ("twist_a", "twist_b"):
            del given[name]
        with pytest.raises(PhysimError, match=words):
            shortest_distances(**given)


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
NOTCHED = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.0, 2.0]])


def test_bodies_are_packed_whichever_way_they_go_round_and_nonconvex_ones_too():
    shapes = pack_shapes([SQUARE, SQUARE[::-1], [SQUARE[::-1]], NOTCHED, NOTCHED[::-1]])
    still, ahead = np.zeros(3), np.array([3.0, 0.0, 0.0])
    inside = np.array([0.9, 0.9, 0.0])  # in the notch, 0.4 m from both arms
    assert shortest_distances(shapes, range(3), still, shapes, 1, ahead).tolist() == [2.0] * 3
    toward = collision_times(shapes, range(3), still, [1.0, 0.0], shapes, 1, ahead, [0.0, 0.0], 9.0)
    assert toward == pytest.approx([2.0] * 3)
    notch = shortest_distances(shapes, [3, 4], still, shapes, [0, 1], inside)
    assert notch == pytest.approx([0.4, 0.4])
