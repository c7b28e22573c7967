"""Records whose distances, scene or world were changed afterwards."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

import physim
from physim.analysis.validation import report, validate
from physim.cli import main
from physim.errors import RecordError


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
        ("/steps/clearance", (150, 0), 99.0, None, "distance to the nearest robot 99 m"),
        ("/steps/boundary_clearance", (9, 1), 1e-3, None, "nearest boundary 0.001 m"),
        ("/extremes", (), 99.0, "clearance", "99 m"),
        ("/extremes", (), 99.0, "boundary_clearance", "99 m"),
        ("/extremes", 0, 7, "clearance_step", "at this sample in the record, but the shapes"),
        ("/extremes_farthest", (), 99.0, "farthest", "largest distance of robots 99 m"),
        ("/extremes_farthest", (), 7, "step", "at this sample in the record, but the shapes"),
    ],
)
def test_recorded_distances(apart, tmp_path, path, row, value, column, expected):
    assert validate(apart).code == 0
    with physim.Record.load(tampered(apart, tmp_path, cell(path, row, value, column))) as record:
        found = validate(record)
        text = " ".join(report(found).split())
    assert found.code == 3
    assert found.verdict.startswith("checks disagree: ")
    assert expected in text
    assert "by the shapes" in text or "m apart then" in text
    assert "came within 99" not in text


def shift(file):
    file["/steps/pose"][:, 1, 1] += 1e-3


def larger(file):
    file["/robots/000/footprint/00"][0, 0] -= 1e-6


def renamed(file):
    file["/bodies/name"][1] = "hasty"


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda file: file.attrs.modify("seed", np.int64(99)), "seed is 99 in the record, 1 by"),
        (cell("/walls/vertices", 0, 77.0), "walls: vertex 0 is (77, 77) in the record"),
        (cell("/robots/stop_station", 0, 1.0), "stop station of robot 0 is 1 in the record"),
        (cell("/paths/points", 1, 5.0), "paths: point 1 is (5, 5) in the record"),
        (shift, "start pose of robot 1 (fast) is (4.6, -0.999, 0) in the record, (4.6, -1, 0) by"),
        (larger, "footprints: vertex 0 is"),
        (renamed, "name of body 1 is hasty in the record, fast by the world inside it"),
        (lambda file: file.attrs.modify("dt", 0.02), "dt is 0.02 in the record, 0.01 by"),
    ],
)
def test_scene_that_is_not_that_of_the_world_inside(rear_end, tmp_path, capsys, change, expected):
    path = tampered(rear_end, tmp_path, change)
    assert main(["validate", "--quiet", str(path)]) == 3
    verdict = capsys.readouterr().out.splitlines()[-1]
    assert verdict.startswith("verdict: checks disagree: ")
    assert expected in verdict


def test_world_inside_that_cannot_be_read(apart, tmp_path, capsys):
    path = tampered(apart, tmp_path, lambda file: file.attrs.modify("world", "nonsense: ["))
    for more in ([], ["--world", "straight"]):
        assert main(["validate", "--quiet", str(path), *more]) == 2
        lines = [s for s in capsys.readouterr().err.splitlines() if not s.startswith("compiling")]
        assert len(lines) == 1
        assert lines[0].startswith(f"{path}: the world inside cannot be read: ")


def test_record_without_the_text_of_a_world(apart, tmp_path):
    path = tampered(apart, tmp_path, lambda file: file.attrs.modify("world", ""))
    with physim.Record.load(path) as record:
        found = validate(record)
    assert found.code == 0
    assert "the record holds no text of its world" in report(found)


def test_a_missing_sample(apart, tmp_path):
    def change(file):
        for key in ("step", "pose", "clearance", "boundary_clearance"):
            rows = np.delete(file[f"/steps/{key}"][()], 50, axis=0)
            file[f"/steps/{key}"].resize(len(rows), axis=0)
            file[f"/steps/{key}"][...] = rows

    with (
        physim.Record.load(tampered(apart, tmp_path, change)) as record,
        pytest.raises(RecordError, match="step 50 has no sample"),
    ):
        validate(record)


def test_an_overlap_is_told_as_one(rear_end, tmp_path):
    path = tampered(rear_end, tmp_path, lambda file: file["/contacts"].resize(0, axis=0))
    with physim.Record.load(path) as record:
        found = validate(record)
        text = " ".join(report(found).split())
    assert found.code == 3
    assert "The record has no contact in 3.00 s, yet bodies overlap: slow and fast overlap" in text
    assert "within -" not in text
