"""A robot that has not arrived and no longer follows its path is told to be off it."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim.analysis.metrics import Absent, absent
from tests.helpers import inside
from tests.validation.runs import LANE, Drivers

STILL_DISTANCE = inside("physim.simulation", "STILL_DISTANCE")


def test_how_far_off_and_how_turned_are_those_of_the_last_pose():
    world = physim.parse_world(LANE, overrides=["time.duration=2.0"])
    record = physim.simulate(world, controller=Drivers((1.0, 1.0), (0.0, 0.0)))
    found = absent(record)
    for one in found:
        _, y, heading = record.pose[-1, one.robot]
        assert one.beside == pytest.approx(abs(y), abs=1e-9)
        assert one.turned == pytest.approx(abs(np.degrees(heading)), abs=1e-9)
    slow = found[0]
    assert slow.turned > 90.0
    assert slow.is_astray
    said = slow.sentence("slow")
    for part in ("m short of its stop station", f"{slow.beside:.1f} m off its path", "115°"):
        assert part in said


def test_of_a_robot_on_its_path_nothing_more_is_said():
    said = Absent(0, 21.3, 0.1, True, beside=0.4, turned=30.0).sentence("r1")
    assert said.endswith("(tolerance 0.10 m)")
    assert "turned 170°" in Absent(0, 21.3, 0.1, True, turned=170.0).sentence("r1")


@pytest.mark.parametrize(
    "time",
    [
        "time.record_every=60",
        "time.record_every=499",
        "time.record_every=1000",
        "time.record_every=1000 time.duration=0.02",
    ],
)
@pytest.mark.parametrize(("v", "word"), [(0.0, "stands"), (0.4, "still moves")])
def test_who_stands_is_told_from_few_samples_too(time: str, v: float, word: str) -> None:
    """The last half second has one sample, or two that lie a step apart."""
    world = physim.parse_world(LANE, overrides=["time.duration=5.0", *time.split()])
    record = physim.simulate(world, controller=Drivers((v, 0.0), (0.0, 0.0)))
    slow, fast = absent(record)
    assert word in slow.sentence("slow")
    assert "stands" in fast.sentence("fast")


@pytest.mark.parametrize("every", [1, 7, 33, 60])
def test_who_is_pushed_does_not_stand_though_it_commands_nothing(every: int) -> None:
    """7, 33: no sample begins the last half second, those within it show the robot elsewhere."""
    place = ["robots.1.pose=[5.5, 0.0, 0.0]", "time.duration=3.0", f"time.record_every={every}"]
    world = physim.parse_world(LANE, overrides=place)
    record = physim.simulate(world, controller=Drivers((0.0, 0.0), (0.6, 0.0)))
    assert record.pose[-1, 0, 0] > 8.2  # [m] it was pushed
    within = record.pose[record.time >= record.time[-1] - 0.5 + 1e-9, 0, :2]
    shows = np.hypot(*(within - within[-1]).T).max() > STILL_DISTANCE
    assert shows == (every < 60)
    slow, fast = absent(record)
    assert "still moves" in fast.sentence("fast")
    assert ("still moves" if shows else "stands") in slow.sentence("slow")
