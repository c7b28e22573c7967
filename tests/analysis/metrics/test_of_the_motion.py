"""Figures of the motion are those of the recorded samples, whoever decided, and however often."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis import metrics
from physim.errors import PhysimError
from physim.record import Record
from tests.analysis.metrics.histories import mean_squares
from tests.helpers import inside
from tests.helpers.records import make_record

FloatArray = inside("physim.geometry", "FloatArray")

WORLD = """
name: bend
time: {step: 0.01, duration: 14.0}
corridor: {centreline: [[0, 0], [9, 0], [15, 5], [20, 5]], width: 14}
formation: {range: 10.0}
arrival: {tolerance: 0.2}
robots:
  - {name: a, footprint: {length: 1.0, width: 0.6}, pose: [5, 1.5, 0.1],
     path: [[0, 1.5], [9, 1.5], [11, 3]]}
  - {name: b, footprint: {length: 1.0, width: 0.6}, pose: [2, -1.5, 0.0], path: {offset: -1.0}}
"""
OF_DECISIONS = {"decisions", "messages", "updates_per_second"}


class Turning:
    """Turns to the left, then to the right; asked every ``hold`` seconds."""

    def __init__(self, hold: float) -> None:
        self.hold = hold

    def decide(self, observation: Any, memory: Any) -> Decision:
        turn = 0.15 if observation.time < 6.0 - 1e-9 else -0.1
        return Decision(v=1.0 - 0.2 * observation.index, omega=turn, hold=self.hold)


def drive(hold: float, **time: int) -> Record:
    world = physim.parse_world(WORLD)
    return physim.simulate(world.changed(time=time) if time else world, controller=Turning(hold))


@pytest.fixture(scope="module")
def both() -> Iterator[tuple[Record, Record]]:
    """Two runs with the same poses: a decision every 6 s, and every 0.1 s."""
    with drive(6.0) as seldom, drive(0.1) as often:
        assert np.array_equal(seldom.pose, often.pose)
        assert len(often.updates) > 40 * len(seldom.updates)
        yield seldom, often


def test_metrics_of_two_runs_with_the_same_poses_are_the_same(both: tuple[Record, Record]) -> None:
    seldom, often = map(metrics.measure, both)
    assert set(seldom) == set(often) > OF_DECISIONS
    assert {"deviation_rms", "formation_error_final", "formation_energy_peak"} < set(often)
    for name in set(often) - OF_DECISIONS:
        assert seldom[name] == often[name], name
    assert abs(often["deviation_peak"].value) > 3.0


def nearest(points: FloatArray, place: FloatArray) -> float:
    """Signed distance of a place from a polyline, segment by segment; left positive."""
    least, side = math.inf, 0.0
    for a, b in zip(points, points[1:], strict=False):
        along = b - a
        share = min(max(float((place - a) @ along / (along @ along)), 0.0), 1.0)
        away = place - (a + share * along)
        if float(np.hypot(*away)) < least:
            least = float(np.hypot(*away))
            side = float(along[0] * away[1] - along[1] * away[0])
    return math.copysign(least, side)


def test_deviations_of_who_decides_once_are_those_of_all_its_poses() -> None:
    """`constant` decides at 0 s, where it is on its path, and drives off it."""
    world = physim.parse_world(WORLD).changed(
        controller={"type": "constant", "commands": [[1.0, 0.15], [0.7, -0.1]]},
        time={"duration": 8.0},
    )
    with physim.simulate(world) as record:
        lines = [record.paths.points[a:b] for a, b in zip(
            record.paths.start, record.paths.start[1:], strict=False
        )]  # fmt: skip
        exact = np.array([[nearest(lines[i], pose[i, :2]) for i in (0, 1)] for pose in record.pose])
        assert len(record.updates) == 2
        assert np.allclose(record.course[:, :, 1], exact, rtol=0.0, atol=1e-9)
        peak, rms = metrics.deviation_peak(record), metrics.Figures(record).metric("deviation_rms")
        assert peak is not None
        k, robot = np.unravel_index(np.argmax(np.abs(exact)), exact.shape)
        assert (peak.step, peak.a) == (k, robot)
        assert peak.value == pytest.approx(exact[k, robot])
        ends = metrics.Figures(record).active_steps
        each = [mean_squares(exact[: n + 1, [i]]).item() for i, n in enumerate(ends)]
        assert rms is not None
        assert rms.robots == pytest.approx(np.sqrt(each), rel=1e-6)
        assert rms.value == pytest.approx(np.sqrt(np.average(each, weights=ends)), rel=1e-6)


@pytest.mark.parametrize(("hold", "every"), [(6.0, 7), (0.1, 140)])
def test_a_coarse_record_has_the_stations_of_a_fine_one_at_its_samples(
    every: int, hold: float
) -> None:
    with drive(6.0) as fine, drive(hold, record_every=every) as coarse:
        assert coarse.samples < fine.samples
        assert np.allclose(fine.course[coarse.steps], coarse.course, rtol=0.0, atol=1e-9)
        size = np.abs(fine.course[coarse.steps, :, 1])
        peak = metrics.deviation_peak(coarse)
        assert peak is not None
        assert abs(peak.value) == pytest.approx(size.max())
        late = metrics.Figures(coarse).active_steps - metrics.Figures(fine).active_steps
        assert np.abs(late).max() < every


def test_of_few_samples_too_the_step_is_known_at_which_a_robot_is_there() -> None:
    """It goes straight on at 1 m/s; the tolerance of 3 m ends between two samples."""
    world = physim.parse_world(WORLD).changed(
        arrival={"tolerance": 3.0},
        robots=[
            {"name": "a", "footprint": {"length": 1.0, "width": 0.6}, "pose": [1, 0, 0],
             "path": [[0, 0], [7.7, 0]]},
        ],
        controller={"type": "constant", "commands": [[1.0, 0.0]]},
    )  # fmt: skip
    for every in (1, 7, 100):
        with physim.simulate(world.changed(time={"record_every": every})) as record:
            assert metrics.Figures(record).active_steps.tolist() == [370]


HAIRPIN = """
name: out and back
time: {step: 0.02, duration: 40.0}
boundaries: [[[-3, -4], [25, -4], [25, 6], [-3, 6], [-3, -4]]]
reference_path: [[0, 0], [20, 0], [20, 2], [0, 2]]
robots:
  - {name: a, footprint: {length: 0.8, width: 0.5}, pose: [0, 0, 0],
     path: [[0, 0], [20, 0], [20, 2], [0, 2]]}
