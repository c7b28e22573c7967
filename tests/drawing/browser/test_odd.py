"""Pages of records that lack something, or have more than most: all of them play and answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import physim
from physim.drawing.page import write_page
from tests.drawing.browser.__main__ import look
from tests.drawing.browser.driver import Seen
from tests.helpers.records import make_record

Opened = Callable[..., Seen]
PLAYED = 0.5
"""[s] that playing takes"""


@pytest.mark.parametrize(("robots", "seconds"), [(1, 2.0), (2, 0.01), (2, 0.0), (80, 2.0)])
def test_few_samples_one_robot_and_a_crowd(
    opened: Opened, tmp_path: Path, robots: int, seconds: float
) -> None:
    with make_record(tmp_path / "r.h5", robots, seconds, contacts=False) as record:
        seen = opened(write_page([record], tmp_path / "r.html"))
    assert list(look(seen, PLAYED)) == []


def run(**how: Any) -> physim.Record:
    """Two robots for 2 s."""
    world = physim.load_world("straight")
    time = world.time.model_copy(update={"duration": 2.0})
    return physim.simulate(world.changed(time=time), **how)


def test_without_tables_it_says_what_was_not_recorded(opened: Opened, tmp_path: Path) -> None:
    bare = run(save=physim.SaveAt(every=10, tables=()))
    seen = opened(write_page([bare], tmp_path / "r.html"))
    assert list(look(seen, PLAYED)) == []
    assert "not recorded" in seen.text(".figures")
    assert "not decided" in seen.text("#why")
