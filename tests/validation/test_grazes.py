"""Contacts between samples: recorded, counted apart, held against the swept check."""

from __future__ import annotations

import math
from functools import partial

import h5py
import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis.metrics import contact_episodes, grazes
from physim.analysis.summary import table
from physim.analysis.validation import report, validate
from physim.contacts import FALSE_CONTACT_ROW, Kind, Phase
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import edited, lane, side_by_side

expectations = inside("physim.analysis", "expectations")
analytic_contacts = inside("physim.analysis.validation", "analytic_contacts")
DecisionTable, GRAZE = inside("physim.analysis.validation", "DecisionTable", "GRAZE")
REJECTED, AGREES = inside("physim.analysis.validation", "REJECTED", "AGREES")
TOUCHED_BEFORE, Predictor = inside("physim.analysis.validation", "TOUCHED_BEFORE", "Predictor")
Timeline, episodes = inside("physim.drawing", "Timeline", "episodes")
ground, SWEPT, signs = inside("physim.drawing.video", "ground", "SWEPT", "signs")

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


def test_one_that_just_misses_leaves_no_row():
    assert len(pass_by(-1e-4).contacts) == 0


def test_it_is_counted_apart_and_still_is_a_contact(grazing):
    assert contact_episodes(grazing) == ()
    (graze,) = grazes(grazing)
    summary = physim.summarise(grazing)
    assert summary.contacts.count == 0
    assert summary.grazes == (graze,)
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
    assert states(said(found), "engine does not look", "touched once")
    assert "Responsible is fast" in said(found)
    assert found.near_misses.distances == ()


def test_it_is_a_contact_where_no_expectation_says_so():
    found = validate(pass_by(DEPTH))
    assert found.missed == ()
    assert (len(found.contacts), len(found.grazes), found.code) == (0, 1, 1)


def test_the_video_counts_and_marks_it_apart(grazing):
    seen = episodes(grazing)
    time = float(seen.began[0])
    assert seen.swept.tolist() == [True]
    assert (seen.count(time - 0.01), seen.swept_count(time - 0.01)) == (0, 0)
    assert (seen.count(time), seen.swept_count(time)) == (1, 1)
    assert SWEPT in signs(Timeline(grazing), ground(Timeline(grazing)))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda rows: rows[:0], "not in the record"),
        (lambda rows: shifted(rows, "step", 3), "in the record, shapes apart"),
        (lambda rows: shifted(rows, "depth", 1e-6), "m by the shapes"),
        (lambda rows: shifted(rows, "impulse", 5.0), "with a push or another phase"),
        (lambda rows: shifted(rows, "phase", int(Phase.STAYS)), "with a push or another phase"),
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


@pytest.mark.parametrize("every", [1, 7, 300])
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


def test_so_is_one_after_a_touch_at_a_sample_that_held_up_nobody():
    world = physim.parse_world(SPIKE.replace("4.997", "4.9898"))
    found = validate(physim.simulate(world, controller=Once()))
    first, second = found.contacts
    assert first.prediction.verdict == AGREES
    assert second.prediction.predicted == first.prediction.predicted
    assert second.prediction.verdict == TOUCHED_BEFORE
    assert found.mispredicted == ()
    assert found.code == 1


ARC = """\
name: arc
time: {step: 0.01, duration: 0.3}
boundaries: [[[0, -4], [20, -4], [20, 4], [0, 4], [0, -4]]]
reference_path: [[0.5, 0], [7.5, 0]]
robots:
  - {name: a, footprint: [[0.8, 0], [-0.4, 0.5], [-0.4, -0.5]], limits: {v: 2.0, omega: 3.0},
     pose: [3.734382391019397, -1.0781452205777287, 7.064970382814139], path: {offset: 0}}
  - {name: b, footprint: {length: 0.6, width: 0.4}, limits: {v: 0.5, omega: 1.6},
     pose: [4.620562448199894, -0.33954680528368186, 3.3836231201749416], path: {offset: 0}}
controller: {type: constant, commands: [[2.0, 3.0], [0.5, 0.0]]}
"""
"""On the arc a's side comes 12 um into a corner of b at 0.0941 s; on the chord they stay apart."""


def test_a_graze_of_the_arc_that_the_chord_does_not_make_is_explained():
    record = physim.simulate(physim.parse_world(ARC))
    found = validate(record)
    assert found.grazes == ()
    (contact,) = found.contacts
    assert contact.prediction.predicted == pytest.approx(0.0941, abs=1e-3)
    assert contact.time > 0.2
    assert contact.prediction.verdict == TOUCHED_BEFORE
    assert found.code == 1
    near = partial(Predictor(record, DecisionTable(record))._is_near, 0, 1, 25)
    assert near(contact.prediction.predicted, 2e-4)
    assert not near(contact.prediction.predicted, 1e-9)
    assert not near(contact.prediction.predicted + 0.05, 2e-4)


def test_a_graze_at_another_time_explains_nothing():
    record = physim.simulate(physim.parse_world(SPIKE), controller=Once())
    (graze,) = grazes(record)
    grazed = partial(Predictor(record, DecisionTable(record))._touched_then, graze.a, graze.b, 0)
    assert grazed(graze.step + 200, graze.time - 0.5 * record.dt, 1e-6)
    assert not grazed(graze.step + 200, graze.time + 0.5 * record.dt, 1e-6)
    assert not grazed(graze.step + 200, graze.time - 1.5 * record.dt, 1e-6)
    assert not grazed(graze.step - 1, graze.time, 1e-6)
