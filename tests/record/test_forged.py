"""Damaged and forged records are refused: one line with file, table, row, given and allowed."""

from __future__ import annotations

import json
import os
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
from tests.helpers.records import make_record, told

AttributesModel, TABLE = inside("physim.record", "AttributesModel", "TABLE")

Change = Callable[[h5py.File], object]
NAN, INF = float("nan"), float("inf")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made") / "record.h5"
    make_record(path, seconds=4.0, world_text=SMALL, sensed=True).close()
    return path


def altered(made: Path, folder: Path, *changes: Change) -> Path:
    """Copy of a record with something changed."""
    copy = Path(shutil.copy(made, folder / "altered.h5"))
    with h5py.File(copy, "r+") as file:
        for change in changes:
            change(file)
    return copy


def read_all(path: Path) -> None:
    """Read what is checked at the start, and what is checked when it is asked for."""
    with Record.load(path) as record:
        for name in ("pose", "clearance", "boundary_clearance", "sensed", "world_settings"):
            getattr(record, name)


def refused(path: Path, *words: str) -> None:
    """Reading ends in one line that names the file and says these facts."""
    with pytest.raises(RecordError, match=facts(*words)) as caught:
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


def attribute(name: str, value: Any) -> Change:
    return lambda file: file.attrs.create(name, value)


def packed(group: str, points: Any, start: Any) -> Change:
    """Other points, and where each run of them starts."""

    def change(file: h5py.File) -> None:
        anew(f"{group}/points", np.array(points, float))(file)
        anew(f"{group}/start", np.array(start))(file)

    return change


def steps_without_end(file: h5py.File) -> None:
    file["/steps/step"][...] = np.arange(401) * 1_000_000
    for name in ("record_every", "steps_run", "steps_planned"):
        file.attrs[name] = 1_000_000 if name == "record_every" else 400_000_000


ALIASES = "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 10))


