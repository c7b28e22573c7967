"""Contacts between samples: recorded, counted apart, held against the swept check."""

from __future__ import annotations

import math

import h5py
import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis.metrics import Figures
from physim.analysis.summary import table
from physim.analysis.validation import report, validate
from physim.contacts import FALSE_CONTACT_ROW, Kind, Phase
from tests.analysis.validation.runs import edited, lane, side_by_side, states
from tests.helpers import inside

expectations = inside("physim.analysis", "expectations")
analytic_contacts = inside("physim.analysis.validation", "analytic_contacts")
GRAZE = inside("physim.analysis.validation", "GRAZE")
REJECTED, TOUCHED_BEFORE = inside("physim.analysis.validation", "REJECTED", "TOUCHED_BEFORE")

DEPTH = 4e-4


def pass_by(depth: float, **changes):
    """The fast one's rear corner passes ``depth`` [m] inside a corner of the standing one."""
    pose = f"[{4.822182541 + depth * 2**0.5!r}, -1.0, {np.pi / 4!r}]"
    return lane(((0.0, 0.0), (1.4, 0.0)), **{"robots.1.pose": pose, **changes})


@pytest.fixture(scope="module")
def grazing():
    return pass_by(DEPTH, **{"expect.contacts": 0})


def said(found):
    return " ".join(report(found).split())


def test_a_graze_is_a_row_of_its_own_kind(grazing):
    (row,) = grazing.contacts
    assert (row["kind"], row["phase"], row["impulse"]) == (Kind.SWEPT, Phase.BEGAN, 0.0)
    assert (row["a"], row["b"]) == (0, 1)
    assert row["depth"] == pytest.approx(DEPTH, rel=0.3)
    assert np.hypot(row["nx"], row["ny"]) == pytest.approx(1.0)
    # front right corner of the standing one
    assert (row["x"], row["y"]) == pytest.approx((8.0 - 0.9, 0.5), abs=2e-3)
    assert grazing.clearance[row["step"] - 1].min() > 1e-9 < grazing.clearance[row["step"]].min()


def test_a_graze_between_samples_is_found_and_explained():
    found = {depth: validate(pass_by(depth)) for depth in (-1e-4, 2e-4, 8e-4)}
    assert found.pop(-1e-4).comparison.disagreements == ()
    for depth, one in found.items():
        assert (one.missed, len(one.contacts), len(one.grazes), one.code) == ((), 0, 1, 1)
        (told,) = one.comparison.disagreements
        assert (told.cause, told.steps) == (GRAZE, 1)
        assert told.distance == pytest.approx(-depth, abs=0.3 * depth)


def test_it_is_counted_apart_and_still_is_a_contact(grazing):
    assert Figures(grazing).episodes == ()
    (graze,) = Figures(grazing).grazes
    summary = physim.summarise(grazing)
    assert summary.contacts == ()
    assert summary.run.grazes == (graze,)
    assert summary.names_of(graze.a, graze.b) == ("slow", "fast")
    text = " ".join(table(summary).split())
    assert states(text, "contacts 0", "grazes between samples 1", within=50)
    (held,) = expectations(grazing)
    assert (held.key, held.got, held.held) == ("contacts", 1, False)


def test_the_verdict_names_it(grazing):
    found = validate(grazing)
    assert found.code == 1
    assert states(found.verdict, "contacts: ", "0 at samples", "1 between samples")
    assert [one.cause for one in found.comparison.disagreements] == [GRAZE]
    assert found.grazes[0].responsible == (1,)
    assert states(said(found), "engine does not look", "1 of them")
    assert "Responsible: fast" in said(found)
    when = found.grazes[0].when
    assert when.startswith("between ")
    assert said(found).lower().count(when) == 3  # above, in the table, in the sentence
    assert found.near_misses.distances == ()


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda rows: rows[:0], "not in the record"),
        (lambda rows: shifted(rows, "step", 3), "in the record, shapes apart"),
        (lambda rows: shifted(rows, "depth", 1e-6), "m by the shapes"),
        (lambda rows: shifted(rows, "impulse", 5.0), "with a push or another phase"),
    ],
)
def test_a_false_row_is_found_out(tmp_path, grazing, change, expected):
    with edited(grazing, tmp_path / "record.h5", change) as record:
        found = validate(record)
    assert found.code == 3
    assert expected in said(found)


