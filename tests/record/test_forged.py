"""Damaged and forged records are refused: one line with file, table, row, given and allowed."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from physim.errors import RecordError
from physim.record import Record
from tests.cli.commands import SMALL
from tests.helpers import check_error, facts, inside, said
from tests.helpers.records import make_record

DATASETS, LITTLE = inside("physim.record", "DATASETS", "LITTLE")

Change = Callable[[h5py.File], object]
NAN, INF = float("nan"), float("inf")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, world_text=SMALL).close()
    return path


def altered(made: Path, folder: Path, change: Change) -> Path:
    """Copy of a record with something changed."""
    copy = Path(shutil.copy(made, folder / "altered.h5"))
    with h5py.File(copy, "r+") as file:
        change(file)
    return copy


def read_all(path: Path) -> None:
    """Read what is checked at the start, and what is checked when it is asked for."""
    with Record.load(path) as record:
        for name in ("pose", "clearance", "boundary_clearance", "shapes", "walls", "paths",
                     "reference", "accessible", "safe", "world_settings"):  # fmt: skip
            getattr(record, name)


def refused(path: Path, *told: str) -> None:
    """Reading ends in one line that names the file and says these facts."""
    with pytest.raises(RecordError, match=facts(*told)) as caught:
        read_all(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def put(path: str, row: Any, value: Any, column: str = "") -> Change:
    """Write one value of a dataset; ``row`` is an index into it."""

    def change(file: h5py.File) -> None:
        rows = np.array(file[path][()])
        (rows[column] if column else rows)[row] = value
        file[path][...] = rows

    return change


def anew(path: str, rows: Any, **how: Any) -> Change:
    """Put another dataset in the place of one."""

    def change(file: h5py.File) -> None:
        del file[path]
        file.create_dataset(path, data=rows, **how)

    return change


def longer(path: str, more: int) -> Change:
    return lambda file: file[path].resize(len(file[path]) + more, axis=0)


def turned(file: h5py.File) -> None:
    file["/steps/pose"][5, 1, 2] += 3.2


def packed(group: str, points: Any, start: Any) -> list[Change]:
    """Other points, and where each run of them starts."""
    return [
        anew(f"{group}/points", np.array(points, float)),
        anew(f"{group}/start", np.array(start)),
    ]


def twice(path: str, *columns: str) -> Change:
    def change(file: h5py.File) -> None:
        rows = file[path][()]
        for column in ("step", *columns):
            rows[column][1] = rows[column][0]
        file[path][...] = rows

    return change


def squeezed(rows: int, given: Callable[[bytes], bytes] | None = None, **how: Any) -> Change:
    """Poses in packed chunks of so many rows, the first of them changed as it lies there."""

    def change(file: h5py.File) -> None:
        values = file["/steps/pose"][()]
        anew("/steps/pose", values, chunks=(rows, 3, 3), maxshape=(None, 3, 3), **how)(file)
        if given:
            chunk = given(values[:rows].tobytes())
            file["/steps/pose"].id.write_direct_chunk((0, 0, 0), chunk)

    return change


def steps_without_end(file: h5py.File) -> None:
    file["/steps/step"][...] = np.arange(401) * 1_000_000
    for name in ("record_every", "steps_run", "steps_planned"):
        file.attrs[name] = 1_000_000 if name == "record_every" else 400_000_000


ALIASES = "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 10))


FORGED: list[tuple[str, Change | list[Change], tuple[str, ...]]] = [
    # numbers of steps, robots, bodies, modes and rules that there are not
    *(
        (path, put(path, row, value, column), (f"row {row}", column, str(value), allowed))
        for path, row, column, value, allowed in [
            ("/updates", 2, "step", 10**8, "0 to 400"),
            ("/updates", 2, "robot", 77, "0 to 2"),
            ("/updates", 2, "robot", -3, "0 to 2"),
            ("/updates", 2, "mode", 77, "-1 to 3"),
            ("/updates", 2, "rule", 2, "-1 to 1"),
            ("/updates", 2, "considered", 55, "0 to 2"),
            ("/updates", 2, "next_step", -5, "to"),
            ("/considered", 2, "count", 3, "0 to 2"),
            ("/considered_others", 2, "", 3, "0 to 2"),
            ("/contacts", 2, "step", 401, "0 to 400"),
            ("/contacts", 2, "a", 3, "0 to 2"),
            ("/contacts", 2, "b", 0, "1 to 4"),
            ("/contacts", 2, "phase", 9, "0 to 2"),
            ("/contacts", 2, "kind", 9, "0 to 1"),
            ("/false_contacts", 0, "b", 5, "1 to 4"),
            ("/extremes", 2, "clearance_other", 3, "-1 to 2"),
            ("/extremes", 2, "boundary_step", 401, "-1 to 400"),
            ("/robots/arrived", 1, "", 401, "-1 to 400"),
            ("/walls/part_start", 1, "", 10**6, "0 to"),
            ("/walls/body_start", 1, "", 50, "0 to"),
            ("/paths/start", 1, "", 150, "0 to"),
        ]
    ),
    # numbers that no run has
    ("/updates", put("/updates", 4, NAN, "applied_v"), ("row 4", "applied_v", "nan", "finite")),
    ("/updates", put("/updates", 0, 1e155, "nominal_v"), ("row 0", "nominal_v", "10000")),
    ("/contacts", put("/contacts", 0, 1e9, "x"), ("row 0", "x", "1e+08")),
    ("/contacts", put("/contacts", 0, 1.5, "nx"), ("row 0", "nx", "1.5")),
    ("/contacts", put("/contacts", 0, -1e300, "depth"), ("row 0", "depth", "3e+08")),
    ("/steps/pose", put("/steps/pose", (5, 1, 0), 2e8), ("row 5", "x", "robot 1", "1e+08")),
    ("/steps/pose", put("/steps/pose", (5, 1, 1), -INF), ("row 5", "y", "robot 1", "-inf")),
    ("/steps/pose", put("/steps/pose", (5, 1, 2), NAN), ("row 5", "heading", "robot 1", "nan")),
    ("/steps/pose", turned, ("row 5", "robot 1", "rad", "3.142")),
    ("/steps/clearance", put("/steps/clearance", (5, 1), NAN), ("row 5", "robot 1", "nan")),
    ("/steps/boundary_clearance", put("/steps/boundary_clearance", (5, 1), 1.7e308), ("row 5",)),
    ("/extremes", put("/extremes", 1, -1.7e308, "clearance"), ("clearance", "-1.7e+308")),
    ("/extremes", put("/extremes", 1, -1, "clearance_step"), ("-1", "both or neither")),
    ("/extremes_farthest", put("/extremes_farthest", (), -1, "a"), ("-1", "both or neither")),
    ("/robots/lead", put("/robots/lead", 1, NAN), ("row 1", "nan", "finite")),
    ("/robots/stop_station", put("/robots/stop_station", 1, INF), ("row 1", "inf", "finite")),
    # bodies, declarations
    ("/bodies/id", put("/bodies/id", 2, 0), ("row 2", "2")),
    ("/bodies/kind", put("/bodies/kind", 0, "obstacle"), ("robot",)),
    ("/bodies/kind", put("/bodies/kind", -1, "wall"), ("boundary or obstacle",)),
    ("/modes", put("/modes/colour", 0, b"red"), ("colour", "'red'")),
    ("/modes", put("/modes/name", 0, b"<script>"), ("name", "'<script>'", "letters")),
    ("/modes/danger", put("/modes/danger", 1, 3), ("row 1", "3")),
    ("/rules", put("/rules/words", 0, b"\x1b[2J"), ("words", "plain text")),
    ("/columns", put("/columns/unit", 0, b"km"), ("unit", "'km'")),
    # rows that contradict each other
    ("/updates", twice("/updates", "robot"), ("row 1", "robot", "once")),
    ("/considered", twice("/considered", "robot"), ("row 1", "robot", "once")),
    ("/contacts", twice("/contacts", "a", "b", "kind"), ("row 1", "a 0, b 1", "once")),
    ("/contacts", put("/contacts", 0, 200, "step"), ("row 1", "step 200", "order")),
    ("/steps/step", put("/steps/step", slice(None), np.arange(401)[::-1]), ("row 1", "increase")),
    ("/considered_others", longer("/considered_others", 1), ("rows", "/considered")),
    ("/considered_others", longer("/considered_others", -1), ("rows", "/considered")),
    ("/considered_others", put("/considered_others", 2, 0), ("row 2", "robot 2", "once")),
    # shapes without extent
    ("/paths/start", packed("/paths", [[0, 0], [1, 0], [2, 0]], [0, 1, 2, 3]), ("1 points",)),
    ("/paths/start", packed("/paths", [[1, 1]] * 6, [0, 2, 4, 6]), ("length 0",)),
    ("/reference/start", packed("/reference", [[1, 1]], [0, 1]), ("1 points",)),
    ("/areas/safe/start", packed("/areas/safe", [[0, 0], [1, 0]], [0, 2]), ("2 points",)),
    ("/footprints", put("/footprints/vertices", slice(None), 0.0), ("row 0", "without area")),
    ("/walls/part_start", put("/bodies/kind", -1, "obstacle"), ("2 corners", "3")),
    # attributes
    ("version", lambda f: f.attrs.create("version", "5.0"), ("record version", "5.0", "4")),
    ("version", lambda f: f.attrs.create("version", 9), ("record version", "9", "4")),
    ("attribute dt", lambda f: f.attrs.pop("dt"), ("missing",)),
    ("attribute dt", lambda f: f.attrs.create("dt", -1.0), ("-1.0",)),
    ("attribute dt", lambda f: f.attrs.create("dt", "x"), ()),
    ("attribute given", lambda f: f.attrs.create("given", ["[]"] * 5), ("many values",)),
    ("steps", steps_without_end, ("400000000 steps", "at most 100000000")),
    ("nested deeper", lambda f: f.attrs.create("world", "a: " + "[" * 100_000), ()),
    ("the world inside cannot be read", lambda f: f.attrs.create("world", ALIASES), ()),
    # rows too few, and chunks that are not what they say
    *(
        (path, lambda f, p=path: anew(p, f[p][:-1], dtype=f[p].dtype)(f), ("robots",))
        for path in ("/robots/lead", "/robots/arrived", "/extremes", "/bodies/name")
    ),
    ("/steps/pose", squeezed(32, lambda chunk: chunk[:100], shuffle=True), ("damaged",)),
    ("/steps/pose", squeezed(LITTLE // 72 + 1, compression="gzip"), ("chunks", "damaged")),
]  # fmt: skip


@pytest.mark.parametrize(
    ("place", "changes", "said"), FORGED, ids=[f"{place}: {said}" for place, _, said in FORGED]
)
def test_what_no_run_writes_is_refused(
    made: Path, tmp_path: Path, place: str, changes: Change | list[Change], said: tuple[str, ...]
) -> None:
    def change(file: h5py.File) -> None:
        for one in changes if isinstance(changes, list) else [changes]:
            one(file)

    refused(altered(made, tmp_path, change), place, *filter(None, said))


@pytest.mark.parametrize("command", ["summary", "plot", "video", "validate"])
@pytest.mark.parametrize(
    ("change", "facts"),
    [
        (put("/updates", 2, 77, "robot"), ("/updates", "row 2", "robot", "77", "0 to 2")),
        (put("/steps/pose", (70, 1, 0), NAN), ("/steps/pose", "row 70", "robot 1", "nan")),
    ],
)
def test_every_command_says_so_in_one_line(
    made: Path, tmp_path: Path, command: str, change: Change, facts: tuple[str, ...]
) -> None:
    bad = altered(made, tmp_path, change)
    done = said(command, str(bad))
    assert done.code == 2
    lines = [line for line in done.err.splitlines(True) if not line.startswith("compiling ")]
    check_error("".join(lines), f"{bad}:", *facts)


@pytest.mark.parametrize("path", DATASETS)
def test_a_dataset_is_there_and_of_its_kind(made: Path, tmp_path: Path, path: str) -> None:
    refused(altered(made, tmp_path, lambda file: file.pop(path)), f"{path} is missing")
    for rows in (np.zeros((3, 5)), np.zeros(3, "V16"), h5py.Empty("f8")):
        refused(altered(made, tmp_path, anew(path, rows)), path)


@pytest.mark.parametrize("cuts", [8, pytest.param(40, marks=pytest.mark.deep)])
def test_a_copy_that_breaks_off_is_refused(made: Path, tmp_path: Path, cuts: int) -> None:
    data = made.read_bytes()
    for size in np.linspace(9, len(data) - 1, cuts).astype(int):
        (tmp_path / "short.h5").write_bytes(data[:size])
        with pytest.raises(RecordError, match=r"^[^\n]*short.h5[^\n]*(truncated|damaged)"):
            Record.load(tmp_path / "short.h5")


def test_a_text_that_is_written_over_is_refused(made: Path, tmp_path: Path) -> None:
    """The library believed a reference to it: 4 GB of memory, or the end of the process."""
    raw = bytearray(made.read_bytes())
    at = raw.find(b"GCOL")
    raw[at + 16 : at + 80] = b"x" * 64
    (tmp_path / "texts.h5").write_bytes(raw)
    refused(tmp_path / "texts.h5", "damaged")


def test_what_is_no_record_is_refused(made: Path, tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("name: world\n")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    for path, told in [
        (tmp_path / "none.h5", "no such file"),
        (tmp_path, "is a folder"),
        (made.parent, "record.h5"),
        (tmp_path / "text.h5", "not an HDF5 file"),
        (tmp_path / "other.h5", "not a record of physim"),
    ]:
        refused(path, told)


@pytest.mark.parametrize("change", ["version", "dt", "/updates", "/footprints/body_start"])
def test_an_open_file_is_checked_too(made: Path, tmp_path: Path, change: str) -> None:
    copy = altered(made, tmp_path, lambda f: (f if change[0] == "/" else f.attrs).pop(change))
    with h5py.File(copy) as file, pytest.raises(RecordError, match=facts(f"{copy}:", change)):
        Record(file)
    with h5py.File(made) as file:
        assert Record(file).names == ("r1", "r2", "r3")


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"compression": "gzip"},
        {"shuffle": True, "compression": "gzip", "compression_opts": 9, "fletcher32": True},
    ],
)
def test_a_record_that_was_packed_is_read_as_it_was(
    made: Path, tmp_path: Path, how: dict[str, Any]
) -> None:
    path = altered(made, tmp_path, squeezed(32, **how))
    with Record.load(path) as record, Record.load(made) as plain:
        assert record.digest() == plain.digest()


def test_what_a_later_version_adds_is_passed_over(made: Path, tmp_path: Path) -> None:
    Record.load(altered(made, tmp_path, lambda f: f.create_dataset("new/x", data=[1]))).close()


def test_considered_robots_of_a_decision_need_no_order(made: Path, tmp_path: Path) -> None:
    swapped = altered(made, tmp_path, put("/considered_others", [1, 2], [1, 0]))
    with Record.load(swapped) as record:
        assert record.considered["other"][:3].tolist() == [0, 1, 0]
