"""Settings of libraries that lie in the working folder are not read: they may be a stranger's."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from physim.stray_settings import MATPLOTLIB, NUMBA, unseen

ASK = """\
import sys
import physim
from physim.stray_settings import load_numba
numba = load_numba()
numba.config.reload_config()  # as before each kernel is compiled
assert numba.config.CACHE_DIR == "", numba.config.CACHE_DIR
assert not numba.config.DUMP_BYTECODE
from physim.drawing.plots.loading import load_matplotlib
from physim.drawing.plots.style import styled
assert load_matplotlib().rcParams["lines.linewidth"] == 1.5
with styled():
    assert not load_matplotlib().rcParams["text.usetex"]
assert sys.argv[1] == __import__("os").getcwd()
"""

SEARCH = """\
import sys
import numpy as np
from physim.campaigns.falsify.optimisers import Evolution
assert len(Evolution(np.full(2, 0.5), 1).ask()) > 1
assert sys.modules["matplotlib"].rcParams["lines.linewidth"] == 1.5
"""


@pytest.mark.parametrize(
    ("numba", "matplotlib"),
    [
        (b"cache_dir: mine\ndump_bytecode: 1\n", b"lines.linewidth: 9\ntext.usetex: true\n"),
        pytest.param(b"[1]", b"\xff\xfe", marks=pytest.mark.deep),
        pytest.param(b"{x", b"backend: module://evil\n", marks=pytest.mark.deep),
    ],
)
def test_no_file_of_the_working_folder_sets_anything(
    tmp_path: Path, numba: bytes, matplotlib: bytes
) -> None:
    """numba would run what lies in the folder that is named; others end in tracebacks."""
    (tmp_path / NUMBA).write_bytes(numba)
    (tmp_path / MATPLOTLIB).write_bytes(matplotlib)
    env = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    done = subprocess.run(
        [sys.executable, "-c", ASK, str(tmp_path)],
        cwd=tmp_path, env=env, capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    assert not (tmp_path / "mine").exists()


@pytest.mark.deep
@pytest.mark.parametrize("given", [b"lines.linewidth: 9\n", b"\xff\xfe"])
def test_what_a_search_is_done_with_reads_no_file_of_the_working_folder(
    tmp_path: Path, given: bytes
) -> None:
    """cma imports matplotlib for plots of its own."""
    (tmp_path / MATPLOTLIB).write_bytes(given)
    done = subprocess.run(
        [sys.executable, "-c", SEARCH],
        cwd=tmp_path, env={**os.environ, "MPLBACKEND": "no such backend"},
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_the_folder_is_the_same_afterwards(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / NUMBA).touch()
    monkeypatch.chdir(tmp_path)
    with unseen(NUMBA):
        assert not Path(NUMBA).exists()
    assert Path.cwd() == tmp_path
    with unseen(MATPLOTLIB):
        assert Path.cwd() == tmp_path, "nothing lies in wait"
