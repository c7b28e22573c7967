"""A record has one writer at a time; who comes second is refused, and what is gone is told."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from physim.errors import RecordError
from physim.record import Record, RecordWriter
from tests.helpers import facts, inside
from tests.helpers.records import DECLARED, make_record, make_scene
from tests.record.test_crash_safe import SCRIPT, append, check

WriteLock, check_unwritten = inside("physim.record", "WriteLock", "check_unwritten")

ROOT = Path(__file__).parents[2]
AT_IT = facts("r.h5: ", "another", "writing")


def writer(path: Path, *, overwrite: bool = True) -> RecordWriter:
    return RecordWriter(
        path, make_scene(), "name: x", name="x", declared=DECLARED, flush_every_s=1e9,
        overwrite=overwrite,
    )  # fmt: skip


def closed(out: RecordWriter, samples: int) -> None:
    out.close("duration", steps_run=samples - 1, rejected=0, wall_clock={})


def test_the_second_writer_is_refused_and_the_first_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    with make_record(seconds=0.1) as other:
        first = writer(path)
        append(first, 0, 50)
        for second in (lambda: writer(path), lambda: other.save(path)):
            with pytest.raises(RecordError, match=AT_IT):
                second()
    first.flush()
    with h5py.File(path) as file:  # whoever only reads may do so meanwhile
        assert len(file["/steps/step"]) == 50
    with pytest.raises(RecordError, match=AT_IT):
        writer(path)
    append(first, 50, 80)
    closed(first, 80)
    with first.record() as record:
        assert check(record, 80) == 80
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]
    closed(writer(path), 0)  # once it has ended, it may be written again


def test_records_side_by_side_have_nothing_to_do_with_each_other(tmp_path: Path) -> None:
    both = [writer(tmp_path / name) for name in ("a.h5", "b.h5")]
    for out in both:
        append(out, 0, 20)
        closed(out, 20)
        with out.record() as record:
            assert check(record, 20) == 20


def test_of_a_writer_that_was_killed_nothing_stands_in_the_way(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    with subprocess.Popen(
        [sys.executable, "-c", "from textwrap import dedent\nexec(dedent('''" + SCRIPT + "'''))",
         str(path)],
        cwd=ROOT, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        process.stdout.readline()
        with pytest.raises(RecordError, match=AT_IT):
            writer(path)
        process.send_signal(signal.SIGKILL)
    out = writer(path)
    append(out, 0, 30)
    closed(out, 30)
    with out.record() as record:
        assert check(record, 30) == 30
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]


@pytest.mark.parametrize("gone", ["removed", "replaced"])
def test_a_record_that_is_gone_is_not_said_to_be_written(tmp_path: Path, gone: str) -> None:
    path = tmp_path / "r.h5"
    out = writer(path)
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


def test_what_came_into_being_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_text("mine")
    with pytest.raises(RecordError, match=facts("r.h5: ", "exists")):
        writer(path, overwrite=False)
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"r.h5": "mine"}


def test_a_lock_that_is_taken_over_from_who_just_removed_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between opening the lock's file and locking it, its owner ends and removes it."""
    path, opened = tmp_path / "r.h5", os.open
    owner = WriteLock(path)

    def late(*arguments: object, **more: object) -> int:
        fd = opened(*arguments, **more)  # type: ignore[arg-type]
        owner.release()
        return fd

    monkeypatch.setattr("physim.record.lock.os.open", late)
    mine = WriteLock(path)
    monkeypatch.undo()
    with pytest.raises(RecordError, match=AT_IT):
        WriteLock(path)
    mine.release()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("there", [False, True])
def test_a_link_in_the_place_of_the_lock_is_not_followed(tmp_path: Path, there: bool) -> None:
    outside, path = tmp_path / "outside", tmp_path / "out/r.h5"
    path.parent.mkdir()
    if there:
        outside.write_text("mine")
    (path.parent / ".r.h5.lock").symlink_to(outside)
    for refused in (lambda: writer(path), lambda: check_unwritten(path)):
        with pytest.raises(RecordError, match=r"^[^\n]*/\.r\.h5\.lock: is a symbolic link[^\n]*$"):
            refused()
    assert outside.exists() == there
    assert [file.name for file in path.parent.iterdir()] == [".r.h5.lock"]
