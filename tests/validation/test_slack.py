"""How much two answers may differ: just beyond it the validation says so, just within it does not.

Distances to 1e-9 m, poses to 1e-11 m, contacts to the step that was foretold: a slack that is wider
than what rounding needs would let something through.
"""

from __future__ import annotations

import math

import h5py
import numpy as np
import pytest

import physim
from physim import tolerances
from physim.analysis import metrics
from physim.analysis.validation import prediction, validate
from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import edited, lane
from tests.validation.test_grazes import pass_by

DecisionTable, TOLERANCE = inside("physim.analysis.validation", "DecisionTable", "TOLERANCE")
UNEXPLAINED = inside("physim.analysis.validation", "UNEXPLAINED")


def changed(record, path, change):
    """Copy of a record on disk with something in the file changed."""
    record.save(path)
    with h5py.File(path, "r+") as file:
        change(file)
    return physim.Record.load(path)


@pytest.mark.parametrize(("by", "code"), [(5e-10, 1), (4e-9, 3)])
def test_depths_agree_to_1e_9_m(rear_end, tmp_path, by, code):
    def deeper(rows):
        rows["depth"][rows["phase"] != Phase.ENDED] += by
        return rows

    with edited(rear_end, tmp_path / "record.h5", deeper) as record:
        assert validate(record).code == code


@pytest.mark.parametrize("path", ["/steps/clearance", "/steps/boundary_clearance"])
@pytest.mark.parametrize(("by", "code"), [(5e-10, 0), (4e-9, 3)])
def test_distances_agree_to_1e_9_m(apart, tmp_path, path, by, code):
    def farther(file):
        file[path][100, 1] += by

    with changed(apart, tmp_path / "record.h5", farther) as record:
        assert validate(record).code == code


@pytest.mark.parametrize("column", [0, 2])
@pytest.mark.parametrize(("by", "code"), [(5e-12, 0), (5e-11, 3)])
def test_poses_agree_to_1e_11_m(apart, tmp_path, column, by, code):
    def shift(file):
        file["/steps/pose"][200, 1, column] += by

    with changed(apart, tmp_path / "record.h5", shift) as record:
        assert validate(record).code == code


def test_a_contact_is_within_tolerance_to_1e_9_m(tmp_path):
    """The record tells a contact of a robot that stands 3e-9 m from a wall."""
    gap = 3e-9
    beside = {"robots.0.pose": f"[8.0, {3.5 - gap!r}, 0.0]", "time.duration": 0.1}
    standing = lane(((0.0, 0.0), (0.0, 0.0)), **beside)
    assert len(standing.contacts) == 0
    wall = next(body.id for body in standing.bodies if body.name == "left wall")
    row = np.zeros(1, CONTACT_ROW)
    row["step"], row["b"], row["kind"] = 5, wall, Kind.PHYSICAL
    with edited(standing, tmp_path / "record.h5", lambda rows: row) as record:
        found = validate(record).comparison.disagreements
    (one,) = [one for one in found if states(one.what, "contact in the record", "shapes apart")]
    assert one.cause == UNEXPLAINED
    assert one.distance == pytest.approx(gap, abs=1e-14)


@pytest.mark.parametrize(("depth", "cause"), [(1.7e-9, TOLERANCE), (2e-8, UNEXPLAINED)])
def test_a_graze_may_count_either_way_to_2e_9_m(tmp_path, depth, cause):
    """One that is in the record alone; the shapes pass each other that far apart."""
    with pass_by(4e-4) as deep:
        (row,) = deep.contacts
    with pass_by(-depth) as near:
        rows = np.array([row])
        rows["depth"] = 0.0
        with edited(near, tmp_path / "record.h5", lambda _: rows) as record:
            (one,) = validate(record).comparison.disagreements
    assert one.distance == pytest.approx(depth, rel=0.5)
    assert one.cause == cause


@pytest.mark.parametrize(
    ("late", "verdict"), [(1e-6, prediction.AGREES), (1e-4, prediction.DISAGREES)]
)
def test_a_prediction_agrees_to_its_slack(monkeypatch, rear_end, late, verdict):
    """The contact comes so much later [s] than the end of the step in which it was found."""
    first = validate(rear_end).contacts[0].prediction
    assert first.verdict == prediction.AGREES
    assert late < first.slack < 1e-5 or late > 10.0 * first.slack
    right = prediction.collision_time_pair
    shift = first.found + late - first.predicted

    monkeypatch.setattr(prediction, "collision_time_pair", lambda *given: right(*given) + shift)
    found = validate(rear_end).contacts[0].prediction
    assert found.predicted == pytest.approx(first.found + late, abs=1e-9)
    assert found.verdict == verdict


@pytest.mark.parametrize(("aside", "moved"), [(5e-8, True), (1e-5, False)])
def test_a_robot_moved_as_commanded_to_1e_7_m(rear_end, tmp_path, aside, moved):
    """At the contact that is predicted from its command; along the other robot's rear."""
    step = metrics.contact_episodes(rear_end)[0].step

    def shift(file):
        file["/steps/pose"][step, 1, 1] += aside

    with changed(rear_end, tmp_path / "record.h5", shift) as record:
        found = validate(record).contacts[0].prediction
    assert (found.verdict != prediction.NOT_AS_COMMANDED) == moved


def test_a_slack_of_hours_is_not_looked_through(rear_end, monkeypatch):
    """A forged command turns so fast that its chord is kilometres long: it took hours."""
    record, episode = rear_end, metrics.contact_episodes(rear_end)[0]
    looked = []
    monkeypatch.setattr(
        prediction.Predictor, "due", lambda *asked: looked.append(asked[-1]) or math.inf
    )
    monkeypatch.setattr(tolerances, "chord", lambda v, omega, dt: 1e4)
    predictor = prediction.Predictor(record, DecisionTable(record))
    predictor.predict(episode.a, episode.b, episode.step, episode.time, 0.0, earlier=False)
    (until,) = looked
    assert prediction.MOST_SLACK < until < 2.0 * prediction.MOST_SLACK
