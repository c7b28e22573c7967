"""Round trip, streaming, digest, memory and bad input of records."""

from __future__ import annotations

import json
import pickle
import shutil
import tracemalloc
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import physim
from physim.contacts import CONTACT_ROW
from physim.errors import PhysimError, RecordError
from physim.record import Record, RecordWriter
from tests.helpers import facts, inside
from tests.helpers.records import (
    DECLARED,
    UPDATE,
    considered_rows,
    contact_rows,
    make_record,
    make_scene,
    poses,
    update_rows,
)

ARRIVED, DATASETS, EXTREMES = inside("physim.record", "ARRIVED", "DATASETS", "EXTREMES")
Extremes = inside("physim.record", "Extremes")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0).close()
    return path


def test_round_trip(made: Path) -> None:
    scene = make_scene(seconds=4.0)
    with Record.load(made) as record:
        assert (record.name, record.seed, record.dt, record.robots) == ("made up", 3, 0.01, 3)
        assert (record.ended, record.steps_planned, record.steps_run) == ("duration", 400, 400)
        assert record.names == ("r1", "r2", "r3")
        assert record.bodies == scene.bodies
        assert record.wall_clock == {"seconds": 0.1, "factor": 40.0}
        assert set(record.versions) >= {"physim", "pymunk", "shapely"}
        np.testing.assert_array_equal(record.steps, np.arange(401))
        np.testing.assert_array_equal(record.time, 0.01 * np.arange(401))
        np.testing.assert_array_equal(record.pose, poses(scene))
        np.testing.assert_array_equal(record.pose_at(17), record.pose[17])
        np.testing.assert_array_equal(record.updates, update_rows(scene, poses(scene)))
        decided = update_rows(scene, poses(scene))
        np.testing.assert_array_equal(record.considered, considered_rows(decided))
        np.testing.assert_array_equal(record.contacts, contact_rows(scene))
        np.testing.assert_array_equal(record.lead, scene.formation.lead)
        assert record.declared == DECLARED
        assert record.arrived.tolist() == [-1, -1, -1]
        np.testing.assert_array_equal(record.stop_station, scene.stop_station)
        assert [len(parts) for parts in record.footprints] == [1, 1, 2]
        np.testing.assert_array_equal(record.footprints[2][1], scene.shapes.vertices[12:16])
        for found, wanted in (
            (record.walls, scene.walls), (record.paths, scene.paths),
            (record.reference, scene.reference),
        ):  # fmt: skip
            for one, other in zip(found, wanted, strict=True):
                np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)
        assert len(record.accessible) == len(record.safe) == 1
        for robot, row in enumerate(record.extremes):
            for values, value, when in (
                (record.clearance, "clearance", "clearance_step"),
                (record.boundary_clearance, "boundary_clearance", "boundary_step"),
            ):
                assert row[value] == values[:, robot].min()
                assert row[when] == values[:, robot].argmin()


def test_arrays_of_a_record_cannot_be_changed(made: Path) -> None:
    with Record.load(made) as record, pytest.raises(ValueError, match="read-only"):
        record.pose[0, 0, 0] = 1.0


def test_memory_and_file_are_the_same_record(made: Path, tmp_path: Path) -> None:
    record = make_record(seconds=4.0)
    record.save(tmp_path / "saved.h5")
    with Record.load(made) as on_disk, Record.load(tmp_path / "saved.h5") as saved:
        assert record.digest() == on_disk.digest() == saved.digest()
        on_disk.save(tmp_path / "copy.h5")
    with Record.load(tmp_path / "copy.h5") as copy:
        assert copy.digest() == record.digest()
    assert {p.name for p in tmp_path.iterdir()} == {"saved.h5", "copy.h5"}


@settings(max_examples=10)
@given(block=st.integers(1, 60))
def test_streaming_in_blocks_of_any_size_gives_one_record(block: int) -> None:
    with make_record(seconds=0.5, block=block) as one, make_record(seconds=0.5, block=51) as whole:
        assert one.digest() == whole.digest()


def test_names_are_labels_only(tmp_path: Path) -> None:
    scene = make_scene(seconds=0.1)
    odd = ("../x", "a/b", "r10 'ü'")
    for body, name in zip(scene.bodies, odd, strict=False):
        object.__setattr__(body, "name", name)
    out = RecordWriter(tmp_path / "r.h5", scene, "", name="")
    out.close("error", steps_run=0, rejected=0, wall_clock={})
    with out.record() as record:
        assert record.names == odd
        assert record.samples == 0