FORGED: list[tuple[str, Change, tuple[str, ...]]] = [
    # numbers of steps, robots, bodies, modes and rules that there are not; values that no run has
    *(
        (path, put(path, row, value, column), (f"row {row}", column, allowed))
        for path, row, column, value, allowed in [
            ("/updates", 2, "step", 10**8, "0 to 400"),
            ("/updates", 2, "robot", 77, "0 to 2"),
            ("/updates", 2, "robot", -3, "0 to 2"),
            ("/updates", 2, "mode", 77, "-1 to 3"),
            ("/updates", 2, "rule", 2, "-1 to 1"),
            ("/updates", 2, "considered", 55, "0 to 2"),
            ("/updates", 2, "next_step", -5, "1 to any"),
            ("/updates", 2, "applied_v", NAN, "1e+08"),
            ("/updates", 2, "nominal_v", 1e155, "1e+08"),
            ("/considered", 2, "count", 3, "0 to 2"),
            ("/considered_others", 2, "", 3, "0 to 2"),
            ("/contacts", 2, "step", 401, "0 to 400"),
            ("/contacts", 2, "a", 3, "0 to 2"),
            ("/contacts", 2, "b", 0, "1 to 4"),
            ("/contacts", 2, "phase", 9, "0 to 2"),
            ("/contacts", 2, "kind", 9, "0 to 1"),
            ("/contacts", 2, "x", 1e9, "1e+08"),
            ("/contacts", 2, "impulse", -1.0, "0 to"),
            ("/false_contacts", 0, "b", 5, "1 to 4"),
            ("/extremes", 2, "clearance_other", 3, "-1 to 2"),
            ("/extremes", 2, "boundary_step", 401, "-1 to 400"),
            ("/extremes", 1, "clearance", -1e300, "-1e+08"),
            ("/robots/arrived", 1, "", 401, "-1 to 400"),
            ("/robots/lead", 1, "", NAN, "1e+08"),
            ("/robots/stop_station", 1, "", INF, "1e+08"),
        ]
    ),
    ("/extremes_farthest", put("/extremes_farthest", (), 3, "a"), ("a is 3", "-1 to 2")),
    ("/steps/pose", put("/steps/pose", (5, 1, 0), 2e8), ("row 5", "[1, 0]", "1e+08")),
    ("/steps/pose", put("/steps/pose", (5, 1, 2), NAN), ("row 5", "[1, 2]", "nan")),
    ("/steps/clearance", put("/steps/clearance", (5, 1), NAN), ("row 5", "[1]", "nan")),
    ("/walls/vertices", put("/walls/vertices", (1, 0), NAN), ("row 1", "nan")),
    # rows that contradict each other
    ("/contacts", put("/contacts", 0, 200, "step"), ("row 1", "step 200", "order")),
    ("/steps/step", put("/steps/step", slice(3, 5), 2), ("row 3", "order")),
    ("/considered_others", longer("/considered_others", 1), ("rows", "/considered counts")),
    ("/considered_others", longer("/considered_others", -1), ("rows", "/considered counts")),
    ("truncated", attribute("steps_run", np.int64(2000)), ("401 samples", "2000 steps")),
    ("/walls/part_start", put("/walls/part_start", 1, 10**6), ("row 1", "at least 2")),
    ("/walls/body_start", put("/walls/body_start", -1, 50), ("not from 0 to",)),
    ("/paths/start", put("/paths/start", 1, 150), ("row 1",)),
    ("/paths/start", packed("/paths", [[0, 0], [1, 0], [2, 0]], [0, 1, 2, 3]), ("at least 2",)),
    ("/reference/start", packed("/reference", [[1, 1]], [0, 1]), ("1 rows", "at least 2")),
    ("/areas/safe/start", packed("/areas/safe", [[0, 0], [1, 0]], [0, 2]), ("2 rows",)),
    ("/paths/start", packed("/paths", [[0, 0], [1, 0]], [0, 2]), ("shape", "N = 3")),
    *(
        (path, lambda f, p=path: anew(p, f[p][:-1], dtype=f[p].dtype)(f), ("shape", "N = 3"))
        for path in ("/robots/lead", "/robots/arrived", "/extremes")
    ),
    # attributes
    ("record version", attribute("version", "4.0"), ("'4.0'", "before 29 November 2026", "'5'")),
    ("record version", attribute("version", 9), ("9", "'5'")),
    ("attribute units", attribute("units", "feet"), ("'feet'",)),
    ("attribute dt", attribute("dt", -1.0), ("-1.0", "0.000000001")),
    ("attribute dt", attribute("dt", "x"), ("'x'",)),
    ("attribute given", attribute("given", ["[]"] * 5), ()),
    ("attribute ended", attribute("ended", "crashed"), ("'crashed'", "interrupted")),
    ("attribute name", attribute("name", "a\x1b[2Jb\nc"), ("one line",)),
    ("attribute steps_planned", steps_without_end, ("400000000", "100000000")),
    ("attribute declared.modes.0.colour", told("declared", "modes", 0, colour="red"), ("'red'",)),
    ("declared.modes.0.name", told("declared", "modes", 0, name="<script>"), ("'<script>'",)),
    ("declared.rules.0.words", told("declared", "rules", 0, words="\x1b[2J"), ("plain text",)),
    ("attribute declared.columns", told("declared", "columns", 0, unit="km"), ("unit 'km'",)),
    ("attribute declared", attribute("declared", "[" * 100_000), ("JSON",)),
    ("attribute bodies", told("bodies", None, 2, id=0), ("row 2",)),
    ("attribute bodies", told("bodies", None, 0, kind="obstacle"), ("row 0", "robot")),
    ("attribute bodies", told("bodies", None, -1, kind="wall"), ("boundary or obstacle",)),
    ("attribute bodies", told("bodies", None, 1, name="a\nb"), ("row 1",)),
    ("the world inside cannot be read", attribute("world", "a: " + "[" * 100_000), ()),
    ("the world inside cannot be read", attribute("world", ALIASES), ()),
    # what would fill the memory, or read another file
    ("/contacts", longer("/contacts", 200_000_000), ("claims", "not in the file")),
    ("/steps/clearance", anew("/steps/clearance", None, shape=(401, 3), dtype="<f8",
                              external=[("other", 0, 9624)]), ("not in the file",)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("place", "change", "words"), FORGED, ids=[f"{place}: {said}" for place, _, said in FORGED]
)
def test_what_no_run_writes_is_refused(
    made: Path, tmp_path: Path, place: str, change: Change, words: tuple[str, ...]
) -> None:
    refused(altered(made, tmp_path, change), place, *filter(None, words))


def test_a_command_says_so_in_one_line(made: Path, tmp_path: Path) -> None:
    bad = altered(made, tmp_path, put("/steps/pose", (70, 1, 0), NAN))
    done = said("validate", str(bad))
    assert done.code == 2
    check_error(done.err, f"{bad}:", "/steps/pose", "row 70", "[1, 0]", "nan")


@pytest.mark.parametrize("path", [path for path in TABLE if path != "/steps/steering"])
def test_a_dataset_is_there_and_of_its_kind(made: Path, tmp_path: Path, path: str) -> None:
    refused(altered(made, tmp_path, lambda file: file.pop(path)), f"{path} is missing")
    for rows in (np.zeros((3, 5)), np.zeros(3, "V16"), h5py.Empty("f8")):
        refused(altered(made, tmp_path, anew(path, rows)), path)
    os.mkfifo(tmp_path / "pipe")  # whoever opens it waits for ever

    def linked(file: h5py.File) -> None:
        del file[path]
        file[path] = h5py.ExternalLink("pipe", "/x")

    refused(altered(made, tmp_path, linked), f"{path} is missing")


@pytest.mark.parametrize(
    "key", [one.alias or name for name, one in AttributesModel.model_fields.items()]
)
def test_an_attribute_is_there_and_of_its_kind(made: Path, tmp_path: Path, key: str) -> None:
    if key not in ("origin", "judged"):  # of a branch alone, and of a log
        refused(altered(made, tmp_path, lambda file: file.attrs.pop(key)), key, "missing")
    refused(altered(made, tmp_path, attribute(key, np.float64(NAN))), key, "nan")


@pytest.mark.parametrize("cuts", [8, pytest.param(40, marks=pytest.mark.deep)])
def test_a_copy_that_breaks_off_is_refused(made: Path, tmp_path: Path, cuts: int) -> None:
    data = made.read_bytes()
    for size in np.linspace(9, len(data) - 1, cuts).astype(int):
        (tmp_path / "short.h5").write_bytes(data[:size])
        with pytest.raises(RecordError, match=r"^[^\n]*short.h5[^\n]*(truncated|damaged)"):
            Record.load(tmp_path / "short.h5")


def test_what_is_no_record_is_refused(made: Path, tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("name: world\n")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    for path, words in [
        (tmp_path / "none.h5", "no such file"),
        (tmp_path, "record.h5: no such file"),
        (tmp_path / "text.h5", "not an HDF5 file"),
        (tmp_path / "other.h5", "not a record of physim"),
    ]:
        refused(path, words)


@pytest.mark.parametrize("change", ["version", "dt", "/updates", "/footprints/body_start"])
def test_an_open_file_is_checked_too(made: Path, tmp_path: Path, change: str) -> None:
    copy = altered(made, tmp_path, lambda f: (f if change[0] == "/" else f.attrs).pop(change))
    with h5py.File(copy) as file, pytest.raises(RecordError, match=facts(f"{copy}:", change)):
        Record(file)
    with h5py.File(made) as file:
        assert Record(file).names == ("r1", "r2", "r3")


def test_a_record_that_was_packed_or_has_more_is_read_as_it_was(made: Path, tmp_path: Path) -> None:
    def pack(file: h5py.File) -> None:
        file["new/x"] = json.dumps({})
        rows = file["/steps/pose"][()]
        anew("/steps/pose", rows, chunks=(32, 3, 3), compression="gzip", shuffle=True)(file)

    with Record.load(altered(made, tmp_path, pack)) as record, Record.load(made) as plain:
        assert record.digest() == plain.digest()
