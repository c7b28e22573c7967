"""Rows on disk: whole or not there, each once, in few files, readable by others."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from physim.campaigns import Folder, Row, shard
from physim.campaigns import rows as module
from physim.errors import Notice, PhysimError
from tests.campaigns.samples import read, rows_in, specs
from tests.campaigns.tables import many
from tests.helpers import facts, inside

COLUMNS, rows_of, schema = inside("physim.campaigns", "COLUMNS", "rows_of", "schema")
row_without_run, write_results = inside("physim.campaigns", "row_without_run", "write_results")
Shards, FAILED, row_of = inside("physim.campaigns", "Shards", "FAILED", "row_of")


def row(number: int, ended: str = "finished", **more: object) -> Row:
    values = {"world": "w", "seed": number, "physim": "1", "engine": "e", **more}
    return Row(run=f"{number:020x}", ended=ended, **values)  # type: ignore[arg-type]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rows").mkdir()
    return tmp_path


def test_rows_come_back_as_they_were(folder: Path) -> None:
    given = [row(1, contacts=1, first_contact=0.1 + 0.2, reason="ä\n;"), row(2, "error")]
    Shards(folder).write(given)
    assert rows_in(folder) == given


def test_many_rows_are_few_files_and_each_is_there_once(folder: Path) -> None:
    shards = Shards(folder)
    count = 3 * module.TOGETHER + 5
    for number in range(count):
        shards.write([row(number)])
    assert len(list((folder / "rows").iterdir())) == 3 + 5
    assert {one.seed for one in rows_in(folder)} == set(range(count))
    shards.put_together()
    assert len(list((folder / "rows").iterdir())) == 1
    assert len(rows_in(folder)) == count


def test_shards_that_are_there_twice_count_once(folder: Path) -> None:
    Shards(folder).write([row(1), row(2)])
    Shards(folder).write([row(2), row(3)])  # as after a kill between merging and removing
    assert sorted(one.seed for one in rows_in(folder)) == [1, 2, 3]
    assert read(folder).num_rows == 3


def test_what_came_to_its_end_stands_whatever_was_written_later(folder: Path) -> None:
    Shards(folder).write([row(1, "killed"), row(2)])
    Shards(folder).write([row(1), row(2, "timeout")])
    assert [one.ended for one in rows_in(folder)] == ["finished", "finished"]
    Shards(folder).put_together()
    assert len(Shards(folder).files()) == 1
    assert [one.ended for one in rows_in(folder)] == ["finished", "finished"]


def test_a_shard_that_is_gone_is_looked_for_in_a_larger_one(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = Shards(folder)
    for number in range(5):
        writer.write([row(number)])
    true, merged = module.read_shard, []

    def read_while_another_merges(file: Path) -> Any:
        if not merged:
            merged.append(True)
            Shards(folder).put_together()
        return true(file)

    monkeypatch.setattr(module, "read_shard", read_while_another_merges)
    assert sorted(one.seed for one in rows_in(folder)) == list(range(5))


def test_of_what_could_not_be_written_nothing_is_left(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shards = Shards(folder)
    shards.write([row(1)])

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(module.os, "fsync", full)
    with pytest.raises(PhysimError, match="No space left"):
        shards.write([row(2)])
    assert [one.seed for one in rows_in(folder)] == [1]
    assert len(list((folder / "rows").iterdir())) == 1


def test_results_open_elsewhere(folder: Path) -> None:
    one, two = specs(3)[1:]
    Folder(folder).open([one])
    touched = replace(row_without_run(one, "finished", ""), contacts=3, deepest_contact=0.01)
    Shards(folder).write([row_without_run(two, "error", "x"), touched])
    write_results(folder)
    table = parquet.read_table(folder / "results.parquet")
    assert table.schema.remove_metadata() == schema()
    assert tuple(table.column_names) == COLUMNS
    assert table.schema.field("seed").type == pa.int64()
    frame = pd.read_parquet(folder / "results.parquet")
    assert frame["seed"].tolist() == [1, 2]
    assert frame["contacts"].isna().tolist() == [False, True]
    assert frame["deepest_contact"][0] == 0.01
    assert not list(folder.glob(".*"))


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
    for once in (lambda: read(folder), lambda: list(Shards(folder).tables())):
        with pytest.raises(PhysimError, match=said):
            once()  # type: ignore[no-untyped-call]


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


def test_a_last_line_that_was_cut_off_is_told_and_mended(folder: Path) -> None:
    shards = Shards(folder)
    shards.write([row(1), row(2), row(3)])
    (file,) = shards.files()
    file.write_bytes(file.read_bytes()[:-30])
    for once in (lambda: rows_of(next(shards.tables())), lambda: rows_in(folder)):
        with pytest.warns(Notice, match=facts(f"{file.name}:3:")):
            assert len(once()) == 2  # type: ignore[no-untyped-call]
    shards.put_together()
    assert [one.seed for one in rows_in(folder)] == [1, 2]
    assert read(folder).num_rows == 2


def test_a_last_line_without_its_end_is_a_row(folder: Path) -> None:
    shards = Shards(folder)
    shards.write([row(1), row(2)])
    (file,) = shards.files()
    file.write_bytes(file.read_bytes()[:-1])
    assert read(folder).num_rows == 2
    Shards(folder).write([row(3)])
    shards.put_together()
    assert [one.seed for one in rows_in(folder)] == [1, 2, 3]


GOOD = json.dumps(asdict(row(7))).encode()
DAMAGED = [
    b"{cut", b"\x00\x00\x00", b"", GOOD + GOOD, GOOD + b" " + GOOD, GOOD + b"\r" + GOOD,
    GOOD + b",", b'{"later":{"x": 1}\n' + GOOD, GOOD.replace(b'"w"', b'"\xff"'),
    GOOD.replace(b"{", b'{"later": "\xff", '), b"[" * 100_000,
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGED, ids=range(len(DAMAGED)))
@pytest.mark.parametrize(("before", "at_once"), [(0, 1 << 20), (1, 1 << 20), (5, 1000)])
def test_any_other_damage_is_refused(
    folder: Path, damage: bytes, before: int, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As two rows on one line, or what is no text, also in a column of a later version; in the
    first part of a shard and in later ones."""
    monkeypatch.setattr(shard, "AT_ONCE", at_once)
    Shards(folder).write([row(1)])
    (file,) = Shards(folder).files()
    lines = [file.read_bytes()] * before + [damage + b"\n", file.read_bytes()]
    file.write_bytes(b"".join(lines))
    with pytest.raises(PhysimError, match=facts(f"{file.name}:{before + 1}:")):
        read(folder)
    shards = Shards(folder)
    shards.write([row(2)])
    with pytest.raises(PhysimError, match=facts(f"{file.name}:{before + 1}:")):
        shards.put_together()
    assert file.exists()


