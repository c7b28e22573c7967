"""Rows on disk: whole or not there, each once, readable by others."""

from __future__ import annotations

import csv
import errno
import json
import os
from dataclasses import asdict, replace
from pathlib import Path

import pandas as pd
import pytest

from physim.campaigns import Folder, Row
from physim.errors import PhysimError
from tests.campaigns.samples import rows_in, specs
from tests.campaigns.tables import many
from tests.helpers import facts, inside

COLUMNS, Rows, write_parquet = inside("physim.campaigns", "COLUMNS", "Rows", "write_parquet")
row_without_run, write_results = inside("physim.campaigns", "row_without_run", "write_results")


def row(number: int, ended: str = "finished", **more: object) -> Row:
    values = {"world": "w", "seed": number, "physim": "1", "engine": "e", **more}
    return Row(run=f"{number:020x}", ended=ended, **values)  # type: ignore[arg-type]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rows").mkdir()
    return tmp_path


def test_rows_come_back_as_they_were(folder: Path) -> None:
    given = [row(1, contacts=1, first_contact=0.1 + 0.2, reason="ä\n;"), row(2, "error")]
    Rows(folder).write(given)
    assert rows_in(folder) == given


def test_each_writer_appends_to_one_file_and_each_run_counts_once(folder: Path) -> None:
    one, other = Rows(folder), Rows(folder)
    for number in range(10):
        one.write([row(number)])
        other.write([row(number + 5)])
    assert len(one.files()) == 2
    assert sorted(each.seed for each in rows_in(folder)) == list(range(15))


def test_what_came_to_its_end_stands_whatever_was_written_later(folder: Path) -> None:
    Rows(folder).write([row(1, "killed"), row(2)])
    Rows(folder).write([row(1), row(2, "timeout")])
    assert [one.ended for one in rows_in(folder)] == ["finished", "finished"]


