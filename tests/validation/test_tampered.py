"""Records whose distances, scene or world were changed afterwards."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import physim
from physim.analysis.validation import analytic_contacts, report, validate
from physim.cli import main
from physim.errors import RecordError
from tests.helpers import facts, inside
from tests.validation.reports import states

distance_at, distinct = inside("physim.analysis.validation", "distance_at", "distinct")


def tampered(record, folder, change):
    path = folder / "tampered.h5"
    record.save(path)
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def cell(path, row, value, column=None):
    def change(file):
        rows = np.array(file[path][()])
        (rows if column is None else rows[column])[row] = value
        file[path][...] = rows

    return change


@pytest.mark.parametrize(
    ("path", "row", "value", "column", "expected"),
    [
        ("/steps/clearance", (150, 0), 99.0, None, ("nearest robot", "99 m")),
        ("/steps/boundary_clearance", (9, 1), 1e-3, None, ("nearest boundary", "0.001 m")),
        ("/extremes", (), 99.0, "clearance", ("99 m",)),
        ("/extremes", (), 99.0, "boundary_clearance", ("99 m",)),
        ("/extremes", 0, 7, "clearance_step", ("at this sample", "shapes")),
        ("/extremes_farthest", (), 99.0, "farthest", ("largest distance", "robots", "99 m")),
        ("/extremes_farthest", (), 7, "step", ("at this sample", "shapes")),
    ],
)
def test_recorded_distances(apart, tmp_path, path, row, value, column, expected):
    assert validate(apart).code == 0
    with physim.Record.load(tampered(apart, tmp_path, cell(path, row, value, column))) as record:
        found = validate(record)
        text = " ".join(report(found).split())
    assert found.code == 3
    assert found.verdict.startswith("checks disagree: ")
    assert states(text, *expected)
    assert "by the shapes" in text or "m apart then" in text
    assert "came within 99" not in text


def shift(file):
    file["/steps/pose"][:, 1, 1] += 1e-3


def larger(file):
    file["/footprints/vertices"][0, 0] -= 1e-6


def renamed(file):
    file["/bodies/name"][1] = "hasty"


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (
            lambda file: file.attrs.modify("seed", np.int64(99)),
            ("seed", "99 in the record", "1 by"),
        ),
        (cell("/walls/vertices", 0, 77.0), ("walls", "vertex 0", "(77, 77) in the record")),
        (cell("/robots/stop_station", 0, 1.0), ("stop station", "robot 0", "1 in the record")),
        (cell("/paths/points", 1, 5.0), ("paths", "point 1", "(5, 5) in the record")),
        (shift, ("start pose", "fast", "(4.6, -0.999, 0) in the record", "(4.6, -1, 0) by")),
        (larger, ("footprints", "vertex 0")),
        (renamed, ("name", "body 1", "hasty in the record", "fast by")),
        (lambda file: file.attrs.modify("dt", 0.02), ("dt", "0.02 in the record", "0.01 by")),
    ],
)
def test_scene_that_is_not_that_of_the_world_inside(rear_end, tmp_path, capsys, change, expected):
    path = tampered(rear_end, tmp_path, change)
    assert main(["validate", "--quiet", str(path)]) == 3
    verdict = capsys.readouterr().out.splitlines()[-1]
    assert verdict.startswith("verdict: checks disagree: ")
    assert states(verdict, *expected)


def test_world_inside_that_cannot_be_read(apart, tmp_path, capsys):
    path = tampered(apart, tmp_path, lambda file: file.attrs.modify("world", "nonsense: ["))
    for more in ([], ["--world", "straight"]):
        assert main(["validate", "--quiet", str(path), *more]) == 2
        lines = [s for s in capsys.readouterr().err.splitlines() if not s.startswith("compiling")]
        assert len(lines) == 1
        assert lines[0].startswith(f"{path}: ")
        assert states(lines[0][len(f"{path}: ") :], "world inside", "cannot be read", within=40)


def test_a_missing_sample(apart, tmp_path):
    def change(file):
        for key in ("step", "pose", "clearance", "boundary_clearance"):
            rows = np.delete(file[f"/steps/{key}"][()], 50, axis=0)
            file[f"/steps/{key}"].resize(len(rows), axis=0)
            file[f"/steps/{key}"][...] = rows

    with (
        physim.Record.load(tampered(apart, tmp_path, change)) as record,
        pytest.raises(RecordError, match=facts("step 50", "no sample")),
    ):
        validate(record)


def test_an_overlap_is_told_as_one(rear_end, tmp_path):
    path = tampered(rear_end, tmp_path, lambda file: file["/contacts"].resize(0, axis=0))
    with physim.Record.load(path) as record:
        found = validate(record)
        text = " ".join(report(found).split())
    assert found.code == 3
    assert states(text, "bodies overlap", "slow and fast", "no contact", "3.00 s")
    assert "within -" not in text


def heap(file):
    file["/steps/pose"][:, 1] = file["/steps/pose"][:, 0]


def test_far_more_contacts_than_the_record_has(apart, tmp_path, monkeypatch):
    """Hundreds of robots in one place, of a record of 140 kB, took minutes and gigabytes."""
    with physim.Record.load(tampered(apart, tmp_path, heap)) as record:
        samples = record.samples
        monkeypatch.setattr(analytic_contacts, "MOST_UNKNOWN", samples)
        assert validate(record).code == 3
        monkeypatch.setattr(analytic_contacts, "MOST_UNKNOWN", samples - 1)
        with pytest.raises(
            RecordError, match=facts(str(samples - 1), "/contacts", "0 rows", "tampered.h5")
        ):
            validate(record)


def test_distances_of_contacts_that_the_record_lacks_are_those_of_the_shapes(apart, tmp_path):
    with physim.Record.load(tampered(apart, tmp_path, heap)) as record:
        lacking = [
            one for one in validate(record).comparison.disagreements if "no contact" in one.what
        ]
        assert [(one.a, one.b, one.step, one.steps) for one in lacking] == [
            (0, 1, 0, record.samples)
        ]
        assert lacking[0].distance == distance_at(record, 0, 1, 0) < -0.1


@given(st.lists(st.integers(-5, 5)))
def test_distinct_is_unique(keys):
    keys = np.array(keys, dtype=np.int64)
    assert np.array_equal(distinct(keys), np.unique(keys))
