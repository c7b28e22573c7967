"""Records: round trip, streaming, digest, memory, tables as data frames."""

from __future__ import annotations

import pickle
import shutil
import sys
import tracemalloc
from collections.abc import Callable
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
    told,
    update_rows,
)

TABLE, Extremes = inside("physim.record", "TABLE", "Extremes")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, sensed=True).close()
    return path


def test_round_trip(made: Path) -> None:
    scene = make_scene(seconds=4.0)
    decided = update_rows(scene, poses(scene))
    with Record.load(made) as record:
        assert (record.name, record.seed, record.dt, record.robots) == ("made up", 3, 0.01, 3)
        assert (record.ended, record.steps_planned, record.steps_run) == ("duration", 400, 400)
        assert (record.bodies, record.declared) == (scene.bodies, DECLARED)
        assert record.wall_clock == {"seconds": 0.1, "factor": 40.0}
        assert set(record.versions) >= {"physim", "pymunk", "shapely"}
        with pytest.raises(ValueError, match="read-only"):
            record.pose[0, 0, 0] = 1.0
        for found, wanted in (
            (record.steps, np.arange(401)),
            (record.time, 0.01 * np.arange(401)),
            (record.pose, poses(scene)),
            (record.pose_at(17), record.pose[17]),
            (record.updates, decided),
            (record.considered, considered_rows(decided)),
            (record.contacts, contact_rows(scene)),
            (record.lead, scene.formation.lead),
            (record.stop_station, scene.stop_station),
            (record.arrived, [-1, -1, -1]),
            (record.footprints[2][1], scene.shapes.vertices[12:16]),
            (record.extremes["clearance"], record.clearance.min(axis=0)),
            (record.extremes["boundary_step"], record.boundary_clearance.argmin(axis=0)),
        ):
            np.testing.assert_array_equal(found, wanted)
        assert [len(parts) for parts in record.footprints] == [1, 1, 2]
        for name in ("shapes", "walls", "paths", "reference"):
            for one, other in zip(getattr(record, name), getattr(scene, name), strict=True):
                np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)
        assert len(record.accessible) == len(record.safe) == 1
        rows = record.contacts
        for first, last in ((0, 401), (-5, 1000), (100, 250), (200, 200)):
            within = rows[(rows["step"] >= first) & (rows["step"] < last)]
            np.testing.assert_array_equal(record.contacts_over(first, last), within)


def test_memory_file_copy_and_pickle_are_the_same_record(made: Path, tmp_path: Path) -> None:
    record = make_record(seconds=4.0, sensed=True)
    record.save(tmp_path / "saved.h5")
    with Record.load(made) as on_disk, pickle.loads(pickle.dumps(on_disk)) as again:
        assert (again.path, again.digest()) == (made.absolute(), record.digest())
        on_disk.save(tmp_path / "copy.h5")
    for name in ("saved.h5", "copy.h5"):
        with Record.load(tmp_path / name) as copy:
            assert copy.digest() == record.digest()
    assert {p.name for p in tmp_path.iterdir()} == {"saved.h5", "copy.h5"}
    with pytest.raises(TypeError, match="save"):
        pickle.dumps(record)


@settings(max_examples=10)
@given(block=st.integers(1, 60))
def test_streaming_in_blocks_of_any_size_gives_one_record(block: int) -> None:
    with make_record(seconds=0.5, block=block) as one, make_record(seconds=0.5, block=51) as whole:
        assert one.digest() == whole.digest()


# Digest