def test_of_what_could_not_be_written_nothing_is_left(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = Rows(folder)
    rows.write([row(1)])

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(PhysimError, match="No space left"):
            rows.write([row(2)])
    assert [one.seed for one in rows_in(folder)] == [1]
    rows.write([row(3)])
    assert [one.seed for one in rows_in(folder)] == [1, 3]


def test_results_open_elsewhere(folder: Path) -> None:
    one, two = specs(3)[1:]
    Folder(folder).open([one])
    touched = replace(row_without_run(one, "finished", ""), contacts=3, deepest_contact=0.1 + 0.2)
    broke = replace(row_without_run(two, "error", 'x, "y"\nä'), metrics={"a": 1e-320})
    Rows(folder).write([broke, touched])
    (folder / "results.parquet").touch()  # of a sweep with fewer rows
    write_results(folder)
    frame = pd.read_csv(folder / "results.csv")
    assert tuple(frame.columns) == (*COLUMNS, "metric_a")
    assert frame["seed"].tolist() == [1, 2]
    assert frame["contacts"].isna().tolist() == [False, True]
    assert frame["reason"][1] == broke.reason
    with open(folder / "results.csv", encoding="utf-8", newline="") as file:
        first, second = csv.DictReader(file)
    assert float(first["deepest_contact"]) == 0.1 + 0.2
    assert float(second["metric_a"]) == 1e-320
    assert {one.name for one in folder.iterdir() if one.is_file()} == {
        "campaign.json", "results.csv",
    }  # fmt: skip
    write_parquet([touched, broke], folder / "results.parquet")
    frame = pd.read_parquet(folder / "results.parquet", dtype_backend="numpy_nullable")
    assert tuple(frame.columns) == (*COLUMNS, "metric_a")
    assert [frame[name].dtype for name in ("seed", "grazes", "impulse", "stood")] == [
        "Int64", "Int64", "Float64", "string",
    ]  # fmt: skip
    assert frame["deepest_contact"][0] == 0.1 + 0.2


FAULTS: list[tuple[str, object]] = [
    ("run", None), ("run", 3), ("run", "../../../x"), ("run", "0" * 19), ("world", None),
    ("world", 1), ("seed", "x"), ("seed", -1), ("seed", 1.5), ("seed", True), ("seed", 2**63),
    ("ended", "won"), ("ended", None), ("contacts", -1), ("grazes", "1"), ("robots", 2.5),
    ("shortest_distance", float("nan")), ("shortest_distance", float("-inf")),
    ("deviation_peak", float("inf")), ("time_to_finish", -0.5), ("danger_share", 1.5),
    ("seconds", "1"),
    ("shortest_distance", 1e13), ("shortest_distance", -1.7e308), ("time_to_finish", 1e300),
    ("reason", 5), ("reason", ["x"]), ("record", "../record.h5"), ("world_hash", "../world"),
    ("digest", "no"), ("settings", {"a": 1}),
]  # fmt: skip


@pytest.mark.parametrize(("column", "value"), FAULTS)
def test_what_may_not_stand_in_a_column_is_told_with_its_line(
    folder: Path, column: str, value: object
) -> None:
    rows = [asdict(row(k, contacts=0, grazes=0)) for k in range(3)]
    rows[1][column] = value
    text = "".join(json.dumps(one) + "\n" for one in rows)
    (folder / "rows" / "5-2-x-1.jsonl").write_text(text)
    said = facts("5-2-x-1.jsonl:2:", f"{column}:")
    with pytest.raises(PhysimError, match=said):
        rows_in(folder)


def test_columns_of_earlier_rows_have_the_names_of_what_they_mean(folder: Path) -> None:
    """There, contacts were of robots alone and the shortest distance was to walls, too."""
    earlier = {"run": "1" * 20, "world": "w", "seed": 1, "physim": "1", "engine": "e",
               "ended": "finished", "contacts": 1, "wall_contacts": 2, "grazes": 0,
               "shortest_distance": -0.01, "shortest_distance_pair": "r1, left wall",
               "shortest_distance_time": 3.0, "deepest": 0.02, "updates": 7}  # fmt: skip
    (folder / "rows" / "5-2-x-1.jsonl").write_text(json.dumps(earlier) + "\n")
    (one,) = rows_in(folder)
    assert (one.contacts, one.contacts_between_robots, one.contacts_with_boundaries) == (3, 1, 2)
    assert (one.shortest_distance, one.shortest_boundary_distance) == (None, None)
    assert (one.least_distance, one.least_distance_pair, one.least_distance_time) == (
        -0.01, "r1, left wall", 3.0,
    )  # fmt: skip
    assert (one.deepest_contact, one.decisions) == (0.02, 7)
    assert not one.contact_free


def test_columns_that_have_the_names_of_metrics_now_are_read_by_their_earlier_names(
    folder: Path,
) -> None:
    earlier = {"run": "1" * 20, "world": "w", "seed": 1, "physim": "1", "engine": "e",
               "ended": "finished", "contacts": 0, "deepest": None, "formation_error": 0.1,
               "deviation": 0.2, "finish_time": 3, "updates": 4,
               "metrics": "a=1.0; b=-2e-07"}  # fmt: skip
    (folder / "rows" / "5-2-x-1.jsonl").write_text(json.dumps(earlier) + "\n")
    (one,) = rows_in(folder)
    assert (one.formation_error_peak, one.deviation_peak) == (0.1, 0.2)
    assert (one.time_to_finish, one.decisions) == (3.0, 4)
    assert one.metrics == {"a": 1.0, "b": -2e-07}


def test_a_last_line_that_was_cut_off_is_no_row(folder: Path) -> None:
    rows = Rows(folder)
    rows.write([row(1), row(2), row(3)])
    (file,) = rows.files()
    file.write_bytes(file.read_bytes()[:-30])
    assert [one.seed for one in rows_in(folder)] == [1, 2]
    Rows(folder).write([row(3)])
    assert [one.seed for one in rows_in(folder)] == [1, 2, 3]


GOOD = json.dumps(asdict(row(7))).encode()
DAMAGED = [
    b"{cut", b"\x00\x00\x00", b"", GOOD + GOOD, GOOD + b" " + GOOD, GOOD + b"\r" + GOOD,
    GOOD + b",", GOOD.replace(b'"w"', b'"\xff"'), b"[" * 100_000,
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGED, ids=range(len(DAMAGED)))
@pytest.mark.parametrize("before", [0, 5])
def test_any_other_damage_is_refused(folder: Path, damage: bytes, before: int) -> None:
    """As two rows on one line, or what is no text."""
    Rows(folder).write([row(1)])
    (file,) = Rows(folder).files()
    lines = [file.read_bytes()] * before + [damage + b"\n", file.read_bytes()]
    file.write_bytes(b"".join(lines))
    with pytest.raises(PhysimError, match=facts(f"{file.name}:{before + 1}:")):
        rows_in(folder)


def test_of_many_rows_each_run_counts_once(folder: Path) -> None:
    given, rows = many(500, cells=6), Rows(folder)
    rows.write(given)
    again = [replace(one, ended="finished", reason="") for one in given if one.failed][:3]
    worse = [replace(one, ended="killed", time_to_finish=None) for one in given if not one.failed]
    rows.write([*again, *worse])
    expected = {one.run: one for one in [*given, *again]}
    order = sorted(expected.values(), key=lambda one: (one.world, one.controller, one.seed))
    assert rows_in(folder) == order


def test_rows_with_fewer_or_more_columns(tmp_path: Path) -> None:
    rows = Rows(tmp_path)
    rows.folder.mkdir()
    small = {"run": "a" * 20, "world": "yard", "seed": 1, "physim": "0", "engine": "e",
             "ended": "finished", "seconds": 20, "later": [1, 2]}  # fmt: skip
    (rows.folder / "1-2-x-1.jsonl").write_text(json.dumps(small) + "\n", encoding="utf-8")
    (rows.folder / "3-2-x-3.jsonl").touch()
    (one,) = rows_in(tmp_path)
    assert (one.seconds, one.reason, one.contacts) == (20.0, "", None)
