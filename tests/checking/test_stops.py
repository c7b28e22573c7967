"""Walls and robots too near ahead of where robots are to stop are told."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.world.file.files import shipped_worlds
from tests.checking.worlds import check, lines
from tests.roads_to_stops import dead_end


def told(folder: Path, text: str) -> list[str]:
    return [line for line in lines(check(folder, text))[1] if "may never arrive" in line]


def test_an_end_wall_below_the_threshold_is_told_with_the_margin_that_mends_it(tmp_path):
    (line,) = told(tmp_path, dead_end(1.0))
    for part in ("end_margin", '"r1"', "0.1 m", "0.15 m", "1.05 m"):
        assert part in line
    assert told(tmp_path, dead_end(1.06)) == []


def test_a_run_that_is_not_to_finish_may_stop_anywhere(tmp_path):
    assert told(tmp_path, dead_end(1.0) + "expect: {finished: false}\n") == []


@pytest.mark.parametrize(("spacing", "warned"), [(2.7, True), (2.9, False)])
def test_a_robot_that_stops_close_behind_another_is_told(tmp_path, spacing, warned):
    """It would meet the one that stands within time_low below 1 m, at 1 m/s."""
    found = told(tmp_path, dead_end(3.0, [2.0 + spacing, 2.0]))
    assert len(found) == warned
    if warned:
        assert '"r2"' in found[0]
        assert "0.9 m" in found[0]


@pytest.mark.parametrize("name", shipped_worlds())
def test_no_shipped_world_is_told(name):
    from physim.world.checks import check_world

    assert not [w for w in check_world(name).warnings if "stops" in w.message]
