"""Clearances against plain minima over all pairs and all wall parts."""

from __future__ import annotations

import numpy as np
import pytest

from tests.geometry.cases import BOX, corridor_walls, random_body
from tests.helpers import inside
from tests.oracles.clearances import clearances as plain_clearances
from tests.oracles.clearances import wall_distances

body_distance, build_wall_tree = inside("physim.geometry", "body_distance", "build_wall_tree")
ClearanceFinder, clearances = inside("physim.geometry", "ClearanceFinder", "clearances")
pack_parts = inside("physim.geometry", "pack_parts")


def random_run(rng, robots, samples):
    """Robots that drift and turn along a corridor, in small and sometimes in large steps."""
    shapes = pack_parts([random_body(rng) for _ in range(robots)])
    start = np.c_[
        rng.uniform(4, 16, robots), rng.uniform(-2, 2, robots), rng.uniform(-4, 4, robots)
    ]
    steps = rng.normal(0.0, [0.03, 0.02, 0.05], (samples, robots, 3)) + [0.02, 0.0, 0.0]
    steps[rng.random(samples) < 0.03] *= 40.0
    return shapes, start + np.cumsum(steps, axis=0)


def plain(pose, shapes, walls):
    """All distances of one sample: (N, N) with inf on the diagonal, (N, P)."""
    robots = len(pose)
    pairs = np.full((robots, robots), np.inf)
    for i in range(robots):
        for j in range(i + 1, robots):
            d = body_distance(shapes, i, pose[i], shapes, j, pose[j])
            pairs[i, j] = pairs[j, i] = d
    gaps = np.array([wall_distances(shapes, i, pose[i], walls) for i in range(robots)])
    return pairs, gaps


@pytest.mark.parametrize("seed", [5, 30, 100])
def test_equal_to_plain_minima(seed):
    rng = np.random.default_rng(seed)
    walls = corridor_walls(25.0)
    shapes, poses = random_run(rng, 6, 60)
    found = clearances(poses, shapes, build_wall_tree(walls))
    body = np.repeat(np.arange(3), np.diff(walls.body_start))
    for b in range(len(poses)):
        pairs, gaps = plain(poses[b], shapes, walls)
        assert found.clearance[b] == pytest.approx(pairs.min(axis=1), abs=1e-13)
        assert (pairs[np.arange(6), found.other[b]] <= pairs.min(axis=1) + 1e-13).all()
        assert (found.boundary_clearance[b] == gaps.min(axis=1)).all()
        assert (found.boundary_other[b] == 6 + body[gaps.argmin(axis=1)]).all()
        np.fill_diagonal(pairs, -np.inf)
        assert found.farthest[b] == pytest.approx(pairs.max(), abs=1e-13)
        a, c = found.farthest_a[b], found.farthest_b[b]
        assert a < c
        assert pairs[a, c] >= pairs.max() - 1e-13


def assert_same(found, expected):
    """Equal to the bit."""
    for name, one, other in zip(found._fields, found, expected, strict=True):
        np.testing.assert_array_equal(one, other, err_msg=name)


@pytest.mark.parametrize("seed", [0, 2, 3, 4])
def test_bit_equal_to_a_look_at_all_pairs(seed):
    """Robots that keep together, scatter, jump, lie on each other, or stand far from the rest."""
    rng = np.random.default_rng(seed)
    walls = corridor_walls(25.0)
    robots = 30
    shapes, poses = random_run(rng, robots, 40)
    poses[:, :, :2] *= [1.0, 2.0, 5.0, 0.05, 1.0, 1.0][seed]
    poses[:, 7, 0] += 1e4 * (seed == 4)
    poses[20:, 3:5] = poses[20:, 5:7]  # two are at the very place of two others, from then on
    assert_same(
        clearances(poses, shapes, build_wall_tree(walls)), plain_clearances(poses, shapes, walls)
    )


@pytest.mark.parametrize("gap", [1.0, 0.0])
def test_robots_in_rows_and_columns_tie_to_the_bit(gap):
    """Every robot has four others at the same distance, and there are two farthest pairs."""
    walls = corridor_walls(25.0)
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    shapes = pack_parts([[square]] * 36)
    places = (1.0 + gap) * np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), axis=-1)
    start = np.c_[places.reshape(36, 2), np.zeros(36)]
    poses = start + np.arange(12)[:, None, None] * np.array([0.25, 0.0, 0.0])
    found = clearances(poses, shapes, build_wall_tree(walls))
    assert_same(found, plain_clearances(poses, shapes, walls))
    assert (found.clearance == gap).all()


