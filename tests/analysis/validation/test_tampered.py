"""Records that were changed afterwards, beside the forgeries; and what is true though unusual."""

from __future__ import annotations

import json

import numpy as np
import pytest

import physim
from physim.analysis.validation import analytic_contacts, report, validate
from physim.errors import RecordError
from tests.analysis.forgeries.parts import Heard, Ramp, Slip
from tests.analysis.forgeries.runs import LANE as PAPER
from tests.analysis.forgeries.tools import attribute, cells, column, decided, dropped, world
from tests.analysis.validation.runs import LANE, REAR_END, Drivers, judged, lane, states, tampered
from tests.helpers import facts, inside, said

distance_at = inside("physim.analysis.validation", "distance_at")
json_of_validation = inside("physim.analysis.validation", "json_of_validation")


@pytest.fixture(scope="module")
def parted():
    """The fast one hits the slow one in passing, and both go on."""
    world = physim.parse_world(LANE, overrides=["time.duration=6"])
    return physim.simulate(world, controller=Drivers((0.3, 0.0), (1.4, 0.0)))


@pytest.fixture(scope="module")
def finished():
    """The paper's controller; all arrive."""
    record = physim.simulate(physim.parse_world(PAPER))
    assert record.ended == "finished"
    return record


BEGAN, ENDED = (lambda rows, phase=phase: rows["phase"] == phase for phase in (0, 2))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (column("/extremes", "boundary_clearance", 99.0), ("99 m", "by the shapes")),
        (column("/extremes", "clearance_step", 7, 0), ("at this sample", "shapes")),
        (cells("/extremes_farthest", "step", 7), ("at this sample", "shapes")),
        (dropped("/contacts", ENDED), ("contact", "end", "not in the record")),
        (dropped("/contacts", BEGAN), ("begins", "goes on", "wrongly")),
        (column("/contacts", "depth", lambda d: d - 1e-6, ENDED), ("gap after a contact",)),
        (cells("/areas/accessible/points", (0, 1), 7.0), ("accessible area", "another")),
        (column("/updates", "station", lambda s: s + 1e-6), ("/updates, row 1", "fast", "station")),
    ],
)
def test_tables(parted, tmp_path, change, words):
    assert validate(parted).code == 1
    found = judged(parted, tmp_path, change)
    assert found.code == 3
    assert found.verdict.startswith("checks disagree: ")
    assert states(report(found), *words)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (column("/contacts", "x", np.nan), ("/contacts, row 0", "x", "nan")),
        (attribute("versions", "nonsense"), ("JSON", "versions")),
        (attribute("units", "feet"), ("attribute units", "'feet'")),
        (lambda file: file.__delitem__("contacts"), ("/contacts", "missing")),
        (attribute("world", "nonsense: ["), ("world inside", "cannot be read")),
    ],
)
def test_what_no_run_writes_is_refused_in_one_line(parted, tmp_path, change, words):
    path = str(tampered(parted, tmp_path, change))
    code, out, err = said("validate", "--quiet", path)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"{path}: ")
    assert states(err, *words)


def test_far_more_contacts_than_the_record_has(apart, tmp_path, monkeypatch):
    """Hundreds of robots in one place, of a record of 140 kB, took minutes and gigabytes."""

    def heap(file):
        file["/steps/pose"][:, 1] = file["/steps/pose"][:, 0]

    with physim.Record.load(tampered(apart, tmp_path, heap)) as record:
        samples = record.samples
        monkeypatch.setattr(analytic_contacts, "MOST_UNKNOWN", samples)
        (one,) = (x for x in validate(record).comparison.disagreements if "no contact" in x.what)
        assert (one.bodies, one.step, one.steps) == ((0, 1), 0, samples)
        assert one.distance == distance_at(record, 0, 1, 0) < -0.1
        monkeypatch.setattr(analytic_contacts, "MOST_UNKNOWN", samples - 1)
        with pytest.raises(RecordError, match=facts(str(samples - 1), "/contacts", "0 rows")):
            validate(record)


def test_a_jump_of_millions_of_metres_is_refused(apart, tmp_path):
    """The search for contacts along it would not end."""
    far = tampered(apart, tmp_path, cells("/steps/pose", (40, 1, 0), 2.0e6))
    with (
        physim.Record.load(far) as record,
        pytest.raises(RecordError, match=facts("/steps/pose", "row 40", "a step of")),
    ):
        validate(record)


# What was decided is decided again


def test_decisions_as_they_are_agree(finished):
    found = validate(finished)
    assert found.rerun.same_digest
    assert found.recomputed.mismatches == found.recomputed.left_out == ()
    found = validate(finished, rerun=False)
    assert found.recomputed.mismatches == ()
    assert found.recomputed.replayed == found.recomputed.decisions == len(finished.updates)


@pytest.mark.parametrize(
    ("name", "value", "recorded", "exact"),
    [("mode", 2, "danger_time", "safe"), ("rule", 1, "plan", "path_following")],
)
def test_a_mode_and_a_rule(finished, tmp_path, name, value, recorded, exact):
    change = column("/updates", name, value, decided(0, 15))
    again = judged(finished, tmp_path, change).rerun.difference
    found = judged(finished, tmp_path, change, rerun=False)
    (one,) = found.recomputed.mismatches
    assert (one.bodies, one.step) == (again.bodies, again.step) == ((0,), 300)
    for two in (one, again):
        assert two.what.startswith("/updates, row ")
        assert states(two.what, name, f"{recorded} in the record", exact)
    assert found.code == 3
    assert json.loads(json_of_validation(found))["recomputed"]["mismatches"][0]["what"] == one.what


def test_limits_hold_for_a_controller_that_is_not_made_again(tmp_path):
    """The slow one goes 0.5 m/s, the fast one 1.4 where the world inside allows 0.9."""
    found = judged(lane(REAR_END), tmp_path, world("v: 1.5", "v: 0.9"))
    assert {one.bodies for one in found.recomputed.mismatches} == {(1,)}
    for one in found.recomputed.mismatches:
        assert states(one.what, "nominal_v is 1.4", "0.9 at most")


def test_behind_stages_decisions_are_made_again_and_what_was_sensed_is_not_known():
    world = physim.parse_world(PAPER, overrides=["time.duration=4"])
    record = physim.simulate(world, filters=[Ramp()], disturbances=[Slip()])
    found = validate(record).recomputed
    assert (found.mismatches, found.replayed) == ((), len(record.updates))
    assert states(found.left_out[-1], "simulated again", "filter", "from Python")
    found = validate(physim.simulate(world, sensing=[Heard()]))
    assert (found.recomputed.mismatches, found.recomputed.replayed) == ((), 0)
    assert states(report(found), "sensed", "not in the record", within=40)


def test_a_run_that_goes_on_when_all_have_arrived(tmp_path):
    """Both stand 0.5 m before their stops, which is near enough for the world inside alone."""
    poses = [f"robots.{k}.pose=[29.5, {y}, 0.0]" for k, y in enumerate((2.0, -2.0))]
    standing = "controller={type: constant, commands: [[0.0, 0.0]]}"
    stand = physim.simulate(
        physim.parse_world(LANE, overrides=[*poses, standing, "arrival.tolerance=0.4"])
    )
    assert judged(stand, tmp_path, world("tolerance: 0.4", "tolerance: 0.6")).code == 3
