"""Faults of a controller's class name the file and line of its author."""

from __future__ import annotations

import inspect
import re

import pytest

from physim.errors import ControllerError
from physim.parts.declarations import Mode
from physim.parts.registry import CONTROLLER, find_part
from physim.simulation.loop import Simulation
from physim.world.file import load_world


class NoModel:
    Settings = dict

    def decide(self, observation, memory): ...


class TwoModes:
    modes = (Mode("a", "#000000"), Mode("a", "#000000"))

    def decide(self, observation, memory): ...


class NoColour:
    modes = (Mode("a", "black"),)

    def decide(self, observation, memory): ...


class Empty:
    pass


class Text:
    def decide(self, observation, memory):
        return "forward"


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ("tests.test_class_faults:NoModel", NoModel),
        ("tests.test_class_faults:Empty", Empty),
        (TwoModes(), TwoModes),
        (NoColour(), NoColour),
        (Empty(), Empty),
        (Text, Text),
        (Text(), Text.decide),
    ],
)
def test_a_fault_of_a_class_names_the_line_at_which_its_author_wrote_it(given, named):
    line = inspect.getsourcelines(named)[1]
    with pytest.raises(ControllerError) as caught:
        Simulation(load_world("straight"), controller=given).step()
    assert str(caught.value).endswith(f" ({__file__}:{line})")


def test_a_class_that_is_not_in_its_module_names_the_file():
    with pytest.raises(ControllerError, match=re.escape(f" ({__file__})") + "$"):
        find_part(CONTROLLER, "tests.test_class_faults:Lost", trusted=True)
