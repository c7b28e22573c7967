"""What `physim.geometry` refuses within a part is an error of that part, told with its line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from physim import Mode, Simulation
from physim.errors import ControllerError
from physim.geometry import collision_time
from physim.world import World
from physim.world.file import load_world
from tests.helpers import inside

record_run = inside("physim.simulation", "record_run")

BOX = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
SAID = r"twist_a.*nan.* \(.*test_refused_by_geometry\.py:\d+\)"


def world() -> World:
    return load_world("three_robots", overrides=["time.duration=0.1", "expect=null"])


def asks(*given: Any) -> Any:
    return collision_time(
        BOX, (0.0, 0.0, 0.0), (float("nan"), 0.0), BOX, (9.0, 0.0, 0.0), (0.0, 0.0)
    )


class Asks:
    """A controller, stage and observer that asks what is refused."""

    modes = (Mode("going", "#0072b2"),)

    def start(self, scene: Any) -> Any:
        return None

    decide = sense = filter = disturb = after_step = asks

    def close(self, ended: str) -> None:
        pass


class AsksTogether(Asks):
    def decide_all(self, view: Any, due: Any, memory: Any) -> Any:
        return asks()


class AsksAtFirst(Asks):
    def start(self, scene: Any) -> Any:
        return asks()


@pytest.mark.parametrize(
    ("controller", "where"),
    [
        (Asks, "controller Asks, r1 at 0 s: "),
        (AsksTogether, "controller AsksTogether at 0 s: "),
        (AsksAtFirst, "controller AsksAtFirst, start: "),
    ],
)
def test_a_controller_is_named_with_its_line(controller: Any, where: str) -> None:
    with pytest.raises(ControllerError, match=f"^{where}.*{SAID}$"):
        Simulation(world(), controller=controller()).step()


@pytest.mark.parametrize(
    ("key", "word"),
    [("sensing", "sensing stage"), ("filters", "filter"), ("disturbances", "disturbance")],
)
def test_a_stage_is_named_with_its_line(key: str, word: str) -> None:
    stages: Any = {key: [Asks()]}
    with pytest.raises(ControllerError, match=f"^{word} Asks at 0 s: .*{SAID}$"):
        Simulation(world(), **stages).step()


def test_an_observer_is_named_with_its_line() -> None:
    with pytest.raises(ControllerError, match=rf"^observer Asks at 0\.01 s: .*{SAID}$"):
        record_run(Simulation(world()), observers=[Asks()])
