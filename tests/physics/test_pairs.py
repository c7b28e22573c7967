"""Bookkeeping of contacts on hand-made histories and through the engine."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hosts import drive, host

from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.simulation.engine.pairs import (
    Pairs,
    contact_rows,
    gather,
    impulse_of,
    phases,
    split,
)

B = 10


def keys(*pairs):
    return np.array(sorted(a * B + b for a, b in pairs), dtype=np.int64)


def test_gather_adds_parts_and_sorts_bodies():
    body = np.array([[3, 1], [0, 9], [1, 3], [0, 2]])
    pairs = gather(body, np.array([1.0, 2.0, 4.0, 8.0]), B)
    assert split(pairs.key, B).tolist() == [[0, 2], [0, 9], [1, 3]]
    assert pairs.impulse.tolist() == [8.0, 2.0, 5.0]


def test_gather_of_nothing():
    pairs = gather(np.zeros((0, 2), dtype=np.int64), np.zeros(0), B)
    assert len(pairs.key) == len(pairs.impulse) == 0


def test_phases_of_a_history():
    history = [keys(), keys((0, 1)), keys((0, 1), (0, 2)), keys((0, 2)), keys(), keys((0, 1))]
    told = []
    for before, now in pairwise(history):
        both = np.union1d(before, now)
        told.append(
            [
                (*p, int(f))
                for p, f in zip(split(both, B).tolist(), phases(both, before, now), strict=True)
            ]
        )
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
    assert impulse_of(keys((0, 1), (0, 2), (0, 3)), push, impact).tolist() == [3.0, 3.0, 0.0]


def test_rows_from_columns():
    found = np.array([[1.0, 2.0, 0.0, 1.0, -0.25], [3.0, 4.0, 1.0, 0.0, 0.5]])
    rows = contact_rows(
        6, np.array([[0, 1], [0, 4]]), np.array([0, 2], dtype="i1"), found, np.array([7.0, 8.0])
    )
    assert rows.dtype == CONTACT_ROW
    assert rows[0].tolist() == (6, 0, 1, 0, Kind.PHYSICAL, 1.0, 2.0, 0.0, 1.0, 0.25, 7.0)
    assert rows[1].tolist() == (6, 0, 4, 2, Kind.PHYSICAL, 3.0, 4.0, 1.0, 0.0, -0.5, 8.0)


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