def shifted(rows, column, by):
    rows[column] += by
    return rows


def test_grazing_a_wall():
    """The tip of the turning robot's corner swings through the wall's skin within one step."""
    found = []
    for gap in np.linspace(-2e-4, 2e-4, 9).tolist():
        y = 4.0 - 1.0 + gap
        changes = {"robots.1.pose": f"[4.6, {y!r}, 1.1883]", "time.step": 0.03,
                   "robots.0.pose": "[20.0, -1.0, 0.0]"}  # fmt: skip
        with lane(((0.0, 0.0), (0.0, 1.5)), **changes) as record:
            ours = analytic_contacts(record).grazes
            rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
            assert rows["step"].tolist() == ours["step"].tolist()
            assert rows["b"].tolist() == ours["b"].tolist()
            assert validate(record).comparison.unexplained == 0
            found += rows["depth"].tolist()
    assert found
    assert max(found) < 1e-3


@pytest.mark.parametrize("every", [7])
def test_blocks_of_any_size_find_the_same(every, grazing):
    with pass_by(DEPTH, **{"time.record_every": every}) as record:
        assert record.contacts.tobytes() == grazing.contacts.tobytes()


def test_rejected_false_contacts_are_told_one_by_one(tmp_path):
    with side_by_side(1073, guarded=True) as record:
        rows = record.false_contacts
        assert len(rows) == record.rejected_contacts > 0
        assert rows["distance"] == pytest.approx(0.2)
        found = validate(record)
        assert (found.verdict, found.comparison.unexplained) == ("contact-free", 0)
        causes = {one.cause for one in found.comparison.disagreements}
        assert causes == {REJECTED}
        assert sum(one.steps for one in found.comparison.disagreements) == len(rows)
        record.save(tmp_path / "record.h5")
    with h5py.File(tmp_path / "record.h5", "r+") as file:
        rows = file["/false_contacts"][()]
        rows["distance"] -= 0.01
        file["/false_contacts"][...] = rows
    with physim.Record.load(tmp_path / "record.h5") as record:
        assert validate(record).code == 3


def test_a_rejected_contact_of_shapes_that_touch(rear_end, tmp_path):
    """The engine was right, and its guard wrong: reported, though the distance is the true one."""
    rear_end.save(tmp_path / "record.h5")
    deep = rear_end.contacts[rear_end.contacts["depth"] > 1e-4][0]
    with h5py.File(tmp_path / "record.h5", "r+") as file:
        rows = np.zeros(1, FALSE_CONTACT_ROW)
        for key in ("step", "a", "b"):
            rows[key] = deep[key]
        rows["distance"] = -deep["depth"]
        file["/false_contacts"].resize(1, axis=0)
        file["/false_contacts"][...] = rows
    with physim.Record.load(tmp_path / "record.h5") as record:
        found = validate(record)
    assert found.code == 3
    assert "rejected, but the shapes touch" in said(found)


SPIKE = """\
name: spike
time: {step: 0.01, duration: 8.0}
boundaries: [[[0, -3], [10, -3], [10, 3], [8, 3], [4.997, 0.6996], [2, 3], [0, 3], [0, -3]]]
reference_path: [[1, 0], [9, 0]]
robots:
  - {name: a, footprint: [[0.7, 0], [0, 0.7], [-0.7, 0], [0, -0.7]], pose: [1, 0, 0],
     path: [[1, 0], [9, 0]]}
"""


class Once:
    """Drives on for ever."""

    def decide(self, observation, memory):
        return Decision(v=1.4, omega=0.0, hold=math.inf)


def test_a_contact_after_a_graze_that_was_foretold_is_explained():
    """The one decision foretold the graze of the spike; the wall behind it came seconds later."""
    found = validate(physim.simulate(physim.parse_world(SPIKE), controller=Once()))
    (graze,) = found.grazes
    (contact,) = found.contacts
    assert contact.time - graze.time > 2.0
    assert contact.prediction.predicted == pytest.approx(graze.time, abs=0.01)
    assert contact.prediction.verdict == TOUCHED_BEFORE
    assert found.mispredicted == ()
    assert found.code == 1
