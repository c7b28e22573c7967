"""Bookkeeping of contacts on hand-made histories and through the engine."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hosts import ELL, box, drive, host, segments

from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.helpers import inside
from tests.oracles import contact_pairs as oracle

joined_shapes, pack_parts = inside("physim.geometry", "joined_shapes", "pack_parts")
part_bodies = inside("physim.geometry", "part_bodies")
Pairs, contact_rows, gather = inside("physim.simulation.engine", "Pairs", "contact_rows", "gather")
hold_back, split = inside("physim.simulation.engine", "hold_back", "split")

B = 10
NO_FACES = pack_parts([])


def keys(*pairs):
    return np.array(sorted(a * B + b for a, b in pairs), dtype=np.int64)


def test_gather_adds_parts_and_sorts_bodies():
    part = np.array([[4, 1], [0, 9], [1, 3], [0, 2]])
    body = np.array([0, 1, 2, 3, 3, 5, 6, 7, 8, 9])  # 3 and 4 are parts of one body
    key, impulse = gather(body[part], np.array([1.0, 2.0, 4.0, 8.0]), B)
    assert split(key, B).tolist() == [[0, 2], [0, 9], [1, 3]]
    assert impulse.tolist() == [8.0, 2.0, 5.0]


def test_gather_of_nothing():
    key, impulse = gather(np.zeros((0, 2), dtype=np.int64), np.zeros(0), B)
    assert len(key) == len(impulse) == 0


def in_a_row(distance=1.0):
    """Ten boxes 1 m long, one ahead of the other."""
    pose = np.zeros((B, 3))
    pose[:, 0] = distance * np.arange(B)
    return pack_parts([[box()]] * B), pose


def account(step, before, now, pushes=None, distance=1.0):
    shapes, pose = in_a_row(distance)
    rows = np.empty(len(before) + len(now.key), CONTACT_ROW)
    pushes = pushes or Pairs(keys(), np.zeros(0))
    return rows[: contact_rows(step, before, *now, *pushes, shapes, NO_FACES, pose, rows)]


def test_phases_of_a_history():
    history = [keys(), keys((0, 1)), keys((0, 1), (0, 2)), keys((0, 2)), keys(), keys((0, 1))]
    told = [
        [tuple(row) for row in account(1, before, Pairs(now, np.zeros(len(now))))[
            ["a", "b", "phase"]
        ].tolist()]
        for before, now in pairwise(history)
    ]  # fmt: skip
    began, stays, ended = Phase.BEGAN, Phase.STAYS, Phase.ENDED
    assert told == [
        [(0, 1, began)],
        [(0, 1, stays), (0, 2, began)],
        [(0, 1, ended), (0, 2, stays)],
        [(0, 2, ended)],
        [(0, 1, began)],
    ]


def test_impulses_of_push_and_impact_add_up():
    push = Pairs(keys((0, 1), (2, 3)), np.array([1.0, 50.0]))
    impact = Pairs(keys((0, 1), (0, 2)), np.array([2.0, 3.0]))
    rows = account(1, keys((0, 3)), impact, push)
    assert rows["impulse"].tolist() == [3.0, 3.0, 0.0]


def test_rows_tell_where_and_how_deep():
    rows = account(6, keys((0, 2)), Pairs(keys((0, 1)), np.array([7.0])), distance=0.75)
    assert rows.dtype == CONTACT_ROW
    assert rows[0].tolist() == (6, 0, 1, 0, Kind.PHYSICAL, 0.375, 0.0, 1.0, 0.0, 0.25, 7.0)
    assert rows[1].tolist() == (6, 0, 2, 2, Kind.PHYSICAL, 0.75, 0.0, 1.0, 0.0, -0.5, 0.0)


def test_just_touching_has_the_depth_nought():
    rows = account(1, keys(), Pairs(keys((0, 1)), np.zeros(1)), distance=1.0)
    assert rows["depth"].tobytes() == np.zeros(1).tobytes()  # and not minus nought


def test_bookkeeping_is_that_of_sets_and_columns():
    """Bit for bit: contacts of parts in any order, of robots and of walls of many segments."""
    rng = np.random.default_rng(0)
    robots = [ELL if k % 3 else [box()] for k in range(7)]
    walls = [
        segments(rng.uniform(-4, 4, (40, 2)).tolist()),
        [box(0.3, 0.3)],
        segments([(0, 0), (1, 3)]),
    ]
    shapes = joined_shapes(pack_parts(robots), pack_parts(walls))
    owner = part_bodies(shapes)
    touched = np.zeros(0, dtype=np.int64)
    for step in range(300):
        pose = np.zeros((B, 3))
        pose[:7] = rng.uniform(-3, 3, (7, 3))
        contacts = []
        for many in rng.integers(0, 40, 2):
            part = rng.integers(0, len(owner), (many, 2))
            part = part[(owner[part[:, 0]] != owner[part[:, 1]]) & (owner[part] < 7).any(axis=1)]
            impulse = rng.exponential(1.0, len(part))
            contacts.append(oracle.gather(owner[part], impulse, B))
            key, total = gather(owner[part], impulse, B)
            assert key.tobytes() == contacts[-1].key.tobytes()
            assert total.tobytes() == contacts[-1].impulse.tobytes()
        now, pushes = contacts
        rows = np.empty(len(touched) + len(now.key), CONTACT_ROW)
        rows = rows[: contact_rows(step, touched, *now, *pushes, shapes, NO_FACES, pose, rows)]
        assert (
            rows.tobytes()
            == oracle.contact_rows(step, touched, now, pushes, shapes, pose).tobytes()
        )
        touched = now.key


def test_only_what_is_pushed_is_held_back():
    wanted, allowed = np.ones((4, 3)), np.arange(12.0).reshape(4, 3)
    hold_back(keys((0, 2), (2, 7)), B, allowed, wanted)
    assert wanted.tolist() == [[0, 1, 2], [1, 1, 1], [6, 7, 8], [1, 1, 1]]


def test_a_visit_to_a_wall_is_one_episode():
    physics = host([[1.3, 0.0, 0.0]], walls=[[[(2.0, -5.0), (2.0, 5.0)]]])
    _, first = drive(physics, [1.0, 0.0], 10)
    _, then = drive(physics, [-1.0, 0.0], 5)
    rows = np.concatenate(first + then[1:])
    assert rows["phase"].tolist() == [Phase.BEGAN] + [Phase.STAYS] * 6 + [Phase.ENDED]
    assert rows["step"].tolist() == list(range(4, 12))
    last = rows[-1]
    assert (last["depth"], last["nx"], last["ny"]) == pytest.approx((-0.05, 1.0, 0.0), abs=1e-3)
    assert last["x"] == pytest.approx(1.975, abs=1e-3)  # midway in the gap
    assert not physics.touching.any()


def test_contact_at_the_start_is_found():
    physics = host([[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [3.0, 0.0, 0.0]])
    (row,) = physics.contacts
    assert row.tolist()[:5] == (0, 0, 1, Phase.BEGAN, Kind.PHYSICAL)
    assert (row["x"], row["y"]) == pytest.approx((0.5, 0.05), abs=1e-12)
    assert (row["nx"], row["ny"], row["depth"]) == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    assert physics.touching.tolist() == [True, True, False]
    assert physics.pose[:, 0].tolist() == [0.0, 1.0, 3.0]
