"""Pictures say what the record says, and are the same for the same record."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from physim.analysis.metrics import Figures
from physim.contacts import Phase
from physim.drawing.plots import FORMATS, NAMES, draw
from physim.errors import PhysimError
from physim.record import Record, RecordWriter
from tests.analysis.metrics.histories import history
from tests.helpers import facts, inside, said
from tests.helpers.records import make_record, make_scene

MOST_POINTS, distances = inside("physim.drawing.plots", "MOST_POINTS", "distances")
predictions, thinned = inside("physim.drawing.plots", "predictions", "thinned")


@pytest.fixture
def record() -> Record:
    return make_record()


@pytest.mark.parametrize(
    "format",
    [pytest.param(one, marks=pytest.mark.deep) if one == "pdf" else one for one in FORMATS],
)
def test_the_same_record_gives_the_same_files(record: Record, tmp_path: Path, format: str) -> None:
    only = ("trajectories", "distances", "modes") if format != "svg" else ("modes",)
    first = draw(record, tmp_path / "a", format=format, only=only)
    second = draw(record, tmp_path / "b", format=format, only=only)
    assert [path.name for path in first] == [f"{name}.{format}" for name in only]
    for one, two in zip(first, second, strict=True):
        assert one.stat().st_size > 2000
        assert one.read_bytes() == two.read_bytes()
    assert len(list((tmp_path / "a").iterdir())) == len(only)


def test_nothing_is_written_over_without_force(record: Record, tmp_path: Path) -> None:
    (tmp_path / "distances.png").write_text("mine")
    with pytest.raises(PhysimError, match="exists"):
        draw(record, tmp_path, only=("distances",))
    assert (tmp_path / "distances.png").read_text() == "mine"
    draw(record, tmp_path, only=("distances",), force=True)
    assert (tmp_path / "distances.png").read_bytes()[:4] == b"\x89PNG"


def test_unknown_names_and_formats_are_refused(record: Record, tmp_path: Path) -> None:
    for only, format in ((("depth",), "png"), (("distances",), "gif")):
        with pytest.raises(PhysimError):
            draw(record, tmp_path, only=only, format=format)
    assert list(tmp_path.iterdir()) == []
    make_record(tmp_path / "r.h5", seconds=1.0).close()
    done = said("plot", str(tmp_path / "r.h5"), "--only", "modes,speed")
    assert done.code == 2
    assert re.search(facts('"speed"', *NAMES), done.err)
    assert '"speeds"' in done.err
    assert [file.name for file in tmp_path.iterdir()] == ["r.h5"]


def test_distances_show_the_least_values_and_every_contact(record: Record) -> None:
    above, below = distances(record).axes
    lines = {line.get_label().split(",")[0]: line for line in above.lines}
    least = lines["robot to robot"].get_ydata()
    assert np.array_equal(least, record.clearance.min(axis=1))
    assert np.array_equal(lines["robot to robot"].get_xdata(), record.time)
    walls = lines["robot to wall"].get_ydata()
    assert np.array_equal(walls, record.boundary_clearance.min(axis=1))
    for axis in (above, below):
        (strip,) = [one for one in axis.collections if one.get_gid() == "contacts"]
        spans = [
            (path.vertices[:, 0].min(), path.vertices[:, 0].max()) for path in strip.get_paths()
        ]
        for episode in Figures(record).episodes:
            assert any(begin <= episode.time <= end for begin, end in spans)


def test_no_dip_is_lost_where_a_curve_is_thinned() -> None:
    values = np.ones(100_000)
    values[77_777] = -1.0
    time, kept = thinned(np.arange(100_000.0), values)
    assert len(kept) == MOST_POINTS
    assert kept.min() == -1.0
    assert time[kept.argmin()] == 77_777.0


def test_predictions_are_those_before_a_contact(record: Record) -> None:
    known = predictions(record)
    rows = record.updates
    began = {0: [0.3], 1: [0.3, 0.6]}  # shares of the run at which contacts begin
    expected = []
    for robot, shares in began.items():
        hits = [round(share * record.steps_run) for share in shares]
        for row in rows[(rows["robot"] == robot) & np.isfinite(rows["collision_time"])]:
            later = [hit for hit in hits if hit > row["step"]]
            if later and row["collision_time"] > 0.0:
                expected.append(
                    (robot, row["collision_time"], (later[0] - row["step"]) * record.dt)
                )
    got = list(zip(known.robot, known.predicted, known.actual, strict=True))
    assert len(got) == len(expected) > 0
    assert np.allclose(got, expected, rtol=0.0, atol=1e-12)


def test_a_prediction_counts_where_the_two_were_apart_and_tells_whether_it_was_kept() -> None:
    """Robot 0 touches robot 1 from step 50 on, and the wall from step 80 on."""
    contacts = [
        (50, 0, 1, Phase.BEGAN, 1e-3),
        (55, 0, 1, Phase.ENDED, -1e-3),
        (80, 0, 2, Phase.BEGAN, 1e-3),
    ]
    decisions = [
        {"step": 10, "collision_time": 0.7, "next_step": 30},  # changed before the contact
        {"step": 30, "collision_time": np.inf, "next_step": 40},
        {"step": 40, "collision_time": 0.12, "next_step": 50},
        {"step": 50, "collision_time": 0.0, "next_step": 60},  # they touch: nothing is foretold
        {"step": 60, "collision_time": 0.2, "next_step": 70},
        {"step": 85, "collision_time": 0.5, "next_step": 90},  # after the last contact
    ]
    known = predictions(history(decisions, contacts))
    assert known.predicted.tolist() == [0.7, 0.12, 0.2]
    assert known.actual == pytest.approx([0.4, 0.1, 0.2])
    assert known.kept.tolist() == [0, 1, 0]
    assert known.robot.tolist() == [0, 0, 0]


def test_a_command_that_a_stage_changed_was_not_held() -> None:
    rows = [{"step": k, "robot": 0, "collision_time": 0.3, "next_step": 40} for k in (0, 10)]
    touch = [(30, 0, 1, 0, 0.001, 1.0), (31, 0, 1, 2, -0.1, 0.0)]
    slowed = [(step, 0, 1.0, 0.0, 1.0, 0.0, 0.5, 0.0) for step in (5, 30)]
    assert predictions(history(rows, touch)).kept.tolist() == [1, 1]
    assert predictions(history(rows, touch, commands=slowed)).kept.tolist() == [0, 1]


def test_of_a_record_whose_world_is_no_yaml_nothing_is_drawn(tmp_path: Path) -> None:
    """Not the first pictures either, which need nothing of it; the fault is at its place."""
    out = RecordWriter(None, make_scene(2), "name: x\nrobots: [1\n", name="x")
    out.close("duration", steps_run=0, rejected=0, wall_clock={})
    with out.record() as record, pytest.raises(PhysimError, match=r"cannot be read: 2:9:") as no:
        draw(record, tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert "unicode string" not in str(no.value)
    assert "\n" not in str(no.value)
