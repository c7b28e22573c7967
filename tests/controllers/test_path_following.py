"""Path following, (2) to (6): projections, targets and plans against slow oracles."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from physim import Scene
from tests.controllers.random_scenes import offset_line
from tests.controllers.scenes import scene_of, single_robot
from tests.helpers import inside
from tests.oracles import path_following, paths
from tests.oracles.choice import smallest
from tests.oracles.tolerances import ROUNDING

Aim, best_plan = inside("physim.controllers", "Aim", "best_plan")
judging_time = inside("physim.controllers", "judging_time")
speed_pairs, SpeedPairs = inside("physim.controllers", "speed_pairs", "SpeedPairs")
target_energy = inside("physim.controllers", "target_energy")
target_on_path = inside("physim.controllers", "target_on_path")
pack_polylines, Tracking = inside("physim.geometry", "pack_polylines", "Tracking")

OMEGAS = [[-0.7, 0.0, 0.7], [0.0, 1.5, -0.8], [-1.5, -0.75, 0.0, 0.75, 1.5]]


def test_target_is_look_ahead_further_along() -> None:
    past = 0
    for k in range(400):
        rng = np.random.default_rng([20, k])
        road = rng.uniform(-20.0, 20.0, (int(rng.integers(2, 7)), 2))
        end = paths.lengths(road)[-1]
        station, look_ahead = rng.uniform(-1.0, end + 1.0), rng.uniform(0.1, 4.0)
        found = target_on_path(pack_polylines([road[::-1], road]), 1, station, look_ahead)
        point, direction = paths.target(road, station, look_ahead)
        assert np.allclose(found, [*point, *direction], rtol=0.0, atol=ROUNDING)
        past += station + look_ahead > end
    assert past >= 20


def test_energy_4_is_half_the_squared_distance() -> None:
    assert target_energy(np.array([1.0, 2.0]), np.array([4.0, -2.0])) == 12.5


def test_pairs_are_all_of_both_sets_in_their_order() -> None:
    found = speed_pairs(np.array([-1.0, 0.5]), 0.8, np.array([0.0, -1.0, 2.0]))
    expected = [(-0.8, 0.0), (-0.8, -1.0), (-0.8, 2.0), (0.4, 0.0), (0.4, -1.0), (0.4, 2.0)]
    assert found.each.tolist() == [list(pair) for pair in expected]


def test_plans_are_judged_no_further_than_to_the_last_waypoint() -> None:
    assert judging_time(0.5, 0.3, 1.0) == 0.3
    assert judging_time(0.5, 0.3, 2.0) == 0.15
    assert judging_time(0.5, 3.0, 1.0) == 0.5
    assert judging_time(0.5, 0.0, 1.0) == 0.0
    assert judging_time(0.5, 0.3, 0.0) == 0.5


@pytest.mark.parametrize("dwells", [1, 2, 3])
def test_best_plan_is_that_of_trying_all(dwells: int) -> None:
    unequal = 0
    for k in range(100):
        rng = np.random.default_rng([21, dwells, k])
        omegas = OMEGAS[rng.integers(3 if dwells < 3 else 2)]
        speeds = [[1.0], [-1.0, 0.0, 1.0], [0.0, 0.5, 1.0]][rng.integers(3)]
        pairs = path_following.pairs(speeds, rng.uniform(0.3, 1.5), omegas)
        dwell = rng.uniform(0.02, 0.3, dwells)
        pose = np.array([*rng.uniform(-20.0, 20.0, 2), rng.uniform(-9.0, 9.0)])
        target = pose[:2] + rng.normal(0.0, rng.choice([0.05, 2.0]), 2)
        ahead = float(rng.choice([0.0, 0.5, 1.0]))
        plan = best_plan(pose, SpeedPairs(pairs, len(pairs)), dwell, Aim(*target, ahead))
        sequences = path_following.plans(pairs, dwell)
        right, _ = smallest(path_following.judgements(pose, sequences, dwell, ahead, target))
        assert any(np.array_equal(plan, sequences[c]) for c in right)
        unequal += len({tuple(pair) for pair in plan}) > 1
    assert unequal >= (0 if dwells == 1 else 8)


def test_at_its_target_a_robot_stands_still() -> None:
    """All turns on the spot end at the target, where no heading is wrong: |omega| decides."""
    for heading in (-2.0, 0.5, 3.0):
        pairs = speed_pairs(np.array([0.0, 1.0]), 1.0, np.array([-0.7, 0.7, 0.0]))
        plan = best_plan(np.array([4.0, 2.0, heading]), pairs, np.array([0.1]), Aim(4.0, 2.0, 0.5))
        assert plan.tolist() == [[0.0, 0.0]]


@pytest.mark.parametrize("dwells", [2, 3])
def test_of_mirror_images_the_first_in_the_order_of_the_sets_is_taken(dwells: int) -> None:
    """Straight before a target, a plan and its mirror image end equally near to it."""
    by_order = 0
    for k in range(60):
        rng = np.random.default_rng([23, dwells, k])
        turn = float(rng.uniform(0.5, 4.0))
        pairs = path_following.pairs([1.0], 1.0, rng.permutation([-turn, 0.0, turn]))
        dwell = rng.uniform(0.1, 0.5, dwells)
        pose = np.array([*rng.uniform(-5.0, 5.0, 2), rng.uniform(-3.0, 3.0)])
        gap = rng.uniform(0.05, 1.0) * dwell.sum()
        target = pose[:2] + gap * np.array([np.cos(pose[2]), np.sin(pose[2])])
        plan = best_plan(pose, SpeedPairs(pairs, len(pairs)), dwell, Aim(*target, 0.0))
        sequences = path_following.plans(pairs, dwell)
        keys = path_following.judgements(pose, sequences, dwell, 0.0, target)
        right, settled = smallest(keys)
        assert any(np.array_equal(plan, sequences[c]) for c in right)
        by_order += settled == 4
    assert by_order >= 20


# The projection is continuous in time, and deviations are positive to the left


def hairpin(rng: np.random.Generator) -> np.ndarray:
    """A path that comes back beside itself, 0.8 to 1.5 m away, and then crosses itself."""
    gap, length = rng.uniform(0.8, 1.5), rng.uniform(8.0, 12.0)
    line = np.array([[0, 0], [length, 0], [length, gap], [2.0, gap], [2.0, -4.0], [6.0, -4.0]])
    angle = rng.uniform(-np.pi, np.pi)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    mirror = rng.choice([-1.0, 1.0])
    return (line * [1.0, mirror]) @ turn + rng.uniform(-20.0, 20.0, 2)


def tracking(scene: Scene) -> Tracking:
    """Projections of a scene's robots, followed as a simulation does."""
    return Tracking(scene.paths, scene.reference, scene.shapes.radius, scene.start)


