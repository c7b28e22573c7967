"""What is packed comes back: poses to their tolerance, decisions, contacts, considered robots."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import physim
from physim.analysis.summary import summarise
from physim.drawing.page.data import run_data
from physim.drawing.page.knots import between, find_knots
from physim.drawing.page.packing import LARGEST, Pack
from physim.drawing.timeline import Timeline
from physim.geometry.motion import arcs
from tests.page.unpacking import unpack
from tests.records import make_record

WHOLE = st.lists(st.integers(-LARGEST // 4 + 1, LARGEST // 4 - 1), max_size=60)
REAL = st.lists(
    st.one_of(st.floats(-1e5, 1e5), st.sampled_from([np.nan, np.inf, -np.inf])), max_size=60
)


@given(WHOLE, REAL, st.sampled_from([1e-3, 0.25]))
def test_numbers_come_back(whole: list[int], real: list[float], quantum: float) -> None:
    pack = Pack()
    pack.whole("whole", whole)
    pack.real("real", real, quantum)
    _, arrays = unpack(pack.to_base64({}))
    assert arrays["whole"].tolist() == whole
    finite = np.isfinite(real)
    error = arrays["real"][finite] - np.array(real)[finite]
    assert (np.abs(error) <= quantum * 0.5 + 1e-9).all()
    assert np.array_equal(arrays["real"][~finite], np.array(real)[~finite], equal_nan=True)


def test_a_number_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="fit"):
        Pack().whole("a", [LARGEST])


COMMANDS = st.lists(
    st.tuples(st.floats(-1.3, 1.3), st.floats(-1.6, 1.6), st.integers(1, 40)),
    min_size=1,
    max_size=8,
)


@given(COMMANDS, st.sampled_from([0.001, 0.01]))
def test_knots_keep_every_sample_within_the_tolerance(
    commands: list[tuple[float, float, int]], tolerance: float
) -> None:
    pose = [np.array([1.0, -2.0, 3.0])]
    for v, omega, steps in commands:
        for _ in range(steps):
            pose.append(arcs(pose[-1][None], np.array([[v, omega]]), 0.02)[0])
    samples = np.array(pose)
    time = 0.02 * np.arange(len(samples))
    quanta = np.full(3, tolerance / 10.0)
    knots = find_knots(samples[:, None], time, quanta, tolerance, np.array([1.0]))
    row, kept = knots.row, knots.pose * quanta
    at = np.clip(np.searchsorted(row, np.arange(len(samples)), side="right") - 1, 0, len(row) - 2)
    share = (time - time[row[at]]) / (time[row[at + 1]] - time[row[at]])
    error = between(kept[at], kept[at + 1], share) - samples
    assert (np.hypot(error[:, 0], error[:, 1]) + np.abs(error[:, 2])).max() <= tolerance
    assert knots.counts.tolist() == [len(row)]


def test_one_command_needs_two_knots() -> None:
    pose = arcs(np.zeros((50, 3)), np.tile([1.0, 0.5], (50, 1)), 0.0)
    for k in range(50):
        pose[k] = arcs(np.zeros((1, 3)), np.array([[1.0, 0.5]]), 0.02 * k)[0]
    knots = find_knots(pose[:, None], 0.02 * np.arange(50), np.full(3, 1e-4), 1e-3, np.ones(1))
    assert len(knots.row) == 2


def test_decisions_and_contacts_come_back(tmp_path: Path) -> None:
    with make_record(tmp_path / "r.h5", 4, 5.0) as record:
        header, arrays = unpack(run_data(record, summarise(record)))
        rows = record.updates[np.lexsort((record.updates["step"], record.updates["robot"]))]
        for name in ("step", "mode", "rule", "considered"):
            assert np.array_equal(arrays[name], rows[name]), name
        assert np.array_equal(arrays["hold"], rows["next_step"] - rows["step"])
        for name in ("station", "formation_error", "deviation", "nominal_v"):
            assert np.allclose(arrays[name], rows[name], rtol=0, atol=5.1e-4), name
        for column in record.declared.columns:
            given, kept = rows[column.name], arrays[f"own:{column.name}"]
            assert np.allclose(kept, given, rtol=0, atol=5.1e-4, equal_nan=True), column.name
        contacts = Timeline(record).contacts
        assert np.allclose(arrays["contact_step"] * record.dt, contacts.began)
        assert np.array_equal(
            np.column_stack((arrays["contact_a"], arrays["contact_b"])), contacts.bodies
        )
        assert [moment["label"] for moment in header["moments"]].count("first contact") == 1
        check_considered(record, rows, arrays)


def check_considered(
    record: physim.Record, rows: np.ndarray, arrays: dict[str, np.ndarray]
) -> None:
    """The considered robots of every decision are those of the record."""
    sets = np.cumsum(arrays["others_new"]).astype(int) - 1
    start = np.concatenate(([0], np.cumsum(arrays["others_count"]))).astype(int)
    table = record.considered
    for k, row in enumerate(rows):
        mine = (table["robot"] == row["robot"]) & (table["step"] == row["step"])
        kept = arrays["others"][start[sets[k]] : start[sets[k] + 1]]
        assert kept.tolist() == table["other"][mine].tolist()


def test_bins_keep_the_shortest_distance(tmp_path: Path) -> None:
    """However few bins a long run has."""
    with make_record(tmp_path / "r.h5", 2, 50.0) as record:
        assert record.samples > 3000
        header, arrays = unpack(run_data(record, summarise(record)))
        assert header["curves"]["pair"]
        assert arrays["pair"].min() == pytest.approx(record.clearance.min(), abs=1e-4)
        assert arrays["wall"].min() == pytest.approx(record.boundary_clearance.min(), abs=1e-4)


def test_ten_robots_over_their_run_fit_into_the_bound(tmp_path: Path) -> None:
    """Made up, with a decision every 0.1 s: as many as the shipped world has, twice over."""
    with make_record(tmp_path / "r.h5", 10, 250.0, contacts=False) as record:
        assert len(physim.page(record).html.encode()) < 1.5e6
