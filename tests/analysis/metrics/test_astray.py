"""Robots that have not arrived: whether they stand, and how far off their path they are."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim.analysis.metrics import Figures
from tests.analysis.validation.runs import LANE, Drivers


def test_how_far_off_and_how_turned_are_those_of_the_last_pose() -> None:
    world = physim.parse_world(LANE, overrides=["time.duration=2.0"])
    record = physim.simulate(world, controller=Drivers((1.0, 1.0), (0.0, 0.0)))
    slow, fast = Figures(record).absent
    for one in (slow, fast):
        _, y, heading = record.pose[-1, one.robot]
        assert one.beside == pytest.approx(abs(y), abs=1e-9)
        assert one.turned == pytest.approx(abs(np.degrees(heading)), abs=1e-9)
    assert slow.turned > 90.0
    assert (slow.is_astray, fast.is_astray) == (True, False)
    for part in ("m short of its stop station", f"{slow.beside:.1f} m off its path", "115°"):
        assert part in slow.sentence("slow")
    assert "off its path" not in fast.sentence("fast")


@pytest.mark.parametrize("time", ["time.record_every=60", "time.record_every=1000"])
@pytest.mark.parametrize(("v", "word"), [(0.0, "stands"), (0.4, "still moves")])
def test_who_stands_is_told_from_few_samples_too(time: str, v: float, word: str) -> None:
    """The last half second has one sample, or two that lie a step apart."""
    world = physim.parse_world(LANE, overrides=["time.duration=5.0", time])
    record = physim.simulate(world, controller=Drivers((v, 0.0), (0.0, 0.0)))
    slow, fast = Figures(record).absent
    assert word in slow.sentence("slow")
    assert "stands" in fast.sentence("fast")


@pytest.mark.parametrize("every", [1, 7])
def test_who_is_pushed_does_not_stand_though_it_commands_nothing(every: int) -> None:
    """7: no sample begins the last half second, those within it show the robot elsewhere."""
    place = ["robots.1.pose=[5.5, 0.0, 0.0]", "time.duration=3.0", f"time.record_every={every}"]
    world = physim.parse_world(LANE, overrides=place)
    record = physim.simulate(world, controller=Drivers((0.0, 0.0), (0.6, 0.0)))
    assert record.pose[-1, 0, 0] > 8.2  # [m] it was pushed
    for one in Figures(record).absent:
        assert "still moves" in one.sentence("it")


@pytest.mark.parametrize(("v", "is_told"), [(0.05, True), (0.4, False)])
def test_who_moves_but_gets_nowhere_is_told(v: float, is_told: bool) -> None:
    world = physim.parse_world(LANE, overrides=["time.duration=6.0"])
    record = physim.simulate(world, controller=Drivers((v, 0.0), (0.0, 0.0)))
    slow = Figures(record).absent[0]
    assert slow.pace == pytest.approx(v, rel=1e-6)
    assert ("came only 0.25 m in the last 5 s" in slow.sentence("slow")) == is_told
