"""How much two answers may differ: just beyond it the validation says so, just within it does not.

Distances to 1e-9 m, poses to 1e-11 m, contacts to the step that was foretold: a slack that is wider
than what rounding needs would let something through.
"""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis import metrics
from physim.analysis.validation import prediction, report, validate
from physim.contacts import CONTACT_ROW, Kind, Phase
from tests.analysis.forgeries.tools import cells, column
from tests.analysis.validation.runs import LANE, edited, judged, lane, states
from tests.analysis.validation.test_grazes import pass_by
from tests.helpers import inside

TOLERANCE, UNEXPLAINED = inside("physim.analysis.validation", "TOLERANCE", "UNEXPLAINED")


@pytest.mark.parametrize(("by", "code"), [(5e-10, 1), (4e-9, 3)])
def test_depths_agree_to_1e_9_m(rear_end, tmp_path, by, code):
    deeper = column("/contacts", "depth", lambda d: d + by, lambda r: r["phase"] != Phase.ENDED)
    assert judged(rear_end, tmp_path, deeper).code == code


@pytest.mark.parametrize(
    ("path", "at", "most"),
    [
        ("/steps/clearance", (100, 1), 1e-9),
        ("/steps/boundary_clearance", (100, 1), 1e-9),
        ("/steps/pose", (200, 1, 0), 1e-11),
        ("/steps/pose", (200, 1, 2), 1e-11),
    ],
)
def test_distances_and_poses_agree_to_so_much(apart, tmp_path, path, at, most):
    for by, code in ((0.5 * most, 0), (5.0 * most, 3)):
        assert judged(apart, tmp_path, cells(path, at, lambda x, by=by: x + by)).code == code


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
    step = metrics.Figures(rear_end).episodes[0].step

    shift = cells("/steps/pose", (step, 1, 1), lambda y: y + aside)
    found = judged(rear_end, tmp_path, shift).contacts[0].prediction
    assert (found.verdict != prediction.NOT_AS_COMMANDED) == moved


class Once:
    """Decides at the start and never again."""

    def __init__(self, *commands: tuple[float, float]) -> None:
        self.commands = commands

    def decide(self, observation, memory):
        v, omega = self.commands[observation.index]
        return Decision(v=v, omega=omega, hold=inf)


@pytest.mark.parametrize(
    ("commands", "seconds"),
    [
        (((0.03, 0.01), (0.1, 0.0)), 22.0),  # the one in front on a circle, 21 s
    ],
)
def test_a_contact_long_after_the_last_decision_is_foretold(commands, seconds):
    changes = [f"time.duration={seconds}", "robots.1.pose=[4.6, 0.0, 0.0]"]
    world = physim.parse_world(LANE, overrides=changes)
    found = validate(physim.simulate(world, controller=Once(*commands)))
    assert found.verdict.startswith("contacts: ")
    first = found.contacts[0].prediction
    assert (first.made, first.verdict) == (0.0, "agrees")
    assert first.touched > 10.0
    assert abs(first.predicted - first.touched) <= first.slack
    assert f"at every decision of the last {first.touched:.3f} s" in " ".join(
        report(found, full=True).split()
    )
