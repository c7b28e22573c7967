"""Rows by cells: what counts as a success, that nothing is lost, and what docs say of columns."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from physim.campaigns import Row, columns, read
from tests.campaigns.samples import rows_in
from tests.campaigns.tables import failed, hit, many, row
from tests.helpers import facts, inside

COLUMNS, Outcomes, Tally = inside("physim.campaigns", "COLUMNS", "Outcomes", "Tally")
sweep_text, sweep_values = inside("physim.campaigns.report", "sweep_text", "sweep_values")
replay = inside("physim.campaigns.report", "replay")


def test_cells_are_sorted_and_have_their_rows_by_seed() -> None:
    rows = [
        row(seed, world=world, settings=settings, controller=controller, deviation_peak=float(seed))
        for seed in (5, 1, 3)
        for world in ("b", "a")
        for settings in ("", "gain=1")
        for controller in ("y", "x")
    ]
    outcomes = Outcomes(rows)
    names = [cell.names for cell in outcomes.cells]
    assert names == sorted(names)
    assert len(names) == 8
    for cell in outcomes.cells:
        part = outcomes.rows[cell.rows]
        assert [(one.world, one.settings, one.controller) for one in part] == [cell.names] * 3
        assert outcomes.seed[cell.rows].tolist() == [1, 3, 5]
        assert outcomes.column("deviation_peak")[cell.rows].tolist() == [1.0, 3.0, 5.0]


@pytest.mark.parametrize(
    ("one", "free", "finished", "failed_"),
    [
        (row(), True, True, False),
        (row(ended="duration", time_to_finish=None), True, False, False),
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
def test_what_counts(one: Row, free: bool, finished: bool, failed_: bool) -> None:
    outcomes = Outcomes([one])
    assert bool(outcomes.contact_free[0]) is free
    assert bool(outcomes.finished[0]) is finished
    assert bool(outcomes.rate[0]) is (free and finished)
    assert bool(outcomes.failed[0]) is failed_
    assert one.came == (failed_, free, finished)


def test_all_rows_of_a_large_campaign_are_there() -> None:
    given = many(4000)
    outcomes = Outcomes([*given[1400:], *given[:1400]])
    assert sum(cell.count for cell in outcomes.cells) == len(outcomes) == 4000
    assert outcomes.keys == sorted(one.run for one in given)
    seeds = [outcomes.seed[cell.rows] for cell in outcomes.cells]
    assert all(np.array_equal(one, np.arange(400)) for one in seeds)


GOOD = ("yard", "", "good")


def test_a_sweep_names_contacts_then_failures_then_what_did_not_finish() -> None:
    rows = [row(1), row(2, ended="duration"), failed(3), failed(4, "killed"), hit(5), hit(6)]
    draws = {GOOD: "the starts", ("none", "", "x"): ""}
    outcomes = Outcomes([*rows, hit(7, world="of another sweep")])
    said = sweep_text(Path("out"), outcomes, draws, Tally(5))
    order = [5, 6, 3, 4, 2]
    named = re.findall(r"^  .*, seed (\d+):", said, flags=re.MULTILINE)
    assert [int(seed) for seed in named] == order
    assert f"physim replay out:{hit(5).run}" in said
    found = sweep_values(Path("out"), outcomes, draws, Tally(5), {})
    one, nothing = found["cells"]
    counts = {"runs": 6, "contact_free": 2, "finished": 3, "failed": 2, "error": 1, "killed": 1,
              "timeout": 0}  # fmt: skip
    assert {key: one[key] for key in counts} == counts
    assert nothing["runs"] == 0
    assert [one["seed"] for one in found["to_look_at"]["first"]] == order
    assert found["to_look_at"]["runs"] == 5
    json.dumps(found, allow_nan=False)
    many_hits = Outcomes([hit(seed) for seed in range(25)])
    said = sweep_text(Path("out"), many_hits, {GOOD: ""}, Tally(25))
    assert re.search(facts("15", "physim report out"), said.splitlines()[-2])


def test_a_run_is_named_by_as_many_digits_as_it_takes() -> None:
    keys = ["abcdef00", "abcdef01", "abcdef1", "123456789a", "f00"]
    outcomes = Outcomes([row(k, run=key.ljust(20, "0")) for k, key in enumerate(keys)])
    named = {replay("out", outcomes, one).rpartition(":")[2] for one in outcomes.rows}
    assert named == {"abcdef00", "abcdef01", "abcdef1", "123456789", "f00000"}


TEXT = (Path(__file__).parents[2] / "docs/how-to/many-runs.md").read_text(encoding="utf-8")


def test_every_column_is_told() -> None:
    assert [name for name, _, meaning in columns() if meaning] == list(COLUMNS)
    assert {"m", "s", "-", ""} <= {unit for _, unit, _ in columns()}


@pytest.mark.deep
def test_the_program_runs(tmp_path: Path) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    (tmp_path / "many.py").write_text(program)
    done = subprocess.run([sys.executable, "many.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = rows_in(tmp_path / "campaign")
    assert [row.seed for row in rows] == [0, 1, 2, 3]
    assert all(f"{row.shortest_distance:.6f}"[:5] in done.stdout for row in rows)
    assert len(read(tmp_path / "campaign")) == 4
