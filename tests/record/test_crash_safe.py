"""A record is complete at every moment: after each write, a kill, on a full disk; one writer."""

from __future__ import annotations

import errno
import io
import itertools
import os
import random
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from physim.contacts import CONTACT_ROW
from physim.errors import RecordError
from physim.record import Record, RecordWriter
from tests.helpers import facts, inside
from tests.helpers.records import DECLARED, UPDATE, make_record, make_scene

CONSIDERING, OTHERS, PAGE = inside("physim.record", "CONSIDERING", "OTHERS", "PAGE")

ROOT = Path(__file__).parents[2]


def append(out: RecordWriter, first: int, last: int) -> None:
    """Append samples, decisions and contacts of steps ``first`` to ``last - 1``."""
    step = np.arange(first, last)
    updates, contacts = np.zeros(len(step), UPDATE), np.zeros(len(step), CONTACT_ROW)
    updates["step"] = contacts["step"] = step
    updates["next_step"], contacts["b"] = step + 1, 1
    updates["station"], contacts["x"] = 0.5 * step, 0.25 * step
    out.append("updates", updates)
    out.append("contacts", contacts)
    decisions = np.zeros(len(step), CONSIDERING)
    decisions["step"], decisions["count"] = step, 2
    out.append_considered(decisions, np.tile([2, 1], len(step)))
    pose = np.broadcast_to(step[:, None, None] + 1.0, (len(step), 3, 3))
    out.append_steps(step, pose, pose[:, 0], pose[:, 1])


def check(record: Record, least: int) -> int:
    """Check every value of a record made by `append`; returns its number of samples."""
    k = record.samples
    assert k >= least
    assert record.ended in ("running", "duration")
    step = np.arange(k)
    for found, wanted in (
        (record.steps, step),
        (record.pose, np.broadcast_to(step[:, None, None] + 1.0, (k, 3, 3))),
        (record.clearance[:, 0], step + 1.0),
        (record.boundary_clearance[:, 2], step + 1.0),
        (record.updates["step"], step),
        (record.updates["station"], 0.5 * step),
        (record.contacts["x"], 0.25 * step),
        (record.considered["step"], np.repeat(step, 2)),
        (record.considered["other"], np.tile([2, 1], k)),
        (record.read(OTHERS, 1, 4), np.tile([2, 1], k)[1:4]),
    ):
        np.testing.assert_array_equal(found, wanted)
    return k


Change = tuple[int, bytes | None]
"""(place, bytes) of a write, (length, None) of a change of length"""


def noted(monkeypatch: pytest.MonkeyPatch) -> list[Change]:
    """What goes to the disk from now on, in order."""
    changes: list[Change] = []
    pwrite, ftruncate = os.pwrite, os.ftruncate

    def note_write(fd: int, data: Any, address: int) -> int:
        changes.append((address, bytes(data)))
        return pwrite(fd, data, address)

    def note_length(fd: int, length: int) -> None:
        changes.append((length, None))
        ftruncate(fd, length)

    monkeypatch.setattr(os, "pwrite", note_write)
    monkeypatch.setattr(os, "ftruncate", note_length)
    return changes


def images(changes: list[Change]) -> Iterator[tuple[int, bytes]]:
    """File after each change, and between the pages of each; with the number of changes."""
    image = bytearray()
    for number, (place, data) in enumerate(changes):
        if data is None:
            del image[place:]
            image.extend(bytes(place - len(image)))
            yield number, bytes(image)
            continue
        end = place + len(data)
        image.extend(bytes(max(0, end - len(image))))
        while place < end:
            stop = min(end, (place // PAGE + 1) * PAGE)
            image[place:stop], data = data[: stop - place], data[stop - place :]
            place = stop
            yield number, bytes(image)


@pytest.mark.parametrize("every", [29, pytest.param(1, marks=pytest.mark.deep)])
def test_file_is_complete_after_every_single_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, every: int
) -> None:
    """Chunks of few rows, so that the chunk trees split: the root at 64 chunks, then a leaf."""
    monkeypatch.setattr(sys.modules[RecordWriter.__module__], "CHUNK_BYTES", 128)
    changes = noted(monkeypatch)
    out = writer_of(tmp_path / "r.h5")
    marks = [(len(changes), 0)]  # from here on the file has its name
    total = 0
    for rows in (1, 61, 1, 1, 1, 1, 48, *[1] * 14):
        append(out, total, total + rows)
        total += rows
        out.flush()
        marks.append((len(changes), total))
    out.close("duration", steps_run=total - 1, rejected=0, wall_clock={"seconds": 1.0})

    checked = 0
    for number, image in itertools.islice(images(changes), 0, None, every):
        if number < marks[0][0]:
            continue
        least = max(rows for done, rows in marks if done <= number + 1)
        with h5py.File(io.BytesIO(image), "r") as file:
            assert check(Record(file), least) <= total
        checked += 1
    assert checked > 200 / every
    with Record.load(tmp_path / "r.h5") as record:
        assert (check(record, total), record.ended) == (total, "duration")


SCRIPT = """
    import sys
    from tests.record.test_crash_safe import append
    from tests.helpers.records import make_scene
    from physim.record import RecordWriter
    from tests.helpers.records import DECLARED

    out = RecordWriter(
        sys.argv[1], make_scene(), "name: x", name="x", declared=DECLARED, flush_every_s=0.02
    )
    step = 0
    while True:
        append(out, step, step + 7)
        step += 7
        if step % 700 == 0:
            out.flush()
            print(step, flush=True)
"""


def writer_of(path: Path, *, overwrite: bool = True) -> RecordWriter:
    return RecordWriter(
        path, make_scene(), "name: x\n", name="x", declared=DECLARED, flush_every_s=1e9,
        overwrite=overwrite,
    )  # fmt: skip


def closed(out: RecordWriter, samples: int) -> None:
    out.close("duration", steps_run=samples - 1, rejected=0, wall_clock={})


AT_IT = facts("r.h5: ", "another", "writing")


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.deep) for k in (1, 2))])
def test_record_survives_a_kill_and_may_be_written_anew(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "r.h5"
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(SCRIPT), str(path)],
        cwd=ROOT, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    with pytest.raises(RecordError, match=AT_IT):
        writer_of(path)
    time.sleep(random.Random(seed).uniform(0.0, 0.1))
    process.send_signal(signal.SIGKILL)
    told = [int(line) for line in process.stdout]
    process.wait()
    process.stdout.close()
    with Record.load(path) as record:
        assert record.ended == "running"
        assert check(record, max(told, default=700)) == record.steps_run + 1
    out = writer_of(path)
    append(out, 0, 30)
    closed(out, 30)
    with out.record() as record:
        assert check(record, 30) == 30
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]


