"""What a decision works out by bounds agrees bit for bit with plain loops over everything."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from physim.geometry import Shapes
from tests.controllers.random_scenes import BOX, convex_part, footprint
from tests.controllers.scenes import near_field
from tests.helpers import inside
from tests.oracles import avoidance as plain

longest_pair, smallest_distance = inside("physim.controllers", "longest_pair", "smallest_distance")
smallest_time, widest_pair = inside("physim.controllers", "smallest_time", "widest_pair")
NearField, speed_pairs, Bodies = inside("physim.controllers", "NearField", "speed_pairs", "Bodies")
facings, IntArray, pack_parts = inside("physim.geometry", "facings", "IntArray", "pack_parts")

PERIOD, AHEAD = 0.1, 0.5
OMEGAS = np.array([-np.pi / 2.0, -np.pi / 4.0, 0.0, np.pi / 4.0, np.pi / 2.0])


class Around(NamedTuple):
    """A robot among others and walls, about to decide."""

    bodies: Bodies
    rows: IntArray
    walls: Shapes
    parts: IntArray
    pairs: np.ndarray
    target: tuple[float, float]
    horizon: float


def packed(
    rng: np.random.Generator, footprints: list, pose: np.ndarray, command: np.ndarray, walls: list
) -> Around:
    order = np.arange(len(pose))
    bodies = Bodies(
        pack_parts(footprints), order, order, pose, command, np.zeros(len(pose)), facings(pose)
    )
    rows = np.flatnonzero(rng.random(len(pose)) < 0.8)
    return Around(
        bodies,
        rows[rows != 0],
        pack_parts([[part] for part in walls]),
        np.arange(len(walls)),
        speed_pairs(np.array([-1.0, 0.0, 1.0]), float(rng.uniform(0.3, 1.3)), OMEGAS),
        tuple(pose[0, :2] + rng.uniform(-2.0, 2.0, 2)),
        float(rng.choice([1.0, 4.0, 10.0])),
    )


def anywhere(rng: np.random.Generator) -> Around:
    """All shapes, places, commands; from so dense that they overlap to nearly alone."""
    n = int(rng.integers(1, 9))
    side = rng.choice([2.0, 5.0, 12.0])
    pose = rng.uniform(-1.0, 1.0, (n, 3)) * [side, side, np.pi]
    command = np.stack(
        [
            rng.choice([0.0, -1.0, 1.0, rng.uniform(-1.5, 1.5)], n),
            rng.choice([0.0, *OMEGAS, 1e-7, rng.uniform(-3.0, 3.0)], n),
        ],
        axis=1,
    )
    walls = [rng.uniform(-side, side, (2, 2)) for _ in range(rng.integers(4))]
    walls += [convex_part(rng, 1.0, rng.uniform(-side, side, 2)) for _ in range(rng.integers(2))]
    return packed(rng, [footprint(rng) for _ in range(n)], pose, command, walls)


def in_rows(rng: np.random.Generator) -> Around:
    """Equal boxes in rows with equal headings and speeds, along straight walls: ties everywhere."""
    n = int(rng.integers(2, 12))
    place = rng.permutation(16)[:n]
    turn = float(rng.choice([0.0, 0.5 * np.pi, 0.3]))
    x, y = 2.1 * (place // 4) - 3.0, 1.25 * (place % 4) - 1.875
    c, s = np.cos(turn), np.sin(turn)
    pose = np.stack([c * x - s * y, s * x + c * y, np.full(n, turn)], axis=1)
    command = np.zeros((n, 2)) + [rng.choice([0.0, 1.0]), rng.choice([0.0, np.pi / 4.0])]
    command[rng.random(n) < 0.3] = 0.0
    corners = np.array(
        [[-9.0, -2.6], [0.0, -2.6], [9.0, -2.6], [9.0, 2.6], [0.0, 2.6], [-9.0, 2.6]]
    )
    outline = corners @ np.array([[c, s], [-s, c]])
    walls = [outline[[k, (k + 1) % 6]] for k in range(6)]
    return packed(rng, [tuple(BOX)] * n, pose, command, walls)


@pytest.fixture(scope="module")
def scenes() -> list[Around]:
    drawn = [anywhere(np.random.default_rng([31, k])) for k in range(250)]
    return drawn + [in_rows(np.random.default_rng([32, k])) for k in range(100)]


def looked(scene: Around, translation: bool = False) -> NearField:
    return near_field(scene.bodies, scene.rows, scene.walls, translation)


def test_distances_now(scenes: list[Around]) -> None:
    deep = 0
    for scene in scenes:
        bodies, near = scene.bodies, looked(scene)
        mine = bodies.pose[0]
        expected = plain.smallest_distance(bodies, 0, mine, scene.rows, bodies.pose)
        assert smallest_distance(bodies, near) == expected
        deep += expected < 0.0
    assert 20 <= deep <= 200


@pytest.mark.parametrize("translation", [False, True], ids=["arc", "translation"])
def test_times_and_the_choice_by_13(scenes: list[Around], translation: bool) -> None:
    met = tied = 0
    for scene in scenes[::2] if translation else scenes:
        bodies, near = scene.bodies, looked(scene, translation)
        times = [
            plain.smallest_time(
                bodies, 0, pair, scene.rows, scene.walls, scene.parts, scene.horizon, translation
            )
            for pair in scene.pairs
        ]
        found = [smallest_time(bodies, near, p, scene.horizon, -1.0) for p in scene.pairs]
        assert found == times
        enough = float(np.median(times))
        for pair, time in zip(scene.pairs, times, strict=True):
            short = smallest_time(bodies, near, pair, scene.horizon, enough)
            assert short == time or time <= short < enough
        judged = plain.judgements(bodies.pose[0], scene.pairs, PERIOD, AHEAD, scene.target)
        expected = plain.first_of_the_best(times, judged)
        # What is known from before: nothing of a candidate, and the time of one of them.
        for known, time in ((np.array([9.0, 9.0]), 5.0), (scene.pairs[-1], times[-1])):
            choice = longest_pair(
                bodies, looked(scene, translation), scene.pairs, known, time, scene.horizon,
                PERIOD, AHEAD, *scene.target,
            )  # fmt: skip
            assert choice == (expected, times[expected])
        met += sum(0.0 < time < np.inf for time in times)
        tied += times.count(max(times)) > 1
    assert met >= 300
    assert tied >= 20


@pytest.mark.parametrize("walls_count", [False, True])
def test_the_choice_by_12(scenes: list[Around], walls_count: bool) -> None:
    for scene in scenes:
        bodies = scene.bodies
        parts = scene.parts if walls_count else scene.parts[:0]
        widths = plain.widths(bodies, 0, scene.pairs, scene.rows, scene.walls, parts, 4.0 * PERIOD)
        judged = plain.judgements(bodies.pose[0], scene.pairs, 4.0 * PERIOD, AHEAD, scene.target)
        expected = plain.first_of_the_best(widths, judged)
        choice = widest_pair(
            bodies, looked(scene), scene.pairs, walls_count, 4.0 * PERIOD, AHEAD, *scene.target
        )
        assert choice == expected
