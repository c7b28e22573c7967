"""Values of a record that no run writes: one line that says file, table, row, given, allowed."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from physim.cli import main
from physim.errors import RecordError
from physim.record import Record
from tests.records import make_record


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, world_text="").close()
    return path


def tampered(made: Path, folder: Path, path: str, row: Any, value: Any, column: str = "") -> Path:
    """Copy with one value changed; ``row`` is an index into the dataset."""
    target = folder / "tampered.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        rows = file[path][()]
        (rows[column] if column else rows)[row] = value
        file[path][...] = rows
    return target


@pytest.mark.parametrize(
    ("path", "column", "value", "allowed"),
    [
        ("/updates", "step", 10**8, "0 to 400"),
        ("/updates", "step", -1, "0 to 400"),
        ("/updates", "robot", 77, "0 to 2"),
        ("/updates", "robot", -3, "0 to 2"),
        ("/updates", "mode", 77, "-1 to 3"),
        ("/updates", "rule", 2, "-1 to 1"),
        ("/updates", "considered", 55, "0 to 2"),
        ("/considered", "robot", 3, "0 to 2"),
        ("/considered", "other", -1, "0 to 2"),
        ("/considered", "step", 401, "0 to 400"),
        ("/updates", "next_step", -5, " to "),
        ("/contacts", "step", 401, "0 to 400"),
        ("/contacts", "a", 3, "0 to 2"),
        ("/contacts", "b", 99, "1 to 4"),
        ("/contacts", "b", 0, "1 to 4"),
        ("/contacts", "phase", 9, "0 to 2"),
        ("/contacts", "kind", 9, "0 to 1"),
        ("/false_contacts", "step", 401, "0 to 400"),
        ("/false_contacts", "a", -1, "0 to 2"),
        ("/false_contacts", "b", 5, "1 to 4"),
        ("/extremes", "clearance_other", 3, "-1 to 2"),
        ("/extremes", "boundary_step", 401, "-1 to 400"),
    ],
)
def test_values_out_of_range(
    made: Path, tmp_path: Path, path: str, column: str, value: int, allowed: str
) -> None:
    with Record.load(made) as record:
        row = min(2, len(record.read(path)) - 1)
    bad = tampered(made, tmp_path, path, row, value, column)
    with pytest.raises(RecordError) as raised:
        Record.load(bad)
    told = str(raised.value)
    assert told.startswith(f"{bad}: {path}, row {row}: {column} is {value}; allowed: ")
    assert allowed in told
    assert "\n" not in told


@pytest.mark.parametrize("command", ["summary", "plot", "video", "validate"])
@pytest.mark.parametrize(
    ("path", "row", "value", "column", "told"),
    [
        ("/updates", 2, 77, "robot", "/updates, row 2: robot is 77; allowed: 0 to 2"),
        ("/walls/part_start", 1, 10**6, "", "/walls/part_start, row 1: it is 1000000; allowed: 0"),
        ("/walls/body_start", 1, 50, "", "/walls/body_start, row 1: it is 50; allowed: 0"),
        ("/paths/start", 1, 150, "", "/paths/start, row 1: it is 150; allowed: 0"),
        ("/steps/pose", (70, 1, 0), np.nan, "", "/steps/pose, row 70: x of robot 1 is nan"),
        ("/steps/pose", (70, 1, 2), np.inf, "", "/steps/pose, row 70: heading of robot 1 is inf"),
    ],
)
def test_every_command_says_so_in_one_line(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str,
    path: str, row: Any, value: Any, column: str, told: str,
) -> None:  # fmt: skip
    bad = tampered(made, tmp_path, path, row, value, column)
    assert main([command, str(bad)]) == 2
    _, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if not line.startswith("compiling ")]
    assert len(lines) == 1
    assert lines[0].startswith(f"{bad}: {told}")


@pytest.mark.parametrize("value", [-2, 401])
def test_arrivals_outside_the_run(made: Path, tmp_path: Path, value: int) -> None:
    bad = tampered(made, tmp_path, "/robots/arrived", 1, value)
    told = f"/robots/arrived, row 1: it is {value}; allowed: -1 to 400"
    with pytest.raises(RecordError, match=told):
        Record.load(bad)


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        ("/modes/colour", b"red", "colour of \"safe\" is 'red'"),
        ("/modes/name", b"<script>", "name '<script>'; allowed are small letters"),
        ("/rules/words", b"\x1b[2J", 'words of "follow" must be a line of plain text'),
        ("/columns/unit", b"km", "\"target_x\" has the unit 'km'"),
    ],
)
def test_declarations_that_no_controller_makes(
    made: Path, tmp_path: Path, path: str, value: bytes, told: str
) -> None:
    with pytest.raises(RecordError, match=re.escape(told)):
        Record.load(tampered(made, tmp_path, path, 0, value))


def test_steps_must_increase(made: Path, tmp_path: Path) -> None:
    bad = tampered(made, tmp_path, "/steps/step", slice(None), np.arange(401)[::-1])
    with pytest.raises(RecordError, match="step 399 comes after step 400; steps must increase"):
        Record.load(bad)


def test_rows_out_of_order(made: Path, tmp_path: Path) -> None:
    """One contact is told later; all its other values are such as a run writes."""
    bad = tampered(made, tmp_path, "/false_contacts", slice(None), 5, "step")
    with h5py.File(bad, "r+") as file:
        rows = file["/false_contacts"]
        rows.resize(2, axis=0)
        rows[1] = rows[0]
        last = rows[1]
        last["step"] = 4
        rows[1] = last
    told = r"/false_contacts, row 1: step 4 comes after step 5; rows must be in the order"
    with pytest.raises(RecordError, match=told):
        Record.load(bad)


def test_a_command_that_is_no_number(made: Path, tmp_path: Path) -> None:
    bad = tampered(made, tmp_path, "/updates", 4, np.nan, "applied_v")
    with pytest.raises(RecordError, match="/updates, row 4: applied_v is nan; it must be finite"):
        Record.load(bad)


@pytest.mark.parametrize(
    ("path", "columns", "who"),
    [
        ("/updates", ("robot",), "robot"),
        ("/contacts", ("a", "b", "kind"), "a 0, b 1"),
    ],
)
def test_a_row_that_is_there_twice(
    made: Path, tmp_path: Path, path: str, columns: tuple[str, ...], who: str
) -> None:
    """Whatever else it says; the same bodies at another step are fine."""
    target = tmp_path / "twice.h5"
    shutil.copyfile(made, target)
    with h5py.File(target, "r+") as file:
        rows = file[path][()]
        for column in ("step", *columns):
            rows[column][1] = rows[column][0]
        file[path][...] = rows
    with pytest.raises(RecordError, match=rf"{path}, row 1: step .*{who}.* again"):
        Record.load(target)
