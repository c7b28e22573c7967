"""Each part is broken on purpose, and the validator must say so."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from physim.analysis.validation import analytic_contacts as ledger
from physim.analysis.validation import prediction, report, validate
from tests.analysis.validation.runs import edited, side_by_side, states
from tests.helpers import inside

collision_time_pair, pack_parts = inside("physim.geometry", "collision_time_pair", "pack_parts")

FALSE_CONTACT = 1073
"""a seed at which the engine without its guard reports contacts of robots that are 0.2 m apart"""


def said(found):
    return " ".join(report(found).split())


def shrunk(shapes):
    """Footprints drawn in by 1 cm on every side, about."""
    parts = np.split(shapes.vertices, shapes.part_start[1:-1])
    smaller = [part - 0.01 * part / abs(part).max() for part in parts]
    return pack_parts([smaller[first:last] for first, last in pairwise(shapes.body_start.tolist())])


def test_footprints_shrunk_in_the_analytic_check(monkeypatch, rear_end, apart):
    assert validate(rear_end).code == 1
    assert validate(apart).code == 0
    right = ledger.near_rows
    monkeypatch.setattr(
        ledger,
        "near_rows",
        lambda poses, start, shapes, *more: right(poses, start, shrunk(shapes), *more),
    )
    found = validate(rear_end)
    assert found.code == 3
    assert found.verdict.startswith("checks disagree: ")
    assert "by the shapes" in said(found)
    # and without any contact, by the distances noted during the run
    assert validate(apart).code == 3


def test_contacts_dropped(tmp_path, rear_end):
    for kept in (slice(0), slice(1, None)):
        with edited(rear_end, tmp_path / "record.h5", lambda rows, kept=kept: rows[kept]) as record:
            assert validate(record).code == 3
    with edited(rear_end, tmp_path / "record.h5", lambda rows: rows[:0]) as record:
        assert states(said(validate(record)), "no contact", "shapes overlap", within=40)


@pytest.mark.parametrize("steps", [-2, 1])
def test_contact_time_shifted(tmp_path, rear_end, steps):
    def later(rows):
        rows["step"] += steps
        return rows[rows["step"] < rear_end.samples]

    with edited(rear_end, tmp_path / "record.h5", later) as record:
        found = validate(record)
    assert found.code == 3
    assert any(one.steps >= abs(steps) for one in found.comparison.disagreements)


def test_guard_switched_off():
    """A false contact between separated shapes comes through and is found out."""
    for seed in (0, FALSE_CONTACT):
        with side_by_side(seed, guarded=True) as record:
            assert validate(record).code == 0
            assert (record.rejected_contacts > 0) == (seed == FALSE_CONTACT)
        with side_by_side(seed, guarded=False) as record:
            found = validate(record)
            assert found.code == (3 if seed == FALSE_CONTACT else 0)
    assert states(said(found), "shapes apart", "contact in the record", within=40)


def test_collision_time_that_ignores_rotation(monkeypatch, rear_end):
    def straight(a, i, pose_i, twist_i, b, j, pose_j, twist_j, horizon):
        one, other = (np.array((twist[0], 0.0, 0.0)) for twist in (twist_i, twist_j))
        return collision_time_pair(a, i, pose_i, one, b, j, pose_j, other, horizon)

    monkeypatch.setattr(prediction, "collision_time_pair", straight)
    found = validate(rear_end)
    assert found.code == 3
    assert found.mispredicted
    assert "but contact predicted" in said(found)
