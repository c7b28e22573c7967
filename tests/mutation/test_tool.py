"""Mutation by sample: a mutant that no test notices is named, and no other."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
from pathlib import Path
from tests.mutation import rooms
rooms.ROOT, rooms.ROOMS = Path.cwd(), {"toy": rooms.Room("toy", ("toy",))}
from tests.mutation.__main__ import main
sys.exit(main(["--room", "toy", "--seed", "3"]))
"""
TOY = """\
def larger(a: int, b: int) -> int:
    return a if a > b else b


def unused(a: int) -> int:
    return -a
"""
TESTS = """\
from toy.toy import larger

def test_larger() -> None:
    assert (larger(1, 2), larger(2, 1)) == (2, 1 + 1)
"""


@pytest.mark.deep
def test_survivors_are_named(tmp_path: Path) -> None:
    for name, text in (("toy/toy.py", TOY), ("tests/toy/test_toy.py", TESTS)):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    root = Path(__file__).parents[2]
    env = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": f"{root}:{tmp_path}"}
    env.pop("PYTEST_ADDOPTS", None)  # options of this run, which the tests of the toy do not know
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=tmp_path, env=env, capture_output=True, text=True
    )
    survivors = [line for line in run.stdout.splitlines() if line.startswith("survives")]
    assert run.returncode == 1, run.stderr
    assert len(survivors) == 3, run.stdout
    assert sum("toy/toy.py:2 larger: a > b  ->  a >= b" in line for line in survivors) == 1
    assert sum("toy/toy.py:6 unused" in line for line in survivors) == 2
