"""What is compiled gives the bits of the plain functions, which another process runs."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from physim import load_world, simulate
from tests.geometry.cases import corridor_walls, random_scene
from tests.helpers import inside

(
    body_separation, build_wall_tree, clearances, collision_time_pair, find_swept_contacts,
    is_convex_part, nearest_walls, no_room, pack_polylines, put_arcs, track_all, Sight, SweptRows,
    wear_off,
) = inside(
    "physim.geometry", "body_separation", "build_wall_tree", "clearances", "collision_time_pair",
    "find_swept_contacts", "is_convex_part", "nearest_walls", "no_room", "pack_polylines",
    "put_arcs", "track_all", "Sight", "SweptRows", "wear_off",
)  # fmt: skip
Aim, Point, Target, best_plan, safe_target, speed_pairs = inside(
    "physim.controllers", "Aim", "Point", "Target", "best_plan", "safe_target", "speed_pairs"
)
Moves, Pairs, cut_short, failures, judge_arrivals = inside(
    "physim.simulation", "Moves", "Pairs", "cut_short", "failures", "judge_arrivals"
)


def distance_and_witness(rng: Any) -> Any:
    _, shapes, pose = random_scene(rng, 2, 2.0)
    return body_separation(shapes, 0, pose[0], shapes, 1, pose[1])


def collision_time(rng: Any) -> Any:
    """Of two that turn, of two on straight lines, of one and a wall."""
    _, shapes, pose = random_scene(rng, 2)
    twist, straight = rng.uniform(-1.0, 1.0, (2, 3)), np.array([rng.uniform(-1.0, 1.0), 0.0, 0.0])
    other = shapes, 1, pose[1]
    wall = corridor_walls(), 0, np.zeros(3), np.zeros(3)
    return (
        collision_time_pair(shapes, 0, pose[0], twist[0], *other, twist[1], 10.0),
        collision_time_pair(shapes, 0, pose[0], straight, *other, np.roll(straight, 1), 10.0),
        collision_time_pair(shapes, 0, pose[0], straight, *other, -straight, 10.0),
        collision_time_pair(*wall, *other, twist[0], 20.0),
    )


def arcs_and_tracking(rng: Any) -> Any:
    lines = pack_polylines([np.cumsum(rng.uniform(-1.0, 2.0, (6, 2)), axis=0) for _ in range(3)])
    pose, out, after = rng.uniform(0.0, 6.0, (2, 3)), np.empty((2, 3)), np.empty(6)
    put_arcs(pose, rng.uniform(-1.0, 1.0, (2, 3)), 2, 0.3, out)
    last, before = np.zeros(4, np.int64), rng.uniform(0.0, 5.0, 6)
    track_all(lines, 2, last, out, rng.uniform(0.5, 3.0, 2), before, after)
    return out, last, after


def arrivals(rng: Any) -> Any:
    lines = pack_polylines([np.cumsum(rng.uniform(0.1, 1.0, (4, 2)), axis=0) for _ in range(3)])
    ends = lines.row[lines.start[1:3] - 1, 4]
    bounds = np.stack((ends - 1.0, ends + 1.0, np.full(2, 0.2), np.full(2, 0.1)), axis=1)
    pose = np.c_[lines.points[lines.start[1:3] - 1] + rng.uniform(-0.5, 0.5, (2, 2)), [0.0, 1.0]]
    trail = np.tile(pose[:, :2], (3, 1)) + rng.normal(0.0, 0.1, (6, 2))
    stations, before = np.empty(6), np.concatenate((ends, np.zeros(2), ends))
    last, arrived = np.zeros(4, np.int64), np.empty(2, np.bool_)
    windows = np.ones(2)
    there = judge_arrivals(
        lines, 2, last, pose, windows, before, stations, 7, bounds, trail, 3, arrived
    )
    return there, stations, trail, arrived


def clearances_and_convexity(rng: Any) -> Any:
    bodies, shapes, _ = random_scene(rng, 4)
    poses = rng.uniform(-4.0, 9.0, (3, 4, 3))
    points = bodies[0][0]
    return clearances(poses, shapes, build_wall_tree(corridor_walls())), is_convex_part(
        points, len(points)
    )


def choice_of_speeds(rng: Any) -> Any:
    pairs = speed_pairs(np.array([0.0, 0.5, 1.0]), 0.8, np.array([-1.5, -0.7, 0.0, 0.7, 1.5]))
    pose, dwell = rng.uniform(-2.0, 2.0, 3), rng.uniform(0.05, 0.3, 2)
    return best_plan(pose, pairs, dwell, Aim(*rng.uniform(-2.0, 2.0, 2), 0.5))


def safe_targets(rng: Any) -> Any:
    tree = build_wall_tree(corridor_walls())
    x, y = rng.uniform(5.0, 35.0), rng.uniform(-4.0, 5.0)
    sight = Sight(tree, x, y, 12.0, nearest_walls(1))
    ahead, at = Point(0.6, 0.8), Point(x + 1.0, y + rng.uniform(-1.0, 1.0))
    target = Target(at, ahead, bool(rng.random() < 0.3))
    return safe_target(sight, target, Point(x, y), 1.5, rng.uniform(0.3, 4.0))


def swept_contacts(rng: Any) -> Any:
    _, shapes, old = random_scene(rng, 6)
    now = old + rng.uniform(-1.0, 1.0, (6, 3))
    room, velocity = no_room(shapes), np.empty((6, 3))
    out = SweptRows(np.zeros((40, 2), np.int64), np.zeros((40, 5)), 40)
    is_used_up = wear_off(old, now, 0.1, shapes.radius, room, velocity)
    tree = build_wall_tree(corridor_walls())
    count = find_swept_contacts(old, now, shapes, tree, room, 0.1, out)
    return is_used_up, count, out.who, out.values, velocity, room.apart


def stops_and_energy(rng: Any) -> Any:
    _, shapes, end = random_scene(rng, 6, 1.5)
    share, way = np.ones(4), rng.uniform(-2.0, 2.0, (4, 3))
    goes_on = np.array([False, False, rng.random() < 0.5, False])  # a mover, now and then
    moves = Moves(shapes, end, way, share, goes_on, 4, 6)
    key = np.array([a * 6 + b for a in range(4) for b in range(a + 1, 6)])
    cut_short(key, len(key), moves, 0.01)
    impulse, failed = np.zeros(len(key)), np.empty(4, np.bool_)
    inertia, given, found = rng.uniform(0.5, 2.0, (3, 4, 3))
    inertia[goes_on], found[goes_on] = 0.0, given[goes_on]
    some = key[rng.random(len(key)) < 0.2]
    pairs = Pairs(some, impulse[: len(some)], len(some))
    return (
        share,
        failures(pairs, inertia, given, found, 4, 6, 1.0, np.ones(4), failed),
        failed,
        impulse,
    )


def three_robots(_: Any) -> Any:
    """All rules of the paper's controller, for a second."""
    with simulate(load_world("three_robots", overrides=["time.duration=1.0"])) as record:
        return record.digest()


