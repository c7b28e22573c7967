"""docs/CAMPAIGNS.md names every column, and its program runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from physim.campaigns.rows import COLUMNS, read
from tests.campaigns.samples import rows_in

TEXT = (Path(__file__).parents[2] / "docs/CAMPAIGNS.md").read_text(encoding="utf-8")


def test_every_column_is_told() -> None:
    told = set(re.findall(r"`(\w+)`", TEXT.split("## Columns")[1].split("\n## ")[0]))
    told |= {f"shortest_{what}{end}" for what in ("distance", "collision_time")
             for end in ("_pair", "_time")}  # fmt: skip
    assert set(COLUMNS) <= told


def test_the_program_runs(tmp_path: Path) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    (tmp_path / "many.py").write_text(program)
    done = subprocess.run([sys.executable, "many.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = rows_in(tmp_path / "campaign")
    assert [row.seed for row in rows] == [0, 1, 2, 3]
    assert all(f"{row.shortest_distance:.6f}"[:5] in done.stdout for row in rows)
    assert read(tmp_path / "campaign").num_rows == 4
