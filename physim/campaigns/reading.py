"""All rows of a campaign as one table, read in bulk: shards are parsed by Arrow."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physim.campaigns.columns import COLUMNS, FAILED, Row, are_rows, schema
from physim.campaigns.rows import Shards
from physim.errors import PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

    from physim.campaigns.grid import Grid

DEEPEST = 100
"""Brackets in a line that Arrow is given; a row has two."""
ORDER = ("world", "settings", "controller", "seed", "run")


def read_table(folder: Path) -> pa.Table:
    """All rows, each run once, in the order of world, settings, controller and seed.

    Of a run that was done again the row that says more, as `Shards.read` has it. Raises PhysimError
    where there is no campaign or a shard cannot be read.
    """
    import pyarrow as pa

    shards = Shards(folder)
    if not shards.folder.is_dir():
        raise PhysimError(f"{folder}: holds no campaign (physim sweep WORLD -o {folder} makes one)")
    tables, known = [schema().empty_table()], set[str]()
    while new := [file for file in shards.files() if file.name not in known]:
        for file in new:
            known.add(file.name)
            try:
                tables.append(_shard(shards, file))
            except FileNotFoundError:
                continue  # its rows are in a larger one by now
    found = _each_once(pa.concat_tables(tables))
    return found.sort_by([(name, "ascending") for name in ORDER])


def read_part(folder: Path, grid: Grid) -> pa.Table:
    """The rows of the runs of a grid; the folder may have others. Raises PhysimError as `read`."""
    import pyarrow as pa

    table = read_table(folder)
    columns = (table[name].to_pylist() for name in (*ORDER[:4], "run"))
    mine = [grid.has((w, s, c), seed, run) for w, s, c, seed, run in zip(*columns, strict=True)]
    return table.filter(pa.array(mine, pa.bool_()))


def _shard(shards: Shards, file: Path) -> pa.Table:
    """Rows of a shard; those that Arrow does not take are read one by one, which says why.

    So are those that hold what may not stand in their columns, and a shard that is cut off.
    """
    import pyarrow as pa
    from pyarrow import compute, json

    if not shards.are_plain(file, _is_plain):  # the nested would break the whole process off
        return _one_by_one(shards.rows_of(file))
    data = file.read_bytes()
    options = json.ParseOptions(explicit_schema=schema(), unexpected_field_behavior="ignore")
    try:
        found = json.read_json(pa.BufferReader(data), parse_options=options).select(list(COLUMNS))
    except pa.ArrowInvalid:
        return _one_by_one(shards.rows_of(file))
    if not are_rows(found):
        return _one_by_one(shards.rows_of(file))
    texts = [k for k, one in enumerate(found.schema) if one.type == pa.string()]
    for k in texts:  # columns that an earlier version did not have
        found = found.set_column(k, found.schema[k], compute.fill_null(found[k], ""))
    return found


def _is_plain(line: bytes) -> bool:
    """Whether a line is an object that is not deeply nested, so that Arrow may be given it."""
    return line[:1] == b"{" and line.count(b"[") + line.count(b"{") <= DEEPEST


def _one_by_one(rows: list[Row]) -> pa.Table:
    """Rows as a table; what is no text in them becomes a question mark."""
    import pyarrow as pa

    def clean(value: object) -> object:
        return value.encode("utf-8", "replace").decode("utf-8") if isinstance(value, str) else value

    columns = {name: [clean(getattr(row, name)) for row in rows] for name in COLUMNS}
    return pa.table(columns, schema=schema())


def _each_once(table: pa.Table) -> pa.Table:
    """The last row of each run that did not fail, or its last row."""
    codes = table["run"].combine_chunks().dictionary_encode().indices.to_numpy()
    if not len(codes) or codes.max() + 1 == len(codes):
        return table
    fine = np.array([end not in FAILED for end in table["ended"].to_pylist()])
    order = np.lexsort((np.arange(len(codes)), fine, codes))
    last = np.flatnonzero(np.diff(codes[order], append=-1))
    return table.take(np.sort(order[last]))