def jam(_: Any) -> Any:
    """Twelve robots that push each other and the end of a dead end."""
    few = ["time.duration=3.0", f"start.region={CLOSE}", "robots.0.count=12"]
    with simulate(load_world("jam", overrides=few)) as record:
        assert len(record.contacts) >= 50
        return record.digest()


CLOSE = [[11.2, -2.5], [14.9, -2.5], [14.9, 2.5], [11.2, 2.5]]
TIMES = {
    distance_and_witness: 200, collision_time: 60, arcs_and_tracking: 100, arrivals: 100,
    clearances_and_convexity: 20, choice_of_speeds: 20, safe_targets: 60, swept_contacts: 40,
    stops_and_energy: 60, three_robots: 1, jam: 1,
}  # fmt: skip
"""How often each is asked"""


def bits(value: Any) -> bytes:
    if isinstance(value, tuple):
        return b"(" + b",".join(map(bits, value)) + b")"
    return value.encode() if isinstance(value, str) else np.asarray(value, order="C").tobytes()


def outcomes() -> dict[str, list[str]]:
    """Hashes of what is found, by name."""
    return {
        find.__name__: [
            hashlib.sha256(bits(find(np.random.default_rng([52, k])))).hexdigest()
            for k in range(times)
        ]
        for find, times in TIMES.items()
    } | {"plain": [str(put_arcs.py_func is put_arcs)]}


@functools.cache
def by(kernels: str) -> dict[str, list[str]]:
    """`outcomes` in a process of its own."""
    script = "import json; from tests.test_compiled import outcomes; print(json.dumps(outcomes()))"
    ran = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PHYSIM_KERNELS": kernels},
        cwd=Path(__file__).parents[1],
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    found: dict[str, list[str]] = json.loads(ran.stdout)
    return found


@pytest.mark.parametrize("name", [find.__name__ for find in TIMES])
def test_compiled_and_plain_kernels_give_the_same_bits(name: str) -> None:
    compiled, plain = by("compiled"), by("plain")
    assert [compiled["plain"], plain["plain"]] == [["False"], ["True"]]
    assert compiled[name] == plain[name]


def test_threads_do_not_disturb_one_another() -> None:
    """The engine lets others run while it calls kernels."""
    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(jam, range(8)))) == 1