def test_existing_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "r.h5").write_text("old")
    with make_record(tmp_path / "r.h5", seconds=0.1) as record:
        assert record.samples == 11


# Digest


def test_wall_clock_and_versions_are_outside_the_digest(made: Path, tmp_path: Path) -> None:
    before, after = digests(made, tmp_path, change_wall_clock)
    assert before == after


def change_wall_clock(file: h5py.File) -> None:
    file["/wall_clock"].attrs["seconds"] = 77.0
    file.attrs["versions"] = "{}"


REFUSED = ("/columns/name", "/columns/unit", "/bodies/id", "/bodies/kind")
"""Any other name, unit, number or kind of these is no record at all: see `test_values`."""


@pytest.mark.parametrize("path", [path for path in DATASETS if path not in REFUSED])
def test_one_bit_changes_the_digest(made: Path, tmp_path: Path, path: str) -> None:
    def change(file: h5py.File) -> None:
        if not file[path].size:
            file[path].resize(1, axis=0)
            return
        values = np.asarray(file[path][()])
        if path == "/modes/colour":
            values[0] = values[0][:-1] + b"0"
        elif values.dtype.kind == "O":
            values[0] = values[0] + b"x"
        else:
            flat = np.frombuffer(bytearray(values.tobytes()), np.uint8)
            flat[len(flat) // 2] ^= 1
            values = np.frombuffer(flat.tobytes(), values.dtype).reshape(values.shape)
        file[path][...] = values

    before, after = digests(made, tmp_path, change)
    assert before != after


def test_footprints_are_inside_the_digest(made: Path, tmp_path: Path) -> None:
    def change(file: h5py.File) -> None:
        file["/footprints/vertices"][-1, 0] += 1e-9

    before, after = digests(made, tmp_path, change)
    assert before != after


@pytest.mark.parametrize("name", ["world", "seed", "dt", "ended", "steps_run", "name"])
def test_attributes_are_inside_the_digest(made: Path, tmp_path: Path, name: str) -> None:
    changed = {"world": "w", "name": "n", "ended": np.bytes_(b"error"), "dt": 0.02}

    def change(file: h5py.File) -> None:
        file.attrs[name] = changed.get(name, np.int64(9))

    before, after = digests(made, tmp_path, change)
    assert before != after


def digests(made: Path, folder: Path, change: object) -> tuple[str, str]:
    """Digest of a record, and of a copy that was changed."""
    copy = folder / "changed.h5"
    shutil.copy(made, copy)
    with h5py.File(copy, "r+") as file:
        change(file)  # type: ignore[operator]
    with Record.load(made) as before, Record(h5py.File(copy, "r")) as after:
        return before.digest(), after.digest()


# Extremes


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000), cuts=st.lists(st.integers(0, 20), max_size=4))
def test_extremes_do_not_depend_on_blocks(seed: int, cuts: list[int]) -> None:
    random = np.random.default_rng(seed)
    found = SimpleNamespace(
        clearance=random.integers(-2, 4, (20, 3)) / 4.0,
        other=random.integers(0, 3, (20, 3)),
        boundary_clearance=random.integers(-2, 4, (20, 3)) / 4.0,
        boundary_other=random.integers(3, 5, (20, 3)),
        farthest=random.integers(0, 5, 20) / 2.0,
        farthest_a=random.integers(0, 2, 20),
        farthest_b=np.full(20, 2),
    )
    whole, parts = Extremes(3), Extremes(3)
    whole.note(np.arange(20), found)
    edges = [0, *sorted(cuts), 20]
    for first, last in pairwise(edges):
        block = {key: value[first:last] for key, value in vars(found).items()}
        parts.note(np.arange(first, last), SimpleNamespace(**block))
    np.testing.assert_array_equal(whole.rows, parts.rows)
    np.testing.assert_array_equal(whole.farthest, parts.farthest)
    first = int(np.argmax(found.farthest))
    expected = (found.farthest.max(), first, found.farthest_a[first], 2)
    assert whole.farthest.tolist() == expected
    for i in range(3):
        at = min(range(20), key=lambda k: (found.clearance[k, i], k))
        row = whole.rows[i]
        assert tuple(row)[:3] == (found.clearance[at, i], at, found.other[at, i])