def test_projection_follows_the_robot_along_a_path_that_nears_and_crosses_itself() -> None:
    jumps = 0
    for k in range(6):
        rng = np.random.default_rng([22, k])
        path = hairpin(rng)
        reference = offset_line(path, 0.05)
        end = paths.lengths(path)[-1]
        robot = single_robot(path, 0.0)
        history = dataclasses.replace(robot, reference=reference)
        known = tracking(scene_of(history))
        window = 1.0  # two circumscribed radii, 1 m at least
        station = reference_station = 0.0
        side = rng.uniform(-0.3, 0.3)
        for gone in np.arange(0.0, end, 0.1):
            point, ahead = paths.point_at(path, gone)
            xy = point + side * np.array([-ahead[1], ahead[0]])
            known.follow(np.array([[*xy, 0.0]]))
            station, deviation = paths.followed_station(path, xy, station, window)
            reference_station, _ = paths.followed_station(reference, xy, reference_station, window)
            assert abs(known.station[0] - station) <= ROUNDING
            assert abs(known.deviation[0] - deviation) <= ROUNDING
            assert abs(known.reference_station[0] - reference_station) <= ROUNDING
            jumps += abs(paths.nearest_station(path, xy)[0] - station) > 2.0
        assert station > end - 1.0
    assert jumps >= 25  # where the nearest point of all lies on another branch


def test_deviation_is_positive_to_the_left() -> None:
    known = tracking(scene_of(single_robot(np.array([[0.0, 0.0], [0.0, 10.0]]), 4.0)))
    known.follow(np.array([[-0.3, 4.0, 0.0]]))
    assert known.station[0] == pytest.approx(4.0)
    assert known.deviation[0] == pytest.approx(0.3)
    known.follow(np.array([[0.2, 4.1, 0.0]]))
    assert known.deviation[0] == pytest.approx(-0.2)
