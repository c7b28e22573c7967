"""A disk that is full: one error, and the record as the last flush left it."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from physim.errors import RecordError
from physim.record import Record, RecordWriter, crash_safe
from tests.helpers.records import DECLARED, make_scene
from tests.record.test_crash_safe import append, check


@pytest.mark.parametrize("room", [0, 3_000, 50_000, *range(60_000, 400_000, 17_000)])
def test_record_stays_as_the_last_flush_left_it(
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

    monkeypatch.setattr(crash_safe.os, "pwrite", write)
    monkeypatch.setattr(crash_safe.os, "ftruncate", lengthen)
    told = rf"^{path}: .*No space left on device$"
    flushed = -1
    with pytest.raises(RecordError, match=told):  # noqa: PT012
        out = RecordWriter(
            path, make_scene(), "name: x\n", name="x", declared=DECLARED, flush_every_s=1e9
        )
        flushed = 0
        for block in range(200):
            append(out, 50 * block, 50 * block + 50)
            out.flush()
            flushed = 50 * block + 50
    if flushed < 0:
        assert list(tmp_path.iterdir()) == []
        return
    for again in (out.flush, lambda: append(out, 0, 1), lambda: close(out)):
        with pytest.raises(RecordError, match=told):
            again()
    with Record.load(path) as record:
        assert check(record, flushed) == flushed
        assert record.ended == "running"
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]


def close(out: RecordWriter) -> None:
    out.close("duration", steps_run=1, rejected=0, wall_clock={})
