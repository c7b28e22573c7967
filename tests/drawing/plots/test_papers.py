"""Figures as papers and readers need them: none that is empty, curves apart, sizes in print."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator
from itertools import chain, combinations
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

from physim.analysis import metrics
from physim.drawing.plots import NAMES, draw
from physim.errors import PhysimError
from physim.record import Record
from physim.units import true_minus
from tests.analysis.metrics.histories import history
from tests.helpers import inside
from tests.helpers.records import make_record

LEAST = inside("physim.drawing", "LEAST")
DATE, DPI, PICTURES = inside("physim.drawing.plots", "DATE", "DPI", "PICTURES")
Paper, deviation = inside("physim.drawing.plots", "Paper", "deviation")
robot_colour, styled = inside("physim.drawing.plots", "robot_colour", "styled")
trajectories = inside("physim.drawing.plots", "trajectories")


@pytest.fixture(scope="module")
def seven() -> Iterator[Record]:
    with make_record(robots=7, seconds=14.0) as made:
        yield made


def test_pictures_of_nothing_are_left_out_and_told(tmp_path: Path) -> None:
    told: dict[str, str] = {}
    (tmp_path / "prediction.png").write_text("an older one")
    with make_record(seconds=1.0, contacts=False) as record:
        files = draw(record, tmp_path, force=True, left_out=told.__setitem__)
        assert "no contact" in told["prediction"]
        assert {file.stem for file in files} | set(told) == set(NAMES)
        assert {file.name for file in tmp_path.iterdir()} == {file.name for file in files}
        assert "trajectories" not in told
        (asked,) = draw(record, tmp_path, only=("prediction",))
    assert asked.stat().st_size > 5000, "what is asked for by name says why it is empty"


def own(axis: Any, name: str) -> Any:
    """The curve of a robot."""
    (line,) = (line for line in axis.lines if line.get_label() == name)
    return line


def test_from_five_robots_on_each_has_an_axis_for_its_deviation(seven: Record) -> None:
    figure = deviation(seven)
    shown = [axis for axis in figure.axes if axis.get_visible()]
    time, values = metrics.deviations(seven)
    assert len(shown) == 7
    for robot, axis in enumerate(shown):
        line = own(axis, seven.names[robot])
        assert np.array_equal(line.get_xydata(), np.stack([time, values[:, robot]], axis=1))
        assert to_hex(line.get_color()) == robot_colour(robot)
        assert axis.get_ylim() == shown[0].get_ylim()
        assert axis.get_title() + axis.get_title("left") == seven.names[robot]
    peak = metrics.deviation_peak(seven)
    assert peak is not None
    found = [(k, t.get_text()) for k, a in enumerate(shown) for t in a.texts]
    assert found == [(peak.a, f"{true_minus(f'{peak.value:+.2f}')} m")]


@pytest.mark.parametrize("width", [3.5, pytest.param(7.16, marks=pytest.mark.deep)])
def test_a_figure_for_a_paper(width: float, seven: Record) -> None:
    for name in NAMES if width > 5.0 else ("trajectories", "distances", "modes"):
        with styled():
            figure = PICTURES[name](seven, paper=Paper(width, title=False))
            figure.draw_without_rendering()
        assert figure.get_size_inches()[0] == width
        shown = [text.get_text() for text in figure.texts if text.get_visible()]
        assert not [text for text in shown if "made up" in text]
        for legend in figure.legends:
            box = legend.get_window_extent()
            assert -1.0 <= box.x0 < box.x1 <= figure.bbox.width + 1.0
        wide = [axis.get_window_extent() for axis in figure.axes if axis.get_visible()]
        together = max(box.x1 for box in wide) - min(box.x0 for box in wide)
        assert together > 0.5 * figure.bbox.width, "most of the width is for the data"


def test_a_width_may_be_a_word_and_the_file_has_it(seven: Record, tmp_path: Path) -> None:
    for word, inches in (("column", 3.5), ("page", 7.16)):
        (file,) = draw(seven, tmp_path / word, only=("modes",), width=word, title=False)
        with Image.open(file) as image:
            assert image.width == round(200 * inches)


@pytest.mark.parametrize("width", [1.0, 3.2, 20.1, math.nan, "collumn", "3.5", True, [3.5]])
def test_another_width_is_refused_in_words(seven: Record, tmp_path: Path, width: Any) -> None:
    with pytest.raises(PhysimError, match=r"^width .* given; .* column .* 3\.3 to 20"):
        draw(seven, tmp_path / "no", width=width)
    assert not (tmp_path / "no").exists()


@pytest.mark.deep
@pytest.mark.parametrize("name", NAMES)
def test_titles_of_the_narrowest_figure_do_not_overlap(name: str, seven: Record) -> None:
    with styled():
        figure = PICTURES[name](seven, paper=Paper(LEAST))
        figure.set_dpi(DPI)
        figure.draw_without_rendering()
        titles = [(a.title, a._left_title, a._right_title) for a in figure.axes]
        texts = [*figure.texts, *chain(*titles)]
        boxes = [t.get_window_extent() for t in texts if t.get_visible() and t.get_text()]
    for one, other in combinations(boxes, 2):
        assert not one.overlaps(other)
    assert all(box.x0 >= -1.0 and box.x1 <= figure.bbox.width + 1.0 for box in boxes)


@pytest.mark.parametrize(("format", "date"), [("svg", "abc"), ("svg", "9" * 20), ("pdf", "1.5")])
def test_files_have_no_date_whatever_the_environment_says(
    seven: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: str, date: str
) -> None:
    monkeypatch.setenv(DATE, date)
    (path,) = draw(seven, tmp_path, only=("modes",), format=format)
    written = path.read_bytes()
    assert len(written) > 5000
    assert b"dc:date" not in written
    assert b"CreationDate" not in written
    assert os.environ[DATE] == date


def to_and_fro() -> Record:
    """A robot that comes past the same places five times, 10 m beside the time before."""
    pose = np.zeros((501, 1, 3))
    along = np.linspace(0.0, 5.0, 501)
    pose[:, 0, 0] = 60.0 * np.abs((along + 1.0) % 2.0 - 1.0)
    pose[:, 0, 1] = 10.0 * np.floor(along)
    return history([{"step": 0, "robot": 0}], robots=1, steps_run=500, pose=pose)


@pytest.mark.parametrize("width", [3.5, pytest.param(7.16, marks=pytest.mark.deep)])
def test_times_on_a_map_do_not_lie_over_each_other(width: float) -> None:
    with to_and_fro() as record, styled():
        figure = trajectories(record, 0.5, Paper(width, title=False))
        figure.draw_without_rendering()
        (axis,) = figure.axes
        boxes = [text.get_window_extent() for text in axis.texts if text.get_gid() == "time"]
        room = axis.get_window_extent()
    assert len(boxes) >= 8
    assert not [(a, b) for a, b in combinations(boxes, 2) if a.overlaps(b)]
    assert all(room.containsx(x) for box in boxes for x in (box.x0, box.x1))
    assert all(room.containsy(y) for box in boxes for y in (box.y0, box.y1))


@pytest.mark.deep
@pytest.mark.parametrize("backend", ["nosuch", "module://matplotlib_inline.backend_inlin"])
def test_a_backend_that_cannot_be_loaded_is_not_needed(tmp_path: Path, backend: str) -> None:
    picture = tmp_path / "straight.png"
    command = [sys.executable, "-m", "physim", "preview", "straight", "-o", str(picture)]
    done = subprocess.run(
        command, env=os.environ | {"MPLBACKEND": backend}, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_pictures_do_not_depend_on_the_backend_of_the_host(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = make_record()
    (one,) = draw(record, tmp_path / "a", only=("distances",))
    monkeypatch.setitem(matplotlib.rcParams, "backend", "svg")
    (other,) = draw(record, tmp_path / "b", only=("distances",))
    assert one.read_bytes() == other.read_bytes()
    assert matplotlib.get_backend() == "svg"
