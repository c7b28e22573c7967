"""Pictures that packages register: drawn by name, and what fails in them is one line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from physim.drawing.plots import NAMES, draw, names
from physim.errors import PhysimError
from physim.record import Record
from tests.cli.commands import physim
from tests.helpers import facts
from tests.helpers.packages import install
from tests.helpers.records import make_record

TEXT = '''
from matplotlib.figure import Figure

class Speed:
    """Applied speeds of the decisions."""

    def draw(self, record):
        figure = Figure()
        axis = figure.subplots()
        axis.plot(record.updates["step"] * record.dt, record.updates["applied_v"])
        axis.set_title(record.name)
        return figure

class Broken:
    def draw(self, record):
        return 1 / 0

class Words:
    def draw(self, record):
        return "a picture"
'''


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Record]:
    with make_record(tmp_path / "record.h5", seconds=1.0) as made:
        yield made


@pytest.fixture(autouse=True)
def _registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    classes = {"speed": "Speed", "broken": "Broken", "words": "Words", "modes": "Broken"}
    folder = tmp_path / "package"
    folder.mkdir()
    name = f"own_plots_{tmp_path.name.replace('-', '_')}"
    install(folder, monkeypatch, name, TEXT, {"physim.plots": classes})


def test_it_is_drawn_by_name(record: Record, tmp_path: Path) -> None:
    assert names() == (*NAMES, "broken", "speed", "words")
    (first,) = draw(record, tmp_path / "a", only="speed")
    (second,) = draw(record, tmp_path / "b", only=("speed",))
    assert first.name == "speed.png"
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 5000
    (shipped,) = draw(record, tmp_path / "c", only=("modes",))
    assert shipped.stat().st_size > 5000  # physim's own are not replaced


def test_the_command_draws_it(
    record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = record.path
    done = physim("plot", path, "--only", "speed", "--format", "svg", capture=capsys)
    assert (done.code, done.out) == (0, f"{tmp_path / 'speed.svg'}\n")
    done = physim("plot", path, "--only", "sped", capture=capsys)
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert '"speed"' in done.err


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("broken", facts("ZeroDivisionError: division by zero")),
        ("words", facts("str", "matplotlib Figure")),
    ],
)
def test_what_fails_is_one_line_and_leaves_no_file(
    name: str, said: str, record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(PhysimError, match=said) as caught:
        draw(record, tmp_path / "out", only=("modes", name))
    assert "\n" not in str(caught.value)
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["modes.png"]
    done = physim("plot", record.path, "--only", name, capture=capsys)
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert done.err.startswith(f'plot "{name}" ')
    assert re.search(said, done.err)