@pytest.mark.parametrize("room", [0, 3_000, 60_000, 77_000, 128_000, 179_000, 300_000])
def test_on_a_full_disk_a_record_stays_as_the_last_flush_left_it(
    room: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pwrite, ftruncate, path = os.pwrite, os.ftruncate, tmp_path / "r.h5"

    def write(fd: int, data: Any, address: int) -> int:
        if address >= room:
            raise OSError(errno.ENOSPC, "No space left on device")
        return pwrite(fd, data[: room - address], address)

    def lengthen(fd: int, length: int) -> None:
        if length > room:
            raise OSError(errno.ENOSPC, "No space left on device")
        ftruncate(fd, length)

    monkeypatch.setattr(os, "pwrite", write)
    monkeypatch.setattr(os, "ftruncate", lengthen)
    told = rf"^{path}: .*No space left on device$"
    flushed = -1
    with pytest.raises(RecordError, match=told):  # noqa: PT012
        out = writer_of(path)
        flushed = 0
        for block in range(200):
            append(out, 50 * block, 50 * block + 50)
            out.flush()
            flushed = 50 * block + 50
    if flushed < 0:
        assert list(tmp_path.iterdir()) == []
        return
    for again in (out.flush, lambda: append(out, 0, 1), lambda: closed(out, 2)):
        with pytest.raises(RecordError, match=told):
            again()
    with Record.load(path) as record:
        assert check(record, flushed) == flushed
        assert record.ended == "running"
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]


# One writer at a time


def test_the_second_writer_is_refused_and_the_first_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    with make_record(seconds=0.1) as other:
        first = writer_of(path)
        append(first, 0, 50)
        for second in (lambda: writer_of(path), lambda: other.save(path)):
            with pytest.raises(RecordError, match=AT_IT):
                second()
    first.flush()
    with h5py.File(path) as file:  # whoever only reads may do so meanwhile
        assert len(file["/steps/step"]) == 50
    with pytest.raises(RecordError, match=AT_IT):
        writer_of(path)
    append(first, 50, 80)
    closed(first, 80)
    with first.record() as record:
        assert check(record, 80) == 80
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]
    closed(writer_of(path), 0)  # once it has ended, it may be written again


@pytest.mark.parametrize("gone", ["removed", "replaced"])
def test_a_record_that_is_gone_is_not_said_to_be_written(tmp_path: Path, gone: str) -> None:
    path = tmp_path / "r.h5"
    out = writer_of(path)
    append(out, 0, 10)
    if gone == "removed":
        path.unlink()
    else:
        make_record(tmp_path / "other.h5", seconds=0.1).close()
        os.replace(tmp_path / "other.h5", path)
    with pytest.raises(RecordError, match=facts("r.h5: ", "cannot be written", "no longer there")):
        closed(out, 10)
    assert path.exists() == (gone == "replaced")
    if path.exists():
        with Record.load(path) as record:
            assert record.name == "made up"
    assert not list(tmp_path.glob(".*"))


def test_what_is_there_stays_where_a_record_cannot_begin(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_text("mine")
    with pytest.raises(RecordError, match=facts("r.h5: ", "exists")):
        writer_of(path, overwrite=False)
    scene = make_scene()
    scene.stop_station = "far"
    with pytest.raises(ValueError, match="far"):
        RecordWriter(path, scene, "name: x", name="x")
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"r.h5": "mine"}
