"""Records: round trip, streaming, digest, memory, tables as data frames."""

from __future__ import annotations

import pickle
import shutil
import sys
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
from physim.world.file import parse_world
from tests.campaigns.samples import WORLD
from tests.helpers import facts, inside
from tests.helpers.records import (
    DECLARED,
    UPDATE,
    considered_rows,
    contact_rows,
    make_record,
    make_scene,
    poses,
    told,
    update_rows,
)

ARRIVED, TABLE, EXTREMES = inside("physim.record", "ARRIVED", "TABLE", "EXTREMES")
DATASETS = tuple(TABLE)
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
        with pytest.raises(ValueError, match="read-only"):
            record.pose[0, 0, 0] = 1.0
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


# Digest


def test_wall_clock_and_versions_are_outside_the_digest(made: Path, tmp_path: Path) -> None:
    def change(file: h5py.File) -> None:
        file["/wall_clock"].attrs["seconds"] = 77.0
        file.attrs["versions"] = "{}"

    before, after = digests(made, tmp_path, change)
    assert before == after


STATES = ("/states", "/state_bytes", "/robots/begun_along")
"""Outside the digest: a run has them or not, or they follow from what is in it."""


@pytest.mark.parametrize("path", [path for path in DATASETS if path not in STATES])
def test_one_bit_changes_the_digest(made: Path, tmp_path: Path, path: str) -> None:
    def change(file: h5py.File) -> None:
        if not file[path].size:
            file[path].resize(1, axis=0)
            return
        values = np.asarray(file[path][()])
        flat = np.frombuffer(bytearray(values.tobytes()), np.uint8)
        flat[len(flat) // 2] ^= 1
        file[path][...] = np.frombuffer(flat.tobytes(), values.dtype).reshape(values.shape)

    before, after = digests(made, tmp_path, change)
    assert before != after


@pytest.mark.parametrize(
    "change",
    [
        told("bodies", None, 1, name="other"),
        told("declared", "modes", 0, words="other"),
        told("declared", "modes", 0, colour="#000000"),
        told("declared", "modes", 0, danger=True),
        told("declared", "rules", 0, name="other"),
        told("declared", "columns", 5, words="other"),
    ],
)
def test_names_and_declarations_are_inside_the_digest(
    made: Path, tmp_path: Path, change: object
) -> None:
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


@settings(max_examples=20)
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
    """Many rows, a bounded peak of memory."""

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

    assert peak(120) < 16e6
    assert (tmp_path / "120.h5").stat().st_size > 50e6


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


# Refused


def test_what_cannot_be_asked_of_a_record(made: Path, tmp_path: Path) -> None:
    with Record.load(made) as record:
        for ask, said in (
            (lambda: record.pose_at(401), ("401", "nearest: 400")),
            (lambda: record.commands_over("aplied", 0, 1), ("'aplied'", "applied")),
            (lambda: record.column("colision_time"), ('"colision_time"', '"collision_time"?')),
            (lambda: record.save(tmp_path / "no" / "r.h5"), ("no/r.h5", "cannot be written")),
            (lambda: record.to_pandas("poses"), ("steps, updates, contacts",)),
        ):
            with pytest.raises(PhysimError, match=facts(*said)):
                ask()
    for ask in (lambda: record.pose, record.digest, lambda: physim.page(record)):
        with pytest.raises(RecordError, match=facts(str(made), "closed", "load")):
            ask()
    with pytest.raises(TypeError, match=facts("Record.load", str(made))):
        Record(str(made))  # type: ignore[arg-type]


def test_what_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=facts("no/r.h5: ", "No such file")):
        make_record(tmp_path / "no" / "r.h5")
    out = RecordWriter(None, make_scene(), "", name="")
    with pytest.raises(RecordError, match="/updates: rows of type"):
        out.append("updates", np.zeros(1, CONTACT_ROW))
    with pytest.raises(ValueError, match="pose"):
        out.append_steps([0], np.zeros((1, 4, 3)), np.zeros((1, 3)), np.zeros((1, 3)))
    with pytest.raises(RecordError, match=facts('"crashed"', "running", "finished")):
        out.close("crashed", steps_run=0, rejected=0, wall_clock={})


# Data frames

TOUCHING = (
    WORLD.replace("duration: 1.0", "duration: 3.0")
    .replace("[6.0, 1.0, random]", "[6.0, 1.0, 0.0]")
    .replace("[3.0, -1.0, random]", "[6.0, -1.2, 1.5]")
)


class Ahead:
    """Goes where it heads, into whatever is there."""

    modes = (physim.Mode("going", "#0072b2"),)

    def decide(self, observation: physim.Observation, memory: Any) -> physim.Decision:
        return physim.Decision(v=1.0, omega=0.0, hold=0.1, mode="going")


def test_tables_hold_the_values_of_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    record = physim.simulate(parse_world(TOUCHING), controller=Ahead())
    steps = record.to_pandas()
    assert len(steps) == record.samples * 2
    b = steps[steps["robot"] == "b"]
    assert np.array_equal(b[["x", "y", "heading"]].to_numpy(), record.pose[:, 1])
    assert np.array_equal(b["time"].to_numpy(), record.time)
    assert np.array_equal(b["clearance"].to_numpy(), record.clearance[:, 1])
    updates = record.to_pandas("updates")
    assert np.array_equal(updates["applied_v"].to_numpy(), record.updates["applied_v"])
    assert set(updates["robot"]) == {"a", "b"}
    assert set(updates["mode"]) == {"going"}
    contacts = record.to_pandas("contacts")
    assert np.array_equal(contacts["depth"].to_numpy(), record.contacts["depth"])
    assert {"began"} <= set(contacts["phase"]) <= {"began", "stays", "ended"}
    assert set(contacts["a"]) == {"a"}
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(PhysimError, match="pip install pandas"):
        record.to_pandas()