def test_blocks_give_what_all_samples_at_once_give():
    rng = np.random.default_rng(11)
    walls = corridor_walls(25.0)
    shapes, poses = random_run(rng, 9, 60)
    whole = clearances(poses, shapes, build_wall_tree(walls))
    finder = ClearanceFinder(shapes, build_wall_tree(walls))
    for first, last in ((0, 1), (1, 2), (2, 30), (30, 60)):
        assert_same(finder.find(poses[first:last]), [one[first:last] for one in whole])


def test_overlaps_are_negative():
    walls = corridor_walls(25.0)
    shapes = pack_parts([[BOX], [BOX], [BOX]])
    poses = np.array([[[5.0, 0.0, 0.0], [6.6, 0.1, 0.0], [12.0, 4.6, 0.0]]])
    found = clearances(poses, shapes, build_wall_tree(walls))
    assert found.clearance[0, :2] == pytest.approx([-0.2, -0.2])
    assert found.boundary_clearance[0, 2] < 0.0


def test_many_walls_near():
    comb = [[np.array([[0.02 * k, 3.0], [0.02 * k + 0.01, 3.1]])] for k in range(320)]
    walls = pack_parts(comb)
    shapes = pack_parts([[BOX]])
    poses = np.array([[[0.5 + 0.02 * k, 0.0, 0.1 * k]] for k in range(40)])
    found = clearances(poses, shapes, build_wall_tree(walls))
    for b in range(len(poses)):
        _, gaps = plain(poses[b], shapes, walls)
        assert found.boundary_clearance[b, 0] == gaps.min()


def test_one_robot_alone():
    walls = corridor_walls(25.0)
    found = clearances(np.array([[[5.0, 0.0, 0.0]]]), pack_parts([[BOX]]), build_wall_tree(walls))
    assert found.clearance[0, 0] == np.inf
    assert found.other[0, 0] == -1
    assert (found.farthest[0], found.farthest_a[0], found.farthest_b[0]) == (-np.inf, -1, -1)


def test_equally_near_robots_give_the_lowest():
    walls = corridor_walls(25.0)
    shapes = pack_parts([[BOX]] * 3)
    poses = np.array([[[8.0, 0.0, 0.0], [5.0, 0.0, 0.0], [11.0, 0.0, 0.0]]])
    found = clearances(poses, shapes, build_wall_tree(walls))
    assert list(found.other[0]) == [1, 0, 0]


def test_equally_near_walls_give_the_lowest():
    """Whichever was nearest before."""
    walls = pack_parts([[np.array([[0.0, y], [20.0, y]])] for y in (3.0, -3.0)])
    poses = np.array([[[8.0, y, 0.0]] for y in (-0.25, 0.0, 0.25, 0.0, -0.25, 0.0)])
    found = clearances(poses, pack_parts([[BOX]]), build_wall_tree(walls))
    assert found.boundary_other[:, 0].tolist() == [2, 1, 1, 1, 2, 1]


def test_a_robot_that_turns_on_the_spot_between_walls():
    """Its reference point rests, yet what was far from its ends comes near."""
    bar = np.array([[-2.0, -0.2], [2.0, -0.2], [2.0, 0.2], [-2.0, 0.2]])
    sides = [[[0.2, 0.6], [0.6, 0.6]], [[1.5, -1.4], [2.5, -1.4]], [[9.0, -9.0], [9.0, 9.0]]]
    shapes, walls = pack_parts([[bar]]), pack_parts([[np.array(side)] for side in sides])
    poses = np.zeros((30, 1, 3))
    poses[:, 0, 2] = -0.02 * np.arange(30)
    found = clearances(poses, shapes, build_wall_tree(walls))
    gaps = np.array([plain(pose, shapes, walls)[1][0] for pose in poses])
    assert (found.boundary_clearance[:, 0] == gaps.min(axis=1)).all()
    assert (found.boundary_other[:, 0] == 1 + gaps.argmin(axis=1)).all()
    assert set(found.boundary_other[:, 0]) == {1, 2}
