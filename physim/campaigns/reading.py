"""All rows of a campaign as one table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physim.campaigns.columns import FAILED, schema
from physim.campaigns.rows import Shards
from physim.errors import PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

    from physim.campaigns.grid import Grid

ORDER = ("world", "settings", "controller", "seed", "run")


def read_table(folder: Path) -> pa.Table:
    """All rows, each run once, in the order of world, settings, controller and seed.

    Of a run that was done again the last row that did not fail, else the last. Raises PhysimError
    where there is no campaign or a shard cannot be read.
    """
    import pyarrow as pa

    shards = Shards(folder)
    if not shards.folder.is_dir():
        raise PhysimError(f"{folder}: holds no campaign (physim sweep WORLD -o {folder} makes one)")
    found = _each_once(pa.concat_tables([schema().empty_table(), *shards.tables()]))
    return found.sort_by([(name, "ascending") for name in ORDER])


def read_part(folder: Path, grid: Grid) -> pa.Table:
    """The rows of the runs of a grid; the folder may have others. Raises PhysimError as `read`."""
    import pyarrow as pa

    table = read_table(folder)
    columns = (table[name].to_pylist() for name in (*ORDER[:4], "run"))
    mine = [grid.has((w, s, c), seed, run) for w, s, c, seed, run in zip(*columns, strict=True)]
    return table.filter(pa.array(mine, pa.bool_()))


def _each_once(table: pa.Table) -> pa.Table:
    """The last row of each run that did not fail, or its last row."""
    codes = table["run"].combine_chunks().dictionary_encode().indices.to_numpy()
    if not len(codes) or codes.max() + 1 == len(codes):
        return table
    fine = np.array([end not in FAILED for end in table["ended"].to_pylist()])
    order = np.lexsort((np.arange(len(codes)), fine, codes))
    last = np.flatnonzero(np.diff(codes[order], append=-1))
    return table.take(np.sort(order[last]))
