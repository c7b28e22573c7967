"""Settings of matplotlib that lie in the working folder are not read: they may be a stranger's."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ASK = """\
import sys
from physim.drawing.plots.style import load_matplotlib
from physim.drawing.plots.style import styled
assert load_matplotlib().rcParams["lines.linewidth"] == 1.5
with styled():
    assert not load_matplotlib().rcParams["text.usetex"]
assert sys.argv[1] == __import__("os").getcwd()
"""


@pytest.mark.parametrize(
    "settings",
    [
        b"lines.linewidth: 9\ntext.usetex: true\n",
        pytest.param(b"\xff\xfe", marks=pytest.mark.deep),
        pytest.param(b"backend: module://evil\n", marks=pytest.mark.deep),
    ],
)
def test_no_file_of_the_working_folder_sets_anything(tmp_path: Path, settings: bytes) -> None:
    (tmp_path / "matplotlibrc").write_bytes(settings)
    done = subprocess.run(
        [sys.executable, "-c", ASK, str(tmp_path)],
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