def test_memory_stays_flat(tmp_path: Path) -> None:
    """Twenty times the rows, the same peak of memory."""

    def peak(blocks: int) -> int:
        scene = make_scene(robots=10, seconds=10_000.0)
        out = RecordWriter(
            tmp_path / f"{blocks}.h5", scene, "", name="", declared=DECLARED, flush_every_s=1e9
        )
        pose, near = np.zeros((1000, 10, 3)), np.zeros((1000, 10))
        rows, touching = np.zeros(1000, UPDATE), np.zeros(1000, CONTACT_ROW)
        tracemalloc.start()
        for block in range(blocks):
            out.append("updates", rows)
            out.append("contacts", touching)
            out.append_steps(np.arange(1000 * block, 1000 * block + 1000), pose, near, near)
        size = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        out.close("duration", steps_run=1, rejected=0, wall_clock={})
        return size

    few, many = peak(10), peak(200)
    assert (tmp_path / "200.h5").stat().st_size > 90e6
    assert many < few + 1e6


def test_single_samples_are_those_of_the_whole_and_read_in_few_pieces(
    made: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("physim.record.history.POSE_BLOCK", 192)  # 64 samples of three robots
    with Record.load(made) as record:
        pieces: list[str] = []
        read = Record.read

        def counted(self: Record, path: str, *rows: Any, **options: Any) -> Any:
            pieces.append(path)
            return read(self, path, *rows, **options)

        monkeypatch.setattr(Record, "read", counted)
        single = [record.pose_at(step) for step in reversed(range(401))]
        assert pieces.count("/steps/pose") == 7
        np.testing.assert_array_equal(single, record.pose[::-1])


def test_contacts_over_steps(made: Path) -> None:
    with Record.load(made) as record:
        rows = record.contacts
        assert len(rows)
        for first, last in ((0, 401), (-5, 1000), (100, 250), (200, 200)):
            within = rows[(rows["step"] >= first) & (rows["step"] < last)]
            np.testing.assert_array_equal(record.contacts_over(first, last), within)


def test_a_record_is_pickled_by_its_file(made: Path) -> None:
    with Record.load(made) as record, pickle.loads(pickle.dumps(record)) as again:
        assert (again.path, again.digest()) == (made.absolute(), record.digest())
    with make_record(seconds=0.1) as record, pytest.raises(TypeError, match="save"):
        pickle.dumps(record)


# Bad input


def test_step_that_is_not_recorded(made: Path) -> None:
    with Record.load(made) as record, pytest.raises(RecordError, match="nearest: 400"):
        record.pose_at(401)


def test_a_closed_record_says_so(made: Path) -> None:
    """It was told as damaged, of a file that is as it should be."""
    with Record.load(made) as record:
        pass
    for ask in (
        lambda: record.pose, lambda: record.versions, record.digest, lambda: physim.page(record)
    ):  # fmt: skip
        with pytest.raises(RecordError, match=facts(str(made), "closed", "load")):
            ask()
    assert record.name
    record.close()


def test_commands_of_a_stage_that_is_none(made: Path) -> None:
    with (
        Record.load(made) as record,
        pytest.raises(PhysimError, match=facts("'aplied'", "applied")),
    ):
        record.commands_over("aplied", 0, 1)


def test_a_path_is_no_open_file(made: Path) -> None:
    with pytest.raises(TypeError, match=facts("Record.load", str(made))):
        Record(str(made))  # type: ignore[arg-type]


def test_unwritable_place(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=facts("no/r.h5: ", "No such file")):
        make_record(tmp_path / "no" / "r.h5")
    with make_record(seconds=0.1) as record, pytest.raises(RecordError, match="cannot be written"):
        record.save(tmp_path / "no" / "r.h5")


def test_rows_of_another_kind(tmp_path: Path) -> None:
    out = RecordWriter(None, make_scene(), "", name="")
    with pytest.raises(RecordError, match="/updates: rows of type"):
        out.append("updates", np.zeros(1, CONTACT_ROW))
    with pytest.raises(ValueError, match="pose"):
        out.append_steps([0], np.zeros((1, 4, 3)), np.zeros((1, 3)), np.zeros((1, 3)))
    with pytest.raises(RecordError, match=facts('"crashed"', "running", "finished")):
        out.close("crashed", steps_run=0, rejected=0, wall_clock={})


def test_what_is_no_file(tmp_path: Path, made: Path) -> None:
    refused(tmp_path / "none.h5", "no such file")
    refused(tmp_path, "is a folder")
    refused(made.parent, facts("record.h5"))
    (tmp_path / "text.h5").write_text("name: world\n")
    refused(tmp_path / "text.h5", "not an HDF5 file")
    (tmp_path / "empty.h5").write_bytes(b"")
    refused(tmp_path / "empty.h5", "not an HDF5 file")


def test_other_hdf5_files(tmp_path: Path, made: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    refused(tmp_path / "other.h5", "not a record of physim")
    for version in ("5.0", "3.0", "2", "4", "4.x", "x" * 99, 9):
        copy = altered(made, tmp_path, lambda f, v=version: f.attrs.create("version", v))
        refused(copy, facts("record version", "reads version 4"))
    refused(altered(made, tmp_path, lambda f: f.attrs.pop("dt")), facts("attribute dt", "missing"))
    refused(altered(made, tmp_path, lambda f: f.attrs.create("dt", -1.0)), "attribute dt is -1.0,")
    refused(altered(made, tmp_path, lambda f: f.attrs.create("dt", "x")), "attribute dt is")


@pytest.mark.parametrize("change", ["version", "dt", "/updates", "/footprints/body_start"])
def test_an_open_file_is_checked_too(made: Path, tmp_path: Path, change: str) -> None:
    def leave_out(file: h5py.File) -> None:
        (file if change.startswith("/") else file.attrs).pop(change)

    copy = altered(made, tmp_path, leave_out)
    with h5py.File(copy) as file, pytest.raises(RecordError, match=change) as caught:
        Record(file)
    assert str(caught.value).startswith(f"{copy}: ")
    other = h5py.File("other", "w", driver="core", backing_store=False)
    with other, pytest.raises(RecordError, match=facts("record in memory:", "not a record")):
        Record(other)
    with h5py.File(made) as file:
        assert Record(file).names == ("r1", "r2", "r3")


@pytest.mark.parametrize("path", DATASETS)
def test_missing_or_wrong_dataset(made: Path, tmp_path: Path, path: str) -> None:
    refused(altered(made, tmp_path, lambda file: file.pop(path)), f"dataset {path} is missing")
    shape = h5py.File(made)[path].shape
    for wrong in (
        np.zeros((3, 5)), np.zeros((*shape, 2), np.uint16), np.zeros(shape, np.uint64),
        np.zeros(shape, "V16"), np.zeros(shape, [("x\x1b", "f8")]), np.zeros(shape, "S3"),
        np.full(shape, None, h5py.vlen_dtype(np.int32)), np.full(shape, None, h5py.ref_dtype),
        h5py.Empty("f8"),
    ):  # fmt: skip

        def other_rows(file: h5py.File, rows: Any = wrong) -> None:
            del file[path]
            file.create_dataset(path, data=None if rows.dtype.kind == "O" else rows,
                                shape=rows.shape, dtype=rows.dtype)  # fmt: skip

        said = f"dataset {path} (has rows|holds no texts)|{path} holds lists"
        refused(altered(made, tmp_path, other_rows), said)


@pytest.mark.parametrize("path", ["/robots/lead", ARRIVED, EXTREMES, "/bodies/name"])
def test_a_row_too_few(made: Path, tmp_path: Path, path: str) -> None:
    def shorter(file: h5py.File) -> None:
        rows, kind = file[path][:-1], file[path].dtype
        del file[path]
        file.create_dataset(path, data=rows, dtype=kind)

    refused(altered(made, tmp_path, shorter), f"dataset {path} has .* robots")


def test_truncated_file(made: Path, tmp_path: Path) -> None:
    """Wherever a copy breaks off: an error of one line, or nothing lost."""
    data = made.read_bytes()
    for size in np.linspace(9, len(data) - 1, 40).astype(int):
        (tmp_path / "short.h5").write_bytes(data[:size])
        refused(tmp_path / "short.h5", "truncated|damaged")


def altered(made: Path, folder: Path, change: object) -> Path:
    """Copy of a record with something changed."""
    copy = folder / "altered.h5"
    shutil.copy(made, copy)
    with h5py.File(copy, "r+") as file:
        change(file)  # type: ignore[operator]
    return copy


def refused(path: Path, message: str) -> None:
    """Check that loading fails with one line that names the file."""
    with pytest.raises(RecordError, match=message) as caught:
        Record.load(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_versions_are_plain_text(made: Path) -> None:
    with h5py.File(made) as file:
        assert "physim" in json.loads(file.attrs["versions"])
