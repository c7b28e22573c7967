"""Records that were packed: read as they are, but for those that unpack to far more."""

from __future__ import annotations

import shutil
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from physim.errors import RecordError
from physim.record import Record
from tests.helpers import inside
from tests.helpers.records import make_record
from tests.record.test_values import in_order

LITTLE, REFERENCE = inside("physim.record", "LITTLE", "REFERENCE")

POSE = "/steps/pose"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, world_text="").close()
    return path


def repacked(made: Path, folder: Path, rows: int = 32, **how: Any) -> tuple[Path, bytes]:
    """Copy whose poses are stored anew, ``rows`` a chunk; and its first chunk, unpacked."""
    target = folder / "packed.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        values = file[POSE][()]
        del file[POSE]
        chunks = (rows, *values.shape[1:])
        file.create_dataset(POSE, data=values, chunks=chunks, maxshape=(None, 3, 3), **how)
    return target, values[:rows].tobytes()


def refused(record: Path, *parts: str) -> None:
    with pytest.raises(RecordError) as raised:
        Record.load(record)
    in_order(str(raised.value), str(record), POSE, *parts)


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"compression": "gzip"},
        {"compression": "gzip", "compression_opts": 0},
        {"shuffle": True, "compression": "gzip", "compression_opts": 9, "fletcher32": True},
        {"shuffle": True, "fletcher32": True},
        {"fletcher32": True},
    ],
)
def test_packed_records_are_read(made: Path, tmp_path: Path, how: Mapping[str, Any]) -> None:
    path, _ = repacked(made, tmp_path, **how)
    with Record.load(path) as record, Record.load(made) as plain:
        assert np.array_equal(record.pose, plain.pose)
        assert record.digest() == plain.digest()


@pytest.mark.parametrize("how", [{"compression": "lzf"}, {"scaleoffset": 6}])
def test_other_filters(made: Path, tmp_path: Path, how: Mapping[str, Any]) -> None:
    path, _ = repacked(made, tmp_path, **how)
    refused(path, "filters", "shuffle, gzip and fletcher32")


