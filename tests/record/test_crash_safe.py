"""A record is complete at every moment: every prefix of its writes, and real kills."""

from __future__ import annotations

import io
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
from physim.record import Record, RecordWriter, crash_safe, writer
from tests.helpers import inside
from tests.helpers.records import DECLARED, UPDATE, make_scene

CONSIDERING, OTHERS = inside("physim.record", "CONSIDERING", "OTHERS")

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
    np.testing.assert_array_equal(record.steps, step)
    np.testing.assert_array_equal(
        record.pose, np.broadcast_to(step[:, None, None] + 1.0, (k, 3, 3))
    )
    np.testing.assert_array_equal(record.clearance[:, 0], step + 1.0)
    np.testing.assert_array_equal(record.boundary_clearance[:, 2], step + 1.0)
    np.testing.assert_array_equal(record.updates["step"], step)
    np.testing.assert_array_equal(record.updates["station"], 0.5 * step)
    np.testing.assert_array_equal(record.contacts["x"], 0.25 * step)
    np.testing.assert_array_equal(record.considered["step"], np.repeat(step, 2))
    np.testing.assert_array_equal(record.considered["other"], np.tile([2, 1], k))
    np.testing.assert_array_equal(record.read(OTHERS, 1, 4), np.tile([2, 1], k)[1:4])
    return k


class Journal:
    """Notes what goes to the disk, in order, and where the file appears under its name."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.changes: list[tuple[int, bytes | None]] = []
        """(place, bytes) of a write, (length, None) of a change of length"""
        self.visible = 0
        pwrite, ftruncate, replace = os.pwrite, os.ftruncate, os.replace

        def note_write(fd: int, data: Any, address: int) -> int:
            self.changes.append((address, bytes(data)))
            return pwrite(fd, data, address)

        def note_length(fd: int, length: int) -> None:
            self.changes.append((length, None))
            ftruncate(fd, length)

        def note_name(old: Path, new: Path) -> None:
            self.visible = len(self.changes)
            replace(old, new)

        monkeypatch.setattr(crash_safe.os, "pwrite", note_write)
        monkeypatch.setattr(crash_safe.os, "ftruncate", note_length)
        monkeypatch.setattr(crash_safe.os, "replace", note_name)

    def images(self) -> Iterator[tuple[int, bytes]]:
        """File after each change, and between the pages of each; with the number of changes."""
        image = bytearray()
        for number, (place, data) in enumerate(self.changes):
            if data is None:
                del image[place:]
                image.extend(bytes(place - len(image)))
                yield number, bytes(image)
                continue
            end = place + len(data)
            image.extend(bytes(max(0, end - len(image))))
            at = place
            while at < end:
                stop = min(end, (at // crash_safe.PAGE + 1) * crash_safe.PAGE)
                image[at:stop] = data[at - place : stop - place]
                at = stop
                if number >= self.visible:
                    yield number, bytes(image)


def test_file_is_complete_after_every_single_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Chunks of few rows, so that the chunk trees split: the root at 64 chunks, then a leaf."""
    monkeypatch.setattr(writer, "CHUNK_BYTES", 128)
    journal = Journal(monkeypatch)
    out = RecordWriter(
        tmp_path / "r.h5", make_scene(), "name: x\n", name="x", declared=DECLARED, flush_every_s=1e9
    )
    marks = [(len(journal.changes), 0)]
    total = 0
    for rows in (1, 61, 1, 1, 1, 1, 48, *[1] * 14):
        append(out, total, total + rows)
        total += rows
        out.flush()
        marks.append((len(journal.changes), total))
    out.close("duration", steps_run=total - 1, rejected=0, wall_clock={"seconds": 1.0})

    checked = 0
    for number, image in journal.images():
        if number < journal.visible:
            continue
        least = max((rows for done, rows in marks if done <= number + 1), default=0)
        with h5py.File(io.BytesIO(image), "r") as file:
            assert check(Record(file), least) <= total
        checked += 1
    assert checked > 200
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


@pytest.mark.parametrize("seed", range(3))
def test_record_survives_a_kill(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "r.h5"
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(SCRIPT), str(path)],
        cwd=ROOT, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(random.Random(seed).uniform(0.0, 0.1))
    process.send_signal(signal.SIGKILL)
    told = [int(line) for line in process.stdout]
    process.wait()
    process.stdout.close()
    with h5py.File(path) as file:
        assert len(file["/steps/pose"]) >= max(told, default=700)
        assert file.attrs["ended"] == b"running"
    with Record.load(path) as record:
        assert check(record, max(told, default=700)) == record.steps_run + 1


def test_block_of_the_index_is_written_last_page_first(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[int, bytes]] = []

    def pwrite(fd: int, data: Any, address: int) -> int:
        part = bytes(data)[:3000]  # the system may write less than it is given
        calls.append((address, part))
        return len(part)

    monkeypatch.setattr(crash_safe.os, "pwrite", pwrite)
    block = bytes(range(256)) * 20
    crash_safe._write_last_page_first(0, block, 4000)
    assert [address for address, _ in calls] == [8192, 4096, 7096, 4000]
    assert b"".join(part for _, part in sorted(calls)) == block


def test_nothing_is_left_of_a_record_that_cannot_begin(tmp_path: Path) -> None:
    scene = make_scene()
    scene.bodies = (None,)
    with pytest.raises(AttributeError):
        RecordWriter(tmp_path / "r.h5", scene, "name: x", name="x")
    assert list(tmp_path.iterdir()) == []
