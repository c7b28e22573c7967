"""Bookkeeping of contacts on hand-made histories and through the engine."""

from __future__ import annotations

import numpy as np
import pytest

from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.helpers import inside
from tests.oracles import contact_pairs as oracle
from tests.simulation.engine.hosts import ELL, box, drive, host, segments

joined_shapes, pack_parts = inside("physim.geometry", "joined_shapes", "pack_parts")
part_bodies = inside("physim.geometry", "part_bodies")
contact_rows, gather = inside("physim.simulation.engine", "contact_rows", "gather")

B = 10
NO_FACES = pack_parts([])


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
