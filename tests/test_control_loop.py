"""What controllers tell of a decision: modes and counts that no record may hold are refused."""

from __future__ import annotations

import numpy as np
import pytest

import physim
from physim import Decision, Report
from physim.errors import ControllerError
from tests.validation.runs import LANE


class Telling:
    def __init__(self, considered: float) -> None:
        self.considered = considered

    def decide(self, observation, memory):
        return Decision(v=0.0, omega=0.0, hold=0.1, report=Report(considered=self.considered))


@pytest.mark.parametrize("considered", [-1, 1000, np.nan])
def test_impossible_numbers_of_robots_considered(considered):
    with pytest.raises(ControllerError, match=r"slow at 0 s: report: considered = .*; allowed: 0"):
        physim.simulate(physim.parse_world(LANE), controller=Telling(considered))
