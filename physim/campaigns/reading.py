"""All rows of a campaign as one table, each of them of a run that the campaign tells of."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from physim.campaigns import contradictions, own_metrics
from physim.campaigns.columns import FAILED, schema
from physim.campaigns.folder import CAMPAIGN, RESULTS, Folder, label_of
from physim.campaigns.spec import identity_of, key_of, short_hash
from physim.drafts import discard, draft_of
from physim.errors import PhysimError
from physim.escaping import escaped
from physim.world.file.files import file_text

if TYPE_CHECKING:
    import pyarrow as pa

    from physim.campaigns.grid import Grid

ORDER = ("world", "settings", "controller", "seed", "run")
OF_CELL = ("world_hash", "physim", "engine")
"""Columns that all rows of a cell have alike."""


def read(folder: str | os.PathLike[str]) -> pa.Table:
    """All rows, each run once, in the order of world, settings, controller and seed.

    Metrics of one's own have a column each, ``metric_NAME``. Of a run that was done again the last
    row that did not fail, else the last. Raises PhysimError where there is no campaign, a shard
    cannot be read, a row is of no run of the campaign (its cell is not in ``campaign.json``, or
    its key is not that of its cell and seed), or rows contradict themselves or one another.
    """
    place = Folder(folder)
    table = _all_rows(place)
    _check_runs(place, table)
    return own_metrics.with_columns(_in_order(table))


def read_rows(place: Folder) -> pa.Table:
    """As `read`, whatever the campaign tells."""
    return _in_order(_all_rows(place))


def check_rows(place: Folder) -> None:
    """Raise PhysimError as `read` does."""
    _check_runs(place, _all_rows(place))


def _all_rows(place: Folder) -> pa.Table:
    import pyarrow as pa

    return pa.concat_tables([schema().empty_table(), *place.shards.tables()])


def _in_order(table: pa.Table) -> pa.Table:
    return _each_once(table).sort_by([(name, "ascending") for name in ORDER])


def read_part(folder: Path, grid: Grid) -> pa.Table:
    """The rows of the runs of a grid; the folder may have others. Raises PhysimError as `read`."""
    import pyarrow as pa

    table = read(folder)
    columns = (table[name].to_pylist() for name in (*ORDER[:4], "run"))
    mine = [grid.has((w, s, c), seed, run) for w, s, c, seed, run in zip(*columns, strict=True)]
    return table.filter(pa.array(mine, pa.bool_()))


def write_results(folder: Path) -> None:
    """Write all rows to ``results.parquet``, whole or not at all. Raises PhysimError as `read`."""
    import pyarrow.parquet as parquet

    table = read(folder)
    path = folder / RESULTS
    draft = draft_of(path)
    try:
        with open(draft, "wb") as stream:  # it takes no path that is not UTF-8
            parquet.write_table(table, stream)
        draft.replace(path)
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        discard(draft)


def _check_runs(place: Folder, table: pa.Table) -> None:
    """Raise PhysimError for a row that is of no run of the campaign, or differs from another of
    its run, with file and line."""
    known = _identities(place)
    columns = [table[name].to_pylist() for name in (*ORDER, *OF_CELL)]
    for *label, seed, run, world_hash, physim, engine in zip(*columns, strict=True):
        cell = known.get(tuple(label))
        if cell is None:
            named = ", ".join(part for part in label if part)
            why = f"{CAMPAIGN} has no runs of {named}"
        elif (key_of(cell[0], seed), world_hash, physim, engine) != (run, *cell[1:]):
            why = f"run {run} is not what {CAMPAIGN} makes of its world, controller and seed {seed}"
        else:
            continue
        row = dict(
            zip((*ORDER, *OF_CELL), (*label, seed, run, world_hash, physim, engine), strict=True)
        )
        raise PhysimError(
            f"{place.shards.place_of(row)}: {escaped(why)}; is this a row of another campaign?"
        )
    if other := contradictions.of_another(table):
        raise PhysimError(
            f"{place.shards.place_of(other)}: {list(other)[1]} is not that of another row of run "
            f"{other['run']}; delete the one that is wrong"
        )


def _identities(place: Folder) -> dict[tuple[str, ...], tuple[str, str, str, str]]:
    """Of each cell what the keys of its runs are made of but the seed, and its columns `OF_CELL`.

    Raises PhysimError for a world that was changed.
    """
    found: dict[tuple[str, ...], tuple[str, str, str, str]] = {}
    for cell in place.cells():
        file = place.world_file(cell["world_hash"])
        text = file_text(file)
        if short_hash(text) != cell["world_hash"]:
            raise PhysimError(f"{file}: was changed since its runs were made")
        parts = cell["controller"], cell["source_hash"], cell["physim"], cell["engine"]
        identity = identity_of(text, *parts)
        found[label_of(cell)] = identity, cell["world_hash"], cell["physim"], cell["engine"]
    return found


def _each_once(table: pa.Table) -> pa.Table:
    """The last row of each run that did not fail, or its last row."""
    codes = table["run"].combine_chunks().dictionary_encode().indices.to_numpy()
    if not len(codes) or codes.max() + 1 == len(codes):
        return table
    fine = np.array([end not in FAILED for end in table["ended"].to_pylist()])
    order = np.lexsort((np.arange(len(codes)), fine, codes))
    last = np.flatnonzero(np.diff(codes[order], append=-1))
    return table.take(np.sort(order[last]))


__all__ = ["check_rows", "read", "read_part", "read_rows", "write_results"]