controller: {type: path_following}
"""


@pytest.mark.parametrize("every", [90])
def test_a_coarse_record_does_not_take_the_way_back_for_the_way_out(every: int) -> None:
    """The robot goes 1.1 or 1.8 m or so from sample to sample, and the two ways are 2 m apart."""
    world = physim.parse_world(HAIRPIN)
    with (
        physim.simulate(world.changed(time={"record_every": every})) as few,
        physim.simulate(world) as all_of_them,
    ):
        exact = all_of_them.course[few.steps]
        assert np.allclose(few.course, exact, rtol=0.0, atol=1e-9)
        assert exact[-1, 0, 0] > 30.0


@pytest.mark.parametrize("wrong", [0, math.nan, "0.1"])
def test_times_asked_for_are_positive(wrong: Any) -> None:
    record = make_record(seconds=1.0)
    for measure, name in (
        (metrics.deviations, "every"), (metrics.averaged_speeds, "every"),
        (metrics.averaged_speeds, "window"),
    ):  # fmt: skip
        with pytest.raises(PhysimError, match=f"{name}: a positive number of seconds"):
            measure(record, **{name: wrong})
    with pytest.raises(PhysimError, match="there are 0 to 2"):
        metrics.corridor_width(record, wrong if isinstance(wrong, str) else 3)
