"""docs/CAMPAIGNS.md names every column, and its program runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pyarrow.parquet as parquet
import pytest

from physim.campaigns import read
from tests.campaigns.samples import rows_in
from tests.campaigns.tables import failed, hit, row, table
from tests.helpers import inside

COLUMNS = inside("physim.campaigns", "COLUMNS")

TEXT = (Path(__file__).parents[2] / "docs/CAMPAIGNS.md").read_text(encoding="utf-8")


def test_every_column_is_told() -> None:
    told = set(re.findall(r"`(\w+)`", TEXT.split("## Columns")[1].split("\n## ")[0]))
    told |= {f"{what}{end}" for what in ("least_distance", "shortest_collision_time")
             for end in ("_pair", "_time")}  # fmt: skip
    assert set(COLUMNS) <= told


@pytest.mark.deep
def test_the_program_runs(tmp_path: Path) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    (tmp_path / "many.py").write_text(program)
    done = subprocess.run([sys.executable, "many.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = rows_in(tmp_path / "campaign")
    assert [row.seed for row in rows] == [0, 1, 2, 3]
    assert all(f"{row.shortest_distance:.6f}"[:5] in done.stdout for row in rows)
    assert read(tmp_path / "campaign").num_rows == 4


def test_the_line_for_pandas_gives_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Runs that failed have no distance: they are not the least."""
    (line,) = re.findall(r"^pd\..*$", TEXT, flags=re.MULTILINE)
    rows = [row(1), hit(2, depth=0.013), failed(3), row(4, controller="other")]
    (tmp_path / "many").mkdir()
    parquet.write_table(table(rows), tmp_path / "many/results.parquet")
    monkeypatch.chdir(tmp_path)
    assert eval(line, {"pd": pd}).to_dict() == {"good": -0.013, "other": 0.4}