def bit(path: str) -> Callable[[h5py.File], None]:
    """Change one bit of a dataset."""

    def change(file: h5py.File) -> None:
        if not file[path].size:
            file[path].resize(1, axis=0)
            return
        values = np.asarray(file[path][()])
        flat = np.frombuffer(bytearray(values.tobytes()), np.uint8)
        flat[len(flat) // 2] ^= 1
        file[path][...] = np.frombuffer(flat.tobytes(), values.dtype).reshape(values.shape)

    return change


def attribute(name: str, value: Any) -> Callable[[h5py.File], None]:
    return lambda file: file.attrs.__setitem__(name, value)


STATES = ("/states", "/state_bytes", "/robots/begun_along")
"""Outside the digest: a run has them or not, or they follow from what is in it."""
INSIDE = {
    **{path: bit(path) for path in TABLE if path not in (*STATES, "/steps/steering")},
    "a name": told("bodies", None, 1, name="other"),
    "words": told("declared", "modes", 0, words="other"),
    "a colour": told("declared", "modes", 0, colour="#000000"),
    "danger": told("declared", "modes", 0, danger=True),
    "a rule": told("declared", "rules", 0, name="other"),
    "a column": told("declared", "columns", 5, words="other"),
    "the world": attribute("world", "w"),
    "the seed": attribute("seed", np.int64(9)),
    "dt": attribute("dt", 0.02),
    "the end": attribute("ended", np.bytes_(b"error")),
}
OUTSIDE = {
    "wall clock": lambda file: file["/wall_clock"].attrs.__setitem__("seconds", 77.0),
    "versions": attribute("versions", "{}"),
}


@pytest.mark.parametrize("what", [*INSIDE, *OUTSIDE])
def test_what_the_digest_is_of(made: Path, tmp_path: Path, what: str) -> None:
    copy = Path(shutil.copy(made, tmp_path / "changed.h5"))
    with h5py.File(copy, "r+") as file:
        {**INSIDE, **OUTSIDE}[what](file)
    with Record.load(made) as before, Record(h5py.File(copy, "r")) as after:
        assert (before.digest() == after.digest()) == (what in OUTSIDE)


# Extremes and memory


@settings(max_examples=20)
@given(seed=st.integers(0, 10_000), cuts=st.lists(st.integers(0, 20), max_size=4))
def test_extremes_are_the_earliest_and_do_not_depend_on_blocks(seed: int, cuts: list[int]) -> None:
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
    parts = Extremes(3)
    for first, last in pairwise([0, *sorted(cuts), 20]):
        block = {key: value[first:last] for key, value in vars(found).items()}
        parts.note(np.arange(first, last), SimpleNamespace(**block))
    first = int(np.argmax(found.farthest))
    expected = (found.farthest.max(), first, found.farthest_a[first], 2)
    assert parts.farthest.tolist() == expected
    for i in range(3):
        at, of = found.clearance[:, i].argmin(), found.boundary_clearance[:, i].argmin()
        assert parts.rows[i].tolist() == (
            found.clearance[at, i], at, found.other[at, i],
            found.boundary_clearance[of, i], of, found.boundary_other[of, i],
        )  # fmt: skip


def test_memory_stays_flat(tmp_path: Path) -> None:
    """Many rows, a bounded peak of memory."""
    path = tmp_path / "r.h5"
    scene = make_scene(robots=10, seconds=10_000.0)
    out = RecordWriter(path, scene, "", name="", declared=DECLARED, flush_every_s=1e9)
    pose, near = np.zeros((1000, 10, 3)), np.zeros((1000, 10))
    rows, touching = np.zeros(1000, UPDATE), np.zeros(1000, CONTACT_ROW)
    tracemalloc.start()
    for block in range(120):
        out.append("updates", rows)
        out.append("contacts", touching)
        out.append_steps(np.arange(1000 * block, 1000 * block + 1000), pose, near, near)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    out.close("duration", steps_run=1, rejected=0, wall_clock={})
    assert peak < 16e6
    assert path.stat().st_size > 50e6


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


def test_data_frames_hold_the_values_of_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    with make_record(seconds=4.0) as record:
        steps, updates = record.to_pandas(), record.to_pandas("updates")
        assert len(steps) == record.samples * 3
        one = steps[steps["robot"] == "r2"]
        assert np.array_equal(one[["x", "y", "heading"]].to_numpy(), record.pose[:, 1])
        assert np.array_equal(one["time"].to_numpy(), record.time)
        assert np.array_equal(one["clearance"].to_numpy(), record.clearance[:, 1])
        assert np.array_equal(updates["station"].to_numpy(), record.updates["station"])
        assert np.array_equal(updates["time"].to_numpy(), 0.01 * record.updates["step"])
        assert set(updates["robot"]) == {"r1", "r2", "r3"}
        assert {"safe", "danger_time"} < set(updates["mode"])
        contacts = record.to_pandas("contacts")
        assert np.array_equal(contacts["depth"].to_numpy(), record.contacts["depth"])
        assert set(contacts["phase"]) == {"began", "stays", "ended"}
        assert (set(contacts["a"]), set(contacts["b"])) == ({"r1", "r2"}, {"r2", "left"})
        monkeypatch.setitem(sys.modules, "pandas", None)
        with pytest.raises(PhysimError, match=r'pip install "physim\[study\]"'):
            record.to_pandas()
