"""Formation errors and energy over time, against the controller's own formulas (9), (10)."""

from __future__ import annotations

import numpy as np
import pytest

from physim.analysis import metrics
from physim.record import Record
from tests.analysis.metrics.histories import along_reference, history, mean_squares
from tests.helpers import inside
from tests.oracles import formation as oracle

formation_energy = inside("physim.controllers", "formation_energy")
FloatArray = inside("physim.geometry", "FloatArray")

LEAD = np.array([0.0, -4.0, -9.0, -30.0])
STATIONS = np.array([[40.0, 35.0, 31.0, 11.0], [50.0, 46.0, 42.0, 18.0], [61.0, 57.0, 52.0, 30.5]])
STEPS = np.array([0, 10, 20])


def drive(world: str) -> Record:
    """Robots that are at these stations every 10 steps, and decide nothing."""
    pose = along_reference(STEPS, STATIONS)
    return history(robots=4, steps_run=20, world=world, lead=LEAD, pose=pose)


def test_errors_are_those_of_the_samples() -> None:
    time, errors = metrics.formation_errors(drive("formation: {}"), every=0.05) or (0, 0)
    assert time == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2])
    exact = np.array([oracle.errors(s, LEAD) for s in STATIONS])
    assert np.allclose(errors[::2], exact, rtol=0, atol=1e-9)
    assert np.allclose(errors[1], (exact[0] + exact[1]) / 2, rtol=0, atol=1e-9)


def test_desired_leads_are_those_of_the_record() -> None:
    lead = metrics.desired_leads(drive("formation: {}"))
    assert lead == pytest.approx(LEAD - LEAD.mean())


ALL = 1 - np.eye(4, dtype=np.int64)
CHAIN = np.array([[0, 1, 0, 0], [1, 0, 0, 1], [0, 0, 0, 0], [0, 1, 0, 0]])


@pytest.mark.parametrize(
    ("neighbours", "adjacency"),
    [
        ("neighbours: all", [ALL, ALL, ALL]),
        ("neighbours: [[r1, r2], [r4, r2]]", [CHAIN, CHAIN, CHAIN]),
        ("range: 8.0", [abs(s[:, None] - s) <= 8.0 for s in STATIONS]),
    ],
)
def test_energy_is_that_of_the_controller(neighbours: str, adjacency: list[FloatArray]) -> None:
    course = metrics.formation_energy(drive(f"formation: {{{neighbours}}}"))
    assert course is not None
    expected = [
        formation_energy(s, LEAD, a * ALL) for s, a in zip(STATIONS, adjacency, strict=True)
    ]
    assert course.values[STEPS] == pytest.approx(expected)
    assert metrics.measure(drive(f"formation: {{{neighbours}}}"))[
        "formation_energy_final"
    ].value == pytest.approx(expected[-1])


@pytest.mark.parametrize(
    ("neighbours", "parts"),
    [
        ("neighbours: all", [1, 1, 1]),
        ("neighbours: [[r1, r2], [r4, r2]]", [2, 2, 2]),
        ("neighbours: [[r1, r2], [r4, r2], [r4, r3]]", [1, 1, 1]),
        ("range: 21.5", [1, 2, 1]),
        ("range: 4.5", [3, 2, 3]),  # gaps of 5, 4 and 20; of 4, 4 and 24; of 4, 5 and 21.5 m
        ("range: 1.0", [4, 4, 4]),
    ],
)
def test_parts_are_those_that_chains_of_neighbours_connect(
    neighbours: str, parts: list[int]
) -> None:
    course = metrics.formation_parts(drive(f"formation: {{{neighbours}}}"))
    assert course is not None
    assert course.values[STEPS].tolist() == parts
    assert metrics.formation_parts(drive("name: none")) is None


def test_rms_is_of_each_robot_and_of_all() -> None:
    found = metrics.Figures(drive("formation: {}")).metric("formation_error_rms")
    exact = np.array([oracle.errors(s, LEAD) for s in STATIONS])
    assert found is not None
    squares = mean_squares(exact)
    assert found.robots == pytest.approx(np.sqrt(squares), rel=1e-6)
    assert found.value == pytest.approx(np.sqrt(squares.mean()), rel=1e-6)


def test_peak_and_final_energy_are_those_of_the_samples() -> None:
    """The run ends 0.02 s after the last tenth of a second, and W is largest between two."""
    steps = np.array([0, 5, 20, 22])
    station = STATIONS[[0, 0, 1, 2]] + np.array([0.0, 3.0, 0.0, 0.0])[:, None] * [1, 0, 0, 0]
    pose = along_reference(steps, station)
    record = history(
        robots=4, steps_run=22, world="formation: {neighbours: all}", lead=LEAD, pose=pose
    )
    exact = [formation_energy(s, LEAD, ALL) for s in station]
    found = metrics.measure(record)
    assert found["formation_energy_final"].value == pytest.approx(exact[-1])
    assert found["formation_energy_peak"].value == pytest.approx(max(exact))
    assert np.argmax(exact) == 1
    course = metrics.formation_energy(record)
    assert course is not None
    assert course.time == pytest.approx(record.time)
    assert course.values[-1] == pytest.approx(exact[-1])
