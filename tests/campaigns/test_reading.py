"""Rows read in bulk are those read one by one."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from physim.campaigns import Row, reading
from physim.errors import PhysimError
from tests.campaigns.samples import read
from tests.campaigns.tables import many
from tests.helpers import facts, inside

COLUMNS, FAILED, row_of = inside("physim.campaigns", "COLUMNS", "FAILED", "row_of")
Shards = inside("physim.campaigns", "Shards")


def rows(count: int) -> list[Row]:
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
    given = rows(500)
    shards = Shards(tmp_path)
    shards.folder.mkdir()
    for k in range(0, 500, 60):
        shards.write(given[k : k + 60])
    again = [replace(one, ended="finished", reason="") for one in given if one.failed][:3]
    worse = [replace(one, ended="killed", finish_time=None) for one in given if not one.failed][:5]
    later = [replace(one, deviation=9.0) for one in given if not one.failed][5:9]
    shards.write([*again, *worse, *later])
    table = read(tmp_path)
    expected = one_by_one(tmp_path)
    assert table.to_pylist() == [asdict(one) for one in expected]
    assert len(expected) == 500
    assert sum(one.ended in FAILED for one in expected) == sum(one.failed for one in given) - 3


def test_what_is_as_it_should_be_is_read_in_bulk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also with a column in which nothing stands, as that of formations in a world without."""
    shards = Shards(tmp_path)
    shards.folder.mkdir()
    shards.write(rows(50))
    monkeypatch.delattr("physim.campaigns.shard._one_by_one")
    assert read(tmp_path)["formation_error"].null_count == 50
    shards.put_together()
    assert len(list(shards.tables())) == 1


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


@pytest.mark.parametrize("text", ["{", "[]", "1", '{"run": 3}', '{"run": "a"}'])
def test_what_is_no_shard_is_refused(tmp_path: Path, text: str) -> None:
    shards = Shards(tmp_path)
    shards.folder.mkdir()
    good = rows(1)
    shards.write(good)
    (shards.folder / "9-2-x-1.jsonl").write_text(text + "\n", encoding="utf-8")
    with pytest.raises(PhysimError):
        read(tmp_path)


def test_a_folder_without_campaign_json_is_none(tmp_path: Path) -> None:
    with pytest.raises(PhysimError, match=facts(str(tmp_path), "no campaign", "physim sweep")):
        reading.read(tmp_path)
    Shards(tmp_path).folder.mkdir()
    assert read(tmp_path).num_rows == 0
    with pytest.raises(PhysimError, match="no campaign"):
        reading.read(tmp_path)
