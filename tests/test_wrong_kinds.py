"""What is given in place of a record or a state is told, wherever one is taken."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import physim
from physim import metrics, plots, video
from tests.helpers import facts

TAKE_A_RECORD: tuple[Callable[[Any], object], ...] = (
    physim.validate,
    physim.summarise,
    physim.page,
    metrics.measure,
    lambda given: metrics.measure(given, ["contacts"]),
    lambda given: plots.draw(given, "nowhere"),
    lambda given: physim.render(given, "nowhere.mp4"),
    lambda given: video.frame_at(given, 0.0),
)


@pytest.mark.parametrize("given", ["record.h5", Path("record.h5"), None, []])
@pytest.mark.parametrize("take", TAKE_A_RECORD)
def test_what_is_no_record_is_told_with_how_to_get_one(
    take: Callable[[Any], object], given: object
) -> None:
    with pytest.raises(TypeError, match=facts("Record", type(given).__name__, "Record.load")):
        take(given)


def test_a_world_is_no_record_and_a_sample_no_state() -> None:
    world = physim.load_world("straight")
    with pytest.raises(TypeError, match=facts("Record", "World", "simulate")):
        physim.summarise(world)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=facts("state", "NoneType")):
        physim.Simulation(world).restore(None)  # type: ignore[arg-type]
