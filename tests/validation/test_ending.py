"""How a run ended, who had arrived, and counts, against what happened."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim.analysis.validation import validate
from physim.errors import RecordError
from tests.forgeries.edits import commanded_from_outside
from tests.forgeries.runs import LANE, killed
from tests.forgeries.tools import attribute, cells, cut
from tests.helpers import facts, inside
from tests.validation.reports import states
from tests.validation.test_tampered import tampered

ArrivalCheck, sample_blocks = inside("physim.analysis.validation", "ArrivalCheck", "sample_blocks")
world_inside = inside("physim.analysis.validation", "world_inside")


@pytest.fixture(scope="module")
def finished():
    record = physim.simulate(physim.parse_world(LANE))
    assert record.ended == "finished"
    return record


@pytest.mark.parametrize("size", [1, 7, 64, 5000])
def test_arrivals_block_by_block(finished, monkeypatch, size):
    monkeypatch.setattr(
        "physim.analysis.validation.analytic_contacts.BLOCK_POSES", size * finished.robots
    )
    monkeypatch.setattr("physim.analysis.validation.analytic_contacts.LEAST_STEPS", 1)
    scene = world_inside(finished).scene
    found = ArrivalCheck(scene)
    for block in sample_blocks(finished):
        found.take(block)
    assert found.all_since == finished.steps_run
    assert found.since.tolist() == finished.arrived.tolist()


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (cut(600, "finished"), ("ended", "finished in the record", "not by", "r1, r2, r3")),
        (cut(600, "duration"), ("steps_run", "600 in the record", "3000 by")),
        (attribute("ended", "interrupted"), ("ended", "interrupted in the record", "finished by")),
        (attribute("ended", "duration"), ("ended", "duration in the record", "finished by")),
        (
            attribute("rejected_contacts", np.int64(3)),
            ("rejected_contacts", "3 in the record", "0 by"),
        ),
        (cells("/robots/arrived", 2, 1500), ("/robots/arrived, row 2", "r3", "1500 in the record")),
    ],
)
def test_how_it_ended(finished, tmp_path, change, expected):
    with physim.Record.load(tampered(finished, tmp_path, change)) as forged:
        found = validate(forged)
    names = [body.name for body in found.run.bodies]
    assert found.code == 3
    assert any(states(one.line(names), *expected) for one in found.recomputed.mismatches)


def test_a_run_that_was_cut_as_it_says_is_judged_as_far_as_it_goes(finished, tmp_path):
    with physim.Record.load(tampered(finished, tmp_path, cut(600, "interrupted"))) as short:
        found = validate(short)
    assert (found.code, found.recomputed.mismatches) == (1, ())
    assert [one.key for one in found.missed] == ["finished"]
    killed(tmp_path / "killed.h5")
    with physim.Record.load(tmp_path / "killed.h5") as record:
        assert validate(record).code == 1


def test_an_unknown_minor_version_is_read_and_a_major_one_refused(finished, tmp_path):
    with physim.Record.load(tampered(finished, tmp_path, attribute("version", "4.7"))) as newer:
        assert validate(newer).code == 0
    with pytest.raises(physim.PhysimError, match=facts("version", "'5.0'", "4")):
        physim.Record.load(tampered(finished, tmp_path, attribute("version", "5.0")))


def test_a_record_without_the_text_of_its_world_is_refused(finished, tmp_path):
    forged = physim.Record.load(tampered(finished, tmp_path, attribute("world", "")))
    with forged, pytest.raises(RecordError) as refused:
        validate(forged)
    assert states(str(refused.value), "no text of its world", within=60)


def test_commands_without_decisions_are_none_of_the_controllers(finished, tmp_path):
    with physim.Record.load(tampered(finished, tmp_path, commanded_from_outside)) as forged:
        found = validate(forged)
    wrong = [one for one in found.recomputed.mismatches if one.table == "/updates"]
    assert {one.robot for one in wrong} == set(range(finished.robots))
    assert found.code == 3
