"""Rows by cells: what counts as a success, and that nothing is mixed up or lost."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest

from tests.campaigns.tables import failed, hit, many, row, table
from tests.helpers import inside

Outcomes = inside("physim.campaigns", "Outcomes")


def test_cells_are_sorted_and_have_their_rows_by_seed() -> None:
    rows = [
        row(seed, world=world, settings=settings, controller=controller, deviation=float(seed))
        for seed in (5, 1, 3)
        for world in ("b", "a")
        for settings in ("", "gain=1")
        for controller in ("y", "x")
    ]
    outcomes = Outcomes(table(rows))
    names = [cell.names for cell in outcomes.cells]
    assert names == sorted(names)
    assert len(names) == 8
    for cell in outcomes.cells:
        part = outcomes.table.slice(cell.start, cell.count).to_pylist()
        assert [(one["world"], one["settings"], one["controller"]) for one in part] == [
            cell.names
        ] * 3
        assert outcomes.seed[cell.rows].tolist() == [1, 3, 5]
        assert outcomes.column("deviation")[cell.rows].tolist() == [1.0, 3.0, 5.0]


@pytest.mark.parametrize(
    ("one", "free", "finished", "failed_"),
    [
        (row(), True, True, False),
        (row(ended="duration", finish_time=None), True, False, False),
        (hit(), False, True, False),
        (row(contacts=1, contacts_with_boundaries=1), False, True, False),
        (row(grazes=1), False, True, False),
        (hit(ended="duration"), False, False, False),
        (failed(), False, False, True),
        (failed(ended="timeout"), False, False, True),
        (failed(ended="killed"), False, False, True),
        (row(ended="interrupted"), False, False, True),
        (row(contacts=None), False, True, False),
    ],
)
def test_what_counts(one: dict[str, object], free: bool, finished: bool, failed_: bool) -> None:
    outcomes = Outcomes(table([one]))
    assert bool(outcomes.contact_free[0]) is free
    assert bool(outcomes.finished[0]) is finished
    assert bool(outcomes.rate[0]) is (free and finished)
    assert bool(outcomes.failed[0]) is failed_


def test_all_rows_of_a_large_campaign_are_there() -> None:
    given = many(20_000)
    outcomes = Outcomes(pa.concat_tables([given.slice(7000), given.slice(0, 7000)]))
    assert sum(cell.count for cell in outcomes.cells) == len(outcomes) == 20_000
    assert sorted(outcomes.table["run"].to_pylist()) == sorted(given["run"].to_pylist())
    seeds = [outcomes.seed[cell.rows] for cell in outcomes.cells]
    assert all(np.array_equal(one, np.arange(2000)) for one in seeds)
