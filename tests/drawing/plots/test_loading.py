"""Pictures are drawn whatever backend the environment asks for, and a host keeps its settings."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from physim.drawing.plots import draw
from tests.helpers.records import make_record

HOST = """
import matplotlib
matplotlib.rcParams["lines.linewidth"] = 7.0
before = dict(dict.items(matplotlib.rcParams))
from physim.drawing.plots.style import styled
with styled():
    pass
after = dict(dict.items(matplotlib.rcParams))
assert {k for k in before if before[k] != after[k]} == set(), "changed"
"""
LATER = """
import os, sys
from physim.drawing.plots.style import styled
with styled():
    pass
import matplotlib
print(os.environ["MPLBACKEND"], matplotlib.get_backend())
"""


def python(arguments: list[str], backend: str | None) -> subprocess.CompletedProcess[str]:
    kept = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"}
    given = {} if backend is None else {"MPLBACKEND": backend}
    command = [sys.executable, *arguments]
    return subprocess.run(command, env=kept | given, capture_output=True, text=True, check=False)


@pytest.mark.deep
@pytest.mark.parametrize("backend", ["nosuch", "module://matplotlib_inline.backend_inlin"])
def test_a_backend_that_cannot_be_loaded_is_not_needed(tmp_path: Path, backend: str) -> None:
    picture = tmp_path / "straight.png"
    done = python(["-m", "physim", "preview", "straight", "-o", str(picture)], backend)
    assert (done.returncode, done.stderr) == (0, "")
    assert picture.read_bytes()[:4] == b"\x89PNG"


@pytest.mark.deep
def test_the_settings_of_a_host_stay() -> None:
    assert (done := python(["-c", HOST], None)).returncode == 0, done.stderr


@pytest.mark.deep
@pytest.mark.parametrize(("backend", "taken"), [("svg", "svg"), ("nosuch", "agg")])
def test_a_backend_that_exists_is_there_for_the_host(backend: str, taken: str) -> None:
    done = python(["-c", LATER], backend)
    assert done.stdout.lower().split() == [backend, taken], done.stderr


def test_pictures_do_not_depend_on_the_backend_of_the_host(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib

    record = make_record()
    (one,) = draw(record, tmp_path / "a", only=("distances",))
    monkeypatch.setitem(matplotlib.rcParams, "backend", "svg")
    (other,) = draw(record, tmp_path / "b", only=("distances",))
    assert one.read_bytes() == other.read_bytes()
    assert matplotlib.get_backend() == "svg"