def some_rows(count: int) -> list[Row]:
    found = many(count, cells=6).to_pylist()
    return [Row(**{key: value for key, value in one.items() if key in COLUMNS}) for one in found]


def one_by_one(folder: Path) -> list[Row]:
    """All rows, each run once: the last that did not fail, else the last."""
    found: dict[str, Row] = {}
    for file in Shards(folder).files():
        for row in map(row_of, map(json.loads, file.read_text().splitlines())):
            if not row.failed or row.run not in found or found[row.run].failed:
                found[row.run] = row
    return sorted(
        found.values(),
        key=lambda row: (row.world, row.settings, row.controller, row.seed, row.run),
    )


def test_in_bulk_as_one_by_one(tmp_path: Path) -> None:
    given = some_rows(500)
    shards = Shards(tmp_path)
    shards.folder.mkdir()
    for k in range(0, 500, 60):
        shards.write(given[k : k + 60])
    again = [replace(one, ended="finished", reason="") for one in given if one.failed][:3]
    worse = [replace(one, ended="killed", time_to_finish=None) for one in given if not one.failed][
        :5
    ]
    later = [replace(one, formation_error_peak=9.0) for one in given if not one.failed][5:9]
    shards.write([*again, *worse, *later])
    table = read(tmp_path)
    expected = one_by_one(tmp_path)
    assert table.to_pylist() == [asdict(one) for one in expected]
    assert len(expected) == 500
    assert sum(one.ended in FAILED for one in expected) == sum(one.failed for one in given) - 3


def test_rows_with_fewer_or_more_columns_and_odd_texts(tmp_path: Path) -> None:
    shards = Shards(tmp_path)
    shards.folder.mkdir()
    small = {"run": "a" * 20, "world": "yard", "seed": 1, "physim": "0", "engine": "e",
             "ended": "finished", "seconds": 20, "later": [1, 2]}  # fmt: skip
    (shards.folder / "1-2-x-1.jsonl").write_text(json.dumps(small) + "\n", encoding="utf-8")
    odd = {**small, "run": "b" * 20, "seed": 2, "reason": "\udc80 \x00"}
    (shards.folder / "2-2-x-2.jsonl").write_text(json.dumps(odd) + "\n", encoding="utf-8")
    (shards.folder / "3-2-x-3.jsonl").touch()
    one, other = read(tmp_path).to_pylist()
    assert (one["seconds"], one["reason"], one["contacts"]) == (20.0, "", None)
    assert other["reason"] == "? \x00"