def test_a_chunk_is_not_far_larger_than_its_dataset(made: Path, tmp_path: Path) -> None:
    """Unpacked whole to read one value: 5 MB of zeros are 4 GB."""
    path, _ = repacked(made, tmp_path, LITTLE // 72 + 1, compression="gzip")
    refused(path, "chunks", "damaged")
    path, _ = repacked(made, tmp_path, LITTLE // 72, compression="gzip")
    Record.load(path).close()


@pytest.mark.parametrize("checksum", [False, True])
@pytest.mark.parametrize("more", [-8, 0, 1, 10_000_000])
def test_a_chunk_unpacks_to_what_it_says(
    made: Path, tmp_path: Path, more: int, checksum: bool
) -> None:
    path, chunk = repacked(made, tmp_path, compression="gzip", fletcher32=checksum)
    with h5py.File(path, "r+") as file:
        there = chunk[:more] if more < 0 else chunk + bytes(more)
        file[POSE].id.write_direct_chunk((0, 0, 0), zlib.compress(there) + bytes(4 * checksum))
    if more:
        refused(path, f"{'longer' if more > 0 else 'shorter'} than it says", "damaged")
    elif not checksum:
        Record.load(path).close()


def test_a_chunk_that_is_stored_as_it_is(made: Path, tmp_path: Path) -> None:
    """The mask of a chunk says which filters it did not go through."""
    path, chunk = repacked(made, tmp_path, compression="gzip")
    with h5py.File(path, "r+") as file:
        file[POSE].id.write_direct_chunk((0, 0, 0), chunk, filter_mask=1)
    Record.load(path).close()
    for given, said in ((chunk + bytes(1), "longer"), (chunk[:-1], "shorter")):
        with h5py.File(path, "r+") as file:
            file[POSE].id.write_direct_chunk((0, 0, 0), given, filter_mask=1)
        refused(path, f"{said} than it says")


@pytest.mark.parametrize(
    "how", [{"shuffle": True}, {"fletcher32": True}, {"shuffle": True, "compression": "gzip"}]
)
def test_a_chunk_that_is_shorter_is_not_read(
    made: Path, tmp_path: Path, how: Mapping[str, Any]
) -> None:
    """The library reads on behind it: figures of what lies in memory, or the end of the process."""
    path, chunk = repacked(made, tmp_path, **how)
    with h5py.File(path, "r+") as file:
        few = chunk[:100]
        given = zlib.compress(few) if "compression" in how else few
        file[POSE].id.write_direct_chunk((0, 0, 0), given)
    refused(path, "shorter than it says")


def with_reference(made: Path, folder: Path, **change: int) -> Path:
    """Copy whose second body has its reference to a name changed."""
    path = shutil.copyfile(made, folder / "texts.h5")
    with h5py.File(path) as file:
        at = file["bodies/name"].id.get_offset()
    raw = bytearray(path.read_bytes())
    rows = np.frombuffer(raw, REFERENCE, 2, at).copy()
    for name, by in change.items():
        rows[name][1] = int(rows[name][1]) + by
    raw[at : at + rows.nbytes] = rows.tobytes()
    path.write_bytes(raw)
    return path


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"length": 1}, "not in the file as it says"),
        ({"length": -1}, "not in the file as it says"),
        ({"length": 2**31}, "letters"),
        ({"heap": 8}, "not in the file as it says"),
        ({"heap": 1 << 40}, "not in the file as it says"),
        ({"number": 500}, "not in the file as it says"),
    ],
)
def test_a_reference_to_a_text_that_is_none(
    made: Path, tmp_path: Path, change: Mapping[str, int], said: str
) -> None:
    """The library believed it: 4 GB of memory, the end of the process, or no end at all."""
    Record.load(with_reference(made, tmp_path)).close()
    with pytest.raises(RecordError, match=f"/bodies/name .*{said}.*damaged"):
        Record.load(with_reference(made, tmp_path, **change))


def test_a_heap_that_is_written_over(made: Path, tmp_path: Path) -> None:
    path = shutil.copyfile(made, tmp_path / "texts.h5")
    raw = bytearray(path.read_bytes())
    at = raw.find(b"GCOL")
    raw[at + 16 : at + 80] = b"x" * 64
    path.write_bytes(raw)
    with pytest.raises(RecordError, match="damaged"):
        Record.load(path)


def test_lists_of_their_own_lengths(made: Path, tmp_path: Path) -> None:
    """Within one another they take memory by the square of the file."""
    path = shutil.copyfile(made, tmp_path / "lists.h5")
    with h5py.File(path, "r+") as file:
        file.create_dataset("x", (2,), h5py.vlen_dtype(np.uint8))
    with pytest.raises(RecordError, match="/x holds lists of their own lengths"):
        Record.load(path)


def test_texts_are_counted_over_all_datasets(made: Path, tmp_path: Path) -> None:
    path = shutil.copyfile(made, tmp_path / "texts.h5")
    with h5py.File(path, "r+") as file:
        for k in range(5):
            many = file.create_dataset(f"x{k}", (4,), h5py.string_dtype())
            many[:] = ["x" * (LITTLE // 16)] * 4
    Record.load(path).close()  # as long as the file
    with h5py.File(path, "r+") as file:
        places = []
        for k in range(5):
            many = file.create_dataset(f"y{k}", (1,), h5py.string_dtype())
            many[0] = "y" * (LITTLE // 2)
            file.flush()
            places.append(many.id.get_offset())
    raw = Path(path).read_bytes()
    with h5py.File(path, "r+") as file:
        for k, place in enumerate(places):
            of_one = file.create_dataset(f"z{k}", (3,), h5py.string_dtype(), chunks=(3,))
            of_one.id.write_direct_chunk((0,), raw[place : place + 16] * 3)
    with pytest.raises(RecordError, match="letters; it is damaged"):
        Record.load(path)
