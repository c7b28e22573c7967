"""Settings of libraries that lie in the working folder are not read: they may be a stranger's."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from physim.stray_settings import MATPLOTLIB, NUMBA

ASK = """\
import sys
import physim
from physim.stray_settings import load_numba
numba = load_numba()
numba.config.reload_config()  # as before each kernel is compiled
assert numba.config.CACHE_DIR == "", numba.config.CACHE_DIR
assert not numba.config.DUMP_BYTECODE
from physim.drawing.plots.style import load_matplotlib
from physim.drawing.plots.style import styled
assert load_matplotlib().rcParams["lines.linewidth"] == 1.5
with styled():
    assert not load_matplotlib().rcParams["text.usetex"]
assert sys.argv[1] == __import__("os").getcwd()
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
